// Promise: saved sky tables come back bit by bit; a damaged file is refused, whatever the damage.
#include <algorithm>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include "support/catch.h"
#include "support/temporary_directory.h"
#include "support/thrown_error.h"
#include "welkin/sky_tables.h"

namespace welkin::test {
namespace {

SkyTableOptions tiny_options(ScatteringLayout layout) {
  return {.layout = layout,
          .heights = 2,
          .view_zeniths = 4,
          .sun_zeniths = 4,
          .sun_angles = 2,
          .transmittance_heights = 2,
          .transmittance_zeniths = 3,
          .irradiance_heights = 2,
          .irradiance_sun_zeniths = 2,
          .orders = 2};
}

std::vector<char> bytes_of(const std::filesystem::path& path) {
  std::ifstream in(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

void write(const std::filesystem::path& path, const std::vector<char>& bytes) {
  std::ofstream out(path, std::ios::binary);
  out.write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
}

bool refused(const std::filesystem::path& path) {
  try {
    static_cast<void>(load_sky_tables(path, std::uint64_t{1} << 20U));
  } catch (const Error& error) {
    return std::string(error.what()).find(path.filename().string()) != std::string::npos;
  }
  return false;
}

}  // namespace

TEST_CASE("Saved sky tables come back with all their parameters and bits", "[sky][codec]") {
  const TemporaryDirectory directory;
  for (const ScatteringLayout layout : {ScatteringLayout::full, ScatteringLayout::compact}) {
    for (const Atmosphere& air : {earth(), mars(), earth_hillaire()}) {
      const SkyTables tables = precompute_sky(air, tiny_options(layout));
      save_sky_tables(tables, directory.file("sky.tables"));
      const SkyTables back = load_sky_tables(directory.file("sky.tables"));
      CHECK(back.atmosphere == tables.atmosphere);
      CHECK(back.options == tables.options);
      CHECK(back.transmittance == tables.transmittance);
      CHECK(back.scattering == tables.scattering);
      CHECK(back.single_mie == tables.single_mie);
      CHECK(back.irradiance == tables.irradiance);
      CHECK(back.orders == tables.orders);
      CHECK(back.last_change == tables.last_change);
    }
  }
  CHECK(std::distance(std::filesystem::directory_iterator(directory.file("")), {}) == 1);
}

TEST_CASE("Sky tables cut off anywhere or changed in any byte are refused", "[sky][codec]") {
  const TemporaryDirectory directory;
  const std::filesystem::path path = directory.file("sky.tables");
  save_sky_tables(precompute_sky(earth(), tiny_options(ScatteringLayout::compact)), path);
  const std::vector<char> sound = bytes_of(path);
  REQUIRE(!refused(path));
  const std::filesystem::path damaged = directory.file("damaged.tables");
  constexpr std::size_t header = 600;  // all parameters, and more
  REQUIRE(sound.size() > header);
  for (std::size_t length = 0; length < sound.size(); length += length < header ? 1 : 7) {
    write(damaged, {sound.begin(), sound.begin() + static_cast<std::ptrdiff_t>(length)});
    if (!refused(damaged)) FAIL("cut off after " << length);
  }
  std::vector<char> longer = sound;
  longer.push_back(0);
  write(damaged, longer);
  CHECK(refused(damaged));
  for (std::size_t place = 0; place < sound.size(); place += place < header ? 1 : 7) {
    for (const int flip : {0x01, 0xff}) {
      std::vector<char> bytes = sound;
      bytes[place] = static_cast<char>(bytes[place] ^ flip);
      write(damaged, bytes);
      if (!refused(damaged)) FAIL("byte " << place << " changed by " << flip);
    }
  }
}

TEST_CASE("Refused sky tables say why", "[sky][codec]") {
  const TemporaryDirectory directory;
  const std::filesystem::path path = directory.file("sky.tables");
  save_sky_tables(precompute_sky(earth(), tiny_options(ScatteringLayout::full)), path);
  const auto load = [&](std::uint64_t limit = 1U << 30U) {
    return thrown_by([&] { static_cast<void>(load_sky_tables(path, limit)); });
  };
  CHECK(load(100).code == ErrorCode::limit_exceeded);
  std::vector<char> bytes = bytes_of(path);
  bytes[8] = 3;
  write(path, bytes);
  CHECK(load().code == ErrorCode::unsupported_file);
  CHECK(load().says("version 3"));
  bytes[8] = 2;
  bytes.back() = static_cast<char>(bytes.back() ^ 1);
  write(path, bytes);
  CHECK(load().code == ErrorCode::corrupt_file);
  CHECK(load().says("checksum"));
  write(path, std::vector<char>(100, 'x'));
  CHECK(load().code == ErrorCode::unsupported_file);
  std::filesystem::remove(path);
  CHECK(load().code == ErrorCode::file_access);
  CHECK(thrown_by([&] {
          save_sky_tables(precompute_sky(earth(), tiny_options(ScatteringLayout::compact)),
                          directory.file("missing/sky.tables"));
        }).code == ErrorCode::file_access);
  SkyTables odd = precompute_sky(earth(), tiny_options(ScatteringLayout::compact));
  odd.scattering.pop_back();
  CHECK(thrown_by([&] { save_sky_tables(odd, path); }).code == ErrorCode::invalid_argument);
  odd = precompute_sky(earth(), tiny_options(ScatteringLayout::compact));
  odd.atmosphere.name.assign(5000, 'n');
  CHECK(thrown_by([&] { save_sky_tables(odd, path); }).code == ErrorCode::invalid_argument);
  CHECK(!std::filesystem::exists(path));
}

}  // namespace welkin::test
