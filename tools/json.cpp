#include "tools/json.h"

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <fstream>
#include <limits>
#include <nlohmann/json.hpp>
#include <system_error>

#include "platform/file.h"
#include "platform/text.h"
#include "welkin/core.h"

namespace welkin::tool {
namespace {

using Library = nlohmann::ordered_json;

}  // namespace

/// Converts between Welkin's values and the library's.
struct JsonAccess {
  static Library to_library(const Json& json) {
    return std::visit([](const auto& value) { return converted(value); }, json.value_);
  }

 private:
  static Library converted(std::monostate /*null*/) { return nullptr; }
  template <class Value>
  static Library converted(const Value& value) {
    return value;
  }
  static Library converted(const Json::List& list) {
    Library result = Library::array();
    for (const Json& element : list) result.push_back(to_library(element));
    return result;
  }
  static Library converted(const Json::Members& members) {
    Library result = Library::object();
    for (const auto& [name, value] : members) result[name] = to_library(value);
    return result;
  }
};

namespace {

Json from_library(const Library& value) {
  switch (value.type()) {
    case Library::value_t::boolean: return value.get<bool>();
    case Library::value_t::number_integer: return value.get<std::int64_t>();
    case Library::value_t::number_unsigned: return value.get<std::uint64_t>();
    case Library::value_t::number_float: return value.get<double>();
    case Library::value_t::string: return value.get<std::string>();
    case Library::value_t::array: {
      Json list = Json::array();
      for (const Library& element : value) list.push_back(from_library(element));
      return list;
    }
    case Library::value_t::object: {
      Json object = Json::object();
      for (const auto& [name, member] : value.items()) object[name] = from_library(member);
      return object;
    }
    default: return nullptr;
  }
}

constexpr int kDeepestNesting = 8;  // valid files have 5

Flaw unknown_member(const std::string& where, const std::string& key, const std::string& known) {
  return {where + " has a member \"" + key + "\"; it can have " + known};
}

std::string text_of(const std::filesystem::path& path, const std::string& hint, std::uintmax_t most, Pipes pipes) {
  const auto fail = [&](ErrorCode code, const std::string& what) {
    throw Error(code, platform::utf8(path) + ": " + what);
  };
  const auto reason = [] { return std::string(errno != 0 ? std::strerror(errno) : "unknown reason"); };
  std::error_code unknown;
  const std::filesystem::file_status status = std::filesystem::status(path, unknown);
  const bool is_readable =
      std::filesystem::is_regular_file(status) || (pipes == Pipes::read && std::filesystem::is_fifo(status));
  if (std::filesystem::exists(status) && !is_readable) {
    const char* const found = std::filesystem::is_directory(status) ? "is a directory; " : "is not a regular file; ";
    fail(ErrorCode::file_access, found + hint);
  }
  errno = 0;
  std::ifstream stream(path, std::ios::binary);
  if (!stream) fail(ErrorCode::file_access, "cannot be read (" + reason() + "); " + hint);
  constexpr std::size_t kBlock = std::size_t{1} << 14U;  // valid files have a few kilobytes
  std::string text;
  while (stream) {
    const std::size_t before = text.size();
    text.resize(before + kBlock);
    errno = 0;
    stream.read(text.data() + before, static_cast<std::streamsize>(kBlock));
    if (stream.bad()) fail(ErrorCode::file_access, "cannot be read (" + reason() + "); " + hint);
    text.resize(before + static_cast<std::size_t>(stream.gcount()));
    if (text.size() <= most) continue;
    fail(ErrorCode::limit_exceeded,
         "has more than " + (most == kMaxJsonBytes ? std::string("a megabyte; sound ones have some kilobytes")
                                                   : std::to_string(most) + " bytes, which no sound one has"));
  }
  return text;
}

std::string member_text(const Json& value) {
  if (!value.is_array() || value.elements().empty() || value.elements().front().is_number()) return value.one_line();
  std::string text;
  for (const Json& element : value.elements()) {
    text += text.empty() ? "[\n    " : ",\n    ";
    text += element.one_line();
  }
  return text + ']';
}

bool is_member(const Json& value) {
  return value.is_array() && value.size() == 2 && value.elements().front().is_text();
}

}  // namespace

Json::Json() = default;
Json::Json(std::nullptr_t) {}
Json::Json(bool value) : value_(value) {}
Json::Json(double value) : value_(value) {}
Json::Json(const char* text) : value_(std::string(text)) {}
Json::Json(std::string text) : value_(std::move(text)) {}
Json::Json(Signed whole) : value_(whole.value) {}
Json::Json(Unsigned whole) : value_(whole.value) {}
Json::Json(const Json& other) = default;
Json::Json(Json&& other) noexcept = default;
Json& Json::operator=(const Json& other) = default;
Json& Json::operator=(Json&& other) noexcept = default;
Json::~Json() = default;

void Json::push_back(Json element) { std::get<List>(value_).push_back(std::move(element)); }

Json& Json::back() { return std::get<List>(value_).back(); }

Json::Json(std::initializer_list<Json> values) {
  if (!std::all_of(values.begin(), values.end(), is_member)) {
    value_ = List(values);
    return;
  }
  Members& members = value_.emplace<Members>();
  for (const Json& pair : values) members.emplace_back(pair.elements().front().text(), pair.elements().back());
}

Json Json::array(std::initializer_list<Json> values) {
  Json json;
  json.value_ = List(values);
  return json;
}

Json Json::object() {
  Json json;
  json.value_ = Members();
  return json;
}

bool Json::is_whole_number() const noexcept {
  return std::holds_alternative<std::int64_t>(value_) || std::holds_alternative<std::uint64_t>(value_);
}

double Json::number() const {
  if (const auto* whole = std::get_if<std::int64_t>(&value_)) return static_cast<double>(*whole);
  if (const auto* whole = std::get_if<std::uint64_t>(&value_)) return static_cast<double>(*whole);
  return std::get<double>(value_);
}

Json& Json::operator[](const std::string& name) {
  if (is_null()) value_ = Members();
  auto& members = std::get<Members>(value_);
  const auto found =
      std::find_if(members.begin(), members.end(), [&](const auto& member) { return member.first == name; });
  return found != members.end() ? found->second : members.emplace_back(name, Json()).second;
}

std::string Json::one_line() const {
  const Library value = JsonAccess::to_library(*this);
  std::string text = value.dump(-1, ' ', false, Library::error_handler_t::replace);
  // The text may go to a terminal, and JSON escapes only the first 32 control characters.
  if (platform::without_controls(text) == text) return text;
  return value.dump(-1, ' ', true, Library::error_handler_t::replace);
}

Json json_triple(const glm::dvec3& rgb) { return Json::array({rgb.x, rgb.y, rgb.z}); }

std::string json_text(const Json& object) {
  std::string text;
  for (const auto& [key, value] : object.members()) {
    text += text.empty() ? "{\n  " : ",\n  ";
    text += Json(key).one_line() + ": " + member_text(value);
  }
  return text + "\n}\n";
}

Json json_object(const std::vector<Member>& members) {
  Json object = Json::object();
  for (const Member& member : members) object[member.name] = member.written();
  return object;
}

void read_object(const Json& object, const std::string& where, const std::vector<Member>& members) {
  if (!object.is_object()) throw Flaw{where + " is not a JSON object"};
  for (const auto& [key, value] : object.members()) {
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
               const std::function<void(const Json& element, const std::string& where)>& read, std::size_t most) {
  if (!list.is_array()) throw Flaw{where + " is not a JSON array"};
  if (list.size() > most) throw Flaw{where + " has " + std::to_string(list.size()) + " elements"};
  for (std::size_t i = 0; i < list.size(); ++i) read(list.elements()[i], where + '[' + std::to_string(i) + ']');
}

Member number(const char* name, double& target) {
  const auto read = [&target](const Json& value, const std::string& where) {
    if (!value.is_number()) throw Flaw{where + " is not a number"};
    target = value.number();
  };
  return {name, read, [&target] { return target; }};
}

Member whole_number(const char* name, int& target) {
  const auto read = [&target](const Json& value, const std::string& where) {
    const bool whole = value.is_whole_number() && value.number() >= std::numeric_limits<int>::min() &&
                       value.number() <= std::numeric_limits<int>::max();
    if (!whole) throw Flaw{where + " is not an integer"};
    target = static_cast<int>(value.number());
  };
  return {name, read, [&target] { return target; }};
}

Member bytes(const char* name, std::uint64_t& target) {
  constexpr double kMost = 1e15;
  const auto read = [&target](const Json& value, const std::string& where) {
    if (!value.is_number() || !(value.number() >= 0.0 && value.number() <= kMost)) {
      throw Flaw{where + " is not a possible number of bytes"};
    }
    target = static_cast<std::uint64_t>(value.number());
  };
  return {name, read, [&target] { return target; }};
}

Member flag(const char* name, bool& target) {
  const auto read = [&target](const Json& value, const std::string& where) {
    if (!value.is_boolean()) throw Flaw{where + " is neither true nor false"};
    target = value.boolean();
  };
  return {name, read, [&target] { return target; }};
}

Member text(const char* name, std::string& target) {
  const auto read = [&target](const Json& value, const std::string& where) {
    if (!value.is_text()) throw Flaw{where + " is not a string"};
    target = value.text();
  };
  return {name, read, [&target] { return target; }};
}

Member numbers(const char* name, std::vector<double>& target) { return list(name, target, number); }

Member texts(const char* name, std::vector<std::string>& target) { return list(name, target, text); }

Json parse_json(const std::string& text) {
  const auto not_too_deep = [](int depth, Library::parse_event_t /*event*/, Library& /*value*/) {
    if (depth > kDeepestNesting) throw Flaw{"is nested too deeply"};
    return true;
  };
  try {
    return from_library(Library::parse(text, not_too_deep));
  } catch (const Library::exception& flaw) {
    throw Flaw{std::string("is not JSON (") + flaw.what() + ")"};
  }
}

Json read_json_file(const std::filesystem::path& path, const std::string& hint, std::uintmax_t most, Pipes pipes) {
  return parse_json(text_of(path, hint, most, pipes));
}

}  // namespace welkin::tool
