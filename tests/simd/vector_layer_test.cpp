// The vector layer, function by function: every instruction set gives the bits of a plain loop, also where processors
// by themselves would not agree. NaNs are NaNs: their signs and payloads differ between processors, and no result shows
// them.
#include "image/pixels.h"
#include "platform/memory.h"
#include "simd/vector_kernels.h"
#include "support/catch.h"
#include "welkin/core.h"

namespace welkin::test {
namespace {

using simd::kLanes;

/// Zeros of both signs, denormals, the ends of the range, infinities, a NaN, and ordinary numbers.
template <class Number>
std::vector<Number> awkward_numbers() {
  using Limits = std::numeric_limits<Number>;
  std::vector<Number> numbers{0,
                              1,
                              2,
                              3,
                              7,
                              0.1F,
                              Limits::min(),
                              Limits::denorm_min(),
                              Limits::min() / 3,
                              Limits::max(),
                              Limits::infinity(),
                              Limits::quiet_NaN(),
                              Limits::epsilon(),
                              2147483648.0F,
                              1e10F,
                              0.5F};
  std::mt19937 generator(5);
  for (int k = 0; k < 48; ++k) {
    numbers.push_back(std::ldexp(static_cast<Number>(generator()), static_cast<int>(generator() % 90U) - 60));
  }
  const std::size_t count = numbers.size();
  for (std::size_t k = 0; k < count; ++k) numbers.push_back(-numbers[k]);
  return numbers;
}

template <class Number>
bool same(Number a, Number b) {
  using Bits = std::conditional_t<sizeof(Number) == 4, std::uint32_t, std::uint64_t>;
  return (std::isnan(a) && std::isnan(b)) || std::bit_cast<Bits>(a) == std::bit_cast<Bits>(b);
}

/// All pairs of awkward numbers, 16 at a time.
template <class Number, class Kernel, class Twin>
void require_as_twin(Kernel kernel, const Twin& twin) {
  const std::vector<Number> numbers = awkward_numbers<Number>();
  for (const Number second : numbers) {
    for (std::size_t first = 0; first < numbers.size(); first += kLanes) {
      std::array<Number, kLanes> a{};
      std::array<Number, kLanes> b{};
      std::array<Number, kLanes> found{};
      for (std::size_t k = 0; k < kLanes; ++k) a[k] = numbers[(first + k) % numbers.size()];
      b.fill(second);
      kernel(a.data(), b.data(), found.data());
      for (std::size_t k = 0; k < kLanes; ++k) {
        const Number expected = twin(a[k], b[k]);
        if (same(found[k], expected)) continue;
        CAPTURE(a[k], b[k], found[k], expected);
        FAIL("other bits than the plain loop's");
      }
    }
  }
}

// The second one where there is nothing to choose between: NaNs, and zeros of both signs.
template <class Number>
Number least(Number a, Number b) {
  return a < b ? a : b;
}
template <class Number>
Number largest(Number a, Number b) {
  return a > b ? a : b;
}

float whole(float a, float /*b*/) {
  if (!(std::abs(a) < 2147483648.0F)) return -2147483648.0F;
  return static_cast<float>(static_cast<std::int32_t>(a));
}

}  // namespace

TEST_CASE("Vector operations on floats round and choose as a plain loop does", "[simd]") {
  for (const InstructionSet set : available_instruction_sets()) {
    CAPTURE(name(set));
    const VectorKernels& kernels = vector_kernels(set);
    require_as_twin<float>(kernels.sum, [](float a, float b) { return a + b; });
    require_as_twin<float>(kernels.difference, [](float a, float b) { return a - b; });
    require_as_twin<float>(kernels.product, [](float a, float b) { return a * b; });
    require_as_twin<float>(kernels.quotient, [](float a, float b) { return a / b; });
    require_as_twin<float>(kernels.root, [](float a, float) { return std::sqrt(a); });
    require_as_twin<float>(kernels.least, least<float>);
    require_as_twin<float>(kernels.largest, largest<float>);
    require_as_twin<float>(kernels.select_less, least<float>);
    require_as_twin<float>(kernels.magnitude, [](float a, float) { return std::abs(a); });
    require_as_twin<float>(kernels.whole, whole);
  }
}

TEST_CASE("Vector operations on doubles round and choose as a plain loop does", "[simd]") {
  for (const InstructionSet set : available_instruction_sets()) {
    CAPTURE(name(set));
    const VectorKernels& kernels = vector_kernels(set);
    require_as_twin<double>(kernels.double_quotient, [](double a, double b) { return a / b; });
    require_as_twin<double>(kernels.double_root, [](double a, double) { return std::sqrt(a); });
    require_as_twin<double>(kernels.double_least, least<double>);
    require_as_twin<double>(kernels.double_largest, largest<double>);
  }
}

TEST_CASE("Doubles become floats by one rounding, and floats doubles by none", "[simd]") {
  std::vector<double> numbers = awkward_numbers<double>();
  for (const float number : awkward_numbers<float>()) {
    const auto exact = static_cast<double>(number);
    numbers.insert(numbers.end(), {exact, exact * (1.0 + 0x1p-24), exact * (1.0 + 0x1p-24 + 0x1p-40)});
  }
  numbers.resize(numbers.size() / kLanes * kLanes);
  for (const InstructionSet set : available_instruction_sets()) {
    CAPTURE(name(set));
    for (std::size_t first = 0; first < numbers.size(); first += kLanes) {
      platform::AlignedBuffer<float> narrowed(kLanes);
      std::array<double, kLanes> widened{};
      vector_kernels(set).narrowed(numbers.data() + first, narrowed.data());
      vector_kernels(set).widened(narrowed.data(), widened.data());
      for (std::size_t k = 0; k < kLanes; ++k) {
        CAPTURE(numbers[first + k]);
        REQUIRE(same(narrowed.data()[k], static_cast<float>(numbers[first + k])));
        REQUIRE(same(widened[k], static_cast<double>(narrowed.data()[k])));
      }
    }
  }
}

TEST_CASE("Vector comparisons hold for no NaN", "[simd]") {
  const std::vector<float> numbers = awkward_numbers<float>();
  for (const InstructionSet set : available_instruction_sets()) {
    CAPTURE(name(set));
    for (const float second : numbers) {
      std::array<float, kLanes> a{};
      std::array<float, kLanes> b{};
      std::copy_n(numbers.begin(), kLanes, a.begin());
      b.fill(second);
      int expected[5] = {};
      for (const float first : a) {
        const bool held[5] = {first<second, first <= second, first> second, first >= second, first == second};
        for (int i = 0; i < 5; ++i) expected[i] += held[i] ? 1 : 0;
      }
      int found[5] = {};
      vector_kernels(set).comparisons(a.data(), b.data(), found);
      CAPTURE(second);
      REQUIRE(std::equal(found, found + 5, expected));
    }
    const std::array<float, kLanes> ones = [] {
      std::array<float, kLanes> values{};
      values.fill(1.0F);
      return values;
    }();
    for (std::size_t k = 0; k < 4; ++k) {  // four lanes: as many as the narrowest register has
      std::array<float, kLanes> other = ones;
      CHECK_FALSE(vector_kernels(set).any_less(ones.data(), other.data()));
      other[k] = 2.0F;
      CHECK(vector_kernels(set).any_less(ones.data(), other.data()));
      other.fill(2.0F);
      CHECK(vector_kernels(set).all_less(ones.data(), other.data()));
      other[k] = 1.0F;
      CHECK_FALSE(vector_kernels(set).all_less(ones.data(), other.data()));
    }
  }
}

namespace {

template <class Channel, class Load>
void require_channels(Load load, int channels, const std::vector<Channel>& texels, float (*value)(Channel)) {
  for (const bool reversed : {false, true}) {
    std::array<float, std::size_t{3} * kLanes> rgb{};
    load(texels.data(), reversed, rgb.data());
    for (int k = 0; k < kLanes; ++k) {
      for (int c = 0; c < 3; ++c) {
        const int texel = reversed ? kLanes - 1 - k : k;
        if (same(rgb[static_cast<std::size_t>(c * kLanes + k)],
                 value(texels[static_cast<std::size_t>(texel * channels + c)]))) {
          continue;
        }
        CAPTURE(reversed, k, c);
        FAIL("another value than the texel's");
      }
    }
  }
}

std::vector<float> counted(std::size_t count) {
  std::vector<float> values(count);
  for (std::size_t k = 0; k < count; ++k) values[k] = static_cast<float>(k) + 0.5F;
  return values;
}

}  // namespace

TEST_CASE("Texels come apart into channels, in either order", "[simd]") {
  for (const InstructionSet set : available_instruction_sets()) {
    CAPTURE(name(set));
    const VectorKernels& kernels = vector_kernels(set);
    float (*const itself)(float) = [](float value) { return value; };
    require_channels<float>(kernels.load_rgb, 3, counted(std::size_t{3} * kLanes), itself);
    require_channels<float>(kernels.load_rgba, 4, counted(std::size_t{4} * kLanes), itself);
    // Every half there is: denormals, infinities and NaNs too.
    for (std::uint32_t first = 0; first < 0x10000U; first += 64) {
      std::vector<std::uint16_t> halves;
      for (std::uint32_t k = 0; k < 64; ++k) halves.push_back(static_cast<std::uint16_t>(first + k));
      require_channels<std::uint16_t>(kernels.load_half_rgba, 4, halves, image::float_from_half);
    }
  }
}

TEST_CASE("Lanes go to the places that the vector layer names", "[simd]") {
  const std::vector<float> numbers = counted(std::size_t{16} * kLanes);
  for (const InstructionSet set : available_instruction_sets()) {
    CAPTURE(name(set));
    const VectorKernels& kernels = vector_kernels(set);
    platform::AlignedBuffer<float> from(numbers.size());
    platform::AlignedBuffer<float> to(numbers.size());
    std::copy(numbers.begin(), numbers.end(), from.data());

    kernels.store_thrice(from.data(), to.data());
    for (int k = 0; k < 3 * kLanes; ++k) REQUIRE(to.data()[k] == from.data()[k / 3]);

    kernels.reverse_rgb(from.data(), to.data());
    for (int k = 0; k < 3 * kLanes; ++k) REQUIRE(to.data()[k] == from.data()[3 * (kLanes - 1 - k / 3) + k % 3]);

    kernels.load_rgb_texels(from.data(), to.data());
    for (int k = 0; k < kLanes; ++k) REQUIRE(to.data()[k] == (k % 4 == 3 ? 0.0F : from.data()[k / 4 * 3 + k % 4]));

    const float weights[4] = {2.0F, 3.0F, 5.0F, 7.0F};
    for (const bool reversed : {false, true}) {
      kernels.weighted_columns(from.data(), weights, reversed, to.data());
      for (int k = 0; k < kLanes; ++k) {
        REQUIRE(to.data()[k] == from.data()[k] * weights[reversed ? 3 - k / 4 : k / 4]);
      }
    }

    kernels.folded(from.data(), to.data());
    for (int c = 0; c < 4; ++c) {
      const float* const q = from.data() + c;
      REQUIRE(to.data()[c] == (q[0] + q[8]) + (q[4] + q[12]));
    }

    int size = 0;
    kernels.transposed(from.data(), to.data(), &size);
    for (int i = 0; i < size; ++i) {
      for (int j = 0; j < size; ++j) REQUIRE(to.data()[i * kLanes + j] == from.data()[j * kLanes + i]);
    }

    std::mt19937 generator(9);
    for (std::size_t k = 0; k < from.size(); ++k) from.data()[k] = static_cast<float>(generator()) * 0x1p-32F - 0.5F;
    kernels.sum_rows(from.data(), to.data());
    for (int row = 0; row < kLanes; ++row) {
      std::array<float, kLanes> lanes{};
      std::copy_n(from.data() + row * kLanes, kLanes, lanes.begin());
      for (std::size_t half = kLanes / 2; half > 0; half /= 2) {
        for (std::size_t k = 0; k < half; ++k) lanes[k] += lanes[k + half];
      }
      REQUIRE(same(to.data()[row], lanes[0]));
    }

    std::fill_n(from.data(), kLanes, 0.0F);
    CHECK(kernels.no_bit_set(from.data()));
    for (int k = 0; k < kLanes; ++k) {
      for (const float bit : {-0.0F, std::numeric_limits<float>::denorm_min()}) {
        from.data()[k] = bit;
        CHECK_FALSE(kernels.no_bit_set(from.data()));
        from.data()[k] = 0.0F;
      }
    }
  }
}

}  // namespace welkin::test
