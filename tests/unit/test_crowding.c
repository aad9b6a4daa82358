/* test_crowding.c - the same matter twice: particles that share a place are refused by all solvers
 * alike, clouds that overlap are warned of with the place, and fills that are merely uneven, at
 * interfaces or of volumes of their own are neither. SPDX-License-Identifier: BSD-3-Clause */
#include "test_common.h"

static mps_context *context;
static char warning[512];

static void listen(void *user, int32_t level, const char *text) {
  if (level == MPS_CONTEXT_LOG_WARNING && strstr(text, "filled above"))
    snprintf(warning, sizeof warning, "%s", text);
}

static mps_particles *empty(int32_t dim, double spacing) {
  DEF(particles, def, .dim = dim, .spacing = spacing);
  MAKE_KEPT(particles, set, create, context, &def);
  return set;
}

/* A square or cube of `side` particles a side, whose first corner is at `at`. Every particle is
 * moved at random by up to `jitter` spacings. */
static void add_cloud(mps_particles *set, int side, double at, double jitter) {
  const int32_t dim = mps_particles_dim(set);
  const double D = mps_particles_spacing(set);
  const int64_t n = dim == 3 ? (int64_t)side * side * side : (int64_t)side * side;
  double *x = malloc((size_t)(n * dim) * sizeof *x);
  uint64_t seed = 7;
  for (int64_t k = 0; k < n; k++)
    for (int32_t c = 0; c < dim; c++) {
      const int64_t place = c == 0 ? k % side : c == 1 ? k / side % side : k / side / side;
      seed = seed * 6364136223846793005u + 1442695040888963407u;
      const double moved = ((double)(seed >> 11) * 0x1p-52 - 1.0) * jitter;
      x[k * dim + c] = at + ((double)place + 0.5 + moved) * D;
    }
  OK(mps_particles_append(set, n, x));
  free(x);
}

static mps_status solve_mpm(mps_particles *set, mps_mpm **out) {
  DEF(mpm, def, .cell = 2.0 * mps_particles_spacing(set));
  if (mps_particles_dim(set) == 3) def.geometry = MPS_MPM_GEOMETRY_SPACE;
  OK(mps_particles_set(set, "density", 0, 1000.0));
  MAKE(material, law, create_linear_elastic, context, 1e6, 0.3);
  warning[0] = '\0';
  return mps_mpm_create(context, set, law, &def, out);
}

TEST(one_place_is_refused_by_all) {
  static const char text[] = "lie at the same point (0.25, 0.05) m";
  scoped_particles *set = empty(2, 0.1);
  const double again[2] = {0.25, 0.05 + 1e-9};
  mps_mpm *mpm = NULL;
  mps_fluid *fluid = NULL;
  mps_dynamics *dynamics = NULL;
  mps_elastic *elastic = NULL;
  add_cloud(set, 10, 0.0, 0.0);
  OK(mps_particles_append(set, 1, again));
  SET_FIELDS(set, {"shear_velocity", 100.0}, {"pressure_velocity", 200.0}, {"damping", 0.0});
  REFUSES(solve_mpm(set, &mpm), text);
  assert_true(strncmp(mps_context_error(context)->message, "particles", 9) == 0);
  mps_fluid_def water = mps_fluid_defaults();
  REFUSES(mps_fluid_create(context, set, &water, &fluid), text);
  mps_dynamics_def ground = mps_dynamics_defaults();
  REFUSES(mps_dynamics_create(context, set, &ground, &dynamics), text);
  const mps_status status = mps_elastic_create(context, set, NULL, &elastic);
  if (status != MPS_ERROR_UNSUPPORTED) {
    assert_int_equal(status, MPS_ERROR_ARGUMENT);
    assert_non_null(strstr(mps_context_error(context)->message, text));
  }
}

TEST(clouds_that_overlap_are_warned_of) {
  for (int32_t dim = 2; dim <= 3; dim++)
    for (int way = 0; way < 3; way++) { /* half a spacing apart, a little, a corner of each */
      scoped_particles *set = empty(dim, 0.05);
      scoped_mpm *mpm = NULL;
      const int side = dim == 3 ? 8 : 20;
      add_cloud(set, side, 0.0, 0.0);
      add_cloud(set, side, way == 0 ? 0.025 : way == 1 ? 1e-4 : 0.51 * 0.05 * side, 0.0);
      OK(solve_mpm(set, &mpm));
      if (!warning[0]) fail_msg("no warning in %dD of clouds %d", (int)dim, way);
    }
}

TEST(uneven_fills_are_not) {
  for (int32_t dim = 2; dim <= 3; dim++) {
    static const double jitters[3] = {0.0, 0.15, 0.3};
    for (int k = 0; k < 5; k++) {
      scoped_particles *set = empty(dim, 0.05);
      scoped_mpm *mpm = NULL;
      add_cloud(set, dim == 3 ? 8 : 20, 0.013, k < 3 ? jitters[k] : 0.0);
      /* another lattice beside it, half a spacing or a quarter into the free half spacing */
      if (k >= 3) add_cloud(set, 6, (dim == 3 ? 8 : 20) * 0.05 + (k == 3 ? 0.013 : 0.0), 0.0);
      OK(solve_mpm(set, &mpm));
      if (warning[0]) fail_msg("%dD, fill %d: %s", (int)dim, k, warning);
    }
  }
}

/* Finer particles in a coarse set, with their own volumes, fill the same space once. */
TEST(volumes_of_their_own_count) {
  for (int given = 0; given < 2; given++) {
    scoped_particles *set = empty(2, 0.1);
    scoped_mpm *mpm = NULL;
    double x[2 * 400];
    for (int k = 0; k < 400; k++)
      x[2 * k] = 0.05 * (k % 20 + 0.5), x[2 * k + 1] = 0.05 * (k / 20 + 0.5);
    OK(mps_particles_append(set, 400, x));
    if (given) OK(mps_particles_set(set, "volume", 0, 0.0025));
    OK(solve_mpm(set, &mpm));
    assert_int_equal(warning[0] == '\0', given);
  }
}

/* So do those that are added between steps. */
TEST(insertions_are_looked_at) {
  scoped_particles *set = empty(2, 0.05);
  scoped_mpm *mpm = NULL;
  const double beside[2] = {2.025, 0.025}, same[2] = {0.125, 0.025};
  add_cloud(set, 20, 0.0, 0.0);
  OK(solve_mpm(set, &mpm));
  OK(mps_particles_append(set, 1, beside));
  assert_true(warning[0] == '\0');
  REFUSES(mps_particles_append(set, 1, same), "lie at the same point (0.125, 0.025) m");
  assert_non_null(strstr(mps_context_error(context)->message, "positions"));
  assert_int_equal(mps_particles_count(set), 401);
  add_cloud(set, 20, 0.02, 0.0);
  assert_true(warning[0] != '\0');
}

static int make(void **state) {
  mps_context_def def = test_context_defaults();
  (void)state;
  def.log = listen;
  OK(mps_context_create(&def, &context, NULL, 0));
  return 0;
}

static int drop(void **state) {
  mps_context_destroy(&context);
  return 0;
}

TEST_GROUP(make, drop)
