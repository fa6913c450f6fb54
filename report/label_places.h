// Where words go beside points so that they do not lie on each other.
#pragma once

#include <optional>
#include <string>
#include <vector>

namespace welkin::report {

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

}  // namespace welkin::report
