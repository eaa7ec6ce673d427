// SPDX-License-Identifier: GPL-3.0-or-later
// Lights: how they fade, where on them a sample lies, and how a map looks around from one.

// All directions on the square [-1, 1]^2: Engelhardt and Dachsbacher, "Octahedron environment maps", 2008. The
// direction (0, 0, 1) lies in the middle, its opposite in the four corners.
struct Octahedral {
  float x;
  float y;
};

Octahedral octahedral(vec3 direction)
{
  float scale = 1.0f / max(abs(direction.x) + abs(direction.y) + abs(direction.z), 1e-30f);
  float x = direction.x * scale;
  float y = direction.y * scale;
  Octahedral place;
  place.x = pick(direction.z < 0.0f, (1.0f - abs(y)) * pick(x < 0.0f, -1.0f, 1.0f), x);
  place.y = pick(direction.z < 0.0f, (1.0f - abs(x)) * pick(y < 0.0f, -1.0f, 1.0f), y);
  return place;
}

vec3 octahedral_direction(Octahedral place)
{
  float z = 1.0f - abs(place.x) - abs(place.y);
  float fold = max(-z, 0.0f);
  float x = place.x - fold * pick(place.x < 0.0f, -1.0f, 1.0f);
  float y = place.y - fold * pick(place.y < 0.0f, -1.0f, 1.0f);
  float scale = 1.0f / sqrt(x * x + y * y + z * z);
  return vec3(x * scale, y * scale, z * scale);
}

// The irradiance that a sphere of intensity 1 brings to what faces it everywhere, smoke for one: its radiance is constant,
// so it is the solid angle that counts, 2 pi (1 - cos), which from afar is the inverse square law. Both arguments are
// squares. Smoke inside the light has what it has on its surface.
float falloff(float distance2, float radius2)
{
  float sine2 = min(radius2 / max(distance2, 1e-20f), 1.0f);
  return 2.0f / ((1.0f + sqrt(1.0f - sine2)) * max(max(distance2, radius2), 1e-20f));
}

// A spot in a direction whose cosine to its axis is given: it fades in over the share `blend` of its cone, measured in
// cosines, as Blender's do.
float spot_fade(float cosine, float cosine_of_edge, float blend)
{
  float width = max((1.0f - cosine_of_edge) * blend, 1e-6f);
  float t = clamp((cosine - cosine_of_edge) / width, 0.0f, 1.0f);
  return t * t * (3.0f - 2.0f * t);
}

// For a direction of any length, the cosine to the axis of a cone that is round where across and up are unit vectors: half
// as wide along those that are twice as long.
float oval_cosine(vec3 along, vec3 axis, vec3 across, vec3 up)
{
  float x = dot(along, across), y = dot(along, up), z = dot(along, axis);
  return z / sqrt(max(x * x + y * y + z * z, 1e-20f));
}

// A lamp with a grid before it that narrows its light to a whole angle `spread`: what is left in a direction whose
// cosine to the lamp's axis is given. `cotangent` is that of spread / 2, zero for a lamp without a grid.
float spread_fade(float cosine, float cotangent)
{
  float safe = max(cosine, 1e-4f);
  float tangent = sqrt(max(1.0f - safe * safe, 0.0f)) / safe;
  return pick(cosine > 0.0f, max(1.0f - tangent * cotangent, 0.0f), 0.0f);
}

// Where on [0, 1] the share u of a density that goes straight from a to b is reached. Neither is negative, one is positive.
float linear_quantile(float u, float a, float b)
{
  return u * (a + b) / max(a + sqrt(max(a * a + u * (b * b - a * a), 0.0f)), 1e-30f);
}

// A place of a density, and the length over which it lies there for each share of it: one over the density.
struct DensityPoint {
  float place;
  float length;
};

// Where between two ends the share u of a tent is reached, which is highest at `middle` and ends at `radius` from there;
// of a length that no part of the tent reaches, the share of the length.
DensityPoint tent_point(float u, float low, float high, float middle, float radius)
{
  float safe = max(radius, 1e-9f);
  float a = clamp((low - middle) / safe, -1.0f, 1.0f), b = clamp((high - middle) / safe, -1.0f, 1.0f);
  // From the side on which less of it lies, so that the thin end of a tent keeps its digits.
  float side = pick(a + b > 0.0f, -1.0f, 1.0f);
  float first = pick(a + b > 0.0f, -b, a), last = pick(a + b > 0.0f, -a, b);
  float start = 0.5f * (1.0f + first) * (1.0f + first), above = max(last, 0.0f), below = 1.0f + min(last, 0.0f);
  float whole = 0.5f * below * below + above * (1.0f - 0.5f * above) - start;
  float share = start + u * whole;
  float at = pick(share < 0.5f, sqrt(2.0f * share) - 1.0f, 1.0f - sqrt(max(2.0f - 2.0f * share, 0.0f)));
  DensityPoint point;
  point.place = pick(whole > 0.0f, middle + side * at * safe, low + (high - low) * u);
  point.length = pick(whole > 0.0f, whole * safe / max(1.0f - abs(at), 1e-4f), high - low);
  return point;
}

float parallelogram_area(vec3 x, vec3 y)
{
  vec3 normal = cross(x, y);
  return sqrt(dot(normal, normal));
}

// A point on a flat convex quadrilateral, a triangle where two corners coincide, from one on the unit square: equal areas
// have equal areas, neighbours stay neighbours. The bilinear map stretches areas by a linear function of both coordinates.
vec3 point_on_quad(vec3 a, vec3 b, vec3 c, vec3 d, float u, float v)
{
  float at_a = parallelogram_area(b - a, d - a), at_b = parallelogram_area(b - a, c - b);
  float at_c = parallelogram_area(d - c, c - b), at_d = parallelogram_area(d - c, d - a);
  float x = linear_quantile(u, at_a + at_d, at_b + at_c);
  float y = linear_quantile(v, at_a + (at_b - at_a) * x, at_d + (at_c - at_d) * x);
  vec3 low = a + (b - a) * x, high = d + (c - d) * x;
  return low + (high - low) * y;
}

// A point on the unit disk from one on the square [-1, 1]^2, equal areas from equal areas and the middle from the middle:
// Shirley and Chiu, "A low distortion map between disk and square", 1997.
struct DiskPoint {
  float x;
  float y;
};

DiskPoint point_on_disk(float a, float b)
{
  float radius = pick(abs(a) > abs(b), a, b);
  float eighths = pick(abs(a) > abs(b), b, a) / pick(abs(radius) < 1e-12f, 1e-12f, radius);
  float angle = 0.785398163397448310f * pick(abs(a) > abs(b), eighths, 2.0f - eighths);
  DiskPoint point;
  point.x = radius * cos(angle);
  point.y = radius * sin(angle);
  return point;
}
