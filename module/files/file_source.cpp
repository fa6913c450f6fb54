#include "files/file_source.h"

#include <algorithm>
#include <cstddef>
#include <cstring>
#include <optional>
#include <string>

#include "files/env.h"
#include "files/environment.h"
#include "files/row_source.h"
#include "platform/file.h"
#include "platform/float_environment.h"
#include "welkin/bake_file.h"
#include "welkin/core.h"
#include "welkin/spherical_harmonics.h"

namespace welkin::files {

namespace {

/// Reads what a plan wants of a file: all of its pixels, its levels, its light alone, or nothing. `file` and `plan`
/// must outlive it.
class FileSource final : public baking::Source {
 public:
  FileSource(const StoredEnvironment& file, const Plan& plan) : file_(file), plan_(plan) {}

  [[nodiscard]] SourceShape shape() const override { return file_.shape; }
  [[nodiscard]] std::string description() const override { return file_.description(); }
  [[nodiscard]] baking::StoredKinds stored() const override {
    baking::StoredKinds kinds;
    if (plan_.take_light) kinds.harmonics_bands = 3;
    if (plan_.take_levels) kinds.background_levels = file_.levels;
    if (plan_.take_specular) {
      kinds.specular_mips = plan_.stored_mips;
      kinds.specular_size = std::max(1, file_.shape.columns >> plan_.first_stored_mip);
    }
    return kinds;
  }
  [[nodiscard]] std::optional<PlannedPass> reading() const override { return plan_.pass("read"); }
  [[nodiscard]] bool holds_pixels() const override { return !plan_.streams; }

  void read(const Control& control) override {
    if (plan_.streams) return;
    const std::uint64_t limit = file_.read.memory_limit_bytes;
    const Control reading{control.stop, control.progress};  // what is read here is no result
    if (!plan_.take_specular && !plan_.take_levels) {
      environment_ = read_environment(file_.input, file_.read, reading);
    } else if (file_.info.format == FileFormat::babylon) {
      chain_ = mirrored_x(read_babylon_environment(file_.input, limit, reading).specular);
    } else {
      chain_ = read_texture(file_.input, limit, reading).cubemap;
    }
  }

  [[nodiscard]] EnvironmentView pixels() const override {
    if (chain_.levels() > 0) return chain_.view(0);
    return environment_.view();
  }

  /// While it is read.
  [[nodiscard]] Projection project(const ProjectionOptions& options, const Control& control) override {
    return project_file(file_.input, file_.read, options, control);
  }

  /// Of the polynomial.
  [[nodiscard]] SphericalHarmonics take_radiance(const Control& control) override {
    return project_file(file_.input, file_.read, {}, {control.stop, {}}).radiance;
  }

  /// The mips that the plan takes.
  [[nodiscard]] PrefilteredSpecular take_specular(const Control& control) override {
    PrefilteredSpecular part;
    part.cubemap = Cubemap(chain_.level_size(plan_.first_stored_mip), plan_.stored_mips, control.memory);
    for (int level = 0; level < plan_.stored_mips; ++level) {
      const int mip = plan_.first_stored_mip + level;
      const auto edge = static_cast<std::size_t>(part.cubemap.level_size(level));
      std::memcpy(part.cubemap.face(level, 0), chain_.face(mip, 0), 18 * edge * edge * sizeof(float));
      MipRecord record;
      record.size = part.cubemap.level_size(level);
      record.roughness = file_.roughness[static_cast<std::size_t>(mip)];
      record.lobe_roughness = record.roughness;
      record.method = MipMethod::stored;
      record.mean = mean_radiance(welkin::project(part.cubemap.view(level), {.bands = 1}).radiance);
      part.mips.push_back(record);
    }
    return part;
  }

  [[nodiscard]] const Cubemap* levels() const override { return &chain_; }

 private:
  const StoredEnvironment& file_;
  const Plan& plan_;
  Cubemap chain_;            ///< of a file whose levels are taken,
  Environment environment_;  ///< of others
};

/// As it stands in the manifest.
std::optional<BabylonPolynomial> stored_polynomial(const StoredEnvironment& file) {
  if (!file.has_polynomial) return std::nullopt;
  platform::ByteFile bytes = open_file(file.input);
  return read_env_manifest(bytes).polynomial;
}

}  // namespace

BakeResult bake_file_source(const StoredEnvironment& file, const Plan& plan, baking::ArtefactStore* store,
                            const Control& control) {
  FileSource source(file, plan);
  BakeResult result = naming_file(file.input.path(), [&] { return baking::run_bake(source, plan, store, control); });
  result.stored_polynomial = stored_polynomial(file);
  return result;
}

}  // namespace welkin::files

namespace welkin {

BakeResult bake(const StoredEnvironment& file, const Plan& plan, const Control& control) {
  const platform::FloatingPointScope floating_point;
  return files::bake_file_source(file, plan, nullptr, control);
}

BakeResult bake_file(const FileInput& input, const ReadOptions& read_options, const BakeOptions& options,
                     const Control& control) {
  const platform::FloatingPointScope floating_point;
  const StoredEnvironment file = inspect_stored_environment(input, read_options);
  return bake(file, files::plan_whole(file, options), control);
}

}  // namespace welkin
