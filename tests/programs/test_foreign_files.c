/* test_foreign_files.c - files of the forms and with the flaws that people have, by all readers: of
 * records, layers, surfaces, model files, checkpoints. The table data/foreign/expected.txt has the
 * answer to each file of its folder: "ok" and what was read, or a part of the message.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "test_common.h"

#include "common/document.h"
#include "common/layers.h"
#include "common/table.h"

#include <dirent.h>

#define FOLDER TEST_DATA "/foreign/"
enum { FILES = 200, ANSWER = 700 };

static mps_context *context;

/* ---- readers: each writes its answer --------------------------------------------------------- */

static void say_error(char *out) {
  snprintf(out, ANSWER, "%s", mps_context_error(context)->message);
}

/* Options of the reader: "step=.02", "unit=g", "column=N-S", "level". */
static void read_record(const char *path, const char *options, char *out) {
  mps_signal_record_def def = mps_signal_record_defaults();
  mps_signal_record_report r;
  scoped_signal *signal = NULL;
  char unit[20], column[20];
  const char *at = strstr(options, "step=");
  if (at) def.step = strtod(at + 5, NULL);
  if ((at = strstr(options, "unit=")) && sscanf(at, "unit=%19[^,]", unit) == 1) def.unit = unit;
  if ((at = strstr(options, "column=")) && sscanf(at, "column=%19[^,]", column) == 1)
    def.column = column;
  if (mps_signal_create_record(context, path, &def, &signal) != MPS_OK) {
    assert_null(signal);
    say_error(out);
    return;
  }
  OK(mps_signal_get_record(signal, &r));
  snprintf(out, ANSWER, "ok %lld values, step %.4g, peak %.3f, unit %s", (long long)r.count, r.step,
           r.peak, r.unit[0] ? r.unit : "none");
}

static void read_layers(const char *path, const char *options, char *out) {
  (void)options;
  static const table_def def = {
      .row = "layer",
      .column =
          {{.name = "thickness",
            .quantity = "m",
            .unit = "m",
            .lower = 0.0,
            .upper = 2e3,
            .open = true},
           {.name = "vs", .quantity = "m/s", .unit = "m/s", .lower = 10.0, .upper = 6e3},
           {.name = "vp", .quantity = "m/s", .unit = "m/s", .lower = 15.0, .upper = 1.2e4},
           {.name = "unit weight", .quantity = "N/m3", .unit = "kN/m3", .lower = 5e3, .upper = 5e4},
           {.name = "damping", .quantity = "1", .unit = "ratio", .lower = 0.0, .upper = 0.5}},
      .count = 5,
      .most = 10};
  double row[50];
  int64_t rows;
  if (!table_read(path, &def, row, &rows, out, ANSWER)) return;
  snprintf(out, ANSWER, "ok %lld layers, %.3f m, %.2f m/s, %.2f m/s, %.1f N/m3, %.3g; %s",
           (long long)rows, row[0], row[1], row[2], row[3], row[4],
           *table_note() ? "no header" : "named");
}

static void read_surface(const char *path, const char *options, char *out) {
  (void)options;
  mps_body_def def = mps_body_defaults();
  scoped_body *body = NULL;
  if (mps_body_create_stl(context, &def, path, 1.0, &body) != MPS_OK) {
    assert_null(body);
    say_error(out);
    return;
  }
  snprintf(out, ANSWER, "ok");
}

static void read_model(const char *path, const char *options, char *out) {
  (void)options;
  document *d = document_read(path, out, ANSWER);
  if (!d) return;
  snprintf(out, ANSWER, "ok %s of %d", document_kind_name(d), d->count);
  document_free(d);
}

static void read_checkpoint(const char *path, const char *options, char *out) {
  (void)options;
  mps_checkpoint info = mps_checkpoint_defaults();
  if (mps_checkpoint_info(context, path, &info) != MPS_OK)
    say_error(out);
  else
    snprintf(out, ANSWER, "ok");
}

static const struct {
  const char *name;
  void (*read)(const char *path, const char *options, char *out);
} readers[] = {{"record", read_record},
               {"layers", read_layers},
               {"surface", read_surface},
               {"model", read_model},
               {"checkpoint", read_checkpoint}};

/* ---- the table ------------------------------------------------------------------------------- */

static bool check(const char *reader, const char *name, const char *options, const char *answer) {
  char path[600], out[ANSWER] = "";
  snprintf(path, sizeof path, "%s%s", FOLDER, name);
  for (size_t k = 0; k < sizeof readers / sizeof *readers; k++) {
    if (strcmp(readers[k].name, reader) != 0) continue;
    readers[k].read(path, options, out);
    const bool same =
        strncmp(answer, "ok", 2) == 0 ? strcmp(out, answer) == 0 : strstr(out, answer) != NULL;
    if (!same)
      print_error("%s %s %s\n  is:     %s\n  wanted: %s\n", reader, name, options, out, answer);
    return same;
  }
  fail_msg("no reader %s", reader);
  return false;
}

/* "reader file [options]: answer"; every file of the folder is in the table. */
TEST(every_file_is_read_as_the_table_says) {
  static char known[FILES][80];
  int count = 0, wrong = 0;
  char line[1000];
  FILE *table = fopen(FOLDER "expected.txt", "r");
  assert_non_null(table);
  while (fgets(line, sizeof line, table)) {
    char reader[20], options[100] = "";
    line[strcspn(line, "\n")] = '\0';
    if (!line[0] || line[0] == '#') continue;
    char *answer = strstr(line, ": ");
    assert_non_null(answer);
    *answer = '\0', answer += 2;
    assert_true(count < FILES);
    if (sscanf(line, "%19s %79s %99[^\n]", reader, known[count], options) < 2) fail_msg("%s", line);
    wrong += !check(reader, known[count++], options, answer);
  }
  fclose(table);
  DIR *folder = opendir(FOLDER);
  assert_non_null(folder);
  for (struct dirent *e; (e = readdir(folder));) {
    bool found = e->d_name[0] == '.' || strcmp(e->d_name, "expected.txt") == 0 ||
                 strcmp(e->d_name, "make-files") == 0;
    for (int k = 0; k < count && !found; k++) found = strcmp(known[k], e->d_name) == 0;
    if (!found) print_error("%s is not in the table\n", e->d_name), wrong++;
  }
  closedir(folder);
  assert_int_equal(wrong, 0);
}

/* A line of 100 MB, most of it a hole of the file system: refused without being read. */
TEST(a_line_without_end_is_refused) {
  static const char path[] = TEST_TMP "/foreign_long.csv";
  char out[ANSWER];
  FILE *file = fopen(path, "wb");
  assert_non_null(file);
  for (int k = 0; k < 4000; k++) fputc('7', file);
  assert_int_equal(fseek(file, 100L << 20, SEEK_SET), 0);
  fputc('\n', file);
  assert_int_equal(fclose(file), 0);
  read_layers(path, "", out);
  assert_non_null(strstr(out, "foreign_long.csv:1: line longer than 1022 characters"));
  read_model(path, "", out);
  assert_null(strstr(out, "ok"));
  read_record(path, "", out);
  assert_non_null(strstr(out, "a NUL byte: this is not a text file"));
  read_surface(path, "", out);
  assert_true(out[0] && strcmp(out, "ok") != 0);
  remove(path);
}

static int make(void **state) {
  (void)state;
  return mps_context_create(NULL, &context, NULL, 0) != MPS_OK;
}

static int drop(void **state) {
  (void)state;
  mps_context_destroy(&context);
  return 0;
}

TEST_GROUP(make, drop)
