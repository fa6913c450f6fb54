#include "tools/sky_tables_file.h"

#include <chrono>
#include <filesystem>
#include <utility>

namespace welkin::tool {
namespace {

/// The limit bounds the work; it changes no table.
bool fit(const SkyTables& tables, const Atmosphere& atmosphere, const SkyTableOptions& options) {
  SkyTableOptions theirs = tables.options;
  theirs.memory_limit_bytes = options.memory_limit_bytes;
  return tables.atmosphere == atmosphere && theirs == options;
}

ReadyTables made_or_loaded(const Atmosphere& atmosphere, const SkyTableOptions& options,
                           const std::optional<std::string>& file, const Control& control) {
  std::error_code none;
  std::string reason = "no --tables file keeps them";
  if (file) {
    const bool is_there = std::filesystem::exists(*file, none);
    if (is_there) {
      auto loaded = std::make_shared<const SkyTables>(load_sky_tables(*file, options.memory_limit_bytes));
      if (fit(*loaded, atmosphere, options)) return {loaded, {"tables", "reuse", "loaded from " + *file, 0.0}};
    }
    reason = (is_there ? "those in the file were of other parameters; now saved to " : "saved to ") + *file;
  }
  auto made = std::make_shared<const SkyTables>(precompute_sky(atmosphere, options, control));
  if (file) save_sky_tables(*made, *file);
  return {made, {"tables", "run", reason, 0.0}};
}

}  // namespace

ReadyTables ready_tables(const Atmosphere& atmosphere, const SkyTableOptions& options,
                         const std::optional<std::string>& file, const Control& control) {
  const auto start = std::chrono::steady_clock::now();
  ReadyTables ready = made_or_loaded(atmosphere, options, file, control);
  ready.pass.milliseconds = std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count();
  return ready;
}

}  // namespace welkin::tool
