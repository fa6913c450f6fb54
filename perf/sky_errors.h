#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace welkin::perf {

/// The tables of docs/sky.md, as Markdown: errors of precomputed skies against the truth in double. Options choose:
/// "--radiance" (single scattering by table size and sun), "--orders" (orders 2 to 4 as harmonics against path
/// tracing), "--methods" (ways to harmonics by sun and time); none: all. "--directions=N" (400), "--paths=N" (4000000),
/// "--altitude=METRES" (0).
[[nodiscard]] std::string sky_error_tables(const std::vector<std::filesystem::path>& options);

}  // namespace welkin::perf
