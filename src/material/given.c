/* given.c - the constants of a law, as named numbers. SPDX-License-Identifier: BSD-3-Clause */
#include "material_private.h"

#include <stddef.h>

enum { CONSTANTS = 44 }; /* doubles of mpsi_law before its layers, all of them listed below */
_Static_assert(offsetof(mpsi_law, layer_shear) - offsetof(mpsi_law, shear) ==
                   CONSTANTS * sizeof(double),
               "a constant that is new in mpsi_law is to be listed in mpsi_material_give");

/* For functions of the caller: whether there is one; addresses differ between processes. */
void mpsi_material_give(mpsi_given *list, const mps_material *material) {
  mpsi_give(list, "having a material", material != NULL);
  if (!material) return;
  const mpsi_law *law = &material->law;
  const struct {
    const char *name;
    double value;
  } constants[] = {{"the shear modulus of the material", law->shear},
                   {"the bulk modulus of the material", law->bulk},
                   {"Lame's first constant of the material", law->lambda},
                   {"the reciprocal bulk modulus of the material", law->per_bulk},
                   {"the yield stress of the material", law->yield},
                   {"the hardening modulus of the material", law->hardening},
                   {"the slope of the material's cone", law->alpha},
                   {"the strength of the material's cone", law->kappa},
                   {"the slope of the material's flow cone", law->alpha_flow},
                   {"the return to the material's cone", law->cone},
                   {"the tension limit of the material", law->tension},
                   {"the strength of the material at its tension limit", law->q_tension},
                   {"sin(phi) of the material", law->sin_phi},
                   {"sin(psi) of the material", law->sin_psi},
                   {"c cos(phi) of the material", law->c_cos_phi},
                   {"the apex of the material's pyramid", law->apex},
                   {"the tension limit of the material's pyramid", law->cut},
                   {"V/V0 at which the material's dilation ends", law->loosest},
                   {"the residual strength of the material", law->residual},
                   {"the rate of softening of the material", law->per_strain},
                   {"the softening of the material", law->softens + 2.0 * law->softens_linearly},
                   {"the rate factor of the material", law->rate_factor},
                   {"the reciprocal reference rate of the material", law->per_rate},
                   {"tan(phi) of the material", law->tan_phi},
                   {"the residual tan(phi) of the material", law->tan_phi_last},
                   {"tan(psi) of the material", law->tan_psi},
                   {"the cohesion of the material", law->cohesion},
                   {"the residual cohesion of the material", law->cohesion_last},
                   {"the tension limit given to the material", law->given_cut},
                   {"M of the material", law->slope},
                   {"lambda of Cam-Clay of the material", law->compression},
                   {"kappa of the material", law->swelling},
                   {"G/K of the material", law->shear_ratio},
                   {"the Lode option of the material", law->lode},
                   {"the least pressure of the material", law->least_pressure},
                   {"the logarithm of the material's least pressure", law->log_least},
                   {"the material's having factors by field", material->by_field},
                   {"pc of the material", law->first_pc},
                   {"the void ratio of the material", law->first_void},
                   {"the material's having moduli by the state", law->moduli != NULL},
                   {"C1 of the material", law->contract[0]},
                   {"C2 of the material", law->contract[1]},
                   {"C3 of the material", law->contract[2]},
                   {"C4 of the material", law->contract[3]},
                   {"the threshold of the material's contraction", law->threshold},
                   {"the strain limit of the material's contraction", law->strain_limit},
                   {"the viscosity of the material", law->viscosity},
                   {"the equation of state of the material", law->tait},
                   {"the material's having no tension", law->no_tension},
                   {"turning the stress of the material", law->turns_stress},
                   {"the material's need of a deformation", law->needs_deformation},
                   {"the material's having grains that part", law->frictional},
                   {"the wave modulus of the material", material->wave_modulus},
                   {"the material's number of histories", material->history_count},
                   {"stating the moduli of the material", law->has_moduli}};
  mpsi_give_text(list, "a hash of the kind of the material's law", material->type->name);
  mpsi_give_bytes(list, "a hash of the constants of the material's UMAT", material->owned_constants,
                  (size_t)material->owned_count * sizeof *material->owned_constants);
  for (size_t k = 0; k < sizeof constants / sizeof *constants; k++)
    mpsi_give(list, constants[k].name, constants[k].value);
  mpsi_give_bytes(list, "a hash of the shear moduli of the material's layers", law->layer_shear,
                  sizeof law->layer_shear);
  mpsi_give_bytes(list, "a hash of the strengths of the material's layers", law->layer_strength,
                  sizeof law->layer_strength);
  mpsi_give_text(list, "a hash of the material's name", material->name);
  uint64_t hash = MPSI_HASH;
  for (int32_t h = 0; h < material->history_count; h++) {
    hash = mpsi_hash(hash, material->history_names[h], strlen(material->history_names[h]) + 1);
    hash = mpsi_hash_number(hash, material->history_initial[h]);
  }
  mpsi_give(list, "a hash of the material's histories", mpsi_hash_short(hash));
}
