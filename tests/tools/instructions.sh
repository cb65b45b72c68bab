#!/usr/bin/env bash
# Counts the instructions of some commands of a release build with callgrind, and compares them with
# benches/instructions.txt. More than 5 % above the recorded count fails. Unlike times, the counts are the same on a busy
# computer.
#
#   tests/tools/instructions.sh BINARY            compare
#   tests/tools/instructions.sh BINARY --record   record the counts after an intended change
set -euo pipefail
cd "$(dirname "$0")/../.."
binary=$(realpath "$1")
record=${2:-}
list=benches/instructions.txt

work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
# Nothing of the user's is read, and every run begins without settings and logbook.
export HOME=$work XDG_CONFIG_HOME=$work/config XDG_DATA_HOME=$work/data XDG_CACHE_HOME=$work/cache
python3 - "$work" <<'PYTHON'
import sys
# 50,000 frames of AHM36 (27 clocks) in Gray code: the position advances by 4,099 steps from frame to frame.
with open(sys.argv[1] + "/frames.txt", "w") as frames:
    for number in range(50_000):
        position = number * 4_099 % (1 << 26)
        frames.write(format((position ^ position >> 1) << 1, "027b") + "\n")
PYTHON

failed=0
lines=()
while read -r name count command; do
    case $name in '' | '#'*) lines+=("${name:-} ${count:-} ${command:-}"); continue ;; esac
    # A status other than 0 is not a measurement.
    eval "valgrind --tool=callgrind --callgrind-out-file=$work/out $binary ${command//WORK/$work}" >"$work/stdout" 2>"$work/log" ||
        { echo "$name: the command failed"; tail -5 "$work/log"; exit 1; }
    now=$(sed -n 's/^summary: //p' "$work/out" | tail -1)
    [ -n "$now" ] || now=$(sed -n 's/^totals: //p' "$work/out" | tail -1)
    percent=$(awk -v now="$now" -v before="$count" 'BEGIN { printf "%+.1f", before ? (now / before - 1) * 100 : 0 }')
    verdict=
    if [ "$record" != --record ] && awk -v now="$now" -v before="$count" 'BEGIN { exit !(now > before * 1.05) }'; then
        verdict="  more than 5 % above the recorded count"
        failed=1
    fi
    printf '%-18s %14s instructions  %6s %%%s\n' "$name" "$now" "$percent" "$verdict"
    lines+=("$name $now $command")
done <"$list"
if [ "$record" = --record ]; then
    printf '%s\n' "${lines[@]}" | sed 's/ *$//' >"$list"
fi
exit $failed
