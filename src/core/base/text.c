/* text.c - text files: loading, lines, words, numbers, errors.
 *
 * Numbers. strtod reads with the decimal point of the host's locale, and knows "nan" and hex. So
 * the notation is checked here, character by character, and only plain decimal notation is passed
 * to strtod (correctly rounded in the C libraries of our platforms), under the "C" locale set for
 * this thread alone (uselocale, POSIX.1-2008), for just that call.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "text.h"

#include <errno.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define FIRST_CAPACITY 65536 /* bytes of a file's first buffer */
#define NUMBER_SIZE 128      /* characters of the longest number, with its end */
#define PATH_SHOWN 200       /* characters of a path in a message: leaves room for the reason */

/* ---- errors ---------------------------------------------------------------------------------- */

const char *mpsi_path_tail(const char *path) {
  const size_t length = strlen(path);
  return length > PATH_SHOWN ? path + length - PATH_SHOWN : path;
}

mps_status mpsi_text_fail(const mpsi_text *text, const char *format, ...) {
  char reason[256];
  va_list args;
  va_start(args, format);
  vsnprintf(reason, sizeof reason, format, args);
  va_end(args);
  const char *tail = mpsi_path_tail(text->path);
  return mpsi_fail(text->context, text->function, MPS_ERROR_FORMAT, "%s%s:%lld: %s",
                   tail == text->path ? "" : "...", tail, (long long)text->line, reason);
}

static mps_status fail_io(mps_context *context, const char *function, const char *path,
                          const char *verb, int error) {
  char reason[128] = "unknown error";
  if (error != 0) (void)strerror_r(error, reason, sizeof reason);
  const char *tail = mpsi_path_tail(path);
  return mpsi_fail(context, function, MPS_ERROR_IO, "cannot %s '%s%s': %s", verb,
                   tail == path ? "" : "...", tail, reason);
}

/* ---- loading --------------------------------------------------------------------------------- */

mps_status mpsi_text_wrap(mps_context *context, const char *function, const char *path,
                          const char *data, size_t size, mpsi_text *out) {
  mpsi_text text = {.context = context,
                    .function = function,
                    .path = path,
                    .rest = {data, data + size},
                    .line = 1};
  const char *nul = size > 0 ? memchr(data, '\0', size) : NULL;
  if (nul) {
    for (const char *c = data; c < nul; c++) text.line += *c == '\n';
    return mpsi_text_fail(&text, "a NUL byte: this is not a text file");
  }
  text.locale = newlocale(LC_ALL_MASK, "C", (locale_t)0);
  if (!text.locale)
    return mpsi_fail(context, function, MPS_ERROR_MEMORY, "newlocale could not make the C locale");
  if (size >= 3 && memcmp(data, "\xef\xbb\xbf", 3) == 0) text.rest.begin += 3; /* UTF-8 mark */
  text.line = 0;
  *out = text;
  return MPS_OK;
}

/* Reads on to the end of `file`; *data grows. */
static mps_status read_all(mps_context *context, const char *function, const char *path,
                           int64_t limit, FILE *file, char **data, int64_t *size) {
  int64_t capacity = 0;
  for (;;) {
    if (*size == capacity) {
      void *grown = *data;
      const int64_t wanted = capacity > 0 ? 2 * capacity : FIRST_CAPACITY;
      if (!mpsi_grow(context, &grown, capacity, wanted, 1))
        return mpsi_fail_memory(context, function, (size_t)wanted);
      *data = grown;
      capacity = wanted;
    }
    errno = 0;
    const size_t got = fread(*data + *size, 1, (size_t)(capacity - *size), file);
    *size += (int64_t)got;
    if (*size > limit) {
      const char *tail = mpsi_path_tail(path);
      return mpsi_fail(context, function, MPS_ERROR_FORMAT,
                       "%s%s: larger than %lld bytes, the most that is read",
                       tail == path ? "" : "...", tail, (long long)limit);
    }
    if (ferror(file)) return fail_io(context, function, path, "read", errno);
    if (got == 0) return MPS_OK;
  }
}

mps_status mpsi_file_read(mps_context *context, const char *function, const char *path,
                          int64_t limit, char **data, int64_t *size) {
  *data = NULL;
  *size = 0;
  errno = 0;
  FILE *file = fopen(path, "rb");
  if (!file) return fail_io(context, function, path, "open", errno);
  const mps_status status = read_all(context, function, path, limit, file, data, size);
  (void)fclose(file); /* read only: no data can be lost */
  if (status == MPS_OK) return MPS_OK;
  mpsi_free(context, *data);
  *data = NULL;
  return status;
}

mps_status mpsi_text_load(mps_context *context, const char *function, const char *path,
                          int64_t limit, mpsi_text *out) {
  char *data;
  int64_t size;
  MPSI_TRY(mpsi_file_read(context, function, path, limit, &data, &size));
  mps_status status = mpsi_text_wrap(context, function, path, data, (size_t)size, out);
  if (status == MPS_OK)
    out->owned = data;
  else
    mpsi_free(context, data);
  return status;
}

void mpsi_text_close(mpsi_text *text) {
  freelocale(text->locale);
  mpsi_free(text->context, text->owned);
  text->owned = NULL;
}

/* ---- lines and words ------------------------------------------------------------------------- */

static bool is_blank(char c) {
  return c == ' ' || c == '\t' || c == '\r' || c == '\v' || c == '\f';
}

static bool is_digit(char c) { return c >= '0' && c <= '9'; }

static char lower(char c) { return c >= 'A' && c <= 'Z' ? (char)(c - 'A' + 'a') : c; }

bool mpsi_text_line(mpsi_text *text, mpsi_slice *line) {
  if (text->rest.begin == text->rest.end) return false;
  const char *begin = text->rest.begin;
  const char *newline = memchr(begin, '\n', (size_t)mpsi_slice_size(text->rest));
  const char *end = newline ? newline : text->rest.end;
  text->rest.begin = newline ? newline + 1 : end;
  text->line++;
  if (end > begin && end[-1] == '\r') end--;
  *line = (mpsi_slice){begin, end};
  return true;
}

void mpsi_slice_trim(mpsi_slice *slice) {
  while (slice->begin < slice->end && is_blank(*slice->begin)) slice->begin++;
}

mpsi_slice mpsi_slice_word(mpsi_slice *slice, const char *stops) {
  mpsi_slice_trim(slice);
  const mpsi_slice word = *slice;
  const char *c = word.begin;
  while (c < word.end && !is_blank(*c) && !strchr(stops, *c)) c++;
  slice->begin = c;
  return (mpsi_slice){word.begin, c};
}

bool mpsi_text_word(mpsi_text *text, mpsi_slice *line, mpsi_slice *word) {
  do {
    *word = mpsi_slice_word(line, "");
    if (mpsi_slice_size(*word) > 0) return true;
  } while (mpsi_text_line(text, line));
  return false;
}

bool mpsi_slice_starts(mpsi_slice slice, const char *name, mpsi_slice *after) {
  for (; *name; name++, slice.begin++)
    if (slice.begin == slice.end || lower(*slice.begin) != lower(*name)) return false;
  if (after) *after = slice;
  return true;
}

bool mpsi_slice_find(mpsi_slice slice, const char *name, mpsi_slice *after) {
  for (; slice.begin < slice.end; slice.begin++)
    if (mpsi_slice_starts(slice, name, after)) return true;
  return false;
}

mpsi_quote mpsi_slice_quote(mpsi_slice slice) {
  mpsi_quote quote;
  const size_t capacity = sizeof quote.text - 4;
  size_t length = 0;
  while (slice.begin < slice.end && length < capacity) {
    const char c = *slice.begin++;
    quote.text[length++] = c >= ' ' && c <= '~' ? c : '?';
  }
  memcpy(quote.text + length, slice.begin < slice.end ? "..." : "\0\0\0", 4);
  return quote;
}

/* ---- numbers --------------------------------------------------------------------------------- */

/* End of the digits at `c`. */
static const char *skip_digits(const char *c, const char *end) {
  while (c < end && is_digit(*c)) c++;
  return c;
}

/* End of the number at the start of the slice, its begin where there is none. */
static const char *number_end(mpsi_slice slice) {
  const char *c = slice.begin, *const end = slice.end;
  if (c < end && (*c == '+' || *c == '-')) c++;
  const char *digits = c;
  c = skip_digits(c, end);
  int64_t count = c - digits;
  if (c < end && *c == '.') {
    digits = ++c;
    c = skip_digits(c, end);
    count += c - digits;
  }
  if (count == 0) return slice.begin;
  if (c < end && (lower(*c) == 'e' || lower(*c) == 'd')) {
    const char *e = c + 1;
    if (e < end && (*e == '+' || *e == '-')) e++;
    if (e < end && is_digit(*e)) c = skip_digits(e, end);
  }
  return c;
}

int64_t mpsi_text_scan(const mpsi_text *text, mpsi_slice slice, double *out) {
  const int64_t length = number_end(slice) - slice.begin;
  if (length == 0 || length >= NUMBER_SIZE) return 0;
  char plain[NUMBER_SIZE];
  for (int64_t i = 0; i < length; i++)
    plain[i] = lower(slice.begin[i]) == 'd' ? 'e' : slice.begin[i];
  plain[length] = '\0';
  const locale_t hosts = uselocale(text->locale);
  *out = strtod(plain, NULL);
  (void)uselocale(hosts);
  return length;
}

mps_status mpsi_text_number(const mpsi_text *text, mpsi_slice word, const char *what, double *out) {
  if (mpsi_slice_size(word) == 0) return mpsi_text_fail(text, "%s is missing", what);
  double value = 0.0;
  if (mpsi_text_scan(text, word, &value) != mpsi_slice_size(word))
    return mpsi_text_fail(text, "%s is \"%s\", which is not a number", what,
                          mpsi_slice_quote(word).text);
  if (!isfinite(value))
    return mpsi_text_fail(text, "%s is %s, which is too large for a double", what,
                          mpsi_slice_quote(word).text);
  *out = value;
  return MPS_OK;
}
