/* pore_water.c - definition of the pore water of a solver (mps/experimental/pore_water.h): checks,
 * fields, faces, budget, report of the solution. SPDX-License-Identifier: BSD-3-Clause */
#include "mpm/base/mpm_solver.h"
#include "mpm/particles/mpm_particles.h"
#include "mpm/water/solve/coarse.h"
#include "mpm/water/water.h"

#include <string.h>

#define STIFF 50.0 /* K_w/n over the wave modulus at rest: settlements are 2 % too large */
#define SLOW 1e-3  /* m/s, permeability above which the inertia of the water matters */
#define LARGE 1e15 /* Pa */
#define REACH (MPSI_SIDE + 1) /* cells along an axis that particles of a block lie in */
#define CONTRAST 3.0          /* of permeabilities within a cell, above which a warning is logged */

/* ---- checks ---------------------------------------------------------------------------------- */

static const char add[] = "mps_mpm_add_pore_water";

static mps_status check_solver(mps_mpm *mpm) {
  MPSI_TRY(mpsi_mpm_usable(mpm, add));
  if (mpm->energy.counts)
    return mpsi_fail(mpm->context, add, MPS_ERROR_UNSUPPORTED,
                     "budget is 1: the energy budget has no terms for pore water, must be 0");
  if (mpm->water)
    return mpsi_fail(mpm->context, add, MPS_ERROR_STATE, "the solver has pore water already");
  if (mpm->run.steps > 0)
    return mpsi_fail(mpm->context, add, MPS_ERROR_STATE,
                     "the solver has taken %lld steps: water is added before the first",
                     (long long)mpm->run.steps);
  return MPS_OK;
}

/* ---- adding ---------------------------------------------------------------------------------- */

/* Adds the field, and sets it to `value` for all particles unless that is NaN. */
static mps_status fill(mps_context *context, const mpsi_columns *p, const char *field,
                       double value) {
  mps_status status = mpsi_as(context, add, mps_particles_add_field(p->set, field, 0));
  double *column = status == MPS_OK ? mpsi_particles_column(p->set, field, 0) : NULL;
  for (int64_t k = 0; column && !isnan(value) && k < p->count; k++) column[k] = value;
  return status;
}

/* Least bulk modulus K_w of the water for this rank's particles, from their moduli at rest. */
static mps_status find_bulk(mps_context *context, const mpsi_columns *p, double *least) {
  for (int64_t k = 0; k < p->count; k++) {
    double wave, shear;
    mpsi_mpm_elastic(p, k, &wave, &shear);
    if (!(wave > 0.0 && wave <= LARGE))
      return mpsi_fail(context, add, MPS_ERROR_ARGUMENT,
                       "bulk is NaN and the law of particle %lld has no modulus at rest: give K_w",
                       (long long)mpsi_particles_integers(p->set, "id")[k]);
    *least = fmax(*least, STIFF * wave * p->n[k]);
  }
  return MPS_OK;
}

/* New limit of the time step, and check of a given dt against it. */
static mps_status renew_limit(mps_mpm *mpm) {
  mpm->p.laws.one_modulus = false;
  mpsi_mpm_find_speeds(mpm);
  mps_status status = mpsi_mpm_collect_block_results(mpm, add);
  if (status != MPS_OK || isnan(mpm->def.dt) || mpm->def.dt <= mpsi_mpm_limit(mpm)) return status;
  return mpsi_fail(
      mpm->context, add, MPS_ERROR_ARGUMENT,
      "bulk is %g Pa: dt of the solver is %g s, above the limit with water, %g s: choose "
      "at most half of that, or NaN for a step that follows the limit",
      mpm->water->def.bulk, mpm->def.dt, mpsi_mpm_limit(mpm));
}

/* A layer without a permeability of the definition has that of the field. */
static bool has_layers(const mpsi_columns *p) {
  return mpsi_particles_column(p->set, "permeability", 0) != NULL;
}

static mps_status add_fields(mps_mpm *mpm, double *bulk) {
  const mps_pore_water_def *def = &mpm->water->def;
  mpm->water->flows = !isnan(def->permeability) || has_layers(&mpm->p);
  MPSI_TRY(fill(mpm->context, &mpm->p, "porosity", def->porosity));
  MPSI_TRY(fill(mpm->context, &mpm->p, "pore_pressure", NAN));
  MPSI_TRY(fill(mpm->context, &mpm->p, "pore_pressure_gradient", NAN));
  if (mpsi_pore_predicts(mpm)) MPSI_TRY(fill(mpm->context, &mpm->p, "pore_pressure_mean", NAN));
  if (mpm->water->flows) MPSI_TRY(fill(mpm->context, &mpm->p, "permeability", def->permeability));
  mpsi_mpm_bind(&mpm->grid, &mpm->p, mpm->water);
  if (!mpsi_pore_predicts(mpm) &&
      !mpsi_mpm_soak_room(mpm->context, &mpm->grid, &mpm->p, &mpm->rooms, &mpm->def))
    return mpsi_fail_memory(mpm->context, add, (size_t)mpm->p.count * 10 * sizeof(double));
  mps_status status = mpsi_pore_check(mpm->context, &mpm->p, mpm->water, add);
  return status == MPS_OK && isnan(def->bulk) ? find_bulk(mpm->context, &mpm->p, bulk) : status;
}

/* `status`: so far on this rank. Collective. */
static mps_status begin(mps_mpm *mpm, mps_status status) {
  double bulk = 0.0; /* of all particles */
  if (status == MPS_OK) status = add_fields(mpm, &bulk);
  if (mpm->partition) status = mpsi_domain_agree_max(mpm->domain, add, status, 1, &bulk);
  if (status != MPS_OK) return status;
  if (isnan(mpm->water->def.bulk)) mpm->water->def.bulk = bulk;
  mpm->p.K_w = mpm->water->def.bulk;
  return renew_limit(mpm);
}

static void warn(mps_context *context, const mpsi_columns *p) {
  double most = 0.0;
  for (int64_t k = 0; p->k && k < p->count; k++) most = fmax(most, p->k[k]);
  if (most > SLOW)
    mpsi_log(context, MPS_CONTEXT_LOG_WARNING,
             "permeability is up to %g m/s: above %g m/s the inertia of the water, which is left "
             "out, counts",
             most, SLOW);
}

static int64_t cell_of(const mpsi_grid *grid, const mpsi_columns *p, int c, int64_t k) {
  return mpsi_own_cell(grid, c, mpsi_grid_at(grid, c, p->x[c][k]));
}

/* Largest ratio of the permeabilities of two particles in one cell of a block, and a place in that
 * cell (m) if it is above `most`. */
static double contrast(const mpsi_grid *grid, const mpsi_columns *p, const mpsi_cell_block *cells,
                       double most, double *place) {
  double low[REACH * REACH * REACH], high[REACH * REACH * REACH] = {0.0};
  int64_t first[3] = {INT64_MAX, INT64_MAX, INT64_MAX};
  for (int64_t k = cells->begin; k < cells->end; k++)
    for (int c = 0; c < grid->dim; c++)
      first[c] = cell_of(grid, p, c, k) < first[c] ? cell_of(grid, p, c, k) : first[c];
  for (int64_t k = cells->begin; k < cells->end; k++) {
    int64_t at = 0, farthest = 0;
    for (int c = 0; c < grid->dim; c++) {
      const int64_t i = cell_of(grid, p, c, k) - first[c];
      farthest = i > farthest ? i : farthest;
      at = REACH * at + i;
    }
    if (farthest >= REACH) continue;
    low[at] = high[at] > 0.0 ? fmin(low[at], p->k[k]) : p->k[k];
    high[at] = fmax(high[at], p->k[k]);
    if (high[at] <= most * low[at]) continue;
    most = high[at] / low[at];
    for (int c = 0; c < grid->dim; c++) place[c] = p->x[c][k];
  }
  return most;
}

/* A cell has one permeability, the mean of its particles: that along layers which share it. Across
 * them it is too high, and a seam of clay in cells of sand holds no water. */
static void warn_of_contrast(mps_context *context, const mpsi_grid *grid, const mpsi_columns *p) {
  double most = CONTRAST, place[3] = {0.0};
  for (int64_t b = 0; p->k && b < grid->cell_count; b++)
    most = contrast(grid, p, &grid->cells[b], most, place);
  if (most > CONTRAST)
    mpsi_log(context, MPS_CONTEXT_LOG_WARNING,
             "permeability differs by %g times within a cell, at (%g, %g, %g) m: a cell has the "
             "mean of its particles, so that layers that end within cells leak, and thinner ones "
             "do not hold water at all; let layers end at faces of cells",
             most, place[0], place[1], place[2]);
}

/* Copies of the columns that `fill` writes, to restore after an error. */
typedef struct kept {
  double *values;
  double speed;
  bool one_modulus;
  int32_t fields;
} kept;

static double *written(const mpsi_columns *p, int number) {
  static const char *const names[] = {"porosity", "permeability"};
  return mpsi_particles_column(p->set, names[number], 0);
}

static mps_status keep(mps_context *context, const mpsi_columns *p, const mpsi_run *run,
                       kept *out) {
  *out = (kept){.speed = run->speed,
                .one_modulus = p->laws.one_modulus,
                .fields = mps_particles_field_count(p->set)};
  out->values = mpsi_alloc(context, 2 * p->count, sizeof *out->values);
  if (!out->values)
    return mpsi_fail_memory(context, add, 2 * (size_t)p->count * sizeof *out->values);
  for (int f = 0; f < 2; f++)
    if (written(p, f))
      memcpy(out->values + f * p->count, written(p, f), (size_t)p->count * sizeof(double));
  return MPS_OK;
}

static void restore(mps_mpm *mpm, const kept *before) {
  mpsi_pore_free(mpm);
  mpsi_particles_drop_fields(mpm->p.set, before->fields);
  mpm->run.speed = before->speed, mpm->run.wave = 0.0;
  mpm->p.laws.one_modulus = before->one_modulus;
  for (int f = 0; f < 2; f++)
    if (written(&mpm->p, f))
      memcpy(written(&mpm->p, f), before->values + f * mpm->p.count,
             (size_t)mpm->p.count * sizeof(double));
  mpsi_mpm_bind(&mpm->grid, &mpm->p, mpm->water);
}

/* All ranks give the same. */
static mps_status agree_on_water(mps_mpm *mpm, mps_status status, const mps_pore_water_def *def) {
  mpsi_given given = MPSI_GIVEN;
  if (!mpm->partition) return status;
  MPSI_GIVE_DEF(&given, mps_pore_water_def, def);
  mpsi_give(&given, "having a field 'permeability'", has_layers(&mpm->p));
  return mpsi_domain_agree_given(mpm->domain, add, status, &given);
}

mps_status mps_mpm_add_pore_water(mps_mpm *mpm, const mps_pore_water_def *user_def) {
  if (!mpm) return mpsi_null(__func__, "mpm");
  mps_pore_water_def def = mps_pore_water_defaults();
  mps_status status = check_solver(mpm);
  if (status == MPS_OK)
    status = MPSI_DEF_READ_OR_DEFAULTS(mpm->context, __func__, mps_pore_water_def, user_def, &def);
  MPSI_TRY(agree_on_water(mpm, status, &def));
  MPSI_TRY(mpsi_mpm_ready(mpm, __func__));
  kept before;
  status = keep(mpm->context, &mpm->p, &mpm->run, &before);
  mpm->water = status == MPS_OK ? mpsi_alloc(mpm->context, 1, sizeof *mpm->water) : NULL;
  if (status == MPS_OK && !mpm->water)
    status = mpsi_fail_memory(mpm->context, __func__, sizeof *mpm->water);
  if (mpm->water) mpm->water->def = def;
  const bool kept_values = before.values != NULL;
  status = begin(mpm, status);
  if (status == MPS_OK) {
    if (!mpsi_pore_predicts(mpm)) mpsi_mpm_soak_laws(&mpm->p, &mpm->def);
    warn(mpm->context, &mpm->p);
    warn_of_contrast(mpm->context, &mpm->grid, &mpm->p);
    mpm->boundaries.renew = true;    /* dashpots */
    mpm->boundaries.outdated = true; /* lists: frictional sides have sums with water */
  } else if (kept_values) {
    restore(mpm, &before);
  }
  mpsi_free(mpm->context, before.values);
  return status;
}

/* ---- queries --------------------------------------------------------------------------------- */

static mps_status check_water(mps_context *context, mpsi_water *water, const char *function) {
  if (water) return MPS_OK;
  return mpsi_fail(context, function, MPS_ERROR_STATE,
                   "the solver has no pore water: mps_mpm_add_pore_water adds it");
}

mps_status mps_mpm_get_pore_water_sized(const mps_mpm *mpm, mps_pore_water_def *out, size_t size) {
  if (!mpm) return mpsi_null(__func__, "mpm");
  MPSI_TRY(check_water(mpm->context, mpm->water, __func__));
  return mpsi_def_write(mpm->context, "mps_mpm_get_pore_water", out, size, &mpm->water->def,
                        sizeof mpm->water->def);
}

/* Sums of all ranks, where all are well. */
static mps_status sum_ranks(const mps_mpm *mpm, const char *function, mps_status status,
                            int32_t count, mpsi_exact *sum) {
  if (!mpm->partition) return status;
  status = mpsi_domain_agree(mpm->domain, function, status);
  return status == MPS_OK ? mpsi_domain_sum_exact(mpm->domain, function, count, sum) : status;
}

mps_status mps_mpm_get_pore_budget_sized(const mps_mpm *mpm, mps_pore_budget *out, size_t size) {
  if (!mpm) return mpsi_null(__func__, "mpm");
  enum { MASS, START, DRAINED, ENTERED, SUMS };
  mpsi_exact sum[SUMS] = {{{0}}};
  mps_status status = check_water(mpm->context, mpm->water, __func__);
  if (status == MPS_OK) {
    mpsi_pore_mass(&mpm->p, mpm->water, &sum[MASS]);
    sum[START] = mpm->run.steps == 0 ? sum[MASS] : mpm->water->start;
    for (int f = 0; f < MPSI_PORE_FACES; f++)
      mpsi_exact_merge(&sum[DRAINED], &mpm->water->drained[f]);
    sum[ENTERED] = mpm->water->entered;
  }
  status = sum_ranks(mpm, "mps_mpm_get_pore_budget", status, SUMS, sum);
  if (status != MPS_OK) return status;
  mps_pore_budget budget = {.mass = mpsi_exact_value(&sum[MASS]),
                            .start = mpsi_exact_value(&sum[START]),
                            .drained = mpsi_exact_value(&sum[DRAINED]),
                            .entered = mpsi_exact_value(&sum[ENTERED])};
  budget.residual = budget.start - budget.mass - budget.drained;
  budget.left = budget.drained + budget.entered;
  return mpsi_out_write(mpm->context, "mps_mpm_get_pore_budget", out, size, &budget, sizeof budget);
}

mps_status mps_mpm_get_pore_flow(const mps_mpm *mpm, int32_t number, double *rate, double *mass) {
  if (!mpm) return mpsi_null(__func__, "mpm");
  mpsi_exact sum[2] = {{{0}}};
  mps_status status = check_water(mpm->context, mpm->water, __func__);
  if (status == MPS_OK && (number < -1 || number >= mpm->water->face_count))
    status = mpsi_fail(mpm->context, __func__, MPS_ERROR_ARGUMENT,
                       "number is %d: there is no pore face of this number, and the free surface "
                       "is -1",
                       number);
  if (mpm->partition)
    status = mpsi_domain_agree_same(mpm->domain, __func__, status, "number", number);
  const int at = number < 0 ? MPS_PORE_MAX_FACES : number;
  if (status == MPS_OK) sum[0] = mpm->water->rate[at], sum[1] = mpm->water->drained[at];
  MPSI_TRY(sum_ranks(mpm, __func__, status, 2, sum));
  if (rate) *rate = mpsi_exact_value(&sum[0]);
  if (mass) *mass = mpsi_exact_value(&sum[1]);
  return MPS_OK;
}

/* ---- changes --------------------------------------------------------------------------------- */

static mps_status check_level(mps_mpm *mpm, const char *function, const double *point) {
  MPSI_TRY(mpsi_mpm_usable(mpm, function));
  MPSI_TRY(check_water(mpm->context, mpm->water, function));
  if (!point) return mpsi_fail(mpm->context, function, MPS_ERROR_ARGUMENT, "point is NULL");
  double square = 0.0;
  for (int c = 0; c < mpm->grid.dim; c++) {
    if (!isfinite(point[c]))
      return mpsi_fail(mpm->context, function, MPS_ERROR_ARGUMENT,
                       "point[%d] is %g m, must be finite", c, point[c]);
    square += mpm->def.gravity[c] * mpm->def.gravity[c];
  }
  if (square == 0.0)
    return mpsi_fail(
        mpm->context, function, MPS_ERROR_ARGUMENT,
        "point gives a level without gravity: that of the solver is 0, must be above 0");
  return MPS_OK;
}

mps_status mps_mpm_set_pore_level(mps_mpm *mpm, const double *point) {
  if (!mpm) return mpsi_null(__func__, "mpm");
  mps_status status = check_level(mpm, __func__, point);
  if (mpm->partition) {
    mpsi_given given = MPSI_GIVEN;
    if (status == MPS_OK) mpsi_give_vector(&given, "point", mpm->grid.dim, point);
    status = mpsi_domain_agree_given(mpm->domain, __func__, status, &given);
  }
  if (status != MPS_OK) return status;
  const mpsi_columns *p = &mpm->p;
  for (int64_t k = 0; k < p->count; k++) {
    double u = 0.0;
    for (int c = 0; c < mpm->grid.dim; c++)
      u += mpm->water->def.density * mpm->def.gravity[c] * (p->x[c][k] - point[c]);
    p->u[k] = fmax(0.0, u);
    for (int c = 0; c < mpm->grid.dim; c++)
      p->g[c][k] = u > 0.0 ? mpm->water->def.density * mpm->def.gravity[c] : 0.0;
  }
  mpsi_pore_begin_means(p);
  return MPS_OK;
}

/* All ranks give the same. */
static mps_status agree_on_face(const mps_mpm *mpm, const char *function, mps_status status,
                                const mps_pore_face_def *def, int32_t number) {
  mpsi_given given = MPSI_GIVEN;
  if (!mpm->partition) return status;
  mpsi_give(&given, "number", number);
  MPSI_GIVE_DEF(&given, mps_pore_face_def, def);
  return mpsi_domain_agree_given(mpm->domain, function, status, &given);
}

static mps_status read_face(mps_context *context, const mpsi_grid *grid, mpsi_water *water,
                            mpsi_run *run, const char *function, const mps_pore_face_def *user_def,
                            mps_pore_face_def *def) {
  *def = mps_pore_face_defaults();
  MPSI_TRY(mpsi_mpm_between_steps(context, run, function));
  MPSI_TRY(check_water(context, water, function));
  return MPSI_DEF_READ_IN(context, function, mps_pore_face_def, user_def, mpsi_scene_of(grid->dim),
                          def);
}

/* As where the permeability was forgotten. */
static void warn_of_face(const mps_mpm *mpm, const mps_pore_face_def *def) {
  if (def->kind == MPS_PORE_FACE_DRAINED && !mpm->water->flows)
    mpsi_log(
        mpm->context, MPS_CONTEXT_LOG_WARNING,
        "no water passes a drained face of undrained ground: it has neither the member nor the "
        "field 'permeability'");
}

mps_status mps_mpm_add_pore_face(mps_mpm *mpm, const mps_pore_face_def *user_def, int32_t *number) {
  if (!mpm) return mpsi_null(__func__, "mpm");
  mps_pore_face_def def;
  mps_status status =
      read_face(mpm->context, &mpm->grid, mpm->water, &mpm->run, __func__, user_def, &def);
  if (status == MPS_OK && mpm->water->face_count == MPS_PORE_MAX_FACES)
    status =
        mpsi_fail(mpm->context, __func__, MPS_ERROR_ARGUMENT,
                  "the solver has %d pore faces, the most that are allowed", MPS_PORE_MAX_FACES);
  MPSI_TRY(agree_on_face(mpm, __func__, status, &def, -1));
  if (number) *number = (int32_t)mpm->water->face_count;
  mpm->water->face[mpm->water->face_count++] = def;
  warn_of_face(mpm, &def);
  return MPS_OK;
}

mps_status mps_mpm_set_pore_face(mps_mpm *mpm, int32_t number, const mps_pore_face_def *user_def) {
  if (!mpm) return mpsi_null(__func__, "mpm");
  mps_pore_face_def def;
  mps_status status =
      read_face(mpm->context, &mpm->grid, mpm->water, &mpm->run, __func__, user_def, &def);
  if (status == MPS_OK && (number < 0 || number >= mpm->water->face_count))
    status = mpsi_fail(mpm->context, __func__, MPS_ERROR_ARGUMENT,
                       "number is %d: there is no pore face of this number", number);
  MPSI_TRY(agree_on_face(mpm, __func__, status, &def, number));
  const bool drained = mpm->water->face[number].kind == MPS_PORE_FACE_DRAINED;
  mpm->water->face[number] = def;
  if (!drained) warn_of_face(mpm, &def); /* once, whatever its pressure does from step to step */
  return MPS_OK;
}

mps_status mps_mpm_get_pore_report_sized(const mps_mpm *mpm, mps_pore_report *out, size_t size) {
  if (!mpm) return mpsi_null(__func__, "mpm");
  mps_pore_report report = {0};
  if (!mpm->water)
    return mpsi_fail(mpm->context, "mps_mpm_get_pore_report", MPS_ERROR_STATE,
                     "the solver has no pore water");
  const mpsi_pore_system *s = mpm->water->system;
  if (s && s->coarse && mpm->water->def.scheme == MPS_PORE_SCHEME_IMPLICIT) {
    report.unknowns = s->unknowns;
    report.coarse = s->coarse->used ? s->coarse->matrix.rows : 0;
    report.iterations = s->iterations;
  }
  return mpsi_out_write(mpm->context, "mps_mpm_get_pore_report", out, size, &report, sizeof report);
}
