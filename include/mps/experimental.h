/* mps/experimental.h - functions that libmps promises nothing about: they may change or go in any
 * release. They serve comparisons with printed methods and studies, not the work of a program that
 * shall be built once and run for years.
 *
 * Their names begin with mps_experimental_. The shared library exports them under the version node
 * LIBMPS_EXPERIMENTAL; mps/mps.h does not include this header.
 * SPDX-License-Identifier: BSD-3-Clause */
#ifndef LIBMPS_EXPERIMENTAL_H
#define LIBMPS_EXPERIMENTAL_H

#include "base.h"

/* Marks what is exported under that node. */
#define MPS_EXPERIMENTAL_API MPS_API

MPS_EXTERN_C_BEGIN

MPS_EXTERN_C_END
#endif
