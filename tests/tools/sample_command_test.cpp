// Promises: `welkin sample` makes an environment like a photograph's in range, out of nothing, the same everywhere.
#include "support/catch.h"
#include "support/temporary_directory.h"
#include "tools/command.h"
#include "welkin/core.h"
#include "welkin/environment_file.h"

using namespace welkin;
using namespace welkin::test;

namespace {

/// Values of the image that `welkin sample` makes.
std::vector<float> sample(int width) {
  const TemporaryDirectory directory;
  const auto path = directory.file("sample.pfm");
  CHECK(printed_by("sample --size " + std::to_string(width) + " -o " + quoted(path)) ==
        path.string() + ": lat-long, " + std::to_string(width) + " x " + std::to_string(width / 2) + "\n");
  return pixels_in(path);
}

}  // namespace

TEST_CASE("sample: a room with a sun, lamps and dark corners, within what half floats hold", "[tools][sample][slow]") {
  std::vector<float> values = sample(128);
  std::sort(values.begin(), values.end());
  CHECK(values.front() >= 0.0F);
  const float dark = values[values.size() / 100];
  CHECK(dark > 0.0F);
  CHECK(values.back() > 1e4F * dark);
  CHECK(values.back() < 65504.0F);
  const float median = values[values.size() / 2];
  CHECK(median > 0.05F);
  CHECK(median < 2.0F);
}

TEST_CASE("sample: refuses what it cannot write, before it computes", "[tools][sample]") {
  CHECK(run_welkin("sample").exit_code == 2);
  CHECK(run_welkin("sample -o sample.jpg").exit_code == 1);
  CHECK(run_welkin("sample --size 0 -o sample.exr").exit_code == 2);
  CHECK(contains(failure("sample --size 65536 --memory-limit 1MiB -o sample.exr", 1), "--memory-limit"));
}
