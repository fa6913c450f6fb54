
#include "places.h"
#include "support/catch.h"
#include "tools/command.h"
#include "welkin/core.h"
#include "welkin/reflections.h"

using namespace welkin;
using namespace welkin::test;

// Promises: help fits a screen, slips are answered with what was meant, and terminals alone get colours and progress.

namespace {

/// As it comes out of a terminal of its own: script(1) makes one.
std::string on_terminal(const std::string& arguments, const std::string& environment = "") {
  const TemporaryDirectory folder;
  const auto typed = folder.path() / "typed";
  const std::string command = environment + " TERM=xterm " + quoted(WELKIN_COMMAND) + " " + arguments;
  const CommandResult result =
      run_program("/usr/bin/env", "script -qec \"" + command + "\" " + quoted(typed) + " < /dev/null");
  return result.output;
}

}  // namespace

TEST_CASE("command: slips are answered with the nearest right word", "[tools]") {
  CHECK(contains(failure("bakee x.hdr -o out", 2), "there is no command bakee; did you mean bake?"));
  CHECK(contains(failure("hlep", 2), "did you mean help?"));
  CHECK(contains(failure("help bakee", 2), "there is no command bakee; did you mean bake?"));
  CHECK(contains(failure("''", 2), "there is no command"));
  CHECK(contains(failure("bake x.hdr --sise 256 -o out", 2), "there is no option --sise; did you mean --size?"));
  CHECK(contains(failure("bake x.hdr --sise=256 -o out", 2), "there is no option --sise; did you mean --size?"));
  CHECK(contains(failure("bake x.hdr --ouput out", 2), "there is no option --ouput; did you mean --output?"));
  CHECK(contains(failure("sh x.hdr --for untiy", 2), "did you mean unity?"));
  CHECK_FALSE(contains(failure("sh --frobnicate", 2), "did you mean"));
  CHECK(contains(failure("sh one.exr two.exr", 2), "two.exr is an argument too many"));
  CHECK(contains(failure("sh -- one.exr -two.exr", 2), "-two.exr is an argument too many"));
  CHECK(contains(failure("report --quik", 2), "did you mean --quick?"));
}

TEST_CASE("command: options may stand before their command", "[tools][posix][slow]") {
  const TemporaryDirectory folder;
  const std::string small = " " + small_image() + " --size 4 --irradiance 0 --no-brdf --no-previews ";
  const auto baked = [&](const std::string& arguments, const char* name) {
    printed_by(arguments, "cd " + quoted(folder.path()) + " &&");
    CHECK(std::filesystem::exists(folder.path() / name / "manifest.json"));
  };
  baked("-o out bake" + small, "out");
  baked("-q --output=other bake" + small, "other");
  baked("--size 4 -o sh bake " + small_image() + " --irradiance 0 --no-previews", "sh");  // named as a command is
  CHECK(contains(failure("--sise 4 bake --sky", 2), "bake: there is no option --sise; did you mean --size?"));
}

TEST_CASE("command: words are taken whatever their case", "[tools][slow]") {
  const std::string sh = "sh " + small_image();
  CHECK(run_welkin(sh + " --for Unity --format TEXT --window Hanning").output ==
        run_welkin(sh + " --for unity --format text --window hanning").output);
  const TemporaryDirectory folder;
  const std::string small = " --size 4 --irradiance 0 --no-brdf --no-previews ";
  const auto manifest =
      bake_into(folder.path() / "out", small_image() + " --formats KTX2,Exr --roughness Unity" + small);
  CHECK(manifest.at("options").at("roughness") == "unity");
  CHECK(file_of(manifest, "specular.exr").at("mips") == 3);
}

TEST_CASE("command: --quiet says nothing where all is well, --verbose what was done", "[tools][slow]") {
  const TemporaryDirectory folder;
  const std::string bake =
      "bake " + small_image() + " --size 4 --irradiance 0 --no-brdf --no-previews -o " + quoted(folder.path() / "o");
  for (const std::string& quiet :
       {bake + " --quiet", bake + " -q", "testmap --size 4 -q -o " + quoted(folder.path() / "t.exr"), "-q " + bake}) {
    INFO(quiet);
    CHECK(printed_by(quiet).empty());
  }
  CHECK(json_of(run_welkin(bake + " -q --json").output).contains("files"));  // --json overrides -q
  CHECK(contains(run_welkin("sh -q " + small_image()).output, "radiance"));
  const CommandResult verbose = run_welkin(bake + " --verbose");
  CHECK(contains(verbose.output, "manifest.json"));
  for (const char* stage : {"read: ", "bake: ", "write: "}) CHECK(contains(verbose.errors, stage));
}

TEST_CASE("command: colours are for terminals that may show them", "[tools]") {
  const std::string escape = "\033[";
  CHECK_FALSE(contains(run_welkin("--help").output, escape));
  CHECK_FALSE(contains(run_welkin("nonsense").errors, escape));
  if (run_program("/usr/bin/env", "script --version").exit_code != 0) {
    WARN("left out: there is no script(1) to make a terminal");
    return;
  }
  CHECK(contains(on_terminal("--help"), escape));
  CHECK(contains(on_terminal("nonsense"), escape));
  CHECK_FALSE(contains(on_terminal("--help", "NO_COLOR=1"), escape));
  CHECK_FALSE(contains(on_terminal("nonsense", "NO_COLOR=1"), escape));
  CHECK(contains(on_terminal("--help", "NO_COLOR="), escape));  // empty is as good as not there
}

TEST_CASE("command: a terminal is told stage, share and time left", "[tools][slow]") {
  if (run_program("/usr/bin/env", "script --version").exit_code != 0) return;
  const TemporaryDirectory folder;
  const std::string slow =
      "bake --sky --size 8 --method reference --threads 1 --no-previews -o " + (folder.path() / "o").string();
  const std::string shown = on_terminal(slow);
  INFO(shown);
  CHECK(contains(shown, "bake  ["));
  CHECK(contains(shown, " % "));
  CHECK(contains(shown, "s left"));
  CHECK_FALSE(contains(on_terminal(slow + " --quiet"), "["));
  CHECK(contains(on_terminal("report --scale tiny --no-peers --passes prefilter -o " + (folder.path() / "r").string()),
                 "prefilter"));
}

// Promise: - is standard input and output, with the results of files.

TEST_CASE("command: - reads standard input", "[tools]") {
  const TemporaryDirectory folder;
  const auto in = folder.path() / "in.pfm";
  std::vector<float> pixels = grey_image(32, 16, 1.0F);
  pixels[77] = 9.0F;
  write_pfm(in, 32, 16, pixels);
  const std::string from = " < " + quoted(in);
  auto file = run_sh_json_without_times(quoted(in));
  auto piped = run_sh_json_without_times("-" + from);
  CHECK(piped.at("source").at("path") == "standard input");
  CHECK(piped.at("radiance") == file.at("radiance"));
  CHECK(run_sh_json_without_times("- --extract-sun" + from).at("radiance") ==
        run_sh_json_without_times("--extract-sun " + quoted(in)).at("radiance"));
  CHECK(contains(run_welkin("info -" + from).output, "32 x 16"));
  const std::string bake = " --size 8 --irradiance 4 --brdf 4 --no-previews";
  bake_into(folder.path() / "file", quoted(in) + bake);
  const auto manifest = bake_into(folder.path() / "piped", "-" + bake + from);
  CHECK(manifest.at("source").at("path") == "standard input");
  CHECK((file_text(folder.path() / "piped" / "specular.ktx2") == file_text(folder.path() / "file" / "specular.ktx2")));
  CHECK(contains(failure("info - < /dev/null", 1), "standard input"));
  CHECK(contains(failure("info --memory-limit 1KiB -" + from, 1), "standard input"));
}

TEST_CASE("command: - writes standard output, and nothing else there", "[tools]") {
  const TemporaryDirectory folder;
  const auto in = folder.path() / "in.pfm";
  write_pfm(in, 32, 16, grey_image(32, 16, 0.5F));
  for (const std::string format : {"exr", "hdr", "pfm", "png"}) {
    INFO(format);
    const auto file = folder.path() / ("out." + format);
    REQUIRE(run_welkin("convert " + quoted(in) + " " + quoted(file)).exit_code == 0);
    const CommandResult piped = run_welkin("convert - - --format " + format + " < " + quoted(in));
    CHECK(piped.exit_code == 0);
    CHECK((piped.output == file_text(file)));
  }
  CHECK((run_welkin("testmap --size 16 -o -").output.substr(0, 4) == "\x76\x2f\x31\x01"));  // OpenEXR's magic number
  CHECK(run_welkin("convert " + quoted(in) + " - --layout six-files").exit_code == 2);
}

// Promise: shell completion and man pages agree with the tables of options.

TEST_CASE("command: bash completes commands, options and words", "[tools]") {
  const TemporaryDirectory folder;
  const auto script = folder.path() / "welkin.bash";
  std::ofstream(script) << run_welkin("completion bash").output;
  const auto completed = [&](const std::string& words, int last) {
    const std::string lines = "source " + quoted(script) + "; COMP_WORDS=(" + words +
                              "); COMP_CWORD=" + std::to_string(last) + "; _welkin; echo \"${COMPREPLY[@]}\"";
    std::ofstream(folder.path() / "run.bash") << lines;
    const CommandResult result = run_program("/usr/bin/env", "bash " + quoted(folder.path() / "run.bash"));
    CHECK(result.errors.empty());
    return result.output;
  };
  CHECK(completed("welkin ba", 1) == "bake batch\n");
  CHECK(completed("welkin batch me", 2) == "merge\n");
  CHECK(contains(completed("welkin help s", 2), "sky"));
  CHECK(completed("welkin bake --preview-", 2) == "--preview-size\n");
  CHECK(completed("welkin sh in.hdr --for un", 4) == "unity unreal\n");
  CHECK(completed("welkin completion z", 2) == "zsh\n");
  CHECK(completed("welkin bake --size 5", 3) == "\n");
}

TEST_CASE("command: zsh completes commands, options and words where there is a zsh", "[tools][slow]") {
  const std::string script = run_welkin("completion zsh").output;
  CHECK(script.rfind("#compdef welkin", 0) == 0);
  CHECK(contains(script, "'--for["));
  CHECK(contains(script, "(welkin openexr babylon"));
  const TemporaryDirectory folder;
  std::ofstream(folder.path() / "_welkin") << script;
  const CommandResult checked = run_program("/usr/bin/env", "zsh -n " + quoted(folder.path() / "_welkin"));
  if (checked.exit_code == 127) {
    WARN("left out: there is no zsh");
    return;
  }
  CHECK(checked.exit_code == 0);
  const CommandResult completed = run_program(
      "/usr/bin/env", "timeout 60 zsh -f " + quoted(std::filesystem::path(WELKIN_TEST_DATA) / "../tools/complete.zsh") +
                          ' ' + quoted(folder.path()) + " 'welkin ba' bake 'welkin bake --si' --size" +
                          " 'welkin sh in.hdr --for ' unity 'welkin help ' testmap");
  INFO("typed, the last one in vain:\n" << completed.output << completed.errors);
  CHECK(completed.exit_code == 0);
}

TEST_CASE("command: the manual page names every command and option", "[tools]") {
  const TemporaryDirectory folder;
  const auto page = folder.path() / "welkin.1";
  std::ofstream(page) << run_welkin("completion manual").output;
  const CommandResult shown = run_program("/usr/bin/env", "groff -man -Tascii -P-cbu -ww " + quoted(page));
  if (shown.exit_code == 127) {
    WARN("left out: there is no groff");
    return;
  }
  CHECK(shown.exit_code == 0);
  CHECK(shown.errors.empty());
  for (const char* part : {"NAME", "--sun-elevation", "--preview-size", "--extract-sun", "Exit codes", "NO_COLOR"}) {
    INFO(part);
    CHECK(contains(shown.output, part));
  }
}

// Promise: what is written can be given away. It says nothing of the folders of the machine that wrote it.

TEST_CASE("bake: no file that is written holds an absolute path", "[tools][bake]") {
  const TemporaryDirectory folder;
  const auto in = folder.path() / "city.pfm";
  write_pfm(in, 16, 8, grey_image(16, 8, 1.0F));
  const auto out = folder.path() / "out";
  REQUIRE(run_welkin("bake " + quoted(in) + " --size 8 --irradiance 4 --brdf 4 --explain --cache " +
                     quoted(folder.path() / "cache") + " -o " + quoted(out))
              .exit_code == 0);
  for (const char* name : {"manifest.json", "sh.json", "sh.h"}) {
    INFO(name);
    const std::string text = file_text(out / name);
    CHECK(contains(text, "city.pfm"));
    CHECK_FALSE(contains(text, folder.path().string()));
  }
  CHECK(manifest_of(out).at("source").at("path") == "city.pfm");
  CHECK_FALSE(contains(run_welkin("sh --format c " + quoted(in)).output, folder.path().string()));
}

// Promise: what is baked for an engine has the roughness that its shader looks for.

TEST_CASE("bake: roughness is spread as the engine has it", "[tools][bake][slow]") {
  const TemporaryDirectory folder;
  const std::string small = " --irradiance 0 --no-brdf --no-previews ";
  const auto roughness = [&](const std::string& options) {
    std::vector<double> table;
    const auto manifest = bake_into(folder.path() / "out", small_image() + small + options);
    for (const auto& mip : manifest.at("specular")) {
      table.push_back(mip.at("roughness").get<double>());
    }
    return table;
  };
  CHECK(roughness("--size 64 --roughness unity") == mip_roughness(RoughnessSchedule::unity, 7, 64));
  CHECK(roughness("--size 64 --for unity --formats ktx2") == mip_roughness(RoughnessSchedule::unity, 7, 64));
  CHECK(roughness("--size 64 --for unreal --formats ktx2") == mip_roughness(RoughnessSchedule::unreal, 7, 64));
  CHECK(roughness("--size 64 --for unity --formats ktx2 --roughness linear") ==
        mip_roughness(RoughnessSchedule::linear, 5, 64));
  // The library has an equal default.
  const LatLongImage grey{16, 8, grey_image(16, 8, 1.0F)};
  std::vector<double> of_library;
  for (const MipRecord& mip : prefilter_specular(grey.view(), {.size = 64}).mips) of_library.push_back(mip.roughness);
  CHECK(roughness("--size 64") == of_library);
}
