// Sizes of sky tables, and checks of their options.
#pragma once

#include <cstddef>
#include <cstdint>

#include "sky/air.h"
#include "sky/ray_light.h"
#include "sky/sunlight.h"
#include "sky/table_mapping.h"
#include "welkin/sky.h"

namespace welkin::sky {

/// Returns the memory in bytes that `precompute_sky` needs at most, including results and 1 MB per thread of the
/// caller's arena. Throws `Error` (invalid_argument), also for `spectral` tables without three wavelengths.
[[nodiscard]] std::uint64_t sky_table_bytes(const Atmosphere& atmosphere, const SkyTableOptions& options);

/// Throws `Error` (invalid_argument) naming the option that is out of its range.
void check_options(const SkyTableOptions& options);

/// Cosines between view and sun that a layout has: 1 if compact.
[[nodiscard]] int angles_of(const SkyTableOptions& options) noexcept;

/// Returns which axes have many nodes. Compact tables have none, for callers that look them up as published.
[[nodiscard]] TableNodes table_nodes(const SkyTableOptions& options) noexcept;

/// Returns the mapping of the texels of tables with these options.
[[nodiscard]] TableMapping mapping_of(const Atmosphere& atmosphere, const SkyTableOptions& options) noexcept;

/// Texels of the scattering table; floats of the other two.
[[nodiscard]] std::uint64_t scattering_texels(const SkyTableOptions& options) noexcept;
[[nodiscard]] std::uint64_t transmittance_floats(const SkyTableOptions& options) noexcept;
[[nodiscard]] std::uint64_t irradiance_floats(const SkyTableOptions& options) noexcept;

/// Floats of the table of single Mie scattering: none where the layout is compact, or where no aerosol scatters.
[[nodiscard]] std::uint64_t single_mie_floats(const Atmosphere& atmosphere, const SkyTableOptions& options) noexcept;

/// Returns the nodes of the source that the tables are computed from: fewer for small tables, so that those are quick
/// to make. Heights are bent where the air is thin relative to its shell.
[[nodiscard]] SourceShape source_shape(const SkyTableOptions& options, const AirModel& air,
                                       const TableMapping& mapping);
/// Returns the nodes of the sun's paths: where the air is thin relative to its shell, as many as for large tables, for
/// the lowest heights must not lie beyond it.
[[nodiscard]] SunPaths::Size sun_path_size(const SkyTableOptions& options, const AirModel& air,
                                           const TableMapping& mapping) noexcept;

/// Bytes of the tables themselves.
[[nodiscard]] std::uint64_t result_bytes(const Atmosphere& atmosphere, const SkyTableOptions& options) noexcept;

}  // namespace welkin::sky
