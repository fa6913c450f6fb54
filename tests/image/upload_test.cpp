// Promise: a cubemap goes into the caller's memory in the format, the pitch and the order that were asked for, the same
// texels as in a file; nothing is written beside them.
#include "image/pixels.h"
#include "support/catch.h"
#include "support/test_environments.h"
#include "support/thrown_error.h"
#include "welkin/core.h"
#include "welkin/image.h"

namespace welkin::test {
namespace {

constexpr TexelFormat kFormats[] = {TexelFormat::rgba16f, TexelFormat::rgba32f, TexelFormat::b10g11r11,
                                    TexelFormat::e5b9g9r9};
constexpr std::byte kUntouched{0xA5};

std::size_t texel_bytes(TexelFormat format) {
  return format == TexelFormat::rgba32f ? 16 : format == TexelFormat::rgba16f ? 8 : 4;
}

Cubemap random_chain(int size, int levels) {
  Cubemap chain(size, levels);
  for (int level = 0; level < levels; ++level) {
    const TestCubemap pixels = make_cubemap(Content::high_range, chain.level_size(level), 3, 7U);
    std::memcpy(chain.face(level, 0), pixels.pixels.data(), pixels.pixels.size() * sizeof(float));
  }
  return chain;
}

/// What one row is in the format, by the encoder whose every value tests/files/textures_test.cpp knows.
std::vector<std::uint8_t> encoded_row(const Cubemap& chain, int level, int face, int row, TexelFormat format) {
  const auto edge = static_cast<std::size_t>(chain.level_size(level));
  std::vector<std::uint8_t> texels(edge * texel_bytes(format));
  image::encode_texels(format, chain.face(level, face) + 3 * edge * static_cast<std::size_t>(row), edge, texels.data());
  return texels;
}

}  // namespace

TEST_CASE("upload: every texel is where the layout says, and nothing else is touched") {
  for (const int size : {1, 2, 3, 7, 64, 257}) {
    const Cubemap chain = random_chain(size, full_chain_levels(size));
    for (const TexelFormat format : kFormats) {
      for (const UploadOrder order : {UploadOrder::level_by_level, UploadOrder::face_by_face}) {
        for (const std::uint64_t alignment : {1U, 256U}) {
          INFO(size << ' ' << static_cast<int>(format) << ' ' << static_cast<int>(order) << ' ' << alignment);
          const UploadLayout layout{format, size, chain.levels(), order, alignment, 2 * alignment};
          std::vector<std::byte> memory(upload_bytes(layout) + 64, kUntouched);
          const std::vector<CubemapTarget> targets = upload_targets(layout, memory);
          REQUIRE(store_texels(chain, targets) == 0);
          std::vector<bool> written(memory.size(), false);
          bool right = true;
          for (int level = 0; level < chain.levels(); ++level) {
            const CubemapTarget& target = targets[static_cast<std::size_t>(level)];
            CHECK(target.row_stride_bytes % static_cast<std::ptrdiff_t>(alignment) == 0);
            for (int face = 0; face < 6; ++face) {
              const auto* const first = static_cast<const std::byte*>(target.faces[static_cast<std::size_t>(face)]);
              CHECK((first - memory.data()) % static_cast<std::ptrdiff_t>(2 * alignment) == 0);
              for (int row = 0; row < target.size; ++row) {
                const std::vector<std::uint8_t> expected = encoded_row(chain, level, face, row, format);
                const std::byte* const texels = first + row * target.row_stride_bytes;
                right = right && std::memcmp(texels, expected.data(), expected.size()) == 0;
                const auto begin = written.begin() + (texels - memory.data());
                right = right && std::find(begin, begin + static_cast<std::ptrdiff_t>(expected.size()), true) ==
                                     begin + static_cast<std::ptrdiff_t>(expected.size());
                std::fill_n(begin, expected.size(), true);
              }
            }
          }
          CHECK(right);
          for (std::size_t k = 0; k < memory.size(); ++k) right = right && (written[k] || memory[k] == kUntouched);
          CHECK(right);
        }
      }
    }
  }
}

TEST_CASE("upload: bottom-up rows, pixels of every kind, and the same bytes on any number of threads") {
  for (const PixelFormat format : {PixelFormat::rgb32f, PixelFormat::rgba32f, PixelFormat::rgb16f, PixelFormat::rgba16f,
                                   PixelFormat::rgb8, PixelFormat::srgba8}) {
    constexpr int size = 200;
    std::vector<std::byte> pixels(6 * size * size * bytes_per_texel(format), std::byte{0x2C});
    CubemapView view{{}, size, 0, format};
    for (std::size_t face = 0; face < 6; ++face)
      view.faces[face] = pixels.data() + face * size * size * bytes_per_texel(format);
    std::vector<std::vector<std::byte>> results;
    for (const int threads : {1, 2, 5}) {
      std::vector<std::byte> memory(6 * size * size * 8);
      CubemapTarget target{{}, size, -size * 8, TexelFormat::rgba16f};
      for (std::size_t face = 0; face < 6; ++face)
        target.faces[face] = memory.data() + (face * size + size - 1) * size * 8;
      run_with_threads(threads, [&] { store_texels(view, target); });
      results.push_back(std::move(memory));
    }
    CHECK(results[0] == results[1]);
    CHECK(results[0] == results[2]);
    float first[3] = {};
    image::decode_texels(format, pixels.data(), 1, first);
    std::uint16_t red = 0;
    std::memcpy(&red, results[0].data(), sizeof red);
    CHECK(red == image::half_from_float(first[0]));
  }
}

TEST_CASE("upload: what a format cannot hold is clamped and counted") {
  Cubemap chain(1, 1);
  std::fill_n(chain.face(0, 0), 18, 1.0F);
  chain.face(0, 0)[0] = 1e6F;
  chain.face(0, 1)[1] = -2.0F;
  chain.face(0, 2)[2] = std::numeric_limits<float>::quiet_NaN();
  const std::uint64_t expected[] = {2, 0, 3, 3};  // halves hold -2, floats everything
  for (std::size_t k = 0; k < 4; ++k) {
    const UploadLayout layout{kFormats[k], 1, 1};
    std::vector<std::byte> memory(upload_bytes(layout));
    CHECK(store_texels(chain, upload_targets(layout, memory)) == expected[k]);
  }
}

TEST_CASE("upload: what does not fit is refused before anything is written") {
  const Cubemap chain = random_chain(8, 2);
  const UploadLayout layout{TexelFormat::rgba16f, 8, 2};
  std::vector<std::byte> memory(upload_bytes(layout), kUntouched);
  const auto refused = [&](const auto& change) {
    std::vector<CubemapTarget> targets = upload_targets(layout, memory);
    change(targets);
    const ThrownError error = thrown_by([&] { store_texels(chain, targets); });
    CHECK(error.code == ErrorCode::invalid_argument);
    CHECK(std::all_of(memory.begin(), memory.end(), [](std::byte byte) { return byte == kUntouched; }));
  };
  refused([](auto& targets) { targets[1].faces[3] = nullptr; });
  refused([](auto& targets) { targets[1].size = 3; });
  refused([](auto& targets) { targets[1].row_stride_bytes = 31; });
  refused([](auto& targets) { targets[1].row_stride_bytes = -31; });
  refused([](auto& targets) { targets[1].format = static_cast<TexelFormat>(9); });
  refused([](auto& targets) { targets.pop_back(); });
  CHECK(thrown_by([&] {
          static_cast<void>(upload_targets(layout, std::span(memory).first(memory.size() - 1)));
        }).says("bytes"));
  for (const UploadLayout& wrong : {UploadLayout{TexelFormat::rgba16f, 0, 1}, UploadLayout{TexelFormat::rgba16f, 8, 5},
                                    UploadLayout{TexelFormat::rgba16f, 8, 0},
                                    UploadLayout{TexelFormat::rgba16f, 8, 1, UploadOrder::level_by_level, 0}}) {
    CHECK(thrown_by([&] { static_cast<void>(upload_bytes(wrong)); }).code == ErrorCode::invalid_argument);
  }
  Control control;
  stop_source stop;
  stop.request_stop();
  control.stop = stop.get_token();
  CHECK(thrown_by([&] { store_texels(chain, upload_targets(layout, memory), control); }).code == ErrorCode::cancelled);
}

}  // namespace welkin::test
