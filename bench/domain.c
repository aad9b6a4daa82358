/* domain.c - what ranks cost: mpirun -n N bench-domain [PARTICLES [STEPS [dynamics|mpm|ground]]],
 * particles a rank (20000), steps (600) and solver (dynamics; `ground`: WLS-MPM in space, the model
 * of bench-partition). Each rank has one thread; scripts/bench-ranks makes a table of such runs.
 *
 * The ranks compute one body together and, in turns of a few steps with that, each of them a body
 * of its own size by itself, without a domain: what processors beside one another cost each other
 * is in both, and the ratio is what ranks cost. In WLS-MPM the body flies over the grid, so that it
 * is sorted and particles change ranks. SPDX-License-Identifier: BSD-3-Clause */
#include "domain_counts.h"
#include "measure.h"

#include <mps/dynamics.h>
#include <mps/mpm.h>
#include <mps/experimental/petsc.h>

#include <math.h>
#include <stdbool.h>
#include <string.h>

enum { TURN = 10, MOST_STEPS = 100000 };
enum { BLOCK = 8, FULL = 8 * BLOCK * BLOCK * BLOCK }; /* cells and particles of a full block */
typedef enum problem { DYNAMICS, MPM, GROUND } problem;

/* One solver of one body, and the times of its turns of TURN steps. */
typedef struct body {
  mps_context *context;
  mps_particles *set;
  mps_material *material;
  mps_dynamics *dynamics;
  mps_mpm *mpm;
  int64_t whole;       /* particles of all ranks */
  double made;         /* s */
  double *step;        /* s, means of turns */
  bool *sorted;        /* in the turn */
  domain_counts *sent; /* of turns */
  int64_t turns;
} body;

/* Ground of so many particles, twice as wide as high. */
static void fill_plane(body *b, int64_t count, problem kind) {
  mps_particles_def def = mps_particles_defaults();
  def.spacing = kind == MPM ? 0.5 : 1.0;
  check(b->context, mps_particles_create(b->context, &def, &b->set), "set");
  const double high = floor(sqrt(0.5 * (double)count)), wide = floor((double)count / high);
  const double lo[2] = {0.0, 0.0}, hi[2] = {wide * def.spacing, high * def.spacing};
  check(b->context, mps_particles_fill_box(b->set, lo, hi, NULL), "fill");
}

/* Under a slope of 1 in 4: two thirds as deep at its middle as `user`, its length. */
static mps_status is_under(void *user, const double *x, int32_t *inside) {
  const double side = *(const double *)user;
  *inside = x[2] < 2.0 / 3.0 * side + 0.25 * (x[0] - 0.5 * side);
  return MPS_OK;
}

static void fill_ground(body *b, int64_t count) {
  mps_particles_def def = mps_particles_defaults();
  double side = BLOCK * cbrt(1.5 * (double)count / FULL);
  const double lo[3] = {0.0, 0.0, 0.0}, hi[3] = {side, side, side};
  def.dim = 3;
  def.spacing = 0.5;
  check(b->context, mps_particles_create(b->context, &def, &b->set), "set");
  check(b->context, mps_particles_fill_where(b->set, lo, hi, is_under, &side, NULL), "fill");
}

static void fill(body *b, int64_t count, problem kind) {
  if (kind == GROUND)
    fill_ground(b, count);
  else
    fill_plane(b, count, kind);
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
  solver.geometry =
      mps_particles_dim(b->set) == 3 ? MPS_MPM_GEOMETRY_SPACE : MPS_MPM_GEOMETRY_PLANE_STRAIN;
  solver.domain = domain;
  check(b->context, mps_particles_set(b->set, "velocity", 0, 20.0), "velocity");
  check(b->context, mps_material_create_linear_elastic(b->context, 6e7, 0.3, &b->material), "law");
  check(b->context, mps_mpm_create(b->context, b->set, b->material, &solver, &b->mpm), "solver");
}

static body make(mps_context *context, mps_domain *domain, int64_t count, problem kind,
                 int64_t steps) {
  body b = {.context = context};
  fill(&b, count, kind);
  const double start = seconds();
  (kind == DYNAMICS ? make_dynamics : make_mpm)(&b, domain);
  b.made = seconds() - start;
  b.step = calloc((size_t)(steps / TURN) + 1, sizeof *b.step);
  b.sorted = calloc((size_t)(steps / TURN) + 1, sizeof *b.sorted);
  b.sent = calloc((size_t)(steps / TURN) + 1, sizeof *b.sent);
  if (!b.step || !b.sorted || !b.sent) check(NULL, MPS_ERROR_MEMORY, "steps");
  return b;
}

static void destroy(body *b) {
  mps_dynamics_destroy(&b->dynamics);
  mps_mpm_destroy(&b->mpm);
  mps_material_destroy(&b->material);
  mps_particles_destroy(&b->set);
  free(b->step);
  free(b->sorted);
  free(b->sent);
}

/* ---- measurements ---------------------------------------------------------------------------- */

static domain_counts less(const domain_counts *a, const domain_counts *b) {
  return (domain_counts){a->reducing - b->reducing, a->waiting - b->waiting,
                         a->posting - b->posting,   a->reductions - b->reductions,
                         a->messages - b->messages, a->bytes - b->bytes};
}

/* As one call: what a call costs by itself is shared by its steps. */
static void take_turn(body *b) {
  const uint64_t epoch = mps_particles_epoch(b->set);
  const domain_counts before = domain_count;
  const double start = seconds();
  check(b->context, b->mpm ? mps_mpm_step(b->mpm, TURN) : mps_dynamics_step(b->dynamics, TURN),
        "step");
  b->step[b->turns] = (seconds() - start) / TURN;
  b->sent[b->turns] = less(&domain_count, &before);
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

/* A step's, of turns [first, end): of the rank with most of each. */
static void tell_counts(const body *b, mps_domain *domain, const char *which, int64_t first,
                        int64_t end) {
  domain_counts c = {0};
  for (int64_t k = first; k < end; k++) {
    c.reducing += b->sent[k].reducing, c.waiting += b->sent[k].waiting;
    c.posting += b->sent[k].posting, c.reductions += b->sent[k].reductions;
    c.messages += b->sent[k].messages, c.bytes += b->sent[k].bytes;
  }
  const double n = (double)((end - first) * TURN), ms = 1e3 / n;
  double most[] = {ms * c.reducing,          ms * c.waiting,         ms * c.posting,
                   (double)c.reductions / n, (double)c.messages / n, 1e-3 * (double)c.bytes / n};
  check(b->context, mps_domain_max(domain, 6, most), "counts");
  if (mps_domain_rank(domain) == 0)
    printf("%s, rank with most: in reductions %.3f ms, waiting for messages %.3f, sending %.3f; "
           "%.2f reductions, %.2f messages, %.1f kB\n",
           which, most[0], most[1], most[2], most[3], most[4], most[5]);
}

/* The turn without a sort that took rank 0 least. */
static int64_t best_turn(const body *b, mps_domain *domain) {
  int64_t best = -1;
  for (int64_t k = 0; k < b->turns; k++)
    if (!b->sorted[k] && (best < 0 || b->step[k] < b->step[best])) best = k;
  double number = mps_domain_rank(domain) == 0 ? (double)best : -1.0;
  check(b->context, mps_domain_max(domain, 1, &number), "turn");
  return (int64_t)number;
}

static problem kind_of(const char *word) {
  static const char *const words[] = {"dynamics", "mpm", "ground"};
  for (int k = DYNAMICS; k <= GROUND; k++)
    if (strcmp(word, words[k]) == 0) return (problem)k;
  fprintf(stderr, "bench-domain: no solver %s: dynamics, mpm or ground\n", word);
  exit(2);
}

/* One line that scripts/bench-ranks reads. */
static void tell_row(mps_context *context, mps_domain *domain, const body *together,
                     const body *beside) {
  const spread joined = spread_of(together, false), apart = spread_of(beside, false);
  const double least[2] = {slowest(context, domain, joined.least),
                           slowest(context, domain, apart.least)};
  const double median[2] = {slowest(context, domain, joined.median),
                            slowest(context, domain, apart.median)};
  if (mps_domain_rank(domain) > 0) return;
  printf("together over alone: %.3f (least), %.3f (median)\n", least[1] / least[0],
         median[1] / median[0]);
  printf("row %d %lld %.4f %.4f %.4f %.4f\n", (int)mps_domain_size(domain),
         (long long)together->whole, 1e3 * least[0], 1e3 * least[1], 1e3 * median[0],
         1e3 * median[1]);
}

int main(int argc, char **argv) {
  static const char *const title[] = {"explicit dynamics", "WLS-MPM", "WLS-MPM in space"};
  const int64_t each = argc > 1 ? atoll(argv[1]) : 20000;
  int64_t steps = argc > 2 ? atoll(argv[2]) : 600;
  const problem kind = kind_of(argc > 3 ? argv[3] : "dynamics");
  mps_context_def def = mps_context_defaults();
  mps_context *context = NULL;
  mps_domain *domain = NULL;
  if (steps < TURN || steps > MOST_STEPS) steps = 600;
  def.executor = MPS_CONTEXT_EXECUTOR_SERIAL;
  check(NULL, mps_context_create(&def, &context, NULL, 0), "context");
  check(context, mps_petsc_domain_create_world(context, &domain), "domain");
  const int32_t ranks = mps_domain_size(domain);
  body together = make(context, domain, each * ranks, kind, steps);
  body beside = make(context, NULL, each, kind, steps);
  while (together.turns * TURN < steps) {
    take_turn(&together);
    take_turn(&beside); /* all ranks at once: the last step has synchronised them */
  }
  if (mps_domain_rank(domain) == 0)
    printf("%s, %d ranks of %lld particles\n", title[kind], (int)ranks, (long long)each);
  tell(context, domain, "together", &together);
  const int64_t best = best_turn(&together, domain);
  tell_counts(&together, domain, "a step", 0, together.turns);
  if (best >= 0) tell_counts(&together, domain, "a step of the least turn", best, best + 1);
  tell(context, domain, "each alone, beside the others", &beside);
  tell_row(context, domain, &together, &beside);
  destroy(&together);
  destroy(&beside);
  mps_domain_destroy(&domain);
  mps_context_destroy(&context);
  return 0;
}
