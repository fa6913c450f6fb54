// Filament's libs/ibl beside Welkin at equal inputs: judges/filament_ibl.cpp, a program of its own, times its calls
// itself.
#include <sstream>

#include "perf/report/passes.h"

namespace welkin::report {
namespace {

constexpr const char* kPeer = "libs/ibl 1.9.25";

std::string write_floats(const std::filesystem::path& file, const CubemapView& cube) {
  std::ofstream stream(file, std::ios::binary);
  for (const void* const face : cube.faces)
    stream.write(static_cast<const char*>(face), std::streamsize{12} * cube.size * cube.size);
  return file.string();
}

/// Fills `values` with a file's floats; false if it has fewer.
bool read_floats(const std::filesystem::path& file, float* values, std::size_t bytes) {
  std::ifstream stream(file, std::ios::binary);
  stream.read(reinterpret_cast<char*>(values), static_cast<std::streamsize>(bytes));
  return static_cast<std::size_t>(stream.gcount()) == bytes;
}

}  // namespace

std::vector<double> Peers::ask_filament(std::vector<std::string> words, const std::filesystem::path& folder) const {
  std::vector<double> numbers;
  if (!filament_) return numbers;
  words.insert(words.begin(), *filament_);
  const std::filesystem::path output = folder / "filament_found.txt";
  if (run_process(words, 0, Clock::wall, output).exit_code != 0) return numbers;
  std::ifstream said(output);
  for (double number = 0.0; said >> number;) numbers.push_back(number);
  return numbers;
}

std::vector<PeerProjection> Peers::project_in_process(const CubemapView& cube, const std::filesystem::path& folder,
                                                      const Stopwatch& stopwatch) const {
  const std::vector<double> said = ask_filament({"--harmonics", write_floats(folder / "filament.f32", cube),
                                                 std::to_string(cube.size), std::to_string(stopwatch.budget_seconds)},
                                                folder);
  if (said.size() != 28) return {};
  PeerProjection found{kPeer, "computeSH", 0, SphericalHarmonics(3), said[0]};
  for (std::size_t k = 0; k < 9; ++k) {
    const double sign = k % 2 == 1 ? -1.0 : 1.0;  // its odd orders, which are the odd indices here
    found.radiance.coefficients()[k] = sign * glm::dvec3(said[3 * k + 1], said[3 * k + 2], said[3 * k + 3]);
  }
  return {found};
}

std::vector<PeerChain> Peers::prefilter_in_process(const CubemapView& cube, int mips, std::span<const int> samples,
                                                   const std::filesystem::path& folder,
                                                   const Stopwatch& stopwatch) const {
  std::vector<std::string> words{"--chain",
                                 write_floats(folder / "filament.f32", cube),
                                 std::to_string(cube.size),
                                 std::to_string(mips),
                                 std::to_string(stopwatch.budget_seconds),
                                 folder.string()};
  for (const int count : samples) words.push_back(std::to_string(count));
  const std::vector<double> said = ask_filament(words, folder);
  std::vector<PeerChain> found;
  for (std::size_t i = 0; i < said.size(); ++i) {
    const std::string count = std::to_string(samples[i]);
    Cubemap chain(cube.size, mips);
    if (!read_floats(folder / ("filament_" + count + ".f32"), chain.face(0, 0), chain.bytes())) continue;
    found.push_back(
        {kPeer, "roughnessFilter", count + " samples", std::move(chain), RoughnessSchedule::filament, said[i]});
  }
  return found;
}

std::vector<PeerTable> Peers::table_in_process(std::span<const int> sizes, const std::filesystem::path& folder,
                                               const Stopwatch& stopwatch) const {
  std::vector<PeerTable> found;
  for (const int size : sizes) {
    const std::filesystem::path file = folder / "filament_table.f32";
    const std::vector<double> said = ask_filament(
        {"--table", std::to_string(size), std::to_string(stopwatch.budget_seconds), file.string()}, folder);
    std::vector<float> values(std::size_t{3} * static_cast<std::size_t>(size) * static_cast<std::size_t>(size));
    if (said.size() == 1 && read_floats(file, values.data(), values.size() * sizeof(float)))
      found.push_back({kPeer, size, rows_from_below(values.data(), size), said[0]});
  }
  return found;
}

}  // namespace welkin::report
