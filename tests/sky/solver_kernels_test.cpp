// Promise: the kernels that carry scattered light along rays are their twins in double, on every instruction set.
#include "sky/sky_kernels.h"
#include "support/catch.h"
#include "welkin/core.h"

namespace welkin::test {
namespace {

template <class Check>
void on_every_instruction_set(const Check& check) {
  const InstructionSet before = active_instruction_set();
  for (const InstructionSet set : available_instruction_sets()) {
    force_instruction_set(set);
    CAPTURE(name(set));
    check(sky::solver_kernels());
  }
  force_instruction_set(before);
}

constexpr int kAngles = 5;
constexpr int kNodes = 16;
constexpr int kCount = 48;
constexpr int kSteps = (kNodes - 1) * sky::kSunSteps + 1;
constexpr sky::SunAxis kAxis{.reach = 0.019F,
                             .shortest = 0.0094F,
                             .scale = 7.8F,
                             .inverse_lowest = 0.12F,
                             .bend = 0.25F,
                             .path = 0.8F,
                             .level = 0.13F,
                             .lowest = -0.5F,
                             .zenith = 0.13F,
                             .nodes = kNodes};

std::vector<float> numbers(std::mt19937& generator, std::size_t count, double low, double high) {
  std::vector<float> values(count);
  for (float& value : values) value = static_cast<float>(std::uniform_real_distribution<double>(low, high)(generator));
  return values;
}

/// Two heights, four images and the suns of a ray, at random.
struct Scene {
  std::mt19937 generator{11};
  std::vector<float> molecules[2], images[4], steps[2];
  std::vector<float> sun, nu, fraction;
  std::vector<std::int32_t> row;
  sky::SourceSample sample{};

  Scene() {
    for (int k = 0; k < 2; ++k) {
      molecules[k] = numbers(generator, sky::kMoleculeTerms * 4 * kNodes, -0.2, 1.0);
      steps[k] = numbers(generator, kSteps + 15, 0.5, 2.0);
      sample.molecules[k] = molecules[k].data();
      sample.steps[k] = steps[k].data();
      sample.step_weights[k] = k == 0 ? 0.3F : 0.7F;
      for (int c = 0; c < 3; ++c) sample.molecule_weights[k][c] = 0.1F * static_cast<float>(1 + k + c);
    }
    for (int k = 0; k < 4; ++k) {
      images[k] = numbers(generator, 4 * kAngles * kNodes, 0.0, 1.0);
      sample.images[k] = images[k].data();
      for (int c = 0; c < 3; ++c) sample.weights[k][c] = 0.05F * static_cast<float>(1 + k + c);
    }
    sample.count = 4;
    sample.start_ratio = 0.98F;
    sample.distance_ratio = 0.04F;
    sample.view_cosine = 0.35F;
    sun = numbers(generator, kCount, -0.6, 1.0);
    nu = numbers(generator, kCount, -1.0, 1.0);
    fraction = numbers(generator, kCount, 0.0, 1.0);
    for (int i = 0; i < kCount; ++i) row.push_back(kNodes * (i % (kAngles - 1)));
  }

  /// Returns the light that molecules scatter at a node of suns, in a channel, before the weight by brightness.
  [[nodiscard]] double molecules_at(int node, std::size_t c, double q) const {
    const double mu = static_cast<double>(sample.view_cosine);
    const double factors[sky::kMoleculeTerms] = {1.0, 0.5 * (3.0 * mu * mu - 1.0), mu * mu - 1.0, mu * q, q * q};
    double sum = 0.0;
    for (std::size_t k = 0; k < 2; ++k) {
      for (int term = 0; term < sky::kMoleculeTerms; ++term) {
        const auto at = static_cast<std::size_t>(4 * (term * kNodes + node)) + c;
        sum +=
            static_cast<double>(sample.molecule_weights[k][c]) * factors[term] * static_cast<double>(molecules[k][at]);
      }
    }
    return std::max(0.0, sum);
  }

  [[nodiscard]] double images_at(std::size_t i, int node, std::size_t c) const {
    double rows[2]{};
    for (std::size_t k = 0; k < 4; ++k) {
      for (int next = 0; next < 2; ++next) {
        const auto at = static_cast<std::size_t>(4 * (row[i] + next * kNodes + node)) + c;
        rows[next] += static_cast<double>(sample.weights[k][c]) * static_cast<double>(images[k][at]);
      }
    }
    return rows[0] + static_cast<double>(fraction[i]) * (rows[1] - rows[0]);
  }

  [[nodiscard]] double brightness(double step) const {
    const int below = std::min(static_cast<int>(step), kSteps - 2);
    const auto mixed = [&](int at) {
      return 0.3 * static_cast<double>(steps[0][static_cast<std::size_t>(at)]) +
             0.7 * static_cast<double>(steps[1][static_cast<std::size_t>(at)]);
    };
    return mixed(below) + (step - below) * (mixed(below + 1) - mixed(below));
  }

  [[nodiscard]] double expected(std::size_t i, std::size_t c, bool with_molecules, bool with_images) const {
    const double mu = 0.98 * static_cast<double>(sun[i]) + 0.04 * static_cast<double>(nu[i]);
    const double inside = std::clamp(mu, -1.0, 1.0);
    const double a = std::max(std::sqrt(inside * inside + 0.019) - inside - 0.0094, 0.0) * 7.8;
    const double even = 0.8 * std::max(1.0 - a * 0.12, 0.0) / (1.0 + 0.25 * a) + 0.13 * std::max(inside + 0.5, 0.0);
    const double u = std::clamp((1.0 - even) / 0.19, 0.0, 1.0);
    const double x = even - 0.19 * (std::sqrt(u * (u + 0.13 * std::pow(1.0 - u, 3.0))) - u);
    const double position = std::clamp(x, 0.0, 1.0) * (kNodes - 1);
    const int node = std::min(static_cast<int>(position), kNodes - 2);
    const double q = static_cast<double>(nu[i]) - static_cast<double>(sample.view_cosine) * mu;
    double ends[2]{};
    for (int k = 0; k < 2; ++k) {
      if (with_molecules) ends[k] += molecules_at(node + k, c, q);
      if (with_images) ends[k] += images_at(i, node + k, c);
      ends[k] /= brightness(static_cast<double>((node + k) * sky::kSunSteps));
    }
    return brightness(position * sky::kSunSteps) * (ends[0] + (position - node) * (ends[1] - ends[0]));
  }
};

/// A sample in sunlight, whose suns stand from below its horizon to the zenith.
struct SunlitScene {
  static constexpr int kRow = 20;  ///< nodes
  std::mt19937 generator{5};
  std::vector<float> rows[4], sun, nu;
  sky::SunlitSample sample{};

  explicit SunlitScene(int count, bool with_aerosol) {
    sample.start_ratio = 0.99F;
    sample.distance_ratio = 0.02F;
    sample.horizon = -0.05F;
    sample.rational = 0.7F * kRow;
    sample.bend = 0.2F;
    sample.linear = 0.35F * kRow;
    sample.disc_slope = 9.0F;
    sample.disc_offset = 0.3F;
    sample.view_cosine = 0.3F;
    sample.turning = 0.4F;
    sample.sinking = 0.1F;
    const std::vector<float> factors = numbers(generator, 12, 0.1, 0.9);
    for (std::size_t k = 0; k < 4; ++k) {
      rows[k] = numbers(generator, 4 * kRow, 0.0, 1.0);
      sample.rows[k] = rows[k].data();
      sample.row_weights[k] = factors[k];
      sample.rayleigh[k] = k < 3 ? factors[4 + k] : 0.0F;
      sample.aerosol[k] = k < 3 ? factors[8 + k] : 0.0F;
    }
    sample.with_aerosol = with_aerosol;
    sun = numbers(generator, static_cast<std::size_t>(count), -0.3, 1.0);
    nu = numbers(generator, sun.size(), -1.0, 1.0);
  }

  /// Returns the disc's visible share for a middle that rises by 2 w about `risen`, by Simpson's rule.
  static double share(double risen, double width) {
    const auto visible = [](double t) {
      const double inside = std::clamp(t, 0.0, 1.0);
      return inside * inside * (3.0 - 2.0 * inside);
    };
    constexpr int steps = 2000;
    double sum = 0.0;
    for (int i = 0; i <= steps; ++i) {
      const double weight = i == 0 || i == steps ? 1.0 : (i % 2 == 1 ? 4.0 : 2.0);
      sum += weight * visible(risen + width * (2.0 * i / steps - 1.0));
    }
    return sum / (3.0 * steps);
  }

  /// Returns the expected sunlight of sun i, for matter 0 or 1.
  double expected(std::size_t i, std::size_t matter, std::size_t c) const {
    const auto number = [](float value) { return static_cast<double>(value); };
    if (matter == 1 && !sample.with_aerosol) return 0.0;
    const double mu = number(sample.start_ratio) * number(sun[i]) + number(sample.distance_ratio) * number(nu[i]);
    const double above = mu - number(sample.horizon);
    const double turned = number(nu[i]) - number(sample.view_cosine) * mu;
    const double width = std::max(std::abs(number(sample.turning) * turned - number(sample.sinking)), 0.03125);
    const double y = std::max(above, 0.0);
    const double x = number(sample.rational) * y / (y + number(sample.bend)) + number(sample.linear) * y;
    const double position = std::clamp(x, 0.0, kRow - 1.0);
    const auto node = std::min(static_cast<std::size_t>(position), static_cast<std::size_t>(kRow - 2));
    double ends[2] = {};
    for (std::size_t k = 0; k < 4; ++k) {
      for (std::size_t e = 0; e < 2; ++e) {
        ends[e] += number(sample.row_weights[k]) * number(rows[k][4 * (node + e) + c]);
      }
    }
    const double light = ends[0] + (position - static_cast<double>(node)) * (ends[1] - ends[0]);
    return number(matter == 0 ? sample.rayleigh[c] : sample.aerosol[c]) * light *
           share(number(sample.disc_slope) * above + number(sample.disc_offset), width);
  }
};

}  // namespace

TEST_CASE("Light of a source along a ray is its twin's in double", "[sky][tables][kernels]") {
  on_every_instruction_set([](const sky::SolverKernels& kernels) {
    for (const int kinds : {1, 2, 3}) {
      Scene scene;
      const bool molecules = (kinds & 1) != 0;
      const bool images = (kinds & 2) != 0;
      if (!molecules) scene.sample.molecules[0] = nullptr;
      if (!images) scene.sample.count = 0;
      const sky::SkySuns suns{scene.sun.data(), scene.nu.data(), scene.row.data(), scene.fraction.data(), kCount};
      std::vector<float> scratch(4 * kAngles * kNodes + 16 * kNodes + kSteps + 15);
      std::vector<float> sums(8 * kCount, 1.0F);  // they are added to
      kernels.add_source(scene.sample, kAxis, kAngles * kNodes, suns, scratch.data(), sums.data());
      double worst = 0.0;
      for (std::size_t i = 0; i < kCount; ++i) {
        for (std::size_t c = 0; c < 3; ++c) {
          const double found = static_cast<double>(sums[8 * i + c]) + static_cast<double>(sums[8 * i + 4 + c]) - 2.0;
          worst = std::max(worst, std::abs(found - scene.expected(i, c, molecules, images)));
        }
      }
      CAPTURE(kinds);
      CHECK(worst < 2e-5);
    }
  });
}

TEST_CASE("Sunlight that reaches a sample is its twin's in double", "[sky][tables][kernels]") {
  on_every_instruction_set([](const sky::SolverKernels& kernels) {
    for (const int count : {16, 48, 272}) {
      for (const bool with_aerosol : {false, true}) {
        const SunlitScene scene(count, with_aerosol);
        const sky::SkySuns suns{scene.sun.data(), scene.nu.data(), nullptr, nullptr, count};
        std::vector<float> slice(8 * SunlitScene::kRow);
        std::vector<float> sums(8 * scene.sun.size(), 1.0F);  // they are added to
        kernels.add_sunlight(scene.sample, SunlitScene::kRow, suns, slice.data(), sums.data());
        double worst = 0.0;
        for (std::size_t i = 0; i < sums.size(); ++i) {
          const std::size_t c = i % 4;
          const double exact = c < 3 ? scene.expected(i / 8, i / 4 % 2, c) : 0.0;
          worst = std::max(worst, std::abs(static_cast<double>(sums[i]) - 1.0 - exact));
        }
        CAPTURE(count, with_aerosol);
        CHECK(worst < 2e-5);
      }
    }
  });
}

TEST_CASE("Places of angles are those of their arc cosines", "[sky][tables][kernels]") {
  on_every_instruction_set([](const sky::SolverKernels& kernels) {
    for (const int count : {16, 64, 272}) {
      std::vector<float> cosines;
      for (int i = 0; i < count; ++i) cosines.push_back(static_cast<float>(-1.0 + 2.0 * i / (count - 1)));
      std::vector<std::int32_t> rows(static_cast<std::size_t>(count));
      std::vector<float> fractions(rows.size());
      for (const int angles : {2, 13, 25}) {
        kernels.place_angles(cosines.data(), count, angles, 48, rows.data(), fractions.data());
        for (std::size_t i = 0; i < rows.size(); ++i) {
          CHECK(rows[i] % 48 == 0);
          CHECK((rows[i] >= 0 && rows[i] / 48 <= angles - 2));
          const double position = rows[i] / 48 + static_cast<double>(fractions[i]);
          const double exact = std::acos(static_cast<double>(cosines[i])) / std::numbers::pi * (angles - 1);
          CHECK(std::abs(position - exact) < 1e-5 * (angles - 1));
        }
      }
    }
  });
}

}  // namespace welkin::test
