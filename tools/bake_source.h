// What `welkin bake` bakes: read, without its sun if that is asked for, turned to Welkin's axes.
#pragma once

#include <cstdint>
#include <optional>
#include <utility>

#include "tools/bake_options.h"
#include "tools/pixels.h"
#include "tools/source.h"
#include "welkin/environment_file.h"
#include "welkin/projection.h"

namespace welkin::tool {

class BakeSource {
 public:
  /// Throws `Error` as `read_environment`, and limit_exceeded if source and copies of it take too much.
  BakeSource(const BakeCommandOptions& options, const Control& control);

  [[nodiscard]] const Source& description() const noexcept { return description_; }
  /// That was taken out, or never in; in Welkin's axes.
  [[nodiscard]] const std::optional<Sun>& sun() const noexcept { return sun_; }
  [[nodiscard]] const std::optional<SkyReport>& sky() const noexcept { return sky_; }  ///< of a computed one
  /// What was computed, if it is to be kept.
  [[nodiscard]] LatLongImage take_picture() noexcept { return std::move(picture_); }
  /// Three bands that an .env stores beside its pixels, turned as those are: its pixels end at 255. None if light was
  /// taken out, clamped or decoded: then the pixels alone tell.
  [[nodiscard]] const std::optional<Projection>& stored_light() const noexcept { return stored_light_; }
  [[nodiscard]] std::uint64_t bytes() const noexcept;

  /// Calls `function` with the view of the pixels, a lat-long's or a cubemap's.
  template <typename Function>
  auto visit(const Function& function) const {
    if (!file_) return with_view(pixels_, function);
    return file_->face_size() > 0 ? function(file_->cubemap()) : function(file_->lat_long());
  }

 private:
  void read(const BakeCommandOptions& options, const Control& control);
  void turn(const BakeCommandOptions& options, const Control& control);
  [[nodiscard]] bool is_cubemap() const noexcept { return file_ ? file_->face_size() > 0 : pixels_.is_cubemap; }

  std::optional<Environment> file_;  // as it was read,
  Pixels pixels_;                    // or what was made of it
  Source description_;
  std::optional<SkyReport> sky_;
  LatLongImage picture_;
  std::optional<Sun> sun_;
  std::optional<Projection> stored_light_;
};

}  // namespace welkin::tool
