// Promise: a result's estimate is at least its true error in 99 % of random environments, and at most five times too
// careful in the median. `welkin_perf --estimates` measures the same over as many environments as one likes.

#include "support/catch.h"
#include "support/estimate_trials.h"

namespace welkin::test {

TEST_CASE("True errors lie under their estimates", "[estimates][specular][projection][budget]") {
  EstimateTrials trials;
  add_estimate_trials(100'000, 300, 0.12, {}, trials);
  CHECK(trials.size() >= 12);
  for (const auto& [kind, honesty] : trials) {
    CAPTURE(kind, honesty->count(), honesty->worst(), honesty->worst_case());
    const auto count = static_cast<double>(honesty->count());
    CHECK((1.0 - honesty->share()) * count <= 1.001 + 0.02 * count);  // 1 % is wanted: of so few, one or two
    CHECK(honesty->worst() < 2.0);
    // The level that the error budget takes from a chain is judged more carefully than is wanted: docs/reflections.md.
    CHECK(honesty->median() <= (kind == "budget, level of a mip chain" ? 20.0 : 5.0));
  }
}

}  // namespace welkin::test
