/* test_absorber.c - absorbing pistons in linear theory, step by step; separation of incident and
 * reflected waves of known parts; memory and refusals.
 * SPDX-License-Identifier: BSD-3-Clause */

#include "waves_theory.h"
#include "test_fixture.h"

#include <complex.h>

#define G 9.81

static double period_of(double kd, double depth) {
  return 2.0 * PI / sqrt(G * kd / depth * tanh(kd));
}

static mps_absorber *make(const mps_absorber_def *def) {
  MAKE_KEPT(absorber, a, create, context, def);
  return a;
}

/* A wave a_i comes to the piston; the level at its face is that wave, its reflection at a wall, 2
 * a_i cos wt, and what the piston itself sends: c0 times its displacement a quarter of a period
 * later, and C in phase. In steady state the reflected amplitude is |a_i + i c0 X|. */
static double reflect(int32_t form, double kd, double depth, double limit, int64_t *limited) {
  DEF(absorber, def, .form = form, .depth = depth, .period = period_of(kd, depth),
      .acceleration = limit);
  scoped_absorber *end = make(&def);
  double far, near;
  far = theory_far(def.period, depth, G), near = theory_near(def.period, depth, G);
  const double a = 0.01, w = 2.0 * PI / def.period, dt = def.period / 10000.0;
  double s = 0.0, u = 0.0, expected;
  double complex X = 0.0;
  const int warm = 150, all = 160; /* periods */
  for (int n = 0; n < all * 10000; n++) {
    const double t = n * dt;
    /* harmonic motion: X = Re Xc exp(iwt), Xc from displacement and velocity */
    const double complex now = (s - I * u / w) * cexp(-I * w * t);
    const double level = creal((2.0 * a + I * far * now + near * now) * cexp(I * w * t));
    OK(mps_absorber_advance(end, t, dt, level, &s, &u));
    if (n >= warm * 10000) X += now / ((all - warm) * 10000.0);
  }
  mps_absorber_report r;
  OK(mps_absorber_get_report(end, &r));
  *limited = r.limited;
  OK(mps_absorber_get_reflection(end, def.period, &expected));
  const double R = cabs(a + I * far * X) / a;
  printf("form %d, kd %.1f: reflection %.4f, theory %.4f\n", form, kd, R, expected);
  if (isnan(limit)) NEAR(R, expected, 0.003);
  return R;
}

TEST(pistons_reflect_what_theory_says) {
  int64_t limited;
  for (double kd = 0.5; kd < 2.1; kd *= 2.0) {
    const double shallow = reflect(MPS_ABSORBER_FORM_SHALLOW, kd, 0.4, NAN, &limited);
    const double tuned = reflect(MPS_ABSORBER_FORM_TUNED, kd, 0.4, NAN, &limited);
    assert_true(limited < 5000); /* of 1.6e6, as the level begins with a jump */
    assert_true(tuned < 0.01);
    if (kd > 1.9) assert_true(shallow > 0.15);
  }
  (void)reflect(MPS_ABSORBER_FORM_SHALLOW, 1.0, 0.4, 1e-3, &limited);
  assert_true(limited > 1000);
}

/* Published: at kd .5, 1 and 2 the shallow form has 2.0, 6.6 and 16.8 %, without leak. */
TEST(theory_has_its_closed_form) {
  static const double kd[] = {0.5, 1.0, 2.0}, R[] = {0.020, 0.066, 0.168};
  for (int n = 0; n < 3; n++) {
    DEF(absorber, def, .depth = 0.4, .period = period_of(kd[n], 0.4), .leak = 0.0);
    scoped_absorber *a = make(&def);
    double r;
    OK(mps_absorber_get_reflection(a, def.period, &r));
    NEAR(r, R[n], 6e-4);
    mps_absorber_destroy(&a);
    def.form = MPS_ABSORBER_FORM_TUNED;
    a = make(&def);
    OK(mps_absorber_get_reflection(a, def.period, &r));
    NEAR(r, 0.0, 1e-9);
  }
}

/* Two pistons that move together leave the level as it is: a displacement of the correction must
 * fade, not feed itself through the evanescent level. */
TEST(pistons_do_not_run_away_together) {
  for (double kd = 0.5; kd < 6.0; kd *= 1.3) {
    DEF(absorber, def, .form = MPS_ABSORBER_FORM_TUNED, .depth = 0.4, .period = period_of(kd, 0.4));
    mps_absorber *a = make(&def);
    const double memory[MPS_ABSORBER_MEMORY] = {0.01, 0.0, 0.01, 0.01, 0.0};
    const double dt = def.period / 300.0;
    double s = 0.0, u = 0.0, most = 0.0;
    OK(mps_absorber_set_memory(a, memory));
    for (int n = 0; n < 30 * 300; n++) {
      OK(mps_absorber_advance(a, n * dt, dt, 0.0, &s, &u));
      most = fmax(most, fabs(s));
    }
    assert_true(most < 0.04); /* of .01: it grows with s C/(f - s C), at most 1, and then leaks */
    assert_true(fabs(s) < 0.7 * most && fabs(u) < 1e-2 * most * 2.0 * PI / def.period);
    mps_absorber_destroy(&a);
    def.high_pass = 1e-3;
    REFUSES(mps_absorber_create(context, &def, &a), "high_pass");
  }
}

/* Where the level is the one asked for, the motion is the one asked for; it stays within the
 * stroke. */
TEST(the_sea_asked_for_is_made) {
  DEF(waves, sea, .depth = 0.4, .height = 0.05, .period = 1.4);
  MAKE(waves, w, create, context, &sea);
  DEF(absorber, def, .depth = 0.4, .waves = w, .stroke = 0.2);
  scoped_absorber *a = make(&def);
  double s = 0.0, u = 0.0;
  const double dt = 1e-3;
  for (int n = 0; n < 8000; n++) {
    double level, asked, speed;
    const double t = n * dt, next = t + dt;
    OK(mps_waves_get_piston(w, 1, &t, NULL, NULL, NULL, &level));
    OK(mps_absorber_advance(a, t, dt, level, &s, &u));
    OK(mps_waves_get_piston(w, 1, &next, &asked, &speed, NULL, NULL));
    NEAR(s, asked, 1e-6);
    NEAR(u, speed, 1e-5);
  }
  for (int n = 0; n < 20000; n++) { /* a level that stays low drives it in, to its stroke */
    OK(mps_absorber_advance(a, 8.0 + n * dt, dt, -0.3, &s, &u));
    assert_true(fabs(s) <= 0.2);
  }
  mps_absorber_report r;
  OK(mps_absorber_get_report(a, &r));
  assert_true(r.limited > 0 && s > 0.1);
}

TEST(memory_continues_bit_for_bit) {
  DEF(absorber, def, .form = MPS_ABSORBER_FORM_TUNED, .depth = 0.4, .period = 1.3);
  scoped_absorber *one = make(&def), *two = make(&def);
  double s, u, other[2], memory[MPS_ABSORBER_MEMORY];
  for (int n = 0; n < 500; n++)
    OK(mps_absorber_advance(one, 0.01 * n, 0.01, 0.02 * sin(0.05 * n), &s, &u));
  OK(mps_absorber_get_memory(one, memory));
  OK(mps_absorber_set_memory(two, memory));
  for (int n = 500; n < 700; n++) {
    const double level = 0.02 * sin(0.05 * n);
    OK(mps_absorber_advance(one, 0.01 * n, 0.01, level, &s, &u));
    OK(mps_absorber_advance(two, 0.01 * n, 0.01, level, &other[0], &other[1]));
    assert_true(s == other[0] && u == other[1]);
  }
  memory[1] = NAN;
  FAILS(mps_absorber_set_memory(two, memory), MPS_ERROR_FORMAT, "values[1]");
  memory[1] = 0.0, memory[0] = 3.0;
  FAILS(mps_absorber_set_memory(two, memory), MPS_ERROR_FORMAT, "stroke");
}

TEST(wrong_steps_are_refused) {
  DEF(absorber, def, .depth = 0.4, .period = 1.3);
  scoped_absorber *a = make(&def);
  double s = 7.0, u = 7.0;
  REFUSES(mps_absorber_advance(a, 0.0, 0.0, 0.0, &s, &u), "dt");
  REFUSES(mps_absorber_advance(a, NAN, 0.1, 0.0, &s, &u), "t is");
  REFUSES(mps_absorber_advance(a, 0.0, 0.1, INFINITY, &s, &u), "level");
  assert_true(s == 7.0 && u == 7.0);
  OK(mps_absorber_advance(a, 0.0, 0.1, NAN, &s, &u)); /* no surface */
  assert_true(s == 0.0 && u == 0.0);
}

/* ---- separation ------------------------------------------------------------------------------ */

enum { GAUGES = 4, SAMPLES = 3000, WAVES = 3 };

typedef struct field {
  double times[SAMPLES], levels[SAMPLES * GAUGES];
} field;

static const double gauge[GAUGES] = {3.0, 3.25, 3.7, 4.4};
static const double amplitude[WAVES] = {0.03, 0.02, 0.01}, back[WAVES] = {0.3, 0.6, 0.05};
static const int waves[WAVES] = {25, 31, 40}; /* cycles in 40 s */

/* Uneven times; levels of incident and reflected waves with phases. */
static mps_separation_def fill(field *f) {
  for (int64_t n = 0; n < SAMPLES; n++) {
    f->times[n] = 41.0 * (n + 0.3 * sin(7.0 * n)) / SAMPLES - 0.1;
    for (int p = 0; p < GAUGES; p++) {
      double eta = 0.005;
      for (int m = 0; m < WAVES; m++) {
        const double w = 2.0 * PI * waves[m] / 40.0;
        const double k = theory_number(2.0 * PI / w, 0.5, G);
        eta += amplitude[m] * cos(w * f->times[n] - k * gauge[p] + m) +
               amplitude[m] * back[m] * cos(w * f->times[n] + k * gauge[p] + 2.0 * m);
      }
      f->levels[n * GAUGES + p] = eta;
    }
  }
  DEF(separation, def, .gauges = GAUGES, .depth = 0.5, .position = gauge, .samples = SAMPLES,
      .times = f->times, .levels = f->levels, .from = 0.5, .to = 40.5, .lower = 0.4, .upper = 1.2);
  return def;
}

TEST(known_parts_are_found_again) {
  field *f = calloc(1, sizeof *f);
  mps_separation_def def = fill(f);
  double frequency[64], incident[64], reflected[64], in = 0.0, out = 0.0;
  int64_t count;
  mps_separation r;
  OK(mps_separation_find(context, &def, 64, &count, frequency, incident, reflected, &r));
  assert_int_equal(count, r.bands);
  for (int64_t n = 0; n < count; n++)
    for (int m = 0; m < WAVES; m++)
      if (fabs(frequency[n] - waves[m] / 40.0) < 1e-9) {
        NEAR(incident[n], amplitude[m], 2e-3 * amplitude[m]);
        NEAR(reflected[n], amplitude[m] * back[m], 2e-3 * amplitude[m]);
      }
  for (int m = 0; m < WAVES; m++) {
    in += 0.5 * amplitude[m] * amplitude[m];
    out += 0.5 * amplitude[m] * amplitude[m] * back[m] * back[m];
  }
  NEAR(r.incident_height, 4.0 * sqrt(in), 2e-3 * 4.0 * sqrt(in));
  NEAR(r.reflection, sqrt(out / in), 2e-3);
  NEAR(r.residual, 0.0, 1e-4);
  NEAR(r.peak_period, 1.6, 1e-2);
  double moment = 0.0;
  for (int m = 0; m < WAVES; m++) moment += 0.5 * amplitude[m] * amplitude[m] * 40.0 / waves[m];
  NEAR(r.energy_period, moment / in, 2e-3);
  free(f);
}

TEST(gauges_half_a_wave_apart_are_left_out) {
  field *f = calloc(1, sizeof *f);
  mps_separation_def def = fill(f);
  double k;
  mps_separation r;
  k = theory_number(40.0 / 31.0, 0.5, G);
  const double two[2] = {3.0, 3.0 + PI / k};
  def.gauges = 2, def.position = two, def.samples = SAMPLES;
  for (int64_t n = 0; n < SAMPLES; n++)
    for (int p = 0; p < 2; p++) f->levels[2 * n + p] = 0.01 * cos(f->times[n]);
  OK(mps_separation_find(context, &def, 0, NULL, NULL, NULL, NULL, &r));
  assert_true(r.unresolved >= 1 && r.unresolved < r.bands);
#define REFUSED(change, text)                                                                      \
  do {                                                                                             \
    def = fill(f);                                                                                 \
    change;                                                                                        \
    REFUSES(mps_separation_find(context, &def, 0, NULL, NULL, NULL, NULL, &r), text);              \
  } while (0)
  const double same[GAUGES] = {1.0, 2.0, 3.0, 2.0};
  REFUSED(def.position = same, "position[1] and position[3]");
  REFUSED(def.upper = 40.0, "upper");
  REFUSED(def.to = 50.0, "to");
  REFUSED((def.lower = 0.501, def.upper = 0.502), "no multiple");
  REFUSED(f->levels[7] = NAN, "levels[7]");
#undef REFUSED
  free(f);
}
