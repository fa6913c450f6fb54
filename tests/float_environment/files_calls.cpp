// Files of every kind, written and read.
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "calls.h"
#include "images.h"
#include "support/chains.h"
#include "welkin/bake_file.h"
#include "welkin/environment_file.h"
#include "welkin/result_cache.h"

namespace welkin::test {
namespace {

void call_images_in_files(Calls& calls, const TemporaryDirectory& folder) {
  const LatLongImage wide = small_lat_long();
  const LatLongImage dark = faint(wide);
  const Cubemap cube = small_cubemap();
  for (const char* const name : {"wide.pfm", "wide.hdr", "wide.exr", "wide.png", "dark.pfm"}) {
    const std::filesystem::path path = folder.file(name);
    const LatLongView view = name == std::string("dark.pfm") ? dark.view() : wide.view();
    calls.write("write_environment(FileOutput const&, EnvironmentView", path, [&] { write_environment(path, view); });
    calls.call("inspect_environment(", [&] { return inspect_environment(path).notes; });
    calls.call("read_environment(", [&] { return read_environment(path); });
    calls.call("measure_environment(", [&] { return measure_environment(path); });
    calls.call("project_file(", [&] { return project_file(path, {}, {.target_size = 4}); });
  }
  const std::filesystem::path cross = folder.file("cube.exr");
  calls.write("write_environment(FileOutput const&, EnvironmentView", cross,
              [&] { write_environment(cross, cube.view(), {.layout = Layout::horizontal_cross}); });
  calls.call("project_file(", [&] { return project_file(cross); });
  const std::filesystem::path hdr = folder.file("wide.hdr");
  calls.call("check_write_options(", [&] {
    check_write_options(hdr, {}, false);
    return 0;
  });
  calls.call("bake_file(", [&] { return bake_file(hdr, {}, small_bake()); });
  calls.refused("project_file(", [&] { static_cast<void>(project_file(hdr, {}, {.bands = 0})); });

  std::filesystem::create_directory(folder.file("faces"));
  for (const char* const name : {"px", "nx", "py", "ny", "pz", "nz"}) {
    const LatLongImage square{4, 4, std::vector<float>(48, 0.1F)};
    write_environment(folder.file(std::string("faces/") + name + ".pfm"), square.view());
  }
  const std::filesystem::path faces = folder.file("faces");
  calls.call("project_file(", [&] { return project_file(faces); });
  calls.call("hash_file(", [&] { return hash_file(hdr); });

  const ReadFile reading{hdr, {}};
  calls.call("ReadFile::operator()(", [&] { return reading({}); });
  const MeasureFile measuring{hdr, {}};
  calls.call("MeasureFile::operator()(", [&] { return measuring({}); });
  const ProjectFile projecting{hdr, {}, {}};
  calls.call("ProjectFile::operator()(", [&] { return projecting({}); });
  const BakeFile baking{hdr, {}, small_bake()};
  calls.call("BakeFile::operator()(", [&] { return baking({}); });
}

void call_textures(Calls& calls, const TemporaryDirectory& folder) {
  const Cubemap chain = noisy_chain(8, 4, 4);
  const std::vector<CubemapView> views = chain.views();
  struct File {
    const char* name;
    TextureOptions options;
  };
  for (const File& file : {File{"half.ktx2", {.supercompression = Supercompression::zstd}},
                           File{"packed.ktx2", {.format = TexelFormat::b10g11r11}},
                           File{"shared.ktx2", {.format = TexelFormat::e5b9g9r9}}, File{"half.dds", {}}}) {
    const std::filesystem::path path = folder.file(file.name);
    calls.write("write_texture(", path, [&] { write_texture(path, views, file.options); });
    calls.call("read_texture(", [&] { return read_texture(path).cubemap; });
  }
  const std::filesystem::path table = folder.file("table.ktx2");
  const std::vector<float> rgb(36, 0.1F);
  const std::filesystem::path octahedral = folder.file("octahedral.ktx2");
  calls.write("write_octahedral(", octahedral,
              [&] { write_octahedral(octahedral, to_octahedral(chain, {.size = 8})); });
  calls.write("write_texture_2d(", table, [&] { write_texture_2d(table, 4, 3, rgb.data()); });

  const std::filesystem::path captured = folder.file("captured.ktx2");
  write_texture(captured, views);
  const std::vector<FileInput> captures(2, FileInput(captured));
  const ProbeGrid grid{.counts = {2, 1, 1}};
  const BakedProbes probes = calls.call("bake_probe_files(", [&] { return bake_probe_files(grid, captures); });
  const std::filesystem::path description = folder.file("probes.json");
  const std::filesystem::path texture = folder.file("probes_three.ktx2");
  const std::vector<ProbeLayout> layouts{ProbeLayout::three};
  calls.write("write_probes(", texture, [&] { write_probes(description, probes, layouts); });
  calls.call("read_probes(", [&] { return read_probes(description); });

  const SphericalHarmonics radiance = project(chain.view(0)).radiance;
  calls.call("to_babylon(", [&] { return to_babylon(chain, radiance).polynomial; });
  const BabylonEnvironment environment = to_babylon(chain, radiance, {8, std::vector<float>(6 * 64 * 3, 0.3F)});
  const std::filesystem::path env = folder.file("light.env");
  calls.write("write_babylon_environment(", env, [&] { write_babylon_environment(env, environment); });
  calls.call("rgbd_images(", [&] { return rgbd_images(chain).png; });
  calls.call("read_babylon_environment(", [&] { return read_babylon_environment(env).specular; });
  calls.call("mirrored_x(Cubemap", [&] { return mirrored_x(chain); });
  const Cubemap cube = small_cubemap();
  calls.call("mirrored_x(Cubemap", [&] { return mirrored_x(cube); });

  const std::filesystem::path prefiltered = folder.file("prefiltered.ktx2");
  write_texture(prefiltered, views, {.metadata = {{"welkin.roughness", "0 0.21 0.53 0.87"}}});
  for (const std::filesystem::path& path : {prefiltered, env}) {
    calls.call("inspect_stored_environment(", [&] { return inspect_stored_environment(path).roughness; });
    const StoredEnvironment stored = inspect_stored_environment(path);
    calls.call("StoredEnvironment::description(", [&] { return stored.description(); });
    calls.call("plan(StoredEnvironment", [&] { return plan(stored, {}, small_bake()).passes; });
    const Plan planned = plan(stored, {}, small_bake());
    calls.call("bake(StoredEnvironment", [&] { return bake(stored, planned); });
  }
}

}  // namespace

void call_files(Calls& calls) {
  const TemporaryDirectory folder;
  call_images_in_files(calls, folder);
  call_textures(calls, folder);
}

}  // namespace welkin::test
