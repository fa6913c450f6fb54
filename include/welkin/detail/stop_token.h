// A request to stop, in the words of <stop_token>, for standard libraries without that header.
#pragma once

#include <atomic>
#include <condition_variable>
#include <memory>
#include <mutex>
#include <thread>
#include <type_traits>
#include <utility>

namespace welkin::detail::standard {

/// Makes a source that cannot stop anything.
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

/// What sources, tokens and callbacks share.
class StopState {
 public:
  [[nodiscard]] bool requested() const noexcept { return requested_.load(std::memory_order_acquire); }
  [[nodiscard]] bool possible() const noexcept { return requested() || sources_.load() > 0; }
  void add_source() noexcept { ++sources_; }
  void remove_source() noexcept { --sources_; }

  /// True for the first request, which calls the callbacks.
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

  /// False if stop was requested: the node is then to be called at once, by whoever adds it.
  [[nodiscard]] bool add(StopCallbackNode& node) {
    const std::scoped_lock lock(mutex_);
    if (requested()) return false;
    node.after_ = first_;
    if (first_ != nullptr) first_->before_ = &node;
    first_ = &node;
    node.listed_ = true;
    return true;
  }

  /// The node is not called any more; a call under way in another thread has returned.
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
  StopCallbackNode* running_ = nullptr;  ///< is compared, never followed
  std::thread::id caller_;               ///< of the callbacks
};

/// As std::stop_token.
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

/// As std::stop_source.
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

/// As std::stop_callback.
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

}  // namespace welkin::detail::standard
