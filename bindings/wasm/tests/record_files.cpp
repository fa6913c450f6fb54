// Prints what codecs.test.mjs compares WebAssembly with: small files that OpenEXR itself wrote, of every compression,
// and the light that the native library finds in them. Run by hand, from the root of a tree with a release build:
//
//   g++ -std=c++20 -Iinclude -I/usr/include/OpenEXR -I/usr/include/Imath bindings/wasm/tests/record_files.cpp
//     build/release/module/libwelkin-files.a build/release/module/libwelkin-core.a -lOpenEXR-3_1 -lImath-3_1
//     -lIlmThread-3_1 -lIex-3_1 -lspng -lwebp -lz -lzstd -ltbb -lastcenc -o /tmp/record_files
//   /tmp/record_files >bindings/wasm/tests/data/files.json
#include <ImfChannelList.h>
#include <ImfFrameBuffer.h>
#include <ImfHeader.h>
#include <ImfIO.h>
#include <ImfOutputFile.h>
#include <half.h>

#include <charconv>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <cstring>
#include <iterator>
#include <span>
#include <string>
#include <vector>

#include "welkin/bake_file.h"
#include "welkin/engines.h"
#include "welkin/environment_file.h"

namespace {

constexpr int kWidth = 24;
constexpr int kHeight = 12;

/// A file in memory.
class Memory final : public Imf::OStream {
 public:
  Memory() : OStream("memory") {}
  void write(const char* from, int count) override {
    if (bytes.size() < at_ + static_cast<std::size_t>(count)) bytes.resize(at_ + static_cast<std::size_t>(count));
    std::memcpy(bytes.data() + at_, from, static_cast<std::size_t>(count));
    at_ += static_cast<std::size_t>(count);
  }
  std::uint64_t tellp() override { return at_; }
  void seekp(std::uint64_t to) override { at_ = static_cast<std::size_t>(to); }

  std::vector<std::byte> bytes;

 private:
  std::size_t at_ = 0;
};

/// A slope, a sun, and a little noise.
std::vector<float> image() {
  std::vector<float> rgb;
  std::uint32_t state = 7;
  for (int row = 0; row < kHeight; ++row) {
    for (int column = 0; column < kWidth; ++column) {
      for (int c = 0; c < 3; ++c) {
        state = state * 1664525 + 1013904223;
        const float noise = static_cast<float>(state >> 24U) / 4096.0F;
        const bool sun = row == 4 && column > 6 && column < 9;
        rgb.push_back((sun ? 40.0F : 0.25F + static_cast<float>(row * (c + 1)) / 24.0F) + noise);
      }
    }
  }
  return rgb;
}

std::vector<std::byte> open_exr(const std::vector<float>& rgb, Imf::Compression compression, bool halves) {
  Imf::Header header(kWidth, kHeight);
  header.compression() = compression;
  const std::vector<half> narrow(rgb.begin(), rgb.end());
  Imf::FrameBuffer buffer;
  const Imf::PixelType type = halves ? Imf::HALF : Imf::FLOAT;
  const std::size_t bytes = halves ? 2 : 4;
  const char* const first =
      halves ? reinterpret_cast<const char*>(narrow.data()) : reinterpret_cast<const char*>(rgb.data());
  for (std::size_t c = 0; c < 3; ++c) {
    const std::string name(1, "RGB"[c]);
    header.channels().insert(name, Imf::Channel(type));
    buffer.insert(name, Imf::Slice(type, const_cast<char*>(first) + c * bytes, 3 * bytes, 3 * bytes * kWidth));
  }
  Memory memory;
  {
    Imf::OutputFile file(memory, header);
    file.setFrameBuffer(buffer);
    file.writePixels(kHeight);
  }
  return memory.bytes;
}

void print_bytes(const char* name, std::span<const std::byte> bytes) {
  std::printf("\"%s\": \"", name);
  for (const std::byte byte : bytes) std::printf("%02x", static_cast<unsigned>(byte));
  std::printf("\"");
}

/// FNV-1a of 64 bits.
void print_hash(const char* name, std::span<const std::byte> bytes) {
  std::uint64_t hash = 0xcbf29ce484222325;
  for (const std::byte byte : bytes) hash = (hash ^ static_cast<std::uint64_t>(byte)) * 0x100000001b3;
  std::printf(", \"%s\": \"%016llx\"", name, static_cast<unsigned long long>(hash));
}

/// The hashes are those of bakeEnvironment's files for a size of 16 and Babylon.js's roughness.
void print_light(const std::string& name, const std::vector<std::byte>& file, bool with_files) {
  const welkin::FileInput input{file, name};
  const welkin::Environment read = welkin::read_environment(input);
  const bool wide = read.face_size() == 0;
  const welkin::LatLongView view = wide ? read.lat_long() : welkin::LatLongView{};
  std::printf(" {\"name\": \"%s\", \"width\": %d, \"height\": %d, ", name.c_str(), read.info.width, read.info.height);
  print_bytes("file", file);
  std::printf(", \"radiance\": [");
  const char* between = "";
  const auto radiance = (wide ? welkin::project(view) : welkin::project(read.cubemap())).radiance;
  for (const auto& coefficient : radiance.coefficients()) {
    std::printf("%s%.17g, %.17g, %.17g", between, coefficient.x, coefficient.y, coefficient.z);
    between = ", ";
  }
  std::printf("]");
  if (with_files) {
    welkin::PrefilterOptions chain{.size = 16};
    chain.mips = welkin::default_mip_count(welkin::RoughnessSchedule::babylon, 16);
    chain.roughness = welkin::mip_roughness(welkin::RoughnessSchedule::babylon, *chain.mips, 16);
    const welkin::PrefilteredSpecular light = welkin::prefilter_specular(view, chain);
    std::vector<std::byte> texture;
    welkin::TextureOptions options{.format = welkin::TexelFormat::rgba16f};
    std::string& roughness = options.metadata["welkin.roughness"];
    for (const welkin::MipRecord& mip : light.mips) {
      char number[32];
      *std::to_chars(number, std::end(number), mip.roughness).ptr = '\0';
      roughness += (roughness.empty() ? "" : " ") + std::string(number);
    }
    welkin::write_texture({texture, "a.ktx2"}, light.cubemap.views(), options);
    print_hash("ktx2", texture);
    chain.mips = welkin::full_chain_levels(16);
    chain.roughness = welkin::mip_roughness(welkin::RoughnessSchedule::babylon, *chain.mips, 16);
    chain.lobe_roughness = welkin::fitted_mip_roughness(welkin::RoughnessSchedule::babylon, *chain.mips, 16);
    std::vector<std::byte> env;
    welkin::write_babylon_environment({env, "a.env"},
                                      welkin::to_babylon(welkin::prefilter_specular(view, chain).cubemap, radiance));
    print_hash("env", env);
  }
  std::printf("}");
}

}  // namespace

int main() {
  const std::vector<float> rgb = image();
  struct Kind {
    const char* name;
    Imf::Compression compression;
  };
  constexpr Kind kKinds[] = {{"none", Imf::NO_COMPRESSION},   {"rle", Imf::RLE_COMPRESSION},
                             {"zips", Imf::ZIPS_COMPRESSION}, {"zip", Imf::ZIP_COMPRESSION},
                             {"piz", Imf::PIZ_COMPRESSION},   {"pxr24", Imf::PXR24_COMPRESSION},
                             {"b44", Imf::B44_COMPRESSION},   {"b44a", Imf::B44A_COMPRESSION},
                             {"dwaa", Imf::DWAA_COMPRESSION}, {"dwab", Imf::DWAB_COMPRESSION}};
  const char* between = "[\n";
  for (const Kind& kind : kKinds) {
    for (const bool halves : {false, true}) {
      std::printf("%s", between);
      print_light(std::string(kind.name) + (halves ? "_half.exr" : "_float.exr"),
                  open_exr(rgb, kind.compression, halves), !halves && kind.compression == Imf::ZIP_COMPRESSION);
      between = ",\n";
    }
  }

  // What other codecs have packed: levels of a KTX2 by zlib, a PNG, an .env.
  const welkin::LatLongView view{rgb.data(), kWidth, kHeight, 0, welkin::PixelFormat::rgb32f};
  const welkin::PrefilteredSpecular chain = welkin::prefilter_specular(view, {.size = 4, .mips = 3, .roughness = {}});
  std::vector<std::byte> file;
  welkin::write_texture({file, "a.ktx2"}, chain.cubemap.views(),
                        {.format = welkin::TexelFormat::rgba16f, .supercompression = welkin::Supercompression::zlib});
  std::printf("%s", between);
  print_light("zlib.ktx2", file, false);
  welkin::write_environment({file, "a.png"}, view);
  std::printf("%s", between);
  print_light("bytes.png", file, false);
  welkin::write_babylon_environment({file, "a.env"}, welkin::to_babylon(chain.cubemap, welkin::project(view).radiance));
  std::printf("%s", between);
  print_light("rgbd.env", file, false);
  std::printf("\n]\n");
}
