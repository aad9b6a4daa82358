/* test_mesh.c - bodies from meshes and STL files: what is refused and why, both notations of a
 * file, parts, lack of memory. SPDX-License-Identifier: BSD-3-Clause */
#include "mesh_shapes.h"
#include "test_allocator.h"
#include "test_fixture.h"

#include <mps/body.h>

#define FILE_NAME TEST_TMP "/mesh.stl"

static mesh_shape block;

static mps_status create(mps_body **body) {
  return mps_body_create_mesh(context, NULL, 3 * block.triangles, block.xyz, block.triangles,
                              block.corner, body);
}

static void refuses_bad_arrays(void **state) {
  (void)state;
  mps_body *body = (mps_body *)1;
  mesh_block(&block, 0.3);
  mps_assert_fails(context, mps_body_create_mesh(context, NULL, 6, NULL, 4, block.corner, &body),
                   MPS_ERROR_ARGUMENT, "xyz is NULL");
  assert_null(body);
  mps_assert_fails(context, mps_body_create_mesh(context, NULL, 6, block.xyz, 4, NULL, &body),
                   MPS_ERROR_ARGUMENT, "corner is NULL");
  mps_assert_fails(context,
                   mps_body_create_mesh(context, NULL, 6, block.xyz, 3, block.corner, &body),
                   MPS_ERROR_ARGUMENT, "triangles is 3");
  mps_assert_fails(context,
                   mps_body_create_mesh(context, NULL, 3, block.xyz, 4, block.corner, &body),
                   MPS_ERROR_ARGUMENT, "vertices is 3");
  block.corner[7] = -1;
  mps_assert_fails(context, create(&body), MPS_ERROR_ARGUMENT, "triangle 2 has the corner -1");
  mesh_block(&block, 0.3);
  block.xyz[9 * 5 + 4] = INFINITY;
  mps_assert_fails(context, create(&body), MPS_ERROR_ARGUMENT, "vertex 16 has y = inf m");
  mps_body_def def = mps_body_defaults();
  def.damping[0] = -1.0;
  mesh_block(&block, 0.3);
  mps_assert_fails(context,
                   mps_body_create_mesh(context, &def, 3 * block.triangles, block.xyz,
                                        block.triangles, block.corner, &body),
                   MPS_ERROR_ARGUMENT, "damping[0] is -1");
}

/* Every way in which triangles are not the surface of a solid. */
static void refuses_what_is_not_closed(void **state) {
  (void)state;
  mps_body *body = NULL;
  mesh_block(&block, 0.3);
  block.triangles--; /* triangle 18 is the other at the edge of the missing one */
  mps_assert_fails(context, create(&body), MPS_ERROR_ARGUMENT, "belongs to no other triangle");
  mesh_block(&block, 0.3);
  const int32_t second = block.corner[3 * 6 + 1];
  block.corner[3 * 6 + 1] = block.corner[3 * 6 + 2], block.corner[3 * 6 + 2] = second;
  mps_assert_fails(context, create(&body), MPS_ERROR_ARGUMENT, "turned inside out");
  mesh_block(&block, 0.3);
  const double up[3] = {0.5, 0.5, 5.0};
  mesh_add(&block, block.xyz, block.xyz + 3, up);
  mps_assert_fails(context, create(&body), MPS_ERROR_ARGUMENT,
                   "the edge of triangle 20 from (0, 0, 0)");
  mesh_block(&block, 0.3);
  memcpy(block.xyz + 9 * 3 + 3, block.xyz + 9 * 3, 3 * sizeof(double));
  mps_assert_fails(context, create(&body), MPS_ERROR_ARGUMENT, "triangle 3 with the corners");
  const double p[4][3] = {{0, 0, 1}, {1, 0, 1}, {1, 1, 1}, {0, 1, 1}};
  block.triangles = 0; /* two sheets, one on the other */
  mesh_add(&block, p[0], p[1], p[2]);
  mesh_add(&block, p[0], p[2], p[3]);
  mesh_add(&block, p[0], p[3], p[1]);
  mesh_add(&block, p[1], p[3], p[2]);
  mps_assert_fails(context, create(&body), MPS_ERROR_ARGUMENT, "the mesh encloses 0 m3");
  assert_null(body);
}

/* Two tetrahedra that have one corner in common. */
static void refuses_a_pinched_surface(void **state) {
  (void)state;
  const double p[7][3] = {{0, 0, 0},  {1, 0, 0},  {0, 1, 0}, {0, 0, 1},
                          {-1, 0, 0}, {0, -1, 0}, {0, 0, -1}};
  static const int faces[8][3] = {{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3},
                                  {0, 4, 5}, {0, 6, 4}, {0, 5, 6}, {4, 6, 5}};
  mps_body *body = NULL;
  block.triangles = 0;
  for (int k = 0; k < 8; k++) mesh_add(&block, p[faces[k][0]], p[faces[k][1]], p[faces[k][2]]);
  mps_assert_fails(context, create(&body), MPS_ERROR_ARGUMENT, "have a single point in common");
  block.triangles = 4;
  mps_assert_ok(context, create(&body)); /* one of them is a body */
  mps_body_destroy(&body);
}

static void names_parts_of_a_mesh(void **state) {
  (void)state;
  mps_body *body = NULL;
  mesh_block(&block, 0.3);
  mps_assert_ok(context, create(&body));
  assert_int_equal(mps_body_dim(body), 3);
  mps_assert_fails(context, mps_body_name_part(body, "sides", 20, 1, NULL), MPS_ERROR_ARGUMENT,
                   "allowed are 0 to 19");
  mps_assert_ok(context, mps_body_name_part(body, "sides", 8, 12, NULL));
  const double x[6] = {0.2, 0.6, 0.29, 0.99, 0.2, 0.15};
  int64_t face[2];
  double n[6];
  mps_assert_ok(context, mps_body_distance(body, 2, x, NULL, n, NULL, face));
  assert_true(face[0] < 8 && face[1] >= 8);
  mps_assert_near(n[2], 1.0, 1e-15);
  mps_assert_near(n[3], 1.0, 1e-15);
  mps_body_destroy(&body);
}

/* ---- STL ------------------------------------------------------------------------------------- */

static void put(FILE *file, float value) {
  unsigned char bytes[4];
  uint32_t bits;
  memcpy(&bits, &value, sizeof bits);
  for (int k = 0; k < 4; k++) bytes[k] = (unsigned char)(bits >> (8 * k));
  assert_int_equal(fwrite(bytes, 1, 4, file), 4);
}

/* The block in millimetres; `cut` bytes are missing at the end, value `broken` is not a number. */
static void write_binary(const char *header, long cut, int64_t broken) {
  FILE *file = fopen(FILE_NAME, "wb");
  assert_non_null(file);
  char head[80] = "";
  strcpy(head, header);
  const uint32_t n = (uint32_t)block.triangles;
  const unsigned char count[4] = {(unsigned char)n, (unsigned char)(n >> 8), 0, 0};
  assert_int_equal(fwrite(head, 1, 80, file) + fwrite(count, 1, 4, file), 84);
  for (int64_t t = 0; t < block.triangles; t++) {
    for (int k = 0; k < 3; k++) put(file, 0.0f);
    for (int64_t k = 9 * t; k < 9 * t + 9; k++)
      put(file, k == broken ? NAN : (float)(1000.0 * block.xyz[k]));
    if (t < block.triangles - 1 || cut == 0) assert_int_equal(fwrite("\0\0", 1, 2, file), 2);
  }
  assert_int_equal(fclose(file), 0);
}

static void write_text(const char *text) {
  FILE *file = fopen(FILE_NAME, "wb");
  assert_non_null(file);
  fputs(text, file);
  assert_int_equal(fclose(file), 0);
}

static void write_ascii(const char *last) {
  FILE *file = fopen(FILE_NAME, "wb");
  assert_non_null(file);
  fprintf(file, "solid a block\r\n");
  for (int64_t t = 0; t < block.triangles; t++) {
    fprintf(file, " facet normal 0 0 0\n  outer loop\n");
    for (int k = 0; k < 3; k++) {
      const double *x = block.xyz + 9 * t + 3 * k;
      fprintf(file, "   vertex %.9g %.9E %g\n", 1000.0 * x[0], 1000.0 * x[1], 1000.0 * x[2]);
    }
    fprintf(file, "  endloop\n ENDFACET\n");
  }
  fputs(last, file);
  assert_int_equal(fclose(file), 0);
}

static mps_status load(mps_body **body) {
  return mps_body_create_stl(context, NULL, FILE_NAME, 1e-3, body);
}

static void reads_both_notations(void **state) {
  (void)state;
  mps_body *body[3] = {NULL};
  mesh_block(&block, 0.25);
  mps_assert_ok(context, create(&body[0]));
  write_binary("solid, but binary", 0, -1);
  mps_assert_ok(context, load(&body[1]));
  write_ascii("endsolid a block\n\n");
  mps_assert_ok(context, load(&body[2]));
  const double x[9] = {0.6, 0.6, 0.1, 0.4, 0.45, 0.2, -1.0, 2.0, 0.3};
  double d[3][3];
  for (int k = 0; k < 3; k++) {
    mps_assert_ok(context, mps_body_distance(body[k], 3, x, d[k], NULL, NULL, NULL));
    mps_body_destroy(&body[k]);
  }
  for (int k = 0; k < 9; k++) mps_assert_near(d[k / 3][k % 3], d[0][k % 3], 1e-15);
}

static void refuses_bad_files(void **state) {
  (void)state;
  mps_body *body = NULL;
  mesh_block(&block, 0.25);
  mps_assert_fails(context, mps_body_create_stl(context, NULL, NULL, 1.0, &body),
                   MPS_ERROR_ARGUMENT, "path is NULL");
  mps_assert_fails(context, mps_body_create_stl(context, NULL, FILE_NAME, -1.0, &body),
                   MPS_ERROR_ARGUMENT, "scale is -1");
  mps_assert_fails(context, mps_body_create_stl(context, NULL, "/nowhere/a.stl", 1.0, &body),
                   MPS_ERROR_IO, "/nowhere/a.stl: cannot open");
  write_binary("", 2, -1);
  mps_assert_fails(
      context, load(&body), MPS_ERROR_FORMAT,
      "mesh.stl:@80: 20 triangles make a binary STL file of 1084 bytes, this has 1082");
  write_binary("", 0, 9 * 3 + 4); /* 84 + 3 * 50 + 12 + 16 */
  mps_assert_fails(context, load(&body), MPS_ERROR_FORMAT, "mesh.stl:@262: triangle 3 has y = nan");
  write_text("abc");
  mps_assert_fails(context, load(&body), MPS_ERROR_FORMAT, "mesh.stl:@3: ends within the header");
  write_text("solid\nendsolid\n");
  mps_assert_fails(context, load(&body), MPS_ERROR_FORMAT, "mesh.stl:2: no triangles");
  write_text("solid s\nfacet normal 0 0 1\nouter loop\nvertex 0 0 nan\n");
  mps_assert_fails(context, load(&body), MPS_ERROR_FORMAT, "mesh.stl:4: z is \"nan\"");
  write_text("solid s\nfacet normal 0 0 1\nouter loop\nvertex 0 0\nvertex");
  mps_assert_fails(context, load(&body), MPS_ERROR_FORMAT, "mesh.stl:5: z is \"vertex\"");
  write_ascii("");
  mps_assert_fails(context, load(&body), MPS_ERROR_FORMAT, "the file ends without \"endsolid\"");
  write_ascii("endsolid\nsolid two\n");
  mps_assert_fails(context, load(&body), MPS_ERROR_FORMAT, "\"solid\" after \"endsolid\"");
  block.triangles--;
  write_binary("", 0, -1);
  mps_assert_fails(context, load(&body), MPS_ERROR_ARGUMENT, "a hole");
  assert_null(body);
}

/* ---- memory ---------------------------------------------------------------------------------- */

static mps_status make(mps_context *c, int what) {
  mps_body *body = NULL;
  const mps_status status = what == 0
                                ? mps_body_create_mesh(c, NULL, 3 * block.triangles, block.xyz,
                                                       block.triangles, block.corner, &body)
                                : mps_body_create_stl(c, NULL, FILE_NAME, 1e-3, &body);
  if (status != MPS_OK) assert_null(body);
  mps_body_destroy(&body);
  return status;
}

static void survives_lack_of_memory(void **state) {
  (void)state;
  mesh_block(&block, 0.25);
  test_allocator_sweep(make, 0);
  write_binary("", 0, -1);
  test_allocator_sweep(make, 1);
  write_ascii("endsolid\n");
  test_allocator_sweep(make, 1);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(refuses_bad_arrays),        cmocka_unit_test(refuses_what_is_not_closed),
      cmocka_unit_test(refuses_a_pinched_surface), cmocka_unit_test(names_parts_of_a_mesh),
      cmocka_unit_test(reads_both_notations),      cmocka_unit_test(refuses_bad_files),
      cmocka_unit_test(survives_lack_of_memory)};
  return cmocka_run_group_tests(tests, make_context, drop_context);
}
