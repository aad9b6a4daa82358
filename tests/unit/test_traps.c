/* test_traps.c - a host that traps floating-point exceptions (Fortran's
 * -ffpe-trap=invalid,zero,overflow) gets no signal from scenes that are right.
 * SPDX-License-Identifier: BSD-3-Clause */
#define _GNU_SOURCE /* feenableexcept */
#include "host_scenes.h"

#include <fenv.h>
#include <signal.h>
#include <unistd.h>

/* clang computes both branches of a choice and keeps one: a division that nothing asks for raises.
 */
#ifdef __clang__
enum { SPECULATES = 1 };
#else
enum { SPECULATES = 0 };
#endif

enum {
  OWN = sizeof host_own / sizeof *host_own,
  SCENES = OWN + sizeof host_foreign / sizeof *host_foreign
};

#ifdef __GLIBC__
static const char *running = "";

static void on_trap(int number) {
  (void)number;
  (void)!write(STDERR_FILENO, "SIGFPE in ", 10);
  (void)!write(STDERR_FILENO, running, strlen(running));
  (void)!write(STDERR_FILENO, "\n", 1);
  _exit(1);
}

/* TEST_TRAPS_COUNT, or clang: says what each scene raises instead of trapping. */
TEST(no_scene_traps) {
  const int which = FE_INVALID | FE_DIVBYZERO | FE_OVERFLOW;
  const bool counts = SPECULATES || getenv("TEST_TRAPS_COUNT") != NULL;
  (void)signal(SIGFPE, on_trap);
  for (int k = 0; k < SCENES; k++) {
    scoped_context *context = test_context(MPS_CONTEXT_EXECUTOR_SERIAL, 1);
    const host_scene *scene = k < OWN ? &host_own[k] : &host_foreign[k - OWN];
    running = scene->name;
    (void)feclearexcept(FE_ALL_EXCEPT);
    if (!counts) (void)feenableexcept(which);
    const mps_status status = scene->run(context);
    const int raised = fetestexcept(which);
    (void)fedisableexcept(which);
    if (status != MPS_OK)
      fail_msg("%s: status %d: %s", running, (int)status, mps_context_error(context)->message);
    printf("%-28s%s%s%s\n", running, raised & FE_INVALID ? " invalid" : "",
           raised & FE_DIVBYZERO ? " zero" : "", raised & FE_OVERFLOW ? " overflow" : "");
  }
}
#else
TEST(no_scene_traps) { skip(); } /* no feenableexcept */
#endif
