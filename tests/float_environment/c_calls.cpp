// The C interface.
#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "calls.h"
#include "images.h"
#include "support/temporary_directory.h"
#include "welkin/environment_file.h"
#include "welkin/welkin.h"

namespace welkin::test {
namespace {

/// Result of a C function: its status, and the numbers that it wrote.
struct Given {
  welkin_status status = WELKIN_INTERNAL;
  std::vector<double> numbers;
};

void add_bits(BitHash& hash, const Given& given) { test::add_bits(hash, given.status, given.numbers); }

Given given(welkin_status status, const welkin_projection& projection) {
  Given result{status, {projection.error_estimate}};
  result.numbers.insert(result.numbers.end(), std::begin(projection.coefficients), std::end(projection.coefficients));
  return result;
}

Given given(welkin_status status, const welkin_engine_light& light) {
  Given result{status, {}};
  for (const auto& term : light.terms) result.numbers.insert(result.numbers.end(), std::begin(term), std::end(term));
  for (const auto& vector : light.vectors) {
    result.numbers.insert(result.numbers.end(), std::begin(vector), std::end(vector));
  }
  return result;
}

/// Posts, waits and takes the result.
template <class Post>
Given done_by_worker(const Post& post) {
  welkin_job* job = nullptr;
  const welkin_status posted = post(&job);
  if (posted != WELKIN_OK) return {posted, {}};
  welkin_job_wait(job, WELKIN_NO_LIMIT);
  welkin_projection projection;
  WELKIN_INIT(projection);
  const welkin_status status = welkin_job_projection(job, &projection);
  welkin_job_release(job);
  return given(status, projection);
}

}  // namespace

void call_c(Calls& calls) {
  const LatLongImage wide = small_lat_long();
  const Cubemap cube = small_cubemap();
  const TemporaryDirectory folder;
  const std::string path = folder.file("wide.hdr").string();
  write_environment(path, wide.view());

  welkin_environment faces;
  WELKIN_INIT(faces);
  for (std::size_t face = 0; face < 6; ++face) faces.faces[face] = cube.view().faces[face];
  faces.size = cube.size();
  welkin_environment lat_long;
  WELKIN_INIT(lat_long);
  lat_long.faces[0] = wide.pixels.data();
  lat_long.width = wide.width;
  lat_long.height = wide.height;
  welkin_projection_options options;
  WELKIN_INIT(options);
  options.target_size = 5;
  welkin_pixel_policy policy;
  WELKIN_INIT(policy);
  policy.clamp_maximum = 123.4F;
  options.pixels = &policy;

  const auto projected = [&](const auto& project) {
    welkin_projection projection;
    WELKIN_INIT(projection);
    return given(project(&projection), projection);
  };
  const std::array views{&faces, &lat_long};
  for (const welkin_environment* view : views) {
    calls.call("welkin_project",
               [&] { return projected([&](auto* out) { return welkin_project(view, 1, &options, nullptr, out); }); });
  }
  calls.call("welkin_project_many", [&] {
    Given result{WELKIN_INTERNAL, std::vector<double>(27)};
    result.status = welkin_project_many(&faces, 1, &options, nullptr, result.numbers.data(), nullptr);
    return result;
  });
  calls.call("welkin_bake_many", [&] {
    Given result{WELKIN_INTERNAL, std::vector<double>(27)};
    std::vector<float> texels(std::size_t{6} * 4 * 4 * 4);
    welkin_prefilter_options reflections;
    WELKIN_INIT(reflections);
    reflections.size = 4;
    reflections.mips = 1;
    const double rough = 0.6;
    reflections.roughness = &rough;
    reflections.roughness_count = 1;
    welkin_target target;
    WELKIN_INIT(target);
    target.format = WELKIN_FORMAT_RGBA_F32;
    target.size = 4;
    for (std::size_t face = 0; face < 6; ++face) target.faces[face] = texels.data() + 64 * face;
    result.status =
        welkin_bake_many(&faces, 1, &reflections, nullptr, &target, 1, 3, result.numbers.data(), nullptr, nullptr);
    result.numbers.insert(result.numbers.end(), texels.begin(), texels.end());
    return result;
  });
  calls.call("welkin_project_file", [&] {
    return projected([&](auto* out) { return welkin_project_file(path.c_str(), nullptr, &options, nullptr, out); });
  });

  welkin_worker_options worker_options;
  WELKIN_INIT(worker_options);
  worker_options.threads = 1;
  worker_options.thread_priority = WELKIN_THREAD_PRIORITY_NORMAL;
  welkin_worker* worker = nullptr;
  calls.call("welkin_worker_create", [&] {
    welkin_worker_destroy(worker);
    return welkin_worker_create(&worker_options, &worker);
  });
  for (const welkin_environment* view : views) {
    calls.call("welkin_post_project", [&] {
      return done_by_worker([&](auto** job) { return welkin_post_project(worker, view, 1, &options, nullptr, job); });
    });
  }
  calls.call("welkin_post_project_file", [&] {
    return done_by_worker(
        [&](auto** job) { return welkin_post_project_file(worker, path.c_str(), nullptr, &options, nullptr, job); });
  });
  welkin_worker_destroy(worker);

  welkin_projection projection;
  WELKIN_INIT(projection);
  welkin_project(&faces, 1, nullptr, nullptr, &projection);
  const double* const radiance = projection.coefficients;
  std::vector<double> irradiance(27);
  calls.call("welkin_irradiance_from_radiance", [&] {
    const welkin_status status = welkin_irradiance_from_radiance(3, radiance, irradiance.data());
    return Given{status, irradiance};
  });
  const double direction[3] = {0.36, -0.48, 0.8};
  calls.call("welkin_evaluate", [&] {
    std::vector<double> value(3);
    const welkin_status status = welkin_evaluate(3, radiance, direction, value.data());
    return Given{status, value};
  });
  for (const welkin_engine engine : {WELKIN_ENGINE_BABYLON, WELKIN_ENGINE_THREE, WELKIN_ENGINE_UNITY}) {
    welkin_engine_light light;
    WELKIN_INIT(light);
    for (const int unrotated : {0, 1}) {
      calls.call("welkin_engine_light_from_radiance", [&] {
        return given(welkin_engine_light_from_radiance(3, radiance, engine, unrotated, &light), light);
      });
    }
  }
}

}  // namespace welkin::test
