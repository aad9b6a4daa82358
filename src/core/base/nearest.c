/* nearest.c - a k-d tree in place: the axes take turns, and the median of each part is its root.
 * Points are ordered by coordinate, then number, so that equal coordinates change nothing.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "nearest.h"

/* ---- order ----------------------------------------------------------------------------------- */

static bool before(const mpsi_nearest *t, int32_t axis, int64_t a, int64_t b) {
  const double xa = t->x[a * t->dim + axis], xb = t->x[b * t->dim + axis];
  return xa < xb || (xa == xb && a < b);
}

/* Moves the item that belongs at `middle` of [begin, end) there, lower ones before it (Hoare). */
static void select_middle(const mpsi_nearest *t, int32_t axis, int64_t begin, int64_t end,
                          int64_t middle) {
  int64_t *order = t->order, low = begin, high = end - 1;
  while (low < high) {
    const int64_t pivot = order[low + (high - low) / 2];
    int64_t i = low, j = high;
    while (i <= j) {
      while (before(t, axis, order[i], pivot)) i++;
      while (before(t, axis, pivot, order[j])) j--;
      if (i > j) break;
      const int64_t swap = order[i];
      order[i++] = order[j], order[j--] = swap;
    }
    if (j < middle) low = i;
    if (middle < i) high = j;
  }
}

static void sort_part(const mpsi_nearest *t, int32_t axis, int64_t begin, int64_t end) {
  if (end - begin < 2) return;
  const int64_t middle = begin + (end - begin) / 2;
  const int32_t next = axis + 1 < t->dim ? axis + 1 : 0;
  select_middle(t, axis, begin, end, middle);
  sort_part(t, next, begin, middle);
  sort_part(t, next, middle + 1, end);
}

void mpsi_nearest_build(mpsi_nearest *tree) {
  for (int64_t i = 0; i < tree->count; i++) tree->order[i] = i;
  sort_part(tree, 0, 0, tree->count);
}

/* ---- search ---------------------------------------------------------------------------------- */

typedef struct search {
  const mpsi_nearest *tree;
  const double *at;
  int32_t wanted, found;
  mpsi_near *out;
} search;

static bool nearer(const mpsi_near *a, const mpsi_near *b) {
  return a->square < b->square || (a->square == b->square && a->point < b->point);
}

/* Enters a point in the ascending list, of which the last may drop out. */
static void enter(search *s, int64_t point) {
  mpsi_near now = {.point = point};
  for (int32_t c = 0; c < s->tree->dim; c++) {
    const double d = s->tree->x[point * s->tree->dim + c] - s->at[c];
    now.square += d * d;
  }
  if (s->found == s->wanted && !nearer(&now, &s->out[s->found - 1])) return;
  int32_t k = s->found < s->wanted ? s->found++ : s->found - 1;
  for (; k > 0 && nearer(&now, &s->out[k - 1]); k--) s->out[k] = s->out[k - 1];
  s->out[k] = now;
}

static void search_part(search *s, int32_t axis, int64_t begin, int64_t end) {
  if (begin == end) return;
  const int64_t middle = begin + (end - begin) / 2, root = s->tree->order[middle];
  const double d = s->at[axis] - s->tree->x[root * s->tree->dim + axis];
  const int32_t next = axis + 1 < s->tree->dim ? axis + 1 : 0;
  if (d < 0.0)
    search_part(s, next, begin, middle);
  else
    search_part(s, next, middle + 1, end);
  enter(s, root);
  /* the other side also where it is as far as the last one found: its numbers may be lower */
  if (s->found == s->wanted && d * d > s->out[s->found - 1].square) return;
  if (d < 0.0)
    search_part(s, next, middle + 1, end);
  else
    search_part(s, next, begin, middle);
}

int32_t mpsi_nearest_find(const mpsi_nearest *tree, const double *at, int32_t wanted,
                          mpsi_near *out) {
  search s = {.tree = tree, .at = at, .wanted = wanted, .out = out};
  search_part(&s, 0, 0, tree->count);
  return s.found;
}
