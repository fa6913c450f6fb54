#include "perf.h"
#include "welkin/bake.h"
#include "welkin/environment_file.h"
#include "welkin/probes.h"
#include "welkin/projection.h"
#include "welkin/reflections.h"
#include "welkin/requests.h"
#include "welkin/resampling.h"
#include "welkin/worker.h"

namespace welkin::perf {
namespace {

using Call = std::function<void()>;

/// The input of a child; pixels are raw floats, so that it decodes nothing by the library.
struct Pixels {
  LatLongImage lat_long;
  Cubemap cube;
};

enum class Kind { none, lat_long, cube };

struct Operation {
  std::string name;
  Kind kind = Kind::none;
  int source = 0;  ///< width of the lat-long, or texels along an edge of the cube
  int calls = 10;  ///< per process
  std::function<Call(const Pixels&)> prepare;
};

/// Consumes a result.
template <class Result>
void use(const Result& result) {
  static volatile std::size_t used = 0;
  used = used + (reinterpret_cast<std::size_t>(&result) & 1U);
}

EnvironmentView view_of(Kind kind, const Pixels& pixels) {
  if (kind == Kind::cube) return pixels.cube.view();
  return pixels.lat_long.view();
}

/// Each call computes `of` the pixels.
template <class Of>
Operation plain(std::string name, Kind kind, int source, int calls, Of of) {
  return {std::move(name), kind, source, calls,
          [of](const Pixels& pixels) -> Call { return [of, &pixels] { use(of(pixels)); }; }};
}

Operation prefiltered(const std::string& from, Kind kind, int source, int size, std::optional<int> mips = {}) {
  std::string name = "prefilter " + from + " -> " + std::to_string(size);
  if (mips) name += ", " + std::to_string(*mips) + " mips";
  return plain(name, kind, source, size > 512 ? 4 : 10, [=](const Pixels& pixels) {
    return prefilter_specular(view_of(kind, pixels), {.size = size, .mips = mips});
  });
}

Operation baked(const std::string& from, Kind kind, int source, int size) {
  return plain("bake " + from + " -> " + std::to_string(size), kind, source, 10, [=](const Pixels& pixels) {
    BakeOptions options;
    options.specular->size = size;
    return bake(view_of(kind, pixels), options);
  });
}

void add_projections(std::vector<Operation>& operations) {
  for (const int size : {64, 256, 1024}) {
    operations.push_back(plain("project rgb32f cube " + std::to_string(size), Kind::cube, size, 10,
                               [](const Pixels& pixels) { return project(pixels.cube.view()); }));
  }
  operations.push_back(plain("project lat-long 1024", Kind::lat_long, 1024, 10,
                             [](const Pixels& pixels) { return project(pixels.lat_long.view()); }));
}

void add_reflections(std::vector<Operation>& operations) {
  for (const int size : {64, 128, 256, 512, 1024})
    operations.push_back(prefiltered("lat-long 1024", Kind::lat_long, 1024, size));
  for (const int size : {512, 2048}) operations.push_back(prefiltered("lat-long 4096", Kind::lat_long, 4096, size));
  for (const int size : {64, 256, 512}) operations.push_back(baked("lat-long 1024", Kind::lat_long, 1024, size));
  for (const int size : {16, 32, 64, 128, 256, 512, 1024})
    operations.push_back(prefiltered("cube", Kind::cube, size, size));
  // Chains whose last mip has 16 texels.
  for (const int size : {64, 128, 256, 512}) {
    const int mips = full_chain_levels(size) - 4;
    operations.push_back(prefiltered("lat-long 1024", Kind::lat_long, 1024, size, mips));
    operations.push_back(prefiltered("cube", Kind::cube, size, size, mips));
  }
  for (const int size : {64, 128}) operations.push_back(baked("cube", Kind::cube, size, size));
  operations.push_back(plain("sheen lat-long 1024 -> 256", Kind::lat_long, 1024, 4, [](const Pixels& pixels) {
    LobeChainOptions sheen;
    sheen.size = 256;
    for (const double roughness : {0.05, 0.25, 0.5, 0.75, 1.0}) sheen.lobes.push_back(ZonalLobe::charlie(roughness));
    return prefilter_by_lobes(pixels.lat_long.view(), sheen);
  }));
}

void add_others(std::vector<Operation>& operations) {
  operations.push_back(plain("irradiance cube 64", Kind::none, 0, 10,
                             [](const Pixels&) { return irradiance_cubemap(SphericalHarmonics(3), 64); }));
  operations.push_back(plain("direct irradiance lat-long 1024", Kind::lat_long, 1024, 10, [](const Pixels& pixels) {
    return direct_irradiance(pixels.lat_long.view(), {0.0, 1.0, 0.0});
  }));
  for (const int size : {64, 128}) {
    operations.push_back(plain("BRDF table " + std::to_string(size), Kind::none, 0, 10, [=](const Pixels&) {
      return brdf_table({size, size, BrdfModel::split_sum, true});
    }));
  }
  operations.push_back(plain("64 probes of cube 32", Kind::cube, 32, 10, [](const Pixels& pixels) {
    ProbeGrid grid;
    grid.counts = {4, 4, 4};
    return bake_probes(grid, std::vector<CubemapView>(64, pixels.cube.view()));
  }));
  operations.push_back({"worker made, project cube 64", Kind::cube, 64, 10, [](const Pixels& pixels) -> Call {
                          const auto cube = std::make_shared<const Cubemap>(pixels.cube);
                          return [=] {
                            Worker worker;
                            use(worker.post(Project{EnvironmentSource(cube), {}}).get());
                          };
                        }});
}

std::vector<Operation> all_operations() {
  std::vector<Operation> operations;
  for (const auto& add : {add_projections, add_reflections, add_others}) add(operations);
  return operations;
}

// Pixels between the processes.

std::string file_of(const Operation& operation) {
  return (operation.kind == Kind::cube ? "cube-" : "lat-long-") + std::to_string(operation.source);
}

std::vector<float> read_floats(const std::filesystem::path& file, std::size_t count) {
  std::vector<float> values(count);
  const auto bytes = static_cast<std::streamsize>(count * sizeof(float));
  if (!std::ifstream(file, std::ios::binary).read(reinterpret_cast<char*>(values.data()), bytes))
    throw Error(ErrorCode::file_access, file.string() + ": cannot be read");
  return values;
}

Pixels read_pixels(const Operation& operation, const std::filesystem::path& folder) {
  const auto source = static_cast<std::size_t>(operation.source);
  Pixels pixels;
  if (operation.kind == Kind::lat_long) {
    pixels.lat_long = {operation.source, operation.source / 2,
                       read_floats(folder / file_of(operation), source * source / 2 * 3)};
  } else if (operation.kind == Kind::cube) {
    pixels.cube = {operation.source, read_floats(folder / file_of(operation), 18 * source * source)};
  }
  return pixels;
}

/// The parent's pixels, which may warm up freely.
class Sources {
 public:
  explicit Sources(std::filesystem::path file) : file_(std::move(file)) {}

  [[nodiscard]] LatLongImage lat_long(int width) const {
    return (file_.empty() ? report::built_in_environment(width) : report::environment_from(file_, width)).image;
  }
  [[nodiscard]] Cubemap cube(int size) const { return to_cubemap(lat_long(1024).view(), size); }

  /// Returns the folder of the pixels of an operation.
  [[nodiscard]] std::filesystem::path write(const Operation& operation) const {
    return scratch_file(file_of(operation),
                        [&](const std::filesystem::path& path) {
                          std::vector<float> values;
                          if (operation.kind == Kind::cube) {
                            const Cubemap made = cube(operation.source);
                            values.assign(made.pixels().begin(), made.pixels().end());
                          }
                          if (operation.kind == Kind::lat_long) values = lat_long(operation.source).pixels;
                          std::ofstream(path, std::ios::binary)
                              .write(reinterpret_cast<const char*>(values.data()),
                                     static_cast<std::streamsize>(values.size() * sizeof(float)));
                        })
        .parent_path();
  }

 private:
  std::filesystem::path file_;
};

// The child.

/// Returns the page faults of this process that read nothing from disk; 0 if the system does not report them.
long page_faults() {
  std::ifstream stream("/proc/self/stat");
  std::string text((std::istreambuf_iterator<char>(stream)), {});
  std::istringstream fields(text.substr(std::min(text.size(), text.rfind(')') + 1)));
  std::string field;
  for (int k = 0; k < 8; ++k) fields >> field;  // the state is the third field, the faults are the tenth
  return std::atol(field.c_str());
}

/// Returns the peak memory of this process, MiB; 0 if the system does not report it.
long resident_megabytes() {
  std::ifstream stream("/proc/self/status");
  for (std::string line; std::getline(stream, line);) {
    if (line.rfind("VmHWM:", 0) == 0) return std::atol(line.c_str() + 6) / 1024;
  }
  return 0;
}

/// The numbers of a row, each the minimum over several processes.
struct Row {
  std::array<double, 7> values{};  ///< ms of the first, second, last and fastest later call; faults of first, last; MiB

  void lower_to(const Row& other) {
    for (std::size_t k = 0; k < values.size(); ++k) values[k] = std::min(values[k], other.values[k]);
  }
};

double seconds(report::Clock clock) {
  if (clock == report::Clock::processor) return report::processor_seconds();
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

Row measure(const Call& call, int calls, report::Clock clock) {
  std::vector<double> milliseconds;
  std::vector<long> faults;
  for (int k = 0; k < calls; ++k) {
    const long before = page_faults();
    const double start = seconds(clock);
    call();
    milliseconds.push_back(1e3 * (seconds(clock) - start));
    faults.push_back(page_faults() - before);
  }
  return {{milliseconds[0], milliseconds[1], milliseconds.back(),
           *std::min_element(milliseconds.begin() + 1, milliseconds.end()), static_cast<double>(faults.front()),
           static_cast<double>(faults.back()), static_cast<double>(resident_megabytes())}};
}

const Operation& find(const std::vector<Operation>& operations, const std::string& name) {
  const auto at =
      std::find_if(operations.begin(), operations.end(), [&](const Operation& one) { return one.name == name; });
  if (at == operations.end()) throw Error(ErrorCode::invalid_argument, name + ": no such operation");
  return *at;
}

// The parent.

struct Options {
  std::vector<int> threads;
  int runs = 0;
  std::string only;
  report::Clock clock = report::Clock::wall;
  std::filesystem::path file;
};

Options read_options(const Paths& words) {
  const Arguments arguments(words, {"--threads", "--runs", "--processor", "--only"});
  Options options;
  options.runs = std::max(1, arguments.count("--runs", 3));
  options.only = arguments.text("--only");
  for (const std::string& one : arguments.list("--threads", "1")) options.threads.push_back(std::atoi(one.c_str()));
  if (arguments.has("--processor")) options.clock = report::Clock::processor;
  if (!arguments.files.empty()) options.file = arguments.files.back();
  return options;
}

std::string digits(double value) { return number(value < 1000.0 ? "%.3g" : "%.0f", value); }

std::vector<std::string> row_of(const std::filesystem::path& program, const Operation& operation,
                                const Sources& sources, int threads, const Options& options) {
  const std::filesystem::path folder = sources.write(operation);
  const std::filesystem::path output = folder / "row";
  Row minimum;
  for (int run = 0; run < options.runs; ++run) {
    const report::ProcessResult result =
        report::run_process({program.string(), "--cold-calls", operation.name, folder.string(), std::to_string(threads),
                             options.clock == report::Clock::processor ? "processor" : "wall"},
                            0, report::Clock::wall, output);
    Row row;
    std::ifstream stream(output);
    for (double& value : row.values) stream >> value;
    if (result.exit_code != 0 || !stream) throw Error(ErrorCode::file_access, operation.name + ": the process failed");
    if (run == 0) minimum = row;
    minimum.lower_to(row);
  }
  const auto& [first, second, last, warm, first_faults, last_faults, resident] = minimum.values;
  return {operation.name,
          digits(first),
          digits(second),
          digits(last),
          digits(warm),
          digits(first / warm),
          number("%.0f", first_faults) + " / " + number("%.0f", last_faults),
          number("%.0f", resident)};
}

/// Adds whole processes of the command: KTX2 without previews.
void add_processes(Table& table, const std::filesystem::path& command, const Sources& sources, int threads,
                   const Options& options) {
  const auto add = [&](const std::string& name, int size,
                       const std::function<void(const std::filesystem::path&)>& write) {
    if (name.find(options.only) == std::string::npos) return;
    const std::filesystem::path image = scratch_file(name + ".exr", write);
    double seconds = 1e9;
    for (int run = 0; run < options.runs; ++run) {
      const report::ProcessResult result = report::run_process(
          {command.string(), "bake", image.string(), "--quiet", "--no-previews", "--size", std::to_string(size),
           "--threads", std::to_string(threads), "-o", (image.parent_path() / "baked").string()},
          threads, options.clock);
      if (result.exit_code != 0) throw Error(ErrorCode::file_access, command.string() + " bake: the process failed");
      seconds = std::min(seconds, result.seconds);
    }
    table.add({name, digits(1e3 * seconds)});
  };
  for (const int size : {64, 128, 256, 512}) {
    add("process: bake cube -> " + std::to_string(size), size,
        [&](const auto& path) { (void)write_environment(path, sources.cube(size).view()); });
  }
  for (const int size : {256, 512}) {
    add("process: bake lat-long 1024 -> " + std::to_string(size), size,
        [&](const auto& path) { (void)write_environment(path, sources.lat_long(1024).view()); });
  }
}

// Warm calls by their error bound.

constexpr double kBounds[] = {1e-5, 1e-4, 1e-3, 3e-3, 1e-2, 3e-2};

/// Returns the run-time bakes of engines, within a bound. `Operation::source`: the size of the result and of its cube.
std::vector<Operation> operations_within(double rms_error) {
  std::vector<Operation> all;
  const auto chain = [&](const std::string& name, Kind kind, PrefilterOptions options) {
    options.rms_error = rms_error;
    all.push_back(plain(name, kind, options.size, 1,
                        [=](const Pixels& pixels) { return prefilter_specular(view_of(kind, pixels), options); }));
  };
  const auto probes = [&](int mips) {
    all.push_back({"64 probes of 64 halves, " + std::to_string(mips) + " mips", Kind::cube, 64, 1,
                   [=](const Pixels& pixels) -> Call {
                     const auto source = std::make_shared<report::FormattedCubemap>(pixels.cube, PixelFormat::rgba16f);
                     const auto out = std::make_shared<const ProbeTargets>(64, 64, mips);
                     return [=, light = std::vector<dvec3>(std::size_t{9} * 64)]() mutable {
                       const PrefilterOptions options{.size = 64, .mips = mips, .rms_error = rms_error};
                       use(bake_many(std::vector<CubemapView>(64, source->view()), out->targets, light, options, 3));
                     };
                   }});
  };
  for (const int size : {64, 128, 256, 512}) {
    const int mips = size == 64 ? 3 : size == 128 ? 4 : size == 256 ? 5 : 6;  // down to 16 texels
    const std::string cube = "cube " + std::to_string(size);
    chain(cube + ", " + std::to_string(mips) + " mips", Kind::cube, {.size = size, .mips = mips});
    chain(cube, Kind::cube, {.size = size});
  }
  chain("lat-long to 256, 5 mips", Kind::lat_long, {.size = 256, .mips = 5});
  for (const auto& [kind, from] : {std::pair(Kind::cube, "cube 64"), std::pair(Kind::lat_long, "lat-long to 64")}) {
    chain(std::string(from) + ", Charlie, 3 mips", kind, {.size = 64, .mips = 3, .lobe = LobeFamily::charlie});
    chain(std::string(from) + ", Lambert", kind, {.size = 64, .lobe = LobeFamily::lambert});
  }
  all.push_back(plain("cube 64, irradiance", Kind::cube, 64, 1, [=](const Pixels& pixels) {
    BakeOptions options{.background = {}, .specular = {}, .brdf = {}};
    options.irradiance->rms_error = rms_error;
    return bake(pixels.cube.view(), options);
  }));
  for (const int mips : {3, 5}) probes(mips);
  return all;
}

/// Returns milliseconds: the minimum of `runs` calls after a first one, which makes tables.
std::string best_of(const Call& call, int runs) {
  try {
    const report::Stopwatch stopwatch{.threads = 1, .budget_seconds = 60.0, .most_runs = runs + 1};
    return number("%.3g", 1e3 * stopwatch.seconds(call));
  } catch (const Error&) {
    return "refused";
  }
}

}  // namespace

std::string cold_tables(const std::filesystem::path& program, const std::vector<std::filesystem::path>& arguments) {
  const Options options = read_options(arguments);
  const Sources sources(options.file);
  const std::filesystem::path command = program.parent_path() / "welkin";
  std::string text;
  for (const int threads : options.threads) {
    const std::string count = std::to_string(threads) + (threads == 1 ? " thread" : " threads");
    Table calls({count, "first, ms", "second", "last", "best", "first / best", "faults, first / last", "MiB"});
    for (const Operation& operation : all_operations()) {
      if (operation.name.find(options.only) != std::string::npos)
        calls.add(row_of(program, operation, sources, threads, options));
    }
    Table processes({count, "whole process, ms"});
    if (std::filesystem::exists(command)) add_processes(processes, command, sources, threads, options);
    for (const Table* const table : {&calls, &processes}) text += table->empty() ? "" : table->text() + "\n";
  }
  return text;
}

std::string cold_calls(const std::vector<std::filesystem::path>& arguments) {
  const std::vector<Operation> operations = all_operations();
  const Operation& operation = find(operations, arguments.at(0).string());
  const Pixels pixels = read_pixels(operation, arguments.at(1));
  const Call call = operation.prepare(pixels);
  const report::Clock clock = arguments.at(3) == "processor" ? report::Clock::processor : report::Clock::wall;
  Row row;
  run_with_threads(std::atoi(arguments.at(2).string().c_str()), [&] { row = measure(call, operation.calls, clock); });
  std::string text;
  for (const double value : row.values) text += number("%.6g ", value);
  return text + "\n";
}

std::string bounds_table(const Paths& words) {
  const Arguments arguments(words, {"--runs"});
  if (arguments.files.size() != 1) throw Error(ErrorCode::invalid_argument, "--bounds: name one lat-long");
  const int runs = std::max(1, arguments.count("--runs", 20));
  const Environment image = read_environment(arguments.files.at(0));
  const LatLongView view = image.lat_long();
  Pixels pixels;
  pixels.lat_long = to_lat_long(view, view.width, view.height, dmat3(1.0), ResampleFilter::area);
  std::vector<std::string> heads{"ms within"};
  for (const double bound : kBounds) heads.push_back(number("%g", bound));
  Table table(heads);
  run_with_threads(1, [&] {
    for (std::size_t k = 0; k < operations_within(kBounds[0]).size(); ++k) {
      std::vector<std::string> cells;
      for (const double bound : kBounds) {
        const Operation operation = operations_within(bound)[k];
        if (cells.empty()) cells.push_back(operation.name);
        if (pixels.cube.size() != operation.source) pixels.cube = to_cubemap(view, operation.source);
        cells.push_back(best_of(operation.prepare(pixels), bound < 5e-4 ? 2 : runs));
      }
      table.add(cells);
    }
  });
  return table.text();
}

}  // namespace welkin::perf
