// Grids of probes from files of captures, and files with a description in JSON, written and read.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <functional>
#include <nlohmann/json.hpp>
#include <numeric>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "files/textures.h"
#include "files/write_environment.h"
#include "jobs/control.h"
#include "jobs/tiles.h"
#include "platform/file.h"
#include "platform/float_environment.h"
#include "platform/text.h"
#include "probes/probe_arrays.h"
#include "projection/tile_sums.h"
#include "welkin/bake_file.h"

namespace welkin {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::size_t kProbesTogether = 128;

// ---- From files

/// The captures of some probes, as floats.
class Captured {
 public:
  Captured(std::span<const FileInput> cubes, std::span<const FileInput> depths, const Control& control)
      : chains_(cubes.size()), distances_(depths.size()), cubes_(cubes.size()), depths_(depths.size()) {
    // Files have a few hundred KB; threads mostly wait for the disk.
    jobs::run_tiles(cubes.size(), jobs::Placement::arena, jobs::worker_count(jobs::Placement::arena), {control.stop},
                    [&](std::size_t k, std::size_t /*worker*/) {
                      const jobs::OneThread alone;
                      chains_[k] = read_texture(cubes[k]).cubemap;
                      cubes_[k] = chains_[k].view(0);
                      if (!depths.empty()) read_depth(depths[k], k);
                    });
  }

  [[nodiscard]] std::span<const CubemapView> cubes() const noexcept { return cubes_; }
  [[nodiscard]] std::span<const DepthView> depths() const noexcept { return depths_; }

 private:
  void read_depth(const FileInput& input, std::size_t k) {
    const CubemapTexture texture = read_texture(input);
    if (texture.format.find("32f") == std::string::npos) {
      throw platform::file_error(ErrorCode::unsupported_file, input.path(),
                                 "holds \"" + texture.format + "\"; distances are read from 32-bit floats");
    }
    const CubemapView view = texture.cubemap.view(0);
    const auto face = static_cast<std::size_t>(view.size) * static_cast<std::size_t>(view.size);
    distances_[k].resize(6 * face);
    depths_[k].size = view.size;
    for (std::size_t f = 0; f < 6; ++f) {
      float* to = distances_[k].data() + f * face;
      const auto* from = static_cast<const float*>(view.faces[f]);
      for (std::size_t texel = 0; texel < face; ++texel) to[texel] = from[3 * texel];
      depths_[k].faces[f] = to;
    }
  }

  std::vector<Cubemap> chains_;
  std::vector<std::vector<float>> distances_;
  std::vector<CubemapView> cubes_;
  std::vector<DepthView> depths_;
};

template <class Value>
void append(std::vector<Value>& to, const std::vector<Value>& from) {
  to.insert(to.end(), from.begin(), from.end());
}

void append(BakedProbes& to, const BakedProbes& part) {
  append(to.coefficients, part.coefficients);
  append(to.validity, part.validity);
  append(to.passes, part.passes);
  append(to.distances, part.distances);
  append(to.sky, part.sky);
  projection::add(to.diagnostics, part.diagnostics);
  to.bands = part.bands;
  to.distance_size = part.distance_size;
  to.distance_limit = part.distance_limit;
  to.sky_bands = part.sky_bands;
}

void require_files(const ProbeGrid& grid, std::span<const FileInput> cubes, std::span<const FileInput> depths) {
  if (cubes.size() == grid.size() && (depths.empty() || depths.size() == grid.size())) return;
  throw Error(ErrorCode::invalid_argument, "there are " + std::to_string(cubes.size()) + " files of cubemaps and " +
                                               std::to_string(depths.size()) + " of depths for " +
                                               std::to_string(grid.size()) + " probes; pass one per probe");
}

// ---- The file of arrays

using Shape = std::vector<std::size_t>;  ///< of an array's values, where a `dvec3` counts as one

/// One list for reading and writing: the arrays' names, types of numbers, values and shapes, in the file's order, and
/// whether a file may lack one. Probes: BakedProbes or const BakedProbes.
template <class Probes, class Use>
void for_each_array(Probes& probes, const Use& use) {
  const std::size_t count = probes.grid.size();
  const auto edge = static_cast<std::size_t>(probes.distance_edge());
  use("coefficients", "float64", probes.coefficients, Shape{count, probes::squared(probes.bands)}, false);
  use("validity", "float32", probes.validity, Shape{count}, false);
  use("passes", "uint8", probes.passes, Shape{count}, false);
  use("distances", "float32", probes.distances, Shape{count, edge, edge, 2}, false);
  use("sky", "float64", probes.sky, Shape{count, probes::squared(probes.sky_bands)}, false);
  use("offsets", "float64", probes.offsets, Shape{count}, true);
}

// ---- To files

Json append_arrays(std::vector<std::uint8_t>& bytes, const BakedProbes& probes) {
  Json entries = Json::array();
  for_each_array(probes, [&](const char* name, const char* type, const auto& values, Shape shape, bool optional) {
    if (optional && values.empty()) return;
    if (sizeof values.front() == sizeof(dvec3)) shape.push_back(3);
    const std::size_t offset = bytes.size();
    const std::span<const std::byte> raw = std::as_bytes(std::span(values));
    bytes.resize((offset + raw.size() + 7) / 8 * 8);
    if (!raw.empty()) std::memcpy(bytes.data() + offset, raw.data(), raw.size());
    entries.push_back({{"name", name}, {"type", type}, {"shape", shape}, {"offset", offset}, {"bytes", raw.size()}});
  });
  return entries;
}

Json three_numbers(const dvec3& numbers) { return {numbers.x, numbers.y, numbers.z}; }

Json description_of(const BakedProbes& probes) {
  return {{"format", "welkin probes"},
          {"version", 1},
          {"grid",
           {{"counts", probes.grid.counts},
            {"origin", three_numbers(probes.grid.origin)},
            {"spacing", three_numbers(probes.grid.spacing)},
            {"order", "probe = i + counts[0] * (j + counts[1] * k)"}}},
          {"bands", probes.bands},
          {"coefficients", "radiance, orthonormal real harmonics without Condon-Shortley phase, index l * (l + 1) + m"},
          {"distance_size", probes.distance_size},
          {"distance_limit", probes.distance_limit},
          {"sky_bands", probes.sky_bands},
          {"invalid", probes.invalid},
          {"unfilled", probes.unfilled}};
}

/// Returns the box that a grid's cells fill, half a cell around its outermost probes, as engines place a volume.
Json box_of(const ProbeGrid& grid) {
  const dvec3 counts(grid.counts[0], grid.counts[1], grid.counts[2]);
  return {{"centre", three_numbers(grid.origin + 0.5 * (counts - 1.0) * grid.spacing)},
          {"size", three_numbers(counts * grid.spacing)}};
}

/// Returns a scene of three.js, in the format of `Object3D.toJSON` and ObjectLoader: a group of LightProbes.
Json three_scene(const BakedProbes& probes, const std::string& texture) {
  const Json box = box_of(probes.grid);
  Json children = Json::array();
  const std::size_t functions = probes::squared(probes.bands);
  for (std::size_t probe = 0; probe < probes.grid.size(); ++probe) {
    Json numbers = Json::array();
    for (std::size_t k = 0; k < 9; ++k) {
      const dvec3 rgb = k < functions ? probes.coefficients[probe * functions + k] : dvec3(0.0);
      for (int c = 0; c < 3; ++c) numbers.push_back(rgb[c]);
    }
    const dvec3 at = probes.grid.position(probe) + (probes.offsets.empty() ? dvec3(0.0) : probes.offsets[probe]);
    children.push_back({{"type", "LightProbe"},
                        {"name", std::to_string(probe)},
                        {"layers", 1},
                        {"matrix", {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, at.x, at.y, at.z, 1}},
                        {"intensity", 1},
                        {"sh", std::move(numbers)}});
  }
  return {{"metadata", {{"version", 4.7}, {"type", "Object"}, {"generator", "Welkin"}}},
          {"object",
           {{"type", "Group"},
            {"name", "probes"},
            {"layers", 1},
            {"matrix", {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1}},
            {"userData",
             {{"counts", probes.grid.counts}, {"centre", box["centre"]}, {"size", box["size"]}, {"texture", texture}}},
            {"children", std::move(children)}}}};
}

void write_json(platform::WholeFile& file, const Json& json, int indent) {
  const std::string text = json.dump(indent, ' ', false, nlohmann::json::error_handler_t::replace) + "\n";
  file.write(text.data(), text.size());
}

Json write_layout(files::OutputFiles& output, const std::filesystem::path& path, const BakedProbes& probes,
                  ProbeLayout layout, std::uint64_t& clamped) {
  const PackedProbes packed = pack_probes(probes, layout);
  clamped += packed.values_clamped;
  Json textures = Json::array();
  for (const ProbeTexture& texture : packed.textures) {
    const std::string ending = packed.textures.size() == 1 ? "" : "_" + texture.name;
    const std::filesystem::path file = files::beside(path, std::string("_") + name(layout) + ending + ".ktx2");
    files::write_ktx2_volume(output.add(file), {texture.size, texture.halves, texture.is_array},
                             {{"welkin.probes", std::string(name(layout)) + " " + texture.name}});
    textures.push_back({{"name", texture.name},
                        {"file", platform::utf8(file.filename())},
                        {"format", "rgba16f"},
                        {"size", texture.size}});
    if (texture.is_array) textures.back()["array"] = true;
  }
  Json described{{"layout", name(layout)}};
  if (layout == ProbeLayout::unity_l1 || layout == ProbeLayout::unity_l2) described["bricks"] = packed.bricks;
  if (layout == ProbeLayout::three) {
    const std::filesystem::path file = files::beside(path, "_three.json");
    write_json(output.add(file), three_scene(probes, textures[0]["file"]), -1);
    described["scene"] = platform::utf8(file.filename());
  }
  if (layout == ProbeLayout::bevy || layout == ProbeLayout::rtxgi) described["box"] = box_of(probes.grid);
  if (layout == ProbeLayout::rtxgi) {
    described["irradiance_gamma"] = 5;
    described["irradiance_texels"] = 6;
    described["distance_texels"] = probes.distance_size;
  }
  described["textures"] = std::move(textures);
  return described;
}

}  // namespace

BakedProbes bake_probe_files(const ProbeGrid& grid, std::span<const FileInput> cubes, std::span<const FileInput> depths,
                             const ProbeOptions& options, const Control& control) {
  const platform::FloatingPointScope floating_point;
  probes::check_grid(grid);
  probes::check_options(options, !depths.empty());
  require_files(grid, cubes, depths);
  BakedProbes probes;
  probes.grid = grid;
  ProbeOptions of_part = options;
  of_part.dilation_passes = 0;
  for (std::size_t first = 0; first < grid.size(); first += kProbesTogether) {
    const std::size_t count = std::min(kProbesTogether, grid.size() - first);
    const auto share = [&](std::size_t done) {
      return 0.98 * static_cast<double>(done) / static_cast<double>(grid.size());
    };
    const Captured captured(cubes.subspan(first, count), depths.empty() ? depths : depths.subspan(first, count),
                            control);
    // In a row: a probe's result does not depend on its position.
    const ProbeGrid row{.counts = {static_cast<int>(count), 1, 1}, .spacing = grid.spacing};
    try {
      append(probes, bake_probes(row, captured.cubes(), captured.depths(), of_part,
                                 jobs::part_of(control, share(first), share(first + count))));
    } catch (const Error& error) {
      if (error.code() == ErrorCode::cancelled || first == 0) throw;
      throw Error(error.code(), "of the files from number " + std::to_string(first) + " on, " + error.what());
    }
  }
  dilate(probes, options.dilation_passes, jobs::part_of(control, 0.98, 1.0));
  return probes;
}

WriteReport write_probes(const std::filesystem::path& path, const BakedProbes& probes,
                         std::span<const ProbeLayout> layouts, const Control& control) {
  const platform::FloatingPointScope floating_point;
  if (path.extension() != ".json") {
    throw platform::file_error(ErrorCode::unsupported_file, path,
                               "is not a name for the description of probes; pass one that ends in .json");
  }
  files::OutputFiles output;
  std::uint64_t clamped = 0;
  Json description = description_of(probes);
  std::vector<std::uint8_t> arrays;
  const std::filesystem::path arrays_path = files::beside(path, ".bin");
  probes::check_arrays(probes);
  description["arrays"] = {{"file", platform::utf8(arrays_path.filename())},
                           {"byte_order", "little"},
                           {"entries", append_arrays(arrays, probes)}};
  description["layouts"] = Json::array();
  for (std::size_t k = 0; k < layouts.size(); ++k) {
    jobs::throw_if_cancelled(control);
    description["layouts"].push_back(write_layout(output, path, probes, layouts[k], clamped));
  }
  output.add(arrays_path).write(arrays.data(), arrays.size());
  write_json(output.add(path), description, 2);
  return output.commit(clamped, control);
}

// ---- Back

namespace {

using ParsedJson = nlohmann::json;  // finds a name directly; the ordered one searches all names
using platform::ByteFile;
using platform::file_error;

constexpr std::uint64_t kLongestText = std::uint64_t{1} << 20U;
constexpr int kDeepestNesting = 8;
constexpr double kLargestExact = 9007199254740992.0;  // 2^53

/// The description, and its name in messages.
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
    const auto not_too_deep = [](int depth, ParsedJson::parse_event_t /*event*/, ParsedJson& /*parsed*/) {
      return depth < kDeepestNesting;
    };
    json_ = ParsedJson::parse(text, not_too_deep, false);
    if (!json_.is_object() || json_.value("format", ParsedJson()) != "welkin probes") {
      throw file_error(ErrorCode::unsupported_file, path_, "is no description of probes; write one by write_probes");
    }
    if (json_.value("version", ParsedJson()) != 1) {
      throw file_error(ErrorCode::unsupported_file, path_, "has a version that this library does not read; update it");
    }
  }

  [[noreturn]] void refuse(const std::string& message) const {
    throw file_error(ErrorCode::corrupt_file, path_, message);
  }

  [[nodiscard]] const ParsedJson& at(const ParsedJson& object, const char* key) const {
    const auto found = object.is_object() ? object.find(key) : object.end();
    if (!object.is_object() || found == object.end()) refuse(std::string("has no \"") + key + "\"");
    return *found;
  }
  [[nodiscard]] const ParsedJson& at(const char* key) const { return at(json_, key); }

  [[nodiscard]] double number(const ParsedJson& value, const char* key) const {
    if (!value.is_number()) refuse(std::string("has a \"") + key + "\" that is not a number");
    return value.get<double>();
  }
  /// Reads an integer from 0 to 2^53.
  [[nodiscard]] std::uint64_t whole(const ParsedJson& value, const char* key) const {
    const double found = number(value, key);
    if (!(found >= 0.0 && found <= kLargestExact) || found != std::floor(found)) {
      refuse(std::string("has a \"") + key + "\" that is not a whole number");
    }
    return static_cast<std::uint64_t>(found);
  }
  /// Reads an integer of at most `most`.
  [[nodiscard]] int small(const char* key, int most) const {
    const std::uint64_t found = whole(at(key), key);
    if (found > static_cast<std::uint64_t>(most)) {
      refuse(std::string("has ") + std::to_string(found) + " as its \"" + key + "\"; it can be " +
             std::to_string(most) + " at most");
    }
    return static_cast<int>(found);
  }
  [[nodiscard]] const ParsedJson& three(const ParsedJson& object, const char* key) const {
    const ParsedJson& value = at(object, key);
    if (!value.is_array() || value.size() != 3) refuse(std::string("has a \"") + key + "\" that is not three numbers");
    return value;
  }
  [[nodiscard]] const std::string& text(const ParsedJson& object, const char* key) const {
    const ParsedJson& value = at(object, key);
    if (!value.is_string()) refuse(std::string("has a \"") + key + "\" that is not text");
    return value.get_ref<const std::string&>();
  }

  [[nodiscard]] ProbeGrid grid() const {
    const ParsedJson& described = at("grid");
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

  /// Returns the entry of an array; null if there is none of that name.
  [[nodiscard]] const ParsedJson* entry(const char* name) const {
    const ParsedJson& entries = at(at("arrays"), "entries");
    if (!entries.is_array()) refuse("has \"entries\" that are no list");
    for (const ParsedJson& each : entries) {
      if (text(each, "name") == name) return &each;
    }
    return nullptr;
  }

 private:
  std::filesystem::path path_;
  ParsedJson json_;
};

/// Reads the arrays, each of which must have the size that follows from grid, bands and sizes.
class Arrays {
 public:
  Arrays(const Description& description, const FileInput& file)
      : description_(description), file_(file.path(), file.bytes()) {}

  template <class Value>
  void read(const char* name, const char* type, std::vector<Value>& values, const Shape& shape, bool optional) {
    const std::size_t count = std::accumulate(shape.begin(), shape.end(), std::size_t{1}, std::multiplies<>());
    const ParsedJson* entry = description_.entry(name);
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
    if (offset > file_.size() || bytes > file_.size() - offset) {  // before memory is allocated
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
  // A name in the description's folder, and no path to other folders.
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
  Arrays file(description, arrays ? *arrays : arrays_of(description, input));
  for_each_array(read, [&](const char* name, const char* type, auto& values, const Shape& shape, bool optional) {
    file.read(name, type, values, shape, optional);
  });
  for (const std::uint8_t pass : read.passes) {
    if (pass != 0) ++read.invalid;
    if (pass == probes::kUnfilled) ++read.unfilled;
  }
  return read;
}

}  // namespace welkin
