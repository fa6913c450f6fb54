// `welkin importance`: the files it writes and what it says of them.
#include <nlohmann/json.hpp>

#include "support/catch.h"
#include "support/images.h"
#include "support/test_environments.h"
#include "tools/command.h"
#include "welkin/environment_file.h"
#include "welkin/importance.h"

namespace welkin::test {

TEST_CASE("importance: files hold the library's tables", "[tools][importance]") {
  const TemporaryDirectory scratch;
  const auto input = scratch.path() / "sky.exr";
  const TestLatLong image = make_lat_long(Content::high_range, 20, 10, 3);
  write_environment(input, image.view(), {.type = SampleType::float32});
  const auto folder = scratch.path() / "a" / "tables";
  printed_by("importance " + quoted(input) + " -o " + quoted(folder) +
             " --width 8 --height 5 --weight largest --mis-compensation --alias --pyramid");
  const ImportanceTable table = importance_table(
      image.view(), {.width = 8, .height = 5, .weight = ImportanceWeight::largest, .mis_compensation = true});
  CHECK(npy_values<float>(folder / "function.npy", "'<f4'", "(5, 8)") == table.function);
  CHECK(npy_values<float>(folder / "row_cdf.npy", "'<f4'", "(6, )") == table.row_cdf);
  CHECK(npy_values<float>(folder / "column_cdf.npy", "'<f4'", "(5, 9)") == table.column_cdf);
  const AliasTable alias = alias_table(table);
  const auto rows = npy_values<AliasEntry>(folder / "alias_rows.npy", "[('own', '<f4'), ('other', '<u4')]", "(5, )");
  REQUIRE(rows.size() == 5);
  for (std::size_t k = 0; k < 5; ++k) {
    CHECK(rows[k].own == alias.rows[k].own);
    CHECK(rows[k].other == alias.rows[k].other);
  }
  const ImportancePyramid pyramid = importance_pyramid(table);
  for (std::size_t level = 0; level < pyramid.levels.size(); ++level) {
    const auto& each = pyramid.levels[level];
    CHECK(npy_values<float>(folder / ("pyramid_" + std::to_string(level) + ".npy"), "'<f4'",
                            "(" + std::to_string(each.height) + ", " + std::to_string(each.width) + ")") ==
          each.probabilities);
  }
  const auto said = json_of(read_text(folder / "importance.json"));
  CHECK(said.at("width") == 8);
  CHECK(said.at("height") == 5);
  CHECK(said.at("weight") == "largest");
  CHECK(said.at("mis_compensation") == true);
  CHECK(std::abs(said.at("integral").get<double>() - table.integral) < 1e-12 * table.integral);
  CHECK(said.at("files").size() == 5 + pyramid.levels.size());
}

TEST_CASE("importance: cubemaps do, and what cannot be is refused", "[tools][importance][slow]") {
  const TemporaryDirectory scratch;
  const auto cube = scratch.path() / "cube.pfm";
  REQUIRE(run_welkin("testmap --size 8 --layout vertical-strip -o " + quoted(cube)).exit_code == 0);
  const auto said = json_printed_by("importance " + quoted(cube) + " --json -o " + quoted(scratch.path() / "tables"));
  CHECK(said.at("width") == 32);
  CHECK(said.at("height") == 16);
  CHECK(said.at("variance").at("table").get<double>() < 0.2 * said.at("variance").at("uniform").get<double>());
  CHECK(run_welkin("importance " + quoted(cube) + " --width 1000 -o " + quoted(scratch.path() / "b")).exit_code == 2);
  CHECK(run_welkin("importance " + quoted(cube) + " --width 0 -o " + quoted(scratch.path() / "b")).exit_code == 2);
  CHECK(run_welkin("importance -o " + quoted(scratch.path() / "b")).exit_code == 2);
  CHECK(run_welkin("importance " + quoted(cube) + " -o " + quoted(cube)).exit_code == 1);
}

}  // namespace welkin::test
