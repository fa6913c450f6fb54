// Files in memory: read from bytes and written to them.
#include "files/row_source.h"
#include "support/catch.h"
#include "support/chains.h"
#include "support/damaged_files.h"
#include "support/exr_files.h"
#include "support/images.h"
#include "support/same_bits.h"
#include "support/small_skies.h"
#include "support/temporary_directory.h"
#include "support/thrown_error.h"
#include "support/webp_env.h"
#include "welkin/bake_file.h"
#include "welkin/environment_file.h"
#include "welkin/worker.h"

namespace welkin::test {

// Promises: bytes in memory read as the file at a path does: the same bits and descriptions, and the same error for a
// damaged file.

namespace {

using Bytes = std::vector<std::byte>;

std::span<const std::byte> as_bytes(const std::vector<char>& bytes) { return std::as_bytes(std::span(bytes)); }

Bytes bytes_of(const std::filesystem::path& path) {
  const std::vector<char> bytes = read_bytes(path);
  const std::span<const std::byte> span = as_bytes(bytes);
  return {span.begin(), span.end()};
}

/// The result of a call, or the error that it threw.
template <class Value>
struct Outcome {
  std::optional<Value> value;
  std::string error;
};

template <class Call>
auto outcome_of(const Call& call) -> Outcome<decltype(call())> {
  try {
    return {call(), {}};
  } catch (const Error& error) {
    return {{}, std::to_string(static_cast<int>(error.code())) + " " + error.what()};
  }
}

/// Cuts the reason why a square image is not one of six faces, which only the error for a path states.
std::string comparable(const std::string& error) { return error.substr(0, error.find(" is square")); }

/// Compares the outcomes of `call` for the path and for the bytes with the path as their name.
template <class Call, class Same>
void check_same_outcome(const std::filesystem::path& path, std::span<const std::byte> bytes, const Call& call,
                        const Same& same) {
  const auto from_path = outcome_of([&] { return call(FileInput(path)); });
  const auto from_memory = outcome_of([&] { return call(FileInput(bytes, path.string())); });
  CHECK(comparable(from_memory.error) == comparable(from_path.error));
  if (from_path.value && from_memory.value) CHECK(same(*from_path.value, *from_memory.value));
}

const auto same_results = [](const auto& a, const auto& b) { return same_bits(a, b); };

bool same_words(const EnvironmentInfo& a, const EnvironmentInfo& b) {
  return a.path == b.path && a.format_description() == b.format_description() && a.compression == b.compression &&
         a.storage == b.storage && a.layout == b.layout && a.layout_reason == b.layout_reason && a.width == b.width &&
         a.height == b.height && a.channels.size() == b.channels.size() && a.levels.size() == b.levels.size() &&
         a.parts == b.parts && a.layers == b.layers && a.notes == b.notes && a.faces == b.faces;
}

void check_environment(const std::filesystem::path& path, std::span<const std::byte> bytes,
                       const ReadOptions& options = {}) {
  CAPTURE(path, options.part, options.level);
  const auto inspect = [&](const FileInput& input) { return inspect_environment(input, options); };
  check_same_outcome(path, bytes, inspect, same_words);
  const auto read = [&](const FileInput& input) { return read_environment(input, options); };
  check_same_outcome(path, bytes, read, same_results);
  const auto measure = [&](const FileInput& input) { return measure_environment(input, options); };
  check_same_outcome(path, bytes, measure, same_results);
  const auto project = [&](const FileInput& input) { return project_file(input, options, {.target_size = 2}); };
  check_same_outcome(path, bytes, project, same_results);
}

void check_texture(const std::filesystem::path& path, std::span<const std::byte> bytes) {
  CAPTURE(path);
  const auto chain = [](const FileInput& input) { return read_texture(input).cubemap; };
  check_same_outcome(path, bytes, chain, same_results);
  const auto specular = [](const FileInput& input) { return read_babylon_environment(input).specular; };
  check_same_outcome(path, bytes, specular, same_results);
}

std::vector<std::filesystem::path> write_textures(const TemporaryDirectory& directory) {
  const Cubemap chain = noisy_chain(8, 4);
  const std::pair<const char*, TextureOptions> files[] = {
      {"none.ktx2", {.metadata = {{"welkin.roughness", "0 0.25 0.5 1"}}}},
      {"zlib.ktx2", {TexelFormat::b10g11r11, Supercompression::zlib, {}}},
      {"zstd.ktx2", {TexelFormat::e5b9g9r9, Supercompression::zstd, {}}},
      {"plain.dds", {TexelFormat::rgba32f, Supercompression::none, {}}},
      {"mip-map.exr", {}}};
  std::vector<std::filesystem::path> paths;
  for (const auto& [name, options] : files) {
    paths.push_back(directory.file(name));
    write_texture(paths.back(), chain.views(), options);
  }
  BabylonEnvironment environment;
  environment.specular = noisy_chain(8, 4);
  environment.polynomial = BabylonPolynomial{};
  environment.irradiance = {4, std::vector<float>(std::size_t{18} * 16, 0.5F)};
  paths.push_back(directory.file("sky.env"));
  write_babylon_environment(paths.back(), environment);
  paths.push_back(directory.file("webp.env"));
  write_bytes(paths.back(), with_webp_images(read_bytes(directory.file("sky.env"))));
  return paths;
}

}  // namespace

TEST_CASE("an image in memory is read as the file on disk is", "[codec][memory]") {
  const TemporaryDirectory directory;
  for (const SoundFile& sound : sound_files(directory.file(""))) {
    const std::filesystem::path path = directory.file(sound.name);
    write_bytes(path, sound.bytes);
    for (const int level : {0, 1}) check_environment(path, as_bytes(sound.bytes), {.level = level});
    check_environment(path, as_bytes(sound.bytes), {.part = "1"});
  }
}

TEST_CASE("a file in memory that is cut off is refused with the words of the file on disk", "[codec][memory][damage]") {
  const TemporaryDirectory directory;
  std::vector<SoundFile> files = sound_files(directory.file(""));
  for (const std::filesystem::path& path : write_textures(directory)) {
    files.push_back({path.filename().string(), read_bytes(path)});
  }
  constexpr std::size_t cuts = 20;
  for (const SoundFile& sound : files) {
    const std::filesystem::path path = directory.file(sound.name);
    for (std::size_t cut = 0; cut < cuts; ++cut) {
      const auto count = static_cast<std::ptrdiff_t>(sound.bytes.size() * cut / cuts);
      const std::vector<char> bytes(sound.bytes.begin(), sound.bytes.begin() + count);
      CAPTURE(sound.name, count);
      std::filesystem::remove(path);
      write_bytes(path, bytes);
      const auto read = [](const FileInput& input) { return read_environment(input); };
      check_same_outcome(path, as_bytes(bytes), read, same_results);
      const auto project = [](const FileInput& input) { return project_file(input); };
      check_same_outcome(path, as_bytes(bytes), project, same_results);
      check_texture(path, as_bytes(bytes));
    }
  }
}

TEST_CASE("bytes without a name, and none at all, are refused with words", "[codec][memory]") {
  CHECK(thrown_by([] { (void)read_environment({Bytes{}, ""}); }).says("bytes in memory: is empty"));
  check_thrown([] { (void)read_environment(FileInput()); }, ErrorCode::file_access);
  CHECK(thrown_by([] { (void)read_texture({std::span<const std::byte>(), "a.ktx2"}); }).says("a.ktx2: "));
}

// Promises: a bake takes from bytes in memory what it takes from a file: pixels, levels, a polynomial.

TEST_CASE("a bake of bytes is that of the file, whole and planned", "[bake][memory]") {
  const TemporaryDirectory directory;
  std::vector<std::filesystem::path> paths = write_textures(directory);
  paths.push_back(directory.file("sky.hdr"));
  write_environment(paths.back(), LatLongImage{64, 32, some_pixels(64, 32)}.view());
  BakeOptions options{.specular = PrefilterOptions{.size = 8}};
  options.irradiance->size = 4;
  options.brdf.reset();
  const auto same = [](const BakeResult& a, const BakeResult& b) {
    return same_bits(a.background.value(), b.background.value()) &&
           same_bits(a.irradiance.value(), b.irradiance.value()) &&
           same_bits(a.specular->cubemap, b.specular->cubemap) &&
           a.stored_polynomial.has_value() == b.stored_polynomial.has_value() &&
           same_bytes<glm::dvec3>(a.radiance->coefficients(), b.radiance->coefficients());
  };
  for (const std::filesystem::path& path : paths) {
    CAPTURE(path);
    const Bytes bytes = bytes_of(path);
    const auto whole = [&](const FileInput& input) { return bake_file(input, {}, options); };
    check_same_outcome(path, bytes, whole, same);
    const auto planned = [&](const FileInput& input) {
      const StoredEnvironment stored = inspect_stored_environment(input);
      return bake(stored, plan(stored, {}, options));
    };
    check_same_outcome(path, bytes, planned, same);
  }
}

// Promises: six faces in memory are a cubemap as six files are; what reads one file says that they are six.

namespace {

struct SixFaces {
  std::array<Bytes, 6> bytes;
  std::array<std::filesystem::path, 6> paths;

  explicit SixFaces(const TemporaryDirectory& directory) {
    const Cubemap chain = noisy_chain(8, 1);
    write_environment(directory.file("sky.pfm"), chain.view(0), {.layout = Layout::six_files});
    paths = files::face_files(directory.file("sky_px.pfm"));
    for (std::size_t face = 0; face < 6; ++face) bytes[face] = bytes_of(paths[face]);
  }

  [[nodiscard]] FileInput input(std::size_t in_memory = 6) const {
    std::array<FileInput, 6> faces;
    for (std::size_t face = 0; face < 6; ++face) {
      faces[face] = face < in_memory ? FileInput(bytes[face], paths[face].string()) : FileInput(paths[face]);
    }
    return FileInput::six_faces(faces);
  }
};

}  // namespace

TEST_CASE("six faces in memory are read as six files are", "[codec][memory]") {
  const TemporaryDirectory directory;
  const SixFaces six(directory);
  const Environment wanted = read_environment(six.paths[0]);
  for (const std::size_t in_memory : {std::size_t{6}, std::size_t{3}, std::size_t{0}}) {
    const Environment found = read_environment(six.input(in_memory));
    CHECK(same_bits(wanted, found));
    CHECK(found.info.faces == wanted.info.faces);
    CHECK(found.info.layout_reason == "six faces were given");
  }
  CHECK(same_bits(read_environment(six.input(), {.layout = Layout::six_files}), wanted));
  CHECK(same_bits(measure_environment(six.input()), measure_environment(six.paths[0])));
  CHECK(
      same_bits(project_file(six.input(), {}, {.target_size = 4}), project_file(six.paths[0], {}, {.target_size = 4})));
  const StoredEnvironment stored = inspect_stored_environment(six.input());
  CHECK(stored.shape.cubemap);
  BakeOptions options;
  options.specular.reset();
  options.brdf.reset();
  CHECK(same_bits(bake(stored, plan(stored, {}, options)).background.value(),
                  bake_file(six.paths[0], {}, options).background.value()));
}

// Promises: what is written to memory has the bytes of the file; after an error the vector is as it was.

TEST_CASE("what is written to memory has the bytes of the file", "[codec][memory]") {
  const TemporaryDirectory directory;
  const LatLongImage image{64, 32, some_pixels(64, 32)};
  const Cubemap chain = noisy_chain(8, 4);
  const auto check = [&](const char* name, const auto& write) {
    CAPTURE(name);
    Bytes bytes(3, std::byte{7});
    const WriteReport in_memory = write(FileOutput(bytes, name));
    const WriteReport on_disk = write(FileOutput(directory.file(name)));
    CHECK(bytes == bytes_of(directory.file(name)));
    CHECK(in_memory.values_clamped == on_disk.values_clamped);
    CHECK(in_memory.files == std::vector<std::filesystem::path>{name});
  };
  for (const char* name : {"sky.exr", "sky.hdr", "sky.pfm", "sky.png"}) {
    check(name, [&](const FileOutput& output) { return write_environment(output, image.view()); });
    for (const Layout layout : {Layout::vertical_strip, Layout::horizontal_cross}) {
      check(name,
            [&](const FileOutput& output) { return write_environment(output, chain.view(0), {.layout = layout}); });
    }
  }
  for (const char* name : {"chain.ktx2", "chain.dds", "chain.exr"}) {
    check(name, [&](const FileOutput& output) { return write_texture(output, chain.views()); });
  }
  for (const Supercompression packed : {Supercompression::zlib, Supercompression::zstd}) {
    const TextureOptions options{TexelFormat::rgba32f, packed, {}};
    check("packed.ktx2", [&](const FileOutput& output) { return write_texture(output, chain.views(), options); });
  }
  for (const char* name : {"table.ktx2", "table.dds"}) {
    check(name, [&](const FileOutput& output) { return write_texture_2d(output, 64, 32, image.pixels.data()); });
  }
  BabylonEnvironment environment;
  environment.specular = noisy_chain(8, 4);
  check("sky.env", [&](const FileOutput& output) { return write_babylon_environment(output, environment); });
}

TEST_CASE("after an error the bytes that were to be written are as they were", "[codec][memory]") {
  const LatLongImage image{64, 32, some_pixels(64, 32)};
  const Cubemap chain = noisy_chain(8, 1);
  const Bytes before(5, std::byte{9});
  Bytes bytes = before;
  stop_source stop;
  stop.request_stop();
  for (const char* name : {"sky.exr", "sky.hdr", "sky.pfm", "sky.png"}) {
    CAPTURE(name);
    CHECK(thrown_by([&] {
            write_environment({bytes, name}, image.view(), {}, {stop.get_token(), {}});
          }).code == ErrorCode::cancelled);
    CHECK(bytes == before);
  }
  CHECK(thrown_by([&] { write_environment({bytes, "sky.gif"}, image.view()); }).code == ErrorCode::unsupported_file);
  CHECK(thrown_by([&] {
          write_texture({bytes, ""}, chain.views());
        }).says("bytes in memory: has no extension that names a format"));
  const auto write_six = [&] { write_environment({bytes, "sky.exr"}, chain.view(0), {.layout = Layout::six_files}); };
  check_thrown(write_six, ErrorCode::invalid_argument, {"six files cannot be written to one vector of bytes"});
  CHECK_THROWS_AS(check_write_options({bytes, "sky.exr"}, {.layout = Layout::six_files}, true), Error);
  CHECK(bytes == before);
  // The folder of a name need not be there.
  check_write_options({bytes, "no such folder/sky.exr"}, {}, false);
}

}  // namespace welkin::test
