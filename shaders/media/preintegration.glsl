// SPDX-License-Identifier: GPL-3.0-or-later
// Smoke whose extinction and emission are functions of one number s, a transfer function or ramp: what a stretch of a
// ray sends to the eye where s is known along it. Emission is that of a unit of length (associated colours).
//
// Between two stops of a ramp, extinction is linear and emission at most quadratic in s. So over a stretch t in [0, 1]
// on which s is linear and meets no stop,
//     optical depth(t) = tau t - bend t (1 - t) ,
//     emission(t) length = mean + tilt (t - 1/2) + bow (t (1 - t) - 1/6) ,
//     radiance = int_0^1 emission(t) length exp(-optical depth(t)) dt .
// The moments of exp(-tau t) are closed forms; exp(bend t (1 - t)) is expanded to its first power.

// The bend of pieces for which that is enough: what is left out is below bend^2 / 60 of their radiance, 4e-7.
#define LEAST_BEND 0.005f

// Means over t in [0, 1].
struct Attenuation {
  float mean;   // of exp(-tau t)
  float tilt;   // of that times t - 1/2
  float arc;    // of that times t (1 - t)
  float slant;  // of that times t (1 - t) (t - 1/2)
  float behind; // exp(-tau)
};

struct Stretch {
  float front; // extinction times the stretch's length, where the ray enters
  float back;  // and where it leaves
  vec3 emission_front; // likewise
  vec3 emission_back;
  vec3 bow; // emission is that much times t (1 - t) above the line between its ends
};

// The mean of t^3 exp(-tau t) is a power series with positive terms, and cancels in closed form only where tau is small.
// The others follow from it by sums of positive terms.
Attenuation attenuation_over(float tau)
{
  Attenuation over;
  over.behind = exp(-tau);
  float inverse = 1.0f / max(tau, 1.0f);
  float closed = (2.0f * ((1.0f - over.behind) * inverse - over.behind) * inverse - over.behind) * inverse;
  closed = (3.0f * closed - over.behind) * inverse;
  float x = min(tau, 1.0f);
  float series = 1.0f + x * (1.0f / 12.0f) * (1.0f + x * (1.0f / 13.0f) * (1.0f + x * (1.0f / 14.0f)));
  series = 1.0f + x * (1.0f / 9.0f) * (1.0f + x * (1.0f / 10.0f) * (1.0f + x * (1.0f / 11.0f) * series));
  series = 1.0f + x * (1.0f / 6.0f) * (1.0f + x * (1.0f / 7.0f) * (1.0f + x * (1.0f / 8.0f) * series));
  series = 1.0f + x * 0.2f * series;
  float cubes = pick(tau < 1.0f, over.behind * 0.25f * series, closed);
  float squares = (tau * cubes + over.behind) * (1.0f / 3.0f);
  float firsts = 0.5f * (tau * squares + over.behind);
  over.mean = tau * firsts + over.behind;
  over.tilt = firsts - 0.5f * over.mean;
  over.arc = firsts - squares;
  over.slant = 1.5f * squares - cubes - 0.5f * firsts;
  return over;
}

float depth_of(Stretch stretch)
{
  return 0.5f * (stretch.front + stretch.back);
}

// The mean over the stretch, times its length.
vec3 mean_emission(Stretch stretch)
{
  return (stretch.emission_front + stretch.emission_back) * float(0.5f) + stretch.bow * float(1.0f / 6.0f);
}

// What the stretch sends to the eye; `over` is of its depth.
vec3 radiance_of(Stretch stretch, Attenuation over)
{
  float bend = 0.5f * (stretch.back - stretch.front);
  return mean_emission(stretch) * (over.mean + bend * over.arc) +
         (stretch.emission_back - stretch.emission_front) * (over.tilt + bend * over.slant) +
         stretch.bow * (over.arc - over.mean * (1.0f / 6.0f));
}

// For a ray that goes the other way.
Stretch reversed_stretch(Stretch stretch)
{
  Stretch other;
  other.front = stretch.back;
  other.back = stretch.front;
  other.emission_front = stretch.emission_back;
  other.emission_back = stretch.emission_front;
  other.bow = stretch.bow;
  return other;
}

// Into how many equal pieces a stretch must be cut: a piece bends by the square of its share. No more than make a stretch
// exact that bends by 327: of one that bends more, nothing but its front is seen.
float pieces_of(Stretch stretch)
{
  return clamp(ceil(sqrt(abs(stretch.back - stretch.front) * (0.5f / LEAST_BEND))), 1.0f, 256.0f);
}

// The part of a stretch from t on, `share` of it long.
Stretch piece_of(Stretch stretch, float t, float share)
{
  float end = t + share;
  float gain = stretch.back - stretch.front;
  vec3 more = stretch.emission_back - stretch.emission_front;
  Stretch piece;
  piece.front = (stretch.front + gain * t) * share;
  piece.back = (stretch.front + gain * end) * share;
  piece.emission_front = (stretch.emission_front + more * t + stretch.bow * (t * (1.0f - t))) * share;
  piece.emission_back = (stretch.emission_front + more * end + stretch.bow * (end * (1.0f - end))) * share;
  piece.bow = stretch.bow * (share * share * share);
  return piece;
}

// ---- Trilinear smoke along a ray: in each cell a cubic of the way u in [0, 1] through it ----

struct Cubic {
  float c0;
  float c1;
  float c2;
  float c3;
};

// Where it turns, in order; 1 where it does not within the cell.
struct Turns {
  float first;
  float second;
};

// Through the values at 0, 1/3, 2/3 and 1.
Cubic cubic_through(float s0, float s1, float s2, float s3)
{
  Cubic cubic;
  cubic.c0 = s0;
  cubic.c1 = 9.0f * s1 - 4.5f * s2 + s3 - 5.5f * s0;
  cubic.c2 = 9.0f * s0 - 22.5f * s1 + 18.0f * s2 - 4.5f * s3;
  cubic.c3 = 4.5f * (s3 - s0) + 13.5f * (s1 - s2);
  return cubic;
}

float cubic_at(Cubic cubic, float u)
{
  return cubic.c0 + u * (cubic.c1 + u * (cubic.c2 + u * cubic.c3));
}

// The zeros of c1 + 2 c2 u + 3 c3 u^2, by the root that does not cancel and the product of both.
Turns turns_of(Cubic cubic)
{
  float squared = cubic.c2 * cubic.c2 - 3.0f * cubic.c3 * cubic.c1;
  float root = sqrt(max(squared, 0.0f));
  float sum = -(cubic.c2 + pick(cubic.c2 < 0.0f, -root, root));
  float a = pick(abs(cubic.c3) > 1e-30f, sum / pick(abs(cubic.c3) > 1e-30f, 3.0f * cubic.c3, 1.0f), 1.0f);
  float b = pick(abs(sum) > 1e-30f, cubic.c1 / pick(abs(sum) > 1e-30f, sum, 1.0f), 1.0f);
  a = pick(squared > 0.0f && a > 0.0f && a < 1.0f, a, 1.0f);
  b = pick(squared > 0.0f && b > 0.0f && b < 1.0f, b, 1.0f);
  Turns turns;
  turns.first = min(a, b);
  turns.second = max(a, b);
  return turns;
}

// Where the cubic meets `value` between two places on either side of which it lies and between which it does not turn:
// Newton's steps, and halves where those leave the bracket.
float cubic_crossing(Cubic cubic, float low, float high, float value)
{
  float rising = pick(cubic_at(cubic, low) < cubic_at(cubic, high), 1.0f, -1.0f);
  float u = 0.5f * (low + high);
  float moved = high - low;
  for (int k = 0; k < 24 && any_lane(abs(moved) > 1e-7f); ++k) {
    float above = (cubic_at(cubic, u) - value) * rising;
    low = pick(above > 0.0f, low, u);
    high = pick(above > 0.0f, u, high);
    float slope = (cubic.c1 + u * (2.0f * cubic.c2 + u * (3.0f * cubic.c3))) * rising;
    float newton = u - above / max(slope, 1e-30f);
    float next = pick(newton > low && newton < high, newton, 0.5f * (low + high));
    moved = next - u;
    u = next;
  }
  return u;
}
