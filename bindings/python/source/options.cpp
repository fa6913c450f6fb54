#include "options.h"

#include <algorithm>

namespace welkin::python {

std::string suggestion(const std::string& found, const std::vector<const char*>& names) {
  py::list words;
  for (const char* const name : names) words.append(name);
  const py::list near = py::module_::import("difflib").attr("get_close_matches")(found, words, 1, 0.7);
  return near.empty() ? "" : " (did you mean \"" + near[0].cast<std::string>() + "\"?)";
}

void throw_unknown_name(const std::string& what, const std::string& found, const std::vector<const char*>& names) {
  std::string list;
  for (const char* const name : names) list += (list.empty() ? "\"" : ", \"") + std::string(name) + '"';
  throw Error(ErrorCode::invalid_argument, what + ": \"" + found + "\" is none of " + list + suggestion(found, names));
}

py::handle Options::take(const char* name) {
  known_.push_back(name);
  if (given_.empty()) return {};
  const py::handle found = PyDict_GetItemString(given_.ptr(), name);
  return found && !found.is_none() ? found : py::handle();
}

bool Options::has(const char* name) const {
  return !given_.empty() && PyDict_GetItemString(given_.ptr(), name) != nullptr;
}

std::optional<py::dict> Options::group(const char* name, bool by_default) {
  const bool given = has(name);
  const py::handle value = take(name);
  if (!given) return by_default ? std::optional<py::dict>(py::dict()) : std::nullopt;
  if (!value || value.is(py::handle(Py_False))) return std::nullopt;
  if (value.is(py::handle(Py_True))) return py::dict();
  if (!py::isinstance<py::dict>(value)) throw_wrong_type(name, value, "True, False or a dictionary of options");
  return py::reinterpret_borrow<py::dict>(value);
}

std::string Options::called(const char* name) const {
  if (group_ == nullptr) return std::string(function_) + '(' + name + "=...)";
  return std::string(function_) + '(' + group_ + "={\"" + name + "\": ...})";
}

void Options::throw_wrong_type(const char* name, py::handle given, const char* taken) const {
  const auto found = py::repr(given).cast<std::string>();
  if (*taken == '\0') throw py::type_error(called(name) + " does not take " + found);
  throw py::type_error(called(name) + " takes " + taken + ", found " + found);
}

void Options::finish() const {
  for (const auto& [key, value] : given_) {
    const auto name = key.cast<std::string>();
    const auto is_name = [&](const char* known) { return name == known; };
    if (std::any_of(known_.begin(), known_.end(), is_name)) continue;
    std::vector<const char*> sorted = known_;
    std::sort(sorted.begin(), sorted.end(),
              [](const char* a, const char* b) { return std::string_view(a) < std::string_view(b); });
    const auto same = [](const char* a, const char* b) { return std::string_view(a) == std::string_view(b); };
    sorted.erase(std::unique(sorted.begin(), sorted.end(), same), sorted.end());
    std::string list;
    for (const char* const known : sorted) list += (list.empty() ? "" : ", ") + std::string(known);
    std::string words = function_;
    words += group_ == nullptr ? "() takes no argument \"" : '(' + std::string(group_) + "={...}) takes no \"";
    words.append(name).append("\"").append(suggestion(name, known_)).append("; it takes ").append(list);
    throw py::type_error(words);
  }
}

}  // namespace welkin::python
