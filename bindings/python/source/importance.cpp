// Tables by which a path tracer picks directions.
#include "welkin/importance.h"

#include <pybind11/stl.h>

#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "arrays.h"
#include "bindings.h"
#include "call.h"
#include "results.h"
#include "source.h"

namespace welkin::python {
namespace {

constexpr Named<ImportanceWeight> kWeights[] = {{"luminance", ImportanceWeight::luminance},
                                                {"mean", ImportanceWeight::mean},
                                                {"largest", ImportanceWeight::largest}};

/// A table that arrays look at, too.
struct SharedImportance {
  std::shared_ptr<const ImportanceTable> table;
};

LatLongView lat_long_of(const Source& source, const char* function) {
  if (source.is_cubemap()) {
    throw Error(ErrorCode::invalid_argument,
                std::string(function) + ": takes a lat-long, found a cubemap; welkin.to_lat_long makes one of it");
  }
  return source.view.lat_long();
}

SharedImportance table_of(const py::object& pixels, const py::kwargs& given) {
  Options options("importance_table", given);
  const Source source = source_of(pixels, options);
  ImportanceOptions how;
  options.read("width", how.width);
  options.read("height", how.height);
  options.read("weight", how.weight, kWeights);
  options.read("mis_compensation", how.mis_compensation);
  options.read("policy", how.pixels);
  Call call("importance_table", options);
  options.finish();
  const LatLongView view = lat_long_of(source, "importance_table");
  return {std::make_shared<const ImportanceTable>(
      call.run([&](const Control& control) { return importance_table(view, how, control); }))};
}

py::array part_of(const SharedImportance& self, const std::vector<float>& values, std::vector<py::ssize_t> shape) {
  return shown(std::move(shape), values.data(), keeper(self.table), false);
}

using Numbers = py::array_t<double, py::array::c_style | py::array::forcecast>;

std::vector<py::ssize_t> shape_of_array(const py::array& array) {
  return {array.shape(), array.shape() + array.ndim()};
}

py::tuple sampled(const SharedImportance& self, const Numbers& across, const Numbers& down) {
  std::vector<py::ssize_t> shape = shape_of_array(across);
  if (shape != shape_of_array(down)) {
    throw Error(ErrorCode::invalid_argument, "sample: across and down must have one shape");
  }
  py::array_t<double> densities(shape);
  shape.push_back(3);
  py::array_t<double> directions(shape);
  double* const density = densities.mutable_data();
  double* const direction = directions.mutable_data();
  const auto count = static_cast<std::size_t>(across.size());
  const double* const u = across.data();
  const double* const v = down.data();
  {
    const LockReleased released(count);
    for (std::size_t index = 0; index < count; ++index) {
      const ImportanceSample found = self.table->sample(u[index], v[index]);
      density[index] = found.density;
      std::copy_n(&found.direction.x, 3, direction + 3 * index);
    }
  }
  return py::make_tuple(directions, densities);
}

py::array densities_at(const SharedImportance& self, const py::object& directions) {
  const Directions asked = directions_of(directions, "directions");
  py::array_t<double> densities(std::vector<py::ssize_t>(asked.shape.begin(), asked.shape.end() - 1));
  double* const density = densities.mutable_data();
  const LockReleased released(asked.count());
  for (std::size_t index = 0; index < asked.count(); ++index) density[index] = self.table->density(asked.at(index));
  return densities;
}

py::tuple alias_of(const SharedImportance& self, const py::kwargs& given) {
  Options options("ImportanceTable.alias", given);
  Call call("alias", options);
  options.finish();
  AliasTable made = call.run([&](const Control& control) { return alias_table(*self.table, control); });
  const py::ssize_t height = self.table->height;
  const py::ssize_t width = self.table->width;
  return py::make_tuple(owning(std::move(made.rows), {height}), owning(std::move(made.columns), {height, width}));
}

py::list pyramid_of(const SharedImportance& self, const py::kwargs& given) {
  Options options("ImportanceTable.pyramid", given);
  Call call("pyramid", options);
  options.finish();
  ImportancePyramid made = call.run([&](const Control& control) { return importance_pyramid(*self.table, control); });
  py::list levels;
  for (ImportancePyramid::Level& level : made.levels) {
    levels.append(owning(std::move(level.probabilities), {level.height, level.width}));
  }
  return levels;
}

py::tuple variance_of(const SharedImportance& self, const py::object& pixels, const py::kwargs& given) {
  Options options("ImportanceTable.variance", given);
  const Source source = source_of(pixels, options);
  ImportanceWeight weight = ImportanceWeight::luminance;
  PixelPolicy policy;
  options.read("weight", weight, kWeights);
  options.read("policy", policy);
  Call call("variance", options);
  options.finish();
  const LatLongView view = lat_long_of(source, "variance");
  const ImportanceVariance found =
      call.run([&](const Control& control) { return importance_variance(view, *self.table, weight, policy, control); });
  return py::make_tuple(found.uniform, found.table);
}

}  // namespace

void bind_importance(py::module_& module) {
  PYBIND11_NUMPY_DTYPE(AliasEntry, own, other);
  py::class_<SharedImportance>(module, "ImportanceTable",
                               "A density over the sphere, constant per solid angle within each texel of a lat-\n"
                               "long. Arrays are read-only views of the table's memory, laid out as pbrt's\n"
                               "PiecewiseConstant2D.")
      .def_property_readonly(
          "width", [](const SharedImportance& self) { return self.table->width; }, "Texels.")
      .def_property_readonly(
          "height", [](const SharedImportance& self) { return self.table->height; }, "Texels.")
      .def_property_readonly(
          "function",
          [](const SharedImportance& self) {
            return part_of(self, self.table->function, {self.table->height, self.table->width});
          },
          "(height, width) float32: integral of the weight over each texel; divided by `integral`, its\n"
          "probability.")
      .def_property_readonly(
          "row_cdf",
          [](const SharedImportance& self) { return part_of(self, self.table->row_cdf, {self.table->height + 1}); },
          "(height + 1,) float32: probability of the rows above each.")
      .def_property_readonly(
          "column_cdf",
          [](const SharedImportance& self) {
            return part_of(self, self.table->column_cdf, {self.table->height, self.table->width + 1});
          },
          "(height, width + 1) float32: probability within a row of the columns before each.")
      .def_property_readonly(
          "integral", [](const SharedImportance& self) { return self.table->integral; }, "The sum of `function`.")
      .def("sample", &sampled, py::arg("across"), py::arg("down"),
           "sample(self, across, down)\n"
           "--\n\n"
           "Returns (directions (..., 3), densities (...)) for numbers in [0, 1) of shape (...): `down` selects\n"
           "the row, `across` the column. Densities are per steradian.")
      .def("density", &densities_at, py::arg("directions"),
           "density(self, directions)\n"
           "--\n\n"
           "Returns the density per steradian at directions (..., 3): (...).")
      .def("alias", &alias_of,
           "alias(self, *, progress=None, threads=None)\n"
           "--\n\n"
           "Returns (rows (height,), columns (height, width)): alias tables with the same probabilities, for\n"
           "sampling in constant time. Fields: own (float32), the probability of the entry itself, and other\n"
           "(uint32), the index used otherwise.")
      .def("pyramid", &pyramid_of,
           "pyramid(self, *, progress=None, threads=None)\n"
           "--\n\n"
           "Returns probabilities of blocks, (height, width) float32, each level half the size of the one before,\n"
           "down to one block.")
      .def("variance", &variance_of, py::arg("pixels"),
           "variance(self, pixels, *, weight='luminance', policy=None, layout=None, encoding=None, read=None, "
           "progress=None,\n"
           "         threads=None)\n"
           "--\n\n"
           "Returns (uniform, table): the variance of a one-sample estimate of the pixels' total weight, relative\n"
           "to the square of the total, for uniform directions and for the table.")
      .def("__repr__", [](const SharedImportance& self) {
        return "<welkin.ImportanceTable: " + std::to_string(self.table->width) + " x " +
               std::to_string(self.table->height) + ">";
      });
  module.def(
      "importance_table", &table_of, py::arg("pixels"),
      "importance_table(pixels, *, width=0, height=0, weight='luminance', mis_compensation=False, policy=None,\n"
      "                 layout=None, encoding=None, read=None, progress=None, threads=None)\n"
      "--\n\n"
      "Computes a table for sampling directions of a lat-long. Returns an `ImportanceTable`. `width`,\n"
      "`height`: at most the image's; 0: the image's. `weight`: \"luminance\", or \"mean\" or \"largest\" of the\n"
      "channels. `mis_compensation`: subtracts the mean, for estimators that also sample the material.");
}

}  // namespace welkin::python
