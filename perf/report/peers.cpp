#include <nlohmann/json.hpp>

#include "embedded_texts.h"
#include "image/geometry.h"
#include "perf/report/passes.h"
#include "welkin/core.h"
#include "welkin/environment_file.h"

namespace welkin::report {
namespace {

using Json = nlohmann::json;

constexpr int kSmallestMip = 16;

std::string text_of(const std::filesystem::path& path) {
  std::ifstream stream(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(stream), {}};
}

/// Nine lines of "( r, g, b); // L00" as cmgen writes them, odd orders with the other sign.
std::optional<SphericalHarmonics> harmonics_of_cmgen(const std::string& text) {
  SphericalHarmonics radiance(3);
  std::string numbers = text;
  std::replace_if(
      numbers.begin(), numbers.end(), [](char c) { return c == '(' || c == ')' || c == ',' || c == ';'; }, ' ');
  std::istringstream lines(numbers);
  std::size_t count = 0;
  for (std::string line; std::getline(lines, line) && count < 9; ++count) {
    std::istringstream words(line);
    glm::dvec3& rgb = radiance.coefficients()[count];
    if (!(words >> rgb.r >> rgb.g >> rgb.b)) return std::nullopt;
    if (count % 2 == 1) rgb = -rgb;  // indices of odd orders are the odd ones here: 1, 3, 5, 7
  }
  return count == 9 ? std::optional(radiance) : std::nullopt;
}

/// Debian's package knows its version, the program does not tell.
std::string cmgen_name(const std::filesystem::path& folder) {
  const std::filesystem::path file = folder / "version.txt";
  const ProcessResult asked =
      run_process({"dpkg-query", "-W", "-f=${Version}", "libfilament-tools"}, 0, Clock::wall, file);
  const std::string version = asked.exit_code == 0 ? text_of(file) : "";
  return version.empty() ? "cmgen" : "cmgen " + version.substr(0, version.find_first_of("+-"));
}

PeerProjection projection_from(const Json& one) {
  PeerProjection projection{one.at("peer"), one.at("method"), one.at("target"), SphericalHarmonics(3),
                            one.at("seconds")};
  for (std::size_t k = 0; k < 9; ++k) {
    for (int c = 0; c < 3; ++c) {
      projection.radiance.coefficients()[k][c] = one.at("radiance").at(k).at(static_cast<std::size_t>(c)).get<double>();
    }
  }
  return projection;
}

/// Levels m0_px.exr ... of one folder.
Cubemap read_levels(const std::filesystem::path& folder, int size, int levels) {
  Cubemap chain(size, levels);
  for (int level = 0; level < levels; ++level) {
    const Environment environment = read_environment(folder / ("m" + std::to_string(level) + "_px.exr"));
    const CubemapView view = environment.cubemap();
    if (view.size != chain.level_size(level)) throw Error(ErrorCode::corrupt_file, "another size than requested");
    const auto values = std::size_t{3} * static_cast<std::size_t>(view.size) * static_cast<std::size_t>(view.size);
    for (int face = 0; face < 6; ++face) {
      const auto* const from = static_cast<const float*>(view.faces[static_cast<std::size_t>(face)]);
      std::copy_n(from, values, chain.face(level, face));
    }
  }
  return chain;
}

/// The chain that webgl_peers.mjs wrote and said this of.
PeerChain webgl_chain(const Json& said, const std::filesystem::path& folder) {
  const bool is_three = said.at("engine") == "three";
  Cubemap chain(said.at("size").get<int>(), said.at("mips").get<int>());
  const std::string bytes = text_of(folder / (said.at("engine").get<std::string>() + ".f32"));
  std::size_t at = 0;
  for (int level = 0; level < chain.levels(); ++level) {
    const auto level_bytes = std::size_t{18} * sizeof(float) * static_cast<std::size_t>(chain.level_size(level)) *
                             static_cast<std::size_t>(chain.level_size(level));
    if (bytes.size() - at < level_bytes) throw Error(ErrorCode::corrupt_file, "fewer texels than it said");
    std::copy_n(bytes.data() + at, level_bytes, reinterpret_cast<char*>(chain.face(level, 0)));
    at += level_bytes;
  }
  const Convention& engine = convention(is_three ? Engine::three : Engine::babylon);
  // three.js mirrors cubemaps that are loaded; what it draws itself it reads as it is.
  const dmat3 faces = is_three ? engine.from_welkin : *engine.faces_from_engine * engine.from_welkin;
  return {said.at("version"),
          is_three ? "PMREMGenerator" : "HDRFiltering",
          std::to_string(chain.level_size(0)) + " texels, " + std::to_string(chain.levels()) + " mips",
          from_axes(chain, faces),
          is_three ? RoughnessSchedule::filament : RoughnessSchedule::babylon,
          std::numeric_limits<double>::quiet_NaN()};
}

}  // namespace

std::vector<float> rows_from_below(const float* rgb, int size) {
  const std::ptrdiff_t row_values = std::ptrdiff_t{3} * size;
  std::vector<float> rotated;
  for (int row = size - 1; row >= 0; --row) {
    rotated.insert(rotated.end(), rgb + row * row_values, rgb + (row + 1) * row_values);
  }
  return rotated;
}

Cubemap from_axes(const Cubemap& chain, const dmat3& faces) {
  Cubemap result(chain.level_size(0), chain.levels());
  for (int level = 0; level < chain.levels(); ++level) {
    const int size = chain.level_size(level);
    for (int face = 0; face < 6; ++face) {
      for (int row = 0; row < size; ++row) {
        for (int column = 0; column < size; ++column) {
          const glm::dvec3 there = faces * glm::dvec3(image::point_of(size, {face, column, row}));
          const image::CubeTexel from = image::texel_at(size, glm::ivec3(glm::round(there)));
          std::copy_n(chain.face(level, from.face) + 3 * (from.row * size + from.column), 3,
                      result.face(level, face) + 3 * (row * size + column));
        }
      }
    }
  }
  return result;
}

Peers Peers::find(const std::filesystem::path& node_modules, const std::filesystem::path& programs, int threads) {
  Peers peers;
  if (on_path("cmgen")) {
    peers.cmgen_ = "cmgen";
  } else {
    peers.notes_.emplace_back("Filament's cmgen is not on this machine (Debian: libfilament-tools): left out.");
  }
  constexpr const char* kFilament = "judge_filament_ibl";
  if (threads > 1) {
    peers.notes_.emplace_back("Filament's libs/ibl is measured with one thread alone: left out.");
  } else if (!programs.empty() && std::filesystem::exists(programs / kFilament)) {
    peers.filament_ = (programs / kFilament).string();
  } else if (on_path(kFilament)) {
    peers.filament_ = kFilament;
  } else {
    peers.notes_.emplace_back(
        "Filament's libs/ibl is not in a program here (Debian: libfilament-dev; target judge_filament_ibl): left out.");
  }
  if (node_modules.empty()) {
    peers.notes_.emplace_back("Babylon.js and three.js were not requested (--node-modules): left out.");
  } else if (!on_path("node")) {
    peers.notes_.emplace_back("Node.js is not on this machine: Babylon.js and three.js are left out.");
  } else if (!std::filesystem::is_directory(node_modules / "node_modules")) {
    throw Error(ErrorCode::file_access, node_modules.string() + ": holds no folder node_modules");
  } else {
    peers.node_ = "node";
    peers.node_modules_ = std::filesystem::absolute(node_modules);
    for (const char* const name : {"chromium-headless-shell", "chromium"})
      if (!peers.browser_ && on_path(name)) peers.browser_ = name;
    if (!peers.browser_)
      peers.notes_.emplace_back("Chromium is not on this machine: chains of Babylon.js and three.js are left out.");
  }
  return peers;
}

std::vector<PeerProjection> Peers::project(const Cubemap& cube, const std::vector<int>& targets,
                                           const std::filesystem::path& folder, const Stopwatch& stopwatch) const {
  if (!node_) return {};
  std::ofstream(folder / "cube.f32", std::ios::binary)
      .write(reinterpret_cast<const char*>(cube.face(0)), static_cast<std::streamsize>(cube.bytes()));
  std::ofstream(folder / "peers.mjs") << tool::embedded_text("peers.mjs");
  const Json wanted{{"modules", node_modules_.string()},
                    {"cube", (folder / "cube.f32").string()},
                    {"size", cube.size()},
                    {"targets", targets},
                    {"budget", 4.0 * stopwatch.budget_seconds},
                    {"processor", stopwatch.clock() == Clock::processor}};
  std::ofstream(folder / "peers.json") << wanted;
  const std::filesystem::path output = folder / "peers_found.json";
  const ProcessResult result = run_process({*node_, (folder / "peers.mjs").string(), (folder / "peers.json").string()},
                                           stopwatch.threads, stopwatch.clock(), output);
  if (result.exit_code != 0) return {};
  std::vector<PeerProjection> found;
  try {
    for (const Json& one : Json::parse(text_of(output))) found.push_back(projection_from(one));
  } catch (const Json::exception&) {
    return {};
  }
  return found;
}

std::vector<PeerProjection> Peers::project_file(const std::filesystem::path& file, const std::filesystem::path& folder,
                                                const Stopwatch& stopwatch) const {
  std::vector<PeerProjection> found;
  if (!cmgen_) return found;
  const std::string peer = cmgen_name(folder);
  for (const int size : {64, 256}) {
    const std::filesystem::path output = folder / ("cmgen_" + std::to_string(size) + ".txt");
    const std::vector<std::string> arguments{
        *cmgen_,      "-q", "--sh=3", "-w", "no", "--size=" + std::to_string(size), "--sh-output=" + output.string(),
        file.string()};
    const std::optional<double> seconds = process_seconds(arguments, stopwatch);
    if (!seconds) continue;
    const std::optional<SphericalHarmonics> radiance = harmonics_of_cmgen(text_of(output));
    if (radiance) found.push_back({peer, "--sh", size, *radiance, *seconds});
  }
  return found;
}

std::vector<PeerChain> Peers::prefilter_file(const std::filesystem::path& file, int size, std::span<const int> samples,
                                             const std::filesystem::path& folder, const Stopwatch& stopwatch) const {
  std::vector<PeerChain> found;
  if (!cmgen_) return found;
  const std::string peer = cmgen_name(folder);
  const int levels = full_chain_levels(size) - full_chain_levels(kSmallestMip) + 1;
  for (const int count : samples) {
    const std::filesystem::path output = folder / ("cmgen_" + std::to_string(count));
    const std::vector<std::string> arguments{*cmgen_,
                                             "-q",
                                             "-f",
                                             "exr",
                                             "--size=" + std::to_string(size),
                                             "--ibl-samples=" + std::to_string(count),
                                             "--ibl-ld=" + output.string(),
                                             file.string()};
    const std::optional<double> seconds = process_seconds(arguments, stopwatch);
    if (!seconds) continue;
    try {
      found.push_back({peer, "importance sampling", std::to_string(count) + " samples",
                       read_levels(output / file.stem(), size, levels), RoughnessSchedule::filament, *seconds});
    } catch (const Error&) {
      continue;  // it wrote something else
    }
  }
  return found;
}

std::vector<PeerChain> Peers::prefilter_by_webgl(const std::filesystem::path& file, int size,
                                                 const std::filesystem::path& folder) const {
  if (!browser_) return {};
  const std::filesystem::path output = folder / "webgl_found.json";
  if (!std::filesystem::exists(output)) {
    std::ofstream(folder / "webgl_peers.mjs") << tool::embedded_text("webgl_peers.mjs");
    std::ofstream(folder / "webgl_peers.json") << Json{{"modules", node_modules_.string()},
                                                       {"browser", *browser_},
                                                       {"picture", std::filesystem::absolute(file).string()},
                                                       {"size", size},
                                                       {"folder", folder.string()}};
    (void)run_process({*node_, (folder / "webgl_peers.mjs").string(), (folder / "webgl_peers.json").string()}, 0,
                      Clock::wall, output);
  }
  std::vector<PeerChain> found;
  try {
    for (const Json& one : Json::parse(text_of(output))) found.push_back(webgl_chain(one, folder));
  } catch (const Json::exception&) {
    return {};
  } catch (const Error&) {
    return {};
  }
  return found;
}

std::vector<PeerTable> Peers::brdf_table(std::span<const int> sizes, const std::filesystem::path& folder,
                                         const Stopwatch& stopwatch) const {
  std::vector<PeerTable> found;
  if (!cmgen_) return found;
  const std::string peer = cmgen_name(folder);
  for (const int size : sizes) {
    const std::filesystem::path output = folder / ("dfg_" + std::to_string(size) + ".exr");
    const std::vector<std::string> arguments{*cmgen_, "-q", "--size=" + std::to_string(size), "--ibl-dfg-multiscatter",
                                             "--ibl-dfg=" + output.string()};
    const std::optional<double> seconds = process_seconds(arguments, stopwatch);
    if (!seconds) continue;
    try {
      ReadOptions options;
      options.layout = Layout::lat_long;  // any picture will do
      const Environment picture = read_environment(output, options);
      if (picture.info.width != size || picture.info.height != size) continue;
      found.push_back({peer, size, rows_from_below(picture.pixels.get(), size), *seconds});
    } catch (const Error&) {
      continue;
    }
  }
  return found;
}

}  // namespace welkin::report
