# SPDX-License-Identifier: MIT OR Apache-2.0
# one.sh CONTROLLER THEOREM: one line that says what became of a theorem; all of it goes to OUT.
. proof/esbmc.sh

log=$OUT/proof-$1-$2.txt
theorem "$1" "$2" proof/induction.c > "$log"
count=$(sed -n 's/^\*\* 0 of [0-9]* properties failed, \([0-9]*\) passed.*/\1/p' "$log")
if grep -q '^VERIFICATION SUCCESSFUL' "$log" && [ -n "$count" ]; then
    echo "$1 $2: proven, with $count properties"
elif grep -q '^VERIFICATION FAILED' "$log"; then
    echo "$1 $2: REFUTED: $(grep -A 3 '^Violated property' "$log" | tail -n 3 | tr -s '\n ' ' ')"
else
    echo "$1 $2: NOT DECIDED, see $log"
fi
