/* test_waves.c - seas against closed forms: dispersion, transfer of a piston, spectra, focus,
 * records, second order against the conditions at the free surface and at the piston; refusals.
 * SPDX-License-Identifier: BSD-3-Clause */

#include "waves_theory.h"
#include "test_allocator.h"
#include "test_fixture.h"

#include <complex.h>

#define G 9.81

static mps_waves_def regular(double depth, double height, double period) {
  DEF(waves, def, .depth = depth, .height = height, .period = period);
  return def;
}

static mps_waves_def sea(int32_t kind, double depth, double height, double period) {
  mps_waves_def def = regular(depth, height, period);
  def.kind = kind;
  return def;
}

static mps_waves *make(const mps_waves_def *def) {
  MAKE_KEPT(waves, w, create, context, def);
  return w;
}

static double period_of(double kd, double depth) {
  return 2.0 * PI / sqrt(G * kd / depth * tanh(kd));
}

/* ---- linear theory --------------------------------------------------------------------------- */

TEST(wave_lengths_are_those_of_published_tables) {
  /* Goda (2000), table of wave lengths, g 9.8 m/s2: period, depth, length */
  static const double table[][3] = {
      {2.0, 0.2, 2.71}, {2.0, 1.0, 5.21}, {2.0, 2.0, 6.05}, {2.0, 11.0, 6.24}, {5.0, 6.0, 32.17}};
  for (int k = 0; k < 5; k++) {
    const double number = theory_number(table[k][0], table[k][1], 9.8);
    NEAR(2.0 * PI / number, table[k][2], 0.0051);
  }
}

TEST(wave_numbers_solve_the_dispersion_relation) {
  for (double y = 1.1e-6; y < 9e3; y *= 1.7) { /* omega^2 d/g */
    const double depth = 3.0, omega = sqrt(y * G / depth);
    const double k = theory_number(2.0 * PI / omega, depth, G);
    NEAR(G * k * tanh(k * depth) / (omega * omega), 1.0, 1e-13);
  }
}

TEST(a_piston_has_the_transfer_of_biesel) {
  /* the sums of the evanescent modes at kd .5, 1, 1.5, 2: root finding in a program of its own */
  static const double kd[] = {0.5, 1.0, 1.5, 2.0}, C[] = {0.0045, 0.057, 0.207, 0.430};
  for (int n = 0; n < 4; n++) {
    const double T = period_of(kd[n], 0.4);
    const double far = theory_far(T, 0.4, G), near = theory_near(T, 0.4, G);
    const double s = sinh(kd[n]);
    NEAR(far, 4.0 * s * s / (sinh(2.0 * kd[n]) + 2.0 * kd[n]), 1e-13);
    NEAR(near, C[n], 6e-4 + 1e-3 * C[n]);
  }
  NEAR(theory_far(period_of(2e-3, 1.0), 1.0, G), 2e-3, 1e-8); /* long waves: a = kd X */
  NEAR(theory_far(period_of(30.0, 1.0), 1.0, G), 2.0, 1e-12); /* short waves */
}

/* Flux of energy of the waves, g a^2 cg/2, against the work of the pressure of the progressive mode
 * on the piston, both over the density: the evanescent modes do none. */
TEST(the_waves_carry_the_energy_of_the_piston) {
  for (double kd = 0.3; kd < 4.0; kd += 0.37) {
    const double d = 0.7, k = kd / d, T = period_of(kd, d), w = 2.0 * PI / T;
    const double far = theory_far(T, d, G);
    const double n = 0.5 * (1.0 + 2.0 * kd / sinh(2.0 * kd));
    const double flux = 0.5 * G * far * far * n * w / k; /* of X = 1 m, over the density */
    /* p = rho g a cosh k(z + d)/cosh kd: its integral times the velocity w X/2 */
    const double work = 0.5 * G * far * tanh(kd) / k * w;
    NEAR(work / flux, 1.0, 1e-12);
  }
}

/* ---- first order in time --------------------------------------------------------------------- */

TEST(a_linear_wave_is_its_closed_form) {
  const double d = 0.4, T = period_of(1.0, d), H = 0.04, w = 2.0 * PI / T;
  mps_waves_def def = regular(d, H, T);
  def.theory = MPS_WAVES_THEORY_LINEAR;
  def.ramp = 0.0;
  scoped_waves *sea_ = make(&def);
  double far, near;
  far = theory_far(T, d, G), near = theory_near(T, d, G);
  for (int n = 0; n < 20; n++) {
    const double t = 0.13 * n, x = 2.3;
    double eta, all, s, v, a, face;
    OK(mps_waves_get_levels(sea_, x, 1, &t, &eta, &all));
    NEAR(eta, 0.5 * H * cos(w * t - x / d), 1e-14);
    NEAR(all, eta, 0.0);
    OK(mps_waves_get_piston(sea_, 1, &t, &s, &v, &a, &face));
    NEAR(s, 0.5 * H / far * sin(w * t), 1e-14);
    NEAR(v, 0.5 * H / far * w * cos(w * t), 1e-13);
    NEAR(a, -0.5 * H / far * w * w * sin(w * t), 1e-12);
    NEAR(face, 0.5 * H * (cos(w * t) + near / far * sin(w * t)), 1e-14);
  }
  mps_waves_report r;
  OK(mps_waves_get_report(sea_, &r));
  NEAR(r.stroke[1], 0.5 * H / far, 1e-4 * H);
  NEAR(r.stroke[0], -0.5 * H / far, 1e-4 * H);
  NEAR(r.speed, 0.5 * H / far * w, 1e-3 * H * w);
  NEAR(r.wave_number, 1.0 / d, 1e-9);
}

TEST(a_signal_is_the_motion_and_its_derivatives) {
  mps_waves_def def = sea(MPS_WAVES_JONSWAP, 0.5, 0.05, 1.5);
  def.repeat = 30.0;
  mps_waves *w = make(&def);
  MAKE(signal, signal, create_waves, context, w);
  mps_waves_destroy(&w); /* the signal keeps it */
  const double h = 1e-4;
  for (int n = 0; n < 60; n++) {
    const double t = 0.11 * n + 0.05; /* through the ramp of 3 s */
    const double v =
        (mps_signal_displacement(signal, t + h) - mps_signal_displacement(signal, t - h)) /
        (2.0 * h);
    const double a =
        (mps_signal_velocity(signal, t + h) - mps_signal_velocity(signal, t - h)) / (2.0 * h);
    NEAR(mps_signal_velocity(signal, t), v, 1e-6);
    NEAR(mps_signal_acceleration(signal, t), a, 1e-5);
  }
  assert_true(mps_signal_displacement(signal, -1.0) == 0.0);
  NEAR(mps_signal_displacement(signal, 0.0), 0.0, 0.0);
  NEAR(mps_signal_displacement(signal, 10.0), mps_signal_displacement(signal, 40.0),
       1e-12); /* repeats after 30 s */
}

/* ---- spectra --------------------------------------------------------------------------------- */

static double height_of(const mps_waves *w) {
  double a[4096], sum = 0.0;
  int64_t count;
  OK(mps_waves_get_components(w, 4096, &count, NULL, a, NULL));
  for (int64_t n = 0; n < count; n++) sum += 0.5 * a[n] * a[n];
  return 4.0 * sqrt(sum);
}

TEST(spectra_have_their_height_and_shape) {
  for (int32_t kind = MPS_WAVES_JONSWAP; kind <= MPS_WAVES_PIERSON_MOSKOWITZ; kind++) {
    mps_waves_def def = sea(kind, 2.0, 0.2, 2.0);
    def.theory = MPS_WAVES_THEORY_LINEAR;
    scoped_waves *w = make(&def);
    double f[4096], a[4096];
    int64_t count;
    NEAR(height_of(w), 0.2, 1e-12);
    OK(mps_waves_get_components(w, 4096, &count, f, a, NULL));
    int64_t peak = 0, twice = -1;
    for (int64_t n = 0; n < count; n++) {
      if (a[n] > a[peak]) peak = n;
      if (fabs(f[n] - 1.0) < 1e-9) twice = n;
    }
    NEAR(f[peak], 0.5, 1e-9);
    /* S(2 fp)/S(fp) = 2^-5 exp(-5/4 (1/16 - 1)) gamma^(exp(-1/(2 .09^2)) - 1) */
    const double gamma = kind == MPS_WAVES_JONSWAP ? 3.3 : 1.0;
    const double ratio = pow(2.0, -5.0) * exp(1.25 * 15.0 / 16.0) / gamma;
    NEAR(a[twice] * a[twice] / (a[peak] * a[peak]), ratio, 1e-9);
  }
}

TEST(random_amplitudes_scatter_about_the_height) {
  double sum = 0.0, first = 0.0;
  for (int64_t seed = 1; seed <= 40; seed++) {
    mps_waves_def def = sea(MPS_WAVES_JONSWAP, 2.0, 0.2, 2.0);
    def.theory = MPS_WAVES_THEORY_LINEAR;
    def.phases = MPS_WAVES_PHASES_AMPLITUDES;
    def.seed = seed;
    scoped_waves *w = make(&def);
    const double h = height_of(w);
    if (seed == 1) first = h;
    if (seed == 2) assert_true(h != first);
    sum += h * h / 40.0;
  }
  NEAR(sqrt(sum), 0.2, 0.006); /* some 25 components of weight, 40 seas: 1.6 % */
}

TEST(a_focus_has_its_crest_where_and_when) {
  mps_waves_def def = sea(MPS_WAVES_JONSWAP, 0.4, NAN, 1.3);
  def.phases = MPS_WAVES_PHASES_FOCUSED;
  def.theory = MPS_WAVES_THEORY_LINEAR;
  def.crest = 0.06, def.position = 4.0, def.time = 12.0, def.repeat = 40.0;
  scoped_waves *w = make(&def);
  double t[2001], eta[2001];
  for (int k = 0; k < 2001; k++) t[k] = 2.0 + 0.01 * k;
  OK(mps_waves_get_levels(w, 4.0, 2001, t, eta, NULL));
  NEAR(eta[1000], 0.06, 1e-14);
  for (int k = 0; k < 2001; k++) assert_true(eta[k] <= 0.06 + 1e-14);
}

TEST(a_table_and_a_record_are_reproduced) {
  enum { N = 400 };
  static double t[N], eta[N], back[N];
  const double span = 20.0; /* waves of 11 and 17 cycles */
  for (int k = 0; k < N; k++) {
    t[k] = 3.0 + span * k / N;
    eta[k] =
        0.03 * cos(2.0 * PI * 11.0 * t[k] / span + 0.4) + 0.01 * sin(2.0 * PI * 17.0 * t[k] / span);
  }
  DEF(waves, def, .kind = MPS_WAVES_RECORD, .depth = 0.5, .theory = MPS_WAVES_THEORY_LINEAR,
      .samples = N, .times = t, .levels = eta, .position = 2.5);
  scoped_waves *w = make(&def);
  OK(mps_waves_get_levels(w, 2.5, N, t, back, NULL));
  for (int k = 0; k < N; k++) NEAR(back[k], eta[k], 1e-12);
  mps_waves_report r;
  OK(mps_waves_get_report(w, &r));
  NEAR(r.period, span / 11.0, 1e-12);
  mps_waves_destroy(&w);
  const double f[] = {0.4, 0.5, 0.9}, S[] = {0.0, 0.02, 0.0};
  def = mps_waves_defaults();
  def.kind = MPS_WAVES_SPECTRUM, def.depth = 3.0, def.theory = MPS_WAVES_THEORY_LINEAR;
  def.count = 3, def.frequency = f, def.density = S, def.repeat = 2000.0;
  w = make(&def);
  NEAR(height_of(w), 4.0 * sqrt(0.5 * 0.02 * 0.5), 1e-4); /* area of the triangle */
}

/* ---- second order ---------------------------------------------------------------------------- */

/* Stokes: a^2 k/4 cosh kd (2 + cosh 2kd)/sinh^3 kd cos 2(wt - kx). */
TEST(the_second_harmonic_is_stokes) {
  for (double kd = 0.6; kd < 3.0; kd += 0.4) {
    const double d = 0.4, T = period_of(kd, d), H = 0.02, k = kd / d, w = 2.0 * PI / T;
    const mps_waves_def def = regular(d, H, T);
    scoped_waves *s = make(&def);
    const double c = cosh(kd), h = sinh(kd);
    const double second = H * H * k / 16.0 * c * (2.0 + cosh(2.0 * kd)) / (h * h * h);
    for (int n = 0; n < 10; n++) {
      const double t = 0.17 * n, x = 1.1;
      double linear, level;
      OK(mps_waves_get_levels(s, x, 1, &t, &linear, &level));
      NEAR(level - linear, second * cos(2.0 * (w * t - k * x)), 1e-9 * second);
    }
  }
}

/* Madsen (1971): X2 = H^2/(32 d) (3 cosh kd/sinh^3 kd - 2/c0) sin 2wt, the limit of long waves. */
TEST(the_piston_of_long_waves_is_that_of_madsen) {
  static const double kd[] = {0.2, 0.3, 0.5}, bar[] = {0.002, 0.007, 0.05};
  for (int n = 0; n < 3; n++) {
    const double d = 0.4, T = period_of(kd[n], d), H = 0.002;
    mps_waves_def def = regular(d, H, T);
    def.ramp = 0.0;
    scoped_waves *s = make(&def);
    double far, sum_sin = 0.0, sum_cos = 0.0;
    far = theory_far(T, d, G);
    enum { M = 64 };
    for (int m = 0; m < M; m++) {
      const double t = T * m / M;
      double x;
      OK(mps_waves_get_piston(s, 1, &t, &x, NULL, NULL, NULL));
      sum_sin += 2.0 / M * x * sin(4.0 * PI * m / M);
      sum_cos += 2.0 / M * x * cos(4.0 * PI * m / M);
    }
    const double h = sinh(kd[n]);
    const double madsen = H * H / (32.0 * d) * (3.0 * cosh(kd[n]) / (h * h * h) - 2.0 / far);
    printf("kd %.1f: second order of the piston %.5g sin %+.2g cos, Madsen %.5g m\n", kd[n],
           sum_sin, sum_cos, madsen);
    NEAR(sum_sin / madsen, 1.0, bar[n]);
    NEAR(sum_cos / madsen, 0.0, 1e-3);
  }
}

/* ---- the stream function --------------------------------------------------------------------- */

static mps_waves_def stream(double depth, double height, double period) {
  mps_waves_def def = regular(depth, height, period);
  def.theory = MPS_WAVES_THEORY_STREAM, def.ramp = 0.0;
  return def;
}

/* raschii 2.0.0, another program of Fenton's method, 30 harmonics: height, depth, length, flux Q in
 * the frame of the wave, levels of crest, quarter and trough. The period without transport of water
 * is length depth/Q. */
TEST(waves_of_the_stream_function_are_those_of_another_program) {
  static const double table[][7] = {{0.02, 0.4, 4.0, 0.746511281, 0.010608, -0.000605, -0.009392},
                                    {0.1, 0.4, 3.0, 0.723340811, 0.059989, -0.009198, -0.040011},
                                    {0.16, 0.4, 4.0, 0.773198815, 0.111531, -0.023995, -0.048469},
                                    {0.08, 0.4, 8.0, 0.805427844, 0.059928, -0.013990, -0.020072},
                                    {0.16, 0.4, 8.0, 0.843416622, 0.131372, -0.025303, -0.028628},
                                    {0.2, 0.4, 6.0, 0.834245893, 0.159753, -0.032220, -0.040247},
                                    {2.0, 5.0, 60.0, 35.12274246, 1.459758, -0.325078, -0.540242}};
  for (size_t n = 0; n < sizeof table / sizeof *table; n++) {
    const double *row = table[n], T = row[2] * row[1] / row[3];
    const mps_waves_def def = stream(row[1], row[0], T);
    scoped_waves *s = make(&def);
    mps_waves_report report;
    OK(mps_waves_get_report(s, &report));
    NEAR(2.0 * PI / report.wave_number, row[2], 1e-7 * row[2]);
    for (int k = 0; k < 3; k++) {
      const double t = 0.0;
      double level;
      OK(mps_waves_get_levels(s, 0.25 * k * row[2], 1, &t, NULL, &level));
      NEAR(level, row[4 + k], 2e-6 * row[1]);
    }
  }
}

/* What the piston moves is what passes: its velocity is the mean of the water's over the depth at
 * its face, c eta/(depth + eta), as long as the waves are long; its way back is its way out. */
TEST(the_piston_of_long_waves_moves_with_their_flux) {
  static const double length[] = {60.0, 90.0, 120.0}; /* depths */
  for (int n = 0; n < 3; n++) {
    const double d = 0.4, L = length[n] * d, T = L / sqrt(G * d), H = 0.02;
    const mps_waves_def def = stream(d, H, T);
    scoped_waves *s = make(&def);
    mps_waves_report report;
    double worst = 0.0, fastest = 0.0, sum = 0.0;
    OK(mps_waves_get_report(s, &report));
    const double c = 2.0 * PI / T / report.wave_number;
    enum { M = 64 };
    for (int m = 0; m < M; m++) {
      const double t = T * m / M;
      double x, u, level;
      OK(mps_waves_get_piston(s, 1, &t, &x, &u, NULL, NULL));
      const double there = fabs(x), then = t - (x < 0.0 ? 2.0 * x / c : 0.0); /* station >= 0 */
      OK(mps_waves_get_levels(s, there, 1, &then, NULL, &level));
      worst = fmax(worst, fabs(u - c * level / (d + level)));
      fastest = fmax(fastest, fabs(u)), sum += u / M;
    }
    print_message("L/d %g: velocity of the piston within %.2g of the flux's\n", length[n],
                  worst / fastest);
    assert_true(worst < 0.01 * fastest && fabs(sum) < 1e-9);
  }
}

/* Low waves have the piston of second order, at any length. */
TEST(low_waves_of_the_stream_function_are_of_second_order) {
  static const double kd[] = {0.3, 0.6, 0.9};
  for (int n = 0; n < 3; n++) {
    const double d = 0.4, T = period_of(kd[n], d), H = 0.02 * d * kd[n] * kd[n];
    mps_waves_def def = stream(d, H, T);
    scoped_waves *s = make(&def);
    def.theory = MPS_WAVES_THEORY_SECOND;
    scoped_waves *low = make(&def);
    double difference = 0.0, most = 0.0;
    for (int m = 0; m < 64; m++) {
      const double t = T * m / 64;
      double x, y;
      OK(mps_waves_get_piston(s, 1, &t, &x, NULL, NULL, NULL));
      OK(mps_waves_get_piston(low, 1, &t, &y, NULL, NULL, NULL));
      difference = fmax(difference, fabs(x - y)), most = fmax(most, fabs(y));
    }
    print_message("kd %g: pistons differ by %.2g\n", kd[n], difference / most);
    assert_true(difference < 2e-3 * most);
  }
}

TEST(waves_beyond_the_stream_function_are_refused) {
  mps_waves_def def = stream(0.4, 0.08, period_of(1.2, 0.4));
  mps_waves *w = NULL;
  REFUSES(mps_waves_create(context, &def, &w), "is for k depth <= 1");
  def = stream(0.4, 0.34, 4.0);
  REFUSES(mps_waves_create(context, &def, &w), "the stream function has no such waves");
  def = stream(0.4, 0.2, 40.0);
  REFUSES(mps_waves_create(context, &def, &w), "height 0.2 m of waves of 40 s");
  def = sea(MPS_WAVES_JONSWAP, 0.4, 0.04, 2.0);
  def.theory = MPS_WAVES_THEORY_STREAM;
  REFUSES(mps_waves_create(context, &def, &w), "is for MPS_WAVES_REGULAR");
}

/* Two waves as a record, of 40 and 41 (or more) cycles. */
static mps_waves *pair(double d, double a, double kd, int first, int second, int32_t theory) {
  enum { N = 4096 };
  static double t[N], eta[N];
  const double span = first * period_of(kd, d);
  for (int k = 0; k < N; k++) {
    t[k] = span * k / N;
    eta[k] = a * cos(2.0 * PI * first * k / N) + a * cos(2.0 * PI * second * k / N);
  }
  DEF(waves, def, .kind = MPS_WAVES_RECORD, .depth = d, .theory = theory,
      .period = period_of(kd, d), .ramp = 0.0, .lower = 0.9, .upper = 1.5, .samples = N, .times = t,
      .levels = eta);
  return make(&def);
}

/* Amplitude of a number of cycles in `span`. */
static double complex cycles(int count, const double *value, int n) {
  double complex sum = 0.0;
  for (int k = 0; k < count; k++)
    sum += 2.0 / count * value[k] * cexp(-2.0 * PI * I * n * k / count);
  return sum;
}

TEST(close_frequencies_have_the_limits_of_a_narrow_band) {
  enum { N = 1024 };
  static double t[N], linear[N], level[N], x[N];
  const double d = 0.4, kd = 0.8, a = 0.004, span = 40.0 * period_of(kd, d);
  double complex wave[2], piston[2];
  for (int k = 0; k < N; k++) t[k] = span * k / N;
  for (int theory = 0; theory < 2; theory++) {
    mps_waves *w =
        pair(d, a, kd, 40, 41, theory ? MPS_WAVES_THEORY_NARROW : MPS_WAVES_THEORY_SECOND);
    OK(mps_waves_get_levels(w, 0.0, N, t, linear, level));
    OK(mps_waves_get_piston(w, N, t, x, NULL, NULL, NULL));
    for (int k = 0; k < N; k++) level[k] -= linear[k];
    wave[theory] = cycles(N, level, 1);
    piston[theory] = cycles(N, x, 1);
    mps_waves_destroy(&w);
  }
  printf("difference wave: %.5g and %.5g mm, piston %.5g and %.5g mm\n", 1e3 * creal(wave[0]),
         1e3 * creal(wave[1]), 1e3 * cimag(piston[0]), 1e3 * cimag(piston[1]));
  NEAR(cabs(wave[0] / wave[1] - 1.0), 0.0, 0.05);
  NEAR(cabs(piston[0] / piston[1] - 1.0), 0.0, 0.12);
}

/* ---- the conditions at the free surface, by finite differences ------------------------------- */

/* Amplitude of `n` cycles in the level of second order at x. */
static double complex second_of(const mps_waves *w, double x, double span, int n) {
  enum { N = 1024 };
  static double t[N], linear[N], level[N];
  for (int k = 0; k < N; k++) t[k] = span * k / N;
  OK(mps_waves_get_levels(w, x, N, t, linear, level));
  for (int k = 0; k < N; k++) level[k] -= linear[k];
  return cycles(N, level, n);
}

/* Levels of second order fulfil the kinematic condition with the potential that the dynamic one
 * gives: eta2_t - phi2_z = -(eta1 phi1_x)_x, g eta2 + phi2_t = -eta1 phi1_zt - (phi1_x^2 +
 * phi1_z^2)/2, mode by mode of frequency W and wave number K, phi2_z = K tanh(K d) phi2. */
TEST(bound_waves_fulfil_the_surface_conditions) {
  const double d = 0.4, a = 0.004, kd = 0.9;
  const int first = 40, second = 53;
  const double span = first * period_of(kd, d);
  scoped_waves *s = pair(d, a, kd, first, second, MPS_WAVES_THEORY_SECOND);
  const double w[2] = {2.0 * PI * first / span, 2.0 * PI * second / span};
  double k[2];
  for (int n = 0; n < 2; n++) k[n] = theory_number(2.0 * PI / w[n], d, G);
  for (int sign = -1; sign <= 1; sign += 2) {
    const double W = w[1] + sign * w[0], K = k[1] + sign * k[0];
    /* eta = a cos, phi = a g/w sin(...) (theta = k x - w t): products at the pair's frequency, x =
     * 0; amplitudes of cos(W t) for levels, of sin for potentials of -(w t) */
    const double level = creal(second_of(s, 0.0, span, second + sign * first));
    /* products of two cosines: half of cos of the sum or difference, and both orders */
    const double u0 = a * G * k[0] / w[0], u1 = a * G * k[1] / w[1]; /* phi_x = u cos */
    const double v0 = a * w[0], v1 = a * w[1];                       /* phi_z = v sin(kx - wt) */
    const double quadratic = 0.5 * (u0 * u1 * 1.0) + sign * -0.5 * v0 * v1;
    /* phi_zt = -w^2 a cos: eta1 phi_zt of both orders */
    const double bend = -0.5 * a * a * (w[0] * w[0] + w[1] * w[1]);
    /* dynamic: g level + phi2_t = -bend - quadratic, phi2 = P sin(Kx - Wt), phi2_t = -W P cos */
    const double P = (G * level + bend + quadratic) / W;
    /* kinematic: eta2_t + (eta1 phi1_x)_x = phi2_z at sin(Kx - Wt): W level - K flux = K tanh P */
    const double flux = 0.5 * a * (u0 + u1);
    const double left = W * level - K * flux, right = K * tanh(K * d) * P;
    printf("%s: level %.6g mm, sides of the kinematic condition %.9g and %.9g\n",
           sign < 0 ? "difference" : "sum", 1e3 * level, left, right);
    NEAR(left, right, 1e-9 * (fabs(W * level) + fabs(K * flux)));
  }
}

/* ---- a solitary wave --------------------------------------------------------------------------
 */

/* The piston follows the mean velocity of the water at its face, and displaces the water of the
 * wave, 2 H/k. */
TEST(a_solitary_wave_is_the_water_that_its_piston_displaces) {
  static const double depth[] = {0.2, 0.4, 5.0}, ratio[] = {0.1, 0.3, 0.7};
  for (int n = 0; n < 9; n++) {
    const double d = depth[n / 3], H = ratio[n % 3] * d, c = sqrt(G * (d + H));
    DEF(waves, def, .kind = MPS_WAVES_SOLITARY, .depth = d, .height = H);
    scoped_waves *w = make(&def);
    mps_waves_report r;
    OK(mps_waves_get_report(w, &r));
    NEAR(r.wave_number, sqrt(0.75 * H / d) / d, 1e-12 / d);
    double volume = 0.0, highest = 0.0;
    for (int k = 0; k <= 4000; k++) {
      const double step = r.repeat / 4000.0, t[] = {k * step, (k + 0.01) * step, (k + 0.02) * step};
      double x[3], u[3], a[3], face[3], there;
      OK(mps_waves_get_piston(w, 3, t, x, u, a, face));
      OK(mps_waves_get_levels(w, x[1], 1, &t[1], NULL, &there));
      NEAR(there, face[1], 1e-9 * H);
      NEAR(u[1], c * there / (d + there), 1e-9 * c);
      NEAR((x[2] - x[0]) / (0.02 * step), u[1], 1e-6 * c);
      NEAR((u[2] - u[0]) / (0.02 * step), a[1], 1e-5 * G);
      volume += u[0] * d * step, highest = fmax(highest, face[0]);
    }
    NEAR(highest, H, 1e-5 * H);
    NEAR(volume, 2.0 * H / r.wave_number, 2e-3 * H / r.wave_number);
    NEAR(r.stroke[1], 2.0 * H / (r.wave_number * d), 2e-3 * r.stroke[1]);
  }
}

/* ---- refusals -------------------------------------------------------------------------------- */

TEST(wrong_definitions_are_named) {
  scoped_waves *w = NULL;
  mps_waves_def def;
#define REFUSED(change, text)                                                                      \
  do {                                                                                             \
    def = regular(0.4, 0.04, 1.3);                                                                 \
    change;                                                                                        \
    REFUSES(mps_waves_create(context, &def, &w), text);                                            \
    assert_null(w);                                                                                \
  } while (0)
  REFUSED(def.height = 0.3, "breaking");
  REFUSED((def.period = 4.0, def.height = 0.1), "26.3");
  REFUSED(def.stroke = 0.001, "stroke is 0.001 m");
  REFUSED(def.speed = 0.01, "speed is 0.01 m/s");
  REFUSED((def.kind = 1, def.repeat = 1e5), "components");
  REFUSED((def.kind = MPS_WAVES_SOLITARY, def.period = NAN, def.height = 0.3),
          "height 0.3 m of the solitary wave must be at most 0.28 m");
  REFUSED(def.kind = MPS_WAVES_SOLITARY, "period");
  REFUSED((def.kind = MPS_WAVES_SOLITARY, def.period = NAN, def.theory = MPS_WAVES_THEORY_STREAM),
          "theory");
  /* seas that cannot be: Hm0 above a wave that breaks, crests above any, a level in mm or below the
   * bed, a piston that the water does not follow */
  double t[64], level[64];
  for (int k = 0; k < 64; k++) t[k] = 0.1 * k, level[k] = 40.0 * cos(2.0 * PI * k / 16.0);
  REFUSED((def.kind = 1, def.height = 5.0),
          "height Hm0 5 m of the sea is above the breaking height");
  REFUSED((def.kind = 2, def.height = 5.0),
          "height Hm0 5 m of the sea is above the breaking height");
  REFUSED((def.kind = 1, def.phases = 2, def.crest = 2.5, def.time = 9.0, def.position = 3.0),
          "crest is 2.5 m, must be at most 0.178");
  REFUSED((def.kind = 4, def.samples = 64, def.times = t, def.levels = level),
          "levels are from -40 to 40 m, must be above the bed at -0.4 m");
  for (int k = 0; k < 64; k++) level[k] *= 0.3 / 40.0;
  REFUSED((def.kind = 4, def.samples = 64, def.times = t, def.levels = level),
          "less than 0.356885 m from trough to crest");
  for (int k = 0; k < 64; k++) level[k] *= 0.14 / 0.3;
  REFUSED((def.kind = 4, def.samples = 64, def.times = t, def.levels = level, def.period = NAN),
          "height Hm0 0.39");
#undef REFUSED
  def = regular(0.4, 0.04, 1.3);
  w = make(&def);
  double value, when = NAN;
  REFUSES(mps_waves_get_levels(w, -1.0, 0, NULL, NULL, NULL), "station");
  REFUSES(mps_waves_get_levels(w, 1.0, 1, &when, &value, NULL), "t[0]");
  REFUSES(mps_waves_get_piston(w, -1, NULL, NULL, NULL, NULL, NULL), "count");
}

static mps_status make_all(mps_context *own, int what) {
  mps_waves_def def = sea(MPS_WAVES_JONSWAP, 0.4, 0.04, 1.3);
  def.repeat = 10.0;
  scoped_waves *w = NULL;
  scoped_signal *signal = NULL;
  scoped_absorber *absorber = NULL;
  mps_status status = mps_waves_create(own, &def, &w);
  if (status == MPS_OK) status = mps_signal_create_waves(own, w, &signal);
  DEF(absorber, end, .depth = 0.4, .waves = w);
  if (status == MPS_OK) status = mps_absorber_create(own, &end, &absorber);
  return status;
}

TEST(refused_memory_is_an_error_without_a_leak) { test_allocator_sweep(make_all, 0); }
