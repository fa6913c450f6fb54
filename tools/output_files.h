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

/// Containers, by the word on the command line and the extension alike.
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
  text,  ///< none: what a file of letters holds
};

[[nodiscard]] const char* name(Container container) noexcept;

/// "rgba16f", "bc6h", ...: as --ktx2-format has them.
[[nodiscard]] const char* name(TexelFormat format) noexcept;

/// All of them, by their names.
[[nodiscard]] std::vector<std::pair<std::string, TexelFormat>> texel_formats();

/// The radiance above which the format clamps.
[[nodiscard]] const glm::dvec3& largest_of(TexelFormat format) noexcept;

[[nodiscard]] bool is_bc6h(TexelFormat format) noexcept;
/// BC6H or ASTC.
[[nodiscard]] bool is_in_blocks(TexelFormat format) noexcept;

/// What a file holds.
enum class Content {
  env,               ///< all that Babylon.js wants
  playcanvas_atlas,  ///< reflections and diffuse light on one image
  playcanvas_asset,  ///< how that image is to be loaded
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

/// "background", "specular", ...: the name of its files without extension where nobody calls them otherwise.
[[nodiscard]] const char* name(Content content) noexcept;

/// Of `charlie`, `lambert`, `phong`.
[[nodiscard]] Content content_of(LobeFamily lobe) noexcept;

/// A file that is to be written.
struct OutputFile {
  Content content;
  Container container;
  TexelFormat format;  ///< that is stored; of no meaning to .hdr, .pfm, .env, .glb, .png and text
  Supercompression supercompression = Supercompression::none;
  std::string name{};  ///< with its extension
  int levels = 0;      ///< the first ones of the content's; 0: all
};

/// Returns words for what becomes of values that the file does not hold. A bake gives none that a float does not hold:
/// PFM clamps nothing.
[[nodiscard]] const char* range_of(const OutputFile& file) noexcept;

/// The names in the folder: its own or, of a container that holds one level of this content, one a level.
[[nodiscard]] std::vector<std::string> names_of(const OutputFile& file, int levels);

/// What `--formats` asks for: of each container everything that it can hold.
[[nodiscard]] std::vector<OutputFile> files_in(const std::set<Container>& containers,
                                               const BakeCommandOptions& options);

/// What `options.orientation.to` loads as it is and, as KTX2, what is asked for beside it (--lobe, --octahedral). The
/// format and supercompression of .ktx2 files are those of the options, where these name them.
[[nodiscard]] std::vector<OutputFile> files_of_engine(const BakeCommandOptions& options);

/// Of a list, those with this content, in its order.
[[nodiscard]] std::vector<OutputFile> files_with(Content content, const std::vector<OutputFile>& files);

[[nodiscard]] bool contains(const std::vector<OutputFile>& files, Content content) noexcept;

/// Whether there is one that Babylon.js reads as RGBD: it has a specular chain of its own, and harmonics.
[[nodiscard]] bool contains_rgbd(const std::vector<OutputFile>& files) noexcept;

/// Whether a bake may call a file so, of whichever engine, formats and sky; not its manifest.
[[nodiscard]] bool is_bake_name(std::string_view name);

/// Whether there is one whose faces lie as the engine looks for them.
[[nodiscard]] bool contains_cubemap(const std::vector<OutputFile>& files) noexcept;

}  // namespace welkin::tool
