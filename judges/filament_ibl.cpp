// Filament's libs/ibl in this process beside Welkin, at equal inputs: specular chains, harmonics, the DFG table.
//
//   filament_ibl IMAGE SIZE [SAMPLES...]
//
// The cubemap of SIZE texels that Welkin makes of IMAGE is given to both, in memory. One thread: Filament's JobSystem
// has the calling one alone, Welkin one too. Times are processor time, the least of several runs. Errors are those
// against the integral in double of the same cubemap. Prints tables in Markdown.
#include <ibl/Cubemap.h>
#include <ibl/CubemapIBL.h>
#include <ibl/CubemapSH.h>
#include <ibl/CubemapUtils.h>
#include <ibl/Image.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <functional>
#include <memory>
#include <vector>

#include "welkin/environment_file.h"
#include "welkin/projection.h"
#include "welkin/reflections.h"
#include "welkin/resampling.h"

// Debian's package has no utils/JobSystem.h. Declared is what is used, of 1.9.25, with more than the room that it
// takes.
namespace utils {
class JobSystem {
 public:
  explicit JobSystem(std::size_t threads = 0, std::size_t adoptable_threads = 1) noexcept;
  ~JobSystem();
  void adopt();
  void emancipate();

 private:
  alignas(128) unsigned char room_[1U << 20U];
};
}  // namespace utils

namespace {

namespace ibl = filament::ibl;

double processor_seconds() {
  timespec now;
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

/// The least of at least three runs, and of half a second's.
double least_seconds(const std::function<void()>& run) {
  double least = 1e9;
  double spent = 0.0;
  for (int i = 0; i < 3 || (spent < 0.5 && i < 200); ++i) {
    const double before = processor_seconds();
    run();
    const double took = processor_seconds() - before;
    least = std::min(least, took);
    spent += took;
  }
  return least;
}

struct Peer {
  ibl::Image image;
  ibl::Cubemap cube;
  explicit Peer(std::size_t size) : cube(ibl::CubemapUtils::create(image, size)) {}
};

/// Filament's face names, frames and row order are those of the usual cubemap, which Welkin has too.
void fill(Peer& peer, const welkin::Cubemap& from, int level) {
  const int size = from.level_size(level);
  for (int face = 0; face < 6; ++face) {
    ibl::Image& image = peer.cube.getImageForFace(static_cast<ibl::Cubemap::Face>(face));
    const float* const texels = from.face(level, face);
    for (int y = 0; y < size; ++y)
      for (int x = 0; x < size; ++x) {
        const float* const rgb = texels + 3 * (y * size + x);
        ibl::Cubemap::writeAt(image.getPixelRef(static_cast<std::size_t>(x), static_cast<std::size_t>(y)),
                              {rgb[0], rgb[1], rgb[2]});
      }
  }
  peer.cube.makeSeamless();
}

/// Error of texels on a grid of each face against the integral in double: rms over the truth's rms.
double rms_error(const welkin::CubemapView& source, double roughness, int size,
                 const std::function<glm::dvec3(int, int, int)>& texel) {
  const int step = std::max(1, size / 8);
  std::vector<welkin::dvec3> directions;
  std::vector<glm::dvec3> found;
  for (int face = 0; face < 6; ++face)
    for (int y = step / 2; y < size; y += step)
      for (int x = step / 2; x < size; x += step) {
        const double u = (2.0 * x + 1.0) / size - 1.0;
        const double v = (2.0 * y + 1.0) / size - 1.0;
        const glm::dvec3 d[6] = {{1, -v, -u}, {-1, -v, u}, {u, 1, v}, {u, -1, -v}, {u, -v, 1}, {-u, -v, -1}};
        directions.push_back(glm::normalize(d[face]));
        found.push_back(texel(face, x, y));
      }
  const std::vector<welkin::dvec3> truth = welkin::reference_specular(source, roughness, directions);
  double squares = 0.0;
  double scale = 0.0;
  for (std::size_t i = 0; i < truth.size(); ++i) {
    const glm::dvec3 off = found[i] - truth[i];
    squares += glm::dot(off, off);
    scale += glm::dot(truth[i], truth[i]);
  }
  return std::sqrt(squares / scale);
}

void chains(utils::JobSystem& js, const welkin::Cubemap& cube, const std::vector<int>& samples) {
  const int size = cube.size();
  // Filament's filter wants box-filtered levels of the source, as cmgen makes them; not counted in its time.
  std::vector<Peer> sources;
  sources.reserve(16);
  for (int level_size = size; level_size >= 1; level_size /= 2)
    sources.emplace_back(static_cast<std::size_t>(level_size));
  fill(sources[0], cube, 0);
  for (std::size_t i = 1; i < sources.size(); ++i) {
    ibl::CubemapUtils::downsampleCubemapLevelBoxFilter(js, sources[i].cube, sources[i - 1].cube);
    sources[i].cube.makeSeamless();
  }
  std::vector<ibl::Cubemap> levels;
  for (Peer& each : sources) levels.push_back(std::move(each.cube));
  const int mips = static_cast<int>(std::log2(size / 16)) + 1;
  std::printf("| chain of %d, %d mips | time, ms | error of each mip, rms percent |\n|---|---|---|\n", size, mips);
  const std::vector<double> roughness = welkin::roughness_of_mips(welkin::RoughnessSchedule::filament, mips, size);
  for (const int count : samples) {
    std::vector<Peer> found;
    for (int mip = 0; mip < mips; ++mip) found.emplace_back(static_cast<std::size_t>(size >> mip));
    const auto run = [&] {
      for (int mip = 0; mip < mips; ++mip) {
        const auto alpha =
            static_cast<float>(roughness[static_cast<std::size_t>(mip)] * roughness[static_cast<std::size_t>(mip)]);
        ibl::CubemapIBL::roughnessFilter(js, found[static_cast<std::size_t>(mip)].cube, levels, alpha,
                                         static_cast<std::size_t>(count), {1, 1, 1}, true);
      }
    };
    const double before = processor_seconds();
    run();
    const double seconds = processor_seconds() - before;
    std::printf("| Filament's libs/ibl, %d samples | %.1f |", count, 1e3 * seconds);
    for (int mip = 1; mip < mips; ++mip) {
      ibl::Cubemap& chain = found[static_cast<std::size_t>(mip)].cube;
      std::printf(" %.2g",
                  100.0 * rms_error(cube.view(0), roughness[static_cast<std::size_t>(mip)], size >> mip,
                                    [&](int face, int x, int y) {
                                      const auto& rgb = ibl::Cubemap::sampleAt(
                                          chain.getImageForFace(static_cast<ibl::Cubemap::Face>(face))
                                              .getPixelRef(static_cast<std::size_t>(x), static_cast<std::size_t>(y)));
                                      return glm::dvec3(rgb.x, rgb.y, rgb.z);
                                    }));
    }
    std::printf(" |\n");
  }
  for (const double bound : {1e-2, 1e-3, 1e-4}) {
    welkin::PrefilterOptions options{.size = size};
    options.mips = mips;
    options.rms_error = bound;
    options.roughness = roughness;
    welkin::PrefilteredSpecular made;
    const double seconds = least_seconds([&] { made = welkin::prefilter_specular(cube.view(0), options); });
    std::printf("| Welkin, --rms-error %.0e | %.1f |", bound, 1e3 * seconds);
    for (int mip = 1; mip < mips; ++mip) {
      std::printf(" %.2g", 100.0 * rms_error(cube.view(0), roughness[static_cast<std::size_t>(mip)], size >> mip,
                                             [&](int face, int x, int y) {
                                               const float* const rgb =
                                                   made.cubemap.face(mip, face) + 3 * (y * (size >> mip) + x);
                                               return glm::dvec3(rgb[0], rgb[1], rgb[2]);
                                             }));
    }
    std::printf(" |\n");
  }
}

/// Three bands, against exact integrals of the texels: Welkin's own in quadrature by the definition, in double.
void harmonics(utils::JobSystem& js, const welkin::Cubemap& cube) {
  const auto size = static_cast<std::size_t>(cube.size());
  Peer peer(size);
  fill(peer, cube, 0);
  // Texels by 16 x 16 midpoints each, in double.
  std::vector<glm::dvec3> truth(9, glm::dvec3(0.0));
  constexpr int kParts = 16;
  for (int face = 0; face < 6; ++face)
    for (int y = 0; y < cube.size(); ++y)
      for (int x = 0; x < cube.size(); ++x) {
        double moments[9] = {};
        for (int part = 0; part < kParts * kParts; ++part) {
          const double cells = static_cast<double>(kParts) * cube.size();
          const double u = (2.0 * (kParts * x + part % kParts) + 1.0) / cells - 1.0;
          const double v = (2.0 * (kParts * y + part / kParts) + 1.0) / cells - 1.0;
          const glm::dvec3 d[6] = {{1, -v, -u}, {-1, -v, u}, {u, 1, v}, {u, -1, -v}, {u, -v, 1}, {-u, -v, -1}};
          const double square = glm::dot(d[face], d[face]);
          const double weight = 4.0 / (cells * cells * square * std::sqrt(square));
          const glm::dvec3 n = d[face] / std::sqrt(square);
          const double basis[9] = {0.28209479177387814,
                                   0.4886025119029199 * n.y,
                                   0.4886025119029199 * n.z,
                                   0.4886025119029199 * n.x,
                                   1.0925484305920792 * n.x * n.y,
                                   1.0925484305920792 * n.y * n.z,
                                   0.31539156525252005 * (3.0 * n.z * n.z - 1.0),
                                   1.0925484305920792 * n.x * n.z,
                                   0.5462742152960396 * (n.x * n.x - n.y * n.y)};
          for (int k = 0; k < 9; ++k) moments[k] += weight * basis[k];
        }
        const float* const rgb = cube.face(0, face) + 3 * (y * cube.size() + x);
        for (std::size_t k = 0; k < 9; ++k) truth[k] += moments[k] * glm::dvec3(rgb[0], rgb[1], rgb[2]);
      }
  const auto error = [&](const std::function<glm::dvec3(std::size_t)>& found) {
    double squares = 0.0;
    double scale = 0.0;
    for (std::size_t k = 0; k < 9; ++k) {
      squares += glm::dot(found(k) - truth[k], found(k) - truth[k]);
      scale += glm::dot(truth[k], truth[k]);
    }
    return 100.0 * std::sqrt(squares / scale);
  };
  std::unique_ptr<filament::math::float3[]> theirs;
  const double their_seconds = least_seconds([&] { theirs = ibl::CubemapSH::computeSH(js, peer.cube, 3, false); });
  welkin::Projection ours;
  const double our_seconds = least_seconds([&] { ours = welkin::project(cube.view(0)); });
  std::printf("\n| three bands of %d | time, ms | error, percent of all coefficients |\n|---|---|---|\n", cube.size());
  // Its basis has the Condon-Shortley phase: odd orders have the other sign.
  std::printf("| Filament's libs/ibl, computeSH | %.3f | %.2g |\n", 1e3 * their_seconds, error([&](std::size_t k) {
                return (k % 2 == 1 ? -1.0 : 1.0) * glm::dvec3(theirs[k].x, theirs[k].y, theirs[k].z);
              }));
  std::printf("| Welkin, project | %.3f | %.2g |\n", 1e3 * our_seconds,
              error([&](std::size_t k) { return ours.radiance.coefficients()[k]; }));
}

/// The energy of GGX with height-correlated Smith masking at one angle and roughness, in double: (bias, scale + bias).
glm::dvec2 dfg_truth(double n_dot_v, double roughness) {
  const double alpha = roughness * roughness;
  const double alpha2 = alpha * alpha;
  constexpr int kZeniths = 3000;
  constexpr int kAzimuths = 600;
  glm::dvec2 sum(0.0);
  for (int i = 0; i < kZeniths; ++i) {
    // s = 1 - q^2 is the share of half vectors nearer to the normal: samples crowd at grazing ones.
    const double q = (i + 0.5) / kZeniths;
    const double s = 1.0 - q * q;
    const double c = q / std::sqrt(1.0 + (alpha2 - 1.0) * s);
    const double sine = std::sqrt(1.0 - c * c);
    for (int j = 0; j < kAzimuths; ++j) {
      const double phi = 3.141592653589793 * (j + 0.5) / kAzimuths;
      const double v_dot_h = std::sqrt(1.0 - n_dot_v * n_dot_v) * sine * std::cos(phi) + n_dot_v * c;
      const double n_dot_l = 2.0 * v_dot_h * c - n_dot_v;
      if (v_dot_h <= 0.0 || n_dot_l <= 0.0) continue;
      const double in_light = n_dot_l * std::sqrt(alpha2 + (1.0 - alpha2) * n_dot_v * n_dot_v);
      const double in_view = n_dot_v * std::sqrt(alpha2 + (1.0 - alpha2) * n_dot_l * n_dot_l);
      const double weight = 2.0 * q * 2.0 * n_dot_l * v_dot_h / (c * (in_light + in_view));
      sum += weight * glm::dvec2(std::pow(1.0 - v_dot_h, 5.0), 1.0);
    }
  }
  return sum / (static_cast<double>(kZeniths) * kAzimuths);
}

void tables(utils::JobSystem& js, int size) {
  ibl::Image image(static_cast<std::size_t>(size), static_cast<std::size_t>(size));
  const double before = processor_seconds();
  ibl::CubemapIBL::DFG(js, image, true, false);
  const double their_seconds = processor_seconds() - before;
  const double start = processor_seconds();
  const auto ours = welkin::brdf_table({size, size, welkin::BrdfModel::multiple_scattering, false});
  const double our_seconds = processor_seconds() - start;
  glm::dvec2 worst(0.0);
  for (int row = size / 16; row < size; row += size / 8)
    for (int column = size / 16; column < size; column += size / 8) {
      const glm::dvec2 truth = dfg_truth((column + 0.5) / size, (row + 0.5) / size);
      const auto& rgb = *static_cast<const filament::math::float3*>(  // its top row is the roughest
          image.getPixelRef(static_cast<std::size_t>(column), static_cast<std::size_t>(size - 1 - row)));
      const float* const values = ours->values.data() + ours->channels * (row * size + column);
      const glm::dvec2 theirs(rgb.x, rgb.y);
      const glm::dvec2 mine(values[0], values[1]);
      for (int k = 0; k < 2; ++k) {
        worst.x = std::max(worst.x, std::abs(theirs[k] - truth[k]));
        worst.y = std::max(worst.y, std::abs(mine[k] - truth[k]));
      }
    }
  std::printf("\n| DFG table of %d x %d | time, ms | largest error of 64 texels |\n|---|---|---|\n", size, size);
  std::printf("| Filament's libs/ibl, DFG, 1024 samples | %.1f | %.1e |\n", 1e3 * their_seconds, worst.x);
  std::printf("| Welkin, brdf_table | %.1f | %.1e |\n", 1e3 * our_seconds, worst.y);
}

}  // namespace

int main(int count, char** arguments) {
  if (count < 3) {
    std::fputs("usage: filament_ibl IMAGE SIZE [SAMPLES...]\n", stderr);
    return 2;
  }
  const int size = std::atoi(arguments[2]);
  std::vector<int> samples;
  for (int i = 3; i < count; ++i) samples.push_back(std::atoi(arguments[i]));
  const welkin::Environment environment = welkin::read_environment(arguments[1]);
  const welkin::Cubemap cube = welkin::to_cubemap(environment.view(), size);
  const auto js = std::make_unique<utils::JobSystem>(1);
  js->adopt();
  welkin::run_with_threads(1, [&] {
    chains(*js, cube, samples);
    harmonics(*js, cube);
    tables(*js, 128);
  });
  js->emancipate();
  return 0;
}
