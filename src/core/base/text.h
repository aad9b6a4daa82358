/* text.h - reading of text files: the file in memory, its lines and words, numbers in the same
 * notation everywhere, errors as "path:line: reason".
 * SPDX-License-Identifier: BSD-3-Clause */
#pragma once

#include "core/internal.h"

#include <locale.h>
#ifdef __APPLE__
#include <xlocale.h>
#endif

/* A stretch of the text, not terminated. */
typedef struct mpsi_slice {
  const char *begin, *end;
} mpsi_slice;

/* A text in memory, read line by line. A copy of the struct is a bookmark. */
typedef struct mpsi_text {
  mps_context *context;
  const char *function; /* calling public function */
  const char *path;     /* for messages */
  mpsi_slice rest;      /* not read yet */
  int64_t line;         /* number of the line last read, from 1 */
  locale_t locale;      /* "C": numbers are read the same in every host */
  char *owned;          /* released by mpsi_text_close */
} mpsi_text;

/* The end of a long path, for messages. */
const char *mpsi_path_tail(const char *path);
/* Reads a whole file of at most `limit` bytes, to be released with mpsi_free. */
mps_status mpsi_file_read(mps_context *context, const char *function, const char *path,
                          int64_t limit, char **data, int64_t *size);
/* Loads a file of at most `limit` bytes, or takes `size` bytes at `data`, which must outlive the
 * text. Fails on a NUL byte: not a text. After a failure nothing is open. */
mps_status mpsi_text_load(mps_context *context, const char *function, const char *path,
                          int64_t limit, mpsi_text *out);
mps_status mpsi_text_wrap(mps_context *context, const char *function, const char *path,
                          const char *data, size_t size, mpsi_text *out);
void mpsi_text_close(mpsi_text *text);

/* Records MPS_ERROR_FORMAT at the line last read, and returns it. */
mps_status mpsi_text_fail(const mpsi_text *text, const char *format, ...) MPSI_PRINTF(2, 3);

/* The next line without its end (\n or \r\n); false at the end of the text. */
bool mpsi_text_line(mpsi_text *text, mpsi_slice *line);
/* Removes leading blanks. */
void mpsi_slice_trim(mpsi_slice *slice);
/* Removes leading blanks and then a word: up to a blank or a character of `stops`. Returns the
 * word, empty at the end. */
mpsi_slice mpsi_slice_word(mpsi_slice *slice, const char *stops);
MPSI_INLINE int64_t mpsi_slice_size(mpsi_slice slice) { return slice.end - slice.begin; }
/* The next word of the text, on this line or a later one; false at the end. Begin with an empty
 * line. */
bool mpsi_text_word(mpsi_text *text, mpsi_slice *line, mpsi_slice *word);
/* The text behind `name` (ASCII, any case) in the slice; false where it does not occur. */
bool mpsi_slice_find(mpsi_slice slice, const char *name, mpsi_slice *after);
bool mpsi_slice_starts(mpsi_slice slice, const char *name, mpsi_slice *after);
/* Printable copy for messages, cut to a short length. */
typedef struct mpsi_quote {
  char text[40];
} mpsi_quote;
mpsi_quote mpsi_slice_quote(mpsi_slice slice);

/* Length of the number at the start of the slice, 0 where there is none: an optional sign, digits
 * with at most one point, and an exponent that begins with e, E, d or D (Fortran). Correctly
 * rounded; out of range gives +-infinity. */
int64_t mpsi_text_scan(const mpsi_text *text, mpsi_slice slice, double *out);
/* The whole word as a finite number, or an error that calls it `what`. */
mps_status mpsi_text_number(const mpsi_text *text, mpsi_slice word, const char *what, double *out);
