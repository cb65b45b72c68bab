#!/usr/bin/env bash
# Shows that a kind of device can be deleted: removes its folder, its line in the list of kinds, its assets, profiles and
# tests from a copy of the tree, runs the tests of the library there and opens the window.
#
#   tests/tools/without.sh DEVICE        hiperface, biss, ssi, interbus or hiperdrive
#
# The build goes to target/without, for all devices. The window needs Xvfb; without it that part is skipped.
set -euo pipefail

device=${1:?usage: without.sh DEVICE}
root=$(cd "$(dirname "$0")/../.." && pwd)
[ -d "$root/src/devices/$device" ] || { echo "there is no src/devices/$device" >&2; exit 2; }
copy=$(mktemp -d)
display=
trap 'kill ${display:-} 2>/dev/null || true; rm -rf "$copy"' EXIT

# The working tree, including uncommitted edits.
(cd "$root" && git ls-files -z --cached --others --exclude-standard | tar --null --ignore-failed-read -T - -cf -) 2>/dev/null |
    tar -xf - -C "$copy"
cd "$copy"

# The folder, the module that declares it, and the one line that names the kind.
rm -r "src/devices/$device"
sed -i "/^pub mod $device;\$/d" src/devices/mod.rs
sed -i "/^    crate::devices::$device::KIND,\$/d" src/kinds.rs
# The files of the kind besides the code. Tests of the complete list count the kinds; the others are not built here.
rm -rf "assets/texts/$device.ron" "assets/devices/$device" "profiles/$device"
rm -r src/kinds/tests src/kinds/tests.rs
sed -i '/^#\[cfg(test)\]$/,/^mod tests;$/d' src/kinds.rs

left=$(grep -rnE "(devices|super)::$device\b" src || true)
[ -z "$left" ] || { echo "$device is still named:"; echo "$left"; exit 1; }

export CARGO_TARGET_DIR=$root/target/without CARGO_PROFILE_DEV_DEBUG=0
# Another tree at the same path: file times are not comparable.
find src tests -name '*.rs' -exec touch {} +
# Warnings are about parts of the core that only this kind uses.
if ! cargo test --locked --lib -q >"$copy/report" 2>"$copy/errors" || ! cargo build --locked -q 2>>"$copy/errors"; then
    cat "$copy/report" "$copy/errors"
    exit 1
fi
grep "^test result" "$copy/report"

command -v Xvfb >/dev/null || { echo "without $device: the library's tests pass; no Xvfb, no window"; exit 0; }
export HOME=$copy/home XDG_CONFIG_HOME=$copy/home/config XDG_DATA_HOME=$copy/home/data LIBGL_ALWAYS_SOFTWARE=1
unset XDG_STATE_HOME XDG_CACHE_HOME WAYLAND_DISPLAY WAYLAND_SOCKET
mkdir -p "$HOME"
exec {number}<> <(:)
Xvfb -displayfd "$number" -screen 0 1280x800x24 -nolisten tcp 2>/dev/null &
display=$!
read -r -t 20 -u "$number" screen
DISPLAY=:$screen timeout 60 "$CARGO_TARGET_DIR/debug/encoder-studio" &
window=$!
for _ in $(seq 240); do
    grep -rqs "first picture after" "$HOME" && break
    kill -0 "$window" 2>/dev/null || break
    sleep 0.25
done
grep -rhs "first picture after" "$HOME" || { echo "without $device: the window has not been drawn"; exit 1; }
kill "$window" 2>/dev/null || true
wait "$window" 2>/dev/null || true
echo "without $device: the library's tests pass, the window opens"
