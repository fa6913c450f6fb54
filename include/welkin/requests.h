// What can be asked of a worker: Welkin's own calls, with the pixels or tables that they work on.
//
//   auto light = worker.post(welkin::Project{std::move(image), {.bands = 4}});
//   auto tables = worker.post(welkin::PrecomputeSky{welkin::earth()}, {.key = "sky tables"});
//
// Each request does what the call of the same name does, and throws what that throws. Any other callable is a request
// too: `worker.post([image](const welkin::Control& control) { return ...; })`. Requests about files are in bake_file.h.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "welkin/bake.h"
#include "welkin/core.h"
#include "welkin/image.h"
#include "welkin/projection.h"
#include "welkin/reflections.h"
#include "welkin/resampling.h"
#include "welkin/sky.h"

namespace WELKIN_EXPORT welkin {

struct Environment;  // environment_file.h

// ---- Pixels of a request

/// A picture for a request, together with what keeps its pixels alive. Copies share the pixels.
class EnvironmentSource {
 public:
  /// The pixels are moved into the request, without a copy, and are freed when it is done.
  EnvironmentSource(Cubemap image);       // NOLINT(google-explicit-constructor): a request is written as what it reads
  EnvironmentSource(LatLongImage image);  ///< moved in, too. NOLINT(google-explicit-constructor)
  EnvironmentSource(Environment environment);  ///< defined in welkin::files. NOLINT(google-explicit-constructor)
  /// The pixels are shared, all levels of a cubemap, and must not change until the job is ready.
  EnvironmentSource(std::shared_ptr<const Cubemap> image);       // NOLINT(google-explicit-constructor)
  EnvironmentSource(std::shared_ptr<const LatLongImage> image);  ///< shared, too. NOLINT(google-explicit-constructor)
  /// Pixels of any kind, and whatever frees them when its last copy goes, on whichever thread that is. If `owner` is
  /// empty, they must stay until the job is ready.
  EnvironmentSource(const EnvironmentView& view, std::shared_ptr<const void> owner);
  /// A cubemap with its mip chain, `mips[0]` the full size.
  EnvironmentSource(std::vector<CubemapView> mips, std::shared_ptr<const void> owner);

  /// The full size.
  [[nodiscard]] const EnvironmentView& view() const noexcept { return view_; }
  /// All levels of a cubemap that brought its mip chain; else empty.
  [[nodiscard]] std::span<const CubemapView> mips() const noexcept { return mips_; }
  /// Memory of the pixels in bytes, padding of rows included.
  [[nodiscard]] std::uint64_t bytes() const noexcept { return bytes_; }

 private:
  EnvironmentView view_;
  std::vector<CubemapView> mips_;
  std::shared_ptr<const void> owner_;
  std::uint64_t bytes_ = 0;
};

// ---- Requests about pixels

/// `project`.
struct Project {
  EnvironmentSource source;     ///< the pixels that are read
  ProjectionOptions options{};  ///< as of `project`

  [[nodiscard]] Projection operator()(const Control& control) const;
  /// Memory of the source in bytes, which counts against the limit of the worker.
  [[nodiscard]] std::uint64_t bytes() const noexcept { return source.bytes(); }
};

/// `to_cubemap`.
struct ToCubemap {
  EnvironmentSource source;  ///< the pixels that are read
  int size = 0;              ///< of the result: texels along an edge, 1 to 16384
  dmat3 turn = dmat3(1.0);   ///< orthogonal: direction d of the source becomes turn * d

  [[nodiscard]] Cubemap operator()(const Control& control) const;
  /// Memory of the source in bytes, which counts against the limit of the worker.
  [[nodiscard]] std::uint64_t bytes() const noexcept { return source.bytes(); }
};

/// `to_lat_long`.
struct ToLatLong {
  EnvironmentSource source;  ///< the pixels that are read
  int width = 0;             ///< of the result: texels, 1 to 65536
  int height = 0;            ///< of the result: texels, 1 to 32768
  dmat3 turn = dmat3(1.0);   ///< orthogonal: direction d of the source becomes turn * d

  [[nodiscard]] LatLongImage operator()(const Control& control) const;
  /// Memory of the source in bytes, which counts against the limit of the worker.
  [[nodiscard]] std::uint64_t bytes() const noexcept { return source.bytes(); }
};

/// `bake`. Its result is handed out by pointer, because it is large.
struct Bake {
  EnvironmentSource source;  ///< the pixels that are baked
  BakeOptions options{};     ///< what is made, and how

  [[nodiscard]] std::shared_ptr<const BakeResult> operator()(const Control& control) const;
  /// Memory of the source in bytes, which counts against the limit of the worker.
  [[nodiscard]] std::uint64_t bytes() const noexcept { return source.bytes(); }
};

/// `bake_to`: bakes into the caller's memory, such as a mapped upload buffer. The worker's threads read the source in
/// its format and write the targets in theirs, so the thread that posts converts no texel.
///
/// The memory of the targets must stay until the job is ready, or be kept alive by `owner`. Once the job is ready,
/// nothing writes to them. A job with a result has written every texel of its
/// targets. A job that never started, or whose targets were refused, has written nothing. Any other job without a
/// result (cancelled, replaced, failed) may have written any part of the texels.
///
/// Running jobs must not share targets: a job that another with its key replaces writes until it is ready, so give the
/// new one other memory.
struct BakeTo {
  EnvironmentSource source;  ///< the pixels that are baked
  BakeTargets targets{};     ///< where cubemaps are written
  BakeOptions options{};     ///< what is made, and how
  /// Frees the targets' memory when its last copy goes, on whichever thread that is; may be empty. The worker's copy
  /// goes right after the job is ready.
  std::shared_ptr<const void> owner{};

  /// Returns what `bake_to` returns.
  [[nodiscard]] std::shared_ptr<const BakeResult> operator()(const Control& control) const;
  /// Memory of the source in bytes, which counts against the limit of the worker.
  [[nodiscard]] std::uint64_t bytes() const noexcept { return source.bytes(); }
};

// ---- Requests about skies

/// `precompute_sky`. Handed out by pointer: views and curves share the tables.
struct PrecomputeSky {
  Atmosphere atmosphere;      ///< whose sky
  SkyTableOptions options{};  ///< sizes and orders of the tables

  [[nodiscard]] std::shared_ptr<const SkyTables> operator()(const Control& control) const;
};

/// `SkyCurve` of a height.
struct BakeSkyCurve {
  std::shared_ptr<const SkyTables> tables;  ///< of the atmosphere
  double altitude_m = 0.0;                  ///< the observer's, above the ground
  SkyCurveOptions options{};                ///< nodes of the curve

  [[nodiscard]] SkyCurve operator()(const Control& control) const;
};

/// `sky_specular`, without the sun's disc. Handed out by pointer.
struct SkySpecular {
  std::shared_ptr<const SkyTables> tables;  ///< of the atmosphere
  double altitude_m = 0.0;                  ///< the observer's, above the ground
  dvec3 sun{0.0, 1.0, 0.0};                 ///< unit, towards it
  PrefilterOptions options{.size = 32};     ///< of the chain

  [[nodiscard]] std::shared_ptr<const PrefilteredSpecular> operator()(const Control& control) const;
};

}  // namespace welkin
