// `welkin info` for a person.
#include <string_view>

#include "tools/direction_text.h"
#include "tools/info_report.h"
#include "tools/number_text.h"
#include "tools/printable_text.h"

namespace welkin::tool {
namespace {

std::string line(std::string_view label, const std::string& text) { return "  " + pad_right(label, 12) + text + '\n'; }

std::string channels_text(const EnvironmentInfo& file) {
  std::string text;
  for (const ChannelInfo& channel : file.channels) {
    if (!text.empty()) text += ", ";
    text += printable(channel.name) + ' ' + channel.type;
  }
  return text;
}

std::string list_text(const std::vector<std::string>& names) {
  std::string text;
  for (const std::string& name : names) text += (text.empty() ? "" : ", ") + printable(name);
  return text;
}

std::string levels_text(const EnvironmentInfo& file) {
  const LevelInfo& last = file.levels.back();
  return std::to_string(file.levels.size()) + ", down to " + std::to_string(last.width) + " x " +
         std::to_string(last.height) + " (--level)";
}

// What few files have.
std::string further_lines(const EnvironmentInfo& file) {
  std::string text;
  if (file.levels.size() > 1) text += line("mip levels", levels_text(file));
  if (!file.parts.empty()) text += line("parts", list_text(file.parts) + " (--part)");
  if (!file.layers.empty()) text += line("layers", list_text(file.layers) + " (--layer)");
  if (file.layout == Layout::six_files) {
    for (const std::filesystem::path& face : file.faces) text += line("", face.filename().string());
  }
  for (const std::string& note : file.notes) text += line("note", printable(note));
  return text;
}

std::string file_lines(const EnvironmentInfo& file) {
  const std::string compression = file.compression == "none" ? "not compressed" : file.compression + " compression";
  return file.path.string() + '\n' + line("size", std::to_string(file.width) + " x " + std::to_string(file.height)) +
         line("layout", std::string(name(file.layout)) + " (" + file.layout_reason + ")") +
         line("format", file.format + ", " + file.storage + ", " + compression) +
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
         line("flux", cells(pixels.flux) + "   integral over the sphere");
}

std::string odd_values_text(const EnvironmentStatistics& pixels) {
  if (pixels.nans + pixels.infinities + pixels.negatives == 0) return "no NaN, no infinity, nothing negative";
  return counted({{pixels.nans, "NaN"}, {pixels.infinities, "infinite value"}, {pixels.negatives, "negative value"}}) +
         " of " + grouped(3 * pixels.texels);
}

std::string place_text(const InfoReport& report) {
  const EnvironmentStatistics& pixels = report.pixels;
  const std::string place =
      "column " + std::to_string(pixels.brightest_column) + ", row " + std::to_string(pixels.brightest_row);
  if (report.file.layout != Layout::vertical_strip && report.file.layout != Layout::six_files) return place;
  const int face = pixels.brightest_row / report.file.width;
  return place + " (face " + face_name(face) + ", row " + std::to_string(pixels.brightest_row % report.file.width) +
         ")";
}

}  // namespace

std::string info_table(const InfoReport& report) {
  return file_lines(report.file) + range_lines(report.pixels) + '\n' +
         line("odd values", odd_values_text(report.pixels)) + line("brightest", significant(report.pixels.brightest)) +
         line("", place_text(report)) + line("", direction_text(report.pixels.brightest_direction)) +
         "\n  Directions: y is up; the centre of a lat-long looks along +z, and +x lies a\n  quarter in from the "
         "left.\n";
}

}  // namespace welkin::tool
