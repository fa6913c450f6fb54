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
#include "projection/projection_error.h"
#include "projection/sanitizer.h"
#include "projection/strip_projection.h"
#include "transform/frame_transform.h"

namespace welkin::projection {
namespace {

constexpr int kFaces = 6;

std::size_t tiles_of(int size, const ProjectionOptions& options, const TexelWeights& weights) {
  if (StripProjection::serves(size, options)) return static_cast<std::size_t>(StripProjection::tile_count(size));
  return static_cast<std::size_t>(ChunkProjection::tile_count(weights));
}

/// The error estimate of a projection by the midpoint rule. `off`: what `MidpointError::add` returned.
double midpoint_estimate(std::span<const glm::dvec3> radiance, const TileSums& off, const MidpointError& error) {
  std::array<glm::dvec3, std::size_t{kMaximumBands} * kMaximumBands> exact;
  off.total(exact);
  for (std::size_t f = 0; f < radiance.size(); ++f) exact[f] = radiance[f] - exact[f];
  // c(0, 0) = Int L Y(0, 0) = flux / sqrt(4 pi) in each channel. `beyond` bounds what the error of a texel leaves, per
  // unit of its light (L w), as a norm over all functions, so its product with the flux bounds the coefficients' error.
  // That holds for light that is nowhere negative.
  const double flux = std::sqrt(4.0 * std::numbers::pi * glm::dot(radiance[0], radiance[0]));
  return relative_error(radiance, {exact.data(), radiance.size()}, error.beyond() * flux);
}

}  // namespace

CubemapTables::CubemapTables(int its_size, const ProjectionOptions& options)
    : size(its_size), bands(options.bands), weights(TexelWeights::get(weights_key(size, options))) {
  if (options.quadrature == Quadrature::midpoint && !options.target_size)
    error = MidpointError::get(size, bands, *weights);
  // Shared tables are built here, not inside a tile.
  for (const int face : kAllFaces) static_cast<void>(transforms::face_transform(face, bands));
}

WorldSums::WorldSums(std::size_t tiles, const ProjectionOptions& options)
    : sums_(tiles, options.bands),
      off_(options.quadrature == Quadrature::midpoint && !options.target_size ? tiles : 0, options.bands) {}

void WorldSums::clear() noexcept {
  std::fill(sums_.values.begin(), sums_.values.end(), 0.0);
  std::fill(off_.values.begin(), off_.values.end(), 0.0);
  std::fill(sums_.records.begin(), sums_.records.end(), SanitizeRecord{});
}

void WorldSums::add(const CubemapTables& tables, std::size_t tile, int face, const double* face_sums,
                    const SanitizeRecord& record) noexcept {
  transforms::face_transform(face, tables.bands).add(face_sums, tables.weights->weight_rows().data(), sums_.tile(tile));
  if (tables.error) tables.error->add(face, face_sums, off_.tile(tile));
  sums_.records[tile].add(record);
}

ProjectionDiagnostics WorldSums::finish(const CubemapTables& tables, std::span<glm::dvec3> radiance) const {
  sums_.total(radiance);
  const SanitizeRecord record = sums_.total_record();
  throw_if_rejected(record, true);
  // Weight 0 is the solid angle times Y(0,0) = 1 / sqrt(4 pi).
  ProjectionDiagnostics diagnostics = diagnostics_of(radiance, record, 2.0 * std::sqrt(std::numbers::pi));
  const auto edge = static_cast<std::uint64_t>(tables.size);
  diagnostics.texels = std::uint64_t{kFaces} * edge * edge;
  diagnostics.error_estimate =
      tables.error ? midpoint_estimate(radiance, off_, *tables.error) : relative_error(radiance, radiance);
  return diagnostics;
}

namespace {

Projection projection_of(const WorldSums& sums, const CubemapTables& tables) {
  Projection projection{SphericalHarmonics(tables.bands), {}};
  projection.diagnostics = sums.finish(tables, projection.radiance.coefficients());
  return projection;
}

using NewFaceSums = std::array<std::shared_ptr<FaceSums>, kFaces>;

/// Runs the tiles, by strips where they serve, else by chunks. The sums of a tile and a face turn from the face's frame
/// to the world's, or are kept as they are.
class CubemapProjection {
 public:
  /// `tables` are those of the cubemap's size and must stay.
  CubemapProjection(const CubemapView& cubemap, const ProjectionOptions& options, std::span<const int> faces,
                    const CubemapTables& tables)
      : cubemap_(cubemap),
        options_(options),
        faces_(faces),
        sanitizer_(options.pixels),
        bands_(options.bands),
        tables_(tables),
        tile_count_(tiles_of(cubemap.size, options, *tables.weights)) {}

  Projection run(const Control& control) {
    WorldSums sums(tile_count_, options_);
    run_tiles(control, [&](std::size_t tile, int face, const double* face_sums, const SanitizeRecord& record) {
      sums.add(tables_, tile, face, face_sums, record);
    });
    return projection_of(sums, tables_);
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
      run_parts(StripProjection(cubemap_, options_, faces_, sanitizer_, *tables_.weights), control, keep);
    } else {
      run_parts(ChunkProjection(cubemap_, options_, faces_, sanitizer_, *tables_.weights), control, keep);
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
  const CubemapTables& tables_;
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
  const CubemapTables tables(size, options);
  const std::size_t tiles = faces.front()->records.size();
  WorldSums sums(tiles, options);
  for (std::size_t tile = 0; tile < tiles; ++tile) {
    for (int face = 0; face < kFaces; ++face) {
      const FaceSums& kept = *faces[static_cast<std::size_t>(face)];
      sums.add(tables, tile, face, kept.tile(tile), kept.records[tile]);
    }
  }
  Projection projection = projection_of(sums, tables);
  if (!options.target_size) return projection;
  TileSums exact(1, options.bands);
  for (int face = 0; face < kFaces; ++face) {
    const FaceSums& kept = *faces[static_cast<std::size_t>(face)];
    transforms::face_transform(face, options.bands)
        .add(kept.exact.data(), tables.weights->weight_rows().data(), exact.tile(0));
  }
  SphericalHarmonics of_areas(options.bands);
  exact.total(of_areas.coefficients());
  projection.diagnostics.error_estimate = relative_error(projection.radiance.coefficients(), of_areas.coefficients());
  return projection;
}

}  // namespace

Projection project_cubemap(const CubemapView& cubemap, const ProjectionOptions& options, const Control& control) {
  const jobs::Stopwatch watch;
  Projection projection =
      options.target_size
          ? sum_of_faces(sum_faces(cubemap, options, kAllFaces, control), cubemap.size, options)
          : CubemapProjection(cubemap, options, kAllFaces, CubemapTables(cubemap.size, options)).run(control);
  projection.diagnostics.passes = passes_of(cubemap.size, options);
  projection.diagnostics.passes.back().milliseconds = watch.milliseconds();
  return projection;
}

SixFaceSums sum_faces(const CubemapView& cubemap, const ProjectionOptions& options, std::span<const int> faces,
                      const Control& control) {
  const CubemapTables tables(cubemap.size, options);
  CubemapProjection projection(cubemap, options, faces, tables);
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
  const CubemapTables whole_tables(cubemap.size, whole);
  const NewFaceSums exact =
      CubemapProjection(cubemap, whole, faces, whole_tables).run_faces(jobs::part_of(control, 0.7, 1.0));
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

}  // namespace welkin::projection
