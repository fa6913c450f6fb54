// Helpers of the tests of the C interface: images, structures, handles and comparisons.
#pragma once

#include "support/catch.h"
#include "support/same_bits.h"
#include "welkin/image.h"
#include "welkin/projection.h"
#include "welkin/spherical_harmonics.h"
#include "welkin/welkin.h"

namespace welkin::test {

// The tests' images as C callers describe them.

inline welkin_environment c_view(const CubemapView& view) {
  welkin_environment cubemap;
  WELKIN_INIT(cubemap);
  cubemap.format = static_cast<welkin_format>(view.format);
  cubemap.row_stride_bytes = view.row_stride_bytes;
  std::copy(view.faces.begin(), view.faces.end(), cubemap.faces);
  cubemap.size = view.size;
  return cubemap;
}

inline welkin_environment c_view(const LatLongView& view) {
  welkin_environment lat_long;
  WELKIN_INIT(lat_long);
  lat_long.format = static_cast<welkin_format>(view.format);
  lat_long.row_stride_bytes = view.row_stride_bytes;
  lat_long.faces[0] = view.pixels;
  lat_long.width = view.width;
  lat_long.height = view.height;
  return lat_long;
}

/// Returns a structure that is zero except for its size.
template <class Struct>
Struct c_struct() {
  Struct made;
  WELKIN_INIT(made);
  return made;
}

/// Returns the C description of the target's memory.
inline welkin_target c_target(const CubemapTarget& target, welkin_format format) {
  auto made = c_struct<welkin_target>();
  made.format = format;
  made.row_stride_bytes = target.row_stride_bytes;
  made.size = target.size;
  std::copy(target.faces.begin(), target.faces.end(), made.faces);
  return made;
}

/// Returns a target of six packed faces in one block of floats.
inline welkin_target c_target(std::vector<float>& texels, int size, welkin_format format = WELKIN_FORMAT_RGB_F32) {
  auto made = c_struct<welkin_target>();
  made.format = format;
  made.size = size;
  for (std::size_t face = 0; face < 6; ++face) made.faces[face] = texels.data() + face * texels.size() / 6;
  return made;
}

/// Handles of one kind, destroyed with their scope.
template <class Handle, void (*destroy)(Handle*)>
struct Destroyed {
  Handle* handle = nullptr;

  Destroyed() = default;
  explicit Destroyed(Handle* its_handle) : handle(its_handle) {}
  ~Destroyed() { destroy(handle); }
  Destroyed(const Destroyed&) = delete;
  Destroyed& operator=(const Destroyed&) = delete;
};
using CChain = Destroyed<welkin_chain, welkin_chain_destroy>;

/// A worker of `threads`, destroyed with its scope.
class CWorker {
 public:
  explicit CWorker(int threads) {
    auto options = c_struct<welkin_worker_options>();
    options.threads = threads;
    REQUIRE(welkin_worker_create(&options, &worker_) == WELKIN_OK);
  }
  ~CWorker() { welkin_worker_destroy(worker_); }
  CWorker(const CWorker&) = delete;
  CWorker& operator=(const CWorker&) = delete;

  [[nodiscard]] welkin_worker* get() const noexcept { return worker_; }

 private:
  welkin_worker* worker_ = nullptr;
};

// Results of the C interface equal those of the C++ calls bit for bit.

inline bool same_triple(const double* values, const glm::dvec3& expected) {
  return same_bits(values[0], expected.x) && same_bits(values[1], expected.y) && same_bits(values[2], expected.z);
}

inline void require_same_projection(const welkin_projection& light, const Projection& expected) {
  REQUIRE(light.bands == expected.radiance.bands());
  const auto coefficients = expected.radiance.coefficients();
  for (std::size_t i = 0; i < coefficients.size(); ++i) {
    INFO("coefficient " << i);
    REQUIRE(same_triple(light.coefficients + 3 * i, coefficients[i]));
  }
  for (std::size_t i = 3 * coefficients.size(); i < std::size(light.coefficients); ++i) {
    REQUIRE(light.coefficients[i] == 0.0);
  }
  const ProjectionDiagnostics& diagnostics = expected.diagnostics;
  REQUIRE(light.texels == diagnostics.texels);
  REQUIRE(light.nans_replaced == diagnostics.nans_replaced);
  REQUIRE(light.infinities_replaced == diagnostics.infinities_replaced);
  REQUIRE(light.negatives_replaced == diagnostics.negatives_replaced);
  REQUIRE(light.texels_clamped == diagnostics.texels_clamped);
  REQUIRE(same_triple(light.total_radiance_before_clamp, diagnostics.total_radiance_before_clamp));
  REQUIRE(same_triple(light.total_radiance, diagnostics.total_radiance));
  REQUIRE(same_bits(light.error_estimate, diagnostics.error_estimate));
}

/// 3 bands^2 doubles.
inline std::vector<double> plain(const SphericalHarmonics& harmonics) {
  std::vector<double> values;
  for (const glm::dvec3& rgb : harmonics.coefficients()) values.insert(values.end(), {rgb.x, rgb.y, rgb.z});
  return values;
}

inline bool same_doubles(const double* values, const SphericalHarmonics& expected) {
  const auto wanted = plain(expected);
  return same_bytes(std::span<const double>(values, wanted.size()), std::span<const double>(wanted));
}

/// Returns a level's texels, face after face; the view has packed RGB floats.
inline std::vector<float> texels_of(const CubemapView& view) {
  const std::size_t count = 3 * static_cast<std::size_t>(view.size) * static_cast<std::size_t>(view.size);
  std::vector<float> texels;
  for (const void* face : view.faces) {
    const auto* first = static_cast<const float*>(face);
    texels.insert(texels.end(), first, first + count);
  }
  return texels;
}

inline std::vector<float> texels_of(const welkin_chain* chain, int level) {
  auto pixels = c_struct<welkin_environment>();
  REQUIRE(welkin_chain_get_level(chain, level, &pixels) == WELKIN_OK);
  REQUIRE(pixels.format == WELKIN_FORMAT_RGB_F32);
  REQUIRE(pixels.row_stride_bytes == 0);
  CubemapView view{{}, static_cast<int>(pixels.size), 0, PixelFormat::rgb32f};
  std::copy(std::begin(pixels.faces), std::end(pixels.faces), view.faces.begin());
  return texels_of(view);
}

inline bool same_texels(std::span<const float> a, std::span<const float> b) { return same_bytes(a, b); }

inline void require_same_chain(const welkin_chain* chain, const Cubemap& expected) {
  auto info = c_struct<welkin_chain_info>();
  REQUIRE(welkin_chain_get_info(chain, &info) == WELKIN_OK);
  REQUIRE(info.size == expected.size());
  REQUIRE(info.levels == expected.levels());
  for (int level = 0; level < expected.levels(); ++level) {
    INFO("level " << level);
    REQUIRE(same_texels(texels_of(chain, level), texels_of(expected.view(level))));
  }
}

/// Posts a job by `post`, waits for it, and returns the handle that `get` obtains from it.
template <class Handle>
Handle* posted_handle(const std::function<welkin_status(welkin_job**)>& post,
                      welkin_status (*get)(const welkin_job*, Handle**)) {
  welkin_job* job = nullptr;
  REQUIRE(post(&job) == WELKIN_OK);
  const welkin_status status = welkin_job_wait(job, WELKIN_NO_LIMIT);
  INFO(welkin_last_error());
  REQUIRE(status == WELKIN_OK);
  Handle* handle = nullptr;
  REQUIRE(get(job, &handle) == WELKIN_OK);
  REQUIRE(handle != nullptr);
  welkin_job_release(job);  // the handle keeps the result
  return handle;
}

}  // namespace welkin::test
