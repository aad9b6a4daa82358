/* loads.c - forces on particles besides gravity: the fields `body_acceleration` and
 * `external_force`, and dead loads on lists of particles, which are found by their ids so that
 * sorting does not matter. SPDX-License-Identifier: BSD-3-Clause */
#include "mpm_particles.h"

#include "core/particles/particles_internal.h"
#include "core/context/retain.h"
#include "signal/signal_internal.h"

#include <string.h>

/* ---- forces of a step ------------------------------------------------------------------------ */

static mps_status make_forces(mps_context *context, const mpsi_grid *grid, mpsi_columns *p,
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
  (void)worker;
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
  double traction[3] = {0.0};
  for (int c = 0; c < grid->dim; c++) {
    traction[c] = load->factor[c] * load->now[c] * load->traction[c];
  }
  for (int64_t k = 0; k < load->count; k++) {
    const int64_t particle = mps_particles_index(p->set, load->id[k]);
    if (particle < 0) continue; /* removed */
    const double area = load->area ? load->area[k] : area_by_spacing(grid, p, particle);
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
    const mps_status status = make_forces(context, grid, p, rooms, function);
    if (status != MPS_OK) return status;
  }
  if (!rooms->force.item) return MPS_OK;
  field_forces of = {grid, p, loads};
  mpsi_mpm_for_cells(context, grid, p, begin_forces, &of);
  for (int32_t k = 0; k < loads->count; k++) add_traction(grid, p, &loads->traction[k]);
  return MPS_OK;
}

/* ---- loads ----------------------------------------------------------------------------------- */

static const mps_mpm_load_def load_defaults = {.struct_size = sizeof(mps_mpm_load_def),
                                               .factor = {1.0, 1.0, 1.0}};

mps_status mps_mpm_load_def_init(mps_mpm_load_def *def, size_t size) {
  return MPSI_DEF_INIT(mps_mpm_load_def, def, size, &load_defaults);
}

static void drop(mps_context *context, mpsi_traction *load) {
  mpsi_free(context, load->id);
  mpsi_free(context, load->area);
  for (int c = 0; c < 3; c++) mps_signal_destroy(&load->signal[c]);
  memset(load, 0, sizeof *load);
}

void mpsi_mpm_drop_loads(mps_context *context, const mpsi_loads *loads) {
  for (int32_t k = 0; k < loads->count; k++) drop(context, &loads->traction[k]);
  mpsi_free(context, loads->traction);
}

#define STRONGEST 1e150 /* N: impulses stay finite */

static mps_status check_numbers(mps_context *context, const mpsi_grid *grid, const mpsi_columns *p,
                                mpsi_partition *partition, const char *function,
                                const mps_mpm_load_def *def) {
  const int64_t most = partition ? MPSI_MPM_MOST_PARTICLES : p->count;
  if (def->id_count < 1 || def->id_count > most || !def->ids)
    return mpsi_fail(context, function, MPS_ERROR_ARGUMENT,
                     "id_count is %lld and ids %s, allowed are 1 to %lld particles",
                     (long long)def->id_count, def->ids ? "given" : "NULL", (long long)most);
  for (int64_t k = 0; def->area && k < def->id_count; k++)
    if (!isfinite(def->area[k]))
      return mpsi_fail(context, function, MPS_ERROR_ARGUMENT, "area[%lld] is %g m2, must be finite",
                       (long long)k, def->area[k]);
    else
      for (int c = 0; c < grid->dim; c++) {
        const double force = def->area[k] * def->traction[c] * def->factor[c];
        if (!(fabs(force) <= STRONGEST))
          return mpsi_fail(context, function, MPS_ERROR_ARGUMENT,
                           "area[%lld] is %g m2 with traction[%d] %g Pa and factor[%d] %g, a force "
                           "of %g N: allowed is up to %g N",
                           (long long)k, def->area[k], c, def->traction[c], c, def->factor[c],
                           force, STRONGEST);
      }
  return MPS_OK;
}

static mps_status check_list(mps_context *context, const mpsi_grid *grid, const mpsi_columns *p,
                             mpsi_partition *partition, const char *function, mps_status status,
                             const mps_mpm_load_def *def) {
  if (status == MPS_OK) status = check_numbers(context, grid, p, partition, function, def);
  return mpsi_mpm_check_ids(context, p, partition, function, status, def->id_count, def->ids);
}

static mps_status read_def(mps_context *context, const mpsi_grid *grid, const char *function,
                           const mps_mpm_load_def *user, mps_mpm_load_def *def) {
  if (!user) return mpsi_fail(context, function, MPS_ERROR_ARGUMENT, "def is NULL");
  const mps_status status = MPSI_DEF_READ(context, function, mps_mpm_load_def, user, def);
  for (int c = 0; c < grid->dim && status == MPS_OK; c++)
    if (!isfinite(def->traction[c]) || !isfinite(def->factor[c]))
      return mpsi_fail(context, function, MPS_ERROR_ARGUMENT,
                       "traction[%d] is %g Pa and factor[%d] %g, must be finite", c,
                       def->traction[c], c, def->factor[c]);
  return status;
}

static void take_traction(mpsi_traction *load, const mps_mpm_load_def *def) {
  for (int c = 0; c < 3; c++) {
    mps_signal *old = load->signal[c];
    load->traction[c] = def->traction[c];
    load->factor[c] = def->factor[c];
    load->signal[c] = def->signal[c] ? mpsi_signal_retain(def->signal[c]) : NULL;
    mps_signal_destroy(&old);
  }
}

/* Copies the ids and areas. */
static mps_status copy_list(mps_context *context, const char *function, const mps_mpm_load_def *def,
                            mpsi_traction *out) {
  const size_t bytes = (size_t)def->id_count * 8;
  out->id = mpsi_alloc(context, def->id_count, sizeof *out->id);
  if (out->id && def->area) out->area = mpsi_alloc(context, def->id_count, sizeof *out->area);
  if (!out->id || (def->area && !out->area)) {
    mpsi_free(context, out->id);
    out->id = NULL;
    return mpsi_fail_memory(context, function, bytes);
  }
  out->count = def->id_count;
  memcpy(out->id, def->ids, bytes);
  if (def->area) memcpy(out->area, def->area, bytes);
  return MPS_OK;
}

/* Checks that all ranks give the same load (`number` -1: a new one). */
static mps_status compare_ranks(const mpsi_grid *grid, mpsi_partition *partition,
                                const char *function, mps_status status, int32_t number,
                                const mps_mpm_load_def *def) {
  if (!partition) return status;
  mpsi_given given;
  mpsi_given_begin(&given);
  mpsi_give(&given, "load", number);
  if (status == MPS_OK) {
    const size_t bytes = def->id_count > 0 ? (size_t)def->id_count * 8 : 0;
    MPSI_GIVE(&given, def, id_count);
    MPSI_GIVE_VECTOR(&given, def, traction, grid->dim);
    MPSI_GIVE_VECTOR(&given, def, factor, grid->dim);
    for (int c = 0; c < grid->dim; c++)
      mpsi_signal_give(&given, "a hash of signal", def->signal[c]);
    mpsi_give_bytes(&given, "a hash of ids", def->ids, bytes);
    mpsi_give_bytes(&given, "a hash of area", def->area, bytes);
  }
  return mpsi_domain_agree_given(partition->domain, function, status, &given);
}

/* Lowest free number, and memory for it in the list. */
static mps_status find_number(mps_context *context, mpsi_loads *loads, const char *function,
                              int32_t *number) {
  int32_t at = 0;
  while (at < loads->count && loads->traction[at].count > 0) at++;
  if (number) *number = at;
  if (at < loads->count) return MPS_OK;
  void *list = loads->traction;
  if (!mpsi_grow(context, &list, at, at + 1, sizeof *loads->traction))
    return mpsi_fail_memory(context, function, sizeof *loads->traction);
  loads->traction = list;
  loads->count++;
  return MPS_OK;
}

mps_status mpsi_mpm_add_load(const mpsi_load_setup *setup, const char *function,
                             const mps_mpm_load_def *user, int32_t *number) {
  mps_mpm_load_def def = load_defaults;
  mpsi_traction made = {.count = 0};
  int32_t at = 0;
  mps_status status = mpsi_mpm_between_steps(setup->context, setup->run, function);
  if (status == MPS_OK) status = read_def(setup->context, setup->grid, function, user, &def);
  status = compare_ranks(setup->grid, setup->partition, function, status, -1, &def);
  status =
      check_list(setup->context, setup->grid, setup->p, setup->partition, function, status, &def);
  if (status == MPS_OK)
    status = make_forces(setup->context, setup->grid, setup->p, setup->rooms, function);
  if (status == MPS_OK) status = copy_list(setup->context, function, &def, &made);
  if (status == MPS_OK) status = find_number(setup->context, setup->loads, function, &at);
  status = mpsi_mpm_agree(setup->partition, function, status);
  if (status != MPS_OK) {
    drop(setup->context, &made);
    return status;
  }
  take_traction(&made, &def);
  setup->loads->traction[at] = made;
  if (number) *number = at;
  return MPS_OK;
}

static mps_status find_load(mps_context *context, const mpsi_loads *loads, const mpsi_run *run,
                            const char *function, int32_t number) {
  const mps_status status = mpsi_mpm_between_steps(context, run, function);
  if (status != MPS_OK) return status;
  if (number >= 0 && number < loads->count && loads->traction[number].count > 0) return MPS_OK;
  return mpsi_fail(context, function, MPS_ERROR_ARGUMENT,
                   "load is %d, must be a number that mps_mpm_add_load gave", number);
}

mps_status mpsi_mpm_set_load(const mpsi_load_setup *setup, const char *function, int32_t number,
                             const mps_mpm_load_def *user) {
  mps_mpm_load_def def = load_defaults;
  mps_status status = find_load(setup->context, setup->loads, setup->run, function, number);
  if (status == MPS_OK) status = read_def(setup->context, setup->grid, function, user, &def);
  status = compare_ranks(setup->grid, setup->partition, function, status, number, &def);
  if (status != MPS_OK) return status;
  mpsi_traction *load = &setup->loads->traction[number];
  if (def.ids || def.id_count != 0 || def.area) {
    mpsi_traction list = {.count = 0};
    status =
        check_list(setup->context, setup->grid, setup->p, setup->partition, function, status, &def);
    if (status == MPS_OK) status = copy_list(setup->context, function, &def, &list);
    status = mpsi_mpm_agree(setup->partition, function, status);
    if (status != MPS_OK) {
      drop(setup->context, &list);
      return status;
    }
    mpsi_free(setup->context, load->id);
    mpsi_free(setup->context, load->area);
    load->count = list.count, load->id = list.id, load->area = list.area;
  }
  take_traction(load, &def);
  return MPS_OK;
}

mps_status mpsi_mpm_remove_load(const mpsi_load_setup *setup, const char *function,
                                int32_t number) {
  mps_status status = find_load(setup->context, setup->loads, setup->run, function, number);
  if (setup->partition)
    status = mpsi_domain_agree_same(setup->partition->domain, function, status, "load", number);
  if (status == MPS_OK) drop(setup->context, &setup->loads->traction[number]);
  return status;
}
