/* mps-element - any law of the library at one point, along the paths of soil tests: compression,
 * oedometer, triaxial cell, plane strain, simple shear, or stages of strain and stress from a file.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "element/element.h"

#include <stdlib.h>

static bool run(element *x) {
  if (!element_make_law(x) || !element_start(x) || !element_make_path(x)) return false;
  app_leave_at_once(&x->a, true); /* a step does not look at Ctrl-C */
  const bool done = element_drive(x);
  app_leave_at_once(&x->a, false);
  return element_results(x, done) && done;
}

int main(int argc, char **argv) {
  static element x;
  static option table[ELEMENT_OPTIONS];
  settings *s = &x.s;
  x.s.threads = 1;
  element_options(s, table);
  const options_program program = {
      "mps-element",
      "A constitutive law at one point along the path of a soil test: stresses, pore pressure, "
      "void\n"
      "ratio and preconsolidation by steps of strain, or of strain and stress mixed.",
      table};
  int code = options_parse(&program, argc, argv);
  if (code >= 0) return code;
  const char *reason = element_settle(s, table);
  if (reason) return options_refuse(&program, reason);
  code = APP_FAILED;
  if (app_start(&x.a, "mps-element", s->threads) &&
      app_agree(&x.a, x.a.rank > 0 || (output_directory(&x.a, s->out) && run(&x))))
    code = APP_OK;
  mps_material_destroy(&x.material);
  free(x.stages);
  free(x.table);
  return app_finish(&x.a, code);
}
