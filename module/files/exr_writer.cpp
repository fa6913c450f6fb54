// OpenEXR: R, G, B as half or float, scanlines, ZIP.
#include <ImfChannelList.h>
#include <ImfFrameBuffer.h>
#include <ImfHeader.h>
#include <ImfIntAttribute.h>
#include <ImfOutputFile.h>
#include <ImfStandardAttributes.h>
#include <ImfStringAttribute.h>
#include <ImfTiledOutputFile.h>
#include <half.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <string>
#include <vector>

#include "files/exr.h"
#include "files/textures.h"
#include "files/write_environment.h"
#include "image/pixels.h"
#include "welkin/image.h"

namespace welkin::files {
namespace {

constexpr int kBlockRows = 16;      // compressed together by ZIP
constexpr int kLibraryThreads = 0;  // the pool is the program's
constexpr std::array kNames{"R", "G", "B"};

/// Returns rows from `first_row` on, packed, in the file's type.
template <typename Value>
Imf::FrameBuffer frame_buffer(std::vector<Value>& values, int width, int first_row) {
  constexpr Imf::PixelType type = sizeof(Value) == 4 ? Imf::FLOAT : Imf::HALF;
  constexpr std::size_t texel = 3 * sizeof(Value);
  Imf::FrameBuffer buffer;
  for (std::size_t i = 0; i < kNames.size(); ++i) {
    buffer.insert(kNames[i],
                  exr_slice(type, values.data() + i, 0, first_row, texel, texel * static_cast<std::size_t>(width)));
  }
  return buffer;
}

/// Converts to the file's type and counts clamped values. Finite values stay finite: above the largest half, rounding
/// would make them infinite. NaN and infinities are unchanged.
void convert(const float* from, std::size_t count, float* to, std::uint64_t& /*clamped*/) noexcept {
  std::copy_n(from, count, to);
}

void convert(const float* from, std::size_t count, Imath::half* to, std::uint64_t& clamped) noexcept {
  for (std::size_t i = 0; i < count; ++i) {
    float value = from[i];
    if (std::isfinite(value) && std::abs(value) > image::kLargestHalf) {
      value = std::copysign(image::kLargestHalf, value);
      ++clamped;
    }
    to[i] = Imath::half(value);
  }
}

/// Converts OpenEXR's failures to `Error`s that name the file. OpenEXR's file objects write their table of offsets on
/// destruction and swallow errors there. A stream that failed once fails again in `WholeFile::finish`.
template <typename Write>
std::uint64_t write_with_library(const platform::WholeFile& file, const Write& write) {
  try {
    return write();
  } catch (const Error&) {
    throw;
  } catch (const std::bad_alloc&) {
    throw;
  } catch (const Iex::BaseExc& failure) {
    throw platform::file_error(
        ErrorCode::file_access, file.path(),
        std::string("could not be written; OpenEXR says: ") + platform::printable(failure.what()));
  }
}

class OutputStream final : public Imf::OStream {
 public:
  /// `file` must outlive the stream.
  explicit OutputStream(platform::WholeFile& file) : Imf::OStream(platform::utf8(file.path()).c_str()), file_(file) {}

  void write(const char bytes[], int count) override { file_.write(bytes, static_cast<std::size_t>(count)); }
  std::uint64_t tellp() override { return file_.position(); }
  void seekp(std::uint64_t position) override { file_.seek(position); }

 private:
  platform::WholeFile& file_;
};

Imf::Header make_header(const OutputImage& image, const WriteJob& job) {
  Imf::Header header(image.width(), image.height());
  header.compression() = Imf::ZIP_COMPRESSION;
  const Imf::PixelType type = job.type == SampleType::float32 ? Imf::FLOAT : Imf::HALF;
  for (const char* name : kNames) header.channels().insert(name, Imf::Channel(type));
  if (job.envmap == Envmap::lat_long) Imf::addEnvmap(header, Imf::ENVMAP_LATLONG);
  if (job.envmap == Envmap::cube) Imf::addEnvmap(header, Imf::ENVMAP_CUBE);
  return header;
}

template <typename Value>
std::uint64_t write_blocks(const OutputImage& image, const WriteJob& job, Imf::OutputFile& file) {
  const std::size_t row_values = std::size_t{3} * static_cast<std::size_t>(image.width());
  std::vector<float> rgb(row_values);
  std::vector<Value> block(row_values * kBlockRows);
  std::uint64_t clamped = 0;
  for (int first = 0; first < image.height(); first += kBlockRows) {
    report_rows(job, first, image.height());
    const int rows = std::min(kBlockRows, image.height() - first);
    for (int row = 0; row < rows; ++row) {
      image.read_row(first + row, rgb.data());
      convert(rgb.data(), row_values, block.data() + static_cast<std::size_t>(row) * row_values, clamped);
    }
    file.setFrameBuffer(frame_buffer(block, image.width(), first));
    file.writePixels(rows);
  }
  return clamped;
}

}  // namespace

std::uint64_t write_exr(const OutputImage& image, const WriteJob& job) {
  return write_with_library(job.file, [&] {
    OutputStream stream(job.file);
    Imf::OutputFile file(stream, make_header(image, job), kLibraryThreads);
    return job.type == SampleType::float32 ? write_blocks<float>(image, job, file)
                                           : write_blocks<Imath::half>(image, job, file);
  });
}

namespace {

// OpenEXR: a cube `envmap` in mip-mapped tiles, as OpenEXR's exrenvmap writes them.
//
// The image is `size` x 6 `size`; OpenEXR halves both, rounding down, until both are 1. So a level can be taller than
// its six faces (odd sizes: they lie on top, as CubeMap::sizeOfFace has it), and the last ones hold no faces at all.

constexpr int kTileSize = 64;

// Attributes with a fixed meaning and type that are not in every header from the start.
constexpr std::array kReserved{"name", "type", "version", "chunkCount", "view", "tiles", "preview", "multiView"};
constexpr std::size_t kLongestName = 255;

void add_metadata(Imf::Header& header, const TextureJob& job) {
  for (const auto& [key, value] : job.options.metadata) {
    const bool reserved = std::find(kReserved.begin(), kReserved.end(), key) != kReserved.end();
    if (reserved || key.size() > kLongestName || header.find(key) != header.end()) {
      throw platform::file_error(
          ErrorCode::invalid_argument, job.file.path(),
          "its metadata has the key \"" + platform::printable(key) +
              "\", which OpenEXR keeps for itself or finds too long (255 characters); name it otherwise");
    }
    header.insert(key, Imf::StringAttribute(value));
  }
}

Imf::Header make_header(const TextureJob& job) {
  const int size = job.mips.front().size;
  Imf::Header header(size, 6 * size);
  header.compression() = Imf::ZIP_COMPRESSION;
  header.setTileDescription(Imf::TileDescription(kTileSize, kTileSize, Imf::MIPMAP_LEVELS, Imf::ROUND_DOWN));
  const Imf::PixelType type = job.options.format == TexelFormat::rgba32f ? Imf::FLOAT : Imf::HALF;
  for (const char* name : kNames) header.channels().insert(name, Imf::Channel(type));
  Imf::addEnvmap(header, Imf::ENVMAP_CUBE);
  header.insert("welkinLevels", Imf::IntAttribute(static_cast<int>(job.mips.size())));
  add_metadata(header, job);
  return header;
}

/// Reduces to one face, size x size x 3 values. A source texel cut by a texel's edge counts for both.
void reduce_face(const OutputImage& source, int size, float* to) {
  const int source_size = source.width();
  const auto first = [&](int texel) { return texel * source_size / size; };
  const auto end = [&](int texel) { return ((texel + 1) * source_size + size - 1) / size; };
  std::vector<float> rgb(std::size_t{3} * static_cast<std::size_t>(source_size));
  std::vector<double> sums(std::size_t{3} * static_cast<std::size_t>(size));
  for (int row = 0; row < size; ++row, to += sums.size()) {
    std::fill(sums.begin(), sums.end(), 0.0);
    for (int source_row = first(row); source_row < end(row); ++source_row) {
      source.read_row(source_row, rgb.data());
      for (int column = 0; column < size; ++column) {
        double* sum = sums.data() + std::ptrdiff_t{3} * column;
        for (int i = 3 * first(column); i < 3 * end(column); ++i) {
          sum[i % 3] += static_cast<double>(rgb[static_cast<std::size_t>(i)]);
        }
      }
    }
    for (int column = 0; column < size; ++column) {
      const double count = static_cast<double>(end(row) - first(row)) * (end(column) - first(column));
      for (int i = 3 * column; i < 3 * column + 3; ++i) {
        to[i] = static_cast<float>(sums[static_cast<std::size_t>(i)] / count);
      }
    }
  }
}

/// Returns smaller faces for a level that was not given.
Cubemap reduced(const CubemapView& source, int size) {
  Cubemap smaller(size, 1, new_delete_resource());
  for (int face = 0; face < 6; ++face) reduce_face(OutputImage(source, face), size, smaller.face(face));
  return smaller;
}

/// Returns six faces of one texel each, in the mean of all texels.
Cubemap one_colour(const CubemapView& source) {
  const Cubemap faces = reduced(source, 1);
  Cubemap result(1, 1, new_delete_resource());
  for (std::size_t i = 0; i < 18; ++i) {
    double sum = 0.0;
    for (std::size_t face = 0; face < 6; ++face) sum += static_cast<double>(faces.pixels()[3 * face + i % 3]);
    result.pixels()[i] = static_cast<float>(sum / 6.0);
  }
  return result;
}

/// Writes a level; rows below the image (if any) are black.
template <typename Value>
class LevelWriter {
 public:
  LevelWriter(Imf::TiledOutputFile& file, TexelProgress& progress) : file_(file), progress_(progress) {}

  void write(int level, const OutputImage& image) {
    const int width = file_.levelWidth(level);
    const int height = file_.levelHeight(level);
    const std::size_t row_values = std::size_t{3} * static_cast<std::size_t>(width);
    rgb_.resize(row_values);
    values_.resize(row_values * kTileSize);
    for (int tile_row = 0; tile_row < file_.numYTiles(level); ++tile_row) {
      const int first = tile_row * kTileSize;
      const int end = std::min(first + kTileSize, height);
      progress_.next(static_cast<std::uint64_t>(width) * static_cast<std::uint64_t>(end - first));
      for (int row = first; row < end; ++row) {
        std::fill(rgb_.begin(), rgb_.end(), 0.0F);
        if (row < image.height()) image.read_row(row, rgb_.data());
        convert(rgb_.data(), row_values, values_.data() + row_values * static_cast<std::size_t>(row - first), clamped_);
      }
      file_.setFrameBuffer(frame_buffer(values_, width, first));
      file_.writeTiles(0, file_.numXTiles(level) - 1, tile_row, tile_row, level);
    }
  }

  [[nodiscard]] std::uint64_t clamped() const noexcept { return clamped_; }

 private:
  Imf::TiledOutputFile& file_;
  TexelProgress& progress_;
  std::vector<float> rgb_;
  std::vector<Value> values_;
  std::uint64_t clamped_ = 0;
};

template <typename Value>
std::uint64_t write_levels(const TextureJob& job, Imf::TiledOutputFile& file) {
  const CubePlacement& placement = openexr_cube_placement();
  TexelProgress progress(job);
  LevelWriter<Value> writer(file, progress);
  const int given = static_cast<int>(job.mips.size());
  for (int level = 0; level < given; ++level) {
    writer.write(level, OutputImage(job.mips[static_cast<std::size_t>(level)], placement));
  }
  // A file must have every level down to 1 x 1.
  const std::uint64_t clamped = writer.clamped();
  Cubemap last;
  CubemapView above = job.mips.back();
  for (int level = given; level < file.numLevels(); ++level) {
    const int size = file.levelWidth(level);
    const bool has_faces = file.levelHeight(level) >= 6 * size;
    last = has_faces ? reduced(above, size) : one_colour(above);
    above = last.view();
    writer.write(level, OutputImage(above, placement));
  }
  return clamped;
}

}  // namespace

std::uint64_t write_exr_cube(const TextureJob& job) {
  return write_with_library(job.file, [&] {
    OutputStream stream(job.file);
    Imf::TiledOutputFile file(stream, make_header(job), kLibraryThreads);
    return job.options.format == TexelFormat::rgba32f ? write_levels<float>(job, file)
                                                      : write_levels<Imath::half>(job, file);
  });
}

}  // namespace welkin::files
