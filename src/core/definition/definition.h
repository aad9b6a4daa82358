/* clang-format off */
/* definition.h - what a definition struct (mps_x_def) is, written once: its table has a line for
 * each member, and defaults, ranges, messages and the agreement of ranks follow from the table. A
 * second table has the rules that depend on other members of the same definition.
 *
 * A table is a macro T(X, S) of lines
 *
 *   X(S, type, member, count, unit, rule, default, ranks)
 *
 *   type     INT int32_t, BITS uint32_t, LONG int64_t, REAL double, CHAR char, ADDRESS any pointer
 *            to data, CALL any pointer to a function
 *   count    1, or the length of an array
 *   rule     ANY                         not looked at
 *            FINITE, NUMBER              any finite real number; an infinite one too, not NaN
 *            IN(a, b)                    a to b
 *            ABOVE(a, b), BELOW(a, b)    without the end a, without the end b
 *            BETWEEN(a, b)               without both
 *            NAMES("a|b||d")             a choice: names of the values 0, 1 and 3
 *            ONE_OF(MPS_X_, "A|B")       a choice: MPS_X_A and MPS_X_B are 0 and 1
 *            NEEDED                      a pointer that is not NULL
 *            RESERVED                    0
 *            before it OR_NAN, OR_ZERO: allowed beside the range; OF_AXIS(c): component c alone has
 *            the default, others 0
 *   ranks    SAME on all ranks of a domain, or OWN
 *
 * A table of rules is a macro R(X, S) of lines
 *
 *   X(S, member, demand, case, ...)
 *
 * The demand applies where all cases do (ALWAYS, or 1 to 4 of them). Lines are looked at in their
 * order, after the ranges of all members. "Given" means other than the default: not NaN, not NULL,
 * not 0 where that is the default; of an array, any component.
 *
 *   case     ALWAYS
 *            IS(S, kind, A, B), ISNT(S, kind, A)  the choice `kind` is one of (none of) at most 6
 *            WITH(S, m), WITHOUT(S, m)     m is given, is not given
 *            BEYOND(S, m, a), WITHIN(S, m, a)  the number m is > a, is <= a; neither for NaN
 *            IN_PLANE, IN_SPACE, IN_AXISYMMETRY   of the solver or set that takes the definition:
 *                                          mpsi_scene of MPSI_DEF_READ_IN. In axisymmetry both of
 *                                          IN_PLANE and IN_AXISYMMETRY apply
 *            BECAUSE("text")               no case: ends the message
 *   demand   GIVEN, NOT_GIVEN
 *            UNUSED                        a member that is given has no effect: a warning, as
 *                                          releases without the rule take it
 *            a range as above              NaN is refused unless OR_NAN stands before it
 *            LESS(S, m), MORE(S, m)        than the member m, component by component
 *            AT_MOST(S, m, f), AT_LEAST(S, m, f)  f times m; these four pass where either is NaN
 *            EACH(S, n, k) range           of an ADDRESS of double: k numbers for each of n, the
 *                                          member with the length; nothing where it is NULL
 *            RISING(S, n) range            the same with k = 1, each above the one before
 *            before it COMPONENT(c), FIRST(n): of an array, c alone, or the first n. Else of three
 *            components those that the scene has
 *
 * So "exactly one of a and b" is  X(S, a, GIVEN, WITHOUT(S, b)) X(S, b, NOT_GIVEN, WITH(S, a)).
 *
 * MPSI_DEFINITION(struct, stem of its _defaults function, T) makes it known, or
 * MPSI_DEFINITION_RULED(struct, stem, T, R). A member that the struct has and the table lacks, or
 * the reverse, does not compile; nor does a rule of a member that is in no table.
 * SPDX-License-Identifier: BSD-3-Clause */
/* clang-format on */
#pragma once

#include <mps/base.h>

#include <stdbool.h>

/* Largest size (bytes) of a definition or a result. A larger one is an error before any byte of the
 * tail is read or written. */
#define MPSI_STRUCT_MOST 4096

typedef enum mpsi_member_type {
  MPSI_MEMBER_INT,
  MPSI_MEMBER_BITS,
  MPSI_MEMBER_LONG,
  MPSI_MEMBER_REAL,
  MPSI_MEMBER_CHAR,
  MPSI_MEMBER_ADDRESS,
  MPSI_MEMBER_CALL
} mpsi_member_type;

/* Values that a line or a rule allows. */
typedef struct mpsi_allowed {
  const char *choices; /* names of the values 0, 1, ... between bars; an empty one is not allowed */
  double lower, upper;
  bool checked; /* `lower` to `upper` are ends */
  bool open_lower, open_upper, or_nan, or_zero, needed;
} mpsi_allowed;

typedef struct mpsi_def_member {
  const char *name, *unit;
  const char *text; /* default of a pointer to text */
  double initial;
  mpsi_allowed allowed;
  uint16_t offset, count;
  uint8_t axis; /* 1 more than the component that alone has the default; 0: all have it */
  uint8_t type; /* mpsi_member_type */
  bool same;
} mpsi_def_member;

/* What the solver or set that takes a definition is; 0: not known. */
typedef enum mpsi_scene {
  MPSI_SCENE_PLANE = 1,
  MPSI_SCENE_AXIS = 2,
  MPSI_SCENE_SPACE = 4
} mpsi_scene;

static inline mpsi_scene mpsi_scene_of(int32_t dim) {
  return dim == 3 ? MPSI_SCENE_SPACE : MPSI_SCENE_PLANE;
}

typedef enum mpsi_case_kind {
  MPSI_CASE_ALWAYS,
  MPSI_CASE_IS,
  MPSI_CASE_WITH,
  MPSI_CASE_WITHOUT,
  MPSI_CASE_BEYOND,
  MPSI_CASE_WITHIN,
  MPSI_CASE_SCENE,
  MPSI_CASE_BECAUSE
} mpsi_case_kind;

typedef struct mpsi_def_case {
  uint8_t kind;    /* mpsi_case_kind */
  uint16_t member; /* its number in the definition */
  uint32_t values; /* bits of a choice, or of scenes */
  double limit;
  const char *text;
} mpsi_def_case;

typedef enum mpsi_demand {
  MPSI_DEMAND_RANGE,
  MPSI_DEMAND_GIVEN,
  MPSI_DEMAND_NOT_GIVEN,
  MPSI_DEMAND_LESS,
  MPSI_DEMAND_MORE,
  MPSI_DEMAND_AT_MOST,
  MPSI_DEMAND_AT_LEAST,
  MPSI_DEMAND_EACH,
  MPSI_DEMAND_RISING,
  MPSI_DEMAND_UNUSED
} mpsi_demand;

#define MPSI_CASES 4

typedef struct mpsi_def_rule {
  mpsi_allowed allowed;
  double factor;          /* of the other member; of EACH: numbers for each */
  uint16_t member, other; /* their numbers in the definition */
  uint8_t demand;         /* mpsi_demand */
  uint8_t begin, end;     /* components; end 0: all that the scene has */
  mpsi_def_case when[MPSI_CASES];
} mpsi_def_rule;

typedef struct mpsi_definition {
  const char *type, *defaults; /* names of the struct, and of the function that fills it */
  size_t size, released;       /* now, and at its first release */
  int32_t count;
  const mpsi_def_member *member; /* all but struct_size */
  int32_t rules;
  const mpsi_def_rule *rule;
} mpsi_definition;

/* mpsi_definition_of_<struct> */
#define MPSI_DEFINITION_DECLARE(NAME, kind, type)                                                  \
  extern const mpsi_definition mpsi_definition_of_##type;
MPS_DEFINITION_TABLE(MPSI_DEFINITION_DECLARE)
#undef MPSI_DEFINITION_DECLARE

/* By MPS_DEF_...; NULL for a number that is none. */
const mpsi_definition *mpsi_definition_of(int32_t kind);

#define MPSI_WHY 320 /* characters of a reason */

/* Writes the defaults to *known, over them the caller's `def`, of any size from the released one
 * on, and checks every member and rule. NULL gives the defaults, checked too. On a failure `why`
 * says which member, its value and what is allowed. `scene`: an mpsi_scene, or 0. */
mps_status mpsi_definition_take(const mpsi_definition *definition, const void *def, void *known,
                                uint32_t scene, char why[MPSI_WHY]);
/* Whether each member is as its line says, and each rule passes, those of unused members aside;
 * else the first that does not. */
bool mpsi_definition_check(const mpsi_definition *definition, const void *known, uint32_t scene,
                           char why[MPSI_WHY]);
/* Whether one rule passes, or does not apply. */
bool mpsi_rule_check(const mpsi_definition *definition, const mpsi_def_rule *rule,
                     const void *known, uint32_t scene, char why[MPSI_WHY]);
bool mpsi_case_applies(const mpsi_definition *definition, const mpsi_def_case *when,
                       const void *known, uint32_t scene);
/* "must be in 0 to 1, or NaN": what a member or a rule allows. */
void mpsi_allowed_text(const mpsi_allowed *allowed, bool whole, char text[MPSI_WHY]);
/* Whether a member is other than its default. */
bool mpsi_member_given(const mpsi_def_member *member, const void *def);
/* The first `size` bytes of the defaults, with struct_size. */
void mpsi_definition_fill(const mpsi_definition *definition, void *def, size_t size);
/* Component `c` of a number. */
double mpsi_member_value(const mpsi_def_member *member, const void *def, int32_t c);
void mpsi_member_set(const mpsi_def_member *member, void *def, int32_t c, double value);
/* A value in a message: the name of a choice, else (and where `member` is NULL) the number. */
struct mpsi_name mpsi_member_text(const mpsi_def_member *member, double value);
const mpsi_def_member *mpsi_member_find(const mpsi_definition *definition, const char *name);
