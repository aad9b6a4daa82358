/* test_mesh_threads.c - the nearest point of a mesh, requested by many threads at once: the same
 * bits as by one, and from another copy of the mesh. SPDX-License-Identifier: BSD-3-Clause */
#include "body/body_internal.h"
#include "mesh_shapes.h"
#include "pthread_executor.h"
#include "test_common.h"

enum { POINTS = 8000, BLOCK = 100 };

typedef struct quest {
  const mps_body *body;
  double x[POINTS][3];
  mpsi_foot foot[POINTS];
} quest;

static void find(void *data, int64_t block, int32_t worker) {
  quest *q = data;
  for (int64_t i = BLOCK * block; i < BLOCK * (block + 1); i++)
    q->foot[i] = mpsi_body_foot(q->body, q->x[i]);
}

/* Points of a lattice through the middle: many have several feet as near. */
static void fill(quest *q) {
  for (int i = 0; i < POINTS; i++) {
    q->x[i][0] = 0.15 * (i % 20 - 10);
    q->x[i][1] = 0.15 * (i / 20 % 20 - 10);
    q->x[i][2] = 0.15 * (i / 400 - 10);
  }
}

TEST(same_bits) {
  static mesh_shape shape;
  static quest q[2];
  mesh_sphere(&shape, 3);
  for (int k = 0; k < 2; k++) {
    int32_t threads = k ? 4 : 1;
    const mps_context_def def = pthread_executor_def(&threads);
    scoped_context *context = NULL;
    scoped_body *body = NULL;
    char text[256];
    if (mps_context_create(&def, &context, text, sizeof text) != MPS_OK) fail_msg("%s", text);
    OK(mps_body_create_mesh(context, NULL, 3 * shape.triangles, shape.xyz, shape.triangles,
                            shape.corner, &body));
    q[k].body = body;
    fill(&q[k]);
    OK(mps_context_parallel_for(context, POINTS / BLOCK, find, &q[k]));
  }
  assert_memory_equal(q[0].foot, q[1].foot, sizeof q[0].foot);
}
