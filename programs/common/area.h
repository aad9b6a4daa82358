/* area.h - the area of the particles as an image of a continuum. A pixel belongs to the nearest
 * particle; narrow slits between particles, and between them and solids, are closed, the outline
 * runs half a spacing beyond the outermost particles.
 * SPDX-License-Identifier: BSD-3-Clause */
#pragma once

#include "output.h"

enum { AREA_SIDE = 1500 }; /* most pixels along a side of a separate picture */

typedef struct area {
  int64_t offset; /* bytes of its file in front of it */
  int64_t columns, rows;
  double lower[2], pixel; /* m */
  double least, most;     /* of the values shown; 0 and 0 without any */
} area;

/* Width of the slits that are closed, in spacings: of particles at regular distances, and of a
 * lattice stretched by shear in one direction and compressed in the other. */
#define AREA_SLIT 2.0
#define AREA_SLIT_SHEARED 4.0

typedef struct area_def {
  double spacing;            /* m */
  double slit;               /* spacings */
  double lower[2], upper[2]; /* m, what is shown */
  bool walled;               /* beyond it all is solid: walls, or the body continues */
  int side;                  /* pixels along a side, at most */
  double factor;             /* of the values in the image over those given; 0: 1 */
  /* a body or a wall at x, y (m), which the picture draws over the image; NULL: none */
  bool (*solid)(const void *user, double x, double y);
  const void *user;
} area_def;

/* Appends the image to the file: `row` holds x, y (m) and the value of each of `count` particles.
 * Errors are those of output_close. */
void area_write(output *file, const area_def *def, int64_t count, const double *row, area *out);

/* The same as a file of its own. */
bool area_image(app *a, const char *directory, const char *file, const area_def *def, int64_t count,
                const double *row, area *out);

/* Variables of the template maps.gp that follow from `count` images of one size in `file`: lengths
 * divided by `length` (m). */
void area_set(output *script, const char *file, const area_def *def, int64_t count,
              const area *images, double length);
