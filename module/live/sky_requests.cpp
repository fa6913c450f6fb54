#include "welkin/sky_requests.h"

#include "welkin/error.h"

namespace welkin {
namespace {

const std::shared_ptr<const SkyTables>& there(const std::shared_ptr<const SkyTables>& tables) {
  if (!tables) throw Error(ErrorCode::invalid_argument, "a sky's tables are a null pointer; precompute_sky makes some");
  return tables;
}

}  // namespace

std::shared_ptr<const SkyTables> PrecomputeSky::operator()(const Control& control) const {
  return std::make_shared<const SkyTables>(precompute_sky(atmosphere, options, control));
}

SkyCurve BakeSkyCurve::operator()(const Control& control) const {
  return SkyCurve(SkyView(there(tables), altitude_m), options, control);
}

std::shared_ptr<const PrefilteredSpecular> SkySpecular::operator()(const Control& control) const {
  return std::make_shared<const PrefilteredSpecular>(
      sky_specular(SkyView(there(tables), altitude_m), sun, options, {}, control));
}

}  // namespace welkin
