// Irradiance at a place on a surface, from a grid of probes (Welkin, docs/guides/probe_grids.md).
//
// The weights are those of Majercik, Guertin, Nowrouzezahrai and McGuire 2019, "Dynamic Diffuse Global Illumination with
// Ray-Traced Irradiance Fields", section 5.2: trilinear, facing, and visibility by Chebyshev's inequality.
//
// This text is GLSL and C++ at once, and a statement begins on a line of its own, so that a few replacements of words
// make HLSL and WGSL of it (sampling_code.cpp).

// NOLINTBEGIN(readability-*,modernize-*,bugprone-integer-division): other languages have no words for it
struct ProbeVolume {
  vec3 origin;
  vec3 spacing;
  ivec3 counts;
  int bands;
  int distance_edge;
  float normal_bias;
  int visibility;
  int facing;
  int validity;
};

// Irradiance of one probe: radiance times the cosine lobe's factors, pi, 2 pi / 3 and pi / 4 by band.
vec3 probe_light(int probe, int bands, vec3 normal) {
  vec3 light = probe_coefficient(probe, 0) * 0.88622693f;
  if (bands > 1) {
    light += probe_coefficient(probe, 1) * (1.0233267f * normal.y);
    light += probe_coefficient(probe, 2) * (1.0233267f * normal.z);
    light += probe_coefficient(probe, 3) * (1.0233267f * normal.x);
  }
  if (bands > 2) {
    light += probe_coefficient(probe, 4) * (0.8580855f * normal.x * normal.y);
    light += probe_coefficient(probe, 5) * (0.8580855f * normal.y * normal.z);
    light += probe_coefficient(probe, 6) * (0.24770796f * (3.0f * normal.z * normal.z - 1.0f));
    light += probe_coefficient(probe, 7) * (0.8580855f * normal.x * normal.z);
    light += probe_coefficient(probe, 8) * (0.42904275f * (normal.x * normal.x - normal.y * normal.y));
  }
  return light;
}

// Where a direction lies on the octahedral map, from 0 to 1: +z in the middle, -z in the corners.
vec2 probe_octahedral_place(vec3 direction) {
  float whole = abs(direction.x) + abs(direction.y) + abs(direction.z);
  float a = direction.x / whole;
  float b = direction.y / whole;
  float u = a;
  float v = b;
  if (direction.z < 0.0f) {
    u = 1.0f - abs(b);
    v = 1.0f - abs(a);
    if (a < 0.0f) {
      u = -u;
    }
    if (b < 0.0f) {
      v = -v;
    }
  }
  return vec2(u * 0.5f + 0.5f, v * 0.5f + 0.5f);
}

// Mean distance and mean of its square in a direction, bilinear.
vec2 probe_distances(int probe, int edge, vec3 direction) {
  vec2 place = probe_octahedral_place(direction);
  float inner = float(edge - 2);
  float x = place.x * inner + 0.5f;
  float y = place.y * inner + 0.5f;
  int column = int(min(floor(x), inner));
  int row = int(min(floor(y), inner));
  float right = x - float(column);
  float down = y - float(row);
  vec2 above = probe_distance(probe, column, row) * (1.0f - right) + probe_distance(probe, column + 1, row) * right;
  vec2 below = probe_distance(probe, column, row + 1) * (1.0f - right) + probe_distance(probe, column + 1, row + 1) * right;
  return above * (1.0f - down) + below * down;
}

// An upper bound of the chance that what lies so far away is seen, cubed so that shadows are not too soft.
float probe_sight(int probe, int edge, vec3 direction, float reach) {
  vec2 moments = probe_distances(probe, edge, direction);
  if (reach <= moments.x) {
    return 1.0f;
  }
  float variance = abs(moments.y - moments.x * moments.x);
  float beyond = reach - moments.x;
  float chance = variance / (variance + beyond * beyond);
  return chance * chance * chance;
}

// Irradiance on a surface at a place that faces along a normal of unit length.
vec3 probe_volume_light(ProbeVolume volume, vec3 surface, vec3 normal) {
  vec3 place = surface + normal * volume.normal_bias;
  vec3 last = vec3(volume.counts - ivec3(1, 1, 1));
  vec3 on_grid = min(max((place - volume.origin) / volume.spacing, vec3(0.0f, 0.0f, 0.0f)), last);
  vec3 lower = min(floor(on_grid), max(last - vec3(1.0f, 1.0f, 1.0f), vec3(0.0f, 0.0f, 0.0f)));
  vec3 inside = on_grid - lower;
  vec3 sum = vec3(0.0f, 0.0f, 0.0f);
  float weights = 0.0f;
  for (int corner = 0; corner < 8; corner++) {
    vec3 step_up = vec3(float(corner % 2), float((corner / 2) % 2), float(corner / 4));
    vec3 at = min(lower + step_up, last);
    int probe = int(at.x) + volume.counts.x * (int(at.y) + volume.counts.y * int(at.z));
    vec3 part = vec3(1.0f, 1.0f, 1.0f) - abs(step_up - inside);
    float weight = 1.0f;
    vec3 probe_place = volume.origin + at * volume.spacing + probe_offset(probe);
    if (volume.facing > 0) {
      vec3 way = probe_place - surface;
      float cosine = dot(way, normal) / max(length(way), 1e-12f);
      float wrapped = 0.5f * cosine + 0.5f;
      weight = weight * (wrapped * wrapped + 0.2f);
    }
    if (volume.visibility > 0) {
      vec3 way = place - probe_place;
      float reach = length(way);
      if (reach > 0.0f) {
        weight = weight * probe_sight(probe, volume.distance_edge, way, reach);
      }
      // So that there is some light where no probe sees the place, and little from those that hardly do.
      weight = max(weight, 1e-6f);
      if (weight < 0.2f) {
        weight = weight * weight * weight * 25.0f;
      }
    }
    weight = weight * part.x * part.y * part.z;
    if (volume.validity > 0) {
      weight = weight * probe_share(probe);
    }
    if (weight > 0.0f) {
      sum += probe_light(probe, volume.bands, normal) * weight;
      weights += weight;
    }
  }
  if (weights > 0.0f) {
    sum = sum / weights;
  }
  return max(sum, vec3(0.0f, 0.0f, 0.0f));
}
// NOLINTEND(readability-*,modernize-*,bugprone-integer-division)
