/* document.h - a YAML file as a tree of texts, lists and maps, each with its line, for model files.
 * Read by libyaml, where the programs were built with it.
 * SPDX-License-Identifier: BSD-3-Clause */
#pragma once

#include <stdbool.h>
#include <stddef.h>

typedef enum document_kind { DOCUMENT_TEXT = 0, DOCUMENT_LIST, DOCUMENT_MAP } document_kind;

typedef struct document {
  document_kind kind;
  int line;               /* from 1; of a member of a map that of its key */
  char *key;              /* of a member of a map, else NULL */
  char *text;             /* of DOCUMENT_TEXT, as written */
  int count;              /* of children */
  struct document *child; /* of a list in order, of a map as written */
} document;

/* Reads the file. NULL: the reason in `why`, with the line where there is one. Of a map that names
 * a key twice the second line is an error, and so are files above 1 MB, anchors, aliases, tag
 * directives, and more than 10 levels. Takes time in proportion to the size of the file. */
document *document_read(const char *path, char *why, size_t size);
void document_free(document *d);
/* The member of a map; NULL where it has none. */
const document *document_find(const document *map, const char *key);
/* "a text", "a list" or "a map", for errors. */
const char *document_kind_name(const document *d);
