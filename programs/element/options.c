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
      OPTION_CHOICE_OF("path", ELEMENT_PATHS, &s->path, NULL),
      OPTION_TEXT("path-file", &s->path_file, NULL),
      OPTION_NUMBER("strain", &s->strain, NULL),
      OPTION_INTEGER("steps", &s->steps, NULL),
      OPTION_INTEGER_IN("cycles", OPTION_FROM_TO(1.0, 400.0), &s->cycles, "of --path cyclic"),
      OPTION_NUMBER("csr", &s->csr, NULL),
      OPTION_FLAG("drained", &s->drained, NULL),
      OPTION_NUMBER("strain-rate", &s->rate, NULL),
      OPTION_NUMBER("p0", &s->p0, NULL),
      OPTION_NUMBER_IN("k0", OPTION_FROM_TO(0.1, 10.0), &s->k0, NULL)};
  return put(out, rows, sizeof rows / sizeof *rows);
}

/* The law; Cam-Clay and stiffness at small strains. */
static size_t clay_options(settings *s, option *out) {
  const option rows[] = {
      OPTION_HEADING("Law"),
      OPTION_CHOICE_OF("law", ELEMENT_LAWS, &s->law,
                       "law; mcc: modified Cam-Clay; smallstrain: Hardin and Drnevich; cyclicsand: "
                       "Mohr-Coulomb that contracts in cycles, Martin, Finn and Seed, Byrne"),
      OPTION_NUMBER("M", &s->M, NULL),
      OPTION_NUMBER("lambda", &s->lambda, NULL),
      OPTION_NUMBER("kappa", &s->kappa, NULL),
      OPTION_NUMBER("e0", &s->e0, "default of mcc 1.4"),
      OPTION_NUMBER("ocr", &s->ocr, NULL),
      OPTION_NUMBER("shear-modulus", &s->shear_modulus, NULL),
      OPTION_NUMBER("reference-strain", &s->reference_strain, NULL),
      OPTION_NUMBER("curvature", &s->curvature, NULL),
      OPTION_NUMBER("strength", &s->strength, NULL),
      OPTION_FLAG("lode", &s->lode, NULL)};
  return put(out, rows, sizeof rows / sizeof *rows);
}

/* Elasticity, strength and viscosity. */
static size_t elastic_options(settings *s, option *out) {
  const option rows[] = {
      OPTION_NUMBER("young", &s->young, NULL),
      OPTION_NUMBER("poisson", &s->poisson, "default 0.3, of mcc 0.25"),
      OPTION_NUMBER("cohesion", &s->cohesion,
                    "tresca, vonmises: su, default 10 kPa; druckerprager, mohrcoulomb: default 0"),
      OPTION_NUMBER("yield", &s->yield, NULL),
      OPTION_NUMBER("hardening", &s->hardening, NULL),
      OPTION_NUMBER("phi", &s->phi, "druckerprager, mohrcoulomb"),
      OPTION_NUMBER("psi", &s->psi, "at most phi"),
      OPTION_NUMBER("emax", &s->e_max, "without it dilation has no end"),
      OPTION_NUMBER("tension", &s->tension, NULL),
      OPTION_CHOICE("cone", &s->cone, "druckerprager"),
      OPTION_NUMBER("bulk", &s->bulk, NULL),
      OPTION_NUMBER("viscosity", &s->viscosity, "newtonian")};
  return put(out, rows, sizeof rows / sizeof *rows);
}

static size_t sand_options(settings *s, option *out) {
  const option rows[] = {OPTION_HEADING("Contraction in cycles (cyclicsand)"),
                         OPTION_NUMBER("relative-density", &s->relative_density, NULL),
                         OPTION_NUMBER("blow-count", &s->blow_count, NULL),
                         OPTION_NUMBER("c1", &s->c[0], NULL),
                         OPTION_NUMBER("c2", &s->c[1], NULL),
                         OPTION_NUMBER("c3", &s->c[2], NULL),
                         OPTION_NUMBER("c4", &s->c[3], NULL),
                         OPTION_NUMBER("threshold", &s->threshold, NULL),
                         OPTION_NUMBER("strain-limit", &s->strain_limit, NULL)};
  return put(out, rows, sizeof rows / sizeof *rows);
}

static size_t softening_options(settings *s, option *out) {
  const option rows[] = {OPTION_HEADING("Softening and rate"),
                         OPTION_NUMBER("residual", &s->residual, NULL),
                         OPTION_NUMBER("residual-phi", &s->residual_phi, "mohrcoulomb"),
                         OPTION_NUMBER("residual-cohesion", &s->residual_cohesion, "mohrcoulomb"),
                         OPTION_NUMBER("slip", &s->slip, NULL),
                         OPTION_NUMBER("band", &s->band, NULL),
                         OPTION_FLAG("linear", &s->linear, "tresca, mohrcoulomb"),
                         OPTION_NUMBER("rate-factor", &s->rate_factor, NULL),
                         OPTION_NUMBER("rate-reference", &s->rate_reference, NULL)};
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
