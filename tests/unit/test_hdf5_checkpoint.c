/* test_hdf5_checkpoint.c - checkpoints: every bit comes back; every damage, mismatch, full disk and
 * refused allocation is an error that changes nothing. The restart of a solver:
 * test_hdf5_restart.c. SPDX-License-Identifier: BSD-3-Clause */
#include "io/checkpoint.h"
#include "test_allocator.h"
#include "test_fixture.h"
#include "test_hdf5.h"

#include <core/particles/particles_internal.h>
#include <io/replace.h>

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#define COUNT 37

static const char path[] = TEST_TMP "/checkpoint.h5", part[] = TEST_TMP "/checkpoint.h5.part";
static const char bent[] = TEST_TMP "/checkpoint-bent.h5";
/* ---- sets of known bits ---------------------------------------------------------------------- */

static mps_particles *make_set(mps_context *ctx, int32_t dim, double spacing, int64_t count) {
  DEF(particles, def, .dim = dim, .spacing = spacing);
  mps_particles *set = NULL;
  const double at[3] = {0.25, 0.5, 0.0};
  if (mps_particles_create(ctx, &def, &set) != MPS_OK) return NULL;
  for (int64_t k = 0; k < count; k++)
    if (mps_particles_append(set, 1, at) != MPS_OK) mps_particles_destroy(&set);
  return set;
}

static void add_fields(mps_particles *set) {
  OK(mps_particles_add_field(set, "velocity", 0));
  OK(mps_particles_add_field(set, "group", 0));
  OK(mps_particles_add_field(set, "restoring_old", 0));
  OK(mps_particles_add_field(set, "user.my_strain", 4));
}

/* 64 bits from where they belong: every kind of double comes up, NaNs with a payload too. */
static uint64_t bits(const char *name, int64_t component, int64_t id) {
  uint64_t word = (uint64_t)id * 0x9e3779b97f4a7c15u + (uint64_t)component * 0xbf58476d1ce4e5b9u;
  for (const char *c = name; *c; c++) word = (word ^ (uint64_t)*c) * 0x100000001b3u;
  word ^= word >> 29;
  if (id == 3) return 0x8000000000000000u; /* -0 */
  if (id == 4) return 0x7ff4deadbeef0001u; /* a signalling NaN */
  if (id == 5) return 0x0000000000000001u; /* the least number */
  if (id == 6) return 0xfff0000000000000u; /* -infinity */
  return word;
}

/* Writes or compares a field. */
static void field_bits(mps_particles *set, const char *name, bool write) {
  mps_view id = view_field(set, "id");
  mps_view view = view_field(set, name);
  for (int64_t i = 0; i < view.shape[0]; i++)
    for (int64_t c = 0; c < view.shape[1]; c++) {
      const uint64_t want = bits(name, c, *mps_view_i64(&id, i, 0));
      /* bits that no edit would let in */
      void *at = (void *)(uintptr_t)mps_view_f64(&view, i, c);
      if (write)
        memcpy(at, &want, 8);
      else if (memcmp(at, &want, 8) != 0)
        fail_msg("%s, component %d, index %d", name, (int)c, (int)i);
    }
}

/* Writes or compares all fields but id. */
static void each_bit(mps_particles *set, bool write) {
  mps_particles_field_info info;
  for (int32_t f = 1; f < mps_particles_field_count(set); f++) {
    OK(mps_particles_get_field_info(set, f, &info));
    field_bits(set, info.name, write);
  }
}

static void reverse(mps_particles *set) {
  const int64_t n = mps_particles_count(set);
  int64_t *order = malloc((size_t)n * sizeof *order);
  for (int64_t k = 0; k < n; k++) order[k] = n - 1 - k;
  OK(mpsi_particles_permute(set, __func__, order));
  free(order);
}

static mps_checkpoint some_info(void) {
  WITH_DEFAULTS(mps_checkpoint, info, .time = 0.1, .step = 123456789012, .dt = 1.0 / 3.0);
  snprintf(info.user_key, sizeof info.user_key, "wave --layers 3");
  return info;
}

static void write_checkpoint(void) {
  scoped_particles *set = make_set(context, 2, 0.5, COUNT);
  const mps_checkpoint info = some_info();
  add_fields(set);
  each_bit(set, true);
  OK(mpsi_checkpoint_write(set, path, &info));
}

/* A copy of the set's fields, to see that nothing changes. */
static unsigned char *copy_of(mps_particles *set, size_t *size) {
  unsigned char *copy = NULL;
  *size = 0;
  for (int32_t f = 0; f < mps_particles_field_count(set); f++) {
    mps_particles_field_info info;
    OK(mps_particles_get_field_info(set, f, &info));
    mps_view view = view_field(set, info.name);
    for (int64_t c = 0; c < view.shape[1]; c++) {
      const size_t bytes = (size_t)view.shape[0] * 8;
      copy = realloc(copy, *size + bytes + 1);
      memcpy(copy + *size, mps_view_f64(&view, 0, c), bytes);
      *size += bytes;
    }
  }
  return copy;
}

/* Reading `file` into a set like ours fails like this, and changes neither set nor info. */
static void refused(const char *file, mps_particles *set, mps_status status, const char *text) {
  size_t before_size, after_size;
  mps_checkpoint info = mps_checkpoint_defaults(), untouched;
  info.time = -7.0;
  untouched = info;
  unsigned char *before = copy_of(set, &before_size);
  FAILS(mps_checkpoint_read(set, file, &info), status, text);
  unsigned char *after = copy_of(set, &after_size);
  assert_int_equal(before_size, after_size);
  assert_memory_equal(before, after, before_size);
  assert_memory_equal(&info, &untouched, sizeof info);
  assert_string_equal(mps_context_error(context)->function, "mps_checkpoint_read");
  free(before);
  free(after);
}

/* ---- round trip ------------------------------------------------------------------------------ */

TEST(every_bit_comes_back_into_any_order) {
  const int64_t handles = test_hdf5_handles();
  write_checkpoint();
  for (int k = 0; k < 4; k++) {
    scoped_particles *set = make_set(context, 2, 0.5, COUNT);
    mps_checkpoint info = mps_checkpoint_defaults();
    if (k & 1) reverse(set);
    if (k & 2) add_fields(set); /* else they are added */
    OK(mps_particles_add_field(set, "user.own", 1));
    field_bits(set, "user.own", true); /* not in the file: stays */
    const uint64_t epoch = mps_particles_epoch(set);
    OK(mps_checkpoint_read(set, path, &info));
    assert_int_equal(mps_particles_epoch(set), epoch);
    assert_int_equal(mps_particles_index(set, 0), k & 1 ? COUNT - 1 : 0);
    each_bit(set, false);
    assert_true(info.time == 0.1 && info.dt == 1.0 / 3.0);
    assert_int_equal(info.step, 123456789012);
    assert_string_equal(info.user_key, "wave --layers 3");
  }
  assert_int_equal(test_hdf5_handles(), handles);
  assert_int_equal(access(part, F_OK), -1);
}

TEST(three_dimensions_and_no_particles) {
  for (int64_t count = 0; count < 6; count += 5) {
    scoped_particles *set = make_set(context, 3, 0.5, count),
                     *other = make_set(context, 3, 0.5, count);
    mps_checkpoint info = mps_checkpoint_defaults();
    add_fields(set);
    each_bit(set, true);
    OK(mpsi_checkpoint_write(set, path, &info));
    OK(mps_checkpoint_read(other, path, &info));
    each_bit(other, false);
    assert_int_equal(mps_particles_field_count(other), mps_particles_field_count(set));
    assert_string_equal(info.user_key, "");
  }
}

TEST(the_header_can_be_read_alone) {
  mps_checkpoint info = mps_checkpoint_defaults();
  write_checkpoint();
  OK(mps_checkpoint_info(context, path, &info));
  assert_true(info.time == 0.1 && info.dt == 1.0 / 3.0 && info.step == 123456789012);
  OK(mps_checkpoint_info(context, path, &info)); /* the key is equal now */
  info.user_key[0] = 'W';
  REFUSES(mps_checkpoint_info(context, path, &info),
          "has user_key 'wave --layers 3', wanted is 'Wave --layers 3'");
  assert_int_equal(mps_checkpoint_info(NULL, path, &info), MPS_ERROR_ARGUMENT);
  REFUSES(mps_checkpoint_info(context, NULL, &info), "path");
  REFUSES(mps_checkpoint_info(context, path, NULL), "info");
}

/* ---- arguments ------------------------------------------------------------------------------- */

TEST(bad_arguments_of_writing) {
  scoped_particles *set = make_set(context, 2, 0.5, 2);
  mps_checkpoint info = some_info();
  unlink(path);
#define BAD(text) REFUSES(mpsi_checkpoint_write(set, path, &info), text)
  assert_int_equal(mpsi_checkpoint_write(NULL, path, &info), MPS_ERROR_ARGUMENT);
  REFUSES(mpsi_checkpoint_write(set, NULL, &info), "path is NULL");
  REFUSES(mpsi_checkpoint_write(set, "", &info), "path is empty");
  REFUSES(mpsi_checkpoint_write(set, path, NULL), "info is NULL");
  info.time = NAN;
  BAD("time is nan");
  info = some_info();
  info.dt = -1.0;
  BAD("dt is -1 s");
  info.dt = INFINITY;
  BAD("dt is inf");
  info = some_info();
  info.step = -2;
  BAD("step is -2");
  info = some_info();
  memset(info.user_key, 'x', sizeof info.user_key);
  BAD("at most 63 characters");
#undef BAD
  assert_int_equal(access(path, F_OK), -1);
  info = some_info();
  FAILS(mpsi_checkpoint_write(set, TEST_TMP "/none/x.h5", &info), MPS_ERROR_IO,
        "No such file or directory");
  mkdir(TEST_TMP "/checkpoint-dir", 0777);
  FAILS(mpsi_checkpoint_write(set, TEST_TMP "/checkpoint-dir", &info), MPS_ERROR_IO, "directory");
  assert_int_equal(access(TEST_TMP "/checkpoint-dir.part", F_OK), -1);
}

/* The temporary name: a file that a killed program has left is replaced; a link is not followed; a
 * file that is being written is left to its writer. */
TEST(the_temporary_name_is_exclusive) {
  static const char mine[] = TEST_TMP "/checkpoint-mine";
  scoped_particles *set = make_set(context, 2, 0.5, COUNT);
  const mps_checkpoint info = some_info();
  unlink(path), unlink(part), unlink(mine);
  FILE *file = fopen(part, "w");
  assert_non_null(file);
  fputs("left", file);
  fclose(file);
  OK(mpsi_checkpoint_write(set, path, &info));
  assert_int_equal(access(part, F_OK), -1);
  assert_int_equal(symlink(mine, part), 0);
  FAILS(mpsi_checkpoint_write(set, path, &info), MPS_ERROR_IO, "not a file");
  assert_int_equal(access(mine, F_OK), -1);
  assert_int_equal(unlink(part), 0);
  mpsi_replacement other;
  OK(mpsi_replace_begin(context, "test", path, true, &other));
  FAILS(mpsi_checkpoint_write(set, path, &info), MPS_ERROR_IO, "being written by another program");
  assert_int_equal(access(part, F_OK), 0);
  mpsi_replace_abandon(context, &other);
  OK(mpsi_checkpoint_write(set, path, &info));
  unlink(path);
}

/* What is no checkpoint stays what it is: devices, pipes, links to them, other files. An empty file
 * is replaced. */
TEST(other_files_are_not_replaced) {
  static const char *const kinds[] = {"device or pipe", "device or pipe", "no checkpoint"};
  char names[3][80];
  snprintf(names[0], sizeof names[0], "%s/checkpoint-pipe", TEST_TMP);
  snprintf(names[1], sizeof names[1], "%s/checkpoint-link", TEST_TMP);
  snprintf(names[2], sizeof names[2], "%s/checkpoint-text", TEST_TMP);
  scoped_particles *set = make_set(context, 2, 0.5, COUNT);
  mps_checkpoint info = some_info();
  for (int k = 0; k < 3; k++) remove(names[k]);
  assert_int_equal(mkfifo(names[0], 0600), 0);
  assert_int_equal(symlink("/dev/full", names[1]), 0);
  FILE *text = fopen(names[2], "w");
  assert_non_null(text);
  fprintf(text, "%s", "a letter that is longer than a seal of a checkpoint");
  fclose(text);
  for (int k = 0; k < 3; k++) {
    struct stat before, after;
    assert_int_equal(lstat(names[k], &before), 0);
    FAILS(mpsi_checkpoint_write(set, names[k], &info), MPS_ERROR_IO, kinds[k]);
    assert_int_equal(lstat(names[k], &after), 0);
    assert_int_equal(before.st_ino, after.st_ino);
    assert_int_equal(before.st_mode, after.st_mode);
    assert_int_equal(before.st_size, after.st_size);
  }
  remove(names[2]);
  text = fopen(names[2], "w");
  assert_non_null(text);
  fclose(text);
  OK(mpsi_checkpoint_write(set, names[2], &info));
  OK(mpsi_checkpoint_write(set, names[2], &info)); /* one of ours */
  for (int k = 0; k < 3; k++) remove(names[k]);
}

TEST(another_set_is_refused) {
  write_checkpoint();
  scoped_particles *fewer = make_set(context, 2, 0.5, COUNT - 1),
                   *space = make_set(context, 3, 0.5, COUNT);
  scoped_particles *finer = make_set(context, 2, 0.25, COUNT),
                   *same = make_set(context, 2, 0.5, COUNT);
  refused(path, fewer, MPS_ERROR_ARGUMENT, "has 37 particles in 2D, the set has 36 in 2D");
  refused(path, space, MPS_ERROR_ARGUMENT, "has 37 particles in 2D, the set has 37 in 3D");
  refused(path, finer, MPS_ERROR_ARGUMENT, "has spacing 0.5 m, the set has 0.25 m");
  OK(mps_particles_add_field(same, "user.my_strain", 3));
  refused(path, same, MPS_ERROR_FIELD, "field 'user.my_strain' with 4 components of float64");
  WITH_DEFAULTS(mps_checkpoint, info, .user_key[0] = 'x');
  REFUSES(mps_checkpoint_read(same, path, &info), "has user_key 'wave --layers 3', wanted is 'x'");
  assert_int_equal(mps_checkpoint_read(NULL, path, &info), MPS_ERROR_ARGUMENT);
  REFUSES(mps_checkpoint_read(same, NULL, &info), "path");
  REFUSES(mps_checkpoint_read(same, path, NULL), "info");
}

/* ---- files that are not one ------------------------------------------------------------------ */

static unsigned char *load(const char *file, size_t *size) {
  FILE *in = fopen(file, "rb");
  assert_non_null(in);
  fseek(in, 0, SEEK_END);
  *size = (size_t)ftell(in);
  rewind(in);
  unsigned char *data = malloc(*size);
  assert_int_equal(fread(data, 1, *size, in), *size);
  fclose(in);
  return data;
}

static void store(const char *file, const void *data, size_t size) {
  FILE *out = fopen(file, "wb");
  assert_non_null(out);
  assert_int_equal(fwrite(data, 1, size, out), size);
  fclose(out);
}

TEST(what_is_no_checkpoint_is_refused) {
  scoped_particles *set = make_set(context, 2, 0.5, COUNT);
  scoped_recorder *recorder = NULL;
  refused(TEST_TMP "/no such file", set, MPS_ERROR_IO, "No such file or directory");
  refused(TEST_TMP, set, MPS_ERROR_IO, "not a file");
  unlink(bent);
  assert_int_equal(mkfifo(bent, 0600), 0);
  refused(bent, set, MPS_ERROR_IO, "not a file");
  unlink(bent);
  store(bent, "", 0);
  refused(bent, set, MPS_ERROR_FORMAT, "does not begin as an HDF5 file");
  store(bent, "time,x,y\n0,1,2\n", 15);
  refused(bent, set, MPS_ERROR_FORMAT, "does not begin as an HDF5 file");
  unlink(bent);
  USING(recorder, mps_recorder_create(context, set, &given, &recorder), .path = bent);
  refused(bent, set, MPS_ERROR_FORMAT, "does not end with a seal");
}

TEST(a_file_cut_short_anywhere_is_refused) {
  size_t size;
  write_checkpoint();
  scoped_particles *set = make_set(context, 2, 0.5, COUNT);
  unsigned char *data = load(path, &size);
  int lengths = 0;
  for (size_t length = 0; length < size; length += length < 600 || length + 600 > size ? 1 : 61) {
    store(bent, data, length);
    refused(bent, set, MPS_ERROR_FORMAT, "is not a checkpoint");
    lengths++;
  }
  assert_true(lengths > 1200);
  assert_int_equal(test_hdf5_open(), 0);
  free(data);
}

TEST(a_changed_byte_is_noticed) {
  size_t size;
  write_checkpoint();
  scoped_particles *set = make_set(context, 2, 0.5, COUNT);
  unsigned char *data = load(path, &size);
  for (size_t at = 0; at<size; at += at + 40> size ? 1 : 31) {
    data[at] ^= (unsigned char)(1u << at % 8);
    store(bent, data, size);
    refused(bent, set, MPS_ERROR_FORMAT, "checkpoint-bent.h5' is ");
    data[at] ^= (unsigned char)(1u << at % 8);
  }
  store(bent, data, size);
  mps_checkpoint info = mps_checkpoint_defaults();
  OK(mps_checkpoint_read(set, bent, &info));
  free(data);
}

/* Seals `size` bytes of `data` as mpsi_checkpoint_write does. */
static void store_sealed(const char *file, const void *data, size_t size) {
  mpsi_replacement replacement;
  remove(file); /* bent, it would not be replaced */
  OK(mpsi_replace_begin(context, __func__, file, true, &replacement));
  assert_int_equal(write(replacement.fd, data, size), (ssize_t)size);
  OK(mpsi_replace_commit(context, __func__, &replacement));
}

/* Even a sealed file is not believed: HDF5's own checks come to the caller as errors. */
TEST(a_sealed_file_cut_short_is_refused) {
  size_t size;
  write_checkpoint();
  scoped_particles *set = make_set(context, 2, 0.5, COUNT);
  unsigned char *data = load(path, &size);
  for (size_t length = 8; length < size - 32; length += 997) {
    store_sealed(bent, data, length);
    refused(bent, set, MPS_ERROR_FORMAT, "is not a checkpoint of libmps: it does not open");
  }
  assert_int_equal(test_hdf5_open(), 0);
  free(data);
}

static int printed;
static herr_t host_print(hid_t stack, void *data) {
  printed += *(int *)data;
  return 0;
}
static herr_t host_print_old(void *data) {
  printed += *(int *)data;
  return 0;
}

/* A host of HDF5 may have either of its two ways of printing errors. */
TEST(the_hosts_error_printing_is_left_alone) {
  int weight = 3;
  size_t size;
  H5E_auto2_t before, now;
  void *before_data, *now_data;
  write_checkpoint();
  scoped_particles *set = make_set(context, 2, 0.5, COUNT);
  unsigned char *data = load(path, &size);
  store_sealed(bent, data, size / 2);
  H5Eget_auto2(H5E_DEFAULT, &before, &before_data);
  for (int old = 0; old < 2; old++) {
    printed = 0;
    if (old)
      H5Eset_auto1(host_print_old, &weight);
    else
      H5Eset_auto2(H5E_DEFAULT, host_print, &weight);
    refused(bent, set, MPS_ERROR_FORMAT, "it does not open; HDF5 says: truncated file");
    assert_int_equal(printed, 0);
    if (!old) {
      H5Eget_auto2(H5E_DEFAULT, &now, &now_data);
      assert_true(now == host_print && now_data == &weight);
    }
    assert_true(H5Fopen(TEST_TMP "/no such file", H5F_ACC_RDONLY, H5P_DEFAULT) < 0);
    assert_int_equal(printed, 3);
  }
  H5Eset_auto2(H5E_DEFAULT, before, before_data);
  free(data);
}

/* ---- checkpoints whose content is wrong ------------------------------------------------------ */

static void put_attribute(hid_t file, const char *name, hid_t type, const void *value) {
  const hid_t space = H5Screate(H5S_SCALAR);
  H5Adelete(file, name);
  const hid_t attribute = H5Acreate2(file, name, type, space, H5P_DEFAULT, H5P_DEFAULT);
  assert_true(H5Awrite(attribute, type, value) >= 0);
  H5Aclose(attribute);
  H5Sclose(space);
}

static void put_text(hid_t file, const char *name, const char *text, size_t size) {
  const hid_t type = H5Tcopy(H5T_C_S1);
  H5Tset_size(type, size);
  put_attribute(file, name, type, size == H5T_VARIABLE ? (const void *)&text : text);
  H5Tclose(type);
}

static void put_dataset(hid_t file, const char *name, hid_t type, int rank, hsize_t rows,
                        hsize_t columns) {
  const hsize_t size[3] = {rows, columns, 1};
  const hid_t space = H5Screate_simple(rank, size, NULL);
  if (H5Lexists(file, name, H5P_DEFAULT) > 0) H5Ldelete(file, name, H5P_DEFAULT);
  H5Dclose(H5Dcreate2(file, name, type, space, H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT));
  H5Sclose(space);
}

static void put_id(hid_t file, int64_t index, int64_t value) {
  int64_t id[COUNT];
  const hid_t dataset = H5Dopen2(file, "fields/id", H5P_DEFAULT);
  H5Dread(dataset, H5T_NATIVE_INT64, H5S_ALL, H5S_ALL, H5P_DEFAULT, id);
  id[index] = value;
  H5Dwrite(dataset, H5T_NATIVE_INT64, H5S_ALL, H5S_ALL, H5P_DEFAULT, id);
  H5Dclose(dataset);
}

static const int64_t minus_one = -1, seven = 7;
static const double nan_value = NAN, minus_dt = -0.5;
static const float single = 0.5F;

typedef struct bend {
  const char *text; /* part of the message */
  mps_status status;
} bend;

/* clang-format off */
/* Bends the open file in one of many ways; false when there are no more. */
static bool bend_file(hid_t f, int way, bend *out) {
  *out = (bend){"is not a checkpoint of libmps", MPS_ERROR_FORMAT};
  switch (way) {
  case 0: H5Adelete(f, "format"); out->text = "'format'"; return true;
  case 1: put_text(f, "format", "other checkpoint!", 17); out->text = "'format'"; return true;
  case 2: put_text(f, "format", "libmps checkpoint and more", 26); out->text = "'format'"; return true;
  case 3: put_attribute(f, "version", H5T_NATIVE_INT64, &seven);
    *out = (bend){"is a checkpoint of version 7", MPS_ERROR_UNSUPPORTED}; return true;
  case 4: H5Adelete(f, "version"); out->text = "version"; return true;
  case 5: H5Adelete(f, "spacing"); out->text = "spacing"; return true;
  case 6: put_attribute(f, "spacing", H5T_NATIVE_INT64, &seven); out->text = "spacing"; return true;
  case 7: put_attribute(f, "time", H5T_NATIVE_DOUBLE, &nan_value); out->text = "out of range"; return true;
  case 8: put_attribute(f, "step", H5T_NATIVE_INT64, &minus_one); out->text = "out of range"; return true;
  case 9: put_attribute(f, "dt", H5T_NATIVE_DOUBLE, &minus_dt); out->text = "out of range"; return true;
  case 10: put_text(f, "user_key", "x", H5T_VARIABLE); out->text = "user_key"; return true;
  case 11: put_text(f, "user_key", "0123456789012345678901234567890123456789012345678901234567890123", 64);
    out->text = "user_key"; return true;
  case 12: put_attribute(f, "particles", H5T_NATIVE_INT64, &minus_one);
    *out = (bend){"has -1 particles", MPS_ERROR_ARGUMENT}; return true;
  case 13: H5Ldelete(f, "fields", H5P_DEFAULT); out->text = "group 'fields'"; return true;
  case 14: H5Ldelete(f, "fields/id", H5P_DEFAULT); out->text = "no ids"; return true;
  case 15: put_dataset(f, "fields/id", H5T_NATIVE_DOUBLE, 2, 1, COUNT); out->text = "no ids"; return true;
  case 16: put_id(f, 5, COUNT); *out = (bend){"id 37, the set has none", MPS_ERROR_ARGUMENT}; return true;
  case 17: put_id(f, 5, -3); *out = (bend){"id -3, the set has none", MPS_ERROR_ARGUMENT}; return true;
  case 18: put_id(f, 5, 6); *out = (bend){"id 6, more than once", MPS_ERROR_ARGUMENT}; return true;
  case 19: put_dataset(f, "fields/velocity", H5T_NATIVE_DOUBLE, 2, 3, COUNT);
    *out = (bend){"'velocity' with 3 components", MPS_ERROR_FIELD}; return true;
  case 20: put_dataset(f, "fields/velocity", H5T_NATIVE_INT64, 2, 2, COUNT);
    *out = (bend){"'velocity' with 2 components of int64", MPS_ERROR_FIELD}; return true;
  case 21: put_dataset(f, "fields/position", H5T_NATIVE_DOUBLE, 2, 3, COUNT);
    *out = (bend){"'position' with 3 components", MPS_ERROR_FIELD}; return true;
  case 22: put_dataset(f, "fields/velocity", H5T_NATIVE_DOUBLE, 1, COUNT, 1); out->text = "velocity"; return true;
  case 23: put_dataset(f, "fields/velocity", H5T_NATIVE_DOUBLE, 3, 2, COUNT); out->text = "velocity"; return true;
  case 24: put_dataset(f, "fields/velocity", H5T_NATIVE_DOUBLE, 2, 2, COUNT - 1); out->text = "velocity"; return true;
  case 25: put_dataset(f, "fields/velocity", H5T_NATIVE_DOUBLE, 2, 65, COUNT); out->text = "velocity"; return true;
  case 26: put_dataset(f, "fields/velocity", H5T_NATIVE_FLOAT, 2, 2, COUNT); out->text = "velocity"; return true;
  case 27: put_dataset(f, "fields/9_lives", H5T_NATIVE_DOUBLE, 2, 2, COUNT);
    *out = (bend){"'9_lives'", MPS_ERROR_FIELD}; return true;
  case 28: put_dataset(f, "fields/wide", H5T_NATIVE_DOUBLE, 2, 17, COUNT);
    *out = (bend){"'user.wide' with 17 components", MPS_ERROR_FIELD}; return true;
  case 29: put_dataset(f, "fields/whole", H5T_NATIVE_INT64, 2, 1, COUNT);
    *out = (bend){"'user.whole' with 1 components of int64", MPS_ERROR_FIELD}; return true;
  case 30: put_dataset(f, "fields/a_name_of_more_than_95_characters_is_too_long_for_a_field_even_for_one_of_the_history_of_a_material", H5T_NATIVE_DOUBLE, 2, 2, COUNT); out->text = "the name of a field"; return true;
  case 31: H5Gclose(H5Gcreate2(f, "fields/nested", H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT));
    out->text = "nested"; return true;
  case 32: H5Lcreate_external("/etc/passwd", "x", f, "fields/abroad", H5P_DEFAULT, H5P_DEFAULT);
    out->text = "the name of a field"; return true;
  case 33: H5Lcreate_soft("/fields/id", f, "fields/soft", H5P_DEFAULT, H5P_DEFAULT);
    out->text = "the name of a field"; return true;
  case 34: put_attribute(f, "dt", H5T_NATIVE_FLOAT, &single); *out = (bend){NULL, MPS_OK}; return true;
  default: return false;
  }
}
/* clang-format on */

/* A checkpoint in memory as a file without its seal, to be bent. */
static hid_t open_bent(const unsigned char *data, size_t size) {
  store(bent, data, size - 32);
  return H5Fopen(bent, H5F_ACC_RDWR, H5P_DEFAULT);
}

static void seal_bent(void) {
  size_t size;
  unsigned char *data = load(bent, &size);
  store_sealed(bent, data, size);
  free(data);
}

TEST(wrong_content_is_refused) {
  size_t size;
  write_checkpoint();
  scoped_particles *set = make_set(context, 2, 0.5, COUNT);
  unsigned char *data = load(path, &size);
  const int64_t handles = test_hdf5_handles();
  bend bent_way;
  for (int way = 0;; way++) {
    const hid_t file = open_bent(data, size);
    const bool more = bend_file(file, way, &bent_way);
    assert_true(H5Fclose(file) >= 0);
    if (!more) break;
    seal_bent();
    mps_checkpoint info = mps_checkpoint_defaults();
    if (bent_way.status != MPS_OK)
      refused(bent, set, bent_way.status, bent_way.text);
    else /* another width of a number is no harm */
      OK(mps_checkpoint_info(context, bent, &info));
    assert_int_equal(test_hdf5_open(), 0);
  }
  assert_int_equal(test_hdf5_handles(), handles);
  free(data);
}

/* libmps 0.3 wrote a caller's field without "user." before its name. */
TEST(a_callers_field_of_a_former_version_gets_the_name_of_today) {
  size_t size;
  write_checkpoint();
  unsigned char *data = load(path, &size);
  scoped_particles *set = make_set(context, 2, 0.5, COUNT);
  hid_t file = open_bent(data, size);
  assert_true(H5Lmove(file, "fields/user.my_strain", file, "fields/my_strain", H5P_DEFAULT,
                      H5P_DEFAULT) >= 0);
  assert_true(H5Fclose(file) >= 0);
  seal_bent();
  mps_checkpoint info = mps_checkpoint_defaults();
  OK(mps_checkpoint_read(set, bent, &info));
  each_bit(set, false);
  file = open_bent(data, size); /* which of the two should it be? */
  put_dataset(file, "fields/my_strain", H5T_NATIVE_DOUBLE, 2, 4, COUNT);
  assert_true(H5Fclose(file) >= 0);
  seal_bent();
  refused(bent, set, MPS_ERROR_FORMAT, "user.my_strain");
  free(data);
}

/* ---- full disk, refused memory --------------------------------------------------------------- */

TEST(a_full_disk_leaves_the_former_checkpoint) {
  size_t size, former_size;
  write_checkpoint();
  unsigned char *former = load(path, &former_size);
  scoped_particles *set = make_set(context, 2, 0.5, COUNT);
  mps_checkpoint info = mps_checkpoint_defaults();
  add_fields(set);
  remove(bent);
  OK(mpsi_checkpoint_write(set, bent, &info));
  free(load(bent, &size));
  for (size_t limit = 1; limit<size; limit += limit + 200> size ? 1 : 173) {
    size_t now_size;
    test_disk_limit((int64_t)limit);
    FAILS(mpsi_checkpoint_write(set, path, &info), MPS_ERROR_IO, "File too large");
    test_disk_limit(0);
    unsigned char *now = load(path, &now_size);
    assert_int_equal(now_size, former_size);
    assert_memory_equal(now, former, now_size);
    assert_int_equal(access(part, F_OK), -1);
    assert_int_equal(test_hdf5_open(), 0);
    free(now);
  }
  test_disk_limit((int64_t)size);
  OK(mpsi_checkpoint_write(set, path, &info));
  test_disk_limit(0);
  free(former);
}

static mps_status write_or_read(mps_context *ctx, int what) {
  mps_checkpoint info = mps_checkpoint_defaults();
  scoped_particles *set = make_set(ctx, 2, 0.5, COUNT);
  if (!set) return MPS_ERROR_MEMORY;
  const mps_status status =
      what == 0 ? mpsi_checkpoint_write(set, path, &info) : mps_checkpoint_read(set, path, &info);
  if (status != MPS_OK) assert_int_equal(mps_particles_field_count(set), 2); /* none added */
  return status;
}

TEST(refused_allocations_leave_nothing_behind) {
  const int64_t handles = test_hdf5_handles();
  write_checkpoint();
  test_allocator_sweep(write_or_read, 1);
  test_allocator_sweep(write_or_read, 0);
  assert_int_equal(test_hdf5_handles(), handles);
  assert_int_equal(access(part, F_OK), -1);
}
