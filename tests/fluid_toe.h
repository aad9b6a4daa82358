/* fluid_toe.h - still water between a wall at x = 0, a bed and the sloping face of a body that
 * stands on the bed, against hydrostatics. SPDX-License-Identifier: BSD-3-Clause */
#ifndef TESTS_FLUID_TOE_H
#define TESTS_FLUID_TOE_H

#include "test_fixture.h"

#include "fluid_tank.h"

typedef struct toe {
  double angle;    /* degrees of water between bed and face */
  double vertical; /* m, height of a vertical part of the face above the bed */
  int rows;        /* particles in the water's depth */
} toe;

#define TOE_DEPTH 0.4

/* The face at height y, m. */
static inline double toe_face(const toe *s, double foot, double y) {
  return foot - fmax(y - s->vertical, 0.0) / tan(s->angle * TANK_PI / 180.0);
}

/* Water up to where the particles are 0.45 l0 from the face, displaced by up to .05 l0; its volume
 * (m2) and the body. */
static inline double toe_fill(const toe *s, double foot, tank *t, mps_body **body) {
  const double l0 = TOE_DEPTH / s->rows, sine = sin(s->angle * TANK_PI / 180.0), top = 0.6;
  const double ends[2] = {toe_face(s, foot, 0.0), toe_face(s, foot, top)},
               back = fmax(ends[0], ends[1]);
  const double xy[] = {foot, 0.0,     back + 0.3, 0.0,  back + 0.3,
                       top,  ends[1], top,        foot, s->vertical};
  const mps_body_def at = mps_body_defaults();
  uint64_t seed = 5;
  USING(particles, mps_particles_create(context, &given, &t->water), .spacing = l0);
  OK(mps_body_create_polygon(context, &at, s->vertical > 0.0 ? 5 : 4, xy, body));
  for (int j = 0; j < s->rows; j++)
    for (int i = 0; (i + 0.5) * l0 < back; i++) {
      double p[2] = {(i + 0.5) * l0, (j + 0.5) * l0};
      const double off = (toe_face(s, foot, p[1]) - p[0]) * (p[1] > s->vertical ? sine : 1.0);
      if (off < 0.45 * l0) continue;
      for (int c = 0; c < 2; c++) {
        seed = seed * 6364136223846793005u + 1442695040888963407u;
        p[c] += 0.05 * l0 * ((double)(seed >> 11) * 0x1p-52 - 1.0);
      }
      OK(mps_particles_append(t->water, 1, p));
    }
  return (double)mps_particles_count(t->water) * l0 * l0;
}

/* The water's depth, when its volume has settled. */
static inline double toe_depth(const toe *s, double foot, double volume) {
  double low = 0.0, high = 2.0 * TOE_DEPTH;
  for (int k = 0; k < 60; k++) {
    const double y = 0.5 * (low + high), above = fmax(y - s->vertical, 0.0);
    const double area = foot * y - 0.5 * above * above / tan(s->angle * TANK_PI / 180.0);
    if (area < volume)
      low = y;
    else
      high = y;
  }
  return low;
}

/* Forces on body and bed, mean over the second half of `duration`, within `bar` of hydrostatics and
 * with a scatter of less than `scatter` of that. */
static inline void toe_check(const toe *s, double duration, double bar, double scatter) {
  scoped_tank t = {NULL, NULL};
  scoped_body *body = NULL;
  mps_reaction r;
  mps_fluid_report report;
  const double slope = 1.0 / tan(s->angle * TANK_PI / 180.0);
  const double foot = 2.0 * TOE_DEPTH + fmax(slope, 0.0) * TOE_DEPTH;
  const double volume = toe_fill(s, foot, &t, &body);
  USING(fluid, mps_fluid_create(context, t.water, &given, &t.fluid), .level = TOE_DEPTH);
  const int32_t bed = tank_wall(t.fluid, 0.0, 0.0, 0.0, 1.0, NULL);
  const int32_t left = tank_wall(t.fluid, 0.0, 0.0, 1.0, 0.0, NULL);
  scoped_contact *contact = tank_body(t.fluid, body, MPS_CONTACT_MOVER_OTHER);
  double mean[3] = {0.0, 0.0, 0.0}, square = 0.0, opposite = 0.0;
  int samples = 0;
  while (mps_fluid_time(t.fluid) < duration) {
    OK(mps_fluid_step(t.fluid, 1));
    if (mps_fluid_time(t.fluid) < 0.5 * duration) continue;
    OK(mps_contact_get_reaction(contact, -1, &r));
    for (int c = 0; c < 2; c++) mean[c] += r.force[c];
    square += r.force[0] * r.force[0];
    OK(mps_fluid_get_reaction(t.fluid, bed, &r));
    mean[2] += r.force[1];
    OK(mps_fluid_get_reaction(t.fluid, left, &r));
    opposite += r.force[0];
    samples++;
  }
  for (int c = 0; c < 3; c++) mean[c] /= samples;
  const double weight = 1000.0 * TANK_G;
  /* an acute corner holds no particles, so that the water stands higher: as on the wall opposite */
  const double depth =
      s->angle < 90.0 ? sqrt(2.0 * opposite / (samples * weight)) : toe_depth(s, foot, volume);
  const double above = depth - s->vertical;
  const double exact[3] = {0.5 * weight * depth * depth, 0.5 * weight * above * above * slope,
                           weight * depth * foot};
  const double deviation = sqrt(fmax(square / samples - mean[0] * mean[0], 0.0));
  OK(mps_fluid_get_report(t.fluid, &report));
  print_message("%3.0f degrees%s, %d rows: force on the body %+.2f %% +- %.2f %%, %+.2f %%, on the "
                "bed %+.2f %%; collisions %lld, speeds cut %lld\n",
                s->angle, s->vertical > 0.0 ? ", vertical toe" : "", s->rows,
                100.0 * (mean[0] / exact[0] - 1.0), 100.0 * deviation / exact[0],
                100.0 * (mean[1] - exact[1]) / hypot(exact[0], exact[1]),
                100.0 * (mean[2] / exact[2] - 1.0), (long long)report.collisions,
                (long long)report.limited);
  const double unit = hypot(exact[0], exact[1]);
  NEAR(mean[0], exact[0], bar * unit);
  NEAR(mean[1], exact[1], bar * unit);
  NEAR(mean[2], exact[2], 0.02 * exact[2]);
  assert_true(deviation < scatter * unit);
}

#endif
