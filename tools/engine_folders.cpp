#include "tools/engine_folders.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <sstream>

#include "embedded_texts.h"
#include "tools/text.h"

namespace welkin::tool {
namespace {

/// Whether the lines also load .ktx2 files of other texel formats than the folder's.
enum class Textures : std::uint8_t { fixed, any };

struct EngineFolder {
  Engine engine;
  std::vector<OutputFile> files;
  Textures textures = Textures::fixed;
};

constexpr TexelFormat kHalves = TexelFormat::rgba16f;
constexpr TexelFormat kBlocks = TexelFormat::bc6h_ufloat;
constexpr TexelFormat kPacked = TexelFormat::b10g11r11;
constexpr TexelFormat kShared = TexelFormat::e5b9g9r9;

OutputFile texture(Content content, Container container, TexelFormat format, const char* name, int levels = 0) {
  return {content, container, format, Supercompression::none, name, levels};
}

OutputFile lat_long(Container container) {
  return texture(Content::lat_long, container, kHalves,
                 container == Container::exr ? "environment.exr" : "environment.hdr");
}

OutputFile text_file(Content content, const char* name) { return texture(content, Container::text, kHalves, name); }

const std::vector<EngineFolder>& folders() {
  static const std::vector<EngineFolder> all = {
      {Engine::three,
       {texture(Content::specular, Container::dds, kBlocks, "specular.dds"),
        texture(Content::specular, Container::ktx2, kHalves, "specular.ktx2")}},
      {Engine::babylon,
       {texture(Content::env, Container::env, kHalves, "environment.env"),
        texture(Content::specular, Container::dds, kHalves, "specular.dds")}},
      {Engine::filament,
       {texture(Content::specular, Container::ktx, kPacked, "environment_ibl.ktx"),
        texture(Content::background, Container::ktx, kPacked, "environment_skybox.ktx", 1)}},
      {Engine::bevy,
       {texture(Content::lambert, Container::ktx2, kShared, "diffuse.ktx2"),
        texture(Content::specular, Container::ktx2, kShared, "specular.ktx2"),
        texture(Content::specular, Container::ktx2, kBlocks, "specular_bc6h.ktx2")},
       Textures::any},
      {Engine::gltf,
       {texture(Content::lambert, Container::ktx2, kHalves, "lambertian.ktx2"),
        texture(Content::specular, Container::ktx2, kHalves, "ggx.ktx2"),
        texture(Content::charlie, Container::ktx2, kHalves, "charlie.ktx2"),
        texture(Content::gltf_light, Container::glb, kHalves, "environment.glb")}},
      {Engine::unity, {lat_long(Container::exr)}},
      {Engine::unreal, {lat_long(Container::hdr)}},
      {Engine::blender, {lat_long(Container::exr)}},
      {Engine::godot, {lat_long(Container::exr)}},
      {Engine::usd, {text_file(Content::usd_stage, "environment.usda"), lat_long(Container::exr)}},
  };
  return all;
}

const EngineFolder* folder_of(Engine engine) noexcept {
  const std::vector<EngineFolder>& all = folders();
  const auto found =
      std::ranges::find_if(all, [engine](const EngineFolder& folder) { return folder.engine == engine; });
  return found == all.end() ? nullptr : &*found;
}

constexpr const char* kFirstWords = "# Light for ";
constexpr const char* kLastWords = ", made by Welkin";

}  // namespace

bool has_folder(Engine engine) noexcept { return folder_of(engine) != nullptr; }

std::vector<OutputFile> files_for(Engine engine) {
  std::vector<OutputFile> files = folder_of(engine)->files;
  files.push_back(text_file(Content::readme, kReadmeName));
  return files;
}

bool takes_any_texture(Engine engine) noexcept { return folder_of(engine)->textures == Textures::any; }

bool is_own_readme(const std::string& first_line) noexcept {
  return first_line.starts_with(kFirstWords) && first_line.ends_with(kLastWords);
}

std::string readme_text(Engine engine, const std::vector<std::string>& written) {
  const Convention& axes = convention(engine);
  std::string text = kFirstWords + std::string(axes.title) + kLastWords + "\n\n";
  // Parts of tools/engines/NAME.md begin with the files that they are about, <!-- specular.dds -->; the last with none.
  std::istringstream lines(embedded_text(std::string("engines/") + axes.name + ".md"));
  bool is_shown = false;
  bool any_shown = false;
  for (std::string line; std::getline(lines, line);) {
    if (!line.starts_with("<!-- ")) {
      if (is_shown) text += line + '\n';
      continue;
    }
    std::istringstream files(line.substr(5, line.size() - 5 - 3));
    is_shown = true;
    bool names_files = false;
    for (std::string file; files >> file; names_files = true) {
      is_shown = is_shown && std::ranges::find(written, file) != written.end();
    }
    if (!names_files) is_shown = any_shown;
    any_shown = any_shown || is_shown;
  }
  if (!any_shown) {
    text += "The scene for which this was baked reads none of the files that " + std::string(axes.title) + " loads.\n";
  }
  return text + "\nSizes, roughness and errors are in manifest.json; axes: " + axes.axes + ".\n";
}

std::string usd_stage(const std::string& lat_long) {
  return R"(#usda 1.0
(
    defaultPrim = "Environment"
    metersPerUnit = 1
    upAxis = "Y"
)

def DomeLight "Environment"
{
    float inputs:intensity = 1
    asset inputs:texture:file = @./)" +
         lat_long + R"(@
    token inputs:texture:format = "latlong"
}
)";
}

std::string filament_harmonics(const SphericalHarmonics& radiance) {
  std::string text;
  for (const EngineTerm& term : engine_light(radiance, Engine::filament).terms) {
    text += significant(term.rgb.x) + ' ' + significant(term.rgb.y) + ' ' + significant(term.rgb.z) + '\n';
  }
  return text;
}

}  // namespace welkin::tool
