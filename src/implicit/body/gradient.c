/* gradient.c - the displacement gradient at particles, G_i of operator.c, from the sites of
 * lattice.c and the joints of joints.c; and its transpose, which makes nodal forces of a load's
 * first moment. SPDX-License-Identifier: BSD-3-Clause */
#include "gradient.h"
#include "implicit/base/implicit_solver.h"

#include <string.h>

typedef struct gradient_task {
  mps_elastic *e;
  const double *u;
  double *gradient;
} gradient_task;

static void gradient_at(void *task, int64_t i) {
  const gradient_task *t = task;
  const int d = t->e->dim;
  int64_t sites[MPSI_STENCIL_MAX];
  double g[MPSI_STENCIL_MAX][3], *G = t->gradient + mpsi_elastic_slot(t->e, i) * d * d;
  const int32_t m = mpsi_elastic_stencil(t->e, i, sites, g);
  memset(G, 0, (size_t)(d * d) * sizeof *G);
  /* Differences, so that a rigid translation gives exactly zero. */
  for (int32_t a = 1; a < m; a++)
    for (int c = 0; c < d; c++) {
      const double du = t->u[sites[a] * d + c] - t->u[i * d + c];
      for (int b = 0; b < d; b++) G[c * d + b] += du * g[a][b];
    }
}

void mpsi_elastic_gradients(mps_elastic *e, const double *u, double *gradient) {
  gradient_task task = {.e = e, .u = u, .gradient = gradient};
  mpsi_elastic_for_span(e, e->span[(int)e->def.radius_ratio + 3], gradient_at, &task);
  mpsi_elastic_joint_gradients(e, u, gradient);
}

void mpsi_elastic_spread(const mps_elastic *e, int64_t i, const double (*moment)[3], double *f) {
  const int d = e->dim;
  int64_t sites[MPSI_STENCIL_MAX];
  double g[MPSI_STENCIL_MAX][3];
  if (mpsi_elastic_at_joint(e, i)) {
    mpsi_wide w;
    mpsi_elastic_wide_gradient(e, i, &w);
    for (int32_t a = 0; a < w.count; a++)
      for (int c = 0; c < d; c++)
        for (int b = 0; b < d; b++)
          for (int k = 0; k < d; k++) f[w.site[a] * d + k] += moment[c][b] * w.c[a][c * d + b][k];
    return;
  }
  const int32_t m = mpsi_elastic_stencil(e, i, sites, g);
  for (int32_t a = 0; a < m; a++)
    for (int c = 0; c < d; c++)
      for (int b = 0; b < d; b++) f[sites[a] * d + c] += moment[c][b] * g[a][b];
}
