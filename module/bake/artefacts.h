// The inputs of a bake: a source, which may bring finished results along, and a store of earlier results.
//
// An artefact (the coefficients, a cubemap, a table) comes from the first of three origins that has it: the source
// carries it, a store finds it, or it is computed. `run_bake` serves every bake: of pixels in memory, of files,
// planned, cached, on a worker.
#pragma once

#include <optional>
#include <string>

#include "bake/bake_plan.h"
#include "projection/sanitized_pixels.h"
#include "reflections/prefilter.h"
#include "welkin/bake.h"
#include "welkin/core.h"
#include "welkin/image.h"

namespace welkin::baking {

/// Pixels of a known shape, and the results that come with them.
class Source {
 public:
  Source() = default;
  virtual ~Source() = default;
  Source(const Source&) = delete;
  Source& operator=(const Source&) = delete;

  [[nodiscard]] virtual SourceShape shape() const = 0;
  /// Returns the description that plans show.
  [[nodiscard]] virtual std::string description() const { return shape().description(); }

  /// Returns the kinds of results that the bake takes from the source instead of computing them.
  [[nodiscard]] virtual StoredKinds stored() const { return {}; }

  /// Returns the pass "read", which precedes all others; none where the pixels are in memory.
  [[nodiscard]] virtual std::optional<PlannedPass> reading() const { return std::nullopt; }
  /// Returns whether pixels are held after `read`. If not, `project` reads them.
  [[nodiscard]] virtual bool holds_pixels() const { return true; }
  virtual void read(const Control& /*control*/) {}

  /// Returns the pixels, after `read`, of a source that holds them.
  [[nodiscard]] virtual EnvironmentView pixels() const = 0;

  /// Projects a source that does not hold its pixels.
  [[nodiscard]] virtual Projection project(const ProjectionOptions& options, const Control& control);

  // The results of `stored()`, after `read`. Each is taken at most once.
  [[nodiscard]] virtual SphericalHarmonics take_radiance(const Control& control);
  [[nodiscard]] virtual PrefilteredSpecular take_specular(const Control& control);
  /// Returns plain mips, whose level 0 is the pixels.
  [[nodiscard]] virtual const Cubemap* levels() const { return nullptr; }
};

/// A result of an earlier bake.
template <class Value>
struct Found {
  Value value;
  std::string where;  ///< "found in memory", "found on disk"
  double milliseconds = 0.0;
};

/// All results of one bake that a store has.
struct FoundArtefacts {
  std::optional<Found<Projection>> projection;  ///< with its diagnostics
  std::optional<Found<Cubemap>> background;
  std::optional<Found<reflections::IrradianceMap>> irradiance;
  /// The outcome of sanitizing the pixels.
  std::optional<ProjectionDiagnostics> sanitized;

  /// The part of the prefiltered chain that is still to be made; empty if all mips were found.
  std::optional<reflections::PrefilterPlan> missing_specular;
  std::optional<Found<OctahedralMap>> octahedral;
  std::string specular_where;  ///< "3 of 5 mips found on disk"; empty if none was
  double specular_milliseconds = 0.0;
};

/// A store that finds and keeps the results of bakes. One object serves one bake; its calls may come from several
/// threads at once.
class ArtefactStore {
 public:
  ArtefactStore() = default;
  virtual ~ArtefactStore() = default;
  ArtefactStore(const ArtefactStore&) = delete;
  ArtefactStore& operator=(const ArtefactStore&) = delete;

  /// Hashes the pixels, and finds what `plan` computes of them. Called first. Throws `Error` (cancelled).
  [[nodiscard]] virtual FoundArtefacts find(const EnvironmentView& pixels, const BakeOptions& options,
                                            const BakePlan& plan, const Control& control) = 0;

  virtual void keep(const projection::SanitizedSource& sanitized) = 0;
  virtual void keep(const Projection& projection) = 0;
  virtual void keep_background(const Cubemap& background) = 0;
  virtual void keep_irradiance(const reflections::IrradianceMap& irradiance) = 0;
  virtual void keep_octahedral(const OctahedralMap& map) = 0;
  /// Keeps the missing mips, if any were made, and joins them with those found to the whole chain. Called once.
  [[nodiscard]] virtual PrefilteredSpecular whole_specular(std::optional<PrefilteredSpecular> made) = 0;
};

/// Bakes any source into an older result, as `bake_into`. Throws `Error` as `bake`, the source and the store do.
void run_bake(BakeResult& result, Source& source, const BakeOptions& options, ArtefactStore* store,
              const Control& control);

/// Carries out a plan, whose reasons are copied where the bake does what was planned. Throws `Error` as `run_bake`
/// above, and invalid_argument for another source's plan.
[[nodiscard]] BakeResult run_bake(Source& source, const Plan& plan, ArtefactStore* store, const Control& control);

// Pixels in memory.

class MemorySource final : public Source {
 public:
  explicit MemorySource(const EnvironmentView& pixels) : pixels_(pixels), shape_(welkin::shape_of(pixels)) {}

  [[nodiscard]] SourceShape shape() const override { return shape_; }
  [[nodiscard]] EnvironmentView pixels() const override { return pixels_; }

 private:
  EnvironmentView pixels_;
  SourceShape shape_;
};

}  // namespace welkin::baking
