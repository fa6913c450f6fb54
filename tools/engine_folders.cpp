#include "tools/engine_folders.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <numbers>
#include <sstream>

#include "embedded_texts.h"
#include "math/elementary.h"
#include "tools/input.h"
#include "tools/json.h"
#include "tools/text.h"
#include "welkin/bake_file.h"
#include "welkin/engines.h"
#include "welkin/resampling.h"

namespace welkin::tool {

namespace {

/// Whether the loader also takes .ktx2 files of other texel formats than the folder's.
enum class Textures : std::uint8_t { fixed, any };

struct EngineFolder {
  Engine engine;
  std::vector<OutputFile> files;
  Textures textures = Textures::fixed;
};

constexpr TexelFormat kHalves = TexelFormat::rgba16f;
constexpr TexelFormat kBlocks = TexelFormat::bc6h_ufloat;
constexpr TexelFormat kAnyBlocks = TexelFormat::uastc_hdr_4x4;  // ASTC or BC6H, whichever the GPU reads
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
        texture(Content::specular, Container::ktx2, kHalves, "specular.ktx2"),
        texture(Content::specular, Container::ktx2, kAnyBlocks, "specular_uastc.ktx2")}},
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
      {Engine::playcanvas,
       {texture(Content::playcanvas_atlas, Container::png, kHalves, kAtlasName),
        text_file(Content::playcanvas_asset, "env_atlas.json")}},
      {Engine::qt, {texture(Content::specular, Container::ktx, kHalves, "environment.ktx")}},
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

}  // namespace

bool has_folder(Engine engine) noexcept { return folder_of(engine) != nullptr; }

std::vector<OutputFile> files_for(Engine engine) {
  std::vector<OutputFile> files = folder_of(engine)->files;
  files.push_back(text_file(Content::readme, kReadmeName));
  return files;
}

bool takes_any_texture(Engine engine) noexcept { return folder_of(engine)->textures == Textures::any; }

std::string readme_text(Engine engine, const std::vector<std::string>& written) {
  const Convention& axes = convention(engine);
  std::string text = kReadmeSigns[0] + std::string(axes.title) + kReadmeSigns[1] + '\n';
  // Parts of tools/engines/NAME.md begin with their files, <!-- specular.dds -->; a part that names none is shown if
  // any before it is.
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

namespace {

constexpr const char* kExtension = "EXT_lights_image_based";

// GLB (glTF 2.0, section 4.4): a header of 12 bytes, then chunks of a length, a type, and bytes that end at a multiple
// of four. All numbers are little-endian.
constexpr std::uint32_t kMagic = 0x46546C67;  // "glTF"
constexpr std::uint32_t kVersion = 2;
constexpr std::uint32_t kJsonChunk = 0x4E4F534A;  // "JSON"
constexpr std::uint32_t kBinaryChunk = 0x004E4942;

void append_number(std::uint32_t value, std::string& bytes) {
  for (unsigned shift = 0; shift < 32; shift += 8) bytes.push_back(static_cast<char>((value >> shift) & 0xFFU));
}

void pad(std::string& bytes, char filling) {
  while (bytes.size() % 4 != 0) bytes.push_back(filling);
}

void append_chunk(std::uint32_t type, const std::string& content, std::string& bytes) {
  append_number(static_cast<std::uint32_t>(content.size()), bytes);
  append_number(type, bytes);
  bytes += content;
}

std::string glb(const Json& document, std::string binary) {
  constexpr std::size_t kHeader = 12;
  constexpr std::size_t kChunkHeader = 8;
  std::string text = document.one_line();
  pad(text, ' ');
  pad(binary, '\0');
  const std::size_t size = kHeader + 2 * kChunkHeader + text.size() + binary.size();
  if (size > ~std::uint32_t{0}) {
    throw Error(ErrorCode::limit_exceeded, "environment.glb would have " + std::to_string(size) +
                                               " bytes, and the limit of a .glb is 4 GiB; pass a smaller --size");
  }
  std::string bytes;
  bytes.reserve(size);
  append_number(kMagic, bytes);
  append_number(kVersion, bytes);
  append_number(static_cast<std::uint32_t>(size), bytes);
  append_chunk(kJsonChunk, text, bytes);
  append_chunk(kBinaryChunk, binary, bytes);
  return bytes;
}

int octaves_of(int size) noexcept { return full_chain_levels(size) - 1; }

/// Returns the indices of the RGBD images, six per mip.
Json mips_json(std::size_t rgbd) {
  Json mips = Json::array();
  for (std::size_t first = 0; first < rgbd; first += 6) {
    Json faces = Json::array();
    for (std::size_t image = first; image < first + 6; ++image) faces.push_back(image);
    mips.push_back(faces);
  }
  return mips;
}

/// Makes an object with one member, which braces would make a list.
Json object_of(const char* name, const Json& content) {
  Json object = Json::object();
  object[name] = content;
  return object;
}

/// Makes the extension's object at the root of the document.
Json lights_json(int size, std::size_t rgbd, const std::array<glm::dvec3, 9>& coefficients) {
  Json light = {{"name", "environment"},
                {"intensity", 1.0},
                {"rotation", Json::array({0.0, 0.0, 0.0, 1.0})},
                {"irradianceCoefficients", json_list(coefficients, json_triple)},
                {"specularImageSize", size},
                {"specularImages", mips_json(rgbd)}};
  return object_of("lights", Json::array({light}));
}

/// Returns the `irradianceCoefficients` of `engine_light` for glTF, in the axes in which the loader evaluates them: x
/// is glTF's -x, so indices 3, 4 and 7 change sign.
std::array<glm::dvec3, 9> gltf_light_coefficients(const SphericalHarmonics& radiance) {
  std::array<glm::dvec3, 9> coefficients{};
  const EngineLight light = engine_light(radiance, Engine::gltf);
  for (std::size_t k = 0; k < coefficients.size(); ++k) coefficients[k] = light.terms[k].rgb;
  for (const std::size_t odd_in_x : {3U, 4U, 7U}) coefficients[odd_in_x] *= -1.0;
  return coefficients;
}

}  // namespace

int gltf_light_size(int specular_size) noexcept { return std::max(2, 1 << octaves_of(specular_size)); }

int gltf_light_mips(int size) noexcept {
  constexpr int kLastOctaves = 3;  // 8 texels
  return std::max(2, octaves_of(size) + 1 - kLastOctaves);
}

std::vector<double> gltf_light_roughness(int size, int mips) {
  std::vector<double> table;
  for (int mip = 0; mip < mips; ++mip) {
    const double power = octaves_of(size) * (static_cast<double>(mip) / (mips - 1) - 1.0);  // alpha = 2^power
    table.push_back(mip == 0 ? 0.0 : math::exponential(0.5 * std::numbers::ln2 * power));
  }
  return table;
}

GltfLight gltf_light(const Cubemap& specular, const SphericalHarmonics& radiance, const Control& control) {
  // The loader also looks faces up in Babylon.js's axes, whose x is glTF's -x.
  const Cubemap faces = mirrored_x(rotate(specular, faces_of(Engine::gltf), control));
  const RgbdImages rgbd = rgbd_images(faces, control);
  std::string binary;
  Json views = Json::array();
  Json images = Json::array();
  for (const std::vector<std::uint8_t>& png : rgbd.png) {
    pad(binary, '\0');
    images.push_back({{"bufferView", images.size()}, {"mimeType", "image/png"}});
    views.push_back({{"buffer", 0}, {"byteOffset", binary.size()}, {"byteLength", png.size()}});
    binary.append(png.begin(), png.end());
  }
  pad(binary, '\0');
  const Json scene = object_of("extensions", object_of(kExtension, object_of("light", 0)));
  const Json document = {{"asset", {{"version", "2.0"}, {"generator", std::string("Welkin ") + WELKIN_VERSION_STRING}}},
                         {"extensionsUsed", Json::array({kExtension})},
                         {"extensions", object_of(kExtension, lights_json(faces.size(), rgbd.png.size(),
                                                                          gltf_light_coefficients(radiance)))},
                         {"scene", 0},
                         {"scenes", Json::array({scene})},
                         {"images", images},
                         {"bufferViews", views},
                         {"buffers", Json::array({object_of("byteLength", binary.size())})}};
  return {glb(document, std::move(binary)), rgbd.values_clamped};
}

namespace {

// EnvLighting of PlayCanvas 2.23, for an atlas of 512 texels; all lengths scale with it.
constexpr int kUnit = 512;
constexpr int kSharpLevels = 6;

struct Rectangle {
  int left = 0;
  int top = 0;
  int width = 0;
  int height = 0;
};

/// Stores a texel as RGBP: sqrt(radiance) = c (8 - 7 a), with the largest a that the largest channel permits.
void put(const float* radiance, int column, int row, PlayCanvasAtlas& atlas) {
  const std::size_t index =
      static_cast<std::size_t>(row) * static_cast<std::size_t>(atlas.size) + static_cast<std::size_t>(column);
  std::uint8_t* const texel = atlas.rgba.data() + 4 * index;
  float root[3];
  float largest = 1.0F;
  for (int channel = 0; channel < 3; ++channel) {
    const float value = radiance[channel];
    const bool is_held = value >= 0.0F && value <= static_cast<float>(kLargestRgbp);
    if (!is_held) ++atlas.values_clamped;
    root[channel] = std::sqrt(is_held ? value : value > 0.0F ? static_cast<float>(kLargestRgbp) : 0.0F);
    largest = std::max(largest, root[channel]);
  }
  const float steps = std::floor(255.0F * (8.0F - largest) / 7.0F);  // rounded down, so that no channel is above 1
  const float scale = 255.0F / (8.0F - 7.0F * steps / 255.0F);
  for (int channel = 0; channel < 3; ++channel) {
    texel[channel] = static_cast<std::uint8_t>(std::min(255.0F, std::floor(root[channel] * scale + 0.5F)));
  }
  texel[3] = static_cast<std::uint8_t>(steps);
}

/// Draws a lat-long inside a seam that continues it: around, and over the poles.
void draw(const CubemapView& source, ResampleFilter filter, const Rectangle& at, PlayCanvasAtlas& atlas,
          const Control& control) {
  const int seam = atlas.size / kUnit;
  const int width = at.width - 2 * seam;
  const int height = at.height - 2 * seam;
  // A result coarser than its source averages the source's texels. Rough mips are interpolated by the shader, so texels
  // hold the values at their centres: those of a finer result.
  int finer = 1;
  while (filter == ResampleFilter::bilinear && finer * width < 4 * source.size) finer += 2;
  const LatLongImage image = to_lat_long(source, finer * width, finer * height, dmat3(1.0), filter, {control.stop, {}});
  for (int row = 0; row < at.height; ++row) {
    const int wanted = row - seam;
    const bool is_beyond_pole = wanted < 0 || wanted >= height;
    const int from = wanted < 0 ? -1 - wanted : wanted >= height ? 2 * height - 1 - wanted : wanted;
    for (int column = 0; column < at.width; ++column) {
      const int around = column - seam + width + (is_beyond_pole ? width / 2 : 0);
      const auto texel = static_cast<std::size_t>(finer * from + finer / 2) * static_cast<std::size_t>(finer * width) +
                         static_cast<std::size_t>(finer * (around % width) + finer / 2);
      put(image.pixels.data() + 3 * texel, at.left + column, at.top + row, atlas);
    }
  }
}

}  // namespace

int atlas_size(int specular_size) noexcept { return kUnit * std::max(1, 2 * specular_size / kUnit); }

PlayCanvasAtlas playcanvas_atlas(const Cubemap& specular, const CubemapView& diffuse, bool ends_in_diffuse,
                                 const Control& control) {
  PlayCanvasAtlas atlas{atlas_size(specular.size()), {}, 0};
  const auto edge = static_cast<std::size_t>(atlas.size);
  atlas.rgba.assign(4 * edge * edge, 0);
  const int scale = atlas.size / kUnit;
  Rectangle sharp{0, 0, atlas.size, atlas.size / 2};
  for (int level = 0; level < kSharpLevels; ++level) {
    draw(specular.view(0), ResampleFilter::area, sharp, atlas, control);
    sharp = {sharp.left + sharp.height, sharp.top + sharp.height, sharp.width / 2, sharp.height / 2};
  }
  Rectangle rough{0, atlas.size / 2, atlas.size / 2, atlas.size / 4};
  for (int level = 1; level <= kAtlasMips; ++level) {  // the shader does not read the last
    const int mip = std::min({level, kAtlasMips - 1, specular.levels() - 1});
    const bool is_diffuse = ends_in_diffuse && level >= kAtlasMips - 1;
    draw(is_diffuse ? diffuse : specular.view(mip), ResampleFilter::bilinear, rough, atlas, control);
    rough = {0, rough.top + rough.height, rough.width / 2, rough.height / 2};
  }
  draw(diffuse, ResampleFilter::bilinear, {128 * scale, 384 * scale, 64 * scale, 32 * scale}, atlas, control);
  return atlas;
}

std::string playcanvas_asset(const std::string& file) {
  const Json asset = {{"name", file.substr(0, file.rfind('.'))},
                      {"type", "texture"},
                      {"file", {{"filename", file}, {"url", file}}},
                      {"data",
                       {{"type", "rgbp"},
                        {"mipmaps", false},
                        {"minfilter", "linear"},
                        {"magfilter", "linear"},
                        {"addressu", "clamp"},
                        {"addressv", "clamp"}}}};
  return json_text(asset) + '\n';
}

}  // namespace welkin::tool
