// Sky tables in a file, all little-endian:
//
//   8 bytes "WLKNSKY" and a line feed; uint32 version; uint32 CRC-32 of all that follows; uint64 bytes that follow;
//   uint32 bytes of parameters; the parameters, in the order of `parameters`; transmittance, scattering, single
//   Mie and irradiance as floats, their sizes being those that the options give.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <string>
#include <type_traits>
#include <vector>

#include "files/crc32.h"
#include "files/row_source.h"
#include "platform/file.h"
#include "platform/float_environment.h"
#include "platform/standard_library.h"
#include "sky/table_sizes.h"
#include "welkin/bake_file.h"
#include "welkin/sky.h"

namespace welkin {
namespace {

using files::crc32;
using platform::ByteFile;
using platform::file_error;

[[noreturn]] void damaged(const std::filesystem::path& path, const std::string& what) {
  throw file_error(ErrorCode::corrupt_file, path, what);
}

constexpr std::array<char, 8> kMagic{'W', 'L', 'K', 'N', 'S', 'K', 'Y', '\n'};
// Tables are results, whose bits may change with every minor version of the library; the last two digits count changes
// of the format.
constexpr std::uint32_t kVersion = 10'000 * WELKIN_VERSION_MAJOR + 100 * WELKIN_VERSION_MINOR + 8;
constexpr std::size_t kHeaderBytes = 24;
constexpr std::size_t kSummedFrom = 16;  ///< earlier bytes are not in the checksum
constexpr std::uint32_t kMaxParameterBytes = 1U << 20U;
constexpr std::size_t kMaxText = 4096;

/// A number of the file: reals are doubles; integers have 8 bytes or 4, as enumerators have.
template <class Value>
inline constexpr bool kIsNumber = std::is_arithmetic_v<Value> || std::is_enum_v<Value>;

/// Appends values to bytes, or reads them back; lists state their length first. Nothing is read past the end, and
/// every count that is read must be within a limit.
class Archive {
 public:
  enum class Way { write, read };

  Archive(Way way, std::vector<std::uint8_t>& bytes, const std::filesystem::path& path)
      : way_(way), bytes_(bytes), path_(path) {}

  template <class... Values>
  void all(Values&... values) {
    (each(values), ...);
  }
  [[nodiscard]] bool at_end() const noexcept { return position_ == bytes_.size(); }

 private:
  template <class Value>
  void each(Value& value) requires kIsNumber<Value> {
    std::conditional_t<sizeof(Value) == sizeof(std::uint64_t), std::uint64_t, std::uint32_t> bits{};
    if constexpr (std::is_floating_point_v<Value>) {
      bits = platform::bit_cast<std::uint64_t>(value);
      raw(&bits, sizeof bits);
      value = platform::bit_cast<double>(bits);
    } else {
      bits = static_cast<decltype(bits)>(value);
      raw(&bits, sizeof bits);
      value = static_cast<Value>(bits);
    }
  }
  void each(std::string& text) {
    text.resize(count(text.size(), kMaxText, "characters of the name"));
    raw(text.data(), text.size());
  }
  void each(std::vector<double>& values) { list(values, 96, "values of a spectrum"); }
  void each(std::vector<DensityLayer>& layers) { list(layers, 8, "layers"); }
  void each(std::vector<Constituent>& absorbers) { list(absorbers, 4, "absorbers"); }
  void each(DensityLayer& layer) {
    all(layer.thickness_m, layer.exponential_term, layer.exponential_scale_per_m, layer.linear_term_per_m,
        layer.constant_term);
  }
  void each(Constituent& matter) { all(matter.density, matter.scattering_per_m, matter.absorption_per_m); }

  template <class Value>
  void list(std::vector<Value>& values, std::size_t most, const char* what) {
    values.resize(count(values.size(), most, what));
    for (Value& value : values) each(value);
  }
  /// `size` is that to write; returns the size written or read.
  std::size_t count(std::size_t size, std::size_t most, const char* what) {
    auto stated = static_cast<std::uint32_t>(size);
    each(stated);
    if (way_ == Way::read && stated > most) {
      damaged(path_,
              "states " + std::to_string(stated) + " " + what + ", more than the limit of " + std::to_string(most));
    }
    return stated;
  }
  void raw(void* value, std::size_t count) {
    if (way_ == Way::write) bytes_.resize(position_ + count);
    if (count > bytes_.size() - position_) damaged(path_, "its parameters end too early");
    std::uint8_t* const slot = bytes_.data() + position_;
    position_ += count;
    if (count == 0) return;
    way_ == Way::write ? std::memcpy(slot, value, count) : std::memcpy(value, slot, count);
  }

  Way way_;
  std::vector<std::uint8_t>& bytes_;
  const std::filesystem::path& path_;
  std::size_t position_ = 0;
};

/// Saves or loads everything but the tables themselves.
void parameters(Archive& archive, SkyTables& tables) {
  Atmosphere& air = tables.atmosphere;
  archive.all(air.name, air.wavelengths_nm, air.bottom_radius_m, air.top_radius_m, air.rayleigh, air.aerosol,
              air.aerosol_asymmetry, air.aerosol_asymmetries, air.ground_albedo, air.solar_irradiance,
              air.sun_angular_radius_degrees, air.night_zenith_luminance);
  SkyTableOptions& options = tables.options;
  archive.all(options.heights, options.view_zeniths, options.sun_zeniths, options.sun_angles,
              options.transmittance_heights, options.transmittance_zeniths, options.irradiance_heights,
              options.irradiance_sun_zeniths, options.minimum_sun_elevation_degrees, options.orders,
              options.convergence_threshold, options.memory_limit_bytes, tables.orders, tables.last_change);
  archive.all(air.absorbers, air.aerosol_phase, options.layout, options.colour, options.truncate_orders);
}

std::vector<std::uint8_t> write_parameters(const SkyTables& tables, const std::filesystem::path& path) {
  SkyTables stated;
  stated.atmosphere = tables.atmosphere;
  stated.options = tables.options;
  stated.orders = tables.orders;
  stated.last_change = tables.last_change;
  std::vector<std::uint8_t> bytes;
  Archive archive(Archive::Way::write, bytes, path);
  parameters(archive, stated);
  return bytes;
}

SkyTables read_parameters(std::vector<std::uint8_t>& bytes, const std::filesystem::path& path) {
  SkyTables tables;
  Archive archive(Archive::Way::read, bytes, path);
  parameters(archive, tables);
  if (!archive.at_end()) damaged(path, "has bytes after its parameters");
  try {
    check(tables.atmosphere);
    sky::check_options(tables.options);
  } catch (const Error& error) {
    damaged(path, error.what());
  }
  if (tables.orders < 1 || tables.orders > tables.options.orders || !std::isfinite(tables.last_change)) {
    damaged(path, "states more orders than were computed");
  }
  return tables;
}

/// Calls `use` for the tables themselves, in the order of the file.
template <class Tables, class Use>
void for_each_table(Tables& tables, const Use& use) {
  use(tables.transmittance, sky::transmittance_floats(tables.options));
  const std::uint64_t scattering = 4 * sky::scattering_texels(tables.options);
  use(tables.scattering, scattering);
  use(tables.single_mie, sky::single_mie_floats(tables.atmosphere, tables.options));
  use(tables.irradiance, sky::irradiance_floats(tables.options));
}

void read_table(ByteFile& file, std::vector<float>& values, std::uint64_t count, std::uint32_t& sum) {
  values.resize(count);
  file.read(values.data(), values.size() * sizeof(float));
  sum = crc32(sum, values.data(), values.size() * sizeof(float));
}

bool sound(const std::vector<float>& values) {
  return std::all_of(values.begin(), values.end(), [](float value) { return value >= 0.0F && std::isfinite(value); });
}

}  // namespace

void save_sky_tables(const SkyTables& tables, const FileOutput& output) {
  const platform::FloatingPointScope floating_point;
  check(tables.atmosphere);
  sky::check_options(tables.options);
  if (tables.atmosphere.name.size() > kMaxText) {
    throw Error(ErrorCode::invalid_argument, "the atmosphere's name has " +
                                                 std::to_string(tables.atmosphere.name.size()) +
                                                 " bytes; a file of sky tables holds " + std::to_string(kMaxText));
  }
  const std::vector<std::uint8_t> stated = write_parameters(tables, output.path());
  std::uint64_t following = sizeof(std::uint32_t) + stated.size();
  for_each_table(tables, [&](const std::vector<float>& values, std::uint64_t count) {
    if (values.size() != count) {
      throw Error(ErrorCode::invalid_argument,
                  "the sizes of the sky tables differ from their options; pass tables of precompute_sky");
    }
    following += values.size() * sizeof(float);
  });
  std::vector<std::uint8_t> header;  // from the first byte that the checksum covers
  platform::append_little_endian(header, following);
  platform::append_little_endian(header, static_cast<std::uint32_t>(stated.size()));
  header.insert(header.end(), stated.begin(), stated.end());
  std::uint32_t sum = crc32(0, header.data(), header.size());
  for_each_table(tables, [&](const std::vector<float>& values, std::uint64_t) {
    sum = crc32(sum, values.data(), values.size() * sizeof(float));
  });
  platform::WholeFile file(output.path(), output.bytes());
  std::vector<std::uint8_t> start(kMagic.begin(), kMagic.end());
  platform::append_little_endian(start, kVersion);
  platform::append_little_endian(start, sum);
  file.write(start.data(), start.size());
  file.write(header.data(), header.size());
  for_each_table(tables, [&](const std::vector<float>& values, std::uint64_t) {
    file.write(values.data(), values.size() * sizeof(float));
  });
  file.finish();
  file.commit();
}

SkyTables load_sky_tables(const FileInput& input, std::uint64_t memory_limit_bytes) {
  const platform::FloatingPointScope floating_point;
  ByteFile file = files::open_file(input);
  const std::filesystem::path& path = file.path();
  std::array<std::uint8_t, kHeaderBytes + sizeof(std::uint32_t)> start{};
  if (file.size() < kMagic.size()) damaged(path, "is too short for sky tables");
  file.read(start.data(), std::min<std::uint64_t>(start.size(), file.size()));
  if (std::memcmp(start.data(), kMagic.data(), kMagic.size()) != 0) {
    throw file_error(ErrorCode::unsupported_file, path, "holds no sky tables; make some with precompute_sky");
  }
  if (file.size() < start.size()) damaged(path, "is cut off in its header");
  const auto version = platform::read_little_endian<std::uint32_t>(start.data() + 8);
  if (version != kVersion) {
    throw file_error(ErrorCode::unsupported_file, path,
                     "has version " + std::to_string(version) + " of the format, this library reads version " +
                         std::to_string(kVersion) + "; compute it again");
  }
  const auto wanted = platform::read_little_endian<std::uint32_t>(start.data() + 12);
  const auto following = platform::read_little_endian<std::uint64_t>(start.data() + 16);
  const auto stated = platform::read_little_endian<std::uint32_t>(start.data() + kHeaderBytes);
  if (following != file.size() - kHeaderBytes) {
    damaged(path, "states " + std::to_string(following) + " bytes after its header, " +
                      std::to_string(file.size() - kHeaderBytes) + " are there");
  }
  if (stated > kMaxParameterBytes || stated > following - sizeof stated) {
    damaged(path, "states more bytes of parameters than there are");
  }
  std::vector<std::uint8_t> bytes(stated);
  file.read(bytes.data(), bytes.size());
  std::uint32_t sum = crc32(0, start.data() + kSummedFrom, start.size() - kSummedFrom);
  sum = crc32(sum, bytes.data(), bytes.size());
  SkyTables tables = read_parameters(bytes, path);
  const std::uint64_t size = sky::result_bytes(tables.atmosphere, tables.options);
  if (size != following - sizeof stated - stated) {
    damaged(path, "its tables do not have the size of its options");
  }
  if (size > memory_limit_bytes) {
    throw file_error(ErrorCode::limit_exceeded, path,
                     "needs " + std::to_string(size) + " bytes, the limit is " + std::to_string(memory_limit_bytes) +
                         "; raise it to read this file");
  }
  for_each_table(tables,
                 [&](std::vector<float>& values, std::uint64_t count) { read_table(file, values, count, sum); });
  if (sum != wanted) damaged(path, "its checksum differs");
  for_each_table(tables, [&](const std::vector<float>& values, std::uint64_t) {
    if (!sound(values)) {
      damaged(path, "holds values that are negative or not finite");
    }
  });
  tables.passes = {{"scattering", PassAction::reuse, "read from a file", 0.0}};
  return tables;
}

}  // namespace welkin
