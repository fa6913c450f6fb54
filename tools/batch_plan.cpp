// A batch's plan: the inputs, the options and the predicted cost of each, and the shards.
#include <algorithm>
#include <array>
#include <map>
#include <numeric>
#include <queue>
#include <set>
#include <string_view>
#include <system_error>
#include <tuple>
#include <utility>

#include "platform/text.h"
#include "tools/bake_manifest.h"
#include "tools/baked.h"
#include "tools/batch.h"
#include "tools/text.h"

namespace welkin::tool {
namespace {

namespace fs = std::filesystem;

constexpr const char* kSchema = "welkin batch jobs";
constexpr int kVersion = 1;
constexpr std::size_t kMaxJobs = 10'000'000;
constexpr std::uintmax_t kMaxPlanBytes = std::uintmax_t{1} << 32U;
constexpr double kMaxSeconds = 1e9;

// ---- Options

constexpr const char* kNeeds = "--needs";  // the only option that names a file

std::vector<std::string> words_of(const GivenOptions& options) {
  std::vector<std::string> words;
  for (const auto& [name, value] : options) {
    words.push_back(name);
    if (!value.empty()) words.push_back(value);
  }
  return words;
}

// ---- The files named by the words of a command line

/// Returns whether a path fits a pattern: within a folder's or file's name `*` stands for any characters and `?` for
/// one, and `**` for any number of folders.
bool fits(std::string_view path, std::string_view pattern) noexcept {
  constexpr std::string_view kFolders = "**/";
  if (pattern.empty()) return path.empty();
  if (pattern.starts_with(kFolders)) {
    const std::size_t slash = path.find('/');
    return fits(path, pattern.substr(kFolders.size())) ||
           (slash != std::string_view::npos && fits(path.substr(slash + 1), pattern));
  }
  const bool goes_on = !path.empty() && path.front() != '/';
  if (pattern.front() == '*') return fits(path, pattern.substr(1)) || (goes_on && fits(path.substr(1), pattern));
  const bool same = !path.empty() && path.front() == pattern.front();
  return (same || (goes_on && pattern.front() == '?')) && fits(path.substr(1), pattern.substr(1));
}

/// Adds the images in a folder and in those below it, except hidden ones and those that a bake has made. Links to
/// folders are not followed: they might form a cycle.
void add_images(const fs::path& folder, std::size_t depth, std::vector<fs::path>& found) {
  std::error_code trouble;
  std::error_code unknown;
  for (fs::directory_iterator at(folder.empty() ? "." : folder, trouble), end; !trouble && at != end;
       at.increment(trouble)) {
    const fs::path path = folder / at->path().filename();
    if (platform::utf8(path.filename()).starts_with('.')) continue;
    if (at->is_directory(unknown) && !at->is_symlink(unknown)) {
      if (depth > 1 && !begins_with(path / kManifestName, "\"welkin\"")) add_images(path, depth - 1, found);
    } else if (is_image_name(path) && at->is_regular_file(unknown)) {
      found.push_back(path);
    }
  }
  if (!trouble) return;
  throw Error(ErrorCode::file_access,
              platform::utf8(folder) + ": cannot be listed (" + trouble.message() + "); check its permissions");
}

constexpr std::size_t kAnyDepth = 1000;

/// Returns all images below a folder, in the order of their paths.
std::vector<fs::path> images_below(const fs::path& folder, std::size_t depth = kAnyDepth) {
  std::vector<fs::path> found;
  add_images(folder, depth, found);
  std::ranges::sort(found);
  return found;
}

std::vector<fs::path> images_that_fit(const std::string& named) {
  fs::path folder;
  std::string pattern;
  std::size_t parts = 0;
  for (const fs::path& part : platform::path_of(named)) {
    const std::string text = platform::utf8(part);
    if (parts == 0 && !is_pattern(text)) {
      folder /= part;
    } else if (!text.empty()) {
      pattern += (parts++ > 0 ? "/" : "") + text;
    }
  }
  std::error_code unknown;
  if (!folder.empty() && !fs::is_directory(folder, unknown)) return {};
  std::vector<fs::path> found = images_below(folder, pattern.find("**") != std::string::npos ? kAnyDepth : parts);
  std::erase_if(found, [&](const fs::path& path) {
    return !fits(platform::generic_utf8(path.lexically_relative(folder.empty() ? "." : folder)), pattern);
  });
  return found;
}

// ---- Planning

/// Returns the path relative to `folder`. Links in the file's own name stay, because its name may determine its layout.
std::string relative_to(const fs::path& folder, const fs::path& file) {
  std::error_code unknown;
  const fs::path parent = fs::weakly_canonical(fs::absolute(file, unknown).parent_path(), unknown);
  return platform::generic_utf8((parent / file.filename()).lexically_proximate(folder));
}

/// Returns a plan without jobs.
BatchPlan plan_at(const fs::path& named) {
  std::error_code unknown;
  const fs::path file = fs::is_symlink(named, unknown) ? fs::weakly_canonical(named, unknown) : named;
  return {file, fs::weakly_canonical(fs::absolute(file, unknown).parent_path(), unknown), {}};
}

/// Returns the seconds of one core, measured with bakes of photographs of 1024 x 512 with `--size 256` and more on one
/// thread of Zen 4. They only affect how work is shared out.
double seconds_of(const Prediction& prediction, const BakeCommandOptions& options) {
  constexpr double kSecondsPerJob = 0.02;          // opening, hashing and naming eight files
  constexpr double kSecondsPerTexel = 60e-9;       // reading and transforming it
  constexpr double kSecondsPerByte = 10e-9;        // of the results in memory: making and encoding it
  constexpr double kSecondsPerZlibByte = 40e-9;    // for files compressed by zlib
  constexpr double kSecondsPerBlockByte = 160e-9;  // for files with ASTC blocks
  constexpr double kSecondsOfPreviews = 0.12;      // with spheres of the default size
  double seconds_per_byte = kSecondsPerByte;
  for (const OutputFile& file : options.files) {
    const bool has_blocks = file.format == TexelFormat::astc_4x4_hdr || file.format == TexelFormat::astc_6x6_hdr;
    if (file.supercompression == Supercompression::zlib)
      seconds_per_byte = std::max(seconds_per_byte, kSecondsPerZlibByte);
    if (has_blocks) seconds_per_byte = kSecondsPerBlockByte;
  }
  const double sphere = static_cast<double>(options.preview_size) / BakeCommandOptions().preview_size;
  return kSecondsPerJob + kSecondsPerTexel * static_cast<double>(prediction.texels) +
         seconds_per_byte * static_cast<double>(prediction.result_bytes) +
         (options.previews ? kSecondsOfPreviews * sphere * sphere : 0.0);
}

/// Refuses a NUL, at which names of files end and C++ strings do not.
void refuse_nul(const std::string& text, const std::string& where) {
  if (text.find('\0') != std::string::npos) throw Flaw{where + " has a character NUL"};
}

/// Adds jobs to a plan one by one.
class Planner {
 public:
  Planner(BatchPlan& plan, const GivenOptions& options) : plan_(plan), options_(with_files_of(".", options)) {
    static_cast<void>(bake_options_of(plan, {.options = words_of(options_)}));  // checks them even without an input
  }

  void add_input(const std::string& word) {
    std::error_code unknown;
    const fs::path path = platform::path_of(word);
    const bool is_there = fs::exists(path, unknown);
    const bool is_folder = is_there && fs::is_directory(path, unknown);
    if (!is_folder && (is_there || !is_pattern(word))) {
      return wishes_.push_back({.input = word, .options = options_, .typed = true});
    }
    const std::vector<fs::path> files = is_folder ? images_below(path) : images_that_fit(word);
    if (files.empty()) {
      throw Error(ErrorCode::invalid_argument,
                  printable(word) + ": contains no images that Welkin reads; pass other files or folders");
    }
    for (const fs::path& file : files) {
      const fs::path name = is_folder ? file.lexically_relative(path) : file.filename();
      wishes_.push_back(
          {.input = platform::utf8(file), .name = platform::generic_utf8(name), .options = options_, .found = true});
    }
  }

  void add_list(const fs::path& list) {
    for_each_line(list, [&](std::size_t number, const std::string& line) {
      if (line.find_first_not_of(" \t\r") == std::string::npos) return;
      const std::string where = platform::utf8(list) + ": line " + std::to_string(number) + ": ";
      try {
        wishes_.push_back(wish_in(line, list));
      } catch (const Flaw& flaw) {
        throw Error(
            ErrorCode::invalid_argument,
            where + flaw.message + R"(; a line is {"input": PATH, "name": NAME, "options": ["--size", "128"]})");
      } catch (const Error& error) {
        throw Error(error.code(), where + error.what());
      }
    });
  }

  /// Throws `Error` (file_access) for inputs of the command line that do not exist or that no run could read: most are
  /// mistyped.
  void plan() {
    if (wishes_.empty()) {
      throw Error(ErrorCode::invalid_argument,
                  "batch plan: there is nothing to do; name images, folders of them, or a --list");
    }
    require_own(plan_.file, kSchema, "batch plan");
    std::error_code unknown;
    if (!fs::is_directory(plan_.folder, unknown)) {
      throw Error(ErrorCode::file_access, platform::utf8(plan_.file) + ": its folder does not exist; create it first");
    }
    for (const Wish& wish : wishes_) plan_job(wish);
    if (refused_.empty()) return;
    constexpr std::size_t kShown = 10;
    std::string message =
        "batch plan: " + counted(refused_.size(), "input") + " cannot be read, so no plan was written";
    for (std::size_t i = 0; i < std::min(kShown, refused_.size()); ++i) message += '\n' + refused_[i];
    throw Error(ErrorCode::file_access, message + (refused_.size() > kShown ? "\n..." : ""));
  }

 private:
  struct Wish {
    std::string input{};     ///< as named
    std::string name{};      ///< empty: from the input
    GivenOptions options{};  ///< with the plan's paths of files
    bool found = false;      ///< in a folder or by a pattern: one of six faces stands for all
    bool typed = false;      ///< on the command line: refused if no run could read it
  };

  /// Returns the options with the plan's paths of files, which `folder` contains.
  [[nodiscard]] GivenOptions with_files_of(const fs::path& folder, GivenOptions options) const {
    for (auto& [name, value] : options) {
      if (name == kNeeds) value = relative_to(plan_.folder, folder / platform::path_of(value));
    }
    return options;
  }

  [[nodiscard]] Wish wish_in(const std::string& line, const fs::path& list) const {
    Wish wish;
    std::vector<std::string> words;
    read_object(parse_json(line), "the line",
                {text("input", wish.input), text("name", wish.name), texts("options", words)});
    if (wish.input.empty()) throw Flaw{"there is no \"input\""};
    refuse_nul(wish.input, "\"input\"");
    refuse_nul(wish.name, "\"name\"");
    // Paths in a list are relative to the list's folder. An option of a line replaces that of all lines.
    const fs::path folder = list.has_parent_path() ? list.parent_path() : fs::path(".");
    BakeCommandOptions unused;
    unused.scene.folder = folder;
    Options table = job_options(unused);
    for (Option& option : table) option.needs = option.excludes = {};
    wish.options = options_;
    for (const auto& given : with_files_of(folder, read_options(table, words))) {
      std::erase_if(wish.options, [&](const auto& one) { return one.first == given.first; });
      wish.options.push_back(given);
    }
    static_cast<void>(bake_options_of(plan_, {.options = words_of(wish.options)}));
    wish.input = platform::utf8(list.parent_path() / platform::path_of(wish.input));
    return wish;
  }

  void plan_job(const Wish& wish) {
    BatchJob job;
    job.input = relative_to(plan_.folder, platform::path_of(wish.input));
    job.options = words_of(wish.options);
    try {
      if (is_stream(wish.input)) {
        throw Error(ErrorCode::unsupported_file,
                    printable(wish.input) + ": can be read only once, as a pipe can; a batch needs files");
      }
      if (platform::utf8(platform::path_of(wish.input)) != wish.input) {
        throw Error(ErrorCode::unsupported_file,
                    printable(wish.input) + ": its name is not UTF-8, which plans need; rename it");
      }
      constexpr std::uint64_t kBytesPerJob = std::uint64_t{4} << 20U;  // buffers of codecs, at least
      BakeCommandOptions options = bake_options_of(plan_, job);
      options.input = wish.input;
      const Prediction prediction = predict(options);
      if (wish.found && is_known_face(job, prediction.info)) return;
      job.seconds = seconds_of(prediction, options);
      job.memory = prediction.most_bytes + prediction.result_bytes / 2 + kBytesPerJob;
      std::error_code unknown;
      const auto size = fs::file_size(platform::path_of(wish.input), unknown);
      job.size = unknown ? 0 : static_cast<std::uint64_t>(size);
    } catch (const Error& error) {
      job.error = error.what();
      const bool is_hopeless = error.code() == ErrorCode::file_access || error.code() == ErrorCode::unsupported_file;
      if (wish.typed && is_hopeless) refused_.push_back(job.error);
    }
    job.name = unique_name(wish);
    plan_.jobs.push_back(std::move(job));
  }

  /// Returns the name, without the extension of an image, with a number if another job has it.
  std::string unique_name(const Wish& wish) {
    const bool said = !wish.found && !wish.name.empty();
    std::string name = wish.name.empty() ? platform::utf8(platform::path_of(wish.input).filename()) : wish.name;
    if (!said && is_image_name(platform::path_of(name))) name.resize(name.rfind('.'));
    if (name.empty()) name = "input";
    std::string unique = name;
    while (!names_.emplace(unique, 2).second) unique = name + '-' + std::to_string(names_.at(name)++);
    return unique;
  }

  /// Returns whether this is one of six files that another job reads together.
  bool is_known_face(const BatchJob& job, const EnvironmentInfo& info) {
    if (info.layout != Layout::six_files) return false;
    std::string all;
    for (const auto& face : info.faces) all += platform::utf8(face) + '\n';
    for (const std::string& word : job.options) all += word + '\0';
    return !faces_.insert(all).second;
  }

  BatchPlan& plan_;
  const GivenOptions options_;
  std::vector<Wish> wishes_;
  std::vector<std::string> refused_;
  std::map<std::string, int> names_;  ///< for each name, the number to try next
  std::set<std::string> faces_;
};

// ---- The file

BatchJob job_in(const Json& value, const std::string& where) {
  BatchJob job;
  read_object(
      value, where,
      {text("name", job.name), text("input", job.input), texts("options", job.options), number("seconds", job.seconds),
       bytes("size", job.size), bytes("memory", job.memory), text("error", job.error)});
  if (job.name.empty() || job.input.empty()) throw Flaw{where + " has no name or no input"};
  refuse_nul(job.name, where + ".name");
  refuse_nul(job.input, where + ".input");
  if (!(job.seconds >= 0.0 && job.seconds <= kMaxSeconds)) throw Flaw{where + ".seconds is impossible"};
  return job;
}

std::vector<BatchJob> jobs_in(const Json& json) {
  std::string schema;
  int version = 0;
  const Json* list = nullptr;
  std::string welkin;
  read_object(json, "the plan",
              {text("schema", schema),
               whole_number("version", version),
               text("welkin", welkin),
               {"jobs", [&](const Json& value, const std::string& /*where*/) { list = &value; }},
               {"totals", [](const Json& /*value*/, const std::string& /*where*/) {}}});
  if (schema != kSchema) throw Flaw{"is not a plan of this version"};
  if (version != kVersion) {
    throw Flaw{"has version " + std::to_string(version) + ", and this Welkin reads " + std::to_string(kVersion) +
               "; plan again"};
  }
  if (list == nullptr) throw Flaw{"has no jobs"};
  std::vector<BatchJob> jobs;
  std::set<std::string> names;
  const auto add = [&](const Json& value, const std::string& where) {
    jobs.push_back(job_in(value, where));
    if (!names.insert(jobs.back().name).second) throw Flaw{where + ".name occurs twice"};
  };
  read_list(*list, "jobs", add, kMaxJobs);
  return jobs;
}

}  // namespace

double BatchPlan::seconds() const noexcept {
  double sum = 0.0;
  for (const BatchJob& job : jobs) sum += job.seconds;
  return sum;
}

fs::path BatchPlan::default_results() const {
  fs::path results = file;
  return results.replace_extension(".results");
}

bool is_image_name(const fs::path& path) {
  constexpr std::array<const char*, 8> kEndings = {".exr", ".hdr", ".pfm", ".png", ".ktx2", ".ktx", ".dds", ".env"};
  const std::string ending = platform::utf8(path.extension());
  return std::ranges::any_of(kEndings, [&](const char* known) { return same_word(ending, known); });
}

bool is_pattern(const std::string& text) noexcept { return text.find_first_of("*?") != std::string::npos; }

Options job_options(BakeCommandOptions& bake) {
  constexpr std::array<std::string_view, 9> kOthers = {
      "INPUT", "--sky", "-o,--output", "--json", "--threads", "--cache", "--memory-limit", "--explain", "--plan-only"};
  Options table;
  add_bake_options(table, bake);
  std::erase_if(table, [&](const Option& option) { return std::ranges::find(kOthers, option.names) != kOthers.end(); });
  for (Option& option : table) std::erase(option.needs, "INPUT");
  return table;
}

BatchPlan plan_batch(const BatchRequest& request, const fs::path& file) {
  BatchPlan plan = plan_at(file);
  Planner planner(plan, request.options);
  for (const std::string& word : request.inputs) planner.add_input(word);
  if (request.list) planner.add_list(platform::path_of(*request.list));
  planner.plan();
  return plan;
}

void write_batch_plan(const BatchPlan& plan) {
  Json jobs = Json::array();
  std::uint64_t size = 0;
  std::size_t errors = 0;
  for (const BatchJob& job : plan.jobs) {
    jobs.push_back({{"name", job.name},
                    {"input", job.input},
                    {"options", job.options},
                    {"seconds", job.seconds},
                    {"size", job.size},
                    {"memory", job.memory}});
    if (!job.error.empty()) jobs.back()["error"] = job.error;
    size += job.size;
    errors += job.error.empty() ? 0 : 1;
  }
  write_text_file(
      plan.file,
      json_text(
          {{"schema", kSchema},
           {"version", kVersion},
           {"welkin", WELKIN_VERSION_STRING},
           {"totals", {{"jobs", plan.jobs.size()}, {"seconds", plan.seconds()}, {"size", size}, {"errors", errors}}},
           {"jobs", jobs}}));
}

BatchPlan read_batch_plan(const fs::path& file) {
  try {
    BatchPlan plan = plan_at(file);
    plan.jobs = jobs_in(read_json_file(file, "'welkin batch plan INPUT... -o jobs.json' writes one", kMaxPlanBytes));
    return plan;
  } catch (const Flaw& flaw) {
    throw Error(ErrorCode::corrupt_file,
                platform::utf8(file) + ": " + flaw.message + "; write it again with 'welkin batch plan'");
  }
}

BakeCommandOptions bake_options_of(const BatchPlan& plan, const BatchJob& job) {
  BakeCommandOptions options;
  options.scene.folder = plan.folder;
  options.asked = read_options(job_options(options), job.options);
  settle_files(options);
  static_cast<void>(library_options(options));
  options.input = platform::utf8((plan.folder / platform::path_of(job.input)).lexically_normal());
  options.called = "environment";
  return options;
}

std::vector<std::vector<std::size_t>> cut_batch(const BatchPlan& plan, int shards) {
  std::vector<std::size_t> order(plan.jobs.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::ranges::stable_sort(order, std::ranges::greater{}, [&](std::size_t job) { return plan.jobs[job].seconds; });
  using Load = std::tuple<double, std::size_t, std::size_t>;  // seconds, jobs, shard
  std::priority_queue<Load, std::vector<Load>, std::greater<>> loads;
  std::vector<std::vector<std::size_t>> cut(static_cast<std::size_t>(shards));
  for (std::size_t shard = 0; shard < cut.size(); ++shard) loads.emplace(0.0, 0, shard);
  for (const std::size_t job : order) {
    const auto [seconds, jobs, shard] = loads.top();
    loads.pop();
    cut[shard].push_back(job);
    loads.emplace(seconds + plan.jobs[job].seconds, jobs + 1, shard);
  }
  return cut;
}

}  // namespace welkin::tool
