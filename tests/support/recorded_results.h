// Recorded hashes of results: the code must still give the bits that it gave when they were recorded.
#pragma once

#include "support/bit_hash.h"
#include "support/catch.h"

namespace welkin::test {

/// How often a result is computed.
enum class Repeats {
  everywhere,  ///< also on the narrowest instruction set with one thread, and on the widest with 2 and 5: fast ones
  once,        ///< with the current instruction set and arena
};

/// A result's name, which has no spaces, and the function that computes it. The function returns anything that
/// `add_bits` takes, or the hash itself as `bits_of` gives it.
struct NamedResult {
  template <std::invocable Function>
  NamedResult(std::string result_name, Function function, Repeats result_repeats = Repeats::everywhere)
      : name(std::move(result_name)), repeats(result_repeats) {
    hash = [function = std::move(function)] {
      if constexpr (std::same_as<std::invoke_result_t<const Function&>, std::uint64_t>) {
        return function();
      } else {
        return bits_of(function());
      }
    };
  }

  std::string name;
  std::function<std::uint64_t()> hash;
  Repeats repeats;
};

/// Returns a result's name from words and numbers.
template <class... Parts>
[[nodiscard]] std::string joined(const Parts&... parts) {
  std::ostringstream text;
  (text << ... << parts);
  return text.str();
}

/// Checks the hash of each result against its line `group/name hash` in tests/data/same_as_before.txt, and that the
/// group has no other lines there; each mismatch is a failure that names the result. With the environment variable
/// WELKIN_RECORD_GOLDEN set, writes the group's lines instead, for a change that alters bits and documents why. (Record
/// in one process: every group rewrites the file.)
void require_as_recorded(const std::string& group, const std::vector<NamedResult>& results);

/// Whether any line of the group is recorded, or this run records.
[[nodiscard]] bool is_on_record(const std::string& group);

}  // namespace welkin::test
