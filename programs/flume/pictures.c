/* pictures.c - pictures of mps-flume: levels with their target, spectra, force, pressures at the
 * largest force, discharge. SPDX-License-Identifier: BSD-3-Clause */
#include "flume.h"

#include "common/plot.h"

#include <math.h>

enum { SHOWN = 3 };   /* gauges */
#define IN_METRES 0.5 /* m: waves from this height on have levels in m, of prototypes */

/* First, middle and last gauge, the last 12 periods. */
static bool draw_levels(app *a, const flume *m) {
  const double last = m->samples ? m->sample[m->samples - 1].t : 1.0;
  const int shown = m->gauges < SHOWN ? m->gauges : SHOWN;
  output f;
  if (shown == 0) return true;
  if (!plot_begin(&f, a, m->s.out, "levels")) return false;
  output_text(
      &f,
      "shown = %d; from = %.9g; end = %.9g; unit = %g; high = %.9g\narray gauge[shown]; array "
      "at[shown]\n",
      shown, fmax(last - 12.0 * m->s.period, 0.0), last, m->s.height >= IN_METRES ? 1.0 : 1e3,
      m->s.height);
  for (int k = 0; k < shown; k++) {
    const int g = shown == 1 ? 0 : k * (m->gauges - 1) / (shown - 1);
    output_text(&f, "gauge[%d] = %d; at[%d] = %.9g\n", k + 1, g, k + 1, m->s.gauge[g]);
  }
  return plot_end(&f, m->s.out, "levels", "flume/levels");
}

static bool draw_spectrum(app *a, const flume *m, const flume_figures *g) {
  if (!g->separated || m->s.waves == FLUME_REGULAR) return true;
  return plot_draw(
      a, m->s.out, "spectrum", "flume/spectrum",
      "first = '%.1f to %.1f s: H_{m0} incident %.3g m, target %.3g m, reflection %.2f'", g->from,
      g->to, g->split.incident_height, g->target_height, g->split.reflection);
}

static bool draw_force(app *a, const flume *m, const flume_figures *g) {
  return !flume_is_loaded(m) ||
         plot_draw(a, m->s.out, "force", "flume/force", "end = %.9g; still = %.9g; goda = %.9g",
                   m->s.duration, g->force_still,
                   g->has_goda ? g->force_still + g->goda.force : NAN);
}

static bool draw_discharge(app *a, const flume *m, const flume_figures *g) {
  return !flume_is_open(m) ||
         plot_draw(a, m->s.out, "discharge", "flume/discharge",
                   "end = %.9g; from = %.9g; eurotop = %.9g; thin = %d", m->s.duration, g->from,
                   g->has_eurotop ? g->eurotop.discharge : NAN, (int)(g->thin != 0));
}

/* At the largest force. Goda's trapezoids: from the base over the still level to eta*, or the
 * crest. */
static bool draw_pressures(app *a, const flume *m, const flume_figures *g) {
  const bool body = flume_has_body(m), upright = m->s.wall == FLUME_VERTICAL;
  const double bed = upright ? m->ground[m->grounds - 1][1] : 0.0;
  const double reach = g->goda.reach, top = fmin(reach, upright ? INFINITY : g->crest);
  output f;
  if (!flume_is_loaded(m) || m->look.faces == 0) return true;
  if (!plot_begin(&f, a, m->s.out, "pressures")) return false;
  if (g->has_goda)
    output_text(&f, "$goda << EOD\np,y\n%.6g,%.6g\n%.6g,%.6g\n%.6g,%.6g\nEOD\n", 1e-3 * g->goda.p3,
                body ? m->heel[1] : bed, 1e-3 * g->goda.p1, m->s.depth,
                top < reach ? 1e-3 * g->goda.p4 : 0.0, m->s.depth + top);
  output_text(&f,
              "t = %.9g; body = %d; bedded = %d; goda = %d; pu = %.9g\nbase = %.9g; heel = %.9g; "
              "front = %.9g; half = %.9g; foot = %.9g\n",
              m->look.t, body, m->bedded, g->has_goda, 1e-3 * g->goda.pu, m->heel[1], m->heel[0],
              g->front, 0.5 * m->s.spacing, 1e-3 * g->foot_peak);
  return plot_end(&f, m->s.out, "pressures", "flume/pressures");
}

bool flume_draw(app *a, const flume *m, const flume_figures *g) {
  return draw_levels(a, m) && draw_spectrum(a, m, g) && draw_force(a, m, g) &&
         draw_pressures(a, m, g) && draw_discharge(a, m, g) && flume_draw_water(a, m);
}
