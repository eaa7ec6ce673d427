// SPDX-License-Identifier: GPL-3.0-or-later
// Complex numbers, as far as the poles of poles.glsl and ellipse.glsl need them.

struct Complex {
  float re;
  float im;
};

Complex complex(float re, float im)
{
  Complex z;
  z.re = re;
  z.im = im;
  return z;
}

Complex complex_add(Complex a, Complex b)
{
  return complex(a.re + b.re, a.im + b.im);
}

Complex complex_sub(Complex a, Complex b)
{
  return complex(a.re - b.re, a.im - b.im);
}

Complex complex_scale(float x, Complex a)
{
  return complex(x * a.re, x * a.im);
}

Complex complex_mul(Complex a, Complex b)
{
  return complex(a.re * b.re - a.im * b.im, a.re * b.im + a.im * b.re);
}

float complex_norm(Complex a) // squared magnitude
{
  return a.re * a.re + a.im * a.im;
}

// A division by zero gives a large number instead of a NaN.
Complex complex_div(Complex a, Complex b)
{
  float inverse = 1.0f / max(complex_norm(b), 1e-37f);
  return complex((a.re * b.re + a.im * b.im) * inverse, (a.im * b.re - a.re * b.im) * inverse);
}

// The root with the positive real part. The larger of its parts is a root of a sum, the other follows from their
// product: neither cancels.
Complex complex_sqrt(Complex a)
{
  float larger = sqrt(0.5f * (sqrt(complex_norm(a)) + abs(a.re)));
  float smaller = 0.5f * abs(a.im) / max(larger, 1e-30f);
  return complex(pick(a.re < 0.0f, smaller, larger),
                 pick(a.im < 0.0f, -1.0f, 1.0f) * pick(a.re < 0.0f, larger, smaller));
}

// atan(q/p) with its real part in [-pi/2, pi/2]: 2 Re is the angle, and -2 Im the logarithm of the magnitude, of
// (p + i q)/(p - i q). Small q/p keep their relative precision.
Complex complex_atan(Complex q, Complex p)
{
  float p2 = complex_norm(p);
  float q2 = complex_norm(q);
  float y = 2.0f * (p.re * q.re + p.im * q.im);
  float x = p2 - q2;
  float angle = atan(y, pick(abs(x) + abs(y) > 0.0f, x, 1.0f));
  return complex(0.5f * angle, -0.5f * atanh(2.0f * (p.im * q.re - p.re * q.im) / max(p2 + q2, 1e-37f)));
}
