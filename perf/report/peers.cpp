#include <glm/matrix.hpp>
#include <nlohmann/json.hpp>

#include "embedded_texts.h"
#include "perf/report/passes.h"
#include "welkin/core.h"
#include "welkin/environment_file.h"
#include "welkin/resampling.h"

namespace welkin::report {
namespace {

using Json = nlohmann::json;

constexpr int kSmallestMip = 16;  // last mip of cmgen's chains
constexpr const char* kFilament = "libs/ibl 1.9.25";
constexpr const char* kTable = "table";  // the name of Welkin's own

std::string text_of(const std::filesystem::path& path) {
  std::ifstream stream(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(stream), {}};
}

/// Fills `values` with a file's floats; returns false if it has fewer.
bool read_floats(const std::filesystem::path& file, float* values, std::size_t bytes) {
  std::ifstream stream(file, std::ios::binary);
  stream.read(reinterpret_cast<char*>(values), static_cast<std::streamsize>(bytes));
  return static_cast<std::size_t>(stream.gcount()) == bytes;
}

std::string write_floats(const std::filesystem::path& file, const CubemapView& cube) {
  std::ofstream stream(file, std::ios::binary);
  for (const void* const face : cube.faces)
    stream.write(static_cast<const char*>(face), std::streamsize{12} * cube.size * cube.size);
  return file.string();
}

/// Reads nine lines of "( r, g, b); // L00" of cmgen, with the opposite sign of odd orders.
SphericalHarmonics harmonics_of_cmgen(const std::string& text) {
  SphericalHarmonics radiance(3);
  std::string numbers = text;
  std::replace_if(
      numbers.begin(), numbers.end(), [](char c) { return c == '(' || c == ')' || c == ',' || c == ';'; }, ' ');
  std::istringstream lines(numbers);
  std::size_t count = 0;
  for (std::string line; std::getline(lines, line) && count < 9; ++count) {
    std::istringstream words(line);
    glm::dvec3& rgb = radiance.coefficients()[count];
    if (!(words >> rgb.r >> rgb.g >> rgb.b)) break;
    if (count % 2 == 1) rgb = -rgb;  // indices of odd orders are the odd ones here: 1, 3, 5, 7
  }
  if (count < 9) throw Error(ErrorCode::corrupt_file, "fewer than nine coefficients");
  return radiance;
}

/// Returns cmgen's name with the version of Debian's package, which the program does not report.
std::string cmgen_name(const std::filesystem::path& folder) {
  const std::filesystem::path file = folder / "version.txt";
  const ProcessResult asked =
      run_process({"dpkg-query", "-W", "-f=${Version}", "libfilament-tools"}, 0, Clock::wall, file);
  const std::string version = asked.exit_code == 0 ? text_of(file) : "";
  return version.empty() ? "cmgen" : "cmgen " + version.substr(0, version.find_first_of("+-"));
}

PeerResult<SphericalHarmonics> projection_from(const Json& one) {
  PeerResult<SphericalHarmonics> projection{one.at("peer"), one.at("method"), target_words(one.at("target")),
                                            SphericalHarmonics(3), one.at("seconds")};
  for (std::size_t k = 0; k < 9; ++k) {
    for (int c = 0; c < 3; ++c) {
      projection.result.coefficients()[k][c] = one.at("radiance").at(k).at(static_cast<std::size_t>(c)).get<double>();
    }
  }
  return projection;
}

/// Reads levels m0_px.exr ... of one folder.
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

/// Returns the chain that webgl_peers.mjs wrote and describes in `said`.
PeerResult<PeerChain> webgl_chain(const Json& said, const std::filesystem::path& folder) {
  const bool is_three = said.at("engine") == "three";
  Cubemap chain(said.at("size").get<int>(), said.at("mips").get<int>());
  if (!read_floats(folder / (said.at("engine").get<std::string>() + ".f32"), chain.face(0, 0), chain.bytes()))
    throw Error(ErrorCode::corrupt_file, "fewer texels than it said");
  const Convention& engine = convention(is_three ? Engine::three : Engine::babylon);
  // three.js mirrors loaded cubemaps, and reads those that it draws unchanged.
  const dmat3 faces = is_three ? engine.from_welkin : *engine.faces_from_engine * engine.from_welkin;
  return {said.at("version"),
          is_three ? "PMREMGenerator" : "HDRFiltering",
          std::to_string(chain.level_size(0)) + " texels, " + std::to_string(chain.levels()) + " mips",
          {from_axes(chain, faces), is_three ? RoughnessSchedule::filament : RoughnessSchedule::babylon},
          std::numeric_limits<double>::quiet_NaN()};
}

/// Returns a table's RGB rows in the opposite order: Filament's has the roughest on top, as OpenGL counts.
PeerTable rows_from_below(const float* rgb, int size) {
  const std::ptrdiff_t row_values = std::ptrdiff_t{3} * size;
  PeerTable rotated{size, {}};
  for (int row = size - 1; row >= 0; --row) {
    rotated.values.insert(rotated.values.end(), rgb + row * row_values, rgb + (row + 1) * row_values);
  }
  return rotated;
}

}  // namespace

Cubemap from_axes(const Cubemap& chain, const dmat3& faces) {
  Cubemap result(chain.level_size(0), chain.levels());
  for (int level = 0; level < chain.levels(); ++level) {
    const Cubemap moved = to_cubemap(chain.view(level), chain.level_size(level), glm::transpose(faces));
    std::copy(moved.pixels().begin(), moved.pixels().end(), result.face(level, 0));
  }
  return result;
}

Peers Peers::find(const std::filesystem::path& node_modules, const std::filesystem::path& programs,
                  const std::filesystem::path& folder, const Stopwatch& stopwatch) {
  Peers peers;
  peers.folder_ = folder;
  peers.stopwatch_ = stopwatch;
  if (on_path("cmgen")) {
    peers.cmgen_ = cmgen_name(folder);
  } else {
    peers.notes_.emplace_back("Filament's cmgen is not on this machine (Debian: libfilament-tools): left out.");
  }
  constexpr const char* kProgram = "judge_filament_ibl";
  if (stopwatch.threads > 1) {
    peers.notes_.emplace_back("Filament's libs/ibl is measured with one thread alone: left out.");
  } else if (!programs.empty() && std::filesystem::exists(programs / kProgram)) {
    peers.filament_ = (programs / kProgram).string();
  } else if (on_path(kProgram)) {
    peers.filament_ = kProgram;
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

PeerProjections Peers::project(const Cubemap& cube, const std::vector<int>& targets) const {
  PeerProjections found;
  if (node_) {
    std::ofstream(folder_ / "peers.mjs") << tool::embedded_text("peers.mjs");
    std::ofstream(folder_ / "peers.json") << Json{{"modules", node_modules_.string()},
                                                  {"cube", write_floats(folder_ / "cube.f32", cube.view())},
                                                  {"size", cube.size()},
                                                  {"targets", targets},
                                                  {"budget", 4.0 * stopwatch_.budget_seconds},
                                                  {"processor", stopwatch_.clock() == Clock::processor}};
    const std::filesystem::path output = folder_ / "peers_found.json";
    const std::vector<std::string> arguments{*node_, (folder_ / "peers.mjs").string(),
                                             (folder_ / "peers.json").string()};
    if (run_process(arguments, stopwatch_.threads, stopwatch_.clock(), output).exit_code == 0) {
      try {
        for (const Json& one : Json::parse(text_of(output))) found.push_back(projection_from(one));
      } catch (const Json::exception&) {
        found.clear();
      }
    }
  }
  const std::vector<double> said =
      ask_filament({"--harmonics", write_floats(folder_ / "filament.f32", cube.view()), std::to_string(cube.size()),
                    std::to_string(stopwatch_.budget_seconds)});
  if (said.size() != 28) return found;
  SphericalHarmonics radiance(3);
  for (std::size_t k = 0; k < 9; ++k) {
    const double sign = k % 2 == 1 ? -1.0 : 1.0;  // its odd orders, here the odd indices
    radiance.coefficients()[k] = sign * glm::dvec3(said[3 * k + 1], said[3 * k + 2], said[3 * k + 3]);
  }
  found.push_back({kFilament, "computeSH", target_words(0), radiance, said[0]});
  return found;
}

template <typename Result>
void Peers::ask_cmgen(const std::vector<std::string>& words, const char* method, const std::string& setting,
                      const std::function<Result()>& read, std::vector<PeerResult<Result>>& found) const {
  std::vector<std::string> arguments{"cmgen", "-q"};
  arguments.insert(arguments.end(), words.begin(), words.end());
  const std::optional<double> seconds = cmgen_ ? process_seconds(arguments, stopwatch_) : std::nullopt;
  if (!seconds) return;
  try {
    found.push_back({*cmgen_, method, setting, read(), *seconds});
  } catch (const Error&) {
    return;  // its output has another form
  }
}

std::vector<double> Peers::ask_filament(std::vector<std::string> words) const {
  std::vector<double> numbers;
  if (!filament_) return numbers;
  words.insert(words.begin(), *filament_);
  const std::filesystem::path output = folder_ / "filament_found.txt";
  if (run_process(words, 0, Clock::wall, output).exit_code != 0) return numbers;
  std::ifstream said(output);
  for (double number = 0.0; said >> number;) numbers.push_back(number);
  return numbers;
}

PeerProjections Peers::project_file(const std::filesystem::path& file) const {
  PeerProjections found;
  for (const int size : {64, 256}) {
    const std::filesystem::path output = folder_ / ("cmgen_" + std::to_string(size) + ".txt");
    ask_cmgen<SphericalHarmonics>(
        {"--sh=3", "-w", "no", "--size=" + std::to_string(size), "--sh-output=" + output.string(), file.string()},
        "--sh", "cube of " + std::to_string(size), [&] { return harmonics_of_cmgen(text_of(output)); }, found);
  }
  return found;
}

PeerChains Peers::prefilter_file(const std::filesystem::path& file, int size, std::span<const int> samples) const {
  PeerChains found;
  const int levels = full_chain_levels(size) - full_chain_levels(kSmallestMip) + 1;
  for (const int count : samples) {
    const std::filesystem::path output = folder_ / ("cmgen_" + std::to_string(count));
    ask_cmgen<PeerChain>(
        {"-f", "exr", "--size=" + std::to_string(size), "--ibl-samples=" + std::to_string(count),
         "--ibl-ld=" + output.string(), file.string()},
        "importance sampling", std::to_string(count) + " samples",
        [&] {
          return PeerChain{read_levels(output / file.stem(), size, levels), RoughnessSchedule::filament};
        },
        found);
  }
  add_webgl(file, size, found);
  return found;
}

void Peers::add_webgl(const std::filesystem::path& file, int size, PeerChains& found) const {
  if (!browser_) return;
  const std::filesystem::path output = folder_ / "webgl_found.json";
  if (!std::filesystem::exists(output)) {
    std::ofstream(folder_ / "webgl_peers.mjs") << tool::embedded_text("webgl_peers.mjs");
    std::ofstream(folder_ / "webgl_peers.json") << Json{{"modules", node_modules_.string()},
                                                        {"browser", *browser_},
                                                        {"image", std::filesystem::absolute(file).string()},
                                                        {"size", size},
                                                        {"folder", folder_.string()}};
    (void)run_process({*node_, (folder_ / "webgl_peers.mjs").string(), (folder_ / "webgl_peers.json").string()}, 0,
                      Clock::wall, output);
  }
  PeerChains chains;
  try {
    for (const Json& one : Json::parse(text_of(output))) chains.push_back(webgl_chain(one, folder_));
  } catch (const Json::exception&) {
    return;
  } catch (const Error&) {
    return;
  }
  std::move(chains.begin(), chains.end(), std::back_inserter(found));
}

PeerChains Peers::prefilter_cube(const CubemapView& cube, int mips, std::span<const int> samples) const {
  std::vector<std::string> words{"--chain",
                                 write_floats(folder_ / "filament.f32", cube),
                                 std::to_string(cube.size),
                                 std::to_string(mips),
                                 std::to_string(stopwatch_.budget_seconds),
                                 folder_.string()};
  for (const int count : samples) words.push_back(std::to_string(count));
  const std::vector<double> said = ask_filament(words);
  PeerChains found;
  for (std::size_t i = 0; i < said.size(); ++i) {
    const std::string count = std::to_string(samples[i]);
    Cubemap chain(cube.size, mips);
    if (!read_floats(folder_ / ("filament_" + count + ".f32"), chain.face(0, 0), chain.bytes())) continue;
    found.push_back(
        {kFilament, "roughnessFilter", count + " samples", {std::move(chain), RoughnessSchedule::filament}, said[i]});
  }
  return found;
}

PeerTables Peers::brdf_table(std::span<const int> sizes) const {
  PeerTables found;
  for (const int size : sizes) {
    const std::filesystem::path output = folder_ / ("dfg_" + std::to_string(size) + ".exr");
    const auto read = [&] {
      ReadOptions options;
      options.layout = Layout::lat_long;  // the aspect ratio does not matter
      const Environment image = read_environment(output, options);
      if (image.info.width != size || image.info.height != size)
        throw Error(ErrorCode::corrupt_file, "another size than requested");
      return rows_from_below(image.pixels.get(), size);
    };
    ask_cmgen<PeerTable>({"--size=" + std::to_string(size), "--ibl-dfg-multiscatter", "--ibl-dfg=" + output.string()},
                         kTable, square_words(size), read, found);
  }
  for (const int size : sizes) {
    const std::filesystem::path file = folder_ / "filament_table.f32";
    const std::vector<double> said =
        ask_filament({"--table", std::to_string(size), std::to_string(stopwatch_.budget_seconds), file.string()});
    std::vector<float> values(std::size_t{3} * static_cast<std::size_t>(size) * static_cast<std::size_t>(size));
    if (said.size() == 1 && read_floats(file, values.data(), values.size() * sizeof(float)))
      found.push_back({kFilament, kTable, square_words(size), rows_from_below(values.data(), size), said[0]});
  }
  return found;
}

}  // namespace welkin::report
