// Parts of the standard library that public headers need and some implementations lack: libc++ has no <stop_token>
// before version 18 and no <memory_resource> before version 16. Where available, these are the library's own types, so
// that a host's `std::stop_token` can be passed directly; otherwise they are the equivalents below, with the same
// members.
#pragma once

#include <atomic>
#include <condition_variable>
#include <cstddef>
#include <memory>
#include <mutex>
#include <new>
#include <thread>
#include <type_traits>
#include <utility>
#include <version>

#ifdef __cpp_lib_jthread
#include <stop_token>
#endif
#ifdef __cpp_lib_memory_resource
#include <memory_resource>
#endif

namespace welkin::detail::standard {

// ---- Equivalent of <stop_token>

/// Tag for a source without state.
struct nostopstate_t {
  explicit nostopstate_t() = default;
};
inline constexpr nostopstate_t nostopstate{};

/// One callback in a state's list.
class StopCallbackNode {
 public:
  StopCallbackNode() = default;
  virtual ~StopCallbackNode() = default;
  StopCallbackNode(const StopCallbackNode&) = delete;
  StopCallbackNode& operator=(const StopCallbackNode&) = delete;

 private:
  friend class StopState;
  virtual void call() noexcept = 0;

  StopCallbackNode* before_ = nullptr;
  StopCallbackNode* after_ = nullptr;
  bool listed_ = false;
};

/// State shared by sources, tokens and callbacks.
class StopState {
 public:
  [[nodiscard]] bool requested() const noexcept { return requested_.load(std::memory_order_acquire); }
  [[nodiscard]] bool possible() const noexcept { return requested() || sources_.load() > 0; }
  void add_source() noexcept { ++sources_; }
  void remove_source() noexcept { --sources_; }

  /// Requests stop and calls the callbacks. Returns true for the first request.
  bool request() {
    std::unique_lock lock(mutex_);
    if (requested_.exchange(true, std::memory_order_acq_rel)) return false;
    caller_ = std::this_thread::get_id();
    while (first_ != nullptr) {
      StopCallbackNode* const node = first_;
      unlist(*node);
      running_ = node;
      lock.unlock();
      node->call();  // which may destroy the node
      lock.lock();
      running_ = nullptr;
      returned_.notify_all();
    }
    return true;
  }

  /// Adds a callback. Returns false if stop was requested; the caller must then call the node at once.
  [[nodiscard]] bool add(StopCallbackNode& node) {
    const std::scoped_lock lock(mutex_);
    if (requested()) return false;
    node.after_ = first_;
    if (first_ != nullptr) first_->before_ = &node;
    first_ = &node;
    node.listed_ = true;
    return true;
  }

  /// Removes a callback, and waits for a call in progress on another thread.
  void remove(StopCallbackNode& node) {
    std::unique_lock lock(mutex_);
    if (node.listed_) {
      unlist(node);
    } else if (running_ == &node && caller_ != std::this_thread::get_id()) {
      returned_.wait(lock, [&] { return running_ != &node; });
    }
  }

 private:
  void unlist(StopCallbackNode& node) noexcept {
    (node.before_ == nullptr ? first_ : node.before_->after_) = node.after_;
    if (node.after_ != nullptr) node.after_->before_ = node.before_;
    node.before_ = nullptr;
    node.after_ = nullptr;
    node.listed_ = false;
  }

  std::atomic<bool> requested_{false};
  std::atomic<int> sources_{0};
  std::mutex mutex_;
  std::condition_variable returned_;
  StopCallbackNode* first_ = nullptr;
  StopCallbackNode* running_ = nullptr;  ///< compared, never dereferenced
  std::thread::id caller_;               ///< thread that runs the callbacks
};

/// Equivalent of std::stop_token.
class stop_token {
 public:
  stop_token() noexcept = default;

  [[nodiscard]] bool stop_requested() const noexcept { return state_ && state_->requested(); }
  [[nodiscard]] bool stop_possible() const noexcept { return state_ && state_->possible(); }
  void swap(stop_token& other) noexcept { state_.swap(other.state_); }
  friend bool operator==(const stop_token&, const stop_token&) noexcept = default;

 private:
  friend class stop_source;
  template <class Callback>
  friend class stop_callback;
  explicit stop_token(std::shared_ptr<StopState> state) noexcept : state_(std::move(state)) {}

  std::shared_ptr<StopState> state_;
};

/// Equivalent of std::stop_source.
class stop_source {
 public:
  stop_source() : state_(std::make_shared<StopState>()) { state_->add_source(); }
  explicit stop_source(nostopstate_t /*none*/) noexcept {}
  stop_source(const stop_source& other) noexcept : state_(other.state_) {
    if (state_) state_->add_source();
  }
  stop_source(stop_source&& other) noexcept = default;
  stop_source& operator=(stop_source other) noexcept {
    swap(other);
    return *this;
  }
  ~stop_source() {
    if (state_) state_->remove_source();
  }

  bool request_stop() const { return state_ && state_->request(); }
  [[nodiscard]] stop_token get_token() const noexcept { return stop_token(state_); }
  [[nodiscard]] bool stop_requested() const noexcept { return state_ && state_->requested(); }
  [[nodiscard]] bool stop_possible() const noexcept { return state_ != nullptr; }
  void swap(stop_source& other) noexcept { state_.swap(other.state_); }
  friend bool operator==(const stop_source&, const stop_source&) noexcept = default;

 private:
  std::shared_ptr<StopState> state_;
};

/// Equivalent of std::stop_callback.
template <class Callback>
class stop_callback final : private StopCallbackNode {
 public:
  using callback_type = Callback;

  template <class Initial>
  explicit stop_callback(stop_token token, Initial&& callback)
      : callback_(std::forward<Initial>(callback)), state_(std::move(token.state_)) {
    if (!state_ || state_->add(*this)) return;
    state_.reset();
    callback_();
  }
  ~stop_callback() override {
    if (state_) state_->remove(*this);
  }
  stop_callback(const stop_callback&) = delete;
  stop_callback& operator=(const stop_callback&) = delete;

 private:
  void call() noexcept override { callback_(); }

  Callback callback_;
  std::shared_ptr<StopState> state_;
};

template <class Callback>
stop_callback(stop_token, Callback) -> stop_callback<Callback>;

// ---- Equivalent of <memory_resource>

/// Equivalent of std::pmr::memory_resource.
class memory_resource {
 public:
  memory_resource() = default;
  memory_resource(const memory_resource&) = default;
  memory_resource& operator=(const memory_resource&) = default;
  virtual ~memory_resource() = default;

  [[nodiscard]] void* allocate(std::size_t bytes, std::size_t alignment = alignof(std::max_align_t)) {
    return do_allocate(bytes, alignment);
  }
  void deallocate(void* block, std::size_t bytes, std::size_t alignment = alignof(std::max_align_t)) {
    do_deallocate(block, bytes, alignment);
  }
  [[nodiscard]] bool is_equal(const memory_resource& other) const noexcept { return do_is_equal(other); }

 private:
  virtual void* do_allocate(std::size_t bytes, std::size_t alignment) = 0;
  virtual void do_deallocate(void* block, std::size_t bytes, std::size_t alignment) = 0;
  [[nodiscard]] virtual bool do_is_equal(const memory_resource& other) const noexcept = 0;
};

inline bool operator==(const memory_resource& a, const memory_resource& b) noexcept {
  return &a == &b || a.is_equal(b);
}

/// Resource that allocates from the heap.
class HeapResource final : public memory_resource {
  void* do_allocate(std::size_t bytes, std::size_t alignment) override {
    return ::operator new (bytes, std::align_val_t{alignment});
  }
  void do_deallocate(void* block, std::size_t /*bytes*/, std::size_t alignment) override {
    ::operator delete (block, std::align_val_t{alignment});
  }
  [[nodiscard]] bool do_is_equal(const memory_resource& other) const noexcept override { return this == &other; }
};

[[nodiscard]] inline memory_resource* new_delete_resource() noexcept {
  // Never destroyed, because global objects may still free memory at exit.
  static auto& heap = *new HeapResource;  // NOLINT(bugprone-unhandled-exception-at-new): no memory at the start
  return &heap;
}

/// Returns the heap resource, the only default.
[[nodiscard]] inline memory_resource* get_default_resource() noexcept { return new_delete_resource(); }

}  // namespace welkin::detail::standard

namespace welkin {
// MinGW-w64: std::stop_callback may hang when it is destroyed as it is called.
#if defined(__cpp_lib_jthread) && !defined(__MINGW32__)
using std::nostopstate;
using std::stop_callback;
using std::stop_source;
using std::stop_token;
#else
using detail::standard::nostopstate;
using detail::standard::stop_callback;
using detail::standard::stop_source;
using detail::standard::stop_token;
#endif

#ifdef __cpp_lib_memory_resource
using std::pmr::get_default_resource;
using std::pmr::memory_resource;
using std::pmr::new_delete_resource;
#else
using detail::standard::get_default_resource;
using detail::standard::memory_resource;
using detail::standard::new_delete_resource;
#endif

}  // namespace welkin
