/* table.h - for the files of tables: what makes a definition of a table's lines (definition.h).
 * SPDX-License-Identifier: BSD-3-Clause */
#pragma once

#include "definition.h"

#include "core/context/released_sizes.h"
#include "ends.h"

#include <float.h>
#include <math.h>
#include <stddef.h>

/* ---- rules ----------------------------------------------------------------------------------- */

#define ANY .allowed.checked = false
#define IN(...) .allowed.checked = true, MPSI_ENDS(__VA_ARGS__)
#define ABOVE(...) .allowed.open_lower = true, IN(__VA_ARGS__)
#define BELOW(...) .allowed.open_upper = true, IN(__VA_ARGS__)
#define BETWEEN(...) .allowed.open_lower = true, .allowed.open_upper = true, IN(__VA_ARGS__)
#define FINITE IN(-DBL_MAX, DBL_MAX)
#define NUMBER IN(-INFINITY, INFINITY)
#define NAMES(list) .allowed.choices = (list)
#define ONE_OF(begin, list) .allowed.choices = #begin ":" list
#define YES_NO NAMES("no|yes")
#define NEEDED .allowed.needed = true
#define RESERVED IN(0.0, 0.0)
#define OR_NAN .allowed.or_nan = true,
#define OR_ZERO .allowed.or_zero = true,
#define OF_AXIS(c) .axis = 1 + (c),
#define MPSI_ENDS(...) MPSI_ENDS_OF(__VA_ARGS__)
#define MPSI_ENDS_OF(a, b) .allowed.lower = (a), .allowed.upper = (b)

/* Of tables of rules: a demand, */
#define GIVEN .demand = MPSI_DEMAND_GIVEN
#define NOT_GIVEN .demand = MPSI_DEMAND_NOT_GIVEN
#define UNUSED .demand = MPSI_DEMAND_UNUSED
#define LESS(S, m) MPSI_COMPARE(LESS, S, m, 1.0)
#define MORE(S, m) MPSI_COMPARE(MORE, S, m, 1.0)
#define AT_MOST(S, m, factor) MPSI_COMPARE(AT_MOST, S, m, factor)
#define AT_LEAST(S, m, factor) MPSI_COMPARE(AT_LEAST, S, m, factor)
#define EACH(S, n, each) MPSI_COMPARE(EACH, S, n, each),
#define RISING(S, n) MPSI_COMPARE(RISING, S, n, 1.0),
#define COMPONENT(c) .begin = (c), .end = (c) + 1,
#define FIRST(n) .end = (n),
#define MPSI_COMPARE(kind, S, m, by)                                                               \
  .demand = MPSI_DEMAND_##kind, .other = MPSI_AT(S, m), .factor = (by)
/* and a case. */
#define ALWAYS {.kind = MPSI_CASE_ALWAYS}
#define IS(S, m, ...) {.kind = MPSI_CASE_IS, .member = MPSI_AT(S, m), .values = MPSI_SET(__VA_ARGS__)}
#define ISNT(S, m, ...)                                                                            \
  {.kind = MPSI_CASE_IS, .member = MPSI_AT(S, m), .values = ~MPSI_SET(__VA_ARGS__)}
#define WITH(S, m) {.kind = MPSI_CASE_WITH, .member = MPSI_AT(S, m)}
#define WITHOUT(S, m) {.kind = MPSI_CASE_WITHOUT, .member = MPSI_AT(S, m)}
#define BEYOND(S, m, a) {.kind = MPSI_CASE_BEYOND, .member = MPSI_AT(S, m), .limit = (a)}
#define WITHIN(S, m, a) {.kind = MPSI_CASE_WITHIN, .member = MPSI_AT(S, m), .limit = (a)}
#define IN_PLANE {.kind = MPSI_CASE_SCENE, .values = MPSI_SCENE_PLANE | MPSI_SCENE_AXIS}
#define IN_AXISYMMETRY {.kind = MPSI_CASE_SCENE, .values = MPSI_SCENE_AXIS}
#define IN_SPACE {.kind = MPSI_CASE_SCENE, .values = MPSI_SCENE_SPACE}
#define BECAUSE(advice) {.kind = MPSI_CASE_BECAUSE, .text = (advice)}
/* Of boundaries, whose signals are motions; a load has its factor without a signal too. */
#define FACTOR_OF_SIGNALS BECAUSE("it multiplies signals")
#define MPSI_AT(S, m) MPSI_AT_OF(S, m)
#define MPSI_AT_OF(S, m) mpsi_at_##S##_##m
#define MPSI_SET(...) MPSI_SET_OF(__VA_ARGS__, -1, -1, -1, -1, -1, -1)
#define MPSI_SET_OF(a, b, c, d, e, f, ...)                                                         \
  (MPSI_BIT(a) | MPSI_BIT(b) | MPSI_BIT(c) | MPSI_BIT(d) | MPSI_BIT(e) | MPSI_BIT(f))
#define MPSI_BIT(value) ((value) < 0 ? 0u : 1u << ((value) & 31))

#define UNSET NAN /* a default: the library finds it, or the caller has to give it */

/* ---- types ----------------------------------------------------------------------------------- */

#define MPSI_TYPE_INT int32_t
#define MPSI_TYPE_BITS uint32_t
#define MPSI_TYPE_LONG int64_t
#define MPSI_TYPE_REAL double
#define MPSI_TYPE_CHAR char
#define MPSI_TYPE_ADDRESS const void *
#define MPSI_TYPE_CALL mpsi_any_function
typedef void (*mpsi_any_function)(void);

/* Whether a struct's member has the type that its line says. */
#define MPSI_IS_INT(x) _Generic((x), int32_t : 1, int32_t * : 1, const int32_t * : 1, default : 0)
#define MPSI_IS_BITS(x) _Generic((x), uint32_t : 1, default : 0)
#define MPSI_IS_LONG(x) _Generic((x), int64_t : 1, default : 0)
#define MPSI_IS_REAL(x) _Generic((x), double : 1, double * : 1, const double * : 1, default : 0)
#define MPSI_IS_CHAR(x) _Generic((x), char * : 1, const char * : 1, default : 0)
#define MPSI_IS_ADDRESS(x) (!MPSI_IS_REAL_ITSELF(x))
#define MPSI_IS_CALL(x) (!MPSI_IS_REAL_ITSELF(x))
#define MPSI_IS_REAL_ITSELF(x) _Generic((x), double : 1, int64_t : 1, uint64_t : 1, default : 0)

#define MPSI_DEFAULT_INT(value) .initial = (value)
#define MPSI_DEFAULT_BITS(value) .initial = (value)
#define MPSI_DEFAULT_LONG(value) .initial = (value)
#define MPSI_DEFAULT_REAL(value) .initial = (value)
#define MPSI_DEFAULT_CHAR(value) .initial = (value)
#define MPSI_DEFAULT_ADDRESS(value) .text = (value)
#define MPSI_DEFAULT_CALL(value) .text = (value)

#define MPSI_SAME_SAME true
#define MPSI_SAME_OWN false

/* ---- a definition ---------------------------------------------------------------------------- */

#define MPSI_MIRROR(S, type, member, count, unit, rule, initial, ranks)                            \
  MPSI_TYPE_##type member[count];
#define MPSI_BYTES(S, type, member, count, unit, rule, initial, ranks) +sizeof((S *)0)->member
#define MPSI_ALIKE(S, type, member, count, unit, rule, initial, ranks)                             \
  _Static_assert(offsetof(S, member) == offsetof(struct mpsi_mirror_##S, member) &&                \
                     sizeof((S *)0)->member == sizeof((struct mpsi_mirror_##S *)0)->member &&      \
                     MPSI_IS_##type(((S *)0)->member),                                             \
                 "a line of the table and the struct of the header: " #member);
#define MPSI_LINE(S, of_type, of_member, of_count, of_unit, rule, of_initial, ranks)               \
  {.name = #of_member,                                                                             \
   .unit = of_unit,                                                                                \
   .offset = (uint16_t)offsetof(S, of_member),                                                     \
   .count = of_count,                                                                              \
   .type = MPSI_MEMBER_##of_type,                                                                  \
   rule,                                                                                           \
   MPSI_DEFAULT_##of_type(of_initial),                                                             \
   .same = MPSI_SAME_##ranks},

/* Number of a member in its table, for rules. */
#define MPSI_NUMBER(S, type, member, count, unit, rule, initial, ranks) MPSI_AT(S, member),
#define MPSI_RULE(S, of_member, of_demand, ...)                                                    \
  {.member = MPSI_AT(S, of_member), of_demand, .when = {__VA_ARGS__}},

/* Where pointers are shorter than in the table of sizes, so are the structs. */
#define MPSI_RELEASED(S)                                                                           \
  ((size_t)MPSI_RELEASED_##S < sizeof(S) ? (size_t)MPSI_RELEASED_##S : sizeof(S))

/* Without gaps the sum of the members is the struct: none is missing in the table. */
#define MPSI_DEFINITION_MEMBERS(S, T)                                                              \
  struct mpsi_mirror_##S {                                                                         \
    uint32_t struct_size;                                                                          \
    T(MPSI_MIRROR, S)                                                                              \
  };                                                                                               \
  _Static_assert(sizeof(S) == sizeof(struct mpsi_mirror_##S), "the table lacks a member of " #S);  \
  _Static_assert(sizeof(void *) < 8 || sizeof(S) == sizeof(uint32_t) T(MPSI_BYTES, S),             \
                 "the table lacks a member of " #S);                                               \
  T(MPSI_ALIKE, S)                                                                                 \
  static const mpsi_def_member S##_members[] = {T(MPSI_LINE, S)};

#define MPSI_DEFINITION_OF(S, stem, ...)                                                           \
  const mpsi_definition mpsi_definition_of_##S = {#S,                                              \
                                                  "mps_" stem "_defaults",                         \
                                                  sizeof(S),                                       \
                                                  MPSI_RELEASED(S),                                \
                                                  sizeof S##_members / sizeof *S##_members,        \
                                                  S##_members,                                     \
                                                  __VA_ARGS__};

#define MPSI_DEFINITION(S, stem, T)                                                                \
  MPSI_DEFINITION_MEMBERS(S, T)                                                                    \
  MPSI_DEFINITION_OF(S, stem, 0, NULL)

#define MPSI_DEFINITION_RULED(S, stem, T, R)                                                       \
  MPSI_DEFINITION_MEMBERS(S, T)                                                                    \
  enum { T(MPSI_NUMBER, S) };                                                                      \
  static const mpsi_def_rule S##_rules[] = {R(MPSI_RULE, S)};                                      \
  MPSI_DEFINITION_OF(S, stem, sizeof S##_rules / sizeof *S##_rules, S##_rules)
