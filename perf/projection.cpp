// Projection to harmonics, the bandwidth that bounds it, and small calls on coefficients, which engines make thousands
// of.
#include "welkin/projection.h"

#include "files/row_source.h"
#include "jobs/tiles.h"
#include "perf.h"
#include "welkin/core.h"
#include "welkin/environment_file.h"
#include "welkin/spherical_harmonics.h"

namespace welkin::perf {
namespace {

constexpr int kSizes[] = {32, 64, 128, 256, 512, 1024, 2048};

double texels_of(int size) { return 6.0 * size * size; }

void add(const std::string& variant, PixelFormat format, int size, std::span<const int> threads,
         const ProjectionOptions& options) {
  const double bytes = texels_of(size) * static_cast<double>(bytes_per_texel(format));
  add_benchmark("ProjectCubemap", variant, std::to_string(size), threads, texels_of(size), bytes, [=] {
    const CubemapView view = noise_cubemap(format, size);
    return [=] { benchmark::DoNotOptimize(project(view, options)); };
  });
}

/// The sums of nine functions for each channel, as DirectXMath's SHProjectCubeMap adds them up: every texel's
/// direction, functions at its centre in float, and its solid angle by the midpoint rule. Rebuilt from its method, as
/// no package has it; only its time is compared.
void sum_as_directxmath(const CubemapView& view, std::array<float, 27>& sums) {
  static constexpr float kFrames[6][3][3] = {{{0, 0, -1}, {0, -1, 0}, {1, 0, 0}}, {{0, 0, 1}, {0, -1, 0}, {-1, 0, 0}},
                                             {{1, 0, 0}, {0, 0, 1}, {0, 1, 0}},   {{1, 0, 0}, {0, 0, -1}, {0, -1, 0}},
                                             {{1, 0, 0}, {0, -1, 0}, {0, 0, 1}},  {{-1, 0, 0}, {0, -1, 0}, {0, 0, -1}}};
  sums.fill(0.0F);
  float total = 0.0F;
  for (std::size_t face = 0; face < 6; ++face) {
    const auto* rgb = static_cast<const float*>(view.faces[face]);
    for (int row = 0; row < view.size; ++row) {
      for (int column = 0; column < view.size; ++column, rgb += 3) {
        const float u = (2.0F * static_cast<float>(column) + 1.0F) / static_cast<float>(view.size) - 1.0F;
        const float v = (2.0F * static_cast<float>(row) + 1.0F) / static_cast<float>(view.size) - 1.0F;
        const float squared = 1.0F + u * u + v * v;
        const float length = std::sqrt(squared);
        const float weight = 4.0F / (squared * length);
        float d[3];
        for (int k = 0; k < 3; ++k) {
          d[k] = (u * kFrames[face][0][k] + v * kFrames[face][1][k] + kFrames[face][2][k]) / length;
        }
        const float basis[9] = {0.282095F,
                                -0.488603F * d[1],
                                0.488603F * d[2],
                                -0.488603F * d[0],
                                1.092548F * d[0] * d[1],
                                -1.092548F * d[1] * d[2],
                                0.315392F * (3.0F * d[2] * d[2] - 1.0F),
                                -1.092548F * d[0] * d[2],
                                0.546274F * (d[0] * d[0] - d[1] * d[1])};
        total += weight;
        for (std::size_t c = 0; c < 3; ++c) {
          for (std::size_t f = 0; f < 9; ++f) sums[9 * c + f] += rgb[c] * basis[f] * weight;
        }
      }
    }
  }
  for (float& sum : sums) sum *= 4.0F * std::numbers::pi_v<float> / total;
}

void add_directxmath(int size) {
  add_benchmark("ProjectCubemap", "directxmath-method", std::to_string(size), kOneThread, texels_of(size),
                12.0 * texels_of(size), [=] {
                  const CubemapView view = noise_cubemap(PixelFormat::rgb32f, size);
                  return [view, sums = std::array<float, 27>{}]() mutable {
                    sum_as_directxmath(view, sums);
                    benchmark::DoNotOptimize(sums);
                  };
                });
}

/// Adds `count` probes of 64 with half floats, 64 different ones repeated: in one call on one or more threads, and in a
/// call for each on one thread.
void add_many(int count) {
  constexpr std::size_t kDifferent = 64;
  const double texels = texels_of(64) * count;
  const std::string size = "64x" + std::to_string(count);
  const auto probes = [count] { return noise_probes(static_cast<std::size_t>(count), kDifferent); };
  add_benchmark("ProjectMany", "rgba16f", size, kThreadCounts, texels, 8.0 * texels, [=] {
    return [views = probes(), light = std::vector<dvec3>(9 * static_cast<std::size_t>(count))]() mutable {
      benchmark::DoNotOptimize(project_many(views, light));
    };
  });
  add_benchmark("ProjectMany", "rgba16f-single-calls", size, kOneThread, texels, 8.0 * texels, [=] {
    return [views = probes()] {
      for (const CubemapView& view : views) benchmark::DoNotOptimize(project(view));
    };
  });
}

}  // namespace

void add_project_cubemap() {
  for (const PixelFormat format : {PixelFormat::rgb32f, PixelFormat::rgba32f, PixelFormat::rgba16f}) {
    for (const int size : kSizes) add(name(format), format, size, kThreadCounts, {});
  }
  for (const PixelFormat format : {PixelFormat::rgb16f, PixelFormat::rgb8, PixelFormat::srgba8}) {
    for (const int size : {64, 256, 1024}) add(name(format), format, size, kOneThread, {});
  }
  for (const int bands : {4, 6, 10}) {
    ProjectionOptions options;
    options.bands = bands;
    for (const int size : {64, 1024})
      add("rgb32f-bands" + std::to_string(bands), PixelFormat::rgb32f, size, kOneThread, options);
  }
  for (const int size : {64, 256}) add_directxmath(size);
  add_many(10'000);
}

void add_project_lat_long() {
  constexpr int width = 4096;
  constexpr int height = 2048;
  constexpr double texels = 1.0 * width * height;
  for (const PixelFormat format : {PixelFormat::rgb32f, PixelFormat::rgba32f, PixelFormat::rgba16f}) {
    add_benchmark("ProjectLatLong", name(format), "4096x2048", kThreadCounts, texels,
                  texels * static_cast<double>(bytes_per_texel(format)), [=] {
                    const LatLongView view = noise_lat_long(format, width, height);
                    return [=] { benchmark::DoNotOptimize(project(view)); };
                  });
  }
}

namespace {

constexpr int kWidth = 2048;
constexpr int kHeight = 1024;

struct Variant {
  const char* name;
  const char* extension;
  WriteOptions options;
};

constexpr std::array<Variant, 5> kVariants{{{"hdr", ".hdr", {}},
                                            {"exr-half-zip", ".exr", {Layout::automatic, SampleType::half}},
                                            {"exr-float-zip", ".exr", {Layout::automatic, SampleType::float32}},
                                            {"pfm", ".pfm", {}},
                                            {"png8", ".png", {}}}};

std::filesystem::path file_of(const Variant& variant) {
  return scratch_file(std::string(variant.name) + variant.extension, [&](const std::filesystem::path& path) {
    (void)write_environment(path, noise_lat_long(PixelFormat::rgb32f, kWidth, kHeight), variant.options);
  });
}

/// Runs the decoder alone: rows to floats in one thread, each block of them discarded.
void decode(const std::filesystem::path& path, std::vector<float>& rgb) {
  const std::unique_ptr<files::RowSource> source = files::open_image(path, ReadOptions{});
  const int rows = source->traits().natural_rows * std::max(1, 16 / source->traits().natural_rows);
  rgb.resize(std::size_t{3} * kWidth * static_cast<std::size_t>(rows));
  const std::unique_ptr<files::RowReader> reader = source->open_reader();
  for (int row = 0; row < kHeight; row += rows) {
    reader->read(row, std::min(rows, kHeight - row), rgb.data());
    benchmark::DoNotOptimize(rgb.data());
  }
}

}  // namespace

void add_project_file() {
  constexpr double texels = 1.0 * kWidth * kHeight;
  const std::string size = std::to_string(kWidth) + "x" + std::to_string(kHeight);
  for (const Variant& variant : kVariants) {
    add_benchmark("ProjectFile", variant.name, size, kThreadCounts, texels, 12.0 * texels, [&variant] {
      const std::filesystem::path path = file_of(variant);
      return [path] { benchmark::DoNotOptimize(project_file(path)); };
    });
    add_benchmark("DecodeFile", variant.name, size, kOneThread, texels, 12.0 * texels, [&variant] {
      const std::filesystem::path path = file_of(variant);
      return [path, rgb = std::vector<float>()]() mutable { decode(path, rgb); };
    });
  }
}

namespace {

constexpr std::int64_t kTileBytes = std::int64_t{512} << 10U;  // about a projection tile
constexpr std::int64_t kGroupBytes = 64;
constexpr std::int64_t kGroupWords = 8;

/// Adds words as fast as memory supplies them: the reference for bandwidth.
std::uint64_t read_groups(const std::uint64_t* words, std::int64_t groups) {
  std::array<std::uint64_t, kGroupWords> sums{};
  for (std::int64_t group = 0; group < groups; ++group, words += kGroupWords) {
    for (std::size_t k = 0; k < sums.size(); ++k) sums[k] += words[k];
  }
  return std::accumulate(sums.begin(), sums.end(), std::uint64_t{0});
}

/// Reads `bytes` bytes in tiles, inline or as tasks just like the projection does.
std::function<void()> reader(const void* pixels, std::int64_t bytes, std::int64_t texels) {
  const jobs::Placement placement = jobs::placement_for(texels);
  const std::int64_t groups = bytes / kGroupBytes;
  const std::int64_t tile_groups = kTileBytes / kGroupBytes;
  const auto tiles = static_cast<std::size_t>((groups + tile_groups - 1) / tile_groups);
  return [=] {
    std::vector<std::uint64_t> sums(tiles);
    jobs::run_tiles(tiles, placement, jobs::worker_count(placement), {}, [&](std::size_t tile, std::size_t) {
      const std::int64_t first = static_cast<std::int64_t>(tile) * tile_groups;
      sums[tile] = read_groups(static_cast<const std::uint64_t*>(pixels) + first * kGroupWords,
                               std::min(tile_groups, groups - first));
    });
    benchmark::DoNotOptimize(sums.data());
  };
}

/// `pixels()`: returns the first of them when the benchmark runs.
void add_read(PixelFormat format, const std::string& size, std::int64_t texels,
              const std::function<const void*()>& pixels) {
  const std::int64_t bytes = texels * static_cast<std::int64_t>(bytes_per_texel(format));
  add_benchmark("ReadBandwidth", name(format), size, kThreadCounts, static_cast<double>(texels),
                static_cast<double>(bytes), [=] { return reader(pixels(), bytes, texels); });
}

}  // namespace

void add_read_bandwidth() {
  for (const PixelFormat format : {PixelFormat::rgb32f, PixelFormat::rgba32f, PixelFormat::rgba16f}) {
    for (const int size : kSizes) {
      add_read(format, std::to_string(size), std::int64_t{6} * size * size,
               [=] { return noise_cubemap(format, size).faces[0]; });
    }
  }
  add_read(PixelFormat::rgb32f, "4096x2048", std::int64_t{4096} * 2048,
           [] { return noise_lat_long(PixelFormat::rgb32f, 4096, 2048).pixels; });
}

namespace {

SphericalHarmonics light_of(int bands, double rotation) {
  SphericalHarmonics light(bands);
  double angle = rotation;
  for (dvec3& value : light.coefficients()) {
    angle += 1.7;
    value = {std::cos(angle), std::cos(2.0 * angle), std::cos(3.0 * angle)};
  }
  return light;
}

std::vector<dvec3> directions(int count) {
  std::vector<dvec3> result;
  for (int k = 0; k < count; ++k) result.push_back(sun_direction(180.0 * (k + 0.5) / count - 90.0, 137.50776 * k));
  return result;
}

/// The repeats per iteration of calls below a microsecond, so that only they are timed: the figure's milliseconds are
/// then their microseconds.
constexpr int kThousand = 1000;

/// A channel's nine coefficients rotated in float, by the matrix of each band with band 2's in closed form: what
/// DirectXMath's XMSHRotate does for three bands. Rebuilt from its method, as no package has it; only its time is
/// compared.
void rotate_as_directxmath(const std::array<std::array<float, 3>, 3>& r, const float* in, float* out) {
  const auto& [rx, ry, rz] = r;
  out[0] = in[0];
  out[1] = ry[1] * in[1] + ry[2] * in[2] + ry[0] * in[3];
  out[2] = rz[1] * in[1] + rz[2] * in[2] + rz[0] * in[3];
  out[3] = rx[1] * in[1] + rx[2] * in[2] + rx[0] * in[3];
  constexpr float root3 = 1.7320508F;
  constexpr float half = 0.5F;
  const auto squares = [](const auto& a) { return a[0] * a[0] - a[1] * a[1]; };
  const float matrix[5][5] = {
      {rx[0] * ry[1] + rx[1] * ry[0], rx[1] * ry[2] + rx[2] * ry[1], root3 * rx[2] * ry[2],
       rx[0] * ry[2] + rx[2] * ry[0], rx[0] * ry[0] - rx[1] * ry[1]},
      {ry[0] * rz[1] + ry[1] * rz[0], ry[1] * rz[2] + ry[2] * rz[1], root3 * ry[2] * rz[2],
       ry[0] * rz[2] + ry[2] * rz[0], ry[0] * rz[0] - ry[1] * rz[1]},
      {(2.0F * rz[0] * rz[1] - rx[0] * rx[1] - ry[0] * ry[1]) / root3,
       (2.0F * rz[1] * rz[2] - rx[1] * rx[2] - ry[1] * ry[2]) / root3,
       rz[2] * rz[2] - half * (rx[2] * rx[2] + ry[2] * ry[2]),
       (2.0F * rz[0] * rz[2] - rx[0] * rx[2] - ry[0] * ry[2]) / root3,
       (2.0F * squares(rz) - squares(rx) - squares(ry)) * half / root3},
      {rx[0] * rz[1] + rx[1] * rz[0], rx[1] * rz[2] + rx[2] * rz[1], root3 * rx[2] * rz[2],
       rx[0] * rz[2] + rx[2] * rz[0], rx[0] * rz[0] - rx[1] * rz[1]},
      {rx[0] * rx[1] - ry[0] * ry[1], rx[1] * rx[2] - ry[1] * ry[2], half * root3 * (rx[2] * rx[2] - ry[2] * ry[2]),
       rx[0] * rx[2] - ry[0] * ry[2], half * (squares(rx) - squares(ry))}};
  for (int i = 0; i < 5; ++i) {
    out[4 + i] = 0.0F;
    for (int k = 0; k < 5; ++k) out[4 + i] += matrix[i][k] * in[4 + k];
  }
}

void add(const std::string& variant, int bands, std::function<void()> body) {
  add_benchmark("Harmonics", variant, std::to_string(bands), kOneThread, kThousand, 0.0,
                [body = std::move(body)] { return body; });
}

}  // namespace

void add_harmonics() {
  for (const int bands : {3, 4, 6, 10}) {
    const SphericalHarmonics a = light_of(bands, 0.1);
    const SphericalHarmonics b = light_of(bands, 0.2);
    const Quaternion rotation{0.9, 0.1, -0.3, 0.2};
    add("product-1000", bands, [=] {
      for (int k = 0; k < kThousand; ++k) benchmark::DoNotOptimize(product(a, b, a.bands()));
    });
    add("rotate-1000", bands, [=] {
      for (int k = 0; k < kThousand; ++k) benchmark::DoNotOptimize(rotate(a, rotation));
    });
    add("evaluate-1000", bands, [=, towards = directions(kThousand), values = std::vector<dvec3>(kThousand)]() mutable {
      evaluate(a, towards, values);
      benchmark::DoNotOptimize(values.data());
    });
    add("evaluate-one-by-one-1000", bands, [=, towards = directions(kThousand)] {
      for (const dvec3& direction : towards) benchmark::DoNotOptimize(evaluate(a, direction));
    });
  }
  add("directxmath-method-rotate-1000", 3, [in = std::array<float, 27>{0.7F, 0.1F, 0.3F}]() mutable {
    std::array<float, 27> out{};
    std::array<std::array<float, 3>, 3> rotation{{{0.36F, 0.48F, -0.8F}, {-0.8F, 0.6F, 0.0F}, {0.48F, 0.64F, 0.6F}}};
    for (int k = 0; k < kThousand; ++k) {
      benchmark::DoNotOptimize(rotation);
      for (std::size_t c = 0; c < 27; c += 9) rotate_as_directxmath(rotation, &in[c], &out[c]);
      in[0] = out[0];
      benchmark::DoNotOptimize(out);
    }
  });
  add_benchmark("Harmonics", "sky-curve-1000", "3", kOneThread, kThousand, 0.0, [] {
    const auto curve = std::make_shared<const SkyCurve>(SkyView(earth_tables(), 0.0), SkyCurveOptions{});
    return [curve] {
      for (int k = 0; k < kThousand; ++k) benchmark::DoNotOptimize(curve->at(sun_direction(0.09 * k, 30.0)));
    };
  });
}

}  // namespace welkin::perf
