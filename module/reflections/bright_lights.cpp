// The sums of bright lights' lobes, and what they err.
#include "reflections/bright_lights.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <glm/geometric.hpp>
#include <glm/vec3.hpp>
#include <memory>
#include <mutex>
#include <numbers>
#include <utility>

#include "image/geometry.h"
#include "jobs/tiles.h"
#include "reflections/light_field.h"
#include "reflections/lobe.h"

namespace welkin::reflections {
namespace {

constexpr double kPi = std::numbers::pi;

constexpr int kSmallMip = 64;  ///< mips below that end with areas of `kPartEdge`, over which no field is interpolated

constexpr double kHorizon =
    0.1;  ///< of what the horizon cuts, times the square of a part's size: docs/maths/reflections.md
constexpr double kLost = 5e-6;      ///< of the lights' field, at least: float sums, and the reference's own error
constexpr double kMerged = 1.5e-4;  ///< of merged lights at `kFar`, in the mean
constexpr double kField = 1e-5;     ///< of lights that are interpolated, at `kFar`: falls with its fourth power too

// Constants of lobes in tables. They were fitted in several rounds to some hundred random environments
// (docs/maths/reflections.md). Over its scale:
constexpr double kMergedOfScale = 0.4;  ///< most radius of a node
constexpr double kFieldOfScale = 0.25;  ///< most radius of a block with a field
constexpr double kWidestField = 0.2;    ///< of directions over a face
constexpr double kOfMerged = 6e-3;      ///< times the fourth power
constexpr double kOfField = 9e-3;       ///< times the fourth power
constexpr double kTableHorizon = 3e-4;  ///< of what the horizon cuts
constexpr double kAnnularHorizon = 2e-4;
constexpr double kOfLean = 2e-3;  ///< of annular lobes: parts next to a pole are no parallelograms

/// Returns what `points` along an edge of `radians` lose of a smooth lobe, in the mean: fits to Gauss' error terms for
/// 1 / (1 + x^2)^2.
double smooth_error(double radians, double alpha, int points) {
  const double edge = radians / (2.0 * alpha);
  const double square = edge * edge;
  if (points == 2) return square * square / 40.0;
  if (points == 3) return square * square * square / 200.0;
  return points == 4 ? square * square * square * square / 1000.0 : 1e-5;
}

/// Returns the error for other lobes: fits to Gauss' error terms for a bell of which `alpha` is 2.2 standard
/// deviations. Over half an edge h the mean by n points errs by h^(2 n) f^(2 n) times 1/270, 1/31500, 1/6945750 and
/// 4.04e-10 for n = 2, 3, 4 and 5. In units of 2 alpha h is edge / 2 and the bell's deviation 1 / 4.4, so at its peak
/// f^(4) = 3 4.4^4, f^(6) = 15 4.4^6, f^(8) = 105 4.4^8 and f^(10) = 945 4.4^10: 0.26 edge^4, 0.054 edge^6, 8.3e-3
/// edge^8 and 1.0e-3 edge^10. The root mean square over all places and both axes, over the bell's own, is 1.0 to 1.3
/// times that.
double smooth_table_error(double radians, double alpha, int points) {
  const double edge = radians / (2.0 * alpha);
  const double square = edge * edge;
  const double fourth = square * square;
  if (points == 2) return 0.26 * fourth;
  if (points == 3) return 0.054 * fourth * square;
  return points == 4 ? 8e-3 * fourth * fourth : 1e-3 * fourth * fourth * square;
}

}  // namespace

double BrightLights::ggx_error(double alpha, int size, double rms) const {
  const double square = alpha * alpha;
  const double integral = lobe_integral(alpha);
  // the lobe's slope there is alpha^2 / (pi width^2) per unit of the cosine, over its integral
  const double width = 0.5 * (1.0 + square);  // alpha^2 + (1 - c) (1 - alpha^2) / 2 at c = 0
  const double horizon = kHorizon * square / kPi / integral / (width * width) * glm::length(cut_);
  // Int k^2 is at most its peak times Int k, and less for a narrow lobe
  const double squares = std::min(integral / (kPi * square), 4.0 / (3.0 * kPi * square * std::max(1e-9, 1.0 - square)));
  const double of_width = std::min(1.0, far_ * most_merged_ * std::sqrt(1.0 - square) / (2.0 * alpha)) * kFar / far_;
  const double share = kMerged * of_width * of_width * of_width * of_width;
  const double smooth = smooth_error(edge_, alpha, smooth_points_);
  const double looser = kFar / far_;
  const double interpolated = size < kSmallMip ? 0.0 : kField * looser * looser * looser * looser;
  const double lost = kLost + std::sqrt(share * share + smooth * smooth + interpolated * interpolated);
  const double field =
      glm::length(power_) * std::sqrt(squares / (4.0 * kPi)) / integral;  // of one light with all of it
  const double merged = lost * std::min(field, rms);
  return std::sqrt(horizon * horizon + merged * merged);
}

double BrightLights::table_error(const Lobe& lobe, int size, double rms) const {
  const auto fourth_power = [](double x) { return x * x * x * x; };
  const double tighter = kFar / far_;
  const double scale = lobe.table().smooth_scale;
  double widest = 0.0;  // of the nodes whose rule is used
  for (const Node& node : nodes_) {
    if (node.merged <= kMergedOfScale * tighter * scale) widest = std::max(widest, node.merged);
  }
  const double node = kOfMerged * fourth_power(widest / scale);
  const bool fields = size >= kSmallMip;  // no block of a smaller one is as small as `kWidestField`
  const double block = fields ? kOfField * fourth_power(std::min(kFieldOfScale * tighter, kWidestField / scale)) : 0.0;
  const double smooth = lobe.annular() ? 0.0 : smooth_table_error(edge_, lobe.width_alpha(), smooth_points_);
  const double field = glm::length(power_) * std::sqrt(lobe.square() / (4.0 * kPi));
  // A mip of few texels may see the lights' flanks alone, which err by more of their value than the peaks.
  const bool misses = 0.5 * kPi / size > lobe.scale();
  const double seen = misses ? std::sqrt(field * std::min(field, rms)) : std::min(field, rms);
  const double shape = lobe.annular() && squares_ > 0.0 ? kOfLean * std::sqrt(leaning_ / squares_) : 0.0;
  const double merged = (kLost + shape + std::sqrt(node * node + block * block + smooth * smooth)) * seen;
  // A light errs by its size times the slope, on a fraction of the sphere that is as wide. Errors are independent.
  const double slope = lobe.horizon_slope() + (lobe.hemisphere() ? std::abs(lobe.value(1e-6)) / edge_ : 0.0);
  const double horizon = (lobe.annular() ? kAnnularHorizon : kTableHorizon) * slope * std::sqrt(cut_square_);
  // Elsewhere a break lies between a texel's points.
  const double broken = lobe.bends() ? lobe.peak() * std::sqrt(squares_ * edge_) / smooth_points_ : 0.0;
  return std::sqrt(horizon * horizon + merged * merged + broken * broken);
}

double BrightLights::error(const Lobe& lobe, int size, double rms) const {
  if (nodes_.empty()) return 0.0;
  return lobe.alpha() > 0.0 ? ggx_error(lobe.alpha(), size, rms) : table_error(lobe, size, rms);
}

/// A lobe, and what all blocks need of it.
struct BrightLights::Blur : LightsLobe {
  LobeBlock shape{};             ///< all but the texels
  float scale = 1.0F;            ///< of the kernels' sums
  double far = kFar;             ///< see `kFar`
  double width_squared = 0.0;    ///< of GGX: it has its poles at such distances, squared and negative
  double smooth = 0.0;           ///< of GGX, see `even_enough`
  bool by_table = false;         ///< whatever the distance, the radii below decide
  double most_merged = 0.0;      ///< the radius over which the lobe is all but a polynomial
  double widest = kWidestField;  ///< radius up to which a field over a block is all but a cubic
  bool annular = false;          ///< a leaf is seen as a parallelogram
  bool horizon = true;           ///< whether nothing comes from below it
  double nearest = 0.0;          ///< distance of a light, less and more of which nothing is seen
  double farthest = 2.0;
  double left_out = 0.0;  ///< see `add`
};

/// Where all lights together would be dimmer than `least` at a distance, none is looked at that is farther: at the
/// chord d the lobe is at most peak / (alpha^2 + (1 - alpha^2) d^2 / 4)^2, as 1 - c = d^2 / 2. `width` is the bracket
/// at which that times the largest channel of all light is `least`.
BrightLights::Blur BrightLights::blur_of(const LightsLobe& lights) const {
  constexpr double kSmoothOfFar = 3.0;  // at 9 radii 1 / distance^4 is within 2e-4 of its cubic at worst
  const Lobe& lobe = lights.lobe;
  const double square = lobe.alpha() * lobe.alpha();
  Blur blur{lights};
  blur.far = far_;
  blur.smooth = kSmoothOfFar * far_;
  blur.horizon = lobe.hemisphere();
  blur.nearest = 2.0 * lobe.nearest();
  if (square == 0.0) {
    find_table(blur);
    return blur;
  }
  // alpha^2 + (1 - alpha^2) d^2 / 4 is 0 at d^2 = -4 alpha^2 / (1 - alpha^2)
  blur.width_squared = 4.0 * square / std::max(1e-6, 1.0 - square);
  blur.shape.alpha_squared = static_cast<float>(square);
  blur.shape.half_slope = static_cast<float>(0.25 * (1.0 - square));
  blur.shape.far_scale = static_cast<float>(lights.far_end > 0.0 ? 1.0 / (lights.far_end * (1.0 - square)) : 0.0);
  const double peak = square / kPi / lobe_integral(lobe.alpha());  // times 1 / width^2
  blur.scale = static_cast<float>(peak);
  if (lights.least > 0.0 && square < 1.0) {
    const double width = std::sqrt(peak * std::max({power_.r, power_.g, power_.b}) / lights.least);
    blur.farthest = std::min(2.0, std::sqrt(std::max(0.0, 4.0 * (width - square) / (1.0 - square))));
    if (blur.farthest < 2.0) blur.left_out = lights.least;
  }
  return blur;
}

/// Sets the limits by which a lobe with a table decides: distances, sizes and fields of lights.
void BrightLights::find_table(Blur& blur) {
  constexpr double kSmall = 0.2;  // size of a light, which is 100 times its `least`: see `smooth_points`
  const Lobe& lobe = blur.lobe;
  const KernelTable& table = lobe.table();
  const double scale = kFar / blur.far * table.smooth_scale;
  blur.by_table = true;
  blur.widest = std::min(kWidestField, kFieldOfScale * scale);
  blur.most_merged = kMergedOfScale * scale;
  blur.annular = lobe.annular();
  blur.farthest = 2.0 * lobe.farthest();
  LobeBlock& shape = blur.shape;
  shape.half_slope = 0.25F;
  shape.lines = table.lines.data();
  shape.cells = table.cells();
  shape.first_cell = static_cast<float>(table.first_cell);
  shape.cells_of_s = static_cast<float>(table.cells_of_s);
  shape.nearest = static_cast<float>(4.0 * lobe.nearest() * lobe.nearest());
  shape.farthest = static_cast<float>(4.0 * lobe.farthest() * lobe.farthest());
  shape.twice_integrated = table.twice_integrated.data();
  shape.cosine_cells = table.cosine_cells();
  shape.cells_of_c = static_cast<float>(table.cells_of_c);
  shape.small = static_cast<float>(0.01 * kSmall * lobe.scale());
  shape.annular = blur.annular;
}

/// Some texels of a face that lie together.
struct BrightLights::Block {
  Block(const FaceArea& area, const Blur& lobe_of_all)
      : lobe(lobe_of_all),
        centre(area.direction(0.5 * (area.column + area.end_column), 0.5 * (area.row + area.end_row))) {
    for (const double column : {area.column + 0.5, area.end_column - 0.5}) {
      for (const double row : {area.row + 0.5, area.end_row - 0.5})
        radius = std::max(radius, glm::length(area.direction(column, row) - centre));
    }
    radius += 1e-6;
  }

  const Blur& lobe;
  glm::dvec3 centre;
  double radius = 0.0;

  enum class Sight { below, cut, above };

  [[nodiscard]] double distance_to(const Node& node) const noexcept { return glm::length(centre - node.centre); }

  /// n.s is at least that of the two centres less both radii: n.s - n0.s0 = (n - n0).s + n0.(s - s0), where |s| = 1 and
  /// |n0| = 1.
  [[nodiscard]] Sight sight_of(const Node& node) const noexcept {
    if (!lobe.horizon) return Sight::above;
    const double between = glm::dot(centre, node.centre);
    const double margin = radius + node.radius;
    return between < -margin ? Sight::below : (between > margin ? Sight::above : Sight::cut);
  }
  [[nodiscard]] bool unseen(const Node& node) const noexcept {
    if (lobe.nearest <= 0.0 && lobe.farthest >= 2.0) return false;
    const double distance = distance_to(node);
    const double margin = radius + node.radius;
    return distance + margin < lobe.nearest || distance - margin > lobe.farthest;
  }
  [[nodiscard]] bool far_enough(const Node& node) const noexcept {
    if (lobe.by_table) return node.merged <= lobe.most_merged && (node.merged > 0.0 || !lobe.annular);
    const double distance = std::max(0.0, distance_to(node) - radius);
    return distance * distance + lobe.width_squared >= lobe.far * lobe.far * node.merged * node.merged;
  }
  /// Returns whether the node's light, all of it above the horizon, is all but a cubic over the block along each axis.
  [[nodiscard]] bool even_enough(const Node& node) const noexcept {
    if (lobe.by_table || radius > lobe.widest) return radius <= lobe.widest;
    const double distance = std::max(0.0, distance_to(node) - node.radius);
    return distance * distance + lobe.width_squared >= lobe.smooth * lobe.smooth * radius * radius;
  }
};

namespace {

constexpr int kLeafEdge = LightField::kMaxEdge;
constexpr int kLeafTexels = kLeafEdge * kLeafEdge;
constexpr int kTileEdge = LightField::kMaxWidth;  ///< of the areas that threads share out
constexpr int kWideBlocks = 8;  ///< of mips up to this a block of parts would be as wide as from a peak to its horizon
constexpr int kPartEdge = 4;    ///< of parts of a block, about each of which is decided what the horizon cuts
constexpr int kMaxLevels = 6;   ///< areas within each other, the parts of a leaf included
static_assert(LightField::kPoints == kLobeTexels);

/// Calls `use` with the parts of an area, at most `across` by `down` texels.
template <class Use>
void for_each_part(const FaceArea& area, int across, int down, const Use& use) {
  for (int row = area.row; row < area.end_row; row += down) {
    for (int column = area.column; column < area.end_column; column += across)
      use(FaceArea{area.face, area.size, column, row, std::min(column + across, area.end_column),
                   std::min(row + down, area.end_row)});
  }
}

void add_run(const LobeRun& run, std::vector<LobeRun>& runs) {
  if (!runs.empty() && runs.back().first + runs.back().count == run.first) {
    runs.back().count += run.count;
  } else {
    runs.push_back(run);
  }
}

}  // namespace

/// A worker's scratch for one area. Nothing is allocated inside tiles: nodes in a list have no leaf in common, so that
/// one element per leaf suffices.
struct BrightLights::Scratch {
  explicit Scratch(std::size_t leaves) {
    stack.reserve(leaves);
    pending.reserve(kMaxLevels * leaves);
    for (std::vector<LobeRun>* list : {&runs, &parts}) list->reserve(leaves);
  }

  [[nodiscard]] static constexpr std::size_t bytes(std::size_t leaves) noexcept {
    return sizeof(Scratch) + leaves * ((1 + kMaxLevels) * sizeof(int) + 2 * sizeof(LobeRun));
  }

  std::array<float, kLeafTexels> u{};
  std::array<float, kLeafTexels> v{};
  std::array<float, 3 * kLeafTexels> sums{};
  std::vector<int> stack;      ///< nodes that are still to be looked at
  std::vector<int> pending;    ///< nodes that are left to the parts of an area; below them, those of wider areas
  std::vector<LobeRun> runs;   ///< of lights
  std::vector<LobeRun> parts;  ///< of cut lights
};

std::size_t BrightLights::most_bytes(std::size_t texels, const ImageShape& shape, const LightLobes& lobes,
                                     std::size_t workers) noexcept {
  const std::size_t leaves = most_leaves(texels, shape, lobes);
  return tree_bytes(texels, leaves, shape, lobes) + workers * Scratch::bytes(leaves);
}

/// As many scratches as there are workers, for all mips together: a tile takes one while it runs.
class BrightLights::ScratchPool {
 public:
  ScratchPool(std::size_t workers, std::size_t leaves) : leaves_(leaves) {
    free_.reserve(workers);
    while (free_.size() < workers) free_.push_back(std::make_unique<Scratch>(leaves));
  }

  [[nodiscard]] std::unique_ptr<Scratch> take() {
    const std::scoped_lock lock(mutex_);
    if (free_.empty()) return std::make_unique<Scratch>(leaves_);  // there are more threads than there were
    std::unique_ptr<Scratch> scratch = std::move(free_.back());
    free_.pop_back();
    return scratch;
  }
  void give_back(std::unique_ptr<Scratch> scratch) {
    const std::scoped_lock lock(mutex_);
    free_.push_back(std::move(scratch));
  }

 private:
  std::size_t leaves_;
  std::mutex mutex_;
  std::vector<std::unique_ptr<Scratch>> free_;
};

void BrightLights::make_scratch() {
  scratches_ = std::make_shared<ScratchPool>(jobs::worker_count(jobs::Placement::arena), (nodes_.size() + 1) / 2);
}

/// Takes the stack's nodes to `runs`, and those that parts of the area must look at to `pending`; in the last parts,
/// what the horizon cuts to its texels' parts.
void BrightLights::choose(const Block& block, Step step, Scratch& scratch) const {
  while (!scratch.stack.empty()) {
    const int index = scratch.stack.back();
    const Node& node = nodes_[static_cast<std::size_t>(index)];
    scratch.stack.pop_back();
    const Block::Sight sight = block.sight_of(node);
    if (sight == Block::Sight::below || block.unseen(node)) continue;
    const bool leaf = node.children[0] < 0;
    const bool cut = sight == Block::Sight::cut;
    const bool has_parts = leaf || ((cut || block.lobe.annular) && node.parts.count > 0);
    const bool as_parts = block.lobe.annular && has_parts;
    if (!cut && (leaf || as_parts || (node.smooth.count > 0 && block.far_enough(node))) &&
        (step != Step::field || block.even_enough(node))) {
      add_run(as_parts ? node.parts : node.smooth, as_parts ? scratch.parts : scratch.runs);
    } else if (step != Step::parts && (cut || step == Step::field) && (has_parts || node.radius < block.radius)) {
      scratch.pending.push_back(index);
    } else if (has_parts) {
      add_run(node.parts, scratch.parts);
    } else {
      scratch.stack.push_back(node.children[1]);
      scratch.stack.push_back(node.children[0]);
    }
  }
}

/// Adds the lights of `scratch`'s runs at its first `count` points, a multiple of `kLobeTexels`, to its sums, and
/// forgets them.
void BrightLights::sum_runs(int face, int count, const Blur& lobe, Scratch& scratch) const {
  const image::Frame& frame = image::face_frame(face);
  LobeBlock of = lobe.shape;
  of.u = scratch.u.data();
  of.v = scratch.v.data();
  of.count = count;
  for (int axis = 0; axis < 3; ++axis) {
    of.normal[axis] = static_cast<float>(frame.normal[axis]);
    of.along[axis] = static_cast<float>(frame.u[axis]);
    of.down[axis] = static_cast<float>(frame.v[axis]);
  }
  const LobeKernels& kernels = lobe_kernels();
  kernels.sum_lobes(of, lights_.data(), scratch.runs.data(), static_cast<int>(scratch.runs.size()),
                    scratch.sums.data());
  kernels.sum_cut_lobes(of, cut_lights_.data(), scratch.parts.data(), static_cast<int>(scratch.parts.size()),
                        scratch.sums.data());
  scratch.runs.clear();
  scratch.parts.clear();
}

/// Adds the lights of `scratch`'s runs to an area's field.
void BrightLights::add_to_field(const FaceArea& area, const Blur& lobe, LightField& field, Scratch& scratch) const {
  if (scratch.runs.empty() && scratch.parts.empty()) return;
  for (std::size_t k = 0; k < LightField::kPoints; ++k) {
    scratch.u[k] =
        static_cast<float>(LightField::point(area.column, area.end_column, area.size, k % LightField::kEdge));
    scratch.v[k] = static_cast<float>(LightField::point(area.row, area.end_row, area.size, k / LightField::kEdge));
  }
  std::array<float, 3 * LightField::kPoints>& values = field.lit();
  std::copy(values.begin(), values.end(), scratch.sums.begin());
  sum_runs(area.face, LightField::kPoints, lobe, scratch);
  std::copy_n(scratch.sums.begin(), values.size(), values.begin());
}

/// Adds an area's field and the lights of `scratch`'s runs to its texels, packed RGB.
void BrightLights::add_to_texels(const FaceArea& area, const Blur& lobe, const LightField& field, float* rgb,
                                 Scratch& scratch) const {
  if (texels_) add_exactly(area, lobe, rgb, scratch);
  if (field.dark() && scratch.runs.empty() && scratch.parts.empty()) return;
  const int across = area.across();
  const int texels = across * area.down();
  const int count = (texels + kLobeTexels - 1) / kLobeTexels * kLobeTexels;
  std::fill_n(scratch.sums.begin(), 3 * count, 0.0F);
  if (!field.dark()) field.write(area, count, scratch.sums.data());
  if (!scratch.runs.empty() || !scratch.parts.empty()) {
    auto index = std::size_t{0};
    for (int row = area.row; row < area.end_row; ++row) {
      for (int column = area.column; column < area.end_column; ++column, ++index) {
        scratch.u[index] = static_cast<float>(place_on_face(column, area.size));
        scratch.v[index] = static_cast<float>(place_on_face(row, area.size));
      }
    }
    std::fill(scratch.u.begin() + texels, scratch.u.begin() + count, scratch.u[index - 1]);
    std::fill(scratch.v.begin() + texels, scratch.v.begin() + count, scratch.v[index - 1]);
    sum_runs(area.face, count, lobe, scratch);
  }
  const float* sums = scratch.sums.data();
  for (int row = area.row; row < area.end_row; ++row) {
    float* texel = rgb + 3 * (std::ptrdiff_t{row} * area.size + area.column);
    for (int column = 0; column < across; ++column, ++sums, texel += 3) {
      texel[0] += lobe.scale * sums[0];
      texel[1] += lobe.scale * sums[count];
      texel[2] += lobe.scale * sums[2 * count];
    }
  }
}

/// Adds the rectangles that are `scratch`'s parts, texel by texel in double, and clears the parts.
void BrightLights::add_exactly(const FaceArea& area, const Blur& lobe, float* rgb, Scratch& scratch) const {
  if (scratch.parts.empty()) return;
  const double whole = lobe_integral(lobe.lobe.alpha());
  const GgxFunction ggx(lobe.lobe.alpha());
  for (int row = area.row; row < area.end_row; ++row) {
    for (int column = area.column; column < area.end_column; ++column) {
      const glm::dvec3 normal = area.direction(column + 0.5, row + 0.5);
      std::array<double, 3> sum{};
      for (const LobeRun& run : scratch.parts) {
        for (int k = run.first; k < run.first + run.count; ++k) {
          const Rectangle& part = rectangles_[static_cast<std::size_t>(k)];
          const double share = texels_->integral(part.texels, normal, ggx) / whole;
          for (std::size_t c = 0; c < 3; ++c) sum[c] += share * static_cast<double>(part.excess[c]);
        }
      }
      float* const texel = rgb + 3 * (std::ptrdiff_t{row} * area.size + column);
      for (std::size_t c = 0; c < 3; ++c) texel[c] = static_cast<float>(static_cast<double>(texel[c]) + sum[c]);
    }
  }
  scratch.parts.clear();
}

/// Adds the lights of `scratch`'s pending nodes from `first` on to an area of texels that no field is interpolated
/// over.
void BrightLights::add_to_leaf(const FaceArea& area, const Blur& lobe, const Block& block, const LightField& field,
                               std::size_t first, float* rgb, Scratch& scratch) const {
  // Integrals are costly. Over a wide block, parts, which are placed at their middles, would be used for texels at the
  // peak.
  const int edge = texels_ || area.size <= kWideBlocks ? 1 : kPartEdge;
  const bool parted = area.across() > edge || area.down() > edge;
  const std::size_t end = scratch.pending.size();
  const auto take_pending = [&scratch](std::size_t from, std::size_t to) {
    const auto begin = scratch.pending.rbegin();
    const auto last = static_cast<std::ptrdiff_t>(scratch.pending.size());
    scratch.stack.assign(begin + (last - static_cast<std::ptrdiff_t>(to)),
                         begin + (last - static_cast<std::ptrdiff_t>(from)));
  };
  take_pending(first, end);
  choose(block, parted ? Step::texels : Step::parts, scratch);
  add_to_texels(area, lobe, field, rgb, scratch);
  const std::size_t cut = scratch.pending.size();
  if (cut == end) return;
  for_each_part(area, edge, edge, [&](const FaceArea& part) {
    take_pending(end, cut);
    choose(Block(part, lobe), Step::parts, scratch);
    add_to_texels(part, lobe, {}, rgb, scratch);
  });
  scratch.pending.resize(end);
}

/// Adds the lights of `scratch`'s pending nodes from `first` on to an area, over which `field` has those of all others.
void BrightLights::add_to_area(const FaceArea& area, const Blur& lobe, LightField field, std::size_t first, float* rgb,
                               Scratch& scratch) const {
  const int edge = area.size < kSmallMip ? kPartEdge : kLeafEdge;
  const bool leaf = area.across() <= edge && area.down() <= edge;
  const Block block(area, lobe);
  if (leaf && edge <= LightField::kEdge) {
    add_to_leaf(area, lobe, block, field, first, rgb, scratch);
    return;
  }
  const std::size_t end = scratch.pending.size();
  scratch.stack.assign(scratch.pending.rbegin(), scratch.pending.rend() - static_cast<std::ptrdiff_t>(first));
  choose(block, Step::field, scratch);
  add_to_field(area, lobe, field, scratch);
  if (scratch.pending.size() == end) {
    if (!field.dark()) field.add_to(area, lobe.scale, rgb);
  } else if (leaf) {
    add_to_leaf(area, lobe, block, field, end, rgb, scratch);
  } else {
    const auto half = [edge](int texels) { return texels > edge ? (texels / 2 + edge - 1) / edge * edge : texels; };
    for_each_part(area, half(area.across()), half(area.down()),
                  [&](const FaceArea& part) { add_to_area(part, lobe, field.within(area, part), end, rgb, scratch); });
  }
  scratch.pending.resize(end);
}

double BrightLights::add(const LightsLobe& lights, int size, const std::array<float*, 6>& faces,
                         const Control& control) const {
  if (nodes_.empty()) return 0.0;
  const Blur lobe = blur_of(lights);
  const int edge = std::min(kTileEdge, size >= kSmallMip ? size / 4 : size);
  const int across = (size + edge - 1) / edge;
  const auto count = static_cast<std::int64_t>(std::min<std::size_t>(lights_.size(), 1000));
  const auto placement = jobs::placement_for(std::int64_t{6} * size * size * count);
  const std::size_t workers = jobs::worker_count(placement);
  jobs::run_tiles(static_cast<std::size_t>(6 * across * across), placement, workers, control,
                  [&](std::size_t tile, std::size_t /*worker*/) {
                    std::unique_ptr<Scratch> scratch = scratches_->take();
                    const int face = static_cast<int>(tile) / (across * across);
                    const int row = static_cast<int>(tile) / across % across * edge;
                    const int column = static_cast<int>(tile) % across * edge;
                    scratch->pending.assign(1, 0);
                    add_to_area({face, size, column, row, std::min(column + edge, size), std::min(row + edge, size)},
                                lobe, {}, 0, faces[static_cast<std::size_t>(face)], *scratch);
                    scratches_->give_back(std::move(scratch));
                  });
  return lobe.left_out;
}

}  // namespace welkin::reflections
