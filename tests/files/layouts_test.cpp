// Layouts: told, read, joined like the cube, and gone through by the labelled map.
#include "files/layout.h"
#include "files/row_source.h"
#include "image/geometry.h"
#include "support/catch.h"
#include "support/coefficients.h"
#include "support/cube_images.h"
#include "support/exr_files.h"
#include "support/pfm_files.h"
#include "support/same_bits.h"
#include "support/temporary_directory.h"
#include "support/thrown_error.h"
#include "tools/test_map.h"
#include "welkin/engines.h"
#include "welkin/environment_file.h"
#include "welkin/resampling.h"

namespace welkin::test {

// Promises: the layout is the requested one, otherwise the header's, otherwise that of the shape; and the reason
// is given.

namespace {

std::filesystem::path write_image(const TemporaryDirectory& directory, int width, int height,
                                  std::optional<Imf::Envmap> envmap = std::nullopt) {
  std::filesystem::path path = directory.file("sky.exr");
  ExrRecipe recipe{.width = width, .height = height, .envmap = envmap};
  write_exr(path, recipe, some_pixels(width, height));
  return path;
}

ReadOptions as(Layout layout) { return {.layout = layout}; }

}  // namespace

TEST_CASE("the shape tells the layout", "[codec]") {
  const TemporaryDirectory directory;
  const auto check = [&](int width, int height, Layout layout, const std::string& reason) {
    const EnvironmentInfo info = inspect_environment(write_image(directory, width, height));
    CHECK(info.layout == layout);
    CHECK(info.layout_reason == reason);
  };
  check(64, 32, Layout::lat_long, "64 x 32 is 2:1");
  check(8, 48, Layout::vertical_strip, "8 x 48 is 1:6");
  check(48, 8, Layout::horizontal_strip, "48 x 8 is 6:1");
  check(32, 24, Layout::horizontal_cross, "32 x 24 is 4:3");
  check(24, 32, Layout::vertical_cross, "24 x 32 is 3:4");
  check(4, 3, Layout::horizontal_cross, "4 x 3 is 4:3");
}

TEST_CASE("a shape that tells nothing is refused, and --layout is offered", "[codec]") {
  const TemporaryDirectory directory;
  for (const auto& [width, height] : {std::pair{64, 31}, {33, 24}, {32, 25}, {49, 8}, {8, 47}, {13, 9}, {5, 1}}) {
    const std::filesystem::path path = write_image(directory, width, height);
    const ThrownError error = thrown_by([&] { (void)inspect_environment(path); });
    CHECK(error.code == ErrorCode::unsupported_file);
    CHECK(error.message ==
          path.string() + ": " + std::to_string(width) + " x " + std::to_string(height) +
              " is neither a 2:1 lat-long nor a 1:6 vertical strip, a 6:1 horizontal strip, a 4:3 or a 3:4 cross; pass "
              "--layout to say what it is: lat-long (any ratio), vertical-strip (1:6), horizontal-strip (6:1), "
              "horizontal-cross (4:3), "
              "vertical-cross (3:4) or six-files (1:1 each)");
  }
}

TEST_CASE("a square that is none of six files is refused, saying why it is not", "[codec]") {
  const TemporaryDirectory directory;
  const std::filesystem::path path = write_image(directory, 8, 8);
  check_thrown([&] { (void)inspect_environment(path); }, ErrorCode::unsupported_file,
               {path.string() + ": 8 x 8 is square, so it would be a face among six files, but " + path.string() +
                    ": its name does not end as one of six faces does (px nx",
                ". If it is something else, pass --layout to say what: lat-long (any ratio), "});
  const std::filesystem::path face = directory.file("sky_px.exr");
  std::filesystem::rename(path, face);
  check_thrown([&] { (void)inspect_environment(face); }, ErrorCode::unsupported_file,
               {"is one of six faces, and others are missing in its folder: -X (sky_nx.exr), +Y (sky_py.exr)"});
  CHECK(inspect_environment(face, as(Layout::lat_long)).layout == Layout::lat_long);
  check_thrown([&] { (void)inspect_environment(face, as(Layout::six_files)); }, ErrorCode::file_access,
               {"-X (sky_nx.exr)"});
}

TEST_CASE("the header tells before the shape", "[codec]") {
  const TemporaryDirectory directory;
  const EnvironmentInfo odd = inspect_environment(write_image(directory, 50, 31, Imf::ENVMAP_LATLONG));
  CHECK(odd.layout == Layout::lat_long);
  CHECK(odd.layout_reason == "the header's envmap attribute says latlong");
  const EnvironmentInfo cube = inspect_environment(write_image(directory, 4, 24, Imf::ENVMAP_CUBE));
  CHECK(cube.layout == Layout::vertical_strip);
  CHECK(cube.layout_reason == "the header's envmap attribute says cube");
  const std::filesystem::path path = write_image(directory, 64, 32, Imf::ENVMAP_CUBE);
  check_thrown([&] { (void)inspect_environment(path); }, ErrorCode::unsupported_file,
               {path.string() + ": 64 x 32 is not a 1:6 vertical strip", "--layout lat-long"});
}

TEST_CASE("what is asked for comes before header and shape", "[codec]") {
  const TemporaryDirectory directory;
  const std::filesystem::path path = write_image(directory, 8, 48, Imf::ENVMAP_CUBE);
  const EnvironmentInfo info = inspect_environment(path, as(Layout::lat_long));
  CHECK(info.layout == Layout::lat_long);
  CHECK(info.layout_reason == "lat-long was requested");
  CHECK(inspect_environment(path, as(Layout::vertical_strip)).layout == Layout::vertical_strip);
  const std::filesystem::path wide = write_image(directory, 100, 31);
  CHECK(inspect_environment(wide, as(Layout::lat_long)).layout == Layout::lat_long);
  CHECK(thrown_by([&] {
          (void)inspect_environment(wide, as(Layout::vertical_strip));
        }).says("100 x 31 is not a 1:6 vertical strip"));
}

TEST_CASE("an environment gives the view of its own layout and no other", "[codec]") {
  const TemporaryDirectory directory;
  const Environment sky = read_environment(write_image(directory, 64, 32));
  CHECK(sky.lat_long().pixels == sky.pixels.get());
  CHECK(sky.lat_long().width == 64);
  CHECK(sky.lat_long().height == 32);
  check_thrown([&] { (void)sky.cubemap(); }, ErrorCode::invalid_argument,
               {"is a lat-long (64 x 32 is 2:1), not a cubemap"});
  CHECK(sky.face_size() == 0);
  const Environment strip = read_environment(write_image(directory, 8, 48));
  CHECK(strip.cubemap().size == 8);
  CHECK(strip.cubemap().faces[5] == strip.pixels.get() + 5 * 8 * 8 * 3);
  CHECK(thrown_by([&] { (void)strip.lat_long(); }).says("vertical-strip"));
}

// Promises: a cubemap comes out of an image of any layout texel for texel, whatever its size, and what lies between
// the faces of a cross is never seen: not in pixels, not in statistics, not in a projection.

namespace {

constexpr float kNaN = std::numeric_limits<float>::quiet_NaN();

void write_pfm(const std::filesystem::path& path, const CubeImage& image) {
  write_bytes(path, pfm_bytes(image.width, image.height, false, "-1", image.pixels));
}

bool holds(const Environment& environment, std::span<const float> faces) {
  return std::equal(faces.begin(), faces.end(), environment.pixels.get());
}

}  // namespace

TEST_CASE("every texel of every layout comes to its place", "[codec][layout]") {
  const TemporaryFile path("cube.pfm");
  for (const Layout layout : one_file_cube_layouts()) {
    for (const int size : {1, 2, 3, 7, 64, 130}) {
      CAPTURE(name(layout), size);
      const std::vector<float> faces = unlike_texels(size);
      write_pfm(path, cube_image(layout, size, faces, kNaN));
      const Environment cube = read_environment(path);
      CHECK(cube.info.layout == layout);
      CHECK(cube.face_size() == size);
      CHECK(holds(cube, faces));
      const CubemapView view = cube.cubemap();
      CHECK(view.size == size);
      for (std::size_t face = 0; face < 6; ++face) {
        const auto edge = static_cast<std::size_t>(size);
        CHECK(*static_cast<const float*>(view.faces[face]) == faces[face * edge * edge * 3]);
      }
    }
  }
}

TEST_CASE("what lies between the faces of a cross counts for nothing", "[codec][layout]") {
  const TemporaryFile path("cube.pfm");
  const int size = 24;
  const std::vector<float> faces = some_pixels(size, 6 * size);
  write_pfm(path, cube_image(Layout::vertical_strip, size, faces, 0.0F));
  const EnvironmentStatistics wanted = measure_environment(path);
  const Projection wanted_light = project_file(path);
  for (const Layout layout : one_file_cube_layouts()) {
    for (const float blank : {0.0F, 1e30F, -1.0F, kNaN}) {
      CAPTURE(name(layout), blank);
      write_pfm(path, cube_image(layout, size, faces, blank));
      const EnvironmentStatistics found = measure_environment(path);
      CHECK(found.texels == std::uint64_t{6} * size * size);
      CHECK(found.nans == 0);
      CHECK(found.negatives == wanted.negatives);
      CHECK(found.minimum == wanted.minimum);
      CHECK(found.maximum == wanted.maximum);
      for (int channel = 0; channel < 3; ++channel) {
        CHECK(found.mean[channel] == Approx(wanted.mean[channel]).epsilon(1e-13));
        CHECK(found.total_radiance[channel] == Approx(wanted.total_radiance[channel]).epsilon(1e-13));
      }
      CHECK(found.brightest == wanted.brightest);
      CHECK(found.brightest_direction == wanted.brightest_direction);
      CHECK(same_bits(project_file(path).radiance, wanted_light.radiance));
    }
  }
}

TEST_CASE("the brightest texel is told by its place in the image and its direction", "[codec][layout]") {
  const TemporaryFile path("cube.pfm");
  const int size = 8;
  const std::vector<float> dark(std::size_t{18} * size * size, 0.25F);
  for (std::size_t face = 0; face < 6; ++face) {
    std::vector<float> faces = dark;
    std::fill_n(faces.begin() + static_cast<std::ptrdiff_t>(3 * ((face * size + 2) * size + 5)), 3, 9.0F);
    write_pfm(path, cube_image(Layout::vertical_strip, size, faces, 0.0F));
    const glm::dvec3 wanted = measure_environment(path).brightest_direction;
    for (const Layout layout : one_file_cube_layouts()) {
      CAPTURE(name(layout), face);
      const CubeImage image = cube_image(layout, size, faces, 0.5F);
      write_pfm(path, image);
      const EnvironmentStatistics found = measure_environment(path);
      CHECK(found.brightest_direction == wanted);
      CHECK(image.pixels[static_cast<std::size_t>(3 * (found.brightest_row * image.width + found.brightest_column))] ==
            9.0F);
    }
  }
}

TEST_CASE("a cross is held as its faces alone and refused by what they take", "[codec][layout]") {
  const TemporaryFile path("cross.pfm");
  const int size = 64;
  write_pfm(path, cube_image(Layout::horizontal_cross, size, unlike_texels(size), kNaN));
  ReadOptions options{.memory_limit_bytes = 6 * size * size * 12 - 1};
  const ThrownError error = thrown_by([&] { (void)read_environment(path, options); });
  CHECK(error.code == ErrorCode::limit_exceeded);
  CHECK(error.message == path.string() +
                             ": 256 x 192 texels take 294912 bytes as RGB floats, above the limit of 294911; raise "
                             "the limit or reduce the image");
  options.memory_limit_bytes += std::uint64_t{1} << 19U;  // memory for decoding
  CHECK(read_environment(path, options).face_size() == size);
}

// Promises: in each cross, faces that touch in the image touch on the cube, edge along edge; in every layout each
// face lies once; and OpenEXR's strip is that of its own documentation.

namespace {

const files::FaceSegment* segment_at(const files::RowSegments& segments, int size, int column) {
  for (const files::FaceSegment& segment : segments) {
    if (column >= segment.first_column && column < segment.first_column + size) return &segment;
  }
  return nullptr;
}

// Returns the direction of a texel's centre, or nothing for a blank texel.
std::optional<glm::dvec3> direction_at(const files::CubePlacement& placement, int size, int column, int row) {
  if (column >= placement.columns * size || row >= placement.rows * size) return std::nullopt;
  const files::RowSegments segments = files::row_segments(placement, size, row);
  const files::FaceSegment* segment = segment_at(segments, size, column);
  if (segment == nullptr) return std::nullopt;
  const int offset = column - segment->first_column;
  const int face_column = segment->mirrored ? size - 1 - offset : offset;
  return image::face_direction(size, segment->face, face_column + 0.5, segment->face_row + 0.5);
}

}  // namespace

TEST_CASE("neighbouring texels of a cross are neighbours on the sphere, across faces too", "[codec][layout]") {
  for (const Layout layout : {Layout::horizontal_cross, Layout::vertical_cross}) {
    for (const int size : {1, 2, 7, 16}) {
      CAPTURE(name(layout), size);
      const files::CubePlacement& placement = files::cube_placement(layout);
      int joins = 0;
      for (int row = 0; row < placement.rows * size; ++row) {
        for (int column = 0; column < placement.columns * size; ++column) {
          const auto here = direction_at(placement, size, column, row);
          for (const auto& there :
               {direction_at(placement, size, column + 1, row), direction_at(placement, size, column, row + 1)}) {
            if (!here || !there) continue;
            ++joins;
            // Centres of neighbours are at most two texels' edges of 2 / size apart on the cube's surface.
            const double angle = std::acos(std::min(1.0, glm::dot(*here, *there)));
            REQUIRE(angle <= 2.0 * std::atan(1.0 / size) + 1e-9);
          }
        }
      }
      const int inside_faces = 6 * 2 * size * (size - 1);
      CHECK(joins == inside_faces + 5 * size);
    }
  }
}

// Promise: the labelled map shows which way is which, the same on a lat-long and on a cube.

namespace {

glm::dvec3 mean_of_face(const Cubemap& map, int face) {
  const std::size_t texels = static_cast<std::size_t>(map.size()) * static_cast<std::size_t>(map.size());
  glm::dvec3 sum(0.0);
  for (std::size_t i = 0; i < texels; ++i) {
    const float* rgb = map.face(0) + 3 * (static_cast<std::size_t>(face) * texels + i);
    sum += glm::dvec3(rgb[0], rgb[1], rgb[2]);
  }
  return sum / static_cast<double>(texels);
}

}  // namespace

TEST_CASE("Positive axes have their primary colour, negative ones its complement", "[testmap]") {
  const Cubemap map = test_map_cubemap(32);
  for (int face = 0; face < 6; ++face) {
    const glm::dvec3 mean = mean_of_face(map, face);
    const int axis = face / 2;
    for (int other : {(axis + 1) % 3, (axis + 2) % 3}) {
      CAPTURE(face, other);
      if (face % 2 == 0) {
        CHECK(mean[axis] > mean[other] + 0.1);
      } else {
        CHECK(mean[axis] < mean[other] - 0.1);
      }
    }
  }
}

TEST_CASE("Lat-long and cubemap are the same map", "[testmap][slow]") {
  const LatLongImage map = test_map_lat_long(512, 256);
  const Cubemap cube = test_map_cubemap(128);
  const LatLongImage from_cube = to_lat_long(cube.view(), 512, 256);
  CHECK(std::ranges::all_of(map.pixels, [](float value) { return value >= 0.0F && value <= 1.0F; }));
  double squares = 0.0;
  for (std::size_t i = 0; i < map.pixels.size(); ++i) squares += std::pow(map.pixels[i] - from_cube.pixels[i], 2);
  CHECK(std::sqrt(squares / static_cast<double>(map.pixels.size())) < 0.08);
}

TEST_CASE("From inside, letters read from left to right and arrows point up", "[testmap][slow]") {
  // On each wall of the lat-long: the sign stands to the left of the letter. The upper half of an X, Z or its like and
  // the word below it are not symmetric to the arrow above.
  const int width = 1024;
  const LatLongImage map = test_map_lat_long(width, 512);
  const auto is_ink = [&](int column, int row) {
    const float* rgb = map.pixels.data() + 3 * (row * width + (column + width) % width);
    return rgb[0] > 0.9F && rgb[1] > 0.9F && rgb[2] > 0.9F;
  };
  for (const int middle : {0, 256, 512, 768}) {
    int left = 0;
    int right = 0;
    int above = 0;
    int below = 0;
    for (int row = 190; row < 315; ++row) {
      for (int step = 8; step < 110; ++step) {
        left += is_ink(middle - step, row) ? 1 : 0;
        right += is_ink(middle + step, row) ? 1 : 0;
      }
    }
    for (int step = -12; step <= 12; ++step) {
      for (int row = 140; row < 180; ++row) above += is_ink(middle + step, row) ? 1 : 0;
      for (int row = 332; row < 372; ++row) below += is_ink(middle + step, row) ? 1 : 0;
    }
    CAPTURE(middle, left, right, above, below);
    CHECK(left * 1.2 < right);  // '+' and '-' have less ink than 'X' and 'Z'
    CHECK(above > 200);         // the arrow's shaft
  }
}

// Promise: a labelled map goes through every layout, format and orientation and back, and no texel moves.

namespace {

constexpr std::array kCubeLayouts{Layout::automatic,        Layout::vertical_strip, Layout::horizontal_strip,
                                  Layout::horizontal_cross, Layout::vertical_cross, Layout::six_files};

}  // namespace

TEST_CASE("The labelled map goes through every layout and back without a moved texel", "[writers][layouts]") {
  for (const int size : {1, 2, 7, 32}) {
    const Cubemap map = test_map_cubemap(size);
    for (const char* extension : {".exr", ".pfm"}) {
      for (const Layout layout : kCubeLayouts) {
        const TemporaryDirectory directory;
        const auto path = directory.file(std::string("map") + extension);
        const WriteReport report = write_environment(path, map.view(), {layout, SampleType::float32});
        CAPTURE(size, extension, name(layout));
        REQUIRE(report.files.size() == (layout == Layout::six_files ? 6U : 1U));
        const Environment read = read_environment(report.files.front());  // the layout follows from shape and header
        REQUIRE(read.face_size() == size);
        CHECK(same_bits(map.pixels(), read.pixels.get()));
      }
    }
  }
}

TEST_CASE("The labelled map goes into every engine's faces and back without a moved texel", "[resampling]") {
  const Cubemap map = test_map_cubemap(32);
  for (const Convention& engine : conventions()) {
    if (!engine.faces_from_engine) continue;
    const glm::dmat3 there = *engine.faces_from_engine * engine.from_welkin;
    CAPTURE(engine.name);
    const Cubemap rotated = to_cubemap(map.view(), 32, there);
    CHECK(same_bits(map.pixels(), to_cubemap(rotated.view(), 32, glm::transpose(there)).pixels().data()));
  }
}

}  // namespace welkin::test
