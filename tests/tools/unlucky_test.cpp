// The command under adverse conditions: signals, killed runs, too few threads, pipes, outputs that would overwrite the
// input, names that would control a terminal, files that need too much memory.
#include <signal.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include "places.h"
#include "platform/file.h"
#include "support/catch.h"
#include "support/trials.h"
#include "tools/command.h"

namespace welkin::test {
namespace {

bool has_temporary(const std::filesystem::path& folder) {
  const std::vector<std::string> names = names_in(folder);
  return std::any_of(names.begin(), names.end(), [](const std::string& name) { return name.starts_with(".welkin-"); });
}

/// An image that takes seconds to bake.
std::filesystem::path large_image(const TemporaryDirectory& folder) {
  const std::filesystem::path path = folder.path() / "large.pfm";
  write_pfm(path, 2048, 1024, grey_image(2048, 1024, 0.5F));
  return path;
}

struct Ended {
  int status = 0;
  std::string errors;
};

/// Starts a bake into `folder`/out, sends it the signal after a while, and waits for its end.
Ended bake_and_signal(const TemporaryDirectory& folder, const std::filesystem::path& input, int signal) {
  const std::filesystem::path errors = folder.path() / "errors";
  const std::filesystem::path out = folder.path() / "out";
  const pid_t child = fork();
  REQUIRE(child >= 0);
  if (child == 0) {
    if (std::freopen(errors.c_str(), "w", stderr) == nullptr || std::freopen("/dev/null", "w", stdout) == nullptr) {
      _exit(99);
    }
    ::signal(signal, SIG_DFL);
    execl(WELKIN_COMMAND, "welkin", "bake", input.c_str(), "-o", out.c_str(), "--size", "1024", "--threads", "1",
          "--formats", "ktx2,env", nullptr);
    _exit(98);
  }
  std::this_thread::sleep_for(std::chrono::milliseconds(400));
  REQUIRE(kill(child, signal) == 0);
  Ended ended;
  REQUIRE(waitpid(child, &ended.status, 0) == child);
  ended.errors = file_text(errors);
  return ended;
}

}  // namespace

TEST_CASE("A signal stops a bake by its stop token, is said, and leaves no temporary file",
          "[command][unlucky][slow]") {
  const TemporaryDirectory folder;
  const std::filesystem::path input = large_image(folder);
  for (const int signal : {SIGINT, SIGTERM, SIGHUP}) {
    const Ended ended = bake_and_signal(folder, input, signal);
    INFO(ended.errors);
    REQUIRE(WIFEXITED(ended.status));
    CHECK(WEXITSTATUS(ended.status) == 128 + signal);
    CHECK(contains(ended.errors, "welkin: stopped ("));
    const std::filesystem::path out = folder.path() / "out";
    if (!std::filesystem::exists(out)) continue;
    CHECK_FALSE(std::filesystem::exists(out / "manifest.json"));
    CHECK_FALSE(has_temporary(out));
  }
}

TEST_CASE("A file that outgrows its limit ends the command by the error that names it", "[command][unlucky]") {
  const TemporaryDirectory folder;
  const std::filesystem::path input = large_image(folder);
  const std::filesystem::path out = folder.path() / "made.pfm";
  const CommandResult result =
      run_script("ulimit -f 100; exec '" WELKIN_COMMAND "' convert " + quoted(input) + ' ' + quoted(out));
  INFO(result.errors);
  CHECK(result.exit_code == 128 + SIGXFSZ);
  CHECK(contains(result.errors, "made.pfm: could not be written"));
  CHECK_FALSE(std::filesystem::exists(out));
  CHECK_FALSE(has_temporary(folder.path()));
}

TEST_CASE("What killed runs left in a folder is tidied by the next one, and blocks none", "[command][unlucky]") {
  const TemporaryDirectory folder;
  const std::filesystem::path out = folder.path() / "out";
  std::filesystem::create_directory(out);
  write_text(out / ".welkin-1-0.part", "left");
  write_text(out / ".welkin-77-3-1700000000000000000.part", "left");
  write_text(out / ".welkin-mine.part", "somebody's");
  // In a container each run is process 1; the name is what an earlier version would have taken.
  const CommandResult result = run_script("touch '" + (out / "manifest.json.welkin-").string() +
                                          "'$$; exec '" WELKIN_COMMAND "' bake --sky -o " + quoted(out) +
                                          " --size 16 --irradiance 4 --brdf 8 --formats ktx2 --no-previews");
  INFO(result.errors);
  CHECK(result.exit_code == 0);
  CHECK_FALSE(std::filesystem::exists(out / ".welkin-1-0.part"));
  CHECK_FALSE(std::filesystem::exists(out / ".welkin-77-3-1700000000000000000.part"));
  CHECK(file_text(out / ".welkin-mine.part") == "somebody's");
  CHECK(std::filesystem::exists(out / "manifest.json"));
}

TEST_CASE("Files that options name are read once, so that pipes do, and are not written over", "[command][unlucky]") {
  const std::string small = "bake --sky --size 16 --irradiance 4 --brdf 8 --formats ktx2 --no-previews --json ";
  const TemporaryFile out("out");
  const std::string needs = R"({"background": false, "diffuse_bands": 2})";
  const CommandResult piped = run_program("/bin/sh", "-c 'printf %s \"$0\" | exec " WELKIN_COMMAND " " + small +
                                                         "--needs /dev/stdin -o " + out.string() + "' '" + needs + "'");
  INFO(piped.errors);
  REQUIRE(piped.exit_code == 0);
  CHECK(json_of(piped.output).at("needs").at("diffuse_bands") == 2);
  CHECK_FALSE(std::filesystem::exists(out / "background.ktx2"));

  write_text(out / "manifest.json", needs);
  CHECK(contains(failure(small + "--needs " + quoted(out / "manifest.json") + " -o " + quoted(out), 1),
                 "is read, and this bake would write over it"));
  CHECK(file_text(out / "manifest.json") == needs);
}

TEST_CASE("A conversion does not write over what it reads", "[command][unlucky]") {
  const TemporaryDirectory folder;
  const auto refused = [](const std::filesystem::path& kept, const std::string& arguments) {
    const std::string before = file_text(kept);
    CHECK(contains(failure("convert " + arguments, 1), "is read, and the conversion would write over it"));
    CHECK(file_text(kept) == before);
  };
  const std::filesystem::path map = folder.path() / "map.hdr";
  REQUIRE(run_welkin("testmap --size 64 -o " + quoted(map)).exit_code == 0);
  refused(map, quoted(map) + " " + quoted(map) + " --size 32");
  const std::filesystem::path link = folder.path() / "link.hdr";
  std::filesystem::create_symlink(map, link);
  refused(map, quoted(link) + " " + quoted(map) + " --size 32");

  const std::filesystem::path faces = folder.path() / "cube.hdr";
  REQUIRE(run_welkin("convert " + quoted(map) + " " + quoted(faces) + " --layout six-files --size 8").exit_code == 0);
  const std::filesystem::path face = folder.path() / "cube_ny.hdr";
  refused(face, quoted(folder.path() / "cube_px.hdr") + " " + quoted(faces) + " --layout six-files --size 4");
  CHECK(run_welkin("convert " + quoted(map) + " " + quoted(folder.path() / "small.hdr") + " --size 32").exit_code == 0);
}

TEST_CASE("Two bakes into one folder come one after the other, and caches keep none of the other's files",
          "[command][unlucky][slow]") {
  const TemporaryDirectory folder;
  const std::filesystem::path input = folder.path() / "map.hdr";
  REQUIRE(run_welkin("testmap --size 64 -o " + quoted(input)).exit_code == 0);
  const auto bake = [&](const std::string& size, const std::string& out) {
    return "bake " + quoted(input) + " -q --irradiance 4 --brdf 8 --preview-size 32 --formats ktx2,env,exr --size " +
           size + " -o " + quoted(folder.path() / out);
  };
  REQUIRE(run_welkin(bake("16", "alone16")).exit_code == 0);
  REQUIRE(run_welkin(bake("32", "alone32")).exit_code == 0);
  for (int run = 0; run < 4; ++run) {
    const std::string cache = " --cache " + quoted(folder.path() / ("cache" + std::to_string(run)));
    const std::string both = "'" WELKIN_COMMAND "' " + bake("16", "both") + cache + " & '" WELKIN_COMMAND "' " +
                             bake("32", "both") + cache + " & wait";
    REQUIRE(run_script(both).exit_code == 0);
    const int size = manifest_of(folder.path() / "both").at("options").at("size");
    check_same_files(folder.path() / "both", folder.path() / ("alone" + std::to_string(size)));
    for (const std::string& kept : {std::string("16"), std::string("32")}) {
      REQUIRE(run_welkin(bake(kept, "kept") + cache).exit_code == 0);
      REQUIRE(manifest_of(folder.path() / "kept").at("times").size() == 1);  // all of it is from the cache
      check_same_files(folder.path() / "kept", folder.path() / ("alone" + kept));
    }
  }
}

TEST_CASE("A bake that waits for another in its folder ends by a signal", "[command][unlucky][slow]") {
  const TemporaryDirectory folder;
  const std::filesystem::path out = folder.path() / "out";
  std::filesystem::create_directory(out);
  platform::FolderLock other(out);
  REQUIRE(other.take());
  const std::string line = "timeout --foreground -s INT 2 '" WELKIN_COMMAND
                           "' bake --sky --size 16 --irradiance 4 --brdf 8 --formats ktx2 --no-previews -o " +
                           quoted(out);
  const CommandResult result = run_script(line + "; test $? = 124");
  INFO(result.errors);
  CHECK(result.exit_code == 0);
  CHECK(contains(result.errors, "welkin: stopped ("));
  CHECK(names_in(out).empty());
}

TEST_CASE("Standard streams that the caller has closed become nobody's", "[command][unlucky][slow]") {
  const TemporaryDirectory folder;
  const auto run = [](const std::string& command, const std::string& closed) {
    return run_script("exec '" WELKIN_COMMAND "' " + command + ' ' + closed);
  };
  // The output of --verbose would otherwise go to the first opened file: the pipe by which signals stop the work.
  const std::string bake =
      "bake " + small_image() + " --size 16 --irradiance 4 --brdf 8 --formats ktx2 --preview-size 32 --verbose -o ";
  for (const std::string closed : {">&- 2>&-", "<&- >&- 2>&-", "<&- >&-", "2>&-"}) {
    const std::filesystem::path out = folder.path() / "out";
    const CommandResult result = run(bake + quoted(out), closed);
    INFO(closed);
    const bool has_output = closed == "2>&-";
    CHECK(result.exit_code == (has_output ? 0 : 1));  // the table has nowhere to go
    REQUIRE(std::filesystem::exists(out / "manifest.json"));
    for (const auto& file : manifest_of(out).at("files")) {
      CHECK(std::filesystem::file_size(out / file.at("name").get<std::string>()) == file.at("bytes"));
    }
    std::filesystem::remove_all(out);
  }
  CHECK(run("info -", "<&-").exit_code == 1);
}

TEST_CASE("A pipe is an input as good as a file", "[command][unlucky]") {
  const TemporaryDirectory folder;
  const std::filesystem::path input = folder.path() / "in.pfm";
  const std::filesystem::path pipe = folder.path() / "pipe";
  write_pfm(input, 8, 4, grey_image(8, 4, 0.5F));
  REQUIRE(mkfifo(pipe.c_str(), 0600) == 0);
  const auto run = [&](const std::string& command) {
    return run_script("cat " + quoted(input) + " >" + quoted(pipe) + " & timeout 60 '" WELKIN_COMMAND "' " + command +
                      ' ' + quoted(pipe));
  };
  const std::string out = quoted(folder.path() / "out");
  for (const std::string& command :
       {std::string("info"), std::string("sh --json"), "sh --cache " + quoted(folder.path() / "cache"),
        "bake --size 8 --irradiance 2 --brdf 8 --no-previews --cache " + quoted(folder.path() / "cache") + " -o " +
            out}) {
    const CommandResult result = run(command);
    INFO(command << result.errors);
    CHECK(result.exit_code == 0);
  }
  CHECK(manifest_of(folder.path() / "out").at("source").at("layout") == "lat-long");
}

TEST_CASE("A signal ends a command that waits for its input", "[command][unlucky][slow]") {
  const TemporaryDirectory folder;
  const std::filesystem::path pipe = folder.path() / "pipe";
  REQUIRE(mkfifo(pipe.c_str(), 0600) == 0);
  for (const std::string& command :
       {std::string("sleep 2 | timeout --foreground -s INT 1 '" WELKIN_COMMAND "' sh -"),
        "timeout --foreground -s INT 1 '" WELKIN_COMMAND "' bake -o out " + quoted(pipe)}) {
    write_text(folder.path() / "run.sh", command);
    // Killed later, it would not say so. (Without --foreground timeout sends each signal twice.)
    const CommandResult result = run_program("timeout", "-s KILL 10 /bin/sh " + quoted(folder.path() / "run.sh"));
    INFO(command << result.errors);
    CHECK(contains(result.errors, "welkin: stopped (Interrupt)"));
  }
}

TEST_CASE("A sky writes over no file that it reads", "[command][unlucky][slow]") {
  const TemporaryDirectory folder;
  const std::string air = printed_by("sky --print-atmosphere");
  const std::filesystem::path out = folder.path() / "out";
  std::filesystem::create_directory(out);
  const auto in = [&](const std::string& name) { return quoted(folder.path() / name); };
  const std::string sky = "sky --table-size 8,16,16,4 --orders 2 ";
  const std::string sweep = " --sweep-tiles 2 --sweep-size 16 --sweep " + in("day.png");
  const std::string bake = " --size 16 --image-height 16 --irradiance 4 --brdf 8 --no-previews -o " + in("out");
  // The text of a sweep, and the image of a bake.
  for (const auto& [name, rest] :
       {std::pair(std::string("day.txt"), sweep), std::pair(std::string("out/sky.exr"), bake)}) {
    write_text(folder.path() / name, air);
    INFO(name);
    CHECK(contains(failure(sky + "--atmosphere " + in(name) + rest, 1), "is read, and"));
    CHECK(file_text(folder.path() / name) == air);
    std::filesystem::remove(folder.path() / name);
    // Tables would overwrite the same file.
    CHECK(run_welkin(sky + "--tables " + in(name) + rest).exit_code == 1);
    CHECK_FALSE(std::filesystem::exists(folder.path() / name));
  }
  CHECK(run_welkin(sky + "--tables " + in("day.tables") + sweep).exit_code == 0);
}

TEST_CASE("Numbers beyond floats are refused by name, and never stand in a C header", "[command][unlucky]") {
  const TemporaryDirectory folder;
  const std::filesystem::path bright = folder.path() / "bright.pfm";
  write_pfm(bright, 8, 4, grey_image(8, 4, 3e38F));
  const std::string header = failure("sh --format c " + quoted(bright), 1);
  CHECK(contains(header, "bright.pfm: a number of the light is"));
  CHECK(contains(header, "which exceeds the range of floats"));
  // A bake has the same light as JSON, and all its other files.
  const nlohmann::json bake = bake_into(folder.path() / "bright", quoted(bright) + " --size 16 --no-previews");
  CHECK(contains(bake.at("notes").dump(), "sh.h is omitted"));
  CHECK_FALSE(std::filesystem::exists(folder.path() / "bright" / "sh.h"));
  CHECK(file_of(bake, "sh.json").at("bands") == 3);

  const std::filesystem::path out = folder.path() / "out";
  bake_into(out, small_image() + " --size 16 --irradiance 4 --brdf 8 --formats env --no-previews");
  std::string env = file_text(out / "environment.env");
  const std::size_t end = env.find('\0', 8);
  nlohmann::json manifest = json_of(env.substr(8, end - 8));
  manifest["irradiance"]["xx"] = {1e308, 1e308, 1e308};
  write_text(folder.path() / "huge.env", env.substr(0, 8) + manifest.dump() + env.substr(end));
  for (const std::string& command :
       {std::string("sh "), std::string("info "), "bake --size 16 -o " + quoted(folder.path() / "none") + ' '}) {
    const std::string said = failure(command + quoted(folder.path() / "huge.env"), 1);
    CHECK(contains(said, "huge.env: "));
    CHECK(contains(said, "polynomial"));
  }
}

TEST_CASE("Memory is refused by the header, before pixels are read, with a remedy that helps", "[command][unlucky]") {
  const TemporaryDirectory folder;
  // Its pixels are not there, so that reading them would be another error.
  const std::filesystem::path large = folder.path() / "large.pfm";
  write_text(large, "PF\n16384 8192\n-1.0\n");
  std::filesystem::resize_file(large, 19 + std::uint64_t{16384} * 8192 * 12);
  const auto start = std::chrono::steady_clock::now();
  const std::string refused =
      failure("bake " + quoted(large) + " --size 16 --memory-limit 2GiB -o " + quoted(folder.path() / "none"), 1);
  CHECK(std::chrono::steady_clock::now() - start < std::chrono::seconds(kSanitized ? 20 : 2));
  CHECK(contains(refused, "'welkin convert' with --size"));

  // The remedy, on an image that does not take minutes.
  const std::filesystem::path input = folder.path() / "in.pfm";
  write_pfm(input, 512, 256, grey_image(512, 256, 0.5F));
  const std::string bake = " --size 16 --irradiance 4 --brdf 8 --formats ktx2 --no-previews --memory-limit 40MiB -o " +
                           quoted(folder.path() / "out");
  REQUIRE(contains(failure("bake " + quoted(input) + bake, 1), "'welkin convert' with --size"));
  const std::filesystem::path smaller = folder.path() / "smaller.exr";
  printed_by("convert " + quoted(input) + ' ' + quoted(smaller) + " --size 32 --memory-limit 40MiB");
  printed_by("bake " + quoted(smaller) + bake);
}

TEST_CASE("Control characters in names of files never reach a terminal", "[command][unlucky][slow]") {
  const TemporaryDirectory folder;
  const std::string name =
      "a\x1b[31m\x07\xc2\x9b"
      "2J\nb\x9b\xe2\x80\xae\xed\xa0\x80\xc3\xa9";
  const std::filesystem::path there = folder.path() / (name + ".pfm");
  write_pfm(there, 8, 4, grey_image(8, 4, 0.5F));
  const std::filesystem::path broken = folder.path() / (name + "x.pfm");
  write_text(broken, "PF\n8 4\n-1.0\nshort");
  const std::filesystem::path absent = folder.path() / (name + "y.pfm");
  const auto clean = [](const std::string& text) {
    return std::none_of(text.begin(), text.end(),
                        [](char c) { return (c >= 0 && c < ' ' && c != '\n') || c == '\x7f'; }) &&
           !contains(text, "\xc2\x9b") && !contains(text, "b\x9b") && !contains(text, "\xe2\x80\xae") &&
           !contains(text, "\xed\xa0\x80");
  };
  for (const std::filesystem::path& file : {there, broken, absent}) {
    for (const std::string& command :
         {std::string("info "), std::string("sh "), std::string("sh --format text "), std::string("sh --format c "),
          "bake --size 8 --irradiance 2 --brdf 8 --explain -o " + quoted(folder.path() / (name + "out")) + ' ',
          "convert --layout vertical-strip --size 4 " + quoted(folder.path() / (name + "z.pfm")) + ' '}) {
      const CommandResult result = run_welkin(command + quoted(file));
      INFO(command << result.output << result.errors);
      CHECK(clean(result.output));
      CHECK(clean(result.errors));
      CHECK((result.output + result.errors).find("a?[31m??2J?b?????\xc3\xa9") != std::string::npos);
    }
  }
  // JSON has them as escapes, so that programs read the name itself.
  const CommandResult json = run_welkin("sh --json " + quoted(there));
  CHECK(clean(json.output));
  CHECK(contains(json_of(json.output).at("source").at("path").get<std::string>(), "a\x1b[31m\x07\xc2\x9b"));
}

}  // namespace welkin::test
