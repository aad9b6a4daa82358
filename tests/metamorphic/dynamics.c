/* dynamics.c - random layers of explicit dynamics and their images: dashpots, driven and held
 * boxes, loads, damping, a start in motion. SPDX-License-Identifier: BSD-3-Clause */
#include "plane.h"

#include <float.h>
#include <math.h>
#include <stdio.h>

typedef struct layers {
  lattice of;
  int32_t integrator, rotation, damping;
  uint32_t dofs[EDGES];
  bool load;
  double ratio;
} layers;

static layers choose(uint64_t seed, const change *by) {
  static const int32_t kinds[] = {-1,
                                  -1,
                                  MPS_BOUNDARY_HELD,
                                  MPS_BOUNDARY_DRIVEN,
                                  MPS_BOUNDARY_ABSORBING,
                                  MPS_BOUNDARY_ABSORBING};
  uint64_t r = seed * UINT64_C(0xD1342543DE82EF95) + 7;
  layers chosen = {.of.by = by}, *l = &chosen;
  lattice *g = &l->of;
  g->nx = 6 + below(&r, 12), g->ny = 5 + below(&r, 12);
  l->integrator = below(&r, 2), l->rotation = below(&r, 2), l->damping = below(&r, 2);
  for (int k = 0; k < EDGES; k++) {
    g->kind[k] = kinds[below(&r, 6)];
    l->dofs[k] = (uint32_t)(1 + below(&r, 3)); /* x, y, both: no turn prescribed */
    for (int c = 0; c < 2; c++)
      g->moves[k][c] =
          (g->kind[k] == MPS_BOUNDARY_DRIVEN || g->kind[k] == MPS_BOUNDARY_ABSORBING) &&
          below(&r, 2);
  }
  l->load = below(&r, 2);
  g->contrast = uniform(&r, 1.0, 2.0), l->ratio = below(&r, 2) ? uniform(&r, 0.01, 0.05) : 0.0;
  g->frequency = uniform(&r, 2.0, 20.0), g->amplitude = uniform(&r, 1e-4, 1e-2);
  g->phase = uniform(&r, 0.0, 3.0);
  for (int c = 0; c < 2; c++) g->traction[c] = uniform(&r, -1e4, 1e4);
  for (int k = 0; k < 2; k++) g->steps[k] = 20 + below(&r, 40);
  g->random = r;
  return chosen;
}

static mps_status make_edges(layers *l) {
  lattice *g = &l->of;
  const change *by = g->by;
  mps_signal *signal = NULL;
  mps_status status = make_signal(g, &signal);
  for (int k = 0; k < EDGES; k++) {
    int64_t ids[64];
    mps_dynamics_boundary_def def = mps_dynamics_boundary_defaults();
    if (g->kind[k] < 0) continue;
    def.kind = g->kind[k];
    def.ids = ids, def.id_count = list_edge(g, k, ids);
    def.axis = by->axis[k / 2];
    for (int c = 0; c < 2; c++) {
      if (def.kind != MPS_BOUNDARY_ABSORBING && l->dofs[k] >> c & 1) def.dofs |= 1u << by->axis[c];
      if (!g->moves[k][c]) continue;
      def.signal[by->axis[c]] = signal, def.factor[by->axis[c]] = by->sign[c] * (1.0 + c);
    }
    TRY(mps_solver_add(g->solver, MPS_DEF_DYNAMICS_BOUNDARY, &def, NULL));
  }
  mps_signal_destroy(&signal);
  return status;
}

/* Two layers, the upper one softer. */
static mps_status build(lattice *g) {
  layers *l = (layers *)g;
  const change *by = g->by;
  const double first[2] = {0.5 * SPACING * (1 - g->nx), 0.5 * SPACING * (1 - g->ny)};
  mps_dynamics_def def = mps_dynamics_defaults();
  mps_dynamics_load_def load = mps_dynamics_load_defaults();
  mps_dynamics *dynamics = NULL;
  int64_t ids[64];
  def.integrator = l->integrator, def.rotation = l->rotation, def.damping = l->damping;
  def.dt = ldexp(2e-4, -by->halved) * by->time, def.measure = by->length;
  def.f1 = 1.0 / by->time, def.f2 = 14.0 / by->time;
  mps_status status = make_lattice(g, first);
  TRY(mps_particles_set(g->set, "shear_velocity", 0, 200.0 * by->length / by->time));
  TRY(mps_particles_set(g->set, "pressure_velocity", 0, 400.0 * by->length / by->time));
  TRY(mps_particles_set(g->set, "damping", 0, l->ratio));
  TRY(soften(g, "shear_velocity"));
  TRY(soften(g, "pressure_velocity"));
  TRY(mps_dynamics_create(g->context, g->set, &def, &dynamics));
  if (status == MPS_OK) g->solver = mps_dynamics_solver(dynamics);
  TRY(make_edges(l));
  load.ids = ids, load.id_count = list_edge(g, 3, ids);
  for (int c = 0; c < 2; c++)
    load.traction[by->axis[c]] =
        by->sign[c] * g->traction[c] * by->mass / (by->length * by->time * by->time);
  if (l->load) TRY(mps_solver_add(g->solver, MPS_DEF_DYNAMICS_LOAD, &load, NULL));
  return status;
}

void run_layers(const plan *p, const change *by, const char *folder, result *out) {
  layers l = choose(p->seed, by);
  run_lattice(&l.of, build, "position", folder, out);
}

/* A step adds some ten units of round-off to displacements, as parts of the positions that pairs
 * subtract: of the ground's 20 spacings, over the displacements of 1e-3 spacings that matter. */
double bound_of_layers(const plan *p, double left) {
  const layers l = choose(p->seed, NULL);
  (void)left;
  return 10.0 * DBL_EPSILON * 2e4 * (double)(l.of.steps[0] + l.of.steps[1]);
}

void print_layers(const plan *p) {
  const layers l = choose(p->seed, NULL);
  print_lattice(&l.of);
  printf("layers, integrator %d, rotation %d, damping %d of %g%s\n", (int)l.integrator,
         (int)l.rotation, (int)l.damping, l.ratio, l.load ? ", a load" : "");
}
