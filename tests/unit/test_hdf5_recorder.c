/* test_hdf5_recorder.c - series of frames: the file against the VTKHDF specification (temporal
 * UnstructuredGrid), read with HDF5 alone; errors, a full disk, compression, two threads. The files
 * vtk-*.vtkhdf that it leaves are read by VTK itself: tests/vtk.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "test_allocator.h"
#include "test_fixture.h"
#include "test_hdf5.h"

#include <core/particles/particles_internal.h>

#include <pthread.h>
#include <sys/stat.h>
#include <unistd.h>

/* ---- sets whose every value is known from id and time ---------------------------------------- */

static double expected(int column, int64_t id, double time) {
  return 1000.0 * column + 0.25 * (double)id + 8.0 * time;
}

typedef struct known_field {
  const char *name;
  int components, width; /* in 2D: in the set, in the file */
  int column;
} known_field;
static const known_field known[] = {{"displacement", 2, 3, 1},
                                    {"pressure", 1, 0, 3},
                                    {"user.four", 4, 4, 4},
                                    {"user.pair", 2, 3, 8}};
#define KNOWN ((int)(sizeof known / sizeof *known))

static void fill(mps_particles *set, double time) {
  mps_edit view;
  mps_view id = view_field(set, "id");
  for (int f = -2; f < KNOWN; f++) {
    const char *name = f == -2 ? "position" : f == -1 ? "group" : known[f].name;
    OK(mps_particles_edit(set, name, &view));
    for (int64_t i = 0; i < view.view.shape[0]; i++)
      for (int64_t c = 0; c < view.view.shape[1]; c++) {
        const int64_t k = *mps_view_i64(&id, i, 0);
        if (f == -1)
          *mps_edit_i64(&view, i, 0) = 7 * k;
        else
          *mps_edit_f64(&view, i, c) = expected((f < 0 ? 20 : known[f].column) + (int)c, k, time);
      }
    OK(mps_particles_commit(set, &view));
  }
}

static void add(mps_particles *set, int64_t count) {
  const double at[3] = {0.0, 0.0, 0.0};
  for (int64_t k = 0; k < count; k++) OK(mps_particles_append(set, 1, at));
}

static mps_particles *make_set_in(mps_context *ctx, int32_t dim, int64_t count) {
  DEF(particles, def, .dim = dim, .spacing = 0.5);
  MAKE_KEPT(particles, set, create, ctx, &def);
  for (int f = 0; f < KNOWN; f++)
    OK(mps_particles_add_field(set, known[f].name, f == 0 ? dim : known[f].components));
  OK(mps_particles_add_field(set, "group", 0));
  add(set, count);
  return set;
}

static mps_particles *make_set(int64_t count) { return make_set_in(context, 2, count); }

static mps_recorder *record(mps_particles *set, const char *path, int32_t compression) {
  DEF(recorder, def, .path = path, .compression = compression, .xdmf = 1);
  MAKE_KEPT(recorder, recorder, create, context, set, &def);
  return recorder;
}

static void frame(mps_recorder *recorder, mps_particles *set, double time) {
  fill(set, time);
  OK(mps_recorder_write(recorder, time));
}

/* ---- reading by the specification ------------------------------------------------------------ */

static int64_t read_rows(hid_t file, const char *path, hid_t type, int rank, int64_t width,
                         int64_t first, int64_t rows, void *out) {
  const hid_t dataset = H5Dopen2(file, path, H5P_DEFAULT);
  assert_true(dataset >= 0);
  const hid_t space = H5Dget_space(dataset);
  hsize_t size[2] = {0, 1};
  assert_int_equal(H5Sget_simple_extent_ndims(space), rank);
  H5Sget_simple_extent_dims(space, size, NULL);
  if (rank == 2) assert_int_equal(size[1], width);
  if (rows > 0) {
    const hsize_t start[2] = {(hsize_t)first, 0}, count[2] = {(hsize_t)rows, (hsize_t)width};
    assert_true(first + rows <= (int64_t)size[0]);
    const hid_t memory = H5Screate_simple(rank, count, NULL);
    H5Sselect_hyperslab(space, H5S_SELECT_SET, start, NULL, count, NULL);
    assert_true(H5Dread(dataset, type, memory, space, H5P_DEFAULT, out) >= 0);
    H5Sclose(memory);
  }
  H5Sclose(space);
  H5Dclose(dataset);
  return (int64_t)size[0];
}

static int64_t read_i64(hid_t file, const char *path, int rank, int64_t row) {
  int64_t value = -1;
  read_rows(file, path, H5T_NATIVE_INT64, rank, 1, row, 1, &value);
  return value;
}

static int64_t read_steps(hid_t file) {
  int64_t steps = -1;
  const hid_t attribute = H5Aopen_by_name(file, "VTKHDF/Steps", "NSteps", H5P_DEFAULT, H5P_DEFAULT);
  assert_true(attribute >= 0);
  assert_true(H5Aread(attribute, H5T_NATIVE_INT64, &steps) >= 0);
  H5Aclose(attribute);
  return steps;
}

static void check_root(hid_t file) {
  int64_t version[2] = {0, 0};
  hid_t attribute = H5Aopen_by_name(file, "VTKHDF", "Version", H5P_DEFAULT, H5P_DEFAULT);
  assert_true(H5Aread(attribute, H5T_NATIVE_INT64, version) >= 0);
  H5Aclose(attribute);
  assert_int_equal(version[0], 2);
  attribute = H5Aopen_by_name(file, "VTKHDF", "Type", H5P_DEFAULT, H5P_DEFAULT);
  char text[17] = "";
  const hid_t type = H5Aget_type(attribute);
  assert_int_equal(H5Tget_size(type), 16);
  assert_true(H5Aread(attribute, type, text) >= 0);
  assert_string_equal(text, "UnstructuredGrid");
  H5Tclose(type);
  H5Aclose(attribute);
}

/* One vertex cell for each of the `n` points of the part of this step. */
static void check_cells(hid_t file, int64_t step, int64_t part, int64_t n) {
  assert_int_equal(read_i64(file, "VTKHDF/NumberOfCells", 1, part), n);
  assert_int_equal(read_i64(file, "VTKHDF/NumberOfConnectivityIds", 1, part), n);
  const int64_t cell = read_i64(file, "VTKHDF/Steps/CellOffsets", 2, step);
  const int64_t id = read_i64(file, "VTKHDF/Steps/ConnectivityIdOffsets", 2, step);
  int64_t *number = malloc((size_t)(n + 1) * sizeof *number);
  unsigned char *type = malloc((size_t)n + 1);
  /* each part has one offset more than cells */
  read_rows(file, "VTKHDF/Offsets", H5T_NATIVE_INT64, 1, 1, cell + part, n + 1, number);
  for (int64_t k = 0; k <= n; k++) assert_int_equal(number[k], k);
  read_rows(file, "VTKHDF/Connectivity", H5T_NATIVE_INT64, 1, 1, id, n, number);
  read_rows(file, "VTKHDF/Types", H5T_NATIVE_UINT8, 1, 1, cell, n, type);
  for (int64_t k = 0; k < n; k++) {
    assert_int_equal(number[k], k);
    assert_int_equal(type[k], 1); /* VTK_VERTEX */
  }
  free(type);
  free(number);
}

static void check_values(hid_t file, const char *path, int column, int components, int width,
                         int64_t first, int64_t n, const int64_t *id, double time) {
  const int items = width > 0 ? width : 1;
  double *value = malloc((size_t)(n * items + 1) * sizeof *value);
  read_rows(file, path, H5T_NATIVE_DOUBLE, width > 0 ? 2 : 1, items, first, n, value);
  for (int64_t k = 0; k < n; k++)
    for (int c = 0; c < items; c++) {
      const double want = c < components ? expected(column + c, id[k], time) : 0.0;
      if (value[k * items + c] != want)
        fail_msg("%s at %g s, particle %lld: %g, not %g", path, time, (long long)id[k],
                 value[k * items + c], want);
    }
  free(value);
}

static void check_step(hid_t file, int64_t step, double time, int64_t n) {
  double value = -1.0;
  read_rows(file, "VTKHDF/Steps/Values", H5T_NATIVE_DOUBLE, 1, 1, step, 1, &value);
  assert_true(value == time);
  assert_int_equal(read_i64(file, "VTKHDF/Steps/NumberOfParts", 1, step), 1);
  const int64_t part = read_i64(file, "VTKHDF/Steps/PartOffsets", 1, step);
  const int64_t first = read_i64(file, "VTKHDF/Steps/PointOffsets", 1, step);
  assert_int_equal(read_i64(file, "VTKHDF/NumberOfPoints", 1, part), n);
  check_cells(file, step, part, n);
  int64_t *id = malloc((size_t)(n + 1) * sizeof *id), *group = malloc((size_t)(n + 1) * sizeof *id);
  read_rows(file, "VTKHDF/PointData/id", H5T_NATIVE_INT64, 1, 1, first, n, id);
  read_rows(file, "VTKHDF/PointData/group", H5T_NATIVE_INT64, 1, 1, first, n, group);
  for (int64_t k = 0; k < n; k++) assert_int_equal(group[k], 7 * id[k]);
  check_values(file, "VTKHDF/Points", 20, 2, 3, first, n, id, time);
  for (int f = 0; f < KNOWN; f++) {
    char path[80];
    snprintf(path, sizeof path, "VTKHDF/PointData/%s", known[f].name);
    check_values(file, path, known[f].column, known[f].components, known[f].width, first, n, id,
                 time);
  }
  free(group);
  free(id);
}

static hid_t open_series(const char *path, int64_t steps) {
  const hid_t file = H5Fopen(path, H5F_ACC_RDONLY, H5P_DEFAULT);
  assert_true(file >= 0);
  check_root(file);
  assert_int_equal(read_steps(file), steps);
  return file;
}

/* ---- tests ----------------------------------------------------------------------------------- */

TEST(a_series_is_a_temporal_unstructured_grid) {
  static const char path[] = TEST_TMP "/vtk-series.vtkhdf";
  static const int64_t count[] = {5, 5, 5, 8, 8, 0};
  static const int64_t order[] = {3, 0, 4, 1, 2};
  scoped_particles *set = make_set(5);
  mps_recorder *recorder = record(set, path, 0);
  frame(recorder, set, 0.0);
  OK(mpsi_particles_permute(set, __func__, order));
  frame(recorder, set, 0.5);
  frame(recorder, set, 2.0);
  add(set, 3);
  frame(recorder, set, 2.5);
  frame(recorder, set, 4.0);
  OK(mps_recorder_close(&recorder));
  assert_null(recorder);
  const double time[] = {0.0, 0.5, 2.0, 2.5, 4.0};
  const hid_t file = open_series(path, 5);
  for (int64_t s = 0; s < 5; s++) check_step(file, s, time[s], count[s]);
  /* equal numbers of particles share their cells */
  assert_int_equal(read_rows(file, "VTKHDF/NumberOfPoints", -1, 1, 1, 0, 0, NULL), 2);
  assert_int_equal(read_rows(file, "VTKHDF/Connectivity", -1, 1, 1, 0, 0, NULL), 13);
  H5Fclose(file);
}

TEST(a_single_frame_and_an_empty_one) {
  static const char path[] = TEST_TMP "/vtk-single.vtkhdf", none[] = TEST_TMP "/vtk-empty.vtkhdf";
  scoped_particles *set = make_set(6), *empty = make_set(0);
  mps_recorder *recorder = record(set, path, 0), *other = record(empty, none, 0);
  frame(recorder, set, 1.5);
  frame(other, empty, 0.0);
  add(empty, 2);
  frame(other, empty, 1.0);
  mps_recorder_destroy(&recorder);
  mps_recorder_destroy(&recorder);
  mps_recorder_destroy(&other);
  hid_t file = open_series(path, 1);
  check_step(file, 0, 1.5, 6);
  H5Fclose(file);
  file = open_series(none, 2);
  check_step(file, 0, 0.0, 0);
  check_step(file, 1, 1.0, 2);
  H5Fclose(file);
}

/* Compressed frames begin with a chunk: there are rows between them that belong to none. */
TEST(compressed_frames_are_apart) {
  static const char path[] = TEST_TMP "/vtk-moving.vtkhdf";
  scoped_particles *set = make_set(10);
  mps_recorder *recorder = record(set, path, 9);
  add(set, 290);
  for (int k = 0; k < 4; k++) frame(recorder, set, 0.5 * k);
  OK(mps_recorder_close(&recorder));
  const hid_t file = open_series(path, 4);
  for (int k = 0; k < 4; k++) {
    assert_int_equal(read_i64(file, "VTKHDF/Steps/PointOffsets", 1, k), 512 * k);
    check_step(file, k, 0.5 * k, 300);
  }
  H5Fclose(file);
}

TEST(many_particles_go_in_blocks_and_compressed) {
  static const char path[] = TEST_TMP "/recorder-large.vtkhdf";
  const int64_t count = 40000; /* 2.4 blocks */
  struct stat plain, compressed;
  for (int level = 0; level < 10; level += 6) {
    scoped_particles *set = make_set(0);
    double *at = calloc((size_t)count * 2, sizeof *at);
    OK(mps_particles_append(set, count, at));
    free(at);
    mps_recorder *recorder = record(set, path, level);
    frame(recorder, set, 0.0);
    frame(recorder, set, 1.0);
    OK(mps_recorder_close(&recorder));
    assert_int_equal(stat(path, level ? &compressed : &plain), 0);
    const hid_t file = open_series(path, 2);
    check_step(file, 0, 0.0, count);
    check_step(file, 1, 1.0, count);
    H5Fclose(file);
  }
  assert_true(compressed.st_size < plain.st_size / 2);
}

TEST(in_three_dimensions_nothing_is_padded) {
  static const char path[] = TEST_TMP "/recorder-3d.vtkhdf";
  scoped_particles *set = make_set_in(context, 3, 4);
  mps_recorder *recorder = record(set, path, 0);
  frame(recorder, set, 3.0);
  OK(mps_recorder_close(&recorder));
  const hid_t file = open_series(path, 1);
  const int64_t id[] = {0, 1, 2, 3};
  check_values(file, "VTKHDF/Points", 20, 3, 3, 0, 4, id, 3.0);
  check_values(file, "VTKHDF/PointData/displacement", 1, 3, 3, 0, 4, id, 3.0);
  check_values(file, "VTKHDF/PointData/user.pair", 8, 2, 2, 0, 4, id, 3.0);
  H5Fclose(file);
}

TEST(the_same_time_again_replaces_the_frame) {
  static const char path[] = TEST_TMP "/recorder-again.vtkhdf";
  scoped_particles *set = make_set(3);
  mps_recorder *recorder = record(set, path, 0);
  frame(recorder, set, 1.0);
  frame(recorder, set, 1.0); /* the first */
  frame(recorder, set, 2.0);
  add(set, 1);
  frame(recorder, set, 2.0); /* with another number of particles */
  fill(set, 64.0);
  OK(mps_recorder_write(recorder, 3.0));
  frame(recorder, set, 3.0);
  OK(mps_recorder_close(&recorder));
  const hid_t file = open_series(path, 3);
  check_step(file, 0, 1.0, 3);
  check_step(file, 1, 2.0, 4);
  check_step(file, 2, 3.0, 4);
  assert_int_equal(read_rows(file, "VTKHDF/Points", -1, 2, 3, 0, 0, NULL), 11);
  H5Fclose(file);
}

TEST(only_the_fields_of_the_list_are_written) {
  static const char path[] = TEST_TMP "/recorder-list.vtkhdf";
  static const char *const list[] = {"pressure", "id", "position", "pressure"};
  scoped_particles *set = make_set(3);
  DEF(recorder, def, .path = path);
  mps_recorder *recorder = NULL;
  for (int count = 0; count < 5; count += 4) {
    def.fields = list;
    def.field_count = count;
    OK(mps_recorder_create(context, set, &def, &recorder));
    OK(mps_recorder_write(recorder, 0.0));
    OK(mps_recorder_close(&recorder));
    const hid_t file = open_series(path, 1),
                group = H5Gopen2(file, "VTKHDF/PointData", H5P_DEFAULT);
    H5G_info_t info;
    H5Gget_info(group, &info);
    assert_int_equal(info.nlinks, count ? 2 : 1);
    assert_true(H5Lexists(group, "id", H5P_DEFAULT) > 0);
    assert_int_equal(H5Lexists(group, "pressure", H5P_DEFAULT) > 0, count > 0);
    H5Gclose(group);
    H5Fclose(file);
  }
}

/* How often a text stands in a file, which must end with `end`. */
static int occurrences(const char *path, const char *text, const char *end) {
  static char all[1 << 16];
  FILE *file = fopen(path, "r");
  assert_non_null(file);
  const size_t size = fread(all, 1, sizeof all - 1, file);
  fclose(file);
  all[size] = '\0';
  assert_true(size > strlen(end) && strcmp(all + size - strlen(end), end) == 0);
  int count = 0;
  for (const char *at = all; (at = strstr(at, text)) != NULL; at++) count++;
  return count;
}

/* After each frame the text beside the series is whole; a frame at the same time is replaced, a
 * shorter one too, and one without particles is left out. tests/vtk compares what it names with the
 * values. */
TEST(the_fields_of_a_recorder_stay) {
  static const char path[] = TEST_TMP "/recorder-stay.vtkhdf";
  const char *const fields[] = {"pressure"};
  scoped_particles *set = make_set(4);
  DEF(recorder, def, .path = path, .fields = fields, .field_count = 1);
  mps_recorder *recorder = NULL;
  OK(mps_recorder_create(context, set, &def, &recorder));
  FAILS(mps_particles_remove_field(set, "pressure"), MPS_ERROR_STATE, "is used by a recorder");
  OK(mps_particles_remove_field(set, "user.four"));
  OK(mps_particles_remove_field(set, "displacement"));
  OK(mps_recorder_write(recorder, 0.0));
  OK(mps_recorder_close(&recorder));
  OK(mps_particles_remove_field(set, "pressure"));
}

TEST(the_text_beside_it_is_whole_after_each_frame) {
  static const char text[] = TEST_TMP "/recorder-text.xdmf",
                    end[] = "</Grid>\n</Domain>\n</Xdmf>\n";
  scoped_particles *set = make_set(1200);
  mps_recorder *recorder = record(set, TEST_TMP "/recorder-text.vtkhdf", 0);
  assert_int_equal(occurrences(text, "<Time", end), 0);
  frame(recorder, set, 0.0);
  frame(recorder, set, 0.25);
  assert_int_equal(occurrences(text, "<Time", end), 2);
  assert_int_equal(occurrences(text, "NumberOfElements=\"1200\"", end), 2);
  int64_t ids[1200];
  for (int64_t k = 0; k < 1200; k++) ids[k] = k;
  OK(mps_particles_remove(set, ids, 1195));
  frame(recorder, set, 0.25);
  assert_int_equal(occurrences(text, "<Time", end), 2);
  assert_int_equal(occurrences(text, "NumberOfElements=\"5\"", end), 1);
  OK(mps_particles_remove(set, ids + 1195, 5));
  frame(recorder, set, 0.5);
  assert_int_equal(occurrences(text, "<Time", end), 2);
  assert_int_equal(occurrences(text, "recorder-text.vtkhdf:/VTKHDF/Points<", end), 2);
  OK(mps_recorder_close(&recorder));
}

TEST(bad_arguments_are_refused_before_the_file_is_touched) {
  static const char path[] = TEST_TMP "/recorder-untouched.vtkhdf";
  static const char *const unknown[] = {"pressure", "no_such"}, *const hole[] = {NULL};
  scoped_particles *set = make_set(3);
  mps_recorder *recorder = (mps_recorder *)&recorder;
  mps_recorder_def def = mps_recorder_defaults();
  scoped_context *other = test_context(MPS_CONTEXT_EXECUTOR_SERIAL, 1);
  unlink(path);
#define REFUSED(status, text)                                                                      \
  FAILS(mps_recorder_create(context, set, &def, &recorder), status, text);                         \
  assert_null(recorder)
  assert_int_equal(mps_recorder_create(NULL, set, &def, &recorder), MPS_ERROR_ARGUMENT);
  REFUSES(mps_recorder_create(context, set, &def, NULL), "out");
  REFUSES(mps_recorder_create(context, NULL, &def, &recorder), "particles is NULL");
  REFUSES(mps_recorder_create(context, set, NULL, &recorder), "def is NULL");
  def.path = "";
  REFUSED(MPS_ERROR_ARGUMENT, "path is empty");
  def.path = path;
  FAILS_ON(other, mps_recorder_create(other, set, &def, &recorder), MPS_ERROR_ARGUMENT,
           "another context");
  def.fields = unknown;
  def.field_count = 2;
  REFUSED(MPS_ERROR_FIELD, "fields[1] is 'no_such'");
  def.fields = hole;
  def.field_count = 1;
  REFUSED(MPS_ERROR_ARGUMENT, "fields[0] is NULL");
  def = mps_recorder_defaults();
  def.path = path;
  def.xdmf = 1;
  def.path = TEST_TMP "/recorder:untouched.vtkhdf";
  REFUSED(MPS_ERROR_ARGUMENT, "must have none of : < >");
  assert_int_equal(access(def.path, F_OK), -1);
  assert_int_equal(access(path, F_OK), -1);
  def = mps_recorder_defaults();
  def.path = TEST_TMP "/no such directory/x.vtkhdf";
  REFUSED(MPS_ERROR_IO, "No such file or directory");
  def.path = TEST_TMP;
  REFUSED(MPS_ERROR_IO, "directory");
  def.path = "/dev/full";
  REFUSED(MPS_ERROR_IO, "/dev/full");
#undef REFUSED
}

TEST(bad_times_are_refused_and_write_nothing) {
  static const char path[] = TEST_TMP "/recorder-times.vtkhdf";
  scoped_particles *set = make_set(3);
  mps_recorder *recorder = record(set, path, 0);
  REFUSES(mps_recorder_write(recorder, NAN), "time is nan");
  frame(recorder, set, 1.0);
  REFUSES(mps_recorder_write(recorder, 0.5), "time is 0.5 s");
  REFUSES(mps_recorder_write(recorder, INFINITY), "inf");
  assert_int_equal(mps_recorder_write(NULL, 1.0), MPS_ERROR_ARGUMENT);
  OK(mps_recorder_close(&recorder));
  OK(mps_recorder_close(&recorder));
  OK(mps_recorder_close(NULL));
  const hid_t file = open_series(path, 1);
  check_step(file, 0, 1.0, 3);
  H5Fclose(file);
}

/* Whatever the place where the disk gets full, the frames before stay readable. */
TEST(a_full_disk_costs_the_last_frame_only) {
  static const char path[] = TEST_TMP "/recorder-full.vtkhdf";
  scoped_particles *set = make_set(700);
  const int64_t handles = test_hdf5_handles();
  int reached = 0;
  for (int level = 0; level < 2; level++)
    for (int64_t limit = 100; limit < 600000; limit += limit < 60000 ? 700 : 9973) {
      DEF(recorder, def, .path = path, .compression = level);
      mps_recorder *recorder = NULL;
      double time = 0.0;
      test_disk_limit(limit);
      mps_status status = mps_recorder_create(context, set, &def, &recorder);
      int64_t frames = 0;
      for (; status == MPS_OK && time < 6.0; time += 1.0) {
        fill(set, time);
        status = mps_recorder_write(recorder, time);
        frames += status == MPS_OK;
      }
      if (status != MPS_OK) {
        assert_int_equal(status, MPS_ERROR_IO);
        assert_non_null(strstr(mps_context_error(context)->message, "File too large"));
      }
      if (status != MPS_OK && recorder) {
        FAILS(mps_recorder_write(recorder, time), MPS_ERROR_STATE, "no more");
        assert_int_equal(mps_recorder_close(&recorder), MPS_ERROR_IO);
      } else if (recorder) {
        OK(mps_recorder_close(&recorder));
      }
      test_disk_limit(0);
      if (frames > 0) {
        const hid_t file = open_series(path, frames);
        for (int64_t s = 0; s < frames; s++) check_step(file, s, (double)s, 700);
        H5Fclose(file);
        reached |= 1 << frames;
      }
      assert_int_equal(test_hdf5_open(), 0);
    }
  assert_int_equal(test_hdf5_handles(), handles);
  assert_int_equal(reached, 0x7e); /* it was full after every number of frames */
}

/* HDF5's tables grow with the number of frames: the disk gets full where they do. */
TEST(a_full_disk_spares_growing_tables) {
  static const char path[] = TEST_TMP "/recorder-tables.vtkhdf";
  enum { LONG = 140 };
  scoped_particles *set = make_set(2);
  DEF(recorder, def, .path = path);
  off_t size[LONG];
  static const char *const list[] = {"pressure"};
  def.fields = list;
  def.field_count = 1;
  def.compression = 1; /* a chunk a frame, so that the tables of chunks grow fast */
  MAKE_KEPT(recorder, recorder, create, context, set, &def);
  for (int k = 0; k < LONG; k++) {
    struct stat status;
    OK(mps_recorder_write(recorder, k));
    assert_int_equal(stat(path, &status), 0);
    size[k] = status.st_size;
  }
  OK(mps_recorder_close(&recorder));
  for (int k = 1; k < LONG; k++) {
    if (size[k] - size[k - 1] < 2000) continue; /* data only */
    for (off_t limit = size[k - 1] + 1; limit < size[k]; limit += 197) {
      int64_t frames = 0;
      OK(mps_recorder_create(context, set, &def, &recorder));
      test_disk_limit(limit);
      while (mps_recorder_write(recorder, (double)frames) == MPS_OK) frames++;
      assert_int_equal(mps_recorder_close(&recorder), MPS_ERROR_IO);
      test_disk_limit(0);
      assert_int_equal(frames, k);
      const hid_t file = open_series(path, frames);
      double times[LONG];
      read_rows(file, "VTKHDF/Steps/Values", H5T_NATIVE_DOUBLE, 1, 1, 0, frames, times);
      for (int64_t s = 0; s < frames; s++) {
        double row[3];
        int64_t id = -1;
        assert_true(times[s] == (double)s);
        const int64_t first = read_i64(file, "VTKHDF/Steps/PointOffsets", 1, s);
        read_rows(file, "VTKHDF/PointData/id", H5T_NATIVE_INT64, 1, 1, first + 1, 1, &id);
        assert_int_equal(id, 1);
        read_rows(file, "VTKHDF/Points", H5T_NATIVE_DOUBLE, 2, 3, first, 1, row);
      }
      H5Fclose(file);
    }
  }
}

static mps_status make_and_write(mps_context *ctx, int what) {
  DEF(particles, set_def, .spacing = 1.0);
  scoped_particles *set = NULL;
  scoped_recorder *recorder = NULL;
  const double at[2] = {0.0, 0.0};
  DEF(recorder, def, .path = TEST_TMP "/recorder-sweep.vtkhdf", .compression = what);
  mps_status status = mps_particles_create(ctx, &set_def, &set);
  if (status == MPS_OK) status = mps_particles_append(set, 1, at);
  if (status == MPS_OK) status = mps_recorder_create(ctx, set, &def, &recorder);
  if (status == MPS_OK) status = mps_recorder_write(recorder, 0.0);
  return status;
}

TEST(refused_allocations_leave_nothing_behind) {
  const int64_t handles = test_hdf5_handles();
  test_allocator_sweep(make_and_write, 0);
  test_allocator_sweep(make_and_write, 1);
  assert_int_equal(test_hdf5_handles(), handles);
}

TEST(frames_allocate_nothing) {
  test_allocator allocator = {0};
  mps_context *outer = context;
  context = test_allocator_context(&allocator);
  mps_particles *set = make_set(100);
  mps_recorder *recorder = record(set, TEST_TMP "/recorder-quiet.vtkhdf", 1);
  fill(set, 0.0); /* the set keeps memory for the values before an edit */
  const int64_t calls = allocator.calls;
  for (int k = 0; k < 5; k++) frame(recorder, set, k);
  assert_int_equal(allocator.calls, calls);
  OK(mps_recorder_close(&recorder));
  mps_particles_destroy(&set);
  mps_context_destroy(&context);
  assert_int_equal(allocator.live, 0);
  context = outer;
}

/* Distinct contexts may write at once, from distinct threads. */
static void *write_series(void *data) {
  mps_context *own = NULL;
  mps_particles *set = NULL;
  mps_recorder *recorder = NULL;
  const double at[4] = {0.0, 0.0, 1.0, 0.0};
  DEF(context, context_def, .executor = MPS_CONTEXT_EXECUTOR_SERIAL);
  DEF(particles, set_def, .spacing = 1.0);
  DEF(recorder, def, .path = data);
  mps_status status = mps_context_create(&context_def, &own, NULL, 0);
  if (status == MPS_OK) status = mps_particles_create(own, &set_def, &set);
  if (status == MPS_OK) status = mps_particles_append(set, 2, at);
  if (status == MPS_OK) status = mps_recorder_create(own, set, &def, &recorder);
  for (int k = 0; status == MPS_OK && k < 40; k++) status = mps_recorder_write(recorder, k);
  if (status == MPS_OK) status = mps_recorder_close(&recorder);
  mps_recorder_destroy(&recorder);
  mps_particles_destroy(&set);
  mps_context_destroy(&own);
  return status == MPS_OK ? NULL : data;
}

TEST(two_contexts_write_at_once) {
  char paths[3][sizeof TEST_TMP "/recorder-thread-0.vtkhdf"];
  pthread_t threads[3];
  for (int k = 0; k < 3; k++) {
    snprintf(paths[k], sizeof paths[k], "%s/recorder-thread-%d.vtkhdf", TEST_TMP, k);
    assert_int_equal(pthread_create(&threads[k], NULL, write_series, paths[k]), 0);
  }
  for (int k = 0; k < 3; k++) {
    void *failed = NULL;
    pthread_join(threads[k], &failed);
    assert_null(failed);
    H5Fclose(open_series(paths[k], 40));
  }
}
