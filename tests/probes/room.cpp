#include "probes/room.h"

#include "support/catch.h"
#include "support/images.h"

namespace welkin::test {
namespace {

constexpr double kPi = std::numbers::pi;
constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr double kAway = 1e-6;  // from a surface
constexpr int kMaxBounces = 5;

// The light is a rectangle just under the ceiling.
const dvec3 kLightLow{-1.5, 1.995, -0.35};
const dvec3 kLightHigh{-0.7, 1.995, 0.35};
const dvec3 kLightRadiance{18.0, 16.0, 13.0};

std::uint32_t mixed(std::uint32_t value) {
  value = (value ^ value >> 16U) * 0x7feb352dU;
  value = (value ^ value >> 15U) * 0x846ca68bU;
  return value ^ value >> 16U;
}

/// Returns a random number from 0 to 1.
double number(std::uint32_t& state) {
  state += 0x9e3779b9U;
  return (static_cast<double>(mixed(state)) + 0.5) / 4294967296.0;
}

/// Returns a random direction about a normal, distributed by the cosine.
dvec3 cosine_direction(const dvec3& normal, std::uint32_t& state) {
  const double turn = 2.0 * kPi * number(state);
  const double square = number(state);
  const dvec3 helper = std::abs(normal.x) > 0.5 ? dvec3(0, 1, 0) : dvec3(1, 0, 0);
  const dvec3 across = glm::normalize(glm::cross(normal, helper));
  const dvec3 along = glm::cross(normal, across);
  return std::sqrt(square) * (std::cos(turn) * across + std::sin(turn) * along) + std::sqrt(1.0 - square) * normal;
}

}  // namespace

Room::Room() {
  const dvec3 white(0.75);
  const dvec3 red(0.7, 0.08, 0.06);
  const dvec3 green(0.1, 0.55, 0.08);
  boxes_ = {
      {{-3, -1, -2}, {-2, 3, 2}, red},          {{2, -1, -2}, {3, 3, 2}, green},
      {{-2, -1, -2}, {2, 0, 2}, white},         {{-2, 2, -2}, {2, 3, 2}, white},
      {{-2, 0, -2}, {2, 2, -1}, white},         {{-2, 0, 1}, {2, 2, 2}, white},
      {{-0.04, 0, -1}, {0.04, 2, 0.35}, white}, {{-1.5, 0, -0.7}, {-0.9, 0.7, -0.1}, white},
  };
}

Room::Hit Room::trace(const dvec3& from, const dvec3& direction) const {
  Hit hit{kInfinity, {}, {}, {}, false, false};
  for (const Box& box : boxes_) {
    double enter = -kInfinity;
    double leave = kInfinity;
    int enter_axis = 0;
    int leave_axis = 0;
    for (int axis = 0; axis < 3; ++axis) {
      double first = (box.low[axis] - from[axis]) / direction[axis];
      double second = (box.high[axis] - from[axis]) / direction[axis];
      if (first > second) std::swap(first, second);
      if (first > enter) std::tie(enter, enter_axis) = std::pair(first, axis);
      if (second < leave) std::tie(leave, leave_axis) = std::pair(second, axis);
    }
    if (enter > leave || leave <= kAway) continue;
    const bool inside = enter <= kAway;
    const double distance = inside ? leave : enter;
    if (distance >= hit.distance) continue;
    dvec3 normal(0.0);
    const int axis = inside ? leave_axis : enter_axis;
    normal[axis] = direction[axis] > 0.0 ? -1.0 : 1.0;
    hit = {distance, from + distance * direction, normal, box.albedo, false, inside};
  }
  const double to_light = (kLightLow.y - from.y) / direction.y;
  const dvec3 position = from + to_light * direction;
  if (to_light > kAway && to_light < hit.distance && direction.y > 0.0 && position.x > kLightLow.x &&
      position.x < kLightHigh.x && position.z > kLightLow.z && position.z < kLightHigh.z) {
    hit = {to_light, position, {0, -1, 0}, {}, true, false};
  }
  return hit;
}

bool Room::free_between(const dvec3& from, const dvec3& to) const {
  const dvec3 way = to - from;
  const double length = glm::length(way);
  return trace(from, way / length).distance > length - 1e-4;
}

dvec3 Room::direct(const dvec3& position, const dvec3& normal, std::uint32_t& state) const {
  const dvec3 there{kLightLow.x + number(state) * (kLightHigh.x - kLightLow.x), kLightLow.y,
                    kLightLow.z + number(state) * (kLightHigh.z - kLightLow.z)};
  const dvec3 way = there - position;
  const double square = glm::dot(way, way);
  const double cosine = glm::dot(way, normal) / std::sqrt(square);
  const double at_light = way.y / std::sqrt(square);
  if (cosine <= 0.0 || at_light <= 0.0 || !free_between(position, there)) return dvec3(0.0);
  const double area = (kLightHigh.x - kLightLow.x) * (kLightHigh.z - kLightLow.z);
  return kLightRadiance * (cosine * at_light * area / square);
}

dvec3 Room::radiance(const dvec3& from, const dvec3& direction, std::uint32_t seed) const {
  std::uint32_t state = mixed(seed);
  dvec3 sum(0.0);
  dvec3 share(1.0);
  dvec3 position = from;
  dvec3 way = direction;
  for (int bounce = 0; bounce < kMaxBounces; ++bounce) {
    const Hit hit = trace(position, way);
    if (hit.is_light || hit.is_back || hit.distance == kInfinity) break;  // each surface samples the light directly
    position = hit.position + kAway * hit.normal;
    share *= hit.albedo;
    sum += share * direct(position, hit.normal, state) / kPi;
    way = cosine_direction(hit.normal, state);
  }
  return sum;
}

dvec3 Room::irradiance(const dvec3& position, const dvec3& normal, int paths, std::uint32_t seed) const {
  dvec3 sum(0.0);
  std::uint32_t state = mixed(seed);
  const dvec3 above = position + kAway * normal;
  for (int path = 0; path < paths; ++path) {
    const dvec3 way = cosine_direction(normal, state);
    state = mixed(state);
    sum += radiance(above, way, state);
  }
  return sum * (kPi / paths);
}

Captures Room::capture(const ProbeGrid& grid, int size, int paths) const {
  // Texels are in the order in which `Captures` reads them. Probes are independent, so that threads can share them.
  std::vector<std::vector<dvec3>> colours(grid.size());
  std::atomic<std::size_t> next{0};
  const auto work = [&] {
    for (std::size_t k = next++; k < grid.size(); k = next++) {
      std::uint32_t seed = mixed(static_cast<std::uint32_t>(k) + 77U);
      for (const dvec3& direction : texel_centres(size)) {
        dvec3 sum(0.0);
        for (int path = 0; path < paths; ++path) sum += radiance(grid.position(k), direction, seed++);
        colours[k].push_back(sum / static_cast<double>(std::max(1, paths)));
      }
    }
  };
  std::vector<std::thread> threads;
  for (int k = 0; k < 2; ++k) threads.emplace_back(work);
  for (std::thread& thread : threads) thread.join();
  std::vector<std::size_t> cursors(grid.size());
  return {grid.size(), size, [&](std::size_t k, const dvec3&) { return colours[k][cursors[k]++]; }, size,
          [&](std::size_t k, const dvec3& direction) {
            const Hit hit = trace(grid.position(k), direction);
            return static_cast<float>(hit.is_back ? -hit.distance : hit.distance);
          }};
}

}  // namespace welkin::test
