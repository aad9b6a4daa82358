/* test_mpm_filter.c - the change of volume by the law, and the filter of the mean stress of
 * frictional laws and fluids: flowed sand has pressures like its neighbours', with the same heap;
 * the sum of volumes times pressures is kept, in every geometry and beside mirrors and thin bodies;
 * ground at rest does not move; each law has the treatment that suits it, however it came to the
 * solver. SPDX-License-Identifier: BSD-3-Clause */
#include "mpm_scene.h"
#include "test_fixture.h"

#define DEGREE 0.017453292519943295

static mps_material *make_water(void) {
  DEF(material_newtonian, law, .bulk_modulus = 1e6, .no_tension = 1);
  MAKE_KEPT(material, out, create_newtonian, context, &law);
  return out;
}

static mps_material *make_sand(double young, double cohesion) {
  DEF(material_mohr_coulomb, law, .young = young, .friction = 30.0 * DEGREE, .dilation = 0.0,
      .cohesion = cohesion);
  MAKE_KEPT(material, out, create_mohr_coulomb, context, &law);
  return out;
}

static double pressure(const mps_view *stress, int64_t k) {
  return -(*mps_view_f64(stress, k, 0) + *mps_view_f64(stress, k, 1) +
           *mps_view_f64(stress, k, 2)) /
         3.0;
}

/* ---- a heap ---------------------------------------------------------------------------------- */

typedef struct heap {
  double noise, front, top, volume, residual, spent;
} heap;

/* rms of each pressure less the mean of its 8 nearest neighbours', over the rms pressure. */
static double find_noise(mpm_scene *s, double h) {
  mps_view x = mpm_scene_view(s, "position"), stress = mpm_scene_view(s, "stress");
  double rough = 0.0, all = 0.0;
  for (int64_t k = 0; k < x.shape[0]; k++) {
    double near[8], p[8] = {0.0}, mean = 0.0;
    for (int i = 0; i < 8; i++) near[i] = INFINITY;
    for (int64_t j = 0; j < x.shape[0]; j++) {
      const double dx = *mps_view_f64(&x, j, 0) - *mps_view_f64(&x, k, 0);
      const double dy = *mps_view_f64(&x, j, 1) - *mps_view_f64(&x, k, 1);
      const double square = dx * dx + dy * dy;
      if (j == k || square > 4.0 * h * h || square >= near[7]) continue;
      int i = 7;
      for (; i > 0 && near[i - 1] > square; i--) near[i] = near[i - 1], p[i] = p[i - 1];
      near[i] = square, p[i] = pressure(&stress, j);
    }
    if (near[7] == INFINITY) continue; /* a grain that lies alone */
    for (int i = 0; i < 8; i++) mean += p[i] / 8.0;
    const double own = pressure(&stress, k);
    rough += (own - mean) * (own - mean);
    all += own * own;
  }
  return sqrt(rough / all);
}

static int ascending(const void *a, const void *b) {
  const double x = *(const double *)a, y = *(const double *)b;
  return x < y ? -1 : x > y;
}

/* The place that all but 1 % of the particles are below, along axis c. */
static double find_extent(mpm_scene *s, int c) {
  mps_view x = mpm_scene_view(s, "position");
  double *sorted = malloc((size_t)x.shape[0] * sizeof *sorted);
  assert_non_null(sorted);
  for (int64_t k = 0; k < x.shape[0]; k++) sorted[k] = *mps_view_f64(&x, k, c);
  qsort(sorted, (size_t)x.shape[0], sizeof *sorted, ascending);
  const double out = sorted[(int64_t)(0.99 * (double)(x.shape[0] - 1))];
  free(sorted);
  return out;
}

/* A column of sand, 0.2 x 0.3 m, that has collapsed on a rough floor. */
static heap collapse(double young, int32_t volumetric, int32_t spline, double flip_time) {
  const double h = 0.02;
  scoped_mpm_scene s = mpm_scene_begin(context, 0.5 * h, 0.0, 0.0, 1e6);
  mpm_scene_box(&s, 0.0, 0.0, 0.2, 0.3);
  mps_material_destroy(&s.material);
  s.material = make_sand(young, 0.0);
  USING(mpm, mpm_scene_solve(&s, &given), .cell = h, .spline = spline, .volumetric = volumetric,
        .budget = 1, .flip_time = flip_time, .lower[0] = given.lower[1] = 0.0, .gravity[1] = -9.81);
  mpm_scene_side(&s, MPS_SIDE_Y_LOWER, MPS_BOUNDARY_FRICTIONAL, 0.5);
  OK(mps_mpm_run(s.mpm, 1.2, INT64_MAX, NULL, NULL));
  mps_mpm_energy_report l;
  OK(mps_mpm_get_energy_report(s.mpm, &l));
  const heap out = {.noise = find_noise(&s, h),
                    .front = find_extent(&s, 0),
                    .top = find_extent(&s, 1),
                    .volume = mpm_scene_totals(&s).volume,
                    .residual = l.residual,
                    .spent = l.laws};
  print_message(
      "E %g Pa, volumetric %d, spline %d: noise %.3f, front %.4f m, top %.4f m, V %.6f m2, laws "
      "%.2f J, residual %.2g J\n",
      young, (int)volumetric, (int)spline, out.noise, out.front, out.top, out.volume, out.spent,
      out.residual);
  return out;
}

TEST(flowed_sand_has_smooth_pressures) {
  static const double young[] = {1e6, 3e6, 1e7};
  for (int k = 0; k < 6; k++) {
    const int32_t spline = 2 + k % 2;
    const heap own = collapse(young[k / 2], MPS_MPM_VOLUMETRIC_POINT, spline, 0.0);
    const heap filtered = collapse(young[k / 2], MPS_MPM_VOLUMETRIC_BY_LAW, spline, 0.0);
    const heap kept = collapse(young[k / 2], MPS_MPM_VOLUMETRIC_BY_LAW, spline, NAN);
    assert_true(own.noise > 0.6);
    assert_true(kept.noise < 0.12); /* by default particles keep what the nodes do not represent */
    assert_true(filtered.noise < 0.16); /* 0.1 but for cubic weights at the last */
    NEAR(filtered.front / own.front, 1.0, 0.02);
    NEAR(filtered.top / own.top, 1.0, 0.02);
    NEAR(filtered.volume / own.volume, 1.0, 5e-4);
    NEAR(filtered.residual, 0.0, 1e-10 * filtered.spent);
  }
}

/* ---- what is kept ---------------------------------------------------------------------------- */

/* Stress of pressure p beyond the yield surface by shear: the first step returns it, with plastic
 * strain, at the same p. */
static void set_beyond(const mps_edit *stress, int64_t k, double p) {
  *mps_edit_f64(stress, k, 0) = -0.4 * p;
  *mps_edit_f64(stress, k, 1) = -1.6 * p;
  *mps_edit_f64(stress, k, 2) = -p;
}

/* The same pressure of water, whose state is its volume. */
static void compress(const mps_edit *volume_ratio, int64_t k, double p) {
  *mps_edit_f64(volume_ratio, k, 0) = pow(1.0 + 7.0 * p / 1e6, -1.0 / 7.0); /* Tait */
}

/* A block between rollers whose pressures differ from particle to particle, after the first step,
 * in which sand yields, and which filters. */
static mpm_scene step_rough(bool water, int32_t volumetric, int32_t geometry, int32_t spline) {
  const int dim = geometry == MPS_MPM_GEOMETRY_SPACE ? 3 : 2;
  const double h = 0.1, lo[3] = {0.0, 0.0, 0.0}, hi[3] = {0.9, 1.1, 0.5};
  mpm_scene s = mpm_scene_begin_in(context, dim, 0.5 * h, 0.0, 0.0, 1e6);
  OK(mps_particles_fill_box(s.particles, lo, hi, NULL));
  SET_FIELDS(s.particles, {"stress", 0.0}, {"volume_ratio", 1.0});
  mps_material_destroy(&s.material);
  s.material = water ? make_water() : make_sand(1e6, 0.0);
  mps_edit stress = mpm_scene_edit(&s, "stress"), ratio = mpm_scene_edit(&s, "volume_ratio");
  uint32_t random = 7;
  for (int64_t k = 0; k < stress.view.shape[0]; k++) {
    random = random * 1664525u + 1013904223u;
    const double p = 1e4 + 5e3 * ((double)(random >> 8) / 16777216.0 - 0.5);
    set_beyond(&stress, k, p);
    if (water) compress(&ratio, k, p);
  }
  mpm_scene_commit(&s, &stress);
  mpm_scene_commit(&s, &ratio);
  DEF(mpm, def, .geometry = geometry, .cell = h, .spline = spline, .volumetric = volumetric);
  def.dt = 1e-4; /* no particle opens */
  for (int c = 0; c < dim; c++) def.lower[c] = 0.0;
  mpm_scene_solve(&s, &def);
  OK(mps_mpm_step(s.mpm, 1));
  return s;
}

TEST(the_sum_of_volumes_times_pressures_is_kept) {
  for (int k = 0; k < 12; k++) {
    scoped_mpm_scene own = step_rough(k >= 6, MPS_MPM_VOLUMETRIC_POINT, k % 6 / 2, 2 + k % 2);
    scoped_mpm_scene filtered = step_rough(k >= 6, MPS_MPM_VOLUMETRIC_BY_LAW, k % 6 / 2, 2 + k % 2);
    mps_view p[2] = {mpm_scene_view(&own, "stress"), mpm_scene_view(&filtered, "stress")};
    mps_view V = mpm_scene_view(&own, "volume");
    double sum = 0.0, change = 0.0, largest = 0.0, rough[2] = {0.0, 0.0};
    for (int64_t i = 0; i < V.shape[0]; i++) {
      const double v = *mps_view_f64(&V, i, 0), before = pressure(&p[0], i);
      sum += v * before;
      change += v * (pressure(&p[1], i) - before);
      largest = fmax(largest, fabs(pressure(&p[1], i) - before));
      for (int f = 0; f < 2; f++) rough[f] += pow(pressure(&p[f], i) - 1e4, 2);
    }
    assert_true(largest > 10.0);
    if (k >= 6) assert_true(rough[1] < 0.25 * rough[0]); /* at once */
    NEAR(change, 0.0, 1e-12 * sum);
    const double volume[2] = {mpm_scene_totals(&own).volume, mpm_scene_totals(&filtered).volume};
    /* p/K of sand is 0.01; the modulus of water differs by 7 p from particle to particle */
    NEAR(volume[1] / volume[0], 1.0, k < 6 ? 1e-6 : 2e-5);
  }
}

/* Two halves with different pressures on either side of a thin plate: the largest difference from
 * these after some steps. */
static double beside_plate(bool water, int32_t volumetric) {
  scoped_mpm_scene s = mpm_scene_begin(context, 0.05, 0.0, 0.0, 1e6);
  mpm_scene_box(&s, 0.0, 0.0, 0.5, 1.0);
  mpm_scene_box(&s, 0.55, 0.0, 1.0, 1.0);
  SET_FIELDS(s.particles, {"stress", 0.0}, {"volume_ratio", 1.0});
  mps_material_destroy(&s.material);
  s.material = water ? make_water() : make_sand(1e6, 0.0);
  mps_edit stress = mpm_scene_edit(&s, "stress"), ratio = mpm_scene_edit(&s, "volume_ratio");
  mps_view x = mpm_scene_view(&s, "position");
  for (int64_t k = 0; k < x.shape[0]; k++) {
    const double p = *mps_view_f64(&x, k, 0) < 0.5 ? 1e4 : 2e4;
    set_beyond(&stress, k, p);
    if (water) compress(&ratio, k, p);
  }
  mpm_scene_commit(&s, &stress);
  mpm_scene_commit(&s, &ratio);
  DEF(mpm, def, .cell = 0.1, .volumetric = volumetric);
  for (int c = 0; c < 2; c++) def.lower[c] = 0.0, def.upper[c] = 1.0;
  mpm_scene_solve(&s, &def);
  DEF(body, at, .position[0] = 0.525, .position[1] = 0.5);
  MAKE(body, plate, create_box, context, &at, 0.05, 1.4);
  mpm_scene_contact(&s, plate, 0.0);
  OK(mps_mpm_step(s.mpm, 97));
  mps_view p = mpm_scene_view(&s, "stress");
  x = mpm_scene_view(&s, "position");
  double off = 0.0;
  for (int64_t k = 0; k < x.shape[0]; k++)
    off = fmax(off, fabs(pressure(&p, k) - (*mps_view_f64(&x, k, 0) < 0.5 ? 1e4 : 2e4)));
  return off;
}

TEST(nothing_passes_a_thin_plate) {
  for (int water = 0; water < 2; water++) {
    const double own = beside_plate(water != 0, MPS_MPM_VOLUMETRIC_POINT);
    const double filtered = beside_plate(water != 0, MPS_MPM_VOLUMETRIC_BY_LAW);
    print_message("%s beside a plate: pressures off by %.3g and %.3g Pa\n",
                  water ? "water" : "sand", own, filtered);
    assert_true(filtered < 1.05 * own + 1.0); /* of a difference of 1e4 */
  }
}

/* ---- water ----------------------------------------------------------------------------------- */

/* A column of water collapses and strikes a wall; what the laws and transfers lose in J. */
static mps_mpm_energy_report splash(int32_t volumetric, double *noise) {
  const double h = 0.05;
  scoped_mpm_scene s = mpm_scene_begin(context, 0.5 * h, 0.0, 0.0, 1e6);
  mpm_scene_box(&s, 0.0, 0.0, 0.5, 1.0);
  mps_material_destroy(&s.material);
  s.material = make_water();
  OK(mps_particles_set(s.particles, "density", 0, 1000.0));
  USING(mpm, mpm_scene_solve(&s, &given), .cell = h, .volumetric = volumetric, .budget = 1,
        .lower[0] = given.lower[1] = 0.0, .upper[0] = 1.5, .gravity[1] = -9.81);
  OK(mps_mpm_run(s.mpm, 0.8, INT64_MAX, NULL, NULL));
  mps_mpm_energy_report out;
  OK(mps_mpm_get_energy_report(s.mpm, &out));
  *noise = find_noise(&s, h);
  print_message("splash, volumetric %d: %lld steps, noise %.3f, laws %.3g J, transfers %.3g J, "
                "residual %.2g J\n",
                (int)volumetric, (long long)mps_mpm_steps(s.mpm), *noise, out.laws, out.transfer,
                out.residual);
  return out;
}

TEST(the_budget_of_water_counts_the_filter) {
  double noise[2];
  const mps_mpm_energy_report own = splash(MPS_MPM_VOLUMETRIC_POINT, &noise[0]);
  const mps_mpm_energy_report filtered = splash(MPS_MPM_VOLUMETRIC_BY_LAW, &noise[1]);
  assert_true(noise[1] < 0.4 * noise[0]);
  assert_true(filtered.laws > own.laws); /* the filter takes energy */
  assert_true(filtered.laws < 50.0);     /* of 1226 J that the water can lose */
  NEAR(filtered.residual, 0.0, 1e-8);
}

/* Sand without cohesion at its K0 stress under gravity, between rollers, with a free surface. */
TEST(ground_at_rest_does_not_move) {
  for (int32_t spline = 2; spline <= 3; spline++) {
    double moved[2] = {0.0, 0.0}, off[2] = {0.0, 0.0};
    for (int option = 0; option < 2; option++) {
      scoped_mpm_scene s = mpm_scene_begin(context, 0.05, 0.0, 0.0, 1e7);
      mpm_scene_box(&s, 0.0, 0.0, 2.0, 1.0);
      mps_material_destroy(&s.material);
      s.material = make_sand(1e6, 0.0);
      OK(mps_particles_set(s.particles, "density", 0, 1000.0));
      const mps_geostatic_layer layer = {.thickness = INFINITY, .k0 = 0.5, .density = NAN};
      DEF(geostatic, rest, .layers = &layer, .layer_count = 1, .gravity = 9.81, .surface = 1.0);
      OK(mps_particles_set_geostatic(s.particles, &rest));
      USING(mpm, mpm_scene_solve(&s, &given), .cell = 0.1, .spline = spline, .gravity[1] = -9.81,
            .volumetric = option == 0 ? MPS_MPM_VOLUMETRIC_POINT : MPS_MPM_VOLUMETRIC_BY_LAW,
            .lower[0] = given.lower[1] = 0.0, .upper[0] = 2.0);
      double start[800];
      mps_view x = mpm_scene_view(&s, "position"), id = mpm_scene_view(&s, "id");
      assert_int_equal(x.shape[0], 800);
      for (int64_t k = 0; k < 800; k++) start[*mps_view_i64(&id, k, 0)] = *mps_view_f64(&x, k, 1);
      OK(mps_mpm_step(s.mpm, 800));
      mps_view stress = mpm_scene_view(&s, "stress");
      x = mpm_scene_view(&s, "position"), id = mpm_scene_view(&s, "id");
      for (int64_t k = 0; k < 800; k++) {
        const double y = start[*mps_view_i64(&id, k, 0)];
        moved[option] = fmax(moved[option], fabs(*mps_view_f64(&x, k, 1) - y));
        off[option] =
            fmax(off[option], fabs(*mps_view_f64(&stress, k, 1) + 9810.0 * (1.0 - y)) / 9810.0);
      }
    }
    print_message("spline %d: moved %.3g and %.3g m, stress off by %.3g and %.3g of the largest\n",
                  (int)spline, moved[0], moved[1], off[0], off[1]);
    assert_true(moved[1] < moved[0] + 1e-5); /* 1e-4 of the smallest cell */
    assert_true(off[1] < off[0] + 2e-3);
  }
}

/* How far (m) a block on sand goes down in 2 s under its weight, a fifth of what the sand bears,
 * and a load to and fro along the ground, after 0.5 s in which it has settled. */
static double creep(int32_t volumetric, double push) {
  const double h = 0.05, width = 0.3, weight = 6e3;
  mpm_scene s = mpm_scene_begin(context, 0.5 * h, 0.0, 0.0, 1e6);
  mpm_scene_box(&s, 0.0, 0.0, 1.2, 0.5);
  mps_material_destroy(&s.material);
  s.material = make_sand(2e7, 200.0);
  OK(mps_particles_set(s.particles, "density", 0, 1600.0));
  const mps_geostatic_layer layer = {.thickness = INFINITY, .k0 = 0.5, .density = NAN};
  DEF(geostatic, rest, .layers = &layer, .layer_count = 1, .gravity = 9.81, .surface = 0.5);
  OK(mps_particles_set_geostatic(s.particles, &rest));
  DEF(mpm, def, .cell = h, .gravity[1] = -9.81, .volumetric = volumetric,
      .lower[0] = def.lower[1] = 0.0, .upper[0] = 1.2);
  OK(mps_mpm_create(context, s.particles, s.material, &def, &s.mpm));
  DEF(body, at, .motion = MPS_BODY_MOTION_FREE, .position[0] = 0.6, .position[1] = 0.55,
      .gravity[1] = -9.81, .mass = weight / 9.81, .inertia[2] = 0.1 * at.mass * width * width);
  MAKE(body, block, create_box, context, &at, width, 0.1);
  mpm_scene_contact(&s, block, 0.5);
  mps_body_state first, last;
  OK(mps_mpm_run(s.mpm, 0.5, INT64_MAX, NULL, NULL));
  OK(mps_body_get_state(block, &first));
  for (int k = 0; k < 8; k++) {
    const double force[3] = {k % 2 ? -push * weight : push * weight, 0.0, 0.0};
    const double none[3] = {0.0};
    OK(mps_body_set_load(block, force, none));
    OK(mps_mpm_run(s.mpm, 0.75 + 0.25 * k, INT64_MAX, NULL, NULL));
  }
  OK(mps_body_get_state(block, &last));
  print_message("volumetric %d, push %g: in %lld steps down by %.4g mm of %.4g\n", (int)volumetric,
                push, (long long)mps_mpm_steps(s.mpm), 1e3 * (first.position[1] - last.position[1]),
                1e3 * (0.55 - last.position[1]));
  mpm_scene_end(&s);
  return first.position[1] - last.position[1];
}

/* Its true gradients are not filtered away. */
TEST(loaded_ground_does_not_creep) {
  for (int k = 0; k < (test_quick() ? 1 : 2); k++) {
    const double own = creep(MPS_MPM_VOLUMETRIC_POINT, 0.02 * k);
    const double filtered = creep(MPS_MPM_VOLUMETRIC_BY_LAW, 0.02 * k);
    assert_true(filtered < own + 1e-6);
  }
}

/* ---- the choice ------------------------------------------------------------------------------ */

typedef enum choice {
  SAND,
  CONE,
  CLAY,
  CONE_CLAY,
  METAL,
  RUBBER,
  JELLY,
  SOIL,
  WATER,
  CHOICES
} choice;

static mps_material *make_law(choice which) {
  mps_material *out = NULL;
  mps_material_drucker_prager_def cone = mps_material_drucker_prager_defaults();
  mps_material_von_mises_def mises = mps_material_von_mises_defaults();
  DEF(material_mohr_coulomb, pyramid, .young = cone.young = mises.young = 1e6,
      .friction = cone.friction = which == SAND || which == CONE ? 0.5 : 0.0,
      .dilation = cone.dilation = which == SAND ? 0.2 : 0.0, .cohesion = cone.cohesion = 100.0);
  mises.poisson = 0.3, mises.yield_stress = 200.0;
  DEF(material_newtonian, fluid, .bulk_modulus = 1e6);
  mps_status status = MPS_OK;
  if (which == SAND || which == CLAY)
    status = mps_material_create_mohr_coulomb(context, &pyramid, &out);
  if (which == CONE || which == CONE_CLAY)
    status = mps_material_create_drucker_prager(context, &cone, &out);
  if (which == METAL) status = mps_material_create_von_mises(context, &mises, &out);
  if (which == RUBBER) status = mps_material_create_neo_hookean(context, 1e6, 0.45, &out);
  if (which == JELLY) status = mps_material_create_linear_elastic(context, 1e6, 0.49, &out);
  if (which == SOIL) status = mps_material_create_linear_elastic(context, 1e6, 0.44, &out);
  if (which == WATER) status = mps_material_create_newtonian(context, &fluid, &out);
  OK(status);
  return out;
}

/* A block of the law strikes the floor; `later`: it was made of elastic soil, and is given the law
 * before the first step. */
static mpm_scene strike(choice which, int32_t volumetric, bool later) {
  mpm_scene s = mpm_scene_begin(context, 0.05, 0.0, 0.0, 1e6);
  mpm_scene_box(&s, 0.1, 0.0, 0.6, 0.5);
  const double v0[2] = {0.0, -1.0}, still[4] = {0.5, 0.0, 0.0, 0.0};
  mpm_scene_affine(&s, v0, still);
  mps_material *law = make_law(which);
  DEF(mpm, def, .cell = 0.1, .volumetric = volumetric, .lower[1] = 0.0, .dt = 2e-4);
  if (!later) mps_material_destroy(&s.material), s.material = law;
  mpm_scene_solve(&s, &def);
  if (later) {
    OK(mps_mpm_set_material(s.mpm, law, NULL, 0));
    mps_material_destroy(&law);
  }
  OK(mps_mpm_step(s.mpm, 40));
  return s;
}

TEST(each_law_has_what_suits_it) {
  static const int32_t expected[CHOICES] = {[SAND] = MPS_MPM_VOLUMETRIC_NODES,
                                            [CONE] = MPS_MPM_VOLUMETRIC_NODES,
                                            [CLAY] = MPS_MPM_VOLUMETRIC_CELL,
                                            [CONE_CLAY] = MPS_MPM_VOLUMETRIC_CELL,
                                            [METAL] = MPS_MPM_VOLUMETRIC_CELL,
                                            [RUBBER] = MPS_MPM_VOLUMETRIC_CELL,
                                            [JELLY] = MPS_MPM_VOLUMETRIC_CELL,
                                            [SOIL] = MPS_MPM_VOLUMETRIC_POINT,
                                            [WATER] = -1}; /* a filter of its own */
  for (int which = 0; which < CHOICES; which++) {
    scoped_mpm_scene by_law = strike(which, MPS_MPM_VOLUMETRIC_BY_LAW, false);
    for (int32_t option = MPS_MPM_VOLUMETRIC_POINT; option <= MPS_MPM_VOLUMETRIC_NODES; option++) {
      scoped_mpm_scene s = strike(which, option, false);
      const double apart = mpm_scene_stress_difference(&by_law, &s);
      if (option == expected[which])
        NEAR(apart, 0.0, 0.0);
      else
        assert_true(apart > 1e-6);
    }
    scoped_mpm_scene later = strike(which, MPS_MPM_VOLUMETRIC_BY_LAW, true);
    NEAR(mpm_scene_stress_difference(&by_law, &later), 0.0, 0.0);
  }
}

/* Stresses (Pa) by id of 100 particles of sand that strike the floor, beside falling water or not.
 */
static void strike_beside(bool beside, double (*stress)[4]) {
  scoped_mpm_scene s = mpm_scene_begin(context, 0.05, 0.0, 0.0, 1e6);
  const double v0[2] = {0.0, -1.0}, still[4] = {0.5, 0.0, 0.0, 0.0};
  mpm_scene_box(&s, 0.1, 0.0, 0.6, 0.5);
  if (beside) mpm_scene_box(&s, 2.1, 0.0, 2.6, 0.5);
  mpm_scene_affine(&s, v0, still);
  mps_material_destroy(&s.material);
  s.material = make_law(SAND);
  USING(mpm, mpm_scene_solve(&s, &given), .cell = 0.1, .lower[1] = 0.0, .dt = 2e-4);
  scoped_material *water = make_law(WATER);
  int64_t ids[100];
  for (int k = 0; k < 100; k++) ids[k] = 100 + k;
  if (beside) OK(mps_mpm_set_material(s.mpm, water, ids, 100));
  OK(mps_mpm_step(s.mpm, 40));
  mps_view all = mpm_scene_view(&s, "stress"), id = mpm_scene_view(&s, "id");
  assert_int_equal(all.shape[0], beside ? 200 : 100);
  for (int64_t k = 0; k < all.shape[0]; k++) {
    const int64_t at = *mps_view_i64(&id, k, 0);
    for (int c = 0; c < 4 && at < 100; c++) stress[at][c] = *mps_view_f64(&all, k, c);
  }
}

TEST(water_does_not_change_the_filter_of_sand) {
  double alone[100][4], beside[100][4];
  strike_beside(false, alone);
  strike_beside(true, beside);
  for (int k = 0; k < 100; k++)
    for (int c = 0; c < 4; c++) NEAR(beside[k][c], alone[k][c], 0.0);
}
