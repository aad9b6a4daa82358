/* envelope.h - a small symmetric matrix in envelope storage, each row from its first entry to the
 * diagonal, and its factors L D L^T in the same place: the equation of a coarse space.
 * SPDX-License-Identifier: BSD-3-Clause */
#pragma once

#include "room.h"

typedef struct mpsi_envelope {
  int64_t rows;
  int64_t entries; /* left of the diagonal */
  mpsi_room first_room, start_room, value_room;
  int32_t *first;   /* column of each row's first entry, at most the row */
  int64_t *start;   /* of each row in `value` */
  double *value;    /* entries, then the diagonal; the factors: L and the reciprocal pivots */
  double *diagonal; /* in the same memory */
} mpsi_envelope;

/* Rows without entries left of the diagonal: the caller then lowers `first`. false: no memory. */
bool mpsi_envelope_begin(mps_context *context, mpsi_envelope *e, int64_t rows);
/* Additions and multiplications of a factorisation with the present `first`. */
double mpsi_envelope_work(const mpsi_envelope *e);
/* Room for the entries, which are 0 then. false: no memory. */
bool mpsi_envelope_make(mps_context *context, mpsi_envelope *e);
/* Of row i, column j <= i. */
static inline double *mpsi_envelope_at(const mpsi_envelope *e, int64_t i, int64_t j) {
  return i == j ? e->diagonal + i : e->value + e->start[i] + j - e->first[i];
}
/* A pivot below 1e-8 of its diagonal belongs to an unknown that the others determine up to
 * round-off, as the last one where the matrix is singular: it is skipped, and its value is 0. */
void mpsi_envelope_factor(mpsi_envelope *e);
void mpsi_envelope_solve(const mpsi_envelope *e, double *x); /* in place */
void mpsi_envelope_drop(mps_context *context, mpsi_envelope *e);
