/* thin.c - warning for bodies of thin parts that are solved without the bending stiffness of their
 * cells (bending.c). A part of n cells lacks 1/n^2 of its stiffness against bending, of which free
 * surfaces make up for a share. SPDX-License-Identifier: BSD-3-Clause */
#include "thin.h"
#include "implicit/base/implicit_solver.h"

#define THIN 8        /* cells: the error of a cantilever is .8 % there, with and without */
#define SLENDER 4     /* times as long as thick, at least */
#define LEAST_PART 20 /* warned from this fraction of the particles on: 1 of 20 */

/* Cells in a row along `axis` through particle i; counting ends beyond `most`. */
static int count_row(const mpsi_sites *sites, int64_t i, int axis, int most) {
  int count = 1;
  for (int up = 0; up < 2; up++)
    for (int64_t j = i; count <= most && (j = mpsi_elastic_beside(sites, j, axis, up)) >= 0;)
      count++;
  return count;
}

/* Cells through the thickness at particle i, at most THIN; 0 where the body is thick or short. */
static int count_through(const mpsi_sites *sites, int dim, int64_t i) {
  int least = 0;
  for (int axis = 0; axis < dim; axis++) {
    const int n = count_row(sites, i, axis, THIN);
    if (n > THIN || (least && n >= least)) continue;
    for (int other = 0; other < dim; other++)
      if (other != axis && count_row(sites, i, other, SLENDER * n) >= SLENDER * n) least = n;
  }
  return least;
}

mps_status mpsi_elastic_warn_of_thin_parts(mps_elastic *e, const char *function) {
  mpsi_sites *sites = NULL;
  int64_t count[THIN + 1] = {0}, thin = 0;
  int common = 0;
  if (e->warned_thin || !e->conservative || !isnan(e->def.bending) || e->bending) return MPS_OK;
  MPSI_TRY(mpsi_elastic_open_sites(e, function, &sites));
  for (int64_t i = 0; i < e->n; i++) count[count_through(sites, e->dim, i)]++;
  mpsi_elastic_close_sites(e, sites);
  e->warned_thin = true;
  for (int n = 1; n <= THIN; n++) {
    thin += count[n];
    if (count[n] > count[common] || !common) common = n;
  }
  if (thin * LEAST_PART < e->n) return MPS_OK;
  mpsi_log(e->context, MPS_CONTEXT_LOG_WARNING,
           "%lld of %lld particles are in slender parts of few cells through their thickness, most "
           "of %d: without `bending` they lack up to %.3g %% of the stiffness against bending; set "
           "it to 1 where parts bend (0 to solve without, and without this warning)",
           (long long)thin, (long long)e->n, common, 100.0 / (common * common));
  return MPS_OK;
}
