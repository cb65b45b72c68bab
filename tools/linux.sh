#!/usr/bin/env bash
# Makes the packages for Linux from target/release/encoder-studio, which tools/build.sh has built: the package for Debian
# and Ubuntu, and an archive with the same files for other distributions. Prints their paths.
#
#   tools/linux.sh FOLDER [VERSION]     VERSION: as in Cargo.toml, or for example 0.2.0-dev.5f2c1ab
set -euo pipefail
folder=$(realpath -m "$1")
cd "$(dirname "$0")/.."
. tools/reproducible.sh
version=${2:-$(tools/version.sh)}
release=$(realpath "${CARGO_TARGET_DIR:-target}")/release
made=$release/package
deb=$(tools/cargo_tool.sh cargo-deb 3.8.0)
rm -rf "$made"
mkdir -p "$folder" "$made"

# The example is compiled with the tests, so it has their flags.
env -u CARGO_ENCODED_RUSTFLAGS cargo run --quiet --locked --example manual -- "$made/manual"
gzip -9n "$made"/manual/*.1
tools/licences.py texts "$made/third-party-licences.txt"

# Debian sorts ~ before the end of a version, so that a release replaces what was built before it. A package from Debian
# itself, whose revisions begin with 1, would replace both.
debian=${version/-/\~}-0upstream1
{
    printf 'encoder-studio (%s) unstable; urgency=medium\n\n' "$debian"
    printf '  * Version %s. The changes are in changelog.gz.\n\n' "$version"
    maintainer=$(sed -n 's/^maintainer = "\(.*\)"/\1/p' Cargo.toml)
    printf ' -- %s  %s\n' "$maintainer" "$(date --utc --rfc-email --date "@$SOURCE_DATE_EPOCH")"
} | gzip -9n >"$made/changelog.Debian.gz"

architecture=$(dpkg --print-architecture)
package=$folder/encoder-studio_${debian}_$architecture.deb
"$deb" --no-build --no-strip --deb-version "$debian" --output "$package" --quiet >/dev/null

# The archive is unpacked anywhere, so its folder has the name of the version.
name=encoder-studio-$version-linux-$(uname -m)
tree=$(mktemp -d)
trap 'rm -rf "$tree"' EXIT
dpkg-deb --extract "$package" "$tree/$name"
mv "$tree/$name"/usr/* "$tree/$name"
rmdir "$tree/$name/usr"
cp assets/linux/INSTALL LICENSE-APACHE LICENSE-MIT "$tree/$name"
tar --create --directory "$tree" --sort=name --owner=0 --group=0 --numeric-owner --mtime="@$SOURCE_DATE_EPOCH" "$name" |
    xz --threads=1 >"$folder/$name.tar.xz"

tools/no_paths.sh "$package" "$folder/$name.tar.xz"
printf '%s\n' "$package" "$folder/$name.tar.xz"
