/* plot.c - a script of variables, style and template; gnuplot runs on it in its directory, without
 * a shell, and its picture is kept only when it is complete. SPDX-License-Identifier: BSD-3-Clause
 */
#include "plot.h"

#include <errno.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/wait.h>
#include <unistd.h>

/* ---- the script ------------------------------------------------------------------------------ */

/* Opens the template NAME for reading: in the folder $MPS_PLOTS, beside the program where it is
 * installed or built, or where it was to be installed. */
static FILE *open_template(const char *name) {
  char program[3000], path[4096];
  const ssize_t length = readlink("/proc/self/exe", program, sizeof program - 1);
  program[length > 0 ? length : 0] = '\0';
  char *slash = strrchr(program, '/');
  if (slash) *slash = '\0';
  const char *const folders[] = {getenv("MPS_PLOTS"), "", slash ? program : NULL, PLOTS_BESIDE,
                                 PLOTS_INSTALLED,     ""};
  for (int k = 0; k < 6; k += 2) {
    if (!folders[k] || !*folders[k]) continue;
    snprintf(path, sizeof path, "%s%s/%s", folders[k], folders[k + 1], name);
    FILE *f = fopen(path, "r");
    if (f) return f;
  }
  return NULL;
}

/* Without a template there is no picture, but the results stay. */
static bool no_template(app *a, const char *name) {
  if (!a->no_gnuplot)
    printf("No pictures: the template %s of libmps is not found: set MPS_PLOTS to its folder\n",
           name);
  return a->no_gnuplot = true;
}

/* Appends the template; its line "load 'style.gp'" becomes the text of that file. */
static bool append(output *script, const char *name) {
  FILE *f = open_template(name);
  char line[1200];
  if (!f) return false;
  bool good = true;
  while (good && fgets(line, sizeof line, f))
    if (strcmp(line, "load 'style.gp'\n") == 0)
      good = append(script, "style.gp");
    else
      output_text(script, "%s", line);
  fclose(f);
  return good;
}

bool plot_begin(output *script, app *a, const char *directory, const char *name) {
  char file[80];
  *script = (output){.a = a};
  FILE *style = open_template("style.gp");
  if (!style) return no_template(a, "style.gp");
  fclose(style);
  const char *point = strchr(name, '.');
  const int stem = (int)(point ? point - name : (ptrdiff_t)strlen(name));
  snprintf(file, sizeof file, "%.*s.gp", stem, name);
  if (!output_open(script, a, directory, file)) return false;
  output_text(script,
              "# Draws %.*s%s from the files beside it: gnuplot %s\nreset\nnan = NaN; inf = 1e308\n"
              "if (!exists(\"picture\")) picture = '%.*s%s'\n",
              stem, name, point ? point : ".png", file, stem, name, point ? point : ".png");
  return true;
}

/* ---- gnuplot --------------------------------------------------------------------------------- */

enum { NOT_FOUND = 127, NO_DIRECTORY = 126 };

/* In the child, which only calls functions that are safe after fork in a program with threads. Its
 * group of processes is its own: Ctrl-C on the terminal does not reach it, and the picture of an
 * interrupted run is drawn. */
static void become_gnuplot(const char *directory, const char *picture, const char *file,
                           int report) {
  setpgid(0, 0);
  if (dup2(report, STDOUT_FILENO) < 0 || dup2(report, STDERR_FILENO) < 0 || chdir(directory) != 0)
    _exit(NO_DIRECTORY);
  execlp("gnuplot", "gnuplot", "-e", picture, file, (char *)NULL);
  _exit(errno == ENOENT || errno == ENOTDIR ? NOT_FOUND : NO_DIRECTORY);
}

/* The exit status of gnuplot, or -1; `said` is the beginning of its output. */
static int run(const char *directory, const char *picture, const char *file, char *said,
               size_t size) {
  int ends[2], status;
  said[0] = '\0';
  if (pipe(ends) != 0) return -1;
  const pid_t child = fork();
  if (child == 0) become_gnuplot(directory, picture, file, ends[1]);
  close(ends[1]);
  char chunk[512];
  size_t used = 0;
  for (ssize_t got; child > 0;) {
    got = read(ends[0], chunk, sizeof chunk);
    if (got < 0 && errno == EINTR) continue;
    if (got <= 0) break;
    const size_t room = size - 1 - used, part = (size_t)got < room ? (size_t)got : room;
    memcpy(said + used, chunk, part);
    said[used += part] = '\0';
  }
  close(ends[0]);
  if (child < 0) return -1;
  while (waitpid(child, &status, 0) < 0)
    if (errno != EINTR) return -1;
  return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
}

/* The line of gnuplot's report that gives the reason: the one with "line N:", else the last one. */
static const char *reason_of(char *said) {
  const char *reason = NULL;
  for (char *line = strtok(said, "\n"); line; line = strtok(NULL, "\n")) {
    line += strspn(line, " \t");
    if (!*line || *line == '^') continue;
    const char *found = strstr(line, "line ");
    if (found && strchr(found, ':')) return found;
    reason = line;
  }
  return reason ? reason : "gnuplot gave no reason";
}

/* ---- the picture ----------------------------------------------------------------------------- */

/* A PNG begins with its signature and ends with the chunk IEND; a GIF with GIF8 and a semicolon. */
static bool is_complete(const char *path, const char *kind) {
  static const unsigned char begin[8] = {0x89, 'P', 'N', 'G', '\r', '\n', 0x1a, '\n'};
  static const unsigned char end[8] = {'I', 'E', 'N', 'D', 0xae, 0x42, 0x60, 0x82};
  unsigned char first[8], last[8];
  FILE *f = fopen(path, "rb");
  if (!f) return false;
  const bool read =
      fread(first, 1, 8, f) == 8 && fseek(f, -8, SEEK_END) == 0 && fread(last, 1, 8, f) == 8;
  fclose(f);
  if (strcmp(kind, "gif") == 0) return read && memcmp(first, "GIF8", 4) == 0 && last[7] == ';';
  return read && memcmp(first, begin, 8) == 0 && memcmp(last, end, 8) == 0;
}

static bool draw(app *a, const char *directory, const char *name, const char *kind) {
  char variable[120], script[80], said[2048], picture[4096], part[4096];
  snprintf(script, sizeof script, "%s.gp", name);
  snprintf(variable, sizeof variable, "picture='%s.%s.part'", name, kind);
  if (snprintf(picture, sizeof picture, "%s/%s.%s", directory, name, kind) >= (int)sizeof picture ||
      snprintf(part, sizeof part, "%s/%s.%s.part", directory, name, kind) >= (int)sizeof part)
    return app_error(a, "the path of %s.%s is too long", name, kind);
  const int empty = output_exclusive(part); /* for gnuplot, which would follow a link */
  if (empty < 0 || close(empty) != 0)
    return app_error(a, "cannot draw %s: cannot write %s: %s", picture, part,
                     errno == EEXIST ? "something that is no file has this name" : strerror(errno));
  const int status = run(directory, variable, script, said, sizeof said);
  if (status == NOT_FOUND) {
    unlink(part);
    if (!a->no_gnuplot)
      printf("No pictures: gnuplot is not installed. Later: cd '%s' && gnuplot *.gp\n", directory);
    a->no_gnuplot = true;
    return true;
  }
  if (status == 0 && is_complete(part, kind) && rename(part, picture) == 0) {
    app_wrote(a, picture);
    return true;
  }
  unlink(part);
  return app_error(a, "cannot draw %s: %s", picture,
                   status == 0 ? "the picture is cut off, as on a full disk" : reason_of(said));
}

bool plot_end(output *script, const char *directory, const char *name, const char *template) {
  char file[80], stem[64];
  app *a = script->a;
  if (!script->stream) return true; /* plot_begin has said why */
  snprintf(file, sizeof file, "%s.gp", template);
  if (!append(script, file)) {
    output_discard(script);
    return no_template(a, file);
  }
  snprintf(stem, sizeof stem, "%.*s", (int)strcspn(name, "."), name);
  output_text(script, "unset output\nundefine picture\n");
  if (!output_close(script)) return false;
  progress_clear(&a->bar);
  fflush(stdout);
  return draw(a, directory, stem, strstr(name, ".gif") ? "gif" : "png");
}

bool plot_draw(app *a, const char *directory, const char *name, const char *template,
               const char *variables, ...) {
  output script;
  if (!plot_begin(&script, a, directory, name)) return false;
  va_list args;
  va_start(args, variables);
  output_list(&script, variables, args);
  va_end(args);
  output_text(&script, "\n");
  return plot_end(&script, directory, name, template);
}
