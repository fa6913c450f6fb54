#include "tools/bake_options.h"

#include <array>
#include <cmath>

#include "tools/cache_option.h"
#include "tools/number_text.h"
#include "welkin/error.h"

namespace welkin::tool {
namespace {

constexpr int kLargestFace = 8192;
constexpr int kLargestIrradiance = 4096;
constexpr int kLargestTable = 4096;
constexpr int kMostMips = 14;  // of the largest face
constexpr int kMostSamples = 1 << 20;

constexpr std::array<Container, 6> kContainers = {Container::ktx2, Container::dds, Container::exr,
                                                  Container::hdr,  Container::pfm, Container::env};

CLI::Option* add_size(CLI::App& command, const char* option, int& size, int least, int largest,
                      const std::string& text) {
  return command.add_option(option, size, text)->check(CLI::Range(least, largest).description(""))->type_name("N");
}

/// Down to 16 texels an edge, as Filament has it: rough balls lit by fewer show them.
int default_mips(int size) {
  constexpr int kLeast = 16;
  int mips = 1;
  while (size >> mips >= kLeast) ++mips;
  return mips;
}

/// "linear", "filament", "babylon", or numbers with commas between them.
RoughnessChoice roughness_choice(const std::vector<std::string>& words) {
  RoughnessChoice choice;
  if (words.size() == 1) {
    for (const auto schedule : {RoughnessSchedule::linear, RoughnessSchedule::filament, RoughnessSchedule::babylon}) {
      choice.schedule = schedule;
      if (words.front() == name(schedule)) return choice;
    }
  }
  for (const std::string& word : words) {
    double value = 0.0;
    if (!CLI::detail::lexical_cast(word, value) || !(value >= 0.0 && value <= 1.0)) {
      throw CLI::ValidationError("--roughness", word +
                                                    " is neither linear, filament or babylon nor a number from 0 to 1; "
                                                    "of numbers give one a mip, such as 0,0.25,0.5,1");
    }
    if (!choice.table.empty() && value < choice.table.back()) {
      throw CLI::ValidationError("--roughness", "falls from " + significant(choice.table.back()) + " to " +
                                                    significant(value) + "; roughness must rise from mip to mip");
    }
    choice.table.push_back(value);
  }
  return choice;
}

void choose_mips(const std::string& word, BakeCommandOptions& options) {
  int mips = 0;
  options.all_mips = word == "all";
  if (options.all_mips) return;
  if (!CLI::detail::lexical_cast(word, mips) || mips < 1 || mips > kMostMips) {
    throw CLI::ValidationError("--mips",
                               word + " is neither a number from 1 to " + std::to_string(kMostMips) + " nor all");
  }
  options.specular.mips = mips;
}

void add_container_options(CLI::App& command, BakeCommandOptions& options) {
  std::vector<std::string> words;
  words.reserve(kContainers.size());
  for (const Container container : kContainers) words.emplace_back(name(container));
  const auto store = [&options](const std::vector<std::string>& chosen) {
    options.containers.clear();
    for (const Container container : kContainers) {
      for (const std::string& word : chosen) {
        if (word == name(container)) options.containers.insert(container);
      }
    }
  };
  command
      .add_option_function<std::vector<std::string>>(
          "--formats", store,
          "Which files to write the cubemaps as, with commas between them: ktx2, dds, exr, hdr, pfm, env; "
          "default ktx2,env")
      ->delimiter(',')
      ->allow_extra_args(false)
      ->check(CLI::IsMember(words).description(""))
      ->type_name("LIST");
  add_choice<TexelFormat>(command, "--ktx2-format", options.texture.format,
                          {{"rgba16f", TexelFormat::rgba16f},
                           {"rgba32f", TexelFormat::rgba32f},
                           {"b10g11r11", TexelFormat::b10g11r11},
                           {"e5b9g9r9", TexelFormat::e5b9g9r9}},
                          "How a .ktx2 holds a texel: 8 bytes (default), 16, 4, 4. DDS and OpenEXR hold halves, "
                          "but with rgba32f floats");
  add_choice<Supercompression>(
      command, "--supercompression", options.texture.supercompression,
      {{"none", Supercompression::none}, {"zlib", Supercompression::zlib}, {"zstd", Supercompression::zstd}},
      "How a .ktx2 is compressed; default none");
  command.add_flag_callback(
      "--no-previews", [&options] { options.previews = false; }, "No pictures for people");
}

void add_specular_options(CLI::App& command, BakeCommandOptions& options) {
  add_size(command, "--size", options.specular.size, 1, kLargestFace,
           "Texels along an edge of the specular cubemap's faces; default " + std::to_string(options.specular.size));
  add_size(command, "--background-size", options.bake.background_size, 0, kLargestFace,
           "The same of the background, which is not blurred; 0: as --size; default " +
               std::to_string(options.bake.background_size));
  command
      .add_option_function<std::string>(
          "--mips", [&options](const std::string& word) { choose_mips(word, options); },
          std::string("Mips of the specular cubemap, 1 to 14, or all: down to 1 texel. Default: as many as --roughness "
                      "has numbers, else ") +
              (options.all_mips ? "all" : "down to 16 texels, where roughness 1 needs no more"))
      ->type_name("N|all");
  command
      .add_option_function<std::vector<std::string>>(
          "--roughness",
          [&options](const std::vector<std::string>& words) { options.roughness = roughness_choice(words); },
          "Roughness of each mip: filament (default; as three.js too), linear, babylon, or the numbers themselves, "
          "with "
          "commas between them")
      ->delimiter(',')
      ->allow_extra_args(false)
      ->type_name("filament|linear|babylon|LIST");
  add_choice<PrefilterMethod>(
      command, "--method", options.specular.method,
      {{"automatic", PrefilterMethod::automatic},
       {"spectral", PrefilterMethod::spectral},
       {"sampled", PrefilterMethod::sampled},
       {"reference", PrefilterMethod::reference}},
      "How to prefilter: automatic (default: what is fastest within the error bounds), spectral, "
      "sampled (as most tools do), reference (the integral itself; slow)");
  command.add_option("--samples", options.specular.samples, "Directions a texel of the sampled method; default 1024")
      ->check(CLI::Range(1, kMostSamples).description(""))
      ->type_name("N");
}

void add_diffuse_options(CLI::App& command, BakeCommandOptions& options) {
  add_size(command, "--irradiance", options.bake.irradiance_size, 0, kLargestIrradiance,
           "Texels along an edge of the irradiance cubemap's faces; default 64; 0: none");
  add_choice<IrradianceMethod>(command, "--irradiance-method", options.bake.irradiance_method,
                               {{"harmonics", IrradianceMethod::harmonics}, {"direct", IrradianceMethod::direct}},
                               "From the spherical harmonics (default), or by direct integration: exact, and slow");
  CLI::Option* none = command.add_flag("--no-brdf", options.no_brdf, "No BRDF table");
  command
      .add_option_function<int>(
          "--brdf", [&options](int size) { options.brdf.width = options.brdf.height = size; },
          "Texels along an edge of the BRDF table; default 64")
      ->check(CLI::Range(1, kLargestTable).description(""))
      ->type_name("N")
      ->excludes(none);
  add_choice<BrdfModel>(
      command, "--brdf-model", options.brdf.model,
      {{"split-sum", BrdfModel::split_sum}, {"multiple-scattering", BrdfModel::multiple_scattering}},
      "What the table holds: (scale, bias) of f0 (default), or Filament's DFG with multiple scattering")
      ->excludes(none);
}

}  // namespace

const char* name(Container container) noexcept {
  switch (container) {
    case Container::ktx2: return "ktx2";
    case Container::dds: return "dds";
    case Container::exr: return "exr";
    case Container::hdr: return "hdr";
    case Container::pfm: return "pfm";
    case Container::env: break;
  }
  return "env";
}

std::string RoughnessChoice::words() const {
  if (table.empty()) return welkin::name(schedule);
  std::string text;
  for (const double value : table) text += (text.empty() ? "" : ",") + significant(value);
  return text;
}

void add_result_options(CLI::App& command, BakeCommandOptions& options) {
  add_specular_options(command, options);
  add_diffuse_options(command, options);
  add_container_options(command, options);
}

void add_bake_options(CLI::App& command, BakeCommandOptions& options) {
  CLI::Option* input =
      command
          .add_option("INPUT", options.input,
                      "An OpenEXR, Radiance .hdr, PFM or PNG file, or one of six (or their directory); without it, a "
                      "built-in sky")
          ->type_name("");
  command.add_option("-o,--output", options.directory, "The folder to write to; it is made if it is not there")
      ->required()
      ->type_name("DIR");
  add_json_option(command, options.common);
  add_result_options(command, options);
  add_size(command, "--bands", options.bake.bands, 0, kMaximumBands,
           "Bands of spherical harmonics; default 3; 0: none, and no files of them");
  add_needs_options(command, options.scene);
  add_turn_options(command, options.turn);
  add_pixel_options(command, options.bake.pixels, options.clamp);
  // The sun is looked for in radiance, before pixels are decoded.
  add_sun_options(command, options.sun)->excludes(command.get_option("--gamma"));
  add_read_options(command, options.common, input);
  command.get_option("--memory-limit")->remove_needs(input);  // a bake of the built-in sky takes memory too
  add_threads_option(command, options.common);
  add_cache_option(command, options.common);
}

BakeOptions library_options(const BakeCommandOptions& options) {
  BakeOptions bake = options.bake;
  PrefilterOptions specular = options.specular;
  const RoughnessChoice& roughness = options.roughness;
  const auto numbers = static_cast<int>(roughness.table.size());
  if (options.all_mips) specular.mips = full_chain_levels(specular.size);
  if (numbers > 0 && specular.mips > 0 && specular.mips != numbers) {
    throw Error(ErrorCode::invalid_argument, "--mips asks for " + std::to_string(specular.mips) +
                                                 ", and --roughness has numbers for " + std::to_string(numbers) +
                                                 "; leave --mips out");
  }
  if (specular.mips == 0) specular.mips = numbers > 0 ? numbers : default_mips(specular.size);
  if (specular.mips > full_chain_levels(specular.size)) {
    throw Error(ErrorCode::invalid_argument,
                "a cubemap of " + std::to_string(specular.size) + " texels has at most " +
                    counted(static_cast<std::uint64_t>(full_chain_levels(specular.size)), "mip") + ", not " +
                    std::to_string(specular.mips));
  }
  specular.roughness =
      numbers > 0 ? roughness.table : roughness_of_mips(roughness.schedule, specular.mips, specular.size);
  options.clamp.apply(bake.pixels);
  specular.pixels = bake.pixels;
  bake.specular = specular;
  bake.brdf = options.no_brdf ? std::nullopt : std::optional(options.brdf);
  // The .env wants its polynomial; the files of harmonics look at what was asked for.
  if (bake.bands == 0 && options.containers.contains(Container::env)) bake.bands = 3;
  bake.memory_limit_bytes = options.common.read.memory_limit_bytes;
  return bake;
}

int env_size(int specular_size) noexcept {
  int size = 1;
  while (2 * size <= specular_size) size *= 2;
  return size;
}

}  // namespace welkin::tool
