// Air cut into shells in which its extinction changes little: how much of it lies along rays.
#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <span>
#include <vector>

#include "reference/reference_air.h"

namespace welkin::sky {

class PathShells {
 public:
  using Columns = ReferenceAir::Columns;

  explicit PathShells(const ReferenceAir& air);

  [[nodiscard]] std::size_t count() const noexcept { return densest_.size(); }
  /// r^2 - R^2 of the lower bound of shell `i`, and of the top for i = count().
  [[nodiscard]] double square(std::size_t i) const noexcept { return squares_[i]; }
  /// The shell that r^2 - R^2 lies in.
  [[nodiscard]] std::size_t find(double square) const noexcept;
  /// Densities of all matter at a point of shell `i`.
  void densities(std::size_t i, double square, Columns& values) const noexcept;

  /// Metres at density 1 of each matter along a part of a ray within shell `i`: Gauss's rule of five points; the
  /// extinction changes by a factor of two at most, so that an optical depth's relative error is below 1e-6.
  [[nodiscard]] Columns columns(const AirRay& ray, std::size_t i, double from, double to) const noexcept;
  /// The same along a whole ray.
  [[nodiscard]] Columns columns(const AirRay& ray) const noexcept;

 private:
  void add_shells(double low, double high, int depth);
  void add_shell(double low, double high);
  [[nodiscard]] double densest(double low, double high, bool thinnest) const;
  [[nodiscard]] bool steep(double low, double high, double most) const;

  const ReferenceAir& air_;
  std::vector<double> bounds_;
  std::vector<double> squares_;
  std::vector<double> densest_;  ///< no extinction in a shell is above its own, 1/m
  std::vector<std::array<const DensityLayer*, ReferenceAir::kMaxConstituents>> layers_;
};

/// Walks a ray shell by shell.
class ShellWalk {
 public:
  ShellWalk(const PathShells& shells, const AirRay& ray) noexcept
      : shells_(shells), ray_(ray), shell_(shells.find(ray.square)), falling_(ray.slope < 0.0) {
    if (!falling_ && shell_ + 1 < shells.count() && ray.square >= shells.square(shell_ + 1)) ++shell_;
    set_end();
  }

  [[nodiscard]] std::size_t shell() const noexcept { return shell_; }
  [[nodiscard]] double end() const noexcept { return end_; }
  /// The last shell of the ray.
  [[nodiscard]] bool last() const noexcept { return falling_ ? shell_ == 0 : shell_ + 1 == shells_.count(); }

  void next() noexcept {
    shell_ = falling_ ? shell_ - 1 : shell_ + 1;
    set_end();
  }

 private:
  void set_end() noexcept {
    const double start = end_;
    const double nearest = ray_.slope * ray_.slope - ray_.square;  // -(r^2 - R^2) at the lowest point
    if (falling_) {
      const double below = nearest + shells_.square(shell_);
      if (below > 0.0 && (shell_ > 0 || ray_.ground)) {
        end_ = -ray_.slope - std::sqrt(below);
        if (end_ < start) end_ = start;
        return;
      }
      falling_ = false;
    }
    if (last()) {
      end_ = ray_.length;
    } else {
      const double above = nearest + shells_.square(shell_ + 1);
      end_ = -ray_.slope + std::sqrt(above > 0.0 ? above : 0.0);
    }
    if (end_ > ray_.length) end_ = ray_.length;
    if (end_ < start) end_ = start;
  }

  const PathShells& shells_;
  AirRay ray_;
  std::size_t shell_;
  bool falling_;
  double end_ = 0.0;
};

}  // namespace welkin::sky
