// SPDX-License-Identifier: GPL-3.0-or-later
// Lights: how they fade, and how a map looks around from one.

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

// A lamp with a grid before it that narrows its light to a whole angle `spread`: what is left in a direction whose
// cosine to the lamp's axis is given. `cotangent` is that of spread / 2, zero for a lamp without a grid.
float spread_fade(float cosine, float cotangent)
{
  float safe = max(cosine, 1e-4f);
  float tangent = sqrt(max(1.0f - safe * safe, 0.0f)) / safe;
  return pick(cosine > 0.0f, max(1.0f - tangent * cotangent, 0.0f), 0.0f);
}
