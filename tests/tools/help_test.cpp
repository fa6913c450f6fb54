// --help teaches: what the command does, examples that run, units and exit codes.
#include "support/catch.h"
#include "tools/command.h"
#include "welkin/instruction_set.h"
#include "welkin/version.h"

using namespace welkin::test;

TEST_CASE("command: --help teaches", "[tools]") {
  for (const char* arguments : {"--help", "bake --help", "sh --help", "sky --help", "info --help", "convert --help",
                                "testmap --help", "report --help", "-h"}) {
    const CommandResult result = run_welkin(arguments);
    INFO("welkin " << arguments);
    CHECK(result.exit_code == 0);
    CHECK(result.errors.empty());
    CHECK(contains(result.output, "Usage: welkin"));
    CHECK(contains(result.output, "Examples:"));
    CHECK(contains(result.output, "Units:"));
    CHECK(contains(result.output, "Exit codes:"));
  }
}

TEST_CASE("command: sh --help names every option", "[tools]") {
  const CommandResult result = run_welkin("sh --help");
  for (const char* option : {"INPUT", "--json", "--bands", "--quadrature exact|midpoint", "--target-size", "--layout",
                             "vertical-strip", "--clamp", "--preserve-clamped", "--gamma", "--nan", "--infinity",
                             "--negative keep|replace|reject", "--threads", "--memory-limit"}) {
    INFO(option);
    CHECK(contains(result.output, option));
  }
}

TEST_CASE("command: sky --help names every option", "[tools][sky]") {
  const CommandResult result = run_welkin("sky --help");
  for (const char* option : {"--sun-elevation",
                             "--sun-azimuth",
                             "--altitude",
                             "--no-ground",
                             "--preset earth|earth-hillaire|mars|no-aerosol",
                             "--atmosphere FILE",
                             "--wavelengths",
                             "--ground-albedo",
                             "--print-atmosphere",
                             "--orders",
                             "--until-change",
                             "--colour spectral|srgb",
                             "--layout full|compact",
                             "--table-size",
                             "--tables FILE",
                             "--quadrature article|gauss|gauss-split",
                             "--directions",
                             "--json",
                             "--bands",
                             "--for",
                             "--sweep FILE.png",
                             "--sweep-to",
                             "--output",
                             "--picture-height",
                             "--sun-disc",
                             "--size",
                             "--formats",
                             "--memory-limit",
                             "--threads"}) {
    INFO(option);
    CHECK(contains(result.output, option));
  }
}

TEST_CASE("command: bake --help names every option", "[tools]") {
  const CommandResult result = run_welkin("bake --help");
  for (const char* option : {"INPUT",
                             "--output",
                             "--json",
                             "--size",
                             "--background-size",
                             "--mips",
                             "--roughness filament|linear|babylon|LIST",
                             "--method automatic|spectral|sampled|reference",
                             "--samples",
                             "--irradiance",
                             "--irradiance-method",
                             "--bands",
                             "--brdf",
                             "--brdf-model",
                             "--no-brdf",
                             "--formats",
                             "--ktx2-format rgba16f|rgba32f|b10g11r11|e5b9g9r9",
                             "--supercompression none|zlib|zstd",
                             "--no-previews",
                             "--for",
                             "--clamp",
                             "--nan",
                             "--threads",
                             "--memory-limit"}) {
    INFO(option);
    CHECK(contains(result.output, option));
  }
}

TEST_CASE("command: report --help names every option and pass", "[tools][report]") {
  const CommandResult result = run_welkin("report --help");
  for (const char* part : {"--output", "--json", "--csv", "--plots", "--scale", "--quick", "--passes", "--environment",
                           "--threads", "--against", "--error-factor", "--time-factor", "--node-modules", "--no-peers",
                           "--stability", "project-cubemap", "prefilter-file", "sky-tables"}) {
    INFO(part);
    CHECK(contains(result.output, part));
  }
}

TEST_CASE("command: --version tells version and instruction sets", "[tools]") {
  const CommandResult result = run_welkin("--version");
  CHECK(result.exit_code == 0);
  CHECK(contains(result.output, "welkin " WELKIN_VERSION_STRING));
  for (const auto set : welkin::available_instruction_sets()) CHECK(contains(result.output, welkin::name(set)));
  CHECK(contains(run_welkin("--version", "WELKIN_ISA=sse2").output, "in use: sse2"));
}
