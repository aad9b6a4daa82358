/* fluid.c - definitions of free-surface flow. SPDX-License-Identifier: BSD-3-Clause */
#include "table.h"

#include <mps/experimental/fluid_rock.h>
#include <mps/fluid.h>

/* clang-format off */

#define FLUID(X, S) \
  X(S, INT,     iterations,   1, "",      IN(1, INT32_MAX),         2000,  SAME) \
  X(S, REAL,    density,      1, "kg/m3", OR_NAN IN(1e-3, 1e6),     UNSET, SAME) \
  X(S, REAL,    viscosity,    1, "Pa s",  OR_NAN IN(0, 1e6),        UNSET, SAME) \
  X(S, REAL,    gravity,      3, "m/s2",  OF_AXIS(1) FINITE,        -9.81, SAME) \
  X(S, REAL,    level,        1, "m",     OR_NAN FINITE,            UNSET, SAME) \
  X(S, REAL,    measure,      1, "m",     IN(1e-9, 1e9),            1,     SAME) \
  X(S, REAL,    dt,           1, "s",     OR_NAN ABOVE(0, DBL_MAX), UNSET, SAME) \
  X(S, REAL,    radius_ratio, 1, "",      IN(2.6, 4),               3.1,   SAME) \
  X(S, REAL,    tolerance,    1, "",      IN(1e-14, 1e-2),          1e-05, SAME) \
  X(S, ADDRESS, domain,       1, "",      ANY,                      NULL,  OWN) \
  X(S, ADDRESS, kernel,       1, "",      ANY,                      NULL,  OWN) \
  X(S, ADDRESS, material,     1, "",      ANY,                      NULL,  OWN)

#define FLUID_RULES(X, S) \
  X(S, gravity, COMPONENT(2) RESERVED, ALWAYS, BECAUSE("the fluid is in the plane"))
MPSI_DEFINITION_RULED(mps_fluid_def, "fluid", FLUID, FLUID_RULES)

#define FLUID_BOUNDARY(X, S) \
  X(S, INT,     kind,         1, "",  ONE_OF(MPS_BOUNDARY_, "HELD|DRIVEN|ROLLER|||||OPEN"), 0,    OWN) \
  X(S, REAL,    point,        3, "m", IN(-1e12, 1e12),                                      0,    OWN) \
  X(S, REAL,    normal,       3, "",  ANY,                                                  0,    OWN) \
  X(S, ADDRESS, signal,       1, "",  ANY,                                                  NULL, OWN) \
  X(S, REAL,    factor,       1, "",  FINITE,                                               1,    OWN) \
  X(S, ADDRESS, nodes,        1, "",  ANY,                                                  NULL, OWN) \
  X(S, LONG,    node_count,   1, "",  IN(0, 1000000),                                       0,    OWN) \
  X(S, ADDRESS, corners,      1, "",  ANY,                                                  NULL, OWN) \
  X(S, LONG,    corner_count, 1, "",  OR_ZERO IN(2, 10000),                                 0,    OWN) \
  X(S, REAL, friction_factor, 1, "",  IN(0, 1e6),                                           0,    OWN)
#define FLUID_BOUNDARY_RULES(X, S) \
  X(S, signal, NOT_GIVEN, IS(S, kind, MPS_BOUNDARY_HELD), BECAUSE("make its kind MPS_BOUNDARY_DRIVEN, or MPS_BOUNDARY_ROLLER for slip")) \
  X(S, signal, NOT_GIVEN, IS(S, kind, MPS_BOUNDARY_OPEN)) \
  X(S, signal, NOT_GIVEN, WITH(S, corner_count), BECAUSE("a polyline does not move")) \
  X(S, friction_factor, NOT_GIVEN, IS(S, kind, MPS_BOUNDARY_OPEN)) \
  X(S, node_count, NOT_GIVEN, IS(S, kind, MPS_BOUNDARY_OPEN)) \
  X(S, node_count, NOT_GIVEN, WITH(S, corner_count), BECAUSE("a polyline does not move")) \
  X(S, node_count, IN(0, 1), WITH(S, signal)) \
  X(S, nodes, GIVEN, WITH(S, node_count)) \
  X(S, nodes, EACH(S, node_count, 3) IN(-1e12, 1e12), ALWAYS) \
  X(S, corners, GIVEN, WITH(S, corner_count)) \
  X(S, kind, ONE_OF(MPS_BOUNDARY_, "HELD||ROLLER"), WITH(S, corner_count)) \
  X(S, normal, COMPONENT(2) IN(0, 0), WITHOUT(S, corner_count)) \
  X(S, factor, UNUSED, WITHOUT(S, signal), FACTOR_OF_SIGNALS)
MPSI_DEFINITION_RULED(mps_fluid_boundary_def, "fluid_boundary", FLUID_BOUNDARY, FLUID_BOUNDARY_RULES)

#define FLUID_LOAD(X, S) \
  X(S, INT,     kind,         1, "",     ONE_OF(MPS_FLUID_LOAD_, "BODY|PRESSURE|DAMPING"), 0,     OWN) \
  X(S, ADDRESS, ids,          1, "",     ANY,                                              NULL,  OWN) \
  X(S, LONG,    id_count,     1, "",     ANY,                                              0,     OWN) \
  X(S, REAL,    lower,        3, "m",    ANY,                                              UNSET, OWN) \
  X(S, REAL,    upper,        3, "m",    ANY,                                              UNSET, OWN) \
  X(S, REAL,    acceleration, 3, "m/s2", IN(-1e6, 1e6),                                    0,     OWN) \
  X(S, REAL,    pressure,     1, "Pa",   IN(-1e12, 1e12),                                  0,     OWN) \
  X(S, ADDRESS, signal,       3, "",     ANY,                                              NULL,  OWN) \
  X(S, REAL,    factor,       3, "",     FINITE,                                           1,     OWN) \
  X(S, REAL,    rate,         1, "1/s",  IN(0, 1e6),                                       0,     OWN) \
  X(S, INT,     rise,         1, "",     IN(-1, 1),                                        0,     OWN) \
  X(S, INT,     all,          1, "",     YES_NO,                                  0,     OWN)
#define RISES(S) IS(S, kind, MPS_FLUID_LOAD_DAMPING), WITH(S, rise)
#define FLUID_LOAD_RULES(X, S) \
  X(S, acceleration, COMPONENT(2) IN(0, 0), IN_PLANE) \
  X(S, lower, COMPONENT(0) FINITE, RISES(S)) \
  X(S, upper, COMPONENT(0) FINITE, RISES(S)) \
  X(S, lower, COMPONENT(0) LESS(S, upper), RISES(S)) \
  X(S, acceleration, UNUSED, ISNT(S, kind, MPS_FLUID_LOAD_BODY)) \
  X(S, pressure, UNUSED, ISNT(S, kind, MPS_FLUID_LOAD_PRESSURE)) \
  X(S, rate, UNUSED, ISNT(S, kind, MPS_FLUID_LOAD_DAMPING)) \
  X(S, rise, UNUSED, ISNT(S, kind, MPS_FLUID_LOAD_DAMPING))
MPSI_DEFINITION_RULED(mps_fluid_load_def, "fluid_load", FLUID_LOAD, FLUID_LOAD_RULES)

#define FLUID_CONTACT(X, S) \
  X(S, INT, kind,     1, "", ONE_OF(MPS_BOUNDARY_, "HELD||ROLLER"),       0, SAME) \
  X(S, INT, mover,    1, "", ONE_OF(MPS_CONTACT_MOVER_, "SOLVER|OTHER"), 0, SAME) \
  X(S, INT, reserved, 1, "", RESERVED,                                   0, OWN) \
  X(S, REAL, friction_factor, 1, "", IN(0, 1e6),                         0, SAME)
MPSI_DEFINITION(mps_fluid_contact_def, "fluid_contact", FLUID_CONTACT)

#define FLUID_ROCK(X, S) \
  X(S, INT,     reserved,     1, "",     RESERVED,               0,     OWN) \
  X(S, LONG,    corner_count, 1, "",     IN(3, 10000),           0,     SAME) \
  X(S, ADDRESS, corners,      1, "m",    NEEDED,                 NULL,  OWN) \
  X(S, REAL,    porosity,     1, "",     IN(0.1, 1),             UNSET, SAME) \
  X(S, REAL,    diameter,     1, "m",    IN(1e-6, 100),          UNSET, SAME) \
  X(S, REAL,    alpha,        1, "",     IN(0, 1e6),             1000,  SAME) \
  X(S, REAL,    beta,         1, "",     IN(0, 1e3),             1.1,   SAME) \
  X(S, REAL,    KC,           1, "",     OR_NAN IN(1e-6, 1e300), UNSET, SAME) \
  X(S, REAL,    gamma,        1, "",     IN(0, 10),              0.34,  SAME) \
  X(S, REAL,    viscosity,    1, "m2/s", IN(0, 1),               1e-06, SAME)

#define FLUID_ROCK_RULES(X, S) \
  X(S, corners, EACH(S, corner_count, 3) IN(-1e12, 1e12), ALWAYS)
MPSI_DEFINITION_RULED(mps_fluid_rock_def, "fluid_rock", FLUID_ROCK, FLUID_ROCK_RULES)
/* clang-format on */
