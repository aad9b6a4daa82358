/* test_hdf5_forged.c - a checkpoint that was changed and sealed again: counters and limbs of exact
 * sums that a run could not have are refused, and whatever integer is forged, a file is refused or
 * the run continues without an overflow (the sanitizers look). SPDX-License-Identifier:
 * BSD-3-Clause
 */
#include "mpm_scene.h"
#include "test_fixture.h"
#include "test_hdf5.h"

#include "io/replace.h"

#include <unistd.h>

#define GOOD "forged_good.h5"
#define FORGED "forged_bent.h5"

/* ---- forging --------------------------------------------------------------------------------- */

static unsigned char *load(const char *name, size_t *size) {
  FILE *file = fopen(name, "rb");
  assert_non_null(file);
  fseek(file, 0, SEEK_END);
  *size = (size_t)ftell(file);
  rewind(file);
  unsigned char *data = malloc(*size);
  assert_int_equal(fread(data, 1, *size, file), *size);
  fclose(file);
  return data;
}

static void store(const char *name, const void *data, size_t size, bool seal) {
  remove(name);
  if (seal) {
    mpsi_replacement replacement;
    OK(mpsi_replace_begin(context, __func__, name, true, &replacement));
    assert_int_equal(write(replacement.fd, data, size), (ssize_t)size);
    OK(mpsi_replace_commit(context, __func__, &replacement));
    return;
  }
  FILE *file = fopen(name, "wb");
  assert_non_null(file);
  assert_int_equal(fwrite(data, 1, size, file), size);
  fclose(file);
}

/* One integer of the solver's attributes and datasets in turn. */
typedef struct forgery {
  int64_t wanted, seen; /* number of the value to change */
  int64_t value;
  char name[128]; /* of what was changed; "" none */
} forgery;

static herr_t forge_attribute(hid_t object, const char *name, const H5A_info_t *info, void *data) {
  forgery *f = data;
  int64_t values[8192];
  (void)info;
  const hid_t attribute = H5Aopen(object, name, H5P_DEFAULT), type = H5Aget_type(attribute);
  const hid_t space = H5Aget_space(attribute);
  const hssize_t count = H5Sget_simple_extent_npoints(space);
  if (H5Tget_class(type) == H5T_INTEGER && H5Tget_size(type) == 8 && count <= 8192) {
    const int64_t places[3] = {0, count / 2, count - 1};
    for (int p = 0; p < (count > 2 ? 3 : 1); p++)
      if (f->seen++ == f->wanted) {
        H5Aread(attribute, H5T_NATIVE_INT64, values);
        values[places[p]] = f->value;
        H5Awrite(attribute, H5T_NATIVE_INT64, values);
        snprintf(f->name, sizeof f->name, "%s[%d]", name, (int)places[p]);
      }
  }
  H5Sclose(space), H5Tclose(type), H5Aclose(attribute);
  return 0;
}

static herr_t forge_dataset(hid_t object, const char *name, void *data) {
  forgery *f = data;
  const hid_t dataset = H5Dopen2(object, name, H5P_DEFAULT), type = H5Dget_type(dataset);
  const hid_t space = H5Dget_space(dataset);
  const hssize_t count = H5Sget_simple_extent_npoints(space);
  if (H5Tget_class(type) == H5T_INTEGER && H5Tget_size(type) == 8) {
    int64_t *values = malloc((size_t)count * sizeof *values);
    const int64_t places[3] = {0, count / 2, count - 1};
    for (int p = 0; p < (count > 2 ? 3 : 1); p++)
      if (f->seen++ == f->wanted) {
        H5Dread(dataset, H5T_NATIVE_INT64, H5S_ALL, H5S_ALL, H5P_DEFAULT, values);
        values[places[p]] = f->value;
        H5Dwrite(dataset, H5T_NATIVE_INT64, H5S_ALL, H5S_ALL, H5P_DEFAULT, values);
        snprintf(f->name, sizeof f->name, "%s[%d]", name, (int)places[p]);
      }
    free(values);
  }
  H5Sclose(space), H5Tclose(type), H5Dclose(dataset);
  return 0;
}

static herr_t forge_group(hid_t object, const char *name, const H5L_info_t *info, void *data) {
  H5O_info_t what;
  if (H5Oget_info_by_name(object, name, &what, H5P_DEFAULT) < 0) return -1;
  if (what.type == H5O_TYPE_DATASET) return forge_dataset(object, name, data);
  if (what.type != H5O_TYPE_GROUP) return 0;
  hsize_t at = 0;
  const hid_t group = H5Gopen2(object, name, H5P_DEFAULT);
  H5Aiterate2(group, H5_INDEX_NAME, H5_ITER_INC, &at, forge_attribute, data);
  at = 0;
  H5Literate(group, H5_INDEX_NAME, H5_ITER_INC, &at, forge_group, data);
  H5Gclose(group);
  return 0;
}

/* Changes value number `wanted` of the checkpoint's solver; false: there are no more. */
static bool forge(int64_t wanted, int64_t value, forgery *f) {
  size_t size;
  unsigned char *data = load(GOOD, &size);
  store(FORGED, data, size - 32, false); /* without the seal */
  free(data);
  *f = (forgery){.wanted = wanted, .value = value};
  const hid_t file = H5Fopen(FORGED, H5F_ACC_RDWR, H5P_DEFAULT);
  assert_true(file >= 0);
  forge_group(file, "solver", NULL, f);
  assert_true(H5Fclose(file) >= 0);
  if (!f->name[0]) return false;
  data = load(FORGED, &size);
  store(FORGED, data, size, true);
  free(data);
  return true;
}

static void drop_files(void) { remove(GOOD), remove(FORGED); }

/* ---- WLS-MPM --------------------------------------------------------------------------------- */

static mpm_scene ground(void) {
  mpm_scene s = mpm_scene_begin(context, 0.1, 0.0, 0.0, 1e6);
  mpm_scene_box(&s, 0.0, 0.0, 0.8, 0.8);
  USING(mpm, mpm_scene_solve(&s, &given), .cell = 0.2, .gravity[1] = -9.81, .lower[0] = 0.0,
        .upper[0] = 0.8, .lower[1] = 0.0);
  mpm_scene_side(&s, MPS_SIDE_Y_LOWER, MPS_BOUNDARY_HELD, 0.0);
  return s;
}

TEST(integers_of_wls_mpm) {
  static const int64_t values[3] = {INT64_MAX, INT64_MIN, INT64_C(1) << 61};
  mpm_scene s = ground();
  mps_checkpoint info = mps_checkpoint_defaults();
  OK(mps_mpm_step(s.mpm, 3));
  OK(mps_mpm_save(s.mpm, GOOD, &info));
  mpm_scene_end(&s);
  int64_t tried = 0, refused = 0, limbs = 0;
  forgery f;
  for (int64_t k = 0; forge(k, values[k % 3], &f); k++, tried++) {
    s = ground();
    info = mps_checkpoint_defaults();
    const mps_status status = mps_mpm_restore(s.mpm, FORGED, &info);
    refused += status != MPS_OK;
    const bool counted = strncmp(f.name, "steps", 5) == 0 || strncmp(f.name, "energies", 8) == 0 ||
                         strncmp(f.name, "all", 3) == 0 || strncmp(f.name, "removed", 7) == 0;
    limbs += counted;
    if (counted && status != MPS_ERROR_FORMAT)
      fail_msg("%s = %lld: status %d", f.name, (long long)values[k % 3], (int)status);
    if (counted)
      assert_non_null(strstr(mps_context_error(context)->message, "beyond what a run can count"));
    if (status == MPS_OK) (void)!mps_mpm_step(s.mpm, 2);
    mpm_scene_end(&s);
  }
  print_message("%d integers forged, %d refused\n", (int)tried, (int)refused);
  assert_true(tried > 20 && limbs > 5);
  drop_files();
}

/* ---- the fluid ------------------------------------------------------------------------------- */

static void make_water(mps_particles **set, mps_fluid **fluid) {
  mps_fluid_def water = mps_fluid_defaults();
  DEF(fluid_boundary, bed, .kind = MPS_BOUNDARY_ROLLER, .normal[1] = 1.0);
  USING(particles, mps_particles_create(context, &given, set), .spacing = 0.05);
  OK(mps_particles_fill_box(*set, AT(0.0, 0.0), AT(1.0, 0.5), NULL));
  OK(mps_fluid_create(context, *set, &water, fluid));
  OK(mps_fluid_add_boundary(*fluid, &bed, NULL));
}

TEST(integers_of_the_fluid) {
  mps_particles *set = NULL;
  mps_fluid *fluid = NULL;
  mps_checkpoint info = mps_checkpoint_defaults();
  make_water(&set, &fluid);
  OK(mps_fluid_step(fluid, 2));
  OK(mps_fluid_save(fluid, GOOD, &info));
  mps_fluid_destroy(&fluid), mps_particles_destroy(&set);
  int64_t tried = 0;
  forgery f;
  for (int64_t k = 0; forge(k, k % 2 ? INT64_MIN : INT64_MAX, &f); k++, tried++) {
    make_water(&set, &fluid);
    info = mps_checkpoint_defaults();
    const mps_status status = mps_fluid_restore(fluid, FORGED, &info);
    if (status == MPS_OK) fail_msg("%s was accepted", f.name);
    mps_fluid_destroy(&fluid), mps_particles_destroy(&set);
  }
  assert_true(tried > 10);
  drop_files();
}
