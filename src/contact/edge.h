/* edge.h - faces of a body that bear particles up to an edge inset from their own, in the plane:
 * docs/theory/contact.md derives it. Beyond the inset edge is a strip in which no particle is
 * borne. SPDX-License-Identifier: BSD-3-Clause */
#pragma once

#include "body/body_internal.h"

/* Where the foot of a particle lies on its face. */
typedef enum mpsi_edge_place {
  MPSI_EDGE_INNER, /* within the inset edge, or the face has none: the body bears it at its foot */
  MPSI_EDGE_AT,    /* within half a spacing of the inset edge: the body bears it there */
  MPSI_EDGE_STRIP  /* beyond, or at an edge of the body: the body does not bear it */
} mpsi_edge_place;

/* Writes the distances (m) by which the faces of a polygon end before their first and their second
 * corner, one pair an edge, for the inset `inset` (m) of a right angle. `axial`: the body turns
 * about x = 0. */
void mpsi_edge_insets(const mps_body *body, double inset, bool axial, double (*out)[2]);
/* Place of the foot of a particle whose half spacing is `half` (m); `shift` (m) moves the foot to
 * the inset edge, 0 elsewhere. */
mpsi_edge_place mpsi_edge_find(const mps_body *body, const double (*inset)[2], double half,
                               const mpsi_foot *foot, double *shift);
