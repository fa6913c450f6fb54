// PNG through libspng: images that are written (as sRGB, 8 or 16 bits per channel, no alpha), and the small images of
// .env files.
#include "files/png.h"

#include <spng.h>

#include <algorithm>
#include <exception>
#include <memory>
#include <new>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "files/env.h"
#include "files/write_environment.h"
#include "image/pixels.h"
#include "jobs/control.h"
#include "platform/file.h"

namespace welkin::files {
namespace {

/// Encodes to the code whose light is nearest in the encoded scale: the next code begins where the curve passes half a
/// code. A table of these thresholds makes it exact, and the same on every machine.
class SrgbEncoder {
 public:
  explicit SrgbEncoder(int largest_code) : thresholds_(static_cast<std::size_t>(largest_code)) {
    for (std::size_t code = 0; code < thresholds_.size(); ++code) {
      thresholds_[code] = image::linear_from_srgb((static_cast<double>(code) + 0.5) / largest_code);
    }
  }

  /// Encodes a value. NaN becomes 0.
  [[nodiscard]] unsigned encode(float value, std::uint64_t& clamped) const {
    if (!(value >= 0.0F && value <= 1.0F)) ++clamped;
    const double light = value > 0.0F ? static_cast<double>(value) : 0.0;
    return static_cast<unsigned>(std::upper_bound(thresholds_.begin(), thresholds_.end(), light) - thresholds_.begin());
  }

 private:
  std::vector<double> thresholds_;
};

/// The target of libspng's write callback; exceptions must not pass through its C code.
struct Sink {
  platform::WholeFile& file;
  std::exception_ptr failure;
};

int write_bytes(spng_ctx* /*context*/, void* user, void* bytes, std::size_t count) {
  Sink& sink = *static_cast<Sink*>(user);
  try {
    sink.file.write(bytes, count);
    return 0;
  } catch (...) {
    sink.failure = std::current_exception();
    return SPNG_IO_ERROR;
  }
}

/// Selects one filter for all rows, and only deflate's search for runs (zlib's Z_RLE). Returns libspng's result.
int choose_speed(spng_ctx* context, spng_filter_choice filter) {
  constexpr int kRuns = 3;
  for (const auto& [option, value] : {std::pair<spng_option, int>{SPNG_FILTER_CHOICE, filter},
                                      {SPNG_IMG_COMPRESSION_LEVEL, 1},
                                      {SPNG_IMG_COMPRESSION_STRATEGY, kRuns}}) {
    const int result = spng_set_option(context, option, value);
    if (result != SPNG_OK) return result;
  }
  return SPNG_OK;
}

/// The form of a PNG to write.
struct PngShape {
  int width;
  int height;
  int bits = 8;
  spng_color_type colour = SPNG_COLOR_TYPE_TRUECOLOR;  ///< without alpha the file states sRGB
  std::optional<spng_filter_choice> quick{};           ///< encoded in a fraction of the time, with this filter
};

class PngEncoder {
 public:
  PngEncoder(platform::WholeFile& file, const PngShape& shape)
      : sink_{file, {}}, context_(spng_ctx_new(SPNG_CTX_ENCODER), spng_ctx_free) {
    if (!context_) throw std::bad_alloc();
    require(spng_set_png_stream(context_.get(), write_bytes, &sink_));
    spng_ihdr header{};
    header.width = static_cast<std::uint32_t>(shape.width);
    header.height = static_cast<std::uint32_t>(shape.height);
    header.bit_depth = static_cast<std::uint8_t>(shape.bits);
    header.color_type = static_cast<std::uint8_t>(shape.colour);
    require(spng_set_ihdr(context_.get(), &header));
    constexpr std::uint8_t kRelativeColorimetric = 1;
    if (shape.colour == SPNG_COLOR_TYPE_TRUECOLOR) require(spng_set_srgb(context_.get(), kRelativeColorimetric));
    if (shape.quick) require(choose_speed(context_.get(), *shape.quick));
    require(
        spng_encode_image(context_.get(), nullptr, 0, SPNG_FMT_PNG, SPNG_ENCODE_PROGRESSIVE | SPNG_ENCODE_FINALIZE));
  }

  void write_row(const void* row, std::size_t bytes, bool last) {
    const int result = spng_encode_row(context_.get(), row, bytes);
    if (!(last && result == SPNG_EOI)) require(result);
  }

 private:
  void require(int result) const {
    if (sink_.failure) std::rethrow_exception(sink_.failure);
    if (result == SPNG_OK) return;
    if (result == SPNG_EMEM) throw std::bad_alloc();
    throw platform::file_error(ErrorCode::invalid_argument, sink_.file.path(),
                               std::string("cannot be written as a PNG: libspng says \"") + spng_strerror(result) +
                                   "\"; write an OpenEXR file (.exr)");
  }

  Sink sink_;
  std::unique_ptr<spng_ctx, void (*)(spng_ctx*)> context_;
};

}  // namespace

std::uint64_t write_png(const OutputImage& image, const WriteJob& job) {
  const int bits = job.type == SampleType::uint16 ? 16 : 8;
  const SrgbEncoder srgb((1 << bits) - 1);
  PngEncoder encoder(job.file, {image.width(), image.height(), bits});
  std::uint64_t clamped = 0;
  const std::size_t values = std::size_t{3} * static_cast<std::size_t>(image.width());
  std::vector<float> rgb(values);
  std::vector<std::uint8_t> bytes(bits == 16 ? 0 : values);
  std::vector<std::uint16_t> words(bits == 16 ? values : 0);  // in the machine's byte order, as libspng expects
  for (int row = 0; row < image.height(); ++row) {
    report_rows(job, row, image.height());
    image.read_row(row, rgb.data());
    for (std::size_t i = 0; i < values; ++i) {
      const unsigned code = srgb.encode(rgb[i], clamped);
      if (bits == 16) {
        words[i] = static_cast<std::uint16_t>(code);
      } else {
        bytes[i] = static_cast<std::uint8_t>(code);
      }
    }
    const void* data = bits == 16 ? static_cast<const void*>(words.data()) : bytes.data();
    encoder.write_row(data, values * static_cast<std::size_t>(bits / 8), row + 1 == image.height());
  }
  return clamped;
}

void write_png_quickly(platform::WholeFile& file, const std::vector<std::uint8_t>& rgb, int width) {
  const std::size_t row_bytes = std::size_t{3} * static_cast<std::size_t>(width);
  const std::size_t rows = rgb.size() / row_bytes;
  PngEncoder encoder(file, {.width = width, .height = static_cast<int>(rows), .quick = SPNG_FILTER_CHOICE_SUB});
  for (std::size_t row = 0; row < rows; ++row) {
    encoder.write_row(rgb.data() + row * row_bytes, row_bytes, row + 1 == rows);
  }
}

std::vector<std::uint8_t> encode_png_rgba(const std::vector<std::uint8_t>& rgba, int size, const stop_token& stop) {
  std::vector<std::byte> png;
  platform::WholeFile file("an image of an .env file", &png);
  // For RGBD of a photograph: a ninth of the time of libspng's choice of filters and zlib's level 6, and 4 % more
  // bytes; Sub instead of Paeth would make it 10 %.
  PngEncoder encoder(file, {size, size, 8, SPNG_COLOR_TYPE_TRUECOLOR_ALPHA, SPNG_FILTER_CHOICE_PAETH});
  const std::size_t row_bytes = std::size_t{4} * static_cast<std::size_t>(size);
  for (int row = 0; row < size; ++row) {
    jobs::throw_if_cancelled(stop);
    encoder.write_row(rgba.data() + row_bytes * static_cast<std::size_t>(row), row_bytes, row + 1 == size);
  }
  file.finish();
  file.commit();
  const auto* const first = reinterpret_cast<const std::uint8_t*>(png.data());
  return {first, first + png.size()};
}

void decode_png_rgba(const EnvImageBytes& image, std::uint8_t* rgba, const stop_token& stop) {
  // Bounds chunks other than pixels (texts, profiles), which are unused; an image with a larger one is refused.
  constexpr std::size_t kMaxOfAChunk = std::size_t{1} << 20U;
  const auto require = [&image](int result) {
    if (result == SPNG_OK) return;
    if (result == SPNG_EMEM) throw std::bad_alloc();
    image.refuse(ErrorCode::corrupt_file, std::string("is a damaged PNG: libspng says \"") + spng_strerror(result) +
                                              "\"; fetch or export the file again");
  };
  const std::unique_ptr<spng_ctx, void (*)(spng_ctx*)> context(spng_ctx_new(0), spng_ctx_free);
  if (!context) throw std::bad_alloc();
  require(spng_set_chunk_limits(context.get(), kMaxOfAChunk, kMaxOfAChunk));
  require(spng_set_png_buffer(context.get(), image.bytes.data(), image.bytes.size()));
  spng_ihdr header{};
  require(spng_get_ihdr(context.get(), &header));
  image.require_size(header.width, header.height);
  constexpr int flags = SPNG_DECODE_TRNS | SPNG_DECODE_PROGRESSIVE;
  require(spng_decode_image(context.get(), nullptr, 0, SPNG_FMT_RGBA8, flags));
  const std::size_t row_bytes = std::size_t{4} * header.width;
  for (int result = SPNG_OK; result != SPNG_EOI;) {  // an interlaced image's rows come several times
    jobs::throw_if_cancelled(stop);
    spng_row_info row{};
    require(spng_get_row_info(context.get(), &row));
    result = spng_decode_row(context.get(), rgba + row_bytes * row.row_num, row_bytes);
    if (result != SPNG_EOI) require(result);
  }
}

}  // namespace welkin::files
