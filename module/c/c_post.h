// Posting: what is handed over is given back whatever happens, and nothing fails any more once a job is posted.
#pragma once

#include <utility>

#include "c/c_support.h"
#include "c/c_worker.h"
#include "welkin/welkin.h"

namespace welkin::c_interface {

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
[[nodiscard]] welkin_status guarded_post(welkin_worker* worker, const welkin_post_options* options, welkin_job** job,
                                         const Body& body) noexcept {
  return guarded([&] {
    if (job != nullptr) *job = nullptr;
    Posting posting(options);
    require(worker, "worker");
    body(posting);
    return WELKIN_OK;
  });
}

}  // namespace welkin::c_interface
