/* ground.c - layers of the ground behind a wall and water in them: densities, stresses at rest, and
 * the force on the wall by theory.
 *
 * Depths are those below the surface behind the wall. Below the water table the water is at rest on
 * both sides and does not pass below the toe: effective stresses carry the weight less the
 * buoyancy, phi and cohesion are effective, and the pressure of the water on the wall comes
 * besides. SPDX-License-Identifier: BSD-3-Clause */
#include "common/layers.h"
#include "common/table.h"
#include "wall.h"

#include <mps/soil.h>
#include <mps/mpm.h>

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#define DEGREE (3.14159265358979323846 / 180.0)
#define WATER 1000.0   /* kg/m3 */
enum { PARTS = 1000 }; /* of each piece of an integral */

/* ---- layers ---------------------------------------------------------------------------------- */

const wall_layer *wall_layer_at(const settings *s, double depth) {
  double bottom = 0.0;
  for (int k = 0; k + 1 < s->layers; k++) {
    bottom += s->layer[k].thickness;
    if (depth < bottom) return &s->layer[k];
  }
  return &s->layer[s->layers - 1];
}

bool wall_is_plain(const settings *s) { return s->layers == 1 && isnan(s->water); }

static double wet_depth(const settings *s) { return isnan(s->water) ? INFINITY : s->water; }

/* Of the ground between two depths, total and less the buoyancy, Pa. */
static void weigh(const settings *s, double from, double to, double *total, double *buoyant) {
  double top = 0.0;
  *total = 0.0;
  for (int k = 0; k < s->layers; k++) {
    const wall_layer *l = &s->layer[k];
    const double bottom = k + 1 < s->layers ? top + l->thickness : INFINITY;
    const double part = fmin(bottom, to) - fmax(top, from);
    if (part > 0.0) *total += l->density * s->gravity * part;
    top = bottom;
  }
  *buoyant = *total - WATER * s->gravity * fmax(0.0, to - fmax(from, wet_depth(s)));
}

/* ---- options --------------------------------------------------------------------------------- */

static const char *fault(const double *row) {
  if (!(row[2] <= row[1])) return "psi_degrees must be at most phi_degrees";
  if (row[1] == 0.0 && row[3] == 0.0) return "phi_degrees and cohesion_Pa must not both be 0";
  return NULL;
}

static const char *read_layers(settings *s) {
  static const table_def def = {
      .row = "layer",
      .column = {{"thickness", "m", "m", 0.0, 1e4, .open = true, .endless = true},
                 {"phi", "degrees", "degrees", 0.0, 50.0, .open = false},
                 {"psi", "degrees", "degrees", 0.0, 50.0, .open = false},
                 {"cohesion", "Pa", "Pa", 0.0, 1e9, .open = false},
                 {"density", "kg/m3", "kg/m3", 500.0, 5000.0, .open = false}},
      .count = 5,
      .others = LAYERS_OTHERS,
      .most = WALL_LAYERS,
      .fault = fault};
  static char why[600];
  double rows[5 * WALL_LAYERS];
  int64_t count = 0;
  if (!table_read(s->layers_file, &def, rows, &count, why, sizeof why)) return why;
  s->layers = (int)count;
  for (int k = 0; k < s->layers; k++) {
    const double *r = rows + 5 * k;
    s->layer[k] = (wall_layer){r[0], r[1], r[2], r[3], r[4]};
  }
  return NULL;
}

/* Layers begin and end at faces of particles. */
static const char *place_layers(settings *s) {
  static char why[200];
  const double spacing = s->h / sqrt((double)s->ppc);
  double given = 0.0, top = 0.0;
  for (int k = 0; k + 1 < s->layers; k++) {
    wall_layer *l = &s->layer[k];
    if (l->thickness < s->h * (1.0 - 1e-9)) {
      snprintf(why, sizeof why,
               "--layers: layer %d: thickness_m is %g, must be at least a cell, %g: give a smaller "
               "--cell",
               k + 1, l->thickness, s->h);
      return why;
    }
    given += l->thickness;
    const double bottom = spacing * nearbyint(given / spacing);
    if (fabs(given - bottom) > 1e-5 * spacing)
      options_note("layer %d of --layers ends at %.6g m, taken as %.6g m: a whole multiple of the "
                   "particles' spacing, %.6g m",
                   k + 1, given, bottom, spacing);
    l->thickness = bottom - top, top = bottom;
  }
  return NULL;
}

const char *wall_settle_ground(settings *s, const option *table) {
  static const char *const own[] = {"phi", "psi", "cohesion", "density"};
  s->layers = 1;
  s->layer[0] = (wall_layer){INFINITY, s->phi, s->psi, s->cohesion, s->density};
  for (size_t k = 0; k < sizeof own / sizeof *own && s->layers_file; k++)
    if (options_given(table, own[k]))
      return "--phi, --psi, --cohesion and --density are not for --layers, which have their own";
  const char *why = s->layers_file ? read_layers(s) : NULL;
  if (!why) why = place_layers(s);
  if (why) return why;
  if (s->water > s->height) return "--water-table must be at most --height below the surface";
  for (int k = 0; k < s->layers; k++)
    if (!isnan(s->water) && !(s->layer[k].density > WATER))
      return "--density must be above 1000 kg/m3, that of water, with --water-table";
  for (int k = 0; k < s->layers; k++) s->heaviest = fmax(s->heaviest, s->layer[k].density);
  return NULL;
}

/* ---- particles ------------------------------------------------------------------------------- */

/* The effective stress at rest; the ground in front of the wall begins at the level of its toe. */
static mps_status rest(void *user, const double *place, double *stress) {
  const settings *s = user;
  const double depth = s->base + s->height - place[1];
  const bool front = place[0] < 0.0;
  double total, up;
  weigh(s, front ? s->height : 0.0, depth, &total, &up);
  if (!front) up += s->surcharge;
  const double k0 =
      s->k0_given ? s->k0 : 1.0 - sin(wall_layer_at(s, depth)->phi * DEGREE); /* Jaky */
  stress[1] = -up;
  stress[0] = stress[2] = -up * k0;
  return MPS_OK;
}

mps_status wall_set_ground(settings *s, mps_particles *set) {
  mps_view x;
  mps_edit density, force;
  mps_status status = mps_particles_add_field(set, "body_acceleration", 0);
  if (status == MPS_OK) status = mps_particles_view(set, "position", &x);
  if (status == MPS_OK) status = mps_particles_edit(set, "density", &density);
  if (status == MPS_OK) status = mps_particles_edit(set, "body_acceleration", &force);
  if (status != MPS_OK) return status;
  for (int64_t k = 0; k < x.shape[0]; k++) {
    const double depth = s->base + s->height - *mps_view_f64(&x, k, 1);
    const double rho = wall_layer_at(s, depth)->density;
    *mps_edit_f64(&density, k, 0) = rho;
    *mps_edit_f64(&force, k, 1) = depth > wet_depth(s) ? WATER * s->gravity / rho : 0.0;
  }
  status = mps_particles_commit(set, &density);
  if (status == MPS_OK) status = mps_particles_commit(set, &force);
  return status == MPS_OK ? mps_particles_set_stress(set, rest, s) : status;
}

mps_status wall_make_law(mps_context *context, const settings *s, int k, mps_material **out) {
  const wall_layer *l = &s->layer[k];
  mps_material_mohr_coulomb_def law = mps_material_mohr_coulomb_defaults();
  law.young = s->young, law.poisson = s->poisson;
  law.friction = l->phi * DEGREE, law.dilation = l->psi * DEGREE, law.cohesion = l->cohesion;
  law.void_ratio = s->voids.e0, law.max_void_ratio = s->voids.e_max;
  return mps_material_create_mohr_coulomb(context, &law, out);
}

/* The laws of the layers below the first. */
mps_status wall_set_laws(mps_context *context, const settings *s, mpm_model *m) {
  mps_particles *set = m->particles;
  int64_t *ids = malloc((size_t)(mps_particles_count(set) + 1) * sizeof *ids);
  mps_view x, id;
  mps_status status = ids ? mps_particles_view(set, "position", &x) : MPS_ERROR_MEMORY;
  if (status == MPS_OK) status = mps_particles_view(set, "id", &id);
  for (int k = 1; k < s->layers && status == MPS_OK; k++) {
    mps_material *law = NULL;
    int64_t count = 0;
    for (int64_t i = 0; i < x.shape[0]; i++)
      if (wall_layer_at(s, s->base + s->height - *mps_view_f64(&x, i, 1)) == &s->layer[k])
        ids[count++] = *mps_view_i64(&id, i, 0);
    int64_t all = count;
    status = wall_make_law(context, s, k, &law);
    if (status == MPS_OK) status = mpm_model_sum(m, &all);
    if (status == MPS_OK && all > 0) status = mps_mpm_set_material(m->mpm, law, ids, count);
    mps_material_destroy(&law);
  }
  free(ids);
  return status;
}

/* ---- theory ---------------------------------------------------------------------------------- */

/* Integral of K (sigma_v + q) + side 2 c K^1/2 over the height, N/m; sigma_v less the buoyancy
 * where `effective`; `bound`: only where it is a pressure. */
static double integrate(const settings *s, wall_coefficient_fn k_of, bool effective, bool bound) {
  const double side = s->pressure == ACTIVE ? -1.0 : 1.0;
  double sum = 0.0, from = 0.0;
  while (from < s->height * (1.0 - 1e-12)) {
    double to = s->height, bottom = 0.0, total, buoyant;
    for (int k = 0; k + 1 < s->layers; k++) {
      bottom += s->layer[k].thickness;
      if (bottom > from * (1.0 + 1e-12)) to = fmin(to, bottom);
    }
    if (wet_depth(s) > from * (1.0 + 1e-12)) to = fmin(to, wet_depth(s));
    const wall_layer *l = wall_layer_at(s, 0.5 * (from + to));
    const double K = k_of ? k_of(s, l) : 1.0;
    for (int i = 0; i < PARTS; i++) {
      weigh(s, 0.0, from + (i + 0.5) / PARTS * (to - from), &total, &buoyant);
      const double up = effective ? buoyant + s->surcharge : total;
      const double p = k_of ? K * up + side * 2.0 * l->cohesion * sqrt(K) : up;
      sum += (bound ? fmax(0.0, p) : p) * (to - from) / PARTS;
    }
    from = to;
  }
  return sum;
}

double wall_theory(const settings *s, wall_coefficient_fn k_of, bool bound) {
  return integrate(s, k_of, true, bound);
}

double wall_unit(const settings *s) {
  return wall_is_plain(s) ? 0.5 * s->density * s->gravity * s->height * s->height
                          : integrate(s, NULL, false, false);
}

double wall_water(const settings *s) {
  const double wet = s->height - fmin(s->height, wet_depth(s));
  return 0.5 * WATER * s->gravity * wet * wet;
}
