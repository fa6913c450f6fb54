// The passes of a bake: what each does, what it waits for, and what is said of it.
#include "welkin/bake.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <numbers>
#include <string>
#include <type_traits>
#include <utility>

#include "bake/bake_plan.h"
#include "bake/bake_source.h"
#include "bake/pass_graph.h"
#include "image/fill_cubemap.h"
#include "jobs/tiles.h"
#include "specular/brdf_integration.h"
#include "specular/clean_source.h"
#include "specular/prefilter.h"
#include "welkin/error.h"
#include "welkin/harmonic_transforms.h"
#include "welkin/irradiance_cubemap.h"
#include "welkin/resampling.h"

namespace welkin {
namespace baking {
namespace {

std::string edge(int size) { return std::to_string(size) + " x " + std::to_string(size); }

/// What a pass came to.
struct Outcome {
  std::string action = "run";
  std::string reason{};
};

template <class View>
class Baking {
 public:
  Baking(const View& source, const BakeOptions& options, const BakePlan& plan, const SphericalHarmonics* stored,
         BakeResult& result)
      : source_(source),
        shape_(shape_of(source)),
        options_(options),
        plan_(plan),
        stored_(stored != nullptr && options.bands > 0 && options.bands <= stored->bands() ? stored : nullptr),
        result_(result) {}

  void run(const Control& control) {
    prepare_results();
    add_passes();
    graph_.run(control);
    finish();
  }

 private:
  struct Step {
    std::string name;
    Outcome outcome;
    std::size_t pass = kSkipped;  ///< of the graph
  };
  static constexpr std::size_t kSkipped = static_cast<std::size_t>(-1);

  /// Makes room for the results, in what is there if it has the right size.
  void prepare_results() {
    result_.background = plan_.background_size == 0 ? CubemapChain()
                                                    : image::shaped(std::move(result_.background),
                                                                    plan_.background_size, plan_.background_levels);
    if (!options_.specular) result_.specular.reset();
    if (options_.irradiance_size == 0) result_.irradiance = {};
    result_.radiance.reset();
    result_.brdf.reset();
    result_.stored_polynomial.reset();
    result_.diagnostics = {};
    result_.peak_bytes = 0;
  }

  /// A step that runs as a pass of the graph.
  template <class Work>
  std::size_t add(std::string name, double cost, Work work, const std::vector<std::size_t>& after) {
    const std::size_t step = steps_.size();
    const std::size_t pass = graph_.add(
        cost, [this, step, work](const Control& control) { steps_[step].outcome = work(control); }, after);
    steps_.push_back({std::move(name), {}, pass});
    return pass;
  }

  void skip(std::string name, std::string reason) { steps_.push_back({std::move(name), {"skip", std::move(reason)}}); }

  void add_passes() {
    std::vector<std::size_t> cleaned;
    if (plan_.cleans) {
      cleaned.push_back(add("clean", plan_.costs.clean, [this](const Control& c) { return clean(c); }, {}));
    } else {
      skip("clean", "no pass wants pixels but the projection, which cleans on the fly");
    }
    add_specular(cleaned);
    add_background(cleaned);
    const std::size_t projected =
        add("project", plan_.costs.project, [this](const Control& c) { return project_source(c); }, {});
    add_irradiance(cleaned, projected);
    if (options_.brdf) {
      add("brdf", plan_.costs.brdf, [this](const Control& c) { return look_up_brdf(c); }, {});
    } else {
      skip("brdf", "not asked for");
    }
  }

  void add_background(const std::vector<std::size_t>& cleaned) {
    if (plan_.background_size == 0) {
      skip("background", "not asked for");
      skip("background mips", "there is no background");
      return;
    }
    const std::vector<std::size_t> after = plan_.same_level ? std::vector{specular_} : cleaned;
    const std::size_t background = add(
        "background", plan_.costs.background, [this](const Control& c) { return fill_background(c); }, after);
    if (plan_.background_levels > 1) {
      add("background mips", plan_.costs.background_mips, [this](const Control& c) { return fill_levels(c); },
          {background});
    } else {
      skip("background mips", options_.background_mips ? "level 0 is 1 texel" : "not asked for");
    }
  }

  void add_specular(const std::vector<std::size_t>& cleaned) {
    if (options_.specular) {
      specular_ = add(
          "specular", plan_.costs.specular, [this](const Control& c) { return prefilter(c); }, cleaned);
    } else {
      skip("specular", "not asked for");
    }
  }

  void add_irradiance(const std::vector<std::size_t>& cleaned, std::size_t projected) {
    if (options_.irradiance_size == 0) {
      skip("irradiance", "not asked for");
    } else if (options_.irradiance_method == IrradianceMethod::direct) {
      add(
          "irradiance", plan_.costs.irradiance, [this](const Control& c) { return convolve_irradiance(c); }, cleaned);
    } else {
      add("irradiance", plan_.costs.irradiance, [this](const Control& c) { return evaluate_irradiance(c); },
          {projected});
    }
  }

  Outcome clean(const Control& control) {
    clean_.emplace(source_, options_.pixels, control);
    if (clean_->bytes() == 0) return {"reuse", "the source's own pixels, looked through: they are clean RGB floats"};
    return {"run", "a copy as RGB floats, clamped and replaced as asked for"};
  }

  [[nodiscard]] const View& clean_view() const {
    if constexpr (std::is_same_v<View, CubemapView>) {
      return clean_->cube();
    } else {
      return clean_->lat_long();
    }
  }

  Outcome fill_background(const Control& control) {
    CubemapChain& chain = result_.background;
    const int size = chain.size();
    if (plan_.same_level) {
      copy_level(result_.specular->cubemap, chain, control);
      return {"reuse", "mip 0 of the specular cubemap is the same"};
    }
    if constexpr (std::is_same_v<View, LatLongView>) {
      image::fill_cubemap(clean_view(), chain, ResampleFilter::area, control);
    } else {
      const CubemapImage image = to_cubemap(clean_view(), size, glm::dmat3(1.0), control);
      std::copy(image.pixels.begin(), image.pixels.end(), chain.face(0, 0));
    }
    return {"run", shape_.words() + " to faces of " + edge(size) + ", by area"};
  }

  /// Level 0, a tile for some rows of all that lies one after the other in memory.
  static void copy_level(const CubemapChain& from, CubemapChain& to, const Control& control) {
    const std::size_t row = 3 * static_cast<std::size_t>(from.size());
    const std::size_t rows = 6 * static_cast<std::size_t>(from.size());
    const std::size_t tile_rows = std::max<std::size_t>(1, (std::size_t{1} << 16U) / row);
    const auto placement = jobs::placement_for(static_cast<std::int64_t>(rows * row / 3));
    jobs::run_tiles((rows + tile_rows - 1) / tile_rows, placement, jobs::worker_count(placement), control,
                    [&](std::size_t tile, std::size_t) {
                      const std::size_t first = tile * tile_rows;
                      const std::size_t count = std::min(tile_rows, rows - first);
                      std::memcpy(to.face(0, 0) + first * row, from.face(0, 0) + first * row,
                                  count * row * sizeof(float));
                    });
  }

  Outcome fill_levels(const Control& control) {
    fill_mips(result_.background, options_.mip_filter, control);
    return {"run", std::to_string(plan_.background_levels) + " levels, each from the one above, by " +
                       (options_.mip_filter == MipFilter::box ? "plain mean" : "solid angle")};
  }

  Outcome prefilter(const Control& control) {
    PrefilterOptions prefiltering = *options_.specular;
    prefiltering.pixels = {};
    CubemapChain room = result_.specular ? std::move(result_.specular->cubemap) : CubemapChain();
    result_.specular = specular::prefilter(clean_view(), prefiltering, 0, std::move(room), control).specular;
    return {"run", std::to_string(plan_.specular_mips) + " mips from " + edge(plan_.specular_size)};
  }

  Outcome project_source(const Control& control) {
    if (stored_ != nullptr) {
      projection_ = Projection{with_bands(*stored_, options_.bands), {}};
      return {"reuse", "the harmonics that came with the pixels"};
    }
    projection_ = project(source_, plan_.projecting, control);
    if (options_.bands == 0) return {"run", "1 band, for the flux: no coefficients were asked for"};
    return {"run", std::to_string(options_.bands) + " bands from the source's own texels"};
  }

  Outcome evaluate_irradiance(const Control& control) {
    const SphericalHarmonics irradiance = irradiance_from_radiance(projection_->radiance);
    result_.irradiance = irradiance_cubemap(irradiance, options_.irradiance_size, control);
    return {"run", edge(options_.irradiance_size) + " from " + std::to_string(options_.bands) + " bands"};
  }

  Outcome convolve_irradiance(const Control& control) {
    result_.irradiance = direct_irradiance_cubemap(clean_view(), options_.irradiance_size, control);
    return {"run", edge(options_.irradiance_size) + " by direct convolution in double"};
  }

  Outcome look_up_brdf(const Control& control) {
    bool made = false;
    result_.brdf = specular::shared_brdf(*options_.brdf, control, made);
    const std::string size = std::to_string(options_.brdf->width) + " x " + std::to_string(options_.brdf->height);
    if (made) return {"run", size + " by quadrature"};
    return {"reuse", size + ", made before: it depends on no scene"};
  }

  void finish() {
    ProjectionDiagnostics& diagnostics = result_.diagnostics;
    diagnostics = std::move(projection_->diagnostics);
    if (stored_ != nullptr) {
      if (clean_) diagnostics = clean_->diagnostics();
      diagnostics.texels = shape_.texels();
      diagnostics.flux = stored_->at(0, 0) * std::sqrt(4.0 * std::numbers::pi);
      diagnostics.flux_before_clamp = diagnostics.flux;
    }
    diagnostics.passes.clear();
    if (options_.bands > 0) result_.radiance = std::move(projection_->radiance);
    for (Step& step : steps_) {
      diagnostics.passes.push_back({std::move(step.name), std::move(step.outcome.action),
                                    std::move(step.outcome.reason),
                                    step.pass == kSkipped ? 0.0 : graph_.milliseconds(step.pass)});
    }
    result_.peak_bytes = plan_.result_bytes + plan_.working_bytes;
  }

  const View& source_;
  SourceShape shape_;
  const BakeOptions& options_;
  const BakePlan& plan_;
  const SphericalHarmonics* stored_;  ///< null if the pixels are to be projected
  BakeResult& result_;
  PassGraph graph_;
  std::vector<Step> steps_;
  std::size_t specular_ = kSkipped;
  std::optional<specular::CleanSource> clean_;
  std::optional<Projection> projection_;
};

template <class View>
std::uint64_t bytes_of(const View& source, const BakeOptions& options) {
  const BakePlan plan = plan_bake(shape_of(source), options);
  return plan.result_bytes + plan.working_bytes;
}

template <class View>
void bake_view(BakeResult& result, const View& source, const BakeOptions& options, const SphericalHarmonics* stored,
               const Control& control) {
  const BakePlan plan = plan_bake(shape_of(source), options);
  require_memory(plan, options);
  Baking<View>(source, options, plan, stored, result).run(control);
}

}  // namespace

void bake_source(BakeResult& result, const CubemapView& source, const BakeOptions& options,
                 const SphericalHarmonics* stored, const Control& control) {
  bake_view(result, source, options, stored, control);
}

void bake_source(BakeResult& result, const LatLongView& source, const BakeOptions& options,
                 const SphericalHarmonics* stored, const Control& control) {
  bake_view(result, source, options, stored, control);
}

}  // namespace baking

std::uint64_t bake_bytes(const LatLongView& source, const BakeOptions& options) {
  return baking::bytes_of(source, options);
}

std::uint64_t bake_bytes(const CubemapView& source, const BakeOptions& options) {
  return baking::bytes_of(source, options);
}

void bake_into(BakeResult& result, const LatLongView& source, const BakeOptions& options, const Control& control) {
  baking::bake_source(result, source, options, nullptr, control);
}

void bake_into(BakeResult& result, const CubemapView& source, const BakeOptions& options, const Control& control) {
  baking::bake_source(result, source, options, nullptr, control);
}

BakeResult bake(const LatLongView& source, const BakeOptions& options, const Control& control) {
  BakeResult result;
  bake_into(result, source, options, control);
  return result;
}

BakeResult bake(const CubemapView& source, const BakeOptions& options, const Control& control) {
  BakeResult result;
  bake_into(result, source, options, control);
  return result;
}

}  // namespace welkin
