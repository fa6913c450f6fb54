#include "schedule.h"

#include <cxxabi.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <cstdlib>
#include <fstream>
#include <functional>
#include <map>
#include <memory>
#include <utility>

#include "bake.h"
#include "image/geometry.h"
#include "perf/report/process.h"
#include "perf/report/schedule.h"
#include "platform/text.h"
#include "scratch_files.h"
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

/// Of the first call of this process.
TracedWork first_trace(const Case& subject) {
  TracedWork trace;
  run_with_threads(1, [&] {
    jobs::TraceRecording recording;
    subject.work();
    trace = recording.finish();
  });
  return trace;
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

constexpr std::array<int, 7> kWorkers = {1, 2, 4, 8, 16, 32, 64};

/// Seconds at each number of workers, then the critical path.
using Times = std::array<double, kWorkers.size() + 1>;

Times times_of(const TracedWork& trace) {
  Times times{};
  for (std::size_t k = 0; k < kWorkers.size(); ++k) times[k] = scheduled_seconds(trace, kWorkers[k]);
  times.back() = critical_path_seconds(trace);
  return times;
}

std::string row_of(const std::string& name, const Times& times) {
  std::string text = "| " + name + " |";
  for (const double seconds : times) text += " " + milliseconds(seconds) + " |";
  return text + "\n";
}

/// A hundred lamps of a texel each, 300 times as bright as the sky, on the picture of `bake_picture`.
std::shared_ptr<const LatLongImage> picture_with_lamps(int width) {
  auto lit = std::make_shared<LatLongImage>(*bake_picture(width, false));
  for (std::size_t lamp = 0; lamp < 100; ++lamp) {
    const std::size_t row = static_cast<std::size_t>(lit->height) * (10 + lamp % 10 * 3) / 50;
    const std::size_t column = static_cast<std::size_t>(width) * ((lamp * 37 + 11) % 100) / 100;
    float* const texel = lit->pixels.data() + 3 * (row * static_cast<std::size_t>(width) + column);
    for (int c = 0; c < 3; ++c) texel[c] = 300.0F;
  }
  return lit;
}

/// The picture of `bake_picture` at the texels' centres of a cubemap, without any of the library's tables.
std::shared_ptr<const CubemapImage> cube_picture(int size) {
  const auto source = bake_picture(1024, false);
  auto cube = std::make_shared<CubemapImage>();
  cube->size = size;
  cube->pixels.reserve(std::size_t{18} * static_cast<std::size_t>(size) * static_cast<std::size_t>(size));
  for (int face = 0; face < 6; ++face) {
    for (int row = 0; row < size; ++row) {
      for (int column = 0; column < size; ++column) {
        const dvec3 to = image::face_direction(size, face, column + 0.5, row + 0.5);
        const double height = std::acos(std::clamp(to.y / glm::length(to), -1.0, 1.0)) / M_PI * source->height;
        const double turn = (std::atan2(to.x, to.z) / (2.0 * M_PI) + 0.5) * source->width;
        const int source_row = std::min(source->height - 1, static_cast<int>(height));
        const int source_column = std::min(source->width - 1, static_cast<int>(turn));
        const float* const texel =
            source->pixels.data() + std::ptrdiff_t{3} * (std::ptrdiff_t{source_row} * source->width + source_column);
        cube->pixels.insert(cube->pixels.end(), texel, texel + 3);
      }
    }
  }
  return cube;
}

template <class Image>
Case bake_case(std::string name, int size, std::shared_ptr<const Image> source) {
  const auto result = std::make_shared<BakeResult>();
  return {std::move(name), [=] { bake_into(*result, source->view(), bake_options(size, false)); }};
}

/// Makes one case's picture when it is asked for.
struct Subject {
  std::string name;
  std::function<Case(const std::string& name)> make;
};

std::vector<Subject> all_subjects() {
  std::vector<Subject> subjects;
  for (const auto& [size, width] : {std::pair{256, 1024}, {512, 1024}, {1024, 2048}}) {
    subjects.push_back(
        {"`Bake/" + std::to_string(size) + "/" + std::to_string(width) + "x" + std::to_string(width / 2) + "`",
         [size = size, width = width](const auto& name) { return bake_case(name, size, bake_picture(width, false)); }});
  }
  subjects.push_back({"`Bake/512/1024x512` with a hundred lamps",
                      [](const auto& name) { return bake_case(name, 512, picture_with_lamps(1024)); }});
  for (const int size : {64, 256, 512}) {
    subjects.push_back({"`Bake/cube-rgb32f/" + std::to_string(size) + "`",
                        [=](const auto& name) { return bake_case(name, size, cube_picture(size)); }});
  }
  subjects.push_back({"`ProjectCubemap/rgb32f/1024`", [](const auto& name) {
                        return Case{name, [view = noise_cubemap(PixelFormat::rgb32f, 1024)] { (void)project(view); }};
                      }});
  return subjects;
}

/// The least of several processes' first calls, each number by itself.
Times first_times(const std::filesystem::path& program, const std::string& name) {
  constexpr int kRuns = 5;
  const std::filesystem::path output = scratch_file("first-call", [](const auto&) {}).parent_path() / "times";
  Times least{};
  for (int run = 0; run < kRuns; ++run) {
    const report::ProcessResult result =
        report::run_process({program.string(), "--schedule-first", name}, 0, report::Clock::wall, output);
    std::ifstream stream(output);
    for (double& value : least) {
      double seconds = 0.0;
      stream >> seconds;
      value = run == 0 ? seconds : std::min(value, seconds);
    }
    if (result.exit_code != 0 || !stream) throw Error(ErrorCode::file_access, name + ": the process failed");
  }
  return least;
}

}  // namespace

std::string schedule_tables(const std::filesystem::path& program) {
  std::string text = "| milliseconds on workers |";
  for (const int workers : kWorkers) text += " " + std::to_string(workers) + " |";
  text += " critical path |\n|---|---|---|---|---|---|---|---|---|\n";
  std::string regions;
  for (const Subject& subject : all_subjects()) {
    const TracedWork trace = least_trace(subject.make(subject.name));
    text += row_of(subject.name, times_of(trace));
    text += row_of(subject.name + ", first call", first_times(program, subject.name));
    regions += "\n" + subject.name + ":\n\n" + regions_table(trace) + "\n" + critical_path_table(trace);
  }
  return text + regions;
}

std::string first_schedule(const std::string& name) {
  std::string text;
  for (const Subject& subject : all_subjects()) {
    if (subject.name != name) continue;
    const Case one = subject.make(name);
    const TracedWork trace = first_trace(one);
    for (const double seconds : times_of(trace))
      text += platform::number_text(seconds, std::chars_format::general, 9) + " ";
    if (std::getenv("WELKIN_SCHEDULE_PATH") != nullptr)
      text += "\n" + regions_table(trace) + critical_path_table(trace);
  }
  return text + "\n";
}

}  // namespace welkin::perf
