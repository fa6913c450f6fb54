#include "tools/json_members.h"

#include <cerrno>
#include <cstring>
#include <fstream>
#include <limits>
#include <system_error>

#include "welkin/error.h"

namespace welkin::tool {
namespace {

constexpr std::size_t kLongestText = std::size_t{1} << 20U;  // sound ones have some kilobytes
constexpr int kDeepestNesting = 8;                           // sound ones have 5
constexpr std::size_t kMostElements = 4096;                  // of a list; what sense they make, others know

Flaw unknown_member(const std::string& where, const std::string& key, const std::string& known) {
  return {where + " has a member \"" + key + "\"; it can have " + known};
}

std::string text_of(const std::filesystem::path& path, const std::string& hint) {
  std::error_code none;
  errno = 0;
  std::ifstream stream(path, std::ios::binary);
  if (!stream || std::filesystem::is_directory(path, none)) {
    throw Error(ErrorCode::file_access, path.string() + ": cannot be read (" +
                                            (errno != 0 ? std::strerror(errno) : "it is a directory") + "); " + hint);
  }
  std::string text(kLongestText + 1, '\0');
  stream.read(text.data(), static_cast<std::streamsize>(text.size()));
  text.resize(static_cast<std::size_t>(stream.gcount()));
  if (text.size() > kLongestText) {
    throw Error(ErrorCode::limit_exceeded,
                path.string() + ": has more than a megabyte; sound ones have some kilobytes");
  }
  return text;
}

Json parsed(const std::string& text) {
  const auto not_too_deep = [](int depth, Json::parse_event_t /*event*/, Json& /*value*/) {
    if (depth > kDeepestNesting) throw Flaw{"nests deeper than a sound one does"};
    return true;
  };
  try {
    return Json::parse(text, not_too_deep);
  } catch (const Json::exception& flaw) {
    throw Flaw{std::string("is no JSON (") + flaw.what() + ")"};
  }
}

}  // namespace

void read_object(const Json& object, const std::string& where, const std::vector<Member>& members) {
  if (!object.is_object()) throw Flaw{where + " is no object in braces"};
  for (const auto& [key, value] : object.items()) {
    const Member* found = nullptr;
    std::string known;
    for (const Member& member : members) {
      if (!known.empty()) known += ", ";
      known += member.name;
      if (key == member.name) found = &member;
    }
    if (found == nullptr) throw unknown_member(where, key, known);
    found->read(value, std::string(where).append(".").append(key));
  }
}

void read_list(const Json& list, const std::string& where,
               const std::function<void(const Json& element, const std::string& where)>& read) {
  if (!list.is_array()) throw Flaw{where + " is no list in brackets"};
  if (list.size() > kMostElements) throw Flaw{where + " has " + std::to_string(list.size()) + " elements"};
  for (std::size_t i = 0; i < list.size(); ++i) read(list[i], where + '[' + std::to_string(i) + ']');
}

Member number(const char* name, double& target) {
  return {name, [&target](const Json& value, const std::string& where) {
            if (!value.is_number()) throw Flaw{where + " is no number"};
            target = value.get<double>();
          }};
}

Member numbers(const char* name, std::vector<double>& target) {
  return {name, [&target](const Json& value, const std::string& where) {
            target.clear();
            read_list(value, where, [&](const Json& element, const std::string& at) {
              if (!element.is_number()) throw Flaw{at + " is no number"};
              target.push_back(element.get<double>());
            });
          }};
}

Member text(const char* name, std::string& target) {
  return {name, [&target](const Json& value, const std::string& where) {
            if (!value.is_string()) throw Flaw{where + " is no text in quotes"};
            target = value.get<std::string>();
          }};
}

Member whole_number(const char* name, int& target) {
  return {name, [&target](const Json& value, const std::string& where) {
            const bool whole = value.is_number_integer() && value.get<double>() >= std::numeric_limits<int>::min() &&
                               value.get<double>() <= std::numeric_limits<int>::max();
            if (!whole) throw Flaw{where + " is no whole number"};
            target = value.get<int>();
          }};
}

Member flag(const char* name, bool& target) {
  return {name, [&target](const Json& value, const std::string& where) {
            if (!value.is_boolean()) throw Flaw{where + " is neither true nor false"};
            target = value.get<bool>();
          }};
}

Json read_json_file(const std::filesystem::path& path, const std::string& hint) { return parsed(text_of(path, hint)); }

}  // namespace welkin::tool
