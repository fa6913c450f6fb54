#include "sky/ground_light.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numbers>

#include "sky/density.h"
#include "sky/direct_sun.h"
#include "sky/sky_geometry.h"
#include "tables/exponential.h"
#include "tables/gauss_legendre.h"

namespace welkin::sky {
namespace {

double value_at(const std::vector<double>& values, std::size_t index) {
  return index < values.size() ? values[index] : 0.0;
}

std::vector<const Constituent*> matter_of(const Atmosphere& atmosphere) {
  std::vector<const Constituent*> matter{&atmosphere.rayleigh, &atmosphere.aerosol};
  for (const Constituent& absorber : atmosphere.absorbers) matter.push_back(&absorber);
  std::erase_if(matter, [](const Constituent* one) { return one->density.empty(); });
  return matter;
}

/// Altitudes from 0 to `altitude` between which every density is smooth and, where an exponential one starts, steps are
/// short against its scale height at first and double from there.
std::vector<double> panels_of(const std::vector<const Constituent*>& matter, double altitude) {
  double finest = altitude;
  std::vector<double> breaks{0.0, altitude};
  for (const Constituent* const one : matter) {
    for (const double place : density_breaks(one->density, altitude)) breaks.push_back(place);
    for (const DensityLayer& layer : one->density) {
      const double slope = std::abs(layer.exponential_scale_per_m);
      if (layer.exponential_term != 0.0 && slope * finest > 1.0) finest = 1.0 / slope;
    }
  }
  std::sort(breaks.begin(), breaks.end());
  std::vector<double> panels{0.0};
  for (std::size_t i = 1; i < breaks.size(); ++i) {
    double step = finest;
    while (panels.back() + 1.5 * step < breaks[i]) {
      panels.push_back(panels.back() + step);
      step *= 1.5;
    }
    if (breaks[i] > panels.back()) panels.push_back(breaks[i]);
  }
  return panels;
}

}  // namespace

std::vector<float> ground_radiances(const SkyTables& tables, const TableMapping& mapping, const ColourFold& fold) {
  std::vector<float> radiances(std::size_t{4} * kGroundNodes);
  const glm::dvec3 albedo = fold.share(tables.atmosphere.ground_albedo);
  for (int node = 0; node < kGroundNodes; ++node) {
    const double root = 2.0 * node / (kGroundNodes - 1) - 1.0;
    const double mu_s = root * std::abs(root);
    glm::dvec3 irradiance = sky_irradiance(tables, mapping, 0.0, mu_s);
    if (mu_s > 0.0) irradiance += mu_s * fold.sunlight() * sun_share(tables, mapping, 0.0, mu_s);
    for (int c = 0; c < 3; ++c) {
      radiances[static_cast<std::size_t>(4 * node + c)] =
          static_cast<float>(albedo[c] * irradiance[c] * std::numbers::inv_pi);
    }
  }
  return radiances;
}

// Seen from where it ends, a ray of length d goes up with the cosine mu_g = (rho^2 - d^2) / (2 R d), and comes through
// an altitude whose tangent distance is u at s = sqrt((R mu_g)^2 + u^2) - R mu_g: smooth in u, the horizon's too.
std::vector<float> ground_reach(const SkyTables& tables, const TableMapping& mapping, const ColourFold& fold,
                                double altitude, int half) {
  constexpr int order = 6;
  const Atmosphere& atmosphere = tables.atmosphere;
  const double bottom = atmosphere.bottom_radius_m;
  const std::vector<const Constituent*> matter = matter_of(atmosphere);
  const std::vector<double> panels = panels_of(matter, altitude);
  const simd::GaussRule rule = tables::gauss_legendre(order);
  struct Node {
    double u, weight;
    std::vector<double> densities;
  };
  std::vector<Node> nodes;
  for (std::size_t i = 1; i < panels.size(); ++i) {
    const double low = tangent_distance(bottom, panels[i - 1]);
    const double high = tangent_distance(bottom, panels[i]);
    for (int k = 0; k < order; ++k) {
      const double u = low + 0.5 * (high - low) * (1.0 + rule.nodes[k]);
      Node node{u, 0.5 * (high - low) * rule.weights[k], {}};
      for (const Constituent* const one : matter) {
        node.densities.push_back(density(one->density, altitude_of_tangent(bottom, u)));
      }
      nodes.push_back(std::move(node));
    }
  }
  const double rho = tangent_distance(bottom, altitude);
  std::vector<float> reach(static_cast<std::size_t>(4 * half));
  std::vector<double> lengths(matter.size());
  std::vector<double> shares(atmosphere.wavelengths_nm.size());
  for (int k = 0; k < half; ++k) {
    const double distance = mapping.view_ray(altitude, k, 2 * half).distance;
    const double tangent = distance > 0.0 ? std::max(0.0, 0.5 * (rho - distance) * (rho + distance) / distance) : 0.0;
    std::fill(lengths.begin(), lengths.end(), 0.0);
    for (const Node& node : nodes) {
      const double slope = node.u / std::sqrt(tangent * tangent + node.u * node.u);
      for (std::size_t i = 0; i < matter.size(); ++i) lengths[i] += node.weight * slope * node.densities[i];
    }
    for (std::size_t w = 0; w < shares.size(); ++w) {
      double depth = 0.0;
      for (std::size_t i = 0; i < matter.size(); ++i) {
        depth += lengths[i] * (value_at(matter[i]->scattering_per_m, w) + value_at(matter[i]->absorption_per_m, w));
      }
      shares[w] = tables::exponential(-depth);
    }
    const glm::dvec3 share = fold.share(shares);
    for (int c = 0; c < 3; ++c) reach[static_cast<std::size_t>(4 * k + c)] = static_cast<float>(share[c]);
  }
  return reach;
}

}  // namespace welkin::sky
