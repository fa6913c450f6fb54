#include <fstream>

#include "perf.h"

namespace welkin::perf {
namespace {

/// Collects the fastest run of each benchmark, and its counters. Names of running benchmarks go to standard error.
class Collector final : public benchmark::ConsoleReporter {
 public:
  /// `processor`: benchmarks on one thread count by CPU time instead of wall time.
  explicit Collector(bool processor) : processor_(processor) {}

  struct Result {
    double seconds = 0.0;
    std::map<std::string, double> counters;
  };

  bool ReportContext(const Context& /*context*/) override { return true; }

  void ReportRuns(const std::vector<Run>& runs) override {
    if (!runs.empty()) std::cerr << runs.front().benchmark_name() << '\n';
    for (const Run& run : runs) {
      if (run.run_type != Run::RT_Iteration || run.error_occurred) continue;
      const std::string full = run.benchmark_name();
      const bool latency = full.find("/manual_time") != std::string::npos;
      const std::string key = base_name(full);
      const bool processor = processor_ && !latency && key.ends_with("/1");
      const double time = processor ? run.cpu_accumulated_time : run.real_accumulated_time;
      Result result{time / static_cast<double>(run.iterations), {}};
      for (const auto& [name, counter] : run.counters) result.counters[name] = counter.value;
      const auto [at, added] = results_.try_emplace(key, result);
      if (!added && result.seconds < at->second.seconds) at->second = result;
    }
  }

  /// Returns the benchmark's own time, or that of a counter in microseconds.
  [[nodiscard]] std::optional<double> seconds(const std::string& name, const std::string& counter = "") const {
    const auto result = results_.find(name);
    if (result == results_.end()) return std::nullopt;
    if (counter.empty()) return result->second.seconds;
    const auto value = result->second.counters.find(counter);
    return value == result->second.counters.end() ? std::nullopt : std::optional(1e-6 * value->second);
  }

 private:
  /// Returns Subject/variant/size/threads, without the "/real_time", "/iterations:N" and the like of Google Benchmark.
  static std::string base_name(const std::string& full) {
    std::size_t end = 0;
    for (int parts = 0; parts < 4 && end != std::string::npos; ++parts) end = full.find('/', end + 1);
    return full.substr(0, end);
  }

  bool processor_;
  std::map<std::string, Result> results_;
};

/// The comparison of a figure, and which direction is better.
enum class Measure {
  share_of_limit,  ///< the limit's time over the figure's; the mark is the minimum
  ratio_to_other,  ///< the figure's time over the other's; the mark is the maximum
  seconds,         ///< the mark is the maximum time
  counted,         ///< cycles per texel; the mark is the minimum fraction of them that the counted operations take
};

struct Figure {
  std::string benchmark;  ///< Subject/variant/size/threads
  std::string limit;      ///< another benchmark, or empty
  Measure measure = Measure::seconds;
  std::optional<double> mark{};  ///< none: shown for comparison
  std::string counter{};         ///< use this counter, in microseconds, instead of the benchmark's own time
  double texels = 0.0;           ///< of `counted`, ...
  double operations = 0.0;       ///< ... and operations on floats per texel
};

struct Section {
  std::string title;
  std::string said;
  std::vector<Figure> figures;
};

constexpr double kMilli = 1e-3;
constexpr double kMicro = 1e-6;

/// The fraction of the cycles that counted operations take at four registers each: the AVX2 target (64 in 10 us).
constexpr double kShareOfCounted = 0.4;

/// Returns the additions, subtractions and multiplications of three bands for a texel of three channels, as
/// docs/maths/projection.md counts them. Of strips: moments of values, then classes and products of moments.
double operations_of(int size) {
  constexpr double kQuadrants = 19.5;  // 3 (8 + 18) / 4
  if (size < 256) return kQuadrants;
  const double moments = size >= 1024 ? 4.0 : size >= 512 ? 5.0 : 6.0;
  const double moments_of_value = size >= 1024 ? 4.0 : size >= 512 ? 4.5 : 5.1;
  return 3.0 * moments_of_value + kQuadrants * moments / 16.0;
}

Section projection() {
  Section section{
      "Projection",
      "Exact quadrature, three bands where the name says nothing else. Faces to 512 are bound by arithmetic: "
      "cycles a texel, and the share of them that the counted operations take at four registers a cycle. "
      "Larger ones are bound by memory: share of the time in which the same bytes are read.",
      {}};
  const auto counted = [&section](const std::string& variant, int size, std::optional<double> mark) {
    section.figures.push_back({"ProjectCubemap/" + variant + '/' + std::to_string(size) + "/1", "", Measure::counted,
                               mark, "", 6.0 * size * size, operations_of(size)});
  };
  const auto read = [&section](const std::string& rest, std::optional<double> mark) {
    section.figures.push_back({"ProjectCubemap/" + rest, "ReadBandwidth/" + rest, Measure::share_of_limit, mark});
  };
  for (const char* const format : {"rgb32f", "rgba32f", "rgba16f"}) {
    for (const int size : {64, 128, 256, 512}) counted(format, size, kShareOfCounted);
    for (const char* const size : {"1024", "2048"}) {
      read(std::string(format) + '/' + size + "/1", 0.7);
      read(std::string(format) + '/' + size + "/2", 0.9);
    }
  }
  for (const char* const variant : {"rgb8", "rgba8srgb"}) counted(variant, 64, {});
  for (const char* const size : {"64", "256"}) {
    const std::string rest = std::string("/") + size + "/1";
    section.figures.push_back(
        {"ProjectCubemap/directxmath-method" + rest, "ProjectCubemap/rgb32f" + rest, Measure::ratio_to_other});
  }
  for (const char* const variant : {"rgb32f-bands4", "rgb32f-bands6", "rgb32f-bands10", "rgb8", "rgba8srgb"}) {
    section.figures.push_back(
        {std::string("ProjectCubemap/") + variant + "/1024/1", "ReadBandwidth/rgb32f/1024/1", Measure::share_of_limit});
  }
  for (const char* const threads : {"1", "2"}) {
    section.figures.push_back({std::string("ProjectLatLong/rgb32f/4096x2048/") + threads,
                               std::string("ReadBandwidth/rgb32f/4096x2048/") + threads, Measure::share_of_limit,
                               0.75});
  }
  return section;
}

Section harmonics() {
  Section section{"Small calls",
                  "A thousand calls of three bands: milliseconds here are microseconds a call. `evaluate` in one call "
                  "for a thousand directions, compared with one by one.",
                  {}};
  for (const char* const bands : {"3", "6", "10"}) {
    const std::string rest = std::string("/") + bands + "/1";
    section.figures.push_back(
        {"Harmonics/evaluate-1000" + rest, "Harmonics/evaluate-one-by-one-1000" + rest, Measure::ratio_to_other, 0.5});
    for (const char* const call : {"product-1000", "rotate-1000"}) {
      section.figures.push_back({std::string("Harmonics/") + call + rest, "", Measure::seconds});
    }
  }
  section.figures.push_back({"Harmonics/sky-curve-1000/3/1", "", Measure::seconds, 1.0 * kMilli});
  return section;
}

Section streams() {
  Section section{"Files projected while they are read",
                  "Compared with the decoder alone, whose rows are discarded, on one thread. The excess over 1 is the "
                  "projection's.",
                  {}};
  for (const char* const format : {"hdr", "exr-half-zip", "exr-float-zip", "pfm", "png8"}) {
    section.figures.push_back({std::string("ProjectFile/") + format + "/2048x1024/1",
                               std::string("DecodeFile/") + format + "/2048x1024/1", Measure::ratio_to_other, 1.11});
  }
  return section;
}

Section bakes() {
  Section section{"Bakes", "Specular chain, irradiance cubemap, BRDF table; from lat-longs, then from cubemaps.", {}};
  const auto add = [&section](const std::string& name, double milliseconds) {
    section.figures.push_back({"Bake/" + name + "/2", "", Measure::seconds, milliseconds * kMilli});
  };
  add("512/1024x512", 10.0);
  add("512-sun/1024x512", 12.0);
  add("256/1024x512", 4.0);
  add("1024/2048x1024", 40.0);
  add("2048/4096x2048", 180.0);
  add("512/8192x4096", 60.0);
  for (const auto& [size, milliseconds] : {std::pair{"64", 0.5}, {"128", 1.5}, {"256", 5.0}, {"512", 14.0}}) {
    add(std::string("cube-rgb32f/") + size, milliseconds);
  }
  return section;
}

Section skies() {
  return {"Skies",
          "",
          {{"SkyTables/full/4/2", "", Measure::seconds, 0.25},
           {"SkyTables/compact/4/2", "", Measure::seconds, 0.06},
           {"SkyTables/compact-haze/4/2", "SkyTables/compact/4/2", Measure::ratio_to_other},
           {"SkySpecular/no_disc/32/2", "", Measure::seconds, 3.0 * kMilli}}};
}

Section many() {
  return {
      "Many small probes",
      "Of 64 half floats: one call on one or two threads, compared with single calls on one.",
      {{"ProjectMany/rgba16f/64x10000/1", "", Measure::seconds, 40.0 * kMilli},
       {"ProjectMany/rgba16f/64x10000/1", "ProjectMany/rgba16f-single-calls/64x10000/1", Measure::ratio_to_other, 1.0},
       {"ProjectMany/rgba16f/64x10000/2", "ProjectMany/rgba16f-single-calls/64x10000/1", Measure::ratio_to_other,
        1.0 / (2.0 * 0.95)},
       {"BakeMany/rgba16f/64x64/1", "", Measure::seconds, 64.0 * kMilli},
       {"BakeMany/rgba16f/64x64/2", "BakeMany/rgba16f-single-calls/64x64/1", Measure::ratio_to_other,
        1.0 / (2.0 * 0.95)}}};
}

Section command() { return {"Previews", "", {{"Previews/spheres-256/256/2", "", Measure::seconds, 60.0 * kMilli}}}; }

Section worker() {
  return {"Worker",
          "Time of a job beyond the same call without a worker (median).",
          {{"PostToResult/wait/64/1", "", Measure::seconds, 3.0 * kMicro, "overhead_us"},
           {"PostToResult/wait-asleep-2ms/64/1", "", Measure::seconds, 60.0 * kMicro, "overhead_us"},
           {"PostToResult/wait/1024/2", "", Measure::seconds, {}, "overhead_us"}}};
}

std::string time_text(std::optional<double> seconds) {
  if (!seconds) return "not measured";
  const auto digits = [](double value) { return number("%.3g", value); };
  if (*seconds < 1e-3) return digits(1e6 * *seconds) + " us";
  return *seconds < 1.0 ? digits(1e3 * *seconds) + " ms" : digits(*seconds) + " s";
}

std::string percent(double share) { return number("%.0f %%", 100.0 * share); }

/// The value that is compared with the mark, as text; the mark; whether it is reached.
struct Verdict {
  std::string value;
  std::string mark;
  bool reached = false;
};

/// The data with which all rows are compared.
struct Comparison {
  const Collector& results;
  double clock;                                                                    ///< cycles per second; 0: unknown
  std::vector<std::pair<std::string, std::map<std::string, std::string>>> others;  ///< heads and times of other pages
};

/// Returns the registers' lanes of floats times operations per cycle, as on Zen.
double operations_per_cycle() {
  switch (active_instruction_set()) {
    case InstructionSet::avx512: return 4.0 * 16.0;
    case InstructionSet::avx2: return 4.0 * 8.0;
    default: return 4.0 * 4.0;
  }
}

/// `limit`: seconds; 0 if there is none.
Verdict verdict(const Figure& figure, double seconds, double limit, double clock) {
  const double mark = figure.mark.value_or(0.0);
  switch (figure.measure) {
    case Measure::share_of_limit: {
      if (!(limit > 0.0)) break;
      return {percent(limit / seconds), "at least " + percent(mark), limit / seconds >= mark};
    }
    case Measure::ratio_to_other: {
      if (!(limit > 0.0)) break;
      return {number("%.2f x", seconds / limit), number("at most %.3g x", mark), seconds / limit <= mark};
    }
    case Measure::seconds: return {"", "at most " + time_text(mark), seconds <= mark};
    case Measure::counted: {
      const double cycles = seconds * clock / figure.texels;
      const double share = figure.operations / operations_per_cycle() / cycles;
      return {number("%.2f cycles, ", cycles) + percent(share), "at least " + percent(mark), share >= mark};
    }
  }
  return {};
}

std::string label_of(const Figure& figure) {
  return '`' + figure.benchmark + "`" + (figure.counter.empty() ? "" : " " + figure.counter);
}

void add_row(Table& table, const Figure& figure, const Comparison& by) {
  const std::optional<double> seconds = by.results.seconds(figure.benchmark, figure.counter);
  const double limit = figure.limit.empty() ? 0.0 : by.results.seconds(figure.limit).value_or(0.0);
  const Verdict said = seconds ? verdict(figure, *seconds, limit, by.clock) : Verdict();
  const bool marked = seconds && figure.mark;
  std::vector<std::string> cells{
      label_of(figure), time_text(seconds),      limit > 0.0 ? time_text(limit) : "",
      said.value,       marked ? said.mark : "", marked ? (said.reached ? "yes" : "no") : ""};
  std::ptrdiff_t column = 2;
  for (const auto& [head, times] : by.others) {
    const auto time = times.find(cells.front());
    cells.insert(cells.begin() + column++, time == times.end() ? "" : time->second);
  }
  table.add(cells);
}

/// Returns the first cell of each row of a page's tables, with the second.
std::map<std::string, std::string> times_of_page(const std::filesystem::path& file) {
  std::map<std::string, std::string> times;
  std::ifstream in(file);
  if (!in) throw Error(ErrorCode::invalid_argument, "the other page cannot be read: " + file.string());
  for (std::string line; std::getline(in, line);) {
    const std::size_t first = line.find(" | ");
    const std::size_t second = first == std::string::npos ? first : line.find(" | ", first + 3);
    if (line.starts_with("| `") && second != std::string::npos) {
      times.try_emplace(line.substr(2, first - 2), line.substr(first + 3, second - first - 3));
    }
  }
  return times;
}

/// Returns cycles per second from a chain of integer multiplications, each of which takes three.
double clock_of_this_machine() {
  constexpr int kChain = 20'000;
  double shortest = 1.0;
  std::uint64_t value = 3;
  for (int run = 0; run < 200; ++run) {
    const Clock::time_point start = Clock::now();
    for (int k = 0; k < kChain; ++k) {
      value *= 0x9E3779B97F4A7C15U;
      benchmark::DoNotOptimize(value);
    }
    shortest = std::min(shortest, seconds(Clock::now() - start));
  }
  return 3.0 * kChain / shortest;
}

/// Returns a filter for exactly those names, with any suffix of Google Benchmark.
std::string filter_for(const std::vector<Section>& sections) {
  std::vector<std::string> names;
  for (const Section& section : sections) {
    for (const Figure& figure : section.figures) {
      names.push_back(figure.benchmark);
      if (!figure.limit.empty()) names.push_back(figure.limit);
    }
  }
  std::sort(names.begin(), names.end());
  names.erase(std::unique(names.begin(), names.end()), names.end());
  std::string filter = "^(";
  for (const std::string& name : names) filter += (filter.size() > 2 ? "|" : "") + name;
  return filter + ")(/|$)";
}

}  // namespace

std::string speed_page(const PageOptions& options) {
  const std::vector<Section> sections = {projection(), streams(), harmonics(), bakes(),
                                         many(),       skies(),   command(),   worker()};
  Collector results(options.processor);
  Comparison by{results, 0.0, {}};
  for (const auto& [head, file] : options.others) by.others.emplace_back(head, times_of_page(file));
  benchmark::RunSpecifiedBenchmarks(&results, filter_for(sections));
  by.clock = clock_of_this_machine();
  report::Stopwatch stopwatch;
  stopwatch.threads = 2;
  const report::Machine machine = report::this_machine(stopwatch);
  std::string page = "# Speed\n\n`welkin_perf --page`, " + machine.date + ": " + machine.processor + ", " +
                     machine.instruction_set + number(", %.2f GHz, ", 1e-9 * by.clock) + machine.compiler +
                     ", Welkin " + machine.welkin + ". A name ends with the number of threads; times are " +
                     (options.processor ? "processor times (of several threads wall times)" : "wall times") +
                     ", the fastest repetition's.\n";
  std::vector<std::string> heads{"figure", "time", "compared with", "share, ratio or cycles a texel", "target", "met"};
  for (std::size_t k = 0; k < by.others.size(); ++k) {
    heads.insert(heads.begin() + 2 + static_cast<std::ptrdiff_t>(k), by.others[k].first);
  }
  for (const Section& section : sections) {
    page += "\n## " + section.title + "\n\n" + (section.said.empty() ? "" : section.said + "\n\n");
    Table table(heads);
    for (const Figure& figure : section.figures) add_row(table, figure, by);
    page += table.text();
  }
  return page;
}

}  // namespace welkin::perf
