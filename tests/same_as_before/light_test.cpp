// Promise: results for harmonics, irradiance, suns and content hashes are bit-identical to those on record
// (see projections_test.cpp).
#include "cache/recipe.h"
#include "support/catch.h"
#include "support/random_harmonics.h"
#include "support/recorded_results.h"
#include "support/temporary_directory.h"
#include "support/test_environments.h"
#include "welkin/engines.h"
#include "welkin/environment_file.h"
#include "welkin/projection.h"
#include "welkin/result_cache.h"
#include "welkin/sky.h"
#include "welkin/spherical_harmonics.h"

namespace welkin::test {
namespace {

SphericalHarmonics harmonics(int bands, std::uint32_t seed) { return RandomLight(seed).harmonics(bands); }

/// A grey sky and a strong light: ringing makes some of its irradiance negative.
SphericalHarmonics lit(int bands) {
  return add(constant_radiance({0.3, 0.4, 0.5}, bands),
             point_light(glm::normalize(glm::dvec3(0.3, 0.8, -0.5)), {5.0, 4.0, 3.0}, bands));
}

std::vector<glm::dvec3> normals() {
  RandomLight random(21);
  std::vector<glm::dvec3> result{{1, 0, 0}, {0, 1, 0}, {0, 0, -2}, {0, -1, 0}};
  for (int i = 0; i < 8; ++i) result.push_back(random.direction());
  return result;
}

std::uint64_t bits_of_errors(const std::vector<IrradianceError>& errors) {
  BitHash hash;
  for (const IrradianceError& error : errors) add_bits(hash, error);
  return hash.value();
}

/// The image without its sun, and the sun.
template <class Image>
std::uint64_t bits_without_sun(Image image, const SunOptions& options = {}) {
  const std::optional<Sun> sun = extract_sun(image, options);
  return bits_of(image, sun);
}

LatLongImage wide_image(Content content) { return {128, 64, make_lat_long(content, 128, 64, 31).pixels}; }

Cubemap cube_image(Content content) { return {64, make_cubemap(content, 64, 3, 32).pixels}; }

}  // namespace

TEST_CASE("The algebra of harmonics is the same as before", "[same_as_before]") {
  const glm::dquat rotation = RandomLight(20).rotation();
  const glm::dmat3 mirror = glm::dmat3(-1, 0, 0, 0, 0, 1, 0, 1, 0);
  require_as_recorded(
      "harmonics", {
                       {"basis_of_16_bands",
                        [] {
                          std::vector<double> values(256);
                          BitHash hash;
                          for (const glm::dvec3& normal : normals()) {
                            evaluate_basis(glm::normalize(normal), 16, values);
                            add_bits(hash, values);
                          }
                          return hash.value();
                        }},
                       {"evaluate", [] { return evaluate(harmonics(7, 1), glm::normalize(glm::dvec3(1, 2, -3))); }},
                       {"cosine_lobe",
                        [] {
                          std::vector<double> factors;
                          for (int l = 0; l < 16; ++l) factors.push_back(cosine_lobe(l));
                          return factors;
                        }},
                       {"irradiance_from_radiance", [] { return irradiance_from_radiance(harmonics(9, 2)); }},
                       {"lambertian_from_irradiance", [] { return lambertian_from_irradiance(harmonics(9, 3)); }},
                       {"average_radiance", [] { return mean_radiance(harmonics(3, 4)); }},
                       {"rotate_3", [&] { return rotate(harmonics(3, 5), rotation); }},
                       {"rotate_9", [&] { return rotate(harmonics(9, 6), rotation); }},
                       {"rotate_16", [&] { return rotate(harmonics(16, 7), rotation); }},
                       {"transform_mirror", [&] { return rotate(harmonics(6, 8), mirror); }},
                       {"add", [] { return add(harmonics(3, 9), harmonics(5, 10)); }},
                       {"scale", [] { return scale(harmonics(4, 11), glm::dvec3(0.1, 2.0, 0.7)); }},
                       {"lerp", [] { return lerp(harmonics(4, 12), harmonics(2, 13), 0.3); }},
                       {"resized", [] { return bits_of(resized(harmonics(4, 14), 2), resized(harmonics(2, 15), 5)); }},
                       {"product", [] { return product(harmonics(3, 16), harmonics(4, 17)); }},
                       {"product_cut", [] { return product(harmonics(8, 18), harmonics(8, 19), 3); }},
                       {"window_hanning", [] { return apply_window(lit(6), Window::hanning); }},
                       {"window_lanczos", [] { return apply_window(lit(5), Window::lanczos, 7.5); }},
                       {"window_least_3", [] { return apply_window(lit(3), Window::min_laplacian); }},
                       {"window_least_9", [] { return apply_window(lit(9), Window::min_laplacian); }},
                       {"minimum_3", [] { return minimum(harmonics(3, 20)); }},
                       {"minimum_8", [] { return minimum(harmonics(8, 21)); }},
                       {"minimum_of_a_ring", [] { return minimum(irradiance_from_radiance(lit(4))); }},
                       {"dominant_light_3", [] { return dominant_light(lit(3)).value(); }},
                       {"dominant_light_2", [] { return dominant_light(lit(2)).value(); }},
                       {"sun_harmonics_disc",
                        [] {
                          Sun sun;
                          sun.direction = glm::normalize(glm::dvec3(1, 2, 3));
                          sun.irradiance = {3, 2, 1};
                          sun.solid_angle = 0.02;
                          return sun_harmonics(sun, 16);
                        }},
                       {"sun_harmonics_point",
                        [] {
                          Sun sun;
                          sun.direction = {0, 0, -1};
                          sun.irradiance = {3, 2, 1};
                          return sun_harmonics(sun, 4);
                        }},
                   });
}

TEST_CASE("Engines' forms of light are the same as before", "[same_as_before]") {
  std::vector<NamedResult> results{
      {"babylon_polynomial", [] { return babylon_polynomial(harmonics(4, 22)); }},
      {"babylon_polynomial_evaluated",
       [] { return evaluate(babylon_polynomial(harmonics(3, 23)), glm::normalize(glm::dvec3(1, -2, 2))); }},
      {"conventions",
       [] {
         BitHash hash;
         for (const Convention& c : conventions()) {
           add_bits(hash, c.from_welkin);
           add_bits(hash, c.faces_from_engine);
         }
         return hash.value();
       }},
  };
  for (const Convention& c : conventions()) {
    if (!has_engine_light(c.engine)) continue;
    results.emplace_back(c.name, [engine = c.engine] { return engine_light(harmonics(4, 24), engine); });
    results.emplace_back(joined(c.name, "_in_place"),
                         [engine = c.engine] { return engine_light_unrotated(harmonics(2, 25), engine); });
  }
  require_as_recorded("engine_light", results);
}

TEST_CASE("Irradiance is the same as before", "[same_as_before]") {
  const TestCubemap cube = make_cubemap(Content::high_range, 24, 3, 26);
  const TestCubemap odd = make_cubemap(Content::special_values, 9, 4, 27);
  const TestLatLong wide = make_lat_long(Content::sun_disc, 80, 40, 28);
  const TestLatLongHalf half = make_lat_long_half(Content::smooth, 33, 20, 29, 4);
  const PixelPolicy clamped{.clamp = RadianceClamp{}};
  require_as_recorded(
      "irradiance",
      {
          {"direct_cubemap", [&] { return direct_irradiance(cube.view(), normals()); }},
          {"direct_cubemap_of_special_values", [&] { return direct_irradiance(odd.view(), normals(), clamped); }},
          {"direct_lat_long", [&] { return direct_irradiance(wide.view(), normals()); }},
          {"direct_lat_long_f16", [&] { return direct_irradiance(half.view(), normals(), clamped); }},
          {"reference_cubemap", [&] { return direct_irradiance(cube.view(), glm::dvec3(0.6, 0.0, 0.8)); }},
          {"reference_lat_long", [&] { return direct_irradiance(wide.view(), glm::dvec3(0.6, 0.0, 0.8)); }},
          {"errors_cubemap",
           [&] {
             return bits_of_errors(irradiance_errors(cube.view(), project(cube.view(), {.bands = 5}).radiance, 60));
           }},
          {"errors_lat_long",
           [&] { return bits_of_errors(irradiance_errors(wide.view(), project(wide.view()).radiance, 50)); }},
          {"harmonics_cubemap_1", [] { return irradiance_cubemap(harmonics(3, 30), 1); }},
          {"harmonics_cubemap_5", [] { return irradiance_cubemap(harmonics(9, 31), 5); }},
          {"harmonics_cubemap_64", [] { return irradiance_cubemap(harmonics(3, 32), 64); }},
          {"direct_cubemap_of_cubemap", [&] { return direct_irradiance_cubemap(cube.view(), 3); }},
          {"direct_cubemap_of_lat_long", [&] { return direct_irradiance_cubemap(wide.view(), 4); }},
      });
}

TEST_CASE("Suns are found and taken out as before", "[same_as_before]") {
  require_as_recorded("sun",
                      {
                          {"lat_long_disc", [] { return bits_without_sun(wide_image(Content::sun_disc)); }},
                          {"cubemap_disc", [] { return bits_without_sun(cube_image(Content::sun_disc)); }},
                          {"lat_long_texel", [] { return bits_without_sun(wide_image(Content::one_texel_sun)); }},
                          {"cubemap_texel", [] { return bits_without_sun(cube_image(Content::one_texel_sun)); }},
                          {"lat_long_wide",
                           [] {
                             return bits_without_sun(wide_image(Content::high_range),
                                                     {.relative_threshold = 0.5, .maximum_radius_degrees = 40.0});
                           }},
                          {"lat_long_none", [] { return bits_without_sun(wide_image(Content::smooth)); }},
                          {"cubemap_none", [] { return bits_without_sun(cube_image(Content::special_values)); }},
                      });
}

TEST_CASE("Content hashes are the same as before", "[same_as_before]") {
  const TestCubemap cube = make_cubemap(Content::special_values, 37, 4, 33);
  const TestCubemapHalf half = make_cubemap_half(Content::random, 20, 3, 34);
  const TestLatLong wide = make_lat_long(Content::nan_bearing, 64, 32, 35);
  const TestLatLongBytes bytes = make_lat_long_bytes(Content::random, 70, 31, 36, 4);
  const TemporaryDirectory folder;
  write_bytes(folder.file("some"), std::vector<char>(100'000, 'w'));
  require_as_recorded("content_hash",
                      {
                          {"nothing", [] { return hash_bytes(nullptr, 0); }},
                          {"bytes", [&] { return hash_bytes(bytes.pixels.data(), bytes.pixels.size()); }},
                          {"combined",
                           [] {
                             return combine(std::array{hash_bytes("a", 1), hash_bytes("bc", 2)});
                           }},
                          {"text", [] { return hash_bytes("welkin", 6).text(); }},
                          {"cubemap_f32", [&] { return hash_pixels(cube.view()); }},
                          {"cubemap_f16", [&] { return hash_pixels(half.view()); }},
                          {"lat_long_f32", [&] { return hash_pixels(wide.view()); }},
                          {"lat_long_u8", [&] { return hash_pixels(bytes.view()); }},
                          {"faces",
                           [&] {
                             BitHash hash;
                             for (const ContentHash& face : cache::hash_faces(cube.view(), {})) add_bits(hash, face);
                             return hash.value();
                           }},
                          {"of_faces", [&] { return combine(cache::hash_faces(cube.view(), {})); }},
                          {"file", [&] { return hash_file(folder.file("some")); }},
                          {"projection_options",
                           [] { return cache::hash_options(ProjectionOptions{.pixels = {.clamp = RadianceClamp{}}}); }},
                          {"prefilter_options",
                           [] {
                             return cache::hash_options(PrefilterOptions{.roughness = {0.0, 0.5}});
                           }},
                          {"brdf_options", [] { return cache::hash_options(BrdfTableOptions{}); }},
                          {"bake_options", [] { return cache::hash_options(BakeOptions{}); }},
                          {"read_options", [] { return cache::hash_options(ReadOptions{}); }},
                          {"sky_table_options", [] { return cache::hash_options(SkyTableOptions{}); }},
                          {"atmosphere", [] { return cache::hash_options(earth_bruneton()); }},
                      });
}

}  // namespace welkin::test
