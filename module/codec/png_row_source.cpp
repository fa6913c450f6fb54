#include "codec/png_row_source.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "codec/layout.h"
#include "codec/png_decoder.h"
#include "codec/png_samples.h"
#include "codec/stated_primaries.h"

namespace welkin::codec {
namespace {

// What libspng and zlib hold beside rows: a window of 32 KiB, tables, buffers of 8 KiB, the stream's own.
constexpr std::uint64_t kOfLibraries = std::uint64_t{128} << 10U;

class PngReader final : public RowReader {
 public:
  PngReader(std::filesystem::path path, const PngHeader& header, const PngSamples& samples)
      : path_(std::move(path)), header_(header), samples_(samples) {
    open();
    const std::size_t rows = header.interlaced ? static_cast<std::size_t>(header.height) : 1;
    coded_ = std::make_unique_for_overwrite<std::uint8_t[]>(header.row_bytes() * rows);
  }

  void read(int first_row, int row_count, float* rgb) override {
    const auto width = static_cast<std::size_t>(header_.width);
    if (header_.interlaced) {
      if (next_row_ == 0) {
        decoder_->decode_all(coded_.get());
        next_row_ = header_.height;
      }
      samples_.convert(coded_.get() + header_.row_bytes() * static_cast<std::size_t>(first_row),
                       width * static_cast<std::size_t>(row_count), rgb);
      return;
    }
    go_to(first_row);
    for (int row = 0; row < row_count; ++row) {
      next();
      samples_.convert(coded_.get(), width, rgb + static_cast<std::size_t>(row) * 3 * width);
    }
  }

 private:
  // If the file is another one by now, its rows may not fit where they would go.
  void open() {
    decoder_ = std::make_unique<PngDecoder>(path_);
    next_row_ = 0;
    const PngHeader& found = decoder_->header();
    if (found.width != header_.width || found.height != header_.height || found.bits != header_.bits ||
        found.interlaced != header_.interlaced) {
      throw file_error(ErrorCode::file_access, path_, "has changed while it was read; read it again");
    }
  }

  void go_to(int row) {
    if (row < next_row_) {
      open();
    }
    while (next_row_ < row) {
      next();
    }
  }

  void next() {
    decoder_->decode_row(coded_.get());
    ++next_row_;
  }

  std::filesystem::path path_;
  const PngHeader& header_;
  const PngSamples& samples_;
  std::unique_ptr<PngDecoder> decoder_;
  std::unique_ptr<std::uint8_t[]> coded_;  // a row, or all of them
  int next_row_ = 0;
};

class PngSource final : public RowSource {
 public:
  PngSource(EnvironmentInfo info, const PngHeader& header, PngSamples samples, std::uint64_t memory_limit_bytes)
      : RowSource(std::move(info)),
        header_(header),
        samples_(std::move(samples)),
        memory_limit_bytes_(memory_limit_bytes) {}

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
    if (header_.interlaced && reader_bytes() > memory_limit_bytes_) {
      throw file_error(ErrorCode::limit_exceeded, info().path,
                       "is interlaced, so that it must be decoded whole: that takes " + std::to_string(reader_bytes()) +
                           " bytes, above the limit of " + std::to_string(memory_limit_bytes_) +
                           "; raise the limit, or save it without interlacing");
    }
    return std::make_unique<PngReader>(info().path, header_, samples_);
  }

 private:
  PngHeader header_;
  PngSamples samples_;
  std::uint64_t memory_limit_bytes_;
};

void list_channels(EnvironmentInfo& info, const PngHeader& header) {
  const std::string type = "uint" + std::to_string(header.palette ? 8 : header.bits);
  const std::vector<const char*> names = header.grey ? std::vector{"Y"} : std::vector{"R", "G", "B"};
  for (const char* name : names) {
    info.channels.push_back({name, type});
  }
  if (header.alpha) {
    info.channels.push_back({"A", type});
    info.notes.emplace_back("alpha is ignored: colours are taken as they are");
  }
}

std::string as_text(double value) {
  std::array<char, 32> text{};
  return {text.data(), std::to_chars(text.data(), text.data() + text.size(), value).ptr};
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
    info.notes.emplace_back(asked_for == Transfer::linear ? "samples are taken as linear, as was asked for"
                                                          : "samples are taken as sRGB, as was asked for");
    return asked_for;
  }
  if (says_linear(header)) {
    info.notes.emplace_back("samples are taken as linear: the gAMA chunk says 1");
    return Transfer::linear;
  }
  std::string reason = header.says_srgb ? ": the sRGB chunk says so" : ": nothing in the file says otherwise";
  if (header.gamma && !header.says_srgb) {
    const bool close_to_srgb = std::abs(*header.gamma - 1.0 / 2.2) < 0.01;
    reason = close_to_srgb ? ": the gAMA chunk says nearly so"
                           : "; its gAMA of " + as_text(*header.gamma) + " is not applied: convert it if it is right";
  }
  info.notes.push_back("samples are taken as sRGB" + reason);
  return Transfer::srgb;
}

// deflate makes at best 1032 bytes of one (zlib's technical notes).
void require_plausible_size(const ByteFile& file, const PngHeader& header) {
  const std::uint64_t samples = header.palette || header.grey ? 1 : 3;
  const std::uint64_t bits = samples * static_cast<std::uint64_t>(header.bits) *
                             static_cast<std::uint64_t>(header.width) * static_cast<std::uint64_t>(header.height);
  const std::uint64_t wanted = bits / 8 / 1032;
  if (wanted > file.size()) {
    throw file_error(ErrorCode::corrupt_file, file.path(),
                     "ends too early: " + std::to_string(header.width) + " x " + std::to_string(header.height) +
                         " texels of a PNG take at least " + std::to_string(wanted) + " bytes, and the file has " +
                         std::to_string(file.size()) + "; fetch or export it again");
  }
}

}  // namespace

std::unique_ptr<RowSource> open_png(ByteFile& file, const ReadOptions& options) {
  const PngHeader header = PngDecoder(file.path()).header();
  require_plausible_size(file, header);

  EnvironmentInfo info;
  info.path = file.path();
  info.format = "PNG";
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
  return std::make_unique<PngSource>(std::move(info), header, PngSamples(header.bits == 16, transfer, matrix),
                                     options.memory_limit_bytes);
}

}  // namespace welkin::codec
