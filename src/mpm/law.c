/* law.c - the material's law on the particles of a block, seed B (45)-(48).
 * SPDX-License-Identifier: BSD-3-Clause */
#include "kernels.h"

/* Columns of particles [begin, end) as the law sees them. */
static mps_material_block columns_of(const mps_mpm *mpm, int64_t begin, int64_t end) {
  static const int planar[5] = {0, 1, 3, 4, 8};
  const mpsi_columns *p = &mpm->p;
  mps_material_block block = {.struct_size = sizeof block,
                              .dim = mpm->dim,
                              .count = end - begin,
                              .dt = mpm->dt,
                              .volume_ratio = (p->J ? p->J : p->V) + begin,
                              .flags = mpm->flags + begin};
  const int tensors = mpm->dim == 3 ? 9 : 5;
  for (int c = 0; c < tensors; c++) {
    const int to = mpm->dim == 3 ? c : planar[c];
    if (mpm->def.geometry != MPS_PLANE_STRAIN || c < 4) block.gradient[to] = p->L[c] + begin;
    if (p->F[c]) block.deformation[to] = p->F[c] + begin;
  }
  for (int c = 0; c < 2 * mpm->dim; c++) block.stress[c] = p->s[c] + begin;
  for (int32_t h = 0; h < mpm->histories; h++) block.history[h] = p->history[h] + begin;
  return block;
}

void mpsi_mpm_apply_law(mps_mpm *mpm, mpsi_cells *cells, int64_t begin, int64_t end) {
  mpsi_columns *p = &mpm->p;
  const mps_material_block block = columns_of(mpm, begin, end);
  /* Where the law works on J, V stands for V0 meanwhile. */
  for (int64_t k = begin; p->J && k < end; k++) p->V[k] /= p->J[k];
  if (mpsi_material_apply(mpm->material, &block) != 0) cells->refused = true;
  for (int64_t k = begin; p->J && k < end; k++) p->V[k] *= p->J[k];
}

void mpsi_mpm_elastic(const mps_mpm *mpm, int64_t particle, double *wave, double *shear) {
  (void)particle;
  *wave = mpm->modulus;
  *shear = mpsi_material_shear(mpm->material);
}

void mpsi_mpm_find_moduli(const mps_mpm *mpm, int64_t begin, int64_t end, double *moduli) {
  const mps_material_block block = columns_of(mpm, begin, end);
  mpsi_material_wave_moduli(mpm->material, &block, moduli);
}
