#!/bin/sh
# refuses.sh CODE TEXT PROGRAM ARGUMENT...: the program must end with that exit code and print one
# line on stderr, of at most 1000 bytes, that begins with its name and contains the text.
code=$1
text=$2
shift 2
errors=$("$@" 2>&1 >/dev/null)
status=$?
name=$(basename "$1")
echo "exit code $status: $errors"
[ "$status" -eq "$code" ] || { echo "expected exit code $code"; exit 1; }
case $errors in
"$name: "*"$text"*) ;;
*) echo "expected a line with: $text"; exit 1 ;;
esac
[ "$(printf '%s\n' "$errors" | wc -l)" -eq 1 ] || { echo "expected one line"; exit 1; }
[ "$(printf '%s\n' "$errors" | wc -c)" -le 1000 ] || { echo "expected at most 1000 bytes"; exit 1; }
