#include "sky/slice_rows.h"

#include <algorithm>
#include <cstddef>

#include "simd/kernels.h"
#include "sky/cubic.h"

namespace welkin::sky {
namespace {

constexpr int kRow = simd::kSkyRow;

/// In channels that the compact layout leaves out the aerosol's light is taken to be coloured as the molecules' is
/// (Bruneton and Neyret 2008, section 4: "C_M = C_*.rgb C_M.r / C_*.r ..."); no more than this times the first channel.
constexpr double kMostColoured = 1e4;

/// Tables of a node along an axis: the rows from `first` on, `stride` apart.
struct Blend {
  Cubic cubic;
  int count;
};

Blend blend_at(double position, int count) { return {cubic_at(position, count), std::min(count, 4)}; }

/// Node `node` of a slice's axis among the tables' nodes.
Blend node_of(int node, int nodes, int table_nodes) {
  if (nodes == table_nodes) return {{node, {1.0, 0.0, 0.0, 0.0}}, 1};
  return blend_at(static_cast<double>(node) * (table_nodes - 1) / (nodes - 1), table_nodes);
}

/// The same for views: either half by itself.
Blend view_of(int node, int nodes, int table_nodes) {
  const int half = nodes / 2;
  const int table_half = table_nodes / 2;
  Blend blend = node_of(node % half, half, table_half);
  if (node >= half) blend.cubic.first += table_half;
  return blend;
}

int angles_of(const SkyTableOptions& options) {
  return options.layout == ScatteringLayout::full ? options.sun_angles : 1;
}

/// By channel how much more the aerosol scatters than molecules do, relative to the first channel; how much more of it
/// there is where there are no molecules to tell its colour.
struct AerosolColour {
  glm::dvec3 by_molecules{0.0};
  glm::dvec3 alone{0.0};

  AerosolColour(const Atmosphere& atmosphere, const ColourFold& fold) {
    const glm::dvec3 aerosol = fold.share(atmosphere.aerosol.scattering_per_m) * fold.sunlight();
    const glm::dvec3 rayleigh = fold.share(atmosphere.rayleigh.scattering_per_m) * fold.sunlight();
    for (int c = 0; c < 3; ++c) {
      if (!(aerosol[0] > 0.0)) continue;
      alone[c] = aerosol[c] / aerosol[0];
      by_molecules[c] = rayleigh[c] > 0.0 ? alone[c] * (rayleigh[0] / rayleigh[c]) : 0.0;
    }
  }

  void extrapolate(float* row) const {
    const auto first = static_cast<double>(row[4]);
    const auto red = static_cast<double>(row[0]);
    for (int c = 1; c < 3; ++c) {
      const double ratio =
          red > 0.0 && by_molecules[c] > 0.0 ? static_cast<double>(row[c]) / red * by_molecules[c] : alone[c];
      row[4 + c] = static_cast<float>(first * std::min(ratio, kMostColoured));
    }
  }
};

/// Adds weight times `count` texels of one height.
void add_texels(const SkyTables& tables, std::size_t first, std::size_t count, float weight, float* rows) {
  const float* const scattering = tables.scattering.data() + 4 * first;
  if (tables.options.layout == ScatteringLayout::compact) {
    for (std::size_t i = 0; i < count; ++i) {
      for (std::size_t c = 0; c < 3; ++c) rows[kRow * i + c] += weight * scattering[4 * i + c];
      rows[kRow * i + 4] += weight * scattering[4 * i + 3];
    }
    return;
  }
  for (std::size_t i = 0; i < count; ++i) {
    for (std::size_t c = 0; c < 3; ++c) rows[kRow * i + c] += weight * scattering[4 * i + c];
  }
  if (tables.single_mie.empty()) return;  // no aerosol: nothing to add
  const float* const mie = tables.single_mie.data() + 4 * first;
  for (std::size_t i = 0; i < count; ++i) {
    for (std::size_t c = 0; c < 3; ++c) rows[kRow * i + 4 + c] += weight * mie[4 * i + c];
  }
}

/// [view_zeniths][angles][sun_zeniths] rows at the altitude.
std::vector<float> rows_at(const SkyTables& tables, const TableMapping& mapping, const ColourFold& fold,
                           double altitude) {
  const SkyTableOptions& options = tables.options;
  const std::size_t count = static_cast<std::size_t>(options.view_zeniths) *
                            static_cast<std::size_t>(angles_of(options)) *
                            static_cast<std::size_t>(options.sun_zeniths);
  const Blend heights = blend_at(mapping.height_coordinate(altitude) * (options.heights - 1), options.heights);
  std::vector<float> rows(kRow * count);
  for (int i = 0; i < heights.count; ++i) {
    const auto weight = static_cast<float>(heights.cubic.weights[i]);
    if (weight == 0.0F) continue;
    add_texels(tables, static_cast<std::size_t>(heights.cubic.first + i) * count, count, weight, rows.data());
  }
  for (float& value : rows) value = value > 0.0F ? value : 0.0F;
  if (options.layout == ScatteringLayout::compact) {
    const AerosolColour colour(tables.atmosphere, fold);
    for (std::size_t i = 0; i < count; ++i) colour.extrapolate(rows.data() + kRow * i);
  }
  return rows;
}

}  // namespace

SliceShape slice_shape(const SkyTableOptions& options) noexcept {
  return {2 * std::max(4, options.view_zeniths / 2), std::max(4, angles_of(options)), std::max(4, options.sun_zeniths)};
}

std::vector<float> slice_rows(const SkyTables& tables, const TableMapping& mapping, const ColourFold& fold,
                              double altitude) {
  const SkyTableOptions& options = tables.options;
  const SliceShape shape = slice_shape(options);
  const int angles = angles_of(options);
  std::vector<float> rows = rows_at(tables, mapping, fold, altitude);
  if (shape.views == options.view_zeniths && shape.azimuths == angles && shape.suns == options.sun_zeniths) {
    return rows;
  }
  std::vector<float> result;
  result.reserve(std::size_t{kRow} * static_cast<std::size_t>(shape.views) * static_cast<std::size_t>(shape.azimuths) *
                 static_cast<std::size_t>(shape.suns));
  for (int v = 0; v < shape.views; ++v) {
    const Blend view = view_of(v, shape.views, options.view_zeniths);
    for (int a = 0; a < shape.azimuths; ++a) {
      const Blend azimuth = node_of(a, shape.azimuths, angles);
      for (int s = 0; s < shape.suns; ++s) {
        const Blend sun = node_of(s, shape.suns, options.sun_zeniths);
        double sums[kRow]{};
        for (int i = 0; i < view.count; ++i) {
          for (int j = 0; j < azimuth.count; ++j) {
            for (int k = 0; k < sun.count; ++k) {
              const double weight = view.cubic.weights[i] * azimuth.cubic.weights[j] * sun.cubic.weights[k];
              const int texel = ((view.cubic.first + i) * angles + azimuth.cubic.first + j) * options.sun_zeniths +
                                sun.cubic.first + k;
              for (int c = 0; c < kRow; ++c) {
                sums[c] += weight * static_cast<double>(rows[static_cast<std::size_t>(kRow * texel + c)]);
              }
            }
          }
        }
        for (const double sum : sums) result.push_back(static_cast<float>(std::max(sum, 0.0)));
      }
    }
  }
  return result;
}

}  // namespace welkin::sky
