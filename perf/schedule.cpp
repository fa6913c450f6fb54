#include "schedule.h"

#include <cxxabi.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cstdlib>
#include <functional>
#include <map>
#include <memory>
#include <utility>

#include "bake.h"
#include "perf/report/schedule.h"
#include "platform/text.h"
#include "subjects.h"
#include "welkin/bake.h"
#include "welkin/projection.h"

namespace welkin::perf {
namespace {

using jobs::TracedRegion;
using jobs::TracedWork;
using report::critical_path_seconds;
using report::scheduled_seconds;

/// What the regions of one kind come to.
struct Kind {
  int regions = 0;
  std::size_t parts = 0;
  std::size_t fewest = static_cast<std::size_t>(-1);
  double seconds = 0.0;
  double longest = 0.0;
};

double all_seconds(const TracedWork& work) { return scheduled_seconds(work, 1); }

std::string name_of(const std::type_info* what) {
  if (what == nullptr) return "passes of a graph";
  int status = 0;
  const std::unique_ptr<char, void (*)(void*)> text(abi::__cxa_demangle(what->name(), nullptr, nullptr, &status),
                                                    std::free);
  std::string name = status == 0 ? text.get() : what->name();
  name = name.substr(0, name.find('('));
  const std::size_t inner = name.find("welkin::");
  return inner == std::string::npos ? name : name.substr(inner + 8);
}

void count(const TracedWork& work, std::map<std::string, Kind>& kinds) {
  for (const TracedWork::Stretch& stretch : work.stretches) {
    for (const TracedRegion& region : stretch.region) {
      Kind& kind = kinds[name_of(region.what)];
      ++kind.regions;
      kind.parts += region.parts.size();
      kind.fewest = std::min(kind.fewest, region.parts.size());
      for (const TracedWork& part : region.parts) {
        const double seconds = all_seconds(part);
        kind.seconds += seconds;
        kind.longest = std::max(kind.longest, seconds);
        count(part, kinds);
      }
    }
  }
}

struct Case {
  std::string name;
  std::function<void()> work;
};

/// Takes the least of each stretch: whatever else the machine does can only add to it. False, and nothing of use in
/// `least`, if the other run did other things.
bool keep_least(TracedWork& least, const TracedWork& other) {
  if (least.stretches.size() != other.stretches.size()) return false;
  for (std::size_t at = 0; at < least.stretches.size(); ++at) {
    TracedWork::Stretch& stretch = least.stretches[at];
    const TracedWork::Stretch& beside = other.stretches[at];
    stretch.seconds = std::min(stretch.seconds, beside.seconds);
    if (stretch.region.size() != beside.region.size()) return false;
    for (std::size_t k = 0; k < stretch.region.size(); ++k) {
      if (stretch.region[k].parts.size() != beside.region[k].parts.size()) return false;
      for (std::size_t part = 0; part < stretch.region[k].parts.size(); ++part) {
        if (!keep_least(stretch.region[k].parts[part], beside.region[k].parts[part])) return false;
      }
    }
  }
  return true;
}

/// The least of each stretch over several runs.
TracedWork least_trace(const Case& subject) {
  constexpr int kRuns = 15;
  TracedWork least;
  run_with_threads(1, [&] {
    subject.work();
    for (int run = 0; run < kRuns; ++run) {
      jobs::TraceRecording recording;
      subject.work();
      TracedWork trace = recording.finish();
      if (run == 0 || !keep_least(least, trace)) least = std::move(trace);
    }
  });
  return least;
}

std::string milliseconds(double seconds) { return platform::number_text(1e3 * seconds, std::chars_format::general, 3); }

std::string regions_table(const TracedWork& trace) {
  std::map<std::string, Kind> kinds;
  count(trace, kinds);
  std::vector<std::pair<std::string, Kind>> sorted(kinds.begin(), kinds.end());
  std::sort(sorted.begin(), sorted.end(),
            [](const auto& a, const auto& b) { return a.second.longest > b.second.longest; });
  std::string text =
      "| regions of | how many | parts | fewest parts | all parts, ms | longest part, ms "
      "|\n|---|---|---|---|---|---|\n";
  for (const auto& [name, kind] : sorted) {
    text += "| `" + name + "` | " + std::to_string(kind.regions) + " | " + std::to_string(kind.parts) + " | " +
            std::to_string(kind.fewest) + " | " + milliseconds(kind.seconds) + " | " + milliseconds(kind.longest) +
            " |\n";
  }
  return text;
}

/// What the critical path consists of: serial work before or after a region, and parts of regions.
void add_critical_path(const TracedWork& work, const std::string& inside,
                       std::vector<std::pair<std::string, double>>& path) {
  for (const TracedWork::Stretch& stretch : work.stretches) {
    const bool forks = !stretch.region.empty();
    const std::string next = forks ? name_of(stretch.region.front().what) : "";
    const bool whole = work.stretches.size() == 1;
    path.emplace_back(whole ? inside : "serial in " + inside + (forks ? ", before " + next : ", at its end"),
                      stretch.seconds);
    for (const TracedRegion& region : stretch.region) {
      for (const std::size_t part : report::longest_way(region)) {
        add_critical_path(region.parts[part], region.what == nullptr ? "pass " + std::to_string(part) : next, path);
      }
    }
  }
}

std::string critical_path_table(const TracedWork& trace) {
  std::vector<std::pair<std::string, double>> path;
  add_critical_path(trace, "the call", path);
  std::stable_sort(path.begin(), path.end(), [](const auto& a, const auto& b) { return a.second > b.second; });
  std::string text = "| on the critical path | ms |\n|---|---|\n";
  const double least = 0.02 * critical_path_seconds(trace);
  for (const auto& [name, seconds] : path) {
    if (seconds >= least) text += "| " + name + " | " + milliseconds(seconds) + " |\n";
  }
  return text;
}

}  // namespace

std::string schedule_tables(const std::vector<std::filesystem::path>& /*arguments*/) {
  constexpr std::array<int, 7> kWorkers = {1, 2, 4, 8, 16, 32, 64};
  std::vector<Case> cases;
  for (const auto& [size, width] : {std::pair{256, 1024}, {512, 1024}, {1024, 2048}}) {
    const auto result = std::make_shared<BakeResult>();
    cases.push_back({"Bake/" + std::to_string(size) + "/" + std::to_string(width) + "x" + std::to_string(width / 2),
                     [result, size = size, source = bake_picture(width, false)] {
                       bake_into(*result, source->view(), bake_options(size, false));
                     }});
  }
  cases.push_back(
      {"ProjectCubemap/rgb32f/1024", [view = noise_cubemap(PixelFormat::rgb32f, 1024)] { (void)project(view); }});
  std::string text = "| milliseconds on workers |";
  for (const int workers : kWorkers) text += " " + std::to_string(workers) + " |";
  text += " critical path |\n|---|---|---|---|---|---|---|---|---|\n";
  std::string regions;
  for (const Case& subject : cases) {
    const TracedWork trace = least_trace(subject);
    text += "| `" + subject.name + "` |";
    for (const int workers : kWorkers) text += " " + milliseconds(scheduled_seconds(trace, workers)) + " |";
    text += " " + milliseconds(critical_path_seconds(trace)) + " |\n";
    regions += "\n`" + subject.name + "`:\n\n" + regions_table(trace) + "\n" + critical_path_table(trace);
  }
  return text + regions;
}

}  // namespace welkin::perf
