// Files that benchmarks read, written when first asked for.
#pragma once

#include <filesystem>
#include <functional>
#include <string>

namespace welkin::perf {

/// The file of that name in a folder of this run's own, made by `write(path)` if it is not there. The folder is gone
/// when the program ends.
[[nodiscard]] std::filesystem::path scratch_file(const std::string& name,
                                                 const std::function<void(const std::filesystem::path&)>& write);

}  // namespace welkin::perf
