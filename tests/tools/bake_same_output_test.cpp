// Promise: the same input gives the same files, bit for bit, on any number of threads and every instruction set; only
// the times in the manifest differ.
#include "tools/baked_folder.h"
#include "tools/temporary_folder.h"
#include "welkin/instruction_set.h"

using namespace welkin;
using namespace welkin::test;

namespace {

void check_same(const std::filesystem::path& folder, const std::filesystem::path& expected) {
  REQUIRE(names_in(folder) == names_in(expected));
  for (const std::string& name : names_in(expected)) {
    INFO(name);
    if (name == "manifest.json") {
      nlohmann::json ours = manifest_of(folder);
      nlohmann::json theirs = manifest_of(expected);
      for (nlohmann::json* manifest : {&ours, &theirs}) {
        for (auto& pass : manifest->at("times")) pass.erase("ms");
      }
      CHECK(ours == theirs);
    } else {
      CHECK((file_text(folder / name) == file_text(expected / name)));
    }
  }
}

const std::string kOptions = "--size 64 --irradiance 16 --brdf 16 --formats ktx2,dds,exr,env ";

}  // namespace

TEST_CASE("bake: the same files on any number of threads", "[tools][bake]") {
  const TemporaryFolder scratch;
  const auto expected = scratch.path() / "one";
  bake_into(expected, kOptions + "--threads 1");
  for (const char* threads : {"--threads 2", "--threads 5", ""}) {
    INFO(threads);
    bake_into(scratch.path() / "many", kOptions + threads);
    check_same(scratch.path() / "many", expected);
  }
}

TEST_CASE("bake: the same files on every instruction set", "[tools][bake]") {
  const TemporaryFolder scratch;
  const auto expected = scratch.path() / "expected";
  bake_into(expected, kOptions);
  for (const InstructionSet set : available_instruction_sets()) {
    INFO(name(set));
    bake_into(scratch.path() / "set", kOptions, std::string("WELKIN_ISA=") + name(set));
    check_same(scratch.path() / "set", expected);
  }
}
