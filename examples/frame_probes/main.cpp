// Reflection probes that follow a moving light. Each frame the engine captures one of them as six faces of half floats
// and posts a bake of it to a worker, which writes the prefiltered chain as half floats into a staging buffer; a later
// frame copies that to the GPU. No frame waits for a bake, and the frame's thread converts no texel.
//
//   frame_probes [frames]     default 90, once without bakes and once with them; prints the frame times of both
#include <welkin/bake.h>
#include <welkin/core.h>
#include <welkin/image.h>
#include <welkin/reflections.h>
#include <welkin/requests.h>
#include <welkin/spherical_harmonics.h>
#include <welkin/worker.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cstddef>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <exception>
#include <memory>
#include <stdexcept>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "scene.h"

namespace {

using Clock = std::chrono::steady_clock;

constexpr int kSize = 64;                             // texels along an edge of a capture and of mip 0
constexpr std::size_t kProbes = 8;                    // captured in turns
constexpr std::size_t kSlots = 4;                     // captures in flight
constexpr std::chrono::microseconds kPeriod{16'667};  // of a frame

/// Where a probe stands in the scene.
welkin::dvec3 position_of(std::size_t probe) { return {-2.8 + 0.8 * static_cast<double>(probe), 0.4, -1.5}; }

/// Reflections of 1 % and nine coefficients; the fast preset is meant for probes of every frame.
welkin::BakeOptions options_of_probes() {
  welkin::BakeOptions options = welkin::BakeOptions::at(welkin::Quality::fast);
  options.background.reset();
  options.irradiance.reset();
  options.brdf.reset();
  options.specular->size = kSize;
  return options;
}

/// The chain of a probe in staging and GPU memory alike, so that an upload is one copy.
welkin::UploadLayout layout_of_probes() {
  return {.format = welkin::TexelFormat::rgba16f,
          .size = kSize,
          .levels = welkin::default_mip_count(*options_of_probes().specular),
          .row_alignment_bytes = 256,
          .level_alignment_bytes = 512};
}

// ---- The engine's memory

/// A capture on its way through the worker: what was rendered, and the mapped staging buffer that its bake writes to.
/// Both belong to the job until it is ready. `capture` and `staging` are allocated once.
struct Slot {
  std::vector<frame_probes::HalfTexel> capture = std::vector<frame_probes::HalfTexel>(std::size_t{6} * kSize * kSize);
  std::vector<std::byte> staging = std::vector<std::byte>(welkin::upload_bytes(layout_of_probes()));
  std::vector<welkin::CubemapTarget> targets = welkin::upload_targets(layout_of_probes(), staging);
  std::array<welkin::dvec3, 9> light{};  ///< coefficients of radiance
  welkin::Job<void> job{};               ///< a bake, and what follows it
  std::size_t probe = 0;
  int frame = 0;      ///< of the capture
  bool busy = false;  ///< posted, and not yet taken back

  [[nodiscard]] welkin::CubemapView view() const {
    welkin::CubemapView view{.faces = {}, .size = kSize, .format = welkin::PixelFormat::rgba16f};
    for (std::size_t face = 0; face < 6; ++face) view.faces[face] = &capture[face * kSize * kSize];
    return view;
  }
};

/// Stands for a probe's texture and constants on the GPU.
struct GpuProbe {
  std::vector<std::byte> memory = std::vector<std::byte>(welkin::upload_bytes(layout_of_probes()));
  std::array<welkin::dvec3, 9> light{};
  int frame = -1;  ///< of the capture that it shows
};

/// Copies the coefficients, which have no targets, out of a result.
void take_light(const welkin::BakeResult& baked, std::array<welkin::dvec3, 9>& light) {
  std::ranges::copy(baked.radiance->coefficients(), light.begin());
}

// ---- The probes, a frame at a time

class Probes {
 public:
  /// Uploads what is ready. Never waits.
  void take_back() {
    for (Slot& slot : slots_) {
      if (!slot.busy || !slot.job.ready()) continue;
      slot.busy = false;
      if (slot.job.try_take()) {
        GpuProbe& probe = gpu_.at(slot.probe);
        if (slot.frame < probe.frame) continue;  // two bakes of a probe may end in either order
        std::memcpy(probe.memory.data(), slot.staging.data(), slot.staging.size());
        probe.light = slot.light;
        probe.frame = slot.frame;
        ++uploads_;
      } else if (const auto error = slot.job.error(); error->code != welkin::ErrorCode::replaced) {
        throw std::runtime_error(error->message);
      }
    }
  }

  /// Captures a probe, and posts its bake if there is a worker. A frame in which all slots are busy captures nothing.
  void capture(std::size_t probe, int frame, welkin::Worker* worker) {
    const auto slot = std::find_if(slots_.begin(), slots_.end(), [](const Slot& some) { return !some.busy; });
    if (slot == slots_.end()) {
      ++skipped_;
      return;
    }
    slot->probe = probe;
    slot->frame = frame;
    frame_probes::capture(frame_probes::Scene(frame), position_of(probe), kSize, slot->capture);
    if (worker == nullptr) return;
    // The job reads the capture and writes the staging buffer in place. A bake of the same probe that has not ended is
    // dropped for this one; its slot stays busy until it is ready, so no two bakes share memory. The follow-up runs on
    // the worker's thread and frees the result there: a frame that frees it may wait for the allocator's lock.
    slot->job =
        worker
            ->post(
                welkin::BakeTo{welkin::EnvironmentSource{slot->view(), nullptr}, {.specular = slot->targets}, options_},
                {.key = "probe " + std::to_string(probe)})
            .then([to = &*slot](const std::shared_ptr<const welkin::BakeResult>& baked) {
              take_light(*baked, to->light);
            });
    slot->busy = true;
  }

  [[nodiscard]] bool idle() const {
    return std::none_of(slots_.begin(), slots_.end(), [](const Slot& slot) { return slot.busy; });
  }

  [[nodiscard]] bool shown(std::size_t probe) const { return gpu_.at(probe).frame >= 0; }

  /// Returns whether a probe's chain and coefficients on the GPU are those of a direct bake of its capture.
  [[nodiscard]] bool right(std::size_t probe) const {
    const GpuProbe& shown = gpu_.at(probe);
    Slot again;
    frame_probes::capture(frame_probes::Scene(shown.frame), position_of(probe), kSize, again.capture);
    take_light(welkin::bake_to({.specular = again.targets}, again.view(), options_), again.light);
    return again.staging == shown.memory && again.light == shown.light;
  }

  [[nodiscard]] int uploads() const { return uploads_; }
  [[nodiscard]] int skipped() const { return skipped_; }

 private:
  welkin::BakeOptions options_ = options_of_probes();
  std::array<Slot, kSlots> slots_;
  std::array<GpuProbe, kProbes> gpu_;
  int uploads_ = 0;
  int skipped_ = 0;
};

// ---- The loop

using Milliseconds = std::chrono::duration<double, std::milli>;

/// Prints percentiles of times in milliseconds.
void print_times(const char* name, std::vector<double> times) {
  std::sort(times.begin(), times.end());
  const auto percentile = [&](std::size_t percent) { return times[(times.size() - 1) * percent / 100]; };
  std::printf("%-28s p50 %7.3f ms   p99 %7.3f ms   longest %7.3f ms\n", name, percentile(50), percentile(99),
              times.back());
}

/// Runs frames at 60 Hz, with bakes if there is a worker, and prints how long they took without the sleep.
void run_frames(Probes& probes, int frames, welkin::Worker* worker) {
  std::vector<double> whole;
  std::vector<double> uploads;
  for (int frame = 0; frame < frames; ++frame) {
    const auto start = Clock::now();
    probes.take_back();
    const auto taken = Clock::now();
    probes.capture(static_cast<std::size_t>(frame) % kProbes, frame, worker);
    const auto end = Clock::now();
    uploads.push_back(Milliseconds(taken - start).count());
    whole.push_back(Milliseconds(end - start).count());
    std::this_thread::sleep_until(start + kPeriod);
  }
  print_times(worker != nullptr ? "frames with bakes" : "frames without bakes", whole);
  if (worker != nullptr) print_times("  polls and uploads in them", uploads);
}

void finish(Probes& probes) {
  while (!probes.idle()) {
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
    probes.take_back();
  }
}

int run(int frames) {
  Probes probes;
  welkin::Worker worker;  // after the probes, because its destructor waits for jobs that use their memory
  run_frames(probes, frames, nullptr);
  run_frames(probes, frames, &worker);
  finish(probes);

  bool right = true;
  for (std::size_t probe = 0; probe < kProbes; ++probe) {
    if (!probes.shown(probe)) {  // all its captures were skipped or replaced on a machine this slow
      probes.capture(probe, frames, &worker);
      finish(probes);
    }
    right = probes.right(probe) && right;
  }
  std::printf("%d frames with bakes: %d uploads, %d captures skipped; they have %s direct call's bits\n", frames,
              probes.uploads(), probes.skipped(), right ? "the" : "NOT the");
  return right ? 0 : 1;
}

}  // namespace

int main(int count, char** arguments) {
  try {
    const int frames = count > 1 ? std::atoi(arguments[1]) : 90;
    if (frames < 2 * static_cast<int>(kProbes)) {
      throw std::invalid_argument("the number of frames must be at least 16: two captures per probe");
    }
    return run(frames);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "frame_probes: %s\n", error.what());
    return 1;
  }
}
