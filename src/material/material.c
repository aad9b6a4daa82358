/* material.c - creation and release of a material, queries, and its application to a block.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "material_private.h"

#include <mps/experimental/material_point.h>
#include <stdio.h>

/* ---- life ------------------------------------------------------------------------------------ */

static void release(mps_material *m) {
  mps_context *context = m->context;
  MPSI_FREE(context, m->history_names, m->history_fields, m->history_initial);
  mpsi_release(m->release, m->release_user);
  MPSI_FREE(context, m->owned, m);
  mpsi_context_release(context);
}

mps_material *mpsi_material_new(mps_context *context, const char *function,
                                const mpsi_law_type *type, const char *name,
                                int32_t history_count) {
  mps_material *m = mpsi_alloc(context, 1, sizeof *m);
  if (!m) {
    (void)mpsi_fail_memory(context, function, sizeof *m);
    return NULL;
  }
  m->context = mpsi_context_retain(context);
  atomic_init(&m->references, 1);
  m->type = type;
  m->table = mpsi_laws_select(mpsi_context_level(context));
  strncpy(m->name, name, sizeof m->name - 1);
  m->history_count = history_count;
  if (history_count == 0) return m;
  m->history_names = mpsi_alloc(context, history_count, sizeof *m->history_names);
  if (m->history_names)
    m->history_fields = mpsi_alloc(context, history_count, sizeof *m->history_fields);
  if (m->history_fields)
    m->history_initial = mpsi_alloc(context, history_count, sizeof *m->history_initial);
  if (!m->history_initial) {
    (void)mpsi_fail_memory(context, function, (size_t)history_count * sizeof *m->history_names);
    release(m);
    return NULL;
  }
  return m;
}

mps_material *mpsi_material_retain(mps_material *material) {
  atomic_fetch_add(&material->references, 1);
  return material;
}

void mps_material_destroy(mps_material **material) {
  if (!material || !*material) return;
  mps_material *m = *material;
  *material = NULL;
  if (atomic_fetch_sub(&m->references, 1) == 1) release(m);
}

mps_status mpsi_material_check_newtonian(mps_context *context, const char *function,
                                         const mps_material *material) {
  if (!material) return mpsi_fail(context, function, MPS_ERROR_ARGUMENT, "material is NULL");
  if (material->type->kind == MPSI_LAW_NEWTONIAN) return MPS_OK;
  return mpsi_fail(context, function, MPS_ERROR_UNSUPPORTED,
                   "material: the law is %s, a fluid is newtonian", material->name);
}

/* ---- questions ------------------------------------------------------------------------------- */

const char *mps_material_name(const mps_material *material) {
  return material ? material->name : "";
}

double mps_material_wave_modulus(const mps_material *material) {
  return material ? material->wave_modulus : 0.0;
}

int32_t mps_material_history_count(const mps_material *material) {
  return material ? material->history_count : 0;
}

const char *mps_material_history_name(const mps_material *material, int32_t index) {
  if (!material || index < 0 || index >= material->history_count) return NULL;
  return material->history_names[index];
}

const char *mpsi_material_history_field(const mps_material *material, int32_t index) {
  if (!material || index < 0 || index >= material->history_count) return NULL;
  return material->history_fields[index];
}

double mps_material_history_initial(const mps_material *material, int32_t index) {
  if (!material || index < 0 || index >= material->history_count) return 0.0;
  return material->history_initial[index];
}

bool mpsi_material_needs_deformation(const mps_material *material) {
  return material->law.needs_deformation;
}

bool mpsi_material_reads_volume(const mps_material *material) {
  return (material->type->traits & MPSI_LAW_READS_VOLUME) != 0 || material->law.loosest > 0.0;
}

bool mpsi_material_opens(const mps_material *material) {
  return (material->type->traits & MPSI_LAW_OPENS) != 0 || material->law.frictional;
}

static int32_t column_named(const mps_material *material, const char *name) {
  int32_t c = 0;
  while (c < material->history_count && strcmp(material->history_names[c], name) != 0) c++;
  return c;
}

void mpsi_material_sand_columns(const mps_material *material, int32_t *strain, int32_t *gap) {
  *strain = column_named(material, mpsi_sand_columns[0]);
  *gap = column_named(material, mpsi_sand_columns[1]);
}

int32_t mpsi_material_gap_column(const mps_material *material) {
  const int32_t c = column_named(material, mpsi_sand_columns[1]);
  return c < material->history_count ? c : -1;
}

bool mpsi_material_dilates(const mps_material *material) {
  return mpsi_material_opens(material) &&
         (material->law.sin_psi > 0.0 || material->law.alpha_flow > 0.0 ||
          material->law.frictional);
}

bool mpsi_material_dilates_without_end(const mps_material *material) {
  return mpsi_material_dilates(material) && !(material->law.loosest > 0.0);
}

bool mpsi_material_keeps_volume(const mps_material *material) {
  const uint32_t yields = MPSI_LAW_OPENS | MPSI_LAW_ISOCHORIC | MPSI_LAW_HAS_START;
  return (material->type->traits & yields) != 0 && !(material->law.loosest > 0.0);
}

bool mpsi_material_flows(const mps_material *material) {
  return (material->type->traits & MPSI_LAW_FLOWS) != 0 || material->law.frictional;
}

const double *mpsi_material_stiffness(const mps_material *material, double *const *history) {
  return material->by_field ? history[material->history_count - 2] : NULL;
}

bool mpsi_material_has_start(const mps_material *material) {
  return (material->type->traits & MPSI_LAW_HAS_START) != 0;
}

bool mpsi_material_may_refuse(const mps_material *material) {
  return (material->type->traits & MPSI_LAW_MAY_REFUSE) != 0;
}

double mpsi_material_viscosity(const mps_material *material) { return material->law.viscosity; }

void mpsi_material_begin(const mps_material *material, double *const *history, int64_t begin,
                         int64_t end) {
  const bool starts = mpsi_material_has_start(material) || material->by_field;
  for (int32_t c = 0; c < material->history_count; c++) {
    const double initial = material->history_initial[c];
    const bool given = starts && initial != 0.0; /* a value of the caller's stays */
    for (int64_t k = begin; k < end; k++)
      if (!given || history[c][k] == 0.0) history[c][k] = initial;
  }
}

/* ---- one step of a block --------------------------------------------------------------------- */

static mpsi_geometry_kind geometry_of(const mps_material_block *block) {
  if (block->dim == 3) return MPSI_SPACE;
  return block->gradient[8] ? MPSI_AXIAL : MPSI_PLANE;
}

mps_status mpsi_material_apply(const mps_material *material, const mps_material_block *block) {
  if (material->by_field) return mpsi_apply_by_field(material, block);
  return material->table->apply[material->type->kind][geometry_of(block)](&material->law, block);
}

static const char *const tensor_names[9] = {"xx", "xy", "xz", "yx", "yy", "yz", "zx", "zy", "zz"};

/* The tensors' columns: those of `dim`, and the deformation gradient where the law needs it. */
static mps_status check_tensors(mps_context *context, const char *function,
                                const mps_material *material, const mps_material_block *block) {
  for (int c = 0; c < 9; c++) {
    const bool there = block->dim == 3 || c == 0 || c == 1 || c == 3 || c == 4 || c == 8;
    const bool free = block->dim == 2 && c == 8; /* plane strain */
    if (there && !free && !block->gradient[c])
      return mpsi_fail(context, function, MPS_ERROR_ARGUMENT,
                       "gradient[%d] (%s) is NULL, needed in %dD", c, tensor_names[c], block->dim);
    if (there && material->law.needs_deformation && !block->deformation[c])
      return mpsi_fail(context, function, MPS_ERROR_ARGUMENT,
                       "deformation[%d] (%s) is NULL, needed by the law %s in %dD", c,
                       tensor_names[c], material->name, block->dim);
  }
  for (int c = 0; c < (block->dim == 3 ? 6 : 4); c++)
    if (!block->stress[c])
      return mpsi_fail(context, function, MPS_ERROR_ARGUMENT, "stress[%d] is NULL, needed in %dD",
                       c, block->dim);
  return MPS_OK;
}

static mps_status check_block(mps_context *context, const char *function,
                              const mps_material *material, const mps_material_block *block) {
  if (block->history_count < material->history_count)
    return mpsi_fail(context, function, MPS_ERROR_ARGUMENT,
                     "history_count is %d, the law %s has %d columns", block->history_count,
                     material->name, material->history_count);
  for (int32_t c = 0; c < material->history_count; c++)
    if (!block->history || !block->history[c])
      return mpsi_fail(context, function, MPS_ERROR_ARGUMENT,
                       "history[%d] (%s) is NULL, needed by the law %s", c,
                       material->history_names[c], material->name);
  return check_tensors(context, function, material, block);
}

mps_status mpsi_material_refused(mps_context *context, const char *function,
                                 const mps_material *material, mps_status status,
                                 const char *message, int64_t id, int64_t step) {
  char particle[40] = "";
  if (id >= 0) (void)snprintf(particle, sizeof particle, " particle %lld", (long long)id);
  const bool known = status > MPS_OK && status <= MPS_ERROR_INTERNAL;
  const mps_status reported =
      mpsi_fail(context, function, known ? status : MPS_ERROR_NUMERIC,
                "the law '%s' has refused%s%s%s", material->name,
                id >= 0 ? particle : " a block of particles", message[0] ? ": " : "", message);
  mpsi_fail_where(context, step, id);
  return reported;
}

mps_status mps_material_update(mps_context *context, const mps_material *material,
                               const mps_material_block *user_block) {
  if (!context) return mpsi_null(__func__, "context");
  if (!material || !user_block)
    return mpsi_fail(context, __func__, MPS_ERROR_ARGUMENT, "%s is NULL",
                     material ? "block" : "material");
  mps_material_block block = {.dim = 2};
  MPSI_TRY(MPSI_DEF_READ(context, __func__, mps_material_block, user_block, &block));
  MPSI_TRY(check_block(context, __func__, material, &block));
  char message[MPSI_MATERIAL_MESSAGE] = "";
  int64_t refused = -1;
  if (!block.message || block.message_size == 0)
    block.message = message, block.message_size = sizeof message;
  if (!block.refused) block.refused = &refused;
  block.message[0] = '\0';
  *block.refused = -1;
  mps_status status = mpsi_material_apply(material, &block);
  if (status == MPS_OK) return MPS_OK;
  const int64_t k = *block.refused;
  const bool there = k >= 0 && k < block.count;
  return mpsi_material_refused(context, __func__, material, status, block.message,
                               !there      ? -1
                               : block.ids ? block.ids[k]
                                           : k,
                               -1);
}
