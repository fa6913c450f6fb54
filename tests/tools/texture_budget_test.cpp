// Budgets for the textures of a bake: what is chosen is within them, and its error is the one that a shader would see.
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <glm/geometric.hpp>
#include <nlohmann/json.hpp>
#include <numbers>
#include <string>
#include <vector>

#include "support/test_environments.h"
#include "tools/baked_folder.h"
#include "tools/command.h"
#include "welkin/environment_file.h"
#include "welkin/reflections.h"
#include "welkin/resampling.h"
#include "welkin/texture_file.h"

using namespace welkin;
using namespace welkin::test;

namespace {

constexpr const char* kFew = " --no-previews --brdf 16 --irradiance 8 ";

/// Blocks of light, as a file.
std::filesystem::path picture_in(const TemporaryFolder& folder, const CubemapView& view) {
  std::filesystem::path path = folder.path() / "picture.pfm";
  WriteOptions options;
  options.layout = Layout::vertical_strip;
  write_environment(path, view, options);
  return path;
}

std::uintmax_t bytes_of_textures(const std::filesystem::path& folder) {
  std::uintmax_t bytes = 0;
  for (const auto& entry : std::filesystem::directory_iterator(folder)) {
    const std::string kind = entry.path().extension().string();
    if (kind == ".ktx2" || kind == ".dds" || kind == ".exr" || kind == ".env") bytes += entry.file_size();
  }
  return bytes;
}

/// Rms error of what is read between the chain's mips at a roughness, over the rms of the truth.
double error_at(const CubemapChain& chain, const std::vector<double>& table, double roughness,
                const CubemapView& source) {
  constexpr int width = 32;
  constexpr int height = 16;
  const double level = mip_of_roughness(table, roughness);
  const int below = std::min(static_cast<int>(level), chain.levels() - 1);
  const int above = std::min(below + 1, chain.levels() - 1);
  const auto picture = [&](int mip) {
    return to_lat_long(chain.view(mip), width, height, glm::dmat3(1.0), ResampleFilter::bilinear);
  };
  const LatLongImage near = picture(below);
  const LatLongImage far = picture(above);
  std::vector<dvec3> directions;
  for (int row = 0; row < height; ++row) {
    const double latitude = std::numbers::pi * (0.5 - (row + 0.5) / height);
    for (int column = 0; column < width; ++column) {
      const double longitude = 2.0 * std::numbers::pi * (0.5 - (column + 0.5) / width);
      directions.emplace_back(std::sin(longitude) * std::cos(latitude), std::sin(latitude),
                              std::cos(longitude) * std::cos(latitude));
    }
  }
  const std::vector<dvec3> truth = reference_specular(source, roughness, directions);
  double wrong = 0.0;
  double whole = 0.0;
  for (std::size_t k = 0; k < truth.size(); ++k) {
    const double weight = std::sqrt(1.0 - directions[k].y * directions[k].y);
    for (int c = 0; c < 3; ++c) {
      const std::size_t at = 3 * k + static_cast<std::size_t>(c);
      const double read =
          glm::mix(static_cast<double>(near.pixels[at]), static_cast<double>(far.pixels[at]), level - below);
      wrong += weight * (read - truth[k][c]) * (read - truth[k][c]);
      whole += weight * truth[k][c] * truth[k][c];
    }
  }
  return std::sqrt(wrong / whole);
}

}  // namespace

TEST_CASE("An error budget takes the fewest bytes that are within it", "[command][budget]") {
  const TemporaryFolder folder;
  const TestCubemap source = make_cubemap(Content::blocks, 64, 3, 7);
  const std::string bake = quoted(picture_in(folder, source.view())) + kFew;
  const nlohmann::json manifest = bake_into(folder.path() / "out", bake + "--error-budget 0.08");
  const nlohmann::json textures = manifest.at("textures");
  INFO(textures.dump(1));
  REQUIRE(textures.at("met") == true);
  const nlohmann::json chosen = textures.at("chosen");
  CHECK(chosen.at("error") <= 0.08);
  CHECK(chosen == textures.at("tried").back());  // the first one by bytes
  REQUIRE(textures.at("tried").size() > 3);
  for (std::size_t k = 0; k + 1 < textures.at("tried").size(); ++k) CHECK(textures.at("tried")[k].at("error") > 0.08);
  CHECK(manifest.at("options").at("size") == chosen.at("size"));
  CHECK(manifest.at("options").at("background_size") == 256);  // as without a budget
  CHECK(file_of(manifest, "specular.ktx2").at("mips") == chosen.at("mips"));
  CHECK(file_of(manifest, "specular.ktx2").at("format") == "KTX2 " + chosen.at("formats").get<std::string>());

  const CubemapTexture written = read_texture(folder.path() / "out" / "specular.ktx2");
  const std::vector<double> table = file_of(manifest, "specular.ktx2").at("roughness").get<std::vector<double>>();
  const double error = error_at(written.cubemap, table, chosen.at("roughness"), source.view());
  CAPTURE(error);
  CHECK(error < 1.25 * chosen.at("error").get<double>());
  CHECK(error > 0.8 * chosen.at("error").get<double>());
}

TEST_CASE("An error budget that nothing meets is a failure that says by how much", "[command][budget]") {
  const TemporaryFolder folder;
  const std::string bake = "bake " + quoted(picture_in(folder, make_cubemap(Content::random, 32, 3, 7).view())) + kFew +
                           "--error-budget 0.0001 -o " + quoted(folder.path() / "no");
  const std::string message = failure(bake, 1);
  INFO(message);
  CHECK(contains(message, "no textures are within --error-budget 0.0001"));
  CHECK(contains(message, "are off by 0."));
  CHECK(contains(message, "or more mips"));
  const CommandResult said = run_welkin(bake + " --explain --plan-only");
  CHECK(said.exit_code == 0);
  CHECK(contains(said.errors, "none is within the budget"));
  CHECK_FALSE(std::filesystem::exists(folder.path() / "no"));
}

TEST_CASE("A budget of bytes holds for what is written", "[command][budget]") {
  const TemporaryFolder folder;
  const std::string picture = quoted(picture_in(folder, make_cubemap(Content::blocks, 64, 3, 7).view()));
  constexpr std::uintmax_t kHeaders = 8 << 10;
  for (const std::string engine : {"", "--for three ", "--for babylon ", "--for filament ", "--for usd "}) {
    for (const std::uintmax_t budget : {100'000, 400'000}) {
      CAPTURE(engine, budget);
      const std::filesystem::path out = folder.path() / "out";
      std::filesystem::remove_all(out);
      const nlohmann::json manifest = bake_into(out, picture + kFew + engine + "--budget " + std::to_string(budget));
      const nlohmann::json textures = manifest.at("textures");
      CHECK(textures.at("met") == true);
      CHECK(textures.at("chosen").at("bytes") <= budget);
      CHECK(bytes_of_textures(out) <= budget + kHeaders);
      for (const auto& tried : textures.at("tried")) CHECK(tried.at("error") >= textures.at("chosen").at("error"));
      const bool reflections = engine != "--for usd ";
      CHECK(textures.at("tried").empty() == !reflections);
      if (!reflections) CHECK(textures.at("chosen").at("background_size") == (budget == 100'000 ? 32 : 64));
    }
  }
}

TEST_CASE("What options name no budget changes, and one that is too small is refused", "[command][budget]") {
  const TemporaryFolder folder;
  const std::string picture = quoted(picture_in(folder, make_cubemap(Content::blocks, 64, 3, 7).view())) + kFew;
  const nlohmann::json named = bake_into(
      folder.path() / "out", picture + "--size 32 --mips 4 --ktx2-format e5b9g9r9 --background-size 16 --budget 1MiB");
  CHECK(named.at("options").at("size") == 32);
  CHECK(named.at("options").at("background_size") == 16);
  CHECK(file_of(named, "specular.ktx2").at("mips") == 4);
  CHECK(file_of(named, "specular.ktx2").at("format") == "KTX2 e5b9g9r9");
  const nlohmann::json engine = bake_into(folder.path() / "bevy", picture + "--for bevy --budget 1MiB");
  CHECK(file_of(engine, "specular.ktx2").at("format") == "KTX2 e5b9g9r9");
  for (const std::string budget : {"0", "100"}) {
    CHECK(contains(failure("bake " + picture + "--budget " + budget + " -o " + quoted(folder.path() / "no"), 2),
                   "too small"));
  }
  CHECK_FALSE(std::filesystem::exists(folder.path() / "no"));
}

TEST_CASE("A small picture may have larger faces than its own, and its choice keeps to the memory limit",
          "[command][budget]") {
  const TemporaryFolder folder;
  const std::string picture = quoted(picture_in(folder, make_cubemap(Content::blocks, 8, 3, 7).view())) + kFew;
  const auto out = [&](const char* name) { return " -o " + quoted(folder.path() / name); };
  const CommandResult free =
      run_welkin("bake " + picture + "--mips 3 --error-budget 0.0001 --plan-only --explain" + out("free"));
  CHECK(contains(free.errors, "  256     3 "));
  // The chain of 512 texels that all are compared with takes 18 MiB by itself.
  CHECK(contains(failure("bake " + picture + "--error-budget 0.0001 --memory-limit 10MiB" + out("none"), 1),
                 "raise --memory-limit"));
  CHECK_FALSE(std::filesystem::exists(folder.path() / "none"));
}
