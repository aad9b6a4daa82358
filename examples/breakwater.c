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

/* ---- building -------------------------------------------------------------------------------- */

static mps_status make_sand(mps_context *context, sea *s) {
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
  mps_status status = mps_particles_create(context, &set, &s->sand);
  if (status == MPS_OK) status = mps_particles_fill_box(s->sand, lo, hi, NULL);
  if (status == MPS_OK) status = mps_particles_set(s->sand, "density", 0, 1600.0);
  if (status == MPS_OK) status = mps_particles_set_geostatic(s->sand, &rest);
  if (status == MPS_OK) status = mps_material_create_drucker_prager(context, &law, &s->material);
  return status == MPS_OK ? mps_mpm_create(context, s->sand, s->material, &def, &s->mpm) : status;
}

static mps_status make_caisson(mps_context *context, sea *s) {
  mps_body_def def = mps_body_defaults();
  mps_contact_def contact = mps_contact_defaults();
  def.motion = MPS_BODY_MOTION_FREE;
  def.position[0] = LENGTH + 0.5 * WIDTH, def.position[1] = MIDDLE;
  def.mass = 2400.0 * WIDTH * HEIGHT;
  def.inertia[2] = def.mass * (WIDTH * WIDTH + HEIGHT * HEIGHT) / 12.0;
  def.gravity[1] = -G;
  contact.friction = 0.5, contact.inside = MPS_CONTACT_INSIDE_REMOVE;
  const mps_status status = mps_body_create_box(context, &def, WIDTH, HEIGHT, &s->caisson);
  return status == MPS_OK ? mps_mpm_add_contact(s->mpm, s->caisson, &contact, NULL) : status;
}

static mps_status add_wall(sea *s, double x, double nx, double ny) {
  mps_fluid_boundary_def def = mps_fluid_boundary_defaults();
  def.kind = MPS_BOUNDARY_ROLLER; /* slip */
  def.point[0] = x, def.normal[0] = nx, def.normal[1] = ny;
  if (nx > 0.0) def.signal = s->piston;
  if (nx < 0.0) def.nodes = nodes, def.node_count = 2;
  return mps_fluid_add_boundary(s->fluid, &def, NULL);
}

static mps_status make_water(mps_context *context, sea *s) {
  const double lo[] = {0.0, 0.0}, hi[] = {LENGTH, DEPTH};
  mps_particles_def set = mps_particles_defaults();
  mps_fluid_def def = mps_fluid_defaults();
  mps_coupling_def both = mps_coupling_defaults();
  set.spacing = SPACING;
  def.dt = DT, def.level = DEPTH;
  both.size = 2, both.tolerance = 1e-3, both.floor = 1e-3 * G;
  mps_status status = mps_particles_create(context, &set, &s->water);
  if (status == MPS_OK) status = mps_particles_fill_box(s->water, lo, hi, NULL);
  if (status == MPS_OK) status = mps_fluid_create(context, s->water, &def, &s->fluid);
  if (status == MPS_OK)
    status = mps_signal_create_sine(context, MPS_SIGNAL_QUANTITY_DISPLACEMENT, 1.0, 0.01, 0.0,
                                    &s->piston);
  if (status == MPS_OK) status = add_wall(s, 0.0, 0.0, 1.0);
  if (status == MPS_OK) status = add_wall(s, 0.0, 1.0, 0.0);
  if (status == MPS_OK) status = add_wall(s, LENGTH, -1.0, 0.0);
  return status == MPS_OK ? mps_coupling_create(context, &both, &s->coupling) : status;
}

/* ---- the caisson between both ---------------------------------------------------------------- */

/* Motion of the front's nodes along the water's normal, which points to smaller x. */
static mps_status read_front(sea *s, double *displacement, double *velocity) {
  mps_body_state now;
  const mps_status status = mps_body_get_state(s->caisson, &now);
  for (int k = 0; status == MPS_OK && k < 2; k++) {
    const double arm = nodes[3 * k + 1] - MIDDLE;
    displacement[k] =
        -(now.position[0] - s->rest.position[0]) + (now.rotation[2] - s->rest.rotation[2]) * arm;
    velocity[k] = -now.velocity[0] + now.spin[2] * arm;
  }
  return status;
}

/* The force (N) of the water in x, and its moment (N m) about the caisson's middle, act until
 * changed. */
static mps_status load(sea *s, double push, double moment) {
  const double force[3] = {push, 0.0, 0.0}, turn[3] = {0.0, 0.0, moment};
  return mps_body_set_load(s->caisson, force, turn);
}

static mps_status run_sand(sea *s, double span) {
  return mps_mpm_run(s->mpm, mps_mpm_time(s->mpm) + span, INT64_MAX, NULL, NULL);
}

/* Under still water, until the caisson's weight is borne by the sand. */
static mps_status settle(sea *s) {
  const double push = 0.5 * DENSITY * G * DEPTH * DEPTH;
  mps_status status = load(s, push, push * (MIDDLE - DEPTH / 3.0));
  if (status == MPS_OK) status = run_sand(s, SETTLE);
  return status == MPS_OK ? mps_body_get_state(s->caisson, &s->rest) : status;
}

/* Accelerations of the front's nodes if the water is given `mean`; `push` on the way. */
static mps_status answer(sea *s, const double *d, const double *v, const double *mean, double *push,
                         double *out) {
  double moved[2], speed[2], unused[2];
  mps_reaction r;
  for (int k = 0; k < 2; k++) {
    speed[k] = v[k] + DT * mean[k];
    moved[k] = d[k] + 0.5 * DT * (v[k] + speed[k]);
  }
  mps_status status = mps_fluid_set_boundary_motion(s->fluid, FRONT, moved, speed);
  if (status == MPS_OK) status = mps_fluid_solve_pressure(s->fluid);
  if (status == MPS_OK) status = mps_fluid_get_reaction(s->fluid, FRONT, &r);
  if (status == MPS_OK) status = mps_mpm_rollback(s->mpm, s->before);
  if (status != MPS_OK) return status;
  *push = -r.force[0];
  status = load(s, *push, -r.moment[2] + *push * MIDDLE);
  if (status == MPS_OK) status = run_sand(s, DT);
  if (status == MPS_OK) status = read_front(s, unused, out);
  for (int k = 0; k < 2; k++) out[k] = (out[k] - v[k]) / DT;
  return status;
}

static mps_status step(sea *s, double *push) {
  double d[2], v[2], mean[2], got[2];
  int32_t done = 0;
  mps_status status = read_front(s, d, v);
  if (status == MPS_OK) status = mps_mpm_snapshot(s->mpm, &s->before);
  if (status == MPS_OK) status = mps_fluid_begin_step(s->fluid, DT);
  if (status == MPS_OK) status = mps_coupling_begin(s->coupling, NULL, mean);
  while (status == MPS_OK && !done) {
    status = answer(s, d, v, mean, push, got);
    if (status == MPS_OK) status = mps_coupling_next(s->coupling, got, mean, &done);
  }
  if (status == MPS_OK) status = mps_coupling_accept(s->coupling);
  return status == MPS_OK ? mps_fluid_end_step(s->fluid) : status;
}

/* Impulses (N s) of the water and of the sand on the caisson, and its displacement. */
static mps_status run(sea *s, double *water, double *slid, double *most) {
  mps_status status = settle(s);
  const int steps = (int)(WAVES / DT + 0.5);
  for (int n = 1; n <= steps && status == MPS_OK; n++) {
    double push = 0.0, d[2] = {0.0, 0.0}, v[2];
    status = step(s, &push);
    if (status == MPS_OK) status = read_front(s, d, v);
    *water += DT * push;
    *most = fmax(*most, push);
    *slid = fmax(*slid, fmax(fabs(d[0]), fabs(d[1])));
    if (status == MPS_OK && n % 125 == 0)
      printf("t = %.2f s: water pushes %.1f N, foot at %+.4f mm, crest at %+.4f mm\n",
             mps_fluid_time(s->fluid), push, -1e3 * d[0], -1e3 * d[1]);
  }
  return status;
}

int main(void) {
  mps_context *context = NULL;
  mps_reaction before = {0}, after = {0};
  mps_coupling_report report = {0};
  sea s = {0};
  double water = 0.0, slid = 0.0, most = 0.0;
  if (mps_context_create(NULL, &context, NULL, 0) != MPS_OK) return 1;
  mps_status status = make_sand(context, &s);
  if (status == MPS_OK) status = make_caisson(context, &s);
  if (status == MPS_OK) status = make_water(context, &s);
  if (status == MPS_OK) status = run(&s, &water, &slid, &most);
  if (status == MPS_OK) status = mps_body_get_reaction(s.caisson, -1, &after);
  if (status == MPS_OK) status = mps_coupling_get_report(s.coupling, &report);
  if (status != MPS_OK) fprintf(stderr, "%s\n", mps_context_error(context)->message);
  /* the sand bore the force of still water while the caisson settled */
  water += SETTLE * 0.5 * DENSITY * G * DEPTH * DEPTH;
  const double sand = -(after.impulse[0] - before.impulse[0]);
  printf("%.2f solutions a step; water %.2f N s, sand %.2f N s, at most %.1f N; moved by %.4f mm\n",
         (double)report.all_repeats / fmax((double)report.steps, 1.0), water, sand, most,
         1e3 * slid);
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
  return status == MPS_OK && held ? 0 : 1;
}
