/* pictures.c - pictures of mps-site-response: motion and spectra of the surface, and largest values
 * by depth. SPDX-License-Identifier: BSD-3-Clause */
#include "site.h"

#include "common/plot.h"

#include <math.h>

static bool draw_surface(app *a, const simulation *sim, bool exact) {
  return plot_draw(a, sim->s.out, "surface", "site/surface",
                   "end = %.9g; outcrop = %d; highest = %.9g; long = %d; exact = %d",
                   sim->sample[sim->count - 1].t, sim->s.base != SITE_RIGID, sim->highest,
                   sim->duration * sim->highest >= 2.0, exact);
}

static bool draw_profile(app *a, const simulation *sim) {
  double depth = 0.0, most[4] = {0.0};
  output f;
  for (int64_t r = 0; r < sim->rows; r++) {
    const site_row *row = &sim->row[r];
    const double value[] = {row->acceleration, 100.0 * row->strain, row->ru, 1e-3 * row->stress};
    for (int k = 0; k < 4; k++) most[k] = fmax(most[k], value[k]);
  }
  if (!plot_begin(&f, a, sim->s.out, "profile")) return false;
  output_text(&f, "depth = %.9g; wet = %d\narray most[4] = [%.9g, %.9g, %.9g, %.9g]\n",
              sim->height + sim->below, sim->wet, most[0], most[1], most[2], most[3]);
  output_text(&f, "array joints[%d] = [0", (int)sim->ground.count);
  for (int64_t i = 0; i < sim->ground.count - 1; i++)
    output_text(&f, ", %.9g", depth += sim->ground.layer[i].thickness);
  output_text(&f, "]\n");
  return plot_end(&f, sim->s.out, "profile", "site/profile");
}

static bool draw_loop(app *a, const simulation *sim) {
  return sim->loop_row < 0 || plot_draw(a, sim->s.out, "loop", "site/loop", "depth = %.9g",
                                        sim->row[sim->loop_row].depth);
}

bool site_draw(app *a, const simulation *sim, bool exact) {
  return draw_surface(a, sim, exact) && draw_profile(a, sim) && draw_loop(a, sim);
}
