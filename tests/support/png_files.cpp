#include "support/png_files.h"

#include <memory>
#include <random>
#include <stdexcept>

namespace welkin::test {
namespace {

void check(int result) {
  if (result != SPNG_OK) {
    throw std::runtime_error(spng_strerror(result));
  }
}

// libspng takes rows as a PNG stores them, except that 16-bit samples have the machine's byte order.
std::vector<std::uint8_t> packed(const PngRecipe& recipe, const std::vector<std::uint16_t>& samples) {
  std::vector<std::uint8_t> bytes;
  const auto row_samples = static_cast<std::size_t>(recipe.width * png_channels(recipe));
  for (int row = 0; row < recipe.height; ++row) {
    unsigned filled = 0;
    for (std::size_t i = 0; i < row_samples; ++i) {
      const std::uint16_t sample = samples[static_cast<std::size_t>(row) * row_samples + i];
      if (recipe.bits == 16) {
        const auto* raw = reinterpret_cast<const std::uint8_t*>(&sample);
        bytes.insert(bytes.end(), raw, raw + 2);
        continue;
      }
      if (filled == 0) {
        bytes.push_back(0);
      }
      filled += static_cast<unsigned>(recipe.bits);
      bytes.back() = static_cast<std::uint8_t>(bytes.back() | sample << (8 - filled));
      filled %= 8;
    }
  }
  return bytes;
}

void put_big_endian(char* to, std::uint32_t value) {
  for (const unsigned shift : {24U, 16U, 8U, 0U}) {
    *to++ = static_cast<char>(value >> shift & 0xffU);
  }
}

}  // namespace

int png_channels(const PngRecipe& recipe) {
  switch (recipe.colour_type) {
    case SPNG_COLOR_TYPE_TRUECOLOR: return 3;
    case SPNG_COLOR_TYPE_TRUECOLOR_ALPHA: return 4;
    case SPNG_COLOR_TYPE_GRAYSCALE_ALPHA: return 2;
    default: return 1;
  }
}

std::vector<std::uint16_t> some_samples(const PngRecipe& recipe, unsigned seed) {
  std::mt19937 random(seed);
  const std::uint32_t count = recipe.palette.empty() ? 1U << static_cast<unsigned>(recipe.bits)
                                                     : static_cast<std::uint32_t>(recipe.palette.size());
  std::vector<std::uint16_t> samples(static_cast<std::size_t>(recipe.width * recipe.height * png_channels(recipe)));
  for (std::uint16_t& sample : samples) {
    sample = static_cast<std::uint16_t>(random() % count);
  }
  return samples;
}

std::vector<char> png_bytes(const PngRecipe& recipe, const std::vector<std::uint16_t>& samples) {
  const std::unique_ptr<spng_ctx, void (*)(spng_ctx*)> context(spng_ctx_new(SPNG_CTX_ENCODER), spng_ctx_free);
  check(spng_set_option(context.get(), SPNG_ENCODE_TO_BUFFER, 1));
  spng_ihdr header{};
  header.width = static_cast<std::uint32_t>(recipe.width);
  header.height = static_cast<std::uint32_t>(recipe.height);
  header.bit_depth = static_cast<std::uint8_t>(recipe.bits);
  header.color_type = static_cast<std::uint8_t>(recipe.colour_type);
  header.interlace_method = recipe.interlaced ? SPNG_INTERLACE_ADAM7 : SPNG_INTERLACE_NONE;
  check(spng_set_ihdr(context.get(), &header));
  if (recipe.srgb) {
    check(spng_set_srgb(context.get(), 0));
  }
  if (recipe.gamma) {
    check(spng_set_gama_int(context.get(), *recipe.gamma));
  }
  if (recipe.primaries) {
    spng_chrm_int primaries = *recipe.primaries;
    check(spng_set_chrm_int(context.get(), &primaries));
  }
  if (!recipe.palette.empty()) {
    spng_plte palette{};
    palette.n_entries = static_cast<std::uint32_t>(recipe.palette.size());
    std::copy(recipe.palette.begin(), recipe.palette.end(), palette.entries);
    check(spng_set_plte(context.get(), &palette));
  }
  const std::vector<std::uint8_t> image = packed(recipe, samples);
  check(spng_encode_image(context.get(), image.data(), image.size(), SPNG_FMT_PNG, SPNG_ENCODE_FINALIZE));
  std::size_t size = 0;
  int result = 0;
  const std::unique_ptr<void, void (*)(void*)> file(spng_get_png_buffer(context.get(), &size, &result), std::free);
  check(result);
  const auto* bytes = static_cast<const char*>(file.get());
  return {bytes, bytes + size};
}

std::uint32_t png_checksum(const char* bytes, std::size_t count) {
  std::uint32_t sum = 0xffffffffU;
  for (std::size_t i = 0; i < count; ++i) {
    sum ^= static_cast<unsigned char>(bytes[i]);
    for (int bit = 0; bit < 8; ++bit) {
      sum = sum >> 1U ^ ((sum & 1U) != 0 ? 0xedb88320U : 0U);
    }
  }
  return ~sum;
}

std::vector<char> with_png_chunk(std::vector<char> file, const std::string& type, const std::string& data) {
  std::string chunk(4, '\0');
  put_big_endian(chunk.data(), static_cast<std::uint32_t>(data.size()));
  chunk += type + data + "none";
  constexpr std::ptrdiff_t kAfterHeader = 8 + 4 + 4 + 13 + 4;
  file.insert(file.begin() + kAfterHeader, chunk.begin(), chunk.end());
  return file;
}

std::vector<char> with_png_size(std::vector<char> file, std::uint32_t width, std::uint32_t height) {
  constexpr std::size_t kType = 12;
  constexpr std::size_t kTypeAndData = 4 + 13;
  put_big_endian(file.data() + kType + 4, width);
  put_big_endian(file.data() + kType + 8, height);
  put_big_endian(file.data() + kType + kTypeAndData, png_checksum(file.data() + kType, kTypeAndData));
  return file;
}

}  // namespace welkin::test
