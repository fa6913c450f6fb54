#include "welkin/probes.h"

#include "perf.h"
#include "welkin/bake_file.h"

namespace welkin::perf {
namespace {

constexpr int kSize = 64;
constexpr std::size_t kFaceTexels = std::size_t{kSize} * kSize;

/// The number of different captures that 10 000 probes use in turn: 100 MB of half floats, more than a cache holds, and
/// less than the 1.9 GB that all would take.
constexpr std::size_t kDifferent = 512;

const ProbeGrid kGrid{.counts = {25, 16, 25}};

/// Returns distances from a probe in a box of 4 x 3 x 4 with one door open to the sky.
float distance(std::size_t probe, double x, double y, double z) {
  const double away =
      1.0 / std::max({std::abs(x) / 2.0, std::abs(y) / (1.0 + 0.001 * static_cast<double>(probe)), std::abs(z) / 2.0});
  if (z > 0.8) return INFINITY;
  return static_cast<float>(probe % 11 == 3 ? -away : away);
}

struct Captures {
  std::vector<float> distances;
  std::vector<CubemapView> cubes = noise_probes(kGrid.size(), kDifferent);
  std::vector<DepthView> depths;

  Captures() {
    distances.resize(kDifferent * 6 * kFaceTexels);
    for (std::size_t k = 0; k < kDifferent; ++k) {
      for (std::size_t texel = 0; texel < 6 * kFaceTexels; ++texel) {
        const double u = (static_cast<double>(texel % kSize) + 0.5) / 32.0 - 1.0;
        const double v = (static_cast<double>(texel / kSize % kSize) + 0.5) / 32.0 - 1.0;
        const std::size_t face = texel / kFaceTexels;
        const double side = face % 2 == 0 ? 1.0 : -1.0;
        distances[k * 6 * kFaceTexels + texel] = face < 2   ? distance(k, side, u, v)
                                                 : face < 4 ? distance(k, u, side, v)
                                                            : distance(k, u, v, side);
      }
    }
    for (std::size_t probe = 0; probe < kGrid.size(); ++probe) {
      const std::size_t k = probe % kDifferent;
      DepthView depth{{}, kSize, 0};
      for (std::size_t face = 0; face < 6; ++face) {
        depth.faces[face] = distances.data() + (6 * k + face) * kFaceTexels;
      }
      depths.push_back(depth);
    }
  }
};

const Captures& captures() {
  static const Captures made;
  return made;
}

std::vector<FileInput> files() {
  std::vector<FileInput> inputs;
  std::vector<std::filesystem::path> paths;
  for (std::size_t k = 0; k < kDifferent; ++k) {
    paths.push_back(scratch_file("probe" + std::to_string(k) + ".ktx2", [k](const std::filesystem::path& path) {
      write_texture(path, {&captures().cubes[k], 1});
    }));
  }
  for (std::size_t probe = 0; probe < kGrid.size(); ++probe) inputs.emplace_back(paths[probe % kDifferent]);
  return inputs;
}

void add(const char* variant, double bytes_per_probe, const std::function<std::function<void()>()>& make) {
  const auto count = static_cast<double>(kGrid.size());
  add_benchmark("Probes", variant, "64x10000", kThreadCounts, 6.0 * kFaceTexels * count, bytes_per_probe * count, make);
}

}  // namespace

void add_probes() {
  constexpr double colours = 8.0 * 6.0 * kFaceTexels;
  constexpr double depths = 4.0 * 6.0 * kFaceTexels;
  add("rgba16f", colours, [] {
    static_cast<void>(captures());
    return [] { benchmark::DoNotOptimize(bake_probes(kGrid, captures().cubes)); };
  });
  add("rgba16f-depths", colours + depths, [] {
    static_cast<void>(captures());
    return [] { benchmark::DoNotOptimize(bake_probes(kGrid, captures().cubes, captures().depths)); };
  });
  add("rgba16f-depths-sky", colours + 2 * depths, [] {
    static_cast<void>(captures());
    return [] {
      benchmark::DoNotOptimize(bake_probes(kGrid, captures().cubes, captures().depths, {.environment_bands = 4}));
    };
  });
  add("files", colours, [] {
    return [inputs = files()] {
      const BakedProbes probes = bake_probe_files(kGrid, inputs);
      const std::array layouts{ProbeLayout::three, ProbeLayout::unity_l2};
      const std::filesystem::path folder = inputs[0].path().parent_path();
      benchmark::DoNotOptimize(write_probes(folder / "probes.json", probes, layouts));
    };
  });
  add("relight", 0.0, [] {
    const auto probes = std::make_shared<BakedProbes>(
        bake_probes(kGrid, captures().cubes, captures().depths, {.environment_bands = 4}));
    SphericalHarmonics sun(4);
    for (std::size_t k = 0; k < 16; ++k) sun.coefficients()[k] = dvec3(1.0 / (1.0 + static_cast<double>(k)));
    return [probes, sun] { relight(*probes, SphericalHarmonics(4), sun); };
  });
  for (const auto& [variant, layout] :
       {std::pair{"pack-three", ProbeLayout::three}, {"pack-unity-l2", ProbeLayout::unity_l2}}) {
    add(variant, 0.0, [layout = layout] {
      const auto probes = std::make_shared<BakedProbes>(bake_probes(kGrid, captures().cubes));
      return [probes, layout] { benchmark::DoNotOptimize(pack_probes(*probes, layout)); };
    });
  }
}

}  // namespace welkin::perf
