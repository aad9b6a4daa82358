/* test_textbook_block.c - Newmark's sliding block (N. M. Newmark, Effects of earthquakes on dams
 * and embankments, Geotechnique 15 (1965) 139-160): a stiff elastic block of particles on a rigid
 * rough plane that is shaken. Slip after one rectangular pulse on level ground against the closed
 * form, and after five cycles down a slope against the equation of a rigid block, integrated apart.
 * Where mu is 0.55 the block's own stress has a viscous part: steady sliding of an undamped elastic
 * block is unstable (docs/theory/contact.md, Sliding that vibrates), and one that vibrates has less
 * friction than a rigid block.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "mpm_scene.h"

#include "test_fixture.h"
#include "textbook_table.h"

#define G 9.81
#define LENGTH 0.8 /* m, of the block */
#define HEIGHT 0.2
#define DENSITY 2000.0
#define YOUNG 5e7 /* Pa: a shear wave crosses the height in 2 ms */
#define POISSON 0.3
#define REST 0.1 /* s before the plane moves */

/* A block on a plane at the angle `slope` (rad), in axes along the plane. */
typedef struct shaking {
  const char *name;
  double friction, slope;
  double peak, frequency; /* m/s2; Hz, 0: one rectangular pulse */
  double duration;        /* s, of the pulse or the cycles */
  double end;             /* s */
  double damping; /* s, a1: the stress is C (e + a1 de/dt), C the elastic stiffness; 0: none */
} shaking;

/* Acceleration of the plane, positive up the slope. */
static double plane_acceleration(const shaking *s, double t) {
  const double u = t - REST;
  if (u < 0.0 || u >= s->duration) return 0.0;
  return s->frequency > 0.0 ? s->peak * sin(2.0 * PI * s->frequency * u) : s->peak;
}

/* Its integral. */
static double plane_velocity(const shaking *s, double t) {
  const double u = fmin(fmax(t - REST, 0.0), s->duration), w = 2.0 * PI * s->frequency;
  return s->frequency > 0.0 ? s->peak * (1.0 - cos(w * u)) / w : s->peak * u;
}

static double plane_place(const shaking *s, double t) {
  const double u = fmin(fmax(t - REST, 0.0), s->duration), w = 2.0 * PI * s->frequency;
  const double after = fmax(t - REST - s->duration, 0.0) * plane_velocity(s, t);
  return after + (s->frequency > 0.0 ? s->peak / w * (u - sin(w * u) / w) : 0.5 * s->peak * u * u);
}

/* Slip of a rigid block down the plane (m): it slips down where the plane's acceleration up the
 * slope is above ay = g (mu cos - sin), and up where it is below -g (mu cos + sin). Steps of 1e-6
 * s.
 */
static double rigid_slip(const shaking *s) {
  const double hold = s->friction * G * cos(s->slope), pull = G * sin(s->slope), dt = 1e-6;
  double v = 0.0, slip = 0.0; /* of the block against the plane, down the slope */
  for (int64_t k = 0; k < (int64_t)(s->end / dt); k++) {
    const double drive = plane_acceleration(s, (k + 0.5) * dt) + pull;
    double a = 0.0;
    if (v > 0.0 || (v == 0.0 && drive > hold)) a = drive - hold;
    if (v < 0.0 || (v == 0.0 && drive < -hold)) a = drive + hold;
    const double next = v + a * dt;
    const bool stops = v != 0.0 && next * v <= 0.0 && fabs(drive) <= hold;
    slip += 0.5 * (v + (stops ? 0.0 : next)) * dt;
    v = stops ? 0.0 : next;
  }
  return slip;
}

static mps_status move(void *user, double t, double motion[3]) {
  const shaking *s = user;
  motion[0] = plane_place(s, t);
  motion[1] = plane_velocity(s, t);
  motion[2] = plane_acceleration(s, t);
  return MPS_OK;
}

/* Stress C (e + a1 de/dt) by increments, of which history has the viscous part of the last step. */
static mps_status update_damped(void *user, const mps_material_block *block) {
  const double a1 = ((const shaking *)user)->damping;
  const double lambda = YOUNG * POISSON / ((1.0 + POISSON) * (1.0 - 2.0 * POISSON));
  const double G2 = YOUNG / (1.0 + POISSON);
  for (int64_t k = 0; k < block->count; k++) {
    const double xx = block->gradient[0][k], yy = block->gradient[4][k];
    const double xy = 0.5 * (block->gradient[1][k] + block->gradient[3][k]);
    const double mean = lambda * (xx + yy);
    const double rate[4] = {mean + G2 * xx, mean + G2 * yy, mean, G2 * xy};
    for (int c = 0; c < 4; c++) {
      block->stress[c][k] += rate[c] * (block->dt + a1) - block->history[c][k];
      block->history[c][k] = a1 * rate[c];
    }
  }
  return MPS_OK;
}

static void make_damped(mpm_scene *s, shaking *how) {
  static const char *const names[] = {"xx", "yy", "zz", "xy"};
  mps_material_destroy(&s->material);
  USING(material_user, mps_material_create_user(context, &given, &s->material),
        .update = update_damped, .user = how, .name = "damped", .history_count = 4,
        .history = names, .shear_modulus = 0.5 * YOUNG / (1.0 + POISSON),
        .bulk_modulus = YOUNG / (3.0 * (1.0 - 2.0 * POISSON)),
        .wave_modulus = given.bulk_modulus + 4.0 / 3.0 * given.shear_modulus,
        .viscosity = how->damping * given.wave_modulus);
}

/* The plane is y = 0, x points up the slope. The stress of rest across the plane is there. */
static mps_body *place_block(mpm_scene *s, shaking *how, double h) {
  *s = mpm_scene_begin(context, 0.5 * h, 0.0, 0.0, YOUNG);
  if (how->damping > 0.0) make_damped(s, how);
  mpm_scene_box(s, 0.0, 0.0, LENGTH, HEIGHT);
  SET_FIELDS(s->particles, {"density", DENSITY}, {"stress", 0.0});
  const mps_view x = mpm_scene_view(s, "position");
  EDIT(stress, s->particles, "stress")
    for (int64_t k = 0; k < x.shape[0]; k++) {
      const double across = -DENSITY * G * cos(how->slope) * (HEIGHT - *mps_view_f64(&x, k, 1));
      *mps_edit_f64(&stress, k, 1) = across;
      *mps_edit_f64(&stress, k, 2) = 0.3 * across;
    }
  DEF(mpm, def, .cell = h, .gravity[0] = -G * sin(how->slope), .gravity[1] = -G * cos(how->slope));
  OK(mps_mpm_create(context, s->particles, s->material, &def, &s->mpm));
  const double up[2] = {0.0, 1.0};
  MAKE_KEPT(body, plane, create_half_plane, context, NULL, up);
  MAKE(signal, signal, create_user, context, MPS_SIGNAL_QUANTITY_DISPLACEMENT, move, how, NULL);
  OK(mps_body_drive(plane, 0, signal, 1.0));
  mpm_scene_contact(s, plane, how->friction);
  return plane;
}

/* Down the slope, against the plane, of the centre of mass. */
static double slip_of(mpm_scene *s, const shaking *how) {
  const mps_view x = mpm_scene_view(s, "position");
  double sum = 0.0;
  for (int64_t k = 0; k < x.shape[0]; k++) sum += *mps_view_f64(&x, k, 0);
  return plane_place(how, mps_mpm_time(s->mpm)) - (sum / (double)x.shape[0] - 0.5 * LENGTH);
}

static double slide(shaking *how, double h, double expected) {
  mpm_scene s;
  const double began = textbook_cost();
  scoped_body *plane = place_block(&s, how, h);
  FILE *f = textbook_table(how->name, "t_s,plane_m_s2,slip_m");
  const int samples = 200;
  double slip = 0.0;
  for (int k = 0; k <= samples; k++) {
    const double t = how->end * k / samples;
    OK(mps_mpm_run(s.mpm, t, 1000000, NULL, NULL));
    slip = slip_of(&s, how);
    textbook_row(f, 3, (double[]){t, plane_acceleration(how, t), slip});
  }
  textbook_close(f);
  print_message("%s, h %g m: slip %.6f m, exact %.6f (%+.2f %%), %.1f s\n", how->name, h, slip,
                expected, 100.0 * (slip / expected - 1.0), textbook_cost() - began);
  mpm_scene_end(&s);
  return slip;
}

/* Level ground, 0.4 g for 0.25 s over mu = 0.2: a t0^2/2 (a/ay - 1). */
TEST(slips_after_a_pulse) {
  shaking how = {.name = "block_pulse", .friction = 0.2, .peak = 0.4 * G, .duration = 0.25};
  how.end = REST + 0.7;
  const double yield = how.friction * G;
  const double exact = 0.5 * how.peak * how.duration * how.duration * (how.peak / yield - 1.0);
  NEAR(rigid_slip(&how), exact, 1e-5 * exact);
  NEAR(slide(&how, 0.05, exact), exact, 0.01 * exact);
}

/* A slope of 15 degrees, mu = 0.4 (ay 0.128 g), five cycles of 0.35 g and 2 Hz. The undamped block
 * vibrates as it slides, and slips the farther the finer it is. */
TEST(slips_down_a_slope) {
  shaking how = {.name = "block_cycles",
                 .friction = 0.4,
                 .slope = PI / 12.0,
                 .peak = 0.35 * G,
                 .frequency = 2.0,
                 .duration = 2.5};
  how.end = REST + 3.0;
  const double exact = rigid_slip(&how);
  NEAR(slide(&how, 0.05, exact), exact, 0.02 * exact);
}

/* A rougher slope of 20 degrees, mu = 0.55 (ay 0.175 g): five cycles of `peak` (g) and `frequency`.
 */
static void slide_damped(const char *name, double peak, double frequency) {
  shaking how = {.name = name,
                 .friction = 0.55,
                 .slope = PI / 9.0,
                 .peak = peak * G,
                 .frequency = frequency,
                 .duration = 5.0 / frequency,
                 .damping = 1e-4};
  how.end = REST + how.duration + 0.5;
  const double exact = rigid_slip(&how);
  NEAR(slide(&how, 0.05, exact), exact, 0.02 * exact);
}

TEST(slips_when_damped) { slide_damped("block_rough", 0.5, 3.0); }

TEST(slips_slowly_when_damped) { slide_damped("block_slow", 0.35, 2.0); }
