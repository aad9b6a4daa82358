/* elastic.c - definitions of implicit elasticity. SPDX-License-Identifier: BSD-3-Clause */
#include "table.h"

#include <mps/elastic.h>

/* clang-format off */

#define ELASTIC_POSITIVE 1e-30, 1e30

#define ELASTIC(X, S) \
  X(S, INT,     state,        1, "",      ONE_OF(MPS_ELASTIC_STATE_, "PLANE_STRESS|PLANE_STRAIN"), 0,     SAME) \
  X(S, INT,     solver,       1, "",      ONE_OF(MPS_ELASTIC_SOLVER_, "AUTO|LLT|LDLT|CG"),         0,     SAME) \
  X(S, INT,     ordering,     1, "",      ONE_OF(MPS_ELASTIC_ORDERING_, "BEST|AMD|METIS"),         0,     OWN) \
  X(S, REAL,    radius_ratio, 1, "",      OR_NAN ABOVE(1, 4),                                      UNSET, SAME) \
  X(S, REAL,    alpha,        1, "",      OR_NAN IN(0.03, 100),                                    1,     SAME) \
  X(S, REAL,    measure,      1, "m",     OR_NAN IN(ELASTIC_POSITIVE),                             1,     SAME) \
  X(S, REAL,    memory_limit, 1, "bytes", OR_NAN IN(0, INFINITY),                                  UNSET, OWN) \
  X(S, REAL,    tolerance,    1, "",      OR_NAN IN(1e-14, 1e-2),                                  1e-10, SAME) \
  X(S, LONG,    iterations,   1, "",      IN(0, INFINITY),                                         0,     OWN) \
  X(S, INT,     refinements,  1, "",      IN(0, 10),                                               1,     SAME) \
  X(S, INT,     blas_threads, 1, "",      IN(0, 1024),                                             0,     OWN) \
  X(S, REAL,    gravity,      3, "m/s2",  IN(-1e6, 1e6),                                           0,     SAME) \
  X(S, ADDRESS, material,     1, "",      ANY,                                                     NULL,  OWN) \
  X(S, ADDRESS, kernel,       1, "",      ANY,                                                     NULL,  OWN) \
  X(S, REAL,    bending,      1, "",      OR_NAN IN(0, 1),                                         UNSET, SAME) \
  X(S, ADDRESS, domain,       1, "",      ANY,                                                     NULL,  OWN)
MPSI_DEFINITION(mps_elastic_def, "elastic", ELASTIC)

#define ELASTIC_BOUNDARY(X, S) \
  X(S, INT,     kind,     1, "",  ONE_OF(MPS_BOUNDARY_, "HELD|DRIVEN|ROLLER"), 0,     OWN) \
  X(S, ADDRESS, ids,      1, "",  ANY,                                         NULL,  OWN) \
  X(S, LONG,    id_count, 1, "",  ANY,                                         0,     OWN) \
  X(S, REAL,    lower,    3, "m", ANY,                                         UNSET, OWN) \
  X(S, REAL,    upper,    3, "m", ANY,                                         UNSET, OWN) \
  X(S, BITS,    dofs,     1, "",  ANY,                                         0,     OWN) \
  X(S, INT,     all,      1, "",  YES_NO,                             0,     OWN) \
  X(S, REAL,    normal,   3, "",  ANY,                                         0,     OWN) \
  X(S, ADDRESS, values,   1, "m", ANY,                                         NULL,  OWN) \
  X(S, ADDRESS, signal,   3, "",  ANY,                                         NULL,  OWN) \
  X(S, REAL,    factor,   3, "",  FINITE,                                      1,     OWN)
#define ALONG_NORMAL BECAUSE("signal[0] is along the normal")
#define ELASTIC_BOUNDARY_RULES(X, S) \
  X(S, values, NOT_GIVEN, IS(S, kind, MPS_BOUNDARY_HELD), BECAUSE("make its kind MPS_BOUNDARY_DRIVEN")) \
  X(S, signal, NOT_GIVEN, IS(S, kind, MPS_BOUNDARY_HELD), BECAUSE("make its kind MPS_BOUNDARY_DRIVEN")) \
  X(S, values, EACH(S, id_count, 3) FINITE, IS(S, kind, MPS_BOUNDARY_DRIVEN)) \
  X(S, values, EACH(S, id_count, 1) FINITE, IS(S, kind, MPS_BOUNDARY_ROLLER)) \
  X(S, factor, UNUSED, WITHOUT(S, signal), FACTOR_OF_SIGNALS) \
  X(S, signal, COMPONENT(1) UNUSED, IS(S, kind, MPS_BOUNDARY_ROLLER), ALONG_NORMAL) \
  X(S, signal, COMPONENT(2) UNUSED, IS(S, kind, MPS_BOUNDARY_ROLLER), ALONG_NORMAL) \
  X(S, normal, UNUSED, ISNT(S, kind, MPS_BOUNDARY_ROLLER)) \
  X(S, dofs, UNUSED, IS(S, kind, MPS_BOUNDARY_ROLLER))
MPSI_DEFINITION_RULED(mps_elastic_boundary_def, "elastic_boundary", ELASTIC_BOUNDARY, ELASTIC_BOUNDARY_RULES)

#define ELASTIC_LOAD(X, S) \
  X(S, INT,     kind,     1, "",  ONE_OF(MPS_ELASTIC_LOAD_, "BODY|VOLUME|FORCE|TRACTION|PRESSURE|FUNCTION"), 0, OWN) \
  X(S, ADDRESS, ids,      1, "",  ANY,             NULL,  OWN) \
  X(S, LONG,    id_count, 1, "",  ANY,             0,     OWN) \
  X(S, REAL,    lower,    3, "m", ANY,             UNSET, OWN) \
  X(S, REAL,    upper,    3, "m", ANY,             UNSET, OWN) \
  X(S, INT,     all,      1, "",  YES_NO, 0,     OWN) \
  X(S, INT,     reserved, 1, "",  RESERVED,        0,     OWN) \
  X(S, ADDRESS, values,   1, "",  ANY,             NULL,  OWN) \
  X(S, REAL,    force,    3, "",  FINITE,          0,     OWN) \
  X(S, CALL,    function, 1, "",  ANY,             NULL,  OWN) \
  X(S, ADDRESS, user,     1, "",  ANY,             NULL,  OWN) \
  X(S, ADDRESS, signal,   3, "",  ANY,             NULL,  OWN) \
  X(S, REAL,    factor,   3, "",  FINITE,          1,     OWN)
#define ONE_PRESSURE BECAUSE("the pressure is force[0]")
#define ELASTIC_LOAD_RULES(X, S) \
  X(S, function, GIVEN, IS(S, kind, MPS_ELASTIC_LOAD_FUNCTION)) \
  X(S, values, NOT_GIVEN, IS(S, kind, MPS_ELASTIC_LOAD_BODY, MPS_ELASTIC_LOAD_VOLUME, MPS_ELASTIC_LOAD_FUNCTION)) \
  X(S, values, EACH(S, id_count, 3) FINITE, IS(S, kind, MPS_ELASTIC_LOAD_FORCE, MPS_ELASTIC_LOAD_TRACTION)) \
  X(S, values, EACH(S, id_count, 1) FINITE, IS(S, kind, MPS_ELASTIC_LOAD_PRESSURE)) \
  X(S, function, UNUSED, ISNT(S, kind, MPS_ELASTIC_LOAD_FUNCTION)) \
  X(S, force, UNUSED, IS(S, kind, MPS_ELASTIC_LOAD_FUNCTION)) \
  X(S, force, UNUSED, WITH(S, values)) \
  X(S, force, COMPONENT(1) UNUSED, IS(S, kind, MPS_ELASTIC_LOAD_PRESSURE), ONE_PRESSURE) \
  X(S, force, COMPONENT(2) UNUSED, IS(S, kind, MPS_ELASTIC_LOAD_PRESSURE), ONE_PRESSURE)
MPSI_DEFINITION_RULED(mps_elastic_load_def, "elastic_load", ELASTIC_LOAD, ELASTIC_LOAD_RULES)

#define ELASTIC_MOTION(X, S) \
  X(S, INT,  reserved,          1, "",    RESERVED,                    0,     OWN) \
  X(S, REAL, dt,                1, "s",   IN(ELASTIC_POSITIVE),        0,     SAME) \
  X(S, REAL, rho_inf,           1, "",    IN(0, 1),                    1,     SAME) \
  X(S, REAL, beta,              1, "",    OR_NAN ABOVE(0, 10),         UNSET, SAME) \
  X(S, REAL, gamma,             1, "",    OR_NAN IN(0.5, 1),           UNSET, SAME) \
  X(S, REAL, mass_damping,      1, "1/s", IN(0, 1e30),                 0,     SAME) \
  X(S, REAL, stiffness_damping, 1, "s",   IN(0, 1e30),                 0,     SAME) \
  X(S, REAL, ratio,             2, "",    OR_NAN BELOW(0, 1),          UNSET, SAME) \
  X(S, REAL, frequency,         2, "Hz",  OR_NAN IN(ELASTIC_POSITIVE), UNSET, SAME) \
  X(S, REAL, time,              1, "s",   FINITE,                      0,     SAME)

#define BY_RATIOS BECAUSE("the coefficients follow from the ratios")
#define ELASTIC_MOTION_RULES(X, S) \
  X(S, beta,              NOT_GIVEN,            WITH(S, rho_inf)) \
  X(S, gamma,             NOT_GIVEN,            WITH(S, rho_inf)) \
  X(S, beta,              GIVEN,                WITH(S, gamma)) \
  X(S, gamma,             GIVEN,                WITH(S, beta)) \
  X(S, ratio,             BELOW(0, 1),          WITH(S, frequency)) \
  X(S, frequency,         IN(ELASTIC_POSITIVE), WITH(S, ratio)) \
  X(S, mass_damping,      NOT_GIVEN,            WITH(S, ratio), BY_RATIOS) \
  X(S, stiffness_damping, NOT_GIVEN,            WITH(S, ratio), BY_RATIOS)
MPSI_DEFINITION_RULED(mps_elastic_motion_def, "elastic_motion", ELASTIC_MOTION, ELASTIC_MOTION_RULES)
/* clang-format on */
