// Classes of the module that more than one part makes.
#pragma once

#include <pybind11/pybind11.h>

#include <cstdint>
#include <memory>
#include <utility>
#include <vector>

#include "arrays.h"
#include "options.h"
#include "welkin/projection.h"
#include "welkin/reflections.h"

namespace welkin::python {

/// A cubemap with its mips. Arrays look at its memory and keep it.
struct Chain {
  SharedChain cubemap;

  explicit Chain(Cubemap made) : cubemap(std::make_shared<Cubemap>(std::move(made))) {}
};

/// A chain of reflections.
struct Reflections : Chain {
  std::vector<MipRecord> mips;
  ProjectionDiagnostics diagnostics;
  std::uint64_t peak_bytes = 0;

  explicit Reflections(PrefilteredSpecular made)
      : Chain(std::move(made.cubemap)),
        mips(std::move(made.mips)),
        diagnostics(std::move(made.pixels)),
        peak_bytes(made.peak_bytes) {}
};

/// What the light of `irradiance` is in.
struct Irradiance {
  SphericalHarmonics harmonics;
  py::object cubemap;  ///< an array, or None
};

/// A BRDF table, which other calls share.
struct SharedBrdf {
  std::shared_ptr<const BrdfTable> table;
};

[[nodiscard]] py::array array_of(const SharedBrdf& brdf);

/// Takes the options of a projection.
[[nodiscard]] ProjectionOptions projection_options(Options& options);
/// Takes those of a chain of reflections; `policy` too, if it is not the bake's.
/// The options that `prefilter_options` takes but the policy, for signatures.
extern const std::string kPrefilterSignature;
[[nodiscard]] PrefilterOptions prefilter_options(Options& options, bool policy, Quality otherwise = Quality::normal);

/// The preset that `quality` names.
[[nodiscard]] Quality read_quality(Options& options, Quality otherwise);
[[nodiscard]] BrdfTableOptions brdf_options(Options& options);

/// "512 x 256", "5 levels", ...
[[nodiscard]] std::string counted(std::size_t count, const char* one);

}  // namespace welkin::python
