/* moduli.c - the wave modulus K + 4G/3 of Nakamura (50) in the present state, for laws with a
 * stiffness that depends on the state. SPDX-License-Identifier: BSD-3-Clause */
#include "constants.h"

bool mpsi_material_stiffens(const mps_material *material) {
  if (material->by_field) return true;
  return material->type->moduli != NULL &&
         (material->type->kind != MPSI_LAW_USER || material->law.moduli != NULL);
}

/* A value that no modulus can have makes the particle a bad one, which the solver reports. */
void mpsi_user_moduli(const mpsi_law *law, const mps_material_block *block, double *moduli) {
  law->moduli(law->user, block, moduli);
  for (int64_t k = 0; k < block->count; k++)
    if (!(moduli[k] > 0.0)) moduli[k] = NAN;
}

/* K = v p/kappa at the larger of p and pc, which bounds that of the next steps too, and G. */
void mpsi_cam_clay_moduli(const mpsi_law *law, const mps_material_block *block, double *moduli) {
  for (int64_t k = 0; k < block->count; k++) {
    const double p = -(block->stress[0][k] + block->stress[1][k] + block->stress[2][k]) / 3.0;
    const double pc = fmax(block->history[MPSI_CLAY_PC][k], 2.0 * law->least_pressure);
    const double v = 1.0 + block->history[MPSI_CLAY_VOID][k];
    const double bulk = v * fmax(p, pc) / law->swelling;
    const double shear = law->shear_ratio > 0.0 ? law->shear_ratio * bulk : law->shear;
    moduli[k] = bulk + 4.0 / 3.0 * shear;
  }
}

/* -V dp/dV: K r, or K r^7, r = V0/V. */
void mpsi_newtonian_moduli(const mpsi_law *law, const mps_material_block *block, double *moduli) {
  for (int64_t k = 0; k < block->count; k++) {
    const double r = 1.0 / block->volume_ratio[k], r2 = r * r;
    moduli[k] = law->bulk * (law->tait ? r2 * r2 * r2 * r : r);
  }
}

/* The acoustic tensor's largest eigenvalue along n: (lambda/2 + G + G b_n)/J + lambda J/2, where
 * b_n = n.B.n is at most B's mean plus 2 sqrt(J2(B)/3). */
void mpsi_neo_hookean_moduli(const mpsi_law *law, const mps_material_block *block, double *moduli) {
  const bool space = block->dim == 3;
  double *const *f = block->deformation;
  for (int64_t k = 0; k < block->count; k++) {
    double now[3][3] = {{0}}, b[3][3];
    for (int c = 0; c < 9; c++)
      if (space || c == 0 || c == 1 || c == 3 || c == 4 || c == 8) now[c / 3][c % 3] = f[c][k];
    for (int i = 0; i < 3; i++)
      for (int j = 0; j < 3; j++)
        b[i][j] = now[i][0] * now[j][0] + now[i][1] * now[j][1] + now[i][2] * now[j][2];
    const double mean = (b[0][0] + b[1][1] + b[2][2]) / 3.0;
    double square = 0.0;
    for (int i = 0; i < 3; i++) {
      const int j = (i + 1) % 3;
      square += 0.5 * (b[i][i] - mean) * (b[i][i] - mean) + b[i][j] * b[i][j];
    }
    const double largest = mean + 2.0 * sqrt(square / 3.0), j = block->volume_ratio[k];
    moduli[k] = (0.5 * law->lambda + law->shear * (1.0 + largest)) / j + 0.5 * law->lambda * j;
  }
}

void mpsi_material_wave_moduli(const mps_material *material, const mps_material_block *block,
                               double *moduli) {
  if (material->by_field) {
    const double *factor = mpsi_material_stiffness(material, block->history);
    for (int64_t k = 0; k < block->count; k++)
      moduli[k] = mpsi_factor(factor[k]) * material->wave_modulus;
  } else if (mpsi_material_stiffens(material))
    material->type->moduli(&material->law, block, moduli);
  else
    for (int64_t k = 0; k < block->count; k++) moduli[k] = material->wave_modulus;
}

double mpsi_material_rest_modulus(const mps_material *material) {
  return material->law.has_moduli ? mpsi_law_wave_modulus(&material->law) : material->wave_modulus;
}

double mpsi_material_shear(const mps_material *material) { return material->law.shear; }

int32_t mpsi_material_dissipated(void) { return MPSI_SMALL_DISSIPATED; }

mpsi_kept mpsi_material_kept(const mps_material *material) { return material->type->kept; }
