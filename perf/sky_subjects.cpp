#include "sky_subjects.h"

namespace welkin::perf {

std::shared_ptr<const SkyTables> earth_tables() {
  static const std::shared_ptr<const SkyTables> tables = [] {
    SkyTableOptions options;
    options.orders = 2;
    return std::make_shared<const SkyTables>(precompute_sky(earth(), options));
  }();
  return tables;
}

std::vector<SkyMethod> sky_methods() {
  std::vector<SkyMethod> methods;
  const auto add = [&](SkyQuadrature quadrature, int zeniths, int azimuths) {
    const int rings = quadrature == SkyQuadrature::article ? zeniths : 2 * zeniths;
    methods.push_back({name(quadrature),
                       std::to_string(zeniths) + "x" + std::to_string(azimuths),
                       std::to_string(rings * azimuths * 2),
                       {.bands = 3, .quadrature = quadrature, .zeniths = zeniths, .azimuths = azimuths}});
  };
  add(SkyQuadrature::article, 16, 16);
  add(SkyQuadrature::article, 64, 64);
  for (const int size : {8, 16, 32}) add(SkyQuadrature::gauss, size, size);
  add(SkyQuadrature::gauss_split, 8, 8);
  add(SkyQuadrature::gauss_split, 12, 12);
  add(SkyQuadrature::gauss_split, 16, 16);
  add(SkyQuadrature::gauss_split, 32, 32);
  return methods;
}

}  // namespace welkin::perf
