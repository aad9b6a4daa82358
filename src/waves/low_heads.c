/* low_heads.c - overtopping by heads too low for a count of what passes, from the level at a wall:
 * of each event, an excursion of the level above the crest, whose highest head is that of the
 * definition or less, the flow of a free overfall over a broad crest (critical depth, Poleni),
 *
 *   q = (2/3)^(3/2) g^(1/2) h^(3/2),   h + q/(g depth)^(1/2) = head,
 *
 * the second as a discharge q over the wall sends a long wave of the height -q/(g depth)^(1/2) back
 * from it. SPDX-License-Identifier: BSD-3-Clause */
#include "waves_private.h"

#include <mps/experimental/wave_loads.h>

#define ITERATIONS 60 /* of Newton's, which converges from above: a few are needed */

/* ---- events ---------------------------------------------------------------------------------- */

/* Discharge (m2/s) under a head: the root s = h^(1/2) of s^2 + law/(g depth)^(1/2) s^3 = head. */
static double flow(const mps_overtopping_def *d, double head) {
  const double law = pow(2.0 / 3.0, 1.5) * sqrt(d->gravity);
  const double drop = isnan(d->depth) ? 0.0 : law / sqrt(d->gravity * d->depth);
  if (!(head > 0.0)) return 0.0;
  double s = sqrt(head);
  for (int n = 0; n < ITERATIONS; n++) {
    const double change = (s * s * (1.0 + drop * s) - head) / (s * (2.0 + 3.0 * drop * s));
    s -= change;
    if (fabs(change) <= 1e-15 * s) break;
  }
  return law * s * s * s;
}

typedef struct event {
  int64_t begin, end; /* its samples, the last one behind it; begin == samples: none */
  double highest;     /* m */
} event;

/* The first event from sample `k` on. */
static event find_event(const mps_overtopping_def *d, int64_t k) {
  while (k < d->samples && !(d->heads[k] > 0.0)) k++;
  event e = {k, k, 0.0};
  for (; k < d->samples; k++) {
    const double head = d->heads[k];
    if (head > 0.0) e.end = k + 1, e.highest = fmax(e.highest, head);
    if (d->times[k] > d->times[e.end - 1] + d->pause) break;
  }
  return e;
}

/* By the rule of trapezia, from the sample before it to the one behind it. */
static double volume_of(const mps_overtopping_def *d, const event *e) {
  const int64_t first = e->begin > 0 ? e->begin : 1;
  const int64_t last = e->end < d->samples ? e->end : d->samples - 1;
  double sum = 0.0;
  for (int64_t k = first; k <= last; k++)
    sum +=
        0.5 * (d->times[k] - d->times[k - 1]) * (flow(d, d->heads[k - 1]) + flow(d, d->heads[k]));
  return sum;
}

/* The volume so far jumps with the last sample of each thin event; its first `count` samples. */
static void add_up(const mps_overtopping_def *d, int64_t count, double *thin,
                   mps_overtopping *out) {
  int64_t written = 0;
  for (event e = find_event(d, 0), next; e.begin < d->samples; e = next) {
    next = find_event(d, e.end);
    out->events++;
    out->highest = fmax(out->highest, e.highest);
    for (; written < e.end - 1 && written < count; written++) thin[written] = out->thin;
    if (e.highest > d->resolved) continue;
    const int64_t from = e.begin > 0 ? e.begin - 1 : 0;
    const int64_t to = next.begin < d->samples ? next.begin - 1 : d->samples - 1;
    const double counted = d->volumes ? d->volumes[to] - d->volumes[from] : 0.0;
    out->thin_events++;
    out->thin += fmax(volume_of(d, &e) - fmax(counted, 0.0), 0.0);
  }
  for (; written < count; written++) thin[written] = out->thin;
  if (d->volumes) out->counted = d->volumes[d->samples - 1] - d->volumes[0];
}

mps_status mps_overtopping_find_sized(mps_context *context, const mps_overtopping_def *user_def,
                                      int64_t capacity, double *thin, mps_overtopping *out,
                                      size_t size) {
  if (!context) return mpsi_null(__func__, "context");
  if (!user_def) return mpsi_fail(context, __func__, MPS_ERROR_ARGUMENT, "def is NULL");
  if (capacity < 0)
    return mpsi_fail(context, __func__, MPS_ERROR_ARGUMENT, "capacity is %lld, must be >= 0",
                     (long long)capacity);
  mps_overtopping_def d = mps_overtopping_defaults();
  mps_overtopping r = {.counted = 0.0};
  MPSI_TRY(MPSI_DEF_READ(context, __func__, mps_overtopping_def, user_def, &d));
  MPSI_TRY(mpsi_out_check(context, __func__, out, size));
  add_up(&d, !thin ? 0 : capacity < d.samples ? capacity : d.samples, thin, &r);
  return mpsi_out_write(context, __func__, out, size, &r, sizeof r);
}
