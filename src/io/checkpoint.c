/* checkpoint.c - all fields of a set in a file, and back, bit for bit.
 *
 * Layout: attributes `format`, `version` and those of header_table at the root; the group `fields`
 * with a dataset [component][particle] of float64 or int64 for each field. Particles are identified
 * by `fields/id`. The caller's own bytes are the dataset `user_data`. Reading first loads and
 * checks the whole file; only then does it change the set. SPDX-License-Identifier: BSD-3-Clause */
#include "checkpoint_private.h"
#include "replace.h"

#include <errno.h>
#include <fcntl.h>
#include <stdio.h>
#include <string.h>
#include <unistd.h>

#define FORMAT_NAME "libmps checkpoint"
#define FORMAT_VERSION 2
#define MAX_FIELDS 4096
#define MAX_COMPONENTS 64
#define NAME_SIZE MPSI_STATE_NAME /* bytes of a field's name, with the terminating zero */

typedef mpsi_checkpoint_header header;
typedef mpsi_reading reading;

static const mpsi_h5_row header_table[] = {{"version", true, 1, offsetof(header, version)},
                                           {"dim", true, 1, offsetof(header, dim)},
                                           {"particles", true, 1, offsetof(header, count)},
                                           {"spacing", false, 1, offsetof(header, spacing)},
                                           {"time", false, 1, offsetof(header, time)},
                                           {"step", true, 1, offsetof(header, step)},
                                           {"dt", false, 1, offsetof(header, dt)}};
#define HEADER_ROWS (sizeof header_table / sizeof *header_table)

static mps_status check_path(mps_context *context, const char *function, const char *path) {
  if (path && path[0]) return MPS_OK;
  return mpsi_fail(context, function, MPS_ERROR_ARGUMENT, "path is %s, must name a file",
                   path ? "empty" : "NULL");
}

static mps_status read_info(mps_context *context, const char *function, const mps_checkpoint *info,
                            mps_checkpoint *out) {
  if (!info) return mpsi_fail(context, function, MPS_ERROR_ARGUMENT, "info is NULL");
  const mps_status status = MPSI_DEF_READ(context, function, mps_checkpoint, info, out);
  if (status == MPS_OK && !memchr(out->user_key, '\0', sizeof out->user_key))
    return mpsi_fail(context, function, MPS_ERROR_ARGUMENT,
                     "user_key is '%.64s...', must be terminated: at most 63 characters",
                     out->user_key);
  return status;
}

/* ---- writing --------------------------------------------------------------------------------- */

/* A component of a field in the file, and in memory so many rows of it. */
typedef struct column {
  hid_t dataset, type, target;
  hsize_t component;
} column;

static bool write_rows(void *user, int64_t first, int64_t rows, const void *values) {
  const column *c = user;
  const hsize_t start[2] = {c->component, (hsize_t)first}, count[2] = {1, (hsize_t)rows};
  const hid_t source = H5Screate_simple(1, count + 1, NULL);
  const bool good = source >= 0 &&
                    H5Sselect_hyperslab(c->target, H5S_SELECT_SET, start, NULL, count, NULL) >= 0 &&
                    H5Dwrite(c->dataset, c->type, source, c->target, H5P_DEFAULT, values) >= 0;
  if (source >= 0) H5Sclose(source);
  return good;
}

static bool write_field(hid_t group, mpsi_row_source *from, int32_t field,
                        const mps_particles_field_info *info) {
  const hsize_t size[2] = {(hsize_t)info->components, (hsize_t)from->particles};
  const hid_t target = H5Screate_simple(2, size, NULL);
  const hid_t type = mpsi_h5_number_type(info->dtype.code == 0);
  const hid_t dataset = mpsi_h5_dataset(group, info->name, type, target);
  column to = {.dataset = dataset, .type = type, .target = target};
  bool good =
      dataset >= 0 && (!info->unit[0] || mpsi_h5_attribute_text(dataset, "unit", info->unit));
  for (int32_t c = 0; good && c < info->components; c++) {
    to.component = (hsize_t)c;
    good = from->column(from, field, c, write_rows, &to);
  }
  if (dataset >= 0) good = H5Dclose(dataset) >= 0 && good;
  if (target >= 0) H5Sclose(target);
  return good;
}

static bool write_fields(hid_t root, mpsi_row_source *from) {
  const hid_t group = H5Gcreate2(root, "fields", H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT);
  bool good = group >= 0;
  for (int32_t k = 0; good && k < mps_particles_field_count(from->set); k++) {
    mps_particles_field_info info;
    good = mps_particles_get_field_info(from->set, k, &info) == MPS_OK &&
           write_field(group, from, k, &info);
  }
  if (group >= 0) H5Gclose(group);
  return good;
}

/* Rows of a set that is here as a whole. */
static mps_status begin_own(mpsi_row_source *source, mps_status status) { return status; }

static bool put_own(mpsi_row_source *source, int32_t field, int32_t component, mpsi_put_rows_fn put,
                    void *user) {
  mps_particles_field_info info;
  mps_view view;
  return mps_particles_get_field_info(source->set, field, &info) == MPS_OK &&
         mps_particles_view(source->set, info.name, &view) == MPS_OK &&
         (view.shape[0] == 0 ||
          put(user, 0, view.shape[0], (const char *)view.data + 8 * component * view.stride[1]));
}

static mpsi_row_source source_of(mps_particles *set) {
  return (mpsi_row_source){
      .set = set, .particles = mps_particles_count(set), .begin = begin_own, .column = put_own};
}

static bool write_user_data(hid_t root, const mps_checkpoint *info) {
  const hsize_t size = (hsize_t)info->user_bytes;
  if (size == 0) return true;
  const hid_t space = H5Screate_simple(1, &size, NULL);
  const hid_t dataset = mpsi_h5_dataset(root, "user_data", H5T_NATIVE_UINT8, space);
  bool good = dataset >= 0 && H5Dwrite(dataset, H5T_NATIVE_UINT8, H5S_ALL, H5S_ALL, H5P_DEFAULT,
                                       info->user_data) >= 0;
  if (dataset >= 0) good = H5Dclose(dataset) >= 0 && good;
  if (space >= 0) H5Sclose(space);
  return good;
}

/* With the state of a solver of the kind `solver`, if that is not NULL. */
static bool write_file(hid_t root, mpsi_row_source *from, const mps_checkpoint *info,
                       const char *solver, const mpsi_values *state) {
  const header h = {.version = FORMAT_VERSION,
                    .dim = mps_particles_dim(from->set),
                    .count = from->particles,
                    .step = info->step,
                    .spacing = mps_particles_spacing(from->set),
                    .time = info->time,
                    .dt = info->dt};
  return mpsi_h5_attribute_text(root, "format", FORMAT_NAME) &&
         mpsi_h5_attribute_text(root, "library", mps_version()) &&
         mpsi_h5_attribute_text(root, "user_key", info->user_key) &&
         mpsi_h5_write_rows(root, header_table, HEADER_ROWS, &h) && write_user_data(root, info) &&
         write_fields(root, from) && (!solver || mpsi_h5_write_state(root, solver, state));
}

/* A checkpoint that is being written, with the caller's `info`. */
typedef struct writing {
  mps_context *context;
  const char *function;
  mps_checkpoint info;
  mpsi_replacement replacement;
} writing;

/* All checks before a byte is written. */
static mps_status open_checkpoint(writing *w, const char *path, const mps_checkpoint *user_info) {
  mps_context *context = w->context;
  const mps_checkpoint *info = &w->info;
  MPSI_TRY(check_path(context, w->function, path));
  MPSI_TRY(read_info(context, w->function, user_info, &w->info));
  if (info->user_bytes > 0 && !info->user_data)
    return mpsi_fail(context, w->function, MPS_ERROR_ARGUMENT,
                     "user_data is NULL, must be given where user_bytes is %lld",
                     (long long)info->user_bytes);
  if (!isfinite(info->time))
    return mpsi_fail(context, w->function, MPS_ERROR_ARGUMENT, "time is %g s, must be finite",
                     info->time);
  if (info->step < 0)
    return mpsi_fail(context, w->function, MPS_ERROR_ARGUMENT, "step is %lld, must be >= 0",
                     (long long)info->step);
  if (!(info->dt >= 0.0 && isfinite(info->dt)))
    return mpsi_fail(context, w->function, MPS_ERROR_ARGUMENT,
                     "dt is %g s, must be finite and >= 0", info->dt);
  MPSI_TRY(mpsi_h5_load(context, w->function));
  return mpsi_replace_begin(context, w->function, path, true, &w->replacement);
}

static mps_status fill_checkpoint(writing *w, mpsi_row_source *from, const char *solver,
                                  const mpsi_values *state) {
  mps_status status = MPS_OK;
  mpsi_h5_file file;
  mpsi_h5_stay stay;
  mpsi_h5_enter(&stay);
  bool good = mpsi_h5_open(&file, w->replacement.fd, w->replacement.part, true) &&
              write_file(file.id, from, &w->info, solver, state);
  good = mpsi_h5_close(&file) && good;
  if (from->status != MPS_OK)
    status = from->status;
  else if (!good || file.error)
    status = mpsi_h5_fail(w->context, w->function, MPS_ERROR_IO, &stay, &file, "write",
                          w->replacement.part);
  mpsi_h5_leave(&stay);
  if (status == MPS_OK) return mpsi_replace_commit(w->context, w->function, &w->replacement);
  mpsi_replace_abandon(w->context, &w->replacement);
  return status;
}

mps_status mpsi_checkpoint_write(mps_particles *particles, const char *path,
                                 const mps_checkpoint *info) {
  if (!particles) return mpsi_null(__func__, "particles");
  writing w = {.context = mpsi_particles_context(particles), .function = __func__};
  mps_status status = mpsi_particles_committed(particles, __func__);
  if (status == MPS_OK) status = open_checkpoint(&w, path, info);
  mpsi_row_source own = source_of(particles);
  return status == MPS_OK ? fill_checkpoint(&w, &own, NULL, NULL) : status;
}

static mps_status open_solver(writing *w, const mpsi_state_of *of, const char *path,
                              const mps_checkpoint *user_info) {
  mps_checkpoint info = mps_checkpoint_defaults();
  MPSI_TRY(MPSI_DEF_READ_OR_DEFAULTS(of->context, w->function, mps_checkpoint, user_info, &info));
  info.struct_size = sizeof info;
  info.time = of->time;
  info.step = of->steps;
  info.dt = of->dt;
  return open_checkpoint(w, path, &info);
}

mps_status mpsi_checkpoint_save_rows(void *user, mpsi_row_source *source) {
  const mpsi_checkpoint_request *q = user;
  writing w = {.context = q->of->context, .function = q->function};
  const mps_status own = open_solver(&w, q->of, q->path, q->info);
  const mps_status status = source->begin(source, own);
  if (status == MPS_OK) return fill_checkpoint(&w, source, q->of->name, q->state);
  if (own == MPS_OK) mpsi_replace_abandon(q->of->context, &w.replacement);
  return status;
}

/* The file is opened before the solver reads edits: an error of the path leaves the solver
 * unchanged. */
mps_status mpsi_checkpoint_save(const mpsi_state_of *of, const char *function, const char *path,
                                const mps_checkpoint *info) {
  mps_snapshot state = {.context = of->context};
  writing w = {.context = of->context, .function = function};
  MPSI_TRY(open_solver(&w, of, path, info));
  mps_status status = mpsi_state_get(of, function, &state);
  mpsi_row_source own = source_of(of->particles);
  if (status == MPS_OK)
    status = fill_checkpoint(&w, &own, of->name, &state.state);
  else
    mpsi_replace_abandon(of->context, &w.replacement);
  mpsi_values_free(of->context, &state.state);
  return status;
}

/* ---- reading: the file into memory ----------------------------------------------------------- */

static mps_status read_header(reading *r) {
  char format[sizeof FORMAT_NAME];
  const hid_t root = r->file.id;
  if (!mpsi_h5_read_text(root, "format", sizeof format, format) || strcmp(format, FORMAT_NAME) != 0)
    return mpsi_checkpoint_malformed(r, "its attribute 'format' is not '" FORMAT_NAME "'");
  mps_status status = mpsi_h5_read_rows(r, root, header_table, 1, &r->header);
  if (status == MPS_OK && r->header.version != FORMAT_VERSION)
    return mpsi_fail(r->context, r->function, MPS_ERROR_UNSUPPORTED,
                     "'%.300s' is a checkpoint of version %lld; this libmps (%s) reads version %d",
                     r->path, (long long)r->header.version, mps_version(), FORMAT_VERSION);
  if (status == MPS_OK)
    status = mpsi_h5_read_rows(r, root, header_table + 1, HEADER_ROWS - 1, &r->header);
  if (status != MPS_OK) return status;
  if (!mpsi_h5_read_text(root, "user_key", sizeof r->user_key, r->user_key))
    return mpsi_checkpoint_malformed(r, "user_key");
  const header *h = &r->header;
  if (!isfinite(h->time) || h->step < 0 || h->step > MPSI_STATE_MOST ||
      !(h->dt >= 0.0 && isfinite(h->dt)))
    return mpsi_checkpoint_malformed(r, "its time, step or dt is out of range");
  return MPS_OK;
}

/* The length of the caller's bytes, and the bytes if `room` is large enough. */
static mps_status stage_user_data(reading *r, const mps_checkpoint *wanted) {
  if (H5Lexists(r->file.id, "user_data", H5P_DEFAULT) <= 0) return MPS_OK;
  const hid_t dataset = H5Dopen2(r->file.id, "user_data", H5P_DEFAULT);
  const hid_t type = dataset < 0 ? -1 : H5Dget_type(dataset);
  const hid_t space = dataset < 0 ? -1 : H5Dget_space(dataset);
  mps_status status = MPS_OK;
  hsize_t size = 0;
  if (type < 0 || space < 0 || H5Sget_simple_extent_ndims(space) != 1 ||
      H5Sget_simple_extent_dims(space, &size, NULL) < 0 || size < 1 || size > INT64_MAX ||
      H5Tget_class(type) != H5T_INTEGER || H5Tget_size(type) != 1)
    status = mpsi_checkpoint_malformed(r, "user_data");
  r->user_bytes = (int64_t)size;
  if (status == MPS_OK && wanted->user_data && wanted->user_bytes < r->user_bytes)
    status = mpsi_fail(r->context, r->function, MPS_ERROR_ARGUMENT,
                       "user_bytes is %lld, '%.200s' has %lld", (long long)wanted->user_bytes,
                       r->path, (long long)r->user_bytes);
  if (status == MPS_OK && wanted->user_data) {
    r->user_data = mpsi_alloc(r->context, r->user_bytes, 1);
    if (!r->user_data)
      status = mpsi_fail_memory(r->context, r->function, size);
    else if (H5Dread(dataset, H5T_NATIVE_UINT8, H5S_ALL, H5S_ALL, H5P_DEFAULT, r->user_data) < 0)
      status = mpsi_checkpoint_malformed(r, "user_data");
  }
  if (space >= 0) H5Sclose(space);
  if (type >= 0) H5Tclose(type);
  if (dataset >= 0) H5Dclose(dataset);
  return status;
}

static mps_status check_key(const reading *r, const char *wanted) {
  if (!wanted[0] || strcmp(wanted, r->user_key) == 0) return MPS_OK;
  return mpsi_fail(r->context, r->function, MPS_ERROR_ARGUMENT,
                   "path: '%.200s' has user_key '%.63s', wanted is '%.63s'", r->path, r->user_key,
                   wanted);
}

/* Is it of this set? */
static mps_status check_set(const reading *r) {
  const header *h = &r->header;
  const int64_t count = mps_particles_count(r->particles);
  const int32_t dim = mps_particles_dim(r->particles);
  const double spacing = mps_particles_spacing(r->particles);
  if (h->dim != dim || h->count < 0 || (h->count != count && !r->any_particles))
    return mpsi_fail(r->context, r->function, MPS_ERROR_ARGUMENT,
                     "path: '%.200s' has %lld particles in %lldD, the set has %lld in %dD", r->path,
                     (long long)h->count, (long long)h->dim, (long long)count, dim);
  if (h->spacing != spacing)
    return mpsi_fail(r->context, r->function, MPS_ERROR_ARGUMENT,
                     "path: '%.200s' has spacing %.17g m, the set has %.17g m", r->path, h->spacing,
                     spacing);
  return MPS_OK;
}

/* Reads an open dataset. */
static mps_status stage_dataset(reading *r, hid_t dataset, hid_t type, hid_t space,
                                mpsi_value *field) {
  hsize_t size[2] = {0, 0};
  const H5T_class_t kind = H5Tget_class(type);
  if (H5Sget_simple_extent_ndims(space) != 2 || H5Sget_simple_extent_dims(space, size, NULL) < 0 ||
      size[0] < 1 || size[0] > MAX_COMPONENTS || size[1] != (hsize_t)r->header.count ||
      H5Tget_size(type) != 8 || (kind != H5T_FLOAT && kind != H5T_INTEGER))
    return mpsi_checkpoint_malformed(r, field->name);
  field->columns = (int32_t)size[0];
  field->type = kind == H5T_INTEGER ? MPSI_STATE_I64 : MPSI_STATE_F64;
  field->rows = r->header.count;
  if (!mpsi_value_reserve(r->context, field, field->type, field->rows, field->columns))
    return mpsi_fail_memory(r->context, r->function, (size_t)(field->columns * field->rows) * 8);
  if (field->rows > 0 && H5Dread(dataset, mpsi_h5_number_type(kind == H5T_INTEGER), H5S_ALL,
                                 H5S_ALL, H5P_DEFAULT, field->data) < 0)
    return mpsi_checkpoint_malformed(r, field->name);
  return MPS_OK;
}

static mps_status stage_field(reading *r, hid_t group, hsize_t index) {
  mpsi_value *field = &r->values.fields.item[r->values.fields.count];
  H5L_info_t link;
  const ssize_t length = H5Lget_name_by_idx(group, ".", H5_INDEX_NAME, H5_ITER_INC, index,
                                            field->name, NAME_SIZE, H5P_DEFAULT);
  if (length < 1 || length >= NAME_SIZE ||
      H5Lget_info(group, field->name, &link, H5P_DEFAULT) < 0 || link.type != H5L_TYPE_HARD)
    return mpsi_checkpoint_malformed(r, "the name of a field");
  r->values.fields.count++;
  const hid_t dataset = H5Dopen2(group, field->name, H5P_DEFAULT);
  const hid_t type = dataset < 0 ? -1 : H5Dget_type(dataset);
  const hid_t space = dataset < 0 ? -1 : H5Dget_space(dataset);
  const mps_status status = type >= 0 && space >= 0 ? stage_dataset(r, dataset, type, space, field)
                                                    : mpsi_checkpoint_malformed(r, field->name);
  if (space >= 0) H5Sclose(space);
  if (type >= 0) H5Tclose(type);
  if (dataset >= 0) H5Dclose(dataset);
  return status;
}

/* Callers' fields have the names of today. */
static mps_status rename_own(reading *r) {
  char name[NAME_SIZE];
  for (int32_t k = 0; k < r->values.fields.count; k++) {
    mpsi_value *field = &r->values.fields.item[k];
    if (!mpsi_field_own_name(field->name, name, sizeof name)) continue;
    if (mpsi_values_find(&r->values.fields, name)) return mpsi_checkpoint_malformed(r, name);
    memcpy(field->name, name, sizeof name);
  }
  return MPS_OK;
}

static mps_status stage_fields(reading *r) {
  H5G_info_t info;
  const hid_t group = H5Gopen2(r->file.id, "fields", H5P_DEFAULT);
  mps_status status = MPS_OK;
  if (group < 0 || H5Gget_info(group, &info) < 0 || info.nlinks > MAX_FIELDS)
    status = mpsi_checkpoint_malformed(r, "group 'fields'");
  if (status == MPS_OK && !mpsi_values_reserve(r->context, &r->values.fields, (int32_t)info.nlinks))
    status = mpsi_fail_memory(r->context, r->function, info.nlinks * sizeof(mpsi_value));
  for (hsize_t k = 0; status == MPS_OK && k < info.nlinks; k++) status = stage_field(r, group, k);
  if (group >= 0) H5Gclose(group);
  return status == MPS_OK ? rename_own(r) : status;
}

/* Opens the file, and reads the header, and the rest if it is for a set. */
static mps_status stage(reading *r, const mps_checkpoint *wanted, const mpsi_state_of *of) {
  const int fd = open(r->path, O_RDONLY | O_NONBLOCK | O_CLOEXEC);
  if (fd < 0) return mpsi_fail_io(r->context, r->function, "open", r->path, errno);
  mps_status status = mpsi_seal_check(r->context, r->function, fd, r->path);
  if (status == MPS_OK) status = mpsi_h5_load(r->context, r->function);
  if (status == MPS_OK) {
    mpsi_h5_enter(&r->stay);
    if (!mpsi_h5_open(&r->file, fd, r->path, false))
      status = mpsi_checkpoint_malformed(r, "it does not open");
    if (status == MPS_OK) status = read_header(r);
    if (status == MPS_OK) status = check_key(r, wanted->user_key);
    if (status == MPS_OK) status = stage_user_data(r, wanted);
    if (status == MPS_OK && r->particles) status = check_set(r);
    if (status == MPS_OK && r->particles) status = stage_fields(r);
    if (status == MPS_OK && of) status = mpsi_h5_read_state(r, of);
    (void)mpsi_h5_close(&r->file);
    mpsi_h5_leave(&r->stay);
  }
  close(fd);
  return status;
}

/* ---- reading: checks ------------------------------------------------------------------------- */

static mps_status match_ids(reading *r) {
  const int64_t count = r->header.count;
  const mpsi_value *id = mpsi_values_find(&r->values.fields, "id");
  if (!id || id->type != MPSI_STATE_I64 || id->columns != 1)
    return mpsi_checkpoint_malformed(r, "it has no ids");
  r->source = mpsi_alloc(r->context, count, sizeof *r->source);
  if (!r->source)
    return mpsi_fail_memory(r->context, r->function, (size_t)count * sizeof *r->source);
  for (int64_t i = 0; i < count; i++) r->source[i] = -1;
  for (int64_t k = 0; k < count; k++) {
    const int64_t value = ((const int64_t *)id->data)[k];
    const int64_t i = mps_particles_index(r->particles, value);
    if (i < 0 || r->source[i] >= 0)
      return mpsi_fail(r->context, r->function, MPS_ERROR_ARGUMENT,
                       "path: '%.200s' has a particle of id %lld, %s", r->path, (long long)value,
                       i < 0 ? "the set has none" : "more than once");
    r->source[i] = k;
  }
  return MPS_OK;
}

static bool find_info(const mps_particles *particles, const char *name,
                      mps_particles_field_info *out) {
  for (int32_t k = 0; k < mps_particles_field_count(particles); k++)
    if (mps_particles_get_field_info(particles, k, out) == MPS_OK && strcmp(out->name, name) == 0)
      return true;
  return false;
}

/* Has each field the shape of the set's, or that of a new one? New ones are tested on `trial`, an
 * empty set. */
static mps_status match_shapes(const reading *r, mps_particles *trial) {
  for (int32_t k = 0; k < r->values.fields.count; k++) {
    const mpsi_value *field = &r->values.fields.item[k];
    const bool integer = field->type == MPSI_STATE_I64;
    mps_particles_field_info info;
    if (!find_info(r->particles, field->name, &info)) {
      const mps_status status =
          mpsi_particles_add_field(trial, r->function, field->name, field->columns);
      if (status == MPS_ERROR_MEMORY) return mpsi_fail_memory(r->context, r->function, 1);
      info.components = 0;
      if (status == MPS_OK && !find_info(trial, field->name, &info)) return MPS_ERROR_INTERNAL;
    }
    if (info.components != field->columns || (info.dtype.code == 0) != integer)
      return mpsi_fail(
          r->context, r->function, MPS_ERROR_FIELD,
          "'%.200s' has field '%s' with %d components of %s, which the set cannot take", r->path,
          field->name, field->columns, integer ? "int64" : "float64");
  }
  return MPS_OK;
}

static mps_status check_shapes(const reading *r) {
  mps_particles_def def = mps_particles_defaults();
  def.dim = mps_particles_dim(r->particles);
  def.spacing = mps_particles_spacing(r->particles);
  mps_particles *trial = NULL;
  mps_status status = mps_particles_create(r->context, &def, &trial);
  if (status != MPS_OK) return mpsi_fail_memory(r->context, r->function, 1);
  status = match_shapes(r, trial);
  mps_particles_destroy(&trial);
  return status;
}

/* ---- reading: into the set ------------------------------------------------------------------- */

static mps_status add_missing(const reading *r) {
  const int32_t before = mps_particles_field_count(r->particles);
  for (int32_t k = 0; k < r->values.fields.count; k++) {
    const mpsi_value *field = &r->values.fields.item[k];
    if (mpsi_particles_add_field(r->particles, r->function, field->name, field->columns) == MPS_OK)
      continue;
    mpsi_particles_drop_fields(r->particles, before);
    return mpsi_fail(r->context, r->function, MPS_ERROR_MEMORY,
                     "could not allocate field '%s' of %lld particles", field->name,
                     (long long)r->header.count);
  }
  return MPS_OK;
}

static void put_field(const reading *r, const mpsi_value *field) {
  if (strcmp(field->name, "id") == 0) return; /* the order of the set stays */
  const int64_t count = mps_particles_count(r->particles);
  for (int32_t c = 0; c < field->columns; c++) {
    void *number = mpsi_particles_column(r->particles, field->name, c);
    if (!number) number = mpsi_particles_integers(r->particles, field->name);
    char *to = number;
    const char *from = (const char *)field->data + 8 * c * count;
    for (int64_t i = 0; to && i < count; i++) memcpy(to + 8 * i, from + 8 * r->source[i], 8);
  }
}

static void report(const reading *r, mps_checkpoint *info) {
  info->time = r->header.time;
  info->step = r->header.step;
  info->dt = r->header.dt;
  memcpy(info->user_key, r->user_key, sizeof info->user_key);
  if (r->user_data) memcpy(info->user_data, r->user_data, (size_t)r->user_bytes);
  info->user_bytes = r->user_bytes;
}

static void drop_reading(reading *r) {
  mpsi_values_free(r->context, &r->values.fields);
  mpsi_values_free(r->context, &r->values.state);
  MPSI_FREE(r->context, r->source, r->user_data);
}

mps_status mps_checkpoint_info(mps_context *context, const char *path, mps_checkpoint *info) {
  if (!context) return mpsi_null(__func__, "context");
  reading r = {.context = context, .function = __func__, .path = path, .file = {.id = -1}};
  mps_checkpoint wanted;
  mps_status status = check_path(context, __func__, path);
  if (status == MPS_OK) status = read_info(context, __func__, info, &wanted);
  if (status == MPS_OK) status = stage(&r, &wanted, NULL);
  if (status == MPS_OK) report(&r, info);
  drop_reading(&r);
  return status;
}

/* Checks everything; nothing has changed yet. */
static mps_status look(reading *r, const mps_checkpoint *info, const mpsi_state_of *of) {
  mps_checkpoint wanted;
  MPSI_TRY(check_path(r->context, r->function, r->path));
  MPSI_TRY(read_info(r->context, r->function, info, &wanted));
  MPSI_TRY(stage(r, &wanted, of));
  if (!r->any_particles) MPSI_TRY(match_ids(r));
  return check_shapes(r);
}

static reading reading_of(mps_particles *particles, const char *function, const char *path) {
  return (reading){.context = mpsi_particles_context(particles),
                   .function = function,
                   .particles = particles,
                   .path = path,
                   .file = {.id = -1}};
}

mps_status mps_checkpoint_read(mps_particles *particles, const char *path, mps_checkpoint *info) {
  if (!particles) return mpsi_null(__func__, "particles");
  reading r = reading_of(particles, __func__, path);
  mps_status status = look(&r, info, NULL);
  if (status == MPS_OK) /* a solver would continue from fields that it has not read */
    status = mpsi_particles_check_hold(particles, __func__, MPSI_USE_MOVE);
  if (status == MPS_OK) status = add_missing(&r);
  if (status == MPS_OK) {
    for (int32_t k = 0; k < r.values.fields.count; k++) put_field(&r, &r.values.fields.item[k]);
    report(&r, info);
  }
  drop_reading(&r);
  return status;
}

mps_status mpsi_checkpoint_restore(const mpsi_state_of *of, const char *function, const char *path,
                                   mps_checkpoint *info) {
  reading r = reading_of(of->particles, function, path);
  r.any_particles = mpsi_state_any_particles(of);
  mps_checkpoint unwanted = mps_checkpoint_defaults();
  if (!info) info = &unwanted;
  mps_status status = look(&r, info, of);
  char source[208];
  snprintf(source, sizeof source, "'%.200s'", path ? path : "");
  r.values.particles = r.header.count;
  if (status == MPS_OK)
    status = mpsi_fail_of(
        of->context, mpsi_state_agree(of, function, &r.values, source, MPS_ERROR_ARGUMENT), "path");
  const char *what = "its values do not fit";
  if (status == MPS_OK && of->fits && !of->fits(of->solver, &r.values, &what))
    status = mpsi_checkpoint_malformed(&r, what);
  if (of->take_share) status = of->take_share(of->solver, function, status, &r.values);
  if (status == MPS_OK)
    status = mpsi_fail_of(
        of->context, mpsi_state_restore_values(of, function, &r.values, source, MPS_ERROR_ARGUMENT),
        "path");
  if (status == MPS_OK) report(&r, info);
  drop_reading(&r);
  return status;
}
