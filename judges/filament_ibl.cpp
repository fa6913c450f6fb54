// Filament's libs/ibl for `welkin report` (perf/report/peers.cpp), which measures it beside Welkin at equal
// inputs: specular chains, harmonics, the DFG table. One thread: Filament's JobSystem has the calling one alone. Times
// are processor time, the least of several runs.
//
//   judge_filament_ibl --chain CUBE SIZE MIPS BUDGET FOLDER SAMPLES...
//   judge_filament_ibl --harmonics CUBE SIZE BUDGET
//   judge_filament_ibl --table SIZE BUDGET FILE
//
// CUBE has faces of floats, BUDGET is the seconds for repeats. Prints the time of each call, and after that of
// --harmonics their 27 numbers. --chain writes FOLDER/filament_SAMPLES.f32, mip after mip, and --table FILE, rows of
// RGB floats, roughest first.
#include <ibl/Cubemap.h>
#include <ibl/CubemapIBL.h>
#include <ibl/CubemapSH.h>
#include <ibl/CubemapUtils.h>
#include <ibl/Image.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <fstream>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "welkin/image.h"
#include "welkin/reflections.h"

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
  const auto js = std::make_unique<utils::JobSystem>(1);
  js->adopt();
  int exit_code = 0;
  if (task == "--chain" && count > 7) {
    print_chain(*js, arguments + 2, count - 2);
  } else if (task == "--harmonics" && count == 5) {
    print_harmonics(*js, arguments + 2);
  } else if (task == "--table" && count == 5) {
    print_table(*js, arguments + 2);
  } else {
    std::fputs("usage: judge_filament_ibl --chain|--harmonics|--table ARGUMENT...\n", stderr);
    exit_code = 2;
  }
  js->emancipate();
  return exit_code;
}
