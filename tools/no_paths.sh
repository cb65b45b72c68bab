#!/usr/bin/env bash
# Fails if a file to be passed on contains a path of this computer: of the sources, of cargo, of the compiler, or the host
# from which the crates came.
#
#   tools/no_paths.sh FILE…      packages, archives and other files
set -euo pipefail
files=()
for file; do files+=("$(realpath "$file")"); done
cd "$(dirname "$0")/.."
tree=$(mktemp -d)
trap 'rm -rf "$tree"' EXIT

cargo_home=$(realpath "${CARGO_HOME:-$HOME/.cargo}")
paths=("$PWD" "$(realpath -m "${CARGO_TARGET_DIR:-target}")" "$cargo_home" "$(rustc --print sysroot)")
for registry in "$cargo_home"/registry/src/*; do paths+=("$(basename "$registry")"); done

for file in "${files[@]}"; do
    inside=$tree/$(basename "$file")
    mkdir "$inside"
    case $file in
        *.deb) dpkg-deb --raw-extract "$file" "$inside" ;;
        *.tar.xz) tar --extract --file "$file" --directory "$inside" ;;
        *.zip) python3 -m zipfile --extract "$file" "$inside" ;;
        *) cp "$file" "$inside" ;;
    esac
done
find "$tree" -name '*.gz' -exec gunzip --force {} +
found=0
for path in "${paths[@]}"; do
    if (cd "$tree" && grep --recursive --text --files-with-matches --fixed-strings -e "$path" .); then
        echo "These files contain $path." >&2
        found=1
    fi
done
exit $found
