/* waves.c - definitions of seas and wave loads. SPDX-License-Identifier: BSD-3-Clause */
#include "table.h"

#include <mps/experimental/wave_loads.h>
#include <mps/experimental/waves.h>

/* clang-format off */

#define WAVES(X, S) \
  X(S, INT,     kind,      1, "",     ONE_OF(MPS_WAVES_, "REGULAR|JONSWAP|PIERSON_MOSKOWITZ|SPECTRUM|RECORD|SOLITARY"), 0,     OWN) \
  X(S, INT,     phases,    1, "",     ONE_OF(MPS_WAVES_PHASES_, "RANDOM|AMPLITUDES|FOCUSED"),                       0,     OWN) \
  X(S, INT,     theory,    1, "",     ONE_OF(MPS_WAVES_THEORY_, "SECOND|LINEAR|NARROW|STREAM"),                     0,     OWN) \
  X(S, REAL,    depth,     1, "m",    IN(1e-12, 1e12),                                                              UNSET, OWN) \
  X(S, REAL,    gravity,   1, "m/s2", IN(1e-12, 1e12),                                                              9.81,  OWN) \
  X(S, REAL,    height,    1, "m",    OR_NAN IN(1e-12, 1e12),                                                       UNSET, OWN) \
  X(S, REAL,    period,    1, "s",    OR_NAN IN(1e-12, 1e12),                                                       UNSET, OWN) \
  X(S, REAL,    gamma,     1, "",     IN(1, 20),                                                                    3.3,   OWN) \
  X(S, REAL,    repeat,    1, "s",    OR_NAN IN(1e-12, 1e12),                                                       UNSET, OWN) \
  X(S, REAL,    lower,     1, "",     ABOVE(0, 10),                                                                 0.6,   OWN) \
  X(S, REAL,    upper,     1, "",     ABOVE(0, 10),                                                                 2.5,   OWN) \
  X(S, REAL,    crest,     1, "m",    OR_NAN IN(1e-12, 1e12),                                                       UNSET, OWN) \
  X(S, REAL,    position,  1, "m",    IN(0, 1e12),                                                                  0,     OWN) \
  X(S, REAL,    time,      1, "s",    OR_NAN IN(-1e12, 1e12),                                                       UNSET, OWN) \
  X(S, REAL,    ramp,      1, "s",    OR_ZERO OR_NAN IN(1e-12, 1e12),                                               UNSET, OWN) \
  X(S, REAL,    stroke,    1, "m",    OR_NAN IN(1e-12, 1e12),                                                       UNSET, OWN) \
  X(S, REAL,    speed,     1, "m/s",  OR_NAN IN(1e-12, 1e12),                                                       UNSET, OWN) \
  X(S, LONG,    seed,      1, "",     ANY,                                                                          1,     OWN) \
  X(S, LONG,    count,     1, "",     IN(0, INFINITY),                                                                 0,     OWN) \
  X(S, ADDRESS, frequency, 1, "Hz",   ANY,                                                                          NULL,  OWN) \
  X(S, ADDRESS, density,   1, "m2 s",  ANY,                                                                          NULL,  OWN) \
  X(S, LONG,    samples,   1, "",     IN(0, INFINITY),                                                                 0,     OWN) \
  X(S, ADDRESS, times,     1, "s",    ANY,                                                                          NULL,  OWN) \
  X(S, ADDRESS, levels,    1, "m",    ANY,                                                                          NULL,  OWN)

#define WAVES_RULES(X, S) \
  X(S, phases,    NOT_GIVEN,                          IS(S, kind, MPS_WAVES_REGULAR, MPS_WAVES_RECORD, MPS_WAVES_SOLITARY)) \
  X(S, theory,    NOT_GIVEN,                          IS(S, kind, MPS_WAVES_SOLITARY)) \
  X(S, height,    GIVEN,                              ISNT(S, kind, MPS_WAVES_SPECTRUM, MPS_WAVES_RECORD), \
                                                      ISNT(S, phases, MPS_WAVES_PHASES_FOCUSED)) \
  X(S, period,    GIVEN,                              ISNT(S, kind, MPS_WAVES_SPECTRUM, MPS_WAVES_RECORD, MPS_WAVES_SOLITARY)) \
  X(S, period,    NOT_GIVEN,                          IS(S, kind, MPS_WAVES_SOLITARY)) \
  X(S, crest,     GIVEN,                              IS(S, phases, MPS_WAVES_PHASES_FOCUSED)) \
  X(S, time,      GIVEN,                              IS(S, phases, MPS_WAVES_PHASES_FOCUSED)) \
  X(S, lower,     LESS(S, upper),                     ALWAYS) \
  X(S, repeat,    AT_LEAST(S, period, 2),             ISNT(S, kind, MPS_WAVES_REGULAR, MPS_WAVES_RECORD, MPS_WAVES_SOLITARY)) \
  X(S, count,     IN(2, INFINITY),                    IS(S, kind, MPS_WAVES_SPECTRUM)) \
  X(S, frequency, GIVEN,                              IS(S, kind, MPS_WAVES_SPECTRUM)) \
  X(S, density,   GIVEN,                              IS(S, kind, MPS_WAVES_SPECTRUM)) \
  X(S, frequency, RISING(S, count) ABOVE(0, 1e12),    IS(S, kind, MPS_WAVES_SPECTRUM)) \
  X(S, density,   EACH(S, count, 1) IN(0, 1e100),     IS(S, kind, MPS_WAVES_SPECTRUM)) \
  X(S, samples,   IN(8, INFINITY),                    IS(S, kind, MPS_WAVES_RECORD)) \
  X(S, times,     GIVEN,                              IS(S, kind, MPS_WAVES_RECORD)) \
  X(S, levels,    GIVEN,                              IS(S, kind, MPS_WAVES_RECORD)) \
  X(S, levels,    EACH(S, samples, 1) IN(-1e12, 1e12), IS(S, kind, MPS_WAVES_RECORD))
MPSI_DEFINITION_RULED(mps_waves_def, "waves", WAVES, WAVES_RULES)

#define ABSORBER(X, S) \
  X(S, INT,     form,         1, "",      ONE_OF(MPS_ABSORBER_FORM_, "SHALLOW|TUNED"), 0,     OWN) \
  X(S, REAL,    depth,        1, "m",     IN(1e-12, 1e12),                             UNSET, OWN) \
  X(S, REAL,    gravity,      1, "m/s2",  IN(1e-12, 1e12),                             9.81,  OWN) \
  X(S, REAL,    period,       1, "s",     OR_NAN IN(1e-12, 1e12),                      UNSET, OWN) \
  X(S, REAL,    high_pass,    1, "rad/s", OR_NAN IN(0, 1e12),                          UNSET, OWN) \
  X(S, REAL,    leak,         1, "1/s",   OR_NAN IN(0, 1e12),                          UNSET, OWN) \
  X(S, REAL,    stroke,       1, "m",     OR_NAN IN(1e-12, 1e12),                      UNSET, OWN) \
  X(S, REAL,    acceleration, 1, "m/s2",  OR_NAN IN(1e-12, 1e12),                      UNSET, OWN) \
  X(S, ADDRESS, waves,        1, "",      ANY,                                         NULL,  OWN)

#define ABSORBER_RULES(X, S) \
  X(S, period, GIVEN, WITHOUT(S, waves))
MPSI_DEFINITION_RULED(mps_absorber_def, "absorber", ABSORBER, ABSORBER_RULES)

#define SEPARATION(X, S) \
  X(S, INT,     gauges,   1, "",     IN(2, 16),        0,     OWN) \
  X(S, REAL,    depth,    1, "m",    IN(1e-12, 1e12),  UNSET, OWN) \
  X(S, REAL,    gravity,  1, "m/s2", IN(1e-12, 1e12),  9.81,  OWN) \
  X(S, REAL,    from,     1, "s",    OR_NAN FINITE,    UNSET, OWN) \
  X(S, REAL,    to,       1, "s",    OR_NAN FINITE,    UNSET, OWN) \
  X(S, REAL,    lower,    1, "Hz",   ABOVE(0, 1e12),   UNSET, OWN) \
  X(S, REAL,    upper,    1, "Hz",   ABOVE(0, 1e12),   UNSET, OWN) \
  X(S, ADDRESS, position, 1, "m",    NEEDED,           NULL,  OWN) \
  X(S, LONG,    samples,  1, "",     IN(8, 268435456), 0,     OWN) \
  X(S, ADDRESS, times,    1, "s",    NEEDED,           NULL,  OWN) \
  X(S, ADDRESS, levels,   1, "m",    NEEDED,           NULL,  OWN)

#define SEPARATION_RULES(X, S) \
  X(S, from,     LESS(S, to),                         ALWAYS) \
  X(S, lower,    LESS(S, upper),                      ALWAYS) \
  X(S, position, EACH(S, gauges, 1) IN(-1e12, 1e12),  ALWAYS) \
  X(S, times,    RISING(S, samples) IN(-1e12, 1e12),  ALWAYS)
MPSI_DEFINITION_RULED(mps_separation_def, "separation", SEPARATION, SEPARATION_RULES)

#define SAINFLOU(X, S) \
  X(S, INT,  reserved, 1, "",      RESERVED,        0,     OWN) \
  X(S, REAL, height,   1, "m",     IN(1e-12, 1e12), UNSET, OWN) \
  X(S, REAL, period,   1, "s",     IN(1e-12, 1e12), UNSET, OWN) \
  X(S, REAL, depth,    1, "m",     IN(1e-12, 1e12), UNSET, OWN) \
  X(S, REAL, density,  1, "kg/m3", IN(1e-12, 1e12), 1000,  OWN) \
  X(S, REAL, gravity,  1, "m/s2",  IN(1e-12, 1e12), 9.81,  OWN)
MPSI_DEFINITION(mps_sainflou_def, "sainflou", SAINFLOU)

#define GODA(X, S) \
  X(S, INT,  impulsive,  1, "",      YES_NO,                     0,     OWN) \
  X(S, REAL, height,     1, "m",     IN(1e-12, 1e12),                     UNSET, OWN) \
  X(S, REAL, period,     1, "s",     IN(1e-12, 1e12),                     UNSET, OWN) \
  X(S, REAL, depth,      1, "m",     IN(1e-12, 1e12),                     UNSET, OWN) \
  X(S, REAL, seaward,    1, "m",     OR_NAN IN(1e-12, 1e12),              UNSET, OWN) \
  X(S, REAL, berm_depth, 1, "m",     OR_NAN IN(1e-12, 1e12),              UNSET, OWN) \
  X(S, REAL, base,       1, "m",     OR_NAN IN(1e-12, 1e12),              UNSET, OWN) \
  X(S, REAL, crest,      1, "m",     IN(1e-12, 1e12),                     UNSET, OWN) \
  X(S, REAL, width,      1, "m",     IN(1e-12, 1e12),                     UNSET, OWN) \
  X(S, REAL, berm_width, 1, "m",     IN(0, 1e12),                         0,     OWN) \
  X(S, REAL, angle,      1, "rad",   IN(0, 0.5 * 3.14159265358979323846), 0,     OWN) \
  X(S, REAL, weight,     1, "N/m",   OR_NAN IN(1e-12, 1e15),              UNSET, OWN) \
  X(S, REAL, arm,        1, "m",     OR_NAN IN(1e-12, 1e12),              UNSET, OWN) \
  X(S, REAL, friction,   1, "",      IN(1e-12, 1e12),                     0.6,   OWN) \
  X(S, REAL, density,    1, "kg/m3", IN(1e-12, 1e12),                     1000,  OWN) \
  X(S, REAL, gravity,    1, "m/s2",  IN(1e-12, 1e12),                     9.81,  OWN)

#define GODA_RULES(X, S) \
  X(S, seaward,    AT_LEAST(S, depth, 1),      ALWAYS) \
  X(S, berm_depth, AT_MOST(S, depth, 1),       ALWAYS) \
  X(S, base,       AT_MOST(S, depth, 1),       ALWAYS) \
  X(S, base,       AT_LEAST(S, berm_depth, 1), ALWAYS) \
  X(S, base,       AT_LEAST(S, depth, 1),      WITHOUT(S, berm_depth)) \
  X(S, arm,        AT_MOST(S, width, 1),       ALWAYS)
MPSI_DEFINITION_RULED(mps_goda_def, "goda", GODA, GODA_RULES)

#define EUROTOP(X, S) \
  X(S, INT,  wall,      1, "",     ONE_OF(MPS_EUROTOP_WALL_, "VERTICAL|SLOPE"), 0,     OWN) \
  X(S, INT,  foreshore, 1, "",     YES_NO,                             0,     OWN) \
  X(S, INT,  design,    1, "",     NAMES("mean|design"),                        0,     OWN) \
  X(S, REAL, height,    1, "m",    IN(1e-12, 1e12),                             UNSET, OWN) \
  X(S, REAL, period,    1, "s",    IN(1e-12, 1e12),                             UNSET, OWN) \
  X(S, REAL, depth,     1, "m",    IN(1e-12, 1e12),                             UNSET, OWN) \
  X(S, REAL, crest,     1, "m",    OR_NAN IN(1e-12, 1e12),                      UNSET, OWN) \
  X(S, REAL, cotangent, 1, "",     OR_NAN IN(2, 8),                             UNSET, OWN) \
  X(S, REAL, berm,      1, "",     ABOVE(0, 1),                                 1,     OWN) \
  X(S, REAL, roughness, 1, "",     ABOVE(0, 1),                                 1,     OWN) \
  X(S, REAL, obliquity, 1, "",     ABOVE(0, 1),                                 1,     OWN) \
  X(S, REAL, crown,     1, "",     ABOVE(0, 1),                                 1,     OWN) \
  X(S, REAL, promenade, 1, "",     ABOVE(0, 1),                                 1,     OWN) \
  X(S, REAL, gravity,   1, "m/s2", IN(1e-12, 1e12),                             9.81,  OWN)

#define EUROTOP_RULES(X, S) \
  X(S, cotangent, GIVEN, IS(S, wall, MPS_EUROTOP_WALL_SLOPE))
MPSI_DEFINITION_RULED(mps_eurotop_def, "eurotop", EUROTOP, EUROTOP_RULES)

#define OVERTOPPING(X, S) \
  X(S, INT,     reserved, 1, "",     RESERVED,               0,     OWN) \
  X(S, LONG,    samples,  1, "",     IN(2, 268435456),       0,     OWN) \
  X(S, ADDRESS, times,    1, "s",    NEEDED,                 NULL,  OWN) \
  X(S, ADDRESS, heads,    1, "m",    NEEDED,                 NULL,  OWN) \
  X(S, ADDRESS, volumes,  1, "m2",   ANY,                    NULL,  OWN) \
  X(S, REAL,    resolved, 1, "m",    IN(1e-12, 1e12),        UNSET, OWN) \
  X(S, REAL,    pause,    1, "s",    IN(0, 1e12),            0,     OWN) \
  X(S, REAL,    depth,    1, "m",    OR_NAN IN(1e-12, 1e12), UNSET, OWN) \
  X(S, REAL,    gravity,  1, "m/s2", IN(1e-12, 1e12),        9.81,  OWN)

#define OVERTOPPING_RULES(X, S) \
  X(S, times,   RISING(S, samples) IN(-1e12, 1e12),              ALWAYS) \
  X(S, heads,   EACH(S, samples, 1) OR_NAN IN(-INFINITY, 1e12),  ALWAYS) \
  X(S, volumes, EACH(S, samples, 1) IN(-1e12, 1e12),             ALWAYS)
MPSI_DEFINITION_RULED(mps_overtopping_def, "overtopping", OVERTOPPING, OVERTOPPING_RULES)
/* clang-format on */
