/* begin_ranks.c - memory that begins a model on ranks: bench-begin-ranks [PARTICLES [RANKS
 * [SPACE]]] makes a box of so many particles (1e6) of WLS-MPM in the plane (SPACE 3: in space) on
 * so many ranks (16, at most 16) that are threads of this process, takes one step, and prints the
 * most bytes that the library has had at once, of one rank and of all together, and those after the
 * step. The set lies in parts (mps_domain_create_particles), so that no rank has memory for all of
 * it. SPDX-License-Identifier: BSD-3-Clause */
#include "domain_threads.h"
#include "peak_allocator.h"

#include <mps/mpm.h>
#include <mps/experimental/domain.h>

#include <math.h>
#include <sys/resource.h>

typedef struct model {
  double particles;
  int32_t dim;
  peak_allocator memory[TEAM_MOST];
  int64_t here[TEAM_MOST]; /* particles */
  mps_status status[TEAM_MOST];
  char message[TEAM_MOST][512];
} model;

static mps_status begin(mps_context *context, mps_domain *domain, const model *m, int64_t *here) {
  mps_particles_def def = mps_particles_defaults();
  mps_mpm_def solver = mps_mpm_defaults();
  mps_particles *set = NULL;
  mps_material *material = NULL;
  mps_mpm *mpm = NULL;
  const double side = m->dim == 3 ? ceil(cbrt(m->particles)) : ceil(sqrt(m->particles));
  const double lo[3] = {0.0, 0.0, 0.0}, hi[3] = {side, side, side};
  def.dim = m->dim, def.spacing = 1.0;
  solver.cell = 2.0, solver.domain = domain;
  solver.geometry = m->dim == 3 ? MPS_MPM_GEOMETRY_SPACE : MPS_MPM_GEOMETRY_PLANE_STRAIN;
  mps_status status = mps_domain_create_particles(domain, &def, &set);
  if (status == MPS_OK) status = mps_particles_fill_box(set, lo, hi, NULL);
  if (status == MPS_OK) status = mps_particles_set(set, "density", 0, 1900.0);
  if (status == MPS_OK) status = mps_material_create_linear_elastic(context, 6e7, 0.3, &material);
  status = mps_domain_agree(domain, status);
  if (status == MPS_OK) status = mps_mpm_create(context, set, material, &solver, &mpm);
  if (status == MPS_OK) status = mps_mpm_step(mpm, 1);
  *here = mps_particles_count(set);
  return status; /* objects go with the process */
}

static void run(void *user, team *t, int32_t rank) {
  model *m = user;
  mps_context *context = NULL;
  mps_domain *domain = NULL;
  mps_context_def def = mps_context_defaults();
  const mps_domain_def domain_def = team_domain_def(t, rank);
  def.executor = MPS_CONTEXT_EXECUTOR_SERIAL;
  peak_use(&def, &m->memory[rank]);
  mps_status status = mps_context_create(&def, &context, NULL, 0);
  if (status == MPS_OK) status = mps_domain_create(context, &domain_def, &domain);
  if (status == MPS_OK) status = begin(context, domain, m, &m->here[rank]);
  m->status[rank] = status;
  if (context) snprintf(m->message[rank], 512, "%s", mps_context_error(context)->message);
}

int main(int argc, char **argv) {
  static model m;
  const int32_t ranks = argc > 2 ? atoi(argv[2]) : TEAM_MOST;
  team t;
  m.particles = argc > 1 ? atof(argv[1]) : 1e6;
  m.dim = argc > 3 && atoi(argv[3]) == 3 ? 3 : 2;
  if (ranks < 2 || ranks > TEAM_MOST || !(m.particles >= 1.0 && m.particles <= 2e9)) {
    fprintf(stderr, "bench-begin-ranks: 1 to 2e9 particles on 2 to %d ranks\n", TEAM_MOST);
    return 2;
  }
  team_begin(&t, ranks);
  team_run(&t, run, &m);
  int64_t all = 0, most = 0, sum = 0, now = 0;
  for (int32_t r = 0; r < ranks; r++) {
    if (m.status[r] != MPS_OK) {
      fprintf(stderr, "rank %d: %s\n", (int)r, m.message[r]);
      return 1;
    }
    all += m.here[r], sum += m.memory[r].most, now += m.memory[r].now;
    most = m.memory[r].most > most ? m.memory[r].most : most;
  }
  struct rusage usage;
  getrusage(RUSAGE_SELF, &usage);
  printf("%lld particles in %s on %d ranks: at most %.1f MB on a rank, %.1f MB on all (%.1f B a "
         "particle), %.1f MB after a step (%.1f B a particle); the process had %.1f MB\n",
         (long long)all, m.dim == 3 ? "space" : "the plane", (int)ranks, 1e-6 * (double)most,
         1e-6 * (double)sum, (double)sum / (double)all, 1e-6 * (double)now,
         (double)now / (double)all, 1e-3 * (double)usage.ru_maxrss * 1.024);
  return 0;
}
