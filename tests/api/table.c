/* table.c - all tables of calls, the names that are deliberately in none, and scenes.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "calls.h"

#include <stdio.h>
#include <stdlib.h>

const api_table *const api_tables[] = {&api_context_calls,  &api_particles_calls, &api_signal_calls,
                                       &api_material_calls, &api_body_calls,      &api_mpm_calls,
                                       &api_dynamics_calls, &api_elastic_calls,   &api_fluid_calls,
                                       &api_io_calls,       &api_waves_calls,     &api_history_calls};
const int api_table_count = API_COUNT(api_tables);

/* Exported functions that nothing here calls, and why. A new function belongs into a table. */
static const struct {
  const char *name, *reason;
} left_out[] = {
    {"mps_snapshot_destroy", "called wherever a snapshot goes"},
    {"mps_mpm_solver", "called by each function that all solvers share"},
    {"mps_dynamics_solver", "likewise"},
    {"mps_elastic_solver", "likewise"},
    {"mps_fluid_solver", "likewise"},
};

/* ---- names ----------------------------------------------------------------------------------- */

enum { MOST_NAMES = 512 };

static struct {
  const char *name;
  int64_t outcomes[MPS_ERROR_INTERNAL + 2];
} counts[MOST_NAMES];
static int count_of_names;

static int find_count(const char *name) {
  for (int k = 0; k < count_of_names; k++)
    if (strcmp(counts[k].name, name) == 0) return k;
  if (count_of_names == MOST_NAMES) return MOST_NAMES - 1;
  counts[count_of_names].name = name;
  return count_of_names++;
}

void api_count(const char *name, mps_status status) {
  const bool known = status >= MPS_OK && status <= MPS_ERROR_INTERNAL;
  counts[find_count(name)].outcomes[known ? status : MPS_ERROR_INTERNAL + 1]++;
}

void api_print_counts(void) {
  printf("%-36s %8s  errors by status\n", "function", "success");
  for (int k = 0; k < count_of_names; k++) {
    printf("%-36s %8lld ", counts[k].name, (long long)counts[k].outcomes[0]);
    for (int status = 1; status <= MPS_ERROR_INTERNAL; status++)
      if (counts[k].outcomes[status])
        printf(" %d: %lld", status, (long long)counts[k].outcomes[status]);
    printf("\n");
  }
}

static bool in_tables(const char *name) {
  for (int t = 0; t < api_table_count; t++)
    for (int k = 0; k < api_tables[t]->count; k++) {
      char shared[80];
      const char *called = api_tables[t]->calls[k].name;
      api_shared_name(called, shared, sizeof shared);
      if (strcmp(called, name) == 0 || strcmp(shared, name) == 0) return true;
    }
  return false;
}

static bool is_left_out(const char *name) {
  for (int k = 0; k < API_COUNT(left_out); k++)
    if (strcmp(left_out[k].name, name) == 0) return true;
  return false;
}

/* Is `name` a word of the map's text that a semicolon ends? */
static bool in_map(const char *map, const char *name) {
  const size_t length = strlen(name);
  for (const char *at = strstr(map, name); at; at = strstr(at + 1, name))
    if (at[length] == ';' && (at == map || at[-1] == ' ')) return true;
  return false;
}

static int complain(const char *name, const char *what) {
  fprintf(stderr, "%s %s\n", name, what);
  return 1;
}

int api_check_names(const char *path) {
  static char map[1 << 16];
  char name[80];
  int wrong = 0;
  FILE *file = fopen(path, "r");
  if (!file) return complain(path, "cannot be read");
  map[fread(map, 1, sizeof map - 1, file)] = '\0';
  (void)fclose(file);
  for (const char *at = strstr(map, "mps_"); at; at = strstr(at + 1, "mps_")) {
    if (at[-1] != ' ' || sscanf(at, "%79[a-z0-9_];", name) != 1) continue;
    if (in_tables(name) == is_left_out(name))
      wrong += complain(name, in_tables(name) ? "is in a table, and left out"
                                              : "is in no table of tests/api");
  }
  for (int t = 0; t < api_table_count; t++)
    for (int k = 0; k < api_tables[t]->count; k++) {
      char shared[80];
      const char *called = api_tables[t]->calls[k].name;
      api_shared_name(called, shared, sizeof shared);
      if (!in_map(map, called) && !in_map(map, shared))
        wrong += complain(called, "is in a table, but not exported");
    }
  for (int k = 0; k < API_COUNT(left_out); k++)
    if (!in_map(map, left_out[k].name))
      wrong += complain(left_out[k].name, "is left out, but not exported");
  return wrong;
}

/* ---- scenes ---------------------------------------------------------------------------------- */

void api_do(api *a, const char *name) {
  for (int t = 0; t < api_table_count; t++)
    for (int k = 0; k < api_tables[t]->count; k++)
      if (strcmp(api_tables[t]->calls[k].name, name) == 0) {
        api_make(a, &api_tables[t]->calls[k]);
        return;
      }
  api_broken(a, "no call %s for the scene", name);
}

/* A field of the latest set, one value for all. */
static void set_field(api *a, const char *name, double value) {
  api_begin(a, "mps_particles_set");
  mps_particles *set = api_any(a, API_SET)->handle;
  api_say(a, "\"%s\", 0, %g", name, value);
  (void)api_end(a, mps_particles_set(set, name, 0, value));
}

static void particles(api *a) {
  api_do(a, "mps_particles_create");
  api_do(a, "mps_particles_fill_box");
}

static void scene_mpm(api *a) {
  static const char *const laws[] = {"mps_material_create_linear_elastic",
                                     "mps_material_create_linear_elastic",
                                     "mps_material_create_neo_hookean",
                                     "mps_material_create_von_mises",
                                     "mps_material_create_drucker_prager",
                                     "mps_material_create_mohr_coulomb",
                                     "mps_material_create_newtonian",
                                     "mps_material_create_user",
                                     "mps_material_create_umat"};
  particles(a);
  set_field(a, "density", 1000.0);
  api_do(a, laws[api_below(a, API_COUNT(laws))]);
  api_do(a, "mps_mpm_create");
  if (api_chance(a, 60)) {
    api_do(a, a->dim == 2 ? "mps_body_create_half_plane" : "mps_body_create_half_space");
    api_do(a, "mps_mpm_add_contact");
  }
}

static void scene_dynamics(api *a) {
  a->dim = 2;
  particles(a);
  set_field(a, "density", 1000.0);
  set_field(a, "shear_velocity", 20.0);
  set_field(a, "pressure_velocity", 40.0);
  if (api_chance(a, 50)) set_field(a, "damping", 0.02);
  api_do(a, "mps_dynamics_create");
}

static void scene_elastic(api *a) {
  particles(a);
  set_field(a, "young", 1e6);
  set_field(a, "poisson", 0.3);
  set_field(a, "density", 1000.0);
  api_do(a, "mps_elastic_create");
  api_do(a, "mps_elastic_add_boundary");
  api_do(a, api_chance(a, 60) ? "mps_elastic_start" : "mps_elastic_solve");
}

static void scene_fluid(api *a) {
  a->dim = 2;
  particles(a);
  api_do(a, "mps_fluid_create");
  for (int k = 0; k < 3; k++) api_do(a, "mps_fluid_add_boundary");
}

void api_scene(api *a) {
  static void (*const scenes[])(api *) = {particles,     scene_mpm,     scene_mpm,   scene_dynamics,
                                          scene_elastic, scene_elastic, scene_fluid, scene_fluid};
  a->latest = true;
  a->mood = API_VALID;
  api_do(a, "mps_context_create");
  if (api_chance(a, 40)) api_do(a, "mps_signal_create_sine");
  if (api_chance(a, 40)) api_do(a, "mps_signal_create_user");
  scenes[api_below(a, API_COUNT(scenes))](a);
  a->latest = false;
}
