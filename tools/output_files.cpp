#include "tools/output_files.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <functional>
#include <limits>

#include "tools/bake_options.h"
#include "tools/engine_folders.h"

namespace welkin::tool {
namespace {

constexpr std::array kContainerNames{"ktx2", "dds", "exr", "hdr", "pfm", "env", "ktx", "glb", "png", "text"};
static_assert(kContainerNames.size() == static_cast<std::size_t>(Container::text) + 1);

constexpr std::array kContentNames{
    "environment", "environment", "environment", "environment", "environment", "specular_octahedral",
    "background",  "specular",    "charlie",     "lambert",     "phong",       "irradiance",
    "brdf",        "dome light",  "readme"};
static_assert(kContentNames.size() == static_cast<std::size_t>(Content::readme) + 1);

struct FormatTraits {
  const char* name;
  glm::dvec3 largest;
  const char* range;
};

constexpr glm::dvec3 kLargestHalf(65504.0);
constexpr const char* kRangeOfAstc = "below 0 or above 65504 clamped: ASTC ends there";
constexpr std::array<FormatTraits, 9> kFormats{
    {{"rgba16f", kLargestHalf, "beyond +-65504, the range of half floats, clamped"},
     {"rgba32f", glm::dvec3(std::numeric_limits<float>::max()), "that are not finite replaced"},
     {"b10g11r11", {65024.0, 65024.0, 64512.0}, "below 0 or above 65024 (blue: 64512) clamped: b10g11r11 ends there"},
     {"e5b9g9r9", glm::dvec3(65408.0), "below 0 or above 65408 clamped: e5b9g9r9 ends there"},
     {"bc6h", kLargestHalf, "below 0 or above 65504 clamped: unsigned BC6H ends there"},
     {"bc6h-signed", kLargestHalf, "beyond +-65504 clamped: BC6H ends there"},
     {"astc4x4", kLargestHalf, kRangeOfAstc},
     {"astc6x6", kLargestHalf, kRangeOfAstc},
     {"uastc-hdr", kLargestHalf, kRangeOfAstc}}};
static_assert(kFormats.size() == static_cast<std::size_t>(TexelFormat::uastc_hdr_4x4) + 1);

const FormatTraits& traits(TexelFormat format) noexcept { return kFormats.at(static_cast<std::size_t>(format)); }

/// Returns a format that the container holds: OpenEXR half floats or floats, DDS also BC6H, KTX all but ASTC.
/// Irradiance is not compressed: near 0, errors of blocks are relatively large. A table holds half floats or floats.
TexelFormat stored_format(Content content, Container container, TexelFormat wanted) {
  if (wanted == TexelFormat::rgba32f) return wanted;
  const bool is_smooth = content == Content::irradiance || content == Content::lambert;
  if (is_in_blocks(wanted) && is_smooth) return TexelFormat::rgba16f;
  if (is_in_blocks(wanted) && !is_bc6h(wanted) && container != Container::ktx2) return TexelFormat::rgba16f;
  if (content == Content::brdf || container == Container::exr) return TexelFormat::rgba16f;
  if (container == Container::dds && !is_bc6h(wanted)) return TexelFormat::rgba16f;
  return wanted;
}

OutputFile file_of(Content content, Container container, const TextureOptions& texture) {
  return {content, container, stored_format(content, container, texture.format),
          container == Container::ktx2 ? texture.supercompression : Supercompression::none,
          std::string(name(content)) + '.' + name(container)};
}

bool holds_all_levels(const OutputFile& file) {
  if (file.container == Container::exr) return file.content != Content::octahedral;
  return file.container != Container::hdr && file.container != Container::pfm;
}

/// Returns the cubemaps of a bake, in the order in which they are written.
std::vector<Content> cubemaps_of(const BakeCommandOptions& options) {
  std::vector<Content> cubemaps = {Content::background, Content::specular};
  for (const LobeFamily lobe : options.lobes) cubemaps.push_back(content_of(lobe));
  if (options.irradiance_size > 0) cubemaps.push_back(Content::irradiance);
  return cubemaps;
}

}  // namespace

const char* name(Container container) noexcept { return kContainerNames.at(static_cast<std::size_t>(container)); }

const char* name(TexelFormat format) noexcept { return traits(format).name; }
const glm::dvec3& largest_of(TexelFormat format) noexcept { return traits(format).largest; }

std::vector<std::pair<std::string, TexelFormat>> texel_formats() {
  std::vector<std::pair<std::string, TexelFormat>> formats;
  formats.reserve(std::size(kFormats));
  for (const FormatTraits& each : kFormats) formats.emplace_back(each.name, static_cast<TexelFormat>(formats.size()));
  return formats;
}

const char* range_of(const OutputFile& file) noexcept {
  if (file.container == Container::hdr) return "below 0 or above 1.69e38 clamped: RGBE ends there";
  return file.container == Container::pfm ? "" : traits(file.format).range;
}

bool is_bc6h(TexelFormat format) noexcept {
  return format == TexelFormat::bc6h_ufloat || format == TexelFormat::bc6h_sfloat;
}

bool is_in_blocks(TexelFormat format) noexcept {
  return is_bc6h(format) || format == TexelFormat::astc_4x4_hdr || format == TexelFormat::astc_6x6_hdr ||
         format == TexelFormat::uastc_hdr_4x4;
}

const char* name(Content content) noexcept { return kContentNames.at(static_cast<std::size_t>(content)); }

Content content_of(LobeFamily lobe) noexcept {
  if (lobe == LobeFamily::charlie) return Content::charlie;
  return lobe == LobeFamily::lambert ? Content::lambert : Content::phong;
}

std::vector<std::string> names_of(const OutputFile& file, int levels) {
  if (levels <= 1 || holds_all_levels(file)) return {file.name};
  const std::size_t dot = file.name.rfind('.');
  std::vector<std::string> names;
  names.reserve(static_cast<std::size_t>(levels));
  for (int level = 0; level < levels; ++level) {
    names.push_back(file.name.substr(0, dot) + "_m" + std::to_string(level) + file.name.substr(dot));
  }
  return names;
}

std::vector<OutputFile> files_in(const std::set<Container>& containers, const BakeCommandOptions& options) {
  std::vector<OutputFile> files;
  const auto add = [&](Content content, std::initializer_list<Container> able) {
    bool any = false;
    for (const Container container : able) {
      if (!containers.contains(container)) continue;
      files.push_back(file_of(content, container, options.texture));
      any = true;
    }
    return any;
  };
  add(Content::env, {Container::env});
  add(Content::lat_long, {Container::exr, Container::hdr, Container::pfm});
  if (options.octahedral_size > 0) add(Content::octahedral, {Container::ktx2, Container::exr});
  for (const Content cubemap : cubemaps_of(options)) {
    add(cubemap, {Container::ktx2, Container::dds, Container::exr, Container::hdr, Container::pfm, Container::ktx});
  }
  if (options.no_brdf) return files;
  const bool babylon_alone = containers == std::set<Container>{Container::env};  // Babylon.js has its own table
  if (!add(Content::brdf, {Container::ktx2, Container::dds}) && !babylon_alone) {
    files.push_back(file_of(Content::brdf, Container::pfm, options.texture));
  }
  return files;
}

std::vector<OutputFile> files_of_engine(const BakeCommandOptions& options) {
  std::vector<OutputFile> files;
  const auto add = [&files](OutputFile file) {
    const auto same = [&file](const OutputFile& other) {
      return other.content == file.content && other.container == file.container && other.format == file.format;
    };
    if (std::ranges::none_of(files, same)) files.push_back(std::move(file));
  };
  for (OutputFile file : files_for(options.orientation.to)) {
    if (file.container == Container::ktx2) {
      if (options.format_named && takes_any_texture(options.orientation.to))
        file.format = stored_format(file.content, file.container, options.texture.format);
      file.supercompression = options.texture.supercompression;
    }
    if (file.container == Container::exr)
      file.format = stored_format(file.content, file.container, options.texture.format);
    add(std::move(file));
  }
  if (options.octahedral_size > 0) add(file_of(Content::octahedral, Container::ktx2, options.texture));
  for (const LobeFamily lobe : options.lobes) {
    if (!contains(files, content_of(lobe))) add(file_of(content_of(lobe), Container::ktx2, options.texture));
  }
  return files;
}

std::vector<OutputFile> files_with(Content content, const std::vector<OutputFile>& files) {
  std::vector<OutputFile> found;
  std::ranges::copy_if(files, std::back_inserter(found),
                       [content](const OutputFile& file) { return file.content == content; });
  return found;
}

bool contains(const std::vector<OutputFile>& files, Content content) noexcept {
  return std::ranges::any_of(files, [content](const OutputFile& file) { return file.content == content; });
}

bool contains_rgbd(const std::vector<OutputFile>& files) noexcept {
  return contains(files, Content::env) || contains(files, Content::gltf_light);
}

namespace {

/// Returns the names of all files that a bake can write; for strips of mips, the name of the first.
std::set<std::string, std::less<>> all_bake_names() {
  constexpr std::array kContainers{Container::ktx2, Container::dds, Container::exr, Container::hdr,
                                   Container::pfm,  Container::env, Container::ktx};
  constexpr std::array kContents{Content::lat_long, Content::octahedral, Content::background,
                                 Content::specular, Content::charlie,    Content::lambert,
                                 Content::phong,    Content::irradiance, Content::brdf};
  std::set<std::string, std::less<>> names = {
      "sh.json",          "sh.h",        "sh.cs", "sky.exr", "preview_environment.png", "preview_spheres.png",
      "preview_mips.png", "preview.html"};
  for (const Content content : kContents) {
    for (const Container container : kContainers) names.insert(std::string(name(content)) + '.' + name(container));
  }
  for (const Convention& each : conventions()) {
    if (!has_folder(each.engine)) continue;
    for (const OutputFile& file : files_for(each.engine)) names.insert(file.name);
  }
  return names;
}

}  // namespace

bool is_bake_name(std::string_view name) {
  static const std::set<std::string, std::less<>> names = all_bake_names();
  if (names.contains(name)) return true;
  const std::size_t dot = name.rfind('.');
  const std::size_t mip = name.rfind("_m");
  if (dot == std::string_view::npos || mip == std::string_view::npos || mip > dot) return false;
  const std::string_view number = name.substr(mip + 2, dot - mip - 2);
  const bool is_number = !number.empty() && number.find_first_not_of("0123456789") == std::string_view::npos;
  return is_number && names.contains(std::string(name.substr(0, mip)) + std::string(name.substr(dot)));
}

bool contains_cubemap(const std::vector<OutputFile>& files) noexcept {
  constexpr std::array kOthers{
      Content::env,       Content::gltf_light, Content::lat_long,         Content::octahedral,      Content::brdf,
      Content::usd_stage, Content::readme,     Content::playcanvas_atlas, Content::playcanvas_asset};
  return std::ranges::any_of(
      files, [&](const OutputFile& file) { return std::ranges::find(kOthers, file.content) == kOthers.end(); });
}

}  // namespace welkin::tool
