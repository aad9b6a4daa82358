/* test_textbook_crater.c - a sphere dropped on loose grains: the depth at which it comes to rest
 * against the law of experiments, d = 0.14/mu (rho_b/rho_g)^(1/2) D^(2/3) H^(1/3), of which H is
 * the whole drop, d included (J. S. Uehara, M. A. Ambroso, R. P. Ojha, D. J. Durian: Low-speed
 * impact craters in loose granular media, Phys. Rev. Lett. 90 (2003) 194301). The grains are a
 * continuum of Coulomb's strength at constant volume, in axisymmetry.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "mpm_scene.h"

#include "test_fixture.h"
#include "textbook_table.h"

#define G 9.81
#define DIAMETER 0.025 /* m, of the sphere */
#define DENSITY 1520.0 /* kg/m3, of the glass beads as poured */
#define FRICTION 0.45  /* tan of their angle of repose */
#define SURFACE 0.3    /* friction of the sphere */
#define YOUNG 1e6      /* Pa, of the bed: its weight compresses it by 0.1 % */
#define WIDTH 4.0      /* radius and depth of the bed over D */
#define END 0.2        /* s */

typedef struct drop {
  const char *name;
  double density; /* kg/m3, of the sphere */
  double fall;    /* m, of its lowest point to the surface */
} drop;

static double law(const drop *d, double depth) {
  return 0.14 / FRICTION * sqrt(d->density / DENSITY) * pow(DIAMETER, 2.0 / 3.0) *
         cbrt(d->fall + depth);
}

/* The depth that is that of the law for its own total drop. */
static double expected(const drop *d) {
  double depth = DIAMETER;
  for (int k = 0; k < 60; k++) depth = law(d, depth);
  return depth;
}

static void make_bed(mpm_scene *s, double cell) {
  *s = mpm_scene_begin(context, 0.5 * cell, 0.0, 0.0, YOUNG);
  mps_material_destroy(&s->material);
  DEF(material_mohr_coulomb, grains, .young = YOUNG, .friction = atan(FRICTION), .cohesion = 1.0);
  OK(mps_material_create_mohr_coulomb(context, &grains, &s->material));
  mpm_scene_box(s, 0.0, 0.0, WIDTH * DIAMETER, WIDTH * DIAMETER);
  mpm_scene_weigh(s, DENSITY * G, 0.5, WIDTH * DIAMETER);
  OK(mps_particles_set(s->particles, "density", 0, DENSITY));
  USING(mpm, mps_mpm_create(context, s->particles, s->material, &given, &s->mpm),
        .geometry = MPS_MPM_GEOMETRY_AXISYMMETRIC, .cell = cell, .lower[0] = given.lower[1] = 0.0,
        .upper[0] = WIDTH * DIAMETER, .upper[1] = 2.0 * WIDTH * DIAMETER, .gravity[1] = -G);
  mpm_scene_side(s, MPS_SIDE_X_UPPER, MPS_BOUNDARY_ROLLER, 0.0);
  mpm_scene_side(s, MPS_SIDE_Y_LOWER, MPS_BOUNDARY_ROLLER, 0.0);
}

static mps_body *make_sphere(mpm_scene *s, const drop *d) {
  DEF(body, def, .motion = MPS_BODY_MOTION_FREE);
  const double mass = d->density * PI * DIAMETER * DIAMETER * DIAMETER / 6.0;
  def.position[1] = (WIDTH + 0.5) * DIAMETER;
  def.velocity[1] = -sqrt(2.0 * G * d->fall);
  def.gravity[1] = -G;
  def.mass = mass;
  def.inertia[2] = 0.1 * mass * DIAMETER * DIAMETER;
  MAKE_KEPT(body, sphere, create_disc, context, &def, 0.5 * DIAMETER);
  mpm_scene_contact(s, sphere, SURFACE);
  return sphere;
}

/* How deep its lowest point comes, over the depth of the law. */
static double fall_into_bed(const drop *d, int cells) {
  mpm_scene s;
  mps_body_state state;
  mps_body_totals totals;
  const double began = textbook_cost(), exact = expected(d);
  make_bed(&s, DIAMETER / cells);
  scoped_body *sphere = make_sphere(&s, d);
  FILE *f = textbook_table(d->name, "t_s,depth_m,velocity_m_s");
  double deepest = 0.0;
  for (int k = 1; k <= 100; k++) {
    OK(mps_mpm_run(s.mpm, END * k / 100.0, 1000000, NULL, NULL));
    OK(mps_body_get_state(sphere, &state));
    const double depth = (WIDTH + 0.5) * DIAMETER - state.position[1];
    deepest = fmax(deepest, depth);
    textbook_row(f, 3, (double[]){state.time, depth, state.velocity[1]});
  }
  textbook_close(f);
  OK(mps_body_get_totals(sphere, &totals));
  NEAR(state.position[0], 0.0, 0.0); /* on the axis, and not turned */
  NEAR(state.spin[2], 0.0, 0.0);
  NEAR(state.velocity[1], 0.0, 0.02); /* at rest */
  print_message("%s, D/%d: depth %.2f mm, law %.2f mm (%+.1f %%), %.1f s\n", d->name, cells,
                1e3 * deepest, 1e3 * exact, 100.0 * (deepest / exact - 1.0),
                textbook_cost() - began);
  mpm_scene_end(&s);
  return deepest / exact;
}

static int cells = 10; /* of the grid over D; another number as the argument */

static void spheres_come_to_rest_at_the_depth_of_experiments(void **state) {
  static const drop list[] = {{"crater_glass", 2200.0, 0.1},
                              {"crater_glass_high", 2200.0, 0.4},
                              {"crater_steel", 7800.0, 0.1},
                              {"crater_wood", 700.0, 0.1}};
  for (size_t k = 0; k < sizeof list / sizeof *list; k++)
    NEAR(fall_into_bed(&list[k], cells), 1.0, cells < 20 ? 0.3 : 0.15);
}

int main(int argc, char **argv) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(spheres_come_to_rest_at_the_depth_of_experiments)};
  if (argc > 1) cells = atoi(argv[1]);
  return cmocka_run_group_tests(tests, make_context, drop_context);
}
