// The files that the words on a command line stand for: themselves, pictures in folders, patterns.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace welkin::tool {

/// Whether the name has the ending of a file that Welkin reads as an environment.
[[nodiscard]] bool is_picture_name(const std::filesystem::path& path);

/// All pictures below the folder, in the order of their paths. Folders and files whose names begin with a dot are left
/// out, and so are folders with a manifest of a bake: those pictures were made by Welkin. Throws `Error` (file_access).
[[nodiscard]] std::vector<std::filesystem::path> pictures_below(const std::filesystem::path& folder);

/// Whether the text has one of the signs of a pattern.
[[nodiscard]] bool is_pattern(const std::string& text) noexcept;

/// Whether a name fits a pattern: `*` stands for any characters, `?` for one.
[[nodiscard]] bool fits(const std::string& name, const std::string& pattern) noexcept;

/// The files that fit, in the order of their paths: pictures where the last part is a pattern. `**` as a folder stands
/// for any number of folders, none too, but for those that a bake has made. A name with a dot in front fits only a
/// pattern with one. Throws `Error` (file_access).
[[nodiscard]] std::vector<std::filesystem::path> files_that_fit(const std::string& pattern);

}  // namespace welkin::tool
