#include "frame_csv.h"

#include <fstream>
#include <iomanip>

namespace engine_loop {

void write_csv(const std::filesystem::path& path, const std::vector<Run>& runs) {
  std::ofstream file;
  file.exceptions(std::ios::failbit | std::ios::badbit);
  file.open(path);
  file << std::fixed << std::setprecision(4) << "run,frame,total_ms,wake_ms,work_ms,collect_ms,ask_ms\n";
  for (const Run& run : runs) {
    for (std::size_t frame = 0; frame < run.frames.size(); ++frame) {
      const Frame& times = run.frames[frame];
      file << run.name << ',' << frame << ',' << times.total << ',' << times.wake << ',' << times.work << ','
           << times.collect << ',' << times.ask << '\n';
    }
  }
  file.close();
}

}  // namespace engine_loop
