/* test_stl.c - damaged STL files: whatever the bytes, the outcome is a closed surface with finite
 * distances, or a clean error that names the place, and nothing leaks.
 *
 * As a test: some thousand mutations of a block in both notations, from a fixed seed (run it under
 * the asan preset too). With libFuzzer:
 *   clang -g -O1 -fsanitize=fuzzer,address,undefined -DMPS_LIBFUZZER -D_POSIX_C_SOURCE=200809L \
 *     -Iinclude -Isrc -Itests tests/fuzz/test_stl.c src/body/[bdmrs]*.c src/core/[a-z]*.c \
 *     -llapacke -lembree3 -lm -o fuzz
 *   ./fuzz -max_len=4096 corpus
 * SPDX-License-Identifier: BSD-3-Clause */
#include "body/mesh.h"
#include "mesh_shapes.h"
#include "test_allocator.h"

/* Called with what is wrong: a crash for libFuzzer, a failed test for cmocka. */
#ifdef MPS_LIBFUZZER
#define BROKEN(...) abort()
#else
#define BROKEN(...) fail_msg(__VA_ARGS__)
#endif

static void check_mesh(const mpsi_mesh *mesh) {
  for (int k = 0; k < 20; k++) {
    double x[3];
    for (int c = 0; c < 3; c++)
      x[c] = mesh->middle[c] + mesh->size * (0.13 * k - 1.3 + 0.7 * c * (k % 3 - 1));
    const mpsi_foot f = mpsi_mesh_foot(mesh, x);
    if (!isfinite(f.distance) || f.face < 0 || f.face >= mesh->triangles)
      BROKEN("distance %g, face %lld", f.distance, (long long)f.face);
    for (int c = 0; c < 3; c++)
      if (!isfinite(f.normal[c]) || !isfinite(f.at[c])) BROKEN("normal or foot not finite");
  }
}

/* True if the file is read; a mesh may then still be refused as not closed. */
static bool check_file(const char *data, size_t size) {
  test_allocator allocator = {0};
  mps_context *context = test_allocator_context(&allocator);
  if (!context) BROKEN("no context");
  int64_t triangles = 0;
  double *xyz = NULL;
  mpsi_mesh *mesh = NULL;
  const mps_status read =
      mpsi_stl_read(context, "fuzz", "fuzz", data, (int64_t)size, 1e-3, &triangles, &xyz);
  const char *message = mps_context_error(context)->message;
  if (read == MPS_OK) {
    const mps_status status =
        mpsi_mesh_create(context, "fuzz", 3 * triangles, xyz, triangles, NULL, &mesh);
    if (status != MPS_OK && status != MPS_ERROR_ARGUMENT) BROKEN("%s", message);
    if ((status == MPS_OK) != (mesh != NULL)) BROKEN("status %d, mesh or not", (int)status);
    if (mesh) check_mesh(mesh);
  } else {
    long long place = -1;
    const bool named =
        sscanf(message, "fuzz:@%lld: ", &place) == 1 || sscanf(message, "fuzz:%lld: ", &place) == 1;
    if (read != MPS_ERROR_FORMAT || !named || place < 0) BROKEN("no place: %s", message);
    if (xyz) BROKEN("numbers in spite of an error");
  }
  mpsi_mesh_destroy(context, mesh);
  mpsi_free(context, xyz);
  mps_context_destroy(&context);
  if (allocator.live != 0) BROKEN("%lld allocations left", (long long)allocator.live);
  return read == MPS_OK;
}

#ifdef MPS_LIBFUZZER

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);
int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
  check_file((const char *)data, size);
  return 0;
}

#else

#include "mutation.h"

static mesh_shape block;

static size_t ascii_sample(char *data) {
  size_t size = (size_t)sprintf(data, "solid block\n");
  for (int64_t t = 0; t < block.triangles; t++) {
    size += (size_t)sprintf(data + size, "facet normal 0 0 0\nouter loop\n");
    for (int k = 0; k < 3; k++) {
      const double *x = block.xyz + 9 * t + 3 * k;
      size += (size_t)sprintf(data + size, "vertex %g %g %g\n", x[0], x[1], x[2]);
    }
    size += (size_t)sprintf(data + size, "endloop\nendfacet\n");
  }
  return size + (size_t)sprintf(data + size, "endsolid block\n");
}

static size_t binary_sample(char *data) {
  memset(data, 0, ROOM);
  data[80] = (char)block.triangles;
  for (int64_t t = 0; t < block.triangles; t++)
    for (int k = 0; k < 9; k++) {
      const float value = (float)block.xyz[9 * t + k];
      uint32_t bits;
      memcpy(&bits, &value, sizeof bits);
      for (int b = 0; b < 4; b++) data[84 + 50 * t + 12 + 4 * k + b] = (char)(bits >> (8 * b));
    }
  return 84 + 50 * (size_t)block.triangles;
}

/* One small damage, of kinds that occur in files or are hard for a parser. */
static size_t mutate(char *data, size_t size) {
  static const char *const words[] = {
      "solid", "endsolid", "facet", "endfacet", "outer loop", "endloop", "vertex", "normal", "nan",
      "inf",   "1e999",    "-1e39", "1e-310",   "0x1p3",      "-",       ".",      "\n",     " "};
  const size_t at = size > 0 ? random_below((uint32_t)size) : 0;
  const char byte = (char)random_below(256);
  switch (random_below(size > 0 ? 7 : 1)) {
  case 0: {
    const char *word = words[random_below(sizeof words / sizeof *words)];
    return replace(data, size, at, random_below(8), word, strlen(word));
  }
  case 1: /* a byte: keeps binary files as long as they are */
    return replace(data, size, at, 1, &byte, 1);
  case 2: /* a digit: keeps numbers numbers */
    return replace(data, size, at, 1, &"0123456789"[random_below(10)], 1);
  case 3: /* lost bytes */
    return random_below(4) ? size : replace(data, size, at, random_below(100), "", 0);
  case 4: /* cut short */
    return random_below(8) ? size : at;
  case 5: /* a piece twice */
    return random_below(4) ? size
                           : replace(data, size, at, 0, data + at, size - at < 50 ? size - at : 50);
  default: /* one byte in another's place */
    return replace(data, size, at, 1, &data[random_below((uint32_t)size)], 1);
  }
}

static void fuzz(const char *name, size_t (*make)(char *data), int runs) {
  static char sample[ROOM], data[ROOM];
  mesh_block(&block, 0.5);
  const size_t length = make(sample);
  assert_true(check_file(sample, length));
  random_state = 20240229u;
  int accepted = 0;
  for (int run = 0; run < runs; run++) {
    memcpy(data, sample, length);
    size_t size = length;
    for (uint32_t n = 1 + random_below(3); n > 0; n--) size = mutate(data, size);
    /* as long as the file: the sanitizer sees a read past it */
    char *exact = malloc(size > 0 ? size : 1);
    assert_non_null(exact);
    memcpy(exact, data, size);
    accepted += check_file(exact, size);
    free(exact);
  }
  print_message("%s: %d of %d mutations still read\n", name, accepted, runs);
  assert_true(accepted > runs / 100 && accepted < runs * 99 / 100); /* both ways are tried */
}

TEST(damaged_text) { fuzz("ASCII", ascii_sample, 4000); }

TEST(damaged_binary) { fuzz("binary", binary_sample, 4000); }

#endif
