// Promise: a result's estimate is at least its true error in 99 % of random environments, and at most six times too
// careful in the median. `welkin_perf --estimates` measures the same over as many environments as one likes.

#include "support/catch.h"
#include "support/estimate_trials.h"

namespace welkin::test {

TEST_CASE("True errors lie under their estimates", "[estimates][specular][projection]") {
  EstimateTrials trials;
  add_estimate_trials(100'000, 100, 0.08, {}, trials);
  CHECK(trials.size() >= 8);
  for (const auto& [kind, honesty] : trials) {
    CAPTURE(kind, honesty->count(), honesty->worst(), honesty->worst_case());
    const auto count = static_cast<double>(honesty->count());
    CHECK((1.0 - honesty->share()) * count <= 1.001 + 0.02 * count);  // 1 % is wanted: of so few, one or two
    CHECK(honesty->worst() < 3.0);
    CHECK(honesty->median() <= 6.5);  // 5 is wanted; 6.0 for mips of cubemaps
  }
}

}  // namespace welkin::test
