#!/usr/bin/env bash
# Builds the program for Windows and makes its files for passing on: an installer for one user (NSIS), a package for a whole
# computer (MSI), and an archive that needs no installation. Prints their paths.
#
#   tools/windows/release.sh FOLDER [VERSION]     VERSION: as in Cargo.toml, or for example 0.2.0-dev.5f2c1ab
set -euo pipefail
folder=$(realpath -m "$1")
cd "$(dirname "$0")/../.."
version=${2:-$(tools/version.sh)}
target=$(realpath -m "${CARGO_TARGET_DIR:-target}")
texts=$(mktemp)
made=$(mktemp -d)
trap 'rm -rf "$texts" "$made"' EXIT
tools/licences.py texts "$texts"

# A folder of its own, because the compiler may be another one than that of the other builds.
export CARGO_TARGET_DIR=$target/windows
. tools/windows/toolchain.sh
. tools/reproducible.sh
cargo build --release --locked --target "$windows"

name=encoder-studio-$version-windows-x86_64
tree=$made/$name
mkdir -p "$folder" "$tree"
cp "$CARGO_TARGET_DIR/$windows/release/encoder-studio.exe" README.md CHANGELOG.md LICENSE-APACHE LICENSE-MIT "$tree"
cp "$texts" "$tree/third-party-licences.txt"
cp -r docs profiles "$tree"
# The same program for the start menu and the explorer: this subsystem opens no console behind the window. Linking it twice
# would yield the same, but the installer compresses equal files to the size of one.
x86_64-w64-mingw32-objcopy --subsystem windows "$tree/encoder-studio.exe" "$tree/encoder-studio-window.exe"
for program in "$tree"/*.exe; do tools/windows/sign.sh "$program"; done
find "$tree" -exec touch --no-dereference --date "@$SOURCE_DATE_EPOCH" {} +

archive=$folder/$name.zip
rm -f "$archive"
(cd "$made" && find "$name" -type f | sort | zip -9 -X -q -@ "$archive")

# The uninstaller removes the files that were installed, and nothing else in their folder.
(cd "$tree" && find . -type f -printf '%P\n') | sort | sed 's|/|\\|g; s|.*|Delete "$INSTDIR\\&"|' >"$made/remove.nsh"
(cd "$tree" && find . -mindepth 1 -type d -printf '%P\n') | sort -r | sed 's|/|\\|g; s|.*|RMDir "$INSTDIR\\&"|' >>"$made/remove.nsh"
setup=$folder/encoder-studio-$version-windows-setup.exe
makensis -V2 -NOCD "-DVERSION=$version" "-DTREE=$tree" "-DREMOVE=$made/remove.nsh" "-DSETUP=$setup" assets/windows/installer.nsi
tools/windows/sign.sh "$setup"

# Windows Installer compares three numbers only.
numbers=${version%%-*}
package=$folder/encoder-studio-$version-windows-x86_64.msi
find "$tree" -type f | sort |
    wixl-heat --prefix "$tree/" --var var.Tree --directory-ref INSTALLDIR --component-group Files --win64 >"$made/files.wxs"
cp assets/windows/package.wxs assets/icon/encoder-studio.ico "$made"
# It reads files only by paths relative to its folder.
(cd "$made" && wixl --arch x64 --output "$package" -D "Version=$numbers" -D "Tree=$name" -D Icon=encoder-studio.ico \
    -D Win64=yes package.wxs files.wxs)
tools/windows/sign.sh "$package"

printf '%s\n' "$setup" "$package" "$archive"
