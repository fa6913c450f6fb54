// The results that a file carries in addition to its pixels, plans that use them, and bakes by these plans.
#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstddef>
#include <cstring>
#include <optional>
#include <string>
#include <string_view>
#include <system_error>
#include <utility>
#include <vector>

#include "bake/artefacts.h"
#include "bake/bake_plan.h"
#include "files/env.h"
#include "files/environment.h"
#include "files/row_source.h"
#include "files/textures.h"
#include "platform/file.h"
#include "platform/float_environment.h"
#include "platform/standard_library.h"
#include "platform/text.h"
#include "welkin/bake.h"
#include "welkin/bake_file.h"
#include "welkin/core.h"
#include "welkin/reflections.h"
#include "welkin/spherical_harmonics.h"

namespace welkin {
namespace {

/// Mip k of an .env has alpha = 2^(k / scale) / size, at most 1; 0 at mip 0.
std::vector<double> babylon_roughness(int levels, int size, double scale) {
  std::vector<double> roughness{0.0};
  for (int level = 1; level < levels; ++level)
    roughness.push_back(std::sqrt(std::min(1.0, std::exp2(level / scale) / size)));
  return roughness;
}

void look_into_env(StoredEnvironment& stored) {
  platform::ByteFile file = files::open_file(stored.input);
  const files::EnvManifest manifest = files::read_env_manifest(file);
  stored.has_polynomial = manifest.polynomial.has_value();
  stored.levels = manifest.levels();
  if (!(manifest.lod_generation_scale > 0.0)) {
    stored.content = LevelContent::radiance;  // Babylon.js stores this for a cubemap that was not prefiltered
    return;
  }
  stored.content = LevelContent::reflections;
  stored.roughness = babylon_roughness(stored.levels, manifest.width, manifest.lod_generation_scale);
}

/// Parses numbers separated by spaces, one per level, each from 0 to 1 and none below the one before; otherwise empty.
/// No locale is used: a host's may require a decimal comma.
std::vector<double> roughness_in(std::string_view text, int levels) {
  constexpr std::string_view kSpaces = " \t\r\n";
  std::vector<double> roughness;
  for (;;) {
    text.remove_prefix(std::min(text.find_first_not_of(kSpaces), text.size()));
    if (text.empty()) break;
    double value = 0.0;
    const auto [end, failure] = platform::from_chars(text.data(), text.data() + text.size(), value);
    text.remove_prefix(static_cast<std::size_t>(end - text.data()));
    if (failure != std::errc() || (!text.empty() && kSpaces.find(text.front()) == std::string_view::npos)) return {};
    if (!(value >= (roughness.empty() ? 0.0 : roughness.back()) && value <= 1.0)) return {};
    roughness.push_back(value);
  }
  if (static_cast<int>(roughness.size()) != levels) roughness.clear();
  return roughness;
}

/// Notes why the stored roughness is not used, for people who see mips of another one.
void note_discarded(StoredEnvironment& stored, const std::string& text) {
  stored.info.notes.push_back("its roughness \"" + platform::printable(text) +
                              "\" is not used: " + std::to_string(stored.levels) +
                              " levels need as many numbers from 0 to 1, none below the one before");
}

void look_into_texture(StoredEnvironment& stored) {
  platform::ByteFile file = files::open_file(stored.input);
  const files::TextureLayout layout = files::read_texture_layout(file, stored.read.element);
  if (layout.faces() != 6) return;
  stored.levels = static_cast<int>(layout.levels.size());
  stored.compressed = layout.supercompression != Supercompression::none;
  if (!layout.has_metadata || layout.container == FileFormat::ktx1) return;  // unknown
  stored.content = LevelContent::radiance;
  for (const auto& [key, value] : layout.metadata) {
    if (!files::speaks_of_roughness(key)) continue;
    stored.content = LevelContent::reflections;
    stored.roughness = roughness_in(value, stored.levels);
    if (stored.roughness.empty()) note_discarded(stored, value);
  }
}

}  // namespace

std::string StoredEnvironment::description() const {
  const platform::FloatingPointScope floating_point;
  std::string text =
      platform::utf8(input.path().filename()) + ": " + info.format_description() + ", " + shape.description();
  if (levels > 1) {
    text += ", " + std::to_string(levels) +
            (content == LevelContent::reflections ? " prefiltered mips"
             : content == LevelContent::radiance  ? " mips"
                                                  : " levels of unknown meaning");
  }
  return has_polynomial ? text + ", polynomial" : text;
}

StoredEnvironment inspect_stored_environment(const FileInput& input, const ReadOptions& read, LevelContent content) {
  const platform::FloatingPointScope floating_point;
  StoredEnvironment stored;
  stored.input = input;
  stored.read = read;
  stored.info = inspect_environment(input, read);
  const EnvironmentInfo& info = stored.info;
  Environment shapes;
  shapes.info = info;
  const int face = shapes.face_size();
  stored.shape = face > 0 ? SourceShape{true, face, 6 * face, PixelFormat::rgb32f}
                          : SourceShape{false, info.width, info.height, PixelFormat::rgb32f};
  stored.compressed = info.format != FileFormat::pfm && info.compression != "none";
  if (info.format == FileFormat::babylon) look_into_env(stored);
  if (info.format == FileFormat::ktx2 || info.format == FileFormat::ktx1 || info.format == FileFormat::dds)
    look_into_texture(stored);
  if (content != LevelContent::automatic && stored.levels > 1) {
    if (content != LevelContent::reflections && !stored.roughness.empty()) {
      stored.info.notes.emplace_back("its roughness is not used, because its levels are read as radiance");
    }
    stored.content = content;
  }
  if (read.level != 0) {  // a single level
    stored.levels = 1;
    stored.content = LevelContent::automatic;
    stored.has_polynomial = false;
  }
  if (stored.content != LevelContent::reflections) {
    stored.roughness.clear();
  } else if (stored.roughness.empty()) {
    stored.roughness = mip_roughness(RoughnessSchedule::linear, stored.levels, face);
  }
  return stored;
}

namespace files {
namespace {

// Plans for files: which results they carry, and whether their pixels are needed at all.

constexpr const char* kRead = "read";

/// Returns whether options change the pixels: stored results were made of unchanged ones, read as the file states.
bool changes_pixels(const StoredEnvironment& file, const BakeOptions& options) {
  return file.read.transfer != Transfer::automatic || options.pixels.clamp || options.pixels.gamma ||
         options.pixels.negative != NegativePolicy::keep || options.pixels.nan == NonFinitePolicy::reject ||
         options.pixels.infinity == NonFinitePolicy::reject;
}

bool takes_specular(const StoredEnvironment& file, const SceneNeeds& needs, const BakeOptions& options) {
  if (!options.specular || !needs.glossy || file.content != LevelContent::reflections) return false;
  if (options.specular->lobe != LobeFamily::ggx) return false;  // files carry results of GGX
  return platform::ranges::is_sorted(file.roughness) && file.roughness.front() <= needs.glossy->minimum &&
         file.roughness.back() >= needs.glossy->maximum;
}

baking::StoredKinds stored_kinds(const StoredEnvironment& file, const SceneNeeds& needs, const BakeOptions& options) {
  baking::StoredKinds kinds;
  if (!needs.stored_results || changes_pixels(file, options)) return kinds;
  if (file.has_polynomial) kinds.harmonics_bands = 3;
  if (file.content == LevelContent::radiance) kinds.background_levels = file.levels;
  if (!takes_specular(file, needs, options)) return kinds;
  const auto [first, count] = baking::used_mips(file.roughness, *needs.glossy);
  kinds.specular_mips = count;
  kinds.specular_size = std::max(1, file.shape.columns >> first);
  return kinds;
}

bool wants_pixels(const Plan& plan) {
  if (plan.take_specular) return true;  // of the chain itself
  return plan.pass("sanitize").action != PassAction::skip || plan.pass("project").action == PassAction::run;
}

/// Returns whether a plan needs at most a projection. (Reading only light always uses a stored polynomial.)
bool streams(const StoredEnvironment& file, const Plan& plan) {
  if (plan.pass("sanitize").action != PassAction::skip || plan.take_specular) return false;
  return plan.take_light || !file.has_polynomial || plan.pass("project").action == PassAction::skip;
}

PlannedPass read_pass(const StoredEnvironment& file, const Plan& plan) {
  if (!wants_pixels(plan)) return {kRead, PassAction::skip, "no pass needs pixels; the header suffices", 0};
  auto texels = static_cast<double>(file.shape.texels());
  if (plan.take_specular || plan.take_levels) texels *= 4.0 / 3.0;
  if (plan.streams) return {kRead, PassAction::run, "projected while it is read", 0};
  const std::uint64_t bytes = static_cast<std::uint64_t>(texels) * 3 * sizeof(float);
  return {kRead, PassAction::run, file.description(), bytes};
}

/// `kinds`: the results that are taken from the file.
Plan plan_with(const StoredEnvironment& file, const baking::NeededOptions& needed, const baking::StoredKinds& kinds) {
  Plan plan = baking::plan_pixels(file.shape, needed, kinds);
  plan.source = file.description();
  plan.streams = streams(file, plan);
  plan.passes.insert(plan.passes.begin(), read_pass(file, plan));
  return plan;
}

/// Plans a bake of everything that the options request: of the file's stored results only the light is used, which is
/// more than its pixels hold.
Plan plan_whole(const StoredEnvironment& file, const BakeOptions& options) {
  baking::StoredKinds kinds;
  if (file.has_polynomial && !changes_pixels(file, options)) kinds.harmonics_bands = 3;
  return plan_with(file, {options}, kinds);
}

// Files as sources of bakes.

/// Reads what a plan needs of a file: all of its pixels, its levels, only its light, or nothing. `file` and `plan` must
/// outlive it.
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
    const Control reading{control.stop, control.progress};  // no `memory`: this is not a result
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

  /// Projects the file while it is read.
  [[nodiscard]] Projection project(const ProjectionOptions& options, const Control& control) override {
    return project_file(file_.input, file_.read, options, control);
  }

  /// Returns the polynomial's light.
  [[nodiscard]] SphericalHarmonics take_radiance(const Control& control) override {
    return project_file(file_.input, file_.read, {}, {control.stop, {}}).radiance;
  }

  /// Returns the mips that the plan takes.
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
  Cubemap chain_;            ///< of a file whose levels are taken
  Environment environment_;  ///< of other files
};

/// Returns the polynomial as stated in the manifest.
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

}  // namespace files

Plan plan(const StoredEnvironment& file, const SceneNeeds& needs, const BakeOptions& full_options) {
  const platform::FloatingPointScope floating_point;
  check(needs);
  const baking::NeededOptions needed = baking::needed_options(file.shape, needs, full_options);
  const baking::StoredKinds kinds = files::stored_kinds(file, needs, needed.options);
  Plan plan = files::plan_with(file, needed, kinds);
  if (plan.take_specular) {
    plan.first_stored_mip = baking::used_mips(file.roughness, *needs.glossy).first;
    plan.stored_mips = kinds.specular_mips;
  }
  return plan;
}

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
