// A brightness over suns that stand at the nodes of a table, between those nodes.
#pragma once

#include <span>
#include <vector>

namespace welkin::sky {

/// Straight pieces between two nodes.
inline constexpr int kSunSteps = 32;

/// A brightness that is known at nodes and falls by decades between suns, kSunSteps times as densely:
/// (nodes - 1) kSunSteps + 1 values. Between nodes its logarithm is the cubic through the four nearest, where one of
/// them is 0 the straight line between the two nearest, and where one of those is 0 a straight line it is; it leaves
/// the range of the two nearest by no more than a tenth, and what is below 1e-30 is 0. Where a step of nodes changes
/// the brightness by a factor e, straight lines between what is returned are within 1.3e-4.
[[nodiscard]] std::vector<float> resample_log_cubic(std::span<const double> nodes);

/// Of a brightness that something else is told relative to: no node is darker than a hundredth of either neighbour, as
/// what is left where light goes out may come from one direction alone and tells nothing of the sun before.
void limit_decay(std::span<double> nodes) noexcept;

}  // namespace welkin::sky
