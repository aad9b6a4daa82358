/* mpm.c - life of the WLS-MPM solver: definition, checks, fields, bodies.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "kernels.h"

#include "core/particles_internal.h"

#include <string.h>

#define ON_NODE 1e-6 /* cells: a wall this close to a node is on it */
#define MAX_COUNT INT32_MAX
#define OVERLAP 0.1 /* cells: bodies may by so much */
#define THIN 2.0    /* cells: walls below let momentum through */

static const mps_mpm_def mpm_defaults = {.struct_size = sizeof(mps_mpm_def),
                                         .spline = 3,
                                         .lower = {-INFINITY, -INFINITY, -INFINITY},
                                         .upper = {INFINITY, INFINITY, INFINITY},
                                         .courant = 0.5,
                                         .flip = 1.0};

mps_status mps_mpm_def_init(mps_mpm_def *def, size_t size) {
  return MPSI_DEF_INIT(mps_mpm_def, def, size, &mpm_defaults);
}

/* ---- checks ---------------------------------------------------------------------------------- */

static const char create[] = "mps_mpm_create";

static int dim_of(const mps_mpm_def *d) { return d->geometry == MPS_SPACE ? 3 : 2; }

static mps_status check_choices(mps_context *context, const mps_mpm_def *d) {
  if (d->geometry < MPS_PLANE_STRAIN || d->geometry > MPS_SPACE)
    return mpsi_fail(context, create, MPS_ERROR_ARGUMENT,
                     "geometry is %d, allowed are 0 (plane strain), 1 (axisymmetric) and 2 (space)",
                     d->geometry);
  if (d->spline != 2 && d->spline != 3)
    return mpsi_fail(context, create, MPS_ERROR_ARGUMENT, "spline is %d, allowed are 2 and 3",
                     d->spline);
  if (d->transfer != MPS_TRANSFER_SHAPE && d->transfer != MPS_TRANSFER_WEIGHT)
    return mpsi_fail(context, create, MPS_ERROR_ARGUMENT,
                     "transfer is %d, allowed are 0 (shape) and 1 (weight)", d->transfer);
  if (d->volumetric != MPS_VOLUMETRIC_POINT && d->volumetric != MPS_VOLUMETRIC_CELL)
    return mpsi_fail(context, create, MPS_ERROR_ARGUMENT,
                     "volumetric is %d, allowed are 0 (point) and 1 (cell)", d->volumetric);
  if (d->scheme != MPS_SCHEME_WLS && d->scheme != MPS_SCHEME_STANDARD)
    return mpsi_fail(context, create, MPS_ERROR_ARGUMENT,
                     "scheme is %d, allowed are 0 (WLS) and 1 (standard)", d->scheme);
  for (int c = 0; c < dim_of(d); c++)
    for (int side = 0; side < 2; side++) {
      const bool on_axis =
          d->geometry == MPS_AXISYMMETRIC && c == 0 && side == 0 && !(d->lower[0] > 0.0);
      const mps_status status = mpsi_mpm_check_wall(
          context, create, c, side == 1, side ? d->wall_upper[c] : d->wall_lower[c],
          side ? d->wall_friction_upper[c] : d->wall_friction_lower[c], on_axis,
          d->scheme == MPS_SCHEME_STANDARD);
      if (status != MPS_OK) return status;
    }
  return MPS_OK;
}

static mps_status check_numbers(mps_context *context, const mps_mpm_def *d) {
  if (!isfinite(d->cell) || d->cell <= 0.0)
    return mpsi_fail(context, create, MPS_ERROR_ARGUMENT, "cell is %g m, must be finite and > 0",
                     d->cell);
  if (!isfinite(d->dt) || d->dt < 0.0)
    return mpsi_fail(context, create, MPS_ERROR_ARGUMENT,
                     "dt is %g s, must be > 0, or 0 for the largest stable one", d->dt);
  if (!(d->courant > 0.0 && d->courant <= 1.0))
    return mpsi_fail(context, create, MPS_ERROR_ARGUMENT, "courant is %g, must be in (0, 1]",
                     d->courant);
  if (!isfinite(d->settle) || d->settle < 0.0)
    return mpsi_fail(context, create, MPS_ERROR_ARGUMENT, "settle is %g s, must be finite and >= 0",
                     d->settle);
  if (!(d->flip >= 0.0 && d->flip <= 1.0) || (d->scheme == MPS_SCHEME_WLS && d->flip != 1.0))
    return mpsi_fail(
        context, create, MPS_ERROR_ARGUMENT,
        "flip is %g, must be in [0, 1] with scheme 1 (standard); with 0 (WLS) it is 1, "
        "the default",
        d->flip);
  for (int c = 0; c < dim_of(d); c++)
    if (!isfinite(d->origin[c]) || !isfinite(d->gravity[c]))
      return mpsi_fail(context, create, MPS_ERROR_ARGUMENT,
                       "origin[%d] is %g m and gravity[%d] %g m/s2, must be finite", c,
                       d->origin[c], c, d->gravity[c]);
  return MPS_OK;
}

/* A wall's node, or a far one where there is no wall. */
static mps_status read_wall(mps_context *context, const mps_mpm_def *d, int c, bool upper,
                            int64_t *node) {
  const double x = upper ? d->upper[c] : d->lower[c];
  const char *name = upper ? "upper" : "lower";
  *node = upper ? MPSI_NO_WALL : -MPSI_NO_WALL;
  if (x == (upper ? INFINITY : -INFINITY)) return MPS_OK;
  const double X = (x - d->origin[c]) / d->cell, nearest = nearbyint(X);
  if (!(fabs(X) < MPSI_MAX_CELLS))
    return mpsi_fail(context, create, MPS_ERROR_ARGUMENT,
                     "%s[%d] is %g m, must be within 2^30 cells of the origin, or %sinfinite", name,
                     c, x, upper ? "+" : "-");
  if (fabs(X - nearest) > ON_NODE)
    return mpsi_fail(context, create, MPS_ERROR_ARGUMENT,
                     "%s[%d] is %g m, must lie on a node: origin %g m plus a multiple of the cell "
                     "%g m",
                     name, c, x, d->origin[c], d->cell);
  *node = (int64_t)nearest;
  return MPS_OK;
}

static mps_status read_domain(mps_context *context, mps_mpm_def *d, int64_t *low, int64_t *high) {
  if (d->geometry == MPS_AXISYMMETRIC) {
    if (d->lower[0] == -INFINITY) d->lower[0] = 0.0;
    if (!(d->lower[0] >= 0.0))
      return mpsi_fail(context, create, MPS_ERROR_ARGUMENT,
                       "lower[0] is %g m, in axisymmetry the radius begins at 0 or more",
                       d->lower[0]);
  }
  low[2] = high[2] = 0;
  for (int c = 0; c < dim_of(d); c++) {
    mps_status status = read_wall(context, d, c, false, &low[c]);
    if (status == MPS_OK) status = read_wall(context, d, c, true, &high[c]);
    if (status != MPS_OK) return status;
    if (low[c] >= high[c])
      return mpsi_fail(context, create, MPS_ERROR_ARGUMENT,
                       "the domain in %c is [%g, %g] m, must be at least one cell", "xyz"[c],
                       d -> lower[c], d -> upper[c]);
  }
  return MPS_OK;
}

static mps_status check_set(mps_context *context, mps_particles *set) {
  if (!set) return mpsi_fail(context, create, MPS_ERROR_ARGUMENT, "particles is NULL");
  if (mpsi_particles_context(set) != context)
    return mpsi_fail(context, create, MPS_ERROR_ARGUMENT,
                     "the particle set was made from another context");
  const int64_t count = mps_particles_count(set);
  if (count < 1 || count > MAX_COUNT)
    return mpsi_fail(context, create, MPS_ERROR_ARGUMENT,
                     "the set has %lld particles, allowed are 1 to %d", (long long)count,
                     MAX_COUNT);
  if (!mpsi_particles_column(set, "density", 0))
    return mpsi_fail(context, create, MPS_ERROR_FIELD,
                     "the set has no field 'density': mps_particles_set adds it");
  return MPS_OK;
}

/* A field's columns must be finite where the solver starts from them. */
static mps_status check_start(const mps_mpm *mpm, const char *function) {
  static const char *const names[] = {
      "position", "velocity", "velocity_gradient",    "stress",           "volume_ratio",
      "volume",   "density",  "deformation_gradient", "body_acceleration"};
  for (size_t f = 0; f < sizeof names / sizeof *names; f++)
    for (int32_t c = 0; c < 9; c++) {
      const double *value = mpsi_particles_column(mpm->particles, names[f], c);
      for (int64_t k = 0; value && k < mpm->p.count; k++)
        if (!isfinite(value[k]))
          return mpsi_fail(mpm->context, function, MPS_ERROR_ARGUMENT,
                           "'%s' of particle %lld is %g, must be finite", names[f],
                           (long long)mpsi_particles_integers(mpm->particles, "id")[k], value[k]);
    }
  for (int64_t k = 0; k < mpm->p.count; k++)
    for (int c = 0; c < mpm->dim; c++) {
      const double x = mpm->p.x[c][k], X = mpsi_grid_coordinate(mpm, c, x);
      const long long id = (long long)mpsi_particles_integers(mpm->particles, "id")[k];
      if (!(fabs(X) < MPSI_MAX_CELLS))
        return mpsi_fail(mpm->context, function, MPS_ERROR_ARGUMENT,
                         "particle %lld has %c = %g m, more than 2^30 cells from the origin", id,
                         "xyz"[c], x);
      if (!(X >= (double)mpm->grid.low[c] && X <= (double)mpm->grid.high[c]))
        return mpsi_fail(mpm->context, function, MPS_ERROR_ARGUMENT,
                         "particle %lld has %c = %g m, outside the domain [%g, %g] m", id, "xyz"[c],
                         x, mpm -> def.lower[c], mpm->def.upper[c]);
    }
  return MPS_OK;
}

/* ---- fields ---------------------------------------------------------------------------------- */

static mps_status add_fields(mps_mpm *mpm) {
  static const char *const names[] = {"velocity", "velocity_gradient", "stress", "volume", "mass"};
  mps_status status = MPS_OK;
  for (size_t k = 0; k < sizeof names / sizeof *names && status == MPS_OK; k++)
    status = mps_particles_add_field(mpm->particles, names[k], 0);
  return status;
}

static void bind_fields(mps_mpm *mpm) {
  mps_particles *set = mpm->particles;
  mpsi_columns *p = &mpm->p;
  for (int c = 0; c < mpm->dim; c++) {
    p->x[c] = mpsi_particles_column(set, "position", c);
    p->v[c] = mpsi_particles_column(set, "velocity", c);
    mpm->loads.body_acceleration[c] = mpsi_particles_column(set, "body_acceleration", c);
  }
  for (int c = 0; c < 2 * mpm->dim; c++) p->s[c] = mpsi_particles_column(set, "stress", c);
  for (int c = 0; c < 9; c++) /* NULL where there is no such component */
    p->L[c] = mpsi_particles_column(set, "velocity_gradient", c);
  p->V = mpsi_particles_column(set, "volume", 0);
  p->m = mpsi_particles_column(set, "mass", 0);
}

/* The volume of a particle that the caller gave none. */
static double lattice_volume(const mps_mpm *mpm, int64_t k) {
  const double spacing = mps_particles_spacing(mpm->particles);
  if (mpm->dim == 3) return spacing * spacing * spacing;
  return spacing * spacing * (mpm->def.geometry == MPS_AXISYMMETRIC ? mpm->p.x[0][k] : 1.0);
}

static mps_status check_volumes(const mps_mpm *mpm, const double *density) {
  const mpsi_columns *p = &mpm->p;
  for (int64_t k = 0; k < mpm->p.count; k++) {
    const double volume = p->V[k] != 0.0 ? p->V[k] : lattice_volume(mpm, k);
    const double ratio = !p->J ? 1.0 : p->J[k] != 0.0 ? p->J[k] : 1.0;
    if (!(density[k] > 0.0) || !(volume > 0.0) || !(ratio > 0.0))
      return mpsi_fail(mpm->context, create, MPS_ERROR_ARGUMENT,
                       "particle %lld has density %g kg/m3, volume %g m3 and volume ratio %g, must "
                       "be > 0%s",
                       (long long)mpsi_particles_integers(mpm->particles, "id")[k], density[k],
                       volume, ratio, volume == 0.0 ? " (it lies on the axis, r = 0)" : "");
  }
  return MPS_OK;
}

/* Volumes and masses from density and spacing; unstrained states where the caller gave none. */
static mps_status set_start(mps_mpm *mpm) {
  mpsi_columns *p = &mpm->p;
  const double *density = mpsi_particles_column(mpm->particles, "density", 0);
  const mps_status status = check_volumes(mpm, density);
  if (status != MPS_OK) return status;
  for (int64_t k = 0; k < mpm->p.count; k++) {
    if (p->V[k] == 0.0) p->V[k] = lattice_volume(mpm, k);
    p->m[k] = density[k] * p->V[k]; /* the density is that of the present volume */
    const double mass = mpm->def.geometry == MPS_AXISYMMETRIC ? p->m[k] / p->x[0][k] : p->m[k];
    if (k == 0 || mass < mpm->contact.least_mass) mpm->contact.least_mass = mass;
    mpsi_mpm_begin_law(mpm, &mpm->laws.law[0], k);
  }
  return MPS_OK;
}

/* ---- life ------------------------------------------------------------------------------------ */

static mps_status make_workers(mps_mpm *mpm) {
  mpm->grid.worker_count = mps_context_threads(mpm->context);
  mpm->grid.workers = mpsi_alloc(mpm->context, mpm->grid.worker_count, sizeof *mpm->grid.workers);
  const size_t bytes = mpsi_worker_bytes(mpm), tile = (size_t)mpm->grid.tile_nodes;
  for (int32_t k = 0; mpm->grid.workers && k < mpm->grid.worker_count; k++) {
    mpsi_worker *w = &mpm->grid.workers[k];
    char *memory = w->memory = mpsi_alloc(mpm->context, 1, bytes);
    if (!memory) return mpsi_fail_memory(mpm->context, create, bytes);
    w->tile = (mpsi_node *)memory;
    w->force = w->tile + tile;
    w->inside = (uint32_t *)(w->force + tile);
    w->state = (uint8_t *)(w->inside + tile); /* and a little more: rows are read as four */
  }
  return mpm->grid.workers ? MPS_OK
                           : mpsi_fail_memory(mpm->context, create, sizeof *mpm->grid.workers);
}

static void place_walls(mps_mpm *mpm) {
  const mps_mpm_def *d = &mpm->def;
  for (int32_t k = 0; k < MPSI_HOLDS; k++) mpm->boundaries.hold[k].kind = MPSI_HOLD_NONE;
  for (int32_t k = 0; k < 2 * mpm->dim; k++)
    mpsi_mpm_place_wall(mpm, k, k % 2 ? d->wall_upper[k / 2] : d->wall_lower[k / 2],
                        k % 2 ? d->wall_friction_upper[k / 2] : d->wall_friction_lower[k / 2]);
}

/* The first step's size against what the first state allows. */
static mps_status check_step(mps_mpm *mpm) {
  const double dt = mpm->def.dt, limit = mps_mpm_limit(mpm);
  if (dt <= limit) return MPS_OK;
  return mpsi_fail(
      mpm->context, create, MPS_ERROR_ARGUMENT,
      "dt is %g s, above the Courant limit of the first state, %g s: choose at most half "
      "of that, or 0 for a step that follows the limit",
      dt, limit);
}

static mps_status build(mps_mpm *mpm, mps_material *material) {
  mps_context *context = mpm->context;
  mps_status status = add_fields(mpm);
  if (status == MPS_OK) status = mpsi_mpm_add_law(mpm, create, material);
  if (status != MPS_OK) return status;
  bind_fields(mpm);
  status = check_start(mpm, create);
  if (status == MPS_OK) status = set_start(mpm);
  if (status != MPS_OK) return status;
  mpm->grid.radix = mpsi_alloc(context, 2 * mpm->p.count, sizeof *mpm->grid.radix);
  if (mpm->grid.radix) mpm->laws.flags = mpsi_alloc(context, mpm->p.count, sizeof *mpm->laws.flags);
  const bool by_cell = mpm->def.volumetric == MPS_VOLUMETRIC_CELL;
  if (mpm->laws.flags && by_cell)
    mpm->p.stencil = mpsi_alloc(context, mpm->p.count, sizeof *mpm->p.stencil);
  if (!mpm->laws.flags || (by_cell && !mpm->p.stencil))
    return mpsi_fail_memory(context, create, (size_t)mpm->p.count * sizeof *mpm->grid.radix);
  status = make_workers(mpm);
  if (status == MPS_OK && mpm->loads.body_acceleration[0])
    status = mpsi_mpm_make_forces(mpm, create);
  if (status == MPS_OK) status = mpsi_mpm_sort(mpm, create);
  if (status == MPS_OK) status = mpsi_mpm_list_holds(mpm, create);
  if (status != MPS_OK) return status;
  mpsi_mpm_for_cells(mpm, mpm->kernels->speed);
  status = mpsi_mpm_collect_block_results(mpm, create);
  return status == MPS_OK ? check_step(mpm) : status;
}

/* The caller has written a field: it must be one to start from, and is read before the next step.
 */
static mps_status note_edit(void *self, const char *function, const char *field) {
  mps_mpm *mpm = self;
  (void)field;
  const mps_status status = check_start(mpm, function);
  if (status == MPS_OK) mpm->run.edited = mpm->run.stale = true;
  return status;
}

mps_status mps_mpm_create(mps_context *context, mps_particles *particles, mps_material *material,
                          const mps_mpm_def *user_def, mps_mpm **out) {
  if (!context) return MPS_ERROR_ARGUMENT;
  if (!out) return mpsi_fail(context, __func__, MPS_ERROR_ARGUMENT, "out is NULL");
  *out = NULL;
  if (!material) return mpsi_fail(context, __func__, MPS_ERROR_ARGUMENT, "material is NULL");
  mps_mpm_def def = mpm_defaults;
  int64_t low[3], high[3];
  mps_status status = check_set(context, particles);
  if (status == MPS_OK && user_def)
    status = MPSI_DEF_READ(context, __func__, mps_mpm_def, user_def, &def);
  if (status == MPS_OK) status = check_choices(context, &def);
  if (status == MPS_OK && mps_particles_dim(particles) != dim_of(&def))
    status = mpsi_fail(context, __func__, MPS_ERROR_ARGUMENT,
                       "geometry is %d, and the set has %d dimensions: it needs %s", def.geometry,
                       mps_particles_dim(particles),
                       dim_of(&def) == 3 ? "0 (plane strain) or 1 (axisymmetric)" : "2 (space)");
  if (status == MPS_OK) status = check_numbers(context, &def);
  if (status == MPS_OK) status = read_domain(context, &def, low, high);
  if (status == MPS_OK) status = mpsi_particles_check_hold(particles, __func__, MPSI_USE_MOVE);
  if (status != MPS_OK) return status;
  mps_mpm *mpm = mpsi_alloc(context, 1, sizeof *mpm);
  if (!mpm) return mpsi_fail_memory(context, __func__, sizeof *mpm);
  mpm->context = mpsi_context_retain(context);
  mpm->particles = particles;
  mpm->holder = (mpsi_holder){.name = "a WLS-MPM solver (mps_mpm)",
                              .self = mpm,
                              .kind = MPSI_USE_MOVE,
                              .commit = note_edit};
  (void)mpsi_particles_hold(particles, __func__, &mpm->holder); /* checked above */
  mpm->def = def;
  mpm->standard = def.scheme == MPS_SCHEME_STANDARD;
  mpm->flip = mpm->standard ? def.flip : 0.0;
  mpm->dim = dim_of(&def);
  mpm->grid.block_nodes = mpm->dim == 3 ? MPSI_SIDE * MPSI_SIDE * MPSI_SIDE : MPSI_SIDE * MPSI_SIDE;
  mpm->grid.tile_nodes = mpm->dim == 3 ? MPSI_TILE_SIDE * MPSI_TILE_SIDE * MPSI_TILE_SIDE
                                       : MPSI_TILE_SIDE * MPSI_TILE_SIDE;
  mpm->kernels = mpsi_mpm_kernels(mpsi_context_level(context));
  mpm->p.count = mps_particles_count(particles);
  mpm->grid.inverse = 1.0 / def.cell;
  mpm->contact.gap = 0.5 * mps_particles_spacing(particles);
  memcpy(mpm->grid.low, low, sizeof low);
  memcpy(mpm->grid.high, high, sizeof high);
  place_walls(mpm);
  if ((status = build(mpm, material)) != MPS_OK) {
    mps_mpm_destroy(&mpm);
    return status;
  }
  *out = mpm;
  return MPS_OK;
}

void mps_mpm_destroy(mps_mpm **pointer) {
  if (!pointer || !*pointer) return;
  mps_mpm *mpm = *pointer;
  mps_context *context = mpm->context;
  *pointer = NULL;
  for (int32_t b = 0; b < mpm->contact.bodies; b++) mpsi_body_give(mpm->contact.body[b]);
  for (int32_t k = 0; mpm->grid.workers && k < mpm->grid.worker_count; k++)
    mpsi_free(context, mpm->grid.workers[k].memory);
  void *parts[] = {mpm->grid.workers,
                   mpm->grid.cells_room.item,
                   mpm->grid.coloured_room.item,
                   mpm->grid.digits_room.item,
                   mpm->grid.pass_room.item,
                   mpm->grid.nodes_room.item,
                   mpm->grid.node_room.item,
                   mpm->grid.side_room.item,
                   mpm->contact.cell_pair_room.item,
                   mpm->contact.node_pair_room.item,
                   mpm->contact.node_room.item,
                   mpm->contact.inside_room.item,
                   mpm->contact.reached_room.item,
                   mpm->boundaries.held_room.item,
                   mpm->boundaries.dash_room.item,
                   mpm->boundaries.old_held_room.item,
                   mpm->boundaries.old_dash_room.item,
                   mpm->loads.force_memory,
                   mpm->grid.radix,
                   mpm->laws.flags,
                   mpm->p.stencil};
  for (size_t k = 0; k < sizeof parts / sizeof *parts; k++) mpsi_free(context, parts[k]);
  mpsi_mpm_drop_loads(mpm);
  for (int32_t k = 0; k < MPSI_HOLDS; k++)
    for (int c = 0; c < 3; c++) mps_signal_destroy(&mpm->boundaries.hold[k].signal[c]);
  for (int32_t k = 0; k < mpm->laws.count; k++) {
    mps_material_destroy(&mpm->laws.law[k].material);
    mpsi_free(context, mpm->laws.law[k].history);
  }
  mpsi_state_forget(&mpm->identity);
  mpsi_particles_release(mpm->particles, &mpm->holder);
  mpsi_free(context, mpm);
  mpsi_context_release(context);
}

/* Half spaces are there to be laid one over the other, as floor and wall. */
static mps_status check_overlap(mps_mpm *mpm, const char *function, const mps_body *body) {
  const double depth = OVERLAP * mpm->def.cell;
  for (int32_t b = 0; b < mpm->contact.bodies; b++) {
    const bool halves = body->shape == MPSI_HALF && mpm->contact.body[b]->shape == MPSI_HALF;
    if (mpm->contact.body[b] == body || halves ||
        !mpsi_body_overlap(mpm->contact.body[b], body, depth))
      continue;
    return mpsi_fail(mpm->context, function, MPS_ERROR_ARGUMENT,
                     "the body overlaps body %d of the solver by more than %g m (%g cells)", b,
                     depth, OVERLAP);
  }
  return MPS_OK;
}

static void warn_about_thickness(mps_mpm *mpm, const mps_body *body) {
  const double wall = mpsi_body_thickness(body), cells = wall * mpm->grid.inverse;
  if (cells < THIN * (1.0 - 1e-9))
    mpsi_log(
        mpm->context, MPS_LOG_WARNING,
        "body %d has a wall %.4g m thin, %.3g cells: below %g cells momentum leaks through it; "
        "use a cell of at most %.4g m or a thicker wall",
        mpm->contact.bodies, wall, cells, THIN, wall / THIN);
}

mps_status mps_mpm_add_body(mps_mpm *mpm, mps_body *body) {
  if (!mpm) return MPS_ERROR_ARGUMENT;
  if (!body) return mpsi_fail(mpm->context, __func__, MPS_ERROR_ARGUMENT, "body is NULL");
  if (body->context != mpm->context)
    return mpsi_fail(mpm->context, __func__, MPS_ERROR_ARGUMENT,
                     "the body was made from another context");
  if (body->dim != mpm->dim)
    return mpsi_fail(mpm->context, __func__, MPS_ERROR_ARGUMENT, "the body is %dD, the solver %dD",
                     body->dim, mpm->dim);
  if (mpm->contact.bodies == MPS_MPM_MAX_BODIES)
    return mpsi_fail(mpm->context, __func__, MPS_ERROR_ARGUMENT,
                     "the solver has %d bodies, the most there can be", MPS_MPM_MAX_BODIES);
  const mps_status status = check_overlap(mpm, __func__, body);
  if (status != MPS_OK) return status;
  if (!mpsi_body_take(body, mpm))
    return mpsi_fail(mpm->context, __func__, MPS_ERROR_STATE, "a solver has the body already");
  warn_about_thickness(mpm, body);
  mpm->contact.body[mpm->contact.bodies++] = body;
  return MPS_OK;
}
