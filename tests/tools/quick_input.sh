#!/usr/bin/env bash
# Real input events on a virtual screen: quick typing (10 ms a key), double clicks, the wheel and a drag in the tables, the hex
# editor and the cam chart of profiles. What was entered has to be in the saved files, and nothing else may have changed.
#
#   tests/tools/quick_input.sh BINARY        needs Xvfb and xdotool
set -euo pipefail

binary=$(realpath "${1:?usage: quick_input.sh BINARY}")
folder=$(mktemp -d)
server= studio=
trap 'kill $studio $server 2>/dev/null || true; rm -rf "$folder"' EXIT
export HOME=$folder XDG_CONFIG_HOME=$folder/config XDG_DATA_HOME=$folder/data XDG_RUNTIME_DIR=$folder LIBGL_ALWAYS_SOFTWARE=1
unset XDG_STATE_HOME XDG_CACHE_HOME WAYLAND_DISPLAY WAYLAND_SOCKET
mkdir -p "$XDG_CONFIG_HOME/encoder-studio"
echo '(theme: Dark, language: English)' >"$XDG_CONFIG_HOME/encoder-studio/settings.ron"
exec {number}<> <(:)
Xvfb -displayfd "$number" -screen 0 1280x800x24 -nolisten tcp 2>/dev/null &
server=$!
read -r -t 20 -u "$number" screen
export DISPLAY=:$screen

at() { xdotool mousemove "$1" "$2"; sleep 0.1; }          # at X Y
quickly() { xdotool type --delay 10 "$1"; sleep 0.1; }    # quickly TEXT
page() { at 60 $((72 + 36 * $1)); xdotool click 1; sleep 1; } # page N: the Nth entry of the navigation
opened() { # opened KIND: saves a profile of the virtual device, and opens it in the window
    "$binary" save "$1" --link sim: -o "$folder/$1.ron" >/dev/null 2>&1
    cp "$folder/$1.ron" "$folder/before.ron"
    "$binary" --profile "$folder/$1.ron" >/dev/null 2>&1 &
    studio=$!
    window=$(xdotool search --sync --onlyvisible --name encoder-studio | tail -1)
    xdotool windowmove "$window" 0 0 windowsize "$window" 1280 800 windowfocus "$window"
    sleep 3
}
saved() { # saved KIND EXPECTED: saves and closes; EXPECTED is a pattern of the lines that are new in the file
    xdotool key ctrl+s
    sleep 2
    kill "$studio"
    wait "$studio" 2>/dev/null || true
    new=$( (diff "$folder/before.ron" "$folder/$1.ron" || true) | sed -n 's/^> *//p' | sed 's| *//.*||')
    # shellcheck disable=SC2053
    [[ $new == $2 ]] || { printf '%s: expected\n%s\ngot\n%s\n' "$1" "$2" "$new" >&2; exit 1; }
    echo "$1: nothing lost"
}

opened hiperdrive
page 6
at 300 360; xdotool click 1
quickly 1234567890; xdotool key Down
quickly 987654321; xdotool key Down
quickly 4000000001; xdotool key Return
at 500 408; xdotool click --repeat 2 --delay 60 1; quickly 55; xdotool key Return
at 500 440; xdotool click --repeat 10 --delay 20 5; xdotool click --repeat 10 --delay 20 4
saved hiperdrive "24: 1234567890,
26: 987654321,
28: 4000000001,
30: 55,"

opened hiperface
page 2
at 234 236; xdotool click 1; quickly 00112233445566778899aabbccddeeff
saved hiperface '"00 11 22 33 44 55 66 77 88 99 AA BB CC DD EE FF",'

opened interbus
page 6
at 459 567; xdotool click --repeat 3 --delay 30 1; quickly 1234567; xdotool key Tab; quickly 7654321; xdotool key Return
at 560 225; xdotool mousedown 1; at 620 225; at 700 226; xdotool mouseup 1
sleep 1
saved interbus "mask: 0x02,
(cam: 0, start: 1234567, stop: 7654321),
(cam: 1, start: 11000000, stop: 20??????),"
