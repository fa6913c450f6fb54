// PNG through libspng: environments as rows.
#include <spng.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <exception>
#include <glm/mat3x3.hpp>
#include <memory>
#include <new>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "files/codecs.h"
#include "files/layout.h"
#include "files/primaries.h"
#include "files/row_source.h"
#include "image/pixels.h"
#include "platform/file.h"
#include "platform/standard_library.h"
#include "platform/text.h"

namespace welkin::files {
namespace {

constexpr std::uint64_t kChecksumBytes = 4;

std::uint64_t big_endian(const char* bytes) {
  std::uint64_t value = 0;
  for (int i = 0; i < 4; ++i) {
    value = value << 8U | static_cast<unsigned char>(bytes[i]);
  }
  return value;
}

// A type whose first letter is upper case is critical: the decoder must support or refuse it.
bool is_wanted(std::string_view type) {
  return (static_cast<unsigned char>(type[0]) & 0x20U) == 0 || type == "gAMA" || type == "sRGB" || type == "cHRM";
}

// Skips bytes. Seeking costs a system call; reading a few bytes is cheaper.
void pass_over(platform::ByteFile& file, std::uint64_t count) {
  std::array<char, 512> bytes{};
  if (count <= bytes.size() && count <= file.remaining()) {
    file.read(bytes.data(), count);
  } else {
    file.seek(file.position() + count);
  }
}

/// The file's signature and chunks, without ancillary chunks other than gAMA, sRGB and cHRM. Texts, profiles and
/// previews can be megabytes; a decoder that would keep them, or fail on a malformed one, never sees them. A PNG's
/// chunk is a length, a type, that many bytes, and a checksum. (PNG specification, third edition, 5.3.)
class PngStream {
 public:
  explicit PngStream(const FileInput& input) : file_(open_file(input)) {}

  /// Reads the next `count` bytes. Throws the errors of `ByteFile::read`.
  void read(void* bytes, std::size_t count) {
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

  [[nodiscard]] const platform::ByteFile& file() const noexcept { return file_; }

  // Return true once such a chunk was skipped, which is noted.
  [[nodiscard]] bool has_profile() const noexcept { return has_profile_; }            ///< iCCP
  [[nodiscard]] bool has_transparency() const noexcept { return has_transparency_; }  ///< tRNS
  [[nodiscard]] bool has_code_points() const noexcept { return has_code_points_; }    ///< cICP

 private:
  void next_chunk() {
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

  platform::ByteFile file_;
  std::array<char, 8> start_{};  // signature, or a chunk's length and type
  std::size_t start_used_ = 8;   // bytes of `start_` that were read
  std::uint64_t body_left_ = 0;  // bytes and checksum of the current chunk
  bool signature_is_out_ = false;
  bool has_profile_ = false, has_transparency_ = false, has_code_points_ = false;
};

// libspng, one row after the other.

struct PngHeader {
  int width = 0;
  int height = 0;
  int bits = 8;  ///< per sample in the file: 1, 2, 4, 8 or 16
  bool grey = false;
  bool palette = false;
  bool alpha = false;  ///< as a channel, or as the transparent colours of a tRNS chunk
  bool interlaced = false;
  bool says_srgb = false;                   ///< has an sRGB chunk
  bool has_profile = false;                 ///< has an iCCP chunk
  bool has_code_points = false;             ///< has a cICP chunk
  std::optional<double> gamma;              ///< of the gAMA chunk: the exponent from light to samples; 1 is linear
  std::optional<Chromaticities> primaries;  ///< of the cHRM chunk

  /// Returns the bytes per texel of decoded rows.
  [[nodiscard]] std::size_t texel_bytes() const noexcept { return bits == 16 ? 8 : 3; }
  [[nodiscard]] std::size_t row_bytes() const noexcept { return texel_bytes() * static_cast<std::size_t>(width); }
};

/// Rows come as RGB of 8 bits, or, from samples of 16 bits, as RGBA of 16 in the machine's byte order. Greys become
/// three equal samples, palettes their colours, and samples of fewer bits are spread to 0 .. 255, which is exact.
class PngDecoder {
 public:
  /// Reads up to the pixels. Throws `Error`: file_access, corrupt_file, unsupported_file.
  explicit PngDecoder(const FileInput& input) : stream_(input), context_(spng_ctx_new(0)) {
    if (context_ == nullptr) {
      throw std::bad_alloc();
    }
    check(spng_set_png_stream(context_.get(), &PngDecoder::read_stream, this));
    read_header();
  }

  PngDecoder(const PngDecoder&) = delete;  // libspng holds a pointer to this
  PngDecoder& operator=(const PngDecoder&) = delete;

  [[nodiscard]] const PngHeader& header() const noexcept { return header_; }

  /// Decodes the next row, from the top, to `header().row_bytes()` bytes. Not for an interlaced image. With the last
  /// row the file is read to its end, which verifies its checksums. Throws `Error`: corrupt_file, file_access.
  void decode_row(void* row) {
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

  /// Decodes all rows of any image at once; called once, and instead of `decode_row`. Throws the same errors.
  void decode_all(void* rows) {
    const std::size_t bytes = header_.row_bytes() * static_cast<std::size_t>(header_.height);
    check(spng_decode_image(context_.get(), rows, bytes, format(), 0));
    check(spng_decode_chunks(context_.get()));
  }

 private:
  struct Free {
    void operator()(spng_ctx* context) const noexcept { spng_ctx_free(context); }
  };

  // Called by a library without exceptions: a thrown one is kept until `check`.
  static int read_stream(spng_ctx* /*context*/, void* decoder, void* bytes, std::size_t count) noexcept {
    auto* self = static_cast<PngDecoder*>(decoder);
    try {
      self->stream_.read(bytes, count);
      return 0;
    } catch (...) {
      self->stream_failure_ = std::current_exception();
      return SPNG_IO_ERROR;
    }
  }

  void check(int result) {
    if (stream_failure_) {
      std::rethrow_exception(stream_failure_);
    }
    if (result == SPNG_OK) {
      return;
    }
    if (result == SPNG_EMEM) {
      throw std::bad_alloc();
    }
    // libspng reads a row ahead.
    const std::string where =
        next_row_ > 0 ? "near row " + std::to_string(next_row_) + " of " + std::to_string(header_.height) + ", " : "";
    const platform::ByteFile& file = stream_.file();
    throw platform::file_error(ErrorCode::corrupt_file, file.path(),
                               "is a damaged PNG: " + where + "at byte " + std::to_string(file.position()) +
                                   ", libspng says \"" + spng_strerror(result) + "\"; fetch or export it again");
  }

  void read_header() {
    spng_ihdr basic{};
    check(spng_get_ihdr(context_.get(), &basic));
    if (basic.width > static_cast<std::uint32_t>(kMaximumWidth) ||
        basic.height > static_cast<std::uint32_t>(kMaximumHeight)) {
      throw platform::file_error(ErrorCode::unsupported_file, stream_.file().path(),
                                 "its " + std::to_string(basic.width) + " x " + std::to_string(basic.height) +
                                     " texels are more than " + std::to_string(kMaximumWidth) + " x " +
                                     std::to_string(kMaximumHeight) + "; reduce the image first");
    }
    // Reads to the first pixels; only then are the flags of the stream those of the whole header.
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

  [[nodiscard]] int format() const noexcept { return header_.bits == 16 ? SPNG_FMT_RGBA16 : SPNG_FMT_RGB8; }

  PngStream stream_;
  std::exception_ptr stream_failure_;
  std::unique_ptr<spng_ctx, Free> context_;
  PngHeader header_;
  int next_row_ = 0;
};

// Conversion of samples to RGB floats.

/// A sample of n bits is sample / (2^n - 1), through sRGB's curve or not, rounded once to float: a table of 256 or
/// 65536 values, computed here and the same on every machine.
class PngSamples {
 public:
  /// `sixteen_bits`: RGBA of 16 bits in the machine's byte order; else RGB of 8. `transfer` is srgb or linear. Texels
  /// are multiplied by `matrix` in double, if there is one.
  PngSamples(bool sixteen_bits, Transfer transfer, const std::optional<glm::dmat3>& matrix)
      : sixteen_bits_(sixteen_bits), table_(sixteen_bits ? 65536 : 256), matrix_(matrix) {
    const auto largest = static_cast<double>(table_.size() - 1);
    for (std::size_t i = 0; i < table_.size(); ++i) {
      const double encoded = static_cast<double>(i) / largest;
      table_[i] = static_cast<float>(transfer == Transfer::srgb ? image::linear_from_srgb(encoded) : encoded);
    }
  }

  /// `coded`: `count` texels, of 3 or 8 bytes, at any address.
  void convert(const std::uint8_t* coded, std::size_t count, float* rgb) const noexcept {
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

  [[nodiscard]] std::uint64_t memory_bytes() const noexcept { return table_.size() * sizeof(float); }

 private:
  bool sixteen_bits_;
  std::vector<float> table_;
  std::optional<glm::dmat3> matrix_;
};

// Memory of libspng and zlib without rows: a window of 32 KiB, tables, buffers of 8 KiB, and the stream.
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

  // If the file was replaced meanwhile, its rows may not fit their memory.
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

  const FileInput& input_;  // of the source
  const PngHeader& header_;
  const PngSamples& samples_;
  std::unique_ptr<PngDecoder> decoder_;
  std::unique_ptr<std::uint8_t[]> coded_;  // a row, or all of them
  bool holds_all_ = false;                 // of an interlaced image
};

RowTraits png_traits(const PngHeader& header, const PngSamples& samples) {
  const auto rows = static_cast<std::uint64_t>(header.interlaced ? header.height : 1);
  constexpr std::uint64_t of_libspng = 3;
  RowTraits traits{.sequential = true};
  traits.reader_bytes = header.row_bytes() * (rows + of_libspng) + samples.memory_bytes() + kOfLibraries;
  if (header.interlaced) traits.smaller_reader = "save it without interlacing: as it is, it must be decoded whole";
  return traits;
}

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

// Decides the transfer function of the samples, and notes the reason.
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

// deflate yields at most 1032 bytes per byte (zlib's technical notes).
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
  const PngSamples samples(header.bits == 16, transfer, matrix);
  const auto open = [input = input_of(file), header, samples] {
    return std::make_unique<PngReader>(input, header, samples);
  };
  return std::make_unique<RowSource>(std::move(info), png_traits(header, samples), open);
}

}  // namespace welkin::files
