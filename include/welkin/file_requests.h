// What can be asked of a worker about files: Welkin's own calls, as in requests.h.
#pragma once

#include <cstddef>
#include <filesystem>
#include <memory>

#include "welkin/bake.h"
#include "welkin/control.h"
#include "welkin/environment_file.h"
#include "welkin/export.h"
#include "welkin/projection.h"

namespace WELKIN_EXPORT welkin {

/// `project_file`. Equal are the same path and options; as the file may change, only those that still wait share a run.
struct ProjectFile {
  static constexpr bool kReadsFiles = true;

  std::filesystem::path path;
  ReadOptions read_options{};
  ProjectionOptions options{};

  [[nodiscard]] Projection operator()(const Control& control) const;
  [[nodiscard]] std::size_t hash() const noexcept { return std::filesystem::hash_value(path); }
  friend bool operator==(const ProjectFile&, const ProjectFile&) = default;
};

/// `read_environment`. Its result cannot be copied, so it is not shared.
struct ReadFile {
  std::filesystem::path path;
  ReadOptions read_options{};

  [[nodiscard]] Environment operator()(const Control& control) const;
};

/// `measure_environment`. Shared as `ProjectFile`.
struct MeasureFile {
  static constexpr bool kReadsFiles = true;

  std::filesystem::path path;
  ReadOptions read_options{};

  [[nodiscard]] EnvironmentStatistics operator()(const Control& control) const;
  [[nodiscard]] std::size_t hash() const noexcept { return std::filesystem::hash_value(path); }
  friend bool operator==(const MeasureFile&, const MeasureFile&) = default;
};

/// `bake_file`. Shared as `ProjectFile`.
struct BakeFile {
  static constexpr bool kReadsFiles = true;

  std::filesystem::path path;
  ReadOptions read_options{};
  BakeOptions options{};

  [[nodiscard]] std::shared_ptr<const BakeResult> operator()(const Control& control) const;
  [[nodiscard]] std::size_t hash() const noexcept { return std::filesystem::hash_value(path); }
  friend bool operator==(const BakeFile&, const BakeFile&) = default;
};

}  // namespace welkin
