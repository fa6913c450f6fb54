// Grids of light probes.
#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "c/c_support.h"
#include "c/c_worker.h"
#include "probes/probe_arrays.h"
#include "welkin/probes.h"
#include "welkin/welkin.h"

namespace welkin::c_interface {

ProbeLayout probe_layout(std::string_view name) {
  std::string known;
  for (const ProbeLayout layout : {ProbeLayout::three, ProbeLayout::unity_l2, ProbeLayout::unity_l1, ProbeLayout::plain,
                                   ProbeLayout::bevy, ProbeLayout::rtxgi}) {
    if (name == welkin::name(layout)) return layout;
    known += std::string(known.empty() ? "" : ", ") + welkin::name(layout);
  }
  refuse("there is no layout \"" + std::string(name.substr(0, 64)) + "\" of probes; pass one of " + known);
}

ProbeGrid probe_grid(const welkin_probe_grid* grid) {
  const auto given = read_struct(grid, "grid");
  const ProbeGrid wanted{.counts = {given.counts[0], given.counts[1], given.counts[2]},
                         .origin = read_triple(given.origin, "origin"),
                         .spacing = read_triple(given.spacing, "spacing")};
  probes::check_grid(wanted);
  return wanted;
}

ProbeOptions probe_options(const welkin_probe_options* options) {
  const auto given = read_options(options, "options");
  ProbeOptions wanted;
  set_unless_zero(wanted.projection.bands, given.bands);
  const auto set_or_none = [](int& target, std::int32_t value) {
    if (value != 0) target = value == -1 ? 0 : value;
  };
  set_or_none(wanted.distance_size, given.distance_size);
  set_or_none(wanted.dilation_passes, given.dilation_passes);
  wanted.environment_bands = given.environment_bands;
  set_unless_zero(wanted.near_share, given.near_share);
  set_unless_zero(wanted.valid_share, given.valid_share);
  return wanted;
}

namespace {

std::vector<DepthView> depth_views(const float* const* depths, std::int32_t size, std::size_t count) {
  image::require_range("depth_size", size, 1, 1024);
  const auto face = static_cast<std::size_t>(size) * static_cast<std::size_t>(size);
  std::vector<DepthView> views(count, DepthView{{}, size, 0});
  for (std::size_t k = 0; k < count; ++k) {
    if (depths[k] == nullptr) refuse("depths[" + std::to_string(k) + "] is null; pass the six faces of its distances");
    for (std::size_t f = 0; f < 6; ++f) views[k].faces[f] = depths[k] + f * face;
  }
  return views;
}

const BakedProbes& probes_of(const welkin_probes* probes) {
  require(probes, "probes");
  return probes->probes;
}

}  // namespace
}  // namespace welkin::c_interface

// Entries of C cannot be in a namespace.
using namespace welkin::c_interface;  // NOLINT(google-build-using-namespace,google-global-names-in-headers)

void welkin_probes_destroy(welkin_probes* probes) { destroy(probes); }

welkin_status welkin_probes_bake(const welkin_probe_grid* grid, const welkin_environment* cubes,
                                 const float* const* depths, int32_t depth_size, const welkin_probe_options* options,
                                 const welkin_control* control, welkin_probes** probes) {
  return guarded_making(probes, "probes", [&] {
    const auto wanted = probe_grid(grid);
    const auto views = probe_views(cubes, static_cast<std::int64_t>(wanted.size()));
    const auto distances =
        depths != nullptr ? depth_views(depths, depth_size, wanted.size()) : std::vector<welkin::DepthView>{};
    return new welkin_probes{
        welkin::bake_probes(wanted, views, distances, probe_options(options), control_of(control))};
  });
}

welkin_status welkin_probes_relocate(const welkin_probe_grid* grid, const float* const* depths, int32_t depth_size,
                                     double* offsets) {
  return guarded([&] {
    const auto wanted = probe_grid(grid);
    require(depths, "depths");
    const auto before = triples(offsets, wanted.size(), "offsets");
    const auto after = welkin::relocate_probes(wanted, depth_views(depths, depth_size, wanted.size()), {}, before);
    std::copy_n(&after[0].x, 3 * after.size(), offsets);
  });
}

welkin_status welkin_probes_set_offsets(welkin_probes* probes, const double* offsets) {
  return guarded([&] {
    const std::size_t count = probes_of(probes).grid.size();
    const auto given = offsets != nullptr ? triples(offsets, count, "offsets") : std::span<const welkin::dvec3>{};
    probes->probes.offsets.assign(given.begin(), given.end());
  });
}

welkin_status welkin_probes_relight(welkin_probes* probes, int32_t bands, const double* from, const double* to) {
  return guarded([&] {
    require(probes, "probes");
    welkin::relight(probes->probes, read_harmonics(bands, from, "from"), read_harmonics(bands, to, "to"));
  });
}

welkin_status welkin_probes_irradiance(const welkin_probes* probes, const double* positions, const double* normals,
                                       size_t count, double* irradiance) {
  return guarded([&] {
    const auto& baked = probes_of(probes);
    if (count == 0) return;
    const auto points = triples(positions, count, "positions");
    const auto facing = triples(normals, count, "normals");
    require(irradiance, "irradiance");
    for (std::size_t k = 0; k < count; ++k) {
      write_triple(welkin::probe_irradiance(baked, points[k], facing[k]), irradiance + 3 * k);
    }
  });
}

welkin_status welkin_probes_coefficients(const welkin_probes* probes, const double** coefficients, size_t* count) {
  return guarded([&] {
    const auto& baked = probes_of(probes);
    require(coefficients, "coefficients");
    require(count, "count");
    *coefficients = &baked.coefficients[0].x;
    *count = 3 * baked.coefficients.size();
  });
}

welkin_status welkin_probes_pack(const welkin_probes* probes, const char* layout, int32_t index, int32_t* size,
                                 uint16_t* halves, size_t half_count) {
  return guarded([&] {
    require(layout, "layout");
    require(size, "size");
    const auto packed = welkin::pack_probes(probes_of(probes), probe_layout(layout));
    require_enumerator("index", index, static_cast<std::int32_t>(packed.textures.size()) - 1);
    const auto& texture = packed.textures[static_cast<std::size_t>(index)];
    std::copy(texture.size.begin(), texture.size.end(), size);
    if (halves == nullptr) return;
    if (half_count < texture.halves.size()) {
      refuse("half_count is " + std::to_string(half_count) + "; the texture has " +
             std::to_string(texture.halves.size()) + " half floats");
    }
    std::copy(texture.halves.begin(), texture.halves.end(), halves);
  });
}
