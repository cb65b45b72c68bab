# To be sourced: variables with which cargo builds for 64-bit Windows (--target "$windows"), with mingw as the linker.
# Where rustup has installed the target, it is used. Otherwise this takes Debian's second compiler, rustc-web, and compiles
# the standard library from its source with the program; Cargo calls this build-std, and it is not stable.

windows=x86_64-pc-windows-gnu
export CARGO_TARGET_X86_64_PC_WINDOWS_GNU_LINKER=x86_64-w64-mingw32-gcc
if [ ! -d "$(rustc --print target-libdir --target "$windows" 2>/dev/null)" ]; then
    [ -d /usr/lib/rustlib/src/rust ] || { echo "There is no standard library for Windows; see docs/building.md." >&2; exit 1; }
    export PATH=/usr/bin:/bin RUSTC=/usr/bin/rustc RUSTDOC=/usr/bin/rustdoc RUSTC_BOOTSTRAP=1
    export CARGO_UNSTABLE_BUILD_STD=std,panic_unwind
fi
