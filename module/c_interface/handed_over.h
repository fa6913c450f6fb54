// What a caller hands over together with the function that frees it.
#pragma once

#include <memory>
#include <utility>

namespace welkin::c_interface {

/// Calls `release(user)` when it goes: once, wherever it was moved to.
class HandedOver {
 public:
  using Release = void (*)(void* user);

  HandedOver() = default;
  HandedOver(Release release, void* user) noexcept : release_(release), user_(user) {}
  ~HandedOver() {
    if (release_ == nullptr) return;
    try {
      release_(user_);
    } catch (...) {  // NOLINT(bugprone-empty-catch): it may not throw, and there is nobody who could be told
    }
  }
  HandedOver(HandedOver&& other) noexcept : release_(std::exchange(other.release_, nullptr)), user_(other.user_) {}
  HandedOver& operator=(HandedOver&& other) noexcept {
    std::swap(release_, other.release_);
    std::swap(user_, other.user_);
    return *this;
  }
  HandedOver(const HandedOver&) = delete;
  HandedOver& operator=(const HandedOver&) = delete;

  [[nodiscard]] bool empty() const noexcept { return release_ == nullptr; }

 private:
  Release release_ = nullptr;
  void* user_ = nullptr;
};

/// Null if nothing is handed over. An owner is equal to no other, also if both free the same thing: whoever compares
/// sources then takes no post's pixels for another's, and none is released while a run for its job reads them.
/// Throws std::bad_alloc; `handed_over` keeps what it has then.
[[nodiscard]] inline std::shared_ptr<const void> make_owner(HandedOver&& handed_over) {
  if (handed_over.empty()) return nullptr;
  return std::make_shared<HandedOver>(std::move(handed_over));
}

}  // namespace welkin::c_interface
