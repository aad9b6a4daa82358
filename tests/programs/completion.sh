#!/bin/bash
# completion.sh DIRECTORY: what bash and zsh complete after the programs' names, from the files beside the programs;
# and the commands of the manual pages, which must be free of wrong options.
. "$(dirname "$0")/checks.sh"
completions=$1/completions
[ -d "$completions" ] || { echo "skipped: this build makes no completions"; exit 77; }

complete_line() { # complete_line WORD...: what bash offers for the last word
  COMP_WORDS=("$@") COMP_CWORD=$(($# - 1)) COMPREPLY=()
  compopt() { :; } # is for a shell that waits for keys
  "_${1//-/_}"
  echo "${COMPREPLY[*]}"
}
same() { [ "$1" = "$2" ] || fail "completes '$1', not '$2'"; }

count=0
for file in "$completions"/bash/*; do
  . "$file" || fail "$file"
  program=$(basename "$file") count=$((count + 1))
  # every option of --help, and no other
  "$1/$program" --help | sed -n 's/^  \(--[A-Za-z0-9-]*\).*/\1/p' | sort >"$work/there"
  complete_line "$program" -- | tr ' ' '\n' | sort >"$work/offered"
  cmp "$work/there" "$work/offered" || fail "$program: other options than those of --help"
  if command -v zsh >/dev/null; then zsh -n "$completions/zsh/_$program" || fail "_$program"; fi
  grep -q "^#compdef $program\$" "$completions/zsh/_$program" || fail "_$program is of another program"
done
[ "$count" -ge 10 ] || fail "completions of $count programs alone"
same "$(complete_line mps-wave --integrator ver)" verlet
same "$(complete_line mps-wave --integrator = le)" leapfrog
same "$(complete_line mps-wave --wave '')" "S P"
same "$(complete_line mps-wave --height '')" ""
touch "$work/ground one.csv"
same "$(complete_line mps-wave --layers "$work/ground")" "$work/ground one.csv"

manual=$(dirname "$0")/../../programs/manual
sed -n 's/^\.B \(mps.*\)/\1/p' "$manual"/mps-*.h2m | tr -d '\\' | grep -v '|' >"$work/commands"
[ "$(wc -l <"$work/commands")" -ge 20 ] || fail "few commands in the manual pages"
while read -r program arguments; do
  [ -x "$1/$program" ] || continue # left out of this build
  # shellcheck disable=SC2086
  "$1/$program" $arguments --help >"$work/help" 2>&1 || fail "manual page: $program $arguments"
done <"$work/commands"
