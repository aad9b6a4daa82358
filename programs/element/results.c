/* results.c - path.csv, summary.json and the pictures of mps-element.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "element.h"

#include "common/plot.h"

#include <math.h>
#include <stdio.h>

static const char *const law_names[] = {
    "linear elastic", "neo-Hookean", "von Mises",         "Tresca",       "Drucker-Prager",
    "Mohr-Coulomb",   "Newtonian",   "modified Cam-Clay", "small strain", "cyclic sand"};
static const char *const path_names[] = {"isotropic compression",
                                         "oedometer",
                                         "undrained triaxial compression",
                                         "drained triaxial compression",
                                         "undrained plane strain compression",
                                         "undrained triaxial extension",
                                         "simple shear",
                                         "cyclic simple shear",
                                         "cyclic triaxial test",
                                         "path of a file"};

static const char *path_name(const settings *s) {
  return path_names[s->path_file ? FROM_FILE : s->path];
}

static bool write_path(element *x) {
  output f;
  if (!csv_open(&f, &x->a, x->s.out, "path.csv",
                "strain,sxx,syy,szz,sxy,p,q,u,void_ratio?,pc?,exx,eyy,ezz,gxy,volume_ratio,"
                "plastic_strain?,contraction?,cycles?"))
    return false;
  for (int64_t k = 0; k < x->rows; k++) {
    const row *r = &x->table[k];
    CSV_LINE(&f, r->strain, r->stress[0], r->stress[1], r->stress[2], r->stress[3], r->p, r->q,
             r->u, r->void_ratio, r->pc, r->e[0], r->e[1], r->e[2], r->e[3], r->volume_ratio,
             r->plastic, r->contraction, r->cycles);
  }
  return output_close(&f);
}

bool element_loop(const element *x, double *modulus, double *damping) {
  if (x->s.path_file || x->s.path != CYCLIC || x->stopped) return false;
  const int64_t length = x->stages[x->stage_count - 1].steps, first = x->rows - 1 - 2 * length;
  if (first < 0) return false; /* the path has not come to its end */
  double area = 0.0;
  for (int64_t k = first; k < x->rows - 1; k++) {
    const row *a = &x->table[k], *b = a + 1;
    area += 0.5 * (a->stress[3] + b->stress[3]) * (b->strain - a->strain);
  }
  const row *top = &x->table[x->rows - 1], *bottom = &x->table[first + length];
  const double tau = 0.5 * (top->stress[3] - bottom->stress[3]);
  const double gamma = 0.5 * (top->strain - bottom->strain);
  *modulus = tau / gamma;
  *damping = area / (2.0 * 3.14159265358979323846 * tau * gamma);
  return true;
}

static bool write_summary(element *x) {
  const row *last = &x->table[x->rows - 1], *peak = last;
  for (int64_t k = 0; k < x->rows; k++)
    if (x->table[k].q > peak->q) peak = &x->table[k];
  output f;
  if (!summary_open(&f, &x->a, x->s.out)) return false;
  json_text(&f, "law", law_names[x->s.law]);
  json_text(&f, "path", path_name(&x->s));
  json_integer(&f, "steps", x->rows - 1);
  json_number(&f, "strain", last->strain);
  static const char *const components[] = {"sxx", "syy", "szz", "sxy"};
  for (int c = 0; c < 4; c++) json_number(&f, components[c], last->stress[c]);
  JSON_NUMBERS(&f, {"p", last->p}, {"q", last->q}, {"u", last->u}, {"void_ratio", last->void_ratio},
               {"pc", last->pc}, {"volume_strain", log(last->volume_ratio)}, {"q_peak", peak->q},
               {"strain_at_peak", peak->strain}, {"q_limit", element_limit(x)},
               {"k0_normal", mps_material_normal_k0(x->material)});
  double modulus = NAN, damping = NAN;
  (void)element_loop(x, &modulus, &damping);
  JSON_NUMBERS(&f, {"secant_modulus", modulus}, {"damping_ratio", damping},
               {"contraction", last->contraction}, {"cycles", last->cycles},
               {"ru", element_is_cyclic(&x->s) ? last->u / element_reference(x) : NAN},
               {"cycles_to_liquefaction", element_liquefied(x)});
  json_end(&f);
  return output_close(&f);
}

/* ---- pictures -------------------------------------------------------------------------------- */

static bool draw_q_p(element *x, const char *law) {
  const settings *s = &x->s;
  double most = 0.0;
  for (int64_t k = 0; k < x->rows; k++) most = fmax(most, fmax(x->table[k].p, x->table[k].pc));
  return plot_draw(&x->a, s->out, "q_p", "element/q_p",
                   "law = '%s'; clay = %d; M = %.9g; first_pc = %.9g; last_pc = %.9g; most = %.9g",
                   law, s->law == CAM_CLAY, s->M, 1e-3 * x->table[0].pc,
                   1e-3 * x->table[x->rows - 1].pc, 1e-3 * most);
}

static bool draw_q_strain(element *x, const char *law) {
  static const char *const axes[] = {"volume strain (%)", "axial strain (%)", "axial strain (%)",
                                     "axial strain (%)",  "axial strain (%)", "axial extension (%)",
                                     "shear strain (%)",  "shear strain (%)", "axial strain (%)",
                                     "axial strain (%)"};
  return plot_draw(&x->a, x->s.out, "q_strain", "element/q_strain",
                   "law = '%s'; x_name = '%s'; limit = %.9g", law,
                   axes[x->s.path_file ? FROM_FILE : x->s.path], 1e-3 * element_limit(x));
}

/* Stress against strain, and of the small-strain law its backbone. */
static bool draw_loop(element *x, const char *law) {
  const settings *s = &x->s;
  const bool triaxial = s->path == CYCLIC_TRIAXIAL;
  if (!element_is_cyclic(s)) return true;
  double widest = 0.0;
  for (int64_t k = 0; k < x->rows; k++) widest = fmax(widest, fabs(x->table[k].strain));
  const double g0 =
      isnan(s->shear_modulus) ? s->young / (2.0 * (1.0 + s->poisson)) : s->shear_modulus;
  return plot_draw(&x->a, s->out, "loop", "element/loop",
                   "law = '%s'; triaxial = %d; widest = %.9g\ncurved = %d; g0 = %.9g; reference = "
                   "%.9g; curvature = %.9g",
                   law, triaxial, widest, s->law == SMALL_STRAIN && !triaxial, 1e-5 * g0,
                   100.0 * s->reference_strain, s->curvature);
}

/* Void ratio, or V/V0 where there is none, against the logarithm of p; none where p <= 0. */
static bool draw_e_p(element *x, const char *law) {
  const settings *s = &x->s;
  const row *r = &x->table[0];
  double least = INFINITY, most = 0.0;
  for (int64_t k = 0; k < x->rows; k++)
    if (x->table[k].p > 0.0) least = fmin(least, x->table[k].p), most = fmax(most, x->table[k].p);
  if (!(most > 0.0)) return true;
  const double n = r->void_ratio + (s->lambda - s->kappa) * log(1e-3 * r->pc) +
                   s->kappa * log(1e-3 * r->p); /* of virgin compression, e at 1 kPa */
  return plot_draw(&x->a, s->out, "e_p", "element/e_p",
                   "law = '%s'; voids = %d; least = %.9g; most = %.9g\nclay = %d; n = %.9g; lambda "
                   "= %.9g; critical = %.9g",
                   law, !isnan(r->void_ratio), 1e-3 * least, 1e-3 * most, s->law == CAM_CLAY, n,
                   s->lambda, n - (s->lambda - s->kappa) * log(2.0));
}

static bool draw(element *x) {
  char law[100];
  snprintf(law, sizeof law, "%s, %s", law_names[x->s.law], path_name(&x->s));
  return draw_q_p(x, law) && draw_q_strain(x, law) && draw_e_p(x, law) && draw_loop(x, law);
}

/* The e-ln p line has no end where no pores are left, and means nothing there. */
static void warn_of_no_pores(element *x) {
  double least = INFINITY; /* NaN: no void ratio is known */
  for (int64_t k = 0; k < x->rows; k++) least = fmin(least, x->table[k].void_ratio);
  if (least < 0.0)
    app_warn(&x->a,
             "the void ratio falls to %.3g: below 0 there are no pores left, take a smaller "
             "--strain or a larger --e0",
             least);
}

bool element_results(element *x, bool done) {
  app *a = &x->a;
  if (!done) a->outcome = "failed";
  warn_of_no_pores(x); /* before the summary, which lists it */
  if (!write_path(x) || !write_summary(x) || !draw(x) || !element_write_cycles(x) ||
      !element_draw_cycles(x))
    return false;
  app_tell_results(a, x->s.out);
  const row *last = &x->table[x->rows - 1];
  printf("%s, %s: p %.6g kPa, q %.6g kPa", law_names[x->s.law], path_name(&x->s), 1e-3 * last->p,
         1e-3 * last->q);
  if (last->u != 0.0) printf(", u %.6g kPa", 1e-3 * last->u);
  if (!isnan(last->void_ratio)) printf(", e %.6g", last->void_ratio);
  if (!isnan(last->pc)) printf(", pc %.6g kPa", 1e-3 * last->pc);
  double modulus, damping;
  if (element_loop(x, &modulus, &damping))
    printf("; last loop: G %.6g MPa, damping ratio %.4f", 1e-6 * modulus, damping);
  const double liquefied = element_liquefied(x);
  if (last->contraction > 0.0) printf("; contraction %.4g %%", 100.0 * last->contraction);
  if (!isnan(liquefied) && last->u < ELEMENT_LIQUEFIED * element_reference(x))
    printf("; from %.2f cycles on the stress is no longer borne, r_u %.2f", liquefied,
           last->u / element_reference(x));
  else if (!isnan(liquefied))
    printf("; liquefied after %.2f cycles", liquefied);
  if (!isnan(element_limit(x))) printf("; limit of q by theory %.6g kPa", 1e-3 * element_limit(x));
  printf("\n");
  return true;
}
