/* mpm.c - definitions of WLS-MPM. SPDX-License-Identifier: BSD-3-Clause */
#include "table.h"

#include <mps/experimental/pore_water.h>
#include <mps/experimental/settle.h>
#include <mps/mpm.h>

/* clang-format off */

#define MPM(X, S) \
  X(S, INT,     geometry,        1, "",     ONE_OF(MPS_MPM_GEOMETRY_, "PLANE_STRAIN|AXISYMMETRIC|SPACE"), 0,         SAME) \
  X(S, INT,     spline,          1, "",     NAMES("cubic||quadratic|cubic"),                              0,         SAME) \
  X(S, INT,     volumetric,      1, "",     ONE_OF(MPS_MPM_VOLUMETRIC_, "BY_LAW|POINT|CELL|NODES"),       0,         SAME) \
  X(S, INT,     step_from,       1, "",     ONE_OF(MPS_MPM_STEP_FROM_, "SPEED|WAVE"),                     0,         SAME) \
  X(S, INT,     budget,          1, "",     NAMES("no energies|the energy budget"),                       0,         SAME) \
  X(S, REAL,    local_damping,   1, "",     BELOW(0, 1),                                                  0,         SAME) \
  X(S, REAL,    viscous_damping, 1, "1/s",  IN(0, 1e9),                                                   0,         SAME) \
  X(S, REAL,    cell,            1, "m",    ABOVE(0, 1e9),                                                UNSET,     SAME) \
  X(S, REAL,    origin,          3, "m",    IN(-1e9, 1e9),                                                0,         SAME) \
  X(S, REAL,    lower,           3, "m",    NUMBER,                                                       -INFINITY, SAME) \
  X(S, REAL,    upper,           3, "m",    NUMBER,                                                       INFINITY,  SAME) \
  X(S, REAL,    measure,         1, "",     OR_NAN IN(1e-9, 1e9),                                         UNSET,     SAME) \
  X(S, REAL,    gravity,         3, "m/s2", IN(-1e9, 1e9),                                                0,         SAME) \
  X(S, REAL,    dt,              1, "s",    OR_NAN IN(1e-18, 1e9),                                        UNSET,     SAME) \
  X(S, REAL,    courant,         1, "",     ABOVE(0, 1),                                                  0.5,       SAME) \
  X(S, ADDRESS, kernel,          1, "",     ANY,                                                          NULL,      OWN) \
  X(S, INT,     edge,            1, "",     ONE_OF(MPS_MPM_EDGE_, "MIRROR|FIT"),                         0,         SAME) \
  X(S, INT,     reserved,        1, "",     RESERVED,                                                     0,         OWN) \
  X(S, ADDRESS, domain,          1, "",     ANY,                                                          NULL,      OWN) \
  X(S, REAL,    flip_time,       1, "s",    OR_NAN IN(0, 1e9),                                            UNSET,     SAME)

#define WHOLE_TURN (2.0 * 3.14159265358979323846 * (1.0 + 1e-12))
#define MPM_RULES(X, S) \
  X(S, lower,   FIRST(2) LESS(S, upper),     ALWAYS) \
  X(S, lower,   COMPONENT(2) LESS(S, upper), IS(S, geometry, MPS_MPM_GEOMETRY_SPACE)) \
  X(S, measure, OR_NAN IN(1e-9, WHOLE_TURN), IS(S, geometry, MPS_MPM_GEOMETRY_AXISYMMETRIC), BECAUSE("the angle of the sector, rad")) \
  X(S, measure, OR_NAN IN(1, 1),             IS(S, geometry, MPS_MPM_GEOMETRY_SPACE))
MPSI_DEFINITION_RULED(mps_mpm_def, "mpm", MPM, MPM_RULES)

#define MPM_BOUNDARY(X, S) \
  X(S, INT,     kind,     1, "",  ONE_OF(MPS_BOUNDARY_, "HELD|DRIVEN|ROLLER|FRICTIONAL|ABSORBING|FREE_FIELD|FREE|OPEN"), 0, OWN) \
  X(S, REAL,    lower,    3, "m", ANY,             UNSET, OWN) \
  X(S, REAL,    upper,    3, "m", ANY,             UNSET, OWN) \
  X(S, ADDRESS, ids,      1, "",  ANY,             NULL,  OWN) \
  X(S, LONG,    id_count, 1, "",  ANY,             0,     OWN) \
  X(S, BITS,    dofs,     1, "",  ANY,             0,     OWN) \
  X(S, INT,     all,      1, "",  YES_NO, 0,     OWN) \
  X(S, ADDRESS, signal,   3, "",  ANY,             NULL,  OWN) \
  X(S, REAL,    factor,   3, "",  FINITE,          1,     OWN) \
  X(S, REAL,    friction, 1, "",  IN(0, 1e3),      0,     OWN) \
  X(S, REAL,    settle,   1, "s", IN(0, DBL_MAX),  0,     OWN)
#define MPM_BOUNDARY_RULES(X, S) \
  X(S, friction, NOT_GIVEN, ISNT(S, kind, MPS_BOUNDARY_FRICTIONAL), BECAUSE("make it MPS_BOUNDARY_FRICTIONAL")) \
  X(S, signal, NOT_GIVEN, IS(S, kind, MPS_BOUNDARY_HELD), BECAUSE("make its kind MPS_BOUNDARY_DRIVEN")) \
  X(S, signal, NOT_GIVEN, IS(S, kind, MPS_BOUNDARY_FREE, MPS_BOUNDARY_OPEN, MPS_BOUNDARY_FREE_FIELD)) \
  X(S, factor, UNUSED, WITHOUT(S, signal), FACTOR_OF_SIGNALS) \
  X(S, settle, UNUSED, ISNT(S, kind, MPS_BOUNDARY_ABSORBING))
MPSI_DEFINITION_RULED(mps_mpm_boundary_def, "mpm_boundary", MPM_BOUNDARY, MPM_BOUNDARY_RULES)

#define MPM_LOAD(X, S) \
  X(S, INT,     all,      1, "",   YES_NO, 0,     OWN) \
  X(S, ADDRESS, ids,      1, "",   ANY,             NULL,  OWN) \
  X(S, LONG,    id_count, 1, "",   ANY,             0,     OWN) \
  X(S, REAL,    lower,    3, "m",  ANY,             UNSET, OWN) \
  X(S, REAL,    upper,    3, "m",  ANY,             UNSET, OWN) \
  X(S, ADDRESS, area,     1, "m2", ANY,             NULL,  OWN) \
  X(S, REAL,    traction, 3, "Pa", FINITE,          0,     OWN) \
  X(S, ADDRESS, signal,   3, "",   ANY,             NULL,  OWN) \
  X(S, REAL,    factor,   3, "",   FINITE,          1,     OWN)
#define MPM_LOAD_RULES(X, S) \
  X(S, area, EACH(S, id_count, 1) FINITE, ALWAYS)
MPSI_DEFINITION_RULED(mps_mpm_load_def, "mpm_load", MPM_LOAD, MPM_LOAD_RULES)

#define MPM_SETTLE(X, S) \
  X(S, INT,  reserved,  1, "", RESERVED,             0,     OWN) \
  X(S, LONG, max_steps, 1, "", IN(1, INFINITY),      20000, SAME) \
  X(S, REAL, tolerance, 1, "", OR_NAN BETWEEN(0, 1), UNSET, SAME)
MPSI_DEFINITION(mps_mpm_settle_def, "mpm_settle", MPM_SETTLE)

#define PORE_WATER(X, S) \
  X(S, INT,  scheme,       1, "",      ONE_OF(MPS_PORE_SCHEME_, "EXPLICIT|IMPLICIT"), 0,        SAME) \
  X(S, REAL, porosity,     1, "",      OR_NAN BETWEEN(0, 1),                          UNSET,    SAME) \
  X(S, REAL, permeability, 1, "m/s",   OR_NAN ABOVE(0, 1),                            UNSET,    SAME) \
  X(S, REAL, bulk,         1, "Pa",    OR_NAN ABOVE(0, 1e15),                         UNSET,    SAME) \
  X(S, REAL, density,      1, "kg/m3", ABOVE(0, 1e6),                                 1000,     SAME) \
  X(S, REAL, exponent,     1, "",      IN(0, 100),                                    0,        SAME) \
  X(S, REAL, ratio_slope,  1, "",      IN(1e-3, INFINITY),                            INFINITY, SAME)
MPSI_DEFINITION(mps_pore_water_def, "pore_water", PORE_WATER)

#define PORE_FACE(X, S) \
  X(S, INT,  kind,     1, "",   ONE_OF(MPS_PORE_FACE_, "IMPERVIOUS|DRAINED"), 0,         SAME) \
  X(S, BITS, sides,    1, "",   IN(0, 63),                                    0,         SAME) \
  X(S, INT,  at_rest,  1, "",   YES_NO,                                       0,         SAME) \
  X(S, REAL, lower,    3, "m",  NUMBER,                                       -INFINITY, SAME) \
  X(S, REAL, upper,    3, "m",  NUMBER,                                       INFINITY,  SAME) \
  X(S, REAL, pressure, 1, "Pa", IN(-1e15, 1e15),                              0,         SAME)

#define PORE_FACE_RULES(X, S) \
  X(S, sides,    IN(0, 15),                    IN_PLANE) \
  X(S, pressure, NOT_GIVEN,                    IS(S, kind, MPS_PORE_FACE_IMPERVIOUS)) \
  X(S, at_rest,  NOT_GIVEN,                    IS(S, kind, MPS_PORE_FACE_IMPERVIOUS)) \
  X(S, lower,    LESS(S, upper),               ALWAYS)
MPSI_DEFINITION_RULED(mps_pore_face_def, "pore_face", PORE_FACE, PORE_FACE_RULES)
/* clang-format on */
