/* warnings.c - warnings of mps-flume before a run: waves of few spacings or that break on the way,
 * a record of other periods, gauges without use, a body without rock below, thin rock.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "flume.h"

#include <math.h>
#include <stdio.h>

/* Heights of waves in spacings. Heads of less than some .7 spacings do not pass a crest. */
#define LEAST_OF_WAVES 3.0
#define LEAST_OF_DISCHARGE 4.0
#define HIGHEST_OF_SEA 1.8       /* highest of some hundred waves over Hm0 */
#define LEAST_OF_ROCK 4.4        /* particles across (docs/limits.md) */
#define LEAST_OF_BAND 0.95       /* of the height of a record */
#define LEAST_OF_COLLISIONS 0.05 /* a step */
#define LONGEST 26.3             /* Ursell's number up to which second order holds, 8 pi^2/3 */

static void warn_of_spacing(app *a, const flume *m) {
  const flume_settings *s = &m->s;
  if (s->waves == FLUME_FILE) return;
  if (s->height < LEAST_OF_WAVES * s->spacing)
    app_warn(a, "the waves, %.3g m high, are lower than %g spacings of %g m: they will lose height",
             s->height, LEAST_OF_WAVES, s->spacing);
  if (flume_is_open(m) && s->height < LEAST_OF_DISCHARGE * s->spacing)
    app_warn(a,
             "the waves, %.3g m high, are lower than %g spacings of %g m: of the water that passes "
             "the crest small events will be lost, so that q is uncertain",
             s->height, LEAST_OF_DISCHARGE, s->spacing);
}

/* Regular waves beyond are refused by the library. */
static void warn_of_length(app *a, const flume *m) {
  const flume_settings *s = &m->s;
  const double ursell = s->height * m->wave_length * m->wave_length / pow(s->depth, 3.0);
  const bool sea = s->waves == FLUME_JONSWAP || s->waves == FLUME_PM || s->waves == FLUME_FOCUSED;
  if (sea && s->order != MPS_WAVES_THEORY_LINEAR && ursell >= LONGEST)
    app_warn(a,
             "height L^2/depth^3 of this sea is %.3g: from 26.3 on second order does not hold, and "
             "the maker's slow part is too large: --order linear",
             ursell);
}

/* Miche (1944), as for regular waves, which the library refuses then. */
static double breaking_height(const flume *m) {
  return 0.142 * m->wave_length * tanh(2.0 * WAVES_PI / m->wave_length * m->s.depth);
}

/* Waves that do not break have none; some pairs at the surface do not part again by themselves. */
void flume_warn_of_collisions(app *a, const flume *m) {
  const flume_settings *s = &m->s;
  const double highest = s->waves == FLUME_REGULAR || s->waves == FLUME_FOCUSED
                             ? s->height
                             : HIGHEST_OF_SEA * s->height;
  const double count = (double)m->report.collisions, steps = (double)mps_fluid_steps(m->fluid);
  if (flume_is_loaded(m) || m->shape.bed > 0 || m->shape.rocks > 0 || s->waves == FLUME_FILE)
    return;
  if (highest > breaking_height(m) || count < LEAST_OF_COLLISIONS * steps) return;
  app_warn(a, "%.0f collisions of particles in %.0f steps, in waves that do not break", count,
           steps);
}

static void warn_of_breaking(app *a, const flume *m) {
  const flume_settings *s = &m->s;
  const double most = breaking_height(m);
  if ((s->waves == FLUME_JONSWAP || s->waves == FLUME_PM) && HIGHEST_OF_SEA * s->height > most)
    app_warn(a,
             "the highest waves of this sea, some %.2g m (1.8 Hm0), are above the breaking height "
             "%.2g m: they break on the way, and Hm0 stays below that asked for",
             HIGHEST_OF_SEA * s->height, most);
  if (s->waves == FLUME_FOCUSED && s->height > most)
    app_warn(a,
             "the focused wave, twice its crest %.2g m, is above the breaking height %.2g m: it "
             "breaks before its focus",
             s->height, most);
}

/* The slowest of the peak's waves must have been sent before the focus. */
static void warn_of_focus(app *a, const flume *m) {
  const flume_settings *s = &m->s;
  const double kd = 2.0 * WAVES_PI / m->wave_length * s->depth;
  const double group = 0.5 * (1.0 + 2.0 * kd / sinh(2.0 * kd)) * m->wave_length / s->period;
  const double least = s->ramp + s->focus[0] / group;
  if (s->waves != FLUME_FOCUSED) return;
  if (s->focus[1] > s->duration)
    app_warn(a, "the focus at %.4g s comes after the end of the run, at %.4g s", s->focus[1],
             s->duration);
  if (s->focus[1] < least)
    app_warn(a,
             "the focus at %.4g s is too early: the waves of the peak need %.4g s to %.4g m, the "
             "rise of the maker included",
             s->focus[1], least, s->focus[0]);
}

static void warn_of_gauges(app *a, const flume *m) {
  for (int g = 0; g < m->gauges; g++) {
    bool counts = false;
    for (int k = 0; k < m->fronts; k++) counts = counts || m->front[k] == g;
    for (int k = 0; k < m->rears; k++) counts = counts || m->rear[k] == g;
    if (counts) continue;
    app_warn(
        a,
        "the gauge at %g m lies between the ends of structure, rock, a bed that is not level, or "
        "zone: incident and reflected waves are found without it",
        m->s.gauge[g]);
    break;
  }
  if (m->fronts < 2)
    app_warn(
        a,
        "incident and reflected waves need two gauges before structure, rock, a bed that is not "
        "level, or zone: there %s %d",
        m->fronts == 1 ? "is" : "are", m->fronts);
}

static void warn_of_end(app *a, const flume *m) {
  const bool piston = m->s.absorb == FLUME_ACTIVE && m->s.wall == FLUME_OPEN_END;
  if (!piston || flume_is_open(m) || flume_end_is_wet(m)) return;
  app_warn(a,
           "the bed is %.3g m high at the far end, with less than 2 spacings of water above it: no "
           "piston absorbs there",
           m->s.depth - flume_end_depth(m));
}

/* Of a region that reaches through the water: fewer particles across reflect too much. */
static void warn_of_rock(app *a, const flume *m) {
  for (int k = 0; k < m->shape.rocks; k++) {
    const flume_rock *r = &m->shape.rock[k];
    double left = INFINITY, right = -INFINITY, top = -INFINITY;
    for (int j = 0; j < r->corners; j++) {
      left = fmin(left, r->corner[j][0]), right = fmax(right, r->corner[j][0]);
      top = fmax(top, r->corner[j][1]);
    }
    const double across = (right - left) * sqrt(r->porosity) / m->s.spacing;
    if (top < m->s.depth || across >= LEAST_OF_ROCK) continue;
    app_warn(
        a,
        "the rock from %g to %g m is %.2g particles across, width porosity^1/2 / spacing: below "
        "%g its reflection is more than a tenth too high",
        left, right, across, LEAST_OF_ROCK);
  }
}

static void warn_of_record(app *a, const flume *m) {
  mps_waves_report r;
  if (m->s.waves != FLUME_FILE || mps_waves_get_report(m->waves, &r) != MPS_OK) return;
  if (r.height < LEAST_OF_BAND * m->record_height)
    app_warn(a,
             "the record has Hm0 %.4g m, its components from .6 to 2.5 times the frequency of "
             "--period, which the maker makes, %.4g m",
             m->record_height, r.height);
  if (r.repeat < m->s.duration * (1.0 - 1e-9))
    app_warn(a, "the record lasts %.4g s: it repeats itself until %.4g s", r.repeat, m->s.duration);
}

/* The terminal shows the first ones, summary.json all. */
void flume_warn(app *a, const flume *m) {
  warn_of_record(a, m);
  warn_of_length(a, m);
  warn_of_breaking(a, m);
  warn_of_focus(a, m);
  if (flume_has_body(m) && !m->bedded)
    app_warn(a, "there is no rock below the caisson: it is held where it is, and has no safeties");
  warn_of_end(a, m);
  warn_of_rock(a, m);
  warn_of_gauges(a, m);
  warn_of_spacing(a, m);
}
