#!/usr/bin/env bash
# Makes all files of a release from the commit that is checked out: packages, lists of their components (SBOM), checksums.
# A commit with the tag of its version (v0.2.0) becomes this version, any other a version that ends in -dev, date and commit.
#
#   tools/release.sh      writes to target/dist, which is emptied first
set -euo pipefail
cd "$(dirname "$0")/.."
folder=$(realpath -m "${CARGO_TARGET_DIR:-target}")/dist
. tools/reproducible.sh

[ -z "$(git status --porcelain)" ] || { echo "There are changes without a commit: git status" >&2; exit 1; }
version=$(tools/version.sh)
tags=$(git tag --points-at HEAD --list 'v[0-9]*')
case $tags in
    "v$version") ;;
    '') version=$version-dev.$(date --utc --date "@$SOURCE_DATE_EPOCH" +%Y%m%d).$(git rev-parse HEAD | cut -c 1-8) ;;
    *) echo "The commit has the tag $tags, Cargo.toml the version $version." >&2; exit 1 ;;
esac
echo "Version $version"

components() { # components SYSTEM TARGET: writes the list of components for a system (SBOM). The tool writes beside Cargo.toml.
    local name=encoder-studio-$version-$1-x86_64.cdx
    "$(tools/cargo_tool.sh cargo-cyclonedx 0.5.9)" cyclonedx --quiet --format json --spec-version 1.5 --target "$2" \
        --override-filename "$name"
    sed "s|$PWD|/encoder-studio|g" "$name.json" >"$folder/$name.json"
    rm "$name.json"
}

rm -rf "$folder"
mkdir -p "$folder"

tools/build.sh
tools/linux.sh "$folder" "$version"
components linux x86_64-unknown-linux-gnu
# Windows, where its compiler and tools are installed.
if [ -x tools/windows/release.sh ]; then
    tools/windows/release.sh "$folder" "$version"
    components windows x86_64-pc-windows-gnu
fi

tools/no_paths.sh "$folder"/*
(cd "$folder" && sha256sum -- * >SHA256SUMS)
cat "$folder/SHA256SUMS"
