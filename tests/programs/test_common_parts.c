/* test_common_parts.c - what the example programs share: options, numbers, layers, heaps, tongues.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "test_common.h"

#include "common/compare.h"
#include "common/area.h"
#include "common/frame.h"
#include "common/layers.h"
#include "common/mpm_heap.h"
#include "common/options.h"
#include "common/output.h"
#include "common/series.h"
#include "common/tongue.h"
#include "common/units.h"

#include <unistd.h>

/* A number without a unit is doubted where it is far below what the quantity has in SI units, but
 * not where its unit is written, nor where the program's own default is as small. */
TEST(a_number_of_another_unit_is_doubted) {
  double young = 1e7, density = 1800.0, cohesion = 0.5;
  option table[] = {OPTION_NUMBER("young", &young, NULL),
                    OPTION_NUMBER("density", &density, NULL),
                    OPTION_NUMBER("cohesion", &cohesion, NULL),
                    {0}};
  const options_program program = {"test", "", table};
  char text[200];
  char *bare[] = {(char[]){"test"}, (char[]){"--young=1000"}, (char[]){"--cohesion=2"},
                  (char[]){"--density=1.8"}};
  assert_int_equal(options_parse(&program, 4, bare), -1);
  assert_true(options_doubt(0, text, sizeof text));
  assert_string_equal(text, "--young is 1000 Pa: write 1000kPa if that is meant");
  assert_true(options_doubt(1, text, sizeof text));
  assert_string_equal(text, "--density is 1.8 kg/m3: write 1.8t/m3 if that is meant");
  assert_false(options_doubt(2, text, sizeof text));
  young = 1e7, density = 1800.0;
  char *written[] = {(char[]){"test"}, (char[]){"--young"}, (char[]){"1000Pa"},
                     (char[]){"--density=1.8t/m3"}};
  assert_int_equal(options_parse(&program, 4, written), -1);
  assert_false(options_doubt(0, text, sizeof text));
}

TEST(options_are_read_in_both_spellings) {
  double radius = 0.5, three[3] = {0};
  int64_t count = 3;
  int wave = 0;
  bool flag = false;
  const char *out = "out";
  option table[] = {
      OPTION_HEADING("Heading"),
      OPTION_NUMBER("radius", &radius, NULL),
      {.name = "incline", .count = 3, .range = OPTION_FROM_TO(-1e3, 1e3), .number = three},
      OPTION_INTEGER("seed", &count, NULL),
      OPTION_CHOICE_OF("wave", "S|P", &wave, NULL),
      OPTION_FLAG("drained", &flag, NULL),
      OPTION_TEXT("out", &out, NULL),
      {0}};
  const options_program program = {"test", "", table};
  char *argv[] = {(char[]){"test"},
                  (char[]){"--radius"},
                  (char[]){"-0"}, /* less than the least length */
                  (char[]){"--seed"},
                  (char[]){"7"},
                  (char[]){"--incline=1,-2.5,3e2"},
                  (char[]){"--wave=P"},
                  (char[]){"--drained"},
                  (char[]){"--out=a=b"},
                  NULL};
  assert_int_equal(options_parse(&program, 9, argv), 2);
  argv[2] = (char[]){"1.25"};
  assert_int_equal(options_parse(&program, 9, argv), -1);
  NEAR(radius, 1.25, 0.0);
  NEAR(three[0], 1.0, 0.0);
  NEAR(three[1], -2.5, 0.0);
  NEAR(three[2], 300.0, 0.0);
  assert_int_equal(count, 7);
  assert_int_equal(wave, 1);
  assert_true(flag);
  assert_string_equal(out, "a=b");
  assert_true(options_given(table, "incline"));
  assert_false(options_given(table, "nothing"));
}

/* No program starts with an option that the table of all does not have, or has otherwise. */
TEST(options_are_those_of_the_vocabulary) {
  double number = 1.0;
  int64_t integer = 1;
  int choice = 0;
  bool flag = false;
  const char *text = NULL;
  option wrong[][3] = {{OPTION_NUMBER("resolution", &number, NULL)}, /* not there */
                       {OPTION_INTEGER("young", &integer, NULL)},    /* of another kind */
                       {OPTION_FLAG("cell", &flag, NULL)},
                       {OPTION_TEXT_OF("out", "FILE", &text, NULL)}, /* of other words */
                       {OPTION_CHOICE_OF("wave", "S|Q", &choice, NULL)},
                       {OPTION_CHOICE("law", &choice, NULL)}, /* without its words */
                       {OPTION_FLAG("drained", &flag, NULL), OPTION_FLAG("drained", &flag, NULL)}};
  option right[] = {OPTION_CHOICE_OF("volumetric", "point|cell", &choice, NULL), {0}};
  char *argv[] = {(char[]){"test"}, NULL};
  for (size_t k = 0; k < sizeof wrong / sizeof *wrong; k++) {
    const options_program program = {"test", "", wrong[k]};
    assert_int_equal(options_parse(&program, 1, argv), 2);
  }
  const options_program program = {"test", "", right};
  assert_int_equal(options_parse(&program, 1, argv), -1);
}

/* A length that must divide another is rounded, and that is said. */
TEST(lengths_that_must_divide_are_rounded) {
  double part = 0.3, same = 0.25;
  NEAR(options_divide("cell", &same, "--width", 1.0, false), 4.0, 0.0);
  assert_null(options_noted(0));
  NEAR(options_divide("cell", &part, "--width", 1.0, false), 3.0, 0.0);
  NEAR(part, 1.0 / 3.0, 0.0);
  assert_string_equal(options_noted(0), "--cell is 0.3 m, taken as 0.333333 m: 3 in --width, 1 m");
  part = 0.2;
  NEAR(options_divide("spacing", &part, "--radius", 1.0, true), 4.5, 0.0);
  assert_non_null(options_noted(1));
  assert_null(options_noted(2));
}

TEST(only_finite_decimal_numbers_are_numbers) {
  static const char *const bad[] = {"",     " 1",  "1 ",  "nan", "inf", "1e999",
                                    "0x10", "1,5", "--1", "1e",  ".",   "1.2.3"};
  double value = 42.0;
  for (size_t i = 0; i < sizeof bad / sizeof *bad; i++)
    if (options_number(bad[i], &value)) fail_msg("\"%s\" was read as %g", bad[i], value);
  NEAR(value, 42.0, 0.0);
  assert_true(options_number("-1.5e-3", &value));
  NEAR(value, -1.5e-3, 0.0);
}

TEST(numbers_are_written_so_that_they_read_back) {
  static const double values[] = {0.1, 1.0 / 3.0, 1e-300, 1e22, 4.1047494306831e-3, -2.0};
  char text[32];
  for (size_t i = 0; i < sizeof values / sizeof *values; i++) {
    output_number(text, values[i]);
    NEAR(strtod(text, NULL), values[i], 0.0);
  }
  assert_string_equal(output_number(text, 0.1), "0.1");
}

/* A record of the options finds the one that differs, except free ones. */
TEST(options_are_compared_one_by_one) {
  double radius = 0.1, three[3] = {1.0, -2.5, NAN};
  int64_t count = 3;
  int wave = 1;
  bool flag = false;
  const char *out = "a", *file = NULL;
  option table[] = {OPTION_HEADING("Heading"),
                    OPTION_NUMBER("radius", &radius, NULL),
                    OPTION_NUMBERS("incline", 3, three, NULL),
                    OPTION_INTEGER("seed", &count, NULL),
                    OPTION_CHOICE_OF("wave", "S|P", &wave, NULL),
                    OPTION_FLAG("drained", &flag, NULL),
                    OPTION_TEXT("layers", &file, NULL),
                    OPTION_TEXT("out", &out, NULL),
                    {0}};
  char record[200], small[20], why[200];
  assert_true(options_record(table, record, sizeof record));
  assert_string_equal(record, "radius=0.1\nincline=1,-2.5,not given\nseed=3\nwave=P\n"
                              "drained=not given\nlayers=not given\n");
  assert_false(options_record(table, small, sizeof small));
  out = "b";
  assert_true(options_agree(table, record, NULL, why, sizeof why));
  radius = nextafter(0.1, 1.0); /* the last bit counts */
  assert_false(options_agree(table, record, NULL, why, sizeof why));
  assert_string_equal(why, "--radius is 0.10000000000000002, was 0.1");
  radius = 0.1, wave = 0;
  assert_false(options_agree(table, record, NULL, why, sizeof why));
  assert_string_equal(why, "--wave is S, was P");
  wave = 1, file = "x";
  assert_false(options_agree(table, record, NULL, why, sizeof why));
  assert_string_equal(why, "--layers is x, was not given");
  file = NULL;
  assert_false(options_agree(table, "radius=0.1\n", NULL, why, sizeof why));
  assert_string_equal(why, "--incline is 1,-2.5,not given, was unknown");
}

/* Numbers are SI, or have a unit of the same quantity; another one is refused. */
TEST(numbers_may_have_a_unit) {
  static const struct {
    const char *text, *unit;
    double value;
  } good[] = {{"10MPa", "Pa", 1e7},       {"2.5 kPa", "Pa", 2500.0},    {"5mm/s", "m/s", 5e-3},
              {"2000kN/m", "N/m", 2e6},   {"40kPa/m", "Pa/m", 4e4},     {"18kN/m3", "N/m3", 18e3},
              {"30cm", "m", 0.3},         {"2ms", "s", 2e-3},           {"1g", "m/s2", 9.80665},
              {"5g", "kg", 5e-3},         {"1.8t/m3", "kg/m3", 1800.0}, {"-0.5", "1", -0.5},
              {"30deg", "degrees", 30.0}, {"1e-3m", "m", 1e-3}};
  static const struct {
    const char *text, *unit;
    units_status status;
  } bad[] = {{"5mm", "Pa", UNITS_OTHER},     {"5mPa", "Pa", UNITS_OTHER},
             {"0.3Pa", "1", UNITS_OTHER},    {"3m", "N", UNITS_OTHER},
             {"Pa", "Pa", UNITS_NO_NUMBER},  {"nanPa", "Pa", UNITS_NO_NUMBER},
             {"1,5m", "m", UNITS_NO_NUMBER}, {"1e999m", "m", UNITS_NO_NUMBER},
             {"1e", "m", UNITS_OTHER},       {"1 m ", "m", UNITS_OTHER},
             {"", "m", UNITS_NO_NUMBER}};
  double value;
  char text[120];
  for (size_t k = 0; k < sizeof good / sizeof *good; k++) {
    if (units_read(good[k].text, good[k].unit, &value) != UNITS_GOOD)
      fail_msg("%s is not read", good[k].text);
    NEAR(value, good[k].value, 1e-12 * fabs(good[k].value));
  }
  value = 42.0;
  for (size_t k = 0; k < sizeof bad / sizeof *bad; k++)
    if (units_read(bad[k].text, bad[k].unit, &value) != bad[k].status)
      fail_msg("%s: another status", bad[k].text);
  NEAR(value, 42.0, 0.0);
  units_wanted("Hz", text, sizeof text);
  assert_string_equal(text, "a frequency is wanted (Hz, kHz)");
  units_show(2e6, "Pa", text, sizeof text);
  assert_string_equal(text, "2 MPa");
  units_show(0.0006, "m", text, sizeof text);
  assert_string_equal(text, "0.6 mm");
  units_show(1000.0, "kg/m3", text, sizeof text);
  assert_string_equal(text, "1000 kg/m3");
}

TEST(frames_are_spread_over_the_samples) {
  for (int64_t frames = 0; frames <= 11; frames++) {
    int64_t count = 0;
    for (int64_t k = 0; k <= 10; k++) count += frame_is_due(k, 10, frames);
    assert_int_equal(count, frames);
    assert_int_equal(frame_is_due(10, 10, frames), frames > 0);
    assert_int_equal(frame_is_due(0, 10, frames), frames > 1);
  }
}

/* A number that does not exist is an empty cell, or null; a warning where it should have one. */
TEST(results_hold_no_nan) {
  char directory[] = "/tmp/mps-output-XXXXXX", path[64], line[80] = "";
  app a = {.program = "test", .outcome = "finished"};
  output f;
  double young = NAN, rate = 2e-3;
  const char *name = "a \"b\"";
  option table[] = {OPTION_NUMBER("young", &young, NULL),
                    OPTION_NUMBER("rate", &rate, NULL),
                    OPTION_TEXT("layers", &name, NULL),
                    OPTION_TEXT("out", &name, NULL),
                    {0}};
  const options_program program = {"test", "", table};
  char *argv[] = {(char[]){"test"}, (char[]){"--rate"}, (char[]){"5mm/s"}, NULL};
  assert_int_equal(options_parse(&program, 3, argv), -1);
  assert_non_null(mkdtemp(directory));
  snprintf(path, sizeof path, "%s/table.csv", directory);
  const double row[] = {1.0, NAN, 2.0}, bad[] = {1.0, -INFINITY, NAN};
  assert_true(output_open(&f, &a, directory, "table.csv"));
  csv_header(&f, "t_s,x_m?,v_m_s");
  csv_row(&f, 3, row);
  assert_true(output_close(&f));
  assert_string_equal(a.results, "table.csv");
  assert_int_equal(a.warnings, 0);
  assert_true(output_open(&f, &a, directory, "table.csv"));
  csv_header(&f, "t_s,x_m?,v_m_s");
  csv_row(&f, 3, bad);
  assert_true(output_close(&f));
  assert_int_equal(a.warnings, 1);
  assert_non_null(strstr(a.warning[0], "v_m_s of row 1 is not a number: the cell is empty"));
  FILE *stream = fopen(path, "r");
  assert_non_null(stream);
  assert_non_null(fgets(line, sizeof line, stream));
  assert_string_equal(line, "t_s,x_m,v_m_s\n");
  assert_non_null(fgets(line, sizeof line, stream));
  assert_string_equal(line, "1,,\n");
  fclose(stream);
  remove(path);
  assert_true(summary_open(&f, &a, directory));
  json_number(&f, "force", -INFINITY);
  json_end(&f);
  assert_true(output_close(&f));
  snprintf(path, sizeof path, "%s/summary.json", directory);
  char text[2000] = "";
  stream = fopen(path, "r");
  assert_non_null(stream);
  assert_true(fread(text, 1, sizeof text - 1, stream) > 0);
  fclose(stream);
  assert_non_null(strstr(text, "\"outcome\": \"finished\",\n  \"options\": {\"young\": null, "
                               "\"rate\": 0.005, \"layers\": \"a \\\"b\\\"\"},\n"));
  assert_non_null(strstr(text, "\"warnings\": [\""));
  assert_non_null(strstr(text, "\"force\": null\n}"));
  remove(path);
  free(a.warning[0]);
  assert_int_equal(rmdir(directory), 0); /* nothing is left in it */
}

/* In headers units are spelled in many ways; the factor is to the SI unit of the quantity. */
TEST(headers_spell_units_in_many_ways) {
  static const struct {
    const char *text, *unit;
    double factor;
  } good[] = {{"m_s", "m/s", 1.0},
              {"kN/m^3", "N/m3", 1e3},
              {"kN_m3", "N/m3", 1e3},
              {"feet", "m", 0.3048},
              {"ft/s", "m/s", 0.3048},
              {"pcf", "N/m3", 157.08746},
              {"psf", "Pa", 47.880259},
              {"KPA", "Pa", 1e3},
              {"kg/m\xc2\xb3", "kg/m3", 1.0},
              {"\xb0", "degrees", 1.0},
              {"%", "1", 0.01},
              {"percent", "1", 0.01},
              {"cm/sec", "m/s", 1e-2},
              {"m/day", "m/s", 1.0 / 86400.0}};
  static const char *const bad[][2] = {
      {"s", "m"}, {"", "m"}, {"kPa", "N/m3"}, {"m", "1"}, {"m", "N"}};
  double factor = 0.0;
  for (size_t k = 0; k < sizeof good / sizeof *good; k++) {
    if (!units_factor(good[k].text, good[k].unit, &factor)) fail_msg("%s", good[k].text);
    NEAR(factor, good[k].factor, 1e-7 * good[k].factor);
  }
  for (size_t k = 0; k < sizeof bad / sizeof *bad; k++)
    assert_false(units_factor(bad[k][0], bad[k][1], &factor));
}

/* A seam within a row: compliances and masses add up; a row within one layer has its very numbers.
 */
TEST(a_row_has_the_mean_stiffness_of_its_layers) {
  const layers ground = {.count = 3,
                         .layer = {{4.0, 200.0, 400.0, 18e3, 0.02},
                                   {0.4, 40.0, 400.0, 16e3, 0.1},
                                   {3.6, 200.0, 400.0, 18e3, 0.02}}};
  for (double top = 3.4; top < 4.05; top += 0.15) { /* the seam whole, anywhere in the row */
    if (top + 1.0 < 4.4) continue;
    const layer l = layers_mean(&ground, top, top + 1.0);
    const double mass = 0.6 * 18e3 + 0.4 * 16e3;
    const double soft = 0.6 / (18e3 * 200.0 * 200.0), softer = 0.4 / (16e3 * 40.0 * 40.0);
    NEAR(l.unit_weight, mass, 1e-9 * mass);
    NEAR(l.unit_weight * l.vs * l.vs * (soft + softer), 1.0, 1e-12);
    NEAR(l.damping, (0.02 * soft + 0.1 * softer) / (soft + softer), 1e-12);
    NEAR(l.vp * l.vp * l.unit_weight * (0.6 / 18e3 + 0.4 / 16e3), 400.0 * 400.0, 1e-6);
  }
  const layer whole = layers_mean(&ground, 5.0, 6.0), below = layers_mean(&ground, 9.0, 10.0);
  assert_true(whole.vs == 200.0 && whole.vp == 400.0 && whole.unit_weight == 18e3);
  assert_true(below.vs == 200.0 && below.damping == 0.02);
  assert_int_equal(layers_thin(&ground, 1.0), 1);
  assert_int_equal(layers_thin(&ground, 0.4), -1);
}

/* Lowest natural frequency (Hz) of undamped layers on a rigid base, by the transfer of u and tau.
 */
static double lowest_frequency(const layers *ground) {
  for (double f = 0.5;; f += 1e-3) {
    double u = 1.0, tau = 0.0;
    for (int64_t i = 0; i < ground->count; i++) {
      const layer *l = &ground->layer[i];
      const double k = 2.0 * 3.14159265358979323846 * f / l->vs;
      const double stiff = layers_density(l) * l->vs * l->vs * k, before = u;
      u = u * cos(k * l->thickness) + tau / stiff * sin(k * l->thickness);
      tau = tau * cos(k * l->thickness) - stiff * before * sin(k * l->thickness);
    }
    if (u <= 0.0) return f;
  }
}

/* 8 m with a seam of .4 m, in rows of 1 m: wherever the seam lies the frequency is that of the
 * layers within 4 %. Without the seam it is 6.25 Hz. */
TEST(rows_keep_the_frequency_of_ground_with_a_seam) {
  for (double top = 3.5; top < 5.0; top += 0.1) {
    const layers ground = {.count = 3,
                           .layer = {{top, 200.0, 400.0, 18e3, 0.0},
                                     {0.4, 40.0, 400.0, 16e3, 0.0},
                                     {7.6 - top, 200.0, 400.0, 18e3, 0.0}}};
    layers rows = {.count = 8};
    for (int i = 0; i < 8; i++) {
      rows.layer[i] = layers_mean(&ground, i, i + 1.0);
      rows.layer[i].thickness = 1.0;
    }
    const double exact = lowest_frequency(&ground);
    assert_true(exact > 3.4 && exact < 4.4);
    NEAR(lowest_frequency(&rows), exact, 0.04 * exact);
  }
}

TEST(travel_time_is_summed_over_layers) {
  const layers ground = {
      .count = 2, .layer = {{10.0, 100.0, 200.0, 14.7e3, 0.0}, {20.0, 400.0, 1000.0, 20e3, 0.0}}};
  NEAR(layers_travel_time(&ground, 'S', 30.0, 0.0), 0.15, 1e-15);
  NEAR(layers_travel_time(&ground, 'P', 30.0, 0.0), 0.07, 1e-15);
  NEAR(layers_travel_time(&ground, 'S', 15.0, 5.0), 0.0625, 1e-15);
  NEAR(layers_travel_time(&ground, 'S', 50.0, 30.0), 0.05, 1e-15);
  NEAR(layers_travel_time(&ground, 'S', 5.0, 5.0), 0.0, 0.0);
  NEAR(layers_density(&ground.layer[0]), 1500.0, 1e-9);
  assert_ptr_equal(layers_at(&ground, 9.9), &ground.layer[0]);
  assert_ptr_equal(layers_at(&ground, 10.0), &ground.layer[1]);
  assert_ptr_equal(layers_at(&ground, 99.0), &ground.layer[1]);
}

/* A block 20 x 10 particles; a drop ahead of it does not move the front, a lump of 5 % does. */
TEST(the_front_leaves_drops_behind) {
  static const double block[] = {2.0, 1.0}, from[] = {0.0, 0.0}, drop[] = {3.05, 0.05, 0.05, 4.0};
  static const double lump[2][2] = {{5.0, 0.0}, {6.0, 0.1}};
  scoped_context *context = NULL;
  scoped_particles *set = NULL;
  DEF(particles, def, .spacing = 0.1);
  const mpm_heap_def measure = {.g = 10.0, .band = 0.2, .thickness = 1.0, .window = 0.5};
  mpm_heap heap;
  app a = {0};
  mpm_model m = {.a = &a};
  assert_int_equal(mps_context_create(NULL, &context, NULL, 0), MPS_OK);
  assert_int_equal(mps_particles_create(context, &def, &set), MPS_OK);
  assert_int_equal(mps_particles_fill_box(set, from, block, NULL), MPS_OK);
  assert_int_equal(mps_particles_append(set, 2, drop), MPS_OK);
  assert_int_equal(mps_particles_set(set, "mass", 0, 3.0), MPS_OK);
  assert_int_equal(mps_particles_set(set, "volume", 0, 0.02), MPS_OK);
  assert_int_equal(mps_particles_set(set, "velocity", 1, -2.0), MPS_OK);
  m.particles = set;
  assert_int_equal(mpm_heap_measure(&m, &measure, &heap), MPS_OK);
  NEAR(heap.front, 2.0, 1e-12);
  NEAR(heap.top, 1.0, 1e-12);
  NEAR(heap.height, 21 * 0.02 / 0.2, 1e-12);
  NEAR(heap.detached, 1.0 / 202.0, 1e-12);
  NEAR(heap.mass, 606.0, 1e-9);
  NEAR(heap.kinetic, 0.5 * 606.0 * 4.0, 1e-9);
  NEAR(heap.potential, 3.0 * 10.0 * (200 * 0.5 + 0.05 + 4.0), 1e-9);
  NEAR(heap.volume_ratio, 2.0, 1e-12);
  NEAR(heap.edge, 2.0, 1e-12); /* 2.5 columns of 0.2 m3 are 1 m thick over 0.5 m */
  assert_int_equal(mps_particles_fill_box(set, lump[0], lump[1], NULL), MPS_OK);
  assert_int_equal(mpm_heap_measure(&m, &measure, &heap), MPS_OK);
  NEAR(heap.front, 6.0, 1e-12);
}

enum { SAMPLES = 400 };

typedef struct moment {
  double t, force, kinetic;
} moment;

/* A standing wave of amplitude exp(-c t): a force with a second harmonic that oscillates with the
 * second mode, whose crests have another decay, and the kinetic energy. */
TEST(a_decay_is_that_of_the_energy) {
  const double c = 0.0067, w = 6.2, other = 9.9;
  static moment at[SAMPLES];
  for (int k = 0; k < SAMPLES; k++) {
    const double t = 0.01 * k, a = exp(-c * t);
    at[k].t = t;
    at[k].force = 441.0 + a * cos(w * t) + 0.03 * cos(other * t);
    at[k].kinetic = 1e-6 + a * a * sin(w * t) * sin(w * t);
  }
  const series force = {SAMPLES, sizeof *at, &at->t, &at->force};
  const series kinetic = {SAMPLES, sizeof *at, &at->t, &at->kinetic};
  const double T = 6.283185307179586 / w;
  NEAR(series_wave_decay(&kinetic, T, 0.0, 3.99), c, 0.02 * c);
  NEAR(series_wave_decay(&kinetic, T, 0.3, 3.2), c, 0.05 * c);
  assert_true(isnan(series_wave_decay(&kinetic, T, 0.0, 1.9 * T)));
  assert_true(isnan(series_wave_decay(&kinetic, T, 0.0, 5.0)));
  double phase;
  NEAR(series_harmonic(&force, T, 0.0, 3.0 * T, &phase), exp(-c * 1.5 * T), 0.02);
  NEAR(phase, 0.5 * 3.141592653589793, 0.03);
  assert_true(isnan(series_harmonic(&force, T, 0.0, 0.9 * T, NULL)));
  NEAR(series_mean(&force, 0.0, 3.0 * T), 441.0, 0.01);
}

/* The pixel of an image at x, y (m). */
static double pixel_at(const area *image, const float *value, double x, double y) {
  const int64_t i = (int64_t)((x - image->lower[0]) / image->pixel);
  const int64_t j = (int64_t)((y - image->lower[1]) / image->pixel);
  return (double)value[j * image->columns + i];
}

/* A lattice of 8 x 4 particles with a slit of two spacings in the middle, one particle above it,
 * and one outside the picture: the slit is closed, outlines run half a spacing beyond the centres.
 */
TEST(particles_are_drawn_as_their_area) {
  app a = {.program = "test"};
  char directory[] = "/tmp/mps-area-XXXXXX", file[64];
  assert_non_null(mkdtemp(directory));
  double row[34 * 3];
  for (int k = 0; k < 32; k++) {
    row[3 * k] = k % 8 + (k % 8 < 4 ? 0.5 : 1.5);
    row[3 * k + 1] = k / 8 + 0.5;
    row[3 * k + 2] = k % 8;
  }
  const double apart[6] = {5.0, 8.0, -3.0, 50.0, 8.0, 1e3};
  memcpy(row + 96, apart, sizeof apart);
  output f;
  area image;
  assert_true(output_open(&f, &a, directory, "image.bin"));
  const area_def def = {
      .spacing = 1.0, .slit = AREA_SLIT, .lower = {-1.0, -1.0}, .upper = {10.0, 10.0}, .side = 400};
  area_write(&f, &def, 34, row, &image);
  assert_true(output_close(&f));
  NEAR(image.least, -3.0, 0.0);
  NEAR(image.most, 7.0, 0.0);
  assert_true(image.columns <= 400 && image.rows <= 400);
  const size_t size = (size_t)(image.columns * image.rows);
  float *value = malloc(size * sizeof *value);
  snprintf(file, sizeof file, "%s/image.bin", directory);
  FILE *stream = fopen(file, "rb");
  assert_non_null(stream);
  assert_int_equal(fread(value, sizeof *value, size, stream), size);
  fclose(stream);
  NEAR(pixel_at(&image, value, 2.6, 1.4), 2.0, 0.0); /* the nearest particle */
  NEAR(pixel_at(&image, value, 4.3, 2.0), 3.0, 0.0); /* in the slit */
  NEAR(pixel_at(&image, value, 4.7, 2.0), 4.0, 0.0);
  NEAR(pixel_at(&image, value, 5.0, 8.2), -3.0, 0.0); /* alone */
  for (int side = -1; side <= 1; side += 2) {         /* half a spacing, to a pixel */
    const double edge = side < 0 ? 0.0 : 9.0;
    assert_false(isnan(pixel_at(&image, value, edge - side * 1.5 * image.pixel, 1.5)));
    assert_true(isnan(pixel_at(&image, value, edge + side * 1.5 * image.pixel, 1.5)));
    for (int k = 1; k < 4; k++) { /* no notches between the particles */
      assert_false(isnan(pixel_at(&image, value, edge - side * 1.5 * image.pixel, k)));
      assert_false(
          isnan(pixel_at(&image, value, k, (side < 0 ? 0.0 : 4.0) - side * 1.5 * image.pixel)));
    }
  }
  assert_true(isnan(pixel_at(&image, value, 5.0, 7.0)));
  free(value);
  unlink(file);
  rmdir(directory);
}

static bool above(const void *user, double x, double y) {
  (void)user, (void)x;
  return y > 2.9;
}

/* One row of particles, two of them three spacings apart: open at slits of two, closed at four; a
 * body 1.9 above the row and a wall below it leave no gap then. */
TEST(slits_and_gaps_to_bodies_are_closed) {
  app a = {.program = "test"};
  char directory[] = "/tmp/mps-area-XXXXXX", file[64];
  assert_non_null(mkdtemp(directory));
  snprintf(file, sizeof file, "%s/image.bin", directory);
  double row[8 * 3];
  for (int k = 0; k < 8; k++)
    row[3 * k] = 0.5 + k + 2 * (k > 3), row[3 * k + 1] = 1.0, row[3 * k + 2] = 1.0;
  for (int pass = 0; pass < 2; pass++) {
    const area_def def = {.spacing = 1.0,
                          .slit = pass ? AREA_SLIT_SHEARED : AREA_SLIT,
                          .lower = {-4.0, 0.0},
                          .upper = {14.0, 9.0},
                          .walled = pass == 1,
                          .side = 400,
                          .solid = pass ? above : NULL};
    output f;
    area image;
    assert_true(output_open(&f, &a, directory, "image.bin"));
    area_write(&f, &def, 8, row, &image);
    assert_true(output_close(&f));
    const size_t size = (size_t)(image.columns * image.rows);
    float *value = malloc(size * sizeof *value);
    FILE *stream = fopen(file, "rb");
    assert_int_equal(fread(value, sizeof *value, size, stream), size);
    fclose(stream);
    assert_int_equal(isnan(pixel_at(&image, value, 5.0, 1.0)), pass == 0); /* in the slit */
    assert_int_equal(isnan(pixel_at(&image, value, 2.0, 2.7)), pass == 0); /* below the body */
    assert_int_equal(isnan(pixel_at(&image, value, 2.0, 0.1)), pass == 0); /* above the wall */
    assert_true(isnan(pixel_at(&image, value, 2.0, 3.3)));
    assert_true(isnan(pixel_at(&image, value, -2.0, 1.0)));
    free(value);
  }
  unlink(file);
  rmdir(directory);
}

/* ---- tongues --------------------------------------------------------------------------------- */

static void add_at(mps_particles *water, const tongue_slope *s, double along, double off) {
  const double x[2] = {s->foot[0] + along * cos(s->angle) - off * sin(s->angle),
                       s->foot[1] + along * sin(s->angle) + off * cos(s->angle)};
  OK(mps_particles_append(water, 1, x));
}

/* Rows of particles on a slope: a wedge from .3 m at its foot to 0 at 3 m, cut off at `end`. */
static mps_particles *make_wedge(mps_context *context, const tongue_slope *s, double l0,
                                 double end) {
  mps_particles *water = NULL;
  DEF(particles, def, .spacing = l0);
  OK(mps_particles_create(context, &def, &water));
  for (double along = 0.5 * l0; along < end; along += l0)
    for (double off = 0.5 * l0; off < 0.3 - 0.1 * along; off += l0) add_at(water, s, along, off);
  return water;
}

TEST(a_tongue_is_continued_to_its_end) {
  const double l0 = 0.02;
  const tongue_slope s = {{1.0, -0.2}, 0.35, 8.0};
  scoped_context *context = NULL;
  tongue t;
  assert_int_equal(mps_context_create(NULL, &context, NULL, 0), MPS_OK);
  scoped_particles *water = make_wedge(context, &s, l0, 3.0);
  assert_true(tongue_find(water, &s, l0, &t));
  NEAR(t.end, 3.0, 3.0 * l0);
  NEAR(t.resolved, 2.9, 3.0 * l0); /* the lowest row ends where half a spacing is left */
  NEAR(t.layer, 2.9, 1.01 * l0);
  for (double along = 2.9; along < 3.5; along += 2.0 * l0) add_at(water, &s, along, 0.5 * l0);
  add_at(water, &s, 3.8, 0.5 * l0); /* a drop on the slope, behind a gap */
  add_at(water, &s, 3.3, 2.5 * l0); /* and one above it */
  assert_true(tongue_find(water, &s, l0, &t));
  NEAR(t.layer, 3.5, 2.0 * l0);
  mps_particles_destroy(&water);
  water = make_wedge(context, &s, l0, 1.0); /* a front .2 m high */
  assert_true(tongue_find(water, &s, l0, &t));
  assert_true(isinf(t.end) && isinf(t.resolved));
  NEAR(t.layer, 1.0, l0);
}

/* The first assumption that does not hold is the reason; a reference that is no number holds
 * nowhere. */
TEST(a_comparison_holds_or_has_a_reason) {
  comparison c = compare_with("Prandtl", 5.4, 5.0);
  compare_require(&c, true, "not this");
  assert_true(compare_holds(&c));
  NEAR(compare_error(&c), 0.08, 1e-12);
  compare_require(&c, false, "the base has %d parts", 2);
  compare_require(&c, false, "not that");
  assert_string_equal(c.reason, "the base has 2 parts");
  assert_false(compare_holds(&c));
  assert_true(isnan(compare_reference(&c)) && isnan(compare_error(&c)));
  comparison none = compare_with("Prandtl", 5.4, NAN);
  assert_false(compare_holds(&none));
  compare_require(&none, false, "the depth is %g m", NAN);
  assert_null(strstr(none.reason, "nan"));
}

/* A value above a rigorous bound by more than results scatter is warned of. */
TEST(a_bound_that_is_passed_is_warned_of) {
  app a = {.program = "test"};
  compare_bound(&a, "the factor", 1.029, "spirals", 1.0);
  compare_bound(&a, "the factor", 2.0, "spirals", NAN);
  compare_bound(&a, "the factor", NAN, "spirals", 1.0);
  assert_int_equal(a.warnings, 0);
  compare_bound(&a, "the factor", 1.1, "spirals", 1.0);
  assert_int_equal(a.warnings, 1);
  assert_non_null(strstr(a.warning[0], "the factor is 10.0 % above that of spirals"));
  free(a.warning[0]);
}
