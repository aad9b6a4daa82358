/* gauges.c - level gauges of mps-flume: where they stand by default, and which of them lie before
 * and behind what changes the waves: structure, body, rock, another bed, damping zone.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "flume.h"

#include <math.h>

#define LEVEL 0.02 /* of the depth: change of the bed that waves feel little of */

/* The bed from where it leaves the height of the maker's foot to where it has that of its end: the
 * depth is another one there, and so are the wave numbers. */
static void find_change_of_bed(const flume *m, double obstacle[2]) {
  const flume_shapes *p = &m->shape;
  const double most = LEVEL * m->s.depth;
  for (int k = p->bed - 1; k > 0; k--) {
    const double *a = p->bed_point[k - 1], *b = p->bed_point[k];
    if (fabs(b[1]) > most) obstacle[0] = fmin(obstacle[0], a[0]);
    if (fabs(a[1] - p->bed_point[p->bed - 1][1]) > most) obstacle[1] = fmax(obstacle[1], b[0]);
  }
}

/* Start and end (m) of structure, body, rock, change of the bed and damping zone. Of a flume
 * without any: its end. */
static void find_obstacle(const flume *m, double obstacle[2]) {
  const flume_shapes *p = &m->shape;
  obstacle[0] = m->toe, obstacle[1] = 0.0;
  if (flume_has_structure(m) || m->s.wall == FLUME_VERTICAL)
    obstacle[1] = flume_is_open(m) || m->s.wall == FLUME_VERTICAL ? m->outlet : m->heel[0];
  for (int k = 0; k < p->body; k++) obstacle[1] = fmax(obstacle[1], p->body_point[k][0]);
  for (int k = 0; k < p->rocks; k++)
    for (int j = 0; j < p->rock[k].corners; j++) {
      obstacle[0] = fmin(obstacle[0], p->rock[k].corner[j][0]);
      obstacle[1] = fmax(obstacle[1], p->rock[k].corner[j][0]);
    }
  find_change_of_bed(m, obstacle);
  if (m->s.absorb != FLUME_ZONE) return;
  obstacle[0] = fmin(obstacle[0], m->outlet - m->s.zone * m->wave_length);
  obstacle[1] = m->outlet;
}

/* Four at unequal distances, the last a wave length before the end, the structure or the zone;
 * where rock lies there, before it. */
static void place(flume *m, double before) {
  static const double part[] = {0.0, 0.1, 0.27, 0.47};
  flume_settings *s = &m->s;
  double last = fmax(m->toe - m->wave_length, 0.5 * m->toe);
  if (m->s.absorb == FLUME_ZONE) last = fmin(last, before);
  if (last > before) last = fmax(before - m->wave_length, 0.5 * before);
  for (int k = 0; k < 4; k++) s->gauge[k] = last - (0.47 - part[k]) * m->wave_length;
  for (int k = 0; k < 4; k++) /* on the lattice, apart */
    s->gauge[k] = fmax(round(s->gauge[k] / s->spacing), k + 1.0) * s->spacing;
  for (int k = 1; k < 4; k++) s->gauge[k] = fmax(s->gauge[k], s->gauge[k - 1] + s->spacing);
  m->gauges = 4;
}

void flume_place_gauges(flume *m) {
  double obstacle[2];
  find_obstacle(m, obstacle);
  if (m->gauges == 0) place(m, obstacle[0]);
  m->fronts = m->rears = 0;
  for (int g = 0; g < m->gauges; g++) { /* the default ones are rounded to the lattice */
    if (m->s.gauge[g] <= obstacle[0] + 0.51 * m->s.spacing)
      m->front[m->fronts++] = g;
    else if (m->s.gauge[g] >= obstacle[1] && m->s.absorb != FLUME_ZONE)
      m->rear[m->rears++] = g;
  }
}
