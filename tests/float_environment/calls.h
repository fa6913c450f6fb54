// Public functions called in a caller's floating-point environment, and the bits that came out.
#pragma once

#include <cstdint>
#include <exception>
#include <filesystem>
#include <functional>
#include <memory>
#include <stdexcept>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include "modes.h"
#include "support/bit_hash.h"
#include "support/temporary_directory.h"
#include "welkin/bake.h"
#include "welkin/engines.h"
#include "welkin/image.h"
#include "welkin/probes.h"
#include "welkin/projection.h"
#include "welkin/sky.h"
#include "welkin/spherical_harmonics.h"

namespace welkin::test {

inline void add_bits(BitHash& hash, const PlannedPass& pass) { add_bits(hash, pass.name, pass.reason, pass.bytes); }
inline void add_bits(BitHash& hash, const DensityLayer& layer) {
  add_bits(hash, layer.thickness_m, layer.exponential_term, layer.exponential_scale_per_m, layer.linear_term_per_m,
           layer.constant_term);
}
inline void add_bits(BitHash& hash, const Constituent& constituent) {
  add_bits(hash, constituent.density, constituent.scattering_per_m, constituent.absorption_per_m);
}
inline void add_bits(BitHash& hash, const Atmosphere& air) {
  add_bits(hash, air.wavelengths_nm, air.aerosol_asymmetries, air.ground_albedo, air.solar_irradiance, air.rayleigh,
           air.aerosol, air.absorbers, air.bottom_radius_m, air.top_radius_m, air.aerosol_asymmetry,
           air.sun_angular_radius_degrees, air.night_zenith_luminance);
}
inline void add_bits(BitHash& hash, const SkyBake& baked) {
  add_bits(hash, baked.tables, baked.radiance, baked.sun, baked.specular, baked.background);
  if (baked.curve) add_bits(hash, baked.curve->at(glm::dvec3(0.6, 0.8, 0.0)));
}
inline void add_bits(BitHash& hash, const BakedProbes& probes) {
  add_bits(hash, probes.coefficients, probes.validity, probes.passes, probes.distances, probes.sky,
           probes.distance_limit);
}
inline void add_bits(BitHash& hash, const PackedProbes& packed) {
  for (const ProbeTexture& texture : packed.textures) add_bits(hash, texture.halves);
}
inline void add_bits(BitHash& hash, const Bc6hCubemap& cubemap) {
  for (const Bc6hLevel& level : cubemap.levels) add_bits(hash, level.estimated_error, level.blocks);
}

/// Hashes an object that a call changed in place.
template <class Value>
void add_bits(BitHash& hash, const std::reference_wrapper<Value>& value) {
  add_bits(hash, value.get());
}
/// Makes each call of a process twice in the process's mode, and keeps a line with the hashes of both results.
class Calls {
 public:
  explicit Calls(const FloatEnvironment& mode) : mode_(mode) {}

  /// Calls `function`, which calls one public function, in the caller's environment, and hashes what it returns when
  /// that is over. `name` is how the public function's declaration begins, without `welkin::`, up to where it differs
  /// from all others: `project(LatLongView`. An exception's message is a result like any other. Returns the last
  /// result.
  template <class Function>
  auto call(const char* name, const Function& function) {
    using Result = std::remove_cvref_t<std::invoke_result_t<const Function&>>;
    std::unique_ptr<Result> result;
    std::string line = name;
    line += '\t';
    for (int time = 0; time < 2; ++time) {
      std::string failure;
      name_call(name);
      set_environment(mode_);
      try {
        result.reset(new Result(function()));
        leave(name);
      } catch (const std::exception& error) {
        leave(name);
        failure = error.what();
      }
      line += ' ' + (failure.empty() && result ? in_hexadecimal(bits_of(*result)) : "threw: " + failure);
    }
    lines_.push_back(line);
    return result ? std::move(*result) : throw std::runtime_error(line);
  }

  /// Makes a call that writes a file, whose bytes are the result.
  template <class Function>
  void write(const char* name, const std::filesystem::path& file, const Function& function) {
    call(name, [&] {
      function();
      return read_bytes(file);
    });
  }

  /// Makes a call that must throw; it, too, must leave the caller's environment unchanged.
  template <class Function>
  void refused(const char* name, const Function& function) {
    name_call(name);
    set_environment(mode_);
    try {
      function();
    } catch (const std::exception& error) {
      leave(name);
      lines_.push_back(std::string(name) + "\t threw: " + error.what());
      return;
    }
    leave(name);
    complain(name, "threw nothing");
  }

  [[nodiscard]] const std::vector<std::string>& lines() const { return lines_; }
  [[nodiscard]] bool failed() const { return failed_; }

 private:
  /// Restores the default environment; the call must have left the caller's unchanged.
  void leave(const char* name);
  void complain(const char* name, const char* what);
  static std::string in_hexadecimal(std::uint64_t number);

  FloatEnvironment mode_;
  std::vector<std::string> lines_;
  bool failed_ = false;
};

/// Each calls the public functions of its subject.
void call_harmonics(Calls& calls);
void call_images(Calls& calls);
void call_bakes(Calls& calls);
void call_skies(Calls& calls);
void call_files(Calls& calls);
void call_worker(Calls& calls);
void call_c(Calls& calls);

}  // namespace welkin::test
