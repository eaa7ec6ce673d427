// SPDX-License-Identifier: GPL-3.0-or-later
// Epipolar sampling: Engelhardt and Dachsbacher, "Epipolar sampling for shadows and crepuscular rays in participating
// media with single scattering", I3D 2010, with slices of equal spacing.
//
// On the screen, in pixels from the lower left corner, the light lies at (light_x / light_w, light_y / light_w), its
// epipole; light_w is not negative, and 0 where that is at infinity. A slice is a line that comes from the epipole and
// leaves the screen by one of four borders; all rays through it lie in one plane with the light. Where the light is behind
// the camera the epipole is where its shadow would fall, and all this stays as it is.
//
// A place on the screen has two coordinates in one of the borders: `along` the border, where its slice leaves, and `deep`,
// how far from the border it lies. Borders 0 and 1 are x = 0 and x = width, 2 and 3 are y = 0 and y = height.

// Beyond its surface a sample is believed for so large a share of its distance, and half for twice that.
#define EPIPOLAR_TOLERANCE 0.005f

struct EpipolarPlace {
  float border;
  float along;
  float deep;
};

struct ScreenPlace {
  float x;
  float y;
};

EpipolarPlace epipolar_place(float x, float y, float light_x, float light_y, float light_w, float width, float height)
{
  float away_x = x * light_w - light_x, away_y = y * light_w - light_y;
  float deep_x = pick(away_x > 0.0f, width - x, x), deep_y = pick(away_y > 0.0f, height - y, y);
  float size_x = max(abs(away_x), 1e-20f), size_y = max(abs(away_y), 1e-20f);
  float to_side = deep_x / size_x, to_end = deep_y / size_y;
  EpipolarPlace place;
  place.border =
      pick(to_side < to_end, pick(away_x > 0.0f, 1.0f, 0.0f), pick(away_y > 0.0f, 3.0f, 2.0f));
  place.along = pick(to_side < to_end, y + to_side * away_y, x + to_end * away_x);
  place.deep = pick(to_side < to_end, deep_x, deep_y);
  return place;
}

// On a slice that leaves the screen at (exit_x, exit_y), the place so far from the border; away from the epipole
// the slice gains (away_x, away_y) while it comes nearer to the border by `gain`.
ScreenPlace place_on_slice(float exit_x, float exit_y, float away_x, float away_y, float gain, float deep)
{
  ScreenPlace place;
  place.x = exit_x - away_x * (deep / gain);
  place.y = exit_y - away_y * (deep / gain);
  return place;
}

// How many slices may become one at a place of which the distance from the epipole is `share` of its slice's: there they
// are still no further from each other than on the border.
float slices_as_one(float share)
{
  return pick(share >= 0.5f, 1.0f, pick(share >= 0.25f, 2.0f, pick(share >= 0.125f, 4.0f, pick(share >= 0.0625f, 8.0f, 16.0f))));
}

// The part of a ray that samples look at: what lies in the last of it, before the surface, goes on as it is there.
#define EPIPOLAR_LOOK 0.99f

// How much a sample says of a place at `distance` on a ray beside it, up to 1. The sample's last stretch, evenly lit, runs
// from `from` to its own surface at `to`: within it the sample knows of any distance, and for a little beyond; before it of
// none.
float sample_knows(float distance, float from, float to)
{
  float beyond = (distance - to) / (EPIPOLAR_TOLERANCE * to + 1e-6f);
  return pick(distance < from, 0.0f, clamp(2.0f - beyond, 0.0f, 1.0f));
}
