// The welkin::Error that a call throws.
#pragma once

#include "support/catch.h"
#include "welkin/core.h"

namespace welkin::test {

struct ThrownError {
  ErrorCode code{};
  std::string message;

  [[nodiscard]] bool says(const std::string& words) const { return message.find(words) != std::string::npos; }
};

/// Returns the error that the call throws. Fails the test if it throws nothing or something else.
template <typename Call>
ThrownError thrown_by(const Call& call) {
  try {
    call();
  } catch (const Error& error) {
    return {error.code(), error.what()};
  }
  FAIL("no error was thrown");
  return {};
}

/// Checks that the call throws an error of this code whose message contains all of these words.
template <typename Call>
void check_thrown(const Call& call, ErrorCode code, std::initializer_list<std::string> words = {}) {
  const ThrownError error = thrown_by(call);
  INFO(error.message);
  CHECK(error.code == code);
  for (const std::string& each : words) {
    INFO("is to say: " << each);
    CHECK(error.says(each));
  }
}

}  // namespace welkin::test
