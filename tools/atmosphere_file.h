// An atmosphere as JSON: what --print-atmosphere writes and --atmosphere reads.
#pragma once

#include <filesystem>
#include <string>

#include "tools/json_text.h"
#include "welkin/atmosphere.h"

namespace welkin::tool {

/// Every member, with every digit: read again it is the same atmosphere.
[[nodiscard]] Json atmosphere_json(const Atmosphere& atmosphere);

/// What is missing is as in a default `Atmosphere`. Throws `Error`: file_access, limit_exceeded (more than a megabyte),
/// corrupt_file for what is no JSON, for a member of another name or kind than those that `atmosphere_json` writes, and
/// for an atmosphere that cannot be computed.
[[nodiscard]] Atmosphere read_atmosphere(const std::filesystem::path& path);

/// The phase function's word.
[[nodiscard]] const char* name(AerosolPhase phase) noexcept;

}  // namespace welkin::tool
