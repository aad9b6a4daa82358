/* foreign.h - process-wide state of other libraries: the numbers of threads of BLAS and OpenMP, and
 * ARPACK's saved variables. libmps has no such state itself.
 * SPDX-License-Identifier: BSD-3-Clause */
#pragma once

#include <stdbool.h>
#include <stdint.h>

/* From enter to leave BLAS (OpenBLAS) works with at most `threads` threads and, where that is 1,
 * OpenMP regions of other libraries with one. Concurrent calls of several contexts use the smallest
 * number; the last to leave restores that of the process. */
void mpsi_foreign_enter(int32_t threads);
void mpsi_foreign_leave(void);

/* ARPACK serves one caller at a time: waits for the others. False where the calling thread itself
 * is inside already. */
bool mpsi_foreign_lock_arpack(void);
void mpsi_foreign_unlock_arpack(void);
