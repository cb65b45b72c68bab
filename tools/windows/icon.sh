#!/usr/bin/env bash
# Packs the pictures of assets/icon into encoder-studio.ico. To be run after a change of them.
set -euo pipefail
cd "$(dirname "$0")/../../assets/icon"
pictures=()
for size in 16 24 32 48; do pictures+=("$size.png"); done
for size in 64 128 256; do pictures+=("--raw=$size.png"); done
icotool --create --output encoder-studio.ico "${pictures[@]}"
