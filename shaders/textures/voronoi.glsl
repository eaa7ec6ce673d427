// SPDX-License-Identifier: GPL-3.0-or-later
// needs: hashes noise
// Worley, "A cellular texture basis function", 1996: distances to points, one in each cell of a lattice of one to four
// dimensions. Dimensions are used as in noise.glsl; what is not used is 0.

#define VORONOI_NEAREST 0
#define VORONOI_SECOND 1
#define VORONOI_SMOOTH 2 // the nearest, but without edges
#define VORONOI_EDGE 3 // the distance to the border between cells
#define VORONOI_SPHERE 4 // the radius of the sphere that the nearest point's own nearest leaves it

#define METRIC_EUCLIDEAN 0
#define METRIC_MANHATTAN 1
#define METRIC_CHEBYCHEV 2
#define METRIC_MINKOWSKI 3

// Blender 5.0 hashes cells by their whole numbers, earlier ones by Jenkins's hash of floats; before 4.0 nothing was
// farther away than 8, which distances of small exponents are.
#define VORONOI_3 0
#define VORONOI_4 1
#define VORONOI_5 2

struct Cells {
  int dimensions;
  int feature;
  int metric;
  int edition;
  bool coloured;
  float exponent; // of Minkowski
  float smoothness;
  float randomness; // 0: the points are the lattice's
};

Spot pick_spot(Mask condition, Spot a, Spot b)
{
  return spot_of(pick(condition, a.p, b.p), pick(condition, a.w, b.w));
}

Spot sum_of(Spot a, Spot b)
{
  return spot_of(a.p + b.p, a.w + b.w);
}

Spot scaled(Spot a, float scale)
{
  return spot_of(a.p * scale, a.w * scale);
}

float product(Spot a, Spot b)
{
  return dot(a.p, b.p) + a.w * b.w;
}

// With 0 for what is not used.
Spot used_of(Cells cells, Spot a)
{
  if (cells.dimensions == 1) {
    a.p.x = a.p.y = 0.0f;
  }
  if (cells.dimensions < 3) {
    a.p.z = 0.0f;
  }
  if (cells.dimensions == 2 || cells.dimensions == 3) {
    a.w = 0.0f;
  }
  return a;
}

float distance_between(Cells cells, Spot a, Spot b)
{
  vec3 d = vec3(abs(a.p.x - b.p.x), abs(a.p.y - b.p.y), abs(a.p.z - b.p.z));
  float w = abs(a.w - b.w);
  if (cells.dimensions == 1) {
    return w;
  }
  if (cells.metric == METRIC_EUCLIDEAN) {
    return sqrt(dot(d, d) + w * w);
  }
  if (cells.metric == METRIC_MANHATTAN) {
    return d.x + d.y + d.z + w;
  }
  if (cells.metric == METRIC_CHEBYCHEV) {
    return max(max(d.x, d.y), max(d.z, w));
  }
  float sum = pow(d.x, cells.exponent) + pow(d.y, cells.exponent);
  if (cells.dimensions > 2) {
    sum = sum + pow(d.z, cells.exponent);
  }
  if (cells.dimensions > 3) {
    sum = sum + pow(w, cells.exponent);
  }
  return pow(sum, 1.0f / cells.exponent);
}

// What is random of a cell, before randomness takes its share.
Spot cell_hash(Cells cells, Spot cell)
{
  Spot hash = spot_of(vec3(0.0f, 0.0f, 0.0f), 0.0f);
  vec3 p = cell.p;
  float w = cell.w;
  if (cells.dimensions == 1) {
    hash.w = hash_unit(w);
  }
  else if (cells.edition == VORONOI_5) {
    uint x = uint_of(p.x), y = uint_of(p.y), z = uint_of(p.z);
    if (cells.dimensions == 2) {
      hash.p = lattice_hash(x, y);
    }
    else if (cells.dimensions == 3) {
      hash.p = lattice_hash(x, y, z);
    }
    else {
      hash = lattice_hash(x, y, z, uint_of(w));
    }
  }
  else if (cells.dimensions == 2) {
    hash.p.x = hash_unit(p.x, p.y);
    hash.p.y = hash_unit(p.x, p.y, 1.0f);
  }
  else if (cells.dimensions == 3) {
    hash.p = hash_colour(3, p, w);
  }
  else {
    hash.p = vec3(hash_unit(p.x, p.y, p.z, w), hash_unit(w, p.x, p.y, p.z), hash_unit(p.z, w, p.x, p.y));
    hash.w = hash_unit(p.y, p.z, w, p.x);
  }
  return hash;
}

vec3 cell_colour(Cells cells, Spot cell)
{
  if (cells.dimensions == 1 || cells.edition != VORONOI_5) {
    return hash_colour(cells.dimensions, cell.p, cell.w);
  }
  if (cells.dimensions == 4) {
    return cell_hash(cells, cell).p;
  }
  return lattice_hash(uint_of(cell.p.x), uint_of(cell.p.y), uint_of(cell.p.z));
}

// How many cells to either side are looked at along an axis.
int reach_along(Cells cells, int axis, int reach)
{
  bool used = axis == 3 ? cells.dimensions == 1 || cells.dimensions == 4
                        : cells.dimensions > 1 && axis < cells.dimensions;
  return used ? reach : 0;
}

// The point of the cell `step` away, as seen from `cell`.
Spot point_in(Cells cells, Spot cell, Spot step)
{
  return sum_of(step, scaled(cell_hash(cells, sum_of(cell, step)), cells.randomness));
}

Spot step_of(int x, int y, int z, int w)
{
  return spot_of(vec3(real_of(x), real_of(y), real_of(z)), real_of(w));
}

float nothing_nearer(Cells cells)
{
  float farthest = 1e30f;
  if (cells.edition == VORONOI_3) {
    farthest = 8.0f;
  }
  return farthest;
}

// Of the nearest point or the second, seen from `cell`.
struct Found {
  float distance;
  Spot step; // to its cell
  Spot point;
};

Found nearest_point(Cells cells, Spot cell, Spot local, bool second)
{
  int rx = reach_along(cells, 0, 1), ry = reach_along(cells, 1, 1), rz = reach_along(cells, 2, 1);
  int rw = reach_along(cells, 3, 1);
  Found first, next;
  first.distance = next.distance = nothing_nearer(cells);
  first.step = first.point = next.step = next.point = step_of(0, 0, 0, 0);
  for (int w = -rw; w <= rw; ++w) {
    for (int z = -rz; z <= rz; ++z) {
      for (int y = -ry; y <= ry; ++y) {
        for (int x = -rx; x <= rx; ++x) {
          Spot step = step_of(x, y, z, w), point = point_in(cells, cell, step);
          float distance = distance_between(cells, point, local);
          if (second) {
            next.step = pick_spot(distance < next.distance, step, next.step);
            next.point = pick_spot(distance < next.distance, point, next.point);
            next.distance = min(distance, next.distance);
            next.step = pick_spot(distance < first.distance, first.step, next.step);
            next.point = pick_spot(distance < first.distance, first.point, next.point);
            next.distance = pick(distance < first.distance, first.distance, next.distance);
          }
          first.step = pick_spot(distance < first.distance, step, first.step);
          first.point = pick_spot(distance < first.distance, point, first.point);
          first.distance = min(distance, first.distance);
        }
      }
    }
  }
  if (second) {
    return next;
  }
  return first;
}

// The radius of the largest ball around the nearest point that its own nearest point leaves it.
float sphere_radius(Cells cells, Spot cell, Spot local)
{
  int rx = reach_along(cells, 0, 1), ry = reach_along(cells, 1, 1), rz = reach_along(cells, 2, 1);
  int rw = reach_along(cells, 3, 1);
  Found nearest = nearest_point(cells, cell, local, false);
  float least = 1e30f;
  for (int w = -rw; w <= rw; ++w) {
    for (int z = -rz; z <= rz; ++z) {
      for (int y = -ry; y <= ry; ++y) {
        for (int x = -rx; x <= rx; ++x) {
          if (x != 0 || y != 0 || z != 0 || w != 0) {
            Spot point = point_in(cells, cell, sum_of(nearest.step, step_of(x, y, z, w)));
            least = min(least, distance_between(cells, point, nearest.point));
          }
        }
      }
    }
  }
  return 0.5f * least;
}

// To the plane midway between the nearest point and any other; in one dimension, to the next of both.
float edge_distance(Cells cells, Spot cell, Spot local)
{
  int rx = reach_along(cells, 0, 1), ry = reach_along(cells, 1, 1), rz = reach_along(cells, 2, 1);
  int rw = reach_along(cells, 3, 1);
  Cells plain = cells;
  plain.metric = METRIC_EUCLIDEAN;
  Spot here = scaled(local, -1.0f), to_nearest = here;
  if (cells.dimensions > 1) {
    to_nearest = sum_of(nearest_point(plain, cell, local, false).point, here);
  }
  else {
    to_nearest = sum_of(point_in(cells, cell, step_of(0, 0, 0, 0)), here);
  }
  float least = 1e30f;
  for (int w = -rw; w <= rw; ++w) {
    for (int z = -rz; z <= rz; ++z) {
      for (int y = -ry; y <= ry; ++y) {
        for (int x = -rx; x <= rx; ++x) {
          Spot to_point = sum_of(point_in(cells, cell, step_of(x, y, z, w)), here);
          Spot across = sum_of(to_point, scaled(to_nearest, -1.0f)), middle = sum_of(to_point, to_nearest);
          float length2 = product(across, across);
          float distance = 0.5f * product(middle, across) * inversesqrt(max(length2, 1e-12f));
          if (cells.dimensions == 1) {
            distance = abs(distance);
          }
          least = min(least, pick(length2 > 1e-4f, distance, least));
        }
      }
    }
  }
  return least;
}

// The nearest of all points around, but each takes over gradually: with the least of two numbers within the smoothness
// of one another goes a cubic. Colours and places go along.
Textured smooth_nearest(Cells cells, Spot cell, Spot local)
{
  int rx = reach_along(cells, 0, 2), ry = reach_along(cells, 1, 2), rz = reach_along(cells, 2, 2);
  int rw = reach_along(cells, 3, 2);
  float smoothness = max(cells.smoothness, 1e-6f), least = nothing_nearer(cells);
  vec3 colour = vec3(0.0f, 0.0f, 0.0f);
  Spot found = step_of(0, 0, 0, 0);
  for (int w = -rw; w <= rw; ++w) {
    for (int z = -rz; z <= rz; ++z) {
      for (int y = -ry; y <= ry; ++y) {
        for (int x = -rx; x <= rx; ++x) {
          Spot step = step_of(x, y, z, w), point = point_in(cells, cell, step);
          float distance = distance_between(cells, point, local);
          float t = clamp(0.5f + 0.5f * (least - distance) / smoothness, 0.0f, 1.0f), h = t * t * (3.0f - 2.0f * t);
          float dent = smoothness * h * (1.0f - h), less = dent / (1.0f + 3.0f * smoothness);
          least = pick(h < 1.0f, between(least, distance, h) - dent, distance);
          vec3 each = vec3(less, less, less);
          if (cells.coloured) {
            colour = colour + (cell_colour(cells, sum_of(cell, step)) - colour) * h - each;
          }
          found.p = found.p + (point.p - found.p) * h - each;
          found.w = between(found.w, point.w, h) - less;
        }
      }
    }
  }
  Textured textured;
  textured.value = least;
  textured.colour = colour;
  found = used_of(cells, found);
  textured.position = found.p + cell.p;
  textured.w = found.w + cell.w;
  return textured;
}

// One octave.
Textured voronoi_octave(Cells cells, vec3 p, float w)
{
  Spot at = used_of(cells, spot_of(p, w));
  Spot cell = spot_of(vec3(floor(at.p.x), floor(at.p.y), floor(at.p.z)), floor(at.w));
  Spot local = sum_of(at, scaled(cell, -1.0f));
  if (cells.feature == VORONOI_SMOOTH) {
    return smooth_nearest(cells, cell, local);
  }
  Textured textured;
  if (cells.feature == VORONOI_EDGE) {
    textured.value = edge_distance(cells, cell, local);
    return textured;
  }
  if (cells.feature == VORONOI_SPHERE) {
    textured.value = sphere_radius(cells, cell, local);
    return textured;
  }
  Found found = nearest_point(cells, cell, local, cells.feature == VORONOI_SECOND);
  textured.value = found.distance;
  if (cells.coloured) {
    textured.colour = cell_colour(cells, sum_of(cell, found.step));
  }
  textured.position = found.point.p + cell.p;
  textured.w = found.point.w + cell.w;
  return textured;
}

// The texture Voronoi. detail: octaves after the first, up to 15. position and w are those of the scaled coordinates.
Textured voronoi_texture(int dimensions, int feature, int metric, int edition, bool normalise, bool coloured,
                         vec3 p, float w, float detail, float roughness, float lacunarity, float smoothness,
                         float exponent, float randomness)
{
  Cells cells;
  cells.dimensions = dimensions;
  cells.feature = feature;
  cells.metric = metric;
  cells.edition = edition;
  cells.coloured = coloured;
  cells.exponent = exponent;
  cells.smoothness = 0.5f * clamp(smoothness, 0.0f, 1.0f);
  cells.randomness = clamp(randomness, 0.0f, 1.0f);
  if (feature == VORONOI_SPHERE) {
    return voronoi_octave(cells, p, w);
  }

  float octaves = 1.0f + clamp(detail, 0.0f, 15.0f), ratio = clamp(roughness, 0.0f, 1.0f);
  // As far as a point may be; it divides what is normalised.
  float middle = 0.5f + 0.5f * cells.randomness, farthest = middle;
  if (feature != VORONOI_EDGE) {
    Spot corner = used_of(cells, spot_of(vec3(middle, middle, middle), middle));
    farthest = distance_between(cells, step_of(0, 0, 0, 0), corner);
  }
  if (feature == VORONOI_SECOND) {
    farthest = 2.0f * farthest;
  }

  float scale = 1.0f, height = 1.0f, most = 1.0f, most_edge = farthest;
  Textured sum = voronoi_octave(cells, p, w);
  for (float i = 1.0f; any_lane(i < octaves); i = i + 1.0f) {
    height = height * ratio;
    scale = scale * lacunarity;
    float share = height * octave_share(octaves, i), size = 1.0f / scale;
    Textured octave = voronoi_octave(cells, p * scale, w * scale);
    most = most + share;
    if (feature == VORONOI_EDGE) {
      most_edge = between(most_edge, farthest * size, share);
      sum.value = between(sum.value, min(sum.value, octave.value * size), share);
    }
    else {
      sum.value = sum.value + share * octave.value;
      sum.position = sum.position + (octave.position * size - sum.position) * share;
      sum.w = between(sum.w, octave.w * size, share);
      if (coloured) {
        sum.colour = sum.colour + octave.colour * share;
      }
    }
  }
  if (normalise) {
    if (feature == VORONOI_EDGE) {
      sum.value = sum.value / most_edge;
    }
    else {
      sum.value = sum.value / (most * farthest);
      if (coloured) {
        sum.colour = sum.colour / most;
      }
    }
  }
  return sum;
}
