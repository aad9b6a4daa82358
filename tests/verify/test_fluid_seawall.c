/* test_fluid_seawall.c - a solitary wave breaks before a seawall, passes it and runs on behind:
 * levels and depths at six gauges against the test of Hsiao and Lin (2010), Coastal Engineering 57,
 * 1-18, type 1: .07 m high in .2 m of water, a beach of 1:20 whose water is .02 m deep at the toe
 * of a wall of 1:3.95, crest .056 m above the water at rest. Places and times are theirs, from the
 * wave's crest at the first gauge on; their origin lies 3 m behind that of the flume.
 *
 * test-verify-fluid_seawall L0 [FILE [product]]: with the spacing L0 (m) in place of .02 m; FILE
 * receives the readings in time, as CSV. `product`: particles start at products of L0 in place of
 * sums, which differ by roundings (scripts/draw-seawall).
 * SPDX-License-Identifier: BSD-3-Clause */
#include "test_fixture.h"

#include "goring.h"

#define DEPTH 0.2   /* m */
#define HEIGHT 0.07 /* m, of the wave */
#define PISTON 2.9  /* m, its place at rest */
#define SHORE 11.0  /* m, where the beach without the wall leaves the water at rest */
#define SPAN 4.2    /* s, after the crest at the first gauge */
#define SAMPLE 0.02 /* s */

enum { CORNERS = 7, GAUGES = 7, ROOM = 600 };

/* Bed, beach, face, crest, rear of the wall, beach. */
static const double corner[CORNERS][3] = {
    {1.0, 0.0, 0.0},      {7.0, 0.0, 0.0},        {10.6, 0.18, 0.0}, {10.9, 0.256, 0.0},
    {10.948, 0.256, 0.0}, {11.045, 0.20225, 0.0}, {14.0, 0.35, 0.0}};

/* The readings of the test (docs/references.md): the highest; the one before the wave comes, which
 * is not 0 and is taken off (at 10 none was read); when the level first has half of that rise. On
 * land they are depths. */
typedef struct gauge {
  const char *name;
  double x, before, highest, arrival; /* m, m, m, s */
  bool land;
} gauge;

static const gauge gauges[GAUGES] = {
    {"1", 5.9, 0.0002, 0.0713, NAN, false},     {"3", 7.6, 0.0045, 0.0706, 0.82, false},
    {"10", 9.644, 0.0, 0.0864, 2.25, false},    {"22", 10.462, 0.0044, 0.0531, 2.74, false},
    {"28", 10.732, 0.0044, 0.0584, 3.00, true}, {"37", 11.005, 0.0042, 0.0281, 3.15, true},
    {"40", 11.12, 0.0040, 0.0288, 3.31, true},
};

static double bed_at(double x) {
  int k = 0;
  while (k + 2 < CORNERS && corner[k + 1][0] < x) k++;
  const double *p = corner[k], *q = corner[k + 1];
  return p[1] + (q[1] - p[1]) * (x - p[0]) / (q[0] - p[0]);
}

/* Water up to DEPTH from the piston to the wall. */
static void fill(mps_particles *water, double l0, bool product) {
  double x = PISTON + 0.5 * l0;
  for (int i = 0; x < SHORE; i++) {
    double y = 0.5 * l0;
    for (int j = 0; y < DEPTH; j++) {
      const double at[2] = {x, y};
      if (y > bed_at(x) + 0.45 * l0) OK(mps_particles_append(water, 1, at));
      y = product ? (j + 1.5) * l0 : y + l0;
    }
    x = product ? PISTON + (i + 1.5) * l0 : x + l0;
  }
}

static tank make_flume(double l0, bool product, mps_signal *piston) {
  tank t = {NULL, NULL};
  USING(particles, mps_particles_create(context, &given, &t.water), .spacing = l0);
  fill(t.water, l0, product);
  USING(fluid, mps_fluid_create(context, t.water, &given, &t.fluid), .level = DEPTH);
  USING(fluid_boundary, mps_fluid_add_boundary(t.fluid, &given, NULL), .kind = MPS_BOUNDARY_ROLLER,
        .corners = corner[0], .corner_count = CORNERS);
  tank_wall(t.fluid, PISTON, 0.0, 1.0, 0.0, piston);
  return t;
}

typedef struct record {
  int count;
  double t[ROOM],
      level[ROOM][GAUGES]; /* s; m, above rest or above the bed, 0 where there is none */
} record;

/* From the crest at the first gauge, which `crest` has the time of, over SPAN. */
static void run(tank *t, double crest, record *r) {
  double station[GAUGES], level[GAUGES];
  for (int g = 0; g < GAUGES; g++) station[g] = gauges[g].x;
  r->count = 0;
  for (double end = SAMPLE; end < crest + SPAN && r->count < ROOM; end += SAMPLE) {
    OK(mps_fluid_run(t->fluid, end, 100000, NULL, NULL));
    OK(mps_fluid_get_levels(t->fluid, GAUGES, station, level));
    r->t[r->count] = end;
    for (int g = 0; g < GAUGES; g++) {
      const double zero = gauges[g].land ? bed_at(station[g]) : DEPTH;
      r->level[r->count][g] = isnan(level[g]) ? 0.0 : level[g] - zero;
    }
    r->count++;
  }
}

/* The highest reading from `after` on, and its time. */
static double highest(const record *r, int g, double after, double *time) {
  double most = -INFINITY;
  for (int k = 0; k < r->count; k++)
    if (r->t[k] >= after && r->level[k][g] > most) most = r->level[k][g], *time = r->t[k];
  return most;
}

/* When a reading first reaches a level, from `after` on. NAN: never. */
static double arrival(const record *r, int g, double after, double level) {
  for (int k = 1; k < r->count; k++) {
    const double low = r->level[k - 1][g], high = r->level[k][g];
    if (r->t[k] > after && high >= level)
      return r->t[k] - SAMPLE * fmin((high - level) / (high - low), 1.0);
  }
  return NAN;
}

/* Water behind the crest, m2. */
static double passed(const tank *t, double l0) {
  int64_t count = 0;
  mps_view x = view_field(t->water, "position");
  for (int64_t i = 0; i < x.shape[0]; i++) count += *mps_view_f64(&x, i, 0) > corner[4][0];
  return (double)count * l0 * l0;
}

/* Time after the crest at the first gauge, and the readings, m. */
static void write_record(const char *path, const record *r, double start) {
  FILE *file = fopen(path, "w");
  assert_non_null(file);
  fprintf(file, "t_s");
  for (int g = 0; g < GAUGES; g++) fprintf(file, ",gauge_%s_m", gauges[g].name);
  for (int k = 0; k < r->count; k++) {
    fprintf(file, "\n%.3f", r->t[k] - start);
    for (int g = 0; g < GAUGES; g++) fprintf(file, ",%.6f", r->level[k][g]);
  }
  fprintf(file, "\n");
  assert_int_equal(fclose(file), 0);
}

/* Errors of the highest readings, in % of the test's, and of the arrivals, s. `path`: see the head
 * of this file, or NULL. */
static void compare(double l0, bool product, const char *path, double *height, double *time) {
  static record r;
  const solitary w = solitary_of(DEPTH, HEIGHT);
  scoped_signal *signal = goring_piston(context, &w);
  scoped_tank t = make_flume(l0, product, signal);
  const double way = gauges[0].x - PISTON - w.stroke;
  double start = 0.0, at;
  run(&t, -GORING_START / (w.number * w.speed) + way / w.speed, &r);
  highest(&r, 0, 0.0, &start);
  if (path) write_record(path, &r, start);
  for (int g = 0; g < GAUGES; g++) {
    const double test = gauges[g].highest - gauges[g].before, most = highest(&r, g, start, &at);
    height[g] = 100.0 * (most / test - 1.0);
    time[g] = arrival(&r, g, start, 0.5 * test) - start - gauges[g].arrival;
    printf("gauge %s: highest %.4f m, of the test %.4f m (%+.1f %%)", gauges[g].name, most, test,
           height[g]);
    if (g > 0) printf(", arrives %+.3f s late", time[g]);
    printf("\n");
  }
  printf("l0 %g m: %lld particles, %.4f m2 behind the crest at %.2f s\n", l0,
         (long long)mps_particles_count(t.water), passed(&t, l0), r.t[r.count - 1] - start);
}

static void a_wave_breaks_and_passes_the_wall(void **state) {
  double height[GAUGES], time[GAUGES];
  compare(0.02, false, NULL, height, time);
  for (int g = 1; g < GAUGES - 2; g++) NEAR(time[g], 0.0, 0.15);
  NEAR(height[1], 0.0, 15.0);
  NEAR(height[2], 0.0, 20.0); /* as it breaks, and on the face: roundings decide on 10 % */
  NEAR(height[4], 0.0, 20.0);
}

/* ---- finer, by hand -------------------------------------------------------------------------- */

static double spacing;
static const char *results;
static bool by_product;

static void a_row(void **state) {
  double height[GAUGES], time[GAUGES];
  compare(spacing, by_product, results, height, time);
}

int main(int count, char **values) {
  if (count > 1) {
    const struct CMUnitTest row[] = {cmocka_unit_test(a_row)};
    spacing = strtod(values[1], NULL);
    results = count > 2 ? values[2] : NULL;
    by_product = count > 3 && strcmp(values[3], "product") == 0;
    return cmocka_run_group_tests(row, make_context, drop_context);
  }
  const struct CMUnitTest tests[] = {cmocka_unit_test(a_wave_breaks_and_passes_the_wall)};
  return cmocka_run_group_tests(tests, make_context, drop_context);
}
