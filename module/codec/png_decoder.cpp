#include "codec/png_decoder.h"

#include <new>
#include <string>

#include "codec/row_source.h"

namespace welkin::codec {

PngDecoder::PngDecoder(const std::filesystem::path& path) : stream_(path), context_(spng_ctx_new(0)) {
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
  const ByteFile& file = stream_.file();
  throw file_error(ErrorCode::corrupt_file, file.path(),
                   "is a damaged PNG: " + place + "at byte " + std::to_string(file.position()) + ", libspng says \"" +
                       spng_strerror(result) + "\"; fetch or export it again");
}

void PngDecoder::read_header() {
  spng_ihdr basic{};
  check(spng_get_ihdr(context_.get(), &basic));
  if (basic.width > static_cast<std::uint32_t>(kMaximumWidth) ||
      basic.height > static_cast<std::uint32_t>(kMaximumHeight)) {
    throw file_error(ErrorCode::unsupported_file, stream_.file().path(),
                     "its " + std::to_string(basic.width) + " x " + std::to_string(basic.height) +
                         " texels are more than " + std::to_string(kMaximumWidth) + " x " +
                         std::to_string(kMaximumHeight) + "; reduce the picture first");
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
    header_.primaries = {chrm.red_x / 100000.0,         chrm.red_y / 100000.0,        chrm.green_x / 100000.0,
                         chrm.green_y / 100000.0,       chrm.blue_x / 100000.0,       chrm.blue_y / 100000.0,
                         chrm.white_point_x / 100000.0, chrm.white_point_y / 100000.0};
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

}  // namespace welkin::codec
