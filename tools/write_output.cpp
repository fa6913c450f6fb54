#include "tools/write_output.h"

#include "tools/number_text.h"
#include "tools/options.h"
#include "tools/printable_text.h"

namespace welkin::tool {
namespace {

constexpr int kLargestWidth = 65536;

std::string size_text(int width, int height) { return std::to_string(width) + " x " + std::to_string(height); }

std::string described(const WriteReport& report, const std::string& what) {
  std::string text;
  for (const auto& file : report.files) text += printable(file.string()) + ": " + what + '\n';
  if (report.values_clamped > 0) {
    text += "note: " + counted(report.values_clamped, "value") + " beyond what the format holds, clamped to it\n";
  }
  return text;
}

}  // namespace

void add_output_options(CLI::App& command, OutputOptions& options) {
  add_choice<Layout>(command, "--layout", options.write.layout, layout_choices(),
                     "How OUT holds the sphere; by default a lat-long stays one, and a cube becomes a vertical strip");
  command
      .add_option("--size", options.size,
                  "Texels along the edge of a cube's face, or the width of a lat-long, which is half as high")
      ->check(CLI::Range(1, kLargestWidth).description(""))
      ->type_name("N");
  add_choice<SampleType>(
      command, "--type", options.write.type,
      {{"half", SampleType::half},
       {"float", SampleType::float32},
       {"8bit", SampleType::uint8},
       {"16bit", SampleType::uint16}},
      "How OUT holds a value: .exr half (default) or float, .pfm float, .png 8bit (default) or 16bit");
}

bool wants_cubemap(const OutputOptions& options, bool have_cubemap) noexcept {
  const Layout layout = options.write.layout;
  return layout == Layout::automatic ? have_cubemap : layout != Layout::lat_long;
}

std::string write_output(const OutputOptions& options, const LatLongView& picture, const Control& control) {
  const WriteReport report = write_environment(options.path, picture, options.write, control);
  return described(report, std::string(name(Layout::lat_long)) + ", " + size_text(picture.width, picture.height));
}

std::string write_output(const OutputOptions& options, const CubemapView& picture, const Control& control) {
  const WriteReport report = write_environment(options.path, picture, options.write, control);
  const Layout layout = options.write.layout == Layout::automatic ? Layout::vertical_strip : options.write.layout;
  const std::string face = size_text(picture.size, picture.size);
  return described(report, layout == Layout::six_files ? "one face of six, " + face
                                                       : std::string(name(layout)) + ", faces of " + face);
}

}  // namespace welkin::tool
