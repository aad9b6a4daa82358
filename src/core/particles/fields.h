/* fields.h - the one table of particle fields. Allocation, views, docs/fields.md (a test compares
 * them) and other descriptions of fields follow from it.
 *
 * X(name, type, components, unit, meaning, written by, valid, since)
 * type: F64 or I64. components: a number, or one of the codes below for counts that depend on the
 * dimension of the set. since: the release that has the field first; from there on name, type,
 * components, unit and release stay as they are (the tests abi/released-*-tables).
 * SPDX-License-Identifier: BSD-3-Clause */
#pragma once

#include <mps/experimental/soil.h>
#include <stdint.h>

#define MPSI_PER_DIM 0       /* 2 in 2D, 3 in 3D */
#define MPSI_PER_ROTATION -1 /* 1 in 2D, 3 in 3D */
#define MPSI_PER_FREEDOM -2  /* displacements and rotations: 3 in 2D, 6 in 3D */
#define MPSI_PER_STRESS -3   /* 4 in 2D (xx, yy, zz, xy), 6 in 3D (and zx, yz) */
#define MPSI_PER_GRADIENT -4 /* tensor, in 2D with the hoop component: 5 in 2D, 9 in 3D */

/* clang-format off */
#define MPSI_FIELD_TABLE(X)                                                                        \
  X(id, I64, 1, "-", "number of the particle, of no other one before or after, never changes",  \
    "the library (the caller only reads)", "always", 1.0)                                               \
  X(position, F64, MPSI_PER_DIM, "m", "present position",                                          \
    "fills and append; solvers", "always", 1.0)                                                         \
  X(reference, F64, MPSI_PER_DIM, "m", "position in the unstrained lattice",                       \
    "solvers", "after creation of a solver", 1.0)                                                       \
  X(group, I64, 1, "-", "the caller's number of the material or layer",                            \
    "the caller", "as written", 1.0)                                                                    \
  X(free_field, I64, 1, "-", "0 ordinary, 1 left, 2 right free-field column",                      \
    "the library, with a free-field column", "after adding a free-field column", 1.0)                   \
  X(density, F64, 1, "kg/m3", "mass density",                                                      \
    "the caller", "as written", 1.0)                                                                    \
  X(shear_velocity, F64, 1, "m/s", "S wave velocity Vs",                                           \
    "the caller", "as written", 1.0)                                                                    \
  X(pressure_velocity, F64, 1, "m/s", "P wave velocity Vp",                                        \
    "the caller", "as written", 1.0)                                                                    \
  X(damping, F64, 1, "-", "damping ratio h",                                                       \
    "the caller", "as written", 1.0)                                                                    \
  X(displacement, F64, MPSI_PER_DIM, "m", "displacement from the reference position",              \
    "the caller (initial state); solvers", "after a step or a run", 1.0)                                \
  X(rotation, F64, MPSI_PER_ROTATION, "rad", "rotation, anticlockwise",                            \
    "the caller (initial state); solvers", "after a step or a run", 1.0)                                \
  X(velocity, F64, MPSI_PER_DIM, "m/s", "velocity",                                                \
    "the caller (initial state); solvers", "after a step or a run", 1.0)                                \
  X(spin, F64, MPSI_PER_ROTATION, "rad/s", "angular velocity, anticlockwise",                      \
    "the caller (initial state); solvers", "after a step or a run", 1.0)                                \
  X(young, F64, 1, "Pa", "Young's modulus",                                                        \
    "the caller", "as written", 1.0)                                                                    \
  X(poisson, F64, 1, "-", "Poisson's ratio",                                                       \
    "the caller", "as written", 1.0)                                                                    \
  X(reaction, F64, MPSI_PER_DIM, "N", "force of the supports on the particle",                     \
    "implicit elasticity; explicit dynamics, where the set has it", "after a solution or a step", 1.0)                                           \
  X(strain, F64, MPSI_PER_STRESS, "-",                                                             \
    "strain xx, yy, zz, xy; 3D: and zx, yz (shear: tensor components)",                            \
    "implicit elasticity", "after mps_elastic_update_stress", 1.0)                                             \
  X(stress, F64, MPSI_PER_STRESS, "Pa",                                                            \
    "stress xx, yy, zz, xy; 3D: and zx, yz; tension positive",                                     \
    "the caller (initial state of WLS-MPM); solvers", "after a step or mps_elastic_update_stress", 1.0)        \
  X(principal, F64, 3, "Pa", "principal stresses, largest first",                                  \
    "implicit elasticity", "after mps_elastic_update_stress", 1.0)                                             \
  X(von_mises, F64, 1, "Pa", "von Mises stress",                                                   \
    "implicit elasticity", "after mps_elastic_update_stress", 1.0)                                             \
  X(acceleration, F64, MPSI_PER_DIM, "m/s2", "acceleration",                                       \
    "solvers", "after a step or a run", 1.0)                                                            \
  X(pressure, F64, 1, "Pa", "pressure",                                                            \
    "solvers", "after a step or a run", 1.0)                                                            \
  X(reduced_pressure, F64, 1, "Pa", "pressure plus density g (height - reference level)",           \
    "fluid", "after a step or a run", 1.0)                                                              \
  X(reduced_pressure_old, F64, 1, "Pa", "reduced pressure of the previous step",                   \
    "fluid", "after a step or a run; part of a checkpoint", 1.0)                                        \
  X(free_surface, I64, 1, "-", "0 inside the fluid, 1 at its free surface, 2 apart from the rest",  \
    "fluid", "after a step or a run", 1.0)                                                              \
  X(surface_rise, F64, 1, "m",                                                                     \
    "height of the free surface above the particle; 0 where it has none", "fluid",               \
    "after a step or a run; part of a checkpoint", 1.0)                                                 \
  X(displacement_old, F64, MPSI_PER_DIM, "m", "displacement of the previous step",                 \
    "explicit dynamics", "after a step or a run; part of a checkpoint", 1.0)                            \
  X(rotation_old, F64, MPSI_PER_ROTATION, "rad", "rotation of the previous step",                  \
    "explicit dynamics", "after a step or a run; part of a checkpoint", 1.0)                            \
  X(restoring_old, F64, MPSI_PER_FREEDOM, "m/s, rad/s",                                          \
    "M^-1 times beta times the restoring force of the previous step: displacements, then rotations",          \
    "explicit dynamics", "after a step or a run; part of a checkpoint", 1.0)                            \
  X(mass, F64, 1, "kg", "mass, of the solver's measure",      \
    "WLS-MPM", "after creation of the solver", 1.0)                                                     \
  X(volume, F64, 1, "m3", "volume, of the solver's measure",  \
    "the caller (initial state; 0: from the spacing); WLS-MPM", "after a step or a run", 1.0)           \
  X(velocity_gradient, F64, MPSI_PER_GRADIENT, "1/s", "dv_i/dx_j row by row, in 2D then the hoop strain rate v_r/r", \
    "the caller (initial state); WLS-MPM", "after a step or a run", 1.0)                                \
  X(volume_ratio, F64, 1, "-", "volume over the volume without stress, V/V0",                      \
    "the caller (initial state; 0: 1); WLS-MPM with a law that reads it", "after a step or a run", 1.0) \
  X(deformation_gradient, F64, MPSI_PER_GRADIENT, "-", "F row by row, in 2D then the hoop or out-of-plane stretch", \
    "the caller (initial state; all 0: no deformation); WLS-MPM with a law that reads it", "after a step or a run", 1.0) \
  X(external_force, F64, MPSI_PER_DIM, "N", "force on the particle, such as another code computes", \
    "the caller", "as written; solvers read it in each step", 1.0) \
  X(body_acceleration, F64, MPSI_PER_DIM, "m/s2", "acceleration by forces on the particle's mass, besides gravity", \
    "the caller", "as written; WLS-MPM reads it in each step", 1.0) \
  X(temperature, F64, 1, "K", "temperature", \
    "the caller", "as written; the laws of WLS-MPM read it in each step if it is there at creation", 1.0) \
  X(plastic_strain, F64, 1, "-", "sum of sqrt(2/3 de:de) over the plastic deviatoric strain increments", \
    "WLS-MPM with a plastic law of the library", "after a step or a run", 1.0)                            \
  X(opening, F64, 1, "-", "volume strain of the gap between grains that were drawn apart", \
    "WLS-MPM with a frictional law of the library", "after a step or a run", 1.0)                         \
  X(preconsolidation, F64, 1, "Pa", "pc of Cam-Clay: largest p of the yield surface", \
    "the caller (initial state; 0: of the law); WLS-MPM with Cam-Clay", "after a step or a run", 1.0)     \
  X(void_ratio, F64, 1, "-", "volume of the pores over that of the grains, e", \
    "the caller (initial state; 0: of the law); WLS-MPM with Cam-Clay", "after a step or a run", 1.0)     \
  X(pore_pressure, F64, 1, "Pa", "pressure of the water in the pores", \
    "the caller (initial state); WLS-MPM with pore water", "after a step or a run", 1.0) \
  X(pore_pressure_mean, F64, 1, "Pa", "mean of pore_pressure over some 32 steps, of which implicit pressures need the forces", \
    "WLS-MPM with implicit pressures of pore water", "after a step or a run", 1.0) \
  X(pore_pressure_gradient, F64, MPSI_PER_DIM, "Pa/m", "gradient of pore_pressure", \
    "WLS-MPM with pore water", "after a step or a run", 1.0) \
  X(porosity, F64, 1, "-", "volume of the pores over all volume", \
    "the caller (initial state); WLS-MPM with pore water", "after a step or a run", 1.0) \
  X(permeability, F64, 1, "m/s", "permeability of the ground to water, at the present porosity", \
    "the caller (initial state); WLS-MPM with pore water that flows", "after a step or a run", 1.0) \
  X(seepage, F64, MPSI_PER_DIM, "m/s", "flow of pore water relative to the grains, per area of ground", \
    "WLS-MPM with pore water, where the set has it", "after a step or a run", 1.0) \
  X(stiffness_factor, F64, 1, "-", "factor of E of the particle's law; 0: 1", \
    "the caller; a law of mps_material_create_by_field reads it", "as written", 1.0)                      \
  X(strength_factor, F64, 1, "-", "factor of the strengths of the particle's law; 0: 1", \
    "the caller; a law of mps_material_create_by_field reads it", "as written", 1.0)                      \
  X(material, I64, 1, "-", "number of the law: 0 that of creation, then in the order of mps_mpm_set_material", \
    "WLS-MPM (the caller only reads)", "after mps_mpm_set_material", 1.0)
/* clang-format on */

/* Allowed values of a field of the table: X(name, lower, upper), both allowed. Fields that are not
 * listed take every value up to MPSI_LARGEST in magnitude. 0 stands for "not set yet" where a
 * solver needs more. */
#define MPSI_LARGEST 1e100
#define MPSI_FIELD_RANGES(X)                                                                       \
  X(position, -MPSI_FARTHEST, MPSI_FARTHEST)                                                       \
  X(reference, -MPSI_FARTHEST, MPSI_FARTHEST)                                                      \
  X(displacement, -MPSI_FARTHEST, MPSI_FARTHEST)                                                   \
  X(velocity, -3e8, 3e8)                                                                           \
  X(density, 0.0, 1e12)                                                                            \
  X(shear_velocity, 0.0, 3e8)                                                                      \
  X(pressure_velocity, 0.0, 3e8)                                                                   \
  X(damping, 0.0, 1e6)                                                                             \
  X(preconsolidation, 0.0, 1e18)                                                                   \
  X(stiffness_factor, 0.0, 1e9)                                                                    \
  X(strength_factor, 0.0, 1e9)                                                                     \
  X(void_ratio, 0.0, 1e3)                                                                          \
  X(young, 0.0, 1e24)                                                                              \
  X(poisson, -1.0, 0.5)                                                                            \
  X(mass, 0.0, 1e48)                                                                               \
  X(volume, 0.0, 1e36)                                                                             \
  X(porosity, 0.0, 1.0)                                                                            \
  X(permeability, 0.0, 1.0)                                                                        \
  X(volume_ratio, 0.0, 1e12)

/* Number of components in a set of dimension `dim`, from the table's number or code. */
static inline int32_t mpsi_field_components(int32_t code, int32_t dim) {
  const int32_t rotations = dim == 2 ? 1 : 3;
  if (code == MPSI_PER_DIM) return dim;
  if (code == MPSI_PER_ROTATION) return rotations;
  if (code == MPSI_PER_FREEDOM) return dim + rotations;
  if (code == MPSI_PER_STRESS) return 2 * dim;
  if (code == MPSI_PER_GRADIENT) return dim == 2 ? 5 : 9;
  return code;
}
