/* test_material.c - what holds for every law: plane strain and axisymmetry are the 3D law, the cut
 * into blocks and the instruction set change no bit, threads may share a material.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "material_paths.h"
#include "pthread_executor.h"

#include "core/context/levels.h"
#include "material/material_private.h"

#define COUNT 157 /* not a multiple of a vector's length */
#define LAWS 16
#define MORE 50 /* columns of history that only the small-strain law has */

static mps_status creep(void *user, const mps_material_block *block) {
  (void)user;
  for (int64_t k = 0; k < block->count; k++) {
    const double rate = block->gradient[0][k] + block->gradient[4][k] +
                        (block->gradient[8] ? block->gradient[8][k] : 0.0);
    block->history[0][k] += block->dt * rate;
    for (int c = 0; c < 3; c++) block->stress[c][k] += 1e6 * block->dt * rate;
  }
  return MPS_OK;
}

static mps_material *make_law(int which) {
  static const char *const history[] = {"volume_strain"};
  mps_material *material = NULL;
  mps_material_drucker_prager_def cone = mps_material_drucker_prager_defaults();
  mps_material_mohr_coulomb_def coulomb = mps_material_mohr_coulomb_defaults();
  mps_material_user_def user = mps_material_user_defaults();
  DEF(material_von_mises, mises, .young = cone.young = coulomb.young = 1e7, .yield_stress = 2e4,
      .hardening = 1e6);
  cone.friction = coulomb.friction = 0.6, cone.dilation = 0.2;
  cone.cohesion = coulomb.cohesion = 5e3, cone.tension = which == 3 ? 2e3 : INFINITY;
  DEF(material_newtonian, fluid, .bulk_modulus = 2e6, .viscosity = 3.0, .state = which == 6,
      .no_tension = which == 6);
  user.update = creep, user.wave_modulus = 1e6, user.history = history, user.history_count = 1;
  mps_status status = MPS_OK;
  if (which >= 11) { /* strength that falls with the slip and grows with the rate */
    mises.hardening = 0.0, mises.residual = 0.5, mises.slip = 0.02, mises.band = 0.1;
    coulomb.residual_friction = 0.4, coulomb.residual_cohesion = 1e3;
    coulomb.slip = 0.02, coulomb.band = 0.1;
    mises.rate_factor = coulomb.rate_factor = 0.1;
  }
  if (which == 0) status = mps_material_create_linear_elastic(context, 1e7, 0.3, &material);
  if (which == 1 || which == 11) status = mps_material_create_von_mises(context, &mises, &material);
  if (which >= 14) { /* dilation that ends */
    coulomb.residual_friction = coulomb.residual_cohesion = coulomb.slip = coulomb.band = NAN;
    coulomb.rate_factor = 0.0, coulomb.dilation = 0.2;
    cone.void_ratio = coulomb.void_ratio = 0.6, cone.max_void_ratio = coulomb.max_void_ratio = 0.63;
  }
  if (which == 2 || which == 3 || which == 14)
    status = mps_material_create_drucker_prager(context, &cone, &material);
  if (which == 9) coulomb.tension = 1e3;
  if (which == 4 || which == 9 || which == 12 || which == 15)
    status = mps_material_create_mohr_coulomb(context, &coulomb, &material);
  if (which == 5) status = mps_material_create_neo_hookean(context, 1e7, 0.3, &material);
  if (which == 6 || which == 7) status = mps_material_create_newtonian(context, &fluid, &material);
  DEF(material_small_strain, small, .shear_modulus = 4e6, .reference_strain = 1e-4);
  if (which == 10) status = mps_material_create_small_strain(context, &small, &material);
  DEF(material_cyclic_sand, sand, .young = 1e7, .friction = 0.6, .cohesion = 5e3,
      .relative_density = 0.4);
  if (which == 13) status = mps_material_create_cyclic_sand(context, &sand, &material);
  if (which == 8) status = mps_material_create_user(context, &user, &material);
  OK(status);
  return material;
}

/* A block with its columns. */
typedef struct columns {
  double gradient[9][COUNT], deformation[9][COUNT], stress[6][COUNT], history[COUNT];
  double opening[COUNT], more[MORE][COUNT];
  double volume[COUNT];
  int64_t flags[COUNT];
  double *first[2 + MORE]; /* of the history of the block made last */
} columns;

/* Reproducible values; only in-plane ones, and with `hoop` a rate of zz, unless `space`. */
static void fill(columns *c, bool hoop, bool space) {
  uint64_t seed = 41;
  memset(c, 0, sizeof *c);
  for (int k = 0; k < COUNT; k++) {
    for (int i = 0; i < 9; i++) {
      const bool plane = i == 0 || i == 1 || i == 3 || i == 4 || (i == 8 && hoop);
      const double x = noise(&seed), y = noise(&seed);
      if (space || plane) c->gradient[i][k] = 4.0 * (x - 0.1);
      c->deformation[i][k] = (i % 4 == 0) + (space || plane ? 0.1 * y : 0.0);
    }
    for (int i = 0; i < 6; i++) {
      const double x = noise(&seed);
      if (space || i < 4) c->stress[i][k] = 1e4 * x - (i < 3 ? 1e4 : 0.0);
    }
    c->history[k] = 0.01 * (1.0 + noise(&seed));
    c->opening[k] = k % 3 == 0 ? 0.01 * (1.0 + noise(&seed)) : 0.0;
    c->volume[k] = 1.0 + 0.02 * noise(&seed);
  }
}

/* The block of particles [begin, end). */
static mps_material_block block_of(columns *c, int32_t dim, bool hoop, int begin, int end) {
  mps_material_block block = {.struct_size = sizeof block,
                              .dim = dim,
                              .count = end - begin,
                              .dt = 1e-3,
                              .volume_ratio = c->volume + begin,
                              .flags = c->flags + begin};
  for (int i = 0; i < 9; i++) {
    const bool plane = i == 0 || i == 1 || i == 3 || i == 4 || i == 8;
    if (dim == 3 || (plane && (i != 8 || hoop))) block.gradient[i] = c->gradient[i] + begin;
    if (dim == 3 || plane) block.deformation[i] = c->deformation[i] + begin;
  }
  for (int i = 0; i < (dim == 3 ? 6 : 4); i++) block.stress[i] = c->stress[i] + begin;
  c->first[0] = c->history + begin, c->first[1] = c->opening + begin;
  block.history = c->first, block.history_count = 2 + MORE;
  for (int i = 0; i < MORE; i++) c->first[2 + i] = c->more[i] + begin;
  return block;
}

/* A law that is added to src/material/kinds.h comes into all of these tests by a case in make_law.
 */
TEST(every_law_is_here) {
  bool here[MPSI_LAW_COUNT] = {[MPSI_LAW_CAM_CLAY] = true}; /* test_material_cam_clay.c has it */
  for (int which = 0; which < LAWS; which++) {
    scoped_material *material = make_law(which);
    here[material->type->kind] = true;
    assert_true(mps_material_history_count(material) <=
                MPSI_SMALL_COLUMNS); /* room of by_field.c */
  }
  for (int kind = 0; kind < MPSI_LAW_COUNT; kind++) {
    if (!here[kind])
      print_error("make_law of %s has no '%s' of src/material/kinds.h\n", __FILE__,
                  mpsi_law_types[kind].name);
    assert_true(here[kind]);
  }
}

TEST(plane_and_axisymmetric_are_three_dimensional) {
  for (int which = 0; which < LAWS; which++)
    for (int hoop = 0; hoop < 2; hoop++) {
      scoped_material *material = make_law(which);
      columns flat, space;
      fill(&flat, hoop, false);
      fill(&space, hoop, false);
      int plastic = 0;
      for (int step = 0; step < 5; step++) {
        const mps_material_block a = block_of(&flat, 2, hoop, 0, COUNT);
        const mps_material_block b = block_of(&space, 3, hoop, 0, COUNT);
        OK(mps_material_update(context, material, &a));
        OK(mps_material_update(context, material, &b));
      }
      for (int k = 0; k < COUNT; k++) {
        for (int i = 0; i < 6; i++) {
          NEAR(flat.stress[i][k], space.stress[i][k], 1e-12 * 1e6);
          if (i > 3) NEAR(space.stress[i][k], 0.0, 1e-12 * 1e6);
        }
        for (int i = 0; i < 9; i++) NEAR(flat.deformation[i][k], space.deformation[i][k], 0.0);
        NEAR(flat.volume[k], space.volume[k], 1e-14);
        NEAR(flat.history[k], space.history[k], 1e-13);
        NEAR(flat.opening[k], space.opening[k], which == 10 ? 1e-8 : 1e-14); /* J/m3 */
        for (int i = 0; i < MORE; i++) NEAR(flat.more[i][k], space.more[i][k], 1e-12 * 1e6);
        assert_int_equal(flat.flags[k], space.flags[k]);
        plastic += flat.flags[k] != 0;
      }
      if ((which >= 1 && which <= 4) || which >= 9) assert_true(plastic > COUNT / 4);
    }
}

/* The stress s (xx, yy, zz, xy, zx, yz) turned by the rotation of a step of spin w about `axis`,
 * which is 2 atan(w/2). */
static void turned(const double *s, int axis, double w, double *out) {
  static const int place[3][3] = {{0, 3, 4}, {3, 1, 5}, {4, 5, 2}};
  const double angle = 2.0 * atan(0.5 * w);
  const int a = (axis + 1) % 3, b = (axis + 2) % 3;
  double R[3][3] = {{1.0, 0.0, 0.0}, {0.0, 1.0, 0.0}, {0.0, 0.0, 1.0}};
  R[a][a] = R[b][b] = cos(angle), R[b][a] = sin(angle), R[a][b] = -sin(angle);
  for (int i = 0; i < 3; i++)
    for (int j = i; j < 3; j++) {
      double sum = 0.0;
      for (int k = 0; k < 3; k++)
        for (int l = 0; l < 3; l++) sum += R[i][k] * s[place[k][l]] * R[j][l];
      out[place[i][j]] = sum;
    }
}

/* Of a particle that has been strained and is at rest, without viscous stress or strength by the
 * rate of strain, a rotation turns the stress, and changes neither volume nor
 * plastic strain. The neo-Hookean F is that of (1 + W) F, a rotation to the order of w squared. */
TEST(a_rotation_turns_the_stress) {
  const double w = 1e-3, dt = 1e-3;
  for (int which = 0; which < LAWS; which++)
    for (int axis = 0; axis < 3; axis++) {
      scoped_material *material = make_law(which);
      columns now, before;
      fill(&now, true, true);
      const mps_material_block block = block_of(&now, 3, true, 0, COUNT);
      for (int step = 0; step < 5; step++) OK(mps_material_update(context, material, &block));
      memset(now.gradient, 0, sizeof now.gradient);
      const int a = (axis + 1) % 3, b = (axis + 2) % 3;
      OK(mps_material_update(context, material, &block)); /* at rest */
      for (int k = 0; k < COUNT; k++)
        now.gradient[3 * b + a][k] = w / dt, now.gradient[3 * a + b][k] = -w / dt;
      before = now;
      OK(mps_material_update(context, material, &block));
      const double order = material->type->kind == MPSI_LAW_NEO_HOOKEAN ? 4.0 * w * w : 1e-11;
      for (int k = 0; k < COUNT; k++) {
        double s[6], expected[6];
        for (int i = 0; i < 6; i++) s[i] = before.stress[i][k];
        turned(s, axis, w, expected);
        for (int i = 0; i < 6; i++) NEAR(now.stress[i][k], expected[i], 1e7 * order);
        NEAR(now.volume[k], before.volume[k], order);
        NEAR(now.history[k], before.history[k], 1e-11);
      }
    }
}

TEST(blocks_and_instruction_sets_change_no_bit) {
  static const int32_t levels[] = {MPSI_ALL_LEVELS(MPSI_LEVEL_VALUE, , )};
  for (int which = 0; which < LAWS; which++)
    for (int kind = 0; kind < 3; kind++) {
      scoped_material *material = make_law(which);
      const int32_t dim = kind == 2 ? 3 : 2;
      columns whole, cut;
      fill(&whole, kind > 0, kind == 2);
      const mps_material_block block = block_of(&whole, dim, kind > 0, 0, COUNT);
      OK(mps_material_update(context, material, &block));
      for (size_t level = 0; level < sizeof levels / sizeof *levels; level++) {
        const mpsi_law_table *table = mpsi_laws_select(levels[level]);
        if (!table) continue;
        fill(&cut, kind > 0, kind == 2);
        for (int begin = 0, n = 1; begin < COUNT; begin += n, n = 2 * n + 1) {
          const int end = begin + n < COUNT ? begin + n : COUNT;
          const mps_material_block part = block_of(&cut, dim, kind > 0, begin, end);
          assert_int_equal(table->apply[material->type->kind][kind](&material->law, &part), 0);
        }
        assert_memory_equal(&whole, &cut, offsetof(columns, first));
      }
    }
}

/* Sharing: as many owners and threads as there are. */
typedef struct shared_use {
  mps_material *materials[LAWS];
  columns *columns;
  int32_t failures[64];
} shared_use;

static void use_shared(void *data, int64_t index, int32_t worker) {
  (void)worker;
  shared_use *use = data;
  scoped_material *material = mpsi_material_retain(use->materials[index % LAWS]);
  fill(&use->columns[index], true, true);
  const mps_material_block block = block_of(&use->columns[index], 3, true, 0, COUNT);
  use->failures[index] = mpsi_material_apply(material, &block);
}

TEST(threads_share_a_material) {
  int32_t threads = 4;
  mps_context_def def = pthread_executor_def(&threads);
  mps_context *parallel = NULL;
  shared_use use = {.columns = calloc(4 * LAWS, sizeof(columns))};
  columns alone;
  assert_non_null(use.columns);
  for (int which = 0; which < LAWS; which++) use.materials[which] = make_law(which);
  assert_int_equal(mps_context_create(&def, &parallel, NULL, 0), MPS_OK);
  OK(mps_context_parallel_for(parallel, 4 * LAWS, use_shared, &use));
  for (int k = 0; k < 4 * LAWS; k++) {
    assert_int_equal(use.failures[k], 0);
    fill(&alone, true, true);
    const mps_material_block block = block_of(&alone, 3, true, 0, COUNT);
    OK(mps_material_update(context, use.materials[k % LAWS], &block));
    assert_memory_equal(&alone, &use.columns[k], offsetof(columns, first));
  }
  for (int which = 0; which < LAWS; which++) mps_material_destroy(&use.materials[which]);
  mps_context_destroy(&parallel);
  free(use.columns);
}
