#include "projection/cubemap_projection.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <glm/geometric.hpp>
#include <memory>
#include <numbers>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "jobs/stopwatch.h"
#include "jobs/tiles.h"
#include "projection/chunk_projection.h"
#include "projection/midpoint_error.h"
#include "projection/projection_error.h"
#include "projection/sanitizer.h"
#include "projection/strip_projection.h"
#include "projection/texel_weights.h"
#include "projection/tile_sums.h"
#include "transform/frame_transform.h"

namespace welkin::projection {
namespace {

constexpr int kFaces = 6;

std::size_t tiles_of(int size, const ProjectionOptions& options, const TexelWeights& weights) {
  if (StripProjection::serves(size, options)) return static_cast<std::size_t>(StripProjection::tile_count(size));
  return static_cast<std::size_t>(ChunkProjection::tile_count(weights));
}

/// The error of the midpoint rule; null for the exact rule, and where an average's error is known by other means.
std::shared_ptr<const MidpointError> midpoint_error_of(int size, const ProjectionOptions& options,
                                                       const TexelWeights& weights) {
  if (options.quadrature != Quadrature::midpoint || options.target_size) return nullptr;
  return MidpointError::get(size, options.bands, weights);
}

/// The sums of tiles on their way to a projection: turned from the faces' frames to the world's.
class WorldSums {
 public:
  WorldSums(std::size_t tiles, int size, const ProjectionOptions& options, const TexelWeights& weights)
      : size_(size),
        bands_(options.bands),
        weight_rows_(weights.weight_rows().data()),
        error_(midpoint_error_of(size, options, weights)),
        sums_(tiles, bands_),
        off_(error_ ? tiles : 0, bands_) {
    // Shared tables are built here, not inside a tile.
    for (int face = 0; face < kFaces; ++face) static_cast<void>(transforms::face_transform(face, bands_));
  }

  void add(std::size_t tile, int face, const double* face_sums, const SanitizeRecord& record) {
    transforms::face_transform(face, bands_).add(face_sums, weight_rows_, sums_.tile(tile));
    if (error_) error_->add(face, face_sums, off_.tile(tile));
    sums_.records[tile].add(record);
  }

  [[nodiscard]] Projection projection() const {
    const SanitizeRecord record = sums_.total_record();
    throw_if_rejected(record, true);
    Projection projection{sums_.total(), {}};
    const std::span<const glm::dvec3> radiance = projection.radiance.coefficients();
    projection.diagnostics = cubemap_diagnostics(size_, radiance, record);
    projection.diagnostics.error_estimate =
        error_ ? midpoint_estimate(radiance, off_.total().coefficients(), *error_) : relative_error(radiance, radiance);
    return projection;
  }

 private:
  int size_;
  int bands_;
  const int* weight_rows_;
  std::shared_ptr<const MidpointError> error_;
  TileSums sums_;
  TileSums off_;  ///< by the midpoint rule
};

using NewFaceSums = std::array<std::shared_ptr<FaceSums>, kFaces>;

/// Runs the tiles, by strips where they serve, else by chunks. The sums of a tile and a face turn from the face's frame
/// to the world's, or are kept as they are.
class CubemapProjection {
 public:
  /// `weights` are those of the cubemap's size and must stay.
  CubemapProjection(const CubemapView& cubemap, const ProjectionOptions& options, std::span<const int> faces,
                    const TexelWeights& weights)
      : cubemap_(cubemap),
        options_(options),
        faces_(faces),
        sanitizer_(options.pixels),
        bands_(options.bands),
        weights_(weights),
        tile_count_(tiles_of(cubemap.size, options, weights)) {}

  Projection run(const Control& control) {
    WorldSums sums(tile_count_, cubemap_.size, options_, weights_);
    run_tiles(control, [&](std::size_t tile, int face, const double* face_sums, const SanitizeRecord& record) {
      sums.add(tile, face, face_sums, record);
    });
    return sums.projection();
  }

  NewFaceSums run_faces(const Control& control) {
    NewFaceSums kept;
    for (const int face : faces_) {
      kept[static_cast<std::size_t>(face)] = std::make_shared<FaceSums>(tile_count_, bands_);
    }
    run_tiles(control, [&](std::size_t tile, int face, const double* face_sums, const SanitizeRecord& record) {
      FaceSums& sums = *kept[static_cast<std::size_t>(face)];
      std::copy_n(face_sums, 3 * bands_ * bands_, sums.tile(tile));
      sums.records[tile] = record;
    });
    SanitizeRecord all;
    for (const int face : faces_) all.add(kept[static_cast<std::size_t>(face)]->total_record());
    throw_if_rejected(all, true);
    return kept;
  }

 private:
  /// Calls keep(tile, face, sums, record) for all tiles and faces, from whichever thread.
  template <class Keep>
  void run_tiles(const Control& control, const Keep& keep) {
    if (StripProjection::serves(cubemap_.size, options_)) {
      run_parts(StripProjection(cubemap_, options_, faces_, sanitizer_, weights_), control, keep);
    } else {
      run_parts(ChunkProjection(cubemap_, options_, faces_, sanitizer_, weights_), control, keep);
    }
  }

  template <class Parts, class Keep>
  void run_parts(const Parts& parts, const Control& control, const Keep& keep) {
    const auto texels = static_cast<std::int64_t>(faces_.size()) * cubemap_.size * cubemap_.size;
    const jobs::Placement placement = jobs::placement_for(texels);
    const std::size_t workers = jobs::worker_count(placement);
    std::vector<typename Parts::Scratch> scratch;
    scratch.reserve(workers);
    for (std::size_t worker = 0; worker < workers; ++worker) scratch.emplace_back(parts);
    jobs::run_tiles(tile_count_, placement, workers, control, [&](std::size_t tile, std::size_t worker) {
      const int index = static_cast<int>(tile);
      parts.sum_tile(index, scratch[worker]);
      for (const int face : faces_) {
        SanitizeRecord record;
        const std::span<const double> sums = parts.face_sums(index, face, scratch[worker], record);
        keep(tile, face, sums.data(), record);
      }
    });
  }

  const CubemapView& cubemap_;
  const ProjectionOptions& options_;
  std::span<const int> faces_;
  Sanitizer sanitizer_;
  int bands_;
  const TexelWeights& weights_;
  std::size_t tile_count_;
};

/// The passes of a projection, "project" being the last.
std::vector<PassRecord> passes_of(int size, const ProjectionOptions& options) {
  std::vector<PassRecord> passes;
  if (const int target = options.target_size.value_or(0); target > 0) {
    passes.push_back({"reduce", PassAction::skip,
                      "averaging by solid angle to " + std::to_string(target) + " is part of the weights"});
  }
  passes.push_back(
      {"project", PassAction::run, "six faces of " + std::to_string(size) + " x " + std::to_string(size) + " texels"});
  return passes;
}

/// The sums of all six faces, or of those that a projection keeps, without passes.
Projection sum_of_faces(const SixFaceSums& faces, int size, const ProjectionOptions& options) {
  const std::shared_ptr<const TexelWeights> weights = TexelWeights::get(weights_key(size, options));
  WorldSums sums(faces.front()->records.size(), size, options, *weights);
  TileSums exact(1, options.bands);
  for (std::size_t tile = 0; tile < faces.front()->records.size(); ++tile) {
    for (int face = 0; face < kFaces; ++face) {
      const FaceSums& kept = *faces[static_cast<std::size_t>(face)];
      sums.add(tile, face, kept.tile(tile), kept.records[tile]);
    }
  }
  Projection projection = sums.projection();
  if (!options.target_size) return projection;
  for (int face = 0; face < kFaces; ++face) {
    const FaceSums& kept = *faces[static_cast<std::size_t>(face)];
    transforms::face_transform(face, options.bands)
        .add(kept.exact.data(), weights->weight_rows().data(), exact.tile(0));
  }
  projection.diagnostics.error_estimate =
      relative_error(projection.radiance.coefficients(), exact.total().coefficients());
  return projection;
}

}  // namespace

ProjectionDiagnostics cubemap_diagnostics(int size, std::span<const glm::dvec3> radiance,
                                          const SanitizeRecord& record) {
  // Weight 0 is the solid angle times Y(0,0) = 1 / sqrt(4 pi).
  ProjectionDiagnostics diagnostics = diagnostics_of(radiance, record, 2.0 * std::sqrt(std::numbers::pi));
  diagnostics.texels =
      static_cast<std::uint64_t>(kFaces) * static_cast<std::uint64_t>(size) * static_cast<std::uint64_t>(size);
  return diagnostics;
}

Projection project_cubemap(const CubemapView& cubemap, const ProjectionOptions& options, const Control& control) {
  const jobs::Stopwatch watch;
  Projection projection =
      options.target_size
          ? sum_of_faces(sum_faces(cubemap, options, kAllFaces, control), cubemap.size, options)
          : CubemapProjection(cubemap, options, kAllFaces, *TexelWeights::get(weights_key(cubemap.size, options)))
                .run(control);
  projection.diagnostics.passes = passes_of(cubemap.size, options);
  projection.diagnostics.passes.back().milliseconds = watch.milliseconds();
  return projection;
}

SixFaceSums sum_faces(const CubemapView& cubemap, const ProjectionOptions& options, std::span<const int> faces,
                      const Control& control) {
  const auto weights = TexelWeights::get(weights_key(cubemap.size, options));
  CubemapProjection projection(cubemap, options, faces, *weights);
  SixFaceSums result;
  if (!options.target_size) {
    const NewFaceSums sums = projection.run_faces(control);
    std::copy(sums.begin(), sums.end(), result.begin());
    return result;
  }
  // A target size's error is the difference of its coefficients from those of all texels as areas, so both are summed.
  const NewFaceSums sums = projection.run_faces(jobs::part_of(control, 0.0, 0.7));
  ProjectionOptions whole = options;
  whole.target_size.reset();
  const auto whole_weights = TexelWeights::get(weights_key(cubemap.size, whole));
  const NewFaceSums exact =
      CubemapProjection(cubemap, whole, faces, *whole_weights).run_faces(jobs::part_of(control, 0.7, 1.0));
  for (const int face : faces) {
    const auto at = static_cast<std::size_t>(face);
    sums[at]->exact = exact[at]->sum();
    result[at] = sums[at];
  }
  return result;
}

std::size_t tiles_of_face(int size, const ProjectionOptions& options) {
  return tiles_of(size, options, *TexelWeights::get(weights_key(size, options)));
}

Projection total_of_faces(const SixFaceSums& faces, int size, const ProjectionOptions& options) {
  Projection projection = sum_of_faces(faces, size, options);
  projection.diagnostics.passes = passes_of(size, options);
  return projection;
}

double midpoint_estimate(std::span<const glm::dvec3> radiance, std::span<const glm::dvec3> off,
                         const MidpointError& error) {
  std::array<glm::dvec3, std::size_t{kMaximumBands} * kMaximumBands> exact;
  for (std::size_t f = 0; f < radiance.size(); ++f) exact[f] = radiance[f] - off[f];
  // c(0, 0) = Int L Y(0, 0) = flux / sqrt(4 pi) in each channel. `beyond` bounds what the error of a texel leaves, per
  // unit of its light (L w), as a norm over all functions, so its product with the flux bounds the coefficients' error.
  // That holds for light that is nowhere negative.
  const double flux = std::sqrt(4.0 * std::numbers::pi * glm::dot(radiance[0], radiance[0]));
  return relative_error(radiance, {exact.data(), radiance.size()}, error.beyond() * flux);
}

}  // namespace welkin::projection
