/* elastic.c - the solver object: checks of the definition, creation, destruction.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "implicit/life/restart.h"
#include "implicit/motion/motion.h"
#include "implicit/base/implicit_solver.h"
#include "implicit/base/motion_state.h"
#include "implicit/life/elastic_body.h"
#include "implicit/life/change.h"

#include "core/particles/particles_internal.h"
#include "core/context/retain.h"
#include "material/material_internal.h"
#include "core/definition/digits.h"
#include "solver/linear.h"

#include <mps/experimental/papers.h>
#include <mps/experimental/domain.h>

#include <stdlib.h>
#include <string.h>

/* ---- definition ------------------------------------------------------------------------------ */

static mps_status read_def(mps_context *context, const char *function, const mps_elastic_def *user,
                           int32_t dim, double spacing, bool published, mps_elastic_def *def) {
  *def = mps_elastic_defaults();
  MPSI_TRY(MPSI_DEF_READ_OR_DEFAULTS(context, function, mps_elastic_def, user, def));
  if (def->kernel) def->radius_ratio = mps_kernel_radius(def->kernel) / spacing;
  if (def->kernel && !(def->radius_ratio > 1.0 && def->radius_ratio <= 4.0))
    return mpsi_fail(context, function, MPS_ERROR_ARGUMENT,
                     "the kernel's radius of influence is %s m, must be above the spacing %g m and "
                     "at most 4 times that",
                     mpsi_outside(mps_kernel_radius(def->kernel), spacing, 4.0 * spacing).text,
                     spacing);
  if (isnan(def->radius_ratio)) def->radius_ratio = published ? 3.0 : 1.5;
  if (isnan(def->memory_limit)) def->memory_limit = INFINITY;
  if (isnan(def->measure) || dim == 3) def->measure = 1.0;
  if (isnan(def->alpha)) def->alpha = mps_elastic_defaults().alpha;
  if (isnan(def->tolerance)) def->tolerance = mps_elastic_defaults().tolerance;
  if (published && dim == 3)
    return mpsi_fail(context, function, MPS_ERROR_UNSUPPORTED,
                     "the published method is two-dimensional: at surfaces in 3D a rigid rotation "
                     "would cause stress; use mps_elastic_create");
  return mpsi_domain_check(context, function, def->domain);
}

/* ---- life ------------------------------------------------------------------------------------ */

static void destroy(void *solver) {
  mps_elastic *e = solver;
  mpsi_elastic_end_motion(e);
  mpsi_elastic_drop_change(e);
  mpsi_elastic_free_body(e);
  mps_kernel_destroy(&e->def.kernel);
  mps_material_destroy(&e->def.material);
}

static void get_def(const void *solver, void *out) {
  *(mps_elastic_def *)out = ((const mps_elastic *)solver)->def;
}

static const mpsi_solver_kind elastic_kind = {
    .name = MPSI_SOLVER_NAMES("elastic"),
    .task = "elastic",
    .def_kind = MPS_DEF_ELASTIC,
    .get_def = get_def,
    .time = mpsi_elastic_time,
    .steps = mpsi_elastic_steps,
    .dt = mpsi_elastic_dt,
    .limit = mpsi_elastic_limit,
    .ready = mpsi_elastic_ready,
    .agree = mpsi_elastic_agree,
    .check_dt = mpsi_elastic_check_dt,
    .use_dt = mpsi_elastic_use_dt,
    .equation = MPS_LINEAR_EQUATION_STIFFNESS,
    .linear_ready = mpsi_elastic_linear_ready,
    .linear_changed = mpsi_elastic_linear_changed,
    .get_totals = mpsi_elastic_get_totals,
    .get_reaction = mpsi_elastic_get_reaction,
    .boundary = &mpsi_elastic_boundaries,
    .load = &mpsi_elastic_loads,
    .begin = mpsi_elastic_begin_march,
    .advance = mpsi_elastic_advance_march,
    .end = mpsi_elastic_end_march,
    .state = mpsi_elastic_state,
    .settle = mpsi_elastic_settle,
    .leave = mpsi_elastic_leave_state,
    .destroy = destroy,
};

mps_solver *mps_elastic_solver(const mps_elastic *e) { return e ? (mps_solver *)&e->base : NULL; }

static mps_status build(mps_elastic *e, const char *function) {
  MPSI_TRY(mpsi_elastic_allocate(e, function));
  if (e->def.material) MPSI_TRY(mpsi_elastic_add_material(e, function));
  memcpy(e->id, mpsi_particles_integers(e->particles, "id"), (size_t)e->n * sizeof *e->id);
  mpsi_elastic_sort_ids(e->n, e->id);
  mps_status status = mpsi_elastic_read(e, function, "position", e->x, e->dim);
  for (int64_t i = 0; i < e->n * e->dim && status == MPS_OK; i++)
    if (!isfinite(e->x[i]))
      status =
          mpsi_elastic_bad_value(e, function, "position", i / e->dim, e->x[i], "must be finite");
  if (status == MPS_OK) status = mpsi_elastic_make_body(e, function, false);
  status = mpsi_fail_of(e->context, status, "particles");
  if (status == MPS_OK)
    status =
        mpsi_as(e->context, function, mps_particles_add_field(e->particles, "displacement", 0));
  if (status == MPS_OK)
    status = mpsi_as(e->context, function, mps_particles_add_field(e->particles, "reaction", 0));
  return status;
}

/* The lattice is found once: the solver accepts no other positions. Moduli are read before the next
 * solution or step. */
static mps_status take_edit(void *self, const char *function, const char *field,
                            const double *former) {
  mps_elastic *e = self;
  bool same = true;
  for (int32_t c = 0; c < e->dim && strcmp(field, "position") == 0; c++) {
    const double *x = mpsi_particles_column(e->particles, "position", c);
    for (int64_t i = 0; i < e->n && same; i++)
      same = x[mps_particles_index(e->particles, e->id[i])] == e->x[i * e->dim + c];
  }
  if (strcmp(field, "young") == 0 || strcmp(field, "poisson") == 0) e->unread = true;
  if (same) return MPS_OK;
  return mpsi_fail(
      e->context, function, MPS_ERROR_STATE,
      "the particle set is held by a solver of implicit elasticity, which relies on the "
      "positions: write the former ones back, or destroy it first");
}

/* Do ranks that solve together have the same body and definition? */
static mps_status agree_on_body(const mps_elastic_def *def, const char *function, mps_status status,
                                mps_particles *particles) {
  mpsi_given given = MPSI_GIVEN;
  if (!mpsi_domain_many(def->domain)) return status;
  MPSI_GIVE_DEF(&given, mps_elastic_def, def);
  mpsi_give(&given, "the kind of the kernel", def->kernel ? mps_kernel_get_kind(def->kernel) : -1);
  if (status == MPS_OK) mpsi_material_give(&given, def->material);
  status = mpsi_domain_agree_given(def->domain, function, status, &given);
  return status == MPS_OK ? mpsi_domain_agree_particles(def->domain, function, status, particles)
                          : status;
}

static mps_status create(mps_context *context, const char *function, mps_particles *particles,
                         const mps_elastic_def *user_def, bool published, bool constant,
                         mps_elastic **out) {
  if (!context) return mpsi_null(function, "context");
  if (!out) return mpsi_fail(context, function, MPS_ERROR_ARGUMENT, "out is NULL");
  *out = NULL;
  MPSI_TRY(mpsi_particles_check_context(particles, context, function));
  if (mps_particles_count(particles) == 0)
    return mpsi_fail(context, function, MPS_ERROR_ARGUMENT, "particles is empty");
  mps_elastic_def def;
  mps_status status = read_def(context, function, user_def, mps_particles_dim(particles),
                               mps_particles_spacing(particles), published, &def);
  if (status == MPS_OK) status = mpsi_particles_check_hold(particles, function, MPSI_USE_FIX);
  if (status == MPS_OK) status = mpsi_particles_check_deal(particles, function, NULL);
  if (status == MPS_OK)
    status = mpsi_fail_of(context, mpsi_particles_check_crowding(particles, function, 0, NULL),
                          "particles");
  mpsi_backup backup = {0};
  mps_elastic *e = NULL;
  if (status == MPS_OK) status = mpsi_particles_back_up(particles, function, &backup);
  if (status == MPS_OK && !(e = mpsi_alloc(context, 1, sizeof *e)))
    status = mpsi_fail_memory(context, function, sizeof *e);
  status = agree_on_body(&def, function, status, particles);
  if (status != MPS_OK) {
    mpsi_backup_drop(particles, &backup);
    mpsi_free(context, e);
    return status;
  }
  const mpsi_holder holder = {.name = "a solver of implicit elasticity (mps_elastic)",
                              .kind = MPSI_USE_FIX,
                              .commit = take_edit,
                              .remove = mpsi_elastic_remove,
                              .renew = mpsi_elastic_renew};
  mpsi_solver_start(&e->base, function, &elastic_kind, context, particles, def.domain, &holder);
  e->def = def;
  if (def.kernel) e->def.kernel = mpsi_kernel_retain(def.kernel);
  if (def.material) e->def.material = mpsi_material_retain(def.material);
  e->conservative = !published;
  e->constant = constant;
  e->shared = e->conservative && mpsi_domain_many(def.domain); /* until it has another solver */
  e->dim = mps_particles_dim(particles);
  e->modes = e->dim == 2 ? 3 : 6;
  e->n = mps_particles_count(particles);
  e->spacing = mps_particles_spacing(particles);
  status = mpsi_domain_agree(def.domain, function, build(e, function));
  if (status != MPS_OK) {
    mpsi_particles_go_back(particles, &backup);
    mpsi_solver_end(&e->base);
    return status;
  }
  mpsi_backup_drop(particles, &backup);
  *out = e;
  return MPS_OK;
}

mps_status mps_elastic_create(mps_context *context, mps_particles *particles,
                              const mps_elastic_def *def, mps_elastic **out) {
  return create(context, __func__, particles, def, false, false, out);
}

mps_status mps_experimental_elastic_published(mps_context *context, mps_particles *particles,
                                              const mps_elastic_def *def, int32_t constant,
                                              mps_elastic **out) {
  return create(context, __func__, particles, def, true, constant != 0, out);
}
