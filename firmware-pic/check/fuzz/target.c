/* SPDX-License-Identifier: MIT OR Apache-2.0 */
#include "events.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    run_events(data, size);
    return 0;
}
