// SPDX-License-Identifier: GPL-3.0-or-later
// needs: hashes
// Gradient noise of one to four dimensions, and sums of its octaves. One dimension is w, two are x and y, three are p,
// four are p and w.

// What a texture says of a point. Where one has no colour or no position, or none is asked for, that is unset.
struct Textured {
  float value;
  vec3 colour;
  vec3 position; // and w: of Voronoi's cells
  float w;
};

float between(float a, float b, float t)
{
  return a + (b - a) * t;
}

// Perlin, "Improving noise", 2002: its cubic's successor, and gradients chosen by a hash's lowest bits.
float faded(float t)
{
  return t * t * t * (t * (t * 6.0f - 15.0f) + 10.0f);
}

float slope(uint hash, float x)
{
  return negated(x * (1.0f + real_of(hash & uint(7u))), hash << 28);
}

float slope(uint hash, float x, float y)
{
  float u = pick(none_of(hash, 4u), x, y), v = pick(none_of(hash, 4u), y, x);
  return negated(u, hash << 31) + negated(2.0f * v, hash << 30);
}

float slope(uint hash, float x, float y, float z)
{
  float u = pick(none_of(hash, 8u), x, y);
  float v = pick(none_of(hash, 12u), y, pick(none_of(hash ^ uint(12u), 13u), x, z));
  return negated(u, hash << 31) + negated(v, hash << 30);
}

float slope(uint hash, float x, float y, float z, float w)
{
  float u = pick(none_of(hash ^ uint(24u), 24u), y, x);
  float v = pick(none_of(hash, 16u), y, z);
  float s = pick(none_of(hash, 24u), z, w);
  return negated(u, hash << 31) + negated(v, hash << 30) + negated(s, hash << 29);
}

float gradient_noise(float x)
{
  float x0 = floor(x), fx = x - x0;
  uint cx = uint_of(x0);
  return 0.25f * between(slope(hash_bits(cx), fx), slope(hash_bits(cx + uint(1u)), fx - 1.0f), faded(fx));
}

float gradient_noise(float x, float y)
{
  float x0 = floor(x), y0 = floor(y), fx = x - x0, fy = y - y0, u = faded(fx);
  uint cx = uint_of(x0), cy = uint_of(y0), nx = cx + uint(1u), ny = cy + uint(1u);
  float low = between(slope(hash_bits(cx, cy), fx, fy), slope(hash_bits(nx, cy), fx - 1.0f, fy), u);
  float high = between(slope(hash_bits(cx, ny), fx, fy - 1.0f), slope(hash_bits(nx, ny), fx - 1.0f, fy - 1.0f), u);
  return 0.6616f * between(low, high, faded(fy));
}

// On one face of a cell, before the scale.
float face_noise(uint cx, uint cy, uint cz, float fx, float fy, float fz)
{
  uint nx = cx + uint(1u), ny = cy + uint(1u);
  float u = faded(fx);
  float low = between(slope(hash_bits(cx, cy, cz), fx, fy, fz), slope(hash_bits(nx, cy, cz), fx - 1.0f, fy, fz), u);
  float high = between(slope(hash_bits(cx, ny, cz), fx, fy - 1.0f, fz),
                       slope(hash_bits(nx, ny, cz), fx - 1.0f, fy - 1.0f, fz), u);
  return between(low, high, faded(fy));
}

float gradient_noise(vec3 p)
{
  float x0 = floor(p.x), y0 = floor(p.y), z0 = floor(p.z), fx = p.x - x0, fy = p.y - y0, fz = p.z - z0;
  uint cx = uint_of(x0), cy = uint_of(y0), cz = uint_of(z0);
  return 0.982f * between(face_noise(cx, cy, cz, fx, fy, fz), face_noise(cx, cy, cz + uint(1u), fx, fy, fz - 1.0f),
                          faded(fz));
}

float face_noise(uint cx, uint cy, uint cz, uint cw, float fx, float fy, float fz, float fw)
{
  uint nx = cx + uint(1u), ny = cy + uint(1u);
  float u = faded(fx);
  float low = between(slope(hash_bits(cx, cy, cz, cw), fx, fy, fz, fw),
                      slope(hash_bits(nx, cy, cz, cw), fx - 1.0f, fy, fz, fw), u);
  float high = between(slope(hash_bits(cx, ny, cz, cw), fx, fy - 1.0f, fz, fw),
                       slope(hash_bits(nx, ny, cz, cw), fx - 1.0f, fy - 1.0f, fz, fw), u);
  return between(low, high, faded(fy));
}

float gradient_noise(vec3 p, float w)
{
  float x0 = floor(p.x), y0 = floor(p.y), z0 = floor(p.z), w0 = floor(w);
  float fx = p.x - x0, fy = p.y - y0, fz = p.z - z0, fw = w - w0, v = faded(fz);
  uint cx = uint_of(x0), cy = uint_of(y0), cz = uint_of(z0), cw = uint_of(w0);
  uint nz = cz + uint(1u), nw = cw + uint(1u);
  float low = between(face_noise(cx, cy, cz, cw, fx, fy, fz, fw), face_noise(cx, cy, nz, cw, fx, fy, fz - 1.0f, fw), v);
  float high = between(face_noise(cx, cy, cz, nw, fx, fy, fz, fw - 1.0f),
                       face_noise(cx, cy, nz, nw, fx, fy, fz - 1.0f, fw - 1.0f), v);
  return 0.8344f * between(low, high, faded(fw));
}

// After this many cells of its lattice Blender's noise repeats, from 4.1 on, since a float has few digits left there.
float repeated(float x)
{
  float left = x - 100000.0f * trunc(x * 1e-5f);
  return left + pick(abs(x) < 1e6f, 0.0f, 0.5f);
}

// Within [-1, 1], and 0 where all coordinates are whole.
float gradient_noise(int dimensions, bool repeats, vec3 p, float w)
{
  if (repeats) {
    p = vec3(repeated(p.x), repeated(p.y), repeated(p.z));
    w = repeated(w);
  }
  if (dimensions == 1) {
    return gradient_noise(w);
  }
  if (dimensions == 2) {
    return gradient_noise(p.x, p.y);
  }
  if (dimensions == 3) {
    return gradient_noise(p);
  }
  return gradient_noise(p, w);
}

// Ways to put octaves together: Musgrave, "Procedural fractal terrains", in "Texturing and modeling", 1994.
#define FRACTAL_SUM 0 // fractional Brownian motion
#define FRACTAL_PRODUCT 1 // multifractal
#define FRACTAL_RIDGED 2
#define FRACTAL_HYBRID 3
#define FRACTAL_TERRAIN 4 // that of mixed heights

struct Fractal {
  int type;
  bool repeats;
  bool normalise; // a sum to [0, 1]
  float octaves; // the last one counts by what is above a whole number
  float roughness; // the height of an octave over that of the one before
  float lacunarity; // how much finer it is
  float offset;
  float gain;
};

// The share of octave i that counts.
float octave_share(float octaves, float i)
{
  return clamp(octaves - i, 0.0f, 1.0f);
}

float summed_octaves(Fractal fractal, int dimensions, vec3 p, float w)
{
  float scale = 1.0f, height = 1.0f, sum = 0.0f, most = 0.0f, value = 0.0f;
  for (float i = 0.0f; any_lane(i < fractal.octaves); i = i + 1.0f) {
    float share = octave_share(fractal.octaves, i);
    sum = sum + height * gradient_noise(dimensions, fractal.repeats, p * scale, w * scale);
    most = most + height;
    // A part of an octave lies between the values without and with all of it, each normalised by itself.
    float with_it = sum;
    if (fractal.normalise) {
      with_it = 0.5f * sum / most + 0.5f;
    }
    value = between(value, with_it, share);
    height = height * fractal.roughness;
    scale = scale * fractal.lacunarity;
  }
  return value;
}

float multiplied_octaves(Fractal fractal, int dimensions, vec3 p, float w)
{
  float height = 1.0f, value = 1.0f;
  for (float i = 0.0f; any_lane(i < fractal.octaves); i = i + 1.0f) {
    float share = octave_share(fractal.octaves, i);
    value = value * (1.0f + share * height * gradient_noise(dimensions, fractal.repeats, p, w));
    height = height * fractal.roughness;
    p = p * fractal.lacunarity;
    w = w * fractal.lacunarity;
  }
  return value;
}

// A part of an octave does not count, and the first always does.
float ridged_octaves(Fractal fractal, int dimensions, vec3 p, float w)
{
  float height = 1.0f, value = 0.0f, weight = 1.0f;
  for (float i = 0.0f; any_lane(i <= max(fractal.octaves - 1.0f, 0.0f)); i = i + 1.0f) {
    float ridge = fractal.offset - abs(gradient_noise(dimensions, fractal.repeats, p, w));
    float signal = ridge * ridge * weight;
    value = value + pick(i <= max(fractal.octaves - 1.0f, 0.0f), signal * height, 0.0f);
    weight = clamp(signal * fractal.gain, 0.0f, 1.0f);
    height = height * fractal.roughness;
    p = p * fractal.lacunarity;
    w = w * fractal.lacunarity;
  }
  return value;
}

// Each octave weighs by what all before it were; where that is little, nothing follows.
float hybrid_octaves(Fractal fractal, int dimensions, vec3 p, float w)
{
  float height = 1.0f, value = 0.0f, weight = 1.0f;
  for (float i = 0.0f; any_lane(i < fractal.octaves); i = i + 1.0f) {
    float share = octave_share(fractal.octaves, i);
    float signal = height * (fractal.offset + gradient_noise(dimensions, fractal.repeats, p, w));
    weight = pick(weight > 0.001f, min(weight, 1.0f), 0.0f);
    value = value + share * weight * signal;
    weight = weight * fractal.gain * signal;
    height = height * fractal.roughness;
    p = p * fractal.lacunarity;
    w = w * fractal.lacunarity;
  }
  return value;
}

// Each octave is as high as the ground on which it stands.
float terrain_octaves(Fractal fractal, int dimensions, vec3 p, float w)
{
  float height = 1.0f, value = 1.0f;
  for (float i = 0.0f; any_lane(i < fractal.octaves); i = i + 1.0f) {
    float share = octave_share(fractal.octaves, i);
    float rise = height * (fractal.offset + gradient_noise(dimensions, fractal.repeats, p, w)) * value;
    value = pick(i < 1.0f, rise, value + share * rise);
    height = height * fractal.roughness;
    p = p * fractal.lacunarity;
    w = w * fractal.lacunarity;
  }
  return value;
}

float fractal_noise(Fractal fractal, int dimensions, vec3 p, float w)
{
  if (fractal.type == FRACTAL_SUM) {
    return summed_octaves(fractal, dimensions, p, w);
  }
  if (fractal.type == FRACTAL_PRODUCT) {
    return multiplied_octaves(fractal, dimensions, p, w);
  }
  if (fractal.type == FRACTAL_RIDGED) {
    return ridged_octaves(fractal, dimensions, p, w);
  }
  if (fractal.type == FRACTAL_TERRAIN) {
    return terrain_octaves(fractal, dimensions, p, w);
  }
  return hybrid_octaves(fractal, dimensions, p, w);
}

// How far from a point noise is looked up that is to have nothing in common with that there: 100 and 100 times the hash
// of a seed and an axis or, in one dimension, of the seed alone.
Spot far_spot(int dimensions, int seed)
{
  if (dimensions == 1) {
    return spot_of(vec3(0.0f, 0.0f, 0.0f), seed == 0 ? 158.242584f : seed == 1 ? 114.836052f : 188.488693f);
  }
  if (seed == 0) {
    return spot_of(vec3(186.031281f, 114.955956f, 154.44751f), 142.504913f);
  }
  if (seed == 1) {
    return spot_of(vec3(199.839996f, 162.292603f, 154.048233f), 142.267609f);
  }
  if (seed == 2) {
    return spot_of(vec3(111.633842f, 157.369385f, 199.088104f), 178.436127f);
  }
  if (seed == 3) {
    return spot_of(vec3(165.445282f, 162.768219f, 193.408417f), 145.255508f);
  }
  if (seed == 4) {
    return spot_of(vec3(155.580917f, 177.154633f, 138.14003f), 180.18573f);
  }
  return spot_of(vec3(188.85379f, 132.677689f, 162.052155f), 185.268158f);
}

float far_noise(int dimensions, bool repeats, int seed, vec3 p, float w)
{
  Spot far = far_spot(dimensions, seed);
  return gradient_noise(dimensions, repeats, p + far.p, w + far.w);
}

// The texture Noise. detail: octaves after the first, up to 15. Before Blender 4.0 it is a normalised sum, its
// roughness within [0, 1] and its lacunarity 2; in 4.0 it is a sum.
Textured noise_texture(int dimensions, int type, bool repeats, bool normalise, bool coloured, vec3 p, float w,
                       float detail, float roughness, float lacunarity, float offset, float gain, float distortion)
{
  Fractal fractal;
  fractal.type = type;
  fractal.repeats = repeats;
  fractal.normalise = normalise;
  fractal.octaves = 1.0f + clamp(detail, 0.0f, 15.0f);
  fractal.roughness = max(roughness, 0.0f);
  fractal.lacunarity = lacunarity;
  fractal.offset = offset;
  fractal.gain = gain;
  if (any_lane(distortion > 0.0f) || any_lane(distortion < 0.0f)) {
    float along_w = w;
    if (dimensions == 1) {
      along_w = w + distortion * far_noise(1, repeats, 0, p, w);
    }
    if (dimensions == 4) {
      along_w = w + distortion * far_noise(4, repeats, 3, p, w);
    }
    if (dimensions > 1) {
      vec3 along = vec3(far_noise(dimensions, repeats, 0, p, w), far_noise(dimensions, repeats, 1, p, w), 0.0f);
      if (dimensions > 2) {
        along.z = far_noise(dimensions, repeats, 2, p, w);
      }
      p = p + along * distortion;
    }
    w = along_w;
  }
  Textured textured;
  textured.value = fractal_noise(fractal, dimensions, p, w);
  if (coloured) {
    // The seeds that follow the distortion's.
    Spot second = far_spot(dimensions, dimensions), third = far_spot(dimensions, dimensions + 1);
    textured.colour = vec3(textured.value, fractal_noise(fractal, dimensions, p + second.p, w + second.w),
                           fractal_noise(fractal, dimensions, p + third.p, w + third.w));
  }
  return textured;
}

// The texture Musgrave, which Noise replaced in 4.1. detail: octaves, up to 15. dimension: how much lower finer octaves
// are, as a power of their fineness.
float musgrave_texture(int dimensions, int type, bool repeats, vec3 p, float w, float detail, float dimension,
                       float lacunarity, float offset, float gain)
{
  Fractal fractal;
  fractal.type = type;
  fractal.repeats = repeats;
  fractal.normalise = false;
  fractal.octaves = clamp(detail, 0.0f, 15.0f);
  if (type == FRACTAL_TERRAIN) { // whose ground is a whole octave
    fractal.octaves = fractal.octaves + pick(fractal.octaves < 1.0f, 1.0f, 0.0f);
  }
  fractal.lacunarity = max(lacunarity, 1e-5f);
  fractal.roughness = pow(fractal.lacunarity, 0.0f - max(dimension, 1e-5f));
  fractal.offset = offset;
  fractal.gain = gain;
  return fractal_noise(fractal, dimensions, p, w);
}
