/* pore_column.h - a saturated column of elastic ground between rollers, as the tests of pore water
 * use it: H = 1 m high, one cell wide, of 2 x 2 (x 2) particles a cell.
 * SPDX-License-Identifier: BSD-3-Clause */
#ifndef MPS_TEST_PORE_COLUMN_H
#define MPS_TEST_PORE_COLUMN_H

#include "mpm_scene.h"

typedef struct pore_column {
  mpm_scene s;
  double h, modulus; /* m; Pa, M' */
  double c_v;        /* m2/s */
} pore_column;

enum { PORE_YOUNG = 1000000 }; /* Pa */

/* Of `cells` cells, which need not be whole, without gravity unless `gravity` (m/s2) says so; 2000
 * kg/m3, porosity 0.4. */
static inline pore_column pore_column_begin(mps_context *context, int32_t geometry, double cells,
                                            double gravity, double damping) {
  const int dim = geometry == MPS_MPM_GEOMETRY_SPACE ? 3 : 2;
  pore_column c = {.h = 1.0 / cells};
  const double lo[] = {0.0, 0.0, 0.0}, hi[] = {c.h, 1.0, c.h};
  c.modulus = PORE_YOUNG * 0.7 / (1.3 * 0.4);
  c.s = mpm_scene_begin_in(context, dim, 1.0 / (2.0 * ceil(cells)), 0.0, 0.0, PORE_YOUNG);
  OK(mps_particles_fill_box(c.s.particles, lo, hi, NULL));
  OK(mps_particles_set(c.s.particles, "density", 0, 2000.0));
  DEF(mpm, def, .geometry = geometry, .cell = c.h);
  for (int d = 0; d < dim; d++) {
    def.lower[d] = 0.0;
    if (d != 1) def.upper[d] = c.h;
  }
  def.gravity[1] = -gravity;
  def.viscous_damping = damping;
  OK(mps_mpm_create(context, c.s.particles, c.s.material, &def, &c.s.mpm));
  return c;
}

/* The particles of the highest row. */
static inline int64_t pore_column_top(pore_column *c, int64_t *ids, int64_t most) {
  const mps_view x = mpm_scene_view(&c->s, "position"), id = mpm_scene_view(&c->s, "id");
  int64_t count = 0;
  for (int64_t k = 0; k < x.shape[0]; k++)
    if (*mps_view_f64(&x, k, 1) > 1.0 - 0.5 * c->h) {
      assert_true(count < most);
      ids[count++] = *mps_view_i64(&id, k, 0);
    }
  return count;
}

/* u/q of a layer drained at depth 0 and impervious at H, `depth` in H; its mean is 1 - U. */
static inline double pore_terzaghi(double depth, double T) {
  double u = 0.0;
  for (int m = 0; m < 400; m++) {
    const double M = (m + 0.5) * 3.14159265358979323846;
    u += 2.0 / M * sin(M * depth) * exp(-M * M * T);
  }
  return u;
}
static inline double pore_terzaghi_degree(double T) {
  double U = 1.0;
  for (int m = 0; m < 400; m++) {
    const double M = (m + 0.5) * 3.14159265358979323846;
    U -= 2.0 / (M * M) * exp(-M * M * T);
  }
  return U;
}

#endif
