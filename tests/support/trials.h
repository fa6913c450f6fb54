// The number of cases that a test takes from a large set: a fixed sample, more with WELKIN_RANDOM_TRIALS set
// (`scripts/test --all`), and fewer under a sanitizer.
#pragma once

#include "support/catch.h"

namespace welkin::test {

#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
inline constexpr bool kSanitized = true;
#else
inline constexpr bool kSanitized = false;
#endif

/// Whether the build checks for leaks.
#if defined(__SANITIZE_ADDRESS__)
inline constexpr bool kAddressSanitized = true;
#else
inline constexpr bool kAddressSanitized = false;
#endif

/// Returns the number of random cases: `usual`, a tenth of it under a sanitizer, or WELKIN_RANDOM_TRIALS times as many.
inline int trials(int usual) {
  if (const char* const factor = std::getenv("WELKIN_RANDOM_TRIALS")) return usual * std::max(1, std::atoi(factor));
  return kSanitized ? std::max(1, usual / 10) : usual;
}

/// Returns the step through a list of cases: `usual`, or 1 where WELKIN_RANDOM_TRIALS is set.
inline int stride(int usual) { return std::getenv("WELKIN_RANDOM_TRIALS") != nullptr ? 1 : usual; }

/// Returns every `usual`-th case, from the first on; all of them where WELKIN_RANDOM_TRIALS is set.
template <class Case>
std::vector<Case> some_of(int usual, std::initializer_list<Case> all) {
  std::vector<Case> some;
  for (std::size_t i = 0; i < all.size(); i += static_cast<std::size_t>(stride(usual))) some.push_back(all.begin()[i]);
  return some;
}

}  // namespace welkin::test
