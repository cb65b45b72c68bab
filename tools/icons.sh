#!/usr/bin/env bash
# Draws assets/icon/*.png from the SVG. To be run after a change of it; the pictures are kept in the repository, because the
# window contains one and versions of librsvg draw slightly different pixels.
set -euo pipefail
cd "$(dirname "$0")/../assets/icon"
for size in 16 24 32 48 64 128 256; do
    rsvg-convert --width "$size" --height "$size" encoder-studio.svg --output "$size.png"
done
