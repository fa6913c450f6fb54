#include "c/c_support.h"

#include <cstdlib>
#include <iterator>
#include <limits>
#include <new>
#include <string>

#include "platform/text.h"

namespace welkin::c_interface {
namespace {

/// A thread's last error. The text is separate from its storage, so that it can be set when memory runs out.
struct LastError {
  welkin_status status = WELKIN_OK;
  const char* text = "";
  std::string storage;
};

thread_local LastError last_error;

}  // namespace

welkin_status status_of(ErrorCode code) noexcept {
  switch (code) {
    case ErrorCode::invalid_argument: return WELKIN_INVALID_ARGUMENT;
    case ErrorCode::rejected_pixel: return WELKIN_REJECTED_PIXEL;
    case ErrorCode::file_access: return WELKIN_FILE_ACCESS;
    case ErrorCode::corrupt_file: return WELKIN_CORRUPT_FILE;
    case ErrorCode::unsupported_file: return WELKIN_UNSUPPORTED_FILE;
    case ErrorCode::limit_exceeded: return WELKIN_LIMIT_EXCEEDED;
    case ErrorCode::cancelled: return WELKIN_CANCELLED;
    case ErrorCode::replaced: return WELKIN_REPLACED;
    case ErrorCode::queue_full: return WELKIN_QUEUE_FULL;
    case ErrorCode::stopped: return WELKIN_STOPPED;
  }
  return WELKIN_INTERNAL;
}

Outcome outcome_of(const std::exception_ptr& error) {
  try {
    std::rethrow_exception(error);
  } catch (const Error& known) {
    return {status_of(known.code()), known.what()};
  } catch (const StatusError& returned) {
    return {returned.status(), returned.what()};
  } catch (const std::bad_alloc&) {
    return {WELKIN_OUT_OF_MEMORY, "there is not enough memory"};
  } catch (const std::exception& other) {
    return {WELKIN_INTERNAL, other.what()};
  } catch (...) {
    return {WELKIN_INTERNAL, "an exception of a type other than std::exception was thrown, perhaps by a callback"};
  }
}

welkin_status set_last_error(welkin_status status, const std::string& message) noexcept {
  last_error.status = status;
  try {
    last_error.storage = message;
    last_error.text = last_error.storage.c_str();
  } catch (...) {
    last_error.text = "there is not enough memory for the message";
  }
  return status;
}

welkin_status set_last_error_from_exception() noexcept {
  try {
    const Outcome outcome = outcome_of(std::current_exception());
    return set_last_error(outcome.status, outcome.message);
  } catch (...) {
    last_error.status = WELKIN_OUT_OF_MEMORY;
    last_error.text = "there is not enough memory";
    return WELKIN_OUT_OF_MEMORY;
  }
}

void clear_last_error() noexcept {
  last_error.status = WELKIN_OK;
  last_error.text = "";
}

welkin_status last_error_status() noexcept { return last_error.status; }

void refuse(const std::string& message) { throw Error(ErrorCode::invalid_argument, message); }

void require(const void* pointer, const char* name) {
  if (pointer == nullptr) refuse(std::string(name) + " is null");
}

namespace {

/// The number of bytes by which a stated size may exceed the known one; beyond it, the size was never set.
constexpr std::size_t kMaxSurplus = 4096;

}  // namespace

std::size_t stated_size(const void* given, std::size_t known, std::size_t alignment, const char* name) {
  require(given, name);
  std::uint32_t size = 0;
  std::memcpy(&size, given, sizeof size);
  const std::size_t minimum = std::max(sizeof size, alignment);
  if (size < minimum || size % alignment != 0 || size > known + kMaxSurplus) {
    refuse(std::string(name) + "->struct_size is " + std::to_string(size) +
           "; it must be the structure's sizeof, which is " + std::to_string(known) + " in version " +
           std::to_string(WELKIN_C_VERSION));
  }
  return size;
}

void require_zeros_behind(const void* given, std::size_t known, std::size_t size, const char* name) {
  const auto* bytes = static_cast<const unsigned char*>(given);
  for (std::size_t i = known; i < size; ++i) {
    if (bytes[i] == 0) continue;
    refuse(std::string(name) + " has a field that version " + std::to_string(WELKIN_C_VERSION) +
           " of this interface does not have: byte " + std::to_string(i) + " of the structure is not zero");
  }
}

void require_enumerator(const char* what, std::int32_t value, std::int32_t last) {
  if (value >= 0 && value <= last) return;
  refuse(std::string(what) + " is " + std::to_string(value) + "; it must be one of the named values, 0 to " +
         std::to_string(last));
}

bool flag(const char* what, std::int32_t value) {
  if (value != 0 && value != 1) refuse(std::string(what) + " is " + std::to_string(value) + "; it must be 0 or 1");
  return value == 1;
}

void refuse_thread_exit(const char* function) {
  throw StatusError(WELKIN_INTERNAL,
                    std::string(function) + " called pthread_exit; it must return, as the thread is not its own");
}

Control control_of(const welkin_control* control) { return control == nullptr ? Control{} : control->control; }

// The caller's pixels.

namespace {

constexpr std::int32_t kMaxLevels = 15;  // down from 16384 texels

static_assert(WELKIN_FORMAT_RGBA_SRGB8 == static_cast<int>(PixelFormat::srgba8));
static_assert(WELKIN_FORMAT_RGB_F16 == static_cast<int>(PixelFormat::rgb16f));
static_assert(WELKIN_FORMAT_RGB_U8 == static_cast<int>(PixelFormat::rgb8));
static_assert(WELKIN_NEGATIVE_REPLACE == static_cast<int>(NegativePolicy::replace));
static_assert(WELKIN_NEGATIVE_REJECT == static_cast<int>(NegativePolicy::reject));

PixelFormat pixel_format(welkin_format format) { return enumerator("format", format, PixelFormat::srgba8); }

/// Rejects the most negative stride, which has no positive counterpart to compare with.
std::ptrdiff_t stride(std::int64_t row_stride_bytes) {
  if (row_stride_bytes == std::numeric_limits<std::int64_t>::min()) {
    refuse("row_stride_bytes is " + std::to_string(row_stride_bytes) + "; no image is that large");
  }
  return row_stride_bytes;
}

int face_size(std::int64_t size) {
  if (size < 0 || size > std::numeric_limits<int>::max()) {
    refuse("the cubemap's size is " + std::to_string(size) + "; it must be from 1 to 16384");
  }
  return static_cast<int>(size);
}

/// Reads an array of the caller's structures, which may be shorter or longer than this library's: the stated size is
/// the distance between them.
template <class Struct>
std::vector<Struct> read_structs(const Struct* first, std::size_t count, const std::string& name) {
  const std::size_t step = stated_size(first, sizeof(Struct), alignof(Struct), name.c_str());
  std::vector<Struct> structs;
  structs.reserve(count);
  for (std::size_t k = 0; k < count; ++k) {
    const auto* const given = reinterpret_cast<const Struct*>(reinterpret_cast<const std::byte*>(first) + k * step);
    if (stated_size(given, sizeof(Struct), alignof(Struct), name.c_str()) != step) {
      refuse(name + "[" + std::to_string(k) + "].struct_size differs from that of the first");
    }
    structs.push_back(read_struct(given, name.c_str()));
  }
  return structs;
}

EnvironmentView view_of(const welkin_environment& given) {
  const PixelFormat format = pixel_format(given.format);
  const std::ptrdiff_t row_bytes = stride(given.row_stride_bytes);
  if (given.size == 0) return LatLongView{given.faces[0], given.width, given.height, row_bytes, format};
  if (given.width != 0 || given.height != 0)
    refuse("width and height are set together with size; set them for a lat-long only");
  CubemapView view{{}, face_size(given.size), row_bytes, format};
  std::copy(std::begin(given.faces), std::end(given.faces), view.faces.begin());
  return view;
}

std::vector<CubemapView> views_of(const welkin_environment* cubemaps, std::size_t count, const char* name) {
  std::vector<CubemapView> views;
  views.reserve(count);
  for (const welkin_environment& given : read_structs(cubemaps, count, name)) {
    const EnvironmentView view = view_of(given);
    if (view.kind() != EnvironmentKind::cubemap) {
      refuse(std::string(name) + "[" + std::to_string(views.size()) + "].size is 0; it must be a cubemap");
    }
    views.push_back(view.cubemap());
  }
  return views;
}

}  // namespace

EnvironmentView environment_view(const welkin_environment* environment, const char* name) {
  return view_of(read_struct(environment, name));
}

std::vector<CubemapView> cubemap_views(const welkin_environment* mips, std::int32_t mip_count) {
  image::require_range("mip_count", mip_count, 1, kMaxLevels);
  return views_of(mips, static_cast<std::size_t>(mip_count), "mips");
}

std::vector<CubemapView> probe_views(const welkin_environment* probes, std::int64_t probe_count) {
  image::require_range("probe_count", probe_count, 0, std::numeric_limits<std::int32_t>::max());
  if (probe_count == 0) return {};
  return views_of(probes, static_cast<std::size_t>(probe_count), "probes");
}

ProjectionOptions projection_options(const welkin_projection_options* options) {
  const auto given = read_options(options, "options");
  ProjectionOptions wanted;
  set_unless_zero(wanted.bands, given.bands);
  wanted.quadrature = flag("midpoint", given.midpoint) ? Quadrature::midpoint : Quadrature::exact;
  if (given.target_size != 0) wanted.target_size = given.target_size;
  wanted.pixels = pixel_policy(given.pixels);
  return wanted;
}

PixelPolicy pixel_policy(const welkin_pixel_policy* policy) {
  const auto given = read_options(policy, "pixels");
  const auto non_finite = [](const char* name, std::int32_t rejects) {
    return flag(name, rejects) ? NonFinitePolicy::reject : NonFinitePolicy::replace;
  };
  PixelPolicy wanted;
  const bool preserve_colour = flag("clamp_preserve_colour", given.clamp_preserve_colour);
  if (given.clamp_maximum != 0.0F) wanted.clamp = RadianceClamp{given.clamp_maximum, preserve_colour};
  wanted.gamma = flag("gamma", given.gamma);
  wanted.nan = non_finite("reject_nan", given.reject_nan);
  wanted.infinity = non_finite("reject_infinity", given.reject_infinity);
  wanted.negative = enumerator("negative", given.negative, NegativePolicy::reject);
  return wanted;
}

// Plain numbers.

glm::dvec3 read_triple(const double* values, const char* name) {
  require(values, name);
  return {values[0], values[1], values[2]};
}

void write_triple(const glm::dvec3& values, double* target) noexcept {
  for (int i = 0; i < 3; ++i) target[i] = values[i];
}

void write_matrix(const glm::dmat3& matrix, double* target) noexcept {
  for (int column = 0; column < 3; ++column) write_triple(matrix[column], target + 3 * column);
}

SphericalHarmonics read_harmonics(std::int32_t bands, const double* coefficients, const char* name) {
  require(coefficients, name);
  SphericalHarmonics harmonics(bands);
  const auto given = triples(coefficients, harmonics.coefficients().size());
  std::copy(given.begin(), given.end(), harmonics.coefficients().begin());
  return harmonics;
}

void write_harmonics(const SphericalHarmonics& harmonics, double* target) noexcept {
  const auto from = harmonics.coefficients();
  std::copy(from.begin(), from.end(), triples(target, from.size()).begin());
}

void require_room(const welkin_projection* projection, int bands) {
  require_room_for_bands(projection, bands, "projection");
}

namespace {

welkin_projection plain(const ProjectionDiagnostics& diagnostics) {
  welkin_projection values{};
  values.texels = diagnostics.texels;
  values.nans_replaced = diagnostics.nans_replaced;
  values.infinities_replaced = diagnostics.infinities_replaced;
  values.negatives_replaced = diagnostics.negatives_replaced;
  values.texels_clamped = diagnostics.texels_clamped;
  write_triple(diagnostics.total_radiance_before_clamp, values.total_radiance_before_clamp);
  write_triple(diagnostics.total_radiance, values.total_radiance);
  values.error_estimate = diagnostics.error_estimate;
  return values;
}

}  // namespace

void write_projection(welkin_projection* projection, const SphericalHarmonics& radiance,
                      const ProjectionDiagnostics& diagnostics) {
  require_room(projection, radiance.bands());
  welkin_projection values = plain(diagnostics);
  values.bands = radiance.bands();
  write_harmonics(radiance, values.coefficients);
  write_struct(projection, values, "projection");
}

void write_diagnostics(welkin_projection* totals, const ProjectionDiagnostics& diagnostics) {
  write_struct(totals, plain(diagnostics), "totals");
}

// The caller's memory.

namespace {

image::TexelLayout texel_layout(welkin_format format) {
  switch (format) {
    case WELKIN_FORMAT_RGB_F32: return {3, false};
    case WELKIN_FORMAT_RGBA_F32: return {4, false};
    case WELKIN_FORMAT_RGB_F16: return {3, true};
    case WELKIN_FORMAT_RGBA_F16: return {4, true};
    case WELKIN_FORMAT_RG_F32: return {2, false};
    case WELKIN_FORMAT_RG_F16: return {2, true};
    default:
      refuse("the target's format is " + std::to_string(format) + "; RG, RGB and RGBA of F32 and F16 are written");
  }
}

Target checked_target(welkin_format format, std::int64_t row_stride_bytes, int width, int height) {
  Target target;
  target.width = width;
  target.height = height;
  target.layout = texel_layout(format);
  const auto row = static_cast<std::ptrdiff_t>(target.layout.texel_bytes()) * width;
  target.stride = row_stride_bytes == 0 ? row : stride(row_stride_bytes);
  if (std::abs(target.stride) < row) {
    refuse("the target's row_stride_bytes is " + std::to_string(row_stride_bytes) + ", less than a row of " +
           std::to_string(row) + " bytes");
  }
  if (target.stride % static_cast<std::ptrdiff_t>(target.layout.channel_bytes()) != 0) {
    refuse("the target's row_stride_bytes is " + std::to_string(row_stride_bytes) +
           ", which leaves rows unaligned to their channels of " + std::to_string(target.layout.channel_bytes()) +
           " bytes");
  }
  return target;
}

void add_image(Target& target, void* pixels) {
  const std::string which = target.count > 0 ? "image " + std::to_string(target.count) : "image";
  if (pixels == nullptr) refuse("the target's " + which + " is null");
  if (reinterpret_cast<std::uintptr_t>(pixels) % target.layout.channel_bytes() != 0) {
    refuse("the target's " + which + " is not aligned to its channels, which take " +
           std::to_string(target.layout.channel_bytes()) + " bytes each");
  }
  target.images[static_cast<std::size_t>(target.count++)] = static_cast<std::byte*>(pixels);
}

}  // namespace

Target target_of(const welkin_target* target) {
  const auto given = read_struct(target, "target");
  const bool flat = given.size == 0 && given.width != 0;
  const int size = face_size(given.size);
  if (flat) {
    image::check_lat_long_size(given.width, given.height);
  } else {
    if (given.width != 0 || given.height != 0) refuse("the target has both a size and a width or height; set either");
    image::check_face_size(size);
  }
  Target checked =
      checked_target(given.format, given.row_stride_bytes, flat ? given.width : size, flat ? given.height : size);
  for (int face = 0; face < (flat ? 1 : 6); ++face) add_image(checked, given.faces[face]);
  return checked;
}

Target cubemap_target(const welkin_target* target) {
  const Target checked = target_of(target);
  if (checked.count != 6) refuse("the target is a flat image, but a cubemap is written; set its size");
  return checked;
}

Target flat_target(const welkin_target* target) {
  const Target checked = target_of(target);
  if (checked.count != 1) refuse("the target is a cubemap, but a flat image is written; set its width and height");
  return checked;
}

std::vector<CubemapTarget> cubemap_targets(const welkin_target* targets, std::int64_t count, const std::string& name) {
  constexpr std::int64_t most = std::int64_t{kMaxLevels} * std::numeric_limits<std::int32_t>::max();
  image::require_range(("the number of " + name).c_str(), count, 0, most);
  std::vector<CubemapTarget> written;
  if (count == 0) return written;
  written.reserve(static_cast<std::size_t>(count));
  for (const welkin_target& given : read_structs(targets, static_cast<std::size_t>(count), name)) {
    const std::size_t k = written.size();
    if (given.format != WELKIN_FORMAT_RGBA_F16 && given.format != WELKIN_FORMAT_RGBA_F32) {
      refuse(name + "[" + std::to_string(k) + "].format is " + std::to_string(given.format) +
             "; RGBA_F16 and RGBA_F32 are written");
    }
    CubemapTarget& to = written.emplace_back();
    std::copy(std::begin(given.faces), std::end(given.faces), to.faces.begin());
    to.size = face_size(given.size);
    to.row_stride_bytes = stride(given.row_stride_bytes);
    to.format = given.format == WELKIN_FORMAT_RGBA_F16 ? TexelFormat::rgba16f : TexelFormat::rgba32f;
  }
  return written;
}

void require_size(const Target& target, int width, int height) {
  if (target.width == width && target.height == height) return;
  refuse("the target has " + std::to_string(target.width) + " x " + std::to_string(target.height) +
         " texels; the written image has " + std::to_string(width) + " x " + std::to_string(height));
}

std::uint64_t write_image(const Target& target, int image, const float* values, int channels) noexcept {
  std::byte* const first = target.images[static_cast<std::size_t>(image)];
  const auto width = static_cast<std::size_t>(target.width);
  std::uint64_t changed = 0;
  for (int row = 0; row < target.height; ++row, values += width * static_cast<std::size_t>(channels)) {
    changed += image::encode_texels(values, channels, width, target.layout, first + row * target.stride);
  }
  return changed;
}

std::uint64_t write_faces(const Target& target, const CubemapView& cubemap) noexcept {
  std::uint64_t changed = 0;
  for (int face = 0; face < target.count; ++face) {
    const void* const pixels = cubemap.faces[static_cast<std::size_t>(face)];
    changed += write_image(target, face, static_cast<const float*>(pixels), 3);
  }
  return changed;
}

}  // namespace welkin::c_interface

using namespace welkin::c_interface;  // NOLINT(google-build-using-namespace,google-global-names-in-headers)

void welkin_keep_working_memory(uint64_t bytes) {
  constexpr std::uint64_t most = std::numeric_limits<std::size_t>::max();
  welkin::keep_working_memory(static_cast<std::size_t>(std::min(bytes, most)));
}

void welkin_release_working_memory() { welkin::release_working_memory(); }

const char* welkin_status_name(welkin_status status) {
  switch (status) {
    case WELKIN_OK: return "ok";
    case WELKIN_OUT_OF_MEMORY: return "out_of_memory";
    case WELKIN_NOT_READY: return "not_ready";
    case WELKIN_INTERNAL: return "internal";
    default: break;
  }
  // The other statuses are those of the error codes.
  for (int number = 0; number <= static_cast<int>(welkin::ErrorCode::stopped); ++number) {
    const auto code = static_cast<welkin::ErrorCode>(number);
    if (status_of(code) == status) return welkin::name(code);
  }
  return "unknown";
}

const char* welkin_last_error() { return last_error.text; }

uint32_t welkin_c_version() { return WELKIN_C_VERSION; }

int32_t welkin_control_stop_requested(const welkin_control* control) {
  return control != nullptr && control->control.stop.stop_requested() ? 1 : 0;
}

welkin_status welkin_control_report_progress(const welkin_control* control, double done) {
  return guarded([&] {
    require(control, "control");
    if (!(done >= 0.0 && done <= 1.0))
      refuse("done is " + welkin::platform::number_text(done) + "; it must be from 0 to 1");
    if (control->control.progress) control->control.progress(done);
  });
}
