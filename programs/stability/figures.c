/* figures.c - Figures 3 to 10 of Yoshida from the tables of the study.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "study.h"

#include "common/plot.h"

#include <math.h>

static void list(output *f, const char *name, int32_t count, const double *value) {
  output_text(f, "array %s[%d] = [", name, (int)count);
  for (int32_t k = 0; k < count; k++) output_text(f, "%s%.9g", k ? ", " : "", value[k]);
  output_text(f, "]\n");
}

/* The regression shown: of the stepping limits, as in the paper, where there are any. */
static void write_fits(output *f, const study *s, bool stepping) {
  for (int wave = 0; wave < 2; wave++) {
    const limit_fit *fit = stepping ? &s->stepping[wave].fit : &s->linear[wave].fit;
    const char *const names[2][4] = {{"a_S", "b_S", "c_S", "d_S"}, {"a_P", "b_P", "c_P", "d_P"}};
    if (wave == 0) output_text(f, "dampings = %d\n", (int)fit->dampings);
    if (wave == 0) list(f, "h", fit->dampings, fit->h);
    list(f, names[wave][0], fit->dampings, fit->a1);
    list(f, names[wave][1], fit->dampings, fit->a2);
    list(f, names[wave][2], 3, fit->b1);
    list(f, names[wave][3], 3, fit->b2);
  }
}

bool study_draw(app *a, const study *s, const char *directory) {
  const bool linear = s->m.kind != METHOD_STEPPING, stepping = s->m.kind != METHOD_LINEAR;
  for (int figure = 3; figure <= 10; figure++) {
    const double criterion = figure == 3 ? STUDY_INTEGRATOR_CRITERION : s->m.criterion;
    char name[16];
    output f;
    snprintf(name, sizeof name, "fig%02d", figure);
    if (!plot_begin(&f, a, directory, name)) return false;
    output_text(&f, "figure = %d; linear = %d; stepping = %d\nsecond = '", figure, linear,
                stepping);
    if (linear) output_text(&f, "lines: linear theory%s", stepping ? "; " : "");
    if (stepping && criterion < 1e4)
      output_text(&f, "marks: time stepping, |a| up to %g m/s^2", criterion);
    else if (stepping)
      output_text(&f, "marks: time stepping, |a| up to 10^{%.3g} m/s^2", log10(criterion));
    if (stepping) output_text(&f, ", accuracy %g", s->m.accuracy);
    output_text(&f, "; f_1 = %g Hz, f_2 = %g Hz'\n", s->m.f1, s->m.f2);
    write_fits(&f, s, stepping);
    if (!plot_end(&f, directory, name, "stability")) return false;
  }
  return true;
}
