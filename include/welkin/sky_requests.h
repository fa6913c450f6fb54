// What can be asked of a worker about skies: Welkin's own calls, as in requests.h.
//
//   auto job = worker.post(welkin::PrecomputeSky{welkin::earth()}, {.key = "sky tables"});
#pragma once

#include <cstddef>
#include <functional>
#include <glm/vec3.hpp>
#include <memory>

#include "welkin/atmosphere.h"
#include "welkin/control.h"
#include "welkin/export.h"
#include "welkin/sky_harmonics.h"
#include "welkin/sky_tables.h"
#include "welkin/sky_view.h"
#include "welkin/specular.h"

namespace WELKIN_EXPORT welkin {

/// `precompute_sky`. Handed out by pointer: views and curves share the tables.
struct PrecomputeSky {
  Atmosphere atmosphere;      ///< whose sky
  SkyTableOptions options{};  ///< sizes and orders of the tables

  [[nodiscard]] std::shared_ptr<const SkyTables> operator()(const Control& control) const;
  friend bool operator==(const PrecomputeSky&, const PrecomputeSky&) = default;
};

/// `SkyCurve` of a height. Equal are the same tables in memory: values are not compared.
struct BakeSkyCurve {
  std::shared_ptr<const SkyTables> tables;  ///< of the atmosphere
  double altitude_m = 0.0;                  ///< the observer's, above the ground
  SkyCurveOptions options{};                ///< nodes of the curve

  [[nodiscard]] SkyCurve operator()(const Control& control) const;
  [[nodiscard]] std::size_t hash() const noexcept { return std::hash<const void*>()(tables.get()); }
  friend bool operator==(const BakeSkyCurve&, const BakeSkyCurve&) = default;
};

/// `sky_specular`, without the sun's disc. Handed out by pointer.
struct SkySpecular {
  std::shared_ptr<const SkyTables> tables;  ///< of the atmosphere
  double altitude_m = 0.0;                  ///< the observer's, above the ground
  glm::dvec3 sun{0.0, 1.0, 0.0};            ///< unit, towards it
  PrefilterOptions options{.size = 32};     ///< of the chain

  [[nodiscard]] std::shared_ptr<const PrefilteredSpecular> operator()(const Control& control) const;
  [[nodiscard]] std::size_t hash() const noexcept { return std::hash<const void*>()(tables.get()); }
  friend bool operator==(const SkySpecular&, const SkySpecular&) = default;
};

}  // namespace welkin
