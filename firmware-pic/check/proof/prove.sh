# SPDX-License-Identifier: MIT OR Apache-2.0
# Proves every theorem of induction.c, two at a time. Status 1 when one is not proven; 3 when there
# is no model checker.
set -eu
export OUT=${OUT:-../../target/firmware/check}

. proof/esbmc.sh
if [ -z "$ESBMC" ]; then
    echo "proof: no ESBMC: pip could not fetch what proof/requirements.txt names (set ESBMC=PATH)" >&2
    exit 3
fi
export ESBMC

# The long ones first.
cat > "$OUT/theorems.txt" <<END
motion package
motion response
motion bumpers
motion reset
motion receive_interrupt
motion transmit_interrupt
motion timer_interrupt
motion input_change_interrupt
motion reception
camera reset
camera receive_interrupt
camera transmit_interrupt
camera timer_interrupt
camera reception
camera package
camera response
END
[ "$(sed -n 's/^void theorem_\(.*\)(void)/\1/p' proof/induction.c | sort)" = \
  "$(sed -n 's/^motion //p' "$OUT/theorems.txt" | sort)" ] || {
    echo "proof: prove.sh does not name every theorem of induction.c" >&2
    exit 1
}
xargs -P 2 -L 1 sh proof/one.sh < "$OUT/theorems.txt" > "$OUT/proven.txt"
${CC:-cc} -std=c11 -O2 -DRSAPIEN_MOTION -I../core proof/scaled.c -o "$OUT/scaled"
{
    "$ESBMC" --version
    sort "$OUT/proven.txt"
    "$OUT/scaled"
} > "$OUT/proof-esbmc.txt"
cat "$OUT/proof-esbmc.txt"
! grep -vq ': proven' "$OUT/proven.txt"
