#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <span>

#include "codec/row_groups.h"
#include "image/texel_geometry.h"
#include "welkin/environment_file.h"

namespace welkin {
namespace codec {
namespace {

// What one row adds. Each row has a slot of its own and slots are added from top to bottom, so that neither
// the number of threads nor the way in which the file is cut shows in the sums.
struct RowStatistics {
  glm::dvec3 minimum{std::numeric_limits<double>::infinity()};
  glm::dvec3 maximum{-std::numeric_limits<double>::infinity()};
  glm::dvec3 flux{};         // sum of value times solid angle
  glm::dvec3 solid_angle{};  // of the finite values
  std::uint64_t nans = 0, infinities = 0, negatives = 0;
  double brightest_luminance = -std::numeric_limits<double>::infinity();
  int brightest_column = 0;
  glm::dvec3 brightest{};
};

double luminance(const glm::dvec3& rgb) { return 0.2126 * rgb.r + 0.7152 * rgb.g + 0.0722 * rgb.b; }

void add_value(RowStatistics& row, int channel, float value, double solid_angle) {
  if (std::isnan(value)) {
    ++row.nans;
    return;
  }
  if (std::isinf(value)) {
    ++row.infinities;
    return;
  }
  const auto wide = static_cast<double>(value);
  row.negatives += value < 0.0F ? 1U : 0U;
  row.minimum[channel] = std::min(row.minimum[channel], wide);
  row.maximum[channel] = std::max(row.maximum[channel], wide);
  row.flux[channel] += wide * solid_angle;
  row.solid_angle[channel] += solid_angle;
}

// `solid_angles`: of each texel.
RowStatistics measure_row(const float* rgb, std::span<const double> solid_angles) {
  RowStatistics row;
  for (std::size_t column = 0; column < solid_angles.size(); ++column) {
    const float* texel = rgb + 3 * column;
    for (int channel = 0; channel < 3; ++channel) {
      add_value(row, channel, texel[channel], solid_angles[column]);
    }
    const glm::dvec3 colour(texel[0], texel[1], texel[2]);
    const double brightness = luminance(colour);
    if (std::isfinite(brightness) && brightness > row.brightest_luminance) {
      row.brightest_luminance = brightness;
      row.brightest_column = static_cast<int>(column);
      row.brightest = colour;
    }
  }
  return row;
}

void fill_solid_angles(const EnvironmentInfo& info, int row, std::span<double> angles) {
  if (info.layout == Layout::lat_long) {
    std::fill(angles.begin(), angles.end(), image::lat_long_texel_solid_angle(info.width, info.height, row));
  } else {
    image::cubemap_row_solid_angles(row % info.width, angles);
  }
}

EnvironmentStatistics summarise(const EnvironmentInfo& info, const std::vector<RowStatistics>& rows) {
  RowStatistics total;
  int brightest_row = 0;
  for (std::size_t index = 0; index < rows.size(); ++index) {
    const RowStatistics& row = rows[index];
    for (int channel = 0; channel < 3; ++channel) {
      total.minimum[channel] = std::min(total.minimum[channel], row.minimum[channel]);
      total.maximum[channel] = std::max(total.maximum[channel], row.maximum[channel]);
    }
    total.flux += row.flux;
    total.solid_angle += row.solid_angle;
    total.nans += row.nans;
    total.infinities += row.infinities;
    total.negatives += row.negatives;
    if (row.brightest_luminance > total.brightest_luminance) {
      total.brightest_luminance = row.brightest_luminance;
      total.brightest_column = row.brightest_column;
      total.brightest = row.brightest;
      brightest_row = static_cast<int>(index);
    }
  }

  EnvironmentStatistics result;
  result.texels = static_cast<std::uint64_t>(info.width) * static_cast<std::uint64_t>(info.height);
  for (int channel = 0; channel < 3; ++channel) {
    if (total.solid_angle[channel] > 0.0) {  // else the channel has no finite value, and its numbers stay 0
      result.minimum[channel] = total.minimum[channel];
      result.maximum[channel] = total.maximum[channel];
      result.mean[channel] = total.flux[channel] / total.solid_angle[channel];
    }
  }
  result.flux = 4.0 * std::numbers::pi * result.mean;
  result.nans = total.nans;
  result.infinities = total.infinities;
  result.negatives = total.negatives;
  result.brightest_column = total.brightest_column;
  result.brightest_row = brightest_row;
  result.brightest = total.brightest;
  const double column = total.brightest_column + 0.5;
  result.brightest_direction =
      info.layout == Layout::lat_long
          ? image::lat_long_direction(info.width, info.height, column, brightest_row + 0.5)
          : image::face_direction(info.width, brightest_row / info.width, column, brightest_row % info.width + 0.5);
  return result;
}

}  // namespace
}  // namespace codec

EnvironmentStatistics measure_environment(const std::filesystem::path& path, const ReadOptions& options,
                                          const Control& control) {
  const auto source = codec::open_row_source(path, options);
  const EnvironmentInfo& info = source->info();
  const auto width = static_cast<std::size_t>(info.width);
  std::vector<codec::RowStatistics> rows(static_cast<std::size_t>(info.height));
  const codec::RowGroups groups{codec::comfortable_group_rows(*source), true, options.memory_limit_bytes};
  codec::for_each_row_group(*source, groups, control, [&](codec::RowWorker& worker, int first_row, int row_count) {
    worker.reader->read(first_row, row_count, worker.rows.data());
    std::vector<double> solid_angles(width);
    for (int row = 0; row < row_count; ++row) {
      codec::fill_solid_angles(info, first_row + row, solid_angles);
      const float* rgb = worker.rows.data() + static_cast<std::size_t>(row) * 3 * width;
      rows[static_cast<std::size_t>(first_row + row)] = codec::measure_row(rgb, solid_angles);
    }
  });
  return codec::summarise(info, rows);
}

}  // namespace welkin
