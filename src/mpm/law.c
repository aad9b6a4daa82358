/* law.c - the material's law on the particles of a block, seed B (45)-(48), and the speeds that
 * bound the time step, (49), (50).
 * SPDX-License-Identifier: BSD-3-Clause */
#include "mpm_private.h"

#include <string.h>

/* Columns of particles [begin, end) as the law sees them. */
static mps_material_block columns_of(const mps_mpm *mpm, int64_t begin, int64_t end) {
  static const int at[5] = {0, 1, 3, 4, 8};
  const mpsi_columns *p = &mpm->p;
  mps_material_block block = {.struct_size = sizeof block,
                              .dim = 2,
                              .count = end - begin,
                              .dt = mpm->dt,
                              .volume_ratio = (p->J ? p->J : p->V) + begin,
                              .flags = mpm->flags + begin};
  const int tensors = mpm->def.geometry == MPS_AXISYMMETRIC ? 5 : 4;
  for (int c = 0; c < tensors; c++) block.gradient[at[c]] = p->L[c] + begin;
  for (int c = 0; c < 5 && p->F[c]; c++) block.deformation[at[c]] = p->F[c] + begin;
  for (int c = 0; c < 4; c++) block.stress[c] = p->s[c] + begin;
  for (int32_t h = 0; h < mpm->histories; h++) block.history[h] = p->history[h] + begin;
  return block;
}

void mpsi_mpm_apply_law(mps_mpm *mpm, mpsi_cells *cells) {
  mpsi_columns *p = &mpm->p;
  const mps_material_block block = columns_of(mpm, cells->begin, cells->end);
  /* Where the law works on J, V stands for V0 meanwhile. */
  for (int64_t k = cells->begin; p->J && k < cells->end; k++) p->V[k] /= p->J[k];
  cells->refused = mpsi_material_apply(mpm->material, &block) != 0;
  for (int64_t k = cells->begin; p->J && k < cells->end; k++) p->V[k] *= p->J[k];
}

/* Largest c + |v| of a block. NaN anywhere makes a NaN or shows as a bad particle. */
void mpsi_mpm_find_speed(mps_mpm *mpm, int64_t b) {
  enum { CHUNK = 64 };
  mpsi_cells *cells = &mpm->cells[b];
  const mpsi_columns *p = &mpm->p;
  const bool stiffens = mpsi_material_stiffens(mpm->material);
  double moduli[CHUNK];
  cells->speed = 0.0;
  for (int64_t begin = cells->begin; begin < cells->end; begin += CHUNK) {
    const int64_t end = begin + CHUNK < cells->end ? begin + CHUNK : cells->end;
    if (stiffens) {
      const mps_material_block block = columns_of(mpm, begin, end);
      mpsi_material_wave_moduli(mpm->material, &block, moduli);
    }
    for (int64_t k = begin; k < end; k++) {
      const double M = stiffens ? moduli[k - begin] : mpm->modulus;
      const double v2 = p->v[0][k] * p->v[0][k] + p->v[1][k] * p->v[1][k];
      const double speed = sqrt(M * p->V[k] / p->m[k]) + sqrt(v2);
      if (!isfinite(speed) && cells->bad < 0) cells->bad = k;
      if (speed > cells->speed) cells->speed = speed;
    }
  }
}
