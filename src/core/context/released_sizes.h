/* released_sizes.h - the size that each definition struct had at its first release. Create and init
 * functions accept every size from that on; what a smaller struct lacks has its default.
 * Written by scripts/update-sizes: a size changes no more once its version is released.
 *
 * X(struct, init function, version of the first release, bytes where pointers have 64 bits)
 * SPDX-License-Identifier: BSD-3-Clause */
#ifndef MPSI_RELEASED_SIZES_H
#define MPSI_RELEASED_SIZES_H

/* clang-format off */
#define MPSI_RELEASED_SIZES(X) \
  X(mps_absorber_def, mps_absorber_def_init, "0.3", 72) \
  X(mps_body_def, mps_body_def_init, "0.3", 176) \
  X(mps_body_motion, mps_body_motion_init, "0.3", 104) \
  X(mps_checkpoint, mps_checkpoint_init, "0.3", 112) \
  X(mps_consolidation_def, mps_consolidation_def_init, "0.3", 72) \
  X(mps_contact_def, mps_contact_def_init, "0.3", 96) \
  X(mps_context_def, mps_context_def_init, "0.3", 104) \
  X(mps_coupling_def, mps_coupling_def_init, "0.3", 64) \
  X(mps_domain_def, mps_domain_def_init, "0.3", 112) \
  X(mps_dynamics_boundary_def, mps_dynamics_boundary_def_init, "0.3", 152) \
  X(mps_dynamics_def, mps_dynamics_def_init, "0.3", 112) \
  X(mps_dynamics_load_def, mps_dynamics_load_def_init, "0.3", 176) \
  X(mps_dynamics_predict_def, mps_dynamics_predict_def_init, "0.3", 64) \
  X(mps_elastic_boundary_def, mps_elastic_boundary_def_init, "0.3", 160) \
  X(mps_elastic_def, mps_elastic_def_init, "0.3", 104) \
  X(mps_elastic_load_def, mps_elastic_load_def_init, "0.3", 120) \
  X(mps_elastic_motion_def, mps_elastic_motion_def_init, "0.3", 96) \
  X(mps_elastic_solver_def, mps_elastic_solver_def_init, "0.3", 40) \
  X(mps_eurotop_def, mps_eurotop_def_init, "0.3", 104) \
  X(mps_fluid_boundary_def, mps_fluid_boundary_def_init, "0.3", 104) \
  X(mps_fluid_contact_def, mps_fluid_contact_def_init, "0.3", 16) \
  X(mps_fluid_def, mps_fluid_def_init, "0.3", 112) \
  X(mps_fluid_load_def, mps_fluid_load_def_init, "0.3", 168) \
  X(mps_fluid_rock_def, mps_fluid_rock_def_init, "0.3", 72) \
  X(mps_fluid_solver_def, mps_fluid_solver_def_init, "0.3", 56) \
  X(mps_geostatic_def, mps_geostatic_def_init, "0.3", 80) \
  X(mps_goda_def, mps_goda_def_init, "0.3", 128) \
  X(mps_material_block, mps_material_block_init, "0.3", 312) \
  X(mps_material_cam_clay_def, mps_material_cam_clay_def_init, "0.3", 72) \
  X(mps_material_cyclic_sand_def, mps_material_cyclic_sand_def_init, "0.3", 112) \
  X(mps_material_drucker_prager_def, mps_material_drucker_prager_def_init, "0.3", 56) \
  X(mps_material_mohr_coulomb_def, mps_material_mohr_coulomb_def_init, "0.3", 112) \
  X(mps_material_newtonian_def, mps_material_newtonian_def_init, "0.3", 32) \
  X(mps_material_small_strain_def, mps_material_small_strain_def_init, "0.3", 48) \
  X(mps_material_umat_def, mps_material_umat_def_init, "0.3", 104) \
  X(mps_material_user_def, mps_material_user_def_init, "0.3", 104) \
  X(mps_material_von_mises_def, mps_material_von_mises_def_init, "0.3", 80) \
  X(mps_mpm_boundary_def, mps_mpm_boundary_def_init, "0.3", 144) \
  X(mps_mpm_def, mps_mpm_def_init, "0.3", 200) \
  X(mps_mpm_load_def, mps_mpm_load_def_init, "0.3", 104) \
  X(mps_mpm_settle_def, mps_mpm_settle_def_init, "0.3", 24) \
  X(mps_neighbours_def, mps_neighbours_def_init, "0.3", 24) \
  X(mps_overtopping_def, mps_overtopping_def_init, "0.3", 72) \
  X(mps_particles_def, mps_particles_def_init, "0.3", 40) \
  X(mps_pore_face_def, mps_pore_face_def_init, "0.3", 72) \
  X(mps_pore_solver_def, mps_pore_solver_def_init, "0.3", 48) \
  X(mps_pore_water_def, mps_pore_water_def_init, "0.3", 56) \
  X(mps_recorder_def, mps_recorder_def_init, "0.3", 40) \
  X(mps_sainflou_def, mps_sainflou_def_init, "0.3", 48) \
  X(mps_separation_def, mps_separation_def_init, "0.3", 88) \
  X(mps_signal_record_def, mps_signal_record_def_init, "0.3", 32) \
  X(mps_table_def, mps_table_def_init, "0.3", 24) \
  X(mps_waves_def, mps_waves_def_init, "0.3", 184)
/* clang-format on */

/* MPSI_RELEASED_<struct>: its size. */
enum {
#define MPSI_RELEASED_ENTRY(type, init, version, size) MPSI_RELEASED_##type = (size),
  MPSI_RELEASED_SIZES(MPSI_RELEASED_ENTRY)
#undef MPSI_RELEASED_ENTRY
};

#endif
