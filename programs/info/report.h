/* report.h - output of mps-info: lines of text, or members of a JSON object.
 * SPDX-License-Identifier: BSD-3-Clause */
#pragma once

#include <stdbool.h>
#include <stdint.h>

typedef struct report {
  bool json;
  bool any;     /* JSON: the object or list that is open has a member */
  int32_t deep; /* lists and objects that are open */
} report;

/* The list of all files, around everything else. */
void report_open(report *r);
void report_close(report *r);
/* A file, with its kind ("checkpoint of mps-pile"). */
void report_begin(report *r, const char *path, const char *kind, const char *sentence);
void report_end(report *r);

/* A line "title  text", or the member "title" of JSON. `unit` may be NULL. */
void report_text(report *r, const char *title, const char *text);
void report_number(report *r, const char *title, double value, const char *unit);
void report_integer(report *r, const char *title, int64_t value);

/* Rows under a title, or an object of JSON: each has a name and a text, which is a number of JSON
 * where it reads as one, and null where it is "nan". */
void report_list(report *r, const char *title);
void report_row(report *r, const char *name, const char *text);
void report_list_end(report *r);
