// Grids of probes from files of captures, and to files with a description in JSON.
#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <nlohmann/json.hpp>
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
    // Files are some hundred KB; what a thread waits for is the disk.
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

// ---- To files

/// An array in the file of arrays.
template <class Value>
Json append_array(std::vector<std::uint8_t>& bytes, const char* name, const char* type, std::vector<std::size_t> shape,
                  std::span<const Value> values) {
  const std::size_t offset = bytes.size();
  bytes.resize(offset + values.size_bytes());
  if (!values.empty()) std::memcpy(bytes.data() + offset, values.data(), values.size_bytes());
  const std::size_t whole = (bytes.size() + 7) / 8 * 8;
  bytes.resize(whole);
  return {
      {"name", name}, {"type", type}, {"shape", std::move(shape)}, {"offset", offset}, {"bytes", values.size_bytes()}};
}

Json append_arrays(std::vector<std::uint8_t>& bytes, const BakedProbes& probes) {
  const std::size_t count = probes.grid.size();
  const auto edge = static_cast<std::size_t>(probes.distance_edge());
  const auto functions = [](int bands) { return static_cast<std::size_t>(bands) * static_cast<std::size_t>(bands); };
  const std::span<const double> numbers(count > 0 ? &probes.coefficients[0].x : nullptr,
                                        3 * probes.coefficients.size());
  Json entries = Json::array();
  entries.push_back(append_array(bytes, "coefficients", "float64", {count, functions(probes.bands), 3}, numbers));
  entries.push_back(append_array(bytes, "validity", "float32", {count}, std::span<const float>(probes.validity)));
  entries.push_back(append_array(bytes, "passes", "uint8", {count}, std::span<const std::uint8_t>(probes.passes)));
  entries.push_back(
      append_array(bytes, "distances", "float32", {count, edge, edge, 2}, std::span<const float>(probes.distances)));
  entries.push_back(
      append_array(bytes, "sky", "float64", {count, functions(probes.sky_bands)}, std::span<const double>(probes.sky)));
  if (!probes.offsets.empty()) {
    entries.push_back(append_array(bytes, "offsets", "float64", {count, 3},
                                   std::span<const double>(&probes.offsets[0].x, 3 * probes.offsets.size())));
  }
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

/// The box that a grid's cells fill, half a cell around its outermost probes, as engines place a volume.
Json box_of(const ProbeGrid& grid) {
  const dvec3 counts(grid.counts[0], grid.counts[1], grid.counts[2]);
  return {{"centre", three_numbers(grid.origin + 0.5 * (counts - 1.0) * grid.spacing)},
          {"size", three_numbers(counts * grid.spacing)}};
}

/// A scene of three.js, as `Object3D.toJSON` writes it and ObjectLoader reads it: a group of LightProbes.
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
    // In a row: what a probe is does not depend on where it stands.
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

}  // namespace welkin
