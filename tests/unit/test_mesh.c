/* test_mesh.c - bodies from meshes and STL files: what is refused and why, both notations of a
 * file, parts, lack of memory. SPDX-License-Identifier: BSD-3-Clause */
#include "kit/random.h"
#include "mesh_shapes.h"
#include "test_allocator.h"
#include "test_fixture.h"

#define FILE_NAME TEST_TMP "/mesh.stl"

static mesh_shape block;

static mps_status create(mps_body **body) {
  return mps_body_create_mesh(context, NULL, 3 * block.triangles, block.xyz, block.triangles,
                              block.corner, body);
}

TEST(refuses_bad_arrays) {
  mps_body *body = (mps_body *)1;
  mesh_block(&block, 0.3);
  REFUSES(mps_body_create_mesh(context, NULL, 6, NULL, 4, block.corner, &body), "xyz is NULL");
  assert_null(body);
  REFUSES(mps_body_create_mesh(context, NULL, 6, block.xyz, 4, NULL, &body), "corner is NULL");
  REFUSES(mps_body_create_mesh(context, NULL, 6, block.xyz, 3, block.corner, &body),
          "triangles is 3");
  REFUSES(mps_body_create_mesh(context, NULL, 3, block.xyz, 4, block.corner, &body),
          "vertices is 3");
  block.corner[7] = -1;
  REFUSES(create(&body), "triangle 2 has the corner -1");
  mesh_block(&block, 0.3);
  block.xyz[9 * 5 + 4] = INFINITY;
  REFUSES(create(&body), "vertex 16 has y = inf m");
  DEF(body, def, .damping[0] = -1.0);
  mesh_block(&block, 0.3);
  REFUSES(mps_body_create_mesh(context, &def, 3 * block.triangles, block.xyz, block.triangles,
                               block.corner, &body),
          "damping[0] is -1");
}

/* Every way in which triangles are not the surface of a solid. */
TEST(refuses_what_is_not_closed) {
  mps_body *body = NULL;
  mesh_block(&block, 0.3);
  block.triangles--; /* triangle 18 is the other at the edge of the missing one */
  REFUSES(create(&body), "belongs to no other triangle");
  mesh_block(&block, 0.3);
  const int32_t second = block.corner[3 * 6 + 1];
  block.corner[3 * 6 + 1] = block.corner[3 * 6 + 2], block.corner[3 * 6 + 2] = second;
  REFUSES(create(&body), "turned inside out");
  mesh_block(&block, 0.3);
  const double up[3] = {0.5, 0.5, 5.0};
  mesh_add(&block, block.xyz, block.xyz + 3, up);
  REFUSES(create(&body), "the edge of triangle 20 from (0, 0, 0)");
  mesh_block(&block, 0.3);
  memcpy(block.xyz + 9 * 3 + 3, block.xyz + 9 * 3, 3 * sizeof(double));
  REFUSES(create(&body), "triangle 3 with the corners");
  const double p[4][3] = {{0, 0, 1}, {1, 0, 1}, {1, 1, 1}, {0, 1, 1}};
  block.triangles = 0; /* two sheets, one on the other */
  mesh_add(&block, p[0], p[1], p[2]);
  mesh_add(&block, p[0], p[2], p[3]);
  mesh_add(&block, p[0], p[3], p[1]);
  mesh_add(&block, p[1], p[3], p[2]);
  REFUSES(create(&body), "the mesh encloses 0 m3");
  assert_null(body);
}

/* Two tetrahedra that have one corner in common. */
TEST(refuses_a_pinched_surface) {
  const double p[7][3] = {{0, 0, 0},  {1, 0, 0},  {0, 1, 0}, {0, 0, 1},
                          {-1, 0, 0}, {0, -1, 0}, {0, 0, -1}};
  static const int faces[8][3] = {{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3},
                                  {0, 4, 5}, {0, 6, 4}, {0, 5, 6}, {4, 6, 5}};
  scoped_body *body = NULL;
  block.triangles = 0;
  for (int k = 0; k < 8; k++) mesh_add(&block, p[faces[k][0]], p[faces[k][1]], p[faces[k][2]]);
  REFUSES(create(&body), "have a single point in common");
  block.triangles = 4;
  OK(create(&body)); /* one of them is a body */
}

TEST(names_parts_of_a_mesh) {
  scoped_body *body = NULL;
  mesh_block(&block, 0.3);
  OK(create(&body));
  assert_int_equal(mps_body_dim(body), 3);
  REFUSES(mps_body_name_part(body, "sides", 20, 1, NULL), "are numbered 0 to 19");
  OK(mps_body_name_part(body, "sides", 8, 12, NULL));
  const double x[6] = {0.2, 0.6, 0.29, 0.99, 0.2, 0.15};
  int64_t face[2];
  double n[6];
  OK(mps_body_distance(body, 2, x, NULL, n, NULL, face));
  assert_true(face[0] < 8 && face[1] >= 8);
  NEAR(n[2], 1.0, 1e-15);
  NEAR(n[3], 1.0, 1e-15);
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

TEST(reads_both_notations) {
  mps_body *body[3] = {NULL};
  mesh_block(&block, 0.25);
  OK(create(&body[0]));
  write_binary("solid, but binary", 0, -1);
  OK(load(&body[1]));
  write_ascii("endsolid a block\n\n");
  OK(load(&body[2]));
  const double x[9] = {0.6, 0.6, 0.1, 0.4, 0.45, 0.2, -1.0, 2.0, 0.3};
  double d[3][3];
  for (int k = 0; k < 3; k++) {
    OK(mps_body_distance(body[k], 3, x, d[k], NULL, NULL, NULL));
    mps_body_destroy(&body[k]);
  }
  for (int k = 0; k < 9; k++) NEAR(d[k / 3][k % 3], d[0][k % 3], 1e-15);
}

TEST(refuses_bad_files) {
  mps_body *body = NULL;
  mesh_block(&block, 0.25);
  REFUSES(mps_body_create_stl(context, NULL, NULL, 1.0, &body), "path is NULL");
  REFUSES(mps_body_create_stl(context, NULL, FILE_NAME, -1.0, &body), "scale is -1");
  FAILS(mps_body_create_stl(context, NULL, "/nowhere/a.stl", 1.0, &body), MPS_ERROR_IO,
        "/nowhere/a.stl'");
  write_binary("", 2, -1);
  FAILS(load(&body), MPS_ERROR_FORMAT,
        "mesh.stl:@80: 20 triangles make a binary STL file of 1084 bytes, this has 1082");
  write_binary("", 0, 9 * 3 + 4); /* 84 + 3 * 50 + 12 + 16 */
  FAILS(load(&body), MPS_ERROR_FORMAT, "mesh.stl:@262: triangle 3 has y = nan");
  write_text("abc");
  FAILS(load(&body), MPS_ERROR_FORMAT, "mesh.stl:@3: ends within the header");
  write_text("solid\nendsolid\n");
  FAILS(load(&body), MPS_ERROR_FORMAT, "mesh.stl:2: no triangles");
  write_text("solid s\nfacet normal 0 0 1\nouter loop\nvertex 0 0 nan\n");
  FAILS(load(&body), MPS_ERROR_FORMAT, "mesh.stl:4: z is \"nan\"");
  write_text("solid s\nfacet normal 0 0 1\nouter loop\nvertex 0 0\nvertex");
  FAILS(load(&body), MPS_ERROR_FORMAT, "mesh.stl:5: z is \"vertex\"");
  write_ascii("");
  FAILS(load(&body), MPS_ERROR_FORMAT, "the file ends without \"endsolid\"");
  write_ascii("endsolid\nsolid two\n");
  FAILS(load(&body), MPS_ERROR_FORMAT, "\"solid\" after \"endsolid\"");
  block.triangles--;
  write_binary("", 0, -1);
  REFUSES(load(&body), "a hole");
  assert_null(body);
}

/* ---- corners that are nearly the same -------------------------------------------------------- */

/* Every corner of every triangle is off by up to `off` along each axis. */
static void shake_corners(mesh_shape *m, double off) {
  uint64_t state = 5;
  for (int64_t k = 0; k < 9 * m->triangles; k++) m->xyz[k] += off * noise(&state);
}

/* The same triangles in another order, each from another of its corners. */
static void shuffle(mesh_shape *m) {
  uint64_t state = 11;
  for (int64_t t = m->triangles - 1; t > 0; t--) {
    const int64_t other = (int64_t)((noise(&state) * 0.5 + 0.5) * (double)(t + 1));
    double a[9], b[9];
    memcpy(a, m->xyz + 9 * t, sizeof a), memcpy(b, m->xyz + 9 * other, sizeof b);
    for (int k = 0; k < 9; k++) m->xyz[9 * t + k] = b[(k + 3) % 9], m->xyz[9 * other + k] = a[k];
  }
}

static void find_distances(double *out) {
  scoped_body *body = NULL;
  uint64_t state = 3;
  OK(create(&body));
  for (int k = 0; k < 40; k++) {
    const double x[3] = {1.5 * noise(&state), 1.5 * noise(&state), 1.5 * noise(&state)};
    OK(mps_body_distance(body, 1, x, &out[k], NULL, NULL, NULL));
  }
}

TEST(joins_corners_that_are_nearly_the_same) {
  static mesh_shape shapes[3];
  mesh_sphere(&shapes[0], 3), mesh_torus(&shapes[1]), mesh_block(&shapes[2], 0.3);
  for (int s = 0; s < 3; s++) {
    double exact[40], near[40], other[40];
    block = shapes[s];
    find_distances(exact);
    shake_corners(&block, 2e-7); /* two corners are up to 7e-7 apart; the size is 2 or more */
    find_distances(near);
    shuffle(&block);
    find_distances(other);
    for (int k = 0; k < 40; k++) {
      NEAR(near[k], exact[k], 1e-6);
      NEAR(other[k], near[k], 1e-14);
    }
  }
}

/* A hole stays a hole, and the message says how far the next corner is. */
TEST(joins_no_more_than_that) {
  mps_body *body = NULL;
  mesh_sphere(&block, 2);
  shake_corners(&block, 1e-5);
  REFUSES(create(&body), "a hole; the next corner at a hole");
  REFUSES(create(&body), "e-06 m apart are joined");
  mesh_sphere(&block, 2);
  shake_corners(&block, 2e-7);
  block.triangles--;
  REFUSES(create(&body), "a hole");
  write_binary("", 0, -1);
  REFUSES(load(&body), "mesh.stl': the edge of triangle");
  /* a fine strip of triangles, whose corners follow one another at less than that */
  mesh_block(&block, 0.3);
  for (int k = 0; k < 60; k++) {
    const double a[3] = {5e-7 * k, 3.0, 3.0}, b[3] = {5e-7 * (k + 1), 3.0, 3.0};
    const double c[3] = {5e-7 * k, 3.0 + 5e-7, 3.0};
    mesh_add(&block, a, b, c);
  }
  REFUSES(create(&body), "a hole");
  assert_null(body);
}

/* ---- memory ---------------------------------------------------------------------------------- */

static mps_status make(mps_context *c, int what) {
  scoped_body *body = NULL;
  const mps_status status = what == 0
                                ? mps_body_create_mesh(c, NULL, 3 * block.triangles, block.xyz,
                                                       block.triangles, block.corner, &body)
                                : mps_body_create_stl(c, NULL, FILE_NAME, 1e-3, &body);
  if (status != MPS_OK) assert_null(body);
  return status;
}

TEST(survives_lack_of_memory) {
  mesh_block(&block, 0.25);
  test_allocator_sweep(make, 0);
  write_binary("", 0, -1);
  test_allocator_sweep(make, 1);
  write_ascii("endsolid\n");
  test_allocator_sweep(make, 1);
  shake_corners(&block, 2e-8);
  test_allocator_sweep(make, 0);
}
