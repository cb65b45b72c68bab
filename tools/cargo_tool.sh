#!/usr/bin/env bash
# Prints the path of a tool for cargo, which is built first if it is not there.
#
#   tools/cargo_tool.sh NAME VERSION
set -euo pipefail
cd "$(dirname "$0")/.."
folder=$(realpath -m "${CARGO_TARGET_DIR:-target}")/tools/$1-$2
# Not with the flags of a release: a tool is used on this computer only.
[ -x "$folder/bin/$1" ] || env -u CARGO_ENCODED_RUSTFLAGS cargo install --quiet "$1" --version "$2" --locked --debug \
    --root "$folder" --target-dir "$folder/build" >&2
printf '%s\n' "$folder/bin/$1"
