// The tree over bright texels: how it is made.
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <glm/geometric.hpp>
#include <glm/mat3x3.hpp>
#include <glm/matrix.hpp>
#include <numbers>

#include "image/geometry.h"
#include "math/elementary.h"
#include "math/quadrature.h"
#include "reflections/light_parts.h"

namespace welkin::reflections {
namespace {

constexpr double kPi = std::numbers::pi;

constexpr int kOrder = 4;         ///< points along a rule's edge
constexpr double kWidest = 0.25;  ///< radius of a node: positions on it are still nearly linear in rows and columns
constexpr double kMaxTurn = 0.1;  ///< the same for columns about a pole

constexpr double kDefaultReach = 9.25;   ///< of `reach_for`
constexpr double kMinFarDistance = 0.5;  ///< of what a node's distance must be at the default bounds
constexpr double kMaxLoosening = 1.4;    ///< of the reach, for what the horizon cuts
constexpr double kMaxCutRadius = 0.012;  ///< of a node that the horizon may cut as one light, at the default bounds
constexpr int kMinCutTexels = 4;         ///< of such a node
constexpr double kMaxParts = 4096.0;     ///< that a few texels are cut into, all together
constexpr double kOnePart = 0.01;        ///< radians: smaller texels need not be cut for the horizon

double edge_of(const ImageShape& shape) {
  return shape.cubemap ? 0.5 * kPi / shape.columns : kPi * std::max(1.0 / shape.rows, 2.0 / shape.columns);
}

/// Returns the same of the widest, a cubemap's about the middle of a face, for GGX lobes. The constants of other lobes
/// are fitted to `edge_of`.
double widest_edge_of(const ImageShape& shape, LightsOf of) {
  return shape.cubemap && of == LightsOf::ggx ? 2.0 / shape.columns : edge_of(shape);
}

/// Returns whether texels are too large to be parallelograms where the horizon cuts them in a GGX lobe.
bool is_coarse(const ImageShape& shape, LightsOf of) {
  constexpr double kMaxCut = 0.11;  // radians
  return of == LightsOf::ggx && edge_of(shape) > kMaxCut;
}

/// Returns the parts along an edge that large texels are cut into, each small relative to the lobe and the sphere.
int cuts_of(const ImageShape& shape, const LightLobes& lobes, std::size_t texels) {
  constexpr double kOfWidth = 0.3;
  constexpr double kOfSphere = 0.05;
  const double edge = edge_of(shape);
  const auto parts_of = [](double whole, double part) {
    return std::max(1, static_cast<int>(std::ceil(whole / part)));
  };
  const int needed =
      parts_of(widest_edge_of(shape, lobes.of), 2.0 * lobes.least_alpha);  // five points along an edge suffice
  if (is_coarse(shape, lobes.of)) return needed;
  const int wanted = parts_of(edge, std::min(kOfWidth * 2.0 * lobes.least_alpha, kOfSphere));
  const auto most = static_cast<int>(std::ceil(std::sqrt(kMaxParts / static_cast<double>(texels))));
  return std::max(needed, std::min({wanted, most, 16}));
}

/// Points along an edge of `radians` for a smooth lobe: they may lie half its width apart, two stand for a quarter to
/// 1e-3. Through other lobes than GGX, which may be bells (1.65 deviations wide), they lose 1e-5, 7e-5 at the default
/// bounds: `smooth_table_error`.
int smooth_points(double radians, double alpha, double reach, LightsOf use) {
  const double edge = radians / (2.0 * alpha);
  const int tighter = reach > kDefaultReach + 0.5 ? 1 : 0;
  if (use == LightsOf::any) {
    if (tighter == 0) return edge < 0.12 ? 2 : (edge < 0.3 ? 3 : (edge < 0.55 ? 4 : 5));
    return edge < 0.08 ? 2 : (edge < 0.24 ? 3 : (edge < 0.43 ? 4 : 5));
  }
  return std::min(5, (edge < 0.3 ? 2 : (edge < 0.6 ? 3 : 5)) + tighter);
}

/// Parts along an edge: that small that the horizon and annular lobes meet a parallelogram.
int parts_along(double radians, std::size_t texels, const LightLobes& lobes) {
  constexpr double kPart = 0.008;
  constexpr int kMax = 32;
  const double wanted = std::min(std::ceil(radians / kPart), std::sqrt(kMaxParts / static_cast<double>(texels)));
  const int least = std::max(radians < kOnePart ? 1 : 2, static_cast<int>(std::ceil(radians / lobes.widest_part())));
  return std::clamp(static_cast<int>(wanted), std::min(least, kMax), kMax);
}

}  // namespace

class LightTree {
 public:
  /// Points of a leaf, and its share of those of nodes: at most one node has merged points for each leaf, or, where
  /// four leaves' own are no more than those, for every second one.
  [[nodiscard]] static constexpr std::size_t points_of_leaf(int smooth) noexcept {
    const int points = smooth * smooth;
    return static_cast<std::size_t>(points + kOrder * kOrder / (4 * points <= kOrder * kOrder ? 2 : 1));
  }
  [[nodiscard]] static constexpr std::size_t bytes_of_leaf(int smooth) noexcept {
    return 2 * sizeof(BrightLights::Node) + sizeof(LightPoint) +
           points_of_leaf(smooth) * (sizeof(Sample) + sizeof(LobeLight));
  }

  /// Builds the tree of texels that are cut already. `exact`: keeps rectangles of them and no parts.
  /// `most_cut_radius`: of a node that is one cut light.
  LightTree(const std::vector<BrightTexel>& texels, const ImageShape& shape, const LightLobes& lobes, double reach,
            bool exact, double most_cut_radius, BrightLights& lights)
      : shape_(shape),
        directions_(shape),
        lights_(lights),
        rule_(math::gauss_legendre(kOrder)),
        smooth_(smooth_points(widest_edge_of(shape, lobes.of), lobes.least_alpha, reach, lobes.of)),
        most_cut_radius_(most_cut_radius),
        use_(lobes.of) {
    const double edge = edge_of(shape);
    lights.edge_ = widest_edge_of(shape, lobes.of);
    lights.smooth_points_ = smooth_;
    parts_ = exact ? 0 : parts_along(edge, texels.size(), lobes);
    points_.reserve(texels.size());
    for (const BrightTexel& texel : texels) {
      const Corner corner = corner_of(texel);
      points_.push_back({&texel, directions_.at(corner.face, corner.column + 0.5, corner.row + 0.5)});
    }
    lights_.nodes_.reserve(2 * texels.size());
    samples_.reserve(texels.size() * points_of_leaf(smooth_));
    lights_.cut_lights_.reserve(texels.size() * static_cast<std::size_t>(parts_ * parts_ + 1));
    lights_.nodes_.emplace_back();
    build(0, 0, points_.size(), false);
    lights_.lights_.reserve(samples_.size());
    for (const Sample& sample : samples_) lights_.lights_.push_back(light_of(directions_, sample));
  }

 private:
  struct LightPoint {
    const BrightTexel* texel;
    glm::dvec3 direction;
  };
  struct Corner {
    int face;
    int column;
    int row;
  };
  /// A range of rows and columns, the last ones outside.
  struct Box {
    Corner first;
    Corner end;
  };

  [[nodiscard]] Corner corner_of(const BrightTexel& texel) const {
    if (!shape_.cubemap) return {0, texel.column, texel.row};
    return {texel.row / shape_.columns, texel.column, texel.row % shape_.columns};
  }

  [[nodiscard]] Box box_of(std::size_t first, std::size_t end) const {
    Box box{corner_of(*points_[first].texel), {}};
    box.end = box.first;
    for (std::size_t k = first; k < end; ++k) {
      const Corner corner = corner_of(*points_[k].texel);
      box.first = {std::min(box.first.face, corner.face), std::min(box.first.column, corner.column),
                   std::min(box.first.row, corner.row)};
      box.end = {std::max(box.end.face, corner.face + 1), std::max(box.end.column, corner.column + 1),
                 std::max(box.end.row, corner.row + 1)};
    }
    return box;
  }

  void bound(BrightLights::Node& node, std::size_t first, std::size_t end) const {
    glm::dvec3 centre(0.0);
    for (std::size_t k = first; k < end; ++k) centre += points_[k].direction;
    centre /= static_cast<double>(end - first);
    double radius = 0.0;
    double texel = 0.0;
    for (std::size_t k = first; k < end; ++k) {
      radius = std::max(radius, glm::length(points_[k].direction - centre));
      if (k == first || points_[k].texel->row != points_[k - 1].texel->row)
        texel = std::max(texel, radius_of(points_[k].direction, box_of(k, k + 1)));
    }
    node.centre = centre;
    node.radius = 1.0000001 * (radius + texel) + 1e-7;  // positions are rounded
  }

  [[nodiscard]] std::size_t parted(const Box& box, std::size_t first, std::size_t end) {
    const auto begin = points_.begin();
    const auto part = [&](auto before) {
      const auto middle =
          std::stable_partition(begin + static_cast<std::ptrdiff_t>(first), begin + static_cast<std::ptrdiff_t>(end),
                                [&](const LightPoint& point) { return before(corner_of(*point.texel)); });
      return static_cast<std::size_t>(middle - begin);
    };
    if (box.end.face - box.first.face > 1) {
      const int half = (box.first.face + box.end.face) / 2;
      return part([=](const Corner& corner) { return corner.face < half; });
    }
    // columns are 2 pi sin / columns wide, rows pi / rows high
    const double steep = shape_.cubemap ? 1.0 : directions_.density_at(0.0, 0.5 * (box.first.row + box.end.row));
    const double wide =
        (shape_.cubemap ? 1.0 : steep * 2.0 * shape_.rows / shape_.columns) * (box.end.column - box.first.column);
    const int high = box.end.row - box.first.row;
    if (box.end.column - box.first.column > 1 && (wide >= high || high == 1)) {
      const int half = (box.first.column + box.end.column) / 2;
      return part([=](const Corner& corner) { return corner.column < half; });
    }
    const int half = (box.first.row + box.end.row) / 2;
    return part([=](const Corner& corner) { return corner.row < half; });
  }

  /// Where light lies, all channels together. Moments of a node are the sums of its children's, and no leaf is
  /// visited twice.
  struct Moments {
    glm::dvec3 light{0.0};   ///< of each channel
    glm::dvec3 first{0.0};   ///< Sum light x direction
    glm::dmat3 second{0.0};  ///< Sum light x the outer product of the direction with itself

    void add(const Moments& other) {
      light += other.light;
      first += other.first;
      second += other.second;
    }
  };

  /// `within`: a node above can be cut as one light.
  Moments build(std::size_t index, std::size_t first, std::size_t end, bool within) {
    bound(lights_.nodes_[index], first, end);
    if (end - first == 1) {
      const BrightTexel& texel = *points_[first].texel;
      const auto smooth = static_cast<int>(samples_.size());
      add_points(texel, directions_, smooth_, samples_);
      lights_.nodes_[index].smooth = {smooth, static_cast<int>(samples_.size()) - smooth};
      const LobeRun parts = cut_lights_of(texel);
      lights_.nodes_[index].parts = parts;
      return parts_ > 0 ? moments_of(parts, within) : Moments{};
    }
    const bool one_cut = can_be_one_cut(lights_.nodes_[index], first, end);
    Moments moments;
    const Box box = box_of(first, end);
    const std::size_t middle = parted(box, first, end);
    std::array<int, 2> children{};
    for (std::size_t k = 0; k < 2; ++k) {
      children[k] = static_cast<int>(lights_.nodes_.size());
      lights_.nodes_.emplace_back();
      moments.add(build(static_cast<std::size_t>(children[k]), k == 0 ? first : middle, k == 0 ? middle : end,
                        within || one_cut));
    }
    BrightLights::Node& node = lights_.nodes_[index];
    node.children = children;
    if (parts_ == 0 && node.radius < kWidest) node.parts = rectangle_of(box, first, end);
    if (one_cut) node.parts = one_cut_light(node, box, moments, within);
    merge(node, box);
    return moments;
  }

  /// Returns whether the texels are small together and all have nearly the same colour and brightness.
  [[nodiscard]] bool can_be_one_cut(const BrightLights::Node& node, std::size_t first, std::size_t end) const {
    constexpr float kEven = 4.0F;
    if (parts_ == 0 || end - first < kMinCutTexels || node.radius > most_cut_radius_) return false;
    for (std::size_t c = 0; c < 3; ++c) {
      float least = points_[first].texel->excess[c];
      float most = least;
      for (std::size_t k = first; k < end; ++k) {
        least = std::min(least, points_[k].texel->excess[c]);
        most = std::max(most, points_[k].texel->excess[c]);
      }
      if (most > kEven * least) return false;
    }
    return true;
  }

  /// Returns the moments of a leaf's parts, which count for the error unless `within` a node that is cut as one light.
  Moments moments_of(const LobeRun& parts, bool within) {
    Moments moments;
    for (int k = parts.first; k < parts.first + parts.count; ++k) {
      const CutLight& cut = lights_.cut_lights_[static_cast<std::size_t>(k)];
      const auto vector = [](const auto& x, const auto& y, const auto& z) { return glm::dvec3(x, y, z); };
      const glm::dvec3 direction = vector(cut.light.x, cut.light.y, cut.light.z);
      const glm::dvec3 along = vector(cut.along[0], cut.along[1], cut.along[2]);
      const glm::dvec3 down = vector(cut.down[0], cut.down[1], cut.down[2]);
      const glm::dvec3 colour = vector(cut.light.red, cut.light.green, cut.light.blue);
      const double light = colour.x + colour.y + colour.z;
      moments.add({colour, light * direction,
                   light * (glm::outerProduct(direction, direction) +
                            (glm::outerProduct(along, along) + glm::outerProduct(down, down)) / 3.0)});
    }
    if (!within) count_cut(parts, edge_of(shape_) / parts_);
    return moments;
  }

  void count_cut(const LobeRun& parts, double size) {
    for (int k = parts.first; k < parts.first + parts.count; ++k) {
      const LobeLight& light = lights_.cut_lights_[static_cast<std::size_t>(k)].light;
      const glm::dvec3 colour(light.red, light.green, light.blue);
      const double brightness = glm::length(colour);
      lights_.cut_square_ += brightness * brightness * size * size * size;
      lights_.cut_ += colour * size * size;
    }
  }

  /// A parallelogram with the node's light, centroid and second moments.
  LobeRun one_cut_light(const BrightLights::Node& node, const Box& box, const Moments& moments, bool within) {
    const double light = moments.light.x + moments.light.y + moments.light.z;
    const glm::dvec3 mean = moments.first / light;
    const glm::dmat3 spread = moments.second / light - glm::outerProduct(mean, mean);
    const double column = 0.5 * (box.first.column + box.end.column);
    const double row = 0.5 * (box.first.row + box.end.row);
    const glm::dvec3 normal = glm::normalize(mean);
    const glm::dvec3 step =
        directions_.at(box.first.face, column + 0.5, row) - directions_.at(box.first.face, column - 0.5, row);
    const glm::dvec3 across = glm::normalize(step - glm::dot(step, normal) * normal);
    const glm::dvec3 below = glm::cross(normal, across);
    // 3 spread = along along^T + down down^T in that plane, and rows lie along `across`: a parallelogram c + s along +
    // t down, -1 < s, t < 1, has the covariance (along along^T + down down^T) / 3. With along = (wide, 0) and down =
    // (lean, high) in the axes across and below it is ((wide^2 + lean^2, lean high), (lean high, high^2)), Cholesky's
    // factor from the last element on.
    const double across_across = 3.0 * glm::dot(across, spread * across);
    const double across_below = 3.0 * glm::dot(across, spread * below);
    const double below_below = 3.0 * glm::dot(below, spread * below);
    const double high = std::sqrt(std::max(below_below, 1e-18));
    const double lean = across_below / high;
    const double wide = std::sqrt(std::max(across_across - lean * lean, 1e-18));
    const glm::dvec3 along = wide * across;
    const glm::dvec3 down = high * below + lean * across;
    const auto index = static_cast<int>(lights_.cut_lights_.size());
    const auto single = [](double value) { return static_cast<float>(value); };
    const glm::dvec3& colour = moments.light;
    lights_.cut_lights_.push_back(
        {{single(normal.x), single(normal.y), single(normal.z), single(colour.x), single(colour.y), single(colour.z)},
         {single(along.x), single(along.y), single(along.z)},
         {single(down.x), single(down.y), single(down.z)},
         single(0.01 * (wide + high))});
    if (!within) count_cut({index, 1}, std::numbers::sqrt2 * node.radius);
    return {index, 1};
  }

  LobeRun rectangle_of(const projection::TexelRectangle& texels, const BrightTexel& texel) {
    lights_.rectangles_.push_back({texels, texel.excess});
    return {static_cast<int>(lights_.rectangles_.size()) - 1, 1};
  }

  /// Returns none unless the texels fill their box with one radiance.
  LobeRun rectangle_of(const Box& box, std::size_t first, std::size_t end) {
    const int rows = box.end.row - box.first.row;
    const int columns = box.end.column - box.first.column;
    const BrightTexel& texel = *points_[first].texel;
    const bool full = box.end.face - box.first.face == 1 &&
                      end - first == static_cast<std::size_t>(rows) * static_cast<std::size_t>(columns);
    const bool even = full && std::all_of(points_.begin() + static_cast<std::ptrdiff_t>(first),
                                          points_.begin() + static_cast<std::ptrdiff_t>(end),
                                          [&](const LightPoint& point) { return point.texel->excess == texel.excess; });
    if (!even) return {};
    const int face_row = shape_.cubemap ? box.first.face * shape_.columns : 0;
    return rectangle_of({face_row + box.first.row, box.first.column, rows, columns}, texel);
  }

  LobeRun cut_lights_of(const BrightTexel& texel) {
    const double squares = glm::dot(texel.light(), texel.light());
    lights_.squares_ += squares;
    if (use_ == LightsOf::any && !shape_.cubemap) {
      // `lean` of the middle part as `centre` has it: 0.3 parts are about its rule's nodes, 0.289 from the middle
      const double above = directions_.density_at(0.0, texel.row + 0.5 - 0.3 / parts_);
      const double below = directions_.density_at(0.0, texel.row + 0.5 + 0.3 / parts_);
      const double lean = (below - above) / (below + above);
      lights_.leaning_ += squares * lean * lean;
    }
    if (parts_ == 0) {
      lights_.power_ += texel.light();
      return rectangle_of({texel.row, texel.column, 1, 1}, texel);
    }
    const auto first = static_cast<int>(lights_.cut_lights_.size());
    cut_.clear();
    add_parts(texel, directions_, parts_, use_, cut_);
    for (const Sample& sample : cut_) {
      lights_.cut_lights_.push_back(cut_light_of(directions_, sample, parts_, use_));
      lights_.power_ += sample.light;
    }
    return {first, static_cast<int>(cut_.size())};
  }

  void merge(BrightLights::Node& node, const Box& box) {
    const BrightLights::Node& a = lights_.nodes_[static_cast<std::size_t>(node.children[0])];
    const BrightLights::Node& b = lights_.nodes_[static_cast<std::size_t>(node.children[1])];
    if (a.smooth.count == 0 || b.smooth.count == 0) return;
    const bool exact = a.merged == 0.0 && b.merged == 0.0 && a.smooth.first + a.smooth.count == b.smooth.first;
    if (exact && a.smooth.count + b.smooth.count <= kOrder * kOrder) {
      node.smooth = {a.smooth.first, a.smooth.count + b.smooth.count};
      return;
    }
    const bool many_turns = !shape_.cubemap && box.end.column - box.first.column > kMaxTurn * shape_.columns;
    if (box.end.face - box.first.face > 1 || many_turns) return;
    const double radius = std::max(node.radius, radius_of(node.centre, box));
    if (radius > kWidest) return;
    node.merged = radius;
    lights_.most_merged_ = std::max(lights_.most_merged_, radius);
    const auto first = static_cast<int>(samples_.size());
    const double half_wide = 0.5 * (box.end.column - box.first.column);
    const double half_high = 0.5 * (box.end.row - box.first.row);
    for (int j = 0; j < kOrder; ++j) {
      for (int i = 0; i < kOrder; ++i) {
        samples_.push_back({box.first.face,
                            box.first.column + half_wide * (1.0 + rule_.nodes[i]),
                            box.first.row + half_high * (1.0 + rule_.nodes[j]),
                            {}});
      }
    }
    for (const LobeRun& run : {a.smooth, b.smooth}) {
      for (int k = run.first; k < run.first + run.count; ++k) {
        const Sample from = samples_[static_cast<std::size_t>(k)];
        const auto across = shares((from.column - box.first.column) / half_wide - 1.0);
        const auto down = shares((from.row - box.first.row) / half_high - 1.0);
        for (std::size_t j = 0; j < kOrder; ++j) {
          for (std::size_t i = 0; i < kOrder; ++i) {
            Sample& to = samples_[static_cast<std::size_t>(first) + j * kOrder + i];
            to.light += across[i] * down[j] * from.light;
          }
        }
      }
    }
    node.smooth = {first, kOrder * kOrder};
  }

  /// Distance from a centre to the farthest corner or middle of an edge of a box, whose light may lie along a diagonal.
  [[nodiscard]] double radius_of(const glm::dvec3& centre, const Box& box) const {
    double most = 0.0;
    for (const double x : {0.0, 0.5, 1.0}) {
      for (const double y : {0.0, 0.5, 1.0}) {
        const glm::dvec3 corner =
            directions_.at(box.first.face, box.first.column + x * (box.end.column - box.first.column),
                           box.first.row + y * (box.end.row - box.first.row));
        most = std::max(most, glm::length(corner - centre));
      }
    }
    return most;
  }

  /// The Lagrange polynomials of the rule's nodes. A light at x that is shared out by them gives any function the
  /// value of its interpolation polynomial at x: exact up to degree kOrder - 1, in rows and columns each.
  [[nodiscard]] std::array<double, kOrder> shares(double at) const {
    std::array<double, kOrder> all{};
    for (int i = 0; i < kOrder; ++i) {
      double share = 1.0;
      for (int k = 0; k < kOrder; ++k) {
        if (k != i) share *= (at - rule_.nodes[k]) / (rule_.nodes[i] - rule_.nodes[k]);
      }
      all[static_cast<std::size_t>(i)] = share;
    }
    return all;
  }

  ImageShape shape_;
  mutable Directions directions_;
  BrightLights& lights_;
  math::GaussRule rule_;
  int smooth_;
  int parts_ = 2;
  std::vector<LightPoint, platform::WorkingAllocator<LightPoint>> points_;
  Samples samples_;
  Samples cut_;  ///< of a texel
  double most_cut_radius_ = 0.0;
  LightsOf use_;
};

BrightLights::BrightLights(const std::vector<BrightTexel>& texels, const ImageShape& shape, const LightLobes& lobes,
                           double reach)
    : far_(kFar * std::max(kMinFarDistance, std::sqrt(std::sqrt(math::exponential(reach - kDefaultReach))))) {
  if (texels.empty()) return;
  const int cuts = cuts_of(shape, lobes, texels.size());
  const ImageShape cut{shape.cubemap, cuts * shape.columns, cuts * shape.rows};
  const bool exact = is_coarse(shape, lobes.of);
  if (exact) texels_ = projection::texel_integrals_of(cut.grid());
  // The error of a cut light falls with the square of its size. A kernel may be steep at its horizon.
  double most_cut = kMaxCutRadius * math::exponential(0.5 * std::min(kMaxLoosening, kDefaultReach - reach));
  if (lobes.of == LightsOf::any) most_cut = std::min(most_cut, 0.5 * lobes.narrowest());
  const LightTree tree(cuts == 1 ? texels : cut_texels(texels, shape, cuts), cut, lobes, reach, exact, most_cut, *this);
  make_scratch();
}

std::size_t BrightLights::most_leaves(std::size_t texels, const ImageShape& shape, const LightLobes& lobes) noexcept {
  const auto cuts = static_cast<std::size_t>(cuts_of(shape, lobes, 1));
  const auto needed = static_cast<std::size_t>(cuts_of(shape, lobes, std::size_t{1} << 30U));
  // n texels become 4096 parts or so, but for what rounding up their number along an edge adds
  const double edge = std::sqrt(kMaxParts) + std::sqrt(static_cast<double>(texels));
  return std::min(texels * cuts * cuts, std::max(texels * needed * needed, static_cast<std::size_t>(edge * edge)));
}

std::size_t BrightLights::tree_bytes(std::size_t texels, std::size_t leaves, const ImageShape& shape,
                                     const LightLobes& lobes) noexcept {
  if (texels == 0) return 0;
  const double edge = edge_of(shape) / cuts_of(shape, lobes, texels);
  const auto along = static_cast<std::size_t>(parts_along(edge, leaves, lobes));
  const std::size_t parts = std::max(static_cast<std::size_t>(kMaxParts), leaves * along * along);
  const std::size_t cut = is_coarse(shape, lobes.of) ? 0 : parts + leaves;
  // Positions are listed while solid angles are found.
  const std::size_t cutting = leaves > texels ? leaves * 2 * (sizeof(BrightTexel) + sizeof(std::int64_t)) : 0;
  const double widest = widest_edge_of(shape, lobes.of) / cuts_of(shape, lobes, texels);
  return leaves * LightTree::bytes_of_leaf(smooth_points(widest, lobes.least_alpha, kDefaultReach + 1.0, lobes.of)) +
         cut * sizeof(CutLight) + cutting;
}

std::size_t BrightLights::bytes() const noexcept {
  return nodes_.size() * sizeof(Node) + lights_.size() * sizeof(LobeLight) + cut_lights_.size() * sizeof(CutLight) +
         rectangles_.size() * sizeof(Rectangle);
}

}  // namespace welkin::reflections
