// Many threads retain, ask, cancel and release; each job's pixels are released once, and each handle lives until its
// last reference goes.
#include <array>
#include <atomic>
#include <random>
#include <thread>
#include <vector>

#include "c_interface/c_views.h"
#include "support/catch.h"
#include "support/test_environments.h"

namespace welkin::test {
namespace {

/// One post's pixels: how often they were released, and whether the job's callback came.
struct Slot {
  std::atomic<int> released{0};
  std::atomic<int> completed{0};
};

void release_slot(void* slot) { static_cast<Slot*>(slot)->released.fetch_add(1); }
void complete_slot(welkin_job* job, void* slot) {
  if (welkin_job_poll(job, nullptr) != WELKIN_NOT_READY) static_cast<Slot*>(slot)->completed.fetch_add(1);
}

welkin_post_options post_for(Slot& slot) {
  auto post = c_struct<welkin_post_options>();
  post.release = release_slot;
  post.release_user = &slot;
  post.completed = complete_slot;
  post.completed_user = &slot;
  return post;
}

}  // namespace

TEST_CASE("C: a handle is shared by many threads", "[c_interface]") {
  constexpr int kThreads = 4;
  const CWorker worker(2);
  const auto cube = make_cubemap(Content::random, 32, 3, 1);
  const welkin_cubemap view = c_view(cube.view());
  std::atomic<int> wrong{0};
  for (int round = 0; round < 50; ++round) {
    welkin_job* job = nullptr;
    REQUIRE(welkin_post_project_cubemap(worker.get(), &view, 1, nullptr, nullptr, &job) == WELKIN_OK);
    std::vector<std::thread> threads;
    for (int i = 0; i < kThreads; ++i) {
      welkin_job_retain(job);
      threads.emplace_back([&wrong, job, i, round] {
        if (i == 0 && round % 2 == 0) welkin_job_cancel(job, nullptr);
        const welkin_status status = welkin_job_wait(job, WELKIN_NO_LIMIT);
        if (status != WELKIN_OK && status != WELKIN_CANCELLED) wrong.fetch_add(1);
        auto light = c_struct<welkin_projection>();
        if (welkin_job_projection(job, &light) != status) wrong.fetch_add(1);
        welkin_job_release(job);
      });
    }
    welkin_job_release(job);  // the others keep it
    for (std::thread& thread : threads) thread.join();
  }
  REQUIRE(wrong.load() == 0);
}

TEST_CASE("C: pixels are released once, whoever posts, cancels, drains and terminates", "[c_interface]") {
  constexpr int kThreads = 3;
  constexpr int kPosts = 60;
  const unsigned seed = 4711;
  INFO("seed " << seed);
  const auto cube = make_cubemap(Content::random, 24, 3, 1);
  const welkin_cubemap view = c_view(cube.view());
  for (unsigned round = 0; round < 8; ++round) {
    std::vector<Slot> slots(std::size_t{kThreads} * kPosts);
    std::atomic<int> posted{0};
    auto options = c_struct<welkin_worker_options>();
    options.threads = 2;
    options.most_jobs = 16;
    options.when_full = static_cast<welkin_when_full>(round % 3);
    welkin_worker* worker = nullptr;
    REQUIRE(welkin_worker_create(&options, &worker) == WELKIN_OK);
    std::vector<std::thread> threads;
    for (unsigned i = 0; i < kThreads; ++i) {
      threads.emplace_back([&, i] {
        std::mt19937 random(seed + round * kThreads + i);
        for (unsigned k = 0; k < kPosts; ++k) {
          welkin_post_options post = post_for(slots[i * kPosts + k]);
          const std::array<const char*, 4> keys{nullptr, nullptr, "one", "two"};
          post.key = keys.at(random() % keys.size());
          post.priority = static_cast<welkin_priority>(random() % 3) - 1;
          welkin_job* job = nullptr;
          if (welkin_post_project_cubemap(worker, &view, 1, nullptr, &post, &job) == WELKIN_OK) posted.fetch_add(1);
          if (random() % 3 == 0) welkin_job_cancel(job, nullptr);
          if (random() % 4 == 0) welkin_worker_drain(worker, 0, nullptr);
          if (i == 0 && k == kPosts / 2 && round % 2 == 0) welkin_worker_terminate(worker);
          welkin_job_release(job);
        }
      });
    }
    for (std::thread& thread : threads) thread.join();
    welkin_worker_wait_until_idle(worker);
    REQUIRE(welkin_worker_terminate(worker) == WELKIN_OK);
    REQUIRE(welkin_worker_drain(worker, WELKIN_NO_LIMIT, nullptr) == WELKIN_OK);
    welkin_worker_destroy(worker);
    REQUIRE(posted.load() == static_cast<int>(slots.size()));
    for (const Slot& slot : slots) {
      REQUIRE(slot.released.load() == 1);
      REQUIRE(slot.completed.load() == 1);
    }
  }
}

}  // namespace welkin::test
