// Promise: whatever several threads do to several workers at once, every job ends with the right result or an expected
// error, every callback and coroutine is called or freed, and nothing hangs.
//
// WELKIN_STRESS_SEED=n repeats the random choices of a run; the interleaving of its threads cannot be repeated.
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include "support/bit_hash.h"
#include "support/catch.h"
#include "support/jobs.h"
#include "support/process_threads.h"
#include "support/test_environments.h"
#include "support/trials.h"
#include "welkin/worker.h"

namespace welkin::test {
namespace {

constexpr int kThreads = 4;
constexpr int kStepsPerThread = kSanitized ? 600 : 6000;
constexpr std::chrono::seconds kLongest{kSanitized ? 40 : 4};

using Number = std::uint64_t;

Number digest(const Projection& light) { return bits_of(light.radiance); }

/// Counts the objects that a worker may keep: requests, follow-ups, callbacks.
struct Kept {
  inline static std::atomic<int> alive{0};
  Kept() { ++alive; }
  Kept(const Kept&) { ++alive; }
  Kept(Kept&&) noexcept { ++alive; }
  Kept& operator=(const Kept&) = default;
  Kept& operator=(Kept&&) noexcept = default;
  ~Kept() { --alive; }
};

/// value * value, after some work.
struct Square {
  Number value = 0;
  int rounds = 0;
  Kept kept{};

  Number operator()(const Control& control) const {
    for (int k = 0; k < rounds; ++k) {
      if (control.stop.stop_requested()) throw Error(ErrorCode::cancelled, "told to stop");
      control.progress(static_cast<double>(k) / rounds);
      for (int spin = 0; spin < 300; ++spin) std::atomic_signal_fence(std::memory_order_seq_cst);
    }
    return value * value;
  }
  [[nodiscard]] std::uint64_t bytes() const { return value * 100; }
};

/// A projection's digest.
struct ProjectDigest {
  Project request;
  Kept kept{};

  Number operator()(const Control& control) const { return digest(request(control)); }
  [[nodiscard]] std::uint64_t bytes() const { return request.bytes(); }
};

/// The outcomes that a job may have, and whether it was cancelled meanwhile.
struct Expected {
  Number value = 0;
  std::string thrown{};  ///< instead of a value
  bool keyed = false;
  bool may_be_full = false;
  std::shared_ptr<std::atomic<bool>> cancelled = std::make_shared<std::atomic<bool>>(false);
};

class Stress {
 public:
  explicit Stress(unsigned seed) : seed_(seed) {
    for (const int size : {5, 33, 64, 131}) {
      images_.push_back(std::make_shared<const Cubemap>(
          Cubemap{size, make_cubemap(Content::special_values, size, 3, static_cast<std::uint32_t>(size)).pixels}));
      digests_.push_back(digest(project(images_.back()->view())));
    }
    for (std::size_t slot = 0; slot < kSlots; ++slot) workers_[slot] = make_worker(slot);
  }

  void run() {
    on_threads(kThreads, [this](std::size_t t) { Thread(*this, seed_ * 1000U + static_cast<unsigned>(t)).run(); });
    for (std::size_t slot = 0; slot < kSlots; ++slot) {
      const auto worker = exchange(slot, nullptr);
      if (slot % 2 == 0) worker->wait_until_idle();
      worker->terminate();
      worker->drain();
    }
  }

  [[nodiscard]] const std::vector<std::string>& failures() const { return failures_; }
  [[nodiscard]] Number posted() const { return posted_; }
  [[nodiscard]] Number checked() const { return checked_; }
  [[nodiscard]] Number results() const { return results_; }

 private:
  static constexpr std::size_t kSlots = 4;  ///< workers: one thread, three, a lent arena, one without limits

  std::shared_ptr<Worker> make_worker(std::size_t slot) {
    WorkerOptions options = options_with(slot == 1 ? 3 : 1);
    options.name = slot == 2 ? "lent" : "stress";
    options.max_jobs = slot == 3 ? 4096 : 40;
    options.max_bytes = 3 << 20;
    if (slot == 2) {
      options.executor = std::make_shared<ArenaExecutor>(*arena_);
    }
    return std::make_shared<Worker>(options);
  }

  std::shared_ptr<Worker> worker(std::size_t slot) {
    const std::scoped_lock lock(mutex_);
    return workers_[slot];
  }

  std::shared_ptr<Worker> exchange(std::size_t slot, std::shared_ptr<Worker> worker) {
    const std::scoped_lock lock(mutex_);
    return std::exchange(workers_[slot], std::move(worker));
  }

  void fail(const std::string& what) {
    const std::scoped_lock lock(mutex_);
    if (failures_.size() < 20) failures_.push_back(what);
  }

  void check(std::future<Number> future, const Expected& expected) {
    ++checked_;
    Number value = 0;
    const std::string end = outcome_of([&] { value = future.get(); });
    if (end == "result") {
      ++results_;
      if (!expected.thrown.empty() || value != expected.value) fail("a wrong result");
    } else if (!(end == "stopped" || (end == expected.thrown) || (end == "replaced" && expected.keyed) ||
                 (end == "queue_full" && expected.may_be_full) || (end == "cancelled" && *expected.cancelled))) {
      fail("unexpected: " + end);
    }
  }

  Detached await(Job<Number> job, Expected expected, bool drained, Kept) {
    std::promise<Number> promise;
    std::future<Number> future = promise.get_future();
    try {
      if (drained) {
        promise.set_value(co_await std::move(job).drained());
      } else {
        promise.set_value(co_await std::move(job));
      }
    } catch (...) {
      promise.set_exception(std::current_exception());
    }
    check(std::move(future), expected);
  }

  /// One of the threads that use the workers at random.
  class Thread {
   public:
    Thread(Stress& stress, unsigned seed) : stress_(stress), random_(seed) {}

    void run() {
      const auto end = std::chrono::steady_clock::now() + kLongest;
      for (int step = 0; step < kStepsPerThread && std::chrono::steady_clock::now() < end; ++step) take_step();
      for (Held& held : held_) stress_.check(future_of(std::move(held.job)), held.expected);
    }

   private:
    struct Held {
      Job<Number> job;
      Expected expected;
      double progress = 0.0;
    };
    struct Handle {
      JobHandle handle;
      std::shared_ptr<std::atomic<bool>> cancelled;
    };

    unsigned below(unsigned bound) { return std::uniform_int_distribution<unsigned>(0, bound - 1)(random_); }
    bool one_in(unsigned count) { return below(count) == 0; }
    TaskPriority priority() { return static_cast<TaskPriority>(below(3)); }

    void take_step() {
      const unsigned dice = below(100);
      if (dice < 60) return post();
      if (dice < 70) return cancel_one();
      if (dice < 75) return move_one();
      if (dice < 85) return drain();
      if (dice < 97) return look_at_one();
      if (dice < 98 && one_in(3)) return replace_worker();
    }

    void post() {
      const std::size_t slot = below(kSlots);
      const auto worker = stress_.worker(slot);
      PostOptions options{.priority = priority()};
      Expected expected;
      expected.may_be_full = slot != 3;
      if (one_in(4)) {
        options.key = std::string_view("abcde").substr(below(5), 1);
        expected.keyed = true;
      }
      if (slot == 3) options.bytes = 0;
      Job<Number> job = post_one(worker, options, expected);
      ++stress_.posted_;
      if (one_in(4)) job = follow(std::move(job), expected);
      dispose(std::move(job), std::move(expected));
    }

    Job<Number> post_one(const std::shared_ptr<Worker>& worker, const PostOptions& options, Expected& expected) {
      const Number value = below(8);
      switch (below(9)) {
        case 0:
        case 1:
        case 2: expected.value = value * value; return worker->post(Square{value, 20}, options);
        case 3:
        case 4: {
          const std::size_t image = below(static_cast<unsigned>(stress_.images_.size()));
          expected.value = stress_.digests_[image];
          if (one_in(2)) return worker->post(ProjectDigest{Project{stress_.images_[image]}}, options);
          return worker->post(Project{Cubemap(*stress_.images_[image])}, options).then(&digest);
        }
        case 5: {
          expected.thrown = value % 2 == 0 ? "on purpose" : "something";
          return worker->post(
              [value, kept = Kept()](const Control&) -> Number {
                if (value % 2 == 0) throw std::runtime_error("on purpose");
                throw 7;
              },
              options);
        }
        case 6: {
          expected.value = 4950;
          return worker->post(
              [kept = Kept()](const Control&) {
                std::atomic<Number> sum{0};
                tbb::parallel_for(Number{0}, Number{100}, [&](Number k) { sum += k; });
                return sum.load();
              },
              options);
        }
        case 7: {
          // Waits for another job of the same worker, to which it may hold the last reference.
          expected.value = value * value + 1;
          return worker->post(
              [value, weak = std::weak_ptr<Worker>(worker), kept = Kept()](const Control&) {
                const auto held = weak.lock();
                if (!held) throw Error(ErrorCode::stopped, "the worker is gone");
                auto inner = held->post(Square{value, 20});
                return inner.get() + 1;
              },
              options);
        }
        default: {
          // Runs until it is stopped, which is at once.
          auto job = worker->post(
              [kept = Kept()](const Control& control) -> Number {
                while (!control.stop.stop_requested()) std::this_thread::yield();
                return 0;
              },
              options);
          *expected.cancelled = true;
          job.cancel();
          expected.thrown = "cancelled";
          return job;
        }
      }
    }

    Job<Number> follow(Job<Number> job, Expected& expected) {
      for (unsigned k = below(3); k > 0; --k) {
        ++expected.value;
        job = std::move(job).then([kept = Kept()](Number value) { return value + 1; });
      }
      return job;
    }

    /// Takes the result in one of the possible ways, now, later or never.
    void dispose(Job<Number> job, Expected expected) {
      handles_.push_back({job, expected.cancelled});
      if (handles_.size() > 40) handles_.erase(handles_.begin());
      switch (below(8)) {
        case 0:
        case 1:
        case 2: held_.push_back({std::move(job), std::move(expected), 0.0}); break;
        case 3:
          std::move(job).on_drain([&stress = stress_, expected = std::move(expected), kept = Kept()](Job<Number> done) {
            stress.check(future_of(std::move(done)), expected);
          });
          break;
        case 4: stress_.await(std::move(job), std::move(expected), false, Kept()); break;
        case 5: stress_.await(std::move(job), std::move(expected), true, Kept()); break;
        case 6:
          if (one_in(4)) stress_.check(future_of(std::move(job)), expected);
          break;
        default: break;  // the result is dropped
      }
      while (held_.size() > 60) check_one(below(static_cast<unsigned>(held_.size())));
    }

    void check_one(std::size_t index) {
      Held held = std::move(held_[index]);
      held_.erase(held_.begin() + static_cast<std::ptrdiff_t>(index));
      stress_.check(future_of(std::move(held.job)), held.expected);
    }

    void cancel_one() {
      if (handles_.empty()) return;
      const Handle& one = handles_[below(static_cast<unsigned>(handles_.size()))];
      const bool was_ready = one.handle.ready();
      *one.cancelled = true;
      if (one.handle.cancel() && was_ready) stress_.fail("a job that was ready was given up");
    }

    void move_one() {
      if (!handles_.empty()) handles_[below(static_cast<unsigned>(handles_.size()))].handle.set_priority(priority());
    }

    void drain() {
      const auto worker = stress_.worker(below(kSlots));
      static_cast<void>(worker->drain(std::chrono::microseconds(below(200))));
      const WorkerLoad load = worker->load();
      if (load.jobs > 100'000 || load.bytes > (Number{1} << 40U)) stress_.fail("a load below nothing");
    }

    void look_at_one() {
      if (held_.empty()) return;
      const std::size_t index = below(static_cast<unsigned>(held_.size()));
      Held& held = held_[index];
      const double progress = held.job.progress();
      if (progress < held.progress || progress > 1.0) stress_.fail("progress that fell");
      held.progress = progress;
      if (held.job.ready()) check_one(index);
    }

    void replace_worker() {
      const std::size_t slot = below(kSlots);
      const auto old = stress_.exchange(slot, stress_.make_worker(slot));
      if (one_in(2)) old->terminate();
      if (one_in(2)) static_cast<void>(old->drain());
    }

    Stress& stress_;
    std::mt19937 random_;
    std::vector<Held> held_;
    std::vector<Handle> handles_;
  };

  unsigned seed_;
  std::vector<std::shared_ptr<const Cubemap>> images_;
  std::vector<Number> digests_;
  std::shared_ptr<tbb::task_arena> arena_ = std::make_shared<tbb::task_arena>(2);

  std::mutex mutex_;
  std::array<std::shared_ptr<Worker>, kSlots> workers_;
  std::vector<std::string> failures_;
  std::atomic<Number> posted_{0};
  std::atomic<Number> checked_{0};
  std::atomic<Number> results_{0};
};

unsigned chosen_seed() {
  const char* chosen = std::getenv("WELKIN_STRESS_SEED");
  return chosen != nullptr ? static_cast<unsigned>(std::strtoul(chosen, nullptr, 10))
                           : std::random_device()() % 1000000U;
}

}  // namespace

TEST_CASE("workers stand whatever is done to them at once", "[worker][stress][slow]") {
  const unsigned seed = chosen_seed();
  std::fprintf(stderr, "WELKIN_STRESS_SEED=%u\n", seed);  // at once: ctest ends a test that hangs and shows this
  Number posted = 0;
  Number checked = 0;
  {
    Stress stress(seed);
    stress.run();
    for (const std::string& failure : stress.failures()) FAIL_CHECK(failure);
    posted = stress.posted();
    checked = stress.checked();
    CHECK(stress.results() > 0);
    CHECK(eventually([] { return Detached::alive == 0; }));
    CHECK(eventually([] { return Kept::alive == 0; }));
  }
  CHECK(posted > (kSanitized ? 100 : 1000));
  CHECK(checked > posted / 4);
  CHECK(eventually([] {
    const std::set<int> threads = process_threads();
    return std::none_of(threads.begin(), threads.end(),
                        [](int thread) { return thread_name(thread).rfind("stress", 0) == 0; });
  }));
}

}  // namespace welkin::test
