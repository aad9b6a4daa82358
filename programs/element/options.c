/* options.c - the options of mps-element by subject, and their defaults.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "element.h"

#include <math.h>
#include <string.h>

settings element_defaults(void) {
  return (settings){.law = CAM_CLAY,
                    .path = CU,
                    .strain = 0.2,
                    .rate = 1e-6,
                    .steps = 1000,
                    .cycles = 1,
                    .threads = 1,
                    .p0 = 100e3,
                    .k0 = 1.0,
                    .young = 10e6,
                    .poisson = NAN,
                    .nu = NAN,
                    .cohesion = NAN,
                    .phi = 30.0,
                    .tension = INFINITY,
                    .yield = NAN,
                    .residual = 1.0,
                    .residual_phi = NAN,
                    .residual_cohesion = NAN,
                    .slip = NAN,
                    .band = NAN,
                    .rate_reference = 3e-6,
                    .bulk = 2.2e9,
                    .M = 0.92,
                    .lambda = 0.205,
                    .kappa = 0.044,
                    .e0 = NAN,
                    .e_max = NAN,
                    .ocr = 1.0,
                    .shear_modulus = NAN,
                    .reference_strain = 1e-3,
                    .curvature = 1.0,
                    .strength = NAN,
                    .csr = NAN,
                    .relative_density = NAN,
                    .blow_count = NAN,
                    .c = {NAN, NAN, NAN, NAN},
                    .threshold = 1e-4,
                    .strain_limit = 0.01,
                    .out = "out/element"};
}

/* ---- by subject ------------------------------------------------------------------------------ */

/* To the table; returns how many rows. */
static size_t put(option *out, const option *rows, size_t count) {
  memcpy(out, rows, count * sizeof *rows);
  return count;
}

/* The path, and the first state. */
static size_t path_options(settings *s, option *out) {
  const option rows[] = {
      OPTION_HEADING("Path"),
      OPTION_CHOICE("path", ELEMENT_PATHS, &s->path,
                    "isotropic, oedometer, triaxial undrained and drained, plane strain, triaxial "
                    "extension (both undrained), simple shear, and that to and fro; triaxial "
                    "compression and extension in turns"),
      OPTION_TEXT("path-file", "FILE", &s->path_file,
                  "CSV of stages instead: increments of strain exx, eyy, ezz, gxy, gzx, gyz or of "
                  "stress sxx, syy, szz, sxy, szx, syz (Pa), tension positive, and steps; an empty "
                  "cell is no strain"),
      OPTION_NUMBER(
          "strain", "1", OPTION_ABOVE_TO(0.0, 10.0), &s->strain,
          "logarithmic, at the end: axial, of the volume (iso), gamma (shear), or its amplitude "
          "(cyclic)"),
      OPTION_INTEGER("steps", "N", OPTION_FROM_TO(1.0, 1e6), &s->steps,
                     "steps of the path, or of a loop of the cyclic one"),
      OPTION_INTEGER("cycles", "N", OPTION_FROM_TO(1.0, 400.0), &s->cycles, "cyclic: loops"),
      OPTION_NUMBER("csr", "1", OPTION_ABOVE_TO(0.0, 10.0), &s->csr,
                    "cyclic: stress in place of --strain, shear over first vertical effective "
                    "stress (triaxial: q over twice p0)"),
      OPTION_FLAG("drained", &s->drained,
                  "cyclic: vertical (triaxial: lateral) stress stays, not the volume"),
      OPTION_NUMBER("strain-rate", "1/s", OPTION_FROM_TO(1e-12, 1e6), &s->rate,
                    "rate of the largest strain, for laws that know time"),
      OPTION_NUMBER("p0", "Pa", OPTION_FROM_TO(0.0, 1e11), &s->p0,
                    "first mean effective pressure; laws of F or V/V0 begin without stress"),
      OPTION_NUMBER("k0", "1", OPTION_FROM_TO(0.1, 10.0), &s->k0,
                    "first horizontal over vertical effective stress")};
  return put(out, rows, sizeof rows / sizeof *rows);
}

/* The law; Cam-Clay and stiffness at small strains. */
static size_t clay_options(settings *s, option *out) {
  const option rows[] = {
      OPTION_HEADING("Law"),
      OPTION_CHOICE("law", ELEMENT_LAWS, &s->law,
                    "law; mcc: modified Cam-Clay; smallstrain: Hardin and Drnevich; cyclicsand: "
                    "Mohr-Coulomb that contracts in cycles, Martin, Finn and Seed, Byrne"),
      OPTION_NUMBER("M", "1", OPTION_FROM_TO(0.05, 2.9), &s->M, "mcc: critical q/p in compression"),
      OPTION_NUMBER("lambda", "1", OPTION_FROM_TO(1e-4, 5.0), &s->lambda,
                    "mcc: slope of virgin compression in e - ln p"),
      OPTION_NUMBER("kappa", "1", OPTION_FROM_TO(1e-5, 5.0), &s->kappa,
                    "mcc: slope of unloading, below lambda"),
      OPTION_NUMBER("e0", "1", OPTION_FROM_TO(0.01, 20.0), &s->e0,
                    "first void ratio; default of mcc 1.4"),
      OPTION_NUMBER("ocr", "1", OPTION_FROM_TO(1.0, 1000.0), &s->ocr,
                    "mcc: size of the yield surface over that through the first stress"),
      OPTION_NUMBER(
          "shear-modulus", "Pa", OPTION_MODULUS, &s->shear_modulus,
          "mcc: constant G, default by Poisson's ratio; smallstrain: G at zero strain, default "
          "by Young's modulus"),
      OPTION_NUMBER("reference-strain", "1", OPTION_FROM_TO(1e-7, 1.0), &s->reference_strain,
                    "smallstrain: gamma at which half of G is left"),
      OPTION_NUMBER("curvature", "1", OPTION_FROM_TO(0.5, 1.0), &s->curvature,
                    "smallstrain: exponent of the backbone"),
      OPTION_NUMBER(
          "strength", "Pa", OPTION_STRENGTH, &s->strength,
          "smallstrain: largest sqrt(J2); default, with curvature 1: that of the backbone"),
      OPTION_FLAG("lode", &s->lode, "mcc: M follows the Lode angle")};
  return put(out, rows, sizeof rows / sizeof *rows);
}

/* Elasticity, strength and viscosity. */
static size_t elastic_options(settings *s, option *out) {
  const option rows[] = {
      COMMON_NUMBER("young", &s->young, NULL),
      COMMON_NUMBER("poisson", &s->poisson, "default 0.3, of mcc 0.25"),
      OPTION_NUMBER("nu", "1", OPTION_FROM_TO(0.0, 0.49), &s->nu, "the same as --poisson"),
      COMMON_NUMBER("cohesion", &s->cohesion,
                    "tresca, vonmises: su, default 10 kPa; druckerprager, mohrcoulomb: default 0"),
      OPTION_NUMBER("yield", "Pa", OPTION_ABOVE_TO(0.0, 1e11), &s->yield,
                    "vonmises: yield stress; default sqrt(3) times the cohesion"),
      OPTION_NUMBER("hardening", "Pa", OPTION_STRENGTH, &s->hardening,
                    "vonmises: linear, per plastic strain"),
      COMMON_NUMBER("phi", &s->phi, "druckerprager, mohrcoulomb"),
      COMMON_NUMBER("psi", &s->psi, "at most phi"),
      OPTION_NUMBER("emax", "1", OPTION_FROM_TO(0.01, 20.0), &s->e_max,
                    "void ratio at which dilation ends, from --e0, which is emax - Dr (emax - "
                    "emin); without it dilation has no end"),
      OPTION_NUMBER("tension", "Pa", OPTION_STRENGTH, &s->tension,
                    "largest tension; default: up to the apex"),
      OPTION_CHOICE("cone", "planestrain|circumscribed|inscribed|extension", &s->cone,
                    "druckerprager: where the cone agrees with Mohr and Coulomb"),
      OPTION_NUMBER("bulk", "Pa", OPTION_MODULUS, &s->bulk, "newtonian: bulk modulus"),
      COMMON_NUMBER("viscosity", &s->viscosity, "newtonian")};
  return put(out, rows, sizeof rows / sizeof *rows);
}

static size_t sand_options(settings *s, option *out) {
  const option rows[] = {
      OPTION_HEADING("Contraction in cycles (cyclicsand)"),
      OPTION_NUMBER("relative-density", "1", OPTION_FROM_TO(0.1, 1.0), &s->relative_density,
                    "Dr; default 0.5 where neither (N1)60 nor C1 is given"),
      OPTION_NUMBER("blow-count", "1", OPTION_FROM_TO(1.0, 60.0), &s->blow_count, "(N1)60"),
      OPTION_NUMBER("c1", "1", OPTION_FROM_TO(1e-4, 100.0), &s->c[0], "C1"),
      OPTION_NUMBER("c2", "1", OPTION_FROM_TO(0.0, 100.0), &s->c[1], "C2; default 0.4/C1"),
      OPTION_NUMBER("c3", "1", OPTION_FROM_TO(1e-4, 100.0), &s->c[2],
                    "C3 and C4: the equation of Martin, Finn and Seed, not that of Byrne"),
      OPTION_NUMBER("c4", "1", OPTION_FROM_TO(1e-4, 100.0), &s->c[3], "C4"),
      OPTION_NUMBER("threshold", "1", OPTION_FROM_TO(0.0, 0.01), &s->threshold,
                    "amplitude of shear strain without contraction"),
      OPTION_NUMBER("strain-limit", "1", OPTION_ABOVE_TO(0.0, 1.0), &s->strain_limit,
                    "amplitude beyond which larger ones contract no more")};
  return put(out, rows, sizeof rows / sizeof *rows);
}

static size_t softening_options(settings *s, option *out) {
  const option rows[] = {
      OPTION_HEADING("Softening and rate"),
      OPTION_NUMBER("residual", "1", OPTION_FROM_TO(0.0, 1.0), &s->residual,
                    "vonmises, tresca: last over first strength"),
      OPTION_NUMBER("residual-phi", "degrees", OPTION_FROM_TO(0.0, 60.0), &s->residual_phi,
                    "mohrcoulomb; default phi"),
      OPTION_NUMBER("residual-cohesion", "Pa", OPTION_STRENGTH, &s->residual_cohesion,
                    "mohrcoulomb; default cohesion"),
      OPTION_NUMBER("slip", "m", OPTION_LENGTH, &s->slip,
                    "across a band, at which 1/e of the fall is left"),
      OPTION_NUMBER("band", "m", OPTION_LENGTH, &s->band, "width of the band"),
      OPTION_FLAG("linear", &s->linear, "tresca, mohrcoulomb: linear fall, over at --slip"),
      OPTION_NUMBER("rate-factor", "1", OPTION_FROM_TO(0.0, 10.0), &s->rate_factor,
                    "growth of the strength for a tenfold rate"),
      OPTION_NUMBER("rate-reference", "1/s", OPTION_FROM_TO(1e-12, 1e6), &s->rate_reference,
                    "rate up to which there is no growth")};
  return put(out, rows, sizeof rows / sizeof *rows);
}

static size_t results_options(settings *s, option *out) {
  const option rows[] = {OPTION_HEADING("Results"), OPTION_OUT(&s->out),
                         OPTION_THREADS(&s->threads)};
  return put(out, rows, sizeof rows / sizeof *rows);
}

/* ---- all ------------------------------------------------------------------------------------- */

void element_options(settings *s, option *table) {
  size_t rows = path_options(s, table);
  rows += clay_options(s, table + rows);
  rows += elastic_options(s, table + rows);
  rows += sand_options(s, table + rows);
  rows += softening_options(s, table + rows);
  rows += results_options(s, table + rows);
  table[rows] = (option){0};
}
