// What a scene's needs save: the table of docs/plans.md.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace welkin::perf {

/// Typical scenes baked whole and by a plan: processor time (the fastest of `--runs=N`, default 3) and
/// memory. With `--explain` the plans themselves, predicted and measured.
[[nodiscard]] std::string scene_table(const std::vector<std::filesystem::path>& arguments);

}  // namespace welkin::perf
