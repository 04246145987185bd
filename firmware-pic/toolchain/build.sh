#!/bin/sh
# Builds the C compiler for the PIC18 from the distribution's own source package: build.sh [DEST]
# (default: .cache/firmware-toolchain in the clone). About 2 minutes of processor time, 200 MB while it builds.
#
# Debian's binary package of sdcc leaves the port for the PIC18 ("pic16" in sdcc's words) out and its source package has
# it, with the compiler's own library. Built are: sdcc with that one port, and the parts of the library that compiled C
# can call. The preprocessor, the assembler and the linker are the distribution's (packages sdcc and gputils).
#
# SDCC_SOURCE=FILE   take the source archive from FILE instead of fetching it
# Exit status: 0 the compiler stands in DEST, 1 it does not build, 3 what is needed to build it cannot be had here:
# whoever calls goes on with the committed images and says so.
set -eu

VERSION=4.2.0+dfsg
PACKAGE=$VERSION-1
ARCHIVE=sdcc_$VERSION.orig.tar.xz
ARCHIVE_SHA256=ebe7bfb0894380cd92798b57fb9de96e6c0b913a02b6854d0a01cd70328c1578
LIBRARY_SOURCES="int/mulint int/divsint int/divuint int/modsint int/moduint
    char/divschar char/divuchar char/modschar char/moduchar
    long/mullong long/divslong long/divulong long/modslong long/modulong
    gptr/gptrget1 gptr/gptrget2 gptr/gptrget3 gptr/gptrget4 gptr/gptrput1 gptr/gptrput2 gptr/gptrput3 gptr/gptrput4
    lregs/lrst lregs/lrrest"

here=$(cd "$(dirname "$0")" && pwd)
root=$(cd "$here/../.." && pwd)
destination=${1:-$root/.cache/firmware-toolchain}
mkdir -p "$destination"
destination=$(cd "$destination" && pwd)
work=$destination/work
stamp=$destination/stamp
recipe=$(sha256sum "$here/build.sh" | cut -d ' ' -f 1)

say() { echo "firmware toolchain: $*"; }
cannot() {
    echo "firmware toolchain: $*" >&2
    echo "firmware toolchain: not built; the committed images in firmware-pic/hex need no compiler" >&2
    exit 3
}
fails() {
    echo "firmware toolchain: $*" >&2
    exit 1
}

if [ -f "$stamp" ] && [ "$(cat "$stamp")" = "$recipe" ]; then
    say "sdcc $PACKAGE stands in $destination"
    exit 0
fi
rm -f "$stamp"

for tool in sdcpp gpasm gplib gplink make g++ flex bison xz sha256sum; do
    command -v "$tool" > /dev/null || cannot "'$tool' is missing; on Debian 12: apt-get install" \
        "--no-install-recommends sdcc gputils g++ make bison flex libboost-dev zlib1g-dev xz-utils"
done
echo '#include <boost/graph/adjacency_list.hpp>' | g++ -E -x c++ - > /dev/null 2>&1 ||
    cannot "the headers of boost are missing; on Debian: apt-get install libboost-dev"

is_the_archive() { [ -f "$1" ] && [ "$(sha256sum "$1" | cut -d ' ' -f 1)" = $ARCHIVE_SHA256 ]; }

# Puts the source archive into $work, through a private copy of this machine's package sources with deb-src.
fetch() {
    if [ -n "${SDCC_SOURCE:-}" ]; then
        is_the_archive "$SDCC_SOURCE" || fails "SDCC_SOURCE=$SDCC_SOURCE is not $ARCHIVE (sha256 $ARCHIVE_SHA256)"
        cp "$SDCC_SOURCE" "$work/$ARCHIVE"
        return
    fi
    command -v apt-get > /dev/null ||
        cannot "no apt-get here to fetch the source package with; give the archive with SDCC_SOURCE=$ARCHIVE"
    rm -rf "$work/apt"
    mkdir -p "$work/apt/parts" "$work/apt/lists/partial" "$work/apt/cache/archives/partial"
    for list in /etc/apt/sources.list.d/*.sources; do
        [ -f "$list" ] && grep -q debian-archive-keyring "$list" || continue
        sed 's/^Types:.*/Types: deb-src/' "$list" > "$work/apt/parts/$(basename "$list")"
    done
    for list in /etc/apt/sources.list /etc/apt/sources.list.d/*.list; do
        [ -f "$list" ] && grep -q '^deb .*debian' "$list" || continue
        sed -n '/debian/s/^deb /deb-src /p' "$list" > "$work/apt/parts/$(basename "$list" .list)-source.list"
    done
    [ -n "$(ls "$work/apt/parts")" ] || cannot "this machine has no package source of Debian"
    set -- -o Dir::Etc::sourcelist=/dev/null -o Dir::Etc::sourceparts="$work/apt/parts" \
        -o Dir::State::lists="$work/apt/lists" -o Dir::Cache="$work/apt/cache" -o APT::Sandbox::User=root \
        -o Acquire::Retries=2 -o Acquire::http::Timeout=30
    say "fetching the source package sdcc $PACKAGE"
    (cd "$work" && apt-get "$@" update -q && apt-get "$@" source -q --download-only "sdcc=$PACKAGE") \
        > "$work/fetch.log" 2>&1 ||
        cannot "the source package sdcc $PACKAGE cannot be fetched: $(grep '^[EW]:' "$work/fetch.log" | head -n 1)"
    is_the_archive "$work/$ARCHIVE" ||
        fails "$work/$ARCHIVE does not have the sha256 $ARCHIVE_SHA256; remove it and try again"
}

mkdir -p "$work"
is_the_archive "$work/$ARCHIVE" || fetch

say "unpacking"
source=$work/sdcc-$VERSION
rm -rf "$source"
(cd "$work" && tar xf "$ARCHIVE")
[ -d "$source" ] || fails "$ARCHIVE holds no folder sdcc-$VERSION"

say "building sdcc with the port for the PIC18"
off=
for port in mcs51 z80 z180 r2k r2ka r3ka sm83 tlcs90 ez80_z80 z80n ds390 ds400 pic14 hc08 s08 stm8 pdk13 pdk14 pdk15 \
    mos6502; do
    off="$off --disable-$port-port"
done
jobs=$(getconf _NPROCESSORS_ONLN 2> /dev/null || echo 1)
# shellcheck disable=SC2086 # the options of configure are words
(cd "$source" && ./configure -q --prefix="$destination" $off --disable-ucsim --disable-device-lib --disable-packihx \
    --disable-sdcdb --disable-sdbinutils --disable-sdcpp --disable-non-free CFLAGS="-O1 -w" CXXFLAGS="-O1 -w") \
    > "$work/configure.log" 2>&1 || fails "configure failed, see $work/configure.log"
make -j"$jobs" -C "$source/src" > "$work/make.log" 2>&1 || fails "make failed, see $work/make.log"

include=$destination/share/sdcc/include
library=$destination/share/sdcc/lib/pic16
rm -rf "$destination/bin" "$destination/share"
mkdir -p "$destination/bin" "$include" "$library"
install -s "$source/bin/sdcc" "$destination/bin/sdcc"
ln -s "$(command -v sdcpp)" "$destination/bin/sdcpp"
cp -r "$source/device/include/pic16" "$source/device/include/asm" "$include/"
cp "$source/device/include/stdbool.h" "$include/"

say "building the compiler's library"
objects=$work/objects
rm -rf "$objects"
mkdir -p "$objects"
for name in $LIBRARY_SOURCES; do
    from=$source/device/lib/pic16/libsdcc
    "$destination/bin/sdcc" -mpic16 -p18f452 --no-warn-non-free -Wa,-w2 --std-c11 --fomit-frame-pointer --obanksel=9 \
        --denable-peeps --optimize-cmp --optimize-df -I"$from" -c "$from/$name.c" -o "$objects/$(basename "$name").o" \
        > "$work/library.log" 2>&1 || fails "the library's $name.c does not compile, see $work/library.log"
done
(cd "$objects" && gplib -c "$library/libsdcc.lib" ./*.o) > "$work/library.log" 2>&1 ||
    fails "gplib failed, see $work/library.log"

rm -rf "$source" "$objects"
echo "$recipe" > "$stamp"
say "sdcc $PACKAGE stands in $destination"
