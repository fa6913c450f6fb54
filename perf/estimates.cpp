#include <algorithm>
#include <cstdint>
#include <cstdio>
#include <cstdlib>

#include "benchmarks.h"
#include "support/estimate_trials.h"
#include "welkin/environment_file.h"
#include "welkin/resampling.h"

namespace welkin::perf {
namespace {

constexpr int kPictureSize = 64;
constexpr int kAtATime = 100;  ///< environments from table to table

Cubemap reduced(const std::filesystem::path& file) {
  const Environment environment = read_environment(file);
  return to_cubemap(environment.view(), kPictureSize);
}

std::string table_of(const test::EstimateTrials& trials) {
  std::string table =
      "| result | estimates | true <= estimate | median of estimate / true | worst true / estimate | worst case |\n"
      "|---|---|---|---|---|---|\n";
  for (const auto& [kind, honesty] : trials) {
    char row[160];
    std::snprintf(row, sizeof row, " | %zu | %.1f %% | %.2g | %.2g | ", honesty->count(), 100.0 * honesty->share(),
                  honesty->median(), honesty->worst());
    table += "| " + kind + row + honesty->worst_case() + " |\n";
  }
  return table;
}

}  // namespace

std::string estimate_table(const std::vector<std::filesystem::path>& arguments) {
  int count = 10'000;
  std::uint32_t seed = 1;
  test::RoughnessSpan of{0.02, 1.0};
  std::vector<Cubemap> pictures;
  for (const std::filesystem::path& argument : arguments) {
    const std::string word = argument.string();
    if (word.rfind("--seed=", 0) == 0) {
      seed = static_cast<std::uint32_t>(std::atoi(word.c_str() + 7));
    } else if (word.rfind("--rms-error=", 0) == 0) {
      of.rms_error = std::atof(word.c_str() + 12);
    } else if (!word.empty() && word.find_first_not_of("0123456789") == std::string::npos) {
      count = std::atoi(word.c_str());
    } else {
      pictures.push_back(reduced(argument));
    }
  }
  test::EstimateTrials trials;
  int refused = 0;
  for (int done = 0; done < count;) {
    const int some = std::min(kAtATime, count - done);
    const auto first = seed + static_cast<std::uint32_t>(done);
    test::add_estimate_trials(first, some / 2, of, pictures, trials);
    test::add_family_trials(first + static_cast<std::uint32_t>(some / 2), some - some / 2, of, true, trials);
    refused += test::add_lobe_trials(first, some / 2, pictures, trials);
    done += some;
    if (done < count) std::fprintf(stderr, "%d environments\n%s\n", done, table_of(trials).c_str());
  }
  return table_of(trials) + "\n" + std::to_string(refused) + " of " + std::to_string(count / 2) +
         " mips of other lobes than GGX were refused.\n";
}

}  // namespace welkin::perf
