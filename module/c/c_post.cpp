// Posts of pixels and of functions.
#include <cstddef>
#include <string>
#include <utility>

#include "c/c_projection.h"
#include "c/c_support.h"
#include "c/c_worker.h"
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

}  // namespace
}  // namespace welkin::c_interface

using namespace welkin::c_interface;  // NOLINT(google-build-using-namespace,google-global-names-in-headers)

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

welkin_status welkin_post_function(welkin_worker* worker,
                                   welkin_status (*run)(void* run_user, const welkin_control* control), void* run_user,
                                   const welkin_post_options* post, welkin_job** job) {
  return guarded_post(worker, post, job, [&](Posting& posting) {
    if (run == nullptr) refuse("run is null");
    FunctionRequest request(run, run_user, std::move(posting.handed_over));
    welkin::c_interface::post(worker, std::move(request), posting, job);
  });
}
