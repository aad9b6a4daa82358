/* base.c - definitions of sets, tables, records, output, ranks, coupling, linear solvers.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "table.h"

#include <mps/context.h>
#include <mps/experimental/coupling.h>
#include <mps/experimental/domain.h>
#include <mps/experimental/linear_solver.h>
#include <mps/experimental/neighbours.h>
#include <mps/experimental/soil.h>
#include <mps/io.h>
#include <mps/particles.h>
#include <mps/signal.h>

/* clang-format off */

#define CONTEXT(X, S) \
  X(S, INT,     executor,          1, "", ONE_OF(MPS_CONTEXT_EXECUTOR_, "THREADS|SERIAL|OPENMP|CALLER"), 0,    OWN) \
  X(S, INT,     threads,           1, "", IN(0, 1024),                                                   0,    OWN) \
  X(S, INT,     instruction_level, 1, "", ANY,                                                           0,    OWN) \
  X(S, CALL,    parallel_for,      1, "", ANY,                                                           NULL, OWN) \
  X(S, ADDRESS, parallel_user,     1, "", ANY,                                                           NULL, OWN) \
  X(S, CALL,    parallel_release,  1, "", ANY,                                                           NULL, OWN) \
  X(S, CALL,    alloc,             1, "", ANY,                                                           NULL, OWN) \
  X(S, CALL,    free,              1, "", ANY,                                                           NULL, OWN) \
  X(S, ADDRESS, memory_user,       1, "", ANY,                                                           NULL, OWN) \
  X(S, CALL,    memory_release,    1, "", ANY,                                                           NULL, OWN) \
  X(S, CALL,    log,               1, "", ANY,                                                           NULL, OWN) \
  X(S, ADDRESS, log_user,          1, "", ANY,                                                           NULL, OWN) \
  X(S, CALL,    log_release,       1, "", ANY,                                                           NULL, OWN) \
  X(S, CALL,    progress,          1, "", ANY,                                                           NULL, OWN) \
  X(S, ADDRESS, progress_user,     1, "", ANY,                                                           NULL, OWN) \
  X(S, CALL,    progress_release,  1, "", ANY,                                                           NULL, OWN) \
  X(S, CALL,    cancel,            1, "", ANY,                                                           NULL, OWN) \
  X(S, ADDRESS, cancel_user,       1, "", ANY,                                                           NULL, OWN) \
  X(S, CALL,    cancel_release,    1, "", ANY,                                                           NULL, OWN)

#define CONTEXT_RULES(X, S) \
  X(S, parallel_for, GIVEN,       IS(S, executor, MPS_CONTEXT_EXECUTOR_CALLER)) \
  X(S, threads,      IN(1, 1024), IS(S, executor, MPS_CONTEXT_EXECUTOR_CALLER)) \
  X(S, free,         GIVEN,       WITH(S, alloc)) \
  X(S, alloc,        GIVEN,       WITH(S, free))
MPSI_DEFINITION_RULED(mps_context_def, "context", CONTEXT, CONTEXT_RULES)

#define PARTICLES(X, S) \
  X(S, INT,  dim,     1, "",  NAMES("||plane|space"), 2,     SAME) \
  X(S, REAL, spacing, 1, "m", IN(MPSI_SPACINGS),      UNSET, SAME) \
  X(S, REAL, origin,  3, "m", IN(MPSI_PLACES),        0,     SAME)
MPSI_DEFINITION(mps_particles_def, "particles", PARTICLES)

#define NEIGHBOURS(X, S) \
  X(S, INT,  dim,      1, "",  NAMES("||plane|space"), 2,     OWN) \
  X(S, REAL, radius,   1, "m", IN(1e-150, 1e150),      UNSET, OWN) \
  X(S, INT,  half,     1, "",  NAMES("both|half"),     0,     OWN) \
  X(S, INT,  reserved, 1, "",  RESERVED,               0,     OWN)
MPSI_DEFINITION(mps_neighbours_def, "neighbours", NEIGHBOURS)

#define TABLE(X, S) \
  X(S, INT,  interpolation, 1, "",  ONE_OF(MPS_TABLE_INTERPOLATION_, "NEAREST|LINEAR"), 0,     OWN) \
  X(S, INT,  extrapolate,   1, "",  YES_NO,                      0,     OWN) \
  X(S, INT,  reserved,      1, "",  RESERVED,                             0,     OWN) \
  X(S, REAL, reach,         1, "m", OR_NAN ABOVE(0, INFINITY),            UNSET, OWN)

#define TABLE_RULES(X, S) \
  X(S, extrapolate, NOT_GIVEN, IS(S, interpolation, MPS_TABLE_INTERPOLATION_NEAREST)) \
  X(S, reach,       GIVEN,     WITH(S, extrapolate))
MPSI_DEFINITION_RULED(mps_table_def, "table", TABLE, TABLE_RULES)

#define SIGNAL_RECORD(X, S) \
  X(S, INT,     format,   1, "",  ONE_OF(MPS_SIGNAL_RECORD_FORMAT_, "AUTO|AT2|KNET|CSV|SMC|COSMOS"),         0,     OWN) \
  X(S, INT,     quantity, 1, "",  ONE_OF(MPS_SIGNAL_QUANTITY_, "ACCELERATION|VELOCITY|DISPLACEMENT"), 0,     OWN) \
  X(S, INT,     baseline, 1, "",  ONE_OF(MPS_SIGNAL_BASELINE_, "LINEAR|NONE|MEAN|QUADRATIC|CUBIC"),   0,     OWN) \
  X(S, REAL,    scale,    1, "",  FINITE,                                                             1,     OWN) \
  X(S, REAL,    taper,    1, "s", IN(0, DBL_MAX),                                                     0,     OWN) \
  X(S, REAL,    step,     1, "s", OR_NAN ABOVE(0, DBL_MAX),                                           UNSET, OWN) \
  X(S, ADDRESS, unit,     1, "",  ANY,                                                                NULL,  OWN) \
  X(S, ADDRESS, column,   1, "",  ANY,                                                                NULL,  OWN)
MPSI_DEFINITION(mps_signal_record_def, "signal_record", SIGNAL_RECORD)

#define RECORDER(X, S) \
  X(S, INT,     compression, 1, "", IN(0, 9),         0,    OWN) \
  X(S, ADDRESS, path,        1, "", NEEDED,           NULL, OWN) \
  X(S, ADDRESS, fields,      1, "", ANY,              NULL, OWN) \
  X(S, LONG,    field_count, 1, "", IN(0, INT32_MAX), 0,    OWN) \
  X(S, INT,     xdmf,        1, "", YES_NO,  0,    OWN) \
  X(S, INT,     reserved,    1, "", RESERVED,         0,    OWN)

#define RECORDER_RULES(X, S) \
  X(S, fields, GIVEN, WITH(S, field_count))
MPSI_DEFINITION_RULED(mps_recorder_def, "recorder", RECORDER, RECORDER_RULES)

#define CHECKPOINT(X, S) \
  X(S, INT,     reserved,   1,  "",      RESERVED,        0,    OWN) \
  X(S, REAL,    time,       1,  "",      ANY,             0,    OWN) \
  X(S, LONG,    step,       1,  "",      ANY,             0,    OWN) \
  X(S, REAL,    dt,         1,  "",      ANY,             0,    OWN) \
  X(S, CHAR,    user_key,   64, "",      ANY,             0,    OWN) \
  X(S, ADDRESS, user_data,  1,  "",      ANY,             NULL, OWN) \
  X(S, LONG,    user_bytes, 1,  "bytes", IN(0, INFINITY), 0,    OWN)
MPSI_DEFINITION(mps_checkpoint, "checkpoint", CHECKPOINT)

#define DOMAIN(X, S) \
  X(S, INT,     rank,         1, "",      IN(0, INT32_MAX), 0,    OWN) \
  X(S, INT,     size,         1, "ranks", IN(1, 1000000),   1,    OWN) \
  X(S, INT,     reserved,     1, "",      RESERVED,         0,    OWN) \
  X(S, ADDRESS, user,         1, "",      ANY,              NULL, OWN) \
  X(S, CALL,    rendezvous,   1, "",      NEEDED,           NULL, OWN) \
  X(S, CALL,    star_create,  1, "",      NEEDED,           NULL, OWN) \
  X(S, CALL,    star_begin,   1, "",      NEEDED,           NULL, OWN) \
  X(S, CALL,    star_end,     1, "",      NEEDED,           NULL, OWN) \
  X(S, CALL,    star_destroy, 1, "",      NEEDED,           NULL, OWN) \
  X(S, CALL,    reduce_max,   1, "",      NEEDED,           NULL, OWN) \
  X(S, CALL,    reduce_sum,   1, "",      NEEDED,           NULL, OWN) \
  X(S, CALL,    release,      1, "",      ANY,              NULL, OWN) \
  X(S, CALL,    max_begin,    1, "",      ANY,              NULL, OWN) \
  X(S, CALL,    max_end,      1, "",      ANY,              NULL, OWN) \
  X(S, CALL,    max_leave,    1, "",      ANY,              NULL, OWN)

#define DOMAIN_RULES(X, S) \
  X(S, rank,      LESS(S, size), ALWAYS) \
  X(S, max_begin, GIVEN,         WITH(S, max_end)) \
  X(S, max_end,   GIVEN,         WITH(S, max_begin))
MPSI_DEFINITION_RULED(mps_domain_def, "domain", DOMAIN, DOMAIN_RULES)

#define COUPLING(X, S) \
  X(S, INT,  method,     1, "", ONE_OF(MPS_COUPLING_METHOD_, "QUASI_NEWTON|AITKEN|CONSTANT"), 0,      OWN) \
  X(S, LONG, size,       1, "", IN(1, 2147483648.0),                                          0,      OWN) \
  X(S, REAL, relaxation, 1, "", ABOVE(0, 1),                                                  0.1,    OWN) \
  X(S, REAL, tolerance,  1, "", BETWEEN(0, 1),                                                0.0001, OWN) \
  X(S, REAL, floor,      1, "", IN(0, DBL_MAX),                                               0,      OWN) \
  X(S, REAL, filter,     1, "", BELOW(0, 1),                                                  0.0001, OWN) \
  X(S, INT,  repeats,    1, "", IN(1, INT32_MAX),                                             50,     OWN) \
  X(S, INT,  reuse,      1, "", IN(0, INT32_MAX),                                             4,      OWN) \
  X(S, INT,  columns,    1, "", IN(1, 64),                                                    40,     OWN) \
  X(S, INT,  order,      1, "", NAMES("constant|linear|quadratic"),                           1,      OWN)
MPSI_DEFINITION(mps_coupling_def, "coupling", COUPLING)

#define LINEAR_SOLVER(X, S) \
  X(S, INT,     rank,     1, "", ANY,             0,    OWN) \
  X(S, INT,     ranks,    1, "", ANY,             1,    OWN) \
  X(S, INT,     reserved, 1, "", RESERVED,        0,    OWN) \
  X(S, LONG,    least,    1, "", IN(0, INFINITY), 0,    SAME) \
  X(S, ADDRESS, user,     1, "", ANY,             NULL, OWN) \
  X(S, CALL,    release,  1, "", ANY,             NULL, OWN) \
  X(S, CALL,    matrix,   1, "", NEEDED,          NULL, OWN) \
  X(S, CALL,    solve,    1, "", NEEDED,          NULL, OWN) \
  X(S, CALL,    forget,   1, "", ANY,             NULL, OWN)
MPSI_DEFINITION(mps_linear_solver_def, "linear_solver", LINEAR_SOLVER)
/* clang-format on */
