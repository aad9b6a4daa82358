/* layers.h - horizontal soil layers, from the ground surface down, and the file that lists them.
 *
 * One layer a line, by a header as table.h reads it. Each program reads the columns that it needs
 * and passes over those that only others need (LAYERS_OTHERS), so that one file may serve several.
 * Here: thickness_m, vs_m_s, vp_m_s, unit_weight_kN_m3 or density_kg_m3, damping_ratio.
 * SPDX-License-Identifier: BSD-3-Clause */
#pragma once

#include "app.h"

typedef struct layer {
  double thickness;   /* m */
  double vs, vp;      /* m/s */
  double unit_weight; /* N/m3 */
  double damping;     /* ratio h */
} layer;

#define LAYERS_OTHERS                                                                              \
  "thickness|vs|vp|unit weight|density|damping|poisson|k0|phi|psi|cohesion|e0|emax|permeability|"  \
  "porosity|modulus|law|reference strain|curvature|strength|relative density|blow count"

#define LAYERS_MAX 200
/* Unit weight to density with the paper's g: 14700 N/m3 is 1500 kg/m3. */
#define LAYERS_GRAVITY 9.8

typedef struct layers {
  int64_t count;
  layer layer[LAYERS_MAX];
  layer below; /* the half space, a last row of thickness inf; of thickness 0: there is none */
} layers;

/* Reads the file; errors are "path:line: reason". */
bool layers_read(app *a, const char *path, layers *out);
double layers_thickness(const layers *ground);
/* The layer at `depth` (m) below the surface; the last one continues downwards. */
const layer *layers_at(const layers *ground, double depth);
/* What waves much longer than the span between two depths (m) feel: the compliances of its parts
 * add up (harmonic mean of the moduli), their masses too, the damping is by their shares of the
 * strain energy. The layer itself where there is one alone. */
layer layers_mean(const layers *ground, double top, double bottom);
/* The first layer thinner than `size` (m); -1: none. */
int64_t layers_thin(const layers *ground, double size);
double layers_density(const layer *l); /* kg/m3 */
/* Time (s) that a wave 'S' or 'P' takes from depth `from` up to depth `to` (m). */
double layers_travel_time(const layers *ground, char wave, double from, double to);
