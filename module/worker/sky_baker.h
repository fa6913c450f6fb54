// The results that a dynamic sky makes on a worker: one at a time, always the latest that is wanted.
#pragma once

#include <array>
#include <cstdint>
#include <exception>
#include <glm/vec3.hpp>
#include <memory>
#include <mutex>
#include <optional>
#include <span>

#include "welkin/core.h"
#include "welkin/requests.h"
#include "welkin/sky_light.h"

namespace welkin::worker {

/// Numbers of requests so far; the latest result carries the number of the request that it was made for.
struct SkyVersions {
  std::uint64_t tables = 0;
  std::uint64_t curve = 0;
  std::uint64_t specular = 0;

  friend bool operator==(const SkyVersions&, const SkyVersions&) = default;
};

struct SkyTarget {
  SkyVersions versions;
  std::shared_ptr<const Atmosphere> atmosphere;  ///< null: the tables that are there
  double altitude_m = 0.0;
  glm::dvec3 sun{0.0, 1.0, 0.0};  ///< for reflections
};

struct BakedCurve {
  std::shared_ptr<const SkyCurve> curve;
  double sun_radius_degrees = 0.0;  ///< of the curve's atmosphere
};

struct BakedReflections {
  std::shared_ptr<const PrefilteredSpecular> specular;
  glm::dvec3 sun{0.0, 1.0, 0.0};
};

/// Results that have been made and not been taken.
struct SkyUpdates {
  BakedCurve curve;
  BakedReflections reflections;
  bool more_to_come = false;  ///< something is being made or waits to be made, or was not requested
};

struct SkyBakeCounts {
  std::uint64_t posts = 0, tables = 0, curves = 0, speculars = 0, cancelled = 0, failures = 0;
};

/// Shared by the dynamic sky and the request that is in the worker's hands, whichever lives longer.
class SkyBaker : public std::enable_shared_from_this<SkyBaker> {
 public:
  SkyBaker(Worker& worker, SkyLightOptions options, std::shared_ptr<const SkyTables> tables);

  /// Changes the target, and posts a request if one is due and none is in the worker's hands.
  /// `stop`: tables that are being made are useless now. They are cancelled, but only once between two tables that are
  /// finished: else a target that changes faster than tables are made would never see any.
  void set(const SkyTarget& target, bool stop);

  /// Posts a request if one is due and none is in the worker's hands, as after one that the worker let go of. Does
  /// nothing if another thread holds the lock.
  void retry();

  /// Stops what is being made; nothing is posted any more.
  void close() noexcept;

  /// Returns what has been made for a frame, a curve or reflections only where requested. In return it takes what the
  /// frame has no more use for, as far as there is space, so that it is freed on the worker. Does nothing if another
  /// thread holds the lock: it does not wait.
  [[nodiscard]] std::optional<SkyUpdates> try_take(bool curve, bool reflections,
                                                   std::span<std::shared_ptr<const void>> garbage) noexcept;

  [[nodiscard]] SkyBakeCounts counts() const;
  [[nodiscard]] std::exception_ptr error() const;

 private:
  enum class Step { none, tables, curve, specular };
  class Request;

  [[nodiscard]] Step next_step() const noexcept;
  [[nodiscard]] bool curve_is_due() const noexcept;
  [[nodiscard]] bool specular_is_due() const noexcept;
  [[nodiscard]] bool claim() noexcept;
  void post();
  void run(const Control& control);
  void make(Step step, const SkyTarget& target, const Control& control);
  void settle(Step step, const SkyVersions& wanted, std::exception_ptr error);
  void dropped() noexcept;
  void tell_of_the_worker() noexcept;

  Worker& worker_;
  const SkyLightOptions options_;

  mutable std::mutex mutex_;
  SkyTarget target_;
  SkyVersions done_;
  std::uint64_t curve_tables_ = 0;     ///< version of the tables that the last curve was made from
  std::uint64_t specular_tables_ = 0;  ///< version of the tables that the last reflections were made from
  SkyUpdates updates_;
  SkyBakeCounts counts_;
  std::shared_ptr<const SkyTables> tables_;
  std::array<std::shared_ptr<const void>, 8> retired_;
  stop_source stop_;
  std::exception_ptr error_;
  Step last_ = Step::none;  ///< that was begun
  bool running_ = false;
  bool spared_ = false;  ///< tables were cancelled since the last that were finished: the next ones are not
  bool closed_ = false;
};

}  // namespace welkin::worker
