// Finds the placement of a chain's faces and channels by comparing small images.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <glm/mat3x3.hpp>
#include <glm/vec3.hpp>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include "image/geometry.h"
#include "tools/chain_check.h"
#include "tools/text.h"
#include "welkin/engines.h"
#include "welkin/image.h"
#include "welkin/resampling.h"

namespace welkin::tool {

CubeTexel shown_by(const FaceMapping& mapping, int size, int column, int row) {
  if (mapping.transposed) std::swap(column, row);
  return {mapping.face, mapping.columns_mirrored ? size - 1 - column : column,
          mapping.rows_mirrored ? size - 1 - row : row};
}

namespace {

constexpr int kSymmetries = 8;              // of a square
constexpr int kMappings = 6 * kSymmetries;  // of one face
constexpr double kNearlyAsGood = 1.2;

FaceMapping mapping_at(int index) {
  return {index / kSymmetries, (index & 1) != 0, (index & 2) != 0, (index & 4) != 0};
}

std::size_t index_of(const FaceMapping& mapping) {
  return static_cast<std::size_t>(kSymmetries * mapping.face + (mapping.columns_mirrored ? 1 : 0) +
                                  (mapping.rows_mirrored ? 2 : 0) + (mapping.transposed ? 4 : 0));
}

/// Returns all faces' placements if direction d shows matrix * d. The matrix is one of a cube's 48 symmetries.
std::array<FaceMapping, 6> faces_of(const glm::dmat3& matrix) {
  constexpr int kSize = 2;
  std::array<FaceMapping, 6> faces{};
  for (int face = 0; face < 6; ++face) {
    const auto shown = [&](int column, int row) {
      const glm::dvec3 point(image::point_of(kSize, {face, column, row}));
      return image::texel_at(kSize, glm::ivec3(glm::round(matrix * point)));
    };
    // The first texel's neighbours are to its right and below it, unless the face is mirrored or transposed.
    const CubeTexel first = shown(0, 0);
    const CubeTexel right = shown(1, 0);
    const CubeTexel below = shown(0, 1);
    faces[static_cast<std::size_t>(face)] = {first.face, right.column + below.column < 2 * first.column,
                                             right.row + below.row < 2 * first.row, right.column == first.column};
  }
  return faces;
}

/// Returns all 48 symmetries: permutations of the axes with signs, the identity first.
std::vector<glm::dmat3> cube_symmetries() {
  std::vector<glm::dmat3> symmetries;
  std::array<int, 3> axes = {0, 1, 2};
  do {
    for (int signs = 0; signs < 8; ++signs) {
      glm::dmat3 matrix(0.0);
      for (int axis = 0; axis < 3; ++axis) {
        matrix[axis][axes[static_cast<std::size_t>(axis)]] = (signs >> axis & 1) != 0 ? -1.0 : 1.0;
      }
      symmetries.push_back(matrix);
    }
  } while (std::next_permutation(axes.begin(), axes.end()));
  return symmetries;
}

/// Returns channels compressed to x / (x + median): differences of a lamp and of a wall count equally, and a clipped
/// sun does not change the rest.
std::vector<glm::dvec3> compressed(const Cubemap& image) {
  const std::span<const float> values = image.pixels();
  std::vector<float> sorted(values.begin(), values.end());
  const auto middle = sorted.begin() + static_cast<std::ptrdiff_t>(sorted.size() / 2);
  std::nth_element(sorted.begin(), middle, sorted.end());
  const double median = std::max(static_cast<double>(*middle), 1e-30);
  std::vector<glm::dvec3> texels(values.size() / 3);
  for (std::size_t i = 0; i < texels.size(); ++i) {
    for (int channel = 0; channel < 3; ++channel) {
      const double x = values[3 * i + static_cast<std::size_t>(channel)];
      texels[i][channel] = x > 0.0 ? x / (x + median) : 0.0;
    }
  }
  return texels;
}

/// Squared differences between each face of the image and each face of the reference in each placement.
class Differences {
 public:
  Differences(const std::vector<glm::dvec3>& image, const std::vector<glm::dvec3>& truth, int size) {
    for (int face = 0; face < 6; ++face) {
      for (int index = 0; index < kMappings; ++index) {
        squares_[static_cast<std::size_t>(face)][static_cast<std::size_t>(index)] =
            compare(image, truth, size, face, mapping_at(index));
      }
    }
  }

  [[nodiscard]] double of(const std::array<FaceMapping, 6>& faces) const {
    double sum = 0.0;
    for (std::size_t face = 0; face < 6; ++face) sum += squares_[face][index_of(faces[face])];
    return sum;
  }

  /// Returns the best placement of each face by itself.
  [[nodiscard]] std::array<FaceMapping, 6> each() const {
    std::array<FaceMapping, 6> faces{};
    for (std::size_t face = 0; face < 6; ++face) {
      const auto* const minimum = std::ranges::min_element(squares_[face]);
      faces[face] = mapping_at(static_cast<int>(minimum - squares_[face].begin()));
    }
    return faces;
  }

 private:
  // Compares the sums of channels, which do not depend on their order.
  static double compare(const std::vector<glm::dvec3>& image, const std::vector<glm::dvec3>& truth, int size, int face,
                        const FaceMapping& mapping) {
    double sum = 0.0;
    for (int row = 0; row < size; ++row) {
      for (int column = 0; column < size; ++column) {
        const CubeTexel shown = shown_by(mapping, size, column, row);
        const auto index = [&](int of_face, int i, int j) {
          return static_cast<std::size_t>((of_face * size + j) * size + i);
        };
        const glm::dvec3 difference =
            image[index(face, column, row)] - truth[index(shown.face, shown.column, shown.row)];
        const double total = difference.x + difference.y + difference.z;
        sum += total * total;
      }
    }
    return sum;
  }

  std::array<std::array<double, kMappings>, 6> squares_{};
};

/// Returns the channel order nearest to the reference; the unchanged order unless another halves the difference.
std::array<int, 3> channels_of(const std::vector<glm::dvec3>& image, const std::vector<glm::dvec3>& truth, int size,
                               const std::array<FaceMapping, 6>& faces) {
  const auto differences = [&](const std::array<int, 3>& channels) {
    double sum = 0.0;
    for (std::size_t i = 0; i < image.size(); ++i) {
      const int column = static_cast<int>(i) % size;
      const int row = static_cast<int>(i) / size % size;
      const CubeTexel shown = shown_by(faces[i / static_cast<std::size_t>(size * size)], size, column, row);
      const glm::dvec3& from = truth[static_cast<std::size_t>((shown.face * size + shown.row) * size + shown.column)];
      for (int channel = 0; channel < 3; ++channel) {
        const double difference = image[i][channel] - from[channels[static_cast<std::size_t>(channel)]];
        sum += difference * difference;
      }
    }
    return sum;
  };
  const std::array<int, 3> same = {0, 1, 2};
  std::array<int, 3> best = same;
  double minimum = differences(same) / 2.0;
  std::array<int, 3> order = same;
  while (std::next_permutation(order.begin(), order.end())) {
    if (const double sum = differences(order); sum < minimum) {
      minimum = sum;
      best = order;
    }
  }
  return best;
}

std::string axis_words(const glm::dvec3& axis) {
  for (int i = 0; i < 3; ++i) {
    if (std::abs(axis[i]) > 0.5) return std::string(axis[i] < 0.0 ? "-" : "+") + "xyz"[i];
  }
  return "?";
}

std::string mapping_words(const FaceMapping& mapping) {
  std::string text = face_name(mapping.face);
  if (mapping.transposed) text += " transposed";
  if (mapping.columns_mirrored && mapping.rows_mirrored) return text + " rotated by 180 degrees";
  if (mapping.columns_mirrored) text += " with columns mirrored";
  if (mapping.rows_mirrored) text += " with rows mirrored";
  return text;
}

std::string matrix_words(const glm::dmat3& matrix) {
  const glm::dmat3 identity(1.0);
  for (int axis = 0; axis < 3; ++axis) {
    glm::dmat3 mirror = identity;
    mirror[axis][axis] = -1.0;
    if (matrix == mirror) return std::string("mirrored in ") + "xyz"[axis];
  }
  for (const int degrees : {90, 180, 270}) {
    // Direction d shows `matrix` d, so the surroundings rotate the other way.
    const glm::dmat3 rotation = rotation_about_y(-degrees);
    if (matrix == glm::dmat3(glm::round(rotation[0]), glm::round(rotation[1]), glm::round(rotation[2]))) {
      return "rotated by " + std::to_string(degrees) + " degrees about y";
    }
  }
  return "+x, +y and +z show the source's " + axis_words(matrix[0]) + ", " + axis_words(matrix[1]) + " and " +
         axis_words(matrix[2]);
}

/// Returns ", as Babylon.js has them" if engines store faces so.
std::string engine_words(const glm::dmat3& matrix) {
  std::vector<std::string> engines;
  for (const Convention& each : conventions()) {
    if (!each.faces_from_engine) continue;
    if (glm::transpose(*each.faces_from_engine * each.from_welkin) == matrix) engines.emplace_back(each.title);
  }
  return engines.empty() ? "" : ", as " + joined(engines, " and ") + (engines.size() > 1 ? " have them" : " has them");
}

}  // namespace

bool ChainPlacement::is_identity() const {
  return matrix && *matrix == glm::dmat3(1.0) && channels == std::array{0, 1, 2};
}

PlacementFit placement_of(const Cubemap& image, const Cubemap& truth) {
  const int size = image.size();
  const std::vector<glm::dvec3> compared = compressed(image);
  const std::vector<glm::dvec3> source = compressed(truth);
  const Differences differences(compared, source, size);
  const std::array<FaceMapping, 6> each = differences.each();
  const double rounding = 1e-6 * static_cast<double>(source.size());
  const auto is_as_good_as = [&](double squares, double best) { return squares <= kNearlyAsGood * best + rounding; };

  ChainPlacement placement{each, std::nullopt};
  double minimum = std::numeric_limits<double>::max();
  const std::vector<glm::dmat3> symmetries = cube_symmetries();
  const double as_it_is = differences.of(faces_of(symmetries.front()));
  for (const glm::dmat3& matrix : symmetries) {
    const std::array<FaceMapping, 6> faces = faces_of(matrix);
    const double squares = differences.of(faces);
    if (squares >= minimum || !is_as_good_as(squares, differences.of(each))) continue;
    minimum = squares;
    placement.faces = faces;
    placement.matrix = matrix;
  }
  if (is_as_good_as(as_it_is, std::min(minimum, differences.of(each)))) {
    placement.faces = faces_of(symmetries.front());
    placement.matrix = symmetries.front();
  }
  placement.channels = channels_of(compared, source, size, placement.faces);
  return {placement, differences.of(placement.faces)};
}

std::string words_of(const ChainPlacement& placement) {
  std::vector<std::string> words;
  if (!placement.matrix) {
    std::vector<std::string> faces;
    for (int face = 0; face < 6; ++face) {
      const FaceMapping& shown = placement.faces[static_cast<std::size_t>(face)];
      if (shown != FaceMapping{face}) faces.push_back(std::string(face_name(face)) + " shows " + mapping_words(shown));
    }
    words.push_back("faces do not fit together: " + joined(faces));
  } else if (*placement.matrix != glm::dmat3(1.0)) {
    words.push_back(matrix_words(*placement.matrix) + engine_words(*placement.matrix));
  }
  if (placement.channels != std::array{0, 1, 2}) {
    std::string order;
    for (const int channel : placement.channels) order += "RGB"[channel];
    words.push_back("channels in the order " + order);
  }
  return joined(words, "; ");
}

}  // namespace welkin::tool
