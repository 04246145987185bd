# SPDX-License-Identifier: MIT OR Apache-2.0
# Lines and branches of core/ that the kept fuzz inputs and, where it is recorded, the comparison
# with the model reach; against unreached.txt.
set -eu
OUT=${OUT:-../../target/firmware/check}
core=$(cd ../core && pwd)
work=$OUT/coverage
rm -rf "$work"

for controller in motion camera; do
    folder=$work/$controller
    mkdir -p "$folder"
    case $controller in
    motion) define=RSAPIEN_MOTION modules="bumper joint motion queue" ;;
    camera) define=RSAPIEN_CAMERA modules="camera" ;;
    esac
    objects=
    for module in command communication crc dead_man reception transmission $modules; do
        gcc -std=c11 -O0 -g --coverage -DNDEBUG -D$define -I"$core" -c "$core/$module.c" \
            -o "$folder/$module.o"
        objects="$objects $folder/$module.o"
    done
    # shellcheck disable=SC2086
    gcc -std=c11 -O0 -g --coverage -D$define -I"$core" -Ifuzz \
        fuzz/bench.c fuzz/events.c fuzz/line.c fuzz/replay.c $objects -o "$folder/replay" \
        2>/dev/null
    "$folder/replay" fuzz/corpus-$controller/* > /dev/null
    # And the program that tests/ drives in lock step, on what it was told there.
    gcc -std=c11 -O0 -g --coverage -D$define -I"$core" -I../port/host \
        ../port/host/lockstep.c ../port/host/host.c $objects -o "$folder/lockstep"
    for events in "$OUT"/events-$controller*; do
        if [ -f "$events" ]; then
            "$folder/lockstep" < "$events" > /dev/null
        fi
    done
    gcovr --root "$core" --object-directory "$folder" --filter "$core/" --exclude-unreachable-branches \
        --json "$folder/coverage.json" "$folder" 2> "$folder/gcovr.txt" || {
        cat "$folder/gcovr.txt" >&2
        exit 1
    }
done
python3 coverage/check.py "$work/motion/coverage.json" "$work/camera/coverage.json"
