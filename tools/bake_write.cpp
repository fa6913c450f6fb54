#include "tools/bake_write.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <iterator>
#include <optional>
#include <utility>

#include "jobs/tiles.h"
#include "platform/text.h"
#include "tools/sh_report.h"
#include "tools/terminal.h"
#include "tools/text.h"
#include "welkin/core.h"
#include "welkin/octahedral.h"
#include "welkin/resampling.h"
#include "welkin/spherical_harmonics.h"
#include "welkin/texture_file.h"

namespace welkin::tool {
namespace {

/// One cubemap of the result, and what is said of it.
struct Cubemap {
  std::string name;  ///< of the files, without extension
  std::string what;
  std::vector<CubemapView> mips;
  std::vector<double> roughness;  ///< of each mip; empty if it is not blurred
  std::string unit;
};

/// What all the writers below need to know.
struct Job {
  const BakeCommandOptions& options;
  OutputFolder& folder;
  const Control& control;
};

std::string numbers_text(const std::vector<double>& values) {
  std::string text;
  for (const double value : values) text += (text.empty() ? "" : " ") + all_digits(value);
  return text;
}

Json details_of(const Cubemap& cubemap, const Job& job) {
  Json details = {{"size", cubemap.mips.front().size}, {"mips", cubemap.mips.size()}};
  if (!cubemap.roughness.empty()) details["roughness"] = cubemap.roughness;
  details["unit"] = cubemap.unit;
  details["axes"] = convention(job.options.turn.to).name;
  return details;
}

const char* name(TexelFormat format) {
  switch (format) {
    case TexelFormat::rgba16f: return "rgba16f";
    case TexelFormat::rgba32f: return "rgba32f";
    case TexelFormat::b10g11r11: return "b10g11r11";
    case TexelFormat::bc6h_ufloat: return "bc6h";
    case TexelFormat::bc6h_sfloat: return "bc6h-signed";
    case TexelFormat::astc_4x4_hdr: return "astc4x4";
    case TexelFormat::astc_6x6_hdr: return "astc6x6";
    case TexelFormat::e5b9g9r9: break;
  }
  return "e5b9g9r9";
}

std::string range_of(TexelFormat format) {
  switch (format) {
    case TexelFormat::rgba16f: return "beyond +-65504 clamped: halves end there";
    case TexelFormat::rgba32f: return "that are not finite replaced";
    case TexelFormat::b10g11r11: return "below 0 or above 65024 (blue: 64512) clamped: b10g11r11 ends there";
    case TexelFormat::bc6h_ufloat: return "below 0 or above 65504 clamped: unsigned BC6H ends there";
    case TexelFormat::bc6h_sfloat: return "beyond +-65504 clamped: BC6H ends there";
    case TexelFormat::astc_4x4_hdr:
    case TexelFormat::astc_6x6_hdr: return "below 0 or above 65504 clamped: ASTC ends there";
    case TexelFormat::e5b9g9r9: break;
  }
  return "below 0 or above 65408 clamped: e5b9g9r9 ends there";
}

/// What a float cannot hold does not come out of a bake: PFM clamps nothing.
std::string range_of(Container container) {
  switch (container) {
    case Container::exr: return range_of(TexelFormat::rgba16f);
    case Container::hdr: return "below 0 or above 1.69e38 clamped: RGBE ends there";
    default: return "";
  }
}

bool in_bc6h(TexelFormat format) { return format == TexelFormat::bc6h_ufloat || format == TexelFormat::bc6h_sfloat; }

bool in_blocks(TexelFormat format) {
  return in_bc6h(format) || format == TexelFormat::astc_4x4_hdr || format == TexelFormat::astc_6x6_hdr;
}

/// .dds and .exr hold halves or floats, .dds also blocks of BC6H. Irradiance is not compressed: where it nears 0 the
/// errors of blocks are large beside it.
TextureOptions texture_options(Container container, const Cubemap& cubemap, const Job& job) {
  TextureOptions options = job.options.texture;
  if (container != Container::ktx2) {
    options.supercompression = Supercompression::none;
    const bool holds_blocks = container == Container::dds && in_bc6h(options.format);
    if (options.format != TexelFormat::rgba32f && !holds_blocks) options.format = TexelFormat::rgba16f;
  }
  if (cubemap.name == "irradiance" && in_blocks(options.format)) options.format = TexelFormat::rgba16f;
  options.metadata = {{"welkin.content", cubemap.name},
                      {"welkin.unit", cubemap.unit},
                      {"welkin.axes", convention(job.options.turn.to).name},
                      {"welkin.version", WELKIN_VERSION_STRING}};
  if (!cubemap.roughness.empty()) options.metadata["welkin.roughness"] = numbers_text(cubemap.roughness);
  return options;
}

/// A block of a small level holds much of the sphere, and little in it is alike. (Levels of a cubemap that is not
/// blurred are for the distance, and nobody chooses how many there are.)
std::string caution_of(TexelFormat format, const Cubemap& cubemap) {
  constexpr int kEnough = 32;
  const int last = cubemap.mips.back().size;
  if (!in_blocks(format) || cubemap.roughness.empty() || last >= kEnough) return "";
  return "its last mip has " + counted(static_cast<std::uint64_t>(last), "texel") + " along an edge; below 32 " +
         (in_bc6h(format) ? "BC6H" : "ASTC") +
         " is off by 3 to 10 %. End the chain sooner (--mips) or make it larger (--size)";
}

void write_texture_file(Container container, const Cubemap& cubemap, const Job& job) {
  const TextureOptions options = texture_options(container, cubemap, job);
  const std::string file = cubemap.name + '.' + name(container);
  const WriteReport report = write_texture(job.folder.place(file), cubemap.mips, options, {job.control.stop, {}});
  std::string format = container == Container::ktx2 ? "KTX2 " : container == Container::dds ? "DDS " : "OpenEXR ";
  format += name(options.format);
  if (options.supercompression == Supercompression::zlib) format += " zlib";
  if (options.supercompression == Supercompression::zstd) format += " zstd";
  job.folder.add({file, cubemap.what, format, 0, report.values_clamped, range_of(options.format),
                  details_of(cubemap, job), caution_of(options.format, cubemap)});
}

/// .hdr and .pfm know no mips: a vertical strip for each.
void write_strips(Container container, const Cubemap& cubemap, const Job& job) {
  for (std::size_t mip = 0; mip < cubemap.mips.size(); ++mip) {
    const std::string number = cubemap.mips.size() > 1 ? "_m" + std::to_string(mip) : "";
    const std::string file = cubemap.name + number + '.' + name(container);
    WriteOptions options;
    options.layout = Layout::vertical_strip;
    const WriteReport report =
        write_environment(job.folder.place(file), cubemap.mips[mip], options, {job.control.stop, {}});
    Json details = {{"layout", welkin::name(options.layout)}, {"size", cubemap.mips[mip].size}, {"mip", mip}};
    if (!cubemap.roughness.empty()) details["roughness"] = cubemap.roughness[mip];
    details["unit"] = cubemap.unit;
    details["axes"] = convention(job.options.turn.to).name;
    job.folder.add({file, cubemap.what, container == Container::hdr ? "Radiance RGBE" : "PFM", 0, report.values_clamped,
                    range_of(container), details});
  }
}

void write_cubemap(const Cubemap& cubemap, const Job& job) {
  if (cubemap.mips.empty()) return;
  for (const Container container : job.options.containers) {
    if (container == Container::env) continue;
    const bool strips = container == Container::hdr || container == Container::pfm;
    if (strips) {
      write_strips(container, cubemap, job);
    } else {
      write_texture_file(container, cubemap, job);
    }
  }
}

/// The background once more as a lat-long, which is the same picture for all engines, where the container has them.
void write_lat_longs(const CubemapChain& background, const Job& job) {
  LatLongImage picture;
  for (const Container container : {Container::exr, Container::hdr, Container::pfm}) {
    if (!job.options.containers.contains(container)) continue;
    if (picture.width == 0) {
      picture = to_lat_long(background.view(0), 4 * background.size(), 2 * background.size(), glm::dmat3(1.0),
                            ResampleFilter::bilinear, {job.control.stop, {}});
    }
    const std::string file = std::string("environment.") + name(container);
    const WriteReport report = write_environment(job.folder.place(file), picture.view(), {}, {job.control.stop, {}});
    const char* const format = container == Container::exr   ? "OpenEXR half"
                               : container == Container::hdr ? "Radiance RGBE"
                                                             : "PFM";
    job.folder.add({file,
                    "the background as a lat-long",
                    format,
                    0,
                    report.values_clamped,
                    range_of(container),
                    {{"width", picture.width}, {"height", picture.height}, {"unit", "radiance"}}});
  }
}

/// What was computed, to the last bit: baked again it gives the same files.
void write_computed(const LatLongImage& picture, const Job& job) {
  if (picture.width == 0) return;
  WriteOptions options;
  options.type = SampleType::float32;
  const std::string& file = job.options.picture_name;
  write_environment(job.folder.place(file), picture.view(), options, {job.control.stop, {}});
  job.folder.add({file,
                  "what was baked, a lat-long",
                  "OpenEXR float",
                  0,
                  0,
                  "",
                  {{"width", picture.width}, {"height", picture.height}, {"unit", "radiance"}}});
}

void turn_to_engine(BakeResult& light, Engine engine, const Control& control) {
  const glm::dmat3 symmetry = faces_of(engine);
  if (symmetry == glm::dmat3(1.0)) return;
  if (light.background) light.background = turned(*light.background, symmetry, control);
  if (light.specular) light.specular->cubemap = turned(light.specular->cubemap, symmetry, control);
  if (light.irradiance) light.irradiance = turned(*light.irradiance, symmetry, control);
}

std::vector<double> roughness_of(const PrefilteredSpecular& specular) {
  std::vector<double> table;
  for (const MipRecord& mip : specular.mips) table.push_back(mip.roughness);
  return table;
}

/// The specular chain as an octahedral map, in Welkin's axes, which are Godot's.
void write_octahedral_maps(const PrefilteredSpecular& specular, const Job& job) {
  const BakeCommandOptions& options = job.options;
  if (options.octahedral_size == 0) return;
  const OctahedralMap map = to_octahedral(
      specular.cubemap, octahedral_of(options.octahedral_size, specular.cubemap.levels()), {job.control.stop, {}});
  for (const Container container : {Container::ktx2, Container::exr}) {
    if (!options.containers.contains(container)) continue;
    TextureOptions texture = options.texture;
    if (in_blocks(texture.format) || (container == Container::exr && texture.format != TexelFormat::rgba32f))
      texture.format = TexelFormat::rgba16f;
    if (container == Container::exr) texture.supercompression = Supercompression::none;
    std::vector<double> roughness = roughness_of(specular);
    roughness.resize(map.levels.size());
    texture.metadata = {{"welkin.content", "specular"}, {"welkin.roughness", numbers_text(roughness)}};
    const std::string file = std::string("specular_octahedral.") + name(container);
    const WriteReport report = write_octahedral(job.folder.place(file), map, texture, {job.control.stop, {}});
    const Json details = {{"size", map.size},       {"border", map.border}, {"mips", map.levels.size()},
                          {"roughness", roughness}, {"unit", "radiance"},   {"axes", "welkin"}};
    const std::string format = std::string(container == Container::ktx2 ? "KTX2 " : "OpenEXR ") + name(texture.format);
    for (const std::filesystem::path& path : report.files) {
      job.folder.add({platform::utf8(path.filename()), "the specular cubemap as an octahedral map", format, 0,
                      report.values_clamped, range_of(texture.format), details});
    }
  }
}

/// Three channels, the third one 0 where the table has two.
LatLongImage picture_of(const BrdfTable& table) {
  LatLongImage picture{table.options.width, table.options.height, {}};
  const auto channels = static_cast<std::size_t>(table.channels);
  for (std::size_t at = 0; at < table.values.size(); at += channels) {
    for (std::size_t channel = 0; channel < 3; ++channel) {
      picture.pixels.push_back(channel < channels ? table.values[at + channel] : 0.0F);
    }
  }
  return picture;
}

/// Writes the table in each container that was asked for and that can hold a plain picture.
void write_brdf(const BrdfTable& table, const BakeCommandOptions& options, OutputFolder& folder,
                const Control& control) {
  const LatLongImage picture = picture_of(table);
  constexpr const char* kWhat = "BRDF table: columns along N.V, rows along roughness, the smoothest on top";
  const Json details = {
      {"width", picture.width}, {"height", picture.height}, {"channels", brdf_channels(table.options)}};
  TextureOptions texture;
  texture.format = options.texture.format == TexelFormat::rgba32f ? TexelFormat::rgba32f : TexelFormat::rgba16f;
  const bool floats = texture.format == TexelFormat::rgba32f;
  for (const Container container : {Container::ktx2, Container::dds}) {
    if (!options.containers.contains(container)) continue;
    const std::string file = std::string("brdf.") + name(container);
    texture.supercompression = container == Container::ktx2 ? options.texture.supercompression : Supercompression::none;
    texture.metadata.clear();
    if (container == Container::ktx2) texture.metadata = {{"welkin.content", "brdf"}};
    write_texture_2d(folder.place(file), picture.width, picture.height, picture.pixels.data(), texture,
                     {control.stop, {}});
    const std::string format = container == Container::ktx2 ? "KTX2 " : "DDS ";
    folder.add({file, kWhat, format + (floats ? "rgba32f" : "rgba16f"), 0, 0, "", details});
  }
  constexpr const char* kName = "brdf.pfm";
  if (brdf_names(options) != std::vector<std::string>{kName}) return;
  WriteOptions write;
  write.layout = Layout::lat_long;  // a plain picture, to a PFM
  write_environment(folder.place(kName), picture.view(), write, {control.stop, {}});
  folder.add({kName, kWhat, "PFM", 0, 0, "", details});
}

Json roughness_json(const std::vector<MipRecord>& mips) {
  Json list = Json::array();
  for (const MipRecord& mip : mips) list.push_back(mip.roughness);
  return list;
}

/// environment.env, in Babylon.js's axes.
void write_env(const Baked& baked, OutputFolder& folder, const Control& control) {
  const PrefilteredSpecular& specular = baked.env_is_specular ? *baked.light.specular : *baked.env;
  // The polynomial from the source's own harmonics, or those that it stored: mip 0 ends at 255.
  const SphericalHarmonics& radiance = baked.stored_light ? baked.stored_light->radiance : *baked.light.radiance;
  BabylonEnvironment environment = to_babylon(specular.cubemap, radiance);
  constexpr const char* kName = "environment.env";
  const WriteReport report = write_babylon_environment(folder.place(kName), environment, control);
  const Json details = {
      {"size", environment.specular.size()},
      {"mips", environment.specular.levels()},
      {"roughness", roughness_json(specular.mips)},
      {"axes", "babylon"},
      {"lod_generation_scale", environment.lod_generation_scale},
      {"polynomial", baked.stored_light ? "the one that the input stores" : "of the source's harmonics"}};
  folder.add({kName, "all that Babylon.js wants: specular cubemap, and diffuse light as a polynomial",
              "Babylon.js .env, RGBD in PNG", 0, report.values_clamped, "above 255 or below 0 clamped: RGBD ends there",
              details});
}

ShReport report_of(const Baked& baked, const BakeCommandOptions& options) {
  const SphericalHarmonics& light = *baked.light.radiance;
  TurnOptions to_engine;
  to_engine.to = options.turn.to;
  const glm::dmat3 matrix = turn_of_light(to_engine, false);

  ShReport report;
  report.source = baked.source;
  report.source.path = portable_path(baked.source.path);
  report.options.pixels = baked.options.pixels;
  report.options.bands = light.bands();
  report.projection = {turned(light, matrix), baked.light.diagnostics};
  report.projection.diagnostics.passes.clear();  // the manifest has the times; these files have no use for them
  report.axes = axes_text(options.turn);
  report.engine = options.turn.to;
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

/// sh.json and sh.h.
void write_harmonics(const Baked& baked, const BakeCommandOptions& options, OutputFolder& folder) {
  if (options.bake.bands == 0 || !baked.light.radiance) return;
  const ShReport report = report_of(baked, options);
  const Json details = {{"bands", report.projection.radiance.bands()}};
  write_text_file(folder.place("sh.json"), sh_json(report));
  folder.add({"sh.json", "spherical harmonics: canonical, and as each engine wants them", "JSON", 0, 0, "", details});
  write_text_file(folder.place("sh.h"), sh_c_header(report));
  folder.add({"sh.h", "the same", "C header", 0, 0, "", details});
}

/// Draws and writes the previews.
std::vector<WrittenFile> draw_previews(const Baked& baked, const BakeCommandOptions& options,
                                       const std::filesystem::path& folder, const Control& control) {
  const PreviewOptions how{tone_map_of(baked, options), options.preview_size};
  std::vector<WrittenFile> files;
  for (const WrittenPreview& picture : write_previews(baked.light, how, folder, control)) {
    files.push_back(
        {picture.name, picture.what, "PNG", 0, 0, "", {{"width", picture.width}, {"height", picture.height}}});
  }
  return files;
}

/// All files but .env and the previews.
void write_files(Baked& baked, const BakeCommandOptions& options, OutputFolder& folder, const Control& control) {
  BakeResult& light = baked.light;
  const Job job{options, folder, control};
  write_computed(baked.picture, job);
  if (light.background) write_lat_longs(*light.background, job);  // before it is turned
  if (light.specular) write_octahedral_maps(*light.specular, job);
  turn_to_engine(light, options.turn.to, control);
  if (light.background) {
    write_cubemap({"background", "the environment itself, with plain mips", light.background->views(), {}, "radiance"},
                  job);
  }
  if (light.specular) {
    write_cubemap({"specular", "prefiltered for reflections, a roughness a mip", light.specular->cubemap.views(),
                   roughness_of(*light.specular), "radiance"},
                  job);
  }
  for (LobeChain& chain : baked.lobes) {
    const glm::dmat3 symmetry = faces_of(options.turn.to);
    if (symmetry != glm::dmat3(1.0)) chain.light.cubemap = turned(chain.light.cubemap, symmetry, control);
    const std::vector<double> roughness =
        chain.lobe == Lobe::charlie ? roughness_of(chain.light) : std::vector<double>();
    write_cubemap({name(chain.lobe), what_of(chain.lobe), chain.light.cubemap.views(), roughness, "radiance"}, job);
  }
  if (light.irradiance) {
    write_cubemap({"irradiance",
                   "irradiance: divide by pi for what a white surface shows",
                   {light.irradiance->view()},
                   {},
                   "irradiance"},
                  job);
  }
  if (light.brdf) write_brdf(*light.brdf, options, folder, control);
  write_harmonics(baked, options, folder);
}

}  // namespace

ToneMap tone_map_of(const Baked& baked, const BakeCommandOptions& options) {
  constexpr int kEnough = 32;
  if (options.exposure_stops) return {std::exp2(*options.exposure_stops)};
  const std::optional<CubemapChain>& background = baked.light.background;
  if (!background && !baked.light.specular) return {};
  const CubemapChain& chain = background ? *background : baked.light.specular->cubemap;
  int level = 0;
  while (level + 1 < chain.levels() && chain.level_size(level + 1) >= kEnough) ++level;
  return tone_map_of(chain.view(level));
}

std::vector<std::string> brdf_channels(const BrdfTableOptions& options) {
  std::vector<std::string> names = options.model == BrdfModel::split_sum
                                       ? std::vector<std::string>{"scale", "bias"}
                                       : std::vector<std::string>{"albedo at f0 = 0", "albedo at f0 = 1"};
  if (options.sheen) names.emplace_back("sheen albedo");
  return names;
}

std::vector<std::string> brdf_names(const BakeCommandOptions& options) {
  std::vector<std::string> names;
  for (const Container container : {Container::ktx2, Container::dds}) {
    if (options.containers.contains(container)) names.push_back(std::string("brdf.") + name(container));
  }
  const bool babylon_alone = options.containers == std::set<Container>{Container::env};  // it has a table of its own
  if (names.empty() && !babylon_alone) names.emplace_back("brdf.pfm");
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
    if (options.containers.contains(Container::env) && (baked.env || baked.env_is_specular)) {
      measured(writing, "write .env", "environment.env",
               [&] { write_env(baked, folder, part_of(control, kPreviews, kEnv)); });
      baked.env.reset();
    }
    progress(kEnv);
    measured(writing, "write", "all other files", [&] { write_files(baked, options, folder, control); });
  };
  begin_stage("write");
  if (faces_of(options.turn.to) == glm::dmat3(1.0)) {
    // Side by side: a picture is packed by one thread, a file written by another.
    const jobs::Placement where = jobs::Placement::arena;
    jobs::run_tiles(2, where, jobs::worker_count(where), {control.stop, {}},
                    [&](std::size_t index, std::size_t) { index == 0 ? draw() : write(); });
  } else {  // what is drawn is not turned yet
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
