/* document.c - see document.h.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "document.h"

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#ifndef HAVE_YAML
#define HAVE_YAML 0
#endif

static void clear(document *d) {
  for (int k = 0; k < d->count; k++) clear(&d->child[k]);
  free(d->child);
  free(d->key);
  free(d->text);
  *d = (document){0};
}

void document_free(document *d) {
  if (d) clear(d);
  free(d);
}

const document *document_find(const document *map, const char *key) {
  for (int k = 0; map && map->kind == DOCUMENT_MAP && k < map->count; k++)
    if (strcmp(map->child[k].key, key) == 0) return &map->child[k];
  return NULL;
}

const char *document_kind_name(const document *d) {
  static const char *const name[] = {"a text", "a list", "a map"};
  return name[d->kind];
}

#if HAVE_YAML

#include <yaml.h>

enum { LEVELS = 10, BYTES = 1 << 20 };

typedef struct reading {
  yaml_document_t *source;
  const char *path;
  char *why;
  size_t size;
} reading;

static bool refuse(const reading *r, int line, const char *what, const char *name) {
  snprintf(r->why, r->size, "%s, line %d: %s%s", r->path, line, name, what);
  return false;
}

static char *copy(const yaml_node_t *node) {
  const size_t length = node->data.scalar.length;
  char *text = malloc(length + 1);
  if (text) memcpy(text, node->data.scalar.value, length), text[length] = '\0';
  return text;
}

static bool convert(const reading *r, int number, int level, document *out);

static bool convert_list(const reading *r, const yaml_node_t *node, int level, document *out) {
  const yaml_node_item_t *first = node->data.sequence.items.start;
  const ptrdiff_t count = node->data.sequence.items.top - first;
  out->kind = DOCUMENT_LIST;
  out->child = calloc((size_t)count + 1, sizeof *out->child);
  if (!out->child) return refuse(r, out->line, "out of memory", "");
  for (ptrdiff_t k = 0; k < count; k++, out->count++)
    if (!convert(r, first[k], level + 1, &out->child[k])) {
      out->count++;
      return false;
    }
  return true;
}

/* By key; of equal keys the first in the file comes first. */
static int by_key(const void *a, const void *b) {
  const document *p = *(const document *const *)a, *q = *(const document *const *)b;
  const int order = strcmp(p->key, q->key);
  return order ? order : (p > q) - (p < q);
}

/* Refuses the first line that repeats a key. Sorted, so that the time is in proportion to the size.
 */
static bool has_unique_keys(const reading *r, const document *map) {
  const document **sorted = malloc((size_t)(map->count + 1) * sizeof *sorted), *twice = NULL;
  if (!sorted) return refuse(r, map->line, "out of memory", "");
  for (int k = 0; k < map->count; k++) sorted[k] = &map->child[k];
  qsort(sorted, (size_t)map->count, sizeof *sorted, by_key);
  for (int k = 1; k < map->count; k++)
    if (strcmp(sorted[k]->key, sorted[k - 1]->key) == 0 && (!twice || sorted[k] < twice))
      twice = sorted[k];
  free(sorted);
  return !twice || refuse(r, twice->line, " is given twice", twice->key);
}

static bool convert_map(const reading *r, const yaml_node_t *node, int level, document *out) {
  const yaml_node_pair_t *first = node->data.mapping.pairs.start;
  const ptrdiff_t count = node->data.mapping.pairs.top - first;
  out->kind = DOCUMENT_MAP;
  out->child = calloc((size_t)count + 1, sizeof *out->child);
  if (!out->child) return refuse(r, out->line, "out of memory", "");
  for (ptrdiff_t k = 0; k < count; k++, out->count++) {
    const yaml_node_t *key = yaml_document_get_node(r->source, first[k].key);
    out->child[k].line = (int)key->start_mark.line + 1;
    if (key->type != YAML_SCALAR_NODE)
      return refuse(r, out->child[k].line, "a key must be a word", "");
    out->child[k].key = copy(key);
    if (!out->child[k].key) return refuse(r, out->child[k].line, "out of memory", "");
  }
  if (!has_unique_keys(r, out)) return false;
  for (ptrdiff_t k = 0; k < count; k++) {
    const int line = out->child[k].line;
    if (!convert(r, first[k].value, level + 1, &out->child[k])) return false;
    out->child[k].line = line;
  }
  return true;
}

static bool convert(const reading *r, int number, int level, document *out) {
  yaml_node_t *node = yaml_document_get_node(r->source, number);
  out->line = (int)node->start_mark.line + 1;
  if (level > LEVELS) return refuse(r, out->line, "more than 10 levels", "");
  if (node->type == YAML_SEQUENCE_NODE) return convert_list(r, node, level, out);
  if (node->type == YAML_MAPPING_NODE) return convert_map(r, node, level, out);
  out->text = copy(node);
  if (!out->text) return refuse(r, out->line, "out of memory", "");
  if (strlen(out->text) != node->data.scalar.length)
    return refuse(r, out->line, "a text with a zero byte", "");
  return true;
}

/* The first document of the file, which must be the only one. */
static document *parse(yaml_parser_t *parser, const reading *r) {
  yaml_document_t source, next;
  document *out = NULL;
  bool good = false;
  if (!yaml_parser_load(parser, &source)) {
    snprintf(r->why, r->size, "%s, line %d: %s", r->path, (int)parser->problem_mark.line + 1,
             parser->problem ? parser->problem : "no YAML");
    return NULL;
  }
  const reading whole = {&source, r->path, r->why, r->size};
  if (!yaml_document_get_root_node(&source)) {
    snprintf(r->why, r->size, "%s is empty", r->path);
  } else if ((out = calloc(1, sizeof *out)) != NULL) {
    good = convert(&whole, 1, 0, out);
  } else {
    refuse(r, 1, "out of memory", "");
  }
  yaml_document_delete(&source);
  if (good && yaml_parser_load(parser, &next)) {
    if (yaml_document_get_root_node(&next))
      good = refuse(r, (int)next.start_mark.line + 1, "a second document", "");
    yaml_document_delete(&next);
  } else if (good) {
    good = refuse(r, (int)parser->problem_mark.line + 1, "no YAML after the document", "");
  }
  if (good) return out;
  document_free(out);
  return NULL;
}

/* Bytes of the file, to be freed. */
static char *read_bytes(const char *path, size_t *length, char *why, size_t size) {
  FILE *f = fopen(path, "rb");
  char *bytes = malloc(BYTES + 1);
  *length = 0;
  errno = f ? 0 : errno;
  if (f && bytes) *length = fread(bytes, 1, BYTES + 1, f);
  const bool failed = !f || ferror(f);
  if (failed) snprintf(why, size, "cannot read %s: %s", path, strerror(errno));
  if (!failed && !bytes) snprintf(why, size, "%s: out of memory", path);
  const bool large = !failed && bytes && *length > BYTES;
  if (large) snprintf(why, size, "%s is larger than 1 MB: no model", path);
  if (f) fclose(f);
  if (!failed && bytes && !large) return bytes;
  free(bytes);
  return NULL;
}

/* Before the file is loaded: depth, at which the first level too many ends the scan, and what
 * libyaml compares with all that came before it: anchors. Aliases make a tree whose size is no
 * longer that of the file. */
static bool is_plain(const reading *r, const char *bytes, size_t length) {
  static const char *const wrong[] = {
      NULL, "more than 10 levels", "an alias (*name): write the part again",
      "an anchor (&name): without aliases nothing refers to it", "a tag directive (%TAG)"};
  yaml_parser_t parser;
  yaml_event_t event;
  int found = 0, level = 0, line = 1, anchored = 0; /* line of the first anchor */
  bool over = false;
  for (const char *at = bytes; found == 0 && at && at < bytes + length; line++) {
    if ((size_t)(bytes + length - at) > 4 && memcmp(at, "%TAG", 4) == 0) found = 4;
    at = memchr(at, '\n', (size_t)(bytes + length - at));
    if (at) at++;
  }
  if (found) return refuse(r, line - 1, wrong[found], "");
  if (!yaml_parser_initialize(&parser)) return refuse(r, 1, "out of memory", "");
  yaml_parser_set_input_string(&parser, (const unsigned char *)bytes, length);
  while (found == 0 && !over && yaml_parser_parse(&parser, &event)) {
    const yaml_char_t *anchor = NULL;
    switch (event.type) {
    case YAML_SEQUENCE_START_EVENT:
      anchor = event.data.sequence_start.anchor, level++;
      break;
    case YAML_MAPPING_START_EVENT:
      anchor = event.data.mapping_start.anchor, level++;
      break;
    case YAML_SCALAR_EVENT:
      anchor = event.data.scalar.anchor;
      break;
    case YAML_SEQUENCE_END_EVENT:
    case YAML_MAPPING_END_EVENT:
      level--;
      break;
    default:
      break;
    }
    if (anchor && !anchored) anchored = (int)event.start_mark.line + 1;
    found = event.type == YAML_ALIAS_EVENT ? 2 : level > LEVELS + 1 ? 1 : 0;
    over = event.type == YAML_STREAM_END_EVENT;
    line = (int)event.start_mark.line + 1;
    yaml_event_delete(&event);
  }
  yaml_parser_delete(&parser);
  if (found == 0 && anchored) found = 3, line = anchored;
  return found == 0 || refuse(r, line, wrong[found], "");
}

document *document_read(const char *path, char *why, size_t size) {
  yaml_parser_t parser;
  size_t length;
  document *out = NULL;
  const reading r = {NULL, path, why, size};
  char *bytes = read_bytes(path, &length, why, size);
  if (!bytes) return NULL;
  const bool plain = is_plain(&r, bytes, length);
  if (plain && !yaml_parser_initialize(&parser)) {
    refuse(&r, 1, "out of memory", "");
  } else if (plain) {
    yaml_parser_set_input_string(&parser, (const unsigned char *)bytes, length);
    out = parse(&parser, &r);
    yaml_parser_delete(&parser);
  }
  free(bytes);
  return out;
}

#else

document *document_read(const char *path, char *why, size_t size) {
  snprintf(why, size, "%s cannot be read: this program was built without libyaml", path);
  return NULL;
}

#endif
