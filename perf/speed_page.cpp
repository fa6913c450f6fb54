#include "perf.h"

namespace welkin::perf {
namespace {

/// The fastest run of each benchmark, and its counters.
class Collector : public benchmark::ConsoleReporter {
 public:
  struct Result {
    double seconds = 0.0;
    bool latency = false;  ///< its own counters say what is to be compared
    std::map<std::string, double> counters;
  };

  void ReportRuns(const std::vector<Run>& runs) override {
    for (const Run& run : runs) {
      if (run.run_type != Run::RT_Iteration || run.error_occurred) continue;
      const std::string full = run.benchmark_name();
      Result result{run.real_accumulated_time / static_cast<double>(run.iterations),
                    full.find("/manual_time") != std::string::npos,
                    {}};
      for (const auto& [name, counter] : run.counters) result.counters[name] = counter.value;
      const auto [at, added] = results_.try_emplace(own_name(full), result);
      if (!added && result.seconds < at->second.seconds) at->second = result;
    }
  }

  [[nodiscard]] const std::map<std::string, Result>& results() const { return results_; }

  /// One of its counters is in microseconds.
  [[nodiscard]] std::optional<double> seconds(const std::string& name, const std::string& counter = "") const {
    const auto result = results_.find(name);
    if (result == results_.end()) return std::nullopt;
    if (counter.empty()) return result->second.seconds;
    const auto value = result->second.counters.find(counter);
    return value == result->second.counters.end() ? std::nullopt : std::optional(1e-6 * value->second);
  }

 private:
  /// Subject/variant/size/threads: Google Benchmark appends "/real_time", "/iterations:N" and the like.
  static std::string own_name(const std::string& full) {
    std::size_t end = 0;
    for (int parts = 0; parts < 4 && end != std::string::npos; ++parts) end = full.find('/', end + 1);
    return full.substr(0, end);
  }

  std::map<std::string, Result> results_;
};

/// Names of what runs go to standard error.
class Names final : public Collector {
  bool ReportContext(const Context& /*context*/) override { return true; }
  void ReportRuns(const std::vector<Run>& runs) override {
    Collector::ReportRuns(runs);
    if (!runs.empty()) std::cerr << runs.front().benchmark_name() << '\n';
  }
};

/// The usual table, then ratios between benchmarks of the run: what a shared, noisy machine can honestly be asked for.
class Ratios final : public Collector {
  void ReportRuns(const std::vector<Run>& runs) override {
    ConsoleReporter::ReportRuns(runs);
    Collector::ReportRuns(runs);
  }

  void Finalize() override {
    const auto line = [this](const std::string& name, const std::string& ratio) {
      GetOutputStream() << "  " << name << std::string(name.size() < 40 ? 40 - name.size() : 0, ' ') << ratio << '\n';
    };
    GetOutputStream() << "\nRatios within this run (fastest repetitions)\n";
    for (const auto& [name, result] : results()) {
      const auto bytes = result.counters.find("bytes/s");
      if (result.latency) continue;
      const std::size_t slash = name.find('/');
      const std::string subject = name.substr(0, slash);
      const auto read = seconds("ReadBandwidth" + name.substr(slash));
      if (subject.starts_with("Project") && read)
        line(name, number("%6.1f %% of ReadBandwidth", 100.0 * *read / result.seconds));
      // "1024x512-256" is as large as 256.
      const std::string size_and_threads = name.substr(name.find_last_of("/-", name.rfind('/') - 1) + 1);
      const auto copying = results().find("CopyBandwidth/rgb32f/" + size_and_threads);
      if ((subject == "LatLongToCubemap" || subject == "SampleGrid" || subject == "Mips") && copying != results().end())
        line(name, number("%6.1f %% of CopyBandwidth", 100.0 * bytes->second / copying->second.counters.at("bytes/s")));
      const auto single = seconds(name.substr(0, name.size() - 1) + "1");
      if (name.ends_with("/2") && single)
        line(name, number("%6.2f x as fast as with 1 thread", *single / result.seconds));
    }
  }
};

/// What a figure is compared with, and which way is better.
enum class Measure {
  share_of_limit,  ///< the limit's time over the figure's; the mark is the least share that will do
  ratio_to_other,  ///< the figure's time over the other's; the mark is the largest ratio that will do
  seconds,         ///< the mark is the longest time that will do; the limit, if there is one, is for comparison
};

struct Figure {
  std::string benchmark;  ///< Subject/variant/size/threads
  std::string limit;      ///< another benchmark, or nothing
  Measure measure = Measure::seconds;
  std::optional<double> mark{};  ///< none: shown for comparison
  std::string counter{};         ///< in place of the benchmark's own time: one of its counters, microseconds
};

struct Section {
  std::string title;
  std::string said;
  std::vector<Figure> figures;
};

constexpr double kMilli = 1e-3;
constexpr double kMicro = 1e-6;

Section projection() {
  Section section{"Projection", "Exact quadrature, three bands where the name says nothing else.", {}};
  const auto add = [&section](const std::string& rest, std::optional<double> mark) {
    section.figures.push_back({"ProjectCubemap/" + rest, "ReadBandwidth/" + rest, Measure::share_of_limit, mark});
  };
  for (const char* const format : {"rgb32f", "rgba32f", "rgba16f"}) {
    for (const int size : {64, 128, 256, 512, 1024, 2048}) {
      for (const char* const threads : {"1", "2"}) {
        add(std::string(format) + '/' + std::to_string(size) + '/' + threads, size >= 256 ? 0.85 : 0.6);
      }
    }
  }
  section.figures.push_back({"ProjectCubemap/rgb32f/64/1", "", Measure::seconds, 8.0 * kMicro});
  for (const char* const variant : {"rgb32f-bands4", "rgb32f-bands6", "rgb32f-bands10", "rgb8", "rgba8srgb"}) {
    for (const char* const size : {"64", "1024"}) {
      section.figures.push_back({std::string("ProjectCubemap/") + variant + '/' + size + "/1",
                                 std::string("ReadBandwidth/rgb32f/") + size + "/1", Measure::share_of_limit});
    }
  }
  for (const char* const threads : {"1", "2"}) {
    section.figures.push_back({std::string("ProjectLatLong/rgb32f/4096x2048/") + threads,
                               std::string("ReadBandwidth/rgb32f/4096x2048/") + threads, Measure::share_of_limit});
  }
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
           {"SkyTables/compact/4/2", "", Measure::seconds, 0.05},
           {"SkySpecular/no_disc/32/2", "", Measure::seconds, 3.0 * kMilli}}};
}

Section many() {
  return {
      "Many small probes",
      "Of 64 half floats: one call on one or two threads, compared with single calls on one.",
      {{"ProjectCubemap/rgba16f/64/1", "", Measure::seconds, 12.0 * kMicro},
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

/// What is compared with the mark, as text; the mark; whether it is reached.
struct Verdict {
  std::string value;
  std::string mark;
  bool reached = false;
};

Verdict verdict(const Figure& figure, double seconds, std::optional<double> limit) {
  const double mark = figure.mark.value_or(0.0);
  switch (figure.measure) {
    case Measure::share_of_limit: {
      if (!limit) break;
      return {percent(*limit / seconds), "at least " + percent(mark), *limit / seconds >= mark};
    }
    case Measure::ratio_to_other: {
      if (!limit) break;
      return {number("%.2f x", seconds / *limit), number("at most %.3g x", mark), seconds / *limit <= mark};
    }
    case Measure::seconds:
      return {limit ? percent(*limit / seconds) : "", "at most " + time_text(mark), seconds <= mark};
  }
  return {};
}

void add_row(Table& table, const Figure& figure, const Collector& results) {
  const std::optional<double> seconds = results.seconds(figure.benchmark, figure.counter);
  const std::optional<double> limit = figure.limit.empty() ? std::optional<double>() : results.seconds(figure.limit);
  const Verdict said = seconds ? verdict(figure, *seconds, limit) : Verdict();
  const bool marked = seconds && figure.mark;
  table.add({'`' + figure.benchmark + "`" + (figure.counter.empty() ? "" : " " + figure.counter), time_text(seconds),
             figure.limit.empty() ? "" : time_text(limit), said.value, marked ? said.mark : "",
             marked ? (said.reached ? "yes" : "no") : ""});
}

/// Matches those names and no others, however Google Benchmark goes on after them.
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

void run_benchmarks() {
  Ratios reporter;
  benchmark::RunSpecifiedBenchmarks(&reporter);
}

std::string speed_page() {
  const std::vector<Section> sections = {projection(), streams(), bakes(), many(), skies(), command(), worker()};
  Names results;
  benchmark::RunSpecifiedBenchmarks(&results, filter_for(sections));
  report::Stopwatch stopwatch;
  stopwatch.threads = 2;
  const report::Machine machine = report::this_machine(stopwatch);
  std::string page = "# Speed\n\n`welkin_perf --page`, " + machine.date + ": " + machine.processor + ", " +
                     machine.instruction_set + ", " + machine.compiler + ", Welkin " + machine.welkin +
                     ". A name ends with the number of threads; times are wall times, the fastest repetition's.\n";
  for (const Section& section : sections) {
    page += "\n## " + section.title + "\n\n" + (section.said.empty() ? "" : section.said + "\n\n");
    Table table({"figure", "time", "compared with", "fraction or ratio", "target", "met"});
    for (const Figure& figure : section.figures) add_row(table, figure, results);
    page += table.text();
  }
  return page;
}

}  // namespace welkin::perf
