// `welkin importance`: tables by which a path tracer picks directions, as .npy files with a JSON file that describes
// them.
#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

#include "embedded_texts.h"
#include "platform/text.h"
#include "tools/bake_manifest.h"
#include "tools/commands.h"
#include "tools/input.h"
#include "tools/json.h"
#include "tools/terminal.h"
#include "tools/text.h"
#include "welkin/core.h"
#include "welkin/environment_file.h"
#include "welkin/importance.h"
#include "welkin/resampling.h"

namespace welkin::tool {
namespace {

constexpr const char* kTableName = "importance.json";

/// Returns the names of all tables that may be written.
std::vector<std::string> table_names(bool alias, bool pyramid) {
  std::vector<std::string> names = {"function.npy", "row_cdf.npy", "column_cdf.npy"};
  if (alias) names.insert(names.end(), {"alias_rows.npy", "alias_columns.npy"});
  constexpr int kMaxLevels = 17;  // from 65536 texels down to 1
  for (int level = 0; pyramid && level < kMaxLevels; ++level) {
    names.push_back("pyramid_" + std::to_string(level) + ".npy");
  }
  return names;
}

bool is_table_name(std::string_view name) {
  const std::vector<std::string> names = table_names(true, true);
  return std::ranges::find(names, name) != names.end();
}

constexpr FileSet kTableFiles{"importance", kTableName, is_table_name};

struct ImportanceCommandOptions {
  CommonOptions common;
  std::string input;
  std::string directory;
  ImportanceOptions table;
  ClampChoice clamp;
  bool alias = false;
  bool pyramid = false;
};

/// Returns a NumPy file, version 1.0: little-endian, rows first. `type`: "<f4", or a list of fields.
std::vector<std::byte> npy_bytes(const std::string& type, const std::vector<std::size_t>& shape,
                                 std::span<const std::byte> values) {
  static_assert(std::endian::native == std::endian::little);
  std::string dimensions;
  for (const std::size_t count : shape) dimensions += std::to_string(count) + ", ";
  if (shape.size() > 1) dimensions.resize(dimensions.size() - 2);
  std::string header = "{'descr': " + type + ", 'fortran_order': False, 'shape': (" + dimensions + "), }";
  constexpr std::size_t kBefore = 10;
  constexpr std::size_t kAlignment = 64;
  const std::size_t whole = (kBefore + header.size() + 1 + kAlignment - 1) / kAlignment * kAlignment;
  header.resize(whole - kBefore - 1, ' ');
  header += '\n';
  std::string text("\x93NUMPY\x01\x00", 8);
  text += static_cast<char>(header.size() & 0xFFU);
  text += static_cast<char>(header.size() >> 8U);
  text += header;
  const auto start = std::as_bytes(std::span(text));
  std::vector<std::byte> file(start.begin(), start.end());
  file.insert(file.end(), values.begin(), values.end());
  return file;
}

/// Writes a table, and notes its shape.
template <class Value>
void write_table(const std::string& name, const std::vector<std::size_t>& shape, const std::vector<Value>& values,
                 OutputFolder& folder) {
  constexpr bool kIsFloats = std::is_same_v<Value, float>;
  static_assert(kIsFloats || (std::is_same_v<Value, AliasEntry> && sizeof(AliasEntry) == 8));
  const char* const type = kIsFloats ? "'<f4'" : "[('own', '<f4'), ('other', '<u4')]";
  write_bytes(folder.place(name), npy_bytes(type, shape, std::as_bytes(std::span(values))));
  folder.add({name, "", "", shape});
}

constexpr std::array kWeights{"luminance", "mean", "largest"};

const char* word_of(ImportanceWeight weight) { return kWeights.at(static_cast<std::size_t>(weight)); }

Json table_file_json(const WrittenFile& file) {
  return {{"name", file.name}, {"shape", file.details}, {"bytes", file.bytes}};
}

std::size_t count_of(int number) { return static_cast<std::size_t>(number); }

std::string make(const ImportanceCommandOptions& options, const Control& control) {
  const std::filesystem::path directory = platform::path_of(options.directory);
  std::vector<std::string> names = table_names(options.alias, options.pyramid);
  names.insert(names.begin(), kTableName);
  check_output_folder(directory);
  OwnFiles(directory, kTableFiles).require(names);
  const FileInput input = input_of(options.input, options.common.read);
  begin_stage("read");
  const Environment source = read_environment(input, options.common.read, part_of(control, 0.0, 0.4));
  LatLongImage rotated;
  if (const int face = source.face_size(); face > 0) {
    rotated = to_lat_long(source.cubemap(), 4 * face, 2 * face, dmat3(1.0), ResampleFilter::area, {control.stop, {}});
  }
  const LatLongView view = source.face_size() > 0 ? rotated.view() : source.lat_long();
  begin_stage("tables");
  ImportanceOptions wanted = options.table;
  options.clamp.apply(wanted.pixels);
  const ImportanceTable table = importance_table(view, wanted, part_of(control, 0.4, 0.6));
  const ImportanceVariance variance =
      importance_variance(view, table, wanted.weight, wanted.pixels, part_of(control, 0.6, 0.8));
  begin_stage("write");
  OutputFolder folder(directory, names, {control.stop, {}}, kTableFiles);
  const std::size_t width = count_of(table.width);
  const std::size_t height = count_of(table.height);
  write_table("function.npy", {height, width}, table.function, folder);
  write_table("row_cdf.npy", {height + 1}, table.row_cdf, folder);
  write_table("column_cdf.npy", {height, width + 1}, table.column_cdf, folder);
  if (options.alias) {
    const AliasTable alias = alias_table(table, {control.stop, {}});
    write_table("alias_rows.npy", {height}, alias.rows, folder);
    write_table("alias_columns.npy", {height, width}, alias.columns, folder);
  }
  if (options.pyramid) {
    const ImportancePyramid pyramid = importance_pyramid(table, {control.stop, {}});
    for (std::size_t level = 0; level < pyramid.levels.size(); ++level) {
      const ImportancePyramid::Level& each = pyramid.levels[level];
      write_table("pyramid_" + std::to_string(level) + ".npy", {count_of(each.height), count_of(each.width)},
                  each.probabilities, folder);
    }
  }
  const Json report = {{"welkin", WELKIN_VERSION_STRING},
                       {"source", portable_path(options.input)},
                       {"width", table.width},
                       {"height", table.height},
                       {"weight", word_of(wanted.weight)},
                       {"mis_compensation", wanted.mis_compensation},
                       {"integral", table.integral},
                       {"variance", {{"uniform", variance.uniform}, {"table", variance.table}}},
                       {"directions",
                        "column i of width, row j of height: longitude pi - 2 pi i / width, latitude pi / 2 - pi j / "
                        "height; (sin lon cos lat, sin lat, cos lon cos lat); uniform in solid angle within a texel"},
                       {"files", json_list(folder.files(), table_file_json)}};
  const std::string text = json_text(report);
  const std::vector<std::string> remarks = folder.finish(text, {platform::path_of(options.input)});
  if (options.common.json) return text;
  std::string notes;
  for (const std::string& remark : remarks) notes += "note: " + remark + '\n';
  return printable(platform::utf8(folder.path())) + ": tables of " + std::to_string(table.width) + " x " +
         std::to_string(table.height) + " texels, by " + word_of(wanted.weight) +
         "\n  variance of one sample over the total's square: uniform directions " + significant(variance.uniform, 4) +
         ", the table " + significant(variance.table, 4) + '\n' + notes;
}

void run(const ImportanceCommandOptions& options) {
  const std::string text = with_bar(options.common, [&](const Control& control) { return make(options, control); });
  options.common.json ? print_result(text) : print_summary(text);
}

}  // namespace

Command importance_command() {
  const auto options = std::make_shared<ImportanceCommandOptions>();
  constexpr int kLargest = 65536;
  Command command{"importance", "Make tables for the importance sampling of path tracers",
                  embedded_text("help/importance.txt")};
  Options& table = command.options;
  add_option(table, "INPUT", &options->input, "", input_text(false), {.required = true});
  add_option(table, "-o,--output", &options->directory, "DIR",
             "The folder to write to, made if it is not there; default the input's name without its extension and "
             "_importance, here. A folder of that name with other files is left alone");
  add_json_option(table, options->common);
  in_group(table, "Input and output");
  add_option(table, "--width", &options->table.width, "N",
             "Width of the table, at most the input's; default the input's", {.bounds = whole_between(1, kLargest)});
  add_option(table, "--height", &options->table.height, "N",
             "Height of the table, at most the input's; default the input's", {.bounds = whole_between(1, kLargest)});
  table.push_back(choice<ImportanceWeight>(
      "--weight", options->table.weight, by_order<ImportanceWeight>(kWeights),
      "Weight of a texel: its luminance, or the mean or largest of its channels; default luminance"));
  add_option(table, "--mis-compensation", &options->table.mis_compensation, "",
             "Subtract the mean, for estimators that also sample the material");
  add_option(table, "--alias", &options->alias, "", "Also write alias tables");
  add_option(table, "--pyramid", &options->pyramid, "", "Also write probabilities of blocks by powers of two");
  in_group(table, "Tables");
  add_pixel_options(table, options->table.pixels, options->clamp);
  add_read_options(table, options->common, "");
  add_threads_option(table, options->common);
  command.everyday = {"INPUT",   "--output",           "--json",    "--width",   "--height", "--weight",
                      "--alias", "--mis-compensation", "--pyramid", "--threads", "--quiet"};
  command.run = [options, name = command.name](const Given& given) {
    if (!given("--output")) {
      options->directory = default_output_name(options->input) + "_importance";
      require_own_folder(platform::path_of(options->directory), kTableName, name);
    }
    run(*options);
  };
  return command;
}

}  // namespace welkin::tool
