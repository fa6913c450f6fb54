// Promises: a Radiance picture is the same picture in every form of its scanlines, from every corner, at every width,
// in any pieces, on any number of threads.
#include <algorithm>
#include <cstring>
#include <tuple>

#include "codec/row_source.h"
#include "support/catch.h"
#include "support/hdr_files.h"
#include "support/temporary_directory.h"
#include "welkin/environment_file.h"
#include "welkin/error.h"

namespace welkin {
namespace {

const ReadOptions kLatLong{Layout::lat_long};

bool same_bits(const std::vector<float>& wanted, const float* found) {
  return std::memcmp(wanted.data(), found, wanted.size() * sizeof(float)) == 0;
}

void check_whole(const std::filesystem::path& path, const test::HdrRecipe& recipe,
                 const std::vector<test::Rgbe>& texels) {
  CAPTURE(recipe.width, recipe.height, static_cast<int>(recipe.form), recipe.columns, recipe.bottom_first,
          recipe.right_first);
  test::write_bytes(path, test::hdr_bytes(recipe, texels));
  const Environment read = read_environment(path, kLatLong);
  REQUIRE(read.info.width == recipe.width);
  REQUIRE(read.info.height == recipe.height);
  CHECK(same_bits(test::decoded(texels), read.pixels.get()));
}

}  // namespace

TEST_CASE("all forms and orientations of a Radiance picture are the same picture", "[codec][hdr]") {
  const test::TemporaryDirectory directory;
  const std::filesystem::path path = directory.file("sky.hdr");
  const std::vector<test::Rgbe> texels = test::some_rgbe(38, 19);
  for (const test::HdrForm form :
       {test::HdrForm::flat, test::HdrForm::old_rle, test::HdrForm::new_rle, test::HdrForm::mixed}) {
    for (int orientation = 0; orientation < 8; ++orientation) {
      const test::HdrRecipe recipe{38, 19, form, orientation >= 4, orientation % 4 >= 2, orientation % 2 == 1};
      check_whole(path, recipe, texels);
    }
  }
}

TEST_CASE("Radiance pictures of any width are read", "[codec][hdr]") {
  const test::TemporaryDirectory directory;
  const std::filesystem::path path = directory.file("sky.hdr");
  for (const auto& [width, height] : {std::tuple{1, 1},
                                      {1, 9},
                                      {2, 1},
                                      {3, 2},
                                      {7, 3},
                                      {8, 3},
                                      {9, 2},
                                      {127, 3},
                                      {128, 3},
                                      {129, 3},
                                      {257, 5},
                                      {32767, 2},
                                      {32768, 2},
                                      {65536, 1}}) {
    const std::vector<test::Rgbe> texels = test::some_rgbe(width, height, static_cast<unsigned>(width));
    for (const test::HdrForm form :
         {test::HdrForm::flat, test::HdrForm::old_rle, test::HdrForm::new_rle, test::HdrForm::mixed}) {
      check_whole(path, {width, height, form}, texels);
      if (width <= 257) {
        check_whole(path, {width, height, form, true, false, true}, texels);
      }
    }
  }
}

TEST_CASE("long repeats of the old form shift their counts", "[codec][hdr]") {
  const test::TemporaryDirectory directory;
  const std::filesystem::path path = directory.file("sky.hdr");
  for (const int width : {256, 257, 258, 513, 65536}) {  // after a first texel: counts of 255, 256, 257, 512, 65535
    const std::vector<test::Rgbe> texels(static_cast<std::size_t>(width), test::Rgbe{200, 100, 50, 130});
    check_whole(path, {width, 1, test::HdrForm::old_rle}, texels);
  }
  // A repeat, a texel, a repeat: the texel in between starts the counting anew.
  const test::HdrRecipe recipe{10, 1};
  std::string file = test::hdr_header(recipe);
  file += std::string("\x80\x40\x20\x81\x01\x01\x01\x03", 8) + std::string("\x90\x40\x20\x81\x01\x01\x01\x05", 8);
  test::write_bytes(path, {file.begin(), file.end()});
  std::vector<test::Rgbe> texels(4, {0x80, 0x40, 0x20, 0x81});
  texels.resize(10, {0x90, 0x40, 0x20, 0x81});
  CHECK(same_bits(test::decoded(texels), read_environment(path, kLatLong).pixels.get()));
}

TEST_CASE("what may look like the new form is read as Radiance reads it", "[codec][hdr]") {
  const test::TemporaryDirectory directory;
  const std::filesystem::path path = directory.file("sky.hdr");
  // Third byte 128 or more: an old texel. Below 8 texels and above 32767: never the new form.
  std::vector<test::Rgbe> texels = test::some_rgbe(8, 4);
  texels[0] = texels[8] = {2, 2, 128, 8};
  check_whole(path, {8, 4, test::HdrForm::flat}, texels);
  check_whole(path, {8, 4, test::HdrForm::old_rle}, texels);
  texels.resize(14);
  texels[0] = texels[7] = {2, 2, 0, 7};
  check_whole(path, {7, 2, test::HdrForm::flat}, texels);
  texels = test::some_rgbe(32768, 1);
  texels[0] = {2, 2, 127, 255};
  check_whole(path, {32768, 1, test::HdrForm::flat}, texels);
}

TEST_CASE("codes of no texels are passed over", "[codec][hdr]") {
  const test::TemporaryDirectory directory;
  const std::filesystem::path path = directory.file("sky.hdr");
  std::string file = test::hdr_header({8, 1}) + std::string("\x02\x02\x00\x08", 4);
  for (const char value : {'\x11', '\x22', '\x33', '\x7f'}) {
    file += std::string("\x00\x00\x83", 3) + value + std::string("\x00\x80\x00\x85", 4) + value;
  }
  // A code of 128 takes 128 values, as Radiance has it: a run of none would be 0.
  test::write_bytes(path, {file.begin(), file.end()});
  CHECK_THROWS_AS(read_environment(path, kLatLong), Error);
  file = test::hdr_header({8, 1}) + std::string("\x02\x02\x00\x08", 4);
  for (const char value : {'\x11', '\x22', '\x33', '\x7f'}) {
    file += std::string("\x00\x00\x83", 3) + value + std::string("\x00\x85", 2) + value;
  }
  test::write_bytes(path, {file.begin(), file.end()});
  const std::vector<test::Rgbe> texels(8, {0x11, 0x22, 0x33, 0x7f});
  CHECK(same_bits(test::decoded(texels), read_environment(path, kLatLong).pixels.get()));
}

TEST_CASE("a Radiance picture's rows can be read in any pieces", "[codec][hdr]") {
  const test::TemporaryDirectory directory;
  const std::filesystem::path path = directory.file("sky.hdr");
  constexpr int kWidth = 90;
  constexpr int kHeight = 45;
  const std::vector<test::Rgbe> texels = test::some_rgbe(kWidth, kHeight);
  const std::vector<float> wanted = test::decoded(texels);
  for (int orientation = 0; orientation < 8; ++orientation) {
    CAPTURE(orientation);
    test::write_bytes(path, test::hdr_bytes({kWidth, kHeight, test::HdrForm::mixed, orientation >= 4,
                                             orientation % 4 >= 2, orientation % 2 == 1},
                                            texels));
    const auto source = codec::open_row_source(path, {});
    const auto check_piece = [&](codec::RowReader& reader, int first, int count) {
      std::vector<float> rows(static_cast<std::size_t>(count) * 3 * kWidth);
      reader.read(first, count, rows.data());
      REQUIRE(std::equal(rows.begin(), rows.end(), wanted.begin() + first * 3 * kWidth));
    };
    for (const int rows : {1, 2, 3, 7, 44, 45}) {
      const auto downwards = source->open_reader();
      for (int first = 0; first < kHeight; first += rows) {
        check_piece(*downwards, first, std::min(rows, kHeight - first));
      }
      const auto upwards = source->open_reader();
      for (int first = kHeight - 1; first >= 0; first -= rows) {
        check_piece(*upwards, first, std::min(rows, kHeight - first));
      }
    }
  }
}

TEST_CASE("a Radiance picture has the same bits on any number of threads, streamed or whole", "[codec][hdr]") {
  const test::TemporaryDirectory directory;
  const std::filesystem::path path = directory.file("sky.hdr");
  constexpr int kWidth = 700;
  constexpr int kHeight = 350;  // enough texels for several tasks
  std::vector<test::Rgbe> texels = test::some_rgbe(kWidth, kHeight);
  for (test::Rgbe& texel : texels) {
    texel[3] = std::min(texel[3], std::uint8_t{140});  // for sums that stay finite
  }
  const std::vector<float> wanted = test::decoded(texels);
  for (const bool columns : {false, true}) {
    for (const bool bottom_first : {false, true}) {
      CAPTURE(columns, bottom_first);
      test::write_bytes(path, test::hdr_bytes({kWidth, kHeight, test::HdrForm::mixed, columns, bottom_first}, texels));
      const LatLongView view{wanted.data(), kWidth, kHeight, 0, PixelFormat::rgb_f32};
      const Projection reference = project(view);
      for (const int threads : {1, 4}) {
        run_with_threads(threads, [&] {
          CHECK(same_bits(wanted, read_environment(path).pixels.get()));
          const Projection streamed = project_file(path);
          const auto found = streamed.radiance.coefficients();
          CHECK(std::equal(found.begin(), found.end(), reference.radiance.coefficients().begin()));
        });
      }
    }
  }
}

}  // namespace welkin
