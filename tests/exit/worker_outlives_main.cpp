// A worker that is a global object, with requests still running while the program's static objects are destroyed.
//
// worker_outlives_main PART: posts requests that do PART over and over until they are stopped, and returns from main
// once each has done it. Static objects that main or a request made first are destroyed then, `witness` after them, the
// worker last. The witness waits until PART has been done again and again, by which time whatever the library destroyed
// too early has been used. Another result than the first time, or an error, ends the program with 1.
//
// worker_outlives_main in_passing: posts every part many times and returns from main when some are done; nobody waits.
#include <array>
#include <atomic>
#include <chrono>
#include <cstddef>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <exception>
#include <filesystem>
#include <memory>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "welkin/environment_file.h"
#include "welkin/welkin.hpp"

namespace {

using Values = std::vector<double>;

constexpr int kThreads = 2;
constexpr int kRounds = 4;  ///< that the witness waits for
constexpr std::chrono::seconds kPatience{60};

/// Static objects in the order in which they are made; they are destroyed in the reverse one.
std::unique_ptr<welkin::Worker> worker;
std::atomic<int> rounds{0};
std::atomic<int> started{0};
std::atomic<bool> witnessed{false};  ///< whether the witness is to wait

[[noreturn]] void fail(const char* what) {
  std::fprintf(stderr, "worker_outlives_main: %s\n", what);
  std::fflush(stderr);
  std::_Exit(1);
}

/// Waits until `counter` has reached `least`.
void await(const std::atomic<int>& counter, int least, const char* otherwise) {
  const auto until = std::chrono::steady_clock::now() + kPatience;
  while (counter < least) {
    if (std::chrono::steady_clock::now() > until) fail(otherwise);
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
}

struct Witness {
  ~Witness() {
    if (witnessed) await(rounds, rounds + kRounds, "the requests do not go on while the program exits");
  }
} witness;

/// Pixels of some pattern, 0 to 1.
std::vector<float> pattern(std::size_t count) {
  std::vector<float> values(count);
  for (std::size_t i = 0; i < count; ++i) values[i] = static_cast<float>((i * 2654435761U) % 1009U) / 1009.0F;
  return values;
}

welkin::LatLongImage lat_long() { return {32, 16, pattern(std::size_t{32} * 16 * 3)}; }
welkin::Cubemap cubemap() { return {8, pattern(std::size_t{6} * 8 * 8 * 3)}; }

Values values_of(const welkin::SphericalHarmonics& harmonics) {
  Values values;
  for (const glm::dvec3& c : harmonics.coefficients()) values.insert(values.end(), {c.x, c.y, c.z});
  return values;
}

Values project_cubemap() { return values_of(welkin::project(cubemap().view()).radiance); }

Values project_lat_long() { return values_of(welkin::project(lat_long().view()).radiance); }

Values resample() {
  const welkin::Cubemap faces = welkin::to_cubemap(lat_long().view(), 8);
  return {faces.pixels().begin(), faces.pixels().end()};
}

Values prefilter() {
  welkin::PrefilterOptions options{.size = 8, .method = welkin::PrefilterMethod::spectral};
  const welkin::PrefilteredSpecular result = welkin::prefilter_specular(cubemap().view(), options);
  Values values;
  for (const welkin::MipRecord& mip : result.mips) values.insert(values.end(), {mip.mean.x, mip.mean.y, mip.mean.z});
  return values;
}

Values brdf() {
  const std::shared_ptr<const welkin::BrdfTable> table = welkin::brdf_table({16, 16});
  return {table->values.begin(), table->values.end()};
}

Values sky() {
  welkin::SkyTableOptions options{.heights = 4,
                                  .view_zeniths = 16,
                                  .sun_zeniths = 8,
                                  .sun_angles = 4,
                                  .transmittance_heights = 16,
                                  .transmittance_zeniths = 64,
                                  .irradiance_heights = 4,
                                  .irradiance_sun_zeniths = 16,
                                  .orders = 2};
  const auto tables = std::make_shared<const welkin::SkyTables>(welkin::precompute_sky(welkin::earth(), options));
  const welkin::SkyProjector projector(welkin::SkyView(tables, 0.0));
  return values_of(projector.project(welkin::sun_direction(20.0, 30.0)));
}

/// Which formats there are, and what they hold.
Values write() {
  const std::filesystem::path nowhere("a_folder_that_is_not_there");
  Values refused;
  for (const char* name : {"a.exr", "a.hdr", "a.pfm", "a.png"}) {
    for (const auto type : {welkin::SampleType::half, welkin::SampleType::float32, welkin::SampleType::uint16}) {
      try {
        welkin::check_write_options(nowhere / name, {welkin::Layout::automatic, type}, false);
      } catch (const welkin::Error& error) {
        refused.push_back(static_cast<double>(error.code()));
      }
    }
  }
  return refused;
}

/// An OpenEXR file, written and read, that each thread has for itself.
Values openexr() {
  static std::atomic<int> files{0};
  thread_local const int file = files++;
  const std::filesystem::path path = "worker_outlives_main_" + std::to_string(file) + ".exr";
  (void)welkin::write_environment(path, lat_long().view());
  Values values = values_of(welkin::project_file(path).radiance);
  std::filesystem::remove(path);
  return values;
}

struct Part {
  const char* name;
  Values (*compute)();
};

constexpr std::array kParts{Part{"project_cubemap", project_cubemap},
                            Part{"project_lat_long", project_lat_long},
                            Part{"resample", resample},
                            Part{"prefilter", prefilter},
                            Part{"brdf", brdf},
                            Part{"sky", sky},
                            Part{"write", write},
                            Part{"openexr", openexr}};

/// Ends the program if a part throws, as it must not.
template <class Function>
void without_errors(const Function& function) {
  try {
    function();
  } catch (const std::exception& error) {
    fail(error.what());
  }
}

/// Does a part over and over.
struct Repeat {
  Values (*compute)();

  void operator()(const welkin::Control& control) const {
    without_errors([&] {
      const Values first = compute();
      if (first.empty()) fail("a part has no result");
      ++started;
      while (!control.stop.stop_requested()) {
        if (compute() != first) fail("a result has changed while the program exits");
        ++rounds;
      }
    });
  }
};

struct Once {
  Values (*compute)();

  void operator()(const welkin::Control&) const {
    without_errors([&] { (void)compute(); });
    ++rounds;
  }
};

void run_part(const Part& part) {
  for (int i = 0; i < kThreads; ++i) (void)worker->post(Repeat{part.compute});
  await(started, kThreads, "the requests have not started");
  witnessed = true;
}

void run_in_passing() {
  for (int i = 0; i < 100; ++i) {
    for (const Part& part : kParts) (void)worker->post(Once{part.compute});
  }
  await(rounds, 2 * static_cast<int>(kParts.size()), "the requests have not started");
}

}  // namespace

int main(int count, char** arguments) {
  if (count != 2) fail("usage: worker_outlives_main PART|in_passing");
  welkin::WorkerOptions options;
  // Threads of the default rank run only where nothing else wants a processor: on a busy machine, hardly at all.
  options.thread_priority = welkin::ThreadPriority::normal;
  options.threads = kThreads;
  worker = std::make_unique<welkin::Worker>(std::move(options));
  if (std::strcmp(arguments[1], "in_passing") == 0) {
    run_in_passing();
    return 0;
  }
  for (const Part& part : kParts) {
    if (std::strcmp(arguments[1], part.name) != 0) continue;
    run_part(part);
    return 0;
  }
  fail("there is no such part");
}
