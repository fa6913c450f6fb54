// JPEG with a gain map: what is read of it, and what is refused.
#include "files/jpeg.h"

#include "places.h"
#include "support/catch.h"
#include "support/jpeg_files.h"
#include "support/same_bits.h"
#include "support/temporary_directory.h"
#include "support/thrown_error.h"
#include "welkin/environment_file.h"

namespace welkin::test {

// Promises: the image of high dynamic range that base and gain map make, by XMP's numbers or ISO 21496-1's, whatever
// the two images' sizes and channels; an ICC profile's primaries become Rec. 709; without a gain map it is refused.

namespace {

using Bytes = std::vector<char>;

struct Shape {
  int width, height, components;
};

double srgb_curve(double encoded) {
  return encoded <= 0.04045 ? encoded / 12.92 : std::pow((encoded + 0.055) / 1.055, 2.4);
}

double at(const std::vector<double>& values, std::size_t channel) { return values[values.size() == 1 ? 0 : channel]; }

/// The formula of ISO 21496-1, 5.2, by libm, of samples that libjpeg decoded: what the library must give.
std::vector<double> expected(const Bytes& base, const Shape& of_base, const Bytes& map, const Shape& of_map,
                             const GainNumbers& numbers) {
  const std::vector<std::uint8_t> colours = jpeg_samples(base), gains = jpeg_samples(map);
  const auto sample = [&](int row, int column, std::size_t channel) {
    const auto clamped = [](int value, int count) { return static_cast<std::size_t>(std::clamp(value, 0, count - 1)); };
    const std::size_t texel =
        clamped(row, of_map.height) * static_cast<std::size_t>(of_map.width) + clamped(column, of_map.width);
    return gains[texel * static_cast<std::size_t>(of_map.components) + (of_map.components == 1 ? 0 : channel)] / 255.0;
  };
  std::vector<double> light;
  for (int row = 0; row < of_base.height; ++row) {
    for (int column = 0; column < of_base.width; ++column) {
      for (std::size_t channel = 0; channel < 3; ++channel) {
        const double v = (row + 0.5) * of_map.height / of_base.height - 0.5;
        const double u = (column + 0.5) * of_map.width / of_base.width - 0.5;
        const int top = static_cast<int>(std::floor(v)), left = static_cast<int>(std::floor(u));
        const double down = v - top, across = u - left;
        const double mixed =
            (1 - down) * ((1 - across) * sample(top, left, channel) + across * sample(top, left + 1, channel)) +
            down * ((1 - across) * sample(top + 1, left, channel) + across * sample(top + 1, left + 1, channel));
        const double share = std::pow(mixed, 1.0 / at(numbers.gamma, channel));
        const double stops =
            at(numbers.minimum, channel) + (at(numbers.maximum, channel) - at(numbers.minimum, channel)) * share;
        const std::size_t texel =
            static_cast<std::size_t>(row) * static_cast<std::size_t>(of_base.width) + static_cast<std::size_t>(column);
        const double encoded =
            colours[texel * static_cast<std::size_t>(of_base.components) + (of_base.components == 1 ? 0 : channel)] /
            255.0;
        light.push_back((srgb_curve(encoded) + at(numbers.base_offset, channel)) * std::exp2(stops) -
                        at(numbers.alternate_offset, channel));
      }
    }
  }
  return light;
}

ReadOptions as_lat_long() { return {.layout = Layout::lat_long}; }

Bytes image(const Shape& shape, std::vector<std::pair<int, std::string>> segments = {}, bool progressive = false) {
  return jpeg_bytes({shape.width, shape.height, shape.components, progressive, std::move(segments)},
                    smooth_samples(shape.width, shape.height, shape.components));
}

Environment read(const Bytes& bytes, const ReadOptions& options = as_lat_long()) {
  return read_environment({std::as_bytes(std::span(bytes)), "sky.jpg"}, options);
}

double largest_difference(const Environment& read, const std::vector<double>& truth) {
  const std::span<const float> texels = values_of(read);
  REQUIRE(texels.size() == truth.size());
  double largest = 0.0;
  for (std::size_t i = 0; i < truth.size(); ++i) {
    largest = std::max(largest, std::abs(texels[i] - truth[i]) / (1.0 + std::abs(truth[i])));
  }
  return largest;
}

const GainNumbers kColoured{
    {-0.5, 0.0, 0.25}, {3.0, 4.0, 2.5}, {1.0, 0.8, 2.2}, {0.0, 1.0 / 64, 0.1}, {1.0 / 32, 0.0, 0.05}};

ThrownError refusal(const Bytes& bytes) {
  return thrown_by([&] { (void)read(bytes); });
}

}  // namespace

TEST_CASE("base image and gain map make the image that their numbers say", "[codec][jpeg]") {
  const Shape base = GENERATE(Shape{1, 1, 3}, Shape{2, 1, 1}, Shape{7, 3, 3}, Shape{64, 32, 1}, Shape{257, 128, 3});
  const Shape map = GENERATE(Shape{1, 1, 1}, Shape{3, 2, 3}, Shape{64, 32, 1}, Shape{300, 5, 3});
  CAPTURE(base.width, map.width);
  const Bytes first = image(base);
  const GainNumbers one;
  for (const GainNumbers& numbers : {one, kColoured}) {
    for (const auto& segment :
         {std::pair{1, gain_xmp(numbers)}, {2, gain_iso(numbers, true)}, {2, gain_iso(numbers, false)}}) {
      const Bytes second = image(map, {segment});
      const Environment environment = read(gain_map_file(first, second));
      // Fractions of 2^20 in ISO's segment, floats in the result.
      CHECK(largest_difference(environment, expected(first, base, second, map, numbers)) < 4e-6);
      CHECK(environment.info.format == FileFormat::jpeg);
    }
  }
}

TEST_CASE("progressive images, padding and a file's path give the same", "[codec][jpeg]") {
  const Shape base{64, 32, 3}, map{16, 8, 1};
  const std::pair segment{1, gain_xmp({})};
  const Environment plain = read(gain_map_file(image(base), image(map, {segment})));
  const auto same = [&](const Environment& other) { return std::ranges::equal(values_of(other), values_of(plain)); };
  CHECK(same(read(gain_map_file(image(base, {}, true), image(map, {segment}, true)))));
  Bytes padded = image(base);
  padded.insert(padded.end(), 1000, '\0');
  CHECK(same(read(gain_map_file(padded, image(map, {segment})))));
  // A preview before the map, and a film behind it that looks like an image.
  Bytes with_more = gain_map_file(gain_map_file(image(base), image({8, 4, 3})), image(map, {segment}));
  for (const int byte : {0xFF, 0xD8, 0xFF, 0xE1, 1, 2, 3}) with_more.push_back(static_cast<char>(byte));
  CHECK(same(read(with_more)));
  const TemporaryDirectory directory;
  write_bytes(directory.file("sky.jpg"), gain_map_file(image(base), image(map, {segment})));
  CHECK(same(read_environment(directory.file("sky.jpg"), as_lat_long())));
  // ISO's numbers go before XMP's.
  GainNumbers other;
  other.maximum = {7.0};
  CHECK(same(read(gain_map_file(image(base), image(map, {{1, gain_xmp(other)}, {2, gain_iso({}, true)}})))));
}

TEST_CASE("a profile's primaries become Rec. 709", "[codec][jpeg]") {
  // Display P3 and sRGB, adapted to D50, as their profiles have them.
  const std::string p3 =
      profile_segment({{{0.5151, 0.2412, -0.0011}, {0.2920, 0.6922, 0.0419}, {0.1571, 0.0666, 0.7841}}});
  const std::string srgb =
      profile_segment({{{0.4361, 0.2225, 0.0139}, {0.3851, 0.7169, 0.0971}, {0.1431, 0.0606, 0.7141}}});
  const Bytes map = jpeg_bytes({1, 1, 1, false, {{1, gain_xmp({{0.0}, {2.0}, {1.0}, {0.0}, {0.0}})}}}, {255});
  const auto colour_of = [&](const std::string& profile, std::array<std::uint8_t, 3> code, Primaries wanted) {
    const Bytes base =
        jpeg_bytes({2, 1, 3, false, {{2, profile}}}, {code[0], code[1], code[2], code[0], code[1], code[2]});
    ReadOptions options = as_lat_long();
    options.primaries = wanted;
    const Environment environment = read(gain_map_file(base, map), options);
    const std::span<const float> texels = values_of(environment);
    return std::array<double, 3>{texels[0], texels[1], texels[2]};
  };
  // White stays white, four times as bright.
  for (const double channel : colour_of(p3, {255, 255, 255}, Primaries::rec709))
    CHECK(channel == Approx(4.0).epsilon(1e-3));
  // P3's red in Rec. 709: 1.2249, -0.0421, -0.0196. (SMPTE EG 432-1's primaries through both matrices.)
  const std::array<double, 3> red = colour_of(p3, {254, 0, 0}, Primaries::rec709);
  CHECK(red[0] / 4.0 == Approx(1.2249 * srgb_curve(254 / 255.0)).epsilon(3e-3));
  CHECK(red[1] / 4.0 == Approx(-0.0421).margin(1e-3));
  CHECK(red[2] / 4.0 == Approx(-0.0196).margin(1e-3));
  CHECK(colour_of(p3, {254, 0, 0}, Primaries::as_stored)[1] == 0.0);
  CHECK(colour_of(srgb, {254, 0, 0}, Primaries::rec709)[1] == 0.0);
}

TEST_CASE("a file of another encoder is read as its own decoder reads it", "[codec][jpeg]") {
  // By @monogrid/gainmap-js, which decoded it to half floats in Chromium. (docs/reference/files.md)
  struct Texel {
    std::size_t row, column;
    std::array<double, 3> light;
  };
  const std::filesystem::path path = std::filesystem::path(WELKIN_TEST_DATA) / "ultra_hdr.jpg";
  const Environment environment = read_environment(path);
  REQUIRE(environment.info.width == 256);
  for (const auto& [row, column, light] :
       {Texel{0, 0, {0.48999, 0.270996, 0.130859}}, Texel{64, 128, {0.451172, 0.34082, 0.202515}},
        Texel{72, 149, {8.75781, 12.6875, 20.0781}}, Texel{31, 200, {3.03906, 2.10352, 1.29785}},
        Texel{127, 255, {0.805176, 0.681641, 0.540039}}}) {
    for (std::size_t channel = 0; channel < 3; ++channel) {
      CHECK(environment.pixels[3 * (256 * row + column) + channel] == Approx(light[channel]).epsilon(1e-3));
    }
  }
}

TEST_CASE("streaming a JPEG gives what reading it whole gives", "[codec][jpeg]") {
  const Bytes file = gain_map_file(image({300, 150, 3}), image({75, 38, 1}, {{2, gain_iso(kColoured, true)}}));
  const Environment whole = read(file);
  const FileInput input(std::as_bytes(std::span(file)), "sky.jpg");
  const Projection streamed = project_file(input, as_lat_long());
  const Projection read_whole = project(whole.view());
  CHECK(std::ranges::equal(streamed.radiance.coefficients(), read_whole.radiance.coefficients()));
}

TEST_CASE("a JPEG that is no image of high dynamic range is refused, with the reason", "[codec][jpeg]") {
  const Shape base{16, 8, 3}, map{4, 2, 1};
  const auto check = [](const ThrownError& error, const std::string& words,
                        ErrorCode code = ErrorCode::unsupported_file) {
    CAPTURE(error.message);
    CHECK(error.code == code);
    CHECK(error.says(words));
  };
  check(refusal(image(base)), "is a JPEG without a gain map: 8 bits hold no light brighter than white");
  check(refusal(gain_map_file(image(base), image(map))), "its second image has no metadata");
  GainNumbers down;
  down.base_is_hdr = true;
  check(refusal(gain_map_file(image(base), image(map, {{1, gain_xmp(down)}}))), "leads down to an ordinary image");
  check(refusal(gain_map_file(image(base), image(map, {{2, gain_iso(down, true)}}))),
        "leads down to an ordinary image");
  const Bytes cmyk = jpeg_bytes({4, 4, 4}, std::vector<std::uint8_t>(64, 100));
  check(refusal(gain_map_file(cmyk, image(map, {{1, gain_xmp({})}}))), "is a JPEG of 4 components of 8 bits");
  std::string later = gain_iso({}, true);
  later[29] = 1;
  check(refusal(gain_map_file(image(base), image(map, {{2, later}}))), "ISO 21496-1 version 1");

  const auto damaged = [&](const GainNumbers& numbers, const std::string& words) {
    for (const auto& segment : {std::pair{1, gain_xmp(numbers)}, {2, gain_iso(numbers, false)}}) {
      check(refusal(gain_map_file(image(base), image(map, {segment}))), words, ErrorCode::corrupt_file);
    }
  };
  damaged({{4.0}}, "its minimum is above its maximum");
  damaged({{0.0}, {100.0}}, "its gains are 0 to 100 stops");
  damaged({{0.0}, {3.0}, {0.0}}, "its gamma is 0");
  damaged({{0.0}, {3.0}, {1.0}, {2.0}}, "an offset is no number from -1 to 1");
  std::string word = gain_xmp({});
  word.replace(word.find("GainMapMax=\"3\"") + 12, 1, "?");
  check(refusal(gain_map_file(image(base), image(map, {{1, word}}))), "GainMapMax is \"?\", no number",
        ErrorCode::corrupt_file);
}

}  // namespace welkin::test
