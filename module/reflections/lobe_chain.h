// One call of the prefilter: the mips of a plan, each a source blurred by a lobe.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "image/geometry.h"
#include "image/pixels.h"
#include "jobs/stopwatch.h"
#include "jobs/task_graph.h"
#include "projection/sanitized_pixels.h"
#include "reflections/bright_lights.h"
#include "reflections/bright_texels.h"
#include "reflections/cube_rings.h"
#include "reflections/image_measures.h"
#include "reflections/near_sums.h"
#include "reflections/prefilter.h"
#include "reflections/prefilter_estimate.h"
#include "reflections/prefilter_plan.h"
#include "transform/spectrum.h"

namespace welkin::reflections {

using Faces = std::array<float*, 6>;

/// Working memory at its largest.
class MemoryPeak {
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

/// A level of a chain that is being made.
struct ChainTarget {
  Cubemap& chain;
  int level;
  MipRecord& record;
  std::string name;    ///< in passes
  ErrorBounds bounds;  ///< requested

  [[nodiscard]] Faces faces() const { return image::faces_of(chain, level); }
  /// Returns the root mean square of its texels, by samples so dense that none of the lobe's light lies between them.
  [[nodiscard]] double rms(const Lobe& lobe) const {
    constexpr double kSamplesOfWidth = 12.0;
    const double samples = std::clamp(kSamplesOfWidth / lobe.width_alpha(), 12.0, 128.0);
    return rms_of_level(chain, level, static_cast<int>(samples));
  }
};

/// One call's work: the mips of a plan, each a source blurred by a lobe.
class LobeChain {
 public:
  LobeChain(const projection::SanitizedSource& source, const PrefilterPlan& plan, Cubemap into, memory_resource* memory)
      : source_(source), plan_(plan), spectral_(step_of(0)) {
    const auto levels = static_cast<int>(plan_.mips.size());
    if (levels > 0) result_.cubemap = image::shaped(std::move(into), plan_.mips.front().size, levels, memory);
    if (plan_.irradiance) irradiance_ = Cubemap(plan_.irradiance->size, 1);
    result_.mips.resize(plan_.mips.size());
  }

  /// `scale`: what the source was multiplied by, and so are the mips that this returns; the irradiance is not.
  PrefilteredSpecular run(const Control& control, float scale, IrradianceMap* irradiance);

 private:
  [[nodiscard]] MipRecord& record(std::size_t level) { return result_.mips[level]; }
  [[nodiscard]] ChainTarget target(std::size_t level) {
    return {result_.cubemap, static_cast<int>(level), record(level),
            "mip " + std::to_string(level + static_cast<std::size_t>(plan_.first_mip)), plan_.bounds};
  }
  [[nodiscard]] ChainTarget target_of_irradiance() {
    return {irradiance_, 0, irradiance_record_, "irradiance", plan_.irradiance_bounds};
  }
  [[nodiscard]] PrefilterPlan step_of(int step) const { return plan_.at_step(step, ImageShape::of(source_)); }
  [[nodiscard]] bool last_step() const { return spectral_.tightenings == kMaxTightenings; }

  [[nodiscard]] SpectralSource spectral_source() const {
    const int texels = source_.cubemap() ? 2 * source_.columns() : rows_;  // along a meridian
    const int face = spectral_.face_for_cubemap(source_.columns());
    const bool halved = source_.cubemap() && face < source_.columns();
    return {energies_,
            source_.cubemap() ? source_.columns() : 0,
            rows_,
            texels > 2 * spectral_.bands,
            halved ? 2.0 / face : 0.0,
            contrast_,
            steps_,
            source_.has_negatives(),
            beyond_};
  }

  void note(const std::string& name, const std::string& reason, double milliseconds) {
    const std::scoped_lock lock(mutex_);
    passes_.push_back({name, PassAction::run, reason, milliseconds});
  }

  /// A mip that a step of `spectral_` makes by harmonics; level none: the irradiance.
  struct SpectralMip {
    std::optional<std::size_t> level;
    bool made = false;
  };
  /// A narrow mip until its near part is added.
  struct NearFarMip {
    ChainTarget to;
    MipPlan mip;
    std::shared_ptr<const NearTable> table;
  };
  [[nodiscard]] std::vector<SpectralMip> spectral_levels() const;
  void add_spectral_passes(std::vector<SpectralMip> mips, jobs::TaskGraph& graph);
  void add_near_far_passes(std::size_t analysed, jobs::TaskGraph& graph);
  void tighten(const Control& control);
  void find_lights(const Control& control);
  void analyse(const Control& control);
  void analyse_rings(const Control& control);
  [[nodiscard]] bool settle_bands(const ChainTarget& target, MipPlan& mip, int most) const;
  void blur(const ChainTarget& target, const MipPlan& mip, const Control& control);
  void add_near_sums(const std::string& name, const SourceRows& faces, int columns, const std::vector<NearMip>& mips,
                     const Control& control);
  [[nodiscard]] bool shows_dark(const ChainTarget& target, const MipPlan& mip, const Control& control) const;
  [[nodiscard]] bool spectral_mip(const ChainTarget& target, MipPlan mip, const Control& control);
  [[nodiscard]] bool end_spectral_mip(const ChainTarget& target, const MipPlan& mip, const jobs::Stopwatch& watch,
                                      const Control& control);
  [[nodiscard]] IrradianceMap irradiance_times(double factor);
  void keep_or_integrate(const ChainTarget& target, const MipPlan& mip, const jobs::Stopwatch& watch,
                         const Control& control);
  [[nodiscard]] double seconds_to_integrate(const MipPlan& mip) const;
  [[nodiscard]] bool may_integrate(const ChainTarget& target, const MipPlan& mip) const;
  void copy_mip(std::size_t level, const Control& control);
  void integrate_mip(const ChainTarget& target, const MipPlan& mip, const Control& control);
  void note_darkness(const ChainTarget& target, double field, const Control& control);
  static void end_mip(const ChainTarget& target, const MipPlan& mip, const jobs::Stopwatch& watch,
                      const Control& control);

  const projection::SanitizedSource& source_;
  const PrefilterPlan& plan_;
  PrefilterPlan spectral_;  ///< by which spectral mips are made, see `at_step`
  PrefilteredSpecular result_;
  Cubemap irradiance_;  ///< over pi
  MipRecord irradiance_record_;
  std::vector<BrightTexel> texels_;  ///< the bright ones, which are extracted
  BrightLights bright_;
  std::vector<SpectralMip> spectral_mips_;  ///< of this step
  std::vector<NearFarMip> near_far_mips_;
  transforms::Spectrum spectrum_;
  int rows_ = 0;                       ///< rings of which the spectrum is
  std::vector<double> energies_;       ///< of the harmonics, degree by degree
  std::vector<float> image_energies_;  ///< with the bright texels; empty: unknown
  double contrast_ = 0.0;              ///< see `SpectralSource`
  double steps_ = 0.0;                 ///< see `SpectralSource`
  EnergyBeyond beyond_;                ///< see `SpectralSource`; of GGX lobes' sources
  SourceRows faces_;                   ///< of a cubemap, without the extracted light, as fine as near sums look at
  std::mutex mutex_;
  std::vector<PassRecord> passes_;
  MemoryPeak memory_;
};

}  // namespace welkin::reflections
