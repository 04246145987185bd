# SPDX-License-Identifier: MIT OR Apache-2.0
# Shows that the proof can fail: each mistake is put into a copy of the core, and the theorem that
# watches over it must be refuted.
set -eu
OUT=${OUT:-../../target/firmware/check}

. proof/esbmc.sh
[ -n "$ESBMC" ] || { echo "proof: no ESBMC" >&2; exit 3; }
case $ESBMC in
/*) ;;
*) ESBMC=$PWD/$ESBMC ;;
esac

# mistake NAME FILE FROM TO CONTROLLER THEOREM
mistake() {
    copy=$OUT/mistake
    rm -rf "$copy"
    mkdir -p "$copy/check"
    cp -r ../core "$copy/core"
    cp -r proof invariants.h "$copy/check"
    sed "s/$3/$4/" "../core/$2" > "$copy/core/$2"
    if cmp -s "../core/$2" "$copy/core/$2"; then
        echo "$1: the place is no longer in $2" >&2
        exit 1
    fi
    log=$(cd "$copy/check" && theorem "$5" "$6" proof/induction.c) || true
    if ! echo "$log" | grep -q '^VERIFICATION FAILED'; then
        echo "$1: NOT REFUTED by $6" >&2
        exit 1
    fi
    echo "$1: refuted by $6:" \
        "$(echo "$log" | grep -A 3 '^Violated property' | sed -n '3s/^ *//p')"
}

{
    mistake "ring taken for one place longer" reception.c \
        'reception_ring.put & RING_MASK' 'reception_ring.put % (RECEIVE_RING_LENGTH + 1u)' \
        camera receive_interrupt
    mistake "content one byte too long" reception.c \
        'content_index == ACTION_CONTENT_LENGTH' 'content_index == ACTION_CONTENT_LENGTH + 1u' \
        motion reception
    mistake "header ignored within a package" reception.c \
        'take_header();' '{}' motion reception
    mistake "one byte too many is sent" transmission.h \
        'next >= SYNCHRONIZATION_PACKAGE_LENGTH' 'next > SYNCHRONIZATION_PACKAGE_LENGTH' \
        camera transmit_interrupt
    mistake "no dead time" joint.c \
        '& joints.motors.driven_last' '\& 0u' \
        motion timer_interrupt
    mistake "a thirty-third step waits" queue.c \
        'queue.count == QUEUE_LENGTH' 'queue.count > QUEUE_LENGTH' motion package
    mistake "any speed is taken" camera.c \
        'speed_deg_per_s < AXIS_SPEED_MAX_DEG_PER_S' 'speed_deg_per_s < 0xFFFFu' camera package
} > "$OUT/proof-can-fail.txt"
cat "$OUT/proof-can-fail.txt"
