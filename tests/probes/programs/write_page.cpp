// Writes the input of shaders_live.sh for shader compilers and a browser: the generated code with readers of a probe's
// numbers around it, and a page that evaluates the GLSL (WebGL 2) and, where it can, the WGSL (WebGPU) at points whose
// irradiance the library has computed.
//   write_page FOLDER
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <glm/geometric.hpp>
#include <iomanip>
#include <random>
#include <sstream>
#include <string>
#include <vector>

#include "welkin/probes.h"

namespace welkin::test {
namespace {

const ProbeGrid kGrid{.counts = {4, 3, 2}, .origin = {-1, 0.5, 2}, .spacing = {1, 0.75, 1.25}};
constexpr int kPoints = 256;
constexpr double kBias = 0.2;
constexpr double kEvenSpacing = 0.8;

double number(std::mt19937& random, double low, double high) {
  return low + (high - low) * static_cast<double>(random()) / 4294967296.0;
}

/// Returns made-up probes that cover every case of a lookup.
BakedProbes made_up() {
  std::mt19937 random(3);
  BakedProbes probes;
  probes.grid = kGrid;
  probes.bands = 3;
  probes.distance_size = 6;
  probes.distance_limit = 3.0;
  for (std::size_t k = 0; k < kGrid.size(); ++k) {
    probes.coefficients.emplace_back(3.0, 4.0, 5.0);
    for (int f = 1; f < 9; ++f) {
      probes.coefficients.emplace_back(number(random, -1, 1), number(random, -1, 1), number(random, -1, 1));
    }
    probes.validity.push_back(1.0F);
    probes.passes.push_back(k % 5 == 3 ? 1 : k % 7 == 4 ? 255 : 0);
    probes.offsets.push_back(dvec3(0.01, -0.02, 0.03) * static_cast<double>(k));
    for (int texel = 0; texel < 64; ++texel) {
      const double mean = number(random, 0.2, 1.5);
      probes.distances.push_back(static_cast<float>(mean));
      probes.distances.push_back(static_cast<float>(mean * mean + number(random, 0.001, 0.2)));
    }
  }
  return probes;
}

template <class Values>
std::string list_of(const Values& values) {
  std::ostringstream list;
  list << std::setprecision(9) << "[";
  for (std::size_t k = 0; k < values.size(); ++k) list << (k > 0 ? "," : "") << static_cast<float>(values[k]);
  list << "]";
  return list.str();
}

// One array of floats: 9 x 3 coefficients, share, 64 x 2 distances for each probe.
constexpr int kFloats = 27 + 1 + 128;

std::vector<float> numbers_of(const BakedProbes& probes) {
  std::vector<float> numbers;
  for (std::size_t k = 0; k < probes.grid.size(); ++k) {
    for (std::size_t f = 0; f < 9; ++f) {
      for (int c = 0; c < 3; ++c) numbers.push_back(static_cast<float>(probes.coefficients[9 * k + f][c]));
    }
    numbers.push_back(probe_share(probes.passes[k]));
    for (std::size_t f = 0; f < 128; ++f) numbers.push_back(probes.distances[128 * k + f]);
  }
  return numbers;
}

const char* const kGlslReaders = R"(#version 300 es
precision highp float;
precision highp int;
uniform highp sampler2D numbers;
uniform highp sampler2D places;
layout(location = 0) out vec4 result;
float number_of(int probe, int place) { return texelFetch(numbers, ivec2(place, probe), 0).x; }
vec3 probe_coefficient(int probe, int index) {
  return vec3(number_of(probe, 3 * index), number_of(probe, 3 * index + 1), number_of(probe, 3 * index + 2));
}
float probe_share(int probe) { return number_of(probe, 27); }
vec3 probe_offset(int probe) { return vec3(0.01, -0.02, 0.03) * float(probe); }
vec2 probe_distance(int probe, int column, int row) {
  int place = 28 + 2 * (row * 8 + column);
  return vec2(number_of(probe, place), number_of(probe, place + 1));
}
)";

const char* const kGlslMain = R"(
void main() {
  int k = int(gl_FragCoord.x);
  ProbeVolume volume = ProbeVolume(vec3(-1.0, 0.5, 2.0), vec3(1.0, 0.75, 1.25), ivec3(4, 3, 2), 3, 8, 0.15, 1, 1, 1);
  vec3 surface = texelFetch(places, ivec2(2 * k, 0), 0).xyz;
  vec3 normal = texelFetch(places, ivec2(2 * k + 1, 0), 0).xyz;
  result = vec4(probe_volume_light(volume, surface, normal), 1.0);
}
)";

const char* const kHlslReaders = R"(StructuredBuffer<float> numbers : register(t0);
StructuredBuffer<float4> places : register(t1);
RWStructuredBuffer<float4> results : register(u0);
float number_of(int probe, int place) { return numbers[156 * probe + place]; }
float3 probe_coefficient(int probe, int index) {
  return float3(number_of(probe, 3 * index), number_of(probe, 3 * index + 1), number_of(probe, 3 * index + 2));
}
float probe_share(int probe) { return number_of(probe, 27); }
float3 probe_offset(int probe) { return float3(0.01, -0.02, 0.03) * float(probe); }
float2 probe_distance(int probe, int column, int row) {
  int place = 28 + 2 * (row * 8 + column);
  return float2(number_of(probe, place), number_of(probe, place + 1));
}
)";

const char* const kHlslMain = R"(
[numthreads(64, 1, 1)]
void main(uint3 thread : SV_DispatchThreadID) {
  ProbeVolume volume;
  volume.origin = float3(-1.0, 0.5, 2.0);
  volume.spacing = float3(1.0, 0.75, 1.25);
  volume.counts = int3(4, 3, 2);
  volume.bands = 3;
  volume.distance_edge = 8;
  volume.normal_bias = 0.15;
  volume.visibility = 1;
  volume.facing = 1;
  volume.validity = 1;
  results[thread.x] =
      float4(probe_volume_light(volume, places[2 * thread.x].xyz, places[2 * thread.x + 1].xyz), 1.0);
}
)";

const char* const kWgslReaders = R"(@group(0) @binding(0) var<storage, read> numbers : array<f32>;
@group(0) @binding(1) var<storage, read> places : array<vec4f>;
@group(0) @binding(2) var<storage, read_write> results : array<vec4f>;
fn number_of(probe : i32, place : i32) -> f32 { return numbers[156 * probe + place]; }
fn probe_coefficient(probe : i32, index : i32) -> vec3f {
  return vec3f(number_of(probe, 3 * index), number_of(probe, 3 * index + 1), number_of(probe, 3 * index + 2));
}
fn probe_share(probe : i32) -> f32 { return number_of(probe, 27); }
fn probe_offset(probe : i32) -> vec3f { return vec3f(0.01, -0.02, 0.03) * f32(probe); }
fn probe_distance(probe : i32, column : i32, row : i32) -> vec2f {
  let place = 28 + 2 * (row * 8 + column);
  return vec2f(number_of(probe, place), number_of(probe, place + 1));
}
)";

const char* const kWgslMain = R"(
@compute @workgroup_size(64)
fn main(@builtin(global_invocation_id) thread : vec3u) {
  let volume = ProbeVolume(vec3f(-1.0, 0.5, 2.0), vec3f(1.0, 0.75, 1.25), vec3i(4, 3, 2), 3, 8, 0.15, 1, 1, 1);
  let k = thread.x;
  results[k] = vec4f(probe_volume_light(volume, places[2 * k].xyz, places[2 * k + 1].xyz), 1.0);
}
)";

const char* const kScript = R"(
const worst = (found, truth) => {
  let largest = 0;
  for (let k = 0; k < truth.length / 3; ++k) {
    for (let c = 0; c < 3; ++c) {
      const difference = Math.abs(found[4 * k + c] - truth[3 * k + c]) / Math.max(1, Math.abs(truth[3 * k + c]));
      if (!(difference <= largest)) largest = difference;
    }
  }
  return largest;
};
// Draws a pixel for each place by a fragment shader, whose textures `fill` makes.
const glslWorst = (source, truth, fill) => {
  const count = truth.length / 3;
  const canvas = document.createElement("canvas");
  const gl = canvas.getContext("webgl2");
  if (!gl || !gl.getExtension("EXT_color_buffer_float")) return "no WebGL 2";
  const shader = (kind, source) => {
    const made = gl.createShader(kind);
    gl.shaderSource(made, source);
    gl.compileShader(made);
    if (!gl.getShaderParameter(made, gl.COMPILE_STATUS)) throw new Error(gl.getShaderInfoLog(made));
    return made;
  };
  const program = gl.createProgram();
  gl.attachShader(program, shader(gl.VERTEX_SHADER, `#version 300 es
    void main() { gl_Position = vec4(gl_VertexID == 1 ? 3.0 : -1.0, gl_VertexID == 2 ? 3.0 : -1.0, 0.0, 1.0); }`));
  gl.attachShader(program, shader(gl.FRAGMENT_SHADER, source));
  gl.linkProgram(program);
  if (!gl.getProgramParameter(program, gl.LINK_STATUS)) throw new Error(gl.getProgramInfoLog(program));
  gl.useProgram(program);
  const texture = (unit, width, height, format, layout, data) => {
    gl.activeTexture(gl.TEXTURE0 + unit);
    gl.bindTexture(gl.TEXTURE_2D, gl.createTexture());
    gl.texImage2D(gl.TEXTURE_2D, 0, format, width, height, 0, layout, gl.FLOAT, data);
    gl.texParameteri(gl.TEXTURE_2D, gl.TEXTURE_MIN_FILTER, gl.NEAREST);
    gl.texParameteri(gl.TEXTURE_2D, gl.TEXTURE_MAG_FILTER, gl.NEAREST);
  };
  fill(gl, (name) => gl.getUniformLocation(program, name), texture);
  texture(1, places.length / 4, 1, gl.RGBA32F, gl.RGBA, new Float32Array(places));
  gl.uniform1i(gl.getUniformLocation(program, "places"), 1);
  const target = gl.createRenderbuffer();
  gl.bindRenderbuffer(gl.RENDERBUFFER, target);
  gl.renderbufferStorage(gl.RENDERBUFFER, gl.RGBA32F, count, 1);
  gl.bindFramebuffer(gl.FRAMEBUFFER, gl.createFramebuffer());
  gl.framebufferRenderbuffer(gl.FRAMEBUFFER, gl.COLOR_ATTACHMENT0, gl.RENDERBUFFER, target);
  gl.viewport(0, 0, count, 1);
  gl.drawArrays(gl.TRIANGLES, 0, 3);
  const found = new Float32Array(4 * count);
  gl.readPixels(0, 0, count, 1, gl.RGBA, gl.FLOAT, found);
  return worst(found, truth);
};
const fillNumbers = (gl, place, texture) => {
  texture(0, floats, numbers.length / floats, gl.R32F, gl.RED, new Float32Array(numbers));
  gl.uniform1i(place("numbers"), 0);
};
// three.js's own look-up of the atlas of `ProbeLayout::three`.
const fillAtlas = (gl, place) => {
  gl.activeTexture(gl.TEXTURE0);
  gl.bindTexture(gl.TEXTURE_3D, gl.createTexture());
  gl.texImage3D(gl.TEXTURE_3D, 0, gl.RGBA16F, ...atlasSize, 0, gl.RGBA, gl.HALF_FLOAT, new Uint16Array(atlas));
  for (const filter of [gl.TEXTURE_MIN_FILTER, gl.TEXTURE_MAG_FILTER]) gl.texParameteri(gl.TEXTURE_3D, filter, gl.LINEAR);
  for (const wrap of [gl.TEXTURE_WRAP_S, gl.TEXTURE_WRAP_T, gl.TEXTURE_WRAP_R]) {
    gl.texParameteri(gl.TEXTURE_3D, wrap, gl.CLAMP_TO_EDGE);
  }
  gl.uniform1i(place("probesSH[0]"), 0);
  gl.uniform3f(place("probesMin[0]"), ...origin.map((low) => low - 0.5 * evenSpacing));
  gl.uniform3f(place("probesMax[0]"), ...origin.map((low, axis) => low + (counts[axis] - 0.5) * evenSpacing));
  gl.uniform3f(place("probesResolution[0]"), ...counts);
};
const threeShader = `#version 300 es
precision highp float;
precision highp sampler3D;
#define NUM_LIGHT_PROBE_GRIDS 1
${threeChunk}
uniform highp sampler2D places;
layout(location = 0) out vec4 result;
void main() {
  int k = int(gl_FragCoord.x);
  vec3 place = texelFetch(places, ivec2(2 * k, 0), 0).xyz;
  vec3 normal = texelFetch(places, ivec2(2 * k + 1, 0), 0).xyz;
  result = vec4(getLightProbeGridIrradiance(probesSH[0], probesMin[0], probesMax[0], probesResolution[0], place, normal),
                1.0);
}`;
const wgslWorst = async () => {
  const adapter = navigator.gpu && await navigator.gpu.requestAdapter();
  if (!adapter) return "no WebGPU";
  const device = await adapter.requestDevice();
  const module = device.createShaderModule({code: wgsl});
  for (const message of (await module.getCompilationInfo()).messages) {
    if (message.type === "error") throw new Error(`${message.lineNum}: ${message.message}`);
  }
  const pipeline = device.createComputePipeline({layout: "auto", compute: {module, entryPoint: "main"}});
  const buffer = (data, usage) => {
    const made = device.createBuffer({size: data.byteLength, usage: usage | GPUBufferUsage.COPY_DST});
    device.queue.writeBuffer(made, 0, data);
    return made;
  };
  const results = new Float32Array(4 * wanted.length / 3);
  const buffers = [buffer(new Float32Array(numbers), GPUBufferUsage.STORAGE),
                   buffer(new Float32Array(places), GPUBufferUsage.STORAGE),
                   buffer(results, GPUBufferUsage.STORAGE | GPUBufferUsage.COPY_SRC)];
  const read = buffer(results, GPUBufferUsage.MAP_READ);
  const encoder = device.createCommandEncoder();
  const pass = encoder.beginComputePass();
  pass.setPipeline(pipeline);
  pass.setBindGroup(0, device.createBindGroup({layout: pipeline.getBindGroupLayout(0),
    entries: buffers.map((each, binding) => ({binding, resource: {buffer: each}}))}));
  pass.dispatchWorkgroups(wanted.length / 3 / 64);
  pass.end();
  encoder.copyBufferToBuffer(buffers[2], 0, read, 0, results.byteLength);
  device.queue.submit([encoder.finish()]);
  await read.mapAsync(GPUMapMode.READ);
  return worst(new Float32Array(read.getMappedRange()), wanted);
};
const said = async (name, work) => {
  let words;
  try {
    words = await work();
  } catch (error) {
    words = `failed: ${error.message}`;
  }
  document.body.dataset[name] = words;
};
(async () => {
  await said("glsl", () => glslWorst(glsl, wanted, fillNumbers));
  await said("three", () => threeChunk ? glslWorst(threeShader, threeWanted, fillAtlas) : "no three.js");
  // The browser's clock is a virtual one, which runs to its end while another process is waited for: so this one is
  // kept busy for some seconds of the real one.
  let answered = false;
  let work = 1;
  const answer = said("wgsl", wgslWorst).then(() => answered = true);
  for (let k = 0; k < 1000 && !answered; ++k) {
    for (let step = 0; step < 1e6; ++step) work = (work * 1664525 + 1013904223) % 4294967296;
    await new Promise((take) => setTimeout(take, 1));
  }
  if (answered) await answer;
})();
)";

void write(const std::filesystem::path& path, const std::string& text) {
  std::ofstream file(path, std::ios::binary);
  file << text;
  if (!file) throw std::runtime_error("cannot write a file");
}

void write_all(const std::filesystem::path& folder) {
  const BakedProbes probes = made_up();
  std::mt19937 random(11);
  std::vector<double> positions;
  std::vector<double> wanted;
  // three.js moves a point by half a spacing along the normal, axis by axis; this agrees where the spacings are equal.
  BakedProbes even = probes;
  even.grid.spacing = dvec3(kEvenSpacing);
  const ProbeTexture atlas = pack_probes(even, ProbeLayout::three).textures.front();
  const ProbeSampling plain{.visibility = false, .facing = false, .validity = false, .normal_bias = 0.5};
  std::vector<double> three_wanted;
  for (int k = 0; k < kPoints; ++k) {
    const dvec3 surface{number(random, -1.5, 2.5), number(random, 0.2, 2.3), number(random, 1.5, 3.6)};
    const dvec3 normal = glm::normalize(dvec3(number(random, -1, 1), number(random, -1, 1), number(random, -1, 1)));
    // Both sides start from the same floats.
    const dvec3 light = probe_irradiance(probes, dvec3(vec3(surface)), dvec3(vec3(normal)), {.normal_bias = kBias});
    for (const dvec3& each : {surface, normal}) positions.insert(positions.end(), {each.x, each.y, each.z, 0.0});
    wanted.insert(wanted.end(), {light.x, light.y, light.z});
    const dvec3 in_three = probe_irradiance(even, dvec3(vec3(surface)), dvec3(vec3(normal)), plain);
    three_wanted.insert(three_wanted.end(), {in_three.x, in_three.y, in_three.z});
  }
  const std::string glsl = kGlslReaders + probe_sampling_code(ShaderLanguage::glsl) + kGlslMain;
  const std::string wgsl = kWgslReaders + probe_sampling_code(ShaderLanguage::wgsl) + kWgslMain;
  write(folder / "probes.frag", glsl);
  write(folder / "probes.hlsl", kHlslReaders + probe_sampling_code(ShaderLanguage::hlsl) + kHlslMain);
  write(folder / "probes.wgsl", wgsl);
  std::ostringstream page;
  page << "<!doctype html><meta charset=utf-8><body><script src=three.js></script><script>\nconst floats = " << kFloats
       << ";\nconst numbers = " << list_of(numbers_of(probes)) << ";\nconst places = " << list_of(positions)
       << ";\nconst wanted = " << list_of(wanted) << ";\nconst threeWanted = " << list_of(three_wanted)
       << ";\nconst atlas = " << list_of(atlas.halves) << ";\nconst atlasSize = " << list_of(atlas.size)
       << ";\nconst counts = " << list_of(kGrid.counts) << ";\nconst origin = [-1, 0.5, 2]"
       << ";\nconst evenSpacing = " << kEvenSpacing << ";\nconst glsl = `" << glsl << "`;\nconst wgsl = `" << wgsl
       << "`;\n"
       << kScript << "</script>\n";
  write(folder / "page.html", page.str());
}

}  // namespace
}  // namespace welkin::test

int main(int count, char** words) {
  if (count != 2) return 2;
  welkin::test::write_all(words[1]);
  return 0;
}
