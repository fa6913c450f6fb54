#include "tools/help_text.h"

namespace welkin::tool {

constexpr std::string_view kProgramDescription =
    R"(Welkin turns environments (photographed skies and rooms, computed skies) into light.)";

constexpr std::string_view kProgramFooter =
    R"(Examples:
  welkin sh                        the spherical harmonics of a built-in sky
  welkin sh studio.exr             ... of a photograph, as a table
  welkin sh studio.exr --json      ... for a program
  welkin info studio.exr           what is in the file
  welkin sh --help                 all about one command

Files: OpenEXR (scanline or tiled, half or float, every compression) and PFM;
a lat-long picture, or the six faces +X -X +Y -Y +Z -Z from top to bottom.

Units: radiance is whatever the file holds, W/(m2 sr) say; irradiance is then
W/m2, flux W/m2 too. Directions: y is up, a lat-long's centre looks along +z.

Results go to standard output, everything else to standard error.
The same input gives the same bits on every machine and number of threads;
WELKIN_ISA=sse2|avx2|avx512 in the environment picks an instruction set.

Exit codes: 0 done; 1 a file or its pixels are bad; 2 the command line is.)";

constexpr std::string_view kShFooter =
    R"(What it does:
  Integrates the environment's radiance against the spherical harmonics and
  prints the coefficients of radiance and irradiance, the same light as
  Babylon.js's SphericalPolynomial, the average colour, and how good all that
  is. The table says which convention and formulas the numbers follow.

Examples:
  welkin sh                                   a built-in sky
  welkin sh city.exr                          a table for a person
  welkin sh city.exr --json > city.json       for a program, every digit
  welkin sh city.exr --bands 1 --json         the ambient colour alone
  welkin sh city.exr --clamp 100              cut the sun off; says what it cost
  welkin sh city.exr --quadrature midpoint --clamp 4096
                                              what Babylon.js computes
  welkin sh faces.pfm --layout vertical-strip six faces, one above the other
  welkin sh city.exr --nan reject             fail on a NaN, and name its place

Units: radiance coefficients are (file unit) x sr; irradiance (file unit) x sr.

JSON: {"source": {path, layout, width, height, format}, "bands",
       "radiance": [[r,g,b], ...], "irradiance": [[r,g,b], ...],
       "babylon": {x, y, z, xx, yy, zz, yz, zx, xy}, "diagnostics": {...}};
  coefficient (l, m) is element l (l + 1) + m.

Exit codes: 0 done; 1 a file or its pixels are bad; 2 the command line is.)";

constexpr std::string_view kInfoFooter =
    R"(What it does:
  Reads header and pixels as they are, nothing replaced or clamped: size,
  layout and what told it, channels, compression; the least, greatest and mean
  value; NaN, infinite and negative values; the total flux; the brightest texel.

Examples:
  welkin info city.exr                        for a person
  welkin info city.exr --json                 for a program
  welkin info faces.exr --layout vertical-strip

Units: values as in the file; the mean is weighted by solid angle; the flux is
  the integral over the sphere, 4 pi times the mean. Rows count from the top,
  columns from the left, both from 0.

Exit codes: 0 done; 1 a file or its pixels are bad; 2 the command line is.)";

}  // namespace welkin::tool
