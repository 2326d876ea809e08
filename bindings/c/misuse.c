/* Misuses the API: wrong handles, null pointers, short buffers, wrong sizes, objects used by several threads. Calls
 * have to return the expected codes. bindings/c/test runs this program under AddressSanitizer and valgrind. */
#include <pthread.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "lockstep2d.h"

#define EXPECT(call, status) expect(#call, (call), (status))

static void expect(const char *call, ls2d_status found, ls2d_status expected) {
    if (found != expected) {
        fprintf(stderr, "%s: %d, expected %d\n", call, (int)found, (int)expected);
        exit(1);
    }
}

static void handles(void) {
    ls2d_handle world, other, snapshot, bytes;
    ls2d_hash hash;
    uint64_t tick;
    EXPECT(ls2d_world_step(0), LS2D_HANDLE);
    EXPECT(ls2d_world_step(UINT32_MAX), LS2D_HANDLE);
    EXPECT(ls2d_free(12345), LS2D_HANDLE);
    EXPECT(ls2d_world_new(NULL, &world), LS2D_OK);
    EXPECT(ls2d_world_save(world, &snapshot), LS2D_OK);
    EXPECT(ls2d_world_step(snapshot), LS2D_HANDLE_KIND);
    EXPECT(ls2d_world_restore(world, world), LS2D_HANDLE_KIND);
    EXPECT(ls2d_world_restore(snapshot, world), LS2D_HANDLE_KIND);
    EXPECT(ls2d_free(world), LS2D_OK);
    EXPECT(ls2d_free(world), LS2D_HANDLE);
    EXPECT(ls2d_world_hash(world, &hash), LS2D_HANDLE);
    EXPECT(ls2d_world_restore(world, snapshot), LS2D_HANDLE);
    EXPECT(ls2d_world_new(NULL, &other), LS2D_OK);
    EXPECT(ls2d_world_tick(world, &tick), LS2D_HANDLE);
    EXPECT(ls2d_world_encode(other, &bytes), LS2D_OK);
    EXPECT(ls2d_free(bytes), LS2D_OK);
    EXPECT(ls2d_bytes_copy(bytes, NULL, 0), LS2D_HANDLE);
    EXPECT(ls2d_free(snapshot), LS2D_OK);
    EXPECT(ls2d_free(other), LS2D_OK);
}

static void buffers(ls2d_handle world) {
    ls2d_body bodies[2];
    ls2d_handle bytes, copy;
    size_t count, size;
    uint8_t *data;
    EXPECT(ls2d_world_new(NULL, NULL), LS2D_NULL);
    EXPECT(ls2d_world_bodies(world, NULL, 0, &count), LS2D_BUFFER);
    EXPECT(ls2d_world_bodies(world, bodies, 1, &count), LS2D_BUFFER);
    EXPECT(ls2d_world_bodies(world, bodies, 2, NULL), LS2D_NULL);
    EXPECT(ls2d_world_bodies(world, NULL, 2, &count), LS2D_NULL);
    EXPECT(ls2d_world_bodies(world, bodies, 2, &count), LS2D_OK);
    EXPECT(ls2d_world_bodies(world, (ls2d_body *)((char *)bodies + 1), 2, &count), LS2D_MISALIGNED);
    EXPECT(ls2d_world_encode(world, &bytes), LS2D_OK);
    EXPECT(ls2d_bytes_size(bytes, &size), LS2D_OK);
    data = malloc(size);
    EXPECT(ls2d_bytes_copy(bytes, data, size - 1), LS2D_BUFFER);
    EXPECT(ls2d_bytes_copy(bytes, data, size), LS2D_OK);
    EXPECT(ls2d_world_decode(data, size, &copy), LS2D_OK);
    EXPECT(ls2d_free(copy), LS2D_OK);
    data[size / 2] ^= 1;
    EXPECT(ls2d_world_decode(data, size, &copy), LS2D_SNAPSHOT);
    EXPECT(ls2d_world_decode(data, size / 2, &copy), LS2D_SNAPSHOT);
    EXPECT(ls2d_world_decode(NULL, size, &copy), LS2D_NULL);
    EXPECT(ls2d_world_decode(data, SIZE_MAX, &copy), LS2D_VALUE);
    EXPECT(ls2d_free(bytes), LS2D_OK);
    free(data);
}

static void definitions(ls2d_handle world) {
    ls2d_body_def body;
    ls2d_shape_def shape;
    ls2d_joint_def joint;
    ls2d_body id;
    EXPECT(ls2d_body_def_init(7, &body), LS2D_VALUE);
    EXPECT(ls2d_body_def_init(LS2D_DYNAMIC, &body), LS2D_OK);
    body.size--;
    EXPECT(ls2d_spawn(world, &body, NULL, 0, &id), LS2D_SIZE);
    body.size++;
    EXPECT(ls2d_spawn(world, &body, NULL, 1, &id), LS2D_NULL);
    EXPECT(ls2d_shape_def_init(LS2D_POLYGON, &shape), LS2D_OK);
    shape.count = 9;
    EXPECT(ls2d_spawn(world, &body, &shape, 1, &id), LS2D_GEOMETRY);
    shape.count = 3;
    EXPECT(ls2d_spawn(world, &body, &shape, 1, &id), LS2D_GEOMETRY);
    shape.kind = 99;
    EXPECT(ls2d_spawn(world, &body, &shape, 1, &id), LS2D_VALUE);
    shape.kind = LS2D_CIRCLE;
    shape.radius = LS2D_FX(1);
    shape.flags |= 1u << 30;
    EXPECT(ls2d_spawn(world, &body, &shape, 1, &id), LS2D_VALUE);
    memset(body.name, 'x', sizeof body.name);
    EXPECT(ls2d_spawn(world, &body, NULL, 0, NULL), LS2D_OK);
    body.name[0] = ' ';
    EXPECT(ls2d_spawn(world, &body, NULL, 0, NULL), LS2D_NAME);
    EXPECT(ls2d_joint_def_init(LS2D_WELD, &joint), LS2D_OK);
    joint.flags |= LS2D_JOINT_LIMIT;
    EXPECT(ls2d_add_joint(world, &joint, NULL), LS2D_VALUE);
    joint.flags = 0;
    EXPECT(ls2d_add_joint(world, &joint, NULL), LS2D_STALE_BODY);
    joint.body_a = joint.body_b = 0;
    EXPECT(ls2d_add_joint(world, &joint, NULL), LS2D_JOINT_TO_ITSELF);
    joint.body_b = LS2D_NO_ID;
    EXPECT(ls2d_add_joint(world, &joint, NULL), LS2D_STALE_BODY);
    EXPECT(ls2d_despawn(world, LS2D_NO_ID), LS2D_STALE_BODY);
    EXPECT(ls2d_despawn(world, 99), LS2D_STALE_BODY);
}

/* An edit whose result cannot be written changes nothing. */
static void results(ls2d_handle world, const ls2d_body_def *body) {
    uint64_t memory[2] = {0, 0};
    char *odd = (char *)memory + 1;
    ls2d_handle list;
    ls2d_shape_def shape;
    ls2d_joint_def joint;
    ls2d_hash before, after;
    EXPECT(ls2d_commands_new(&list), LS2D_OK);
    EXPECT(ls2d_spawn(list, body, NULL, 0, NULL), LS2D_OK);
    EXPECT(ls2d_shape_def_init(LS2D_CIRCLE, &shape), LS2D_OK);
    shape.radius = LS2D_FX(1);
    EXPECT(ls2d_joint_def_init(LS2D_WELD, &joint), LS2D_OK);
    joint.body_a = 0;
    joint.body_b = 1;
    EXPECT(ls2d_world_hash(world, &before), LS2D_OK);
    EXPECT(ls2d_spawn(world, body, NULL, 0, (ls2d_body *)odd), LS2D_MISALIGNED);
    EXPECT(ls2d_add_shape(world, 0, &shape, (ls2d_shape *)odd), LS2D_MISALIGNED);
    EXPECT(ls2d_add_joint(world, &joint, (ls2d_joint *)odd), LS2D_MISALIGNED);
    EXPECT(ls2d_world_execute(world, list, (uint32_t *)odd), LS2D_MISALIGNED);
    EXPECT(ls2d_world_hash(world, &after), LS2D_OK);
    if (memcmp(&before, &after, sizeof before) != 0) {
        fprintf(stderr, "an edit that was refused has changed the world\n");
        exit(1);
    }
    EXPECT(ls2d_free(list), LS2D_OK);
    EXPECT(ls2d_set_name(world, 0, (const uint8_t *)"ab\0cd", 5), LS2D_NAME);
}

static void *thread(void *argument) {
    ls2d_handle shared = *(ls2d_handle *)argument, own;
    int i;
    for (i = 0; i < 50; i++) {
        ls2d_status status = ls2d_world_step(shared);
        if (status != LS2D_OK && status != LS2D_HANDLE) {
            exit(1);
        }
        EXPECT(ls2d_world_new(NULL, &own), LS2D_OK);
        EXPECT(ls2d_world_steps(own, 3), LS2D_OK);
        EXPECT(ls2d_free(own), LS2D_OK);
    }
    return NULL;
}

int main(void) {
    ls2d_handle world;
    ls2d_body_def body;
    pthread_t threads[4];
    int i;
    handles();
    EXPECT(ls2d_world_new(NULL, &world), LS2D_OK);
    EXPECT(ls2d_body_def_init(LS2D_FIXED, &body), LS2D_OK);
    EXPECT(ls2d_spawn(world, &body, NULL, 0, NULL), LS2D_OK);
    EXPECT(ls2d_spawn(world, &body, NULL, 0, NULL), LS2D_OK);
    buffers(world);
    results(world, &body);
    definitions(world);
    for (i = 0; i < 4; i++) {
        pthread_create(&threads[i], NULL, thread, &world);
    }
    EXPECT(ls2d_free(world), LS2D_OK);
    for (i = 0; i < 4; i++) {
        pthread_join(threads[i], NULL);
    }
    if (ls2d_object_count() != 0) {
        fprintf(stderr, "%zu objects are left\n", ls2d_object_count());
        return 1;
    }
    puts("every misuse returns the expected code");
    return 0;
}
