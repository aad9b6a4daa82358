/* area.c - see area.h. Discs around the particles, of half a spacing and half the width of a slit,
 * cover the slits; pixels within half that width of uncovered ones are removed again (a closing by
 * a disc), which keeps free surfaces in place. Solid pixels remove nothing: the gap between a body
 * and the nearest particles is closed too. That leaves shallow notches between the particles of an
 * outline, which a mean over half a spacing smooths. SPDX-License-Identifier: BSD-3-Clause */
#include "area.h"

#include <errno.h>
#include <math.h>
#include <stdlib.h>

enum { PIXELS = 24 }; /* a spacing, at most */
static const double
    own = 0.45,
    kept = 0.3; /* spacings: disc that a particle alone has before and after smoothing */

typedef struct canvas {
  int64_t columns, rows;
  double lower[2], pixel;
  float *value;    /* NaN: nothing there */
  float *distance; /* to the nearest particle, pixels^2 */
  char *state;     /* COVERED or not */
} canvas;

enum { BARE, COVERED, OFF, SOLID };

static int64_t column_of(const canvas *c, double x, int axis) {
  const double k = floor((x - c->lower[axis]) / c->pixel);
  return k < -1e6 ? -1000000 : k > 1e6 ? 1000000 : (int64_t)k;
}

/* Covers a disc of `radius` pixels with the particle's value where it is the nearest. */
static void cover(canvas *c, const double *row, double radius) {
  const double x = (row[0] - c->lower[0]) / c->pixel - 0.5;
  const double y = (row[1] - c->lower[1]) / c->pixel - 0.5;
  const int64_t i0 = column_of(c, row[0], 0), j0 = column_of(c, row[1], 1);
  const int64_t n = (int64_t)ceil(radius) + 1;
  for (int64_t j = j0 - n < 0 ? 0 : j0 - n; j <= j0 + n && j < c->rows; j++)
    for (int64_t i = i0 - n < 0 ? 0 : i0 - n; i <= i0 + n && i < c->columns; i++) {
      const double dx = (double)i - x, dy = (double)j - y, d = dx * dx + dy * dy;
      const int64_t k = j * c->columns + i;
      if (d > radius * radius || d >= (double)c->distance[k]) continue;
      c->distance[k] = (float)d;
      c->value[k] = (float)row[2];
    }
}

/* Whether pixel k is uncovered and has a covered neighbour. */
static bool on_edge(const canvas *c, int64_t i, int64_t j) {
  const int64_t k = j * c->columns + i;
  if (!isinf(c->distance[k])) return false;
  return (i > 0 && !isinf(c->distance[k - 1])) ||
         (i + 1 < c->columns && !isinf(c->distance[k + 1])) ||
         (j > 0 && !isinf(c->distance[k - c->columns])) ||
         (j + 1 < c->rows && !isinf(c->distance[k + c->columns]));
}

/* Removes pixels within `depth` of uncovered ones, except the particles' own discs. */
static void take_off(canvas *c, double depth, double alone) {
  const int64_t n = (int64_t)depth;
  for (int64_t j = 0; j < c->rows; j++)
    for (int64_t i = 0; i < c->columns; i++) {
      if (!on_edge(c, i, j)) continue;
      for (int64_t q = j - n < 0 ? 0 : j - n; q <= j + n && q < c->rows; q++)
        for (int64_t p = i - n < 0 ? 0 : i - n; p <= i + n && p < c->columns; p++) {
          const double d = (double)((p - i) * (p - i) + (q - j) * (q - j));
          const int64_t k = q * c->columns + p;
          if (d <= depth * depth && (double)c->distance[k] > alone * alone) c->state[k] = OFF;
        }
    }
}

/* The outline without the scallops of single particles: a pixel belongs to the area where the mean
 * of its neighbours, in two passes of a box of 2 n + 1, is at least a half. Solid pixels have no
 * part in the mean, so that the outline is the same beside a wall as beside its mirror image. */
static void add_up(const float *from, float *to, int64_t count, int64_t step, int64_t n) {
  double sum = 0.0;
  for (int64_t i = -n; i < count; i++) {
    if (i + n < count) sum += (double)from[(i + n) * step];
    if (i - n - 1 >= 0) sum -= (double)from[(i - n - 1) * step];
    if (i >= 0) to[i * step] = (float)sum;
  }
}

static void add_around(const canvas *c, float *value, float *work, int64_t n) {
  for (int pass = 0; pass < 2; pass++) {
    for (int64_t j = 0; j < c->rows; j++)
      add_up(value + j * c->columns, work + j * c->columns, c->columns, 1, n);
    for (int64_t i = 0; i < c->columns; i++) add_up(work + i, value + i, c->rows, c->columns, n);
  }
}

/* `core` pixels around each particle stay. False: out of memory. */
static bool smooth(canvas *c, int64_t n, double core) {
  const int64_t size = c->columns * c->rows;
  float *covered = malloc(3 * (size_t)size * sizeof *covered);
  if (!covered) return false;
  float *open = covered + size;
  for (int64_t k = 0; k < size; k++) {
    open[k] = c->state[k] != SOLID;
    covered[k] = c->state[k] == COVERED;
  }
  add_around(c, covered, open + size, n);
  add_around(c, open, open + size, n);
  for (int64_t k = 0; k < size; k++) {
    if (c->state[k] == SOLID) continue;
    const bool inside = covered[k] >= 0.5f * open[k] || (double)c->distance[k] <= core * core;
    c->state[k] = inside ? COVERED : BARE;
    if (!inside) c->value[k] = NAN;
  }
  free(covered);
  return true;
}

static bool is_solid(const area_def *def, double x, double y) {
  const bool beyond = def->walled && (x < def->lower[0] || x > def->upper[0] || y < def->lower[1] ||
                                      y > def->upper[1]);
  return beyond || (def->solid && def->solid(def->user, x, y));
}

/* Beside solid pixels nothing is removed. They are empty, except for a seam of a pixel, so that no
 * gap is visible between the image and the shapes drawn over it. */
static void mark_solid(canvas *c, const area_def *def) {
  const double p = c->pixel;
  for (int64_t j = 0; j < c->rows; j++)
    for (int64_t i = 0; i < c->columns; i++) {
      const double x = c->lower[0] + ((double)i + 0.5) * p, y = c->lower[1] + ((double)j + 0.5) * p;
      if (!is_solid(def, x, y)) continue;
      c->distance[j * c->columns + i] = -1.0f;
      if (is_solid(def, x - p, y) && is_solid(def, x + p, y) && is_solid(def, x, y - p) &&
          is_solid(def, x, y + p))
        c->value[j * c->columns + i] = NAN;
    }
}

/* The seam ends where the area beside it does. */
static void end_seam(canvas *c) {
  const int64_t across = c->columns, size = across * c->rows;
  for (int64_t k = 0; k < size; k++)
    if (c->state[k] == SOLID && !(k >= across && c->state[k - across] == COVERED) &&
        !(k + across < size && c->state[k + across] == COVERED) &&
        !(k > 0 && c->state[k - 1] == COVERED) && !(k + 1 < size && c->state[k + 1] == COVERED))
      c->value[k] = NAN;
}

static void mark_covered(canvas *c) {
  for (int64_t k = 0; k < c->columns * c->rows; k++)
    c->state[k] = c->distance[k] < 0.0f ? SOLID : isinf(c->distance[k]) ? BARE : COVERED;
}

static void take_range(const canvas *c, area *out) {
  bool any = false;
  for (int64_t k = 0; k < c->columns * c->rows; k++) {
    const double v = (double)c->value[k];
    if (isnan(v)) continue;
    out->least = any ? fmin(out->least, v) : v;
    out->most = any ? fmax(out->most, v) : v;
    any = true;
  }
}

void area_write(output *file, const area_def *def, int64_t count, const double *row, area *out) {
  const double spacing = def->spacing, reach = 0.5 + 0.5 * def->slit; /* m, spacings */
  /* wider than the picture: particles beyond its edge count */
  const double margin = (reach + 0.5) * spacing;
  const double wide = def->upper[0] - def->lower[0] + 2.0 * margin;
  const double high = def->upper[1] - def->lower[1] + 2.0 * margin;
  canvas c = {.lower = {def->lower[0] - margin, def->lower[1] - margin},
              .pixel = fmax(spacing / PIXELS, fmax(wide, high) / def->side)};
  *out = (area){.lower = {c.lower[0], c.lower[1]}, .pixel = c.pixel};
  if (file->stream == NULL || file->error != 0 || !(wide > 0.0 && high > 0.0)) return;
  out->columns = c.columns = (int64_t)ceil(wide / c.pixel);
  out->rows = c.rows = (int64_t)ceil(high / c.pixel);
  const size_t size = (size_t)(c.columns * c.rows);
  c.value = malloc(size * sizeof *c.value);
  c.distance = malloc(size * sizeof *c.distance);
  c.state = malloc(size * sizeof *c.state);
  if (c.value && c.distance && c.state) {
    for (size_t k = 0; k < size; k++) c.value[k] = NAN, c.distance[k] = INFINITY;
    const double step = spacing / c.pixel; /* pixels */
    for (int64_t k = 0; k < count; k++)
      if (isfinite(row[3 * k + 2])) cover(&c, row + 3 * k, reach * step);
    mark_solid(&c, def);
    mark_covered(&c);
    take_off(&c, (reach - 0.5) * step, own * step);
    const double blur = fmax(ceil(0.25 * (0.5 * def->slit + 1.0) * step), 1.0); /* half a box */
    if (!smooth(&c, (int64_t)blur, kept * step)) file->error = ENOMEM;
    end_seam(&c);
    for (size_t k = 0; k < size && def->factor != 0.0; k++) c.value[k] *= (float)def->factor;
    take_range(&c, out);
    out->offset = ftell(file->stream);
    if (fwrite(c.value, sizeof *c.value, size, file->stream) != size) file->error = errno;
  } else {
    file->error = ENOMEM;
  }
  free(c.value);
  free(c.distance);
  free(c.state);
}

/* Least and greatest value of all images. */
static void area_range(int64_t count, const area *images, double *least, double *most) {
  *least = *most = 0.0;
  for (int64_t k = 0; k < count; k++) {
    *least = k ? fmin(*least, images[k].least) : images[k].least;
    *most = k ? fmax(*most, images[k].most) : images[k].most;
  }
}

void area_set(output *script, const char *file, const area_def *def, int64_t count,
              const area *images, double length) {
  const double step = images->pixel / length;
  double least, most;
  area_range(count, images, &least, &most);
  output_text(script,
              "maps = %lld\nimage = \"'%s' binary array=(%lld,%lld) format='%%float' "
              "origin=(%.9g,%.9g) dx=%.9g dy=%.9g\"\nimage_bytes = %lld\n",
              (long long)count, file, (long long)images->columns, (long long)images->rows,
              images->lower[0] / length + 0.5 * step, images->lower[1] / length + 0.5 * step, step,
              step, (long long)(images->columns * images->rows * (int64_t)sizeof(float)));
  output_text(script,
              "x0 = %.9g; x1 = %.9g; y0 = %.9g; y1 = %.9g\ncb_lowest = %.9g; cb_highest = %.9g\n"
              "array titles[maps]\ndo for [k=1:maps] { titles[k] = '' }\nheading = ''\ncover(k) = "
              "''\nframe_of(k) = k\n",
              def->lower[0] / length, def->upper[0] / length, def->lower[1] / length,
              def->upper[1] / length, least, most);
}

bool area_image(app *a, const char *directory, const char *file, const area_def *def, int64_t count,
                const double *row, area *out) {
  output f;
  if (!output_open(&f, a, directory, file)) return false;
  area_write(&f, def, count, row, out);
  return output_close(&f);
}
