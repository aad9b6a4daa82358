/* mpm_checkpoint.c - the state of the WLS-MPM solver in a checkpoint: the group `solver`, its
 * attributes, the datasets `blocks` and `dashpots`, and a group `body<n>` of attributes for each
 * body. SPDX-License-Identifier: BSD-3-Clause */
#include "checkpoint.h"

#include "mpm/restart.h"

#include <stdio.h>
#include <string.h>

#define SOLVER_NAME "WLS-MPM"

#define INTEGERS(type, member, count)                                                              \
  { #member, true, (count), offsetof(type, member) }
#define NUMBERS(type, member, count)                                                               \
  { #member, false, (count), offsetof(type, member) }

static const mpsi_h5_row solver_rows[] = {
    INTEGERS(mpsi_mpm_record, geometry, 1),      INTEGERS(mpsi_mpm_record, spline, 1),
    INTEGERS(mpsi_mpm_record, scheme, 1),        INTEGERS(mpsi_mpm_record, materials, 1),
    INTEGERS(mpsi_mpm_record, loads, 1),         INTEGERS(mpsi_mpm_record, accelerated, 1),
    INTEGERS(mpsi_mpm_record, kind, MPSI_HOLDS), INTEGERS(mpsi_mpm_record, finds, MPSI_HOLDS),
    NUMBERS(mpsi_mpm_record, found, MPSI_HOLDS), NUMBERS(mpsi_mpm_record, force, MPSI_HOLDS * 3),
    INTEGERS(mpsi_mpm_record, bodies, 1),        INTEGERS(mpsi_mpm_record, low, 3),
    INTEGERS(mpsi_mpm_record, high, 3),          INTEGERS(mpsi_mpm_record, stale, 1),
    NUMBERS(mpsi_mpm_record, cell, 1),           NUMBERS(mpsi_mpm_record, origin, 3),
    NUMBERS(mpsi_mpm_record, speed, 1)};
#define SOLVER_ROWS (sizeof solver_rows / sizeof *solver_rows)

static const mpsi_h5_row body_rows[] = {
    INTEGERS(mpsi_body_record, shape, 1),
    INTEGERS(mpsi_body_record, faces, 1),
    INTEGERS(mpsi_body_record, motion, 1),
    INTEGERS(mpsi_body_record, parts, 1),
    INTEGERS(mpsi_body_record, outside, 1),
    NUMBERS(mpsi_body_record, energy, 3),
    NUMBERS(mpsi_body_record, time, 1),
    NUMBERS(mpsi_body_record, position, 3),
    NUMBERS(mpsi_body_record, rotation, 3),
    NUMBERS(mpsi_body_record, orientation, 9),
    NUMBERS(mpsi_body_record, velocity, 3),
    NUMBERS(mpsi_body_record, spin, 3),
    NUMBERS(mpsi_body_record, angular, 3),
    NUMBERS(mpsi_body_record, load, 6),
    NUMBERS(mpsi_body_record, reaction, MPS_BODY_MAX_PARTS * 13),
    INTEGERS(mpsi_body_record, contacts, MPS_BODY_MAX_PARTS)};
#define BODY_ROWS (sizeof body_rows / sizeof *body_rows)

/* One call. */
typedef struct passage {
  mps_mpm *mpm;
  mpsi_mpm_record *record;
} passage;

static void body_name(int64_t b, char name[16]) { snprintf(name, 16, "body%d", (int)b); }
static void material_name(int64_t k, char name[16]) { snprintf(name, 16, "material%d", (int)k); }

/* ---- writing --------------------------------------------------------------------------------- */

/* A table of integers or numbers; none where it has no rows. */
static bool write_table(hid_t group, const char *name, bool integer, int64_t rows, int columns,
                        const void *from) {
  const hsize_t size[2] = {(hsize_t)rows, (hsize_t)columns};
  const hid_t type = integer ? H5T_NATIVE_INT64 : H5T_NATIVE_DOUBLE;
  if (rows == 0) return true;
  const hid_t space = H5Screate_simple(2, size, NULL);
  const hid_t dataset =
      space < 0 ? -1 : H5Dcreate2(group, name, type, space, H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT);
  bool good = dataset >= 0 && H5Dwrite(dataset, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, from) >= 0;
  if (dataset >= 0) good = H5Dclose(dataset) >= 0 && good;
  if (space >= 0) H5Sclose(space);
  return good;
}

static bool write_body(hid_t solver, int64_t b, const mpsi_body_record *body) {
  char name[16];
  body_name(b, name);
  const hid_t group = H5Gcreate2(solver, name, H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT);
  const bool good = group >= 0 && mpsi_h5_write_rows(group, body_rows, BODY_ROWS, body);
  if (group >= 0) H5Gclose(group);
  return good;
}

static bool write_solver(hid_t root, void *user) {
  const mpsi_mpm_record *record = ((const passage *)user)->record;
  const hid_t group = H5Gcreate2(root, "solver", H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT);
  bool good = group >= 0 && mpsi_h5_attribute_text(group, "name", SOLVER_NAME) &&
              mpsi_h5_write_rows(group, solver_rows, SOLVER_ROWS, record) &&
              write_table(group, "blocks", true, record->blocks, MPSI_BLOCK, record->block) &&
              write_table(group, "dashpots", false, record->dashes, MPSI_DASH, record->dash);
  for (int64_t k = 0; good && k < record->materials; k++) {
    char name[16];
    material_name(k, name);
    good = mpsi_h5_attribute_text(group, name, record->material[k]);
  }
  for (int64_t b = 0; good && b < record->bodies; b++)
    good = write_body(group, b, &record->body[b]);
  if (group >= 0) H5Gclose(group);
  return good;
}

/* Too large for the stack. */
static mpsi_mpm_record *new_record(mps_context *context, const char *function) {
  mpsi_mpm_record *record = mpsi_alloc(context, 1, sizeof *record);
  if (!record) (void)mpsi_fail_memory(context, function, sizeof *record);
  return record;
}

static void drop_record(mps_context *context, mpsi_mpm_record *record) {
  mpsi_free(context, record->block);
  mpsi_free(context, record->dash);
  mpsi_free(context, record);
}

mps_status mps_mpm_save(mps_mpm *mpm, const char *path, const mps_checkpoint *user_info) {
  if (!mpm) return MPS_ERROR_ARGUMENT;
  mps_context *context = mpsi_mpm_context(mpm);
  mps_checkpoint info = mps_checkpoint_defaults();
  mps_status status = MPS_OK;
  if (user_info) status = MPSI_DEF_READ(context, __func__, mps_checkpoint, user_info, &info);
  if (status != MPS_OK) return status;
  info.struct_size = sizeof info;
  info.time = mps_mpm_time(mpm);
  info.step = mps_mpm_steps(mpm);
  info.dt = mps_mpm_dt(mpm);
  const passage p = {mpm, new_record(context, __func__)};
  if (!p.record) return MPS_ERROR_MEMORY;
  status = mpsi_mpm_get_record(mpm, __func__, p.record);
  const mpsi_passenger passenger = {.user = (void *)&p, .write = write_solver};
  if (status == MPS_OK)
    status = mpsi_checkpoint_write(mpsi_mpm_particles(mpm), __func__, path, &info, &passenger);
  drop_record(context, p.record);
  return status;
}

/* ---- reading --------------------------------------------------------------------------------- */

/* A table into memory of its own. */
static mps_status stage_table(mpsi_reading *r, hid_t group, const char *name, bool integer,
                              int columns, int64_t *rows, void **to) {
  if (H5Lexists(group, name, H5P_DEFAULT) <= 0) return MPS_OK; /* without rows */
  const hid_t dataset = H5Dopen2(group, name, H5P_DEFAULT);
  const hid_t type = dataset < 0 ? -1 : H5Dget_type(dataset);
  const hid_t space = dataset < 0 ? -1 : H5Dget_space(dataset);
  hsize_t size[2] = {0, 0};
  mps_status status = MPS_OK;
  if (type < 0 || space < 0 || H5Tget_class(type) != (integer ? H5T_INTEGER : H5T_FLOAT) ||
      H5Sget_simple_extent_ndims(space) != 2 || H5Sget_simple_extent_dims(space, size, NULL) < 0 ||
      size[0] < 1 || size[0] > INT32_MAX || size[1] != (hsize_t)columns)
    status = mpsi_checkpoint_malformed(r, name);
  if (status == MPS_OK) {
    *rows = (int64_t)size[0];
    *to = mpsi_alloc(r->context, *rows * columns, 8);
    if (!*to)
      status = mpsi_fail_memory(r->context, r->function, (size_t)(*rows * columns) * 8);
    else if (H5Dread(dataset, integer ? H5T_NATIVE_INT64 : H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL,
                     H5P_DEFAULT, *to) < 0)
      status = mpsi_checkpoint_malformed(r, name);
  }
  if (space >= 0) H5Sclose(space);
  if (type >= 0) H5Tclose(type);
  if (dataset >= 0) H5Dclose(dataset);
  return status;
}

static mps_status stage_tables(mpsi_reading *r, hid_t group, mpsi_mpm_record *record) {
  void *block = NULL, *dash = NULL;
  mps_status status = stage_table(r, group, "blocks", true, MPSI_BLOCK, &record->blocks, &block);
  if (status == MPS_OK)
    status = stage_table(r, group, "dashpots", false, MPSI_DASH, &record->dashes, &dash);
  record->block = block;
  record->dash = dash;
  return status;
}

static mps_status stage_materials(mpsi_reading *r, hid_t group, mpsi_mpm_record *record) {
  if (record->materials < 1 || record->materials > MPS_MPM_MAX_MATERIALS)
    return mpsi_checkpoint_malformed(r, "solver/materials");
  for (int64_t k = 0; k < record->materials; k++) {
    char name[16];
    material_name(k, name);
    if (!mpsi_h5_read_text(group, name, sizeof record->material[k], record->material[k]))
      return mpsi_checkpoint_malformed(r, name);
  }
  return MPS_OK;
}

static mps_status stage_body(mpsi_reading *r, hid_t solver, int64_t b, mpsi_body_record *body) {
  char name[16];
  body_name(b, name);
  const hid_t group = H5Gopen2(solver, name, H5P_DEFAULT);
  if (group < 0) return mpsi_checkpoint_malformed(r, name);
  const mps_status status = mpsi_h5_read_rows(r, group, body_rows, BODY_ROWS, body);
  H5Gclose(group);
  return status;
}

static mps_status stage_solver(mpsi_reading *r, void *user) {
  mpsi_mpm_record *record = ((const passage *)user)->record;
  char name[sizeof SOLVER_NAME];
  if (H5Lexists(r->file.id, "solver", H5P_DEFAULT) <= 0)
    return mpsi_fail(r->context, r->function, MPS_ERROR_FORMAT,
                     "'%.200s' has the fields of a set but no solver: it was not written by "
                     "mps_mpm_save",
                     r->path);
  const hid_t group = H5Gopen2(r->file.id, "solver", H5P_DEFAULT);
  mps_status status = MPS_OK;
  if (group < 0 || !mpsi_h5_read_text(group, "name", sizeof name, name) ||
      strcmp(name, SOLVER_NAME) != 0)
    status = mpsi_checkpoint_malformed(r, "its solver is not " SOLVER_NAME);
  if (status == MPS_OK) status = mpsi_h5_read_rows(r, group, solver_rows, SOLVER_ROWS, record);
  if (status == MPS_OK && (record->bodies < 0 || record->bodies > MPS_MPM_MAX_BODIES))
    status = mpsi_checkpoint_malformed(r, "solver/bodies");
  if (status == MPS_OK) status = stage_materials(r, group, record);
  if (status == MPS_OK) status = stage_tables(r, group, record);
  for (int64_t b = 0; status == MPS_OK && b < record->bodies; b++)
    status = stage_body(r, group, b, &record->body[b]);
  if (group >= 0) H5Gclose(group);
  return status;
}

static mps_status check_solver(mpsi_reading *r, void *user) {
  const passage *p = user;
  const mps_status status = mpsi_mpm_check_record(p->mpm, r->function, r->path, p->record);
  if (status != MPS_OK) return status;
  const mpsi_staged_field *x = mpsi_checkpoint_field(r, "position");
  const mpsi_staged_field *law = mpsi_checkpoint_field(r, "material");
  if (!x || x->integer ||
      !mpsi_mpm_fits_record(p->mpm, p->record, (const double *)(const void *)x->values,
                            law && law->integer ? (const int64_t *)(const void *)law->values
                                                : NULL))
    return mpsi_checkpoint_malformed(r, "its blocks do not hold its particles");
  return MPS_OK;
}

static mps_status apply_solver(const mpsi_reading *r, void *user) {
  const passage *p = user;
  return mpsi_mpm_set_record(p->mpm, r->function, p->record, r->header.time, r->header.step);
}

mps_status mps_mpm_restore(mps_mpm *mpm, const char *path, mps_checkpoint *info) {
  if (!mpm) return MPS_ERROR_ARGUMENT;
  mps_context *context = mpsi_mpm_context(mpm);
  mps_checkpoint unwanted = mps_checkpoint_defaults();
  passage p = {mpm, new_record(context, __func__)};
  if (!p.record) return MPS_ERROR_MEMORY;
  const mpsi_passenger passenger = {&p, NULL, stage_solver, check_solver, apply_solver};
  const mps_status status = mpsi_checkpoint_read(mpsi_mpm_particles(mpm), __func__, path,
                                                 info ? info : &unwanted, &passenger);
  drop_record(context, p.record);
  return status;
}
