/* by_field.c - a law whose moduli and strengths are multiplied by factors of each particle: its
 * constants are scaled for one particle after the other. SPDX-License-Identifier: BSD-3-Clause */
#include "material_private.h"

/* Columns of history: of the factors, and in all at most. */
enum { FACTORS = MPSI_FACTORS, MOST = MPSI_SMALL_COLUMNS + MPSI_FACTORS };

static mpsi_geometry_kind geometry_of(const mps_material_block *block) {
  if (block->dim == 3) return MPSI_SPACE;
  return block->gradient[8] ? MPSI_AXIAL : MPSI_PLANE;
}

/* Stresses times `strength`, moduli times `stiff`. */
static void scale_law(mpsi_law *to, const mpsi_law *law, double stiff, double strength) {
  to->shear = stiff * law->shear, to->bulk = stiff * law->bulk, to->lambda = stiff * law->lambda;
  to->per_bulk = law->per_bulk / stiff, to->hardening = stiff * law->hardening;
  to->cone = law->cone / stiff;
  to->yield = strength * law->yield;
  to->kappa = strength * law->kappa, to->q_tension = strength * law->q_tension;
  to->tension = strength * law->tension;
  to->c_cos_phi = strength * law->c_cos_phi;
  to->apex = strength * law->apex, to->cut = strength * law->cut;
  to->cohesion = strength * law->cohesion, to->cohesion_last = strength * law->cohesion_last;
  to->given_cut = strength * law->given_cut;
  for (int i = 0; i < MPSI_LAYERS; i++) {
    to->layer_shear[i] = stiff * law->layer_shear[i];
    to->layer_strength[i] = strength * law->layer_strength[i];
  }
}

/* The block of its particle k alone. */
static void take_particle(const mps_material_block *block, int64_t k, double **history,
                          mps_material_block *one) {
  for (int c = 0; c < 9; c++)
    if (block->gradient[c]) one->gradient[c] = block->gradient[c] + k;
  for (int c = 0; c < 2 * block->dim; c++) one->stress[c] = block->stress[c] + k;
  for (int c = 0; c < one->history_count; c++) history[c] = block->history[c] + k;
  one->volume_ratio = block->volume_ratio + k;
  one->flags = block->flags + k;
}

mps_status mpsi_apply_by_field(const mps_material *material, const mps_material_block *block) {
  const int32_t columns = material->history_count - FACTORS;
  const double *stiff = block->history[columns], *strength = block->history[columns + 1];
  const mpsi_law_fn apply = material->table->apply[material->type->kind][geometry_of(block)];
  double *history[MOST];
  mps_material_block one = *block;
  mpsi_law law = material->law;
  one.count = 1;
  one.history = history;
  one.history_count = columns;
  for (int64_t k = 0; k < block->count; k++) {
    take_particle(block, k, history, &one);
    scale_law(&law, &material->law, mpsi_factor(stiff[k]), mpsi_factor(strength[k]));
    MPSI_TRY(apply(&law, &one));
  }
  return MPS_OK;
}
