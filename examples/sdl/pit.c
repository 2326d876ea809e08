/* A pit of shapes in an SDL window. Arrow keys push the dark ball, a click is an explosion, Escape quits. Every game is
 * recorded: `lockstep2d verify pit.replay` plays the recording and compares the states.
 *
 *   pit [--replay FILE] [--ticks N] [--screenshot FILE.bmp]
 */
#include <SDL.h>
#include <inttypes.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "lockstep2d.h"

enum { WIDTH = 960, HEIGHT = 640, PIXELS_PER_METRE = 40, CORNERS_MAX = 48, BODIES_MAX = 256 };

static const double METRE = 4294967296.0;

static void check(ls2d_status status) {
    if (status != LS2D_OK) {
        uint8_t text[256];
        size_t length = 0;
        ls2d_last_error(text, sizeof text, &length);
        fprintf(stderr, "error %" PRId32 ": %.*s\n", status, (int)(length < sizeof text ? length : sizeof text),
                (const char *)text);
        exit(1);
    }
}

static void check_sdl(int is_right) {
    if (!is_right) {
        fprintf(stderr, "SDL: %s\n", SDL_GetError());
        exit(1);
    }
}

/* ---- The world: only integers ---- */

static void add(ls2d_handle commands, uint32_t body_kind, ls2d_fx x, ls2d_fx y, const ls2d_shape_def *shape) {
    ls2d_body_def def;
    check(ls2d_body_def_init(body_kind, &def));
    def.position.x = x;
    def.position.y = y;
    check(ls2d_spawn(commands, &def, shape, 1, NULL));
}

static ls2d_shape_def rectangle(ls2d_fx half_width, ls2d_fx half_height) {
    ls2d_shape_def shape;
    check(ls2d_shape_def_init(LS2D_RECTANGLE, &shape));
    shape.points[0].x = half_width;
    shape.points[0].y = half_height;
    return shape;
}

static ls2d_shape_def ball(ls2d_fx radius) {
    ls2d_shape_def shape;
    check(ls2d_shape_def_init(LS2D_CIRCLE, &shape));
    shape.radius = radius;
    return shape;
}

static ls2d_shape_def capsule(void) {
    ls2d_shape_def shape;
    check(ls2d_shape_def_init(LS2D_CAPSULE, &shape));
    shape.points[0].x = LS2D_FX_RATIO(-1, 3);
    shape.points[1].x = LS2D_FX_RATIO(1, 3);
    shape.radius = LS2D_FX_RATIO(1, 4);
    return shape;
}

static ls2d_shape_def triangle(void) {
    ls2d_shape_def shape;
    check(ls2d_shape_def_init(LS2D_POLYGON, &shape));
    shape.count = 3;
    shape.points[0].x = LS2D_FX_RATIO(-1, 2);
    shape.points[0].y = LS2D_FX_RATIO(-1, 3);
    shape.points[1].x = LS2D_FX_RATIO(1, 2);
    shape.points[1].y = LS2D_FX_RATIO(-1, 3);
    shape.points[2].y = LS2D_FX_RATIO(2, 3);
    return shape;
}

/* Body 0 is the floor, body 3 the player's ball. */
static void build(ls2d_handle commands) {
    const ls2d_shape_def floor = rectangle(LS2D_FX(12), LS2D_FX_RATIO(1, 2));
    const ls2d_shape_def wall = rectangle(LS2D_FX_RATIO(1, 2), LS2D_FX(10));
    const ls2d_shape_def shapes[4] = {rectangle(LS2D_FX_RATIO(2, 5), LS2D_FX_RATIO(2, 5)),
                                      ball(LS2D_FX_RATIO(2, 5)), capsule(), triangle()};
    const ls2d_shape_def player = ball(LS2D_FX_RATIO(3, 5));
    int row, column;
    add(commands, LS2D_FIXED, 0, LS2D_FX_RATIO(-1, 2), &floor);
    add(commands, LS2D_FIXED, LS2D_FX_RATIO(-23, 2), LS2D_FX(10), &wall);
    add(commands, LS2D_FIXED, LS2D_FX_RATIO(23, 2), LS2D_FX(10), &wall);
    add(commands, LS2D_DYNAMIC, LS2D_FX(-9), LS2D_FX(2), &player);
    for (row = 0; row < 9; row++) {
        for (column = 0; column < 12; column++) {
            const ls2d_fx x = LS2D_FX_RATIO(6 * column - 33 + row % 2, 5);
            add(commands, LS2D_DYNAMIC, x, LS2D_FX_RATIO(8 + 6 * row, 5), &shapes[(row + column) % 4]);
        }
    }
}

/* Adds the commands of a tick: a force for held arrow keys, and an explosion for a click. */
static void play(ls2d_handle commands, ls2d_handle world, ls2d_body player, const uint8_t *keys,
                 const SDL_Point *click) {
    const int x = keys[SDL_SCANCODE_RIGHT] - keys[SDL_SCANCODE_LEFT];
    const int y = keys[SDL_SCANCODE_UP] - keys[SDL_SCANCODE_DOWN];
    if (x != 0 || y != 0) {
        ls2d_body_info info;
        check(ls2d_body_get(world, player, &info));
        check(ls2d_apply_force(commands, player, LS2D_FX(25 * x), LS2D_FX(25 * y), info.position.x, info.position.y));
    }
    if (click != NULL) {
        /* The position is a fraction of two integers and involves no floats, so the command is the same everywhere. */
        const ls2d_fx at_x = LS2D_FX_RATIO(click->x - WIDTH / 2, PIXELS_PER_METRE);
        const ls2d_fx at_y = LS2D_FX_RATIO(HEIGHT - PIXELS_PER_METRE - click->y, PIXELS_PER_METRE);
        ls2d_explosion explosion;
        check(ls2d_explosion_init(at_x, at_y, LS2D_FX(6), &explosion));
        explosion.radius = LS2D_FX(2);
        explosion.falloff = LS2D_FX(1);
        check(ls2d_explode(commands, &explosion));
    }
}

/* ---- Drawing: floats, which never enter the world ---- */

/* Writes the corners of a shape, in metres relative to its centre. Returns their number, 0 for a shape without area. */
static int outline(const ls2d_shape_def *shape, SDL_FPoint *corners) {
    const double pi = 3.14159265358979, radius = (double)shape->radius / METRE;
    int i, count = 0;
    switch (shape->kind) {
    case LS2D_CIRCLE:
    case LS2D_CAPSULE: {
        const double ax = (double)shape->points[0].x / METRE, ay = (double)shape->points[0].y / METRE;
        const double bx = shape->kind == LS2D_CAPSULE ? (double)shape->points[1].x / METRE : ax;
        const double by = shape->kind == LS2D_CAPSULE ? (double)shape->points[1].y / METRE : ay;
        const double way = atan2(by - ay, bx - ax);
        for (i = 0; i < 32; i++) {
            const double angle = way + pi * (i + 0.5) / 16 - pi / 2;
            corners[count].x = (float)((i < 16 ? bx : ax) + radius * cos(angle));
            corners[count++].y = (float)((i < 16 ? by : ay) + radius * sin(angle));
        }
        return count;
    }
    case LS2D_POLYGON:
        for (i = 0; i < (int)shape->count; i++) {
            corners[count].x = (float)((double)shape->points[i].x / METRE);
            corners[count++].y = (float)((double)shape->points[i].y / METRE);
        }
        return count;
    default:
        return 0;
    }
}

static void draw_shape(SDL_Renderer *renderer, const ls2d_shape_def *shape, const double *pose, SDL_Color colour) {
    SDL_FPoint corners[CORNERS_MAX];
    SDL_Vertex vertices[CORNERS_MAX];
    int indices[3 * CORNERS_MAX];
    const double cosine = cos(pose[3]), sine = sin(pose[3]);
    const int count = outline(shape, corners);
    int i;
    if (count < 3) {
        return;
    }
    memset(vertices, 0, sizeof vertices);
    for (i = 0; i < count; i++) {
        const double x = corners[i].x + (double)shape->offset.x / METRE;
        const double y = corners[i].y + (double)shape->offset.y / METRE;
        const double in_world[2] = {pose[1] + cosine * x - sine * y, pose[2] + sine * x + cosine * y};
        vertices[i].position.x = (float)(WIDTH / 2 + PIXELS_PER_METRE * in_world[0]);
        vertices[i].position.y = (float)(HEIGHT - PIXELS_PER_METRE - PIXELS_PER_METRE * in_world[1]);
        vertices[i].color = colour;
        indices[3 * i] = 0;
        indices[3 * i + 1] = i;
        indices[3 * i + 2] = (i + 1) % count;
    }
    check_sdl(SDL_RenderGeometry(renderer, NULL, vertices, count, indices, 3 * count) == 0);
}

static void draw(SDL_Renderer *renderer, ls2d_handle world) {
    static double poses[5 * BODIES_MAX];
    const SDL_Color fixed = {90, 96, 104, 255}, player = {40, 44, 52, 255}, asleep = {150, 170, 190, 255};
    const SDL_Color awake[4] = {{224, 122, 95, 255}, {129, 178, 154, 255}, {242, 204, 143, 255}, {98, 129, 201, 255}};
    size_t count, body;
    check_sdl(SDL_SetRenderDrawColor(renderer, 244, 241, 236, 255) == 0);
    check_sdl(SDL_RenderClear(renderer) == 0);
    check(ls2d_draw_poses(world, poses, sizeof poses / sizeof poses[0], &count));
    for (body = 0; body < count / 5; body++) {
        const double *pose = &poses[5 * body];
        ls2d_shape shapes[1];
        ls2d_shape_def shape;
        size_t shape_count;
        SDL_Color colour = awake[body % 4];
        check(ls2d_body_shapes(world, (ls2d_body)pose[0], shapes, 1, &shape_count));
        check(ls2d_shape_get(world, shapes[0], &shape, NULL));
        if (body < 3) {
            colour = fixed;
        } else if (body == 3) {
            colour = player;
        } else if (pose[4] == 0) {
            colour = asleep;
        }
        draw_shape(renderer, &shape, pose, colour);
    }
    SDL_RenderPresent(renderer);
}

static void save_screenshot(SDL_Renderer *renderer, const char *path) {
    SDL_Surface *picture = SDL_CreateRGBSurfaceWithFormat(0, WIDTH, HEIGHT, 32, SDL_PIXELFORMAT_ARGB8888);
    check_sdl(picture != NULL);
    check_sdl(SDL_RenderReadPixels(renderer, NULL, picture->format->format, picture->pixels, picture->pitch) == 0);
    check_sdl(SDL_SaveBMP(picture, path) == 0);
    SDL_FreeSurface(picture);
}

static void save_replay(ls2d_handle recording, const char *path) {
    ls2d_handle bytes;
    size_t size;
    uint8_t *buffer;
    FILE *file = fopen(path, "wb");
    check(ls2d_recording_finish(recording, &bytes));
    check(ls2d_bytes_size(bytes, &size));
    buffer = malloc(size);
    if (file == NULL || buffer == NULL) {
        perror(path);
        exit(1);
    }
    check(ls2d_bytes_copy(bytes, buffer, size));
    if (fwrite(buffer, 1, size, file) != size || fclose(file) != 0) {
        perror(path);
        exit(1);
    }
    free(buffer);
    check(ls2d_free(bytes));
}

int main(int argc, char **argv) {
    const char *replay = "pit.replay", *screenshot = NULL;
    uint64_t ticks_max = UINT64_MAX, ticks = 0, skipped = 0;
    ls2d_handle commands, recording, world;
    ls2d_body bodies[BODIES_MAX];
    size_t count;
    SDL_Window *window;
    SDL_Renderer *renderer;
    /* Position of a click. It is kept until the next tick, because some iterations of the loop play no tick. */
    SDL_Point click;
    int i, is_click = 0, is_over = 0;

    for (i = 1; i + 1 < argc; i += 2) {
        if (strcmp(argv[i], "--replay") == 0) {
            replay = argv[i + 1];
        } else if (strcmp(argv[i], "--ticks") == 0) {
            ticks_max = strtoull(argv[i + 1], NULL, 10);
        } else if (strcmp(argv[i], "--screenshot") == 0) {
            screenshot = argv[i + 1];
        } else {
            break;
        }
    }
    if (i != argc) {
        fprintf(stderr, "usage: pit [--replay FILE] [--ticks N] [--screenshot FILE.bmp]\n");
        return 2;
    }
    check_sdl(SDL_Init(SDL_INIT_VIDEO) == 0);
    window = SDL_CreateWindow("lockstep2d", SDL_WINDOWPOS_CENTERED, SDL_WINDOWPOS_CENTERED, WIDTH, HEIGHT, 0);
    check_sdl(window != NULL);
    renderer = SDL_CreateRenderer(window, -1, 0);
    check_sdl(renderer != NULL);

    check(ls2d_commands_new(&commands));
    build(commands);
    check(ls2d_recording_new(NULL, commands, 60, &recording));
    check(ls2d_commands_clear(commands));
    check(ls2d_recording_world(recording, &world));
    check(ls2d_world_bodies(world, bodies, BODIES_MAX, &count));

    while (!is_over && ticks < ticks_max) {
        SDL_Event event;
        while (SDL_PollEvent(&event)) {
            if (event.type == SDL_QUIT || (event.type == SDL_KEYDOWN && event.key.keysym.sym == SDLK_ESCAPE)) {
                is_over = 1;
            } else if (event.type == SDL_MOUSEBUTTONDOWN) {
                click.x = event.button.x;
                click.y = event.button.y;
                is_click = 1;
            }
        }
        if (ticks_max == UINT64_MAX) {
            /* Plays 60 ticks a second. If more than six ticks are due, for example after a pause, skips them. */
            const uint64_t due = SDL_GetTicks64() * 60 / 1000 - skipped;
            if (due > ticks + 6) {
                skipped += due - ticks;
            } else if (due <= ticks) {
                SDL_Delay(1);
                continue;
            }
        }
        play(commands, world, bodies[3], SDL_GetKeyboardState(NULL), is_click ? &click : NULL);
        is_click = 0;
        check(ls2d_recording_step(recording, commands));
        ticks++;
        check(ls2d_free(world));
        check(ls2d_recording_world(recording, &world));
        draw(renderer, world);
    }

    printf("%" PRIu64 " ticks\n", ticks);
    if (screenshot != NULL) {
        draw(renderer, world);
        save_screenshot(renderer, screenshot);
    }
    save_replay(recording, replay);
    check(ls2d_free(world));
    check(ls2d_free(recording));
    check(ls2d_free(commands));
    SDL_DestroyRenderer(renderer);
    SDL_DestroyWindow(window);
    SDL_Quit();
    return 0;
}
