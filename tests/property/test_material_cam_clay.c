/* test_material_cam_clay.c - modified Cam-Clay from any state: the return satisfies its equations,
 * gaps open and close without a loss of volume, closed cycles of elastic strain close, a rotation
 * rotates, blocks and geometries agree.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "clay_points.h"

#include "material/material_private.h"

static double between(uint64_t *seed, double low, double high) {
  return low + (high - low) * 0.5 * (noise(seed) + 1.0);
}

/* Evenly in the logarithm. */
static double scaled(uint64_t *seed, double low, double high) {
  return exp(between(seed, log(low), log(high)));
}

static clay random_clay(uint64_t *seed) {
  clay c = {.M = between(seed, 0.5, 1.7),
            .lambda = scaled(seed, 0.03, 0.4),
            .nu = between(seed, 0.05, 0.42),
            .e0 = scaled(seed, 0.3, 4.0),
            .p0 = scaled(seed, 1e3, 1e6),
            .R = 1.0};
  c.kappa = c.lambda * between(seed, 0.04, 0.6);
  return c;
}

/* A stress of mean pressure p and a random deviator of norm q. */
static void set_stress(mps_material_point *x, uint64_t *seed, double p, double q) {
  double mean = 0.0, *s = x->stress;
  for (int c = 0; c < 6; c++) s[c] = noise(seed);
  for (int c = 0; c < 3; c++) mean += s[c] / 3.0;
  for (int c = 0; c < 3; c++) s[c] -= mean;
  const double scale = q / (ROOT3 * root_j2(s));
  for (int c = 0; c < 6; c++) s[c] = scale * s[c] - (c < 3 ? p : 0.0);
}

static double yield(const clay *c, double p, double q, double pc) {
  return (q * q / (c->M * c->M) + p * (p - pc)) / (pc * pc);
}

static void check_plastic(const clay *c, const mps_material_point *old,
                          const mps_material_point *now) {
  const double p0 = clay_p(old), p1 = clay_p(now), q = clay_q(now), pc = now->history[CLAY_PC];
  const double v0 = 1.0 + old->history[CLAY_VOID], v1 = 1.0 + now->history[CLAY_VOID];
  const double loss = v0 - v1 - c->kappa * log(p1 / p0); /* plastic change of v */
  NEAR(yield(c, p1, q, pc), 0.0, 1e-9);
  NEAR(log(pc / old->history[CLAY_PC]), loss / (c->lambda - c->kappa), 1e-9);
  const double shear = now->history[CLAY_STRAIN] - old->history[CLAY_STRAIN];
  const double volume = loss / (0.5 * (v0 + v1)), m2 = c->M * c->M;
  assert_true(shear >= 0.0);
  const double left = shear * (2.0 * p1 - pc), right = volume * 2.0 * q / m2; /* normality */
  NEAR(left / pc, right / pc, 1e-9 + 1e-7 * fabs(right / pc));
}

TEST(any_state_returns_to_the_surface) {
  uint64_t seed = 7;
  int64_t plastic = 0, apart = 0, elastic = 0;
  for (int draw = 0; draw < 1000; draw++) {
    const clay c = random_clay(&seed);
    scoped_material *m = make_clay(&c);
    for (int i = 0; i < 100; i++) {
      mps_material_point x = point_under(m, 0.0), old;
      const double pc = x.history[CLAY_PC], p = pc * scaled(&seed, 2e-3, 1.0);
      const double most = c.M * sqrt(fmax(0.0, p * (pc - p)));
      const double inside = noise(&seed) > 0.0 ? 1.0 : fabs(noise(&seed));
      set_stress(&x, &seed, p, inside * most);
      double L[9], size = 0.0;
      for (int k = 0; k < 9; k++) L[k] = noise(&seed), size += L[k] * L[k];
      const double length = scaled(&seed, 1e-6, 1e-2) / sqrt(size);
      for (int k = 0; k < 9; k++) L[k] *= length;
      old = x;
      OK(mps_material_point_drive(context, m, &x, L, 1.0, 1));
      const double p1 = clay_p(&x);
      assert_true(yield(&c, p1, clay_q(&x), x.history[CLAY_PC]) < 1e-9);
      if (x.flags & MPS_MATERIAL_FLAG_APEX) {
        apart++;
        assert_true(fabs(p1 / (1e-3 * pc) - 1.0) < 1e-9 && x.history[CLAY_GAP] >= 0.0);
      } else if (x.flags & MPS_MATERIAL_FLAG_PLASTIC) {
        plastic++;
        check_plastic(&c, &old, &x);
      } else {
        elastic++;
        NEAR(log(p1 / clay_p(&old)), (old.history[CLAY_VOID] - x.history[CLAY_VOID]) / c.kappa,
             1e-9);
        assert_true(x.history[CLAY_PC] == pc);
      }
    }
  }
  print_message("%lld plastic, %lld elastic, %lld apart\n", (long long)plastic, (long long)elastic,
                (long long)apart);
  assert_true(plastic > 25000 && elastic > 10000 && apart > 100);
}

/* Torn by 5 % and pressed together again: the same pressure, void ratio and volume. */
TEST(a_gap_closes_where_it_opened) {
  scoped_material *m = make_clay(&clays[1]);
  mps_material_point x = point_under(m, -50e3);
  const mps_material_point first = x;
  const double pull = 0.25 / 3.0;
  const double out[9] = {pull, 0, 0, 0, pull, 0, 0, 0, pull};
  const double in[9] = {-pull, 0, 0, 0, -pull, 0, 0, 0, -pull};
  OK(mps_material_point_drive(context, m, &x, out, 1.0, 100));
  assert_true(x.flags & MPS_MATERIAL_FLAG_APEX);
  NEAR(clay_p(&x), 200.0, 1e-9); /* pc/1000 */
  assert_true(x.history[CLAY_GAP] > 0.15);
  NEAR(log(x.volume_ratio) + x.history[CLAY_GAP], 0.25, 1e-7);
  OK(mps_material_point_drive(context, m, &x, in, 1.0, 130));
  NEAR(x.history[CLAY_GAP], 0.0, 0.0);
  NEAR(clay_p(&x) / 50e3, 1.0, 1e-4);
  NEAR(x.history[CLAY_VOID], first.history[CLAY_VOID], 1e-6);
  NEAR(x.volume_ratio, 1.0, 1e-6);
}

/* A hundred thousand elastic cycles of a hundredth leave pressure and void ratio. */
TEST(elastic_cycles_do_not_drift) {
  scoped_material *m = make_clay(&clays[1]);
  mps_material_point x = point_under(m, -50e3);
  for (int i = 0; i < 100000; i++) {
    const double e = (i % 2 ? -1.0 : 1.0) * 0.003;
    const double L[9] = {e, 0, 0, 0, e, 0, 0, 0, e};
    OK(mps_material_point_drive(context, m, &x, L, 1.0, 1));
  }
  NEAR(clay_p(&x) / 50e3, 1.0, 1e-6);
  NEAR(x.history[CLAY_VOID], 0.8, 1e-8);
}

TEST(a_rotation_rotates_the_stress) {
  uint64_t seed = 3;
  scoped_material *m = make_clay(&clays[0]);
  mps_material_point x = point_under(m, 0.0);
  set_stress(&x, &seed, 60e3, 30e3);
  const mps_material_point first = x;
  const double w = PI, L[9] = {0, w, 0, -w, 0, 0, 0, 0, 0};
  OK(mps_material_point_drive(context, m, &x, L, 1.0, 1000)); /* by 180 degrees */
  for (int c = 0; c < 4; c++) NEAR(x.stress[c] / 60e3, first.stress[c] / 60e3, 1e-4);
  for (int c = 4; c < 6; c++) NEAR(x.stress[c] / 60e3, -first.stress[c] / 60e3, 1e-4);
  NEAR(clay_p(&x) / 60e3, 1.0, 1e-10);
}

/* Plane strain and axisymmetry are space without their missing components. */
TEST(geometries_agree) {
  enum { N = 70 };
  static double L[9][N], s[3][6][N], h[3][4][N], V[3][N];
  static int64_t flags[3][N];
  uint64_t seed = 11;
  scoped_material *m = make_clay(&clays[0]);
  for (int k = 0; k < N; k++) {
    for (int c = 0; c < 9; c++)
      L[c][k] = c == 0 || c == 1 || c == 3 || c == 4 ? 5e-3 * noise(&seed) : 0.0;
    for (int g = 0; g < 3; g++) {
      for (int c = 0; c < 6; c++) s[g][c][k] = c < 3 ? -60e3 : 0.0;
      for (int c = 0; c < 4; c++) h[g][c][k] = mps_material_history_initial(m, c);
      V[g][k] = 1.0;
    }
  }
  for (int g = 0; g < 3; g++) {
    WITH_DEFAULTS(mps_material_block, block, .dim = g == 2 ? 3 : 2, .count = N, .dt = 1.0);
    double *history[4];
    for (int c = 0; c < 9; c++)
      if (g == 2 || c == 0 || c == 1 || c == 3 || c == 4 || (g == 1 && c == 8))
        block.gradient[c] = L[c];
    for (int c = 0; c < 2 * block.dim; c++) block.stress[c] = s[g][c];
    for (int c = 0; c < 4; c++) history[c] = h[g][c];
    block.history = history;
    block.history_count = 4;
    block.volume_ratio = V[g];
    block.flags = flags[g];
    for (int step = 0; step < 5; step++) OK(mps_material_update(context, m, &block));
  }
  for (int g = 1; g < 3; g++)
    for (int k = 0; k < N; k++) {
      for (int c = 0; c < 4; c++) NEAR(s[g][c][k] / 60e3, s[0][c][k] / 60e3, 1e-12);
      for (int c = 0; c < 4; c++) NEAR(h[g][c][k], h[0][c][k], 1e-9 * fabs(h[0][c][k]));
      assert_int_equal(flags[g][k], flags[0][k]);
    }
}

/* Strains far beyond a solver's leave numbers, and absurd ones a NaN that a solver reports. */
TEST(large_strains_are_divided) {
  for (int k = 0; k < 2; k++) {
    scoped_material *m = make_clay(&clays[k]);
    mps_material_point one = point_under(m, -clays[k].p0), many = one;
    const double L[9] = {0.1, 0.3, 0, 0, 0.1, 0, 0, 0, -0.2};
    OK(mps_material_point_drive(context, m, &one, L, 1.0, 1));
    OK(mps_material_point_drive(context, m, &many, L, 1.0, 1000));
    NEAR(clay_p(&one) / clay_p(&many), 1.0, 0.05);
    const double absurd[9] = {1e30, 0, 0, 0, 0, 0, 0, 0, 0};
    assert_int_equal(mps_material_point_drive(context, m, &one, absurd, 1.0, 1), MPS_ERROR_NUMERIC);
  }
}

/* A block is stepped in vectors, a particle alone by cam_clay.c: elastic, yielding, at the apex,
 * with open gaps, in steps that are divided. The same to rounding, and no bit depends on the block.
 */
enum { BLOCK = 157 };

typedef struct clay_block {
  double gradient[9][BLOCK], stress[6][BLOCK], history[4][BLOCK], volume[BLOCK];
  int64_t flags[BLOCK];
} clay_block;

static void fill_block(const mps_material *m, const clay *c, clay_block *b) {
  uint64_t seed = 19;
  for (int k = 0; k < BLOCK; k++) {
    mps_material_point x = point_under(m, 0.0);
    const double pc = x.history[CLAY_PC], p = pc * scaled(&seed, 1e-3, 1.0);
    set_stress(&x, &seed, p, c->M * sqrt(fmax(0.0, p * (pc - p))));
    const double length = scaled(&seed, 1e-6, k % 10 == 0 ? 3e-2 : 3e-3);
    for (int i = 0; i < 9; i++) b->gradient[i][k] = length * noise(&seed);
    for (int i = 0; i < 6; i++) b->stress[i][k] = x.stress[i];
    for (int i = 0; i < 4; i++) b->history[i][k] = x.history[i];
    if (k % 9 == 0) b->history[CLAY_GAP][k] = 1e-4;
    b->volume[k] = 1.0;
    b->flags[k] = 0;
  }
}

static mps_status step_block(const mps_material *m, int kind, clay_block *b, int begin, int end) {
  double *history[4];
  mps_material_block block = {.struct_size = sizeof block,
                              .dim = kind == 2 ? 3 : 2,
                              .count = end - begin,
                              .dt = 1.0,
                              .volume_ratio = b->volume + begin,
                              .history = history,
                              .history_count = 4,
                              .flags = b->flags + begin};
  for (int i = 0; i < 9; i++)
    if (kind == 2 || i == 0 || i == 1 || i == 3 || i == 4 || (kind == 1 && i == 8))
      block.gradient[i] = b->gradient[i] + begin;
  for (int i = 0; i < (kind == 2 ? 6 : 4); i++) block.stress[i] = b->stress[i] + begin;
  for (int i = 0; i < 4; i++) history[i] = b->history[i] + begin;
  return mps_material_update(context, m, &block);
}

/* Particle k by the step of one particle, in space. */
static void compare_alone(const mps_material *m, const clay_block *first, const clay_block *now,
                          int k) {
  static const int row[6] = {0, 4, 8, 1, 6, 5}, other[6] = {0, 4, 8, 3, 2, 7};
  double d[6], s[6];
  mpsi_clay x = {.strain = first->history[CLAY_STRAIN][k],
                 .pc = first->history[CLAY_PC][k],
                 .void_ratio = first->history[CLAY_VOID][k],
                 .gap = first->history[CLAY_GAP][k],
                 .volume = first->volume[k]};
  for (int i = 0; i < 6; i++) {
    d[i] = 0.5 * (first->gradient[row[i]][k] + first->gradient[other[i]][k]);
    s[i] = first->stress[i][k];
  }
  const double pc = x.pc;
  const int64_t flags = mpsi_cam_clay_step(&m->law, 3, d, s, &x);
  for (int i = 0; i < 6; i++) NEAR(now->stress[i][k] / pc, s[i] / pc, 1e-12);
  NEAR(now->history[CLAY_PC][k] / x.pc, 1.0, 1e-12);
  NEAR(now->history[CLAY_VOID][k], x.void_ratio, 1e-13);
  NEAR(now->history[CLAY_STRAIN][k], x.strain, 1e-12);
  NEAR(now->history[CLAY_GAP][k], x.gap, 1e-13);
  NEAR(now->volume[k], x.volume, 1e-13);
  assert_int_equal(now->flags[k], flags);
}

TEST(blocks_agree_with_single_particles) {
  uint64_t seed = 3;
  int64_t yields = 0, apart = 0, elastic = 0;
  for (int draw = 0; draw < 60; draw++) {
    const clay c = random_clay(&seed);
    mps_material_cam_clay_def def = clay_def(&c);
    clay_block first, whole, cut;
    def.lode = draw % 2;
    if (draw % 3 == 0) def.shear_modulus = 20.0 * c.p0;
    MAKE(material, m, create_cam_clay, context, &def);
    for (int kind = 0; kind < 3; kind++) {
      fill_block(m, &c, &whole), fill_block(m, &c, &cut);
      OK(step_block(m, kind, &whole, 0, BLOCK));
      for (int begin = 0, n = 1, end; begin < BLOCK; begin = end, n = 2 * n + 1) {
        end = begin + n < BLOCK ? begin + n : BLOCK;
        OK(step_block(m, kind, &cut, begin, end));
      }
      assert_memory_equal(&whole, &cut, sizeof whole);
    }
    /* symmetric gradients: the step alone knows no spin */
    fill_block(m, &c, &first);
    for (int k = 0; k < BLOCK; k++)
      for (int i = 0; i < 3; i++)
        for (int j = 0; j < i; j++) first.gradient[3 * i + j][k] = first.gradient[3 * j + i][k];
    whole = first;
    OK(step_block(m, 2, &whole, 0, BLOCK));
    for (int k = 0; k < BLOCK; k++) {
      compare_alone(m, &first, &whole, k);
      const bool parted = (whole.flags[k] & MPS_MATERIAL_FLAG_APEX) != 0;
      apart += parted, elastic += whole.flags[k] == 0;
      yields += !parted && whole.flags[k] != 0;
    }
  }
  print_message("%d yield, %d elastic, %d apart\n", (int)yields, (int)elastic, (int)apart);
  assert_true(yields > 2000 && apart > 300 && elastic > 1000);
}
