// Files of textures: chains into KTX2 and .env files, and KTX2 files that others' codecs packed into pixels. The
// modules that bake have none of it, and the worker hands floats from one module to the other.
#include "files/textures.h"

#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "files/row_source.h"
#include "interface.h"
#include "platform/text.h"
#include "welkin/bake_file.h"
#include "welkin/environment_file.h"

namespace welkin::wasm {
namespace {

constexpr std::uint64_t kMaxBytes = std::uint64_t{3} << 30U;

/// Packed RGB floats of a chain, mip by mip and face by face, come first.
enum ChainInput { kFloats, kSize, kLevels, kChainInput };

Cubemap chain_of(const Options& options) {
  Cubemap chain(options.whole(kSize), options.whole(kLevels));
  const auto* const floats = options.pointer<float>(kFloats);
  std::copy_n(floats, chain.pixels().size(), chain.pixels().begin());
  return chain;
}

enum TextureOption { kTexelFormat = kChainInput, kSupercompression, kEffort, kMirrored, kRoughness };

/// Result: a KTX2 file. `kRoughness`: one number a mip.
void pack_texture(const Options& options) {
  Cubemap chain = chain_of(options);
  if (options.flag(kMirrored)) chain = mirrored_x(chain);
  TextureOptions texture{.format = static_cast<TexelFormat>(options.whole(kTexelFormat)),
                         .supercompression = static_cast<Supercompression>(options.whole(kSupercompression)),
                         .bc6h_effort = static_cast<Bc6hEffort>(options.whole(kEffort))};
  std::string roughness;
  for (int mip = 0; mip < chain.levels(); ++mip) {
    if (mip > 0) roughness += ' ';
    roughness += platform::number_text(options.pointer<double>(kRoughness)[mip]);
  }
  texture.metadata["welkin.roughness"] = roughness;
  std::vector<std::byte> ktx2;
  write_texture({ktx2, "environment.ktx2"}, chain.views(), texture);
  give(std::move(ktx2));
}

enum EnvOption { kBands = kChainInput, kRadiance };

/// Result: an .env file.
void pack_env(const Options& options) {
  SphericalHarmonics radiance(options.whole(kBands));
  const auto* numbers = options.pointer<double>(kRadiance);
  for (dvec3& coefficient : radiance.coefficients()) {
    coefficient = {numbers[0], numbers[1], numbers[2]};
    numbers += 3;
  }
  std::vector<std::byte> bytes;
  write_babylon_environment({bytes, "environment.env"}, to_babylon(chain_of(options), radiance));
  give(std::move(bytes));
}

enum PackedOption { kBytes, kLength, kName };

/// Results: width, and height or 0 for a cubemap; packed RGB floats of the largest level.
void unpack_texture(const Options& options) {
  const std::span<const std::byte> bytes(options.pointer<std::byte>(kBytes),
                                         static_cast<std::size_t>(options.number(kLength)));
  platform::ByteFile file = files::open_file({bytes, options.pointer<char>(kName)});
  const std::unique_ptr<files::RowSource> source = files::open_texture(file, {});
  const EnvironmentInfo& info = source->info();
  const auto values = std::size_t{3} * static_cast<std::size_t>(info.width) * static_cast<std::size_t>(info.height);
  const std::shared_ptr<float[]> pixels(new float[values]);  // all written
  files::read_all_rows(*source, kMaxBytes, reporting(), pixels.get());
  const bool cube = info.layout == Layout::vertical_strip;
  if (!cube && info.layout != Layout::lat_long) {
    throw Error(ErrorCode::unsupported_file, std::string(options.pointer<char>(kName)) +
                                                 ": is packed, and neither a cubemap nor a lat-long; save it "
                                                 "without supercompression");
  }
  give(std::vector<double>{static_cast<double>(info.width), cube ? 0.0 : static_cast<double>(info.height)});
  results().push_back({pixels.get(), values * sizeof(float), {pixels, pixels.get()}});
}

}  // namespace
}  // namespace welkin::wasm

WELKIN_ENTRY(welkin_pack_texture) int welkin_pack_texture(const double* options) {
  return welkin::wasm::guarded(welkin::wasm::pack_texture, options);
}

WELKIN_ENTRY(welkin_pack_env) int welkin_pack_env(const double* options) {
  return welkin::wasm::guarded(welkin::wasm::pack_env, options);
}

WELKIN_ENTRY(welkin_unpack_texture) int welkin_unpack_texture(const double* options) {
  return welkin::wasm::guarded(welkin::wasm::unpack_texture, options);
}
