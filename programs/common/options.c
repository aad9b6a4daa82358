/* options.c - table driven command line options.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "options.h"

#include "app.h"
#include "ranks.h"
#include "units.h"
#include "vocabulary.h"

#include <mps/base.h>

#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { USAGE = 2, HELP_COLUMN = 34, HELP_END = 98, MAX_NAME = 40, MAX_ROWS = 64, MAX_NOTES = 6 };

/* Of options_parse, for options_read. A program reads its arguments once. */
static option rows_read[MAX_ROWS];
/* Of options_note. */
static char noted[MAX_NOTES][200];
static int notes;
/* Where values are read that are not on the command line: "flume.yaml, line 7". */
static const char *source;

/* To stderr, from the first of several ranks alone: all have the same options. */
static void complain(const char *format, ...) APP_PRINTF(1, 2);
static void complain(const char *format, ...) {
  va_list args;
  if (ranks_number() > 0) return;
  va_start(args, format);
  app_print_line(format, args);
  va_end(args);
}

bool options_number(const char *text, double *out) {
  return units_read(text, NULL, out) == UNITS_GOOD;
}

bool options_lengths(const char *text, const char *unit, int count, double *const *out) {
  for (int k = 0; k < count; k++) {
    char number[32];
    const size_t length = strcspn(text, "x");
    if (length >= sizeof number || (text[length] == 'x') != (k < count - 1)) return false;
    memcpy(number, text, length);
    number[length] = '\0';
    if (units_read(number, unit, out[k]) != UNITS_GOOD || *out[k] <= 0.0) return false;
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

/* 1e6 instead of 1e+06. */
static void describe_bound(double value, char out[24]) {
  char text[24];
  snprintf(text, sizeof text, "%g", value);
  const int mantissa = (int)strcspn(text, "e");
  if (text[mantissa])
    snprintf(out, 24, "%.*se%d", mantissa, text, atoi(text + mantissa + 1));
  else
    snprintf(out, 24, "%s", text);
}

static void describe_range(const option *o, char *out, size_t size) {
  char lower[24], upper[24];
  describe_bound(o->range.lower, lower);
  describe_bound(o->range.upper, upper);
  snprintf(out, size, "in %c%s, %s]", o->range.open ? '(' : '[', lower, upper);
}

/* The index-th word of a choice "S|P". */
static const char *choice_word(const char *choices, int index, int *length) {
  while (index-- > 0) choices += strcspn(choices, "|") + 1;
  *length = (int)strcspn(choices, "|");
  return choices;
}

/* The value of all but numbers and flags; false where there is none. */
static bool plain_value(const option *o, char *out, size_t size) {
  int length = 0;
  out[0] = '\0';
  if (o->integer) snprintf(out, size, "%lld", (long long)*o->integer);
  if (o->text && *o->text) snprintf(out, size, "%s", *o->text);
  const char *word = o->choice ? choice_word(o->unit, *o->choice, &length) : "";
  if (o->choice) snprintf(out, size, "%.*s", length, word);
  return out[0] != '\0';
}

/* The value as a reader likes it; false where there is none. */
static bool shown_value(const option *o, char *out, size_t size) {
  const bool number = o->number && o->count < 2 && isfinite(*o->number);
  if (number) units_show(*o->number, o->unit, out, size);
  return number || plain_value(o, out, size);
}

static void print_option(const option *o) {
  int at = printf("  --%s", o->name);
  if (o->unit) at += printf(" %s%s%s", o->number ? "[" : "", o->unit, o->number ? "]" : "");
  char range[64] = "", standard[160], help[600], text[900];
  if (o->number || o->integer) describe_range(o, range, sizeof range);
  const bool any = shown_value(o, standard, sizeof standard);
  const char *note = o->note, *join = ", ";
  if (!note)
    join = "";
  else if (strncmp(note, "of ", 3) == 0 && !strpbrk(o->help, " ,"))
    join = " ";
  else if (strncmp(note, "default", 7) == 0 || strchr(note, ':'))
    join = "; ";
  snprintf(help, sizeof help, "%s%s%s", o->help, join, o->note ? o->note : "");
  if (range[0] || any)
    snprintf(text, sizeof text, "%s (%s%s%s%s)", help, range, range[0] && any ? "; " : "",
             any ? "default " : "", standard);
  else
    snprintf(text, sizeof text, "%s", help);
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
  printf("\nNumbers are in the unit shown, or have their own: 10MPa, 5mm/s, 18kN/m3, 0.5g, 30deg.\n"
         "\nHelp\n");
  print_wrapped("show this text", printf("  --help"));
  print_wrapped("show the version of the library", printf("  --version"));
  return 0;
}

/* Checks that the output was written: a full disk is an error. */
static int close_output(const options_program *program) {
  if (fflush(stdout) == 0 && !ferror(stdout)) return 0;
  complain("%s: standard output could not be written", program->name);
  return 1;
}

/* ---- unknown options ------------------------------------------------------------------------- */

/* What an error line begins with: the program, and where the value was read, if not on the command
 * line. Options of a file are written without dashes. */
static const char *place(const options_program *program) {
  static char text[600];
  snprintf(text, sizeof text, "%s%s%s", program->name, source ? ": " : "", source ? source : "");
  return text;
}

static const char *dashes(void) { return source ? "" : "--"; }

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

/* Largest distance of an option from the typed word for a suggestion: a third of its letters. */
static int farthest(const char *name) { return (int)strlen(name) / 3; }

static int refuse_unknown(const options_program *program, const char *name) {
  const char *nearest = NULL;
  int least = MAX_NAME;
  char other[120];
  if (vocabulary_find_other(program->table, name, other, sizeof other)) {
    complain("%s: %s%s is %s%s", place(program), dashes(), name, dashes(), other);
    return USAGE;
  }
  for (const option *o = program->table; o->name || o->help; o++) {
    if (!o->name) continue;
    const size_t typed = strlen(name), length = strlen(o->name);
    const bool begins = typed > 1 && strncmp(name, o->name, typed) == 0;
    const bool ends = length > 2 && typed > length && name[typed - length - 1] == '-' &&
                      strcmp(name + typed - length, o->name) == 0; /* base-friction */
    const int d = begins || ends ? 0 : distance(name, o->name);
    if (d > farthest(o->name) || d >= least) continue;
    least = d;
    nearest = o->name;
  }
  const bool known = vocabulary_has(name);
  const char *what = source ? "key " : "option --";
  if (nearest)
    complain("%s: %s %s%s: did you mean %s%s?", place(program), known ? "there is no" : "unknown",
             what, name, dashes(), nearest);
  else if (known && !source)
    complain("%s: there is no option --%s here, see %s --help", program->name, name, program->name);
  else if (source)
    complain("%s: unknown key %s: keys are the options of %s --help, and parts of the model",
             place(program), name, program->name);
  else
    complain("%s: unknown option --%s, see %s --help", program->name, name, program->name);
  return USAGE;
}

/* ---- values ---------------------------------------------------------------------------------- */

/* A number without a unit is followed by that of the option; of one with its own the range is. */
static int refuse_value(const options_program *program, const option *o, const char *value,
                        const char *allowed) {
  const bool unit = o->number && o->unit && strcmp(o->unit, "1") != 0;
  const bool own = unit && units_written(value);
  complain("%s: %s%s is %s%s%s, must be %s%s%s", place(program), dashes(), o->name,
           *value ? value : "empty", unit && !own ? " " : "", unit && !own ? o->unit : "", allowed,
           own ? " " : "", own ? o->unit : "");
  return USAGE;
}

static int refuse_unit(const options_program *program, const option *o, const char *value) {
  char wanted[160];
  units_wanted(o->unit, wanted, sizeof wanted);
  complain("%s: %s%s is %s: %s%s", place(program), dashes(), o->name, value, wanted,
           strchr(value, ',') ? " with a decimal point" : "");
  return USAGE;
}

/* Nothing, or an infinity or NaN, which are numbers out of the range. */
static bool is_special(const char *value) {
  char *end;
  if (*value == '\0') return true;
  return !isfinite(strtod(value, &end)) && *end == '\0';
}

static bool in_range(const option_range *r, double value) {
  return (r->open ? value > r->lower : value >= r->lower) && value <= r->upper;
}

/* Numbers separated by commas; nothing is changed on an error of one of them. */
static int read_numbers(const options_program *program, option *o, const char *value) {
  enum { MOST = 8 };
  const int count = o->count > 1 ? o->count : 1;
  double number[MOST];
  char allowed[128], range[64], word[64];
  describe_range(o, range, sizeof range);
  if (count > 1)
    snprintf(allowed, sizeof allowed, "%d numbers separated by commas, each %s", count, range);
  else
    snprintf(allowed, sizeof allowed, "%s", range);
  const char *rest = value;
  for (int i = 0; i < count; i++) {
    const size_t length = i + 1 < count ? strcspn(rest, ",") : strlen(rest);
    if (length >= sizeof word) return refuse_value(program, o, value, allowed);
    memcpy(word, rest, length);
    word[length] = '\0';
    const units_status status = units_read(word, o->unit, &number[i]);
    if (status == UNITS_OTHER || (status == UNITS_NO_NUMBER && count == 1 && !is_special(value)))
      return refuse_unit(program, o, value);
    if (status != UNITS_GOOD || !in_range(&o->range, number[i]))
      return refuse_value(program, o, value, allowed);
    rest += length;
    if (i + 1 < count && *rest++ != ',') return refuse_value(program, o, value, allowed);
  }
  memcpy(o->number, number, (size_t)count * sizeof *number);
  o->bare = count == 1 && !units_written(value);
  return -1;
}

static int read_integer(const options_program *program, const option *o, const char *value) {
  char range[64], allowed[96];
  double number;
  describe_range(o, range, sizeof range);
  snprintf(allowed, sizeof allowed, "%s and an integer", range);
  if (!options_number(value, &number) || !in_range(&o->range, number) || number != floor(number) ||
      fabs(number) > 9007199254740992.0)
    return refuse_value(program, o, value, allowed);
  *o->integer = (int64_t)number;
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
  double number;
  o->given = true;
  if (o->choice) return read_choice(program, o, value);
  if (o->number) return read_numbers(program, o, value);
  if (o->integer) return read_integer(program, o, value);
  if (*value == '\0') return refuse_value(program, o, value, o->unit);
  if (strcmp(o->name, "checkpoint") == 0 && units_read(value, "s", &number) == UNITS_GOOD) {
    complain("%s: --checkpoint is %s: a file is wanted; the time between checkpoints is "
             "--every-checkpoint",
             program->name, value);
    return USAGE;
  }
  *o->text = value;
  return -1;
}

/* ---- arguments ------------------------------------------------------------------------------- */

static option *find(option *table, const char *name) {
  for (option *o = table; o->name || o->help; o++)
    if (o->name && strcmp(o->name, name) == 0) return o;
  return NULL;
}

static void keep_rows(const options_program *program) {
  int count = 0;
  for (const option *o = program->table; (o->name || o->help) && count < MAX_ROWS - 1; o++)
    rows_read[count++] = *o;
  rows_read[count] = (option){0};
}

const option *options_read(void) {
  return rows_read[0].name || rows_read[0].help ? rows_read : NULL;
}

bool options_doubt(int k, char *out, size_t size) {
  const option *o = rows_read;
  char value[48];
  for (; o->name || o->help; o++) {
    const char *unit = o->bare ? vocabulary_likelier_unit(o, *o->number) : NULL;
    if (!unit || k-- > 0) continue;
    snprintf(value, sizeof value, "%.6g", *o->number);
    snprintf(out, size, "--%s is %s %s: write %s%s if that is meant", o->name, value, o->unit,
             value, unit);
    return true;
  }
  return false;
}

void options_note(const char *format, ...) {
  va_list args;
  if (notes == MAX_NOTES) return;
  va_start(args, format);
  vsnprintf(noted[notes++], sizeof noted[0], format, args);
  va_end(args);
}

const char *options_noted(int k) { return k < notes ? noted[k] : NULL; }

double options_divide(const char *name, double *part, const char *of, double whole, bool half) {
  const double shift = half ? 0.5 : 0.0;
  const double count = fmax(nearbyint(whole / *part - shift), 1.0) + shift, given = *part;
  *part = whole / count;
  if (fabs(given - *part) > 1e-5 * *part)
    options_note("--%s is %.6g m, taken as %.6g m: %g in %s, %.6g m", name, given, *part, count, of,
                 whole);
  return count;
}

void options_whole(const char *name, double *length, const char *of, double part) {
  const double count = fmax(nearbyint(*length / part), 1.0), given = *length;
  if (fabs(given / part - count) <= 1e-5 * (1.0 + count)) return;
  *length = count * part;
  options_note("--%s is %.6g m, taken as %.6g m: a whole multiple of %s, %.6g m", name, given,
               *length, of, part);
}

/* A word that belongs to no option; one that is the unit of the number before it is put there. */
static int refuse_word(const options_program *program, int i, char **argv) {
  const char *word = argv[i], *equals = i > 1 ? strchr(argv[i - 1], '=') : NULL;
  const option *o =
      i > 2 && strncmp(argv[i - 2], "--", 2) == 0 ? find(program->table, argv[i - 2] + 2) : NULL;
  const char *number = equals ? equals + 1 : o ? argv[i - 1] : NULL;
  char name[MAX_NAME + 1], both[80];
  double value;
  if (equals && strncmp(argv[i - 1], "--", 2) == 0) {
    const ptrdiff_t length = equals - argv[i - 1] - 2;
    snprintf(name, sizeof name, "%.*s", (int)(length < MAX_NAME ? length : MAX_NAME),
             argv[i - 1] + 2);
    o = find(program->table, name);
  }
  if (o && o->number && number &&
      snprintf(both, sizeof both, "%s%s", number, word) < (int)sizeof both &&
      units_read(both, o->unit, &value) == UNITS_GOOD && units_written(both))
    complain("%s: unexpected argument \"%s\": write --%s %s", program->name, word, o->name, both);
  else
    complain("%s: unexpected argument \"%s\", see %s --help", program->name, word, program->name);
  return USAGE;
}

static int refuse_twice(const options_program *program, const option *o, const char *value) {
  if (value)
    complain("%s: --%s is given twice: %s and %s", program->name, o->name, o->typed, value);
  else
    complain("%s: --%s is given twice", program->name, o->name);
  return USAGE;
}

static int parse(const options_program *program, int argc, char **argv) {
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
    if (strncmp(argument, "--", 2) != 0) return refuse_word(program, i, argv);
    char name[MAX_NAME + 1];
    const size_t length = strcspn(argument + 2, "=");
    snprintf(name, sizeof name, "%.*s", (int)(length < MAX_NAME ? length : MAX_NAME), argument + 2);
    option *o = find(program->table, name);
    if (strcmp(name, "help") == 0 || strcmp(name, "version") == 0) {
      complain("%s: --%s must be given without a value", program->name, name);
      return USAGE;
    }
    if (!o) return refuse_unknown(program, name);
    const char *value = argument[2 + length] == '=' ? argument + 3 + length : NULL;
    if (o->flag) {
      if (value) return refuse_value(program, o, value, "given without a value");
      if (o->typed) return refuse_twice(program, o, NULL);
      *o->flag = o->given = true;
      o->typed = "";
      continue;
    }
    if (!value && (i + 1 >= argc || strncmp(argv[i + 1], "--", 2) == 0)) {
      complain("%s: --%s needs a value: %s", program->name, name, o->unit ? o->unit : "a number");
      return USAGE;
    }
    if (!value) value = argv[++i];
    if (o->typed) return refuse_twice(program, o, value);
    o->typed = value;
    const int code = read_value(program, o, value);
    if (code >= 0) return code;
  }
  return -1;
}

static struct {
  int count;
  char **word;
} typed;

/* In quotes where a shell would read it otherwise. */
bool options_word(int k, char *out, size_t size) {
  if (k >= typed.count) return false;
  const char *word = typed.word[k], *slash = k == 0 ? strrchr(word, '/') : NULL;
  const bool plain = *word && strspn(word, "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz"
                                           "0123456789-_=+.,:/@%") == strlen(word);
  snprintf(out, size, plain ? "%s" : "'%s'", slash ? slash + 1 : word);
  return true;
}

/* That of the row; results go to out/PROGRAM without its "mps-". */
static void set_default(const options_program *program, option *o) {
  static char out[MAX_NAME + 8];
  for (int k = 0; o->number && k < (o->count > 1 ? o->count : 1); k++)
    if (o->number[k] == 0.0) o->number[k] = o->standard;
  if (o->integer && *o->integer == 0) *o->integer = (int64_t)o->standard;
  if (o->choice && *o->choice == 0) *o->choice = (int)o->standard;
  o->usual = o->number && o->count < 2 ? *o->number : 0.0;
  if (!o->text || *o->text || strcmp(o->name, "out") != 0) return;
  snprintf(out, sizeof out, "out/%s", program->name + 4 * (strncmp(program->name, "mps-", 4) == 0));
  *o->text = out;
}

int options_parse(const options_program *program, int argc, char **argv) {
  const char *name = "";
  typed.count = argc, typed.word = argv;
  ranks_hush();
  ranks_keep_options(argc, argv);
  for (option *o = program->table; o->name || o->help; o++) set_default(program, o);
  const char *fault = vocabulary_complete(program->table, &name);
  if (fault) {
    complain("%s: --%s is %s", program->name, name, fault);
    return USAGE;
  }
  return options_again(program, argc, argv);
}

int options_again(const options_program *program, int argc, char **argv) {
  for (option *o = program->table; o->name || o->help; o++) o->typed = NULL;
  const int code = parse(program, argc, argv);
  keep_rows(program);
  return code;
}

int options_set(const options_program *program, const char *where, const char *name,
                const char *value) {
  option *o = find(program->table, name);
  source = where;
  const int code = !o || o->flag ? refuse_unknown(program, name) : read_value(program, o, value);
  source = NULL;
  return code;
}

int options_prefer(const options_program *program, const option_preset *presets) {
  for (; presets->name; presets++) {
    option *o = find(program->table, presets->name);
    if (!o || o->given) continue;
    const int code = read_value(program, o, presets->value);
    if (code >= 0) return code;
    o->given = false;
  }
  return -1;
}

bool options_given(const option *table, const char *name) {
  for (const option *o = table; o->name || o->help; o++)
    if (o->name && strcmp(o->name, name) == 0) return o->given;
  return false;
}

/* "0.4 m, taken as 0.5 m: ..." of the note of an option; NULL: its value is as given. */
static const char *find_note(const option *o) {
  const size_t length = strlen(o->name);
  for (int k = 0; k < notes; k++)
    if (strncmp(noted[k], "--", 2) == 0 && strncmp(noted[k] + 2, o->name, length) == 0 &&
        strncmp(noted[k] + 2 + length, " is ", 4) == 0 && strchr(noted[k], ','))
      return noted[k] + length + 6;
  return NULL;
}

/* "--cell is 0.43 m by default", "--depth is 0.4 m by default, taken as 0.5 m"; false where the
 * option has no value. */
static bool show_value(const option *o, char *out, size_t size) {
  char value[160];
  const char *note = find_note(o), *standard = o->given ? "" : " by default";
  const bool any = shown_value(o, value, sizeof value);
  if (note) {
    const int first = (int)strcspn(note, ","), all = (int)strcspn(note, ":");
    snprintf(out, size, "--%s is %.*s%s%.*s", o->name, first, note, standard, all - first,
             note + first);
  } else {
    snprintf(out, size, "--%s is %s%s", o->name, value, standard);
  }
  return any;
}

/* The options that `text` names, each once, with their values; "" where all of them are on the
 * command line. */
static void show_defaults(const option *table, const char *text, char *out, size_t size) {
  bool any = false;
  size_t used = 0;
  out[0] = '\0';
  for (const option *o = table; o->name || o->help; o++) {
    char value[200];
    bool named = false;
    const size_t length = o->name ? strlen(o->name) : 0;
    for (const char *at = strstr(text, "--"); o->name && at; at = strstr(at + 2, "--")) {
      const char after = strncmp(at + 2, o->name, length) == 0 ? at[2 + length] : 'a';
      named = named ||
              !((after >= 'a' && after <= 'z') || (after >= '0' && after <= '9') || after == '-');
    }
    if (!named || !show_value(o, value, sizeof value)) continue;
    any = any || !o->given;
    if (used < size)
      used += (size_t)snprintf(out + used, size - used, "%s%s", used ? ", " : " (", value);
  }
  if (any && used + 2 < size)
    snprintf(out + used, size - used, ")");
  else
    out[0] = '\0';
}

int options_refuse(const options_program *program, const char *reason) {
  char defaults[600];
  char doubt[200], name[MAX_NAME + 4] = "";
  show_defaults(program->table, reason, defaults, sizeof defaults);
  bool doubted = false;
  for (int k = 0; !doubted && options_doubt(k, doubt, sizeof doubt); k++) {
    snprintf(name, sizeof name, "%.*s ", (int)strcspn(doubt, " "), doubt);
    doubted = strstr(reason, name) != NULL;
  }
  complain("%s: %s%s%s%s", program->name, reason, defaults, doubted ? "; " : "",
           doubted ? doubt : "");
  return USAGE;
}

int options_check_needs(const options_program *program, const options_need *need, size_t count) {
  for (size_t k = 0; k < count; k++) {
    char text[300];
    if (need[k].given || !options_given(program->table, need[k].option)) continue;
    snprintf(text, sizeof text, "--%s is not used: it needs %s", need[k].option, need[k].needs);
    return options_refuse(program, text);
  }
  return -1;
}

/* ---- options kept with a checkpoint ---------------------------------------------------------- */

bool options_free(const char *name) {
  static const char *const list[] = {"out", "threads", "checkpoint", "every-checkpoint", "restart"};
  for (size_t k = 0; k < sizeof list / sizeof *list; k++)
    if (strcmp(name, list[k]) == 0) return true;
  return false;
}

/* The shortest text that reads back, of 6 digits at least. */
static void exact_number(double value, char text[32]) {
  for (int digits = 6; digits <= 17; digits++) {
    snprintf(text, 32, "%.*g", digits, value);
    if (strtod(text, NULL) == value) break;
  }
}

/* The value as it would be typed; "not given" where there is none. */
static void describe_value(const option *o, char *out, size_t size) {
  size_t used = 0;
  const bool none = !plain_value(o, out, size) && !(o->flag && *o->flag);
  if (!out[0]) snprintf(out, size, none ? "not given" : "given");
  for (int i = 0; o->number && i < (o->count > 1 ? o->count : 1) && used < size; i++) {
    char text[32] = "not given";
    if (!isnan(o->number[i])) exact_number(o->number[i], text);
    used += (size_t)snprintf(out + used, size - used, "%s%s", i ? "," : "", text);
  }
}

bool options_record(const option *table, char *text, size_t size) {
  size_t used = 0;
  for (const option *o = table; o->name || o->help; o++) {
    char value[256];
    if (!o->name || options_free(o->name)) continue;
    describe_value(o, value, sizeof value);
    used += (size_t)snprintf(text + used, size - used, "%s=%s\n", o->name, value);
    if (used >= size) return false;
  }
  return true;
}

/* The value that a record has of an option; false where it has none. */
static bool recorded(const char *record, const char *name, char *out, size_t size) {
  const size_t length = strlen(name);
  for (const char *line = record; *line;
       line += strcspn(line, "\n") + (strchr(line, '\n') != NULL)) {
    if (strncmp(line, name, length) != 0 || line[length] != '=') continue;
    const char *value = line + length + 1;
    snprintf(out, size, "%.*s", (int)strcspn(value, "\n"), value);
    return true;
  }
  return false;
}

/* Whether `name` is one of "a|b|c". */
static bool is_among(const char *names, const char *name) {
  const size_t length = strlen(name);
  for (const char *at = names; at; at = strchr(at, '|') ? strchr(at, '|') + 1 : NULL)
    if (strcspn(at, "|") == length && strncmp(at, name, length) == 0) return true;
  return false;
}

bool options_agree(const option *table, const char *record, const char *others, char *why,
                   size_t size) {
  for (const option *o = table; o->name || o->help; o++) {
    char now[256], then[256] = "unknown";
    if (!o->name || options_free(o->name) || is_among(others, o->name)) continue;
    describe_value(o, now, sizeof now);
    if (recorded(record, o->name, then, sizeof then) && strcmp(now, then) == 0) continue;
    snprintf(why, size, "--%s is %s, was %s", o->name, now, then);
    return false;
  }
  return true;
}

/* ---- options as JSON ------------------------------------------------------------------------- */

static void json_string(const char *text, size_t length, char *out, size_t size) {
  size_t used = (size_t)snprintf(out, size, "\"");
  for (size_t k = 0; k < length && used + 8 < size; k++) {
    const unsigned char c = (unsigned char)text[k];
    if (c < 0x20)
      used += (size_t)snprintf(out + used, size - used, "\\u%04x", c);
    else
      used += (size_t)snprintf(out + used, size - used, c == '"' || c == '\\' ? "\\%c" : "%c", c);
  }
  snprintf(out + used, size - used, "\"");
}

void options_json(const option *o, char *out, size_t size) {
  size_t used = 0;
  char value[1024];
  const bool any = plain_value(o, value, sizeof value);
  snprintf(out, size, "%s", o->flag ? (*o->flag ? "true" : "false") : any ? value : "null");
  if (any && !o->integer) json_string(value, strlen(value), out, size);
  if (!o->number) return;
  const bool many = o->count > 1;
  for (int k = 0; k < (many ? o->count : 1) && used < size; k++) {
    char text[32] = "null";
    if (isfinite(o->number[k])) exact_number(o->number[k], text);
    used += (size_t)snprintf(out + used, size - used, "%s%s", k ? ", " : many ? "[" : "", text);
  }
  if (many && used < size) snprintf(out + used, size - used, "]");
}
