// Blurred mips of small cubemaps as sums over texels: a linear map that depends on sizes and lobes alone, and is kept.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

#include "platform/memory.h"
#include "reflections/cube_levels.h"
#include "reflections/lobe_errors.h"
#include "reflections/ring_kernels.h"
#include "welkin/core.h"
#include "welkin/image.h"

namespace welkin::reflections {

struct LobeMip {
  int size;
  double alpha;

  friend bool operator==(const LobeMip&, const LobeMip&) = default;
};

struct LobeTableKey {
  int face_size;
  std::vector<LobeMip> mips;

  friend bool operator==(const LobeTableKey&, const LobeTableKey&) = default;
};

/// Weights of a mip's texels. A texel near by has the lobe's integral over it. What is farther away is read from
/// coarser levels of the cube's light (`CubeLevel`), the coarser the farther, as the lobe changes slowly there; the
/// levels are joined by giving every point the difference between the lobe and what the coarser levels have of it.
///
/// Sixteen mirror images and quarter turns have the same weights, so those of a sixteenth of the texels are kept. A
/// mip's weights depend on the size of the faces and on that mip alone.
class LobeTable {
 public:
  /// Whether a mip may be made so: faces of 8 to 64 texels, an even number; a mip of half that or less.
  [[nodiscard]] static bool serves(int face_size, const LobeMip& mip) noexcept;

  /// From a bounded cache. All mips are served. Throws `Error` (cancelled) while it makes one.
  static std::shared_ptr<const LobeTable> get(const LobeTableKey& key, const Control& control = {});

  /// Throws `Error` (cancelled).
  explicit LobeTable(const LobeTableKey& key, const Control& control = {});

  /// Floats of room that `fill` needs.
  [[nodiscard]] std::size_t room_floats() const noexcept { return room_floats_; }

  /// Writes the texels of all mips to packed RGB faces. `source`: rgb32f. The same bits on any number of threads and
  /// instruction set. Throws `Error` (cancelled).
  void fill(const CubemapView& source, float* room, const std::vector<std::array<float*, 6>>& mips, bool not_negative,
            const Control& control) const;

  /// What the weights of a mip err by.
  [[nodiscard]] const LobeErrors& errors(std::size_t mip) const noexcept { return mips_[mip].errors; }

  [[nodiscard]] std::size_t bytes() const noexcept;
  /// Bounds on what `fill` takes, and on what making the table takes, itself included.
  [[nodiscard]] static std::size_t working_bytes(int face_size) noexcept;
  [[nodiscard]] static std::size_t making_bytes(const LobeTableKey& key) noexcept;

 private:
  /// Points of a level's row, where all images have them.
  struct Run {
    std::array<std::uint32_t, kRingImages> from;  ///< the first, in floats of the room
    std::array<std::int32_t, kRingImages> step;
    int count;
    std::uint32_t record;  ///< of the first
  };
  /// Two by two texels of a mip, those of them that lie in the sixteenth.
  struct Group {
    int face;
    int row;
    int column;
    std::uint32_t texels;  ///< bit k: texel k is one
    std::size_t first;     ///< of its taps
    std::size_t end;
    std::size_t place = 0;  ///< of its first texel's images among the mip's
  };
  /// Of a mip's texel.
  struct TexelPlace {
    std::uint16_t face;
    std::uint16_t texel;  ///< of the face, row by row
  };
  struct Mip {
    int size;
    LobeErrors errors;
    std::vector<Group> groups;
    std::vector<TexelPlace> places;  ///< [texel of the sixteenth][image]
  };
  class Builder;
  class Filling;

  [[nodiscard]] std::size_t scratch_floats() const noexcept;

  int face_size_;
  std::vector<CubeLevel> levels_;
  std::vector<std::size_t> level_starts_;  ///< in the room
  std::size_t room_floats_ = 0;
  std::size_t records_start_ = 0;
  std::vector<float> steradians_;  ///< of a face's texels
  std::vector<Run> runs_;
  std::vector<Mip> mips_;
  std::vector<GroupTap> taps_;
};

}  // namespace welkin::reflections
