#include "tools/orientation.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <glm/matrix.hpp>
#include <utility>
#include <vector>

#include "welkin/core.h"
#include "welkin/resampling.h"

namespace welkin::tool {
namespace {

std::vector<std::pair<std::string, Engine>> engine_words() {
  std::vector<std::pair<std::string, Engine>> words;
  for (const Convention& each : conventions()) words.emplace_back(each.name, each.engine);
  return words;
}

// Entries that are whole but for rounding become whole: a quaternion of a quarter turn is then exact.
glm::dmat3 tidied(glm::dmat3 matrix) {
  constexpr double kRounding = 1e-15;
  for (int column = 0; column < 3; ++column) {
    for (int row = 0; row < 3; ++row) {
      const double whole = std::round(matrix[column][row]);
      if (std::abs(matrix[column][row] - whole) < kRounding) matrix[column][row] = whole;
    }
  }
  return matrix;
}

glm::dmat3 faces_matrix(const Convention& engine) {
  if (!engine.faces_from_engine) {
    throw Error(ErrorCode::invalid_argument,
                std::string(engine.title) + " has no cube faces of its own; use a lat-long, or another convention");
  }
  return *engine.faces_from_engine;
}

// From Welkin's axes to where a picture in the engine's convention holds a direction. A lat-long is the same picture
// for all of them: they differ in which of their axes its centre is, and from_welkin is just that. Cube faces are
// named after the engine's axes.
glm::dmat3 into_picture(Engine engine, bool cubemap) {
  const Convention& of = convention(engine);
  return cubemap ? faces_matrix(of) * of.from_welkin : glm::dmat3(1.0);
}

// Between what the file holds and what the result will, in Welkin's axes.
glm::dmat3 turn_in_welkin(const OrientationOptions& options, bool source_is_cubemap) {
  // Orthogonal: the transpose is the inverse.
  glm::dmat3 rotation = glm::transpose(into_picture(options.from, source_is_cubemap));
  if (options.mirror) rotation = glm::dmat3(-1, 0, 0, 0, 1, 0, 0, 0, 1) * rotation;
  return rotation_about_y(options.yaw_degrees) * glm::mat3_cast(options.rotation) * rotation;
}

void set_rotation(OrientationOptions& options, const std::vector<double>& values) {
  const glm::dquat quaternion(values[3], values[0], values[1], values[2]);
  const double length = glm::length(quaternion);
  if (!std::isfinite(length) || length == 0.0) {
    throw BadValue{"--rotation", "is not a rotation; pass a quaternion x,y,z,w of finite length above 0"};
  }
  options.rotation = quaternion / length;
}

}  // namespace

void add_engine_option(Options& table, OrientationOptions& options) {
  table.push_back(
      choice<Engine>("--for", options.to, engine_words(),
                     "Whose axes the result is in, so that the surroundings look the same there; default welkin"));
}

void add_orientation_options(Options& table, OrientationOptions& options) {
  table.push_back(choice<Engine>(
      "--from", options.from, engine_words(),
      "Whose axes the file's cube faces are named after; default welkin. (A lat-long is the same image for all)"));
  add_engine_option(table, options);
  add_option(table, "--yaw", &options.yaw_degrees, "DEGREES",
             "Rotate the environment about the vertical by DEGREES, counter-clockwise from above; default 0; 90 moves "
             "what was at +z to +x",
             {.bounds = number_between(-1e6, 1e6)});
  add_option(table, "--mirror", &options.mirror, "", "Mirror the environment left to right (x changes its sign)");
  const auto rotate = [&options](const std::vector<double>& values) { set_rotation(options, values); };
  add_option(table, "--rotation", On<std::vector<double>>(rotate), "X,Y,Z,W",
             "Rotate the environment by the quaternion X,Y,Z,W, before --yaw",
             {.list = List::commas_or_spaces, .count = 4});
  in_group(table, "Orientation");
}

glm::dmat3 light_rotation(const OrientationOptions& options, bool source_is_cubemap) {
  return tidied(convention(options.to).from_welkin * turn_in_welkin(options, source_is_cubemap));
}

glm::dmat3 picture_rotation(const OrientationOptions& options, bool source_is_cubemap, bool result_is_cubemap) {
  return tidied(into_picture(options.to, result_is_cubemap) * turn_in_welkin(options, source_is_cubemap));
}

std::string axes_text(const OrientationOptions& options) {
  const Convention& engine = convention(options.to);
  return std::string(engine.title) + "'s: " + engine.axes;
}

glm::dmat3 faces_of(Engine engine) {
  OrientationOptions options;
  options.to = engine;
  return picture_rotation(options, false, true);
}

Cubemap rotate(const Cubemap& chain, const glm::dmat3& symmetry, const Control& control) {
  if (chain.levels() == 0) return {};
  const Control quiet{control.stop, {}};
  Cubemap result(chain.size(), chain.levels());
  for (int level = 0; level < chain.levels(); ++level) {
    const Cubemap image = to_cubemap(chain.view(level), chain.level_size(level), symmetry, ResampleFilter::area, quiet);
    std::ranges::copy(image.pixels(), result.face(level, 0));
  }
  return result;
}

}  // namespace welkin::tool
