/* test_wrong_calls.c - one fault, one sentence: what was given, what is allowed, what to do.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "test_fixture.h"

static void said(mps_status status, const char *message) {
  assert_int_not_equal(status, MPS_OK);
  assert_string_equal(mps_last_error()->message, message);
  assert_null(strstr(mps_last_error()->function, "_sized"));
}

static mps_particles *square(void) {
  mps_particles *set = box_of(context, 0.25, AT(0.0, 0.0), AT(1.0, 1.0));
  return set;
}

TEST(bodies_name_the_member_that_is_wrong) {
  scoped_body *body = NULL;
  DEF(body, def, .mass = 5.0);
  mps_reaction reaction;
  const double point[2] = {0.0, 0.0};
  double force[3] = {0.0, NAN, 0.0};
  said(mps_body_create_disc(context, &def, 1.0, &body),
       "mass is 5 kg, must be 0, or NaN where motion is MPS_BODY_MOTION_DRIVEN: make it "
       "MPS_BODY_MOTION_FREE, or leave this out and move the body by mps_body_drive");
  def.motion = MPS_BODY_MOTION_FREE;
  said(mps_body_create_disc(context, &def, 1.0, &body),
       "inertia[2] is nan kg m2, must be in 1e-30 to 1e+30 where motion is MPS_BODY_MOTION_FREE");
  def.inertia[2] = -2.0;
  said(mps_body_create_disc(context, &def, 1.0, &body),
       "inertia[2] is -2 kg m2, must be in 1e-30 to 1e+30, or 0, or NaN");
  def.motion = 7;
  said(mps_body_create_disc(context, &def, 1.0, &body),
       "motion is 7, allowed are MPS_BODY_MOTION_DRIVEN and MPS_BODY_MOTION_FREE");
  def.motion = MPS_BODY_MOTION_FREE, def.inertia[2] = 2.0;
  OK(mps_body_create_disc(context, &def, 1.0, &body));
  said(mps_body_set_load(body, force, NULL), "force[1] is nan, must be finite");
  said(mps_body_name_part(body, "tip", 5, 1, NULL),
       "first is 5 and count 1, but the surface is a single piece: 0 and 1");
  said(mps_body_get_reaction(body, 3, &reaction),
       "part is 3, and the body has no named parts: allowed are 0 and -1, the whole");
  said(mps_body_distance(body, -1, point, NULL, NULL, NULL, NULL),
       "count is -1 points, allowed are 0 to 1099511627776");
  said(mps_body_distance(body, 1, NULL, NULL, NULL, NULL, NULL), "x is NULL");
}

TEST(solvers_name_constants_and_one_argument) {
  scoped_particles *set = square();
  scoped_mpm *mpm = NULL;
  DEF(mpm, def, .cell = 0.5, .lower[0] = 0.0, .lower[1] = 0.0);
  double value;
  OK(mps_particles_set(set, "density", 0, 1800.0));
  said(mps_particles_set(set, "density", 1, 5.0),
       "component of field 'density' is 1, and the field has one alone: 0");
  MAKE(material, law, create_linear_elastic, context, 1e7, 0.3);
  OK(mps_mpm_create(context, set, law, &def, &mpm));
  said(mps_mpm_set_side(mpm, MPS_SIDE_X_LOWER, MPS_BOUNDARY_ROLLER, 0.4),
       "friction is 0.4, must be 0 where kind is MPS_BOUNDARY_ROLLER: make it "
       "MPS_BOUNDARY_FRICTIONAL");
  const mps_grid *grid = mps_mpm_grid(mpm);
  said(mps_grid_evaluate(grid, NULL, 0, 1, &value, &value, NULL), "field is NULL");
  said(mps_grid_evaluate(grid, "velocity", 0, 1, NULL, &value, NULL), "points is NULL");
  mps_mpm_destroy(&mpm);
  mps_geostatic_def ground = mps_geostatic_defaults();
  said(mps_particles_set_geostatic(set, &ground),
       "layers is NULL: give an array of mps_geostatic_layer, and layer_count");
  MAKE(fluid, fluid, create, context, set, NULL);
  said(mps_fluid_set_boundary_motion(fluid, 3, NULL, &value),
       "number is 3: there is no boundary of this number");
}

TEST(a_set_without_moduli_is_told_how_to_get_them) {
  if (!mps_library_has(MPS_FEATURE_CHOLMOD)) skip();
  scoped_particles *set = square();
  scoped_elastic *elastic = NULL;
  said(mps_elastic_create(context, set, NULL, &elastic),
       "the particle set has no field 'young': set it with mps_particles_set or "
       "mps_particles_set_material, or give the `material` of the definition");
  SET_FIELDS(set, {"young", 1e7}, {"poisson", 0.3});
  OK(mps_elastic_create(context, set, NULL, &elastic));
  DEF(elastic_load, load, .kind = 44);
  said(mps_elastic_add_load(elastic, &load, NULL),
       "kind is 44, allowed are MPS_ELASTIC_LOAD_BODY, MPS_ELASTIC_LOAD_VOLUME, "
       "MPS_ELASTIC_LOAD_FORCE, MPS_ELASTIC_LOAD_TRACTION, MPS_ELASTIC_LOAD_PRESSURE and "
       "MPS_ELASTIC_LOAD_FUNCTION");
  said(mps_elastic_cut(elastic, mps_side_of(4, 1), NULL, 0),
       "side is 9, allowed are MPS_SIDE_X_LOWER to MPS_SIDE_Y_UPPER");
  said(mps_elastic_cut(elastic, MPS_SIDE_ANY, NULL, 0),
       "side is MPS_SIDE_ANY, allowed are MPS_SIDE_X_LOWER to MPS_SIDE_Y_UPPER");
}
