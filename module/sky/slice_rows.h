// The scattering tables cut at one altitude.
#pragma once

#include <vector>

#include "sky/sky_colour.h"
#include "sky/table_mapping.h"
#include "welkin/sky_tables.h"

namespace welkin::sky {

/// Nodes along the axes of a slice: those of the tables, and at least four (of the views: eight, four to the ground),
/// on which less of them are continued by the curve through all.
struct SliceShape {
  int views = 0;
  int azimuths = 0;
  int suns = 0;
};

[[nodiscard]] SliceShape slice_shape(const SkyTableOptions& options) noexcept;

/// Rows of eight floats (sky_slice.h): [views][azimuths][suns].
[[nodiscard]] std::vector<float> slice_rows(const SkyTables& tables, const TableMapping& mapping,
                                            const ColourFold& fold, double altitude);

}  // namespace welkin::sky
