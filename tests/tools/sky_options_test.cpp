// `welkin sky`: what cannot be is refused with exit code 2 and the option's name, before any work.
#include "tools/sky_command.h"
#include "tools/temporary_folder.h"

using namespace welkin::test;

TEST_CASE("sky: numbers out of range are refused by name", "[tools][sky]") {
  for (const char* option : {"--sun-elevation 90.001",
                             "--sun-elevation -91",
                             "--sun-elevation nan",
                             "--sun-elevation inf",
                             "--sun-elevation up",
                             "--sun-azimuth nan",
                             "--sun-azimuth inf",
                             "--altitude -1",
                             "--altitude nan",
                             "--altitude 2e9",
                             "--orders 0",
                             "--orders 65",
                             "--orders 1.5",
                             "--ground-albedo -0.1",
                             "--ground-albedo 1.1",
                             "--ground-albedo nan",
                             "--until-change -1",
                             "--until-change nan",
                             "--colour rgb",
                             "--layout 4d",
                             "--table-size 32,128",
                             "--table-size 1,2,3,4,5",
                             "--table-size a,b,c",
                             "--quadrature monte-carlo",
                             "--directions 16",
                             "--preset venus",
                             "--bands 0",
                             "--bands 17",
                             "--window-width 0",
                             "--for doom",
                             "--threads -1",
                             "--memory-limit -1",
                             "--format xml"}) {
    const std::string name = std::string(option).substr(0, std::string(option).find(' '));
    const std::string said = sky_failure(option, 2);
    INFO(option << ": " << said);
    CHECK(contains(said, name));
  }
}

TEST_CASE("sky: what the library refuses is the command line's fault", "[tools][sky]") {
  for (const char* option :
       {"--table-size 1,128,32,8", "--table-size 32,127,32,8", "--table-size 32,128,32,1", "--directions 1,17",
        "--directions 16,257", "--wavelengths 680,550", "--wavelengths 680,550,nan", "--wavelengths 100,200,300",
        "--wavelengths 450,500,550,600", "--preset mars --wavelengths 680,550,440"}) {
    INFO(option);
    CHECK_FALSE(sky_failure(option, 2).empty());
  }
  CHECK(contains(sky_failure("--wavelengths 450,500,550,600", 2), "--colour srgb"));
  CHECK(contains(sky_failure("--preset mars --wavelengths 680,550,440", 2), "--wavelengths"));
  CHECK(contains(sky_failure("--memory-limit 1MB", 1), "limit"));
}

TEST_CASE("sky: options that do not go together are refused", "[tools][sky]") {
  const TemporaryFolder folder;
  const std::string out = quoted(folder.path() / "out");
  const std::string day = "--sweep " + quoted(folder.path() / "day.png");
  for (const std::string& arguments : {std::string("--size 64"),
                                       std::string("--sun-disc"),
                                       std::string("--formats exr"),
                                       std::string("--picture-height 64"),
                                       std::string("--sweep-to -6"),
                                       std::string("--sweep-tiles 3"),
                                       "-o " + out + " --format c",
                                       "-o " + out + " " + day,
                                       "-o " + out + " --window least",
                                       "-o " + out + " --quadrature gauss",
                                       "-o " + out + " --directions 8,8",
                                       day + std::string(" --json"),
                                       day + std::string(" --sun-azimuth 5"),
                                       day + std::string(" --quadrature gauss"),
                                       day + std::string(" --directions 8,8"),
                                       day + std::string(" --bands 2"),
                                       day + std::string(" --window least"),
                                       day + std::string(" --for unity"),
                                       "-o " + out + " --size 0",
                                       "-o " + out + " --picture-height 0",
                                       "--sweep " + quoted(folder.path() / "day.jpg"),
                                       day + std::string(" --sweep-tiles 0"),
                                       day + std::string(" --sweep-to -91"),
                                       day + std::string(" --sweep-size 4"),
                                       std::string("--json --format text"),
                                       std::string("input.hdr")}) {
    INFO(arguments);
    CHECK_FALSE(sky_failure(arguments, 2).empty());
  }
  CHECK_FALSE(std::filesystem::exists(folder.path() / "out"));
  CHECK_FALSE(std::filesystem::exists(folder.path() / "day.png"));
}

TEST_CASE("sky: a table for a person says what sky it is", "[tools][sky]") {
  const CommandResult result = run_welkin("sky --sun-elevation 20 " + kSmallSky);
  CHECK(result.exit_code == 0);
  CHECK(result.errors.empty());
  for (const char* part : {"computed sky", "sun 20 degrees up", "altitude 0 m", "2 orders", "ground albedo 0.1",
                           "4 x 16 x 8 x 4", "W/m2/sr/nm at 680, 550, 440 nm", "Sun, apart", "degrees radius",
                           "radiance r, g, b", "directions asked", "gauss"}) {
    INFO(part);
    CHECK(contains(result.output, part));
  }
  CHECK_FALSE(contains(result.output, "taken out"));
  CHECK(contains(run_welkin("sky --sun-elevation -4 " + kSmallSky).output, "4 degrees below the horizon"));
  CHECK(contains(run_welkin("sky --for unity --format c " + kSmallSky).output, "computed_sky_unity"));
  CHECK(contains(run_welkin("sky --format text " + kSmallSky).output, "sun.solid_angle"));
}
