#include "support/recorded_results.h"

#include "places.h"
#include "support/catch.h"
#include "support/trials.h"
#include "welkin/core.h"

namespace welkin::test {
namespace {

constexpr const char* kFile = WELKIN_TEST_DATA "/same_as_before.txt";

using Lines = std::map<std::string, std::string>;  ///< hashes by full name

bool recording() { return std::getenv("WELKIN_RECORD_GOLDEN") != nullptr; }

Lines read_lines() {
  Lines lines;
  std::ifstream in(kFile);
  for (std::string name, hash; in >> name >> hash;) lines[name] = hash;
  return lines;
}

bool is_in_group(const std::string& full_name, const std::string& group) {
  return full_name.size() > group.size() && full_name[group.size()] == '/' && full_name.starts_with(group);
}

std::string digits(std::uint64_t hash) {
  char text[17];
  std::snprintf(text, sizeof text, "%016llx", static_cast<unsigned long long>(hash));
  return text;
}

/// Restores the instruction set that was active before.
class KeptInstructionSet {
 public:
  KeptInstructionSet() = default;
  ~KeptInstructionSet() { force_instruction_set(before_); }
  KeptInstructionSet(const KeptInstructionSet&) = delete;
  KeptInstructionSet& operator=(const KeptInstructionSet&) = delete;

 private:
  InstructionSet before_ = active_instruction_set();
};

/// Computes the result in the other ways that must give the same bits, and fails by name where one does not.
void check_everywhere(const std::string& full_name, const NamedResult& result, const std::string& expected) {
  const std::vector<InstructionSet> sets = available_instruction_sets();
  std::vector<std::pair<InstructionSet, int>> ways{{sets.front(), 1}, {sets.back(), 5}};
  // With memory filled with NaN only reads matter: 2 threads show no fewer of them than all or 5.
  if (std::getenv("WELKIN_TEST_FILL_MEMORY") == nullptr) ways.emplace_back(sets.back(), 2);
  const KeptInstructionSet kept;
  for (const auto& [set, threads] : ways) {
    force_instruction_set(set);
    std::string found;
    run_with_threads(threads, [&] { found = digits(result.hash()); });
    if (found != expected) {
      FAIL_CHECK(full_name << " has other bits on " << name(set) << " with " << threads << " threads: " << found
                           << " instead of " << expected);
    }
  }
}

void write_group(const std::string& group, const Lines& found) {
  Lines lines = read_lines();
  std::erase_if(lines, [&](const auto& line) { return is_in_group(line.first, group); });
  lines.insert(found.begin(), found.end());
  std::ofstream out(kFile);
  for (const auto& [full_name, hash] : lines) out << full_name << ' ' << hash << '\n';
  REQUIRE(out.flush());
}

}  // namespace

bool is_on_record(const std::string& group) {
  if (recording()) return true;
  for (const auto& line : read_lines()) {
    if (is_in_group(line.first, group)) return true;
  }
  return false;
}

void require_as_recorded(const std::string& group, const std::vector<NamedResult>& results) {
  const Lines lines = read_lines();
  Lines found;
  for (const NamedResult& result : results) {
    std::string full_name = group;
    full_name += '/';
    full_name += result.name;
    REQUIRE(full_name.find(' ') == std::string::npos);
    REQUIRE_FALSE(found.contains(full_name));
    try {
      found[full_name] = digits(result.hash());
      if (result.repeats == Repeats::everywhere && !kSanitized) {
        check_everywhere(full_name, result, found[full_name]);
      }
    } catch (const std::exception& error) {
      FAIL_CHECK(full_name << " threw: " << error.what());
      continue;
    }
    if (recording()) continue;
    const auto line = lines.find(full_name);
    if (line == lines.end()) {
      FAIL_CHECK(full_name << " is not on record");
    } else if (line->second != found[full_name]) {
      FAIL_CHECK(full_name << " has changed: " << found[full_name] << " instead of " << line->second);
    }
  }
  if (recording()) {
    write_group(group, found);
    return;
  }
  for (const auto& line : lines) {
    if (is_in_group(line.first, group) && !found.contains(line.first)) {
      FAIL_CHECK(line.first << " is on record, but nothing computes it any more");
    }
  }
  CHECK(found.size() == results.size());
}

}  // namespace welkin::test
