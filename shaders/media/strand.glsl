// SPDX-License-Identifier: GPL-3.0-or-later
// Light leaving a strand of hair: Chiang, Bitterli, Tappan and Burley, "A practical and controllable hair and fur model
// for production path tracing", 2016, for light from one direction, and the mean of it over a part of the strand's width.
//
// A strand is a dielectric cylinder. Light that meets it at the sine h of the angle between its normal and the eye, as
// seen along the strand, leaves it after p = 0, 1, 2, ... crossings: reflected (R), through it (TT), reflected inside
// (TRT), and the rest. Each lobe is the product of an attenuation A_p, a longitudinal M_p and an azimuthal N_p, and the
// strand sends to the eye, of a light that brings the irradiance E to whatever faces it, E sum_p A_p M_p N_p.
//
// Thin strands show all their width, h in [-1, 1], and N_p is narrow: instead of asking at points we integrate it over
// intervals on which its middle moves linearly with h, which is the difference of two cumulative distributions. What a
// strand sends is kept so however few they are; twelve are 1 % off (root mean square, tests).

// Of a strand's material.
struct Fibre {
  vec3 absorption;  // optical depth of one radius of it, in each colour
  float variance;   // longitudinal, of what crosses it;
  float primary;    // of what is reflected at once
  float scale;      // of the logistic distribution around it
  float tilt;       // sine of the angle of the cuticle's scales
  float index;      // of refraction
};

// By artists' roughness along a strand, and around it, in [0, 1]: the paper's fits.
float fibre_variance(float roughness)
{
  float r2 = roughness * roughness, r4 = r2 * r2, r8 = r4 * r4;
  float root = 0.726f * roughness + 0.812f * r2 + 3.7f * r8 * r8 * r4;
  return root * root;
}

float fibre_scale(float roughness)
{
  float r2 = roughness * roughness, r4 = r2 * r2, r8 = r4 * r4;
  return 0.626657069f * (0.265f * roughness + 1.194f * r2 + 5.372f * r8 * r8 * r4 * r2);
}

// exp(-x) I_0(x), for x >= 0: Abramowitz and Stegun, 9.8.1 and 9.8.2, within 3e-7.
float scaled_bessel(float x)
{
  float t = x * (1.0f / 3.75f), t2 = t * t;
  float near = 1.0f + t2 * (3.5156229f + t2 * (3.0899424f + t2 * (1.2067492f + t2 * (0.2659732f + t2 * (0.0360768f
             + t2 * 0.0045813f)))));
  float u = 1.0f / max(t, 1.0f);
  float far = 0.39894228f + u * (0.01328592f + u * (0.00225319f + u * (-0.00157565f + u * (0.00916281f
            + u * (-0.02057706f + u * (0.02635537f + u * (-0.01647633f + u * 0.00392377f)))))));
  return pick(x < 3.75f, exp(-min(x, 3.75f)) * near, far / sqrt(max(x, 3.75f)));
}

// M_p: of the elevations of light and eye over the plane across the strand. The paper's (6), without overflow: 1 minus
// the cosine of the sum of both angles is half a sum of squares.
float strand_along(float sine_light, float cosine_light, float sine_eye, float cosine_eye, float variance)
{
  float sines = sine_light + sine_eye, cosines = cosine_light - cosine_eye;
  float away = 0.5f * (sines * sines + cosines * cosines) / variance;
  return scaled_bessel(cosine_light * cosine_eye / variance) * exp(-away)
       / (variance * (1.0f - exp(-2.0f / variance)));
}

// The integral, from anywhere, of the logistic distribution that is cut at -pi and pi and repeated: N_p's.
float strand_turned(float angle, float scale)
{
  float turns = floor(angle * 0.159154943f + 0.5f);
  float within = clamp(angle - 6.28318531f * turns, -3.14159265f, 3.14159265f);
  float cut = 1.0f / (1.0f + exp(3.14159265f / scale)); // of the distribution, at either end
  return turns + (1.0f / (1.0f + exp(-within / scale)) - cut) / (1.0f - 2.0f * cut);
}

// The same distribution at an angle.
float strand_around(float angle, float scale)
{
  float within = angle - 6.28318531f * floor(angle * 0.159154943f + 0.5f);
  float cut = 1.0f / (1.0f + exp(3.14159265f / scale)), e = exp(-abs(within) / scale);
  return e / (scale * (1.0f + e) * (1.0f + e) * (1.0f - 2.0f * cut));
}

// What a dielectric reflects of light whose cosine to its normal is given.
float strand_fresnel(float cosine, float index)
{
  float inside = sqrt(max(index * index - 1.0f + cosine * cosine, 0.0f));
  float across = (cosine - inside) / max(cosine + inside, 1e-6f);
  float along = (index * index * cosine - inside) / max(index * index * cosine + inside, 1e-6f);
  return 0.5f * (across * across + along * along);
}

float arc_sine(float x)
{
  return atan(x, sqrt(max(1.0f - x * x, 0.0f)));
}

// What a part of a strand's width looks like from the eye: all that no light changes. Interval i lies between the
// angles number i and i + 1.
struct StrandLook {
  float sine;    // of the eye's elevation
  float cosine;
  float reflected[12]; // A_0, each by the share of the width that it is
  vec3 through[12];    // A_1
  vec3 inside[12];     // A_2
  vec3 rest;
  float outer[13]; // the angles whose sine is h, on the surface,
  float inner[13]; // and inside
};

// `sine`: of the angle between the eye and the plane across the strand. The part of the width is [low, high] in [-1, 1].
StrandLook strand_look(Fibre fibre, float sine, float low, float high)
{
  StrandLook look;
  look.sine = sine;
  look.cosine = sqrt(max(1.0f - sine * sine, 0.0f));
  look.rest = vec3(0.0f, 0.0f, 0.0f);
  float bend = look.cosine / sqrt(max(fibre.index * fibre.index - sine * sine, 1e-6f));
  float sine_inside = sine / fibre.index;
  float slant = 2.0f / sqrt(max(1.0f - sine_inside * sine_inside, 1e-6f));
  float first = arc_sine(low), step = (arc_sine(high) - first) * (1.0f / 12.0f);
  float h = low, per_width = 1.0f / max(high - low, 1e-6f);
  look.outer[0] = first;
  look.inner[0] = arc_sine(clamp(low * bend, -1.0f, 1.0f));
  for (int i = 0; i < 12; ++i) {
    float angle = look.outer[i] + step;
    float middle = angle - 0.5f * step, end = sin(angle);
    float share = (end - h) * per_width;
    h = end;
    look.outer[i + 1] = angle;
    look.inner[i + 1] = arc_sine(clamp(end * bend, -1.0f, 1.0f));
    float sine_middle = sin(middle), cosine_middle = sqrt(max(1.0f - sine_middle * sine_middle, 0.0f));
    float bent = sine_middle * bend;
    float way = slant * sqrt(max(1.0f - bent * bent, 0.0f));
    float f = strand_fresnel(look.cosine * cosine_middle, fibre.index);
    vec3 left = vec3(exp(-fibre.absorption.x * way), exp(-fibre.absorption.y * way), exp(-fibre.absorption.z * way));
    look.reflected[i] = share * f;
    look.through[i] = left * (share * (1.0f - f) * (1.0f - f));
    vec3 again = left * f;
    look.inside[i] = look.through[i] * again;
    look.rest = look.rest + look.inside[i] * again
              * vec3(1.0f / max(1.0f - again.x, 1e-6f), 1.0f / max(1.0f - again.y, 1e-6f), 1.0f / max(1.0f - again.z, 1e-6f));
  }
  return look;
}

// N_p over an interval whose ends have these middles.
float strand_part(float around, float from, float to, float turned_from, float turned_to, float scale)
{
  float width = to - from;
  // Where the middle hardly moves, the difference of two integrals is noise.
  return pick(abs(width) < 0.02f, strand_around(around - 0.5f * (from + to), scale),
              (turned_from - turned_to) / pick(abs(width) < 0.02f, 1.0f, width));
}

// What it sends to the eye of a light of irradiance 1. `sine`: of the light's elevation; `around`: the angle around the
// strand from the eye to the light, counterclockwise as seen from its tip.
vec3 strand_sent(Fibre fibre, StrandLook look, float sine, float around)
{
  float cosine = sqrt(max(1.0f - sine * sine, 0.0f));
  // Scales turn the lobes away, by 2, -1 and -4 times their tilt.
  float sine1 = fibre.tilt, cosine1 = sqrt(max(1.0f - sine1 * sine1, 0.0f));
  float sine2 = 2.0f * sine1 * cosine1, cosine2 = cosine1 * cosine1 - sine1 * sine1;
  float sine4 = 2.0f * sine2 * cosine2, cosine4 = cosine2 * cosine2 - sine2 * sine2;
  float along0 = strand_along(sine * cosine2 + cosine * sine2, abs(cosine * cosine2 - sine * sine2),
                              look.sine, look.cosine, fibre.primary);
  float along1 = strand_along(sine * cosine1 - cosine * sine1, abs(cosine * cosine1 + sine * sine1),
                              look.sine, look.cosine, 0.25f * fibre.variance);
  float along2 = strand_along(sine * cosine4 - cosine * sine4, abs(cosine * cosine4 + sine * sine4),
                              look.sine, look.cosine, 4.0f * fibre.variance);
  float along3 = strand_along(sine, cosine, look.sine, look.cosine, 4.0f * fibre.variance);
  vec3 sent = look.rest * (along3 * 0.159154943f);
  float reflected = 0.0f;
  float from0 = -2.0f * look.outer[0];
  float from1 = 3.14159265f + 2.0f * (look.inner[0] - look.outer[0]);
  float from2 = 6.28318531f + 4.0f * look.inner[0] - 2.0f * look.outer[0];
  float turned0 = strand_turned(around - from0, fibre.scale);
  float turned1 = strand_turned(around - from1, fibre.scale);
  float turned2 = strand_turned(around - from2, fibre.scale);
  vec3 through = vec3(0.0f, 0.0f, 0.0f), inside = vec3(0.0f, 0.0f, 0.0f);
  for (int i = 0; i < 12; ++i) {
    float to0 = -2.0f * look.outer[i + 1];
    float to1 = 3.14159265f + 2.0f * (look.inner[i + 1] - look.outer[i + 1]);
    float to2 = 6.28318531f + 4.0f * look.inner[i + 1] - 2.0f * look.outer[i + 1];
    float next0 = strand_turned(around - to0, fibre.scale);
    float next1 = strand_turned(around - to1, fibre.scale);
    float next2 = strand_turned(around - to2, fibre.scale);
    reflected = reflected + look.reflected[i] * strand_part(around, from0, to0, turned0, next0, fibre.scale);
    through = through + look.through[i] * strand_part(around, from1, to1, turned1, next1, fibre.scale);
    inside = inside + look.inside[i] * strand_part(around, from2, to2, turned2, next2, fibre.scale);
    from0 = to0;
    from1 = to1;
    from2 = to2;
    turned0 = next0;
    turned1 = next1;
    turned2 = next2;
  }
  sent = sent + through * along1 + inside * along2;
  reflected = reflected * along0;
  return vec3(sent.x + reflected, sent.y + reflected, sent.z + reflected);
}

// The other model, of what is no dielectric: a matt cylinder with a highlight, after Kajiya and Kay, "Rendering fur with
// three dimensional textures", 1989. What it sends of a light of irradiance 1 for an albedo of 1: Lambert's law over
// what both the light and the eye see of its part of the width.
float matt_strand(StrandLook look, float sine, float around)
{
  float cosine = sqrt(max(1.0f - sine * sine, 0.0f));
  float turn = around - 6.28318531f * floor(around * 0.159154943f + 0.5f);
  float low = max(-look.outer[12], turn - 1.57079633f), high = min(-look.outer[0], turn + 1.57079633f);
  float seen = 0.5f * ((high - low) * cos(turn) + 0.5f * (sin(2.0f * high - turn) - sin(2.0f * low - turn)));
  float width = sin(look.outer[12]) - sin(look.outer[0]);
  return 0.318309886f * cosine * pick(high > low, seen, 0.0f) / max(width, 1e-6f);
}

// Its highlight, the same all around the strand, of which light loses nothing: theirs is a power of the cosine.
float strand_highlight(StrandLook look, float sine, float variance)
{
  float cosine = sqrt(max(1.0f - sine * sine, 0.0f));
  return 0.159154943f * strand_along(sine, cosine, look.sine, look.cosine, variance);
}
