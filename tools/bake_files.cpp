#include "tools/bake_files.h"

#include <string>

#include "tools/brdf_files.h"
#include "tools/number_text.h"
#include "tools/progress_bar.h"
#include "tools/turn_chain.h"
#include "welkin/resampling.h"
#include "welkin/version.h"

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
    case TexelFormat::e5b9g9r9: break;
  }
  return "e5b9g9r9";
}

std::string range_of(TexelFormat format) {
  switch (format) {
    case TexelFormat::rgba16f: return "beyond +-65504 clamped: halves end there";
    case TexelFormat::rgba32f: return "that are not finite replaced";
    case TexelFormat::b10g11r11: return "below 0 or above 65024 (blue: 64512) clamped: b10g11r11 ends there";
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

/// .dds and .exr hold halves or floats.
TextureOptions texture_options(Container container, const Cubemap& cubemap, const Job& job) {
  TextureOptions options = job.options.texture;
  if (container != Container::ktx2) {
    options.supercompression = Supercompression::none;
    if (options.format != TexelFormat::rgba32f) options.format = TexelFormat::rgba16f;
  }
  options.metadata = {{"welkin.content", cubemap.name},
                      {"welkin.unit", cubemap.unit},
                      {"welkin.axes", convention(job.options.turn.to).name},
                      {"welkin.version", WELKIN_VERSION_STRING}};
  if (!cubemap.roughness.empty()) options.metadata["welkin.roughness"] = numbers_text(cubemap.roughness);
  return options;
}

void write_texture_file(Container container, const Cubemap& cubemap, const Job& job) {
  const TextureOptions options = texture_options(container, cubemap, job);
  const std::string file = cubemap.name + '.' + name(container);
  const WriteReport report = write_texture(job.folder.place(file), cubemap.mips, options, {job.control.stop, {}});
  std::string format = container == Container::ktx2 ? "KTX2 " : container == Container::dds ? "DDS " : "OpenEXR ";
  format += name(options.format);
  if (options.supercompression == Supercompression::zlib) format += " zlib";
  if (options.supercompression == Supercompression::zstd) format += " zstd";
  job.folder.add(
      {file, cubemap.what, format, 0, report.values_clamped, range_of(options.format), details_of(cubemap, job)});
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
    if (!job.options.containers.contains(container) || background.levels() == 0) continue;
    if (picture.width == 0) {
      picture = to_lat_long(background.view(0), 4 * background.size(), 2 * background.size(), glm::dmat3(1.0),
                            {job.control.stop, {}});
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
  if (light.background.levels() > 0) light.background = turned(light.background, symmetry, control);
  if (light.specular) light.specular->cubemap = turned(light.specular->cubemap, symmetry, control);
  if (light.irradiance.size > 0) light.irradiance = turned(light.irradiance, symmetry, control);
}

std::vector<double> roughness_of(const PrefilteredSpecular& specular) {
  std::vector<double> table;
  for (const MipRecord& mip : specular.mips) table.push_back(mip.roughness);
  return table;
}

}  // namespace

void write_bake(Baked& baked, const BakeCommandOptions& options, OutputFolder& folder, const Control& control) {
  constexpr double kPreviews = 0.3;
  constexpr double kEnv = 0.6;
  const auto progress = [&](double done) {
    if (control.progress) control.progress(done);
  };
  if (options.previews) {
    timed(baked.passes, "previews", "drawn and written", [&] { write_previews(baked, folder); });
  }
  progress(kPreviews);
  if (options.containers.contains(Container::env) && (baked.env || baked.env_is_specular)) {
    timed(baked.passes, "write .env", "environment.env",
          [&] { write_env(baked, folder, part_of(control, kPreviews, kEnv)); });
    baked.env.reset();
  }
  progress(kEnv);
  timed(baked.passes, "write", "all other files", [&] {
    BakeResult& light = baked.light;
    const Job job{options, folder, control};
    write_computed(baked.picture, job);
    write_lat_longs(light.background, job);  // before it is turned
    turn_to_engine(light, options.turn.to, control);
    write_cubemap({"background", "the environment itself, with plain mips", light.background.views(), {}, "radiance"},
                  job);
    if (light.specular) {
      write_cubemap({"specular", "prefiltered for reflections, a roughness a mip", light.specular->cubemap.views(),
                     roughness_of(*light.specular), "radiance"},
                    job);
    }
    if (light.irradiance.size > 0) {
      write_cubemap({"irradiance",
                     "irradiance: divide by pi for what a white surface shows",
                     {light.irradiance.view()},
                     {},
                     "irradiance"},
                    job);
    }
    if (light.brdf) write_brdf(*light.brdf, options, folder, control);
    write_harmonics(baked, options, folder);
  });
  progress(1.0);
}

}  // namespace welkin::tool
