/* hdf5_file.c - calls of HDF5, and the file driver through which HDF5 writes.
 *
 * Why a separate driver: HDF5 1.10 does not survive a failed write. It keeps the file registered
 * after its structures are freed, and the program crashes when it exits. This driver stores the
 * first error and accepts all later writes, so that HDF5 closes in order; the caller that opened
 * the file then reads the error. It also reserves the disk space of a file before it changes HDF5's
 * tables in it, so that a full disk leaves the former tables intact.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "hdf5_file.h"

#include "core/context/first_use.h"

#include <errno.h>
#include <fcntl.h>
#include <pthread.h>
#include <stdio.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

/* ---- a stay in HDF5 -------------------------------------------------------------------------- */

/* HDF5 has process-wide tables, so the lock between contexts must be process-wide too. */
static pthread_mutex_t hdf5_mutex = PTHREAD_MUTEX_INITIALIZER;

const mpsi_hdf5_calls *mpsi_hdf5;

mps_status mpsi_h5_load(mps_context *context, const char *function) {
  char why[300] = "";
  pthread_mutex_lock(&hdf5_mutex);
  if (!mpsi_hdf5) mpsi_hdf5 = mpsi_hdf5_find(why, sizeof why);
  const bool found = mpsi_hdf5;
  pthread_mutex_unlock(&hdf5_mutex);
  if (found) return MPS_OK;
  return mpsi_fail(context, function, MPS_ERROR_UNSUPPORTED,
                   "results and restart files need HDF5, which cannot be loaded: %s", why);
}

static herr_t note_innermost(unsigned n, const H5E_error2_t *error, void *data) {
  mpsi_h5_stay *stay = data;
  if (n == 0) {
    snprintf(stay->text, sizeof stay->text, "%s", error->desc ? error->desc : "");
    stay->memory = error->min_num == H5E_NOSPACE || error->min_num == H5E_CANTALLOC;
  }
  return 0;
}

/* Called by HDF5 on each error, where it would print by default. */
static herr_t note_error(hid_t stack, void *data) {
  mpsi_h5_stay *stay = data;
  if (stay->text[0] == '\0') H5Ewalk2(stack, H5E_WALK_UPWARD, note_innermost, stay);
  return 0;
}

void mpsi_h5_enter(mpsi_h5_stay *stay) {
  memset(stay, 0, sizeof *stay);
  stay->is_new_form = 1;
  pthread_mutex_lock(&hdf5_mutex);
  H5open();
  H5Eauto_is_v2(H5E_DEFAULT, &stay->is_new_form);
#ifndef H5_NO_DEPRECATED_SYMBOLS
  if (!stay->is_new_form) H5Eget_auto1(&stay->old_print, &stay->print_data);
#endif
  if (stay->is_new_form) H5Eget_auto2(H5E_DEFAULT, &stay->print, &stay->print_data);
  H5Eset_auto2(H5E_DEFAULT, note_error, stay);
}

void mpsi_h5_leave(mpsi_h5_stay *stay) {
#ifndef H5_NO_DEPRECATED_SYMBOLS
  if (!stay->is_new_form) H5Eset_auto1(stay->old_print, stay->print_data);
#endif
  if (stay->is_new_form) H5Eset_auto2(H5E_DEFAULT, stay->print, stay->print_data);
  pthread_mutex_unlock(&hdf5_mutex);
}

/* ---- the driver ------------------------------------------------------------------------------ */

typedef struct driver_info { /* passed to driver_open in a property list */
  mpsi_h5_file *file;
} driver_info;

static H5FD_t *driver_open(const char *name, unsigned flags, hid_t access, haddr_t max_address) {
  const driver_info *info = H5Pget_driver_info(access);
  return info ? &info->file->driver : NULL;
}

/* The descriptor and the structure belong to the caller that opened the file. */
static herr_t driver_close(H5FD_t *driver) { return 0; }

static herr_t driver_query(const H5FD_t *driver, unsigned long *flags) {
  *flags = H5FD_FEAT_AGGREGATE_METADATA | H5FD_FEAT_ACCUMULATE_METADATA | H5FD_FEAT_DATA_SIEVE |
           H5FD_FEAT_AGGREGATE_SMALLDATA;
  return 0;
}

static haddr_t driver_get_eoa(const H5FD_t *driver, H5FD_mem_t type) {
  return ((const mpsi_h5_file *)driver)->end_of_allocation;
}

static herr_t driver_set_eoa(H5FD_t *driver, H5FD_mem_t type, haddr_t address) {
  ((mpsi_h5_file *)driver)->end_of_allocation = address;
  return 0;
}

static haddr_t driver_get_eof(const H5FD_t *driver, H5FD_mem_t type) {
  return ((const mpsi_h5_file *)driver)->end_of_file;
}

static herr_t driver_read(H5FD_t *driver, H5FD_mem_t type, hid_t transfer, haddr_t address,
                          size_t size, void *buffer) {
  mpsi_h5_file *file = (mpsi_h5_file *)driver;
  char *to = buffer;
  while (size > 0) {
    const ssize_t got = pread(file->fd, to, size, (off_t)address);
    if (got < 0 && errno == EINTR) continue;
    if (got < 0) {
      if (!file->error) file->error = errno;
      return -1;
    }
    if (got == 0) { /* allocated but never written: HDF5 expects zeros */
      memset(to, 0, size);
      return 0;
    }
    to += got, address += (haddr_t)got, size -= (size_t)got;
  }
  return 0;
}

/* Reserves disk space for everything allocated so far. */
static int reserve(mpsi_h5_file *file) {
  if (file->end_of_allocation <= file->reserved) return 0;
  const int error = posix_fallocate(file->fd, 0, (off_t)file->end_of_allocation);
  file->reserved = file->end_of_allocation;
  if (error == 0 && file->end_of_file < file->reserved) file->end_of_file = file->reserved;
  const bool refused = error == ENOSPC || error == EFBIG || error == EDQUOT || error == EIO;
  return refused ? error : 0; /* else: a device that cannot promise */
}

static herr_t driver_write(H5FD_t *driver, H5FD_mem_t type, hid_t transfer, haddr_t address,
                           size_t size, const void *buffer) {
  mpsi_h5_file *file = (mpsi_h5_file *)driver;
  const char *from = buffer;
  if (type != H5FD_MEM_DRAW && !file->error) file->error = reserve(file);
  while (size > 0 && !file->error) {
    const ssize_t put = pwrite(file->fd, from, size, (off_t)address);
    if (put < 0 && errno != EINTR) file->error = errno;
    if (put == 0) file->error = ENOSPC;
    if (put > 0) from += put, address += (haddr_t)put, size -= (size_t)put;
  }
  if (file->end_of_file < address + size) file->end_of_file = address + size;
  return 0;
}

static herr_t driver_truncate(H5FD_t *driver, hid_t transfer, hbool_t closing) {
  mpsi_h5_file *file = (mpsi_h5_file *)driver;
  if (file->end_of_allocation == file->end_of_file) return 0;
  if (!file->error && ftruncate(file->fd, (off_t)file->end_of_allocation) != 0) file->error = errno;
  file->end_of_file = file->end_of_allocation;
  return 0;
}

static const H5FD_class_t driver_class = {
#if H5_VERSION_GE(1, 14, 0)
    .version = H5FD_CLASS_VERSION,
    .value = 511, /* of the range for unregistered drivers: no file names it */
#endif
    .name = "libmps",
    .maxaddr = ((haddr_t)1 << 62) - 1,
    .fc_degree = H5F_CLOSE_STRONG,
    .fapl_size = sizeof(driver_info),
    .open = driver_open,
    .close = driver_close,
    .query = driver_query,
    .get_eoa = driver_get_eoa,
    .set_eoa = driver_set_eoa,
    .get_eof = driver_get_eof,
    .read = driver_read,
    .write = driver_write,
    .truncate = driver_truncate,
    .fl_map = H5FD_FLMAP_DICHOTOMY};

/* ---- a file ---------------------------------------------------------------------------------- */

bool mpsi_h5_open(mpsi_h5_file *file, int fd, const char *name, bool create) {
  struct stat status;
  memset(file, 0, sizeof *file);
  file->fd = fd;
  file->id = -1;
  if (fstat(fd, &status) != 0) {
    file->error = errno;
    return false;
  }
  file->end_of_file = (haddr_t)status.st_size;
  const driver_info info = {file};
  const hid_t driver = file->driver_id = H5FDregister(&driver_class);
  const hid_t access = H5Pcreate(H5P_FILE_ACCESS);
  if (driver > 0 && access >= 0 && H5Pset_driver(access, driver, &info) >= 0 &&
      H5Pset_fclose_degree(access, H5F_CLOSE_STRONG) >= 0)
    file->id = create ? H5Fcreate(name, H5F_ACC_TRUNC, H5P_DEFAULT, access)
                      : H5Fopen(name, H5F_ACC_RDONLY, access);
  if (access >= 0) H5Pclose(access);
  if (file->id < 0) mpsi_h5_close(file);
  return file->id >= 0;
}

bool mpsi_h5_close(mpsi_h5_file *file) {
  const bool good = file->id < 0 || H5Fclose(file->id) >= 0;
  file->id = -1;
  if (file->driver_id > 0) H5FDunregister(file->driver_id);
  file->driver_id = 0;
  return good;
}

mps_status mpsi_h5_fail(mps_context *context, const char *function, mps_status status,
                        const mpsi_h5_stay *stay, const mpsi_h5_file *file, const char *verb,
                        const char *path) {
  if (file->error) return mpsi_fail_io(context, function, verb, path, file->error);
  return mpsi_fail(context, function, stay->memory ? MPS_ERROR_MEMORY : status,
                   "cannot %s '%.200s': HDF5 says: %s", verb, path,
                   stay->text[0] ? stay->text : "nothing");
}

/* ---- datasets and attributes ----------------------------------------------------------------- */

hid_t mpsi_h5_timeless(void) {
  const hid_t list = H5Pcreate(H5P_DATASET_CREATE);
  if (list < 0 || H5Pset_obj_track_times(list, false) >= 0) return list;
  H5Pclose(list);
  return -1;
}

hid_t mpsi_h5_dataset(hid_t group, const char *name, hid_t type, hid_t space) {
  const hid_t list = space < 0 ? -1 : mpsi_h5_timeless();
  const hid_t dataset =
      list < 0 ? -1 : H5Dcreate2(group, name, type, space, H5P_DEFAULT, list, H5P_DEFAULT);
  if (list >= 0) H5Pclose(list);
  return dataset;
}

bool mpsi_h5_attribute(hid_t object, const char *name, hid_t type, hsize_t count,
                       const void *values) {
  const hid_t space = count ? H5Screate_simple(1, &count, NULL) : H5Screate(H5S_SCALAR);
  const hid_t attribute =
      space < 0 ? -1 : H5Acreate2(object, name, type, space, H5P_DEFAULT, H5P_DEFAULT);
  bool good = attribute >= 0 && H5Awrite(attribute, type, values) >= 0;
  if (attribute >= 0) good = H5Aclose(attribute) >= 0 && good;
  if (space >= 0) H5Sclose(space);
  return good;
}

bool mpsi_h5_attribute_text(hid_t object, const char *name, const char *text) {
  const hid_t type = H5Tcopy(H5T_C_S1);
  const size_t size = strlen(text) > 0 ? strlen(text) : 1;
  const bool good = type >= 0 && H5Tset_size(type, size) >= 0 &&
                    H5Tset_strpad(type, H5T_STR_NULLPAD) >= 0 &&
                    mpsi_h5_attribute(object, name, type, 0, text);
  if (type >= 0) H5Tclose(type);
  return good;
}
