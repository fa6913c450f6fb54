// `welkin check`: measures the error of any chain against its source, and reports what is wrong with it.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <filesystem>
#include <glm/vec3.hpp>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "embedded_texts.h"
#include "image/geometry.h"
#include "platform/text.h"
#include "tools/bake_options.h"
#include "tools/chain_check.h"
#include "tools/commands.h"
#include "tools/input.h"
#include "tools/json.h"
#include "tools/preview_light.h"
#include "tools/terminal.h"
#include "tools/text.h"
#include "welkin/bake_file.h"
#include "welkin/core.h"
#include "welkin/environment_file.h"
#include "welkin/image.h"
#include "welkin/reflections.h"

namespace welkin::tool {
namespace {

struct CheckOptions {
  CommonOptions common;
  std::string chain;
  std::string source;
  RoughnessChoice roughness;
  int mips = 0;  ///< 0: all
  double error = 0.0;
  std::string image;
  PixelPolicy pixels;
  ClampChoice clamp;
};

/// A chain as it was read.
struct ChainFile {
  std::string words;  ///< description for a person
  ChainMips mips;
  std::vector<double> roughness;  ///< as stated in the file, or empty
  std::optional<HarmonicsFile> polynomial;
};

Cubemap cubemap_of(const Environment& level, const std::string& named) {
  if (level.face_size() == 0) {
    throw Error(ErrorCode::unsupported_file, printable(named) + ": a chain is a cubemap, and this is a lat-long");
  }
  return {level.face_size(), values_of(level)};
}

/// Returns the first of six files of each mip, as cmgen writes them: m0_px.hdr, ..., m1_px.hdr, ...; empty if the
/// folder has none.
std::vector<std::filesystem::path> files_of_mips(const std::filesystem::path& folder) {
  std::map<std::string, std::filesystem::path> by_stem;
  for (const std::filesystem::directory_entry& entry : std::filesystem::directory_iterator(folder)) {
    if (entry.is_regular_file()) by_stem.emplace(platform::utf8(entry.path().stem()), entry.path());
  }
  std::vector<std::filesystem::path> files;
  for (auto file = by_stem.find("m0_px"); file != by_stem.end();) {
    files.push_back(file->second);
    file = by_stem.find("m" + std::to_string(files.size()) + "_px");
  }
  return files;
}

ChainFile read_chain(const CheckOptions& options, const Control& control) {
  const ReadOptions read{.memory_limit_bytes = options.common.read.memory_limit_bytes};
  const std::filesystem::path path = platform::path_of(options.chain);
  ChainFile chain;
  const auto is_enough = [&] { return options.mips > 0 && std::ssize(chain.mips) == options.mips; };
  if (std::filesystem::is_directory(path)) {
    for (const std::filesystem::path& file : files_of_mips(path)) {
      if (is_enough()) break;
      chain.mips.push_back(cubemap_of(read_environment(file, read, {control.stop, {}}), platform::utf8(file)));
    }
    if (!chain.mips.empty()) {
      chain.words = "six files a mip";
      return chain;
    }
  }
  const FileInput input = input_of(options.chain, read);
  const StoredEnvironment stored = inspect_stored_environment(input, read);
  chain.words = stored.info.format_description();
  const std::size_t levels = std::max(stored.info.levels.size(), std::size_t{1});
  for (std::size_t level = 0; level < levels && !is_enough(); ++level) {
    ReadOptions of_level = read;
    of_level.level = static_cast<int>(level);
    chain.mips.push_back(cubemap_of(read_environment(input, of_level, {control.stop, {}}), options.chain));
  }
  if (stored.has_polynomial) {
    chain.polynomial = harmonics_of(read_babylon_environment(input, read.memory_limit_bytes, {control.stop, {}}));
  }
  if (stored.content == LevelContent::reflections && stored.roughness.size() == stored.info.levels.size()) {
    chain.roughness = stored.roughness;
    chain.roughness.resize(chain.mips.size());
  }
  return chain;
}

std::vector<double> stated_roughness(const CheckOptions& options, const ChainFile& chain) {
  const auto& [schedule, table] = options.roughness;
  if (!schedule) return table.empty() ? chain.roughness : table;
  return mip_roughness(*schedule, static_cast<int>(chain.mips.size()), chain.mips.front().size());
}

// For a program.

Json mip_json(const MipCheck& mip, std::size_t index) {
  return {{"mip", index},
          {"size", mip.size},
          {"roughness", mip.roughness},
          {"lobe_roughness", mip.lobe_roughness},
          {"fitted_roughness", mip.fitted},
          {"scale", json_triple(mip.scale)},
          {"rms", mip.errors.rms},
          {"largest", mip.errors.largest},
          {"largest_at",
           {{"face", face_name(mip.errors.place.face)},
            {"column", mip.errors.place.column},
            {"row", mip.errors.place.row}}},
          {"bias", mip.errors.bias},
          {"rest", mip.rest},
          {"seams", mip.seams},
          {"clipped_at", mip.clipped_at},
          {"odd_values", mip.odd_values}};
}

Json harmonics_json(const HarmonicsCheck& check) {
  return {{"form", check.form},
          {"placement", words_of(check.placement)},
          {"factors", check.factors},
          {"rms", check.rms},
          {"findings", check.findings}};
}

std::string check_json(const CheckOptions& options, const ChainFile& chain, const ChainCheck& check,
                       const std::optional<HarmonicsCheck>& polynomial) {
  Json mips = Json::array();
  for (std::size_t mip = 0; mip < check.mips.size(); ++mip) mips.push_back(mip_json(check.mips[mip], mip));
  return json_text({{"chain", portable_path(options.chain)},
                    {"source", portable_path(options.source)},
                    {"format", chain.words},
                    {"rms", check.rms()},
                    {"placement", words_of(check.placement)},
                    {"lobe", name(check.lobe)},
                    {"unit", check.unit},
                    {"scale", json_triple(check.scale)},
                    {"schedule", check.schedule ? Json(name(*check.schedule)) : Json()},
                    {"schedule_distance", check.schedule ? Json(check.schedule_distance) : Json()},
                    {"fits_lookups", check.fits_lookups},
                    {"findings", check.findings},
                    {"polynomial", polynomial ? harmonics_json(*polynomial) : Json()},
                    {"mips", mips}});
}

// For a person.

std::string percent(double share) { return significant(100.0 * share, 3); }

std::string mip_line(const MipCheck& mip, std::size_t index) {
  return pad_left(std::to_string(index), 4) + pad_left(std::to_string(mip.size), 7) +
         pad_left(significant(mip.roughness, 3), 11) + pad_left(mip.fitted ? significant(*mip.fitted, 3) : "-", 9) +
         pad_left(percent(mip.errors.rms), 9) + pad_left(percent(mip.errors.largest), 11) +
         pad_left(percent(mip.errors.bias), 10) + pad_left(percent(mip.rest), 9) + '\n';
}

std::string findings_text(const std::vector<std::string>& findings, const char* right) {
  if (findings.empty()) return std::string("Nothing is wrong with ") + right + ".\n";
  return listed(
      findings, [](const std::string& finding) { return "found: " + finding + '\n'; }, "");
}

std::string harmonics_text(const std::string& name, const HarmonicsCheck& check) {
  return name + ": " + check.form + " in three bands, rms error " + percent(check.rms) + " %, factors of bands " +
         listed(check.factors, [](double factor) { return significant(factor, 4); }) + '\n' +
         findings_text(check.findings, "orientation, scale and bands");
}

std::string check_table(const CheckOptions& options, const ChainFile& chain, const ChainCheck& check,
                        const std::optional<HarmonicsCheck>& polynomial) {
  std::string text = printable(options.chain) + ": " + chain.words + ", cubemap of " +
                     std::to_string(check.mips.front().size) + ", " + counted(check.mips.size(), "mip") + "\n\n" +
                     " mip   size  roughness   fitted    rms %  largest %    bias %   rest %\n";
  for (std::size_t mip = 0; mip < check.mips.size(); ++mip) text += mip_line(check.mips[mip], mip);
  text += '\n';
  if (check.schedule) {
    text += (check.fits_lookups ? "Lobes are fitted to lookups by the schedule " : "Roughness follows the schedule ") +
            std::string(name(*check.schedule)) + " to within " + significant(check.schedule_distance, 2) + ".\n";
  }
  if (check.lobe == LobeFamily::lambert) {
    text += std::string("It holds irradiance, ") + (check.unit == 1.0 ? "divided by pi" : "not divided by pi") + ".\n";
  }
  text += findings_text(check.findings, "orientation, scale, roughness and edges");
  if (polynomial) text += '\n' + harmonics_text("Polynomial", *polynomial);
  return text;
}

/// Draws a row per mip: the chain, the reference, and four times their difference.
void draw(const CheckOptions& options, const ChainFile& chain, const ChainCheck& check, const EnvironmentView& source,
          const Control& control) {
  constexpr int kHeight = 128;
  constexpr int kWidth = 2 * kHeight;
  constexpr int kGap = 8;
  constexpr double kBrighter = 4.0;
  const std::size_t mips = check.mips.size();
  PreviewImage image(3 * (kWidth + kGap) - kGap, static_cast<int>(mips) * (kHeight + kGap) - kGap, glm::vec3(0.02F));
  glm::dvec3 mean(0.0);
  for (std::size_t mip = 0; mip < mips; ++mip) {
    const Cubemap truth = truth_of(check, check.mips[mip], source, options.pixels, control);
    const CubeLookup made(std::vector<CubemapView>{chain.mips[mip].view()});
    const CubeLookup wanted(std::vector<CubemapView>{truth.view()});
    if (mip == 0) {
      for (const float value : truth.pixels()) mean += glm::dvec3(value);
      mean /= static_cast<double>(truth.pixels().size());
    }
    const ToneMap tone_map{0.2 / std::max(mean.x, 1e-9)};
    const int top = static_cast<int>(mip) * (kHeight + kGap);
    for (int row = 0; row < kHeight; ++row) {
      for (int column = 0; column < kWidth; ++column) {
        const glm::vec3 direction(image::lat_long_direction(kWidth, kHeight, column + 0.5, row + 0.5));
        const glm::vec3 a = made.at(direction, 0);
        const glm::vec3 b = wanted.at(direction, 0);
        image.set(column, top + row, tone_map(a));
        image.set(kWidth + kGap + column, top + row, tone_map(b));
        image.set(2 * (kWidth + kGap) + column, top + row, tone_map(static_cast<float>(kBrighter) * glm::abs(a - b)));
      }
    }
    image.write("MIP " + std::to_string(mip), 40.0, top + kHeight - 12.0, 12.0);
  }
  image.save(platform::path_of(options.image));
}

/// The text of a check, and the error that `--error` limits.
struct Verdict {
  std::string text;
  double rms = 0.0;
};

Verdict check_file(const CheckOptions& options, const HarmonicsFile& file, const EnvironmentView& source,
                   const Control& control) {
  const HarmonicsCheck check = check_harmonics(file, source, options.pixels, control);
  if (!options.common.json) return {harmonics_text(printable(options.chain), check), check.rms};
  Json report = harmonics_json(check);
  report["chain"] = portable_path(options.chain);
  report["source"] = portable_path(options.source);
  return {json_text(report), check.rms};
}

Verdict check_file(const CheckOptions& options, const ChainFile& chain, const EnvironmentView& source,
                   const Control& control) {
  const ChainCheck check = check_chain(chain.mips, source, stated_roughness(options, chain), options.pixels, control);
  std::optional<HarmonicsCheck> polynomial;
  if (chain.polynomial) polynomial = check_harmonics(*chain.polynomial, source, options.pixels, {control.stop, {}});
  if (!options.image.empty()) draw(options, chain, check, source, {control.stop, {}});
  return {options.common.json ? check_json(options, chain, check, polynomial)
                              : check_table(options, chain, check, polynomial),
          check.rms()};
}

Verdict checked(const CheckOptions& options, const Control& control) {
  begin_stage("read");
  const std::optional<HarmonicsFile> harmonics = read_harmonics(platform::path_of(options.chain));
  const ChainFile chain = harmonics ? ChainFile{} : read_chain(options, control);
  const Environment source =
      read_environment(input_of(options.source, options.common.read), options.common.read, part_of(control, 0.0, 0.1));
  begin_stage("compare");
  const Control rest = part_of(control, 0.1, 1.0);
  return harmonics ? check_file(options, *harmonics, source.view(), rest)
                   : check_file(options, chain, source.view(), rest);
}

void run(CheckOptions options) {
  options.clamp.apply(options.pixels);
  double rms = 0.0;
  print_result(with_bar(options.common, [&](const Control& control) {
    Verdict verdict = checked(options, control);
    rms = verdict.rms;
    return std::move(verdict.text);
  }));
  if (options.error > 0.0 && rms > options.error) {
    throw Error(ErrorCode::limit_exceeded,
                "check: a mip errs by " + percent(rms) + " %, more than --error " + significant(options.error));
  }
}

}  // namespace

Command check_command() {
  const auto options = std::make_shared<CheckOptions>();
  Command command{"check", "Compare a prefiltered chain with its source", embedded_text("help/check.txt")};
  Options& table = command.options;
  add_option(table, "CHAIN", &options->chain, "",
             "The chain: a KTX2, KTX, DDS, mip-mapped OpenEXR or Babylon.js .env file, one cubemap in any form that is "
             "read, a folder with m0_px.hdr, m1_px.hdr and so on, as cmgen writes them; or harmonics: sh.json, cmgen's "
             "sh.txt",
             {.required = true});
  add_option(table, "SOURCE", &options->source, "", "The environment that it was made from", {.required = true});
  add_json_option(table, options->common);
  add_option(table, "--image", &options->image, "FILE.png",
             "Also draw each mip, what it should be, and four times the difference");
  add_option(table, "--error", &options->error, "X",
             "Fail (exit code 1) if the rms error of a mip is above X, such as 0.01",
             {.bounds = finite_and_positive()});
  in_group(table, "Input and output");
  add_roughness_option(table, options->roughness, "what the file states, else the schedule that fits best");
  add_option(table, "--mips", &options->mips, "N", "Compare the first N mips; default all",
             {.bounds = whole_between(1, 16)});
  in_group(table, "Chain");
  add_pixel_options(table, options->pixels, options->clamp);
  add_read_options(table, options->common, "");
  add_threads_option(table, options->common);
  command.everyday = {"CHAIN", "SOURCE", "--json", "--image", "--error", "--roughness", "--mips"};
  command.run = [options](const Given& /*given*/) { run(*options); };
  return command;
}

}  // namespace welkin::tool
