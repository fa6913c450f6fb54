// Cubemaps written as KTX of the first version, which Filament loads.
#include "image/pixels.h"
#include "support/catch.h"
#include "support/chains.h"
#include "support/images.h"
#include "support/ktx_files.h"
#include "support/same_bits.h"
#include "support/temporary_directory.h"
#include "support/thrown_error.h"
#include "welkin/bake_file.h"
#include "welkin/environment_file.h"

namespace welkin::test {

namespace {

struct Case {
  TexelFormat format;
  std::vector<std::uint32_t> header;  ///< glType, glTypeSize, glFormat, glInternalFormat, glBaseInternalFormat
};

/// The tables of OpenGL and of its extension for BPTC. R11F_G11F_B10F is as cmgen has it: see below.
const std::vector<Case>& cases() {
  static const std::vector<Case> all = {{TexelFormat::rgba16f, {0x140B, 2, 0x1908, 0x881A, 0x1908}},
                                        {TexelFormat::rgba32f, {0x1406, 4, 0x1908, 0x8814, 0x1908}},
                                        {TexelFormat::b10g11r11, {0x8C3A, 1, 0x1907, 0x8C3A, 0x8C3A}},
                                        {TexelFormat::e5b9g9r9, {0x8C3E, 4, 0x1907, 0x8C3D, 0x1907}},
                                        {TexelFormat::bc6h_ufloat, {0, 1, 0, 0x8E8F, 0x1907}},
                                        {TexelFormat::bc6h_sfloat, {0, 1, 0, 0x8E8E, 0x1907}}};
  return all;
}

}  // namespace

TEST_CASE("KTX of the first version holds what KTX2 holds, of each format", "[codec][textures]") {
  const TemporaryDirectory directory;
  for (const int size : {1, 6, 16}) {
    const Cubemap chain = noisy_chain(size, size == 16 ? 3 : 1);
    for (const Case& each : cases()) {
      TextureOptions options{.format = each.format};
      options.metadata = {{"sh", "1 2 3\n"}, {"a", ""}};
      CAPTURE(size, each.header);
      const WriteReport ktx2 = write_texture(directory.file("a.ktx2"), chain.views(), options);
      const WriteReport ktx1 = write_texture(directory.file("a.ktx"), chain.views(), options);
      CHECK(ktx1.values_clamped == ktx2.values_clamped);
      const CubemapTexture wanted = read_texture(directory.file("a.ktx2"));
      const CubemapTexture got = read_texture(directory.file("a.ktx"));
      CHECK(same_bits(got.cubemap, wanted.cubemap));
      CHECK(got.metadata == options.metadata);
    }
  }
}

TEST_CASE("KTX of the first version has OpenGL's numbers, and sizes of a face before each level", "[codec][textures]") {
  const TemporaryDirectory directory;
  const Cubemap chain = noisy_chain(8, 4);
  for (const Case& each : cases()) {
    CAPTURE(each.header);
    TextureOptions options{.format = each.format};
    options.metadata = {{"sh", "12"}};
    write_texture(directory.file("a.ktx"), chain.views(), options);
    const std::string bytes = read_text(directory.file("a.ktx"));
    CHECK(bytes.substr(0, 12) == "\xABKTX 11\xBB\r\n\x1A\n");
    std::vector<std::uint32_t> header{0x04030201};
    header.insert(header.end(), each.header.begin(), each.header.end());
    header.insert(header.end(), {8, 8, 0, 0, 6, 4, 12});
    for (std::size_t field = 0; field < header.size(); ++field)
      CHECK(number_at(bytes, 12 + 4 * field) == header[field]);
    CHECK(bytes.substr(64, 12) == std::string("\6\0\0\0sh\00012\0\0\0", 12));
    std::size_t index = 76;
    for (int level = 0; level < 4; ++level) {
      const auto size = static_cast<std::uint32_t>(8 >> level);
      const std::uint32_t blocks = (size + 3) / 4 * ((size + 3) / 4) * 16;
      const std::uint32_t texel_bytes = each.format == TexelFormat::rgba32f   ? 16
                                        : each.format == TexelFormat::rgba16f ? 8
                                                                              : 4;
      const std::uint32_t face = each.header[0] == 0 ? blocks : size * size * texel_bytes;
      CHECK(number_at(bytes, index) == face);
      index += 4 + 6 * face;
    }
    CHECK(index == bytes.size());
  }
}

TEST_CASE("a file of Filament's cmgen that is read and written has the same header and texels", "[codec][textures]") {
  if (!shared_images_are_here()) return;
  constexpr std::size_t kFormat = 24, kMetadataBytes = 60, kMetadata = 64;
  const TemporaryDirectory directory;
  for (const char* name : {"konzerthaus_ibl", "park_ibl", "pillars_ibl", "konzerthaus_skybox"}) {
    CAPTURE(name);
    const auto path = kImages / "cube" / (std::string("open3d_") + name + ".ktx");
    const CubemapTexture texture = read_texture(path);
    TextureOptions options{.format = TexelFormat::b10g11r11};
    options.metadata = texture.metadata;
    write_texture(directory.file("again.ktx"), texture.cubemap.views(), options);
    CHECK(read_texture(directory.file("again.ktx")).metadata == texture.metadata);
    const std::string wanted = read_text(path);
    const std::string got = read_text(directory.file("again.ktx"));
    CHECK(number_at(wanted, kFormat) == 0x8C3A);  // as cmgen had it before 1.8: since then it is GL_RGB
    CHECK(number_at(got, kFormat) == 0x1907);
    CHECK(got.substr(0, kFormat) == wanted.substr(0, kFormat));
    CHECK(got.substr(kFormat + 4, kMetadataBytes - kFormat - 4) ==
          wanted.substr(kFormat + 4, kMetadataBytes - kFormat - 4));
    // Our text ends with a zero byte, as the specification recommends; cmgen's does not.
    const bool same_levels = got.substr(kMetadata + number_at(got, kMetadataBytes)) ==
                             wanted.substr(kMetadata + number_at(wanted, kMetadataBytes));
    CHECK(same_levels);
  }
}

TEST_CASE("what KTX of the first version cannot hold is refused", "[codec][textures]") {
  const TemporaryDirectory directory;
  const Cubemap chain = noisy_chain(4, 1);
  const TextureOptions packed{.supercompression = Supercompression::zlib};
  CHECK(thrown_by([&] { write_texture(directory.file("a.ktx"), chain.views(), packed); }).says("be supercompressed"));
  TextureOptions large{.metadata = {{"note", std::string(std::size_t{1} << 20U, 'x')}}};
  CHECK(thrown_by([&] { write_texture(directory.file("a.ktx"), chain.views(), large); }).says("1 MiB is the most"));
  CHECK(thrown_by([&] {
          write_texture_2d(directory.file("a.ktx"), 2, 2, chain.face(0, 0));
        }).says("written as a cubemap alone"));
}

// Textures that are no single cubemap of ours: images, arrays, formats without alpha, and KTX of the first version.

namespace {

using Bytes = std::vector<std::byte>;

/// `texels` of floats, 1, 2, 3, ... in `channels`.
Bytes counted_floats(std::size_t texels, std::size_t channels) {
  Bytes bytes;
  for (std::size_t k = 0; k < texels * channels; ++k) append_value(bytes, static_cast<float>(k + 1));
  return bytes;
}

/// Pixels of an environment that was read, red alone.
std::vector<float> reds(const Bytes& file, const ReadOptions& options = {}) {
  const Environment read = read_environment({file, "texture"}, options);
  std::vector<float> values;
  for (std::size_t k = 0; k < values_of(read).size(); k += 3) values.push_back(read.pixels[k]);
  return values;
}

std::vector<float> counting(std::size_t first, std::size_t step, std::size_t count) {
  std::vector<float> values;
  for (std::size_t k = 0; k < count; ++k) values.push_back(static_cast<float>(first + step * k));
  return values;
}

ThrownError refusal(const Bytes& file, const ReadOptions& options = {}) {
  return thrown_by([&] { static_cast<void>(read_environment({file, "texture"}, options)); });
}

constexpr std::uint32_t kRgb32f = 106, kRgba32f = 109, kB10g11r11 = 122, kE5b9g9r9 = 123, kRgb8 = 23, kRgb16f = 90;

}  // namespace

TEST_CASE("KTX2 images are lat-longs, at each level", "[codec][textures]") {
  const Bytes file = ktx2_bytes({kRgba32f, 4, 4, 2, 0, 1}, {counted_floats(8, 4), counted_floats(2, 4)});
  const EnvironmentInfo info = inspect_environment({file, "texture"});
  CHECK(info.layout == Layout::lat_long);
  CHECK(info.levels.size() == 2);
  CHECK(reds(file) == counting(1, 4, 8));
  ReadOptions half{.level = 1};
  CHECK(reds(file, half) == counting(1, 4, 2));
  half.level = 2;
  CHECK(refusal(file, half).says("has no level 2"));
  CHECK(thrown_by([&] { static_cast<void>(read_texture({file, "texture"})); }).says("is not a cubemap"));
  // other shapes hold other layouts
  CHECK(inspect_environment({ktx2_bytes({kRgb32f, 4, 1, 6, 0, 1}, {counted_floats(6, 3)}), "texture"}).layout ==
        Layout::vertical_strip);
  const Bytes five = ktx2_bytes({kRgb32f, 4, 5, 1, 0, 1}, {counted_floats(5, 3)});
  CHECK(refusal(five).says("5 x 1"));
  CHECK(reds(five, {.layout = Layout::lat_long}) == counting(1, 3, 5));
}

TEST_CASE("KTX2 images of packed floats are read", "[codec][textures]") {
  Bytes packed;
  for (const std::uint32_t exponent : {15U, 16U}) append_value(packed, exponent << 6U | 15U << 17U | 15U << 27U);
  CHECK(reds(ktx2_bytes({kB10g11r11, 4, 2, 1, 0, 1}, {packed})) == std::vector<float>{1.0F, 2.0F});
  Bytes shared;
  for (const std::uint32_t exponent : {16U, 17U}) append_value(shared, exponent << 27U | 256U);
  CHECK(reds(ktx2_bytes({kE5b9g9r9, 4, 2, 1, 0, 1}, {shared})) == std::vector<float>{1.0F, 2.0F});
}

TEST_CASE("KTX2 formats without alpha are read", "[codec][textures]") {
  CHECK(reds(ktx2_bytes({kRgb32f, 4, 1, 1, 0, 6}, {counted_floats(6, 3)})) == counting(1, 3, 6));
  Bytes halves;
  for (int k = 0; k < 18; ++k) append_value(halves, image::half_from_float(static_cast<float>(k)));
  CHECK(reds(ktx2_bytes({kRgb16f, 2, 1, 1, 0, 6}, {halves})) == counting(0, 3, 6));
  Bytes bytes;
  for (int k = 0; k < 18; ++k) bytes.push_back(static_cast<std::byte>(k % 3 == 0 ? 255 : 0));
  CHECK(reds(ktx2_bytes({kRgb8, 1, 1, 1, 0, 6}, {bytes})) == std::vector<float>(6, 1.0F));
}

TEST_CASE("An element of a KTX2 array is read by its number", "[codec][textures]") {
  const Bytes images = ktx2_bytes({kRgb32f, 4, 2, 1, 3, 1}, {counted_floats(6, 3)});
  const Bytes cubes = ktx2_bytes({kRgb32f, 4, 1, 1, 2, 6}, {counted_floats(12, 3)});
  ReadOptions options;
  CHECK(reds(images) == counting(1, 3, 2));
  options.element = 2;
  CHECK(reds(images, options) == counting(13, 3, 2));
  options.element = 1;
  CHECK(reds(cubes, options) == counting(19, 3, 6));
  options.element = 3;
  CHECK(refusal(images, options).says("has no element 3; it has 3"));
  options.element = -1;
  CHECK(refusal(images, options).says("has no element -1"));
  options.element = 1;
  CHECK(refusal(ktx2_bytes({kRgb32f, 4, 1, 1, 0, 6}, {counted_floats(6, 3)}), options).says("it is not an array"));
  CHECK(thrown_by([&] { static_cast<void>(read_texture({cubes, "texture"})); }).says("array of 2 cubemaps"));
}

TEST_CASE("KTX cubemaps of the first version are read, with their levels", "[codec][textures]") {
  constexpr std::uint32_t kFloat = 0x1406, kRgba = 0x1908, kRgba32fInternal = 0x8814;
  const KtxKind kind{kFloat, kRgba, 2, 2, 0, 6};
  const std::vector<Bytes> levels{counted_floats(24, 4), counted_floats(6, 4)};
  const Bytes file = ktx1_bytes(kind, kRgba32fInternal, levels, "hello");
  const CubemapTexture texture = read_texture({file, "texture"});
  CHECK(texture.cubemap.levels() == 2);
  CHECK(texture.metadata.at("note") == "hello");
  CHECK(texture.cubemap.face(0, 5)[9] == 93.0F);
  CHECK(texture.cubemap.face(1, 5)[0] == 21.0F);
  CHECK(reds(file) == counting(1, 4, 24));
  CHECK(inspect_environment({file, "texture"}).format == FileFormat::ktx1);
  // arrays count all of their bytes, and images too
  ReadOptions second{.element = 1};
  CHECK(reds(ktx1_bytes({kFloat, kRgba, 1, 1, 2, 6}, kRgba32fInternal, {counted_floats(12, 4)}), second) ==
        counting(25, 4, 6));
  CHECK(reds(ktx1_bytes({kFloat, kRgba, 2, 1, 0, 1}, kRgba32fInternal, {counted_floats(2, 4)})) == counting(1, 4, 2));
}

TEST_CASE("KTX files of the first version that are not for us are named for what they are", "[codec][textures]") {
  constexpr std::uint32_t kFloat = 0x1406, kRgba = 0x1908, kRgba32fInternal = 0x8814;
  const Bytes sound = ktx1_bytes({kFloat, kRgba, 2, 2, 0, 6}, kRgba32fInternal, {counted_floats(24, 4)});
  const auto with = [&](std::size_t offset, std::uint32_t value) {
    Bytes bytes = sound;
    std::memcpy(bytes.data() + offset, &value, sizeof value);
    return refusal(bytes);
  };
  CHECK(with(8, 0).code == ErrorCode::corrupt_file);
  CHECK(with(12, 0x01020304).says("big-endian"));
  CHECK(with(16, 0x1400).says("glType 5120"));
  CHECK(with(16, 0).says("glInternalFormat 34836"));
  CHECK(with(24, 0x1903).says("glFormat 6403"));
  CHECK(with(36, 3).says("3 x 2"));
  CHECK(with(44, 2).says("3D texture"));
  CHECK(with(48, 100000).says("array of 100000"));
  CHECK(with(52, 5).says("has 5 faces"));
  CHECK(with(56, 3).says("3 levels"));
  CHECK(with(60, 0x7fffffff).says("key/value data"));
  CHECK(with(64, 63).says("states 63 bytes"));
  Bytes cut = sound;
  cut.resize(cut.size() - 1);
  CHECK(refusal(cut).says("ends too early"));
  cut.resize(40);
  CHECK(refusal(cut).code == ErrorCode::corrupt_file);
}

TEST_CASE("Filament's KTX environments hold the light that their own harmonics say", "[codec][textures]") {
  if (!shared_images_are_here()) return;
  for (const char* name : {"konzerthaus", "park", "pillars"}) {
    const auto path = kImages / "cube" / (std::string("open3d_") + name + "_ibl.ktx");
    CAPTURE(path);
    const CubemapTexture texture = read_texture(path);
    CHECK(texture.cubemap.size() == 256);
    CHECK(texture.cubemap.levels() == 5);
    std::istringstream words(texture.metadata.at("sh"));
    dvec3 mean(0.0);
    words >> mean.x >> mean.y >> mean.z;
    if (std::string(name) == "park") continue;  // whose sun was dimmed for the harmonics
    const dvec3 found = measure_environment(path).mean;
    for (int c = 0; c < 3; ++c) CHECK(std::abs(found[c] - mean[c]) < 0.01 * mean[c]);
  }
}

}  // namespace welkin::test
