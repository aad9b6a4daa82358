/* released_sizes.h - the size that each definition struct had at its first release. Create and init
 * functions accept every size from that on; what a smaller struct lacks has its default.
 * Written by scripts/update-sizes: a size changes no more once its version is released.
 *
 * X(struct, version of the first release, bytes where pointers have 64 bits)
 * SPDX-License-Identifier: BSD-3-Clause */
#pragma once

/* clang-format off */
#define MPSI_RELEASED_SIZES(X) \
  X(mps_absorber_def, "0.3", 72) \
  X(mps_body_def, "0.3", 176) \
  X(mps_body_motion, "0.3", 104) \
  X(mps_checkpoint, "0.3", 112) \
  X(mps_consolidation_def, "0.3", 72) \
  X(mps_contact_def, "0.3", 96) \
  X(mps_context_def, "0.3", 144) \
  X(mps_coupling_def, "0.3", 64) \
  X(mps_domain_def, "0.3", 112) \
  X(mps_dynamics_boundary_def, "0.3", 160) \
  X(mps_dynamics_def, "0.3", 112) \
  X(mps_dynamics_load_def, "0.3", 184) \
  X(mps_dynamics_predict_def, "0.3", 64) \
  X(mps_elastic_boundary_def, "0.3", 160) \
  X(mps_elastic_def, "0.3", 104) \
  X(mps_elastic_load_def, "0.3", 176) \
  X(mps_elastic_motion_def, "0.3", 96) \
  X(mps_eurotop_def, "0.3", 104) \
  X(mps_fluid_boundary_def, "0.3", 104) \
  X(mps_fluid_contact_def, "0.3", 16) \
  X(mps_fluid_def, "0.3", 112) \
  X(mps_fluid_load_def, "0.3", 168) \
  X(mps_fluid_rock_def, "0.3", 72) \
  X(mps_geostatic_def, "0.3", 80) \
  X(mps_goda_def, "0.3", 128) \
  X(mps_linear_solver_def, "1.0", 64) \
  X(mps_material_block, "0.3", 312) \
  X(mps_material_cam_clay_def, "0.3", 72) \
  X(mps_material_cyclic_sand_def, "0.3", 128) \
  X(mps_material_drucker_prager_def, "0.3", 72) \
  X(mps_material_mohr_coulomb_def, "0.3", 128) \
  X(mps_material_newtonian_def, "0.3", 32) \
  X(mps_material_small_strain_def, "0.3", 48) \
  X(mps_material_umat_def, "0.3", 120) \
  X(mps_material_user_def, "0.3", 112) \
  X(mps_material_von_mises_def, "0.3", 80) \
  X(mps_mpm_boundary_def, "0.3", 144) \
  X(mps_mpm_def, "0.3", 200) \
  X(mps_mpm_load_def, "0.3", 152) \
  X(mps_mpm_settle_def, "0.3", 24) \
  X(mps_neighbours_def, "0.3", 24) \
  X(mps_overtopping_def, "0.3", 72) \
  X(mps_particles_def, "0.3", 40) \
  X(mps_pore_face_def, "0.3", 72) \
  X(mps_pore_water_def, "0.3", 56) \
  X(mps_recorder_def, "0.3", 40) \
  X(mps_sainflou_def, "0.3", 48) \
  X(mps_separation_def, "0.3", 88) \
  X(mps_signal_record_def, "0.3", 56) \
  X(mps_table_def, "0.3", 24) \
  X(mps_waves_def, "0.3", 184)
/* clang-format on */

/* MPSI_RELEASED_<struct>: its size. */
enum {
#define MPSI_RELEASED_ENTRY(type, version, size) MPSI_RELEASED_##type = (size),
  MPSI_RELEASED_SIZES(MPSI_RELEASED_ENTRY)
#undef MPSI_RELEASED_ENTRY
};
