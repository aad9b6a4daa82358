/* names.c - whether the message of an error names an argument: a parameter of the function as its
 * header declares it, or a member of a struct that it takes.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "api.h"

#include <ctype.h>
#include <dirent.h>
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

static void read_headers(void) {
  DIR *folder = opendir(API_HEADERS);
  if (!folder) abort();
  for (const struct dirent *entry; (entry = readdir(folder));) {
    const size_t length = strlen(entry->d_name);
    char path[600];
    if (length < 3 || strcmp(entry->d_name + length - 2, ".h") != 0) continue;
    snprintf(path, sizeof path, "%s/%s", API_HEADERS, entry->d_name);
    read_header(path);
  }
  (void)closedir(folder);
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
  if (!from || names_one_of(from, end, message)) return from != NULL;
  for (const char *at = from; at < end; at++) {
    char type[NAME];
    const char *stop = NULL;
    if (in_word(at[-1]) || sscanf(at, "%63[a-z0-9_]", type) != 1) continue;
    const char *body = body_of(type, &stop);
    if (body && names_one_of(body, stop, message)) return true;
  }
  return false;
}
