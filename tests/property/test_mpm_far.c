/* test_mpm_far.c - particles as far apart as the grid can count: a grain that has been thrown out
 * of an open domain changes nothing for the others, and cells far smaller than the set work.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "mpm_scene.h"
#include "test_fixture.h"

/* A swinging block of 6^dim particles in cells of 0.2 m, with `far` more particles, far away. */
static mpm_scene swing(int32_t geometry, int far, const double (*at)[3]) {
  const int dim = geometry == MPS_MPM_GEOMETRY_SPACE ? 3 : 2;
  const double lo[] = {0.0, 0.0, 0.0}, hi[] = {0.6, 0.6, 0.6};
  mpm_scene s = mpm_scene_begin_in(context, dim, 0.1, 0.0, 0.0, 1e6);
  OK(mps_particles_fill_box(s.particles, lo, hi, NULL));
  for (int k = 0; k < far; k++) OK(mps_particles_append(s.particles, 1, at[k]));
  OK(mps_particles_add_field(s.particles, "velocity", 0));
  const mps_view x = mpm_scene_view(&s, "position");
  EDIT(v, s.particles, "velocity")
    for (int64_t k = 0; k < mps_particles_count(s.particles) - far; k++)
      for (int c = 0; c < dim; c++)
        *mps_edit_f64(&v, k, c) = 2.0 * sin(7.0 * *mps_view_f64(&x, k, (c + 1) % dim));
  USING(mpm, mpm_scene_solve(&s, &given), .geometry = geometry, .cell = 0.2, .dt = 5e-4);
  OK(mps_mpm_step(s.mpm, 100)); /* some of them sort */
  return s;
}

/* The block moves as it does alone, and a far particle stays where it is. */
static void check_far(int32_t geometry, int far, const double (*at)[3]) {
  scoped_mpm_scene alone = swing(geometry, 0, NULL), both = swing(geometry, far, at);
  const mps_view x = mpm_scene_view(&alone, "position"), y = mpm_scene_view(&both, "position");
  const int64_t count = mps_particles_count(alone.particles);
  const int dim = (int)x.shape[1];
  for (int64_t id = 0; id < count + far; id++) {
    const int64_t j = mps_particles_index(both.particles, id);
    for (int c = 0; c < dim; c++) {
      if (id >= count) {
        assert_true(*mps_view_f64(&y, j, c) == at[id - count][c]);
        continue;
      }
      const int64_t i = mps_particles_index(alone.particles, id);
      NEAR(*mps_view_f64(&x, i, c), *mps_view_f64(&y, j, c), 1e-13);
    }
  }
}

TEST(a_far_grain_changes_nothing) {
  static const double one[][3] = {{1e6, 1e6, 1e6}};
  static const double apart[][3] = {{2e8, -2e8, 2e8},
                                    {-2e8, 2e8, 1e8},
                                    {-1.9e8, 2e8, -2e8},
                                    {2e8, -1.9e8, -1e8},
                                    {3.0, 1e8, 0.3}};
  for (int32_t geometry = 0; geometry <= MPS_MPM_GEOMETRY_SPACE; geometry += 2) {
    check_far(geometry, 1, one);
    check_far(geometry, 5, apart);
  }
}

/* Cells a billion times smaller than the particles' spacing are a slip. */
TEST(tiny_cells_are_refused) {
  scoped_mpm_scene s = mpm_scene_begin(context, 0.5, 0.0, 0.0, 1e6);
  mpm_scene_box(&s, 0.0, 0.0, 1.0, 1.0);
  OK(mps_particles_set(s.particles, "density", 0, 1000.0));
  DEF(mpm, def, .cell = 1e-9);
  REFUSES(mps_mpm_create(context, s.particles, s.material, &def, &s.mpm),
          "must be 0.5 to 100 of their spacings");
}

TEST(farther_is_refused) {
  const double x[] = {3e8, 0.0};
  scoped_mpm_scene s = mpm_scene_begin(context, 0.1, 0.0, 0.0, 1e6);
  OK(mps_particles_append(s.particles, 1, x));
  OK(mps_particles_set(s.particles, "density", 0, 1000.0));
  DEF(mpm, def, .cell = 0.2);
  assert_int_equal(mps_mpm_create(context, s.particles, s.material, &def, &s.mpm),
                   MPS_ERROR_ARGUMENT);
}
