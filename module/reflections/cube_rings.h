// An environment on rings of latitude, as transforms take it. A cubemap's light comes there by a linear map that
// depends on sizes alone, and is kept for each.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

#include "platform/memory.h"
#include "projection/sanitized_pixels.h"
#include "reflections/bright_texels.h"
#include "reflections/halved_faces.h"
#include "reflections/ring_weights.h"
#include "transform/image_rows.h"
#include "welkin/core.h"
#include "welkin/image.h"

namespace welkin::reflections {

struct RingTableKey {
  int face_size;
  int rows;  ///< a multiple of four, 16 or more

  friend bool operator==(const RingTableKey&, const RingTableKey&) = default;
};

/// A lat-long of 2 rows x rows texels whose harmonics, its texels taken as areas, are those of a cubemap's texels taken
/// as areas. The light of each point of a texel goes to `kSpread` columns of `kSpread` rings, in such shares that the
/// moments below `kSpread` - 1 along both are those of the point. So what a function that is smooth over a few rings
/// makes of the lat-long is what it makes of the cubemap: degree l is right to about 0.02 (l pi / rows)^4, and so a
/// lobe needs no more rings than it is wide, however many texels the cube has. Values of single texels of the lat-long
/// mean nothing; they may be below 0.
///
/// Sixteen mirror images and quarter turns have the same weights, so a sixteenth's are kept. Weights of faces so large
/// that their table would take more than `kLargestTable` bytes are made again by each `fill`.
class RingTable {
 public:
  static constexpr std::size_t kLargestTable = std::size_t{112} << 20U;

  /// Returns a table from a bounded cache. Throws `Error` (cancelled) while it makes one.
  static std::shared_ptr<const RingTable> get(const RingTableKey& key, const Control& control = {});

  /// Makes a table on all threads. Keeps no weights of more than `largest` bytes. Throws `Error` (cancelled).
  explicit RingTable(const RingTableKey& key, const Control& control = {}, std::size_t largest = kLargestTable);

  /// Writes 2 rows x rows texels. `faces`: rows of packed RGB, face after face. The same bits on any number of threads.
  /// Throws `Error` (cancelled).
  void fill(const std::vector<const float*>& faces, float* rgb, const Control& control) const;

  [[nodiscard]] std::size_t bytes() const noexcept;
  /// Working memory of `fill`.
  [[nodiscard]] static std::size_t working_bytes(const RingTableKey& key) noexcept;
  /// A bound on what making the table takes, the table included.
  [[nodiscard]] static std::size_t making_bytes(const RingTableKey& key);

 private:
  /// A band's rings: see `RingWeights`.
  struct Band {
    std::vector<std::uint32_t> ends;  ///< [ring][columns / 8]: where taps begin; and the last one's end
    platform::AlignedBuffer<RingTap> taps;
  };

  [[nodiscard]] Band weigh(int band) const;
  void gather(const std::vector<const float*>& faces, const RingWeights::TexelRow& row, float* records) const;
  void sum(const RingRun& run, int ring, float* rgb) const;

  RingTableKey key_;
  RingWeights weights_;
  std::vector<Band> bands_;  ///< none: `fill` makes them again
};

/// The environment as the transform reads it: a lat-long of sanitized pixels, its bright texels extracted.
struct Rings {
  transforms::ImageRows view;
  platform::AlignedBuffer<float> owned{};  ///< holds the rows where the caller's own would not do

  [[nodiscard]] std::size_t bytes() const noexcept { return owned.bytes(); }
};

/// Returns a source's rows without `bright`, which go by rows. Those that have any are copied, and no others: a
/// panorama may have hundreds of megabytes.
[[nodiscard]] SourceRows rows_without(const std::vector<BrightTexel>& bright,
                                      const projection::SanitizedSource& source);

/// A cubemap's rows as a lat-long of 2 rows x rows texels with the same harmonics, by a `RingTable`. The same bits on
/// any number of threads. Throws `Error` (cancelled).
[[nodiscard]] Rings rings_of_cubemap(const std::vector<const float*>& faces, int rows, const Control& control);

/// A lat-long without `bright`, which go by rows: the caller's own rows but for those with bright texels.
[[nodiscard]] Rings rings_of_lat_long(const projection::SanitizedSource& source,
                                      const std::vector<BrightTexel>& bright);

/// A bound on what the rings of a cubemap of `size` take in addition to themselves, halved faces and a `RingTable` that
/// has yet to be made included.
[[nodiscard]] std::size_t cube_rings_bytes(int size, int face_size, int rows);

}  // namespace welkin::reflections
