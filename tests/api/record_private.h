/* record_private.h - what the wrappers of make_record.py call to write a call of the library as C.
 * SPDX-License-Identifier: BSD-3-Clause */
#ifndef TESTS_API_RECORD_PRIVATE_H
#define TESTS_API_RECORD_PRIVATE_H

#include "plan.h"

#include <stddef.h>

typedef void (*rec_any)(void); /* a callback of any type */

bool rec_begin(const char *name); /* false: nothing is written */
void rec_count(
    long long count); /* an integer of the call, by which lengths of arrays are guessed */

/* Before the call: arrays and structs that its arguments point to. */
void rec_array(const char *type, const void *values, size_t size, int real);
int rec_structs(const char *type, const void *values, void *copy, size_t size); /* at most 8 */
void rec_brace(void);
void rec_unbrace(void);
void rec_open(int argument, const char *type);
void rec_close(void);
void rec_member(const char *name);
void rec_element(const char *name, int index, int dimensions);
void rec_next(void);

/* The call, and its arguments or the values of members. */
void rec_call_status(const char *name);
void rec_call_object(const char *name);
void rec_call_other(const char *name);
void rec_comma(void);
void rec_end_call(void);
void rec_real(double value);
void rec_whole(long long value);
void rec_text(const char *text);
void rec_texts(const char *const *texts, int unused);
void rec_object(const void *object);
void rec_place(const char *type, const void *object, bool there);
void rec_function(rec_any function);
void rec_user(const void *user);
void rec_argument(int argument, bool there);
void rec_name_array(const void *values);
void rec_room(int argument, bool there);
void rec_find_edit(const void *data, int fresh);
void rec_edit(bool there);
void rec_fill_edit(const mps_view *view, const void *data);

/* While the library works nothing is written. After it: the handles and the status. */
void rec_enter(void);
void rec_leave(void);
void rec_made(const void *object, bool there);
void rec_result(const void *object);
void rec_keep_edit(const void *data);
void rec_status(mps_status status);
void rec_finish(void);

#endif
