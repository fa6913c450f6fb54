// Checks a Welkin that was built without codecs: refusing FOLDER. Writes and reads small files in the folder; every
// file of a kind whose codec is absent must be refused with an error that names the switch, and others must work.
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "welkin/bake_file.h"
#include "welkin/environment_file.h"
#include "welkin/welkin.h"
#include "welkin/worker.h"

namespace {

using Path = std::filesystem::path;

int failures = 0;

void fail(const std::string& what) {
  std::fprintf(stderr, "refusing: %s\n", what.c_str());
  ++failures;
}

/// `work` must throw an error of unsupported_file whose message holds the name of the file and that of the switch.
void refused(const Path& path, const char* option, const std::function<void()>& work) {
  const std::string name = path.filename().string();
  try {
    work();
  } catch (const welkin::Error& error) {
    const std::string message = error.what();
    std::printf("%s\n", message.c_str());
    const bool says_why = message.find("built without") != std::string::npos &&
                          message.find(std::string(option) + "=ON") != std::string::npos &&
                          message.find(name) != std::string::npos;
    if (error.code() != welkin::ErrorCode::unsupported_file || !says_why) fail(name + " is refused in other words");
    return;
  }
  fail(name + " is not refused");
}

void works(const char* what, const std::function<void()>& work) {
  try {
    work();
  } catch (const std::exception& error) {
    fail(std::string(what) + ": " + error.what());
  }
}

void put(const Path& path, const std::string& bytes) { std::ofstream(path, std::ios::binary) << bytes; }

std::string bytes_of(const Path& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

/// Writes an .env of one texel per face whose images begin as `image` does.
void put_env(const Path& path, const std::string& image) {
  const std::string entry = "{\"position\":0,\"length\":" + std::to_string(image.size()) + "}";
  std::string entries = entry;
  for (int face = 1; face < 6; ++face) entries += "," + entry;
  std::string env("\x86\x16\x87\x96\xf6\xd6\x96\x36");
  env += "{\"version\":2,\"width\":1,\"specular\":{\"mipmaps\":[" + entries + "]}}";
  env += '\0';
  put(path, env + image);
}

void images(const Path& folder) {
  const welkin::LatLongImage image{8, 4, std::vector<float>(std::size_t{8} * 4 * 3, 0.5F)};
  works("a Radiance file", [&] {
    welkin::write_environment(folder / "even.hdr", image.view());
    if (welkin::project_file(folder / "even.hdr").diagnostics.texels != 32) fail("even.hdr has other texels");
  });
  works("a PFM", [&] {
    welkin::write_environment(folder / "even.pfm", image.view());
    (void)welkin::read_environment(folder / "even.pfm");
  });
  const Path exr = folder / "even.exr";
  refused(exr, "WELKIN_EXR", [&] { welkin::check_write_options(exr, {}, false); });
  refused(exr, "WELKIN_EXR", [&] { welkin::write_environment(exr, image.view()); });
  put(exr, std::string("\x76\x2f\x31\x01\x02\0\0\0", 8));
  refused(exr, "WELKIN_EXR", [&] { (void)welkin::inspect_environment(exr); });
  refused(exr, "WELKIN_EXR", [&] { (void)welkin::project_file(exr); });
  const Path png = folder / "even.png";
  refused(png, "WELKIN_PNG", [&] { welkin::write_environment(png, image.view()); });
  put(png, "\x89PNG\r\n\x1a\n");
  refused(png, "WELKIN_PNG", [&] { (void)welkin::read_environment(png); });
  const Path jpeg = folder / "even.jpg";
  put(jpeg, "\xff\xd8\xff\xe0");
  refused(jpeg, "WELKIN_JPEG", [&] { (void)welkin::read_environment(jpeg); });

  welkin::Worker worker;
  refused(exr, "WELKIN_EXR", [&] { (void)worker.post(welkin::ProjectFile{exr}).get(); });
  welkin_projection projection;
  WELKIN_INIT(projection);
  const auto status = welkin_project_file(png.c_str(), nullptr, nullptr, nullptr, &projection);
  if (status != WELKIN_UNSUPPORTED_FILE ||
      std::string(welkin_last_error()).find("WELKIN_PNG=ON") == std::string::npos) {
    fail("the C interface tells otherwise of a PNG");
  }
}

void textures(const Path& folder) {
  const welkin::Cubemap cube{2, std::vector<float>(std::size_t{6} * 2 * 2 * 3, 0.5F)};
  const std::vector<welkin::CubemapView> mips{cube.view()};
  works("KTX2 and DDS", [&] {
    for (const char* name : {"even.ktx2", "even.dds"}) {
      welkin::write_texture(folder / name, mips);
      if (welkin::read_texture(folder / name).cubemap.size() != 2) fail("a texture has another size");
    }
  });
  const Path exr = folder / "chain.exr";
  refused(exr, "WELKIN_EXR", [&] { welkin::write_texture(exr, mips); });
  struct Packing {
    welkin::Supercompression kind;
    char scheme;  ///< KTX2's number of it
    const char* option;
  };
  constexpr std::size_t place_of_scheme = 44;
  for (const Packing& packing : {Packing{welkin::Supercompression::zstd, 2, "WELKIN_ZSTD"},
                                 Packing{welkin::Supercompression::zlib, 3, "WELKIN_ZLIB"}}) {
    const Path path = folder / (std::string(packing.option) + ".ktx2");
    welkin::TextureOptions options{.supercompression = packing.kind};
    refused(path, packing.option, [&] { welkin::write_texture(path, mips, options); });
    const std::vector<float> table(3, 1.0F);
    refused(path, packing.option, [&] { welkin::write_texture_2d(path, 1, 1, table.data(), options); });
    if (std::filesystem::exists(path)) fail(path.string() + " was begun");
    std::string packed = bytes_of(folder / "even.ktx2");
    packed.at(place_of_scheme) = packing.scheme;
    put(path, packed);
    refused(path, packing.option, [&] { (void)welkin::read_texture(path); });
    refused(path, packing.option, [&] { (void)welkin::read_environment(path); });
  }
}

/// Blocks of ASTC, in a file whose header says so.
void blocks(const Path& folder) {
  const welkin::Cubemap cube{4, std::vector<float>(std::size_t{6} * 4 * 4 * 3, 0.5F)};
  const std::vector<welkin::CubemapView> mips{cube.view()};
  const Path path = folder / "astc.ktx2";
  const welkin::TextureOptions options{.format = welkin::TexelFormat::astc_4x4_hdr};
  refused(path, "WELKIN_ASTC", [&] { welkin::write_texture(path, mips, options); });
  if (std::filesystem::exists(path)) fail("astc.ktx2 was begun");
  works("BC6H", [&] { welkin::write_texture(path, mips, {.format = welkin::TexelFormat::bc6h_ufloat}); });
  constexpr std::size_t place_of_format = 12;
  std::string bytes = bytes_of(path);
  bytes.replace(place_of_format, 4, "\xd0\xcb\x9b\x3b");  // 1000066000
  put(path, bytes);
  refused(path, "WELKIN_ASTC", [&] { (void)welkin::read_texture(path); });
  refused(path, "WELKIN_ASTC", [&] { (void)welkin::read_environment(path); });
}

void babylon(const Path& folder) {
  const Path written = folder / "written.env";
  welkin::BabylonEnvironment environment;
  environment.specular = welkin::Cubemap(1, 1);
  refused(written, "WELKIN_PNG", [&] { welkin::write_babylon_environment(written, environment); });
  refused("images of RGBD", "WELKIN_PNG", [&] { (void)welkin::rgbd_images(environment.specular); });
  const Path png = folder / "png.env";
  put_env(png, "\x89PNG\r\n\x1a\n....");
  refused(png, "WELKIN_PNG", [&] { (void)welkin::read_babylon_environment(png); });
  const Path webp = folder / "webp.env";
  put_env(webp, "RIFF....WEBPVP8L....");
  refused(webp, "WELKIN_WEBP", [&] { (void)welkin::read_babylon_environment(webp); });
  refused(webp, "WELKIN_WEBP", [&] { (void)welkin::read_environment(webp); });
}

}  // namespace

int main(int count, char** arguments) {
  if (count != 2) {
    std::fputs("usage: refusing FOLDER\n", stderr);
    return 2;
  }
  const Path folder = Path(arguments[1]) / "files";
  std::filesystem::create_directories(folder);
  images(folder);
  textures(folder);
  blocks(folder);
  babylon(folder);
  return failures == 0 ? 0 : 1;
}
