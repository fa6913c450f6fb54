// The same input gives the same output: on any number of threads, on every instruction set.
#include <filesystem>
#include <string>
#include <vector>

#include "places.h"
#include "support/catch.h"
#include "tools/command.h"
#include "welkin/instruction_set.h"

using namespace welkin;
using namespace welkin::test;

namespace {

/// The built-in sky, and two of the shared photographs where they are.
std::vector<std::string> inputs() {
  std::vector<std::string> list = {""};
  for (const char* name : {"blender_city.exr", "openexr_KernerEnvCube.exr"}) {
    const auto path = std::filesystem::path(WELKIN_SHARED) / "hdr" / "env" / name;
    if (std::filesystem::exists(path)) list.push_back(quoted(path));
  }
  return list;
}

}  // namespace

TEST_CASE("sh: the same output on any number of threads", "[tools]") {
  for (const std::string& input : inputs()) {
    const nlohmann::json expected = run_sh_json_without_times("--threads 1 " + input);
    for (const char* threads : {"--threads 2 ", "--threads 5 ", ""}) {
      INFO(threads << input);
      CHECK(run_sh_json_without_times(threads + input) == expected);
    }
  }
}

TEST_CASE("sh: the same output on every instruction set", "[tools]") {
  for (const std::string& input : inputs()) {
    const nlohmann::json expected = run_sh_json_without_times("--bands 6 " + input);
    for (const InstructionSet set : available_instruction_sets()) {
      INFO(name(set) << ' ' << input);
      CHECK(run_sh_json_without_times("--bands 6 " + input, std::string("WELKIN_ISA=") + name(set)) == expected);
    }
  }
}
