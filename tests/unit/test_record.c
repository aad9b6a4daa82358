/* test_record.c - recorded motions: the three formats against a known motion, units, recognition,
 * taper, baseline correction, the host's locale, every error with its line, memory.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "test_allocator.h"
#include "test_fixture.h"

#include "signal/record_private.h"

#include <locale.h>

#define G 9.80665
#define FILE_TMP TEST_TMP "/record.tmp"

static int tear_down(void **state) {
  remove(FILE_TMP);
  return drop_context(state);
}

static void write_file(const char *content, size_t size) {
  FILE *file = fopen(FILE_TMP, "wb");
  assert_non_null(file);
  assert_int_equal(fwrite(content, 1, size, file), size);
  assert_int_equal(fclose(file), 0);
}

/* ---- the known motion: u = U sin^4(pi t/T) sin(2 pi f t), at rest at 0 and T ----------------- */

#define T 4.0
#define U 0.005

/* Derivative `order` (0, 1, 2) of sin(w t). */
static double wave(double w, double t, int order) {
  return order == 0 ? sin(w * t) : order == 1 ? w * cos(w * t) : -w * w * sin(w * t);
}

static double known(double t, int order) {
  const double w = 4.0 * PI, p = PI / T;
  return U * (0.375 * wave(w, t, order) -
              0.25 * (wave(w + 2.0 * p, t, order) + wave(w - 2.0 * p, t, order)) +
              0.0625 * (wave(w + 4.0 * p, t, order) + wave(w - 4.0 * p, t, order)));
}

/* The largest |a| of the known motion is about U w^2 = 0.79 m/s2. Linear interpolation of a over
 * steps h has an error of h^2/12 a'' on average, so u, v and the motion itself differ by h^2/12 of
 * a, a' and a'': here 7e-6 m. `extra` is what the file's rounding and the correction add. */
static void check_known(const mps_signal *signal, double h, double last, double extra) {
  const double peak = U * 16.0 * PI * PI;
  for (int i = 0; i <= 1000; i++) {
    const double t = last * i / 1000.0;
    NEAR(mps_signal_displacement(signal, t), known(t, 0), h * h / 10.0 * peak + extra);
    NEAR(mps_signal_velocity(signal, t), known(t, 1), h * h * 4.0 * PI * peak + extra);
    NEAR(mps_signal_acceleration(signal, t), known(t, 2), h * h * 16.0 * PI * PI * peak + extra);
  }
  double start, end;
  mps_signal_span(signal, &start, &end);
  assert_true(start == 0.0);
  NEAR(end, last, 1e-12);
}

TEST(the_samples_in_three_formats_are_the_known_motion) {
  static const struct {
    const char *path;
    int32_t format;
    double last, extra;
  } files[] = {
      {TEST_DATA "/sample.AT2", MPS_SIGNAL_RECORD_FORMAT_AT2, 4.0, 1e-7},
      {TEST_DATA "/sample.NS", MPS_SIGNAL_RECORD_FORMAT_KNET, 3.99,
       2e-5}, /* counts of 6.3e-6 m/s2 */
      {TEST_DATA "/sample.csv", MPS_SIGNAL_RECORD_FORMAT_CSV, 4.0, 1e-7},
  };
  for (size_t i = 0; i < sizeof files / sizeof *files; i++)
    for (int automatic = 0; automatic < 2; automatic++) {
      scoped_signal *signal = NULL;
      USING(signal_record, mps_signal_create_record(context, files[i].path, &given, &signal),
            .format = automatic ? MPS_SIGNAL_RECORD_FORMAT_AUTO : files[i].format);
      check_known(signal, 0.01, files[i].last, files[i].extra);
    }
  scoped_signal *signal = NULL; /* without a definition: the defaults */
  OK(mps_signal_create_record(context, files[0].path, NULL, &signal));
}

/* Reads `content`, which must succeed, without baseline correction unless asked. */
static mps_signal *read_text(const char *content, int32_t baseline) {
  write_file(content, strlen(content));
  DEF(signal_record, def, .baseline = baseline);
  mps_signal *signal = NULL;
  OK(mps_signal_create_record(context, FILE_TMP, &def, &signal));
  return signal;
}

static void check_samples(const char *content, double step, const double *values, int count) {
  scoped_signal *signal = read_text(content, MPS_SIGNAL_BASELINE_NONE);
  for (int i = 0; i < count; i++)
    NEAR(mps_signal_acceleration(signal, step * i), values[i], 1e-15 * fabs(values[i]) + 1e-300);
  double start, end;
  mps_signal_span(signal, &start, &end);
  NEAR(end, step * (count - 1), 1e-15);
}

TEST(at2_headers_and_numbers_come_in_many_spellings) {
  const double values[] = {0.1234e-3 * G, -12.0 * G, 0.5 * G, 1e3 * G};
  static const char *const files[] = {
      "A\nB\nC\nNPTS=  4, DT= .5000 SEC\n.1234E-03 -12 .5 1.D+03\n",
      "A\nB\nACCELERATION TIME SERIES IN UNITS OF G\nNPTS=   4, DT=   .5000 SEC,\n"
      "  .1234d-03  -.12E+02\n  +5.E-1\n1000",
      "A\r\nB\r\nACCELERATION TIME HISTORY IN UNITS OF G. FILTER POINTS: HP=0.1 Hz\r\n"
      "   4   0.5   NPTS, DT\r\n0.0001234\r\n-12.\r\n\r\n0.5 1E3\r\n",
      "A\nB\nunits of g\nnpts=4,dt=.5SEC\n123.4e-6\t-12\v0.5\f1e+003",
  };
  for (size_t i = 0; i < sizeof files / sizeof *files; i++) check_samples(files[i], 0.5, values, 4);
}

#define KNET(frequency, duration, scale, data)                                                     \
  "Origin Time       2000/01/01 00:00:00\nStation Code      SYN001\n"                              \
  "Sampling Freq(Hz) " frequency "\nDuration Time(s)  " duration "\nScale Factor      " scale      \
  "\nMemo.             \n" data

TEST(knet_fields_are_found_by_name) {
  const double k = 2000.0 / 8388608.0 * 0.01, values[] = {100 * k, -200 * k, 0, 8388607 * k};
  check_samples(KNET("2Hz", "2", "2000(gal)/8388608", "100 -200 0 8388607\n"), 0.5, values, 4);
  check_samples("Origin Time x\r\nScale Factor      2000(GAL) / 8388608\r\nother line\r\n"
                "sampling freq     2 Hz\r\nMEMO.\r\n100\r\n-200\r\n0\r\n+8388607",
                0.5, values, 4);
}

TEST(csv_columns_are_separated_in_many_ways) {
  const double values[] = {1.5, -2e-3, 0.25};
  static const char *const files[] = {
      "0,1.5\n0.5,-2e-3\n1,.25\n",
      "# made by hand\n\ntime;a\n0;1.5\n0.5; -2e-3 # here\n\n1 ;.25",
      "\xef\xbb\xbf\"t\",\"a\"\r\n10\t1.5\r\n10.5\t-.002\r\n11\t0.25\r\n",
      "-1 1.5\n -0.5   -2D-3  \n0\t,\t0.25\n#",
  };
  for (size_t i = 0; i < sizeof files / sizeof *files; i++) check_samples(files[i], 0.5, values, 3);
  scoped_signal *signal =
      read_text("0 0\n1 1\n4 4\n", MPS_SIGNAL_BASELINE_NONE); /* uneven: a = t */
  NEAR(mps_signal_displacement(signal, 3.0), 4.5, 1e-14);
}

TEST(quantity_scale_and_taper_act_as_they_say) {
  write_file("0 1\n1 1\n2 1\n3 1\n4 1\n", 20);
  mps_signal_record_def def = mps_signal_record_defaults();
  scoped_signal *signal = NULL;
  def.quantity = MPS_SIGNAL_QUANTITY_VELOCITY; /* the default baseline is for accelerations only */
  def.scale = 0.5;
  OK(mps_signal_create_record(context, FILE_TMP, &def, &signal));
  NEAR(mps_signal_displacement(signal, 4.0), 2.0, 1e-15);
  mps_signal_destroy(&signal);
  def.quantity = MPS_SIGNAL_QUANTITY_DISPLACEMENT;
  OK(mps_signal_create_record(context, FILE_TMP, &def, &signal));
  NEAR(mps_signal_displacement(signal, 2.5), 0.5, 1e-15);
  mps_signal_destroy(&signal);
  def.taper = 1.0;
  REFUSES(mps_signal_create_record(context, FILE_TMP, &def, &signal),
          "taper is 1 s, must be 0 for a record of displacements");
  def.quantity = MPS_SIGNAL_QUANTITY_ACCELERATION;
  def.baseline = MPS_SIGNAL_BASELINE_NONE;
  def.scale = -3.0;
  def.taper = 2.0; /* 0, 1/2, 1, 1/2, 0 */
  OK(mps_signal_create_record(context, FILE_TMP, &def, &signal));
  for (int i = 0; i <= 4; i++)
    NEAR(mps_signal_acceleration(signal, i), -1.5 * (2 - abs(i - 2)), 1e-15);
}

/* ---- baseline -------------------------------------------------------------------------------- */

/* A CSV of the known motion plus p'(t), p = drift[0] t + drift[1] t^2 + drift[2] t^3, at uneven
 * times if asked; 17 digits, so that the file adds no error. */
static mps_signal *drifting(const double drift[3], bool uneven, int32_t baseline) {
  FILE *file = fopen(FILE_TMP, "wb");
  assert_non_null(file);
  for (int i = 0; i <= 800; i++) {
    const double x = i / 800.0, t = T * (uneven ? x * (0.7 + 0.3 * x) : x);
    fprintf(file, "%.17g, %.17g\n", t,
            known(t, 2) + drift[0] + 2.0 * drift[1] * t + 3.0 * drift[2] * t * t);
  }
  assert_int_equal(fclose(file), 0);
  DEF(signal_record, def, .baseline = baseline);
  mps_signal *signal = NULL;
  OK(mps_signal_create_record(context, FILE_TMP, &def, &signal));
  return signal;
}

/* A polynomial drift of the degree of the correction disappears: the corrected motion is the one
 * of the record without drift, to rounding (to h^2 for the parabola, which is not linear between
 * samples), and the known motion up to its own small trend. */
TEST(the_trend_of_its_degree_is_removed) {
  const double none[3] = {0};
  for (int degree = 1; degree <= 3; degree++)
    for (int uneven = 0; uneven < 2; uneven++) {
      double drift[3] = {0.3, -0.2, 0.05};
      for (int k = degree; k < 3; k++) drift[k] = 0.0;
      static const int32_t of[] = {MPS_SIGNAL_BASELINE_MEAN, MPS_SIGNAL_BASELINE_LINEAR,
                                   MPS_SIGNAL_BASELINE_QUADRATIC, MPS_SIGNAL_BASELINE_CUBIC};
      scoped_signal *clean = drifting(none, uneven, of[degree]);
      scoped_signal *drifted = drifting(drift, uneven, of[degree]);
      /* steps of at most 1.3 T/800: the parabola's integral differs by h^2/12 6 c3 T at most */
      const double h = 1.3 * T / 800.0, same = degree == 3 ? h * h / 2.0 * 0.05 * T : 1e-13;
      for (int i = 0; i <= 100; i++) {
        const double t = T * i / 100.0;
        NEAR(mps_signal_velocity(drifted, t), mps_signal_velocity(clean, t), same);
        NEAR(mps_signal_displacement(drifted, t), mps_signal_displacement(clean, t), 2.0 * same);
        /* U/100 in u and in v: the least-squares trend of the known motion itself */
        NEAR(mps_signal_displacement(drifted, t), known(t, 0), U / 100.0);
      }
      NEAR(mps_signal_velocity(drifted, T), 0.0, U / 100.0);
    }
}

TEST(the_mean_is_the_one_over_time_and_none_leaves_all) {
  const double drift[3] = {0.3, -0.2, 0.0};
  scoped_signal *signal = drifting(drift, true, MPS_SIGNAL_BASELINE_MEAN);
  NEAR(mps_signal_velocity(signal, T), 0.0, 1e-14);
  mps_signal_destroy(&signal);
  signal = drifting(drift, false, MPS_SIGNAL_BASELINE_NONE);
  NEAR(mps_signal_velocity(signal, T), 0.3 * T - 0.2 * T * T, 1e-13);
  mps_signal_destroy(&signal);
  signal = drifting(drift, false, MPS_SIGNAL_BASELINE_LINEAR); /* of too low a degree */
  assert_true(fabs(mps_signal_velocity(signal, T)) > 0.1);
}

TEST(a_correction_needs_enough_samples) {
  write_file("0 1\n1 2\n2 5\n", 12);
  DEF(signal_record, def, .baseline = MPS_SIGNAL_BASELINE_CUBIC);
  scoped_signal *signal = NULL;
  REFUSES(mps_signal_create_record(context, FILE_TMP, &def, &signal),
          "baseline 4 needs at least 4 samples, the record has 3");
  def.baseline =
      MPS_SIGNAL_BASELINE_QUADRATIC; /* two unknowns, v(1) and v(2): nothing is left of v */
  OK(mps_signal_create_record(context, FILE_TMP, &def, &signal));
  NEAR(mps_signal_velocity(signal, 2.0), 0.0, 1e-14);
  mps_signal_destroy(&signal);
  signal = read_text("0 0\n1 0\n2 0\n3 0\n", MPS_SIGNAL_BASELINE_CUBIC);
  assert_true(mps_signal_displacement(signal, 3.0) == 0.0);
}

/* ---- the host's locale ----------------------------------------------------------------------- */

/* Sets a locale with a decimal comma, made on the spot if the machine has none. */
static bool set_comma(void) {
  static const char *const names[] = {"de_DE.UTF-8", "de_DE.utf8", "fr_FR.UTF-8", "de_DE"};
  for (size_t i = 0; i < sizeof names / sizeof *names; i++)
    if (setlocale(LC_ALL, names[i]) && *localeconv()->decimal_point == ',') return true;
  if (system("localedef -i de_DE -f UTF-8 " TEST_TMP "/comma >/dev/null 2>&1") == -1) return false;
  setenv("LOCPATH", TEST_TMP, 1);
  return setlocale(LC_ALL, "comma") && *localeconv()->decimal_point == ',';
}

TEST(a_decimal_comma_of_the_host_changes_nothing) {
  if (!set_comma()) {
    setlocale(LC_ALL, "C");
    skip();
  }
  char text[8];
  snprintf(text, sizeof text, "%.1f", 0.5);
  assert_string_equal(text, "0,5"); /* the locale is on */
  scoped_signal *signal = NULL;
  OK(mps_signal_create_record(context, TEST_DATA "/sample.AT2", NULL, &signal));
  assert_string_equal(localeconv()->decimal_point, ","); /* and stays on */
  setlocale(LC_ALL, "C");
  check_known(signal, 0.01, 4.0, 1e-7);
}

TEST(numbers_are_rounded_correctly) {
  static const struct {
    const char *text;
    double value;
  } numbers[] = {
      {"0.1", 0.1},
      {"9007199254740993", 9007199254740992.0}, /* a tie, to even */
      {"9007199254740993.0000000000000000000000001", 9007199254740994.0},
      {"2.2250738585072011e-308", 2.2250738585072011e-308},
      {"1.7976931348623157D308", 1.7976931348623157e308},
      {"4.9e-324", 4.9e-324},
      {"1e-400", 0.0},
      {"-0", -0.0},
  };
  mpsi_text text;
  OK(mpsi_text_wrap(context, "test", "numbers", "", 0, &text));
  for (size_t i = 0; i < sizeof numbers / sizeof *numbers; i++) {
    const mpsi_slice word = {numbers[i].text, numbers[i].text + strlen(numbers[i].text)};
    double value = NAN;
    OK(mpsi_text_number(&text, word, "the number", &value));
    assert_memory_equal(&value, &numbers[i].value, sizeof value);
  }
  mpsi_text_close(&text);
}

/* ---- errors ---------------------------------------------------------------------------------- */

typedef struct bad_file {
  const char *content;
  const char *reason; /* what follows the path */
  int32_t format;     /* 0: recognised */
} bad_file;

#define AT2(npts, data) "A\nB\nUNITS OF G\n" npts "\n" data
#define DIGITS_32 "11111111111111111111111111111111"

#pragma GCC diagnostic ignored "-Wmissing-field-initializers"
static const bad_file bad_files[] = {
    {"", ":1: not recognised as AT2"},
    {"\n\n \n", ":1: not recognised as AT2"},
    {"hello\nworld\n", ":1: not recognised as AT2"},
    /* AT2 */
    {"A\nB\n", ":2: no line with NPTS= and DT= ends the header", MPS_SIGNAL_RECORD_FORMAT_AT2},
    {"A\nB\nVELOCITY TIME SERIES\nNPTS= 2, DT= 1\n1 2\n",
     ":3: \"VELOCITY TIME SERIES\": an AT2 file of accelerations"},
    {"A\nB\nIN UNITS OF FURLONGS\nNPTS= 2, DT= 1\n1 2\n",
     ":3: the unit \"FURLONGS\" is not known: accelerations are in m/s2, g"},
    {AT2("no numbers", ""), ":4: no line with NPTS= and DT=", MPS_SIGNAL_RECORD_FORMAT_AT2},
    {AT2("NPTS= 4000, DT= fast", ""),
     ":4: \"NPTS= 4000, DT= fast\": NPTS=", MPS_SIGNAL_RECORD_FORMAT_AT2},
    {AT2("NPTS= 1, DT= 1", "1"), ":4: NPTS is 1, must be a whole number in 2 to "},
    {AT2("NPTS= 2.5, DT= 1", "1"), ":4: NPTS is 2.5"},
    {AT2("NPTS= 1e99, DT= 1", "1"), ":4: NPTS is 1e+99"},
    {AT2("NPTS= 1e999, DT= 1", "1"), ":4: NPTS is inf"},
    {AT2("NPTS= 2, DT= 0 SEC", "1 2"), ":4: DT is 0 s"},
    {AT2("NPTS= 2, DT= -.5 SEC", "1 2"), ":4: DT is -0.5 s"},
    {AT2("NPTS= 5, DT= 1", "1 2\n3 4\n"),
     ":6: the file ends after 4 values, the header announces 5"},
    {AT2("NPTS= 3, DT= 1", "1 2\n3 4\n"), ":6: more values than the 3 that the header"},
    {AT2("NPTS= 3, DT= 1", "1 2\n.1234E-\n"),
     ":6: the acceleration is \".1234E-\", which is not a number"},
    {AT2("NPTS= 3, DT= 1", "1 nan 3\n"), ":5: the acceleration is \"nan\""},
    {AT2("NPTS= 3, DT= 1", "1 2\n-inf"), ":6: the acceleration is \"-inf\""},
    {AT2("NPTS= 3, DT= 1", "1 0x10 3"), ":5: the acceleration is \"0x10\""},
    {AT2("NPTS= 3, DT= 1", "1 1e999 3"), ":5: the acceleration is 1e999, which"},
    {AT2("NPTS= 3, DT= 1", "1 . 3"), ":5: the acceleration is \".\", which"},
    {AT2("NPTS= 3, DT= 1", "1 \x01\xff 3"), ":5: the acceleration is \"??\""},
    {AT2("NPTS= 2, DT= 1", "1 " DIGITS_32 DIGITS_32 DIGITS_32 DIGITS_32),
     ":5: the acceleration is \"" DIGITS_32 "1111...\", which"},
    /* K-NET */
    {"Origin Time\nScale Factor 1(gal)/1\n1 2 3", ":3: no \"Memo.\" line"},
    {"Origin Time\nScale Factor 1(gal)/1\nMemo.\n1 2",
     ":3: the header ends without \"Sampling Freq\""},
    {"Origin Time\nSampling Freq(Hz) 100Hz\nMemo.\n1 2",
     ":3: the header ends without \"Scale Factor\""},
    {KNET("fast", "2", "1(gal)/1", "1 2"), ":3: Sampling Freq is \"fast\", a number > 0"},
    {KNET("0Hz", "2", "1(gal)/1", "1 2"), ":3: Sampling Freq is \"0Hz\""},
    {KNET("1e-320Hz", "2", "1(gal)/1", "1 2"), "too small"},
    {KNET("1Hz", "-2", "1(gal)/1", "1 2"), ":4: Duration Time is \"-2\""},
    {KNET("1Hz", "2", "(gal)/1", "1 2"), ":5: Scale Factor is \"(gal)/1\""},
    {KNET("1Hz", "2", "1(cm)/1", "1 2"),
     ":5: the unit of Scale Factor is \"(cm)\", (gal)/counts is expected"},
    {KNET("1Hz", "2", "1(gal)/x", "1 2"), ":5: the divisor of Scale Factor is"},
    {KNET("1Hz", "2", "1e300(gal)/1e-300", "1 2"), ":5: Scale Factor is 1e+300/1e-300, outside"},
    {KNET("1Hz", "4", "1(gal)/1", "1 2\n3\n"), ":8: the file has 3 values, 4 s at 1 Hz announce 4"},
    {KNET("2Hz", "1", "1(gal)/1", "1 2 3 4\n"),
     ":7: the file has 4 values, 1 s at 2 Hz announce 2"},
    {KNET("1Hz", "2", "1(gal)/1", "1\n2.5\n"), ":8: the count is \"2.5\", a whole number"},
    {KNET("1Hz", "2", "1(gal)/1", "1\n2147483649\n"), ":8: the count is \"2147483649\""},
    {KNET("1Hz", "2", "1(gal)/1", "1 x\n"), ":7: the count is \"x\""},
    /* CSV */
    {"", ":0: the file has no samples, at least 2 are needed", MPS_SIGNAL_RECORD_FORMAT_CSV},
    {"t,a\n0,1\n", ":2: the file has 1 sample, at least 2 are needed"},
    {"t,a\nu,b\n0,1\n", ":2: no column is named time or t", MPS_SIGNAL_RECORD_FORMAT_CSV},
    {"0,1\n1,x\n", ":2: the value is \"x\", which is not a number"},
    {"0,1\n1\n", ":2: the value is missing"},
    {"0,1\n1,\n", ":2: the value is missing"},
    {"0,1\n1,,2\n", ":2: the value is missing"},
    {"0,1\n,2\n", ":2: the time is missing"},
    {"0 1 2\n1 2 3\n", ":1: without names two columns are expected, time and value: \"2\""},
    {"0,01;1,5\n", ":1: the file has 1 sample"},
    {"0,1\n1,1\n#\n1,2\n", ":4: time 1 does not come after 1"},
    {"0,1\n1,1\n0.5,2\n", ":3: time 0.5 does not come after 1"},
    {"-1e16,1\n0,1\n0.25,2\n", ":3: time 0.25 does not come after 0"},
    {"-1e308,1\n1e308,1\n", ":2: time 1e+308 is too far from the first"},
    {"nan,1\n1,1\n", ":1: the time is \"nan\"", MPS_SIGNAL_RECORD_FORMAT_CSV},
    {"0,1\n1,-Infinity\n", ":2: the value is \"-Infinity\""},
    {"0.1.2,1\n1,1\n", ":1: the time is \"0.1.2\""},
    {"0,1\r1,1\r", ":1: lines end with CR alone"},
};

TEST(every_malformed_file_is_refused_with_its_line) {
  for (size_t i = 0; i < sizeof bad_files / sizeof *bad_files; i++) {
    const bad_file *bad = &bad_files[i];
    write_file(bad->content, strlen(bad->content));
    DEF(signal_record, def, .format = bad->format);
    mps_signal *signal = (mps_signal *)&def;
    char expected[512];
    snprintf(expected, sizeof expected, "record.tmp:%s",
             bad->reason[0] == ':' ? bad->reason + 1 : "");
    FAILS(mps_signal_create_record(context, FILE_TMP, &def, &signal), MPS_ERROR_FORMAT, expected);
    assert_non_null(strstr(mps_context_error(context)->message, bad->reason));
    assert_string_equal(mps_context_error(context)->function, "mps_signal_create_record");
    assert_null(signal);
  }
}

TEST(numbers_that_overflow_later_are_refused) {
  static const struct {
    const char *content, *reason;
    int32_t baseline;
    double scale;
  } files[] = {
      {"0 1e308\n1 1\n", "sample 1 overflows: t = 0 s", MPS_SIGNAL_BASELINE_NONE, 10.0},
      {AT2("NPTS= 3, DT= 1e308", "1 2 3"), "sample 2 is at t = 1e+308 s", MPS_SIGNAL_BASELINE_NONE,
       1.0},
      {"0 1\n1e300 1\n", "sample 2 is at t = 1e+300 s, must be within 1e15 s",
       MPS_SIGNAL_BASELINE_NONE, 1.0},
      {"0 1e240\n1e10 1\n", "the motion overflows at or after t = 1e+10 s",
       MPS_SIGNAL_BASELINE_NONE, 1.0},
      {"0 1e305\n1e10 1\n", "the velocity overflows when", MPS_SIGNAL_BASELINE_LINEAR, 1.0},
      {"0 1\n1e-310 1\n2e-310 0\n", "the motion overflows at or after t = 0 s",
       MPS_SIGNAL_BASELINE_QUADRATIC, 1.0},
      {"0 1\n1e-250 1\n2e-250 1\n1 0\n", "the baseline of degree 3 cannot be fitted",
       MPS_SIGNAL_BASELINE_CUBIC, 1.0},
  };
  for (size_t i = 0; i < sizeof files / sizeof *files; i++) {
    write_file(files[i].content, strlen(files[i].content));
    DEF(signal_record, def, .baseline = files[i].baseline, .scale = files[i].scale);
    mps_signal *signal = NULL;
    FAILS(mps_signal_create_record(context, FILE_TMP, &def, &signal), MPS_ERROR_NUMERIC,
          files[i].reason);
  }
}

TEST(what_is_not_a_text_is_refused) {
  mps_signal *signal = NULL;
  write_file("0,1\n1,\0002\n", 9);
  FAILS(mps_signal_create_record(context, FILE_TMP, NULL, &signal), MPS_ERROR_FORMAT,
        "record.tmp:2: a NUL byte: this is not a text file");
  FAILS(mps_signal_create_record(context, TEST_TMP, NULL, &signal), MPS_ERROR_IO,
        "': Is a directory");
  FAILS(mps_signal_create_record(context, TEST_TMP "/no/file", NULL, &signal), MPS_ERROR_IO,
        ": No such file or directory");
  char path[2000];
  memset(path, 'x', sizeof path);
  path[sizeof path - 1] = '\0';
  FAILS(mps_signal_create_record(context, path, NULL, &signal), MPS_ERROR_IO,
        "xxx': File name too long");
  assert_non_null(strstr(mps_context_error(context)->message, "'...xxx"));
  mpsi_text text;
  write_file("0,1\n1,1\n", 8);
  FAILS(mpsi_text_load(context, "test", FILE_TMP, 7, &text), MPS_ERROR_FORMAT,
        "record.tmp: larger than 7 bytes");
  OK(mpsi_text_load(context, "test", FILE_TMP, 8, &text));
  mpsi_text_close(&text);
}

/* All values on one line of 2 MB, and then one word as long. */
TEST(gigantic_lines_are_read_and_gigantic_words_refused) {
  enum { COUNT = 200000, WIDTH = 10 };
  char *content = malloc(COUNT * WIDTH + 100);
  assert_non_null(content);
  const int header = sprintf(content, "A\nB\nC\nNPTS= %d, DT= 0.01\n", COUNT);
  for (int i = 0; i < COUNT; i++)
    snprintf(content + header + i * WIDTH, WIDTH + 1, "%9.6f ", i % 100 * 0.01);
  const size_t size = (size_t)header + COUNT * WIDTH;
  write_file(content, size);
  DEF(signal_record, def, .baseline = MPS_SIGNAL_BASELINE_NONE);
  mps_signal *signal = NULL;
  OK(mps_signal_create_record(context, FILE_TMP, &def, &signal));
  NEAR(mps_signal_acceleration(signal, 0.01 * (COUNT - 1)), 0.99 * G, 1e-9);
  mps_signal_destroy(&signal);
  memset(content + header, '7', COUNT * WIDTH);
  write_file(content, size);
  FAILS(mps_signal_create_record(context, FILE_TMP, &def, &signal), MPS_ERROR_FORMAT,
        ":5: the acceleration is \"7777");
  free(content);
}

TEST(bad_definitions_are_refused) {
  mps_signal *signal = NULL;
  const char *path = TEST_DATA "/sample.csv";
  mps_signal_record_def def;
#define REFUSED(member, value, text)                                                               \
  def = mps_signal_record_defaults();                                                              \
  def.member = value;                                                                              \
  REFUSES(mps_signal_create_record(context, path, &def, &signal), text)
  REFUSED(scale, 0.0, "scale is 0, must be finite and not 0");
  REFUSED(unit, "kPa", "unit is \"kPa\", allowed are m/s2, g, gal");
  REFUSED(unit, "mm", "unit is \"mm\", allowed are m/s2, g, gal");
  REFUSED(taper, 2.001, "taper is 2.001 s, must be at most half the record (2 s)");
#undef REFUSED
  assert_null(signal);
  REFUSES(mps_signal_create_record(context, NULL, NULL, &signal), "path is NULL");
  REFUSES(mps_signal_create_record(context, path, NULL, NULL), "out is NULL");
  assert_int_equal(mps_signal_create_record(NULL, path, NULL, &signal), MPS_ERROR_ARGUMENT);
}

static mps_status read_sample(mps_context *owner, int format) {
  static const char *const paths[] = {TEST_DATA "/sample.AT2", TEST_DATA "/sample.NS",
                                      TEST_DATA "/sample.csv"};
  DEF(signal_record, def, .baseline = MPS_SIGNAL_BASELINE_CUBIC);
  scoped_signal *signal = NULL;
  const mps_status status = mps_signal_create_record(owner, paths[format], &def, &signal);
  assert_int_equal(status == MPS_OK, signal != NULL);
  return status;
}

TEST(a_refused_allocation_leaks_nothing) {
  for (int format = 0; format < 3; format++) test_allocator_sweep(read_sample, format);
}

TEST_GROUP(make_context, tear_down)
