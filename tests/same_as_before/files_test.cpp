// Promise: written files, and what is read from them, are bit-identical to those on record
// (see projections_test.cpp).
//
// Bytes that zlib or Zstandard packed depend on its version: they are on record in a group with that version's name and
// are not compared under another version. Unpacked data is compared everywhere.
#include "support/catch.h"
#include "support/chains.h"
#include "support/process_threads.h"
#include "support/recorded_results.h"
#include "support/temporary_directory.h"
#include "support/test_environments.h"
#include "welkin/bake_file.h"
#include "welkin/environment_file.h"

namespace welkin::test {
namespace {

/// Returns the version that `const char* function()` of a loaded shared library states, or nullopt if there is no such
/// function.
std::optional<std::string> library_version(const char* function) {
  void* const symbol = loaded_function(function);
  if (symbol == nullptr) return std::nullopt;
  return std::string(reinterpret_cast<const char* (*)()>(symbol)());
}

/// Checks bytes that a library packed against those on record for its version, if there are any.
void require_packed_as_recorded(const char* library, const char* version_function,
                                const std::vector<NamedResult>& results) {
  const std::optional<std::string> version = library_version(version_function);
  if (!version) {
    WARN("the version of " << library << " is not known here: packed bytes are not compared");
    return;
  }
  std::string group = "packed_by_";
  group += library;
  group += '_';
  group += *version;
  if (!is_on_record(group)) {
    WARN("there is no record of bytes that " << library << " " << *version << " packs: they are not compared");
    return;
  }
  require_as_recorded(group, results);
}

/// Returns the bytes of the file that `write(path)` writes.
template <class Write>
std::vector<char> bytes_of(const char* file_name, const Write& write) {
  const TemporaryDirectory folder;
  const auto path = folder.file(file_name);
  write(path);
  return read_bytes(path);
}

/// Returns what `read(path)` reads from the file that `write(path)` writes.
template <class Write, class Read>
auto read_back(const char* file_name, const Write& write, const Read& read) {
  const TemporaryDirectory folder;
  const auto path = folder.file(file_name);
  write(path);
  return read(path);
}

/// Texels from 2^-6 to 2^6.
Cubemap some_cubemap(int size) {
  const Cubemap chain = noisy_chain(size, 1, 6, 3);
  return {size, {chain.face(0, 0), chain.face(0, 0) + 6 * face_values(chain, 0)}};
}

LatLongImage some_lat_long(Content content) { return {50, 25, make_lat_long(content, 50, 25, 62).pixels}; }

std::vector<char> image_bytes(const char* file_name, const LatLongImage& image, const WriteOptions& options = {}) {
  return bytes_of(file_name, [&](const auto& path) { write_environment(path, image.view(), options); });
}

std::vector<char> image_bytes(const char* file_name, const Cubemap& image, const WriteOptions& options = {}) {
  return bytes_of(file_name, [&](const auto& path) { write_environment(path, image.view(), options); });
}

template <class Image>
Environment image_back(const char* file_name, const Image& image, const WriteOptions& options = {},
                       const ReadOptions& read_options = {}) {
  return read_back(
      file_name, [&](const auto& path) { write_environment(path, image.view(), options); },
      [&](const auto& path) { return read_environment(path, read_options); });
}

std::vector<char> texture_bytes(const char* file_name, const Cubemap& chain, const TextureOptions& options) {
  return bytes_of(file_name, [&](const auto& path) { write_texture(path, chain.views(), options); });
}

Cubemap texture_back(const char* file_name, const Cubemap& chain, const TextureOptions& options) {
  return read_back(
      file_name, [&](const auto& path) { write_texture(path, chain.views(), options); },
      [](const auto& path) { return read_texture(path).cubemap; });
}

constexpr std::pair<const char*, TexelFormat> kFormats[] = {{"rgba16f", TexelFormat::rgba16f},
                                                            {"rgba32f", TexelFormat::rgba32f},
                                                            {"b10g11r11", TexelFormat::b10g11r11},
                                                            {"e5b9g9r9", TexelFormat::e5b9g9r9}};

BabylonEnvironment some_environment(int size, bool with_irradiance) {
  SphericalHarmonics radiance(3);
  double value = 1.0;
  for (glm::dvec3& c : radiance.coefficients()) {
    c = {value, -0.5 * value, 0.25};
    value *= 0.75;
  }
  BabylonEnvironment environment = to_babylon(noisy_chain(size, full_chain_levels(size), 5), radiance,
                                              with_irradiance ? some_cubemap(4) : Cubemap{});
  if (with_irradiance) environment.dominant_direction = glm::dvec3(0.6, 0.0, 0.8);
  return environment;
}

std::vector<char> environment_bytes(const BabylonEnvironment& environment) {
  return bytes_of("light.env", [&](const auto& path) { write_babylon_environment(path, environment); });
}

std::uint64_t bits_of_environment(const BabylonEnvironment& environment) {
  return read_back(
      "light.env", [&](const auto& path) { write_babylon_environment(path, environment); },
      [](const auto& path) {
        const BabylonEnvironment e = read_babylon_environment(path);
        return bits_of(e.version, e.specular, e.polynomial, e.lod_generation_scale, e.irradiance, e.dominant_direction);
      });
}

}  // namespace

TEST_CASE("Bytes of images are the same as before", "[same_as_before]") {
  const LatLongImage wide = some_lat_long(Content::high_range);
  const LatLongImage special = some_lat_long(Content::special_values);
  const Cubemap cube = some_cubemap(9);
  require_as_recorded(
      "image_bytes",
      {
          {"hdr_lat_long", [&] { return image_bytes("a.hdr", wide); }},
          {"hdr_special_values", [&] { return image_bytes("a.hdr", special); }},
          {"hdr_vertical_strip", [&] { return image_bytes("a.hdr", cube); }},
          {"hdr_horizontal_cross", [&] { return image_bytes("a.hdr", cube, {.layout = Layout::horizontal_cross}); }},
          {"pfm_lat_long", [&] { return image_bytes("a.pfm", wide); }},
          {"pfm_special_values", [&] { return image_bytes("a.pfm", special); }},
          {"pfm_vertical_strip", [&] { return image_bytes("a.pfm", cube); }},
          {"pfm_horizontal_strip", [&] { return image_bytes("a.pfm", cube, {.layout = Layout::horizontal_strip}); }},
          {"pfm_vertical_cross", [&] { return image_bytes("a.pfm", cube, {.layout = Layout::vertical_cross}); }},
          {"pfm_six_files",
           [&] {
             const TemporaryDirectory folder;
             const WriteReport report =
                 write_environment(folder.file("a.pfm"), cube.view(), {.layout = Layout::six_files});
             BitHash hash;
             for (const auto& file : report.files) {
               add_bits(hash, file.filename().string());
               add_bits(hash, read_bytes(file));
             }
             return hash.value();
           }},
      });
}

TEST_CASE("Images that were written and read are the same as before", "[same_as_before]") {
  const LatLongImage wide = some_lat_long(Content::high_range);
  const LatLongImage dim = some_lat_long(Content::random);
  const LatLongImage special = some_lat_long(Content::special_values);
  const Cubemap cube = some_cubemap(9);
  const auto write_exr = [&](const auto& path) { write_environment(path, wide.view()); };
  const SampleType f32 = SampleType::float32;
  require_as_recorded(
      "image_back",
      {
          {"exr_half", [&] { return image_back("a.exr", wide); }},
          {"exr_float", [&] { return image_back("a.exr", wide, {.type = f32}); }},
          {"exr_special_values", [&] { return image_back("a.exr", special, {.type = f32}); }},
          {"exr_cubemap", [&] { return image_back("a.exr", cube); }},
          {"exr_cross", [&] { return image_back("a.exr", cube, {.layout = Layout::vertical_cross, .type = f32}); }},
          {"hdr", [&] { return image_back("a.hdr", wide); }},
          {"hdr_strip", [&] { return image_back("a.hdr", cube, {.layout = Layout::horizontal_strip}); }},
          {"pfm", [&] { return image_back("a.pfm", special); }},
          {"png_8", [&] { return image_back("a.png", dim); }},
          {"png_16", [&] { return image_back("a.png", dim, {.type = SampleType::uint16}); }},
          {"png_linear", [&] { return image_back("a.png", dim, {}, {.transfer = Transfer::linear}); }},
          {"exr_projected",
           [&] { return read_back("a.exr", write_exr, [](const auto& path) { return project_file(path); }); }},
          {"exr_projected_at_target",
           [&] {
             return read_back("a.exr", write_exr,
                              [](const auto& path) { return project_file(path, {}, {.bands = 5, .target_size = 6}); });
           }},
          {"exr_measured",
           [&] { return read_back("a.exr", write_exr, [](const auto& path) { return measure_environment(path); }); }},
          {"pfm_measured",
           [&] {
             return read_back(
                 "a.pfm", [&](const auto& path) { write_environment(path, special.view()); },
                 [](const auto& path) { return measure_environment(path); });
           }},
          {"png_projected",
           [&] {
             return read_back(
                 "a.png", [&](const auto& path) { write_environment(path, dim.view()); },
                 [](const auto& path) { return project_file(path); });
           }},
      });
}

TEST_CASE("Bytes and texels of textures are the same as before", "[same_as_before]") {
  const Cubemap chain = noisy_chain(16, 5);
  const Cubemap odd = noisy_chain(13, 2, 20, 5);
  const Cubemap square = some_cubemap(5);
  std::vector<NamedResult> results;
  for (const auto& [format_name, format] : kFormats) {
    for (const auto& [file_name, kind] : {std::pair{"a.ktx2", "ktx2_"}, std::pair{"a.dds", "dds_"}}) {
      results.emplace_back(joined(kind, format_name), [&chain, file_name = file_name, format = format] {
        return texture_bytes(file_name, chain, {.format = format});
      });
      results.emplace_back(joined(kind, format_name, "_odd"), [&odd, file_name = file_name, format = format] {
        return texture_bytes(file_name, odd, {.format = format});
      });
      results.emplace_back(joined(kind, format_name, "_odd_back"), [&odd, file_name = file_name, format = format] {
        return texture_back(file_name, odd, {.format = format});
      });
    }
    for (const auto& [packing, method] :
         {std::pair{"ktx2_zlib_back_", Supercompression::zlib}, std::pair{"ktx2_zstd_back_", Supercompression::zstd}}) {
      results.emplace_back(joined(packing, format_name), [&chain, format = format, method = method] {
        return texture_back("a.ktx2", chain, {.format = format, .supercompression = method});
      });
    }
  }
  for (const auto& [name, format] :
       {std::pair{"exr_half_back", TexelFormat::rgba16f}, std::pair{"exr_float_back", TexelFormat::rgba32f}}) {
    results.emplace_back(name, [&chain, format = format] {
      return read_back(
          "a.exr", [&](const auto& path) { write_texture(path, chain.views(), {.format = format}); },
          [](const auto& path) { return bits_of(read_environment(path), read_environment(path, {.level = 1})); });
    });
  }
  for (const auto& [name, options] :
       {std::pair{"bc6h_fast", Bc6hOptions{Bc6hEffort::fast}}, std::pair{"bc6h_normal", Bc6hOptions{}},
        std::pair{"bc6h_slow", Bc6hOptions{Bc6hEffort::slow}},
        std::pair{"bc6h_signed", Bc6hOptions{Bc6hEffort::normal, true}}}) {
    for (const auto& [file_name, kind] : {std::pair{"a.ktx2", "_ktx2"}, std::pair{"a.dds", "_dds"}}) {
      TextureOptions texture{.format = options.is_signed ? TexelFormat::bc6h_sfloat : TexelFormat::bc6h_ufloat,
                             .bc6h_effort = options.effort};
      results.emplace_back(std::string(name) + kind, [&chain, file_name = file_name, texture] {
        return texture_bytes(file_name, chain, texture);
      });
      results.emplace_back(std::string(name) + kind + "_odd_back",
                           [&odd, file_name = file_name, texture] { return texture_back(file_name, odd, texture); });
    }
  }
  for (const auto& [name, effort] :
       {std::pair{"uastc_fast", Bc6hEffort::fast}, std::pair{"uastc_normal", Bc6hEffort::normal},
        std::pair{"uastc_slow", Bc6hEffort::slow}}) {
    const TextureOptions texture{.format = TexelFormat::uastc_hdr_4x4, .bc6h_effort = effort};
    results.emplace_back(name, [&chain, texture] { return texture_bytes("a.ktx2", chain, texture); });
    results.emplace_back(std::string(name) + "_odd", [&odd, texture] { return texture_bytes("a.ktx2", odd, texture); });
  }
  results.emplace_back("ktx2_with_metadata", [&] {
    return texture_bytes("a.ktx2", chain, {.metadata = {{"welkin.roughness", "0 0.25 0.5 0.75 1"}, {"b", "c"}}});
  });
  for (const char* file_name : {"table.ktx2", "table.dds"}) {
    results.emplace_back(joined("two_dimensional_", file_name), [&square, file_name] {
      return bytes_of(file_name, [&](const auto& path) { write_texture_2d(path, 25, 6, square.face(0)); });
    });
  }
  require_as_recorded("texture", results);
}

TEST_CASE("Environments of Babylon.js are the same as before", "[same_as_before]") {
  const BabylonEnvironment plain = some_environment(16, false);
  const BabylonEnvironment full = some_environment(8, true);
  const auto write_plain = [&](const auto& path) { write_babylon_environment(path, plain); };
  require_as_recorded(
      "env",
      {
          {"back", [&] { return bits_of_environment(plain); }},
          {"back_with_irradiance", [&] { return bits_of_environment(full); }},
          {"read_as_cubemap",
           [&] { return read_back("a.env", write_plain, [](const auto& path) { return read_environment(path); }); }},
          {"projected",
           [&] { return read_back("a.env", write_plain, [](const auto& path) { return project_file(path); }); }},
          {"probed",
           [&] {
             return read_back("a.env", write_plain, [](const auto& path) {
               const StoredEnvironment stored = inspect_stored_environment(path);
               return bits_of(stored.shape.columns, stored.levels, stored.has_polynomial, stored.roughness);
             });
           }},
      });
}

TEST_CASE("Packed bytes are the same as before, with the same compressors", "[same_as_before]") {
  const LatLongImage dim = some_lat_long(Content::random);
  const Cubemap chain = noisy_chain(16, 5);
  const BabylonEnvironment plain = some_environment(16, false);
  const BabylonEnvironment full = some_environment(8, true);
  const auto ktx2 = [&chain](Supercompression method) {
    return [&chain, method] { return texture_bytes("a.ktx2", chain, {.supercompression = method}); };
  };
  require_packed_as_recorded("zlib", "zlibVersion",
                             {
                                 {"env", [&] { return environment_bytes(plain); }},
                                 {"env_with_irradiance", [&] { return environment_bytes(full); }},
                                 {"ktx2", ktx2(Supercompression::zlib)},
                                 {"png_8", [&] { return image_bytes("a.png", dim); }},
                                 {"png_16", [&] { return image_bytes("a.png", dim, {.type = SampleType::uint16}); }},
                             });
  require_packed_as_recorded("zstd", "ZSTD_versionString", {{"ktx2", ktx2(Supercompression::zstd)}});
}

}  // namespace welkin::test
