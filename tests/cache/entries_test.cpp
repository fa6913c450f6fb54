// The names of cache entries, and the validation of every entry.
#include "cache/entry_store.h"
#include "cache/recipe.h"
#include "cache/result_cache.h"
#include "support/catch.h"
#include "support/payload.h"
#include "support/same_bits.h"
#include "support/small_skies.h"
#include "support/temporary_directory.h"
#include "support/test_environments.h"
#include "support/thrown_error.h"
#include "welkin/environment_file.h"
#include "welkin/result_cache.h"

namespace welkin::test {

// Hashes depend on the content of pixels and options, and on nothing else.

namespace {

/// Texels of another image in memory with padded rows, optionally upside down, and junk between the rows.
struct Strided {
  std::vector<std::byte> memory;
  CubemapView view;
};

Strided strided(const CubemapView& packed, std::ptrdiff_t padding, bool upside_down) {
  const auto rows = static_cast<std::ptrdiff_t>(packed.size);
  const auto row = static_cast<std::ptrdiff_t>(bytes_per_texel(packed.format)) * rows;
  const std::ptrdiff_t stride = row + padding;
  Strided result{std::vector<std::byte>(static_cast<std::size_t>(6 * rows * stride), std::byte{0x5a}), packed};
  for (std::ptrdiff_t face = 0; face < 6; ++face) {
    std::byte* const first = result.memory.data() + face * rows * stride;
    for (std::ptrdiff_t r = 0; r < rows; ++r) {
      const auto* const from = static_cast<const std::byte*>(packed.faces[static_cast<std::size_t>(face)]) + r * row;
      std::memcpy(first + (upside_down ? rows - 1 - r : r) * stride, from, static_cast<std::size_t>(row));
    }
    result.view.faces[static_cast<std::size_t>(face)] = upside_down ? first + (rows - 1) * stride : first;
  }
  result.view.row_stride_bytes = upside_down ? -stride : stride;
  return result;
}

TEST_CASE("hash: where rows lie in memory does not matter") {
  for (const int size : {1, 2, 37, 128}) {
    const TestCubemap cubemap = make_cubemap(Content::smooth, size, 4, 7);
    const ContentHash hash = hash_pixels(cubemap.view());
    CHECK(hash_pixels(strided(cubemap.view(), 0, false).view) == hash);
    CHECK(hash_pixels(strided(cubemap.view(), 48, false).view) == hash);
    CHECK(hash_pixels(strided(cubemap.view(), 16, true).view) == hash);
  }
}

TEST_CASE("hash: every texel, every channel and every face counts") {
  const TestCubemap original = make_cubemap(Content::random, 150, 3, 1);
  const std::array<ContentHash, 6> faces = cache::hash_faces(original.view(), {});
  std::set<ContentHash> seen{hash_pixels(original.view())};
  const std::size_t face_values = original.pixels.size() / 6;
  // First and last values of faces and of the blocks of rows that are hashed separately.
  const std::vector<std::size_t> offsets = {0, 1, 2, 449, 450, face_values - 1, 65535, 65536, face_values / 2};
  for (std::size_t face = 0; face < 6; ++face) {
    for (const std::size_t offset : offsets) {
      TestCubemap changed = original;
      changed.pixels[face * face_values + offset] += 1.0F;
      INFO(face << ' ' << offset);
      CHECK(seen.insert(hash_pixels(changed.view())).second);
      const std::array<ContentHash, 6> now = cache::hash_faces(changed.view(), {});
      for (std::size_t other = 0; other < 6; ++other) CHECK((now[other] == faces[other]) == (other != face));
    }
  }
}

TEST_CASE("hash: faces in another order are another cubemap") {
  const TestCubemap cubemap = make_cubemap(Content::random, 8, 3, 1);
  CubemapView swapped = cubemap.view();
  std::swap(swapped.faces[0], swapped.faces[1]);
  CHECK(hash_pixels(swapped) != hash_pixels(cubemap.view()));
  CHECK(cache::hash_faces(swapped, {})[0] == cache::hash_faces(cubemap.view(), {})[1]);
}

TEST_CASE("hash: what no call accepts is refused, and cancelling works") {
  CHECK(thrown_by([] { static_cast<void>(hash_pixels(CubemapView{})); }).code == ErrorCode::invalid_argument);
  CHECK(thrown_by([] { static_cast<void>(hash_file("/nowhere/at/all")); }).code == ErrorCode::file_access);
  stop_source stop;
  stop.request_stop();
  const TestCubemap cubemap = make_cubemap(Content::random, 8, 3, 1);
  CHECK(thrown_by([&] {
          static_cast<void>(hash_pixels(cubemap.view(), {stop.get_token(), {}}));
        }).code == ErrorCode::cancelled);
}

TEST_CASE("hash: files by their bytes") {
  const TemporaryDirectory directory;
  std::vector<char> bytes(3'000'000, 'x');
  write_bytes(directory.file("a"), bytes);
  write_bytes(directory.file("b"), bytes);
  CHECK(hash_file(directory.file("a")) == hash_file(directory.file("b")));
  CHECK(hash_file(directory.file("a")) == hash_bytes(bytes.data(), bytes.size()));
  bytes.back() = 'y';
  write_bytes(directory.file("b"), bytes);
  CHECK(hash_file(directory.file("a")) != hash_file(directory.file("b")));
}

}  // namespace

// The hash of a result covers every field that the result depends on, and no other.

namespace {

/// A change of options.
#define SET(...) [](auto& options) { options.__VA_ARGS__; }

/// Checks that every change gives a different hash.
template <class Options>
void check_changes(const Options& plain, const std::vector<std::function<void(Options&)>>& changes) {
  std::set<ContentHash> seen{cache::hash_options(plain)};
  for (std::size_t k = 0; k < changes.size(); ++k) {
    Options options = plain;
    changes[k](options);
    INFO("change " << k);
    CHECK(seen.insert(cache::hash_options(options)).second);
  }
}

template <class Options>
void check_without_effect(const Options& plain, const std::function<void(Options&)>& change) {
  Options options = plain;
  change(options);
  CHECK(cache::hash_options(options) == cache::hash_options(plain));
}

TEST_CASE("options: every field of a projection counts") {
  using Options = ProjectionOptions;
  check_changes<Options>(
      {}, {SET(bands = 4), SET(quadrature = Quadrature::midpoint), SET(target_size = 4),
           SET(pixels.clamp = RadianceClamp{}), SET(pixels.clamp = RadianceClamp{2.0F}),
           SET(pixels.clamp = RadianceClamp{2.0F, true}), SET(pixels.gamma = true),
           SET(pixels.nan = NonFinitePolicy::reject), SET(pixels.infinity = NonFinitePolicy::reject),
           SET(pixels.negative = NegativePolicy::replace), SET(pixels.negative = NegativePolicy::reject)});
}

TEST_CASE("options: every field of a prefilter counts, but what it does not use of its pixels") {
  using Options = PrefilterOptions;
  check_changes<Options>({},
                         {SET(size = 4), SET(mips = 4), SET(roughness = {0.5}), SET(roughness = {0.5, 0.5}),
                          SET(lobe_roughness = {0.5}), SET(lobe = LobeFamily::phong), SET(spectra = {{1.0, 0.5}}),
                          SET(spectra = {{1.0}, {0.5}}), SET(method = PrefilterMethod::spectral), SET(rms_error = 0.5),
                          SET(maximum_error = 0.5), SET(pixels.gamma = true), SET(pixels.clamp = RadianceClamp{})});
}

TEST_CASE("options: every field of a bake counts, but its limit and what is not used") {
  using Options = BakeOptions;
  check_changes<Options>(
      {}, {SET(background->size = 4), SET(background.reset()), SET(background->mips = false),
           SET(background->mip_filter = MipFilter::box), SET(specular.reset()), SET(specular->size = 4),
           SET(irradiance->size = 4), SET(irradiance.reset()), SET(irradiance->method = IrradianceMethod::direct),
           SET(irradiance->method = IrradianceMethod::harmonics), SET(irradiance->rms_error = 1e-4), SET(bands = 4),
           SET(total_radiance = false), SET(brdf.reset()), SET(brdf->width = 4), SET(brdf->height = 4),
           SET(brdf->model = BrdfModel::multiple_scattering), SET(brdf->sheen = false),
           SET(pixels.nan = NonFinitePolicy::reject)});
  check_without_effect<Options>({}, [](Options& o) {
    o.memory_limit_bytes = 5;
    o.specular->pixels.gamma = true;
  });
}

TEST_CASE("options: every field of reading counts, but its limit") {
  using Options = ReadOptions;
  check_changes<Options>(
      {}, {SET(layout = Layout::lat_long), SET(part = std::string("a")), SET(layer = std::string("a")), SET(level = 1),
           SET(transfer = Transfer::linear), SET(primaries = Primaries::as_stored)});
  check_without_effect<Options>({}, SET(memory_limit_bytes = 5));
}

TEST_CASE("options: every field of sky tables counts, but their limit") {
  using Options = SkyTableOptions;
  check_changes<Options>(
      {},
      {SET(layout = ScatteringLayout::compact), SET(heights = 9), SET(view_zeniths = 9), SET(sun_zeniths = 9),
       SET(sun_angles = 9), SET(transmittance_heights = 9), SET(transmittance_zeniths = 9), SET(irradiance_heights = 9),
       SET(irradiance_sun_zeniths = 9), SET(minimum_sun_elevation_degrees = -9.0), SET(orders = 9),
       SET(convergence_threshold = 0.5), SET(truncate_orders = true), SET(colour = SkyColour::linear_srgb)});
  check_without_effect<Options>({}, SET(memory_limit_bytes = 5));
}

TEST_CASE("options: every field of an atmosphere counts, but its name") {
  using Options = Atmosphere;
  check_changes<Options>(
      earth(), {SET(wavelengths_nm[1] = 500.0), SET(bottom_radius_m += 1.0), SET(top_radius_m += 1.0),
                SET(rayleigh.scattering_per_m[2] *= 2.0), SET(rayleigh.absorption_per_m = {0.0, 0.0, 1.0}),
                SET(rayleigh.density[0].thickness_m += 1.0), SET(rayleigh.density[0].exponential_term += 1.0),
                SET(rayleigh.density[0].exponential_scale_per_m += 1.0),
                SET(rayleigh.density[0].linear_term_per_m += 1.0), SET(rayleigh.density[0].constant_term += 1.0),
                SET(aerosol = {}), SET(aerosol_phase = AerosolPhase::cornette_shanks), SET(aerosol_asymmetry = 0.1),
                SET(aerosol_asymmetries = {0.1, 0.2, 0.3}), SET(night_zenith_luminance = 2e-4), SET(absorbers.clear()),
                SET(ground_albedo.clear()), SET(solar_irradiance[0] *= 2.0), SET(sun_angular_radius_degrees = 1.0)});
  check_without_effect<Options>(earth(), SET(name = std::string("another")));
}

}  // namespace

// Results are right and calls succeed whatever happens to the folder.

namespace {

using cache::EntryFolder;
using cache::EntryKind;
using cache::EntryName;

constexpr std::uint64_t kLarge = std::uint64_t{1} << 30U;

EntryName named(unsigned number) { return {EntryKind::projection, {number, ~std::uint64_t{number}}}; }

TEST_CASE("entries: a damaged byte, a cut and an appended byte are found out, and the entry is computed anew") {
  const TemporaryDirectory directory;
  const TestCubemap cubemap = make_cubemap(Content::random, 6, 3, 1);
  const CacheOptions options{.folder = directory.file("cache"), .memory_bytes = 0};
  const Projection truth = project(cubemap.view());
  static_cast<void>(ResultCache(options).project(cubemap.view()));
  REQUIRE(files_in(options.folder).size() == 1);
  const std::filesystem::path path = files_in(options.folder).front();
  const std::vector<char> sound = read_bytes(path);
  const auto survives = [&](const std::vector<char>& damaged) {
    write_bytes(path, damaged);
    ResultCache cache(options);
    CHECK(same_bytes<glm::dvec3>(cache.project(cubemap.view()).radiance.coefficients(), truth.radiance.coefficients()));
    CHECK(cache.statistics().damaged == 1);
    CHECK(cache.statistics().disk_hits == 0);
    CHECK(read_bytes(path).size() == sound.size());
  };
  for (std::size_t offset = 0; offset < sound.size(); offset += offset < 64 ? 1 : 41) {
    std::vector<char> damaged = sound;
    damaged[offset] = static_cast<char>(damaged[offset] ^ 4);
    survives(damaged);
  }
  for (const std::size_t length : {std::size_t{0}, std::size_t{63}, std::size_t{64}, sound.size() - 1}) {
    survives({sound.begin(), sound.begin() + static_cast<std::ptrdiff_t>(length)});
  }
  std::vector<char> longer = sound;
  longer.push_back(0);
  survives(longer);
}

/// Returns the entry names that the headers of the folder's files state.
std::vector<EntryName> names_in(const std::filesystem::path& folder) {
  std::vector<EntryName> names;
  for (const std::filesystem::path& path : files_in(folder)) {
    const std::vector<char> bytes = read_bytes(path);
    const std::vector<std::uint8_t> unsigned_bytes(bytes.begin(), bytes.end());
    const auto header = cache::read_entry_header(unsigned_bytes);
    REQUIRE(header.has_value());
    names.push_back(header->name());
  }
  return names;
}

TEST_CASE("entries: whole ones of another shape than was asked for are computed anew") {
  const TemporaryDirectory directory;
  const CacheOptions options{.folder = directory.file("cache"), .memory_bytes = 0};
  const TestLatLong image = make_lat_long(Content::random, 32, 16, 3);
  const TestCubemap cubemap = make_cubemap(Content::random, 8, 3, 1);
  BakeOptions baking{.specular = PrefilterOptions{.size = 8, .mips = 2}};
  baking.irradiance->size = 4;
  baking.brdf.reset();
  const SkyTableOptions sky = tiny_tables();
  const auto check_all = [&] {
    ResultCache cache(options);
    const BakeResult found = cache.bake(image.view(), baking);
    const BakeResult truth = bake(image.view(), baking);
    CHECK(same_bits(*found.irradiance, *truth.irradiance));
    REQUIRE(found.background->size() == truth.background->size());
    CHECK(same_bytes<float>({found.background->face(0, 0), found.background->bytes() / 4},
                            {truth.background->face(0, 0), truth.background->bytes() / 4}));
    CHECK(same_bytes(found.radiance->coefficients(), truth.radiance->coefficients()));
    const Projection light = cache.project(cubemap.view(), {}, {.keep_faces = true});
    CHECK(same_bytes<glm::dvec3>(light.radiance.coefficients(), project(cubemap.view()).radiance.coefficients()));
    CHECK(cache.precompute_sky(earth(), sky).scattering == precompute_sky(earth(), sky).scattering);
    return cache.statistics();
  };
  check_all();
  const std::vector<EntryName> names = names_in(options.folder);
  REQUIRE(names.size() > 10);
  const std::vector<std::vector<std::uint8_t>> others = {
      std::vector<std::uint8_t>(16, 0), std::vector<std::uint8_t>(4096, 0), cache::encode(Cubemap(1, 1)),
      cache::encode(Projection{SphericalHarmonics(7), {}}), cache::encode(projection::FaceSums(1, 2))};
  for (const std::vector<std::uint8_t>& other : others) {
    INFO("entries of " << other.size() << " bytes");
    EntryFolder folder(options.folder, kLarge);
    for (const EntryName& name : names) folder.store(name, other);
    const CacheStatistics statistics = check_all();
    CHECK(statistics.damaged > 4);
    CHECK(statistics.disk_hits == 0);
  }
}

TEST_CASE("entries: another entry under this name is not taken for it") {
  const TemporaryDirectory directory;
  EntryFolder folder(directory.file("cache"), kLarge);
  folder.store(named(1), payload_of(1, 100));
  const std::filesystem::path first = files_in(directory.file("cache")).front();
  folder.store(named(2), payload_of(2, 100));
  for (const std::filesystem::path& path : files_in(directory.file("cache"))) {
    if (path == first) continue;
    std::filesystem::remove(path);  // MinGW's copy_file cannot overwrite
    std::filesystem::copy_file(first, path);
  }
  CHECK(folder.find(named(1)) == payload_of(1, 100));
  CHECK_FALSE(folder.find(named(2)).has_value());
  CHECK(folder.counts().damaged == 1);
}

TEST_CASE("entries: the least recently used go when the folder is full") {
  const TemporaryFile path("cache");
  EntryFolder folder(path, 3 * (1000 + cache::kEntryHeaderBytes));
#if defined(_WIN32)
  constexpr std::chrono::milliseconds kTick(1100);  // libstdc++ reads a file's time in seconds there
#else
  constexpr std::chrono::milliseconds kTick(15);
#endif
  const auto pause = [&] { std::this_thread::sleep_for(kTick); };
  for (unsigned number = 1; number <= 3; ++number) {
    folder.store(named(number), payload_of(number, 1000));
    pause();
  }
  CHECK(folder.find(named(1)).has_value());
  pause();
  folder.store(named(4), payload_of(4, 1000));
  CHECK(folder.find(named(1)).has_value());
  CHECK_FALSE(folder.find(named(2)).has_value());
  CHECK(folder.find(named(4)).has_value());
  folder.store(named(5), payload_of(5, 100'000));
  CHECK_FALSE(folder.find(named(5)).has_value());
  CHECK(files_in(path).size() == 3);
  EntryFolder smaller(path, 1200);
  CHECK(files_in(path).size() == 1);
}

TEST_CASE("entries: a folder that cannot be is no reason to fail") {
  const TemporaryDirectory directory;
  write_bytes(directory.file("file"), {'x'});
  const TestCubemap cubemap = make_cubemap(Content::random, 6, 3, 1);
  ResultCache cache({.folder = directory.file("file") / "cache"});
  const Projection projection = cache.project(cubemap.view());
  CHECK(same_bytes<glm::dvec3>(projection.radiance.coefficients(), project(cubemap.view()).radiance.coefficients()));
  CHECK(cache.statistics().write_failures == 2);
  CHECK_FALSE(cache.statistics().last_failure.empty());
  CHECK(cache.project(cubemap.view()).diagnostics.passes.front().action == PassAction::reuse);
}

// Forged entries: impossible sizes, and sizes for which there is no memory.

TEST_CASE("entries: no memory is taken for more than an entry of its kind can have") {
  const TemporaryFile path("cache");
  EntryFolder folder(path, kLarge);
  folder.store(named(1), std::vector<std::uint8_t>(100, 7));
  CHECK(folder.find(named(1), 100).has_value());
  CHECK_FALSE(folder.find(named(1), 99).has_value());
  CHECK(folder.counts().damaged == 1);

  // A sparse file of a terabyte whose header says so, under the name of a projection's entry.
  const TestLatLong image = make_lat_long(Content::smooth, 16, 8, 3);
  const CacheOptions options{.folder = path, .memory_bytes = 0, .disk_bytes = std::uint64_t{1} << 50U};
  static_cast<void>(ResultCache(options).project(image.view()));
  REQUIRE(files_in(path).size() == 1);
  const std::filesystem::path entry = files_in(path).front();
  std::vector<char> bytes = read_bytes(entry);
  bytes.resize(cache::kEntryHeaderBytes);
  const std::uint64_t payload = std::uint64_t{1} << 40U;
  std::memcpy(bytes.data() + 32, &payload, sizeof payload);
  const std::uint64_t sum = hash_bytes(bytes.data(), cache::kEntryHeaderBytes - sizeof payload).low;
  std::memcpy(bytes.data() + cache::kEntryHeaderBytes - sizeof sum, &sum, sizeof sum);
  write_bytes(entry, bytes);
  std::error_code unsupported;
  std::filesystem::resize_file(entry, payload + cache::kEntryHeaderBytes, unsupported);
  if (unsupported) return;  // a file system without sparse files
  ResultCache cache(options);
  CHECK(cache.project(image.view()).radiance.at(1, 0) == project(image.view()).radiance.at(1, 0));
  CHECK(cache.statistics().damaged == 1);
}

TEST_CASE("entries: running out of memory for an entry is a miss") {
  const TemporaryDirectory directory;
  cache::ResultStore store({.folder = directory.file("cache"), .memory_bytes = 0});
  const cache::EntryName name = named(1);
  store.store(name, [] { return cache::Bytes(100, 7); });
  const auto size = [](cache::ByteSpan bytes) { return std::optional(bytes.size()); };
  REQUIRE(store.find(name, 100, size)->value == 100);
  const auto no_memory = [](cache::ByteSpan) -> std::optional<std::size_t> { throw std::bad_alloc(); };
  CHECK_FALSE(store.find(name, 100, no_memory).has_value());
  CHECK(store.find(name, 100, size)->value == 100);  // it is still there
  store.store(named(2), []() -> cache::Bytes { throw std::bad_alloc(); });
  CHECK(store.statistics().write_failures == 1);
  CHECK_FALSE(store.find(named(2), 100, size).has_value());
}

TEST_CASE("entries: bytes of the caller's are found again in another process's cache") {
  const TemporaryDirectory directory;
  const CacheOptions options{.folder = directory.file("cache"), .memory_bytes = 0};
  const std::array bytes{std::byte{1}, std::byte{0}, std::byte{3}};
  const ContentHash key = hash_bytes("key", 3);
  ResultCache(options).keep_bytes(key, bytes);
  ResultCache other(options);
  const auto found = other.find_bytes(key, 3);
  REQUIRE(found.has_value());
  CHECK(std::ranges::equal(*found, bytes));
  CHECK_FALSE(other.find_bytes(hash_bytes("kez", 3), 3).has_value());
  CHECK_FALSE(other.find_bytes(key, 2).has_value());
}

}  // namespace

}  // namespace welkin::test
