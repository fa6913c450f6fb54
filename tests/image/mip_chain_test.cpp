// Promise: a mip keeps the light of the level above it, at odd sizes too, and a uniform one stays exactly what it is.
#include "welkin/mip_chain.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <vector>

#include "image/texel_geometry.h"
#include "support/catch.h"
#include "support/heap.h"
#include "support/same_bits.h"
#include "support/test_environments.h"
#include "support/thrown_error.h"
#include "tables/gauss_legendre.h"
#include "tables/solid_angle.h"
#include "welkin/instruction_set.h"

namespace welkin::test {
namespace {

std::span<const float> face_values(const CubemapChain& chain, int level, int face) {
  const auto edge = static_cast<std::size_t>(chain.level_size(level));
  return {chain.face(level, face), 3 * edge * edge};
}

bool same_chain(const CubemapChain& a, const CubemapChain& b) {
  if (a.size() != b.size() || a.levels() != b.levels()) return false;
  return same_bytes<float>({a.face(0, 0), a.bytes() / sizeof(float)}, {b.face(0, 0), b.bytes() / sizeof(float)});
}

/// Int radiance over the sphere, texels as areas, or over a plain mean's equal ones.
double flux(const CubemapChain& chain, int level, MipFilter filter) {
  const int size = chain.level_size(level);
  std::vector<double> angles(static_cast<std::size_t>(size), 1.0 / (size * size));
  double sum = 0.0;
  for (int row = 0; row < size; ++row) {
    if (filter == MipFilter::solid_angle) image::cubemap_row_solid_angles(row, angles);
    for (int face = 0; face < 6; ++face) {
      for (int column = 0; column < size; ++column) {
        sum += angles[static_cast<std::size_t>(column)] *
               static_cast<double>(chain.face(level, face)[3 * (row * size + column) + 1]);
      }
    }
  }
  return sum;
}

/// A texel below by its definition: the mean of all texels over the area that it shares with each, in double.
double value_below(const CubemapChain& chain, int level, int face, int column, int row, int channel, MipFilter filter) {
  const int above = chain.level_size(level - 1);
  const int size = chain.level_size(level);
  double sum = 0.0;
  double weights = 0.0;
  for (int j = 0; j < above; ++j) {
    for (int i = 0; i < above; ++i) {
      const double left = std::max(1.0 * i / above, 1.0 * column / size);
      const double right = std::min((i + 1.0) / above, (column + 1.0) / size);
      const double top = std::max(1.0 * j / above, 1.0 * row / size);
      const double bottom = std::min((j + 1.0) / above, (row + 1.0) / size);
      if (left >= right || top >= bottom) continue;
      double weight = (right - left) * (bottom - top);
      if (filter == MipFilter::solid_angle) {
        weight = tables::rectangle_solid_angle(left + right - 1.0, top + bottom - 1.0, right - left, bottom - top,
                                               tables::gauss_legendre(20));
      }
      sum += weight * static_cast<double>(chain.face(level - 1, face)[3 * (j * above + i) + channel]);
      weights += weight;
    }
  }
  return sum / weights;
}

constexpr MipFilter kFilters[] = {MipFilter::box, MipFilter::solid_angle};

}  // namespace

TEST_CASE("Each mip is the mean of the one above over each texel's area", "[mips]") {
  for (const MipFilter filter : kFilters) {
    for (const int size : {1, 2, 3, 5, 7, 12, 26, 27, 52}) {
      const TestCubemap map = make_cubemap(Content::random, size, 4, 3);
      const CubemapChain chain = build_mips(map.view(), filter);
      REQUIRE(chain.levels() == full_chain_levels(size));
      for (int level = 1; level < chain.levels(); ++level) {
        const int edge = chain.level_size(level);
        double worst = 0.0;
        for (int texel = 0; texel < 6 * edge * edge; ++texel) {
          const int face = texel / (edge * edge);
          const int row = texel / edge % edge;
          const int column = texel % edge;
          const int channel = texel % 3;
          const float found = chain.face(level, face)[3 * (row * edge + column) + channel];
          worst = std::max(worst, std::abs(static_cast<double>(found) -
                                           value_below(chain, level, face, column, row, channel, filter)));
        }
        CAPTURE(size, level, static_cast<int>(filter));
        CHECK(worst < 2e-7);
      }
    }
  }
}

TEST_CASE("Every level has the flux of the first", "[mips]") {
  for (const MipFilter filter : kFilters) {
    for (const int size : {1, 2, 3, 7, 64, 257}) {
      const TestCubemap map = make_cubemap(Content::one_texel_sun, size, 3, 8);
      const CubemapChain chain = build_mips(map.view(), filter);
      const double wanted = flux(chain, 0, filter);
      for (int level = 1; level < chain.levels(); ++level) {
        CAPTURE(size, level, static_cast<int>(filter));
        CHECK(flux(chain, level, filter) == Approx(wanted).epsilon(4e-7));
      }
    }
  }
}

TEST_CASE("A uniform cubemap's mips are exactly uniform", "[mips]") {
  for (const MipFilter filter : kFilters) {
    for (const int size : {1, 2, 3, 6, 7, 64, 257, 600}) {
      const CubemapImage map{size, std::vector<float>(static_cast<std::size_t>(18 * size * size), 1.0F)};
      const CubemapChain chain = build_mips(map.view(), filter);
      for (int level = 0; level < chain.levels(); ++level) {
        for (int face = 0; face < 6; ++face) {
          for (const float value : face_values(chain, level, face)) REQUIRE(value == 1.0F);
        }
      }
    }
  }
}

TEST_CASE("Level 0 is the source, decoded, whichever its format", "[mips]") {
  const TestCubemapHalf half = make_cubemap_half(Content::random, 5, 4, 3);
  const CubemapChain chain = build_mips(half.view(), MipFilter::box, 1);
  REQUIRE(chain.levels() == 1);
  for (int face = 0; face < 6; ++face) {
    for (std::size_t texel = 0; texel < 25; ++texel) {
      for (std::size_t c = 0; c < 3; ++c) {
        REQUIRE(chain.face(0, face)[3 * texel + c] ==
                static_cast<float>(half.pixels[(static_cast<std::size_t>(face) * 25 + texel) * 4 + c]));
      }
    }
  }
}

TEST_CASE("Mips have the same bits everywhere, and their tiles allocate nothing", "[mips]") {
  const InstructionSet before = active_instruction_set();
  for (const MipFilter filter : kFilters) {
    for (const int size : {96, 257, 300}) {
      const TestCubemap map = make_cubemap(Content::high_range, size, 3, 4);
      CubemapChain expected;
      force_instruction_set(InstructionSet::sse2);
      run_with_threads(1, [&] { expected = build_mips(map.view(), filter); });
      for (const InstructionSet set : available_instruction_sets()) {
        force_instruction_set(set);
        for (const int threads : {1, 2, 7}) {
          CAPTURE(name(set), threads, size);
          forget_allocations_in_tiles();
          run_with_threads(threads, [&] { CHECK(same_chain(build_mips(map.view(), filter), expected)); });
          CHECK(allocations_in_tiles() == 0);
        }
      }
    }
  }
  force_instruction_set(before);
}

TEST_CASE("Mips are refused, stopped and reported upon", "[mips]") {
  const TestCubemap map = make_cubemap(Content::random, 8, 3, 4);
  CHECK(thrown_by([&] { return build_mips(map.view(), MipFilter::box, 5); }).says("8 texels has 1 to 4"));
  CHECK(thrown_by([&] { return build_mips(map.view(), MipFilter::box, -1); }).code == ErrorCode::invalid_argument);
  CHECK(thrown_by([&] { return build_mips(CubemapView{}); }).code == ErrorCode::invalid_argument);
  CHECK(thrown_by([] {
          CubemapChain none;
          fill_mips(none, MipFilter::box);
          return 0;
        }).says("no levels"));
  std::stop_source stop;
  stop.request_stop();
  CHECK(thrown_by([&] {
          return build_mips(map.view(), MipFilter::box, 0, {stop.get_token(), {}});
        }).code == ErrorCode::cancelled);
  for (const int levels : {1, 4}) {
    std::vector<double> shares;
    (void)build_mips(map.view(), MipFilter::box, levels, {{}, [&](double share) { shares.push_back(share); }});
    CHECK(std::is_sorted(shares.begin(), shares.end()));
    CHECK(shares.back() == 1.0);
  }
}

}  // namespace welkin::test
