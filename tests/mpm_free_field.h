/* mpm_free_field.h - ground between free-field sides, of WLS-MPM, that the tests share: layers
 * under their weight with the stress K0 sigma_v across, shaken from below. SPDX-License-Identifier:
 * BSD-3-Clause */
#ifndef MPS_TEST_MPM_FREE_FIELD_H
#define MPS_TEST_MPM_FREE_FIELD_H

#include "mpm_scene.h"

#define FIELD_RHO 1800.0 /* kg/m3 */
#define FIELD_NU 0.3
#define FIELD_K0 (FIELD_NU / (1.0 - FIELD_NU))

typedef struct field_ground {
  double width, height, spacing;
  double vs;           /* m/s, of the layer */
  double rock, below;  /* m/s, m: of the ground below that height */
  double gravity;      /* m/s2 */
  int32_t sides, base; /* mps_boundary_kind; base: 0 held or driven, 4 absorbing */
  double shift;        /* m, of the left side */
  mps_signal *motion;  /* of the base, along x; */
  mps_signal *heave;   /* along y */
  mps_material *law;   /* of the layer in place of elasticity */
  double flip_time;    /* s */
  int32_t budget, spline;
  bool heated; /* the set has the field `temperature` */
  bool lid;    /* a roller on the surface */
} field_ground;

static inline double field_young(double vs) { return 2.0 * (1.0 + FIELD_NU) * FIELD_RHO * vs * vs; }

/* Gives the particles below a height the elasticity of rock. */
static inline void field_add_rock(mpm_scene *s, const field_ground *of) {
  scoped_material *rock = NULL;
  const double lo[2] = {-1e9, -1e9}, hi[2] = {1e9, of->below};
  int64_t count = mps_particles_count(s->particles);
  int64_t *ids = malloc((size_t)count * sizeof *ids);
  if (!ids) abort();
  OK(mps_particles_select_box(s->particles, lo, hi, count, &count, ids));
  OK(mps_material_create_linear_elastic(s->context, field_young(of->rock), FIELD_NU, &rock));
  OK(mps_mpm_set_material(s->mpm, rock, ids, count));
  free(ids);
}

static inline void field_set_sides(mpm_scene *s, const field_ground *of) {
  USING(mpm_boundary, mps_mpm_set_boundary(s->mpm, MPS_SIDE_Y_LOWER, &given),
        .kind = of->base == MPS_BOUNDARY_HELD && (of->motion || of->heave) ? MPS_BOUNDARY_DRIVEN
                                                                           : of->base,
        .signal[0] = of->motion, .signal[1] = of->heave);
  mpm_scene_side(s, MPS_SIDE_X_LOWER, of->sides, 0.0);
  mpm_scene_side(s, MPS_SIDE_X_UPPER, of->sides, 0.0);
}

static inline mpm_scene field_scene(mps_context *context, const field_ground *of) {
  mpm_scene s = mpm_scene_begin(context, of->spacing, of->shift, 0.0, field_young(of->vs));
  mpm_scene_box(&s, of->shift, 0.0, of->shift + of->width, of->height);
  OK(mps_particles_set(s.particles, "density", 0, FIELD_RHO));
  if (of->heated) OK(mps_particles_add_field(s.particles, "temperature", 0));
  if (of->gravity > 0.0) mpm_scene_weigh(&s, FIELD_RHO * of->gravity, FIELD_K0, of->height);
  DEF(mpm, def, .cell = 2.0 * of->spacing, .spline = of->spline,
      .origin[0] = def.lower[0] = of->shift, .upper[0] = of->shift + of->width, .lower[1] = 0.0);
  if (of->lid) def.upper[1] = of->height;
  def.gravity[1] = -of->gravity;
  def.budget = of->budget;
  def.flip_time = of->flip_time;
  OK(mps_mpm_create(context, s.particles, of->law ? of->law : s.material, &def, &s.mpm));
  if (of->below > 0.0) field_add_rock(&s, of);
  field_set_sides(&s, of);
  return s;
}

/* Sum of the particles' kinetic and elastic energies, J. */
static inline double field_energy(mpm_scene *s, double young) {
  const mps_view v = mpm_scene_view(s, "velocity"), stress = mpm_scene_view(s, "stress");
  const mps_view volume = mpm_scene_view(s, "volume"), mass = mpm_scene_view(s, "mass");
  double sum = 0.0;
  for (int64_t k = 0; k < v.shape[0]; k++) {
    double t[4], trace, square, speed = 0.0;
    for (int c = 0; c < 4; c++) t[c] = *mps_view_f64(&stress, k, c);
    for (int c = 0; c < 2; c++) speed += *mps_view_f64(&v, k, c) * *mps_view_f64(&v, k, c);
    trace = t[0] + t[1] + t[2];
    square = t[0] * t[0] + t[1] * t[1] + t[2] * t[2] + 2.0 * t[3] * t[3];
    sum += 0.5 * *mps_view_f64(&mass, k, 0) * speed +
           *mps_view_f64(&volume, k, 0) * 0.5 *
               ((1.0 + FIELD_NU) * square - FIELD_NU * trace * trace) / young;
  }
  return sum;
}

/* Largest difference of component c of the velocity between particles at one height (m), and the
 * largest size of it there. */
static inline double field_spread(mpm_scene *s, int c, double height, double *largest) {
  const mps_view x = mpm_scene_view(s, "position"), v = mpm_scene_view(s, "velocity");
  double low = INFINITY, high = -INFINITY;
  for (int64_t k = 0; k < x.shape[0]; k++) {
    if (fabs(*mps_view_f64(&x, k, 1) - height) > 0.3 * mps_particles_spacing(s->particles))
      continue;
    low = fmin(low, *mps_view_f64(&v, k, c)), high = fmax(high, *mps_view_f64(&v, k, c));
  }
  *largest = fmax(fabs(low), fabs(high));
  return high - low;
}

/* ---- layer on a half space ------------------------------------------------------------------- */

/* A velocity v sin(2 pi f t) that grows over the first two periods. */
static inline mps_signal *field_shaking(mps_context *context, double frequency, double velocity,
                                        double end) {
  enum { MOST = 20001 };
  static double t[MOST], v[MOST];
  const int count = (int)fmin(MOST - 1, ceil(end * frequency * 80.0)) + 1;
  for (int k = 0; k < count; k++) {
    t[k] = end * k / (count - 1);
    const double share = fmin(1.0, 0.5 * t[k] * frequency);
    v[k] = velocity * share * share * (3.0 - 2.0 * share) * sin(2.0 * PI * frequency * t[k]);
  }
  MAKE_KEPT(signal, out, create_table, context, MPS_SIGNAL_QUANTITY_VELOCITY, count, t, v);
  return out;
}

typedef struct field_response {
  int shear;
  double flip_time;     /* s */
  double share;         /* of the layer's lowest frequency, c/4H */
  double amplification; /* of the surface over the outcrop of the half space */
  double exact;
  double apart; /* largest difference of velocities along x over their largest value */
  double rough; /* amplitude of a velocity that alternates from row to row in the layer, over the
                   largest velocity */
} field_response;

/* Root mean square of the velocity that alternates along y from one particle of the first column to
 * the next, above `from`: a quarter of the second differences less those of the standing wave
 * v = cos k y, -(k d)^2 v. Ids ascend with height by `across`. */
static inline double field_roughness(mpm_scene *s, int c, int64_t across, double from,
                                     double wave_number) {
  const mps_view x = mpm_scene_view(s, "position"), v = mpm_scene_view(s, "velocity");
  const double d = wave_number * mps_particles_spacing(s->particles);
  double sum = 0.0, count = 0.0;
  for (int64_t id = across; id + across < x.shape[0]; id += across) {
    double at[3];
    for (int q = 0; q < 3; q++)
      at[q] = *mps_view_f64(&v, mps_particles_index(s->particles, id + (q - 1) * across), c);
    if (*mps_view_f64(&x, mps_particles_index(s->particles, id), 1) < from) continue;
    const double rest = 0.25 * (at[0] - 2.0 * at[1] + at[2] + d * d * at[1]);
    sum += rest * rest, count += 1.0;
  }
  return sqrt(sum / count);
}

/* |u_surface| over |u| of the half space's outcrop, of an undamped layer of height H and wave
 * velocity c (Kramer 1996, Geotechnical Earthquake Engineering, 7.2.1.3): 1/sqrt(cos^2 kH + a^2
 * sin^2 kH), a = rho c/(rho_r c_r). */
static inline double field_amplification(double k_H, double ratio) {
  return 1.0 / sqrt(cos(k_H) * cos(k_H) + ratio * ratio * sin(k_H) * sin(k_H));
}

/* A layer of 12 m and 120 m/s over 4 m of rock of 480 m/s on an absorbing base, from which a wave
 * of a steady frequency comes; S (`shear`) or P. flip_time: s. */
static inline field_response field_shake_layer(mps_context *context, double spacing, double share,
                                               int shear, double flip_time) {
  const double H = 12.0, below = 4.0, vs = 120.0, rock = 480.0, v = 1e-4;
  const double faster = shear ? 1.0 : sqrt(2.0 * (1.0 - FIELD_NU) / (1.0 - 2.0 * FIELD_NU));
  const double f = share * faster * vs / (4.0 * H);
  const double end = 6.0 / f + 12.0 * 2.0 * H / (vs * faster);
  field_response out = {
      shear, flip_time, share, 0.0, field_amplification(0.5 * PI * share, vs / rock), 0.0, 0.0};
  field_ground of = {.width = 4.0,
                     .height = below + H,
                     .spacing = spacing,
                     .vs = vs,
                     .rock = rock,
                     .below = below,
                     .sides = MPS_BOUNDARY_FREE_FIELD,
                     .base = MPS_BOUNDARY_ABSORBING,
                     .flip_time = flip_time};
  scoped_signal *signal = field_shaking(context, f, v, end + 1.0);
  *(shear ? &of.motion : &of.heave) = signal;
  scoped_mpm_scene s = field_scene(context, &of);
  double peak = 0.0, now;
  while (mps_mpm_time(s.mpm) < end) {
    OK(mps_mpm_step(s.mpm, 5));
    out.apart = fmax(out.apart, field_spread(&s, shear ? 0 : 1, below + H - 0.5 * spacing, &now));
    if (mps_mpm_time(s.mpm) > end - 1.0 / f) peak = fmax(peak, now);
  }
  out.rough = field_roughness(&s, shear ? 0 : 1, llround(of.width / spacing), below + 1.0,
                              2.0 * PI * f / (vs * faster)) /
              peak;
  out.amplification = peak / v;
  out.apart /= peak;
  return out;
}

static inline void field_print_response(const field_response *r) {
  char flip[40] = "";
  if (r->flip_time > 0.0) (void)snprintf(flip, sizeof flip, ", flip_time %g s", r->flip_time);
  print_message(
      "%s wave%s, %.1f of the layer's frequency: amplification %.4f, exact %.4f (%+.2f %%); "
      "along x it differs by %.2g of the amplitude; along y %.2g of it alternates\n",
      r->shear ? "S" : "P", flip, r->share, r->amplification, r->exact,
      100.0 * (r->amplification / r->exact - 1.0), r->apart, r->rough);
}

#endif
