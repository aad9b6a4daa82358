/* page.c - see page.h. What it shows is read from summary.json as it was written: a member a line,
 * the options on one. SPDX-License-Identifier: BSD-3-Clause */
#include "page.h"

#include "options.h"

#include <ctype.h>
#include <stdlib.h>
#include <string.h>

static const char head[] =
    "<!DOCTYPE html>\n<html lang=\"en\"><head><meta charset=\"utf-8\">\n"
    "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n"
    "<style>\n"
    "body { font: 16px/1.5 sans-serif; max-width: 62rem; margin: 0 auto; padding: 0 1rem 3rem;"
    " color: #222; background: #fff }\n"
    "h1 { font-size: 1.5rem } h2 { font-size: 1.15rem; margin: 2rem 0 .5rem }\n"
    "pre { white-space: pre-wrap; overflow-wrap: anywhere; background: #f3f4f6; padding: .6rem }\n"
    "img { max-width: 100%; height: auto } figure { margin: 1rem 0 }\n"
    "figcaption, .quiet { color: #555; font-size: .9rem }\n"
    "table { border-collapse: collapse; width: 100% }\n"
    "td { border-bottom: 1px solid #ddd; padding: .2rem .6rem .2rem 0; vertical-align: top;"
    " overflow-wrap: anywhere }\n"
    "td:first-child { width: 50% } .warning { color: #8a2a12 } ul { padding-left: 1.2rem }\n"
    "</style>\n";

static void escaped(output *f, const char *text, size_t length) {
  for (size_t k = 0; k < length; k++) switch (text[k]) {
    case '&':
      output_text(f, "&amp;");
      break;
    case '<':
      output_text(f, "&lt;");
      break;
    case '>':
      output_text(f, "&gt;");
      break;
    case '"':
      output_text(f, "&quot;");
      break;
    default:
      output_text(f, "%c", text[k]);
    }
}

static void words(output *f, const char *text) { escaped(f, text, strlen(text)); }

/* The end of the JSON value at `at`, of an object or array that of all of it. */
static const char *end_of(const char *at) {
  bool quoted = false;
  for (int depth = 0; *at; at++) {
    if (quoted && *at == '\\' && at[1]) {
      at++;
    } else if (*at == '"') {
      quoted = !quoted;
    } else if (!quoted) {
      if (*at == '{' || *at == '[') depth++;
      if ((*at == ',' || *at == '}' || *at == ']') && depth == 0) break;
      if (*at == '}' || *at == ']') depth--;
    }
  }
  return at;
}

static void show(output *f, const char *value, const char *end) {
  while (end > value && isspace((unsigned char)end[-1])) end--;
  if (*value == '"' && end > value + 1) value++, end--;
  if (end - value == 4 && strncmp(value, "null", 4) == 0) value = "–", end = value + strlen(value);
  char *rest;
  const double number = strtod(value, &rest);
  if (rest == end && end - value > 9)
    output_text(f, "%.6g", number);
  else
    escaped(f, value, (size_t)(end - value));
}

/* The members of the object that begins at `at` as rows of a table; those of `left_out`, words
 * between spaces, have places of their own. */
static void rows(output *f, const char *at, const char *left_out) {
  char word[80];
  output_text(f, "<table>\n");
  while (*at && *at != '"') at++;
  while (*at == '"') {
    const char *key = at + 1, *close = strchr(key, '"');
    if (!close || strncmp(close, "\": ", 3) != 0) break;
    const char *value = close + 3, *end = end_of(value);
    snprintf(word, sizeof word, " %.*s ", (int)(close - key), key);
    if (!strstr(left_out, word)) {
      output_text(f, "<tr><td>");
      escaped(f, key, (size_t)(close - key));
      output_text(f, "</td><td>");
      show(f, value, end);
      output_text(f, "</td></tr>\n");
    }
    for (at = end; *at && *at != '"' && *at != '}';) at++;
  }
  output_text(f, "</table>\n");
}

static char *read_summary(const char *directory) {
  char path[4096];
  snprintf(path, sizeof path, "%s/summary.json", directory);
  FILE *in = fopen(path, "r");
  if (!in) return NULL;
  char *text = NULL;
  size_t used = 0, got = 1;
  while (got > 0) {
    char *more = realloc(text, used + 4097);
    if (!more) break;
    text = more;
    used += got = fread(text + used, 1, 4096, in);
    text[used] = '\0';
  }
  fclose(in);
  return text;
}

static bool is_picture(const char *name) { return strstr(name, ".png") || strstr(name, ".gif"); }

/* Each name of the list "a, b, c" that is a picture, or is none. */
static void files(output *f, const app *a, bool pictures) {
  char list[sizeof a->results], *rest = list;
  memcpy(list, a->results, sizeof list);
  for (char *name = strtok_r(list, ",", &rest); name; name = strtok_r(NULL, ",", &rest)) {
    name += strspn(name, " ");
    if (is_picture(name) != pictures) continue;
    output_text(f, pictures ? "<figure><a href=\"" : "<li><a href=\"");
    words(f, name);
    output_text(f, pictures ? "\"><img alt=\"" : "\">");
    words(f, name);
    if (pictures) {
      output_text(f, "\" src=\"");
      words(f, name);
      output_text(f, "\"></a><figcaption>");
      words(f, name);
      output_text(f, ", drawn by <a href=\"%.*s.gp\">%.*s.gp</a></figcaption></figure>\n",
                  (int)strcspn(name, "."), name, (int)strcspn(name, "."), name);
    } else {
      output_text(f, "</a></li>\n");
    }
  }
}

bool page_write(app *a, const char *directory) {
  output f;
  if (!output_open(&f, a, directory, "index.html")) return false;
  output_text(&f, "%s<title>%s</title></head><body>\n<h1>%s</h1>\n", head, a->program, a->program);
  output_text(&f, "<p class=\"quiet\">libmps %s, run %s</p>\n<pre>", mps_version(), a->outcome);
  char part[2048];
  for (int k = 0; options_word(k, part, sizeof part); k++) {
    if (k > 0) output_text(&f, " ");
    words(&f, part);
  }
  output_text(&f, "</pre>\n");
  for (int k = 0; k < a->warnings; k++) {
    output_text(&f, "<p class=\"warning\">");
    words(&f, a->warning[k]);
    output_text(&f, "</p>\n");
  }
  files(&f, a, true);
  char *summary = read_summary(directory);
  const char *options = summary ? strstr(summary, "\"options\": {") : NULL;
  if (summary) {
    output_text(&f, "<h2>Results</h2>\n");
    rows(&f, summary, " program version outcome options warnings ");
  }
  if (options) {
    output_text(&f, "<h2>Options</h2>\n");
    rows(&f, strchr(options, '{'), "");
  }
  output_text(&f, "<h2>Files</h2>\n<ul>\n");
  files(&f, a, false);
  output_text(&f, "</ul>\n</body></html>\n");
  free(summary);
  return output_close(&f);
}
