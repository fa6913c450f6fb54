#include "welkin/instruction_set.h"

#include <algorithm>
#include <string>

#include "simd/kernels.h"
#include "support/catch.h"
#include "support/thrown_error.h"

namespace welkin::test {

TEST_CASE("Available instruction sets start with the baseline and are ordered", "[simd]") {
  const auto sets = available_instruction_sets();
  REQUIRE(sets.front() == InstructionSet::sse2);
  CHECK(std::is_sorted(sets.begin(), sets.end()));
}

TEST_CASE("A forced instruction set is the one that runs", "[simd]") {
  const InstructionSet before = active_instruction_set();
  for (const InstructionSet set : available_instruction_sets()) {
    force_instruction_set(set);
    CHECK(active_instruction_set() == set);
    CHECK(&simd::active_kernels() == &simd::kernels(set));
  }
  force_instruction_set(before);
  // Three tables of different functions, not three names for one.
  for (const InstructionSet a : available_instruction_sets()) {
    for (const InstructionSet b : available_instruction_sets()) {
      if (a != b) CHECK(simd::kernels(a).weighted_sums != simd::kernels(b).weighted_sums);
    }
  }
}

TEST_CASE("Instruction sets have the names that WELKIN_ISA takes", "[simd]") {
  CHECK(std::string(name(InstructionSet::sse2)) == "sse2");
  CHECK(std::string(name(InstructionSet::avx2)) == "avx2");
  CHECK(std::string(name(InstructionSet::avx512)) == "avx512");
}

}  // namespace welkin::test
