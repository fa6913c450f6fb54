#include "tools/help_text.h"

namespace welkin::tool {

constexpr std::string_view kProgramDescription =
    R"(Welkin turns environments (photographed skies and rooms, computed skies) into light.)";

constexpr std::string_view kProgramFooter =
    R"(Examples:
  welkin bake -o out                 all that a renderer loads, of a built-in sky
  welkin bake studio.hdr -o out      ... of a photograph
  welkin sh                          the spherical harmonics of a built-in sky
  welkin sh studio.hdr               ... of a photograph, as a table
  welkin sh studio.hdr --for three   ... as three.js wants them
  welkin sky --sun-elevation 20      ... of a clear sky, computed
  welkin info studio.hdr             what is in the file
  welkin report --quick              how good each setting is, and how fast
  welkin convert studio.hdr faces.exr --layout vertical-strip
                                     a lat-long to the faces of a cube
  welkin testmap -o labels.exr       an environment that shows how it is turned
  welkin sh --help                   all about one command

Files: OpenEXR, Radiance .hdr, PFM, PNG. A sphere is a lat-long picture, or six
faces in a strip, a cross or six files; header, shape or name tell which.

Units: radiance is whatever the file holds, W/(m2 sr) say; irradiance is then
W/m2, flux W/m2 too. Skies are computed in W/(m2 sr nm) or cd/m2. Directions: y is up, a lat-long's centre looks along +z.

Results go to standard output, everything else to standard error.
The same input gives the same bits on every machine and number of threads;
WELKIN_ISA=sse2|avx2|avx512 in the environment picks an instruction set.

Exit codes: 0 done; 1 a file or its pixels are bad; 2 the command line is.)";

constexpr std::string_view kBakeFooter =
    R"(What it does:
  From an environment to the files with which a physically based renderer lights
  a scene, in one folder:
    background.ktx2       the environment as a cubemap, with plain mips
    specular.ktx2         blurred by GGX lobes, a roughness a mip (split sum)
    irradiance.ktx2       what falls on a matte surface, W/m2
    brdf.ktx2             the BRDF table, the split sum's other half
    environment.env       all of it for Babylon.js
    sh.json, sh.h         spherical harmonics, also in each engine's form
    preview_*.png         the environment, balls lit by the result, the mips
    manifest.json         what is in the folder, how it was made, how good it is
  The manifest is written last: with it, the folder is complete. Other files in
  the folder stay. docs/bake_folder.md says how engines load
  them.

Examples:
  welkin bake -o out                                  a built-in sky
  welkin bake city.hdr -o out                         a photograph
  welkin bake city.hdr -o out --size 512 --json       and what was done, as JSON
  welkin bake city.hdr -o out --for three --formats ktx2,exr
  welkin bake city.hdr -o out --roughness linear --mips all
  welkin bake city.hdr -o out --roughness 0,0.25,0.5,0.75,1
  welkin bake city.hdr -o out --ktx2-format e5b9g9r9 --supercompression zstd
  welkin bake city.hdr -o out --formats env --no-brdf --no-previews
  welkin bake city.hdr -o out --take-out-sun          the sun as a light apart
  welkin bake city.hdr -o out --no-glossy --explain   less than all, and why
  welkin bake city.hdr -o out --glossy 0.4,1          the mips that are looked up
  welkin bake city.hdr -o out --needs scene.json --plan-only

What the scene needs: --needs, --glossy, --no-glossy, --no-background and
  --no-diffuse say what it uses; passes that nothing of it needs are left out,
  and what is left comes out with the bits of a bake of everything. What an .env
  or a KTX2 carries is then taken as it is, unless it is to be turned, clamped
  or written as an .env. --explain says which passes run, are reused or left
  out, why and at what cost, on standard error; when it is done, how that
  compares with what was measured.

Orientation: --mirror comes first, then --rotation, then --yaw, in Welkin's
  axes. --for says after whose axes the cubemaps' faces are named; the .env is
  Babylon.js's in any case, and the previews show what one sees who stands there.
  An .env that is read is taken out of Babylon.js's axes.

Diffuse light of an .env: up to three bands, the irradiance cubemap and the new
  .env's polynomial come from the polynomial that it stores, as its pixels end
  at 255; not with --clamp, --gamma, --take-out-sun or --level above 0.

Memory: --memory-limit is checked before the bake: source, results, working
  memory, the .env's own chain, lat-longs and turned cubemaps. Previews and what
  encoders hold of a file come on top and are not counted.

Units: radiance as in the file, irradiance pi times that in even light.
  Roughness is perceptual roughness; GGX's alpha is its square. What a format
  cannot hold is clamped to it and counted, file by file.

Exit codes: 0 done; 1 a file or its pixels are bad; 2 the command line is.)";

constexpr std::string_view kShFooter =
    R"(What it does:
  Says how much light comes from where, in a few numbers. Nine of them a colour
  are enough to light matte surfaces: a sum of waves over the sphere (spherical
  harmonics), the coarsest first. The first is the mean colour; the next three
  say from which side most light comes; the next five add how it is spread.

  It integrates the environment's radiance against the harmonics and prints the
  coefficients of radiance and irradiance, the same light in the form that an
  engine wants, the average colour, the dominant light, and how good all that
  is. The table says which convention and formulas the numbers follow.

Examples:
  welkin sh                                   a built-in sky
  welkin sh city.hdr                          a table for a person
  welkin sh city.hdr --json > city.json       for a program, every digit
  welkin sh city.hdr --for unity --format c   a C header with Unity's numbers
  welkin sh faces/ --from babylon --for babylon
                                              cube faces made for Babylon.js
  welkin sh city.hdr --yaw 90 --mirror        turned and mirrored first
  welkin sh city.hdr --take-out-sun           the sun as a directional light
  welkin sh city.hdr --window least           no negative irradiance
  welkin sh city.hdr --bands 1 --json         the ambient colour alone
  welkin sh city.hdr --clamp 100              cut the sun off; says what it cost
  welkin sh city.hdr --quadrature midpoint --clamp 4096
                                              what Babylon.js computes
  welkin sh city.hdr --nan reject             fail on a NaN, and name its place

Units: radiance coefficients are (file unit) x sr; irradiance (file unit) x sr.

Forms (--for): U is the radiance coefficient (l, m) at l (l + 1) + m: real,
  orthonormal, no Condon-Shortley phase, Y(1, -1..1) ~ y, z, x, turned to the
  engine's axes; R is U with the signs of odd m turned, (+ - + - + - + - +).
  A = (pi, 2pi/3, pi/4) by band; K = the basis functions' constants.
    babylon   polynomial of the normal: A/pi R, folded into x .. xy, times 1/pi
    three     U, for LightProbe.sh (the shader multiplies by A and Y)
    filament  A/pi K U: value times albedo, so E/pi; nine float3 for its shader
    unity     A/pi K U: SphericalHarmonicsL2, and its seven shader vectors
    unreal    R in z-up axes: FSHVectorRGB3, and its sky light's seven vectors
    gltf      A R: irradianceCoefficients of EXT_lights_image_based
    godot     U/pi: lightmap probes
  Each is printed with its formula; docs/engines.md has where that comes from.

JSON: {"source": {path, layout, width, height, format, notes}, "axes", "bands",
       "radiance": [[r,g,b], ...], "irradiance": [[r,g,b], ...],
       "babylon": {x, y, z, xx, yy, zz, yz, zx, xy}, "engine": {name, form,
       formula, terms, vectors (unity, unreal)} or null, "window",
       "dominant_light", "sun", "irradiance_errors", "diagnostics": {...}};
  coefficient (l, m) is element l (l + 1) + m. All are in the same axes.

Exit codes: 0 done; 1 a file or its pixels are bad; 2 the command line is.)";

constexpr std::string_view kInfoFooter =
    R"(What it does:
  Reads header and pixels as they are, nothing replaced or clamped: size,
  layout and what told it, channels, compression, parts, layers, mip levels; the
  least, greatest and mean value; NaN, infinite and negative values; the total
  flux; the brightest texel.

Examples:
  welkin info city.hdr                        for a person
  welkin info city.exr --json                 for a program
  welkin info faces.exr --layout vertical-strip

Units: values as in the file; the mean is weighted by solid angle; the flux is
  the integral over the sphere, 4 pi times the mean. Rows count from the top,
  columns from the left, both from 0.

Exit codes: 0 done; 1 a file or its pixels are bad; 2 the command line is.)";

constexpr std::string_view kConvertFooter =
    R"(What it does:
  Reads an environment and writes it in the format that OUT's name ends with:
  .exr, .hdr, .pfm or .png. Where no other layout, size or orientation is asked
  for, or one that only moves whole texels (a cube by quarter turns, a mirror),
  every texel stays what it is. Else each new texel is the mean over its area.

Orientation: --mirror comes first, then --rotation, then --yaw, in Welkin's
  axes: right-handed, y up; a lat-long's centre looks along +z, +x lies to its
  left. --from and --for say whose axes the faces of IN and OUT are named after;
  a lat-long is the same picture for all engines. 'welkin testmap' makes a
  picture that shows what was done.

Examples:
  welkin convert sky.hdr sky.exr                        half, lat-long as it was
  welkin convert sky.hdr sky.exr --type float           every bit
  welkin convert sky.exr cube.exr --layout vertical-strip --size 512
  welkin convert sky.exr face.png --layout six-files    face_px.png, face_nx.png..
  welkin convert cross.png sky.exr --in-layout vertical-cross --layout lat-long
  welkin convert sky.exr turned.exr --yaw 90            a quarter to the left
  welkin convert sky.exr cube.png --layout horizontal-cross --for three
  welkin convert sky.exr small.exr --size 1024          1024 x 512
  welkin convert sky.exr rest.exr --take-out-sun        and a directional light

Units: values as they are in the file, linear; a PNG is sRGB. What a format
  cannot hold is clamped to it and counted: .exr half 65504; .hdr nothing
  negative; .png 0 to 1.

Exit codes: 0 done; 1 a file or its pixels are bad; 2 the command line is.)";

constexpr std::string_view kTestmapFooter =
    R"(What it does:
  Draws an environment whose six sides have a colour each, with their axes
  written on them, to be read from inside the sphere: LEFT +X (red), RIGHT -X
  (cyan), UP +Y (green), DOWN -Y (magenta), FRONT +Z (blue), BACK -Z (yellow).
  Arrows point up; lines are 15 degrees apart. In an engine, letters that are
  mirrored mean that the environment is; letters in the wrong place, that it is
  turned. UP and DOWN read for one who faces +Z and looks up, or down.

  A cubemap's faces, looked at as pictures, show their letters mirrored: cube
  faces are laid out for left-handed axes, and Welkin's are right-handed. With
  'welkin convert --for babylon' they read upright. docs/orientation.md shows it.

Examples:
  welkin testmap -o test.exr                            2048 x 1024
  welkin testmap -o test.png --size 1024
  welkin testmap -o cube.exr --layout vertical-strip --size 256
  welkin testmap -o face.png --layout six-files         face_px.png, face_nx.png..

Units: linear values from 0 to 1; a PNG is sRGB.

Exit codes: 0 done; 1 a file or its pixels are bad; 2 the command line is.)";

}  // namespace welkin::tool
