// Cubemaps written as KTX of the first version, which Filament loads.

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <fstream>
#include <iterator>
#include <string>
#include <vector>

#include "support/catch.h"
#include "support/chains.h"
#include "support/shared_pictures.h"
#include "support/temporary_directory.h"
#include "support/thrown_error.h"
#include "welkin/bake_file.h"

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

std::string bytes_of(const std::filesystem::path& path) {
  std::ifstream stream(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(stream), {}};
}

std::uint32_t word(const std::string& bytes, std::size_t place) {
  std::uint32_t value = 0;
  REQUIRE(place + sizeof value <= bytes.size());
  std::memcpy(&value, bytes.data() + place, sizeof value);
  return value;
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
    const std::string bytes = bytes_of(directory.file("a.ktx"));
    CHECK(bytes.substr(0, 12) == "\xABKTX 11\xBB\r\n\x1A\n");
    std::vector<std::uint32_t> header{0x04030201};
    header.insert(header.end(), each.header.begin(), each.header.end());
    header.insert(header.end(), {8, 8, 0, 0, 6, 4, 12});
    for (std::size_t field = 0; field < header.size(); ++field) CHECK(word(bytes, 12 + 4 * field) == header[field]);
    CHECK(bytes.substr(64, 12) == std::string("\6\0\0\0sh\00012\0\0\0", 12));
    std::size_t place = 76;
    for (int level = 0; level < 4; ++level) {
      const auto size = static_cast<std::uint32_t>(8 >> level);
      const std::uint32_t blocks = (size + 3) / 4 * ((size + 3) / 4) * 16;
      const std::uint32_t texel_bytes = each.format == TexelFormat::rgba32f   ? 16
                                        : each.format == TexelFormat::rgba16f ? 8
                                                                              : 4;
      const std::uint32_t face = each.header[0] == 0 ? blocks : size * size * texel_bytes;
      CHECK(word(bytes, place) == face);
      place += 4 + 6 * face;
    }
    CHECK(place == bytes.size());
  }
}

TEST_CASE("a file of Filament's cmgen that is read and written has the same header and texels", "[codec][textures]") {
  if (!shared_pictures_are_here()) return;
  constexpr std::size_t kFormat = 24, kMetadataBytes = 60, kMetadata = 64;
  const TemporaryDirectory directory;
  for (const char* name : {"konzerthaus_ibl", "park_ibl", "pillars_ibl", "konzerthaus_skybox"}) {
    CAPTURE(name);
    const auto path = kPictures / "cube" / (std::string("open3d_") + name + ".ktx");
    const CubemapTexture texture = read_texture(path);
    TextureOptions options{.format = TexelFormat::b10g11r11};
    options.metadata = texture.metadata;
    write_texture(directory.file("again.ktx"), texture.cubemap.views(), options);
    CHECK(read_texture(directory.file("again.ktx")).metadata == texture.metadata);
    const std::string wanted = bytes_of(path);
    const std::string got = bytes_of(directory.file("again.ktx"));
    CHECK(word(wanted, kFormat) == 0x8C3A);  // as cmgen had it before 1.8: since then it is GL_RGB
    CHECK(word(got, kFormat) == 0x1907);
    CHECK(got.substr(0, kFormat) == wanted.substr(0, kFormat));
    CHECK(got.substr(kFormat + 4, kMetadataBytes - kFormat - 4) ==
          wanted.substr(kFormat + 4, kMetadataBytes - kFormat - 4));
    // Our text ends with a zero byte, as the specification recommends; cmgen's does not.
    const bool same_levels =
        got.substr(kMetadata + word(got, kMetadataBytes)) == wanted.substr(kMetadata + word(wanted, kMetadataBytes));
    CHECK(same_levels);
  }
}

TEST_CASE("what KTX of the first version cannot hold is refused", "[codec][textures]") {
  const TemporaryDirectory directory;
  const Cubemap chain = noisy_chain(4, 1);
  const TextureOptions packed{.supercompression = Supercompression::zlib};
  CHECK(thrown_by([&] { write_texture(directory.file("a.ktx"), chain.views(), packed); }).says("be supercompressed"));
  TextureOptions large;
  large.metadata = {{"note", std::string(std::size_t{1} << 20U, 'x')}};
  CHECK(thrown_by([&] { write_texture(directory.file("a.ktx"), chain.views(), large); }).says("1 MiB is the most"));
  CHECK(thrown_by([&] {
          write_texture_2d(directory.file("a.ktx"), 2, 2, chain.face(0, 0));
        }).says("written as a cubemap alone"));
}

}  // namespace welkin::test
