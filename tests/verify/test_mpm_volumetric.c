/* test_mpm_volumetric.c - F-bar by cell: it changes nothing in uniform strain; a nearly
 * incompressible footing does not lock and its pressures do not oscillate.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "mpm_scene.h"
#include "test_fixture.h"

/* A ball of `material` that deforms by a uniform velocity gradient; the nodes are not needed for
 * it: one step. */
static mpm_scene stretched(int32_t geometry, int32_t spline, int32_t volumetric, bool rubber) {
  const int dim = geometry == MPS_MPM_GEOMETRY_SPACE ? 3 : 2;
  const double v0[] = {0.3, -0.2, 0.1}, centre[] = {0.1, 0.0, 0.0};
  const double plane[] = {3.0, -7.0, 4.0, 9.0}, axial[] = {3.0, 0.0, 0.0, 9.0};
  const double space[] = {3.0, -7.0, 3.0, 4.0, 9.0, -5.0, -2.0, 6.0, 8.0};
  const double still[] = {0.0, -0.2, 0.0};
  const bool axis = geometry == MPS_MPM_GEOMETRY_AXISYMMETRIC;
  mpm_scene s = mpm_scene_begin_in(context, dim, 0.01, 0.003, 0.001, 1e6);
  if (rubber) {
    mps_material_destroy(&s.material);
    OK(mps_material_create_neo_hookean(context, 1e6, 0.3, &s.material));
  }
  OK(mps_particles_fill_ball(s.particles, centre, 0.07, NULL));
  mpm_scene_affine(&s, axis ? still : v0, dim == 3 ? space : axis ? axial : plane);
  DEF(mpm, def, .geometry = geometry, .spline = spline, .cell = 0.02, .volumetric = volumetric);
  mpm_scene_solve(&s, &def);
  OK(mps_mpm_step(s.mpm, 1));
  return s;
}

TEST(uniform_strain_is_untouched) {
  for (int variant = 0; variant < 24; variant++) {
    const int geometry = variant % 12 / 4, spline = 2 + variant % 2;
    const bool rubber = variant / 2 % 2;
    scoped_mpm_scene a = stretched(geometry, spline, MPS_MPM_VOLUMETRIC_POINT, rubber);
    mpm_scene b =
        stretched(geometry, spline,
                  variant < 12 ? MPS_MPM_VOLUMETRIC_CELL : MPS_MPM_VOLUMETRIC_NODES, rubber);
    mps_view s = mpm_scene_view(&a, "stress"), S = mpm_scene_view(&b, "stress");
    mps_view V = mpm_scene_view(&a, "volume"), W = mpm_scene_view(&b, "volume");
    double worst = 0.0, largest = 0.0;
    for (int64_t k = 0; k < s.shape[0]; k++) {
      for (int c = 0; c < s.shape[1]; c++) {
        worst = fmax(worst, fabs(*mps_view_f64(&s, k, c) - *mps_view_f64(&S, k, c)));
        largest = fmax(largest, fabs(*mps_view_f64(&s, k, c)));
      }
      NEAR(*mps_view_f64(&W, k, 0) / *mps_view_f64(&V, k, 0), 1.0, 1e-14);
    }
    assert_true(largest > 0.0);
    if (worst > 1e-12 * largest)
      fail_msg("geometry %d, spline %d: stress differs by %g of %g Pa", geometry, spline, worst,
               largest);
    mpm_scene_end(&b);
  }
}

/* ---- the means themselves -------------------------------------------------------------------- */

#define SIDE 32 /* cells that the scene below stays in, along each axis */

static int cell_of(const mps_view *x, int64_t k, int dim, double h) {
  int cell = 0;
  for (int c = dim - 1; c >= 0; c--)
    cell = SIDE * cell + (int)floor(*mps_view_f64(x, k, c) / h) + SIDE / 2;
  return cell;
}

static double trace_of(const mps_view *L, int64_t k) {
  const int zz = 4; /* 2D: the hoop, 0 in plane strain; 3D: yy */
  const int64_t last = L->shape[1] - 1;
  if (last == zz) return *mps_view_f64(L, k, 0) + *mps_view_f64(L, k, 3) + *mps_view_f64(L, k, 4);
  return *mps_view_f64(L, k, 0) + *mps_view_f64(L, k, 4) + *mps_view_f64(L, k, 8);
}

/* A lump that shakes at random flies off its blocks; then the stress is set to zero for one step.
 * In that step every particle's pressure is that of the mean of its cell, whatever its block. */
static void takes_the_mean(int32_t geometry) {
  static double volume[SIDE * SIDE * SIDE], change[SIDE * SIDE * SIDE], held[20000];
  static int cell[20000];
  const int dim = geometry == MPS_MPM_GEOMETRY_SPACE ? 3 : 2;
  const double h = 0.02, E = 1e6, bulk = E / (3.0 * (1.0 - 2.0 * 0.3)), dt = 1e-4;
  const double centre[] = {0.11, 0.0, 0.0};
  scoped_mpm_scene s = mpm_scene_begin_in(context, dim, 0.01, 0.003, 0.001, E);
  OK(mps_particles_fill_ball(s.particles, centre, 0.1, NULL));
  OK(mps_particles_add_field(s.particles, "velocity", 0));
  mps_edit v = mpm_scene_edit(&s, "velocity");
  uint64_t seed = 1;
  for (int64_t k = 0; k < v.view.shape[0]; k++)
    for (int c = 0; c < dim; c++) {
      seed = seed * UINT64_C(6364136223846793005) + UINT64_C(1442695040888963407);
      *mps_edit_f64(&v, k, c) = (c == 1 ? 8.0 : 0.0) + 4.0 * (double)(seed >> 11) * 0x1p-53;
    }
  mpm_scene_commit(&s, &v);
  DEF(mpm, def, .geometry = geometry, .cell = h, .dt = dt, .volumetric = MPS_MPM_VOLUMETRIC_CELL);
  mpm_scene_solve(&s, &def);
  OK(/* means of fields, and not of derivatives */
     mps_experimental_mpm_strain(s.mpm, MPS_EXPERIMENTAL_STRAIN_FIT));
  OK(mps_mpm_step(s.mpm, 15)); /* 12 to 18 mm: within a cell of the blocks */
  mps_view x = mpm_scene_view(&s, "position"), L = mpm_scene_view(&s, "velocity_gradient");
  mps_view V = mpm_scene_view(&s, "volume");
  mps_edit stress = mpm_scene_edit(&s, "stress");
  memset(volume, 0, sizeof volume), memset(change, 0, sizeof change);
  const int64_t count = x.shape[0];
  assert_in_range(count, 200, 20000);
  for (int64_t k = 0; k < count; k++) {
    cell[k] = cell_of(&x, k, dim, h);
    held[k] = *mps_view_f64(&V, k, 0);
    for (int c = 0; c < stress.view.shape[1]; c++) *mps_edit_f64(&stress, k, c) = 0.0;
  }
  mpm_scene_commit(&s, &stress);
  const uint64_t epoch = mps_particles_epoch(s.particles);
  OK(mps_mpm_step(s.mpm, 1));
  assert_true(mps_particles_epoch(s.particles) == epoch); /* not sorted: some are off their block */
  for (int64_t k = 0; k < count; k++) {
    volume[cell[k]] += held[k];
    change[cell[k]] += held[k] * trace_of(&L, k);
  }
  double worst = 0.0, largest = 0.0, apart = 0.0;
  for (int64_t k = 0; k < count; k++) {
    double p = 0.0;
    for (int c = 0; c < 3; c++) p += *mps_view_f64(&stress.view, k, c) / 3.0;
    const double exact = bulk * dt * change[cell[k]] / volume[cell[k]];
    worst = fmax(worst, fabs(p - exact));
    largest = fmax(largest, fabs(exact));
    apart = fmax(apart, fabs(p - bulk * dt * trace_of(&L, k)));
    NEAR(*mps_view_f64(&V, k, 0) / held[k], 1.0 + exact / bulk, 1e-12);
  }
  assert_true(apart > 0.1 * largest); /* its own would have been another */
  if (worst > 1e-12 * largest)
    fail_msg("geometry %d: pressure off by %g of %g Pa", geometry, worst, largest);
}

TEST(pressure_is_of_the_cell) {
  for (int32_t geometry = 0; geometry <= MPS_MPM_GEOMETRY_SPACE; geometry++)
    takes_the_mean(geometry);
}

/* ---- nearly incompressible cantilever -------------------------------------------------------- */

enum { LENGTH_CELLS = 20, HEIGHT_CELLS = 4 };

static double tip_of(mpm_scene *s, double from) {
  mps_view x = mpm_scene_view(s, "position");
  double sum = 0.0;
  int64_t count = 0;
  for (int64_t k = 0; k < x.shape[0]; k++)
    if (*mps_view_f64(&x, k, 0) > from) sum += *mps_view_f64(&x, k, 1), count++;
  return sum / (double)count;
}

/* Fixed at x = 0, gravity from t = 0 on: the tip oscillates about its deflection at rest, which is
 * the mean up to the turning point. Over that of a beam in plane strain with its shear. */
static double deflection(int32_t spline, int32_t volumetric) {
  const double h = 0.05, E = 1e6, nu = 0.499, rho = 1000.0, g = 0.02;
  const double length = h * LENGTH_CELLS, height = h * HEIGHT_CELLS;
  mpm_scene s = mpm_scene_begin(context, 0.5 * h, 0.0, 0.0, E);
  mps_material_destroy(&s.material);
  OK(mps_material_create_linear_elastic(context, E, nu, &s.material));
  mpm_scene_box(&s, 0.0, 0.0, length, height);
  USING(mpm, mpm_scene_solve(&s, &given), .cell = h, .spline = spline, .volumetric = volumetric,
        .lower[0] = 0.0, .gravity[1] = -g);
  mpm_scene_side(&s, MPS_SIDE_X_LOWER, MPS_BOUNDARY_HELD, 0.0);
  const double load = rho * g * height, plane = E / (1.0 - nu * nu), shear = 0.5 * E / (1.0 + nu);
  const double exact = load * pow(length, 4.0) / (8.0 * plane * pow(height, 3.0) / 12.0) +
                       load * length * length / (2.0 * 5.0 / 6.0 * shear * height);
  const double start = tip_of(&s, length - h);
  double sum = 0.0, before = 0.0, down = 0.0, mean = 0.0;
  while (down >= 0.9 * before) { /* a little beyond the turning point */
    const double dt = mps_mpm_dt(s.mpm);
    OK(mps_mpm_step(s.mpm, 1));
    down = start - tip_of(&s, length - h);
    sum += dt * down;
    if (down < before) continue;
    before = down;
    mean = sum / mps_mpm_time(s.mpm);
  }
  mpm_scene_end(&s);
  return mean / exact;
}

TEST(cantilever_bends) {
  for (int32_t spline = 2; spline <= 3; spline++) {
    const double point = deflection(spline, MPS_MPM_VOLUMETRIC_POINT);
    const double cell = deflection(spline, MPS_MPM_VOLUMETRIC_CELL);
    const double nodes = deflection(spline, MPS_MPM_VOLUMETRIC_NODES);
    print_message(
        "cantilever, nu = 0.499, spline %d: deflection over exact: %.3f, by cell %.3f, by "
        "nodes %.3f\n",
        spline, point, cell, nodes);
    assert_true(nodes > 0.9 && nodes < 1.0);
    assert_true(cell > (spline == 3 ? 0.9 : 0.85) && cell < 1.02);
    assert_true(1.0 - cell < 0.6 * (1.0 - point));
  }
}

/* ---- nearly incompressible footing ----------------------------------------------------------- */

#define COHESION 1e4 /* Pa */

enum { NX = 20, NY = 12 }; /* cells of 0.1 m */

/* Mean pressures of the cells, and their numbers of particles. */
static void cell_pressures(mpm_scene *s, double *p, int *count) {
  mps_view x = mpm_scene_view(s, "position"), stress = mpm_scene_view(s, "stress");
  for (int64_t k = 0; k < x.shape[0]; k++) {
    const int i = (int)(*mps_view_f64(&x, k, 0) / 0.1), j = (int)(*mps_view_f64(&x, k, 1) / 0.1);
    if (i < 0 || i >= NX || j < 0 || j >= NY) continue;
    for (int c = 0; c < 3; c++) p[NX * j + i] -= *mps_view_f64(&stress, k, c) / 3.0;
    count[NX * j + i]++;
  }
  for (int k = 0; k < NX * NY; k++)
    if (count[k] > 0) p[k] /= count[k];
}

/* Root mean square of a cell's pressure less that of its four neighbours, below the footing and
 * beside it. */
static double roughness(mpm_scene *s) {
  double p[NX * NY] = {0.0}, square = 0.0;
  int count[NX * NY] = {0}, cells = 0;
  cell_pressures(s, p, count);
  for (int j = 4; j < NY - 2; j++)
    for (int i = 1; i < 14; i++) {
      const int k = NX * j + i;
      if (!count[k] || !count[k - 1] || !count[k + 1] || !count[k - NX] || !count[k + NX]) continue;
      const double d = p[k] - 0.25 * (p[k - 1] + p[k + 1] + p[k - NX] + p[k + NX]);
      square += d * d;
      cells++;
    }
  assert_true(cells > 50);
  return sqrt(square / cells);
}

/* A smooth rigid footing of half width 0.5 m goes 20 mm into von Mises ground of nu = 0.499;
 * returns the mean pressure over the last quarter. */
static double footing(int32_t spline, int32_t volumetric, double *rough) {
  const double half = 0.5, speed = 0.08, ramp = 0.1, t_end = 0.3;
  const double t[] = {0.0, ramp, 1.0}, v[] = {0.0, speed, speed}, height = 0.1 * NY;
  mpm_scene s = mpm_scene_begin(context, 0.05, 0.0, 0.0, 1e6);
  DEF(material_von_mises, law, .young = 1e3 * COHESION, .poisson = 0.499,
      .yield_stress = sqrt(3.0) * COHESION);
  mps_material_destroy(&s.material);
  OK(mps_material_create_von_mises(context, &law, &s.material));
  mpm_scene_box(&s, 0.0, 0.0, 0.1 * NX, height);
  USING(mpm, mpm_scene_solve(&s, &given), .cell = 0.1, .spline = spline, .volumetric = volumetric,
        .lower[0] = given.lower[1] = 0.0, .upper[0] = 0.1 * NX);
  mpm_scene_side(&s, MPS_SIDE_Y_LOWER, MPS_BOUNDARY_HELD, 0.0);
  scoped_body *body = NULL;
  DEF(body, plate, .position[1] = height + 0.25);
  MAKE(signal, down, create_table, context, MPS_SIGNAL_QUANTITY_VELOCITY, 3, t, v);
  OK(mps_body_create_box(context, &plate, 2.0 * half, 0.5, &body));
  OK(mps_body_drive(body, 1, down, -1.0));
  mpm_scene_contact(&s, body, 0.0);
  mps_reaction begin, end;
  OK(mps_mpm_run(s.mpm, 0.75 * t_end, 1000000, NULL, NULL));
  OK(mps_body_get_reaction(body, -1, &begin));
  OK(mps_mpm_run(s.mpm, t_end, 1000000, NULL, NULL));
  OK(mps_body_get_reaction(body, -1, &end));
  *rough = roughness(&s);
  mpm_scene_end(&s);
  return (end.impulse[1] - begin.impulse[1]) / (0.25 * t_end) / half;
}

TEST(footing_does_not_lock) {
  for (int32_t spline = 2; spline <= 3; spline++) {
    double wild, rough, smooth;
    const double point = footing(spline, MPS_MPM_VOLUMETRIC_POINT, &wild) / COHESION;
    const double cell = footing(spline, MPS_MPM_VOLUMETRIC_CELL, &rough) / COHESION;
    const double nodes = footing(spline, MPS_MPM_VOLUMETRIC_NODES, &smooth) / COHESION;
    print_message("footing by nodes: q/c %.3f, pressure between cells %.3f c\n", nodes,
                  smooth / COHESION);
    print_message("footing, nu = 0.499, spline %d: q/c %.3f, by cell %.3f (2 + pi = 5.142); "
                  "pressure between cells %.3f c, by cell %.3f c\n",
                  spline, point, cell, wild / COHESION, rough / COHESION);
    assert_true(cell < 1.35 * (2.0 + PI) && cell > 2.0 + PI);
    assert_true(cell < point);
    assert_true(rough < 0.2 * COHESION);
    assert_true(rough < 0.2 * wild);
    assert_true(nodes < 1.35 * (2.0 + PI) && nodes > 2.0 + PI && nodes < point);
    assert_true(smooth < 0.05 * COHESION);
  }
}
