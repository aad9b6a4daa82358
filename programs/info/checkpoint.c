/* checkpoint.c - contents of a checkpoint of libmps, and how to restart from it.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "info.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* The program that wrote it, by the first word of the key; "" where that is of no program of
 * libmps. */
static void program_of(const char *key, char *program, size_t size) {
  snprintf(program, size, "%.*s", (int)strcspn(key, " "), key);
  if (strncmp(program, "mps-", 4) != 0) program[0] = '\0';
}

/* Lines "name=value" at the start of the user data, which the programs keep there; NULL where they
 * are something else. */
static char *options_of(const mps_checkpoint *info) {
  char *text = info->user_data;
  if (!text || info->user_bytes < 1 || !memchr(text, '\0', (size_t)info->user_bytes)) return NULL;
  for (const char *line = text; *line; line += strcspn(line, "\n") + 1) {
    const size_t name = strcspn(line, "=\n");
    if (line[name] != '=' || strcspn(line, "\n") == strlen(line) || name == 0) return NULL;
  }
  return *text ? text : NULL;
}

static void print_options(report *r, const char *options) {
  report_list(r, "options");
  for (const char *line = options; *line; line += strcspn(line, "\n") + 1) {
    char name[48], value[600];
    const size_t length = strcspn(line, "=");
    snprintf(name, sizeof name, "%.*s", (int)length, line);
    snprintf(value, sizeof value, "%.*s", (int)strcspn(line + length + 1, "\n"), line + length + 1);
    report_row(r, name, value);
  }
  report_list_end(r);
}

/* Values that mps_S_restore compares, and the numbers of the run: attributes of the group `solver`.
 */
typedef struct printing {
  report *r;
  bool any;
} printing;

static herr_t print_attribute(hid_t object, const char *name, const H5A_info_t *about, void *user) {
  printing *p = user;
  char text[80];
  double number;
  int64_t integer;
  (void)about;
  if (strcmp(name, "name") == 0 || strcmp(name, "time") == 0 || strcmp(name, "steps") == 0)
    return 0;
  if (info_integer(object, name, &integer))
    snprintf(text, sizeof text, "%lld", (long long)integer);
  else if (info_number(object, name, &number))
    snprintf(text, sizeof text, "%.9g", number);
  else if (!info_text(object, name, text, sizeof text))
    return 0;
  if (!p->any) report_list(p->r, "solver");
  p->any = true;
  report_row(p->r, name, text);
  return 0;
}

static void print_solver(report *r, hid_t solver) {
  printing p = {.r = r};
  hsize_t at = 0;
  (void)H5Aiterate2(solver, H5_INDEX_NAME, H5_ITER_INC, &at, print_attribute, &p);
  if (p.any) report_list_end(r);
}

/* The function that restores a solver, by the name in the file; "" for an unknown one. */
static const char *restore_of(const char *solver) {
  static const char *const known[][2] = {{"WLS-MPM", "mps_mpm_restore"},
                                         {"fluid", "mps_fluid_restore"},
                                         {"explicit dynamics", "mps_dynamics_restore"},
                                         {"implicit elasticity", "mps_elastic_restore"}};
  for (size_t k = 0; k < sizeof known / sizeof *known; k++)
    if (strcmp(solver, known[k][0]) == 0) return known[k][1];
  return "";
}

static void print_needs(report *r, const char *path, const char *program, const char *solver) {
  char line[600];
  if (program[0])
    snprintf(line, sizeof line, "%s --restart %.400s, with the same options", program, path);
  else if (restore_of(solver)[0])
    snprintf(line, sizeof line,
             "%s, with the set, the solver and what was added to it made as before",
             restore_of(solver));
  else if (solver[0])
    snprintf(line, sizeof line, "a newer libmps: this one has no solver of that name");
  else
    snprintf(line, sizeof line, "mps_checkpoint_read, with a set of the same particles");
  report_text(r, r->json ? "to_go_on" : "to go on", line);
}

static void print(report *r, const char *path, hid_t file, const mps_checkpoint *info,
                  const info_fields *fields, hid_t solver) {
  char library[40], name[64] = "", program[64], sentence[200];
  int64_t count = 0, dim = 0;
  double spacing = 0.0;
  const char *options = options_of(info);
  info_text(file, "library", library, sizeof library);
  if (solver >= 0) info_text(solver, "name", name, sizeof name);
  program_of(info->user_key, program, sizeof program);
  snprintf(sentence, sizeof sentence, "checkpoint of %s, written by libmps %s",
           program[0] ? program
           : name[0]  ? name
                      : "a particle set",
           library);
  report_begin(r, path, "checkpoint", sentence);
  if (r->json) report_text(r, "version", library);
  if (r->json || (!program[0] && info->user_key[0])) report_text(r, "key", info->user_key);
  if (name[0]) report_text(r, r->json ? "solver_name" : "solver", name);
  report_number(r, r->json ? "time_s" : "time", info->time, "s");
  report_integer(r, "step", info->step);
  report_number(r, r->json ? "dt_s" : "dt", info->dt, "s");
  if (info_integer(file, "particles", &count)) report_integer(r, "particles", count);
  if (info_integer(file, "dim", &dim)) report_integer(r, "dimensions", dim);
  if (info_number(file, "spacing", &spacing))
    report_number(r, r->json ? "spacing_m" : "spacing", spacing, "m");
  report_integer(r, r->json ? "user_bytes" : "user bytes", info->user_bytes);
  print_needs(r, path, program, name);
  if (options) print_options(r, options);
  if (solver >= 0) print_solver(r, solver);
  report_list(r, "fields");
  for (hsize_t k = 0; k < fields->count; k++)
    report_row(r, fields->field[k].name, fields->field[k].text);
  report_list_end(r);
  report_end(r);
}

bool info_checkpoint(report *r, mps_context *context, const char *path, hid_t file, char *why) {
  mps_checkpoint info = mps_checkpoint_defaults();
  info_fields fields = {0};
  mps_status status = mps_checkpoint_info(context, path, &info); /* checks that it is whole */
  if (status == MPS_OK && info.user_bytes > 0) {
    info.user_data = malloc((size_t)info.user_bytes);
    info.user_key[0] = '\0';
    status = info.user_data ? mps_checkpoint_info(context, path, &info) : MPS_ERROR_MEMORY;
  }
  if (status != MPS_OK) {
    snprintf(why, INFO_WHY, "%s", mps_context_error(context)->message);
    free(info.user_data);
    return false;
  }
  const hid_t group = H5Gopen2(file, "fields", H5P_DEFAULT);
  const hid_t solver =
      H5Lexists(file, "solver", H5P_DEFAULT) > 0 ? H5Gopen2(file, "solver", H5P_DEFAULT) : -1;
  const bool good = group >= 0 && info_list_fields(group, true, &fields);
  if (good)
    print(r, path, file, &info, &fields, solver);
  else
    snprintf(why, INFO_WHY, "a checkpoint whose fields cannot be listed");
  if (solver >= 0) H5Gclose(solver);
  if (group >= 0) H5Gclose(group);
  free(fields.field);
  free(info.user_data);
  return good;
}
