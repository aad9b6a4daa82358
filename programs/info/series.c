/* series.c - frames, times and fields of a series for ParaView (VTKHDF).
 * SPDX-License-Identifier: BSD-3-Clause */
#include "info.h"

#include <stdio.h>
#include <stdlib.h>

typedef struct frames {
  int64_t count;
  double *time;       /* s, of each */
  int64_t *particles; /* of each part */
  int64_t parts;
} frames;

static bool read_frames(hid_t root, frames *f) {
  f->count = info_rows(root, "Steps/Values");
  f->parts = info_rows(root, "NumberOfPoints");
  if (f->count < 0 || f->parts < 0 || f->count > INT32_MAX || f->parts > INT32_MAX) return false;
  f->time = calloc((size_t)f->count + 1, sizeof *f->time);
  f->particles = calloc((size_t)f->parts + 1, sizeof *f->particles);
  return f->time && f->particles &&
         info_read(root, "Steps/Values", H5T_NATIVE_DOUBLE, f->count, f->time) &&
         info_read(root, "NumberOfPoints", H5T_NATIVE_INT64, f->parts, f->particles);
}

static void print(report *r, const char *path, const char *library, const frames *f,
                  const info_fields *fields) {
  char sentence[160], count[80];
  int64_t least = f->parts ? f->particles[0] : 0, most = least;
  for (int64_t k = 1; k < f->parts; k++) {
    least = f->particles[k] < least ? f->particles[k] : least;
    most = f->particles[k] > most ? f->particles[k] : most;
  }
  snprintf(sentence, sizeof sentence, "series of frames for ParaView%s%s",
           library[0] ? ", written by libmps " : "", library);
  report_begin(r, path, "series", sentence);
  if (r->json && library[0]) report_text(r, "version", library);
  report_integer(r, "frames", f->count);
  if (f->count > 0) {
    report_number(r, r->json ? "time_first_s" : "first", f->time[0], "s");
    report_number(r, r->json ? "time_last_s" : "last", f->time[f->count - 1], "s");
  }
  if (r->json) {
    report_integer(r, "particles_least", least);
    report_integer(r, "particles_most", most);
  } else {
    snprintf(count, sizeof count, "%lld to %lld", (long long)least, (long long)most);
    if (least == most) snprintf(count, sizeof count, "%lld", (long long)least);
    report_text(r, "particles", count);
  }
  report_list(r, "fields");
  for (hsize_t k = 0; k < fields->count; k++)
    report_row(r, fields->field[k].name, fields->field[k].text);
  report_list_end(r);
  report_end(r);
}

bool info_series(report *r, const char *path, hid_t file, char *why) {
  frames f = {0};
  info_fields fields = {0};
  char library[40];
  const hid_t root = H5Gopen2(file, "VTKHDF", H5P_DEFAULT);
  const hid_t data = root < 0 || H5Lexists(root, "PointData", H5P_DEFAULT) <= 0
                         ? -1
                         : H5Gopen2(root, "PointData", H5P_DEFAULT);
  const bool good = data >= 0 && info_rows(root, "Steps/Values") >= 0 && read_frames(root, &f) &&
                    info_list_fields(data, false, &fields);
  info_text(file, "library", library, sizeof library);
  if (good)
    print(r, path, library, &f, &fields);
  else
    snprintf(why, INFO_WHY, "a VTKHDF file, but not a series of particles in time");
  if (data >= 0) H5Gclose(data);
  if (root >= 0) H5Gclose(root);
  free(f.time);
  free(f.particles);
  free(fields.field);
  return good;
}
