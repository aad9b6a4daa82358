/* pictures.c - pictures of mps-site-response: motion and spectra of the surface, and largest values
 * by depth. SPDX-License-Identifier: BSD-3-Clause */
#include "site.h"

#include "common/plot.h"

#include <math.h>

#define BLUE "#1f4e8c"
#define RED "#c0392b"
#define GREY "#888888"

static void draw_spectra(output *f, const simulation *sim, bool exact) {
  output_text(f,
              "set size 0.5,0.5\nset origin 0,0\nset logscale x\nset xrange [%.9g:*]\n"
              "set xtics (0.02, 0.05, 0.1, 0.2, 0.5, 1, 2, 5)\nset yrange [0:*]\n"
              "set xlabel 'period (s)'\nset ylabel 'spectral acceleration, 5 %% (m/s^2)'\n"
              "plot 'spectrum.csv' using 1:2 every ::1 with lines linecolor rgb '" BLUE
              "' title 'surface', \\\n"
              "  '' using 1:3 every ::1 with lines linecolor rgb '" RED "' title 'input'\n",
              0.5 / sim->s.highest);
  if (sim->duration * sim->s.highest < 2.0) { /* amplification.csv may have no row */
    output_text(f, "unset multiplot\n");
    return;
  }
  output_text(f,
              "set origin 0.5,0\nunset logscale\nset xrange [0:*]\nset xtics autofreq\n"
              "set xlabel 'frequency (Hz)'\nset ylabel 'surface over input, Fourier'\n"
              "plot 'amplification.csv' using 1:2 every ::1 with lines linecolor rgb '" BLUE
              "' title 'libmps'%s\nunset multiplot\n",
              exact ? ", '' using 1:3 every ::1 with lines dashtype 2 linecolor rgb '" RED
                      "' title 'exact'"
                    : "");
}

static bool draw_surface(app *a, const simulation *sim, bool exact) {
  output f;
  if (!plot_open(&f, a, sim->s.out, "surface", 1100, 900)) return false;
  output_text(&f,
              "set multiplot\nset size 1,0.48\nset origin 0,0.52\nset xrange [0:%.9g]\n"
              "set key outside top center horizontal\n"
              "set xlabel 'time (s)'\nset ylabel 'acceleration (m/s^2)'\n"
              "plot 'surface.csv' using 1:2 every ::1 with lines linecolor rgb '" BLUE
              "' title 'surface', \\\n"
              "  '' using 1:5 every ::1 with lines linecolor rgb '" RED "' title '%s'\n",
              sim->sample[sim->count - 1].t,
              sim->s.base == SITE_RIGID ? "base" : "outcrop of the half space");
  draw_spectra(&f, sim, exact);
  return plot_close(&f, sim->s.out, "surface");
}

/* Lines at the bottoms of the layers. */
static void draw_layers(output *f, const simulation *sim) {
  double depth = 0.0;
  for (int64_t i = 0; i < sim->ground.count - 1; i++) {
    depth += sim->ground.layer[i].thickness;
    output_text(f,
                "set arrow %d from graph 0, first %.9g to graph 1, first %.9g nohead linecolor rgb "
                "'" GREY "' dashtype 3\n",
                (int)i + 1, depth, depth);
  }
}

/* What the panels of the profile show, of a row. */
static double shown(const site_row *row, int k) {
  const double value[] = {row->acceleration, 100.0 * row->strain, row->ru, 1e-3 * row->stress};
  return value[k];
}

static bool draw_profile(app *a, const simulation *sim) {
  static const char *const label[] = {"largest acceleration (m/s^2)", "largest shear strain (%)",
                                      "largest r_u", "largest shear stress (kPa)"};
  static const char *const column[] = {"3", "(100*$6)", "8", "(1e-3*$7)"};
  output f;
  if (!plot_open(&f, a, sim->s.out, "profile", 1100, 700)) return false;
  output_text(&f, "set multiplot layout 1,3\nset yrange [%.9g:0]\nunset key\nset bmargin 4\n",
              sim->height + sim->below);
  draw_layers(&f, sim);
  for (int k = 0; k < 3; k++) {
    const int q = k == 2 && !sim->wet ? 3 : k;
    double most = 1e-12;
    for (int64_t r = 0; r < sim->rows; r++) most = fmax(most, shown(&sim->row[r], q));
    if (q == 2) most = 1.2; /* the highest rows have hardly any stress, and ratios beyond */
    output_text(&f,
                "set xlabel '%s'\nset ylabel '%s'\nset xrange [0:%.9g]\nset xtics %.9g\n"
                "plot 'profile.csv' using %s:1 every ::1 with lines linecolor rgb '" BLUE "'\n",
                label[q], k == 0 ? "depth (m)" : "", 1.1 * most, plot_tics(most, 5.0), column[q]);
  }
  output_text(&f, "unset multiplot\n");
  return plot_close(&f, sim->s.out, "profile");
}

static bool draw_loop(app *a, const simulation *sim) {
  output f;
  if (sim->loop_row < 0) return true;
  if (!plot_open(&f, a, sim->s.out, "loop", 700, 600)) return false;
  output_text(&f,
              "set xlabel 'shear strain (%%)'\nset ylabel 'shear stress (kPa)'\nunset key\n"
              "set title 'At a depth of %.4g m'\n"
              "plot 'loop.csv' using (100*$2):(1e-3*$3) every ::1 with lines linecolor rgb '" BLUE
              "'\n",
              sim->row[sim->loop_row].depth);
  return plot_close(&f, sim->s.out, "loop");
}

bool site_draw(app *a, const simulation *sim, bool exact) {
  return draw_surface(a, sim, exact) && draw_profile(a, sim) && draw_loop(a, sim);
}
