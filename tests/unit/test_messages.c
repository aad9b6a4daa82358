/* test_messages.c - what the message of an error must say: the argument at fault by the name that
 * the header gives it, once and before all else, and a value in as many digits as distinguish it
 * from the bound that it is beyond.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "io/checkpoint.h"
#include "test_common.h"

#include "core/definition/digits.h"
#include "core/base/ranges.h"
#include "core/internal.h"

static mps_context *context;

static int open_context(void **state) {
  context = test_context(MPS_CONTEXT_EXECUTOR_SERIAL, 1);
  return context ? 0 : -1;
}

static int close_context(void **state) {
  mps_context_destroy(&context);
  return 0;
}

static const char *message(void) { return mps_context_error(context)->message; }

/* ---- the argument ---------------------------------------------------------------------------- */

TEST(an_argument_is_named_once) {
  (void)mpsi_fail(context, "f", MPS_ERROR_ARGUMENT, "the set has 3 particles");
  assert_int_equal(mpsi_fail_of(context, MPS_ERROR_ARGUMENT, "particles"), MPS_ERROR_ARGUMENT);
  assert_string_equal(message(), "particles: the set has 3 particles");
  assert_int_equal(mpsi_fail_of(context, MPS_ERROR_ARGUMENT, "particles"), MPS_ERROR_ARGUMENT);
  assert_string_equal(message(), "particles: the set has 3 particles");
  assert_int_equal(mpsi_fail_of(context, MPS_ERROR_ARGUMENT, "part"), MPS_ERROR_ARGUMENT);
  assert_string_equal(message(), "part: particles: the set has 3 particles"); /* another name */
}

TEST(other_statuses_keep_their_message) {
  for (int32_t status = MPS_OK; status <= MPS_ERROR_INTERNAL; status++) {
    (void)mpsi_fail(context, "f", MPS_ERROR_STATE, "a step is open");
    assert_int_equal(mpsi_fail_of(context, status, "dt"), status);
    assert_string_equal(message(),
                        status == MPS_ERROR_ARGUMENT ? "dt: a step is open" : "a step is open");
  }
  assert_int_equal(mpsi_fail_of(NULL, MPS_ERROR_ARGUMENT, "dt"), MPS_ERROR_ARGUMENT);
}

/* Of a message that fills its room the end is cut, and of a name all but a quarter of the room. */
TEST(a_long_message_stays_in_its_room) {
  enum { ROOM = sizeof(((mps_error *)NULL)->message) };
  char text[ROOM], name[ROOM];
  for (int length = 0; length < ROOM; length++) {
    memset(text, 'x', sizeof text);
    text[length] = '\0';
    (void)mpsi_fail(context, "f", MPS_ERROR_ARGUMENT, "%s", text);
    (void)mpsi_fail_of(context, MPS_ERROR_ARGUMENT, "dt");
    const size_t wanted = (size_t)length + 4 < ROOM ? (size_t)length + 4 : ROOM - 1;
    assert_int_equal(strlen(message()), wanted);
    assert_memory_equal(message(), "dt: ", 4);
    assert_memory_equal(message() + 4, text, wanted - 4);
  }
  memset(name, 'n', sizeof name);
  name[ROOM - 1] = '\0';
  (void)mpsi_fail_of(context, MPS_ERROR_ARGUMENT, name);
  assert_int_equal(strlen(message()), ROOM - 1);
  assert_int_equal(strspn(message(), "n"), ROOM / 4);
  assert_memory_equal(message() + ROOM / 4, ": dt: x", 7);
}

/* ---- the value ------------------------------------------------------------------------------- */

/* The number behind " is ", as it can be read. */
static double shown(void) {
  const char *at = strstr(message(), " is ");
  assert_non_null(at);
  return strtod(at + 4, NULL);
}

TEST(a_value_just_outside_reads_as_one_outside) {
  static const struct {
    mpsi_range range;
    double low, high;
  } table[] = {
#define ROW(name, unit, ...) {MPSI_RANGE_##name, __VA_ARGS__},
      MPSI_RANGE_TABLE(ROW)
#undef ROW
  };
  for (size_t k = 0; k < sizeof table / sizeof *table; k++) {
    const double outside[2] = {nextafter(table[k].low, -INFINITY),
                               nextafter(table[k].high, INFINITY)};
    for (int side = 0; side < 2; side++) {
      const double value = outside[side];
      assert_int_equal(mpsi_check_range(context, "f", "value", value, table[k].range),
                       MPS_ERROR_ARGUMENT);
      assert_true(shown() == value);
    }
    assert_int_equal(mpsi_check_range(context, "f", "value", table[k].low, table[k].range), MPS_OK);
    assert_int_equal(mpsi_check_range(context, "f", "value", table[k].high, table[k].range),
                     MPS_OK);
  }
}

TEST(digits_that_tell_nothing_are_left_out) {
  assert_string_equal(mpsi_outside(1.0 + 1e-15, 0.0, 1.0).text, "1.0000000000000011");
  assert_string_equal(mpsi_outside(1.0 / 3.0, 0.5, 1.0).text, "0.333333");
  assert_string_equal(mpsi_outside(1e300, 0.0, 1e9).text, "1e+300");
  assert_string_equal(mpsi_outside(0.0, 0.0, 1.0).text, "0"); /* of an open interval */
  assert_string_equal(mpsi_outside(NAN, 0.0, 1.0).text, "nan");
  assert_string_equal(mpsi_outside(INFINITY, 0.0, INFINITY).text, "inf");
}

/* ---- calls that had neither ------------------------------------------------------------------ */

static mps_particles *block(int32_t dim) {
  DEF(particles, def, .dim = dim, .spacing = 0.1);
  MAKE_KEPT(particles, set, create, context, &def);
  OK(mps_particles_fill_box(set, AT(0.0, 0.0, 0.0), AT(0.4, 0.4, 0.4), NULL));
  OK(mps_particles_set(set, "density", 0, 1000.0));
  return set;
}

TEST(values_just_outside) {
  const double above = nextafter(1.0, 2.0);
  mps_body_def place = mps_body_defaults();
  mps_coupling_def coupling = mps_coupling_defaults();
  mps_fluid_def water = mps_fluid_defaults();
  mps_mpm_def mpm_def = mps_mpm_defaults();
  scoped_body *body = NULL;
  mps_signal *signal = NULL;
  scoped_material *material = NULL;
  mps_coupling *coupled = NULL;
  mps_fluid *fluid = NULL;
  scoped_mpm *mpm = NULL;
  scoped_particles *set = block(2);
  REFUSES(mps_body_create_disc(context, &place, nextafter(1e9, INFINITY), &body),
          "1000000000.0000001 m");
  REFUSES(mps_signal_create_sine(context, MPS_SIGNAL_QUANTITY_DISPLACEMENT,
                                 nextafter(1e9, INFINITY), 1.0, 0.0, &signal),
          "1000000000.0000001 Hz");
  DEF(material_mohr_coulomb, soil, .young = 1e6, .poisson = 0.3, .friction = 0.25, .cohesion = 1.0,
      .dilation = nextafter(0.25, 1.0));
  REFUSES(mps_material_create_mohr_coulomb(context, &soil, &material), "0.25000000000000006 rad");
  coupling.size = 1, coupling.relaxation = above;
  REFUSES(mps_coupling_create(context, &coupling, &coupled), "1.0000000000000002");
  water.radius_ratio = nextafter(4.0, 5.0);
  REFUSES(mps_fluid_create(context, set, &water, &fluid), "4.0000000000000009");
  OK(mps_material_create_linear_elastic(context, 1e6, 0.3, &material));
  mpm_def.cell = 0.2, mpm_def.courant = above;
  REFUSES(mps_mpm_create(context, set, material, &mpm_def, &mpm), "1.0000000000000002");
  mpm_def.courant = 0.5;
  OK(mps_mpm_create(context, set, material, &mpm_def, &mpm));
  OK(mps_body_create_disc(context, &place, 0.1, &body));
  DEF(contact, contact, .offset = nextafter(1e9, INFINITY));
  REFUSES(mps_mpm_add_contact(mpm, body, &contact, NULL), "1000000000.0000001 m");
}

TEST(values_of_dynamics_just_outside) {
  scoped_particles *set = block(2);
  mps_dynamics *dynamics = NULL;
  SET_FIELDS(set, {"shear_velocity", 20.0}, {"pressure_velocity", 40.0});
  DEF(dynamics, def, .courant = nextafter(1.0, 2.0));
  REFUSES(mps_dynamics_create(context, set, &def, &dynamics), "courant is 1.0000000000000002,");
  def = mps_dynamics_defaults();
  def.radius_ratio = nextafter(4.0, 5.0);
  REFUSES(mps_dynamics_create(context, set, &def, &dynamics),
          "radius_ratio is 4.0000000000000009,");
}

TEST(a_ball_beyond_the_lattice_names_its_radius) {
  const double centre[2] = {0.0, 0.0}, far[2] = {0.0, 1e300};
  scoped_particles *set = block(2);
  REFUSES(mps_particles_fill_ball(set, centre, 1e300, NULL), "radius: the ball has x = -1e+300 m");
  REFUSES(mps_particles_fill_ball(set, far, 1.0, NULL), "centre has y = 1e+300 m");
}

TEST(a_file_of_another_set_names_the_path) {
  if (!mps_library_has(MPS_FEATURE_HDF5)) skip();
  static const char *const path = TEST_TMP "/test_messages.h5";
  mps_particles *set = block(2), *other = NULL;
  mps_checkpoint info = mps_checkpoint_defaults();
  OK(mpsi_checkpoint_write(set, path, &info));
  USING(particles, mps_particles_create(context, &given, &other), .spacing = 0.2);
  REFUSES(mps_checkpoint_read(other, path, &info), "path: '" TEST_TMP "/test_messages.h5' has 16");
  OK(mps_particles_fill_box(other, AT(0.0, 0.0), AT(0.8, 0.8), NULL));
  REFUSES(mps_checkpoint_read(other, path, &info), "path: '");
  assert_non_null(strstr(message(), "has spacing 0.1"));
  mps_particles_destroy(&other);
  mps_particles_destroy(&set);
  (void)remove(path);
}

TEST_GROUP(open_context, close_context)
