/* main.c - seeds of random scenes, each in all its images; see usage.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "metamorphic.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const char usage[] =
    "usage: test-metamorphic [--seed N] [--seeds A:B] [--steps K] [--folder DIR] [--verbose]\n\n"
    "Random scenes of WLS-MPM, of explicit dynamics and of implicit elasticity with every third\n"
    "seed, and their images; see tests/metamorphic/metamorphic.h.\n\n"
    "  --seed N      one scene (default: seeds 0:200)\n"
    "  --seeds A:B   scenes A to B - 1\n"
    "  --steps K     ends each scene after K steps: to find the first that differs\n"
    "  --folder DIR  where checkpoints are written (default: .)\n"
    "  --verbose     prints the features of each scene and the differences of all fields\n";

typedef struct options {
  uint64_t first, last;
  int64_t steps;
  const char *folder;
  bool verbose;
} options;

typedef struct image {
  const char *name;
  change by;
  bool exact;
} image;

static bool fits(const plan *p, const change *by) {
  const bool ring = p->geometry == MPS_MPM_GEOMETRY_AXISYMMETRIC;
  const bool field = p->side[0].kind == MPS_BOUNDARY_FREE_FIELD;
  if (p->dim == 2 && by->axis[2] != 2) return false;
  if ((ring || field) && (by->axis[0] != 0 || by->axis[1] != 1)) return false;
  if (ring && (by->sign[0] < 0.0 || by->shift[0] != 0)) return false;
  if (!ring && !field && by->shift[0] == 0 && by->shift[1] != 0) return false; /* along x too */
  return !(p->dim == 2 && (by->sign[2] < 0.0 || by->shift[2] != 0));
}

/* Water shares its change of volume within a block of cells only (docs/limits.md). So images of
 * such scenes have the same blocks: 8 cells wide, from 2 (mod 8) on with cubic weights, 3/2 with
 * quadratic ones. */
static change keep_blocks(const plan *p, change by) {
  for (int c = 0; c < p->dim && p->water; c++) {
    int *shift = &by.shift[by.axis[c]];
    const int middle = by.sign[c] < 0.0 ? (p->spline == 3 ? 4 : 3) : 0;
    while ((*shift - middle) % 8 != 0) ++*shift;
  }
  return by;
}

#define SAME .axis = {0, 1, 2}, .sign = {1, 1, 1}
#define UNIT .length = 1, .mass = 1, .time = 1
static const image images[] = {
    {"on 3 threads, all steps at once", {SAME, UNIT, .threads = 3, .way = AT_ONCE}, true},
    {"scaled, rolled back",
     {SAME, .length = 8, .mass = 0.25, .time = 0.5, .way = ROLLED_BACK},
     true},
    {"restored", {SAME, UNIT, .way = RESTORED}, true},
    {"mirrored along x", {.axis = {0, 1, 2}, .sign = {-1, 1, 1}, UNIT}, false},
    {"mirrored along y", {.axis = {0, 1, 2}, .sign = {1, -1, 1}, UNIT}, false},
    {"turned by 90 degrees", {.axis = {1, 0, 2}, .sign = {1, -1, 1}, UNIT}, false},
    {"x and y exchanged", {.axis = {1, 0, 2}, .sign = {1, 1, 1}, UNIT}, false},
    {"shifted", {SAME, UNIT, .shift = {5, 11, 0}}, false},
    {"shifted along y", {SAME, UNIT, .shift = {0, 11, 0}}, false},
    {"x, y, z in a circle, shifted",
     {.axis = {1, 2, 0}, .sign = {1, 1, 1}, UNIT, .shift = {2, 3, -7}},
     false},
    {"mirrored along z, scaled",
     {.axis = {0, 1, 2}, .sign = {1, 1, -1}, .length = 0.5, .mass = 4, .time = 2},
     false},
};

static void limit_steps(plan *p, int64_t most) {
  for (int k = 0; k < 3; k++) {
    if (p->steps[k] > most) p->steps[k] = most;
    most -= p->steps[k];
  }
}

static result base, other;

/* What makes and runs scenes of a solver. */
typedef struct kit {
  void (*print)(const plan *p);
  void (*run)(const plan *p, const change *by, const char *folder, result *out);
  double (*bound)(const plan *p, double left);
} kit;
static const kit ground = {print_plan, run_plan, bound_of};
static const kit layers = {print_layers, run_layers, bound_of_layers};
static const kit blocks = {print_blocks, run_blocks, bound_of_blocks};

static bool run_images(const options *o, const kit *of, const plan *p, double *worst) {
  bool good = true;
  if (o->verbose) {
    printf("seed %llu\n", (unsigned long long)p->seed);
    of->print(p);
  }
  of->run(p, &no_change, o->folder, &base);
  if (o->verbose) printf("  status %d %s\n", (int)base.status, base.message);
  const double bound = of->bound(p, base.left);
  for (size_t k = 0; k < sizeof images / sizeof *images; k++) {
    if (!fits(p, &images[k].by)) continue;
    const change by = images[k].exact ? images[k].by : keep_blocks(p, images[k].by);
    of->run(p, &by, o->folder, &other);
    /* the bound on the energy of a run starts from the state that is restored */
    if (images[k].by.way == RESTORED && base.status == MPS_ERROR_DIVERGED) continue;
    double apart = 0.0;
    const bool same = compare(p, &base, &other, images[k].exact ? 0.0 : bound, images[k].name,
                              o->verbose, &apart);
    if (!images[k].exact && same) *worst = fmax(*worst, apart / bound);
    good = good && same;
  }
  if (!good && !o->verbose) of->print(p);
  fflush(stdout);
  return good;
}

static double distance(const result *a, const result *b) {
  double most = 0.0;
  for (int64_t i = 0; i < 2 * MOST; i++)
    for (int c = 0; c < 3 && a->here[i]; c++)
      most = fmax(most, fabs(a->velocity[i][c] - b->velocity[i][c]));
  return most;
}

/* With steps of a quarter, an eighth and a sixteenth: the last change of velocities is less than .7
 * of the one before (a method of the first order .5, of the second .25; dashpots are of the first).
 */
static bool converges(const options *o, const kit *of, const plan *p) {
  static result last;
  change by = no_change;
  double apart[2];
  by.halved = 2;
  of->run(p, &by, o->folder, &last);
  for (int k = 0; k < 2; k++) {
    by.halved++;
    of->run(p, &by, o->folder, &other);
    if (last.status != MPS_OK || other.status != MPS_OK) return last.status == other.status;
    apart[k] = distance(&last, &other);
    last = other;
  }
  const bool good = apart[1] <= 0.7 * apart[0] + 1e-12;
  if (o->verbose || !good)
    printf("seed %llu: halved steps change velocities by %.3g, then by %.3g m/s\n",
           (unsigned long long)p->seed, apart[0], apart[1]);
  if (!good) of->print(p);
  return good;
}

static bool run_seed(const options *o, uint64_t seed, double *worst, int *refused) {
  static plan p;
  make_plan(seed, &p);
  limit_steps(&p, o->steps);
  bool good = run_images(o, &ground, &p, worst);
  *refused += base.status != MPS_OK;
  if (seed % 3 == 2) return good;
  const kit *of = seed % 3 == 0 ? &layers : &blocks;
  memset(&p, 0, sizeof p);
  p.seed = seed, p.dim = 2;
  good = run_images(o, of, &p, worst) && good;
  return converges(o, of, &p) && good;
}

static bool read_options(int count, char **text, options *o) {
  for (int k = 1; k < count; k++) {
    char *end = NULL;
    if (strcmp(text[k], "--verbose") == 0) {
      o->verbose = true;
    } else if (strcmp(text[k], "--folder") == 0 && k + 1 < count) {
      o->folder = text[++k];
    } else if (strcmp(text[k], "--seed") == 0 && k + 1 < count) {
      o->first = strtoull(text[++k], &end, 10);
      o->last = o->first + 1;
      if (*end) return false;
    } else if (strcmp(text[k], "--steps") == 0 && k + 1 < count) {
      o->steps = strtoll(text[++k], &end, 10);
      if (*end || o->steps < 0) return false;
    } else if (strcmp(text[k], "--seeds") == 0 && k + 1 < count) {
      o->first = strtoull(text[++k], &end, 10);
      if (*end != ':') return false;
      o->last = strtoull(end + 1, &end, 10);
      if (*end) return false;
    } else {
      return false;
    }
  }
  return o->first < o->last;
}

int main(int count, char **text) {
  options o = {.last = 200, .steps = 1000, .folder = "."};
  double worst = 0.0;
  int failed = 0, refused = 0;
  if (!read_options(count, text, &o)) {
    fputs(usage, stderr);
    return 2;
  }
  for (uint64_t seed = o.first; seed < o.last; seed++)
    failed += !run_seed(&o, seed, &worst, &refused);
  printf(
      "%llu scenes, of which %d end with an error: %d differ; the others by at most %.2g of what "
      "is allowed\n",
      (unsigned long long)(o.last - o.first), refused, failed, worst);
  return failed > 0;
}
