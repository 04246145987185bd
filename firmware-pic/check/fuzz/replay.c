/* SPDX-License-Identifier: MIT OR Apache-2.0 */
/* Runs kept inputs, each a file, where there is no fuzzer. */
#include <stdio.h>

#include "events.h"

int main(int count, char **paths)
{
    static uint8_t bytes[1 << 16];

    if (count < 2) {
        fprintf(stderr, "usage: %s FILE...\n", paths[0]);
        return 2;
    }
    for (int index = 1; index < count; index++) {
        FILE *file = fopen(paths[index], "rb");
        size_t length;

        if (file == NULL) {
            perror(paths[index]);
            return 2;
        }
        length = fread(bytes, 1, sizeof bytes, file);
        fclose(file);
        /* Said before, so that it is known which one ended the program. */
        printf("%s\n", paths[index]);
        fflush(stdout);
        run_events(bytes, length);
    }
    return 0;
}
