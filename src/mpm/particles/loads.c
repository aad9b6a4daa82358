/* loads.c - forces on particles besides gravity: the fields `body_acceleration` and
 * `external_force`, and dead loads on lists of particles, which are found by their ids so that
 * sorting does not matter. SPDX-License-Identifier: BSD-3-Clause */
#include "mpm_particles.h"
#include "mpm/particles/loads.h"
#include "mpm/particles/rooms.h"
#include "mpm/ranks/partition.h"

#include "core/base/selection.h"
#include "core/particles/particles_internal.h"

/* ---- forces of a step ------------------------------------------------------------------------ */

mps_status mpsi_mpm_make_forces(mps_context *context, const mpsi_grid *grid, mpsi_columns *p,
                                mpsi_rooms *rooms, const char *function) {
  if (rooms->force.item || mpsi_mpm_force_room(context, grid, p, rooms, p->count)) return MPS_OK;
  return mpsi_fail_memory(context, function, (size_t)p->count * sizeof(double));
}

/* Forces by the fields, for the blocks of cells. */
typedef struct field_forces {
  const mpsi_grid *grid;
  const mpsi_columns *p;
  const mpsi_loads *loads;
} field_forces;

static void begin_forces(void *data, int64_t b, int32_t worker) {
  const field_forces *of = data;
  const mpsi_columns *p = of->p;
  const mpsi_cell_block *cells = &of->grid->cells[b];
  for (int c = 0; c < of->grid->dim; c++) {
    const double *a = of->loads->body_acceleration[c], *f = of->loads->external_force[c];
    for (int64_t k = cells->begin; k < cells->end; k++)
      p->f[c][k] = (a ? p->m[k] * a[k] : 0.0) + (f ? f[k] : 0.0);
  }
}

static double area_by_spacing(const mpsi_grid *grid, const mpsi_columns *p, int64_t particle) {
  const double spacing = mps_particles_spacing(p->set);
  if (grid->dim == 3) return spacing * spacing;
  const double radius = grid->geometry == MPS_MPM_GEOMETRY_AXISYMMETRIC ? p->x[0][particle] : 1.0;
  return spacing * grid->measure * radius;
}

static void add_traction(const mpsi_grid *grid, const mpsi_columns *p, const mpsi_traction *load) {
  const mps_mpm_load_def *def = load->def;
  double traction[3] = {0.0};
  for (int c = 0; c < grid->dim; c++)
    traction[c] = def->factor[c] * load->now[c] * def->traction[c];
  for (int64_t k = 0; k < def->id_count; k++) {
    const int64_t particle = mps_particles_index(p->set, def->ids[k]);
    if (particle < 0) continue; /* removed */
    const double area = def->area ? def->area[k] : area_by_spacing(grid, p, particle);
    for (int c = 0; c < grid->dim; c++) p->f[c][particle] += area * traction[c];
  }
}

mps_status mpsi_mpm_find_forces(mps_context *context, const mpsi_grid *grid, mpsi_columns *p,
                                mpsi_rooms *rooms, mpsi_loads *loads, const char *function) {
  /* the fields may be added, or their memory moved, between steps */
  for (int c = 0; c < grid->dim; c++) {
    loads->body_acceleration[c] = mpsi_particles_column(p->set, "body_acceleration", c);
    loads->external_force[c] = mpsi_particles_column(p->set, "external_force", c);
  }
  if (loads->body_acceleration[0] || loads->external_force[0]) {
    MPSI_TRY(mpsi_mpm_make_forces(context, grid, p, rooms, function));
  }
  if (!rooms->force.item) return MPS_OK;
  field_forces of = {grid, p, loads};
  mpsi_mpm_for_cells(context, grid, p, begin_forces, &of);
  for (int32_t k = 0; k < loads->list->capacity; k++)
    if (mpsi_load_of(loads, k)) add_traction(grid, p, mpsi_load_of(loads, k));
  return MPS_OK;
}

/* ---- definitions ----------------------------------------------------------------------------- */

#define STRONGEST 1e150 /* N: impulses stay finite */

static mps_status check_areas(mps_context *context, const mpsi_grid *grid, const char *function,
                              const mps_mpm_load_def *def) {
  for (int64_t k = 0; def->area && k < def->id_count; k++)
    for (int c = 0; c < grid->dim; c++) {
      const double force = def->area[k] * def->traction[c] * def->factor[c];
      if (!(fabs(force) <= STRONGEST))
        return mpsi_fail(context, function, MPS_ERROR_ARGUMENT,
                         "area[%lld] is %g m2 with traction[%d] %g Pa and factor[%d] %g, a force "
                         "of %g N: allowed is up to %g N",
                         (long long)k, def->area[k], c, def->traction[c], c, def->factor[c], force,
                         STRONGEST);
    }
  return MPS_OK;
}

mps_status mpsi_mpm_check_load(mps_context *context, const mpsi_grid *grid, const mpsi_columns *p,
                               const mpsi_partition *partition, const char *function,
                               const mps_mpm_load_def *def) {
  const mpsi_selection selection = MPSI_SELECTION(def, grid->dim);
  const int64_t most = partition ? MPSI_MPM_MOST_PARTICLES : p->count;
  if (partition && !def->ids && mpsi_selection_given(&selection))
    return mpsi_fail(context, function, MPS_ERROR_UNSUPPORTED,
                     "%s given on several ranks: a load takes ids there",
                     def->all ? "all is" : "a box (lower, upper) is");
  if (def->id_count > most)
    return mpsi_fail(context, function, MPS_ERROR_ARGUMENT,
                     "id_count is %lld, allowed are 1 to %lld particles", (long long)def->id_count,
                     (long long)most);
  return check_areas(context, grid, function, def);
}
