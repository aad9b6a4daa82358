/* test_selection.c - one rule in all definitions that act on particles, nodes or facets: a list of
 * ids, or a box, or all; nothing chosen, two ways at once, and a choice that holds nothing are
 * refused by a message that says what to give. SPDX-License-Identifier: BSD-3-Clause */
#define FOUR_SOLVERS
#include "kit/block.h"

#define HINT "give ids and id_count, or a box (lower, upper), or all = 1"

/* ---- the definitions, each as far as it is without a selection ------------------------------- */

typedef enum way {
  NOTHING,
  LIST,
  BOX,
  ALL,
  LIST_AND_BOX,
  LIST_AND_ALL,
  BOX_AND_ALL,
  NO_LIST,
  NO_COUNT,
  UPSIDE_DOWN,
  FAR_AWAY,
  ODD,
  STRANGE,
  WAYS
} way;

static const int64_t some[2] = {0, 1}, strange[2] = {7000, 7001};

#define SELECT(def, how)                                                                           \
  do {                                                                                             \
    const bool list = how == LIST || how == LIST_AND_BOX || how == LIST_AND_ALL;                   \
    if (list || how == NO_COUNT) (def).ids = some;                                                 \
    if (how == STRANGE) (def).ids = strange;                                                       \
    if (list || how == NO_LIST || how == STRANGE) (def).id_count = 2;                              \
    if (how == BOX || how == LIST_AND_BOX || how == BOX_AND_ALL) (def).upper[1] = 0.11;            \
    if (how == UPSIDE_DOWN) (def).lower[1] = 0.2, (def).upper[1] = 0.1;                            \
    if (how == FAR_AWAY) (def).lower[0] = 1e6 + 0.05, (def).upper[0] = 1e6 + 0.06;                 \
    if (how == ALL || how == LIST_AND_ALL || how == BOX_AND_ALL) (def).all = 1;                    \
    if (how == ODD) (def).all = 2;                                                                 \
  } while (0)

#define MAKER(S, what, setting)                                                                    \
  static mps_status S##_##what(way how) {                                                          \
    mps_##S##_##what##_def def = mps_##S##_##what##_defaults();                                    \
    int32_t number = -1;                                                                           \
    setting;                                                                                       \
    SELECT(def, how);                                                                              \
    const mps_status status = mps_##S##_add_##what(S, &def, &number);                              \
    if (status == MPS_OK) OK(mps_##S##_remove_##what(S, number));                                  \
    return status;                                                                                 \
  }
MAKER(mpm, boundary, (void)0)
MAKER(mpm, load, def.traction[0] = 1.0)
MAKER(dynamics, boundary, (void)0)
MAKER(dynamics, load, def.traction[0] = 1.0)
MAKER(elastic, boundary, (void)0)
MAKER(elastic, load, def.force[0] = 1.0)
MAKER(fluid, load, def.acceleration[0] = 1.0)

/* Pressures on facets: those of the bottom and the ends of the lowest row lie in the box. */
static mps_status elastic_facets(way how) {
  DEF(elastic_load, def, .kind = MPS_ELASTIC_LOAD_PRESSURE, .force[0] = 1.0);
  int32_t number = -1;
  SELECT(def, how);
  const mps_status status = mps_elastic_add_load(elastic, &def, &number);
  if (status == MPS_OK) OK(mps_elastic_remove_load(elastic, number));
  return status;
}

TEST(one_rule_in_all_definitions) {
  static mps_status (*const make[])(way) = {mpm_boundary,   mpm_load,     dynamics_boundary,
                                            dynamics_load,  elastic_load, elastic_boundary,
                                            elastic_facets, fluid_load};
  static const char *const why[WAYS] = {
      [NOTHING] = "nothing is selected: " HINT,
      [LIST_AND_BOX] = "both ids and a box (lower, upper) are given: " HINT,
      [LIST_AND_ALL] = "ids and all are given: " HINT,
      [BOX_AND_ALL] = "a box (lower, upper) and all are given: " HINT,
      [NO_LIST] = "id_count is 2 and ids is NULL: at least one id is required",
      [NO_COUNT] = "id_count is 0 and ids is given: at least one id is required",
      [UPSIDE_DOWN] = "lower[1] is 0.2 m and upper[1] 0.1 m: the box is empty",
      [FAR_AWAY] = "",
      [ODD] = "all is 2, allowed are 0 (no) and 1 (yes)",
      [STRANGE] = "ids",
  };
  begin();
  for (size_t k = 0; k < sizeof make / sizeof *make; k++)
    for (way how = NOTHING; how < WAYS; how++) {
      const bool zone = make[k] == fluid_load && how == FAR_AWAY; /* water may come to it */
      const mps_status status = make[k](how);
      if (!why[how] || zone) {
        if (status != MPS_OK)
          fail_msg("definition %d, way %d: %s", (int)k, (int)how,
                   mps_context_error(context)->message);
        continue;
      }
      if (status != MPS_ERROR_ARGUMENT || !strstr(mps_context_error(context)->message, why[how]))
        fail_msg("definition %d, way %d: status %d, \"%s\"", (int)k, (int)how, (int)status,
                 mps_context_error(context)->message);
    }
  end();
}

/* A side of the domain of WLS-MPM selects its nodes itself. */
TEST(a_side_takes_no_selection) {
  begin();
  for (way how = NOTHING; how < WAYS; how++) {
    mps_mpm_boundary_def def = mps_mpm_boundary_defaults();
    SELECT(def, how);
    const mps_status status = mps_mpm_set_boundary(mpm, MPS_SIDE_Y_LOWER, &def);
    assert_int_equal(status, how == NOTHING ? MPS_OK : MPS_ERROR_ARGUMENT);
  }
  end();
}

/* ---- what is selected ------------------------------------------------------------------------ */

/* The force of a load on the elastic block by each way, beside that of the ids that it stands for.
 */
TEST(ways_select_what_they_say) {
  begin();
  int64_t row[8], every[32];
  for (int k = 0; k < 32; k++) every[k] = k;
  memcpy(row, every, sizeof row);
  const int32_t kinds[3] = {MPS_ELASTIC_LOAD_BODY, MPS_ELASTIC_LOAD_VOLUME, MPS_ELASTIC_LOAD_FORCE};
  const double each[3] = {1000.0 * 0.01 * 2.0, 0.01 * 2.0, 2.0}; /* m/s2 on 10 kg; N/m3; N */
  for (int kind = 0; kind < 3; kind++)
    for (int how = 0; how < 4; how++) {
      DEF(elastic_load, def, .kind = kinds[kind], .force[0] = 2.0);
      double force[3], moment[3];
      int32_t number;
      if (how == 0) def.ids = row, def.id_count = 8;
      if (how == 1) def.upper[1] = 0.1;
      if (how == 2) def.ids = every, def.id_count = 32;
      if (how == 3) def.all = 1;
      OK(mps_elastic_add_load(elastic, &def, &number));
      OK(mps_elastic_get_load_resultant(elastic, NULL, force, moment));
      NEAR(force[0], (how < 2 ? 8 : 32) * each[kind], 1e-12 * 32 * each[kind]);
      NEAR(moment[2], -force[0] * (how < 2 ? 0.05 : 0.2), 1e-12 * 32 * each[kind]);
      OK(mps_elastic_remove_load(elastic, number));
    }
  /* a pressure on all facets is in equilibrium, on those of the lower half it lifts the block */
  for (int how = 0; how < 2; how++) {
    DEF(elastic_load, def, .kind = MPS_ELASTIC_LOAD_PRESSURE, .force[0] = 3.0);
    double force[3];
    int32_t number;
    if (how == 0) def.all = 1;
    if (how == 1) def.upper[1] = 0.2;
    OK(mps_elastic_add_load(elastic, &def, &number));
    OK(mps_elastic_get_load_resultant(elastic, NULL, force, NULL));
    NEAR(force[0], 0.0, 1e-12);
    NEAR(force[1], how == 0 ? 0.0 : 3.0 * 0.8, 1e-12);
    OK(mps_elastic_remove_load(elastic, number));
  }
  end();
}

/* The momentum after one step of WLS-MPM, and of explicit dynamics: (selected) * traction * area *
 * dt. */
TEST(explicit_loads_select_what_they_say) {
  for (int how = 0; how < 3; how++) {
    const int64_t row[8] = {0, 1, 2, 3, 4, 5, 6, 7};
    mps_dynamics_load_def other = mps_dynamics_load_defaults();
    mps_totals sum;
    begin();
    DEF(mpm_load, def, .traction[0] = other.traction[0] = 5.0);
    if (how == 0) def.ids = other.ids = row, def.id_count = other.id_count = 8;
    if (how == 1) def.upper[1] = other.upper[1] = 0.1;
    if (how == 2) def.all = other.all = 1;
    OK(mps_mpm_add_load(mpm, &def, NULL));
    OK(mps_mpm_step(mpm, 1));
    OK(mps_mpm_get_totals(mpm, &sum));
    const double count = how < 2 ? 8.0 : 32.0;
    NEAR(sum.linear[0] / (0.5 * mps_mpm_time(mpm)), count, 1e-10);
    OK(mps_dynamics_add_load(dynamics, &other, NULL));
    OK(mps_dynamics_step(dynamics, 1));
    OK(mps_dynamics_get_totals(dynamics, &sum));
    NEAR(sum.linear[0] / (0.5 * mps_dynamics_time(dynamics)), count, 1e-10);
    end();
  }
}
