/* record_at2.c - PEER strong motion files (.AT2). Header lines, four in most files, of which the
 * last has the number of samples and the step, in one of the spellings
 *   NPTS=  4000, DT= .0050 SEC        4000 0.005 NPTS, DT
 * and then come NPTS accelerations, any number of them on a line, in g where the header names no
 * other unit.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "record_private.h"

/* A line that ends the header; one of a comment belongs to a CSV. */
static bool is_size(mpsi_slice line) {
  mpsi_slice_trim(&line);
  return mpsi_slice_size(line) > 0 && *line.begin != '#' && mpsi_slice_find(line, "NPTS", NULL) &&
         mpsi_slice_find(line, "DT", NULL);
}

bool mpsi_at2_matches(mpsi_text text) {
  mpsi_slice line;
  while (text.line < MPSI_RECORD_HEADER && mpsi_text_line(&text, &line))
    if (is_size(line)) return true;
  return false;
}

static mps_status read_header(mpsi_text *text, mpsi_header *h) {
  mpsi_slice line = {0};
  do {
    if (text->line == MPSI_RECORD_HEADER || !mpsi_text_line(text, &line))
      return mpsi_text_fail(text, "no line with NPTS= and DT= ends the header of an AT2 file");
    const mpsi_quote quote = mpsi_slice_quote(line);
    MPSI_TRY(mpsi_header_line(text, line, h));
    /* the files of velocities (.VT2) and displacements (.DT2) look the same but for one line */
    if (h->velocity || h->displacement ||
        (h->unit && h->unit->quantity != MPS_SIGNAL_QUANTITY_ACCELERATION))
      return mpsi_text_fail(text, "\"%s\": an AT2 file of accelerations is expected", quote.text);
  } while (!is_size(line));
  if (isnan(h->count) || isnan(h->step))
    return mpsi_text_fail(text, "\"%s\": NPTS= and DT= with their numbers are expected here",
                          mpsi_slice_quote(line).text);
  return mpsi_header_size(text, "NPTS", h->count, h->step);
}

mps_status mpsi_at2_read(mpsi_text *text, mpsi_samples *samples) {
  static const char g[] = "g";
  mpsi_header h = {.count = NAN, .step = NAN};
  MPSI_TRY(read_header(text, &h));
  MPSI_TRY(mpsi_header_step(text, samples, &h.step));
  samples->unit = h.unit ? h.unit : mpsi_unit_find((mpsi_slice){g, g + 1});
  return mpsi_samples_read(text, samples, (int64_t)h.count, h.step, 0, false);
}
