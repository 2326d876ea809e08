/* A box falls on the ground. Prints its height every half second, and the hash of the last state. */
#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>

#include "lockstep2d.h"

static void check(ls2d_status status) {
    if (status != LS2D_OK) {
        uint8_t text[256];
        size_t length = 0;
        ls2d_last_error(text, sizeof text, &length);
        if (length > sizeof text) {
            length = sizeof text;
        }
        fprintf(stderr, "error %" PRId32 ": %.*s\n", status, (int)length, (const char *)text);
        exit(1);
    }
}

/* Adds a rectangle with its middle at (0, y). */
static ls2d_body add_rectangle(ls2d_handle world, uint32_t kind, ls2d_fx half_width, ls2d_fx half_height, ls2d_fx y) {
    ls2d_shape_def shape;
    ls2d_body_def def;
    ls2d_body body;
    check(ls2d_shape_def_init(LS2D_RECTANGLE, &shape));
    shape.points[0].x = half_width;
    shape.points[0].y = half_height;
    check(ls2d_body_def_init(kind, &def));
    def.position.y = y;
    check(ls2d_spawn(world, &def, &shape, 1, &body));
    return body;
}

int main(void) {
    ls2d_handle world;
    ls2d_body box;
    ls2d_body_info info;
    ls2d_hash hash;
    int tick;

    if (ls2d_api_version() != LS2D_API_VERSION) {
        fprintf(stderr, "the library has another version than the header\n");
        return 1;
    }
    check(ls2d_world_new(NULL, &world));
    add_rectangle(world, LS2D_FIXED, LS2D_FX(20), LS2D_FX(1), LS2D_FX(-1));
    box = add_rectangle(world, LS2D_DYNAMIC, LS2D_FX_RATIO(1, 4), LS2D_FX_RATIO(1, 4), LS2D_FX(3));
    for (tick = 1; tick <= 120; tick++) {
        check(ls2d_world_step(world));
        if (tick % 30 == 0) {
            check(ls2d_body_get(world, box, &info));
            printf("tick %d: height %.6f m\n", tick, (double)info.position.y / 4294967296.0);
        }
    }
    check(ls2d_world_hash(world, &hash));
    printf("%016" PRIx64 "%016" PRIx64 "\n", hash.high, hash.low);
    check(ls2d_free(world));
    return 0;
}
