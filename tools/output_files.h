// The files of a bake: what each holds, in which format, and its name.
#pragma once

#include <glm/vec3.hpp>
#include <set>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "welkin/bake_file.h"
#include "welkin/reflections.h"

namespace welkin::tool {

struct BakeCommandOptions;

/// Containers, named by the word on the command line, which is also the extension.
enum class Container {
  ktx2,
  dds,
  exr,
  hdr,
  pfm,
  env,
  ktx,
  glb,
  png,
  text,  ///< plain text without a container
};

[[nodiscard]] const char* name(Container container) noexcept;

/// Returns "rgba16f", "bc6h", ...: as --ktx2-format names them.
[[nodiscard]] const char* name(TexelFormat format) noexcept;

/// Returns all formats with their names.
[[nodiscard]] std::vector<std::pair<std::string, TexelFormat>> texel_formats();

/// Returns the radiance above which the format clamps.
[[nodiscard]] const glm::dvec3& largest_of(TexelFormat format) noexcept;

[[nodiscard]] bool is_bc6h(TexelFormat format) noexcept;
/// Returns whether the format is BC6H or ASTC.
[[nodiscard]] bool is_in_blocks(TexelFormat format) noexcept;

/// The content of a file.
enum class Content {
  env,               ///< all that Babylon.js needs
  playcanvas_atlas,  ///< reflections and diffuse light on one image
  playcanvas_asset,  ///< the asset that loads that image
  gltf_light,        ///< reflections and harmonics as a light of EXT_lights_image_based
  lat_long,          ///< the background as a lat-long
  octahedral,        ///< the specular chain as an octahedral map
  background,
  specular,
  charlie,
  lambert,
  phong,
  irradiance,
  brdf,
  usd_stage,  ///< a dome light
  readme,     ///< how the engine loads the files
};

/// Returns "background", "specular", ...: the default name of its files without extension.
[[nodiscard]] const char* name(Content content) noexcept;

/// Returns the content for `charlie`, `lambert`, `phong`.
[[nodiscard]] Content content_of(LobeFamily lobe) noexcept;

/// A file to write.
struct OutputFile {
  Content content;
  Container container;
  TexelFormat format;  ///< stored format; unused for .hdr, .pfm, .env, .glb, .png and text
  Supercompression supercompression = Supercompression::none;
  std::string name{};  ///< with its extension
  int levels = 0;      ///< number of the content's first levels; 0: all
};

/// Returns words for the fate of values outside of the file's range. A bake makes no values that a float cannot hold:
/// PFM clamps nothing.
[[nodiscard]] const char* range_of(const OutputFile& file) noexcept;

/// Returns the names in the folder: the file's own or, if its container holds one level of this content, one per level.
[[nodiscard]] std::vector<std::string> names_of(const OutputFile& file, int levels);

/// Returns the files of `--formats`: for each container everything that it can hold.
[[nodiscard]] std::vector<OutputFile> files_in(const std::set<Container>& containers,
                                               const BakeCommandOptions& options);

/// Returns the files that `options.orientation.to` loads as they are and, as KTX2, further selected ones (--lobe,
/// --octahedral). The format and supercompression of .ktx2 files are those of the options, where these name them.
[[nodiscard]] std::vector<OutputFile> files_of_engine(const BakeCommandOptions& options);

/// Returns the files of a list with this content, in its order.
[[nodiscard]] std::vector<OutputFile> files_with(Content content, const std::vector<OutputFile>& files);

[[nodiscard]] bool contains(const std::vector<OutputFile>& files, Content content) noexcept;

/// Returns whether Babylon.js reads one of them as RGBD: it has its own specular chain, and harmonics.
[[nodiscard]] bool contains_rgbd(const std::vector<OutputFile>& files) noexcept;

/// Returns whether a bake for any engine, formats and sky may write a file of this name, except its manifest.
[[nodiscard]] bool is_bake_name(std::string_view name);

/// Returns whether one is a cubemap, whose faces are stored where the engine expects them.
[[nodiscard]] bool contains_cubemap(const std::vector<OutputFile>& files) noexcept;

}  // namespace welkin::tool
