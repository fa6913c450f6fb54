// Three ways to turn environments into light next to the frames: none, inside the frame, on a worker.
#pragma once

#include <tbb/task_arena.h>
#include <welkin/worker.h>

#include <memory>
#include <optional>
#include <stdexcept>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "frame_work.h"
#include "schedule.h"

namespace engine_loop {

/// The outcome of a posting.
struct Baked {
  std::optional<welkin::SphericalHarmonics> radiance;  ///< none if a newer one took its place
  std::uint64_t texels = 0;
  double latency_ms = 0.0;  ///< from being asked for to being in the engine's hands
};

/// No baking, with which the others are compared; and what all have in common.
class Baker {
 public:
  Baker() = default;
  virtual ~Baker() = default;
  Baker(const Baker&) = delete;
  Baker& operator=(const Baker&) = delete;

  /// In every frame, after the engine's own work; throws what went wrong.
  virtual void collect() {}
  /// Then, for each posting of the frame; throws what goes wrong.
  virtual void ask(Posting posting) { keep(std::move(posting)); }
  /// After the last frame: returns when all is done.
  virtual void finish() {}

  /// By the postings' numbers.
  [[nodiscard]] const std::vector<Baked>& baked() const noexcept { return baked_; }

 protected:
  /// To give 75 MB back to the system takes milliseconds; that must not happen in a frame.
  void keep(Posting posting) { kept_.push_back(std::move(posting)); }

  void note(std::size_t number, Baked outcome) {
    if (baked_.size() <= number) baked_.resize(number + 1);
    baked_[number] = std::move(outcome);
  }

  static Baked outcome(Clock::time_point asked, const welkin::Projection& light) {
    return {light.radiance, light.diagnostics.texels, milliseconds(Clock::now() - asked)};
  }

 private:
  std::vector<Posting> kept_;
  std::vector<Baked> baked_;
};

/// Light inside the frame, with all the threads that a frame has.
class SynchronousBaker final : public Baker {
 public:
  explicit SynchronousBaker(tbb::task_arena& arena) : arena_(arena) {}

  void ask(Posting posting) override {
    const Clock::time_point asked = Clock::now();
    const welkin::Projection light = arena_.execute(
        [&] { return std::visit([](const auto& request) { return request(welkin::Control{}); }, posting.request); });
    note(posting.number, outcome(asked, light));
    keep(std::move(posting));
  }

 private:
  tbb::task_arena& arena_;
};

/// Requests are posted, and results are collected at the end of each frame.
class WorkerBaker final : public Baker {
 public:
  explicit WorkerBaker(welkin::WorkerOptions options) : worker_(std::move(options)) {}

  void ask(Posting posting) override {
    const auto post = [&](auto& request) { return worker_.post(std::move(request), {.key = std::move(posting.key)}); };
    auto job = std::visit(post, posting.request);
    std::move(job).on_drain([this, number = posting.number, asked = Clock::now()](auto light) {
      try {
        note(number, outcome(asked, light.get()));
      } catch (const welkin::Error& error) {  // a newer sun came before this one was done: as it should be
        if (error.code() != welkin::ErrorCode::replaced) throw;
        note(number, {});
      }
    });
  }

  void collect() override { worker_.drain(std::chrono::microseconds(500)); }

  void finish() override {
    worker_.wait_until_idle();
    worker_.drain();
  }

 private:
  welkin::Worker worker_;
};

/// A TBB arena, lent to the worker.
class ArenaExecutor final : public welkin::Executor {
 public:
  explicit ArenaExecutor(tbb::task_arena& arena) : arena_(arena) {}

  [[nodiscard]] int concurrency() const noexcept override { return arena_.max_concurrency(); }
  void enqueue(void (*run)(void* job), void* job) override {
    arena_.enqueue([run, job] { run(job); });
  }

 private:
  tbb::task_arena& arena_;
};

/// The ways to set a worker up that the loop can compare.
///
/// own-idle, own-below, own-normal: threads of its own, of that priority.
/// lent: a TBB arena of low priority, in addition to the engine's own, served by the same pool.
/// lent-engine: the arena that frames are computed in, to show why not.
inline const std::vector<std::string> kSetups{"own-idle", "own-below", "own-normal", "lent", "lent-engine"};

/// `threads` of the worker; 0: as many as the process may use. `engine` is the frames' arena, `low` is made for the
/// worker if it needs one, with `threads` slots, and must outlive it.
inline welkin::WorkerOptions worker_options(const std::string& setup, int threads, tbb::task_arena& engine,
                                            std::optional<tbb::task_arena>& low) {
  using welkin::ThreadPriority;
  if (setup == "own-idle") return {.threads = threads, .thread_priority = ThreadPriority::idle};
  if (setup == "own-below") return {.threads = threads, .thread_priority = ThreadPriority::below_normal};
  if (setup == "own-normal") return {.threads = threads, .thread_priority = ThreadPriority::normal};
  if (setup == "lent-engine") return {.executor = std::make_shared<ArenaExecutor>(engine)};
  if (setup != "lent") throw std::invalid_argument(setup + ": no such set-up");
  // No slot is reserved for a thread of the engine's: none ever goes in there.
  low.emplace(threads > 0 ? threads : welkin::available_threads(), 0U, tbb::task_arena::priority::low);
  return {.executor = std::make_shared<ArenaExecutor>(*low)};
}

}  // namespace engine_loop
