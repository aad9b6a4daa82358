/* names.c - what the message of an error must say: an argument, which is a parameter of the
 * function as its header declares it or a member of a struct that it takes; and a value that is
 * not, as it is printed, one of those that it calls allowed. SPDX-License-Identifier: BSD-3-Clause
 */
#include "api.h"

#include <ctype.h>
#include <dirent.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { NAME = 64 };

static char headers[1 << 20]; /* all public headers, without comments */

static void read_header(const char *path) {
  FILE *file = fopen(path, "r");
  if (!file) abort();
  size_t length = strlen(headers);
  int last = ' ';
  bool comment = false;
  for (int c = getc(file); c != EOF; c = getc(file)) {
    if (comment) {
      comment = !(last == '*' && c == '/');
      last = comment ? c : ' ';
      continue;
    }
    comment = last == '/' && c == '*';
    if (comment) {
      headers[length - 1] = ' ';
      last = ' ';
      continue;
    }
    if (length + 2 < sizeof headers) headers[length++] = (char)c;
    last = c;
  }
  headers[length] = '\0';
  (void)fclose(file);
}

static void read_folder(const char *name) {
  DIR *folder = opendir(name);
  if (!folder) abort();
  for (const struct dirent *entry; (entry = readdir(folder));) {
    const size_t length = strlen(entry->d_name);
    char path[600];
    if (length < 3 || strcmp(entry->d_name + length - 2, ".h") != 0) continue;
    snprintf(path, sizeof path, "%s/%s", name, entry->d_name);
    read_header(path);
  }
  (void)closedir(folder);
}

static void read_headers(void) {
  read_folder(API_HEADERS);
  read_folder(API_HEADERS "/experimental");
}

static bool in_word(char c) { return isalnum((unsigned char)c) || c == '_'; }

static const char *find_word(const char *text, const char *word) {
  const size_t length = strlen(word);
  for (const char *at = strstr(text, word); at; at = strstr(at + 1, word))
    if ((at == text || !in_word(at[-1])) && !in_word(at[length])) return at;
  return NULL;
}

/* The identifiers of a declaration that end it: before a comma, semicolon, bracket or its end. */
static bool names_one_of(const char *from, const char *to, const char *message) {
  char name[NAME];
  for (const char *at = from; at < to;) {
    if (!in_word(*at) || isdigit((unsigned char)*at)) {
      at++;
      continue;
    }
    const char *end = at;
    while (end < to && in_word(*end)) end++;
    const char *next = end;
    while (next < to && isspace((unsigned char)*next)) next++;
    if ((next == to || strchr(",;[)", *next)) && end - at < NAME) {
      snprintf(name, sizeof name, "%.*s", (int)(end - at), at);
      if (find_word(message, name)) return true;
    }
    at = end;
  }
  return false;
}

/* The body of the struct that `type` is, up to *end; NULL: it has none in a header. */
static const char *body_of(const char *type, const char **end) {
  char head[NAME + 24];
  snprintf(head, sizeof head, "typedef struct %s {", type);
  const char *at = strstr(headers, head);
  if (!at) return NULL;
  at += strlen(head);
  *end = strchr(at, '}');
  return *end ? at : NULL;
}

void api_shared_name(const char *name, char *shared, size_t size) {
  static const char *const solvers[] = {"mps_mpm_", "mps_dynamics_", "mps_elastic_", "mps_fluid_"};
  static const char *const of_a_kind[] = {"add_", "set_", "get_", "remove_"};
  snprintf(shared, size, "%s", name);
  for (int k = 0; k < 4; k++) {
    if (strncmp(name, solvers[k], strlen(solvers[k])) != 0) continue;
    const char *verb = name + strlen(solvers[k]);
    snprintf(shared, size, "mps_solver_%s", verb);
    if (strcmp(verb, "get_def_sized") == 0) snprintf(shared, size, "mps_solver_get_def");
    for (int v = 0; v < 4; v++) { /* mps_mpm_add_load is mps_solver_add */
      const size_t length = strlen(of_a_kind[v]);
      if (strncmp(verb, of_a_kind[v], length) == 0 &&
          (strcmp(verb + length, "boundary") == 0 || strcmp(verb + length, "load") == 0))
        snprintf(shared, size, "mps_solver_%.*s", (int)length - 1, of_a_kind[v]);
    }
  }
}

static const char *parameters_of(const char *function, const char **end) {
  for (const char *at = find_word(headers, function); at; at = find_word(at + 1, function)) {
    const char *open = at + strlen(function);
    if (*open != '(') continue;
    *end = strchr(open, ';');
    return *end ? open + 1 : NULL;
  }
  return NULL;
}

bool api_names_argument(const char *function, const char *message) {
  const char *end = NULL;
  if (!headers[0]) read_headers();
  const char *from = parameters_of(function, &end);
  char shared[NAME + 16];
  api_shared_name(function, shared, sizeof shared);
  if (strcmp(shared, function) != 0 && strcmp(message, "solver is NULL") == 0) return true;
  /* where what was edited before is taken, particles and bodies are named */
  if (strstr(message, "lie inside the body") || strstr(message, "it overlaps body") ||
      strstr(message, "begins outside the yield surface") || strstr(message, "' of particle "))
    return true;
  if (!from) from = parameters_of(shared, &end);
  if (!from || names_one_of(from, end, message)) return from != NULL;
  for (const char *at = from; at < end; at++) {
    char type[NAME];
    const char *stop = NULL;
    if (in_word(at[-1]) || sscanf(at, "%63[a-z0-9_]", type) != 1) continue;
    const char *body = body_of(type, &stop);
    if (body && names_one_of(body, stop, message)) return true;
    /* an object may be named by its kind: "elastic is NULL" of an mps_elastic */
    const size_t kind = strncmp(type, "mps_", 4) == 0 ? strlen(type) - 4 : 0;
    if (kind > 0 && strncmp(message, type + 4, kind) == 0 && message[kind] == ' ') return true;
  }
  return false;
}

/* The number that `*text` begins with, which is moved behind it. "0..9" begins with 0. */
static bool number_at(const char **text, double *value) {
  char *end = NULL, own[48];
  const char *two = strstr(*text, "..");
  const size_t length = two ? (size_t)(two - *text) : strlen(*text);
  snprintf(own, sizeof own, "%.*s", (int)(length < sizeof own ? length : sizeof own - 1), *text);
  const double read = strtod(own, &end);
  if (end == own) return false;
  *value = read;
  *text += end - own;
  return true;
}

static bool skip(const char **text, const char *words) {
  const size_t length = strlen(words);
  if (strncmp(*text, words, length) != 0) return false;
  *text += length;
  return true;
}

/* Is it, as printed, what "must be" asks for? Bounds are "1 to 2", "1..2", ">= 1", "above 1 and at
 * most 2"; of an upper one that is no number, as "the friction angle", nothing is known. */
static bool is_within(const char *text, double value) {
  static const char *const least[] = {">= ", "at least ", "from "}, *const above[] = {"> ",
                                                                                      "above "};
  static const char *const most[] = {"at most ", "<= "}, *const below[] = {"below ", "< "};
  double low = -HUGE_VAL, high = HUGE_VAL, bound = 0.0;
  bool inside = true;
  for (int k = 0; k < 3; k++)
    if (skip(&text, least[k]) && number_at(&text, &low)) inside = value >= low;
  for (int k = 0; k < 2; k++)
    if (skip(&text, above[k]) && number_at(&text, &low)) inside = value > low;
  if (low > -HUGE_VAL) {
    if (skip(&text, " and ") || skip(&text, ", ")) high = -HUGE_VAL;
    for (int k = 0; k < 2; k++) {
      if (skip(&text, most[k]) && number_at(&text, &high)) return inside && value <= high;
      if (skip(&text, below[k]) && number_at(&text, &high)) return inside && value < high;
    }
    if (skip(&text, "from ") && number_at(&text, &low) && skip(&text, " to "))
      return number_at(&text, &high) && value >= low && value <= high;
    return inside && high == HUGE_VAL;
  }
  for (int k = 0; k < 2; k++)
    if (skip(&text, most[k]) && number_at(&text, &bound)) return value <= bound;
  const bool open = skip(&text, "in (");
  (void)(open || skip(&text, "in [") || skip(&text, "in ") || skip(&text, "0 or "));
  if (!number_at(&text, &low)) return false;
  if (!(skip(&text, " to ") || skip(&text, "..") || skip(&text, ", "))) return false;
  if (!number_at(&text, &high) || (open && value == low)) return false;
  return value >= low && (*text == ')' ? value < high : value <= high);
}

bool api_prints_allowed(const char *message) {
  static const char *const asks[] = {"must be ", "allowed is ", "allowed are "};
  const char *at = strstr(message, " is ");
  double value = 0.0;
  if (!at) return false;
  at += 4;
  if (!number_at(&at, &value)) return false;
  const char *comma = strpbrk(at, ",:");
  if (!comma || comma - at > 8 || comma[1] != ' ') return false;
  at = comma + 2;
  for (int k = 0; k < API_COUNT(asks); k++)
    if (skip(&at, asks[k])) return is_within(at, value);
  return false;
}
