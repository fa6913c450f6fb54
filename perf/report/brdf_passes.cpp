// The passes about BRDF tables: sizes, and cmgen's.
#include <algorithm>
#include <cmath>

#include "perf/report/error_norms.h"
#include "perf/report/passes.h"
#include "welkin/core.h"
#include "welkin/reflections.h"

namespace welkin::report {
namespace {

constexpr const char* kTableTruth = "a finer table's texels, each within 1e-5";
constexpr int kRuns = 3;

/// Two channels of a table, to be looked up as a shader does.
struct Lookup {
  const float* values;
  int width, height, channels;

  [[nodiscard]] double at(int column, int row, int channel) const {
    const int x = std::clamp(column, 0, width - 1);
    const int y = std::clamp(row, 0, height - 1);
    return static_cast<double>(values[(static_cast<std::ptrdiff_t>(y) * width + x) * channels + channel]);
  }

  /// Bilinear, clamped to the edge; both coordinates in [0, 1].
  [[nodiscard]] double linear(double across, double down, int channel) const {
    const double x = across * width - 0.5;
    const double y = down * height - 0.5;
    const int column = static_cast<int>(std::floor(x));
    const int row = static_cast<int>(std::floor(y));
    const double right = x - column;
    const double below = y - row;
    return (1.0 - below) * ((1.0 - right) * at(column, row, channel) + right * at(column + 1, row, channel)) +
           below * ((1.0 - right) * at(column, row + 1, channel) + right * at(column + 1, row + 1, channel));
  }
};

Lookup lookup(const BrdfTable& table) {
  return {table.values.data(), table.options.width, table.options.height, table.channels};
}

ErrorNorms errors_of(const Lookup& table, const BrdfTable& truth) {
  const Lookup exact = lookup(truth);
  double squares = 0.0;
  double whole = 0.0;
  double largest = 0.0;
  for (int row = 0; row < exact.height; ++row) {
    for (int column = 0; column < exact.width; ++column) {
      for (int channel = 0; channel < 2; ++channel) {
        const double expected = exact.at(column, row, channel);
        const double error = table.linear((column + 0.5) / exact.width, (row + 0.5) / exact.height, channel) - expected;
        squares += error * error;
        whole += expected * expected;
        largest = std::max(largest, std::abs(error));
      }
    }
  }
  return {std::sqrt(squares / whole), largest};
}

/// Tables are kept once made: neighbours a column or two wider stand in for repeats, their time in proportion.
double seconds_of(BrdfTableOptions options, const Stopwatch& stopwatch) {
  Stopwatch once = stopwatch;
  once.most_runs = 1;
  const int width = options.width;
  double fastest = HUGE_VAL;
  for (int run = 1; run <= kRuns; ++run) {
    options.width = width + run;
    fastest = std::min(fastest, once.seconds([&] { (void)brdf_table(options); }) * width / options.width);
  }
  return fastest;
}

std::string size_words(int size) { return std::to_string(size) + " x " + std::to_string(size); }

std::vector<Measurement> by_size(const PassContext& context, BrdfModel model) {
  const int fine = context.scale.table_truth;
  std::vector<int> sizes;
  for (int size = 8; size <= context.scale.largest_table; size *= 2) sizes.push_back(size);
  const auto truth = brdf_table({fine, fine, model, false});
  std::vector<Measurement> all;
  for (const int size : sizes) {
    const BrdfTableOptions options{size, size, model, false};
    const ErrorNorms errors = errors_of(lookup(*brdf_table(options)), *truth);
    all.push_back({"", "table", size_words(size), errors.rms, errors.maximum, seconds_of(options, context.stopwatch),
                   kTableTruth});
    progress(context, all.size(), sizes.size() + 1);
  }
  if (model != BrdfModel::multiple_scattering) return all;
  for (const PeerTable& peer : context.peers.brdf_table(sizes, context.folder, context.stopwatch)) {
    const ErrorNorms errors = errors_of({peer.values.data(), peer.size, peer.size, 3}, *truth);
    all.push_back(
        {"", "table", size_words(peer.size), errors.rms, errors.maximum, peer.seconds, kTableTruth, peer.peer});
  }
  return all;
}

PassRunner runner(const char* id, const char* title, const char* holds, BrdfModel model) {
  return {{id, title,
           std::string("A table of ") + holds +
               ", without sheen and without a cache. The error is that of linear lookups. For cmgen, the time is that "
               "of the "
               "whole process.",
           "rms: rms of the difference over that of the reference. Maximum: largest difference."},
          1.0,
          [model](const PassContext& context) { return by_size(context, model); }};
}

}  // namespace

std::vector<PassRunner> brdf_passes() {
  return {runner("brdf-split-sum", "BRDF table, split sum", "scale and bias", BrdfModel::split_sum),
          runner("brdf-multiple", "BRDF table, multiple scattering", "bias and whole albedo",
                 BrdfModel::multiple_scattering)};
}

}  // namespace welkin::report
