// Probes as `write_probes` wrote them.
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "platform/file.h"
#include "platform/float_environment.h"
#include "platform/text.h"
#include "probes/probe_arrays.h"
#include "welkin/bake_file.h"

namespace welkin {
namespace {

using Json = nlohmann::json;
using platform::ByteFile;
using platform::file_error;

constexpr std::uint64_t kLongestText = std::uint64_t{1} << 20U;
constexpr int kDeepestNesting = 8;
constexpr double kLargestExact = 9007199254740992.0;  // 2^53

/// The description and the name that messages give it.
class Description {
 public:
  explicit Description(const FileInput& input) : path_(input.path()) {
    ByteFile file(input.path(), input.bytes());
    if (file.size() > kLongestText) {
      throw file_error(ErrorCode::limit_exceeded, path_,
                       "has " + std::to_string(file.size()) +
                           " bytes, more than a description of probes has; pass the file that write_probes was given");
    }
    std::string text(static_cast<std::size_t>(file.size()), '\0');
    file.read(text.data(), text.size());
    const auto not_too_deep = [](int depth, Json::parse_event_t /*event*/, Json& /*parsed*/) {
      return depth < kDeepestNesting;
    };
    json_ = Json::parse(text, not_too_deep, false);
    if (!json_.is_object() || json_.value("format", Json()) != "welkin probes") {
      throw file_error(ErrorCode::unsupported_file, path_, "is no description of probes; write one by write_probes");
    }
    if (json_.value("version", Json()) != 1) {
      throw file_error(ErrorCode::unsupported_file, path_, "has a version that this library does not read; update it");
    }
  }

  [[noreturn]] void refuse(const std::string& message) const {
    throw file_error(ErrorCode::corrupt_file, path_, message);
  }

  [[nodiscard]] const Json& at(const Json& object, const char* key) const {
    const auto found = object.is_object() ? object.find(key) : object.end();
    if (!object.is_object() || found == object.end()) refuse(std::string("has no \"") + key + "\"");
    return *found;
  }
  [[nodiscard]] const Json& at(const char* key) const { return at(json_, key); }

  [[nodiscard]] double number(const Json& value, const char* key) const {
    if (!value.is_number()) refuse(std::string("has a \"") + key + "\" that is not a number");
    return value.get<double>();
  }
  /// From 0 to 2^53.
  [[nodiscard]] std::uint64_t whole(const Json& value, const char* key) const {
    const double found = number(value, key);
    if (!(found >= 0.0 && found <= kLargestExact) || found != std::floor(found)) {
      refuse(std::string("has a \"") + key + "\" that is not a whole number");
    }
    return static_cast<std::uint64_t>(found);
  }
  /// That many, at most.
  [[nodiscard]] int small(const char* key, int most) const {
    const std::uint64_t found = whole(at(key), key);
    if (found > static_cast<std::uint64_t>(most)) {
      refuse(std::string("has ") + std::to_string(found) + " as its \"" + key + "\"; it can be " +
             std::to_string(most) + " at most");
    }
    return static_cast<int>(found);
  }
  [[nodiscard]] const Json& three(const Json& object, const char* key) const {
    const Json& value = at(object, key);
    if (!value.is_array() || value.size() != 3) refuse(std::string("has a \"") + key + "\" that is not three numbers");
    return value;
  }
  [[nodiscard]] const std::string& text(const Json& object, const char* key) const {
    const Json& value = at(object, key);
    if (!value.is_string()) refuse(std::string("has a \"") + key + "\" that is not text");
    return value.get_ref<const std::string&>();
  }

  [[nodiscard]] ProbeGrid grid() const {
    const Json& described = at("grid");
    ProbeGrid grid;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const std::uint64_t count = whole(three(described, "counts")[axis], "counts");
      grid.counts[axis] = count > 0xffff ? 0xffff : static_cast<int>(count);  // the check refuses either
      grid.origin[static_cast<int>(axis)] = number(three(described, "origin")[axis], "origin");
      grid.spacing[static_cast<int>(axis)] = number(three(described, "spacing")[axis], "spacing");
    }
    try {
      probes::check_grid(grid);
    } catch (const Error& error) {
      refuse(std::string("has a grid that cannot be: ") + error.what());
    }
    return grid;
  }

  /// The entry of an array; nothing if there is none of that name.
  [[nodiscard]] const Json* entry(const char* name) const {
    const Json& entries = at(at("arrays"), "entries");
    if (!entries.is_array()) refuse("has \"entries\" that are no list");
    for (const Json& each : entries) {
      if (text(each, "name") == name) return &each;
    }
    return nullptr;
  }

 private:
  std::filesystem::path path_;
  Json json_;
};

/// Reads the arrays, of which each must have the size that grid, bands and sizes give it.
class Arrays {
 public:
  Arrays(const Description& description, const FileInput& file)
      : description_(description), file_(file.path(), file.bytes()) {}

  template <class Value>
  void read(const char* name, const char* type, std::size_t count, std::vector<Value>& values, bool optional = false) {
    const Json* entry = description_.entry(name);
    if (entry == nullptr) {
      if (optional) return;
      description_.refuse(std::string("names no array \"") + name + "\"");
    }
    const std::string called = std::string("its array \"") + name + "\" ";
    if (description_.text(*entry, "type") != type) description_.refuse(called + "is not of type " + type);
    const std::uint64_t bytes = description_.whole(description_.at(*entry, "bytes"), "bytes");
    if (bytes != std::uint64_t{count} * sizeof(Value)) {
      description_.refuse(called + "has " + std::to_string(bytes) + " bytes; the grid and its sizes need " +
                          std::to_string(std::uint64_t{count} * sizeof(Value)));
    }
    const std::uint64_t offset = description_.whole(description_.at(*entry, "offset"), "offset");
    if (offset > file_.size() || bytes > file_.size() - offset) {  // before memory is taken
      throw file_error(ErrorCode::corrupt_file, file_.path(),
                       "has " + std::to_string(file_.size()) + " bytes and ends before " + called + "does");
    }
    values.resize(count);
    file_.seek(offset);
    if (bytes > 0) file_.read(values.data(), static_cast<std::size_t>(bytes));
  }

 private:
  const Description& description_;
  ByteFile file_;
};

FileInput arrays_of(const Description& description, const FileInput& input) {
  if (input.bytes()) {
    throw Error(ErrorCode::invalid_argument, "read_probes: the description is in memory; pass the file of arrays too");
  }
  const std::filesystem::path named = platform::path_of(description.text(description.at("arrays"), "file"));
  // A name beside the description, and no way to other files.
  if (named.empty() || named != named.filename() || named == "." || named == "..") {
    description.refuse("names a file of arrays in another folder");
  }
  return input.path().parent_path() / named;
}

}  // namespace

BakedProbes read_probes(const FileInput& input, const std::optional<FileInput>& arrays) {
  const platform::FloatingPointScope floating_point;
  const Description description(input);
  BakedProbes read;
  read.grid = description.grid();
  read.bands = description.small("bands", probes::kMaxBands);
  read.distance_size = description.small("distance_size", 64);
  read.distance_limit = description.number(description.at("distance_limit"), "distance_limit");
  read.sky_bands = description.small("sky_bands", kMaximumBands);
  if (read.bands == 0) description.refuse("has 0 as its \"bands\"; it must have 1 to 4");
  if (description.text(description.at("arrays"), "byte_order") != "little") {
    description.refuse("has a \"byte_order\" other than little");
  }
  const std::size_t count = read.grid.size();
  Arrays file(description, arrays ? *arrays : arrays_of(description, input));
  file.read("coefficients", "float64", count * probes::squared(read.bands), read.coefficients);
  file.read("validity", "float32", count, read.validity);
  file.read("passes", "uint8", count, read.passes);
  file.read("distances", "float32", count * probes::distance_floats(read), read.distances);
  file.read("sky", "float64", count * probes::squared(read.sky_bands), read.sky);
  file.read("offsets", "float64", count, read.offsets, true);
  for (const std::uint8_t pass : read.passes) {
    if (pass != 0) ++read.invalid;
    if (pass == probes::kUnfilled) ++read.unfilled;
  }
  return read;
}

}  // namespace welkin
