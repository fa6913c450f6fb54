// `welkin bake` for a person.
#include <algorithm>

#include "tools/bake_manifest.h"
#include "tools/number_text.h"
#include "tools/printable_text.h"
#include "tools/sun_options.h"

namespace welkin::tool {
namespace {

std::string size_text(std::uint64_t bytes) {
  constexpr double kKibi = 1024.0;
  const double kibibytes = static_cast<double>(bytes) / kKibi;
  return kibibytes < kKibi ? significant(kibibytes, 3) + " KiB" : significant(kibibytes / kKibi, 3) + " MiB";
}

std::string file_lines(const OutputFolder& folder) {
  std::size_t name_width = 0;
  std::size_t format_width = 0;
  for (const WrittenFile& file : folder.files()) {
    name_width = std::max(name_width, file.name.size());
    format_width = std::max(format_width, file.format.size());
  }
  std::string text;
  for (const WrittenFile& file : folder.files()) {
    text += "  " + pad_right(file.name, name_width + 2) + pad_right(file.format, format_width + 2) +
            pad_left(size_text(file.bytes), 9) + '\n';
  }
  return text + "  " + kManifestName + '\n';
}

std::string mip_lines(const std::vector<MipRecord>& mips) {
  std::string text = "\nSpecular mips\n  mip  size  roughness  made by    bands  texels apart  largest error, about\n";
  for (std::size_t number = 0; number < mips.size(); ++number) {
    const MipRecord& mip = mips[number];
    text += pad_left(std::to_string(number), 5) + pad_left(std::to_string(mip.size), 6) +
            pad_left(significant(mip.roughness, 4), 11) + "  " + pad_right(mip.method, 10) +
            pad_left(mip.bands > 0 ? std::to_string(mip.bands) : "-", 6) +
            pad_left(mip.bright_texels > 0 ? std::to_string(mip.bright_texels) : "-", 14) +
            pad_left(significant(mip.error_estimate, 2), 22) + '\n';
  }
  return text;
}

/// Of the library's bake, and the .env's chain beside it.
std::vector<PassRecord> measured_passes(const Baked& baked) {
  std::vector<PassRecord> passes = baked.light.diagnostics.passes;
  for (const PassRecord& pass : baked.passes) {
    const auto planned = std::ranges::find(baked.plan.passes, pass.name, &PlannedPass::name);
    const auto known = std::ranges::find(passes, pass.name, &PassRecord::name);
    if (planned != baked.plan.passes.end() && known == passes.end()) passes.push_back(pass);
  }
  return passes;
}

std::string time_lines(const Baked& baked) {
  std::string text = "\nTimes\n";
  for (const auto* passes : {&baked.passes, &baked.light.diagnostics.passes}) {
    for (const PassRecord& pass : *passes) {
      text += std::string(passes == &baked.passes ? "  " : "    ") + pad_right(pass.name, 26) +
              (pass.action == "run" ? duration(pass.milliseconds) : pass.action + ": " + pass.reason) + '\n';
    }
  }
  return text;
}

}  // namespace

std::string bake_table(const Baked& baked, const BakeCommandOptions& options, const OutputFolder& folder) {
  const Source& source = baked.source;
  std::string text = printable(source.path) + ": " + std::to_string(source.width) + " x " +
                     std::to_string(source.height) + ' ' + source.layout + ", " + printable(source.format) + '\n';
  text += printable(folder.path().string()) + ", axes " + axes_text(options.turn) + '\n' + file_lines(folder);
  if (baked.light.specular) text += mip_lines(baked.light.specular->mips);
  if (baked.sun_wanted) {
    std::optional<Sun> sun = baked.sun;
    TurnOptions to_engine;
    to_engine.to = options.turn.to;
    if (sun) sun->direction = turn_of_light(to_engine, false) * sun->direction;
    text += '\n' + sun_text(sun, convention(options.turn.to).from_welkin[1].z > 0.5);
  }
  text += time_lines(baked);
  if (options.scene.explains()) text += '\n' + plan_text(baked.plan, measured_passes(baked));
  for (const std::string& note : bake_notes(baked, folder)) text += "note: " + printable(note) + '\n';
  return text;
}

}  // namespace welkin::tool
