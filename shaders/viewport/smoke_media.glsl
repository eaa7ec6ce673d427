// SPDX-License-Identifier: GPL-3.0-or-later
// What media/march.glsl asks of the media and lights of SmokeView, whose cells are in textures.

#if COLOURS == 1
#  define Colour float
#  define OF_COLOURS(v) (v).x
#  define SHARE_OF(v) (v).y
#else
#  define Colour vec3
#  define OF_COLOURS(v) (v).xyz
#  define SHARE_OF(v) (v).w
#endif
#define Place vec3 // in [0, 1]^3
#define leave_knot(t, step, radiance, depth)
#define note_step(k, world)

struct Arriving {
  Colour depth;
  float share;
};

// Loops over what has a constant bound are unrolled: twice as fast.
#define media_count() MEDIA
#define light_count() int(view.screen.z)

vec3 transformed(int medium, vec4 place)
{
  return vec3(dot(view.media[6 * medium], place), dot(view.media[6 * medium + 1], place),
              dot(view.media[6 * medium + 2], place));
}

#define to_grid(medium, point) transformed(medium, vec4(point, 1.0f))
#define along_grid(medium, direction) transformed(medium, vec4(direction, 0.0f))
#define grid_size(medium) view.media[6 * (medium) + 3].xyz
#define clearance_at(medium, cell) clearance_of_brick(medium, ivec3((cell) * view.media[6 * (medium) + 3].w))
#define place_at(medium, cell) ((cell) / grid_size(medium))
#define longest_step(medium) view.media[6 * (medium) + 4].w
#define extinction_of(medium) OF_COLOURS(view.media[6 * (medium) + 4])
#define scattering_of(medium) view.media[6 * (medium) + 5].xyz
#ifdef TINTED
#  define scattering_at(medium, place) (view.media[6 * (medium) + 5].xyz * tint_at(medium, place))
#else
#  define scattering_at(medium, place) view.media[6 * (medium) + 5].xyz
#endif
#ifdef EMITTING
#  define emits(medium) (last_row(medium) > 0.0f)
#  define last_row(medium) view.emission[EMISSION_ROWS * (medium)].w
#  define emission_row(medium, row) view.emission[EMISSION_ROWS * (medium) + int(row)].xyz
#else
#  define emits(medium) false
#  define glow_at(medium, place) 0.0f
#  define last_row(medium) 1.0f
#  define emission_row(medium, row) vec3(0.0f)
#endif
#ifdef RAMPED
#  define classified(medium) (view.ramps[medium].x > 0.0f)
#  define splits(medium) (view.ramps[medium].y > 0.0f)
#  define ramp_row(medium, row) texelFetch(ramps, ivec2(int(row), medium), 0).xyz
#  define last_part(medium) (view.ramps[medium].x - 1.0f)
#endif
#define anisotropy_of(medium) view.media[6 * (medium) + 5].w

Arriving light_at(int medium, vec3 place, int light)
{
  vec4 volume = light_in_volume(medium, place, float(light), view.screen.z, grid_size(medium).z);
  Arriving arriving;
  arriving.depth = OF_COLOURS(volume);  // its root, as light_box() has it
  arriving.depth *= arriving.depth + 1.0f;
  arriving.share = SHARE_OF(volume);
  return arriving;
}

#define light_along(medium, place, world, light) light_at(medium, place, light)
#define is_parallel(light) (view.lights[3 * (light)].w != 0.0f)
#define light_concentration(light) (is_parallel(light) ? 2.0f - view.lights[3 * (light)].w : 1.0f)
#define light_direction(light) view.lights[3 * (light)].xyz
#define light_position(light) view.lights[3 * (light) + 1].xyz
#define light_size2(light) view.lights[3 * (light) + 1].w
#define light_strength(light) view.lights[3 * (light) + 2].xyz
