/* results.c - load.csv and summary.json, and their report on the terminal.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "pile.h"

#include "common/plot.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

/* ---- engineering estimates ------------------------------------------------------------------- */

double pile_beta_shaft(const pile *p, double depth) {
  return PUSH_PI * p->outer * p->k0 * p->s.friction * p->s.density * PILE_GRAVITY * depth * depth;
}

double pile_nq(const pile *p) {
  const double phi = p->s.phi * PUSH_PI / 180.0;
  return exp(PUSH_PI * tan(phi)) * pow(tan(0.25 * PUSH_PI + 0.5 * phi), 2.0);
}

static double tip_nq(const pile *p, const push_row *row) {
  const double base = PUSH_PI * (p->outer * p->outer - p->inner * p->inner);
  if (!(row->depth > 0.0)) return NAN; /* the tip has not reached the soil */
  return row->smooth[PILE_TIP] / base / (p->s.density * PILE_GRAVITY * row->depth);
}

/* ---- roughness ------------------------------------------------------------------------------- */

/* Over the second half of the path: rms of the rows about their smooth curve, and rms of the single
 * steps about their rows, each over the mean total force. */
static void find_roughness(const pile *p, double *rows, double *steps) {
  double off = 0.0, jitter = 0.0, sum = 0.0;
  int64_t count = 0;
  for (int64_t i = 0; i < p->push.rows; i++) {
    const push_row *r = &p->push.row[i];
    if (r->depth < 0.5 * p->s.depth) continue;
    const double d = r->force[PILE_TOTAL] - r->smooth[PILE_TOTAL];
    off += d * d;
    jitter += r->jitter * r->jitter;
    sum += r->smooth[PILE_TOTAL];
    count++;
  }
  *rows = count && sum > 0.0 ? sqrt(off * (double)count) / sum : NAN;
  *steps = count && sum > 0.0 ? sqrt(jitter * (double)count) / sum : NAN;
}

/* Mean forces over the last fifth of the path (N): the same path whatever the grid, to compare. */
static void find_means(const pile *p, double *mean) {
  int64_t count = 0;
  for (int k = 0; k < PUSH_FORCES; k++) mean[k] = 0.0;
  for (int64_t i = 0; i < p->push.rows; i++) {
    if (!(p->push.row[i].depth > 0.8 * p->s.depth)) continue;
    for (int k = 0; k < PUSH_FORCES; k++) mean[k] += p->push.row[i].force[k];
    count++;
  }
  for (int k = 0; k < PUSH_FORCES; k++) mean[k] = count ? mean[k] / (double)count : NAN;
}

/* ---- files ----------------------------------------------------------------------------------- */

static bool write_load(app *a, const pile *p) {
  output f;
  if (!csv_open(&f, a, p->s.out, "load.csv",
                "depth_m,total_N,tip_N,inside_N,outside_N,total_smooth_N,tip_smooth_N,"
                "inside_smooth_N,outside_smooth_N,step_rms_N,plug_height_m?,plug_level_m?,"
                "outside_beta_N"))
    return false;
  static const int order[PUSH_FORCES] = {PILE_TOTAL, PILE_TIP, PILE_INSIDE, PILE_OUTSIDE};
  for (int64_t i = 0; i < p->push.rows; i++) {
    const push_row *r = &p->push.row[i];
    double row[13] = {r->depth};
    for (int k = 0; k < PUSH_FORCES; k++) {
      row[1 + k] = r->force[order[k]];
      row[5 + k] = r->smooth[order[k]];
    }
    row[9] = r->jitter;
    row[10] = r->plug;
    row[11] = r->plug - r->depth;
    row[12] = r->depth > 0.0 ? pile_beta_shaft(p, r->depth) : 0.0;
    csv_row(&f, 13, row);
  }
  return output_close(&f);
}

static void write_settings(output *f, const pile *p) {
  const pile_settings *s = &p->s;
  JSON_NUMBERS(f, {"cell", s->h}, {"flip_time", s->flip_time}, {"rate", s->rate},
               {"friction", s->friction}, {"phi", s->phi});
  sand_write(f, &s->voids, s->psi);
  json_text(f, "cone", pile_cone_name(s));
  JSON_NUMBERS(f, {"inner_diameter", s->inner_diameter}, {"wall", s->wall});
  if (p->s.contact == MPS_CONTACT_METHOD_PENALTY) json_number(f, "penalty", p->penalty);
  json_number(f, "dt", p->dt);
}

static bool write_summary(app *a, const pile *p, const push_row *end) {
  double rows, steps, mean[PUSH_FORCES];
  output f;
  find_roughness(p, &rows, &steps);
  find_means(p, mean);
  if (!mpm_model_summary(a, &p->m, p->s.out, &f)) return false;
  write_settings(&f, p);
  JSON_NUMBERS(&f, {"depth", end->depth}, {"force_total", end->smooth[PILE_TOTAL]},
               {"force_tip", end->smooth[PILE_TIP]}, {"force_inside", end->smooth[PILE_INSIDE]},
               {"force_outside", end->smooth[PILE_OUTSIDE]}, {"mean_total", mean[PILE_TOTAL]},
               {"mean_tip", mean[PILE_TIP]}, {"mean_inside", mean[PILE_INSIDE]},
               {"mean_outside", mean[PILE_OUTSIDE]}, {"roughness", rows},
               {"roughness_steps", steps}, {"plug_height", end->plug},
               {"plug_level", end->plug - end->depth});
  json_integer(&f, "particles_inside_pile", p->push.seen.inside);
  JSON_NUMBERS(&f, {"deepest_inside_pile", p->push.seen.deepest},
               {"volume_ratio_max", p->push.seen.ratio_max},
               {"volume_ratio_min", p->push.seen.ratio_min}, {"rest_speed", p->push.seen.speed},
               {"outside_beta", end->depth > 0.0 ? pile_beta_shaft(p, end->depth) : NAN},
               {"tip_nq", tip_nq(p, end)}, {"nq_prandtl", pile_nq(p)});
  json_end(&f);
  return output_close(&f);
}

static void tell(const pile *p, const push_row *end) {
  printf("depth %.4g m: %.5g N = tip %.5g + inside %.5g + outside %.5g N", end->depth,
         end->smooth[PILE_TOTAL], end->smooth[PILE_TIP], end->smooth[PILE_INSIDE],
         end->smooth[PILE_OUTSIDE]);
  if (isfinite(end->plug))
    printf("; plug %.4g m high, %+.3g m against the ground", end->plug, end->plug - end->depth);
  printf("\n");
  double mean[PUSH_FORCES];
  find_means(p, mean);
  if (isfinite(mean[PILE_TOTAL]))
    printf("mean of the last fifth: %.5g N = tip %.5g + inside %.5g + outside %.5g N\n",
           mean[PILE_TOTAL], mean[PILE_TIP], mean[PILE_INSIDE], mean[PILE_OUTSIDE]);
  if (isfinite(p->push.seen.ratio_min))
    printf("V/V0 %.4g to %.4g, particles inside the wall: %lld\n", p->push.seen.ratio_min,
           p->push.seen.ratio_max, (long long)p->push.seen.inside);
  sand_print(&p->s.voids, p->s.psi);
}

bool pile_finish(app *a, void *user) {
  pile *p = user;
  const push_row *end = &p->push.row[p->push.rows - 1];
  if (!write_load(a, p) || !write_summary(a, p, end) || !pile_write_frames(a, p) ||
      !pile_draw(a, p))
    return false;
  app_tell_results(a, p->s.out);
  tell(p, end);
  return true;
}
