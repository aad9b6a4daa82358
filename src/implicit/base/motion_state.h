/* motion_state.h - the state of a motion under way, and its arrays.
 * SPDX-License-Identifier: BSD-3-Clause */
#pragma once

#include <mps/elastic.h>

#include <stdbool.h>

/* ---- motion.c -------------------------------------------------------------------------------- */
typedef struct mpsi_elastic_motion {
  double dt, time;
  int64_t steps;
  double alpha_m, alpha_f, beta, gamma; /* of the family */
  double a0, a1;                        /* C = a0 M + a1 K */
  bool conserving;                      /* average acceleration */
  double *velocity, *acceleration;      /* n * dim, as all here */
  double *force;                        /* loads at the end of the last step */
  double *inner;                        /* K (u + a1 v) there */
  double *held;                         /* inner + a0 M v - force along fixed directions */
  double *next[5];                      /* of the step being made: MPSI_NEXT_U ... */
  double *scratch;
  int64_t fabric[2]; /* of the moduli and fixed directions to which inner, held and acceleration
                        belong (fabric.c) */
  bool strain_known; /* after a change of moduli: */
  double strain;     /* J, with those */
} mpsi_elastic_motion;

enum { MPSI_NEXT_U, MPSI_NEXT_V, MPSI_NEXT_A, MPSI_NEXT_INNER, MPSI_NEXT_HELD };
/* ---- motion_state.c ---- */
void mpsi_elastic_end_motion(mps_elastic *e);
/* Ends it, except for its numbers, which a rollback may need. */
void mpsi_elastic_suspend_motion(mps_elastic *e);
/* Arrays of e's particles; moving them to `to`; and their end. */
mps_status mpsi_elastic_allocate_motion(mps_elastic *e, const char *function,
                                        mpsi_elastic_motion *m);
void mpsi_elastic_move_arrays(mpsi_elastic_motion *from, mpsi_elastic_motion *to);
void mpsi_elastic_free_arrays(mps_elastic *e, mpsi_elastic_motion *m);

/* 0 without a motion. */
double mpsi_elastic_time(const void *elastic);
int64_t mpsi_elastic_steps(const void *elastic);
double mpsi_elastic_dt(void *elastic, const char *function);
