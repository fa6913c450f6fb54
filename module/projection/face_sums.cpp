#include "projection/face_sums.h"

#include <cmath>
#include <numbers>
#include <string>
#include <utility>

#include "projection/cubemap_projection.h"
#include "projection/pixel_policy.h"
#include "projection/project.h"
#include "welkin/error.h"
#include "welkin/face_harmonics.h"

namespace welkin {
namespace {

[[noreturn]] void refuse(const std::string& message) { throw Error(ErrorCode::invalid_argument, message); }

/// As the projection itself wants them: with the target that counts.
ProjectionOptions effective(int size, ProjectionOptions options) {
  options.target_size = projection::effective_target(size, options);
  return options;
}

void check_faces(std::span<const int> faces) {
  unsigned seen = 0;
  for (const int face : faces) {
    if (face < 0 || face > 5) refuse("face " + std::to_string(face) + "; a cubemap has faces 0 to 5");
    const unsigned bit = 1U << static_cast<unsigned>(face);
    if ((seen & bit) != 0) refuse("face " + std::to_string(face) + " is named twice; name each face once");
    seen |= bit;
  }
}

}  // namespace

std::size_t FaceHarmonics::bytes() const noexcept {
  std::size_t bytes = sizeof *this;
  for (const auto& face : faces_) bytes += face ? face->bytes() : 0;
  return bytes;
}

FaceHarmonics project_faces(const CubemapView& cubemap, const ProjectionOptions& options, const Control& control) {
  FaceHarmonics faces(cubemap.size, options);
  constexpr std::array<int, 6> kAll{0, 1, 2, 3, 4, 5};
  update_faces(faces, cubemap, kAll, control);
  return faces;
}

void update_faces(FaceHarmonics& kept, const CubemapView& cubemap, std::span<const int> faces, const Control& control) {
  image::check_view(cubemap);
  projection::check_options(kept.options());
  if (kept.options().quadrature == Quadrature::midpoint &&
      projection::effective_target(cubemap.size, kept.options()) > 0) {
    refuse("sums of faces are not kept for a target size with the midpoint rule; pass target_size 0, or exact");
  }
  check_faces(faces);
  if (cubemap.size != kept.size()) {
    refuse("a cubemap of " + std::to_string(cubemap.size) + ", but sums of one of " + std::to_string(kept.size()) +
           " are kept; call project_faces");
  }
  if (faces.empty()) return;
  const projection::SixFaceSums sums =
      projection::sum_faces(cubemap, effective(kept.size(), kept.options()), faces, control);
  for (const int face : faces) kept.set_face(face, sums[static_cast<std::size_t>(face)]);
}

Projection total(const FaceHarmonics& faces) {
  projection::SixFaceSums sums;
  for (int face = 0; face < 6; ++face) {
    sums[static_cast<std::size_t>(face)] = faces.face(face);
    if (!faces.face(face)) refuse("face " + std::to_string(face) + " has no sums; call project_faces or update_faces");
  }
  const ProjectionOptions options = effective(faces.size(), faces.options());
  const auto functions = static_cast<std::size_t>(options.bands) * static_cast<std::size_t>(options.bands);
  for (const auto& face : sums) {
    if (face->functions == functions && face->records.size() == projection::tiles_of_face(faces.size(), options))
      continue;
    refuse("a face's sums are of another size or other options; call project_faces");
  }
  Projection projection = projection::total_of_faces(sums, faces.size(), options);
  projection::describe_projection(projection, faces.size(), options);
  return projection;
}

}  // namespace welkin

namespace welkin::projection {

SphericalHarmonics TileSums::total() const {
  std::vector<double> sums(3 * functions_);
  for (std::size_t at = 0; at < values_.size(); at += sums.size()) {
    for (std::size_t k = 0; k < sums.size(); ++k) sums[k] += values_[at + k];
  }
  SphericalHarmonics result(static_cast<int>(std::lround(std::sqrt(static_cast<double>(functions_)))));
  for (std::size_t f = 0; f < functions_; ++f) {
    result.coefficients()[f] = {sums[f], sums[functions_ + f], sums[2 * functions_ + f]};
  }
  return result;
}

SanitizeRecord TileSums::total_record() const {
  SanitizeRecord total;
  for (const SanitizeRecord& record : records_) total.add(record);
  return total;
}

bool all_finite(std::span<const double> sums) noexcept {
  // x - x is 0 for finite x and NaN else; adding those up needs no branch.
  double poison = 0.0;
  for (const double sum : sums) poison += sum - sum;
  return poison == 0.0;
}

void weighted_sums_in_double(const double* planes, int class_count, const float* weights, const ClassCounts& counts,
                             int positions, double* sums) noexcept {
  for (int channel = 0; channel < 3; ++channel) {
    const float* weight = weights;
    for (int symmetry = 0; symmetry < class_count; ++symmetry) {
      const double* const plane = planes + static_cast<std::ptrdiff_t>(channel * class_count + symmetry) * kChunk;
      for (int i = 0; i < counts.count[symmetry]; ++i, weight += kChunk, ++sums) {
        for (int k = 0; k < positions; ++k) *sums += plane[k] * static_cast<double>(weight[k]);
      }
    }
  }
}

ProjectionDiagnostics diagnostics_of(const SphericalHarmonics& radiance, const SanitizeRecord& record,
                                     double steradians_per_weight) {
  ProjectionDiagnostics diagnostics;
  diagnostics.nans_replaced = record.nans;
  diagnostics.infinities_replaced = record.infinities;
  diagnostics.negatives_replaced = record.negatives;
  diagnostics.texels_clamped = record.clamped;
  // c(0,0) = Int L Y(0,0), and Y(0,0) = 1 / sqrt(4 pi).
  diagnostics.total_radiance = radiance.at(0, 0) * (2.0 * std::sqrt(std::numbers::pi));
  diagnostics.total_radiance_before_clamp =
      diagnostics.total_radiance + record.radiance_removed * steradians_per_weight;
  return diagnostics;
}

}  // namespace welkin::projection
