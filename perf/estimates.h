// How honest the estimates of errors are.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace welkin::perf {

/// `[COUNT] [--seed=N] [--rms-error=X] [PICTURE...]`: a table by kind of result, GGX mips within X (1e-3), over COUNT
/// random environments (10 000), of which a fifth are of the pictures if there are any. After each 500 the table so far
/// goes to standard error.
[[nodiscard]] std::string estimate_table(const std::vector<std::filesystem::path>& arguments);

}  // namespace welkin::perf
