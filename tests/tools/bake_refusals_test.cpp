
#include "support/exr_files.h"
#include "tools/command.h"

using namespace welkin;
using namespace welkin::test;

// Refusals of `welkin bake`: the exit codes and messages, and that every file stays as it was.

namespace {

constexpr const char* kSmall = " --size 16 --irradiance 8 --brdf 16 ";

}  // namespace

TEST_CASE("bake: an input that would be written over is refused before any work, and kept",
          "[tools][bake][posix][slow]") {
  const TemporaryDirectory scratch;
  const auto own = scratch.path() / "own";
  const std::string all = " --formats ktx2,dds,exr,hdr,pfm,env --mips 3 --preview-size 16" + std::string(kSmall);
  bake_into(own, small_image() + all);
  const auto refused = [&](const std::string& input, const std::string& folder, const std::string& options,
                           const std::filesystem::path& kept) {
    const std::string before = file_text(kept);
    const std::string message = failure("bake " + input + " -o " + folder + options, 1);
    INFO(message);
    CHECK(contains(message, "would write over it"));
    CHECK(contains(message, "another folder"));
    CHECK((file_text(kept) == before));
    CHECK(std::filesystem::exists(own / "manifest.json"));  // the old folder stays complete
  };
  for (const std::string& name : names_in(own)) {
    if (name == "manifest.json" || name.substr(0, 3) == "sh." || name.substr(0, 5) == "brdf.") continue;  // no spheres
    INFO(name);
    const std::string plain = name.substr(0, 8) == "preview_" ? " --layout lat-long" : "";
    refused(quoted(own / name), quoted(own), plain + all, own / name);
  }
  refused(quoted(own / "environment.hdr"), quoted(own), " --formats hdr", own / "environment.hdr");

  // Other names of the input: a link to it, a link from the folder, a roundabout path.
  std::filesystem::create_symlink(own / "environment.hdr", scratch.path() / "link.hdr");
  refused(quoted(scratch.path() / "link.hdr"), quoted(own), " --formats hdr", own / "environment.hdr");
  refused(quoted(own / ".." / "own" / "environment.hdr"), quoted(own), " --formats hdr", own / "environment.hdr");
  const auto photograph = scratch.path() / "photograph.hdr";
  std::filesystem::copy_file(own / "environment.hdr", photograph);
  std::filesystem::remove(own / "environment.hdr");
  std::filesystem::create_symlink(photograph, own / "environment.hdr");
  refused(quoted(photograph), quoted(own), " --formats hdr", photograph);

  // A file that is not written may be read from the folder.
  bake_into(own, quoted(own / "environment.exr") + " --formats ktx2 --no-previews" + kSmall);
}

TEST_CASE("bake: none of six files is written over", "[tools][bake][posix]") {
  const TemporaryDirectory scratch;
  const auto faces = scratch.path() / "faces";
  const auto own = scratch.path() / "own";
  std::filesystem::create_directory(faces);
  std::filesystem::create_directory(own);
  for (const std::string face : {"px", "nx", "py", "ny", "pz", "nz"}) {
    write_pfm(faces / (face + ".pfm"), 8, 8, some_pixels(8, 8));
  }
  std::filesystem::create_symlink(faces / "nz.pfm", own / "specular.pfm");
  const std::string before = file_text(faces / "nz.pfm");
  const std::string options = " --formats pfm --no-previews --size 8 --mips 1 --irradiance 8 --brdf 8";
  for (const std::string& input : {quoted(faces / "py.pfm") + " --layout six-files", quoted(faces)}) {
    INFO(input);
    const std::string message = failure("bake " + input + " -o " + quoted(own) + options, 1);
    CHECK(contains(message, "nz.pfm: is read"));
    CHECK(contains(message, "as specular.pfm"));
    CHECK(names_in(own) == std::vector<std::string>{"specular.pfm"});
    CHECK((file_text(faces / "nz.pfm") == before));
  }
  bake_into(scratch.path() / "other", quoted(faces) + options);
}

TEST_CASE("bake: bad usage exits with 2, and makes no folder", "[tools][bake][slow]") {
  const TemporaryFile out("out");
  CHECK(contains(failure("bake", 2), "INPUT is missing"));
  check_refused("bake --sky -o " + quoted(out),
                {{"--size", {"0", "8193", "4 --mips 4"}},
                 {"--mips", {"15", "-1", "0", "some", "3 --roughness 0,1"}},
                 {"--roughness", {"0,2", "rough", "0,0.5,0.2"}},
                 {"--irradiance", {"-1"}},
                 {"--brdf", {"0"}},
                 {"--brdf-model", {"x"}},
                 {"--no-brdf", {"--brdf 8"}},
                 {"--no-diffuse", {"--irradiance 8"}},
                 {"--bands", {"17", "5 --error-budget 1e-2"}},
                 {"--method", {"magic"}},
                 {"--rms-error", {"0", "nan", "1.5", "-1e-3", "small", "1e-2 --error-budget 1e-2"}},
                 {"--error-budget", {"2"}},
                 {"--quality", {"best", "fast --error-budget 1e-2"}},
                 {"--irradiance-method", {"bands"}},
                 {"--formats", {"ktx3", "''"}},
                 {"--ktx2-format", {"bc7"}},
                 {"--supercompression", {"rar"}},
                 {"--layout", {"lat-long"}},
                 {"--clamp", {"0"}},
                 {"--gamma", {"--extract-sun"}},
                 {"--threads", {"-1"}}});
  for (const char* engine : {"blender --formats ktx2", "usd --lobe charlie"}) {
    CHECK(contains(failure("bake --sky -o " + quoted(out) + " --for " + engine, 2), "no cube faces"));
  }
  CHECK_FALSE(std::filesystem::exists(out));
}

TEST_CASE("bake: bad input exits with 1, and makes no folder", "[tools][bake]") {
  const TemporaryDirectory scratch;
  const auto out = scratch.path() / "out";
  const std::string start = "bake -o " + quoted(out) + " ";
  CHECK(contains(failure(start + quoted(scratch.path() / "missing.exr"), 1), "missing.exr"));
  const auto text = scratch.path() / "text.ktx2";
  std::ofstream(text) << "\xABKTX 20\xBB\r\n\x1A\n and no more";
  CHECK(contains(failure(start + quoted(text), 1), "text.ktx2"));
  const auto nan = scratch.path() / "nan.pfm";
  std::vector<float> pixels = grey_image(8, 4, 1.0F);
  pixels[(2 * 8 + 5) * 3] = std::numeric_limits<float>::quiet_NaN();
  write_pfm(nan, 8, 4, pixels);
  CHECK(contains(failure(start + "--nan reject " + quoted(nan), 1), "row 2"));
  CHECK(contains(failure(start + "--sky --memory-limit 100kB", 1), "limit"));
  const auto infinite = scratch.path() / "infinite.pfm";
  pixels[(2 * 8 + 5) * 3] = std::numeric_limits<float>::infinity();
  write_pfm(infinite, 8, 4, pixels);
  CHECK(contains(failure(start + "--extract-sun --infinity reject " + quoted(infinite), 1), "row 2"));
  CHECK_FALSE(std::filesystem::exists(out));
  CHECK(bake_into(out, quoted(nan) + kSmall).at("diagnostics").at("nans_replaced") == 1);
  const auto diagnostics = bake_into(out, quoted(infinite) + " --extract-sun" + kSmall).at("diagnostics");
  CHECK(diagnostics.at("infinities_replaced") == 1);
}

TEST_CASE("bake: a folder that cannot be had exits with 1 and is named", "[tools][bake]") {
  const TemporaryDirectory scratch;
  const auto file = scratch.path() / "file";
  std::ofstream(file) << "no folder";
  CHECK(contains(failure("bake --sky -o " + quoted(file), 1), file.string()));
  CHECK(contains(failure("bake --sky -o " + quoted(file / "below"), 1), file.string()));
  CHECK(contains(failure("bake --sky -o ''", 1), "-o"));
  CHECK(contains(failure("bake --sky -o /proc/welkin", 1), "/proc/welkin"));
  CHECK(file_text(file) == "no folder");
}
