/* test_finite.c - what MPS_OK promises of functions of numbers alone: for arguments of any size,
 * from denormals to the largest double, they answer with finite numbers or refuse. Arguments are
 * usual ones of which up to four are replaced or scaled by an extreme.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "core/context/retain.h"
#include "waves_theory.h"
#include "test_fixture.h"

static uint64_t seed;

static uint64_t draw(uint64_t n) {
  seed = seed * 6364136223846793005u + 1442695040888963407u;
  return (seed >> 33) % n;
}

static double extreme(void) {
  static const double values[] = {0.0,   5e-324, 1e-310, 1e-300, 1e-200,   1e-163, 1e-154, 1e-100,
                                  1e-30, 1e-12,  1e-6,   1e-3,   0.1,      0.5,    1.0,    2.0,
                                  10.0,  1e3,    1e6,    1e12,   1e18,     1e30,   1e100,  1e154,
                                  1e163, 1e200,  1e300,  1e305,  1.797e308};
  const double value = values[draw(sizeof values / sizeof *values)];
  return draw(6) == 0 ? -value : value;
}

/* Of `count` arguments about one in three is bent. */
static void bend(double *values, int count) {
  const uint64_t bent = draw(4);
  for (uint64_t k = 0; k <= bent; k++) {
    const int at = (int)draw((uint64_t)count);
    if (draw(3) == 0) continue;
    values[at] = draw(3) == 0 ? values[at] * extreme() : extreme();
  }
}

static int64_t answers;

/* Every number of an answer. */
static void finite(const char *what, const double *values, int64_t count, const double *of, int n) {
  answers++;
  for (int64_t k = 0; k < count; k++)
    if (!isfinite(values[k])) {
      for (int i = 0; i < n; i++) print_error("argument %d: %.17g\n", i, of[i]);
      fail_msg("%s: number %d of the answer is %g", what, (int)k, values[k]);
    }
}

/* ---- waves ----------------------------------------------------------------------------------- */

static void linear_theory(void) {
  double a[3] = {2.0, 1.0, 9.81}, out[2];
  bend(a, 3);
  const double y = theory_y(a[0], a[1], a[2]);
  if (!(y >= MPSI_WAVES_SHALLOWEST && y <= MPSI_WAVES_DEEPEST)) return;
  for (int k = 0; k < 3; k++)
    if (!(a[k] >= 1e-12 && a[k] <= 1e12)) return;
  out[0] = theory_number(a[0], a[1], a[2]);
  finite("wave number", out, 1, a, 3);
  out[0] = theory_far(a[0], a[1], a[2]), out[1] = theory_near(a[0], a[1], a[2]);
  finite("transfer of a piston", out, 2, a, 3);
}

static void seas(void) {
  enum { N = 12, ROWS = 5 };
  double a[N] = {0.4, 9.81, 0.05, 1.4, 3.3, 40.0, 0.05, 3.0, 10.0, 2.0, 0.6, 2.5};
  double f[ROWS] = {0.3, 0.5, 0.7, 0.9, 1.2}, s[ROWS] = {0.0, 1e-4, 2e-4, 1e-4, 0.0};
  bend(a, N);
  if (draw(4) == 0) bend(s, ROWS);
  DEF(waves, d, .kind = (int32_t)draw(4), .phases = d.kind == 0 ? 0 : (int32_t)draw(3),
      .theory = (int32_t)draw(3), .depth = a[0], .gravity = a[1], .height = draw(5) ? a[2] : NAN,
      .period = a[3], .gamma = a[4], .repeat = d.kind ? a[5] : NAN, .crest = a[6],
      .position = a[7]);
  d.time = a[8], d.ramp = draw(2) ? a[9] : NAN, d.lower = a[10], d.upper = a[11];
  d.count = ROWS, d.frequency = f, d.density = s;
  scoped_waves *w = NULL;
  if (a[5] / a[3] > 60.0 || mps_waves_create(context, &d, &w) != MPS_OK) return;
  mps_waves_report r;
  double amplitude[64], phase[64], frequency[64];
  double t[4] = {0.0, 1.0, extreme(), -extreme()}, m[4][4], level[2][4];
  int64_t count = 0;
  OK(mps_waves_get_report(w, &r));
  const double numbers[] = {r.period,    r.wave_number, r.height,       r.repeat,
                            r.stroke[0], r.stroke[1],   r.acceleration, r.speed};
  finite("mps_waves_get_report", numbers, 8, a, N);
  OK(mps_waves_get_components(w, 64, &count, frequency, amplitude, phase));
  if (count > 64) count = 64;
  finite("amplitudes of mps_waves_get_components", amplitude, count, a, N);
  finite("phases of mps_waves_get_components", phase, count, a, N);
  if (mps_waves_get_piston(w, 4, t, m[0], m[1], m[2], m[3]) == MPS_OK)
    finite("mps_waves_get_piston", m[0], 16, t, 4);
  if (mps_waves_get_levels(w, fabs(extreme()), 4, t, level[0], level[1]) == MPS_OK)
    finite("mps_waves_get_levels", level[0], 8, t, 4);
}

static void absorbers(void) {
  double a[7] = {0.4, 9.81, 1.4, 1.0, 0.02, 0.3, 20.0};
  bend(a, 7);
  DEF(absorber, d, .form = (int32_t)draw(2), .depth = a[0], .gravity = a[1], .period = a[2]);
  if (draw(2)) d.high_pass = a[3];
  if (draw(2)) d.leak = a[4];
  if (draw(2)) d.stroke = a[5];
  if (draw(2)) d.acceleration = a[6];
  scoped_absorber *piston = NULL;
  if (mps_absorber_create(context, &d, &piston) != MPS_OK) return;
  double t = 0.0, m[2], reflection;
  for (int k = 0; k < 4; k++) {
    double step[2] = {1e-3, 0.01};
    if (k > 0) bend(step, 2);
    if (mps_absorber_advance(piston, t, step[0], step[1], m, m + 1) != MPS_OK) continue;
    finite("mps_absorber_advance", m, 2, step, 2);
    t += step[0];
  }
  if (mps_absorber_get_reflection(piston, fabs(extreme()), &reflection) == MPS_OK)
    finite("mps_absorber_get_reflection", &reflection, 1, a, 7);
}

static void gauges(void) {
  enum { SAMPLES = 24, GAUGES = 3 };
  double a[4] = {0.4, 9.81, 0.3, 2.0}, x[GAUGES] = {1.0, 1.3, 1.75};
  double t[SAMPLES], level[SAMPLES * GAUGES], out[3][32];
  for (int k = 0; k < SAMPLES; k++)
    for (int g = 0; g < GAUGES; g++) {
      t[k] = 0.1 * k;
      level[GAUGES * k + g] = 0.02 * sin(6.0 * t[k] - 3.0 * x[g]);
    }
  bend(a, 4);
  if (draw(2)) bend(x, GAUGES);
  if (draw(2)) bend(level, SAMPLES * GAUGES);
  if (draw(6) == 0) bend(t, SAMPLES);
  DEF(separation, d, .gauges = GAUGES, .depth = a[0], .gravity = a[1], .lower = a[2], .upper = a[3],
      .position = x, .samples = SAMPLES, .times = t, .levels = level);
  mps_separation r;
  int64_t count = 0;
  if (mps_separation_find(context, &d, 32, &count, out[0], out[1], out[2], &r) != MPS_OK) return;
  if (count > 32) count = 32;
  for (int k = 0; k < 3; k++) finite("spectra of mps_separation_find", out[k], count, a, 4);
  const double numbers[] = {r.incident_height, r.reflected_height};
  finite("mps_separation_find", numbers, 2, a, 4);
  if (r.incident_height > 0.0) finite("reflection of mps_separation_find", &r.reflection, 1, a, 4);
}

static void walls_and_crests(void) {
  double a[14] = {0.1, 2.0, 0.6, 1000.0, 9.81, 0.7, 0.5, 0.55, 0.3, 0.8, 0.2, 0.3, 5e3, 0.4};
  bend(a, 14);
  DEF(sainflou, s, .height = a[0], .period = a[1], .depth = a[2], .density = a[3], .gravity = a[4]);
  mps_sainflou sainflou;
  if (mps_sainflou_evaluate(context, &s, &sainflou) == MPS_OK)
    finite("mps_sainflou_evaluate", &sainflou.rise, 6, a, 14);
  DEF(goda, g, .impulsive = (int32_t)draw(2), .height = a[0], .period = a[1], .depth = a[2],
      .density = a[3], .gravity = a[4], .crest = a[8], .width = a[9]);
  if (draw(2)) g.seaward = a[5];
  if (draw(2)) g.berm_depth = a[6], g.base = a[7], g.berm_width = a[10];
  g.angle = draw(2) ? a[11] : 0.0;
  const bool weighs = draw(2);
  if (weighs) g.weight = a[12], g.arm = a[13];
  mps_goda goda;
  if (mps_goda_evaluate(context, &g, &goda) == MPS_OK) {
    finite("coefficients of mps_goda_evaluate", goda.alpha, 3, a, 14);
    finite("mps_goda_evaluate", &goda.reach, 10, a, 14);
    if (weighs) finite("safeties of mps_goda_evaluate", &goda.sliding, 2, a, 14);
  }
}

static void storms(void) {
  double a[10] = {1.2, 6.0, 5.0, 2.0, 3.0, 0.9, 0.8, 0.95, 0.9, 9.81};
  bend(a, 10);
  DEF(eurotop, d, .wall = (int32_t)draw(2), .foreshore = (int32_t)draw(2),
      .design = (int32_t)draw(2), .height = a[0], .period = a[1], .depth = a[2], .crest = a[3],
      .cotangent = a[4]);
  d.berm = a[5], d.roughness = a[6], d.obliquity = a[7], d.crown = a[8], d.gravity = a[9];
  mps_eurotop out;
  mps_eurotop_run_up up;
  if (mps_eurotop_evaluate(context, &d, &out) == MPS_OK)
    finite("mps_eurotop_evaluate", &out.discharge, d.wall ? 4 : 3, a, 10);
  if (mps_eurotop_find_run_up(context, &d, &up) == MPS_OK)
    finite("mps_eurotop_find_run_up", &up.height, 4, a, 10);
}

static void low_heads(void) {
  double t[6] = {0, 1, 2, 3, 4, 5}, h[6] = {-0.1, 0.01, 0.02, -0.1, 0.01, -0.1};
  double v[6] = {0, 0, 1e-3, 1e-3, 1e-3, 2e-3}, a[4] = {0.05, 0.5, 0.6, 9.81}, thin[6];
  bend(a, 4), bend(h, 6), bend(v, 6);
  if (draw(4) == 0) bend(t, 6);
  DEF(overtopping, d, .samples = 6, .times = t, .heads = h, .volumes = draw(2) ? v : NULL,
      .resolved = a[0], .pause = a[1], .gravity = a[3]);
  if (draw(2)) d.depth = a[2];
  mps_overtopping out;
  if (mps_overtopping_find(context, &d, 6, thin, &out) != MPS_OK) return;
  finite("volumes of mps_overtopping_find", thin, 6, h, 6);
  finite("mps_overtopping_find", &out.counted, 3, h, 6);
}

/* ---- signals --------------------------------------------------------------------------------- */

static void look_at(mps_signal *signal, const char *what, const double *a, int n) {
  if (!signal) return;
  for (int k = 0; k < 4; k++) {
    const double t = k < 2 ? 0.3 * k : extreme();
    const double m[3] = {mps_signal_displacement(signal, t), mps_signal_velocity(signal, t),
                         mps_signal_acceleration(signal, t)};
    /* queries have no status: NaN says that the motion at t is not finite */
    if (k >= 2 && fabs(t) > 1e12 && isnan(m[0]) && isnan(m[1]) && isnan(m[2])) continue;
    if (!isfinite(m[0] + m[1] + m[2])) print_error("t = %.17g\n", t);
    finite(what, m, 3, a, n);
  }
  mps_signal_destroy(&signal);
}

static void signals(void) {
  double a[3] = {4.0, 0.25, 1.0}, t[5] = {0, 0.1, 0.2, 0.3, 0.4}, v[5] = {0, 1, -1, 2, 0};
  mps_signal *signal = NULL;
  bend(a, 3), bend(v, 5);
  if (draw(3) == 0) bend(t, 5);
  const int32_t quantity = (int32_t)draw(3);
  if (mps_signal_create_ricker(context, a[0], a[1], a[2], &signal) == MPS_OK)
    look_at(signal, "a Ricker wavelet", a, 3);
  if (mps_signal_create_sine(context, MPS_SIGNAL_QUANTITY_DISPLACEMENT, a[0], a[2], a[1],
                             &signal) == MPS_OK)
    look_at(signal, "a sine", a, 3);
  if (mps_signal_create_ramp(context, MPS_SIGNAL_QUANTITY_DISPLACEMENT, a[1], a[0], a[2],
                             &signal) == MPS_OK)
    look_at(signal, "a ramp", a, 3);
  if (mps_signal_create_table(context, quantity, 5, t, v, &signal) == MPS_OK)
    look_at(signal, "a table", v, 5);
}

/* ---- kernels, moduli, laws ------------------------------------------------------------------- */

static void kernels(void) {
  double a[2] = {0.3, 0.1}, out;
  scoped_kernel *kernel = NULL;
  bend(a, 2);
  if (mps_kernel_create(context, (int32_t)draw(4), a[0], &kernel) != MPS_OK) return;
  const double r = draw(2) ? extreme() : a[0] * extreme();
  const double w[2] = {mps_kernel_weight(kernel, r), mps_kernel_derivative(kernel, r)};
  if (!isfinite(w[0] + w[1])) print_error("r = %.17g\n", r);
  finite("weights of a kernel", w, 2, a, 2);
  if (a[0] / a[1] < 30.0) {
    out = mpsi_kernel_density(kernel, a[1]);
    finite("density of a lattice", &out, 1, a, 2);
  }
}

static void moduli(void) {
  double a[5] = {1e7, 0.3, 1900.0, 200.0, 400.0};
  mps_moduli out;
  bend(a, 5);
  if (mps_moduli_from_elastic(context, a[0], a[1], a[2], &out) == MPS_OK)
    finite("mps_moduli_from_elastic", &out.young, 9, a, 5);
  if (mps_moduli_from_velocities(context, a[3], a[4], a[2], &out) == MPS_OK)
    finite("mps_moduli_from_velocities", &out.young, 9, a, 5);
}

static mps_status make_law(int which, double *a, mps_material **out) {
  mps_material_von_mises_def vm = mps_material_von_mises_defaults();
  mps_material_drucker_prager_def dp = mps_material_drucker_prager_defaults();
  mps_material_mohr_coulomb_def mc = mps_material_mohr_coulomb_defaults();
  mps_material_cam_clay_def cc = mps_material_cam_clay_defaults();
  mps_material_newtonian_def nf = mps_material_newtonian_defaults();
  switch (which) {
  case 0:
    return mps_material_create_linear_elastic(context, a[0], a[1], out);
  case 1:
    return mps_material_create_neo_hookean(context, a[0], a[1], out);
  case 2:
    vm.young = a[0], vm.poisson = a[1], vm.yield_stress = a[2];
    return mps_material_create_von_mises(context, &vm, out);
  case 3:
    dp.young = a[0], dp.poisson = a[1], dp.cohesion = a[2], dp.friction = a[3];
    return mps_material_create_drucker_prager(context, &dp, out);
  case 4:
    mc.young = a[0], mc.poisson = a[1], mc.cohesion = a[2], mc.friction = a[3];
    return mps_material_create_mohr_coulomb(context, &mc, out);
  case 5:
    nf.bulk_modulus = a[0], nf.viscosity = a[2];
    return mps_material_create_newtonian(context, &nf, out);
  default:
    cc.critical_slope = a[4], cc.compression = a[5], cc.swelling = a[6], cc.void_ratio = a[7];
    cc.preconsolidation = a[2], cc.poisson = a[1], cc.lode = which & 1;
    return mps_material_create_cam_clay(context, &cc, out);
  }
}

static void laws(void) {
  double a[8] = {1e7, 0.3, 1e4, 0.5, 1.0, 0.2, 0.05, 1.0}, L[9] = {0.01, 0, 0, 0, -0.01};
  scoped_material *law = NULL;
  const int which = (int)draw(8);
  bend(a, 8);
  if (make_law(which, a, &law) != MPS_OK) return;
  const double wave = mps_material_wave_modulus(law), k0 = mps_material_normal_k0(law);
  finite("mps_material_wave_modulus", &wave, 1, a, 8);
  if (which > 5) finite("mps_material_normal_k0", &k0, 1, a, 8);
  mps_moduli out;
  if (mps_material_get_moduli(law, 1900.0, &out) == MPS_OK)
    finite("mps_material_get_moduli", &out.young, 9, a, 8);
  mps_material_point x;
  OK(mps_material_point_init(context, law, &x));
  for (int c = 0; c < 3; c++) x.stress[c] = which > 5 ? -a[2] : 0.0;
  bend(L, 9);
  if (mps_material_point_drive(context, law, &x, L, 1.0, 4) == MPS_OK) {
    finite("stress of mps_material_point_drive", x.stress, 6, L, 9);
    finite("volume of mps_material_point_drive", &x.volume_ratio, 1, L, 9);
    finite("history of mps_material_point_drive", x.history, mps_material_history_count(law), L, 9);
  }
}

/* ---- ground at rest, coupling ---------------------------------------------------------------- */

static void ground(void) {
  double a[8] = {1.0, 0.5, 1900.0, 9.81, 1e4, 2.0, 1e3, 0.6};
  bend(a, 8);
  scoped_particles *set = box_of(context, 0.1, AT(0.0, 0.0), AT(0.4, 0.8));
  const mps_geostatic_layer layer = {a[0], a[1], a[2]};
  DEF(geostatic, rest, .layer_count = 1, .layers = &layer, .gravity = a[3], .surcharge = a[4]);
  if (mps_particles_set_geostatic(set, &rest) == MPS_OK) {
    DEF(material_cam_clay, cc, .critical_slope = 1.0, .compression = 0.2, .swelling = 0.05,
        .void_ratio = 1.0, .preconsolidation = 1e4);
    DEF(consolidation, past, .ocr = a[5], .pop = a[6]);
    mps_view v;
    if (draw(2)) past.k0 = a[7];
    MAKE(material, clay, create_cam_clay, context, &cc);
    const bool clayey = mps_particles_set_consolidation(set, clay, &past) == MPS_OK;
    static const char *const names[] = {"stress", "preconsolidation", "void_ratio"};
    for (int f = 0; f < (clayey ? 3 : 1); f++) {
      OK(mps_particles_view(set, names[f], &v));
      for (int64_t c = 0; c < v.shape[1]; c++)
        finite(names[f], mps_view_f64(&v, 0, c), v.shape[0], a, 8);
    }
  }
}

static void couplings(void) {
  enum { N = 3 };
  double start[N] = {1.0, -2.0, 0.5}, answer[N], guess[N];
  DEF(coupling, d, .method = (int32_t)draw(3), .size = N, .repeats = 8);
  MAKE(coupling, c, create, context, &d);
  for (int step = 0; step < 3; step++) {
    int32_t done = 0;
    bend(start, N);
    if (mps_coupling_begin(c, step == 2 ? NULL : start, guess) != MPS_OK) continue;
    finite("mps_coupling_begin", guess, N, start, N);
    for (int k = 0; k < 8 && !done; k++) {
      for (int i = 0; i < N; i++) answer[i] = 0.3 * guess[(i + 1) % N] + 1.0;
      if (draw(3) == 0) bend(answer, N);
      double before[N], apart = 0.0;
      memcpy(before, guess, sizeof before);
      if (mps_coupling_next(c, answer, guess, &done) != MPS_OK) break;
      finite("mps_coupling_next", guess, N, answer, N);
      for (int i = 0; i < N; i++) apart = fmax(apart, fabs(answer[i] - before[i]));
      double most = 0.0;
      for (int i = 0; i < N; i++) most = fmax(most, fabs(answer[i]));
      if (done && apart > 1e-3 * most) fail_msg("agreed at %g of %g", apart, most);
    }
    mps_coupling_report r;
    OK(mps_coupling_get_report(c, &r));
    finite("mps_coupling_get_report", &r.residual, 1, answer, N);
    if (done) OK(mps_coupling_accept(c));
  }
}

TEST(answers_are_finite) {
  static void (*const all[])(void) = {
      linear_theory, seas,    absorbers, gauges, walls_and_crests, storms,   low_heads,
      signals,       kernels, moduli,    laws,   ground,           couplings};
  static const char *const names[] = {
      "linear theory", "seas",    "absorbers", "gauges", "walls",  "storms",   "low heads",
      "signals",       "kernels", "moduli",    "laws",   "ground", "couplings"};
  const char *given = getenv("MPS_FINITE_ROUNDS");
  const int rounds = given ? atoi(given) : (int)test_steps(400);
  for (size_t k = 0; k < sizeof all / sizeof *all; k++) {
    answers = 0;
    for (int round = 0; round < rounds; round++) {
      seed = (uint64_t)round * 1000 + k + 1;
      (void)draw(2), (void)draw(2);
      all[k]();
    }
    print_message("%s: %d finite answers\n", names[k], (int)answers);
    assert_true(answers > rounds / 8);
  }
}
