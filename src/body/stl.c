/* stl.c - triangles from an STL file, binary or ASCII. The format has no version and no checksum:
 * so the size must match the count to the byte, and the text the grammar to the word.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "mesh.h"

#include "core/base/text.h"

#include <string.h>

/* Binary: 80 bytes of any text, the number of triangles, then for each its normal, three corners (4
 * byte floats) and 2 bytes more. All little endian. */
enum { HEADER = 84, FACET = 50, CORNERS = 12 };

/* ---- binary ---------------------------------------------------------------------------------- */

static uint32_t read_u32(const char *data) {
  const unsigned char *b = (const unsigned char *)data;
  return (uint32_t)b[0] | (uint32_t)b[1] << 8 | (uint32_t)b[2] << 16 | (uint32_t)b[3] << 24;
}

static float read_float(const char *data) {
  const uint32_t bits = read_u32(data);
  float value;
  memcpy(&value, &bits, sizeof value);
  return value;
}

static mps_status read_binary(mps_context *context, const char *function, const char *path,
                              const char *data, int64_t size, double scale, int64_t *triangles,
                              double **xyz) {
  const char *tail = mpsi_path_tail(path);
  if (size < HEADER)
    return mpsi_fail(
        context, function, MPS_ERROR_FORMAT,
        "%s:@%lld: ends within the header of a binary STL file (84 bytes), and does not "
        "begin with \"solid\" as an ASCII one",
        tail, (long long)size);
  const int64_t count = (int64_t)read_u32(data + HEADER - 4);
  if (size != HEADER + FACET * count)
    return mpsi_fail(context, function, MPS_ERROR_FORMAT,
                     "%s:@80: %lld triangles make a binary STL file of %lld bytes, this has %lld",
                     tail, (long long)count, (long long)(HEADER + FACET * count), (long long)size);
  if (count < 1 || count > MPSI_MESH_MAX_TRIANGLES)
    return mpsi_fail(context, function, MPS_ERROR_FORMAT,
                     "%s:@80: %lld triangles, allowed are 1 to %d", tail, (long long)count,
                     MPSI_MESH_MAX_TRIANGLES);
  double *out = mpsi_alloc(context, 9 * count, sizeof *out);
  if (!out) return mpsi_fail_memory(context, function, (size_t)count * 9 * sizeof *out);
  for (int64_t t = 0; t < count; t++)
    for (int k = 0; k < 9; k++) {
      const int64_t at = HEADER + FACET * t + CORNERS + 4 * k;
      const double value = (double)read_float(data + at);
      out[9 * t + k] = scale * value;
      if (isfinite(out[9 * t + k])) continue;
      mpsi_free(context, out);
      return mpsi_fail(context, function, MPS_ERROR_FORMAT,
                       "%s:@%lld: triangle %lld has %c = %g with scale %g, must be finite", tail,
                       (long long)at, (long long)t, "xyz"[k % 3], value, scale);
    }
  *triangles = count;
  *xyz = out;
  return MPS_OK;
}

/* ---- ASCII ----------------------------------------------------------------------------------- */

/* A text and the rest of its line. */
typedef struct reader {
  mpsi_text text;
  mpsi_slice line;
} reader;

static bool is_word(mpsi_slice word, const char *name) {
  mpsi_slice after;
  return mpsi_slice_starts(word, name, &after) && mpsi_slice_size(after) == 0;
}

static mps_status expect(reader *r, const char *name) {
  mpsi_slice word;
  if (!mpsi_text_word(&r->text, &r->line, &word))
    return mpsi_text_fail(&r->text, "the file ends where \"%s\" must be", name);
  if (!is_word(word, name))
    return mpsi_text_fail(&r->text, "\"%s\" where \"%s\" must be", mpsi_slice_quote(word).text,
                          name);
  return MPS_OK;
}

static mps_status read_number(reader *r, const char *what, double *out) {
  mpsi_slice word;
  if (!mpsi_text_word(&r->text, &r->line, &word))
    return mpsi_text_fail(&r->text, "the file ends where %s must be", what);
  return mpsi_text_number(&r->text, word, what, out);
}

/* What follows "facet". */
static mps_status read_facet(reader *r, double scale, double *xyz) {
  static const char *const names[] = {"x", "y", "z"};
  double unused;
  mps_status status = expect(r, "normal");
  for (int c = 0; c < 3 && status == MPS_OK; c++) status = read_number(r, "the normal", &unused);
  if (status == MPS_OK) status = expect(r, "outer");
  if (status == MPS_OK) status = expect(r, "loop");
  for (int k = 0; k < 9 && status == MPS_OK; k++) {
    if (k % 3 == 0) status = expect(r, "vertex");
    if (status == MPS_OK) status = read_number(r, names[k % 3], &xyz[k]);
    if (status != MPS_OK) break;
    xyz[k] *= scale;
    if (!isfinite(xyz[k]))
      status = mpsi_text_fail(&r->text, "%s is too large with scale %g", names[k % 3], scale);
  }
  if (status == MPS_OK) status = expect(r, "endloop");
  return status == MPS_OK ? expect(r, "endfacet") : status;
}

static mps_status read_facets(reader *r, double scale, int64_t *count, double **xyz) {
  int64_t capacity = 0;
  for (;;) {
    mpsi_slice word;
    if (!mpsi_text_word(&r->text, &r->line, &word))
      return mpsi_text_fail(&r->text, "the file ends without \"endsolid\"");
    if (is_word(word, "endsolid")) return MPS_OK;
    if (!is_word(word, "facet"))
      return mpsi_text_fail(&r->text, "\"%s\" where \"facet\" or \"endsolid\" must be",
                            mpsi_slice_quote(word).text);
    if (*count == MPSI_MESH_MAX_TRIANGLES)
      return mpsi_text_fail(&r->text, "more than %d triangles", MPSI_MESH_MAX_TRIANGLES);
    if (*count == capacity) {
      void *grown = *xyz;
      const int64_t wanted = capacity > 0 ? 2 * capacity : 256;
      if (!mpsi_grow(r->text.context, &grown, 9 * capacity, 9 * wanted, sizeof **xyz))
        return mpsi_fail_memory(r->text.context, r->text.function,
                                (size_t)wanted * 9 * sizeof **xyz);
      *xyz = grown;
      capacity = wanted;
    }
    MPSI_TRY(read_facet(r, scale, *xyz + 9 * (*count)++));
  }
}

static mps_status read_ascii(mps_context *context, const char *function, const char *path,
                             const char *data, int64_t size, double scale, int64_t *triangles,
                             double **xyz) {
  reader r = {.line = {NULL, NULL}};
  MPSI_TRY(mpsi_text_wrap(context, function, path, data, (size_t)size, &r.text));
  int64_t count = 0;
  double *out = NULL;
  mps_status status = expect(&r, "solid");
  r.line.begin = r.line.end; /* the solid's name, of any words */
  if (status == MPS_OK) status = read_facets(&r, scale, &count, &out);
  mpsi_slice word;
  r.line.begin = r.line.end;
  if (status == MPS_OK && mpsi_text_word(&r.text, &r.line, &word))
    status = mpsi_text_fail(&r.text, "\"%s\" after \"endsolid\": one solid a file, please",
                            mpsi_slice_quote(word).text);
  if (status == MPS_OK && count == 0) status = mpsi_text_fail(&r.text, "no triangles");
  mpsi_text_close(&r.text);
  if (status == MPS_OK) {
    *triangles = count;
    *xyz = out;
  } else {
    mpsi_free(context, out);
  }
  return status;
}

/* Binary files may begin with "solid" too: the size distinguishes them. One with a wrong size is
 * recognised by zero bytes, which a text does not have. */
static bool looks_ascii(const char *data, int64_t size) {
  if (size >= HEADER && size == HEADER + FACET * (int64_t)read_u32(data + HEADER - 4)) return false;
  mpsi_slice text = {data, data + size};
  while (text.begin < text.end && memchr(" \t\r\n", *text.begin, 4)) text.begin++;
  return mpsi_slice_starts(text, "solid", NULL) && !memchr(data, '\0', (size_t)size);
}

mps_status mpsi_stl_read(mps_context *context, const char *function, const char *path,
                         const char *data, int64_t size, double scale, int64_t *triangles,
                         double **xyz) {
  return (looks_ascii(data, size) ? read_ascii : read_binary)(context, function, path, data, size,
                                                              scale, triangles, xyz);
}
