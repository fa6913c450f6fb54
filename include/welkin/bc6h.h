// Cubemaps as BC6H: blocks of 4 x 4 texels in 16 bytes, which graphics cards read as they are (BC6H_UF16, BC6H_SF16).
//
//   welkin::Bc6hCubemap blocks = welkin::encode_bc6h(light.specular->cubemap.views());
//   upload(blocks.levels[0].blocks);
//
// For radiance. Irradiance must not be compressed: where it nears 0 errors of a block are large beside it.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "welkin/core.h"
#include "welkin/image.h"

namespace WELKIN_EXPORT welkin {

/// How long is searched for a block's best numbers. Errors: rms of a channel's relative error (below 2^-14 relative to
/// that), over chains of 256 from seven pictures; docs/notes/textures.md has the table.
enum class Bc6hEffort {
  fast,    ///< one line of colours a block: 3.4 %
  normal,  ///< and two lines, with the partition that promises most, where one is not enough: 2.3 %
  slow,    ///< with the best of four partitions
};

/// What and how to encode.
struct Bc6hOptions {
  Bc6hEffort effort = Bc6hEffort::normal;  ///< what an error may cost
  bool is_signed = false;                  ///< BC6H_SFLOAT, which has negatives and half the precision
};

/// One level of a cubemap in blocks.
struct Bc6hLevel {
  int size = 0;  ///< texels along an edge; blocks at the right and at the bottom may reach beyond
  /// Face after face in the order of `CubemapView`, rows of blocks from the top: 6 x ceil(size / 4)^2 x 16 bytes.
  std::vector<std::uint8_t> blocks;
  /// Rms of the relative error of a channel, as the encoder sees it while it works. It is within a tenth of
  /// `bc6h_errors` from 16 texels on.
  double estimated_error = 0.0;
};

/// A chain of levels, largest first.
struct Bc6hCubemap {
  std::vector<Bc6hLevel> levels;     ///< largest first
  bool is_signed = false;            ///< BC6H_SFLOAT instead of BC6H_UFLOAT
  std::uint64_t values_clamped = 0;  ///< channel values that halves could not hold: above 65504, NaN, or negative
};

/// Encodes a cubemap with its mips, largest first, each half the one before (rounded down). Values that the format
/// cannot hold are clamped and counted, NaN becomes 0. The same bytes on every instruction set and any number of
/// threads. Throws `Error`: invalid_argument (an uneven chain), cancelled.
/// Error halves where the size of the faces doubles. A level of fewer than 32 texels has little in a block that is
/// alike: of 256 texels' chains with `normal`, 2.6 % at 16 texels, 4 to 5 % below. The ends of a level's brightest
/// blocks are chosen so that from 16 texels on the mean of each channel is within 0.5 % (signed: 0.8 %).
[[nodiscard]] Bc6hCubemap encode_bc6h(std::span<const CubemapView> mips, const Bc6hOptions& options = {},
                                      const Control& control = {});

/// Decodes all levels, exactly as the format is defined. Throws `Error`: invalid_argument (sizes and bytes that do not
/// fit), cancelled.
[[nodiscard]] CubemapChain decode_bc6h(const Bc6hCubemap& cubemap, const Control& control = {});

/// Of each level, the rms over all channels of (decoded - given) / max(|given|, 2^-14), with given as clamped to what
/// the format holds. Decodes all. Throws `Error`: invalid_argument, cancelled.
[[nodiscard]] std::vector<double> bc6h_errors(const Bc6hCubemap& cubemap, std::span<const CubemapView> mips,
                                              const Control& control = {});

}  // namespace welkin
