// SPDX-License-Identifier: GPL-3.0-or-later
// needs: hashes noise
// Textures of regular patterns, and one of none.

// Coordinates a little off whole numbers, so that a surface in a lattice plane is not between two cells.
vec3 nudged(vec3 p)
{
  return vec3((p.x + 0.000001f) * 0.999999f, (p.y + 0.000001f) * 0.999999f, (p.z + 0.000001f) * 0.999999f);
}

// Whether a whole number is a multiple of another: 1 or 0.
float divides(float divisor, float x)
{
  return pick(x == divisor * floor(x / divisor), 1.0f, 0.0f);
}

// The texture Checker: its value is 1 in cells of the first colour, else 0.
Textured checker_texture(vec3 p, vec3 colour1, vec3 colour2)
{
  vec3 q = nudged(p);
  float odd = abs(divides(2.0f, floor(q.x)) - divides(2.0f, floor(q.y)));
  Textured textured;
  textured.value = 1.0f - abs(odd - divides(2.0f, floor(q.z)));
  textured.colour = pick(textured.value > 0.5f, colour1, colour2);
  return textured;
}

// Noise of a whole number, in [0, 1]: Elias, "Perlin noise", 1998, by whose constants it goes.
float number_noise(uint x)
{
  x = (x + uint(1013u)) & uint(0x7fffffffu);
  x = x ^ (x >> 13);
  x = (x * (x * x * uint(60493u) + uint(19990303u)) + uint(1376312589u)) & uint(0x7fffffffu);
  return real_of(x) * 4.6566128730773926e-10f;
}

float smooth_step(float x)
{
  float t = clamp(x, 0.0f, 1.0f);
  return t * t * (3.0f - 2.0f * t);
}

// The texture Brick: its value is the share of mortar. Sizes are those of p. Every offset_frequency-th row is moved by
// a share of a brick, and every squash_frequency-th row's bricks are as many times as wide.
Textured brick_texture(vec3 p, vec3 colour1, vec3 colour2, vec3 mortar, float mortar_size, float mortar_smooth,
                       float bias, float brick_width, float row_height, float offset, int offset_frequency,
                       float squash, int squash_frequency)
{
  float row = floor(p.y / row_height), width = brick_width, along = p.x;
  if (offset_frequency != 0 && squash_frequency != 0) {
    width = pick(divides(real_of(squash_frequency), row) > 0.5f, width * squash, width);
    along = along + pick(divides(real_of(offset_frequency), row) > 0.5f, width * offset, 0.0f);
  }
  float brick = floor(along / width), x = along - width * brick, y = p.y - row_height * row;
  float to_edge = min(min(x, y), min(width - x, row_height - y));
  uint number = (uint_of(row) << 16) + (uint_of(brick) & uint(0xffffu));
  float tint = clamp(number_noise(number) + bias, 0.0f, 1.0f);
  float inside = 1.0f - to_edge / mortar_size;
  float blurred = pick(inside < mortar_smooth, smooth_step(inside / max(mortar_smooth, 1e-12f)), 1.0f);
  Textured textured;
  textured.value = pick(to_edge >= mortar_size, 0.0f, blurred);
  textured.colour = colour1 + (colour2 - colour1) * tint;
  textured.colour = textured.colour + (mortar - textured.colour) * textured.value;
  return textured;
}

// The texture Magic: sines of sums of sines, up to ten deep. Its value is the mean of its colour.
Textured magic_texture(vec3 p, int depth, float distortion)
{
  float x = sin((p.x + p.y + p.z) * 5.0f), y = cos((-p.x + p.y - p.z) * 5.0f), z = -cos((-p.x - p.y + p.z) * 5.0f);
  if (depth > 0) {
    x = x * distortion;
    y = y * distortion;
    z = z * distortion;
    y = -cos(x - y + z) * distortion;
  }
  if (depth > 1) {
    x = cos(x - y - z) * distortion;
  }
  if (depth > 2) {
    z = sin(-x - y - z) * distortion;
  }
  if (depth > 3) {
    x = -cos(-x + y - z) * distortion;
  }
  if (depth > 4) {
    y = -sin(-x + y + z) * distortion;
  }
  if (depth > 5) {
    y = -cos(-x + y + z) * distortion;
  }
  if (depth > 6) {
    x = cos(x + y + z) * distortion;
  }
  if (depth > 7) {
    z = sin(x + y - z) * distortion;
  }
  if (depth > 8) {
    x = -cos(-x - y + z) * distortion;
  }
  if (depth > 9) {
    y = -sin(x - y + z) * distortion;
  }
  float divisor = pick(abs(distortion) > 0.0f, 2.0f * distortion, 1.0f);
  Textured textured;
  textured.colour = vec3(0.5f - x / divisor, 0.5f - y / divisor, 0.5f - z / divisor);
  textured.value = (textured.colour.x + textured.colour.y + textured.colour.z) * 0.333333343f;
  return textured;
}

#define WAVE_BANDS 0
#define WAVE_RINGS 1

// Across which axis bands follow one another, or around which rings lie; the last is the diagonal, or balls.
#define WAVE_X 0
#define WAVE_Y 1
#define WAVE_Z 2
#define WAVE_ALL 3

#define PROFILE_SINE 0
#define PROFILE_SAW 1
#define PROFILE_TRIANGLE 2

// The texture Wave: twenty radians to the unit. Distortion and phase are radians, too. Before Blender 4.0 the detail's
// roughness is in [0, 1].
float wave_texture(int type, int direction, int profile, bool repeats, vec3 p, float distortion, float detail,
                   float detail_scale, float detail_roughness, float phase)
{
  vec3 q = nudged(p);
  float along;
  if (type == WAVE_BANDS) {
    along = direction == WAVE_X   ? q.x * 20.0f
            : direction == WAVE_Y ? q.y * 20.0f
            : direction == WAVE_Z ? q.z * 20.0f
                                  : (q.x + q.y + q.z) * 10.0f;
  }
  else {
    vec3 r = q;
    if (direction == WAVE_X) {
      r.x = 0.0f;
    }
    if (direction == WAVE_Y) {
      r.y = 0.0f;
    }
    if (direction == WAVE_Z) {
      r.z = 0.0f;
    }
    along = sqrt(dot(r, r)) * 20.0f;
  }
  along = along + phase;
  if (any_lane(distortion > 0.0f) || any_lane(distortion < 0.0f)) {
    Fractal fractal;
    fractal.type = FRACTAL_SUM;
    fractal.repeats = repeats;
    fractal.normalise = true;
    fractal.octaves = 1.0f + clamp(detail, 0.0f, 15.0f);
    fractal.roughness = detail_roughness;
    fractal.lacunarity = 2.0f;
    float noise = fractal_noise(fractal, 3, q * detail_scale, 0.0f);
    along = along + distortion * (2.0f * noise - 1.0f);
  }
  if (profile == PROFILE_SINE) {
    return 0.5f + 0.5f * sin(along - 1.57079632679489662f);
  }
  float turns = along / 6.28318530717958648f;
  if (profile == PROFILE_SAW) {
    return turns - floor(turns);
  }
  return 2.0f * abs(turns - floor(turns + 0.5f));
}

// The texture White Noise.
Textured white_noise_texture(int dimensions, bool coloured, vec3 p, float w)
{
  Textured textured;
  if (coloured) {
    textured.colour = hash_colour(dimensions, p, w);
    textured.value = textured.colour.x;
  }
  else {
    textured.value = hash_point(dimensions, p, w);
  }
  return textured;
}
