// SPDX-License-Identifier: GPL-3.0-or-later
// Single scattering along a view ray, by marching.
//
// The radiance that reaches the eye from a stretch of smoke [0, S], in one colour, is
//     L = sum over lights of  int_0^S sigma_s(s) p(s) E(s) exp(-tau_eye(s)) exp(-tau_light(s)) ds ,
// with the phase function p, the light's irradiance E on whatever faces it, and the optical depths of the smoke before
// the eye and before the light.

// The number of equal steps, none longer than `step_length`, that a stretch is cut into. Both are measured in cells, so
// that a grid that is flattened in the world costs what it costs unflattened.
float march_steps(float stretch, float step_length)
{
  return max(ceil(stretch / step_length - 1e-3f), 1.0f);
}

// What a step of optical depth tau sends to the eye per unit of p E. Its smoke scatters the optical depth
// `scattering`; on the way to the middle of the step the light has crossed tau_light of smoke.
// Cells hold the optical depth towards the light rather than the transmittance, because that is what varies linearly
// inside dense smoke: interpolating transmittances half an optical depth apart is 3 % too bright in the middle.
//
// With constant densities the integral over the step is scattering / tau exp(-tau_light - tau_eye) (1 - exp(-tau)). We
// write 1 - exp(-tau) = exp(-tau / 2) 2 sinh(tau / 2) and expand sinh: one exponential serves the whole step, and the
// error is below 2e-8 of the step for tau < 1 and 5e-4 at tau = 4.
float scattered_by_step(float scattering, float tau, float tau_eye, float tau_light)
{
  float x2 = tau * tau;
  float two_sinh_over_tau = 1.0f + x2 * (1.0f / 24.0f) * (1.0f + x2 * (1.0f / 80.0f) * (1.0f + x2 * (1.0f / 168.0f)));
  return scattering * two_sinh_over_tau * exp(-(tau_eye + 0.5f * tau + tau_light));
}

// The same in each colour.
vec3 scattered_by_step(float scattering, vec3 tau, vec3 tau_eye, vec3 tau_light)
{
  return vec3(scattered_by_step(scattering, tau.x, tau_eye.x, tau_light.x),
              scattered_by_step(scattering, tau.y, tau_eye.y, tau_light.y),
              scattered_by_step(scattering, tau.z, tau_eye.z, tau_light.z));
}
