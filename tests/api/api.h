/* api.h - a random caller of the public interface: common declarations.
 *
 * A seed makes a sequence of calls on all objects and solvers of include/mps. Every call has a
 * mood: valid arguments, arguments at the edge of what is allowed, or absurd ones. After each call
 * the caller checks the rules for all calls (check.c): a known status, a record of every error,
 * nothing changed by a call that failed, nothing that is not finite after one that did not.
 *
 *   random.c    numbers and arguments by mood; each writes itself to the line of the call
 *   arena.c     the existing objects, by kind
 *   state.c     the state of each object, in parts that have names and hashes
 *   check.c     before and after a call
 *   names.c     the arguments of each function, from the headers
 *   plan.h      what the callbacks of a call do
 *   callbacks.c the callbacks: memory, hooks of a context, laws, signals, solvers
 *   hooks.c     their faults, drawn before a call
 *   record.c    writes the calls as a C program; its wrappers are made by make_record.py
 *   calls_*.c   one function for each function of the interface, in tables
 *   table.c     all tables; names that are deliberately in none
 *   main.c      seeds, shrinking, the command line
 * SPDX-License-Identifier: BSD-3-Clause */
#ifndef TESTS_API_API_H
#define TESTS_API_API_H

#include "plan.h"

#include <setjmp.h>
#include <stdatomic.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#define API_PRINTF(text, first) __attribute__((format(printf, text, first)))

typedef enum api_kind {
  API_CONTEXT,
  API_SET,
  API_SIGNAL,
  API_MATERIAL,
  API_KERNEL,
  API_BODY,
  API_CONTACT,
  API_NEIGHBOURS,
  API_COUPLING,
  API_DOMAIN,
  API_RECORDER,
  API_SNAPSHOT,
  API_MPM,
  API_DYNAMICS,
  API_ELASTIC,
  API_FLUID,
  API_WAVES,
  API_ABSORBER,
  API_HISTORY,
  API_KINDS,
  API_NOTHING = API_KINDS /* a call that needs no object */
} api_kind;

enum {
  API_SLOTS = 5,   /* objects of a kind that exist at once */
  API_PARTS = 96,  /* of an object's state */
  API_EDITS = 3,   /* fields of a set open at once */
  API_LINES = 20,  /* calls that a report shows */
  API_LINE = 1500, /* characters of one */
  API_MOST = 60    /* particles of a set, about */
};

typedef struct api_part {
  char name[44];
  bool finite, open; /* open: a field that is being written, which may hold anything */
  uint64_t hash;
} api_part;

typedef struct api_object {
  void *handle;    /* NULL: the slot is free */
  int context;     /* slot of the context that it was made from; -1: that has been destroyed */
  uint64_t serial; /* of all objects ever made; the latest has the highest */
  uint64_t owner;  /* of a contact or snapshot: the solver's serial */
  double contrast; /* of an elastic body, the highest so far (state.c); 0: none */
  bool exact;      /* an elastic body whose scheme has no energy but that of rounding */
  bool loose;      /* a solver whose energies need not add up (calls_solver.h) */
  bool rewritten;  /* explicit dynamics: its set's motion has been edited, and restarts */
  bool drags;      /* nor need its momentum: it is damped, or driven by displacements */
  int part_count;
  api_part parts[API_PARTS];
  mps_edit edits[API_EDITS]; /* of a set; data NULL: none */
  char edited[API_EDITS][48];
} api_object;

typedef enum api_mood { API_VALID, API_EDGE, API_ABSURD } api_mood;

/* Changes that a failed call, or a query, may make. */
typedef enum api_change {
  API_CHANGES_NOTHING,
  API_CHANGES_PLACES, /* the particles are sorted: order and epoch */
  API_CHANGES_ORDER,  /* and so the last bits of sums; edits are read: what follows from them */
  API_CHANGES_ALL
} api_change;

typedef struct api {
  api_plan plan; /* of the callbacks of the present call */

  /* the sequence */
  uint64_t seed, random;
  int64_t call; /* number of the present call */
  int32_t threads;
  int32_t dim;          /* of the scene */
  bool verbose, steady; /* steady: no refused allocations, whose number depends on the threads */
  bool pushed;          /* loads or contacts have been given, whose impulses are in no reaction */
  bool lost;            /* a callback has returned MPS_ERROR_INTERNAL, which domains keep */
  uint64_t digest;      /* of all statuses and states so far */
  jmp_buf failed;
  char reason[400]; /* what is broken; "" nothing */

  /* the present call */
  const char *name;
  api_mood mood;
  bool latest; /* objects are the latest ones: a scene is being built */
  int wrong;   /* arguments that no function may take */
  const char *wrong_name;
  bool picked;         /* the first object, whose context gets the record */
  int context;         /* its slot; -1 none */
  bool own_record;     /* an error is what the caller gave: it has no record */
  api_change change;   /* on an error */
  bool reads, queries; /* changes nothing whatever the outcome; has no status */
  size_t length;
  char line[API_LINE];

  char lines[API_LINES][API_LINE];
  int64_t line_count;

  api_memory memory;
  uint64_t serials;
  api_object objects[API_KINDS][API_SLOTS];
  char folder[256]; /* for files */
} api;

/* ---- random.c: arguments; `name` as in the header ------------------------------------------- */
uint64_t api_mix(uint64_t x);
uint64_t api_bits(api *a);
uint32_t api_below(api *a, uint32_t n);
bool api_chance(api *a, int percent);
double api_unit(api *a); /* in [0, 1) */
/* An argument that no function may take was drawn. */
void api_wrong(api *a, const char *name);
/* In [lo, hi], `typical` being of ordinary size; outside in an absurd mood. */
double api_real(api *a, const char *name, double lo, double hi, double typical);
/* The same, and in an absurd mood NaN, which stands for the default and is not wrong. */
double api_real_or_nan(api *a, const char *name, double lo, double hi, double typical);
/* Mostly NaN, which stands for the default. */
double api_optional(api *a, const char *name, double lo, double hi, double typical);
/* Finite; ordinarily within `width` of `centre`. */
double api_near(api *a, const char *name, double centre, double width);
void api_vector(api *a, const char *name, int count, double centre, double width, double *out);
/* In [lo, hi], both allowed. */
int64_t api_whole(api *a, const char *name, int64_t lo, int64_t hi);
/* At least lo, ordinarily at most hi. */
int64_t api_least(api *a, const char *name, int64_t lo, int64_t hi);
/* Of an enumeration with values 0 to count - 1. */
int32_t api_choice(api *a, const char *name, int32_t count);
/* Draws members of a definition, "young 1e6, lode, slip? 0.1, ...", each beside the value behind
 * its name (without one: any) in the range of its table, in an absurd mood outside. One with ? keeps
 * its default most of the time; an array gets the value in component `dim` - 1 or, where all are
 * alike, everywhere. Wrong is what the tables refuse: other members are set before. */
void api_define(api *a, int32_t kind, void *def, int32_t dim, const char *members);
/* struct_size of a definition of `size` bytes. */
uint32_t api_struct_size(api *a, size_t size);
/* Bytes of a definition that is to be filled, which has room for 4096. */
size_t api_size_of(api *a, size_t size);
/* Is this pointer to be NULL although it must not be? */
bool api_null(api *a, const char *name);
/* Name of a field: one that the set has, one of the library's table, or none. */
const char *api_field(api *a, mps_particles *set);
/* Writes ids: of the set's particles, in an absurd mood others too, or one twice. */
int64_t api_ids(api *a, mps_particles *set, int64_t most, int64_t *ids);
/* Adds text to the line of the call. */
void api_say(api *a, const char *format, ...) API_PRINTF(2, 3);

/* ---- arena.c --------------------------------------------------------------------------------- */
extern const char *const api_kind_names[API_KINDS];
/* An existing object, or one whose handle is NULL. */
api_object *api_any(api *a, api_kind kind);
/* The same where NULL is allowed. */
void *api_maybe(api *a, api_kind kind, const char *name);
/* A signal or NULL: a number or a motion as the definition wants it, but in an absurd mood. */
mps_signal *api_signal(api *a, bool number);
int api_alive(const api *a, api_kind kind);
/* Registers the object made by a function (NULL: none). */
api_object *api_adopt(api *a, api_kind kind, void *handle, int context, const api_object *owner);
/* Stresses have been written, which some laws replace: energies of WLS-MPM need not add up. */
void api_loosen(api *a);
/* A field of motion, or moduli, have been written, of any set. */
void api_rewrite(api *a, const char *field);
void api_forget(api *a, api_object *object);
/* Calls the destroy function of the kind. */
void api_destroy(api_kind kind, void **handle);
void api_clear(api *a);
mps_context *api_context(api *a); /* any, with its record to be looked at */

/* ---- state.c --------------------------------------------------------------------------------- */
/* Reads the state of an object into parts. */
int api_look(api *a, api_kind kind, api_object *object, api_part *parts);

/* ---- check.c --------------------------------------------------------------------------------- */
void api_begin(api *a, const char *name);
bool api_end(api *a, mps_status status);
/* Bytes that the caller has for a result of `size`. */
size_t api_size(api *a, size_t size);
void api_check_room(api *a, const void *room, size_t all, size_t size, size_t most,
                    mps_status status);
/* After a function that has no status; the second, where it changes something. */
void api_end_changed(api *a);
void api_end_query(api *a);
/* Broken rule, for the report of this call. */
void api_broken(api *a, const char *format, ...) API_PRINTF(2, 3);
/* Ends a call that makes an object, and takes that over. */
bool api_end_made(api *a, mps_status status, api_kind kind, void *made, const api_object *owner);
void api_count(const char *name, mps_status status);
void api_settle(api *a); /* ends the sequence where something is broken */
void api_print_log(const api *a, int descriptor);

/* ---- names.c --------------------------------------------------------------------------------- */
/* Whether the message has the name of a parameter of the function, or of a member of one. */
bool api_names_argument(const char *function, const char *message);
/* The name under which a function of one solver is exported where all solvers share it
 * (mps/solver.h): mps_solver_step for mps_mpm_step; else `name`. */
void api_shared_name(const char *name, char *shared, size_t size);
/* Does it refuse a value that, as it is printed, is within the bounds that it gives? */
bool api_prints_allowed(const char *message);

/* ---- hooks.c --------------------------------------------------------------------------------- */
void api_hooks(api *a, mps_context_def *def);
void api_arm(api *a);
void api_run_solver(api *a, api_kind kind, api_object *object);

/* ---- record.c: the sequence as a C program (of builds without Python: nothing) ----------------
 */
#ifdef API_FOLDER
bool api_record_begin(const api *a, const char *path);
/* A file that the test has written. */
void api_record_file(const char *path, const void *bytes, size_t size);
void api_record_end(void);
void api_record_crash(void); /* from a handler of signals */
#else
static inline bool api_record_begin(const api *a, const char *path) { return (void)a, !path; }
static inline void api_record_file(const char *path, const void *bytes, size_t size) {
  (void)path, (void)bytes, (void)size;
}
static inline void api_record_end(void) {}
static inline void api_record_crash(void) {}
#endif

/* ---- table.c --------------------------------------------------------------------------------- */
typedef struct api_call {
  const char *name;
  int weight; /* 0: called by others of the table */
  api_kind needs;
  void (*call)(api *a);
} api_call;

/* Begins a call of the table and makes it. What a function calls besides it begins by api_begin. */
void api_make(api *a, const api_call *call);

typedef struct api_table {
  const api_call *calls;
  int count;
} api_table;

extern const api_table *const api_tables[];
extern const int api_table_count;
/* Compares the tables with the names of a linker map; 0 when none is missing or unknown. */
int api_check_names(const char *map);
/* Objects of a scene, by valid calls. */
void api_scene(api *a);
void api_do(api *a, const char *name); /* the call of that name */
void api_print_counts(void);

/* A query of a number of one object. */
#define API_QUERY(function, kind)                                                                  \
  static void query_##function(api *a) {                                                           \
    (void)mps_##function(api_any(a, kind)->handle);                                                \
    api_end_query(a);                                                                              \
  }
/* Releases the caller's reference. */
#define API_DESTROY(function, kind)                                                                \
  static void destroy_##function(api *a) {                                                         \
    api_object *o = api_any(a, kind);                                                              \
    api_destroy(kind, &o->handle);                                                                 \
    if (o->handle) api_broken(a, "has not nulled");                                                \
    api_forget(a, o);                                                                              \
    api_end_changed(a);                                                                            \
  }
/* Writes at most the bytes that the caller has: the call reads `size` and `room`. */
#define API_SIZED(a, type, size, room)                                                             \
  type room[4];                                                                                    \
  memset(room, 0x5a, sizeof room);                                                                 \
  const size_t size = api_size(a, sizeof(type))
#define API_SIZED_END(a, status, size, room, reads_only)                                           \
  do {                                                                                             \
    api_check_room(a, room, sizeof room, size, sizeof room[0], status);                            \
    (a)->reads = reads_only;                                                                       \
    (void)api_end(a, status);                                                                      \
  } while (0)

/* static void name(api *a): the result `type` of a handle, by get(handle, out, size). */
#define API_GETTER(name, get, kind, object, type)                                                  \
  static void name(api *a) {                                                                       \
    object *handle = api_any(a, kind)->handle;                                                     \
    API_SIZED(a, type, size, out);                                                                 \
    const mps_status status = get(handle, api_null(a, "out") ? NULL : out, size);                  \
    API_SIZED_END(a, status, size, out, true);                                                     \
  }

#define API_TABLE(calls)                                                                           \
  { calls, (int)(sizeof calls / sizeof *calls) }
#define API_COUNT(array) ((int)(sizeof array / sizeof *array))

#endif
