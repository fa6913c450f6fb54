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

  std::filesystem::path path;   ///< the file, or one of six
  ReadOptions read_options{};   ///< how it is read
  ProjectionOptions options{};  ///< how it is projected

  [[nodiscard]] Projection operator()(const Control& control) const;
  [[nodiscard]] std::size_t hash() const noexcept { return std::filesystem::hash_value(path); }
  friend bool operator==(const ProjectFile&, const ProjectFile&) = default;
};

/// `read_environment`. Its result cannot be copied, so it is not shared.
struct ReadFile {
  std::filesystem::path path;  ///< the file, or one of six
  ReadOptions read_options{};  ///< how it is read

  [[nodiscard]] Environment operator()(const Control& control) const;
};

/// `measure_environment`. Shared as `ProjectFile`.
struct MeasureFile {
  static constexpr bool kReadsFiles = true;

  std::filesystem::path path;  ///< the file, or one of six
  ReadOptions read_options{};  ///< how it is read

  [[nodiscard]] EnvironmentStatistics operator()(const Control& control) const;
  [[nodiscard]] std::size_t hash() const noexcept { return std::filesystem::hash_value(path); }
  friend bool operator==(const MeasureFile&, const MeasureFile&) = default;
};

/// `bake_file`. Shared as `ProjectFile`.
struct BakeFile {
  static constexpr bool kReadsFiles = true;

  std::filesystem::path path;  ///< the file, or one of six
  ReadOptions read_options{};  ///< how it is read
  BakeOptions options{};       ///< what is made of it

  [[nodiscard]] std::shared_ptr<const BakeResult> operator()(const Control& control) const;
  [[nodiscard]] std::size_t hash() const noexcept { return std::filesystem::hash_value(path); }
  friend bool operator==(const BakeFile&, const BakeFile&) = default;
};

}  // namespace welkin
