#include "perf.h"
#include "support/estimate_trials.h"
#include "welkin/environment_file.h"
#include "welkin/resampling.h"

namespace welkin::perf {
namespace {

constexpr int kPictureSize = 64;
constexpr int kAtATime = 100;  ///< environments from table to table

std::string table_of(const test::EstimateTrials& trials) {
  Table table(
      {"result", "estimates", "true <= estimate", "median of estimate / true", "worst true / estimate", "worst case"});
  for (const auto& [kind, honesty] : trials) {
    table.add({kind, std::to_string(honesty->count()), number("%.1f %%", 100.0 * honesty->share()),
               number("%.2g", honesty->median()), number("%.2g", honesty->worst()), honesty->worst_case()});
  }
  return table.text();
}

}  // namespace

std::string estimate_table(const Paths& words) {
  const Arguments arguments(words, {"--seed", "--rms-error"});
  const auto seed = static_cast<std::uint32_t>(arguments.count("--seed", 1));
  test::RoughnessSpan of{0.02, 1.0};
  of.rms_error = arguments.value("--rms-error", of.rms_error);
  int count = 10'000;
  std::vector<Cubemap> pictures;
  for (const std::filesystem::path& file : arguments.files) {
    const std::string word = file.string();
    if (word.find_first_not_of("0123456789") == std::string::npos) {
      count = std::atoi(word.c_str());
    } else {
      pictures.push_back(to_cubemap(read_environment(file).view(), kPictureSize));
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
