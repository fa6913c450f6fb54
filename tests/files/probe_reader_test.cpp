// Probes read back from files, and files that are not what they say.
#include <nlohmann/json.hpp>

#include "support/catch.h"
#include "support/same_bits.h"
#include "support/temporary_directory.h"
#include "support/thrown_error.h"
#include "welkin/bake_file.h"

namespace welkin::test {
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
