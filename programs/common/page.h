/* page.h - index.html in the directory of results: pictures, numbers of summary.json, the command
 * line and links to the files, on one page that needs nothing from elsewhere.
 * SPDX-License-Identifier: BSD-3-Clause */
#pragma once

#include "output.h"

/* The page of the files noted so far by app_wrote. */
bool page_write(app *a, const char *directory);
