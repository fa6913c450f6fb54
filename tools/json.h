// JSON: values that the command prints, and objects read member by member, with the location of every flaw.
#pragma once

#include <concepts>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <glm/vec3.hpp>
#include <initializer_list>
#include <optional>
#include <string>
#include <utility>
#include <variant>
#include <vector>

namespace welkin::tool {

/// A value: null, true or false, a number, a text, a list, or an object, which keeps its members in the order of
/// insertion. In braces: {{"name", value}, ...} is an object, any other braces a list.
class Json {
 public:
  using List = std::vector<Json>;
  using Members = std::vector<std::pair<std::string, Json>>;

  // Constructors used in many places are defined in one source file, which saves compiling them many times.
  // NOLINTBEGIN(google-explicit-constructor): values stand for themselves in braces.
  Json();
  Json(std::nullptr_t);
  Json(bool value);
  Json(double value);
  Json(const char* text);
  Json(std::string text);
  template <std::signed_integral Whole>
  Json(Whole value) : Json(Signed{value}) {}
  template <std::unsigned_integral Whole>
  requires(!std::same_as<Whole, bool>) Json(Whole value) : Json(Unsigned{value}) {}
  template <class Value>
  Json(const std::vector<Value>& values) : Json(array()) {
    for (const Value& value : values) push_back(value);
  }
  /// Null without a value.
  template <class Value>
  Json(const std::optional<Value>& value) : Json(value ? Json(*value) : Json()) {}
  Json(std::initializer_list<Json> values);
  // NOLINTEND(google-explicit-constructor)
  Json(const Json& other);
  Json(Json&& other) noexcept;
  Json& operator=(const Json& other);
  Json& operator=(Json&& other) noexcept;
  ~Json();

  [[nodiscard]] static Json array(std::initializer_list<Json> values = {});
  [[nodiscard]] static Json object();

  [[nodiscard]] bool is_null() const noexcept { return std::holds_alternative<std::monostate>(value_); }
  [[nodiscard]] bool is_boolean() const noexcept { return std::holds_alternative<bool>(value_); }
  [[nodiscard]] bool is_whole_number() const noexcept;
  [[nodiscard]] bool is_number() const noexcept { return is_whole_number() || std::holds_alternative<double>(value_); }
  [[nodiscard]] bool is_text() const noexcept { return std::holds_alternative<std::string>(value_); }
  [[nodiscard]] bool is_array() const noexcept { return std::holds_alternative<List>(value_); }
  [[nodiscard]] bool is_object() const noexcept { return std::holds_alternative<Members>(value_); }

  // The value, which must be of that kind.
  [[nodiscard]] bool boolean() const { return std::get<bool>(value_); }
  [[nodiscard]] double number() const;  ///< also for a whole number
  [[nodiscard]] const std::string& text() const { return std::get<std::string>(value_); }
  [[nodiscard]] const List& elements() const { return std::get<List>(value_); }
  [[nodiscard]] const Members& members() const { return std::get<Members>(value_); }

  /// Returns the member of that name, which is added if it is missing; null becomes an object.
  Json& operator[](const std::string& name);
  void push_back(Json element);
  [[nodiscard]] Json& back();
  [[nodiscard]] std::size_t size() const { return elements().size(); }

  /// Returns the value in one line. Numbers have all digits of their exact value; text that is no UTF-8 (file names may
  /// be anything) is made valid.
  [[nodiscard]] std::string one_line() const;

 private:
  friend struct JsonAccess;
  struct Signed {
    std::int64_t value;
  };
  struct Unsigned {
    std::uint64_t value;
  };
  explicit Json(Signed whole);
  explicit Json(Unsigned whole);

  std::variant<std::monostate, bool, std::int64_t, std::uint64_t, double, std::string, List, Members> value_;
};

/// Returns the list of the results of `made` for each value.
template <class Values, class Made>
[[nodiscard]] Json json_list(const Values& values, const Made& made) {
  Json list = Json::array();
  for (const auto& value : values) list.push_back(made(value));
  return list;
}

/// Returns [r, g, b].
[[nodiscard]] Json json_triple(const glm::dvec3& rgb);

/// Returns one line per member of the object and per element of a member that is a list of anything but numbers, for
/// readers and diffs.
[[nodiscard]] std::string json_text(const Json& object);

/// A flaw of a file, whose name is added where it is known.
struct Flaw {
  std::string message;
};

/// A member that an object may have: `read` reads it, with `where` as its name in messages, and `written` writes it.
struct Member {
  const char* name;
  std::function<void(const Json& value, const std::string& where)> read;
  std::function<Json()> written{};  ///< none for a member that is only read
};

/// Returns the object of these members, none of which is only read.
[[nodiscard]] Json json_object(const std::vector<Member>& members);

/// Reads an object's members; missing ones stay unchanged. Throws `Flaw` for anything but an object and for a member of
/// another name, listing the known names.
void read_object(const Json& object, const std::string& where, const std::vector<Member>& members);

/// Maximum for most lists; callers judge whether so many elements are meaningful.
inline constexpr std::size_t kMaxElements = 4096;

/// Reads a list. Throws `Flaw`, also for more than `most` elements.
void read_list(const Json& list, const std::string& where,
               const std::function<void(const Json& element, const std::string& where)>& read,
               std::size_t most = kMaxElements);

// Members of a kind, which must not outlive their targets. Reading a value of another kind throws `Flaw`.
[[nodiscard]] Member number(const char* name, double& target);
[[nodiscard]] Member whole_number(const char* name, int& target);
[[nodiscard]] Member flag(const char* name, bool& target);
[[nodiscard]] Member text(const char* name, std::string& target);
/// A number of bytes, at most 1e15.
[[nodiscard]] Member bytes(const char* name, std::uint64_t& target);
/// Returns an object with these members of the target. Missing ones are those of a default target.
template <class Value>
[[nodiscard]] Member object(const char* name, Value& target, const std::vector<Member>& members) {
  const auto read = [&target, members](const Json& value, const std::string& where) {
    target = Value();
    read_object(value, where, members);
  };
  return {name, read, [members] { return json_object(members); }};
}
/// Returns a list whose elements are read and written as members of that kind.
template <class Value>
[[nodiscard]] Member list(const char* name, std::vector<Value>& target, Member (*kind)(const char*, Value&)) {
  const auto read = [&target, kind](const Json& value, const std::string& where) {
    target.clear();
    read_list(value, where,
              [&](const Json& element, const std::string& at) { kind("", target.emplace_back()).read(element, at); });
  };
  const auto written = [&target, kind] {
    Json values = Json::array();
    for (Value& value : target) values.push_back(kind("", value).written());
    return values;
  };
  return {name, read, written};
}
[[nodiscard]] Member numbers(const char* name, std::vector<double>& target);
[[nodiscard]] Member texts(const char* name, std::vector<std::string>& target);

/// Parses JSON that nests no deeper than 8. Throws `Flaw` for text that is no JSON.
[[nodiscard]] Json parse_json(const std::string& text);

inline constexpr std::uintmax_t kMaxJsonBytes = std::uintmax_t{1} << 20U;

/// Whether a file may be a pipe, which is read once. A person may name one; where others can put one, reading it would
/// block.
enum class Pipes { refused, read };

/// Reads and parses a regular file of at most `most` bytes that nests no deeper than 8. Throws `Error`: file_access
/// (`hint` says how to make the file), also for a device and a pipe that is refused, which are not opened;
/// limit_exceeded; `Flaw` for text that is no JSON.
[[nodiscard]] Json read_json_file(const std::filesystem::path& path, const std::string& hint,
                                  std::uintmax_t most = kMaxJsonBytes, Pipes pipes = Pipes::refused);

}  // namespace welkin::tool
