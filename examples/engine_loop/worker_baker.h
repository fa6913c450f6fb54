// Bakes on a worker: requests are posted, results are collected at the end of each frame.
#pragma once

#include <welkin/worker.h>

#include "baker.h"

namespace engine_loop {

class WorkerBaker final : public Baker {
 public:
  explicit WorkerBaker(welkin::WorkerOptions options);

  void collect() override;
  void ask(Posting posting) override;
  void finish() override;

 private:
  void take(std::size_t number, Clock::time_point asked, welkin::Job<welkin::Projection> light);

  welkin::Worker worker_;
};

}  // namespace engine_loop
