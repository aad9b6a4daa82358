/* seawall.c - a piston makes a wave in a tank, whose other end is an elastic wall: the pressures of
 * the water (incompressible moving particles) on its facets load the wall (implicit particle
 * elasticity), which is stiff enough not to move the water.
 *
 * Still water has the force rho g d^2/2, under which the wall bends as Timoshenko's beam; a crest
 * of the height A adds rho g A (tanh(kd)/k + A/2), by linear theory and to the second order.
 * SPDX-License-Identifier: BSD-3-Clause */
#include <mps/elastic.h>
#include <mps/fluid.h>

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

static const double rho = 1000.0, g = 9.81, length = 1.5, depth = 0.3, spacing = 0.015; /* water */
static const double period = 1.0, stroke = 0.01; /* s, m: amplitude of the piston */
static const double young = 30e9, poisson = 0.2, wall = 0.45, thick = 0.05, cell = 0.01;
enum { ROOM = 50 }; /* facets */

typedef struct tank {
  mps_particles *water, *concrete;
  mps_fluid *fluid;
  mps_elastic *elastic;
  int64_t facets[ROOM], count;
  double centre[3 * ROOM], pressure[ROOM];
  mps_elastic_load_def pressed;
  int32_t front, load, foot; /* numbers: the water's wall, load and support of the elastic one */
} tank;

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

static int32_t add_wall(mps_fluid *fluid, double x, double nx, double ny, mps_signal *motion) {
  int32_t number;
  mps_fluid_boundary_def def = mps_fluid_boundary_defaults();
  def.kind = MPS_BOUNDARY_ROLLER; /* slip */
  def.point[0] = x, def.normal[0] = nx, def.normal[1] = ny, def.signal = motion;
  ok(mps_fluid_add_boundary(fluid, &def, &number));
  return number;
}

static void make_water(mps_context *context, tank *t) {
  const double lo[2] = {0.0, 0.0}, hi[2] = {length, depth};
  mps_particles_def set = mps_particles_defaults();
  mps_signal *piston = NULL;
  set.spacing = spacing;
  ok(mps_particles_create(context, &set, &t->water));
  ok(mps_particles_fill_box(t->water, lo, hi, NULL));
  ok(mps_fluid_create(context, t->water, NULL, &t->fluid));
  ok(mps_signal_create_sine(context, MPS_SIGNAL_QUANTITY_DISPLACEMENT, 1.0 / period, stroke,
                            -0.5 * acos(-1.0), &piston)); /* begins at rest, then pushes */
  add_wall(t->fluid, 0.0, 0.0, 1.0, NULL);
  add_wall(t->fluid, 0.0, 1.0, 0.0, piston);
  t->front = add_wall(t->fluid, length, -1.0, 0.0, NULL);
  mps_signal_destroy(&piston);
}

/* Held at its foot, which passes through the lowest particles. */
static void make_concrete(mps_context *context, tank *t) {
  const double lo[2] = {length, -0.5 * cell}, hi[2] = {length + thick, wall - 0.5 * cell};
  const double foot[2] = {INFINITY, 0.1 * cell};
  mps_particles_def set = mps_particles_defaults();
  mps_elastic_def def = mps_elastic_defaults();
  mps_elastic_boundary_def held = mps_elastic_boundary_defaults();
  mps_material *law = NULL;
  int64_t ids[ROOM], count;
  set.spacing = cell, set.origin[0] = lo[0], set.origin[1] = lo[1];
  def.bending = 1.0; /* five cells across */
  ok(mps_particles_create(context, &set, &t->concrete));
  ok(mps_particles_fill_box(t->concrete, lo, hi, NULL));
  ok(mps_material_create_linear_elastic(context, young, poisson, &law));
  ok(mps_particles_set_material(t->concrete, law, 2400.0, NULL, 0));
  ok(mps_elastic_create(context, t->concrete, &def, &t->elastic));
  ok(mps_particles_select_box(t->concrete, lo, foot, ROOM, &count, ids));
  held.ids = ids, held.id_count = count;
  ok(mps_elastic_cut(t->elastic, MPS_SIDE_Y_LOWER, ids, count));
  ok(mps_elastic_add_boundary(t->elastic, &held, &t->foot));
  ok(mps_elastic_select_facets(t->elastic, MPS_SIDE_X_LOWER, NULL, NULL, ROOM, &t->count,
                               t->facets));
  ok(mps_elastic_get_facets(t->elastic, t->facets, t->count,
                            &(mps_elastic_facet_arrays){.centre = t->centre}));
  t->pressed = mps_elastic_load_defaults();
  t->pressed.kind = MPS_ELASTIC_LOAD_PRESSURE, t->pressed.values = t->pressure;
  t->pressed.ids = t->facets, t->pressed.id_count = t->count;
  ok(mps_elastic_add_load(t->elastic, &t->pressed, &t->load));
  mps_material_destroy(&law);
}

/* Solves for the present pressures: deflection of the wall's top, m, and what its foot bears. */
static double bend(tank *t, mps_reaction *foot) {
  const double corner[2] = {length, wall};
  mps_view u;
  ok(mps_fluid_get_pressure(t->fluid, t->front, t->count, t->centre, t->pressure));
  ok(mps_elastic_set_load(t->elastic, t->load, &t->pressed));
  ok(mps_elastic_solve(t->elastic));
  ok(mps_elastic_get_reaction(t->elastic, t->foot, foot));
  ok(mps_particles_view(t->concrete, "displacement", &u));
  const int64_t id = mps_particles_nearest(t->concrete, corner);
  return *mps_view_f64(&u, mps_particles_index(t->concrete, id), 0);
}

int main(void) {
  mps_context *context = NULL;
  tank t = {0};
  mps_reaction water, foot;
  ok(mps_context_create(NULL, &context, NULL, 0));
  make_water(context, &t);
  make_concrete(context, &t);

  ok(mps_fluid_step(t.fluid, 1)); /* the piston has hardly moved */
  ok(mps_fluid_get_reaction(t.fluid, t.front, &water));
  double top = bend(&t, &foot);
  const double still = 0.5 * rho * g * depth * depth, gap = wall - cell - depth;
  const double ei = young * pow(thick, 3.0) / 12.0, ga = young / (2.4 * (1.0 + poisson)) * thick;
  const double beam = rho * g * pow(depth, 3.0) *
                      (depth * depth / (30.0 * ei) + depth * gap / (24.0 * ei) + 1.0 / (6.0 * ga));
  int wrong = compare("still water: force, N", -water.force[0], still, 0.01 * still);
  wrong += compare("deflection of the top, um", 1e6 * top, 1e6 * beam, 2e4 * beam);

  /* the highest level at the wall before the wave has been to the piston and back */
  const double station = length - spacing;
  double level, rise = 0.0;
  while (mps_fluid_time(t.fluid) < 2.5) {
    ok(mps_fluid_step(t.fluid, 1));
    ok(mps_fluid_get_levels(t.fluid, 1, &station, &level));
    if (level - depth <= rise) continue;
    rise = level - depth;
    ok(mps_fluid_get_reaction(t.fluid, t.front, &water));
    top = bend(&t, &foot);
  }
  double k = 1.0, omega = 2.0 * acos(-1.0) / period; /* omega^2 = g k tanh(k d) */
  for (int n = 0; n < 100; n++) k = 0.5 * (k + omega * omega / (g * tanh(k * depth)));
  const double linear = still + rho * g * rise * (tanh(k * depth) / k + 0.5 * rise);
  printf("crest: %.1f mm above still water, top deflected by %.2f um\n", 1e3 * rise, 1e6 * top);
  wrong += compare("force at the crest, N", -water.force[0], linear, 0.05 * linear);
  wrong += compare("force that the foot bears, N", -foot.force[0], -water.force[0], 1.0);
  wrong += compare("moment that the foot bears, N m", foot.moment[2], water.moment[2], 0.5);

  mps_fluid_destroy(&t.fluid);
  mps_elastic_destroy(&t.elastic);
  mps_particles_destroy(&t.water);
  mps_particles_destroy(&t.concrete);
  mps_context_destroy(&context);
  return wrong > 0;
}
