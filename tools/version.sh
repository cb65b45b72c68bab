#!/usr/bin/env bash
# Prints the version of Cargo.toml, the only place where it is written.
set -euo pipefail
cd "$(dirname "$0")/.."
cargo pkgid --locked | sed 's/.*[#@]//'
