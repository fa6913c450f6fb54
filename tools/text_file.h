// Small files of text.
#pragma once

#include <filesystem>
#include <string>

namespace welkin::tool {

/// Writes beside the file's place and renames: it is whole or as it was. Throws `Error` (file_access).
void write_text_file(const std::filesystem::path& path, const std::string& text);

}  // namespace welkin::tool
