// Cubemaps in blocks, as GPUs read them: cost and error of each format and effort.

#include "perf/report/passes.h"
#include "welkin/bake_file.h"
#include "welkin/reflections.h"

namespace welkin::report {

std::vector<BlockWay> block_ways() {
  std::vector<BlockWay> all;
  for (const auto& [effort, name] : {std::pair{Bc6hEffort::fast, "fast"}, std::pair{Bc6hEffort::normal, "normal"},
                                     std::pair{Bc6hEffort::slow, "slow"}}) {
    all.push_back({"BC6H", name, {.format = TexelFormat::bc6h_ufloat, .bc6h_effort = effort}});
    all.push_back({"UASTC HDR", name, {.format = TexelFormat::uastc_hdr_4x4, .bc6h_effort = effort}});
  }
  for (const auto& [format, words] :
       {std::pair{TexelFormat::astc_4x4_hdr, "ASTC 4x4"}, std::pair{TexelFormat::astc_6x6_hdr, "ASTC 6x6"}}) {
    for (const auto& [effort, name] :
         {std::pair{AstcEffort::fastest, "fastest"}, std::pair{AstcEffort::fast, "fast"},
          std::pair{AstcEffort::medium, "medium"}, std::pair{AstcEffort::thorough, "thorough"}}) {
      all.push_back({words, name, {.format = format, .astc_effort = effort}});
    }
  }
  return all;
}

std::optional<std::vector<std::byte>> texture_bytes(const Cubemap& chain, const TextureOptions& options) {
  std::vector<std::byte> bytes;
  try {
    write_texture({bytes, "chain.ktx2"}, chain.views(), options);
  } catch (const Error& error) {
    if (error.code() != ErrorCode::unsupported_file) throw;
    return std::nullopt;
  }
  return bytes;
}

namespace {

double texels_of(const Cubemap& chain) { return static_cast<double>(chain.bytes()) / (3.0 * sizeof(float)); }

/// Returns "normal, 1.00 bytes per texel".
std::string setting_of(const BlockWay& way, std::size_t file_bytes, const Cubemap& chain) {
  std::array<char, 64> text{};
  std::snprintf(text.data(), text.size(), "%s, %.2f bytes per texel", way.effort,
                static_cast<double>(file_bytes) / texels_of(chain));
  return text.data();
}

/// Returns whether astcenc decodes it.
bool is_astc(const BlockWay& way) {
  return way.options.format == TexelFormat::astc_4x4_hdr || way.options.format == TexelFormat::astc_6x6_hdr ||
         way.options.format == TexelFormat::uastc_hdr_4x4;
}

std::vector<BlockWay> ways_of(const Scale& scale) {
  std::vector<BlockWay> all = block_ways();
  if (!scale.peers) std::erase_if(all, is_astc);
  all.push_back({"E5B9G9R9", "as it is", {.format = TexelFormat::e5b9g9r9}});
  all.push_back({"B10G11R11", "as it is", {.format = TexelFormat::b10g11r11}});
  return all;
}

std::vector<Measurement> measure(const PassContext& context) {
  PrefilterOptions options;
  options.size = context.scale.chain_size;
  const Cubemap chain = prefilter_specular(context.environment.image.view(), options).cubemap;
  const std::vector<BlockWay> ways = ways_of(context.scale);
  std::vector<Measurement> all;
  for (std::size_t number = 0; number < ways.size(); ++number) {
    progress(context, number, ways.size());
    const BlockWay& way = ways[number];
    const std::optional<std::vector<std::byte>> bytes = texture_bytes(chain, way.options);
    if (!bytes) continue;
    const CubemapTexture decoded = read_texture({*bytes, "chain.ktx2"});
    const double seconds = context.stopwatch.seconds([&] { (void)texture_bytes(chain, way.options); });
    all.push_back(measurement(way.format, setting_of(way, bytes->size(), chain),
                              relative_errors(decoded.cubemap.pixels(), chain.pixels()), seconds,
                              "the floats that were encoded"));
  }
  return all;
}

}  // namespace

std::vector<PassRunner> block_passes() {
  return {
      {{"blocks", "Compressed specular chains",
        "A prefiltered chain is written to a KTX2 in memory, in formats of 4, 1 and 4/9 (ASTC 6x6) bytes per texel.",
        "Difference of each channel value relative to the value, or to 2^-14 if that is larger. rms and maximum over "
        "all levels."},
       2.0,
       measure}};
}

}  // namespace welkin::report
