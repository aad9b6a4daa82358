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
