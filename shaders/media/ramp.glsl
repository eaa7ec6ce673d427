// SPDX-License-Identifier: GPL-3.0-or-later
// needs: preintegration
// A medium whose density, scattering and emission are a transfer function of what its grid holds, s: parts between stops,
// in which density is linear in s and what is scattered or emitted at most quadratic.
//
// Whoever asks defines, before this text:
//   ramp_row(m, row)   row PART_ROWS * part + i of the parts of medium m: the fields of Part in turn
//   last_part(m)       the number of its last part
//   Colour             see march.glsl

#define PART_ROWS 7.0f

// Pieces of a stretch bend no more: what is left out is below MOST_BEND^2 / 60 of their radiance.
#define MOST_BEND 0.1f

struct Part {
  vec3 place;   // from, to, and one over the width; that is 0 before the first stop and behind the last
  vec3 density; // at `from`, and how much more at `to`; 0 where the part holds nothing
  vec3 scattering; // density times the colour in which it scatters: at `from`,
  vec3 scattering_gain; // how much more at `to`,
  vec3 scattering_bow;  // and the share t (1 - t) of it above the line between these
  vec3 emission;
  vec3 emission_gain;
};

// Of one value of s, per metre and unit of the medium's coefficients.
struct Contents {
  float density;
  vec3 scattering;
  vec3 emission;
};

// What the lights send to the eye by a unit of scattering: where a piece begins, in its middle, and at its end.
struct Lit {
  vec3 front;
  vec3 middle;
  vec3 back;
};

struct Sent {
  vec3 radiance;
  Colour depth; // optical
};

Part part_at(int m, float number)
{
  float row = number * PART_ROWS;
  Part part;
  part.place = ramp_row(m, row);
  part.density = ramp_row(m, row + 1.0f);
  part.scattering = ramp_row(m, row + 2.0f);
  part.scattering_gain = ramp_row(m, row + 3.0f);
  part.scattering_bow = ramp_row(m, row + 4.0f);
  part.emission = ramp_row(m, row + 5.0f);
  part.emission_gain = ramp_row(m, row + 6.0f);
  return part;
}

// The number of the part that holds s: of the stops up to it.
float part_of(int m, float s)
{
  float low = 0.0f;
  float high = last_part(m);
  for (int k = 0; k < 12 && any_lane(low < high); ++k) {
    float middle = floor(0.5f * (low + high));
    bool above = low < high && s >= ramp_row(m, middle * PART_ROWS).y;
    high = pick(above, high, middle);
    low = pick(above, middle + 1.0f, low);
    high = max(low, high);
  }
  return low;
}

Contents contents_at(Part part, float s)
{
  float t = (clamp(s, part.place.x, part.place.y) - part.place.x) * part.place.z;
  Contents contents;
  contents.density = part.density.x + part.density.y * t;
  contents.scattering = part.scattering + part.scattering_gain * t + part.scattering_bow * (t * (1.0f - t));
  contents.emission = part.emission + part.emission_gain * t;
  return contents;
}

// Over all values between two, in either order.
float mean_density(int m, float front, float back)
{
  float s = min(front, back);
  float high = max(front, back);
  float number = part_of(m, s);
  float alone = contents_at(part_at(m, number), s).density;
  float sum = 0.0f;
  for (int k = 0; k < 4096 && any_lane(s < high); ++k) {
    Part part = part_at(m, number);
    float end = max(min(part.place.y, high), s);
    sum = sum + (end - s) * contents_at(part, 0.5f * (s + end)).density;
    s = end;
    number = min(number + 1.0f, last_part(m));
  }
  float width = abs(back - front);
  return pick(width > 1e-30f, sum / max(width, 1e-30f), alone);
}

// Between two values, whether any part holds something.
bool holds_any(int m, float low, float high)
{
  float number = part_of(m, low);
  float last = part_of(m, high);
  float found = 0.0f;
  for (int k = 0; k < 4096 && any_lane(number <= last && found <= 0.0f); ++k) {
    found = max(found, ramp_row(m, min(number, last) * PART_ROWS + 1.0f).z);
    number = min(number + 1.0f, last + 1.0f);
  }
  return found > 0.0f;
}

// At u in [0, 1], by the parabola through all three.
vec3 lit_at(Lit lit, float u)
{
  vec3 gain = lit.middle * float(4.0f) - lit.front * float(3.0f) - lit.back;
  vec3 bend = (lit.front + lit.back) * float(2.0f) - lit.middle * float(4.0f);
  return lit.front + (gain + bend * u) * u;
}

// What a stretch of amounts, density times length, sends to the eye in smoke of which a unit takes so much light, where
// something else takes `beside` from end to end.
vec3 sent_through(Stretch amounts, float extinction, float beside)
{
  Stretch stretch = amounts;
  stretch.front = amounts.front * extinction + beside;
  stretch.back = amounts.back * extinction + beside;
  float pieces = clamp(ceil(sqrt(abs(stretch.back - stretch.front) * (0.5f / MOST_BEND))), 1.0f, 16.0f);
  float share = 1.0f / pieces;
  vec3 sum = vec3(0.0f, 0.0f, 0.0f);
  float depth = 0.0f;
  for (float k = 0.0f; any_lane(k < pieces); k = k + 1.0f) {
    Stretch piece = piece_of(stretch, share * k, share);
    float tau = max(depth_of(piece), 0.0f);
    sum = sum + radiance_of(piece, attenuation_over(tau)) * pick(k < pieces, exp(-depth), 0.0f);
    depth = depth + tau;
  }
  return sum;
}

// In each colour.
vec3 sent_through(Stretch amounts, vec3 extinction, vec3 beside)
{
  return vec3(sent_through(amounts, extinction.x, beside.x).x, sent_through(amounts, extinction.y, beside.y).y,
              sent_through(amounts, extinction.z, beside.z).z);
}

vec3 dimmed(vec3 radiance, float depth)
{
  return radiance * exp(-depth);
}
vec3 dimmed(vec3 radiance, vec3 depth)
{
  return vec3(radiance.x * exp(-depth.x), radiance.y * exp(-depth.y), radiance.z * exp(-depth.z));
}

// A piece of a step of `metres`, from u on and `share` of it, in one part: density times length, and what is sent.
Stretch amounts_of(Part part, Cubic cubic, float u, float share, float metres, vec3 scattering, Lit lit)
{
  Contents front = contents_at(part, cubic_at(cubic, u));
  Contents middle = contents_at(part, cubic_at(cubic, u + 0.5f * share));
  Contents back = contents_at(part, cubic_at(cubic, u + share));
  float way = metres * share;
  // Simpson's rule is exact for a line of a cubic.
  float mean = (front.density + 4.0f * middle.density + back.density) * (1.0f / 6.0f);
  float rise = 0.5f * (back.density - front.density);
  vec3 sent = (middle.scattering * scattering * lit.middle + middle.emission) * way;
  Stretch amounts;
  amounts.front = (mean - rise) * way;
  amounts.back = (mean + rise) * way;
  amounts.emission_front = (front.scattering * scattering * lit.front + front.emission) * way;
  amounts.emission_back = (back.scattering * scattering * lit.back + back.emission) * way;
  amounts.bow = sent * float(4.0f) - (amounts.emission_front + amounts.emission_back) * float(2.0f);
  return amounts;
}
