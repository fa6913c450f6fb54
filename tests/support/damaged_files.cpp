#include "support/damaged_files.h"

#include "support/catch.h"
#include "support/exr_files.h"
#include "support/hdr_files.h"
#include "support/jpeg_files.h"
#include "support/pfm_files.h"
#include "support/png_files.h"
#include "support/temporary_directory.h"
#include "support/trials.h"

namespace welkin::test {
namespace {

using Bytes = std::vector<char>;

constexpr std::size_t kExrHeader = 480;  // including the table of offsets and the first block's size
constexpr std::size_t kWhole = static_cast<std::size_t>(-1);
constexpr std::array<std::uint32_t, 6> kExtremes{0, 1, 0xffffffffU, 0x7fffffffU, 0x80000000U, 0x10000U};
const std::array<const char*, 12> kExtremeNumbers{"0",
                                                  "1",
                                                  "-1",
                                                  "2147483647",
                                                  "-2147483648",
                                                  "2147483648",
                                                  "4294967296",
                                                  "18446744073709551616",
                                                  "99999999999999999999999999999999",
                                                  "1e30",
                                                  "nan",
                                                  ""};

ExrRecipe small_sky() { return {.width = 8, .height = 4, .envmap = Imf::ENVMAP_LATLONG}; }

Bytes exr(const std::filesystem::path& directory, Imf::Compression compression,
          const std::optional<Imf::TileDescription>& tiles) {
  ExrRecipe recipe = small_sky();
  recipe.compression = compression;
  recipe.tiles = tiles;
  const std::filesystem::path path = directory / "sound.exr";
  write_exr(path, recipe, some_pixels(8, 4));
  return read_bytes(path);
}

Bytes luminance_chroma_exr(const std::filesystem::path& directory) {
  const std::filesystem::path path = directory / "sound.exr";
  write_luminance_chroma_exr(path, small_sky(), some_pixels(8, 4));
  return read_bytes(path);
}

/// The first part is the one that is read.
Bytes exr_of_parts(const std::filesystem::path& directory) {
  ExrRecipe mask = small_sky();
  mask.channels = {{"Y"}};
  mask.tiles = Imf::TileDescription(4, 4);
  const std::filesystem::path path = directory / "sound.exr";
  write_exr_parts(path, {{"sky", small_sky(), some_pixels(8, 4)}, {"mask", mask, some_pixels(8, 4)}});
  return read_bytes(path);
}

Bytes hdr(HdrForm form) { return hdr_bytes({8, 4, form}, some_rgbe(8, 4)); }

Bytes jpeg(int width, bool progressive, const std::pair<int, std::string>& gains) {
  const Bytes base = jpeg_bytes({width, width / 2, 3, progressive}, smooth_samples(width, width / 2, 3));
  return gain_map_file(base, jpeg_bytes({2, 1, 1, progressive, {gains}}, smooth_samples(2, 1, 1)));
}

Bytes png(int bits, bool interlaced) {
  PngRecipe recipe{8, 4, bits};
  recipe.interlaced = interlaced;
  return png_bytes(recipe, some_samples(recipe));
}

std::uint32_t big_endian_at(const Bytes& bytes, std::size_t index) {
  std::uint32_t value = 0;
  for (std::size_t i = index; i < index + 4; ++i) value = value << 8U | static_cast<unsigned char>(bytes[i]);
  return value;
}

void put(Bytes& bytes, std::size_t index, std::uint32_t value, bool big) {
  for (std::size_t i = 0; i < 4; ++i) {
    bytes[index + i] = static_cast<char>(value >> (8 * (big ? 3 - i : i)) & 0xffU);
  }
}

void repair_png(Bytes& bytes) {
  for (std::size_t chunk = 8; chunk + 12 <= bytes.size();) {
    const std::size_t length = big_endian_at(bytes, chunk);
    if (length > bytes.size() - chunk - 12) return;
    put(bytes, chunk + 8 + length, png_checksum(bytes.data() + chunk + 4, length + 4), true);
    chunk += length + 12;
  }
}

/// Passes the damaged bytes to `use`, then again with corrected checksums.
void hand_out(const SoundFile& file, Bytes bytes, const Use& use) {
  use(bytes);
  if (!file.repair) return;
  file.repair(bytes);
  use(bytes);
}

/// Returns the offsets of `sample` from which `bytes` lie within the header.
std::vector<std::size_t> places(const SoundFile& file, const SoundFile::Sample& sample, std::size_t bytes) {
  const auto step = static_cast<std::size_t>(stride(static_cast<int>(sample.step)));
  std::vector<std::size_t> all;
  for (std::size_t i = step == 1 && sample.step != 1 ? 0 : sample.first; i + bytes <= file.header_bytes; i += step) {
    all.push_back(i);
  }
  return all;
}

struct Number {
  std::size_t first;
  std::size_t end;
};

std::vector<Number> numbers_in(const SoundFile& file) {
  const auto digit = [&](std::size_t i) { return file.bytes[i] >= '0' && file.bytes[i] <= '9'; };
  std::vector<Number> numbers;
  for (std::size_t i = 0; i < file.header_bytes; ++i) {
    if (!digit(i)) continue;
    const std::size_t first = i;
    while (i < file.header_bytes && digit(i)) ++i;
    numbers.push_back({first, i});
  }
  return numbers;
}

Bytes replaced(Bytes bytes, const Number& number, const std::string& text) {
  const auto index = bytes.begin() + static_cast<std::ptrdiff_t>(number.first);
  const auto after = bytes.erase(index, bytes.begin() + static_cast<std::ptrdiff_t>(number.end));
  bytes.insert(after, text.begin(), text.end());
  return bytes;
}

}  // namespace

std::vector<SoundFile> sound_files(const std::filesystem::path& directory) {
  std::vector<SoundFile> files{
      {"scanlines.exr", exr(directory, Imf::ZIP_COMPRESSION, std::nullopt), kExrHeader},
      {"tiles.exr", exr(directory, Imf::PIZ_COMPRESSION, Imf::TileDescription(4, 4)), kExrHeader},
      {"mip-map.exr",
       exr(directory, Imf::DWAA_COMPRESSION, Imf::TileDescription(4, 4, Imf::MIPMAP_LEVELS)),
       kExrHeader,
       false,
       {},
       false},
      {"luminance-chroma.exr", luminance_chroma_exr(directory), kExrHeader},
      {"parts.exr", exr_of_parts(directory), 2 * kExrHeader, false, {}, false},
      {"colour.pfm", pfm_bytes(8, 4, false, "-1.0", some_pixels(8, 4)), 16},
      {"grey.pfm", pfm_bytes(8, 4, true, "1.0", some_pixels(8, 4)), 16},
      {"flat.hdr", hdr(HdrForm::flat), kWhole},
      {"old-runs.hdr", hdr(HdrForm::old_rle), kWhole},
      {"new-runs.hdr", hdr(HdrForm::new_rle), kWhole},
      {"columns.hdr", hdr_bytes({8, 4, HdrForm::mixed, true}, some_rgbe(8, 4)), kWhole},
      {"xmp.jpg", jpeg(8, false, {1, gain_xmp({})}), kWhole, true},
      {"iso.jpg", jpeg(8, true, {2, gain_iso({}, true)}), kWhole, true},
      {"eight-bits.png", png(8, false), kWhole, true, repair_png},
      {"interlaced.png", png(16, true), kWhole, true, repair_png},
  };
  // OpenEXR headers begin the same way, so each file has a different third of them damaged. A JPEG's fields are short:
  // each gets part of every extreme.
  std::size_t number = 0;
  for (SoundFile& file : files) {
    file.header_bytes = std::min(file.header_bytes, file.bytes.size());
    const bool is_jpeg = file.name.ends_with(".jpg");
    if (!is_jpeg && !file.name.ends_with(".exr")) continue;
    file.bytes_changed = {number++ % 3, 3};
    file.fields_changed = is_jpeg ? SoundFile::Sample{0, 4} : file.bytes_changed;
  }
  return files;
}

void for_each_truncation(const SoundFile& file, const Use& use) {
  for (std::size_t size = 0; size < file.bytes.size(); ++size) {
    use({file.bytes.begin(), file.bytes.begin() + static_cast<std::ptrdiff_t>(size)});
  }
}

void for_each_changed_byte(const SoundFile& file, const Use& use) {
  for (const std::size_t index : places(file, file.bytes_changed, 1)) {
    for (const int value : {~file.bytes[index] & 0xff, 0x00, 0x01, 0xff}) {
      if (static_cast<char>(value) == file.bytes[index]) continue;
      Bytes damaged = file.bytes;
      damaged[index] = static_cast<char>(value);
      hand_out(file, std::move(damaged), use);
    }
  }
}

void for_each_extreme_field(const SoundFile& file, const Use& use) {
  for (const std::size_t index : places(file, file.fields_changed, 4)) {
    for (const std::uint32_t value : kExtremes) {
      Bytes damaged = file.bytes;
      put(damaged, index, value, file.big_endian);
      hand_out(file, damaged, use);
      // Pairs are written only if their product is large.
      if (index + 8 > file.header_bytes || value < 0x10000U) continue;
      put(damaged, index + 4, value, file.big_endian);
      hand_out(file, std::move(damaged), use);
    }
  }
}

void for_each_extreme_number(const SoundFile& file, const Use& use) {
  const std::vector<Number> numbers = numbers_in(file);
  for (std::size_t i = 0; i < numbers.size(); ++i) {
    for (const char* text : kExtremeNumbers) {
      use(replaced(file.bytes, numbers[i], text));
      if (i + 1 < numbers.size()) use(replaced(replaced(file.bytes, numbers[i + 1], text), numbers[i], text));
    }
  }
}

void for_each_damage(const SoundFile& file, const Use& use) {
  for_each_truncation(file, use);
  for_each_changed_byte(file, use);
  for_each_extreme_field(file, use);
  for_each_extreme_number(file, use);
}

}  // namespace welkin::test
