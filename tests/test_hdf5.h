/* test_hdf5.h - what the tests of HDF5 files share: a census of handles, and a full disk.
 * SPDX-License-Identifier: BSD-3-Clause */
#ifndef MPS_TEST_HDF5_H
#define MPS_TEST_HDF5_H

#include "test_common.h"

#include <hdf5.h>

#include <signal.h>
#include <sys/resource.h>

/* How many files, groups, datasets and attributes are open. */
static inline int64_t test_hdf5_open(void) {
  return (int64_t)H5Fget_obj_count((hid_t)H5F_OBJ_ALL, H5F_OBJ_ALL);
}

/* Identifiers of the kind of `newest`, which is closed, that are in use: their low 56 bits count
 * up. */
static inline int64_t test_hdf5_in_use(hid_t newest, herr_t (*close)(hid_t)) {
  const hid_t first = newest & ~(((hid_t)1 << 56) - 1);
  int64_t sum = 0;
  assert_true(newest > 0 && close(newest) >= 0);
  for (hid_t id = first; id < newest; id++) sum += H5Iis_valid(id) > 0;
  return sum;
}

/* How many things of every kind the program holds of HDF5. */
static inline int64_t test_hdf5_handles(void) {
  return test_hdf5_open() + test_hdf5_in_use(H5Screate(H5S_SCALAR), H5Sclose) +
         test_hdf5_in_use(H5Tcopy(H5T_C_S1), H5Tclose) +
         test_hdf5_in_use(H5Pcreate(H5P_DATASET_CREATE), H5Pclose);
}

/* No file may grow beyond `bytes` any more: the system refuses as a full disk does. 0: no limit. */
static inline void test_disk_limit(int64_t bytes) {
  struct rlimit limit;
  signal(SIGXFSZ, SIG_IGN);
  assert_int_equal(getrlimit(RLIMIT_FSIZE, &limit), 0);
  limit.rlim_cur = bytes > 0 ? (rlim_t)bytes : limit.rlim_max;
  assert_int_equal(setrlimit(RLIMIT_FSIZE, &limit), 0);
}

#endif
