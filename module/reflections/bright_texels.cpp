// Texels so bright that their lobes are summed one by one: which they are.
#include "reflections/bright_texels.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <glm/geometric.hpp>
#include <limits>
#include <memory>
#include <numbers>
#include <span>

#include "image/geometry.h"
#include "jobs/tiles.h"
#include "math/elementary.h"
#include "platform/memory.h"
#include "platform/standard_library.h"
#include "reflections/bright_lights.h"
#include "reflections/lobe.h"

namespace welkin::reflections {
namespace {

constexpr double kPi = std::numbers::pi;

/// Float arithmetic loses some 3e-7 of the brightest light to everything, and the end of the spectrum 1e-5 of a lobe's
/// peak at its horizon. Blurred light of 25 times the mean so costs 1e-5 of the mean, a hundredth of what is dark in a
/// studio: where there is more, or a quarter of all light lies in one lobe, every texel above that is extracted (those
/// too that are not bright when they are blurred: the edge of a disc is to go with it).
constexpr double kPeak = 25.0;
constexpr double kMinPeak = 4.0;
constexpr double kPart = 0.25;

/// Lights of up to a third of the sphere are compared with the mean of the rest if they make the whole mean this much
/// brighter. With a darker rest no float is right to a percent.
constexpr double kDarker = 2.0 / 3.0;
constexpr double kOutshone = 250.0;
constexpr double kBlack = 1e-9;
constexpr double kMaxTexelsSearched = 4096.0;  ///< texels

/// A cell is as wide as the lobe: a quarter at least of any light narrower than that lies in one.
constexpr double kOfCell = 0.25;

/// Radians. `rows`: of a lat-long, or of a cubemap's six faces.
double texel_height(bool cubemap, int rows) noexcept {
  const int face_rows = rows / 6;
  return cubemap ? 0.5 * kPi / face_rows : kPi / rows;
}

struct Cell {
  double blurred = 0.0;  ///< light at its middle, at most, of what lies in it
  double darkest = std::numeric_limits<double>::max();
};

/// An image as the search sees it: the light of a texel is the largest of its channels. Bands are runs of rows about
/// as high as the lobe is wide, each cut in cells about as wide.
class Search {
 public:
  Search(const projection::SanitizedSource& source, double alpha)
      : source_(source),
        grid_(ImageShape::of(source).grid()),
        face_rows_(source.cubemap() ? source.columns() : source.rows()) {
    if (source.cubemap()) {
      of_face_ = image::FaceSolidAngles::get(source.columns());
    } else {
      for (int row = 0; row < source.rows(); ++row)
        of_row_.push_back(image::lat_long_texel_solid_angle(source.columns(), source.rows(), row));
    }
    std::vector<double> of_rows;  // of each class
    for (int row = 0; row < grid_.row_classes(); ++row) {
      double sum = source.cubemap() ? 0.0 : angle_of(row, 0) * source.columns();
      for (int column = 0; source.cubemap() && column < source.columns(); ++column) sum += angle_of(row, column);
      of_rows.push_back(sum);
    }
    double total = 0.0;
    for (int row = 0; row < source.rows(); ++row)
      total += of_rows[static_cast<std::size_t>(grid_.class_of(row))] * source.range(row).mean;
    mean_ = std::max(0.0, total / (4.0 * kPi));
    scale_ = lobe(1.0, alpha) / lobe_integral(alpha);
    dark_ = dark_mean();
    // A share kPart of all light, 4 pi mean, in one lobe is kPart 4 pi mean scale_ at its middle.
    threshold_ = dark_ * std::clamp(kPart * 4.0 * kPi * scale_, kMinPeak, kPeak);
    const double texel = texel_height(source.cubemap(), source.rows());
    band_rows_ = std::clamp(static_cast<int>(2.0 * alpha / texel), 1, face_rows_);
    bands_a_face_ = (face_rows_ + band_rows_ - 1) / band_rows_;
    const int bands = bands_a_face_ * (source.cubemap() ? 6 : 1);
    starts_.push_back(0);
    for (int band = 0; band < bands; ++band) starts_.push_back(starts_.back() + cells_across(band, alpha));
  }

  [[nodiscard]] int bands() const noexcept { return static_cast<int>(starts_.size()) - 1; }
  [[nodiscard]] std::size_t cells() const noexcept { return starts_.back(); }

  [[nodiscard]] bool may_be_bright(int band) const noexcept {
    float largest = 0.0F;
    for (int row = first_row(band); row < end_row(band); ++row) largest = std::max(largest, source_.range(row).largest);
    return static_cast<double>(largest) > threshold_;
  }

  /// Fills the band's cells.
  void measure(int band, std::span<Cell> cells) const noexcept {
    const std::size_t first = starts_[static_cast<std::size_t>(band)];
    for (int row = first_row(band); row < end_row(band); ++row) {
      for (int column = 0; column < source_.columns(); ++column) {
        Cell& cell = cells[first + cell_of(band, column)];
        const double value = light(row, column);
        cell.darkest = std::min(value, cell.darkest);
        cell.blurred += value * angle_of(row, column) * scale_;
      }
    }
  }

  /// Adds the band's bright texels, not parted yet: their light, and that of the darkest texel of the cell.
  /// Returns whether one of them is in a bright cell.
  bool collect(int band, std::span<const Cell> cells, std::vector<BrightTexel>& found) const {
    bool bright = false;
    for (int row = first_row(band); row < end_row(band); ++row) {
      if (!(static_cast<double>(source_.range(row).largest) > threshold_)) continue;
      for (int column = 0; column < source_.columns(); ++column) {
        const double value = light(row, column);
        if (!(value > threshold_)) continue;
        const Cell& cell = cells[starts_[static_cast<std::size_t>(band)] + cell_of(band, column)];
        bright = bright || cell.blurred > kOfCell * threshold_;
        BrightTexel texel{row, column, {}, {}, angle_of(row, column)};
        const float* const rgb = source_.row(row) + std::ptrdiff_t{3} * column;
        std::copy_n(rgb, 3, texel.excess.begin());
        texel.rest[0] = static_cast<float>(cell.darkest);
        found.push_back(texel);
      }
    }
    return bright;
  }

  /// Parts the found texels' light in what is left, as bright as the darkest texel of the cell and no brighter than the
  /// mean of all that is not found, and the rest, which is extracted.
  void part(std::vector<BrightTexel>& found) const {
    double taken = 0.0;
    for (const BrightTexel& texel : found) {
      for (const float value : texel.excess) taken += texel.steradians * static_cast<double>(value) / 3.0;
    }
    const double mean = source_.cubemap() && dark_ < mean_ ? mean_of_faces() : mean_;
    const double mean_of_others = std::max(0.0, mean - taken / (4.0 * kPi));
    for (BrightTexel& texel : found) {
      const double whole = light(texel.row, texel.column);
      const auto factor = static_cast<float>(std::min(static_cast<double>(texel.rest[0]), mean_of_others) / whole);
      for (std::size_t c = 0; c < 3; ++c) {
        const float value = texel.excess[c];
        texel.rest[c] = value > 0.0F ? value * factor : value;
        texel.excess[c] = value - texel.rest[c];
      }
    }
  }

 private:
  /// Calls look(row, column) for some thousand texels.
  template <class Look>
  void look_around(const Look& look) const noexcept {
    const auto texels = static_cast<double>(source_.rows()) * source_.columns();
    const int step = std::max(1, static_cast<int>(std::sqrt(texels / kMaxTexelsSearched)));
    for (int row = std::min(step / 2, source_.rows() - 1); row < source_.rows(); row += step) {
      for (int column = std::min(step / 2, source_.columns() - 1); column < source_.columns(); column += step)
        look(row, column);
    }
  }

  /// Returns whether no part of the sphere that `dark_mean` could take is `kOutshone`. It takes two thirds: if 0.7 of
  /// the sphere have 2.5 times the light that decides, 0.7 - 1/3 of it lie among the two thirds: those have
  /// (0.7 - 1/3) / (2/3) 2.5 = 1.4 times that light on average.
  [[nodiscard]] bool is_lit() const noexcept {
    const auto enough = static_cast<float>(2.5 * mean_ / kOutshone);
    double lit = 0.0;
    double whole = 0.0;
    look_around([&](int row, int column) {
      const double angle = angle_of(row, column);
      const float* const rgb = source_.row(row) + std::ptrdiff_t{3} * column;
      whole += angle;
      if (rgb[0] >= enough || rgb[1] >= enough || rgb[2] >= enough) lit += angle;
    });
    return lit >= 0.7 * whole;
  }

  /// Returns the mean or, if lights make up nearly all of it, that of the darker part of the sphere.
  [[nodiscard]] double dark_mean() const noexcept {
    if (is_lit()) return mean_;
    struct Texels {
      double steradians = 0.0;
      double light = 0.0;
    };
    constexpr int kExponents = 256;  // of floats that are not negative
    std::array<Texels, kExponents> by_exponent{};
    double whole = 0.0;
    look_around([&](int row, int column) {
      const double value = light(row, column);
      Texels& of = by_exponent[(platform::bit_cast<std::uint32_t>(static_cast<float>(value)) >> 23U) & 0xFFU];
      of.steradians += angle_of(row, column);
      of.light += value * angle_of(row, column);
      whole += angle_of(row, column);
    });
    // from the darkest on; of the exponent that two thirds end in, which spans a factor of 2, a share as bright as all
    double left = kDarker * whole;
    double sum = 0.0;
    for (const Texels& of : by_exponent) {
      if (!(of.steradians > 0.0)) continue;
      sum += of.light * std::min(1.0, left / of.steradians);
      left -= of.steradians;
      if (left <= 0.0) break;
    }
    const double dark = sum / (kDarker * whole);
    return mean_ > kOutshone * dark && dark > kBlack * mean_ ? dark : mean_;
  }

  /// `mean_` takes a row's texels as equally large, which a cubemap's are not: what is left of a lamp in a corner would
  /// be a share of it.
  [[nodiscard]] double mean_of_faces() const noexcept {
    double sum = 0.0;
    for (int row = 0; row < source_.rows(); ++row) {
      const float* rgb = source_.row(row);
      for (int column = 0; column < source_.columns(); ++column, rgb += 3) {
        for (int c = 0; c < 3; ++c) sum += angle_of(row, column) * static_cast<double>(rgb[c]) / 3.0;
      }
    }
    return sum / (4.0 * kPi);
  }

  [[nodiscard]] double light(int row, int column) const noexcept {
    const float* const rgb = source_.row(row) + std::ptrdiff_t{3} * column;
    return static_cast<double>(std::max({rgb[0], rgb[1], rgb[2], 0.0F}));
  }

  [[nodiscard]] std::size_t width() const noexcept { return static_cast<std::size_t>(source_.columns()); }
  [[nodiscard]] double angle_of(int row, int column) const noexcept {
    return of_face_ ? of_face_->at(row % source_.columns(), column) : of_row_[static_cast<std::size_t>(row)];
  }
  [[nodiscard]] int first_row(int band) const noexcept {
    return band / bands_a_face_ * face_rows_ + band % bands_a_face_ * band_rows_;
  }
  [[nodiscard]] int end_row(int band) const noexcept {
    return std::min(first_row(band) + band_rows_, (band / bands_a_face_ + 1) * face_rows_);
  }
  [[nodiscard]] std::size_t cells_across(int band, double alpha) const noexcept {
    double length = 0.5 * kPi;
    if (!source_.cubemap()) {
      const double turns = 0.25 * (first_row(band) + end_row(band)) / face_rows_;
      length = 2.0 * kPi * math::sine_cosine_of_turns(turns).sine;
    }
    const int across = std::clamp(static_cast<int>(length / (2.0 * alpha)), 1, source_.columns());
    return static_cast<std::size_t>(across > 4 ? across / 4 * 4 : across);  // a quarter turn changes nothing
  }
  [[nodiscard]] std::size_t cell_of(int band, int column) const noexcept {
    const auto at = static_cast<std::size_t>(band);
    return static_cast<std::size_t>(column) * (starts_[at + 1] - starts_[at]) / width();
  }

  const projection::SanitizedSource& source_;
  image::TexelGrid grid_;
  std::shared_ptr<const image::FaceSolidAngles> of_face_;  ///< of a cubemap; null of a lat-long
  std::vector<double> of_row_;                             ///< steradians of a texel of each row of a lat-long
  int face_rows_;
  int band_rows_ = 1;
  int bands_a_face_ = 1;
  double scale_ = 0.0;
  double mean_ = 0.0;
  double dark_ = 0.0;
  double threshold_ = 0.0;           ///< of blurred light
  std::vector<std::size_t> starts_;  ///< of each band's cells
};

}  // namespace

BrightSearch search_for_bright_texels(bool cubemap, int columns, int rows, double alpha, std::size_t most) noexcept {
  const double high = texel_height(cubemap, rows);
  const int face_rows = cubemap ? columns : rows;
  const int band_rows = std::clamp(static_cast<int>(2.0 * alpha / high), 1, face_rows);
  const int bands = (face_rows + band_rows - 1) / band_rows * (cubemap ? 6 : 1);
  const int across = std::clamp(static_cast<int>((cubemap ? 0.5 : 2.0) * kPi / (2.0 * alpha)), 1, columns);
  const auto product = [](int a, int b) { return static_cast<std::size_t>(a) * static_cast<std::size_t>(b); };
  const std::size_t found = product(rows, columns) / static_cast<std::size_t>(kPeak) + 1;
  // A list that grows is there twice for a moment, once with twice the capacity.
  return {std::min(found, most),
          product(cubemap ? (columns + 1) / 2 : rows, cubemap ? (columns + 1) / 2 : 1) * sizeof(double) +
              product(bands, across) * sizeof(Cell) + 3 * found * sizeof(BrightTexel)};
}

std::vector<BrightTexel> find_bright_texels(const projection::SanitizedSource& source, double alpha, std::size_t most,
                                            const Control& control) {
  const Search search(source, alpha);
  std::vector<int> bands;
  for (int band = 0; band < search.bands(); ++band) {
    if (search.may_be_bright(band)) bands.push_back(band);
  }
  if (bands.empty()) return {};
  platform::AlignedBuffer<Cell> buffer(search.cells());
  const std::span<Cell> cells(buffer.data(), buffer.size());
  std::fill(cells.begin(), cells.end(), Cell());
  const auto placement = jobs::placement_for(static_cast<std::int64_t>(source.rows()) * source.columns());
  jobs::run_tiles(bands.size(), placement, jobs::worker_count(placement), control,
                  [&](std::size_t tile, std::size_t /*worker*/) { search.measure(bands[tile], cells); });
  std::vector<BrightTexel> found;
  bool bright = false;
  for (const int band : bands) bright = search.collect(band, cells, found) || bright;
  if (!bright) return {};
  if (found.size() > most) {
    const auto peak = [](const BrightTexel& texel) { return *platform::ranges::max_element(texel.excess); };
    platform::ranges::stable_sort(found, [&](const BrightTexel& a, const BrightTexel& b) { return peak(a) > peak(b); });
    found.resize(most);
    platform::ranges::sort(found, [](const BrightTexel& a, const BrightTexel& b) {
      return a.row != b.row ? a.row < b.row : a.column < b.column;
    });
  }
  search.part(found);
  return found;
}

double mean_excess(const std::vector<BrightTexel>& texels) noexcept {
  glm::dvec3 sum(0.0);
  for (const BrightTexel& texel : texels) sum += texel.light();
  return glm::length(sum) / (4.0 * kPi);
}

}  // namespace welkin::reflections
