/* test_release.c - callbacks that the library stores are released once, with the last object that
 * has them or when another one takes their place, and never by a call that fails.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "test_fixture.h"

#include "domain_threads.h"

/* `user` is a count of its releases. */
static void count(void *user) { ++*(int *)user; }

static mps_particles *square(void) {
  static const struct {
    const char *name;
    double value;
  } fields[] = {{"density", 2000.0}, {"young", 1e7}, {"poisson", 0.3}};
  mps_particles *set = NULL;
  USING(particles, mps_particles_create(context, &given, &set), .spacing = 0.5);
  OK(mps_particles_fill_box(set, AT(0.0, 0.0), AT(2.0, 2.0), NULL));
  for (size_t k = 0; k < sizeof fields / sizeof *fields; k++)
    OK(mps_particles_set(set, fields[k].name, 0, fields[k].value));
  return set;
}

static mps_mpm *ground(mps_material *law) {
  scoped_particles *set = square();
  mps_mpm *mpm = NULL;
  USING(mpm, mps_mpm_create(context, set, law, &given, &mpm), .cell = 1.0);
  return mpm;
}

/* ---- laws ------------------------------------------------------------------------------------ */

static mps_status stay(void *user, const mps_material_block *block) {
  return *(int *)user == 0 ? MPS_OK : MPS_ERROR_STATE; /* not released yet */
}

TEST(a_law_of_two_solvers_ends_with_the_last) {
  int released = 0;
  DEF(material_user, def, .update = stay, .user = &released, .release = count);
  mps_material *law = NULL;
  REFUSES(mps_material_create_user(context, &def, &law), "wave_modulus");
  assert_int_equal(mps_material_create_user(NULL, &def, &law), MPS_ERROR_ARGUMENT);
  assert_int_equal(released, 0);
  def.wave_modulus = 1e7;
  OK(mps_material_create_user(context, &def, &law));
  mps_mpm *one = ground(law), *two = ground(law);
  mps_material_destroy(&law);
  mps_mpm_destroy(&one);
  assert_int_equal(released, 0);
  OK(mps_mpm_step(two, 1));
  mps_mpm_destroy(&two);
  assert_int_equal(released, 1);
}

static MPS_MATERIAL_UMAT(no_umat) { MPS_MATERIAL_UMAT_UNUSED; }

TEST(a_umat_ends_with_its_law) {
  int released = 0;
  DEF(material_umat, def, .umat = no_umat, .user = &released, .release = count);
  mps_material *law = NULL;
  REFUSES(mps_material_create_umat(context, &def, &law), "wave_modulus");
  assert_int_equal(released, 0);
  def.wave_modulus = 1e7;
  OK(mps_material_create_umat(context, &def, &law));
  mps_mpm *mpm = ground(law);
  mps_material_destroy(&law);
  assert_int_equal(released, 0);
  mps_mpm_destroy(&mpm);
  assert_int_equal(released, 1);
}

/* ---- signals --------------------------------------------------------------------------------- */

static mps_status rest(void *user, double t, double motion[3]) {
  motion[0] = motion[1] = motion[2] = 0.0;
  return MPS_OK;
}

TEST(a_signal_ends_with_the_last_condition_that_has_it) {
  int released = 0;
  int32_t number = -1;
  mps_signal *signal = NULL;
  mps_material *law = NULL;
  REFUSES(mps_signal_create_user(context, MPS_SIGNAL_QUANTITY_DISPLACEMENT, NULL, &released, count,
                                 &signal),
          "fn is NULL");
  assert_int_equal(released, 0);
  OK(mps_signal_create_user(context, MPS_SIGNAL_QUANTITY_DISPLACEMENT, rest, &released, count,
                            &signal));
  OK(mps_material_create_linear_elastic(context, 1e7, 0.3, &law));
  mps_mpm *mpm = ground(law);
  USING(mpm_boundary, mps_mpm_add_boundary(mpm, &given, &number), .kind = MPS_BOUNDARY_DRIVEN, .lower[0] = 0.0, .upper[0] = 2.0, .lower[1] = 0.0, .upper[1] = 0.6, .signal[0] = signal);
  mps_signal_destroy(&signal);
  OK(mps_mpm_step(mpm, 1));
  assert_int_equal(released, 0);
  OK(mps_mpm_remove_boundary(mpm, number));
  assert_int_equal(released, 1);
  mps_mpm_destroy(&mpm);
  mps_material_destroy(&law);
  assert_int_equal(released, 1);
}

/* ---- hooks of a context ---------------------------------------------------------------------- */

static void write_nothing(void *user, int32_t level, const char *message) {
}
static void show_nothing(void *user, const mps_context_progress *progress) {
  assert_int_equal(progress->struct_size, sizeof *progress);
}
static int32_t go_on(void *user) { return *(int *)user; }

static void run_in_order(void *user, int64_t units, mps_context_task_fn task, void *data) {
  if (*(int *)user == 0)
    for (int64_t k = 0; k < units; k++) task(data, k, 0);
}

/* Memory is the last to be released: what it gave is free then. */
static int blocks;
static void *give(void *user, size_t size, size_t alignment) {
  assert_int_equal(*(int *)user, 0);
  blocks++;
  return aligned_alloc(alignment, (size + alignment - 1) / alignment * alignment);
}
static void take(void *user, void *memory) {
  assert_int_equal(*(int *)user, 0);
  blocks--;
  free(memory);
}
static void count_at_the_end(void *user) {
  assert_int_equal(blocks, 0);
  ++*(int *)user;
}

TEST(hooks_end_with_the_last_object_of_their_context) {
  int log = 0, progress = 0, cancel = 0, executor = 0, memory = 0, broken = 1, later = 0;
  DEF(context, def, .log = write_nothing, .log_user = &log, .log_release = count,
      .progress = show_nothing, .progress_user = &progress, .progress_release = count,
      .cancel = go_on, .cancel_user = &cancel, .cancel_release = count, .alloc = give, .free = take,
      .memory_user = &memory);
  mps_context *own = NULL;
  mps_kernel *kernel = NULL;
  def.memory_release = count_at_the_end;
  def.executor = MPS_CONTEXT_EXECUTOR_CALLER, def.threads = 1;
  def.parallel_for = run_in_order, def.parallel_user = &broken, def.parallel_release = count;
  assert_int_equal(mps_context_create(&def, &own, NULL, 0), MPS_ERROR_ARGUMENT);
  assert_int_equal(log + progress + cancel + executor + memory, 0);
  assert_int_equal(broken, 1);
  assert_int_equal(blocks, 0);
  def.parallel_user = &executor;
  assert_int_equal(mps_context_create(&def, &own, NULL, 0), MPS_OK);
  mps_context_set_log(own, write_nothing, &later, count);
  assert_int_equal(log, 1);
  mps_context_set_log(own, NULL, NULL, NULL);
  assert_int_equal(later, 1);
  mps_context_set_progress(own, show_nothing, &later, NULL);
  assert_int_equal(progress, 1);
  mps_context_set_cancel(NULL, go_on, &later, count);
  assert_int_equal(later, 1);
  OK(mps_kernel_create(own, MPS_KERNEL_MPS, 2.0, &kernel));
  mps_context_destroy(&own);
  assert_int_equal(cancel + executor + memory, 0); /* the kernel has the context */
  mps_kernel_destroy(&kernel);
  assert_true(log == 1 && progress == 1 && cancel == 1 && executor == 1 && memory == 1);
  assert_int_equal(later, 1);
}

/* ---- foreign solvers ------------------------------------------------------------------------- */

static mps_status no_matrix(void *user, const mps_linear_matrix *matrix) {
  return MPS_OK;
}
static mps_status no_solution(void *user, const double *b, double tolerance, double *x,
                              mps_linear_result *result) {
  return MPS_OK;
}

/* A linear solver that fails to be set, is replaced, is taken away, and ends with its owner. */
static void try_linear(mps_solver *owner, int32_t equation) {
  int first = 0, second = 0, third = 0;
  DEF(linear_solver, def, .user = &first, .release = count, .matrix = no_matrix);
  REFUSES(mps_solver_set_linear_solver(owner, equation, &def), "NULL");
  assert_int_equal(first, 0);
  def.solve = no_solution;
  OK(mps_solver_set_linear_solver(owner, equation, &def));
  def.user = &second;
  OK(mps_solver_set_linear_solver(owner, equation, &def));
  assert_true(first == 1 && second == 0);
  OK(mps_solver_set_linear_solver(owner, equation, NULL));
  assert_int_equal(second, 1);
  def.user = &third;
  OK(mps_solver_set_linear_solver(owner, equation, &def));
  mps_solver_destroy(&owner);
  assert_true(first == 1 && second == 1 && third == 1);
}

TEST(foreign_solvers_end_when_others_take_their_place) {
  scoped_particles *set = square();
  mps_fluid *fluid = NULL;
  OK(mps_fluid_create(context, set, NULL, &fluid));
  try_linear(mps_fluid_solver(fluid), MPS_LINEAR_EQUATION_PRESSURE);

  scoped_material *law = NULL;
  OK(mps_material_create_linear_elastic(context, 1e7, 0.3, &law));
  mps_mpm *mpm = ground(law);
  USING(pore_water, mps_mpm_add_pore_water(mpm, &given), .porosity = 0.4);
  try_linear(mps_mpm_solver(mpm), MPS_LINEAR_EQUATION_PORE_PRESSURE);

  if (!mps_library_has(MPS_FEATURE_CHOLMOD)) return;
  scoped_particles *solid = square();
  mps_elastic *elastic = NULL;
  OK(mps_elastic_create(context, solid, NULL, &elastic));
  try_linear(mps_elastic_solver(elastic), MPS_LINEAR_EQUATION_STIFFNESS);
}

/* ---- domains --------------------------------------------------------------------------------- */

static team alone;
static int ended;
static void end_transport(void *user) {
  ended++;
}

TEST(a_transport_ends_with_the_last_solver_on_it) {
  team_begin(&alone, 1);
  mps_domain_def def = team_domain_def(&alone, 0);
  mps_domain *domain = NULL;
  mps_fluid *fluid = NULL;
  scoped_particles *set = square();
  def.release = end_transport;
  def.rank = 5;
  REFUSES(mps_domain_create(context, &def, &domain), "rank");
  assert_int_equal(ended, 0);
  def.rank = 0;
  OK(mps_domain_create(context, &def, &domain));
  USING(fluid, mps_fluid_create(context, set, &given, &fluid), .domain = domain);
  mps_domain_destroy(&domain);
  assert_int_equal(ended, 0);
  mps_fluid_destroy(&fluid);
  assert_int_equal(ended, 1);
}
