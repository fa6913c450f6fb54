// Lines of a file that may be large, hostile or a pipe.
#pragma once

#include <cstddef>
#include <filesystem>
#include <functional>
#include <string>

namespace welkin::tool {

/// Calls `use` with each line, without its line feed, and with the line's number from 1. The file is a regular one or a
/// pipe. Throws `Error`: file_access for anything else, and if it cannot be read to its end; limit_exceeded for a line
/// of more than a megabyte, and for more than a gigabyte, both as soon as they are read; and what `use` throws.
void for_each_line(const std::filesystem::path& file,
                   const std::function<void(std::size_t number, const std::string& line)>& use);

}  // namespace welkin::tool
