// What a bake will do, what it needs and what it is expected to cost: settled before any of it runs.
#pragma once

#include <cstdint>
#include <string>

#include "welkin/bake.h"

namespace welkin::baking {

/// What a source looks like from outside.
struct SourceShape {
  bool cubemap;
  int columns;  ///< of a lat-long, or of a face
  int rows;     ///< of a lat-long, or of six faces
  PixelFormat format;

  [[nodiscard]] std::uint64_t texels() const noexcept {
    return static_cast<std::uint64_t>(columns) * static_cast<std::uint64_t>(rows);
  }
  /// "lat-long 1024 x 512", "cubemap of 256"
  [[nodiscard]] std::string words() const;
};

[[nodiscard]] SourceShape shape_of(const LatLongView& view);
[[nodiscard]] SourceShape shape_of(const CubemapView& view);

/// Nanoseconds of one thread that a pass is expected to take: only ratios count.
struct PassCosts {
  double clean = 1.0;
  double background = 1.0;
  double background_mips = 1.0;
  double specular = 1.0;
  double project = 1.0;
  double irradiance = 1.0;
  double brdf = 1.0;
};

struct BakePlan {
  int background_size = 0;    ///< 0: none
  int background_levels = 0;  ///< 0: none
  int specular_size = 0;      ///< 0: none
  int specular_mips = 0;
  bool same_level = false;  ///< specular mip 0 is the background's level 0
  bool cleans = false;      ///< some pass wants clean RGB floats
  ProjectionOptions projecting{};

  std::uint64_t result_bytes = 0;
  std::uint64_t working_bytes = 0;  ///< at most
  PassCosts costs{};
};

/// Working memory of all passes that may run at the same time, at most; the plan's sizes must be there.
[[nodiscard]] std::uint64_t working_bytes(const SourceShape& source, const BakeOptions& options, const BakePlan& plan);
[[nodiscard]] PassCosts expected_costs(const SourceShape& source, const BakeOptions& options, const BakePlan& plan);

/// Throws `Error` (invalid_argument) for options that are out of range or do not go together.
[[nodiscard]] BakePlan plan_bake(const SourceShape& source, const BakeOptions& options);

/// Throws `Error` (limit_exceeded) if the plan needs more than the options allow.
void require_memory(const BakePlan& plan, const BakeOptions& options);

}  // namespace welkin::baking
