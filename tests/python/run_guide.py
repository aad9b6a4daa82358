"""Runs the first Python program of a document, and expects what the text behind "prints" says of it: each line
of the block that follows, numbers to the digits given."""

import contextlib
import io
import re
import sys

text = open(sys.argv[1], encoding="utf-8").read()
program = re.search(r"```python\n(.*?)```", text, re.S).group(1)
expected = re.search(r"prints\n\n```text\n(.*?)```", text, re.S).group(1)
printed = io.StringIO()
with contextlib.redirect_stdout(printed):
    exec(compile(program, sys.argv[1], "exec"), {"__name__": "__main__"})
if printed.getvalue() != expected:
    sys.exit(f"the program prints\n{printed.getvalue()}and not\n{expected}")
