#!/bin/sh
# Builds the compiler and both images at 40 MHz and 57600 baud from nothing but this clone and the
# distribution's source package.
#
#   build.sh           and puts images, symbols, sizes and sha256 here
#   build.sh --check   and compares them byte for byte with those here
#
# FIRMWARE_TOOLCHAIN=DIR   where the compiler is, or is to be built (default .cache/firmware-toolchain)
# Exit status: 0 done, or equal; 1 it does not build, or differs; 3 the compiler cannot be built here
# (with --check the committed files are still compared with their SHA256SUMS).
set -eu

here=$(cd "$(dirname "$0")" && pwd)
root=$(cd "$here/../.." && pwd)
toolchain=${FIRMWARE_TOOLCHAIN:-$root/.cache/firmware-toolchain}
built=$root/target/firmware/pic18/hex
images="rsapien-motion-18f452-40mhz-57600 rsapien-camera-18f2320-40mhz-57600"

case ${1:-} in
"" | --check) ;;
*)
    sed -n '2,12s/^# \{0,1\}//p' "$0" >&2
    exit 1
    ;;
esac

if [ "${1:-}" = --check ]; then
    (cd "$here" && sha256sum --quiet -c SHA256SUMS) || {
        echo "firmware images: the files in firmware-pic/hex are not those of its SHA256SUMS" >&2
        exit 1
    }
fi

"$root/firmware-pic/toolchain/build.sh" "$toolchain"
make -s -C "$root/firmware-pic/port/pic18" check
rm -rf "$built"
make -s -C "$root/firmware-pic/port/pic18" SDCC="$toolchain/bin/sdcc" OUT="$built"

# What goes here, in a folder of its own.
fresh=$built/fresh
mkdir -p "$fresh"
for image in $images; do
    cp "$built/$image.hex" "$built/$image.symbols" "$fresh/"
done
# The table in README.md, its last two lines.
{
    grep -v '^| rsapien-' "$here/README.md"
    for image in $images; do
        cat "$built/$image.sizes"
    done
} > "$fresh/README.md"
(cd "$fresh" && sha256sum -- *.hex *.symbols > SHA256SUMS)

if [ "${1:-}" = --check ]; then
    for file in SHA256SUMS README.md $(cd "$fresh" && ls -- *.hex *.symbols); do
        if ! cmp "$fresh/$file" "$here/$file"; then
            echo "firmware images: firmware-pic/hex/$file is not what the sources give: run firmware-pic/hex/build.sh" >&2
            exit 1
        fi
    done
    echo "firmware images: those in firmware-pic/hex are what the sources give, byte for byte"
else
    cp "$fresh"/* "$here/"
    echo "firmware images: written to firmware-pic/hex"
fi
