/* path.c - the path of mps-element: one of those by name, or the stages of a file, and its steps.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "element.h"

#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* ---- by name --------------------------------------------------------------------------------- */

/* Returns the number of stages. */
static int named_path(const settings *s, stage *g) {
  const double e = s->strain;
  *g = (stage){.steps = s->steps};
  switch (s->path) {
  case ISO:
    g->strain[0] = g->strain[4] = g->strain[8] = -e / 3.0;
    break;
  case OEDOMETER:
    g->strain[8] = -e;
    break;
  case CU:
  case EXTENSION:
    g->strain[8] = s->path == CU ? -e : e;
    g->strain[0] = g->strain[4] = -0.5 * g->strain[8];
    break;
  case CD:
    g->strain[8] = -e;
    g->controlled = MPS_MATERIAL_POINT_XX | MPS_MATERIAL_POINT_YY;
    break;
  case PS_UNDRAINED:
    g->strain[0] = e;
    g->strain[4] = -e;
    break;
  case CYCLIC:
  case CYCLIC_TRIAXIAL:
    return element_cyclic_path(s, g);
  default:
    g->strain[1] = e;
  }
  return 1;
}

/* ---- from a file ----------------------------------------------------------------------------- */

enum { LINE = 1024, COLUMNS = 16 };
/* Strains, then stresses, in the order of a stress's components; steps. */
static const char *const known[] = {"exx", "eyy", "ezz", "gxy", "gzx", "gyz",  "sxx",
                                    "syy", "szz", "sxy", "szx", "syz", "steps"};
enum { KNOWN = 13, STRESSES = 6, STEPS = 12 };

typedef struct reader {
  element *x;
  FILE *file;
  int line, columns, column[COLUMNS]; /* index in `known` */
  char text[LINE];
} reader;

static bool bad(reader *r, const char *what, const char *cell) {
  return app_error(&r->x->a, "%s:%d: %s%.60s", r->x->s.path_file, r->line, what, cell);
}

/* The next line that is neither empty nor a comment; *end: there is none. */
static bool read_line(reader *r, bool *end) {
  for (*end = false; fgets(r->text, sizeof r->text, r->file);) {
    r->line++;
    if (r->line == 1 && strncmp(r->text, "\xef\xbb\xbf", 3) == 0) /* a mark of UTF-8 */
      memmove(r->text, r->text + 3, strlen(r->text + 3) + 1);
    size_t length = strlen(r->text);
    /* a NUL hides the newline that ends the line */
    if ((length == 0 || r->text[length - 1] != '\n') && !feof(r->file))
      return bad(r, "line longer than 1022 characters, or no text", "");
    while (length > 0 && strchr("\r\n \t", r->text[length - 1])) r->text[--length] = '\0';
    if (length > 0 && r->text[0] != '#') return true;
  }
  *end = true;
  return !ferror(r->file) || bad(r, strerror(errno), "");
}

/* The next cell of a line, NULL after the last; without spaces around. */
static char *next_cell(char **rest) {
  char *cell = *rest;
  if (!cell) return NULL;
  char *comma = strchr(cell, ',');
  *rest = comma ? comma + 1 : NULL;
  if (comma) *comma = '\0';
  while (*cell == ' ' || *cell == '\t') cell++;
  for (size_t n = strlen(cell); n > 0 && (cell[n - 1] == ' ' || cell[n - 1] == '\t');)
    cell[--n] = '\0';
  return cell;
}

static bool read_header(reader *r) {
  bool end;
  if (!read_line(r, &end)) return false;
  if (end) return bad(r, "no line with the names of the columns", "");
  char *rest = r->text;
  for (char *cell; (cell = next_cell(&rest));) {
    int k = 0;
    while (k < KNOWN && strcmp(known[k], cell) != 0) k++;
    if (k == KNOWN)
      return bad(r,
                 "columns are exx, eyy, ezz, gxy, gzx, gyz (strain), sxx, syy, szz, sxy, szx, syz "
                 "(Pa) and steps, not ",
                 cell);
    for (int c = 0; c < r->columns; c++)
      if (r->column[c] == k) return bad(r, "a second column ", cell);
    r->column[r->columns++] = k; /* at most KNOWN, as none is there twice */
  }
  return true;
}

static bool read_cell(reader *r, stage *g, int k, const char *cell, uint32_t *strains) {
  static const int row_of[] = {0, 1, 2, 0, 2, 1}, column_of[] = {0, 1, 2, 1, 0, 2};
  double value;
  if (!options_number(cell, &value)) return bad(r, "a number is wanted, not ", cell);
  if (k == STEPS) {
    if (!(value >= 1.0 && value <= 1e6 && value == floor(value)))
      return bad(r, "steps must be in [1, 1e6] and an integer, not ", cell);
    g->steps = (int64_t)value;
    return true;
  }
  const int c = k % STRESSES;
  if (k >= STRESSES) {
    if (!(fabs(value) <= 1e12)) return bad(r, "a stress must be in [-1e12, 1e12] Pa, not ", cell);
    g->controlled |= 1u << c;
    g->stress[c] = value;
    return true;
  }
  if (!(fabs(value) <= 10.0)) return bad(r, "a strain must be in [-10, 10], not ", cell);
  *strains |= 1u << c;
  /* a shear strain as a symmetric gradient, half each */
  g->strain[3 * row_of[c] + column_of[c]] = c < 3 ? value : 0.5 * value;
  if (c >= 3) g->strain[3 * column_of[c] + row_of[c]] = 0.5 * value;
  return true;
}

static bool read_stage(reader *r, stage *g) {
  uint32_t strains = 0;
  char *rest = r->text, *cell;
  int c = 0;
  *g = (stage){.steps = 100};
  for (; (cell = next_cell(&rest)); c++) {
    if (c == r->columns) return bad(r, "more cells than columns", "");
    if (cell[0] && !read_cell(r, g, r->column[c], cell, &strains)) return false;
  }
  if (c < r->columns) return bad(r, "fewer cells than columns", "");
  if (strains & g->controlled)
    return bad(r, "strain and stress of the same component are given", "");
  return true;
}

static bool read_path(element *x) {
  reader r = {.x = x, .file = fopen(x->s.path_file, "r")};
  if (!r.file) return app_error(&x->a, "cannot read %s: %s", x->s.path_file, strerror(errno));
  bool end = false, good = read_header(&r);
  while (good && (good = read_line(&r, &end)) && !end) {
    if (x->stage_count == STAGES)
      good = bad(&r, "more than 1000 stages", "");
    else
      good = read_stage(&r, &x->stages[x->stage_count++]);
  }
  if (good && x->stage_count == 0) good = bad(&r, "no stage after the names of the columns", "");
  (void)fclose(r.file);
  return good;
}

bool element_make_path(element *x) {
  x->stages = calloc(STAGES, sizeof *x->stages);
  if (!x->stages) return app_no_memory(&x->a);
  if (x->s.path_file) {
    if (!read_path(x)) return false;
  } else {
    x->stage_count = named_path(&x->s, x->stages);
  }
  x->room = 1;
  for (int k = 0; k < x->stage_count; k++) x->room += x->stages[k].steps;
  if (x->room > 10000000) return app_error(&x->a, "the path has more than 1e7 steps");
  x->table = calloc((size_t)x->room, sizeof *x->table);
  return x->table || app_no_memory(&x->a);
}

/* ---- steps ----------------------------------------------------------------------------------- */

/* The strain of a row: axial compression, extension, volume strain, or shear, all positive. */
static double measure(const element *x) {
  const double *e = x->e;
  if (x->s.path_file) return 0.0 - e[2];
  switch (x->s.path) {
  case ISO:
    return 0.0 - (e[0] + e[1] + e[2]);
  case EXTENSION:
    return e[2];
  case PS_UNDRAINED:
    return 0.0 - e[1];
  case SHEAR:
  case CYCLIC:
    return e[3];
  case CYCLIC_TRIAXIAL:
    return 0.0 - e[2];
  default:
    return 0.0 - e[2];
  }
}

/* Excess pore pressure where nothing drains: the total lateral stress stays, in shear the vertical
 * one. */
static double pore_pressure(const element *x) {
  const double *s = x->point.stress;
  if (x->s.path_file || x->s.path == ISO || x->s.path == OEDOMETER || x->s.path == CD ||
      x->s.drained)
    return 0.0;
  const int held = x->s.path == SHEAR || x->s.path == CYCLIC ? 1 : 0;
  return s[held] - (x->rows == 0 ? s[held] : x->table[0].stress[held]);
}

static void take_row(element *x) {
  const double *s = x->point.stress, *h = x->point.history;
  const double a = s[0] - s[1], b = s[1] - s[2], c = s[2] - s[0];
  row r = {
      .strain = measure(x),
      .p = 0.0 - (s[0] + s[1] + s[2]) / 3.0,
      .q = sqrt(0.5 * (a * a + b * b + c * c) + 3.0 * (s[3] * s[3] + s[4] * s[4] + s[5] * s[5])),
      .u = pore_pressure(x),
      .void_ratio = x->void_at >= 0 ? h[x->void_at] : (1.0 + x->s.e0) * x->point.volume_ratio - 1.0,
      .pc = x->pc_at >= 0 ? h[x->pc_at] : NAN,
      .plastic = x->plastic_at >= 0 ? h[x->plastic_at] : NAN,
      .volume_ratio = x->point.volume_ratio,
      .contraction = x->contraction_at >= 0 ? h[x->contraction_at] : NAN,
      .cycles = NAN};
  /* a cyclic path has its first quarter in the first stage */
  if (element_is_cyclic(&x->s)) r.cycles = (double)x->rows / (4.0 * (double)x->stages[0].steps);
  memcpy(r.stress, s, sizeof r.stress);
  memcpy(r.e, x->e, sizeof r.e);
  x->table[x->rows++] = r;
}

/* One step; `target`: the controlled stresses at its end. */
static mps_status drive_step(element *x, const stage *g, const double *gradient,
                             const double *target, double dt, double *found) {
  if (g->deviator != 0.0) return element_drive_deviator(x, target[2], dt, found);
  return mps_material_point_control(x->a.context, x->material, &x->point, gradient, g->controlled,
                                    target, dt, 1, found);
}

static bool drive_stage(element *x, const stage *g) {
  double gradient[9], found[9], largest = 0.0, first[6];
  for (int c = 0; c < 9; c++) largest = fmax(largest, fabs(g->strain[c]));
  /* a stage of stresses alone has no strain that gives its time: one of 1 % */
  const double dt = (largest > 0.0 ? largest : 0.01) / x->s.rate / (double)g->steps;
  for (int c = 0; c < 9; c++) gradient[c] = g->strain[c] / (dt * (double)g->steps);
  memcpy(first, x->point.stress, sizeof first);
  if (g->deviator != 0.0) first[2] = first[0] - first[2];
  for (int64_t k = 1; k <= g->steps; k++) {
    double target[6];
    const double share = (double)k / (double)g->steps;
    for (int c = 0; c < 6; c++) target[c] = first[c] + g->stress[c] * share;
    if (g->deviator != 0.0) target[2] = first[2] + g->deviator * share;
    const mps_status status = drive_step(x, g, gradient, target, dt, found);
    x->stopped = status == MPS_ERROR_NUMERIC && element_has_ratio(&x->s);
    if (x->stopped) return true;
    if (!app_check(&x->a, status)) return false;
    for (int c = 0; c < 3; c++) x->e[c] += dt * found[4 * c];
    x->e[3] += dt * (found[1] + found[3]);
    take_row(x);
  }
  return true;
}

bool element_drive(element *x) {
  take_row(x);
  for (int k = 0; k < x->stage_count && !x->stopped; k++)
    if (!drive_stage(x, &x->stages[k])) return false;
  return true;
}
