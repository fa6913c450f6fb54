// Filament's libs/ibl in this process beside Welkin, at equal inputs: specular chains, harmonics, the DFG table.
//
//   filament_ibl IMAGE SIZE [SAMPLES...]
//
// The cubemap of SIZE texels that Welkin makes of IMAGE is given to both, in memory. One thread: Filament's JobSystem
// has the calling one alone, Welkin one too. Times are processor time, the least of several runs. Errors are those
// against the integral in double of the same cubemap. Prints tables in Markdown.
//
// For `welkin report` (perf/report/filament_peer.cpp), Filament's calls alone; CUBE has faces of floats, BUDGET is the
// seconds for repeats. Prints the time of each, and after that of --harmonics their 27 numbers:
//
//   filament_ibl --chain CUBE SIZE MIPS BUDGET FOLDER SAMPLES...      writes FOLDER/filament_SAMPLES.f32, mip after mip
//   filament_ibl --harmonics CUBE SIZE BUDGET
//   filament_ibl --table SIZE BUDGET FILE                             writes FILE, rows of RGB floats, roughest first
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
#include <fstream>
#include <functional>
#include <memory>
#include <string>
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

/// The least of at least `fewest` runs, and of `budget` seconds'.
double least_seconds(const std::function<void()>& run, double budget = 0.5, int fewest = 3) {
  double least = 1e9;
  double spent = 0.0;
  for (int i = 0; i < fewest || (spent < budget && i < 200); ++i) {
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

/// Filament's filter wants box-filtered levels of the source, as cmgen makes them; not counted in its time.
class Chain {
 public:
  Chain(utils::JobSystem& js, const welkin::Cubemap& cube, int mips)
      : js_(js), roughness_(welkin::mip_roughness(welkin::RoughnessSchedule::filament, mips, cube.size())) {
    sources_.reserve(16);
    for (int size = cube.size(); size >= 1; size /= 2) sources_.emplace_back(static_cast<std::size_t>(size));
    fill(sources_[0], cube, 0);
    for (std::size_t i = 1; i < sources_.size(); ++i) {
      ibl::CubemapUtils::downsampleCubemapLevelBoxFilter(js, sources_[i].cube, sources_[i - 1].cube);
      sources_[i].cube.makeSeamless();
    }
    for (Peer& each : sources_) levels_.push_back(std::move(each.cube));
    for (int mip = 0; mip < mips; ++mip) found_.emplace_back(static_cast<std::size_t>(cube.size() >> mip));
  }

  void filter(int samples) {
    for (std::size_t mip = 0; mip < found_.size(); ++mip) {
      ibl::CubemapIBL::roughnessFilter(js_, found_[mip].cube, levels_,
                                       static_cast<float>(roughness_[mip] * roughness_[mip]),
                                       static_cast<std::size_t>(samples), {1, 1, 1}, true);
    }
  }
  [[nodiscard]] filament::math::float3 texel(int mip, int face, int x, int y) {
    const ibl::Image& image =
        found_[static_cast<std::size_t>(mip)].cube.getImageForFace(static_cast<ibl::Cubemap::Face>(face));
    return ibl::Cubemap::sampleAt(image.getPixelRef(static_cast<std::size_t>(x), static_cast<std::size_t>(y)));
  }

 private:
  utils::JobSystem& js_;
  std::vector<double> roughness_;
  std::vector<Peer> sources_;
  std::vector<ibl::Cubemap> levels_;
  std::vector<Peer> found_;
};

void chains(utils::JobSystem& js, const welkin::Cubemap& cube, const std::vector<int>& samples) {
  const int size = cube.size();
  const int mips = static_cast<int>(std::log2(size / 16)) + 1;
  std::printf("| chain of %d, %d mips | time, ms | error of each mip, rms percent |\n|---|---|---|\n", size, mips);
  const std::vector<double> roughness = welkin::mip_roughness(welkin::RoughnessSchedule::filament, mips, size);
  Chain theirs(js, cube, mips);
  for (const int count : samples) {
    const double seconds = least_seconds([&] { theirs.filter(count); }, 0.0, 1);
    std::printf("| Filament's libs/ibl, %d samples | %.1f |", count, 1e3 * seconds);
    for (int mip = 1; mip < mips; ++mip) {
      std::printf(" %.2g", 100.0 * rms_error(cube.view(0), roughness[static_cast<std::size_t>(mip)], size >> mip,
                                             [&](int face, int x, int y) {
                                               const auto rgb = theirs.texel(mip, face, x, y);
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

welkin::Cubemap read_cube(const char* path, int size) {
  welkin::Cubemap cube(size, 1);
  std::ifstream(path, std::ios::binary)
      .read(reinterpret_cast<char*>(cube.face(0, 0)), static_cast<std::streamsize>(cube.bytes()));
  return cube;
}

void print_chain(utils::JobSystem& js, char** words, int count) {
  const int size = std::atoi(words[1]);
  const int mips = std::atoi(words[2]);
  Chain chain(js, read_cube(words[0], size), mips);
  for (int i = 5; i < count; ++i) {
    const int samples = std::atoi(words[i]);
    std::printf("%.9g\n", least_seconds([&] { chain.filter(samples); }, std::atof(words[3]), 1));
    std::ofstream file(std::string(words[4]) + "/filament_" + words[i] + ".f32", std::ios::binary);
    for (int mip = 0; mip < mips; ++mip)
      for (int texel = 0; texel < 6 * (size >> mip) * (size >> mip); ++texel) {
        const int edge = size >> mip;
        const auto rgb = chain.texel(mip, texel / (edge * edge), texel % edge, texel / edge % edge);
        file.write(reinterpret_cast<const char*>(&rgb), sizeof rgb);
      }
  }
}

void print_harmonics(utils::JobSystem& js, char** words) {
  const int size = std::atoi(words[1]);
  Peer peer(static_cast<std::size_t>(size));
  fill(peer, read_cube(words[0], size), 0);
  std::unique_ptr<filament::math::float3[]> found;
  const auto run = [&] { found = ibl::CubemapSH::computeSH(js, peer.cube, 3, false); };
  std::printf("%.9g\n", least_seconds(run, std::atof(words[2])));
  for (int k = 0; k < 9; ++k) std::printf("%.9g %.9g %.9g\n", found[k].x, found[k].y, found[k].z);
}

void print_table(utils::JobSystem& js, char** words) {
  const auto size = static_cast<std::size_t>(std::atoi(words[0]));
  ibl::Image image(size, size);
  std::printf("%.9g\n", least_seconds([&] { ibl::CubemapIBL::DFG(js, image, true, false); }, std::atof(words[1]), 1));
  std::ofstream file(words[2], std::ios::binary);
  for (std::size_t row = 0; row < size; ++row)
    file.write(static_cast<const char*>(image.getPixelRef(0, row)), static_cast<std::streamsize>(12 * size));
}

}  // namespace

int main(int count, char** arguments) {
  const std::string task = count > 1 ? arguments[1] : "";
  if (count < 3) {
    std::fputs("usage: filament_ibl IMAGE SIZE [SAMPLES...]\n", stderr);
    return 2;
  }
  const auto js = std::make_unique<utils::JobSystem>(1);
  js->adopt();
  if (task == "--chain" && count > 7) {
    print_chain(*js, arguments + 2, count - 2);
  } else if (task == "--harmonics" && count == 5) {
    print_harmonics(*js, arguments + 2);
  } else if (task == "--table" && count == 5) {
    print_table(*js, arguments + 2);
  } else {
    const int size = std::atoi(arguments[2]);
    std::vector<int> samples;
    for (int i = 3; i < count; ++i) samples.push_back(std::atoi(arguments[i]));
    const welkin::Environment environment = welkin::read_environment(arguments[1]);
    const welkin::Cubemap cube = welkin::to_cubemap(environment.view(), size);
    welkin::run_with_threads(1, [&] {
      chains(*js, cube, samples);
      harmonics(*js, cube);
      tables(*js, 128);
    });
  }
  js->emancipate();
  return 0;
}
