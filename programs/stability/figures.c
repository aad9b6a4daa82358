/* figures.c - Figures 3 to 10 of Yoshida from the tables of the study. Lines are linear theory,
 * marks are bisection by time stepping. SPDX-License-Identifier: BSD-3-Clause */
#include "study.h"

#include "common/plot.h"

#include <math.h>

static const char *const colours[] = {"#1b4f8c", "#1e8449", "#c77700", "#a61c2b", "#6c3483"};
static const int marks[] = {7, 5, 9, 13, 6}; /* disc, square, triangle, diamond, wide ring */
static const double sizes[] = {1.3, 1.3, 1.3, 1.3, 2.4};
static const double widths[] = {1, 1, 1, 1, 3}; /* of the ring's line: under another one */

static bool has_linear(const study *s) { return s->m.kind != METHOD_STEPPING; }
static bool has_stepping(const study *s) { return s->m.kind != METHOD_LINEAR; }

/* Opens a figure of two panels side by side under one title. */
static bool open_pair(output *f, app *a, const study *s, const char *directory, const char *name,
                      const char *title, double criterion) {
  if (!plot_open(f, a, directory, name, 1500, 780)) return false;
  output_text(f, "set multiplot layout 1,2 title \"%s\\n{/*0.8 ", title);
  if (has_linear(s)) output_text(f, "lines: linear theory%s", has_stepping(s) ? "; " : "");
  if (has_stepping(s)) {
    output_text(f, "marks: time stepping, |a| up to ");
    output_text(f, criterion < 1e4 ? "%g" : "10^{%.3g}",
                criterion < 1e4 ? criterion : log10(criterion));
    output_text(f, " m/s^2, accuracy %g", s->m.accuracy);
  }
  output_text(f, "; f_1 = %g Hz, f_2 = %g Hz}\"\n", s->m.f1, s->m.f2);
  output_text(f, "set key left bottom reverse Left samplen 2.5\n"
                 "set ylabel 'critical time step (s)'\nset format y '10^{%%T}'\nset logscale xy\n");
  return true;
}

static bool close_pair(output *f, const char *directory, const char *name) {
  output_text(f, "unset multiplot\n");
  return plot_close(f, directory, name);
}

/* The limits in `file` that fulfil `where`, over `x`: the linear ones (column `column`) as a line,
 * the stepping ones (the next column) as marks. Ends without a newline. */
static void series(output *f, const study *s, const char *file, int column, const char *where,
                   const char *x, int style, const char *title) {
  const char *lead = "";
  if (has_linear(s)) {
    output_text(f,
                "'%s' every ::1 using %s:((%s) ? $%d : NaN) with lines linewidth %g linecolor rgb "
                "'%s' ",
                file, x, where, column, widths[style], colours[style]);
    output_text(f, has_stepping(s) ? "notitle" : "title '%s'", title);
    lead = ", ";
  }
  if (has_stepping(s))
    output_text(f,
                "%s'%s' every ::1 using %s:((%s) ? $%d : NaN) with points pointtype %d pointsize "
                "%g linecolor rgb '%s' title '%s'",
                lead, file, x, where, column + 1, marks[style], sizes[style], colours[style],
                title);
}

static const char *separator(bool last) { return last ? "\n" : ", \\\n  "; }

/* ---- Figures 3 to 5: against damping and radius ---------------------------------------------- */

static bool figure3(app *a, const study *s, const char *directory) {
  static const char *const names[] = {"euler", "leapfrog", "verlet"};
  static const char *const titles[] = {"Euler", "Leapfrog", "Verlet"};
  static const int styles[] = {3, 4, 0}; /* Verlet falls into the rings of leapfrog */
  output f;
  char where[96];
  if (!open_pair(&f, a, s, directory, "fig03", "Time integration: shear wave, V_S = 100 m/s",
                 STUDY_INTEGRATOR_CRITERION))
    return false;
  output_text(&f, "set xlabel 'damping ratio h'\nset xrange [0.0007:1.4]\n");
  for (int r = 1; r < STUDY_RADII; r += 2) {
    output_text(&f, "set title 'R = %g m'\nplot ", study_radius[r]);
    for (int k = 0; k < 3; k++) {
      snprintf(where, sizeof where, "strcol(1) eq '%s' && $2 == %g", names[k], study_radius[r]);
      series(&f, s, "integrators.csv", 4, where, "3", styles[k], titles[k]);
      output_text(&f, "%s", separator(k == 2));
    }
  }
  return close_pair(&f, directory, "fig03");
}

static bool figure4(app *a, const study *s, const char *directory) {
  output f;
  char where[96], title[32];
  if (!open_pair(&f, a, s, directory, "fig04", "Critical time step against damping: shear wave",
                 s->m.criterion))
    return false;
  output_text(&f, "set xlabel 'damping ratio h'\nset xrange [0.0007:1.4]\n");
  for (int r = 0; r < STUDY_RADII; r += 2) {
    output_text(&f, "set title 'R = %g m'\nplot ", study_radius[r]);
    for (int v = 0; v < STUDY_VELOCITIES; v++) {
      snprintf(where, sizeof where, "strcol(1) eq 'S' && $2 == %g && $3 == %g", study_radius[r],
               study_velocity[v]);
      snprintf(title, sizeof title, "V_S = %g m/s", study_velocity[v]);
      series(&f, s, "limits.csv", 5, where, "4", v, title);
      output_text(&f, "%s", separator(v + 1 == STUDY_VELOCITIES));
    }
  }
  return close_pair(&f, directory, "fig04");
}

static bool figure5(app *a, const study *s, const char *directory) {
  static const int damping[] = {0, 5}; /* 0.001 and 0.048 */
  output f;
  char where[96], title[32];
  if (!open_pair(&f, a, s, directory, "fig05",
                 "Critical time step against particle radius: shear wave", s->m.criterion))
    return false;
  output_text(&f, "set xlabel 'particle radius R (m)'\nset xrange [0.2:2]\n"
                  "set xtics (0.25, 0.5, 1, 1.6)\nset key right bottom\n");
  for (int k = 0; k < 2; k++) {
    const double h = study_damping[damping[k]];
    output_text(&f, "set title 'h = %g'\nplot ", h);
    for (int v = 0; v < STUDY_VELOCITIES; v++) {
      snprintf(where, sizeof where, "strcol(1) eq 'S' && $4 == %g && $3 == %g", h,
               study_velocity[v]);
      snprintf(title, sizeof title, "V_S = %g m/s", study_velocity[v]);
      series(&f, s, "limits.csv", 5, where, "2", v, title);
      output_text(&f, "%s", separator(v + 1 == STUDY_VELOCITIES));
    }
  }
  return close_pair(&f, directory, "fig05");
}

/* ---- Figures 6 and 7: against R/V ------------------------------------------------------------ */

/* As `series` over R/V, whose values are not in order in the table: the line sorts them. */
static void scaled_series(output *f, const study *s, char wave, double h, int style,
                          const char *title) {
  char where[96];
  snprintf(where, sizeof where, "strcol(1) eq '%c' && $4 == %g", wave, h);
  if (has_linear(s))
    output_text(f,
                "'limits.csv' every ::1 using ($2/$3):((%s) ? $5 : NaN) smooth unique with lines "
                "linecolor rgb '%s' dashtype %d %s%s%s, ",
                where, colours[style], wave == 'S' ? 1 : 2, has_stepping(s) ? "notitle" : "title '",
                has_stepping(s) ? "" : title, has_stepping(s) ? "" : "'");
  output_text(f,
              "'limits.csv' every ::1 using ($2/$3):((%s) ? $%d : NaN) with points pointtype %d "
              "pointsize 1.3 linecolor rgb '%s' %s%s%s",
              where, has_stepping(s) ? 6 : 5, marks[style] - (wave == 'P'), colours[style],
              has_stepping(s) ? "title '" : "notitle", has_stepping(s) ? title : "",
              has_stepping(s) ? "'" : "");
}

static bool figure6(app *a, const study *s, const char *directory) {
  static const int damping[] = {0, 5, 9}; /* 0.001, 0.048, 1 */
  output f;
  char title[32];
  if (!open_pair(&f, a, s, directory, "fig06", "Critical time step against R/V", s->m.criterion))
    return false;
  output_text(&f, "set key left top\nset format x '10^{%%T}'\nset xrange [2e-4:3e-2]\n");
  for (int wave = 0; wave < 2; wave++) {
    output_text(&f, "set xlabel 'R / V_%c (s)'\nset title '%s wave'\nplot ", "SP"[wave],
                wave == 0 ? "shear" : "pressure");
    for (int k = 0; k < 3; k++) {
      snprintf(title, sizeof title, "h = %g", study_damping[damping[k]]);
      scaled_series(&f, s, "SP"[wave], study_damping[damping[k]], k, title);
      output_text(&f, "%s", separator(k == 2));
    }
  }
  return close_pair(&f, directory, "fig06");
}

static bool figure7(app *a, const study *s, const char *directory) {
  static const int damping[] = {0, 6}; /* 0.001 and 0.1 */
  output f;
  if (!open_pair(&f, a, s, directory, "fig07", "Shear and pressure wave at equal wave velocity",
                 s->m.criterion))
    return false;
  output_text(&f, "set key left top\nset format x '10^{%%T}'\nset xrange [2e-4:3e-2]\nset xlabel "
                  "'R / V (s)'\n");
  for (int k = 0; k < 2; k++) {
    output_text(&f, "set title 'h = %g'\nplot ", study_damping[damping[k]]);
    scaled_series(&f, s, 'S', study_damping[damping[k]], 0, "S wave, V = V_S");
    output_text(&f, "%s", separator(false));
    scaled_series(&f, s, 'P', study_damping[damping[k]], 3, "P wave, V = V_P");
    output_text(&f, "\n");
  }
  return close_pair(&f, directory, "fig07");
}

/* ---- Figures 8 to 10: the regression --------------------------------------------------------- */

/* The regression shown: of the stepping limits, as in the paper, where there are any. */
static const regression *shown(const study *s, int wave) {
  return has_stepping(s) ? &s->stepping[wave] : &s->linear[wave];
}

static const char *shown_name(const study *s) { return has_stepping(s) ? "stepping" : "linear"; }

static bool figure8(app *a, const study *s, const char *directory) {
  output f;
  if (!plot_open(&f, a, directory, "fig08", 1500, 780)) return false;
  output_text(&f,
              "set multiplot layout 1,2 title \"Regression dt = a_1 (R/V)^{a_2} for each damping "
              "ratio\\n{/*0.8 lines: regression; marks: limits by %s}\"\n",
              has_stepping(s) ? "time stepping" : "linear theory");
  output_text(&f,
              "set logscale xy\nset format xy '10^{%%T}'\nset xrange [0.0002:0.03]\n"
              "set ylabel 'critical time step (s)'\nset key right bottom reverse Left samplen 1.5\n"
              "set palette defined (0 '#1b4f8c', 0.5 '#1e8449', 1 '#c0392b')\n"
              "unset colorbox\nset cbrange [-3:0]\n");
  for (int wave = 0; wave < 2; wave++) {
    const limit_fit *fit = &shown(s, wave)->fit;
    output_text(&f, "set xlabel 'R / V_%c (s)'\nset title '%s wave'\nplot ", "SP"[wave],
                wave == 0 ? "shear" : "pressure");
    for (int32_t i = 0; i < fit->dampings; i++)
      output_text(&f, "%.9g*x**%.9g with lines linecolor palette cb %.4g title 'h = %g', \\\n  ",
                  fit->a1[i], fit->a2[i], log10(fit->h[i]), fit->h[i]);
    output_text(&f,
                "'limits.csv' every ::1 using ($2/$3):((strcol(1) eq '%c') ? $%d : "
                "NaN):(log10($4)) with points pointtype 7 pointsize 0.7 linecolor palette "
                "notitle\n",
                "SP"[wave], has_stepping(s) ? 6 : 5);
  }
  return close_pair(&f, directory, "fig08");
}

static bool figure9(app *a, const study *s, const char *directory) {
  output f;
  if (!plot_open(&f, a, directory, "fig09", 1500, 780)) return false;
  output_text(&f,
              "set multiplot layout 1,2 title \"Coefficients of the regression against damping\\n"
              "{/*0.8 of the limits by %s}\"\n",
              has_stepping(s) ? "time stepping" : "linear theory");
  output_text(&f, "set logscale x\nset xlabel 'damping ratio h'\nset xrange [0.0007:1.4]\n"
                  "set key left top reverse Left samplen 2.5\n");
  for (int k = 1; k <= 2; k++) {
    if (k == 1)
      output_text(&f,
                  "set logscale y\nset yrange [0.5:300]\nset ylabel 'a_1'\nset title 'a_1'\nplot ");
    else
      output_text(&f, "unset logscale y\nset ylabel 'a_2'\nset title 'a_2'\nset yrange [0.8:2.2]\n"
                      "plot ");
    for (int wave = 0; wave < 2; wave++) {
      const char w = "SP"[wave];
      const char *colour = colours[wave == 0 ? 0 : 3];
      char where[64];
      snprintf(where, sizeof where, "strcol(1) eq '%c' && strcol(2) eq '%s'", w, shown_name(s));
      output_text(&f,
                  "'regression.csv' every ::1 using 3:((%s) ? $%d : NaN) with points pointtype %d "
                  "pointsize 1.3 linecolor rgb '%s' title '%c wave', \\\n  ",
                  where, 3 + k, wave == 0 ? 7 : 5, colour, w);
      output_text(&f,
                  "'regression.csv' every ::1 using 3:((%s) ? $%d : NaN) with lines linecolor rgb "
                  "'%s' title '%c: own quadratic', \\\n  ",
                  where, 5 + k, colour, w);
      output_text(&f,
                  "'regression.csv' every ::1 using 3:((%s) ? $%d : NaN) with lines dashtype 2 "
                  "linecolor rgb '%s' title '%c: Table 2 as printed'%s",
                  where, 7 + k, colour, w, separator(wave == 1));
    }
  }
  return close_pair(&f, directory, "fig09");
}

static bool figure10(app *a, const study *s, const char *directory) {
  output f;
  const int column = has_stepping(s) ? 6 : 5;
  if (!plot_open(&f, a, directory, "fig10", 1500, 780)) return false;
  output_text(&f, "set multiplot layout 1,2 title \"Critical time step by the regression against "
                  "that found (h up to 0.22)\\n{/*0.8 grey: within 20 %%}\"\n");
  output_text(&f,
              "set logscale xy\nset format xy '10^{%%T}'\nset xlabel 'found by %s (s)'\n"
              "set ylabel 'by the regression (s)'\nset key right bottom reverse Left samplen "
              "1.5\nset size square\n"
              "set xrange [8e-6:6e-2]\nset yrange [8e-6:6e-2]\n",
              has_stepping(s) ? "time stepping" : "linear theory");
  for (int wave = 0; wave < 2; wave++) {
    const limit_fit *fit = &shown(s, wave)->fit;
    output_text(&f, "a1(h) = 10**(%.9g*log10(h)**2 + %.9g*log10(h) + %.9g)\n", fit->b1[0],
                fit->b1[1], fit->b1[2]);
    output_text(&f, "a2(h) = 10**(%.9g*log10(h)**2 + %.9g*log10(h) + %.9g)\n", fit->b2[0],
                fit->b2[1], fit->b2[2]);
    output_text(&f, "set title '%s wave'\nplot ", wave == 0 ? "shear" : "pressure");
    output_text(&f, "'+' using 1:($1/1.2):($1*1.2) with filledcurves fillcolor rgb '#e4e4e4' "
                    "notitle, '+' using 1:1 with lines linecolor rgb '#777777' notitle, \\\n  ");
    char where[48];
    snprintf(where, sizeof where, "strcol(1) eq '%c' && $4 < 0.23", "SP"[wave]);
    output_text(&f,
                "'limits.csv' every ::1 using %d:((%s) ? $7 : NaN) with points pointtype 4 "
                "pointsize 1 linecolor rgb '%s' title 'Table 2 as printed', \\\n  ",
                column, where, colours[3]);
    output_text(&f,
                "'limits.csv' every ::1 using %d:((%s) ? a1($4)*($2/$3)**a2($4) : NaN) with "
                "points pointtype 7 pointsize 0.8 linecolor rgb '%s' title 'own regression'\n",
                column, where, colours[0]);
  }
  return close_pair(&f, directory, "fig10");
}

bool study_draw(app *a, const study *s, const char *directory) {
  return figure3(a, s, directory) && figure4(a, s, directory) && figure5(a, s, directory) &&
         figure6(a, s, directory) && figure7(a, s, directory) && figure8(a, s, directory) &&
         figure9(a, s, directory) && figure10(a, s, directory);
}
