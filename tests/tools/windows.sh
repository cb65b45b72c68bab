#!/usr/bin/env bash
# Installs the program for Windows under Wine, in a new prefix, and uses it there: commands on virtual devices, the window on a
# virtual screen, with and without a renderer. Then it removes the program and looks for what is left. Nothing is built.
#
#   tests/tools/windows.sh FOLDER     with the files that tools/windows/release.sh has made
#
# Needs the Debian packages wine64, gcc-mingw-w64-x86-64, mesa-vulkan-drivers, xvfb, xdotool, imagemagick and unzip.
set -euo pipefail
dist=$(realpath "${1:?usage: windows.sh FOLDER}")
cd "$(dirname "$0")/../.."
wine=$(command -v wine64 || echo /usr/lib/wine/wine64)
setup=$(ls "$dist"/encoder-studio-*-windows-setup.exe)
msi=$(ls "$dist"/encoder-studio-*-windows-x86_64.msi)
zip=$(ls "$dist"/encoder-studio-*-windows-x86_64.zip)

home=$(mktemp -d)
export WINEPREFIX=$home/prefix WINEARCH=win64 WINEDEBUG=-all WINEDLLOVERRIDES="mscoree,mshtml=;winemenubuilder.exe=d"
export XDG_RUNTIME_DIR=$home LIBGL_ALWAYS_SOFTWARE=1
processes=()
finish() {
    kill "${processes[@]}" 2>/dev/null || true
    /usr/lib/wine/wineserver64 -k 2>/dev/null || wineserver -k 2>/dev/null || true
    wait
    rm -rf "$home"
}
trap finish EXIT
began=$(date +%s%N)
passed() { # passed WHAT: prints the time since the last step
    local now
    now=$(date +%s%N)
    printf '%6s s  %s\n' "$(printf '%d.%d' $(((now - began) / 1000000000)) $(((now - began) / 100000000 % 10)))" "$1"
    began=$now
}
fail() { echo "$*" >&2; exit 1; }
run() { timeout 120 "$wine" "$@"; }
status() { # status WANTED COMMAND…: runs a command of the program and compares its exit status
    local wanted=$1 got=0
    shift
    studio "$@" >"$home/out" 2>"$home/err" || got=$?
    [ "$got" = "$wanted" ] || fail "encoder-studio $*: status $got instead of $wanted: $(cat "$home/out" "$home/err")"
}

coproc SCREEN { exec Xvfb -displayfd 1 -screen 0 1280x800x24 -nolisten tcp 2>/dev/null; }
processes+=("$SCREEN_PID")
read -r -t 20 -u "${SCREEN[0]}" display || fail "The virtual screen does not start."
export DISPLAY=:$display

run wineboot --init >/dev/null 2>&1
# Newer versions of Wine have this library.
[ -e "$WINEPREFIX/drive_c/windows/system32/bcryptprimitives.dll" ] || x86_64-w64-mingw32-gcc -shared \
    -o "$WINEPREFIX/drive_c/windows/system32/bcryptprimitives.dll" tests/tools/windows/bcryptprimitives.c -ladvapi32
passed "new prefix"

programs() { find "$WINEPREFIX/drive_c" -ipath '*encoder-studio*' -not -path '*/dosdevices/*' | sort; }
settings() { run reg query "HKCU\\Software" /s 2>/dev/null | grep -i encoder-studio || true; }

run "$setup" /S
installed=$(dirname "$(find "$WINEPREFIX/drive_c/users" -name encoder-studio-window.exe)")
studio() { run "$installed/encoder-studio.exe" "$@"; }
run reg query 'HKCU\Software\Classes\encoder-studio.profile\shell\open\command' | grep -q 'encoder-studio-window.exe" --profile "%1"' ||
    fail "Profiles are not associated with the program."
passed "installed without questions"

version=$(studio --version | tr -d '\r')
case $(basename "$setup") in encoder-studio-"${version#* }"*) ;; *) fail "The installed version is $version." ;; esac
status 2 identify hiperface
status 2 frobnicate
status 1 identify hiperface --link serial:COM77
grep -q COM77 "$home/err" || fail "The error does not name the port: $(cat "$home/err")"
status 0 ports --json
passed "exit status of commands"

folder=$home/Prüfstand
mkdir "$folder"
(cd "$folder" && exec timeout 600 "$wine" "$installed/encoder-studio.exe" simulate hiperface --listen 127.0.0.1:0 >"$home/ready") &
processes+=($!)
for _ in $(seq 100); do [ -s "$home/ready" ] && break; sleep 0.1; done
read -r _ _ address _ < <(tr -d '\r' <"$home/ready") || fail "The virtual encoder does not start."
link=--link=tcp:$address
cd "$folder"
status 0 identify hiperface "$link" --json
grep -q '"serial_number"' "$home/out" || fail "The encoder is not identified: $(cat "$home/out")"
status 0 save hiperface "$link" -o "Geber Süd.ron"
[ -s "Geber Süd.ron" ] || fail "The profile was not saved."
status 2 write hiperface field:0@8+1 5A "$link" </dev/null
status 0 write hiperface field:0@8+1 5A "$link" --yes
status 0 read hiperface field:0@8+1 "$link" --json
grep -q '"5A"' "$home/out" || fail "The byte was not written: $(cat "$home/out")"
status 3 diff "Geber Süd.ron" "$link"
# As an editor of Windows saves it.
sed -i 's/$/\r/' "Geber Süd.ron"
status 0 restore "Geber Süd.ron" "$link" --yes
status 0 verify "Geber Süd.ron" "$link"
status 0 diff "Geber Süd.ron" "$link"
cd - >/dev/null
studio position hiperface "$link" --count 100000 --interval 0 2>"$home/err" | head -n 2 >/dev/null || true
[ ! -s "$home/err" ] || fail "A closed pipe is reported: $(cat "$home/err")"
passed "byte of a virtual encoder written, compared, restored and verified"

timeout 600 "$wine" "$installed/encoder-studio.exe" simulate hiperdrive --listen 127.0.0.1:0 >"$home/ready2" &
processes+=($!)
for _ in $(seq 100); do [ -s "$home/ready2" ] && break; sleep 0.1; done
read -r _ _ address _ < <(tr -d '\r' <"$home/ready2")
status 0 move hiperdrive 20000 --link "enip:$address?rpi=20" --yes
passed "drive moved over cyclic data (UDP)"

window() { # window [VARIABLE=VALUE]: opens the window as the start menu does, and waits for its picture
    env "$@" timeout 120 "$wine" "$installed/encoder-studio-window.exe" >"$home/window.log" 2>&1 &
    local shown=$! colours=0 size
    processes+=("$shown")
    for _ in $(seq 80); do
        sleep 0.5
        kill -0 "$shown" 2>/dev/null || fail "The window has closed: $(cat "$home/window.log")"
        import -window root "$home/window.png" 2>/dev/null || continue
        # A window that is only filled with its background has a few colours, its text in grey levels many.
        colours=$(identify -format %k "$home/window.png")
        [ "$colours" -gt 200 ] && break
    done
    [ "$colours" -gt 200 ] || fail "The window is empty: $colours colours."
    size=$(xdotool search --onlyvisible --name '^encoder-studio$' getwindowgeometry | sed -n 's/.*Geometry: //p' | tail -n 1)
    case $size in 1[0-9][0-9][0-9]x[6-9][0-9][0-9]) ;; *) fail "The window has the size $size." ;; esac
    [ -z "${PICTURES:-}" ] || cp "$home/window.png" "$PICTURES/window${1+-${1#*=}}.png"
    kill "$shown"
    wait "$shown" 2>/dev/null || true
    passed "window of $size drawn in $colours colours ${1-}"
}
window
# The Direct3D 12 of Wine 8 loses its device, so the second renderer draws with Vulkan here, which Mesa has in software.
window ENCODER_STUDIO_RENDERER=direct3d WGPU_BACKEND=vulkan
found=0
ENCODER_STUDIO_RENDERER=none run "$installed/encoder-studio-window.exe" 2>"$home/err" || found=$?
{ [ "$found" = 1 ] && grep -q "cannot be opened" "$home/err"; } || fail "Without a renderer: status $found, $(cat "$home/err")"
passed "no renderer: a message and status 1"

data=$(find "$WINEPREFIX/drive_c/users" -path '*AppData/Roaming/encoder-studio' -type d)
[ -n "$(find "$data" -name 'settings*')" ] || fail "The settings are not in $data."
kept=$(find "$data" -type f | sort)
# A program that is running is not removed: the virtual devices end first.
kill "${processes[@]:1}" 2>/dev/null || true
run "$installed/uninstall.exe" /S
# It goes on as a copy of itself.
for _ in $(seq 50); do [ -e "$installed" ] && sleep 0.2; done
left=$(programs | grep -v "^$data" || true)
[ -z "$left$(settings)" ] || fail "Removing the program left: $left $(settings)"
[ "$(find "$data" -type f | sort)" = "$kept" ] || fail "Removing the program changed the data of the user."
passed "removed; settings and backups are kept"

run msiexec /i "$(run winepath -w "$msi" | tr -d '\r')" /qn
installed="$WINEPREFIX/drive_c/Program Files/encoder-studio"
status 0 --version
run msiexec /x "$(run winepath -w "$msi" | tr -d '\r')" /qn
left=$(programs | grep -v "^$data" || true)
[ -z "$left" ] || fail "Removing the package left: $left"
passed "package for the whole computer installed and removed"

unzip -q "$zip" -d "$home/unzipped"
installed=$(echo "$home"/unzipped/*)
status 0 --version
[ -s "$installed/encoder-studio-window.exe" ] || fail "The archive is not complete."
passed "archive unpacked"
