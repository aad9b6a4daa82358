/* first_use.h - libraries that libmps.so loads when they are first needed: HDF5 and Embree, each
 * behind a module that is linked to it and holds one table of its functions (src/FirstUse.cmake).
 * libmps.a holds the tables itself. SPDX-License-Identifier: BSD-3-Clause */
#pragma once

#include <stddef.h>

/* The table of that module; NULL: *why says what is missing. The module stays for the life of the
 * process. */
const void *mpsi_hdf5_find(char *why, size_t size);
const void *mpsi_embree_find(char *why, size_t size);
