#include <algorithm>
#include <array>
#include <limits>
#include <string>
#include <string_view>
#include <utility>

#include "files/layout.h"
#include "files/textures.h"
#include "image/bc6h.h"
#include "image/pixels.h"
#include "image/uastc_hdr.h"
#include "jobs/control.h"
#include "jobs/tiles.h"
#include "platform/float_environment.h"
#include "platform/text.h"
#include "welkin/image.h"

namespace welkin::files {
namespace {

template <typename Unpack>
void decode_packed(const std::uint8_t* texels, std::size_t count, float* rgb, const Unpack& unpack) noexcept {
  for (std::size_t i = 0; i < count; ++i, rgb += 3, texels += 4) {
    const std::array<float, 3> texel = unpack(platform::read_little_endian<std::uint32_t>(texels));
    std::memcpy(rgb, texel.data(), sizeof texel);
  }
}

using Channel = ChannelType;

// Indexed by TexelKind.
constexpr std::array kKinds{
    KindTraits{"rgba16f", 8, 1, 2, 97, 10, PixelFormat::rgba16f, Channel::half, 4},
    KindTraits{"rgba32f", 16, 1, 4, 109, 2, PixelFormat::rgba32f, Channel::float32, 4},
    KindTraits{"b10g11r11", 4, 1, 4, 122, 26, std::nullopt, Channel::ufloat11, 3},
    KindTraits{"e5b9g9r9", 4, 1, 4, 123, 67, std::nullopt, Channel::shared_exponent, 3},
    KindTraits{"bc6h ufloat", 16, image::kBlockEdge, 1, 143, 95, std::nullopt, Channel::half, 3},
    KindTraits{"bc6h sfloat", 16, image::kBlockEdge, 1, 144, 96, std::nullopt, Channel::half, 3},
    KindTraits{"astc 4x4 hdr", 16, 4, 1, 1000066000, 0, std::nullopt, Channel::half, 3},
    KindTraits{"astc 6x6 hdr", 16, 6, 1, 1000066004, 0, std::nullopt, Channel::half, 3},
    KindTraits{"uastc hdr 4x4", 16, 4, 1, 1000066000, 0, std::nullopt, Channel::half, 3},
    KindTraits{"rgba8", 4, 1, 1, 37, 28, PixelFormat::rgba8, Channel::uint8, 4},
    KindTraits{"rgba8 srgb", 4, 1, 1, 43, 29, PixelFormat::srgba8, Channel::uint8, 4},
    KindTraits{"rgb16f", 6, 1, 2, 90, 0, PixelFormat::rgb16f, Channel::half, 3},
    KindTraits{"rgb32f", 12, 1, 4, 106, 0, PixelFormat::rgb32f, Channel::float32, 3},
    KindTraits{"rgb8", 3, 1, 1, 23, 0, PixelFormat::rgb8, Channel::uint8, 3},
    KindTraits{"rgb8 srgb", 3, 1, 1, 29, 0, PixelFormat::srgb8, Channel::uint8, 3},
};
static_assert(kKinds.size() == static_cast<std::size_t>(TexelKind::rgb8_srgb) + 1);

}  // namespace

const KindTraits& traits(TexelKind kind) noexcept { return kKinds[static_cast<std::size_t>(kind)]; }

std::optional<TexelKind> kind_with(std::uint32_t KindTraits::*member, std::uint32_t number) noexcept {
  const auto found =
      std::find_if(kKinds.begin(), kKinds.end(), [&](const KindTraits& known) { return known.*member == number; });
  if (number == 0 || found == kKinds.end()) return std::nullopt;
  return static_cast<TexelKind>(found - kKinds.begin());
}

ByteRange row_byte_range(TexelKind kind, int size, int first_row, int rows) noexcept {
  const int edge = block_edge(kind);
  const std::uint64_t row = static_cast<std::uint64_t>((size + edge - 1) / edge) * texel_bytes(kind);
  const auto first = static_cast<std::uint64_t>(first_row / edge);
  const auto end = static_cast<std::uint64_t>((first_row + rows + edge - 1) / edge);
  return {first * row, (end - first) * row};
}

void decode_texels(TexelKind kind, const std::uint8_t* texels, std::size_t count, float* rgb) noexcept {
  if (const auto& pixels = traits(kind).pixels) {
    image::decode_texels(*pixels, texels, static_cast<int>(count), rgb);
  } else if (kind == TexelKind::b10g11r11) {
    decode_packed(texels, count, rgb, image::unpack_b10g11r11);
  } else if (kind == TexelKind::e5b9g9r9) {
    decode_packed(texels, count, rgb, image::unpack_e5b9g9r9);
  }
}

namespace {

using namespace std::string_view_literals;

bool is_ktx(std::string_view start) { return start.starts_with("\xabKTX "sv); }
bool is_ktx1(std::string_view start) { return start.starts_with("\xabKTX 11"sv); }
bool is_dds(std::string_view start) { return start.starts_with("DDS "sv); }

}  // namespace

const char* name(Supercompression supercompression) noexcept {
  constexpr std::array names{"none", "zlib", "zstd"};
  return platform::name_in<Supercompression::zstd>(names, supercompression, "unknown");
}

bool is_texture(std::string_view start) { return is_ktx(start) || is_dds(start); }

TextureLayout read_texture_layout(platform::ByteFile& file, int element) {
  const std::string start = first_bytes(file);
  if (is_ktx1(start)) return read_ktx1_layout(file, element);
  if (is_ktx(start)) return read_ktx2_layout(file, element);
  if (is_dds(start)) return read_dds_layout(file, element);
  throw platform::file_error(ErrorCode::unsupported_file, file.path(),
                             "is not a KTX2, KTX or DDS texture (unknown signature); pass one of those");
}

void refuse_texture(const platform::ByteFile& file, ErrorCode code, const std::string& message) {
  throw platform::file_error(code, file.path(), message);
}

void settle_texture(const platform::ByteFile& file, TextureLayout& layout, std::uint64_t width, std::uint64_t height,
                    std::uint64_t levels, std::uint32_t faces, std::uint32_t elements, int element) {
  constexpr std::uint32_t most_elements = 65536;
  if (faces != 6 && faces != 1)
    refuse_texture(file, ErrorCode::corrupt_file,
                   "has " + std::to_string(faces) + " faces; a cubemap has six and an image one");
  const std::uint32_t count = std::max(elements, 1U);
  if (count > most_elements) {
    refuse_texture(file, ErrorCode::unsupported_file,
                   "is an array of " + std::to_string(elements) + "; up to " + std::to_string(most_elements) +
                       " elements are read");
  }
  require_element(file.path(), static_cast<int>(count), element);
  const std::string shape = std::to_string(width) + " x " + std::to_string(height);
  if (faces == 6) {
    if (width != height || width < 1) {
      refuse_texture(file, ErrorCode::corrupt_file,
                     "its faces are " + shape + " texels; a cubemap's are square, from 1 x 1 up");
    }
    if (width > image::kLargestFace) {
      refuse_texture(
          file, ErrorCode::unsupported_file,
          "its faces are " + shape + " texels; reduce them to " + std::to_string(image::kLargestFace) + " or fewer");
    }
  } else if (width < 1 || height < 1 || width > static_cast<std::uint64_t>(kMaximumWidth) ||
             height > static_cast<std::uint64_t>(kMaximumHeight)) {
    refuse_texture(file, ErrorCode::unsupported_file,
                   "has " + shape + " texels; images from 1 x 1 to " + std::to_string(kMaximumWidth) + " x " +
                       std::to_string(kMaximumHeight) + " are read");
  }
  const int most = full_chain_levels(static_cast<int>(std::max(width, height)));
  if (levels < 1 || levels > static_cast<std::uint64_t>(most)) {
    refuse_texture(file, ErrorCode::corrupt_file,
                   "states " + std::to_string(levels) + " levels; from " + shape + " texels down there can be 1 to " +
                       std::to_string(most));
  }
  layout.size = static_cast<int>(width);
  layout.height = faces == 6 ? 0 : static_cast<int>(height);
  layout.elements = static_cast<int>(count);
  layout.element = element;
}

namespace {

constexpr int kRowsAtOnce = 64;

/// Adds, at most to the largest number: packed levels have the bytes that the file states, huge ones in a sparse file.
std::uint64_t sum(std::uint64_t a, std::uint64_t b) {
  constexpr std::uint64_t most = std::numeric_limits<std::uint64_t>::max();
  return a > most - b ? most : a + b;
}

/// Returns an upper bound on a reader's memory while it reads `rows` rows of a level at once.
std::uint64_t texture_reader_bytes(const TextureLayout& layout, int level, int rows) noexcept {
  const int size = layout.level_size(level);
  const auto& stored = layout.levels[static_cast<std::size_t>(level)];
  // Rows of blocks reach beyond the rows that are read, at either end.
  const int most_rows = rows + (is_compressed(layout.kind) ? block_edge(layout.kind) : 0);
  std::uint64_t bytes = row_byte_range(layout.kind, size, 0, most_rows).bytes;
  if (layout.supercompression != Supercompression::none) bytes = sum(layout.whole_bytes(level), stored.packed_bytes);
  if (!is_astc(layout.kind)) return bytes;
  constexpr std::uint64_t decoder = std::uint64_t{4} << 20U;
  const auto texels = static_cast<std::uint64_t>(size) * static_cast<std::uint64_t>(most_rows);
  return sum(bytes, decoder + texels * 4 * sizeof(float));
}

/// Reads texels of a KTX2 or DDS file. Each thread has its own. If the file's levels are packed, it holds one unpacked
/// level until another is requested.
class TextureReader {
 public:
  /// `layout` is that of the file, and outlives the reader. `stop` is checked while a level is unpacked.
  TextureReader(const FileInput& input, const TextureLayout& layout, stop_token stop = {})
      : file_(open_file(input)), layout_(layout), stop_(std::move(stop)) {}

  /// Reads rows of a face to `rows` x level size x 3 floats. Throws `Error`: corrupt_file, file_access, cancelled.
  void read(int level, int face, int first_row, int rows, float* rgb) {
    const int size = layout_.level_size(level);
    const ByteRange range = row_byte_range(layout_.kind, size, first_row, rows);
    if (layout_.supercompression != Supercompression::none) {
      if (unpacked_level_ != level) unpack_level(level);
      const std::uint64_t first_byte = layout_.first_byte_of(level, face);
      decode(texels_.data() + first_byte + range.first_byte, size, first_row, rows, rgb);
      return;
    }
    texels_.resize(range.bytes);
    const TextureLayout::Level& stored = layout_.levels[static_cast<std::size_t>(level)];
    file_.seek(stored.first_byte + stored.face_stride * static_cast<std::uint64_t>(face) + range.first_byte);
    file_.read(texels_.data(), texels_.size());
    decode(texels_.data(), size, first_row, rows, rgb);
  }

 private:
  void unpack_level(int level) {
    const TextureLayout::Level& stored = layout_.levels[static_cast<std::size_t>(level)];
    unpacked_level_ = -1;
    std::vector<std::uint8_t> packed(stored.packed_bytes);
    file_.seek(stored.first_byte);
    file_.read(packed.data(), packed.size());
    texels_.resize(layout_.whole_bytes(level));
    unpack(layout_.supercompression, packed, file_.path(), texels_, stop_);
    unpacked_level_ = level;
  }

  /// Decodes the bytes at `row_byte_range`, at an address that is a multiple of 4 (rgb16f: of 2; rgb8: any).
  void decode(const std::uint8_t* bytes, int size, int first_row, int rows, float* rgb) {
    const TexelKind kind = layout_.kind;
    if (!is_compressed(kind)) {
      decode_texels(kind, bytes, static_cast<std::size_t>(rows) * static_cast<std::size_t>(size), rgb);
    } else if (kind == TexelKind::uastc_hdr_4x4) {
      image::decode_uastc_hdr_rows(bytes, size, first_row, rows, rgb);
    } else if (is_astc(kind)) {
      if (!astc_) astc_ = make_astc_decoder(kind, file_.path());
      astc_(bytes, size, first_row, rows, rgb);
    } else {
      const auto range = kind == TexelKind::bc6h_ufloat ? image::Bc6hRange::positive : image::Bc6hRange::signed_values;
      image::decode_bc6h_rows(bytes, range, size, first_row, rows, rgb);
    }
  }

  platform::ByteFile file_;
  const TextureLayout& layout_;
  stop_token stop_;
  AstcDecoder astc_;  ///< made at first use
  std::vector<std::uint8_t> texels_;
  int unpacked_level_ = -1;
};

/// Returns the bytes of the whole chain as floats. Sizes are bounded, so that this cannot overflow.
std::uint64_t chain_bytes(const TextureLayout& layout) {
  std::uint64_t texels = 0;
  for (int level = 0; level < static_cast<int>(layout.levels.size()); ++level) {
    const auto edge = static_cast<std::uint64_t>(layout.level_size(level));
    texels += 6 * edge * edge;
  }
  return texels * 3 * sizeof(float);
}

/// A packed level is one tile, the others are six, one per face.
struct Tiles {
  explicit Tiles(const TextureLayout& layout)
      : faces(layout.supercompression == Supercompression::none ? 1 : 6), count(layout.levels.size() * 6 / faces) {}

  std::size_t faces;  ///< per tile
  std::size_t count;
};

/// Returns the bytes in addition to the chain, with `workers` readers: each level is unpacked by one of them.
std::uint64_t working_bytes(const TextureLayout& layout, std::size_t workers) {
  std::uint64_t bytes = 0;
  for (int level = 0; level < static_cast<int>(layout.levels.size()); ++level) {
    const std::uint64_t one = texture_reader_bytes(layout, level, kRowsAtOnce);
    if (layout.supercompression == Supercompression::none) return one * workers;
    bytes = sum(bytes, one);
  }
  return bytes;
}

void check_memory(const std::filesystem::path& path, const TextureLayout& layout, std::uint64_t limit,
                  std::size_t workers) {
  const std::uint64_t wanted = sum(chain_bytes(layout), working_bytes(layout, workers));
  if (wanted <= limit) return;
  throw platform::file_error(ErrorCode::limit_exceeded, path,
                             "its " + std::to_string(layout.levels.size()) + " levels from " +
                                 std::to_string(layout.size) + " texels take " + std::to_string(wanted) +
                                 " bytes, above the limit of " + std::to_string(limit) + "; raise the limit");
}

std::string words_for(const TextureLayout& layout) {
  std::string words = std::string(name(layout.container)) + " " + name(layout.kind);
  if (layout.supercompression != Supercompression::none) words += std::string(" ") + name(layout.supercompression);
  return words;
}

/// Rounds rows to read at once down to whole blocks.
int whole_rows(TexelKind kind, int rows) { return rows / block_edge(kind) * block_edge(kind); }

void read_face(TextureReader& reader, Cubemap& chain, int level, int face, int rows_at_once, const stop_token& stop) {
  const int size = chain.level_size(level);
  for (int row = 0; row < size; row += rows_at_once) {
    jobs::throw_if_cancelled(stop);
    const std::ptrdiff_t offset = std::ptrdiff_t{3} * size * row;
    reader.read(level, face, row, std::min(rows_at_once, size - row), chain.face(level, face) + offset);
  }
}

constexpr int kStreamedRows = 16;

class TextureRowReader final : public RowReader {
 public:
  TextureRowReader(const FileInput& input, const TextureLayout& layout, int level)
      : reader_(input, layout),
        level_(level),
        width_(layout.level_size(level)),
        rows_(layout.level_rows(level)),
        streamed_rows_(whole_rows(layout.kind, kStreamedRows)) {}

  void read(int first_row, int row_count, float* rgb) override {
    const int end = first_row + row_count;
    for (int row = first_row; row < end;) {
      const int face = row / rows_;
      const int rows = std::min({end - row, (face + 1) * rows_ - row, streamed_rows_});
      reader_.read(level_, face, row % rows_, rows, rgb);
      rgb += rgb_bytes(width_, rows) / sizeof(float);
      row += rows;
    }
  }

 private:
  TextureReader reader_;
  int level_;
  int width_;
  int rows_;           ///< per face
  int streamed_rows_;  ///< read at once
};

bool has_prefiltered_levels(const TextureLayout& layout) {
  if (layout.faces() != 6) return false;
  if (!layout.has_metadata || layout.container == FileFormat::ktx1)
    return true;  // DDS cannot say, and those of lighting tools mostly are prefiltered
  return std::any_of(layout.metadata.begin(), layout.metadata.end(),
                     [](const auto& entry) { return speaks_of_roughness(entry.first); });
}

/// `height`: rows of the level's image.
RowTraits texture_traits(const TextureLayout& layout, int level, int height) {
  RowTraits traits{.natural_rows = std::min(block_edge(layout.kind), layout.level_rows(level)),
                   .prefiltered_levels = has_prefiltered_levels(layout),
                   .reader_bytes = texture_reader_bytes(layout, level, kStreamedRows)};
  if (layout.supercompression != Supercompression::none) {
    traits.natural_rows = height;
    traits.smaller_reader = "save it without supercompression: a packed level must be unpacked whole";
  }
  return traits;
}

void list_channels(EnvironmentInfo& info, TexelKind kind) {
  constexpr std::array names{"R", "G", "B", "A"};
  for (std::size_t channel = 0; channel < traits(kind).channels; ++channel) {
    const bool short_one = kind == TexelKind::b10g11r11 && channel == 2;
    info.channels.push_back({names[channel], short_one ? ChannelType::ufloat10 : traits(kind).channel});
  }
}

TexelKind with_transfer(TexelKind kind, Transfer asked_for, EnvironmentInfo& info) {
  const bool with_alpha = kind == TexelKind::rgba8 || kind == TexelKind::rgba8_srgb;
  if (!with_alpha && kind != TexelKind::rgb8 && kind != TexelKind::rgb8_srgb) return kind;
  const bool asked = asked_for != Transfer::automatic;
  const bool states_linear = kind == TexelKind::rgba8 || kind == TexelKind::rgb8;
  const bool linear = asked ? asked_for == Transfer::linear : states_linear;
  info.notes.push_back(std::string("samples are read as ") + (linear ? "linear" : "sRGB") +
                       (asked ? ", as requested" : ", as the format states"));
  if (with_alpha) return linear ? TexelKind::rgba8 : TexelKind::rgba8_srgb;
  return linear ? TexelKind::rgb8 : TexelKind::rgb8_srgb;
}

/// Sets layout and sizes of an image's level.
void settle_image(EnvironmentInfo& info, const TextureLayout& layout, const ReadOptions& options) {
  const auto levels = static_cast<int>(layout.levels.size());
  require_level(info, levels, options.level);
  for (int level = 0; level < levels; ++level)
    info.levels.push_back({layout.level_size(level), layout.level_rows(level)});
  info.width = layout.level_size(options.level);
  info.height = layout.level_rows(options.level);
  decide_layout(info, options.layout, std::nullopt);
}

}  // namespace

std::unique_ptr<RowSource> open_texture(platform::ByteFile& file, const ReadOptions& options) {
  TextureLayout layout = read_texture_layout(file, options.element);
  EnvironmentInfo info;
  info.path = file.path();
  info.format = layout.container;
  info.compression = name(layout.supercompression);
  info.storage = name(layout.kind);
  layout.kind = with_transfer(layout.kind, options.transfer, info);
  list_channels(info, layout.kind);
  if (layout.faces() == 6) {
    settle_cube(info, layout.size, static_cast<int>(layout.levels.size()), options);
  } else {
    settle_image(info, layout, options);
  }
  if (layout.elements > 1) {
    info.notes.push_back("element " + std::to_string(layout.element) + " of an array of " +
                         std::to_string(layout.elements));
  }
  const auto orientation = layout.metadata.find("KTXorientation");
  const bool usual = orientation == layout.metadata.end() || orientation->second == "rd" ||
                     orientation->second.starts_with("S=r,T=d");  // KTX 1
  if (!usual) {
    info.notes.push_back("its KTXorientation of \"" + platform::printable(orientation->second) +
                         "\" is not applied: rows are read from the top");
  }
  RowTraits traits = texture_traits(layout, options.level, info.height);
  const auto open = [input = input_of(file), layout, level = options.level] {
    return std::make_unique<TextureRowReader>(input, layout, level);
  };
  return std::make_unique<RowSource>(std::move(info), std::move(traits), open);
}

}  // namespace welkin::files

namespace welkin {

CubemapTexture read_texture(const FileInput& input, std::uint64_t memory_limit_bytes, const Control& control) {
  const platform::FloatingPointScope floating_point;
  platform::ByteFile file = files::open_file(input);
  const files::TextureLayout layout = files::read_texture_layout(file);
  if (layout.faces() != 6 || layout.elements > 1) {
    throw platform::file_error(ErrorCode::unsupported_file, input.path(),
                               layout.faces() != 6
                                   ? "is not a cubemap; read it as an environment (read_environment)"
                                   : "is an array of " + std::to_string(layout.elements) +
                                         " cubemaps; read one as an environment (ReadOptions::element)");
  }
  const files::Tiles tiles(layout);
  const jobs::Placement placement = jobs::placement_for(std::int64_t{6} * layout.size * layout.size);
  const std::size_t workers = jobs::worker_count(placement);
  files::check_memory(input.path(), layout, memory_limit_bytes, workers);

  CubemapTexture texture{Cubemap(layout.size, static_cast<int>(layout.levels.size()), control.memory),
                         files::words_for(layout), layout.metadata};
  const int rows_at_once = files::whole_rows(layout.kind, files::kRowsAtOnce);
  std::vector<std::unique_ptr<files::TextureReader>> readers(workers);
  jobs::run_tiles(tiles.count, placement, workers, control, [&](std::size_t tile, std::size_t worker) {
    auto& reader = readers[worker];
    if (!reader) reader = std::make_unique<files::TextureReader>(input, layout, control.stop);
    const std::size_t first = tile * tiles.faces;
    for (std::size_t face = first; face < first + tiles.faces; ++face) {
      files::read_face(*reader, texture.cubemap, static_cast<int>(face / 6), static_cast<int>(face % 6), rows_at_once,
                       control.stop);
    }
  });
  return texture;
}

}  // namespace welkin
