/* boundaries.c - the boundaries of a solver: sides of the domain, boxes of nodes, lists of
 * particles; their definitions and reactions (public functions: life/conditions.c). Their action in
 * a step: walls.c, absorb.c. SPDX-License-Identifier: BSD-3-Clause */
#include "free_field.h"
#include "mpm/particles/mpm_particles.h"

#include "core/base/boundary_kind.h"
#include "core/context/retain.h"
#include "signal/signal_internal.h"
#include "core/base/digits.h"

#include <string.h>

#define ON_NODE 1e-6 /* cells: a node this close to the edge of a box belongs to it */
#define ROUGHEST 1e3 /* largest coefficient of friction */
/* Kinds of a side, as bits; walls.c has what each does to a node. */
#define SIDE_KINDS                                                                                 \
  (1u << MPS_BOUNDARY_HELD | 1u << MPS_BOUNDARY_DRIVEN | 1u << MPS_BOUNDARY_ROLLER |               \
   1u << MPS_BOUNDARY_FRICTIONAL | 1u << MPS_BOUNDARY_ABSORBING | 1u << MPS_BOUNDARY_FREE |        \
   1u << MPS_BOUNDARY_FREE_FIELD | 1u << MPS_BOUNDARY_OPEN)

static const mps_mpm_boundary_def boundary_defaults = {.struct_size = sizeof(mps_mpm_boundary_def),
                                                       .kind = MPS_BOUNDARY_HELD,
                                                       .lower = {-INFINITY, -INFINITY, -INFINITY},
                                                       .upper = {INFINITY, INFINITY, INFINITY},
                                                       .factor = {1.0, 1.0, 1.0}};

mps_status mps_mpm_boundary_def_init(mps_mpm_boundary_def *def, size_t size) {
  return MPSI_DEF_INIT(mps_mpm_boundary_def, def, size, &boundary_defaults);
}

/* ---- checks ---------------------------------------------------------------------------------- */

static bool on_axis(const mpsi_grid *grid, const mps_mpm_def *def, int32_t number) {
  return grid->geometry == MPS_MPM_GEOMETRY_AXISYMMETRIC && number == MPS_MPM_SIDE_X_LOWER &&
         def->lower[0] == 0.0;
}

static bool has_side(const mpsi_grid *grid, int32_t number) {
  if (number / 2 >= grid->dim) return false;
  const int64_t at = number % 2 ? grid->high[number / 2] : grid->low[number / 2];
  return at > -MPSI_NO_WALL && at < MPSI_NO_WALL;
}

static mps_status check_motion(mps_context *context, const mpsi_grid *grid, mpsi_run *run,
                               const char *function, int32_t number,
                               const mps_mpm_boundary_def *def) {
  const mpsi_guard outer = mpsi_guard_close(&run->guard, context, "a signal of the solver");
  mps_status status = MPS_OK;
  for (int c = 0; c < grid->dim && status == MPS_OK; c++) {
    const mpsi_signal_use use = {context, function, "boundary", number, c};
    mpsi_signal_motion m;
    const double factor = def->factor[c];
    status = mpsi_signal_evaluate(def->signal[c], use, run->time, &m);
    if (status == MPS_OK && (!isfinite(factor) || !isfinite(factor * m.v)))
      status = mpsi_fail(context, function, MPS_ERROR_ARGUMENT,
                         "factor[%d] is %g, it and the velocity that it makes must be finite", c,
                         factor);
  }
  run->guard = outer;
  return status;
}

static mps_status check_numbers(mps_context *context, const mpsi_grid *grid, mpsi_run *run,
                                const char *function, int32_t number,
                                const mps_mpm_boundary_def *def) {
  const bool frictional = def->kind == MPS_BOUNDARY_FRICTIONAL;
  if (!(def->friction >= 0.0 && def->friction <= ROUGHEST) || (def->friction > 0.0 && !frictional))
    return mpsi_fail(context, function, MPS_ERROR_ARGUMENT,
                     "friction is %s with a boundary of kind %d, must be in 0 to %g, and 0 for "
                     "other than frictional ones (3)",
                     mpsi_outside(def->friction, 0.0, ROUGHEST).text, def->kind, ROUGHEST);
  if (!isfinite(def->settle) || def->settle < 0.0)
    return mpsi_fail(context, function, MPS_ERROR_ARGUMENT,
                     "settle is %g s, must be finite and >= 0", def->settle);
  for (int c = 0; c < grid->dim && def->kind == MPS_BOUNDARY_HELD; c++)
    if (def->signal[c])
      return mpsi_fail(context, function, MPS_ERROR_ARGUMENT,
                       "signal[%d] is given and a held boundary takes none: make its kind DRIVEN",
                       c);
  return check_motion(context, grid, run, function, number, def);
}

static mps_status check_side(mps_context *context, const mpsi_grid *grid, mpsi_run *run,
                             const mps_mpm_def *definition, const char *function, int32_t number,
                             const mps_mpm_boundary_def *def) {
  if (!has_side(grid, number))
    return mpsi_fail(context, function, MPS_ERROR_ARGUMENT,
                     "number is %d, and the domain has no %s side across %c", number,
                     number % 2 ? "upper" : "lower", "xyz"[number / 2]);
  const bool open = def->kind == MPS_BOUNDARY_OPEN;
  if (!mpsi_boundary_kind_in(def->kind, SIDE_KINDS))
    return mpsi_fail(context, function, MPS_ERROR_ARGUMENT,
                     "kind is %d (%s), WLS-MPM has on a side 0 (HELD), 1 (DRIVEN), 2 (ROLLER), 3 "
                     "(FRICTIONAL), 4 (ABSORBING), 5 (FREE_FIELD), 6 (FREE) and 7 (OPEN)",
                     def->kind, mpsi_boundary_kind_name(def->kind));
  if (def->ids || def->id_count != 0 || def->dofs != 0)
    return mpsi_fail(context, function, MPS_ERROR_ARGUMENT,
                     "ids, id_count (%lld) and dofs (%u) are not for sides of the domain",
                     (long long)def->id_count, def->dofs);
  if (grid->standard && def->kind == MPS_BOUNDARY_ABSORBING)
    return mpsi_fail(context, function, MPS_ERROR_ARGUMENT,
                     "kind is 4 (ABSORBING), which the standard method does not allow: its splines "
                     "reach over the side");
  if (on_axis(grid, definition, number) && (def->kind > MPS_BOUNDARY_ROLLER || def->signal[0]))
    return mpsi_fail(context, function, MPS_ERROR_ARGUMENT,
                     "kind is %d with signal[0] %s on the axis r = 0: allowed are 0 (HELD), 1 "
                     "(DRIVEN) and 2 (ROLLER), and the radial velocity is 0",
                     def->kind, def->signal[0] ? "given" : "NULL");
  for (int c = 0; c < grid->dim; c++)
    if (def->signal[c] &&
        (def->kind == MPS_BOUNDARY_FREE || open || def->kind == MPS_BOUNDARY_FREE_FIELD ||
         (def->kind == MPS_BOUNDARY_ROLLER && c != number / 2)))
      return mpsi_fail(context, function, MPS_ERROR_ARGUMENT,
                       "signal[%d] is given, and a side of kind %d does not hold that component", c,
                       def->kind);
  return check_numbers(context, grid, run, function, number, def);
}

/* First or last node of a box that begins or ends at x. */
static int64_t box_node(const mpsi_grid *grid, int c, double x, bool last) {
  const double X = mpsi_grid_at(grid, c, x);
  if (!(X > -(double)MPSI_NO_WALL)) return -MPSI_NO_WALL;
  if (!(X < (double)MPSI_NO_WALL)) return MPSI_NO_WALL;
  return (int64_t)(last ? floor(X + ON_NODE) : ceil(X - ON_NODE));
}

static mps_status find_box(mps_context *context, const mpsi_grid *grid, const char *function,
                           const mps_mpm_boundary_def *def, mpsi_boundary *out) {
  for (int c = 0; c < grid->dim; c++) {
    out->first[c] = box_node(grid, c, def->lower[c], false);
    out->last[c] = box_node(grid, c, def->upper[c], true);
    if (!(def->lower[c] <= def->upper[c]) || out->first[c] > out->last[c])
      return mpsi_fail(
          context, function, MPS_ERROR_ARGUMENT,
          "lower and upper: the box is [%g, %g] m in %c, must hold a node: origin %g m "
          "plus a multiple of the cell %g m",
          def->lower[c], def->upper[c], "xyz"[c], grid -> origin[c], grid -> cell);
  }
  return MPS_OK;
}

static mps_status check_ids(mps_context *context, const mpsi_columns *p, mpsi_partition *partition,
                            const char *function, const mps_mpm_boundary_def *def) {
  const int64_t most = partition ? MPSI_MPM_MOST_PARTICLES : p->count;
  if ((def->id_count > 0) != (def->ids != NULL) || def->id_count < 0 || def->id_count > most)
    return mpsi_fail(context, function, MPS_ERROR_ARGUMENT,
                     "id_count is %lld with ids %s, allowed are 1 to %lld particles, or 0 and NULL",
                     (long long)def->id_count, def->ids ? "given" : "NULL", (long long)most);
  return MPS_OK;
}

static mps_status check_prescribed(const mpsi_boundary_setup *setup, const char *function,
                                   int32_t number, const mps_mpm_boundary_def *def,
                                   mpsi_boundary *out) {
  const mpsi_grid *grid = setup->grid;
  mps_context *context = setup->context;
  const uint32_t all = grid->dim == 3 ? MPS_DOF_X | MPS_DOF_Y | MPS_DOF_Z : MPS_DOF_X | MPS_DOF_Y;
  if (def->kind != MPS_BOUNDARY_HELD && def->kind != MPS_BOUNDARY_DRIVEN)
    return mpsi_fail(context, function, MPS_ERROR_ARGUMENT,
                     "kind is %d (%s), boxes of nodes and particles are 0 (HELD) or 1 (DRIVEN)",
                     def->kind, mpsi_boundary_kind_name(def->kind));
  if (def->dofs & ~all)
    return mpsi_fail(context, function, MPS_ERROR_ARGUMENT,
                     "dofs is %u, allowed are those or-ed from MPS_DOF_X, MPS_DOF_Y%s", def->dofs,
                     grid->dim == 3 ? ", MPS_DOF_Z" : "");
  mps_status status = check_numbers(context, grid, setup->run, function, number, def);
  if (status == MPS_OK) status = check_ids(context, setup->p, setup->partition, function, def);
  if (status == MPS_OK && !def->ids) status = find_box(context, grid, function, def, out);
  return mpsi_mpm_check_ids(context, setup->p, setup->partition, function, status, def->id_count,
                            def->ids);
}

/* ---- changing boundaries --------------------------------------------------------------------- */

static void place_side(const mpsi_grid *grid, const mpsi_boundaries *boundaries, int32_t number,
                       int32_t kind) {
  mpsi_boundary *hold = &boundaries->hold[number];
  const int axis = number / 2;
  hold->axis = axis;
  /* the standard scheme has nodes beyond the side too */
  const int64_t beyond = grid->standard ? MPSI_SIDE : 0;
  const int64_t inwards = kind == MPS_BOUNDARY_FREE_FIELD ? MPSI_FIELD_PLANES - 1 : 0;
  for (int c = 0; c < grid->dim; c++)
    hold->first[c] = grid->low[c] - beyond, hold->last[c] = grid->high[c] + beyond;
  if (number % 2)
    hold->first[axis] = grid->high[axis] - inwards;
  else
    hold->last[axis] = grid->low[axis] + inwards;
  hold->dofs = MPS_DOF_X | MPS_DOF_Y | MPS_DOF_Z;
  hold->finds = kind == MPS_BOUNDARY_ABSORBING;
  hold->found = 0.0;
  hold->kind = kind == MPS_BOUNDARY_FREE ? MPSI_BOUNDARY_NONE : kind;
}

/* Memory for the sums of a boundary, which stays with its number. */
static bool make_sums(mps_context *context, mpsi_boundary *hold) {
  if (!hold->sums) hold->sums = mpsi_alloc(context, 1, sizeof *hold->sums);
  return hold->sums != NULL;
}

bool mpsi_mpm_begin_sides(mps_context *context, const mpsi_grid *grid,
                          mpsi_boundaries *boundaries) {
  bool good = true;
  boundaries->hold = boundaries->hold_room.item;
  boundaries->holds = MPSI_SIDES;
  for (int32_t k = 0; k < MPSI_SIDES; k++) boundaries->hold[k].kind = MPSI_BOUNDARY_NONE;
  for (int32_t k = 0; k < MPSI_SIDES && good; k++) {
    if (!has_side(grid, k)) continue;
    place_side(grid, boundaries, k, MPS_BOUNDARY_ROLLER);
    good = make_sums(context, &boundaries->hold[k]);
  }
  return good;
}

mps_status mpsi_mpm_widen_sides(mps_context *context, const mpsi_grid *grid,
                                mpsi_boundaries *boundaries, const char *function) {
  mpsi_boundary *hold = boundaries->hold;
  for (int32_t k = 0; k < MPSI_SIDES; k++)
    if (hold[k].kind == MPS_BOUNDARY_ABSORBING)
      return mpsi_fail(context, function, MPS_ERROR_ARGUMENT,
                       "mpm: boundary %d is absorbing, which the standard method does not allow",
                       k);
    else if (hold[k].kind == MPS_BOUNDARY_FREE_FIELD)
      return mpsi_fail(context, function, MPS_ERROR_ARGUMENT,
                       "mpm: boundary %d is of kind 5 (FREE_FIELD), which the standard method does "
                       "not allow",
                       k);
  for (int32_t k = 0; k < MPSI_SIDES; k++)
    if (hold[k].kind != MPSI_BOUNDARY_NONE) place_side(grid, boundaries, k, hold[k].kind);
  boundaries->outdated = true;
  return MPS_OK;
}

static void take_numbers(mpsi_boundary *hold, const mps_mpm_boundary_def *def) {
  hold->friction = def->friction;
  hold->settle = def->settle;
  for (int c = 0; c < 3; c++) {
    mps_signal *old = hold->signal[c];
    hold->signal[c] = def->signal[c] ? mpsi_signal_retain(def->signal[c]) : NULL;
    hold->factor[c] = def->factor[c];
    mps_signal_destroy(&old);
  }
}

static void drop(mps_context *context, mpsi_boundary *hold) {
  const mps_mpm_boundary_def rest = boundary_defaults;
  take_numbers(hold, &rest);
  mpsi_mpm_free_field_free(context, &hold->field);
  mpsi_free(context, hold->ids);
  hold->ids = NULL;
  hold->id_count = 0;
  hold->kind = MPSI_BOUNDARY_NONE;
}

void mpsi_mpm_drop_boundaries(mps_context *context, const mpsi_boundaries *boundaries) {
  for (int32_t k = 0; k < boundaries->holds; k++) {
    drop(context, &boundaries->hold[k]);
    mpsi_free(context, boundaries->hold[k].sums);
  }
  mpsi_free(context, boundaries->hold_room.item);
}

/* Number of the next boundary, the lowest free one, and memory for it. */
static mps_status find_number(mps_context *context, mpsi_boundaries *b, const char *function,
                              int32_t *number) {
  int32_t at = MPSI_SIDES;
  while (at < b->holds && b->hold[at].kind != MPSI_BOUNDARY_NONE) at++;
  *number = at;
  if (at < b->holds) return MPS_OK;
  if (!mpsi_room_keep(context, &b->hold_room, at + 1, sizeof *b->hold))
    return mpsi_fail_memory(context, function, (size_t)(at + 1) * sizeof *b->hold);
  b->hold = b->hold_room.item;
  b->hold[b->holds++].kind = MPSI_BOUNDARY_NONE;
  return MPS_OK;
}

/* Makes the boundary `number` one of a box or a list of particles. */
static mps_status make_prescribed(const mpsi_boundary_setup *setup, const char *function,
                                  int32_t number, const mps_mpm_boundary_def *def) {
  mpsi_boundary *hold = &setup->boundaries->hold[number];
  mpsi_boundary made = {.kind = MPS_BOUNDARY_DRIVEN,
                        .dofs = def->dofs ? def->dofs : MPS_DOF_X | MPS_DOF_Y | MPS_DOF_Z};
  mps_status status = check_prescribed(setup, function, number, def, &made);
  if (status == MPS_OK && !make_sums(setup->context, hold))
    status = mpsi_fail_memory(setup->context, function, sizeof *hold->sums);
  if (status == MPS_OK && def->ids) {
    made.ids = mpsi_alloc(setup->context, def->id_count, sizeof *made.ids);
    if (!made.ids)
      status = mpsi_fail_memory(setup->context, function, (size_t)def->id_count * sizeof *made.ids);
  }
  status = mpsi_mpm_agree(setup->partition, function, status);
  if (status != MPS_OK) {
    mpsi_free(setup->context, made.ids);
    return status;
  }
  if (def->ids) {
    memcpy(made.ids, def->ids, (size_t)def->id_count * sizeof *made.ids);
    made.id_count = def->id_count;
  }
  if (hold->kind == MPSI_BOUNDARY_NONE || made.ids || hold->ids ||
      memcmp(made.first, hold->first, sizeof made.first) != 0 ||
      memcmp(made.last, hold->last, sizeof made.last) != 0)
    setup->boundaries->outdated = true;
  mpsi_free(setup->context, hold->ids);
  hold->kind = made.kind;
  hold->dofs = made.dofs;
  hold->ids = made.ids;
  hold->id_count = made.id_count;
  memcpy(hold->first, made.first, sizeof made.first);
  memcpy(hold->last, made.last, sizeof made.last);
  take_numbers(hold, def);
  return MPS_OK;
}

static mps_status read_def(mps_context *context, const char *function,
                           const mps_mpm_boundary_def *user, mps_mpm_boundary_def *def) {
  if (!user) return mpsi_fail(context, function, MPS_ERROR_ARGUMENT, "def is NULL");
  return MPSI_DEF_READ(context, function, mps_mpm_boundary_def, user, def);
}

/* Checks that all ranks give the same boundary (`number` -1: a new one). */
static mps_status compare_ranks(const mpsi_grid *grid, mpsi_partition *partition,
                                const char *function, mps_status status, int32_t number,
                                const mps_mpm_boundary_def *def) {
  if (!partition) return status;
  mpsi_given given;
  mpsi_given_begin(&given);
  mpsi_give(&given, "boundary", number);
  if (status == MPS_OK) {
    MPSI_GIVE(&given, def, kind);
    MPSI_GIVE(&given, def, dofs);
    MPSI_GIVE(&given, def, friction);
    MPSI_GIVE(&given, def, settle);
    MPSI_GIVE_VECTOR(&given, def, lower, grid->dim);
    MPSI_GIVE_VECTOR(&given, def, upper, grid->dim);
    MPSI_GIVE_VECTOR(&given, def, factor, grid->dim);
    for (int c = 0; c < grid->dim; c++)
      mpsi_signal_give(&given, "a hash of signal", def->signal[c]);
    mpsi_give_bytes(&given, "a hash of ids", def->id_count > 0 ? def->ids : NULL,
                    (size_t)def->id_count * sizeof *def->ids);
  }
  return mpsi_domain_agree_given(partition->domain, function, status, &given);
}

/* ---- what the caller asks for ---------------------------------------------------------------- */

mps_status mpsi_mpm_add_boundary(const mpsi_boundary_setup *setup, const char *function,
                                 const mps_mpm_boundary_def *user, int32_t *number) {
  mps_mpm_boundary_def def = boundary_defaults;
  mps_status status = mpsi_mpm_between_steps(setup->context, setup->run, function);
  if (status == MPS_OK) status = read_def(setup->context, function, user, &def);
  int32_t at = MPSI_SIDES;
  if (status == MPS_OK) status = find_number(setup->context, setup->boundaries, function, &at);
  status = compare_ranks(setup->grid, setup->partition, function, status, -1, &def);
  if (status != MPS_OK) return status;
  status = make_prescribed(setup, function, at, &def);
  if (status != MPS_OK) return status;
  mpsi_boundary *hold = &setup->boundaries->hold[at];
  mpsi_exact_merge(
      &setup->boundaries->work,
      &hold->sums->all[MPSI_BOUNDARY_WORK]); /* work of a former boundary with this number */
  mpsi_exact_merge(&setup->boundaries->work, &hold->sums->step[MPSI_BOUNDARY_WORK]);
  memset(hold->sums, 0, sizeof *hold->sums);
  hold->count = hold->removed = 0;
  if (number) *number = at;
  return MPS_OK;
}

static mps_status find(mps_context *context, const mpsi_grid *grid,
                       const mpsi_boundaries *boundaries, const char *function, int32_t number) {
  const bool side = number >= 0 && number < MPSI_SIDES;
  if (side ? has_side(grid, number)
           : number >= 0 && number < boundaries->holds &&
                 boundaries->hold[number].kind != MPSI_BOUNDARY_NONE)
    return MPS_OK;
  if (side)
    return mpsi_fail(context, function, MPS_ERROR_ARGUMENT,
                     "number is %d, and the domain has no %s side across %c", number,
                     number % 2 ? "upper" : "lower", "xyz"[number / 2]);
  return mpsi_fail(
      context, function, MPS_ERROR_ARGUMENT,
      "number: boundary is %d, must be that of a side of the domain (0 to 5) or a number that "
      "mps_mpm_add_boundary gave",
      number);
}

/* The column of a free-field side, of the present particles. */
static mps_status make_field(const mpsi_boundary_setup *setup, const char *function, int32_t number,
                             mpsi_free_field **out) {
  mps_status status = mpsi_mpm_check_free_field(setup, function, number);
  if (status == MPS_OK) status = mpsi_mpm_check_masses(setup->context, setup->p, function);
  return status == MPS_OK ? mpsi_mpm_make_free_field(setup, function, number, out) : status;
}

mps_status mpsi_mpm_set_boundary(const mpsi_boundary_setup *setup, const char *function,
                                 int32_t number, const mps_mpm_boundary_def *user) {
  mps_mpm_boundary_def def = boundary_defaults;
  mps_status status = mpsi_mpm_between_steps(setup->context, setup->run, function);
  if (status == MPS_OK)
    status = find(setup->context, setup->grid, setup->boundaries, function, number);
  if (status == MPS_OK) status = read_def(setup->context, function, user, &def);
  status = compare_ranks(setup->grid, setup->partition, function, status, number, &def);
  if (status != MPS_OK) return status;
  mpsi_boundary *hold = &setup->boundaries->hold[number];
  if (number >= MPSI_SIDES) return make_prescribed(setup, function, number, &def);
  status = mpsi_mpm_agree(
      setup->partition, function,
      check_side(setup->context, setup->grid, setup->run, setup->def, function, number, &def));
  if (status == MPS_OK)
    status =
        mpsi_mpm_check_beside_field(setup->context, setup->boundaries, function, number, def.kind);
  mpsi_free_field *field = NULL;
  if (status == MPS_OK && def.kind == MPS_BOUNDARY_FREE_FIELD)
    status = make_field(setup, function, number, &field);
  if (status != MPS_OK) return status;
  mpsi_mpm_free_field_free(setup->context, &hold->field);
  hold->field = field;
  /* a side that is driven is held, and moves with its signals; DRIVEN is of boxes and particles */
  const int32_t kind = def.kind == MPS_BOUNDARY_DRIVEN ? MPS_BOUNDARY_HELD : def.kind;
  if (hold->kind != kind || kind == MPS_BOUNDARY_ABSORBING) {
    place_side(setup->grid, setup->boundaries, number, kind);
    setup->boundaries->outdated = true;
  }
  take_numbers(hold, &def);
  return MPS_OK;
}

mps_status mpsi_mpm_remove_boundary(const mpsi_boundary_setup *setup, const char *function,
                                    int32_t number) {
  mps_status status = mpsi_mpm_between_steps(setup->context, setup->run, function);
  if (status == MPS_OK)
    status = find(setup->context, setup->grid, setup->boundaries, function, number);
  if (status == MPS_OK && on_axis(setup->grid, setup->def, number))
    status = mpsi_fail(setup->context, function, MPS_ERROR_ARGUMENT,
                       "number: boundary is 0, the axis r = 0, which cannot be free");
  if (setup->partition)
    status = mpsi_domain_agree_same(setup->partition->domain, function, status, "boundary", number);
  if (status != MPS_OK) return status;
  drop(setup->context, &setup->boundaries->hold[number]);
  setup->boundaries->outdated = true;
  return MPS_OK;
}

void mpsi_mpm_boundary_add_impulse(mpsi_boundary *hold, const double *impulse, const double *moment,
                                   double work, int64_t count) {
  for (int c = 0; c < 3; c++) {
    mpsi_exact_add(&hold->sums->step[MPSI_BOUNDARY_IMPULSE + c], impulse[c]);
    mpsi_exact_add(&hold->sums->step[MPSI_BOUNDARY_MOMENT + c], moment[c]);
  }
  mpsi_exact_add(&hold->sums->step[MPSI_BOUNDARY_WORK], work);
  hold->count += count;
}

void mpsi_mpm_boundary_add_works(const mpsi_boundaries *boundaries, mpsi_exact *sum) {
  mpsi_exact_merge(sum, &boundaries->work);
  for (int32_t k = 0; k < boundaries->holds; k++) {
    const mpsi_boundary_sums *sums = boundaries->hold[k].sums;
    if (!sums) continue;
    mpsi_exact_merge(sum, &sums->all[MPSI_BOUNDARY_WORK]);
    mpsi_exact_merge(sum, &sums->step[MPSI_BOUNDARY_WORK]);
  }
}

/* Sums over all ranks: of the last step, and since the boundary was made. */
static mps_status sum_ranks(mpsi_partition *partition, const char *function,
                            const mpsi_boundary *hold, mpsi_boundary_sums *out, int64_t *counts) {
  *out = *hold->sums;
  for (int k = 0; k < MPSI_BOUNDARY_MASS; k++) mpsi_exact_merge(&out->all[k], &out->step[k]);
  counts[0] = hold->count, counts[1] = hold->removed;
  if (!partition) return MPS_OK;
  const mps_status status = mpsi_domain_sum(partition->domain, function, 2, counts);
  if (status != MPS_OK) return status;
  return mpsi_domain_sum_exact(partition->domain, function, 2 * MPSI_BOUNDARY_MASS + 1, out->step);
}

mps_status mpsi_mpm_find_reaction(const mpsi_boundary_setup *setup, const char *function,
                                  int32_t number, mps_reaction *out) {
  mpsi_boundary_sums sums;
  int64_t counts[2];
  mps_status status = find(setup->context, setup->grid, setup->boundaries, function, number);
  if (setup->partition)
    status = mpsi_domain_agree_same(setup->partition->domain, function, status, "boundary", number);
  if (status != MPS_OK) return status;
  status = sum_ranks(setup->partition, function, &setup->boundaries->hold[number], &sums, counts);
  if (status != MPS_OK) return status;
  const double rate = setup->boundaries->dt > 0.0 ? 1.0 / setup->boundaries->dt : 0.0;
  *out = (mps_reaction){.count = counts[0],
                        .removed = counts[1],
                        .work = mpsi_exact_value(&sums.all[MPSI_BOUNDARY_WORK]),
                        .removed_mass = mpsi_exact_value(&sums.all[MPSI_BOUNDARY_MASS])};
  for (int c = 0; c < 3; c++) {
    out->force[c] = rate * mpsi_exact_value(&sums.step[MPSI_BOUNDARY_IMPULSE + c]);
    out->moment[c] = rate * mpsi_exact_value(&sums.step[MPSI_BOUNDARY_MOMENT + c]);
    out->impulse[c] = mpsi_exact_value(&sums.all[MPSI_BOUNDARY_IMPULSE + c]);
    out->moment_impulse[c] = mpsi_exact_value(&sums.all[MPSI_BOUNDARY_MOMENT + c]);
  }
  return MPS_OK;
}
