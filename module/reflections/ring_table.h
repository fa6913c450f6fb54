// A cubemap's light on rings of latitude: a linear map that depends on sizes alone, and is kept for each.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

#include "reflections/ring_kernels.h"
#include "welkin/core.h"
#include "welkin/image.h"

namespace welkin::reflections {

struct RingTableKey {
  int face_size;
  int rows;

  friend bool operator==(const RingTableKey&, const RingTableKey&) = default;
};

/// A lat-long of 2 rows x rows texels whose harmonics, its texels taken as areas, are those of a cubemap's texels taken
/// as areas. Gauss points stand for a texel; each point's light goes to `kSpread` columns of `kSpread` rings, in such
/// shares that the moments below `kSpread` - 1 along both are those of the point. So what a function that is smooth
/// over a few rings makes of the lat-long is what it makes of the cubemap: degree l is right to some 0.02 (l pi /
/// rows)^4, and so a lobe needs no more rings than it is wide, however many texels the cube has. Values of single
/// texels of the lat-long mean nothing; they may be below 0.
///
/// Sixteen mirror images and quarter turns have the same weights, so a sixteenth's are kept.
class RingTable {
 public:
  static constexpr int kSpread = 5;

  /// Whether such a table may be made: the face has an even size, `rows` is a multiple of four, 16 or more, and the
  /// table not too large to be kept.
  [[nodiscard]] static bool serves(const RingTableKey& key) noexcept;

  /// From a bounded cache. For sizes that it serves. Throws `Error` (cancelled) while it makes one.
  static std::shared_ptr<const RingTable> get(const RingTableKey& key, const Control& control = {});

  /// Throws `Error` (cancelled).
  explicit RingTable(const RingTableKey& key, const Control& control = {});

  /// Writes 2 rows x rows texels. `source`: rgb32f. The same bits on any number of threads. Throws `Error` (cancelled).
  void fill(const CubemapView& source, float* rgb, const Control& control) const;

  [[nodiscard]] std::size_t bytes() const noexcept;
  /// What `fill` takes while it runs.
  [[nodiscard]] static std::size_t working_bytes(const RingTableKey& key) noexcept;
  /// A bound on what making the table takes, the table and the lists that it is made from.
  [[nodiscard]] static std::size_t making_bytes(const RingTableKey& key) noexcept;

 private:
  /// Texels of a face's row.
  struct Run {
    int face;
    int row;
    int first;
    int count;
    std::uint32_t record;  ///< of the first
  };
  class Builder;

  void gather(const CubemapView& source, const Run& run, float* records) const;

  RingTableKey key_;
  std::size_t record_count_ = 0;
  std::vector<Run> runs_;
  std::vector<std::uint32_t> ends_;  ///< [rows / 2][columns / 8 + 1]
  std::vector<RingTap> taps_;
};

}  // namespace welkin::reflections
