// The bake from the inside: for sources that bring a part of the results along.
#pragma once

#include "welkin/bake.h"

namespace welkin::baking {

/// `bake_into`. `stored`: harmonics of the radiance that came with the pixels, used instead of a projection where they
/// have all bands that are asked for; may be null.
void bake_source(BakeResult& result, const CubemapView& source, const BakeOptions& options,
                 const SphericalHarmonics* stored, const Control& control);
void bake_source(BakeResult& result, const LatLongView& source, const BakeOptions& options,
                 const SphericalHarmonics* stored, const Control& control);

}  // namespace welkin::baking
