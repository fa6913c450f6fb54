#include "tools/batch_plan.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>
#include <queue>
#include <set>
#include <string_view>
#include <system_error>
#include <tuple>
#include <utility>

#include "platform/text.h"
#include "tools/baked.h"
#include "tools/batch_costs.h"
#include "tools/batch_inputs.h"
#include "tools/batch_words.h"
#include "tools/json.h"
#include "tools/lines.h"
#include "tools/text.h"
#include "welkin/core.h"

namespace welkin::tool {
namespace {

namespace fs = std::filesystem;

constexpr const char* kSchema = "welkin batch jobs";
constexpr int kVersion = 1;
constexpr std::size_t kMostJobs = 10'000'000;
constexpr std::uintmax_t kMostPlanBytes = std::uintmax_t{1} << 32U;
constexpr double kMostSeconds = 1e9;
constexpr double kMostBytes = 1e15;
constexpr std::uint64_t kBytesOfAJob = std::uint64_t{4} << 20U;  // buffers of codecs, at least

// ---- Options

bool names_a_file(std::string_view option) { return option == "--needs"; }

/// The words with `change` called on those that name a file.
template <class Change>
std::vector<std::string> with_files(std::vector<std::string> words, const Change& change) {
  for (std::size_t i = 0; i < words.size(); ++i) {
    const std::size_t equal = words[i].find('=');
    if (!names_a_file(std::string_view(words[i]).substr(0, equal))) continue;
    if (equal != std::string::npos) {
      words[i] = words[i].substr(0, equal + 1) + change(words[i].substr(equal + 1));
    } else if (i + 1 < words.size()) {
      ++i;
      words[i] = change(words[i]);
    }
  }
  return words;
}

/// The file as `folder` sees it. Links in its own name stay, for what it is called may tell its layout.
std::string relative_to(const fs::path& folder, const fs::path& file) {
  std::error_code unknown;
  const fs::path parent = fs::weakly_canonical(fs::absolute(file, unknown).parent_path(), unknown);
  return platform::utf8((parent / file.filename()).lexically_proximate(folder));
}

/// A plan without jobs.
BatchPlan plan_at(const fs::path& named) {
  std::error_code unknown;
  const fs::path file = fs::is_symlink(named, unknown) ? fs::weakly_canonical(named, unknown) : named;
  return {file, fs::weakly_canonical(fs::absolute(file, unknown).parent_path(), unknown), {}};
}

// ---- Planning

/// One line of the plan to come.
struct Wish {
  std::string input;  ///< as it was named
  std::string name;   ///< empty: by the input
  std::vector<std::string> options;
  bool found = false;  ///< in a folder or by a pattern: of six faces one stands for all
  bool typed = false;  ///< on the command line: what no run could read is refused
};

void add_input(const std::string& word, const std::vector<std::string>& options, std::vector<Wish>& wishes) {
  std::error_code unknown;
  const fs::path path = platform::path_of(word);
  const bool is_there = fs::exists(path, unknown);
  const auto add = [&](const std::vector<fs::path>& files, const fs::path& below) {
    if (files.empty()) {
      throw Error(ErrorCode::invalid_argument, printable(word) + ": there are no pictures that Welkin reads");
    }
    for (const fs::path& file : files) {
      const fs::path name = below.empty() ? file.filename() : file.lexically_relative(below);
      wishes.push_back(
          {.input = platform::utf8(file), .name = platform::utf8(name), .options = options, .found = true});
    }
  };
  if (is_there && fs::is_directory(path, unknown)) {
    add(pictures_below(path), path);
  } else if (!is_there && is_pattern(word)) {
    add(files_that_fit(word), {});
  } else {
    wishes.push_back({.input = word, .name = "", .options = options, .typed = true});
  }
}

/// The options of all jobs with those of a line, which most lines share.
class LineOptions {
 public:
  explicit LineOptions(const std::vector<std::string>& all) : all_(all) {}

  /// Throws `Error` (invalid_argument) for what no bake could be asked.
  const std::vector<std::string>& with(const std::vector<std::string>& own) {
    const auto found = known_.find(own);
    if (found != known_.end()) return found->second;
    std::vector<std::string> words = with_own(all_, own);
    static_cast<void>(bake_options_of({}, words));
    return known_.emplace(own, std::move(words)).first->second;
  }

 private:
  const std::vector<std::string>& all_;
  std::map<std::vector<std::string>, std::vector<std::string>> known_;
};

/// C++ strings go on behind it, and names of files end there.
void refuse_nul(const std::string& text, const std::string& where) {
  if (text.find('\0') != std::string::npos) throw Flaw{where + " has a character NUL"};
}

Wish wish_in(const std::string& line, const fs::path& list, LineOptions& options) {
  Wish wish;
  std::vector<std::string> own;
  const auto add_word = [&](const Json& value, const std::string& where) {
    text("", own.emplace_back()).read(value, where);
  };
  read_object(parse_json(line), "the line",
              {text("input", wish.input),
               text("name", wish.name),
               {"options", [&](const Json& value, const std::string& where) { read_list(value, where, add_word); }}});
  if (wish.input.empty()) throw Flaw{"there is no \"input\""};
  refuse_nul(wish.input, "\"input\"");
  refuse_nul(wish.name, "\"name\"");
  // What a list names lies beside it.
  const auto beside = [&](const std::string& path) {
    return platform::utf8(list.parent_path() / platform::path_of(path));
  };
  wish.options = options.with(with_files(own, beside));
  wish.input = beside(wish.input);
  return wish;
}

void add_list(const fs::path& list, const std::vector<std::string>& options, std::vector<Wish>& wishes) {
  LineOptions known(options);
  for_each_line(list, [&](std::size_t number, const std::string& line) {
    if (line.find_first_not_of(" \t\r") == std::string::npos) return;
    const std::string where = platform::utf8(list) + ": line " + std::to_string(number) + ": ";
    try {
      wishes.push_back(wish_in(line, list, known));
    } catch (const Flaw& flaw) {
      throw Error(ErrorCode::invalid_argument, where + flaw.message +
                                                   "; a line is {\"input\": PATH, \"name\": NAME, \"options\": "
                                                   "[\"--size\", \"128\"]}");
    } catch (const Error& error) {
      throw Error(error.code(), where + error.what());
    }
  });
}

/// Returns the name, with a number where it is taken. `taken`: of each name the number that is to be tried next.
std::string numbered(const std::string& name, std::map<std::string, int>& taken) {
  if (taken.emplace(name, 2).second) return name;
  std::string unique;
  do unique = name + '-' + std::to_string(taken.at(name)++);
  while (!taken.emplace(unique, 2).second);
  return unique;
}

/// Returns the name without its ending, with a number where another job has it.
std::string unique_name(const Wish& wish, std::map<std::string, int>& taken) {
  std::string name = wish.name;
  if (name.empty()) name = platform::utf8(platform::path_of(wish.input).filename());
  const bool said = !wish.found && !wish.name.empty();
  if (!said && is_picture_name(platform::path_of(name))) name.resize(name.rfind('.'));
  return numbered(name.empty() ? "input" : name, taken);
}

/// Plans wishes one by one.
class Planner {
 public:
  explicit Planner(BatchPlan& plan) : plan_(plan) {}

  void add(const Wish& wish) {
    const BakeCommandOptions& whole = options_of(wish.options);
    BatchJob job;
    job.input = relative_to(plan_.folder, platform::path_of(wish.input));
    job.options = with_files(
        wish.options, [&](const std::string& file) { return relative_to(plan_.folder, platform::path_of(file)); });
    BakeCommandOptions options = whole;
    options.input = wish.input;
    try {
      if (is_stream(wish.input)) {
        throw Error(ErrorCode::unsupported_file,
                    printable(wish.input) + ": is read once only, as a pipe; a batch wants files");
      }
      if (platform::utf8(platform::path_of(wish.input)) != wish.input) {
        throw Error(ErrorCode::unsupported_file,
                    printable(wish.input) + ": a plan names no file whose name is not UTF-8");
      }
      const Prediction prediction = predict(options);
      if (wish.found && is_known_face(wish, prediction.info)) return;
      job.seconds = seconds_of_job(prediction, options);
      job.memory = prediction.most_bytes + prediction.result_bytes / 2 + kBytesOfAJob;
      std::error_code unknown;
      const auto size = fs::file_size(platform::path_of(wish.input), unknown);
      job.size = unknown ? 0 : static_cast<std::uint64_t>(size);
    } catch (const Error& error) {
      job.error = error.what();
      const bool is_hopeless = error.code() == ErrorCode::file_access || error.code() == ErrorCode::unsupported_file;
      if (wish.typed && is_hopeless) refused_.push_back(job.error);
    }
    job.name = unique_name(wish, names_);
    plan_.jobs.push_back(std::move(job));
  }

  /// After all are added. Throws `Error` (file_access) for inputs of the command line that are not there or that no run
  /// could read: most often their names are mistyped.
  void refuse_hopeless() const {
    if (refused_.empty()) return;
    std::string message =
        "batch plan: " + counted(refused_.size(), "input") + " cannot be read, so no plan was written";
    constexpr std::size_t kShown = 10;
    for (std::size_t i = 0; i < std::min(kShown, refused_.size()); ++i) message += '\n' + refused_[i];
    if (refused_.size() > kShown) message += "\n...";
    throw Error(ErrorCode::file_access, message);
  }

 private:
  /// Read once for many jobs. Here files that options name are where the command runs.
  const BakeCommandOptions& options_of(const std::vector<std::string>& words) {
    const auto found = known_.find(words);
    if (found != known_.end()) return found->second;
    return known_.emplace(words, bake_options_of({}, words)).first->second;
  }

  /// Whether this is one of six files that another job reads as a whole.
  bool is_known_face(const Wish& wish, const EnvironmentInfo& info) {
    if (info.layout != Layout::six_files) return false;
    std::string all;
    for (const auto& face : info.faces) all += platform::utf8(face) + '\n';
    for (const std::string& word : wish.options) all += word + '\0';
    return !faces_.insert(all).second;
  }

  BatchPlan& plan_;
  std::vector<std::string> refused_;
  std::map<std::string, int> names_;
  std::set<std::string> faces_;
  std::map<std::vector<std::string>, BakeCommandOptions> known_;
};

// ---- The file

Json job_json(const BatchJob& job) {
  Json json = {{"name", job.name},       {"input", job.input}, {"options", job.options},
               {"seconds", job.seconds}, {"size", job.size},   {"memory", job.memory}};
  if (!job.error.empty()) json["error"] = job.error;
  return json;
}

std::uint64_t bytes_in(double value, const std::string& where) {
  if (!(value >= 0.0 && value <= kMostBytes)) throw Flaw{where + " has a number of bytes that cannot be"};
  return static_cast<std::uint64_t>(value);
}

BatchJob job_in(const Json& value, const std::string& where) {
  BatchJob job;
  double size = 0.0;
  double memory = 0.0;
  const auto add_word = [&](const Json& word, const std::string& place) {
    text("", job.options.emplace_back()).read(word, place);
  };
  read_object(value, where,
              {text("name", job.name),
               text("input", job.input),
               {"options", [&](const Json& list, const std::string& place) { read_list(list, place, add_word); }},
               number("seconds", job.seconds),
               number("size", size),
               number("memory", memory),
               text("error", job.error)});
  if (job.name.empty() || job.input.empty()) throw Flaw{where + " has no name or no input"};
  refuse_nul(job.name, where + ".name");
  refuse_nul(job.input, where + ".input");
  if (!(job.seconds >= 0.0 && job.seconds <= kMostSeconds)) throw Flaw{where + ".seconds cannot be"};
  job.size = bytes_in(size, where);
  job.memory = bytes_in(memory, where);
  return job;
}

/// Throws `Flaw`.
void check_head(const std::string& schema, int version) {
  if (schema != kSchema) throw Flaw{"is no plan that 'welkin batch plan' has written"};
  if (version != kVersion) {
    throw Flaw{"has version " + std::to_string(version) + ", and this Welkin reads " + std::to_string(kVersion) +
               "; plan again"};
  }
}

/// Nothing of anybody else's is lost, and no header is read for a plan that cannot be written.
void require_place(const BatchPlan& plan) {
  std::error_code unknown;
  require_own(plan.file, kSchema, "batch plan");
  if (fs::is_directory(plan.folder, unknown)) return;
  throw Error(ErrorCode::file_access, platform::utf8(plan.file) + ": there is no such folder to write it to");
}

void ignore(const Json& /*value*/, const std::string& /*where*/) {}

/// Throws `Flaw`.
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
               {"totals", ignore}});
  check_head(schema, version);
  if (list == nullptr) throw Flaw{"has no jobs"};
  std::vector<BatchJob> jobs;
  std::set<std::string> names;
  const auto add = [&](const Json& value, const std::string& where) {
    jobs.push_back(job_in(value, where));
    if (!names.insert(jobs.back().name).second) throw Flaw{where + ".name is that of another job, too"};
  };
  read_list(*list, "jobs", add, kMostJobs);
  return jobs;
}

}  // namespace

double BatchPlan::seconds() const noexcept {
  return std::accumulate(jobs.begin(), jobs.end(), 0.0,
                         [](double sum, const BatchJob& job) { return sum + job.seconds; });
}

fs::path BatchPlan::place(const std::string& path) const {
  return (folder / platform::path_of(path)).lexically_normal();
}

fs::path BatchPlan::default_results() const {
  fs::path results = file;
  return results.replace_extension(".results");
}

BatchPlan plan_batch(const BatchRequest& request, const fs::path& file) {
  static_cast<void>(bake_options_of({}, request.options));  // which are wrong even if there is no input
  std::vector<Wish> wishes;
  for (const std::string& word : request.inputs) add_input(word, request.options, wishes);
  if (request.list) add_list(platform::path_of(*request.list), request.options, wishes);
  if (wishes.empty()) {
    throw Error(ErrorCode::invalid_argument,
                "batch plan: there is nothing to do; name pictures, folders of them, or a "
                "--list");
  }
  BatchPlan plan = plan_at(file);
  require_place(plan);
  Planner planner(plan);
  for (const Wish& wish : wishes) planner.add(wish);
  planner.refuse_hopeless();
  return plan;
}

std::vector<std::string> file_names_of(const BatchPlan& plan) {
  constexpr std::string_view kElsewhere = "/\\:*?\"<>|";
  constexpr unsigned char kFirstPrintable = 0x20;
  std::vector<std::string> names;
  std::map<std::string, int> taken;
  for (const BatchJob& job : plan.jobs) {
    std::string name = job.name;
    for (char& c : name) {
      if (static_cast<unsigned char>(c) < kFirstPrintable || kElsewhere.find(c) != std::string_view::npos) c = '_';
    }
    if (name.empty() || name.front() == '.') name.insert(0, 1, '_');
    names.push_back(numbered(name, taken));
  }
  return names;
}

void write_batch_plan(const BatchPlan& plan) {
  Json jobs = Json::array();
  std::uint64_t size = 0;
  std::size_t errors = 0;
  for (const BatchJob& job : plan.jobs) {
    jobs.push_back(job_json(job));
    size += job.size;
    errors += job.error.empty() ? 0 : 1;
  }
  const Json json = {
      {"schema", kSchema},
      {"version", kVersion},
      {"welkin", WELKIN_VERSION_STRING},
      {"totals", {{"jobs", plan.jobs.size()}, {"seconds", plan.seconds()}, {"size", size}, {"errors", errors}}},
      {"jobs", jobs}};
  write_text_file(plan.file, json_text(json));
}

BatchPlan read_batch_plan(const fs::path& file) {
  try {
    BatchPlan plan = plan_at(file);
    plan.jobs = jobs_in(read_json_file(file, "'welkin batch plan INPUT... -o jobs.json' writes one", kMostPlanBytes));
    return plan;
  } catch (const Flaw& flaw) {
    throw Error(ErrorCode::corrupt_file, platform::utf8(file) + ": " + flaw.message);
  }
}

BakeCommandOptions bake_options_of(const BatchPlan& plan, const std::vector<std::string>& words) {
  BakeCommandOptions options;
  const Options table = job_options(options);
  const auto placed = [&](const std::string& path) {
    const fs::path place = plan.place(path);
    std::error_code unknown;
    if (fs::exists(place, unknown) && !fs::is_regular_file(place, unknown)) {
      throw Error(ErrorCode::file_access,
                  platform::utf8(place) + ": is not a regular file; a batch reads the files of its options many times");
    }
    return platform::utf8(place);
  };
  read_options(table, with_files(words, placed));
  settle_files(options);
  static_cast<void>(library_options(options));
  options.called = "environment";
  return options;
}

std::vector<std::vector<std::size_t>> cut_batch(const BatchPlan& plan, int shards) {
  std::vector<std::size_t> order(plan.jobs.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::ranges::stable_sort(
      order, [&](std::size_t one, std::size_t other) { return plan.jobs[one].seconds > plan.jobs[other].seconds; });
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
