#include <algorithm>
#include <cmath>
#include <cstddef>
#include <iterator>
#include <numbers>
#include <optional>
#include <utility>

#include "files/env.h"
#include "jobs/tiles.h"
#include "platform/text.h"
#include "tools/bake_manifest.h"
#include "tools/engine_folders.h"
#include "tools/sh_command.h"
#include "tools/terminal.h"
#include "tools/text.h"
#include "welkin/bake_file.h"
#include "welkin/core.h"
#include "welkin/resampling.h"
#include "welkin/spherical_harmonics.h"

namespace welkin::tool {
namespace {

/// One cubemap of the result, and its description.
struct Subject {
  Content content;
  std::string what;
  std::vector<CubemapView> mips;
  std::vector<double> roughness;  ///< of each mip; empty if it is not blurred
  std::string unit;
};

/// The state that all writers below share.
struct Job {
  const BakeCommandOptions& options;
  OutputFolder& folder;
  const Control& control;
  const SphericalHarmonics* radiance = nullptr;  ///< in Welkin's axes; null without harmonics
};

std::string numbers_text(const std::vector<double>& values) { return listed(values, all_digits, " "); }

Json details_of(const Subject& cubemap, const Job& job) {
  Json details = {{"size", cubemap.mips.front().size}, {"mips", cubemap.mips.size()}};
  if (!cubemap.roughness.empty()) details["roughness"] = cubemap.roughness;
  details["unit"] = cubemap.unit;
  details["axes"] = convention(job.options.orientation.to).name;
  return details;
}

Json details_of(const LatLongImage& image) {
  return {{"width", image.width}, {"height", image.height}, {"unit", "radiance"}};
}

constexpr const char* kWithoutSun = "--extract-sun makes the sun a separate light";

/// Returns the options that keep the light that a format does not hold.
std::string remedy_for(const OutputFile& file, const BakeCommandOptions& options) {
  const bool holds_floats = file.container != Container::hdr && file.container != Container::env &&
                            file.container != Container::glb && file.format != TexelFormat::rgba32f;
  const bool may_choose =
      !is_engine_folder(options) || takes_any_texture(options.orientation.to) || file.content == Content::lat_long;
  const std::string floats = holds_floats && may_choose ? "--ktx2-format rgba32f keeps it" : "";
  if (!options.input || options.sun.take_out) return floats;
  return floats + (floats.empty() ? "" : ", ") + kWithoutSun;
}

TextureOptions texture_options(const OutputFile& file, const Subject& cubemap, const Job& job) {
  TextureOptions options = job.options.texture;
  options.format = file.format;
  options.supercompression = file.supercompression;
  options.metadata = {{"welkin.content", name(cubemap.content)},
                      {"welkin.unit", cubemap.unit},
                      {"welkin.axes", convention(job.options.orientation.to).name},
                      {"welkin.version", WELKIN_VERSION_STRING}};
  if (!cubemap.roughness.empty()) options.metadata["welkin.roughness"] = numbers_text(cubemap.roughness);
  if (job.radiance != nullptr && file.content == Content::specular && stores_harmonics(job.options)) {
    options.metadata["sh"] = filament_harmonics(*job.radiance);
  }
  // Without this entry Qt takes the faces for images to be filtered.
  if (job.options.orientation.to == Engine::qt && file.container == Container::ktx) {
    options.metadata["QT_IBL_BAKER_VERSION"] = "1";
  }
  return options;
}

/// Returns a warning about blocks of small mips, which cover much of the sphere and differ inside; none where the user
/// does not choose the number of mips: for an engine's files, and for cubemaps that are not blurred.
std::string caution_of(TexelFormat format, const Subject& cubemap, const BakeCommandOptions& options) {
  constexpr int kEnough = 32;
  const int last = cubemap.mips.back().size;
  if (is_engine_folder(options) && !options.specular.mips) return "";
  if (!is_in_blocks(format) || cubemap.roughness.empty() || last >= kEnough) return "";
  return "its last mip has " + counted(static_cast<std::uint64_t>(last), "texel") + " per edge; below 32 " +
         (is_bc6h(format) ? "BC6H" : "ASTC") +
         " is off by 3 to 10 %. End the chain sooner (--mips) or make it larger (--size)";
}

/// Returns the format for a person: "KTX2 rgba16f zstd".
std::string format_text(const OutputFile& file) {
  const char* const container = file.container == Container::ktx2  ? "KTX2 "
                                : file.container == Container::ktx ? "KTX "
                                : file.container == Container::dds ? "DDS "
                                                                   : "OpenEXR ";
  std::string text = container;
  text += name(file.format);
  if (file.supercompression == Supercompression::zlib) text += " zlib";
  if (file.supercompression == Supercompression::zstd) text += " zstd";
  return text;
}

/// Notes how much light a format's limit takes from an image or the first level of a chain, and how to keep it.
template <class View>
WrittenFile with_loss(WrittenFile file, const View& view, const glm::dvec3& largest, std::string remedy) {
  if (file.values_clamped == 0) return file;
  file.share_clamped = share_beyond(view, largest);
  file.remedy = std::move(remedy);
  return file;
}

void write_texture_file(const OutputFile& file, const Subject& cubemap, const Job& job) {
  const TextureOptions options = texture_options(file, cubemap, job);
  const WriteReport report = write_texture(job.folder.place(file.name), cubemap.mips, options, {job.control.stop, {}});
  const WrittenFile written{file.name,
                            cubemap.what,
                            format_text(file),
                            details_of(cubemap, job),
                            report.values_clamped,
                            range_of(file),
                            caution_of(options.format, cubemap, job.options)};
  job.folder.add(with_loss(written, cubemap.mips.front(), largest_of(options.format), remedy_for(file, job.options)));
}

/// Writes a vertical strip per mip: .hdr and .pfm have no mips.
void write_strips(const OutputFile& file, const Subject& cubemap, const Job& job) {
  const std::vector<std::string> names = names_of(file, static_cast<int>(cubemap.mips.size()));
  for (std::size_t mip = 0; mip < cubemap.mips.size(); ++mip) {
    WriteOptions options;
    options.layout = Layout::vertical_strip;
    const WriteReport report =
        write_environment(job.folder.place(names[mip]), cubemap.mips[mip], options, {job.control.stop, {}});
    Json details = {{"layout", welkin::name(options.layout)}, {"size", cubemap.mips[mip].size}, {"mip", mip}};
    if (!cubemap.roughness.empty()) details["roughness"] = cubemap.roughness[mip];
    details["unit"] = cubemap.unit;
    details["axes"] = convention(job.options.orientation.to).name;
    job.folder.add({names[mip], cubemap.what, file.container == Container::hdr ? "Radiance RGBE" : "PFM", details,
                    report.values_clamped, range_of(file)});
  }
}

/// Keeps the first levels; 0 keeps all.
Subject with_levels(Subject cubemap, int levels) {
  const auto most = static_cast<std::size_t>(levels);
  if (levels > 0 && cubemap.mips.size() > most) cubemap.mips.resize(most);
  if (levels > 0 && cubemap.roughness.size() > most) cubemap.roughness.resize(most);
  return cubemap;
}

void write_cubemap(const Subject& cubemap, const Job& job) {
  if (cubemap.mips.empty()) return;
  for (const OutputFile& file : files_with(cubemap.content, job.options.files)) {
    const bool strips = file.container == Container::hdr || file.container == Container::pfm;
    const Subject content = with_levels(cubemap, file.levels);
    if (strips) {
      write_strips(file, content, job);
    } else {
      write_texture_file(file, content, job);
    }
  }
}

/// Writes the environment as a lat-long, the same image for all engines.
void write_lat_longs(const LatLongImage& image, const Job& job) {
  for (const OutputFile& file : files_with(Content::lat_long, job.options.files)) {
    const bool is_exr = file.container == Container::exr;
    const bool floats = is_exr && file.format == TexelFormat::rgba32f;
    WriteOptions options;
    if (floats) options.type = SampleType::float32;
    const WriteReport report =
        write_environment(job.folder.place(file.name), image.view(), options, {job.control.stop, {}});
    const char* const format = floats                             ? "OpenEXR float"
                               : is_exr                           ? "OpenEXR half"
                               : file.container == Container::hdr ? "Radiance RGBE"
                                                                  : "PFM";
    const WrittenFile written{file.name,         "the environment as a lat-long", format,
                              details_of(image), report.values_clamped,           range_of(file)};
    job.folder.add(is_exr ? with_loss(written, image.view(), largest_of(file.format), remedy_for(file, job.options))
                          : written);
  }
}

/// Writes the selected OpenUSD stages, with the lat-long next to each.
void write_usd_stages(const Job& job) {
  for (const OutputFile& file : files_with(Content::usd_stage, job.options.files)) {
    job.folder.write({file.name, "a dome light with the lat-long", "OpenUSD text"},
                     usd_stage(files_with(Content::lat_long, job.options.files).front().name));
  }
}

/// Returns the radiance of a white surface.
Cubemap over_pi(const Cubemap& irradiance) {
  Cubemap radiance = irradiance;
  for (float& value : radiance.pixels()) value *= std::numbers::inv_pi_v<float>;
  return radiance;
}

std::vector<double> roughness_of(const PrefilteredSpecular& specular) {
  std::vector<double> table;
  for (const MipRecord& mip : specular.mips) table.push_back(mip.roughness);
  return table;
}

/// Writes PlayCanvas' atlas and the asset that loads it. `light` is in Welkin's axes.
void write_playcanvas(const BakeResult& light, const Job& job) {
  if (!light.specular) return;
  for (const OutputFile& file : files_with(Content::playcanvas_atlas, job.options.files)) {
    const Cubemap& chain = light.specular->cubemap;
    const Cubemap white = light.irradiance ? over_pi(*light.irradiance) : Cubemap();
    // The lobe of roughness 1, that of the last mip, is the cosine lobe.
    const CubemapView diffuse = light.irradiance ? white.view() : chain.view(chain.levels() - 1);
    const bool is_finer =
        light.specular->mips.back().roughness >= 1.0 && diffuse.size > chain.level_size(chain.levels() - 1);
    const PlayCanvasAtlas atlas = playcanvas_atlas(chain, diffuse, is_finer, job.control);
    const std::vector<std::uint8_t> png = files::encode_png_rgba(atlas.rgba, atlas.size, job.control.stop);
    const WrittenFile written{
        file.name,
        "PlayCanvas' envAtlas: reflections and diffuse light",
        "PNG, RGBP",
        {{"size", atlas.size}, {"roughness", roughness_of(*light.specular)}, {"axes", "playcanvas"}},
        atlas.values_clamped,
        "above 64 or below 0, the range of RGBP, clamped"};
    const bool may_take_sun_out = job.options.input && !job.options.sun.take_out;
    job.folder.write(with_loss(written, chain.view(0), glm::dvec3(kLargestRgbp), may_take_sun_out ? kWithoutSun : ""),
                     {png.begin(), png.end()});
  }
  for (const OutputFile& file : files_with(Content::playcanvas_asset, job.options.files)) {
    job.folder.write({file.name, "the asset that loads the atlas", "JSON"}, playcanvas_asset(kAtlasName));
  }
}

/// Writes README.md: how the engine loads the files.
void write_readme(const Job& job) {
  for (const OutputFile& file : files_with(Content::readme, job.options.files)) {
    std::vector<std::string> written;
    for (const WrittenFile& each : job.folder.files()) written.push_back(each.name);
    job.folder.write({file.name, "how the engine loads the files", "Markdown"},
                     readme_text(job.options.orientation.to, written));
  }
}

/// Writes the computed image with all its bits: baking it again gives the same files.
void write_computed(const LatLongImage& image, const Job& job) {
  if (image.width == 0) return;
  WriteOptions options;
  options.type = SampleType::float32;
  const std::string& file = job.options.image_name;
  write_environment(job.folder.place(file), image.view(), options, {job.control.stop, {}});
  job.folder.add({file, "the source as a lat-long", "OpenEXR float", details_of(image)});
}

void turn_to_engine(BakeResult& light, const glm::dmat3& symmetry, const Control& control) {
  if (symmetry == glm::dmat3(1.0)) return;
  if (light.background) light.background = rotate(*light.background, symmetry, control);
  if (light.specular) light.specular->cubemap = rotate(light.specular->cubemap, symmetry, control);
  if (light.irradiance) light.irradiance = rotate(*light.irradiance, symmetry, control);
}

/// Writes the specular chain as an octahedral map, in Welkin's axes, which are Godot's.
void write_octahedral_maps(const BakeResult& light, const Job& job) {
  if (!light.octahedral) return;
  const OctahedralMap& map = *light.octahedral;
  for (const OutputFile& file : files_with(Content::octahedral, job.options.files)) {
    TextureOptions texture = job.options.texture;
    texture.format = file.format;
    texture.supercompression = file.supercompression;
    std::vector<double> roughness = roughness_of(*light.specular);
    roughness.resize(map.levels.size());
    texture.metadata = {{"welkin.content", "specular"}, {"welkin.roughness", numbers_text(roughness)}};
    const WriteReport report = write_octahedral(job.folder.place(file.name), map, texture, {job.control.stop, {}});
    const Json details = {{"size", map.size},       {"border", map.border}, {"mips", map.levels.size()},
                          {"roughness", roughness}, {"unit", "radiance"},   {"axes", "welkin"}};
    for (const std::filesystem::path& path : report.files) {
      job.folder.add({platform::utf8(path.filename()), "the specular cubemap as an octahedral map", format_text(file),
                      details, report.values_clamped, range_of(file)});
    }
  }
}

/// Returns three channels; the third is 0 if the table has two.
LatLongImage image_of(const BrdfTable& table) {
  LatLongImage image{table.options.width, table.options.height, {}};
  const auto channels = static_cast<std::size_t>(table.channels);
  for (std::size_t at = 0; at < table.values.size(); at += channels) {
    for (std::size_t channel = 0; channel < 3; ++channel) {
      image.pixels.push_back(channel < channels ? table.values[at + channel] : 0.0F);
    }
  }
  return image;
}

/// Writes the table in each selected container that can hold a plain image.
void write_brdf(const BrdfTable& table, const BakeCommandOptions& options, OutputFolder& folder,
                const Control& control) {
  const LatLongImage image = image_of(table);
  constexpr const char* kWhat = "BRDF table: columns along N.V, rows along roughness, smoothest first";
  const Json details = {{"width", image.width}, {"height", image.height}, {"channels", brdf_channels(table.options)}};
  for (const OutputFile& file : files_with(Content::brdf, options.files)) {
    if (file.container == Container::pfm) {
      WriteOptions write;
      write.layout = Layout::lat_long;  // a plain image, to a PFM
      write_environment(folder.place(file.name), image.view(), write, {control.stop, {}});
      folder.add({file.name, kWhat, "PFM", details});
      continue;
    }
    TextureOptions texture;
    texture.format = file.format;
    texture.supercompression = file.supercompression;
    if (file.container == Container::ktx2) texture.metadata = {{"welkin.content", name(file.content)}};
    write_texture_2d(folder.place(file.name), image.width, image.height, image.pixels.data(), texture,
                     {control.stop, {}});
    folder.add({file.name, kWhat, format_text(file), details});
  }
}

constexpr const char* kRangeOfRgbd = "above 255 or below 0, the range of RGBD, clamped";
constexpr double kLargestRgbd = 255.0;

/// Returns the chain that files in RGBD hold, in Welkin's axes.
const PrefilteredSpecular& rgbd_chain(const Baked& baked) {
  return baked.env_is_specular ? *baked.light.specular : *baked.env;
}

/// Returns the source's harmonics, or those that it stores: mip 0 of RGBD ends at 255.
const SphericalHarmonics& rgbd_radiance(const Baked& baked) {
  return baked.stored_light ? baked.stored_light->radiance : *baked.light.radiance;
}

WrittenFile rgbd_file(const WrittenFile& file, const Baked& baked) {
  return with_loss(file, rgbd_chain(baked).cubemap.view(0), glm::dvec3(kLargestRgbd),
                   baked.sun_wanted ? "" : kWithoutSun);
}

/// Writes environment.env, in Babylon.js's axes.
void write_env(const Baked& baked, const std::string& file, OutputFolder& folder, const Control& control) {
  const PrefilteredSpecular& specular = rgbd_chain(baked);
  const SphericalHarmonics& radiance = rgbd_radiance(baked);
  const Cubemap diffuse = baked.light.irradiance ? over_pi(*baked.light.irradiance) : Cubemap();
  BabylonEnvironment environment = to_babylon(specular.cubemap, radiance, diffuse);
  if (diffuse.size() > 0) {
    // For materials whose diffuse light depends on its direction (Burley, EON).
    const glm::dmat3& into_babylon = convention(Engine::babylon).from_welkin;
    if (const auto light = dominant_light(radiance)) environment.dominant_direction = into_babylon * light->direction;
  }
  const WriteReport report = write_babylon_environment(folder.place(file), environment, control);
  const Json details = {{"size", environment.specular.size()},
                        {"mips", environment.specular.levels()},
                        {"roughness", roughness_of(specular)},
                        {"axes", "babylon"},
                        {"lod_generation_scale", environment.lod_generation_scale},
                        {"irradiance_size", environment.irradiance.size()},
                        {"polynomial", baked.stored_light ? "as stored in the input" : "from the source's harmonics"}};
  folder.add(
      rgbd_file({file,
                 diffuse.size() > 0 ? "for Babylon.js: specular cubemap, diffuse light as a cubemap and as a polynomial"
                                    : "for Babylon.js: specular cubemap, and diffuse light as a polynomial",
                 "Babylon.js .env, RGBD in PNG", details, report.values_clamped, kRangeOfRgbd},
                baked));
}

/// Writes environment.glb, a light of EXT_lights_image_based.
void write_gltf_light(const Baked& baked, const std::string& file, OutputFolder& folder, const Control& control) {
  const PrefilteredSpecular& specular = rgbd_chain(baked);
  const GltfLight light = gltf_light(specular.cubemap, rgbd_radiance(baked), control);
  const Json details = {{"size", specular.cubemap.size()},
                        {"mips", specular.cubemap.levels()},
                        {"roughness", roughness_of(specular)},
                        {"axes", "gltf"}};
  folder.write(
      rgbd_file({file, "a light of EXT_lights_image_based: specular cubemap, and diffuse light as coefficients",
                 "glTF 2.0 binary, RGBD in PNG", details, light.values_clamped, kRangeOfRgbd},
                baked),
      light.bytes);
}

ShReport report_of(const Baked& baked, const BakeCommandOptions& options) {
  const SphericalHarmonics& light = *baked.light.radiance;
  OrientationOptions to_engine;
  to_engine.to = options.orientation.to;
  const glm::dmat3 matrix = light_rotation(to_engine, false);

  ShReport report;
  report.source = baked.source;
  report.source.path = options.called.empty() ? portable_path(baked.source.path) : options.called;
  report.options.pixels = baked.options.pixels;
  report.options.bands = light.bands();
  report.projection = {rotate(light, matrix), baked.light.diagnostics};
  report.projection.diagnostics.passes.clear();  // the manifest has the times
  report.axes = axes_text(options.orientation);
  report.engine = options.orientation.to;
  report.sky = baked.sky;
  report.sun_wanted = baked.sun_wanted;
  report.sun = baked.sun;
  if (report.sun) report.sun->direction = matrix * report.sun->direction;
  report.dominant = dominant_light(report.projection.radiance);
  report.windowed = apply_window(report.projection.radiance, Window::none);
  report.irradiance = irradiance_from_radiance(report.projection.radiance);
  report.polynomial = babylon_polynomial(report.projection.radiance);
  for (const Convention& each : conventions()) {
    if (has_engine_light(each.engine)) report.engine_lights.push_back(engine_light(light, each.engine));
  }
  return report;
}

/// Writes sh.json and, if floats hold the light, source code with the same values.
void write_harmonics(Baked& baked, const BakeCommandOptions& options, OutputFolder& folder) {
  if (options.bake.bands == 0 || !baked.light.radiance) return;
  const ShReport report = report_of(baked, options);
  const Json details = {{"bands", report.projection.radiance.bands()}};
  folder.write({"sh.json", "spherical harmonics, in canonical form and in each engine's", "JSON", details},
               sh_json(report));
  const std::string name = harmonics_name(options);
  const bool is_c = name == kHarmonicsHeader;
  std::string header;
  try {
    header = is_c ? sh_c_header(report) : sh_c_sharp(report);
  } catch (const Error& error) {  // light beyond the range of floats, which JSON holds
    if (error.code() != ErrorCode::limit_exceeded) throw;
    baked.notes.push_back(name + " is omitted: " + error.what());
    return;
  }
  folder.write({name, "the same", is_c ? "C header" : "C#", details}, header);
}

/// Draws and writes the previews.
std::vector<WrittenFile> draw_previews(const Baked& baked, const BakeCommandOptions& options,
                                       const std::filesystem::path& folder, const Control& control) {
  const PreviewOptions how{tone_map_of(baked, options), options.preview_size};
  std::vector<WrittenFile> files;
  for (const WrittenPreview& image : write_previews(baked.light, how, folder, control)) {
    files.push_back({image.name, image.what, "PNG", {{"width", image.width}, {"height", image.height}}});
  }
  if (options.preview_page && baked.light.specular) {
    write_preview_page(baked.light, how.tone_map, folder / kPreviewPage, control);
    files.push_back({kPreviewPage, "spheres and a knot in the light of this bake, to be turned in a browser", "HTML"});
  }
  return files;
}

/// Writes all files but .env, .glb and the previews.
void write_files(Baked& baked, const BakeCommandOptions& options, OutputFolder& folder, const Control& control) {
  BakeResult& light = baked.light;
  const Job job{options, folder, control, light.radiance ? &*light.radiance : nullptr};
  const glm::dmat3 symmetry = face_rotation(options);
  write_computed(baked.image, job);
  if (baked.lat_long.width > 0) {
    write_lat_longs(baked.lat_long, job);
    write_usd_stages(job);
  }
  write_octahedral_maps(light, job);
  write_playcanvas(light, job);
  turn_to_engine(light, symmetry, control);
  if (light.background) {
    write_cubemap({Content::background, "the environment, with plain mips", light.background->views(), {}, "radiance"},
                  job);
  }
  if (light.specular) {
    write_cubemap({Content::specular, "prefiltered for reflections, one roughness per mip",
                   light.specular->cubemap.views(), roughness_of(*light.specular), "radiance"},
                  job);
  }
  for (LobeChain& chain : baked.lobes) {
    if (symmetry != glm::dmat3(1.0)) chain.light.cubemap = rotate(chain.light.cubemap, symmetry, control);
    const std::vector<double> roughness =
        chain.lobe == LobeFamily::charlie ? roughness_of(chain.light) : std::vector<double>();
    write_cubemap({content_of(chain.lobe), what_of(chain.lobe), chain.light.cubemap.views(), roughness, "radiance"},
                  job);
  }
  if (light.irradiance) {
    write_cubemap({Content::irradiance,
                   "irradiance: divide by pi for the radiance of a white surface",
                   {light.irradiance->view()},
                   {},
                   "irradiance"},
                  job);
  }
  if (light.brdf) write_brdf(*light.brdf, options, folder, control);
  write_harmonics(baked, options, folder);
  write_readme(job);
}

}  // namespace

ToneMap tone_map_of(const Baked& baked, const BakeCommandOptions& options) {
  constexpr int kEnough = 32;
  if (options.exposure_stops) return {std::exp2(*options.exposure_stops)};
  const std::optional<Cubemap>& background = baked.light.background;
  if (!background && !baked.light.specular) return {};
  const Cubemap& chain = background ? *background : baked.light.specular->cubemap;
  int level = 0;
  while (level + 1 < chain.levels() && chain.level_size(level + 1) >= kEnough) ++level;
  return {exposure_of(chain.view(level))};
}

std::vector<std::string> brdf_channels(const BrdfTableOptions& options) {
  std::vector<std::string> names = options.model == BrdfModel::split_sum
                                       ? std::vector<std::string>{"scale", "bias"}
                                       : std::vector<std::string>{"albedo at f0 = 0", "albedo at f0 = 1"};
  if (options.sheen) names.emplace_back("sheen albedo");
  return names;
}

void write_bake(Baked& baked, const BakeCommandOptions& options, OutputFolder& folder, const Control& control) {
  constexpr double kPreviews = 0.3;
  constexpr double kEnv = 0.6;
  const auto progress = [&](double done) {
    if (control.progress) control.progress(done);
  };
  std::vector<PassRecord> drawing;
  std::vector<WrittenFile> previews;
  const auto draw = [&] {
    if (!options.previews) return;
    measured(drawing, "previews", "drawn and written", [&] {
      previews = draw_previews(baked, options, folder.path(), {control.stop, {}});
    });
  };
  std::vector<PassRecord> writing;
  const auto write = [&] {
    progress(kPreviews);
    for (const OutputFile& file : options.files) {
      if (file.content != Content::env && file.content != Content::gltf_light) continue;
      if (!baked.env && !baked.env_is_specular) continue;
      const auto write_one = file.content == Content::env ? write_env : write_gltf_light;
      measured(writing, std::string("write .") + name(file.container), file.name,
               [&] { write_one(baked, file.name, folder, part_of(control, kPreviews, kEnv)); });
      baked.env.reset();
    }
    progress(kEnv);
    measured(writing, "write", "all other files", [&] { write_files(baked, options, folder, control); });
  };
  begin_stage("write");
  if (face_rotation(options) == glm::dmat3(1.0)) {
    // These run concurrently: one thread packs an image while others write files.
    const jobs::Placement where = jobs::Placement::arena;
    jobs::run_tiles(2, where, jobs::worker_count(where), {control.stop, {}},
                    [&](std::size_t index, std::size_t) { index == 0 ? draw() : write(); });
  } else {  // previews are drawn before rotation
    draw();
    write();
  }
  folder.add_in_front(std::move(previews));
  for (std::vector<PassRecord>* const passes : {&drawing, &writing}) {
    std::move(passes->begin(), passes->end(), std::back_inserter(baked.passes));
  }
  progress(1.0);
}

}  // namespace welkin::tool
