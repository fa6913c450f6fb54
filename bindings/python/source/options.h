// Keyword arguments: each is taken once by its name, and what nobody took is an error.
#pragma once

#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>
#include <pybind11/stl.h>

#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

#include "welkin/core.h"

namespace welkin::python {

namespace py = pybind11;

/// A value of an enumeration by the name that Python has for it.
template <class Value>
struct Named {
  const char* name;
  Value value;
};

/// Returns ` (did you mean "size"?)` for the nearest of the names, or nothing where none is near.
[[nodiscard]] std::string suggestion(const std::string& found, const std::vector<const char*>& names);

/// Throws `Error` (invalid_argument) that lists the names.
[[noreturn]] void throw_unknown_name(const std::string& what, const std::string& found,
                                     const std::vector<const char*>& names);

/// The value of a name. `what` is how messages call it.
template <class Value>
[[nodiscard]] Value value_of(const std::string& what, const std::string& found, std::span<const Named<Value>> table) {
  for (const Named<Value>& entry : table) {
    if (found == entry.name) return entry.value;
  }
  std::vector<const char*> names;
  for (const Named<Value>& entry : table) names.push_back(entry.name);
  throw_unknown_name(what, found, names);
}

/// The name of a value that is in the table.
template <class Value>
[[nodiscard]] const char* name_of(Value value, std::span<const Named<Value>> table) {
  for (const Named<Value>& entry : table) {
    if (value == entry.value) return entry.name;
  }
  return "unknown";
}

/// Returns what an option of this type takes, in words; nothing for types that only programs know.
template <class Value>
[[nodiscard]] constexpr const char* taken_words() {
  if constexpr (std::is_same_v<Value, bool>) return "True or False";
  if constexpr (std::is_integral_v<Value> && !std::is_same_v<Value, bool>) return "a whole number";
  if constexpr (std::is_floating_point_v<Value>) return "a number";
  if constexpr (std::is_same_v<Value, std::string>) return "text";
  if constexpr (std::is_same_v<Value, std::vector<double>>) return "a list of numbers";
  if constexpr (
      requires { typename Value::value_type; } && requires(Value value) { value.has_value(); }) {
    return taken_words<typename Value::value_type>();
  }
  return "";
}

class Options {
 public:
  /// `function` and `group`, the argument whose dictionary these are, are for messages. `given` must outlive this.
  Options(const char* function, const py::dict& given, const char* group = nullptr)
      : function_(function), group_(group), given_(given) {}

  /// The argument, or null; a null handle stands for `None` too.
  [[nodiscard]] py::handle take(const char* name);

  /// Whether the argument was given, `None` included. It still has to be taken.
  [[nodiscard]] bool has(const char* name) const;

  /// `value` keeps its default if the argument is absent or `None`.
  template <class Value>
  void read(const char* name, Value& value) {
    const py::handle given = take(name);
    if (!given) return;
    try {
      value = given.cast<Value>();
    } catch (const py::cast_error&) {
      throw_wrong_type(name, given, taken_words<Value>());
    }
  }

  /// The same for what has names.
  template <class Value, std::size_t Count>
  void read(const char* name, Value& value, const Named<Value> (&table)[Count]) {
    std::optional<std::string> given;
    read(name, given);
    if (given) value = value_of<Value>(called(name), *given, table);
  }

  /// The options in a dictionary of its own: `True` for the defaults, `False` for none at all. Absent: `by_default`.
  /// Nothing where there are none.
  [[nodiscard]] std::optional<py::dict> group(const char* name, bool by_default);

  /// Throws TypeError for an argument that nobody took.
  void finish() const;

  [[nodiscard]] const char* function() const noexcept { return function_; }

  /// "prefilter(size=...)", "bake(specular={"size": ...})"
  [[nodiscard]] std::string called(const char* name) const;

 private:
  [[noreturn]] void throw_wrong_type(const char* name, py::handle given, const char* taken) const;

  const char* function_;
  const char* group_;
  const py::dict& given_;
  std::vector<const char*> known_;
};

}  // namespace welkin::python
