/* recorder.c - a series of frames as one VTKHDF file: a temporal UnstructuredGrid (version 2.0 of
 * the format) of one VTK_VERTEX cell a particle.
 *
 * The format calls a piece of the grid a part. Vertex i of every frame is particle i in the order
 * of that moment, so frames of equal numbers of particles share one part: its cells are written
 * once, and a reader without time series (VTK before 9.3) finds a plain grid, the first frame.
 * Another number of particles begins another part.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "xdmf.h"

#include <errno.h>
#include <fcntl.h>
#include <string.h>
#include <unistd.h>

#define MAX_CHUNK_ROWS 16384 /* also the number of rows gathered at once */
#define MIN_CHUNK_ROWS 256
#define VTK_VERTEX 1

/* The datasets of the format: X(symbol, path below /VTKHDF, item, width, rows are). */
#define SERIES_TABLE(X)                                                                            \
  X(POINTS, "Points", F64, 3, PARTICLES)                                                           \
  X(CONNECTIVITY, "Connectivity", I64, 0, PARTICLES)                                               \
  X(OFFSETS, "Offsets", I64, 0, PARTICLES)                                                         \
  X(TYPES, "Types", U8, 0, PARTICLES)                                                              \
  X(NUMBER_OF_POINTS, "NumberOfPoints", I64, 0, STEPS)                                             \
  X(NUMBER_OF_CELLS, "NumberOfCells", I64, 0, STEPS)                                               \
  X(NUMBER_OF_CONNECTIVITY_IDS, "NumberOfConnectivityIds", I64, 0, STEPS)                          \
  X(VALUES, "Steps/Values", F64, 0, STEPS)                                                         \
  X(PART_OFFSETS, "Steps/PartOffsets", I64, 0, STEPS)                                              \
  X(NUMBER_OF_PARTS, "Steps/NumberOfParts", I64, 0, STEPS)                                         \
  X(POINT_OFFSETS, "Steps/PointOffsets", I64, 0, STEPS)                                            \
  X(CELL_OFFSETS, "Steps/CellOffsets", I64, 1, STEPS)                                              \
  X(CONNECTIVITY_ID_OFFSETS, "Steps/ConnectivityIdOffsets", I64, 1, STEPS)

#define SERIES_SYMBOL(symbol, path, item, width, rows) symbol,
typedef enum series_symbol { SERIES_TABLE(SERIES_SYMBOL) SERIES_COUNT } series_symbol;
typedef enum rows_kind { PARTICLES, STEPS } rows_kind;
#define SERIES_ROW(symbol, path, item, width, rows) {path, MPSI_ITEM_##item, width, rows},
static const struct {
  const char *path;
  mpsi_item item;
  int32_t width;
  rows_kind rows;
} series_table[] = {SERIES_TABLE(SERIES_ROW)};

typedef struct recorded_field {
  const char *name, *unit; /* of the set */
  mpsi_item item;
  int32_t width;
  mpsi_series series;
} recorded_field;

/* Present sizes in the file. A frame is undone by returning to the sizes before it. */
typedef struct mark {
  int64_t frames, points, parts, cells;
  int64_t part_points, part_cells; /* of the last part: its points, and the cells before it */
  int64_t xdmf;                    /* bytes of the file beside the series */
} mark;

struct mps_recorder {
  mps_context *context;
  mps_particles *particles;
  mpsi_holder holder;
  char *path;
  mpsi_h5_file file;
  mpsi_xdmf xdmf;
  bool broken; /* a frame could not be written */
  int32_t compression;
  int64_t chunk_rows;    /* of the datasets of points */
  hid_t number_of_steps; /* the attribute */
  mpsi_series series[SERIES_COUNT];
  recorded_field *fields; /* of PointData */
  int32_t field_count;
  mark now, before; /* after the last frame, and before it */
  double last_time;
  void *rows; /* room for MAX_CHUNK_ROWS of the widest field */
};

/* ---- a frame --------------------------------------------------------------------------------- */

static bool append_number(mps_recorder *recorder, series_symbol symbol, int64_t row,
                          int64_t value) {
  return mpsi_series_append(&recorder->series[symbol], row, 1, &value);
}

/* Appends 0, 1, 2, ... */
static bool append_count(mps_recorder *recorder, series_symbol symbol, int64_t first,
                         int64_t rows) {
  int64_t *value = recorder->rows;
  bool good = true;
  for (int64_t done = 0; good && done < rows; done += MAX_CHUNK_ROWS) {
    const int64_t n = rows - done < MAX_CHUNK_ROWS ? rows - done : MAX_CHUNK_ROWS;
    for (int64_t k = 0; k < n; k++) value[k] = done + k;
    good = mpsi_series_append(&recorder->series[symbol], first + done, n, value);
  }
  return good;
}

static bool append_types(mps_recorder *recorder, int64_t first, int64_t rows) {
  bool good = true;
  memset(recorder->rows, VTK_VERTEX, MAX_CHUNK_ROWS);
  for (int64_t done = 0; good && done < rows; done += MAX_CHUNK_ROWS) {
    const int64_t n = rows - done < MAX_CHUNK_ROWS ? rows - done : MAX_CHUNK_ROWS;
    good = mpsi_series_append(&recorder->series[TYPES], first + done, n, recorder->rows);
  }
  return good;
}

/* A part of `count` vertices. */
static bool append_part(mps_recorder *recorder, mark *next, int64_t count) {
  const bool good = append_count(recorder, CONNECTIVITY, next->cells, count) &&
                    append_count(recorder, OFFSETS, next->cells + next->parts, count + 1) &&
                    append_types(recorder, next->cells, count) &&
                    append_number(recorder, NUMBER_OF_POINTS, next->parts, count) &&
                    append_number(recorder, NUMBER_OF_CELLS, next->parts, count) &&
                    append_number(recorder, NUMBER_OF_CONNECTIVITY_IDS, next->parts, count);
  next->part_points = count;
  next->part_cells = next->cells;
  next->cells += count;
  next->parts++;
  return good;
}

/* Appends a field: columns of the set become rows of the file, which may be wider (then zero). */
static bool append_field(mps_recorder *recorder, const mpsi_series *series, const char *name,
                         int64_t first) {
  const int64_t width = series->width > 0 ? series->width : 1;
  mps_view view;
  if (mps_particles_view(recorder->particles, name, &view) != MPS_OK) return false;
  char *row = recorder->rows;
  bool good = mpsi_series_append(series, first, 0, NULL);
  if (view.shape[1] < width) memset(row, 0, (size_t)(MAX_CHUNK_ROWS * width) * 8);
  for (int64_t done = 0; good && done < view.shape[0]; done += MAX_CHUNK_ROWS) {
    const int64_t left = view.shape[0] - done, n = left < MAX_CHUNK_ROWS ? left : MAX_CHUNK_ROWS;
    for (int64_t c = 0; c < view.shape[1]; c++) {
      const char *column = (const char *)view.data + 8 * (done + c * view.stride[1]);
      for (int64_t k = 0; k < n; k++) memcpy(row + 8 * (k * width + c), column + 8 * k, 8);
    }
    good = mpsi_series_append(series, first + done, n, row);
  }
  return good;
}

static bool append_step(mps_recorder *recorder, mark *next, int64_t points, double time) {
  const int64_t step = next->frames++;
  return mpsi_series_append(&recorder->series[VALUES], step, 1, &time) &&
         append_number(recorder, PART_OFFSETS, step, next->parts - 1) &&
         append_number(recorder, NUMBER_OF_PARTS, step, 1) &&
         append_number(recorder, POINT_OFFSETS, step, points) &&
         append_number(recorder, CELL_OFFSETS, step, next->part_cells) &&
         append_number(recorder, CONNECTIVITY_ID_OFFSETS, step, next->part_cells) &&
         H5Awrite(recorder->number_of_steps, H5T_NATIVE_INT64, &next->frames) >= 0;
}

/* Passes all written data to the operating system. */
static bool flush(const mps_recorder *recorder) {
  return H5Fflush(recorder->file.id, H5F_SCOPE_LOCAL) >= 0 && recorder->file.error == 0;
}

static bool append_frame(mps_recorder *recorder, mark *next, double time) {
  const int64_t count = mps_particles_count(recorder->particles), points = next->points;
  bool good = true;
  if (next->parts == 0 || next->part_points != count) good = append_part(recorder, next, count);
  good = good && append_field(recorder, &recorder->series[POINTS], "position", points);
  for (int32_t f = 0; good && f < recorder->field_count; f++)
    good = append_field(recorder, &recorder->fields[f].series, recorder->fields[f].name, points);
  next->points += count;
  /* A compressed chunk that changes moves, and its former place is written over before the file is
   * whole again. So that no such chunk contains a part of a former frame, frames begin with one. */
  if (recorder->compression > 0)
    next->points =
        (next->points + recorder->chunk_rows - 1) / recorder->chunk_rows * recorder->chunk_rows;
  return good && append_step(recorder, next, points, time) && flush(recorder);
}

/* The frame in the XDMF file: rows from `points` on. */
static bool describe_frame(mps_recorder *recorder, mark *next, int64_t points, double time) {
  const int64_t count = mps_particles_count(recorder->particles);
  mpsi_xdmf *x = &recorder->xdmf;
  if (x->fd < 0) return true;
  mpsi_xdmf_begin(x, next->xdmf, time, count);
  if (count > 0) mpsi_xdmf_array(x, NULL, MPSI_ITEM_F64, 3, points, count);
  for (int32_t f = 0; count > 0 && f < recorder->field_count; f++)
    mpsi_xdmf_array(x, recorder->fields[f].name, recorder->fields[f].item,
                    recorder->fields[f].width, points, count);
  next->xdmf = mpsi_xdmf_end(x, count);
  if (x->error) recorder->file.error = x->error;
  return next->xdmf >= 0;
}

mps_status mps_recorder_write(mps_recorder *recorder, double time) {
  if (!recorder) return mpsi_null(__func__, "recorder");
  mps_context *context = recorder->context;
  if (recorder->broken)
    return mpsi_fail(context, __func__, MPS_ERROR_STATE,
                     "'%.300s' accepts no more frames, since one could not be written",
                     recorder->path);
  if (mpsi_particles_ready(recorder->particles, __func__) != MPS_OK) return MPS_ERROR_STATE;
  if (!isfinite(time))
    return mpsi_fail(context, __func__, MPS_ERROR_ARGUMENT, "time is %g s, must be finite", time);
  if (recorder->now.frames > 0 && time < recorder->last_time)
    return mpsi_fail(context, __func__, MPS_ERROR_ARGUMENT,
                     "time is %.17g s, must not be before that of the last frame, %.17g s", time,
                     recorder->last_time);
  const bool again = recorder->now.frames > 0 && time == recorder->last_time;
  const mark before = again ? recorder->before : recorder->now;
  mark next = before;
  mps_status status = MPS_OK;
  mpsi_h5_stay stay;
  mpsi_h5_enter(&stay);
  if (!append_frame(recorder, &next, time) ||
      !describe_frame(recorder, &next, before.points, time)) {
    recorder->broken = true;
    (void)mpsi_h5_close(&recorder->file);
    status = mpsi_h5_fail(context, __func__, MPS_ERROR_IO, &stay, &recorder->file, "write",
                          recorder->path);
  }
  mpsi_h5_leave(&stay);
  if (status != MPS_OK) return status;
  recorder->before = before;
  recorder->now = next;
  recorder->last_time = time;
  return MPS_OK;
}

/* ---- creation: the choice of fields ---------------------------------------------------------- */

/* Finds a field of the set, and its form in the file. */
static bool find_field(const mps_particles *particles, const char *name, recorded_field *out) {
  mps_particles_field_info info;
  for (int32_t k = 0; k < mps_particles_field_count(particles); k++) {
    if (mps_particles_get_field_info(particles, k, &info) != MPS_OK || strcmp(info.name, name) != 0)
      continue;
    /* vectors have three components in VTK */
    const bool vector = info.components == 2 && mps_particles_dim(particles) == 2;
    *out = (recorded_field){.name = info.name,
                            .unit = info.unit,
                            .item = info.dtype.code == 0 ? MPSI_ITEM_I64 : MPSI_ITEM_F64,
                            .width = vector                ? 3
                                     : info.components > 1 ? info.components
                                                           : 0};
    return true;
  }
  return false;
}

static bool already_chosen(const mps_recorder *recorder, const char *name) {
  bool found = strcmp(name, "position") == 0; /* is what Points contains */
  for (int32_t f = 0; !found && f < recorder->field_count; f++)
    found = strcmp(recorder->fields[f].name, name) == 0;
  return found;
}

static bool uses(const void *self, const char *field) { return already_chosen(self, field); }

/* Chooses id, and the fields of the list or all; finds the greatest width. */
static mps_status choose_fields(mps_recorder *recorder, const mps_recorder_def *def,
                                int32_t *widest) {
  static const char *const function = "mps_recorder_create";
  mps_context *context = recorder->context;
  const int64_t all = mps_particles_field_count(recorder->particles);
  const int64_t count = def->fields ? def->field_count : all;
  recorder->fields = mpsi_alloc(context, all, sizeof *recorder->fields);
  if (!recorder->fields)
    return mpsi_fail_memory(context, function, (size_t)all * sizeof *recorder->fields);
  *widest = 3;
  for (int64_t k = -1; k < count; k++) {
    mps_particles_field_info info = {.name = "id"};
    if (k >= 0 && def->fields)
      info.name = def->fields[k];
    else if (k >= 0 &&
             mps_particles_get_field_info(recorder->particles, (int32_t)k, &info) != MPS_OK)
      continue;
    recorded_field field;
    if (!info.name)
      return mpsi_fail(context, function, MPS_ERROR_ARGUMENT, "fields[%lld] is NULL", (long long)k);
    if (!find_field(recorder->particles, info.name, &field))
      return mpsi_fail(context, function, MPS_ERROR_FIELD,
                       "fields[%lld] is '%.60s': the set has no field of that name", (long long)k,
                       info.name);
    if (already_chosen(recorder, info.name)) continue;
    recorder->fields[recorder->field_count++] = field;
    if (field.width > *widest) *widest = field.width;
  }
  return MPS_OK;
}

static mps_status check_def(mps_context *context, const mps_recorder_def *def) {
  static const char *const function = "mps_recorder_create";
  if (!def->path[0])
    return mpsi_fail(context, function, MPS_ERROR_ARGUMENT, "path is empty, must name a file");
  return def->xdmf ? mpsi_xdmf_check(context, function, def->path) : MPS_OK;
}

/* ---- creation: the file ---------------------------------------------------------------------- */

static bool make_attributes(mps_recorder *recorder, hid_t root, hid_t steps) {
  static const int64_t version[2] = {2, 0}, no_steps = 0;
  if (!mpsi_h5_attribute(root, "Version", H5T_NATIVE_INT64, 2, version) ||
      !mpsi_h5_attribute_text(root, "Type", "UnstructuredGrid") ||
      !mpsi_h5_attribute(steps, "NSteps", H5T_NATIVE_INT64, 0, &no_steps))
    return false;
  recorder->number_of_steps = H5Aopen(steps, "NSteps", H5P_DEFAULT);
  return recorder->number_of_steps >= 0;
}

static bool make_datasets(mps_recorder *recorder, hid_t root, hid_t point_data) {
  bool good = true;
  for (int k = 0; good && k < SERIES_COUNT; k++)
    good =
        mpsi_series_create(root, series_table[k].path, series_table[k].item, series_table[k].width,
                           series_table[k].rows == STEPS ? MIN_CHUNK_ROWS : recorder->chunk_rows,
                           k == POINTS ? recorder->compression : 0, &recorder->series[k]);
  for (int32_t f = 0; good && f < recorder->field_count; f++) {
    recorded_field *field = &recorder->fields[f];
    good = mpsi_series_create(point_data, field->name, field->item, field->width,
                              recorder->chunk_rows, recorder->compression, &field->series);
    if (good && field->unit[0])
      good = mpsi_h5_attribute_text(field->series.dataset, "unit", field->unit);
  }
  return good;
}

static bool make_file(mps_recorder *recorder) {
  enum { ROOT, STEPS_GROUP, POINT_DATA, GROUPS = 5 };
  static const char *const path[GROUPS] = {"/VTKHDF", "/VTKHDF/Steps", "/VTKHDF/PointData",
                                           "/VTKHDF/CellData", "/VTKHDF/FieldData"};
  hid_t group[GROUPS];
  bool good = mpsi_h5_open(&recorder->file, recorder->file.fd, recorder->path, true);
  for (int k = 0; k < GROUPS; k++) {
    group[k] = -1;
    if (good)
      group[k] = H5Gcreate2(recorder->file.id, path[k], H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT);
    good = group[k] >= 0;
  }
  good = good && mpsi_h5_attribute_text(recorder->file.id, "library", mps_version()) &&
         make_attributes(recorder, group[ROOT], group[STEPS_GROUP]) &&
         make_datasets(recorder, group[ROOT], group[POINT_DATA]);
  for (int k = 0; k < GROUPS; k++)
    if (group[k] >= 0) H5Gclose(group[k]);
  return good && flush(recorder);
}

static mps_status open_file(mps_recorder *recorder) {
  static const char *const function = "mps_recorder_create";
  mps_context *context = recorder->context;
  MPSI_TRY(mpsi_h5_load(context, function));
  mps_status status = MPS_OK;
  mpsi_h5_stay stay;
  mpsi_h5_enter(&stay);
  unsigned zlib = 0;
  if (recorder->compression > 0 && (H5Zfilter_avail(H5Z_FILTER_DEFLATE) <= 0 ||
                                    H5Zget_filter_info(H5Z_FILTER_DEFLATE, &zlib) < 0 ||
                                    !(zlib & H5Z_FILTER_CONFIG_ENCODE_ENABLED)))
    status = mpsi_fail(context, function, MPS_ERROR_UNSUPPORTED,
                       "compression is %d, but this HDF5 has no zlib: allowed is 0",
                       recorder->compression);
  if (status == MPS_OK) {
    recorder->file.fd = open(recorder->path, O_RDWR | O_CREAT | O_TRUNC | O_CLOEXEC, 0666);
    if (recorder->file.fd < 0)
      status = mpsi_fail_io(context, function, "open", recorder->path, errno);
    else if (!make_file(recorder))
      status = mpsi_h5_fail(context, function, MPS_ERROR_IO, &stay, &recorder->file, "write",
                            recorder->path);
  }
  mpsi_h5_leave(&stay);
  return status;
}

static mps_status build(mps_recorder *recorder, const mps_recorder_def *def) {
  static const char *const function = "mps_recorder_create";
  mps_context *context = recorder->context;
  int32_t widest = 0;
  MPSI_TRY(choose_fields(recorder, def, &widest));
  const size_t length = strlen(def->path) + 1, row = (size_t)widest * 8;
  recorder->path = mpsi_alloc(context, (int64_t)length, 1);
  if (!recorder->path) return mpsi_fail_memory(context, function, length);
  memcpy(recorder->path, def->path, length);
  recorder->rows = mpsi_alloc(context, MAX_CHUNK_ROWS, row);
  if (!recorder->rows) return mpsi_fail_memory(context, function, MAX_CHUNK_ROWS * row);
  MPSI_TRY(open_file(recorder));
  if (def->xdmf) MPSI_TRY(mpsi_xdmf_open(context, function, recorder->path, &recorder->xdmf));
  return MPS_OK;
}

mps_status mps_recorder_create(mps_context *context, mps_particles *particles,
                               const mps_recorder_def *user_def, mps_recorder **out) {
  if (!context) return mpsi_null(__func__, "context");
  if (!out) return mpsi_fail(context, __func__, MPS_ERROR_ARGUMENT, "out is NULL");
  *out = NULL;
  mps_recorder_def def;
  mps_status status = mpsi_particles_check_context(particles, context, __func__);
  if (status == MPS_OK) status = MPSI_DEF_READ(context, __func__, mps_recorder_def, user_def, &def);
  if (status == MPS_OK) status = check_def(context, &def);
  if (status == MPS_OK) status = mpsi_particles_check_hold(particles, __func__, MPSI_USE_LOOK);
  if (status != MPS_OK) return status;
  mps_recorder *recorder = mpsi_alloc(context, 1, sizeof *recorder);
  if (!recorder) return mpsi_fail_memory(context, __func__, sizeof *recorder);
  recorder->context = mpsi_context_retain(context);
  recorder->particles = particles;
  recorder->holder =
      (mpsi_holder){.name = "a recorder", .self = recorder, .kind = MPSI_USE_LOOK, .uses = uses};
  (void)mpsi_particles_hold(particles, __func__, &recorder->holder); /* checked above */
  recorder->compression = def.compression;
  const int64_t count = mps_particles_count(particles);
  recorder->chunk_rows = count < MIN_CHUNK_ROWS ? MIN_CHUNK_ROWS : count;
  if (count > MAX_CHUNK_ROWS) recorder->chunk_rows = MAX_CHUNK_ROWS;
  recorder->file.fd = recorder->xdmf.fd = -1;
  recorder->file.id = recorder->number_of_steps = -1;
  if ((status = build(recorder, &def)) != MPS_OK) {
    mps_recorder_destroy(&recorder);
    return status;
  }
  *out = recorder;
  return MPS_OK;
}

/* ---- the end --------------------------------------------------------------------------------- */

/* Closes the file; the first error is recorded if `function` is given. */
static mps_status close_file(mps_recorder *recorder, const char *function) {
  mps_context *context = function ? recorder->context : NULL;
  mps_status status = MPS_OK;
  mpsi_h5_stay stay;
  mpsi_h5_enter(&stay);
  const bool good = mpsi_h5_close(&recorder->file) && !recorder->broken;
  if (!good || recorder->file.error)
    status = mpsi_h5_fail(context, function, MPS_ERROR_IO, &stay, &recorder->file, "write",
                          recorder->path);
  mpsi_h5_leave(&stay);
  const bool regular = fsync(recorder->file.fd) == 0 || errno == EINVAL; /* else: not on a disk */
  if (!regular && status == MPS_OK)
    status = mpsi_fail_io(context, function, "write", recorder->path, errno);
  if (close(recorder->file.fd) != 0 && status == MPS_OK)
    status = mpsi_fail_io(context, function, "close", recorder->path, errno);
  return status;
}

static mps_status end(mps_recorder **pointer, const char *function) {
  if (!pointer || !*pointer) return MPS_OK;
  mps_recorder *recorder = *pointer;
  mps_context *context = recorder->context;
  *pointer = NULL;
  mps_status status = recorder->file.fd >= 0 ? close_file(recorder, function) : MPS_OK;
  const int closed = recorder->xdmf.fd >= 0 ? close(recorder->xdmf.fd) : 0;
  if (closed != 0 && status == MPS_OK)
    status = mpsi_fail_io(function ? context : NULL, function, "close", recorder->xdmf.path, errno);
  mpsi_particles_release(recorder->particles, &recorder->holder);
  MPSI_FREE(context, recorder->rows, recorder->path, recorder->xdmf.path, recorder->fields,
            recorder);
  mpsi_context_release(context);
  return status;
}

mps_status mps_recorder_close(mps_recorder **recorder) { return end(recorder, __func__); }

void mps_recorder_destroy(mps_recorder **recorder) { (void)end(recorder, NULL); }
