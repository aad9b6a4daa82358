/* embree.h - the headers of Embree 3 or 4. SPDX-License-Identifier: BSD-3-Clause */
#pragma once

#if MPSI_EMBREE == 3
#include <embree3/rtcore.h>
#else
#include <embree4/rtcore.h>
#endif
