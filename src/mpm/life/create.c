/* create.c - life of the WLS-MPM solver: definition, checks, fields, bodies.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "mpm/base/mpm_solver.h"
#include "mpm/life/conditions.h"
#include "mpm/life/restart.h"
#include "mpm/reading/totals.h"
#include "mpm/base/march.h"
#include "mpm/boundary/free_field.h"
#include "mpm/particles/mpm_particles.h"
#include "mpm/step/insertion.h"
#include "mpm/water/water.h"

#include "core/particles/particles_internal.h"
#include "core/context/retain.h"
#include "core/definition/digits.h"
#include "solver/linear.h"

#include <mps/experimental/papers.h>
#include <mps/experimental/domain.h>

#include <string.h>

#define ON_NODE 1e-6 /* cells: a wall this close to a node is on it */
/* spacings: smaller cells, or cells larger than COARSEST, are taken for errors */
#define FINEST 0.5
#define COARSEST 100.0

/* ---- checks ---------------------------------------------------------------------------------- */

static const char create[] = "mps_mpm_create";

static int dim_of(const mps_mpm_def *d) { return d->geometry == MPS_MPM_GEOMETRY_SPACE ? 3 : 2; }

/* Radius of the weights, m. */
static double radius_of(const mps_mpm_def *d) { return (d->spline == 2 ? 1.5 : 2.0) * d->cell; }

/* Degree of the caller's weights, which must be those of the grid. */
static mps_status read_kernel(mps_context *context, mps_mpm_def *d) {
  const int32_t kind = mps_kernel_get_kind(d->kernel);
  if (d->spline == 0) d->spline = 3;
  if (!d->kernel) return MPS_OK;
  if (kind != MPS_KERNEL_SPLINE2 && kind != MPS_KERNEL_SPLINE3)
    return mpsi_fail(
        context, create, MPS_ERROR_ARGUMENT,
        "kernel: its kind is %s, allowed are MPS_KERNEL_SPLINE2 and MPS_KERNEL_SPLINE3",
        mpsi_name_of("mps_kernel_kind", kind).text);
  d->spline = kind == MPS_KERNEL_SPLINE2 ? 2 : 3;
  const double wanted = radius_of(d), radius = mps_kernel_radius(d->kernel);
  if (fabs(radius - wanted) <= ON_NODE * wanted) return MPS_OK;
  return mpsi_fail(context, create, MPS_ERROR_ARGUMENT,
                   "kernel has radius %g m, must be %g cells of %g m, %g m", radius,
                   wanted / d->cell, d->cell, wanted);
}

/* Node of a wall, or MPSI_NO_WALL without a wall. */
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
  if (d->geometry == MPS_MPM_GEOMETRY_AXISYMMETRIC) {
    if (d->lower[0] == -INFINITY) d->lower[0] = 0.0;
    if (!(d->lower[0] >= 0.0))
      return mpsi_fail(context, create, MPS_ERROR_ARGUMENT,
                       "lower[0] is %g m, in axisymmetry the radius begins at 0 or more",
                       d->lower[0]);
  }
  low[2] = high[2] = 0;
  for (int c = 0; c < dim_of(d); c++) {
    MPSI_TRY(read_wall(context, d, c, false, &low[c]));
    MPSI_TRY(read_wall(context, d, c, true, &high[c]));
    if (low[c] >= high[c])
      return mpsi_fail(context, create, MPS_ERROR_ARGUMENT,
                       "the domain in %c is [%g, %g] m, must be at least one cell", "xyz"[c],
                       d -> lower[c], d -> upper[c]);
  }
  return MPS_OK;
}

static mps_status check_cell(mps_context *context, const mps_mpm_def *d, mps_particles *set) {
  const double spacing = mps_particles_spacing(set), ratio = d->cell / spacing;
  if (ratio >= FINEST && ratio <= COARSEST) return MPS_OK;
  return mpsi_fail(context, create, MPS_ERROR_ARGUMENT,
                   "cell is %g m with particles %g m apart: must be %g to %g of their spacings, "
                   "usually 2",
                   d->cell, spacing, FINEST, COARSEST);
}

static mps_status check_set(mps_context *context, mps_particles *set) {
  if (!set) return mpsi_fail(context, create, MPS_ERROR_ARGUMENT, "particles is NULL");
  if (mpsi_particles_context(set) != context)
    return mpsi_fail(context, create, MPS_ERROR_ARGUMENT,
                     "the particle set was made from another context");
  /* a rank may have none of a set in parts */
  const bool parts = mpsi_particles_deal(set) && mpsi_particles_made(set) > 0;
  const int64_t count = mps_particles_count(set);
  if (count < (parts ? 0 : 1) || count > MPSI_MPM_MOST_PARTICLES)
    return mpsi_fail(context, create, MPS_ERROR_ARGUMENT,
                     "the set has %lld particles, allowed are 1 to %d", (long long)count,
                     MPSI_MPM_MOST_PARTICLES);
  if (!mpsi_particles_column(set, "density", 0))
    return mpsi_fail(context, create, MPS_ERROR_FIELD,
                     "the set has no field 'density': mps_particles_set adds it");
  return MPS_OK;
}

/* ---- several ranks --------------------------------------------------------------------------- */

static bool is_shared(const mps_mpm_def *d) { return mpsi_domain_many(d->domain); }

/* Whether each rank has been given a part of the set, not all of it. */
static bool in_parts(const mpsi_columns *p) { return mpsi_particles_deal(p->set) != NULL; }

/* Largest speed and smallest mass over all ranks. */
static mps_status join_extremes(mpsi_contacts *contacts, mpsi_run *run, const mps_mpm_def *def,
                                mps_status status) {
  double most[2] = {run->speed, isnan(contacts->least_mass) ? -INFINITY : -contacts->least_mass};
  MPSI_TRY(mpsi_domain_agree_max(def->domain, create, status, 2, most));
  run->speed = most[0];
  contacts->least_mass = most[1] == -INFINITY ? NAN : -most[1];
  return MPS_OK;
}

/* ---- fields ---------------------------------------------------------------------------------- */

static mps_status add_fields(mps_context *context, const mpsi_columns *p) {
  static const char *const names[] = {"velocity", "velocity_gradient", "stress", "volume", "mass"};
  for (size_t k = 0; k < sizeof names / sizeof *names; k++)
    MPSI_TRY(mpsi_as(context, create, mps_particles_add_field(p->set, names[k], 0)));
  return MPS_OK;
}

/* ---- restoring the set after an error -------------------------------------------------------- */

/* Columns that mpsi_mpm_begin_particles writes: volume, mass, V/V0, F and the law's histories. */
enum { OWN_COLUMNS = 12 };

static double *written(const mpsi_columns *p, int32_t number) {
  if (number == 0) return p->V;
  if (number == 1) return p->m;
  if (number == 2) return p->J;
  return number < OWN_COLUMNS ? p->F[number - 3] : p->laws.law[0].history[number - OWN_COLUMNS];
}

static int32_t written_count(const mpsi_columns *p) {
  return OWN_COLUMNS + mps_material_history_count(p->laws.law[0].material);
}

/* Whether the first `fields` fields, those of the caller, are among these columns. */
static bool writes_given(const mpsi_columns *p, int32_t fields) {
  for (int32_t f = 0; f < fields; f++) {
    mps_particles_field_info info = {.name = ""};
    if (mps_particles_get_field_info(p->set, f, &info) != MPS_OK) return true;
    for (int32_t c = 0; c < written_count(p) && info.dtype.code != 0; c++)
      if (written(p, c) == mpsi_particles_column(p->set, info.name, 0)) return true;
  }
  return false;
}

static mps_status save_columns(mps_context *context, const mpsi_columns *p, double **copy) {
  const int32_t columns = written_count(p);
  const int64_t count = p->count;
  *copy = mpsi_alloc(context, columns * count, sizeof **copy);
  if (!*copy) return mpsi_fail_memory(context, create, (size_t)(columns * count) * sizeof **copy);
  for (int32_t c = 0; c < columns; c++)
    if (written(p, c)) memcpy(*copy + c * count, written(p, c), (size_t)count * sizeof **copy);
  return MPS_OK;
}

static void restore_columns(const mpsi_columns *p, const double *copy) {
  const int64_t count = p->count;
  for (int32_t c = 0; c < written_count(p); c++)
    if (written(p, c)) memcpy(written(p, c), copy + c * count, (size_t)count * sizeof *copy);
}

/* ---- life ------------------------------------------------------------------------------------ */

static mps_status make_workers(mps_context *context, mpsi_grid *grid) {
  grid->worker_count = mps_context_threads(context);
  grid->workers = mpsi_alloc(context, grid->worker_count, sizeof *grid->workers);
  const size_t bytes = mpsi_worker_bytes(grid), tile = (size_t)grid->tile_nodes;
  for (int32_t k = 0; grid->workers && k < grid->worker_count; k++) {
    mpsi_worker *w = &grid->workers[k];
    char *memory = w->memory = mpsi_alloc(context, 1, bytes);
    if (!memory) return mpsi_fail_memory(context, create, bytes);
    w->scratch = memory;
    w->tile = (mpsi_node *)(memory + MPSI_WORKER_SCRATCH);
    w->force = w->tile + tile;
    w->strain = w->force + tile;
    w->state = (uint8_t *)(w->strain + tile); /* with a margin: rows are read as four */
  }
  return grid->workers ? MPS_OK : mpsi_fail_memory(context, create, sizeof *grid->workers);
}

/* Largest speed of the initial state; in the set's own order. */
static mps_status find_speed(mps_mpm *mpm) {
  const mpsi_columns *p = &mpm->p;
  double moduli[MPSI_CHUNK];
  mpsi_pore_speeds none; /* no water yet */
  for (int64_t begin = 0; begin < p->count; begin += MPSI_CHUNK) {
    const int64_t end = begin + MPSI_CHUNK < p->count ? begin + MPSI_CHUNK : p->count;
    mpsi_mpm_find_moduli(&mpm->grid, &mpm->p, mpm->water, &mpm->run, &mpm->def, begin, end, moduli,
                         &none);
    for (int64_t k = begin; k < end; k++) {
      double square = 0.0;
      for (int c = 0; c < mpm->grid.dim && mpm->def.step_from == MPS_MPM_STEP_FROM_SPEED; c++)
        square += p->v[c][k] * p->v[c][k];
      const double speed = sqrt(moduli[k - begin] * p->V[k] / p->m[k]) + sqrt(square);
      if (!(speed > 0.0 && speed <= 1e300))
        return mpsi_fail(mpm->context, create, MPS_ERROR_ARGUMENT,
                         "particle %lld has a wave velocity plus velocity of %g m/s: must be > 0 "
                         "and finite; check modulus, density and velocity",
                         (long long)mpsi_particles_integers(mpm->p.set, "id")[k], speed);
      mpm->run.speed = fmax(mpm->run.speed, speed);
    }
  }
  return MPS_OK;
}

/* Checks a given dt against the limit of the initial state. */
static mps_status check_step(const mps_mpm *mpm) {
  const double dt = mpm->def.dt, limit = mpsi_mpm_limit(mpm);
  if (isnan(dt) || dt <= limit) return MPS_OK;
  return mpsi_fail(mpm->context, create, MPS_ERROR_ARGUMENT,
                   "dt is %g s, above the Courant limit h/(c + v) of the first state, %g s: choose "
                   "at most half of that, or NaN for a step that follows the limit",
                   dt, limit);
}

static mps_status make_memory(mps_mpm *mpm) {
  if (!mpsi_mpm_hold_room(mpm, mpm->p.count))
    return mpsi_fail_memory(mpm->context, create, (size_t)mpm->p.count * sizeof *mpm->grid.radix);
  return make_workers(mpm->context, &mpm->grid);
}

/* Initial state of the particles, and their order. */
static mps_status begin(mps_mpm *mpm) {
  mpsi_mpm_begin_particles(&mpm->grid, &mpm->p, &mpm->contact);
  MPSI_TRY(find_speed(mpm));
  MPSI_TRY(check_step(mpm));
  MPSI_TRY(make_memory(mpm));
  return is_shared(&mpm->def)
             ? mpsi_mpm_sort_cells(mpm->context, &mpm->grid, &mpm->p, &mpm->run, create)
             : mpsi_mpm_sort(mpm, create);
}

/* Builds a solver over the whole set. All that can fail comes before the sort, which orders the set
 * at its end. On several ranks the caller undoes the changes after an error. */
static mps_status build(mps_mpm *mpm, mps_material *material, mps_status status,
                        mpsi_storage **former) {
  const int32_t fields = mps_particles_field_count(mpm->p.set);
  const bool shared = is_shared(&mpm->def);
  double *copy = NULL;
  if (status == MPS_OK) status = add_fields(mpm->context, &mpm->p);
  if (status == MPS_OK)
    status = mpsi_mpm_add_law(mpm->context, &mpm->grid, &mpm->p, &mpm->rooms, &mpm->def, create,
                              material);
  if (status == MPS_OK) {
    mpsi_mpm_bind(&mpm->grid, &mpm->p, mpm->water);
    status = mpsi_mpm_check_start(mpm->context, &mpm->grid, &mpm->p, &mpm->def, create);
    if (status == MPS_OK)
      status = mpsi_mpm_check_amounts(mpm->context, &mpm->grid, &mpm->p, create);
    if (status == MPS_OK)
      status = mpsi_mpm_check_states(mpm->context, &mpm->grid, &mpm->p, create, 0, 0, mpm->p.count);
    status = mpsi_fail_of(mpm->context, status, "particles");
    if (status == MPS_OK && !shared) status = save_columns(mpm->context, &mpm->p, &copy);
    if (status == MPS_OK) status = begin(mpm);
    if (status != MPS_OK && copy) restore_columns(&mpm->p, copy);
    mpsi_free(mpm->context, copy);
  }
  if (shared)
    status = mpsi_mpm_share_begin(mpm->context, &mpm->p, mpm->def.domain, create, status,
                                  &mpm->partition);
  const mpsi_rank_part part = mpsi_rank_part_of(mpm);
  if (shared && status == MPS_OK) status = mpsi_mpm_partition_create(&part, create, former);
  if (status != MPS_OK && !shared) mpsi_particles_drop_fields(mpm->p.set, fields);
  mpm->boundaries.outdated = mpm->boundaries.renew = true; /* listed with the first step */
  return status;
}

/* Builds a solver over a set in parts: particles are sent to their ranks with the caller's fields
 * alone, and the solver's fields are added there. The set is copied, to be restored after an error,
 * only where a field of the caller is written. Every rank calls each collective function. */
static mps_status build_parts(mps_mpm *mpm, mps_material *material, mps_status status,
                              mpsi_backup *backup) {
  const int32_t fields = mps_particles_field_count(mpm->p.set);
  status =
      mpsi_mpm_share_begin(mpm->context, &mpm->p, mpm->def.domain, create, status, &mpm->partition);
  const mpsi_rank_part part = mpsi_rank_part_of(mpm);
  if (status == MPS_OK) status = mpsi_mpm_share_deal(&part, create);
  if (status != MPS_OK) return status;
  status = add_fields(mpm->context, &mpm->p);
  if (status == MPS_OK)
    status = mpsi_mpm_add_law(mpm->context, &mpm->grid, &mpm->p, &mpm->rooms, &mpm->def, create,
                              material);
  if (status == MPS_OK) {
    mpsi_mpm_bind(&mpm->grid, &mpm->p, mpm->water);
    status = mpsi_mpm_check_start(mpm->context, &mpm->grid, &mpm->p, &mpm->def, create);
    if (status == MPS_OK)
      status = mpsi_mpm_check_amounts(mpm->context, &mpm->grid, &mpm->p, create);
    if (status == MPS_OK)
      status = mpsi_mpm_check_states(mpm->context, &mpm->grid, &mpm->p, create, 0, 0, mpm->p.count);
    status = mpsi_fail_of(mpm->context, status, "particles");
  }
  if (status == MPS_OK && writes_given(&mpm->p, fields))
    status = mpsi_particles_back_up(mpm->p.set, create, backup);
  backup->field_count = fields;
  if (status == MPS_OK) {
    mpsi_mpm_begin_particles(&mpm->grid, &mpm->p, &mpm->contact);
    status = find_speed(mpm);
  }
  status = join_extremes(&mpm->contact, &mpm->run, &mpm->def, status);
  if (status == MPS_OK) status = check_step(mpm);
  if (status == MPS_OK) status = make_memory(mpm);
  if (status == MPS_OK)
    status = mpsi_mpm_sort_cells(mpm->context, &mpm->grid, &mpm->p, &mpm->run, create);
  status = mpsi_mpm_share_take_part(&part, create, status);
  if (status != MPS_OK && !backup->memory) mpsi_particles_drop_fields(mpm->p.set, fields);
  mpm->boundaries.outdated = mpm->boundaries.renew = true;
  return status;
}

/* Checks the definition for the set and fills in what it leaves open: kernel, measure, domain. */
static mps_status complete(mps_context *context, mps_particles *particles, mps_mpm_def *def,
                           int64_t *low, int64_t *high) {
  mps_status status = check_set(context, particles);
  if (status == MPS_OK && mps_particles_dim(particles) != dim_of(def))
    status = mpsi_fail(
        context, create, MPS_ERROR_ARGUMENT,
        "geometry is %s, and the set has %d dimensions: it needs %s",
        mpsi_name_of("mps_mpm_geometry", def->geometry).text, mps_particles_dim(particles),
        dim_of(def) == 3 ? "MPS_MPM_GEOMETRY_PLANE_STRAIN or MPS_MPM_GEOMETRY_AXISYMMETRIC"
                         : "MPS_MPM_GEOMETRY_SPACE");
  if (status == MPS_OK) status = read_kernel(context, def);
  if (isnan(def->measure))
    def->measure = def->geometry == MPS_MPM_GEOMETRY_AXISYMMETRIC ? 8.0 * atan(1.0) : 1.0;
  if (status == MPS_OK) status = check_cell(context, def, particles);
  if (status == MPS_OK) status = read_domain(context, def, low, high);
  if (status == MPS_OK) status = mpsi_particles_check_deal(particles, create, def->domain);
  if (status == MPS_OK) status = mpsi_particles_check_hold(particles, create, MPSI_USE_MOVE);
  const mpsi_amount amount = {def->measure, def->geometry == MPS_MPM_GEOMETRY_AXISYMMETRIC};
  if (status == MPS_OK)
    status = mpsi_fail_of(context, mpsi_particles_check_crowding(particles, create, 0, &amount),
                          "particles");
  return status;
}

static void free_rooms(mps_mpm *mpm) {
  for (int32_t k = 0; mpm->grid.workers && k < mpm->grid.worker_count; k++)
    mpsi_free(mpm->context, mpm->grid.workers[k].memory);
  MPSI_FREE(
      mpm->context, mpm->grid.workers, mpm->grid.cells_room.item, mpm->grid.coloured_room.item,
      mpm->grid.digits_room.item, mpm->grid.pass_room.item, mpm->grid.nodes_room.item,
      mpm->grid.node_room.item, mpm->grid.side_room.item, mpm->grid.fit_room.item,
      mpm->grid.fitted_room.item, mpm->contact.cell_pair_room.item,
      mpm->contact.node_pair_room.item, mpm->contact.node_room.item, mpm->contact.normal_room.item,
      mpm->contact.inside_room.item, mpm->contact.reached_room.item, mpm->contact.sight_room.item,
      mpm->contact.across_room.item, mpm->contact.beside_room.item, mpm->contact.penalty_room.item,
      mpm->contact.load_room.item, mpm->contact.held_room.item, mpm->contact.near_room.item,
      mpm->contact.sum_room.item, mpm->contact.handle_room.item, mpm->contact.body_room.item,
      mpm->contact.state_room.item, mpm->grid.across_room.item, mpm->mirrors.mirror_room.item,
      mpm->mirrors.mass_room.item, mpm->boundaries.held_room.item,
      mpm->boundaries.dashpot_room.item, mpm->boundaries.borne_room.item,
      mpm->boundaries.old_held_room.item, mpm->boundaries.old_dashpot_room.item,
      mpm->boundaries.warm_room.item, mpm->energy.cells_room.item, mpm->energy.nodes_room.item,
      mpm->settling.nodes_room.item, mpm->rooms.force.item, mpm->rooms.radix.item,
      mpm->rooms.stencil.item, mpm->rooms.places.item, mpm->rooms.strain.item,
      mpm->rooms.rough.item, mpm->rooms.gone.item, mpm->undo.list_room.item, mpm->undo.room.item,
      mpm->undo.dashpot_room.item, mpm->undo.sums_room.item, mpm->undo.boundary_room.item);
}

static void destroy(void *solver) {
  mps_mpm *mpm = solver;
  mps_context *context = mpm->context;
  mpsi_mpm_end_contacts(&mpm->contact);
  free_rooms(mpm);
  mpsi_pore_free(mpm);
  mpsi_mpm_free_impulses(mpm->context, &mpm->contact);
  mpsi_mpm_free_contact_exchange(mpm->context, &mpm->contact);
  mpsi_mpm_free_partners(&mpm->contact.partners, context);
  mpsi_mpm_free_prescribed(context, &mpm->prescribed);
  mpsi_mpm_drop_boundaries(mpm->context, &mpm->boundaries);
  for (int32_t k = 0; k < mpm->p.laws.count; k++) {
    mps_material_destroy(&mpm->p.laws.law[k].material);
    mpsi_free(context, mpm->p.laws.law[k].history);
  }
  mpsi_free(context, mpm->p.laws.room.item);
  mps_kernel_destroy(&mpm->weights);
  mpsi_mpm_partition_free(context, &mpm->partition);
}

/* ---- as one of all solvers ------------------------------------------------------------------- */

static double time_of(const void *solver) { return ((const mps_mpm *)solver)->run.time; }
static int64_t steps_of(const void *solver) { return ((const mps_mpm *)solver)->run.steps; }

static double dt_of(void *solver, const char *function) { return mpsi_mpm_dt(solver); }

static mps_status agree(void *solver, const char *function, mps_status status) {
  mps_mpm *mpm = solver;
  if (!mpm->partition) return status;
  return mpsi_mpm_agree_alike(&mpm->contact, mpm->partition, &mpm->run, &mpm->def, function, status,
                              0, NULL);
}

static mps_status use_dt(void *solver, const char *function, double dt) {
  mps_mpm *mpm = solver;
  if (mpm->bound.beyond >= 0)
    mpm->run.renewed = true; /* the caller continues from the present state */
  mpm->def.dt = dt;
  return MPS_OK;
}

static void changing(void *solver) { ((mps_mpm *)solver)->run.changed = true; }

static void get_def(const void *solver, void *out) {
  *(mps_mpm_def *)out = ((const mps_mpm *)solver)->def;
}

/* Whether a linear solver can be set. */
static mps_status linear_ready(void *solver, const char *function) {
  mps_mpm *mpm = solver;
  const mps_status status = mpsi_mpm_usable(mpm, function);
  if (status != MPS_OK || mpm->water) return status;
  return mpsi_fail(mpm->context, function, MPS_ERROR_STATE,
                   "the solver has no pore water: mps_mpm_add_pore_water adds it");
}

static const mpsi_solver_kind mpm_kind = {
    .name = MPSI_SOLVER_NAMES("mpm"),
    .task = "mpm",
    .def_kind = MPS_DEF_MPM,
    .get_def = get_def,
    .time = time_of,
    .steps = steps_of,
    .dt = dt_of,
    .limit = mpsi_mpm_limit,
    .changing = changing,
    .agree = agree,
    .check_dt = mpsi_mpm_check_dt,
    .use_dt = use_dt,
    .equation = MPS_LINEAR_EQUATION_PORE_PRESSURE,
    .linear_ready = linear_ready,
    .get_totals = mpsi_mpm_get_totals,
    .get_reaction = mpsi_mpm_get_reaction,
    .boundary = &mpsi_mpm_boundary_kind,
    .load = &mpsi_mpm_load_kind,
    .begin = mpsi_mpm_begin_march,
    .advance = mpsi_mpm_advance_march,
    .end = mpsi_mpm_end_march,
    .stopped = mpsi_mpm_stopped,
    .state = mpsi_mpm_state,
    .settle = mpsi_mpm_settle_state,
    .settled = mpsi_mpm_settled_state,
    .returned = mpsi_mpm_returned,
    .save = mpsi_mpm_save_state,
    .destroy = destroy,
};

static void enter_set(mps_mpm *mpm, const char *function, mps_context *context,
                      mps_particles *particles, mps_domain *domain, bool shared) {
  mpsi_holder holder = {.name = "a WLS-MPM solver (mps_mpm)",
                        .kind = MPSI_USE_MOVE,
                        .commit = mpsi_mpm_note_edit,
                        .compares = mpsi_mpm_compares,
                        .insert = mpsi_mpm_insert,
                        .remove = mpsi_mpm_remove,
                        .leaving = mpsi_mpm_thin_out,
                        .renew = mpsi_mpm_renew};
  if (shared) {
    holder.runs = mpsi_mpm_row_runs;
    holder.agree = mpsi_mpm_agree_on_insertion;
    holder.find = mpsi_mpm_find_removed;
  }
  mpsi_solver_start(&mpm->base, function, &mpm_kind, context, particles, domain, &holder);
  mpm->run.guard = &mpm->guard;
  mpm->p.set = particles;
  mpm->loads.list = &mpm->conditions[MPSI_LOADS];
}

/* Sets the members that depend on the definition alone. */
static void describe(mps_mpm *mpm, const mps_mpm_def *def, const int64_t *low,
                     const int64_t *high) {
  mpm->def = *def;
  mpm->grid.dim = dim_of(def);
  mpm->grid.block_nodes = MPSI_SIDE * MPSI_SIDE * (mpm->grid.dim == 3 ? MPSI_SIDE : 1);
  mpm->grid.tile_nodes =
      MPSI_TILE_SIDE * MPSI_TILE_SIDE * (mpm->grid.dim == 3 ? MPSI_TILE_SIDE : 1);
  mpm->energy.counts = def->budget != 0;
  mpm->kernels = mpsi_mpm_kernels(mpsi_context_level(mpm->context));
  mpm->p.count = mps_particles_count(mpm->p.set);
  mpm->p.laws.at_once = true; /* until some law needs means */
  mpm->grid.inverse = 1.0 / def->cell;
  mpm->grid.spline = def->spline, mpm->grid.cell = def->cell;
  mpm->grid.geometry = (mps_mpm_geometry)def->geometry, mpm->grid.measure = def->measure;
  memcpy(mpm->grid.origin, def->origin, sizeof mpm->grid.origin);
  memcpy(mpm->grid.low, low, sizeof mpm->grid.low);
  memcpy(mpm->grid.high, high, sizeof mpm->grid.high);
}

mps_status mps_mpm_create(mps_context *context, mps_particles *particles, mps_material *material,
                          const mps_mpm_def *user_def, mps_mpm **out) {
  if (!context) return mpsi_null(__func__, "context");
  if (!out) return mpsi_fail(context, __func__, MPS_ERROR_ARGUMENT, "out is NULL");
  *out = NULL;
  if (!material) return mpsi_fail(context, __func__, MPS_ERROR_ARGUMENT, "material is NULL");
  mps_mpm_def def = mps_mpm_defaults();
  int64_t low[3], high[3];
  mps_status status = MPSI_DEF_READ_OR_DEFAULTS(context, __func__, mps_mpm_def, user_def, &def);
  if (mpsi_domain_check(context, __func__, def.domain) != MPS_OK) return MPS_ERROR_ARGUMENT;
  /* what one rank refuses, all do: they agree below */
  if (status == MPS_OK) status = complete(context, particles, &def, low, high);
  mpsi_backup backup = {0};
  mpsi_storage *former = NULL;
  mps_mpm *mpm = status == MPS_OK ? mpsi_alloc(context, 1, sizeof *mpm) : NULL;
  if (status == MPS_OK && (!mpm || !mpsi_room_keep(context, &mpm->boundaries.boundary_room,
                                                   MPSI_SIDES, sizeof(mpsi_boundary))))
    status = mpsi_fail_memory(context, __func__, sizeof *mpm + MPSI_SIDES * sizeof(mpsi_boundary));
  if (status == MPS_OK && is_shared(&def) && !mpsi_particles_deal(particles))
    status = mpsi_particles_back_up(particles, __func__, &backup);
  status = mpsi_domain_agree(def.domain, __func__, status);
  if (status != MPS_OK) {
    if (backup.memory) mpsi_backup_drop(particles, &backup);
    if (mpm) mpsi_free(context, mpm->boundaries.boundary_room.item);
    mpsi_free(context, mpm);
    return status;
  }
  mpm->reader.mpm = mpm;
  enter_set(mpm, __func__, context, particles, def.domain, is_shared(&def)); /* checked above */
  mpm->run.changed = mpm->run.renewed = true;
  describe(mpm, &def, low, high);
  if (!mpsi_mpm_begin_sides(mpm->context, &mpm->grid, &mpm->boundaries))
    status = mpsi_fail_memory(context, __func__, MPSI_SIDES * sizeof(mpsi_boundary_sums));
  if (def.kernel)
    mpm->weights = mpsi_kernel_retain(def.kernel);
  else if (status == MPS_OK)
    status = mpsi_as(context, __func__,
                     mps_kernel_create(context,
                                       def.spline == 2 ? MPS_KERNEL_SPLINE2 : MPS_KERNEL_SPLINE3,
                                       radius_of(&def), &mpm->weights));
  status = in_parts(&mpm->p) ? build_parts(mpm, material, status, &backup)
                             : build(mpm, material, status, &former);
  if (status != MPS_OK) {
    mpsi_particles_take_back(particles, &former);
    if (is_shared(&def)) mpsi_particles_go_back(particles, &backup);
    mpsi_solver_end(&mpm->base);
    return status;
  }
  mpsi_backup_drop(particles, &backup);
  mpsi_storage_drop(particles, &former);
  *out = mpm;
  return MPS_OK;
}

mps_solver *mps_mpm_solver(const mps_mpm *mpm) { return mpm ? (mps_solver *)&mpm->base : NULL; }

/* ---- variants for comparison ----------------------------------------------------------------- */

/* Checks that a variant is chosen before the first step, the same on all ranks. */
static mps_status check_before_steps(mps_context *context, mpsi_run *run, const mps_mpm_def *def,
                                     const char *function, const char *name, double value) {
  mps_status status = mpsi_mpm_between_steps(context, run, function);
  if (status != MPS_OK) return status;
  if (run->steps > 0)
    status = mpsi_fail(context, function, MPS_ERROR_STATE,
                       "the solver has taken %lld steps: the variant is chosen before the first",
                       (long long)run->steps);
  return mpsi_domain_agree_same(def->domain, function, status, name, value);
}

mps_status mps_experimental_mpm_transfer(mps_mpm *mpm, int32_t transfer) {
  if (!mpm) return mpsi_null(__func__, "mpm");
  MPSI_TRY(check_before_steps(mpm->context, &mpm->run, &mpm->def, __func__, "transfer", transfer));
  if (transfer != MPS_EXPERIMENTAL_TRANSFER_SHAPE && transfer != MPS_EXPERIMENTAL_TRANSFER_WEIGHT)
    return mpsi_fail(mpm->context, __func__, MPS_ERROR_ARGUMENT,
                     "transfer is %d, allowed are MPS_EXPERIMENTAL_TRANSFER_SHAPE and _WEIGHT",
                     transfer);
  if (transfer == MPS_EXPERIMENTAL_TRANSFER_WEIGHT && mpm->def.flip_time > 0.0)
    return mpsi_fail(
        mpm->context, __func__, MPS_ERROR_ARGUMENT,
        "transfer is MPS_EXPERIMENTAL_TRANSFER_WEIGHT, but flip_time of the definition "
        "is %g s: must be 0",
        mpm->def.flip_time);
  if (transfer == MPS_EXPERIMENTAL_TRANSFER_WEIGHT && mpsi_mpm_has_free_field(&mpm->boundaries))
    return mpsi_fail(mpm->context, __func__, MPS_ERROR_ARGUMENT,
                     "transfer is MPS_EXPERIMENTAL_TRANSFER_WEIGHT, which a side of kind "
                     "MPS_BOUNDARY_FREE_FIELD does not allow");
  if (transfer == MPS_EXPERIMENTAL_TRANSFER_WEIGHT) mpm->def.flip_time = 0.0; /* not left open */
  mpm->grid.by_weight = transfer == MPS_EXPERIMENTAL_TRANSFER_WEIGHT;
  return MPS_OK;
}

mps_status mps_experimental_mpm_strain(mps_mpm *mpm, int32_t strain) {
  if (!mpm) return mpsi_null(__func__, "mpm");
  MPSI_TRY(check_before_steps(mpm->context, &mpm->run, &mpm->def, __func__, "strain", strain));
  if (strain != MPS_EXPERIMENTAL_STRAIN_DERIVATIVE && strain != MPS_EXPERIMENTAL_STRAIN_FIT)
    return mpsi_fail(mpm->context, __func__, MPS_ERROR_ARGUMENT,
                     "strain is %d, allowed are MPS_EXPERIMENTAL_STRAIN_DERIVATIVE and _FIT",
                     strain);
  mpm->grid.strain_by_fit = strain == MPS_EXPERIMENTAL_STRAIN_FIT;
  return MPS_OK;
}

mps_status mps_experimental_mpm_standard(mps_mpm *mpm, double flip) {
  if (!mpm) return mpsi_null(__func__, "mpm");
  MPSI_TRY(check_before_steps(mpm->context, &mpm->run, &mpm->def, __func__, "flip", flip));
  if (!(flip >= 0.0 && flip <= 1.0))
    return mpsi_fail(mpm->context, __func__, MPS_ERROR_ARGUMENT, "flip is %s, must be in [0, 1]",
                     mpsi_outside(flip, 0.0, 1.0).text);
  if (mpm->def.flip_time > 0.0)
    return mpsi_fail(mpm->context, __func__, MPS_ERROR_ARGUMENT,
                     "flip is given, but flip_time of the definition is %g s: must be 0",
                     mpm->def.flip_time);
  mpm->grid.standard = true;
  mpm->grid.flip = flip;
  const mps_status widened =
      mpsi_domain_agree(mpm->def.domain, __func__,
                        mpsi_mpm_widen_sides(mpm->context, &mpm->grid, &mpm->boundaries, __func__));
  if (widened != MPS_OK)
    mpm->grid.standard = false, mpm->grid.flip = 0.0;
  else
    mpm->def.flip_time = 0.0; /* not left open */
  return widened;
}
