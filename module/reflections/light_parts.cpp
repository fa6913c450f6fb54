#include "reflections/light_parts.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <numbers>

#include "math/quadrature.h"

namespace welkin::reflections {

std::vector<BrightTexel> cut_texels(const std::vector<BrightTexel>& texels, const ImageShape& shape, int cuts) {
  std::vector<BrightTexel> parts;
  std::vector<std::int64_t> indices;
  const std::int64_t columns = std::int64_t{cuts} * shape.columns;
  for (const BrightTexel& texel : texels) {
    for (int j = 0; j < cuts; ++j) {
      for (int i = 0; i < cuts; ++i) {
        BrightTexel part = texel;
        part.row = texel.row * cuts + j;
        part.column = texel.column * cuts + i;
        parts.push_back(part);
        indices.push_back(part.row * columns + part.column);
      }
    }
  }
  const ImageShape cut{shape.cubemap, cuts * shape.columns, cuts * shape.rows};
  const std::vector<double> steradians = image::solid_angles_of(cut.grid(), indices);
  for (std::size_t k = 0; k < parts.size(); ++k) parts[k].steradians = steradians[k];
  return parts;
}

namespace {

constexpr double kPi = std::numbers::pi;

/// Shares its light among the samples from `first` on by the weights that stand there.
void share_light(const BrightTexel& texel, std::size_t first, Samples& samples) {
  double whole = 0.0;
  for (std::size_t k = first; k < samples.size(); ++k) whole += samples[k].light[0];
  for (std::size_t k = first; k < samples.size(); ++k) samples[k].light *= texel.light() / whole;
}

Sample sample_at(Directions& directions, const BrightTexel& texel, double across, double down, double weight) {
  const ImageShape& shape = directions.shape();
  Sample sample{shape.cubemap ? texel.row / shape.columns : 0,
                texel.column + across,
                (shape.cubemap ? texel.row % shape.columns : texel.row) + down,
                {}};
  sample.light = glm::dvec3(weight * directions.density_at(sample.column, sample.row));
  return sample;
}

}  // namespace

void add_points(const BrightTexel& texel, Directions& directions, int count, Samples& samples) {
  const math::GaussRule rule = math::gauss_legendre(count);
  const std::size_t first = samples.size();
  for (int j = 0; j < count; ++j) {
    for (int i = 0; i < count; ++i)
      samples.push_back(sample_at(directions, texel, 0.5 + 0.5 * rule.nodes[i], 0.5 + 0.5 * rule.nodes[j],
                                  rule.weights[i] * rule.weights[j]));
  }
  share_light(texel, first, samples);
}

namespace {

/// Returns by how many rows the centroid of a part, `high` rows high, lies below its middle. Near a pole rows are
/// triangles.
/// With y the way from the middle in rows and the polar angle pi row / rows, the density is proportional to 1 + y (pi
/// / rows) cos / sin, and the mean of y with it is y^2's mean, high^2 / 12, times that.
double below_middle(Directions& directions, double row, double high) {
  constexpr double kRows = 8.0;  // farther than that many parts from a pole it is a hundredth of the part
  const ImageShape& shape = directions.shape();
  if (shape.cubemap || std::min(row, shape.rows - row) > kRows * high) return 0.0;
  const math::SineCosine middle = directions.of_turns(row / (2.0 * shape.rows));
  return high * high * kPi / (12.0 * shape.rows) * middle.cosine / middle.sine;
}

}  // namespace

void add_parts(const BrightTexel& texel, Directions& directions, int count, LightsOf use, Samples& samples) {
  const std::size_t first = samples.size();
  for (int j = 0; j < count; ++j) {
    for (int i = 0; i < count; ++i)
      samples.push_back(sample_at(directions, texel, (i + 0.5) / count, (j + 0.5) / count, 1.0));
  }
  share_light(texel, first, samples);
  if (use == LightsOf::any) return;  // see `centre`
  for (std::size_t k = first; k < samples.size(); ++k)
    samples[k].row += below_middle(directions, samples[k].row, 1.0 / count);
}

LobeLight light_of(Directions& directions, const Sample& sample) {
  const glm::dvec3 direction = directions.at(sample.face, sample.column, sample.row);
  const auto single = [](double value) { return static_cast<float>(value); };
  return {single(direction.x),    single(direction.y),    single(direction.z),
          single(sample.light.r), single(sample.light.g), single(sample.light.b)};
}

namespace {

/// Gives a light that is a part of a texel, `half` of it to each side of a middle, the part's centroid (half the square
/// of its size away from the middle) and second moments, by Gauss' rule of 2 x 2 points.
void centre(Directions& directions, const Sample& middle, double half, CutLight& cut) {
  const double node = half * math::gauss_legendre(2).nodes[1];
  glm::dvec3 sum(0.0);
  double density[2]{};
  for (int j = 0; j < 2; ++j) {
    const double row = middle.row + (j == 0 ? -node : node);
    for (const double across : {-node, node}) {
      const double weight = directions.density_at(middle.column + across, row);
      sum += weight * directions.at(middle.face, middle.column + across, row);
      density[j] += weight;
    }
  }
  const glm::dvec3 centroid = glm::normalize(sum);
  cut.light.x = static_cast<float>(centroid.x);
  cut.light.y = static_cast<float>(centroid.y);
  cut.light.z = static_cast<float>(centroid.z);
  if (directions.shape().cubemap) return;
  // Rows become shorter towards a pole, as their density falls. Over a part with y from -1 to 1 the density and the
  // width are 1 + sqrt(3) lean y, as the rule's nodes are at +-1 / sqrt(3). So y has the mean lean / sqrt(3) and the
  // variance 1/3 - lean^2 / 3, and across a row the variance is the mean of (1 + sqrt(3) lean y)^3, 1 + 3 lean^2,
  // times 1/3. A parallelogram that is to have both has `down` and `along` by their roots.
  const double lean = (density[1] - density[0]) / (density[1] + density[0]);
  for (int axis = 0; axis < 3; ++axis) {
    cut.along[axis] *= static_cast<float>(std::sqrt(1.0 + 3.0 * lean * lean));
    cut.down[axis] *= static_cast<float>(std::sqrt(1.0 - lean * lean));
  }
}

}  // namespace

CutLight cut_light_of(Directions& directions, const Sample& sample, int parts, LightsOf use) {
  const double half = 0.5 / parts;
  const glm::dvec3 along = 0.5 * (directions.at(sample.face, sample.column + half, sample.row) -
                                  directions.at(sample.face, sample.column - half, sample.row));
  const glm::dvec3 down = 0.5 * (directions.at(sample.face, sample.column, sample.row + half) -
                                 directions.at(sample.face, sample.column, sample.row - half));
  CutLight cut{
      light_of(directions, sample), {}, {}, static_cast<float>(0.01 * (glm::length(along) + glm::length(down)))};
  for (int axis = 0; axis < 3; ++axis) {
    cut.along[axis] = static_cast<float>(along[axis]);
    cut.down[axis] = static_cast<float>(down[axis]);
  }
  if (use == LightsOf::any) centre(directions, sample, half, cut);
  return cut;
}

}  // namespace welkin::reflections
