// PNG through libspng: environments as rows (written as sRGB, 8 or 16 bits a channel, no alpha), and the small images
// of .env files.
#include "files/png.h"

#include <spng.h>

#include <algorithm>
#include <cmath>
#include <exception>
#include <memory>
#include <new>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "files/codecs.h"
#include "files/env.h"
#include "files/layout.h"
#include "files/primaries.h"
#include "files/write_environment.h"
#include "image/pixels.h"
#include "jobs/control.h"
#include "platform/file.h"
#include "platform/standard_library.h"
#include "platform/text.h"

namespace welkin::files {
namespace {

// What libspng and zlib hold beside rows: a window of 32 KiB, tables, buffers of 8 KiB, the stream's own.
constexpr std::uint64_t kOfLibraries = std::uint64_t{128} << 10U;

class PngReader final : public SequentialReader {
 public:
  PngReader(const FileInput& input, const PngHeader& header, const PngSamples& samples)
      : SequentialReader(header.width), input_(input), header_(header), samples_(samples) {
    open();
    const std::size_t rows = header.interlaced ? static_cast<std::size_t>(header.height) : 1;
    coded_ = platform::make_unique_for_overwrite<std::uint8_t[]>(header.row_bytes() * rows);
  }

  void read(int first_row, int row_count, float* rgb) override {
    if (!header_.interlaced) return SequentialReader::read(first_row, row_count, rgb);
    if (!std::exchange(holds_all_, true)) decoder_->decode_all(coded_.get());
    samples_.convert(coded_.get() + header_.row_bytes() * static_cast<std::size_t>(first_row),
                     static_cast<std::size_t>(header_.width) * static_cast<std::size_t>(row_count), rgb);
  }

 private:
  void restart() override { open(); }

  // If the file is another one by now, its rows may not fit where they would go.
  void open() {
    decoder_ = std::make_unique<PngDecoder>(input_);
    const PngHeader& found = decoder_->header();
    if (found.width != header_.width || found.height != header_.height || found.bits != header_.bits ||
        found.interlaced != header_.interlaced) {
      throw platform::file_error(ErrorCode::file_access, input_.path(), "has changed while it was read; read it again");
    }
  }

  void next(int /*row*/, float* rgb) override {
    decoder_->decode_row(coded_.get());
    if (rgb != nullptr) samples_.convert(coded_.get(), static_cast<std::size_t>(header_.width), rgb);
  }

  const FileInput& input_;  // the source's
  const PngHeader& header_;
  const PngSamples& samples_;
  std::unique_ptr<PngDecoder> decoder_;
  std::unique_ptr<std::uint8_t[]> coded_;  // a row, or all of them
  bool holds_all_ = false;                 // of an interlaced image
};

class PngSource final : public RowSource {
 public:
  PngSource(EnvironmentInfo info, FileInput input, const PngHeader& header, PngSamples samples)
      : RowSource(std::move(info), std::move(input)), header_(header), samples_(std::move(samples)) {}

  [[nodiscard]] int natural_rows() const override { return 1; }
  [[nodiscard]] bool sequential() const override { return true; }

  // Three rows are libspng's.
  [[nodiscard]] std::uint64_t reader_bytes() const override {
    const auto rows = static_cast<std::uint64_t>(header_.interlaced ? header_.height : 1);
    return header_.row_bytes() * (rows + 3) + samples_.memory_bytes() + kOfLibraries;
  }

  [[nodiscard]] const char* smaller_reader() const override {
    return header_.interlaced ? "save it without interlacing: as it is, it must be decoded whole"
                              : RowSource::smaller_reader();
  }

  [[nodiscard]] std::unique_ptr<RowReader> open_reader() const override {
    return std::make_unique<PngReader>(input(), header_, samples_);
  }

 private:
  PngHeader header_;
  PngSamples samples_;
};

ChannelType type_of_samples(const PngHeader& header) {
  if (header.palette) return ChannelType::uint8;
  switch (header.bits) {
    case 1: return ChannelType::uint1;
    case 2: return ChannelType::uint2;
    case 4: return ChannelType::uint4;
    case 16: return ChannelType::uint16;
    default: return ChannelType::uint8;
  }
}

void list_channels(EnvironmentInfo& info, const PngHeader& header) {
  const ChannelType type = type_of_samples(header);
  add_channels(info, header.grey ? "Y" : "RGB", type);
  if (header.alpha) {
    info.channels.push_back({"A", type});
    info.notes.emplace_back("alpha is ignored");
  }
}

bool says_linear(const PngHeader& header) {
  return header.gamma && !header.says_srgb && std::abs(*header.gamma - 1.0) < 0.01;
}

// What the samples mean, and a note of what told it.
Transfer decide_transfer(const PngHeader& header, Transfer asked_for, EnvironmentInfo& info) {
  if (header.has_code_points) {
    info.notes.emplace_back("its cICP chunk (video colour) is not applied");
  }
  if (header.has_profile) {
    info.notes.emplace_back("its ICC profile is not applied");
  }
  if (asked_for != Transfer::automatic) {
    info.notes.emplace_back(asked_for == Transfer::linear ? "samples are read as linear, as requested"
                                                          : "samples are read as sRGB, as requested");
    return asked_for;
  }
  if (says_linear(header)) {
    info.notes.emplace_back("samples are read as linear, because the gAMA chunk is 1");
    return Transfer::linear;
  }
  std::string reason = header.says_srgb ? ", as the sRGB chunk states" : ", the default";
  if (header.gamma && !header.says_srgb) {
    const bool close_to_srgb = std::abs(*header.gamma - 1.0 / 2.2) < 0.01;
    reason = close_to_srgb ? ", as the gAMA chunk nearly states"
                           : "; its gAMA of " + platform::number_text(*header.gamma) +
                                 " is not applied: convert it if it is right";
  }
  info.notes.push_back("samples are read as sRGB" + reason);
  return Transfer::srgb;
}

// deflate makes at best 1032 bytes of one (zlib's technical notes).
void require_plausible_size(const platform::ByteFile& file, const PngHeader& header) {
  const std::uint64_t samples = header.palette || header.grey ? 1 : 3;
  const std::uint64_t bits = samples * static_cast<std::uint64_t>(header.bits) *
                             static_cast<std::uint64_t>(header.width) * static_cast<std::uint64_t>(header.height);
  const std::uint64_t wanted = bits / 8 / 1032;
  if (wanted > file.size()) {
    throw platform::file_error(ErrorCode::corrupt_file, file.path(),
                               "ends too early: " + std::to_string(header.width) + " x " +
                                   std::to_string(header.height) + " texels of a PNG take at least " +
                                   std::to_string(wanted) + " bytes, and the file has " + std::to_string(file.size()) +
                                   "; fetch or export it again");
  }
}

}  // namespace

std::unique_ptr<RowSource> open_png(platform::ByteFile& file, const ReadOptions& options) {
  const PngHeader header = PngDecoder(input_of(file)).header();
  require_plausible_size(file, header);

  EnvironmentInfo info;
  info.path = file.path();
  info.format = FileFormat::png;
  info.compression = "deflate";
  info.storage = header.interlaced ? "interlaced" : "scanline";
  info.width = header.width;
  info.height = header.height;
  list_channels(info, header);
  const Transfer transfer = decide_transfer(header, options.transfer, info);
  const std::optional<glm::dmat3> matrix =
      header.primaries && !header.says_srgb
          ? rec709_from_stated(*header.primaries, "the cHRM chunk", options.primaries, info)
          : std::nullopt;
  decide_layout(info, options.layout, std::nullopt);
  return std::make_unique<PngSource>(std::move(info), input_of(file), header,
                                     PngSamples(header.bits == 16, transfer, matrix));
}

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

/// One filter for all rows, and of deflate only the search for runs (zlib's Z_RLE). Returns libspng's result.
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

/// What a PNG is to be.
struct PngShape {
  int width;
  int height;
  int bits = 8;
  spng_color_type colour = SPNG_COLOR_TYPE_TRUECOLOR;  ///< without alpha it says that it is sRGB
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
  std::vector<std::uint16_t> words(bits == 16 ? values : 0);  // in the machine's byte order, as libspng takes them
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
  // Over RGBD of a photograph: a ninth of the time of libspng's own choice of filters and zlib's level 6, and 4 % more
  // bytes; Sub for Paeth would make it 10 %.
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
  // Texts and profiles beside the pixels, which nobody here wants; beyond it the image is refused.
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
