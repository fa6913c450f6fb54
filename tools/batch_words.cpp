#include "tools/batch_words.h"

#include <algorithm>
#include <array>
#include <set>
#include <string_view>
#include <variant>

namespace welkin::tool {
namespace {

const Option* option_named(const Options& table, const std::string& word) {
  const std::string name = word.substr(0, word.find('='));
  const auto found = std::ranges::find_if(table, [&](const Option& option) {
    return (',' + option.names + ',').find(',' + name + ',') != std::string::npos;
  });
  return name.starts_with("-") && found != table.end() ? &*found : nullptr;
}

/// How many of the words behind an option are its values.
std::size_t values_of(const Option& option, const std::vector<std::string>& words, std::size_t at) {
  const bool is_flag = std::holds_alternative<bool*>(option.target) || std::holds_alternative<OnFlag>(option.target);
  if (is_flag || words[at].find('=') != std::string::npos) return 0;
  if (option.list != List::commas_or_spaces) return 1;
  std::size_t values = 1;
  while (at + 1 + values < words.size() && static_cast<int>(values) < option.count &&
         number_in(words[at + 1 + values])) {
    ++values;
  }
  return values;
}

/// An option of the table with its values, or a word that is none.
struct Group {
  const Option* option = nullptr;
  std::vector<std::string> words;
};

std::vector<Group> groups_in(const std::vector<std::string>& words, const Options& table) {
  std::vector<Group> groups;
  for (std::size_t at = 0; at < words.size();) {
    Group group{option_named(table, words[at]), {}};
    const std::size_t values = group.option != nullptr ? values_of(*group.option, words, at) : 0;
    const std::size_t end = std::min(words.size(), at + 1 + values);
    for (; at < end; ++at) group.words.push_back(words[at]);
    groups.push_back(group);
  }
  return groups;
}

}  // namespace

Options job_options(BakeCommandOptions& bake) {
  constexpr std::array<std::string_view, 9> kOthers = {
      "INPUT", "--sky", "-o,--output", "--json", "--threads", "--cache", "--memory-limit", "--explain", "--plan-only"};
  Options table;
  add_bake_options(table, bake);
  std::erase_if(table, [&](const Option& option) { return std::ranges::find(kOthers, option.names) != kOthers.end(); });
  for (Option& option : table) std::erase(option.needs, "INPUT");
  return table;
}

std::vector<std::string> words_for_jobs(const std::vector<std::string>& words) {
  BakeCommandOptions unused;
  const Options table = job_options(unused);
  std::vector<std::string> kept;
  for (const Group& group : groups_in(words, table)) {
    if (group.words.front() == "--") break;  // inputs alone follow
    if (group.option != nullptr) kept.insert(kept.end(), group.words.begin(), group.words.end());
  }
  return kept;
}

std::vector<std::string> with_own(const std::vector<std::string>& all, const std::vector<std::string>& own) {
  BakeCommandOptions unused;
  const Options table = job_options(unused);
  std::set<const Option*> named;
  for (const Group& group : groups_in(own, table)) named.insert(group.option);
  std::vector<std::string> joined;
  for (const Group& group : groups_in(all, table)) {
    if (!named.contains(group.option)) joined.insert(joined.end(), group.words.begin(), group.words.end());
  }
  joined.insert(joined.end(), own.begin(), own.end());
  return joined;
}

}  // namespace welkin::tool
