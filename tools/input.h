// What is read and how: the options of commands that read an environment, what they hold of it in memory, and how it is
// turned.
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

/// What every subcommand that reads an environment takes.
struct CommonOptions {
  bool json = false;
  int threads = 0;  ///< 0: as many as the process may use
  ReadOptions read;
  const char* memory_option = "--memory-limit";  ///< what sets the limit of `read`, for messages
  std::string cache;                             ///< a folder; empty: results are not kept
};

/// The description of an option that names an environment to read. `six`: of six files it may be one, or their folder.
[[nodiscard]] std::string input_text(bool six);

/// INPUT, a file's path, and --sky, the built-in computed sky. They exclude each other.
void add_input_options(Options& table, std::optional<std::string>& input, bool& sky);

/// Throws `Error` (invalid_argument), which says what the command wants, if there is neither an input nor --sky, or if
/// the input is an empty text. An unset shell variable gives either, and must not become a sky.
void require_input(const std::string& command, const std::optional<std::string>& input, bool sky);

/// The file that was named, or the bytes of a pipe or, for "-", of standard input: they are read once, whole, and kept.
/// A command has one input. Throws `Error`: limit_exceeded if they are more than the options' memory limit,
/// file_access.
[[nodiscard]] FileInput input_of(const std::string& named, const ReadOptions& read);

/// Returns what results are called where -o names nothing: "city" for an input "hdr/city.hdr" or a folder "hdr/city",
/// "sky" where there is no input. Throws `Error` (invalid_argument) for an input without a name: a pipe, standard
/// input.
[[nodiscard]] std::string default_output_name(const std::optional<std::string>& input);

/// Throws `Error` (file_access) if something is there that `command` would not find again as its own: another thing
/// than a folder, or a folder with files but without the command's `table` ("manifest.json").
void require_own_folder(const std::filesystem::path& folder, const std::string& table, const std::string& command);

/// Whether that is standard input or standard output.
[[nodiscard]] inline bool is_standard_stream(const std::string& named) { return named == "-"; }
/// Whether that can be read once only: standard input or a pipe.
[[nodiscard]] bool is_stream(const std::string& named);

void add_json_option(Options& table, CommonOptions& options);
void add_threads_option(Options& table, CommonOptions& options);
void add_memory_limit_option(Options& table, CommonOptions& options);
void add_cache_option(Options& table, CommonOptions& options);

/// How the input is read: its layout, which part of it, and how its numbers are meant. `input`: the place that they
/// need, if it may be left out; else empty. `layout_option`: for a command that has a layout of its own to ask for.
void add_read_options(Options& table, CommonOptions& options, const std::string& input,
                      const std::string& layout_option = "--layout");

/// The layouts' words.
[[nodiscard]] std::vector<std::pair<std::string, Layout>> layout_choices();

/// The number of threads that the options ask for.
[[nodiscard]] int thread_count(const CommonOptions& options);

/// Returns what `work` returns, which gets the threads that the options ask for and a progress bar.
[[nodiscard]] std::string with_bar(const CommonOptions& options,
                                   const std::function<std::string(const Control& control)>& work);

/// Calls `work` with the cache that was asked for, or with null. What was damaged or could not be kept is noted:
/// results are right without it.
void with_cache(const CommonOptions& options, std::vector<std::string>& notes,
                const std::function<void(ResultCache* cache)>& work);

/// A clamp as it is put together from two options, either of which may be absent.
struct ClampChoice {
  RadianceClamp clamp;
  bool clamps = false;

  void apply(PixelPolicy& pixels) const {
    if (clamps) pixels.clamp = clamp;
  }
};

/// --clamp, --preserve-clamped, --gamma, --nan, --infinity, --negative.
void add_pixel_options(Options& table, PixelPolicy& pixels, ClampChoice& clamp);

/// Where light came from, for those who read of it.
struct Source {
  std::string path;
  std::string layout;
  int width = 0;
  int height = 0;
  std::string format;
  std::string detail;  ///< what a person may want to know besides: channel type, compression, what told the layout
  std::vector<std::string> notes;  ///< what was done to the pixels on the way in
};

[[nodiscard]] Source source_of(const std::string& named, const EnvironmentInfo& info);

/// An environment in memory, as it was read or as it was made, where more is asked of it than one pass over its rows.
struct Pixels {
  std::variant<LatLongImage, Cubemap, Environment> image;

  [[nodiscard]] EnvironmentView view() const;
  [[nodiscard]] bool is_cubemap() const { return view().kind() == EnvironmentKind::cubemap; }
  [[nodiscard]] std::span<float> values();
};

/// All values of what was read.
[[nodiscard]] std::span<float> values_of(const Environment& environment);

inline constexpr float kForInfinity = 65504.0F;  ///< the largest half

/// Puts `largest` in the place of +infinity and 0 in that of -infinity: a sun that overflowed has a value then.
/// How many there were.
std::uint64_t replace_infinities(Pixels& pixels, float largest = kForInfinity);

/// What was read is copied first.
[[nodiscard]] std::optional<Sun> extract_sun(Pixels& pixels, const SunOptions& options);

/// What becomes of the sun.
struct SunChoice {
  bool take_out = false;
  SunOptions options;
};

/// --extract-sun and --sun-threshold, --sun-radius, --sun-contrast, --sun-share. `excludes`: options that go with none
/// of that.
void add_sun_options(Options& table, SunChoice& choice, const std::vector<std::string>& excludes = {});

/// Some lines for a person about the sun that was taken out or was never in the pixels, or that there was none.
[[nodiscard]] std::string sun_text(const std::optional<Sun>& sun, bool z_is_up);

// How it is turned on the way to its result: conventions, yaw, mirror, quaternion.

struct OrientationOptions {
  Engine from = Engine::welkin;
  Engine to = Engine::welkin;
  double yaw_degrees = 0.0;
  bool mirror = false;
  glm::dquat rotation{1.0, 0.0, 0.0, 0.0};
};

/// --for alone: of light that was never in a file.
void add_engine_option(Options& table, OrientationOptions& options);

/// --from, --for, --yaw, --mirror, --rotation.
void add_orientation_options(Options& table, OrientationOptions& options);

/// Takes a direction as the file has it (by the frames of LatLongView or CubemapView) to the one in which the result
/// has it, in the axes of the engine that it is for: out of the file's convention, mirrored (x changes its sign),
/// turned by the quaternion and then about y, in Welkin's axes, and into the engine's. For coefficients and lights.
[[nodiscard]] glm::dmat3 light_rotation(const OrientationOptions& options, bool source_is_cubemap);

/// The same where the result is an image, by the frames of LatLongView or CubemapView: a cubemap's faces are where
/// the engine looks for them; a lat-long is the same image for all engines.
[[nodiscard]] glm::dmat3 image_rotation(const OrientationOptions& options, bool source_is_cubemap,
                                        bool result_is_cubemap);

/// The result's axes in words.
[[nodiscard]] std::string axes_text(const OrientationOptions& options);

/// What takes Welkin's axes to the places in the engine's cube faces: one of the cube's 48 symmetries. Throws `Error`
/// (invalid_argument) for an engine that has no cube faces.
[[nodiscard]] glm::dmat3 faces_of(Engine engine);

/// Every texel is moved as it is.
[[nodiscard]] Cubemap rotate(const Cubemap& chain, const glm::dmat3& symmetry, const Control& control);

}  // namespace welkin::tool
