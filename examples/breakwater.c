/* breakwater.c - a caisson on sand under waves: water (mps_fluid), sand (mps_mpm, Drucker-Prager)
 * and a free rigid body between them, loaded by both. The caisson's front is the tank's right wall.
 * In every step of the water the steps of sand and body are rolled back and repeated, until the
 * accelerations given to the water are those of body and sand under its pressures
 * (mps/experimental/coupling.h).
 *
 * Ends with 0 where they agreed in every step, the caisson slid by less than a hundredth of a
 * spacing of the water, and the friction of the sand balanced the force of the water.
 * SPDX-License-Identifier: BSD-3-Clause */
#define MPS_EXPERIMENTAL 1
#include <mps/experimental/coupling.h>
#include <mps/fluid.h>
#include <mps/soil.h>
#include <mps/mpm.h>
#include <mps/experimental/fluid_parts.h>

#include <math.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>

#define G 9.81
#define DENSITY 1000.0 /* of the water */
#define LENGTH 1.0     /* m: tank */
#define DEPTH 0.2
#define SPACING 0.02 /* of the water's particles */
#define WIDTH 0.15   /* caisson */
#define HEIGHT 0.35
#define FOOT 0.0 /* m: on the sand, not let into it */
#define MIDDLE (FOOT + 0.5 * HEIGHT)
#define SAND 0.3 /* deep */
#define CELL 0.025
#define DT 2e-3
#define SETTLE 0.4 /* s, before the waves */
#define WAVES 2.0  /* s */

enum { BED = 0, PISTON, FRONT };

typedef struct sea {
  mps_particles *water, *sand;
  mps_fluid *fluid;
  mps_mpm *mpm;
  mps_material *material;
  mps_body *caisson;
  mps_signal *piston;
  mps_coupling *coupling;
  mps_snapshot *before;
  mps_body_state rest; /* of the caisson, when the waves begin */
} sea;

static const double nodes[6] = {LENGTH, 0.0, 0.0, LENGTH, FOOT + HEIGHT, 0.0}; /* of the front */

/* Stops where a call fails, with the library's message. */
static void ok(mps_status status) {
  if (status == MPS_OK) return;
  fprintf(stderr, "%s\n", mps_last_error()->message);
  exit(1);
}

/* ---- building -------------------------------------------------------------------------------- */

static void make_sand(mps_context *context, sea *s) {
  const double lo[] = {LENGTH - 0.25, -SAND}, hi[] = {LENGTH + 0.4, 0.0};
  const mps_geostatic_layer layer = {.thickness = INFINITY, .k0 = 0.43, .density = NAN};
  mps_particles_def set = mps_particles_defaults();
  mps_geostatic_def rest = mps_geostatic_defaults();
  mps_material_drucker_prager_def law = mps_material_drucker_prager_defaults();
  mps_mpm_def def = mps_mpm_defaults();
  set.spacing = 0.5 * CELL;
  rest.layers = &layer, rest.layer_count = 1, rest.gravity = G, rest.surface = 0.0;
  law.young = 2e7, law.friction = 35.0 * 3.14159265 / 180.0, law.cohesion = 200.0;
  def.cell = CELL, def.gravity[1] = -G;
  def.lower[0] = lo[0], def.lower[1] = lo[1], def.upper[0] = hi[0];
  ok(mps_particles_create(context, &set, &s->sand));
  ok(mps_particles_fill_box(s->sand, lo, hi, NULL));
  ok(mps_particles_set(s->sand, "density", 0, 1600.0));
  ok(mps_particles_set_geostatic(s->sand, &rest));
  ok(mps_material_create_drucker_prager(context, &law, &s->material));
  ok(mps_mpm_create(context, s->sand, s->material, &def, &s->mpm));
}

static void make_caisson(mps_context *context, sea *s) {
  mps_body_def def = mps_body_defaults();
  mps_contact_def contact = mps_contact_defaults();
  def.motion = MPS_BODY_MOTION_FREE;
  def.position[0] = LENGTH + 0.5 * WIDTH, def.position[1] = MIDDLE;
  def.mass = 2400.0 * WIDTH * HEIGHT;
  def.inertia[2] = def.mass * (WIDTH * WIDTH + HEIGHT * HEIGHT) / 12.0;
  def.gravity[1] = -G;
  contact.friction = 0.5, contact.inside = MPS_CONTACT_INSIDE_REMOVE;
  ok(mps_body_create_box(context, &def, WIDTH, HEIGHT, &s->caisson));
  ok(mps_mpm_add_contact(s->mpm, s->caisson, &contact, NULL));
}

static void add_wall(sea *s, double x, double nx, double ny) {
  mps_fluid_boundary_def def = mps_fluid_boundary_defaults();
  def.kind = MPS_BOUNDARY_ROLLER; /* slip */
  def.point[0] = x, def.normal[0] = nx, def.normal[1] = ny;
  if (nx > 0.0) def.signal = s->piston;
  if (nx < 0.0) def.nodes = nodes, def.node_count = 2;
  ok(mps_fluid_add_boundary(s->fluid, &def, NULL));
}

static void make_water(mps_context *context, sea *s) {
  const double lo[] = {0.0, 0.0}, hi[] = {LENGTH, DEPTH};
  mps_particles_def set = mps_particles_defaults();
  mps_fluid_def def = mps_fluid_defaults();
  mps_coupling_def both = mps_coupling_defaults();
  set.spacing = SPACING;
  def.dt = DT, def.level = DEPTH;
  both.size = 2, both.tolerance = 1e-3, both.floor = 1e-3 * G;
  ok(mps_particles_create(context, &set, &s->water));
  ok(mps_particles_fill_box(s->water, lo, hi, NULL));
  ok(mps_fluid_create(context, s->water, &def, &s->fluid));
  ok(mps_signal_create_sine(context, MPS_SIGNAL_QUANTITY_DISPLACEMENT, 1.0, 0.01, 0.0, &s->piston));
  add_wall(s, 0.0, 0.0, 1.0);
  add_wall(s, 0.0, 1.0, 0.0);
  add_wall(s, LENGTH, -1.0, 0.0);
  ok(mps_coupling_create(context, &both, &s->coupling));
}

/* ---- the caisson between both ---------------------------------------------------------------- */

/* Motion of the front's nodes along the water's normal, which points to smaller x. */
static void read_front(sea *s, double *displacement, double *velocity) {
  mps_body_state now;
  ok(mps_body_get_state(s->caisson, &now));
  for (int k = 0; k < 2; k++) {
    const double arm = nodes[3 * k + 1] - MIDDLE;
    displacement[k] =
        -(now.position[0] - s->rest.position[0]) + (now.rotation[2] - s->rest.rotation[2]) * arm;
    velocity[k] = -now.velocity[0] + now.spin[2] * arm;
  }
}

/* The force (N) of the water in x, and its moment (N m) about the caisson's middle, act until
 * changed. */
static void load(sea *s, double push, double moment) {
  const double force[3] = {push, 0.0, 0.0}, turn[3] = {0.0, 0.0, moment};
  ok(mps_body_set_load(s->caisson, force, turn));
}

static void run_sand(sea *s, double span) {
  ok(mps_mpm_run(s->mpm, mps_mpm_time(s->mpm) + span, INT64_MAX, NULL, NULL));
}

/* Under still water, until the caisson's weight is borne by the sand. */
static void settle(sea *s) {
  const double push = 0.5 * DENSITY * G * DEPTH * DEPTH;
  load(s, push, push * (MIDDLE - DEPTH / 3.0));
  run_sand(s, SETTLE);
  ok(mps_body_get_state(s->caisson, &s->rest));
}

/* Accelerations of the front's nodes if the water is given `mean`; `push` on the way. */
static void answer(sea *s, const double *d, const double *v, const double *mean, double *push,
                   double *out) {
  double moved[2], speed[2], unused[2];
  mps_reaction r;
  for (int k = 0; k < 2; k++) {
    speed[k] = v[k] + DT * mean[k];
    moved[k] = d[k] + 0.5 * DT * (v[k] + speed[k]);
  }
  ok(mps_fluid_set_boundary_motion(s->fluid, FRONT, moved, speed));
  ok(mps_fluid_solve_pressure(s->fluid));
  ok(mps_fluid_get_reaction(s->fluid, FRONT, &r));
  ok(mps_mpm_rollback(s->mpm, s->before));
  *push = -r.force[0];
  load(s, *push, -r.moment[2] + *push * MIDDLE);
  run_sand(s, DT);
  read_front(s, unused, out);
  for (int k = 0; k < 2; k++) out[k] = (out[k] - v[k]) / DT;
}

static void step(sea *s, double *push) {
  double d[2], v[2], mean[2], got[2];
  int32_t done = 0;
  read_front(s, d, v);
  ok(mps_mpm_snapshot(s->mpm, &s->before));
  ok(mps_fluid_begin_step(s->fluid, DT));
  ok(mps_coupling_begin(s->coupling, NULL, mean));
  while (!done) {
    answer(s, d, v, mean, push, got);
    ok(mps_coupling_next(s->coupling, got, mean, &done));
  }
  ok(mps_coupling_accept(s->coupling));
  ok(mps_fluid_end_step(s->fluid));
}

/* Impulses (N s) of the water and of the sand on the caisson, and its displacement. */
static void run(sea *s, double *water, double *slid, double *most) {
  settle(s);
  const int steps = (int)(WAVES / DT + 0.5);
  for (int n = 1; n <= steps; n++) {
    double push = 0.0, d[2] = {0.0, 0.0}, v[2];
    step(s, &push);
    read_front(s, d, v);
    *water += DT * push;
    *most = fmax(*most, push);
    *slid = fmax(*slid, fmax(fabs(d[0]), fabs(d[1])));
    if (n % 125 == 0)
      printf("t = %.2f s: water pushes %.1f N, foot at %+.4f mm, crest at %+.4f mm\n",
             mps_fluid_time(s->fluid), push, -1e3 * d[0], -1e3 * d[1]);
  }
}

int main(void) {
  mps_context *context = NULL;
  mps_reaction after;
  mps_coupling_report report;
  sea s = {0};
  double water = 0.0, slid = 0.0, most = 0.0;
  ok(mps_context_create(NULL, &context, NULL, 0));
  make_sand(context, &s);
  make_caisson(context, &s);
  make_water(context, &s);
  run(&s, &water, &slid, &most);
  ok(mps_body_get_reaction(s.caisson, -1, &after));
  ok(mps_coupling_get_report(s.coupling, &report));
  /* the sand bore the force of still water while the caisson settled */
  water += SETTLE * 0.5 * DENSITY * G * DEPTH * DEPTH;
  const double sand = -after.impulse[0];
  printf("%.2f solutions a step; water %.2f N s, sand %.2f N s, at most %.1f N; moved by %.4f mm\n",
         (double)report.all_repeats / (double)report.steps, water, sand, most, 1e3 * slid);
  mps_snapshot_destroy(&s.before);
  mps_coupling_destroy(&s.coupling);
  mps_fluid_destroy(&s.fluid);
  mps_mpm_destroy(&s.mpm);
  mps_body_destroy(&s.caisson);
  mps_material_destroy(&s.material);
  mps_signal_destroy(&s.piston);
  mps_particles_destroy(&s.water);
  mps_particles_destroy(&s.sand);
  mps_context_destroy(&context);
  const bool held = fabs(sand / water - 1.0) < 0.01 && slid < 0.01 * SPACING && most > 200.0;
  return held ? 0 : 1;
}
