/* test_hdf5_mpm_free_field.c - free-field sides of WLS-MPM: what they need and refuse; their
 * columns go back with a snapshot, go on from a file, and stay where a step is undone, bit for bit;
 * refused memory. SPDX-License-Identifier: BSD-3-Clause */
#include "kit/same.h"
#include "domain_threads.h"
#include "mpm_free_field.h"
#include "pthread_executor.h"
#include "test_allocator.h"
#include "test_fixture.h"

#include <core/internal.h>
#include <io/replace.h>

#include <fcntl.h>
#include <hdf5.h>
#include <unistd.h>

static const char path[] = TEST_TMP "/mpm_free_field.h5";

/* Sand over rock on an absorbing base, shaken. */
static mpm_scene shaken_dry(mps_context *on, int32_t sides) {
  DEF(material_mohr_coulomb, law, .young = field_young(100.0), .poisson = FIELD_NU, .friction = 0.5,
      .cohesion = 500.0);
  MAKE(material, sand, create_mohr_coulomb, on, &law);
  MAKE(signal, signal, create_sine, on, MPS_SIGNAL_QUANTITY_DISPLACEMENT, 4.0, 1.0, 20.0);
  const field_ground of = {.width = 6.0,
                           .height = 8.0,
                           .spacing = 0.5,
                           .vs = 100.0,
                           .rock = 300.0,
                           .below = 2.0,
                           .gravity = 9.81,
                           .sides = sides,
                           .base = MPS_BOUNDARY_ABSORBING,
                           .motion = signal,
                           .law = sand};
  mpm_scene s = field_scene(on, &of);
  return s;
}

/* The same, saturated where `wet`. */
static mpm_scene shaken_ground(mps_context *on, int32_t sides, bool wet) {
  mpm_scene s = shaken_dry(on, sides);
  if (!wet) return s;
  DEF(pore_water, water, .porosity = 0.4, .bulk = 2.2e8, .permeability = 1e-4);
  OK(mps_mpm_add_pore_water(s.mpm, &water));
  return s;
}

static mpm_scene shaken(mps_context *on, int32_t sides) { return shaken_ground(on, sides, false); }

/* The particles' fields, and the forces of the sides, bit for bit. */
static void same(mpm_scene *a, mpm_scene *b) {
  assert_same_by_id(a->particles, b->particles, "");
  for (int32_t k = 0; k < 3; k++) {
    double fa[3], fb[3];
    mpm_scene_force(a, k, fa);
    mpm_scene_force(b, k, fb);
    assert_memory_equal(fa, fb, sizeof fa);
  }
}

static void go_back(bool wet) {
  scoped_mpm_scene x = shaken_ground(context, MPS_BOUNDARY_FREE_FIELD, wet);
  scoped_mpm_scene twin = shaken_ground(context, MPS_BOUNDARY_FREE_FIELD, wet);
  scoped_snapshot *snapshot = NULL;
  OK(mps_mpm_step(x.mpm, 40));
  OK(mps_mpm_step(twin.mpm, 40));
  OK(mps_mpm_snapshot(x.mpm, &snapshot));
  OK(mps_mpm_step(x.mpm, 33));
  OK(mps_mpm_rollback(x.mpm, snapshot));
  same(&x, &twin);
  OK(mps_mpm_step(x.mpm, 100));
  OK(mps_mpm_step(twin.mpm, 100));
  same(&x, &twin);
  double force[3];
  mpm_scene_force(&x, MPS_SIDE_X_LOWER, force);
  assert_true(fabs(force[0]) > 1e4 && fabs(force[1]) > 100.0); /* K0 and the shear of the waves */
}

TEST(goes_back_bit_for_bit) {
  go_back(false);
  go_back(true);
}

static void go_on(bool wet) {
  scoped_mpm_scene whole = shaken_ground(context, MPS_BOUNDARY_FREE_FIELD, wet);
  OK(mps_mpm_step(whole.mpm, 60));
  OK(mps_mpm_save(whole.mpm, path, NULL));
  int32_t threads = 3;
  mps_context_def def = pthread_executor_def(&threads);
  scoped_context *other = NULL;
  assert_int_equal(mps_context_create(&def, &other, NULL, 0), MPS_OK);
  scoped_mpm_scene next = shaken_ground(other, MPS_BOUNDARY_FREE_FIELD, wet);
  OK(mps_mpm_step(next.mpm, 7)); /* where it is does not matter */
  OK(mps_mpm_restore(next.mpm, path, NULL));
  OK(mps_mpm_step(whole.mpm, 100));
  OK(mps_mpm_step(next.mpm, 100));
  same(&whole, &next);
  mpm_scene_end(&next);
  next = shaken_ground(other, MPS_BOUNDARY_ROLLER, wet);
  FAILS_ON(other, mps_mpm_restore(next.mpm, path, NULL), MPS_ERROR_ARGUMENT, "boundary0/kind");
}

TEST(goes_on_from_a_file) {
  go_on(false);
  go_on(true);
}

static void move_one(mpm_scene *s) {
  mps_edit x = mpm_scene_edit(s, "position");
  int64_t k = 0;
  while (*mps_view_f64(&x.view, k, 0) > 0.5 || *mps_view_f64(&x.view, k, 1) < 5.0) k++;
  *mps_edit_f64(&x, k, 1) += 0.01;
  mpm_scene_commit(s, &x);
  mpm_scene_side(s, MPS_SIDE_X_LOWER, MPS_BOUNDARY_FREE_FIELD, 0.0);
}

/* The column of a file was made of ground with a particle between two rows, as after settling, the
 * solver's of ground before that. */
TEST(takes_the_rows_of_a_file) {
  scoped_mpm_scene whole = shaken(context, MPS_BOUNDARY_FREE_FIELD);
  scoped_mpm_scene next = shaken(context, MPS_BOUNDARY_FREE_FIELD);
  move_one(&whole);
  OK(mps_mpm_step(whole.mpm, 60));
  OK(mps_mpm_save(whole.mpm, path, NULL));
  OK(mps_mpm_restore(next.mpm, path, NULL));
  OK(mps_mpm_step(whole.mpm, 100));
  OK(mps_mpm_step(next.mpm, 100));
  same(&whole, &next);
}

/* Writes the first number of a list of integers of the left column in the file, a dataset or an
 * attribute, and seals the file again. */
static void write_number(const char *name, int64_t value) {
  enum { MOST = 1024 };
  static int64_t number[MOST];
  static char data[1 << 22];
  const hid_t file = H5Fopen(path, H5F_ACC_RDWR, H5P_DEFAULT);
  const hid_t group = H5Gopen2(file, "solver/boundary0", H5P_DEFAULT);
  if (H5Aexists(group, name) > 0) {
    const hid_t attribute = H5Aopen(group, name, H5P_DEFAULT);
    assert_true(H5Aget_storage_size(attribute) <= sizeof number);
    assert_true(H5Aread(attribute, H5T_NATIVE_INT64, number) >= 0);
    number[0] = value;
    assert_true(H5Awrite(attribute, H5T_NATIVE_INT64, number) >= 0);
    H5Aclose(attribute);
  } else {
    const hid_t set = H5Dopen2(group, name, H5P_DEFAULT);
    assert_true(H5Dget_storage_size(set) <= sizeof number);
    assert_true(H5Dread(set, H5T_NATIVE_INT64, H5S_ALL, H5S_ALL, H5P_DEFAULT, number) >= 0);
    number[0] = value;
    assert_true(H5Dwrite(set, H5T_NATIVE_INT64, H5S_ALL, H5S_ALL, H5P_DEFAULT, number) >= 0);
    H5Dclose(set);
  }
  H5Gclose(group);
  H5Fclose(file);
  mpsi_replacement again;
  OK(mpsi_replace_begin(context, "test", path, true, &again));
  const int fd = open(path, O_RDONLY);
  const ssize_t size = read(fd, data, sizeof data);
  assert_true(size > 0 && size < (ssize_t)sizeof data);
  assert_int_equal(write(again.fd, data, (size_t)size), size);
  close(fd);
  OK(mpsi_replace_commit(context, "test", &again));
}

/* A sealed file with contents that no run writes: laws that the column has no memory for, or that
 * do not exist; rows that do not exist. */
TEST(columns_of_other_laws_are_refused) {
  static const struct {
    const char *list;
    int64_t value;
  } bad[] = {{"column_laws", 1},    {"column_laws", 2},        {"column_laws", -1},
             {"column_row_of", 99}, {"column_row_of", -1},     {"column_rows", 0},
             {"column_rows", 5},    {"column_rows", INT64_MAX}};
  const field_ground of = {
      .width = 6.0, .height = 8.0, .spacing = 0.5, .vs = 100.0, .sides = MPS_BOUNDARY_FREE_FIELD};
  scoped_mpm_scene s = field_scene(context, &of);
  DEF(material_mohr_coulomb, law, .young = field_young(100.0), .friction = 0.5);
  const double middle[2] = {3.25, 4.25};
  MAKE(material, sand, create_mohr_coulomb, context, &law);
  const int64_t id = mps_particles_nearest(s.particles, middle);
  OK(mps_mpm_set_material(s.mpm, sand, &id, 1));
  for (size_t k = 0; k < sizeof bad / sizeof *bad; k++) {
    OK(mps_mpm_save(s.mpm, path, NULL));
    write_number(bad[k].list, bad[k].value);
    FAILS(mps_mpm_restore(s.mpm, path, NULL), MPS_ERROR_FORMAT, "column");
    OK(mps_mpm_step(s.mpm, 1));
  }
}

/* ---- steps that are undone ------------------------------------------------------------------- */

/* Elastic, with a pressure that rises with the temperature; but in the call `refuse_at`, and where
 * it is not given the places of particles in the ground, it refuses. */
typedef struct fussy {
  int64_t calls, refuse_at;
} fussy;

static mps_status update(void *user, const mps_material_block *b) {
  fussy *of = user;
  if (++of->calls == of->refuse_at) return MPS_ERROR_NUMERIC;
  const double G = FIELD_RHO * 100.0 * 100.0, lambda = 1.5 * G;
  for (int64_t k = 0; k < b->count; k++) {
    const bool placed = b->position[0] && b->position[1] && b->position[0][k] >= 0.0 &&
                        b->position[0][k] <= 6.0 && b->position[1][k] > 0.0;
    if (!placed) return MPS_ERROR_ARGUMENT;
    const double xx = b->gradient[0][k], yy = b->gradient[4][k];
    const double xy = b->gradient[1][k] + b->gradient[3][k];
    b->stress[0][k] += b->dt * (lambda * (xx + yy) + 2.0 * G * xx);
    b->stress[1][k] += b->dt * (lambda * (xx + yy) + 2.0 * G * yy);
    b->stress[2][k] += b->dt * lambda * (xx + yy);
    b->stress[3][k] += b->dt * G * xy;
    for (int c = 0; b->temperature && c < 3; c++)
      b->stress[c][k] -= b->dt * 100.0 * b->temperature[k];
  }
  return MPS_OK;
}

static mpm_scene fussy_scene(fussy *of, mps_signal *signal) {
  DEF(material_user, law, .update = update, .user = of,
      .bulk_modulus = FIELD_RHO * 1e4 * (1.5 + 2.0 / 3.0), .shear_modulus = FIELD_RHO * 1e4);
  MAKE(material, material, create_user, context, &law);
  const field_ground ground = {.width = 6.0,
                               .height = 6.0,
                               .spacing = 0.5,
                               .vs = 100.0,
                               .gravity = 9.81,
                               .sides = MPS_BOUNDARY_FREE_FIELD,
                               .base = MPS_BOUNDARY_HELD,
                               .motion = signal,
                               .law = material,
                               .heated = signal == NULL};
  mpm_scene s = field_scene(context, &ground);
  return s;
}

/* A law refuses at any of its calls of a step, of either column or of the particles: the step is
 * undone, and is made afterwards as if nothing had been. */
TEST(refused_steps_are_undone) {
  MAKE(signal, signal, create_sine, context, MPS_SIGNAL_QUANTITY_DISPLACEMENT, 4.0, 1.0, 20.0);
  fussy plain = {0}, of = {0};
  scoped_mpm_scene twin = fussy_scene(&plain, signal), s = fussy_scene(&of, signal);
  OK(mps_mpm_step(twin.mpm, 21));
  OK(mps_mpm_step(s.mpm, 20));
  const int64_t calls = plain.calls / 21;
  assert_true(calls > 2);
  for (int64_t k = 1; k <= calls; k++) {
    of = (fussy){.refuse_at = k};
    assert_int_equal(mps_mpm_step(s.mpm, 1), MPS_ERROR_NUMERIC);
    assert_int_equal(mps_mpm_steps(s.mpm), 20);
  }
  of = (fussy){0};
  OK(mps_mpm_step(s.mpm, 1));
  const mps_view va = mpm_scene_view(&twin, "velocity"), vb = mpm_scene_view(&s, "velocity");
  for (int64_t k = 0; k < va.shape[0]; k++)
    for (int c = 0; c < 2; c++) assert_true(*mps_view_f64(&va, k, c) == *mps_view_f64(&vb, k, c));
}

/* Ground that is heated as a whole moves as between rollers: its columns have its temperatures. */
TEST(columns_are_heated_with_the_ground) {
  fussy of = {0};
  mpm_scene s[2];
  for (int k = 0; k < 2; k++) {
    s[k] = fussy_scene(&of, NULL);
    if (k == 1)
      for (int32_t side = 0; side < 2; side++)
        mpm_scene_side(&s[k], side, MPS_BOUNDARY_ROLLER, 0.0);
    for (int round = 1; round <= 3; round++) {
      OK(mps_particles_set(s[k].particles, "temperature", 0, 100.0 * round));
      OK(mps_mpm_step(s[k].mpm, 20));
    }
  }
  const mps_view va = mpm_scene_view(&s[0], "velocity"), vb = mpm_scene_view(&s[1], "velocity");
  const mps_view id = mpm_scene_view(&s[0], "id");
  double apart = 0.0, fastest = 0.0;
  for (int64_t k = 0; k < va.shape[0]; k++) {
    const int64_t m = mps_particles_index(s[1].particles, *mps_view_i64(&id, k, 0));
    for (int c = 0; c < 2; c++) {
      apart = fmax(apart, fabs(*mps_view_f64(&va, k, c) - *mps_view_f64(&vb, m, c)));
      fastest = fmax(fastest, fabs(*mps_view_f64(&vb, m, c)));
    }
  }
  print_message("heated ground: %.3g m/s, differs by %.2g m/s\n", fastest, apart);
  assert_true(fastest > 1e-4);
  assert_true(apart < 1e-9 * fastest);
  for (int k = 0; k < 2; k++) mpm_scene_end(&s[k]);
}

/* ---- refusals -------------------------------------------------------------------------------- */

static mps_status set(mpm_scene *s, int32_t side, int32_t kind) {
  return mps_mpm_set_side(s->mpm, side, kind, 0.0);
}

TEST(refuses_by_name) {
  scoped_mpm_scene s = shaken(context, MPS_BOUNDARY_ROLLER);
  MAKE(signal, signal, create_sine, context, MPS_SIGNAL_QUANTITY_DISPLACEMENT, 4.0, 1.0, 20.0);
  REFUSES(set(&s, MPS_SIDE_Y_LOWER, 5), "kind is MPS_BOUNDARY_FREE_FIELD at MPS_SIDE_Y_LOWER");
  DEF(mpm_boundary, def, .kind = MPS_BOUNDARY_FREE_FIELD, .signal[0] = signal);
  REFUSES(mps_mpm_set_boundary(s.mpm, 0, &def), "signal[0] is given");
  REFUSES(set(&s, 0, 8), "kind is 8");
  OK(set(&s, MPS_SIDE_Y_LOWER, MPS_BOUNDARY_FRICTIONAL));
  REFUSES(set(&s, 0, 5), "beside MPS_SIDE_Y_LOWER of kind");
  OK(set(&s, MPS_SIDE_Y_LOWER, MPS_BOUNDARY_HELD));
  OK(set(&s, 0, 5));
  REFUSES(set(&s, MPS_SIDE_Y_LOWER, MPS_BOUNDARY_FRICTIONAL),
          "beside a side of kind MPS_BOUNDARY_FREE_FIELD");
  FAILS(mps_mpm_settle(s.mpm, NULL, NULL), MPS_ERROR_STATE, "settle with MPS_BOUNDARY_ROLLER");
  REFUSES(mps_experimental_mpm_standard(s.mpm, 0.9),
          "MPS_SIDE_X_LOWER is of kind MPS_BOUNDARY_FREE_FIELD");
  REFUSES(mps_experimental_mpm_transfer(s.mpm, MPS_EXPERIMENTAL_TRANSFER_WEIGHT),
          "transfer is MPS_EXPERIMENTAL_TRANSFER_WEIGHT");
  OK(mps_mpm_step(s.mpm, 3)); /* it still works */
  OK(mps_mpm_remove_boundary(s.mpm, 0));
  OK(set(&s, MPS_SIDE_Y_LOWER, MPS_BOUNDARY_FRICTIONAL));
}

static mpm_scene block(int32_t geometry, double width, double from) {
  mpm_scene s = mpm_scene_begin(context, 0.5, 0.0, 0.0, 1e7);
  mpm_scene_box(&s, from, 0.0, width, 4.0);
  USING(mpm, mpm_scene_solve(&s, &given), .cell = 1.0, .geometry = geometry,
        .lower[0] = given.lower[1] = 0.0, .upper[0] = width);
  return s;
}

static int32_t cancel(void *user) { return 1; }

/* Velocities of relaxation are no motion of the ground: the column would keep them. */
TEST(refuses_ground_that_settles) {
  scoped_mpm_scene s = block(MPS_MPM_GEOMETRY_PLANE_STRAIN, 6.0, 0.0);
  const double down[2] = {0.0, -9.81};
  OK(mps_particles_add_field(s.particles, "body_acceleration", 0));
  for (int c = 0; c < 2; c++) OK(mps_particles_set(s.particles, "body_acceleration", c, down[c]));
  mps_context_set_cancel(context, cancel, NULL, NULL);
  FAILS(mps_mpm_settle(s.mpm, NULL, NULL), MPS_ERROR_CANCELLED, "cancel");
  mps_context_set_cancel(context, NULL, NULL, NULL);
  FAILS(set(&s, 0, 5), MPS_ERROR_STATE, "mps_mpm_settle was cancelled");
  OK(mps_mpm_step(s.mpm, 1));
  OK(set(&s, 0, 5));
}

TEST(refuses_ground_without_neighbour) {
  scoped_mpm_scene s = block(MPS_MPM_GEOMETRY_AXISYMMETRIC, 6.0, 0.0);
  REFUSES(set(&s, 1, 5), "with geometry MPS_MPM_GEOMETRY_AXISYMMETRIC");
  mpm_scene_end(&s);
  s = block(MPS_MPM_GEOMETRY_PLANE_STRAIN, 3.0, 0.0);
  REFUSES(set(&s, 1, 5), "3 cells wide");
  mpm_scene_end(&s);
  s = block(MPS_MPM_GEOMETRY_PLANE_STRAIN, 6.0, 2.0);
  REFUSES(set(&s, 0, 5), "have no particles");
  OK(set(&s, 1, 5));
  mpm_scene_end(&s);
  s = block(MPS_MPM_GEOMETRY_PLANE_STRAIN, 6.0, 0.0);
  OK(mps_experimental_mpm_standard(s.mpm, 0.9));
  REFUSES(set(&s, 1, 5), "standard method");
}

/* What a rank has been answered. */
typedef struct answer {
  mps_status made, set, stepped;
  char message[512];
} answer;

/* A body on two ranks: its column would need the particles of both. */
static void ask_on_rank(void *user, team *t, int32_t rank) {
  answer *out = (answer *)user + rank;
  scoped_context *own = team_context(MPS_CONTEXT_EXECUTOR_SERIAL, 1);
  scoped_domain *domain = NULL;
  scoped_particles *particles = NULL;
  scoped_material *material = NULL;
  scoped_mpm *mpm = NULL;
  const mps_domain_def domain_def = team_domain_def(t, rank);
  DEF(particles, set_def, .spacing = 0.5);
  mps_status status = mps_domain_create(own, &domain_def, &domain);
  if (status == MPS_OK) status = mps_particles_create(own, &set_def, &particles);
  if (status == MPS_OK)
    status = mps_particles_fill_box(particles, AT(0.0, 0.0), AT(16.0, 8.0), NULL);
  if (status == MPS_OK) status = mps_particles_set(particles, "density", 0, 1800.0);
  if (status == MPS_OK) status = mps_material_create_linear_elastic(own, 1e7, 0.3, &material);
  DEF(mpm, def, .cell = 1.0, .domain = domain, .lower[0] = def.lower[1] = 0.0, .upper[0] = 16.0);
  if (status == MPS_OK) status = mps_mpm_create(own, particles, material, &def, &mpm);
  out->made = status;
  out->set = mps_mpm_set_side(mpm, 0, MPS_BOUNDARY_FREE_FIELD, 0.0);
  (void)snprintf(out->message, sizeof out->message, "%s", mps_context_error(own)->message);
  out->stepped = mps_mpm_step(mpm, 2);
}

TEST(refused_on_ranks) {
  answer of[2] = {{0}};
  team_compute(2, ask_on_rank, of);
  for (int rank = 0; rank < 2; rank++) {
    assert_int_equal(of[rank].made, MPS_OK);
    assert_int_equal(of[rank].set, MPS_ERROR_ARGUMENT);
    assert_non_null(strstr(of[rank].message, "on several ranks"));
    assert_int_equal(of[rank].stepped, MPS_OK);
  }
}

/* ---- memory ---------------------------------------------------------------------------------- */

static mps_status make(mps_context *own, int what) {
  DEF(particles, set_def, .spacing = 0.5);
  scoped_particles *particles = NULL;
  scoped_material *material = NULL;
  scoped_mpm *mpm = NULL;
  mps_status status = mps_particles_create(own, &set_def, &particles);
  if (status == MPS_OK)
    status = mps_particles_fill_box(particles, AT(0.0, 0.0), AT(4.0, 2.0), NULL);
  if (status == MPS_OK) status = mps_particles_set(particles, "density", 0, 1800.0);
  if (status == MPS_OK) status = mps_material_create_linear_elastic(own, 1e7, 0.3, &material);
  DEF(mpm, def, .cell = 1.0, .lower[0] = def.lower[1] = 0.0, .upper[0] = 4.0);
  if (status == MPS_OK) status = mps_mpm_create(own, particles, material, &def, &mpm);
  if (status == MPS_OK) status = mps_mpm_set_side(mpm, 0, MPS_BOUNDARY_FREE_FIELD, 0.0);
  if (status == MPS_OK) status = mps_mpm_set_side(mpm, 0, MPS_BOUNDARY_FREE_FIELD, 0.0);
  if (status == MPS_OK) status = mps_mpm_step(mpm, 2);
  return status;
}

TEST(refused_memory_leaves_nothing) { test_allocator_sweep(make, 0); }
