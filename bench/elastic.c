/* elastic.c - benchmark of implicit elasticity: a square cantilever plate (2D) and a block (3D) of
 * growing size, time and memory of each stage, and the exponent of growth from row to row.
 *
 * bench-elastic [UNKNOWNS_2D [UNKNOWNS_3D [THREADS [SMALLEST [SOLVER]]]]]: the largest sizes,
 * default 1e6 and 1e5 (0 leaves the dimension out), threads (0: all), the smallest size, default
 * 1e3, and mps_elastic_solver_kind, default 0. SPDX-License-Identifier: BSD-3-Clause */
#include "measure.h"

#include <mps/elastic.h>

#include <math.h>

/* The library's own memory: an allocator that keeps the size in front of each block. */
typedef struct own_memory {
  double now, peak; /* bytes */
} own_memory;

static void *own_alloc(void *user, size_t size, size_t alignment) {
  own_memory *m = user;
  char *block = aligned_alloc(alignment, size + alignment);
  if (!block) return NULL;
  ((size_t *)block)[0] = size;
  m->now += (double)size;
  m->peak = fmax(m->peak, m->now);
  return block + alignment;
}

/* Every block of the library is aligned to 64 bytes, so the header lies 64 bytes in front. */
static void own_free(void *user, void *memory) {
  char *block = (char *)memory - 64;
  ((own_memory *)user)->now -= (double)((size_t *)block)[0];
  free(block);
}

typedef struct result {
  double unknowns, nonzeros, flops, bytes, peak, own;
  double create, assemble, analyse, factor, solve, total;
} result;

/* A square or cube of `cells` a side, clamped below, pulled sideways above. */
static result measure(int32_t dim, int64_t cells, int threads, int solver) {
  mps_context *context = NULL;
  mps_particles *particles = NULL;
  mps_elastic *elastic = NULL;
  mps_context_def context_def = mps_context_defaults();
  mps_particles_def set = mps_particles_defaults();
  mps_elastic_def def = mps_elastic_defaults();
  char text[256] = "";
  def.solver = solver;
  own_memory own = {0};
  context_def.threads = threads;
  context_def.alloc = own_alloc;
  context_def.free = own_free;
  context_def.memory_user = &own;
  check(NULL, mps_context_create(&context_def, &context, text, sizeof text), text);
  set.dim = dim;
  set.spacing = 1.0 / (double)cells;
  const double lo[3] = {0, 0, 0}, hi[3] = {1, 1, 1};
  check(context, mps_particles_create(context, &set, &particles), "particles");
  check(context, mps_particles_fill_box(particles, lo, hi, NULL), "fill");
  check(context, mps_particles_set(particles, "young", 0, 1.0), "young");
  check(context, mps_particles_set(particles, "poisson", 0, 0.3), "poisson");
  const int64_t n = mps_particles_count(particles);
  int64_t *ids = malloc((size_t)n * sizeof *ids), count;
  const double base[3] = {1, dim == 2 ? set.spacing : 1, dim == 3 ? set.spacing : 1};
  check(context, mps_particles_select_box(particles, lo, base, n, &count, ids), "select");
  const double start = seconds();
  check(context, mps_elastic_create(context, particles, &def, &elastic), "create");
  const double created = seconds();
  mps_elastic_boundary_def clamp = mps_elastic_boundary_defaults();
  clamp.ids = ids;
  clamp.id_count = count;
  check(context, mps_elastic_add_boundary(elastic, &clamp, NULL), "boundary");
  check(context,
        mps_elastic_select_facets(elastic, mps_side_of(dim - 1, 1), NULL, NULL, n, &count, ids),
        "facets");
  mps_elastic_load_def pull = mps_elastic_load_defaults();
  pull.kind = MPS_ELASTIC_LOAD_TRACTION;
  pull.ids = ids;
  pull.id_count = count;
  pull.force[0] = 1.0;
  check(context, mps_elastic_add_load(elastic, &pull, NULL), "load");
  check(context, mps_elastic_solve(elastic), "solve");
  const double end = seconds();
  mps_elastic_report report;
  check(context, mps_elastic_get_report(elastic, &report), "report");
  free(ids);
  mps_elastic_destroy(&elastic);
  mps_particles_destroy(&particles);
  mps_context_destroy(&context);
  return (result){.unknowns = (double)report.unknowns,
                  .nonzeros = (double)report.factor_nonzeros,
                  .flops = report.factor_flops,
                  .bytes = report.factor_bytes,
                  .peak = report.peak_bytes,
                  .own = own.peak,
                  .create = created - start,
                  .assemble = report.seconds_assemble,
                  .analyse = report.seconds_analyse,
                  .factor = report.seconds_factor,
                  .solve = report.seconds_solve,
                  .total = end - start};
}

static void series(int32_t dim, double smallest, double largest, int threads, int solver) {
  result former = {0};
  for (double target = smallest; target <= 1.01 * largest; target *= sqrt(10.0)) {
    const int64_t cells = (int64_t)llround(pow(target / dim, 1.0 / dim));
    const result r = measure(dim, cells, threads, solver);
    printf("%2dD %9.0f %8.2e %8.2e %7.1f %7.1f %7.1f %8.3f %8.3f %8.3f %8.3f %8.3f %8.3f %6.1f",
           dim, r.unknowns, r.nonzeros, r.flops, r.bytes * 1e-6, r.peak * 1e-6, r.own * 1e-6,
           r.create, r.assemble, r.analyse, r.factor, r.solve, r.total,
           100.0 * r.assemble / r.total);
    if (former.nonzeros > 0.0)
      printf(" %6.2f %6.2f %6.2f",
             log(r.nonzeros / former.nonzeros) / log(r.unknowns / former.unknowns),
             log(r.flops / former.flops) / log(r.unknowns / former.unknowns),
             log(r.factor / former.factor) / log(r.unknowns / former.unknowns));
    printf("\n");
    fflush(stdout);
    former = r;
  }
}

int main(int argc, char **argv) {
  const double plane = argc > 1 ? atof(argv[1]) : 1e6, solid = argc > 2 ? atof(argv[2]) : 1e5;
  const int threads = argc > 3 ? atoi(argv[3]) : 0;
  const double smallest = argc > 4 ? atof(argv[4]) : 1e3;
  const int solver = argc > 5 ? atoi(argv[5]) : MPS_ELASTIC_SOLVER_AUTO;
  printf("%3s %9s %8s %8s %7s %7s %7s %8s %8s %8s %8s %8s %8s %6s %6s %6s %6s\n", "", "unknowns",
         "nnz(L)", "flops", "L MB", "CHOLMOD", "own MB", "create", "assemble", "analyse", "factor",
         "solve", "total s", "asm %", "nnz~N^", "flop~", "time~");
  series(2, smallest, plane, threads, solver);
  series(3, smallest, solid, threads, solver);
  return 0;
}
