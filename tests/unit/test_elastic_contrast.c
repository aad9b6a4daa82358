/* test_elastic_contrast.c - moduli that differ by many orders in one body: above 1e8 the log is
 * warned, as of Poisson's ratios near 0.5 where they lock; the budget of energies closes to
 * rounding, and what the solutions leave of the equations works at most 1e-14 times the contrast
 * (`scheme`), as mps/elastic.h states. SPDX-License-Identifier: BSD-3-Clause */
#include "test_journal.h"

/* A block with its lowest row held and eight particles of another modulus is loaded and set free:
 * the largest term of the budget, what it misses, and `scheme`. */
static void swing(mps_context *own, double contrast, double *missing, double *scheme,
                  double *largest) {
  static const double lo[2] = {0.0, 0.0}, hi[2] = {0.6, 0.6}, row[2] = {0.6, 0.1};
  static const int64_t hard[8] = {14, 15, 16, 17, 20, 21, 22, 23};
  mps_elastic_motion_def motion = mps_elastic_motion_defaults();
  mps_totals t;
  int64_t held[36];
  scoped_particles *set = box_of(own, 0.1, lo, hi);
  SET_FIELDS(set, {"young", 1e6}, {"poisson", 0.3}, {"density", 1000.0});
  MAKE(material, other, create_linear_elastic, own, 1e6 * contrast, 0.3);
  MAKE(elastic, e, create, own, set, NULL);
  DEF(elastic_boundary, bottom, .ids = held);
  OK(mps_particles_select_box(set, lo, row, 36, &bottom.id_count, held));
  OK(mps_elastic_add_boundary(e, &bottom, NULL));
  OK(mps_elastic_set_material(e, other, hard, 8));
  USING(elastic_load, mps_elastic_add_load(e, &given, NULL), .kind = MPS_ELASTIC_LOAD_VOLUME,
        .all = 1, .force[0] = 50.0, .force[1] = -20.0);
  motion.dt = 1e-3;
  motion.rho_inf = 1.0;
  OK(mps_elastic_start(e, &motion));
  *missing = *scheme = *largest = 0.0;
  for (int k = 0; k < 20; k++) {
    OK(mps_elastic_step(e, 1));
    OK(mps_elastic_get_totals(e, &t));
    const double sum = t.kinetic + t.strain + t.dissipated - t.work_loads - t.work_boundaries;
    *missing = fmax(*missing, fabs(sum));
    *scheme = fmax(*scheme, fabs(t.scheme));
    *largest = fmax(*largest, fmax(t.kinetic + t.strain, fabs(t.work_loads)));
  }
}

TEST(the_budget_follows_the_contrast) {
  static const double contrasts[] = {1.0, 1e4, 1e8, 1e10, 1e12};
  for (int k = 0; k < 5; k++) {
    journal j = {0};
    scoped_context *own = journal_context(&j, NULL);
    double missing, scheme, largest;
    swing(own, contrasts[k], &missing, &scheme, &largest);
    const double bound = fmax(1e-10, 1e-14 * contrasts[k]);
    print_message("contrast %g: misses %.2g of the largest term, scheme %.2g, bound %.2g\n",
                  contrasts[k], missing / largest, scheme / largest, bound);
    assert_true(largest > 0.0 && missing <= 1e-12 * largest);
    assert_true(scheme <= bound * largest);
    assert_int_equal(j.count, contrasts[k] > 1.01e8 ? 1 : 0);
    if (j.count) assert_non_null(strstr(j.last, "a contrast of 1e+1"));
  }
}

static int warnings_with(int32_t state, double poisson) {
  static const double lo[2] = {0.0, 0.0}, hi[2] = {0.6, 0.4};
  journal j = {0};
  scoped_context *own = journal_context(&j, NULL);
  scoped_particles *set = box_of(own, 0.1, lo, hi);
  SET_FIELDS(set, {"young", 1e6}, {"poisson", poisson});
  DEF(elastic, def, .state = state);
  MAKE(elastic, e, create, own, set, &def);
  if (j.count) assert_non_null(strstr(j.last, "poisson is up to 0.49"));
  return (int)j.count;
}

TEST(a_ratio_of_poisson_near_a_half) {
  assert_int_equal(warnings_with(MPS_ELASTIC_STATE_PLANE_STRAIN, 0.49), 0);
  assert_int_equal(warnings_with(MPS_ELASTIC_STATE_PLANE_STRAIN, 0.495), 1);
  assert_int_equal(warnings_with(MPS_ELASTIC_STATE_PLANE_STRAIN, 0.4999), 1);
  assert_int_equal(warnings_with(MPS_ELASTIC_STATE_PLANE_STRESS, 0.4999), 0);
}
