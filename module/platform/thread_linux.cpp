#include <pthread.h>
#include <sched.h>
#include <sys/mman.h>
#include <sys/resource.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <csetjmp>
#include <cstdint>
#include <exception>
#include <new>
#include <vector>

#include "platform/thread.h"

namespace welkin::detail {

void name_current_thread(const char* name) noexcept { pthread_setname_np(pthread_self(), name); }

void rank_current_thread(ThreadPriority priority) noexcept {
  constexpr int kNicer = 10;
  constexpr int kNicest = 19;
  const sched_param none{};
  if (priority == ThreadPriority::normal) return;
  if (priority == ThreadPriority::idle && pthread_setschedparam(pthread_self(), SCHED_IDLE, &none) == 0) return;
  // A thread made by a real-time thread is real-time too, and has no nice value.
  static_cast<void>(pthread_setschedparam(pthread_self(), SCHED_OTHER, &none));
  // On Linux each thread has a nice value, at first its maker's; setpriority takes its number as a process's.
  const auto thread = static_cast<id_t>(::syscall(SYS_gettid));
  static_cast<void>(setpriority(PRIO_PROCESS, thread, std::min(kNicest, getpriority(PRIO_PROCESS, thread) + kNicer)));
}

namespace {

/// The point where a thread that `pthread_exit` unwinds continues. That is no C++ exception: only glibc's code at the
/// end of the stack may catch it for good, so a jump leads out past that code. By then all that was called from there
/// is unwound.
class WayBack {
 public:
  explicit WayBack(std::jmp_buf& target) noexcept : target_(target), exceptions_(std::uncaught_exceptions()) {}
  ~WayBack() {
    // NOLINTNEXTLINE(cert-err52-cpp,modernize-avoid-setjmp-longjmp): there is no other way
    if (!returned && std::uncaught_exceptions() == exceptions_) std::longjmp(target_, 1);
  }
  WayBack(const WayBack&) = delete;
  WayBack& operator=(const WayBack&) = delete;

  bool returned = false;

 private:
  std::jmp_buf& target_;
  int exceptions_;  ///< under way before the call
};

}  // namespace

bool returns_from(void (*function)(void* argument), void* argument) {
  std::jmp_buf target;
  // NOLINTNEXTLINE(cert-err52-cpp,modernize-avoid-setjmp-longjmp): see above
  if (setjmp(target) != 0) return false;
  WayBack way_back(target);
  function(argument);
  way_back.returned = true;
  return true;
}

AddressReserve::AddressReserve(std::size_t bytes) noexcept : bytes_(bytes) {
  void* const block = mmap(nullptr, bytes, PROT_NONE, MAP_PRIVATE | MAP_ANONYMOUS | MAP_NORESERVE, -1, 0);
  if (block != MAP_FAILED) block_ = block;
}

AddressReserve::~AddressReserve() {
  if (block_ != nullptr) munmap(block_, bytes_);
}

namespace {

/// Runs a thread of `can_make_threads`, which stays until all threads exist.
void* stay(void* over) {
  static_cast<std::atomic<bool>*>(over)->wait(false);
  return nullptr;
}

}  // namespace

bool can_make_threads(int count) noexcept {
  constexpr std::size_t kLargestStack = std::size_t{8} << 20U;  // oneTBB's have 4 MiB
  pthread_attr_t attributes;
  if (pthread_attr_init(&attributes) != 0) return false;
  std::size_t stack = 0;
  pthread_attr_getstacksize(&attributes, &stack);
  pthread_attr_setstacksize(&attributes, std::max(stack, kLargestStack));
  const std::size_t wanted = count > 0 ? static_cast<std::size_t>(count) : 0;
  std::atomic<bool> over{false};
  std::size_t made = 0;
  try {
    std::vector<pthread_t> threads(wanted);
    while (made < wanted && pthread_create(&threads[made], &attributes, stay, &over) == 0) ++made;
    over = true;
    over.notify_all();
    for (std::size_t i = 0; i < made; ++i) pthread_join(threads[i], nullptr);
  } catch (const std::bad_alloc&) {  // from the vector, before there are threads
  }
  pthread_attr_destroy(&attributes);
  return made == wanted;
}

}  // namespace welkin::detail
