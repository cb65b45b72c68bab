#!/usr/bin/env bash
# Builds the firmware of the adapter: adapter/target/firmware/encoder-adapter.elf and .uf2, which is copied to the boot drive
# of a Pico. Where rustup has installed the target thumbv6m-none-eabi, it is used. Otherwise this takes Debian's second
# compiler, rustc-web, and compiles the core library from its source.
set -euo pipefail
cd "$(dirname "$0")"

target=thumbv6m-none-eabi
if [ ! -d "$(rustc --print target-libdir --target "$target" 2>/dev/null)" ]; then
    [ -d /usr/lib/rustlib/src/rust ] || { echo "There is no core library for the Pico; see docs/building.md." >&2; exit 1; }
    export PATH=/usr/bin:/bin RUSTC=/usr/bin/rustc RUSTDOC=/usr/bin/rustdoc RUSTC_BOOTSTRAP=1
    export CARGO_UNSTABLE_BUILD_STD=core,alloc
    export CARGO_TARGET_THUMBV6M_NONE_EABI_LINKER=ld.lld
fi
# The folder of a build for another compiler must not be shared.
export CARGO_TARGET_DIR=$PWD/../target/firmware
cargo "${1:-build}" --locked --release --target "$target"
[ "${1:-build}" = build ] || exit 0
cp "$CARGO_TARGET_DIR/$target/release/adapter-firmware" "$CARGO_TARGET_DIR/encoder-adapter.elf"
python3 uf2.py "$CARGO_TARGET_DIR/encoder-adapter.elf" "$CARGO_TARGET_DIR/encoder-adapter.uf2"
