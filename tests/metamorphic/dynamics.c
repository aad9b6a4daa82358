/* dynamics.c - random layers of explicit dynamics and their images: dashpots, driven and held
 * boxes, loads, damping, a start in motion. SPDX-License-Identifier: BSD-3-Clause */
#include "metamorphic.h"

#include <float.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#define TRY(call)                                                                                  \
  do {                                                                                             \
    if (status == MPS_OK) status = (call);                                                         \
  } while (0)

typedef struct layers {
  int nx, ny;
  int32_t integrator, rotation, damping;
  int32_t kind[EDGES]; /* -1: none */
  uint32_t dofs[EDGES];
  bool moves[EDGES][2], load;
  double contrast, ratio, frequency, amplitude, phase, traction[2];
  int64_t steps[2];
  uint64_t random;
} layers;

static void choose(uint64_t seed, layers *l) {
  static const int32_t kinds[] = {-1,
                                  -1,
                                  MPS_BOUNDARY_HELD,
                                  MPS_BOUNDARY_DRIVEN,
                                  MPS_BOUNDARY_ABSORBING,
                                  MPS_BOUNDARY_ABSORBING};
  uint64_t r = seed * UINT64_C(0xD1342543DE82EF95) + 7;
  memset(l, 0, sizeof *l);
  l->nx = 6 + below(&r, 12), l->ny = 5 + below(&r, 12);
  l->integrator = below(&r, 2), l->rotation = below(&r, 2), l->damping = below(&r, 2);
  for (int k = 0; k < EDGES; k++) {
    l->kind[k] = kinds[below(&r, 6)];
    l->dofs[k] = (uint32_t)(1 + below(&r, 3)); /* x, y, both: no turn prescribed */
    for (int c = 0; c < 2; c++)
      l->moves[k][c] =
          (l->kind[k] == MPS_BOUNDARY_DRIVEN || l->kind[k] == MPS_BOUNDARY_ABSORBING) &&
          below(&r, 2);
  }
  l->load = below(&r, 2);
  l->contrast = uniform(&r, 1.0, 2.0), l->ratio = below(&r, 2) ? uniform(&r, 0.01, 0.05) : 0.0;
  l->frequency = uniform(&r, 2.0, 20.0), l->amplitude = uniform(&r, 1e-4, 1e-2);
  l->phase = uniform(&r, 0.0, 3.0);
  for (int c = 0; c < 2; c++) l->traction[c] = uniform(&r, -1e4, 1e4);
  for (int k = 0; k < 2; k++) l->steps[k] = 20 + below(&r, 40);
  l->random = r;
}

typedef struct ground {
  const layers *l;
  const change *by;
  mps_context *context;
  mps_particles *set;
  mps_dynamics *dynamics;
} ground;

static double lattice(int i, int n) { return SPACING * (i + 0.5 - 0.5 * n); }

void place_in_plane(const change *by, const double *x, double *out) {
  for (int c = 0; c < 2; c++)
    out[by->axis[c]] =
        by->sign[c] * x[c] * by->length + by->shift[by->axis[c]] * (SPACING * by->length);
}

double sense_of_turns(const change *by) {
  return (by->axis[0] == 0 ? 1.0 : -1.0) * by->sign[0] * by->sign[1];
}

/* Two layers, the upper one softer; a start in random motion. */
static mps_status make_ground(ground *g) {
  const layers *l = g->l;
  const change *by = g->by;
  const double speed = by->length / by->time;
  uint64_t r = l->random;
  mps_particles_def def = mps_particles_defaults();
  mps_edit v, vs, vp;
  def.spacing = SPACING * by->length;
  mps_status status = mps_particles_create(g->context, &def, &g->set);
  for (int j = 0; j < l->ny; j++)
    for (int i = 0; i < l->nx; i++) {
      const double x[2] = {lattice(i, l->nx), lattice(j, l->ny)};
      double at[2];
      place_in_plane(by, x, at);
      TRY(mps_particles_append(g->set, 1, at));
    }
  TRY(mps_particles_set(g->set, "density", 0, 1900.0 * by->mass / pow(by->length, 3.0)));
  TRY(mps_particles_set(g->set, "shear_velocity", 0, 200.0 * speed));
  TRY(mps_particles_set(g->set, "pressure_velocity", 0, 400.0 * speed));
  TRY(mps_particles_set(g->set, "damping", 0, l->ratio));
  TRY(mps_particles_add_field(g->set, "velocity", 0));
  TRY(mps_particles_edit(g->set, "velocity", &v));
  TRY(mps_particles_edit(g->set, "shear_velocity", &vs));
  TRY(mps_particles_edit(g->set, "pressure_velocity", &vp));
  for (int64_t k = 0; status == MPS_OK && k < v.view.shape[0]; k++) {
    if (k >= v.view.shape[0] / 2) {
      *mps_edit_f64(&vs, k, 0) /= l->contrast;
      *mps_edit_f64(&vp, k, 0) /= l->contrast;
    }
    for (int c = 0; c < 2; c++)
      *mps_edit_f64(&v, k, by->axis[c]) = by->sign[c] * speed * uniform(&r, -0.1, 0.1);
  }
  TRY(mps_particles_commit(g->set, &v));
  TRY(mps_particles_commit(g->set, &vs));
  TRY(mps_particles_commit(g->set, &vp));
  return status;
}

int64_t list_edge(int nx, int ny, int k, int64_t *ids) {
  int64_t count = 0;
  const int along = k < 2 ? ny : nx, row = k % 2 ? (k < 2 ? nx : ny) - 1 : 0;
  for (int i = 0; i < along; i++) ids[count++] = k < 2 ? (int64_t)i * nx + row : row * nx + i;
  return count;
}

static mps_status make_edges(ground *g) {
  const layers *l = g->l;
  const change *by = g->by;
  mps_signal *signal = NULL;
  mps_status status =
      mps_signal_create_sine(g->context, MPS_SIGNAL_QUANTITY_DISPLACEMENT, l->frequency / by->time,
                             l->amplitude * by->length, l->phase, &signal);
  for (int k = 0; k < EDGES; k++) {
    int64_t ids[64];
    mps_dynamics_boundary_def def = mps_dynamics_boundary_defaults();
    if (l->kind[k] < 0) continue;
    def.kind = l->kind[k];
    def.ids = ids, def.id_count = list_edge(l->nx, l->ny, k, ids);
    def.axis = by->axis[k / 2];
    for (int c = 0; c < 2; c++) {
      if (def.kind != MPS_BOUNDARY_ABSORBING && l->dofs[k] >> c & 1) def.dofs |= 1u << by->axis[c];
      if (!l->moves[k][c]) continue;
      def.signal[by->axis[c]] = signal, def.factor[by->axis[c]] = by->sign[c] * (1.0 + c);
    }
    TRY(mps_dynamics_add_boundary(g->dynamics, &def, NULL));
  }
  mps_signal_destroy(&signal);
  return status;
}

static mps_status build(ground *g) {
  const layers *l = g->l;
  const change *by = g->by;
  mps_dynamics_def def = mps_dynamics_defaults();
  mps_dynamics_load_def load = mps_dynamics_load_defaults();
  int64_t ids[64];
  def.integrator = l->integrator, def.rotation = l->rotation, def.damping = l->damping;
  def.dt = ldexp(2e-4, -by->halved) * by->time, def.measure = by->length;
  def.f1 = 1.0 / by->time, def.f2 = 14.0 / by->time;
  mps_status status = make_ground(g);
  TRY(mps_dynamics_create(g->context, g->set, &def, &g->dynamics));
  TRY(make_edges(g));
  load.ids = ids, load.id_count = list_edge(l->nx, l->ny, 3, ids);
  for (int c = 0; c < 2; c++)
    load.traction[by->axis[c]] =
        by->sign[c] * l->traction[c] * by->mass / (by->length * by->time * by->time);
  if (l->load) TRY(mps_dynamics_add_load(g->dynamics, &load, NULL));
  return status;
}

static mps_status run(ground *g, const char *folder) {
  const layers *l = g->l;
  mps_snapshot *snapshot = NULL;
  char path[400];
  mps_status status = build(g);
  TRY(mps_dynamics_step(g->dynamics, l->steps[0] << g->by->halved));
  if (g->by->way == ROLLED_BACK) {
    TRY(mps_dynamics_snapshot(g->dynamics, &snapshot));
    TRY(mps_dynamics_step(g->dynamics, l->steps[1]));
    TRY(mps_dynamics_rollback(g->dynamics, snapshot));
    mps_snapshot_destroy(&snapshot);
  }
  if (g->by->way == RESTORED) {
    snprintf(path, sizeof path, "%s/metamorphic-%d.h5", folder, (int)getpid());
    TRY(mps_dynamics_save(g->dynamics, path, NULL));
    mps_dynamics_destroy(&g->dynamics);
    mps_particles_destroy(&g->set);
    TRY(build(g));
    TRY(mps_dynamics_restore(g->dynamics, path, NULL));
    (void)remove(path);
  }
  const int64_t steps = l->steps[1] << g->by->halved;
  for (int64_t k = 0; g->by->way != AT_ONCE && k < steps; k++)
    TRY(mps_dynamics_step(g->dynamics, 1));
  if (g->by->way == AT_ONCE) TRY(mps_dynamics_step(g->dynamics, steps));
  return status;
}

static void keep(ground *g, result *out) {
  const change *by = g->by;
  const double scale[3] = {by->length, by->length / by->time, by->length / (by->time * by->time)};
  mps_view view[4], id;
  static const char *const names[] = {"position", "velocity", "acceleration", "rotation"};
  for (int f = 0; f < 4; f++)
    if (mps_particles_view(g->set, names[f], &view[f]) != MPS_OK) abort();
  if (mps_particles_view(g->set, "id", &id) != MPS_OK) abort();
  out->count = id.shape[0];
  for (int64_t k = 0; k < out->count; k++) {
    const int64_t i = *mps_view_i64(&id, k, 0);
    double(*to[3])[3] = {&out->position[i], &out->velocity[i], &out->stress[i][0]};
    out->here[i] = true;
    for (int f = 0; f < 3; f++)
      for (int c = 0; c < 2; c++) {
        const int a = by->axis[c];
        double x = *mps_view_f64(&view[f], k, a);
        if (f == 0) x -= by->shift[a] * (SPACING * by->length);
        (*to[f])[c] = by->sign[c] * x / scale[f];
      }
    out->scalar[2][i] = sense_of_turns(by) * *mps_view_f64(&view[3], k, 0);
  }
  for (int k = 0, number = 0; k < EDGES; k++) {
    mps_reaction r;
    if (g->l->kind[k] < 0) continue;
    if (mps_dynamics_get_reaction(g->dynamics, number++, &r) != MPS_OK) abort();
    for (int c = 0; c < 2; c++)
      out->impulse[k][c] =
          by->sign[c] * r.impulse[by->axis[c]] / (by->mass * by->length / by->time);
  }
}

void run_layers(const plan *p, const change *by, const char *folder, result *out) {
  layers l;
  ground g = {.l = &l, .by = by};
  mps_context_def def = mps_context_defaults();
  char why[200];
  memset(out, 0, sizeof *out);
  choose(p->seed, &l);
  def.executor = by->threads > 0 ? MPS_CONTEXT_EXECUTOR_THREADS : MPS_CONTEXT_EXECUTOR_SERIAL;
  def.threads = by->threads > 0 ? by->threads : 1;
  if (mps_context_create(&def, &g.context, why, sizeof why) != MPS_OK) abort();
  out->status = run(&g, folder);
  if (out->status != MPS_OK)
    snprintf(out->message, sizeof out->message, "%.190s", mps_context_error(g.context)->message);
  if (out->status == MPS_OK) keep(&g, out);
  mps_dynamics_destroy(&g.dynamics);
  mps_particles_destroy(&g.set);
  mps_context_destroy(&g.context);
}

/* A step adds some ten units of round-off to displacements, as parts of the positions that pairs
 * subtract: of the ground's 20 spacings, over the displacements of 1e-3 spacings that matter. */
double bound_of_layers(const plan *p, double left) {
  layers l;
  (void)left;
  choose(p->seed, &l);
  return 10.0 * DBL_EPSILON * 2e4 * (double)(l.steps[0] + l.steps[1]);
}

void print_layers(const plan *p) {
  layers l;
  choose(p->seed, &l);
  printf(
      "  layers of %d x %d particles, integrator %d, rotation %d, damping %d of %g, contrast %g, "
      "edges %d %d %d %d%s; steps %d %d\n",
      l.nx, l.ny, (int)l.integrator, (int)l.rotation, (int)l.damping, l.ratio, l.contrast,
      (int)l.kind[0], (int)l.kind[1], (int)l.kind[2], (int)l.kind[3], l.load ? ", a load" : "",
      (int)l.steps[0], (int)l.steps[1]);
}
