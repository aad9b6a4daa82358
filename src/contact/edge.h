/* edge.h - faces of a body that bear particles up to an edge inset from their own, in the plane:
 * docs/theory/contact.md derives it. One particle bears at the inset edge itself; beyond it is a
 * strip in which no particle is borne. SPDX-License-Identifier: BSD-3-Clause */
#pragma once

#include "body/body_internal.h"

/* The inset edge that is nearest to the foot of a particle on its face. */
typedef struct mpsi_inset_edge {
  int32_t point; /* 1 + 2 k + c: where edge k of the polygon ends before its corner c (0, 1); 0:
                    none, or the foot is a corner of the body */
  double inside; /* m, of the foot within it, along the face; < 0 beyond; INFINITY: no inset edge */
  double shift[3]; /* m, from the foot to it */
} mpsi_inset_edge;

/* Writes the distances (m) by which the faces of a polygon end before their first and their second
 * corner, one pair an edge, for the inset `inset` (m) of a right angle. `axial`: the body turns
 * about x = 0. */
void mpsi_edge_insets(const mps_body *body, double inset, bool axial, double (*out)[2]);
/* The inset edge that the foot of a particle is beyond, or nearest to. */
mpsi_inset_edge mpsi_edge_find(const mps_body *body, const double (*inset)[2],
                               const mpsi_foot *foot);
