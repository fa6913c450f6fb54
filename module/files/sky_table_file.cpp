// Sky tables in a file of their own, all little-endian:
//
//   8 bytes "WLKNSKY" and a line feed; uint32 version; uint32 CRC-32 of all that follows; uint64 bytes that follow;
//   uint32 bytes of parameters; the parameters, in the order of `write_parameters`; transmittance, scattering, single
//   Mie and irradiance as floats, their sizes being those that the options give.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <string>
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
// of the form.
constexpr std::uint32_t kVersion = 10'000 * WELKIN_VERSION_MAJOR + 100 * WELKIN_VERSION_MINOR + 8;
constexpr std::size_t kHeaderBytes = 24;
constexpr std::size_t kSummedFrom = 16;  ///< what lies before is not in the checksum
constexpr std::uint32_t kMaxParameterBytes = 1U << 20U;
constexpr std::size_t kMaxText = 4096;
constexpr std::size_t kMaxValues = 96;
constexpr std::size_t kMaxLayers = 8;
constexpr std::size_t kMaxAbsorbers = 4;

constexpr std::array kLayerFields{&DensityLayer::thickness_m, &DensityLayer::exponential_term,
                                  &DensityLayer::exponential_scale_per_m, &DensityLayer::linear_term_per_m,
                                  &DensityLayer::constant_term};

/// Appends values to bytes.
class Writer {
 public:
  std::vector<std::uint8_t> bytes;

  void put(std::uint32_t value) { platform::append_little_endian(bytes, value); }
  void put(std::uint64_t value) { platform::append_little_endian(bytes, value); }
  void put(int value) { put(static_cast<std::uint32_t>(value)); }
  void put(double value) { put(platform::bit_cast<std::uint64_t>(value)); }
  void put(const std::string& text) {
    put(static_cast<std::uint32_t>(text.size()));
    bytes.insert(bytes.end(), text.begin(), text.end());
  }
  void put(const std::vector<double>& values) {
    put(static_cast<std::uint32_t>(values.size()));
    for (const double value : values) put(value);
  }
  void put(const DensityLayer& layer) {
    for (const auto field : kLayerFields) put(layer.*field);
  }
  void put(const Constituent& matter) {
    put(static_cast<std::uint32_t>(matter.density.size()));
    for (const DensityLayer& layer : matter.density) put(layer);
    put(matter.scattering_per_m);
    put(matter.absorption_per_m);
  }
};

/// Takes them back; nothing is read past the end, and no count is believed that the end does not bear out.
class Reader {
 public:
  Reader(const std::vector<std::uint8_t>& bytes, const std::filesystem::path& path) : bytes_(bytes), path_(path) {}

  void get(std::uint32_t& value) { value = platform::read_little_endian<std::uint32_t>(take(sizeof value)); }
  void get(std::uint64_t& value) { value = platform::read_little_endian<std::uint64_t>(take(sizeof value)); }
  void get(int& value) {
    std::uint32_t bits = 0;
    get(bits);
    value = static_cast<int>(bits);
  }
  void get(double& value) {
    std::uint64_t bits = 0;
    get(bits);
    value = platform::bit_cast<double>(bits);
  }
  void get(std::string& text) {
    const std::size_t length = count(kMaxText, "characters of the name");
    const std::uint8_t* const first = take(length);
    text.assign(first, first + length);
  }
  void get(std::vector<double>& values) {
    values.resize(count(kMaxValues, "values of a spectrum"));
    for (double& value : values) get(value);
  }
  void get(DensityLayer& layer) {
    for (const auto field : kLayerFields) get(layer.*field);
  }
  void get(Constituent& matter) {
    matter.density.resize(count(kMaxLayers, "layers"));
    for (DensityLayer& layer : matter.density) get(layer);
    get(matter.scattering_per_m);
    get(matter.absorption_per_m);
  }
  std::size_t count(std::size_t most, const char* what) {
    std::uint32_t value = 0;
    get(value);
    if (value > most) {
      damaged(path_,
              "states " + std::to_string(value) + " " + what + ", more than the limit of " + std::to_string(most));
    }
    return value;
  }
  [[nodiscard]] bool at_end() const noexcept { return position_ == bytes_.size(); }

 private:
  const std::uint8_t* take(std::size_t count) {
    if (count > bytes_.size() - position_) {
      damaged(path_, "its parameters end too early");
    }
    position_ += count;
    return bytes_.data() + (position_ - count);
  }

  const std::vector<std::uint8_t>& bytes_;
  const std::filesystem::path& path_;
  std::size_t position_ = 0;
};

/// One list for both ways. Tables: SkyTables or const SkyTables.
template <class Archive, class Tables>
void parameters(Archive&& each, Tables& tables) {
  auto& air = tables.atmosphere;
  each(air.name, air.wavelengths_nm, air.bottom_radius_m, air.top_radius_m, air.rayleigh, air.aerosol,
       air.aerosol_asymmetry, air.aerosol_asymmetries, air.ground_albedo, air.solar_irradiance,
       air.sun_angular_radius_degrees, air.night_zenith_luminance);
  auto& options = tables.options;
  each(options.heights, options.view_zeniths, options.sun_zeniths, options.sun_angles, options.transmittance_heights,
       options.transmittance_zeniths, options.irradiance_heights, options.irradiance_sun_zeniths,
       options.minimum_sun_elevation_degrees, options.orders, options.convergence_threshold, options.memory_limit_bytes,
       tables.orders, tables.last_change);
}

std::vector<std::uint8_t> write_parameters(const SkyTables& tables) {
  Writer writer;
  parameters([&](const auto&... values) { (writer.put(values), ...); }, tables);
  writer.put(static_cast<std::uint32_t>(tables.atmosphere.absorbers.size()));
  for (const Constituent& absorber : tables.atmosphere.absorbers) writer.put(absorber);
  writer.put(static_cast<int>(tables.atmosphere.aerosol_phase));
  writer.put(static_cast<int>(tables.options.layout));
  writer.put(static_cast<int>(tables.options.colour));
  writer.put(static_cast<int>(tables.options.truncate_orders));
  return std::move(writer.bytes);
}

SkyTables read_parameters(const std::vector<std::uint8_t>& bytes, const std::filesystem::path& path) {
  SkyTables tables;
  Reader reader(bytes, path);
  parameters([&](auto&... values) { (reader.get(values), ...); }, tables);
  tables.atmosphere.absorbers.resize(reader.count(kMaxAbsorbers, "absorbers"));
  for (Constituent& absorber : tables.atmosphere.absorbers) reader.get(absorber);
  int phase = 0;
  int layout = 0;
  int colour = 0;
  int truncate_orders = 0;
  for (int* const value : {&phase, &layout, &colour, &truncate_orders}) reader.get(*value);
  tables.atmosphere.aerosol_phase = static_cast<AerosolPhase>(phase);
  tables.options.layout = static_cast<ScatteringLayout>(layout);
  tables.options.colour = static_cast<SkyColour>(colour);
  tables.options.truncate_orders = truncate_orders != 0;
  if (!reader.at_end()) damaged(path, "has bytes after its parameters");
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

/// The tables themselves, in the order of the file.
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
  const std::vector<std::uint8_t> stated = write_parameters(tables);
  std::uint64_t following = sizeof(std::uint32_t) + stated.size();
  for_each_table(tables, [&](const std::vector<float>& values, std::uint64_t count) {
    if (values.size() != count) {
      throw Error(ErrorCode::invalid_argument,
                  "the sizes of the sky tables differ from their options; pass tables of precompute_sky");
    }
    following += values.size() * sizeof(float);
  });
  Writer header;  // from the checksum's first byte on
  header.put(following);
  header.put(static_cast<std::uint32_t>(stated.size()));
  std::uint32_t sum = crc32(0, header.bytes.data(), header.bytes.size());
  sum = crc32(sum, stated.data(), stated.size());
  for_each_table(tables, [&](const std::vector<float>& values, std::uint64_t) {
    sum = crc32(sum, values.data(), values.size() * sizeof(float));
  });
  platform::WholeFile file(output.path(), output.bytes());
  Writer start;
  start.put(kVersion);
  start.put(sum);
  file.write(kMagic.data(), kMagic.size());
  file.write(start.bytes.data(), start.bytes.size());
  file.write(header.bytes.data(), header.bytes.size());
  file.write(stated.data(), stated.size());
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
