// Whatever happens to the folder, results are right and calls succeed.
#include <signal.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <string>
#include <thread>
#include <vector>

#include "cache/entry_folder.h"
#include "cache/payloads.h"
#include "support/catch.h"
#include "support/same_bits.h"
#include "support/temporary_directory.h"
#include "support/test_environments.h"
#include "welkin/result_cache.h"

namespace {

using namespace welkin;
using cache::EntryFolder;
using cache::EntryKind;
using cache::EntryName;

constexpr std::uint64_t kLarge = std::uint64_t{1} << 30U;

std::vector<std::filesystem::path> files_in(const std::filesystem::path& folder) {
  std::vector<std::filesystem::path> files;
  for (const auto& entry : std::filesystem::directory_iterator(folder)) files.push_back(entry.path());
  return files;
}

/// A payload whose every byte follows from the number.
std::vector<std::uint8_t> payload_of(unsigned number, std::size_t bytes) {
  std::vector<std::uint8_t> payload(bytes);
  for (std::size_t k = 0; k < bytes; ++k) payload[k] = static_cast<std::uint8_t>(k * 31 + number * 7 + k / 256);
  return payload;
}

EntryName named(unsigned number) { return {EntryKind::projection, {number, ~std::uint64_t{number}}}; }

TEST_CASE("entries: a damaged byte, a cut and an appended byte are found out, and the entry is computed anew") {
  const test::TemporaryDirectory directory;
  const test::TestCubemap cubemap = test::make_cubemap(test::Content::random, 6, 3, 1);
  const CacheOptions options{.folder = directory.file("cache"), .memory_bytes = 0};
  const Projection truth = project(cubemap.view());
  static_cast<void>(ResultCache(options).project(cubemap.view()));
  REQUIRE(files_in(options.folder).size() == 1);
  const std::filesystem::path path = files_in(options.folder).front();
  const std::vector<char> sound = test::read_bytes(path);
  const auto survives = [&](const std::vector<char>& damaged) {
    test::write_bytes(path, damaged);
    ResultCache cache(options);
    CHECK(test::same_bytes<glm::dvec3>(cache.project(cubemap.view()).radiance.coefficients(),
                                       truth.radiance.coefficients()));
    CHECK(cache.statistics().damaged == 1);
    CHECK(cache.statistics().disk_hits == 0);
    CHECK(test::read_bytes(path).size() == sound.size());
  };
  for (std::size_t place = 0; place < sound.size(); place += place < 64 ? 1 : 41) {
    std::vector<char> damaged = sound;
    damaged[place] = static_cast<char>(damaged[place] ^ 4);
    survives(damaged);
  }
  for (const std::size_t length : {std::size_t{0}, std::size_t{63}, std::size_t{64}, sound.size() - 1}) {
    survives({sound.begin(), sound.begin() + static_cast<std::ptrdiff_t>(length)});
  }
  std::vector<char> longer = sound;
  longer.push_back(0);
  survives(longer);
}

/// What the folder's files say that they are.
std::vector<EntryName> names_in(const std::filesystem::path& folder) {
  std::vector<EntryName> names;
  for (const std::filesystem::path& path : files_in(folder)) {
    const std::vector<char> bytes = test::read_bytes(path);
    const std::vector<std::uint8_t> unsigned_bytes(bytes.begin(), bytes.end());
    const auto statement = cache::read_entry_header(unsigned_bytes);
    REQUIRE(statement.has_value());
    names.push_back(statement->name);
  }
  return names;
}

TEST_CASE("entries: whole ones of another shape than was asked for are computed anew") {
  const test::TemporaryDirectory directory;
  const CacheOptions options{.folder = directory.file("cache"), .memory_bytes = 0};
  const test::TestLatLong picture = test::make_lat_long(test::Content::random, 32, 16, 3);
  const test::TestCubemap cubemap = test::make_cubemap(test::Content::random, 8, 3, 1);
  BakeOptions baking;
  baking.specular = PrefilterOptions{.size = 8, .mips = 2};
  baking.irradiance_size = 4;
  baking.brdf.reset();
  const SkyTableOptions sky{.heights = 4,
                            .view_zeniths = 8,
                            .sun_zeniths = 4,
                            .sun_angles = 2,
                            .transmittance_heights = 4,
                            .transmittance_zeniths = 8,
                            .irradiance_heights = 2,
                            .irradiance_sun_zeniths = 4,
                            .orders = 1};
  const auto check_all = [&] {
    ResultCache cache(options);
    const BakeResult found = cache.bake(picture.view(), baking);
    const BakeResult truth = bake(picture.view(), baking);
    CHECK(test::same_bits(found.irradiance, truth.irradiance));
    REQUIRE(found.background.size() == truth.background.size());
    CHECK(test::same_bytes<float>({found.background.face(0, 0), found.background.bytes() / 4},
                                  {truth.background.face(0, 0), truth.background.bytes() / 4}));
    CHECK(test::same_bytes(found.radiance->coefficients(), truth.radiance->coefficients()));
    const Projection light = cache.project(cubemap.view(), {}, {.keep_faces = true});
    CHECK(test::same_bytes<glm::dvec3>(light.radiance.coefficients(), project(cubemap.view()).radiance.coefficients()));
    CHECK(cache.precompute_sky(earth(), sky).scattering == precompute_sky(earth(), sky).scattering);
    return cache.statistics();
  };
  check_all();
  const std::vector<EntryName> names = names_in(options.folder);
  REQUIRE(names.size() > 10);
  const std::vector<std::vector<std::uint8_t>> others = {
      std::vector<std::uint8_t>(16, 0),  std::vector<std::uint8_t>(4096, 0),
      cache::encode(CubemapChain(1, 1)), cache::encode(Projection{SphericalHarmonics(7), {}}),
      cache::encode(sh::FaceSums(1, 2)), cache::encode(SkyTables())};
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
  const test::TemporaryDirectory directory;
  EntryFolder folder(directory.file("cache"), kLarge);
  folder.store(named(1), payload_of(1, 100));
  const std::filesystem::path first = files_in(directory.file("cache")).front();
  folder.store(named(2), payload_of(2, 100));
  for (const std::filesystem::path& path : files_in(directory.file("cache"))) {
    if (path != first) std::filesystem::copy_file(first, path, std::filesystem::copy_options::overwrite_existing);
  }
  CHECK(folder.find(named(1)) == payload_of(1, 100));
  CHECK_FALSE(folder.find(named(2)).has_value());
  CHECK(folder.counts().damaged == 1);
}

TEST_CASE("entries: files of others stay, and pipes and folders under an entry's name keep nobody waiting") {
  const test::TemporaryDirectory directory;
  const std::filesystem::path place = directory.file("cache");
  EntryFolder folder(place, 1000);
  const std::vector<std::string> theirs{"notes.txt", "mine.welkin-entry", ".welkin-notes.part", ".welkin-.part"};
  for (const std::string& name : theirs) {
    test::write_bytes(place / name, std::vector<char>(5000, 'x'));
    std::filesystem::last_write_time(place / name,
                                     std::filesystem::file_time_type::clock::now() - std::chrono::hours(200));
  }
  folder.store(named(1), payload_of(1, 500));
  const std::string name = [&] {
    for (const auto& path : files_in(place)) {
      if (std::ranges::find(theirs, path.filename().string()) == theirs.end()) return path.filename().string();
    }
    return std::string();
  }();
  std::filesystem::remove(place / name);
  REQUIRE(mkfifo((place / name).c_str(), 0600) == 0);
  CHECK_FALSE(folder.find(named(1)).has_value());
  std::filesystem::create_directory(place / name);
  CHECK_FALSE(folder.find(named(1)).has_value());
  for (unsigned number = 2; number < 6; ++number) folder.store(named(number), payload_of(number, 500));
  const EntryFolder once_more(place, 1000);
  for (const std::string& each : theirs) CHECK(std::filesystem::exists(place / each));
}

TEST_CASE("entries: the least recently used go when the folder is full") {
  const test::TemporaryDirectory directory;
  const std::filesystem::path place = directory.file("cache");
  EntryFolder folder(place, 3 * (1000 + cache::kEntryHeaderBytes));
  const auto pause = [] { std::this_thread::sleep_for(std::chrono::milliseconds(15)); };
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
  CHECK(files_in(place).size() == 3);
  EntryFolder smaller(place, 1200);
  CHECK(files_in(place).size() == 1);
}

TEST_CASE("entries: what a killed writer left behind goes after an hour") {
  const test::TemporaryDirectory directory;
  const std::filesystem::path place = directory.file("cache");
  std::filesystem::create_directory(place);
  test::write_bytes(place / ".welkin-1-0.part", {'x'});
  test::write_bytes(place / ".welkin-2-0.part", {'x'});
  std::filesystem::last_write_time(place / ".welkin-1-0.part",
                                   std::filesystem::file_time_type::clock::now() - std::chrono::hours(2));
  const EntryFolder folder(place, 1000);
  CHECK_FALSE(std::filesystem::exists(place / ".welkin-1-0.part"));
  CHECK(std::filesystem::exists(place / ".welkin-2-0.part"));
}

TEST_CASE("entries: a folder that cannot be is no reason to fail") {
  const test::TemporaryDirectory directory;
  test::write_bytes(directory.file("file"), {'x'});
  const test::TestCubemap cubemap = test::make_cubemap(test::Content::random, 6, 3, 1);
  ResultCache cache({.folder = directory.file("file") / "cache"});
  const Projection projection = cache.project(cubemap.view());
  CHECK(test::same_bytes<glm::dvec3>(projection.radiance.coefficients(),
                                     project(cubemap.view()).radiance.coefficients()));
  CHECK(cache.statistics().write_failures == 2);
  CHECK_FALSE(cache.statistics().last_failure.empty());
  CHECK(cache.project(cubemap.view()).diagnostics.passes.front().action == "reuse");
}

/// Runs `work` in a process of its own; what it returns.
template <class Work>
pid_t start_process(const Work& work) {
  const pid_t child = fork();
  if (child == 0) _exit(work());
  return child;
}

int exit_code(pid_t child) {
  int status = 0;
  waitpid(child, &status, 0);
  return WIFEXITED(status) ? WEXITSTATUS(status) : 256 + WTERMSIG(status);
}

TEST_CASE("entries: a full disk is no reason to fail and leaves nothing behind") {
  const test::TemporaryDirectory directory;
  const std::filesystem::path place = directory.file("cache");
  const pid_t child = start_process([&] {
    signal(SIGXFSZ, SIG_IGN);
    const rlimit limit{4096, 4096};
    setrlimit(RLIMIT_FSIZE, &limit);
    EntryFolder folder(place, kLarge);
    folder.store(named(1), payload_of(1, 100'000));
    folder.store(named(2), payload_of(2, 1000));
    const bool right = folder.counts().write_failures == 1 && !folder.find(named(1)) && folder.find(named(2));
    return right ? 0 : 1;
  });
  CHECK(exit_code(child) == 0);
  CHECK(files_in(place).size() == 1);
}

/// Stores and finds entries among those of others; 0 if all that was found was right.
int work_among_others(const std::filesystem::path& place, unsigned seed, int rounds) {
  // Little room: entries come and go under the readers' hands.
  EntryFolder folder(place, 40'000);
  unsigned state = seed * 2654435761U + 1;
  for (int round = 0; round < rounds; ++round) {
    state = state * 1664525U + 1013904223U;
    const unsigned number = (state >> 16U) % 12;
    const std::size_t bytes = 1000 + 500 * number;
    if (const auto found = folder.find(named(number)); found && *found != payload_of(number, bytes)) return 1;
    if ((state >> 28U) % 2 == 0) folder.store(named(number), payload_of(number, bytes));
  }
  return folder.counts().write_failures == 0 ? 0 : 2;
}

TEST_CASE("entries: processes and threads that share a folder never see half an entry") {
  const test::TemporaryDirectory directory;
  const std::filesystem::path place = directory.file("cache");
  std::vector<pid_t> children;
  for (unsigned seed = 0; seed < 4; ++seed) {
    children.push_back(start_process([&] { return work_among_others(place, seed, 60); }));
  }
  const pid_t killed = start_process([&] { return work_among_others(place, 9, 1'000'000); });
  for (const pid_t child : children) CHECK(exit_code(child) == 0);
  kill(killed, SIGKILL);
  CHECK(exit_code(killed) == 256 + SIGKILL);
  std::vector<int> codes(3, -1);
  std::vector<std::thread> threads;
  for (unsigned k = 0; k < 3; ++k) {
    threads.emplace_back([&, k] { codes[k] = work_among_others(place, 20 + k, 60); });
  }
  for (std::thread& thread : threads) thread.join();
  CHECK(codes == std::vector<int>{0, 0, 0});
  EntryFolder folder(place, kLarge);
  for (unsigned number = 0; number < 12; ++number) {
    const auto found = folder.find(named(number));
    CHECK((!found || *found == payload_of(number, 1000 + 500 * number)));
  }
  CHECK(folder.counts().damaged == 0);
}

}  // namespace
