// Who turns environments into light for the loop.
#pragma once

#include <welkin/projection.h>
#include <welkin/spherical_harmonics.h>

#include <cstdint>
#include <optional>
#include <vector>

#include "clock.h"
#include "schedule.h"

namespace engine_loop {

/// What became of a posting.
struct Baked {
  std::optional<welkin::SphericalHarmonics> radiance;  ///< none if a newer one took its place
  std::uint64_t texels = 0;
  double latency_ms = 0.0;  ///< from being asked for to being in the engine's hands
};

class Baker {
 public:
  Baker() = default;
  virtual ~Baker() = default;
  Baker(const Baker&) = delete;
  Baker& operator=(const Baker&) = delete;

  /// In every frame, after the engine's own work; throws what went wrong.
  virtual void collect() = 0;
  /// Then, for each posting of the frame; throws what goes wrong.
  virtual void ask(Posting posting) = 0;
  /// After the last frame: returns when all is done.
  virtual void finish() = 0;

  /// By the postings' numbers.
  [[nodiscard]] const std::vector<Baked>& baked() const noexcept { return baked_; }

 protected:
  void keep(std::size_t number, Clock::time_point asked, const welkin::Projection& light);
  void give_up(std::size_t number);

 private:
  Baked& place(std::size_t number);

  std::vector<Baked> baked_;
};

}  // namespace engine_loop
