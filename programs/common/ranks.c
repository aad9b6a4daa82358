/* ranks.c - see ranks.h.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "ranks.h"

#include <dlfcn.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* ---- variables of the launcher --------------------------------------------------------------- */

/* Open MPI, MPICH and its derivatives, Slurm with PMIx: the first that is set. */
static int32_t ask(const char *const names[], int32_t otherwise) {
  for (; *names; names++) {
    const char *value = getenv(*names);
    if (value && *value) return (int32_t)strtol(value, NULL, 10);
  }
  return otherwise;
}

int32_t ranks_launched(void) {
  static const char *const names[] = {"OMPI_COMM_WORLD_SIZE", "PMI_SIZE", "MV2_COMM_WORLD_SIZE",
                                      NULL};
  static const char *const steps[] = {"SLURM_STEP_NUM_TASKS", NULL};
  const int32_t count = ask(names, getenv("PMIX_RANK") ? ask(steps, 1) : 1);
  return count > 1 ? count : 1;
}

int32_t ranks_number(void) {
  static const char *const names[] = {"OMPI_COMM_WORLD_RANK", "PMI_RANK", "MV2_COMM_WORLD_RANK",
                                      "PMIX_RANK", NULL};
  return ranks_launched() > 1 ? ask(names, 0) : 0;
}

static int32_t ranks_of_node(void) {
  static const char *const names[] = {"OMPI_COMM_WORLD_LOCAL_SIZE", "MPI_LOCALNRANKS",
                                      "MV2_COMM_WORLD_LOCAL_SIZE", "SLURM_NTASKS_PER_NODE", NULL};
  const int32_t count = ask(names, ranks_launched());
  return count > 1 ? count : 1;
}

void ranks_hush(void) {
  if (ranks_number() > 0 && !freopen("/dev/null", "w", stdout)) fclose(stdout);
}

/* ---- the domain ------------------------------------------------------------------------------ */

typedef mps_status (*join_fn)(mps_context *context, mps_domain **out);

/* Puts the function of that name into *function. */
static bool load(const char *name, void *function, char *why, size_t size) {
  /* MPI loads parts of itself, which need its symbols to be global */
  void *library = dlopen(RANKS_LIBRARY, RTLD_NOW | RTLD_GLOBAL);
  void *symbol = library ? dlsym(library, name) : NULL;
  if (!symbol) {
    const char *reason = dlerror();
    snprintf(why, size,
             "libmps-petsc, which several ranks and PETSc's solvers need, cannot be loaded: %s",
             reason ? reason : RANKS_LIBRARY);
    return false;
  }
  memcpy(function, &symbol, sizeof symbol);
  return true;
}

bool ranks_join(mps_context *context, mps_domain **out, char *why, size_t size) {
  join_fn join = NULL;
  *out = NULL;
  if (!load("mps_petsc_domain_create_world", &join, why, size)) return false;
  const mps_status status = join(context, out);
  if (status != MPS_OK)
    snprintf(why, size, "the ranks cannot be joined: %s",
             mps_context_error(context)->status == status ? mps_context_error(context)->message
                                                          : mps_status_text(status));
  return status == MPS_OK && mps_domain_size(*out) == ranks_launched();
}

/* ---- options --------------------------------------------------------------------------------- */

enum { WORDS = 512 };

static struct {
  int count;
  char **word;
} command; /* as main was given it */

void ranks_keep_options(int argc, char **argv) { command.count = argc, command.word = argv; }

/* The words of the command line but for the program's name and the number of threads. */
static int command_words(const char **word) {
  int count = 0;
  for (int k = 1; k < command.count && count < WORDS; k++) {
    const bool threads = strncmp(command.word[k], "--threads", 9) == 0;
    if (!threads) word[count++] = command.word[k];
    if (threads && command.word[k][9] == '\0') k++; /* its value */
  }
  return count;
}

static double hash_of(const char *word) {
  uint64_t hash = UINT64_C(0xcbf29ce484222325);
  for (; *word; word++) hash = (hash ^ (unsigned char)*word) * UINT64_C(0x100000001b3);
  return (double)(hash >> 12) + 1.0;
}

bool ranks_same_options(mps_domain *domain, char *why, size_t size) {
  static const char *word[WORDS];
  static double own[WORDS], first[WORDS]; /* 0: no word */
  const int count = command_words(word);
  for (int k = 0; k < WORDS; k++) {
    own[k] = k < count ? hash_of(word[k]) : 0.0;
    first[k] = mps_domain_rank(domain) == 0 ? own[k] : 0.0;
  }
  if (mps_domain_max(domain, WORDS, first) != MPS_OK) {
    snprintf(why, size, "the ranks cannot compare their options");
    return false;
  }
  int k = 0;
  while (k < WORDS && own[k] == first[k]) k++;
  if (k == WORDS) return true;
  if (k < count)
    snprintf(why, size,
             "word %d of the options is '%.200s', and another one on rank 0: all ranks must be "
             "given the same options",
             k + 1, word[k]);
  else
    snprintf(why, size,
             "there are %d words of options, and more for rank 0: all ranks must be given the same "
             "options",
             count);
  return false;
}

/* ---- equations ------------------------------------------------------------------------------- */

typedef mps_status (*create_fn)(mps_context *context, int32_t method, void **petsc);
typedef mps_status (*define_fn)(void *petsc, mps_linear_solver_def *def);
typedef void (*destroy_fn)(void **petsc);

/* The recorded message, where it is of this status. */
static const char *reason(const mps_context *context, mps_status status) {
  const mps_error *error = mps_context_error(context);
  return error && error->status == status ? error->message : mps_status_text(status);
}

bool ranks_solve(mps_solver *solver, int32_t equation, int32_t method, void **petsc, char *why,
                 size_t size) {
  mps_context *context = mps_solver_context(solver);
  mps_linear_solver_def def;
  create_fn create = NULL;
  define_fn define = NULL;
  if (!load("mps_petsc_solver_create_world", &create, why, size) ||
      !load("mps_petsc_linear_solver", &define, why, size))
    return false;
  mps_status status = *petsc ? MPS_OK : create(context, method, petsc);
  if (status == MPS_OK) status = define(*petsc, &def);
  if (status == MPS_OK) status = mps_solver_set_linear_solver(solver, equation, &def);
  if (status != MPS_OK)
    snprintf(why, size, "PETSc's solver cannot be had: %s", reason(context, status));
  return status == MPS_OK;
}

void ranks_drop_solver(void **petsc) {
  destroy_fn destroy = NULL;
  char why[300];
  if (*petsc && load("mps_petsc_solver_destroy", &destroy, why, sizeof why)) destroy(petsc);
}

/* ---- threads --------------------------------------------------------------------------------- */

/* A number that identifies the set of processors available to this process. 0 where it does not
 * say; sets are then taken to be the same. */
static double bound_to(void) {
  char line[1024];
  uint32_t hash = 0;
  FILE *file = fopen("/proc/self/status", "r");
  while (file && fgets(line, sizeof line, file))
    for (const char *at = line; strncmp(line, "Cpus_allowed:", 13) == 0 && *at; at++)
      hash = hash * 33 + (unsigned char)*at;
  if (file) fclose(file);
  return hash;
}

/* Threads that a context takes by itself: all processors that this process may use. */
static int64_t processors(void) {
  const mps_context_def def = mps_context_defaults();
  mps_context *probe = NULL;
  const mps_status status = mps_context_create(&def, &probe, NULL, 0);
  const int64_t count = status == MPS_OK ? mps_context_threads(probe) : 1;
  mps_context_destroy(&probe);
  return count;
}

mps_status ranks_threads(mps_domain *domain, int64_t *threads) {
  const int64_t count = processors(), ranks = ranks_of_node();
  double range[2] = {bound_to()};
  range[1] = -range[0];
  const mps_status status = mps_domain_max(domain, 2, range);
  const bool shared = range[0] == -range[1]; /* not bound to processors of their own */
  *threads = !shared ? count : count > ranks ? count / ranks : 1;
  return status;
}
