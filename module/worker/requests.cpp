#include "welkin/requests.h"

#include <cstddef>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "welkin/bake.h"
#include "welkin/core.h"

namespace welkin {
namespace {

/// That rows take, one before the other.
std::uint64_t bytes_of_rows(std::uint64_t rows, int width, std::ptrdiff_t stride, PixelFormat format) noexcept {
  const std::uint64_t packed = static_cast<std::uint64_t>(width > 0 ? width : 0) * bytes_per_texel(format);
  const auto forward = static_cast<std::uint64_t>(stride);
  const std::uint64_t distance = stride < 0 ? 0 - forward : forward;  // even of the most negative one
  return rows * (distance > packed ? distance : packed);
}

std::uint64_t positive(int value) noexcept { return value > 0 ? static_cast<std::uint64_t>(value) : 0; }

std::uint64_t bytes_of(const EnvironmentView& environment) {
  if (environment.kind() == EnvironmentKind::lat_long) {
    const LatLongView view = environment.lat_long();
    return bytes_of_rows(positive(view.height), view.width, view.row_stride_bytes, view.format);
  }
  const CubemapView view = environment.cubemap();
  return bytes_of_rows(6 * positive(view.size), view.size, view.row_stride_bytes, view.format);
}

const char* const kNoImage = "a source is a null pointer to an image";
const char* const kNoTables = "a sky's tables are a null pointer; precompute_sky makes some";

template <class Type>
const std::shared_ptr<const Type>& checked(const std::shared_ptr<const Type>& pointer, const char* if_null) {
  if (!pointer) throw Error(ErrorCode::invalid_argument, if_null);
  return pointer;
}

const CubemapView& first_of(const std::vector<CubemapView>& mips) {
  if (mips.empty())
    throw Error(ErrorCode::invalid_argument, "a source's mip chain is empty; pass at least the full size");
  return mips.front();
}

}  // namespace

EnvironmentSource::EnvironmentSource(Cubemap image)
    : EnvironmentSource(std::make_shared<const Cubemap>(std::move(image))) {}
EnvironmentSource::EnvironmentSource(LatLongImage image)
    : EnvironmentSource(std::make_shared<const LatLongImage>(std::move(image))) {}
EnvironmentSource::EnvironmentSource(std::shared_ptr<const Cubemap> image)
    : EnvironmentSource(checked(image, kNoImage)->view(), image) {
  if (image->levels() > 1) mips_ = image->views();
  bytes_ = image->bytes();
}
EnvironmentSource::EnvironmentSource(std::shared_ptr<const LatLongImage> image)
    : EnvironmentSource(checked(image, kNoImage)->view(), image) {}
EnvironmentSource::EnvironmentSource(const EnvironmentView& view, std::shared_ptr<const void> owner)
    : view_(view), owner_(std::move(owner)), bytes_(bytes_of(view)) {}
EnvironmentSource::EnvironmentSource(std::vector<CubemapView> mips, std::shared_ptr<const void> owner)
    : view_(first_of(mips)), mips_(std::move(mips)), owner_(std::move(owner)) {
  for (const CubemapView& view : mips_) bytes_ += bytes_of(view);
}

Projection Project::operator()(const Control& control) const {
  return source.mips().empty() ? project(source.view(), options, control) : project(source.mips(), options, control);
}

Cubemap ToCubemap::operator()(const Control& control) const {
  return to_cubemap(source.view(), size, rotation, ResampleFilter::area, control);
}

LatLongImage ToLatLong::operator()(const Control& control) const {
  return to_lat_long(source.view(), width, height, rotation, ResampleFilter::bilinear, control);
}

std::shared_ptr<const BakeResult> Bake::operator()(const Control& control) const {
  return std::make_shared<const BakeResult>(bake(source.view(), options, control));
}

std::shared_ptr<const BakeResult> BakeTo::operator()(const Control& control) const {
  return std::make_shared<const BakeResult>(bake_to(targets, source.view(), options, control));
}

std::shared_ptr<const SkyTables> PrecomputeSky::operator()(const Control& control) const {
  return std::make_shared<const SkyTables>(precompute_sky(atmosphere, options, control));
}

SkyCurve BakeSkyCurve::operator()(const Control& control) const {
  return SkyCurve(SkyView(checked(tables, kNoTables), altitude_m), options, control);
}

std::shared_ptr<const PrefilteredSpecular> SkySpecular::operator()(const Control& control) const {
  return std::make_shared<const PrefilteredSpecular>(
      sky_specular(SkyView(checked(tables, kNoTables), altitude_m), sun, options, {}, control));
}

}  // namespace welkin
