// The entries of a bake: what was made before is found, the rest is kept when it is made.
#include "cache/cached_bake.h"

#include <algorithm>
#include <optional>
#include <span>
#include <utility>

#include "bake/artefacts.h"
#include "bake/bake_plan.h"
#include "bake/needs.h"
#include "cache/recipe.h"
#include "cache/result_cache.h"
#include "files/file_source.h"
#include "platform/float_environment.h"
#include "reflections/prefilter_plan.h"
#include "welkin/result_cache.h"

namespace welkin::cache {
namespace {

/// What a mip's bits depend on beside the source and how its pixels are sanitized: see `Prefilter`.
ContentHash mip_key(const reflections::PrefilterPlan& plan, const reflections::MipPlan& mip,
                    const PrefilterOptions& options) {
  ByteWriter writer;
  writer.put(mip.size);
  writer.put(mip.roughness);
  writer.put(mip.copy ? "copy" : name(mip.method));
  if (!mip.copy && mip.method == PrefilterMethod::spectral) {
    // The narrowest lobe of the whole chain decides which texels are taken out, and a cubemap's rings.
    writer.put(plan.least_alpha);
    writer.put(plan.reach);
  }
  if (!mip.copy && mip.method == PrefilterMethod::sampled) {
    writer.put(options.size);  // the chain that the taps read has the size of mip 0
    writer.put(options.samples);
  }
  return hash_bytes(writer.bytes().data(), writer.bytes().size());
}

}  // namespace

std::vector<EntryName> mip_names(const ContentHash& source, const PrefilterOptions& options) {
  const reflections::PrefilterPlan plan = reflections::plan_prefilter(options);
  const ContentHash pixels = pixel_key(options.pixels);
  std::vector<EntryName> names;
  for (const reflections::MipPlan& mip : plan.mips) {
    names.push_back(
        {EntryKind::specular_mip, result_key("specular mip", {source, pixels, mip_key(plan, mip, options)})});
  }
  return names;
}

StoredChain::StoredChain(const ContentHash& source, const PrefilterOptions& options)
    : options_(options),
      names_(mip_names(source, options)),
      chain_(std::max(1, options.size >> options.leave_out_sharp), static_cast<int>(names_.size())),
      mips_(names_.size()) {
  settle();
}

void StoredChain::settle() {
  const auto missing = [](const std::optional<MipRecord>& mip) { return !mip; };
  const auto first = std::find_if(mips_.begin(), mips_.end(), missing);
  const auto last = std::find_if(mips_.rbegin(), mips_.rend(), missing);
  first_missing_ = static_cast<std::size_t>(first - mips_.begin());
  end_missing_ = static_cast<std::size_t>(mips_.rend() - last);
}

PrefilterOptions StoredChain::missing() const {
  PrefilterOptions rest = options_;
  rest.leave_out_sharp += static_cast<int>(first_missing_);
  rest.leave_out_rough += static_cast<int>(names_.size() - end_missing_);
  return rest;
}

void StoredChain::take_over(PrefilteredSpecular made) {
  if (made.mips.size() == names_.size()) {
    chain_ = std::move(made.cubemap);
  } else {
    const float* const first = made.cubemap.face(0, 0);
    std::copy(first, first + made.cubemap.bytes() / sizeof(float), chain_.face(static_cast<int>(first_missing_), 0));
  }
  std::move(made.mips.begin(), made.mips.end(), mips_.begin() + static_cast<std::ptrdiff_t>(first_missing_));
  made_ = std::move(made);
}

std::string StoredChain::found_text() const {
  const std::size_t found = names_.size() - (end_missing_ > first_missing_ ? end_missing_ - first_missing_ : 0);
  if (found == 0) return {};
  if (complete()) return "found " + where_;
  return std::to_string(found) + " of " + std::to_string(names_.size()) + " mips found " + where_;
}

PrefilteredSpecular StoredChain::take() {
  PrefilteredSpecular whole;
  whole.cubemap = std::move(chain_);
  for (std::optional<MipRecord>& mip : mips_) whole.mips.push_back(std::move(*mip));
  whole.pixels.passes = std::move(made_.pixels.passes);
  if (const std::string found = found_text(); !found.empty()) {
    whole.pixels.passes.insert(whole.pixels.passes.begin(), {"cache", PassAction::reuse, found, milliseconds_});
  }
  whole.peak_bytes = made_.peak_bytes;
  return whole;
}

}  // namespace welkin::cache

namespace welkin {
namespace {

using cache::EntryKind;
using cache::EntryName;
using cache::hash_of;

CubemapChain chain_of(const CubemapImage& image) {
  CubemapChain chain(image.size, 1);
  std::copy(image.pixels.begin(), image.pixels.end(), chain.face(0, 0));
  return chain;
}

CubemapImage image_of(const CubemapChain& chain) {
  const float* const first = chain.face(0, 0);
  return {chain.size(), std::vector<float>(first, first + chain.bytes() / sizeof(float))};
}

/// The entries of one bake. Store: ResultCache::Store.
template <class Store>
class BakeEntries final : public baking::ArtefactStore {
 public:
  explicit BakeEntries(Store& store) : store_(store) {}

  [[nodiscard]] baking::FoundArtefacts find(const baking::Source& source, const BakeOptions& options,
                                            const baking::BakePlan& plan, const Control& control) override {
    identify(source, options, plan, {control.stop, {}});
    baking::FoundArtefacts found;
    const bool computes_light = runs(plan, baking::BakePass::project) && !plan.stored_harmonics;
    if (computes_light) {
      found.projection = found_as(store_.find(
          projection_, [&](cache::ByteSpan bytes) { return cache::decode_projection(bytes, plan.projecting.bands); }));
    } else if (runs(plan, baking::BakePass::sanitize)) {
      if (auto sanitized = cache::find_sanitized(store_, sanitized_)) found.sanitized = sanitized->diagnostics;
    }
    if (plan.background_size > 0 && !plan.stored_background) {
      found.background = found_as(find_cubemap(background_, plan.background_size, plan.background_levels));
    }
    const bool from_source = plan.stored_harmonics && options.irradiance_method == IrradianceMethod::harmonics;
    if (options.irradiance_size > 0 && !from_source) {
      if (auto image = find_cubemap(irradiance_, options.irradiance_size, 1)) {
        found.irradiance = {image_of(image->value), words(image->where), image->milliseconds};
      }
    }
    if (options.specular && !plan.stored_specular) find_specular(options, found);
    return found;
  }

  void keep(const projection::SanitizedSource& sanitized) override {
    static_cast<void>(cache::store_sanitized(store_, sanitized_, sanitized));
  }
  void keep(const Projection& projection) override { store_.store(projection_, cache::encode(projection)); }
  void keep_background(const CubemapChain& background) override {
    store_.store(background_, cache::encode(background));
  }
  void keep_irradiance(const CubemapImage& irradiance) override {
    store_.store(irradiance_, cache::encode(chain_of(irradiance)));
  }
  [[nodiscard]] PrefilteredSpecular whole_specular(std::optional<PrefilteredSpecular> made) override {
    if (made) chain_->add(store_, std::move(*made));
    return chain_->take();
  }

 private:
  static bool runs(const baking::BakePlan& plan, baking::BakePass pass) {
    return plan.step(pass).planned.action != PassAction::skip;
  }
  static std::string words(const char* where) { return std::string("found ") + where; }

  template <class Value>
  static std::optional<baking::Found<Value>> found_as(std::optional<FoundResult<Value>> result) {
    if (!result) return std::nullopt;
    return baking::Found<Value>{std::move(result->value), words(result->where), result->milliseconds};
  }

  /// Names of the entries: what decides the bits of each.
  void identify(const baking::Source& source, const BakeOptions& options, const baking::BakePlan& plan,
                const Control& control) {
    source_ = source.shape().cubemap ? hash_pixels(source.cubemap(), control) : hash_pixels(source.lat_long(), control);
    const ContentHash pixels = cache::pixel_key(options.pixels);
    projection_ = cache::projection_name(source_, plan.projecting);
    sanitized_ = cache::sanitized_name(source_, options.pixels);
    const ContentHash background = hash_of(plan.background_size, plan.background_levels, options.mip_filter);
    background_ = {EntryKind::cubemap, cache::result_key("bake background", {source_, pixels, background})};
    // From harmonics its bits are those of the first of all bands that are projected.
    const bool direct = options.irradiance_method == IrradianceMethod::direct;
    const ContentHash irradiance =
        hash_of(options.irradiance_size, direct, direct ? 0 : options.bands, direct ? 0 : plan.projecting.bands);
    irradiance_ = {EntryKind::cubemap, cache::result_key("bake irradiance", {source_, pixels, irradiance})};
  }

  [[nodiscard]] auto find_cubemap(const EntryName& name, int size, int levels) {
    return store_.find(name, [=](cache::ByteSpan bytes) { return cache::decode_cubemap(bytes, size, levels); });
  }

  void find_specular(const BakeOptions& options, baking::FoundArtefacts& found) {
    PrefilterOptions prefiltering = *options.specular;
    prefiltering.pixels = options.pixels;
    chain_.emplace(source_, prefiltering);
    chain_->find(store_);
    if (!chain_->complete()) found.missing_specular = chain_->missing();
    found.specular_where = chain_->found_text();
    found.specular_milliseconds = chain_->milliseconds();
  }

  Store& store_;
  ContentHash source_;
  EntryName projection_, sanitized_, background_, irradiance_;
  std::optional<cache::StoredChain> chain_;
};

template <class Store>
BakeResult bake_with(Store& store, baking::Source& source, const BakeOptions& options,
                     std::span<const PlannedPass> planned, const Control& control) {
  BakeResult result;
  BakeEntries<Store> entries(store);
  baking::run_bake(result, source, {options, planned, &entries}, control);
  return result;
}

}  // namespace

BakeResult ResultCache::bake(const CubemapView& view, const BakeOptions& options, const Control& control) {
  const platform::FloatingPointScope floating_point;
  baking::MemorySource source(view);
  return bake_with(*store_, source, options, {}, control);
}

BakeResult ResultCache::bake(const LatLongView& view, const BakeOptions& options, const Control& control) {
  const platform::FloatingPointScope floating_point;
  baking::MemorySource source(view);
  return bake_with(*store_, source, options, {}, control);
}

BakeResult ResultCache::bake(const CubemapView& view, const Plan& plan, const Control& control) {
  const platform::FloatingPointScope floating_point;
  baking::MemorySource source(view);
  baking::require_same_source(plan, source.shape().words());
  return bake_with(*store_, source, plan.options, plan.passes, control);
}

BakeResult ResultCache::bake(const LatLongView& view, const Plan& plan, const Control& control) {
  const platform::FloatingPointScope floating_point;
  baking::MemorySource source(view);
  baking::require_same_source(plan, source.shape().words());
  return bake_with(*store_, source, plan.options, plan.passes, control);
}

BakeResult ResultCache::bake(const StoredEnvironment& file, const Plan& plan, const Control& control) {
  const platform::FloatingPointScope floating_point;
  BakeEntries<Store> entries(*store_);
  return files::bake_file_source(file, plan, &entries, control);
}

}  // namespace welkin
