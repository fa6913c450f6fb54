// A file as the source of a bake.
#pragma once

#include <optional>
#include <string>

#include "bake/artefacts.h"
#include "welkin/bake.h"
#include "welkin/bake_file.h"
#include "welkin/environment_file.h"
#include "welkin/image.h"

namespace welkin::files {

/// Reads what a plan wants of a file: all of its pixels, its levels, its light alone, or nothing. `file` and `plan`
/// must outlive it.
class FileSource final : public baking::Source {
 public:
  FileSource(const StoredEnvironment& file, const Plan& plan) : file_(file), plan_(plan) {}

  [[nodiscard]] SourceShape shape() const override { return file_.shape; }
  [[nodiscard]] std::string description() const override { return file_.description(); }
  [[nodiscard]] baking::StoredKinds stored() const override;
  [[nodiscard]] std::optional<PlannedPass> reading() const override { return plan_.pass("read"); }
  [[nodiscard]] bool holds_pixels() const override { return !plan_.streams; }
  void read(const Control& control) override;

  [[nodiscard]] EnvironmentView pixels() const override;
  /// While it is read.
  [[nodiscard]] Projection project(const ProjectionOptions& options, const Control& control) override;

  /// Of the polynomial.
  [[nodiscard]] SphericalHarmonics take_radiance(const Control& control) override;
  /// The mips that the plan takes.
  [[nodiscard]] PrefilteredSpecular take_specular(const Control& control) override;
  [[nodiscard]] const Cubemap* levels() const override { return &chain_; }

 private:
  const StoredEnvironment& file_;
  const Plan& plan_;
  Cubemap chain_;            ///< of a file whose levels are taken,
  Environment environment_;  ///< of others
};

/// The plan of a bake of everything that the options ask for: of what the file carries its light alone is taken, which
/// is more than its pixels hold.
[[nodiscard]] Plan plan_whole(const StoredEnvironment& file, const BakeOptions& options);

/// Bakes a file; what is said of a rejected pixel names it. Throws as `run_bake`.
[[nodiscard]] BakeResult bake_file_source(const StoredEnvironment& file, const Plan& plan, baking::ArtefactStore* store,
                                          const Control& control);

}  // namespace welkin::files
