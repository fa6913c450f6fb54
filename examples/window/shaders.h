// The window's only shader program. Spheres and environment are drawn by one triangle that covers the window: each
// pixel intersects its ray with twelve spheres, and what it finds is shaded by the split sum.
#pragma once

namespace window {

constexpr char kVertexShader[] = R"(#version 330 core
out vec2 corner;
void main() {
  corner = vec2(gl_VertexID == 1 ? 3.0 : -1.0, gl_VertexID == 2 ? 3.0 : -1.0);
  gl_Position = vec4(corner, 0.0, 1.0);
})";

constexpr char kFragmentShader[] = R"(#version 330 core
uniform samplerCube chain[2];  // newer and older reflections, one roughness per mip
uniform mat3 turn[2];          // rotation of each since it was baked
uniform float weight[2], mips, exposure, slider;
uniform vec3 sh[9], sun, sun_irradiance;
uniform sampler2D brdf;
uniform mat3 camera;  // view to world; the spheres stay in view space
uniform vec2 frustum;  // half width and half height of the view at distance 1
in vec2 corner;
out vec4 pixel;

vec3 diffuse_light(vec3 n) {  // formula of Engine::welkin: irradiance over pi
  return sh[0] + sh[1] * n.y + sh[2] * n.z + sh[3] * n.x + sh[4] * (n.x * n.y) + sh[5] * (n.y * n.z) +
         sh[6] * (3.0 * n.z * n.z - 1.0) + sh[7] * (n.x * n.z) + sh[8] * (n.x * n.x - n.y * n.y);
}

vec3 reflections(vec3 direction, float roughness) {
  float mip = (mips - 1.0) * roughness * (2.0 - roughness);  // RoughnessSchedule::filament, the default of bakes
  return weight[0] * textureLod(chain[0], transpose(turn[0]) * direction, mip).rgb +
         weight[1] * textureLod(chain[1], transpose(turn[1]) * direction, mip).rgb;
}

float sun_lobe(vec3 n, vec3 v, float roughness) {  // D V of GGX, for the one light with a direction
  vec3 h = normalize(sun + v);
  float alpha = max(roughness * roughness, 0.01), nh = max(dot(n, h), 0.0), nl = max(dot(n, sun), 0.0);
  float nv = max(dot(n, v), 1e-3), a2 = alpha * alpha, d = nh * nh * (a2 - 1.0) + 1.0;
  float smith = nl * sqrt(nv * nv * (1.0 - a2) + a2) + nv * sqrt(nl * nl * (1.0 - a2) + a2);
  return a2 / (3.14159265 * d * d) * 0.5 / max(smith, 1e-4);
}


void main() {
  vec3 ray = normalize(vec3(corner * frustum, -1.0)), eye = vec3(0.0, 0.0, 12.0), n = vec3(0.0);
  int hit = -1;
  for (int sphere = 0; sphere < 12; ++sphere) {  // six of metal, five of plastic, one of white plaster
    vec3 to = vec3((float(sphere % 6) - 2.5) * 2.2, sphere < 6 ? 1.1 : -1.1, 0.0) - eye;
    float along = dot(to, ray), past = length(to - along * ray);
    if (past >= 1.0) continue;
    hit = sphere;
    n = camera * ((along - sqrt(1.0 - past * past)) * ray - to);
  }
  vec3 towards = camera * ray;
  float roughness = hit < 6 ? max(float(hit), 0.0) / 5.0 : float(hit - 6) / 4.0;
  vec3 f0 = hit < 6 ? vec3(1.0) : hit < 11 ? vec3(0.04) : vec3(0.0);
  vec3 albedo = hit < 6 ? vec3(0.0) : hit < 11 ? vec3(0.5, 0.07, 0.05) : vec3(1.0);
  vec2 table = textureLod(brdf, vec2(-dot(n, towards), roughness), 0.0).rg;
  vec3 light = reflections(hit < 0 ? towards : reflect(towards, n), roughness);  // of all pixels: no branches
  vec3 from_sun = sun_irradiance * max(dot(n, sun), 0.0);
  if (hit >= 0) {
    light = light * (f0 * table.x + table.y * (hit < 11 ? 1.0 : 0.0)) + albedo * diffuse_light(n) +
            from_sun * (albedo / 3.14159265 + f0 * sun_lobe(n, -towards, roughness));
  } else {
    light += sun_irradiance * 2e3 * step(0.99996, dot(towards, sun));
  }
  if (corner.x > 0.96) light = vec3(abs(corner.y - slider) < 0.02 ? 1.0 : 0.1) / exposure;
  vec3 linear = clamp(light * exposure, 0.0, 1.0);
  pixel = vec4(mix(12.92 * linear, 1.055 * pow(linear, vec3(1.0 / 2.4)) - 0.055, step(0.0031308, linear)), 1.0);
})";

}  // namespace window
