#include "reflections/lobe_chain.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <span>

#include "image/sphere_grid.h"
#include "jobs/tiles.h"
#include "platform/text.h"
#include "reflections/band_choice.h"
#include "reflections/direct.h"
#include "reflections/lobe.h"
#include "welkin/resampling.h"

namespace welkin::reflections {
namespace {

constexpr double kPi = std::numbers::pi;
constexpr double kReferenceError = 2e-5;  ///< see `KernelFunction::far`
constexpr double kLeftOut = 0.1;          ///< of lights, over the darkest texel and the bound
constexpr double kOfFarLights = 2e-4;     ///< of what narrow lobes' far parts have of lights
constexpr int kFewTexels = 48;            ///< along an edge: wider ones' weights in near sums are to be estimated

using jobs::Stopwatch;

void make_not_negative(int size, const Faces& faces) {
  const std::ptrdiff_t count = std::ptrdiff_t{3} * size * size;
  for (float* const values : faces)
    std::transform(values, values + count, values, [](float value) { return std::max(value, 0.0F); });
}

/// Returns about how long a mip takes, in any unit.
double work_of(const MipPlan& mip) {
  return static_cast<double>(mip.size) * mip.size + mip.bands.bands() * mip.bands.bands();
}

}  // namespace

PrefilteredSpecular LobeChain::run(const Control& control, float scale, IrradianceMap* irradiance) {
  jobs::TaskGraph graph;
  if (plan_.bands > 0) add_spectral_passes(spectral_levels(), graph);
  for (std::size_t level = 0; level < plan_.mips.size(); ++level) {
    constexpr double kIntegral = 1000.0;  // of a copy's time
    const MipPlan& mip = plan_.mips[level];
    if (mip.method == MipMethod::copy)
      graph.add(work_of(mip), [this, level](const Control& part) { copy_mip(level, part); });
    if (mip.method == MipMethod::reference)
      graph.add(kIntegral * work_of(mip),
                [this, level, &mip](const Control& part) { integrate_mip(target(level), mip, part); });
  }
  graph.run(control);
  tighten({control.stop, {}});
  for (std::size_t level = 0; level < plan_.mips.size() && !image_energies_.empty(); ++level) {
    const std::optional<MipPair>& mips = plan_.mips[level].to_next;
    if (mips) record(level).error_between = error_between(*mips, plan_.lookups, image_energies_);
  }
  if (plan_.energies && !image_energies_.empty()) *plan_.energies = image_energies_;
  result_.pixels.passes = std::move(passes_);
  result_.peak_bytes = memory_.peak();
  if (plan_.irradiance) *irradiance = irradiance_times(kPi / static_cast<double>(scale));
  return std::move(result_);
}

/// Adds a pass to the diagnostics if a channel is too dark relative to `field`, the root mean square of what was summed
/// in floats, for the bound on its error.
void LobeChain::note_darkness(const ChainTarget& target, double field, const Control& control) {
  constexpr double kFloatNoise = 1e-6;  // of the field, at any texel: five times the rms of harmonics in floats
  const double share = kFloatNoise / target.bounds.maximum;
  if (least_of(target.chain, target.level, control) >= share * field) return;
  note(target.name + ": dark channels",
       "below 1 / " + platform::number_text(std::round(1.0 / share)) +
           " of the mip, where floats err by more than a texel may",
       0.0);
}

void LobeChain::end_mip(const ChainTarget& target, const MipPlan& mip, const Stopwatch& watch, const Control& control) {
  target.record.size = mip.size;
  target.record.roughness = mip.roughness;
  target.record.lobe_roughness = mip.lobe_roughness;
  target.record.method = mip.method;
  const CubemapView whole = target.chain.view(target.level);
  target.record.mean = mean_radiance(project(whole, {.bands = 1}, {control.stop, {}}).radiance);
  target.record.milliseconds = watch.milliseconds();
}

void LobeChain::find_lights(const Control& control) {
  const Stopwatch watch;
  const std::size_t most = plan_.lights.of == LightsOf::ggx ? kMaxBright : kMaxBrightFar;
  texels_ = find_bright_texels(source_, spectral_.light_alpha, most, control);
  bright_ = BrightLights(texels_, ImageShape::of(source_), spectral_.lights, spectral_.reach);
  memory_.take(bright_.bytes());
  note("bright texels", std::to_string(texels_.size()) + " extracted", watch.milliseconds());
  if (plan_.uses(MipMethod::near_far)) steps_ = contrast_of(source_);
}

void LobeChain::analyse_rings(const Control& control) {
  const Stopwatch watch;
  const int wanted = source_.cubemap() ? spectral_.rows_for_cubemap() : 0;
  const int face = spectral_.face_for_cubemap(source_.columns());
  const std::size_t bringing = source_.cubemap() ? cube_rings_bytes(source_.columns(), face, wanted) : 0;
  memory_.take(bringing);
  if (source_.cubemap()) {
    int finest = face;
    for (const MipPlan& mip : spectral_.near_mips)
      finest = std::max(finest, std::min(mip.near.face, source_.columns()));
    memory_.give_back(faces_.owned.bytes());
    faces_ = {};
    faces_ = halved_faces(rows_without(texels_, source_), finest, {control.stop, {}});
    memory_.take(faces_.owned.bytes());
    if (!spectral_.near_mips.empty() && faces_.face() < kFewTexels)
      contrast_ = contrast_of_faces(faces_.rows, faces_.face());
  }
  // Tighter bounds take so many bands that the tail says enough, and sums would refuse noise that is within them.
  const bool few = spectral_.near_mips.empty() && spectral_.bands < bands_for_dark(plan_.bounds);
  const bool looked = spectral_.lights.of == LightsOf::ggx && (few || plan_.bounds.rms > 1e-3);
  std::optional<ImageSums> sums;
  Rings rings;
  if (source_.cubemap()) {
    const SourceRows coarse = halved_faces({faces_.rows}, face, {control.stop, {}});
    if (looked) sums.emplace(coarse, wanted);
    rings = rings_of_cubemap(coarse.rows, wanted, {control.stop, {}});
  } else {
    rings = rings_of_lat_long(source_, texels_);
    if (looked) sums.emplace(rings.view);
  }
  if (spectral_.near_mips.empty()) {
    memory_.give_back(faces_.owned.bytes());
    faces_ = {};
  }
  memory_.give_back(bringing);
  memory_.take(rings.bytes());
  note("rings", std::to_string(rings.view.height) + " of them", watch.milliseconds());
  const Stopwatch analysis;
  spectrum_ = transforms::analyse(rings.view, spectral_.bands, control, transforms::SourceRows::fewer);
  memory_.take(spectrum_.bytes());
  note("analyse", std::to_string(spectral_.bands) + " bands", analysis.milliseconds());
  memory_.give_back(rings.bytes());
  energies_ = energies_of(spectrum_);
  beyond_ = sums ? sums->beyond(energies_) : EnergyBeyond{};
  rows_ = rings.view.height;
}

void LobeChain::analyse(const Control& control) {
  for (Control part = control;; part.progress = {}) {
    analyse_rings(part);
    if (plan_.lights.of == LightsOf::ggx) break;
    const int wanted = choose_bands_by_energy(spectral_, spectral_source());
    if (std::exchange(spectral_.bands, wanted) == wanted) break;
    memory_.give_back(spectrum_.bytes());
    note("energies", "more than most images have: " + std::to_string(spectral_.bands) + " bands", 0.0);
  }
  if (plan_.lights.of == LightsOf::ggx && !plan_.mips.empty() && spectral_.tightenings == 0)
    image_energies_ = whole_energies(energies_, texels_, ImageShape::of(source_), {control.stop, {}});
}

std::vector<LobeChain::SpectralMip> LobeChain::spectral_levels() const {
  std::vector<SpectralMip> mips;
  for (std::size_t level = 0; level < plan_.mips.size(); ++level) {
    const MipMethod method = plan_.mips[level].method;
    if (method == MipMethod::spectral || method == MipMethod::near_far) mips.push_back({level});
  }
  if (plan_.irradiance) mips.push_back({});
  return mips;
}

/// Makes those mips for which this step's bands and near sums do. By itself alone each goes on to a next step, so that
/// it has the same bits whatever other mips there are.
void LobeChain::add_spectral_passes(std::vector<SpectralMip> mips, jobs::TaskGraph& graph) {
  constexpr double kAnalysis = 2.0 / 3.0;  // of the time of what it is for
  spectral_mips_ = std::move(mips);
  near_far_mips_.clear();
  const auto plan_of = [&](const SpectralMip& job) -> const MipPlan& {
    return job.level ? spectral_.mips[*job.level] : *spectral_.irradiance;
  };
  double work = 0.0;
  for (const SpectralMip& job : spectral_mips_) work += work_of(plan_of(job));
  const std::size_t analysed = graph.add(kAnalysis * work, [this](const Control& part) {
    if (spectral_.tightenings == 0) find_lights({part.stop, {}});
    analyse(part);
  });
  for (SpectralMip& job : spectral_mips_) {
    const MipPlan& mip = plan_of(job);
    const ChainTarget to = job.level ? target(*job.level) : target_of_irradiance();
    job.made = mip.method == MipMethod::near_far;
    if (job.made) {
      near_far_mips_.push_back({to, mip, nullptr});
    } else {
      graph.add(work_of(mip), [this, to, &job, &mip](const Control& part) { job.made = spectral_mip(to, mip, part); },
                {analysed});
    }
  }
  if (!near_far_mips_.empty()) add_near_far_passes(analysed, graph);
}

/// Further steps for mips that the first did not make: none are left after the last.
void LobeChain::tighten(const Control& control) {
  for (;;) {
    memory_.give_back(spectrum_.bytes());
    spectrum_ = {};
    std::vector<SpectralMip> left;
    for (const SpectralMip& job : spectral_mips_) {
      if (!job.made) left.push_back(job);
    }
    if (left.empty()) return;
    spectral_ = step_of(spectral_.tightenings + 1);
    note("energies", "more than most images have: " + std::to_string(spectral_.bands) + " bands", 0.0);
    jobs::TaskGraph graph;
    add_spectral_passes(std::move(left), graph);
    graph.run(control);
  }
}

/// Narrow mips' near sums look at the same texels of the whole source.
void LobeChain::add_near_far_passes(std::size_t analysed, jobs::TaskGraph& graph) {
  std::vector<std::size_t> far;
  for (NearFarMip& job : near_far_mips_) {
    far.push_back(graph.add(work_of(job.mip),
                            [this, &job](const Control& part) {
                              job.table = NearTable::get(job.mip.near);
                              job.mip = with_far_part(std::move(job.mip));
                              blur(job.to, job.mip, part);
                            },
                            {analysed}));
  }
  const auto near = graph.add(
      2.0 * work_of(near_far_mips_.front().mip),
      [this](const Control& part) {
        std::vector<NearMip> tables;
        for (const NearFarMip& job : near_far_mips_) tables.push_back({job.table, job.to.faces()});
        add_near_sums("near_far", rows_without({}, source_), source_.columns(), tables, part);
      },
      far);
  for (const NearFarMip& job : near_far_mips_) {
    graph.add(work_of(job.mip),
              [this, &job](const Control& part) { static_cast<void>(end_spectral_mip(job.to, job.mip, {}, part)); },
              {near});
  }
}

/// Adds the near parts of their lobes to mips' faces. `faces`: the source's, of `columns`.
void LobeChain::add_near_sums(const std::string& name, const SourceRows& faces, int columns,
                              const std::vector<NearMip>& mips, const Control& control) {
  const Stopwatch watch;
  const SourceRows cut = cut_rows(faces.rows, columns, mips.front().table->split());
  std::size_t bytes = 0;
  for (const NearMip& mip : mips) bytes = std::max(bytes, near_sums_bytes(mip.table->split()));
  bytes += faces.owned.bytes() + cut.owned.bytes();
  memory_.take(bytes);
  reflections::add_near_sums(cut.rows, mips, control);
  for (const NearMip& mip : mips) {
    if (!source_.has_negatives()) make_not_negative(mip.table->split().size, mip.faces);
  }
  memory_.give_back(bytes);
  note(name + ": near sums", std::to_string(mips.front().table->split().face) + " columns", watch.milliseconds());
}

/// Writes a mip's faces without the extracted light.
void LobeChain::blur(const ChainTarget& target, const MipPlan& mip, const Control& control) {
  const Stopwatch watch;
  const bool negative = source_.has_negatives() || mip.lobe->negative() || mip.near.face > 0;
  const transforms::GridSize grid_size = mip.grid();
  image::SphereGrid grid(grid_size.rings, grid_size.columns, image::GridContent::spline_coefficients);
  memory_.take(grid.bytes());
  transforms::synthesise(spectrum_, mip.bands.zonal, grid, jobs::part_of(control, 0.0, 0.6));
  note(target.name + ": synthesise", std::to_string(grid.rings()) + " rings", watch.milliseconds());
  const Stopwatch sampling;
  const int size = target.chain.level_size(target.level);
  image::sample_faces(grid, size, target.faces(), {.not_negative = !negative}, jobs::part_of(control, 0.6, 1.0));
  memory_.give_back(grid.bytes());
  note(target.name + ": faces", std::to_string(size) + " texels along an edge", sampling.milliseconds());
}

/// Returns whether the darkest texel of a mip without the extracted light keeps the bound on the largest error.
bool LobeChain::shows_dark(const ChainTarget& target, const MipPlan& mip, const Control& control) const {
  constexpr double kOfTruncated = 8.0;  // over the root mean square: the largest error
  const double darkest = least_of(target.chain, target.level, control);
  return kOfTruncated * truncated_afar(mip, energies_) <= target.bounds.maximum * darkest;
}

/// Chooses the bands of a GGX lobe that harmonics alone make: a quarter more as long as the image's energies take
/// more. Returns whether `most` are enough.
bool LobeChain::settle_bands(const ChainTarget& target, MipPlan& mip, int most) const {
  for (int bands = first_bands_within(mip.alpha, target.bounds);;
       bands += (bands / 4 + kBandStep - 1) / kBandStep * kBandStep) {
    mip.bands = tapered_lobe(mip.alpha, std::min(bands, most));
    if (keeps_rms_error(mip, target.bounds.rms, spectral_source(), texels_)) return true;
    if (bands >= most) return false;
  }
}

/// Returns false where a next step is to make the mip.
bool LobeChain::spectral_mip(const ChainTarget& target, MipPlan mip, const Control& control) {
  const Stopwatch watch;
  const bool near = mip.near.face > 0;
  const bool ggx = mip.alpha > 0.0;  // whose bands the image decides
  const bool first = spectral_.tightenings == 0;
  if (near) mip = with_far_part(std::move(mip));
  const int most = first ? spectrum_.bands() : std::min(spectrum_.bands(), mip.bands.bands());
  const bool does = !ggx || (near ? keeps_rms_error(mip, target.bounds.rms, spectral_source(), texels_)
                                  : settle_bands(target, mip, most));
  if (!does && !last_step()) return false;
  int of_dark = 0;
  if (ggx && first) of_dark = bands_for_dark(target.bounds);
  if (ggx && !first && !near)
    of_dark = std::min(most, bands_for_dark(target.bounds.tightened(spectral_.tightenings - 1)));
  blur(target, mip, jobs::part_of(control, 0.0, 0.7));
  if (near) {
    const SourceRows faces = halved_faces({faces_.rows}, std::min(mip.near.face, faces_.face()), {control.stop, {}});
    add_near_sums(target.name, faces, faces.face(), {{NearTable::get(mip.near), target.faces()}}, {control.stop, {}});
  }
  if (mip.bands.bands() < of_dark && !shows_dark(target, mip, control)) {
    if (near || of_dark > spectrum_.bands()) return false;
    mip.bands = tapered_lobe(mip.alpha, of_dark);
    blur(target, mip, {control.stop, {}});
  }
  return end_spectral_mip(target, mip, watch, jobs::part_of(control, 0.7, 1.0));
}

/// Adds lights to a mip and estimates its error. Returns false where a next step is to make the mip.
bool LobeChain::end_spectral_mip(const ChainTarget& target, const MipPlan& mip, const Stopwatch& watch,
                                 const Control& control) {
  const bool narrow = mip.method == MipMethod::near_far;
  const Stopwatch splatting;
  const double least =
      bright_.empty() || narrow ? 0.0 : kLeftOut * target.bounds.rms * least_of(target.chain, target.level, control);
  const double left_out =
      bright_.add({*mip.lobe, narrow ? mip.near.end() : 0.0, least}, mip.size, target.faces(), control);
  note_darkness(target, blurred_rms(energies_, mip.bands.zonal), control);
  note(target.name + ": lobes", std::to_string(texels_.size()) + " bright texels", splatting.milliseconds());
  target.record.bands = mip.bands.bands();
  target.record.bright_texels = static_cast<int>(texels_.size());
  const double rms = narrow ? rms_of_level(target.chain, target.level, mip.size) : target.rms(*mip.lobe);
  // Few texels may lie where the error of a lobe with kinks is largest.
  const double by_chance = mip.alpha > 0.0 ? 1.0 : std::min(2.0, 1.0 + 4.0 / mip.size);
  const double of_lights = narrow ? kOfFarLights * (bright_.empty() ? 0.0 : mip.bands.zonal.front() * rms)
                                  : bright_.error(*mip.lobe, mip.size, rms) + left_out;
  target.record.error_estimate = by_chance * spectral_rms_error(mip, spectral_source(), of_lights, rms);
  // more bands may do
  if (mip.near.face > 0 && !narrow && !last_step() && *target.record.error_estimate > target.bounds.rms) return false;
  keep_or_integrate(target, mip, watch, control);
  return true;
}

/// Ends a mip that keeps the bound by its estimate; integrates it otherwise, or throws.
void LobeChain::keep_or_integrate(const ChainTarget& target, const MipPlan& mip, const Stopwatch& watch,
                                  const Control& control) {
  const double estimate = *target.record.error_estimate;
  if (estimate <= target.bounds.rms) {
    end_mip(target, mip, watch, control);
    return;
  }
  if (!may_integrate(target, mip)) refuse_rms_error(estimate, target.bounds.rms, target.name);
  integrate_mip(target, mip, {control.stop, {}});
  target.record.bands = 0;
  target.record.bright_texels = 0;
}

/// Returns seconds that one core takes to integrate a mip, within a factor of 2 of those measured.
double LobeChain::seconds_to_integrate(const MipPlan& mip) const {
  const double texels = static_cast<double>(source_.columns()) * source_.rows();
  double each = 1e-8 * texels;
  if (mip.alpha == 0.0) {
    // a lobe's table is looked up at some points of each texel, and each texel at the horizon is cut along it
    constexpr double kOfTexel = 1e-7;
    constexpr double kOfCutTexel = 2e-5;
    constexpr double kOfHorizon = 5e-5;
    each = kOfTexel * texels + kOfCutTexel * source_.columns() + kOfHorizon / mip.lobe->scale();
  }
  return 6.0 * mip.size * mip.size * each;
}

/// Returns whether the integral itself, texel by texel, keeps the bound within about a second.
bool LobeChain::may_integrate(const ChainTarget& target, const MipPlan& mip) const {
  return plan_.may_integrate && kReferenceError <= target.bounds.rms && seconds_to_integrate(mip) <= 1.0;
}

IrradianceMap LobeChain::irradiance_times(double factor) {
  static constexpr auto most = static_cast<double>(std::numeric_limits<float>::max());
  IrradianceMap map{std::move(irradiance_), irradiance_record_};
  for (float& value : map.cubemap.pixels()) {
    value = static_cast<float>(std::clamp(factor * static_cast<double>(value), -most, most));
  }
  map.record.mean *= factor;
  return map;
}

void LobeChain::copy_mip(std::size_t level, const Control& control) {
  const Stopwatch watch;
  fill_level(source_, result_.cubemap, static_cast<int>(level), control);
  record(level).error_estimate = 0.0;
  end_mip(target(level), plan_.mips[level], watch, control);
}

void LobeChain::integrate_mip(const ChainTarget& target, const MipPlan& mip, const Control& control) {
  const Stopwatch watch;
  const auto grid = image::TexelGrid::cubemap(mip.size);
  std::vector<glm::dvec3> directions;
  for (std::int64_t texel = 0; texel < grid.texels(); ++texel) directions.push_back(grid.direction(texel));
  const std::vector<glm::dvec3> values = integrate_lobe(source_, *mip.lobe, directions, control);
  float* const rgb = target.chain.face(target.level, 0);
  for (std::size_t k = 0; k < values.size(); ++k) {
    for (int c = 0; c < 3; ++c) rgb[3 * k + static_cast<std::size_t>(c)] = static_cast<float>(values[k][c]);
  }
  target.record.error_estimate = kReferenceError;
  end_mip(target, mip, watch, control);
  target.record.method = MipMethod::reference;
}

}  // namespace welkin::reflections
