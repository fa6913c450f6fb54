// `welkin info --json`. Members are only ever added: programs read this.
#include "tools/info_report.h"
#include "tools/json_text.h"

namespace welkin::tool {
namespace {

Json source_json(const EnvironmentInfo& file) {
  return {{"path", file.path.string()}, {"layout", name(file.layout)}, {"width", file.width},
          {"height", file.height},      {"format", file.format},       {"notes", file.notes}};
}

Json storage_json(const EnvironmentInfo& file) {
  Json levels = Json::array();
  for (const LevelInfo& level : file.levels) levels.push_back({level.width, level.height});
  Json json = {{"compression", file.compression},
               {"storage", file.storage},
               {"layout_reason", file.layout_reason},
               {"levels", levels},
               {"parts", file.parts},
               {"layers", file.layers}};
  if (file.layout == Layout::six_files) {
    Json faces = Json::array();
    for (const std::filesystem::path& face : file.faces) faces.push_back(face.string());
    json["faces"] = faces;
  }
  return json;
}

Json channels_json(const EnvironmentInfo& file) {
  Json list = Json::array();
  for (const ChannelInfo& channel : file.channels) list.push_back({{"name", channel.name}, {"type", channel.type}});
  return list;
}

Json pixels_json(const EnvironmentStatistics& pixels) {
  return {{"texels", pixels.texels},          {"minimum", json_triple(pixels.minimum)},
          {"mean", json_triple(pixels.mean)}, {"maximum", json_triple(pixels.maximum)},
          {"flux", json_triple(pixels.flux)}, {"nans", pixels.nans},
          {"infinities", pixels.infinities},  {"negatives", pixels.negatives}};
}

Json brightest_json(const EnvironmentStatistics& pixels) {
  return {{"column", pixels.brightest_column},
          {"row", pixels.brightest_row},
          {"radiance", json_triple(pixels.brightest)},
          {"direction", json_triple(pixels.brightest_direction)}};
}

}  // namespace

std::string info_json(const InfoReport& report) {
  return json_text({{"source", source_json(report.file)},
                    {"file", storage_json(report.file)},
                    {"channels", channels_json(report.file)},
                    {"pixels", pixels_json(report.pixels)},
                    {"brightest", brightest_json(report.pixels)}});
}

}  // namespace welkin::tool
