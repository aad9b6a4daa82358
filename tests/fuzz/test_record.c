/* test_record.c - mutated records: whatever the bytes, the outcome is a finite motion or a clean
 * error that names the line, and nothing leaks.
 *
 * As a test: some thousand mutations of the sample of each format, from a fixed seed (run it under
 * the asan preset too). With libFuzzer:
 *   clang -g -O1 -fsanitize=fuzzer,address,undefined -DMPS_LIBFUZZER -D_POSIX_C_SOURCE=200809L \
 *     -Iinclude -Isrc -Itests tests/fuzz/test_record.c src/core/[a-z]*.c -llapacke -lm -o fuzz
 *   ./fuzz -max_len=4096 corpus tests/data
 * SPDX-License-Identifier: BSD-3-Clause */
#include "test_allocator.h"

#include "signal/record_private.h"

/* Called with what is wrong: a crash for libFuzzer, a failed test for cmocka. */
#ifdef MPS_LIBFUZZER
#define BROKEN(...) abort()
#else
#define BROKEN(...) fail_msg(__VA_ARGS__)
#endif

static void check_motion(const mps_signal *signal) {
  double start, end;
  mps_signal_span(signal, &start, &end);
  if (start != 0.0 || !(end > start) || !isfinite(end)) BROKEN("span %g..%g", start, end);
  for (int i = -1; i <= 21; i++) {
    const double t = i == 20 ? end : end * i / 20.0;
    if (!isfinite(mps_signal_acceleration(signal, t)))
      BROKEN("a(%g) = %g", t, mps_signal_acceleration(signal, t));
  }
}

/* One text, as every format and with every correction that `options` chooses. True if accepted. */
static bool check_text(const char *data, size_t size, uint32_t options) {
  test_allocator allocator = {0};
  mps_context *context = test_allocator_context(&allocator);
  if (!context) BROKEN("no context");
  mps_signal_record_def def = mps_signal_record_defaults();
  def.format = (int32_t)(options % 4 == 0 ? options / 4 % 4 : 0); /* mostly recognised */
  def.quantity =
      options / 16 % 4 == 0 ? (int32_t)(options / 64 % 3) : MPS_SIGNAL_QUANTITY_ACCELERATION;
  def.baseline = (int32_t)(options / 256 % 5);
  mpsi_text text;
  mps_signal *signal = NULL;
  mps_status status = mpsi_text_wrap(context, "fuzz", "fuzz", data, size, &text);
  if (status == MPS_OK) {
    status = mpsi_record_signal(&text, &def, &signal);
    mpsi_text_close(&text);
  }
  if ((status == MPS_OK) != (signal != NULL)) BROKEN("status %d, signal or not", (int)status);
  if (signal) check_motion(signal);
  const char *message = mps_context_error(context)->message;
  long long line = -1;
  if (status == MPS_ERROR_FORMAT) {
    if (sscanf(message, "fuzz:%lld: ", &line) != 1 || line < 0) BROKEN("no line: %s", message);
  } else if (status != MPS_OK && status != MPS_ERROR_NUMERIC && status != MPS_ERROR_ARGUMENT) {
    BROKEN("status %d: %s", (int)status, message);
  }
  mps_signal_destroy(&signal);
  mps_context_destroy(&context);
  if (allocator.live != 0) BROKEN("%lld allocations left", (long long)allocator.live);
  return status == MPS_OK;
}

#ifdef MPS_LIBFUZZER

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);
int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
  if (size < 2) return 0; /* the last two bytes are the options: files begin the text */
  check_text((const char *)data, size - 2,
             (uint32_t)data[size - 1] | (uint32_t)data[size - 2] << 8);
  return 0;
}

#else

#include "mutation.h"

/* One small damage, of kinds that occur in files or are hard for a parser. */
static size_t mutate(char *data, size_t size) {
  static const char *const words[] = {
      "NPTS=",    "DT=",   "Memo.",   "Origin Time", "Scale Factor",
      "(gal)/",   "1e999", "-1e-999", "nan",         "inf",
      "0x1p3",    "1e308", "-",       "+.e",         "1.D",
      ".",        ",",     ";",       "#",           "\n",
      "\r\n",     "\r",    " ",       "\t",          "99999999999999999999",
      "1e-310",   "0",     "2",       "UNITS OF",    "Sampling Freq",
      "\xff\xfe", "%s%n",  "dt=",     "[g]",         "(gal)",
      "units=",   "npts",  ",,",      "\xb2"};
  const size_t at = size > 0 ? random_below((uint32_t)size) : 0;
  const char byte = (char)random_below(256);
  switch (random_below(size > 0 ? 8 : 1)) {
  case 0: {
    const char *word = words[random_below(sizeof words / sizeof *words)];
    return replace(data, size, at, random_below(3), word, strlen(word));
  }
  case 1: /* a byte, sometimes NUL */
    return replace(data, size, at, 1, random_below(20) ? &byte : "", 1);
  case 2: /* a digit: keeps numbers numbers */
    return replace(data, size, at, 1, &"0123456789"[random_below(10)], 1);
  case 3: /* lost bytes */
    return replace(data, size, at, random_below(200), "", 0);
  case 4: /* cut short */
    return random_below(4) ? size : at;
  case 5: /* the beginning lost */
    return random_below(4) ? size : replace(data, size, 0, at, "", 0);
  case 6: { /* a piece twice */
    const size_t length = size - at < 40 ? size - at : 40;
    return replace(data, size, at, 0, data + at, length);
  }
  default: /* two pieces in each other's place */
    return replace(data, size, at, 1, &data[random_below((uint32_t)size)], 1);
  }
}

/* The first lines of a sample: short enough that damage often hits the header. */
static size_t load(const char *path, int lines, char *data) {
  FILE *file = fopen(path, "rb");
  assert_non_null(file);
  const size_t size = fread(data, 1, ROOM, file);
  assert_int_equal(fclose(file), 0);
  assert_true(size > 1000 && size < ROOM);
  size_t cut = 0;
  while (cut < size && lines > 0) lines -= data[cut++] == '\n';
  return cut;
}

static void fuzz(const char *path, int lines, const char *from, const char *to) {
  static char sample[ROOM], data[ROOM];
  size_t length = load(path, lines, sample);
  char *spot = NULL; /* the announced number of samples becomes that of the lines kept */
  for (size_t i = 0; from && i + strlen(from) <= length && !spot; i++)
    if (memcmp(sample + i, from, strlen(from)) == 0) spot = sample + i;
  if (spot) length = replace(sample, length, (size_t)(spot - sample), strlen(from), to, strlen(to));
  assert_true(check_text(sample, length, 1 | 1 << 4 | 2 << 8)); /* of accelerations */
  random_state = 20240229u;
  int accepted = 0;
  const int runs = 4000;
  for (int run = 0; run < runs; run++) {
    memcpy(data, sample, length);
    size_t size = length;
    for (uint32_t n = 1 + random_below(4); n > 0; n--) size = mutate(data, size);
    /* as long as the text: the sanitizer sees a read past it */
    char *exact = malloc(size > 0 ? size : 1);
    assert_non_null(exact);
    memcpy(exact, data, size);
    accepted += check_text(exact, size, random_below(1u << 16));
    free(exact);
  }
  print_message("%s: %d of %d mutations still read\n", path, accepted, runs);
  assert_true(accepted > runs / 100 && accepted < runs * 99 / 100); /* both ways are tried */
}

TEST(damaged_at2_files) { fuzz(TEST_DATA "/sample.AT2", 16, "NPTS=    401", "NPTS= 60"); }

TEST(damaged_knet_files) { fuzz(TEST_DATA "/sample.NS", 29, "(s)  4\n", "(s)  0.96\n"); }

TEST(damaged_csv_files) { fuzz(TEST_DATA "/sample.csv", 60, NULL, NULL); }

TEST(damaged_smc_files) { fuzz(TEST_DATA "/foreign/ground.smc", 60, NULL, NULL); }

TEST(damaged_cosmos_files) { fuzz(TEST_DATA "/foreign/ground.V2", 80, NULL, NULL); }

TEST(damaged_columns) { fuzz(TEST_DATA "/foreign/three-columns.csv", 60, NULL, NULL); }

TEST(noise) {
  char data[512];
  random_state = 7u;
  for (int run = 0; run < 2000; run++) {
    const size_t size = random_below(sizeof data);
    const uint32_t most = run % 2 ? 256 : 128;
    for (size_t i = 0; i < size; i++) data[i] = (char)(1 + random_below(most - 1));
    check_text(data, size, random_below(1u << 16));
  }
}

#endif
