/* removal.c - particles that leave the body between two steps: erosion, excavation. All that can
 * fail is done before they go; then the solver goes on with what is left, from the displacements
 * and velocities that it has. None can come: the reference positions of a body in motion tell no
 * newcomer how far its neighbours have moved.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "core/particles_internal.h"
#include "dynamics_private.h"

struct mpsi_dynamics_removal {
  int32_t *now; /* index after the removal of each particle, -1: it goes */
  double *x, *y;
  int64_t *side; /* NULL without free-field columns */
  mpsi_dynamics_structure left;
  mpsi_dynamics_lists lists; /* room */
  double energy;             /* J, before */
};

static void drop(mps_dynamics *dynamics) {
  mpsi_dynamics_removal *r = dynamics->removal;
  if (!r) return;
  void *parts[] = {r->now, r->x, r->y, r->side};
  for (size_t k = 0; k < sizeof parts / sizeof *parts; k++) mpsi_free(dynamics->context, parts[k]);
  mpsi_dynamics_free_lists(dynamics, &r->lists);
  mpsi_dynamics_free_structure(dynamics, &r->left);
  mpsi_free(dynamics->context, r);
  dynamics->removal = NULL;
}

/* Numbers what is left, in the present order. */
static mps_status number(mps_dynamics *dynamics, const char *function, int64_t count,
                         const int64_t *ids, int64_t *left) {
  mpsi_dynamics_removal *r = dynamics->removal;
  const double *const at[2] = {dynamics->state.rx, dynamics->state.ry};
  const int64_t *side = mpsi_particles_integers(dynamics->particles, "free_field");
  for (int64_t k = 0; k < count; k++) {
    const int64_t i = mps_particles_index(dynamics->particles, ids[k]);
    r->now[i] = -1;
    if (i >= dynamics->body) {
      (void)mpsi_fail(dynamics->context, function, MPS_ERROR_ARGUMENT,
                      "particle %lld belongs to a free-field column, which stays whole",
                      (long long)ids[k]);
      mpsi_fail_where(dynamics->context, -1, ids[k]);
      return MPS_ERROR_ARGUMENT;
    }
  }
  if (count >= dynamics->body)
    return mpsi_fail(dynamics->context, function, MPS_ERROR_ARGUMENT,
                     "all %lld particles of the body are to go, at least one must stay",
                     (long long)dynamics->body);
  *left = 0;
  for (int64_t i = 0; i < dynamics->count; i++) {
    if (r->now[i] < 0) continue;
    r->x[*left] = at[0][i], r->y[*left] = at[1][i];
    if (side) r->side[*left] = side[i];
    r->now[i] = (int32_t)(*left)++;
  }
  return MPS_OK;
}

static mps_status prepare(mps_dynamics *dynamics, const char *function, int64_t count,
                          const int64_t *ids) {
  mps_context *context = dynamics->context;
  const int64_t n = dynamics->count;
  mpsi_dynamics_removal *r = dynamics->removal = mpsi_alloc(context, 1, sizeof *r);
  if (!r || !(r->now = mpsi_alloc(context, n, sizeof *r->now)) ||
      !(r->x = mpsi_alloc(context, n, sizeof *r->x)) ||
      !(r->y = mpsi_alloc(context, n, sizeof *r->y)) ||
      !(r->side = mpsi_alloc(context, n, sizeof *r->side)))
    return mpsi_fail_memory(context, function, (size_t)n * 28);
  mpsi_dynamics_geometry g = {.x = r->x,
                              .y = r->y,
                              .side = r->side,
                              .spacing = dynamics->spacing,
                              .radius = dynamics->radius,
                              .period_x =
                                  isnan(dynamics->def.period_x) ? 0.0 : dynamics->def.period_x};
  mps_status status = number(dynamics, function, count, ids, &g.count);
  if (status == MPS_OK) status = mpsi_dynamics_make_structure(dynamics, function, &g, &r->left);
  if (status == MPS_OK)
    status = mpsi_dynamics_reserve_lists(dynamics, function, n, r->left.column_dashpots, &r->lists);
  if (status == MPS_OK) r->energy = mpsi_dynamics_present_energy(dynamics);
  return status;
}

mps_status mpsi_dynamics_remove(void *self, const char *function, int64_t count,
                                const int64_t *ids) {
  mps_dynamics *dynamics = self;
  mps_status status = mpsi_dynamics_enter(dynamics, function);
  if (status == MPS_OK) status = mpsi_dynamics_take_edits(dynamics, function);
  if (status != MPS_OK) return status;
  drop(dynamics);
  status = prepare(dynamics, function, count, ids);
  if (status != MPS_OK) drop(dynamics);
  return status;
}

/* Gives the particles of a boundary or load their new numbers; those that went are left out. */
static void renumber_part(const int32_t *now, mpsi_dynamics_part *part) {
  int64_t kept = 0;
  for (int64_t k = 0; k < part->count; k++)
    if (now[part->particle[k]] >= 0) part->particle[kept++] = now[part->particle[k]];
  part->count = kept;
}

static void renumber(mps_dynamics *dynamics, const int32_t *now) {
  int64_t kept = 0;
  for (int32_t k = 0; k < dynamics->boundary_room; k++)
    if (dynamics->boundary[k]) renumber_part(now, &dynamics->boundary[k]->part);
  for (int32_t k = 0; k < dynamics->load_room; k++)
    if (dynamics->load[k]) renumber_part(now, &dynamics->load[k]->part);
  for (int64_t k = 0; k < dynamics->bounds; k++) {
    mpsi_dynamics_bound q = dynamics->bound[k];
    if (now[q.particle] < 0) continue;
    q.particle = now[q.particle];
    dynamics->bound[kept++] = q;
  }
  dynamics->bounds = kept;
}

void mpsi_dynamics_renew(void *self) {
  mps_dynamics *dynamics = self;
  mpsi_dynamics_removal *r = dynamics->removal;
  mpsi_dynamics_bind(dynamics);
  if (!r) return;
  if (mps_particles_count(dynamics->particles) == r->left.count) { /* nobody refused */
    mpsi_dynamics_use_structure(dynamics, &r->left);
    renumber(dynamics, r->now);
    dynamics->kernels->trig[dynamics->def.rotation](&dynamics->state, 0, dynamics->count);
    mpsi_dynamics_use_lists(dynamics, &r->lists);
    if (dynamics->force[0]) dynamics->force[1] = dynamics->force[0] + dynamics->count;
    dynamics->works.start += mpsi_dynamics_present_energy(dynamics) - r->energy;
    mpsi_dynamics_forget_limit(dynamics);
    dynamics->no_rate = dynamics->forces_stale = true;
  }
  drop(dynamics);
}
