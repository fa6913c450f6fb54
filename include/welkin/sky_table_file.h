// Files of a sky's tables, so that they are computed once.
#pragma once

#include <cstdint>
#include <filesystem>

#include "welkin/export.h"
#include "welkin/sky_tables.h"

namespace WELKIN_EXPORT welkin {

/// Writes tables with all their parameters and a checksum; read again they are the same bits. Written beside, renamed.
/// Throws `Error`: invalid_argument for tables whose sizes are not their options', file_access.
void save_sky_tables(const SkyTables& tables, const std::filesystem::path& path);
/// Throws `Error`: file_access, corrupt_file (a checksum that differs, a table cut off), unsupported_file (another
/// version), limit_exceeded.
[[nodiscard]] SkyTables load_sky_tables(const std::filesystem::path& path,
                                        std::uint64_t memory_limit_bytes = std::uint64_t{4} << 30U);

}  // namespace welkin
