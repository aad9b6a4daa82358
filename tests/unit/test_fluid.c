/* test_fluid.c - the fluid solver as an object: what it refuses, how it lives, what a failed or
 * cancelled call leaves behind.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "body/contact_internal.h"
#include "test_fixture.h"

#include "fluid_tank.h"

static mps_particles *block(double l0) {
  mps_particles *p = box_of(context, l0, AT(0.0, 0.0), AT(10.0 * l0, 5.0 * l0));
  return p;
}

TEST(bad_definitions_are_refused) {
  scoped_particles *p = block(0.1);
  mps_fluid *f = NULL;
  const struct {
    size_t member;
    double value;
    const char *text;
  } cases[] = {
      {offsetof(mps_fluid_def, gravity), 1e7, "gravity is (1e+07, -9.81) m/s2"},
      {offsetof(mps_fluid_def, dt), 0.0506, "dt is 0.0506"}, /* .5 (.1/9.81)^.5 = .0505 */
  };
  for (size_t k = 0; k < sizeof cases / sizeof *cases; k++) {
    mps_fluid_def def = mps_fluid_defaults();
    memcpy((char *)&def + cases[k].member, &cases[k].value, sizeof(double));
    const int32_t fields = mps_particles_field_count(p);
    REFUSES(mps_fluid_create(context, p, &def, &f), cases[k].text);
    assert_null(f);
    assert_int_equal(mps_particles_field_count(p), fields);
  }
  f = (mps_fluid *)p; /* an error leaves NULL there, whatever it was */
  REFUSES(mps_fluid_create(context, NULL, NULL, &f), "particles is NULL");
  assert_null(f);
  scoped_context *other = test_context(MPS_CONTEXT_EXECUTOR_SERIAL, 1);
  FAILS_ON(other, mps_fluid_create(other, p, NULL, &f), MPS_ERROR_ARGUMENT, "another context");
}

static mps_material *newtonian(double viscosity) {
  DEF(material_newtonian, law, .bulk_modulus = 1e6, .viscosity = viscosity);
  MAKE_KEPT(material, material, create_newtonian, context, &law);
  return material;
}

/* A square of water between walls of no slip, sheared: what is left of its speeds after ten steps,
 * a digest of them all. */
static double sheared(mps_fluid_def def, double density) {
  scoped_particles *p = block(0.1);
  double sum = 0.0;
  def.dt = 1e-3;
  if (density > 0.0) OK(mps_particles_set(p, "density", 0, density));
  OK(mps_particles_add_field(p, "velocity", 0));
  EDIT(u, p, "velocity")
    for (int64_t i = 0; i < u.view.shape[0]; i++) *mps_edit_f64(&u, i, 0) = 0.01 * (double)(i / 10);
  MAKE(fluid, f, create, context, p, &def);
  (void)tank_wall(f, 0.0, 0.0, 0.0, 1.0, NULL);
  OK(mps_fluid_step(f, 10));
  mps_view v = view_field(p, "velocity");
  for (int64_t i = 0; i < v.shape[0]; i++) sum += *mps_view_f64(&v, i, 0) * (double)(1 + i);
  return sum;
}

/* One fluid, given by numbers, by a material, by the set's field. */
TEST(a_fluid_is_a_material) {
  mps_fluid_def plain = mps_fluid_defaults(), numbers = plain, law = plain, now;
  scoped_material *syrup = newtonian(50.0), *rock = NULL;
  OK(mps_material_create_linear_elastic(context, 1e7, 0.3, &rock));
  assert_true(isnan(plain.density) && isnan(plain.viscosity));
  numbers.density = 1300.0, numbers.viscosity = 50.0;
  law.material = syrup, law.viscosity = 7.0; /* not read with a material */
  const double expected = sheared(numbers, 0.0);
  assert_true(sheared(law, 1300.0) == expected);
  assert_true(sheared(plain, 1300.0) != expected);
  scoped_particles *p = block(0.1);
  MAKE(fluid, f, create, context, p, &law);
  OK(mps_fluid_get_def(f, &now));
  assert_true(now.density == 1000.0 && now.viscosity == 50.0 && now.material == NULL);
  mps_fluid_destroy(&f);
  law = plain, law.material = rock;
  FAILS(mps_fluid_create(context, p, &law, &f), MPS_ERROR_UNSUPPORTED, "the law is linear_elastic");
  OK(mps_particles_set(p, "density", 0, 1000.0));
  EDIT(rho, p, "density") *mps_edit_f64(&rho, 4, 0) = 1025.0;
  REFUSES(mps_fluid_create(context, p, NULL, &f), "is 1025 kg/m3, that of particle 0 1000");
  OK(mps_fluid_create(context, p, &numbers, &f));
}

TEST(the_definition_comes_back_completed) {
  scoped_particles *p = block(0.1);
  mps_fluid_def def = mps_fluid_defaults(), now;
  def.density = 1025.0, def.measure = 2.0;
  MAKE(fluid, f, create, context, p, &def);
  OK(mps_fluid_set_dt(f, 0.01));
  OK(mps_fluid_get_def(f, &now));
  assert_int_equal(now.struct_size, sizeof now);
  assert_true(now.density == 1025.0 && now.measure == 2.0 && now.dt == 0.01);
  NEAR(now.level, 0.5, 1e-12); /* half a spacing above the highest row, at .45 */
  assert_int_equal(mps_fluid_get_def(NULL, &now), MPS_ERROR_ARGUMENT);
  REFUSES(mps_fluid_get_def(f, NULL), "NULL");
  assert_ptr_equal(mps_fluid_context(f), context);
  assert_null(mps_fluid_context(NULL));
}

/* Highest pressure and velocities after a drop, by a kernel of the caller's or by its radius. */
static void drop_with(mps_kernel *kernel, double *out) {
  scoped_particles *p = block(0.1);
  mps_fluid_def def = mps_fluid_defaults(), now;
  def.dt = 0.004;
  def.radius_ratio = kernel ? 3.1 : 2.9;
  def.kernel = kernel;
  MAKE(fluid, f, create, context, p, &def);
  mps_kernel_destroy(&kernel); /* the fluid has its share */
  OK(mps_fluid_get_def(f, &now));
  NEAR(now.radius_ratio, 2.9, 1e-14);
  tank_wall(f, 0.0, 0.0, 0.0, 1.0, NULL);
  OK(mps_fluid_step(f, 5));
  mps_view v = view_field(p, "velocity");
  for (int64_t k = 0; k < v.shape[0]; k++) out[k] = *mps_view_f64(&v, k, 1);
}

/* The weight is the kernel that the caller can query: of another radius, and no other kind. */
TEST(takes_a_kernel) {
  double by_radius[50], by_kernel[50], most = 0.0;
  scoped_particles *p = block(0.1);
  mps_fluid *f = NULL;
  mps_fluid_def def = mps_fluid_defaults();
  OK(mps_kernel_create(context, MPS_KERNEL_SMOOTH, 0.29, &def.kernel));
  drop_with(NULL, by_radius);
  drop_with(def.kernel, by_kernel);
  for (int k = 0; k < 50; k++) {
    NEAR(by_kernel[k], by_radius[k], 1e-12);
    most = fmax(most, fabs(by_radius[k]));
  }
  assert_true(most > 1e-3);
  OK(mps_kernel_create(context, MPS_KERNEL_MPS, 0.29, &def.kernel));
  REFUSES(mps_fluid_create(context, p, &def, &f),
          "its kind is MPS_KERNEL_MPS, and that of a fluid must be MPS_KERNEL_SMOOTH");
  mps_kernel_destroy(&def.kernel);
  OK(mps_kernel_create(context, MPS_KERNEL_SMOOTH, 0.5, &def.kernel));
  REFUSES(mps_fluid_create(context, p, &def, &f),
          "kernel of the fluid has a radius of 0.5 m, must be 2.6 to 4 spacings of 0.1 m");
  mps_kernel_destroy(&def.kernel);
}

TEST(bad_boundaries_are_refused) {
  scoped_particles *p = block(0.1);
  MAKE(fluid, f, create, context, p, NULL);
  mps_fluid_boundary_def def = mps_fluid_boundary_defaults();
  def.kind = MPS_BOUNDARY_ROLLER; /* slip */
  REFUSES(mps_fluid_add_boundary(f, &def, NULL), "normal");
  def.normal[1] = 1.0;
  def.point[1] = 0.021; /* the lowest particles are at .05: .29 l0 */
  REFUSES(mps_fluid_add_boundary(f, &def, NULL), "by at least 0.3 l0");
  def.point[1] = NAN;
  REFUSES(mps_fluid_add_boundary(f, &def, NULL), "point[1] is nan m");
  def.point[1] = 0.0, def.kind = 3;
  REFUSES(mps_fluid_add_boundary(f, &def, NULL), "kind");
  def.kind = MPS_BOUNDARY_ROLLER;
  OK(mps_fluid_add_boundary(f, &def, NULL));
  def.normal[0] = 1.0, def.normal[1] = -1.0, def.point[0] = -3.0, def.point[1] = 3.0;
  REFUSES(mps_fluid_add_boundary(f, &def, NULL), "enclose 45 degrees");
  mps_reaction r;
  REFUSES(mps_fluid_get_reaction(f, 1, &r), "number is 1: there is no boundary");
  REFUSES(mps_fluid_remove_boundary(f, 7), "number is 7");
  const double off[3] = {0.5, 0.01, 0.0};
  double pressure;
  REFUSES(mps_fluid_get_pressure(f, 0, 1, off, &pressure), "off the wall");
  OK(mps_fluid_remove_boundary(f, 0));
  REFUSES(mps_fluid_get_reaction(f, 0, &r), "number is 0");
}

static mps_status steps_inside(void *user, mps_fluid *f) {
  mps_fluid *same = f;
  (void)user;
  FAILS(mps_fluid_step(f, 1), MPS_ERROR_STATE, "may only read");
  FAILS(mps_fluid_set_dt(f, 1e-3), MPS_ERROR_STATE, "may only read");
  mps_fluid_destroy(&same);
  assert_non_null(same);
  return MPS_OK;
}

static mps_status stops(void *user, mps_fluid *f) {
  return mps_fluid_steps(f) == 3 ? MPS_ERROR_IO : MPS_OK;
}

TEST(a_run_ends_on_time_and_its_callback_only_reads) {
  scoped_tank t = tank_make(context, 0.6, 0.3, 0.05, NULL, NAN);
  REFUSES(mps_fluid_run(t.fluid, -1.0, 1, NULL, NULL), "t_end is -1");
  REFUSES(mps_fluid_run(t.fluid, 1.0, 0, NULL, NULL), "every is 0");
  OK(mps_fluid_run(t.fluid, 0.05, 2, steps_inside, NULL));
  NEAR(mps_fluid_time(t.fluid), 0.05, 0.0);
  tank_free(&t);
  t = tank_make(context, 0.6, 0.3, 0.05, NULL, 1e-3);
  FAILS(mps_fluid_run(t.fluid, 1.0, 1, stops, NULL), MPS_ERROR_IO, "callback");
  assert_int_equal(mps_fluid_steps(t.fluid), 3);
}

/* Copies position, velocity and pressure of all particles. */
static void copy_state(const tank *t, double *to) {
  static const char *const names[] = {"position", "velocity"};
  const int64_t n = mps_particles_count(t->water);
  for (int f = 0; f < 2; f++) {
    mps_view v = view_field(t->water, names[f]);
    for (int64_t i = 0; i < n; i++)
      for (int c = 0; c < 2; c++) *to++ = *mps_view_f64(&v, i, c);
  }
}

TEST(a_solution_that_does_not_converge_keeps_the_state) {
  MAKE(signal, piston, create_sine, context, MPS_SIGNAL_QUANTITY_DISPLACEMENT, 1.0, 0.02, 0.0);
  mps_particles *p = block(0.05);
  scoped_tank t = {p, NULL};
  USING(fluid, mps_fluid_create(context, p, &given, &t.fluid), .iterations = 1, .tolerance = 1e-12);
  tank_wall(t.fluid, 0.0, 0.0, 0.0, 1.0, NULL);
  tank_wall(t.fluid, 0.0, 0.0, 1.0, 0.0, piston);
  tank_wall(t.fluid, 0.5, 0.0, -1.0, 0.0, NULL);
  const int64_t n = mps_particles_count(p);
  double *before = malloc(8 * (size_t)n * sizeof *before), *after = before + 4 * n;
  copy_state(&t, before);
  FAILS(mps_fluid_step(t.fluid, 1), MPS_ERROR_NUMERIC, "has not converged");
  copy_state(&t, after);
  assert_memory_equal(before, after, 4 * (size_t)n * sizeof *before);
  assert_int_equal(mps_fluid_steps(t.fluid), 0);
  NEAR(mps_fluid_time(t.fluid), 0.0, 0.0);
  free(before);
}

TEST(a_drop_falls_freely_and_an_empty_tank_goes_on) {
  DEF(particles, set, .spacing = 0.1);
  DEF(fluid, def, .dt = 0.01);
  const double alone[2] = {0.0, 100.0};
  MAKE(particles, p, create, context, &set);
  OK(mps_particles_append(p, 1, alone));
  MAKE(fluid, f, create, context, p, &def);
  OK(mps_fluid_step(f, 100)); /* symplectic Euler: g t (t + dt)/2 */
  mps_view x = view_field(p, "position");
  NEAR(*mps_view_f64(&x, 0, 1), 100.0 - 0.5 * TANK_G * 1.0 * 1.01, 1e-10);
  mps_fluid_report report;
  OK(mps_fluid_get_report(f, &report));
  assert_int_equal(report.apart, 1);
}

/* Without gravity the shortest step is a share of the run, wherever on the axis of time it begins:
 * a drop of 1 m/s takes 40 steps a second, after a million seconds too. */
TEST(a_late_run_has_steps_of_its_own_length) {
  DEF(particles, set, .spacing = 0.1);
  DEF(fluid, def, .gravity[1] = 0.0, .dt = 1e6);
  const double alone[2] = {0.0, 0.0};
  MAKE(particles, p, create, context, &set);
  OK(mps_particles_append(p, 1, alone));
  MAKE(fluid, f, create, context, p, &def);
  OK(mps_fluid_step(f, 1));
  OK(mps_fluid_set_dt(f, NAN));
  mps_edit u;
  OK(mps_particles_edit(p, "velocity", &u));
  *mps_edit_f64(&u, 0, 0) = 1.0;
  OK(mps_particles_commit(p, &u));
  OK(mps_fluid_run(f, 1e6 + 1.0, 1000, NULL, NULL));
  assert_in_range(mps_fluid_steps(f), 41, 42); /* .25 l0/|u| is 1/40 s */
  mps_view x = view_field(p, "position");
  NEAR(*mps_view_f64(&x, 0, 0), 1.0, 1e-9);
}

TEST(a_film_one_particle_thick_lies_still) {
  scoped_tank t = tank_make(context, 0.5, 0.02, 0.02, NULL, 2e-3);
  OK(mps_fluid_step(t.fluid, 500));
  mps_totals sum;
  OK(mps_fluid_get_totals(t.fluid, &sum));
  assert_true(sum.kinetic < 1e-9 * TANK_G * sum.mass * 0.02);
}

/* The tank's floor opens: all water falls out, and the steps continue. */
TEST(a_tank_runs_empty) {
  scoped_tank t = tank_make(context, 0.5, 0.1, 0.02, NULL, 2e-3);
  OK(mps_fluid_remove_boundary(t.fluid, TANK_BED));
  OK(mps_fluid_step(t.fluid, 250));
  double level;
  const double middle = 0.25;
  OK(mps_fluid_get_levels(t.fluid, 1, &middle, &level));
  const double nowhere = NAN;
  REFUSES(mps_fluid_get_levels(t.fluid, 1, &nowhere, &level), "station 0 is nan m, must be finite");
  mps_view x = view_field(t.water, "position");
  for (int64_t i = 0; i < mps_particles_count(t.water); i++)
    NEAR(*mps_view_f64(&x, i, 1), 0.05 - 0.5 * TANK_G * 0.25, 0.12);
}

/* A snapshot of a moving piston's tank, 40 more steps, back, and the same 40 steps. */
TEST(a_rollback_repeats_the_steps_bit_for_bit) {
  scoped_snapshot *snapshot = NULL;
  MAKE(signal, piston, create_sine, context, MPS_SIGNAL_QUANTITY_DISPLACEMENT, 1.0, 0.05, 0.0);
  scoped_tank t = tank_make(context, 1.0, 0.3, 0.025, piston, 2e-3);
  const int64_t n = mps_particles_count(t.water);
  double *first = malloc(8 * (size_t)n * sizeof *first), *second = first + 4 * n;
  OK(mps_fluid_step(t.fluid, 50)); /* a sort comes between: at 64 steps */
  OK(mps_fluid_snapshot(t.fluid, &snapshot));
  mps_reaction force[2];
  for (int run = 0; run < 2; run++) {
    if (run > 0) OK(mps_fluid_rollback(t.fluid, snapshot));
    assert_int_equal(mps_fluid_steps(t.fluid), 50);
    OK(mps_fluid_step(t.fluid, 40));
    copy_state(&t, run == 0 ? first : second);
    OK(mps_fluid_get_reaction(t.fluid, TANK_RIGHT, &force[run]));
  }
  assert_memory_equal(first, second, 4 * (size_t)n * sizeof *first);
  assert_memory_equal(&force[0], &force[1], sizeof force[0]);
  OK(mps_fluid_remove_boundary(t.fluid, TANK_RIGHT));
  FAILS(mps_fluid_rollback(t.fluid, snapshot), MPS_ERROR_STATE, "boundaries is 3");
  free(first);
}

/* A piston that gets another signal continues from where it is with the velocity it has. */
TEST(a_boundary_can_change) {
  scoped_signal *piston = NULL, *slow = NULL;
  OK(mps_signal_create_sine(context, MPS_SIGNAL_QUANTITY_DISPLACEMENT, 1.0, 0.02, 0.0, &piston));
  OK(mps_signal_create_sine(context, MPS_SIGNAL_QUANTITY_DISPLACEMENT, 0.5, 0.02, 0.0, &slow));
  scoped_tank t = tank_make(context, 0.6, 0.3, 0.03, piston, 2e-3);
  OK(mps_fluid_run(t.fluid, 0.25, 1000, NULL, NULL)); /* at .02 m, at rest */
  mps_reaction before, after;
  OK(mps_fluid_get_reaction(t.fluid, TANK_LEFT, &before));
  mps_fluid_boundary_def def = mps_fluid_boundary_defaults();
  def.kind = MPS_BOUNDARY_ROLLER; /* slip */
  def.point[0] = 0.1, def.normal[0] = 1.0;
  REFUSES(mps_fluid_set_boundary(t.fluid, TANK_LEFT, &def), "must lie inside it");
  REFUSES(mps_fluid_set_boundary(t.fluid, 5, &def), "number is 5");
  def.point[0] = 0.02, def.signal = slow, def.kind = MPS_BOUNDARY_DRIVEN;
  OK(mps_fluid_set_boundary(t.fluid, TANK_LEFT, &def));
  OK(mps_fluid_get_reaction(t.fluid, TANK_LEFT, &after));
  assert_memory_equal(&before, &after, sizeof before);
  OK(mps_fluid_run(t.fluid, 1.0, 1000, NULL, NULL));
  OK(mps_fluid_get_reaction(t.fluid, TANK_LEFT, &after));
  assert_true(after.impulse[0] > before.impulse[0] + 100.0);
  double x[3 * 20];
  int64_t count = 0;
  OK(mps_fluid_get_boundary_points(t.fluid, TANK_LEFT, 20, &count, x, NULL));
  assert_in_range(count, 8, 13);
  /* .02 m + .02 (sin(pi) - sin(.25 pi)) m */
  NEAR(x[0], 0.02 - 0.02 * sin(0.25 * TANK_PI), 1e-12);
}

/* What a body must be; a snapshot with a body in the water; how it goes again. */
TEST(bodies_come_and_go) {
  scoped_tank t = tank_make(context, 0.6, 0.3, 0.03, NULL, 2e-3);
  mps_body_def at = mps_body_defaults();
  mps_body *box = NULL, *disc = NULL, *small = NULL, *corner = NULL;
  scoped_snapshot *snapshot = NULL;
  mps_contact *contact = NULL;
  mps_fluid_contact_def driven = mps_fluid_contact_defaults();
  mps_reaction r[2], part;
  int64_t count = 0;
  const double xy[8] = {0.0, 0.0, 0.1, 0.0, 0.02, 0.02, 0.0, 0.1};
  at.position[0] = 0.3, at.position[1] = 0.5, driven.kind = MPS_BOUNDARY_DRIVEN;
  OK(mps_body_create_disc(context, &at, 0.1, &disc));
  OK(mps_body_create_box(context, &at, 0.2, 0.02, &small));
  OK(mps_body_create_polygon(context, &at, 4, xy, &corner));
  OK(mps_body_create_box(context, &at, 0.2, 0.2, &box));
  REFUSES(mps_fluid_add_contact(t.fluid, NULL, NULL, &contact), "NULL");
  REFUSES(mps_fluid_add_contact(t.fluid, disc, NULL, &contact), "must be a polygon");
  REFUSES(mps_fluid_add_contact(t.fluid, small, NULL, &contact), "edge 1 of the body");
  REFUSES(mps_fluid_add_contact(t.fluid, corner, NULL, &contact), "edge 1 of the body");
  REFUSES(mps_fluid_add_contact(t.fluid, box, &driven, &contact), "kind is MPS_BOUNDARY_DRIVEN, ");
  assert_null(contact);
  OK(mps_body_name_part(box, "bottom", 0, 1, NULL));
  DEF(fluid_contact, carried, .mover = MPS_CONTACT_MOVER_OTHER);
  OK(mps_fluid_add_contact(t.fluid, box, &carried, &contact));
  assert_true(contact->body == box);
  REFUSES(mps_contact_get_reaction(contact, 2, &r[0]), "part");
  FAILS(mps_contact_get_particles(contact, 0, &count, NULL, NULL, NULL, NULL, NULL),
        MPS_ERROR_UNSUPPORTED, "contact is that of a fluid");
  /* it dips into the water at 1 m/s */
  OK(mps_fluid_snapshot(t.fluid, &snapshot));
  for (int run = 0; run < 2; run++) {
    mps_body_motion motion = mps_body_motion_defaults();
    if (run > 0) OK(mps_fluid_rollback(t.fluid, snapshot));
    for (int k = 0; k < 75; k++) {
      motion.velocity[1] = -1.0, motion.position[1] = 0.5 - 2e-3 * (k + 1);
      OK(mps_body_set_motion(box, &motion));
      OK(mps_fluid_step(t.fluid, 1));
    }
    OK(mps_contact_get_reaction(contact, -1, &r[run]));
  }
  assert_true(r[0].force[1] > 0.5 * 1000.0 * TANK_G * 0.2 * 0.05);
  assert_true(r[0].work > 0.0 && r[0].impulse[1] > 0.0);
  assert_memory_equal(&r[0], &r[1], sizeof r[0]);
  /* all but the sides' level forces acts on the part that is under water */
  OK(mps_contact_get_reaction(contact, 1, &part));
  NEAR(part.force[1], r[1].force[1], 1e-9 * r[1].force[1]);
  mps_body_destroy(&box); /* the fluid keeps it */
  OK(mps_fluid_step(t.fluid, 1));
  mps_contact_destroy(&contact);
  assert_null(contact);
  OK(mps_fluid_step(t.fluid, 1));
  FAILS(mps_fluid_rollback(t.fluid, snapshot), MPS_ERROR_STATE, "");
  mps_body_destroy(&disc);
  mps_body_destroy(&small);
  mps_body_destroy(&corner);
}

/* A box that dips into water along a signal: moved by the fluid it is where the caller's
 * mps_body_advance before each step puts it, also after a rollback; a step that is not made leaves
 * it. */
static void follows_its_signals(double l0, double x) {
  const double dt = 2e-3;
  mps_body_state end[2];
  mps_reaction r[2];
  for (int run = 0; run < 2; run++) {
    scoped_tank t = tank_make(context, 0.6, 0.3, l0, NULL, dt);
    DEF(body, at, .position[0] = x, .position[1] = 0.42);
    scoped_body *box = NULL;
    scoped_signal *sine = NULL;
    scoped_snapshot *snapshot = NULL;
    OK(mps_body_create_box(context, &at, 0.2, 0.2, &box));
    OK(mps_signal_create_sine(context, MPS_SIGNAL_QUANTITY_DISPLACEMENT, 0.05, 1.0, 0.0, &sine));
    OK(mps_body_drive(box, 1, sine, -1.0));
    OK(mps_body_drive(box, 5, sine, 2.0));
    scoped_contact *contact =
        tank_body(t.fluid, box, run ? MPS_CONTACT_MOVER_SOLVER : MPS_CONTACT_MOVER_OTHER);
    OK(mps_fluid_snapshot(t.fluid, &snapshot));
    if (run) {
      FAILS(mps_body_advance(box, dt), MPS_ERROR_STATE, "MPS_CONTACT_MOVER_OTHER");
      OK(mps_fluid_step(t.fluid, 7));
      OK(mps_fluid_rollback(t.fluid, snapshot));
      OK(mps_fluid_begin_step(t.fluid, 8.0 * dt));
      OK(mps_fluid_solve_pressure(t.fluid));
      OK(mps_fluid_abandon_step(t.fluid));
      OK(mps_body_get_state(box, &end[1]));
      assert_true(end[1].time == 0.0 && end[1].position[1] == 0.42);
    }
    for (int k = 0; k < 75; k++) {
      if (!run) OK(mps_body_advance(box, dt));
      OK(mps_fluid_step(t.fluid, 1));
    }
    OK(mps_contact_get_reaction(contact, -1, &r[run]));
    OK(mps_body_get_state(box, &end[run]));
  }
  assert_true(r[0].force[1] > 30.0); /* N: it dips in by some 0.02 m of 0.2 */
  assert_memory_equal(&r[0], &r[1], sizeof r[0]);
  assert_memory_equal(&end[0], &end[1], sizeof end[0]);
}

TEST(driven_bodies_follow_their_signals) {
  const double l0[] = {0.03, 0.02, 0.015},
               x[] = {0.3, 0.2537, 0.3463}; /* off the lattice, mirrored */
  for (int k = 0; k < 3; k++) follows_its_signals(l0[k], x[k]);
}

/* Water pushed sideways by a in every particle leans on the right wall and off the left one, alike;
 * what the walls do not take is its momentum. */
TEST(forces_on_particles_push) {
  scoped_tank t = tank_make(context, 0.6, 0.3, 0.02, NULL, 1e-3);
  mps_edit force;
  const double a = 0.5, share = 1000.0 * a * 0.3 * 0.3, still = 0.5 * 1000.0 * TANK_G * 0.09;
  OK(mps_particles_add_field(t.water, "external_force", 0));
  OK(mps_particles_edit(t.water, "external_force", &force));
  for (int64_t i = 0; i < mps_particles_count(t.water); i++)
    *mps_edit_f64(&force, i, 0) = a * 1000.0 * 0.02 * 0.02;
  OK(mps_particles_commit(t.water, &force));
  mps_reaction left, right;
  mps_totals sum;
  OK(mps_fluid_step(t.fluid, 1));
  OK(mps_fluid_get_reaction(t.fluid, TANK_LEFT, &left));
  OK(mps_fluid_get_reaction(t.fluid, TANK_RIGHT, &right));
  /* at the surface p is 0: less than rho a (L/2) d on each */
  const double more = -right.force[0] - still, less = still - left.force[0];
  assert_true(more > 0.3 * share && more < share);
  NEAR(more, less, 0.03 * share);
  OK(mps_fluid_get_totals(t.fluid, &sum));
  NEAR(sum.linear[0], 1e-3 * (a * sum.mass - more - less), 1e-3 * 0.03 * share);
  OK(mps_fluid_step(t.fluid, 100));
  OK(mps_fluid_get_totals(t.fluid, &sum));
  assert_true(sum.work_loads > 0.0 && fabs(sum.dissipated) < 0.05 * sum.work_loads);
}

/* A wall that moves by more than a spacing in one step puts the particles before it; nothing is
 * lost, and the next steps are short. */
static void count_warnings(void *user, int32_t level, const char *message) {
  int *count = user;
  *count += level == MPS_CONTEXT_LOG_WARNING && strstr(message, "moved off walls") != NULL;
}

/* Its step is made, and the log has one warning that the guards act often. */
TEST(a_wall_may_be_fast) {
  int warnings = 0;
  mps_context_set_log(context, count_warnings, &warnings, NULL);
  scoped_tank t = tank_make(context, 0.6, 0.3, 0.03, NULL, NAN);
  const double v = 40.0, place = 0.04, stop = 0.0;
  OK(mps_fluid_set_boundary_motion(t.fluid, TANK_LEFT, &place, &v));
  OK(mps_fluid_step(t.fluid, 1));
  mps_fluid_report report;
  OK(mps_fluid_get_report(t.fluid, &report));
  assert_true(report.pushed > 0);
  assert_true(mps_fluid_limit(t.fluid) <= 0.2 * 0.03 / 40.0 * (1.0 + 1e-12));
  for (int k = 0; k < 50; k++) {
    OK(mps_fluid_set_boundary_motion(t.fluid, TANK_LEFT, &place, &stop));
    OK(mps_fluid_step(t.fluid, 1));
  }
  mps_view x = view_field(t.water, "position");
  for (int64_t i = 0; i < mps_particles_count(t.water); i++) {
    assert_true(*mps_view_f64(&x, i, 0) > 0.04 && *mps_view_f64(&x, i, 0) < 0.6);
    assert_true(*mps_view_f64(&x, i, 1) > 0.0);
  }
  assert_int_equal(warnings, 1);
  mps_context_set_log(context, NULL, NULL, NULL);
}

/* A second layer of water comes onto the first, and goes again. */
TEST(particles_come_and_go) {
  scoped_tank t = tank_make(context, 0.6, 0.2, 0.02, NULL, 2e-3);
  const int64_t n = mps_particles_count(t.water);
  const double outside[2] = {0.1, -0.1};
  scoped_snapshot *snapshot = NULL;
  double x[2 * 600];
  int64_t ids[600];
  mps_totals sum;
  mps_reaction r;
  OK(mps_fluid_step(t.fluid, 20));
  REFUSES(mps_particles_append(t.water, 1, outside), "inside the fluid's walls");
  assert_int_equal(mps_particles_count(t.water), n);
  for (int j = 0; j < 20; j++)
    for (int i = 0; i < 30; i++)
      x[2 * (30 * j + i)] = (i + 0.5) * 0.02, x[2 * (30 * j + i) + 1] = 0.2 + (j + 0.5) * 0.02;
  OK(mps_fluid_snapshot(t.fluid, &snapshot));
  OK(mps_particles_append(t.water, 600, x));
  OK(mps_fluid_get_totals(t.fluid, &sum));
  NEAR(sum.mass, 1000.0 * 0.6 * 0.6, 1e-9);
  NEAR(sum.dissipated, 0.0, 1e-4);
  OK(mps_fluid_step(t.fluid, 200));
  OK(mps_fluid_get_reaction(t.fluid, TANK_RIGHT, &r));
  NEAR(-r.force[0], 0.5 * 1000.0 * TANK_G * 0.36, 2.0);
  /* the last 600 go, wherever the sorting has put them */
  mps_view id = view_field(t.water, "id");
  int64_t found = 0;
  for (int64_t i = 0; i < n + 600; i++)
    if (*mps_view_i64(&id, i, 0) >= n) ids[found++] = *mps_view_i64(&id, i, 0);
  assert_int_equal(found, 600);
  OK(mps_fluid_begin_step(t.fluid, NAN));
  FAILS(mps_particles_remove(t.water, ids, 600), MPS_ERROR_STATE, "step is open");
  OK(mps_fluid_abandon_step(t.fluid));
  OK(mps_particles_remove(t.water, ids, 600));
  OK(mps_fluid_step(t.fluid, 200));
  OK(mps_fluid_get_reaction(t.fluid, TANK_RIGHT, &r));
  NEAR(-r.force[0], 0.5 * 1000.0 * TANK_G * 0.04, 2.0);
  OK(mps_fluid_rollback(t.fluid, snapshot)); /* all of the first are there yet */
  assert_int_equal(mps_particles_count(t.water), n);
  assert_int_equal(mps_fluid_steps(t.fluid), 20);
  OK(mps_fluid_step(t.fluid, 40));
}

/* ---- a step in parts ------------------------------------------------------------------------- */

/* One solution and the piston's motion given: the same bits as the step in one with a signal. */
TEST(a_step_in_parts_is_the_step) {
  scoped_tank t = tank_make(context, 0.6, 0.3, 0.03, NULL, 2e-3);
  const int64_t n = mps_particles_count(t.water);
  double *whole = malloc(12 * (size_t)n * sizeof *whole), *parts = whole + 4 * n,
         *before = parts + 4 * n;
  scoped_snapshot *snapshot = NULL;
  mps_reaction force[2];
  OK(mps_fluid_snapshot(t.fluid, &snapshot));
  for (int k = 0; k < 40; k++) {
    const double v = 0.01 * sin(0.1 * k);
    OK(mps_fluid_set_boundary_motion(t.fluid, TANK_LEFT, NULL, &v));
    OK(mps_fluid_step(t.fluid, 1));
  }
  copy_state(&t, whole);
  OK(mps_fluid_get_reaction(t.fluid, TANK_LEFT, &force[0]));
  OK(mps_fluid_rollback(t.fluid, snapshot));
  for (int k = 0; k < 40; k++) {
    const double v = 0.01 * sin(0.1 * k), wrong = 1.0;
    copy_state(&t, before);
    if (k == 7) { /* one that is given up leaves no trace */
      mps_reaction kept;
      OK(mps_fluid_get_reaction(t.fluid, TANK_LEFT, &kept));
      OK(mps_fluid_begin_step(t.fluid, NAN));
      OK(mps_fluid_set_boundary_motion(t.fluid, TANK_LEFT, NULL, &wrong));
      OK(mps_fluid_solve_pressure(t.fluid));
      OK(mps_fluid_get_reaction(t.fluid, TANK_LEFT, &force[1]));
      assert_true(force[1].force[0] > kept.force[0] + 100.0);
      OK(mps_fluid_abandon_step(t.fluid));
      OK(mps_fluid_get_reaction(t.fluid, TANK_LEFT, &force[1]));
      assert_memory_equal(&kept, &force[1], sizeof kept);
    }
    OK(mps_fluid_begin_step(t.fluid, NAN));
    OK(mps_fluid_set_boundary_motion(t.fluid, TANK_LEFT, NULL, &v));
    OK(mps_fluid_solve_pressure(t.fluid));
    copy_state(&t, parts);
    assert_memory_equal(before, parts, 4 * (size_t)n * sizeof *before);
    OK(mps_fluid_end_step(t.fluid));
  }
  copy_state(&t, parts);
  OK(mps_fluid_get_reaction(t.fluid, TANK_LEFT, &force[1]));
  assert_memory_equal(whole, parts, 4 * (size_t)n * sizeof *whole);
  assert_memory_equal(&force[0], &force[1], sizeof force[0]);
  free(whole);
}

TEST(parts_of_a_step_have_their_order) {
  scoped_tank t = tank_make(context, 0.6, 0.3, 0.05, NULL, 2e-3);
  const double v = 0.1, at[3] = {0.0, 0.1, 0.0}, far = NAN;
  double p;
  int64_t count;
  mps_snapshot *snapshot = NULL;
  FAILS(mps_fluid_solve_pressure(t.fluid), MPS_ERROR_STATE, "no step is open");
  FAILS(mps_fluid_end_step(t.fluid), MPS_ERROR_STATE, "no step is open");
  FAILS(mps_fluid_abandon_step(t.fluid), MPS_ERROR_STATE, "no step is open");
  REFUSES(mps_fluid_begin_step(t.fluid, 0.0), "dt is 0");
  OK(mps_fluid_begin_step(t.fluid, 1e-3));
  FAILS(mps_fluid_begin_step(t.fluid, NAN), MPS_ERROR_STATE, "step is open");
  FAILS(mps_fluid_step(t.fluid, 1), MPS_ERROR_STATE, "step is open");
  FAILS(mps_fluid_run(t.fluid, 1.0, 1, NULL, NULL), MPS_ERROR_STATE, "open");
  FAILS(mps_fluid_remove_boundary(t.fluid, 0), MPS_ERROR_STATE, "open");
  FAILS(mps_fluid_snapshot(t.fluid, &snapshot), MPS_ERROR_STATE, "open");
  FAILS(mps_fluid_end_step(t.fluid), MPS_ERROR_STATE, "not been solved");
  FAILS(mps_fluid_get_pressure(t.fluid, TANK_LEFT, 1, at, &p), MPS_ERROR_STATE, "not been solved");
  FAILS(mps_fluid_get_boundary_points(t.fluid, TANK_LEFT, 0, &count, NULL, NULL), MPS_ERROR_STATE,
        "not been solved");
  OK(mps_fluid_solve_pressure(t.fluid));
  OK(mps_fluid_get_pressure(t.fluid, TANK_LEFT, 1, at, &p));
  NEAR(p, 1000.0 * TANK_G * 0.2, 1.0);
  OK(mps_fluid_set_boundary_motion(t.fluid, TANK_LEFT, NULL, &v));
  FAILS(mps_fluid_end_step(t.fluid), MPS_ERROR_STATE, "not been solved");
  REFUSES(mps_fluid_set_boundary_motion(t.fluid, TANK_LEFT, NULL, &far), "node 0 of boundary 1");
  REFUSES(mps_fluid_set_boundary_motion(t.fluid, 9, NULL, &v), "number is 9");
  OK(mps_fluid_solve_pressure(t.fluid));
  NEAR(mps_fluid_time(t.fluid), 0.0, 0.0);
  OK(mps_fluid_end_step(t.fluid));
  NEAR(mps_fluid_time(t.fluid), 1e-3, 0.0);
}

typedef struct clock_log {
  double time[256];
  int count;
} clock_log;

static mps_status note_time(void *user, mps_fluid *fluid) {
  clock_log *log = user;
  log->time[log->count++] = mps_fluid_time(fluid);
  return MPS_OK;
}

/* A run that is no whole number of steps: its last 32 are equal, or all of fewer. */
TEST(a_run_ends_with_even_steps) {
  scoped_tank t = tank_make(context, 0.3, 0.15, 0.025, NULL, 2e-3);
  clock_log log = {.count = 0};
  OK(mps_fluid_run(t.fluid, 0.0211, 1, note_time, &log));
  assert_int_equal(log.count, 12);
  for (int k = 1; k < log.count; k++) NEAR(log.time[k] - log.time[k - 1], 0.0211 / 11.0, 1e-15);
  assert_true(mps_fluid_time(t.fluid) == 0.0211);
  log.count = 0;
  OK(mps_fluid_run(t.fluid, 0.0211 + 0.1005, 1, note_time, &log));
  assert_int_equal(log.count, 52);
  for (int k = 1; k < log.count; k++)
    NEAR(log.time[k] - log.time[k - 1], k < 20 ? 2e-3 : (0.1005 - 19 * 2e-3) / 32.0, 1e-15);
}

/* Creation looks at all particles where they are. */
TEST(thousands_are_where_they_are_put) {
  scoped_tank t = tank_make(context, 0.6, 0.4, 0.01, NULL, 1e-3);
  const double at[3] = {0.1, 0.3, 0.5};
  double level[3];
  assert_int_equal(mps_particles_count(t.water), 2400);
  OK(mps_fluid_get_levels(t.fluid, 3, at, level));
  for (int k = 0; k < 3; k++) NEAR(level[k], 0.4, 1e-12);
}

/* Water that flows off the end of its bed is taken out and counted, and its momentum too; a
 * rollback brings it back. */
TEST(water_leaves_by_an_open_side) {
  mps_fluid_boundary_def def = mps_fluid_boundary_defaults();
  def.kind = MPS_BOUNDARY_ROLLER; /* slip */
  scoped_tank t = {NULL, NULL};
  int32_t number = -1;
  USING(particles, mps_particles_create(context, &given, &t.water), .spacing = 0.02);
  tank_fill(t.water, 0.3, 0.2, NULL, NULL);
  OK(mps_fluid_create(context, t.water, NULL, &t.fluid));
  tank_wall(t.fluid, 0.0, 0.0, 0.0, 1.0, NULL);
  tank_wall(t.fluid, 0.0, 0.0, 1.0, 0.0, NULL);
  def.kind = MPS_BOUNDARY_OPEN, def.point[0] = 0.4, def.normal[0] = -1.0;
  OK(mps_fluid_add_boundary(t.fluid, &def, &number));
  assert_int_equal(number, 2);
  const double mass = 1000.0 * 0.02 * 0.02;
  scoped_snapshot *before = NULL;
  mps_reaction r = {.removed = 0};
  double x[96], p[32];
  int64_t count = 0;
  while (r.removed < 40) {
    mps_totals sum;
    if (r.removed < 10) mps_snapshot_destroy(&before);
    if (!before) OK(mps_fluid_snapshot(t.fluid, &before));
    OK(mps_fluid_step(t.fluid, 5));
    OK(mps_fluid_get_reaction(t.fluid, number, &r));
    OK(mps_fluid_get_totals(t.fluid, &sum));
    assert_int_equal(mps_particles_count(t.water) + r.removed, 150);
    NEAR(sum.mass + r.removed_mass, 150.0 * mass, 1e-9);
    assert_true(mps_fluid_time(t.fluid) < 1.0);
    /* removed particles took their momentum along x; the others got the wall's */
    mps_reaction wall;
    OK(mps_fluid_get_reaction(t.fluid, 1, &wall));
    NEAR(sum.linear[0], wall.impulse[0] + r.impulse[0], 0.05 * wall.impulse[0]);
    OK(mps_fluid_get_boundary_points(t.fluid, 0, 32, &count, x, p));
    assert_true(count > 5 && count <= 23);
    for (int64_t k = 0; k < count; k++) assert_true(x[3 * k] < 0.46);
  }
  const int64_t left = mps_particles_count(t.water);
  mps_totals first, again;
  OK(mps_fluid_get_totals(t.fluid, &first));
  const int64_t steps = mps_fluid_steps(t.fluid);
  OK(mps_fluid_rollback(t.fluid, before));
  assert_true(mps_particles_count(t.water) > left);
  OK(mps_fluid_step(t.fluid, steps - mps_fluid_steps(t.fluid)));
  OK(mps_fluid_get_totals(t.fluid, &again));
  assert_memory_equal(&first, &again, sizeof first);
  /* It is no wall, does not move, and becomes a wall again only where no particle is near. */
  REFUSES(mps_fluid_get_boundary_points(t.fluid, number, 0, &count, NULL, NULL), "number is 2");
  def.nodes = x, def.node_count = 1;
  REFUSES(mps_fluid_set_boundary(t.fluid, number, &def),
          "must be 0 where kind is MPS_BOUNDARY_OPEN");
  /* To the last particle but one. */
  def.nodes = NULL, def.node_count = 0, def.point[0] = -1.0;
  OK(mps_fluid_remove_boundary(t.fluid, number));
  def.normal[0] = 1.0, def.point[0] = 10.0;
  OK(mps_fluid_add_boundary(t.fluid, &def, &number));
  OK(mps_fluid_step(t.fluid, 3));
  assert_int_equal(mps_particles_count(t.water), 1);
}
