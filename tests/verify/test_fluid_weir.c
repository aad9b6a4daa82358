/* test_fluid_weir.c - a basin runs out over a weir of broad crest, a polyline: its volume falls as
 * critical flow on the crest has it, q = (2/3)^1.5 g^.5 h^1.5 of the head h, dh/dt = -q/L, until
 * the head is less than a spacing: a layer of one particle stays. Of water that stands 1.5 spacings
 * above a crest and is released at once as much passes as on a grid twice as fine: neither crest
 * nor surface lies off its place by a part of a spacing. Of lower heads particles pass too little
 * or nothing: their flow is that of mps_overtopping_find, from the level before the weir, beside
 * what passes on a grid four times as fine.
 *
 * test-verify-fluid_weir HEAD [L0]: the last, of a head (m) and what is counted with a spacing (m),
 * by hand. SPDX-License-Identifier: BSD-3-Clause */
#include "test_fixture.h"

#define L0 0.025   /* m */
#define LENGTH 2.0 /* m, of the basin */
#define HEIGHT 0.2 /* m, of the weir */
#define HEAD 0.1   /* m, at the start */
#define CREST 0.3  /* m, its width */

/* Head of the mean level of what is in the basin. */
static double head_of(mps_particles *water) {
  int64_t inside = 0;
  mps_view x = view_field(water, "position");
  for (int64_t i = 0; i < x.shape[0]; i++) inside += *mps_view_f64(&x, i, 0) < LENGTH;
  return (double)inside * L0 * L0 / LENGTH - HEIGHT;
}

/* Bed, weir and the bed behind, with an open side. */
static void add_walls(mps_fluid *fluid, double length, double height, double crest) {
  const double corner[6][3] = {{0.0},
                               {length},
                               {length, height},
                               {length + crest, height},
                               {length + crest},
                               {length + crest + 0.4}};
  mps_fluid_boundary_def line = mps_fluid_boundary_defaults(), side = line;
  line.kind = side.kind = MPS_BOUNDARY_ROLLER;
  line.corners = corner[0], line.corner_count = 6;
  OK(mps_fluid_add_boundary(fluid, &line, NULL));
  side.normal[0] = 1.0;
  OK(mps_fluid_add_boundary(fluid, &side, NULL));
  side.kind = MPS_BOUNDARY_OPEN;
  side.normal[0] = -1.0, side.point[0] = corner[5][0];
  OK(mps_fluid_add_boundary(fluid, &side, NULL));
}

/* `head` above a weir of `height`. */
static mps_fluid *make_basin(double l0, double length, double height, double head, double crest,
                             mps_particles **water) {
  mps_fluid *fluid = NULL;
  USING(particles, mps_particles_create(context, &given, water), .spacing = l0);
  OK(mps_particles_fill_box(*water, AT(0.0, 0.0), AT(length, height + head), NULL));
  USING(fluid, mps_fluid_create(context, *water, &given, &fluid), .level = height + head);
  add_walls(fluid, length, height, crest);
  return fluid;
}

/* Theory continues from the head that was measured when the first front had left. */
static void a_basin_runs_out_by_the_law_of_the_weir(void **state) {
  const double law = pow(2.0 / 3.0, 1.5) * sqrt(9.81); /* m^.5/s */
  const double time[3] = {2.0, 6.0, 10.0};
  double head[3];
  scoped_particles *water = NULL;
  scoped_fluid *fluid = make_basin(L0, LENGTH, HEIGHT, HEAD, CREST, &water);
  for (int k = 0; k < 3; k++) {
    OK(mps_fluid_run(fluid, time[k], 100000, NULL, NULL));
    head[k] = head_of(water);
  }
  for (int k = 1; k < 3; k++) {
    const double root = 1.0 / sqrt(head[0]) + 0.5 * law * (time[k] - time[0]) / LENGTH;
    const double fell = head[0] - head[k], falls = head[0] - 1.0 / (root * root);
    printf("weir: head %.1f to %.1f mm in %g s, discharge over theory %.3f\n", 1000.0 * head[0],
           1000.0 * head[k], time[k] - time[0], fell / falls);
    NEAR(fell / falls, 1.0, 0.1);
  }
}

/* m2 past the front edge of a crest .8 s after .2 m of water, `head` of it above the crest, is
 * released. */
static double released(double l0, double head) {
  const double depth = 0.2, length = 1.0;
  mps_particles *water = NULL;
  mps_fluid *fluid = make_basin(l0, length, depth - head, head, 0.05, &water);
  int64_t inside = 0;
  OK(mps_fluid_run(fluid, 0.8, 100000, NULL, NULL));
  mps_view x = view_field(water, "position");
  for (int64_t i = 0; i < x.shape[0]; i++) inside += *mps_view_f64(&x, i, 0) < length;
  mps_fluid_destroy(&fluid);
  mps_particles_destroy(&water);
  return length * depth - (double)inside * l0 * l0;
}

static void a_small_head_passes_as_on_a_finer_grid(void **state) {
  const double coarse = released(L0, 1.5 * L0), fine = released(0.5 * L0, 1.5 * L0);
  printf("weir: head 1.5 spacings: %.2e m2 in .8 s, on a grid twice as fine %.2e\n", coarse, fine);
  NEAR(coarse / fine, 1.0, 0.2);
}

/* ---- heads too low for particles ------------------------------------------------------------- */

enum { SAMPLES = 40 };
#define SPAN 0.5 /* s */

/* Counted past the front edge (m2) in SPAN, and by the level two spacings before it, `thin`, with
 * all heads up to `resolved` (m). */
static double overflow(double l0, double head, double resolved, double *thin) {
  const double depth = 0.2, length = 1.0, station = length - 2.0 * l0;
  double t[SAMPLES], heads[SAMPLES];
  scoped_particles *water = NULL;
  scoped_fluid *fluid = make_basin(l0, length, depth - head, head, 0.05, &water);
  mps_overtopping found;
  int64_t inside = 0;
  for (int k = 0; k < SAMPLES; k++) {
    t[k] = SPAN * k / (SAMPLES - 1.0);
    if (k > 0) OK(mps_fluid_run(fluid, t[k], 100000, NULL, NULL));
    OK(mps_fluid_get_levels(fluid, 1, &station, &heads[k]));
    heads[k] -= depth - head;
  }
  USING(overtopping, mps_overtopping_find(context, &given, 0, NULL, &found), .samples = SAMPLES,
        .times = t, .heads = heads, .resolved = resolved, .depth = depth);
  mps_view x = view_field(water, "position");
  for (int64_t i = 0; i < x.shape[0]; i++) inside += *mps_view_f64(&x, i, 0) < length;
  *thin = found.thin;
  return length * depth - (double)inside * l0 * l0;
}

static void a_low_head_passes_by_the_level_before_the_weir(void **state) {
  double thin, none;
  const double counted = overflow(L0, 0.7 * L0, 1.3 * L0, &thin);
  const double fine = overflow(0.25 * L0, 0.7 * L0, 0.5 * L0, &none);
  printf("weir: head .7 spacings: counted %.2e m2 in .5 s; by the level %.2e (%+.1f %%), beside "
         "%.2e counted on a grid four times as fine\n",
         counted, thin, 100.0 * (thin / fine - 1.0), fine);
  NEAR(counted, 0.0, 0.5 * L0 * L0); /* not a particle */
  NEAR(thin / fine, 1.0, 0.25);
  NEAR(none, 0.0, 0.0); /* higher than what is continued there: counted alone */
}

static double asked[2];

static void a_row(void **state) {
  double thin;
  const double counted = overflow(asked[1], asked[0], 1.0, &thin);
  printf("weir: head %g m, l0 %g m: counted %.3e m2 in .5 s, by the level %.3e\n", asked[0],
         asked[1], counted, thin);
}

int main(int count, char **values) {
  if (count > 1) {
    const struct CMUnitTest row[] = {cmocka_unit_test(a_row)};
    asked[0] = strtod(values[1], NULL), asked[1] = count > 2 ? strtod(values[2], NULL) : L0;
    return cmocka_run_group_tests(row, make_context, drop_context);
  }
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(a_low_head_passes_by_the_level_before_the_weir),
      cmocka_unit_test(a_basin_runs_out_by_the_law_of_the_weir),
      cmocka_unit_test(a_small_head_passes_as_on_a_finer_grid),
  };
  return cmocka_run_group_tests(tests, make_context, drop_context);
}
