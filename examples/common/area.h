/* area.h - the area that particles have, as an image: a continuum looks like one. A pixel belongs
 * to the nearest particle; slits narrower than two spacings between particles are closed, the
 * outline runs half a spacing beyond the outermost ones. SPDX-License-Identifier: BSD-3-Clause */
#ifndef EXAMPLES_AREA_H
#define EXAMPLES_AREA_H

#include "output.h"

enum { AREA_SIDE = 1500 }; /* pixels that a picture of its own may have along a side */

typedef struct area {
  int64_t offset; /* bytes of its file in front of it */
  int64_t columns, rows;
  double lower[2], pixel; /* m */
  double least, most;     /* of the values shown; 0 and 0 without any */
} area;

/* Appends to the file the image of what lies between `lower` and `upper` (m), at most `side` pixels
 * along a side: `row` holds x, y (m) and the value of each particle. Errors are those of
 * output_close. */
void area_write(output *file, int64_t count, const double *row, double spacing,
                const double lower[2], const double upper[2], int side, area *out);

/* The element of a gnuplot `plot` that draws it from the file of that name: lengths divided by
 * `length` (m), values times `factor`. */
void area_plot(output *script, const char *name, const area *image, double length, double factor);

/* Least and greatest value of all images, times `factor`. */
void area_range(int64_t count, const area *images, double factor, double *least, double *most);

#endif
