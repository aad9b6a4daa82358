"""run_jobs.py PAGE: runs the programs of a page of short jobs (docs/jobs/short.md), section by section. A job has at most
fifteen lines, prints what the page says (numbers within 1 %, or one of the last digit) and is right within the bar that its
section names: the percents in brackets that it prints."""

import contextlib
import importlib.util
import io
import pathlib
import re
import sys
import time

LINES = 15
page = pathlib.Path(sys.argv[1])
spec = importlib.util.spec_from_file_location("programs", page.parents[1] / "site/programs.py")
programs = importlib.util.module_from_spec(spec)
spec.loader.exec_module(programs)

jobs, names, wrong = 0, {"__name__": "__main__"}, []
for section in page.read_text(encoding="utf-8").split("\n## ")[1:]:
    title = section.splitlines()[0]
    bar = re.search(r"\*\*Bar: ([\d.]+) %", section)
    program = re.search(r"^```python\n(.*?)^```$", section, re.M | re.S)
    if not bar or not program:
        continue
    said = re.search(r"^```text\n(.*?)^```$", section, re.M | re.S)[1]
    lines = [line for line in program[1].splitlines() if line.strip()]
    if len(lines) > LINES:
        wrong.append(f"{title}: {len(lines)} lines, must be at most {LINES}")
    printed, start = io.StringIO(), time.monotonic()
    with contextlib.redirect_stdout(printed):
        exec(compile(program[1], title, "exec"), names)
    found = printed.getvalue()
    print(f"{title} ({time.monotonic() - start:.1f} s):\n{found}", end="")
    differ = programs.agree(said, found)
    if differ:
        wrong.append(f"{title}: the page says {differ[0]!r}, and its program prints {differ[1]!r}")
    off = [abs(float(number)) for number in re.findall(r"\(([-+]?[\d.]+) %\)", found)]
    if not off or max(off) > float(bar[1]):
        wrong.append(f"{title}: off by {off} %, the bar is {bar[1]} %")
    jobs += 1
if jobs != 5:
    wrong.append(f"{jobs} jobs were found, must be 5")
sys.exit("\n".join(wrong) if wrong else 0)
