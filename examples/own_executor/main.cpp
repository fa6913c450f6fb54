// A worker on the threads of an engine: the engine's thread pool becomes a welkin::Executor.
//
// The program makes the light of a few cubemaps on the pool, polls for it as a frame loop would, and compares it with
// what direct calls give. It ends with 0 if all is the same.
#include <welkin/worker.h>

#include <algorithm>
#include <cstddef>
#include <cstdio>
#include <memory>
#include <thread>
#include <utility>
#include <vector>

#include "pool_executor.h"
#include "thread_pool.h"

namespace {

/// A room with grey walls and a bright ceiling, each one of another brightness.
welkin::Cubemap room(int number) {
  constexpr int kSize = 64;
  constexpr std::size_t kFaceValues = std::size_t{3} * kSize * kSize;
  constexpr int kCeiling = 2;  // +Y
  welkin::Cubemap image{kSize, std::vector<float>(6 * kFaceValues, 0.2F)};
  for (std::size_t k = 0; k < kFaceValues; ++k) {
    image.face(kCeiling)[k] = 1.0F + static_cast<float>(number);
  }
  return image;
}

bool same(const welkin::Projection& a, const welkin::Projection& b) {
  return std::ranges::equal(a.radiance.coefficients(), b.radiance.coefficients());
}

}  // namespace

int main() {
  constexpr int kRooms = 8;
  std::vector<welkin::Projection> expected;
  for (int k = 0; k < kRooms; ++k) expected.push_back(welkin::project(room(k).view()));

  own_executor::ThreadPool pool(2);
  welkin::WorkerOptions options;
  options.executor = std::make_shared<own_executor::PoolExecutor>(pool);
  welkin::Worker worker(std::move(options));  // it has no threads of its own

  std::vector<welkin::Job<welkin::Projection>> jobs;
  for (int k = 0; k < kRooms; ++k) jobs.push_back(worker.post(welkin::Project{room(k)}));

  std::size_t right = 0;
  std::size_t open = jobs.size();
  for (int frame = 0; open > 0; ++frame) {
    for (std::size_t k = 0; k < jobs.size(); ++k) {
      if (auto light = jobs[k].try_take()) {  // never waits
        right += same(*light, expected[k]) ? 1 : 0;
        --open;
        std::printf("frame %d: the light of room %zu\n", frame, k);
      } else if (const auto error = jobs[k].error()) {
        std::printf("room %zu: %s\n", k, error->message.c_str());
        return 1;
      }
    }
    std::this_thread::yield();  // here the engine would draw
  }
  std::printf("%zu of %d are the direct calls' bits\n", right, kRooms);
  return right == jobs.size() ? 0 : 1;
}
