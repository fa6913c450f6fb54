// Environments to files.
#pragma once

#include <filesystem>

#include "welkin/control.h"
#include "welkin/environment_file.h"
#include "welkin/export.h"
#include "welkin/image_view.h"

namespace WELKIN_EXPORT welkin {

/// How a channel's value is stored.
enum class SampleType {
  automatic,  ///< half in OpenEXR; the others have one kind alone (PNG: 8 bit)
  half,       ///< OpenEXR; values beyond +-65504 are clamped to it and counted
  float32,    ///< OpenEXR, PFM
  uint8,      ///< PNG: sRGB, values clamped to [0, 1]
  uint16,     ///< PNG: sRGB, values clamped to [0, 1]
};

/// How a file is written.
struct WriteOptions {
  /// automatic: lat-long for a lat-long, vertical strip for a cubemap (with OpenEXR's envmap attribute in .exr,
  /// its faces then in OpenEXR's own frames). A cubemap can be written in every other layout too.
  /// Faces of a horizontal strip may have up to 10922 texels: wider pictures than 65536 are not read anywhere.
  /// six_files: "sky.exr" makes sky_px.exr, sky_nx.exr, ..., sky_nz.exr.
  Layout layout = Layout::automatic;
  SampleType type = SampleType::automatic;  ///< halves, floats or bytes; automatic: the usual one of the format
};

/// What a format could not hold of the values.
struct WriteReport {
  std::vector<std::filesystem::path> files;  ///< that were written
  std::uint64_t values_clamped = 0;          ///< channel values beyond the format's range (NaN becomes 0)
};

/// Throws what `write_environment` would by path and options alone: ask it before a picture is made for them. (Of the
/// place only the folder is looked at; the rest shows when it is written.)
void check_write_options(const std::filesystem::path& path, const WriteOptions& options, bool is_cubemap);

/// Writes a picture in the format that the extension names: .exr, .hdr, .pfm, .png.
///
/// A file is complete or not there: it is written beside its place and renamed when it is whole. Existing files
/// are replaced. Throws `Error`: invalid_argument for a view, layout or type that does not fit (naming what
/// does), unsupported_file for an extension that is not written, file_access, cancelled.
WriteReport write_environment(const std::filesystem::path& path, const LatLongView& picture,
                              const WriteOptions& options = {}, const Control& control = {});
WriteReport write_environment(const std::filesystem::path& path, const CubemapView& picture,
                              const WriteOptions& options = {}, const Control& control = {});

}  // namespace welkin
