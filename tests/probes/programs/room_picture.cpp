// Draws the room of tests/probes/room.h as paths and as a grid of probes see it: nine pictures, three in a row.
//   room_picture FILE.png
//
//   paths                    | plain trilinear, no dilation      | plain trilinear, dilated
//   all weights, three bands | all weights, two bands            | difference to paths, four times
//   the light alone, paths    | the light alone, three bands      | the same, windowed (min-laplacian)
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <functional>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <thread>
#include <vector>

#include "probes/room.h"
#include "welkin/environment_file.h"
#include "welkin/probes.h"

namespace welkin::test {
namespace {

constexpr int kWidth = 380;
constexpr int kHeight = 192;
constexpr int kGap = 6;
constexpr double kSpan = 3.94;  // metres of the front, from left to right
constexpr int kPaths = 400;
constexpr double kExposure = 1.5;
constexpr double kPi = 3.14159265358979323846;

struct Pixel {
  Room::Hit hit;
  std::uint32_t seed;
};

using Picture = std::vector<dvec3>;

/// What the camera sees, which stands before the front wall and looks through it.
std::vector<Pixel> pixels_of(const Room& room) {
  std::vector<Pixel> pixels;
  const dvec3 eye{0.25, 1.05, 5.2};
  for (int row = 0; row < kHeight; ++row) {
    for (int column = 0; column < kWidth; ++column) {
      const double x = ((column + 0.5) / kWidth - 0.5) * kSpan;
      const double y = (0.5 - (row + 0.5) / kHeight) * kSpan * kHeight / kWidth;
      const dvec3 through{x, 1.0 + y, 0.9999};
      const dvec3 way = glm::normalize(through - eye);
      pixels.push_back({room.trace(through, way), static_cast<std::uint32_t>(pixels.size()) * 2654435761U});
    }
  }
  return pixels;
}

/// Light on what the pixels show, times its colour.
Picture draw(const std::vector<Pixel>& pixels, const std::function<dvec3(const Pixel&)>& irradiance) {
  Picture picture(pixels.size());
  const auto half = [&](std::size_t first) {
    for (std::size_t k = first; k < pixels.size(); k += 2) {
      const Pixel& pixel = pixels[k];
      picture[k] = pixel.hit.is_light ? dvec3(1.0)
                   : pixel.hit.is_back || !std::isfinite(pixel.hit.distance)
                       ? dvec3(0.0)
                       : pixel.hit.albedo * irradiance(pixel) / kPi;
    }
  };
  std::thread other(half, 1);
  half(0);
  other.join();
  return picture;
}

Picture of_paths(const Room& room, const std::vector<Pixel>& pixels, Followed followed) {
  return draw(pixels, [&](const Pixel& pixel) {
    return room.irradiance(pixel.hit.place, pixel.hit.normal, kPaths, pixel.seed, followed);
  });
}

Picture of_probes(const BakedProbes& probes, const std::vector<Pixel>& pixels, const ProbeSampling& sampling) {
  return draw(pixels, [&](const Pixel& pixel) {
    return probe_irradiance(probes, pixel.hit.place, pixel.hit.normal, sampling);
  });
}

double error_of(const Picture& found, const Picture& wanted) {
  double square = 0.0;
  double whole = 0.0;
  for (std::size_t k = 0; k < found.size(); ++k) {
    square += glm::dot(found[k] - wanted[k], found[k] - wanted[k]);
    whole += glm::dot(wanted[k], wanted[k]);
  }
  return std::sqrt(square / whole);
}

/// The picture's place in the sheet.
void put(std::vector<float>& sheet, int sheet_width, const Picture& picture, int column, int row, double exposure) {
  for (int y = 0; y < kHeight; ++y) {
    for (int x = 0; x < kWidth; ++x) {
      const dvec3 rgb = exposure * picture[static_cast<std::size_t>(y) * kWidth + static_cast<std::size_t>(x)];
      const auto place = (static_cast<std::size_t>(row * (kHeight + kGap) + y) * static_cast<std::size_t>(sheet_width) +
                          static_cast<std::size_t>(column * (kWidth + kGap) + x));
      for (int c = 0; c < 3; ++c) {
        // A shoulder, so that what is bright keeps its colour.
        sheet[3 * place + static_cast<std::size_t>(c)] = static_cast<float>(rgb[c] / (1.0 + 0.4 * rgb[c]));
      }
    }
  }
}

void draw_all(const char* path) {
  const Room room;
  const ProbeGrid grid = Room::grid();
  const std::vector<Pixel> pixels = pixels_of(room);
  const Captures captures = room.capture(grid, 32, 32, Followed::reflected);
  const Captures lit = room.capture(grid, 32, 1, Followed::sent);
  const BakedProbes raw = bake_probes(grid, captures.cubes, captures.depths, {.dilation_passes = 0});
  const BakedProbes three = bake_probes(grid, captures.cubes, captures.depths);
  const BakedProbes two = bake_probes(grid, captures.cubes, captures.depths, {.projection = {.bands = 2}});
  const BakedProbes ringing = bake_probes(grid, lit.cubes, lit.depths);
  const ProbeSampling plain{.visibility = false, .facing = false, .validity = false, .normal_bias = 0.0};

  const Picture paths = of_paths(room, pixels, Followed::reflected);
  const Picture all = of_probes(three, pixels, {});
  Picture difference;
  for (std::size_t k = 0; k < all.size(); ++k) difference.push_back(4.0 * glm::abs(all[k] - paths[k]));
  const Picture lit_paths = of_paths(room, pixels, Followed::sent);
  const std::vector<Picture> pictures{
      paths,     of_probes(raw, pixels, plain),  of_probes(three, pixels, plain),
      all,       of_probes(two, pixels, {}),     difference,
      lit_paths, of_probes(ringing, pixels, {}), of_probes(windowed(ringing, Window::min_laplacian), pixels, {})};
  const int width = 3 * kWidth + 2 * kGap;
  const int height = 3 * kHeight + 2 * kGap;
  std::vector<float> sheet(3 * static_cast<std::size_t>(width) * static_cast<std::size_t>(height), 1.0F);
  for (std::size_t k = 0; k < pictures.size(); ++k) {
    const auto place = static_cast<int>(k);
    put(sheet, width, pictures[k], place % 3, place / 3, place < 6 ? kExposure : 0.6 * kExposure);
    if (place != 5)
      std::printf("%d: relative error %.3f\n", place + 1, error_of(pictures[k], place < 6 ? paths : lit_paths));
  }
  write_environment(path, LatLongView{sheet.data(), width, height, 0, PixelFormat::rgb32f});
}

}  // namespace
}  // namespace welkin::test

int main(int count, char** words) {
  if (count != 2) {
    std::fputs("usage: room_picture FILE.png\n", stderr);
    return 2;
  }
  welkin::test::draw_all(words[1]);
  return 0;
}
