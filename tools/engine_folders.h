// What `--for ENGINE` writes: the files that the engine loads as they are, and the lines of code that load them.
#pragma once

#include <string>
#include <vector>

#include "tools/output_files.h"
#include "welkin/engines.h"

namespace welkin::tool {

inline constexpr const char* kReadmeName = "README.md";

/// Whether files are known that the engine loads as they are. (Not of Welkin itself and of OpenEXR, which is none.)
[[nodiscard]] bool has_folder(Engine engine) noexcept;

/// Those files, without what else the options ask for. Of an engine that `has_folder`.
[[nodiscard]] std::vector<OutputFile> files_for(Engine engine);

/// Whether what loads those files takes .ktx2 files of every texel format. Of an engine that `has_folder`.
[[nodiscard]] bool takes_any_texture(Engine engine) noexcept;

/// The text of README.md: for each file that was written how the engine loads it, and how that is known. `written`: the
/// names in the folder; lines that would name another file are left out.
[[nodiscard]] std::string readme_text(Engine engine, const std::vector<std::string>& written);

/// Whether a README.md that begins like this is one of ours, which may be written over.
[[nodiscard]] bool is_own_readme(const std::string& first_line) noexcept;

/// A stage with a dome light, whose texture lies beside it.
[[nodiscard]] std::string usd_stage(const std::string& lat_long);

/// Nine lines of three numbers, as Filament's cmgen writes them into its .ktx files.
[[nodiscard]] std::string filament_harmonics(const SphericalHarmonics& radiance);

}  // namespace welkin::tool
