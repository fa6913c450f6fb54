// Cubemaps to the faces of an engine, texel by texel.
#pragma once

#include <glm/mat3x3.hpp>

#include "tools/turn_options.h"
#include "welkin/control.h"
#include "welkin/cubemap_chain.h"
#include "welkin/image.h"

namespace welkin::tool {

/// What takes Welkin's axes to the places in the engine's cube faces: one of the cube's 48 symmetries. Throws `Error`
/// (invalid_argument) for an engine that has no cube faces.
[[nodiscard]] glm::dmat3 faces_of(Engine engine);

/// Every texel is moved as it is.
[[nodiscard]] CubemapChain turned(const CubemapChain& chain, const glm::dmat3& symmetry, const Control& control);
[[nodiscard]] CubemapImage turned(const CubemapImage& cubemap, const glm::dmat3& symmetry, const Control& control);

}  // namespace welkin::tool
