// A host that is compiled without exceptions and without RTTI, as many engines are: posts, polls, follows, drains,
// lends its thread and hears of errors, with the library as everybody else links it.
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <deque>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "welkin/requests.h"
#include "welkin/sky_light.h"
#include "welkin/worker.h"

#if defined(__cpp_exceptions) || defined(__cpp_rtti)
#error "this program is to be compiled with -fno-exceptions -fno-rtti"
#endif

namespace {

void expect(bool holds, const char* what) {
  if (holds) return;
  std::fprintf(stderr, "without_exceptions: not so: %s\n", what);
  std::exit(1);
}

/// The program's own thread, when it says so.
class OwnThread final : public welkin::Executor {
 public:
  [[nodiscard]] int concurrency() const noexcept override { return 1; }
  void enqueue(void (*run)(void* job), void* job) override { tasks_.emplace_back(run, job); }

  void run_all() {
    while (!tasks_.empty()) {
      const auto task = tasks_.front();
      tasks_.pop_front();
      task.first(task.second);
    }
  }

 private:
  std::deque<std::pair<void (*)(void*), void*>> tasks_;
};

template <int kind>
struct Number {
  int value;
  int* runs;

  int operator()(const welkin::Control&) const {
    ++*runs;
    return value + kind;
  }
};

welkin::Cubemap grey(float value) { return {4, std::vector<float>(std::size_t{6} * 4 * 4 * 3, value)}; }

}  // namespace

int main() {
  const auto own_thread = std::make_shared<OwnThread>();
  welkin::WorkerOptions options{.executor = own_thread};
  welkin::Worker worker(std::move(options));

  auto light = worker.post(welkin::Project{grey(2.0F)});
  int runs = 0;
  auto one = worker.post(Number<1>{5, &runs});
  auto other = worker.post(Number<2>{5, &runs});
  auto followed = worker.post([](const welkin::Control&) { return 20; }).then([](int value) { return value + 1; });
  int drained = 0;
  worker.post([](const welkin::Control&) { return 4; }).on_drain([&drained](welkin::Job<int> job) {
    if (auto value = job.try_take()) drained = *value;
  });
  // No side of a cubemap can be of -1 texels: the call throws inside the library, and what follows is not run.
  auto failing = worker.post(welkin::ToCubemap{grey(1.0F), -1});
  const welkin::JobHandle failed = failing;
  auto after = std::move(failing).then([](const welkin::Cubemap& image) { return image.size(); });

  expect(!light.try_take() && !light.error(), "a job that waits gives nothing");
  own_thread->run_all();
  const auto projection = light.try_take();
  expect(projection.has_value(), "a job that is done gives its result");
  const double band_0 = projection->radiance.coefficients()[0].x;
  expect(std::abs(band_0 - 2.0 * std::sqrt(4.0 * 3.14159265358979323846)) < 1e-6, "a grey room has its light");
  expect(one.try_take() == 6 && other.try_take() == 7, "numbers are theirs");
  expect(runs == 2, "each request is run once");
  expect(followed.try_take() == 21, "a continuation has its result");
  expect(worker.drain() == 1 && drained == 4, "a callback is drained");
  const auto error = after.error();
  expect(failed.error() && error && !after.try_take(), "a failed job has an error, and so has what follows it");
  expect(error->code == welkin::ErrorCode::invalid_argument, "the error has its code");
  expect(!error->message.empty() && error->message == failed.error()->message, "the error has its words");

  auto cancelled = worker.post(welkin::Project{grey(1.0F)});
  expect(cancelled.cancel() && cancelled.error()->code == welkin::ErrorCode::cancelled, "a job can be cancelled");
  return 0;
}
