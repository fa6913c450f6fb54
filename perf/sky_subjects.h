// Earth's sky, and the ways to its harmonics that are compared.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "welkin/sky_harmonics.h"
#include "welkin/sky_tables.h"

namespace welkin::perf {

/// Default tables of Bruneton's Earth, two orders; made once.
[[nodiscard]] std::shared_ptr<const SkyTables> earth_tables();

struct SkyMethod {
  std::string name;        ///< of the quadrature
  std::string setting;     ///< zeniths x azimuths
  std::string directions;  ///< that it stands for: both sides of the sun
  SkyHarmonicsOptions options;
};

/// From coarse to fine.
[[nodiscard]] std::vector<SkyMethod> sky_methods();

}  // namespace welkin::perf
