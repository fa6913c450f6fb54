// A cubemap's light on rings of latitude: the same harmonics, whatever the sizes.
#include "image/pixels.h"
#include "reflections/cube_rings.h"
#include "reflections/ring_kernels.h"
#include "reflections/ring_weights.h"
#include "support/catch.h"
#include "support/heap.h"
#include "support/sun_maps.h"
#include "support/test_environments.h"
#include "support/trials.h"
#include "welkin/core.h"
#include "welkin/projection.h"
#include "welkin/spherical_harmonics.h"

namespace welkin::test {
namespace {

using reflections::kRecordFloats, reflections::kRingImages, reflections::RingTable, reflections::RingTap;

std::vector<const float*> rows_of(const CubemapView& cube) {
  std::vector<const float*> rows;
  for (int row = 0; row < 6 * cube.size; ++row)
    rows.push_back(static_cast<const float*>(image::row_of(cube, row / cube.size, row % cube.size)));
  return rows;
}

LatLongImage rings_of(const CubemapView& cube, int rows) {
  LatLongImage rings{2 * rows, rows, std::vector<float>(std::size_t{6} * static_cast<std::size_t>(rows * rows))};
  RingTable({cube.size, rows}).fill(rows_of(cube), rings.pixels.data(), {});
  return rings;
}

double largest_difference(const SphericalHarmonics& a, const SphericalHarmonics& b) {
  double largest = 0.0;
  for (int l = 0; l < a.bands(); ++l) {
    for (int m = -l; m <= l; ++m) {
      for (int c = 0; c < 3; ++c) largest = std::max(largest, std::abs(a.at(l, m)[c] - b.at(l, m)[c]));
    }
  }
  return largest;
}

}  // namespace

TEST_CASE("Sums of a ring's taps are the same on all instruction sets", "[prefilter][rings][kernels]") {
  constexpr int kRecords = 7;
  constexpr int kTexels = 5;
  alignas(64) std::array<float, std::size_t{kRecords} * kRecordFloats> records{};
  for (std::size_t k = 0; k < records.size(); ++k) records[k] = static_cast<float>(k * 37 % 101) / 101.0F;
  std::vector<RingTap> taps;
  std::vector<std::uint32_t> ends{0};
  for (std::uint32_t texel = 0; texel < kTexels; ++texel) {
    for (std::uint32_t k = 0; k < texel; ++k)
      taps.push_back({(3 * k + texel) % kRecords, 0.3F - 0.07F * static_cast<float>(k)});
    ends.push_back(static_cast<std::uint32_t>(taps.size()));
  }
  for (const InstructionSet set : available_instruction_sets()) {
    std::array<float, std::size_t{kTexels} * kRecordFloats> out{};
    reflections::RingLayout layout{};
    for (int k = 0; k < kRingImages; ++k) {
      const bool back = k % 2 == 1;
      layout.to[k] = out.data() + 3 * kTexels * k + (back ? 3 * (kTexels - 1) : 0);
      layout.step[k] = back ? -3 : 3;
    }
    reflections::ring_kernels(set).sum_ring_taps({records.data(), taps.data(), ends.data(), kTexels}, layout);
    for (int image = 0; image < kRingImages; ++image) {
      for (int texel = 0; texel < kTexels; ++texel) {
        for (int c = 0; c < 3; ++c) {
          double exact = 0.0;
          float sum = 0.0F;
          for (std::uint32_t k = ends[static_cast<std::size_t>(texel)]; k < ends[static_cast<std::size_t>(texel) + 1];
               ++k) {
            const float value =
                records[std::size_t{taps[k].record} * kRecordFloats + static_cast<std::size_t>(3 * image + c)];
            exact += static_cast<double>(taps[k].weight) * static_cast<double>(value);
            const float product = taps[k].weight * value;
            sum += product;
          }
          const int position = image % 2 == 1 ? kTexels - 1 - texel : texel;
          const float found = out[static_cast<std::size_t>(3 * (kTexels * image + position) + c)];
          REQUIRE(found == sum);
          REQUIRE(std::abs(static_cast<double>(found) - exact) < 3e-7);
        }
      }
    }
  }
}

TEST_CASE("Rings of latitude have a cubemap's harmonics", "[prefilter][rings]") {
  for (const int size : {1, 2, 3, 6, 9, 40}) {
    for (const int rows : {64, 180}) {
      CAPTURE(size, rows);
      const TestCubemap cube = make_cubemap(Content::random, size, 3, 7);
      const LatLongImage rings = rings_of(cube.view(), rows);
      const auto harmonics = [](const auto& view) { return project(view, {.bands = 9}).radiance; };
      // degree 8: (l h)^4 is 0.024 on 64 rings, 4e-4 on 180
      CHECK(largest_difference(harmonics(rings.view()), harmonics(cube.view())) < (rows == 64 ? 2e-4 : 2e-6));
    }
  }
}

TEST_CASE("Even light stays even on rings", "[prefilter][rings]") {
  for (const int size : {1, 2, 7, 16, 40}) {
    for (const int rows : {64, 100}) {
      CAPTURE(size, rows);
      const Cubemap cube = grey_cubemap(size, 1.0F);
      const LatLongImage rings = rings_of(cube.view(), rows);
      float worst = 0.0F;
      for (std::size_t k = 0; k < rings.pixels.size(); k += 3)
        worst = std::max(worst, std::abs(rings.pixels[k] - 1.0F));
      CHECK(worst < 4e-6F);
    }
  }
}

TEST_CASE("Weights of rings are the same on all instruction sets", "[prefilter][rings][kernels]") {
  for (const auto& [size, rows] : {std::pair{6, 100}, {9, 32}, {40, 64}}) {
    CAPTURE(size, rows);
    std::vector<float> first;
    for (const InstructionSet set : available_instruction_sets()) {
      const reflections::RingWeights weights(size, rows, reflections::ring_kernels(set));
      std::vector<float> found;
      for (int band = 0; band < weights.bands(); ++band) {
        const int rings = weights.first_ring(band + 1) - weights.first_ring(band);
        std::vector<std::uint32_t> next(static_cast<std::size_t>(rings) * static_cast<std::size_t>(rows / 4));
        weights.count(band, next.data());
        std::uint32_t sum = 0;
        for (std::uint32_t& count : next) sum += std::exchange(count, sum);
        std::vector<RingTap> taps(sum);
        weights.weigh(band, next.data(), taps.data());
        CHECK(next.back() == sum);
        for (const RingTap& tap : taps) {
          CHECK(tap.record < weights.record_count());
          found.push_back(tap.weight);
        }
      }
      if (first.empty()) first = found;
      CHECK(found == first);
    }
  }
}

TEST_CASE("Tables of rings are kept, and made by any number of threads alike", "[prefilter][rings]") {
  const auto table = RingTable::get({16, 256});
  CHECK(table == RingTable::get({16, 256}));
  CHECK(table->bytes() > 1000);
  const TestCubemap cube = make_cubemap(Content::random, 16, 3, 7);
  const LatLongImage rings = rings_of(cube.view(), 256);
  std::vector<float> others(rings.pixels.size());
  run_with_threads(1, [&] { RingTable({16, 256}).fill(rows_of(cube.view()), others.data(), {}); });
  CHECK(others == rings.pixels);
  // too large to be kept: built band by band
  const RingTable unkept({16, 256}, {}, 0);
  unkept.fill(rows_of(cube.view()), others.data(), {});
  CHECK(others == rings.pixels);
  CHECK(unkept.bytes() < table->bytes());
}

TEST_CASE("Making a table of rings takes no more memory than it says", "[prefilter][rings]") {
  if (kSanitized) return;
  for (const reflections::RingTableKey key : {reflections::RingTableKey{2, 256}, {16, 64}, {64, 540}, {256, 540}}) {
    INFO("faces of " << key.face_size << ", " << key.rows << " rings");
    const HeapWatch heap;
    const RingTable table(key);
    const auto said = static_cast<long>(RingTable::making_bytes(key));
    CHECK(static_cast<long>(table.bytes()) <= heap.peak_bytes());
    CHECK(heap.peak_bytes() <= said);
    CHECK(said <= 4 * heap.peak_bytes());
  }
}

}  // namespace welkin::test
