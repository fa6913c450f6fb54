// Results from a file: an environment in memory, a projection or a bake.
#pragma once

#include <filesystem>
#include <optional>

#include "files/layout.h"
#include "files/row_source.h"
#include "platform/file.h"
#include "welkin/bake.h"
#include "welkin/bake_file.h"
#include "welkin/core.h"
#include "welkin/projection.h"

namespace welkin::baking {
class ArtefactStore;
}  // namespace welkin::baking

namespace welkin::files {

/// Decodes all rows of a source, several groups at a time; a cube's faces, whatever its layout, are stored in face
/// order. Texels outside the faces of a cross are decoded and dropped. Throws `Error`: limit_exceeded before anything
/// is read, cancelled, and whatever reading throws.
[[nodiscard]] Environment read_whole(const RowSource& source, const ReadOptions& options, const Control& control);

/// Runs `work`, and puts the file's name before messages about rejected pixels, which name face, row and column.
template <typename Work>
auto naming_file(const std::filesystem::path& path, const Work& work) {
  try {
    return work();
  } catch (const Error& failure) {
    if (failure.code() != ErrorCode::rejected_pixel) throw;
    throw platform::file_error(failure.code(), path, failure.what());
  }
}

/// Returns the level of the file's mip chain that can replace a reduction to `options.target_size`: the nearest in
/// log2, by the edge of a cube's faces, or a lat-long's width against four times the target. Empty without a chain, or
/// if the target needs no reduction. `info` is that of the full size.
[[nodiscard]] std::optional<int> level_for_target(const EnvironmentInfo& info, const ProjectionOptions& options);

/// Projects the level that `source` reads: a lat-long is streamed, a cube is read whole. See `project_file`.
[[nodiscard]] Projection project_source(const RowSource& source, const ReadOptions& read_options,
                                        const ProjectionOptions& options, const Control& control);

/// Bakes a file; a message about a rejected pixel names it. Throws the errors of `run_bake`.
[[nodiscard]] BakeResult bake_file_source(const StoredEnvironment& file, const Plan& plan, baking::ArtefactStore* store,
                                          const Control& control);

}  // namespace welkin::files
