// Real pictures and the pixels that are known to be in them, where they are at hand.
#pragma once

#include <filesystem>

#include "places.h"
#include "support/catch.h"

namespace welkin::test {

inline const std::filesystem::path kPictures = std::filesystem::path(WELKIN_SHARED) / "hdr";
inline const std::filesystem::path kVariants = kPictures / "variants";

/// Says so if they are not.
inline bool shared_pictures_are_here() {
  if (std::filesystem::exists(kVariants / "truth_256x128.npy")) return true;
  WARN("left out: the shared pictures are not at " << kPictures);
  return false;
}

}  // namespace welkin::test
