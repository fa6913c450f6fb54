#include "reflections/brdf_table.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <memory>
#include <numbers>
#include <string>
#include <vector>

#include "jobs/control.h"
#include "jobs/tiles.h"
#include "math/elementary.h"
#include "math/quadrature.h"
#include "math/table_cache.h"
#include "platform/float_environment.h"
#include "platform/memory.h"
#include "simd/dispatch.h"
#include "welkin/core.h"
#include "welkin/reflections.h"

namespace welkin::reflections {
namespace {

struct Node {
  double position;  ///< in (0, 1)
  double weight;
};

/// Gauss's rule on [0, 1].
template <class Use>
void for_each_node(int order, const Use& use) {
  const math::GaussRule rule = math::gauss_legendre(order);
  for (int i = 0; i < order; ++i) use(Node{0.5 + 0.5 * rule.nodes[i], 0.5 * rule.weights[i]});
}

}  // namespace

AlbedoQuadrature::AlbedoQuadrature(const AlbedoOrders& orders, Radii radii) {
  const auto side = [&](int order, double sign) {
    for_each_node(order, [&](const Node& node) {
      // 90 degrees plus a quarter turn times x^2, x the position, whose differential is pi x dx. The cosine of that
      // azimuth is the sine of the angle from 90 degrees, with its digits near the edge.
      azimuth_cosines_.push_back(
          static_cast<float>(sign * math::sine_cosine_of_turns(0.25 * node.position * node.position).sine));
      azimuth_weights_.push_back(static_cast<float>(std::numbers::pi * node.position * node.weight));
    });
  };
  side(orders.towards, 1.0);
  side(orders.away, -1.0);
  for_each_node(orders.radii, [&](const Node& node) {
    const bool even = radii == Radii::even;
    // y -> 1 - (1 - y)^2, dy -> 2 (1 - y) dy
    const double left = 1.0 - node.position;
    radius_positions_.push_back(static_cast<float>(even ? node.position : 1.0 - left * left));
    radius_weights_.push_back(static_cast<float>(even ? node.weight : 2.0 * left * node.weight));
  });
}

AlbedoRule AlbedoQuadrature::rule() const noexcept {
  return {static_cast<int>(azimuth_cosines_.size()),  azimuth_cosines_.data(),  azimuth_weights_.data(),
          static_cast<int>(radius_positions_.size()), radius_positions_.data(), radius_weights_.data()};
}

AlbedoRules::AlbedoRules()
    : ggx_{{{{6, 10, 20}, Radii::even}, {{8, 9, 17}, Radii::even}, {{8, 9, 15}, Radii::even}}},
      sheen_{{{{14, 3, 16}, Radii::thinning}, {{10, 6, 13}, Radii::thinning}, {{9, 6, 10}, Radii::thinning}}} {}

AlbedoRule AlbedoRules::of(const std::array<AlbedoQuadrature, 3>& rules, double roughness) noexcept {
  return rules[roughness < 0.25 ? 0 : (roughness < 0.5 ? 1 : 2)].rule();
}

namespace {

// Albedo at Chebyshev points of angle and roughness, and polynomials between them.
//
// Albedo changes where N.V is as large as alpha, which may be anywhere over powers of ten, and like c log c at 0. In
// the eighth root of N.V it is smooth: a row of up to 256 columns follows from 16 to 64 points, a wider one from twice
// as many, and all rows of a roughness above 0.15 from 32. The error stays that of the quadrature.

constexpr int kMaxPoints = 128;
constexpr int kWide = 256;  ///< columns: wider tables reach so low that they take twice the points
constexpr int kRowPoints = 16;
constexpr std::size_t kSmall = 768;  ///< values of a table that is not worth waking threads

/// Rows of a roughness below `end`, and the points that their albedo takes along a row.
struct Band {
  double end;
  std::size_t ggx;
  std::size_t sheen;
  bool rows;  ///< whether it is a polynomial of the roughness too
};
constexpr std::array<Band, 3> kBands{{{0.15, 1, 2, false}, {0.5, 1, 0, true}, {1.0, 0, 0, true}}};

std::size_t index_of(int value) { return static_cast<std::size_t>(value); }

/// Chebyshev's points on [from, to], rising, and the polynomial through values there.
class ChebyshevPoints {
 public:
  ChebyshevPoints(int count, double from, double to) {
    for (int k = 0; k < count; ++k) {
      const math::SineCosine angle = math::sine_cosine_of_turns((k + 0.5) / (2.0 * count));
      positions_.push_back(0.5 * (from + to) - 0.5 * (to - from) * angle.cosine);
      weights_.push_back(k % 2 == 0 ? angle.sine : -angle.sine);
    }
  }

  [[nodiscard]] const std::vector<double>& positions() const noexcept { return positions_; }

  /// Writes each point's share of the value at `position`: the second barycentric formula, shares w_k / (x - x_k) over
  /// their sum, with w_k = (-1)^k sin((2 k + 1) pi / (2 n)) for Chebyshev's points of the first kind, but for a factor
  /// (Berrut and Trefethen 2004, "Barycentric Lagrange interpolation", eq. 5.3). It is stable and takes 2 n operations.
  void share(double position, float* shares, std::size_t stride) const noexcept {
    std::array<double, kMaxPoints> all{};
    double sum = 0.0;
    for (std::size_t k = 0; k < positions_.size(); ++k) {
      const double from = position - positions_[k];
      if (from == 0.0) {
        all = {};
        all[k] = sum = 1.0;
        break;
      }
      all[k] = weights_[k] / from;
      sum += all[k];
    }
    for (std::size_t k = 0; k < positions_.size(); ++k) shares[k * stride] = static_cast<float>(all[k] / sum);
  }

 private:
  std::vector<double> positions_;
  std::vector<double> weights_;  ///< barycentric
};

double eighth_root(double x) { return std::sqrt(std::sqrt(std::sqrt(x))); }

/// Where rows are integrated: at points, or at the texels themselves where those are no more.
struct Columns {
  Columns(int width, int points) {
    const auto cosine = [&](int column) { return (column + 0.5) / width; };
    if (width <= points) {  // what lies beyond the row is computed and dropped
      const int padded = (width + simd::kLanes - 1) / simd::kLanes * simd::kLanes;
      for (int k = 0; k < padded; ++k) cosines.push_back(static_cast<float>(cosine(std::min(k, width - 1))));
      return;
    }
    const ChebyshevPoints along(points, eighth_root(cosine(0)), eighth_root(cosine(width - 1)));
    for (const double root : along.positions()) {
      const double square = root * root;
      cosines.push_back(static_cast<float>((square * square) * (square * square)));
    }
    shares.resize(index_of(width) * cosines.size());
    for (int column = 0; column < width; ++column)
      along.share(eighth_root(cosine(column)), shares.data() + column, index_of(width));
  }

  std::vector<float> cosines;  ///< a multiple of `simd::kLanes`
  std::vector<float> shares;   ///< each point's of each column: shares[point][column]; empty: `cosines` are the texels'
};

/// The rows [begin, end) of a band.
struct Rows {
  Rows(const Band& band, int height, int first_row, const Columns& ggx_columns, const Columns& sheen_columns)
      : begin(first_row), end(first_row), ggx(ggx_columns), sheen(sheen_columns) {
    const auto at = [&](int row) { return (row + 0.5) / height; };
    while (end < height && at(end) < band.end) ++end;
    if (!band.rows || end - begin <= kRowPoints) {
      for (int row = begin; row < end; ++row) roughness.push_back(at(row));
      return;
    }
    const ChebyshevPoints down(kRowPoints, at(begin), at(end - 1));
    roughness = down.positions();
    shares.resize(index_of(end - begin) * kRowPoints);
    for (int row = begin; row < end; ++row) down.share(at(row), shares.data() + index_of(row - begin) * kRowPoints, 1);
  }

  [[nodiscard]] std::size_t values() const noexcept { return 2 * ggx.cosines.size() + sheen.cosines.size(); }

  int begin;
  int end;
  const Columns& ggx;
  const Columns& sheen;
  std::vector<double> roughness;  ///< where they are integrated
  std::vector<float> shares;      ///< shares[row][sample]; empty: a sample is a row
  std::size_t first = 0;          ///< of the first sample's values
};

/// Writes the whole, the Fresnel and the sheen albedo at a sample's points, one after the other.
void integrate(const BrdfKernels& kernels, const AlbedoRules& rules, const Rows& rows, double roughness, bool sheen,
               float* values) {
  const auto alpha = static_cast<float>(roughness * roughness);
  const std::vector<float>& ggx = rows.ggx.cosines;
  for (std::size_t k = 0; k < ggx.size(); k += simd::kLanes)
    kernels.directional_albedo(rules.ggx(roughness), alpha, ggx.data() + k, values + k, values + ggx.size() + k);
  const std::vector<float>& of_sheen = rows.sheen.cosines;
  for (std::size_t k = 0; sheen && k < of_sheen.size(); k += simd::kLanes)
    kernels.sheen_albedo(rules.sheen(roughness), alpha, of_sheen.data() + k, values + 2 * ggx.size() + k);
}

constexpr int kBlock = 64;  ///< columns

/// Writes `count` columns from `first` on of what has those values at the points. Light is never negative.
void interpolate(const Columns& columns, int width, int first, int count, const float* values, float* to) {
  if (columns.shares.empty()) {
    std::copy_n(values + first, count, to);
    return;
  }
  std::fill_n(to, count, 0.0F);
  for (std::size_t k = 0; k < columns.cosines.size(); ++k) {
    const float* const shares = columns.shares.data() + k * index_of(width) + first;
    for (int column = 0; column < count; ++column) to[column] += shares[column] * values[k];
  }
  for (int column = 0; column < count; ++column) to[column] = std::max(to[column], 0.0F);
}

void fill_row(const Rows& rows, int row, const float* samples, BrdfTable& table) {
  const int width = table.options.width;
  const std::size_t values = rows.values();
  const auto index = index_of(row - rows.begin);
  std::array<float, std::size_t{3} * kMaxPoints> mixed{};
  const float* line = samples + rows.first + index * values;
  if (!rows.shares.empty()) {
    for (std::size_t j = 0; j < kRowPoints; ++j) {
      const float share = rows.shares[index * kRowPoints + j];
      const float* const sample = samples + rows.first + j * values;
      for (std::size_t k = 0; k < values; ++k) mixed[k] += share * sample[k];
    }
    line = mixed.data();
  }
  float* out = table.values.data() + index_of(row) * index_of(width) * index_of(table.channels);
  for (int first = 0; first < width; first += kBlock) {
    const int count = std::min(kBlock, width - first);
    std::array<float, kBlock> whole{};
    std::array<float, kBlock> fresnel{};
    std::array<float, kBlock> sheen{};
    const std::size_t points = rows.ggx.cosines.size();
    interpolate(rows.ggx, width, first, count, line, whole.data());
    interpolate(rows.ggx, width, first, count, line + points, fresnel.data());
    if (table.options.sheen) interpolate(rows.sheen, width, first, count, line + 2 * points, sheen.data());
    const bool split = table.options.model == BrdfModel::split_sum;
    for (std::size_t k = 0; k < index_of(count); ++k, out += table.channels) {
      out[0] = split ? std::max(whole[k] - fresnel[k], 0.0F) : fresnel[k];
      out[1] = split ? fresnel[k] : whole[k];
      if (table.options.sheen) out[2] = sheen[k];
    }
  }
}

}  // namespace

std::shared_ptr<const BrdfTable> integrated_brdf(const BrdfTableOptions& options, const Control& control) {
  auto table = std::make_shared<BrdfTable>();
  table->options = options;
  table->channels = options.sheen ? 3 : 2;
  table->values.resize(brdf_values(options));
  const AlbedoRules rules;
  const BrdfKernels& kernels = brdf_kernels();
  const int points = options.width > kWide ? 32 : 16;
  const std::array<Columns, 3> columns{Columns(options.width, points), Columns(options.width, 2 * points),
                                       Columns(options.width, 4 * points)};
  std::vector<Rows> bands;
  std::size_t values = 0;
  std::size_t samples = 0;
  for (const Band& band : kBands) {
    const int begin = bands.empty() ? 0 : bands.back().end;
    Rows& rows = bands.emplace_back(band, options.height, begin, columns[band.ggx], columns[band.sheen]);
    rows.first = values;
    values += rows.values() * rows.roughness.size();
    samples += rows.roughness.size();
  }
  platform::AlignedBuffer<float> integrated(values);
  const auto placement = brdf_values(options) <= kSmall ? jobs::Placement::calling_thread : jobs::Placement::arena;
  const std::size_t workers = jobs::worker_count(placement);
  const double integrating = 1.0 / (1.0 + options.height / 1000.0);  // fraction of the time
  const Control first_part = jobs::part_of(control, 0.0, integrating);
  jobs::run_tiles(samples, placement, workers, first_part, [&](std::size_t sample, std::size_t /*worker*/) {
    const Rows* rows = bands.data();
    for (; sample >= rows->roughness.size(); ++rows) sample -= rows->roughness.size();
    integrate(kernels, rules, *rows, rows->roughness[sample], options.sheen,
              integrated.data() + rows->first + sample * rows->values());
  });
  const Control second_part = jobs::part_of(control, integrating, 1.0);
  jobs::run_tiles(index_of(options.height), placement, workers, second_part,
                  [&](std::size_t row, std::size_t /*worker*/) {
                    const Rows* rows = bands.data();
                    while (static_cast<int>(row) >= rows->end) ++rows;
                    fill_row(*rows, static_cast<int>(row), integrated.data(), *table);
                  });
  return table;
}

}  // namespace welkin::reflections

namespace welkin {
namespace {

constexpr int kLargestEdge = 4096;
constexpr std::size_t kCacheBytes = std::size_t{32} << 20U;  ///< some 650 tables of 64 x 64, or two of 1024 x 1024

void check_edge(const char* which, int edge) {
  if (edge >= 1 && edge <= kLargestEdge) return;
  throw Error(ErrorCode::invalid_argument, "a BRDF table's " + std::string(which) + " is " + std::to_string(edge) +
                                               "; pass 1 to " + std::to_string(kLargestEdge));
}

}  // namespace

std::size_t reflections::brdf_values(const BrdfTableOptions& options) noexcept {
  return static_cast<std::size_t>(options.width) * static_cast<std::size_t>(options.height) *
         static_cast<std::size_t>(options.sheen ? 3 : 2);
}

void reflections::check_brdf(const BrdfTableOptions& options) {
  check_edge("width", options.width);
  check_edge("height", options.height);
}

std::shared_ptr<const BrdfTable> reflections::shared_brdf(const BrdfTableOptions& options, const Control& control,
                                                          bool& made) {
  check_brdf(options);
  made = true;
  jobs::throw_if_cancelled(control);
  // Tables too large to keep are made without the cache: a caller that waits there for the same one cannot be stopped.
  if (reflections::brdf_values(options) * sizeof(float) > kCacheBytes)
    return reflections::integrated_brdf(options, control);
  static auto& cache = *new math::TableCache<BrdfTableOptions, BrdfTable>(kCacheBytes);  // never destroyed
  made = false;
  std::shared_ptr<const BrdfTable> table = cache.get(options, [&] {
    made = true;
    return reflections::integrated_brdf(options, control);
  });
  if (!made && control.progress) control.progress(1.0);
  return table;
}

std::shared_ptr<const BrdfTable> brdf_table(const BrdfTableOptions& options, const Control& control) {
  const platform::FloatingPointScope floating_point;
  bool made = false;
  return reflections::shared_brdf(options, control, made);
}

}  // namespace welkin
