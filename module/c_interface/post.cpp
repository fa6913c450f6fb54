// Posting: what is handed over is given back whatever happens, and nothing fails any more once a job is posted.
#include <cstddef>
#include <string>
#include <utility>

#include "c_interface/control.h"
#include "c_interface/environments.h"
#include "c_interface/error_status.h"
#include "c_interface/handed_over.h"
#include "c_interface/job.h"
#include "c_interface/job_priority.h"
#include "c_interface/options.h"
#include "c_interface/versioned_struct.h"
#include "c_interface/worker.h"
#include "welkin/requests.h"
#include "welkin/welkin.h"

namespace welkin::c_interface {
namespace {

/// A caller's function, as a request. No two are equal.
class FunctionRequest {
 public:
  using Run = welkin_status (*)(void* user, const welkin_control* control);

  FunctionRequest(Run run, void* user, HandedOver used) noexcept : run_(run), user_(user), used_(std::move(used)) {}

  void operator()(const Control& control) const {
    const welkin_control steering{control};
    clear_last_error();
    const welkin_status status = run_(user_, &steering);
    if (status == WELKIN_OK) return;
    if (status == WELKIN_NOT_READY) {
      throw StatusError(WELKIN_INTERNAL, "the function returned WELKIN_NOT_READY, which no job can end with");
    }
    // What a call inside failed with is why the function did.
    if (status == last_error_status()) throw StatusError(status, welkin_last_error());
    throw StatusError(status, "the function returned " + std::to_string(status));
  }

 private:
  Run run_;
  void* user_;
  HandedOver used_;
};

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

/// All that is needed later is made first: nothing may fail once the job is posted.
template <class Request>
void post(welkin_worker* worker, Request request, const Posting& posting, welkin_job** job) {
  JobReference reference;
  detail::DeliveryList delivery;
  if (posting.given.completed != nullptr) {
    const auto call = [reference, completed = posting.given.completed, user = posting.given.completed_user] {
      completed(reference.get(), user);
    };
    delivery.push_back({call, false});
  }
  auto posted = worker->worker.post(std::move(request), posting.options());
  reference->adopt(posted);
  if (!delivery.empty()) detail::attach(detail::JobAccess::record(posted), std::move(delivery));
  if (job != nullptr) *job = reference.detach();
}

/// Around every post: `body` gets the posting and makes the request.
template <class Body>
welkin_status guarded_post(welkin_worker* worker, const welkin_post_options* options, welkin_job** job,
                           const Body& body) noexcept {
  return guarded([&] {
    if (job != nullptr) *job = nullptr;
    Posting posting(options);
    require(worker, "worker");
    body(posting);
    return WELKIN_OK;
  });
}

}  // namespace
}  // namespace welkin::c_interface

using namespace welkin::c_interface;  // NOLINT(google-build-using-namespace)

welkin_status welkin_post_project_cubemap(welkin_worker* worker, const welkin_cubemap* mips, int32_t mip_count,
                                          const welkin_projection_options* options, const welkin_post_options* post,
                                          welkin_job** job) {
  return guarded_post(worker, post, job, [&](Posting& posting) {
    auto views = cubemap_views(mips, mip_count);
    const auto wanted = projection_options(options);
    auto owner = make_owner(std::move(posting.handed_over));
    welkin::ProjectCubemap request{{std::move(views), std::move(owner)}, wanted};
    welkin::c_interface::post(worker, std::move(request), posting, job);
  });
}

welkin_status welkin_post_project_lat_long(welkin_worker* worker, const welkin_lat_long* lat_long,
                                           const welkin_projection_options* options, const welkin_post_options* post,
                                           welkin_job** job) {
  return guarded_post(worker, post, job, [&](Posting& posting) {
    const auto view = lat_long_view(lat_long);
    const auto wanted = projection_options(options);
    welkin::ProjectLatLong request{{view, make_owner(std::move(posting.handed_over))}, wanted};
    welkin::c_interface::post(worker, std::move(request), posting, job);
  });
}

welkin_status welkin_post_project_file(welkin_worker* worker, const char* path, const welkin_read_options* read_options,
                                       const welkin_projection_options* options, const welkin_post_options* post,
                                       welkin_job** job) {
  return guarded_post(worker, post, job, [&](Posting& posting) {
    require(path, "path");
    welkin::ProjectFile request{path, file_options(read_options), projection_options(options)};
    welkin::c_interface::post(worker, std::move(request), posting, job);
  });
}

welkin_status welkin_post_function(welkin_worker* worker,
                                   welkin_status (*run)(void* run_user, const welkin_control* control), void* run_user,
                                   const welkin_post_options* post, welkin_job** job) {
  return guarded_post(worker, post, job, [&](Posting& posting) {
    if (run == nullptr) refuse("run is null");
    FunctionRequest request(run, run_user, std::move(posting.handed_over));
    welkin::c_interface::post(worker, std::move(request), posting, job);
  });
}
