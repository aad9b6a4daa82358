/* mps/history.h - histories: named columns of numbers against time that belong to a run of a
 * solver. Rows are kept in memory and are part of the solver's state: a snapshot and a checkpoint
 * have them, and a rollback or restore leaves those of the restored state. So the results of a
 * restarted run are those of an uninterrupted one. A CSV file can follow the rows.
 *
 *   static const char *const names[] = {"settlement", "force"}, *const units[] = {"m", "N"};
 *   mps_history_create(mps_mpm_solver(mpm), "footing", names, units, 2, &history);
 *   mps_history_open(history, "footing.csv", 10);
 *   ... mps_solver_restore, where the run continues a former one ...
 *   in the callback of a run:  mps_history_record(history, NAN, (double[]){s, f}, 2);
 *
 * The first column of every history is "t", the time (s).
 *
 * On several ranks (mps/experimental/domain.h) the functions with a status are collective, all
 * ranks have the rows of rank 0, and rank 0 writes. Thread rule: one thread at a time per context.
 * SPDX-License-Identifier: BSD-3-Clause */
#ifndef LIBMPS_HISTORY_H
#define LIBMPS_HISTORY_H

#include "solver.h"

MPS_EXTERN_C_BEGIN

typedef struct mps_history mps_history;

/** Makes a history without rows. `name`: 1 to 31 letters, digits, '_' or '-', of no other history
 * of the solver; a checkpoint knows the history by it. `columns` (`count`, 1 to 4096): names
 * besides "t", each 1 to 63 bytes of text without line breaks, all different; `units` (`count`, or
 * NULL) likewise, where NULL and "" are numbers without a unit. The texts are copied. A state that
 * lacks this history leaves it without rows when it is restored; one with other columns is not
 * restored: MPS_ERROR_ARGUMENT. MPS_ERROR_ARGUMENT: as said; MPS_ERROR_MEMORY. */
MPS_API MPS_NODISCARD mps_status mps_history_create(mps_solver *solver, const char *name,
                                                    const char *const *columns,
                                                    const char *const *units, int32_t count,
                                                    mps_history **out);
/** Writes the rows that its file lacks, destroys and nulls; accepts NULL. A history may outlive its
 *  solver: its rows can then be read and written, and none be added. In the callback of a column it
 *  only records MPS_ERROR_STATE. */
MPS_API void mps_history_destroy(mps_history **history);

/** Gives a value of a column, in `*value` (NaN before), for the state that `solver` has. It may ask
 *  the solver, not change it. A status other than MPS_OK ends the record without a row. */
typedef mps_status (*mps_history_fn)(void *user, mps_solver *solver, double *value);
/** Numbers of `column` come from `fn` (on ranks called on all of them), no longer from the caller
 *  of mps_history_record; NULL: from there again. `release` (or NULL) ends `user` once, when
 * another takes its place or the history is destroyed, and not by a call that fails.
 *  MPS_ERROR_ARGUMENT: no such column, or "t"; MPS_ERROR_STATE: in the callback of a column. */
MPS_API MPS_NODISCARD mps_status mps_history_set_source(mps_history *history, const char *column,
                                                        mps_history_fn fn, void *user,
                                                        mps_release_fn release);

/** Adds a row at `time` (s, finite; NaN: that of the solver) with `count` values of the columns
 * that have no source, in their order. Values may be NaN (unknown) and infinite. Between steps, as
 * in the callback of a run. Where a file is open and its block of rows is full, writes it: after
 *  MPS_ERROR_IO the row is kept, and the next record tries to write it again. Otherwise an error
 *  adds no row. MPS_ERROR_ARGUMENT: `count` is not that number, or `values` NULL, or `time`;
 *  MPS_ERROR_STATE: the solver has been destroyed, or is within a step; MPS_ERROR_MEMORY; the
 * status of a source. */
MPS_API MPS_NODISCARD mps_status mps_history_record(mps_history *history, double time,
                                                    const double *values, int32_t count);

/** Number of rows; 0 for NULL. */
MPS_API int64_t mps_history_count(const mps_history *history);
/** The numbers of `column`, or of "t": float64, shape (rows, 1, 1), read only, lent; the columns
 *  of a row lie one behind the other, "t" first. Valid until
 * the next record, rollback or restore; the epoch grows then. MPS_ERROR_ARGUMENT: no such column.
 */
MPS_API MPS_NODISCARD mps_status mps_history_view(const mps_history *history, const char *column,
                                                  mps_view *out);

/** Writes all rows as a CSV file, which appears whole or not at all: a line of names, "t_s" and
 *  NAME_UNIT with '_' for '/' and ' ' in the unit, in quotes (RFC 4180) where a name has a comma or
 *  a quote; then a line a row, of numbers that read back to the same bits, with a point in every
 *  locale. NaN is an empty cell. A file that is there is replaced; MPS_ERROR_IO for anything else
 *  (a directory, a device) and where it cannot be written: it is unchanged then. */
MPS_API MPS_NODISCARD mps_status mps_history_write(mps_history *history, const char *path);
/** The same file follows the run: rows are appended in blocks of `every` (>= 1), by
 *  mps_history_flush and at the end. It is made or replaced as a whole when first written, which a
 *  restored run does with all rows of its checkpoint; rows that a rollback has dropped leave it
 * when it is next written. A process that is killed leaves the rows up to the last block. `path` is
 *  copied; NULL: the file is completed and no other follows. MPS_ERROR_ARGUMENT: `every`;
 *  MPS_ERROR_IO: no file can be made there; then a former one continues. */
MPS_API MPS_NODISCARD mps_status mps_history_open(mps_history *history, const char *path,
                                                  int64_t every);
/** Writes the rows that the open file lacks. MPS_ERROR_STATE: none is open; MPS_ERROR_IO: as far as
 *  the file reaches it has whole rows. */
MPS_API MPS_NODISCARD mps_status mps_history_flush(mps_history *history);

MPS_EXTERN_C_END
#endif
