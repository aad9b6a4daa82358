/* test_mpm_delta.c - Kronecker's delta at the boundary, Nakamura Figure 5, which is drawn in one
 * dimension: on a wall the fitted shape functions of the nodes off the wall vanish, and those on it
 * have the sum 1. In a corner four nodes are more than a linear function interpolates: there the
 * function of the corner's node is 1 - p^2, p the part of a neighbour's weight along an axis, and
 * no other is above p^2. With mirrors, the default, the functions of a node and its image are equal
 * on the wall, so that a velocity that is odd across the wall vanishes there; none does alone.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "mpm_scene.h"
#include "test_fixture.h"

#include "mpm/base/mpm_solver.h"

enum { CORNER, NODE, BETWEEN, PLACES };
static const char *const place_name[PLACES] = {"corner", "node", "between nodes"};

/* Particles on the wall x = 0: at the corner with y = 0, at a node far from it, and between two. */
static mpm_scene on_walls(double h, int32_t spline, int32_t edge) {
  const double at[PLACES][2] = {{0.0, 0.0}, {0.0, 6.0 * h}, {0.0, 12.3 * h}};
  mpm_scene s = mpm_scene_begin(context, 0.5 * h, 0.0, 0.0, 1e6);
  for (int p = 0; p < PLACES; p++) OK(mps_particles_append(s.particles, 1, at[p]));
  DEF(mpm, def, .cell = h, .spline = spline, .edge = edge, .lower[0] = 0.0, .lower[1] = 0.0);
  mpm_scene_solve(&s, &def);
  const mpsi_boundary_setup boundaries = mpsi_boundary_setup_of(s.mpm);
  OK(mpsi_mpm_update_boundaries(&boundaries, "test", MPS_OK));
  OK(mpsi_mpm_find_near(s.mpm, "test", MPS_OK));
  return s;
}

/* Sums of the shape functions of one particle over the nodes of its stencil. */
typedef struct delta {
  double own;         /* of the node at the particle, 0 where there is none */
  double line;        /* of all nodes on the wall */
  double off, others; /* largest of a node off the wall; of a node that is not its own */
  double odd;         /* largest difference of a node and its image behind the wall */
} delta;

static delta look(const mpsi_stencil *at, const mpsi_shape_values *f, int32_t spline) {
  delta d = {0};
  double layer[2][4] = {{0.0}}; /* by row, of the nodes one cell before and behind the wall */
  for (int j = 0; j <= spline; j++)
    for (int i = 0; i <= spline; i++) {
      const double phi = f->phi[4 * j + i], x = at->s[0][i], y = at->s[1][j];
      if (fabs(x) < 1e-9) d.line += phi;
      if (fabs(x) > 1e-9) d.off = fmax(d.off, fabs(phi));
      if (hypot(x, y) < 1e-9)
        d.own = phi;
      else
        d.others = fmax(d.others, fabs(phi));
      if (fabs(fabs(x) - 1.0) < 1e-9) layer[x < 0.0][j] = phi;
    }
  for (int j = 0; j <= spline; j++) d.odd = fmax(d.odd, fabs(layer[0][j] - layer[1][j]));
  return d;
}

/* The particle at a place, whatever the order of the set. */
static int place_of(const mps_mpm *mpm, int64_t k) {
  const double y = mpm->p.x[1][k] / mpm->grid.cell;
  return y < 1.0 ? CORNER : y < 9.0 ? NODE : BETWEEN;
}

static void find(mps_mpm *mpm, delta out[PLACES]) {
  for (int64_t b = 0; b < mpm->grid.cell_count; b++) {
    const mpsi_transfer work = mpsi_transfer_of(mpm, b, 0);
    mpsi_mpm_find_states(&work);
    for (int64_t k = work.cells->begin; k < work.cells->end; k++) {
      mpsi_stencil at;
      mpsi_shape_values f;
      mpm->kernels->fit(&work, k, &at, &f);
      out[place_of(mpm, k)] = look(&at, &f, mpm->grid.spline);
    }
  }
}

static const double cell[] = {0.02, 0.01, 0.005}; /* m */

TEST(fitted_functions_have_the_delta_property_on_a_wall) {
  for (int32_t spline = 2; spline <= 3; spline++)
    for (size_t g = 0; g < sizeof cell / sizeof *cell; g++) {
      delta d[PLACES];
      scoped_mpm_scene s = on_walls(cell[g], spline, MPS_MPM_EDGE_FIT);
      find(s.mpm, d);
      const double part = spline == 3 ? 1.0 / 5.0 : 1.0 / 7.0, square = part * part;
      for (int p = 0; p < PLACES; p++) {
        print_message("fit, spline %d, h = %g m, %s: on the wall %.15f, off it %.1e, own %.4f\n",
                      spline, cell[g], place_name[p], d[p].line, d[p].off, d[p].own);
        NEAR(d[p].line, 1.0, 1e-12);
        NEAR(d[p].off, p == CORNER ? square : 0.0, 1e-12);
      }
      NEAR(d[CORNER].own, 1.0 - square, 1e-12);
      NEAR(d[CORNER].others, square, 1e-12);
      /* along the wall the supports are full: the weight of a spline at its own node */
      NEAR(d[NODE].own, spline == 3 ? 2.0 / 3.0 : 0.75, 1e-12);
    }
}

TEST(mirrored_functions_are_even_across_a_wall) {
  for (int32_t spline = 2; spline <= 3; spline++)
    for (size_t g = 0; g < sizeof cell / sizeof *cell; g++) {
      delta d[PLACES];
      scoped_mpm_scene s = on_walls(cell[g], spline, MPS_MPM_EDGE_MIRROR);
      find(s.mpm, d);
      for (int p = 0; p < PLACES; p++) {
        print_message("mirrors, spline %d, h = %g m, %s: on the wall %.4f, node less image %.1e\n",
                      spline, cell[g], place_name[p], d[p].line, d[p].odd);
        NEAR(d[p].line, spline == 3 ? 2.0 / 3.0 : 0.75, 1e-12);
        NEAR(d[p].odd, 0.0, 1e-12);
        assert_true(d[p].off > 0.05);
      }
    }
}
