// What a file carries beside its pixels, and plans that take it.
#include <algorithm>
#include <charconv>
#include <cmath>
#include <string>
#include <string_view>
#include <system_error>
#include <utility>
#include <vector>

#include "bake/bake_plan.h"
#include "files/env.h"
#include "files/file_source.h"
#include "files/textures.h"
#include "platform/file.h"
#include "platform/float_environment.h"
#include "platform/standard_library.h"
#include "platform/text.h"
#include "welkin/bake.h"
#include "welkin/bake_file.h"
#include "welkin/reflections.h"

namespace welkin {
namespace {

/// Mip k of an .env is for alpha = 2^(k / scale) / size, at most 1; 0 at mip 0.
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
    stored.content = LevelContent::radiance;  // what Babylon.js stores of a cubemap that was not prefiltered
    return;
  }
  stored.content = LevelContent::reflections;
  stored.roughness = babylon_roughness(stored.levels, manifest.width, manifest.lod_generation_scale);
}

/// Numbers with spaces between them, as many as there are levels, each from 0 to 1 and none below the one before; else
/// nothing. By no locale: a host's may want a decimal comma.
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

/// A person who sees the mips of another roughness than was stored should know why.
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
  if (!layout.has_metadata || layout.container == FileFormat::ktx1) return;  // it cannot be told
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
  if (read.level != 0) {  // one of the levels alone
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

// Plans for files: what they carry already, and whether their pixels are wanted at all.

constexpr const char* kRead = "read";

/// Stored results were made of the pixels as they are, and as the file says.
bool changes_pixels(const StoredEnvironment& file, const BakeOptions& options) {
  return file.read.transfer != Transfer::automatic || options.pixels.clamp || options.pixels.gamma ||
         options.pixels.negative != NegativePolicy::keep || options.pixels.nan == NonFinitePolicy::reject ||
         options.pixels.infinity == NonFinitePolicy::reject;
}

bool takes_specular(const StoredEnvironment& file, const SceneNeeds& needs, const BakeOptions& options) {
  if (!options.specular || !needs.glossy || file.content != LevelContent::reflections) return false;
  if (options.specular->lobe != LobeFamily::ggx) return false;  // what files carry is of GGX
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

/// Nothing but a projection, or less. (What reads a file for its light alone takes a stored polynomial, asked or not.)
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

/// `kinds`: what is taken of the file.
Plan plan_with(const StoredEnvironment& file, const baking::NeededOptions& needed, const baking::StoredKinds& kinds) {
  Plan plan = baking::plan_pixels(file.shape, needed, kinds);
  plan.source = file.description();
  plan.streams = streams(file, plan);
  plan.passes.insert(plan.passes.begin(), read_pass(file, plan));
  return plan;
}

}  // namespace

Plan plan_whole(const StoredEnvironment& file, const BakeOptions& options) {
  baking::StoredKinds kinds;
  if (file.has_polynomial && !changes_pixels(file, options)) kinds.harmonics_bands = 3;
  return plan_with(file, {options}, kinds);
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

}  // namespace welkin
