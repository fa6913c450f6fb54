#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace welkin::perf {

/// The tables of docs/reflections.md: for each lat-long of `files`, and each made-up one where an entry says
/// "--synthetic", the error and time of each method's mips against the integral in double, at `--texels=N` (256)
/// texels a mip, or all if there are fewer. "--size=N": texels along an edge of mip 0 (512). "--methods=A,B": which
/// (automatic).
[[nodiscard]] std::string prefilter_error_tables(const std::vector<std::filesystem::path>& files);

}  // namespace welkin::perf
