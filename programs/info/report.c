/* report.c - see report.h.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "report.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

enum { TITLE = 12, ROW = 24 }; /* columns of text */

/* A string of JSON: control characters are escaped, and replaced in text. */
static void print_quoted(const char *text) {
  putchar('"');
  for (; *text; text++) {
    const unsigned char c = (unsigned char)*text;
    if (c == '"' || c == '\\')
      printf("\\%c", c);
    else if (c < 0x20 || c == 0x7f)
      printf("\\u%04x", c);
    else
      putchar(c);
  }
  putchar('"');
}

static void print_plain(const char *text) {
  for (; *text; text++) putchar((unsigned char)*text < 0x20 || *text == 0x7f ? '?' : *text);
}

/* The place of a member or element: comma, new line, indent. */
static void place(report *r) {
  printf("%s\n%*s", r->any ? "," : "", 2 * (int)r->deep, "");
  r->any = true;
}

static void open(report *r, char bracket) {
  putchar(bracket);
  r->deep++;
  r->any = false;
}

static void close(report *r, char bracket) {
  r->deep--;
  printf("\n%*s%c", 2 * (int)r->deep, "", bracket);
  r->any = true;
}

static void member(report *r, const char *title) {
  place(r);
  print_quoted(title);
  printf(": ");
}

void report_open(report *r) {
  if (r->json) open(r, '[');
}

void report_close(report *r) {
  if (!r->json) return;
  close(r, ']');
  putchar('\n');
}

void report_begin(report *r, const char *path, const char *kind, const char *sentence) {
  if (!r->json) {
    printf("%s", r->any ? "\n" : "");
    r->any = true;
    print_plain(path);
    printf(": ");
    print_plain(sentence);
    putchar('\n');
    return;
  }
  place(r);
  open(r, '{');
  report_text(r, "file", path);
  report_text(r, "kind", kind);
}

void report_end(report *r) {
  if (r->json) close(r, '}');
}

void report_text(report *r, const char *title, const char *text) {
  if (r->json) {
    member(r, title);
    print_quoted(text);
    return;
  }
  printf("  %-*s", TITLE, title);
  print_plain(text);
  putchar('\n');
}

void report_number(report *r, const char *title, double value, const char *unit) {
  if (!r->json)
    printf("  %-*s%.9g%s%s\n", TITLE, title, value, unit ? " " : "", unit ? unit : "");
  else {
    member(r, title);
    if (isfinite(value))
      printf("%.17g", value);
    else
      printf("null");
  }
}

void report_integer(report *r, const char *title, int64_t value) {
  if (!r->json)
    printf("  %-*s%lld\n", TITLE, title, (long long)value);
  else {
    member(r, title);
    printf("%lld", (long long)value);
  }
}

void report_list(report *r, const char *title) {
  if (!r->json)
    printf("  %s\n", title);
  else {
    member(r, title);
    open(r, '{');
  }
}

/* A number as JSON writes it: -0.5, 1e+06. */
static bool is_number(const char *text) {
  static const char digits[] = "0123456789";
  text += *text == '-';
  const size_t whole = strspn(text, digits);
  if (whole == 0 || (whole > 1 && *text == '0')) return false;
  text += whole;
  if (*text == '.') {
    const size_t part = strspn(++text, digits);
    if (part == 0) return false;
    text += part;
  }
  if (*text == 'e' || *text == 'E') {
    text++;
    text += *text == '-' || *text == '+';
    if (!*text) return false;
    text += strspn(text, digits);
  }
  return *text == '\0';
}

void report_row(report *r, const char *name, const char *text) {
  if (r->json) {
    member(r, name);
    if (is_number(text))
      printf("%s", text);
    else if (strcmp(text, "nan") == 0)
      printf("null");
    else
      print_quoted(text);
    return;
  }
  printf("    %-*s ", ROW, name);
  print_plain(text);
  putchar('\n');
}

void report_list_end(report *r) {
  if (r->json) close(r, '}');
}
