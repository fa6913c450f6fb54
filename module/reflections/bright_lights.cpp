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

#include "image/geometry.h"
#include "jobs/tiles.h"
#include "reflections/lobe.h"

namespace welkin::reflections {
namespace {

constexpr double kPi = std::numbers::pi;

constexpr double kHorizon = 0.1;  ///< of what the horizon cuts, times the square of a part's size: docs/reflections.md
constexpr double kKernelHorizon = 0.1 / 16.0;  ///< the same through a kernel, where a part is looked at in 16 places
constexpr double kLost = 5e-6;      ///< of the lights' field, at least: float sums, and what the truth itself errs
constexpr double kMerged = 1.5e-4;  ///< of merged lights at `kFar`, in the mean

double norm(const std::array<double, 3>& colour) {
  return std::sqrt(colour[0] * colour[0] + colour[1] * colour[1] + colour[2] * colour[2]);
}

/// What `points` along an edge of `radians` lose of a smooth lobe, in the mean: fits to Gauss' error terms for 1 / (1 +
/// x^2)^2.
double smooth_error(double radians, double alpha, int points) {
  const double edge = radians / (2.0 * alpha);
  const double square = edge * edge;
  if (points == 2) return square * square / 40.0;
  if (points == 3) return square * square * square / 200.0;
  return points == 4 ? square * square * square * square / 1000.0 : 1e-5;
}

}  // namespace

double BrightLights::error(double alpha, double rms) const {
  if (nodes_.empty()) return 0.0;
  const double square = alpha * alpha;
  const double integral = lobe_integral(alpha);
  const double width = 0.5 * (1.0 + square);  // alpha^2 + (1 - c) (1 - alpha^2) / 2 at c = 0
  const double horizon = kHorizon * square / kPi / integral / (width * width) * norm(cut_);
  // Int k^2 is at most its peak times Int k, and less for a narrow lobe
  const double squares = std::min(integral / (kPi * square), 4.0 / (3.0 * kPi * square * std::max(1e-9, 1.0 - square)));
  const double of_width = std::min(1.0, far_ * most_merged_ * std::sqrt(1.0 - square) / (2.0 * alpha)) * kFar / far_;
  const double share = kMerged * of_width * of_width * of_width * of_width;
  const double smooth = smooth_error(edge_, alpha, smooth_points_);
  const double lost = kLost + std::sqrt(share * share + smooth * smooth);
  const double field = norm(power_) * std::sqrt(squares / (4.0 * kPi)) / integral;  // of one light with all of it
  const double merged = lost * std::min(field, rms);
  return std::sqrt(horizon * horizon + merged * merged);
}

double BrightLights::error(const ZonalShape& kernel, double rms) const {
  if (nodes_.empty()) return 0.0;
  const double horizon = kKernelHorizon * kernel.peak() / kernel.scale() * norm(cut_);
  const double field = norm(power_) * std::sqrt(kernel.square() / (4.0 * kPi));
  const double merged = (kLost + kMerged) * std::min(field, rms);
  return std::sqrt(horizon * horizon + merged * merged);
}

/// Some texels of a face that lie together.
struct BrightLights::Block {
  std::array<double, 3> centre{};
  double radius = 0.0;
  double far = kFar;
  double width_squared = 0.0;  ///< of the lobe: it has its poles at such distances, squared and negative
  double most_merged = 0.0;    ///< through a kernel, whatever the distance: the radius over which it is all but a
                               ///< polynomial
  bool by_kernel = false;
  double nearest = 0.0;  ///< distance of a light, less and more of which nothing is seen
  double farthest = 2.0;
  bool horizon = true;  ///< whether nothing comes from below it

  enum class Sight { below, cut, above };

  /// n.s is at least that of the two centres less both radii.
  [[nodiscard]] Sight sight_of(const Node& node) const noexcept {
    if (!horizon) return Sight::above;
    const double between = centre[0] * node.centre[0] + centre[1] * node.centre[1] + centre[2] * node.centre[2];
    const double margin = radius + node.radius;
    return between < -margin ? Sight::below : (between > margin ? Sight::above : Sight::cut);
  }
  [[nodiscard]] bool unseen(const Node& node) const noexcept {
    if (!by_kernel) return false;
    const double x = centre[0] - node.centre[0];
    const double y = centre[1] - node.centre[1];
    const double z = centre[2] - node.centre[2];
    const double distance = std::sqrt(x * x + y * y + z * z);
    const double margin = radius + node.radius;
    return distance + margin < nearest || distance - margin > farthest;
  }
  [[nodiscard]] bool far_enough(const Node& node) const noexcept {
    if (by_kernel) return node.merged <= most_merged;
    const double x = centre[0] - node.centre[0];
    const double y = centre[1] - node.centre[1];
    const double z = centre[2] - node.centre[2];
    const double distance = std::max(0.0, std::sqrt(x * x + y * y + z * z) - radius);
    return distance * distance + width_squared >= far * far * node.merged * node.merged;
  }
};

namespace {

constexpr int kMostEdge = 8;
constexpr int kMostTexels = kMostEdge * kMostEdge;
constexpr int kWideBlocks = 8;  ///< of mips up to this a block of parts would be as wide as from a peak to its horizon
constexpr int kPartEdge = 4;    ///< of parts of a block, about each of which is decided what the horizon cuts

double place_on_face(int texel, int size) { return (2.0 * texel + 1.0) / size - 1.0; }

void add_run(const LobeRun& run, std::vector<LobeRun>& runs) {
  if (!runs.empty() && runs.back().first + runs.back().count == run.first) {
    runs.back().count += run.count;
  } else {
    runs.push_back(run);
  }
}

}  // namespace

/// Texels [column, end_column) x [row, end_row) of a face of `size`.
struct BrightLights::Area {
  int face;
  int size;
  int column;
  int row;
  int end_column;
  int end_row;
};

/// What a worker needs for one area. Nothing is allocated inside tiles: nodes in a list have no leaf in common, so that
/// there is room for one of each leaf.
struct BrightLights::Room {
  explicit Room(std::size_t leaves) {
    for (std::vector<int>* list : {&stack, &cut}) list->reserve(leaves);
    for (std::vector<LobeRun>* list : {&runs, &parts}) list->reserve(leaves);
  }

  [[nodiscard]] static constexpr std::size_t bytes(std::size_t leaves) noexcept {
    return sizeof(Room) + leaves * 2 * (sizeof(int) + sizeof(LobeRun));
  }

  std::array<float, kMostTexels> u{};
  std::array<float, kMostTexels> v{};
  std::array<float, 3 * kMostTexels> sums{};
  std::vector<int> stack;      ///< nodes that are still to be looked at
  std::vector<int> cut;        ///< nodes that the horizon of some texel cuts
  std::vector<LobeRun> runs;   ///< of lights
  std::vector<LobeRun> parts;  ///< of cut lights
};

std::size_t BrightLights::most_bytes(std::size_t texels, const PictureShape& shape, double least_alpha,
                                     std::size_t workers) noexcept {
  const std::size_t leaves = most_leaves(texels, shape, least_alpha);
  return tree_bytes(texels, leaves, shape, least_alpha) + workers * Room::bytes(leaves);
}

/// As many rooms as there are workers, for all mips together: a tile takes one while it runs.
class BrightLights::Rooms {
 public:
  Rooms(std::size_t workers, std::size_t leaves) : leaves_(leaves) {
    all_.reserve(workers);
    free_.reserve(workers);
    while (all_.size() < workers) {
      all_.push_back(std::make_unique<Room>(leaves));
      free_.push_back(all_.back().get());
    }
  }

  [[nodiscard]] Room& take() {
    const std::scoped_lock lock(mutex_);
    if (free_.empty()) {  // there are more threads than there were
      all_.push_back(std::make_unique<Room>(leaves_));
      free_.push_back(all_.back().get());
    }
    Room& room = *free_.back();
    free_.pop_back();
    return room;
  }
  void give_back(Room& room) {
    const std::scoped_lock lock(mutex_);
    free_.push_back(&room);
  }

 private:
  std::size_t leaves_;
  std::mutex mutex_;
  std::vector<std::unique_ptr<Room>> all_;
  std::vector<Room*> free_;
};

void BrightLights::make_rooms() {
  rooms_ = std::make_shared<Rooms>(jobs::worker_count(jobs::Placement::arena), (nodes_.size() + 1) / 2);
}

BrightLights::Block BrightLights::block_of(const Area& area, const LightsLobe& lobe) const {
  constexpr double kOfScale = 0.8;  // four Gauss points over a bell of 1.3 standard deviations each side: 3e-4
  Block block;
  const glm::dvec3 middle = image::face_direction(area.size, area.face, 0.5 * (area.column + area.end_column),
                                                  0.5 * (area.row + area.end_row));
  block.centre = {middle.x, middle.y, middle.z};
  for (const double column : {area.column + 0.5, area.end_column - 0.5}) {
    for (const double row : {area.row + 0.5, area.end_row - 0.5}) {
      const glm::dvec3 corner = image::face_direction(area.size, area.face, column, row);
      block.radius = std::max(block.radius, glm::length(corner - middle));
    }
  }
  block.radius += 1e-6;
  block.far = far_;
  block.width_squared = 4.0 * lobe.alpha * lobe.alpha / std::max(1e-6, 1.0 - lobe.alpha * lobe.alpha);
  block.by_kernel = lobe.kernel != nullptr;
  if (block.by_kernel) {
    block.most_merged = kOfScale * lobe.kernel->scale();
    block.horizon = lobe.kernel->hemisphere();
    block.nearest = 2.0 * lobe.kernel->nearest();
    block.farthest = 2.0 * lobe.kernel->farthest();
  }
  return block;
}

/// Takes the stack's nodes to `runs`, and what the horizon cuts to `cut`, or if `to_parts` on to its texels' parts.
void BrightLights::choose(const Block& block, bool to_parts, Room& room) const {
  while (!room.stack.empty()) {
    const int index = room.stack.back();
    const Node& node = nodes_[static_cast<std::size_t>(index)];
    room.stack.pop_back();
    const Block::Sight sight = block.sight_of(node);
    if (sight == Block::Sight::below || block.unseen(node)) continue;
    const bool leaf = node.children[0] < 0;
    const bool cut = sight == Block::Sight::cut;
    if (!cut && (leaf || (node.smooth.count > 0 && block.far_enough(node)))) {
      add_run(node.smooth, room.runs);
    } else if (cut && !to_parts && (leaf || node.parts.count > 0 || node.radius < block.radius)) {
      room.cut.push_back(index);
    } else if (leaf || (cut && node.parts.count > 0)) {
      add_run(node.parts, room.parts);
    } else {
      room.stack.push_back(node.children[1]);
      room.stack.push_back(node.children[0]);
    }
  }
}

/// Adds the lights of `room`'s runs to an area's texels, packed RGB, and forgets them.
void BrightLights::add_runs(const Area& area, const LightsLobe& lobe, float* rgb, Room& room) const {
  if (room.runs.empty() && room.parts.empty()) return;
  if (lobe.kernel != nullptr) {
    add_runs_by_kernel(area, *lobe.kernel, rgb, room);
    return;
  }
  const int across = area.end_column - area.column;
  const int texels = across * (area.end_row - area.row);
  const int count = (texels + kLobeTexels - 1) / kLobeTexels * kLobeTexels;
  for (int k = 0; k < count; ++k) {
    const int texel = std::min(k, texels - 1);
    room.u[static_cast<std::size_t>(k)] = static_cast<float>(place_on_face(area.column + texel % across, area.size));
    room.v[static_cast<std::size_t>(k)] = static_cast<float>(place_on_face(area.row + texel / across, area.size));
  }
  const image::Frame& frame = image::face_frame(area.face);
  const double square = lobe.alpha * lobe.alpha;
  LobeBlock of{{},
               {},
               {},
               room.u.data(),
               room.v.data(),
               count,
               static_cast<float>(square),
               static_cast<float>(0.25 * (1.0 - square)),
               static_cast<float>(lobe.far_split / (1.0 - square))};
  for (int axis = 0; axis < 3; ++axis) {
    of.normal[axis] = static_cast<float>(frame.normal[axis]);
    of.along[axis] = static_cast<float>(frame.u[axis]);
    of.down[axis] = static_cast<float>(frame.v[axis]);
  }
  if (texels_) add_exactly(area, lobe, rgb, room);
  room.sums.fill(0.0F);
  const LobeKernels& kernels = lobe_kernels();
  kernels.sum_lobes(of, lights_.data(), room.runs.data(), static_cast<int>(room.runs.size()), room.sums.data());
  kernels.sum_cut_lobes(of, cut_lights_.data(), room.parts.data(), static_cast<int>(room.parts.size()),
                        room.sums.data());
  room.runs.clear();
  room.parts.clear();
  const double scale = square / kPi / lobe_integral(lobe.alpha);
  for (int k = 0; k < texels; ++k) {
    float* const texel = rgb + 3 * (std::ptrdiff_t{area.row + k / across} * area.size + area.column + k % across);
    for (int c = 0; c < 3; ++c) {
      const double light = scale * static_cast<double>(room.sums[static_cast<std::size_t>(c * count + k)]);
      texel[c] = static_cast<float>(static_cast<double>(texel[c]) + light);
    }
  }
}

/// Adds the rectangles that are `room`'s parts, texel by texel in double, and clears the parts.
void BrightLights::add_exactly(const Area& area, const LightsLobe& lobe, float* rgb, Room& room) const {
  if (room.parts.empty()) return;
  const double whole = lobe_integral(lobe.alpha);
  for (int row = area.row; row < area.end_row; ++row) {
    for (int column = area.column; column < area.end_column; ++column) {
      const glm::dvec3 normal = image::face_direction(area.size, area.face, column + 0.5, row + 0.5);
      std::array<double, 3> sum{};
      for (const LobeRun& run : room.parts) {
        for (int k = run.first; k < run.first + run.count; ++k) {
          const Rectangle& part = rectangles_[static_cast<std::size_t>(k)];
          const double share = texels_->integral(part.texels, normal, lobe.alpha) / whole;
          for (std::size_t c = 0; c < 3; ++c) sum[c] += share * static_cast<double>(part.excess[c]);
        }
      }
      float* const texel = rgb + 3 * (std::ptrdiff_t{row} * area.size + column);
      for (std::size_t c = 0; c < 3; ++c) texel[c] = static_cast<float>(static_cast<double>(texel[c]) + sum[c]);
    }
  }
  room.parts.clear();
}

/// Texel by texel in double, as a kernel is a table. A part that the horizon cuts is looked at in 4 x 4 places.
void BrightLights::add_runs_by_kernel(const Area& area, const ZonalShape& kernel, float* rgb, Room& room) const {
  constexpr int kPlaces = 4;
  const KernelTable& table = kernel.table();
  const auto towards = [&table](const glm::dvec3& normal, double x, double y, double z) {
    x -= normal.x;
    y -= normal.y;
    z -= normal.z;
    return table.at(0.5 * std::sqrt(x * x + y * y + z * z));
  };
  for (int row = area.row; row < area.end_row; ++row) {
    for (int column = area.column; column < area.end_column; ++column) {
      const glm::dvec3 normal = image::face_direction(area.size, area.face, column + 0.5, row + 0.5);
      std::array<double, 3> sum{};
      const auto add = [&sum](const LobeLight& light, double weight) {
        sum[0] += weight * static_cast<double>(light.red);
        sum[1] += weight * static_cast<double>(light.green);
        sum[2] += weight * static_cast<double>(light.blue);
      };
      for (const LobeRun& run : room.runs) {
        for (int k = run.first; k < run.first + run.count; ++k) {
          const LobeLight& light = lights_[static_cast<std::size_t>(k)];
          add(light, towards(normal, static_cast<double>(light.x), static_cast<double>(light.y),
                             static_cast<double>(light.z)));
        }
      }
      for (const LobeRun& run : room.parts) {
        for (int k = run.first; k < run.first + run.count; ++k) {
          const CutLight& cut = cut_lights_[static_cast<std::size_t>(k)];
          double weight = 0.0;
          for (int place = 0; place < kPlaces * kPlaces; ++place) {
            const int down = place / kPlaces;
            const int across = place % kPlaces;
            const double s = (2.0 * across + 1.0) / kPlaces - 1.0;
            const double t = (2.0 * down + 1.0) / kPlaces - 1.0;
            const auto at = [&](float middle, int axis) {
              return static_cast<double>(middle) + s * static_cast<double>(cut.along[axis]) +
                     t * static_cast<double>(cut.down[axis]);
            };
            weight += towards(normal, at(cut.light.x, 0), at(cut.light.y, 1), at(cut.light.z, 2));
          }
          add(cut.light, weight / (kPlaces * kPlaces));
        }
      }
      float* const texel = rgb + 3 * (std::ptrdiff_t{row} * area.size + column);
      for (std::size_t c = 0; c < 3; ++c) texel[c] = static_cast<float>(static_cast<double>(texel[c]) + sum[c]);
    }
  }
  room.runs.clear();
  room.parts.clear();
}

void BrightLights::add_to_area(const Area& area, const LightsLobe& lobe, float* rgb, Room& room) const {
  // Integrals are costly. Over a wide block, parts, which are placed at their middles, would be used for texels at the
  // peak.
  const int edge = texels_ || area.size <= kWideBlocks ? 1 : kPartEdge;
  const bool parted = area.end_column - area.column > edge || area.end_row - area.row > edge;
  room.cut.clear();
  room.stack.push_back(0);
  choose(block_of(area, lobe), !parted, room);
  add_runs(area, lobe, rgb, room);
  if (room.cut.empty()) return;
  for (int row = area.row; row < area.end_row; row += edge) {
    for (int column = area.column; column < area.end_column; column += edge) {
      const Area part{area.face,
                      area.size,
                      column,
                      row,
                      std::min(column + edge, area.end_column),
                      std::min(row + edge, area.end_row)};
      room.stack.assign(room.cut.rbegin(), room.cut.rend());
      choose(block_of(part, lobe), true, room);
      add_runs(part, lobe, rgb, room);
    }
  }
}

void BrightLights::add(const LightsLobe& lobe, int size, const std::array<float*, 6>& faces,
                       const Control& control) const {
  if (nodes_.empty()) return;
  const int edge = size >= 64 ? kMostEdge : kPartEdge;
  const int across = (size + edge - 1) / edge;
  const auto lights = static_cast<std::int64_t>(std::min<std::size_t>(lights_.size(), 1000));
  const auto placement = jobs::placement_for(std::int64_t{6} * size * size * lights);
  const std::size_t workers = jobs::worker_count(placement);
  jobs::run_tiles(static_cast<std::size_t>(6 * across), placement, workers, control,
                  [&](std::size_t tile, std::size_t /*worker*/) {
                    Room& room = rooms_->take();
                    const int face = static_cast<int>(tile) / across;
                    const int row = static_cast<int>(tile) % across * edge;
                    for (int column = 0; column < size; column += edge) {
                      add_to_area({face, size, column, row, std::min(column + edge, size), std::min(row + edge, size)},
                                  lobe, faces[static_cast<std::size_t>(face)], room);
                    }
                    rooms_->give_back(room);
                  });
}

}  // namespace welkin::reflections
