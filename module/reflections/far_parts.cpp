#include "reflections/far_parts.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "jobs/tiles.h"
#include "math/elementary.h"
#include "platform/memory.h"
#include "platform/standard_library.h"

namespace welkin::reflections {
namespace {

constexpr double kSameFarPart = 1e-3;  ///< of the far part, less of the lobe where it is not far

/// How many far parts do for e^-(T q) over e^range: see `far_place`. Interpolation at n places loses as the n-th power
/// of tanh(range / 4), whose loss at the widest range that was measured is not to be exceeded.
int parts_over(double range) noexcept {
  constexpr double most = 0.017;
  if (range < 2.0) return range < 0.5 ? 2 : range < 0.8 ? 3 : range < 1.3 ? 4 : 5;
  const double rise = math::exponential(0.5 * range);
  return static_cast<int>(std::ceil(math::logarithm(most) / math::logarithm((rise - 1.0) / (rise + 1.0))));
}

}  // namespace

double far_place(double largest, double alpha) noexcept {
  return math::exponential(-largest * alpha * alpha / ((1.0 - alpha) * (1.0 + alpha)));
}

std::vector<double> far_alphas(const NarrowSplit& split, const std::vector<double>& alphas) {
  std::vector<double> all = alphas;
  platform::ranges::sort(all);
  all.erase(std::unique(all.begin(), all.end()), all.end());
  if (all.empty()) return all;
  const double least = far_place(split.largest_far, all.back());
  const double most = far_place(split.largest_far, all.front());
  const double range = math::logarithm(most / least);
  const int count = parts_over(range);
  if (all.size() <= static_cast<std::size_t>(count)) return all;
  std::vector<double> some{all.front()};
  for (int k = 1; k + 1 < count; ++k) {
    const double cosine = math::sine_cosine_of_turns(0.5 * k / (count - 1)).cosine;
    const double place = 0.5 * (most + least) + 0.5 * (most - least) * cosine;
    const double q = -math::logarithm(place) / split.largest_far;
    some.push_back(std::sqrt(q / (1.0 + q)));
  }
  some.push_back(all.back());
  return some;
}

/// Of the parts that there are in the one of `alpha`.
std::vector<double> FarParts::shares(double alpha, double energy) const {
  const double y = far_place(largest, alpha);
  std::vector<double> shares(alphas.size());
  // where e^-Tq is as good as one of theirs, that part alone will do
  const auto same = platform::ranges::find_if(alphas, [&](double other) {
    return other == alpha || std::abs(y / far_place(largest, other) - 1.0) < kSameFarPart;
  });
  if (same != alphas.end()) {
    const auto at = static_cast<std::size_t>(same - alphas.begin());
    shares[at] = energy / energies[at];
    return shares;
  }
  double sum = 0.0;
  for (std::size_t k = 0; k < alphas.size(); ++k) {
    shares[k] = alpha * alpha / (alphas[k] * alphas[k]);
    for (std::size_t other = 0; other < alphas.size(); ++other) {
      if (other == k) continue;
      shares[k] *=
          (y - far_place(largest, alphas[other])) / (far_place(largest, alphas[k]) - far_place(largest, alphas[other]));
    }
    sum += shares[k] * energies[k];
  }
  for (double& share : shares) share *= energy / sum;
  return shares;
}

void FarParts::sample(double alpha, double energy, int size, const std::array<float*, 6>& faces,
                      const Control& control) const {
  const auto count = std::size_t{18} * static_cast<std::size_t>(size) * static_cast<std::size_t>(size);
  const std::vector<double> share = shares(alpha, energy);
  platform::AlignedBuffer<float> part;
  std::array<float*, 6> rooms{};
  bool first = true;
  for (std::size_t k = 0; k < alphas.size(); ++k) {
    if (share[k] == 0.0) continue;
    if (!first && part.size() == 0) {
      part = platform::AlignedBuffer<float>(count);
      for (std::size_t face = 0; face < 6; ++face) rooms[face] = part.data() + face * (count / 6);
    }
    const auto step = static_cast<double>(k) / static_cast<double>(alphas.size());
    image::sample_faces(grids[k], size, first ? faces : rooms, {},
                        jobs::part_of(control, step, step + 1.0 / static_cast<double>(alphas.size())));
    const auto scale = static_cast<float>(share[k]);
    for (std::size_t face = 0; face < 6 && !(first && scale == 1.0F); ++face) {
      for (std::size_t i = 0; i < count / 6; ++i)
        faces[face][i] = first ? scale * faces[face][i] : faces[face][i] + scale * rooms[face][i];
    }
    first = false;
  }
}

}  // namespace welkin::reflections
