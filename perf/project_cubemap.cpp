#include "project_cubemap.h"

#include <string>
#include <utility>

#include "reference/reference_projection.h"
#include "subjects.h"
#include "welkin/core.h"
#include "welkin/projection.h"

namespace welkin::perf {
namespace {

double texels_of(int size) { return 6.0 * size * size; }

void add(const std::string& variant, PixelFormat format, int size, int threads, const ProjectionOptions& options) {
  const double bytes = texels_of(size) * static_cast<double>(bytes_per_texel(format));
  add_benchmark("ProjectCubemap", variant, std::to_string(size), threads, texels_of(size), bytes,
                [=]() -> std::function<void()> {
                  const CubemapView view = noise_cubemap(format, size);
                  return [=] { benchmark::DoNotOptimize(project(view, options)); };
                });
}

void add_instruction_set(InstructionSet set, int size) {
  const double bytes = texels_of(size) * 12.0;
  add_benchmark("ProjectCubemap", std::string("rgb32f-") + name(set), std::to_string(size), 1, texels_of(size), bytes,
                [=]() -> std::function<void()> {
                  const CubemapView view = noise_cubemap(PixelFormat::rgb32f, size);
                  return [=] {
                    const InstructionSet before = active_instruction_set();
                    force_instruction_set(set);
                    benchmark::DoNotOptimize(project(view));
                    force_instruction_set(before);
                  };
                });
}

}  // namespace

void add_project_cubemap(const std::vector<int>& sizes, const std::vector<int>& thread_counts) {
  for (const PixelFormat format : {PixelFormat::rgb32f, PixelFormat::rgba32f, PixelFormat::rgba16f}) {
    for (const int size : sizes) {
      for (const int threads : thread_counts) add(name(format), format, size, threads, {});
    }
  }
  for (const PixelFormat format : {PixelFormat::rgb16f, PixelFormat::rgb8, PixelFormat::srgba8}) {
    for (const int size : {64, 1024}) add(name(format), format, size, 1, {});
  }
  for (const int bands : {1, 2, 4, 6, 10}) {
    ProjectionOptions options;
    options.bands = bands;
    for (const int size : {64, 1024})
      add("rgb32f-bands" + std::to_string(bands), PixelFormat::rgb32f, size, 1, options);
  }
  ProjectionOptions clamped;
  clamped.pixels.clamp = RadianceClamp{};
  ProjectionOptions midpoint;
  midpoint.quadrature = Quadrature::midpoint;
  ProjectionOptions gamma;
  gamma.pixels.gamma = true;
  const std::pair<const char*, ProjectionOptions> variants[] = {
      {"rgb32f-clamp", clamped}, {"rgb32f-midpoint", midpoint}, {"rgb32f-gamma", gamma}};
  for (const auto& [variant, options] : variants) add(variant, PixelFormat::rgb32f, 1024, 1, options);
  for (const Quadrature quadrature : {Quadrature::exact, Quadrature::midpoint}) {
    ProjectionOptions options;
    options.quadrature = quadrature;
    options.target_size = 64;
    const std::string variant = quadrature == Quadrature::exact ? "rgb32f-target64" : "rgb32f-target64-midpoint";
    add(variant, PixelFormat::rgb32f, 1024, 1, options);
  }
  for (const InstructionSet set : available_instruction_sets()) {
    for (const int size : {64, 1024}) add_instruction_set(set, size);
  }
  add_benchmark("ReferenceTwin", "rgb32f", "64", 1, texels_of(64), texels_of(64) * 12.0, []() -> std::function<void()> {
    const CubemapView view = noise_cubemap(PixelFormat::rgb32f, 64);
    return [=] { benchmark::DoNotOptimize(reference_projection(view)); };
  });
}

}  // namespace welkin::perf
