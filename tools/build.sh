#!/usr/bin/env bash
# Builds the program for passing on: the same commit gives the same bytes, without a path of this computer in them.
set -euo pipefail
cd "$(dirname "$0")/.."
. tools/reproducible.sh
cargo build --release --locked "$@"
