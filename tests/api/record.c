/* record.c - writes the calls of a sequence as a C program on the public headers that makes them
 * again and compares the statuses. Lengths of arrays are not known here: as much is written as an
 * integer of the call may mean, and can be read. SPDX-License-Identifier: BSD-3-Clause */
#define _GNU_SOURCE /* process_vm_readv */
#include "record_private.h"

#include "api.h"

#include <inttypes.h>
#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/uio.h>
#include <unistd.h>

enum { MOST_OBJECTS = 20000, MOST_ARRAYS = 32, MOST_VALUES = 3000, MOST_EDITS = 2000 };

static FILE *file; /* NULL: nothing is written */
static const api *sequence;
static int calls, depth, edits_made;
static long long most; /* of the integers of the call */
static const void *known[MOST_OBJECTS];
static int objects, place;
static const void *arrays[MOST_ARRAYS];
static int array_count;
static const void *edits[MOST_EDITS];
static int edit;

static void say(const char *format, ...) API_PRINTF(1, 2);
static void say(const char *format, ...) {
  va_list arguments;
  va_start(arguments, format);
  (void)vfprintf(file, format, arguments);
  va_end(arguments);
}

/* ---- values ---------------------------------------------------------------------------------- */

void rec_real(double value) {
  if (isnan(value))
    say("NAN");
  else if (isinf(value))
    say(value > 0.0 ? "INFINITY" : "-INFINITY");
  else
    say("%a", value);
}

void rec_whole(long long value) {
  if (value == INT64_MIN)
    say("INT64_MIN");
  else
    say("%lld", value);
}

/* The folder of the files becomes the program's working directory. */
void rec_text(const char *text) {
  if (!text) {
    say("NULL");
    return;
  }
  const size_t length = strlen(sequence->folder);
  if (strncmp(text, sequence->folder, length) == 0) {
    say("\".");
    text += length;
  } else {
    say("\"");
  }
  for (const unsigned char *c = (const unsigned char *)text; *c; c++)
    if (*c == '"' || *c == '\\' || *c < 32 || *c > 126 || *c == '?')
      say("\\%03o", *c);
    else
      say("%c", *c);
  say("\"");
}

/* As many bytes as can be read, at most `size`; a page beyond the stack or the heap is no fault. */
static size_t peek(const void *from, void *to, size_t size) {
  size_t done = 0;
  while (done < size) { /* not across the end of a page that is there */
    char *const at = (char *)(uintptr_t)from + done;
    const size_t page = 4096 - (uintptr_t)at % 4096, part = page < size - done ? page : size - done;
    const struct iovec own = {(char *)to + done, part}, other = {at, part};
    if (process_vm_readv(getpid(), &own, 1, &other, 1, 0) != (ssize_t)part) break;
    done += part;
  }
  return done;
}

static long long guess(void) {
  const long long count = most > 0 && most <= MOST_VALUES / 9 ? 9 * most : 0;
  return count > 64 ? count : 64;
}

void rec_texts(const char *const *texts, int unused) {
  const char *some[8];
  (void)unused;
  const size_t read = texts ? peek(texts, some, sizeof some) / sizeof *some : 0;
  if (!texts) {
    say("NULL");
    return;
  }
  say("(const char *const[]){");
  for (size_t k = 0; k < read && (long long)k < most + 1; k++) {
    char head[2];
    if (!some[k] || peek(some[k], head, 1) != 1 || k >= 4) break;
    rec_text(some[k]);
    say(", ");
  }
  say("NULL}");
}

void rec_array(const char *type, const void *values, size_t size, int real) {
  static union {
    double real[MOST_VALUES];
    int64_t whole[MOST_VALUES];
    int32_t half[MOST_VALUES];
  } u;
  if (!values || array_count == MOST_ARRAYS) return;
  for (int k = 0; k < array_count; k++)
    if (arrays[k] == values) return;
  const long long wanted = guess();
  const long long read = (long long)(peek(values, &u, (size_t)wanted * size) / size);
  say("  static %s array_%d_%d[%lld] = {", type, calls, array_count, wanted > read ? wanted : read);
  arrays[array_count++] = values;
  for (long long k = 0; k < read; k++) {
    if (real)
      rec_real(u.real[k]);
    else
      rec_whole(size == 8 ? u.whole[k] : u.half[k]);
    say(k % 8 == 7 ? ",\n    " : ", ");
  }
  say("};\n");
}

int rec_structs(const char *type, const void *values, void *copy, size_t size) {
  if (!values || array_count == MOST_ARRAYS) return 0;
  const int read = (int)(peek(values, copy, size * (size_t)(most > 8 ? 8 : most)) / size);
  if (read == 0) return 0;
  say("  static %s array_%d_%d[] = {", type, calls, array_count);
  arrays[array_count++] = values;
  return read;
}

void rec_brace(void) { say("{"); }
void rec_unbrace(void) { say("}, "); }

void rec_name_array(const void *values) {
  for (int k = 0; k < array_count; k++)
    if (values && arrays[k] == values) {
      say("array_%d_%d", calls, k);
      return;
    }
  say("NULL");
}

/* ---- objects --------------------------------------------------------------------------------- */

static int find(const void *object) {
  for (int k = objects - 1; k >= 0; k--)
    if (known[k] == object) return k;
  return -1;
}

void rec_object(const void *object) {
  const int k = object ? find(object) : -1;
  if (k >= 0)
    say("o[%d]", k);
  else
    say("NULL");
}

void rec_place(const char *type, const void *object, bool there) {
  place = object ? find(object) : -1;
  if (there && place < 0 && objects < MOST_OBJECTS) known[place = objects++] = NULL;
  if (there && place >= 0)
    say("(%s **)&o[%d]", type, place);
  else
    say("NULL");
}

void rec_made(const void *object, bool there) {
  if (there && place >= 0) known[place] = object;
}

void rec_result(const void *object) {
  if (object && find(object) < 0) known[place] = object;
}

static const struct {
  const char *name;
  rec_any function;
} functions[] = {
#define ROW(name)                                                                                  \
  { #name, (rec_any)name }
    ROW(api_get_memory),
    ROW(api_return_memory),
    ROW(api_write_log),
    ROW(api_show_progress),
    ROW(api_cancel),
    ROW(api_count_unit),
    ROW(api_law),
    ROW(api_umat),
    ROW(api_motion),
    ROW(api_number),
    ROW(api_inside_disc),
    ROW(api_flat),
    ROW(api_some_stress),
    ROW(api_traction),
    ROW(api_linear_matrix),
    ROW(api_linear_solve),
    ROW(api_linear_forget),
    ROW(api_rendezvous),
    ROW(api_star_create),
    ROW(api_star_begin),
    ROW(api_star_end),
    ROW(api_star_destroy),
    ROW(api_reduce_max),
    ROW(api_reduce_sum),
    ROW(api_in_run_mpm),
    ROW(api_in_run_dynamics),
    ROW(api_in_run_elastic),
    ROW(api_in_run_fluid)};

void rec_function(rec_any function) {
  for (int k = 0; k < API_COUNT(functions); k++)
    if (functions[k].function == function) {
      say("%s", functions[k].name);
      return;
    }
  say("NULL");
}

void rec_user(const void *user) {
  if (!user)
    say("NULL");
  else if (user == &sequence->plan)
    say("&plan");
  else if (user == &sequence->memory)
    say("&memory");
  else
    say("room[15]");
}

/* ---- structs --------------------------------------------------------------------------------- */

void rec_open(int argument, const char *type) { say("  %s struct_%d = {", type, argument); }
void rec_close(void) { say("};\n"); }
void rec_member(const char *name) { say(".%s = ", name); }
void rec_element(const char *name, int index, int dimensions) {
  if (dimensions == 1)
    say(".%s[%d] = ", name, index);
  else
    say(".%s[%d][%d] = ", name, index / 3, index % 3); /* the public ones have three columns */
}
void rec_next(void) { say(", "); }
void rec_argument(int argument, bool there) { say(there ? "&struct_%d" : "NULL", argument); }
void rec_room(int argument, bool there) { say(there ? "(void *)room[%d]" : "NULL", argument); }
void rec_count(long long count) { most = count > most && count < 1000000 ? count : most; }

/* ---- edits ----------------------------------------------------------------------------------- */

void rec_find_edit(const void *data, int fresh) {
  edit = -1;
  for (int k = edits_made - 1; k >= 0 && data && !fresh && edit < 0; k--)
    if (edits[k] == data) edit = k;
  if (fresh && edits_made < MOST_EDITS) edits[edit = edits_made++] = NULL;
}

void rec_edit(bool there) {
  if (there)
    say("&edits[%d]", edit >= 0 ? edit : MOST_EDITS - 1);
  else
    say("NULL");
}

void rec_keep_edit(const void *data) {
  if (edit >= 0) edits[edit] = data;
}

/* What has been written into the field since it was opened. */
void rec_fill_edit(const mps_view *view, const void *data) {
  if (edit < 0 || !data || view->dtype.bits != 64) return;
  for (int64_t i = 0; i < view->shape[0]; i++)
    for (int64_t c = 0; c < view->shape[1]; c++) {
      const char *at = (const char *)data + 8 * (i * view->stride[0] + c * view->stride[1]);
      int64_t bits;
      if (peek(at, &bits, sizeof bits) != sizeof bits) return;
      say("  fill(%d, %" PRId64 ", %" PRId64 ", INT64_C(0x%016" PRIx64 "));\n", edit, i, c,
          (uint64_t)bits);
    }
}

/* ---- calls ----------------------------------------------------------------------------------- */

bool rec_begin(const char *name) {
  if (!file || depth > 0) return false;
  calls++;
  array_count = 0;
  most = 0;
  say("static void call_%d(void) { /* %s */\n", calls, name);
  return true;
}

/* The plan of the callbacks and of refused memory, counted from this call. */
static void say_plan(void) {
  const api_plan *p = &sequence->plan;
  const long long from = atomic_load(&sequence->memory.refuse_from);
  const long long to = atomic_load(&sequence->memory.refuse_to);
  const long long now = atomic_load(&sequence->memory.calls);
  say("  begin((api_plan){.fault = %d, .at = %" PRId64
      ", .status = %d, .choice = %u, .kind = %d, .cancel_at = %" PRId64 ", .solver = ",
      (int)p->fault, p->at, (int)p->status, p->choice, (int)p->kind, p->cancel_at);
  rec_object(p->solver);
  say("}, %lld, %lld);\n", from > 0 ? from - now : 0, to == INT64_MAX ? to : to - now);
}

void rec_call_status(const char *name) {
  say_plan();
  say("  got[%d] = (int)%s(", calls, name);
}

void rec_call_object(const char *name) {
  say_plan();
  place = objects < MOST_OBJECTS ? objects++ : 0;
  known[place] = NULL;
  say("  o[%d] = (void *)%s(", place, name);
}

void rec_call_other(const char *name) {
  say_plan();
  say("  (void)%s(", name);
}

void rec_comma(void) { say(", "); }

/* The text is complete before the call, which may not return. */
void rec_end_call(void) {
  say(");\n  atomic_store(&memory.refuse_from, 0);\n}\n");
  say("static const char *const name_%d = ", calls);
  (void)fflush(file);
}

void rec_enter(void) { depth++; }
void rec_leave(void) { depth--; }

static int wanted[100000];

void rec_status(mps_status status) {
  if (calls < API_COUNT(wanted)) wanted[calls] = (int)status;
}

void rec_finish(void) {
  say("\"%s\";\n", sequence->name);
  (void)fflush(file);
}

void api_record_file(const char *path, const void *bytes, size_t size) {
  if (!file) return;
  calls++;
  say("static void call_%d(void) { /* a file */\n  static const unsigned char bytes[] = {", calls);
  for (size_t k = 0; k < size; k++)
    say("%u,%s", ((const unsigned char *)bytes)[k], k % 20 == 19 ? "\n    " : " ");
  say("0};\n  FILE *file = fopen(");
  rec_text(path);
  say(", \"wb\");\n  if (file) (void)!fwrite(bytes, 1, %zu, file), (void)fclose(file);\n}\n", size);
  say("static const char *const name_%d = \"file\";\n", calls);
  if (calls < API_COUNT(wanted)) wanted[calls] = 0;
}

/* ---- the program ----------------------------------------------------------------------------- */

/* A file of tests/api, without the lines that include its own headers. */
static void copy(const char *name) {
  char path[400], line[400];
  snprintf(path, sizeof path, "%s/%s", API_FOLDER, name);
  FILE *from = fopen(path, "r");
  if (!from) return;
  while (fgets(line, sizeof line, from))
    if (strncmp(line, "#include \"", 10) != 0) (void)fputs(line, file);
  (void)fclose(from);
}

bool api_record_begin(const api *a, const char *path) {
  file = fopen(path, "w");
  sequence = a;
  if (!file) return false;
  say("/* Seed %" PRIu64
      " of the random caller of libmps, on %d threads: its calls, one function each. Each\n"
      " * prints its status where that is another than it was. Run it in an empty folder.\n"
      " *   cc -std=c11 THIS.c $(pkg-config --cflags --libs libmps) -lm -lpthread */\n",
      a->seed, (int)a->threads);
  say("#define _POSIX_C_SOURCE 200809L\n#define MPS_EXPERIMENTAL\n#include "
      "<mps/experimental.h>\n#include "
      "<stdio.h>\n");
  copy("plan.h");
  copy("callbacks.c");
  say("static api_plan plan;\nstatic api_memory memory;\nstatic void *o[%d];\n"
      "static _Alignas(64) char room[16][1 << 20];\nstatic mps_edit edits[%d];\nstatic int "
      "got[100000];\n",
      MOST_OBJECTS, MOST_EDITS);
  say("static void begin(api_plan next, long long from, long long to) {\n"
      "  const long long now = atomic_load(&memory.calls);\n  plan = next;\n"
      "  atomic_store(&memory.refuse_to, to == INT64_MAX ? to : now + to);\n"
      "  atomic_store(&memory.refuse_from, from > 0 ? now + from : 0);\n}\n"
      "static void fill(int k, int64_t i, int64_t c, int64_t bits) {\n"
      "  const mps_view *v = &edits[k].view;\n"
      "  if (edits[k].data && i < v->shape[0] && c < v->shape[1])\n"
      "    memcpy((char *)edits[k].data + 8 * (i * v->stride[0] + c * v->stride[1]), &bits, "
      "8);\n}\n");
  return true;
}

void api_record_end(void) {
  if (!file) return;
  say("\nstatic const struct {\n  void (*call)(void);\n  const char *const *name;\n  int wanted;\n"
      "} sequence[] = {\n");
  for (int k = 1; k <= calls; k++)
    say("  {call_%d, &name_%d, %d},\n", k, k, k < API_COUNT(wanted) ? wanted[k] : 0);
  say("};\n\nint main(void) {\n  int others = 0;\n"
      "  for (int k = 0; k < (int)(sizeof sequence / sizeof *sequence); k++) {\n"
      "    sequence[k].call();\n"
      "    if (plan.broken) printf(\"%%d %%s: %%s\\n\", k + 1, *sequence[k].name, plan.broken);\n"
      "    if (got[k + 1] == sequence[k].wanted) continue;\n"
      "    printf(\"%%d %%s: %%d, was %%d\\n\", k + 1, *sequence[k].name, got[k + 1], "
      "sequence[k].wanted);\n"
      "    others++;\n  }\n"
      "  printf(\"%%d of %d calls return another status\\n\", others);\n  return others != 0;\n}\n",
      calls);
  (void)fclose(file);
  file = NULL;
}

/* From a handler of signals: the name of the call that does not return. */
void api_record_crash(void) {
  if (!file) return;
  say("\"%s\";\n", sequence->name);
  api_record_end();
}
