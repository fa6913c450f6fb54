// `welkin bake`: bakes an environment into all files that a renderer loads.
#include <algorithm>
#include <array>
#include <chrono>
#include <filesystem>
#include <memory>
#include <string>
#include <string_view>
#include <system_error>
#include <vector>

#include "embedded_texts.h"
#include "jobs/control.h"
#include "platform/text.h"
#include "tools/bake_cache.h"
#include "tools/bake_manifest.h"
#include "tools/commands.h"
#include "tools/engine_folders.h"
#include "tools/terminal.h"
#include "tools/text.h"
#include "welkin/core.h"
#include "welkin/environment_file.h"
#include "welkin/image.h"

namespace welkin::tool {
namespace {

// Checks that a bake does not overwrite its inputs.

/// Returns the number of levels that a file's content has. `bake`: from `library_options`.
int levels_of(Content content, const BakeCommandOptions& options, const BakeOptions& bake) {
  const int mips = bake.specular->mips.value();
  switch (content) {
    case Content::background: return full_chain_levels(bake.background->size.value_or(bake.specular->size));
    case Content::specular: return mips;
    case Content::octahedral: return bake.octahedral->levels;
    default: break;
  }
  for (const LobeFamily lobe : options.lobes) {
    if (content_of(lobe) == content) return default_mip_count(lobe_options(lobe, options, *bake.specular));
  }
  return 1;
}

/// Returns all files that are read.
std::vector<std::filesystem::path> files_read(const BakeCommandOptions& options) {
  std::vector<std::filesystem::path> files;
  for (const std::string& file : options.also_read) files.push_back(platform::path_of(file));
  if (options.scene.file) files.push_back(options.scene.folder / platform::path_of(*options.scene.file));
  if (!options.input || is_stream(*options.input)) return files;
  const std::vector<std::filesystem::path> input =
      input_files(options, inspect_environment(platform::path_of(*options.input), options.common.read));
  files.insert(files.end(), input.begin(), input.end());
  return files;
}

/// Returns the names in the output folder that a bake of these options writes, manifest included. `bake`: from
/// `library_options`.
std::vector<std::string> names_to_write(const BakeCommandOptions& options, const BakeOptions& bake) {
  std::vector<std::string> names = {kManifestName};
  if (!options.image_name.empty()) names.push_back(options.image_name);
  for (const OutputFile& file : options.files) {
    for (const std::string& each : names_of(file, levels_of(file.content, options, bake))) names.push_back(each);
  }
  if (options.bake.bands > 0) names.insert(names.end(), {"sh.json", harmonics_name(options)});
  if (options.previews) names.emplace_back("preview_environment.png");
  if (options.previews && writes_reflections(options)) {
    names.insert(names.end(), {"preview_spheres.png", "preview_mips.png"});
    if (options.preview_page) names.emplace_back(kPreviewPage);
  }
  return names;
}

/// Throws `Error` (file_access) if a file that is not of an earlier bake has the name of one to be written.
void check_places(const BakeCommandOptions& options, const BakeOptions& bake) {
  const std::filesystem::path folder = platform::path_of(options.directory);
  OwnFiles(folder, kBakeFiles).require(names_to_write(options, bake));
}

/// Throws `Error`: file_access if a file to be written is also read (by any name or link, any of six files and of a
/// directory's six); and the errors of `inspect_environment`.
void check_input_is_kept(const BakeCommandOptions& options, const BakeOptions& bake) {
  std::error_code none;
  const std::filesystem::path folder = platform::path_of(options.directory);
  if (!std::filesystem::exists(folder, none)) return;
  const std::vector<std::string> names = names_to_write(options, bake);
  for (const std::filesystem::path& input : files_read(options)) {
    for (const std::string& name : names) {
      require_kept(input, folder / name, "this bake", "pass another folder to -o, or move the input");
    }
  }
}

/// Throws `Error` (file_access) if this bake would overwrite a README.md that no bake wrote.
void check_readme_is_kept(const BakeCommandOptions& options) {
  for (const OutputFile& file : files_with(Content::readme, options.files)) {
    for (const char* const sign : kReadmeSigns) {
      require_own(platform::path_of(options.directory) / file.name, sign, "bake",
                  "pass another folder to -o, or choose files without one by --formats");
    }
  }
}

// The table for a person.

std::string size_text(std::uint64_t bytes) {
  constexpr double kKibi = 1024.0;
  const double kibibytes = static_cast<double>(bytes) / kKibi;
  return kibibytes < kKibi ? rough(kibibytes) + " KiB" : rough(kibibytes / kKibi) + " MiB";
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
  std::string text =
      "\nSpecular mips\n  mip  size  roughness  made by    bands  bright texels   estimated rms error between mips\n";
  for (std::size_t number = 0; number < mips.size(); ++number) {
    const MipRecord& mip = mips[number];
    text += pad_left(std::to_string(number), 5) + pad_left(std::to_string(mip.size), 6) +
            pad_left(significant(mip.roughness, 4), 11) + "  " + pad_right(name(mip.method), 10) +
            pad_left(mip.bands > 0 ? std::to_string(mip.bands) : "-", 6) +
            pad_left(mip.bright_texels > 0 ? std::to_string(mip.bright_texels) : "-", 15) +
            pad_left(mip.error_estimate ? significant(*mip.error_estimate, 2) : "-", 22) +
            pad_left(mip.error_between ? significant(*mip.error_between, 2) : "-", 13) + '\n';
  }
  return text;
}

/// Returns the passes of the library's bake and of the .env's chain.
std::vector<PassRecord> measured_passes(const Baked& baked) {
  std::vector<PassRecord> passes = baked.light.diagnostics.passes;
  for (const PassRecord& pass : baked.passes) {
    const auto planned = std::ranges::find(baked.plan.passes, pass.name, &PlannedPass::name);
    const auto known = std::ranges::find(passes, pass.name, &PassRecord::name);
    if (planned != baked.plan.passes.end() && known == passes.end()) passes.push_back(pass);
  }
  return passes;
}

std::string time_line(const std::string& indent, const PassRecord& pass) {
  return indent + pad_right(pass.name, 28 - indent.size()) +
         (pass.action == PassAction::run ? duration(pass.milliseconds)
                                         : std::string(name(pass.action)) + ": " + pass.reason) +
         '\n';
}

/// Lists the library's passes under the bake that they are parts of.
std::string time_lines(const Baked& baked) {
  std::string text = "\nTimes\n";
  for (const PassRecord& pass : baked.passes) {
    text += time_line("  ", pass);
    if (pass.name != kBakePass) continue;
    for (const PassRecord& part : baked.light.diagnostics.passes) text += time_line("    ", part);
  }
  return text;
}

BakeWords words_of(const Baked& baked, const BakeCommandOptions& options, const OutputFolder& folder) {
  const Source& source = baked.source;
  BakeWords words;
  words.source = printable(source.path) + ": " + std::to_string(source.width) + " x " + std::to_string(source.height) +
                 ' ' + source.layout + ", " + printable(source.format) + '\n';
  if (baked.light.specular) words.results += mip_lines(baked.light.specular->mips);
  if (baked.sun_wanted) {
    std::optional<Sun> sun = baked.sun;
    OrientationOptions to_engine;
    to_engine.to = options.orientation.to;
    if (sun) sun->direction = light_rotation(to_engine, false) * sun->direction;
    words.results += '\n' + sun_text(sun, convention(options.orientation.to).from_welkin[1].z > 0.5);
  }
  words.notes = bake_notes(baked, options, folder);
  return words;
}

/// Returns the line that names the main preview; empty without previews.
std::string preview_line(const OutputFolder& folder) {
  for (const char* const name : {kPreviewPage, "preview_spheres.png", "preview_environment.png"}) {
    if (std::ranges::find(folder.files(), name, &WrittenFile::name) == folder.files().end()) continue;
    return "\nPreview  " + printable(platform::utf8(folder.place(name))) + '\n';
  }
  return "";
}

/// `times`: how long the bake took, by pass.
std::string bake_table(const BakeWords& words, const std::string& times, const BakeCommandOptions& options,
                       const OutputFolder& folder) {
  std::string text = words.source + printable(platform::utf8(folder.path())) + ", axes " +
                     axes_text(options.orientation) + '\n' + file_lines(folder) + words.results + times +
                     preview_line(folder);
  for (const std::string& note : words.notes) text += "note: " + printable(note) + '\n';
  return text;
}

// The command.

constexpr double kBaked = 0.6;  // fraction of the progress; the rest is writing
constexpr std::array<std::string_view, 4> kRunningOptions = {"--output", "--json", "--threads", "--cache"};

/// Refuses everything that can be refused, before a folder is made and before any work.
void check(const BakeCommandOptions& options) {
  const BakeOptions bake = library_options(options);
  static_cast<void>(face_rotation(options));
  check_output_folder(platform::path_of(options.directory));
  check_input_is_kept(options, bake);
  check_readme_is_kept(options);
  check_places(options, bake);
}

std::string planned(const BakeCommandOptions& options, const Control& control) {
  const Plan plan = plan_ahead(options, control);
  return options.common.json ? json_text(plan_json(plan)) : plan_text(plan);
}

void run(BakeCommandOptions options) {
  settle_files(options);
  const std::string text = with_bar(options.common, [&](const Control& control) {
    return options.scene.plan_only ? planned(options, control) : bake_to_folder(options, control);
  });
  options.common.json || options.scene.plan_only ? print_result(text) : print_summary(text);
}

/// Writes the files of an earlier bake.
std::string write_kept(const KeptBake& kept, const BakeCommandOptions& options, const Control& control) {
  const auto start = std::chrono::steady_clock::now();
  std::vector<std::string> names = {kManifestName};
  for (const KeptBake::File& file : kept.files) names.push_back(file.about.name);
  OutputFolder folder(platform::path_of(options.directory), names, control);
  for (const KeptBake::File& file : kept.files) {
    jobs::throw_if_cancelled(control.stop);
    write_bytes(folder.place(file.about.name), file.contents);
    folder.add(file.about);
  }
  BakeWords words = kept.words;
  for (std::string& remark : folder.finish(kept.manifest, files_read(options)))
    words.notes.push_back(std::move(remark));
  if (options.common.json) return kept.manifest;
  const std::chrono::duration<double, std::milli> took = std::chrono::steady_clock::now() - start;
  return bake_table(words,
                    "\nTimes\n  write                     " + duration(took.count()) +
                        "\n    all files                 reuse: found in the cache\n",
                    options, folder);
}

}  // namespace

std::string bake_to_folder(const BakeCommandOptions& options, const Control& control) {
  check(options);
  BakeFolderCache cache(options);
  if (const std::optional<KeptBake> kept = cache.find()) return write_kept(*kept, options, control);
  Baked baked = bake_source(options, part_of(control, 0.0, kBaked));
  OutputFolder folder(platform::path_of(options.directory), names_to_write(options, baked.whole),
                      part_of(control, kBaked, 1.0));
  const ToneMap tone_map = tone_map_of(baked, options);
  write_bake(baked, options, folder, part_of(control, kBaked, 1.0));
  const std::string manifest = bake_manifest(baked, options, folder, tone_map);
  const std::vector<std::string> remarks = folder.finish(manifest, files_read(options));
  BakeWords words = words_of(baked, options, folder);
  if (baked.notes.empty()) cache.keep(folder, manifest, words, words.notes);  // `baked.notes` concern this run alone
  words.notes.insert(words.notes.end(), remarks.begin(), remarks.end());
  if (options.common.json) return manifest;
  const std::string plan = options.scene.explains() ? '\n' + plan_text(baked.plan, measured_passes(baked)) : "";
  return bake_table(words, time_lines(baked) + plan, options, folder);
}

Command bake_command() {
  const auto options = std::make_shared<BakeCommandOptions>();
  Command command{"bake", "Bake the lighting files of a physically based renderer", embedded_text("help/bake.txt")};
  add_bake_options(command.options, *options);
  command.everyday = {"INPUT",         "--output", "--sky",      "--json",        "--size", "--roughness",
                      "--formats",     "--for",    "--exposure", "--no-previews", "--yaw",  "--explain",
                      "--extract-sun", "--clamp",  "--threads",  "--cache",       "--quiet"};
  command.several = "; 'welkin batch plan' bakes several: 'welkin help batch'";
  command.run = [options, name = command.name, table = command.options](const Given& given) {
    require_input(name, options->input, options->sky);
    options->asked = given.of(table);
    std::erase_if(options->asked, [](const auto& one) {  // options of where and how, which do not affect the files
      return std::ranges::find(kRunningOptions, one.first) != kRunningOptions.end();
    });
    if (!given("--output") && !options->scene.plan_only) {
      options->directory = default_output_name(options->input);
      require_own_folder(platform::path_of(options->directory), kManifestName, name);
    }
    run(*options);
  };
  return command;
}

}  // namespace welkin::tool
