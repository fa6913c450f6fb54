// Projecting a source.
#pragma once

#include <optional>

#include "files/row_source.h"
#include "welkin/control.h"
#include "welkin/projection.h"

namespace welkin::files {

/// The level of the file's mip chain that stands in for a reduction to `options.target_size`: the nearest in log2, by
/// the edge of a cube's faces, or a lat-long's width against four times the target. Nothing without a chain, or
/// if the target asks for no reduction. `info` is that of the full size.
[[nodiscard]] std::optional<int> level_for_target(const EnvironmentInfo& info, const ProjectionOptions& options);

/// Projects the level that `source` reads: a lat-long streams, a cube is read whole. See `project_file`.
[[nodiscard]] Projection project_source(const RowSource& source, const ReadOptions& read_options,
                                        const ProjectionOptions& options, const Control& control);

}  // namespace welkin::files
