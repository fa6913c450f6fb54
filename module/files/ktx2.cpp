// The header of a KTX2 file.
#include <algorithm>
#include <cstring>
#include <limits>
#include <string>

#include "files/codecs.h"
#include "files/textures.h"
#include "image/block_images.h"
#include "jobs/control.h"
#include "jobs/tiles.h"
#include "platform/file.h"
#include "platform/standard_library.h"

namespace welkin::files {
namespace {

// Channel numbers of the RGBSDA colour model, and the qualifiers in the upper four bits of the same byte.
constexpr std::uint32_t kRed = 0, kGreen = 1, kBlue = 2, kAlpha = 15;
constexpr std::uint32_t kExponent = 0x20, kSigned = 0x40, kFloat = 0x80;

/// A bit field of a texel.
struct Sample {
  std::uint32_t first_bit;
  std::uint32_t bits;
  std::uint32_t channel;  ///< with its qualifiers
  std::uint32_t lower;    ///< the number for 0, or for -1 if signed; for an exponent its bias
  std::uint32_t upper;    ///< the number for 1; for an exponent the largest one
};

std::vector<Sample> samples_of(TexelFormat format) {
  constexpr auto one = platform::bit_cast<std::uint32_t>(1.0F);
  constexpr auto minus_one = platform::bit_cast<std::uint32_t>(-1.0F);
  constexpr std::uint32_t whole_block = 128;
  constexpr std::uint32_t shared_one = 16U << 9U | 256U;  // 1 as exponent and mantissa
  const auto signed_floats = [](std::uint32_t bits) -> std::vector<Sample> {
    constexpr std::uint32_t sort = kFloat | kSigned;
    return {{0, bits, kRed | sort, minus_one, one},
            {bits, bits, kGreen | sort, minus_one, one},
            {2 * bits, bits, kBlue | sort, minus_one, one},
            {3 * bits, bits, kAlpha | sort, minus_one, one}};
  };
  switch (format) {
    case TexelFormat::rgba16f: return signed_floats(16);
    case TexelFormat::rgba32f: return signed_floats(32);
    case TexelFormat::b10g11r11:
      return {{0, 11, kRed | kFloat, 0, one}, {11, 11, kGreen | kFloat, 0, one}, {22, 10, kBlue | kFloat, 0, one}};
    case TexelFormat::e5b9g9r9:
      return {{0, 9, kRed, 0, shared_one},   {27, 5, kRed | kExponent, 15, 31},
              {9, 9, kGreen, 0, shared_one}, {27, 5, kGreen | kExponent, 15, 31},
              {18, 9, kBlue, 0, shared_one}, {27, 5, kBlue | kExponent, 15, 31}};
    case TexelFormat::bc6h_ufloat:
    case TexelFormat::uastc_hdr_4x4: return {{0, whole_block, kFloat, 0, one}};
    case TexelFormat::bc6h_sfloat:
    case TexelFormat::astc_4x4_hdr:
    case TexelFormat::astc_6x6_hdr: return {{0, whole_block, kFloat | kSigned, minus_one, one}};
  }
  return {};
}

/// supercompressionScheme, indexed by Supercompression.
constexpr std::array kSchemes{0U, 3U, 2U};
static_assert(kSchemes.size() == static_cast<std::size_t>(Supercompression::zstd) + 1);

std::optional<Supercompression> supercompression_of_ktx2(std::uint32_t scheme) noexcept {
  const auto found = std::find(kSchemes.begin(), kSchemes.end(), scheme);
  if (found == kSchemes.end()) return std::nullopt;
  return static_cast<Supercompression>(found - kSchemes.begin());
}

/// The descriptor's colour model by which loaders recognize that they can transcode a texture to BC6H.
constexpr std::uint32_t kModelUastcHdr = 167;

/// Returns the data format descriptor after its total size: linear light in Rec. 709 primaries, straight alpha.
std::vector<std::uint8_t> ktx2_descriptor(TexelFormat format) {
  constexpr std::uint32_t version = 2;       // of Data Format 1.3
  constexpr std::uint32_t model_rgbsda = 1;  // red, green, blue, stencil, depth, alpha
  constexpr std::uint32_t model_bc6h = 133;
  constexpr std::uint32_t model_astc = 162;
  constexpr std::uint32_t primaries_srgb = 1;  // Rec. 709's
  constexpr std::uint32_t transfer_linear = 1;
  const std::vector<Sample> samples = samples_of(format);
  const auto block_bytes = static_cast<std::uint32_t>(24 + 16 * samples.size());
  std::vector<std::uint8_t> bytes;
  platform::append_little_endian(bytes, block_bytes + 4);
  platform::append_little_endian(bytes, std::uint32_t{0});  // Khronos, basic format
  platform::append_little_endian(bytes, version | block_bytes << 16U);
  const TexelKind kind = kind_of(format);
  const std::uint32_t model = kind == TexelKind::uastc_hdr_4x4 ? kModelUastcHdr
                              : is_astc(kind)                  ? model_astc
                              : is_compressed(kind)            ? model_bc6h
                                                               : model_rgbsda;
  platform::append_little_endian(bytes, model | primaries_srgb << 8U | transfer_linear << 16U);
  // Texels along the edges of a block, each less one: edge x edge x 1 x 1.
  const auto last = static_cast<std::uint32_t>(block_edge(kind) - 1);
  platform::append_little_endian(bytes, last | last << 8U);
  // Bytes of the first plane of eight, before packing: KTX 2.0.4 deprecates the 0 that earlier revisions required for
  // packed levels.
  platform::append_little_endian(bytes, static_cast<std::uint64_t>(texel_bytes(kind)));
  for (const Sample& sample : samples) {
    platform::append_little_endian(bytes, sample.first_bit | (sample.bits - 1) << 16U | sample.channel << 24U);
    platform::append_little_endian(bytes, std::uint32_t{0});  // its position in the block
    platform::append_little_endian(bytes, sample.lower);
    platform::append_little_endian(bytes, sample.upper);
  }
  return bytes;
}

constexpr std::uint32_t kMaxMetadataBytes = 1U << 20U;

struct Header {
  std::uint32_t format, type_size, width, height, depth, layers, faces, levels, scheme;
  std::uint32_t descriptor_offset, descriptor_bytes, metadata_offset, metadata_bytes;
};

Header read_header(platform::ByteFile& file) {
  std::array<std::uint8_t, kKtx2HeaderBytes> bytes{};
  const auto known = static_cast<std::size_t>(std::min<std::uint64_t>(kKtx2Identifier.size(), file.size()));
  file.read(bytes.data(), known);
  if (std::memcmp(bytes.data(), kKtx2Identifier.data(), known) != 0) {
    refuse_texture(file, ErrorCode::unsupported_file, "is a KTX texture of an unknown version; export it as KTX 2.0");
  }
  file.read(bytes.data() + known, bytes.size() - known);
  Header header{};
  std::memcpy(&header, bytes.data() + kKtx2Identifier.size(), sizeof header);
  return header;
}

void check_kind(const platform::ByteFile& file, const Header& header) {
  if (header.depth > 1)
    refuse_texture(file, ErrorCode::unsupported_file, "is a 3D texture; pass a cubemap or a 2D texture");
  if (!kind_with(&KindTraits::vulkan, header.format)) {
    refuse_texture(
        file, ErrorCode::unsupported_file,
        "its VkFormat " + std::to_string(header.format) +
            " is not read; rgba16f, rgba32f, rgb16f, rgb32f, b10g11r11, e5b9g9r9, bc6h, astc 4x4 and 6x6 (sfloat), "
            "rgba8 and rgb8 (unorm, srgb) are");
  }
  if (!supercompression_of_ktx2(header.scheme)) {
    refuse_texture(file, ErrorCode::unsupported_file,
                   "its supercompression scheme " + std::to_string(header.scheme) +
                       " is not read; none, Zstandard and ZLIB are: convert it");
  }
  const Supercompression supercompression = *supercompression_of_ktx2(header.scheme);
  if (supercompression != Supercompression::none) {
    require_codec(codec_of(supercompression), file.path(), "save it without supercompression");
  }
  const std::uint32_t type_size = traits(*kind_with(&KindTraits::vulkan, header.format)).unit;
  if (header.type_size != type_size) {
    refuse_texture(file, ErrorCode::corrupt_file,
                   "its type size is " + std::to_string(header.type_size) + " instead of " + std::to_string(type_size));
  }
}

TextureLayout::Level read_level(platform::ByteFile& file, const TextureLayout& layout, int level,
                                const std::uint8_t* index) {
  const auto offset = platform::read_little_endian<std::uint64_t>(index);
  const auto bytes = platform::read_little_endian<std::uint64_t>(index + 8);
  const auto unpacked = platform::read_little_endian<std::uint64_t>(index + 16);
  const std::string what = "level " + std::to_string(level);
  require_inside(file, what, offset, bytes);
  const bool packed = layout.supercompression != Supercompression::none;
  const std::uint64_t wanted = layout.whole_bytes(level);
  if (unpacked != wanted || (!packed && bytes != wanted)) {
    refuse_texture(file, ErrorCode::corrupt_file,
                   "its " + what + " has " + std::to_string(packed ? unpacked : bytes) + " bytes instead of " +
                       std::to_string(wanted));
  }
  if (packed && most_unpacked(layout.supercompression, bytes) < wanted) {
    refuse_texture(file, ErrorCode::corrupt_file,
                   "its " + what + " has " + std::to_string(bytes) + " compressed bytes, which cannot expand to " +
                       std::to_string(wanted));
  }
  if (!packed) return {offset + layout.first_byte_of(level, 0), layout.face_bytes(level)};
  std::vector<std::uint8_t> first(std::min<std::uint64_t>(bytes, kFirstPackedBytes));
  file.seek(offset);
  file.read(first.data(), first.size());
  require_unpacks(layout.supercompression, first, wanted, file.path());
  return {.first_byte = offset, .packed_bytes = bytes};
}

}  // namespace

void require_inside(const platform::ByteFile& file, const std::string& what, std::uint64_t offset,
                    std::uint64_t bytes) {
  if (offset <= file.size() && bytes <= file.size() - offset) return;
  refuse_texture(file, ErrorCode::corrupt_file,
                 "ends too early: its " + what + " has " + std::to_string(bytes) + " bytes at " +
                     std::to_string(offset) + ", the file " + std::to_string(file.size()) +
                     "; fetch or export it again");
}

std::map<std::string, std::string> read_key_values(platform::ByteFile& file, std::uint64_t offset,
                                                   std::uint64_t bytes_there) {
  require_inside(file, "key/value data", offset, bytes_there);
  if (bytes_there > kMaxMetadataBytes) {
    refuse_texture(file, ErrorCode::limit_exceeded,
                   "has " + std::to_string(bytes_there) + " bytes of key/value data, above the limit of " +
                       std::to_string(kMaxMetadataBytes) + "; save it without");
  }
  std::vector<char> bytes(bytes_there);
  file.seek(offset);
  file.read(bytes.data(), bytes.size());
  std::map<std::string, std::string> metadata;
  for (std::size_t position = 0; position + 4 <= bytes.size();) {
    std::uint32_t length = 0;
    std::memcpy(&length, bytes.data() + position, sizeof length);
    position += sizeof length;
    if (length > bytes.size() - position) {
      refuse_texture(file, ErrorCode::corrupt_file, "its key/value data ends inside an entry");
    }
    const std::string entry(bytes.data() + position, length);
    const std::size_t end_of_key = entry.find('\0');
    if (end_of_key == std::string::npos) {
      refuse_texture(file, ErrorCode::corrupt_file, "its key/value data has a key without an end");
    }
    std::string value = entry.substr(end_of_key + 1);
    if (!value.empty() && value.back() == '\0') value.pop_back();
    metadata[entry.substr(0, end_of_key)] = std::move(value);
    position += (std::size_t{length} + 3) / 4 * 4;
  }
  return metadata;
}

namespace {

/// Returns whether the descriptor's colour model is that of UASTC HDR. Vulkan's format is ASTC 4 x 4 for both.
bool is_uastc_hdr(platform::ByteFile& file, const Header& header) {
  constexpr std::uint32_t model = 12;  // offset in the descriptor's first block
  if (header.descriptor_bytes <= model) return false;
  std::uint8_t value = 0;
  file.seek(header.descriptor_offset + std::uint64_t{model});
  file.read(&value, 1);
  return value == kModelUastcHdr;
}

}  // namespace

TextureLayout read_ktx2_layout(platform::ByteFile& file, int element) {
  const Header header = read_header(file);
  check_kind(file, header);
  const std::uint32_t levels = std::max(header.levels, 1U);  // 0: one, from which the loading program makes the others
  TextureLayout layout;
  layout.container = FileFormat::ktx2;
  layout.kind = *kind_with(&KindTraits::vulkan, header.format);
  layout.supercompression = *supercompression_of_ktx2(header.scheme);
  settle_texture(file, layout, header.width, header.height, levels, header.faces, header.layers, element);
  std::vector<std::uint8_t> index(kKtx2LevelIndexBytes * levels);
  file.read(index.data(), index.size());
  for (std::uint32_t level = 0; level < levels; ++level) {
    layout.levels.push_back(
        read_level(file, layout, static_cast<int>(level), index.data() + kKtx2LevelIndexBytes * level));
  }
  require_inside(file, "data format descriptor", header.descriptor_offset, header.descriptor_bytes);
  if (layout.kind == TexelKind::astc_4x4_hdr && is_uastc_hdr(file, header)) layout.kind = TexelKind::uastc_hdr_4x4;
  if (is_astc(layout.kind)) require_codec(Codec::astc, file.path(), "save it in another format");
  layout.has_metadata = true;
  layout.metadata = read_key_values(file, header.metadata_offset, header.metadata_bytes);
  return layout;
}

namespace {

using Bytes = std::vector<std::uint8_t>;

void pad_to(Bytes& bytes, std::size_t multiple) { bytes.resize((bytes.size() + multiple - 1) / multiple * multiple); }

void append_entry(Bytes& bytes, const std::string& key, const std::string& value) {
  platform::append_little_endian(bytes, static_cast<std::uint32_t>(key.size() + 1 + value.size() + 1));
  for (const std::string& text : {key, value}) {
    bytes.insert(bytes.end(), text.begin(), text.end());
    bytes.push_back(0);
  }
  pad_to(bytes, 4);
}

}  // namespace

Bytes key_value_bytes(const platform::WholeFile& file, const std::map<std::string, std::string>& metadata) {
  Bytes bytes;
  for (const auto& [key, value] : metadata) append_entry(bytes, key, value);
  if (bytes.size() > kMaxMetadataBytes) {
    throw platform::file_error(ErrorCode::invalid_argument, file.path(),
                               "its metadata takes " + std::to_string(bytes.size()) + " bytes; 1 MiB is the most");
  }
  return bytes;
}

namespace {

Bytes key_values(const platform::WholeFile& file, const TextureOptions& options, bool is_volume) {
  std::map<std::string, std::string> all = options.metadata;
  all["KTXorientation"] = is_volume ? "rdi" : "rd";  // columns run right, rows down, slices in
  all["KTXwriter"] = "Welkin";
  return key_value_bytes(file, all);
}

struct LevelRange {
  std::uint64_t offset = 0;
  std::uint64_t bytes = 0;
  std::uint64_t unpacked = 0;
};

/// The shape of level 0.
struct Shape {
  int width;
  int height;
  std::uint32_t faces;
  std::uint32_t depth = 0;   ///< slices of a volume; 0: not a volume
  std::uint32_t layers = 0;  ///< of an array; 0: not an array
};

Bytes header_bytes(const Shape& shape, const TextureOptions& options, const Bytes& metadata,
                   const std::vector<LevelRange>& ranges) {
  const TexelKind kind = kind_of(options.format);
  const Bytes descriptor = ktx2_descriptor(options.format);
  const auto descriptor_offset = static_cast<std::uint32_t>(kKtx2HeaderBytes + kKtx2LevelIndexBytes * ranges.size());
  const auto descriptor_size = static_cast<std::uint32_t>(descriptor.size());
  Bytes bytes(kKtx2Identifier.begin(), kKtx2Identifier.end());
  for (const std::uint32_t field :
       {traits(kind).vulkan, traits(kind).unit, static_cast<std::uint32_t>(shape.width),
        static_cast<std::uint32_t>(shape.height), shape.depth, shape.layers, shape.faces,
        static_cast<std::uint32_t>(ranges.size()), kSchemes[static_cast<std::size_t>(options.supercompression)],
        descriptor_offset, descriptor_size, descriptor_offset + descriptor_size,
        static_cast<std::uint32_t>(metadata.size())}) {
    platform::append_little_endian(bytes, field);
  }
  platform::append_little_endian(bytes, std::uint64_t{0});  // no supercompression global data: offset and bytes
  platform::append_little_endian(bytes, std::uint64_t{0});
  for (const LevelRange& range : ranges) {
    platform::append_little_endian(bytes, range.offset);
    platform::append_little_endian(bytes, range.bytes);
    platform::append_little_endian(bytes, range.unpacked);
  }
  bytes.insert(bytes.end(), descriptor.begin(), descriptor.end());
  bytes.insert(bytes.end(), metadata.begin(), metadata.end());
  return bytes;
}

/// Sets the offsets, the smallest level first, and writes everything before the levels. Unpacked levels start at
/// multiples of a texel or block (ours are all multiples of 4 bytes, so that this is also the lowest common multiple
/// with 4).
void write_header(platform::WholeFile& file, const Shape& shape, const TextureOptions& options,
                  std::vector<LevelRange>& ranges) {
  const Bytes metadata = key_values(file, options, shape.depth > 0);
  const std::uint64_t alignment =
      options.supercompression == Supercompression::none ? texel_bytes(kind_of(options.format)) : 1;
  std::uint64_t end = header_bytes(shape, options, metadata, ranges).size();
  for (auto range = ranges.rbegin(); range != ranges.rend(); ++range) {
    range->offset = (end + alignment - 1) / alignment * alignment;
    end = range->offset + range->bytes;
  }
  const Bytes header = header_bytes(shape, options, metadata, ranges);
  file.write(header.data(), header.size());
}

void write_padding(platform::WholeFile& file, std::uint64_t until) {
  const Bytes zeros(until - file.position());
  file.write(zeros.data(), zeros.size());
}

struct PackedLevel {
  Bytes bytes;
  std::uint64_t clamped = 0;
};

PackedLevel pack_level(const TextureJob& job, std::size_t level, const Bytes* blocks) {
  if (blocks != nullptr) return {pack(job.options.supercompression, *blocks, job.control.stop), 0};
  TexelEncoder encoder(job.options.format);
  Bytes texels(job.level_bytes(level));
  std::uint8_t* to = texels.data();
  for (const LatLongView& image : job.levels[level]) {
    for (int row = 0; row < image.height; ++row) {
      jobs::throw_if_cancelled(job.control);
      encoder.encode(image, row, 1, to);
      to += static_cast<std::size_t>(image.width) * texel_bytes(job.kind());
    }
  }
  return {pack(job.options.supercompression, texels, job.control.stop), encoder.clamped()};
}

/// Packs levels concurrently: the largest takes three quarters of the time in any case.
std::vector<PackedLevel> pack_levels(const TextureJob& job, const std::optional<BlockLevels>& blocks) {
  std::vector<PackedLevel> levels(job.levels.size());
  const jobs::Placement placement = jobs::placement_for(image::texels_of(job.levels.front()));
  jobs::run_tiles(levels.size(), placement, jobs::worker_count(placement), jobs::part_of(job.control, 0.0, 0.9),
                  [&](std::size_t tile, std::size_t) {
                    levels[tile] = pack_level(job, tile, blocks ? &blocks->levels[tile] : nullptr);
                  });
  return levels;
}

}  // namespace

std::uint64_t write_ktx2(const TextureJob& job) {
  const TextureOptions& options = job.options;
  const bool packed = options.supercompression != Supercompression::none;
  const std::optional<BlockLevels> blocks = compressed(job);
  const std::vector<PackedLevel> levels = packed ? pack_levels(job, blocks) : std::vector<PackedLevel>{};

  std::vector<LevelRange> ranges;
  for (std::size_t level = 0; level < job.levels.size(); ++level) {
    const std::uint64_t unpacked = job.level_bytes(level);
    ranges.push_back({0, packed ? levels[level].bytes.size() : unpacked, unpacked});
  }
  const LatLongView& first = job.levels.front().front();
  write_header(job.file, {first.width, first.height, static_cast<std::uint32_t>(job.faces())}, options, ranges);

  TexelEncoder encoder(options.format);
  TexelProgress progress(job);
  std::uint64_t clamped = blocks ? blocks->values_clamped : 0;
  for (std::size_t level = job.levels.size(); level-- > 0;) {
    write_padding(job.file, ranges[level].offset);
    if (packed) {
      job.file.write(levels[level].bytes.data(), levels[level].bytes.size());
      clamped += levels[level].clamped;
    } else if (blocks) {
      job.file.write(blocks->levels[level].data(), blocks->levels[level].size());
    } else {
      for (const LatLongView& image : job.levels[level]) write_image(job, image, encoder, progress);
    }
  }
  return clamped + encoder.clamped();
}

void write_ktx2_volume(platform::WholeFile& file, const Volume& volume,
                       const std::map<std::string, std::string>& metadata) {
  const auto deep = static_cast<std::uint32_t>(volume.size[2]);
  const std::span<const std::uint16_t> halves = volume.halves;
  std::vector<LevelRange> ranges{{0, halves.size_bytes(), halves.size_bytes()}};
  write_header(file, {volume.size[0], volume.size[1], 1, volume.is_array ? 0 : deep, volume.is_array ? deep : 0},
               {.metadata = metadata}, ranges);
  write_padding(file, ranges[0].offset);
  file.write(halves.data(), halves.size_bytes());
}

}  // namespace welkin::files
