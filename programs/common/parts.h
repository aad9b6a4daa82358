/* parts.h - particle sets that lie in parts on the ranks of a program from the first fill on
 * (mps_domain_create_particles), so that memory at the start falls with the number of ranks. In one
 * process, where the domain is NULL, they are the sets of mps_particles_create. All functions are
 * collective. SPDX-License-Identifier: BSD-3-Clause */
#pragma once

#include <mps/experimental/domain.h>

mps_status parts_create(mps_context *context, mps_domain *domain, const mps_particles_def *def,
                        mps_particles **out);

/* Sum over all ranks of a number of each, all together below 2^53. */
mps_status parts_sum(mps_domain *domain, int64_t *value);

/* The id of the particle of all ranks that is nearest to each of `count` places (`dim` numbers
 * each, m), the lowest of several at the same distance, as mps_particles_nearest finds it in one
 * process; -1 where there is none. position[k * dim + c] is where it lies (m), on all ranks. */
mps_status parts_nearest(mps_domain *domain, mps_particles *particles, int32_t count,
                         const double *places, int64_t *ids, double *position);
