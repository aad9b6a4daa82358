/* pile.c - an open-ended pile is pushed 0.2 m into sand, in axisymmetry, by WLS-MPM: the coarse
 * relative of Nakamura 8 and of mps-pile. The load is reported by tip, inner and outer shaft.
 *
 * The tip is compared with Prandtl and Reissner's bearing capacity Nq of a foundation, with the
 * factor of Brinch Hansen for its depth, and the outer shaft with friction under 0.8 times the
 * vertical stress (API RP 2A, open-ended piles): estimates of practice, whose bounds are wide. That
 * the floor bears the load and the weight of the sand is mechanics.
 * SPDX-License-Identifier: BSD-3-Clause */
#include <mps/mpm.h>
#include <mps/soil.h>

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

static const double gravity = 9.81, density = 1600.0, friction = 0.53, k0 = 0.5;
static const double radius = 0.4, ground = 0.5, cell = 0.01;             /* m */
static const double inner = 0.08, wall = 0.04, depth = 0.2, speed = 0.5; /* m, m/s */

/* Stops where a call fails, with the library's message. */
static void ok(mps_status status) {
  if (status == MPS_OK) return;
  fprintf(stderr, "%s\n", mps_last_error()->message);
  exit(1);
}

/* One line of the results; 1 where `got` is farther from the right value than `bound`. */
static int compare(const char *what, double got, double right, double bound) {
  printf("%-44s %11.5g   right: %11.5g +- %.2g\n", what, got, right, bound);
  return !(fabs(got - right) <= bound);
}

/* Dry sand at rest. */
static void make_sand(mps_context *context, mps_particles **sand, mps_material **law) {
  const double lo[2] = {0.0, 0.0}, hi[2] = {radius, ground};
  mps_particles_def set = mps_particles_defaults();
  mps_material_drucker_prager_def def = mps_material_drucker_prager_defaults();
  const mps_geostatic_layer layer = {.thickness = INFINITY, .k0 = k0, .density = density};
  mps_geostatic_def rest = mps_geostatic_defaults();
  set.spacing = 0.5 * cell;
  def.cone = MPS_MATERIAL_CONE_INSCRIBED;
  def.young = 1e6, def.poisson = k0 / (1.0 + k0), def.friction = 38.0 * acos(-1.0) / 180.0;
  rest.layers = &layer, rest.layer_count = 1, rest.surface = ground;
  ok(mps_particles_create(context, &set, sand));
  ok(mps_particles_fill_box(*sand, lo, hi, NULL));
  ok(mps_particles_set(*sand, "density", 0, density));
  ok(mps_particles_set_geostatic(*sand, &rest));
  ok(mps_material_create_drucker_prager(context, &def, law));
}

/* The section of its wall, a cell above the ground; the tip's part reaches a cell up both faces. */
static void make_pile(mps_context *context, mps_body **pile) {
  const double outer = inner + wall, top = 0.6;
  const double corner[12] = {inner, cell, inner, 0.0, outer, 0.0,
                             outer, cell, outer, top, inner, top};
  mps_body_def def = mps_body_defaults();
  mps_body_motion motion = mps_body_motion_defaults();
  def.position[1] = ground + cell;
  ok(mps_body_create_polygon(context, &def, 6, corner, pile));
  ok(mps_body_name_part(*pile, "tip", 0, 3, NULL));
  ok(mps_body_name_part(*pile, "outside", 3, 1, NULL));
  ok(mps_body_name_part(*pile, "inside", 5, 1, NULL));
  motion.velocity[1] = -speed;
  ok(mps_body_set_motion(*pile, &motion));
}

/* Impulses (N s) upwards: on the parts of the pile, and of the floor on the sand. */
static void read_impulses(const mps_mpm *mpm, const mps_body *pile, double impulse[4]) {
  static const char *const part[3] = {"tip", "inside", "outside"};
  mps_reaction r;
  for (int k = 0; k < 4; k++) {
    if (k < 3) ok(mps_body_get_reaction(pile, mps_body_find_part(pile, part[k]), &r));
    if (k == 3) ok(mps_mpm_get_reaction(mpm, MPS_SIDE_Y_LOWER, &r));
    impulse[k] = r.impulse[1];
  }
}

int main(void) {
  mps_context *context = NULL;
  mps_particles *sand = NULL;
  mps_material *law = NULL;
  mps_body *pile = NULL;
  mps_mpm *mpm = NULL;
  ok(mps_context_create(NULL, &context, NULL, 0));
  make_sand(context, &sand, &law);
  make_pile(context, &pile);

  mps_mpm_def def = mps_mpm_defaults();
  mps_contact_def contact = mps_contact_defaults();
  def.geometry = MPS_MPM_GEOMETRY_AXISYMMETRIC;
  def.cell = cell, def.gravity[1] = -gravity;
  def.lower[0] = def.lower[1] = 0.0, def.upper[0] = radius; /* smooth walls, the ground is open */
  contact.friction = friction;
  ok(mps_mpm_create(context, sand, law, &def, &mpm));
  ok(mps_mpm_add_contact(mpm, pile, &contact, NULL));

  /* forces are means over the last two cells of the path */
  const double span = 2.0 * cell / speed, end = (cell + depth) / speed;
  double before[4], force[4];
  mps_totals totals;
  ok(mps_mpm_run(mpm, end - span, 1, NULL, NULL));
  read_impulses(mpm, pile, before);
  ok(mps_mpm_run(mpm, end, 1, NULL, NULL));
  read_impulses(mpm, pile, force);
  for (int k = 0; k < 4; k++) force[k] = (force[k] - before[k]) / span;
  ok(mps_mpm_get_totals(mpm, &totals));

  const double pi = acos(-1.0), outer = inner + wall, load = force[0] + force[1] + force[2];
  const double phi = 38.0 * pi / 180.0, mean = depth - cell; /* of the tip in that time */
  const double nq = exp(pi * tan(phi)) * pow(tan(0.25 * pi + 0.5 * phi), 2.0) *
                    (1.0 + 2.0 * tan(phi) * pow(1.0 - sin(phi), 2.0) * atan(mean / wall));
  const double pressure = force[0] / (pi * (outer * outer - inner * inner));
  const double shaft = mean - cell; /* above the tip's part */
  const double api = friction * 0.8 * density * gravity * pi * outer * shaft * shaft;
  printf("tip at %.3f m: load %.0f N = tip %.0f + inside %.1f + outside %.1f N\n", depth, load,
         force[0], force[1], force[2]);
  int wrong = compare("tip: pressure over vertical stress, Nq",
                      pressure / (density * gravity * mean), nq, 0.25 * nq);
  wrong += compare("outer shaft, N", force[2], api, 0.3 * api);
  wrong += compare("reaction of the floor, N", force[3], load + totals.mass * gravity,
                   0.02 * (load + totals.mass * gravity));

  mps_mpm_destroy(&mpm);
  mps_body_destroy(&pile);
  mps_material_destroy(&law);
  mps_particles_destroy(&sand);
  mps_context_destroy(&context);
  return wrong > 0;
}
