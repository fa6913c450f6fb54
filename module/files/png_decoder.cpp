#include <algorithm>
#include <array>
#include <cstring>
#include <glm/vec3.hpp>
#include <new>
#include <string>
#include <string_view>
#include <vector>

#include "files/png.h"
#include "files/row_source.h"
#include "image/pixels.h"

namespace welkin::files {

PngDecoder::PngDecoder(const FileInput& input) : stream_(input), context_(spng_ctx_new(0)) {
  if (context_ == nullptr) {
    throw std::bad_alloc();
  }
  check(spng_set_png_stream(context_.get(), &PngDecoder::read_stream, this));
  read_header();
}

// Called by a library that knows no exceptions: one that comes up is kept until `check`.
int PngDecoder::read_stream(spng_ctx* /*context*/, void* decoder, void* bytes, std::size_t count) noexcept {
  auto* self = static_cast<PngDecoder*>(decoder);
  try {
    self->stream_.read(bytes, count);
    return 0;
  } catch (...) {
    self->stream_failure_ = std::current_exception();
    return SPNG_IO_ERROR;
  }
}

void PngDecoder::check(int result) {
  if (stream_failure_) {
    std::rethrow_exception(stream_failure_);
  }
  if (result == SPNG_OK) {
    return;
  }
  if (result == SPNG_EMEM) {
    throw std::bad_alloc();
  }
  // libspng looks a row ahead.
  const std::string place =
      next_row_ > 0 ? "near row " + std::to_string(next_row_) + " of " + std::to_string(header_.height) + ", " : "";
  const platform::ByteFile& file = stream_.file();
  throw platform::file_error(ErrorCode::corrupt_file, file.path(),
                             "is a damaged PNG: " + place + "at byte " + std::to_string(file.position()) +
                                 ", libspng says \"" + spng_strerror(result) + "\"; fetch or export it again");
}

void PngDecoder::read_header() {
  spng_ihdr basic{};
  check(spng_get_ihdr(context_.get(), &basic));
  if (basic.width > static_cast<std::uint32_t>(kMaximumWidth) ||
      basic.height > static_cast<std::uint32_t>(kMaximumHeight)) {
    throw platform::file_error(ErrorCode::unsupported_file, stream_.file().path(),
                               "its " + std::to_string(basic.width) + " x " + std::to_string(basic.height) +
                                   " texels are more than " + std::to_string(kMaximumWidth) + " x " +
                                   std::to_string(kMaximumHeight) + "; reduce the image first");
  }
  // Reads to the first pixels; only now are the flags of the stream those of the whole header.
  check(spng_decode_chunks(context_.get()));
  header_.width = static_cast<int>(basic.width);
  header_.height = static_cast<int>(basic.height);
  header_.bits = basic.bit_depth;
  header_.palette = basic.color_type == SPNG_COLOR_TYPE_INDEXED;
  header_.grey = basic.color_type == SPNG_COLOR_TYPE_GRAYSCALE || basic.color_type == SPNG_COLOR_TYPE_GRAYSCALE_ALPHA;
  header_.alpha = basic.color_type == SPNG_COLOR_TYPE_GRAYSCALE_ALPHA ||
                  basic.color_type == SPNG_COLOR_TYPE_TRUECOLOR_ALPHA || stream_.has_transparency();
  header_.interlaced = basic.interlace_method != SPNG_INTERLACE_NONE;
  header_.has_profile = stream_.has_profile();
  header_.has_code_points = stream_.has_code_points();

  std::uint8_t intent = 0;
  header_.says_srgb = spng_get_srgb(context_.get(), &intent) == SPNG_OK;
  std::uint32_t gamma = 0;
  if (spng_get_gama_int(context_.get(), &gamma) == SPNG_OK) {
    header_.gamma = gamma / 100000.0;
  }
  spng_chrm_int chrm{};
  if (spng_get_chrm_int(context_.get(), &chrm) == SPNG_OK) {
    const auto xy = [](std::uint32_t x, std::uint32_t y) { return glm::dvec2(x / 100000.0, y / 100000.0); };
    header_.primaries = {xy(chrm.red_x, chrm.red_y), xy(chrm.green_x, chrm.green_y), xy(chrm.blue_x, chrm.blue_y),
                         xy(chrm.white_point_x, chrm.white_point_y)};
  }
}

void PngDecoder::decode_row(void* row) {
  if (next_row_ == 0) {
    check(spng_decode_image(context_.get(), nullptr, 0, format(), SPNG_DECODE_PROGRESSIVE));
  }
  const int result = spng_decode_row(context_.get(), row, header_.row_bytes());
  const bool last = next_row_ + 1 == header_.height;
  check(last && result == SPNG_EOI ? static_cast<int>(SPNG_OK) : result);
  ++next_row_;
  if (last) {
    check(spng_decode_chunks(context_.get()));
  }
}

void PngDecoder::decode_all(void* rows) {
  const std::size_t bytes = header_.row_bytes() * static_cast<std::size_t>(header_.height);
  check(spng_decode_image(context_.get(), rows, bytes, format(), 0));
  check(spng_decode_chunks(context_.get()));
}

namespace {

constexpr std::uint64_t kChecksumBytes = 4;

std::uint64_t big_endian(const char* bytes) {
  std::uint64_t value = 0;
  for (int i = 0; i < 4; ++i) {
    value = value << 8U | static_cast<unsigned char>(bytes[i]);
  }
  return value;
}

// A type whose first letter is upper case is critical: to be understood or to be refused, by the decoder.
bool is_wanted(std::string_view type) {
  return (static_cast<unsigned char>(type[0]) & 0x20U) == 0 || type == "gAMA" || type == "sRGB" || type == "cHRM";
}

// Seeking costs a call to the system; over a few bytes it is cheaper to read.
void pass_over(platform::ByteFile& file, std::uint64_t count) {
  std::array<char, 512> bytes{};
  if (count <= bytes.size() && count <= file.remaining()) {
    file.read(bytes.data(), count);
  } else {
    file.seek(file.position() + count);
  }
}

}  // namespace

void PngStream::next_chunk() {
  file_.read(start_.data(), start_.size());
  start_used_ = 0;
  if (!signature_is_out_) {
    signature_is_out_ = true;
    return;
  }
  const std::string_view type(start_.data() + 4, 4);
  const std::uint64_t length = big_endian(start_.data()) + kChecksumBytes;
  has_profile_ = has_profile_ || type == "iCCP";
  has_transparency_ = has_transparency_ || type == "tRNS";
  has_code_points_ = has_code_points_ || type == "cICP";
  if (is_wanted(type)) {
    body_left_ = length;
  } else {
    pass_over(file_, length);
    start_used_ = start_.size();
  }
}

void PngStream::read(void* bytes, std::size_t count) {
  auto* to = static_cast<char*>(bytes);
  while (count > 0) {
    std::size_t part = std::min(count, start_.size() - start_used_);
    if (part > 0) {
      std::memcpy(to, start_.data() + start_used_, part);
      start_used_ += part;
    } else if (body_left_ > 0) {
      part = static_cast<std::size_t>(std::min<std::uint64_t>(count, body_left_));
      file_.read(to, part);
      body_left_ -= part;
    } else {
      next_chunk();
      continue;
    }
    to += part;
    count -= part;
  }
}

PngSamples::PngSamples(bool sixteen_bits, Transfer transfer, const std::optional<glm::dmat3>& matrix)
    : sixteen_bits_(sixteen_bits), table_(sixteen_bits ? 65536 : 256), matrix_(matrix) {
  const auto largest = static_cast<double>(table_.size() - 1);
  for (std::size_t i = 0; i < table_.size(); ++i) {
    const double encoded = static_cast<double>(i) / largest;
    table_[i] = static_cast<float>(transfer == Transfer::srgb ? image::linear_from_srgb(encoded) : encoded);
  }
}

void PngSamples::convert(const std::uint8_t* coded, std::size_t count, float* rgb) const noexcept {
  for (std::size_t i = 0; i < count; ++i) {
    float* const texel = rgb + 3 * i;
    if (sixteen_bits_) {
      std::array<std::uint16_t, 3> words{};
      std::memcpy(words.data(), coded + 8 * i, sizeof words);
      for (std::size_t c = 0; c < 3; ++c) texel[c] = table_[words[c]];
    } else {
      for (std::size_t c = 0; c < 3; ++c) texel[c] = table_[coded[3 * i + c]];
    }
  }
  if (matrix_) apply(*matrix_, rgb, count);
}

}  // namespace welkin::files
