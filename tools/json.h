// JSON: values as the command prints them, and objects read member by member, every flaw named by where it is.
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

/// A value: null, true or false, a number, a text, a list, or an object, which keeps its members in the order in which
/// they were added. In braces: {{"name", value}, ...} is an object, any other braces a list.
class Json {
 public:
  using List = std::vector<Json>;
  using Members = std::vector<std::pair<std::string, Json>>;

  // What is made or copied in many places is made in one: it is compiled once.
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
  /// Null where there is none.
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

  // What it holds; it must be of that kind.
  [[nodiscard]] bool boolean() const { return std::get<bool>(value_); }
  [[nodiscard]] double number() const;  ///< also of a whole number
  [[nodiscard]] const std::string& text() const { return std::get<std::string>(value_); }
  [[nodiscard]] const List& elements() const { return std::get<List>(value_); }
  [[nodiscard]] const Members& members() const { return std::get<Members>(value_); }

  /// The member of that name, which is added if it is not there; null becomes an object.
  Json& operator[](const std::string& name);
  void push_back(Json element);
  [[nodiscard]] Json& back();
  [[nodiscard]] std::size_t size() const { return elements().size(); }

  /// In one line. Numbers have as many digits as their exact value needs; text that is no UTF-8 (file names may be
  /// anything) is made valid.
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

/// The list of what `made` returns for each value.
template <class Values, class Made>
[[nodiscard]] Json json_list(const Values& values, const Made& made) {
  Json list = Json::array();
  for (const auto& value : values) list.push_back(made(value));
  return list;
}

/// [r, g, b]
[[nodiscard]] Json json_triple(const glm::dvec3& rgb);

/// One line per member of the object and per element of a member that is a list of anything but numbers, so that a
/// person and a diff find their way.
[[nodiscard]] std::string json_text(const Json& object);

/// What is wrong with a file; its name is put before it where it is known.
struct Flaw {
  std::string message;
};

/// A member that an object may have: what reads it, where `where` names it in messages, and what writes it.
struct Member {
  const char* name;
  std::function<void(const Json& value, const std::string& where)> read;
  std::function<Json()> written{};  ///< none of a member that is only read
};

/// The object of these members, none of which is only read.
[[nodiscard]] Json json_object(const std::vector<Member>& members);

/// Reads an object's members; what is missing is left as it is. Throws `Flaw` for what is no object and for a member of
/// another name, naming those that there are.
void read_object(const Json& object, const std::string& where, const std::vector<Member>& members);

/// Of most lists; what sense more elements would make, others know.
inline constexpr std::size_t kMaxElements = 4096;

/// Throws `Flaw`, also for more than `most` elements.
void read_list(const Json& list, const std::string& where,
               const std::function<void(const Json& element, const std::string& where)>& read,
               std::size_t most = kMaxElements);

// Members of a kind, which must not outlive their targets. What reads them throws `Flaw` for a value of another.
[[nodiscard]] Member number(const char* name, double& target);
[[nodiscard]] Member whole_number(const char* name, int& target);
[[nodiscard]] Member flag(const char* name, bool& target);
[[nodiscard]] Member text(const char* name, std::string& target);
/// A number of bytes, 1e15 at most.
[[nodiscard]] Member bytes(const char* name, std::uint64_t& target);
/// An object with these members of the target. What is missing is as in a default one.
template <class Value>
[[nodiscard]] Member object(const char* name, Value& target, const std::vector<Member>& members) {
  const auto read = [&target, members](const Json& value, const std::string& where) {
    target = Value();
    read_object(value, where, members);
  };
  return {name, read, [members] { return json_object(members); }};
}
/// A list, each element of which is read and written as a member of that kind.
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

/// Nests no deeper than 8. Throws `Flaw` for what is no JSON.
[[nodiscard]] Json parse_json(const std::string& text);

inline constexpr std::uintmax_t kMaxJsonBytes = std::uintmax_t{1} << 20U;

/// Whether a file may be a pipe, which is read once. A person may name one; where others can put one, reading it would
/// block.
enum class Pipes { refused, read };

/// Reads and parses a regular file of at most `most` bytes that nests no deeper than 8. Throws `Error`: file_access
/// (`hint` says how to come by one), also for a device and a pipe that is refused, which are not opened;
/// limit_exceeded; `Flaw` for what is no JSON.
[[nodiscard]] Json read_json_file(const std::filesystem::path& path, const std::string& hint,
                                  std::uintmax_t most = kMaxJsonBytes, Pipes pipes = Pipes::refused);

}  // namespace welkin::tool
