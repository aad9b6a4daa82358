/* material.c - definitions of laws and the state of ground. SPDX-License-Identifier: BSD-3-Clause
 */
#include "table.h"

#include <mps/experimental/soil.h>
#include <mps/material.h>
#include <mps/material_law.h>
#include <mps/soil.h>

/* clang-format off */

#define RIGHT_ANGLE 1.57079632679489662
#define VOID_RATIOS 1e-3, 100 /* above those of the loosest soils */
#define MODULUS IN(MPSI_MODULI)
#define POISSON IN(MPSI_POISSONS)
#define STRENGTH OR_ZERO IN(MPSI_STRESSES)
#define ANGLE BELOW(0, RIGHT_ANGLE)

#define MATERIAL_VON_MISES(X, S) \
  X(S, BITS, reserved,       1, "",    RESERVED,               0,     OWN) \
  X(S, REAL, young,          1, "Pa",  MODULUS,                UNSET, OWN) \
  X(S, REAL, poisson,        1, "",    POISSON,                0.3,   OWN) \
  X(S, REAL, yield_stress,   1, "Pa",  IN(MPSI_STRESSES),      UNSET, OWN) \
  X(S, REAL, hardening,      1, "Pa",  STRENGTH,               0,     OWN) \
  X(S, REAL, residual,       1, "",    IN(0, 1),               1,     OWN) \
  X(S, REAL, slip,           1, "m",   OR_NAN IN(MPSI_LENGTHS), UNSET, OWN) \
  X(S, REAL, band,           1, "m",   OR_NAN IN(MPSI_LENGTHS), UNSET, OWN) \
  X(S, REAL, rate_factor,    1, "",    IN(0, 10),              0,     OWN) \
  X(S, REAL, rate_reference, 1, "1/s", ABOVE(0, 1e9),          3e-06, OWN)

#define MATERIAL_VON_MISES_RULES(X, S) \
  X(S, hardening, NOT_GIVEN, WITH(S, residual)) \
  X(S, hardening, NOT_GIVEN, WITH(S, rate_factor)) \
  X(S, slip, UNUSED, WITHOUT(S, residual)) \
  X(S, band, UNUSED, WITHOUT(S, residual)) \
  X(S, rate_reference, UNUSED, WITHOUT(S, rate_factor))
MPSI_DEFINITION_RULED(mps_material_von_mises_def, "material_von_mises", MATERIAL_VON_MISES, MATERIAL_VON_MISES_RULES)

/* Of laws of friction: flow, strength, the end of dilation. */
#define FRICTION_RULES(X, S) \
  X(S, dilation,       AT_MOST(S, friction, 1),    ALWAYS) \
  X(S, cohesion,       ABOVE(0, INFINITY),         WITHIN(S, friction, 0), BECAUSE("the material has no strength")) \
  X(S, void_ratio,     GIVEN,                      WITH(S, max_void_ratio)) \
  X(S, max_void_ratio, GIVEN,                      WITH(S, void_ratio)) \
  X(S, max_void_ratio, AT_LEAST(S, void_ratio, 1), ALWAYS)

#define MATERIAL_DRUCKER_PRAGER(X, S) \
  X(S, INT,  cone,           1, "",    ONE_OF(MPS_MATERIAL_CONE_, "PLANE_STRAIN|CIRCUMSCRIBED|INSCRIBED|EXTENSION"), 0, OWN) \
  X(S, REAL, young,          1, "Pa",  MODULUS,                UNSET,    OWN) \
  X(S, REAL, poisson,        1, "",    POISSON,                0.3,      OWN) \
  X(S, REAL, friction,       1, "rad", ANGLE,                  UNSET,    OWN) \
  X(S, REAL, dilation,       1, "rad", ANGLE,                  0,        OWN) \
  X(S, REAL, cohesion,       1, "Pa",  STRENGTH,               0,        OWN) \
  X(S, REAL, tension,        1, "Pa",  IN(0, INFINITY),        INFINITY, OWN) \
  X(S, REAL, void_ratio,     1, "",    OR_NAN IN(VOID_RATIOS), UNSET,    OWN) \
  X(S, REAL, max_void_ratio, 1, "",    OR_NAN IN(VOID_RATIOS), UNSET,    OWN)
MPSI_DEFINITION_RULED(mps_material_drucker_prager_def, "material_drucker_prager", MATERIAL_DRUCKER_PRAGER, FRICTION_RULES)

#define MATERIAL_MOHR_COULOMB(X, S) \
  X(S, BITS, reserved,          1, "",    RESERVED,                0,        OWN) \
  X(S, REAL, young,             1, "Pa",  MODULUS,                 UNSET,    OWN) \
  X(S, REAL, poisson,           1, "",    POISSON,                 0.3,      OWN) \
  X(S, REAL, friction,          1, "rad", ANGLE,                   UNSET,    OWN) \
  X(S, REAL, dilation,          1, "rad", ANGLE,                   0,        OWN) \
  X(S, REAL, cohesion,          1, "Pa",  STRENGTH,                0,        OWN) \
  X(S, REAL, tension,           1, "Pa",  IN(0, INFINITY),         INFINITY, OWN) \
  X(S, REAL, residual_friction, 1, "rad", OR_NAN ANGLE,            UNSET,    OWN) \
  X(S, REAL, residual_cohesion, 1, "Pa",  OR_NAN IN(0, 1e18),      UNSET,    OWN) \
  X(S, REAL, slip,              1, "m",   OR_NAN IN(MPSI_LENGTHS), UNSET,    OWN) \
  X(S, REAL, band,              1, "m",   OR_NAN IN(MPSI_LENGTHS), UNSET,    OWN) \
  X(S, REAL, rate_factor,       1, "",    IN(0, 10),               0,        OWN) \
  X(S, REAL, rate_reference,    1, "1/s", ABOVE(0, 1e9),           3e-06,    OWN) \
  X(S, INT,  softening,         1, "",    ONE_OF(MPS_MATERIAL_SOFTENING_, "EXPONENTIAL|LINEAR"), 0, OWN) \
  X(S, INT,  reserved_2,        1, "",    RESERVED,                0,        OWN) \
  X(S, REAL, void_ratio,        1, "",    OR_NAN IN(VOID_RATIOS),  UNSET,    OWN) \
  X(S, REAL, max_void_ratio,    1, "",    OR_NAN IN(VOID_RATIOS),  UNSET,    OWN)

#define NO_RESIDUAL(S) WITHOUT(S, residual_friction), WITHOUT(S, residual_cohesion)
#define MATERIAL_MOHR_COULOMB_RULES(X, S) \
  FRICTION_RULES(X, S) \
  X(S, residual_friction, AT_MOST(S, friction, 1),             ALWAYS) \
  X(S, residual_cohesion, AT_MOST(S, cohesion, 1),             ALWAYS) \
  X(S, residual_friction, OR_NAN BETWEEN(0, RIGHT_ANGLE),      WITHIN(S, cohesion, 0)) \
  X(S, residual_cohesion, OR_NAN ABOVE(0, INFINITY),           WITHIN(S, friction, 0)) \
  X(S, residual_cohesion, OR_NAN ABOVE(0, INFINITY),           WITHIN(S, residual_friction, 0)) \
  X(S, slip,              UNUSED,                              NO_RESIDUAL(S)) \
  X(S, band,              UNUSED,                              NO_RESIDUAL(S)) \
  X(S, softening,         UNUSED,                              NO_RESIDUAL(S)) \
  X(S, rate_factor,       UNUSED,                              WITHIN(S, cohesion, 0)) \
  X(S, rate_reference,    UNUSED,                              WITHOUT(S, rate_factor))
MPSI_DEFINITION_RULED(mps_material_mohr_coulomb_def, "material_mohr_coulomb", MATERIAL_MOHR_COULOMB, MATERIAL_MOHR_COULOMB_RULES)

#define MATERIAL_NEWTONIAN(X, S) \
  X(S, INT,  state,        1, "",     ONE_OF(MPS_MATERIAL_STATE_EQUATION_, "TAIT|LINEAR"), 0,     OWN) \
  X(S, REAL, bulk_modulus, 1, "Pa",   MODULUS,                                    UNSET, OWN) \
  X(S, REAL, viscosity,    1, "Pa s", OR_ZERO IN(MPSI_VISCOSITIES),               0,     OWN) \
  X(S, INT,  no_tension,   1, "",     YES_NO,                                     0,     OWN) \
  X(S, INT,  reserved,     1, "",     RESERVED,                                   0,     OWN)
MPSI_DEFINITION(mps_material_newtonian_def, "material_newtonian", MATERIAL_NEWTONIAN)

#define MATERIAL_CAM_CLAY(X, S) \
  X(S, INT,  lode,             1, "",   YES_NO,                   0,     OWN) \
  X(S, REAL, critical_slope,   1, "",   IN(0.05, 2.9),            UNSET, OWN) \
  X(S, REAL, compression,      1, "",   IN(1e-4, 5),              UNSET, OWN) \
  X(S, REAL, swelling,         1, "",   IN(1e-5, 5),              UNSET, OWN) \
  X(S, REAL, poisson,          1, "",   ANY,                      0.3,   OWN) \
  X(S, REAL, shear_modulus,    1, "Pa", OR_NAN MODULUS,           UNSET, OWN) \
  X(S, REAL, void_ratio,       1, "",   IN(0.01, 20),             UNSET, OWN) \
  X(S, REAL, preconsolidation, 1, "Pa", IN(1e-3, 1e12),           UNSET, OWN) \
  X(S, REAL, least_pressure,   1, "Pa", OR_NAN ABOVE(0, 1e11),    UNSET, OWN)

#define MATERIAL_CAM_CLAY_RULES(X, S) \
  X(S, swelling,       LESS(S, compression),              ALWAYS) \
  X(S, critical_slope, IN(0.05, 1.9),                     WITH(S, lode), BECAUSE("beyond, 46.2 degrees of friction, the yield surface is not convex")) \
  X(S, poisson,        IN(0, 0.49),                       WITHOUT(S, shear_modulus)) \
  X(S, least_pressure, AT_MOST(S, preconsolidation, 0.1), ALWAYS)
MPSI_DEFINITION_RULED(mps_material_cam_clay_def, "material_cam_clay", MATERIAL_CAM_CLAY, MATERIAL_CAM_CLAY_RULES)

#define MATERIAL_SMALL_STRAIN(X, S) \
  X(S, BITS, reserved,         1, "",   RESERVED,            0,     OWN) \
  X(S, REAL, shear_modulus,    1, "Pa", MODULUS,             UNSET, OWN) \
  X(S, REAL, poisson,          1, "",   POISSON,             0.3,   OWN) \
  X(S, REAL, reference_strain, 1, "",   IN(1e-7, 1),         UNSET, OWN) \
  X(S, REAL, curvature,        1, "",   IN(0.5, 1),          1,     OWN) \
  X(S, REAL, strength,         1, "Pa", OR_NAN ABOVE(0, 1e20), UNSET, OWN)

#define MATERIAL_SMALL_STRAIN_RULES(X, S) \
  X(S, strength, GIVEN, WITH(S, curvature), BECAUSE("only the backbone of curvature 1 has a limit"))
MPSI_DEFINITION_RULED(mps_material_small_strain_def, "material_small_strain", MATERIAL_SMALL_STRAIN, MATERIAL_SMALL_STRAIN_RULES)

#define MATERIAL_CYCLIC_SAND(X, S) \
  X(S, BITS, reserved,         1, "",    RESERVED,               0,      OWN) \
  X(S, REAL, young,            1, "Pa",  MODULUS,                UNSET,  OWN) \
  X(S, REAL, poisson,          1, "",    POISSON,                0.3,    OWN) \
  X(S, REAL, friction,         1, "rad", ANGLE,                  UNSET,  OWN) \
  X(S, REAL, dilation,         1, "rad", ANGLE,                  0,      OWN) \
  X(S, REAL, cohesion,         1, "Pa",  STRENGTH,               0,      OWN) \
  X(S, REAL, relative_density, 1, "",    OR_NAN IN(0.1, 1),      UNSET,  OWN) \
  X(S, REAL, blow_count,       1, "",    OR_NAN IN(1, 60),       UNSET,  OWN) \
  X(S, REAL, c1,               1, "",    OR_NAN IN(1e-4, 100),   UNSET,  OWN) \
  X(S, REAL, c2,               1, "",    OR_NAN IN(0, 100),      UNSET,  OWN) \
  X(S, REAL, c3,               1, "",    OR_NAN IN(1e-4, 100),   UNSET,  OWN) \
  X(S, REAL, c4,               1, "",    OR_NAN IN(1e-4, 100),   UNSET,  OWN) \
  X(S, REAL, threshold,        1, "",    IN(0, 0.01),            0.0001, OWN) \
  X(S, REAL, strain_limit,     1, "",    ABOVE(0, 1),            0.01,   OWN) \
  X(S, REAL, void_ratio,       1, "",    OR_NAN IN(VOID_RATIOS), UNSET,  OWN) \
  X(S, REAL, max_void_ratio,   1, "",    OR_NAN IN(VOID_RATIOS), UNSET,  OWN)

/* C1 comes from one of three. */
#define MATERIAL_CYCLIC_SAND_RULES(X, S) \
  FRICTION_RULES(X, S) \
  X(S, relative_density, GIVEN,              WITHOUT(S, blow_count), WITHOUT(S, c1)) \
  X(S, blow_count,       NOT_GIVEN,          WITH(S, relative_density)) \
  X(S, c1,               NOT_GIVEN,          WITH(S, relative_density)) \
  X(S, c1,               NOT_GIVEN,          WITH(S, blow_count)) \
  X(S, c2,               NOT_GIVEN,          WITHOUT(S, c1)) \
  X(S, c3,               NOT_GIVEN,          WITHOUT(S, c1)) \
  X(S, c2,               GIVEN,              WITH(S, c3)) \
  X(S, c3,               GIVEN,              WITH(S, c4)) \
  X(S, c4,               GIVEN,              WITH(S, c3)) \
  X(S, strain_limit,     MORE(S, threshold), ALWAYS)
MPSI_DEFINITION_RULED(mps_material_cyclic_sand_def, "material_cyclic_sand", MATERIAL_CYCLIC_SAND, MATERIAL_CYCLIC_SAND_RULES)

/* Moduli of a law of the caller's: K with G, and K + 4G/3 that may follow from them. */
#define MODULI_RULES(X, S) \
  X(S, bulk_modulus,  GIVEN, WITH(S, shear_modulus)) \
  X(S, shear_modulus, GIVEN, WITH(S, bulk_modulus)) \
  X(S, wave_modulus,  GIVEN, WITHOUT(S, bulk_modulus))

#define MATERIAL_USER(X, S) \
  X(S, INT,     history_count,     1, "",     IN(0, 1024),                  0,      OWN) \
  X(S, CALL,    update,            1, "",     NEEDED,                       NULL,   OWN) \
  X(S, ADDRESS, user,              1, "",     ANY,                          NULL,   OWN) \
  X(S, CALL,    release,           1, "",     ANY,                          NULL,   OWN) \
  X(S, ADDRESS, name,              1, "",     NEEDED,                       "law", OWN) \
  X(S, ADDRESS, history,           1, "",     ANY,                          NULL,   OWN) \
  X(S, ADDRESS, history_initial,   1, "",     ANY,                          NULL,   OWN) \
  X(S, REAL,    wave_modulus,      1, "Pa",   OR_NAN MODULUS,               UNSET,  OWN) \
  X(S, REAL,    viscosity,         1, "Pa s", OR_ZERO IN(MPSI_VISCOSITIES), 0,      OWN) \
  X(S, INT,     needs_deformation, 1, "",     YES_NO,                       0,      OWN) \
  X(S, INT,     turns_stress,      1, "",     YES_NO,                       1,      OWN) \
  X(S, REAL,    bulk_modulus,      1, "Pa",   OR_NAN MODULUS,               UNSET,  OWN) \
  X(S, REAL,    shear_modulus,     1, "Pa",   OR_NAN OR_ZERO MODULUS,       UNSET,  OWN) \
  X(S, CALL,    moduli,            1, "",     ANY,                          NULL,   OWN) \
  X(S, INT,     frictional,        1, "",     YES_NO,                       0,      OWN) \
  X(S, INT,     reserved,          1, "",     RESERVED,                     0,      OWN)

#define MATERIAL_USER_RULES(X, S) \
  X(S, history,           GIVEN,                           WITH(S, history_count)) \
  X(S, history_initial,   EACH(S, history_count, 1) FINITE, ALWAYS) \
  MODULI_RULES(X, S) \
  X(S, bulk_modulus,      GIVEN,                           WITH(S, frictional)) \
  X(S, needs_deformation, NOT_GIVEN,                       WITH(S, frictional))
MPSI_DEFINITION_RULED(mps_material_user_def, "material_user", MATERIAL_USER, MATERIAL_USER_RULES)

#define MATERIAL_UMAT(X, S) \
  X(S, INT,     statev_count,      1, "",   IN(0, 1000),             0,      OWN) \
  X(S, CALL,    umat,              1, "",   NEEDED,                  NULL,   OWN) \
  X(S, ADDRESS, user,              1, "",   ANY,                     NULL,   OWN) \
  X(S, CALL,    release,           1, "",   ANY,                     NULL,   OWN) \
  X(S, ADDRESS, name,              1, "",   NEEDED,                  "umat", OWN) \
  X(S, ADDRESS, props,             1, "",   ANY,                     NULL,   OWN) \
  X(S, INT,     props_count,       1, "",   IN(0, INT32_MAX),        0,      OWN) \
  X(S, INT,     needs_deformation, 1, "",   YES_NO,                  0,      OWN) \
  X(S, ADDRESS, statev_names,      1, "",   ANY,                     NULL,   OWN) \
  X(S, ADDRESS, statev_initial,    1, "",   ANY,                     NULL,   OWN) \
  X(S, REAL,    wave_modulus,      1, "Pa", OR_NAN MODULUS,          UNSET,  OWN) \
  X(S, REAL,    length,            1, "m",  IN(MPSI_LENGTHS),        1,      OWN) \
  X(S, REAL,    temperature,       1, "K",  FINITE,                  0,      OWN) \
  X(S, INT,     keeps_strain,      1, "",   YES_NO,                  1,      OWN) \
  X(S, INT,     reserved,          1, "",   RESERVED,                0,      OWN) \
  X(S, REAL,    bulk_modulus,      1, "Pa", OR_NAN MODULUS,          UNSET,  OWN) \
  X(S, REAL,    shear_modulus,     1, "Pa", OR_NAN OR_ZERO MODULUS,  UNSET,  OWN)

#define MATERIAL_UMAT_RULES(X, S) \
  X(S, props,          GIVEN,                           WITH(S, props_count)) \
  X(S, props,          EACH(S, props_count, 1) FINITE,  ALWAYS) \
  X(S, statev_initial, EACH(S, statev_count, 1) FINITE, ALWAYS) \
  MODULI_RULES(X, S)
MPSI_DEFINITION_RULED(mps_material_umat_def, "material_umat", MATERIAL_UMAT, MATERIAL_UMAT_RULES)

#define MATERIAL_BLOCK(X, S) \
  X(S, INT,     dim,           1, "",    NAMES("||plane|space"), 2,    OWN) \
  X(S, LONG,    count,         1, "",    IN(0, INFINITY),        0,    OWN) \
  X(S, REAL,    dt,            1, "s",   ABOVE(0, DBL_MAX),      0,    OWN) \
  X(S, REAL,    time,          1, "s",   ANY,                    0,    OWN) \
  X(S, ADDRESS, gradient,      9, "1/s", ANY,                    NULL, OWN) \
  X(S, ADDRESS, deformation,   9, "",    ANY,                    NULL, OWN) \
  X(S, ADDRESS, volume_ratio,  1, "",    NEEDED,                 NULL, OWN) \
  X(S, ADDRESS, stress,        6, "Pa",  ANY,                    NULL, OWN) \
  X(S, ADDRESS, history,       1, "",    ANY,                    NULL, OWN) \
  X(S, INT,     history_count, 1, "",    IN(0, INT32_MAX),       0,    OWN) \
  X(S, INT,     message_size,  1, "",    IN(0, INT32_MAX),       0,    OWN) \
  X(S, ADDRESS, flags,         1, "",    NEEDED,                 NULL, OWN) \
  X(S, ADDRESS, ids,           1, "",    ANY,                    NULL, OWN) \
  X(S, ADDRESS, position,      3, "m",   ANY,                    NULL, OWN) \
  X(S, ADDRESS, temperature,   1, "K",   ANY,                    NULL, OWN) \
  X(S, ADDRESS, message,       1, "",    ANY,                    NULL, OWN) \
  X(S, ADDRESS, refused,       1, "",    ANY,                    NULL, OWN)
MPSI_DEFINITION(mps_material_block, "material_block", MATERIAL_BLOCK)

#define GEOSTATIC(X, S) \
  X(S, INT,     vertical,       1, "",     IN(-1, 2),                 -1,    OWN) \
  X(S, LONG,    layer_count,    1, "",     IN(0, INFINITY),           0,     OWN) \
  X(S, ADDRESS, layers,         1, "",     ANY,                       NULL,  OWN) \
  X(S, REAL,    gravity,        1, "m/s2", IN(MPSI_ACCELERATIONS),    9.81,  OWN) \
  X(S, REAL,    surcharge,      1, "Pa",   OR_ZERO IN(MPSI_STRESSES), 0,     OWN) \
  X(S, LONG,    surface_points, 1, "",     IN(0, INT32_MAX),          0,     OWN) \
  X(S, REAL,    surface,        1, "m",    OR_NAN IN(MPSI_HEIGHTS),   UNSET, OWN) \
  X(S, ADDRESS, surface_line,   1, "",     ANY,                       NULL,  OWN) \
  X(S, CALL,    surface_level,  1, "",     ANY,                       NULL,  OWN) \
  X(S, ADDRESS, user,           1, "",     ANY,                       NULL,  OWN) \
  X(S, INT,     layer_size,     1, "",     ANY,                       0,     OWN) \
  X(S, INT,     reserved,       1, "",     RESERVED,                  0,     OWN)

#define GEOSTATIC_RULES(X, S) \
  X(S, vertical,       IN(-1, 1),        IN_PLANE) \
  X(S, surface_points, IN(2, INT32_MAX), WITH(S, surface_line)) \
  X(S, surface_line,   GIVEN,            WITH(S, surface_points)) \
  X(S, surface_line,   NOT_GIVEN,        WITH(S, surface)) \
  X(S, surface_level,  NOT_GIVEN,        WITH(S, surface)) \
  X(S, surface_level,  NOT_GIVEN,        WITH(S, surface_line))
MPSI_DEFINITION_RULED(mps_geostatic_def, "geostatic", GEOSTATIC, GEOSTATIC_RULES)

#define CONSOLIDATION(X, S) \
  X(S, INT,     reserved,        1, "",   RESERVED,                      0,     OWN) \
  X(S, REAL,    ocr,             1, "",   IN(1, 1000),                   1,     OWN) \
  X(S, REAL,    pop,             1, "Pa", OR_ZERO IN(MPSI_STRESSES),     0,     OWN) \
  X(S, REAL,    k0,              1, "",   OR_NAN IN(MPSI_STRESS_RATIOS), UNSET, OWN) \
  X(S, REAL,    critical_volume, 1, "",   OR_NAN ABOVE(1, 20),           UNSET, OWN) \
  X(S, REAL,    reference,       1, "Pa", IN(MPSI_STRESSES),             1000,  OWN) \
  X(S, LONG,    count,           1, "",   IN(0, INFINITY),               0,     OWN) \
  X(S, ADDRESS, ids,             1, "",   ANY,                           NULL,  OWN) \
  X(S, INT,     vertical,        1, "",   IN(-1, 2),                     -1,    OWN) \
  X(S, INT,     reserved_2,      1, "",   RESERVED,                      0,     OWN)

#define CONSOLIDATION_RULES(X, S) \
  X(S, vertical, IN(-1, 1), IN_PLANE)
MPSI_DEFINITION_RULED(mps_consolidation_def, "consolidation", CONSOLIDATION, CONSOLIDATION_RULES)
/* clang-format on */
