#include "codec/texture_row_source.h"

#include <algorithm>
#include <string>
#include <utility>

#include "codec/cube_levels.h"
#include "codec/roughness_key.h"
#include "codec/texture_reader.h"

namespace welkin::codec {
namespace {

constexpr int kRowsAtOnce = 16;

class TextureRowReader final : public RowReader {
 public:
  TextureRowReader(const std::filesystem::path& path, const TextureLayout& layout, int level)
      : reader_(path, layout), level_(level), size_(layout.level_size(level)) {}

  void read(int first_row, int row_count, float* rgb) override {
    const int end = first_row + row_count;
    for (int row = first_row; row < end;) {
      const int face = row / size_;
      const int rows = std::min({end - row, (face + 1) * size_ - row, kRowsAtOnce});
      reader_.read(level_, face, row % size_, rows, rgb);
      rgb += rgb_bytes(size_, rows) / sizeof(float);
      row += rows;
    }
  }

 private:
  TextureReader reader_;
  int level_;
  int size_;
};

class TextureSource final : public RowSource {
 public:
  TextureSource(EnvironmentInfo info, TextureLayout layout, int level)
      : RowSource(std::move(info)), layout_(std::move(layout)), level_(level) {}

  [[nodiscard]] int natural_rows() const override { return is_packed() ? info().height : 1; }
  [[nodiscard]] bool has_prefiltered_levels() const override {
    if (!layout_.has_metadata) return true;  // DDS cannot say, and what tools for light write as DDS mostly is
    return std::any_of(layout_.metadata.begin(), layout_.metadata.end(),
                       [](const auto& entry) { return speaks_of_roughness(entry.first); });
  }
  [[nodiscard]] std::uint64_t reader_bytes() const override {
    return texture_reader_bytes(layout_, level_, kRowsAtOnce);
  }
  [[nodiscard]] const char* smaller_reader() const override {
    return is_packed() ? "save it without supercompression: a packed level must be unpacked whole"
                       : RowSource::smaller_reader();
  }
  [[nodiscard]] std::unique_ptr<RowReader> open_reader() const override {
    return std::make_unique<TextureRowReader>(info().path, layout_, level_);
  }

 private:
  [[nodiscard]] bool is_packed() const { return layout_.supercompression != Supercompression::none; }

  TextureLayout layout_;
  int level_;
};

const char* channel_type(TexelKind kind, std::size_t channel) {
  switch (kind) {
    case TexelKind::rgba16f: return "half";
    case TexelKind::rgba32f: return "float";
    case TexelKind::b10g11r11: return channel == 2 ? "ufloat10" : "ufloat11";
    case TexelKind::e5b9g9r9: return "shared exponent";
    case TexelKind::rgba8:
    case TexelKind::rgba8_srgb: return "uint8";
  }
  return "";
}

void list_channels(EnvironmentInfo& info, TexelKind kind) {
  const bool alpha = kind != TexelKind::b10g11r11 && kind != TexelKind::e5b9g9r9;
  constexpr std::array names{"R", "G", "B", "A"};
  for (std::size_t channel = 0; channel < (alpha ? 4U : 3U); ++channel) {
    info.channels.push_back({names[channel], channel_type(kind, channel)});
  }
}

TexelKind with_transfer(TexelKind kind, Transfer asked_for, EnvironmentInfo& info) {
  if (kind != TexelKind::rgba8 && kind != TexelKind::rgba8_srgb) return kind;
  if (asked_for == Transfer::automatic) {
    info.notes.emplace_back(kind == TexelKind::rgba8 ? "samples are taken as linear: the format says so"
                                                     : "samples are taken as sRGB: the format says so");
    return kind;
  }
  info.notes.emplace_back(asked_for == Transfer::linear ? "samples are taken as linear, as was asked for"
                                                        : "samples are taken as sRGB, as was asked for");
  return asked_for == Transfer::linear ? TexelKind::rgba8 : TexelKind::rgba8_srgb;
}

}  // namespace

std::unique_ptr<RowSource> open_texture(ByteFile& file, const ReadOptions& options) {
  TextureLayout layout = read_texture_layout(file);
  EnvironmentInfo info;
  info.path = file.path();
  info.format = layout.container;
  info.compression = name(layout.supercompression);
  info.storage = name(layout.kind);
  layout.kind = with_transfer(layout.kind, options.transfer, info);
  list_channels(info, layout.kind);
  settle_cube(info, layout.size, static_cast<int>(layout.levels.size()), options);
  const auto orientation = layout.metadata.find("KTXorientation");
  if (orientation != layout.metadata.end() && orientation->second != "rd") {
    info.notes.push_back("its KTXorientation of \"" + printable(orientation->second) +
                         "\" is not applied: rows are taken from the top");
  }
  auto source = std::make_unique<TextureSource>(std::move(info), std::move(layout), options.level);
  return source;
}

}  // namespace welkin::codec
