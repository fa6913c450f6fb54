// OpenEXR: R, G, B as half or float, scanlines, ZIP.
#include <ImfChannelList.h>
#include <ImfFrameBuffer.h>
#include <ImfHeader.h>
#include <ImfOutputFile.h>
#include <ImfStandardAttributes.h>
#include <half.h>

#include <algorithm>
#include <vector>

#include "codec/exr_output.h"
#include "codec/output_picture.h"

namespace welkin::codec {
namespace {

constexpr int kBlockRows = 16;  // that ZIP compresses together

Imf::Header make_header(const OutputPicture& picture, const WriteJob& job) {
  Imf::Header header(picture.width(), picture.height());
  header.compression() = Imf::ZIP_COMPRESSION;
  const Imf::PixelType type = job.type == SampleType::float32 ? Imf::FLOAT : Imf::HALF;
  for (const char* name : {"R", "G", "B"}) header.channels().insert(name, Imf::Channel(type));
  if (job.openexr_lat_long) Imf::addEnvmap(header, Imf::ENVMAP_LATLONG);
  if (job.openexr_cube) Imf::addEnvmap(header, Imf::ENVMAP_CUBE);
  return header;
}

/// Rows of one block in the file's type.
template <typename Value>
struct Block {
  static constexpr Imf::PixelType kType = sizeof(Value) == 4 ? Imf::FLOAT : Imf::HALF;

  std::vector<Value> values;

  // OpenEXR expects the address that texel (0, 0) would have: an integer, since no such place need exist.
  Imf::FrameBuffer frame_buffer(int width, int first_row) {
    const std::size_t stride = 3 * sizeof(Value) * static_cast<std::size_t>(width);
    const std::intptr_t origin = reinterpret_cast<std::intptr_t>(values.data()) -
                                 static_cast<std::intptr_t>(first_row) * static_cast<std::intptr_t>(stride);
    Imf::FrameBuffer buffer;
    std::size_t offset = 0;
    for (const char* name : {"R", "G", "B"}) {
      char* base = reinterpret_cast<char*>(origin + static_cast<std::intptr_t>(offset));
      buffer.insert(name, Imf::Slice(kType, base, 3 * sizeof(Value), stride));
      offset += sizeof(Value);
    }
    return buffer;
  }
};

template <typename Value>
std::uint64_t write_blocks(const OutputPicture& picture, const WriteJob& job, Imf::OutputFile& file) {
  const std::size_t row_values = std::size_t{3} * static_cast<std::size_t>(picture.width());
  std::vector<float> rgb(row_values);
  Block<Value> block{std::vector<Value>(row_values * kBlockRows)};
  std::uint64_t clamped = 0;
  for (int first = 0; first < picture.height(); first += kBlockRows) {
    report_rows(job, first, picture.height());
    const int rows = std::min(kBlockRows, picture.height() - first);
    for (int row = 0; row < rows; ++row) {
      picture.read_row(first + row, rgb.data());
      convert_for_exr(rgb.data(), row_values, block.values.data() + static_cast<std::size_t>(row) * row_values,
                      clamped);
    }
    file.setFrameBuffer(block.frame_buffer(picture.width(), first));
    file.writePixels(rows);
  }
  return clamped;
}

std::uint64_t write_with_library(const OutputPicture& picture, const WriteJob& job) {
  constexpr int kLibraryThreads = 0;  // its pool is the program's
  ExrOutputStream stream(job.file);
  Imf::OutputFile file(stream, make_header(picture, job), kLibraryThreads);
  return job.type == SampleType::float32 ? write_blocks<float>(picture, job, file)
                                         : write_blocks<Imath::half>(picture, job, file);
}

}  // namespace

std::uint64_t write_exr(const OutputPicture& picture, const WriteJob& job) {
  return write_exr_with_library(job.file, [&] { return write_with_library(picture, job); });
}

}  // namespace welkin::codec
