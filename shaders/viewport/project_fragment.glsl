// SPDX-License-Identifier: GPL-3.0-or-later
// The coefficients of one texel of a light map, by a march along its light ray: eqs 1-2 of Jansen and Bavoil (2010) for
// slabs of constant density. The same slices, weights and leaps as native/maps/light_map_lanes.cpp.
//
// grid_x, grid_y, grid_z are rows of (column, row, slice) -> the grid's cells; texels and slices have their centres at
// half numbers. `length_of_slice` is in metres. Textures: density in red; clearance as in smoke_fragment.glsl.

void main()
{
  vec4 middle = vec4(gl_FragCoord.xy, 0.5f, 1.0f);
  vec3 start = vec3(dot(grid_x, middle), dot(grid_y, middle), dot(grid_z, middle));
  vec3 along = vec3(grid_x.z, grid_y.z, grid_z.z);
  vec3 size = vec3(textureSize(density, 0));
  Interval inside;
  inside.near_t = 0.0f;
  inside.far_t = slices - 1.0f;
  inside = clip_to_box(inside, start, along, size);

  vec4 sums[LAYERS];
  for (int j = 0; j < LAYERS; ++j) {
    sums[j] = vec4(0.0f);
  }
  float width = 1.0f / slices;
  float speed = max(max(abs(along.x), abs(along.y)), abs(along.z)); // cells a slice
  ivec3 last_brick = textureSize(clearance, 0) - 1;
  float s = ceil(inside.near_t);
  while (s <= inside.far_t) {
    vec3 place = start + along * s;
    float clear = texelFetch(clearance, clamp(ivec3(place * (1.0f / BRICK)), ivec3(0), last_brick), 0).x;
    if (clear >= 0.0f) {
      s += 1.0f + floor(clear / speed);
      continue;
    }
    float here = textureLod(density, place / size, 0.0f).x;
    float z = (s + 0.5f) * width;
    Harmonic first = harmonic(1.0f, z);
    Harmonic h = harmonic(float(FIRST), z);
    for (int j = 0; j < LAYERS; ++j) {
      Harmonic next = next_harmonic(h, first);
      sums[j] += here * vec4(h.cosine, h.sine, next.cosine, next.sine);
      h = next_harmonic(next, first);
    }
    s += 1.0f;
  }

  // Slabs of one width have the same factors: they wait until here.
#define WRITE(layer, target, weight) \
  target = 2.0f * length_of_slice * sums[layer] * \
           vec4(vec2(factor_of(2 * layer, width)), vec2(factor_of(2 * layer + 1, width)));
  EACH_LAYER(WRITE)
}
