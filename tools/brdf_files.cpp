#include "tools/brdf_files.h"

#include <cstddef>

namespace welkin::tool {
namespace {

/// Three channels, the third one 0 where the table has two.
LatLongImage picture_of(const BrdfTable& table) {
  LatLongImage picture{table.options.width, table.options.height, {}};
  const auto channels = static_cast<std::size_t>(table.channels);
  for (std::size_t at = 0; at < table.values.size(); at += channels) {
    for (std::size_t channel = 0; channel < 3; ++channel) {
      picture.pixels.push_back(channel < channels ? table.values[at + channel] : 0.0F);
    }
  }
  return picture;
}

}  // namespace

std::vector<std::string> brdf_channels(const BrdfTableOptions& options) {
  std::vector<std::string> names = options.model == BrdfModel::split_sum
                                       ? std::vector<std::string>{"scale", "bias"}
                                       : std::vector<std::string>{"albedo at f0 = 0", "albedo at f0 = 1"};
  if (options.sheen) names.emplace_back("sheen albedo");
  return names;
}

std::vector<std::string> brdf_names(const BakeCommandOptions& options) {
  std::vector<std::string> names;
  for (const Container container : {Container::ktx2, Container::dds}) {
    if (options.containers.contains(container)) names.push_back(std::string("brdf.") + name(container));
  }
  const bool babylon_alone = options.containers == std::set<Container>{Container::env};  // it has a table of its own
  if (names.empty() && !babylon_alone) names.emplace_back("brdf.pfm");
  return names;
}

void write_brdf(const BrdfTable& table, const BakeCommandOptions& options, OutputFolder& folder,
                const Control& control) {
  const LatLongImage picture = picture_of(table);
  constexpr const char* kWhat = "BRDF table: columns along N.V, rows along roughness, the smoothest on top";
  const Json details = {
      {"width", picture.width}, {"height", picture.height}, {"channels", brdf_channels(table.options)}};
  TextureOptions texture;
  texture.format = options.texture.format == TexelFormat::rgba32f ? TexelFormat::rgba32f : TexelFormat::rgba16f;
  const bool floats = texture.format == TexelFormat::rgba32f;
  for (const Container container : {Container::ktx2, Container::dds}) {
    if (!options.containers.contains(container)) continue;
    const std::string file = std::string("brdf.") + name(container);
    texture.supercompression = container == Container::ktx2 ? options.texture.supercompression : Supercompression::none;
    texture.metadata.clear();
    if (container == Container::ktx2) texture.metadata = {{"welkin.content", "brdf"}};
    write_texture_2d(folder.place(file), picture.width, picture.height, picture.pixels.data(), texture,
                     {control.stop, {}});
    const std::string format = container == Container::ktx2 ? "KTX2 " : "DDS ";
    folder.add({file, kWhat, format + (floats ? "rgba32f" : "rgba16f"), 0, 0, "", details});
  }
  constexpr const char* kName = "brdf.pfm";
  if (brdf_names(options) != std::vector<std::string>{kName}) return;
  WriteOptions write;
  write.layout = Layout::lat_long;  // a plain picture, to a PFM
  write_environment(folder.place(kName), picture.view(), write, {control.stop, {}});
  folder.add({kName, kWhat, "PFM", 0, 0, "", details});
}

}  // namespace welkin::tool
