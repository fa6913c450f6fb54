// Requests for a worker: Welkin's calls together with the pixels or tables that they work on.
//
//   auto light = worker.post(welkin::Project{std::move(image), {.bands = 4}});
//   auto tables = worker.post(welkin::PrecomputeSky{welkin::earth()}, {.key = "sky tables"});
//   auto probe = worker.post(welkin::Bake{std::move(image)});  // its result is a std::shared_ptr<const BakeResult>
//
// Each request does what the function of the same name does, and fails with the same errors. Any other callable is a
// request too: `worker.post([image](const welkin::Control& control) { return ...; })`. bake_file.h has the requests
// that read files.
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

/// Pixels of a request together with their owner. Copies share the pixels.
class EnvironmentSource {
 public:
  /// Takes ownership of the pixels without copying them, and frees them when the request is done.
  EnvironmentSource(Cubemap image);       // NOLINT(google-explicit-constructor): a request is written as what it reads
  EnvironmentSource(LatLongImage image);  ///< takes ownership, too. NOLINT(google-explicit-constructor)
  EnvironmentSource(Environment environment);  ///< defined in welkin::files. NOLINT(google-explicit-constructor)
  /// Shares the pixels, all mips of a cubemap, which must not change until the job is ready.
  EnvironmentSource(std::shared_ptr<const Cubemap> image);       // NOLINT(google-explicit-constructor)
  EnvironmentSource(std::shared_ptr<const LatLongImage> image);  ///< shares, too. NOLINT(google-explicit-constructor)
  /// Refers to pixels of any kind. `owner` keeps them alive; its last copy may be destroyed on any thread. If `owner`
  /// is empty, the pixels must stay valid until the job is ready.
  EnvironmentSource(const EnvironmentView& view, std::shared_ptr<const void> owner);
  /// Refers to a cubemap with its mips, `mips[0]` the full size. `owner` keeps the pixels alive.
  EnvironmentSource(std::vector<CubemapView> mips, std::shared_ptr<const void> owner);

  /// Returns the view of the full size.
  [[nodiscard]] const EnvironmentView& view() const noexcept { return view_; }
  /// Returns the mips of a cubemap that came with them, otherwise nothing.
  [[nodiscard]] std::span<const CubemapView> mips() const noexcept { return mips_; }
  /// Returns the size of the pixels in bytes, including padding of rows.
  [[nodiscard]] std::uint64_t bytes() const noexcept { return bytes_; }

 private:
  EnvironmentView view_;
  std::vector<CubemapView> mips_;
  std::shared_ptr<const void> owner_;
  std::uint64_t bytes_ = 0;
};

// ---- Requests about pixels

/// Request for `project`.
struct Project {
  EnvironmentSource source;     ///< pixels to project
  ProjectionOptions options{};  ///< options of `project`

  [[nodiscard]] Projection operator()(const Control& control) const;
  /// Returns the size of the source in bytes, which counts against the worker's limit.
  [[nodiscard]] std::uint64_t bytes() const noexcept { return source.bytes(); }
};

/// Request for `to_cubemap`.
struct ToCubemap {
  EnvironmentSource source;     ///< pixels to resample
  int size = 0;                 ///< texels per edge of the result, 1 to 16384
  dmat3 rotation = dmat3(1.0);  ///< orthogonal matrix: direction d of the source becomes rotation * d

  [[nodiscard]] Cubemap operator()(const Control& control) const;
  /// Returns the size of the source in bytes, which counts against the worker's limit.
  [[nodiscard]] std::uint64_t bytes() const noexcept { return source.bytes(); }
};

/// Request for `to_lat_long`.
struct ToLatLong {
  EnvironmentSource source;     ///< pixels to resample
  int width = 0;                ///< width of the result, 1 to 65536
  int height = 0;               ///< height of the result, 1 to 32768
  dmat3 rotation = dmat3(1.0);  ///< orthogonal matrix: direction d of the source becomes rotation * d

  [[nodiscard]] LatLongImage operator()(const Control& control) const;
  /// Returns the size of the source in bytes, which counts against the worker's limit.
  [[nodiscard]] std::uint64_t bytes() const noexcept { return source.bytes(); }
};

/// Request for `bake`. The result is large and therefore returned by pointer.
struct Bake {
  EnvironmentSource source;  ///< pixels to bake
  BakeOptions options{};     ///< options of the bake

  [[nodiscard]] std::shared_ptr<const BakeResult> operator()(const Control& control) const;
  /// Returns the size of the source in bytes, which counts against the worker's limit.
  [[nodiscard]] std::uint64_t bytes() const noexcept { return source.bytes(); }
};

/// Request for `bake_to`: bakes into the caller's memory, such as a mapped upload buffer. Conversion to and from half
/// floats happens on the worker's threads.
///
/// The targets' memory must stay valid until the job is ready, or be kept alive by `owner`. It is not written after the
/// job is ready. If the job has a result, every texel of its targets has been written. If it never started, or its
/// targets were refused, nothing has been written. If it was cancelled, replaced or failed otherwise, targets may be
/// partly written.
///
/// Running jobs must not share targets. A job that is replaced by another with its key may write until it is ready, so
/// give the new job other memory.
struct BakeTo {
  EnvironmentSource source;  ///< pixels to bake
  BakeTargets targets{};     ///< memory to which cubemaps are written
  BakeOptions options{};     ///< options of the bake
  /// Keeps the targets' memory alive; may be empty. The worker destroys its copy right after the job is ready, on any
  /// thread.
  std::shared_ptr<const void> owner{};

  /// Returns the result of `bake_to`.
  [[nodiscard]] std::shared_ptr<const BakeResult> operator()(const Control& control) const;
  /// Returns the size of the source in bytes, which counts against the worker's limit.
  [[nodiscard]] std::uint64_t bytes() const noexcept { return source.bytes(); }
};

// ---- Requests about skies

/// Request for `precompute_sky`. The result is returned by pointer, because views and curves share the tables.
struct PrecomputeSky {
  Atmosphere atmosphere;      ///< the atmosphere to compute
  SkyTableOptions options{};  ///< sizes of the tables and orders of scattering

  [[nodiscard]] std::shared_ptr<const SkyTables> operator()(const Control& control) const;
};

/// Request for a `SkyCurve` at one altitude.
struct BakeSkyCurve {
  std::shared_ptr<const SkyTables> tables;  ///< scattering tables of the atmosphere
  double altitude_m = 0.0;                  ///< altitude of the observer above the ground
  SkyCurveOptions options{};                ///< nodes of the curve

  [[nodiscard]] SkyCurve operator()(const Control& control) const;
};

/// Request for `sky_specular`, without the sun's disc. The result is returned by pointer.
struct SkySpecular {
  std::shared_ptr<const SkyTables> tables;  ///< scattering tables of the atmosphere
  double altitude_m = 0.0;                  ///< altitude of the observer above the ground
  dvec3 sun{0.0, 1.0, 0.0};                 ///< unit vector towards the sun
  PrefilterOptions options{.size = 32};     ///< options of the specular chain

  [[nodiscard]] std::shared_ptr<const PrefilteredSpecular> operator()(const Control& control) const;
};

}  // namespace welkin
