/* mps-info - contents of a result file of libmps: the fields with their units, frames and times of
 * a series, and how to restart from a checkpoint.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "info/info.h"

#include <errno.h>
#include <stdio.h>
#include <string.h>

enum { OK = 0, FAILED = 1, USAGE = 2 };

static const char help[] =
    "Usage: mps-info [--json] FILE...\n"
    "Shows what is in result files of libmps. Of a series for ParaView: frames, times, particles,\n"
    "fields and their units. Of a checkpoint: the program and its options, solver, time, step,\n"
    "fields, and how a run goes on from it. No file is changed; a damaged checkpoint is an error.\n"
    "\n"
    "  --json      one JSON list with an object a file; names carry the unit (time_s)\n"
    "  --help      show this text\n"
    "  --version   show the version of the library\n"
    "\n"
    "Exit status: 0; 1 where a file cannot be read or is of another kind, the others are shown;\n"
    "2 for a wrong option.\n";

static int complain(const char *path, const char *why) {
  fprintf(stderr, "mps-info: %s: %s\n", path, why);
  return FAILED;
}

static bool readable(const char *path, char *why) {
  FILE *file = fopen(path, "rb");
  if (file && fgetc(file) == EOF && !feof(file)) { /* a directory can be opened */
    snprintf(why, INFO_WHY, "%s", strerror(errno));
    fclose(file);
    return false;
  }
  if (!file) {
    snprintf(why, INFO_WHY, "%s", strerror(errno));
    return false;
  }
  fclose(file);
  return true;
}

/* Why a file is not looked into: of the text beside a series, where its frames are. */
static void refuse(const char *path, char *why) {
  const char *ending = strrchr(path, '.');
  if (ending && strcmp(ending, ".xdmf") == 0)
    snprintf(why, INFO_WHY,
             "names frames for ParaView 5.11, which are in the .vtkhdf file beside it");
  else
    snprintf(why, INFO_WHY, "not an HDF5 file, or a damaged one");
}

static int show(report *r, mps_context *context, const char *path) {
  char why[INFO_WHY] = "", format[40];
  bool good = false;
  if (!readable(path, why)) return complain(path, why);
  const hid_t file = H5Fis_hdf5(path) > 0 ? H5Fopen(path, H5F_ACC_RDONLY, H5P_DEFAULT) : -1;
  if (file < 0)
    refuse(path, why);
  else if (info_text(file, "format", format, sizeof format) &&
           strcmp(format, "libmps checkpoint") == 0)
    good = info_checkpoint(r, context, path, file, why);
  else if (H5Lexists(file, "VTKHDF", H5P_DEFAULT) > 0)
    good = info_series(r, path, file, why);
  else
    snprintf(why, sizeof why, "neither a checkpoint nor a series of libmps");
  if (file >= 0) H5Fclose(file);
  return good ? OK : complain(path, why);
}

/* The options; `argv` keeps the files, whose number is returned in *files. -1: continue. */
static int parse(int argc, char **argv, bool *json, int *files) {
  *files = 0;
  for (int k = 1; k < argc; k++) {
    if (strcmp(argv[k], "--help") == 0 || strcmp(argv[k], "-h") == 0)
      return fputs(help, stdout) < 0 || fflush(stdout) != 0 ? FAILED : OK;
    if (strcmp(argv[k], "--version") == 0)
      return printf("mps-info (libmps %s)\n", mps_version()) < 0 || fflush(stdout) != 0 ? FAILED
                                                                                        : OK;
    if (strcmp(argv[k], "--json") == 0)
      *json = true;
    else if (argv[k][0] == '-' && argv[k][1] != '\0') {
      fprintf(stderr, "mps-info: unknown option %s, see mps-info --help\n", argv[k]);
      return USAGE;
    } else
      argv[++*files] = argv[k];
  }
  if (*files > 0) return -1;
  fprintf(stderr, "mps-info: no file given, see mps-info --help\n");
  return USAGE;
}

int main(int argc, char **argv) {
  report r = {0};
  int files;
  int code = parse(argc, argv, &r.json, &files);
  if (code >= 0) return code;
  mps_context *context = NULL;
  char why[INFO_WHY];
  if (mps_context_create(NULL, &context, why, sizeof why) != MPS_OK) return complain("libmps", why);
  H5Eset_auto2(H5E_DEFAULT, NULL, NULL); /* the error in one line */
  code = OK;
  report_open(&r);
  for (int k = 1; k <= files; k++)
    if (show(&r, context, argv[k]) != OK) code = FAILED;
  report_close(&r);
  mps_context_destroy(&context);
  if (fflush(stdout) != 0 || ferror(stdout)) return complain("standard output", strerror(errno));
  return code;
}
