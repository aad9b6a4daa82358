/* main.c - sequences of calls by seed: on one or several numbers of threads, which must give the
 * same bits, and shortened where something is broken. See usage.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "api.h"

#include <inttypes.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/time.h>
#include <sys/wait.h>
#include <unistd.h>

static const char usage[] =
    "usage: test-api [--seed N] [--seeds A:B] [--calls K] [--threads T] [--shrink] [--verbose]\n"
    "                [--program FILE]\n"
    "       test-api --names FILE\n\n"
    "Random calls of the whole public interface; see tests/api/api.h.\n\n"
    "  --seed N     one sequence (default: seeds 0:100)\n"
    "  --seeds A:B  sequences A to B - 1\n"
    "  --calls K    calls of a sequence, 1 to 2000 (default 60)\n"
    "  --threads T  threads of the contexts (default: 1, and where nothing depends on them 2 and "
    "3)\n"
    "  --shrink     leaves out the calls of a broken sequence that do not matter\n"
    "  --program F  writes the (last) sequence as a C program on the public headers; a sequence\n"
    "               that fails without it writes test-api-SEED.c into the working directory\n"
    "  --verbose    prints each call, and at the end how often each function gave which status\n"
    "  --names FILE compares the tables with the linker map FILE\n";

enum { MOST_CALLS = 2000, SECONDS = 100 };

typedef struct options {
  uint64_t first, last;
  int calls, threads;
  bool shrink, verbose;
  const char *program;    /* NULL: none */
  const char *executable; /* this one */
} options;

static api state;
static options present;
static bool skipped[MOST_CALLS + 1];
static uint64_t digests[MOST_CALLS + 1];

/* ---- one sequence ---------------------------------------------------------------------------- */

static void choose_mood(api *a) {
  const uint32_t k = api_below(a, 10);
  a->mood = k < 6 ? API_VALID : k < 8 ? API_EDGE : API_ABSURD;
}

/* By weight, of calls whose object exists. */
static const api_call *choose_call(api *a) {
  for (int pass = 0;; pass++) {
    int sum = 0, chosen = 0;
    for (int step = 0; step < 2; step++) {
      for (int t = 0; t < api_table_count; t++)
        for (int k = 0; k < api_tables[t]->count; k++) {
          const api_call *call = &api_tables[t]->calls[k];
          const bool there = call->needs == API_NOTHING || api_alive(a, call->needs) > 0;
          const int weight = there ? call->weight * (call->needs >= API_MPM ? 4 : 1) : 0;
          if (step == 0)
            sum += weight;
          else if (chosen < weight)
            return call;
          else
            chosen -= weight;
        }
      if (step == 0) chosen = (int)api_below(a, (uint32_t)sum);
    }
    if (pass > 0) abort();
  }
}

static void remove_files(const api *a) {
  static const char *const names[] = {"record.csv",  "body.stl",   "mpm.h5",
                                      "dynamics.h5", "elastic.h5", "fluid.h5",
                                      "set.h5",      "frames.h5",  "other.h5"};
  char path[400];
  for (int k = 0; k < API_COUNT(names); k++) {
    snprintf(path, sizeof path, "%s/%s", a->folder, names[k]);
    (void)unlink(path);
    snprintf(path, sizeof path, "%s/%s.part", a->folder, names[k]);
    (void)unlink(path);
  }
}

/* Whatever is left is destroyed in any order, and no memory stays. */
static void finish(api *a) {
  a->name = "";
  a->length = 0;
  api_clear(a);
  if (atomic_load(&a->memory.live) != 0) {
    api_broken(a, "%lld allocations are left at the end", (long long)atomic_load(&a->memory.live));
    api_settle(a);
  }
}

/* A call that computes without end gets SIGPROF after so many seconds of processor time (0: none),
 * so that no other work on the machine decides. One that waits for ever is for the limit of ctest.
 */
static void limit_time(int seconds) {
  const struct itimerval limit = {.it_value.tv_sec = seconds};
  (void)setitimer(ITIMER_PROF, &limit, NULL);
}

static bool run_sequence(api *a, uint64_t seed, int calls, int threads) {
  a->seed = seed;
  a->threads = threads;
  a->steady = seed % 3 == 0;
  a->random = api_mix(seed);
  a->dim = api_chance(a, 75) ? 2 : 3;
  a->digest = seed;
  a->pushed = a->lost = false;
  a->call = 0;
  limit_time(SECONDS * (calls > 200 ? 4 : 1));
  if (setjmp(a->failed) == 0) {
    api_scene(a);
    for (a->call = 1; a->call <= calls; a->call++) {
      digests[a->call] = a->digest;
      if (skipped[a->call]) continue;
      a->random = api_mix(api_mix(seed) ^ (uint64_t)a->call);
      choose_mood(a);
      api_make(a, choose_call(a));
    }
    finish(a);
  }
  limit_time(0);
  remove_files(a);
  return a->reason[0] == '\0';
}

static api *fresh(const options *o, const char *folder) {
  memset(&state, 0, sizeof state);
  state.verbose = o->verbose;
  snprintf(state.folder, sizeof state.folder, "%s", folder);
  return &state;
}

static void report(const api *a) {
  fflush(stdout);
  fprintf(stderr, "seed %" PRIu64 ", %d threads, call %" PRId64 ": %s %s\n", a->seed, a->threads,
          a->call, a->name, a->reason);
  api_print_log(a, STDERR_FILENO);
}

/* The same sequence on other numbers of threads. */
static bool same_on_threads(const options *o, const char *folder, uint64_t seed) {
  static uint64_t before[MOST_CALLS + 1];
  memcpy(before, digests, sizeof before);
  const uint64_t end = state.digest;
  for (int threads = 2; threads <= 3; threads++) {
    api *a = fresh(o, folder);
    bool good = run_sequence(a, seed, o->calls, threads);
    if (good && a->digest != end) {
      int call = 1;
      while (call < o->calls && digests[call + 1] == before[call + 1]) call++;
      a->call = call;
      api_broken(a, "differs on %d threads from 1", threads);
      good = false;
    }
    if (!good) return false;
  }
  return true;
}

static bool run_seed(const options *o, const char *folder, uint64_t seed) {
  api *a = fresh(o, folder);
  a->seed = seed, a->threads = o->threads ? o->threads : 1;
  if (o->program && !api_record_begin(a, o->program)) {
    fprintf(stderr, "%s cannot be written\n", o->program);
    return false;
  }
  const bool good = run_sequence(a, seed, o->calls, o->threads ? o->threads : 1);
  api_record_end();
  if (!good || o->program) return good;
  return o->threads || !a->steady || same_on_threads(o, folder, seed);
}

/* ---- irrelevant calls are left out ----------------------------------------------------------- */

/* Repeated in a process of its own: is the outcome the same? The outcome is the function and the
 * reason, or the signal. */
static void outcome_of(const options *o, const char *folder, uint64_t seed, char *text,
                       size_t size) {
  int ends[2], status = 0;
  size_t length = 0;
  if (pipe(ends) != 0) abort();
  const pid_t child = fork();
  if (child == 0) {
    if (!freopen("/dev/null", "w", stdout) || !freopen("/dev/null", "w", stderr)) _exit(4);
    const bool good = run_seed(o, folder, seed);
    char own[200];
    snprintf(own, sizeof own, "%s %.100s", state.name, good ? "" : state.reason);
    for (char *c = own; *c; c++)
      if (*c >= '0' && *c <= '9') *c = '0';
    (void)!write(ends[1], own, strlen(own));
    _exit(good ? 0 : 1);
  }
  (void)close(ends[1]);
  for (ssize_t n = 1; n > 0 && length<size - 1; length += n> 0 ? (size_t)n : 0)
    n = read(ends[0], text + length, size - 1 - length);
  text[length] = '\0';
  (void)close(ends[0]);
  (void)waitpid(child, &status, 0);
  if (WIFEXITED(status) && WEXITSTATUS(status) == 0)
    text[0] = '\0';
  else if (length == 0)
    snprintf(text, size, "ends with %d", status);
}

static void shrink(const options *o, const char *folder, uint64_t seed) {
  char wanted[256], got[256];
  options quiet = *o;
  quiet.verbose = false;
  outcome_of(&quiet, folder, seed, wanted, sizeof wanted);
  if (!wanted[0]) return;
  for (int size = o->calls; size >= 1; size /= 2)
    for (int from = 1; from <= o->calls; from += size) {
      bool former[MOST_CALLS + 1];
      memcpy(former, skipped, sizeof former);
      for (int k = from; k < from + size && k <= o->calls; k++) skipped[k] = true;
      if (memcmp(former, skipped, sizeof former) == 0) continue;
      outcome_of(&quiet, folder, seed, got, sizeof got);
      if (strcmp(got, wanted) != 0) memcpy(skipped, former, sizeof former);
    }
}

/* ---- the program ----------------------------------------------------------------------------- */

/* The same sequence once more, by a process of its own that writes it as a program; for what calls
 * it, a handler of signals too. */
static void write_program(const options *o, uint64_t seed) {
  char seed_text[24], calls[24], threads[24], path[64], text[200];
  if (o->program || !o->executable) return;
  snprintf(seed_text, sizeof seed_text, "%" PRIu64, seed);
  snprintf(calls, sizeof calls, "%d", o->calls);
  snprintf(threads, sizeof threads, "%d", o->threads ? o->threads : 1);
  snprintf(path, sizeof path, "test-api-%s.c", seed_text);
  const pid_t child = fork();
  if (child == 0) {
    (void)!freopen("/dev/null", "w", stdout);
    (void)!freopen("/dev/null", "w", stderr);
    (void)execl(o->executable, "test-api", "--seed", seed_text, "--calls", calls, "--threads",
                threads, "--program", path, (char *)NULL);
    _exit(127);
  }
  if (child > 0) (void)waitpid(child, NULL, 0);
  const int length = snprintf(text, sizeof text, "  as a C program, up to there: %s\n", path);
  if (access(path, R_OK) == 0) (void)!write(STDERR_FILENO, text, (size_t)length);
}

/* A crash, or a call that does not end: the log, and the number of the signal. */
static void on_signal(int number) {
  static const char text[] = "a signal ends this sequence:\n";
  (void)!write(STDERR_FILENO, text, sizeof text - 1);
  api_print_log(&state, STDERR_FILENO);
  (void)signal(number, SIG_DFL);
  api_record_crash();
  write_program(&present, state.seed);
  (void)raise(number);
}

#ifdef __SANITIZE_ADDRESS__
void __sanitizer_set_death_callback(void (*callback)(void));
static void on_death(void) { on_signal(SIGABRT); }
#endif

static bool parse(int argc, char **argv, options *o) {
  for (int k = 1; k < argc; k++) {
    const char *option = argv[k], *value = k + 1 < argc ? argv[k + 1] : "";
    int used = 1;
    if (strcmp(option, "--seed") == 0) {
      if (sscanf(value, "%" SCNu64, &o->first) != 1) return false;
      o->last = o->first + 1;
    } else if (strcmp(option, "--seeds") == 0) {
      if (sscanf(value, "%" SCNu64 ":%" SCNu64, &o->first, &o->last) != 2) return false;
    } else if (strcmp(option, "--calls") == 0) {
      o->calls = atoi(value);
    } else if (strcmp(option, "--program") == 0) {
      o->program = value;
    } else if (strcmp(option, "--threads") == 0) {
      o->threads = atoi(value);
    } else {
      used = 0;
      if (strcmp(option, "--shrink") == 0)
        o->shrink = true;
      else if (strcmp(option, "--verbose") == 0)
        o->verbose = true;
      else
        return false;
    }
    k += used;
  }
  return o->calls >= 1 && o->calls <= MOST_CALLS && o->threads >= 0 && o->threads <= 64;
}

int main(int argc, char **argv) {
  options o = {.first = 0, .last = 100, .calls = 60};
  if (argc == 3 && strcmp(argv[1], "--names") == 0) return api_check_names(argv[2]) != 0;
  if (!parse(argc, argv, &o)) {
    fputs(usage, stderr);
    return 2;
  }
  static const int signals[] = {SIGABRT, SIGPROF, SIGSEGV, SIGFPE, SIGBUS, SIGILL};
#ifdef __SANITIZE_ADDRESS__
  __sanitizer_set_death_callback(on_death);
  (void)signal(SIGPROF, on_signal);
#else
  for (int k = 0; k < API_COUNT(signals); k++) (void)signal(signals[k], on_signal);
#endif
  (void)signals;
  o.executable = argv[0];
  present = o;
  char folder[] = "/tmp/test-api-XXXXXX";
  if (!mkdtemp(folder)) return 2;
  int64_t failed = 0;
  for (uint64_t seed = o.first; seed < o.last; seed++) {
    if (o.shrink) shrink(&o, folder, seed);
    if (!run_seed(&o, folder, seed)) {
      failed++;
      report(&state);
      write_program(&o, seed);
    }
    memset(skipped, 0, sizeof skipped);
  }
  (void)rmdir(folder);
  if (o.verbose) api_print_counts();
  printf("%" PRIu64 " seeds of %d calls, %" PRId64 " failed\n", o.last - o.first, o.calls, failed);
  return failed > 0;
}
