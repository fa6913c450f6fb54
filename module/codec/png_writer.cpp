// PNG through libspng: sRGB, 8 or 16 bits a channel, no alpha.
#include <spng.h>

#include <algorithm>
#include <cmath>
#include <exception>
#include <memory>
#include <new>
#include <string>
#include <vector>

#include "codec/byte_file.h"
#include "codec/output_picture.h"
#include "image/formats.h"

namespace welkin::codec {
namespace {

/// Encodes to the code whose light is nearest in the encoded scale: where the curve passes half a code, the next one
/// begins. A table of those places makes it exact, and the same on every machine.
class SrgbEncoder {
 public:
  explicit SrgbEncoder(int largest_code) : thresholds_(static_cast<std::size_t>(largest_code)) {
    for (std::size_t code = 0; code < thresholds_.size(); ++code) {
      thresholds_[code] = image::linear_from_srgb((static_cast<double>(code) + 0.5) / largest_code);
    }
  }

  /// NaN becomes 0.
  [[nodiscard]] unsigned encode(float value, std::uint64_t& clamped) const {
    if (!(value >= 0.0F && value <= 1.0F)) ++clamped;
    const double light = value > 0.0F ? static_cast<double>(value) : 0.0;
    return static_cast<unsigned>(std::upper_bound(thresholds_.begin(), thresholds_.end(), light) - thresholds_.begin());
  }

 private:
  std::vector<double> thresholds_;
};

/// What libspng calls to write; exceptions must not pass through its C code.
struct Sink {
  WholeFile& file;
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

class PngEncoder {
 public:
  PngEncoder(WholeFile& file, int width, int height, int bits)
      : sink_{file, {}}, context_(spng_ctx_new(SPNG_CTX_ENCODER), spng_ctx_free) {
    if (!context_) throw std::bad_alloc();
    require(spng_set_png_stream(context_.get(), write_bytes, &sink_));
    spng_ihdr header{};
    header.width = static_cast<std::uint32_t>(width);
    header.height = static_cast<std::uint32_t>(height);
    header.bit_depth = static_cast<std::uint8_t>(bits);
    header.color_type = SPNG_COLOR_TYPE_TRUECOLOR;
    require(spng_set_ihdr(context_.get(), &header));
    constexpr std::uint8_t kRelativeColorimetric = 1;
    require(spng_set_srgb(context_.get(), kRelativeColorimetric));
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
    throw file_error(ErrorCode::invalid_argument, sink_.file.path(),
                     std::string("cannot be written as a PNG: libspng says \"") + spng_strerror(result) +
                         "\"; write an OpenEXR file (.exr)");
  }

  Sink sink_;
  std::unique_ptr<spng_ctx, void (*)(spng_ctx*)> context_;
};

}  // namespace

std::uint64_t write_png(const OutputPicture& picture, const WriteJob& job) {
  const int bits = job.type == SampleType::uint16 ? 16 : 8;
  const SrgbEncoder srgb((1 << bits) - 1);
  PngEncoder encoder(job.file, picture.width(), picture.height(), bits);
  std::uint64_t clamped = 0;
  const std::size_t values = std::size_t{3} * static_cast<std::size_t>(picture.width());
  std::vector<float> rgb(values);
  std::vector<std::uint8_t> bytes(bits == 16 ? 0 : values);
  std::vector<std::uint16_t> words(bits == 16 ? values : 0);  // in the machine's byte order, as libspng takes them
  for (int row = 0; row < picture.height(); ++row) {
    report_rows(job, row, picture.height());
    picture.read_row(row, rgb.data());
    for (std::size_t i = 0; i < values; ++i) {
      const unsigned code = srgb.encode(rgb[i], clamped);
      if (bits == 16) {
        words[i] = static_cast<std::uint16_t>(code);
      } else {
        bytes[i] = static_cast<std::uint8_t>(code);
      }
    }
    const void* data = bits == 16 ? static_cast<const void*>(words.data()) : bytes.data();
    encoder.write_row(data, values * static_cast<std::size_t>(bits / 8), row + 1 == picture.height());
  }
  return clamped;
}

}  // namespace welkin::codec
