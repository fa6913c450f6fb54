#include "tools/texture_budget.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstddef>
#include <limits>
#include <map>
#include <numbers>
#include <optional>
#include <set>
#include <tuple>
#include <utility>

#include "jobs/control.h"
#include "math/elementary.h"
#include "tools/bake_lobes.h"
#include "tools/gltf_light.h"
#include "tools/output_files.h"
#include "tools/preview_light.h"
#include "tools/text.h"
#include "welkin/reflections.h"
#include "welkin/texture_file.h"

namespace welkin::tool {
namespace {

constexpr int kLargestChoice = 1024;  ///< where nobody names a size
constexpr int kLeastChoice = 16;
constexpr double kSharpest = 0.1;  ///< roughness of what is judged
constexpr int kRoughnesses = 10;
constexpr int kDirections = 1024;
constexpr int kKeptSize = 256;  ///< larger chains take much memory, and few are looked at twice
constexpr int kTruthSize = 512;
constexpr double kJudgedFrom = 0.3;  ///< of the progress: where the truth is known

// ---- Bytes of a folder

std::uint64_t texel_bytes(std::uint64_t width, std::uint64_t height, TexelFormat format) {
  std::uint64_t edge = 4;  // of a block, which has 16 bytes
  switch (format) {
    case TexelFormat::rgba16f: return 8 * width * height;
    case TexelFormat::rgba32f: return 16 * width * height;
    case TexelFormat::b10g11r11:
    case TexelFormat::e5b9g9r9: return 4 * width * height;
    case TexelFormat::astc_6x6_hdr: edge = 6; break;
    case TexelFormat::bc6h_ufloat:
    case TexelFormat::bc6h_sfloat:
    case TexelFormat::astc_4x4_hdr: break;
  }
  return 16 * ((width + edge - 1) / edge) * ((height + edge - 1) / edge);
}

/// Of a picture in a file: before it is packed, where the container packs.
std::uint64_t picture_bytes(std::uint64_t width, std::uint64_t height, const OutputFile& file) {
  switch (file.container) {
    case Container::exr: return (file.format == TexelFormat::rgba32f ? 12 : 6) * width * height;
    case Container::hdr:
    case Container::env:
    case Container::glb: return 4 * width * height;
    case Container::pfm: return 12 * width * height;
    default: return texel_bytes(width, height, file.format);
  }
}

std::uint64_t chain_bytes(int size, int levels, const OutputFile& file) {
  if (file.levels > 0) levels = std::min(levels, file.levels);
  std::uint64_t bytes = 0;
  for (int level = 0; level < levels; ++level) {
    const auto edge = static_cast<std::uint64_t>(std::max(1, size >> level));
    bytes += 6 * picture_bytes(edge, edge, file);
  }
  return bytes;
}

std::uint64_t file_bytes(const OutputFile& file, const BakeCommandOptions& options, const BakeOptions& bake) {
  const int size = bake.specular->size;
  const int mips = bake.specular->mips.value();
  const int background = bake.background->size.value_or(size);
  switch (file.content) {
    case Content::env: return chain_bytes(env_size(size), full_chain_levels(env_size(size)), file);
    case Content::gltf_light: {
      const int edge = gltf_light_size(size);
      return chain_bytes(edge, gltf_light_mips(edge), file);
    }
    case Content::lat_long: {
      const auto width = 4 * static_cast<std::uint64_t>(background);
      return picture_bytes(width, width / 2, file);
    }
    case Content::octahedral: {
      std::uint64_t bytes = 0;
      for (int level = 0; level < bake.octahedral->levels; ++level) {
        const auto edge = static_cast<std::uint64_t>(options.octahedral_size >> level);
        bytes += picture_bytes(edge, edge, file);
      }
      return bytes;
    }
    case Content::background: return chain_bytes(background, full_chain_levels(background), file);
    case Content::specular: return chain_bytes(size, mips, file);
    case Content::irradiance: return chain_bytes(options.irradiance_size, 1, file);
    case Content::brdf:
      return picture_bytes(static_cast<std::uint64_t>(options.brdf.width),
                           static_cast<std::uint64_t>(options.brdf.height), file);
    default: break;
  }
  for (const LobeFamily lobe : options.lobes) {
    if (content_of(lobe) != file.content) continue;
    const PrefilterOptions chain = lobe_options(lobe, options, *bake.specular);
    return chain_bytes(chain.size, mips_of_chain(chain), file);
  }
  return 0;  // text
}

std::uint64_t folder_bytes(const BakeCommandOptions& options) {
  const BakeOptions bake = library_options(options);
  std::uint64_t bytes = 0;
  for (const OutputFile& file : options.files) bytes += file_bytes(file, options, bake);
  return bytes;
}

// ---- Errors of a chain

/// Spread evenly over the sphere (a Fibonacci lattice).
std::vector<glm::vec3> even_directions() {
  std::vector<glm::vec3> directions;
  for (int k = 0; k < kDirections; ++k) {
    const double y = 1.0 - (2.0 * k + 1.0) / kDirections;
    const double radius = std::sqrt((1.0 - y) * (1.0 + y));
    const double turns = std::numbers::phi * k;
    const math::SineCosine at = math::sine_cosine_of_turns(turns - std::floor(turns));
    directions.emplace_back(radius * at.cosine, y, radius * at.sine);
  }
  return directions;
}

/// Roughness that no mip has, and what a mirror of it shows in even directions.
struct TrueReflections {
  double roughness;
  std::vector<glm::vec3> radiance;
  double square = 0.0;  ///< the sum over all directions and channels
};

double square_of(const glm::dvec3& rgb) { return glm::dot(rgb, rgb); }

/// All that candidates are compared with.
class Truth {
 public:
  template <class View>
  Truth(const View& source, const PrefilterOptions& options, const RoughnessRange& glossy, const Control& control)
      : directions_(even_directions()) {
    const double least = std::max(kSharpest, glossy.minimum);
    const double most = std::max(least, glossy.maximum);
    for (int k = 0; k < kRoughnesses; ++k) {
      const double roughness = least + (most - least) * k / (kRoughnesses - 1);
      const PrefilterOptions one = one_mip(options, roughness);
      const PrefilteredSpecular chain = prefilter_specular(source, one, {control.stop, {}});
      const CubeLookup look(chain.cubemap);
      TrueReflections reflections{roughness, {}};
      for (const glm::vec3& direction : directions_) {
        reflections.radiance.push_back(look.at(direction, 0));
        reflections.square += square_of(reflections.radiance.back());
      }
      roughnesses_.push_back(std::move(reflections));
      if (control.progress) control.progress((k + 1.0) / kRoughnesses);
      if (most == least) break;
    }
  }

  static PrefilterOptions one_mip(PrefilterOptions options, double roughness) {
    options.size = roughness < 0.3 ? kTruthSize : 128;  // texels of a fourth of the lobe's width and less
    options.mips = 1;
    options.roughness = {roughness};
    options.lobe_roughness.clear();
    return options;
  }

  /// The worst error of the chain, whose mips have this roughness, and where it is.
  [[nodiscard]] std::pair<double, double> error_of(const CubemapChain& chain, const std::vector<double>& table) const {
    const CubeLookup look(chain);
    std::pair<double, double> worst{0.0, roughnesses_.front().roughness};
    for (const TrueReflections& truth : roughnesses_) {
      const double level = mip_of_roughness(table, truth.roughness);
      double square = 0.0;
      for (std::size_t k = 0; k < directions_.size(); ++k)
        square += square_of(glm::dvec3(look.at(directions_[k], level)) - glm::dvec3(truth.radiance[k]));
      double error = truth.square > 0.0 ? std::sqrt(square / truth.square) : 0.0;
      if (std::isnan(error)) error = std::numeric_limits<double>::infinity();
      if (error > worst.first) worst = {error, truth.roughness};
    }
    return worst;
  }

 private:
  std::vector<glm::vec3> directions_;
  std::vector<TrueReflections> roughnesses_;
};

/// The chain as a file of that format gives it back.
CubemapChain stored_as(TexelFormat format, const CubemapChain& chain, const TextureOptions& texture,
                       const Control& control) {
  TextureOptions options = texture;
  options.format = format;
  options.supercompression = Supercompression::none;
  std::vector<std::byte> bytes;
  write_texture(FileOutput(bytes, "reflections.ktx2"), chain.views(), options, control);
  return read_texture(FileInput(bytes, "reflections.ktx2"), ~std::uint64_t{0}, control).cubemap;
}

// ---- The choice

bool may_choose_mips(const BakeCommandOptions& options) {
  return !options.all_mips && !options.specular.mips && options.roughness.table.empty();
}

/// A format is chosen for files of --formats alone: an engine's files have those that it loads.
bool may_choose_format(const BakeCommandOptions& options) {
  if (options.format_named || is_engine_folder(options)) return false;
  constexpr std::array kAble{Container::ktx2, Container::dds, Container::ktx};
  return std::any_of(options.files.begin(), options.files.end(), [&](const OutputFile& file) {
    return file.content == Content::specular && std::find(kAble.begin(), kAble.end(), file.container) != kAble.end();
  });
}

std::vector<int> halved_sizes(int most) {
  std::vector<int> sizes{most};
  while (sizes.back() / 2 >= kLeastChoice) sizes.push_back(sizes.back() / 2);
  return sizes;
}

/// As many as the schedule wants; of those that may end anywhere also down to 8, 4, 2 and 1 texels.
std::vector<int> mips_to_try(const BakeCommandOptions& options) {
  const RoughnessSchedule schedule = schedule_of(options);
  const int size = options.specular.size;
  std::vector<int> mips{mips_wanted(options)};
  if (schedule != RoughnessSchedule::filament && schedule != RoughnessSchedule::linear) return mips;
  while (mips.back() < full_chain_levels(size)) mips.push_back(mips.back() + 1);
  return mips;
}

/// A candidate and the options that make it.
struct Candidate {
  TriedTextures tried;
  BakeCommandOptions options;
};

Candidate candidate_of(BakeCommandOptions options) {
  Candidate candidate;
  settle_files(options);
  const BakeOptions bake = library_options(options);
  std::vector<std::string> formats;
  for (const OutputFile& file : files_with(Content::specular, options.files)) {
    const std::string word = name(file.format);
    if (std::find(formats.begin(), formats.end(), word) == formats.end()) formats.push_back(word);
  }
  for (const std::string& word : formats)
    candidate.tried.formats += (candidate.tried.formats.empty() ? "" : ",") + word;
  candidate.tried.size = bake.specular->size;
  candidate.tried.mips = bake.specular->mips.value();
  candidate.tried.background_size = bake.background->size.value_or(bake.specular->size);
  candidate.tried.format = options.texture.format;
  candidate.tried.bytes = folder_bytes(options);
  candidate.options = std::move(options);
  return candidate;
}

bool holds_reflections(const BakeCommandOptions& options) {
  return contains(options.files, Content::specular) || contains_rgbd(options.files);
}

/// All that may be chosen, by bytes.
std::vector<Candidate> candidates_of(const BakeCommandOptions& options, int most) {
  if (!holds_reflections(options)) {  // of the background alone, which is enlarged in the end
    BakeCommandOptions least = options;
    if (options.background_size == 0) least.background_size = std::min(kLeastChoice, options.specular.size);
    return {candidate_of(std::move(least))};
  }
  const std::vector<int> sizes = options.size_named ? std::vector<int>{options.specular.size} : halved_sizes(most);
  std::vector<TexelFormat> formats{options.texture.format};
  if (may_choose_format(options)) {
    formats = {TexelFormat::bc6h_ufloat, TexelFormat::e5b9g9r9, TexelFormat::b10g11r11, TexelFormat::rgba16f};
  }
  std::vector<Candidate> candidates;
  for (const int size : sizes) {
    BakeCommandOptions own = options;
    own.specular.size = size;
    // An error budget is about reflections: it leaves the background as large as it was to be.
    if (options.scene.error_budget && options.background_size == 0) own.background_size = options.specular.size;
    const std::vector<int> mips = may_choose_mips(options) ? mips_to_try(own) : std::vector<int>{0};
    for (const int count : mips) {
      if (count > 0) own.specular.mips = count;
      for (const TexelFormat format : formats) {
        own.texture.format = format;
        candidates.push_back(candidate_of(own));
      }
    }
  }
  std::stable_sort(candidates.begin(), candidates.end(),
                   [](const Candidate& a, const Candidate& b) { return a.tried.bytes < b.tried.bytes; });
  return candidates;
}

/// Bakes and stores each chain once.
template <class View>
class Judge {
 public:
  Judge(const View& source, const BakeCommandOptions& options, const Control& control)
      : source_(source), control_(control) {
    const PrefilterOptions specular = *library_options(options).specular;
    truth_.emplace(source, specular, options.scene.needs().glossy.value_or(RoughnessRange{}),
                   jobs::part_of(control, 0.0, kJudgedFrom));
  }

  void judge(Candidate& candidate) {
    const PrefilterOptions specular = *library_options(candidate.options).specular;
    std::set<TexelFormat> formats;
    for (const OutputFile& file : files_with(Content::specular, candidate.options.files)) formats.insert(file.format);
    // What RGBD rounds is not looked at.
    if (contains_rgbd(candidate.options.files)) formats.insert(TexelFormat::rgba32f);
    for (const TexelFormat format : formats) {
      const auto [error, roughness] = error_of(specular, format, candidate.options.texture);
      if (error < candidate.tried.error) continue;
      candidate.tried.error = error;
      candidate.tried.roughness = roughness;
    }
  }

 private:
  using Key = std::tuple<int, int, TexelFormat>;

  std::pair<double, double> error_of(const PrefilterOptions& specular, TexelFormat format,
                                     const TextureOptions& texture) {
    const Key key{specular.size, *specular.mips, format};
    if (const auto known = errors_.find(key); known != errors_.end()) return known->second;
    const auto error =
        truth_->error_of(stored_as(format, chain_of(specular), texture, {control_.stop, {}}), specular.roughness);
    errors_.emplace(key, error);
    return error;
  }

  const CubemapChain& chain_of(const PrefilterOptions& specular) {
    const std::pair<int, int> key{specular.size, *specular.mips};
    if (const auto known = chains_.find(key); known != chains_.end()) return known->second;
    std::erase_if(chains_, [](const auto& entry) { return entry.first.first > kKeptSize; });
    return chains_.emplace(key, prefilter_specular(source_, specular, {control_.stop, {}}).cubemap).first->second;
  }

  const View& source_;
  const Control& control_;
  std::optional<Truth> truth_;
  std::map<std::pair<int, int>, CubemapChain> chains_;  ///< by size and mips
  std::map<Key, std::pair<double, double>> errors_;
};

void enlarge_background(Candidate& candidate, int most, std::uint64_t budget) {
  for (const int size : halved_sizes(most)) {
    if (size <= candidate.tried.background_size) return;
    BakeCommandOptions options = candidate.options;
    options.background_size = size;
    const std::uint64_t bytes = folder_bytes(options);
    if (bytes > budget) continue;
    candidate.options = std::move(options);
    candidate.tried.background_size = size;
    candidate.tried.bytes = bytes;
    return;
  }
}

[[noreturn]] void refuse(const Candidate& least, std::uint64_t budget) {
  throw Error(ErrorCode::invalid_argument,
              "--budget of " + grouped(budget) + " bytes is too small: with the smallest faces the files take " +
                  grouped(least.tried.bytes) +
                  "; leave some of them out (--formats, --no-brdf, --irradiance 0) or raise it");
}

/// Under the budget of bytes, the largest first where nothing else is asked for: what is far smaller is not better.
void keep_likely(std::vector<Candidate>& candidates, std::uint64_t bytes, bool judged_by_error) {
  const auto end = std::find_if(candidates.begin(), candidates.end(),
                                [&](const Candidate& candidate) { return candidate.tried.bytes > bytes; });
  if (end == candidates.begin()) refuse(candidates.front(), bytes);
  candidates.erase(end, candidates.end());
  if (judged_by_error) return;
  constexpr std::uint64_t kFarSmaller = 16;
  const std::uint64_t most = candidates.back().tried.bytes;
  std::erase_if(candidates, [most](const Candidate& candidate) { return candidate.tried.bytes < most / kFarSmaller; });
}

// ---- Memory

std::uint64_t source_bytes(const LatLongView& source) {
  return 3 * sizeof(float) * static_cast<std::uint64_t>(source.width) * static_cast<std::uint64_t>(source.height);
}
std::uint64_t source_bytes(const CubemapView& source) {
  return 18 * sizeof(float) * static_cast<std::uint64_t>(source.size) * static_cast<std::uint64_t>(source.size);
}

/// What the source and a chain take, and the chain read back from a file with the bytes of that.
template <class View>
std::uint64_t judging_bytes(const View& source, const PrefilterOptions& specular) {
  BakeOptions bake;
  bake.background.reset();
  bake.irradiance.reset();
  bake.brdf = std::nullopt;
  bake.bands = 0;
  bake.specular = specular;
  bake.pixels = specular.pixels;
  const OutputFile floats{Content::specular, Container::ktx2, TexelFormat::rgba32f};
  const std::uint64_t chain = chain_bytes(specular.size, *specular.mips, floats);
  return source_bytes(source) + bake_bytes(source, bake) + 2 * chain;
}

/// Leaves out what cannot be judged in the memory that there may be.
template <class View>
void keep_within_memory(const View& source, std::vector<Candidate>& candidates, const BakeCommandOptions& options) {
  const std::uint64_t limit = options.common.read.memory_limit_bytes;
  const PrefilterOptions truth = Truth::one_mip(*library_options(options).specular, kSharpest);
  std::uint64_t least = judging_bytes(source, truth);
  const auto bytes_of = [&](const Candidate& candidate) {
    return judging_bytes(source, *library_options(candidate.options).specular);
  };
  if (least <= limit) {
    least = bytes_of(candidates.front());
    std::erase_if(candidates, [&](const Candidate& candidate) { return bytes_of(candidate) > limit; });
    if (!candidates.empty()) return;
  }
  throw Error(ErrorCode::limit_exceeded, "choosing textures within a budget takes at least " + grouped(least) +
                                             " bytes, above the limit of " + grouped(limit) + "; raise " +
                                             options.common.memory_option + ", or name --size, --mips and the format");
}

template <class View>
ChosenTextures choose(const View& source, BakeCommandOptions& options, const Control& control) {
  const int resolution = std::clamp(resolution_of(source), kLeastChoice, kLargestChoice);
  // Between the texels of a small picture there are reflections, too, which larger faces show better.
  const int most = std::max(resolution, options.specular.size);
  const std::uint64_t bytes = options.byte_budget;
  const std::optional<double> budget = options.scene.error_budget;
  std::vector<Candidate> candidates = candidates_of(options, most);
  keep_likely(candidates, bytes, budget.has_value());
  ChosenTextures choice;
  const Candidate* best = &candidates.front();
  if (holds_reflections(options)) {
    keep_within_memory(source, candidates, options);
    best = &candidates.front();
    Judge<View> judge(source, options, control);
    for (std::size_t k = 0; k < candidates.size() && !(budget && choice.met); ++k) {
      Candidate& candidate = candidates[k];
      judge.judge(candidate);
      choice.tried.push_back(candidate.tried);
      if (k == 0 || candidate.tried.error < best->tried.error) best = &candidate;
      choice.met = !budget || candidate.tried.error <= *budget;
      const double done = static_cast<double>(k + 1) / static_cast<double>(candidates.size());
      if (control.progress) control.progress(kJudgedFrom + (1.0 - kJudgedFrom) * done);
    }
  } else {
    choice.met = true;
  }
  Candidate chosen = *best;
  if (!budget && options.background_size == 0) enlarge_background(chosen, resolution, bytes);
  choice.chosen = chosen.tried;
  options = std::move(chosen.options);
  return choice;
}

}  // namespace

int resolution_of(const LatLongView& source) noexcept {
  return static_cast<int>(std::bit_ceil((static_cast<unsigned>(source.width) + 3) / 4));
}
int resolution_of(const CubemapView& source) noexcept {
  return static_cast<int>(std::bit_ceil(static_cast<unsigned>(source.size)));
}

bool chooses_textures(const BakeCommandOptions& options) noexcept {
  if (options.byte_budget != kNoByteBudget) return true;
  if (!options.scene.error_budget || !options.scene.needs().glossy || !holds_reflections(options)) return false;
  return !options.size_named || may_choose_mips(options) || may_choose_format(options);
}

ChosenTextures choose_textures(const LatLongView& source, BakeCommandOptions& options, const Control& control) {
  return choose(source, options, control);
}
ChosenTextures choose_textures(const CubemapView& source, BakeCommandOptions& options, const Control& control) {
  return choose(source, options, control);
}

std::string choice_text(const ChosenTextures& choice) {
  std::string text = "Textures\n     size  mips  background        bytes  rms error  at roughness  formats\n";
  for (const TriedTextures& tried : choice.tried) {
    const bool is_chosen =
        tried.size == choice.chosen.size && tried.mips == choice.chosen.mips && tried.format == choice.chosen.format;
    text += pad_left(is_chosen ? "=>" : "", 4) + pad_left(std::to_string(tried.size), 5) +
            pad_left(std::to_string(tried.mips), 6) + pad_left(std::to_string(tried.background_size), 12) +
            pad_left(grouped(tried.bytes), 13) + pad_left(significant(100.0 * tried.error, 3) + " %", 11) +
            pad_left(significant(tried.roughness, 3), 14) + "  " + tried.formats + '\n';
  }
  text += choice.met ? "  chosen: " : "  none is within the budget; the least error is that of: ";
  text += std::to_string(choice.chosen.size) + " texels, " +
          counted(static_cast<std::uint64_t>(choice.chosen.mips), "mip") + ", background " +
          std::to_string(choice.chosen.background_size) + " texels, " + grouped(choice.chosen.bytes) + " bytes\n";
  return text;
}

namespace {

Json tried_json(const TriedTextures& tried) {
  return {{"size", tried.size},          {"mips", tried.mips},   {"background_size", tried.background_size},
          {"formats", tried.formats},    {"bytes", tried.bytes}, {"error", tried.error},
          {"roughness", tried.roughness}};
}

}  // namespace

Json choice_json(const ChosenTextures& choice) {
  Json tried = Json::array();
  for (const TriedTextures& one : choice.tried) tried.push_back(tried_json(one));
  return {{"chosen", tried_json(choice.chosen)}, {"met", choice.met}, {"tried", tried}};
}

}  // namespace welkin::tool
