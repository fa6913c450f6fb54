#include "source.h"

#include <array>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <limits>
#include <memory>
#include <optional>
#include <string>

#include "arrays.h"
#include "call.h"
#include "files.h"
#include "welkin/environment_file.h"

namespace welkin::python {
namespace {

[[noreturn]] void refuse(const std::string& what) { throw Error(ErrorCode::invalid_argument, "pixels: " + what); }

std::string shape_words(const py::array& array) { return py::str(array.attr("shape")).cast<std::string>(); }

constexpr int kHalf = 23;  // numpy's number of float16, for which C has no type
constexpr int kFloat = py::detail::npy_api::NPY_FLOAT_;
constexpr int kByte = py::detail::npy_api::NPY_UBYTE_;

PixelFormat format_of_bytes(bool alpha, const std::string& encoding) {
  if (encoding == "linear") return alpha ? PixelFormat::rgba8 : PixelFormat::rgb8;
  if (encoding == "srgb") return alpha ? PixelFormat::srgba8 : PixelFormat::srgb8;
  refuse(encoding.empty() ? "of uint8 need an encoding: encoding=\"srgb\" (images) or \"linear\""
                          : "encoding=\"" + encoding + "\" is none of \"srgb\", \"linear\"");
}

PixelFormat format_of(const py::array& array, const std::string& encoding) {
  const py::ssize_t channels = array.shape(array.ndim() - 1);
  if (channels != 3 && channels != 4) {
    refuse("the last dimension is red, green, blue and perhaps alpha, 3 or 4; found shape " + shape_words(array));
  }
  const bool alpha = channels == 4;
  const py::dtype type = array.dtype();
  const bool native = type.byteorder() == '=' || type.byteorder() == '|';
  if (native && type.num() == kByte) return format_of_bytes(alpha, encoding);
  if (!encoding.empty() && encoding != "linear")
    refuse("encoding=\"" + encoding + "\" is for uint8; floats are linear");
  if (native && type.num() == kFloat) return alpha ? PixelFormat::rgba32f : PixelFormat::rgb32f;
  if (native && type.num() == kHalf) return alpha ? PixelFormat::rgba16f : PixelFormat::rgb16f;
  refuse("are float32, float16 or uint8 in the machine's byte order, found " +
         py::str(type.attr("str")).cast<std::string>() + "; pixels.astype(numpy.float32) makes a copy that is");
}

/// Where the rows of an image lie.
struct Rows {
  const std::byte* first;
  py::ssize_t stride;  ///< bytes
  int height;
  int width;
  py::ssize_t texel;  ///< bytes
  PixelFormat format;

  [[nodiscard]] const std::byte* at(py::ssize_t column, py::ssize_t row) const {
    return first + row * stride + column * texel;
  }
};

/// Dimensions `axis` (rows), `axis + 1` and channels of an array whose texels are packed along rows.
Rows rows_of(const py::array& array, py::ssize_t axis, PixelFormat format) {
  const py::ssize_t item = array.itemsize();
  const py::ssize_t height = array.shape(axis);
  const py::ssize_t width = array.shape(axis + 1);
  const auto texel = static_cast<py::ssize_t>(bytes_per_texel(format));
  const bool packed = array.strides(axis + 2) == item && (width == 1 || array.strides(axis + 1) == texel);
  const py::ssize_t stride = height > 1 ? array.strides(axis) : width * texel;
  const auto* const first = static_cast<const std::byte*>(array.data());
  if (height > std::numeric_limits<int>::max() || width > std::numeric_limits<int>::max()) {
    refuse("has more than 2^31 - 1 rows or columns: shape " + shape_words(array));
  }
  // Rows that lie in one another are as good as none that lie packed.
  const bool apart = std::abs(stride) >= width * texel;
  const bool aligned =
      reinterpret_cast<std::uintptr_t>(first) % static_cast<std::uintptr_t>(item) == 0 && stride % item == 0;
  if (array.size() > 0 && packed && !aligned) {
    refuse("values must lie at multiples of their " + std::to_string(item) +
           " bytes; numpy.array(pixels) makes a copy that does");
  }
  if (array.size() > 0 && (!packed || !apart)) {
    refuse(
        "channels and the texels of a row must lie packed in memory (rows may lie apart, or bottom-up); found "
        "strides " +
        py::str(array.attr("strides")).cast<std::string>() + " of shape " + shape_words(array) +
        "; numpy.ascontiguousarray(pixels) makes a copy that does");
  }
  return {first, stride, static_cast<int>(height), static_cast<int>(width), texel, format};
}

CubemapView cubemap_of_faces(const py::array& array, PixelFormat format) {
  if (array.shape(0) != 6 || array.shape(1) != array.shape(2)) {
    refuse("of four dimensions are six square faces, (6, n, n, channels); found shape " + shape_words(array));
  }
  const Rows rows = rows_of(array, 1, format);
  CubemapView view{{}, rows.width, rows.stride, format};
  for (std::size_t face = 0; face < view.faces.size(); ++face) {
    view.faces[face] = rows.first + static_cast<py::ssize_t>(face) * array.strides(0);
  }
  if (reinterpret_cast<std::uintptr_t>(view.faces[1]) % static_cast<std::uintptr_t>(array.itemsize()) != 0) {
    refuse("faces must be aligned to their values");
  }
  return view;
}

/// How an image in a layout is cut into faces: its size in faces, and where each face lies.
struct Cut {
  Layout layout;
  int columns;
  int rows;
  std::array<std::array<int, 2>, 6> places;  ///< column and row, in faces
};

constexpr std::array<Cut, 4> kCuts = {{
    {Layout::vertical_strip, 1, 6, {{{0, 0}, {0, 1}, {0, 2}, {0, 3}, {0, 4}, {0, 5}}}},
    {Layout::horizontal_strip, 6, 1, {{{0, 0}, {1, 0}, {2, 0}, {3, 0}, {4, 0}, {5, 0}}}},
    {Layout::horizontal_cross, 4, 3, {{{2, 1}, {0, 1}, {1, 0}, {1, 2}, {1, 1}, {3, 1}}}},
    {Layout::vertical_cross, 3, 4, {{{2, 1}, {0, 1}, {1, 0}, {1, 2}, {1, 1}, {1, 3}}}},
}};

/// The face at a place, turned by half a turn, with the rows of the image: the faces of a view have one stride.
std::vector<std::byte> turned_face(const Rows& image, const std::byte* face, int size) {
  const py::ssize_t stride = image.stride > 0 ? image.stride : -image.stride;
  std::vector<std::byte> rotated(static_cast<std::size_t>(stride * size));
  const auto texel = static_cast<std::size_t>(image.texel);
  for (py::ssize_t row = 0; row < size; ++row) {
    // Rows of an image that lies bottom-up go up in memory here too.
    const py::ssize_t place = image.stride > 0 ? row : size - 1 - row;
    for (py::ssize_t column = 0; column < size; ++column) {
      const std::byte* const from = face + (size - 1 - row) * image.stride + (size - 1 - column) * image.texel;
      std::memcpy(rotated.data() + place * stride + column * image.texel, from, texel);
    }
  }
  return rotated;
}

Source cubemap_of_image(const py::array& array, const Cut& cut, PixelFormat format) {
  const Rows rows = rows_of(array, 0, format);
  const int size = rows.width / cut.columns;
  if (size < 1 || size * cut.columns != rows.width || size * cut.rows != rows.height) {
    refuse("layout=\"" + std::string(name(cut.layout)) + "\" is " + std::to_string(cut.columns) + " n x " +
           std::to_string(cut.rows) + " n texels, found " + std::to_string(rows.width) + " x " +
           std::to_string(rows.height));
  }
  CubemapView view{{}, size, rows.stride, format};
  for (std::size_t face = 0; face < view.faces.size(); ++face) {
    view.faces[face] = rows.at(py::ssize_t{cut.places[face][0]} * size, py::ssize_t{cut.places[face][1]} * size);
  }
  Source source{view, array, {}};
  if (cut.layout == Layout::vertical_cross) {
    source.turned_face = turned_face(rows, static_cast<const std::byte*>(view.faces[5]), size);
    const py::ssize_t top = rows.stride > 0 ? 0 : -rows.stride * (size - 1);
    view.faces[5] = source.turned_face.data() + top;
    source.view = view;
  }
  return source;
}

Source source_of_image(const py::array& array, const std::string& layout, PixelFormat format) {
  if (layout.empty() || layout == name(Layout::lat_long)) {
    const Rows rows = rows_of(array, 0, format);
    return {LatLongView{rows.first, rows.width, rows.height, rows.stride, format}, array, {}};
  }
  std::string names = std::string("\"") + name(Layout::lat_long) + '"';
  for (const Cut& cut : kCuts) {
    if (layout == name(cut.layout)) return cubemap_of_image(array, cut, format);
    names += std::string(", \"") + name(cut.layout) + '"';
  }
  refuse("layout=\"" + layout + "\" is none of " + names);
}

Source source_of_array(const py::array& array, const std::string& layout, const std::string& encoding) {
  if (array.ndim() != 3 && array.ndim() != 4) {
    refuse("are (height, width, channels) or (6, n, n, channels), found shape " + shape_words(array));
  }
  const PixelFormat format = format_of(array, encoding);
  if (array.ndim() == 3) return source_of_image(array, layout, format);
  if (!layout.empty()) refuse("layout is for arrays of three dimensions, found shape " + shape_words(array));
  return {cubemap_of_faces(array, format), array, {}};
}

/// Six arrays, a face each, wherever they lie.
Source source_of_list(const py::tuple& list, const std::string& encoding) {
  if (list.size() != 6) refuse("a list is of six faces, found " + std::to_string(list.size()));
  std::optional<CubemapView> view;
  for (std::size_t face = 0; face < 6; ++face) {
    const py::object item = list[face];
    if (!py::isinstance<py::array>(item)) refuse("faces are numpy arrays");
    const auto array = py::reinterpret_borrow<py::array>(item);
    if (array.ndim() != 3 || array.shape(0) != array.shape(1)) {
      refuse("a face is (n, n, channels), found shape " + shape_words(array));
    }
    const PixelFormat format = format_of(array, encoding);
    const Rows rows = rows_of(array, 0, format);
    if (!view) view = CubemapView{{}, rows.width, rows.stride, format};
    if (rows.width != view->size || rows.stride != view->row_stride_bytes || format != view->format) {
      refuse("six faces must have the same size, type and strides; face " + std::to_string(face) + " differs");
    }
    view->faces[face] = rows.first;
  }
  return {*view, list, {}};
}

Source source_of(const py::object& pixels, const std::string& layout, const std::string& encoding) {
  if (py::isinstance<py::array>(pixels)) {
    return source_of_array(py::reinterpret_borrow<py::array>(pixels), layout, encoding);
  }
  if (py::isinstance<py::list>(pixels) || py::isinstance<py::tuple>(pixels)) {
    return source_of_list(py::tuple(pixels), encoding);  // which holds the arrays, whatever becomes of a list
  }
  if (py::hasattr(pixels, "pixels")) {
    const py::object inner = pixels.attr("pixels");
    const bool is_known =
        py::isinstance<py::array>(inner) || py::isinstance<py::list>(inner) || py::isinstance<py::tuple>(inner);
    if (is_known) return source_of(inner, layout, encoding);
  }
  throw py::type_error(
      "pixels are a numpy array, six of them, a file's path or bytes, or what welkin.read gave; found " +
      py::str(py::type::handle_of(pixels).attr("__name__")).cast<std::string>());
}

/// A file's pixels, read whole.
Source source_of_file(const py::object& file, Options& options) {
  const FileInput input = input_of(file);
  const ReadOptions how = read_group(options);
  const py::dict nothing;
  Options of_reading("read", nothing);
  Call call("read", of_reading);
  auto read = std::make_shared<const Environment>(
      call.run([&](const Control& control) { return read_environment(input, how, control); }));
  const py::capsule owner = keeper(read);
  if (read->face_size() > 0) return {read->cubemap(), owner, {}};
  return {read->lat_long(), owner, {}};
}

}  // namespace

Source source_of(const py::object& pixels, Options& options) {
  if (is_file(pixels)) return source_of_file(pixels, options);
  std::string layout;
  std::string encoding;
  options.read("layout", layout);
  options.read("encoding", encoding);
  return source_of(pixels, layout, encoding);
}

Source source_of(const py::object& pixels) { return source_of(pixels, {}, {}); }

SourceShape shape_of_tuple(const py::tuple& shape) {
  const auto at = [&](std::size_t index) { return shape[index].cast<int>(); };
  if (shape.size() == 3) return {.cubemap = false, .columns = at(1), .rows = at(0), .format = PixelFormat::rgb16f};
  if (shape.size() == 4 && at(0) == 6 && at(1) == at(2)) {
    return {.cubemap = true, .columns = at(1), .rows = 6 * at(1), .format = PixelFormat::rgb16f};
  }
  throw Error(ErrorCode::invalid_argument, "a shape is (height, width, channels) or (6, n, n, channels), found " +
                                               py::repr(shape).cast<std::string>());
}

}  // namespace welkin::python
