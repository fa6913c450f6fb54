// Pixels of numpy's, where they lie, as views of the library's.
#pragma once

#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>

#include <cstddef>
#include <utility>
#include <variant>
#include <vector>

#include "options.h"
#include "welkin/bake.h"
#include "welkin/image.h"

namespace welkin::python {

/// An environment in arrays, which it keeps alive.
class Source {
 public:
  std::variant<CubemapView, LatLongView> view;

  /// What holds the pixels.
  py::object keeps;
  /// The last face of a vertical cross, which lies there turned by half a turn and is the only thing that is copied.
  std::vector<std::byte> turned_face;

  /// `work(view)` of whichever view it is.
  template <class Work>
  decltype(auto) visit(Work&& work) const {
    return std::visit(std::forward<Work>(work), view);
  }

  [[nodiscard]] bool is_cubemap() const noexcept { return std::holds_alternative<CubemapView>(view); }
  [[nodiscard]] SourceShape shape() const {
    return visit([](const auto& pixels) { return shape_of(pixels); });
  }
};

/// Takes
/// - (height, width, channels): a lat-long, or what `layout` says (strips and crosses);
/// - (6, size, size, channels), or six arrays (size, size, channels): a cubemap's faces;
/// - an object with `pixels`: an `Environment`, a `Chain`;
/// - a file, by its path or as bytes, which is read by `read` of the options.
/// Channels are 3 or 4, values float32, float16 or uint8; of bytes `encoding` says whether they are "linear" or "srgb".
/// Takes `layout` and `encoding` from the options. Throws `Error` (invalid_argument) for all else: nothing is
/// converted.
[[nodiscard]] Source source_of(const py::object& pixels, Options& options);

/// The same for pixels without options, RGB floats as the library makes them.
[[nodiscard]] Source source_of(const py::object& pixels);

/// Of a shape alone, (height, width, channels) or (6, size, size, channels), as halves.
[[nodiscard]] SourceShape shape_of_tuple(const py::tuple& shape);

}  // namespace welkin::python
