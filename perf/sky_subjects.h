// Earth's sky.
#pragma once

#include <memory>

#include "welkin/sky.h"

namespace welkin::perf {

/// Default tables of Bruneton's Earth, two orders; made once.
[[nodiscard]] std::shared_ptr<const SkyTables> earth_tables();

}  // namespace welkin::perf
