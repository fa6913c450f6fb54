// A worker that is a global object, with requests still running while the program's static objects are destroyed.
//
// worker_outlives_main PART: posts requests that do PART over and over until they are stopped, and returns from main
// once each has done it. Static objects that main or a request made first are destroyed then, `witness` after them, the
// worker last. The witness waits until PART has been done again and again, by which time whatever the library destroyed
// too early has been used. Another result than the first time, or an error, ends the program with 1.
//
// worker_outlives_main in_passing: posts every part many times and returns from main when some are done.
#include <array>
#include <atomic>
#include <chrono>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <exception>
#include <filesystem>
#include <memory>
#include <string>
#include <thread>
#include <utility>

#include "portability/hashing.h"
#include "welkin/environment_file.h"
#include "welkin/welkin.hpp"

namespace {

using welkin::portability::cubemap;
using welkin::portability::hash_of;
using welkin::portability::lat_long;

constexpr int kThreads = 2;
constexpr int kRounds = 4;  ///< rounds for which the witness waits
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

/// Waits until `counter` has reached `minimum`.
void await(const std::atomic<int>& counter, int minimum, const char* otherwise) {
  const auto until = std::chrono::steady_clock::now() + kPatience;
  while (counter < minimum) {
    if (std::chrono::steady_clock::now() > until) fail(otherwise);
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
}

struct Witness {
  ~Witness() {
    if (witnessed) await(rounds, rounds + kRounds, "the requests do not go on while the program exits");
  }
} witness;

std::uint64_t sky() {
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
  return hash_of(projector.project(welkin::sun_direction(20.0, 30.0)));
}

/// Checks which formats exist and which sample types they hold.
std::uint64_t write() {
  const std::filesystem::path nowhere("a_folder_that_is_not_there");
  welkin::portability::Hash refused;
  for (const char* name : {"a.exr", "a.hdr", "a.pfm", "a.png"}) {
    for (const auto type : {welkin::SampleType::half, welkin::SampleType::float32, welkin::SampleType::uint16}) {
      try {
        welkin::check_write_options(nowhere / name, {welkin::Layout::automatic, type}, false);
      } catch (const welkin::Error& error) {
        refused.add(static_cast<double>(error.code()));
      }
    }
  }
  return refused.value();
}

/// Writes and reads an OpenEXR file, a separate one for each thread.
std::uint64_t openexr() {
  static std::atomic<int> files{0};
  thread_local const int file = files++;
  const std::filesystem::path path = "worker_outlives_main_" + std::to_string(file) + ".exr";
  (void)welkin::write_environment(path, lat_long(16, 1).view());
  const std::uint64_t hash = hash_of(welkin::project_file(path).radiance);
  std::filesystem::remove(path);
  return hash;
}

struct Part {
  const char* name;
  std::uint64_t (*compute)();  ///< the hash of its results
};

constexpr std::array kParts{
    Part{"project_cubemap", [] { return hash_of(welkin::project(cubemap(8, 1).view()).radiance); }},
    Part{"project_lat_long", [] { return hash_of(welkin::project(lat_long(16, 1).view()).radiance); }},
    Part{"resample", [] { return hash_of(welkin::to_cubemap(lat_long(16, 1).view(), 8)); }},
    Part{"prefilter",
         [] {
           const welkin::PrefilterOptions options{.size = 8, .method = welkin::PrefilterMethod::spectral};
           return hash_of(welkin::prefilter_specular(cubemap(8, 1).view(), options).cubemap);
         }},
    Part{"brdf",
         [] {
           return hash_of(welkin::brdf_table({16, 16})->values);
         }},
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

void run_part(const Part& part) {
  const auto repeat = [compute = part.compute](const welkin::Control& control) {
    without_errors([&] {
      const std::uint64_t first = compute();
      if (first == hash_of()) fail("a part has no result");
      ++started;
      while (!control.stop.stop_requested()) {
        if (compute() != first) fail("a result has changed while the program exits");
        ++rounds;
      }
    });
  };
  for (int i = 0; i < kThreads; ++i) (void)worker->post(repeat);
  await(started, kThreads, "the requests have not started");
  witnessed = true;
}

void run_in_passing() {
  for (int i = 0; i < 100; ++i) {
    for (const Part& part : kParts) {
      (void)worker->post([compute = part.compute](const welkin::Control&) {
        without_errors([&] { (void)compute(); });
        ++rounds;
      });
    }
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
