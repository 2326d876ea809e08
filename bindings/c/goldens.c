/* Verifies the replays named on the command line, and prints `name verdict ticks hash` for each. */
#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>

#include "lockstep2d.h"

static uint8_t *read_file(const char *path, size_t *size) {
    FILE *file = fopen(path, "rb");
    uint8_t *bytes;
    long length;
    if (file == NULL) {
        return NULL;
    }
    fseek(file, 0, SEEK_END);
    length = ftell(file);
    rewind(file);
    bytes = malloc((size_t)length + 1);
    *size = fread(bytes, 1, (size_t)length, file);
    fclose(file);
    return bytes;
}

int main(int count, char **paths) {
    int failed = 0, i;
    for (i = 1; i < count; i++) {
        ls2d_verdict verdict;
        size_t size = 0;
        uint8_t *bytes = read_file(paths[i], &size);
        if (bytes == NULL || ls2d_replay_verify(bytes, size, NULL, &verdict) != LS2D_OK) {
            fprintf(stderr, "%s cannot be verified\n", paths[i]);
            return 1;
        }
        printf("%s %s %" PRIu64 " %016" PRIx64 "%016" PRIx64 "\n", paths[i],
            verdict.kind == LS2D_MATCH ? "match" : "different", verdict.ticks, verdict.hash.high, verdict.hash.low);
        failed |= verdict.kind != LS2D_MATCH;
        free(bytes);
    }
    return failed;
}
