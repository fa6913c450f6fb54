#include "tools/bake_inputs.h"

#include <filesystem>
#include <system_error>

#include "tools/brdf_files.h"
#include "tools/output_folder.h"
#include "welkin/cubemap_chain.h"
#include "welkin/error.h"

namespace welkin::tool {
namespace {

/// A file with all mips, or where the container has none, a file a mip.
void add_cubemap(std::vector<std::string>& names, const std::string& cubemap, int mips, Container container) {
  const bool strips = container == Container::hdr || container == Container::pfm;
  for (int mip = 0; mip < (strips ? mips : 1); ++mip) {
    const std::string number = strips && mips > 1 ? "_m" + std::to_string(mip) : "";
    names.push_back(cubemap + number + '.' + name(container));
  }
}

std::vector<std::filesystem::path> input_files(const BakeCommandOptions& options) {
  const EnvironmentInfo info = inspect_environment(*options.input, options.common.read);
  if (info.layout == Layout::six_files) return {info.faces.begin(), info.faces.end()};
  return {*options.input};
}

}  // namespace

std::vector<std::string> names_to_write(const BakeCommandOptions& options, const BakeOptions& bake) {
  const int background = bake.background_size > 0 ? bake.background_size : bake.specular->size;
  std::vector<std::string> names = {kManifestName};
  for (const Container container : options.containers) {
    const bool textures = container == Container::ktx2 || container == Container::dds;
    if (!textures) names.push_back(std::string("environment.") + name(container));
    if (container == Container::env) continue;
    add_cubemap(names, "background", full_chain_levels(background), container);
    add_cubemap(names, "specular", bake.specular->mips, container);
    if (bake.irradiance_size > 0) add_cubemap(names, "irradiance", 1, container);
  }
  if (bake.brdf) {
    for (const std::string& table : brdf_names(options)) names.push_back(table);
  }
  if (options.bake.bands > 0) names.insert(names.end(), {"sh.json", "sh.h"});
  if (options.previews) {
    names.insert(names.end(), {"preview_environment.png", "preview_spheres.png", "preview_mips.png"});
  }
  return names;
}

void check_input_is_kept(const BakeCommandOptions& options, const BakeOptions& bake) {
  std::error_code none;
  const std::filesystem::path folder = options.directory;
  if (!options.input || !std::filesystem::exists(folder, none)) return;
  const std::vector<std::string> names = names_to_write(options, bake);
  for (const std::filesystem::path& input : input_files(options)) {
    for (const std::string& name : names) {
      if (!std::filesystem::equivalent(input, folder / name, none)) continue;
      throw Error(ErrorCode::file_access, input.string() + ": is read, and this bake would write over it as " + name +
                                              "; pass another folder to -o, or move the input");
    }
  }
}

}  // namespace welkin::tool
