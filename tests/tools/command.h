// Runs the built `welkin` as a user does, through a shell, makes small files to read, and looks at what a bake left.
#pragma once

#include <nlohmann/json.hpp>

#include "support/catch.h"
#include "support/temporary_directory.h"

namespace welkin::test {

struct CommandResult {
  int exit_code = -1;
  std::string output;  ///< standard output
  std::string errors;  ///< standard error
};

/// Runs `welkin` with `arguments` as they would be typed; `environment` is such as "WELKIN_ISA=sse2".
CommandResult run_welkin(const std::string& arguments, const std::string& environment = "");

/// Runs another file, such as a copy of the program.
CommandResult run_program(const std::filesystem::path& program, const std::string& arguments,
                          const std::string& environment = "");

/// Runs these lines by /bin/sh.
CommandResult run_script(const std::string& lines);

/// JSON's parser and printer are compiled in command.cpp alone: they take seconds in each source that calls them.
nlohmann::json json_of(const std::string& text);

/// Runs `welkin ARGUMENTS`, requires success and an empty standard error; returns the standard output.
std::string printed_by(const std::string& arguments, const std::string& environment = "");

/// Returns the output of `printed_by`, parsed as JSON.
nlohmann::json json_printed_by(const std::string& arguments, const std::string& environment = "");

/// Runs `welkin ARGUMENTS`, expects this exit code and an empty standard output; returns the standard error.
std::string failure(const std::string& arguments, int exit_code, const std::string& environment = "");

/// Options, and values that they refuse.
using BadValues = std::map<std::string, std::vector<std::string>>;

/// Runs `welkin START OPTION VALUE` for each of them, expects exit code 2 and the option's name on standard error.
void check_refused(const std::string& start, const BadValues& options);

/// Returns the JSON of `welkin sh --json` with more arguments.
nlohmann::json run_sh_json(const std::string& arguments, const std::string& environment = "");

/// Returns the JSON of `run_sh_json` without the passes' times, which differ in every run.
nlohmann::json run_sh_json_without_times(const std::string& arguments, const std::string& environment = "");

bool contains(std::string_view text, std::string_view part);

/// Returns a path in single quotes, for `arguments`.
std::string quoted(const std::filesystem::path& path);

/// Writes a small PFM file, the simplest format that the command reads. `rgb`: width x height x 3 floats, row 0 on top
/// (PFM keeps its rows bottom-up). Little-endian.
void write_pfm(const std::filesystem::path& path, int width, int height, const std::vector<float>& rgb);

/// Returns the quoted path of an image of 64 x 32 texels, bright on one side, for tests with any light. (The built-in
/// sky is computed in each run that uses it.) All its harmonics of three bands differ from 0.
const std::string& small_image();

/// Returns all pixels of an image, or of six faces.
std::vector<float> pixels_in(const std::filesystem::path& file);

/// Returns an image of one grey.
std::vector<float> grey_image(int width, int height, float value);

/// Returns the content of a file; requires that it exists.
std::string file_text(const std::filesystem::path& path);

nlohmann::json manifest_of(const std::filesystem::path& folder);

/// Runs `welkin bake ARGUMENTS -o FOLDER`, requires success and an empty standard error; returns the manifest.
nlohmann::json bake_into(const std::filesystem::path& folder, const std::string& arguments,
                         const std::string& environment = "");

std::vector<std::string> names_in(const std::filesystem::path& folder);

/// Checks that two folders have files of the same names, and that all but those left out have the same bytes.
void check_same_files(const std::filesystem::path& folder, const std::filesystem::path& expected,
                      const std::set<std::string>& left_out = {"manifest.json"});

/// Returns the names of the manifest's files and of the manifest itself.
std::vector<std::string> names_of(const nlohmann::json& manifest);

/// Returns the manifest's entry for a file.
nlohmann::json file_of(const nlohmann::json& manifest, const std::string& name);

}  // namespace welkin::test

template <>
struct Catch::StringMaker<nlohmann::json> {
  static std::string convert(const nlohmann::json& value);
};
