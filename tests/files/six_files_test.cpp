// Promises: six files are found by any one of them or by their directory, under every family of names and no other;
// they are read as one cube, formats mixed; and what is missing or does not fit is said by name.
#include "files/row_source.h"
#include "support/catch.h"
#include "support/coefficients.h"
#include "support/cube_images.h"
#include "support/exr_files.h"
#include "support/pfm_files.h"
#include "support/temporary_directory.h"
#include "support/thrown_error.h"
#include "welkin/environment_file.h"

namespace welkin::test {
namespace {

using Names = std::vector<std::string>;

const std::vector<Names> kFamilies{
    {"px", "nx", "py", "ny", "pz", "nz"},
    {"posx", "negx", "posy", "negy", "posz", "negz"},
    {"right", "left", "top", "bottom", "front", "back"},
    {"right", "left", "up", "down", "front", "back"},
    {"rt", "lf", "up", "dn", "ft", "bk"},
    {"0", "1", "2", "3", "4", "5"},
};

void write_face(const std::filesystem::path& path, int size, std::span<const float> faces, std::size_t face) {
  const auto count = static_cast<std::ptrdiff_t>(3 * size * size);
  const auto first = faces.begin() + static_cast<std::ptrdiff_t>(face) * count;
  const std::vector<float> pixels(first, first + count);
  if (path.extension() == ".exr") {
    ExrRecipe recipe{.width = size, .height = size, .channels = rgb_channels(Imf::FLOAT)};
    write_exr(path, recipe, pixels);
  } else {
    write_bytes(path, pfm_bytes(size, size, false, "-1", pixels));
  }
}

// Writes prefix + name + extension for each face.
std::vector<std::filesystem::path> write_six(const TemporaryDirectory& directory, const std::string& prefix,
                                             const Names& names, const std::string& extension, int size) {
  std::vector<std::filesystem::path> paths;
  for (std::size_t face = 0; face < 6; ++face) {
    paths.push_back(directory.file(prefix + names[face] + extension));
    write_face(paths.back(), size, unlike_texels(size), face);
  }
  return paths;
}

void touch(const std::filesystem::path& path) { write_bytes(path, {}); }

void check_refusal(const std::filesystem::path& path, ErrorCode code, const std::string& message) {
  const ThrownError error = thrown_by([&] { (void)files::face_files(path); });
  INFO(error.message);
  CHECK(error.code == code);
  CHECK(error.message.starts_with(path.string() + ": "));
  CHECK(error.says(message));
}

ReadOptions as_six_files() { return {.layout = Layout::six_files}; }

}  // namespace

TEST_CASE("six files are found under every family of names, by any of them and by their directory", "[codec][layout]") {
  for (const Names& names : kFamilies) {
    for (const std::string prefix : {"", "sky_", "sky-", "sky.", "a sky ", "posx_"}) {
      const TemporaryDirectory directory;
      CAPTURE(names[0], prefix);
      const auto paths = write_six(directory, prefix, names, ".pfm", 1);
      for (const std::filesystem::path& path : paths) {
        const auto found = files::face_files(path);
        CHECK(std::equal(found.begin(), found.end(), paths.begin()));
      }
      const auto found = files::face_files(paths[0].parent_path());
      CHECK(std::equal(found.begin(), found.end(), paths.begin()));
    }
  }
}

TEST_CASE("names of faces may be written in capitals, and the six may differ in that", "[codec][layout]") {
  const TemporaryDirectory directory;
  for (const char* name : {"Sky_PX.EXR", "Sky_nx.EXR", "Sky_Py.EXR", "Sky_NY.EXR", "Sky_pz.EXR", "Sky_nz.exr"}) {
    touch(directory.file(name));
  }
  CHECK(files::face_files(directory.file("Sky_Py.EXR"))[0].filename() == "Sky_PX.EXR");
  CHECK(files::face_files(directory.file("."))[5].filename() == "Sky_nz.exr");
  touch(directory.file("sky_px.exr"));  // another prefix: not of this set
  CHECK(files::face_files(directory.file("Sky_Py.EXR"))[0].filename() == "Sky_PX.EXR");
}

TEST_CASE("names that only resemble those of faces are none", "[codec][layout]") {
  const TemporaryDirectory directory;
  for (int number = 10; number < 16; ++number) touch(directory.file("map" + std::to_string(number) + ".exr"));
  for (const std::string& name : kFamilies[3]) touch(directory.file("thump" + name + ".exr"));
  const std::string ends = "its name does not end as one of six faces does (px nx py ny pz nz; posx negx posy";
  check_refusal(directory.file("map10.exr"), ErrorCode::unsupported_file, ends);
  check_refusal(directory.file("thumpup.exr"), ErrorCode::unsupported_file, "rename the six files accordingly");
  check_refusal(directory.file("none.exr"), ErrorCode::file_access, "there is no such file");
  check_refusal(directory.file("."), ErrorCode::file_access, "is a directory without six faces of a cube");
}

TEST_CASE("a numbered series of more than six is no cube", "[codec][layout]") {
  const TemporaryDirectory directory;
  for (int number = 0; number < 7; ++number) touch(directory.file("frame_" + std::to_string(number) + ".exr"));
  check_refusal(directory.file("frame_3.exr"), ErrorCode::unsupported_file,
                "belongs to a series that continues after 5 (there is a frame_6), so no six files of a cube; name the "
                "faces px nx py ny pz nz");
  check_refusal(directory.file("."), ErrorCode::file_access, "is a directory without six faces");
  std::filesystem::remove(directory.file("frame_6.exr"));
  CHECK(files::face_files(directory.file("frame_3.exr"))[0].filename() == "frame_0.exr");
}

TEST_CASE("missing faces are named, in the family that is the most complete", "[codec][layout]") {
  const TemporaryDirectory directory;
  for (const char* name : {"sky_right.exr", "sky_up.exr", "sky_down.exr", "sky_front.exr", "sky_back.exr"}) {
    touch(directory.file(name));
  }
  check_refusal(
      directory.file("sky_right.exr"), ErrorCode::file_access,
      "is one of six faces, and others are missing in its folder: -X (sky_left.exr); put them there, or rename the six "
      "so that they differ only at their ends");
  check_refusal(directory.file("sky_left.exr"), ErrorCode::file_access, "-X (sky_left.exr)");
  check_refusal(directory.file("night_px.exr"), ErrorCode::file_access,
                "+X (night_px.exr), -X (night_nx.exr), +Y (night_py.exr), -Y (night_ny.exr), +Z (night_pz.exr), -Z "
                "(night_nz.exr)");
  check_refusal(directory.file("nowhere") / "sky_px.exr", ErrorCode::file_access, "there is no such file");
}

TEST_CASE("six files are read as one cube, by any of them or their directory, asked for or not", "[codec][layout]") {
  for (const int size : {1, 2, 3, 7, 64, 130}) {
    const TemporaryDirectory directory;
    const std::vector<float> faces = unlike_texels(size);
    const auto paths = write_six(directory, "sky_", kFamilies[0], ".exr", size);
    for (const std::filesystem::path& path : {paths[4], paths[0].parent_path()}) {
      for (const ReadOptions& options : {ReadOptions{}, as_six_files()}) {
        for (const int threads : {1, 3}) {
          CAPTURE(size, path.string(), threads);
          run_with_threads(threads, [&] {
            const Environment cube = read_environment(path, options);
            CHECK(cube.info.layout == Layout::six_files);
            CHECK(cube.face_size() == size);
            CHECK(std::equal(faces.begin(), faces.end(), cube.pixels.get()));
            CHECK(cube.cubemap().size == size);
          });
        }
      }
    }
  }
}

TEST_CASE("a layout that is asked for keeps a face from being taken for a sixth", "[codec][layout]") {
  const TemporaryDirectory directory;
  const auto paths = write_six(directory, "sky_", kFamilies[0], ".pfm", 4);
  ReadOptions options{.layout = Layout::lat_long};
  CHECK(inspect_environment(paths[0], options).layout == Layout::lat_long);
  CHECK(inspect_environment(paths[0], options).faces[0].empty());
  check_thrown([&] { (void)inspect_environment(paths[0].parent_path(), options); }, ErrorCode::file_access,
               {"is a directory; name an image in it"});
}

TEST_CASE("faces that are not square or not of one size are named", "[codec][layout]") {
  const TemporaryDirectory directory;
  const auto paths = write_six(directory, "sky_", kFamilies[0], ".pfm", 4);
  write_face(paths[3], 5, unlike_texels(5), 3);
  const ThrownError uneven = thrown_by([&] { (void)inspect_environment(paths[0]); });
  CHECK(uneven.code == ErrorCode::unsupported_file);
  CHECK(uneven.message ==
        paths[3].string() +
            ": is 5 x 5, and sky_px.pfm is 4 x 4; the six faces of a cube are of one size: export them "
            "alike");
  write_bytes(paths[1], pfm_bytes(4, 2, false, "-1", some_pixels(4, 2)));
  const ThrownError oblong = thrown_by([&] { (void)inspect_environment(paths[0]); });
  CHECK(oblong.code == ErrorCode::unsupported_file);
  CHECK(oblong.message ==
        paths[1].string() +
            ": is 4 x 2, and the six faces of a cube are square; if it is not a face, pass --layout to say "
            "what it is");
}

TEST_CASE("damage in one of six files is reported with its name", "[codec][layout]") {
  const TemporaryDirectory directory;
  const auto paths = write_six(directory, "sky_", kFamilies[0], ".exr", 64);
  std::vector<char> bytes = read_bytes(paths[5]);
  std::fill_n(bytes.begin() + static_cast<std::ptrdiff_t>(bytes.size() / 2), bytes.size() / 4, '\x55');
  write_bytes(paths[5], bytes);
  check_thrown([&] { (void)read_environment(paths[0]); }, ErrorCode::corrupt_file, {paths[5].string() + ": "});
  touch(paths[2]);
  CHECK(thrown_by([&] { (void)read_environment(paths[0]); }).says(paths[2].string() + ": is empty"));
}

}  // namespace welkin::test
