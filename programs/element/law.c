/* law.c - the law of mps-element from its options, and the first state of the point.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "element.h"

#include <mps/experimental/soil.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

#define RADIANS (3.14159265358979323846 / 180.0)
#define ROOT3 1.7320508075688772

/* Options that only some laws read, each with a letter for every law, in their order. */
static const struct {
  const char *option, *laws;
} uses[] = {{"young", "ENVTDM  SQ"},
            {"poisson", "ENVTDM CSQ"},
            {"cohesion", "  VTDM   Q"},
            {"phi", "    DM   Q"},
            {"psi", "    DM   Q"},
            {"emax", "    DM   Q"},
            {"tension", "   TDM    "},
            {"cone", "    D     "},
            {"yield", "  V       "},
            {"hardening", "  V       "},
            {"residual", "  VT      "},
            {"residual-phi", "     M    "},
            {"residual-cohesion", "     M    "},
            {"slip", "  VT M    "},
            {"band", "  VT M    "},
            {"linear", "   T M    "},
            {"rate-factor", "  VT M    "},
            {"rate-reference", "  VT M    "},
            {"bulk", "      N   "},
            {"viscosity", "      N   "},
            {"M", "       C  "},
            {"lambda", "       C  "},
            {"kappa", "       C  "},
            {"ocr", "       C  "},
            {"shear-modulus", "       CS "},
            {"lode", "       C  "},
            {"reference-strain", "        S "},
            {"curvature", "        S "},
            {"strength", "        S "},
            {"relative-density", "         Q"},
            {"blow-count", "         Q"},
            {"c1", "         Q"},
            {"c2", "         Q"},
            {"c3", "         Q"},
            {"c4", "         Q"},
            {"threshold", "         Q"},
            {"strain-limit", "         Q"},
            {"p0", "E VTDM CSQ"},
            {"k0", "E VTDM CSQ"}};

static const char *check_uses(const settings *s, const option *table) {
  static char text[160];
  static const char *const names[] = {"elastic",       "neohookean",  "vonmises",  "tresca",
                                      "druckerprager", "mohrcoulomb", "newtonian", "mcc",
                                      "smallstrain",   "cyclicsand"};
  for (size_t k = 0; k < sizeof uses / sizeof *uses; k++) {
    if (!options_given(table, uses[k].option) || uses[k].laws[s->law] != ' ') continue;
    char list[100] = "";
    for (int law = 0; law < LAWS; law++)
      if (uses[k].laws[law] != ' ')
        snprintf(list + strlen(list), sizeof list - strlen(list), "%s%s", list[0] ? ", " : "",
                 names[law]);
    snprintf(text, sizeof text, "--%s is for --law %s", uses[k].option, list);
    return text;
  }
  return NULL;
}

const char *element_settle(settings *s, const option *table) {
  const char *unused = check_uses(s, table);
  if (unused) return unused;
  const bool starts = s->law != NEO_HOOKEAN && s->law != NEWTONIAN;
  if (options_given(table, "yield") && options_given(table, "cohesion"))
    return "--yield and --cohesion exclude each other";
  if (s->path_file && (options_given(table, "path") || options_given(table, "strain") ||
                       options_given(table, "steps")))
    return "--path-file excludes --path, --strain and --steps, which stand in the file";
  if (isnan(s->poisson)) s->poisson = s->law == CAM_CLAY ? 0.25 : 0.3;
  if (isnan(s->e0) && s->law == CAM_CLAY) s->e0 = 1.4;
  if (!starts) s->p0 = 0.0;
  if (isnan(s->cohesion)) s->cohesion = s->law == VON_MISES || s->law == TRESCA ? 10e3 : 0.0;
  if (s->law == TRESCA) s->phi = s->psi = 0.0;
  if (isnan(s->yield)) s->yield = ROOT3 * s->cohesion;
  if (s->psi > s->phi) return "--psi must be at most --phi";
  if (!isnan(s->e_max) && !(s->e0 <= s->e_max))
    return "--emax asks for --e0, the void ratio at the start, of at most --emax";
  const bool cyclic = element_is_cyclic(s);
  if (s->cycles > 1 && !cyclic) return "--cycles is for --path cyclic, cyclic-triaxial";
  if (s->drained && !cyclic) return "--drained is for --path cyclic, cyclic-triaxial";
  if (!isnan(s->csr) && !cyclic) return "--csr is for --path cyclic, cyclic-triaxial";
  if (!isnan(s->csr) && options_given(table, "strain"))
    return "--csr and --strain exclude each other";
  if (!isnan(s->csr) && !(s->p0 > 0.0)) return "--csr needs --p0 above 0";
  const int densities = !isnan(s->relative_density) + !isnan(s->blow_count) + !isnan(s->c[0]);
  if (densities > 1) return "--relative-density, --blow-count and --c1 exclude one another";
  if (s->law == CYCLIC_SAND && densities == 0) s->relative_density = 0.5;
  if (s->law == CAM_CLAY && !(s->kappa < s->lambda)) return "--kappa must be below --lambda";
  if (s->law == CAM_CLAY && s->p0 <= 0.0) return "--p0 must be above 0 for --law mcc";
  const bool softens = s->residual < 1.0 || !isnan(s->residual_phi) || !isnan(s->residual_cohesion);
  if (softens && (isnan(s->slip) || isnan(s->band)))
    return "softening needs --slip and --band, the width over which it is spread";
  if (!softens && (!isnan(s->slip) || !isnan(s->band) || s->linear))
    return "--slip, --band and --linear are of a strength that falls to --residual, "
           "--residual-phi or --residual-cohesion";
  if (options_given(table, "rate-reference") && s->rate_factor == 0.0)
    return "--rate-reference needs --rate-factor above 0";
  return NULL;
}

/* ---- the law --------------------------------------------------------------------------------- */

/* pc: --ocr times that of the yield surface through the first stress, which with --lode is smaller
 * in extension, horizontal stresses above the vertical one. */
static double first_preconsolidation(const settings *s) {
  const double vertical = 3.0 * s->p0 / (1.0 + 2.0 * s->k0), q = fabs(1.0 - s->k0) * vertical;
  const double sine = 3.0 * s->M / (6.0 + s->M);
  const double slope = s->lode && s->k0 > 1.0 ? s->M * (3.0 - sine) / (3.0 + sine) : s->M;
  return s->ocr * (s->p0 + q * q / (slope * slope * s->p0));
}

static bool make_cam_clay(element *x) {
  const settings *s = &x->s;
  mps_material_cam_clay_def d = mps_material_cam_clay_defaults();
  d.critical_slope = s->M;
  d.compression = s->lambda;
  d.swelling = s->kappa;
  d.poisson = s->poisson;
  d.shear_modulus = s->shear_modulus;
  d.void_ratio = s->e0;
  d.lode = s->lode;
  d.preconsolidation = first_preconsolidation(s);
  return app_check(&x->a, mps_material_create_cam_clay(x->a.context, &d, &x->material));
}

static double small_shear(const settings *s) {
  return isnan(s->shear_modulus) ? s->young / (2.0 * (1.0 + s->poisson)) : s->shear_modulus;
}

static bool make_small_strain(element *x) {
  const settings *s = &x->s;
  mps_material_small_strain_def d = mps_material_small_strain_defaults();
  d.shear_modulus = small_shear(s), d.poisson = s->poisson;
  d.reference_strain = s->reference_strain, d.curvature = s->curvature, d.strength = s->strength;
  return app_check(&x->a, mps_material_create_small_strain(x->a.context, &d, &x->material));
}

static bool make_von_mises(element *x) {
  const settings *s = &x->s;
  mps_material_von_mises_def d = mps_material_von_mises_defaults();
  d.young = s->young, d.poisson = s->poisson;
  d.yield_stress = s->yield, d.hardening = s->hardening;
  d.residual = s->residual, d.slip = s->slip, d.band = s->band;
  d.rate_factor = s->rate_factor, d.rate_reference = s->rate_reference;
  return app_check(&x->a, mps_material_create_von_mises(x->a.context, &d, &x->material));
}

/* The void ratio at the start, where dilation ends at e_max. */
static double first_voids(const settings *s) { return isnan(s->e_max) ? NAN : s->e0; }

static bool make_mohr_coulomb(element *x) {
  const settings *s = &x->s;
  mps_material_mohr_coulomb_def d = mps_material_mohr_coulomb_defaults();
  d.young = s->young, d.poisson = s->poisson;
  d.friction = s->phi * RADIANS, d.dilation = s->psi * RADIANS;
  d.cohesion = s->cohesion, d.tension = s->tension;
  d.void_ratio = first_voids(s), d.max_void_ratio = s->e_max;
  d.residual_friction = s->residual_phi * RADIANS;
  d.residual_cohesion =
      s->law == TRESCA && s->residual < 1.0 ? s->residual * s->cohesion : s->residual_cohesion;
  d.slip = s->slip, d.band = s->band;
  d.softening = s->linear ? MPS_MATERIAL_SOFTENING_LINEAR : MPS_MATERIAL_SOFTENING_EXPONENTIAL;
  d.rate_factor = s->rate_factor, d.rate_reference = s->rate_reference;
  return app_check(&x->a, mps_material_create_mohr_coulomb(x->a.context, &d, &x->material));
}

static bool make_drucker_prager(element *x) {
  const settings *s = &x->s;
  mps_material_drucker_prager_def d = mps_material_drucker_prager_defaults();
  d.young = s->young, d.poisson = s->poisson, d.cone = s->cone;
  d.friction = s->phi * RADIANS, d.dilation = s->psi * RADIANS;
  d.cohesion = s->cohesion, d.tension = s->tension;
  d.void_ratio = first_voids(s), d.max_void_ratio = s->e_max;
  return app_check(&x->a, mps_material_create_drucker_prager(x->a.context, &d, &x->material));
}

static bool make_cyclic_sand(element *x) {
  const settings *s = &x->s;
  mps_material_cyclic_sand_def d = mps_material_cyclic_sand_defaults();
  d.young = s->young, d.poisson = s->poisson;
  d.friction = s->phi * RADIANS, d.dilation = s->psi * RADIANS, d.cohesion = s->cohesion;
  d.relative_density = s->relative_density, d.blow_count = s->blow_count;
  d.c1 = s->c[0], d.c2 = s->c[1], d.c3 = s->c[2], d.c4 = s->c[3];
  d.threshold = s->threshold, d.strain_limit = s->strain_limit;
  d.void_ratio = first_voids(s), d.max_void_ratio = s->e_max;
  return app_check(&x->a, mps_material_create_cyclic_sand(x->a.context, &d, &x->material));
}

bool element_make_law(element *x) {
  const settings *s = &x->s;
  mps_context *c = x->a.context;
  mps_material_newtonian_def water = mps_material_newtonian_defaults();
  switch (s->law) {
  case ELASTIC:
    return app_check(&x->a,
                     mps_material_create_linear_elastic(c, s->young, s->poisson, &x->material));
  case NEO_HOOKEAN:
    return app_check(&x->a, mps_material_create_neo_hookean(c, s->young, s->poisson, &x->material));
  case VON_MISES:
    return make_von_mises(x);
  case DRUCKER_PRAGER:
    return make_drucker_prager(x);
  case NEWTONIAN:
    water.bulk_modulus = s->bulk, water.viscosity = s->viscosity;
    return app_check(&x->a, mps_material_create_newtonian(c, &water, &x->material));
  case CAM_CLAY:
    return make_cam_clay(x);
  case SMALL_STRAIN:
    return make_small_strain(x);
  case CYCLIC_SAND:
    return make_cyclic_sand(x);
  default:
    return make_mohr_coulomb(x);
  }
}

/* ---- the first state ------------------------------------------------------------------------- */

static int column_of(const element *x, const char *name) {
  for (int32_t c = 0; c < mps_material_history_count(x->material); c++)
    if (strcmp(mps_material_history_name(x->material, c), name) == 0) return c;
  return -1;
}

bool element_start(element *x) {
  const settings *s = &x->s;
  if (!app_check(&x->a, mps_material_point_init(x->a.context, x->material, &x->point)))
    return false;
  x->pc_at = column_of(x, "preconsolidation");
  x->void_at = column_of(x, "void_ratio");
  x->plastic_at = column_of(x, "plastic_strain");
  x->contraction_at = column_of(x, "contraction");
  const double vertical = 3.0 * s->p0 / (1.0 + 2.0 * s->k0);
  /* the axis of compression: y in plane strain and shear, else z */
  const int up = s->path == PS_UNDRAINED || s->path == SHEAR || s->path == CYCLIC ? 1 : 2;
  for (int c = 0; c < 3; c++) x->point.stress[c] = c == up ? -vertical : -s->k0 * vertical;
  return true;
}

/* ---- theory ---------------------------------------------------------------------------------- */

/* p of the critical state at the first void ratio: undrained. */
static double critical_p(const settings *s) {
  const double pc = first_preconsolidation(s), share = s->kappa / s->lambda;
  return pow(0.5 * pc, 1.0 - share) * pow(s->p0, share);
}

static double limit_of_clay(const settings *s) {
  const double sine = 3.0 * s->M / (6.0 + s->M);
  const double lateral = 3.0 * s->k0 * s->p0 / (1.0 + 2.0 * s->k0);
  switch (s->path) {
  case CU:
    return s->M * critical_p(s);
  case CD:
    return s->M < 3.0 ? s->M * 3.0 * lateral / (3.0 - s->M) : NAN;
  case EXTENSION:
    return critical_p(s) * (s->lode ? 6.0 * sine / (3.0 + sine) : s->M);
  case PS_UNDRAINED:
  case SHEAR:
    return s->lode ? NAN : s->M * critical_p(s);
  default:
    return NAN;
  }
}

/* Mohr-Coulomb, sigma1 - sigma3 = (sigma1 + sigma3) sin(phi) + 2 c cos(phi): q in triaxial tests.
 * Without dilation undrained shear keeps p (the elastic law does, and no volume is plastic), with
 * it the strength has no limit. */
static double limit_of_friction(const settings *s, double lateral) {
  const double sine = sin(s->phi * RADIANS), cosine = cos(s->phi * RADIANS);
  const double kp = (1.0 + sine) / (1.0 - sine);
  const double twice = 2.0 * (s->p0 * sine + s->cohesion * cosine);
  if (s->path == CD) return (kp - 1.0) * lateral + 2.0 * s->cohesion * sqrt(kp);
  if (s->psi > 0.0 || s->tension < INFINITY) return NAN;
  if (s->path == CU) return twice / (1.0 - sine / 3.0);
  return s->path == EXTENSION ? twice / (1.0 + sine / 3.0) : NAN;
}

double element_limit(const element *x) {
  const settings *s = &x->s;
  const bool sheared = s->path == CU || s->path == CD || s->path == EXTENSION;
  const double lateral = 3.0 * s->k0 * s->p0 / (1.0 + 2.0 * s->k0);
  const bool firm = s->hardening == 0.0 && s->residual == 1.0 && s->rate_factor == 0.0 &&
                    isnan(s->residual_phi) && isnan(s->residual_cohesion);
  if (s->path_file) return NAN;
  if (s->law == CAM_CLAY) return limit_of_clay(s);
  if (s->law == SMALL_STRAIN && s->path >= CU)
    return ROOT3 * (isnan(s->strength) ? s->reference_strain * small_shear(s) : s->strength);
  if (!firm) return NAN;
  if (s->law == VON_MISES && s->path >= CU) return s->yield;
  if (s->law == TRESCA && sheared) return 2.0 * s->cohesion;
  return s->law == MOHR_COULOMB && sheared ? limit_of_friction(s, lateral) : NAN;
}
