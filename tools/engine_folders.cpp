#include "tools/engine_folders.h"

#include <algorithm>
#include <array>
#include <cstdint>

#include "tools/text.h"

namespace welkin::tool {
namespace {

/// Some lines of the README's code, and the files that they name.
struct LoaderLines {
  std::vector<std::string> files;
  const char* text;
  const char* language = nullptr;  ///< where it is another than the folder's
};

/// Whether the lines also load .ktx2 files of other texel formats than the folder's.
enum class Textures : std::uint8_t { fixed, any };

struct EngineFolder {
  Engine engine;
  std::vector<OutputFile> files;
  const char* language;  ///< of the lines, as Markdown names it
  std::vector<LoaderLines> lines;
  const char* remarks;  ///< what a person should know beside
  const char* known;    ///< how it is known that the engine takes the files so
  Textures textures = Textures::fixed;
};

constexpr TexelFormat kHalves = TexelFormat::rgba16f;
constexpr TexelFormat kBlocks = TexelFormat::bc6h_ufloat;
constexpr TexelFormat kPacked = TexelFormat::b10g11r11;
constexpr TexelFormat kShared = TexelFormat::e5b9g9r9;

OutputFile texture(Content content, Container container, TexelFormat format, const char* name, int levels = 0) {
  return {content, container, format, Supercompression::none, name, levels};
}

OutputFile lat_long(Container container) {
  return texture(Content::lat_long, container, kHalves,
                 container == Container::exr ? "environment.exr" : "environment.hdr");
}

OutputFile text_file(Content content, const char* name) { return texture(content, Container::text, kHalves, name); }

const std::vector<EngineFolder>& folders() {
  static const std::vector<EngineFolder> all = {
      {Engine::three,
       {texture(Content::specular, Container::dds, kBlocks, "specular.dds"),
        texture(Content::specular, Container::ktx2, kHalves, "specular.ktx2")},
       "js",
       {{{"specular.dds"},
         R"(// Blocks of BC6H, a byte a texel: where renderer.extensions.has("EXT_texture_compression_bptc"), as on desktops.
import * as THREE from "three";
import { DDSLoader } from "three/addons/loaders/DDSLoader.js";
const data = await (await fetch("specular.dds")).arrayBuffer();
const { width, height, mipmaps, mipmapCount: n, format } = new DDSLoader().parse(data, true);
const images = [0, 1, 2, 3, 4, 5].map((face) => ({ width, height, mipmaps: mipmaps.slice(n * face, n * (face + 1)) }));
const texture = new THREE.CompressedCubeTexture(images, format, THREE.HalfFloatType);
Object.assign(texture, { minFilter: THREE.LinearMipmapLinearFilter, isPMREMTexture: true, needsUpdate: true });
scene.environment = texture;
)"},
        {{"specular.ktx2"},
         R"(// Halves, eight bytes a texel: everywhere else. The loader needs no transcoder (no setTranscoderPath) for them.
import * as THREE from "three";
import { KTX2Loader } from "three/addons/loaders/KTX2Loader.js";
const { image: { width, height }, mipmaps } = await new KTX2Loader().detectSupport(renderer).loadAsync("specular.ktx2");
const images = [0, 1, 2, 3, 4, 5].map((face) => ({ width, height, mipmaps: mipmaps.map(({ data, width, height }) =>
  ({ width, height, data: data.subarray((data.length / 6) * face, (data.length / 6) * (face + 1)) })) }));
const texture = new THREE.CompressedCubeTexture(images, THREE.RGBAFormat, THREE.HalfFloatType);
Object.assign(texture, { minFilter: THREE.LinearMipmapLinearFilter, isPMREMTexture: true, needsUpdate: true });
scene.environment = texture;
)"},
        {{"sh.json"},
         R"(// A light probe, where no scene.environment brings the diffuse light: of both it would count twice.
const three = (await (await fetch("sh.json")).json()).engines.find((engine) => engine.name === "three");
const probe = new THREE.LightProbe();
probe.sh.set(Object.values(three.terms).map((rgb) => new THREE.Vector3(...rgb)));
scene.add(probe);
)"}},
       "three.js uses the chain as it is: `isPMREMTexture` keeps its own prefilter from running. The last mip has "
       "roughness 1, whose lobe is the cosine's, so it is the diffuse light too. Phones and tablets mostly lack BC6H "
       "and "
       "load the halves: for them bake with `--size 128 --supercompression zstd`, a fifth of the bytes or less, which "
       "KTX2Loader unpacks by itself.",
       "both ways of loading light nine balls in Chromium in Welkin's tests, without a prefilter pass; their distance "
       "from the "
       "truth stands beside that of three.js's own prefilter (r187) in docs/bake_folder.md."},

      {Engine::babylon,
       {texture(Content::env, Container::env, kHalves, "environment.env"),
        texture(Content::specular, Container::dds, kHalves, "specular.dds")},
       "js",
       {{{"environment.env"},
         R"(import * as BABYLON from "@babylonjs/core"; // or the script babylon.js, which brings BABYLON and all loaders
// Reflections, and diffuse light as a polynomial that was computed before the pixels were clipped at 255.
scene.environmentTexture = BABYLON.CubeTexture.CreateFromPrefilteredData("environment.env", scene);
)"},
        {{"specular.dds"},
         R"(import * as BABYLON from "@babylonjs/core";
// Or halves, which hold suns up to 65504; Babylon.js computes the polynomial from mip 0 when it loads them.
scene.environmentTexture = BABYLON.CubeTexture.CreateFromPrefilteredData("specular.dds", scene);
)"}},
       "Each mip has the roughness at which Babylon.js looks it up. No loader need be registered. For phones take "
       "environment.env, which with `--size 128` has a third of the bytes.",
       "environment.env lights balls in Chromium in Welkin's tests, beside Babylon.js's own prefilter (9.34); of "
       "specular.dds its DDS reader was run, and the rest of the loader was read."},

      {Engine::filament,
       {texture(Content::specular, Container::ktx, kPacked, "environment_ibl.ktx"),
        texture(Content::background, Container::ktx, kPacked, "environment_skybox.ktx", 1)},
       "cpp",
       {{{"environment_ibl.ktx"},
         R"(// bytes, size: of environment_ibl.ktx. Filament frees the bundle once the texture is uploaded.
auto* bundle = new image::Ktx1Bundle(bytes, size);
filament::math::float3 sh[9];
bundle->getSphericalHarmonics(sh);
auto* reflections = ktxreader::Ktx1Reader::createTexture(engine, bundle, false);
scene->setIndirectLight(
    filament::IndirectLight::Builder().reflections(reflections).irradiance(3, sh).intensity(1.0f).build(*engine));
)"},
        {{"environment_skybox.ktx"},
         R"(// The same of environment_skybox.ktx.
auto* sky = ktxreader::Ktx1Reader::createTexture(engine, new image::Ktx1Bundle(sky_bytes, sky_size), false);
scene->setSkybox(filament::Skybox::Builder().environment(sky).build(*engine));
)"}},
       "The files are as `cmgen --deploy` writes them, but without the window that it lays over the harmonics. "
       "`intensity` multiplies the radiance; with a picture in units of its own it is what you choose.",
       "header and harmonics were compared with files of cmgen 1.9.25; the KTX reader of Filament 1.53 (its npm "
       "package) "
       "was run and takes the files; the shaders for lod and harmonics were read."},

      {Engine::bevy,
       {texture(Content::lambert, Container::ktx2, kShared, "diffuse.ktx2"),
        texture(Content::specular, Container::ktx2, kShared, "specular.ktx2"),
        texture(Content::specular, Container::ktx2, kBlocks, "specular_bc6h.ktx2")},
       "rust",
       {{{"diffuse.ktx2", "specular.ktx2"},
         R"(commands.spawn((Camera3d::default(), EnvironmentMapLight {
    diffuse_map: asset_server.load("diffuse.ktx2"),
    specular_map: asset_server.load("specular.ktx2"),
    intensity: 1000.0, // cd/m2 for a radiance of 1
    ..default()
}));
)"},
        {{"specular_bc6h.ktx2"},
         R"(// specular_bc6h.ktx2 instead has a quarter of the bytes.
)"}},
       "diffuse.ktx2 is irradiance over pi, of one mip; the specular mips have roughness 0 to 1 in even steps. Bevy "
       "looks "
       "cubemaps up at (x, y, -z), and the faces lie so. It needs Bevy's features ktx2 and, with --supercompression, "
       "zlib or zstd. Blocks of BC6H are for cards that have them (CompressedImageFormats::BC).",
       "environment_map.wgsl was read (direction, mip, and that nothing is divided by pi); Bevy was not run.",
       Textures::any},

      {Engine::gltf,
       {texture(Content::lambert, Container::ktx2, kHalves, "lambertian.ktx2"),
        texture(Content::specular, Container::ktx2, kHalves, "ggx.ktx2"),
        texture(Content::charlie, Container::ktx2, kHalves, "charlie.ktx2"),
        texture(Content::gltf_light, Container::glb, kHalves, "environment.glb")},
       "sh",
       {{{"lambertian.ktx2", "ggx.ktx2", "charlie.ktx2"},
         R"(# The names that Khronos' sample viewer looks for, in a folder of its assets/environments.
mkdir -p city/lambertian city/ggx city/charlie
cp lambertian.ktx2 city/lambertian/diffuse.ktx2
cp ggx.ktx2 city/ggx/specular.ktx2
cp charlie.ktx2 city/charlie/sheen.ktx2
)"},
        {{"environment.glb"},
         R"(// Or the light alone, of EXT_lights_image_based, in Babylon.js with @babylonjs/loaders.
await BABYLON.AppendSceneAsync("environment.glb", scene); // sets scene.environmentTexture
scene.environmentTexture.gammaSpace = false; // linear light, which loader 9.28 does not say: reflections would be dark
)",
         "js"}},
       "lambertian.ktx2 is irradiance over pi, ggx.ktx2 has roughness 0 to 1 in even steps, charlie.ktx2 the same from "
       "0.05 on. environment.glb has roughness and axes as Babylon.js's loader takes them in its own, left-handed "
       "scenes "
       "beside models of glTF; in right-handed ones turn it by `scene.environmentTexture.rotationY = Math.PI`.",
       "names and folders are those of glTF-Sample-Environments; the viewer's shader was read, not run. "
       "environment.glb "
       "lights balls in Chromium in Welkin's tests, by Babylon.js 9.34 and its loader 9.28."},

      {Engine::unity,
       {lat_long(Container::exr)},
       "cs",
       {{{"environment.exr"},
         R"(// Assets/Editor/WelkinImport.cs, with environment.exr in Assets: then choose Tools > Import Welkin's light.
using UnityEditor;
using UnityEngine;
using UnityEngine.Rendering;

public static class WelkinImport {
  [MenuItem("Tools/Import Welkin's light")]
  static void Import() {
    const string path = "Assets/environment.exr";
    var importer = (TextureImporter)AssetImporter.GetAtPath(path);
    importer.textureShape = TextureImporterShape.TextureCube;
    importer.generateCubemap = TextureImporterGenerateCubemap.Cylindrical;
    importer.maxTextureSize = 8192; // of 2048, the default, a larger picture is reduced
    var settings = new TextureImporterSettings();
    importer.ReadTextureSettings(settings);
    settings.cubemapConvolution = TextureImporterCubemapConvolution.Specular;
    importer.SetTextureSettings(settings);
    importer.SaveAndReimport();
    var cubemap = AssetDatabase.LoadAssetAtPath<Cubemap>(path);

    // Reflections.
    RenderSettings.defaultReflectionMode = DefaultReflectionMode.Custom;
    RenderSettings.customReflectionTexture = cubemap;

    // What is seen behind everything.
    var skybox = new Material(Shader.Find("Skybox/Cubemap"));
    skybox.SetTexture("_Tex", cubemap);
    AssetDatabase.CreateAsset(skybox, "Assets/environment_skybox.mat");
    RenderSettings.skybox = skybox;
  }
}
)"},
        {{"sh.cs"},
         R"(// Diffuse light, with sh.cs in Assets. Without AmbientMode.Custom the probe is ignored.
RenderSettings.ambientMode = UnityEngine.Rendering.AmbientMode.Custom;
RenderSettings.ambientProbe = WelkinLight.Probe();
)"}},
       "Unity prefilters the lat-long itself when it imports it. The built-in pipeline and URP read RenderSettings, as "
       "above. HDRP does not: there a Volume gets the overrides HDRI Sky, with the cubemap, and Visual Environment, "
       "whose "
       "sky type is HDRI Sky, and HDRP makes reflections and diffuse light from these. (The material Skybox/Panoramic "
       "would want the picture as a 2D texture, imported once more.) Shaders of your own read unity_SHAr to unity_SHC, "
       "which sh.json has as `vectors`.",
       "the names stand in Unity's scripting reference; Unity was not run. How its importer turns a lat-long is not "
       "public: `welkin testmap` shows it, and --yaw turns the picture."},

      {Engine::unreal,
       {lat_long(Container::hdr)},
       "python",
       {{{"environment.hdr"},
         R"(# In the editor's Python console, with the plugin Python Editor Script Plugin.
import os
import unreal

folder = "C:/path/to/this/folder"  # the whole path: the editor's working directory is another

# A lat-long .hdr becomes a TextureCube.
task = unreal.AssetImportTask()
task.filename = os.path.join(folder, "environment.hdr")
task.destination_path = "/Game/Light"
task.automated, task.replace_existing, task.save = True, True, True
unreal.AssetToolsHelpers.get_asset_tools().import_asset_tasks([task])
cubemap = unreal.load_asset("/Game/Light/environment")

# The level's sky light, or a new one.
actors = unreal.get_editor_subsystem(unreal.EditorActorSubsystem)
sky_light = next((actor for actor in actors.get_all_level_actors() if isinstance(actor, unreal.SkyLight)), None)
if sky_light is None:
    sky_light = actors.spawn_actor_from_class(unreal.SkyLight, unreal.Vector(0, 0, 0))
light = sky_light.light_component
light.set_mobility(unreal.ComponentMobility.MOVABLE)  # else it shows once lighting is built
light.set_editor_property("real_time_capture", False)
light.set_editor_property("source_type", unreal.SkyLightSourceType.SLS_SPECIFIED_CUBEMAP)
light.set_editor_property("cubemap", cubemap)
light.set_editor_property("cubemap_resolution", 512)  # of reflections; default 128
light.set_editor_property("lower_hemisphere_is_black", False)  # else no light comes from below
light.set_editor_property("intensity", 1.0)  # multiplies the radiance
light.recapture_sky()
)"}},
       "Unreal prefilters the cubemap itself. A sky light is not seen: for the picture behind everything enable the "
       "plugin HDRI Backdrop, drag its actor into the level and set its Cubemap (it brings a sky light of its own, so "
       "leave the one above out), or put an unlit, two-sided material that samples the cubemap by the negated camera "
       "vector on a large sphere. Automatic exposure evens `intensity` out.",
       "Unreal's manual says that a .hdr in longitude and latitude becomes a cubemap, its API reference has the names; "
       "Unreal was not run."},

      {Engine::blender,
       {lat_long(Container::exr)},
       "python",
       {{{"environment.exr"},
         R"(import bpy

path = "//environment.exr"  # beside the .blend, once that is saved; else write the whole path
world = bpy.context.scene.world or bpy.data.worlds.new("Welkin")
bpy.context.scene.world = world
world.use_nodes = True
nodes, links = world.node_tree.nodes, world.node_tree.links

def node(kind, name):  # by type: names are translated
    return next((each for each in nodes if each.type == kind), None) or nodes.new(name)

picture = node("TEX_ENVIRONMENT", "ShaderNodeTexEnvironment")
background = node("BACKGROUND", "ShaderNodeBackground")
output = node("OUTPUT_WORLD", "ShaderNodeOutputWorld")
picture.image = bpy.data.images.load(path)
links.new(picture.outputs[0], background.inputs[0])
links.new(background.outputs[0], output.inputs[0])
)"}},
       "Blender samples the lat-long itself; nothing is prefiltered.",
       "Blender was not run; where the picture's centre lies was read in Cycles."},

      {Engine::godot,
       {lat_long(Container::exr)},
       "gdscript",
       {{{"environment.exr"},
         R"(var material := PanoramaSkyMaterial.new()
material.panorama = load("res://environment.exr")
var sky := Sky.new()
sky.sky_material = material
$WorldEnvironment.environment.sky = sky
$WorldEnvironment.environment.background_mode = Environment.BG_SKY
)"}},
       "Godot prefilters the sky itself. For a shader of your own `--octahedral 512` adds the specular chain as an "
       "octahedral map.",
       "Godot's reference names .exr for panoramas, and sky.glsl was read; Godot was not run."},

      {Engine::usd,
       {text_file(Content::usd_stage, "environment.usda"), lat_long(Container::exr)},
       "python",
       {{{"environment.usda", "environment.exr"},
         R"(# usdview environment.usda, or into a Usd.Stage of your own:
stage.DefinePrim("/Environment").GetReferences().AddReference("./environment.usda")
)"}},
       "The dome light's texture is environment.exr beside the stage; its pole is +y and its centre +z, as OpenEXR has "
       "it.",
       "the schema and its orientation are those of OpenUSD's documentation; TinyUSDZ 0.9 reads the stage; OpenUSD was "
       "not run."},
  };
  return all;
}

const EngineFolder* folder_of(Engine engine) noexcept {
  const std::vector<EngineFolder>& all = folders();
  const auto found =
      std::ranges::find_if(all, [engine](const EngineFolder& folder) { return folder.engine == engine; });
  return found == all.end() ? nullptr : &*found;
}

constexpr const char* kFirstWords = "# Light for ";
constexpr const char* kLastWords = ", made by Welkin";

}  // namespace

bool has_folder(Engine engine) noexcept { return folder_of(engine) != nullptr; }

std::vector<OutputFile> files_for(Engine engine) {
  std::vector<OutputFile> files = folder_of(engine)->files;
  files.push_back(text_file(Content::readme, kReadmeName));
  return files;
}

bool takes_any_texture(Engine engine) noexcept { return folder_of(engine)->textures == Textures::any; }

bool is_own_readme(const std::string& first_line) noexcept {
  return first_line.starts_with(kFirstWords) && first_line.ends_with(kLastWords);
}

std::string readme_text(Engine engine, const std::vector<std::string>& written) {
  const EngineFolder& folder = *folder_of(engine);
  const Convention& axes = convention(engine);
  const auto is_there = [&written](const std::string& file) {
    return std::ranges::find(written, file) != written.end();
  };
  std::string code;
  for (const LoaderLines& lines : folder.lines) {
    if (!std::ranges::all_of(lines.files, is_there)) continue;
    code += "```" + std::string(lines.language != nullptr ? lines.language : folder.language) + '\n' + lines.text +
            "```\n\n";
  }
  std::string text = kFirstWords + std::string(axes.title) + kLastWords + "\n\n";
  if (code.empty()) {
    text += "The scene for which this was baked reads none of the files that " + std::string(axes.title) + " loads.\n";
  } else {
    text += code + folder.remarks + "\n\nHow this is known: " + folder.known + '\n';
  }
  return text + "\nSizes, roughness and errors are in manifest.json; axes: " + axes.axes + ".\n";
}

std::string usd_stage(const std::string& lat_long) {
  return R"(#usda 1.0
(
    defaultPrim = "Environment"
    metersPerUnit = 1
    upAxis = "Y"
)

def DomeLight "Environment"
{
    float inputs:intensity = 1
    asset inputs:texture:file = @./)" +
         lat_long + R"(@
    token inputs:texture:format = "latlong"
}
)";
}

std::string filament_harmonics(const SphericalHarmonics& radiance) {
  std::string text;
  for (const EngineTerm& term : engine_light(radiance, Engine::filament).terms) {
    text += significant(term.rgb.x) + ' ' + significant(term.rgb.y) + ' ' + significant(term.rgb.z) + '\n';
  }
  return text;
}

}  // namespace welkin::tool
