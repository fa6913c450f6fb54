#include "reflections/prefilter.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstddef>
#include <cstring>
#include <limits>
#include <memory>
#include <mutex>
#include <numbers>
#include <span>
#include <string>
#include <utility>

#include "image/area_resampling.h"
#include "image/geometry.h"
#include "image/pixels.h"
#include "image/sphere_grid.h"
#include "jobs/task_graph.h"
#include "jobs/tiles.h"
#include "math/elementary.h"
#include "platform/float_environment.h"
#include "platform/memory.h"
#include "platform/text.h"
#include "projection/projection_kernels.h"
#include "projection/sanitized_pixels.h"
#include "reflections/band_choice.h"
#include "reflections/bright_lights.h"
#include "reflections/bright_texels.h"
#include "reflections/cube_rings.h"
#include "reflections/direct.h"
#include "reflections/lobe.h"
#include "reflections/narrow.h"
#include "reflections/near_sums.h"
#include "reflections/prefilter_estimate.h"
#include "reflections/radiance_scale.h"
#include "transform/spectrum.h"
#include "welkin/resampling.h"

namespace welkin::reflections {
void fill_level(const projection::SanitizedSource& source, Cubemap& chain, int level, const Control& control) {
  const int size = chain.level_size(level);
  const CubemapView& cube = source.cube();
  if (!source.cubemap()) {
    image::fill_cubemap(source.lat_long(), chain, level, ResampleFilter::area, control);
  } else if (cube.size == size) {
    const std::size_t row_values = 3 * static_cast<std::size_t>(size);
    float* to = chain.face(level, 0);
    for (int row = 0; row < source.rows(); ++row, to += row_values) {
      jobs::throw_if_cancelled(control);
      std::memcpy(to, source.row(row), row_values * sizeof(float));
    }
    if (control.progress) control.progress(1.0);
  } else {
    const Cubemap image = to_cubemap(cube, size, glm::dmat3(1.0), ResampleFilter::area, control);
    std::copy(image.pixels().begin(), image.pixels().end(), chain.face(level, 0));
  }
}

namespace {

constexpr double kPi = std::numbers::pi;
constexpr double kReferenceError = 2e-5;  ///< see `KernelFunction::far`
constexpr double kLeftOut = 0.1;          ///< of lights, over the darkest texel and the bound
constexpr int kFewTexels = 48;            ///< along an edge: wider ones' weights in near sums are to be estimated

using Faces = std::array<float*, 6>;

/// Milliseconds since it was made.
class Stopwatch {
 public:
  [[nodiscard]] double milliseconds() const {
    return std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start_).count();
  }

 private:
  std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
};

/// Working memory at its largest.
class Memory {
 public:
  void take(std::size_t bytes) {
    const std::scoped_lock lock(mutex_);
    now_ += bytes;
    peak_ = std::max(peak_, now_);
  }
  void give_back(std::size_t bytes) {
    const std::scoped_lock lock(mutex_);
    now_ -= bytes;
  }
  [[nodiscard]] std::uint64_t peak() const { return peak_; }

 private:
  std::mutex mutex_;
  std::uint64_t now_ = 0;
  std::uint64_t peak_ = 0;
};

void make_not_negative(int size, const Faces& faces) {
  const std::ptrdiff_t count = std::ptrdiff_t{3} * size * size;
  for (float* const values : faces)
    std::transform(values, values + count, values, [](float value) { return std::max(value, 0.0F); });
}

/// A level of a chain that is being made.
struct Target {
  Cubemap& chain;
  int level;
  MipRecord& record;
  std::string name;    ///< in passes
  ErrorBounds bounds;  ///< asked for

  [[nodiscard]] Faces faces() const { return image::faces_of(chain, level); }
  /// Returns the root mean square of its texels, of so many that none of the lobe's light lies between them.
  [[nodiscard]] double rms(const Lobe& lobe) const {
    constexpr double kSamplesOfWidth = 12.0;
    const double samples = std::clamp(kSamplesOfWidth / lobe.width_alpha(), 12.0, 128.0);
    return rms_of_level(chain, level, static_cast<int>(samples));
  }
};

/// Returns the smallest channel of a level's texels.
double least_of(const Cubemap& chain, int level, const Control& control) {
  constexpr std::ptrdiff_t kTileValues = 65536;
  const int size = chain.level_size(level);
  const std::ptrdiff_t values = std::ptrdiff_t{18} * size * size;
  const float* const first = chain.face(level, 0);
  std::vector<float> least(static_cast<std::size_t>((values + kTileValues - 1) / kTileValues));
  const auto placement = least.size() < 4 ? jobs::Placement::calling_thread : jobs::Placement::arena;
  jobs::run_tiles(least.size(), placement, jobs::worker_count(placement), {control.stop, {}},
                  [&](std::size_t tile, std::size_t) {
                    const std::ptrdiff_t begin = static_cast<std::ptrdiff_t>(tile) * kTileValues;
                    const auto count = static_cast<int>(std::min(values - begin, kTileValues));
                    least[tile] = projection::projection_kernels().measure_row(first + begin, count).least;
                  });
  return static_cast<double>(*std::min_element(least.begin(), least.end()));
}

/// What narrow mips share.
struct NarrowSource {
  NearSplit split;      ///< of the one whose far part has the most bands
  BrightLights bright;  ///< taken out of the spectrum
  int bright_texels = 0;
  double contrast = 0.0;  ///< see `contrast_of`
  transforms::Spectrum spectrum;
  std::vector<double> energies;  ///< by degrees, see `energies_of`
};

/// One call's work: the mips of a plan, each a source blurred by a lobe.
class LobeChain {
 public:
  LobeChain(const projection::SanitizedSource& source, const PrefilterPlan& plan, Cubemap room, memory_resource* memory)
      : source_(source), plan_(plan), spectral_(step_of(0)) {
    const auto levels = static_cast<int>(plan_.mips.size());
    if (levels > 0) result_.cubemap = image::shaped(std::move(room), plan_.mips.front().size, levels, memory);
    if (plan_.irradiance) irradiance_ = Cubemap(plan_.irradiance->size, 1);
    result_.mips.resize(plan_.mips.size());
  }

  /// `scale`: what the source was multiplied by.
  PrefilteredSpecular run(const Control& control, float scale, IrradianceMap* irradiance) {
    jobs::TaskGraph graph;
    if (plan_.bands > 0) graph.add(2.0, [this](const Control& part) { run_spectral(part); });
    if (plan_.uses(MipMethod::narrow)) graph.add(50.0, [this](const Control& part) { run_narrow(part); });
    for (std::size_t level = 0; level < plan_.mips.size(); ++level) {
      const MipMethod method = plan_.mips[level].method;
      if (method == MipMethod::copy) graph.add(1.0, [this, level](const Control& part) { copy_mip(level, part); });
      if (method == MipMethod::reference)
        graph.add(1000.0,
                  [this, level](const Control& part) { integrate_mip(target(level), plan_.mips[level], part); });
    }
    graph.run(control);
    for (std::size_t level = 0; level < plan_.mips.size() && !picture_energies_.empty(); ++level) {
      const std::optional<MipPair>& mips = plan_.mips[level].to_next;
      if (mips) record(level).error_between = error_between(*mips, plan_.lookups, picture_energies_);
    }
    if (plan_.energies && !picture_energies_.empty()) *plan_.energies = picture_energies_;
    result_.pixels.passes = std::move(passes_);
    result_.peak_bytes = memory_.peak();
    if (plan_.irradiance) *irradiance = irradiance_times(kPi / static_cast<double>(scale));
    if (scale != 1.0F) undo_scale(result_, scale);
    return std::move(result_);
  }

 private:
  [[nodiscard]] MipRecord& record(std::size_t level) { return result_.mips[level]; }
  [[nodiscard]] Target target(std::size_t level) {
    return {result_.cubemap, static_cast<int>(level), record(level),
            "mip " + std::to_string(level + static_cast<std::size_t>(plan_.first_mip)), plan_.bounds};
  }
  [[nodiscard]] Target target_of_irradiance() {
    return {irradiance_, 0, irradiance_record_, "irradiance", plan_.irradiance_bounds};
  }
  [[nodiscard]] PrefilterPlan step_of(int step) const {
    return plan_.at_step(step, source_.cubemap() ? source_.columns() : 0);
  }
  [[nodiscard]] bool last_step() const { return spectral_.tightenings == kMostTightenings; }

  [[nodiscard]] SpectralSource source_on(int rows) const {
    const int texels = source_.cubemap() ? 2 * source_.columns() : rows;  // along a meridian
    const int face = spectral_.face_for_cubemap(source_.columns());
    const bool halved = source_.cubemap() && face < source_.columns();
    return {energies_,
            source_.cubemap() ? source_.columns() : 0,
            rows,
            texels > 2 * spectral_.bands,
            halved ? 2.0 / face : 0.0,
            contrast_,
            beyond_};
  }

  void note(const std::string& name, const std::string& reason, double milliseconds) {
    const std::scoped_lock lock(mutex_);
    passes_.push_back({name, PassAction::run, reason, milliseconds});
  }

  void run_spectral(const Control& control);
  [[nodiscard]] int analyse_rings(const std::vector<BrightTexel>& texels, transforms::Spectrum& spectrum,
                                  const Control& control);
  using Levels = std::vector<std::optional<std::size_t>>;  ///< of spectral mips; none: the irradiance
  [[nodiscard]] Levels run_rings(const std::vector<BrightTexel>& texels, const Levels& levels, const Control& control);
  [[nodiscard]] static bool settle_bands(const Target& target, MipPlan& mip, const SpectralSource& source, int most,
                                         const std::vector<BrightTexel>& texels);
  void blur(const Target& target, std::span<const double> zonal, const transforms::GridSize& grid_size,
            bool not_negative, const transforms::Spectrum& spectrum, const Control& control);
  void blur(const Target& target, const MipPlan& mip, const transforms::Spectrum& spectrum, const Control& control) {
    const bool negative = source_.has_negatives() || mip.lobe->negative() || mip.near.face > 0;
    blur(target, mip.bands.zonal, mip.grid(), !negative, spectrum, control);
  }
  void add_near_sums(const Target& target, const MipPlan& mip, const Control& control);
  [[nodiscard]] bool shows_dark(const Target& target, const MipPlan& mip, const Control& control) const;
  [[nodiscard]] bool spectral_mip(const Target& target, MipPlan mip, const std::vector<BrightTexel>& texels,
                                  const transforms::Spectrum& spectrum, int rows, const Control& control);
  [[nodiscard]] IrradianceMap irradiance_times(double factor);
  void run_narrow(const Control& control);
  [[nodiscard]] NearSplit split_of(const MipPlan& mip) const;
  void add_far_part(std::size_t level, const NarrowSource& narrow, const NearTable& table, const Control& control);
  void end_narrow_mip(std::size_t level, const NarrowSource& narrow, const NearTable& table, const Control& control);
  void keep_or_integrate(const Target& target, const MipPlan& mip, const Stopwatch& watch, const Control& control);
  [[nodiscard]] double seconds_to_integrate(const MipPlan& mip) const;
  [[nodiscard]] bool may_integrate(const Target& target, const MipPlan& mip) const;
  void copy_mip(std::size_t level, const Control& control);
  void integrate_mip(const Target& target, const MipPlan& mip, const Control& control);
  void note_darkness(const Target& target, double field, const Control& control);
  static void end_mip(const Target& target, const MipPlan& mip, const Stopwatch& watch, const Control& control);

  const projection::SanitizedSource& source_;
  const PrefilterPlan& plan_;
  PrefilterPlan spectral_;  ///< by which spectral mips are made, see `at_step`
  PrefilteredSpecular result_;
  Cubemap irradiance_;  ///< over pi
  MipRecord irradiance_record_;
  BrightLights bright_;
  std::size_t extracted_ = 0;
  std::vector<double> energies_;         ///< of the harmonics, degree by degree
  std::vector<float> picture_energies_;  ///< with the bright texels; empty: unknown
  double contrast_ = 0.0;                ///< see `SpectralSource`
  EnergyBeyond beyond_;                  ///< likewise, of GGX lobes' sources
  SourceRows faces_;                     ///< of a cubemap, without the extracted light, as fine as near sums look at
  std::mutex mutex_;
  std::vector<PassRecord> passes_;
  Memory memory_;
};

/// Adds a pass to the diagnostics if a channel is too dark beside `field`, the root mean square of what was summed in
/// floats, for the bound on its error.
void LobeChain::note_darkness(const Target& target, double field, const Control& control) {
  constexpr double kFloatNoise = 1e-6;  // of the field, at any texel: five times the rms of harmonics in floats
  const double share = kFloatNoise / target.bounds.maximum;
  if (least_of(target.chain, target.level, control) >= share * field) return;
  note(target.name + ": dark channels",
       "below " + platform::number_text(share) + " of the mip, where floats err by more than a texel may", 0.0);
}

void LobeChain::end_mip(const Target& target, const MipPlan& mip, const Stopwatch& watch, const Control& control) {
  target.record.size = mip.size;
  target.record.roughness = mip.roughness;
  target.record.lobe_roughness = mip.lobe_roughness;
  target.record.method = mip.method;
  const CubemapView whole = target.chain.view(target.level);
  target.record.mean = mean_radiance(project(whole, {.bands = 1}, {control.stop, {}}).radiance);
  target.record.milliseconds = watch.milliseconds();
}

void LobeChain::run_spectral(const Control& control) {
  const Stopwatch watch;
  const std::size_t most = plan_.lights.of == LightsOf::ggx ? kMostBright : kMostBrightFar;
  const std::vector<BrightTexel> texels = find_bright_texels(source_, plan_.light_alpha, most, {control.stop, {}});
  bright_ = BrightLights(texels, PictureShape::of(source_), plan_.lights, plan_.reach);
  extracted_ = texels.size();
  memory_.take(bright_.bytes());
  note("bright texels", std::to_string(extracted_) + " extracted", watch.milliseconds());
  Levels left;
  for (std::size_t level = 0; level < plan_.mips.size(); ++level) {
    if (plan_.mips[level].method == MipMethod::spectral) left.emplace_back(level);
  }
  if (plan_.irradiance) left.emplace_back(std::nullopt);
  left = run_rings(texels, left, control);
  while (!left.empty()) {
    spectral_ = step_of(spectral_.tightenings + 1);
    note("energies", "more than most images have: " + std::to_string(spectral_.bands) + " bands", 0.0);
    left = run_rings(texels, left, {control.stop, {}});
  }
}

/// Returns the number of rings.
int LobeChain::analyse_rings(const std::vector<BrightTexel>& texels, transforms::Spectrum& spectrum,
                             const Control& control) {
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
    faces_ = halved_faces(rows_without(texels, source_), finest, {control.stop, {}});
    memory_.take(faces_.owned.bytes());
    if (!spectral_.near_mips.empty() && faces_.face() < kFewTexels)
      contrast_ = contrast_of_faces(faces_.rows, faces_.face());
  }
  // Tighter bounds take so many bands that the tail says enough, and sums would refuse noise that is within them.
  const bool few = spectral_.near_mips.empty() && spectral_.bands < bands_for_dark(plan_.bounds);
  const bool looked = spectral_.lights.of == LightsOf::ggx && (few || plan_.bounds.rms > 1e-3);
  std::optional<PictureSums> sums;
  Rings rings;
  if (source_.cubemap()) {
    const SourceRows coarse = halved_faces({faces_.rows}, face, {control.stop, {}});
    if (looked) sums.emplace(coarse, wanted);
    rings = rings_of_cubemap(coarse.rows, wanted, {control.stop, {}});
  } else {
    rings = rings_of(source_, texels, wanted, {control.stop, {}});
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
  spectrum = transforms::analyse(rings.view, spectral_.bands, control, transforms::SourceRows::fewer);
  memory_.take(spectrum.bytes());
  note("analyse", std::to_string(spectral_.bands) + " bands", analysis.milliseconds());
  memory_.give_back(rings.bytes());
  energies_ = energies_of(spectrum);
  beyond_ = sums ? sums->beyond(energies_) : EnergyBeyond{};
  return rings.view.height;
}

/// Makes those mips for which this step's bands and near sums do. Returns the others, none after the last step. By
/// itself alone each mip goes on to a next step, so that it has the same bits whatever other mips there are.
LobeChain::Levels LobeChain::run_rings(const std::vector<BrightTexel>& texels, const Levels& levels,
                                       const Control& control) {
  transforms::Spectrum spectrum;
  int rows = 0;
  for (Control part = jobs::part_of(control, 0.0, 0.4);; part.progress = {}) {
    rows = analyse_rings(texels, spectrum, part);
    if (plan_.lights.of == LightsOf::ggx) break;
    const int wanted = choose_bands_by_energy(spectral_, source_on(rows));
    if (std::exchange(spectral_.bands, wanted) == wanted) break;
    memory_.give_back(spectrum.bytes());
    note("energies", "more than most images have: " + std::to_string(spectral_.bands) + " bands", 0.0);
  }
  if (plan_.lights.of == LightsOf::ggx && !plan_.mips.empty() && spectral_.tightenings == 0)
    picture_energies_ = whole_energies(energies_, texels, PictureShape::of(source_), {control.stop, {}});

  jobs::TaskGraph graph;
  std::vector<char> made(levels.size());
  for (std::size_t k = 0; k < levels.size(); ++k) {
    const MipPlan& mip = levels[k] ? spectral_.mips[*levels[k]] : *spectral_.irradiance;
    const Target to = levels[k] ? target(*levels[k]) : target_of_irradiance();
    graph.add(static_cast<double>(mip.size) * mip.size + mip.bands.bands() * mip.bands.bands(),
              [this, to, k, &mip, &made, &texels, &spectrum, rows](const Control& part) {
                made[k] = spectral_mip(to, mip, texels, spectrum, rows, part) ? 1 : 0;
              });
  }
  graph.run(jobs::part_of(control, 0.4, 1.0));
  memory_.give_back(spectrum.bytes());
  Levels left;
  for (std::size_t k = 0; k < levels.size(); ++k) {
    if (made[k] == 0) left.push_back(levels[k]);
  }
  return left;
}

/// Adds the near part of its lobe to a mip's faces.
void LobeChain::add_near_sums(const Target& target, const MipPlan& mip, const Control& control) {
  const Stopwatch watch;
  const SourceRows faces = halved_faces({faces_.rows}, std::min(mip.near.face, faces_.face()), {control.stop, {}});
  const SourceRows cut = cut_rows(faces.rows, faces.face(), mip.near);
  const std::size_t bytes = faces.owned.bytes() + cut.owned.bytes() + near_sums_bytes(mip.near);
  memory_.take(bytes);
  reflections::add_near_sums(cut.rows, {{NearTable::get(mip.near), target.faces()}}, control);
  if (!source_.has_negatives()) make_not_negative(mip.size, target.faces());
  memory_.give_back(bytes);
  note(target.name + ": near sums", std::to_string(mip.near.face) + " texels along an edge", watch.milliseconds());
}

/// Writes a mip's faces without the extracted light.
void LobeChain::blur(const Target& target, std::span<const double> zonal, const transforms::GridSize& grid_size,
                     bool not_negative, const transforms::Spectrum& spectrum, const Control& control) {
  const Stopwatch watch;
  image::SphereGrid grid(grid_size.rings, grid_size.columns, image::GridContent::spline_coefficients);
  memory_.take(grid.bytes());
  transforms::synthesise(spectrum, zonal, grid, jobs::part_of(control, 0.0, 0.6));
  note(target.name + ": synthesise", std::to_string(grid.rings()) + " rings", watch.milliseconds());
  const Stopwatch sampling;
  const int size = target.chain.level_size(target.level);
  image::sample_faces(grid, size, target.faces(), {.not_negative = not_negative}, jobs::part_of(control, 0.6, 1.0));
  memory_.give_back(grid.bytes());
  note(target.name + ": faces", std::to_string(size) + " texels along an edge", sampling.milliseconds());
}

/// Returns whether the darkest texel of a mip without the extracted light keeps the bound on the largest error.
bool LobeChain::shows_dark(const Target& target, const MipPlan& mip, const Control& control) const {
  constexpr double kOfTruncated = 8.0;  // over the root mean square: the largest error
  const double least = least_of(target.chain, target.level, control);
  return kOfTruncated * truncated_afar(mip, energies_) <= target.bounds.maximum * least;
}

/// Chooses the bands of a GGX lobe that harmonics alone make: a quarter more as long as the picture's energies take
/// more. Returns whether `most` are enough.
bool LobeChain::settle_bands(const Target& target, MipPlan& mip, const SpectralSource& source, int most,
                             const std::vector<BrightTexel>& texels) {
  for (int bands = first_bands_within(mip.alpha, target.bounds);;
       bands += (bands / 4 + kBandStep - 1) / kBandStep * kBandStep) {
    mip.bands = tapered_lobe(mip.alpha, std::min(bands, most));
    if (keeps_rms_error(mip, target.bounds.rms, source, texels)) return true;
    if (bands >= most) return false;
  }
}

/// Returns false where a next step is to make the mip.
bool LobeChain::spectral_mip(const Target& target, MipPlan mip, const std::vector<BrightTexel>& texels,
                             const transforms::Spectrum& spectrum, int rows, const Control& control) {
  const Stopwatch watch;
  const bool near = mip.near.face > 0;
  const bool ggx = mip.alpha > 0.0;
  const bool first = spectral_.tightenings == 0;
  if (near) mip = with_far_part(std::move(mip));
  const int most = first ? spectrum.bands() : std::min(spectrum.bands(), mip.bands.bands());
  const bool does = !ggx || (near ? keeps_rms_error(mip, target.bounds.rms, source_on(rows), texels)
                                  : settle_bands(target, mip, source_on(rows), most, texels));
  if (!does && !last_step()) return false;
  int of_dark = 0;
  if (ggx && first) of_dark = bands_for_dark(target.bounds);
  if (ggx && !first && !near)
    of_dark = std::min(most, bands_for_dark(target.bounds.tightened(spectral_.tightenings - 1)));
  blur(target, mip, spectrum, jobs::part_of(control, 0.0, 0.7));
  if (near) add_near_sums(target, mip, {control.stop, {}});
  if (mip.bands.bands() < of_dark && !shows_dark(target, mip, control)) {
    if (near || of_dark > spectrum.bands()) return false;
    mip.bands = tapered_lobe(mip.alpha, of_dark);
    blur(target, mip, spectrum, {control.stop, {}});
  }
  const Stopwatch splatting;
  const double least =
      bright_.empty() ? 0.0 : kLeftOut * target.bounds.rms * least_of(target.chain, target.level, control);
  const double left_out =
      bright_.add({*mip.lobe, 0.0, least}, mip.size, target.faces(), jobs::part_of(control, 0.7, 1.0));
  note_darkness(target, blurred_rms(energies_, mip.bands.zonal), control);
  note(target.name + ": lobes", std::to_string(extracted_) + " bright texels", splatting.milliseconds());
  target.record.bands = mip.bands.bands();
  target.record.bright_texels = static_cast<int>(extracted_);
  const double rms = target.rms(*mip.lobe);
  // Few texels may lie where the error of a lobe with kinks is largest.
  const double by_chance = mip.alpha > 0.0 ? 1.0 : std::min(2.0, 1.0 + 4.0 / mip.size);
  target.record.error_estimate =
      by_chance * spectral_rms_error(mip, source_on(rows), bright_.error(*mip.lobe, mip.size, rms) + left_out, rms);
  // more bands may do
  if (near && !last_step() && *target.record.error_estimate > target.bounds.rms) return false;
  keep_or_integrate(target, mip, watch, control);
  return true;
}

/// Ends a mip that keeps the bound by its estimate; integrates it otherwise, or throws.
void LobeChain::keep_or_integrate(const Target& target, const MipPlan& mip, const Stopwatch& watch,
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
bool LobeChain::may_integrate(const Target& target, const MipPlan& mip) const {
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

NearSplit LobeChain::split_of(const MipPlan& mip) const {
  return narrow_split(source_.columns(), source_.cubemap() ? 0 : source_.rows(), mip.size, mip.alpha);
}

void LobeChain::run_narrow(const Control& control) {
  const Stopwatch watch;
  NarrowSource narrow;
  narrow.split = narrow_split(source_.columns(), source_.cubemap() ? 0 : source_.rows(), plan_.narrow_size, 0.0);
  const NearSplit& split = narrow.split;
  const double sharpest = sharpest_lobe(split);
  const std::vector<BrightTexel> texels = find_bright_texels(source_, sharpest, kMostBrightFar, {control.stop, {}});
  narrow.bright =
      BrightLights(texels, PictureShape::of(source_), {LightsOf::ggx, kFarLights * sharpest}, narrow_reach(plan_));
  narrow.bright_texels = static_cast<int>(texels.size());
  narrow.contrast = contrast_of(source_);
  Rings rings = rings_of(source_, texels, source_.cubemap() ? far_rows_for_cubemap(split) : 0, {control.stop, {}});
  memory_.take(rings.bytes() + narrow.bright.bytes());
  narrow.spectrum = transforms::analyse(rings.view, split.bands, jobs::part_of(control, 0.0, 0.2));
  narrow.energies = energies_of(narrow.spectrum);
  memory_.take(narrow.spectrum.bytes());
  memory_.give_back(rings.bytes());
  rings = {};
  note("narrow: analyse", std::to_string(split.bands) + " bands of the far part", watch.milliseconds());

  jobs::TaskGraph graph;
  std::vector<std::size_t> levels;
  std::vector<NearMip> mips;
  for (std::size_t level = 0; level < plan_.mips.size(); ++level) {
    if (plan_.mips[level].method != MipMethod::narrow) continue;
    levels.push_back(level);
    mips.push_back({nullptr, target(level).faces()});
  }
  for (std::size_t k = 0; k < levels.size(); ++k) {
    const MipPlan& mip = plan_.mips[levels[k]];
    graph.add(static_cast<double>(mip.size) * mip.size, [this, k, &mip, &levels, &mips, &narrow](const Control& part) {
      mips[k].table = NearTable::get(split_of(mip));
      add_far_part(levels[k], narrow, *mips[k].table, part);
    });
  }
  graph.run(jobs::part_of(control, 0.2, 0.5));

  const Stopwatch near;
  const SourceRows cut = cut_rows(rows_without({}, source_).rows, source_.columns(), split);
  std::size_t bytes = cut.owned.bytes();
  for (const NearMip& mip : mips) bytes = std::max(bytes, cut.owned.bytes() + near_sums_bytes(mip.table->split()));
  memory_.take(bytes);
  reflections::add_near_sums(cut.rows, mips, jobs::part_of(control, 0.5, 0.95));
  note("narrow: near sums", std::to_string(split.face) + " columns", near.milliseconds());
  memory_.give_back(bytes);
  for (std::size_t k = 0; k < levels.size(); ++k) end_narrow_mip(levels[k], narrow, *mips[k].table, {control.stop, {}});
  memory_.give_back(narrow.spectrum.bytes() + narrow.bright.bytes());
}

void LobeChain::add_far_part(std::size_t level, const NarrowSource& narrow, const NearTable& table,
                             const Control& control) {
  const MipPlan& mip = plan_.mips[level];
  const NearSplit& split = table.split();
  const Target target = this->target(level);
  const std::vector<double> zonal = tapered(table.far(), split.bands);
  blur(target, zonal, far_grid(split), false, narrow.spectrum, jobs::part_of(control, 0.0, 0.7));
  narrow.bright.add({*mip.lobe, split.end()}, mip.size, target.faces(), jobs::part_of(control, 0.7, 1.0));
}

void LobeChain::end_narrow_mip(std::size_t level, const NarrowSource& narrow, const NearTable& table,
                               const Control& control) {
  const Stopwatch watch;
  const MipPlan& mip = plan_.mips[level];
  const Target target = this->target(level);
  const std::vector<double>& far = table.far();
  const std::vector<double> zonal = tapered(far, table.split().bands);
  if (!source_.has_negatives()) make_not_negative(mip.size, target.faces());
  const double far_rms = blurred_rms(narrow.energies, zonal);
  note_darkness(target, far_rms, control);
  record(level).bands = table.split().bands;
  record(level).bright_texels = narrow.bright_texels;
  const int rings = source_.cubemap() ? far_rows_for_cubemap(narrow.split) : 0;
  record(level).error_estimate = narrow_error(source_,
                                              {.size = mip.size,
                                               .alpha = mip.alpha,
                                               .rms = rms_of_level(target.chain, target.level, mip.size),
                                               .far_rms = far_rms,
                                               .lost = lost_of_far(far, zonal, narrow.energies, rings),
                                               .lights = narrow.bright.empty() ? 0.0 : far.front()},
                                              narrow.contrast);
  keep_or_integrate(target, mip, watch, control);
}

void LobeChain::copy_mip(std::size_t level, const Control& control) {
  const Stopwatch watch;
  fill_level(source_, result_.cubemap, static_cast<int>(level), control);
  record(level).error_estimate = 0.0;
  end_mip(target(level), plan_.mips[level], watch, control);
}

void LobeChain::integrate_mip(const Target& target, const MipPlan& mip, const Control& control) {
  const Stopwatch watch;
  const int size = mip.size;
  std::vector<glm::dvec3> directions;
  for (int face = 0; face < 6; ++face) {
    for (int row = 0; row < size; ++row) {
      for (int column = 0; column < size; ++column)
        directions.push_back(image::face_direction(size, face, column + 0.5, row + 0.5));
    }
  }
  const std::vector<glm::dvec3> values = integrate_lobe(source_, *mip.lobe, directions, control);
  float* const rgb = target.chain.face(target.level, 0);
  for (std::size_t k = 0; k < values.size(); ++k) {
    for (int c = 0; c < 3; ++c) rgb[3 * k + static_cast<std::size_t>(c)] = static_cast<float>(values[k][c]);
  }
  target.record.error_estimate = kReferenceError;
  end_mip(target, mip, watch, control);
  target.record.method = MipMethod::reference;
}

}  // namespace

void describe_pixels(const ProjectionDiagnostics& sanitized, const glm::dvec3& clamped_radiance,
                     PrefilteredSpecular& specular) {
  std::vector<PassRecord> passes = std::move(specular.pixels.passes);
  specular.pixels = sanitized;
  specular.pixels.passes = std::move(passes);
  specular.pixels.total_radiance = 4.0 * std::numbers::pi * specular.mips.front().mean;
  specular.pixels.total_radiance_before_clamp = specular.pixels.total_radiance + clamped_radiance;
}

void make_tables(const PrefilterPlan& plan, int face_size, const Control& control) {
  if (plan.bands == 0) return;
  const PrefilterPlan own = plan.at_step(0, face_size);
  for (const MipPlan& mip : own.near_mips) static_cast<void>(NearTable::get(mip.near));
  RingTable::get({own.face_for_cubemap(face_size), own.rows_for_cubemap()}, {control.stop});
}

PrefilteredSpecular prefilter(const projection::SanitizedSource& source, const PrefilterPlan& plan, Cubemap room,
                              const Control& control, IrradianceMap* irradiance) {
  const float scale = safe_scale(source);
  if (scale == 1.0F) return LobeChain(source, plan, std::move(room), control.memory).run(control, scale, irradiance);
  const ScaledSource scaled(source, scale, {control.stop, {}});
  return LobeChain(scaled.source(), plan, std::move(room), control.memory).run(control, scale, irradiance);
}

PrefilteredSpecular prefilter(const EnvironmentView& view, const PrefilterPlan& plan, const PixelPolicy& pixels,
                              Cubemap room, const Control& control) {
  const projection::SanitizedSource source(view, pixels, jobs::part_of(control, 0.0, 0.05));
  PrefilteredSpecular result = prefilter(source, plan, std::move(room), jobs::part_of(control, 0.05, 1.0));
  result.peak_bytes += source.bytes();
  describe_pixels(source.diagnostics(), source.clamped_radiance(), result);
  return result;
}

}  // namespace welkin::reflections

namespace welkin {

const char* name(PrefilterMethod method) noexcept {
  switch (method) {
    case PrefilterMethod::automatic: return "automatic";
    case PrefilterMethod::spectral: return "spectral";
    case PrefilterMethod::reference: return "reference";
  }
  return "automatic";
}

const char* name(MipMethod method) noexcept {
  switch (method) {
    case MipMethod::copy: return "copy";
    case MipMethod::spectral: return "spectral";
    case MipMethod::reference: return "reference";
    case MipMethod::stored: return "stored";
    case MipMethod::narrow: return "narrow";
  }
  return "copy";
}

PrefilteredSpecular prefilter_specular(const EnvironmentView& source, const PrefilterOptions& options,
                                       const Control& control) {
  const platform::FloatingPointScope floating_point;
  image::check_view(source);
  return reflections::prefilter(source, reflections::plan_prefilter(options), options.pixels, {}, control);
}

}  // namespace welkin
