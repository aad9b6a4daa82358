/* edge.c - see edge.h. The velocities of a grid turn from those of a face to those of free ground
 * within a width of about half a cell beyond the last place at which the face bears. A face that
 * bears up to that much before its edge, wherever particles are, is as wide as the edge says.
 *
 * At a corner that turns by tau, with the inner angle a, the inset is that of a right angle times
 * max(1, cot(a/2)): the point at that distance from both faces lies an inset below them. Corners of
 * less than 5 degrees are those of a curve; between 5 and 15 degrees the inset grows to its full
 * length. Two insets that are longer than their face end in its middle.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "edge.h"

#include "body/rotation.h"

#include <string.h>

#define DEGREE (3.14159265358979323846 / 180.0)
#define CURVE (5.0 * DEGREE)
#define EDGE (15.0 * DEGREE)
#define TINY 1e-6 /* of an inset or a half spacing: round-off of lattices */

/* Corner k of the polygon in space; that before the first is the last. */
static void corner_at(const mps_body *body, int64_t k, double *out) {
  const double *xy = body->xy + 2 * ((k + body->edges) % body->edges), *R = body->pose.R;
  out[0] = body->pose.x[0] + (R[0] * xy[0] + R[1] * xy[1]);
  out[1] = body->pose.x[1] + (R[3] * xy[0] + R[4] * xy[1]);
}

/* Distance (m) by which both faces of corner k end before it. On the axis of a solid of revolution
 * an edge along the axis is none: the next one is the mirror image of the other. */
static double inset_at(const mps_body *body, int64_t k, double inset, bool axial) {
  double before[2], at[2], after[2], in[2], out[2];
  corner_at(body, k - 1, before), corner_at(body, k, at), corner_at(body, k + 1, after);
  const double tiny = TINY * inset;
  const bool apex = axial && fabs(at[0]) < tiny;
  for (int c = 0; c < 2; c++) in[c] = at[c] - before[c], out[c] = after[c] - at[c];
  if (apex && fabs(before[0]) < tiny)
    in[0] = out[0], in[1] = -out[1];
  else if (apex && fabs(after[0]) < tiny)
    out[0] = in[0], out[1] = -in[1];
  const double turn = atan2(in[0] * out[1] - in[1] * out[0], in[0] * out[0] + in[1] * out[1]);
  const double part = fmin(1.0, fmax(0.0, (turn - CURVE) / (EDGE - CURVE)));
  const double cotangent = tan(0.5 * fmax(0.0, turn));
  return inset * part * (apex ? cotangent : fmax(1.0, cotangent));
}

void mpsi_edge_insets(const mps_body *body, double inset, bool axial, double (*out)[2]) {
  for (int64_t k = 0; k < body->edges; k++) {
    double a[2], b[2];
    corner_at(body, k, a), corner_at(body, k + 1, b);
    const double length = hypot(b[0] - a[0], b[1] - a[1]);
    out[k][0] = inset_at(body, k, inset, axial);
    out[k][1] = inset_at(body, k + 1, inset, axial);
    const double sum = out[k][0] + out[k][1];
    for (int c = 0; c < 2 && sum > length; c++) out[k][c] *= length / sum;
  }
}

/* The edge on which the foot lies; the distance along it from its first corner, and its length. */
static int64_t edge_of(const mps_body *body, const mpsi_foot *foot, double *along, double *length,
                       double *tangent) {
  const int64_t k = body->face_of[0] == 0 ? foot->face : body->edges - 1 - foot->face;
  double a[2], b[2];
  corner_at(body, k, a), corner_at(body, k + 1, b);
  *length = hypot(b[0] - a[0], b[1] - a[1]);
  for (int c = 0; c < 2; c++) tangent[c] = (b[c] - a[c]) / *length;
  *along = (foot->at[0] - a[0]) * tangent[0] + (foot->at[1] - a[1]) * tangent[1];
  return k;
}

mpsi_inset_edge mpsi_edge_find(const mps_body *body, const double (*inset)[2],
                               const mpsi_foot *foot) {
  double along, length, tangent[2];
  mpsi_inset_edge out = {.inside = INFINITY};
  const int64_t k = edge_of(body, foot, &along, &length, tangent);
  const double *end = inset[k], to[2] = {along, length - along};
  if (foot->narrowing == 0.0) { /* a corner: of the end that is nearer */
    if (end[along > 0.5 * length] > 0.0) out.inside = -INFINITY;
    return out;
  }
  for (int c = 0; c < 2; c++) {
    if (!(end[c] > 0.0) || !(to[c] - end[c] < out.inside)) continue;
    out.inside = to[c] - end[c];
    out.point = (int32_t)(1 + 2 * k + c);
    for (int a = 0; a < 2; a++) out.shift[a] = (c == 0 ? -out.inside : out.inside) * tangent[a];
  }
  return out;
}
