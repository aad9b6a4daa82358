/* test_mpm_filter_cycles.c - sand that is loaded to and fro hundreds of times: the filter of its
 * mean stress changes volume, opening and mean stress by bounded parts a cycle.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "mpm_scene.h"
#include "test_fixture.h"

#define DEGREE 0.017453292519943295

enum { LOOKS = 3, CYCLES = 100 }; /* cycles between two looks */

typedef struct look {
  double volume, height, opening, pressure; /* m2, m, 1, Pa: sum, twice the mean, means */
} look;

static look look_at(mpm_scene *s) {
  mps_view x = mpm_scene_view(s, "position"), V = mpm_scene_view(s, "volume");
  mps_view stress = mpm_scene_view(s, "stress"), gap = mpm_scene_view(s, "opening");
  look out = {0.0, 0.0, 0.0, 0.0};
  const double n = (double)x.shape[0];
  for (int64_t k = 0; k < x.shape[0]; k++) {
    out.volume += *mps_view_f64(&V, k, 0);
    out.height += 2.0 * *mps_view_f64(&x, k, 1) / n;
    out.opening += *mps_view_f64(&gap, k, 0) / n;
    for (int c = 0; c < 3; c++) out.pressure -= *mps_view_f64(&stress, k, c) / (3.0 * n);
  }
  return out;
}

/* A bed of sand between rollers, pushed along its floor by 0.3 of its weight, to and fro twice a
 * second. */
static void shake(int32_t spline, look *looks) {
  const double h = 0.1, width = 0.8, depth = 0.4;
  scoped_mpm_scene s = mpm_scene_begin(context, 0.5 * h, 0.0, 0.0, 1e6);
  mpm_scene_box(&s, 0.0, 0.0, width, depth);
  mps_material_destroy(&s.material);
  DEF(material_mohr_coulomb, law, .young = 1e6, .friction = 30.0 * DEGREE, .dilation = 0.0);
  OK(mps_material_create_mohr_coulomb(context, &law, &s.material));
  mpm_scene_weigh(&s, 9810.0, 0.5, depth);
  USING(mpm, mpm_scene_solve(&s, &given), .cell = h, .spline = spline,
        .lower[0] = given.lower[1] = 0.0, .upper[0] = width, .gravity[1] = -9.81);
  mpm_scene_side(&s, MPS_SIDE_Y_LOWER, MPS_BOUNDARY_HELD, 0.0);
  MAKE(signal, sine, create_sine, context, MPS_SIGNAL_QUANTITY_VALUE, 2.0, 1.0, 0.0);
  mps_view id = mpm_scene_view(&s, "id"), m = mpm_scene_view(&s, "mass");
  int64_t *ids = malloc((size_t)id.shape[0] * sizeof *ids);
  double *mass = malloc((size_t)id.shape[0] * sizeof *mass);
  assert_non_null(ids), assert_non_null(mass);
  for (int64_t k = 0; k < id.shape[0]; k++)
    ids[k] = *mps_view_i64(&id, k, 0), mass[k] = *mps_view_f64(&m, k, 0);
  const double along[2] = {0.3 * 9.81, 0.0};
  const mps_mpm_load_def load = mpm_scene_load_def(id.shape[0], ids, mass, along, 2, sine);
  OK(mps_mpm_add_load(s.mpm, &load, NULL));
  for (int k = 0; k <= LOOKS; k++) {
    if (k > 0) OK(mps_mpm_run(s.mpm, 0.5 * CYCLES * k, INT64_MAX, NULL, NULL));
    looks[k] = look_at(&s);
    print_message("spline %d, cycle %d: V %.6f m2, height %.5f m, opening %.3g, p %.1f Pa\n",
                  (int)spline, CYCLES * k, looks[k].volume, looks[k].height, looks[k].opening,
                  looks[k].pressure);
  }
  free(ids), free(mass);
}

/* Two hundred more cycles take 0.21 and 0.11 % of the height, as the filter's slope is that of
 * ground at rest, not of shaken ground, and add 0.5 and 0.7 % to the mean stress. */
TEST(cycles_leave_no_volume) {
  for (int32_t spline = 2; spline <= 3; spline++) {
    look looks[LOOKS + 1];
    shake(spline, looks);
    const look *first = &looks[1], *last = &looks[LOOKS];
    NEAR(last->height / first->height, 1.0, 1.0 / 400.0);
    NEAR(last->volume / looks[0].volume, 1.0, 5e-3);
    NEAR(last->pressure / first->pressure, 1.0, 0.01);
    NEAR(last->opening, 0.0, 1e-4);
  }
}
