/* wall.c - one wall: the nodes at which its motion is given, values between them, and points
 * mirrored at it. SPDX-License-Identifier: BSD-3-Clause */
#include "wall.h"
#include "fluid/boundary/polyline.h"

double mpsi_fluid_between(const mpsi_fluid_wall *w, const double *values, double along) {
  const int64_t last = w->nodes - 1;
  if (!(along > w->node[0])) return values[0];
  if (along >= w->node[last]) return values[last];
  int64_t low = 0, high = last;
  while (high - low > 1) {
    const int64_t middle = (low + high) / 2;
    if (w->node[middle] <= along)
      low = middle;
    else
      high = middle;
  }
  const double part = (along - w->node[low]) / (w->node[high] - w->node[low]);
  return values[low] + part * (values[high] - values[low]);
}

/* Places the nodes (points in space, 3 values each; none: one node) along the wall. */
mps_status mpsi_fluid_make_motion(mps_fluid *f, const char *function, mpsi_fluid_wall *w,
                                  int64_t nodes, const double *points) {
  enum { ARRAYS = 9 };
  w->nodes = nodes > 0 ? nodes : 1;
  w->motion = mpsi_alloc(f->context, ARRAYS * w->nodes, sizeof *w->motion);
  if (!w->motion) return mpsi_fail_memory(f->context, function, ARRAYS * 8 * (size_t)w->nodes);
  double *const part = w->motion;
  const int64_t n = w->nodes;
  w->now = (mpsi_fluid_motion){part, part + n, part + 2 * n};
  w->next = (mpsi_fluid_motion){part + 3 * n, part + 4 * n, part + 5 * n};
  w->node = part + 6 * n;
  w->mean = part + 7 * n;
  w->order = (int64_t *)(part + 8 * n);
  for (int64_t k = 0; k < nodes; k++) {
    const double along = mpsi_fluid_along(w, points[3 * k], points[3 * k + 1]);
    int64_t at = k;
    for (; at > 0 && w->node[at - 1] > along; at--)
      w->node[at] = w->node[at - 1], w->order[at] = w->order[at - 1];
    w->node[at] = along, w->order[at] = k;
  }
  for (int64_t k = 1; k < n; k++)
    if (!(w->node[k] - w->node[k - 1] > 1e-6 * f->l0))
      return mpsi_fail(f->context, function, MPS_ERROR_ARGUMENT,
                       "nodes %lld and %lld of the boundary are %g m apart along it, must be more "
                       "than l0/1e6",
                       (long long)w->order[k - 1], (long long)w->order[k],
                       w->node[k] - w->node[k - 1]);
  return MPS_OK;
}

/* The segments are walls themselves, without polylines. */
static void drop_polyline(mps_fluid *f, mpsi_fluid_polyline *line) {
  if (!line) return;
  for (int64_t k = 0; k < line->count; k++) mpsi_free(f->context, line->segment[k].wall.motion);
  mpsi_free(f->context, line);
}

void mpsi_fluid_drop_wall(mps_fluid *f, mpsi_fluid_wall *w) {
  drop_polyline(f, w->line);
  mps_signal_destroy(&w->signal);
  mpsi_free(f->context, w->motion);
  *w = (mpsi_fluid_wall){0};
}

void mpsi_fluid_mirror_point(const mps_fluid *f, mpsi_fluid_flips flips, double *x) {
  const double from[2] = {x[0], x[1]};
  MPSI_FLUID_FLIPS(k, flips) {
    const mpsi_fluid_wall *w = &f->wall[flips.wall[k]];
    const double s = mpsi_fluid_of_wall(w, w->now.s, from[0], from[1]);
    const double d = (x[0] - w->at[0]) * w->normal[0] + (x[1] - w->at[1]) * w->normal[1] - s;
    x[0] -= 2.0 * d * w->normal[0], x[1] -= 2.0 * d * w->normal[1];
  }
}
