/* materials.c - the laws of a solver and the particles of each: fields that a law reads and writes,
 * and its initial state. SPDX-License-Identifier: BSD-3-Clause */
#include "core/particles/particles_internal.h"
#include "mpm_particles.h"
#include "mpm/particles/rooms.h"

/* ---- one law --------------------------------------------------------------------------------- */

static mps_status add_fields(mps_particles *set, const char *function, const mpsi_law_use *law) {
  mps_status status = MPS_OK;
  if (law->reads_volume) status = mps_particles_add_field(set, "volume_ratio", 0);
  if (status == MPS_OK && law->needs_deformation)
    status = mps_particles_add_field(set, "deformation_gradient", 0);
  for (int32_t h = 0; h < law->columns && status == MPS_OK; h++)
    status =
        mpsi_particles_add_field(set, function, mpsi_material_history_field(law->material, h), 1);
  return status;
}

void mpsi_mpm_bind_law(mpsi_columns *p, mpsi_law_use *law) {
  mps_particles *set = p->set;
  if (law->reads_volume) p->J = mpsi_particles_column(set, "volume_ratio", 0);
  for (int c = 0; c < 9 && law->needs_deformation; c++)
    p->F[c] = mpsi_particles_column(set, "deformation_gradient", c);
  for (int32_t h = 0; h < law->columns; h++)
    law->history[h] = mpsi_particles_column(set, mpsi_material_history_field(law->material, h), 0);
  law->stiffness = mpsi_material_stiffness(law->material, law->history);
  p->laws.ids = mpsi_particles_integers(set, "id");
  p->laws.temperature = mpsi_particles_column(set, "temperature", 0);
}

/* Chooses whether the law takes the mean change of volume or the particle's own. A mean, with
 * forces by each particle's own pressure, does net work in a closed cycle where dilation makes
 * pressures irregular: volumetric.c. */
static void choose_volume(const mps_mpm_def *def, bool soaked, mpsi_law_use *law) {
  mpsi_volume suits = mpsi_material_volume(law->material);
  if (soaked && suits == MPSI_VOLUME_FILTERED && mpsi_material_opens(law->material) &&
      !mpsi_material_dilates(law->material))
    suits = MPSI_VOLUME_MEAN;
  switch (def->volumetric) {
  case MPS_MPM_VOLUMETRIC_BY_LAW:
    law->own_volume = suits != MPSI_VOLUME_MEAN;
    law->filtered = suits == MPSI_VOLUME_FILTERED;
    return;
  case MPS_MPM_VOLUMETRIC_CELL:
    law->own_volume = mpsi_material_dilates(law->material);
    return;
  case MPS_MPM_VOLUMETRIC_NODES:
    law->own_volume = law->filtered = mpsi_material_opens(law->material);
    return;
  default:
    law->own_volume = true;
  }
}

/* The columns that the filter of the law's stress works on. */
static void choose_columns(mpsi_law_use *law) {
  law->strain = law->gap = -1;
  law->opening = mpsi_material_gap_column(law->material);
  if (law->filtered && mpsi_material_opens(law->material))
    mpsi_material_sand_columns(law->material, &law->strain, &law->gap);
}

bool mpsi_mpm_soak_room(mps_context *context, const mpsi_grid *grid, mpsi_columns *p,
                        mpsi_rooms *rooms, const mps_mpm_def *def) {
  bool means = !p->laws.at_once;
  for (int32_t k = 0; k < p->laws.count; k++) {
    mpsi_law_use law = p->laws.law[k];
    choose_volume(def, true, &law);
    means = means || !law.own_volume;
  }
  return mpsi_mpm_volume_room(context, grid, p, rooms, p->count, means, p->laws.some_filtered);
}

void mpsi_mpm_soak_laws(mpsi_columns *p, const mps_mpm_def *def) {
  p->laws.soaked = true;
  p->laws.at_once = true, p->laws.some_own = p->laws.some_filtered = false;
  for (int32_t k = 0; k < p->laws.count; k++) {
    mpsi_law_use *law = &p->laws.law[k];
    choose_volume(def, true, law);
    choose_columns(law);
    p->laws.at_once = p->laws.at_once && law->own_volume;
    p->laws.some_own = p->laws.some_own || law->own_volume;
    p->laws.some_filtered = p->laws.some_filtered || law->filtered;
  }
}

mps_status mpsi_mpm_add_law(mps_context *context, const mpsi_grid *grid, mpsi_columns *p,
                            mpsi_rooms *rooms, const mps_mpm_def *def, const char *function,
                            mps_material *material) {
  if (!mpsi_room_keep(context, &p->laws.room, p->laws.count + 1, sizeof *p->laws.law))
    return mpsi_fail_memory(context, function, (size_t)(p->laws.count + 1) * sizeof *p->laws.law);
  p->laws.law = p->laws.room.item;
  mps_particles *set = p->set;
  mpsi_law_use law = {.material = material,
                      .modulus = mps_material_wave_modulus(material),
                      .reads_volume = mpsi_material_reads_volume(material),
                      .needs_deformation = mpsi_material_needs_deformation(material),
                      .bulk = mpsi_material_rest_modulus(material) -
                              4.0 / 3.0 * mpsi_material_shear(material),
                      .columns = mps_material_history_count(material)};
  choose_volume(def, p->laws.soaked, &law);
  choose_columns(&law);
  const bool at_once = law.own_volume && p->laws.at_once;
  const bool some_filtered = law.filtered || p->laws.some_filtered;
  if (p->laws.count > 0 &&
      !mpsi_mpm_volume_room(context, grid, p, rooms, p->count, !at_once, some_filtered))
    return mpsi_fail_memory(context, function, (size_t)p->count * 10 * sizeof(double));
  law.history = mpsi_alloc(context, law.columns, sizeof *law.history);
  if (!law.history)
    return mpsi_fail_memory(context, function, (size_t)law.columns * sizeof *law.history);
  const int32_t fields = mps_particles_field_count(set);
  const mps_status status = mpsi_as(context, function, add_fields(set, function, &law));
  if (status != MPS_OK) {
    mpsi_particles_drop_fields(set, fields);
    mpsi_free(context, law.history);
    return status;
  }
  mpsi_mpm_bind_law(p, &law);
  mpsi_material_retain(material);
  if (p->laws.count == 0) atomic_flag_clear(&p->laws.refusal.busy);
  p->laws.one_modulus = p->laws.count == 0 && !mpsi_material_stiffens(material) &&
                        mpsi_material_viscosity(material) == 0.0;
  p->laws.at_once = at_once;
  p->laws.some_own = p->laws.some_own || law.own_volume;
  p->laws.some_filtered = some_filtered;
  p->laws.some_open = p->laws.some_open || law.opening >= 0;
  p->laws.some_flow = p->laws.some_flow || mpsi_material_flows(material);
  p->laws.law[p->laws.count++] = law;
  return MPS_OK;
}

void mpsi_mpm_begin_law(const mpsi_grid *grid, const mpsi_columns *p, const mpsi_law_use *law,
                        int64_t k) {
  if (law->reads_volume && p->J[k] == 0.0) p->J[k] = 1.0;
  bool deformed = !law->needs_deformation;
  for (int c = 0; c < 9 && !deformed && p->F[c]; c++) deformed = p->F[c][k] != 0.0;
  for (int c = 0; c < 9 && !deformed && p->F[c]; c++) {
    const bool diagonal = grid->dim == 3 ? c % 4 == 0 : c == 0 || c >= 3;
    p->F[c][k] = diagonal ? 1.0 : 0.0;
  }
  mpsi_material_begin(law->material, law->history, k, k + 1);
}

/* ---- the initial state ----------------------------------------------------------------------- */

void mpsi_mpm_find_state(const mpsi_columns *p, const mps_material *material,
                         mpsi_first_state *out) {
  out->material = material;
  for (int32_t h = 0; h < mps_material_history_count(material); h++)
    out->history[h] = mpsi_particles_column(p->set, mpsi_material_history_field(material, h), 0);
}

mps_status mpsi_mpm_check_state(mps_context *context, const mpsi_grid *grid, const mpsi_columns *p,
                                const char *function, const mpsi_first_state *first, int64_t k) {
  enum { MOST = 8 }; /* most history columns of a law with an initial state */
  double stress[6] = {0.0}, history[MOST] = {0.0};
  char reason[200];
  if (!mpsi_material_has_start(first->material)) return MPS_OK;
  for (int32_t c = 0; c < 2 * grid->dim; c++) stress[c] = p->s[c][k];
  for (int32_t h = 0; h < mps_material_history_count(first->material) && h < MOST; h++)
    if (first->history[h]) history[h] = first->history[h][k];
  if (mpsi_material_check_state(first->material, grid->dim, stress, history, reason, sizeof reason))
    return MPS_OK;
  return mpsi_fail(context, function, MPS_ERROR_ARGUMENT, "material: particle %lld %s",
                   (long long)p->laws.ids[k], reason);
}

mps_status mpsi_mpm_check_states(mps_context *context, const mpsi_grid *grid, const mpsi_columns *p,
                                 const char *function, int32_t number, int64_t begin, int64_t end) {
  const mps_material *material = p->laws.law[number].material;
  mpsi_first_state first;
  if (!mpsi_material_has_start(material)) return MPS_OK;
  mpsi_mpm_find_state(p, material, &first);
  for (int64_t k = begin; k < end; k++)
    if ((p->law ? p->law[k] : 0) == number)
      MPSI_TRY(mpsi_mpm_check_state(context, grid, p, function, &first, k));
  return MPS_OK;
}
