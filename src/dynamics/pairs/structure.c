/* structure.c - structure of a set of particles: order, pairs, mesh, arrays of the solver. Made at
 * creation and after a removal of particles.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "core/particles/particles_internal.h"
#include "structure.h"
#include "dynamics/base/dynamics_solver.h"
#include "batch.h"

#include <float.h>
#include <string.h>

/* ---- fields ---------------------------------------------------------------------------------- */

/* Computes the reference position from position and displacement, but keeps one that differs by
 * round-off alone: a second solver on a set has the pairs of the first. */
static void set_reference(mps_dynamics *dynamics) {
  const int64_t count = mps_particles_count(dynamics->particles);
  const double spacing = mps_particles_spacing(dynamics->particles);
  for (int32_t c = 0; c < 2; c++) {
    const double *x = mpsi_dynamics_column(dynamics, "position", c);
    const double *d = mpsi_dynamics_column(dynamics, "displacement", c);
    double *r = mpsi_dynamics_column(dynamics, "reference", c);
    for (int64_t k = 0; k < count; k++) {
      const double round_off = 1e-9 * spacing + 4.0 * DBL_EPSILON * (fabs(x[k]) + fabs(d[k]));
      if (!(fabs(x[k] - d[k] - r[k]) <= round_off)) r[k] = x[k] - d[k];
    }
  }
}

mps_status mpsi_dynamics_add_reference(mps_dynamics *dynamics, const char *function) {
  mps_context *context = dynamics->context;
  mps_status status =
      mpsi_as(context, function, mps_particles_add_field(dynamics->particles, "displacement", 0));
  if (status == MPS_OK)
    status =
        mpsi_as(context, function, mps_particles_add_field(dynamics->particles, "reference", 0));
  if (status == MPS_OK) set_reference(dynamics);
  return status;
}

mps_status mpsi_dynamics_add_fields(mps_dynamics *dynamics, const char *function) {
  static const char *const names[] = {
      "displacement", "rotation",         "velocity",     "spin",          "acceleration",
      "pressure",     "displacement_old", "rotation_old", "restoring_old", "reference"};
  mps_status status = MPS_OK;
  for (size_t k = 0; status == MPS_OK && k < sizeof names / sizeof *names; k++)
    status = mpsi_as(dynamics->context, function,
                     mps_particles_add_field(dynamics->particles, names[k], 0));
  if (status == MPS_OK) set_reference(dynamics);
  return status;
}

void mpsi_dynamics_bind(mps_dynamics *dynamics) {
  mpsi_dynamics_state *s = &dynamics->state;
  const struct {
    double **to;
    const char *name;
    int component;
  } bind[] = {{&s->rx, "reference", 0},
              {&s->ry, "reference", 1},
              {&s->dx, "displacement", 0},
              {&s->dy, "displacement", 1},
              {&s->th, "rotation", 0},
              {&s->ox, "displacement_old", 0},
              {&s->oy, "displacement_old", 1},
              {&s->oth, "rotation_old", 0},
              {&s->vx, "velocity", 0},
              {&s->vy, "velocity", 1},
              {&s->vth, "spin", 0},
              {&s->hx, "restoring_old", 0},
              {&s->hy, "restoring_old", 1},
              {&s->hth, "restoring_old", 2},
              {&s->ax, "acceleration", 0},
              {&s->ay, "acceleration", 1},
              {&s->p, "pressure", 0}};
  for (size_t k = 0; k < sizeof bind / sizeof *bind; k++)
    *bind[k].to = mpsi_dynamics_column(dynamics, bind[k].name, bind[k].component);
}

/* ---- order ----------------------------------------------------------------------------------- */

mpsi_dynamics_geometry mpsi_dynamics_geometry_of(const mps_dynamics *dynamics, int64_t count,
                                                 const double *x, const double *y,
                                                 const int64_t *side) {
  return (mpsi_dynamics_geometry){.count = count,
                                  .x = x,
                                  .y = y,
                                  .side = side,
                                  .spacing = mps_particles_spacing(dynamics->particles),
                                  .radius = dynamics->radius,
                                  .period_x =
                                      isnan(dynamics->def.period_x) ? 0.0 : dynamics->def.period_x};
}

/* The particles as they are in the set. */
mpsi_dynamics_geometry mpsi_dynamics_present_geometry(const mps_dynamics *dynamics) {
  mps_particles *p = dynamics->particles;
  return mpsi_dynamics_geometry_of(
      dynamics, mps_particles_count(p), mpsi_particles_column(p, "reference", 0),
      mpsi_particles_column(p, "reference", 1), mpsi_particles_integers(p, "free_field"));
}

mps_status mpsi_dynamics_sort(mps_dynamics *dynamics, const char *function) {
  mps_context *context = dynamics->context;
  const mpsi_dynamics_geometry g = mpsi_dynamics_present_geometry(dynamics);
  int64_t *order = mpsi_alloc(context, g.count, sizeof *order);
  mps_status status = MPS_OK;
  if (!order || !mpsi_dynamics_layout_order(context, &g, order))
    status = mpsi_fail_memory(context, function, (size_t)g.count * sizeof *order);
  if (status == MPS_OK) status = mpsi_particles_permute(dynamics->particles, function, order);
  mpsi_free(context, order);
  return status;
}

/* ---- pairs, mesh, arrays --------------------------------------------------------------------- */

static mps_status make_mesh(mps_dynamics *dynamics, const char *function,
                            const mpsi_dynamics_geometry *g, mpsi_dynamics_structure *out) {
  mps_context *context = dynamics->context;
  const mpsi_dynamics_mesh_def def = {.kernel = dynamics->kernel,
                                      .density = dynamics->density,
                                      .particles = g->count,
                                      .body = out->body};
  double edge[2] = {INFINITY, -INFINITY};
  for (int64_t k = 0; k < out->body; k++)
    edge[0] = fmin(edge[0], g->x[k]), edge[1] = fmax(edge[1], g->x[k]);
  mpsi_dynamics_source source = {
      .context = context, .function = function, .g = *g, .nears = g->count, .body = out->body};
  source.g.edge = edge;
  mps_status status = mpsi_dynamics_source_open(&source);
  if (status == MPS_OK)
    status =
        mpsi_dynamics_mesh_build(context, &out->mesh, &def, &source, &out->pairs, &out->lattice);
  mpsi_dynamics_source_close(&source);
  return status;
}

/* The arrays that are not fields, from one slab; starts staggered so that they do not alias in the
 * first-level cache. */
mps_status mpsi_dynamics_allocate(mps_dynamics *dynamics, const char *function,
                                  mpsi_dynamics_structure *out) {
  mps_context *context = dynamics->context;
  const int64_t workers = mps_context_threads(context);
  const int64_t n = (out->count + out->ghosts + 7) / 8 * 8, stride = n + 24;
  const int64_t slots = (out->mesh.slots + 7) / 8 * 8 + 40;
  const int64_t doubles = MPSI_DYN_SLAB_COLUMNS * stride + 2 * slots;
  out->stride = stride, out->slots = slots;
  out->slab = mpsi_alloc(context, doubles, sizeof(double));
  out->scratch = mpsi_alloc(context, workers * MPSI_DYN_SCRATCH, sizeof(double));
  out->bad = mpsi_alloc(context, out->mesh.blocks, sizeof(int32_t));
  out->part = mpsi_alloc(context, 2 * out->mesh.blocks, sizeof(double));
  if (out->slab && out->scratch && out->bad && out->part) return MPS_OK;
  return mpsi_fail_memory(context, function, (size_t)doubles * sizeof(double));
}

/* Dashpots between each free-field column and the edge of the body beside it. */
static mps_status couple_columns(mps_dynamics *dynamics, const char *function,
                                 const mpsi_dynamics_geometry *g, mpsi_dynamics_structure *out) {
  const int64_t columns = out->count - out->body;
  if (columns == 0) return MPS_OK;
  mps_context *context = dynamics->context;
  int64_t *edge = mpsi_alloc(context, out->count, sizeof *edge);
  out->column_dashpot = mpsi_alloc(context, 2 * columns, sizeof *out->column_dashpot);
  mps_status status = MPS_OK;
  if (!edge || !out->column_dashpot)
    status = mpsi_fail_memory(context, function, (size_t)out->count * sizeof *edge);
  if (status == MPS_OK) status = mpsi_dynamics_layout_edges(context, function, g, edge);
  for (int64_t k = out->body; status == MPS_OK && k < out->count; k++)
    for (int c = 0; c < 2 && edge[k] >= 0; c++)
      out->column_dashpot[out->column_dashpots++] = (mpsi_dynamics_dashpot){
          .particle = (int32_t)edge[k], .component = c, .boundary = -1, .partner = (int32_t)k};
  mpsi_free(context, edge);
  return status;
}

mps_status mpsi_dynamics_make_structure(mps_dynamics *dynamics, const char *function,
                                        const mpsi_dynamics_geometry *geometry,
                                        mpsi_dynamics_structure *out) {
  const mpsi_dynamics_geometry g = geometry ? *geometry : mpsi_dynamics_present_geometry(dynamics);
  *out = (mpsi_dynamics_structure){.count = g.count};
  while (out->body < g.count && !(g.side && g.side[out->body])) out->body++;
  mps_status status = make_mesh(dynamics, function, &g, out);
  if (status == MPS_OK) status = mpsi_dynamics_allocate(dynamics, function, out);
  if (status == MPS_OK) status = couple_columns(dynamics, function, &g, out);
  if (status != MPS_OK) mpsi_dynamics_free_structure(dynamics, out);
  return status;
}

void mpsi_dynamics_free_structure(mps_dynamics *dynamics, mpsi_dynamics_structure *s) {
  mpsi_dynamics_mesh_free(dynamics->context, &s->mesh);
  mpsi_halo_destroy(dynamics->context, &s->halo);
  MPSI_FREE(dynamics->context, s->slab, s->scratch, s->bad, s->part, s->column_dashpot);
  *s = (mpsi_dynamics_structure){0};
}

int64_t mpsi_dynamics_hash_positions(int64_t count, const double *x, const double *y) {
  const double *const column[2] = {x, y};
  uint64_t hash = 0xcbf29ce484222325u;
  for (int c = 0; c < 2; c++)
    for (int64_t k = 0; k < count; k++) {
      uint64_t bits;
      memcpy(&bits, &column[c][k], sizeof bits);
      hash = (hash ^ bits) * 0x100000001b3u;
    }
  return (int64_t)(hash >> 32);
}

void mpsi_dynamics_use_structure(mps_dynamics *dynamics, mpsi_dynamics_structure *from) {
  mpsi_dynamics_structure former = {.mesh = dynamics->mesh,
                                    .slab = dynamics->slab,
                                    .scratch = dynamics->scratch,
                                    .bad = dynamics->bad,
                                    .part = dynamics->part,
                                    .halo = dynamics->halo,
                                    .column_dashpot = dynamics->column_dashpot};
  mpsi_dynamics_state *s = &dynamics->state;
  double **arrays[MPSI_DYN_SLAB_COLUMNS] = {&s->gx, &s->gy,     &s->gth, &s->c,     &s->s,
                                            &s->mu, &s->lambda, &s->sx,  &s->sy,    &s->sth,
                                            &s->ix, &s->iy,     &s->ith, &s->alpha, &s->beta};
  dynamics->count = from->count, dynamics->body = from->body, dynamics->pairs = from->pairs;
  dynamics->lattice = from->lattice;
  dynamics->ghosts = from->ghosts, dynamics->halo = from->halo;
  if (!mpsi_domain_many(dynamics->domain))
    dynamics->whole = from->count, dynamics->whole_body = from->body;
  dynamics->mesh = from->mesh;
  dynamics->slab = from->slab, dynamics->scratch = from->scratch;
  dynamics->bad = from->bad, dynamics->part = from->part;
  dynamics->column_dashpot = from->column_dashpot;
  dynamics->column_dashpots = from->column_dashpots;
  for (int k = 0; k < MPSI_DYN_SLAB_COLUMNS; k++) *arrays[k] = from->slab + k * from->stride;
  s->ex = from->slab + MPSI_DYN_SLAB_COLUMNS * from->stride;
  s->ey = s->ex + from->slots;
  *from = (mpsi_dynamics_structure){0};
  mpsi_dynamics_free_structure(dynamics, &former);
  mpsi_dynamics_bind(dynamics);
  dynamics->places = mpsi_dynamics_hash_positions(dynamics->count, s->rx, s->ry);
  (void)mpsi_dynamics_set_coefficients(dynamics);
}
