#include "welkin/requests.h"

#include <cstddef>
#include <memory>
#include <string>
#include <utility>
#include <variant>
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

// std::get_if, because std::get and std::visit may throw as far as the compiler knows.
using EitherSource = std::variant<CubemapSource, LatLongSource>;

std::uint64_t bytes_of(const EitherSource& source) noexcept {
  const auto* const cubemap = std::get_if<CubemapSource>(&source);
  return cubemap != nullptr ? cubemap->bytes() : std::get_if<LatLongSource>(&source)->bytes();
}

const char* const kNoImage = "a source is a null pointer to an image";
const char* const kNoTables = "a sky's tables are a null pointer; precompute_sky makes some";

template <class Type>
const std::shared_ptr<const Type>& checked(const std::shared_ptr<const Type>& pointer, const char* if_null) {
  if (!pointer) throw Error(ErrorCode::invalid_argument, if_null);
  return pointer;
}

}  // namespace

CubemapSource::CubemapSource(CubemapImage image)
    : CubemapSource(std::make_shared<const CubemapImage>(std::move(image))) {}
CubemapSource::CubemapSource(std::shared_ptr<const CubemapImage> image)
    : mips_{checked(image, kNoImage)->view()}, owner_(std::move(image)) {}
CubemapSource::CubemapSource(const CubemapView& view, std::shared_ptr<const void> owner)
    : mips_{view}, owner_(std::move(owner)) {}
CubemapSource::CubemapSource(std::vector<CubemapView> mips, std::shared_ptr<const void> owner)
    : mips_(std::move(mips)), owner_(std::move(owner)) {
  if (mips_.empty()) throw Error(ErrorCode::invalid_argument, "a source's mip chain is empty");
}

std::uint64_t CubemapSource::bytes() const noexcept {
  std::uint64_t sum = 0;
  for (const CubemapView& view : mips_) {
    sum += bytes_of_rows(6 * positive(view.size), view.size, view.row_stride_bytes, view.format);
  }
  return sum;
}

LatLongSource::LatLongSource(LatLongImage image)
    : LatLongSource(std::make_shared<const LatLongImage>(std::move(image))) {}
LatLongSource::LatLongSource(std::shared_ptr<const LatLongImage> image)
    : view_(checked(image, kNoImage)->view()), owner_(std::move(image)) {}
LatLongSource::LatLongSource(const LatLongView& view, std::shared_ptr<const void> owner)
    : view_(view), owner_(std::move(owner)) {}

std::uint64_t LatLongSource::bytes() const noexcept {
  return bytes_of_rows(positive(view_.height), view_.width, view_.row_stride_bytes, view_.format);
}

Projection ProjectCubemap::operator()(const Control& control) const {
  return source.mips().size() == 1 ? project(source.view(), options, control)
                                   : project(source.mips(), options, control);
}

Projection ProjectLatLong::operator()(const Control& control) const { return project(source.view(), options, control); }

CubemapImage LatLongToCubemap::operator()(const Control& control) const {
  return to_cubemap(source.view(), size, turn, ResampleFilter::area, control);
}

CubemapImage CubemapToCubemap::operator()(const Control& control) const {
  return to_cubemap(source.view(), size, turn, control);
}

LatLongImage CubemapToLatLong::operator()(const Control& control) const {
  return to_lat_long(source.view(), width, height, turn, ResampleFilter::bilinear, control);
}

std::shared_ptr<const BakeResult> Bake::operator()(const Control& control) const {
  return std::visit(
      [&](const auto& pixels) { return std::make_shared<const BakeResult>(bake(pixels.view(), options, control)); },
      source);
}

std::uint64_t Bake::bytes() const noexcept { return bytes_of(source); }

std::shared_ptr<const BakeResult> BakeTo::operator()(const Control& control) const {
  return std::visit(
      [&](const auto& pixels) {
        return std::make_shared<const BakeResult>(bake_to(targets, pixels.view(), options, control));
      },
      source);
}

std::uint64_t BakeTo::bytes() const noexcept { return bytes_of(source); }

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
