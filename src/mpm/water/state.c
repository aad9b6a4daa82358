/* state.c - the water of a solver between steps: values that the caller has written, its mass, and
 * what snapshots and checkpoints keep besides the fields. SPDX-License-Identifier: BSD-3-Clause */
#include "halo.h"
#include "solve/coarse.h"
#include "solve/outside.h"
#include "water.h"

static mps_status refuse_particle(mps_context *context, const mpsi_columns *p, const char *function,
                                  int64_t k, const char *field, double value, const char *allowed) {
  const int64_t id = mpsi_particles_integers(p->set, "id")[k];
  (void)mpsi_fail(context, function, MPS_ERROR_ARGUMENT, "'%s' of particle %lld is %g, must be %s",
                  field, (long long)id, value, allowed);
  mpsi_fail_where(context, -1, id);
  return MPS_ERROR_ARGUMENT;
}

mps_status mpsi_pore_check(mps_context *context, const mpsi_columns *p, mpsi_water *water,
                           const char *function) {
  const double rho = water ? water->def.density : 0.0;
  for (int64_t k = 0; water && k < p->count; k++) {
    const double mixture = p->m[k] / p->V[k];
    if (!(p->n[k] > 0.0 && p->n[k] < 1.0))
      return refuse_particle(context, p, function, k, "porosity", p->n[k], "in (0, 1)");
    if (!isfinite(p->u[k]))
      return refuse_particle(context, p, function, k, "pore_pressure", p->u[k], "finite");
    if (p->k && !(p->k[k] > 0.0 && p->k[k] <= MPSI_PORE_FASTEST))
      return refuse_particle(context, p, function, k, "permeability", p->k[k], "in (0, 1] m/s");
    if (!(mixture > p->n[k] * rho))
      return refuse_particle(
          context, p, function, k, "density", mixture,
          "that of grains and water together, above porosity times that of water");
  }
  return MPS_OK;
}

void mpsi_pore_mass(const mpsi_columns *p, mpsi_water *water, mpsi_exact *sum) {
  const mps_pore_water_def *def = &water->def;
  const bool fills = mpsi_pore_responds(water); /* porosities are those of the motion's volume */
  for (int64_t k = 0; k < p->count; k++) {
    const mpsi_law_use *law = mpsi_law_of(p, k);
    const double gap = fills && law->opening >= 0 ? law->history[law->opening][k] : 0.0;
    mpsi_exact_add(sum,
                   def->density * p->n[k] * p->V[k] * (1.0 + gap) * (1.0 + p->u[k] / def->bulk));
  }
}

void mpsi_pore_free(mps_mpm *mpm) {
  if (!mpm->water) return;
  const mpsi_water *w = mpm->water;
  MPSI_FREE(mpm->context, w->cell_room.item, w->column_room.item, w->faces_room.item,
            w->block_room.item, w->linked_room.item, w->outflow_room.item, w->former_room.item,
            w->rest_room.item, w->place_room.item);
  mpsi_pore_free_halo(mpm->context, &mpm->water->halo);
  if (mpm->water->system) mpsi_pore_free_coarse(mpm->context, &mpm->water->system->coarse);
  mpsi_pore_free_system(mpm->context, &mpm->water->system);
  mpsi_pore_free_outside(mpm->context, mpm->water->outside);
  mpsi_free(mpm->context, mpm->water);
  mpm->water = NULL;
}

void mpsi_pore_list_state(mpsi_state *state, mpsi_water *water) {
  mpsi_state_agree_integer(state, "pore_water", water != NULL);
  if (!water) return;
  mpsi_state_enter(state, "water");
  mpsi_state_agree_integer(state, "flows", water->flows);
  mpsi_state_agree_integer(state, "faces", water->face_count);
  mpsi_state_agree_integer(state, "scheme", water->def.scheme);
  mpsi_state_i64(state, "steps", &water->steps, 1);
  mpsi_state_f64(state, "elapsed", &water->elapsed, 1);
  mpsi_state_exact(state, "start", &water->start, 1);
  mpsi_state_exact(state, "drained", water->drained, MPSI_PORE_FACES);
  mpsi_state_exact(state, "entered", &water->entered, 1);
  mpsi_state_exact(state, "rate", water->rate, MPSI_PORE_FACES);
  mpsi_state_leave(state);
}
