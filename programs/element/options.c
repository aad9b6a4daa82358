/* options.c - the options of mps-element by subject.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "element.h"

#include <math.h>
#include <string.h>

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
      OPTION_CHOICE_OF("path", ELEMENT_PATHS, &s->path, NULL, CU),
      OPTION_TEXT("path-file", &s->path_file, NULL),
      OPTION_NUMBER("strain", &s->strain, NULL, 0.2),
      OPTION_INTEGER("steps", &s->steps, NULL, 1000),
      OPTION_INTEGER_IN("cycles", OPTION_FROM_TO(1.0, 400.0), &s->cycles, "of --path cyclic", 1),
      OPTION_NUMBER("csr", &s->csr, NULL, NAN),
      OPTION_FLAG("drained", &s->drained, NULL),
      OPTION_NUMBER("strain-rate", &s->rate, NULL, 1e-6),
      OPTION_NUMBER("p0", &s->p0, NULL, 100e3),
      OPTION_NUMBER_IN("k0", OPTION_FROM_TO(0.1, 10.0), &s->k0, NULL, 1.0)};
  return put(out, rows, sizeof rows / sizeof *rows);
}

/* The law; Cam-Clay and stiffness at small strains. */
static size_t clay_options(settings *s, option *out) {
  const option rows[] = {
      OPTION_HEADING("Law"),
      OPTION_CHOICE_OF("law", ELEMENT_LAWS, &s->law,
                       "mcc: modified Cam-Clay; smallstrain: Hardin and Drnevich; cyclicsand: "
                       "Mohr-Coulomb that contracts in cycles, Martin, Finn and Seed, Byrne",
                       CAM_CLAY),
      OPTION_NUMBER("M", &s->M, NULL, 0.92),
      OPTION_NUMBER("lambda", &s->lambda, NULL, 0.205),
      OPTION_NUMBER("kappa", &s->kappa, NULL, 0.044),
      OPTION_NUMBER("e0", &s->e0, "default of mcc 1.4", NAN),
      OPTION_NUMBER("ocr", &s->ocr, NULL, 1.0),
      OPTION_NUMBER("shear-modulus", &s->shear_modulus, NULL, NAN),
      OPTION_NUMBER("reference-strain", &s->reference_strain, NULL, 1e-3),
      OPTION_NUMBER("curvature", &s->curvature, NULL, 1.0),
      OPTION_NUMBER("strength", &s->strength, NULL, NAN),
      OPTION_FLAG("lode", &s->lode, NULL)};
  return put(out, rows, sizeof rows / sizeof *rows);
}

/* Elasticity, strength and viscosity. */
static size_t elastic_options(settings *s, option *out) {
  const option rows[] = {
      OPTION_NUMBER("young", &s->young, NULL, 10e6),
      OPTION_NUMBER("poisson", &s->poisson, "default 0.3, of mcc 0.25", NAN),
      OPTION_NUMBER("cohesion", &s->cohesion,
                    "tresca, vonmises: su, default 10 kPa; druckerprager, mohrcoulomb: default 0",
                    NAN),
      OPTION_NUMBER("yield", &s->yield, NULL, NAN),
      OPTION_NUMBER("hardening", &s->hardening, NULL),
      OPTION_NUMBER("phi", &s->phi, "druckerprager, mohrcoulomb", 30.0),
      OPTION_NUMBER("psi", &s->psi, "at most phi"),
      OPTION_NUMBER("emax", &s->e_max, "without it dilation has no end", NAN),
      OPTION_NUMBER("tension", &s->tension, NULL, INFINITY),
      OPTION_CHOICE("cone", &s->cone, "druckerprager"),
      OPTION_NUMBER("bulk", &s->bulk, NULL, 2.2e9),
      OPTION_NUMBER("viscosity", &s->viscosity, "newtonian")};
  return put(out, rows, sizeof rows / sizeof *rows);
}

static size_t sand_options(settings *s, option *out) {
  const option rows[] = {OPTION_HEADING("Contraction in cycles (cyclicsand)"),
                         OPTION_NUMBER("relative-density", &s->relative_density, NULL, NAN),
                         OPTION_NUMBER("blow-count", &s->blow_count, NULL, NAN),
                         OPTION_NUMBER("c1", &s->c[0], NULL, NAN),
                         OPTION_NUMBER("c2", &s->c[1], NULL, NAN),
                         OPTION_NUMBER("c3", &s->c[2], NULL, NAN),
                         OPTION_NUMBER("c4", &s->c[3], NULL, NAN),
                         OPTION_NUMBER("threshold", &s->threshold, NULL, 1e-4),
                         OPTION_NUMBER("strain-limit", &s->strain_limit, NULL, 0.01)};
  return put(out, rows, sizeof rows / sizeof *rows);
}

static size_t softening_options(settings *s, option *out) {
  const option rows[] = {
      OPTION_HEADING("Softening and rate"),
      OPTION_NUMBER("residual", &s->residual, NULL, 1.0),
      OPTION_NUMBER("residual-phi", &s->residual_phi, "mohrcoulomb", NAN),
      OPTION_NUMBER("residual-cohesion", &s->residual_cohesion, "mohrcoulomb", NAN),
      OPTION_NUMBER("slip", &s->slip, NULL, NAN),
      OPTION_NUMBER("band", &s->band, NULL, NAN),
      OPTION_FLAG("linear", &s->linear, "tresca, mohrcoulomb"),
      OPTION_NUMBER("rate-factor", &s->rate_factor, NULL),
      OPTION_NUMBER("rate-reference", &s->rate_reference, NULL, 3e-6)};
  return put(out, rows, sizeof rows / sizeof *rows);
}

static size_t results_options(settings *s, option *out) {
  const option rows[] = {OPTION_HEADING("Results"), OPTIONS_OF_ALL(s)};
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
