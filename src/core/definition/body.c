/* body.c - definitions of bodies and contacts. SPDX-License-Identifier: BSD-3-Clause */
#include "table.h"

#include <mps/body.h>
#include <mps/contact.h>

/* clang-format off */

/* A shape in the plane moves in it. */
#define MOTION_RULES(X, S) \
  X(S, position, COMPONENT(2) OR_NAN RESERVED, IN_PLANE) \
  X(S, rotation, FIRST(2) OR_NAN RESERVED, IN_PLANE) \
  X(S, velocity, COMPONENT(2) RESERVED, IN_PLANE) \
  X(S, spin,     FIRST(2) RESERVED,     IN_PLANE)

#define BODY(X, S) \
  X(S, INT,  motion,   1, "",      ONE_OF(MPS_BODY_MOTION_, "DRIVEN|FREE"),             0,     OWN) \
  X(S, REAL, position, 3, "m",     IN(-MPSI_BODY_FAR, MPSI_BODY_FAR),                   0,     OWN) \
  X(S, REAL, rotation, 3, "rad",   IN(-MPSI_BODY_FAR, MPSI_BODY_FAR),                   0,     OWN) \
  X(S, REAL, velocity, 3, "m/s",   IN(-MPSI_BODY_FAR, MPSI_BODY_FAR),                   0,     OWN) \
  X(S, REAL, spin,     3, "rad/s", IN(-MPSI_BODY_FAR, MPSI_BODY_FAR),                   0,     OWN) \
  X(S, REAL, mass,     1, "kg",    OR_ZERO OR_NAN IN(MPSI_BODY_LIGHT, MPSI_BODY_HEAVY), UNSET, OWN) \
  X(S, REAL, inertia,  3, "kg m2", OR_ZERO OR_NAN IN(MPSI_BODY_LIGHT, MPSI_BODY_HEAVY), UNSET, OWN) \
  X(S, REAL, gravity,  3, "m/s2",  IN(-MPSI_BODY_FAR, MPSI_BODY_FAR),                   0,     OWN) \
  X(S, REAL, damping,  2, "1/s",   IN(0, MPSI_BODY_HEAVY),                              0,     OWN)

#define DRIVEN(S) IS(S, motion, MPS_BODY_MOTION_DRIVEN), BECAUSE("make it MPS_BODY_MOTION_FREE, or leave this out and move the body by mps_body_drive")
#define FREE(S) IS(S, motion, MPS_BODY_MOTION_FREE)
#define INERTIA IN(MPSI_BODY_LIGHT, MPSI_BODY_HEAVY)
#define BODY_RULES(X, S) \
  MOTION_RULES(X, S) \
  X(S, inertia,  FIRST(2) OR_NAN RESERVED,  IN_PLANE) \
  X(S, gravity,  COMPONENT(2) RESERVED,     IN_PLANE) \
  X(S, mass,     OR_NAN RESERVED,           DRIVEN(S)) \
  X(S, inertia,  FIRST(3) OR_NAN RESERVED,  DRIVEN(S)) \
  X(S, velocity, FIRST(3) RESERVED,         DRIVEN(S)) \
  X(S, spin,     FIRST(3) RESERVED,         DRIVEN(S)) \
  X(S, gravity,  FIRST(3) RESERVED,         DRIVEN(S)) \
  X(S, damping,  RESERVED,                  DRIVEN(S)) \
  X(S, mass,     INERTIA,                   FREE(S)) \
  X(S, inertia,  COMPONENT(2) INERTIA,      FREE(S)) \
  X(S, inertia,  FIRST(2) INERTIA,          FREE(S), IN_SPACE)
MPSI_DEFINITION_RULED(mps_body_def, "body", BODY, BODY_RULES)

#define BODY_MOTION(X, S) \
  X(S, INT,  reserved, 1, "",      RESERVED,                                 0,     OWN) \
  X(S, REAL, position, 3, "m",     OR_NAN IN(-MPSI_BODY_FAR, MPSI_BODY_FAR), UNSET, OWN) \
  X(S, REAL, rotation, 3, "rad",   OR_NAN IN(-MPSI_BODY_FAR, MPSI_BODY_FAR), UNSET, OWN) \
  X(S, REAL, velocity, 3, "m/s",   IN(-MPSI_BODY_FAR, MPSI_BODY_FAR),        0,     OWN) \
  X(S, REAL, spin,     3, "rad/s", IN(-MPSI_BODY_FAR, MPSI_BODY_FAR),        0,     OWN)

#define BODY_MOTION_RULES(X, S) \
  MOTION_RULES(X, S) \
  X(S, rotation, FINITE, WITH(S, rotation), IN_SPACE, BECAUSE("all components are given, or none"))
MPSI_DEFINITION_RULED(mps_body_motion, "body_motion", BODY_MOTION, BODY_MOTION_RULES)

#define CONTACT(X, S) \
  X(S, INT,  mover,     1, "",    ONE_OF(MPS_CONTACT_MOVER_, "SOLVER|OTHER"),        0,     OWN) \
  X(S, INT,  method,    1, "",    ONE_OF(MPS_CONTACT_METHOD_, "IMPULSE|PENALTY"),    0,     OWN) \
  X(S, INT,  sweeps,    1, "",    IN(0, 100000),                                     0,     OWN) \
  X(S, REAL, friction,  1, "",    IN(0, 1e3),                                        0,     OWN) \
  X(S, REAL, penalty,   1, "N/m", OR_NAN ABOVE(0, MPSI_BODY_HEAVY),                  UNSET, OWN) \
  X(S, REAL, xi,        1, "",    OR_NAN BETWEEN(0, 1),                              UNSET, OWN) \
  X(S, REAL, offset,    1, "m",   OR_NAN IN(0, MPSI_BODY_FAR),                       UNSET, OWN) \
  X(S, REAL, depth,     1, "m",   OR_NAN ABOVE(0, INFINITY),                         UNSET, OWN) \
  X(S, INT,  thin,      1, "",    NAMES("refused|allowed"),                          0,     OWN) \
  X(S, INT,  inside,    1, "",    ONE_OF(MPS_CONTACT_INSIDE_, "REFUSE|PUSH|REMOVE"), 0,     OWN) \
  X(S, REAL, adhesion,  1, "Pa",  IN(0, MPSI_BODY_HEAVY),                            0,     OWN) \
  X(S, REAL, strength,  1, "Pa",  OR_NAN ABOVE(0, MPSI_BODY_HEAVY),                  UNSET, OWN) \
  X(S, REAL, corner,    1, "m",   IN(0, MPSI_BODY_FAR),                              0,     OWN) \
  X(S, REAL, tolerance, 1, "",    OR_NAN BELOW(0, 1),                                UNSET, OWN) \
  X(S, ADDRESS, friction_factor, 1, "", ANY, NULL, OWN) \
  X(S, REAL, inset,     1, "m",   IN(0, MPSI_BODY_FAR),                              0,     OWN)

#define IMPULSE(S) IS(S, method, MPS_CONTACT_METHOD_IMPULSE), BECAUSE("impulses have no stiffness")
#define PENALTY(S) IS(S, method, MPS_CONTACT_METHOD_PENALTY), BECAUSE("it has Coulomb friction alone, and takes corners as they are")
#define CONTACT_RULES(X, S) \
  X(S, xi,       NOT_GIVEN, IMPULSE(S)) \
  X(S, penalty,  NOT_GIVEN, IMPULSE(S)) \
  X(S, penalty,  NOT_GIVEN, WITH(S, xi)) \
  X(S, corner,   NOT_GIVEN, PENALTY(S)) \
  X(S, inset,    NOT_GIVEN, PENALTY(S)) \
  X(S, inset,    NOT_GIVEN, WITH(S, corner)) \
  X(S, inset,    NOT_GIVEN, IN_SPACE, BECAUSE("the edges of a solid can be rounded by `corner`")) \
  X(S, adhesion, NOT_GIVEN, PENALTY(S)) \
  X(S, strength, NOT_GIVEN, PENALTY(S)) \
  X(S, sweeps,    UNUSED, IS(S, method, MPS_CONTACT_METHOD_PENALTY)) \
  X(S, tolerance, UNUSED, IS(S, method, MPS_CONTACT_METHOD_PENALTY)) \
  X(S, friction_factor, UNUSED, WITHOUT(S, friction))
MPSI_DEFINITION_RULED(mps_contact_def, "contact", CONTACT, CONTACT_RULES)
/* clang-format on */
