/* test_mpm_pore_implicit.c - implicit pressures of pore water where explicit ones, or a closed
 * form, say what is right: ground with a free face, stiff water, bodies that come to rest, all
 * kinds of sides, cells of every filling. SPDX-License-Identifier: BSD-3-Clause */
#include "pore_column.h"
#include "test_fixture.h"

#define WEIGHT 9.81 /* m/s2 */

/* ---- ground ---------------------------------------------------------------------------------- */

typedef struct ground {
  mpm_scene s;
  mps_body *body;
  mps_contact *contact;
} ground;

/* What the ground of a test is. */
typedef struct kind {
  int dim;
  double h, left, right, high; /* m: cell; the ground from left to right, within 0 to `wide` */
  double wide;
  double young, cohesion; /* Pa; cohesion NaN: elastic */
  double bulk, k, courant, gravity_x;
  int32_t scheme;
} kind;

static const kind usual = {.dim = 2,
                           .h = 0.25,
                           .left = 0.125,
                           .right = 2.375,
                           .wide = 2.5,
                           .high = 1.5,
                           .young = 2e6,
                           .cohesion = NAN,
                           .bulk = 2.2e9,
                           .k = 1e-4,
                           .courant = 0.5,
                           .scheme = MPS_PORE_SCHEME_IMPLICIT};

static mps_material *material_of(const kind *of) {
  mps_material *out = NULL;
  if (isnan(of->cohesion)) {
    OK(mps_material_create_linear_elastic(context, of->young, 0.3, &out));
    return out;
  }
  DEF(material_mohr_coulomb, def, .young = of->young, .friction = 0.5, .cohesion = of->cohesion);
  OK(mps_material_create_mohr_coulomb(context, &def, &out));
  return out;
}

/* At rest under its weight, water up to its surface. */
static ground begin(const kind *of) {
  ground g = {.s.context = context};
  const double lo[] = {of->left, 0.0, 0.0}, hi[] = {of->right, of->high, of->h};
  const double level[] = {0.0, of->high, 0.0};
  const mps_geostatic_layer layer = {INFINITY, 0.5, 1000.0};
  DEF(particles, set, .dim = of->dim, .spacing = 0.5 * of->h);
  OK(mps_particles_create(context, &set, &g.s.particles));
  OK(mps_particles_fill_box(g.s.particles, lo, hi, NULL));
  OK(mps_particles_set(g.s.particles, "density", 0, 2000.0));
  DEF(geostatic, stress, .layers = &layer, .layer_count = 1);
  OK(mps_particles_set_geostatic(g.s.particles, &stress));
  g.s.material = material_of(of);
  mps_mpm_def def = mps_mpm_defaults();
  if (of->dim == 3) def.geometry = MPS_MPM_GEOMETRY_SPACE, def.lower[2] = 0.0, def.upper[2] = of->h;
  def.cell = of->h, def.lower[0] = def.lower[1] = 0.0, def.upper[0] = of->wide;
  def.upper[1] = 3.0 * of->high, def.courant = of->courant;
  def.gravity[0] = of->gravity_x, def.gravity[1] = -WEIGHT;
  OK(mps_mpm_create(context, g.s.particles, g.s.material, &def, &g.s.mpm));
  USING(pore_water, mps_mpm_add_pore_water(g.s.mpm, &given), .scheme = of->scheme, .porosity = 0.4,
        .bulk = of->bulk, .permeability = of->k);
  OK(mps_mpm_set_pore_level(g.s.mpm, level));
  return g;
}

static void end(ground *g) {
  if (g->contact) mps_contact_destroy(&g->contact);
  if (g->body) mps_body_destroy(&g->body);
  mpm_scene_end(&g->s);
}

/* Largest pressure and speed; range of the porosities. */
typedef struct extremes {
  double p, v, n[2];
} extremes;

static extremes look(ground *g) {
  extremes out = {.n = {1.0, 0.0}};
  const mps_view u = mpm_scene_view(&g->s, "pore_pressure");
  const mps_view n = mpm_scene_view(&g->s, "porosity"), v = mpm_scene_view(&g->s, "velocity");
  for (int64_t k = 0; k < u.shape[0]; k++) {
    const double porosity = *mps_view_f64(&n, k, 0);
    out.p = fmax(out.p, fabs(*mps_view_f64(&u, k, 0)));
    out.v = fmax(out.v, hypot(*mps_view_f64(&v, k, 0), *mps_view_f64(&v, k, 1)));
    out.n[0] = fmin(out.n[0], porosity), out.n[1] = fmax(out.n[1], porosity);
  }
  return out;
}

/* ---- ground at rest -------------------------------------------------------------------------- */

/* A block of ground with free faces slumps and comes to rest; pressures stay near those of its
 * weight, 29 kPa. */
static void rests(const char *name, const kind *of, int64_t steps) {
  SCOPED(end) ground g = begin(of);
  double most = 0.0;
  extremes now = {0};
  for (int part = 0; part < 20; part++) {
    OK(mps_mpm_step(g.s.mpm, steps / 20));
    now = look(&g);
    most = fmax(most, now.p);
    assert_true(now.n[0] > 0.3 && now.n[1] < 0.5);
  }
  print_message("%s: largest pressure %.4g Pa, at the end %.4g Pa and %.2g m/s\n", name, most,
                now.p, now.v);
  assert_true(most <
              6e4); /* a weight that is released at once bears up to twice what it does at rest */
  assert_true(now.p < 4e4);
}

TEST(faces_stand) {
  static const double permeability[] = {1e-3, 1e-4, 1e-6}, courant[] = {0.5, 0.9};
  for (int k = 0; k < 3; k++)
    for (int c = 0; c < 2; c++) {
      kind of = usual;
      char name[80];
      of.k = permeability[k], of.courant = courant[c];
      (void)snprintf(name, sizeof name, "k %g m/s, courant %g", of.k, of.courant);
      rests(name, &of, 400);
    }
}

TEST(faces_stand_of_other_ground) {
  kind of = usual;
  of.cohesion = 1e3;
  rests("frictional", &of, 400);
  of = usual, of.bulk = 2e7;
  rests("soft water", &of, 400);
  of = usual, of.h = 0.125, of.left = 0.1, of.right = 2.45;
  rests("finer, off the grid", &of, 400);
  of = usual, of.dim = 3, of.h = 0.375, of.wide = 2.25, of.left = 0.1, of.right = 2.1;
  rests("in space", &of, 200);
}

/* Ten thousand steps. */
TEST(stays_for_long) {
  for (int c = 0; c < 2; c++) {
    kind of = usual;
    of.h = 0.5, of.left = 0.2, of.right = 2.3, of.courant = c == 0 ? 0.5 : 0.9;
    rests("ten thousand steps", &of, 10000);
  }
}

/* ---- bodies ---------------------------------------------------------------------------------- */

/* A disc of 400 kg falls 0.05 m on sand without cohesion and comes to rest on it. */
static void disc_rests(double courant, double bulk, double k) {
  kind of = usual;
  const double r = 0.3, mass = 400.0;
  of.h = 0.1, of.left = 0.0, of.right = of.wide = 2.0, of.high = 0.8, of.young = 1e7;
  of.cohesion = 0.0, of.courant = courant, of.bulk = bulk, of.k = k;
  SCOPED(end) ground g = begin(&of);
  DEF(body, def, .position[0] = 1.0, .position[1] = 0.8 + r + 0.05, .motion = MPS_BODY_MOTION_FREE,
      .mass = mass, .inertia[2] = 0.5 * mass * r * r, .gravity[1] = -WEIGHT);
  OK(mps_body_create_disc(context, &def, r, &g.body));
  OK(mps_mpm_add_contact(g.s.mpm, g.body, NULL, &g.contact));
  OK(mps_mpm_run(g.s.mpm, 0.6, 1000000, NULL, NULL));
  double force = 0.0; /* mean over some periods of the ground */
  enum { SAMPLES = 50 };
  extremes most = {.n = {1.0, 0.0}};
  for (int part = 0; part < SAMPLES; part++) {
    mps_reaction reaction;
    OK(mps_mpm_run(g.s.mpm, 0.6 + 0.004 * (part + 1), 1000000, NULL, NULL));
    OK(mps_contact_get_reaction(g.contact, -1, &reaction));
    force += reaction.force[1] / SAMPLES;
    const extremes now = look(&g);
    most.p = fmax(most.p, now.p), most.v = fmax(most.v, now.v);
  }
  print_message("disc, courant %g, K_w %g Pa, k %g m/s: bears %.1f N of %.1f, pressure %.4g Pa, "
                "%.2g m/s\n",
                courant, bulk, k, force, mass * WEIGHT, most.p, most.v);
  NEAR(force, mass * WEIGHT, 0.05 * mass * WEIGHT);
  assert_true(most.p < 2e4);
}

TEST(discs_rest) {
  disc_rests(0.5, NAN, 1e-4);
  disc_rests(0.9, NAN, 1e-4);
  disc_rests(0.5, NAN, 1e-3);
}

/* ---- sides ----------------------------------------------------------------------------------- */

/* Force (N) on a side of a block of ground, mean over time, and its largest pressure. */
typedef struct borne {
  double force, p;
} borne;

static borne bear(int32_t scheme, int32_t side, int32_t which, double friction, double k,
                  double gravity_x) {
  kind of = usual;
  of.h = 0.1, of.left = 0.0, of.right = of.wide = 1.0, of.high = 1.0, of.young = 1e7;
  of.scheme = scheme, of.bulk = NAN, of.k = k, of.gravity_x = gravity_x;
  SCOPED(end) ground g = begin(&of);
  borne out = {0.0, 0.0};
  enum { SAMPLES = 25 };
  mpm_scene_side(&g.s, side, which, friction);
  for (int part = 0; part < 2 * SAMPLES; part++) {
    double force[3];
    OK(mps_mpm_run(g.s.mpm, 0.016 * (part + 1), 1000000, NULL, NULL));
    mpm_scene_force(&g.s, side, force);
    if (part >= SAMPLES) out.force += force[side / 2] / SAMPLES;
    if (part >= SAMPLES) out.p = fmax(out.p, look(&g).p);
  }
  return out;
}

/* Implicit pressures are those of explicit ones whatever the side. */
TEST(sides_bear) {
  static const struct {
    const char *name;
    int32_t side, kind;
    double friction, k, gravity_x;
  } cases[] = {{"smooth floor", MPS_SIDE_Y_LOWER, MPS_BOUNDARY_ROLLER, 0.0, 1e-4, 0.0},
               {"frictional floor", MPS_SIDE_Y_LOWER, MPS_BOUNDARY_FRICTIONAL, 0.5, 1e-4, 0.0},
               {"frictional floor, hardly drained", MPS_SIDE_Y_LOWER, MPS_BOUNDARY_FRICTIONAL, 0.5,
                1e-9, 0.0},
               {"frictional wall", MPS_SIDE_X_LOWER, MPS_BOUNDARY_FRICTIONAL, 0.3, 1e-4, 0.0},
               {"absorbing floor", MPS_SIDE_Y_LOWER, MPS_BOUNDARY_ABSORBING, 0.0, 1e-4, 0.0},
               {"absorbing wall", MPS_SIDE_X_LOWER, MPS_BOUNDARY_ABSORBING, 0.0, 1e-4, 0.0}};
  for (size_t c = 0; c < sizeof cases / sizeof *cases; c++) {
    const borne right = bear(MPS_PORE_SCHEME_EXPLICIT, cases[c].side, cases[c].kind,
                             cases[c].friction, cases[c].k, cases[c].gravity_x);
    const borne got = bear(MPS_PORE_SCHEME_IMPLICIT, cases[c].side, cases[c].kind,
                           cases[c].friction, cases[c].k, cases[c].gravity_x);
    print_message("%s: %.1f N, %.1f Pa; explicit %.1f N, %.1f Pa\n", cases[c].name, got.force,
                  got.p, right.force, right.p);
    NEAR(got.force, right.force, 0.05 * fabs(right.force));
    NEAR(got.p, right.p, 0.05 * right.p);
  }
}

/* ---- stiff water ----------------------------------------------------------------------------- */

/* Terzaghi with K_w/n = 2000 M' and a layer that a second would drain: what the step is long
 * against. */
TEST(stiff_water_consolidates) {
  static const double stiffness[] = {50.0, 500.0, 2000.0};
  for (int q = 0; q < 3; q++) {
    pore_column c = pore_column_begin(context, MPS_MPM_GEOMETRY_PLANE_STRAIN, 10, 0.0, 10.0);
    const double load = 1000.0, c_v = 1.0; /* Pa, m2/s: T = 1 is a second */
    USING(pore_water, mps_mpm_add_pore_water(c.s.mpm, &given), .scheme = MPS_PORE_SCHEME_IMPLICIT,
          .porosity = 0.4, .bulk = 0.4 * stiffness[q] * c.modulus,
          .permeability = c_v * 1000.0 * MPS_PORE_GRAVITY / c.modulus);
    OK(mps_particles_set(c.s.particles, "pore_pressure", 0, load));
    int64_t ids[16];
    const double traction[] = {0.0, -load, 0.0};
    mps_mpm_load_def def =
        mpm_scene_load_def(pore_column_top(&c, ids, 16), ids, NULL, traction, 3, NULL);
    OK(mps_mpm_add_load(c.s.mpm, &def, NULL));
    OK(mps_mpm_run(c.s.mpm, 0.3, 1000000, NULL, NULL));
    const mps_view x = mpm_scene_view(&c.s, "position"), u = mpm_scene_view(&c.s, "pore_pressure");
    double worst = 0.0;
    for (int64_t k = 0; k < x.shape[0]; k++)
      worst = fmax(worst, fabs(*mps_view_f64(&u, k, 0) / load -
                               pore_terzaghi(1.0 - *mps_view_f64(&x, k, 1), 0.3)));
    mps_pore_budget budget;
    OK(mps_mpm_get_pore_budget(c.s.mpm, &budget));
    print_message("K_w/n = %g M': u/q within %.2f %%, residual %.1e of %.3g kg drained\n",
                  stiffness[q], 100.0 * worst, budget.residual, budget.drained);
    assert_true(worst < 0.03);
    assert_true(fabs(budget.residual) < 0.02 * budget.drained);
    mpm_scene_end(&c.s);
  }
}
