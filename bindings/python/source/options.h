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

class Options {
 public:
  /// `function`: for messages. `given` must outlive this.
  Options(const char* function, const py::dict& given) : function_(function), given_(given) {}

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
      throw_wrong_type(name, given);
    }
  }

  /// The same for what has names.
  template <class Value, std::size_t Count>
  void read(const char* name, Value& value, const Named<Value> (&table)[Count]) {
    std::string given;
    read(name, given);
    if (!given.empty()) value = value_of<Value>(called(name), given, table);
  }

  /// The options in a dictionary of its own: `True` for the defaults, `False` for none at all. Absent: `by_default`.
  /// Nothing where there are none.
  [[nodiscard]] std::optional<py::dict> group(const char* name, bool by_default);

  /// Throws TypeError for an argument that nobody took.
  void finish() const;

  [[nodiscard]] const char* function() const noexcept { return function_; }

  /// "prefilter(size=...)"
  [[nodiscard]] std::string called(const char* name) const;

 private:
  [[noreturn]] void throw_wrong_type(const char* name, py::handle given) const;

  const char* function_;
  const py::dict& given_;
  std::vector<const char*> known_;
};

}  // namespace welkin::python
