#include "sky_subjects.h"

namespace welkin::perf {

std::shared_ptr<const SkyTables> earth_tables() {
  static const std::shared_ptr<const SkyTables> tables = [] {
    SkyTableOptions options;
    options.orders = 2;
    return std::make_shared<const SkyTables>(precompute_sky(earth_bruneton(), options));
  }();
  return tables;
}

}  // namespace welkin::perf
