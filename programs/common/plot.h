/* plot.h - pictures by gnuplot: the script is written next to the data and then run there.
 * SPDX-License-Identifier: BSD-3-Clause */
#ifndef EXAMPLES_PLOT_H
#define EXAMPLES_PLOT_H

#include "output.h"

/* Opens DIR/NAME.gp and writes the common part of all pictures: a PNG NAME.png of width x height
 * pixels, fonts, comma separated data, grid. */
bool plot_open(output *script, app *a, const char *directory, const char *name, int width,
               int height);
/* Ends the script and draws it. Only a complete picture takes the name NAME.png; otherwise one
 * error line gives gnuplot's reason. Without gnuplot on this machine one line on stdout says how to
 * draw it later, which is no error. */
bool plot_close(output *script, const char *directory, const char *name);

/* Colours from `least` to `most`, taken to round numbers; `lowest` and `highest` are those of the
 * values shown. An end of the scale is marked where values lie beyond it. */
void plot_colours(output *script, double least, double most, double lowest, double highest);

/* The same as plot_open for an animation NAME.gif: each plot of the script is a frame, shown for
 * `step` s. */
bool plot_open_animation(output *script, app *a, const char *directory, const char *name, int width,
                         int height, double step);
bool plot_close_animation(output *script, const char *directory, const char *name);

/* The key below the plot, clear of the name of the x axis. */
void plot_key_below(output *script);

/* A round distance of tics that divides `length` into at most `most` parts. */
double plot_tics(double length, double most);

#endif
