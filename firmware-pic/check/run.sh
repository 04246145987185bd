#!/bin/sh
# SPDX-License-Identifier: MIT OR Apache-2.0
# run.sh [TARGET...]: make, but ends with status 3 when a tool is missing, and says which Debian
# package has it (make itself ends with status 2 whatever was wrong).
cd "$(dirname "$0")" || exit 1
missing=
for tool in gcc clang clang-tidy cppcheck python3; do
    command -v "$tool" >/dev/null 2>&1 || missing="$missing $tool"
done
case " $* " in
*" coverage "*) command -v gcovr >/dev/null 2>&1 || missing="$missing gcovr" ;;
esac
if [ -n "$missing" ]; then
    echo "missing:$missing (apt-get install$missing)" >&2
    exit 3
fi
if ! echo 'int LLVMFuzzerTestOneInput(void); int LLVMFuzzerTestOneInput(void) { return 0; }' |
    clang -fsanitize=fuzzer,address -x c - -o /dev/null 2>/dev/null; then
    echo "missing: libFuzzer and the sanitizers of clang (apt-get install libclang-rt-dev)" >&2
    exit 3
fi
case " ${*:-proof} " in
*" proof"*)
    . proof/esbmc.sh
    if [ -z "$ESBMC" ]; then
        echo "missing: ESBMC, and pip could not fetch what proof/requirements.txt names (set ESBMC=PATH)" >&2
        exit 3
    fi
    ;;
esac
exec make "$@"
