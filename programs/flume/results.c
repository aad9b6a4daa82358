/* results.c - tables and summary of mps-flume.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "flume.h"

#include "common/compare.h"
#include "common/record.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* ---- tables ---------------------------------------------------------------------------------- */

/* Levels and the target of second order at each gauge. */
static bool write_gauges(app *a, const flume *m) {
  const size_t n = (size_t)m->samples;
  char names[1600] = "t_s";
  double *t = malloc(n * sizeof *t), *target = malloc(n * FLUME_GAUGES * sizeof *target);
  output f;
  bool good = t && target;
  if (!good) app_no_memory(a);
  for (int64_t k = 0; good && k < m->samples; k++) t[k] = m->sample[k].t;
  for (int g = 0; good && g < m->gauges; g++) {
    const size_t at = strlen(names);
    snprintf(names + at, sizeof names - at, ",level_at_%g_m?,target_at_%g_m", m->s.gauge[g],
             m->s.gauge[g]);
    good = app_check(a, mps_waves_get_levels(m->waves, m->s.gauge[g], m->samples, t, NULL,
                                             target + n * (size_t)g));
  }
  if (!good || !output_open(&f, a, m->s.out, "gauges.csv")) {
    free(t);
    free(target);
    return false;
  }
  csv_header(&f, names);
  for (int64_t k = 0; k < m->samples; k++) {
    double row[2 * FLUME_GAUGES + 1] = {m->sample[k].t};
    for (int g = 0; g < m->gauges; g++) {
      row[1 + 2 * g] = m->sample[k].level[g];
      row[2 + 2 * g] = target[n * (size_t)g + (size_t)k];
    }
    csv_row(&f, 2 * m->gauges + 1, row);
  }
  free(t);
  free(target);
  return output_close(&f);
}

static bool write_force(app *a, const flume *m) {
  const bool loaded = flume_is_loaded(m), body = flume_has_body(m);
  output f;
  if (!output_open(&f, a, m->s.out, "force.csv")) return false;
  csv_header(&f, body ? "t_s,maker_m,end_m,force_N,moment_N_m,foot_Pa,uplift_N,uplift_moment_N_m"
                 : loaded ? "t_s,maker_m,end_m,force_N,moment_N_m,foot_Pa"
                          : "t_s,maker_m,end_m");
  for (int64_t k = 0; k < m->samples; k++) {
    const flume_sample *p = &m->sample[k];
    const double row[] = {p->t,      p->maker, p->end,    p->force,
                          p->moment, p->foot,  p->uplift, p->uplift_moment};
    csv_row(&f, body ? 8 : loaded ? 6 : 3, row);
  }
  return output_close(&f);
}

/* Pressures at the probes. */
static bool write_probes(app *a, const flume *m) {
  char names[60 * FLUME_PROBES] = "t_s";
  output f;
  for (int k = 0; k < m->shape.probes; k++) {
    const size_t at = strlen(names);
    snprintf(names + at, sizeof names - at, ",at_%.4g_%.4g_m_Pa", m->shape.probe[k][0],
             m->shape.probe[k][1]);
  }
  if (!output_open(&f, a, m->s.out, "probes.csv")) return false;
  csv_header(&f, names);
  for (int64_t k = 0; k < m->samples; k++) {
    double row[FLUME_PROBES + 1] = {m->sample[k].t};
    memcpy(row + 1, m->sample[k].probe, sizeof m->sample[k].probe);
    csv_row(&f, m->shape.probes + 1, row);
  }
  return output_close(&f);
}

/* Pressures along the faces at the largest force, less those of water at rest. */
static bool write_faces(app *a, const flume *m) {
  output f;
  if (!output_open(&f, a, m->s.out, "faces.csv")) return false;
  csv_header(&f, "x_m,y_m,pressure_Pa,above_rest_Pa");
  for (int64_t k = 0; k < m->look.faces; k++) {
    const double x = (double)m->look.face[3 * k], y = (double)m->look.face[3 * k + 1];
    const double p = (double)m->look.face[3 * k + 2];
    const double row[] = {x, y, p, p - WAVES_DENSITY * WAVES_G * fmax(m->s.depth - y, 0.0)};
    csv_row(&f, 4, row);
  }
  return output_close(&f);
}

static bool write_discharge(app *a, const flume *m, const flume_figures *g) {
  output f;
  if (!output_open(&f, a, m->s.out, "discharge.csv")) return false;
  csv_header(&f, g->thin ? "t_s,volume_m2,returned_m2,water_m2,head_m?,thin_m2"
                         : "t_s,volume_m2,returned_m2,water_m2");
  for (int64_t k = 0; k < m->samples; k++) {
    const flume_sample *p = &m->sample[k];
    const double row[] = {p->t,     p->volume, p->returned,
                          p->water, p->head,   g->thin ? g->thin[k] : NAN};
    csv_row(&f, g->thin ? 6 : 4, row);
  }
  return output_close(&f);
}

static bool write_run_up(app *a, const flume *m) {
  output f;
  if (!output_open(&f, a, m->s.out, "runup.csv")) return false;
  csv_header(&f, "t_s,run_up_m?,resolved_m?,layer_m");
  for (int64_t k = 0; k < m->samples; k++) {
    const flume_sample *p = &m->sample[k];
    const double row[] = {p->t, p->run_up, p->resolved, p->layer};
    csv_row(&f, 4, row);
  }
  return output_close(&f);
}

/* An event: water that passes the crest without a pause of half a period. Volumes come in
 * particles, their sum with errors of rounding, which are no event. */
static bool write_events(app *a, const flume *m, int64_t *count) {
  const double some = 0.5 * m->s.spacing * m->s.spacing;
  output f;
  if (!output_open(&f, a, m->s.out, "events.csv")) return false;
  csv_header(&f, "begins_s,ends_s,volume_m2");
  double begins = NAN, ends = NAN, before = 0.0, last = 0.0;
  *count = 0;
  for (int64_t k = 0; k <= m->samples; k++) {
    const bool over = k == m->samples || m->sample[k].t > ends + 0.5 * m->s.period;
    if (!isnan(begins) && over) {
      const double row[] = {begins, ends, last - before};
      csv_row(&f, 3, row);
      (*count)++;
      begins = NAN;
    }
    if (k == m->samples || !(m->sample[k].volume > last + some)) continue;
    if (isnan(begins)) begins = m->sample[k].t, before = last;
    ends = m->sample[k].t, last = m->sample[k].volume;
  }
  return output_close(&f);
}

static bool write_waves(app *a, const flume *m, const flume_figures *g) {
  output f;
  if (!output_open(&f, a, m->s.out, "waves.csv")) return false;
  csv_header(&f, "station_m,waves,mean_m?,Hm0_m?,H_third_m?,H_tenth_m?,H_max_m?,period_s?,"
                 "skewness?");
  for (int k = 0; k < m->gauges; k++) {
    flume_statistics s;
    if (!flume_find_statistics(m, k, g->from, g->to, &s)) return output_close(&f), app_no_memory(a);
    const double row[] = {m->s.gauge[k], (double)s.waves, s.mean,   s.Hm0,     s.third,
                          s.tenth,       s.highest,       s.period, s.skewness};
    csv_row(&f, 9, row);
  }
  return output_close(&f);
}

/* Densities of energy, a^2/(2 df). */
static bool write_spectrum(app *a, const flume *m, const flume_figures *g) {
  const double each = 0.5 * (g->to - g->from);
  output f;
  if (!output_open(&f, a, m->s.out, "spectrum.csv")) return false;
  csv_header(&f, "frequency_Hz,incident_m2_s,reflected_m2_s,target_m2_s");
  for (int64_t k = 0; k < g->bands; k++) {
    const double row[] = {g->frequency[k], each * pow(g->incident[k], 2.0),
                          each * pow(g->reflected[k], 2.0), each * pow(g->target[k], 2.0)};
    csv_row(&f, 4, row);
  }
  return output_close(&f);
}

/* ---- summary --------------------------------------------------------------------------------- */

static void summarise_waves(output *f, const flume *m, const flume_figures *g) {
  const bool regular = m->s.waves == FLUME_REGULAR, there = g->separated;
  mps_waves_report waves;
  if (mps_waves_get_report(m->waves, &waves) != MPS_OK) return;
  if (m->record) record_json(f, m->record);
  json_number(f, "wave_length", m->wave_length);
  json_integer(f, "components", waves.components);
  json_number(f, "stroke", fmax(waves.stroke[1], -waves.stroke[0]));
  json_number(f, "window_from", g->from);
  json_number(f, "window_to", g->to);
  json_number_if(f, there, "Hm0_incident", g->split.incident_height);
  json_number_if(f, there, "Hm0_target", g->target_height);
  json_number_if(f, there && regular, "H_incident", g->split.incident_height * sqrt(0.5));
  json_number_if(f, there, "Tp", g->split.peak_period);
  json_number_if(f, there, "Tm_10", g->split.energy_period);
  json_number_if(f, there, "reflection", g->split.reflection);
  json_number_if(f, there && !isnan(g->reflection), "reflection_formula", g->reflection);
  json_number_if(f, there, "residual", g->split.residual);
  json_number_if(f, g->passed, "Hm0_transmitted", g->behind.incident_height);
  json_number_if(f, g->passed, "transmission",
                 g->behind.incident_height / g->split.incident_height);
  json_number_if(f, g->passed, "reflection_behind", g->behind.reflection);
  json_number_if(f, there, "mean_level", g->mean_level);
  json_number_if(f, there, "mean_maker", g->mean_maker);
  json_number_if(f, there && m->end, "mean_end", g->mean_end);
  json_number(f, "loss_per_wavelength", g->loss);
  json_number_if(f, !isnan(g->bound), "harmonic_bound", g->bound);
  json_number_if(f, !isnan(g->bound), "harmonic_stokes", g->bound_stokes);
  json_number_if(f, !isnan(g->bound), "harmonic_free", g->unbound);
  json_number_if(f, !isnan(g->bound), "harmonic_back", g->back);
  json_number_if(f, !isnan(g->bound), "wave_length_measured", g->length);
  if (there)
    printf("incident Hm0 %.4f m, linear target in the same window %.4f m; Tp %.3f s; reflection "
           "%.3f\n",
           g->split.incident_height, g->target_height, g->split.peak_period, g->split.reflection);
  if (there && !isnan(g->reflection))
    printf("reflection by Zanuttigh and van der Meer %.3f\n", g->reflection);
  if (there && m->maker)
    printf("mean place of the maker %.1f mm, mean level %.1f mm", 1e3 * g->mean_maker,
           1e3 * g->mean_level);
  if (there && m->end) printf(", mean place of the far piston %.1f mm", 1e3 * g->mean_end);
  if (there && m->maker) printf("\n");
  if (g->passed)
    printf("behind structure, rock or a change of the bed Hm0 %.4f m, transmission %.3f, "
           "reflection there %.3f\n",
           g->behind.incident_height, g->behind.incident_height / g->split.incident_height,
           g->behind.reflection);
  if (!isnan(g->bound))
    printf("second harmonic over the first: bound %.4f (Stokes %.4f), free %.4f, sent back %.4f; "
           "wave length %.4f m\n",
           g->bound, g->bound_stokes, g->unbound, g->back, g->length);
}

static void summarise_solitary(output *f, const flume *m, const flume_figures *g) {
  const bool there = m->s.waves == FLUME_SOLITARY && !isnan(g->crest_last);
  const double speed = sqrt(WAVES_G * (m->s.depth + m->s.height));
  json_number_if(f, there && !isnan(g->crest_first), "crest_first", g->crest_first);
  json_number_if(f, there, "crest_last", g->crest_last);
  json_number_if(f, there && isfinite(g->speed), "wave_speed", g->speed);
  json_number_if(f, there, "wave_speed_theory", speed);
  json_number_if(f, there && !isnan(g->trailing), "trailing", g->trailing);
  if (!there) return;
  printf("crest ");
  if (!isnan(g->crest_first)) printf("%.4f m at the first gauge, ", g->crest_first);
  printf("%.4f m at the last, %.4f m asked for", g->crest_last, m->s.height);
  if (isfinite(g->speed)) printf("; speed %.3f m/s, (g (d + H))^1/2 %.3f m/s", g->speed, speed);
  if (!isnan(g->trailing)) printf("; trailing waves %.3f of the height", g->trailing);
  printf("\n");
}

static void summarise_absorption(output *f, const flume *m) {
  double r = NAN;
  mps_absorber_report report = {.limited = 0};
  const bool active = m->maker &&
                      mps_absorber_get_reflection(m->maker, m->s.period, &r) == MPS_OK &&
                      mps_absorber_get_report(m->maker, &report) == MPS_OK;
  json_number_if(f, active, "reflection_theory", r);
  json_integer_if(f, active, "limited_steps", report.limited);
}

#define STEEPEST                                                                                   \
  0.3 /* k H: standing waves of the incident height, up to which linear theory holds */
#define HIGHEST 0.4       /* H over the depth */
#define LONGEST 26.3      /* H L^2/depth^3, 8 pi^2/3 */
#define LEAST_OF_SEA 30.0 /* waves, among which the highest of Goda's is */
#define LEAST_OF_REGULAR 3.0

static comparison compare_standing(const flume *m, const flume_figures *g) {
  const double k = 2.0 * WAVES_PI / m->wave_length, H = m->s.height, d = m->s.depth;
  comparison c = compare_with("a linear standing wave", g->force_harmonic, g->force_linear);
  compare_require(&c, k * H <= STEEPEST, "k H of these waves is %.2g, and it is of waves below %g",
                  k * H, STEEPEST);
  compare_require(&c, H <= HIGHEST * d, "the waves are %.2g of the depth high", H / d);
  compare_require(&c, H * pow(m->wave_length, 2.0) <= LONGEST * pow(d, 3.0),
                  "the waves are long: H L^2/depth^3 is %.3g, and linear waves have less than %g",
                  H * pow(m->wave_length, 2.0) / pow(d, 3.0), LONGEST);
  return c;
}

/* Goda's formula is for the highest wave of a sea, or for regular waves of one height. */
static comparison compare_goda(const flume *m, const flume_figures *g, double force) {
  const double waves = (g->to - g->from) / m->s.period;
  const double least = m->s.waves == FLUME_REGULAR ? LEAST_OF_REGULAR : LEAST_OF_SEA;
  comparison c = compare_with("Goda", force, g->has_goda ? g->goda.force : NAN);
  compare_require(&c, g->separated, "the incident waves are not known");
  compare_require(&c, g->has_goda, "his formula does not hold for this wall and these waves");
  compare_require(&c, m->s.waves != FLUME_FOCUSED, "his force is of a sea, not of a focused wave");
  compare_require(&c, waves >= least,
                  "the window has %.0f waves, and the highest of at least %.0f is wanted", waves,
                  least);
  return c;
}

static void summarise_force(output *f, const flume *m, const flume_figures *g) {
  const bool wall = flume_is_loaded(m), caisson = flume_is_caisson(m), body = flume_has_body(m);
  const bool regular = !isnan(g->force_mean);
  json_number_if(f, wall, "force_still", g->force_still);
  json_number_if(f, wall, "force_peak", g->force_peak - g->force_still);
  json_number_if(f, wall, "force_least", g->force_least - g->force_still);
  json_number_if(f, wall, "force_peak_at", g->peak_at);
  json_number_if(f, regular, "force_peak_mean", g->force_mean);
  json_number_if(f, regular, "force_harmonic", g->force_harmonic);
  const comparison standing = compare_standing(m, g);
  const comparison goda = compare_goda(m, g, g->force_peak - g->force_still);
  if (regular)
    json_comparison(f, "force_harmonic_linear", &standing);
  else
    json_number(f, "force_harmonic_linear", NAN);
  json_number_if(f, wall, "foot_peak", g->foot_peak);
  if (wall)
    json_comparison(f, "force_goda", &goda);
  else
    json_number(f, "force_goda", NAN);
  json_number_if(f, !isnan(g->force_sainflou), "force_sainflou", g->force_sainflou);
  json_number_if(f, g->has_goda, "foot_goda", g->goda.p3);
  json_number_if(f, body, "uplift_peak", g->uplift_peak);
  json_number_if(f, caisson, "uplift_triangle", g->uplift_triangle);
  json_number_if(f, g->has_goda, "uplift_goda", g->goda.uplift);
  json_number_if(f, caisson, "safety_sliding", g->sliding);
  json_number_if(f, caisson, "safety_overturning", g->overturning);
  json_number_if(f, m->bedded, "safety_sliding_bedding", g->sliding_bedding);
  json_number_if(f, m->bedded, "safety_overturning_bedding", g->overturning_bedding);
  json_number_if(f, g->has_goda, "safety_sliding_goda", g->goda.sliding);
  json_number_if(f, g->has_goda, "safety_overturning_goda", g->goda.overturning);
  if (body && g->has_goda && !isnan(g->uplift_peak))
    printf("uplift above rest then %.1f N through the bedding, %.1f N as a triangle, Goda %.1f N\n",
           g->uplift_peak, g->uplift_triangle, g->goda.uplift);
  if (wall && !isnan(g->force_peak) && g->has_goda) {
    printf("largest force above rest %.1f N at %.2f s", g->force_peak - g->force_still, g->peak_at);
    if (compare_holds(&goda))
      printf(", Goda %.1f N (%+.1f %%)", goda.reference, 100.0 * compare_error(&goda));
    printf("\n");
    compare_tell(&goda);
  }
  if (regular && g->has_goda) {
    printf("mean of the highest force of each wave %.1f N", g->force_mean);
    if (compare_holds(&goda))
      printf(" (%+.1f %% of Goda's)", 100.0 * (g->force_mean / goda.reference - 1.0));
    printf("; first harmonic %.1f N", g->force_harmonic);
    if (compare_holds(&standing))
      printf(", linear theory %.1f N (%+.1f %%)", standing.reference,
             100.0 * compare_error(&standing));
    printf("\n");
    compare_tell(&standing);
  }
}

static void summarise_discharge(output *f, const flume *m, const flume_figures *g, int64_t events) {
  const bool body = flume_is_open(m);
  json_number_if(f, body, "q", g->discharge);
  const double thin = isnan(g->discharge) ? NAN : flume_thin_between(m, g, g->from, g->to);
  json_number_if(f, !isnan(g->thrown), "q_thrown", g->thrown);
  json_number_if(f, !isnan(thin), "q_thin", thin);
  json_number_if(f, !isnan(thin), "q_with_thin", g->discharge + thin);
  json_integer_if(f, g->thin, "thin_events", g->thin_events);
  json_number_if(f, body && m->samples > 0, "volume",
                 m->samples ? m->sample[m->samples - 1].volume : NAN);
  json_integer_if(f, body, "events", events);
  json_number_if(f, body && m->samples > 0, "volume_returned",
                 (double)m->returned * m->s.spacing * m->s.spacing);
  json_number_if(f, body && !isnan(g->water), "water_mean", g->water);
  json_number_if(f, g->has_eurotop, "q_eurotop", g->eurotop.discharge);
  json_number_if(f, g->has_eurotop, "q_eurotop_low", g->eurotop.low);
  json_number_if(f, g->has_eurotop, "q_eurotop_high", g->eurotop.high);
  if (body && !isnan(g->discharge))
    printf("discharge %.3g m2/s in %lld events", g->discharge, (long long)events);
  if (g->has_eurotop)
    printf(", EurOtop %.3g m2/s (%.3g to %.3g), ratio %.2f", g->eurotop.discharge, g->eurotop.low,
           g->eurotop.high, g->discharge / g->eurotop.discharge);
  if (body && !isnan(g->discharge)) printf("\n");
  if (g->thrown > 0.0) {
    printf("without particles thrown over the crest %.3g m2/s", g->discharge - g->thrown);
    if (g->has_eurotop) printf(", ratio %.2f", (g->discharge - g->thrown) / g->eurotop.discharge);
    printf("\n");
  }
  if (!isnan(thin)) {
    printf("with events too low for particles %.3g m2/s", g->discharge + thin);
    if (g->has_eurotop) printf(", ratio %.2f", (g->discharge + thin) / g->eurotop.discharge);
    printf("\n");
  }
}

static void summarise_run_up(output *f, const flume *m, const flume_figures *g) {
  const bool slope = flume_has_slope(m), many = !isnan(g->run_up), formula = g->has_formula;
  json_integer_if(f, slope, "climbs", g->climbs);
  json_number_if(f, slope && g->climbs > 0, "run_up_mean", g->run_up_mean);
  json_number_if(f, slope && g->climbs > 0, "run_up_highest", g->run_up_highest);
  json_number_if(f, many, "Ru2", g->run_up);
  json_number_if(f, many, "Ru2_layer", g->run_up_layer);
  json_number_if(f, formula, "Ru2_eurotop", g->formula.height);
  json_number_if(f, formula, "Ru2_eurotop_low", g->formula.low);
  json_number_if(f, formula, "Ru2_eurotop_high", g->formula.high);
  if (slope && g->climbs > 0)
    printf("run-up: highest %.4f m, mean of %lld %.4f m\n", g->run_up_highest, (long long)g->climbs,
           g->run_up_mean);
  if (many) printf("run-up that 2 %% of the waves exceed %.4f m by the tongue", g->run_up);
  if (many && !isnan(g->run_up_layer)) printf(", %.4f m by the layer", g->run_up_layer);
  if (many && formula)
    printf(", EurOtop %.4f m (%.4f to %.4f), ratio %.2f", g->formula.height, g->formula.low,
           g->formula.high, g->run_up / g->formula.height);
  if (many) printf("\n");
}

static bool write_summary(app *a, const flume *m, const flume_figures *g, int64_t events) {
  output f;
  if (!summary_open(&f, a, m->s.out)) return false;
  json_integer(&f, "particles", mps_particles_count(m->water));
  json_integer(&f, "steps", mps_fluid_steps(m->fluid));
  json_number(&f, "time", mps_fluid_time(m->fluid));
  summarise_waves(&f, m, g);
  summarise_solitary(&f, m, g);
  summarise_absorption(&f, m);
  summarise_force(&f, m, g);
  summarise_discharge(&f, m, g, events);
  summarise_run_up(&f, m, g);
  json_integer(&f, "collisions", m->report.collisions);
  json_integer(&f, "limited", m->report.limited);
  json_integer(&f, "pushed", m->report.pushed);
  json_end(&f);
  return output_close(&f);
}

bool flume_write(app *a, flume *m) {
  flume_figures g;
  int64_t events = 0;
  bool good = flume_find_figures(a, m, &g) && write_gauges(a, m) && write_force(a, m);
  if (good && m->shape.probes > 0) good = write_probes(a, m);
  if (good && flume_is_loaded(m)) good = write_faces(a, m);
  if (good && flume_is_open(m)) good = write_discharge(a, m, &g) && write_events(a, m, &events);
  if (good && flume_has_slope(m)) good = write_run_up(a, m);
  if (good && g.separated) good = write_waves(a, m, &g) && write_spectrum(a, m, &g);
  if (good && m->series) good = app_check(a, mps_recorder_close(&m->series));
  good = good && write_summary(a, m, &g, events) && flume_draw(a, m, &g);
  flume_free_figures(&g);
  if (good) app_tell_results(a, m->s.out);
  return good;
}
