/* test_small_stacks.c - every solver steps, goes back and is asked with 64 kB of a thread's stack;
 * what a foreign library does (CHOLMOD, ARPACK, HDF5) needs as much as docs/interface.md says. The
 * bytes are counted by the first word of a painted stack that has changed, less those of a thread
 * that does nothing: glibc puts the thread-local data of all libraries there (OpenBLAS and METIS:
 * 90 kB). SPDX-License-Identifier: BSD-3-Clause */
#include "host_scenes.h"

#include <limits.h>
#include <pthread.h>

#define KB 1024
enum { STACK = 64 * KB, FOREIGN = 64 * KB, PAINT = 1024 * KB };
#define COLOUR UINT64_C(0x5a17c0ffee5a17c0)

typedef struct job {
  const host_scene *scene;
  mps_context *context;
  mps_status status;
} job;

static void *run_job(void *argument) {
  job *j = argument;
  j->status = j->scene->run(j->context);
  return NULL;
}

/* Runs the scene on a stack of `size` bytes; the bytes that it has used, with the thread's own. */
static size_t run_on(const host_scene *scene, size_t size) {
  pthread_attr_t attributes;
  pthread_t thread;
  uint64_t *stack = aligned_alloc(64 * KB, size);
  job j = {.scene = scene, .context = test_context(MPS_CONTEXT_EXECUTOR_SERIAL, 1)};
  size_t clean = 0;
  assert_non_null(stack);
  for (size_t k = 0; k < size / sizeof *stack; k++) stack[k] = COLOUR;
  assert_int_equal(pthread_attr_init(&attributes), 0);
  assert_int_equal(pthread_attr_setstack(&attributes, stack, size), 0);
  assert_int_equal(pthread_create(&thread, &attributes, run_job, &j), 0);
  assert_int_equal(pthread_join(thread, NULL), 0);
  (void)pthread_attr_destroy(&attributes);
  if (j.status != MPS_OK)
    fail_msg("%s: status %d: %s", scene->name, (int)j.status,
             mps_context_error(j.context)->message);
  while (clean < size / sizeof *stack && stack[clean] == COLOUR) clean++;
  free(stack);
  mps_context_destroy(&j.context);
  return size - clean * sizeof *stack;
}

static mps_status do_nothing(mps_context *c) {
  (void)c;
  return MPS_OK;
}

static void check(const host_scene *scene, size_t most) {
  static const host_scene nothing = {"nothing", do_nothing};
  const size_t own_bytes = run_on(&nothing, PAINT), used = run_on(scene, PAINT) - own_bytes;
  printf("%-32s %4.1f kB\n", scene->name, (double)used / KB);
  if (used > most) fail_msg("%s needs %zu bytes of a stack, at most %zu", scene->name, used, most);
  (void)run_on(scene, (own_bytes + most + 4 * KB - 1) / (4 * KB) * (4 * KB));
}

static void steps_need_64_kb(void **state) {
  (void)state;
  for (size_t k = 0; k < sizeof host_own / sizeof *host_own; k++) check(&host_own[k], STACK);
}

static void foreign_libraries_need_no_more(void **state) {
  (void)state;
  for (size_t k = 0; k < sizeof host_foreign / sizeof *host_foreign; k++)
    check(&host_foreign[k], FOREIGN);
}

#ifdef __has_feature /* clang */
enum { SANITIZED = __has_feature(address_sanitizer) || __has_feature(thread_sanitizer) };
#elif defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
enum { SANITIZED = 1 };
#else
enum { SANITIZED = 0 };
#endif

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(steps_need_64_kb),
                                     cmocka_unit_test(foreign_libraries_need_no_more)};
  if (SANITIZED || PTHREAD_STACK_MIN > STACK) { /* 64-bit ARM: 128 kB */
    printf("skipped: sanitizers add to every frame, or no thread may have so small a stack\n");
    return 0;
  }
  return cmocka_run_group_tests(tests, NULL, NULL);
}
