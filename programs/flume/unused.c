/* unused.c - options of mps-flume that the rest of the model makes no use of: an error, since a
 * result without rock would otherwise look like one with the --porosity that was given.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "flume.h"

#include "common/options.h"

#include <stdio.h>

/* What an option needs, and whether the model has it. */
typedef struct need {
  const char *option, *needs;
  bool used;
} need;

static int refuse(const options_program *program, const flume *m, const need *n) {
  char text[300];
  snprintf(text, sizeof text, "--%s is not used: it needs %s", n->option, n->needs);
  return flume_refuse(program, m, text);
}

int flume_check_unused(const options_program *program, const flume *m) {
  const flume_settings *s = &m->s;
  const bool sea = s->waves == FLUME_JONSWAP || s->waves == FLUME_PM;
  const bool peaked = s->waves == FLUME_JONSWAP || s->waves == FLUME_FOCUSED;
  const bool simple = s->wall == FLUME_CAISSON || s->wall == FLUME_SLOPE;
  const bool rock = m->shape.rocks > 0, caisson = flume_is_caisson(m);
  const need list[] = {
      {"height", "--waves other than file", s->waves != FLUME_FILE},
      {"period", "--waves other than solitary", s->waves != FLUME_SOLITARY},
      {"ramp", "--waves other than solitary", s->waves != FLUME_SOLITARY},
      {"order", "--waves other than solitary", s->waves != FLUME_SOLITARY},
      {"gamma", "--waves jonswap or focused", peaked},
      {"repeat", "--waves jonswap, pm or focused", sea || s->waves == FLUME_FOCUSED},
      {"seed", "--waves jonswap or pm", sea},
      {"random", "--waves jonswap or pm", sea},
      {"focus", "--waves focused", s->waves == FLUME_FOCUSED},
      {"levels-column", "--waves file", s->waves == FLUME_FILE},
      {"levels", "--waves file", s->waves == FLUME_FILE},
      {"form", "--absorb active", s->absorb == FLUME_ACTIVE},
      {"zone", "--absorb zone", s->absorb == FLUME_ZONE},
      {"zone-rate", "--absorb zone", s->absorb == FLUME_ZONE},
      {"freeboard", "--wall caisson or slope", simple},
      {"width", "--wall caisson or slope", simple},
      {"slope", "--wall slope", s->wall == FLUME_SLOPE},
      {"wall-density", "--wall caisson or a caisson in --model", caisson},
      {"friction", "--wall caisson or a caisson in --model", caisson},
      {"passed", "--wall caisson, slope or profile, or a structure in --model with --end open",
       flume_is_open(m)},
      {"end", "a structure or a caisson in --model",
       m->text && (flume_has_structure(m) || flume_has_body(m))},
      {"porosity", "--rock, or rock in --model", rock},
      {"stone", "--rock, or rock in --model", rock},
      {"rock-alpha", "--rock, or rock in --model", rock},
      {"rock-beta", "--rock, or rock in --model", rock},
  };
  for (size_t k = 0; k < sizeof list / sizeof *list; k++)
    if (!list[k].used && options_given(m->table, list[k].option))
      return refuse(program, m, &list[k]);
  return -1;
}
