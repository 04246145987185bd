#!/usr/bin/env bash
# Builds the crates that have to run without an operating system for one that has none, so that
# their `no_std` is shown and not only said: a dependency that needs `std` does not compile there.
#
#   scripts/bare-metal.sh                 the compiler's own target by rustup, else Debian's packages
#   scripts/bare-metal.sh --from-debian   Debian's packages, whether or not rustup has the target
#
# Needs nothing but the network, and that only the first time. What it fetches stays in the clone:
# .cache/bare-metal (about 150 MB fetched, 850 MB unpacked, Debian's way only) and target/bare-metal.
set -euo pipefail
cd "$(dirname "$0")/.."

target=thumbv7m-none-eabi
crates=(rsapien-protocol rsapien-firmware-model)
cache=.cache/bare-metal

build() {
    local packages=() crate
    for crate in "${crates[@]}"; do packages+=(--package "$crate"); done
    cargo build --release --target "$target" --target-dir target/bare-metal "${packages[@]}" "$@"
    echo "bare-metal: ${crates[*]} build for $target, without std and without alloc"
}

has_rustup_target() {
    command -v rustup >/dev/null || return 1
    rustup target list --installed 2>/dev/null | grep -qx "$target" && return 0
    echo "bare-metal: asking rustup for $target"
    timeout 120 rustup target add "$target" >/dev/null 2>&1
}

# A second compiler of Debian with the sources of `core`, unpacked into the cache, not installed.
fetch_from_debian() {
    [ -e "$cache/complete" ] && return 0
    command -v apt-get >/dev/null && command -v dpkg >/dev/null || return 1
    echo "bare-metal: fetching Debian's rustc-web and its sources (once)"
    rm -rf "$cache" && mkdir -p "$cache/packages" "$cache/root"
    # Package lists that are old or absent are renewed where we may; where not, they may do.
    apt-get update >/dev/null 2>&1 || true
    local library llvm
    library=$(apt-cache depends libstd-rust-web-dev 2>/dev/null | sed -n 's/.*Depends: \(libstd-rust-web-[0-9.]*\)$/\1/p')
    [ -n "$library" ] || return 1
    llvm=$(apt-cache depends "$library" | sed -n 's/.*Depends: \(libllvm[0-9]*\)$/\1/p')
    (cd "$cache/packages" && apt-get download rustc-web rust-web-src libstd-rust-web-dev "$library" $llvm) \
        >/dev/null 2>&1 || return 1
    local package
    for package in "$cache"/packages/*.deb; do dpkg -x "$package" "$cache/root" || return 1; done
    rm -r "$cache/packages"
    touch "$cache/complete"
}

build_with_debian() {
    local root
    root=$(cd "$cache/root" && pwd)
    # The lints of the workspace are the pinned compiler's; a newer one may know more of them.
    LD_LIBRARY_PATH="$root/usr/lib/$(uname -m)-linux-gnu" RUSTC="$root/usr/bin/rustc" \
        RUSTC_BOOTSTRAP=1 RUSTFLAGS="--cap-lints warn" build -Z build-std=core
}

if [ "${1:-}" != --from-debian ] && has_rustup_target; then
    build
elif fetch_from_debian; then
    build_with_debian
else
    cat >&2 <<END
bare-metal: no compiler for $target. One of these is missing:
  - rustup with the network: rustup target add $target
  - on Debian 12 or newer, the packages rustc-web, rust-web-src, libstd-rust-web-dev and what they
    need (suite bookworm-security): apt-get update, then this script again
END
    exit 1
fi
