/* calls.c - calls every stable function, once with arguments that it may take and once for each argument with each of
 * the wrong or odd values of its kind, and prints the status: "function(argument=value) STATUS". Every call is made in
 * a process of its own on the same objects, so none depends on another and new functions change no line.
 *
 * "calls brief" leaves out the members of definitions. "calls explain" makes the calls with right arguments alone, and
 * prints the records of those that fail.
 *
 * calls_table.h, written by released.py from the headers, has the functions. SPDX-License-Identifier: BSD-3-Clause */
#define _POSIX_C_SOURCE 200809L
#include "scenes.h"

#include <math.h>
#include <stdio.h>
#include <string.h>
#include <sys/wait.h>
#include <unistd.h>

enum { MOST = 14, ROOM = 1 << 21, SECONDS = 60 };
typedef enum argument { HANDLE, PLACE, NUMBERS, REAL, WHOLE, BITS, TEXT, DEFINITION, SIZE, CALLBACK } argument;

/* The values of each kind of argument; the first is the one that a function may take. */
static const char *const choices[][7] = {
    [HANDLE] = {"object", "NULL"},
    [PLACE] = {"room", "NULL"},
    [NUMBERS] = {"0.25, 0.5, ...", "NULL"},
    [REAL] = {"0.25", "0", "-1", "nan", "inf"},
    [WHOLE] = {"1", "0", "-1", "2", "4", "44"},
    [BITS] = {"1", "0", "4294967295"},
    [TEXT] = {"density", "NULL", "empty", "no such name"},
    [DEFINITION] = {"defaults", "NULL", "zeros", "too large"},
    [SIZE] = {"right", "0", "1048576"},
    [CALLBACK] = {"NULL"},
};

/* A number of a definition, and how many values of REAL or WHOLE it has in turn. */
typedef struct member {
  const char *name;
  size_t offset;
  int32_t bytes; /* 8 a double, 4 an int32_t, -8 an int64_t */
} member;
typedef struct definitions {
  int32_t kind;
  size_t bytes;
  const member *members;
  int count;
} definitions;
static const definitions *definition_of(int32_t kind); /* calls_table.h */
static const double wrong[] = {(double)NAN, -1.0, 0.0, 0.25, 1.0, 2.0, 44.0, 1e6, 1e30};
enum { WRONG = (int)(sizeof wrong / sizeof *wrong), KNOWN = 4 /* choices of a definition as a whole */ };

typedef struct entry {
  const char *name;
  int (*call)(const int *choice); /* the status; -1 of a function without one */
  int count;
  const char *names[MOST];
  argument kinds[MOST];
  int32_t definitions[MOST]; /* kinds of definitions, else 0 */
} entry;

static union {
  double align;
  char bytes[ROOM];
} rooms[MOST];
static scene scenes[SCENES];
static mps_particles *set; /* which no solver holds */
static mps_kernel *kernel;
static mps_snapshot *snapshot;
static mps_body *body;
static int explain, brief; /* see above */
static double returned; /* by a function without a status */

static void *handle(const char *type, int choice) {
  const struct {
    const char *type;
    const void *object;
  } objects[] = {
      {"mps_context", scenes[SCENE_MPM].context},
      {"mps_particles", set},
      {"mps_material", scenes[SCENE_MPM].law},
      {"mps_signal", scenes[SCENE_FLUID].signal},
      {"mps_body", body},
      {"mps_contact", scenes[SCENE_MPM].contact},
      {"mps_kernel", kernel},
      {"mps_snapshot", snapshot},
      {"mps_solver", scenes[SCENE_MPM].solver},
      {"mps_mpm", scenes[SCENE_MPM].mpm},
      {"mps_dynamics", scenes[SCENE_DYNAMICS].dynamics},
      {"mps_elastic", scenes[SCENE_ELASTIC].elastic},
      {"mps_fluid", scenes[SCENE_FLUID].fluid},
      {"mps_grid", mps_mpm_grid(scenes[SCENE_MPM].mpm)},
  };
  for (size_t k = 0; choice == 0 && k < sizeof objects / sizeof *objects; k++)
    if (strcmp(objects[k].type, type) == 0) return (void *)objects[k].object;
  return NULL;
}

static void *place(int number, int choice) { return choice == 0 ? rooms[number].bytes : NULL; }

/* A place that holds an object, which the call destroys. */
static void *owned(int number, const char *type, int choice) {
  void *object = handle(type, 0);
  memcpy(rooms[number].bytes, &object, sizeof object);
  return place(number, choice);
}

static void *numbers(int number, int choice) {
  double *values = (double *)(void *)rooms[number].bytes;
  for (int k = 0; k < 64; k++) values[k] = 0.25 * (k + 1) + 10.0 * number;
  return place(number, choice);
}

static double real(int choice) {
  static const double values[] = {0.25, 0.0, -1.0, (double)NAN, (double)INFINITY};
  return values[choice];
}
static int whole(int choice) {
  static const int values[] = {1, 0, -1, 2, 4, 44};
  return values[choice];
}
static uint32_t bits(int choice) { return choice == 2 ? UINT32_MAX : 1u - (uint32_t)choice; }
static size_t size(size_t right, int choice) { return choice == 0 ? right : choice == 1 ? 0 : 1048576; }

static const char *text(int choice) {
  static const char *const values[] = {"density", NULL, "", "no such name"};
  return values[choice];
}

static mps_status law(void *user, const mps_material_block *block) {
  (void)user, (void)block;
  return MPS_OK;
}
static MPS_MATERIAL_UMAT(umat) { MPS_MATERIAL_UMAT_UNUSED; }

/* What has no default, so that a function takes the definition. */
static void complete(int32_t kind, void *def) {
#define GIVE(KIND, type, ...)                                                                      \
  case MPS_DEF_##KIND: {                                                                           \
    type *d = (type *)def;                                                                         \
    __VA_ARGS__;                                                                                   \
    break;                                                                                         \
  }
  static const mps_geostatic_layer ground = {INFINITY, 0.5, 1800.0};
  switch (kind) {
    GIVE(PARTICLES, mps_particles_def, d->spacing = 0.25)
    GIVE(RECORDER, mps_recorder_def, d->path = "density")
    GIVE(MATERIAL_VON_MISES, mps_material_von_mises_def, d->young = 1e6, d->yield_stress = 1e3)
    GIVE(MATERIAL_DRUCKER_PRAGER, mps_material_drucker_prager_def, d->young = 1e6, d->friction = 0.5)
    GIVE(MATERIAL_MOHR_COULOMB, mps_material_mohr_coulomb_def, d->young = 1e6, d->friction = 0.5)
    GIVE(MATERIAL_NEWTONIAN, mps_material_newtonian_def, d->bulk_modulus = 1e6)
    GIVE(MATERIAL_CAM_CLAY, mps_material_cam_clay_def, d->critical_slope = 1.0, d->compression = 0.1,
         d->swelling = 0.02, d->void_ratio = 1.0, d->preconsolidation = 1e5)
    GIVE(MATERIAL_USER, mps_material_user_def, d->update = law, d->wave_modulus = 1e6)
    GIVE(MATERIAL_UMAT, mps_material_umat_def, d->umat = umat, d->wave_modulus = 1e6)
    GIVE(GEOSTATIC, mps_geostatic_def, d->layers = &ground, d->layer_count = 1, d->layer_size = (int32_t)sizeof ground)
    GIVE(MPM, mps_mpm_def, d->cell = 0.5)
    GIVE(MPM_BOUNDARY, mps_mpm_boundary_def, d->all = 1)
    GIVE(MPM_LOAD, mps_mpm_load_def, d->all = 1)
    GIVE(DYNAMICS_BOUNDARY, mps_dynamics_boundary_def, d->all = 1)
    GIVE(DYNAMICS_LOAD, mps_dynamics_load_def, d->all = 1)
    GIVE(ELASTIC_BOUNDARY, mps_elastic_boundary_def, d->all = 1)
    GIVE(ELASTIC_LOAD, mps_elastic_load_def, d->all = 1)
    GIVE(ELASTIC_MOTION, mps_elastic_motion_def, d->dt = 1e-3)
    GIVE(FLUID_BOUNDARY, mps_fluid_boundary_def, d->point[0] = 5.0, d->normal[0] = -1.0)
    GIVE(FLUID_LOAD, mps_fluid_load_def, d->all = 1)
  default:
    break;
  }
#undef GIVE
}

static void set_member(void *def, const member *m, double value) {
  const int32_t whole = value == value && fabs(value) < 1e9 ? (int32_t)value : INT32_MAX;
  const int64_t large = whole;
  memcpy((char *)def + m->offset, m->bytes == 8 ? (const void *)&value : m->bytes == 4 ? (const void *)&whole : &large,
         m->bytes == 4 ? 4 : 8);
}

static void *definition(int number, int32_t kind, int choice) {
  const uint32_t large = 5000;
  const definitions *d = definition_of(kind);
  void *def = rooms[number].bytes;
  if (choice == 1) return NULL;
  if (choice == 2) return def;
  if (mps_def_init(kind, def, d->bytes) != MPS_OK) return NULL;
  complete(kind, def);
  if (choice == 3) memcpy(def, &large, sizeof large);
  if (choice >= KNOWN) set_member(def, &d->members[(choice - KNOWN) / WRONG], wrong[(choice - KNOWN) % WRONG]);
  return def;
}

#include "calls_table.h"

/* The number of choices of an argument, and what one of them is called. */
static int choice_count(const entry *e, int argument) {
  int count = 0;
  if (e->kinds[argument] == DEFINITION && !brief) return KNOWN + WRONG * definition_of(e->definitions[argument])->count;
  while (choices[e->kinds[argument]][count]) count++;
  return count;
}
static void print_choice(const entry *e, int argument, int choice) {
  if (e->kinds[argument] == DEFINITION && choice >= KNOWN)
    printf("%s.%s=%g", e->names[argument], definition_of(e->definitions[argument])->members[(choice - KNOWN) / WRONG].name,
           wrong[(choice - KNOWN) % WRONG]);
  else
    printf("%s=%s", e->names[argument], choices[e->kinds[argument]][choice]);
}

/* Makes one call in a process of its own, which ends with its status. */
static void make(const entry *e, int argument, int choice) {
  int picked[MOST] = {0}, ended = 0;
  double value = NAN;
  int ends[2];
  if (pipe(ends) != 0) return;
  if (argument >= 0) picked[argument] = choice;
  fflush(stdout);
  const pid_t child = fork();
  if (child == 0) {
    alarm(SECONDS);
    const int status = e->call(picked);
    if (explain && status > 0) printf("%s: %s\n", e->name, mps_last_error()->message);
    fflush(stdout);
    (void)!write(ends[1], &returned, sizeof returned);
    _exit(status < 0 ? 100 : status);
  }
  (void)close(ends[1]);
  (void)!read(ends[0], &value, sizeof value);
  (void)close(ends[0]);
  if (child < 0 || waitpid(child, &ended, 0) != child) return;
  static const char *const names[] = {
#define NAME(name, value, text) [value] = #name,
      MPS_STATUS_TABLE(NAME)
#undef NAME
  };
  const int status = WEXITSTATUS(ended);
  printf("%s(", e->name);
  if (argument >= 0) print_choice(e, argument, choice);
  printf(") ");
  if (!WIFEXITED(ended))
    printf("SIGNAL_%d\n", WTERMSIG(ended));
  else if (status == 100 && argument == 0 && e->kinds[0] == HANDLE)
    printf("RETURNED=%g\n", value);
  else if (status == 100)
    printf("RETURNED\n");
  else
    printf("%s\n", status < (int)(sizeof names / sizeof *names) ? names[status] : "UNKNOWN");
  (void)unlink("density");
  (void)unlink("no such name");
}

int main(int arguments, char **argument) {
  const double lower[2] = {0.0, 0.0}, upper[2] = {1.0, 1.0};
  mps_particles_def def = mps_particles_defaults();
  (void)bits;
  explain = arguments > 1 && strcmp(argument[1], "explain") == 0;
  brief = arguments > 1 && strcmp(argument[1], "brief") == 0;
  memset(scenes, 0, sizeof scenes);
  for (int k = 0; k < SCENES; k++)
    if (scene_make(&scenes[k], k) != MPS_OK) printf("scene %s %s\n", scene_names[k], mps_last_error()->message);
  mps_context *context = scenes[SCENE_MPM].context;
  def.spacing = 0.25;
  if (mps_particles_create(context, &def, &set) != MPS_OK || mps_particles_fill_box(set, lower, upper, NULL) != MPS_OK ||
      mps_particles_set(set, "density", 0, 1800.0) != MPS_OK || mps_particles_set(set, "young", 0, 1e6) != MPS_OK ||
      mps_particles_set(set, "poisson", 0, 0.25) != MPS_OK || mps_particles_set(set, "shear_velocity", 0, 100.0) != MPS_OK ||
      mps_particles_set(set, "pressure_velocity", 0, 200.0) != MPS_OK || mps_body_create_disc(context, NULL, 1.0, &body) != MPS_OK ||
      mps_kernel_create(context, MPS_KERNEL_SPLINE3, 0.2, &kernel) != MPS_OK ||
      mps_solver_snapshot(scenes[SCENE_MPM].solver, &snapshot) != MPS_OK)
    printf("objects %s\n", mps_last_error()->message);
  for (const entry *e = entries; e < entries + sizeof entries / sizeof *entries; e++) {
    make(e, -1, 0);
    for (int a = 0; a < e->count && !explain; a++)
      for (int c = 1; c < choice_count(e, a); c++) make(e, a, c);
  }
  mps_snapshot_destroy(&snapshot);
  mps_kernel_destroy(&kernel);
  mps_body_destroy(&body);
  mps_particles_destroy(&set);
  for (int k = 0; k < SCENES; k++) scene_drop(&scenes[k]);
  return 0;
}
