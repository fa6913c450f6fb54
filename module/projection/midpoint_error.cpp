#include "projection/midpoint_error.h"

#include <algorithm>
#include <cmath>

#include "math/basis.h"
#include "math/quadrature.h"
#include "math/table_cache.h"
#include "transform/frame_transform.h"
#include "welkin/spherical_harmonics.h"

namespace welkin::projection {
namespace {

constexpr std::size_t kCacheBytes = std::size_t{4} << 20U;
constexpr int kMaxSamples = 24;    ///< along the edge of a quadrant: bands below 16 have two waves there
constexpr double kBetween = 1.15;  ///< times the largest of the samples, for texels between them
constexpr double kRidge = 1e-10;   ///< of the mean square: keeps the combination's factors, and what they make of
                                   ///< rounded sums, below 1e5 d

struct Key {
  int size;
  int bands;
  bool operator==(const Key&) const = default;
};

/// Solves `matrix` x = b for each row b of `right`, in weight_rows, by Cholesky's way. Both are [n][n]; the first is
/// symmetric and positive definite.
void solve(std::vector<double>& matrix, int n, double* right) {
  const auto at = [n](int row, int column) { return static_cast<std::size_t>(row * n + column); };
  // matrix = L L^T, column by column, in its lower triangle: L_ij = (m_ij - sum over k < j of L_ik L_jk) / L_jj. Then L
  // y = b downwards and L^T x = y upwards.
  for (int j = 0; j < n; ++j) {
    for (int i = j; i < n; ++i) {
      double sum = matrix[at(i, j)];
      for (int k = 0; k < j; ++k) sum -= matrix[at(i, k)] * matrix[at(j, k)];
      matrix[at(i, j)] = i == j ? std::sqrt(sum) : sum / matrix[at(j, j)];
    }
  }
  for (int row = 0; row < n; ++row) {
    double* const x = right + static_cast<std::ptrdiff_t>(row) * n;
    for (int i = 0; i < n; ++i) {
      for (int k = 0; k < i; ++k) x[i] -= matrix[at(i, k)] * x[k];
      x[i] /= matrix[at(i, i)];
    }
    for (int i = n - 1; i >= 0; --i) {
      for (int k = i + 1; k < n; ++k) x[i] -= matrix[at(k, i)] * x[k];
      x[i] /= matrix[at(i, i)];
    }
  }
}

}  // namespace

/// Some texels of the quadrant: harmonics at their centres and what those differ by from the means over the texels,
/// both in the order of the weights.
struct MidpointError::Samples {
  Samples(int size, int bands, const std::vector<int>& weight_rows)
      : functions(bands * bands), values(static_cast<std::size_t>(functions)) {
    // A face's four quadrants are mirror images, so one is enough. Samples are evenly spaced over it and include the
    // texels at the face's middle, at an edge's middle and at a corner.
    const int half = (size + 1) / 2;
    const int across = std::min(half, kMaxSamples);
    const auto texel = [&](int k) { return across > 1 ? k * (half - 1) / (across - 1) : 0; };
    for (int row = 0; row < across; ++row) {
      for (int column = 0; column < across; ++column) add(size, bands, weight_rows, texel(row), texel(column));
    }
  }

  void add(int size, int bands, const std::vector<int>& weight_rows, int row, int column) {
    const double h = 1.0 / size;
    const double u = (2 * column + 1) * h - 1.0;
    const double v = (2 * row + 1) * h - 1.0;
    const std::size_t first = centres.size();
    centres.resize(first + values.size());
    off.resize(first + values.size());
    const auto put = [&](double x, double y, double share, std::vector<double>& to) {
      const double r = std::sqrt(1.0 + x * x + y * y);
      math::evaluate_basis(x / r, y / r, 1.0 / r, bands, values.data());
      for (std::size_t k = 0; k < values.size(); ++k)
        to[first + static_cast<std::size_t>(weight_rows[k])] += share * values[k];
    };
    // off = Y(centre) - (1 / W) sum over the rule's points of h^2 w_i w_j r^-3 Y, W the same sum without Y: what the
    // midpoint rule has too much per unit of a texel's light.
    put(u, v, 1.0, centres);
    put(u, v, 1.0, off);
    const math::GaussRule rule = math::texel_rule(size);
    const double whole = math::rectangle_solid_angle(u, v, h, h, rule);
    for (int j = 0; j < rule.order; ++j) {
      for (int i = 0; i < rule.order; ++i) {
        const double x = u + h * rule.nodes[i];
        const double y = v + h * rule.nodes[j];
        const double squared = 1.0 + x * x + y * y;
        put(x, y, -h * h * rule.weights[i] * rule.weights[j] / (squared * std::sqrt(squared)) / whole, off);
      }
    }
  }

  [[nodiscard]] std::size_t count() const noexcept { return centres.size() / values.size(); }

  int functions;
  std::vector<double> values;
  std::vector<double> centres;  ///< [sample][functions]
  std::vector<double> off;      ///< [sample][functions]
};

std::shared_ptr<const MidpointError> MidpointError::get(int size, int bands, const TexelWeights& weights) {
  static auto& cache = *new math::TableCache<Key, MidpointError>(kCacheBytes);  // never destroyed
  return cache.get({size, bands}, [&] { return std::make_shared<const MidpointError>(size, bands, weights); });
}

MidpointError::MidpointError(int size, int bands, const TexelWeights& weights)
    : bands_(bands), weight_rows_(weights.weight_rows()), counts_(weights.class_counts()) {
  combine(Samples(size, bands, weight_rows_));
}

// Each class has its own least squares: C minimizes sum over samples |off - C centre|^2 + lambda |C|^2. Its rows solve
// (G + lambda 1) C_a = R_a with G = sum centre centre^T, R = sum off centre^T and lambda = kRidge trace(G) / n. In a
// direction of singular value s the gain is s / (s^2 + lambda) <= 1 / (2 sqrt(lambda)), so no entry of C exceeds 5e4
// |off| / sqrt(trace(G) / n), |off|^2 being the sum over all samples, however alike the functions are on few texels.
//
// A projection's sums S = sum L w centre then have the error sum L w off = C S + sum L w left, and the norm of the last
// sum is at most sum L w max |left|: the light times `beyond_`.
void MidpointError::combine(const Samples& samples) {
  const auto functions = static_cast<std::size_t>(samples.functions);
  std::vector<double> left(samples.off);
  std::size_t first = 0;
  for (const int count : counts_.count) {
    const auto n = static_cast<std::size_t>(count);
    std::vector<double> gram(n * n);
    const std::size_t begin = combination_.size();
    combination_.resize(begin + n * n);
    double* const rows = combination_.data() + begin;
    double trace = 0.0;
    for (std::size_t s = 0; s < samples.count(); ++s) {
      const double* const centre = samples.centres.data() + s * functions + first;
      const double* const off = samples.off.data() + s * functions + first;
      for (std::size_t a = 0; a < n; ++a) {
        for (std::size_t b = 0; b < n; ++b) {
          gram[a * n + b] += centre[a] * centre[b];
          rows[a * n + b] += off[a] * centre[b];
        }
        trace += centre[a] * centre[a];
      }
    }
    for (std::size_t a = 0; a < n; ++a) gram[a * n + a] += kRidge * trace / static_cast<double>(n);
    if (trace > 0.0) solve(gram, count, rows);  // a lone texel's centre has no odd functions
    for (std::size_t s = 0; s < samples.count(); ++s) {
      const double* const centre = samples.centres.data() + s * functions + first;
      for (std::size_t a = 0; a < n; ++a) {
        for (std::size_t b = 0; b < n; ++b) left[s * functions + first + a] -= rows[a * n + b] * centre[b];
      }
    }
    first += n;
  }
  for (std::size_t s = 0; s < samples.count(); ++s) {
    double square = 0.0;
    for (std::size_t f = 0; f < functions; ++f) square += left[s * functions + f] * left[s * functions + f];
    beyond_ = std::max(beyond_, kBetween * std::sqrt(square));
  }
}

void MidpointError::add(int face, const double* face_sums, double* canonical) const noexcept {
  // C S, class by class, in the face's frame, and then to the world's like the sums themselves.
  double off[3 * kMaximumBands * kMaximumBands];
  const int functions = bands_ * bands_;
  for (int channel = 0; channel < 3; ++channel) {
    const double* row = combination_.data();
    int first = channel * functions;
    for (const int count : counts_.count) {
      for (int a = 0; a < count; ++a, row += count) {
        off[first + a] = 0.0;
        for (int b = 0; b < count; ++b) off[first + a] += row[b] * face_sums[first + b];
      }
      first += count;
    }
  }
  transforms::face_transform(face, bands_).add(off, weight_rows_.data(), canonical);
}

}  // namespace welkin::projection
