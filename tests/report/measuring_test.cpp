#include "perf/report/measuring.h"

#include "perf/report/report.h"
#include "places.h"
#include "support/catch.h"
#include "support/temporary_directory.h"
#include "support/thrown_error.h"
#include "welkin/core.h"
#include "welkin/projection.h"
#include "welkin/resampling.h"

using namespace welkin;
using namespace welkin::report;

// Parts of measurements: norms, probes, lights, formats, the stopwatch, other programs.

TEST_CASE("report: errors at probes are by solid angle, the largest by its own truth", "[report]") {
  Cubemap chain(1, 1);
  for (int face = 0; face < 6; ++face) std::fill_n(chain.face(0, face), 3, 1.0F);
  std::mt19937 random(1);
  const std::vector<Probe> probes = probes_of(chain, 0, 100, random);
  REQUIRE(probes.size() == 6);
  std::vector<glm::dvec3> truth(6, glm::dvec3(1.0));
  CHECK(errors_at(chain, 0, probes, truth, glm::dvec3(1.0)).norms.rms == 0.0);
  truth[2].g = 0.5;
  const ProbeErrors errors = errors_at(chain, 0, probes, truth, glm::dvec3(1.0));
  CHECK(errors.norms.rms == Approx(std::sqrt(0.25 / 17.25)));
  CHECK(errors.norms.maximum == Approx(1.0));
  CHECK(errors.truth_there == Approx(0.5));
}

TEST_CASE("report: many texels are probed evenly, and where they are brightest and darkest", "[report]") {
  const ReportEnvironment light = built_in_environment(64);
  Cubemap chain(16, 1);
  for (std::size_t k = 0; k < std::size_t{6} * 256 * 3; ++k) chain.face(0, 0)[k] = light.image.pixels[k];
  chain.face(0, 3)[3 * 77 + 1] = 1e6F;
  chain.face(0, 5)[3 * 5 + 1] = -1.0F;
  std::mt19937 random(1);
  const std::vector<Probe> probes = probes_of(chain, 0, 40, random);
  REQUIRE(probes.size() == 56);
  const auto among = [&](std::int64_t texel) {
    return std::any_of(probes.begin() + 40, probes.end(),
                       [&](const Probe& p) { return p.texel == texel && p.weight == 0.0; });
  };
  CHECK(among(3 * 256 + 77));
  CHECK(among(5 * 256 + 5));
  for (std::int64_t k = 0; k < 40; ++k) CHECK(probes[static_cast<std::size_t>(k)].texel / (1536 / 40) - k <= 1);
}

TEST_CASE("report: norms of harmonics", "[report]") {
  SphericalHarmonics truth(3);
  truth.at(0, 0) = glm::dvec3(3.0, 4.0, 0.0);
  SphericalHarmonics found = truth;
  CHECK(harmonic_errors(found, truth).rms == 0.0);
  CHECK(harmonic_errors(found, truth).maximum == 0.0);
  found.at(0, 0).g = 4.5;
  CHECK(relative_error(found, truth) == Approx(0.1));
  CHECK(harmonic_errors(found, truth).maximum == Approx(0.1));  // band 0 is the same everywhere
  SphericalHarmonics positive = truth;
  positive.at(0, 0).b = 1.0;
  found.at(0, 0).b = 1.0;
  CHECK(worst_channel_error(found, positive) == Approx(0.125));
  const ErrorNorms both[] = {{3.0, 1.0}, {4.0, 2.0}};
  CHECK(together(both).rms == Approx(std::sqrt(12.5)));
  CHECK(together(both).maximum == 2.0);
}

TEST_CASE("report: formats hold what they can", "[report]") {
  Cubemap image{1, std::vector<float>(18, 0.5F)};
  image.pixels()[0] = 2.0F;
  for (const PixelFormat format : {PixelFormat::rgb32f, PixelFormat::rgba32f, PixelFormat::rgb16f, PixelFormat::rgba16f,
                                   PixelFormat::rgb8, PixelFormat::rgba8, PixelFormat::srgb8, PixelFormat::srgba8}) {
    INFO(name(format));
    const bool bytes = bytes_per_texel(format) <= 4;
    const FormattedCubemap formatted(image, format);
    const glm::dvec3 mean = mean_radiance(project(formatted.view()).radiance);
    CHECK(mean.r == Approx((bytes ? 1.0 + 2.5 : 2.0 + 2.5) / 6.0).epsilon(6e-3));
    CHECK(mean.g == Approx(0.5).epsilon(6e-3));
  }
}

TEST_CASE("report: the stopwatch runs work as often as it may", "[report]") {
  int calls = 0;
  const auto work = [&] { ++calls; };
  CHECK(Stopwatch{1, 0.0, 1000}.seconds(work) >= 0.0);
  CHECK(calls == 1);
  CHECK(Stopwatch{2, 60.0, 1}.seconds(work) >= 0.0);
  CHECK(calls == 2);
  CHECK(Stopwatch{1, 0.005, 1000}.seconds(work) >= 0.0);
  CHECK(calls > 10);
  CHECK(Stopwatch{1}.clock() == Clock::processor);
  CHECK(Stopwatch{2}.clock() == Clock::wall);
  CHECK_THROWS_AS(Stopwatch{1}.seconds([] { throw 5; }), int);
}

TEST_CASE("report: other programs are run, timed and told apart by how they end", "[report]") {
  const test::TemporaryDirectory folder;
  const ProcessResult said =
      run_process({"sh", "-c", "echo $0; echo no >&2", "word"}, 1, Clock::wall, folder.file("said"));
  CHECK(said.exit_code == 0);
  std::ifstream stream(folder.file("said"));
  std::string line;
  std::getline(stream, line);
  CHECK(line == "word");
  CHECK(run_process({"sh", "-c", "exit 3"}, 0, Clock::processor).exit_code == 3);
  CHECK(run_process({"sh", "-c", "kill -9 $$"}, 1, Clock::wall).exit_code == -1);
  CHECK(run_process({"welkin-there-is-no-such-program"}, 1, Clock::wall).exit_code == -1);
  CHECK(run_process({"sleep", "0.02"}, 1, Clock::wall).seconds >= 0.02);
  CHECK_FALSE(process_seconds({"false"}, Stopwatch{}).has_value());
  CHECK(process_seconds({"true"}, Stopwatch{1, 0.0}).has_value());
  CHECK(on_path("sh"));
  CHECK_FALSE(on_path("welkin-there-is-no-such-program"));
}

// The settings that a report recommends stay good: by their errors, which are the same on every run. Times are those on
// record in tests/data/report_tiny.json, so that a setting leaves the front only by its error or another's.

namespace {

constexpr double kGrowth = 1.1;     // of an error, beyond which it fails
constexpr double kRounding = 1e-6;  // errors below it are not told apart

std::filesystem::path record() { return std::filesystem::path(WELKIN_TEST_DATA) / "report_tiny.json"; }

/// Today's errors with the times on record.
Report measured_again(const Report& recorded, const std::string& pass) {
  ReportOptions options;
  options.scale = "tiny";
  options.passes = {pass};
  options.peers = false;
  options.budget_seconds = 0.0;
  Report today = run_report(options);
  std::map<std::string, double> seconds;
  for (const Measurement& one : recorded.measurements) seconds[one.pass + label(one)] = one.seconds;
  for (Measurement& one : today.measurements) {
    INFO(one.pass << ": " << label(one));
    REQUIRE(seconds.count(one.pass + label(one)) == 1);
    one.seconds = seconds[one.pass + label(one)];
  }
  return today;
}

void check_errors(const std::vector<Measurement>& recorded, const std::vector<Measurement>& today) {
  REQUIRE(today.size() == recorded.size());
  for (std::size_t k = 0; k < today.size(); ++k) {
    INFO(today[k].pass << ": " << label(today[k]));
    CHECK(today[k].error_rms <= kGrowth * recorded[k].error_rms + kRounding);
    CHECK(today[k].error_maximum <= kGrowth * recorded[k].error_maximum + kRounding);
  }
}

/// Checks that recommended settings still meet their targets and lie on the Pareto front.
void check_recommendations(const std::vector<Measurement>& recorded, const std::vector<Measurement>& today) {
  const std::vector<std::size_t> front = pareto_front(today);
  for (const double target : kErrorTargets) {
    const auto chosen = recommend(recorded, target);
    if (!chosen) continue;
    INFO(today[*chosen].pass << " for " << target << ": " << label(today[*chosen]));
    CHECK(today[*chosen].error_rms <= kGrowth * target);
    CHECK(std::find(front.begin(), front.end(), *chosen) != front.end());
  }
}

void check_pass(const std::string& start) {
  const Report recorded = read_report(record());
  const Report today = measured_again(recorded, start);
  REQUIRE(today.environment == recorded.environment);
  for (const Pass& pass : today.passes) {
    check_errors(of_pass(recorded, pass.id), of_pass(today, pass.id));
    check_recommendations(of_pass(recorded, pass.id), of_pass(today, pass.id));
  }
}

}  // namespace

// WELKIN_RECORD_GOLDEN=1 welkin_tests "report: the record is whole" writes the record again, times included: for a
// change that alters errors or settings and says why.
TEST_CASE("report: the record is whole", "[report]") {
  if (std::getenv("WELKIN_RECORD_GOLDEN") != nullptr) {
    ReportOptions options;
    options.scale = "tiny";
    options.peers = false;
    options.budget_seconds = 0.05;
    std::ofstream(record()) << to_json(run_report(options));
  }
  const Report recorded = read_report(record());
  std::vector<std::string> passes;
  for (const Pass& pass : recorded.passes) passes.push_back(pass.id);
  CHECK(passes == pass_ids());
}

TEST_CASE("report: recommended projections stay on the front", "[report]") { check_pass("project"); }
TEST_CASE("report: recommended prefilters stay on the front", "[report][slow]") { check_pass("prefilter"); }
TEST_CASE("report: lookups stay as near to the truth", "[report][slow]") { check_pass("lookups"); }
TEST_CASE("report: recommended bands stay on the front", "[report][slow]") { check_pass("irradiance"); }
TEST_CASE("report: recommended BRDF tables stay on the front", "[report]") { check_pass("brdf"); }
TEST_CASE("report: recommended blocks stay on the front", "[report]") { check_pass("blocks"); }
TEST_CASE("report: recommended sky quadratures stay on the front", "[report][slow]") { check_pass("sky-harmonics"); }
TEST_CASE("report: recommended sky tables stay on the front", "[report][slow]") { check_pass("sky-tables"); }

TEST_CASE("report: errors are the same on every run and number of threads", "[report][slow]") {
  ReportOptions options;
  options.scale = "tiny";
  options.passes = {"project-lat-long", "prefilter-0.30"};
  options.peers = false;
  options.budget_seconds = 0.0;
  const Report one = run_report(options);
  options.threads = 3;
  const Report three = run_report(options);
  REQUIRE(one.measurements.size() == three.measurements.size());
  for (std::size_t k = 0; k < one.measurements.size(); ++k) {
    CHECK(one.measurements[k].error_rms == three.measurements[k].error_rms);
    CHECK(one.measurements[k].error_maximum == three.measurements[k].error_maximum);
  }
  CHECK(three.machine.clock == "wall time");
}

TEST_CASE("report: what cannot be measured is refused", "[report]") {
  const auto refused = [](const ReportOptions& options) {
    return test::thrown_by([&] { (void)run_report(options); }).code == ErrorCode::invalid_argument;
  };
  ReportOptions options;
  options.scale = "huge";
  CHECK(refused(options));
  options.scale = "tiny";
  options.passes = {"brdf", "nonsense"};
  CHECK(refused(options));
  options.passes = {"brdf"};
  options.threads = -1;
  CHECK(refused(options));
}

TEST_CASE("report: it can be cancelled, and tells how far it is", "[report][slow]") {
  ReportOptions options;
  options.scale = "tiny";
  options.passes = {"irradiance", "brdf"};
  options.budget_seconds = 0.0;
  std::vector<double> shares;
  (void)run_report(options, {{}, [&](double share) { shares.push_back(share); }});
  CHECK(std::is_sorted(shares.begin(), shares.end()));
  REQUIRE_FALSE(shares.empty());
  CHECK(shares.back() == Approx(1.0));
  stop_source stop;
  stop.request_stop();
  CHECK(test::thrown_by([&] { (void)run_report(options, {stop.get_token(), {}}); }).code == ErrorCode::cancelled);
}
