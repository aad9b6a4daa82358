/* boundaries.c - the boundaries of a solver: sides of the domain, boxes of nodes, lists of
 * particles; their definitions and reactions (public functions: life/conditions.c). Their action in
 * a step: walls.c, absorb.c. SPDX-License-Identifier: BSD-3-Clause */
#include "free_field.h"
#include "kinds.h"
#include "mpm/particles/mpm_particles.h"
#include "mpm/contact/prescribed.h"
#include "mpm/ranks/partition.h"

#include "core/base/boundary_kind.h"
#include "core/base/selection.h"
#include "signal/signal_internal.h"

#include <string.h>

#define ON_NODE 1e-6 /* cells: a node this close to the edge of a box belongs to it */

/* ---- checks ---------------------------------------------------------------------------------- */

static bool on_axis(const mpsi_grid *grid, const mps_mpm_def *def, int32_t number) {
  return grid->geometry == MPS_MPM_GEOMETRY_AXISYMMETRIC && number == MPS_SIDE_X_LOWER &&
         def->lower[0] == 0.0;
}

bool mpsi_mpm_has_side(const mpsi_grid *grid, int32_t number) {
  if (number / 2 >= grid->dim) return false;
  const int64_t at = number % 2 ? grid->high[number / 2] : grid->low[number / 2];
  return at > -MPSI_NO_WALL && at < MPSI_NO_WALL;
}

static mps_status check_motion(mps_context *context, const mpsi_grid *grid, mpsi_run *run,
                               const char *function, int32_t number,
                               const mps_mpm_boundary_def *def) {
  const mpsi_guard outer = mpsi_guard_close(run->guard, context, "a signal of the solver");
  mps_status status = MPS_OK;
  for (int c = 0; c < grid->dim && status == MPS_OK; c++) {
    const mpsi_signal_use use = {context, function, "boundary", number, c};
    mpsi_signal_motion m;
    const double factor = def->factor[c];
    status = mpsi_signal_evaluate(def->signal[c], use, run->time, &m);
    if (status == MPS_OK && !isfinite(factor * m.v))
      status = mpsi_fail(context, function, MPS_ERROR_ARGUMENT,
                         "factor[%d] is %g, the velocity that it makes must be finite", c, factor);
  }
  *run->guard = outer;
  return status;
}

static mps_status check_side(mps_context *context, const mpsi_grid *grid, mpsi_run *run,
                             const mps_mpm_def *definition, const char *function, int32_t number,
                             const mps_mpm_boundary_def *def) {
  const mpsi_selection selection = MPSI_SELECTION(def, grid->dim);
  if (mpsi_selection_given(&selection) || def->dofs != 0)
    return mpsi_fail(context, function, MPS_ERROR_ARGUMENT,
                     "%s given, and a side of the domain is whole: no ids, box, all or dofs",
                     def->dofs  ? "dofs is"
                     : def->all ? "all is"
                     : def->ids ? "ids is"
                                : "a box (lower, upper) is");
  if (grid->standard && def->kind == MPS_BOUNDARY_ABSORBING)
    return mpsi_fail(
        context, function, MPS_ERROR_ARGUMENT,
        "kind is MPS_BOUNDARY_ABSORBING, which the standard method does not allow: its "
        "splines reach over the side");
  if (on_axis(grid, definition, number) && (def->kind > MPS_BOUNDARY_ROLLER || def->signal[0]))
    return mpsi_fail(
        context, function, MPS_ERROR_ARGUMENT,
        "kind is %s with signal[0] %s on the axis r = 0: allowed are MPS_BOUNDARY_HELD, "
        "_DRIVEN and _ROLLER, without a signal[0], as the radial velocity is 0",
        mpsi_name_of("mps_boundary_kind", def->kind).text, def->signal[0] ? "given" : "NULL");
  for (int c = 0; c < grid->dim; c++)
    if (def->signal[c] && def->kind == MPS_BOUNDARY_ROLLER && c != number / 2)
      return mpsi_fail(context, function, MPS_ERROR_ARGUMENT,
                       "signal[%d] is given, and a side of kind MPS_BOUNDARY_ROLLER prescribes the "
                       "component across it alone",
                       c);
  return check_motion(context, grid, run, function, number, def);
}

/* First or last node of a box that begins or ends at x. */
static int64_t box_node(const mpsi_grid *grid, int c, double x, bool last) {
  const double X = mpsi_grid_at(grid, c, x);
  if (!(X > -(double)MPSI_NO_WALL)) return -MPSI_NO_WALL;
  if (!(X < (double)MPSI_NO_WALL)) return MPSI_NO_WALL;
  return (int64_t)(last ? floor(X + ON_NODE) : ceil(X - ON_NODE));
}

static mps_status find_box(mps_context *context, const mpsi_grid *grid, const char *function,
                           const mpsi_selection_box *box, mpsi_boundary *out) {
  for (int c = 0; c < grid->dim; c++) {
    out->first[c] = box_node(grid, c, box->lower[c], false);
    out->last[c] = box_node(grid, c, box->upper[c], true);
    if (out->first[c] > out->last[c])
      return mpsi_fail(
          context, function, MPS_ERROR_ARGUMENT,
          "lower and upper: the box is [%g, %g] m in %c, must hold a node: origin %g m "
          "plus a multiple of the cell %g m",
          box->lower[c], box->upper[c], "xyz"[c], grid -> origin[c], grid -> cell);
  }
  return MPS_OK;
}

static mps_status check_prescribed(const mpsi_boundary_setup *setup, const char *function,
                                   int32_t number, const mps_mpm_boundary_def *def) {
  const mpsi_grid *grid = setup->grid;
  mps_context *context = setup->context;
  const uint32_t all = grid->dim == 3 ? MPS_DOF_X | MPS_DOF_Y | MPS_DOF_Z : MPS_DOF_X | MPS_DOF_Y;
  if (def->kind != MPS_BOUNDARY_HELD && def->kind != MPS_BOUNDARY_DRIVEN)
    return mpsi_fail(context, function, MPS_ERROR_ARGUMENT,
                     "kind is %s, boxes of nodes and particles are MPS_BOUNDARY_HELD or "
                     "MPS_BOUNDARY_DRIVEN",
                     mpsi_name_of("mps_boundary_kind", def->kind).text);
  if (def->dofs & ~all)
    return mpsi_fail(context, function, MPS_ERROR_ARGUMENT,
                     "dofs is %u, allowed are MPS_DOF_X, MPS_DOF_Y%s, or-ed, and 0 for all",
                     def->dofs, grid->dim == 3 ? ", MPS_DOF_Z" : "");
  return check_motion(context, grid, setup->run, function, number, def);
}

mps_status mpsi_mpm_check_boundary(const mpsi_boundary_setup *setup, const char *function,
                                   int32_t number, const mps_mpm_boundary_def *def) {
  return number < MPSI_SIDES ? check_side(setup->context, setup->grid, setup->run, setup->def,
                                          function, number, def)
                             : check_prescribed(setup, function, number, def);
}

/* ---- changing boundaries --------------------------------------------------------------------- */

static void place_side(const mpsi_grid *grid, const mpsi_boundaries *boundaries, int32_t number,
                       int32_t kind) {
  mpsi_boundary *boundary = &boundaries->boundary[number];
  const int axis = number / 2;
  boundary->axis = axis;
  /* the standard scheme has nodes beyond the side too */
  const int64_t beyond = grid->standard ? MPSI_SIDE : 0;
  const int64_t inwards = mpsi_boundary_kinds[kind].column ? MPSI_FIELD_PLANES - 1 : 0;
  for (int c = 0; c < grid->dim; c++)
    boundary->first[c] = grid->low[c] - beyond, boundary->last[c] = grid->high[c] + beyond;
  if (number % 2)
    boundary->first[axis] = grid->high[axis] - inwards;
  else
    boundary->last[axis] = grid->low[axis] + inwards;
  boundary->dofs = MPS_DOF_X | MPS_DOF_Y | MPS_DOF_Z;
  boundary->finds = mpsi_boundary_kinds[kind].absorbs;
  boundary->found = 0.0;
  boundary->kind = kind == MPS_BOUNDARY_FREE ? MPSI_BOUNDARY_NONE : kind;
}

/* Memory for the sums of a boundary, which stays with its number. */
static bool make_sums(mps_context *context, mpsi_boundary *boundary) {
  if (!boundary->sums) boundary->sums = mpsi_alloc(context, 1, sizeof *boundary->sums);
  return boundary->sums != NULL;
}

bool mpsi_mpm_begin_sides(mps_context *context, const mpsi_grid *grid,
                          mpsi_boundaries *boundaries) {
  bool good = true;
  boundaries->boundary = boundaries->boundary_room.item;
  boundaries->count = MPSI_SIDES;
  for (int32_t k = 0; k < MPSI_SIDES; k++) boundaries->boundary[k].kind = MPSI_BOUNDARY_NONE;
  for (int32_t k = 0; k < MPSI_SIDES && good; k++) {
    if (!mpsi_mpm_has_side(grid, k)) continue;
    place_side(grid, boundaries, k, MPS_BOUNDARY_ROLLER);
    good = make_sums(context, &boundaries->boundary[k]);
  }
  return good;
}

mps_status mpsi_mpm_widen_sides(mps_context *context, const mpsi_grid *grid,
                                mpsi_boundaries *boundaries, const char *function) {
  mpsi_boundary *boundary = boundaries->boundary;
  for (int32_t k = 0; k < MPSI_SIDES; k++)
    if (boundary[k].kind == MPS_BOUNDARY_ABSORBING || boundary[k].kind == MPS_BOUNDARY_FREE_FIELD)
      return mpsi_fail(context, function, MPS_ERROR_ARGUMENT,
                       "mpm: %s is of kind %s, which the standard method does not allow",
                       mpsi_name_of("mps_side", k).text,
                       mpsi_name_of("mps_boundary_kind", boundary[k].kind).text);
  for (int32_t k = 0; k < MPSI_SIDES; k++)
    if (boundary[k].kind != MPSI_BOUNDARY_NONE) place_side(grid, boundaries, k, boundary[k].kind);
  boundaries->outdated = true;
  return MPS_OK;
}

static void take_numbers(mpsi_boundary *boundary, const mps_mpm_boundary_def *def) {
  boundary->friction = def->friction;
  boundary->settle = def->settle;
  for (int c = 0; c < 3; c++)
    boundary->signal[c] = def->signal[c], boundary->factor[c] = def->factor[c];
}

static void drop(mps_context *context, mpsi_boundary *boundary) {
  const mps_mpm_boundary_def rest = mps_mpm_boundary_defaults();
  take_numbers(boundary, &rest);
  mpsi_mpm_free_field_free(context, &boundary->field);
  boundary->ids = NULL;
  boundary->id_count = 0;
  boundary->kind = MPSI_BOUNDARY_NONE;
}

void mpsi_mpm_drop_boundaries(mps_context *context, const mpsi_boundaries *boundaries) {
  for (int32_t k = 0; k < boundaries->count; k++) {
    drop(context, &boundaries->boundary[k]);
    mpsi_free(context, boundaries->boundary[k].sums);
  }
  mpsi_free(context, boundaries->boundary_room.item);
}

/* Memory for boundary `number`. */
static mps_status reserve(mps_context *context, mpsi_boundaries *b, const char *function,
                          int32_t number) {
  if (!mpsi_room_keep(context, &b->boundary_room, number + 1, sizeof *b->boundary))
    return mpsi_fail_memory(context, function, (size_t)(number + 1) * sizeof *b->boundary);
  b->boundary = b->boundary_room.item;
  while (b->count <= number) b->boundary[b->count++].kind = MPSI_BOUNDARY_NONE;
  if (make_sums(context, &b->boundary[number])) return MPS_OK;
  return mpsi_fail_memory(context, function, sizeof *b->boundary->sums);
}

mps_status mpsi_mpm_make_boundary(const mpsi_boundary_setup *setup, const char *function,
                                  int32_t number, const mps_mpm_boundary_def *def,
                                  mpsi_boundary *made) {
  if (number < MPSI_SIDES) return MPS_OK;
  *made = (mpsi_boundary){.kind = MPS_BOUNDARY_DRIVEN,
                          .dofs = def->dofs ? def->dofs : MPS_DOF_X | MPS_DOF_Y | MPS_DOF_Z,
                          .ids = def->ids,
                          .id_count = def->id_count};
  const mps_status status = reserve(setup->context, setup->boundaries, function, number);
  if (status != MPS_OK || def->ids) return status;
  mpsi_selection_box box;
  for (int c = 0; c < 3; c++) {
    box.lower[c] = isnan(def->lower[c]) ? -INFINITY : def->lower[c];
    box.upper[c] = isnan(def->upper[c]) ? INFINITY : def->upper[c];
  }
  return find_box(setup->context, setup->grid, function, &box, made);
}

/* ---- what the caller asks for ---------------------------------------------------------------- */

/* The column of a free-field side, of the present particles. */
static mps_status make_field(const mpsi_boundary_setup *setup, const char *function, int32_t number,
                             mpsi_free_field **out) {
  mps_status status = mpsi_mpm_check_free_field(setup, function, number);
  if (status == MPS_OK) status = mpsi_mpm_check_masses(setup->context, setup->p, function);
  return status == MPS_OK ? mpsi_mpm_make_free_field(setup, function, number, out) : status;
}

static mps_status set_side(const mpsi_boundary_setup *setup, const char *function, int32_t number,
                           const mps_mpm_boundary_def *def) {
  mpsi_boundary *boundary = &setup->boundaries->boundary[number];
  mpsi_free_field *field = NULL;
  MPSI_TRY(
      mpsi_mpm_check_beside_field(setup->context, setup->boundaries, function, number, def->kind));
  if (def->kind == MPS_BOUNDARY_FREE_FIELD) MPSI_TRY(make_field(setup, function, number, &field));
  mpsi_mpm_free_field_free(setup->context, &boundary->field);
  boundary->field = field;
  /* a side that is driven is held, and moves with its signals; DRIVEN is of boxes and particles */
  const int32_t kind = def->kind == MPS_BOUNDARY_DRIVEN ? MPS_BOUNDARY_HELD : def->kind;
  if (boundary->kind != kind || kind == MPS_BOUNDARY_ABSORBING) {
    place_side(setup->grid, setup->boundaries, number, kind);
    setup->boundaries->outdated = setup->boundaries->renew = true;
  }
  take_numbers(boundary, def);
  return MPS_OK;
}

/* The boundary `number` becomes one of a box or a list of particles. */
static void set_prescribed(mpsi_boundaries *boundaries, int32_t number, const mpsi_boundary *made,
                           const mps_mpm_boundary_def *def) {
  mpsi_boundary *boundary = &boundaries->boundary[number];
  const bool is_new = boundary->kind == MPSI_BOUNDARY_NONE;
  if (is_new || made->ids || boundary->ids ||
      memcmp(made->first, boundary->first, sizeof made->first) != 0 ||
      memcmp(made->last, boundary->last, sizeof made->last) != 0)
    boundaries->outdated = true;
  boundary->kind = made->kind;
  boundary->dofs = made->dofs;
  boundary->ids = made->ids;
  boundary->id_count = made->id_count;
  memcpy(boundary->first, made->first, sizeof made->first);
  memcpy(boundary->last, made->last, sizeof made->last);
  take_numbers(boundary, def);
  if (!is_new) return;
  /* work of a former boundary with this number */
  mpsi_exact_merge(&boundaries->work, &boundary->sums->all[MPSI_BOUNDARY_WORK]);
  mpsi_exact_merge(&boundaries->work, &boundary->sums->step[MPSI_BOUNDARY_WORK]);
  memset(boundary->sums, 0, sizeof *boundary->sums);
  boundary->count = boundary->removed = 0;
}

mps_status mpsi_mpm_set_boundary(const mpsi_boundary_setup *setup, const char *function,
                                 int32_t number, const mps_mpm_boundary_def *def,
                                 const mpsi_boundary *made) {
  if (number < MPSI_SIDES) return set_side(setup, function, number, def);
  set_prescribed(setup->boundaries, number, made, def);
  return MPS_OK;
}

mps_status mpsi_mpm_remove_boundary(const mpsi_boundary_setup *setup, const char *function,
                                    int32_t number) {
  if (on_axis(setup->grid, setup->def, number))
    return mpsi_fail(setup->context, function, MPS_ERROR_ARGUMENT,
                     "number is MPS_SIDE_X_LOWER, the axis r = 0, which cannot be free");
  drop(setup->context, &setup->boundaries->boundary[number]);
  setup->boundaries->outdated = true;
  return MPS_OK;
}

void mpsi_mpm_boundary_add_impulse(mpsi_boundary *boundary, const double *impulse,
                                   const double *moment, double work, int64_t count) {
  for (int c = 0; c < 3; c++) {
    mpsi_exact_add(&boundary->sums->step[MPSI_BOUNDARY_IMPULSE + c], impulse[c]);
    mpsi_exact_add(&boundary->sums->step[MPSI_BOUNDARY_MOMENT + c], moment[c]);
  }
  mpsi_exact_add(&boundary->sums->step[MPSI_BOUNDARY_WORK], work);
  boundary->count += count;
}

void mpsi_mpm_boundary_add_works(const mpsi_boundaries *boundaries, mpsi_exact *sum) {
  mpsi_exact_merge(sum, &boundaries->work);
  for (int32_t k = 0; k < boundaries->count; k++) {
    const mpsi_boundary_sums *sums = boundaries->boundary[k].sums;
    if (!sums) continue;
    mpsi_exact_merge(sum, &sums->all[MPSI_BOUNDARY_WORK]);
    mpsi_exact_merge(sum, &sums->step[MPSI_BOUNDARY_WORK]);
  }
}

/* Sums over all ranks: of the last step, and since the boundary was made. */
static mps_status sum_ranks(mpsi_partition *partition, const char *function,
                            const mpsi_boundary *boundary, mpsi_boundary_sums *out,
                            int64_t *counts) {
  *out = *boundary->sums;
  for (int k = 0; k < MPSI_BOUNDARY_MASS; k++) mpsi_exact_merge(&out->all[k], &out->step[k]);
  counts[0] = boundary->count, counts[1] = boundary->removed;
  if (!partition) return MPS_OK;
  MPSI_TRY(mpsi_domain_sum(partition->domain, function, 2, counts));
  return mpsi_domain_sum_exact(partition->domain, function, 2 * MPSI_BOUNDARY_MASS + 1, out->step);
}

mps_status mpsi_mpm_find_reaction(const mpsi_boundary_setup *setup, const char *function,
                                  mps_status status, int32_t number, mps_reaction *out) {
  mpsi_boundary_sums sums;
  int64_t counts[2];
  if (setup->partition)
    status = mpsi_domain_agree_same(setup->partition->domain, function, status, "number", number);
  if (status != MPS_OK) return status;
  MPSI_TRY(
      sum_ranks(setup->partition, function, &setup->boundaries->boundary[number], &sums, counts));
  const double rate = setup->run->dt > 0.0 ? 1.0 / setup->run->dt : 0.0;
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
