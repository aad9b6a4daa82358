/* test_geostatic.c - the stress of ground at rest: layers, surfaces, a caller's function, errors.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "core/particles/particles_internal.h"
#include "test_allocator.h"
#include "test_fixture.h"

#define G 9.81

/* A block of the given height on the unit square (2D: unit length), spacing 0.25 m. */
static mps_particles *ground(mps_context *own, int32_t dim, double height) {
  DEF(particles, def, .dim = dim, .spacing = 0.25);
  MAKE_KEPT(particles, set, create, own, &def);
  OK(mps_particles_fill_box(set, AT(0.0), AT(1.0, dim == 2 ? height : 1.0, height), NULL));
  return set;
}

/* Two layers, 1 m of 1500 with K0 = 0.4 and deeper ground of 2000 with K0 = 0.6, under 3 kPa. */
static const mps_geostatic_layer two[] = {{1.0, 0.4, 1500.0}, {INFINITY, 0.6, 2000.0}};

static double weight_above(double depth) {
  return 3e3 + G * (1500.0 * fmin(depth, 1.0) + 2000.0 * fmax(depth - 1.0, 0.0));
}

static mps_geostatic_def two_layers(void) {
  DEF(geostatic, def, .layers = two, .layer_count = 2, .surcharge = 3e3);
  return def;
}

/* Every particle carries the weight above the level `surface(x)`. */
static void expect_two_layers(mps_particles *set, int up, double (*surface)(double x)) {
  const int dim = mps_particles_dim(set);
  mps_view x = view_field(set, "position"), s = view_field(set, "stress");
  assert_int_equal(s.shape[1], 2 * dim);
  for (int64_t k = 0; k < x.shape[0]; k++) {
    const double depth = surface(*mps_view_f64(&x, k, 0)) - *mps_view_f64(&x, k, up);
    const double vertical = -weight_above(depth), k0 = depth < 1.0 ? 0.4 : 0.6;
    for (int c = 0; c < 2 * dim; c++)
      NEAR(*mps_view_f64(&s, k, c), c == up ? vertical : c < 3 ? k0 * vertical : 0.0, 1e-12 * 1e5);
  }
}

static double at_three(double x) { return 0.0 * x + 3.0; }
static double at_four(double x) { return 0.0 * x + 4.0; }
/* 3 m at the left, 5 m from x = 0.5 m on. */
static double slope(double x) { return x < 0.5 ? 3.0 + 4.0 * x : 5.0; }
static mps_status level(void *user, const double *x, double *at) {
  *(int *)user += 1;
  *at = slope(x[0]);
  return MPS_OK;
}
static mps_status no_level(void *user, const double *x, double *at) { return MPS_ERROR_IO; }

TEST(layers_carry_what_lies_above) {
  for (int32_t dim = 2; dim <= 3; dim++) {
    const double line[] = {0.0, 3.0, 0.5, 5.0};
    int asked = 0;
    scoped_particles *set = ground(context, dim, 3.0);
    mps_geostatic_def def = two_layers();
    OK(mps_particles_set_geostatic(set, &def));
    expect_two_layers(set, dim - 1, at_three); /* found by the highest particle */
    def.surface = 4.0;
    OK(mps_particles_set_geostatic(set, &def));
    expect_two_layers(set, dim - 1, at_four);
    def.surface = NAN;
    def.surface_level = level, def.user = &asked;
    OK(mps_particles_set_geostatic(set, &def));
    expect_two_layers(set, dim - 1, slope);
    assert_int_equal(asked, mps_particles_count(set));
    def.surface_level = NULL;
    def.surface_line = line, def.surface_points = 2;
    if (dim == 2) {
      OK(mps_particles_set_geostatic(set, &def));
      expect_two_layers(set, 1, slope);
    } else {
      FAILS(mps_particles_set_geostatic(set, &def), MPS_ERROR_UNSUPPORTED,
            "surface_line is for 2D");
    }
  }
  scoped_particles *set = ground(context, 3, 1.0); /* y upwards */
  mps_geostatic_def def = two_layers();
  def.vertical = 1;
  def.surface = 3.0;
  OK(mps_particles_set_geostatic(set, &def));
  expect_two_layers(set, 1, at_three);
}

TEST(layers_take_their_particles_density) {
  static const mps_geostatic_layer from_field[] = {{1.0, 0.4, NAN}, {4.0, 0.6, NAN}};
  scoped_particles *set = ground(context, 2, 3.0);
  mps_geostatic_def def = two_layers();
  def.layers = from_field;
  FAILS(mps_particles_set_geostatic(set, &def), MPS_ERROR_FIELD,
        "layer 0 has density NaN, but the set has no field 'density'");
  OK(mps_particles_set(set, "density", 0, 2000.0));
  const mps_view x = view_field(set, "position");
  double *rho = mpsi_particles_column(set, "density", 0); /* past the set's own check */
  for (int64_t k = 0; k < x.shape[0]; k++)
    if (*mps_view_f64(&x, k, 1) > 2.0) rho[k] = 1500.0;
  OK(mps_particles_set_geostatic(set, &def));
  expect_two_layers(set, 1, at_three);
  def.surface = 3.5; /* now some of the lower layer's particles lie in the upper one */
  REFUSES(mps_particles_set_geostatic(set, &def),
          "layer 1 has particles of 2000 and of 1500 kg/m3 (particle 32)");
  expect_two_layers(set, 1, at_three);
  def.surface = 8.0;
  REFUSES(mps_particles_set_geostatic(set, &def),
          "particle 0 is 7.875 m deep, the layers reach down to 5 m");
  rho[7] = NAN;
  def.surface = NAN;
  REFUSES(mps_particles_set_geostatic(set, &def), "particle 7 has density nan");
}

/* Layers of a program that was built with a longer struct: what lies behind the members that this
 * library knows is passed over. */
TEST(layers_may_be_longer) {
  struct longer {
    mps_geostatic_layer layer;
    double more[2];
  } layers[2];
  memset(layers, 0xff, sizeof layers);
  for (int k = 0; k < 2; k++) layers[k].layer = two[k];
  scoped_particles *set = ground(context, 2, 3.0);
  mps_geostatic_def def = two_layers();
  assert_int_equal(def.layer_size, sizeof(mps_geostatic_layer));
  def.layers = &layers[0].layer, def.layer_size = (int32_t)sizeof *layers;
  OK(mps_particles_set_geostatic(set, &def));
  expect_two_layers(set, 1, at_three);
}

TEST(bad_layers_are_refused_and_nothing_is_changed) {
  scoped_particles *set = ground(context, 2, 3.0);
  mps_geostatic_layer layers[2];
  const double backwards[] = {1.0, 0.0, 0.5, 0.0};
#define REFUSED(change, text)                                                                      \
  do {                                                                                             \
    mps_geostatic_def def = two_layers();                                                          \
    mps_view view;                                                                                 \
    memcpy(layers, two, sizeof two);                                                               \
    def.layers = layers;                                                                           \
    change;                                                                                        \
    REFUSES(mps_particles_set_geostatic(set, &def), text);                                         \
    assert_int_equal(mps_particles_view(set, "stress", &view), MPS_ERROR_FIELD);                   \
  } while (0)
  REFUSED(def.layer_count = 0, "layer_count is 0, must be >= 1");
  REFUSED(def.layers = NULL, "layers is NULL");
  REFUSED(layers[0].thickness = 0.0, "layer 0 has thickness 0 m, must be > 0");
  REFUSED(layers[0].thickness = INFINITY, "only the lowest may be infinite");
  REFUSED(layers[1].thickness = NAN, "layer 1 has thickness nan");
  REFUSED(layers[1].thickness = 1.0, "the layers reach down to 2 m");
  REFUSED(layers[1].k0 = -0.1, "layer 1 has k0 -0.1");
  REFUSED(layers[0].density = 0.0, "layer 0 has density 0 kg/m3");
  REFUSED(def.layer_size = 20, "layer_size is 20, must be sizeof(mps_geostatic_layer)");
  REFUSED(def.layer_size = 1 << 20, "layer_size is 1048576");
  REFUSED(layers[0].density = -1.0, "layer 0 has density -1 kg/m3");
  REFUSED(def.surface = 2.5, "above the surface at 2.5 m there");
  REFUSED((def.surface_line = backwards, def.surface_points = 2), "point 1 of surface_line");
  REFUSED(layers[0].density = 1e20, "layer 0 has density 1e+20 kg/m3");
  REFUSED(layers[0].k0 = 1e300, "layer 0 has k0 1e+300");
  mps_geostatic_def refusing = two_layers();
  refusing.surface_level = no_level;
  FAILS(mps_particles_set_geostatic(set, &refusing), MPS_ERROR_IO,
        "surface_level refused the position of particle 0");
  assert_int_equal(mps_particles_set_geostatic(NULL, NULL), MPS_ERROR_ARGUMENT);
}

/* ---- a caller's function --------------------------------------------------------------------- */

static mps_status radial(void *user, const double *x, double *stress) {
  const double limit = *(const double *)user;
  for (int c = 0; c < 3; c++) stress[c] = -100.0 * (c + 1) * x[1];
  stress[3] = 7.0 * x[0];
  if (x[1] > limit) stress[2] = NAN;
  return x[0] > limit ? MPS_ERROR_CANCELLED : MPS_OK;
}

TEST(a_function_sets_the_stress) {
  double limit = 0.8;
  mps_view s;
  scoped_particles *set = ground(context, 2, 1.0);
  FAILS(mps_particles_set_stress(set, radial, &limit), MPS_ERROR_CANCELLED,
        "the stress function refused particle 3");
  mps_edit x;
  OK(mps_particles_edit(set, "position", &x));
  for (int64_t k = 0; k < x.view.shape[0]; k++) *mps_edit_f64(&x, k, 0) *= 0.5;
  OK(mps_particles_commit(set, &x));
  REFUSES(mps_particles_set_stress(set, radial, &limit), "stress[2] at particle 12 is nan Pa");
  REFUSES(mps_particles_set_stress(set, NULL, NULL), "stress is NULL");
  assert_int_equal(mps_particles_view(set, "stress", &s), MPS_ERROR_FIELD);
  limit = 10.0;
  OK(mps_particles_set_stress(set, radial, &limit));
  s = view_field(set, "stress");
  for (int64_t k = 0; k < x.view.shape[0]; k++) {
    for (int c = 0; c < 3; c++)
      NEAR(*mps_view_f64(&s, k, c), -100.0 * (c + 1) * *mps_view_f64(&x.view, k, 1), 1e-12);
    NEAR(*mps_view_f64(&s, k, 3), 7.0 * *mps_view_f64(&x.view, k, 0), 1e-12);
  }
}

/* ---- memory ---------------------------------------------------------------------------------- */

/* A stress field in an edit is not written. */
TEST(an_open_edit_is_respected) {
  scoped_particles *set = ground(context, 2, 2.0);
  const mps_geostatic_def def = two_layers();
  double limit = 10.0;
  OK(mps_particles_add_field(set, "stress", 0));
  EDIT(edit, set, "stress") {
    *mps_edit_f64(&edit, 3, 0) = -7.0;
    FAILS(mps_particles_set_geostatic(set, &def), MPS_ERROR_STATE, "being edited");
    FAILS(mps_particles_set_stress(set, radial, &limit), MPS_ERROR_STATE, "being edited");
    assert_true(*mps_edit_f64(&edit, 3, 0) == -7.0);
  }
  OK(mps_particles_set_geostatic(set, &def));
}

static mps_status set_and_destroy(mps_context *own, int what) {
  double limit = 10.0;
  DEF(particles, def, .spacing = 0.25);
  const mps_geostatic_def layers = two_layers();
  scoped_particles *set = NULL;
  mps_status status = mps_particles_create(own, &def, &set);
  if (status == MPS_OK) status = mps_particles_fill_box(set, AT(0.0, 0.0), AT(1.0, 1.0), NULL);
  if (status == MPS_OK)
    status = what == 0 ? mps_particles_set_geostatic(set, &layers)
                       : mps_particles_set_stress(set, radial, &limit);
  return status;
}

TEST(refused_memory_leaves_nothing_behind) {
  test_allocator_sweep(set_and_destroy, 0);
  test_allocator_sweep(set_and_destroy, 1);
}
