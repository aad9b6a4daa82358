/* test_journal.h - a log hook that counts the warnings and keeps the last one.
 * SPDX-License-Identifier: BSD-3-Clause */
#ifndef MPS_TEST_JOURNAL_H
#define MPS_TEST_JOURNAL_H

#include "test_common.h"

typedef struct journal {
  int count, asked; /* warnings; calls of a test's cancel hook */
  char last[512];
} journal;

static inline void journal_note(void *user, int32_t level, const char *message) {
  journal *j = user;
  if (level != MPS_CONTEXT_LOG_WARNING) return;
  j->count++;
  snprintf(j->last, sizeof j->last, "%s", message);
}

/* A serial context that notes its warnings; `cancel` may be NULL. */
static inline mps_context *journal_context(journal *j, mps_context_cancel_fn cancel) {
  mps_context_def def = test_context_defaults();
  mps_context *own = NULL;
  def.executor = MPS_CONTEXT_EXECUTOR_SERIAL;
  def.log = journal_note, def.log_user = j;
  if (cancel) def.cancel = cancel, def.cancel_user = j;
  assert_int_equal(mps_context_create(&def, &own, NULL, 0), MPS_OK);
  return own;
}

#endif
