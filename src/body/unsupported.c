/* unsupported.c - meshes in a libmps built without Embree.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "mesh.h"

static mps_status unsupported(mps_context *context, const char *function) {
  return mpsi_fail(context, function, MPS_ERROR_UNSUPPORTED,
                   "this libmps was built without Embree (CMake option MPS_EMBREE)");
}

mps_status mps_body_create_mesh(mps_context *context, const mps_body_def *def, int64_t vertices,
                                const double *xyz, int64_t triangles, const int32_t *corner,
                                mps_body **out) {
  if (out) *out = NULL;
  return unsupported(context, __func__);
}

mps_status mps_body_create_stl(mps_context *context, const mps_body_def *def, const char *path,
                               double scale, mps_body **out) {
  if (out) *out = NULL;
  return unsupported(context, __func__);
}

/* No mesh can exist. */
void mpsi_mesh_destroy(mps_context *context, mpsi_mesh *mesh) { (void)context, (void)mesh; }

mpsi_foot mpsi_mesh_foot(const mpsi_mesh *mesh, const double *x) {
  return (mpsi_foot){.distance = NAN};
}

double mpsi_mesh_wall(const mpsi_mesh *mesh, int64_t t) { return INFINITY; }
