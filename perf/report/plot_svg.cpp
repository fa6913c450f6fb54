#include "perf/report/plot_svg.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <optional>
#include <sstream>
#include <string>
#include <vector>

#include "perf/report/measurement.h"
#include "perf/report/words.h"

namespace welkin::report {
namespace {

/// Values to places along a picture's edge.
class LogAxis {
 public:
  /// Shows `values` that are above 0 and finite, with a margin; `floor`: what is smaller is drawn there. `from`, `to`:
  /// the places of its ends (`to` may lie before `from`). At least one and a half decades, so that noise does not fill
  /// it.
  LogAxis(const std::vector<double>& values, double floor, double from, double to);

  [[nodiscard]] double place(double value) const noexcept;
  /// Powers of ten within it.
  [[nodiscard]] std::vector<double> decades() const;
  /// Their multiples by 2 to 9 within it.
  [[nodiscard]] std::vector<double> minor() const;
  [[nodiscard]] bool shows(double value) const noexcept;

 private:
  double floor_, from_, to_;
  double low_ = -1.0, high_ = 1.0;  ///< decimal logarithms of its ends
};

struct Box {
  double left, top, right, bottom;
};

struct LabelPlace {
  double x, y;         ///< of the text's baseline
  const char* anchor;  ///< "start" or "end"
};

/// Takes places one after the other.
class LabelPlaces {
 public:
  explicit LabelPlaces(Box area) : area_(area) {}

  /// Nothing will lie on it.
  void keep_free(const Box& box) { taken_.push_back(box); }

  /// A place for `text` near a point, in letters of `size`; none if there is no free one.
  [[nodiscard]] std::optional<LabelPlace> place(double x, double y, const std::string& text, double size);

 private:
  Box area_;
  std::vector<Box> taken_;
};

constexpr double kLeastDecades = 1.5;
constexpr double kMargin = 0.12;  // decades

LogAxis::LogAxis(const std::vector<double>& values, double floor, double from, double to)
    : floor_(floor), from_(from), to_(to) {
  double least = HUGE_VAL;
  double largest = 0.0;
  for (const double value : values) {
    if (!std::isfinite(value) || value < 0.0) continue;
    least = std::min(least, std::max(value, floor));
    largest = std::max(largest, std::max(value, floor));
  }
  if (largest <= 0.0) return;
  low_ = std::log10(least) - kMargin;
  high_ = std::log10(largest) + kMargin;
  const double missing = std::max(0.0, kLeastDecades - (high_ - low_));
  low_ -= 0.5 * missing;
  high_ += 0.5 * missing;
}

double LogAxis::place(double value) const noexcept {
  const double at = std::log10(std::max(value, floor_));
  return from_ + (to_ - from_) * (at - low_) / (high_ - low_);
}

bool LogAxis::shows(double value) const noexcept {
  const double at = std::log10(value);
  return at >= low_ && at <= high_;
}

std::vector<double> LogAxis::decades() const {
  std::vector<double> found;
  for (int power = static_cast<int>(std::ceil(low_)); power <= high_; ++power) found.push_back(std::pow(10.0, power));
  return found;
}

std::vector<double> LogAxis::minor() const {
  std::vector<double> found;
  for (int power = static_cast<int>(std::floor(low_)); power <= high_; ++power) {
    for (int factor = 2; factor <= 9; ++factor) {
      const double value = factor * std::pow(10.0, power);
      if (shows(value)) found.push_back(value);
    }
  }
  return found;
}

constexpr double kLetter = 0.56;  // a letter's width in its size, on the safe side
constexpr double kGap = 9.0;      // from the point's centre

bool touch(const Box& a, const Box& b) {
  return a.left < b.right && b.left < a.right && a.top < b.bottom && b.top < a.bottom;
}

std::optional<LabelPlace> LabelPlaces::place(double x, double y, const std::string& text, double size) {
  const double width = kLetter * size * static_cast<double>(text.size());
  const double half = 0.35 * size;  // from the baseline to the middle of small letters
  const LabelPlace tries[] = {{x + kGap, y + half, "start"},
                              {x + 0.7 * kGap, y - kGap, "start"},
                              {x + 0.7 * kGap, y + kGap + 2.0 * half, "start"},
                              {x - kGap, y + half, "end"},
                              {x - 0.7 * kGap, y - kGap, "end"},
                              {x - 0.7 * kGap, y + kGap + 2.0 * half, "end"}};
  for (const LabelPlace& place : tries) {
    const double left = place.anchor[0] == 's' ? place.x : place.x - width;
    const Box box{left, place.y - 0.8 * size, left + width, place.y + 0.25 * size};
    const bool inside =
        box.left >= area_.left && box.right <= area_.right && box.top >= area_.top && box.bottom <= area_.bottom;
    if (!inside || std::any_of(taken_.begin(), taken_.end(), [&](const Box& other) { return touch(box, other); }))
      continue;
    taken_.push_back(box);
    return place;
  }
  return std::nullopt;
}

constexpr double kWidth = 860.0;
constexpr double kLeft = 70.0, kRight = 20.0, kTop = 16.0, kBottom = 52.0;
constexpr double kHeight = 420.0;  // of the frame with its axes, without the legend
constexpr double kLegendRow = 20.0;
constexpr double kLegendLetter = 6.6;  // width
constexpr double kErrorFloor = 1e-9;
constexpr double kLetters = 11.0;

// Okabe and Ito's palette ("Color universal design", 2008): told apart by colour-blind people too.
constexpr const char* kColours[] = {"#0072b2", "#d55e00", "#009e73", "#cc79a7",
                                    "#8c6d00", "#56b4e9", "#000000", "#7a7a7a"};

std::string number(double value) {
  char text[32];
  std::snprintf(text, sizeof text, "%.1f", value);
  return text;
}

/// A power of ten in percent; with an exponent where zeros would not fit beside the axis.
std::string percent_of_power(double value) {
  const int power = static_cast<int>(std::lround(std::log10(value))) + 2;
  char text[32];
  if (power < -3) {
    std::snprintf(text, sizeof text, "1e%d %%", power);
  } else {
    std::snprintf(text, sizeof text, "%.*f %%", std::max(0, -power), 100.0 * value);
  }
  return text;
}

/// Methods in the order in which they come; a peer's are its own.
struct Series {
  std::string name;
  bool peer = false;
  std::vector<std::size_t> members;
};

class Plot {
 public:
  Plot(const Pass& pass, std::span<const Measurement> measurements, const Machine& machine)
      : pass_(pass),
        all_(measurements),
        machine_(machine),
        front_(pareto_front(measurements)),
        times_(values(&Measurement::seconds), 1e-9, kLeft, kWidth - kRight),
        errors_(values(&Measurement::error_rms), kErrorFloor, kHeight - kBottom, kTop),
        places_({kLeft, kTop, kWidth - kRight, kHeight - kBottom}) {
    for (std::size_t k = 0; k < all_.size(); ++k) add_to_series(k);
  }

  std::string svg(PlotUse use) {
    const std::string keys = legend();
    const double height = kHeight + legend_height_;
    out_ << "<svg " << (use == PlotUse::file ? "xmlns=\"http://www.w3.org/2000/svg\" " : "") << "viewBox=\"0 0 "
         << number(kWidth) << ' ' << number(height) << "\" width=\"" << number(kWidth) << "\" height=\""
         << number(height) << "\" role=\"img\" font-family=\"system-ui, sans-serif\" font-size=\"12\">\n<title>"
         << escaped(pass_.title)
         << ": error over time</title>\n<rect width=\"100%\" height=\"100%\" fill=\"#ffffff\"/>\n";
    axes();
    targets();
    for (std::size_t k = 0; k < series_.size(); ++k) line(series_[k], colour(k));
    front_line();
    for (std::size_t k = 0; k < series_.size(); ++k) {
      for (const std::size_t member : series_[k].members) point(member, colour(k));
    }
    labels();
    out_ << keys << "</svg>\n";
    return out_.str();
  }

 private:
  std::vector<double> values(double Measurement::*member) const {
    std::vector<double> found;
    for (const Measurement& one : all_) found.push_back(one.*member);
    return found;
  }

  static const char* colour(std::size_t series) { return kColours[series % std::size(kColours)]; }

  bool drawn(std::size_t k) const { return std::isfinite(all_[k].seconds) && std::isfinite(all_[k].error_rms); }

  void add_to_series(std::size_t k) {
    const Measurement& one = all_[k];
    const std::string name = one.peer.empty() ? one.method : one.peer + ", " + one.method;
    auto found = std::find_if(series_.begin(), series_.end(), [&](const Series& s) { return s.name == name; });
    if (found == series_.end()) found = series_.insert(series_.end(), {name, !one.peer.empty(), {}});
    if (drawn(k)) found->members.push_back(k);
  }

  double x(std::size_t k) const { return times_.place(all_[k].seconds); }
  double y(std::size_t k) const { return errors_.place(all_[k].error_rms); }

  void stroke(double x1, double y1, double x2, double y2, const char* style) {
    out_ << "<line x1=\"" << number(x1) << "\" y1=\"" << number(y1) << "\" x2=\"" << number(x2) << "\" y2=\""
         << number(y2) << "\" " << style << "/>\n";
  }

  void words(double at_x, double at_y, const std::string& text, const std::string& style) {
    out_ << "<text x=\"" << number(at_x) << "\" y=\"" << number(at_y) << "\" " << style << '>' << text << "</text>\n";
  }

  void axes() {
    const double bottom = kHeight - kBottom;
    const double right = kWidth - kRight;
    for (const double value : times_.minor())
      stroke(times_.place(value), bottom, times_.place(value), bottom + 3, "stroke=\"#999999\"");
    for (const double value : errors_.minor())
      stroke(kLeft - 3, errors_.place(value), kLeft, errors_.place(value), "stroke=\"#999999\"");
    for (const double value : times_.decades()) {
      stroke(times_.place(value), kTop, times_.place(value), bottom + 6, "stroke=\"#e4e4e4\"");
      words(times_.place(value), bottom + 20, duration_markup(value), "text-anchor=\"middle\" fill=\"#333333\"");
    }
    // Few powers of ten leave room for what is between them.
    if (times_.decades().size() < 3) {
      for (const double value : times_.minor()) {
        const double digit = value / std::pow(10.0, std::floor(std::log10(value)));
        if (std::lround(digit) != 2 && std::lround(digit) != 5) continue;
        words(times_.place(value), bottom + 20, duration_markup(value), "text-anchor=\"middle\" fill=\"#666666\"");
      }
    }
    for (const double value : errors_.decades()) {
      stroke(kLeft - 6, errors_.place(value), right, errors_.place(value), "stroke=\"#e4e4e4\"");
      words(kLeft - 9, errors_.place(value) + 4, percent_of_power(value), "text-anchor=\"end\" fill=\"#333333\"");
    }
    out_ << "<rect x=\"" << number(kLeft) << "\" y=\"" << number(kTop) << "\" width=\"" << number(right - kLeft)
         << "\" height=\"" << number(bottom - kTop) << "\" fill=\"none\" stroke=\"#666666\"/>\n";
    words(0.5 * (kLeft + right), bottom + 40,
          escaped(machine_.clock + " of a call, " + std::to_string(machine_.threads) +
                  (machine_.threads == 1 ? " thread" : " threads")),
          "text-anchor=\"middle\" fill=\"#333333\"");
    const std::string middle = number(0.5 * (kTop + bottom));
    words(14, 0.5 * (kTop + bottom), "rms error",
          "text-anchor=\"middle\" fill=\"#333333\" transform=\"rotate(-90 14 " + middle + ")\"");
  }

  void targets() {
    for (const double target : kErrorTargets) {
      if (!errors_.shows(target)) continue;
      const double at = errors_.place(target);
      stroke(kLeft, at, kWidth - kRight, at, "stroke=\"#bb9955\" stroke-dasharray=\"2 4\"");
      const double base = at - 13 < kTop ? at + 11 : at - 3;  // of the word: below the line where there is no room
      words(kWidth - kRight - 4, base, percent(target), "text-anchor=\"end\" fill=\"#997733\" font-size=\"10\"");
      places_.keep_free({kWidth - kRight - 36, base - 10, kWidth - kRight, base + 3});
    }
  }

  void line(const Series& series, const char* paint) {
    out_ << "<polyline fill=\"none\" stroke=\"" << paint << "\" stroke-width=\"1\" opacity=\"0.55\""
         << (series.peer ? " stroke-dasharray=\"4 3\"" : "") << " points=\"";
    for (const std::size_t k : series.members) out_ << number(x(k)) << ',' << number(y(k)) << ' ';
    out_ << "\"/>\n";
  }

  void front_line() {
    out_ << "<path fill=\"none\" stroke=\"#222222\" stroke-width=\"5\" opacity=\"0.13\" d=\"";
    const char* command = "M";
    for (const std::size_t k : front_) {
      out_ << command << number(x(k));
      if (*command == 'M') out_ << ' ' << number(y(k));
      if (*command == 'H') out_ << 'V' << number(y(k));
      command = "H";
    }
    out_ << "\"/>\n";
  }

  bool on_front(std::size_t k) const { return std::find(front_.begin(), front_.end(), k) != front_.end(); }

  void point(std::size_t k, const char* paint) {
    const Measurement& one = all_[k];
    const bool peer = !one.peer.empty();
    out_ << "<g class=\"point\"><title>" << escaped(label(one)) << "\n"
         << percent(one.error_rms) << " rms, " << percent(one.error_maximum) << " at most\n"
         << duration_markup(one.seconds) << (on_front(k) ? "\non the front" : "") << "</title>";
    if (on_front(k)) {
      out_ << "<circle cx=\"" << number(x(k)) << "\" cy=\"" << number(y(k))
           << "\" r=\"7.5\" fill=\"#ffffff\" stroke=\"#222222\" stroke-width=\"1.4\"/>";
    }
    if (peer) {
      out_ << "<rect x=\"" << number(x(k) - 4) << "\" y=\"" << number(y(k) - 4)
           << "\" width=\"8\" height=\"8\" fill=\"#ffffff\" stroke=\"" << paint << "\" stroke-width=\"1.8\"/>";
    } else {
      out_ << "<circle cx=\"" << number(x(k)) << "\" cy=\"" << number(y(k)) << "\" r=\"4.2\" fill=\"" << paint
           << "\"/>";
    }
    out_ << "</g>\n";
    places_.keep_free({x(k) - 6, y(k) - 6, x(k) + 6, y(k) + 6});
  }

  void label_of(std::size_t k) {
    const std::string& text = all_[k].setting;
    const auto place = places_.place(x(k), y(k), text, kLetters);
    if (!place) return;
    words(place->x, place->y, escaped(text),
          std::string("font-size=\"11\" fill=\"#222222\" stroke=\"#ffffff\" stroke-width=\"3\" paint-order=\"stroke\" "
                      "text-anchor=\"") +
              place->anchor + "\"");
  }

  /// The front's words first, then those of peers, then of the rest where there is room.
  void labels() {
    for (const std::size_t k : front_) label_of(k);
    for (std::size_t k = 0; k < all_.size(); ++k) {
      if (drawn(k) && !all_[k].peer.empty()) label_of(k);
    }
    for (std::size_t k = 0; k < all_.size(); ++k) {
      if (drawn(k) && all_[k].peer.empty() && !on_front(k)) label_of(k);
    }
  }

  static void key_sign(std::ostringstream& keys, const Series& series, double at_x, double at_y, const char* paint) {
    if (series.peer) {
      keys << "<rect x=\"" << number(at_x - 4) << "\" y=\"" << number(at_y - 4)
           << "\" width=\"8\" height=\"8\" fill=\"#ffffff\" stroke=\"" << paint << "\" stroke-width=\"1.8\"/>";
    } else {
      keys << "<circle cx=\"" << number(at_x) << "\" cy=\"" << number(at_y) << "\" r=\"4.2\" fill=\"" << paint
           << "\"/>";
    }
  }

  std::string legend() {
    std::ostringstream keys;
    double at_x = kLeft;
    double at_y = kHeight + 8;
    const auto next = [&](const std::string& text) {
      const double width = 34.0 + kLegendLetter * static_cast<double>(text.size());
      if (at_x > kLeft && at_x + width > kWidth - kRight) {
        at_x = kLeft;
        at_y += kLegendRow;
      }
      keys << "<text x=\"" << number(at_x + 11) << "\" y=\"" << number(at_y + 4) << "\" fill=\"#222222\">"
           << escaped(text) << "</text>";
      const double here = at_x;
      at_x += width;
      return here;
    };
    for (std::size_t k = 0; k < series_.size(); ++k) {
      const double here = next(series_[k].name);
      key_sign(keys, series_[k], here + 2, at_y, colour(k));
    }
    const double here = next("on the front");
    keys << "<circle cx=\"" << number(here + 1) << "\" cy=\"" << number(at_y)
         << "\" r=\"6.5\" fill=\"none\" stroke=\"#222222\" stroke-width=\"1.4\"/>\n";
    legend_height_ = at_y + kLegendRow - kHeight;
    return keys.str();
  }

  const Pass& pass_;
  std::span<const Measurement> all_;
  const Machine& machine_;
  std::vector<std::size_t> front_;
  LogAxis times_;
  LogAxis errors_;
  LabelPlaces places_;
  std::vector<Series> series_;
  double legend_height_ = 0.0;
  std::ostringstream out_;
};

}  // namespace

std::string plot_svg(const Pass& pass, std::span<const Measurement> measurements, const Machine& machine, PlotUse use) {
  const bool any = std::any_of(measurements.begin(), measurements.end(), [](const Measurement& one) {
    return std::isfinite(one.seconds) && std::isfinite(one.error_rms);
  });
  return any ? Plot(pass, measurements, machine).svg(use) : "";
}

}  // namespace welkin::report
