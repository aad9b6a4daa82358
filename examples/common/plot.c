/* plot.c - runs gnuplot on a script in its directory, without a shell.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "plot.h"

#include <errno.h>
#include <string.h>
#include <sys/wait.h>
#include <unistd.h>

bool plot_open(output *script, app *a, const char *directory, const char *name, int width,
               int height) {
  char file[80];
  snprintf(file, sizeof file, "%s.gp", name);
  if (!output_open(script, a, directory, file)) return false;
  output_text(script,
              "# Draws %s.png from the CSV files beside it: gnuplot %s.gp\n"
              "set terminal pngcairo size %d,%d enhanced font 'DejaVu Sans,15' linewidth 1.5\n"
              "set output '%s.png'\n"
              "set encoding utf8\n"
              "set datafile separator ','\n"
              "set datafile missing NaN\n"
              "set border linecolor rgb '#333333'\n"
              "set tics nomirror out\n"
              "set grid linecolor rgb '#dddddd' linetype 1 linewidth 0.6\n",
              name, name, width, height, name);
  return true;
}

enum { NOT_FOUND = 127, NO_DIRECTORY = 126 };

/* The exit status of `gnuplot NAME.gp` in `directory`, or -1. The child only calls functions that
 * are safe after fork in a program with threads. */
static int run(const char *directory, const char *file) {
  const pid_t child = fork();
  if (child < 0) return -1;
  if (child == 0) {
    if (chdir(directory) != 0) _exit(NO_DIRECTORY);
    execlp("gnuplot", "gnuplot", file, (char *)NULL);
    _exit(errno == ENOENT ? NOT_FOUND : NO_DIRECTORY);
  }
  int status;
  while (waitpid(child, &status, 0) < 0)
    if (errno != EINTR) return -1;
  return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
}

bool plot_close(output *script, const char *directory, const char *name) {
  app *a = script->a;
  if (!output_close(script)) return false;
  char file[80];
  snprintf(file, sizeof file, "%s.gp", name);
  progress_clear(&a->bar);
  fflush(stdout);
  const int status = run(directory, file);
  if (status == 0) return true;
  if (status == NOT_FOUND) {
    if (!a->no_gnuplot)
      printf("No pictures: gnuplot is not installed. Later: cd '%s' && gnuplot *.gp\n", directory);
    a->no_gnuplot = true;
    return true;
  }
  return app_error(a, "gnuplot could not draw %s/%s (status %d)", directory, file, status);
}
