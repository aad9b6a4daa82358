/* foreign.h - state that other libraries keep for the whole process: the numbers of threads of BLAS
 * and OpenMP, and ARPACK's saved variables. What is guarded here is theirs; libmps has none.
 * SPDX-License-Identifier: BSD-3-Clause */
#ifndef MPSI_FOREIGN_H
#define MPSI_FOREIGN_H

#include <stdbool.h>
#include <stdint.h>

/* From enter to leave BLAS (OpenBLAS) works with at most `threads` threads and, where that is 1,
 * OpenMP regions of other libraries with one. Calls of several contexts at once share the smallest
 * number; the last to leave restores what the process had. */
void mpsi_foreign_enter(int32_t threads);
void mpsi_foreign_leave(void);

/* ARPACK serves one caller at a time: waits for the others. False where the calling thread itself
 * is inside already. */
bool mpsi_foreign_lock_arpack(void);
void mpsi_foreign_unlock_arpack(void);

#endif
