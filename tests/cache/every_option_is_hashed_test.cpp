// No field that a result depends on is left out of its hash, and none that it does not depend on is in it.
#include <functional>
#include <set>
#include <vector>

#include "support/catch.h"
#include "welkin/content_hash.h"

namespace {

using namespace welkin;

/// Every change gives a hash of its own.
template <class Options>
void check_changes(const Options& plain, const std::vector<std::function<void(Options&)>>& changes) {
  std::set<ContentHash> seen{hash_options(plain)};
  for (std::size_t k = 0; k < changes.size(); ++k) {
    Options options = plain;
    changes[k](options);
    INFO("change " << k);
    CHECK(seen.insert(hash_options(options)).second);
  }
}

template <class Options>
void check_without_effect(const Options& plain, const std::function<void(Options&)>& change) {
  Options options = plain;
  change(options);
  CHECK(hash_options(options) == hash_options(plain));
}

TEST_CASE("options: every field of a projection counts") {
  using Options = ProjectionOptions;
  check_changes<Options>({}, {[](Options& o) { o.bands = 4; }, [](Options& o) { o.quadrature = Quadrature::midpoint; },
                              [](Options& o) { o.target_size = 4; }, [](Options& o) { o.clamp = RadianceClamp{}; },
                              [](Options& o) { o.clamp = RadianceClamp{2.0F}; },
                              [](Options& o) {
                                o.clamp = RadianceClamp{2.0F, true};
                              },
                              [](Options& o) { o.gamma = true; }, [](Options& o) { o.nan = NonFinitePolicy::reject; },
                              [](Options& o) { o.infinity = NonFinitePolicy::reject; },
                              [](Options& o) { o.negative = NegativePolicy::replace; },
                              [](Options& o) { o.negative = NegativePolicy::reject; }});
}

TEST_CASE("options: every field of a prefilter counts, but what it does not use of its pixels") {
  using Options = PrefilterOptions;
  check_changes<Options>(
      {}, {[](Options& o) { o.size = 4; }, [](Options& o) { o.mips = 4; }, [](Options& o) { o.roughness = {0.5}; },
           [](Options& o) {
             o.roughness = {0.5, 0.5};
           },
           [](Options& o) { o.method = PrefilterMethod::sampled; }, [](Options& o) { o.rms_error = 0.5; },
           [](Options& o) { o.maximum_error = 0.5; }, [](Options& o) { o.samples = 4; },
           [](Options& o) { o.pixels.gamma = true; }, [](Options& o) { o.pixels.clamp = RadianceClamp{}; }});
  check_without_effect<Options>({}, [](Options& o) { o.pixels.bands = 7; });
}

TEST_CASE("options: every field of a bake counts, but its limit and what is not used") {
  using Options = BakeOptions;
  check_changes<Options>(
      {},
      {[](Options& o) { o.background_size = 4; }, [](Options& o) { o.background = false; },
       [](Options& o) { o.background_mips = false; }, [](Options& o) { o.mip_filter = MipFilter::box; },
       [](Options& o) { o.specular.reset(); }, [](Options& o) { o.specular->size = 4; },
       [](Options& o) { o.irradiance_size = 4; }, [](Options& o) { o.irradiance_method = IrradianceMethod::direct; },
       [](Options& o) { o.bands = 4; }, [](Options& o) { o.brdf.reset(); }, [](Options& o) { o.brdf->width = 4; },
       [](Options& o) { o.brdf->height = 4; }, [](Options& o) { o.brdf->model = BrdfModel::multiple_scattering; },
       [](Options& o) { o.brdf->sheen = false; }, [](Options& o) { o.pixels.nan = NonFinitePolicy::reject; }});
  check_without_effect<Options>({}, [](Options& o) {
    o.memory_limit_bytes = 5;
    o.pixels.bands = 7;
    o.specular->pixels.gamma = true;
  });
}

TEST_CASE("options: every field of reading counts, but its limit") {
  using Options = ReadOptions;
  check_changes<Options>(
      {}, {[](Options& o) { o.layout = Layout::lat_long; }, [](Options& o) { o.part = std::string("a"); },
           [](Options& o) { o.layer = std::string("a"); }, [](Options& o) { o.level = 1; },
           [](Options& o) { o.transfer = Transfer::linear; }, [](Options& o) { o.primaries = Primaries::as_stored; }});
  check_without_effect<Options>({}, [](Options& o) { o.memory_limit_bytes = 5; });
}

TEST_CASE("options: every field of sky tables counts, but their limit") {
  using Options = SkyTableOptions;
  check_changes<Options>(
      {}, {[](Options& o) { o.layout = ScatteringLayout::compact; }, [](Options& o) { o.heights = 9; },
           [](Options& o) { o.view_zeniths = 9; }, [](Options& o) { o.sun_zeniths = 9; },
           [](Options& o) { o.sun_angles = 9; }, [](Options& o) { o.transmittance_heights = 9; },
           [](Options& o) { o.transmittance_zeniths = 9; }, [](Options& o) { o.irradiance_heights = 9; },
           [](Options& o) { o.irradiance_sun_zeniths = 9; }, [](Options& o) { o.lowest_sun_degrees = -9.0; },
           [](Options& o) { o.orders = 9; }, [](Options& o) { o.until_change = 0.5; },
           [](Options& o) { o.colour = SkyColour::linear_srgb; }});
  check_without_effect<Options>({}, [](Options& o) { o.memory_limit_bytes = 5; });
}

TEST_CASE("options: every field of an atmosphere counts, but its name") {
  using Options = Atmosphere;
  check_changes<Options>(
      earth(), {[](Options& o) { o.wavelengths_nm[1] = 500.0; }, [](Options& o) { o.bottom_radius_m += 1.0; },
                [](Options& o) { o.top_radius_m += 1.0; }, [](Options& o) { o.rayleigh.scattering_per_m[2] *= 2.0; },
                [](Options& o) {
                  o.rayleigh.absorption_per_m = {0.0, 0.0, 1.0};
                },
                [](Options& o) { o.rayleigh.density[0].thickness_m += 1.0; },
                [](Options& o) { o.rayleigh.density[0].exponential_term += 1.0; },
                [](Options& o) { o.rayleigh.density[0].exponential_scale_per_m += 1.0; },
                [](Options& o) { o.rayleigh.density[0].linear_term_per_m += 1.0; },
                [](Options& o) { o.rayleigh.density[0].constant_term += 1.0; }, [](Options& o) { o.aerosol = {}; },
                [](Options& o) { o.aerosol_phase = AerosolPhase::henyey_greenstein; },
                [](Options& o) { o.aerosol_asymmetry = 0.1; }, [](Options& o) { o.absorbers.clear(); },
                [](Options& o) { o.ground_albedo.clear(); }, [](Options& o) { o.solar_irradiance[0] *= 2.0; },
                [](Options& o) { o.sun_angular_radius_degrees = 1.0; }});
  check_without_effect<Options>(earth(), [](Options& o) { o.name = std::string("another"); });
}

}  // namespace
