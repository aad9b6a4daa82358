/* elastic.c - random blocks of implicit elasticity in motion, and their images: plane stress or
 * strain, held, driven and rolling edges, body forces, a traction on an edge, damping.
 * SPDX-License-Identifier: BSD-3-Clause */
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

typedef struct blocks {
  int nx, ny;
  int32_t state, solver;
  int32_t kind[EDGES]; /* -1: none */
  bool moves[EDGES][2];
  double poisson, contrast, damping, frequency, amplitude, phase, body[2], traction[2];
  int64_t steps[2];
  uint64_t random;
} blocks;

/* The lower edge is held in all scenes, so that the matrix is regular without inertia too. */
static void choose(uint64_t seed, blocks *b) {
  static const int32_t kinds[] = {-1, -1, MPS_BOUNDARY_HELD, MPS_BOUNDARY_DRIVEN};
  uint64_t r = seed * UINT64_C(0x9E6C63D0876A9A47) + 5;
  memset(b, 0, sizeof *b);
  b->nx = 4 + below(&r, 6), b->ny = 4 + below(&r, 6);
  b->state = below(&r, 2) ? MPS_ELASTIC_STATE_PLANE_STRAIN : MPS_ELASTIC_STATE_PLANE_STRESS;
  b->solver = below(&r, 2) ? MPS_ELASTIC_SOLVER_LDLT : MPS_ELASTIC_SOLVER_CG;
  for (int k = 0; k < EDGES; k++) {
    b->kind[k] = k == 2 ? MPS_BOUNDARY_HELD : kinds[below(&r, 4)];
    for (int c = 0; c < 2; c++) b->moves[k][c] = b->kind[k] == MPS_BOUNDARY_DRIVEN && below(&r, 2);
  }
  b->poisson = uniform(&r, 0.0, 0.45), b->contrast = uniform(&r, 1.0, 5.0);
  b->damping = below(&r, 2) ? uniform(&r, 1.0, 10.0) : 0.0;
  b->frequency = uniform(&r, 2.0, 20.0), b->amplitude = uniform(&r, 1e-4, 1e-2);
  b->phase = uniform(&r, 0.0, 3.0);
  for (int c = 0; c < 2; c++)
    b->body[c] = uniform(&r, -2e4, 2e4), b->traction[c] = uniform(&r, -1e4, 1e4);
  for (int k = 0; k < 2; k++) b->steps[k] = 3 + below(&r, 6);
  b->random = r;
}

typedef struct body {
  const blocks *b;
  const change *by;
  mps_context *context;
  mps_particles *set;
  mps_elastic *elastic;
} body;

static double pressure_of(const change *by) {
  return by->mass / (by->length * by->time * by->time);
}

/* A block of two materials, with a start in random motion. */
static mps_status make_set(body *g) {
  const blocks *b = g->b;
  const change *by = g->by;
  uint64_t r = b->random;
  mps_particles_def def = mps_particles_defaults();
  mps_edit v, young;
  def.spacing = SPACING * by->length;
  mps_status status = mps_particles_create(g->context, &def, &g->set);
  for (int j = 0; j < b->ny; j++)
    for (int i = 0; i < b->nx; i++) {
      const double x[2] = {SPACING * (i + 0.5), SPACING * (j + 0.5)};
      double at[2];
      place_in_plane(by, x, at);
      TRY(mps_particles_append(g->set, 1, at));
    }
  TRY(mps_particles_set(g->set, "density", 0, 1900.0 * by->mass / pow(by->length, 3.0)));
  TRY(mps_particles_set(g->set, "young", 0, 1e7 * pressure_of(by)));
  TRY(mps_particles_set(g->set, "poisson", 0, b->poisson));
  TRY(mps_particles_add_field(g->set, "velocity", 0));
  TRY(mps_particles_edit(g->set, "velocity", &v));
  TRY(mps_particles_edit(g->set, "young", &young));
  for (int64_t k = 0; status == MPS_OK && k < v.view.shape[0]; k++) {
    if (k >= v.view.shape[0] / 2) *mps_edit_f64(&young, k, 0) /= b->contrast;
    for (int c = 0; c < 2; c++)
      *mps_edit_f64(&v, k, by->axis[c]) =
          by->sign[c] * (by->length / by->time) * uniform(&r, -0.1, 0.1);
  }
  TRY(mps_particles_commit(g->set, &v));
  TRY(mps_particles_commit(g->set, &young));
  return status;
}

static mps_status make_edges(body *g) {
  const blocks *b = g->b;
  const change *by = g->by;
  mps_signal *signal = NULL;
  mps_status status =
      mps_signal_create_sine(g->context, MPS_SIGNAL_QUANTITY_DISPLACEMENT, b->frequency / by->time,
                             b->amplitude * by->length, b->phase, &signal);
  for (int k = 0; k < EDGES; k++) {
    int64_t ids[64];
    mps_elastic_boundary_def def = mps_elastic_boundary_defaults();
    if (b->kind[k] < 0) continue;
    def.kind = b->kind[k];
    def.ids = ids, def.id_count = list_edge(b->nx, b->ny, k, ids);
    for (int c = 0; c < 2; c++) {
      if (!b->moves[k][c]) continue;
      def.signal[by->axis[c]] = signal, def.factor[by->axis[c]] = by->sign[c] * (1.0 + c);
    }
    TRY(mps_elastic_add_boundary(g->elastic, &def, NULL));
  }
  mps_signal_destroy(&signal);
  return status;
}

static mps_status make_loads(body *g) {
  const blocks *b = g->b;
  const change *by = g->by;
  mps_elastic_load_def weight = mps_elastic_load_defaults(), pull = weight;
  int64_t ids[64];
  pull.kind = MPS_ELASTIC_LOAD_FORCE;
  pull.ids = ids, pull.id_count = list_edge(b->nx, b->ny, 3, ids);
  for (int c = 0; c < 2; c++) {
    const double scale = by->sign[c] * pressure_of(by);
    weight.force[by->axis[c]] = b->body[c] * scale / by->length;
    pull.force[by->axis[c]] = b->traction[c] * scale * SPACING * by->length * by->length;
  }
  mps_status status = mps_elastic_add_load(g->elastic, &weight, NULL);
  TRY(mps_elastic_add_load(g->elastic, &pull, NULL));
  return status;
}

static mps_status build(body *g, bool start) {
  const blocks *b = g->b;
  const change *by = g->by;
  mps_elastic_def def = mps_elastic_defaults();
  mps_elastic_motion_def motion = mps_elastic_motion_defaults();
  def.state = b->state, def.solver = b->solver, def.measure = by->length;
  def.tolerance = 1e-13;
  motion.dt = ldexp(2e-3, -by->halved) * by->time, motion.mass_damping = b->damping / by->time;
  mps_status status = make_set(g);
  TRY(mps_elastic_create(g->context, g->set, &def, &g->elastic));
  TRY(make_edges(g));
  TRY(make_loads(g));
  if (start) TRY(mps_elastic_start(g->elastic, &motion));
  return status;
}

static mps_status run(body *g, const char *folder) {
  const int64_t steps = g->b->steps[1] << g->by->halved;
  mps_snapshot *snapshot = NULL;
  char path[400];
  mps_status status = build(g, true);
  TRY(mps_elastic_step(g->elastic, g->b->steps[0] << g->by->halved));
  if (g->by->way == ROLLED_BACK) {
    TRY(mps_elastic_snapshot(g->elastic, &snapshot));
    TRY(mps_elastic_step(g->elastic, steps));
    TRY(mps_elastic_rollback(g->elastic, snapshot));
    mps_snapshot_destroy(&snapshot);
  }
  if (g->by->way == RESTORED) {
    snprintf(path, sizeof path, "%s/metamorphic-%d.h5", folder, (int)getpid());
    TRY(mps_elastic_save(g->elastic, path, NULL));
    mps_elastic_destroy(&g->elastic);
    mps_particles_destroy(&g->set);
    TRY(build(g, true));
    TRY(mps_elastic_restore(g->elastic, path, NULL));
    (void)remove(path);
  }
  for (int64_t k = 0; g->by->way != AT_ONCE && k < steps; k++) TRY(mps_elastic_step(g->elastic, 1));
  if (g->by->way == AT_ONCE) TRY(mps_elastic_step(g->elastic, steps));
  return status;
}

static void keep(body *g, result *out) {
  static const char *const names[] = {"displacement", "velocity", "acceleration"};
  const change *by = g->by;
  const double scale[3] = {by->length, by->length / by->time, by->length / (by->time * by->time)};
  mps_view view[3], id;
  for (int f = 0; f < 3; f++)
    if (mps_particles_view(g->set, names[f], &view[f]) != MPS_OK) abort();
  if (mps_particles_view(g->set, "id", &id) != MPS_OK) abort();
  out->count = id.shape[0];
  for (int64_t k = 0; k < out->count; k++) {
    const int64_t i = *mps_view_i64(&id, k, 0);
    double(*to[3])[3] = {&out->position[i], &out->velocity[i], &out->stress[i][0]};
    out->here[i] = true;
    for (int f = 0; f < 3; f++)
      for (int c = 0; c < 2; c++)
        (*to[f])[c] = by->sign[c] * *mps_view_f64(&view[f], k, by->axis[c]) / scale[f];
  }
  for (int k = 0, number = 0; k < EDGES; k++) {
    mps_reaction r;
    if (g->b->kind[k] < 0) continue;
    if (mps_elastic_get_reaction(g->elastic, number++, &r) != MPS_OK) abort();
    for (int c = 0; c < 2; c++)
      out->impulse[k][c] =
          by->sign[c] * r.impulse[by->axis[c]] / (by->mass * by->length / by->time);
  }
}

void run_blocks(const plan *p, const change *by, const char *folder, result *out) {
  blocks b;
  body g = {.b = &b, .by = by};
  mps_context_def def = mps_context_defaults();
  char why[200];
  memset(out, 0, sizeof *out);
  choose(p->seed, &b);
  def.executor = by->threads > 0 ? MPS_CONTEXT_EXECUTOR_THREADS : MPS_CONTEXT_EXECUTOR_SERIAL;
  def.threads = by->threads > 0 ? by->threads : 1;
  if (mps_context_create(&def, &g.context, why, sizeof why) != MPS_OK) abort();
  out->status = run(&g, folder);
  if (out->status != MPS_OK)
    snprintf(out->message, sizeof out->message, "%.190s", mps_context_error(g.context)->message);
  if (out->status == MPS_OK) keep(&g, out);
  mps_elastic_destroy(&g.elastic);
  mps_particles_destroy(&g.set);
  mps_context_destroy(&g.context);
}

/* Each solution has round-off, or the tolerance of conjugate gradients, times the condition of the
 * matrix, some hundreds of elements squared. */
double bound_of_blocks(const plan *p, double left) {
  blocks b;
  (void)left;
  choose(p->seed, &b);
  return 1e3 * 1e-13 * (double)(b.steps[0] + b.steps[1]);
}

void print_blocks(const plan *p) {
  blocks b;
  choose(p->seed, &b);
  printf("  block of %d x %d particles, state %d, solver %d, nu %g, contrast %g, damping %g, edges "
         "%d %d %d %d; steps %d %d\n",
         b.nx, b.ny, (int)b.state, (int)b.solver, b.poisson, b.contrast, b.damping, (int)b.kind[0],
         (int)b.kind[1], (int)b.kind[2], (int)b.kind[3], (int)b.steps[0], (int)b.steps[1]);
}
