/* test_hdf5_ranks.c - a checkpoint of several ranks has the particles of one, bit for bit, and rank
 * 0, which writes it, has little more memory than the others for that: theirs come in pieces.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "kit/same.h"
#include "test_common.h"

#include "ranks_memory.h"
#include "test_hdf5.h"

#define MOST_RATIO 1.2 /* of the memory of rank 0 to that of the rank with most of the others */

static mps_status begin_set(mps_context *own, mps_domain *domain, mps_particles **out) {
  DEF(particles, def, .spacing = 1.0);
  mps_status status = domain ? mps_domain_create_particles(domain, &def, out)
                             : mps_particles_create(own, &def, out);
  TRY(mps_particles_fill_box(*out, AT(0.0, 0.0), AT(200.0, 150.0), NULL));
  return status;
}

/* From here on the most that is in use counts. */
static void count_anew(const peak_allocator *allocator) {
  peak_allocator *a = (peak_allocator *)allocator;
  a->most = a->now;
}

/* `user`: path of the file. */
static mps_status save_dynamics(mps_context *own, mps_domain *domain,
                                const peak_allocator *allocator, void *user) {
  DEF(dynamics, def, .domain = domain);
  scoped_particles *set = NULL;
  scoped_dynamics *dynamics = NULL;
  mps_status status = begin_set(own, domain, &set);
  TRY(mps_particles_set(set, "density", 0, 1900.0));
  TRY(mps_particles_set(set, "shear_velocity", 0, 200.0));
  TRY(mps_particles_set(set, "pressure_velocity", 0, 400.0));
  TRY(mps_particles_set(set, "velocity", 0, 0.1));
  TRY(mps_dynamics_create(own, set, &def, &dynamics));
  TRY(mps_dynamics_step(dynamics, 2));
  count_anew(allocator);
  TRY(mps_dynamics_save(dynamics, user, NULL));
  return status;
}

static mps_status save_mpm(mps_context *own, mps_domain *domain, const peak_allocator *allocator,
                           void *user) {
  DEF(mpm, def, .domain = domain, .cell = 2.0, .gravity[1] = -9.81);
  scoped_particles *set = NULL;
  scoped_material *material = NULL;
  scoped_mpm *mpm = NULL;
  mps_status status = begin_set(own, domain, &set);
  TRY(mps_particles_set(set, "density", 0, 1900.0));
  TRY(mps_material_create_linear_elastic(own, 1e7, 0.3, &material));
  TRY(mps_mpm_create(own, set, material, &def, &mpm));
  TRY(mps_mpm_step(mpm, 2));
  count_anew(allocator);
  TRY(mps_mpm_save(mpm, user, NULL));
  return status;
}

/* The set of a file. */
static mps_particles *read_set(mps_context *context, const char *path) {
  mps_checkpoint info = mps_checkpoint_defaults();
  mps_particles *set = NULL;
  OK(begin_set(context, NULL, &set));
  OK(mps_checkpoint_read(set, path, &info));
  return set;
}

static memory_peaks save_on(int32_t size, memory_fn *save, char *path, mps_status expected) {
  memory_peaks p = {.run = save, .user = path};
  team_compute(size, memory_measure, &p);
  for (int32_t r = 0; r < size; r++) assert_int_equal(p.status[r], expected);
  return p;
}

static void compare_files(memory_fn *save) {
  char one[] = "hdf5_ranks_one.h5", four[] = "hdf5_ranks_four.h5";
  save_on(1, save, one, MPS_OK);
  const memory_peaks p = save_on(4, save, four, MPS_OK);
  int64_t others = 0;
  for (int32_t r = 1; r < 4; r++) others = p.most[r] > others ? p.most[r] : others;
  print_message("bytes while it is saved: rank 0 %lld, most of the others %lld: %.3f\n",
                (long long)p.most[0], (long long)others, (double)p.most[0] / (double)others);
  assert_true((double)p.most[0] <= MOST_RATIO * (double)others);
  mps_context *context = test_context(MPS_CONTEXT_EXECUTOR_SERIAL, 1);
  mps_particles *a = read_set(context, one), *b = read_set(context, four);
  assert_same_by_id(a, b, "");
  mps_particles_destroy(&a);
  mps_particles_destroy(&b);
  mps_context_destroy(&context);
  remove(one), remove(four);
}

TEST(test_dynamics) { compare_files(save_dynamics); }

TEST(test_mpm) { compare_files(save_mpm); }

/* A path that will not do, before any particle is sent, and a disk that is full when half of them
 * are written: an error on all ranks, and none waits. */
TEST(test_refused) {
  char nowhere[] = "no/such/folder/hdf5_ranks.h5", file[] = "hdf5_ranks_full.h5";
  save_on(3, save_mpm, nowhere, MPS_ERROR_IO);
  test_disk_limit(1000000);
  save_on(3, save_dynamics, file, MPS_ERROR_IO);
  test_disk_limit(0);
  assert_null(fopen(file, "rb"));
}
