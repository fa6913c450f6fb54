#include "perf/report/passes.h"

#include <array>

#include "welkin/core.h"

namespace welkin::report {
namespace {

SkyTableOptions sized(int heights, int views, int suns, int angles, ScatteringLayout layout = ScatteringLayout::full) {
  SkyTableOptions options;
  options.layout = layout;
  options.heights = heights;
  options.view_zeniths = views;
  options.sun_zeniths = suns;
  options.sun_angles = angles;
  options.orders = 1;
  return options;
}

Scale tiny() {
  Scale scale;
  scale.name = "tiny";
  scale.budget_seconds = 0.01;
  scale.lat_long_width = 128;
  scale.cube_size = 32;
  scale.chain_size = 32;
  scale.probes = 40;
  scale.most_samples = 256;
  scale.most_bands = 5;
  scale.largest_table = 32;
  scale.table_truth = 48;
  scale.sun_elevations = {40.0, 2.0};
  scale.sky_zeniths = 8;
  scale.sky_azimuths = 8;
  scale.sky_tables = {sized(4, 16, 8, 4), sized(8, 16, 16, 4)};
  scale.peers = false;
  return scale;
}

Scale quick() {
  Scale scale;
  scale.name = "quick";
  scale.budget_seconds = 0.03;
  scale.lat_long_width = 512;
  scale.cube_size = 256;
  scale.chain_size = 128;
  scale.probes = 120;
  scale.most_samples = 1024;
  scale.most_bands = 7;
  scale.largest_table = 128;
  scale.table_truth = 160;
  scale.sun_elevations = {60.0, 20.0, 2.0, -4.0};
  scale.sky_zeniths = 20;
  scale.sky_azimuths = 16;
  scale.sky_tables = {sized(8, 16, 16, 4), sized(16, 32, 16, 4), sized(32, 64, 32, 8, ScatteringLayout::compact),
                      sized(16, 32, 32, 8), sized(16, 64, 64, 8)};
  return scale;
}

Scale full() {
  Scale scale = quick();
  scale.name = "full";
  scale.budget_seconds = 0.4;
  scale.lat_long_width = 1024;
  scale.cube_size = 1024;
  scale.chain_size = 256;
  scale.probes = 240;
  scale.most_samples = 4096;
  scale.most_bands = 9;
  scale.largest_table = 256;
  scale.table_truth = 384;
  scale.sun_elevations = {90.0, 60.0, 30.0, 10.0, 5.0, 2.0, 0.0, -2.0, -4.0, -6.0};
  scale.sky_zeniths = 40;
  scale.sky_azimuths = 32;
  scale.sky_tables.push_back(sized(32, 64, 64, 8));
  scale.sky_tables.insert(scale.sky_tables.end() - 1, sized(32, 128, 64, 8));
  return scale;
}

}  // namespace

const Scale& scale(const std::string& name) {
  static const std::array<Scale, 3> all{tiny(), quick(), full()};
  for (const Scale& one : all) {
    if (one.name == name) return one;
  }
  throw Error(ErrorCode::invalid_argument, "\"" + name + "\" is no scale of a report; there are tiny, quick and full");
}

std::vector<std::string> scale_names() { return {"tiny", "quick", "full"}; }

void progress(const PassContext& context, std::size_t done, std::size_t of) {
  if (context.control.stop.stop_requested()) throw Error(ErrorCode::cancelled, "the report was cancelled");
  if (context.control.progress) context.control.progress(static_cast<double>(done) / static_cast<double>(of));
}

}  // namespace welkin::report
