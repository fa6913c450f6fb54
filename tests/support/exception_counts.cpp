// Lets the thread sanitizer see who is the last to hold an exception.
//
// libstdc++ counts the holders of an exception, which futures hand from thread to thread, with atomic operations inside
// its own library, where the sanitizer does not look: the last one, who frees it, then seems to race with those who
// read it before. Here the two places where a count falls take a lock that the sanitizer does see. So it need not be
// told to ignore anything.
#if defined(__SANITIZE_THREAD__)

#include <dlfcn.h>

#include <exception>
#include <mutex>

namespace {

std::recursive_mutex& counts_mutex() {
  static std::recursive_mutex mutex;
  return mutex;
}

template <class Function>
Function libstdcxx(const char* name) {
  return reinterpret_cast<Function>(dlsym(RTLD_NEXT, name));
}

}  // namespace

extern "C" void __cxa_end_catch() {
  static const auto end_catch = libstdcxx<void (*)()>("__cxa_end_catch");
  const std::lock_guard lock(counts_mutex());
  end_catch();
}

namespace std::__exception_ptr {

void exception_ptr::_M_release() noexcept {
  static const auto release =
      libstdcxx<void (*)(exception_ptr*)>("_ZNSt15__exception_ptr13exception_ptr10_M_releaseEv");
  const lock_guard lock(counts_mutex());
  release(this);
}

}  // namespace std::__exception_ptr

#endif
