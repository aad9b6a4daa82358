/* progress.c - progress bar, and signals that end a run: Ctrl-C, SIGTERM, SIGHUP.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "progress.h"

#include <math.h>
#include <signal.h>
#include <stdatomic.h>
#include <stdio.h>
#include <string.h>
#include <time.h>
#include <unistd.h>

/* A signal handler can use static variables only. The library has none and installs no handler:
 * both belong to the program. */
static volatile sig_atomic_t interrupted;
static volatile sig_atomic_t presses; /* of Ctrl-C */
static char third[120];               /* the line upon the third */
static char last_line[PROGRESS_LAST_LINE + 1];
static char last_part[PROGRESS_PATH], last_whole[PROGRESS_PATH]; /* "": no file */
static volatile sig_atomic_t last_length;                        /* > 0: leave at once */

/* Set once the program is ending: signals may reach several threads, or one during another. */
static atomic_flag leaving = ATOMIC_FLAG_INIT;

static void on_interrupt(int number) {
  interrupted = 1;
  if (number == SIGINT && ++presses > 2) {
    if (atomic_flag_test_and_set(&leaving)) return;
    const ssize_t sent = write(STDERR_FILENO, third, strlen(third));
    (void)sent;
    _exit(130);
  }
  if (last_length == 0 || atomic_flag_test_and_set(&leaving)) return;
  if (last_part[0] && rename(last_part, last_whole) != 0) last_part[0] = '\0';
  const ssize_t written = write(STDERR_FILENO, last_line, (size_t)last_length);
  (void)written;
  _exit(130);
}

void progress_leave_at_once(const char *line, const char *part, const char *whole) {
  last_length = 0;
  if (!line) return;
  snprintf(last_part, sizeof last_part, "%s", part ? part : "");
  snprintf(last_whole, sizeof last_whole, "%s", whole ? whole : "");
  /* the bar, which a thread may have drawn, is taken off the terminal first */
  snprintf(last_line, sizeof last_line, "%s%s\n", isatty(STDERR_FILENO) == 1 ? "\r\x1b[K" : "",
           line);
  last_length = (sig_atomic_t)strlen(last_line);
  if (interrupted) on_interrupt(SIGINT); /* pressed before */
}

static double now(void) {
  struct timespec t;
  if (clock_gettime(CLOCK_MONOTONIC, &t) != 0) return 0.0;
  return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

void progress_start(progress *bar, const char *program) {
  *bar = (progress){.terminal = isatty(STDERR_FILENO) == 1, .share = 1.0, .first = -1.0};
  snprintf(third, sizeof third, "%s%.40s: ended at once: what was not yet written is lost\n",
           bar->terminal ? "\r\x1b[K" : "", program);
  struct sigaction action = {.sa_handler = on_interrupt};
  sigemptyset(&action.sa_mask);
  sigaction(SIGINT, &action, NULL);
  sigaction(SIGTERM, &action, NULL);
  /* nohup has SIGHUP ignored; a terminal that hangs up breaks its pipes too */
  struct sigaction former;
  if (sigaction(SIGHUP, NULL, &former) == 0 && former.sa_handler != SIG_IGN)
    sigaction(SIGHUP, &action, NULL);
  action.sa_handler = SIG_IGN;
  sigaction(SIGPIPE, &action, NULL);
  sigaction(SIGXFSZ, &action, NULL);
}

void progress_heed_launcher(void) {
  struct sigaction action = {.sa_handler = on_interrupt};
  sigemptyset(&action.sa_mask);
  sigaction(SIGUSR1, &action, NULL);
}

void progress_part(progress *bar, double done, double share, double from, double to) {
  bar->done = done, bar->share = share;
  bar->from = from, bar->to = to;
}

void progress_draw(progress *bar, double fraction, const char *text) {
  enum { WIDTH = 30 };
  if (!bar->terminal) return;
  if (!(fraction >= bar->shown)) fraction = bar->shown;
  if (fraction > 1.0) fraction = 1.0;
  if (bar->first < 0.0) bar->first = fraction, bar->started = now();
  bar->shown = fraction;
  char cells[WIDTH + 1];
  const int full = (int)(fraction * WIDTH + 0.5);
  for (int i = 0; i < WIDTH; i++) cells[i] = i < full ? '#' : '.';
  cells[WIDTH] = '\0';
  const double spent = now() - bar->started;
  fprintf(stderr, "\r[%s] %3.0f %%  %s", cells, 100.0 * fraction, text);
  if (fraction - bar->first > 0.02 && spent > 1.0)
    fprintf(stderr, "  %.0f s left", spent * (1.0 - fraction) / (fraction - bar->first));
  fputs("\x1b[K", stderr); /* erases the rest of a longer former line */
  fflush(stderr);
  bar->drawn = true;
}

void progress_clear(progress *bar) {
  if (!bar->drawn) return;
  fputs("\r\x1b[K", stderr);
  fflush(stderr);
  bar->drawn = false;
}

bool progress_interrupted(void) { return interrupted != 0; }

/* ---- by the clock ---------------------------------------------------------------------------- */

/* Of the part, after `x` of the time that it should take. */
static double part_done(double x) { return x < 0.8 ? x : 1.0 - 0.2 * exp((0.8 - x) / 0.2); }

static void *draw_by_clock(void *user) {
  progress *bar = user;
  const struct timespec tick = {.tv_nsec = 100000000};
  while (!atomic_load(&bar->stopped)) {
    const double part = part_done((now() - bar->began) / bar->takes);
    progress_draw(bar, bar->done + bar->share * part, bar->doing);
    nanosleep(&tick, NULL);
  }
  return NULL;
}

void progress_by_clock(progress *bar, double seconds, const char *text) {
  if (bar->ticks) {
    atomic_store(&bar->stopped, true);
    pthread_join(bar->clock, NULL);
    bar->ticks = false;
    progress_clear(bar);
  }
  if (!bar->terminal || !(seconds > 0.0)) return;
  bar->began = now(), bar->takes = seconds, bar->doing = text;
  atomic_store(&bar->stopped, false);
  bar->ticks = pthread_create(&bar->clock, NULL, draw_by_clock, bar) == 0;
}

/* ---- hooks ----------------------------------------------------------------------------------- */

void progress_hook(void *user, const mps_context_progress *p) {
  progress *bar = user;
  char text[96];
  const bool part = bar->to > bar->from;
  if (part && strcmp(p->task, "mpm settle") == 0) { /* its time is a number of iterations */
    progress_draw(bar, bar->shown, "coming to rest");
    return;
  }
  const double time = bar->call + p->time;
  const double inside = part ? (time - bar->from) / (bar->to - bar->from) : p->fraction;
  snprintf(text, sizeof text, "t = %.3g of %.3g s", time, part ? bar->to : p->time_end);
  progress_draw(bar, bar->done + bar->share * fmin(1.0, fmax(0.0, inside)), text);
}

int32_t progress_cancel_hook(void *user) {
  (void)user;
  return interrupted;
}
