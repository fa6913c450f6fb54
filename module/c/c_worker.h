// The handles of the C interface: a worker, its jobs, and results.
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

// Results. A handle shares what it shows through a pointer; any number of handles may hold the same one.

struct welkin_chain {
  welkin_chain() = default;  ///< has no levels
  explicit welkin_chain(std::shared_ptr<const welkin::PrefilteredSpecular> specular);
  /// Shows a chain or an image that `its_owner` keeps.
  welkin_chain(std::vector<welkin::CubemapView> its_levels, std::shared_ptr<const void> its_owner);

  std::vector<welkin::CubemapView> levels;    ///< packed RGB floats
  std::span<const welkin::MipRecord> mips{};  ///< of a prefiltered chain
  std::shared_ptr<const void> owner;
};

struct welkin_bake_result {
  explicit welkin_bake_result(std::shared_ptr<const welkin::BakeResult> its_result);

  std::shared_ptr<const welkin::BakeResult> result;
  welkin_chain background, specular, irradiance;  ///< without levels where they were not made
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

// A posted job as C callers hold it: reference-counted, and usable from any thread.

struct welkin_job {
 public:
  template <class Result>
  void adopt(const welkin::Job<Result>& posted) noexcept {
    handle_ = static_cast<const welkin::JobHandle&>(posted);
  }

  [[nodiscard]] const welkin::JobHandle& handle() const noexcept { return handle_; }

  /// Waits for a result or an error while helping the worker; `wait_for` waits at most the given time.
  void wait() const;
  void wait_for(std::chrono::nanoseconds time) const;

  /// Returns WELKIN_NOT_READY, or how the job ended. Throws std::bad_alloc.
  [[nodiscard]] const welkin::c_interface::Outcome& outcome() const;
  /// Returns the result of a job that succeeded; null if the job makes another type.
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

  welkin::JobHandle handle_;  ///< the result stays in its record and is never moved out
  std::atomic<std::size_t> references_{1};

  mutable std::once_flag asked_;  ///< the outcome is looked up once: errors are thrown, which is slow
  mutable welkin::c_interface::Outcome outcome_;
};

namespace welkin::c_interface {

/// A counted reference to a job.
using JobReference = std::shared_ptr<welkin_job>;

/// Makes a job that is not yet attached to a posted one. Throws std::bad_alloc.
[[nodiscard]] inline JobReference make_job() {
  return {new welkin_job, [](welkin_job* job) { job->release(); }};
}

/// Returns the status of a query about the job; a failure also becomes the last error.
welkin_status report(const Outcome& outcome) noexcept;

/// Calls `use(result)` if the job succeeded and makes this type; `what` names the type in the message.
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

/// Makes a handle for the caller: sets `made` to null first, and to the new handle at the end.
template <class Handle, class Make>
void hand_out(Handle** made, const char* name, const Make& make) {
  require(made, name);
  *made = nullptr;
  *made = make();
}

/// Wraps the body of an entry that makes a handle.
template <class Handle, class Make>
welkin_status guarded_making(Handle** made, const char* name, const Make& make) noexcept {
  return guarded([&] { hand_out(made, name, make); });
}

/// Makes a handle for a job's result.
template <class Result, class Handle, class Make>
welkin_status hand_out_result(const welkin_job* job, Handle** made, const char* what, const Make& make) noexcept {
  if (made != nullptr) *made = nullptr;
  return with_result<Result>(job, what,
                             [&](const Result& result) { hand_out(made, what, [&] { return make(result); }); });
}

/// Deletes a handle with the default floating-point environment; throws nothing.
template <class Handle>
void destroy(Handle* handle) noexcept {
  static_cast<void>(guarded([&] { const std::unique_ptr<Handle> gone(handle); }));
}

// Options of a prefilter, a bake and a sky. These throw `Error` (invalid_argument), for null handles too.

/// Reads options. 0 selects `size`. `pixels`: whether the options may have a pixel policy; if not, it must be null.
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
/// Returns the layout of that name; messages repeat at most 64 characters of `name`, which is the caller's text.
[[nodiscard]] ProbeLayout probe_layout(std::string_view name);
[[nodiscard]] const std::shared_ptr<const SkyTables>& tables_of(const welkin_sky_tables* tables);
[[nodiscard]] const SkyView& view_of(const welkin_sky_view* view);

inline constexpr int kSkyReflections = 32;  ///< default texels along an edge of a sky's reflections

// Priorities are numbers around 0, the default.

/// Throws `Error` (invalid_argument) if no priority has that number.
[[nodiscard]] TaskPriority priority_of(welkin_priority priority);

// Posting: ownership that is handed over is always released, and nothing can fail once a job is posted.

/// A caller's post options. Made before anything else that can fail, so that it owns what is handed over.
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

/// Posts a job. Makes all objects that are needed later first: nothing may fail once the job is posted.
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

/// Wraps every post: `body` gets the posting and returns the request.
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
