/* elastic.c - the solver object: checks of the definition, creation, destruction.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "implicit/base/defs.h"
#include "implicit/base/implicit_solver.h"
#include "implicit/base/motion_state.h"
#include "implicit/life/elastic_body.h"
#include "implicit/life/change.h"

#include "core/particles/particles_internal.h"
#include "core/context/retain.h"
#include "material/material_internal.h"
#include "core/base/digits.h"

#include <mps/experimental.h>

#include <stdlib.h>
#include <string.h>

/* ---- definition ------------------------------------------------------------------------------ */

static mps_status check_choice(mps_context *context, const char *function, const char *name,
                               int32_t value, int32_t low, int32_t high) {
  if (value >= low && value <= high) return MPS_OK;
  return mpsi_fail(context, function, MPS_ERROR_ARGUMENT, "%s is %d, allowed are %d..%d", name,
                   value, low, high);
}

/* NaN is an error, too. */
static mps_status check_range(mps_context *context, const char *function, const char *name,
                              double value, double low, double high) {
  if (value >= low && value <= high) return MPS_OK;
  return mpsi_fail(context, function, MPS_ERROR_ARGUMENT, "%s is %s, allowed is %g to %g", name,
                   mpsi_outside(value, low, high).text, low, high);
}

static mps_status check_numbers(mps_context *context, const char *function,
                                const mps_elastic_def *def) {
  mps_status status = MPS_OK;
  if (!(def->radius_ratio > 1.0 && def->radius_ratio <= 4.0))
    return mpsi_fail(context, function, MPS_ERROR_ARGUMENT,
                     "radius_ratio is %s, must be above 1 and at most 4 (NaN: default)",
                     mpsi_outside(def->radius_ratio, 1.0, 4.0).text);
  if (!(def->memory_limit >= 0.0))
    return mpsi_fail(context, function, MPS_ERROR_ARGUMENT,
                     "memory_limit is %g bytes, must be >= 0 (NaN: none)", def->memory_limit);
  if (def->iterations < 0)
    return mpsi_fail(context, function, MPS_ERROR_ARGUMENT,
                     "iterations is %lld, must be >= 0 (0: default)", (long long)def->iterations);
  status = check_range(context, function, "measure", def->measure, MPSI_ELASTIC_LEAST,
                       MPSI_ELASTIC_MOST);
  if (status == MPS_OK) status = mpsi_domain_check(context, function, def->domain);
  if (status == MPS_OK) status = check_range(context, function, "alpha", def->alpha, 0.03, 100.0);
  if (status == MPS_OK && !isnan(def->bending))
    status = check_range(context, function, "bending", def->bending, 0.0, 1.0);
  if (status == MPS_OK)
    status = check_range(context, function, "tolerance", def->tolerance, 1e-14, 1e-2);
  return status;
}

static mps_status read_def(mps_context *context, const char *function, const mps_elastic_def *user,
                           int32_t dim, double spacing, bool published, mps_elastic_def *def) {
  *def = mpsi_elastic_defaults;
  mps_status status = MPS_OK;
  if (user) status = MPSI_DEF_READ(context, function, mps_elastic_def, user, def);
  const struct {
    const char *name;
    int32_t value, low, high;
  } choices[] = {
      {"state", def->state, MPS_ELASTIC_STATE_PLANE_STRESS, MPS_ELASTIC_STATE_PLANE_STRAIN},
      {"solver", def->solver, MPS_ELASTIC_SOLVER_AUTO, MPS_ELASTIC_SOLVER_CG},
      {"ordering", def->ordering, MPS_ELASTIC_ORDERING_BEST, MPS_ELASTIC_ORDERING_METIS},
      {"refinements", def->refinements, 0, 10},
      {"blas_threads", def->blas_threads, 0, 1024},
  };
  for (size_t k = 0; k < sizeof choices / sizeof *choices && status == MPS_OK; k++)
    status = check_choice(context, function, choices[k].name, choices[k].value, choices[k].low,
                          choices[k].high);
  if (status != MPS_OK) return status;
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
  if (isnan(def->alpha)) def->alpha = mpsi_elastic_defaults.alpha;
  if (isnan(def->tolerance)) def->tolerance = mpsi_elastic_defaults.tolerance;
  if (published && dim == 3)
    return mpsi_fail(context, function, MPS_ERROR_UNSUPPORTED,
                     "the published method is two-dimensional: at surfaces in 3D a rigid rotation "
                     "would cause stress; use mps_elastic_create");
  return check_numbers(context, function, def);
}

/* ---- life ------------------------------------------------------------------------------------ */

void mps_elastic_destroy(mps_elastic **elastic) {
  if (!elastic || !*elastic) return;
  mps_elastic *e = *elastic;
  mps_context *context = e->context;
  /* within a callback: the running function still needs it */
  if (mpsi_guard_check(&e->guard, context, __func__) != MPS_OK) return;
  *elastic = NULL;
  mpsi_elastic_end_motion(e);
  mpsi_elastic_drop_change(e);
  mpsi_elastic_drop_boundaries(e);
  mpsi_state_forget(&e->identity);
  mpsi_elastic_drop_loads(e);
  mpsi_elastic_drop_outside(e);
  mpsi_elastic_free_body(e);
  mps_kernel_destroy(&e->def.kernel);
  mps_material_destroy(&e->def.material);
  mps_domain_destroy(&e->def.domain);
  mpsi_particles_release(e->particles, &e->holder);
  mpsi_free(context, e);
  mpsi_context_release(context);
}

static mps_status build(mps_elastic *e, const char *function) {
  mps_status status = mpsi_elastic_allocate(e, function);
  if (status == MPS_OK && e->def.material) status = mpsi_elastic_add_material(e, function);
  if (status != MPS_OK) return status;
  memcpy(e->id, mpsi_particles_integers(e->particles, "id"), (size_t)e->n * sizeof *e->id);
  mpsi_elastic_sort_ids(e->n, e->id);
  status = mpsi_elastic_read(e, function, "position", e->x, e->dim);
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

/* The lattice is found once: the solver accepts no other positions. */
static mps_status refuse_positions(void *self, const char *function, const char *field,
                                   const double *former) {
  mps_elastic *e = self;
  bool same = true;
  (void)former;
  for (int32_t c = 0; c < e->dim && strcmp(field, "position") == 0; c++) {
    const double *x = mpsi_particles_column(e->particles, "position", c);
    for (int64_t i = 0; i < e->n && same; i++)
      same = x[mps_particles_index(e->particles, e->id[i])] == e->x[i * e->dim + c];
  }
  if (same) return MPS_OK;
  return mpsi_fail(
      e->context, function, MPS_ERROR_STATE,
      "the particle set is held by a solver of implicit elasticity, which relies on the "
      "positions: write the former ones back, or destroy it first");
}

/* Do ranks that solve together have the same body and definition? */
static mps_status agree_on_body(const mps_elastic_def *def, const char *function, mps_status status,
                                mps_particles *particles) {
  mpsi_given given;
  if (!mpsi_domain_many(def->domain)) return status;
  mpsi_given_begin(&given);
  MPSI_GIVE(&given, def, state);
  MPSI_GIVE(&given, def, solver);
  MPSI_GIVE(&given, def, radius_ratio);
  MPSI_GIVE(&given, def, alpha);
  MPSI_GIVE(&given, def, measure);
  MPSI_GIVE(&given, def, tolerance);
  MPSI_GIVE(&given, def, bending);
  MPSI_GIVE(&given, def, refinements);
  mpsi_give(&given, "the kind of the kernel", def->kernel ? mps_kernel_get_kind(def->kernel) : -1);
  if (status == MPS_OK) mpsi_material_give(&given, def->material);
  status = mpsi_domain_agree_given(def->domain, function, status, &given);
  return status == MPS_OK ? mpsi_domain_agree_particles(def->domain, function, status, particles)
                          : status;
}

static mps_status create(mps_context *context, const char *function, mps_particles *particles,
                         const mps_elastic_def *user_def, bool published, bool constant,
                         mps_elastic **out) {
  if (!context) return MPS_ERROR_ARGUMENT;
  if (!out) return mpsi_fail(context, function, MPS_ERROR_ARGUMENT, "out is NULL");
  *out = NULL;
  mps_status status = mpsi_particles_check_context(particles, context, function);
  if (status == MPS_OK && mps_particles_count(particles) == 0)
    status = mpsi_fail(context, function, MPS_ERROR_ARGUMENT, "particles is empty");
  if (status != MPS_OK) return status;
  mps_elastic_def def;
  status = read_def(context, function, user_def, mps_particles_dim(particles),
                    mps_particles_spacing(particles), published, &def);
  if (status == MPS_OK) status = mpsi_particles_check_hold(particles, function, MPSI_USE_FIX);
  if (status == MPS_OK) status = mpsi_particles_check_deal(particles, function, NULL);
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
  e->context = mpsi_context_retain(context);
  e->particles = particles;
  e->holder = (mpsi_holder){.name = "a solver of implicit elasticity (mps_elastic)",
                            .self = e,
                            .kind = MPSI_USE_FIX,
                            .guard = &e->guard,
                            .commit = refuse_positions,
                            .remove = mpsi_elastic_remove,
                            .renew = mpsi_elastic_renew};
  (void)mpsi_particles_hold(particles, function, &e->holder); /* checked above */
  e->def = def;
  if (def.kernel) e->def.kernel = mpsi_kernel_retain(def.kernel);
  if (def.material) e->def.material = mpsi_material_retain(def.material);
  e->def.domain = mpsi_domain_retain(def.domain);
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
    mps_elastic_destroy(&e);
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

mps_status mps_elastic_get_def_sized(const mps_elastic *e, mps_elastic_def *out, size_t size) {
  if (!e) return MPS_ERROR_ARGUMENT;
  return mpsi_def_write(e->context, "mps_elastic_get_def", out, size, &e->def, sizeof e->def);
}

mps_particles *mps_elastic_particles(const mps_elastic *e) { return e ? e->particles : NULL; }
mps_context *mps_elastic_context(const mps_elastic *e) { return e ? e->context : NULL; }
