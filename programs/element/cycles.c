/* cycles.c - cyclic paths of mps-element: their stages, in simple shear and in the triaxial cell,
 * by strain or by stress, at constant volume or drained; cycles.csv, with a row for each reversal,
 * and the picture over the cycles. SPDX-License-Identifier: BSD-3-Clause */
#include "common/plot.h"
#include "element.h"

#include <math.h>

#define FARTHEST 0.05 /* axial strain of a step in search of a deviator stress */

bool element_is_cyclic(const settings *s) {
  return !s->path_file && (s->path == CYCLIC || s->path == CYCLIC_TRIAXIAL);
}

bool element_has_ratio(const settings *s) { return element_is_cyclic(s) && !isnan(s->csr); }

/* ---- stages ---------------------------------------------------------------------------------- */

/* A stage that changes strain or stress by `share` of the amplitude. */
static stage cyclic_stage(const settings *s, double share, int64_t steps) {
  const double vertical = 3.0 * s->p0 / (1.0 + 2.0 * s->k0);
  stage g = {.steps = steps};
  if (s->path == CYCLIC) {
    if (s->drained) g.controlled = MPS_MATERIAL_POINT_YY;
    if (isnan(s->csr))
      g.strain[1] = share * s->strain;
    else
      g.controlled |= MPS_MATERIAL_POINT_XY, g.stress[3] = share * s->csr * vertical;
    return g;
  }
  if (s->drained) g.controlled = MPS_MATERIAL_POINT_XX | MPS_MATERIAL_POINT_YY;
  if (isnan(s->csr)) {
    g.strain[8] = -share * s->strain;
    if (!s->drained) g.strain[0] = g.strain[4] = 0.5 * share * s->strain;
  } else if (s->drained) {
    g.controlled |= MPS_MATERIAL_POINT_ZZ, g.stress[2] = -2.0 * share * s->csr * s->p0;
  } else {
    g.deviator = 2.0 * share * s->csr * s->p0;
  }
  return g;
}

/* To one side, then loops to the other and back, a quarter of the steps for each half way. */
int element_cyclic_path(const settings *s, stage *g) {
  const int64_t quarter = (s->steps + 3) / 4;
  int n = 0;
  g[n++] = cyclic_stage(s, 1.0, quarter);
  for (int64_t k = 0; k < s->cycles; k++) {
    g[n++] = cyclic_stage(s, -2.0, 2 * quarter);
    g[n++] = cyclic_stage(s, 2.0, 2 * quarter);
  }
  return n;
}

/* ---- an undrained step to a deviator stress -------------------------------------------------- */

static void isochoric(double rate, double *gradient) {
  for (int c = 0; c < 9; c++) gradient[c] = 0.0;
  gradient[8] = rate, gradient[0] = gradient[4] = -0.5 * rate;
}

/* sigma_xx - sigma_zz less the target after the axial strain `strain`, from the present point. */
static mps_status excess(element *x, double strain, double dt, double q, mps_material_point *trial,
                         double *out) {
  double gradient[9];
  *trial = x->point;
  isochoric(strain / dt, gradient);
  const mps_status status =
      mps_material_point_drive(x->a.context, x->material, trial, gradient, dt, 1);
  *out = trial->stress[0] - trial->stress[2] - q;
  return status;
}

mps_status element_drive_deviator(element *x, double q, double dt, double found[9]) {
  mps_material_point trial;
  double low = 0.0, f_low, high = 1e-7, f_high, strain = 0.0, f = 0.0;
  mps_status status = excess(x, low, dt, q, &trial, &f_low);
  if (f_low < 0.0) high = -high; /* compression, which raises q */
  for (f_high = f_low; status == MPS_OK && f_low * f_high > 0.0;) {
    high *= 2.0;
    if (fabs(high) > FARTHEST) return MPS_ERROR_NUMERIC;
    status = excess(x, high, dt, q, &trial, &f_high);
  }
  for (int i = 0; i < 100 && status == MPS_OK; i++) { /* Illinois */
    strain = f_high == f_low ? high : low - f_low * (high - low) / (f_high - f_low);
    status = excess(x, strain, dt, q, &trial, &f);
    if (fabs(f) <= 1e-9 * (fabs(q) + x->s.p0)) break;
    if (f * f_high > 0.0) {
      high = strain, f_high = f;
      f_low *= 0.5;
    } else {
      low = strain, f_low = f;
      f_high *= 0.5;
    }
  }
  if (status != MPS_OK) return status;
  x->point = trial;
  isochoric(strain / dt, found);
  return MPS_OK;
}

/* ---- results --------------------------------------------------------------------------------- */

double element_reference(const element *x) {
  return x->s.path == CYCLIC ? 3.0 * x->s.p0 / (1.0 + 2.0 * x->s.k0) : x->s.p0;
}

double element_liquefied(const element *x) {
  if (!element_is_cyclic(&x->s) || x->s.drained || !(x->s.p0 > 0.0)) return NAN;
  for (int64_t k = 0; k < x->rows; k++)
    if (x->table[k].u >= ELEMENT_LIQUEFIED * element_reference(x)) return x->table[k].cycles;
  return x->stopped ? x->table[x->rows - 1].cycles : NAN;
}

static double stress_of(const element *x, int64_t k) {
  const double *s = x->table[k].stress;
  return x->s.path == CYCLIC ? s[3] : s[0] - s[2];
}

/* Rows at the ends of stages, with the half range of strain and stress since the one before. */
bool element_write_cycles(element *x) {
  output f;
  if (!element_is_cyclic(&x->s)) return true;
  if (!csv_open(&f, &x->a, x->s.out, "cycles.csv",
                "cycles,strain_amplitude,stress_amplitude,u,ru?,volume_strain,contraction?"))
    return false;
  int64_t from = 0;
  for (int n = 0; n < x->stage_count; n++) {
    const int64_t to = from + x->stages[n].steps;
    if (to >= x->rows) break;
    const row *a = &x->table[from], *b = &x->table[to];
    const double reference = element_reference(x);
    CSV_LINE(&f, b->cycles, 0.5 * fabs(b->strain - a->strain),
             0.5 * fabs(stress_of(x, to) - stress_of(x, from)), b->u,
             reference > 0.0 ? b->u / reference : NAN, log(b->volume_ratio), b->contraction);
    from = to;
  }
  return output_close(&f);
}

/* u over the first effective stress, or the drained volume strain, against the cycles. */
bool element_draw_cycles(element *x) {
  const settings *s = &x->s;
  if (!element_is_cyclic(s) || !(s->p0 > 0.0)) return true;
  return plot_draw(&x->a, s->out, "cycles", "element/cycles", "drained = %d; first = %.9g",
                   s->drained, element_reference(x));
}
