# To be sourced: variables that make a build depend on nothing but the sources. The same commit gives the same bytes in
# any folder, and no path of this computer gets into a file. SOURCE_DATE_EPOCH replaces the time of the build.

export SOURCE_DATE_EPOCH=${SOURCE_DATE_EPOCH:-$(git log -1 --format=%ct)}
# Modes of files and folders in packages.
umask 022
export LC_ALL=C.UTF-8 TZ=UTC

remapped() { # the flags for rustc, separated as cargo wants them. Of several that fit a path, the last one counts.
    local separator=$'\x1f' folder
    printf %s "--remap-path-prefix=$PWD=."
    printf %s "$separator--remap-path-prefix=$(realpath -m "${CARGO_TARGET_DIR:-target}")=target"
    printf %s "$separator--remap-path-prefix=$(rustc --print sysroot)/lib/rustlib/src/rust=rust"
    # One folder for each registry, named after its host.
    for folder in "${CARGO_HOME:-$HOME/.cargo}"/registry/src/*; do
        printf %s "$separator--remap-path-prefix=$(realpath "$folder")=crates"
    done
}
cargo fetch --locked --quiet
CARGO_ENCODED_RUSTFLAGS=$(remapped)
export CARGO_ENCODED_RUSTFLAGS
