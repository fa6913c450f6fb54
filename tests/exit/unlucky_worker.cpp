// A process with a worker, to which something happens. unlucky_worker PART; any exit code but 0 is a failure.
//
// fork: in a fork of the process, which has none of the worker's threads, each call that would wait for one of them for
// ever throws instead, and the worker, its jobs and a sky can be destroyed. The parent's worker works on.
// own: a fork makes a worker of its own once its parent's is gone, and gets an error before.
// busy: a fork that is made while a job runs gets an error too.
// no_threads MEBIBYTES: only so much of the address space, which the caller has limited (ulimit -v), is left when a
// worker is made. It works, or an exception says that there are no threads.
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cstddef>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <exception>
#include <functional>
#include <memory>
#include <new>
#include <optional>
#include <system_error>
#include <thread>
#include <utility>
#include <vector>

#include "welkin/welkin.hpp"

namespace {

constexpr unsigned kPatienceSeconds = 30;
constexpr unsigned kBriefPatienceSeconds = 5;
constexpr int kBusy = 2;  ///< exit code of a fork that was made while a thread of its parent's was at work

/// The child process's worker goes with its static objects, as a global one does.
std::unique_ptr<welkin::Worker> worker;

[[noreturn]] void fail(const char* what) {
  std::fprintf(stderr, "unlucky_worker: %s\n", what);
  std::fflush(stderr);
  std::_Exit(1);
}

void require(bool holds, const char* what) {
  if (!holds) fail(what);
}

void require_stopped(const char* what, const std::function<void()>& call) {
  try {
    call();
  } catch (const welkin::Error& error) {
    return require(error.code() == welkin::ErrorCode::stopped, what);
  }
  fail(what);
}

/// Runs `work` in a fork of this process, which then exits as programs do, and requires that this ends well and soon.
/// Returns false if `work` ended the fork by `exit_as_busy`, or if it hung and `may_hang`.
bool succeeds_in_fork(const std::function<void()>& work, bool may_hang = false) {
  const pid_t child = fork();
  require(child >= 0, "cannot fork");
  if (child == 0) {
    alarm(may_hang ? kBriefPatienceSeconds : kPatienceSeconds);  // which ends the child by a signal if it hangs
    work();
    std::exit(0);  // NOLINT(concurrency-mt-unsafe): static objects are to be destroyed
  }
  int status = 0;
  const bool ended = waitpid(child, &status, 0) == child;
  if (ended && may_hang && WIFSIGNALED(status) && WTERMSIG(status) == SIGALRM) return false;
  const bool exited = ended && WIFEXITED(status);
  require(exited && (WEXITSTATUS(status) == 0 || WEXITSTATUS(status) == kBusy),
          "the fork hung, crashed or found something wrong");
  return WEXITSTATUS(status) == 0;
}

[[noreturn]] void exit_as_busy() { std::_Exit(kBusy); }

void in_fork(const std::function<void()>& work) { require(succeeds_in_fork(work), "the fork's parent was busy"); }

int wait_for_stop(const welkin::Control& control) {
  while (!control.stop.stop_requested()) std::this_thread::sleep_for(std::chrono::milliseconds(1));
  return 1;
}

void make_worker() { worker = std::make_unique<welkin::Worker>(welkin::WorkerOptions{.threads = 2, .max_jobs = 3}); }

void use_in_fork(std::optional<welkin::Job<int>>& running, const welkin::Job<int>& done) {
  require_stopped("post", [] { (void)worker->post([](const welkin::Control&) { return 1; }); });
  require_stopped("get", [&] { (void)std::move(*running).get(); });
  require_stopped("drain", [] { (void)worker->drain(); });
  require_stopped("load", [] { (void)worker->load(); });
  require_stopped("wait_until_idle", [] { worker->wait_until_idle(); });
  require(!running->cancel(), "cancel");
  require(done.ready(), "a job that was done is not any more");
  running.reset();
  worker->terminate();
}

void fork_with_worker() {
  make_worker();
  const welkin::Job<int> done = worker->post([](const welkin::Control&) { return 1; });
  worker->wait_until_idle();
  std::optional<welkin::Job<int>> running = worker->post(wait_for_stop);
  (void)worker->post(wait_for_stop);
  in_fork([&] { require_stopped("post", [] { (void)worker->post([](const welkin::Control&) { return 1; }); }); });
  in_fork([&] { use_in_fork(running, done); });
  // At its limits, where a post takes the mutex.
  (void)worker->post(wait_for_stop);
  in_fork([&] {
    require_stopped("post at the limits", [] { (void)worker->post([](const welkin::Control&) { return 1; }); });
  });
  require(running->cancel(), "the parent's worker does not go on");
  worker.reset();
}

void own_worker() {
  make_worker();
  const auto answer = [](const welkin::Control&) { return 42; };
  require(worker->post(answer).get() == 42, "the worker does not work");
  worker->wait_until_idle();
  // By now its threads normally sleep, and oneTBB's list of sleepers leads to their stacks.
  std::this_thread::sleep_for(std::chrono::milliseconds(100));
  in_fork([] {
    require_stopped("a worker of a fork whose parent has an idle one", make_worker);
    std::_Exit(0);
  });
  worker.reset();
  // oneTBB's own threads rest a moment later, on a busy machine much later: such a fork may hang in oneTBB.
  constexpr int kTrials = 20;
  const auto work_in_fork = [&] {
    try {
      make_worker();
    } catch (const welkin::Error& error) {
      require(error.code() == welkin::ErrorCode::stopped, error.what());
      exit_as_busy();
    }
    require(worker->post(answer).get() == 42, "the fork's worker does not work");
  };
  bool works = false;
  for (int trial = 0; trial < kTrials && !works; ++trial) {
    std::this_thread::sleep_for(std::chrono::milliseconds(100));
    works = succeeds_in_fork(work_in_fork, true);
  }
  require(works, "no fork of a process whose worker is gone can make one");
}

void own_worker_of_busy_process() {
  make_worker();
  const welkin::Job<int> running = worker->post(wait_for_stop);
  while (worker->load().running == 0) std::this_thread::yield();
  in_fork([] {
    (void)worker.release();  // the parent's: its threads are not here
    require_stopped("a worker of a fork whose parent's was at work", make_worker);
    require_stopped("and once more", make_worker);
    std::_Exit(0);
  });
  require(running.cancel(), "the parent's worker does not go on");
  worker.reset();
}

/// Allocates all but so much of the address space, in blocks.
std::vector<std::unique_ptr<char[]>> take_all_but(std::size_t mebibytes) {
  constexpr std::size_t kMebibyte = std::size_t{1} << 20U;
  constexpr std::size_t kMax = 4096;
  std::vector<std::unique_ptr<char[]>> blocks;
  blocks.reserve(kMax);
  try {
    while (blocks.size() < kMax) blocks.emplace_back(new char[kMebibyte]);
  } catch (const std::bad_alloc&) {
    blocks.resize(blocks.size() - std::min(blocks.size(), mebibytes));
    return blocks;
  }
  fail("the address space is not limited");
}

void without_threads(std::size_t mebibytes) {
  const std::vector<std::unique_ptr<char[]>> taken = take_all_but(mebibytes);
  try {
    make_worker();
    require(worker->post([](const welkin::Control&) { return 42; }).get() == 42, "the worker does not work");
  } catch (const std::bad_alloc&) {
  } catch (const std::system_error&) {  // what the header says; not oneTBB's own error, which can end the process
  } catch (const std::exception& error) {
    fail(error.what());
  }
  worker.reset();
}

}  // namespace

int main(int count, char** arguments) {
  const char* const part = count >= 2 ? arguments[1] : "";
  if (std::strcmp(part, "fork") == 0) {
    fork_with_worker();
  } else if (std::strcmp(part, "own") == 0) {
    own_worker();
  } else if (std::strcmp(part, "busy") == 0) {
    own_worker_of_busy_process();
  } else if (std::strcmp(part, "no_threads") == 0 && count == 3) {
    without_threads(std::strtoul(arguments[2], nullptr, 10));
  } else {
    fail("usage: unlucky_worker fork|own|busy|no_threads MEBIBYTES");
  }
  return 0;
}
