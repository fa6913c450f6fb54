// The input of commands that read an environment: their options, the image in memory, and its orientation.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <glm/gtc/quaternion.hpp>
#include <glm/mat3x3.hpp>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "tools/arguments.h"
#include "welkin/core.h"
#include "welkin/engines.h"
#include "welkin/environment_file.h"
#include "welkin/image.h"
#include "welkin/projection.h"
#include "welkin/spherical_harmonics.h"

namespace welkin {
class ResultCache;
}

namespace welkin::tool {

/// Options of every subcommand that reads an environment.
struct CommonOptions {
  bool json = false;
  int threads = 0;  ///< 0: as many as the process may use
  ReadOptions read;
  const char* memory_option = "--memory-limit";  ///< the option that sets the limit of `read`, for messages
  std::string cache;                             ///< a folder; empty: results are not kept
};

/// Returns the text of an option that names an environment. `six`: it may be one of six files, or their folder.
[[nodiscard]] std::string input_text(bool six);

/// Adds INPUT, a file's path, and --sky, the built-in computed sky. They exclude each other.
void add_input_options(Options& table, std::optional<std::string>& input, bool& sky);

/// Throws `Error` (invalid_argument), which states the needs of the command, if there is neither an input nor --sky, or
/// if the input is an empty text. An unset shell variable gives either, and must not become a sky.
void require_input(const std::string& command, const std::optional<std::string>& input, bool sky);

/// Returns the named file, or the bytes of a pipe or, for "-", of standard input: they are read once, completely, and
/// kept. A command has only one input. Throws `Error`: limit_exceeded if they exceed the options' memory limit,
/// file_access.
[[nodiscard]] FileInput input_of(const std::string& named, const ReadOptions& read);

/// Returns the name of results without -o: "city" for an input "hdr/city.hdr" or a folder "hdr/city", "sky" without an
/// input. Throws `Error` (invalid_argument) for an input without a name: a pipe, standard input.
[[nodiscard]] std::string default_output_name(const std::optional<std::string>& input);

/// Throws `Error` (file_access) if the path exists and `command` would not recognize it as its own: not a folder, or a
/// folder with files but without the command's `table` ("manifest.json").
void require_own_folder(const std::filesystem::path& folder, const std::string& table, const std::string& command);

/// Returns whether the name means standard input or standard output.
[[nodiscard]] inline bool is_standard_stream(const std::string& named) { return named == "-"; }
/// Returns whether the input can be read only once: standard input or a pipe.
[[nodiscard]] bool is_stream(const std::string& named);

void add_json_option(Options& table, CommonOptions& options);
void add_threads_option(Options& table, CommonOptions& options);
void add_memory_limit_option(Options& table, CommonOptions& options);
void add_cache_option(Options& table, CommonOptions& options);

/// Adds options of reading: layout, part of the file, interpretation of its numbers. `input`: the positional option
/// that they need, if it may be left out; else empty. `layout_option`: another name if --layout is the command's own.
void add_read_options(Options& table, CommonOptions& options, const std::string& input,
                      const std::string& layout_option = "--layout");

/// Returns the words for the layouts.
[[nodiscard]] std::vector<std::pair<std::string, Layout>> layout_choices();

/// Returns the number of threads that the options select.
[[nodiscard]] int thread_count(const CommonOptions& options);

/// Returns the result of `work`, which runs with the selected number of threads and a progress bar.
[[nodiscard]] std::string with_bar(const CommonOptions& options,
                                   const std::function<std::string(const Control& control)>& work);

/// Calls `work` with the selected cache, or with null. Damaged and unwritable entries are noted: results are right
/// without them.
void with_cache(const CommonOptions& options, std::vector<std::string>& notes,
                const std::function<void(ResultCache* cache)>& work);

/// A clamp from two options, either of which may be absent.
struct ClampChoice {
  RadianceClamp clamp;
  bool clamps = false;

  void apply(PixelPolicy& pixels) const {
    if (clamps) pixels.clamp = clamp;
  }
};

/// Adds --clamp, --preserve-clamped, --gamma, --nan, --infinity, --negative.
void add_pixel_options(Options& table, PixelPolicy& pixels, ClampChoice& clamp);

/// The origin of light, for reports.
struct Source {
  std::string path;
  std::string layout;
  int width = 0;
  int height = 0;
  std::string format;
  std::string detail;              ///< more for a person: channel type, compression, how the layout was determined
  std::vector<std::string> notes;  ///< how reading changed the pixels
};

[[nodiscard]] Source source_of(const std::string& named, const EnvironmentInfo& info);

/// An environment in memory, as read or computed, for work that needs more than one pass over its rows.
struct Pixels {
  std::variant<LatLongImage, Cubemap, Environment> image;

  [[nodiscard]] EnvironmentView view() const;
  [[nodiscard]] bool is_cubemap() const { return view().kind() == EnvironmentKind::cubemap; }
  [[nodiscard]] std::span<float> values();
};

/// Returns all values of an environment that was read.
[[nodiscard]] std::span<float> values_of(const Environment& environment);

inline constexpr float kForInfinity = 65504.0F;  ///< the largest half float

/// Replaces +infinity with `largest` and -infinity with 0, so that a sun that overflowed has a value. Returns the
/// number of replaced values.
std::uint64_t replace_infinities(Pixels& pixels, float largest = kForInfinity);

/// Extracts the sun. An environment from a file is copied first.
[[nodiscard]] std::optional<Sun> extract_sun(Pixels& pixels, const SunOptions& options);

/// The options for the sun.
struct SunChoice {
  bool take_out = false;
  SunOptions options;
};

/// Adds --extract-sun and --sun-threshold, --sun-radius, --sun-contrast, --sun-share. `excludes`: options that exclude
/// --extract-sun.
void add_sun_options(Options& table, SunChoice& choice, const std::vector<std::string>& excludes = {});

/// Returns lines for a person about the sun that was extracted or was never in the pixels, or that none was found.
[[nodiscard]] std::string sun_text(const std::optional<Sun>& sun, bool z_is_up);

// The orientation of the result: conventions, yaw, mirror, quaternion.

struct OrientationOptions {
  Engine from = Engine::welkin;
  Engine to = Engine::welkin;
  double yaw_degrees = 0.0;
  bool mirror = false;
  glm::dquat rotation{1.0, 0.0, 0.0, 0.0};
};

/// Adds only --for: for light that was never in a file.
void add_engine_option(Options& table, OrientationOptions& options);

/// Adds --from, --for, --yaw, --mirror, --rotation.
void add_orientation_options(Options& table, OrientationOptions& options);

/// Returns the matrix from a direction in the file (in the frames of LatLongView or CubemapView) to that in the result,
/// in the axes of its engine: out of the file's convention, mirrored (x changes its sign), rotated by the quaternion
/// and then about y, in Welkin's axes, and into the engine's. For coefficients and lights.
[[nodiscard]] glm::dmat3 light_rotation(const OrientationOptions& options, bool source_is_cubemap);

/// Returns the matrix of `light_rotation` for a result that is an image in the frames of LatLongView or CubemapView: a
/// cubemap's faces are where the engine looks for them; a lat-long is the same image for all engines.
[[nodiscard]] glm::dmat3 image_rotation(const OrientationOptions& options, bool source_is_cubemap,
                                        bool result_is_cubemap);

/// Returns the result's axes in words.
[[nodiscard]] std::string axes_text(const OrientationOptions& options);

/// Returns the matrix from Welkin's axes to positions in the engine's cube faces: one of the cube's 48 symmetries.
/// Throws `Error` (invalid_argument) for an engine that has no cube faces.
[[nodiscard]] glm::dmat3 faces_of(Engine engine);

/// Rotates a chain by moving its texels unchanged.
[[nodiscard]] Cubemap rotate(const Cubemap& chain, const glm::dmat3& symmetry, const Control& control);

}  // namespace welkin::tool
