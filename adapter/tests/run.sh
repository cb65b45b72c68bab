#!/usr/bin/env bash
# Builds the firmware of the adapter and tests it in an emulated Pico: with encoders on its pins, and with the studio's
# command line. Installs what is missing on Debian.
#
#   adapter/tests/run.sh [STUDIO]      the studio's executable; without it, that part is not run
set -euo pipefail
studio=${1:+$(realpath "$1")}
cd "$(dirname "$0")/.."

need() { # need COMMAND PACKAGE…: installs packages of Debian where COMMAND does not succeed
    local command=$1
    shift
    eval "$command" >/dev/null 2>&1 && return
    apt-get update -qq
    DEBIAN_FRONTEND=noninteractive apt-get install -y -qq "$@"
}
need "test -d /usr/lib/rustlib/src/rust" rustc-web cargo-web rust-web-src
need "command -v ld.lld" lld
need "command -v python3" python3
need "command -v npm" nodejs npm

RUSTFLAGS=-Dwarnings firmware/build.sh
export ADAPTER_UF2=$PWD/target/firmware/encoder-adapter.uf2
(cd emulator && npm ci --silent --no-audit --no-fund && timeout 600 node --test test/*.test.mjs)
if [ -n "$studio" ]; then
    python3 tests/studio.py "$studio" "$ADAPTER_UF2"
else
    echo "The studio's command line was not tested: its executable was not given."
fi
