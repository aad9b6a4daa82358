/* consolidation.c - the state of rest of Cam-Clay: horizontal stress, preconsolidation and void
 * ratio of particles from their vertical stress and the largest one they have had.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "core/base/ranges.h"
#include "core/particles/particles_internal.h"
#include "material/material_private.h"

#include <mps/soil.h>
#include <mps/experimental/soil.h>

static const char function[] = "mps_particles_set_consolidation";

typedef struct clay_state {
  double horizontal, pc, void_ratio; /* Pa, Pa, - */
} clay_state;

/* ---- one particle ---------------------------------------------------------------------------- */

/* The largest vertical stress `past` has made pc by virgin compression; unloading is elastic, at
 * most to the passive state of M in compression. */
static clay_state find_state(const mpsi_law *law, const mps_consolidation_def *d, double normal_k0,
                             double vertical) {
  const double past = d->ocr * vertical + d->pop, ocr = past / vertical;
  const double p1 = past * (1.0 + 2.0 * normal_k0) / 3.0;
  const double eta1 = 3.0 * (1.0 - normal_k0) / (1.0 + 2.0 * normal_k0);
  const double pc = p1 * (1.0 + eta1 * eta1 / (law->slope * law->slope));
  /* nu/(1 - nu) = (3 K - 2 G)/(3 K + 4 G) */
  const double g = law->shear_ratio > 0.0 ? law->shear_ratio : law->shear * law->per_bulk;
  const double sine = 3.0 * law->slope / (6.0 + law->slope);
  const double passive = (1.0 + sine) / (1.0 - sine);
  const double unloaded = normal_k0 * ocr - (ocr - 1.0) * (3.0 - 2.0 * g) / (3.0 + 4.0 * g);
  const double k0 = isnan(d->k0) ? fmin(unloaded, passive) : d->k0;
  const double p = vertical * (1.0 + 2.0 * k0) / 3.0;
  clay_state state = {.horizontal = k0 * vertical, .pc = pc, .void_ratio = law->first_void};
  if (!isnan(d->critical_volume))
    state.void_ratio = d->critical_volume - 1.0 +
                       (law->compression - law->swelling) * log(2.0 * d->reference / pc) -
                       law->swelling * log(p / d->reference);
  return state;
}

static mps_status check_state(mps_particles *set, const mps_material *material, int64_t k,
                              double vertical, const clay_state *state) {
  mps_context *context = mpsi_particles_context(set);
  const long long id = (long long)mpsi_particles_integers(set, "id")[k];
  if (!(state->void_ratio >= 0.01 && state->void_ratio <= 20.0))
    return mpsi_fail(context, function, MPS_ERROR_ARGUMENT,
                     "particle %lld would have the void ratio %g by critical_volume, must be 0.01 "
                     "to 20",
                     id, state->void_ratio);
  const double stress[4] = {-vertical, -state->horizontal, -state->horizontal, 0.0};
  const double history[MPSI_CLAY_COLUMNS] = {[MPSI_CLAY_PC] = state->pc};
  char reason[200];
  if (mpsi_material_check_state(material, 2, stress, history, reason, sizeof reason)) return MPS_OK;
  return mpsi_fail(context, function, MPS_ERROR_ARGUMENT, "particle %lld %s", id, reason);
}

/* ---- all particles --------------------------------------------------------------------------- */

typedef struct consolidation {
  mps_particles *set;
  const mps_material *material;
  mps_consolidation_def def;
  int32_t dim, up;
  int64_t count;
  double normal_k0;
} consolidation;

static int64_t place(const consolidation *c, int64_t i) {
  return c->def.ids ? mps_particles_index(c->set, c->def.ids[i]) : i;
}

static mps_status find_states(const consolidation *c, clay_state *state) {
  const double *vertical = mpsi_particles_column(c->set, "stress", c->up);
  for (int64_t i = 0; i < c->count; i++) {
    const int64_t k = place(c, i);
    const double load = -vertical[k];
    if (!(load > 0.0 && load <= 1e12))
      return mpsi_fail(mpsi_particles_context(c->set), function, MPS_ERROR_ARGUMENT,
                       "particle %lld has the vertical stress %g Pa, must be compression, -1e12 to "
                       "below 0: set it by mps_particles_set_geostatic, at the surface with a "
                       "surcharge",
                       (long long)mpsi_particles_integers(c->set, "id")[k], vertical[k]);
    state[i] = find_state(&c->material->law, &c->def, c->normal_k0, load);
    MPSI_TRY(check_state(c->set, c->material, k, load, &state[i]));
  }
  return MPS_OK;
}

static mps_status open_fields(const consolidation *c) {
  static const char *const names[] = {"preconsolidation", "void_ratio", "stress"};
  mps_context *context = mpsi_particles_context(c->set);
  const int32_t fields = mps_particles_field_count(c->set);
  mps_status status = MPS_OK;
  for (int f = 0; f < 2 && status == MPS_OK; f++)
    status = mpsi_as(context, function, mps_particles_add_field(c->set, names[f], 0));
  for (int f = 0; f < 3 && status == MPS_OK; f++)
    status = mpsi_particles_notify(c->set, function, names[f], NULL);
  if (status != MPS_OK) mpsi_particles_drop_fields(c->set, fields);
  return status;
}

static void write_states(const consolidation *c, const clay_state *state) {
  double *s[6], *pc = mpsi_particles_column(c->set, "preconsolidation", 0);
  double *e = mpsi_particles_column(c->set, "void_ratio", 0);
  for (int32_t a = 0; a < 2 * c->dim; a++) s[a] = mpsi_particles_column(c->set, "stress", a);
  for (int64_t i = 0; i < c->count; i++) {
    const int64_t k = place(c, i);
    for (int32_t a = 0; a < 2 * c->dim; a++)
      if (a != c->up) s[a][k] = a < 3 ? -state[i].horizontal : 0.0;
    pc[k] = state[i].pc;
    e[k] = state[i].void_ratio;
  }
}

static mps_status begin(consolidation *c, const mps_consolidation_def *def) {
  mps_context *context = mpsi_particles_context(c->set);
  MPSI_TRY(MPSI_DEF_READ_IN(context, function, mps_consolidation_def, def, mpsi_scene_of(c->dim),
                            &c->def));
  if (!c->material) return mpsi_fail(context, function, MPS_ERROR_ARGUMENT, "material is NULL");
  if (c->material->type->kind != MPSI_LAW_CAM_CLAY)
    return mpsi_fail(context, function, MPS_ERROR_UNSUPPORTED,
                     "material: the law is %s, must be cam_clay", c->material->name);
  MPSI_TRY(mpsi_particles_check_ids_or_all(c->set, function, c->def.count, c->def.ids));
  MPSI_TRY(mpsi_particles_writable(c->set, function));
  if (!mpsi_particles_column(c->set, "stress", 0))
    return mpsi_fail(context, function, MPS_ERROR_FIELD,
                     "the set has no field 'stress' with the vertical stress: call "
                     "mps_particles_set_geostatic first");
  c->count = c->def.ids ? c->def.count : mps_particles_count(c->set);
  c->up = c->def.vertical == -1 ? c->dim - 1 : c->def.vertical;
  c->normal_k0 = mpsi_cam_clay_k0(&c->material->law);
  return MPS_OK;
}

mps_status mps_particles_set_consolidation(mps_particles *particles, const mps_material *material,
                                           const mps_consolidation_def *def) {
  if (!particles) return mpsi_null(__func__, "particles");
  mps_context *context = mpsi_particles_context(particles);
  consolidation c = {.set = particles,
                     .material = material,
                     .def = mps_consolidation_defaults(),
                     .dim = mps_particles_dim(particles)};
  MPSI_TRY(begin(&c, def));
  clay_state *state = mpsi_alloc(context, c.count, sizeof *state);
  if (!state) return mpsi_fail_memory(context, function, (size_t)c.count * sizeof *state);
  mps_status status = find_states(&c, state);
  if (status == MPS_OK) status = open_fields(&c);
  if (status == MPS_OK) write_states(&c, state);
  mpsi_free(context, state);
  return status;
}
