/* options.c - table driven command line options.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "options.h"

#include <mps/base.h>

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { USAGE = 2, HELP_COLUMN = 34, HELP_END = 98, MAX_NAME = 40 };

/* The programs never call setlocale, so strtod reads the C locale's decimal point. */
bool options_number(const char *text, double *out) {
  if (*text == '\0' || text[strspn(text, "0123456789+-.eE")] != '\0') return false;
  char *end;
  const double value = strtod(text, &end);
  if (*end != '\0' || !isfinite(value)) return false;
  *out = value;
  return true;
}

bool options_lengths(const char *text, int count, double *const *out) {
  for (int k = 0; k < count; k++) {
    char number[32];
    const size_t length = strcspn(text, "x");
    if (length >= sizeof number || (text[length] == 'x') != (k < count - 1)) return false;
    memcpy(number, text, length);
    number[length] = '\0';
    if (!options_number(number, out[k]) || *out[k] <= 0.0) return false;
    text += length + 1;
  }
  return true;
}

/* ---- help ------------------------------------------------------------------------------------ */

/* Prints words in the columns HELP_COLUMN..HELP_END, the cursor being at `at`. */
static void print_wrapped(const char *text, int at) {
  if (at >= HELP_COLUMN - 1) {
    putchar('\n');
    at = 0;
  }
  printf("%*s", HELP_COLUMN - at, "");
  at = HELP_COLUMN;
  while (*text) {
    const int word = (int)strcspn(text, " ");
    if (at > HELP_COLUMN && at + 1 + word > HELP_END) {
      printf("\n%*s", HELP_COLUMN, "");
      at = HELP_COLUMN;
    } else if (at > HELP_COLUMN) {
      putchar(' ');
      at++;
    }
    printf("%.*s", word, text);
    at += word;
    text += word;
    text += strspn(text, " ");
  }
  putchar('\n');
}

static void describe_range(const option *o, char *out, size_t size) {
  const option_range r = o->range;
  if (r.lower == 0.0 && r.upper == 0.0)
    snprintf(out, size, "finite");
  else if (r.upper >= 1e300)
    snprintf(out, size, "%s %g", r.open ? ">" : ">=", r.lower);
  else
    snprintf(out, size, "in %c%g, %g]", r.open ? '(' : '[', r.lower, r.upper);
}

/* The index-th word of a choice "S|P". */
static const char *choice_word(const char *choices, int index, int *length) {
  while (index-- > 0) choices += strcspn(choices, "|") + 1;
  *length = (int)strcspn(choices, "|");
  return choices;
}

static void describe_default(const option *o, char *out, size_t size) {
  out[0] = '\0';
  if (o->number && o->count < 2 && !isnan(*o->number))
    snprintf(out, size, "; default %g", *o->number);
  else if (o->integer)
    snprintf(out, size, "; default %lld", (long long)*o->integer);
  else if (o->text && *o->text)
    snprintf(out, size, "default %s", *o->text);
  else if (o->choice) {
    int length;
    const char *word = choice_word(o->unit, *o->choice, &length);
    snprintf(out, size, "default %.*s", length, word);
  }
}

static void print_option(const option *o) {
  int at = printf("  --%s", o->name);
  if (o->unit) at += printf(" %s%s%s", o->number ? "[" : "", o->unit, o->number ? "]" : "");
  char range[64] = "", standard[64], text[600];
  if (o->number || o->integer) describe_range(o, range, sizeof range);
  describe_default(o, standard, sizeof standard);
  if (range[0] || standard[0])
    snprintf(text, sizeof text, "%s (%s%s)", o->help, range, standard);
  else
    snprintf(text, sizeof text, "%s", o->help);
  print_wrapped(text, at);
}

static int print_help(const options_program *program) {
  printf("Usage: %s [options]\n%s\n", program->name, program->purpose);
  for (const option *o = program->table; o->name || o->help; o++) {
    if (o->name)
      print_option(o);
    else
      printf("\n%s\n", o->help);
  }
  printf("\nHelp\n");
  print_wrapped("show this text", printf("  --help"));
  print_wrapped("show the version of the library", printf("  --version"));
  return 0;
}

/* What was printed must have arrived: a full disk is an error. */
static int close_output(const options_program *program) {
  if (fflush(stdout) == 0 && !ferror(stdout)) return 0;
  fprintf(stderr, "%s: standard output could not be written\n", program->name);
  return 1;
}

/* ---- unknown options ------------------------------------------------------------------------- */

/* Levenshtein distance of two short words. */
static int distance(const char *a, const char *b) {
  int row[MAX_NAME + 1];
  const int n = (int)strlen(b);
  if (n > MAX_NAME) return MAX_NAME;
  for (int j = 0; j <= n; j++) row[j] = j;
  for (int i = 1; a[i - 1]; i++) {
    int diagonal = row[0];
    row[0] = i;
    for (int j = 1; j <= n; j++) {
      const int substitute = diagonal + (a[i - 1] != b[j - 1]);
      diagonal = row[j];
      const int gap = (row[j] < row[j - 1] ? row[j] : row[j - 1]) + 1;
      row[j] = substitute < gap ? substitute : gap;
    }
  }
  return row[n];
}

static int refuse_unknown(const options_program *program, const char *name) {
  const char *nearest = NULL;
  int least = 4; /* farther names are no help */
  for (const option *o = program->table; o->name || o->help; o++) {
    if (!o->name) continue;
    const int d = distance(name, o->name);
    if (d < least) {
      least = d;
      nearest = o->name;
    }
  }
  if (nearest)
    fprintf(stderr, "%s: unknown option --%s, did you mean --%s?\n", program->name, name, nearest);
  else
    fprintf(stderr, "%s: unknown option --%s, see %s --help\n", program->name, name, program->name);
  return USAGE;
}

/* ---- values ---------------------------------------------------------------------------------- */

static int refuse_value(const options_program *program, const option *o, const char *value,
                        const char *allowed) {
  const bool unit = (o->number || o->integer) && o->unit && strcmp(o->unit, "1") != 0;
  fprintf(stderr, "%s: --%s is %s%s%s, must be %s\n", program->name, o->name,
          *value ? value : "empty", unit ? " " : "", unit ? o->unit : "", allowed);
  return USAGE;
}

static bool in_range(const option_range *r, double value) {
  if (r->lower == 0.0 && r->upper == 0.0) return true;
  return (r->open ? value > r->lower : value >= r->lower) && value <= r->upper;
}

static int read_numbers(const options_program *program, const option *o, const char *value) {
  const int count = o->count > 1 ? o->count : 1;
  char allowed[128], range[64], word[64];
  describe_range(o, range, sizeof range);
  if (count > 1)
    snprintf(allowed, sizeof allowed, "%d numbers separated by commas, each %s", count, range);
  else
    snprintf(allowed, sizeof allowed, "%s%s",
             strcmp(range, "finite") == 0 ? "a finite number" : range,
             o->integer ? " and an integer" : "");
  const char *rest = value;
  for (int i = 0; i < count; i++) {
    const size_t length = i + 1 < count ? strcspn(rest, ",") : strlen(rest);
    double number;
    if (length >= sizeof word) return refuse_value(program, o, value, allowed);
    memcpy(word, rest, length);
    word[length] = '\0';
    if (!options_number(word, &number) || !in_range(&o->range, number))
      return refuse_value(program, o, value, allowed);
    if (o->integer) {
      if (number != floor(number) || fabs(number) > 9007199254740992.0)
        return refuse_value(program, o, value, allowed);
      *o->integer = (int64_t)number;
    } else {
      o->number[i] = number;
    }
    rest += length;
    if (i + 1 < count) {
      if (*rest != ',') return refuse_value(program, o, value, allowed);
      rest++;
    }
  }
  return -1;
}

static int read_choice(const options_program *program, const option *o, const char *value) {
  const char *word = o->unit;
  for (int i = 0;; i++) {
    const size_t length = strcspn(word, "|");
    if (strlen(value) == length && strncmp(word, value, length) == 0) {
      *o->choice = i;
      return -1;
    }
    if (word[length] == '\0') break;
    word += length + 1;
  }
  char allowed[160];
  snprintf(allowed, sizeof allowed, "one of %s", o->unit);
  return refuse_value(program, o, value, allowed);
}

static int read_value(const options_program *program, option *o, const char *value) {
  o->given = true;
  if (o->choice) return read_choice(program, o, value);
  if (o->number || o->integer) return read_numbers(program, o, value);
  if (*value == '\0') return refuse_value(program, o, value, o->unit);
  *o->text = value;
  return -1;
}

/* ---- arguments ------------------------------------------------------------------------------- */

static option *find(option *table, const char *name) {
  for (option *o = table; o->name || o->help; o++)
    if (o->name && strcmp(o->name, name) == 0) return o;
  return NULL;
}

int options_parse(const options_program *program, int argc, char **argv) {
  for (int i = 1; i < argc; i++) {
    const char *argument = argv[i];
    if (strcmp(argument, "--help") == 0 || strcmp(argument, "-h") == 0) {
      print_help(program);
      return close_output(program);
    }
    if (strcmp(argument, "--version") == 0) {
      printf("%s (libmps %s)\n", program->name, mps_version());
      return close_output(program);
    }
    if (strncmp(argument, "--", 2) != 0) {
      fprintf(stderr, "%s: unexpected argument \"%s\", see %s --help\n", program->name, argument,
              program->name);
      return USAGE;
    }
    char name[MAX_NAME + 1];
    const size_t length = strcspn(argument + 2, "=");
    snprintf(name, sizeof name, "%.*s", (int)(length < MAX_NAME ? length : MAX_NAME), argument + 2);
    option *o = find(program->table, name);
    if (!o) return refuse_unknown(program, name);
    const char *value = argument[2 + length] == '=' ? argument + 3 + length : NULL;
    if (o->flag) {
      if (value) return refuse_value(program, o, value, "given without a value");
      *o->flag = o->given = true;
      continue;
    }
    if (!value && (i + 1 >= argc || strncmp(argv[i + 1], "--", 2) == 0)) {
      fprintf(stderr, "%s: --%s needs a value: %s\n", program->name, name,
              o->unit ? o->unit : "a number");
      return USAGE;
    }
    const int code = read_value(program, o, value ? value : argv[++i]);
    if (code >= 0) return code;
  }
  return -1;
}

bool options_given(const option *table, const char *name) {
  for (const option *o = table; o->name || o->help; o++)
    if (o->name && strcmp(o->name, name) == 0) return o->given;
  return false;
}

int options_refuse(const options_program *program, const char *reason) {
  fprintf(stderr, "%s: %s\n", program->name, reason);
  return USAGE;
}
