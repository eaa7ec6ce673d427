// SPDX-License-Identifier: GPL-3.0-or-later
// Camera rays and their overlap with the box of a medium.

// A ray in world space; distances along it are metres.
struct Ray {
  vec3 origin;
  vec3 direction;
  float reach; // distance to the far plane
};

// The ray through (u, v) in [0, 1]^2, from the lower left corner. Both ends are affine in (u, v) for perspective and
// orthographic cameras alike: near0 + u near_u + v near_v on the near plane, and the same on the far plane.
Ray camera_ray(vec3 near0, vec3 near_u, vec3 near_v, vec3 far0, vec3 far_u, vec3 far_v, float u, float v)
{
  Ray ray;
  ray.origin = near0 + near_u * u + near_v * v;
  vec3 across = far0 + far_u * u + far_v * v - ray.origin;
  ray.reach = sqrt(dot(across, across));
  ray.direction = across * (1.0f / ray.reach);
  return ray;
}

// Where a ray is inside something: from near_t to far_t, empty when near_t >= far_t.
struct Interval {
  float near_t;
  float far_t;
};

// The part of `interval` in which origin + t direction lies between 0 and size along one axis.
// A direction of zero is nudged: the division then yields a huge interval of the right sign instead of a NaN.
Interval clip_to_slab(Interval interval, float origin, float direction, float size)
{
  float slope = 1.0f / pick(abs(direction) < 1e-12f, 1e-12f, direction);
  float t0 = (0.0f - origin) * slope;
  float t1 = (size - origin) * slope;
  Interval clipped;
  clipped.near_t = max(interval.near_t, min(t0, t1));
  clipped.far_t = min(interval.far_t, max(t0, t1));
  return clipped;
}

// The part of `interval` in which a ray, given in grid space (see scene.hpp), lies within a grid of `size` cells.
Interval clip_to_box(Interval interval, vec3 origin, vec3 direction, vec3 size)
{
  interval = clip_to_slab(interval, origin.x, direction.x, size.x);
  interval = clip_to_slab(interval, origin.y, direction.y, size.y);
  return clip_to_slab(interval, origin.z, direction.z, size.z);
}

// The share of Blackman and Harris's filter (1978) up to a share t of its diameter.
float filter_share(float t)
{
  float sine = sin(6.28318530717958648f * t), cosine = cos(6.28318530717958648f * t);
  float sine2 = 2.0f * sine * cosine, sine3 = sine * (3.0f - 4.0f * sine * sine);
  // Its coefficients over the first, .35875, and over a whole turn
  return t - (0.216623741219f * sine - 0.0313385510244f * sine2 + 0.00172722855778f * sine3);
}
