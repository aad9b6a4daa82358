/* free_field.h - free-field sides: the ground beyond a side across x is a column of soil, level
 * ground that moves as if it went on horizontally without end (Zienkiewicz, Bicanic and Shen 1989).
 * It is computed by the same method in one dimension, with copies of the particles in the cells at
 * the side: their fields depend on y alone.
 *
 * The side itself is a mirror of velocities without change of sign (mirror.h, R = I), so that a
 * motion that does not depend on x has full supports there, and takes two tractions of the column:
 *
 *   that of its stresses, (sigma_xx, sigma_xy) at the height of the particles at the side: the
 *   force sum V sigma . grad_x phi on the nodes, by the same sums as the particles' own force of
 *   the opposite sign, which it balances to the last digits where their stresses are equal;
 *   that of dashpots (Lysmer and Kuhlemeyer 1969) rho c_p and rho c_s times the difference between
 *   the velocities of column and node, across and along, by which other waves leave.
 *
 * Water in the pores: the column has its own pressures, by its own changes of volume and by the
 * flow up and down between the cells at the side (mpsi_pore_update_columns), with the
 * permeabilities, porosities and masses of the particles that were copied; pressures that the
 * caller writes to these it takes too. With the ground's pressures in the column the side bears
 * nothing of a pressure that differs from one side to the other: it follows the ground's motion as
 * a load does, and ground that sways between two sides is pushed on, the faster the narrower it is
 * (docs/theory/walls.md). Implicit pressures are refused: the column has none.
 *
 * SPDX-License-Identifier: BSD-3-Clause */
#pragma once

#include "boundaries.h"
#include "mirror.h"

enum { MPSI_FIELD_PLANES = 2 }; /* planes of nodes on which the traction of a side acts */
enum { MPSI_FIELD_CELLS = 4 };  /* least width of a domain with such a side, cells */

/* Nodes of the column along y. */
typedef struct mpsi_field_node {
  double mass;            /* kg */
  double v[2], before[2]; /* m/s: with the forces and without */
  double force[2];        /* N */
  double across, along;   /* kg/s, dashpots of the side */
  double volume, strain;  /* m3, of the particles whose lowest node it is, and what it grows by */
  double traction[MPSI_FIELD_PLANES]
                 [2]; /* N, traction of the column's stresses on the side's nodes */
} mpsi_field_node;

/* The particles' columns lie in `state`, which is all that steps change, and is what is saved. */
typedef struct mpsi_free_field {
  int64_t count, doubles;
  int32_t histories;               /* columns */
  double *state, *kept;            /* kept: of before the present step */
  double *y, *v[2], *slope[2];     /* m, m/s, 1/s: dv/dy */
  double *s[4], *V, *m, *J, *F[5]; /* as in mpsi_columns */
  double *cp, *cs, *temperature;   /* m/s, elastic waves; K */
  double *u, *g, *seen; /* Pa, pressure of pore water; Pa/m, its slope along y; Pa, that of the
                           particle that was copied, as the library left it */
  double *history;      /* one column after the other */
  double *rest; /* N: force at rest of absorbing sides across y, [side][component]; and 1 where it
                   is still to be found */
  int64_t *law, *id;     /* id: of the particle that was copied */
  double *derivative[2]; /* 1/s, scratch: dv/dy for the laws */
  double *x;             /* m, that of the side, for the laws */
  double *former;        /* m3, scratch: V before the laws */
  int64_t *lowest;       /* scratch: number of the lowest node of the stencil */
  double (*row)[4];      /* y, sigma_xx, sigma_xy, V: rows of particles, from below */
  int64_t rows, *row_of;
  int64_t first, nodes; /* coordinate of the lowest node */
  mpsi_field_node *node;
} mpsi_free_field;

/* free_field.c: MPS_ERROR_ARGUMENT where side `number` cannot have a column, MPS_ERROR_STATE where
 * particles have velocities of a cancelled mps_mpm_settle. */
mps_status mpsi_mpm_check_free_field(const mpsi_boundary_setup *setup, const char *function,
                                     int32_t number);
/* free_field.c: MPS_ERROR_ARGUMENT where side `number` has a free-field side beside it and cannot
 * be of this kind. */
mps_status mpsi_mpm_check_beside_field(mps_context *context, const mpsi_boundaries *boundaries,
                                       const char *function, int32_t number, int32_t kind);
/* free_field.c: the column of the present ground at side `number`. */
mps_status mpsi_mpm_make_free_field(const mpsi_boundary_setup *setup, const char *function,
                                    int32_t number, mpsi_free_field **out);
void mpsi_mpm_free_field_free(mps_context *context, mpsi_free_field **field);
/* free_field.c: whether some side is a free field. */
bool mpsi_mpm_has_free_field(const mpsi_boundaries *boundaries);
/* free_field.c: its state, for snapshots and checkpoints. */
void mpsi_mpm_list_free_field(mpsi_state *state, mpsi_free_field *field);
/* free_field.c: whether the column of a file has its particles in its rows, and laws of the solver
 * whose histories it has memory for. */
bool mpsi_mpm_free_field_fits(const mpsi_free_field *field, int32_t number, const mpsi_laws *laws,
                              mps_snapshot *from);

/* free_field_step.c: the tractions of the columns on the nodes of their sides, and a step of the
 * columns. On an error they have not moved. */
mps_status mpsi_mpm_move_free_fields(const mpsi_boundary_setup *setup, const char *function);
/* free_field_step.c: after a step: of level ground between two such sides the particles that have
 * been stopped at one, on their way out, come in at the other. Whether there were any. */
bool mpsi_mpm_pass_free_fields(const mpsi_boundary_setup *setup);
/* free_field_step.c: takes back the step of the columns: the solver has not made it. */
void mpsi_mpm_return_free_fields(const mpsi_boundaries *boundaries);
/* free_field_step.c: node of the column beside node k of the block at `at`, and the plane that this
 * node is in, counted from the side; NULL: none. */
const mpsi_field_node *mpsi_mpm_beside(const mpsi_grid *grid, const mpsi_boundary *boundary,
                                       const int32_t *at, int k, int *plane);
