#!/usr/bin/env bash
# Installs a Debian package on a bare system (debootstrap, in a folder of its own), and uses it there as an ordinary user: the
# version, a byte of a virtual encoder that is changed and verified, the window on a virtual screen. Then it removes the
# package again. Nothing is compiled; downloads are kept in target/debian for the next run.
#
#   tests/tools/debian.sh PACKAGE        as root; needs debootstrap, Xvfb and Python 3
set -euo pipefail
# debootstrap is in /usr/sbin, which is not in every PATH.
PATH=$PATH:/usr/sbin
package=$(realpath "${1:?usage: debian.sh PACKAGE}")
cd "$(dirname "$0")/../.."

skip() { echo "The package is not installed on a bare system here: $*"; exit 0; }
[ "$(id -u)" = 0 ] || skip "that needs root."
for command in debootstrap Xvfb python3; do
    command -v "$command" >/dev/null || skip "$command is missing."
done
# The release of this computer, from where its own packages come.
codename=$(. /etc/os-release && echo "${VERSION_CODENAME:-}")
mirror=$(apt-get indextargets --format '$(CODENAME) $(COMPONENT) $(REPO_URI)' 'Created-By: Packages' |
    sed -n "s/^$codename main //p" | head -n 1)
[ -n "$mirror" ] || skip "apt has no source for the release of this computer."

cache=$(realpath -m "${CARGO_TARGET_DIR:-target}")/debian
bare=$(mktemp -d)
processes=()
finish() {
    kill "${processes[@]}" 2>/dev/null || true
    wait
    umount "$bare/proc" "$bare" 2>/dev/null || true
    rm -rf --one-file-system "$bare"
}
trap finish EXIT
began=$(date +%s%N)
passed() { # passed WHAT: prints the time since the last step
    local now
    now=$(date +%s%N)
    printf '%6.1f s  %s\n' "$(((now - began) / 100000000))e-1" "$1"
    began=$now
}
fail() { echo "$*" >&2; exit 1; }
inside() { env -i PATH=/usr/sbin:/usr/bin:/sbin:/bin LC_ALL=C.UTF-8 DEBIAN_FRONTEND=noninteractive chroot "$bare" "$@"; }

exec {number}<> <(:)
mkdir -p "$cache/archives/partial"
Xvfb -displayfd "$number" -screen 0 1280x800x24 -nolisten tcp -fbdir "$cache" 2>/dev/null &
processes+=($!)
read -r -t 20 -u "$number" display || fail "The virtual screen does not start."
# What an ordinary user without groups starts there: an array, because a function would be a process of its own.
user=(env -i PATH=/usr/sbin:/usr/bin:/bin LC_ALL=C.UTF-8 HOME=/home/user "DISPLAY=:$display" LIBGL_ALWAYS_SOFTWARE=1
    chroot --userspec=1000:1000 --groups= "$bare")

# In memory where possible, which is quicker.
mount -t tmpfs -o size=2g,mode=755 tmpfs "$bare" 2>/dev/null || chmod 755 "$bare"
debootstrap --variant=minbase --cache-dir="$cache/archives" "$codename" "$bare" "$mirror" >"$cache/debootstrap.log" 2>&1 ||
    { tail -n 20 "$cache/debootstrap.log"; exit 1; }
mount -t proc proc "$bare/proc" 2>/dev/null || skip "a system in a folder cannot have /proc."
mkdir -p "$bare/home/user" && chown 1000:1000 "$bare/home/user"
passed "bare $codename"

# Losing this system with the power is no loss.
echo force-unsafe-io >"$bare/etc/dpkg/dpkg.cfg.d/unsafe-io"
cp "$package" "$bare/encoder-studio.deb"
cp "$cache"/archives/*.deb "$bare/var/cache/apt/archives/"
inside apt-get install --yes --quiet --no-install-recommends \
    /encoder-studio.deb shared-mime-info libglib2.0-bin >"$cache/install.log" 2>&1 ||
    { tail -n 20 "$cache/install.log"; exit 1; }
cp --update "$bare"/var/cache/apt/archives/*.deb "$cache/archives/"
passed "package installed with $(grep -c '^Setting up' "$cache/install.log") packages"

for profile in $(find profiles -name '*.ron') Cargo.toml assets/theme.ron; do
    cp "$profile" "$bare/home/user/$(basename "$profile")"
    type=$(inside gio info --attributes=standard::content-type "/home/user/$(basename "$profile")")
    case $profile in profiles/*) wanted=1 ;; *) wanted=0 ;; esac
    [ "$(grep -c application/x-encoder-studio-profile <<<"$type" || true)" = $wanted ] || fail "$profile has the type $type"
done
passed "profiles recognised by their content"

completed=$(inside bash -O extglob -c '
    . /usr/share/bash-completion/completions/encoder-studio
    COMP_WORDS=(encoder-studio read h) COMP_CWORD=2
    $(complete -p encoder-studio | sed "s/.*-F \([^ ]*\).*/\1/") encoder-studio h read
    echo "${COMPREPLY[*]}"')
[ "$completed" = "hiperface hiperdrive" ] || fail "bash completes: $completed"

"${user[@]}" encoder-studio --version
"${user[@]}" encoder-studio simulate hiperface --listen 127.0.0.1:0 >"$bare/home/ready" &
processes+=($!)
for _ in $(seq 50); do
    [ -s "$bare/home/ready" ] && break
    sleep 0.1
done
read -r _ _ address <"$bare/home/ready" || fail "The virtual encoder does not start."
"${user[@]}" encoder-studio write hiperface field:0@8+1 5A --link "tcp:$address" --yes >/dev/null
byte=$("${user[@]}" encoder-studio read hiperface field:0@8+1 --link "tcp:$address" --json)
case $byte in *'"5A"'*) ;; *) fail "The byte was not written: $byte" ;; esac
"${user[@]}" encoder-studio save hiperface --link "tcp:$address" -o /home/user/encoder.ron >/dev/null
"${user[@]}" encoder-studio verify /home/user/encoder.ron --link "tcp:$address"
passed "byte of a virtual encoder written, read back and verified"

"${user[@]}" encoder-studio >"$bare/home/window.log" 2>&1 &
window=$!
processes+=("$window")
for _ in $(seq 60); do
    sleep 0.5
    kill -0 "$window" 2>/dev/null || fail "The window has closed: $(cat "$bare/home/window.log")"
    # A window that is only filled with its background has a few colours, its text in grey levels many.
    colours=$(python3 tests/tools/colours.py "$cache/Xvfb_screen0")
    [ "$colours" -gt 64 ] && break
done
[ "$colours" -gt 64 ] || fail "The window is empty: $colours colours."
passed "window drawn in $colours colours"

kill "${processes[@]}"
wait
processes=()
inside apt-get purge --yes --quiet encoder-studio >"$cache/purge.log" 2>&1
left=$(inside find / -xdev -not -path '/proc/*' -name '*encoder-studio*' -not -path '/home/*' -not -name encoder-studio.deb)
[ -z "$left" ] || fail "Removing the package left these files: $left"
passed "package removed"
