/* dynamics.c - definitions of explicit elastodynamics. SPDX-License-Identifier: BSD-3-Clause */
#include "table.h"

#include <mps/dynamics.h>
#include <mps/experimental/dynamics_predict.h>

/* clang-format off */

#define DYNAMICS(X, S) \
  X(S, INT,     integrator,    1, "",     ONE_OF(MPS_DYNAMICS_INTEGRATOR_, "VERLET|LEAPFROG|EULER"), 0,                SAME) \
  X(S, INT,     rotation,      1, "",     ONE_OF(MPS_DYNAMICS_ROTATION_, "MEAN_MATRIX|MEAN_ANGLE"),  0,                SAME) \
  X(S, INT,     damping,       1, "",     ONE_OF(MPS_DYNAMICS_DAMPING_, "PAIR|PARTICLE"),            0,                SAME) \
  X(S, REAL,    dt,            1, "s",    OR_NAN IN(1e-12, 1e9),                                     UNSET,            SAME) \
  X(S, REAL,    courant,       1, "",     ABOVE(0, 1),                                               0.9,              SAME) \
  X(S, REAL,    radius_ratio,  1, "",     ABOVE(1, 4),                                               1.5,              OWN) \
  X(S, REAL,    f1,            1, "Hz",   IN(1e-20, 1e9),                                            1,                SAME) \
  X(S, REAL,    f2,            1, "Hz",   IN(1e-20, 1e9),                                            14,               SAME) \
  X(S, REAL,    period_x,      1, "m",    OR_NAN ABOVE(0, 1e300),                                    UNSET,            SAME) \
  X(S, REAL,    divergence,    1, "m/s2", OR_NAN ABOVE(0, 1e300),                                    UNSET,            SAME) \
  X(S, REAL,    measure,       1, "m",    IN(1e-9, 1e9),                                             1,                SAME) \
  X(S, REAL,    gravity,       3, "m/s2", IN(-1e6, 1e6),                                             0,                SAME) \
  X(S, INT,     watch_damping, 1, "",     YES_NO,                                           0,                SAME) \
  X(S, INT,     reserved,      1, "",     RESERVED,                                                  0,                OWN) \
  X(S, ADDRESS, material,      1, "",     ANY,                                                       NULL,             OWN) \
  X(S, ADDRESS, kernel,        1, "",     ANY,                                                       NULL,             OWN) \
  X(S, ADDRESS, domain,        1, "",     ANY,                                                       NULL,             OWN)

#define DYNAMICS_RULES(X, S) \
  X(S, gravity, COMPONENT(2) RESERVED, ALWAYS, BECAUSE("the body is in the plane"))
MPSI_DEFINITION_RULED(mps_dynamics_def, "dynamics", DYNAMICS, DYNAMICS_RULES)

#define DYNAMICS_BOUNDARY(X, S) \
  X(S, INT,     kind,              1, "",      ONE_OF(MPS_BOUNDARY_, "HELD|DRIVEN|||ABSORBING"), 0,     OWN) \
  X(S, ADDRESS, ids,               1, "",      ANY,                                              NULL,  OWN) \
  X(S, LONG,    id_count,          1, "",      ANY,                                              0,     OWN) \
  X(S, REAL,    lower,             3, "m",     ANY,                                              UNSET, OWN) \
  X(S, REAL,    upper,             3, "m",     ANY,                                              UNSET, OWN) \
  X(S, INT,     all,               1, "",      YES_NO,                                  0,     OWN) \
  X(S, INT,     reserved,          1, "",      RESERVED,                                         0,     OWN) \
  X(S, BITS,    dofs,              1, "",      ANY,                                              0,     OWN) \
  X(S, INT,     axis,              1, "",      NAMES("x|y"),                                     1,     OWN) \
  X(S, ADDRESS, signal,            3, "",      ANY,                                              NULL,  OWN) \
  X(S, REAL,    factor,            3, "",      FINITE,                                           1,     OWN) \
  X(S, REAL,    density,           1, "kg/m3", OR_NAN IN(1e-6, 1e9),                             UNSET, OWN) \
  X(S, REAL,    shear_velocity,    1, "m/s",   OR_NAN IN(1e-6, 1e9),                             UNSET, OWN) \
  X(S, REAL,    pressure_velocity, 1, "m/s",   OR_NAN IN(1e-6, 1e9),                             UNSET, OWN)
#define DYNAMICS_BOUNDARY_RULES(X, S) \
  X(S, dofs, NOT_GIVEN, IS(S, kind, MPS_BOUNDARY_ABSORBING)) \
  X(S, signal, NOT_GIVEN, IS(S, kind, MPS_BOUNDARY_HELD), BECAUSE("make its kind MPS_BOUNDARY_DRIVEN")) \
  X(S, signal, GIVEN, IS(S, kind, MPS_BOUNDARY_DRIVEN)) \
  X(S, signal, COMPONENT(2) NOT_GIVEN, IN_PLANE) \
  X(S, factor, UNUSED, WITHOUT(S, signal), FACTOR_OF_SIGNALS) \
  X(S, axis, UNUSED, ISNT(S, kind, MPS_BOUNDARY_ABSORBING)) \
  X(S, density, UNUSED, ISNT(S, kind, MPS_BOUNDARY_ABSORBING)) \
  X(S, shear_velocity, UNUSED, ISNT(S, kind, MPS_BOUNDARY_ABSORBING)) \
  X(S, pressure_velocity, UNUSED, ISNT(S, kind, MPS_BOUNDARY_ABSORBING))
MPSI_DEFINITION_RULED(mps_dynamics_boundary_def, "dynamics_boundary", DYNAMICS_BOUNDARY, DYNAMICS_BOUNDARY_RULES)

#define DYNAMICS_LOAD(X, S) \
  X(S, INT,     kind,         1, "",     ONE_OF(MPS_DYNAMICS_LOAD_, "TRACTION|BODY"), 0,     OWN) \
  X(S, ADDRESS, ids,          1, "",     ANY,                                         NULL,  OWN) \
  X(S, LONG,    id_count,     1, "",     ANY,                                         0,     OWN) \
  X(S, REAL,    lower,        3, "m",    ANY,                                         UNSET, OWN) \
  X(S, REAL,    upper,        3, "m",    ANY,                                         UNSET, OWN) \
  X(S, INT,     all,          1, "",     YES_NO,                             0,     OWN) \
  X(S, INT,     reserved,     1, "",     RESERVED,                                    0,     OWN) \
  X(S, REAL,    traction,     3, "Pa",   FINITE,                                      0,     OWN) \
  X(S, REAL,    acceleration, 3, "m/s2", FINITE,                                      0,     OWN) \
  X(S, REAL,    area,         1, "m2",   OR_NAN IN(1e-30, 1e30),                      UNSET, OWN) \
  X(S, ADDRESS, signal,       3, "",     ANY,                                         NULL,  OWN) \
  X(S, REAL,    factor,       3, "",     FINITE,                                      1,     OWN)
#define DYNAMICS_LOAD_RULES(X, S) \
  X(S, traction, COMPONENT(2) IN(0, 0), IN_PLANE) \
  X(S, acceleration, COMPONENT(2) IN(0, 0), IN_PLANE) \
  X(S, signal, COMPONENT(2) NOT_GIVEN, IN_PLANE) \
  X(S, traction, UNUSED, IS(S, kind, MPS_DYNAMICS_LOAD_BODY)) \
  X(S, area, UNUSED, IS(S, kind, MPS_DYNAMICS_LOAD_BODY)) \
  X(S, acceleration, UNUSED, IS(S, kind, MPS_DYNAMICS_LOAD_TRACTION))
MPSI_DEFINITION_RULED(mps_dynamics_load_def, "dynamics_load", DYNAMICS_LOAD, DYNAMICS_LOAD_RULES)

#define DYNAMICS_PREDICT(X, S) \
  X(S, INT,  integrator,        1, "",    ONE_OF(MPS_DYNAMICS_INTEGRATOR_, "VERLET|LEAPFROG"), 0, OWN) \
  X(S, REAL, spacing,           1, "m",   IN(1e-9, 1e9),                                    UNSET, OWN) \
  X(S, REAL, shear_velocity,    1, "m/s", IN(1e-6, 1e9),                                    UNSET, OWN) \
  X(S, REAL, pressure_velocity, 1, "m/s", IN(1e-6, 1e9),                                    UNSET, OWN) \
  X(S, REAL, damping,           1, "",    IN(0, 1000),                                      0,     OWN) \
  X(S, REAL, f1,                1, "Hz",  IN(1e-20, 1e9),                                   1,     OWN) \
  X(S, REAL, f2,                1, "Hz",  IN(1e-20, 1e9),                                   14,    OWN) \
  X(S, REAL, radius_ratio,      1, "",    IN(1 + 1e-9, 4),                                  1.5,   OWN)

#define ROOT2 (1.41421356237309505 * (1 - 1e-12))
#define DYNAMICS_PREDICT_RULES(X, S) \
  X(S, pressure_velocity, AT_LEAST(S, shear_velocity, ROOT2), ALWAYS)
MPSI_DEFINITION_RULED(mps_dynamics_predict_def, "dynamics_predict", DYNAMICS_PREDICT, DYNAMICS_PREDICT_RULES)
/* clang-format on */
