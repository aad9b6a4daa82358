/* results.c - tables and summary of mps-site-response.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "site.h"

#include "common/record.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#define DAMPING 0.05
/* Of the largest Fourier amplitude of the input: ratios of less are noise; those in which the
 * largest is sought, where soil that yields makes harmonics. */
#define LEAST_INPUT 0.01
#define STRONG_INPUT 0.1
#define RESTS 0.01 /* of the peak: motion left at the end of a record that has died out */
#define LARGE_STRAIN 0.01

/* What is found from the history. */
typedef struct findings {
  site_series series;
  site_fourier fourier;
  double period[SITE_PERIODS], surface[SITE_PERIODS], input[SITE_PERIODS]; /* s, m/s2 */
  double peak, peak_time;    /* m/s2, s: of the surface */
  double largest, frequency; /* ratio of Fourier amplitudes, Hz where */
  double error;              /* largest difference from elastic layers, relative */
  comparison layers;         /* with elastic layers at `frequency` */
} findings;

static findings found;

/* Derivative of the relative velocity of the surface; of lower order at the ends. */
static double surface_slope(const simulation *sim, int64_t k) {
  const site_sample *s = sim->sample;
  const int64_t last = sim->count - 1;
  if (k >= 2 && k + 2 <= last) {
    const double v[5] = {s[k - 2].v, s[k - 1].v, s[k].v, s[k + 1].v, s[k + 2].v};
    return site_slope(v, sim->s.sample);
  }
  const int64_t a = k > 0 ? k - 1 : 0, b = k < last ? k + 1 : last;
  return b > a ? (s[b].v - s[a].v) / (s[b].t - s[a].t) : 0.0;
}

static bool make_series(app *a, const simulation *sim, site_series *out) {
  *out = (site_series){.count = sim->count, .step = sim->s.sample};
  out->surface = malloc((size_t)sim->count * sizeof *out->surface);
  out->input = malloc((size_t)sim->count * sizeof *out->input);
  if (!out->surface || !out->input) return app_no_memory(a);
  for (int64_t k = 0; k < sim->count; k++) {
    out->input[k] = site_input(sim, sim->sample[k].t);
    out->surface[k] = out->input[k] + surface_slope(sim, k);
  }
  return true;
}

/* ---- spectra --------------------------------------------------------------------------------- */

static void find_response(const simulation *sim, findings *f) {
  const double shortest = 0.5 / sim->highest, longest = fmax(4.0, 8.0 * shortest);
  for (int k = 0; k < SITE_PERIODS; k++) {
    const double T = shortest * pow(longest / shortest, (double)k / (SITE_PERIODS - 1));
    f->period[k] = T;
    f->surface[k] = site_response(f->series.surface, f->series.count, f->series.step, T, DAMPING);
    f->input[k] = site_response(f->series.input, f->series.count, f->series.step, T, DAMPING);
  }
}

static double largest_of(const double *x, int64_t count) {
  double most = 0.0;
  for (int64_t k = 0; k < count; k++) most = fmax(most, x[k]);
  return most;
}

static bool counts(const findings *f, int64_t k, double least) {
  return f->fourier.input[k] > least * largest_of(f->fourier.input, f->fourier.count);
}

/* Largest over the last tenth of the record over that of all of it. */
static double left_of(const double *x, int64_t count) {
  const int64_t tenth = count / 10;
  double last = 0.0, most = 0.0;
  for (int64_t k = 0; k < count; k++) {
    most = fmax(most, fabs(x[k]));
    if (k >= count - tenth) last = fmax(last, fabs(x[k]));
  }
  return last / most;
}

static const site_row *most_strained(const simulation *sim) {
  const site_row *most = &sim->row[sim->rows - 1];
  for (int64_t r = 0; r < sim->rows; r++)
    if (sim->row[r].depth < sim->height && sim->row[r].strain > most->strain) most = &sim->row[r];
  return most;
}

static double largest_strain(const simulation *sim) { return most_strained(sim)->strain; }

/* Whether a row has the strains of two layers: displacements have no kinks within the reach of the
 * weights. An elastic layer has the strain of its stress (record.c). */
static bool is_smeared(const simulation *sim, const site_row *row) {
  const site_ground *g = &sim->ground;
  double bottom = 0.0;
  if (site_layer_at(g, row->depth)->law == SITE_ELASTIC) return false;
  for (int64_t i = 0; i + 1 < g->count; i++) {
    bottom += g->layer[i].thickness;
    if (fabs(row->depth - bottom) < 1.5 * sim->cell) return true;
  }
  return false;
}

/* Steady waves in elastic layers. Spectra of a record have their ratio only where the motion is
 * over at its end, which undamped layers on a rigid base never are. */
static comparison compare_layers(const simulation *sim, const findings *f) {
  comparison c = compare_with("elastic layers", f->largest, site_exact(sim, f->frequency));
  bool elastic = true;
  for (int64_t i = 0; i < sim->ground.count; i++)
    elastic = elastic && sim->ground.layer[i].law == SITE_ELASTIC;
  const double left = left_of(f->series.surface, f->series.count);
  compare_require(&c, elastic, "a layer is not linear elastic");
  compare_require(&c, sim->s.damping == 0.0, "--mass-damping is not that of elastic layers");
  compare_require(&c, sim->s.base == SITE_COMPLIANT,
                  "on a rigid base undamped layers swing without end, and have no spectrum");
  compare_require(&c, !isnan(f->largest), "the input has too little motion up to --max-frequency");
  compare_require(&c, left <= RESTS,
                  "at the end the surface still moves at %.0f %% of its peak: the spectrum is cut "
                  "off, take a longer --duration",
                  100.0 * left);
  compare_require(&c, largest_strain(sim) <= LARGE_STRAIN,
                  "shear strains reach %.2g: layers of small strains are not those of large ones",
                  largest_strain(sim));
  return c;
}

static void find_amplification(const simulation *sim, findings *f) {
  site_transform(&f->series, sim->highest, &f->fourier);
  for (int64_t k = 0; k < f->fourier.count; k++)
    f->fourier.exact[k] = site_exact(sim, (double)(k + 1) * f->fourier.step);
  site_smooth(&f->fourier);
  double exact_at = NAN;
  f->largest = f->frequency = f->error = NAN;
  for (int64_t k = 0; k < f->fourier.count; k++) {
    const double ratio = f->fourier.surface[k] / f->fourier.input[k];
    if (!counts(f, k, LEAST_INPUT)) continue;
    f->error = fmax(isnan(f->error) ? 0.0 : f->error, fabs(ratio / f->fourier.exact[k] - 1.0));
    if (ratio <= f->largest || !counts(f, k, STRONG_INPUT)) continue;
    f->largest = ratio, f->frequency = (double)(k + 1) * f->fourier.step;
    exact_at = f->fourier.exact[k]; /* smoothed, as the ratio is */
  }
  f->layers = compare_layers(sim, f);
  f->layers.reference = exact_at;
  if (compare_holds(&f->layers)) return;
  f->error = NAN;
  for (int64_t k = 0; k < f->fourier.count; k++) f->fourier.exact[k] = NAN;
}

static void find_peak(const simulation *sim, findings *f) {
  f->peak = f->peak_time = 0.0;
  for (int64_t k = 0; k < f->series.count; k++)
    if (fabs(f->series.surface[k]) > f->peak)
      f->peak = fabs(f->series.surface[k]), f->peak_time = sim->sample[k].t;
}

/* ---- tables ---------------------------------------------------------------------------------- */

static bool write_surface(app *a, const simulation *sim, const findings *f) {
  output file;
  if (!csv_open(&file, a, sim->s.out, "surface.csv",
                "time_s,acceleration_m_s2,velocity_m_s,displacement_m,input_acceleration_m_s2,"
                "input_velocity_m_s,input_displacement_m,settlement_m"))
    return false;
  for (int64_t k = 0; k < sim->count; k++) {
    const site_sample *s = &sim->sample[k];
    const double v = mps_signal_velocity(sim->motion, s->t);
    const double u = mps_signal_displacement(sim->motion, s->t);
    CSV_LINE(&file, s->t, f->series.surface[k], s->v + v, s->u + u, f->series.input[k], v, u,
             s->settlement);
  }
  return output_close(&file);
}

static bool write_spectrum(app *a, const simulation *sim, const findings *f) {
  output file;
  if (!csv_open(&file, a, sim->s.out, "spectrum.csv", "period_s,surface_m_s2,input_m_s2,ratio"))
    return false;
  for (int k = 0; k < SITE_PERIODS; k++) {
    CSV_LINE(&file, f->period[k], f->surface[k], f->input[k], f->surface[k] / f->input[k]);
  }
  return output_close(&file);
}

static bool write_amplification(app *a, const simulation *sim, const findings *f) {
  output file;
  if (!csv_open(&file, a, sim->s.out, "amplification.csv",
                "frequency_Hz,surface_over_input,exact?"))
    return false;
  for (int64_t k = 0; k < f->fourier.count; k++) {
    const double line[] = {(double)(k + 1) * f->fourier.step,
                           f->fourier.surface[k] / f->fourier.input[k], f->fourier.exact[k]};
    if (counts(f, k, LEAST_INPUT)) csv_row(&file, 3, line);
  }
  return output_close(&file);
}

static bool write_profile(app *a, const simulation *sim) {
  output file;
  if (!csv_open(&file, a, sim->s.out, "profile.csv",
                "depth_m,layer,acceleration_m_s2,velocity_m_s,relative_displacement_m,"
                "shear_strain,shear_stress_Pa,ru,last_ru,settlement_m,last_displacement_m"))
    return false;
  for (int64_t r = sim->rows - 1; r >= 0; r--) {
    const site_row *row = &sim->row[r];
    const site_layer *l = site_layer_at(&sim->ground, row->depth);
    CSV_LINE(&file, row->depth, (double)(l - sim->ground.layer + 1), row->acceleration,
             row->velocity, row->displacement, row->strain, row->stress, row->ru, row->last_ru,
             row->settlement, row->last_displacement);
  }
  return output_close(&file);
}

static bool write_loop(app *a, const simulation *sim) {
  output file;
  if (sim->loop_row < 0) return true;
  if (!csv_open(&file, a, sim->s.out, "loop.csv", "time_s,shear_strain,shear_stress_Pa,ru"))
    return false;
  for (int64_t k = 0; k < sim->count; k++) {
    const site_sample *s = &sim->sample[k];
    CSV_LINE(&file, s->t, s->strain, s->stress, s->ru);
  }
  return output_close(&file);
}

/* Largest over the soil, below the highest cell, where stresses are those of half a cell. */
static double largest_ru(const simulation *sim) {
  double most = 0.0;
  for (int64_t r = 0; r < sim->rows; r++)
    if (sim->row[r].depth > sim->cell && sim->row[r].depth < sim->height)
      most = fmax(most, sim->row[r].ru);
  return most;
}

/* How far the places of the highest particles are off their settlement by volumes, where that
 * counts: in sand that has liquefied. */
static double drift_of(const site_row *top) { return top->sunk - top->settlement; }
static bool has_drifted(const site_row *top) { return fabs(drift_of(top)) > 1e-3; }

static bool write_summary(app *a, const simulation *sim, const findings *f) {
  const site_row *top = &sim->row[sim->rows - 1];
  output file;
  if (!mpm_model_summary(a, &sim->m, sim->s.out, &file)) return false;
  JSON_NUMBERS(&file, {"time", sim->sample[sim->count - 1].t}, {"height", sim->height},
               {"cell", sim->cell}, {"flip_time_used", sim->flip_time},
               {"travel_time", site_travel_time(&sim->ground)},
               {"record_duration", sim->record_end});
  record_json(&file, sim->motion);
  JSON_NUMBERS(
      &file, {"input_peak_acceleration", sim->record_peak}, {"peak_acceleration", f->peak},
      {"peak_time", f->peak_time}, {"peak_velocity", top->velocity},
      {"response_ratio", largest_of(f->surface, SITE_PERIODS) / largest_of(f->input, SITE_PERIODS)},
      {"amplification", f->largest}, {"amplification_frequency", f->frequency});
  json_comparison(&file, "amplification_exact", &f->layers);
  JSON_NUMBERS(&file, {"amplification_error", f->error}, {"shear_strain", largest_strain(sim)},
               {"ru", sim->wet ? largest_ru(sim) : NAN}, {"settlement", top->settlement});
  json_number(&file, "settlement_drift", drift_of(top));
  json_number(&file, "last_displacement", top->last_displacement);
  json_end(&file);
  return output_close(&file);
}

static void report(const simulation *sim, const findings *f) {
  printf("peak acceleration %.3g m/s2 at the surface (%.2f s), %.3g m/s2 of the input\n", f->peak,
         f->peak_time, sim->record_peak);
  if (!isnan(f->largest)) {
    printf("largest amplification %.3f at %.3g Hz", f->largest, f->frequency);
    if (!isnan(f->error))
      printf(" (exact, smoothed alike, %.3f; all frequencies within %.1f %%)", f->layers.reference,
             100.0 * f->error);
    printf("\n");
  }
  compare_tell(&f->layers);
  const site_row *most = most_strained(sim);
  printf("largest shear strain %.3g", most->strain);
  if (is_smeared(sim, most))
    printf(" (at %.3g m: within 1.5 cells of an interface of layers, strains are means of both)",
           most->depth);
  if (sim->wet) printf(", r_u %.3f", largest_ru(sim));
  const site_row *top = &sim->row[sim->rows - 1];
  printf(", settlement %.3g mm\n", 1e3 * top->settlement);
  if (has_drifted(top))
    printf("The particles of the surface are %.3g mm %s that: in liquefied sand places drift.\n",
           1e3 * fabs(drift_of(top)), drift_of(top) > 0.0 ? "below" : "above");
}

bool site_finish(app *a, void *user) {
  simulation *sim = user;
  findings *f = &found;
  bool ok = make_series(a, sim, &f->series);
  if (ok) {
    find_response(sim, f);
    find_amplification(sim, f);
    find_peak(sim, f);
    ok = write_surface(a, sim, f) && write_spectrum(a, sim, f) && write_amplification(a, sim, f) &&
         write_profile(a, sim) && write_loop(a, sim) && write_summary(a, sim, f) &&
         site_draw(a, sim, compare_holds(&f->layers));
  }
  if (ok) app_tell_results(a, sim->s.out);
  if (ok) report(sim, f);
  free(f->series.surface);
  free(f->series.input);
  return ok;
}
