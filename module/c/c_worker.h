// What C callers hold: a worker, its jobs, and results.
#pragma once

#include <atomic>
#include <chrono>
#include <cstdint>
#include <functional>
#include <memory>
#include <mutex>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "c/c_support.h"
#include "welkin/bake.h"
#include "welkin/probes.h"
#include "welkin/projection.h"
#include "welkin/reflections.h"
#include "welkin/sky.h"
#include "welkin/sky_light.h"
#include "welkin/welkin.h"
#include "welkin/worker.h"

// Results. A handle shares what it shows: it holds a pointer, and any number of handles may hold the same.

struct welkin_chain {
  welkin_chain() = default;  ///< shows nothing
  explicit welkin_chain(std::shared_ptr<const welkin::PrefilteredSpecular> specular);
  /// Of a chain or an image that `its_owner` keeps.
  welkin_chain(std::vector<welkin::CubemapView> its_levels, std::shared_ptr<const void> its_owner);

  std::vector<welkin::CubemapView> levels;    ///< packed RGB floats
  std::span<const welkin::MipRecord> mips{};  ///< of a prefiltered one
  std::shared_ptr<const void> owner;
};

struct welkin_bake_result {
  explicit welkin_bake_result(std::shared_ptr<const welkin::BakeResult> its_result);

  std::shared_ptr<const welkin::BakeResult> result;
  welkin_chain background, specular, irradiance;  ///< of no levels where they were not made
};

struct welkin_sky_tables {
  std::shared_ptr<const welkin::SkyTables> tables;
};

struct welkin_sky_view {
  welkin::SkyView view;
};

struct welkin_sky_curve {
  welkin::SkyCurve curve;
};

struct welkin_probes {
  welkin::BakedProbes probes;
};

struct welkin_worker {
  explicit welkin_worker(welkin::WorkerOptions options) : worker(std::move(options)) {}

  welkin::Worker worker;
};

// A posted job as C callers hold it: counted, asked any number of times, from any thread.

struct welkin_job {
 public:
  template <class Result>
  void adopt(const welkin::Job<Result>& posted) noexcept {
    handle_ = static_cast<const welkin::JobHandle&>(posted);
  }

  [[nodiscard]] const welkin::JobHandle& handle() const noexcept { return handle_; }

  /// Waits until result or error are there, with the worker's help; or at most so long.
  void wait() const;
  void wait_for(std::chrono::nanoseconds time) const;

  /// WELKIN_NOT_READY, or how it ended. Throws std::bad_alloc.
  [[nodiscard]] const welkin::c_interface::Outcome& outcome() const;
  /// Of a job that is done and went well; null if it makes something else.
  template <class Result>
  [[nodiscard]] const Result* result() const {
    if (record().result_type != &welkin::detail::type_tag<Result>) return nullptr;
    const auto& made = static_cast<const welkin::detail::TypedJobRecord<Result>&>(record()).result;
    return made ? &*made : nullptr;
  }

  void retain() noexcept { references_.fetch_add(1, std::memory_order_relaxed); }
  void release() noexcept;

 private:
  [[nodiscard]] const welkin::detail::JobRecord& record() const noexcept {
    return *welkin::detail::JobAccess::record(handle_);
  }

  welkin::JobHandle handle_;  ///< the result stays in its record, where nobody takes it
  std::atomic<std::size_t> references_{1};

  mutable std::once_flag asked_;  ///< how it ended is looked up once: errors are thrown, which takes its time
  mutable welkin::c_interface::Outcome outcome_;
};

namespace welkin::c_interface {

/// Holds a reference.
using JobReference = std::shared_ptr<welkin_job>;

/// A job that nothing is known of yet. Throws std::bad_alloc.
[[nodiscard]] inline JobReference make_job() {
  return {new welkin_job, [](welkin_job* job) { job->release(); }};
}

/// What a question about the job returns, and what that leaves in `welkin_last_error`.
welkin_status report(const Outcome& outcome) noexcept;

/// `use(result)` if the job is done and went well and makes such a thing; `what` is that thing, for the message.
template <class Result, class Use>
welkin_status with_result(const welkin_job* job, const char* what, const Use& use) noexcept {
  return guarded([&] {
    require(job, "job");
    const Outcome& outcome = job->outcome();
    if (outcome.status != WELKIN_OK) return report(outcome);
    const auto* result = job->result<Result>();
    if (result == nullptr) refuse(std::string("the job makes something else; it has no ") + what);
    use(*result);
    return outcome.status;
  });
}

/// Makes a handle for the caller: `made` becomes null first, and the new handle at last.
template <class Handle, class Make>
void hand_out(Handle** made, const char* name, const Make& make) {
  require(made, name);
  *made = nullptr;
  *made = make();
}

/// Around the body of an entry that makes a handle.
template <class Handle, class Make>
welkin_status guarded_making(Handle** made, const char* name, const Make& make) noexcept {
  return guarded([&] { hand_out(made, name, make); });
}

/// The same of a job's result.
template <class Result, class Handle, class Make>
welkin_status hand_out_result(const welkin_job* job, Handle** made, const char* what, const Make& make) noexcept {
  if (made != nullptr) *made = nullptr;
  return with_result<Result>(job, what,
                             [&](const Result& result) { hand_out(made, what, [&] { return make(result); }); });
}

/// Memory of a destroyed handle comes back here; nothing is thrown.
template <class Handle>
void destroy(Handle* handle) noexcept {
  static_cast<void>(guarded([&] { const std::unique_ptr<Handle> gone(handle); }));
}

// What is asked of a prefilter, a bake and a sky. These throw `Error` (invalid_argument), for null handles too.

/// `size` is what 0 stands for; `pixels` whether the options' policy counts, else it must be null.
[[nodiscard]] PrefilterOptions prefilter_options(const welkin_prefilter_options* options, int size, bool pixels,
                                                 Quality otherwise = Quality::normal);
[[nodiscard]] BakeOptions bake_options(const welkin_bake_options* options);
[[nodiscard]] SkyTableOptions table_options(const welkin_sky_table_options* options);
[[nodiscard]] SkyCurveOptions curve_options(const welkin_sky_harmonics_options* options);
[[nodiscard]] SkyLightOptions light_options(const welkin_sky_light_options* options);
[[nodiscard]] WorkerOptions worker_options(const welkin_worker_options* options);
[[nodiscard]] ProbeGrid probe_grid(const welkin_probe_grid* grid);
[[nodiscard]] ProbeOptions probe_options(const welkin_probe_options* options);
[[nodiscard]] Atmosphere atmosphere_of(const welkin_atmosphere* atmosphere);
/// The layout of that name; `name` is text of a caller, of which messages repeat 64 characters.
[[nodiscard]] ProbeLayout probe_layout(std::string_view name);
[[nodiscard]] const std::shared_ptr<const SkyTables>& tables_of(const welkin_sky_tables* tables);
[[nodiscard]] const SkyView& view_of(const welkin_sky_view* view);

inline constexpr int kSkyReflections = 32;  ///< texels along an edge of a sky's reflections where nothing is said

// Priorities are numbers around 0, the default.

/// Throws `Error` (invalid_argument) if there is none of that number.
[[nodiscard]] TaskPriority priority_of(welkin_priority priority);

// Posting: what is handed over is given back whatever happens, and nothing fails any more once a job is posted.

/// A caller's post options; made before anything else that can fail, so that what is handed over has a keeper.
struct Posting {
  explicit Posting(const welkin_post_options* options)
      : given(options == nullptr ? welkin_post_options{} : read_known(options, "post")),
        handed_over(given.release, given.release_user) {
    if (options != nullptr) require_known(options, "post");
  }

  [[nodiscard]] PostOptions options() const {
    PostOptions wanted;
    wanted.priority = priority_of(given.priority);
    if (given.key != nullptr) wanted.key = given.key;
    if (given.bytes != 0) wanted.bytes = given.bytes;
    return wanted;
  }

  welkin_post_options given;
  HandedOver handed_over;
};

/// Calls `completed` inside `drain`.
class CompletedCallback final : public detail::Computation {
 public:
  CompletedCallback(JobReference job, decltype(welkin_post_options::completed) completed, void* user)
      : Computation(detail::CallSite::drain), job_(std::move(job)), completed_(completed), user_(user) {}

  void run(const Control&) override {
    if (!returns([this] { completed_(job_.get(), user_); })) refuse_thread_exit("completed");
  }

 private:
  JobReference job_;
  decltype(welkin_post_options::completed) completed_;
  void* user_;
};

/// All that is needed later is made first: nothing may fail once the job is posted.
template <class Request>
void post(welkin_worker* worker, Request request, const Posting& posting, welkin_job** job) {
  const JobReference reference = make_job();
  detail::ComputationList completed;
  if (posting.given.completed != nullptr) {
    completed.push_back(detail::make_shared_in_job_memory<CompletedCallback>(reference, posting.given.completed,
                                                                             posting.given.completed_user));
  }
  const std::uint64_t bytes = detail::bytes_of(request);
  const auto made = detail::JobAccess::make<Request>(std::move(request));
  reference->adopt(made);
  detail::JobAccess::submit(worker->worker, made, posting.options(), bytes, std::move(completed));
  if (job == nullptr) return;
  reference->retain();
  *job = reference.get();
}

/// Around every post: `body` gets the posting and returns the request.
template <class Body>
[[nodiscard]] welkin_status guarded_post(welkin_worker* worker, const welkin_post_options* options, welkin_job** job,
                                         const Body& body) noexcept {
  return guarded([&] {
    if (job != nullptr) *job = nullptr;
    Posting posting(options);
    require(worker, "worker");
    auto request = body(posting);
    c_interface::post(worker, std::move(request), posting, job);
  });
}

}  // namespace welkin::c_interface
