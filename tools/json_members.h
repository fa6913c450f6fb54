// JSON objects read member by member, every flaw named by where it is.
#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "tools/json_text.h"

namespace welkin::tool {

/// What is wrong; the file's name is put before it where it is known.
struct Flaw {
  std::string message;
};

/// A member that an object may have, and what reads it; `where` names it in messages.
struct Member {
  const char* name;
  std::function<void(const Json& value, const std::string& where)> read;
};

/// Reads an object's members; what is missing is left as it is. Throws `Flaw` for what is no object and for a member of
/// another name, naming those that there are.
void read_object(const Json& object, const std::string& where, const std::vector<Member>& members);

/// At most 4096 elements. Throws `Flaw`.
void read_list(const Json& list, const std::string& where,
               const std::function<void(const Json& element, const std::string& where)>& read);

// Members of a kind. What reads them throws `Flaw` for a value of another.
[[nodiscard]] Member number(const char* name, double& target);
[[nodiscard]] Member whole_number(const char* name, int& target);
[[nodiscard]] Member flag(const char* name, bool& target);
[[nodiscard]] Member numbers(const char* name, std::vector<double>& target);
[[nodiscard]] Member text(const char* name, std::string& target);

/// Reads and parses a file of at most a megabyte that nests no deeper than 8. Throws `Error`: file_access
/// (`hint` says how to come by one), limit_exceeded; `Flaw` for what is no JSON.
[[nodiscard]] Json read_json_file(const std::filesystem::path& path, const std::string& hint);

}  // namespace welkin::tool
