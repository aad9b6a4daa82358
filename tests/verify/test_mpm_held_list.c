/* test_mpm_held_list.c - lists of particles with a prescribed velocity hold: a bar hangs from its
 * listed particles, and is stretched by those of its ends. SPDX-License-Identifier: BSD-3-Clause */
#include "mpm_scene.h"

#include "test_fixture.h"

#define YOUNG 1e7
#define DENSITY 1000.0
#define GRAVITY 9.81
#define WIDTH 0.2
#define MOST 4000

typedef struct bar {
  mpm_scene s;
  double h;
} bar;

/* A bar WIDTH by 1 m, free on all sides, nu 0; the grid is moved by `shift`. */
static bar begin_bar(double h, double shift, mps_mpm_def def, double gravity) {
  bar b = {.h = h};
  b.s = mpm_scene_begin(context, 0.5 * h, 0.0, 0.0, YOUNG);
  mps_material_destroy(&b.s.material);
  OK(mps_material_create_linear_elastic(context, YOUNG, 0.0, &b.s.material));
  const bool axial = def.geometry == MPS_MPM_GEOMETRY_AXISYMMETRIC;
  mpm_scene_box(&b.s, 0.0, 0.0, WIDTH, 1.0);
  def.cell = h;
  def.origin[1] = shift;
  def.lower[0] = axial ? 0.0 : -4.0 * h, def.upper[0] = WIDTH + 4.0 * h;
  def.lower[1] = shift - 5.0 * h, def.upper[1] = shift + h * ceil(1.0 / h + 5.0);
  def.gravity[1] = -gravity;
  mpm_scene_solve(&b.s, &def);
  for (int32_t k = axial ? 1 : 0; k < 4; k++) mpm_scene_side(&b.s, k, MPS_BOUNDARY_FREE, 0.0);
  return b;
}

/* Lists the particles of a box, and holds them or drives them along y. */
static int32_t prescribe(bar *b, const double *lo, const double *hi, mps_signal *signal,
                         int64_t *ids, int64_t *count) {
  int32_t number;
  OK(mps_particles_select_box(b->s.particles, lo, hi, MOST, count, ids));
  DEF(mpm_boundary, def, .ids = ids, .id_count = *count);
  if (signal) def.kind = MPS_BOUNDARY_DRIVEN, def.signal[1] = signal;
  OK(mps_mpm_add_boundary(b->s.mpm, &def, &number));
  return number;
}

static double lowest(bar *b) {
  const mps_view x = mpm_scene_view(&b->s, "position");
  double y = 1.0;
  for (int64_t k = 0; k < x.shape[0]; k++) y = fmin(y, *mps_view_f64(&x, k, 1));
  return y - 0.25 * b->h;
}

/* Listed particles have not moved at all, and the bar oscillates about its static length. */
static void check_hanging(double cells, double courant, double shift) {
  const double h = 0.1, grip = cells * h, lo[] = {-1.0, 1.0 - grip}, hi[] = {1.0, 2.0};
  DEF(mpm, def, .courant = courant);
  bar b = begin_bar(h, shift, def, GRAVITY);
  int64_t ids[MOST], count;
  double place[MOST][2];
  const int32_t number = prescribe(&b, lo, hi, NULL, ids, &count);
  mps_view x = mpm_scene_view(&b.s, "position");
  for (int64_t i = 0; i < count; i++)
    for (int c = 0; c < 2; c++)
      place[i][c] = *mps_view_f64(&x, mps_particles_index(b.s.particles, ids[i]), c);
  const double weight = DENSITY * GRAVITY * WIDTH;
  const double sag = 0.5 * DENSITY * GRAVITY * (1.0 - grip) * (1.0 - grip) / YOUNG;
  for (int k = 1; k <= 5; k++) {
    OK(mps_mpm_run(b.s.mpm, 0.2 * k, 1000000, NULL, NULL));
    assert_true(lowest(&b) < 0.0 && lowest(&b) > -2.3 * sag);
  }
  x = mpm_scene_view(&b.s, "position");
  for (int64_t i = 0; i < count; i++)
    for (int c = 0; c < 2; c++)
      assert_true(*mps_view_f64(&x, mps_particles_index(b.s.particles, ids[i]), c) == place[i][c]);
  mps_reaction r;
  OK(mps_mpm_get_reaction(b.s.mpm, number, &r));
  assert_int_equal(r.count, count);
  const mps_totals t = mpm_scene_totals(&b.s); /* the impulse is that of the weight and of P */
  NEAR(r.impulse[1] - weight * mps_mpm_time(b.s.mpm), t.linear[1], 1e-9 * weight);
  NEAR(r.work, 0.0, 0.0);
  mpm_scene_end(&b.s);
}

TEST(test_hanging) {
  check_hanging(2.0, 0.1, 0.0);
  check_hanging(2.0, 0.9, 0.03);
  check_hanging(1.0, 0.5, 0.0);
  check_hanging(1.0, 0.9, 0.05);
  check_hanging(3.0, 0.5, 0.08);
}

/* A displacement at constant speed to STROKE in PULL seconds, with smooth ends; then rest. */
#define STROKE 1e-3
#define PULL 0.3
#define SMOOTH 0.05
static mps_status pull(void *user, double t, double motion[3]) {
  const double v = STROKE / PULL, *sign = user;
  const double up = fmin(1.0, t / SMOOTH), down = fmin(1.0, fmax(0.0, (t - PULL) / SMOOTH));
  const double x = t < SMOOTH
                       ? 0.5 * v * t * t / SMOOTH
                       : v * (t - 0.5 * SMOOTH) - (t < PULL ? 0.0
                                                   : t < PULL + SMOOTH
                                                       ? 0.5 * v * (t - PULL) * (t - PULL) / SMOOTH
                                                       : v * (t - PULL - 0.5 * SMOOTH));
  motion[0] = *sign * x;
  motion[1] = *sign * v * (up - down);
  motion[2] = 0.0;
  return MPS_OK;
}

/* The end of a list acts within a quarter of a cell of its last particles' faces. */
static void check_stretched(double h, double shift, int32_t spline, mps_mpm_geometry geometry) {
  const double grip = 0.1, low[] = {-1.0, -1.0}, low_end[] = {1.0, grip};
  const double high[] = {-1.0, 1.0 - grip}, high_end[] = {1.0, 2.0}, pi = 3.14159265358979;
  DEF(mpm, def, .geometry = geometry, .spline = spline, .budget = 1, .viscous_damping = 60.0);
  bar b = begin_bar(h, shift, def, 0.0);
  int64_t ids[MOST], count;
  double sign = 1.0;
  MAKE(signal, signal, create_user, context, MPS_SIGNAL_QUANTITY_DISPLACEMENT, pull, &sign, NULL);
  const int32_t lower = prescribe(&b, low, low_end, NULL, ids, &count);
  const int32_t upper = prescribe(&b, high, high_end, signal, ids, &count);
  const double area = geometry == MPS_MPM_GEOMETRY_AXISYMMETRIC ? pi * WIDTH * WIDTH : WIDTH;
  const double exact = YOUNG * STROKE / (1.0 - 2.0 * grip) * area;
  double before = 0.0;
  for (int k = 1; k <= 2; k++) {
    mps_reaction r, q;
    mps_mpm_energy_report losses;
    OK(mps_mpm_run(b.s.mpm, 0.6 * k, 1000000, NULL, NULL));
    OK(mps_mpm_get_reaction(b.s.mpm, lower, &q));
    OK(mps_mpm_get_reaction(b.s.mpm, upper, &r));
    OK(mps_mpm_get_energy_report(b.s.mpm, &losses));
    NEAR(r.force[1] / exact, 1.0, shift == 0.0 ? 0.02 : 0.5 * h / (1.0 - 2.0 * grip));
    NEAR(q.force[1] / r.force[1], -1.0, 1e-3);
    NEAR(r.work, mpm_scene_totals(&b.s).work_boundaries, 1e-9 * r.work);
    NEAR(losses.residual, 0.0, 1e-10 * r.work);
    assert_true(r.work > 0.45 * r.force[1] * STROKE && r.work < 0.65 * r.force[1] * STROKE);
    if (k > 1) NEAR(r.force[1], before, 2e-3 * before);
    before = r.force[1];
  }
  mpm_scene_end(&b.s);
}

TEST(test_stretched) {
  check_stretched(0.05, 0.0, 3, MPS_MPM_GEOMETRY_PLANE_STRAIN);
  check_stretched(0.05, 0.0125, 3, MPS_MPM_GEOMETRY_PLANE_STRAIN);
  check_stretched(0.05, 0.0, 2, MPS_MPM_GEOMETRY_PLANE_STRAIN);
  check_stretched(0.05, 0.0, 3, MPS_MPM_GEOMETRY_AXISYMMETRIC);
}

/* A step without effect on the state but its own: the same bits again after a rollback. */
TEST(test_rollback) {
  const double lo[] = {-1.0, 0.8}, hi[] = {1.0, 2.0};
  mps_mpm_def def = mps_mpm_defaults();
  bar b = begin_bar(0.1, 0.0, def, GRAVITY);
  int64_t ids[MOST], count;
  scoped_snapshot *kept = NULL;
  double y[2];
  const int32_t number = prescribe(&b, lo, hi, NULL, ids, &count);
  mps_reaction r[2];
  OK(mps_mpm_step(b.s.mpm, 20));
  OK(mps_mpm_snapshot(b.s.mpm, &kept));
  for (int k = 0; k < 2; k++) {
    OK(mps_mpm_step(b.s.mpm, 20));
    OK(mps_mpm_get_reaction(b.s.mpm, number, &r[k]));
    y[k] = lowest(&b);
    if (k == 0) OK(mps_mpm_rollback(b.s.mpm, kept));
  }
  assert_true(y[0] == y[1] && r[0].force[1] == r[1].force[1]);
  /* listed twice is listed once; particles that are gone are skipped */
  const int64_t again[] = {ids[0], ids[1], ids[0], ids[0]};
  USING(mpm_boundary, mps_mpm_set_boundary(b.s.mpm, number, &given), .ids = again, .id_count = 4);
  OK(mps_mpm_step(b.s.mpm, 1));
  OK(mps_mpm_get_reaction(b.s.mpm, number, &r[0]));
  assert_int_equal(r[0].count, 2);
  OK(mps_particles_remove(b.s.particles, ids, 2));
  OK(mps_mpm_step(b.s.mpm, 1));
  OK(mps_mpm_get_reaction(b.s.mpm, number, &r[0]));
  assert_int_equal(r[0].count, 0);
  NEAR(r[0].force[1], 0.0, 0.0);
  mpm_scene_end(&b.s);
}

/* A block that is held below bears a free body, and sides beside it share the load. */
TEST(test_among_others) {
  const double lo[] = {-1.0, -1.0}, hi[] = {1.0, 0.2},
               corner[] = {-0.1, -0.1, 0.1, -0.1, 0.1, 0.1, -0.1, 0.1};
  DEF(mpm, def, .local_damping = 0.5);
  bar b = begin_bar(0.1, 0.0, def, GRAVITY);
  DEF(body, rigid, .motion = MPS_BODY_MOTION_FREE, .position[0] = 0.1, .position[1] = 1.1,
      .mass = 400.0, .inertia[2] = 5.0, .gravity[1] = -GRAVITY);
  int64_t ids[MOST], count;
  const int32_t number = prescribe(&b, lo, hi, NULL, ids, &count);
  MAKE(body, body, create_polygon, context, &rigid, 4, corner);
  mpm_scene_contact(&b.s, body, 0.3);
  mps_body_state at;
  mps_reaction r, before;
  OK(mps_mpm_run(b.s.mpm, 0.5, 1000000, NULL, NULL));
  OK(mps_mpm_get_reaction(b.s.mpm, number, &before));
  OK(mps_mpm_run(b.s.mpm, 1.0, 1000000, NULL, NULL));
  OK(mps_body_get_state(body, &at));
  OK(mps_mpm_get_reaction(b.s.mpm, number, &r));
  const double weight = (DENSITY * WIDTH + rigid.mass) * GRAVITY;
  NEAR((r.impulse[1] - before.impulse[1]) / 0.5, weight, 0.01 * weight);
  assert_true(at.position[1] < 1.1 && at.position[1] > 1.095);
  mpm_scene_end(&b.s);
}

/* The same bits on any number of threads, which share the sweeps over so many constraints. */
TEST(test_threads) {
  const double lo[] = {-1.0, 0.55}, hi[] = {1.0, 2.0};
  static const int32_t threads[] = {1, 2, 5};
  mps_context *const own = context;
  double *first = NULL;
  mps_reaction r[3];
  for (int k = 0; k < 3; k++) {
    int64_t ids[MOST], count;
    context =
        test_context(k ? MPS_CONTEXT_EXECUTOR_THREADS : MPS_CONTEXT_EXECUTOR_SERIAL, threads[k]);
    bar b = begin_bar(0.01, 0.003, mps_mpm_defaults(), GRAVITY);
    const int32_t number = prescribe(&b, lo, hi, NULL, ids, &count);
    assert_true(count == 3600);
    OK(mps_mpm_step(b.s.mpm, 12));
    OK(mps_mpm_get_reaction(b.s.mpm, number, &r[k]));
    const mps_view x = mpm_scene_view(&b.s, "position"), id = mpm_scene_view(&b.s, "id");
    const int64_t n = x.shape[0];
    if (k == 0) first = calloc((size_t)(2 * n), sizeof *first);
    for (int64_t i = 0; i < n; i++)
      for (int c = 0; c < 2; c++) {
        double *at = &first[2 * *mps_view_i64(&id, i, 0) + c];
        if (k == 0) *at = *mps_view_f64(&x, i, c);
        assert_true(*at == *mps_view_f64(&x, i, c));
      }
    assert_int_equal(memcmp(&r[k], &r[0], sizeof r[0]), 0);
    mpm_scene_end(&b.s);
    mps_context_destroy(&context);
  }
  free(first);
  context = own;
}

/* Where a list holds one component the other is free: a bar glides across its supports. */
TEST(test_one_component) {
  const double speed = 0.05, lo[] = {-1.0, 0.8}, hi[] = {1.0, 2.0};
  bar b = begin_bar(0.1, 0.0, mps_mpm_defaults(), GRAVITY);
  int64_t ids[MOST], count;
  double place[MOST][2];
  int32_t number;
  OK(mps_particles_select_box(b.s.particles, lo, hi, MOST, &count, ids));
  OK(mps_particles_set(b.s.particles, "velocity", 0, speed));
  DEF(mpm_boundary, def, .ids = ids, .id_count = count, .dofs = MPS_DOF_Y);
  OK(mps_mpm_add_boundary(b.s.mpm, &def, &number));
  mps_view x = mpm_scene_view(&b.s, "position");
  for (int64_t i = 0; i < count; i++)
    for (int c = 0; c < 2; c++)
      place[i][c] = *mps_view_f64(&x, mps_particles_index(b.s.particles, ids[i]), c);
  const mps_totals before = mpm_scene_totals(&b.s);
  OK(mps_mpm_run(b.s.mpm, 0.4, 1000000, NULL, NULL));
  const mps_totals after = mpm_scene_totals(&b.s);
  mps_reaction r;
  OK(mps_mpm_get_reaction(b.s.mpm, number, &r));
  NEAR(after.linear[0], before.linear[0], 1e-10 * before.linear[0]);
  NEAR(r.impulse[0], 0.0, 1e-10 * before.linear[0]);
  x = mpm_scene_view(&b.s, "position");
  for (int64_t i = 0; i < count; i++) {
    const int64_t k = mps_particles_index(b.s.particles, ids[i]);
    assert_true(*mps_view_f64(&x, k, 1) == place[i][1]);
    NEAR(*mps_view_f64(&x, k, 0) - place[i][0], 0.4 * speed, 1e-3 * speed);
  }
  mpm_scene_end(&b.s);
}

/* A bar of 1 m on a floor of any kind, held in the middle, undamped: the impulses of floor, list
 * and gravity make up the momentum; its mean vanishes, so that floor and list bear the weight. */
TEST(test_floor) {
  static const int32_t kinds[] = {MPS_BOUNDARY_ROLLER, MPS_BOUNDARY_HELD, MPS_BOUNDARY_FRICTIONAL,
                                  MPS_BOUNDARY_ABSORBING};
  const double lo[] = {-1.0, 0.4}, hi[] = {1.0, 0.6}, weight = DENSITY * GRAVITY * WIDTH;
  for (int k = 0; k < 4; k++) {
    scoped_mpm_scene s = mpm_scene_begin(context, 0.05, 0.0, 0.0, YOUNG);
    mps_reaction list, floor;
    bar b = {.h = 0.1};
    int64_t ids[MOST], count;
    mpm_scene_box(&s, 0.0, 0.0, WIDTH, 1.0);
    USING(mpm, mpm_scene_solve(&s, &given), .cell = b.h, .lower[0] = -0.4, .upper[0] = WIDTH + 0.4,
          .lower[1] = 0.0, .upper[1] = 1.5, .gravity[1] = -GRAVITY);
    b.s = s;
    for (int32_t side = 0; side < 4; side++)
      mpm_scene_side(&s, side, side == 2 ? kinds[k] : MPS_BOUNDARY_FREE,
                     side == 2 && kinds[k] == MPS_BOUNDARY_FRICTIONAL ? 0.5 : 0.0);
    const int32_t number = prescribe(&b, lo, hi, NULL, ids, &count);
    OK(mps_mpm_run(s.mpm, 0.4, 1000000, NULL, NULL));
    OK(mps_mpm_get_reaction(s.mpm, number, &list));
    OK(mps_mpm_get_reaction(s.mpm, MPS_SIDE_Y_LOWER, &floor));
    const double borne = list.impulse[1] + floor.impulse[1], time = mps_mpm_time(s.mpm);
    NEAR(borne - weight * time, mpm_scene_totals(&s).linear[1], 1e-9 * weight);
    NEAR(borne / time, weight, 5e-3 * weight);
    assert_true(list.impulse[1] > 0.5 * weight * time && floor.impulse[1] > 0.0);
  }
}

TEST(test_implicit_water_refuses) {
  const double lo[] = {-1.0, 0.8}, hi[] = {1.0, 2.0}, level[] = {0.0, 1.0};
  bar b = begin_bar(0.1, 0.0, mps_mpm_defaults(), GRAVITY);
  int64_t ids[MOST], count;
  OK(mps_particles_set(b.s.particles, "density", 0, 2000.0));
  USING(pore_water, mps_mpm_add_pore_water(b.s.mpm, &given), .scheme = MPS_PORE_SCHEME_IMPLICIT,
        .porosity = 0.4, .bulk = 2e9, .permeability = 1e-4);
  OK(mps_mpm_set_pore_level(b.s.mpm, level));
  const int32_t number = prescribe(&b, lo, hi, NULL, ids, &count);
  FAILS(mps_mpm_step(b.s.mpm, 1), MPS_ERROR_UNSUPPORTED, "boundary 6 is a list of particles");
  assert_true(mps_mpm_steps(b.s.mpm) == 0 && lowest(&b) == 0.0);
  OK(mps_mpm_remove_boundary(b.s.mpm, number));
  OK(mps_mpm_step(b.s.mpm, 1));
  mpm_scene_end(&b.s);
}
