// Plans for skies carried out.
#include <chrono>
#include <utility>

#include "jobs/tiles.h"
#include "welkin/sky_plan.h"

namespace welkin {
namespace {

constexpr double kTables = 0.8;  ///< of the progress

class SkyBaking {
 public:
  SkyBaking(const SkyPlan& plan, const glm::dvec3& sun, const Control& control)
      : plan_(plan), sun_(sun), control_(control), quiet_{control.stop, {}} {}

  SkyBake run() {
    if (plan_.tables) {
      sky_.tables = std::make_shared<const SkyTables>(
          precompute_sky(plan_.atmosphere, plan_.options.tables, jobs::part_of(control_, 0.0, kTables)));
    }
    for (const PlannedPass& pass : plan_.passes) {
      if (pass.action == PassAction::skip) {
        sky_.passes.push_back({pass.name, "skip", pass.reason, 0.0});
      } else if (!record_of_tables(pass.name)) {
        run_pass(pass);
      }
    }
    if (control_.progress) control_.progress(1.0);
    return std::move(sky_);
  }

 private:
  /// The tables' own records, where they have some of that name.
  bool record_of_tables(const std::string& name) {
    bool found = false;
    for (const PassRecord& record : sky_.tables ? sky_.tables->passes : std::vector<PassRecord>()) {
      if (record.name != name) continue;
      sky_.passes.push_back(record);
      found = true;
    }
    return found;
  }

  void run_pass(const PlannedPass& pass) {
    const auto start = std::chrono::steady_clock::now();
    make(pass.name);
    const std::chrono::duration<double, std::milli> time = std::chrono::steady_clock::now() - start;
    sky_.passes.push_back({pass.name, name(pass.action), pass.reason, time.count()});
  }

  void make(const std::string& pass) {
    const SkyBakeOptions& options = plan_.options;
    if (pass == "view") {
      view_.emplace(sky_.tables, options.altitude_m);
      sky_.sun = view_->sun(sun_);
    } else if (pass == "curve") {
      SkyCurveOptions curve = options.curve;
      curve.bands = options.bands;
      sky_.curve.emplace(*view_, curve, quiet_);
    } else if (pass == "project") {
      SkyHarmonicsOptions harmonics = options.harmonics;
      harmonics.bands = options.bands;
      sky_.radiance = SkyProjector(*view_, harmonics).project(sun_);
    } else if (pass == "specular") {
      sky_.specular = sky_specular(*view_, sun_, *options.specular, {}, quiet_);
    } else if (pass == "background") {
      sky_.background = sky_cubemap(*view_, sun_, options.background_size, {}, quiet_);
    } else if (pass == "brdf") {
      sky_.brdf = brdf_table(*options.brdf, quiet_);
    }  // aerosol and absorbers are in the tables
  }

  const SkyPlan& plan_;
  glm::dvec3 sun_;
  const Control& control_;
  Control quiet_;  ///< stops, and reports nothing: what follows the tables is short
  std::optional<SkyView> view_;
  SkyBake sky_;
};

}  // namespace

SkyBake bake(const SkyPlan& plan, const glm::dvec3& sun, const Control& control) {
  return SkyBaking(plan, sun, control).run();
}

}  // namespace welkin
