/* domain.c - what ranks cost: mpirun -n N bench-domain [PARTICLES [STEPS [dynamics|mpm]]],
 * particles a rank (20000), steps (600) and solver (dynamics). Each rank has one thread.
 *
 * The ranks compute one body together and, in turns of a few steps with that, each of them a body
 * of its own size by itself, without a domain: what processors beside one another cost each other
 * is in both, and the ratio is what ranks cost. In WLS-MPM the body flies over the grid, so that it
 * is sorted and particles change ranks. SPDX-License-Identifier: BSD-3-Clause */
#include "domain_counts.h"
#include "measure.h"

#include <mps/dynamics.h>
#include <mps/mpm.h>
#include <mps/petsc.h>

#include <math.h>
#include <stdbool.h>
#include <string.h>

enum { TURN = 10, MOST_STEPS = 100000 };

/* One solver of one body, and the times of its turns of TURN steps. */
typedef struct body {
  mps_context *context;
  mps_particles *set;
  mps_material *material;
  mps_dynamics *dynamics;
  mps_mpm *mpm;
  int64_t whole; /* particles of all ranks */
  double made;   /* s */
  double *step;  /* s, means of turns */
  bool *sorted;  /* in the turn */
  int64_t turns;
} body;

/* Ground of so many particles, twice as wide as high. */
static void fill(body *b, int64_t count, bool mpm) {
  mps_particles_def def = mps_particles_defaults();
  def.spacing = mpm ? 0.5 : 1.0;
  check(b->context, mps_particles_create(b->context, &def, &b->set), "set");
  const double high = floor(sqrt(0.5 * (double)count)), wide = floor((double)count / high);
  const double lo[2] = {0.0, 0.0}, hi[2] = {wide * def.spacing, high * def.spacing};
  check(b->context, mps_particles_fill_box(b->set, lo, hi, NULL), "fill");
  check(b->context, mps_particles_set(b->set, "density", 0, 1900.0), "density");
  b->whole = mps_particles_count(b->set);
}

static void make_dynamics(body *b, mps_domain *domain) {
  mps_dynamics_def solver = mps_dynamics_defaults();
  solver.domain = domain;
  check(b->context, mps_particles_set(b->set, "shear_velocity", 0, 200.0), "velocity");
  check(b->context, mps_particles_set(b->set, "pressure_velocity", 0, 400.0), "velocity");
  check(b->context, mps_particles_set(b->set, "damping", 0, 0.02), "damping");
  check(b->context, mps_dynamics_create(b->context, b->set, &solver, &b->dynamics), "solver");
  check(b->context, mps_dynamics_step(b->dynamics, 1), "step"); /* finds dt */
}

/* At a tenth of the speed of sound: a cell in some twenty steps. */
static void make_mpm(body *b, mps_domain *domain) {
  mps_mpm_def solver = mps_mpm_defaults();
  solver.cell = 1.0;
  solver.domain = domain;
  check(b->context, mps_particles_set(b->set, "velocity", 0, 20.0), "velocity");
  check(b->context, mps_material_linear_elastic(b->context, 6e7, 0.3, &b->material), "law");
  check(b->context, mps_mpm_create(b->context, b->set, b->material, &solver, &b->mpm), "solver");
}

static body make(mps_context *context, mps_domain *domain, int64_t count, bool mpm, int64_t steps) {
  body b = {.context = context};
  fill(&b, count, mpm);
  const double start = seconds();
  (mpm ? make_mpm : make_dynamics)(&b, domain);
  b.made = seconds() - start;
  b.step = calloc((size_t)(steps / TURN) + 1, sizeof *b.step);
  b.sorted = calloc((size_t)(steps / TURN) + 1, sizeof *b.sorted);
  if (!b.step || !b.sorted) check(NULL, MPS_ERROR_MEMORY, "steps");
  return b;
}

static void destroy(body *b) {
  mps_dynamics_destroy(&b->dynamics);
  mps_mpm_destroy(&b->mpm);
  mps_material_destroy(&b->material);
  mps_particles_destroy(&b->set);
  free(b->step);
  free(b->sorted);
}

/* As one call: what a call costs by itself is shared by its steps. */
static void take_turn(body *b) {
  const uint64_t epoch = mps_particles_epoch(b->set);
  const double start = seconds();
  check(b->context, b->mpm ? mps_mpm_step(b->mpm, TURN) : mps_dynamics_step(b->dynamics, TURN),
        "step");
  b->step[b->turns] = (seconds() - start) / TURN;
  b->sorted[b->turns++] = mps_particles_epoch(b->set) != epoch;
}

static int ascending(const void *a, const void *b) {
  const double x = *(const double *)a, y = *(const double *)b;
  return (x > y) - (x < y);
}

/* Of the turns with or without a sort: the least, the median, and their number. */
typedef struct spread {
  double least, median;
  int64_t count;
} spread;

static spread spread_of(const body *b, bool sorted) {
  spread s = {NAN, NAN, 0};
  double *some = calloc((size_t)b->turns + 1, sizeof *some);
  for (int64_t k = 0; some && k < b->turns; k++)
    if (b->sorted[k] == sorted) some[s.count++] = b->step[k];
  if (some && s.count > 0) {
    qsort(some, (size_t)s.count, sizeof *some, ascending);
    s.least = some[0], s.median = some[s.count / 2];
  }
  free(some);
  return s;
}

/* Of all ranks the slowest. */
static double slowest(mps_context *context, mps_domain *domain, double value) {
  double most = isnan(value) ? -1.0 : value;
  check(context, mps_domain_max(domain, 1, &most), "times");
  return most;
}

static void tell(mps_context *context, mps_domain *domain, const char *what, const body *b) {
  const spread plain = spread_of(b, false), sorted = spread_of(b, true);
  const double least = slowest(context, domain, plain.least);
  const double median = slowest(context, domain, plain.median);
  const double sort = slowest(context, domain, sorted.median);
  if (mps_domain_rank(domain) > 0) return;
  printf("%s: made in %.2f s, a step %.3f ms (least), %.3f (median)", what, b->made, 1e3 * least,
         1e3 * median);
  if (sorted.count > 0)
    printf(
        "; where there is a sort in %d steps (%lld of %lld) %.3f ms (median): sorts take %.1f %%",
        TURN, (long long)sorted.count, (long long)b->turns, 1e3 * sort,
        100.0 * (double)sorted.count * (sort - median) /
            ((double)plain.count * median + (double)sorted.count * sort));
  printf("\n");
}

static void tell_counts(mps_context *context, mps_domain *domain, const body *b,
                        const domain_counts *c) {
  const double n = (double)(b->turns * TURN), ms = 1e3 / n;
  double most[] = {ms * c->reducing,          ms * c->waiting,         ms * c->posting,
                   (double)c->reductions / n, (double)c->messages / n, 1e-3 * (double)c->bytes / n};
  check(context, mps_domain_max(domain, 6, most), "counts");
  if (mps_domain_rank(domain) == 0)
    printf(
        "a step, rank with most: in reductions %.3f ms, waiting for messages %.3f, sending %.3f; "
        "%.2f reductions, %.2f messages, %.1f kB\n",
        most[0], most[1], most[2], most[3], most[4], most[5]);
}

static domain_counts less(const domain_counts *a, const domain_counts *b) {
  return (domain_counts){a->reducing - b->reducing, a->waiting - b->waiting,
                         a->posting - b->posting,   a->reductions - b->reductions,
                         a->messages - b->messages, a->bytes - b->bytes};
}

static void add(domain_counts *sum, domain_counts c) {
  sum->reducing += c.reducing, sum->waiting += c.waiting, sum->posting += c.posting;
  sum->reductions += c.reductions, sum->messages += c.messages, sum->bytes += c.bytes;
}

int main(int argc, char **argv) {
  const int64_t each = argc > 1 ? atoll(argv[1]) : 20000;
  int64_t steps = argc > 2 ? atoll(argv[2]) : 600;
  const bool mpm = argc > 3 && strcmp(argv[3], "mpm") == 0;
  mps_context_def def = mps_context_defaults();
  mps_context *context = NULL;
  mps_domain *domain = NULL;
  domain_counts sent = {0};
  if (steps < TURN || steps > MOST_STEPS) steps = 600;
  def.executor = MPS_EXECUTOR_SERIAL;
  check(NULL, mps_context_create(&def, &context, NULL, 0), "context");
  check(context, mps_petsc_domain_create_world(context, &domain), "domain");
  const int32_t ranks = mps_domain_size(domain);
  body together = make(context, domain, each * ranks, mpm, steps);
  body beside = make(context, NULL, each, mpm, steps);
  while (together.turns * TURN < steps) {
    const domain_counts before = domain_count;
    take_turn(&together);
    add(&sent, less(&domain_count, &before));
    take_turn(&beside); /* all ranks at once: they have met in the last step */
  }
  const double apart = slowest(context, domain, spread_of(&beside, false).least);
  const double joined = slowest(context, domain, spread_of(&together, false).least);
  const double apart_median = slowest(context, domain, spread_of(&beside, false).median);
  const double joined_median = slowest(context, domain, spread_of(&together, false).median);
  if (mps_domain_rank(domain) == 0)
    printf("%s, %d ranks of %lld particles\n", mpm ? "WLS-MPM" : "explicit dynamics", (int)ranks,
           (long long)each);
  tell(context, domain, "together", &together);
  tell_counts(context, domain, &together, &sent);
  tell(context, domain, "each alone, beside the others", &beside);
  if (mps_domain_rank(domain) == 0)
    printf("together over alone: %.3f (least), %.3f (median)\n", apart / joined,
           apart_median / joined_median);
  destroy(&together);
  destroy(&beside);
  mps_domain_destroy(&domain);
  mps_context_destroy(&context);
  return 0;
}
