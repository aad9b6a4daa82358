/* defs.h - defaults and first sizes of the definition structures of implicit elasticity.
 * SPDX-License-Identifier: BSD-3-Clause */
#ifndef MPSI_IMPLICIT_DEFS_H
#define MPSI_IMPLICIT_DEFS_H

#include <mps/elastic.h>

extern const mps_elastic_def mpsi_elastic_defaults;
extern const mps_newmark_def mpsi_newmark_defaults;

/* Sizes in the first release: the structures may only grow. */
#define MPSI_ELASTIC_DEF_MINIMUM (offsetof(mps_elastic_def, first_moment) + sizeof(int32_t))
#define MPSI_NEWMARK_DEF_MINIMUM (offsetof(mps_newmark_def, gamma) + sizeof(double))

#endif
