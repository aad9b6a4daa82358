/* hdf5_headers.h - the headers of HDF5. SPDX-License-Identifier: BSD-3-Clause */
#pragma once

#define H5_USE_110_API /* newer versions of HDF5 have these forms of the functions */
#include <hdf5.h>
#if H5_VERSION_GE(1, 14, 0)
#include <H5FDdevelop.h>
#endif
