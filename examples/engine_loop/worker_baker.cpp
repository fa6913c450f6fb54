#include "worker_baker.h"

#include <welkin/core.h>

#include <chrono>
#include <utility>
#include <variant>

namespace engine_loop {
namespace {

constexpr std::chrono::microseconds kDrainBudget(500);

}  // namespace

WorkerBaker::WorkerBaker(welkin::WorkerOptions options) : worker_(std::move(options)) {}

void WorkerBaker::ask(Posting posting) {
  const Clock::time_point asked = Clock::now();
  auto job =
      std::visit([&](auto& request) { return worker_.post(std::move(request), {.key = std::move(posting.key)}); },
                 posting.request);
  std::move(job).on_drain([this, number = posting.number, asked](welkin::Job<welkin::Projection> light) {
    take(number, asked, std::move(light));
  });
}

void WorkerBaker::collect() { worker_.drain(kDrainBudget); }

void WorkerBaker::finish() {
  worker_.wait_until_idle();
  worker_.drain();
}

void WorkerBaker::take(std::size_t number, Clock::time_point asked, welkin::Job<welkin::Projection> light) {
  try {
    keep(number, asked, light.get());
  } catch (const welkin::Error& error) {
    // A newer sun came before this one was done: as it should be.
    if (error.code() != welkin::ErrorCode::replaced) throw;
    give_up(number);
  }
}

}  // namespace engine_loop
