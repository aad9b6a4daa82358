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
  if (!output_open(&f, &x->a, x->s.out, "path.csv")) return false;
  csv_header(&f, "strain,sxx,syy,szz,sxy,p,q,u,void_ratio?,pc?,exx,eyy,ezz,gxy,volume_ratio,"
                 "plastic_strain?,contraction?,cycles?");
  for (int64_t k = 0; k < x->rows; k++) {
    const row *r = &x->table[k];
    const double cells[] = {
        r->strain, r->stress[0], r->stress[1],    r->stress[2], r->stress[3],   r->p,
        r->q,      r->u,         r->void_ratio,   r->pc,        r->e[0],        r->e[1],
        r->e[2],   r->e[3],      r->volume_ratio, r->plastic,   r->contraction, r->cycles};
    csv_row(&f, 18, cells);
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
  json_number(&f, "p", last->p);
  json_number(&f, "q", last->q);
  json_number(&f, "u", last->u);
  json_number(&f, "void_ratio", last->void_ratio);
  json_number(&f, "pc", last->pc);
  json_number(&f, "volume_strain", log(last->volume_ratio));
  json_number(&f, "q_peak", peak->q);
  json_number(&f, "strain_at_peak", peak->strain);
  json_number(&f, "q_limit", element_limit(x));
  json_number(&f, "k0_normal", mps_material_normal_k0(x->material));
  double modulus = NAN, damping = NAN;
  (void)element_loop(x, &modulus, &damping);
  json_number(&f, "secant_modulus", modulus);
  json_number(&f, "damping_ratio", damping);
  json_number(&f, "contraction", last->contraction);
  json_number(&f, "cycles", last->cycles);
  json_number(&f, "ru", element_is_cyclic(&x->s) ? last->u / element_reference(x) : NAN);
  json_number(&f, "cycles_to_liquefaction", element_liquefied(x));
  json_end(&f);
  return output_close(&f);
}

/* ---- pictures -------------------------------------------------------------------------------- */

static bool open_picture(element *x, output *f, const char *name, const char *what) {
  if (!plot_open(f, &x->a, x->s.out, name, 900, 640)) return false;
  output_text(f, "set title \"%s\\n{/*0.85 %s, %s}\"\n", what, law_names[x->s.law],
              path_name(&x->s));
  return true;
}

static bool draw_q_p(element *x) {
  const settings *s = &x->s;
  output f;
  double most = 0.0;
  for (int64_t k = 0; k < x->rows; k++) most = fmax(most, fmax(x->table[k].p, x->table[k].pc));
  if (!open_picture(x, &f, "q_p", "Path of effective stress")) return false;
  output_text(&f, "set xlabel 'p (kPa)'\nset ylabel 'q (kPa)'\nset key left top opaque\n"
                  "set offsets graph 0.05, graph 0.05, graph 0.05, 0\n");
  const char *path =
      "'path.csv' every ::1 using ($6/1000):($7/1000) with lines linewidth 2 "
      "linecolor rgb '#1f4e8c' title 'path', '' every ::1::1 using ($6/1000):($7/1000) "
      "with points pointtype 7 linecolor rgb '#1f4e8c' title 'start'";
  if (s->law == CAM_CLAY) {
    const double first = 1e-3 * x->table[0].pc, last = 1e-3 * x->table[x->rows - 1].pc;
    output_text(&f,
                "set xrange [0:%.9g]\nset samples 400\nM = %.9g\n"
                "p(t, pc) = 0.5*pc*(1 - cos(t))\nq(t, pc) = 0.5*M*pc*sin(t)\n"
                "plot M*x dashtype '--' linecolor rgb '#777777' title 'critical state line', "
                "[t=0:pi] '+' using (p($1, %.9g)):(q($1, %.9g)) with lines linecolor rgb '#e08214' "
                "title 'first yield surface', "
                "[t=0:pi] '+' using (p($1, %.9g)):(q($1, %.9g)) with lines linecolor rgb '#c0392b' "
                "title 'last yield surface', %s\n",
                1.05e-3 * most, s->M, first, first, last, last, path);
  } else {
    output_text(&f, "plot %s\n", path);
  }
  return plot_close(&f, s->out, "q_p");
}

static bool draw_q_strain(element *x) {
  static const char *const axes[] = {"volume strain (%)", "axial strain (%)", "axial strain (%)",
                                     "axial strain (%)",  "axial strain (%)", "axial extension (%)",
                                     "shear strain (%)",  "shear strain (%)", "axial strain (%)",
                                     "axial strain (%)"};
  const double limit = element_limit(x);
  output f;
  if (!open_picture(x, &f, "q_strain", "Deviator stress and pore pressure")) return false;
  output_text(&f,
              "set xlabel '%s'\nset ylabel 'q, u (kPa)'\nset key right bottom opaque\n"
              "set offsets 0, 0, graph 0.05, graph 0.05\n"
              "plot 'path.csv' every ::1 using (100*$1):($7/1000) with lines linewidth 2 "
              "linecolor rgb '#1f4e8c' title 'q', '' every ::1 using (100*$1):($8/1000) with lines "
              "linecolor rgb '#2ca25f' title 'u'",
              axes[x->s.path_file ? FROM_FILE : x->s.path]);
  if (!isnan(limit))
    output_text(&f, ", %.9g dashtype '--' linecolor rgb '#c0392b' title 'limit of q'",
                1e-3 * limit);
  output_text(&f, "\n");
  return plot_close(&f, x->s.out, "q_strain");
}

/* Shear stress against shear strain, and of the small-strain law its backbone. */
static bool draw_loop(element *x) {
  const settings *s = &x->s;
  const bool triaxial = s->path == CYCLIC_TRIAXIAL;
  if (!element_is_cyclic(s)) return true;
  double widest = 0.0;
  for (int64_t k = 0; k < x->rows; k++) widest = fmax(widest, fabs(x->table[k].strain));
  output f;
  if (!open_picture(x, &f, "loop", "Loops of stress and strain")) return false;
  output_text(&f,
              "set xlabel '%s strain (%%)'\nset ylabel '%s stress (kPa)'\n"
              "set key right bottom opaque\nset zeroaxis\nset samples 400\n"
              "set xrange [%.9g:%.9g]\nset offsets 0, 0, graph 0.05, graph 0.05\nplot ",
              triaxial ? "axial" : "shear", triaxial ? "deviator" : "shear", -105.0 * widest,
              105.0 * widest);
  if (s->law == SMALL_STRAIN && !triaxial) {
    const double g0 =
        isnan(s->shear_modulus) ? s->young / (2.0 * (1.0 + s->poisson)) : s->shear_modulus;
    output_text(&f,
                "%.9g*x/(1 + (abs(x)/%.9g)**%.9g) dashtype '--' linecolor rgb '#c0392b' "
                "title 'backbone', ",
                1e-5 * g0, 100.0 * s->reference_strain, s->curvature);
  }
  output_text(&f,
              "'path.csv' every ::1 using (100*$1):(%s/1000) with lines linewidth 1.5 linecolor "
              "rgb '#1f4e8c' title 'path'\n",
              triaxial ? "($2 - $4)" : "$5");
  return plot_close(&f, s->out, "loop");
}

/* Tics 1, 2, 5 times the powers of ten of a range. */
static void decimal_tics(output *f, double low, double high) {
  static const double lead[] = {1.0, 2.0, 5.0};
  const char *between = "";
  output_text(f, "set xtics (");
  for (int power = (int)floor(log10(low)); power <= (int)ceil(log10(high)); power++)
    for (int k = 0; k < 3; k++) {
      const double tic = lead[k] * pow(10.0, power);
      if (tic < low || tic > high) continue;
      output_text(f, "%s%.9g", between, tic);
      between = ", ";
    }
  output_text(f, ")\n");
}

/* Void ratio, or V/V0 where there is none, against the logarithm of p; none where p <= 0. */
static bool draw_e_p(element *x) {
  const settings *s = &x->s;
  const bool known = !isnan(x->table[0].void_ratio);
  double least = INFINITY, most = 0.0;
  for (int64_t k = 0; k < x->rows; k++)
    if (x->table[k].p > 0.0) least = fmin(least, x->table[k].p), most = fmax(most, x->table[k].p);
  if (!(most > 0.0)) return true;
  output f;
  if (!open_picture(x, &f, "e_p", known ? "Void ratio" : "Volume")) return false;
  const double low = 0.7e-3 * least, high = 1.4e-3 * most;
  decimal_tics(&f, low, high);
  output_text(
      &f,
      "set xlabel 'p (kPa)'\nset ylabel '%s'\nset key right top opaque\nset logscale x\n"
      "set xrange [%.9g:%.9g]\nset offsets 0, 0, graph 0.05, graph 0.05\nset samples 400\nplot ",
      known ? "void ratio e" : "V/V_0", low, high);
  if (s->law == CAM_CLAY) {
    const row *r = &x->table[0];
    const double n = r->void_ratio + (s->lambda - s->kappa) * log(1e-3 * r->pc) +
                     s->kappa * log(1e-3 * r->p); /* of virgin compression, e at 1 kPa */
    output_text(
        &f,
        "%.9g - %.9g*log(x) linecolor rgb '#e08214' title 'virgin isotropic compression', "
        "%.9g - %.9g*log(x) dashtype '--' linecolor rgb '#777777' title 'critical state line', ",
        n, s->lambda, n - (s->lambda - s->kappa) * log(2.0), s->lambda);
  }
  output_text(&f,
              "'path.csv' every ::1 using ($6/1000):%d with lines linewidth 2 linecolor rgb "
              "'#1f4e8c' title 'path'\n",
              known ? 9 : 15);
  return plot_close(&f, s->out, "e_p");
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
  if (!write_path(x) || !write_summary(x) || !draw_q_p(x) || !draw_q_strain(x) || !draw_e_p(x) ||
      !draw_loop(x) || !element_write_cycles(x) || !element_draw_cycles(x))
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
