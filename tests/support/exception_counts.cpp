// Lets the thread sanitizer see which thread holds an exception last.
//
// libstdc++ counts the holders of an exception, which futures pass between threads, with atomic operations inside its
// own library, which is not instrumented. The last holder, which frees the exception, then seems to race with the
// earlier readers. Here the two functions that decrement the count take a lock that the sanitizer does see, so that no
// suppression is needed.
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
