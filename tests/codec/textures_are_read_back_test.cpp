// Promises: what is written as KTX2, DDS or mip-mapped OpenEXR comes back texel for texel, rounded as the format says;
// the bytes are where the formats' specifications want them, and the same on any number of threads.
#include <Imath/half.h>

#include <cmath>
#include <cstring>
#include <glm/glm.hpp>

#include "codec/small_floats.h"
#include "support/catch.h"
#include "support/chains.h"
#include "support/same_bits.h"
#include "support/temporary_directory.h"
#include "support/thrown_error.h"
#include "welkin/control.h"
#include "welkin/environment_file.h"
#include "welkin/texture_file.h"

namespace welkin::test {
namespace {

constexpr std::array kFormats{TexelFormat::rgba16f, TexelFormat::rgba32f, TexelFormat::b10g11r11,
                              TexelFormat::e5b9g9r9};
constexpr std::array kPackings{Supercompression::none, Supercompression::zlib, Supercompression::zstd};

/// A step of the format at a value: that of a half, ...
double step(TexelFormat format, double value, double largest_of_texel) {
  switch (format) {
    case TexelFormat::rgba16f: return std::ldexp(std::abs(value), -10);
    case TexelFormat::rgba32f: return 0.0;
    case TexelFormat::b10g11r11: return std::ldexp(std::abs(value), -5);
    case TexelFormat::e5b9g9r9: return std::ldexp(largest_of_texel, -8) * 1.001;  // 511.5 steps are rounded to 512
  }
  return 0.0;
}

/// Whether each value of `read` is half a step from what was written, at most.
bool is_rounded(const CubemapChain& written, const CubemapChain& read, TexelFormat format) {
  if (written.size() != read.size() || written.levels() != read.levels()) return false;
  for (int level = 0; level < written.levels(); ++level) {
    for (int face = 0; face < 6; ++face) {
      for (std::size_t texel = 0; texel < face_values(written, level); texel += 3) {
        const float* from = written.face(level, face) + texel;
        const float* to = read.face(level, face) + texel;
        const double largest = std::max({std::abs(from[0]), std::abs(from[1]), std::abs(from[2])});
        for (int c = 0; c < 3; ++c) {
          const double off = std::abs(static_cast<double>(from[c]) - static_cast<double>(to[c]));
          if (!(off <= 0.5 * step(format, static_cast<double>(from[c]), largest))) return false;
        }
      }
    }
  }
  return true;
}

std::uint64_t number(const std::vector<char>& bytes, std::size_t place, std::size_t count) {
  std::uint64_t value = 0;
  std::memcpy(&value, bytes.data() + place, count);
  return value;
}

CubemapChain half_chain(int size, int levels) {
  return changed(noisy_chain(size, levels), [](float value) { return static_cast<float>(Imath::half(value)); });
}

}  // namespace

TEST_CASE("textures come back rounded as their format says, at every size", "[codec][textures]") {
  const TemporaryDirectory directory;
  for (const int size : {1, 2, 3, 7, 64, 257}) {
    for (const int levels : {1, full_chain_levels(size)}) {
      if (size == 257 && levels == 1) continue;  // takes its time, and says nothing new
      const CubemapChain chain = noisy_chain(size, levels);
      for (const TexelFormat format : kFormats) {
        for (const Supercompression packing : kPackings) {
          CAPTURE(size, levels, static_cast<int>(format), static_cast<int>(packing));
          const auto path = directory.file("sky.ktx2");
          const WriteReport report = write_texture(path, chain.views(), {format, packing, {{"key", "value"}}});
          CHECK(report.values_clamped == 0);
          CHECK(report.files == std::vector<std::filesystem::path>{path});
          const CubemapTexture texture = read_texture(path);
          CHECK(is_rounded(chain, texture.cubemap, format));
          CHECK(texture.metadata.at("key") == "value");
          CHECK(texture.metadata.at("KTXorientation") == "rd");
        }
        const auto path = directory.file("sky.dds");
        write_texture(path, chain.views(), {format});
        CHECK(is_rounded(chain, read_texture(path).cubemap, format));
      }
    }
  }
}

TEST_CASE("a KTX2 file has its parts where the specification wants them", "[codec][textures]") {
  const TemporaryDirectory directory;
  const CubemapChain chain = half_chain(6, 3);
  for (const TexelFormat format : kFormats) {
    for (const Supercompression packing : kPackings) {
      CAPTURE(static_cast<int>(format), static_cast<int>(packing));
      write_texture(directory.file("sky.ktx2"), chain.views(), {format, packing, {{"zeta", "1"}, {"Alpha", "22"}}});
      const std::vector<char> bytes = read_bytes(directory.file("sky.ktx2"));
      const std::size_t texel = format == TexelFormat::rgba16f ? 8 : format == TexelFormat::rgba32f ? 16 : 4;
      CHECK(std::string(bytes.data() + 1, 6) == "KTX 20");
      constexpr std::array<std::uint64_t, 4> formats{97, 109, 122, 123};
      CHECK(number(bytes, 12, 4) == formats[static_cast<std::size_t>(format)]);
      CHECK(number(bytes, 20, 4) == 6);  // width and height
      CHECK(number(bytes, 24, 4) == 6);
      CHECK(number(bytes, 36, 4) == 6);  // faces
      CHECK(number(bytes, 40, 4) == 3);  // levels
      CHECK(number(bytes, 44, 4) == (packing == Supercompression::none   ? 0U
                                     : packing == Supercompression::zstd ? 2U
                                                                         : 3U));
      const std::size_t descriptor = number(bytes, 48, 4);
      CHECK(descriptor == 80 + 3 * 24);
      CHECK(number(bytes, descriptor, 4) == number(bytes, 52, 4));
      const std::size_t samples = format == TexelFormat::e5b9g9r9 ? 6 : format == TexelFormat::b10g11r11 ? 3 : 4;
      CHECK(number(bytes, 52, 4) == 4 + 24 + 16 * samples);
      CHECK(number(bytes, descriptor + 20, 1) == (packing == Supercompression::none ? texel : 0));
      const std::size_t metadata = number(bytes, 56, 4);
      CHECK(metadata == descriptor + number(bytes, 52, 4));
      const std::string text(bytes.data() + metadata, number(bytes, 60, 4));
      CHECK(text.find("Alpha") < text.find("KTXorientation"));
      CHECK(text.find("KTXorientation") < text.find("KTXwriter"));
      CHECK(text.find("KTXwriter") < text.find("zeta"));
      std::uint64_t end = metadata + number(bytes, 60, 4);
      for (const std::size_t level : {2U, 1U, 0U}) {  // the smallest comes first
        const std::size_t entry = 80 + 24 * level;
        const std::uint64_t offset = number(bytes, entry, 8);
        const std::uint64_t edge = 6U >> level;
        CHECK(offset >= end);
        CHECK(offset < end + texel);
        if (packing == Supercompression::none) CHECK(offset % texel == 0);
        CHECK(number(bytes, entry + 16, 8) == 6 * edge * edge * texel);
        end = offset + number(bytes, entry + 8, 8);
      }
      CHECK(end == bytes.size());
    }
  }
}

TEST_CASE("plain KTX2 levels start at multiples of a texel, however long the metadata is", "[codec][textures]") {
  const TemporaryDirectory directory;
  const CubemapChain chain = half_chain(2, 2);
  for (std::size_t length = 0; length < 16; length += 4) {
    const TextureOptions options{TexelFormat::rgba32f, Supercompression::none, {{"k", std::string(length, 'x')}}};
    write_texture(directory.file("sky.ktx2"), chain.views(), options);
    const std::vector<char> bytes = read_bytes(directory.file("sky.ktx2"));
    CHECK(number(bytes, 80, 8) % 16 == 0);
    CHECK(number(bytes, 104, 8) % 16 == 0);
  }
}

TEST_CASE("a DDS file has face after face, with its levels from the largest to the smallest", "[codec][textures]") {
  const TemporaryDirectory directory;
  const CubemapChain chain = half_chain(4, 3);
  write_texture(directory.file("sky.dds"), chain.views(), {});
  const std::vector<char> bytes = read_bytes(directory.file("sky.dds"));
  REQUIRE(bytes.size() == 148 + 6 * (16 + 4 + 1) * 8);
  CHECK(std::string(bytes.data(), 4) == "DDS ");
  CHECK(std::string(bytes.data() + 84, 4) == "DX10");
  CHECK(number(bytes, 28, 4) == 3);
  CHECK(number(bytes, 112, 4) == 0xFE00);
  CHECK(number(bytes, 128, 4) == 10);
  CHECK(number(bytes, 136, 4) == 4);
  std::size_t place = 148;
  bool right = true;
  for (int face = 0; face < 6; ++face) {
    for (int level = 0; level < 3; ++level) {
      for (std::size_t i = 0; i < face_values(chain, level); i += 3, place += 8) {
        for (std::size_t c = 0; c < 3; ++c) {
          Imath::half half;
          half.setBits(static_cast<std::uint16_t>(number(bytes, place + 2 * c, 2)));
          right = right && static_cast<float>(half) == chain.face(level, face)[i + c];
        }
        right = right && number(bytes, place + 6, 2) == 0x3C00;
      }
    }
  }
  CHECK(right);
}

TEST_CASE("each level of a mip-mapped OpenEXR cube is read back, in our frames", "[codec][textures]") {
  const TemporaryDirectory directory;
  const auto path = directory.file("sky.exr");
  for (const TexelFormat format : {TexelFormat::rgba16f, TexelFormat::rgba32f}) {
    for (const auto& [size, levels] : {std::pair{1, 1}, {2, 2}, {64, 7}, {64, 3}, {256, 1}}) {
      const CubemapChain chain = half_chain(size, levels);
      write_texture(path, chain.views(), {format, Supercompression::none, {{"roughness", "0 0.5 1"}}});
      for (int level = 0; level < levels; ++level) {
        CAPTURE(size, levels, level);
        ReadOptions options;
        options.level = level;
        const Environment read = read_environment(path, options);
        REQUIRE(read.face_size() == chain.level_size(level));
        CHECK(same_bytes<float>({read.pixels.get(), 6 * face_values(chain, level)},
                                {chain.face(level, 0), 6 * face_values(chain, level)}));
      }
    }
  }
  const EnvironmentInfo info = inspect_environment(path);
  CHECK(info.storage.find("mip-mapped tiles") != std::string::npos);
  CHECK(info.layout_reason.find("envmap") != std::string::npos);
}

TEST_CASE("levels of an OpenEXR cube that were not given are means of the last one", "[codec][textures]") {
  const TemporaryDirectory directory;
  const CubemapChain chain = half_chain(16, 2);
  write_texture(directory.file("sky.exr"), chain.views(), {TexelFormat::rgba32f});
  ReadOptions options;
  options.level = 3;
  const Environment read = read_environment(directory.file("sky.exr"), options);
  REQUIRE(read.face_size() == 2);
  for (int face = 0; face < 6; ++face) {
    double sum = 0.0;  // of the top left quarter of 8 x 8
    for (int j = 0; j < 4; ++j) {
      for (int i = 0; i < 4; ++i) sum += static_cast<double>(chain.face(1, face)[3 * (8 * j + i)]);
    }
    CHECK(std::abs(static_cast<double>(read.pixels[static_cast<std::size_t>(face) * 12]) - sum / 16.0) < 1e-6 * sum);
  }
}

TEST_CASE("odd sizes of an OpenEXR cube are written whole", "[codec][textures]") {
  const TemporaryDirectory directory;
  for (const int size : {3, 7, 257}) {
    const CubemapChain chain = half_chain(size, full_chain_levels(size));
    write_texture(directory.file("sky.exr"), chain.views(), {});
    const Environment read = read_environment(directory.file("sky.exr"));
    CHECK(read.face_size() == size);
    CHECK(same_bytes<float>({read.pixels.get(), 6 * face_values(chain, 0)},
                            {chain.face(0, 0), 6 * face_values(chain, 0)}));
  }
}

TEST_CASE("a texture's bytes do not depend on the number of threads", "[codec][textures]") {
  const TemporaryDirectory directory;
  const CubemapChain chain = noisy_chain(128, 8);
  for (const char* file : {"sky.ktx2", "sky.dds", "sky.exr"}) {
    for (const Supercompression packing : kPackings) {
      if (packing != Supercompression::none && std::string(file) != "sky.ktx2") continue;
      std::vector<char> first;
      for (const int threads : {1, 2, 5}) {
        CubemapChain read;
        run_with_threads(threads, [&] {
          write_texture(directory.file(file), chain.views(), {TexelFormat::rgba16f, packing, {}});
          if (std::string(file) != "sky.exr") read = read_texture(directory.file(file)).cubemap;
        });
        const std::vector<char> bytes = read_bytes(directory.file(file));
        if (threads == 1) first = bytes;
        CHECK(bytes == first);
        if (std::string(file) != "sky.exr") CHECK(is_rounded(chain, read, TexelFormat::rgba16f));
      }
    }
  }
}

TEST_CASE("views of any format and stride are written as they are seen", "[codec][textures]") {
  const TemporaryDirectory directory;
  std::vector<std::uint16_t> halves;
  for (int texel = 0; texel < 6 * 3 * 5; ++texel) {  // rows of 5 texels, of which 3 are the picture
    for (int channel = 0; channel < 4; ++channel) {
      halves.push_back(Imath::half(static_cast<float>(texel * 4 + channel) * 0.25F).bits());
    }
  }
  CubemapView view{{}, 3, -5 * 8, PixelFormat::rgba_f16};  // bottom row first
  for (std::size_t face = 0; face < 6; ++face) view.faces[face] = halves.data() + (face * 15 + 10) * 4;
  write_texture(directory.file("sky.ktx2"), {&view, 1}, {});
  const CubemapTexture read = read_texture(directory.file("sky.ktx2"));
  for (int face = 0; face < 6; ++face) {
    for (int row = 0; row < 3; ++row) {
      const float wanted = static_cast<float>((face * 15 + (2 - row) * 5 + 1) * 4 + 2) * 0.25F;
      CHECK(read.cubemap.face(0, face)[3 * (row * 3 + 1) + 2] == wanted);
    }
  }
}

TEST_CASE("what is clamped on the way into a texture is counted", "[codec][textures]") {
  const TemporaryDirectory directory;
  CubemapChain chain = noisy_chain(4, 3);
  chain.face(0, 2)[7] = 1e6F;
  chain.face(2, 5)[0] = -1e6F;
  for (const char* file : {"sky.ktx2", "sky.dds", "sky.exr"}) {
    CHECK(write_texture(directory.file(file), chain.views(), {}).values_clamped == 2);
    CHECK(write_texture(directory.file(file), chain.views(), {TexelFormat::rgba32f}).values_clamped == 0);
  }
  const TextureOptions packed{TexelFormat::e5b9g9r9, Supercompression::zstd, {}};
  CHECK(write_texture(directory.file("sky.ktx2"), chain.views(), packed).values_clamped == 2);
}

TEST_CASE("a picture is written as a two-dimensional texture, row after row", "[codec][textures]") {
  const TemporaryDirectory directory;
  const CubemapChain chain = half_chain(4, 1);
  const float* rgb = chain.face(0, 0);
  for (const auto& [width, height] : {std::pair{1, 1}, {7, 3}, {2, 16}}) {
    const auto texels = static_cast<std::size_t>(width * height);
    const auto holds_halves = [&](const std::vector<char>& bytes, std::size_t place) {
      bool right = bytes.size() == place + 8 * texels;
      for (std::size_t i = 0; right && i < 3 * texels; ++i) {
        Imath::half half;
        half.setBits(static_cast<std::uint16_t>(number(bytes, place + i / 3 * 8 + i % 3 * 2, 2)));
        right = static_cast<float>(half) == rgb[i];
      }
      return right;
    };
    write_texture_2d(directory.file("table.ktx2"), width, height, rgb);
    std::vector<char> bytes = read_bytes(directory.file("table.ktx2"));
    CHECK(number(bytes, 20, 4) == static_cast<std::uint64_t>(width));
    CHECK(number(bytes, 24, 4) == static_cast<std::uint64_t>(height));
    CHECK(number(bytes, 36, 4) == 1);
    CHECK(holds_halves(bytes, number(bytes, 80, 8)));
    write_texture_2d(directory.file("table.dds"), width, height, rgb);
    bytes = read_bytes(directory.file("table.dds"));
    CHECK(number(bytes, 112, 4) == 0);
    CHECK(number(bytes, 12, 4) == static_cast<std::uint64_t>(height));
    CHECK(number(bytes, 16, 4) == static_cast<std::uint64_t>(width));
    CHECK(holds_halves(bytes, 148));
  }
  const auto refusal = [&](const char* file, int width, const float* pixels) {
    return thrown_by([&] { write_texture_2d(directory.file(file), width, 4, pixels); });
  };
  CHECK(refusal("table.exr", 4, rgb).code == ErrorCode::unsupported_file);
  CHECK(refusal("table.dds", 0, rgb).code == ErrorCode::invalid_argument);
  CHECK(refusal("table.dds", 4, nullptr).says("no pixels"));
  CHECK(thrown_by([&] { (void)read_texture(directory.file("table.ktx2")); }).says("has 1 face; cubemaps"));
}

}  // namespace welkin::test
