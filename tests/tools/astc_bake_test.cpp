// What `welkin bake` packs in ASTC.
#include "support/catch.h"
#include "support/chains.h"
#include "support/same_bits.h"
#include "tools/baked_folder.h"
#include "tools/command.h"
#include "welkin/bake_file.h"

namespace welkin::test {

TEST_CASE("bake: --ktx2-format astc4x4 and astc6x6 pack background and reflections of KTX2",
          "[tools][bake][astc][slow]") {
  const TemporaryDirectory scratch;
  const std::string options =
      small_image() + " --size 32 --mips 2 --irradiance 8 --brdf 16 --no-previews --formats ktx2,dds ";
  const auto floats = scratch.path() / "floats";
  bake_into(floats, options + "--ktx2-format rgba32f");
  for (const auto& [word, format] :
       {std::pair{"astc4x4", TexelFormat::astc_4x4_hdr}, std::pair{"astc6x6", TexelFormat::astc_6x6_hdr}}) {
    INFO(word);
    const auto blocks = scratch.path() / word;
    const nlohmann::json manifest = bake_into(blocks, options + "--astc-effort fastest --ktx2-format " + word);
    for (const std::string name : {"background", "specular"}) {
      CHECK(file_of(manifest, name + ".ktx2").at("format") == std::string("KTX2 ") + word);
      CHECK(file_of(manifest, name + ".dds").at("format") == "DDS rgba16f");
      // The very texels that the library's blocks of the same floats stand for, with the effort that was asked for.
      const Cubemap given = read_texture(floats / (name + ".ktx2")).cubemap;
      std::vector<std::byte> bytes;
      write_texture({bytes, "wanted.ktx2"}, given.views(), {.format = format, .astc_effort = AstcEffort::fastest});
      const Cubemap wanted = read_texture({std::as_const(bytes), "wanted.ktx2"}).cubemap;
      CHECK(same_bits(read_texture(blocks / (name + ".ktx2")).cubemap, wanted));
    }
    for (const char* const name : {"irradiance.ktx2", "brdf.ktx2"}) {
      CHECK(file_of(manifest, name).at("format") == "KTX2 rgba16f");
    }
  }
}

}  // namespace welkin::test
