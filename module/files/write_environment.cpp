#include "files/write_environment.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <system_error>
#include <vector>

#include "files/codecs.h"
#include "files/row_source.h"
#include "image/pixels.h"
#include "jobs/tiles.h"
#include "platform/file.h"
#include "platform/float_environment.h"
#include "platform/text.h"
#include "welkin/core.h"
#include "welkin/environment_file.h"

namespace welkin {
namespace {

using files::Envmap;
using files::OutputImage;
using platform::file_error;

struct Format {
  const char* extension;
  std::optional<files::Codec> codec;  ///< the codec that writes it, if a build can leave that out
  std::uint64_t (*write)(const OutputImage&, const files::WriteJob&);
  std::vector<SampleType> types;  ///< the first is the automatic one
  const char* types_in_words;
};

const std::array<Format, 4>& formats() {
  // Never destroyed: a worker's thread may still write while the program exits.
  static const auto& all = *new std::array<Format, 4>{{
      {".exr",
       files::Codec::exr,
       files::write_exr,
       {SampleType::half, SampleType::float32},
       "OpenEXR is written as half or float"},
      {".hdr", {}, files::write_hdr, {SampleType::automatic}, "Radiance .hdr holds RGBE alone; leave the type out"},
      {".pfm", {}, files::write_pfm, {SampleType::float32}, "PFM holds floats alone"},
      {".png",
       files::Codec::png,
       files::write_png,
       {SampleType::uint8, SampleType::uint16},
       "PNG is written with 8 or 16 bits"},
  }};
  return all;
}

const Format& format_of(const std::filesystem::path& path) {
  const Format& format = files::format_named_by(path, formats(), " is not written", "; use .exr, .hdr, .pfm or .png");
  if (format.codec) files::require_codec(*format.codec, path, "write .hdr or .pfm");
  return format;
}

SampleType type_for(const Format& format, SampleType asked_for, const std::filesystem::path& path) {
  if (asked_for == SampleType::automatic) return format.types.front();
  const bool known = std::find(format.types.begin(), format.types.end(), asked_for) != format.types.end();
  if (!known) {
    throw file_error(ErrorCode::invalid_argument, path, std::string("cannot hold that type; ") + format.types_in_words);
  }
  return asked_for;
}

}  // namespace

void check_write_options(const FileOutput& output, const WriteOptions& options, bool is_cubemap) {
  const platform::FloatingPointScope floating_point;
  const std::filesystem::path& path = output.path();
  (void)type_for(format_of(path), options.type, path);
  if (!is_cubemap && options.layout != Layout::automatic && options.layout != Layout::lat_long) {
    throw file_error(ErrorCode::invalid_argument, path,
                     std::string("a lat-long cannot be written as a ") + name(options.layout) +
                         "; make a cubemap of it first (to_cubemap)");
  }
  if (is_cubemap && options.layout == Layout::lat_long) {
    throw file_error(ErrorCode::invalid_argument, path,
                     "a cubemap cannot be written as a lat-long; make one of it first (to_lat_long)");
  }
  if (output.bytes() != nullptr) {
    if (options.layout == Layout::six_files) {
      throw file_error(ErrorCode::invalid_argument, path,
                       "six files cannot be written to one vector of bytes; write a strip or a cross, or to a path");
    }
    return;
  }
  std::error_code failure;
  const std::filesystem::path folder = path.has_parent_path() ? path.parent_path() : ".";
  if (!std::filesystem::is_directory(folder, failure)) {
    throw file_error(ErrorCode::file_access, path, "cannot be written: its folder is not there; make it first");
  }
}

namespace {

/// A file of an environment.
struct Piece {
  FileOutput output;
  OutputImage image;
  Envmap envmap = Envmap::none;
};

std::vector<Piece> pieces_of(const FileOutput& output, const LatLongView& image, const Format& /*format*/,
                             Layout /*layout*/) {
  return {{output, OutputImage(image), Envmap::lat_long}};
}

std::vector<Piece> pieces_of(const FileOutput& output, const CubemapView& image, const Format& format,
                             Layout asked_for) {
  const Layout layout = asked_for == Layout::automatic ? Layout::vertical_strip : asked_for;
  if (layout == Layout::horizontal_strip && 6 * image.size > files::kMaximumWidth) {
    throw file_error(ErrorCode::invalid_argument, output.path(),
                     "would be " + std::to_string(6 * image.size) + " texels wide, above the " +
                         std::to_string(files::kMaximumWidth) +
                         " that are read; write a vertical strip, a cross or six files");
  }
  if (layout == Layout::six_files) {
    std::vector<Piece> faces;
    for (const std::filesystem::path& path : files::files_to_write(output.path(), layout)) {
      faces.push_back({path, OutputImage(image, static_cast<int>(faces.size()))});
    }
    return faces;
  }
  if (layout == Layout::vertical_strip && format.write == files::write_exr) {
    return {{output, OutputImage(image, files::openexr_cube_placement()), Envmap::cube}};
  }
  return {{output, OutputImage(image, files::cube_placement(layout))}};
}

}  // namespace

WriteReport write_environment(const FileOutput& output, const EnvironmentView& image, const WriteOptions& options,
                              const Control& control) {
  const platform::FloatingPointScope floating_point;
  image::check_view(image);
  check_write_options(output, options, image.kind() == EnvironmentKind::cubemap);
  const Format& format = format_of(output.path());
  const SampleType type = type_for(format, options.type, output.path());
  const std::vector<Piece> pieces =
      image::with_view(image, [&](const auto& view) { return pieces_of(output, view, format, options.layout); });
  files::OutputFiles written;
  std::uint64_t values_clamped = 0;
  const auto count = static_cast<double>(pieces.size());
  for (std::size_t k = 0; k < pieces.size(); ++k) {
    const auto before = static_cast<double>(k);
    const Control part = jobs::part_of(control, before / count, (before + 1.0) / count);
    values_clamped += format.write(pieces[k].image, {written.add(pieces[k].output), type, pieces[k].envmap, part});
  }
  return written.commit(values_clamped, control);
}

}  // namespace welkin

namespace welkin::files {

std::vector<std::filesystem::path> files_to_write(const std::filesystem::path& path, Layout layout) {
  if (layout != Layout::six_files) return {path};
  std::vector<std::filesystem::path> files;
  for (const char* const end : {"_px", "_nx", "_py", "_ny", "_pz", "_nz"}) {
    files.push_back(beside(path, end, path.extension()));
  }
  return files;
}

std::filesystem::path beside(const std::filesystem::path& path, const std::string& ending,
                             const std::filesystem::path& extension) {
  std::filesystem::path file = path.stem();
  file += ending;
  file += extension;
  return path.parent_path() / file;
}

platform::WholeFile& OutputFiles::add(const FileOutput& output) {
  return *files_.emplace_back(std::make_unique<platform::WholeFile>(output.path(), output.bytes()));
}

WriteReport OutputFiles::commit(std::uint64_t values_clamped, const Control& control) {
  WriteReport report{.files = {}, .values_clamped = values_clamped};
  for (const auto& file : files_) {
    file->finish();
    report.files.push_back(file->path());
  }
  if (control.progress) control.progress(1.0);
  for (const auto& file : files_) file->commit();  // last: an earlier exception leaves the old files
  return report;
}

OutputImage::OutputImage(const LatLongView& view)
    : width_(view.width), height_(view.height), read_row_([view](int row, float* rgb) {
        image::decode_texels(view.format, image::row_of(view, row), view.width, rgb);
      }) {}

OutputImage::OutputImage(const CubemapView& view, int face)
    : width_(view.size), height_(view.size), read_row_([view, face](int row, float* rgb) {
        image::decode_texels(view.format, image::row_of(view, face, row), view.size, rgb);
      }) {}

OutputImage::OutputImage(const CubemapView& view, const CubePlacement& placement)
    : width_(view.size * placement.columns), height_(view.size * placement.rows) {
  const std::size_t row_floats = std::size_t{3} * static_cast<std::size_t>(width_);
  auto face_row = std::make_shared<std::vector<float>>(std::size_t{3} * static_cast<std::size_t>(view.size));
  read_row_ = [view, &placement, row_floats, face_row](int row, float* rgb) {
    std::fill_n(rgb, row_floats, 0.0F);
    for (const FaceSegment& segment : row_segments(placement, view.size, row)) {
      image::decode_texels(view.format, image::row_of(view, segment.face, segment.face_row), view.size,
                           face_row->data());
      copy_segment(face_row->data(), rgb + std::size_t{3} * static_cast<std::size_t>(segment.first_column), view.size,
                   segment.mirrored);
    }
  };
}

void report_rows(const WriteJob& job, int done, int height) {
  jobs::throw_if_cancelled(job.control);
  if (job.control.progress && done > 0) {
    job.control.progress(static_cast<double>(done) / height);
  }
}

}  // namespace welkin::files
