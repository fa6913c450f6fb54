// What a looser bound saves.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace welkin::perf {

/// `[--runs=N] LATLONG`: a table of warm processor milliseconds on one thread, by subject and `rms_error`, each the
/// least of N calls (20): default and short chains of cubemaps and of the lat-long itself, sheen, irradiance, and 64
/// probes of halves in one call.
[[nodiscard]] std::string bounds_table(const std::vector<std::filesystem::path>& arguments);

}  // namespace welkin::perf
