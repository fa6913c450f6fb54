// KTX 2.0: see ktx2_format.h.
#include <numeric>
#include <string>

#include "codec/byte_file.h"
#include "codec/ktx2_format.h"
#include "codec/little_endian.h"
#include "codec/stop.h"
#include "codec/supercompression.h"
#include "codec/texture_writer.h"
#include "jobs/tiles.h"

namespace welkin::codec {
namespace {

using Bytes = std::vector<std::uint8_t>;

constexpr std::uint32_t kMostMetadataBytes = 1U << 20U;  // that our own reader takes

void pad_to(Bytes& bytes, std::size_t multiple) { bytes.resize((bytes.size() + multiple - 1) / multiple * multiple); }

void append_entry(Bytes& bytes, const std::string& key, const std::string& value) {
  append_little_endian(bytes, static_cast<std::uint32_t>(key.size() + 1 + value.size() + 1));
  for (const std::string& text : {key, value}) {
    bytes.insert(bytes.end(), text.begin(), text.end());
    bytes.push_back(0);
  }
  pad_to(bytes, 4);
}

/// Keys in the order of their bytes, as the map has them.
Bytes key_values(const WholeFile& file, const TextureOptions& options) {
  std::map<std::string, std::string> all = options.metadata;
  all["KTXorientation"] = "rd";  // columns run right, rows down
  all["KTXwriter"] = "Welkin";
  Bytes bytes;
  for (const auto& [key, value] : all) append_entry(bytes, key, value);
  if (bytes.size() > kMostMetadataBytes) {
    throw file_error(ErrorCode::invalid_argument, file.path(),
                     "its metadata takes " + std::to_string(bytes.size()) + " bytes; 1 MiB is the most");
  }
  return bytes;
}

struct Place {
  std::uint64_t offset = 0;
  std::uint64_t bytes = 0;
  std::uint64_t unpacked = 0;
};

/// Of level 0.
struct Shape {
  int width;
  int height;
  std::uint32_t faces;
};

Bytes header_bytes(const Shape& shape, const TextureOptions& options, const Bytes& metadata,
                   const std::vector<Place>& places) {
  const TexelKind kind = kind_of(options.format);
  const Bytes descriptor = ktx2_descriptor(options.format, options.supercompression);
  const auto descriptor_offset = static_cast<std::uint32_t>(kKtx2HeaderBytes + kKtx2LevelIndexBytes * places.size());
  const auto descriptor_size = static_cast<std::uint32_t>(descriptor.size());
  Bytes bytes(kKtx2Identifier.begin(), kKtx2Identifier.end());
  constexpr std::uint32_t depth = 0, layers = 0;
  for (const std::uint32_t field :
       {vulkan_format(kind), ktx2_type_size(kind), static_cast<std::uint32_t>(shape.width),
        static_cast<std::uint32_t>(shape.height), depth, layers, shape.faces, static_cast<std::uint32_t>(places.size()),
        ktx2_scheme(options.supercompression), descriptor_offset, descriptor_size, descriptor_offset + descriptor_size,
        static_cast<std::uint32_t>(metadata.size())}) {
    append_little_endian(bytes, field);
  }
  append_little_endian(bytes, std::uint64_t{0});  // no supercompression global data: offset and bytes
  append_little_endian(bytes, std::uint64_t{0});
  for (const Place& place : places) {
    append_little_endian(bytes, place.offset);
    append_little_endian(bytes, place.bytes);
    append_little_endian(bytes, place.unpacked);
  }
  bytes.insert(bytes.end(), descriptor.begin(), descriptor.end());
  bytes.insert(bytes.end(), metadata.begin(), metadata.end());
  return bytes;
}

/// Sets the offsets, the smallest level first, and writes all that stands before the levels. Unpacked levels start at
/// multiples of a texel (all of ours are multiples of 4 bytes, so that this is also the least common multiple with 4).
void write_header(WholeFile& file, const Shape& shape, const TextureOptions& options, std::vector<Place>& places) {
  const Bytes metadata = key_values(file, options);
  const std::uint64_t alignment =
      options.supercompression == Supercompression::none ? texel_bytes(kind_of(options.format)) : 1;
  std::uint64_t end = header_bytes(shape, options, metadata, places).size();
  for (auto place = places.rbegin(); place != places.rend(); ++place) {
    place->offset = (end + alignment - 1) / alignment * alignment;
    end = place->offset + place->bytes;
  }
  const Bytes header = header_bytes(shape, options, metadata, places);
  file.write(header.data(), header.size());
}

void write_padding(WholeFile& file, std::uint64_t until) {
  const Bytes zeros(until - file.position());
  file.write(zeros.data(), zeros.size());
}

struct PackedLevel {
  Bytes bytes;
  std::uint64_t clamped = 0;
};

PackedLevel pack_level(const TextureJob& job, const CubemapView& view) {
  TexelEncoder encoder(job.options.format);
  const TexelKind kind = kind_of(job.options.format);
  Bytes texels(level_bytes(kind, view.size));
  const std::size_t row_bytes = texels.size() / (std::size_t{6} * static_cast<std::size_t>(view.size));
  std::uint8_t* to = texels.data();
  for (int row = 0; row < 6 * view.size; ++row, to += row_bytes) {
    throw_if_stopped(job.control.stop);
    encoder.encode(view, row / view.size, row % view.size, 1, to);
  }
  return {pack(job.options.supercompression, texels, job.control.stop), encoder.clamped()};
}

/// Levels are packed side by side: the largest takes three quarters of the time, whatever is done.
std::vector<PackedLevel> pack_levels(const TextureJob& job) {
  std::vector<PackedLevel> levels(job.mips.size());
  const auto size = std::int64_t{job.mips.front().size};
  const jobs::Placement placement = jobs::placement_for(6 * size * size);
  jobs::run_tiles(levels.size(), placement, jobs::worker_count(placement), jobs::part_of(job.control, 0.0, 0.9),
                  [&](std::size_t tile, std::size_t) { levels[tile] = pack_level(job, job.mips[tile]); });
  return levels;
}

}  // namespace

std::uint64_t write_ktx2(const TextureJob& job) {
  const TextureOptions& options = job.options;
  const TexelKind kind = kind_of(options.format);
  const bool packed = options.supercompression != Supercompression::none;
  const std::vector<PackedLevel> levels = packed ? pack_levels(job) : std::vector<PackedLevel>{};

  std::vector<Place> places;
  for (std::size_t level = 0; level < job.mips.size(); ++level) {
    const std::uint64_t unpacked = level_bytes(kind, job.mips[level].size);
    places.push_back({0, packed ? levels[level].bytes.size() : unpacked, unpacked});
  }
  const int size = job.mips.front().size;
  write_header(job.file, {size, size, 6}, options, places);

  TexelEncoder encoder(options.format);
  TexelProgress progress(job.mips, job.control);
  std::uint64_t clamped = 0;
  for (std::size_t level = job.mips.size(); level-- > 0;) {
    write_padding(job.file, places[level].offset);
    if (packed) {
      job.file.write(levels[level].bytes.data(), levels[level].bytes.size());
      clamped += levels[level].clamped;
    } else {
      for (int face = 0; face < 6; ++face) {
        write_face(job.file, job.mips[level], face, options.format, encoder, progress);
      }
    }
  }
  return clamped + encoder.clamped();
}

std::uint64_t write_ktx2(const PictureJob& job) {
  const TextureOptions& options = job.options;
  const LatLongView& picture = job.picture;
  const std::uint64_t unpacked = static_cast<std::uint64_t>(picture.width) *
                                 static_cast<std::uint64_t>(picture.height) * texel_bytes(kind_of(options.format));
  TexelEncoder encoder(options.format);
  Bytes packed;
  if (options.supercompression != Supercompression::none) {
    Bytes texels(unpacked);
    const std::size_t row_bytes = texels.size() / static_cast<std::size_t>(picture.height);
    for (int row = 0; row < picture.height; ++row) {
      report_share(job.control, 0.1 * row / picture.height);
      encoder.encode(picture, row, 1, texels.data() + row_bytes * static_cast<std::size_t>(row));
    }
    packed = pack(options.supercompression, texels, job.control.stop);
  }
  std::vector<Place> places{{0, packed.empty() ? unpacked : packed.size(), unpacked}};
  write_header(job.file, {picture.width, picture.height, 1}, options, places);
  write_padding(job.file, places.front().offset);
  if (packed.empty()) {
    write_picture(job, encoder);
  } else {
    job.file.write(packed.data(), packed.size());
  }
  return encoder.clamped();
}

}  // namespace welkin::codec
