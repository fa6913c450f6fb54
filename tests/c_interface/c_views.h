// The tests' pictures as C callers describe them.
#pragma once

#include "support/catch.h"
#include "welkin/image_view.h"
#include "welkin/welkin.h"

namespace welkin::test {

inline welkin_cubemap c_view(const CubemapView& view) {
  welkin_cubemap cubemap;
  WELKIN_INIT(cubemap);
  cubemap.format = static_cast<welkin_format>(view.format);
  cubemap.row_stride_bytes = view.row_stride_bytes;
  std::copy(view.faces.begin(), view.faces.end(), cubemap.faces);
  cubemap.size = view.size;
  return cubemap;
}

inline welkin_lat_long c_view(const LatLongView& view) {
  welkin_lat_long lat_long;
  WELKIN_INIT(lat_long);
  lat_long.format = static_cast<welkin_format>(view.format);
  lat_long.row_stride_bytes = view.row_stride_bytes;
  lat_long.pixels = view.pixels;
  lat_long.width = view.width;
  lat_long.height = view.height;
  return lat_long;
}

/// All zero but the size.
template <class Struct>
Struct c_struct() {
  Struct made;
  WELKIN_INIT(made);
  return made;
}

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

}  // namespace welkin::test
