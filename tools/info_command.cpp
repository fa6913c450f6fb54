// `welkin info`: describes an environment file.
#include <memory>
#include <string>
#include <string_view>

#include "embedded_texts.h"
#include "platform/text.h"
#include "tools/commands.h"
#include "tools/input.h"
#include "tools/json.h"
#include "tools/terminal.h"
#include "tools/text.h"
#include "welkin/core.h"
#include "welkin/environment_file.h"

namespace welkin::tool {
namespace {

/// The findings, before they are printed as text or JSON.
struct InfoReport {
  EnvironmentInfo file;
  EnvironmentStatistics pixels;
};

// JSON. Members are only ever added: programs read this.

Json source_json(const EnvironmentInfo& file) {
  return {{"path", platform::utf8(file.path)},
          {"layout", name(file.layout)},
          {"width", file.width},
          {"height", file.height},
          {"format", file.format_description()},
          {"notes", file.notes}};
}

Json storage_json(const EnvironmentInfo& file) {
  const Json levels = json_list(file.levels, [](const LevelInfo& level) -> Json {
    return {level.width, level.height};
  });
  Json json = {{"compression", file.compression},
               {"storage", file.storage},
               {"layout_reason", file.layout_reason},
               {"levels", levels},
               {"parts", file.parts},
               {"layers", file.layers}};
  if (file.layout == Layout::six_files) {
    json["faces"] = json_list(file.faces, [](const std::filesystem::path& face) { return platform::utf8(face); });
  }
  return json;
}

Json channels_json(const EnvironmentInfo& file) {
  return json_list(file.channels, [](const ChannelInfo& channel) -> Json {
    return {{"name", channel.name}, {"type", name(channel.type)}};
  });
}

Json pixels_json(const EnvironmentStatistics& pixels) {
  return {{"texels", pixels.texels},
          {"minimum", json_triple(pixels.minimum)},
          {"mean", json_triple(pixels.mean)},
          {"maximum", json_triple(pixels.maximum)},
          {"total_radiance", json_triple(pixels.total_radiance)},
          {"nans", pixels.nans},
          {"infinities", pixels.infinities},
          {"negatives", pixels.negatives}};
}

Json brightest_json(const EnvironmentStatistics& pixels) {
  return {{"column", pixels.brightest_column},
          {"row", pixels.brightest_row},
          {"radiance", json_triple(pixels.brightest)},
          {"direction", json_triple(pixels.brightest_direction)}};
}

std::string info_json(const InfoReport& report) {
  return json_text({{"source", source_json(report.file)},
                    {"file", storage_json(report.file)},
                    {"channels", channels_json(report.file)},
                    {"pixels", pixels_json(report.pixels)},
                    {"brightest", brightest_json(report.pixels)}});
}

// For a person.

std::string line(std::string_view label, const std::string& text) { return "  " + pad_right(label, 12) + text + '\n'; }

std::string channels_text(const EnvironmentInfo& file) {
  return listed(file.channels,
                [](const ChannelInfo& channel) { return printable(channel.name) + ' ' + name(channel.type); });
}

std::string levels_text(const EnvironmentInfo& file) {
  const LevelInfo& last = file.levels.back();
  return std::to_string(file.levels.size()) + ", down to " + std::to_string(last.width) + " x " +
         std::to_string(last.height) + " (--level)";
}

// Returns lines about properties that few files have.
std::string further_lines(const EnvironmentInfo& file) {
  std::string text;
  if (file.levels.size() > 1) text += line("mip levels", levels_text(file));
  if (!file.parts.empty()) text += line("parts", listed(file.parts, printable) + " (--part)");
  if (!file.layers.empty()) text += line("layers", listed(file.layers, printable) + " (--layer)");
  if (file.layout == Layout::six_files) {
    for (const std::filesystem::path& face : file.faces) text += line("", printable(platform::utf8(face.filename())));
  }
  for (const std::string& note : file.notes) text += line("note", printable(note));
  return text;
}

std::string file_lines(const EnvironmentInfo& file) {
  const std::string compression = file.compression == "none" ? "not compressed" : file.compression + " compression";
  return printable(platform::utf8(file.path)) + '\n' +
         line("size", std::to_string(file.width) + " x " + std::to_string(file.height)) +
         line("layout", std::string(name(file.layout)) + " (" + file.layout_reason + ")") +
         line("format", file.format_description() + ", " + file.storage + ", " + compression) +
         line("channels", channels_text(file)) + further_lines(file);
}

std::string cells(const glm::dvec3& rgb) {
  constexpr std::size_t kWidth = 14;
  return pad_left(significant(rgb.x), kWidth) + pad_left(significant(rgb.y), kWidth) +
         pad_left(significant(rgb.z), kWidth);
}

std::string range_lines(const EnvironmentStatistics& pixels) {
  return "\n" + line("", "             r             g             b") + line("minimum", cells(pixels.minimum)) +
         line("maximum", cells(pixels.maximum)) + line("mean", cells(pixels.mean) + "   weighted by solid angle") +
         line("total", cells(pixels.total_radiance) + "   integral of radiance over the sphere");
}

std::string odd_values_text(const EnvironmentStatistics& pixels) {
  if (pixels.nans + pixels.infinities + pixels.negatives == 0) return "no NaN, infinities or negative values";
  return counted({{pixels.nans, "NaN"}, {pixels.infinities, "infinite value"}, {pixels.negatives, "negative value"}}) +
         " of " + grouped(3 * pixels.texels);
}

std::string position_text(const InfoReport& report) {
  const EnvironmentStatistics& pixels = report.pixels;
  const std::string position =
      "column " + std::to_string(pixels.brightest_column) + ", row " + std::to_string(pixels.brightest_row);
  if (report.file.layout != Layout::vertical_strip && report.file.layout != Layout::six_files) return position;
  const int face = pixels.brightest_row / report.file.width;
  return position + " (face " + face_name(face) + ", row " + std::to_string(pixels.brightest_row % report.file.width) +
         ")";
}

std::string info_table(const InfoReport& report) {
  return file_lines(report.file) + range_lines(report.pixels) + '\n' + line("special", odd_values_text(report.pixels)) +
         line("brightest", significant(report.pixels.brightest)) + line("", position_text(report)) +
         line("", direction_text(report.pixels.brightest_direction)) +
         "\n  Directions: y is up; the centre of a lat-long looks along +z, and +x lies a\n  quarter of the width from "
         "the "
         "left.\n";
}

// The command.

struct InfoOptions {
  CommonOptions common;
  std::string file;
};

std::string described(const InfoOptions& options, const Control& control) {
  begin_stage("read and measure");
  const FileInput input = input_of(options.file, options.common.read);
  const InfoReport report{inspect_environment(input, options.common.read),
                          measure_environment(input, options.common.read, control)};
  return options.common.json ? info_json(report) : info_table(report);
}

}  // namespace

Command info_command() {
  const auto options = std::make_shared<InfoOptions>();
  Command command{"info", "Describe an environment file", embedded_text("help/info.txt")};
  add_option(command.options, "FILE", &options->file, "", input_text(true), {.required = true});
  add_json_option(command.options, options->common);
  in_group(command.options, "Input and output");
  add_read_options(command.options, options->common, "");
  add_threads_option(command.options, options->common);
  command.run = [options](const Given& /*given*/) {
    print_result(with_bar(options->common, [&](const Control& control) { return described(*options, control); }));
  };
  return command;
}

}  // namespace welkin::tool
