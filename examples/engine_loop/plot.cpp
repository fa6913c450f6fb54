#include "plot.h"

#include <cstdio>
#include <iomanip>
#include <sstream>
#include <string>

#include "statistics.h"

namespace engine_loop {
namespace {

/// A gnuplot string: inside single quotes only these themselves are special.
std::string quoted(const std::string& text) {
  std::string result = "'";
  for (const char letter : text) result += letter == '\'' ? "''" : std::string(1, letter);
  return result + "'";
}

std::string panel_title(const Run& run) {
  const FrameStatistics frames = frame_statistics(run.frames);
  std::ostringstream text;
  text << std::fixed << std::setprecision(1) << run.name << ": 50 % of the frames within " << frames.median_ms
       << " ms, 99 % within " << frames.percentile_99_ms << " ms; " << frames.missed << " missed";
  return text.str();
}

/// Panels share their axes; time is logarithmic, or the worst frame would press all others flat.
std::string script(const std::string& csv, const std::string& png, const std::vector<Run>& runs) {
  std::ostringstream text;
  text << "csv = " << quoted(csv) << "\nset output " << quoted(png) << R"(
set terminal png noenhanced size 1200,)"
       << 60 + 270 * runs.size() << R"( font ',11'
set datafile separator ','
set key off
stats csv using 2:3 every ::1 name 'all' nooutput
set xrange [-1:all_max_x + 1]
set logscale y 2
set yrange [(all_min_y < 5 ? 0.8 * all_min_y : 4):(all_max_y > 32 ? 1.3 * all_max_y : 40)]
set ytics (1, 2, 4, 8, 16.67, 32, 64, 128, 256, 512)
set grid ytics linecolor rgb '#dddddd'
set lmargin 8
set rmargin 3
set multiplot layout )"
       << runs.size() << ",1 title 'Time of each frame, ms. Above the line (16.67) it is missed.'\n";
  for (const Run& run : runs) {
    text << "set title " << quoted(panel_title(run)) << " offset 0,-0.6\n"
         << (&run == &runs.back() ? "set xlabel 'frame'\n" : "") << "plot csv using (strcol(1) eq " << quoted(run.name)
         << " ? $2 : NaN):3 every ::1 with points pointtype 7 pointsize 0.6 linecolor rgb '#1f5fa8', "
            "1000.0 / 60.0 with lines linewidth 1.5 linecolor rgb '#c0392b'\n";
  }
  return text.str() + "unset multiplot\n";
}

}  // namespace

bool draw_plot(const std::filesystem::path& csv, const std::filesystem::path& png, const std::vector<Run>& runs) {
  std::FILE* gnuplot = popen("gnuplot", "w");
  if (gnuplot == nullptr) return false;
  const std::string commands = script(csv.string(), png.string(), runs);
  const bool written = std::fputs(commands.c_str(), gnuplot) >= 0;
  return pclose(gnuplot) == 0 && written;
}

}  // namespace engine_loop
