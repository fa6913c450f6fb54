// Grids of probes from files of captures, to files with a description, and back; and files that are not what they say.
#include <nlohmann/json.hpp>

#include "probes/probe_captures.h"
#include "support/catch.h"
#include "support/same_bits.h"
#include "support/temporary_directory.h"
#include "support/thrown_error.h"
#include "welkin/bake_file.h"

namespace welkin::test {
namespace {

float distance(std::size_t probe, const dvec3& d) {
  if (d.y > 0.6) return kNothing;
  return static_cast<float>((probe % 4 == 1 ? -1.0 : 1.0) * (1.0 + 0.1 * static_cast<double>(probe) + d.x * d.x));
}

Captures made_up(std::size_t count) {
  return {count, 4,
          [](std::size_t probe, const dvec3& d) {
            return dvec3(2.0 + d.y, 1.0 + 0.01 * static_cast<double>(probe), 1.0 - d.x);
          },
          6, distance};
}

}  // namespace

TEST_CASE("probe files: captures in files give the bits of captures in memory", "[probes][files]") {
  const TemporaryDirectory folder;
  const ProbeGrid grid{.counts = {13, 5, 3}, .spacing = {2, 0.75, 3}};  // more than are read at once
  const Captures captures = made_up(grid.size());
  std::vector<FileInput> cubes;
  std::vector<FileInput> depths;
  for (std::size_t k = 0; k < grid.size(); ++k) {
    const std::filesystem::path cube = folder.path() / ("cube" + std::to_string(k) + (k % 2 == 0 ? ".ktx2" : ".dds"));
    write_texture(cube, {&captures.cubes[k], 1}, {.format = TexelFormat::rgba32f});
    std::vector<float> rgb;
    for (const float each : captures.distances[k]) rgb.insert(rgb.end(), 3, each);
    const Cubemap grey(6, rgb);
    const std::filesystem::path depth = folder.path() / ("depth" + std::to_string(k) + ".ktx2");
    const CubemapView view = grey.view();
    write_texture(depth, {&view, 1}, {.format = TexelFormat::rgba32f});
    cubes.emplace_back(cube);
    depths.emplace_back(depth);
  }
  const ProbeOptions options{.projection = {.bands = 4}, .environment_bands = 2};
  const BakedProbes wanted = bake_probes(grid, captures.cubes, captures.depths, options);
  for (const int threads : {1, 3}) {
    BakedProbes found;
    run_with_threads(threads, [&] { found = bake_probe_files(grid, cubes, depths, options); });
    CHECK(found.grid == grid);
    CHECK(same_bytes<dvec3>(wanted.coefficients, found.coefficients));
    CHECK(same_bytes<float>(wanted.validity, found.validity));
    CHECK(same_bytes<float>(wanted.distances, found.distances));
    CHECK(same_bytes<double>(wanted.sky, found.sky));
    CHECK(wanted.passes == found.passes);
    CHECK(wanted.invalid == found.invalid);
    CHECK(found.diagnostics.texels == wanted.diagnostics.texels);
  }

  // Halves hold distances to three digits: they are refused.
  const std::filesystem::path half = folder.path() / "half.ktx2";
  write_texture(half, {&captures.cubes[0], 1});
  depths[140] = FileInput(half);
  check_thrown([&] { static_cast<void>(bake_probe_files(grid, cubes, depths)); }, ErrorCode::unsupported_file,
               {"half.ktx2"});
  cubes.pop_back();
  CHECK(thrown_by([&] { static_cast<void>(bake_probe_files(grid, cubes)); }).says("for 195 probes"));
  // Errors that do not depend on the files are reported before one is read.
  const std::vector<FileInput> nowhere(grid.size(), FileInput(folder.path() / "nowhere.ktx2"));
  CHECK(thrown_by([&] {
          static_cast<void>(bake_probe_files(grid, nowhere, {}, {.dilation_passes = 5000}));
        }).says("dilation"));
  ProbeGrid far = grid;
  far.origin.x = 1e16;
  CHECK(thrown_by([&] { static_cast<void>(bake_probe_files(far, nowhere)); }).says("origin"));
}

TEST_CASE("probe files: the description says where every number lies", "[probes][files]") {
  const TemporaryDirectory folder;
  const ProbeGrid grid{.counts = {5, 1, 3}, .origin = {0.1, -2, 3}, .spacing = {1, 2, 0.7}};
  const Captures captures = made_up(grid.size());
  const BakedProbes probes =
      bake_probes(grid, captures.cubes, captures.depths, {.distance_size = 3, .environment_bands = 2});
  const std::vector<ProbeLayout> layouts{ProbeLayout::three, ProbeLayout::unity_l2, ProbeLayout::unity_l1,
                                         ProbeLayout::plain};
  const WriteReport report = write_probes(folder.path() / "level.json", probes, layouts);
  CHECK(report.files.size() == 1 + 1 + 2 + 7 + 3 + 1);
  CHECK(report.values_clamped == 0);
  const std::string text = read_text(folder.path() / "level.json");
  const nlohmann::json description = nlohmann::json::parse(text);
  CHECK(description["format"] == "welkin probes");
  CHECK(description["grid"]["counts"] == nlohmann::json({5, 1, 3}));
  CHECK(description["grid"]["origin"][0].get<double>() == 0.1);
  CHECK(description["grid"]["spacing"][2].get<double>() == 0.7);
  CHECK(description["bands"] == 3);
  CHECK(description["sky_bands"] == 4);
  CHECK(description["distance_size"] == 3);
  CHECK(description["distance_limit"].get<double>() == probes.distance_limit);
  CHECK(description["invalid"].get<std::size_t>() == probes.invalid);

  const std::vector<char> arrays = read_bytes(folder.path() / description["arrays"]["file"].get<std::string>());
  const auto require_array = [&](std::size_t index, const char* name, const nlohmann::json& shape, const void* values,
                                 std::size_t bytes) {
    const nlohmann::json& entry = description["arrays"]["entries"][index];
    CAPTURE(name);
    CHECK(entry["name"] == name);
    CHECK(entry["shape"] == shape);
    REQUIRE(entry["bytes"] == bytes);
    const auto offset = entry["offset"].get<std::size_t>();
    CHECK(offset % 8 == 0);
    REQUIRE(offset + bytes <= arrays.size());
    CHECK(std::memcmp(arrays.data() + offset, values, bytes) == 0);
  };
  require_array(0, "coefficients", {15, 9, 3}, probes.coefficients.data(), 15 * 27 * 8);
  require_array(1, "validity", {15}, probes.validity.data(), 60);
  require_array(2, "passes", {15}, probes.passes.data(), 15);
  require_array(3, "distances", {15, 5, 5, 2}, probes.distances.data(), 15 * 50 * 4);
  require_array(4, "sky", {15, 16}, probes.sky.data(), 15 * 16 * 8);

  REQUIRE(description["layouts"].size() == 4);
  for (std::size_t k = 0; k < 4; ++k) {
    const nlohmann::json& layout = description["layouts"][k];
    const PackedProbes packed = pack_probes(probes, layouts[k]);
    CHECK(layout["layout"] == name(layouts[k]));
    CHECK(layout.contains("bricks") == (k == 1 || k == 2));
    REQUIRE(layout["textures"].size() == packed.textures.size());
    for (std::size_t t = 0; t < packed.textures.size(); ++t) {
      const nlohmann::json& texture = layout["textures"][t];
      CAPTURE(k, t);
      CHECK(texture["name"] == packed.textures[t].name);
      CHECK(texture["size"] == packed.textures[t].size);
      CHECK(texture["format"] == "rgba16f");
      const std::string file = read_text(folder.path() / texture["file"].get<std::string>());
      // KTX 2.0: VK_FORMAT_R16G16B16A16_SFLOAT, width, height, depth, no layers, one face, one level.
      CHECK(number_at(file, 12) == 97);
      for (std::size_t a = 0; a < 3; ++a) {
        CHECK(number_at(file, 20 + 4 * a) == static_cast<std::uint32_t>(packed.textures[t].size[a]));
      }
      CHECK(number_at(file, 32) == 0);
      CHECK(number_at(file, 36) == 1);
      CHECK(number_at(file, 40) == 1);
      const auto offset = number_at<std::uint64_t>(file, 80);
      const auto bytes = packed.textures[t].halves.size() * 2;
      CHECK(number_at<std::uint64_t>(file, 88) == bytes);
      CHECK(offset % 8 == 0);
      REQUIRE(file.size() == offset + bytes);
      CHECK(std::memcmp(file.data() + offset, packed.textures[t].halves.data(), bytes) == 0);
      CHECK(file.find(std::string("KTXorientation\0rdi", 18)) != std::string::npos);
    }
  }
}

TEST_CASE("probe files: nothing is written if something cannot be", "[probes][files]") {
  const TemporaryDirectory folder;
  const Captures captures = made_up(1);
  BakedProbes probes = bake_probes({}, captures.cubes);
  CHECK(thrown_by([&] { write_probes(folder.path() / "level.txt", probes); }).code == ErrorCode::unsupported_file);
  CHECK(thrown_by([&] { write_probes(folder.path() / "nowhere" / "level.json", probes); }).code ==
        ErrorCode::file_access);
  probes.coefficients.pop_back();
  CHECK(thrown_by([&] { write_probes(folder.path() / "level.json", probes); }).says("coefficients has 8"));
  CHECK(std::filesystem::is_empty(folder.path()));
}

namespace {

BakedProbes numbered_probes() {
  BakedProbes probes;
  probes.grid = {.counts = {3, 2, 2}, .origin = {0.1, -2.0, 1e15}, .spacing = {0.3, 1e-9, 1e12}};
  probes.bands = 2;
  probes.distance_size = 2;
  probes.distance_limit = 0.7;
  probes.sky_bands = 3;
  double next = 0.1;
  const auto number = [&] { return next *= -1.37; };
  for (std::size_t k = 0; k < probes.grid.size(); ++k) {
    for (int f = 0; f < 4; ++f) probes.coefficients.emplace_back(number(), number(), number());
    for (int f = 0; f < 32; ++f) probes.distances.push_back(static_cast<float>(k) + 0.1F * static_cast<float>(f));
    for (int f = 0; f < 9; ++f) probes.sky.push_back(1.0 / (1.0 + static_cast<double>(k) + f));
    probes.validity.push_back(1.0F / (1.0F + static_cast<float>(k)));
    probes.passes.push_back(std::array<std::uint8_t, 4>{0, 1, 254, 255}[k % 4]);
    probes.offsets.emplace_back(0.01 * static_cast<double>(k), 0.0, -0.0);
  }
  probes.invalid = 9;
  probes.unfilled = 3;
  return probes;
}

bool same_probes(const BakedProbes& a, const BakedProbes& b) {
  return a.grid == b.grid && a.bands == b.bands && a.distance_size == b.distance_size &&
         a.distance_limit == b.distance_limit && a.sky_bands == b.sky_bands &&
         same_bytes<dvec3>(a.coefficients, b.coefficients) && same_bytes<float>(a.validity, b.validity) &&
         a.passes == b.passes && same_bytes<float>(a.distances, b.distances) && same_bytes<double>(a.sky, b.sky) &&
         same_bytes<dvec3>(a.offsets, b.offsets) && a.invalid == b.invalid && a.unfilled == b.unfilled;
}

}  // namespace

TEST_CASE("read probes: every bit comes back, from the folder and from memory", "[probes][files]") {
  const TemporaryDirectory folder;
  const std::filesystem::path path = folder.path() / "level.json";
  BakedProbes probes = numbered_probes();
  write_probes(path, probes, {{ProbeLayout::plain}});
  CHECK(same_probes(read_probes(path), probes));
  const std::string text = read_text(path);
  const std::string arrays = read_text(folder.path() / "level.bin");
  const FileInput description(std::as_bytes(std::span(text)), "level.json");
  CHECK(same_probes(read_probes(description, FileInput(std::as_bytes(std::span(arrays)), "level.bin")), probes));
  CHECK(thrown_by([&] { static_cast<void>(read_probes(description)); }).says("pass the file of arrays"));
  probes.offsets.clear();
  probes.distance_size = 0;
  probes.distances.clear();
  probes.sky_bands = 0;
  probes.sky.clear();
  write_probes(path, probes);
  CHECK(same_probes(read_probes(path), probes));
}

TEST_CASE("read probes: a description that is not one, or does not fit its arrays, is refused", "[probes][files]") {
  const TemporaryDirectory folder;
  const std::filesystem::path path = folder.path() / "level.json";
  write_probes(path, numbered_probes());
  const nlohmann::json sound = nlohmann::json::parse(read_text(path));
  const auto refused = [&](const std::function<void(nlohmann::json&)>& change, const char* reason,
                           ErrorCode code = ErrorCode::corrupt_file) {
    nlohmann::json changed = sound;
    change(changed);
    write_text(path, changed.dump());
    const ThrownError error = thrown_by([&] { static_cast<void>(read_probes(path)); });
    INFO(error.message);
    return error.code == code && error.says(reason) && error.says("level.");
  };
  const auto entry = [](nlohmann::json& json, std::size_t k) -> nlohmann::json& {
    return json["arrays"]["entries"][k];
  };
  CHECK(refused([](auto& j) { j["format"] = "probes"; }, "no description", ErrorCode::unsupported_file));
  CHECK(refused([](auto& j) { j["version"] = 2; }, "version", ErrorCode::unsupported_file));
  for (const char* key : {"grid", "bands", "distance_size", "distance_limit", "sky_bands", "arrays"}) {
    CHECK(refused([&](auto& j) { j.erase(key); }, key));
    CHECK(refused([&](auto& j) { j[key] = "some"; }, "has"));
  }
  CHECK(refused([](auto& j) { j["grid"]["counts"] = {3, 2}; }, "counts"));
  CHECK(refused([](auto& j) { j["grid"]["counts"] = {3, 2, 0}; }, "grid that cannot be"));
  CHECK(refused([](auto& j) { j["grid"]["counts"] = {3, 2, 1e15}; }, "grid that cannot be"));
  CHECK(refused([](auto& j) { j["grid"]["counts"] = {2048, 2048, 2048}; }, "grid that cannot be"));
  CHECK(refused([](auto& j) { j["grid"]["counts"] = {3, 2, 3}; }, "bytes; the grid and its sizes need"));
  CHECK(refused([](auto& j) { j["grid"]["spacing"][1] = 0; }, "spacing"));
  CHECK(refused([](auto& j) { j["grid"]["origin"][1] = nullptr; }, "origin"));
  CHECK(refused([](auto& j) { j["bands"] = 5; }, "4 at most"));
  CHECK(refused([](auto& j) { j["bands"] = 0; }, "1 to 4"));
  CHECK(refused([](auto& j) { j["bands"] = 1.5; }, "whole number"));
  CHECK(refused([](auto& j) { j["sky_bands"] = -1; }, "whole number"));
  CHECK(refused([](auto& j) { j["arrays"]["byte_order"] = "big"; }, "byte_order"));
  CHECK(refused([](auto& j) { j["arrays"]["entries"] = 7; }, "entries"));
  CHECK(refused([](auto& j) { j["arrays"]["entries"].erase(0); }, "coefficients"));
  CHECK(refused([&](auto& j) { entry(j, 1)["type"] = "float64"; }, "float32"));
  CHECK(refused([&](auto& j) { entry(j, 1)["bytes"] = 47; }, "validity"));
  CHECK(refused([&](auto& j) { entry(j, 1)["offset"] = 1e15; }, "ends before"));
  CHECK(refused([&](auto& j) { entry(j, 5)["bytes"] = 8; }, "offsets"));
  for (const char* elsewhere : {"../level.bin", "/etc/passwd", "..", "", "a/b"}) {
    CHECK(refused([&](auto& j) { j["arrays"]["file"] = elsewhere; }, "another folder"));
  }
  CHECK(refused([](auto& j) { j["arrays"]["file"] = "level.none"; }, "level.none", ErrorCode::file_access));

  for (const std::string& text : {std::string("{"), std::string(), std::string(100000, '['), std::string("7")}) {
    write_text(path, text);
    CHECK(thrown_by([&] { static_cast<void>(read_probes(path)); }).code == ErrorCode::unsupported_file);
  }
  write_text(path, std::string((1U << 20U) + 1, ' '));
  CHECK(thrown_by([&] { static_cast<void>(read_probes(path)); }).code == ErrorCode::limit_exceeded);
  write_text(path, sound.dump());
  const std::string arrays = read_text(folder.path() / "level.bin");
  write_text(folder.path() / "level.bin", arrays.substr(0, arrays.size() - 8));
  CHECK(thrown_by([&] { static_cast<void>(read_probes(path)); }).code == ErrorCode::corrupt_file);
}

}  // namespace welkin::test
