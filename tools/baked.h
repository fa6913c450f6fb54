// The source and the results of `welkin bake`, before they are written.
#pragma once

#include <chrono>
#include <cstdint>
#include <glm/vec3.hpp>
#include <optional>
#include <string>
#include <vector>

#include "tools/bake_options.h"
#include "tools/terminal.h"
#include "welkin/bake.h"

namespace welkin::tool {

/// A chain by another lobe than GGX.
struct LobeChain {
  LobeFamily lobe{};
  PrefilteredSpecular light;
};

/// All directions and faces in Welkin's axes.
struct Baked {
  Source source;
  std::optional<SkyReport> sky;  ///< of a computed one
  LatLongImage image;            ///< of `sky`, if it is to be kept
  LatLongImage lat_long;         ///< for files with one: the source, sanitized, at the requested size
  bool sun_wanted = false;       ///< the sun was to be extracted, or was never in the pixels
  std::optional<Sun> sun;
  BakeOptions whole;    ///< all that the options select
  BakeOptions options;  ///< the part of it that the scene needs
  Plan plan;
  BakeResult light;
  std::optional<PrefilteredSpecular> env;  ///< the .env's or .glb's chain, if the specular one would not do
  std::vector<LobeChain> lobes;            ///< of --lobe
  std::optional<Projection> stored_light;  ///< of an .env: three bands that its clipped pixels lack
  bool env_is_specular = false;            ///< the specular chain serves for the .env or .glb too
  bool env_left_out = false;               ///< no material of the scene would read it
  std::vector<MipRecord> env_mips;         ///< of that chain; empty without an .env or .glb
  std::string env_container;               ///< "env" or "glb"
  std::vector<PassRecord> passes;          ///< of the command itself, outside of the library's bake
  std::vector<std::string> notes;          ///< of this run alone: what its cache failed to do
};

/// The name of the library's bake among the command's own passes.
inline constexpr const char* kBakePass = "bake";

/// Runs `work` and notes its time: for a stage, or for one of several concurrent parts of a stage.
template <typename Work>
auto measured(std::vector<PassRecord>& passes, const std::string& name, const std::string& reason, const Work& work) {
  using Milliseconds = std::chrono::duration<double, std::milli>;
  const auto start = std::chrono::steady_clock::now();
  struct Note {
    std::vector<PassRecord>& passes;
    const std::string& name;
    const std::string& reason;
    std::chrono::steady_clock::time_point start;
    ~Note() {
      passes.push_back({name, PassAction::run, reason, Milliseconds(std::chrono::steady_clock::now() - start).count()});
    }
  } note{passes, name, reason, start};
  return work();
}

/// Begins a stage, and runs its work by `measured`.
template <typename Work>
auto timed(std::vector<PassRecord>& passes, const std::string& name, const std::string& reason, const Work& work) {
  begin_stage(name);
  return measured(passes, name, reason, work);
}

/// Returns the plan alone; of a file only the header is read.
[[nodiscard]] Plan plan_ahead(const BakeCommandOptions& options, const Control& control);

/// The size of a bake, as predicted from its input's header.
struct Prediction {
  EnvironmentInfo info;
  std::uint64_t texels = 0;        ///< of the input
  std::uint64_t result_bytes = 0;  ///< in memory, before they become files
  std::uint64_t most_bytes = 0;    ///< of the step that takes the most; without previews and encoders
};

/// Predicts a bake of a file. Throws the errors of `plan_ahead`.
[[nodiscard]] Prediction predict(const BakeCommandOptions& options);

/// Reads the source and bakes what the options select, except what the scene does not need. Prints the plan to standard
/// error before, if it is to be explained.
[[nodiscard]] Baked bake_source(const BakeCommandOptions& options, const Control& control);

// Parts of a bake that the command makes itself.

/// Returns what the file of a lobe's chain holds.
[[nodiscard]] std::string what_of(LobeFamily lobe);

/// Returns the options of a lobe's chain. `specular`: of `library_options`.
[[nodiscard]] PrefilterOptions lobe_options(LobeFamily lobe, const BakeCommandOptions& options,
                                            const PrefilterOptions& specular);

/// Returns the bytes of the lat-long; 0 if there is none. `whole`: from `library_options`.
[[nodiscard]] std::uint64_t lat_long_bytes(const SourceShape& source, const BakeCommandOptions& options,
                                           const BakeOptions& whole);

/// Returns the lat-long of a bake, without width if there is none. In an engine's folder, if no option names a size, it
/// is as large as the source, or four times as wide as a cubemap's face; else it is four times as wide as the
/// background cubemap. A lat-long source of that size keeps its pixels, except for those that the pixel policy changes.
[[nodiscard]] LatLongImage lat_long_of(const EnvironmentView& source, const BakeCommandOptions& options,
                                       const BakeOptions& whole, const Control& control);

/// Returns the fraction of all luminance, by solid angle, that a clamp at `largest` removes; 0 if there is no light.
/// Pixels are RGB floats; negative values count as no light.
[[nodiscard]] double share_beyond(const LatLongView& image, const glm::dvec3& largest);
[[nodiscard]] double share_beyond(const CubemapView& cubemap, const glm::dvec3& largest);

}  // namespace welkin::tool
