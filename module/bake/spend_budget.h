// What a scene may lose, spent: the cheapest setting of each pass that this environment allows.
#pragma once

#include "bake/needs.h"
#include "welkin/control.h"
#include "welkin/image_view.h"

namespace welkin::baking {

/// Bands of diffuse light up to those that are there, and the prefilter's bounds: picked, and said in `needed.chosen`.
/// `budget`: relative rms. Throws `Error` as `choose_prefilter` and `choose_irradiance_bands`.
void spend_budget(const LatLongView& view, double budget, NeededOptions& needed, const Control& control);
void spend_budget(const CubemapView& view, double budget, NeededOptions& needed, const Control& control);

}  // namespace welkin::baking
