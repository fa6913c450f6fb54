// A bake part by part: what was there is read, and one smaller bake makes the rest.
#include "cache/cached_bake.h"

#include <algorithm>
#include <chrono>
#include <optional>
#include <utility>

#include "bake/bake_plan.h"
#include "cache/recipe.h"
#include "cache/result_cache.h"
#include "jobs/tiles.h"
#include "reflections/prefilter.h"
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
    whole.pixels.passes.insert(whole.pixels.passes.begin(), {"cache", "reuse", found, milliseconds_});
  }
  whole.peak_bytes = made_.peak_bytes;
  return whole;
}

}  // namespace welkin::cache

namespace welkin {
namespace {

using baking::BakePass;
using cache::EntryKind;
using cache::EntryName;
using cache::hash_of;

constexpr double kProjected = 0.15;  ///< of the progress

CubemapChain chain_of(const CubemapImage& image) {
  CubemapChain chain(image.size, 1);
  std::copy(image.pixels.begin(), image.pixels.end(), chain.face(0, 0));
  return chain;
}

CubemapImage image_of(const CubemapChain& chain) {
  const float* const first = chain.face(0, 0);
  return {chain.size(), std::vector<float>(first, first + chain.bytes() / sizeof(float))};
}

/// One call's work. Store: ResultCache::Store.
template <class View, class Store>
class CachedBake {
 public:
  CachedBake(Store& store, const View& view, const BakeOptions& options, const baking::BakePlan& plan)
      : store_(store), view_(view), options_(options), plan_(plan) {}

  BakeResult run(const Control& control) {
    const auto start = std::chrono::steady_clock::now();
    source_ = hash_pixels(view_, {control.stop, {}});
    const std::chrono::duration<double, std::milli> hashed = std::chrono::steady_clock::now() - start;
    find();
    project(jobs::part_of(control, 0.0, kProjected));
    bake_rest(jobs::part_of(control, kProjected, 1.0));
    std::vector<PassRecord> passes = std::move(result_.diagnostics.passes);
    result_.diagnostics = diagnostics(control);
    result_.diagnostics.passes = std::move(passes);
    put(projecting_);
    take_found();
    result_.diagnostics.passes.insert(result_.diagnostics.passes.begin(),
                                      {"hash", "run", "of the source, to find what was made of it", hashed.count()});
    result_.peak_bytes = plan_.result_bytes + plan_.working_bytes;
    return std::move(result_);
  }

 private:
  using FoundCubemap = std::optional<FoundResult<CubemapChain>>;

  [[nodiscard]] ContentHash pixels() const { return cache::pixel_key(options_.pixels); }
  [[nodiscard]] EntryName background_name() const {
    const ContentHash what = hash_of(plan_.background_size, plan_.background_levels, options_.mip_filter);
    return {EntryKind::cubemap, cache::result_key("bake background", {source_, pixels(), what})};
  }
  /// From harmonics its bits are those of the first of all bands that are projected.
  [[nodiscard]] EntryName irradiance_name() const {
    const bool direct = options_.irradiance_method == IrradianceMethod::direct;
    const ContentHash what =
        hash_of(options_.irradiance_size, direct, direct ? 0 : options_.bands, direct ? 0 : plan_.projecting.bands);
    return {EntryKind::cubemap, cache::result_key("bake irradiance", {source_, pixels(), what})};
  }

  [[nodiscard]] bool runs(BakePass pass) const { return plan_.step(pass).planned.action != PassAction::skip; }

  [[nodiscard]] FoundCubemap find_cubemap(const EntryName& name, int size, int levels) {
    return store_.find(name, [=](cache::ByteSpan bytes) { return cache::decode_cubemap(bytes, size, levels); });
  }

  void find() {
    if (plan_.background_size > 0)
      background_ = find_cubemap(background_name(), plan_.background_size, plan_.background_levels);
    if (options_.irradiance_size > 0) irradiance_ = find_cubemap(irradiance_name(), options_.irradiance_size, 1);
    if (!options_.specular) return;
    PrefilterOptions prefiltering = *options_.specular;
    prefiltering.pixels = options_.pixels;
    chain_.emplace(source_, prefiltering);
    chain_->find(store_);
  }

  void project(const Control& control) {
    const PlannedPass& planned = plan_.step(BakePass::project).planned;
    projecting_ = {planned.name, name(planned.action), planned.reason, 0.0};
    if (!runs(BakePass::project)) return;
    const EntryName entry = cache::projection_name(source_, plan_.projecting);
    projection_ = store_.find_projection(entry, plan_.projecting.bands);
    if (projection_) {
      projecting_ = projection_->diagnostics.passes.front();
      projecting_.name = planned.name;
      return;
    }
    projection_ = welkin::project(view_, plan_.projecting, control);
    projecting_.milliseconds = projection_->diagnostics.passes.back().milliseconds;
    store_.store(entry, cache::encode(*projection_));
  }

  void bake_rest(const Control& control) {
    BakeOptions missing = options_;
    missing.background_size = plan_.background_size;
    missing.background = plan_.background_size > 0 && !background_;
    missing.specular.reset();
    if (chain_ && !chain_->complete()) missing.specular = chain_->missing();
    if (irradiance_) missing.irradiance_size = 0;
    missing.total_radiance = false;
    baking::StoredResults stored;
    if (projection_) stored.harmonics = &projection_->radiance;
    baking::bake_source(result_, view_, missing, stored, {}, control);
    if (missing.background) store_.store(background_name(), cache::encode(result_.background));
    if (missing.irradiance_size > 0) store_.store(irradiance_name(), cache::encode(chain_of(result_.irradiance)));
    if (missing.specular) chain_->add(store_, std::move(*result_.specular));
  }

  /// As a bake has them: the projection's, or where there is none those of sanitizing.
  [[nodiscard]] ProjectionDiagnostics diagnostics(const Control& control) {
    if (projection_) return std::move(projection_->diagnostics);
    ProjectionDiagnostics texels;
    texels.texels = shape_of(view_).texels();
    if (!runs(BakePass::sanitize)) return texels;
    const EntryName entry = cache::sanitized_name(source_, options_.pixels);
    if (auto found = cache::find_sanitized(store_, entry)) return std::move(found->diagnostics);
    const projection::SanitizedSource sanitized(view_, options_.pixels, {control.stop, {}});
    return cache::store_sanitized(store_, entry, sanitized).diagnostics;
  }

  void take_found() {
    if (background_) {
      result_.background = std::move(background_->value);
      put(reused(BakePass::background, background_->where, background_->milliseconds));
      if (plan_.background_levels > 1) put(reused(BakePass::background_mips, background_->where, 0.0));
    }
    if (irradiance_) {
      result_.irradiance = image_of(irradiance_->value);
      put(reused(BakePass::irradiance, irradiance_->where, irradiance_->milliseconds));
    }
    if (!chain_) return;
    if (const std::string found = chain_->found_text(); !found.empty()) {
      PassRecord& record = record_of(baking::name(BakePass::specular));
      record.reason = chain_->complete() ? found : found + ", the others made";
      if (chain_->complete()) record.action = name(PassAction::reuse);
      record.milliseconds += chain_->milliseconds();
    }
    result_.specular = chain_->take();
    ProjectionDiagnostics pixels;  // nothing to report: what was prefiltered has been sanitized before
    pixels.texels = shape_of(view_).texels();
    reflections::describe_pixels(pixels, {}, *result_.specular);
  }

  [[nodiscard]] PassRecord reused(BakePass pass, const char* where, double milliseconds) const {
    return {baking::name(pass), name(PassAction::reuse), std::string("found ") + where, milliseconds};
  }

  /// A bake records every pass, those that it skips too.
  [[nodiscard]] PassRecord& record_of(const std::string& pass) {
    std::vector<PassRecord>& passes = result_.diagnostics.passes;
    return *std::find_if(passes.begin(), passes.end(), [&](const PassRecord& record) { return record.name == pass; });
  }
  void put(const PassRecord& record) { record_of(record.name) = record; }

  Store& store_;
  const View& view_;
  const BakeOptions& options_;
  const baking::BakePlan& plan_;
  ContentHash source_;
  std::optional<Projection> projection_;
  PassRecord projecting_;
  FoundCubemap background_;
  FoundCubemap irradiance_;
  std::optional<cache::StoredChain> chain_;
  BakeResult result_;
};

}  // namespace

template <class View>
BakeResult ResultCache::bake_view(const View& view, const BakeOptions& options, const Control& control) {
  const baking::BakePlan plan = baking::plan_bake(shape_of(view), options);
  baking::require_memory(plan.result_bytes, plan.working_bytes, options);
  return CachedBake<View, Store>(*store_, view, options, plan).run(control);
}

BakeResult ResultCache::bake(const CubemapView& source, const BakeOptions& options, const Control& control) {
  return bake_view(source, options, control);
}

BakeResult ResultCache::bake(const LatLongView& source, const BakeOptions& options, const Control& control) {
  return bake_view(source, options, control);
}

}  // namespace welkin
