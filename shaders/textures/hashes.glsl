// SPDX-License-Identifier: GPL-3.0-or-later
// Hashes of whole numbers, and of other numbers by their bits. What GLSL calls otherwise than C++ does has names of its
// own here (textures_text.hpp): real_of, uint_of, float_bits, rotated, negated, none_of.

// Jenkins, "lookup3.c", 2006: what ends all his hashes. Its c.
uint last_mix(uint a, uint b, uint c)
{
  c = (c ^ b) - rotated(b, 14);
  a = (a ^ c) - rotated(c, 11);
  b = (b ^ a) - rotated(a, 25);
  c = (c ^ b) - rotated(b, 16);
  a = (a ^ c) - rotated(c, 4);
  b = (b ^ a) - rotated(a, 14);
  return (c ^ b) - rotated(b, 24);
}

// Each starts from his 0xdeadbeef + 13 and four times the count.
uint hash_bits(uint x)
{
  uint start = uint(0xdeadbf00u);
  return last_mix(start + x, start, start);
}

uint hash_bits(uint x, uint y)
{
  uint start = uint(0xdeadbf04u);
  return last_mix(start + x, start + y, start);
}

uint hash_bits(uint x, uint y, uint z)
{
  uint start = uint(0xdeadbf08u);
  return last_mix(start + x, start + y, start + z);
}

// The fourth comes after his other mix.
uint hash_bits(uint x, uint y, uint z, uint w)
{
  uint start = uint(0xdeadbf0cu), a = start + x, b = start + y, c = start + z;
  a = (a - c) ^ rotated(c, 4);
  c = c + b;
  b = (b - a) ^ rotated(a, 6);
  a = a + c;
  c = (c - b) ^ rotated(b, 8);
  b = b + a;
  a = (a - c) ^ rotated(c, 16);
  c = c + b;
  b = (b - a) ^ rotated(a, 19);
  a = a + c;
  c = (c - b) ^ rotated(b, 4);
  b = b + a;
  return last_mix(a + w, b, c);
}

// All 2^32 hashes as the numbers from 0 to 1, both included.
float unit_of(uint hash)
{
  return real_of(hash) * 2.3283064365386963e-10f;
}

float hash_unit(float x)
{
  return unit_of(hash_bits(float_bits(x)));
}

float hash_unit(float x, float y)
{
  return unit_of(hash_bits(float_bits(x), float_bits(y)));
}

float hash_unit(float x, float y, float z)
{
  return unit_of(hash_bits(float_bits(x), float_bits(y), float_bits(z)));
}

float hash_unit(float x, float y, float z, float w)
{
  return unit_of(hash_bits(float_bits(x), float_bits(y), float_bits(z), float_bits(w)));
}

// One number of a point: with one dimension of w, with two of x and y, with three of p, with four of all.
float hash_point(int dimensions, vec3 p, float w)
{
  if (dimensions == 1) {
    return hash_unit(w);
  }
  if (dimensions == 2) {
    return hash_unit(p.x, p.y);
  }
  if (dimensions == 3) {
    return hash_unit(p.x, p.y, p.z);
  }
  return hash_unit(p.x, p.y, p.z, w);
}

// Three numbers, the first of which is hash_point's.
vec3 hash_colour(int dimensions, vec3 p, float w)
{
  float first = hash_point(dimensions, p, w);
  if (dimensions == 1) {
    return vec3(first, hash_unit(w, 1.0f), hash_unit(w, 2.0f));
  }
  if (dimensions == 2) {
    return vec3(first, hash_unit(p.x, p.y, 1.0f), hash_unit(p.x, p.y, 2.0f));
  }
  if (dimensions == 3) {
    return vec3(first, hash_unit(p.x, p.y, p.z, 1.0f), hash_unit(p.x, p.y, p.z, 2.0f));
  }
  return vec3(first, hash_unit(p.z, p.x, w, p.y), hash_unit(w, p.z, p.y, p.x));
}

// Jarzynski and Olano, "Hash Functions for GPU Rendering", 2020: several numbers at once. Blender's copy is of signed
// numbers, so that its shift keeps the sign, and it leaves that out at the end.
uint congruent(uint x)
{
  return x * uint(1664525u) + uint(1013904223u);
}

uint folded(uint x)
{
  return x ^ ((x >> 16) | ((uint(0u) - (x >> 31)) << 16));
}

float half_unit_of(uint hash)
{
  return real_of(hash & uint(0x7fffffffu)) * 4.6566128730773926e-10f;
}

// Of two, in x and y; z is 0.
vec3 lattice_hash(uint x, uint y)
{
  x = congruent(x), y = congruent(y);
  x = x + y * uint(1664525u);
  y = y + x * uint(1664525u);
  x = folded(x), y = folded(y);
  x = x + y * uint(1664525u);
  y = y + x * uint(1664525u);
  return vec3(half_unit_of(x), half_unit_of(y), 0.0f);
}

vec3 lattice_hash(uint x, uint y, uint z)
{
  x = congruent(x), y = congruent(y), z = congruent(z);
  x = x + y * z;
  y = y + z * x;
  z = z + x * y;
  x = folded(x), y = folded(y), z = folded(z);
  x = x + y * z;
  y = y + z * x;
  z = z + x * y;
  return vec3(half_unit_of(x), half_unit_of(y), half_unit_of(z));
}

// Numbers in four dimensions.
struct Spot {
  vec3 p;
  float w;
};

Spot spot_of(vec3 p, float w)
{
  Spot spot;
  spot.p = p;
  spot.w = w;
  return spot;
}

Spot lattice_hash(uint x, uint y, uint z, uint w)
{
  x = congruent(x), y = congruent(y), z = congruent(z), w = congruent(w);
  x = x + y * w;
  y = y + z * x;
  z = z + x * y;
  w = w + y * z;
  x = folded(x), y = folded(y), z = folded(z), w = folded(w);
  x = x + y * w;
  y = y + z * x;
  z = z + x * y;
  w = w + y * z;
  return spot_of(vec3(half_unit_of(x), half_unit_of(y), half_unit_of(z)), half_unit_of(w));
}
