/* textbook_table.h - the tables that the tests of the textbook's cases leave for the pictures of
 * docs/verification/textbook.md: comma-separated, in the folder of the environment variable
 * MPS_VERIFY_OUT, which scripts/verify sets; nothing is written without it.
 * SPDX-License-Identifier: BSD-3-Clause */
#ifndef MPS_TEST_TEXTBOOK_TABLE_H
#define MPS_TEST_TEXTBOOK_TABLE_H

#include "test_common.h"

#include <time.h>

/* NULL: no table is wanted. */
static inline FILE *textbook_table(const char *name, const char *header) {
  const char *folder = getenv("MPS_VERIFY_OUT");
  char path[1024];
  if (!folder) return NULL;
  assert_true(snprintf(path, sizeof path, "%s/%s.csv", folder, name) < (int)sizeof path);
  FILE *f = fopen(path, "w");
  if (!f) fail_msg("cannot write %s", path);
  fprintf(f, "%s\n", header);
  return f;
}

static inline void textbook_row(FILE *f, int count, const double *value) {
  for (int k = 0; f && k < count; k++) fprintf(f, "%.9g%c", value[k], k + 1 < count ? ',' : '\n');
}

static inline void textbook_close(FILE *f) {
  if (f && fclose(f) != 0) fail_msg("the table was not written");
}

/* Processor time of this program so far (s), which the pages state as the cost of a row. */
static inline double textbook_cost(void) { return (double)clock() / CLOCKS_PER_SEC; }

#endif
