/* elastic.c - random blocks of implicit elasticity in motion, and their images: plane stress or
 * strain, held, driven and rolling edges, body forces, a traction on an edge, damping.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "plane.h"

#include <math.h>
#include <stdio.h>

typedef struct blocks {
  lattice of;
  int32_t state, solver;
  double poisson, damping, body[2];
} blocks;

/* The lower edge is held in all scenes, so that the matrix is regular without inertia too. */
static blocks choose(uint64_t seed, const change *by) {
  static const int32_t kinds[] = {-1, -1, MPS_BOUNDARY_HELD, MPS_BOUNDARY_DRIVEN};
  uint64_t r = seed * UINT64_C(0x9E6C63D0876A9A47) + 5;
  blocks chosen = {.of.by = by}, *b = &chosen;
  lattice *g = &b->of;
  g->nx = 4 + below(&r, 6), g->ny = 4 + below(&r, 6);
  b->state = below(&r, 2) ? MPS_ELASTIC_STATE_PLANE_STRAIN : MPS_ELASTIC_STATE_PLANE_STRESS;
  b->solver = below(&r, 2) ? MPS_ELASTIC_SOLVER_LDLT : MPS_ELASTIC_SOLVER_CG;
  for (int k = 0; k < EDGES; k++) {
    g->kind[k] = k == 2 ? MPS_BOUNDARY_HELD : kinds[below(&r, 4)];
    for (int c = 0; c < 2; c++) g->moves[k][c] = g->kind[k] == MPS_BOUNDARY_DRIVEN && below(&r, 2);
  }
  b->poisson = uniform(&r, 0.0, 0.45), g->contrast = uniform(&r, 1.0, 5.0);
  b->damping = below(&r, 2) ? uniform(&r, 1.0, 10.0) : 0.0;
  g->frequency = uniform(&r, 2.0, 20.0), g->amplitude = uniform(&r, 1e-4, 1e-2);
  g->phase = uniform(&r, 0.0, 3.0);
  for (int c = 0; c < 2; c++)
    b->body[c] = uniform(&r, -2e4, 2e4), g->traction[c] = uniform(&r, -1e4, 1e4);
  for (int k = 0; k < 2; k++) g->steps[k] = 3 + below(&r, 6);
  g->random = r;
  return chosen;
}

static double pressure_of(const change *by) {
  return by->mass / (by->length * by->time * by->time);
}

static mps_status make_edges(lattice *g) {
  const change *by = g->by;
  mps_signal *signal = NULL;
  mps_status status = make_signal(g, &signal);
  for (int k = 0; k < EDGES; k++) {
    int64_t ids[64];
    mps_elastic_boundary_def def = mps_elastic_boundary_defaults();
    if (g->kind[k] < 0) continue;
    def.kind = g->kind[k];
    def.ids = ids, def.id_count = list_edge(g, k, ids);
    for (int c = 0; c < 2; c++) {
      if (!g->moves[k][c]) continue;
      def.signal[by->axis[c]] = signal, def.factor[by->axis[c]] = by->sign[c] * (1.0 + c);
    }
    TRY(mps_solver_add(g->solver, MPS_DEF_ELASTIC_BOUNDARY, &def, NULL));
  }
  mps_signal_destroy(&signal);
  return status;
}

static mps_status make_loads(const blocks *b) {
  const lattice *g = &b->of;
  const change *by = g->by;
  mps_elastic_load_def weight = mps_elastic_load_defaults(), pull = weight;
  int64_t ids[64];
  pull.kind = MPS_ELASTIC_LOAD_FORCE;
  pull.ids = ids, pull.id_count = list_edge(g, 3, ids);
  for (int c = 0; c < 2; c++) {
    const double scale = by->sign[c] * pressure_of(by);
    weight.force[by->axis[c]] = b->body[c] * scale / by->length;
    pull.force[by->axis[c]] = g->traction[c] * scale * SPACING * by->length * by->length;
  }
  mps_status status = mps_solver_add(g->solver, MPS_DEF_ELASTIC_LOAD, &weight, NULL);
  TRY(mps_solver_add(g->solver, MPS_DEF_ELASTIC_LOAD, &pull, NULL));
  return status;
}

/* A block of two materials. */
static mps_status build(lattice *g) {
  blocks *b = (blocks *)g;
  const change *by = g->by;
  const double first[2] = {0.5 * SPACING, 0.5 * SPACING};
  mps_elastic_def def = mps_elastic_defaults();
  mps_elastic_motion_def motion = mps_elastic_motion_defaults();
  mps_elastic *elastic = NULL;
  def.state = b->state, def.solver = b->solver, def.measure = by->length;
  def.tolerance = 1e-13;
  motion.dt = ldexp(2e-3, -by->halved) * by->time, motion.mass_damping = b->damping / by->time;
  mps_status status = make_lattice(g, first);
  TRY(mps_particles_set(g->set, "young", 0, 1e7 * pressure_of(by)));
  TRY(mps_particles_set(g->set, "poisson", 0, b->poisson));
  TRY(soften(g, "young"));
  TRY(mps_elastic_create(g->context, g->set, &def, &elastic));
  if (status == MPS_OK) g->solver = mps_elastic_solver(elastic);
  TRY(make_edges(g));
  TRY(make_loads(b));
  TRY(mps_elastic_start(elastic, &motion));
  return status;
}

void run_blocks(const plan *p, const change *by, const char *folder, result *out) {
  blocks b = choose(p->seed, by);
  run_lattice(&b.of, build, "displacement", folder, out);
}

/* Each solution has round-off, or the tolerance of conjugate gradients, times the condition of the
 * matrix, some hundreds of elements squared. */
double bound_of_blocks(const plan *p, double left) {
  const blocks b = choose(p->seed, NULL);
  (void)left;
  return 1e3 * 1e-13 * (double)(b.of.steps[0] + b.of.steps[1]);
}

void print_blocks(const plan *p) {
  const blocks b = choose(p->seed, NULL);
  print_lattice(&b.of);
  printf("a block, state %d, solver %d, nu %g, damping %g\n", (int)b.state, (int)b.solver,
         b.poisson, b.damping);
}
