/* plot.h - pictures by gnuplot: the script is written next to the data and then run there.
 * SPDX-License-Identifier: BSD-3-Clause */
#pragma once

#include "output.h"

/* A picture DIR/NAME.png, or "NAME.gif", from a template TEMPLATE.gp of share/plots, such as
 * "wave/receivers": DIR/NAME.gp begins with variables of the run, lines of gnuplot such as
 * "depth = %g", and continues with the template and the common style, so that it can be edited and
 * drawn again. Only a complete picture takes its name; otherwise one error line gives gnuplot's
 * reason. Without gnuplot or template one line on stdout says so, which is no error. */
bool plot_draw(app *a, const char *directory, const char *name, const char *template,
               const char *variables, ...) APP_PRINTF(5, 6);
/* The same with variables written between the two by output_text and area_set. */
bool plot_begin(output *script, app *a, const char *directory, const char *name);
bool plot_end(output *script, const char *directory, const char *name, const char *template);

/* Without a template: NAME.gp with the common style, which the program continues, and draws. */
bool plot_open(output *script, app *a, const char *directory, const char *name, int width,
               int height);
bool plot_close(output *script, const char *directory, const char *name);

/* Colours from `least` to `most`, taken to round numbers; `lowest` and `highest` are those of the
 * values shown. An end of the scale is marked where values lie beyond it. */
void plot_colours(output *script, double least, double most, double lowest, double highest);

/* The key below the plot, clear of the name of the x axis. */
void plot_key_below(output *script);
