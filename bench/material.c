/* material.c - benchmark of the constitutive laws: ns per particle of one step on blocks that stay
 * in the first cache, as a solver's do, with about half the particles yielding. The laws are timed
 * in turn, in rounds, in one process; minima are compared, so that the differences from linear
 * elastic hold when the machine's speed drifts. SPDX-License-Identifier: BSD-3-Clause */
#include <mps/soil.h>
#include <mps/experimental/material_point.h>

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <time.h>

#define ROUNDS 7
#define BLOCK 136
#define REPEATS 4000
#define LAWS 8

static double seconds(void) {
  struct timespec now;
  clock_gettime(CLOCK_MONOTONIC, &now);
  return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
}

static void check(mps_context *context, mps_status status) {
  if (status == MPS_OK) return;
  fprintf(stderr, "bench-material: %s\n", mps_context_error(context)->message);
  exit(1);
}

static mps_material *make(mps_context *context, int law) {
  mps_material *material = NULL;
  mps_material_von_mises_def mises = mps_material_von_mises_defaults();
  mps_material_drucker_prager_def cone = mps_material_drucker_prager_defaults();
  mps_material_mohr_coulomb_def pyramid = mps_material_mohr_coulomb_defaults();
  mps_material_newtonian_def fluid = mps_material_newtonian_defaults();
  mises.young = cone.young = pyramid.young = 1e6;
  mises.yield_stress = 1e3, mises.hardening = 1e5;
  cone.friction = pyramid.friction = 0.6, cone.cohesion = pyramid.cohesion = 100.0;
  mps_material_von_mises_def soft = mises;
  soft.hardening = 0.0, soft.residual = 0.5, soft.slip = soft.band = 1.0;
  mps_material_cam_clay_def clay = mps_material_cam_clay_defaults();
  clay.critical_slope = 0.92, clay.compression = 0.205, clay.swelling = 0.044;
  clay.void_ratio = 1.4, clay.preconsolidation = 1e3;
  fluid.bulk_modulus = 1e6, fluid.viscosity = 1.0;
  if (law == 0) check(context, mps_material_create_linear_elastic(context, 1e6, 0.3, &material));
  if (law == 1) check(context, mps_material_create_von_mises(context, &mises, &material));
  if (law == 2) check(context, mps_material_create_drucker_prager(context, &cone, &material));
  if (law == 3) check(context, mps_material_create_mohr_coulomb(context, &pyramid, &material));
  if (law == 4) check(context, mps_material_create_neo_hookean(context, 1e6, 0.3, &material));
  if (law == 5) check(context, mps_material_create_newtonian(context, &fluid, &material));
  if (law == 6) check(context, mps_material_create_von_mises(context, &soft, &material));
  if (law == 7) check(context, mps_material_create_cam_clay(context, &clay, &material));
  return material;
}

enum { HISTORY = 4 };

/* Columns of a block; the gradient changes sign each step, so that the state stays bounded. */
typedef struct columns {
  double gradient[2][9][BLOCK], deformation[9][BLOCK], stress[6][BLOCK], history[HISTORY][BLOCK];
  double volume[BLOCK];
  int64_t flags[BLOCK];
} columns;

static void fill(const mps_material *material, columns *c) {
  srand(1);
  for (int k = 0; k < BLOCK; k++) {
    for (int i = 0; i < 9; i++) {
      c->gradient[0][i][k] = rand() / (double)RAND_MAX - 0.5;
      c->gradient[1][i][k] = -c->gradient[0][i][k];
      c->deformation[i][k] = i % 4 == 0;
    }
    for (int i = 0; i < 6; i++) c->stress[i][k] = i < 3 ? -1e3 : 0.0;
    for (int i = 0; i < HISTORY; i++) c->history[i][k] = mps_material_history_initial(material, i);
    c->volume[k] = 1.0;
  }
}

/* ns per particle-step; *plastic receives the share of particles that yield. */
static double run(mps_context *context, const mps_material *material, int32_t dim, columns *c,
                  double *plastic) {
  mps_material_block block[2];
  double *history[HISTORY];
  for (int i = 0; i < HISTORY; i++) history[i] = c->history[i];
  for (int turn = 0; turn < 2; turn++) {
    block[turn] = (mps_material_block){.struct_size = sizeof block[turn],
                                       .dim = dim,
                                       .count = BLOCK,
                                       .dt = 2e-3,
                                       .volume_ratio = c->volume,
                                       .flags = c->flags};
    for (int i = 0; i < 9; i++) {
      const int plane = i == 0 || i == 1 || i == 3 || i == 4;
      if (dim == 3 || plane) block[turn].gradient[i] = c->gradient[turn][i];
      block[turn].deformation[i] = c->deformation[i];
    }
    for (int i = 0; i < 6; i++) block[turn].stress[i] = c->stress[i];
    block[turn].history = history, block[turn].history_count = HISTORY;
  }
  fill(material, c);
  const double start = seconds();
  for (int step = 0; step < REPEATS; step++)
    check(context, mps_material_update(context, material, &block[step % 2]));
  const double spent = seconds() - start;
  int count = 0;
  for (int k = 0; k < BLOCK; k++) count += (c->flags[k] & MPS_MATERIAL_FLAG_PLASTIC) != 0;
  *plastic = (double)count / BLOCK;
  return 1e9 * spent / ((double)BLOCK * REPEATS);
}

int main(void) {
  mps_context *context = NULL;
  mps_context_def def = mps_context_defaults();
  def.executor = MPS_CONTEXT_EXECUTOR_SERIAL;
  if (mps_context_create(&def, &context, NULL, 0) != MPS_OK) return 1;
  static columns c;
  printf("%-16s %22s %22s\n", "ns/particle", "plane strain (yield)", "3D (yield)");
  double best[LAWS][2], plastic[LAWS][2];
  for (int round = 0; round < ROUNDS; round++)
    for (int law = 0; law < LAWS; law++) {
      mps_material *material = make(context, law);
      for (int space = 0; space < 2; space++) {
        const double ns = run(context, material, 2 + space, &c, &plastic[law][space]);
        if (round == 0 || ns < best[law][space]) best[law][space] = ns;
      }
      if (round == ROUNDS - 1)
        printf("%-16s %14.2f (%3.0f %%) %14.2f (%3.0f %%)\n", mps_material_name(material),
               best[law][0], 100.0 * plastic[law][0], best[law][1], 100.0 * plastic[law][1]);
      mps_material_destroy(&material);
    }
  mps_context_destroy(&context);
  return 0;
}
