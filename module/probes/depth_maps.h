// Statistics of the distances around a probe: how much of what it sees is near or a back, and the means by direction.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "welkin/core.h"
#include "welkin/probes.h"

namespace welkin::probes {

/// Throws `Error` (invalid_argument) unless all views can be read and have one size.
void check_depths(std::span<const DepthView> depths);
/// Throws `Error` (invalid_argument) unless there is one for each probe.
void require_count(const char* name, std::size_t is, std::size_t must_be);
/// Throws `Error` (rejected_pixel).
[[noreturn]] void refuse_nan_depth(std::size_t probe);

/// Returns the solid angles of a face's texels, sr, [size][size]; alike on all faces.
[[nodiscard]] std::vector<double> face_solid_angles(int size);

/// A row of texels.
[[nodiscard]] const float* row_of(const DepthView& view, int face, int row) noexcept;

/// Rules for which distances count and how, and the map's size and lobe.
struct DepthRules {
  double near_distance;   ///< what is seen nearer counts against the probe
  double distance_limit;  ///< larger distances count as it
  int distance_size;      ///< of the map, without its border; 0: none
  int distance_power;     ///< of the cosine
};

/// Reads depths of one size. Tables are made once; then any number of threads may read, each with its own scratch.
class DepthMaps {
 public:
  DepthMaps(int size, const DepthRules& rules);

  /// The memory of one thread.
  class Scratch {
   public:
    explicit Scratch(const DepthMaps& maps);

   private:
    friend class DepthMaps;
    std::vector<double> columns_;  ///< of a row of blocks, [3][size]: sums of distance, of its square, of what is bad
    std::vector<double> blocks_;   ///< [blocks][2]: means
  };

  /// Writes (distance_size + 2)^2 x 2 floats, and returns the fraction of the sphere that is neither near nor a back;
  /// below 0 if a depth is NaN. Allocates nothing.
  [[nodiscard]] float read(const DepthView& depths, Scratch& scratch, std::span<float> distances) const noexcept;

 private:
  /// The weight of a block in a texel of the map.
  struct Share {
    std::uint32_t block;
    double weight;
  };

  /// Returns the first texel of a block: the least k with floor(k edge / size) = block, ceil(block size / edge).
  [[nodiscard]] int first_of(int block) const noexcept { return (block * size_ + edge_ - 1) / edge_; }
  void add_row(const float* depths, int row, Scratch& scratch, bool& is_number) const noexcept;
  void gather_shares(int column, int row);
  void write_map(const Scratch& scratch, std::span<float> distances) const noexcept;

  int size_;
  int edge_;  ///< blocks along an edge of a face
  DepthRules rules_;
  std::vector<double> solid_angles_;      ///< [size][size] of texels, alike on all faces
  std::vector<double> block_angles_;      ///< [edge][edge] of blocks, alike on all faces
  std::vector<dvec3> directions_;         ///< of the middles of all blocks
  std::vector<Share> shares_;             ///< of all texels of the map
  std::vector<std::size_t> first_share_;  ///< of each texel, and where the last one's end
};

}  // namespace welkin::probes
