/* test_fluid_friction.c - friction of faces, tau = f rho v^2/2. A layer of one particle on a bed
 * slows by du/dt = -f u^2/(2 l0), and down a slope it tends to (2 g l0 sin(a)/f)^1/2, on planes and
 * polylines of any angle; a face acts along all its length, however the particles
 * lie. Deeper layers lose what the bed takes, and are a little faster than a block: their lowest
 * particles are slower than the rest.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "test_fixture.h"

#define G 9.81
#define DEGREES 0.017453292519943295

/* A layer of `rows` x `columns` on a face at `angle` to the horizontal, its lattice turned by
 * `lattice` against the face; gravity g has the angle `slope` with the face's normal. */
typedef struct layer {
  double l0;
  int rows, columns;
  double angle, lattice, slope, u0, f, g;
  bool line; /* a polyline in place of a plane */
} layer;

static const layer plain = {.l0 = 0.02, .rows = 1, .columns = 60, .u0 = 1.0, .f = 0.05, .g = G};

typedef struct run {
  mps_particles *water;
  mps_fluid *fluid;
  double along[2], mass; /* kg of a particle */
} run;

static void place(const run *r, double along, double above) {
  const double *t = r->along;
  OK(mps_particles_append(r->water, 1,
                          AT(along * t[0] - above * t[1], along * t[1] + above * t[0])));
}

/* Particles of a lattice that is turned, in the same rectangle. */
static void fill_turned(const layer *p, const run *r) {
  const double length = p->columns * p->l0, height = p->rows * p->l0;
  const int most = p->columns + p->rows;
  for (int i = -most; i < most; i++)
    for (int j = -most; j < most; j++) {
      const double a = (cos(p->lattice) * i - sin(p->lattice) * j + 0.123) * p->l0;
      const double b = (sin(p->lattice) * i + cos(p->lattice) * j + 0.321) * p->l0;
      if (a >= 0.0 && a < length && b >= 0.4 * p->l0 && b < height) place(r, a, b);
    }
}

static void add_face(const layer *p, const run *r) {
  const double *t = r->along;
  const double corner[2][3] = {{-9.0 * t[0], -9.0 * t[1]}, {9.0 * t[0], 9.0 * t[1]}};
  DEF(fluid_boundary, def, .kind = MPS_BOUNDARY_ROLLER, .friction_factor = p->f);
  if (p->line)
    def.corners = corner[0], def.corner_count = 2;
  else
    def.normal[0] = -t[1], def.normal[1] = t[0];
  OK(mps_fluid_add_boundary(r->fluid, &def, NULL));
}

static run begin(const layer *p, double dt) {
  run r = {.along = {cos(p->angle), sin(p->angle)}, .mass = 1000.0 * p->l0 * p->l0};
  USING(particles, mps_particles_create(context, &given, &r.water), .spacing = p->l0);
  for (int i = 0; i < p->columns && p->lattice == 0.0; i++)
    for (int j = 0; j < p->rows; j++) place(&r, (i + 0.5) * p->l0, (j + 0.5) * p->l0);
  if (p->lattice != 0.0) fill_turned(p, &r);
  for (int c = 0; c < 2; c++) OK(mps_particles_set(r.water, "velocity", c, p->u0 * r.along[c]));
  const double down = p->angle - p->slope; /* of gravity, from -y */
  USING(fluid, mps_fluid_create(context, r.water, &given, &r.fluid), .dt = dt,
        .gravity[0] = p->g * sin(down), .gravity[1] = -p->g * cos(down), .level = 0.0);
  add_face(p, &r);
  return r;
}

static void end(run *r) {
  mps_fluid_destroy(&r->fluid);
  mps_particles_destroy(&r->water);
}

/* Mean velocity along the face of the columns from `from` to `to`, as parts of their number. */
static double speed(const run *r, double from, double to) {
  const mps_view u = view_field(r->water, "velocity"), id = view_field(r->water, "id");
  const double all = (double)u.shape[0];
  double sum = 0.0;
  int count = 0;
  for (int64_t i = 0; i < u.shape[0]; i++) {
    const double at = (double)*mps_view_i64(&id, i, 0) / all;
    if (at < from || at > to) continue;
    sum += *mps_view_f64(&u, i, 0) * r->along[0] + *mps_view_f64(&u, i, 1) * r->along[1];
    count++;
  }
  return sum / count;
}

static double taken(const run *r, const double *of) {
  return of[0] * r->along[0] + of[1] * r->along[1];
}

static mps_reaction face_of(const run *r) {
  mps_reaction reaction;
  OK(mps_fluid_get_reaction(r->fluid, 0, &reaction));
  return reaction;
}

static const char *mirrored(int way) { return way < 0 ? "mirrored " : ""; }

/* ---- one layer ------------------------------------------------------------------------------- */

static void slides_by_the_law(layer p) {
  const double T = 20.0 * p.l0; /* f u0 T/(2 l0) = .5 */
  run r = begin(&p, T / 100.0);
  OK(mps_fluid_step(r.fluid, 100));
  const double u = speed(&r, 0.4, 0.6), law = p.u0 / (1.0 + p.f * fabs(p.u0) * T / (2.0 * p.l0));
  printf("row, l0 %g, %g degrees, %s, u0 %+g: u over law %.5f\n", p.l0, p.angle / DEGREES,
         p.line ? "polyline" : "plane", p.u0, u / law);
  NEAR(u / law, 1.0, 2e-3);
  end(&r);
}

TEST(a_row_slows_by_the_law) {
  const double spacings[3] = {0.01, 0.02, 0.04}, angles[4] = {0.0, 10.0, 27.0, 45.0};
  for (int s = 0; s < 3; s++)
    for (int a = 0; a < 4; a++)
      for (int way = -1; way <= 1; way += 2) {
        layer p = plain;
        p.l0 = spacings[s], p.angle = angles[a] * DEGREES, p.u0 = way;
        p.line = (s + a) % 2;
        slides_by_the_law(p);
        p.g = 0.0;
        if (a == 2) slides_by_the_law(p);
      }
}

/* From rest u = V tanh(g sin(a) t/V), V the terminal velocity; .96 of it at the end. Gravity acts
 * first in a step, which takes half a step's share of V off. */
TEST(a_row_runs_down_a_slope_to_its_terminal_velocity) {
  const double spacings[3] = {0.01, 0.02, 0.04}, angles[3] = {10.0, 27.0, 45.0};
  for (int s = 0; s < 3; s++)
    for (int a = 0; a < 3; a++)
      for (int way = -1; way <= 1; way += 2) {
        layer p = plain;
        p.l0 = spacings[s], p.u0 = 0.0, p.line = (s + a) % 2 == 0;
        p.angle = way * angles[a] * DEGREES, p.slope = p.angle;
        p.f = 0.2;
        const double pull = G * sin(-p.slope), V = sqrt(2.0 * fabs(pull) * p.l0 / p.f);
        const double T = 2.0 * V / fabs(pull);
        run r = begin(&p, 0.04 * sqrt(p.l0 / G));
        OK(mps_fluid_run(r.fluid, T, 1000, NULL, NULL));
        const double u = speed(&r, 0.4, 0.6), law = V * tanh(pull * T / V);
        printf("%sslope of %g degrees, l0 %g: u %.4f m/s, %+.2f %% off the law\n", mirrored(way),
               angles[a], p.l0, u, 100.0 * (u / law - 1.0));
        NEAR(u / law, 1.0, 0.006);
        end(&r);
      }
}

/* ---- any lattice ----------------------------------------------------------------------------- */

/* In the first step all particles have u0. */
TEST(a_face_acts_along_all_its_length) {
  const double lattices[5] = {0.0, 10.0, 27.0, 45.0, 71.0}, spacings[3] = {0.005, 0.01, 0.02};
  for (int s = 0; s < 3; s++)
    for (int a = 0; a < 5; a++) {
      layer p = plain;
      p.l0 = spacings[s], p.rows = 6, p.columns = 200, p.g = 0.0;
      p.lattice = lattices[a] * DEGREES, p.angle = (13.0 * a - 20.0) * DEGREES;
      p.u0 = a % 2 ? 1.0 : -1.0, p.line = (s + a) % 2;
      run r = begin(&p, 1e-5);
      OK(mps_fluid_step(r.fluid, 1));
      const double tau = 500.0 * p.f * p.u0 * p.u0, length = p.columns * p.l0;
      const double force = -taken(&r, face_of(&r).force) * p.u0;
      printf("lattice at %g degrees, l0 %g: force %+.2f %% off tau L\n", lattices[a], p.l0,
             100.0 * (force / (tau * length) - 1.0));
      NEAR(force / (tau * length), 1.0, 0.006); /* its ends are within a spacing */
      end(&r);
    }
}

/* ---- deeper layers --------------------------------------------------------------------------- */

/* Above the lowest particles smoothing is one-sided, and no momentum is conserved by it. */
TEST(layers_lose_what_the_bed_takes) {
  for (int rows = 2; rows <= 8; rows += rows < 4 ? 1 : 2)
    for (int way = -1; way <= 1; way += 2) {
      layer p = plain;
      p.rows = rows, p.u0 = way, p.line = rows == 3, p.angle = 17.0 * way * DEGREES;
      const double T = 0.4, block = p.u0 / (1.0 + p.f * T / (2.0 * rows * p.l0));
      run r = begin(&p, T / 200.0);
      OK(mps_fluid_step(r.fluid, 200));
      const double water = (double)(p.rows * p.columns) * r.mass * (speed(&r, 0.0, 1.0) - p.u0);
      const double bed = taken(&r, face_of(&r).impulse), u = speed(&r, 0.4, 0.6);
      printf("%s%d rows: the water's change of momentum %+.1f %% off the bed's impulse; u %+.1f %% "
             "off a block's\n",
             mirrored(way), rows, 100.0 * (water / bed - 1.0), 100.0 * (u / block - 1.0));
      NEAR(water / bed, 1.0, rows > 4 ? 0.15 : 0.05);
      NEAR(u / block, 1.0, 0.03);
      end(&r);
    }
}

/* ---- bounds ---------------------------------------------------------------------------------- */

/* However large f: the face never drives the water, energy falls, and the water does not turn. */
TEST(friction_stops_water_and_never_turns_it) {
  const double factors[3] = {0.01, 1.0, 1e6};
  for (int k = 0; k < 3; k++)
    for (int rows = 1; rows <= 3; rows++) {
      layer p = plain;
      p.f = factors[k], p.rows = rows, p.g = 0.0, p.line = rows == 2, p.angle = 0.3;
      run r = begin(&p, 1e-3);
      double energy = INFINITY;
      for (int n = 0; n < 60; n++) {
        mps_totals totals;
        OK(mps_fluid_step(r.fluid, 1));
        OK(mps_fluid_get_totals(r.fluid, &totals));
        if (taken(&r, face_of(&r).force) > 0.0) fail_msg("step %d, f %g: it is driven", n, p.f);
        if (totals.kinetic > energy * (1.0 + 1e-12)) fail_msg("step %d, f %g: energy", n, p.f);
        energy = totals.kinetic;
        NEAR(face_of(&r).work, 0.0, 0.0);
      }
      const double u = speed(&r, 0.0, 1.0);
      printf("f %g, %d rows: u %.2g m/s\n", p.f, rows, u);
      if (!(u >= 0.0)) fail_msg("f %g: it runs back, %g m/s", p.f, u);
      if (rows == 1 && k == 2) NEAR(u, 0.0, 1e-3);
      end(&r);
    }
}
