// The number of processors that control groups grant. Only Linux has control groups; elsewhere no such file is found.
#include <algorithm>
#include <charconv>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <optional>
#include <string>
#include <string_view>
#include <system_error>
#include <vector>

#include "platform/thread.h"

namespace welkin::detail {
namespace {

/// Splits a line into words; each character of `separators` ends one. Streams would parse numbers by the host's locale.
std::vector<std::string_view> split(std::string_view text, std::string_view separators) {
  std::vector<std::string_view> words;
  while (!text.empty()) {
    const std::size_t end = std::min(text.find_first_of(separators), text.size());
    words.push_back(text.substr(0, end));
    text.remove_prefix(std::min(end + 1, text.size()));
  }
  return words;
}

std::vector<std::string> lines_of(const std::filesystem::path& path) {
  std::ifstream file(path);
  std::vector<std::string> lines;
  for (std::string line; std::getline(file, line);) lines.push_back(line);
  return lines;
}

std::optional<std::int64_t> whole_number(std::string_view text) {
  std::int64_t value = 0;
  const auto [end, failure] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (failure != std::errc() || end != text.data() + text.size()) return std::nullopt;
  return value;
}

/// Returns ceil(quota / period), both in microseconds; 0 where there is no quota ("max", -1).
int processors_of(std::string_view quota, std::string_view period) {
  constexpr std::int64_t kMax = 1 << 20;
  const std::optional<std::int64_t> share = whole_number(quota);
  const std::optional<std::int64_t> whole = whole_number(period);
  if (!share || !whole || *share <= 0 || *whole <= 0) return 0;
  return static_cast<int>(std::min(kMax, (*share - 1) / *whole + 1));
}

/// Returns the processors that a single group's files grant; 0 if they set no quota.
int quota_of(const std::filesystem::path& group, bool version_2) {
  if (version_2) {
    const std::vector<std::string> lines = lines_of(group / "cpu.max");
    const auto words = lines.empty() ? std::vector<std::string_view>() : split(lines.front(), " ");
    return words.size() == 2 ? processors_of(words[0], words[1]) : 0;
  }
  const std::vector<std::string> quota = lines_of(group / "cpu.cfs_quota_us");
  const std::vector<std::string> period = lines_of(group / "cpu.cfs_period_us");
  return quota.empty() || period.empty() ? 0 : processors_of(quota.front(), period.front());
}

/// Returns the process's group in the hierarchy of version 2, or in that of version 1 that controls processors: the
/// third field of a line of /proc/self/cgroup, "0::/path" or "4:cpu,cpuacct:/path".
std::optional<std::string> own_group(const std::filesystem::path& root, bool version_2) {
  for (const std::string& line : lines_of(root / "proc/self/cgroup")) {
    const std::size_t first = line.find(':');
    const std::size_t second = first == std::string::npos ? first : line.find(':', first + 1);
    if (second == std::string::npos) continue;
    const std::vector<std::string_view> names =
        split(std::string_view(line).substr(first + 1, second - first - 1), ",");
    const bool right = version_2 ? names.empty() : std::find(names.begin(), names.end(), "cpu") != names.end();
    if (right) return line.substr(second + 1);
  }
  return std::nullopt;
}

struct Hierarchy {
  std::string top;  ///< the group that is mounted
  std::string mount_point;
};

/// Parses a line of /proc/self/mountinfo (proc(5)): number, parent, device, root, mount point, options, any number of
/// optional fields, a hyphen, type, source, options of the file system.
std::optional<Hierarchy> hierarchy_in(const std::string& line, bool version_2) {
  const std::vector<std::string_view> words = split(line, " ");
  const auto hyphen = std::find(words.begin(), words.end(), "-");
  if (words.size() < 6 || words.end() - hyphen < 4) return std::nullopt;
  const std::vector<std::string_view> controllers = split(hyphen[3], ",");
  const bool right = version_2 ? hyphen[1] == "cgroup2"
                               : hyphen[1] == "cgroup" &&
                                     std::find(controllers.begin(), controllers.end(), "cpu") != controllers.end();
  if (!right) return std::nullopt;
  return Hierarchy{std::string(words[3]), std::string(words[4])};
}

/// Returns the minimum quota in a hierarchy, from the process's group to the topmost mounted; 0 if there is none.
int quota_in(const std::filesystem::path& root, bool version_2) {
  const std::optional<std::string> group = own_group(root, version_2);
  if (!group) return 0;
  for (const std::string& line : lines_of(root / "proc/self/mountinfo")) {
    const std::optional<Hierarchy> hierarchy = hierarchy_in(line, version_2);
    if (!hierarchy) continue;
    // In a container the process's group is often itself the mounted one, and has another path outside.
    std::filesystem::path below = std::filesystem::path(*group).lexically_relative(hierarchy->top);
    if (below.empty() || *below.begin() == "..") below = ".";
    const std::filesystem::path top = root / std::filesystem::path(hierarchy->mount_point).relative_path();
    int minimum = 0;
    for (;; below = below.parent_path()) {
      const int quota = quota_of((top / below).lexically_normal(), version_2);
      if (quota > 0 && (minimum == 0 || quota < minimum)) minimum = quota;
      if (below.empty() || below == ".") return minimum;
    }
  }
  return 0;
}

}  // namespace

int quota_processors(const std::filesystem::path& root) {
  const int second = quota_in(root, true);
  const int first = quota_in(root, false);
  return first > 0 && second > 0 ? std::min(first, second) : std::max(first, second);
}

}  // namespace welkin::detail
