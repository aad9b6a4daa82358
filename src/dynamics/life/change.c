/* change.c - change of the set of particles, by a removal or by a rollback to a state with other
 * particles. Everything that can fail is done beside the present body, which the new one then
 * replaces. SPDX-License-Identifier: BSD-3-Clause */
#include "core/particles/particles_internal.h"
#include "change.h"
#include "dynamics/base/dynamics_solver.h"

#include <stdio.h>
#include <string.h>

void mpsi_dynamics_drop_change(mps_dynamics *dynamics) {
  mpsi_dynamics_change *c = dynamics->change;
  if (!c) return;
  MPSI_FREE(dynamics->context, c->now, c->force, c->before, c->drag);
  mpsi_dynamics_free_lists(dynamics, &c->lists);
  mpsi_dynamics_free_structure(dynamics, &c->structure);
  mpsi_free(dynamics->context, c);
  dynamics->change = NULL;
}

static mps_status reserve_columns(mps_dynamics *dynamics, const char *function, int64_t n) {
  mpsi_dynamics_change *c = dynamics->change;
  const struct {
    double **to, *present;
    int64_t columns;
  } column[] = {{&c->force, dynamics->force[0], 2},
                {&c->before, dynamics->before, 3},
                {&c->drag, dynamics->drag, 3}};
  for (size_t k = 0; k < sizeof column / sizeof *column; k++) {
    if (!column[k].present) continue;
    *column[k].to = mpsi_alloc(dynamics->context, column[k].columns * n, sizeof(double));
    if (!*column[k].to) return mpsi_fail_memory(dynamics->context, function, (size_t)n * 24);
  }
  return MPS_OK;
}

mps_status mpsi_dynamics_prepare_change(mps_dynamics *dynamics, const char *function,
                                        const mpsi_dynamics_geometry *geometry) {
  mpsi_dynamics_drop_change(dynamics);
  mpsi_dynamics_change *c = dynamics->change = mpsi_alloc(dynamics->context, 1, sizeof *c);
  if (!c) return mpsi_fail_memory(dynamics->context, function, sizeof *c);
  mps_status status = mpsi_dynamics_make_structure(dynamics, function, geometry, &c->structure);
  if (status == MPS_OK) status = reserve_columns(dynamics, function, geometry->count);
  if (status == MPS_OK)
    status = mpsi_dynamics_reserve_lists(dynamics, function, geometry->count,
                                         c->structure.column_dashpots, &c->lists);
  if (status != MPS_OK) mpsi_dynamics_drop_change(dynamics);
  return status;
}

static void exchange(double **a, double **b) {
  double *const keep = *a;
  *a = *b;
  *b = keep;
}

/* Prescribed degrees of freedom of the remaining particles, with their values and new numbers. */
static void renumber_bounds(mps_dynamics *dynamics, const int32_t *now) {
  int64_t kept = 0;
  for (int64_t k = 0; now && k < dynamics->bounds; k++) {
    mpsi_dynamics_bound q = dynamics->bound[k];
    if (now[q.particle] < 0) continue;
    q.particle = now[q.particle];
    dynamics->bound[kept++] = q;
  }
  dynamics->bounds = kept;
}

void mpsi_dynamics_use_change(mps_dynamics *dynamics) {
  mpsi_dynamics_change *c = dynamics->change;
  mpsi_dynamics_use_structure(dynamics, &c->structure);
  for (int32_t k = 0; k < mpsi_dynamics_boundary_count(dynamics); k++)
    if (mpsi_dynamics_boundary_of(dynamics, k))
      mpsi_dynamics_find_part(dynamics, &mpsi_dynamics_boundary_of(dynamics, k)->part);
  for (int32_t k = 0; k < mpsi_dynamics_load_count(dynamics); k++)
    if (mpsi_dynamics_load_of(dynamics, k))
      mpsi_dynamics_find_part(dynamics, &mpsi_dynamics_load_of(dynamics, k)->part);
  renumber_bounds(dynamics, c->now);
  dynamics->kernels->trig[dynamics->def.rotation](&dynamics->state, 0, dynamics->count);
  mpsi_dynamics_use_lists(dynamics, &c->lists);
  exchange(&dynamics->force[0], &c->force);
  if (dynamics->force[0]) dynamics->force[1] = dynamics->force[0] + dynamics->count;
  exchange(&dynamics->before, &c->before);
  exchange(&dynamics->drag, &c->drag);
  mpsi_dynamics_forget_limit(dynamics);
  dynamics->forces_stale = true;
}

/* ---- restoration of a state ------------------------------------------------------------------ */

/* Geometry of the pairs of `from`. */
typedef struct former {
  int64_t count;
  const int64_t *id, *side;
  const double *x, *y;
} former;

static bool read_former(const mps_snapshot *from, former *out) {
  const mpsi_value *id = mpsi_values_find(&from->fields, "id");
  const mpsi_value *reference = mpsi_values_find(&from->fields, "reference");
  const mpsi_value *side = mpsi_values_find(&from->fields, "free_field");
  if (!id || !reference || reference->type != MPSI_STATE_F64 || reference->columns < 2)
    return false;
  *out = (former){.count = from->particles, .id = id->data, .x = reference->data};
  out->y = out->x + from->particles;
  if (side && side->type == MPSI_STATE_I64) out->side = side->data;
  return true;
}

/* Counts the particles and degrees of freedom of a boundary that the state has. */
typedef struct tally {
  int32_t *index_of; /* by id, -1: none; NULL: as in the set now */
  uint8_t *taken;    /* degree of freedom [component * count + index] */
  int64_t count, bounds, dashpots;
} tally;

static int64_t tally_part(const mps_dynamics *dynamics, tally *t, const mpsi_dynamics_boundary *b) {
  static const uint32_t dof[3] = {MPS_DOF_X, MPS_DOF_Y, MPS_DOF_ROTATION};
  int64_t present = 0;
  for (int64_t p = 0; p < b->part.listed; p++) {
    const int64_t id = b->part.id[p];
    const int64_t at = t->index_of ? t->index_of[id] : mps_particles_index(dynamics->particles, id);
    if (at < 0) continue;
    present++;
    if (b->kind == MPS_BOUNDARY_ABSORBING) t->dashpots += 2;
    for (int c = 0; c < 3; c++) {
      if (!(b->dofs & dof[c]) || t->taken[c * t->count + at]) continue;
      t->taken[c * t->count + at] = 1;
      t->bounds++;
    }
  }
  return present;
}

static mps_status check_boundaries(mps_dynamics *dynamics, const char *function,
                                   const mps_snapshot *from, const char *source,
                                   mps_status disagreement, tally *t) {
  const mpsi_value *held = mpsi_values_find(&from->state, "held_values");
  const mpsi_value *dashpots = mpsi_values_find(&from->state, "dashpot_forces");
  for (int32_t k = 0; k < mpsi_dynamics_boundary_count(dynamics); k++) {
    if (!mpsi_dynamics_boundary_of(dynamics, k)) continue;
    char name[64];
    snprintf(name, sizeof name, "boundary%d/particles", (int)k);
    const int64_t present = tally_part(dynamics, t, mpsi_dynamics_boundary_of(dynamics, k));
    const mpsi_value *then = mpsi_values_find(&from->state, name);
    if (*(const int64_t *)then->data != present)
      return mpsi_fail(dynamics->context, function, disagreement,
                       "in %s %s is %lld, in this solver %lld of those particles", source, name,
                       (long long)*(const int64_t *)then->data, (long long)present);
  }
  if (held->rows == t->bounds && dashpots->rows == t->dashpots) return MPS_OK;
  return mpsi_fail(dynamics->context, function, disagreement,
                   "%s has %lld degrees of freedom held or driven and %lld dashpots, this solver "
                   "%lld and %lld on those particles",
                   source, (long long)held->rows, (long long)dashpots->rows, (long long)t->bounds,
                   (long long)t->dashpots);
}

/* Reference position of a particle of both bodies is kept; that of a restored one is in `from`. */
static mps_status check_places(mps_dynamics *dynamics, const char *function, const former *f,
                               const char *source, mps_status disagreement) {
  for (int64_t k = 0; k < f->count && !dynamics->broken; k++) {
    const int64_t at = mps_particles_index(dynamics->particles, f->id[k]);
    const double *const here[2] = {dynamics->state.rx, dynamics->state.ry};
    if (at < 0 || (here[0][at] == f->x[k] && here[1][at] == f->y[k])) continue;
    (void)mpsi_fail(dynamics->context, function, disagreement,
                    "in %s particle %lld has the reference position (%.17g, %.17g) m, in this "
                    "solver (%.17g, %.17g) m",
                    source, (long long)f->id[k], f->x[k], f->y[k], here[0][at], here[1][at]);
    mpsi_fail_where(dynamics->context, -1, f->id[k]);
    return disagreement;
  }
  return MPS_OK;
}

/* Checks of a file's values that creation and numbering rely on. */
static mps_status check_former(const mps_dynamics *dynamics, const char *function, const former *f,
                               const char *source) {
  const double far = MPSI_DYN_MOST_SPACINGS * dynamics->spacing;
  bool good = f->count > 0 && f->count <= INT32_MAX && !(f->side && f->side[0]);
  for (int64_t k = 0; k < f->count && good; k++) {
    good = fabs(f->x[k] - f->x[0]) <= far && fabs(f->y[k] - f->y[0]) <= far;
    if (f->side && k > 0) good = good && f->side[k] >= f->side[k - 1] && f->side[k] <= 2;
  }
  if (good) return MPS_OK;
  return mpsi_fail(dynamics->context, function, MPS_ERROR_FORMAT,
                   "%s is malformed: its reference positions or free-field columns", source);
}

static bool same_particles(const mps_dynamics *dynamics, const former *f) {
  return f->count == dynamics->count &&
         memcmp(f->id, mpsi_particles_integers(dynamics->particles, "id"),
                (size_t)f->count * sizeof *f->id) == 0;
}

mps_status mpsi_dynamics_prepare_state(void *solver, const char *function, const mps_snapshot *from,
                                       const char *source, mps_status disagreement) {
  mps_dynamics *dynamics = solver;
  mps_context *context = dynamics->context;
  former f;
  if (!read_former(from, &f))
    return mpsi_fail(context, function, MPS_ERROR_FORMAT, "%s has no reference positions", source);
  const bool same = same_particles(dynamics, &f);
  const bool here = same && mpsi_dynamics_hash_positions(f.count, f.x, f.y) == dynamics->places;
  const int64_t made = mpsi_particles_made(dynamics->particles);
  mps_status status = MPS_OK;
  tally t = {.count = f.count, .dashpots = dynamics->column_dashpots};
  mpsi_dynamics_drop_change(dynamics);
  if (!here) {
    const mpsi_dynamics_geometry g = mpsi_dynamics_geometry_of(dynamics, f.count, f.x, f.y, f.side);
    status = check_former(dynamics, function, &f, source);
    if (status == MPS_OK) status = check_places(dynamics, function, &f, source, disagreement);
    if (status == MPS_OK) status = mpsi_dynamics_prepare_change(dynamics, function, &g);
    if (status == MPS_OK) t.dashpots = dynamics->change->structure.column_dashpots;
    if (status == MPS_OK && !(t.index_of = mpsi_alloc(context, made, sizeof *t.index_of)))
      status = mpsi_fail_memory(context, function, (size_t)made * sizeof *t.index_of);
    for (int64_t k = 0; t.index_of && k < made; k++) t.index_of[k] = -1;
    for (int64_t k = 0; t.index_of && k < f.count; k++) t.index_of[f.id[k]] = (int32_t)k;
  }
  if (status == MPS_OK && !(t.taken = mpsi_alloc(context, 3 * f.count, 1)))
    status = mpsi_fail_memory(context, function, (size_t)f.count * 3);
  if (status == MPS_OK)
    status = check_boundaries(dynamics, function, from, source, disagreement, &t);
  MPSI_FREE(context, t.index_of, t.taken);
  if (status != MPS_OK) mpsi_dynamics_drop_change(dynamics);
  return status;
}
