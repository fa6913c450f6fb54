// The entries of bakes and prefilters: earlier results are found, and the others are kept when they are made.
#include <algorithm>
#include <optional>
#include <utility>
#include <variant>

#include "bake/artefacts.h"
#include "bake/bake_plan.h"
#include "cache/recipe.h"
#include "cache/result_cache.h"
#include "files/environment.h"
#include "harmonics/octahedral.h"
#include "jobs/tiles.h"
#include "platform/float_environment.h"
#include "projection/sanitizer.h"
#include "reflections/prefilter.h"
#include "reflections/prefilter_plan.h"
#include "welkin/result_cache.h"

namespace welkin::cache {
namespace {

// The outcome of sanitizing an image's pixels, kept so that results can be described without the pixels.

struct SanitizedPixels {
  ProjectionDiagnostics diagnostics;  ///< its total radiances are not filled in
  glm::dvec3 clamped_radiance{};      ///< removed by the clamp
};

EntryName sanitized_name(const ContentHash& source, const PixelPolicy& pixels) {
  return {EntryKind::projection, result_key("cleaned pixels", {source, pixel_key(pixels)})};
}

/// Finds the outcome in the entry of a projection, whose total radiance before clamping is that removed by the clamp.
std::optional<SanitizedPixels> find_sanitized(ResultStore& store, const EntryName& name) {
  constexpr int bands = 1;
  auto found =
      store.find(name, projection_bytes(bands), [](ByteSpan bytes) { return decode_projection(bytes, bands); });
  if (!found) return std::nullopt;
  SanitizedPixels sanitized{std::move(found->value.diagnostics), {}};
  std::swap(sanitized.diagnostics.total_radiance_before_clamp, sanitized.clamped_radiance);
  return sanitized;
}

SanitizedPixels store_sanitized(ResultStore& store, const EntryName& name, const projection::SanitizedSource& source) {
  Projection entry{SphericalHarmonics(1), source.diagnostics()};
  entry.diagnostics.total_radiance_before_clamp = source.clamped_radiance();
  store.store(name, [&] { return encode(entry); });
  return {source.diagnostics(), source.clamped_radiance()};
}

// A prefiltered chain mip by mip: a mip that was made before, for any chain, is not made again.

/// Returns the key of all that a mip's bits depend on except the source and its sanitizing: see `Prefilter`.
ContentHash mip_key(const reflections::PrefilterPlan& plan, const reflections::MipPlan& mip) {
  ByteWriter writer;
  writer.all(mip.size, mip.roughness, mip.lobe_roughness, name(mip.method));
  if (plan.family != LobeFamily::ggx) {
    // All lobes of a chain together decide which texels are extracted and how many bands there are.
    writer.all(plan.family, plan.size);
    for (const std::vector<double>& numbers : plan.family_numbers) writer.put(numbers);
    writer.put(plan.bounds.rms);
  } else if (mip.method == MipMethod::spectral || mip.method == MipMethod::near_far) {
    // The narrowest lobe of the whole chain decides which texels are extracted, how many bands there are, and a
    // cubemap's rings.
    writer.all(plan.bounds.rms, plan.bounds.maximum, plan.may_integrate);
    for (std::size_t k = 0; k < plan.spectral_lobes.size(); ++k) {
      // Which of these are summed nearby is decided for all together.
      if (plan.spectral_lobes[k]->alpha() >= reflections::kMaxNearAlpha) continue;
      writer.all(plan.spectral_lobes[k]->alpha(), plan.spectral_sizes[k]);
    }
    writer.put(plan.near_far_size);  // the bands that its far part takes
  }
  return writer.hash();
}

/// A chain that is being put together.
class StoredChain {
 public:
  /// Finds all mips that `plan` makes of a source. `source`: hash of its pixels.
  StoredChain(ResultStore& store, const ContentHash& source, const PixelPolicy& pixels,
              const reflections::PrefilterPlan& plan, memory_resource* memory)
      : store_(store),
        plan_(plan),
        chain_(plan.mips.front().size, static_cast<int>(plan.mips.size()), memory),
        mips_(plan.mips.size()) {
    plan_.energies = std::make_shared<std::vector<float>>();  // those in other mips' entries may be another chain's
    for (std::size_t mip = 0; mip < mips_.size(); ++mip) {
      const auto level = static_cast<int>(mip);
      const ContentHash key = result_key("specular mip", {source, pixel_key(pixels), mip_key(plan, plan.mips[mip])});
      names_.push_back({EntryKind::specular_mip, key});
      auto found = store.find(names_[mip], mip_bytes(chain_.level_size(level)), [&](ByteSpan bytes) {
        return decode_mip(bytes, chain_.level_size(level), chain_.face(level, 0),
                          spectral(mip) ? plan_.energies.get() : nullptr);
      });
      if (!found) {
        if (end_missing_ == 0) first_missing_ = mip;
        end_missing_ = mip + 1;
        continue;
      }
      mips_[mip] = found->value;
      where_ = where_.empty() || where_ == found->where ? found->where : "found in memory and on disk";
      milliseconds_ += found->milliseconds;
    }
  }

  /// Returns the plan of what is missing, from the first such mip to the last; empty if the chain is complete.
  [[nodiscard]] std::optional<reflections::PrefilterPlan> missing() const {
    if (first_missing_ == end_missing_) return std::nullopt;
    return plan_.without(static_cast<int>(first_missing_), static_cast<int>(mips_.size() - end_missing_));
  }

  /// Returns the key of all that decides the bits of a mip.
  [[nodiscard]] const ContentHash& key(int mip) const { return names_[static_cast<std::size_t>(mip)].key; }

  /// Takes the mips of a chain, and keeps them for later bakes.
  void add(PrefilteredSpecular made) {
    for (std::size_t mip = first_missing_; mip < end_missing_; ++mip) {
      const std::size_t level = mip - first_missing_;
      store_.store(names_[mip], [&] {
        return encode_mip(made.mips[level], made.cubemap.face(static_cast<int>(level), 0),
                          spectral(mip) ? *plan_.energies : std::vector<float>());
      });
    }
    const float* const first = made.cubemap.face(0, 0);
    std::copy(first, first + made.cubemap.bytes() / sizeof(float), chain_.face(static_cast<int>(first_missing_), 0));
    made.cubemap = {};
    std::move(made.mips.begin(), made.mips.end(), mips_.begin() + static_cast<std::ptrdiff_t>(first_missing_));
    made_ = std::move(made);
  }

  [[nodiscard]] double milliseconds() const noexcept { return milliseconds_; }  ///< time that finding took

  /// Returns "found on disk", "3 of 5 mips found on disk"; empty if none was.
  [[nodiscard]] std::string found_text() const {
    const std::size_t found = mips_.size() - (end_missing_ - first_missing_);
    if (found == 0) return {};
    if (found == mips_.size()) return where_;
    return std::to_string(found) + " of " + std::to_string(mips_.size()) + " mips " + where_;
  }

  /// Returns the whole chain, once; of its `pixels` only the passes are filled in.
  [[nodiscard]] PrefilteredSpecular take() {
    PrefilteredSpecular whole;
    whole.cubemap = std::move(chain_);
    for (std::size_t k = 0; k < mips_.size(); ++k) {
      MipRecord& mip = whole.mips.emplace_back(*mips_[k]);
      const std::optional<reflections::MipPair>& pair = plan_.mips[k].to_next;
      mip.error_between.reset();  // the next mip may differ from that of the chain it was made for
      if (pair && !plan_.energies->empty())
        mip.error_between = reflections::error_between(*pair, plan_.lookups, *plan_.energies);
    }
    whole.pixels.passes = std::move(made_.pixels.passes);
    if (const std::string found = found_text(); !found.empty()) {
      whole.pixels.passes.insert(whole.pixels.passes.begin(), {"cache", PassAction::reuse, found, milliseconds_});
    }
    whole.peak_bytes = made_.peak_bytes;
    return whole;
  }

 private:
  [[nodiscard]] bool spectral(std::size_t mip) const { return plan_.mips[mip].method == MipMethod::spectral; }

  ResultStore& store_;
  reflections::PrefilterPlan plan_;
  std::vector<EntryName> names_;
  Cubemap chain_;
  std::vector<std::optional<MipRecord>> mips_;
  std::size_t first_missing_ = 0;
  std::size_t end_missing_ = 0;
  std::string where_;
  double milliseconds_ = 0.0;
  PrefilteredSpecular made_;
};

}  // namespace
}  // namespace welkin::cache

namespace welkin {
namespace {

using cache::EntryKind;
using cache::EntryName;
using cache::hash_of;

/// Returns the key of what irradiance depends on, whether or not it shares a chain's harmonics.
ContentHash shared_key(const baking::BakePlan& plan) {
  if (!plan.shares_harmonics) return hash_of(false);
  const reflections::PrefilterPlan& chain = *plan.irradiance_plan;
  return hash_of(true, chain.bounds.rms, chain.bounds.maximum, chain.light_alpha, chain.lights.least_alpha, chain.bands,
                 chain.near_far_size);
}

/// The entries of one bake.
class BakeEntries final : public baking::ArtefactStore {
 public:
  explicit BakeEntries(cache::ResultStore& store) : store_(store) {}

  [[nodiscard]] baking::FoundArtefacts find(const EnvironmentView& pixels, const BakeOptions& options,
                                            const baking::BakePlan& plan, const Control& control) override {
    name_entries(pixels, options, plan, {control.stop, {}});
    baking::FoundArtefacts found;
    if (plan.runs(baking::BakePass::project) && !plan.stored_harmonics) {
      const int bands = plan.projecting.bands;
      found.projection = store_.find(projection_, cache::projection_bytes(bands),
                                     [bands](cache::ByteSpan bytes) { return cache::decode_projection(bytes, bands); });
    } else if (plan.runs(baking::BakePass::sanitize)) {
      if (auto sanitized = cache::find_sanitized(store_, sanitized_)) found.sanitized = sanitized->diagnostics;
    }
    if (plan.background_size > 0 && !plan.stored_background) {
      const int size = plan.background_size;
      const int levels = plan.background_levels;
      found.background = store_.find(background_, cache::cubemap_bytes(size, levels), [&](cache::ByteSpan bytes) {
        return cache::decode_cubemap(bytes, size, levels, control.memory);
      });
    }
    if (options.irradiance && (plan.convolves() || !plan.stored_harmonics)) {
      found.irradiance = find_irradiance(options.irradiance->size);
    }
    if (plan.prefilter) {
      chain_.emplace(store_, source_, options.pixels, *plan.prefilter, control.memory);
      found.missing_specular = chain_->missing();
      found.specular_where = chain_->found_text();
      found.specular_milliseconds = chain_->milliseconds();
      if (plan.octahedral) {
        name_octahedral(*plan.octahedral);
        found.octahedral =
            store_.find(octahedral_, octahedral::map_bytes(*plan.octahedral) + cache::kSmallPayload,
                        [&](cache::ByteSpan bytes) { return cache::decode_octahedral(bytes, *plan.octahedral); });
      }
    }
    return found;
  }

  void keep(const projection::SanitizedSource& sanitized) override {
    static_cast<void>(cache::store_sanitized(store_, sanitized_, sanitized));
  }
  void keep(const Projection& projection) override {
    store_.store(projection_, [&] { return cache::encode(projection); });
  }
  void keep_background(const Cubemap& background) override {
    store_.store(background_, [&] { return cache::encode(background); });
  }
  void keep_irradiance(const reflections::IrradianceMap& irradiance) override {
    store_.store(irradiance_, [&] { return cache::encode_mip(irradiance.record, irradiance.cubemap.face(0)); });
  }
  void keep_octahedral(const OctahedralMap& map) override {
    store_.store(octahedral_, [&] { return cache::encode(map); });
  }
  [[nodiscard]] PrefilteredSpecular whole_specular(std::optional<PrefilteredSpecular> made) override {
    if (made) chain_->add(std::move(*made));
    return chain_->take();
  }

 private:
  /// Names each entry by the key of all that decides its bits.
  void name_entries(const EnvironmentView& view, const BakeOptions& options, const baking::BakePlan& plan,
                    const Control& control) {
    source_ = hash_pixels(view, control);
    const ContentHash pixels = cache::pixel_key(options.pixels);
    projection_ = cache::projection_name(source_, plan.projecting);
    sanitized_ = cache::sanitized_name(source_, options.pixels);
    if (options.background) {
      const ContentHash background =
          hash_of(plan.background_size, plan.background_levels, options.background->mip_filter);
      background_ = {EntryKind::cubemap, cache::result_key("bake background", {source_, pixels, background})};
    }
    if (options.irradiance) {
      const bool pixels_alone = plan.convolves();
      const double error = plan.irradiance == IrradianceMethod::automatic ? options.irradiance->rms_error : 0.0;
      const ContentHash irradiance =
          hash_of(options.irradiance->size, plan.irradiance, pixels_alone ? 0 : options.bands, error);
      irradiance_ = {EntryKind::specular_mip,
                     cache::result_key("bake irradiance", {source_, pixels, irradiance, shared_key(plan)})};
    }
  }

  /// Names the entry by the mips that the map is made of.
  void name_octahedral(const OctahedralOptions& options) {
    const auto& [size, levels, border] = options;
    std::vector<ContentHash> parts{hash_of(size, levels, border)};
    for (int mip = 0; mip < levels; ++mip) parts.push_back(chain_->key(mip));
    octahedral_ = {EntryKind::octahedral, cache::result_key("bake octahedral", {combine(parts)})};
  }

  [[nodiscard]] std::optional<baking::Found<reflections::IrradianceMap>> find_irradiance(int size) {
    return store_.find(irradiance_, cache::mip_bytes(size),
                       [=](cache::ByteSpan bytes) -> std::optional<reflections::IrradianceMap> {
                         reflections::IrradianceMap map{Cubemap(size), {}};
                         const std::optional<MipRecord> record = cache::decode_mip(bytes, size, map.cubemap.face(0));
                         if (!record) return std::nullopt;
                         map.record = *record;
                         return map;
                       });
  }

  cache::ResultStore& store_;
  ContentHash source_;
  EntryName projection_, sanitized_, background_, irradiance_, octahedral_;
  std::optional<cache::StoredChain> chain_;
};

}  // namespace

BakeResult ResultCache::bake(const EnvironmentView& view, const BakeOptions& options, const Control& control) {
  const platform::FloatingPointScope floating_point;
  baking::MemorySource source(view);
  BakeEntries entries(*store_);
  BakeResult result;
  baking::run_bake(result, source, options, &entries, control);
  return result;
}

BakeResult ResultCache::bake(const EnvironmentView& view, const Plan& plan, const Control& control) {
  const platform::FloatingPointScope floating_point;
  baking::MemorySource source(view);
  BakeEntries entries(*store_);
  return baking::run_bake(source, plan, &entries, control);
}

BakeResult ResultCache::bake(const StoredEnvironment& file, const Plan& plan, const Control& control) {
  const platform::FloatingPointScope floating_point;
  BakeEntries entries(*store_);
  return files::bake_file_source(file, plan, &entries, control);
}

PrefilteredSpecular ResultCache::prefilter_specular(const EnvironmentView& source, const PrefilterOptions& options,
                                                    const Control& control) {
  const platform::FloatingPointScope floating_point;
  const ContentHash pixels = hash_pixels(source, jobs::part_of(control, 0.0, cache::kHashing));
  cache::StoredChain chain(*store_, pixels, options.pixels, reflections::plan_prefilter(options), control.memory);
  const std::optional<reflections::PrefilterPlan> missing = chain.missing();
  const EntryName sanitized_entry = cache::sanitized_name(pixels, options.pixels);
  auto sanitized = cache::find_sanitized(*store_, sanitized_entry);
  std::uint64_t sanitized_bytes = 0;
  if (!sanitized || missing) {
    const projection::SanitizedSource texels(source, options.pixels, {control.stop, {}});
    sanitized_bytes = texels.bytes();
    sanitized = cache::store_sanitized(*store_, sanitized_entry, texels);
    if (missing) {
      // Only the whole chain counts as a result.
      Control making = jobs::part_of(control, cache::kHashing, 1.0);
      making.memory = nullptr;
      chain.add(reflections::prefilter(texels, *missing, {}, making));
    }
  }
  PrefilteredSpecular specular = chain.take();
  reflections::describe_pixels(sanitized->diagnostics, sanitized->clamped_radiance, specular);
  specular.peak_bytes += sanitized_bytes;
  if (control.progress) control.progress(1.0);
  return specular;
}

}  // namespace welkin
