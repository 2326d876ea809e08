/* The flat API of lockstep2d: a deterministic fixed-point 2D physics and lockstep engine.
 *
 * Written by the tests of lockstep2d-flat; do not edit it.
 *
 * Most functions return a status: LS2D_OK, LS2D_NONE if there is nothing to return, or an error, whose text
 * ls2d_last_error copies. Objects are referred to by handles, numbers that are never 0. A wrong or stale handle is an
 * error, never undefined behaviour. ls2d_free frees objects of all kinds.
 *
 * A pointer has to be null or to point to as many items as the function reads or writes. Nothing else may use that
 * memory during the call. Functions that fill a buffer take its capacity in items. If the buffer is too short, such a
 * function returns LS2D_BUFFER, and writes the number of items needed if it has a pointer for this number. There are
 * two exceptions: ls2d_last_error cuts the text, and ls2d_match_next_packet writes the size of the packet only if the
 * buffer for the address is long enough.
 *
 * Structs with an ls2d_*_init function, except ls2d_rng, begin with their size. The init function sets the size and the
 * defaults.
 *
 * Numbers are integers: ls2d_fx has 32 fraction bits, so that a length of LS2D_FX(1) is one metre. ls2d_angle is in
 * units of 2^-32 turn. Several threads may use different objects at the same time. */
#ifndef LOCKSTEP2D_H
#define LOCKSTEP2D_H

#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

/* Result of a function: one of the LS2D_ codes below. */
typedef int32_t ls2d_status;
/* Handle of an object. */
typedef uint32_t ls2d_handle;

/* LS2D_FX converts a whole number to ls2d_fx. LS2D_FX_RATIO is the quotient of two whole numbers, rounded towards zero.
 * The quotient has to be less than 2^31, and the denominator at most 2^31; the macro uses its arguments several times.
 * With `| 0`, a float does not compile; without it, the conversion to int64_t would truncate the float silently. The
 * arguments are converted before the division, because a division by an unsigned number would be unsigned. */
#define LS2D_WHOLE(whole) ((int64_t)((whole) | 0))
#define LS2D_FX(whole) ((ls2d_fx)(LS2D_WHOLE(whole) * 4294967296))
#define LS2D_QUOTIENT(n, d) ((ls2d_fx)(LS2D_FX((n) / (d)) + LS2D_FX((n) % (d)) / (d)))
#define LS2D_FX_RATIO(numerator, denominator) LS2D_QUOTIENT(LS2D_WHOLE(numerator), LS2D_WHOLE(denominator))
/* An angle of whole degrees, rounded towards zero. */
#define LS2D_DEGREES(whole) ((ls2d_angle)LS2D_FX_RATIO(whole, 360))
/* An ls2d_body, ls2d_shape or ls2d_joint that refers to nothing. */
#define LS2D_NO_ID UINT64_MAX
/* Version of this header, to be compared with ls2d_api_version(). */
#define LS2D_API_VERSION 1

/* The function has succeeded. */
#define LS2D_OK 0
/* There is nothing to return, which is not an error. */
#define LS2D_NONE 1
/* A pointer that must not be null is null. */
#define LS2D_NULL 2
/* A pointer is not aligned for its type. */
#define LS2D_MISALIGNED 3
/* No object has the handle: the object was freed, or never existed. */
#define LS2D_HANDLE 4
/* The handle belongs to an object of another kind. */
#define LS2D_HANDLE_KIND 5
/* The `size` of a struct does not match this version of the library. */
#define LS2D_SIZE 6
/* An argument is out of its range, or the call is not possible at this time. */
#define LS2D_VALUE 7
/* The buffer is too short. If the function has a pointer for the number of items, it has written the number
 * needed. */
#define LS2D_BUFFER 8
/* A text is invalid, for example not UTF-8. */
#define LS2D_TEXT 9
/* The result is undefined, as for a division by zero or the root of a negative number. */
#define LS2D_NUMBER 10
/* An internal error in the library. The objects that were passed to the call are unusable. */
#define LS2D_INTERNAL 11
/* An earlier `LS2D_INTERNAL` has left the object unusable. The object can still be freed. */
#define LS2D_BROKEN 12
/* There are already 2^20 objects, or the process has used all of about 4 290 000 000 handles. To save a world
 * without a new handle, use `ls2d_world_save_into`. */
#define LS2D_EXHAUSTED 13
/* The bytes are not a valid encoding of the expected value. */
#define LS2D_DECODE 14
/* Geometry is not valid. */
#define LS2D_GEOMETRY 20
/* The body is not in the world. */
#define LS2D_STALE_BODY 21
/* The shape is not in the world. */
#define LS2D_STALE_SHAPE 22
/* The joint is not in the world. */
#define LS2D_STALE_JOINT 23
/* A position is out of range. */
#define LS2D_POSITION 24
/* A shape or an anchor is too far from the origin of its body. */
#define LS2D_OFFSET 25
/* A speed is out of range. */
#define LS2D_SPEED 26
/* A density is out of range. */
#define LS2D_DENSITY 27
/* A property of a material is out of range. */
#define LS2D_MATERIAL 28
/* A mass is out of range. */
#define LS2D_MASS 29
/* A radius of gyration is out of range. */
#define LS2D_GYRATION 30
/* A damping rate is out of range. */
#define LS2D_DAMPING 31
/* A gravity scale is out of range. */
#define LS2D_GRAVITY_SCALE 32
/* A property of an area is out of range, or the shape cannot be an area. */
#define LS2D_AREA 33
/* A joint connects a body to itself. */
#define LS2D_JOINT_TO_ITSELF 34
/* The bodies of a joint cannot be changed. */
#define LS2D_JOINT_BODIES 35
/* The joint does not have the part to change, such as a motor. */
#define LS2D_JOINT_PART 36
/* A property of a joint is out of range, or its limits are reversed. */
#define LS2D_JOINT 37
/* A setting of the world or a property of an explosion is out of range. */
#define LS2D_SETTING 38
/* A limit of the world, such as `body_limit`, cannot be changed. */
#define LS2D_FIXED_SETTING 39
/* A name is not 1 to 16 ASCII letters, digits, `-` and `_`. */
#define LS2D_NAME 40
/* The world would have too many bodies, shapes or joints, or a body too many shapes. */
#define LS2D_FULL 41
/* The kind of the body does not allow the change. */
#define LS2D_WRONG_KIND 42
/* The bytes are not an encoded world of this version of the library. */
#define LS2D_SNAPSHOT 50
/* A replay cannot be recorded, opened or played further. */
#define LS2D_RECORD 51
/* A parameter of a match is out of its range. */
#define LS2D_CONFIG 60
/* The inputs do not have the expected number of bytes, or the input of an absent player does not consist of zeros. */
#define LS2D_INPUTS 61
/* This peer does not take part in the match yet. */
#define LS2D_NOT_IN_MATCH 62

/* A fixed-point number in units of 2^-32: the integer 4294967296 stands for 1. */
typedef int64_t ls2d_fx;
/* An angle in units of 2^-32 turn, counter-clockwise: a quarter turn is 1073741824. */
typedef uint32_t ls2d_angle;
/* Handle of a body of a world. It is valid until the body is despawned, or until a rollback to a state from before
 * the spawn of the body. After such a rollback, another body may get the same handle, so a table of sprites should
 * also compare `user_data`. The lowest 21 bits are the slot. The other bits are the generation, which counts the
 * earlier bodies in that slot: the first bodies have the handles 0, 1, 2 and so on. Handles of bodies are less
 * than 2^53, so that a JavaScript number holds them exactly. Only `LS2D_NO_ID`, which refers to nothing, is
 * larger. */
typedef uint64_t ls2d_body;
/* Handle of a shape of a world, encoded like `ls2d_body`. */
typedef uint64_t ls2d_shape;
/* Handle of a joint of a world, encoded like `ls2d_body`. */
typedef uint64_t ls2d_joint;

/* Kind of a body: does not move. */
#define LS2D_FIXED 0
/* Kind of a body: moves at its velocity, which forces and contacts do not change. */
#define LS2D_KINEMATIC 1
/* Kind of a body: moved by forces, contacts and joints. */
#define LS2D_DYNAMIC 2
/* Flag of a body: takes part in the simulation. */
#define LS2D_BODY_ENABLED 1
/* Flag of a body: asleep. */
#define LS2D_BODY_ASLEEP 2
/* Flag of a body: does not move along the x axis of the world. */
#define LS2D_BODY_LOCK_X 4
/* Flag of a body: does not move along the y axis of the world. */
#define LS2D_BODY_LOCK_Y 8
/* Flag of a body: does not turn. */
#define LS2D_BODY_LOCK_ROTATION 16
/* Flag of a body: may fall asleep. */
#define LS2D_BODY_MAY_SLEEP 32
/* Flag of a body: the fields `mass`, `mass_centre` and `mass_gyration` give its mass. Without this flag, its mass
 * is computed from its shapes. */
#define LS2D_BODY_GIVEN_MASS 64
/* `ls2d_body_def.continuous`: no continuous collision detection. */
#define LS2D_SWEEP_OFF 0
/* `ls2d_body_def.continuous`: the body is swept against fixed bodies. */
#define LS2D_SWEEP_FIXED 1
/* `ls2d_body_def.continuous`: the body is swept against all bodies except bullets. */
#define LS2D_SWEEP_BULLET 2
/* `ls2d_body_def.continuous`: the body is swept against fixed and kinematic bodies. */
#define LS2D_SWEEP_KINEMATIC 3
/* `ls2d_mover_state.flags`: the character stands on ground. */
#define LS2D_MOVER_ON_GROUND 1
/* `ls2d_mover_state.flags`, in results: the character is wedged between two slopes that are too steep to stand on. */
#define LS2D_MOVER_WEDGED 2
/* `ls2d_mover_state.flags`: the last move has brought the character from the air onto ground. */
#define LS2D_MOVER_LANDED 4
/* `ls2d_config.flags`: bodies at rest fall asleep. */
#define LS2D_SLEEPING 1
/* `ls2d_config.flags`: fast bodies are swept so that they do not pass through shapes. */
#define LS2D_CONTINUOUS 2
/* `ls2d_config.contact`: contacts are soft springs. */
#define LS2D_CONTACT_SOFT 0
/* `ls2d_config.contact`: contacts correct a share of the overlap in each sub-step. */
#define LS2D_CONTACT_BAUMGARTE 1
/* Kind of a joint: a hinge. */
#define LS2D_REVOLUTE 0
/* Kind of a joint: B slides along the x axis of the joint's frame on A, and does not turn. */
#define LS2D_PRISMATIC 1
/* Kind of a joint: a rod, a rope or a spring between the anchors. */
#define LS2D_DISTANCE 2
/* Kind of a joint: B keeps its pose relative to A, rigidly or by springs. */
#define LS2D_WELD 3
/* Kind of a joint: B slides along the x axis of the joint's frame on A, and turns. */
#define LS2D_WHEEL 4
/* Kind of a joint: B is driven relative to A with limited force. */
#define LS2D_MOTOR 5
/* Kind of a joint: only keeps the bodies from colliding with each other. */
#define LS2D_FILTER 6
/* Kind of a joint: the wheels about the anchors turn in a fixed ratio, as gears. */
#define LS2D_GEAR 7
/* Kind of a joint: the wheel about A's anchor rolls along the x axis of the joint's frame on B. */
#define LS2D_RACK 8
/* Kind of a joint: a rope over two wheels that are fixed in the world. */
#define LS2D_PULLEY 9
/* Flag of a joint: its bodies collide with each other. */
#define LS2D_JOINT_COLLIDE 1
/* Flag of a joint: enabled. */
#define LS2D_JOINT_ENABLED 2
/* Flag of a joint: has `limit_lower` and `limit_upper` (revolute, prismatic, distance, wheel). */
#define LS2D_JOINT_LIMIT 4
/* Flag of a joint: has `motor_speed` and `motor_max` (revolute, prismatic, distance, wheel, and for the angle of a
 * motor joint). */
#define LS2D_JOINT_MOTOR 8
/* Flag of a joint: has `spring_hertz`, `spring_damping_ratio`, `spring_target` (revolute, prismatic, distance,
 * wheel). */
#define LS2D_JOINT_SPRING 16
/* Flag of a joint: has `spring_force_lower` and `spring_force_upper` (distance). */
#define LS2D_JOINT_SPRING_FORCE 32
/* Flag of a joint: holds `length` rigidly (distance). */
#define LS2D_JOINT_ROD 64
/* Flag of a joint: has its own `hertz` and `damping_ratio`. */
#define LS2D_JOINT_SOFTNESS 128
/* Flag of a joint: has `threshold_force`. */
#define LS2D_JOINT_THRESHOLD_FORCE 256
/* Flag of a joint: has `threshold_torque`. */
#define LS2D_JOINT_THRESHOLD_TORQUE 512
/* Flag of a joint: breaks beyond a threshold. */
#define LS2D_JOINT_BREAKS 1024
/* Flag of a joint: has `linear_velocity` and `linear_motor_max` (motor). */
#define LS2D_JOINT_LINEAR_MOTOR 2048
/* Flag of a joint: has `linear_hertz`, `linear_damping_ratio` and, for a motor, `linear_max` (weld, motor). */
#define LS2D_JOINT_LINEAR_SPRING 4096
/* Flag of a joint: has `angular_hertz`, `angular_damping_ratio` and, for a motor, `angular_max` (weld, motor). */
#define LS2D_JOINT_ANGULAR_SPRING 8192
/* Verdict: setup and inputs reproduce every checkpoint and the trailer. */
#define LS2D_MATCH 0
/* Verdict: a claim or the final hash in the trailer differs from the simulation. */
#define LS2D_CLAIM_MISMATCH 1
/* Verdict: the simulation diverges from the checkpoints. */
#define LS2D_DIVERGED 2
/* Verdict: the file ends before its trailer. */
#define LS2D_INCOMPLETE 3
/* Verdict: the bytes are not a valid replay file. */
#define LS2D_MALFORMED 4
/* Verdict: the file exceeds one of the limits. */
#define LS2D_LIMIT_EXCEEDED 5
/* Verdict: the file was recorded with another version of the engine, or with other rules. */
#define LS2D_UNVERIFIABLE 6
/* Request: keep a copy of the state before `tick`. The copy replaces an older copy for the same tick. */
#define LS2D_REQUEST_SAVE 0
/* Request: restore the copy of the state before `tick`. In a match, copies for later ticks are no longer needed. */
#define LS2D_REQUEST_LOAD 1
/* Request: simulate `tick` with the inputs that come with this request. */
#define LS2D_REQUEST_ADVANCE 2
/* Request: pass the hash of the copy of the state before `tick` to `ls2d_match_report_hash`, or, in a replay, the
 * hash of the current state to `ls2d_replay_check`. */
#define LS2D_REQUEST_CHECKSUM 3
/* Request: copies for ticks below `tick` are no longer needed. */
#define LS2D_REQUEST_FORGET 4
/* Event: the status is `value`, an `LS2D_MATCH_` constant. For `LS2D_MATCH_FINISHED`, `tick` is the number of
 * ticks. */
#define LS2D_EVENT_STATUS 0
/* Event: voters, seats, start or end of the match have changed. `value` is the number of the new view, which each
 * change increases by one. */
#define LS2D_EVENT_VIEW 1
/* Event: `peer` has `seat` from `tick` on. */
#define LS2D_EVENT_SEATED 2
/* Event: `peer` loses `seat` at `tick`. */
#define LS2D_EVENT_UNSEATED 3
/* Event: play stalls, because inputs of `peer` are missing. `value` is 1 if messages of this peer still arrive,
 * directly or through other peers; otherwise 0. */
#define LS2D_EVENT_WAITING 4
/* Event: play continues. */
#define LS2D_EVENT_RESUMED 5
/* Event: `peer` requests a pause (`value` is 1) or withdraws its request (0). */
#define LS2D_EVENT_PAUSE 6
/* Event: the match ends after `tick` ticks. */
#define LS2D_EVENT_END 7
/* Event: after `tick` ticks, the state of `peer` has the hash `theirs`, and the state of this peer the hash
 * `ours`. */
#define LS2D_EVENT_DESYNC 8
/* Event: `peer` has issued two different inputs for `tick`. The input that arrived first counts. */
#define LS2D_EVENT_CONFLICT 9
/* Event: this peer is so far behind that the others may have dropped inputs that it lacks. It has to join again. */
#define LS2D_EVENT_TOO_FAR_BEHIND 10
/* Event: the contact refuses the request to join. `value` is the reason, an `LS2D_REFUSED_` constant. */
#define LS2D_EVENT_REFUSED 11
/* Event: the state after `tick` ticks was downloaded. `value` is the handle of its bytes, which the caller frees.
 * Restore this state before you fulfil the next request. */
#define LS2D_EVENT_STATE 12
/* Event: the downloaded bytes are not a valid state. This peer requests the state again. */
#define LS2D_EVENT_BAD_STATE 13
/* Reason: the offers differ. */
#define LS2D_REFUSED_OFFER 0
/* Reason: too many peers are joining through this contact. */
#define LS2D_REFUSED_FULL 1
/* Reason: another peer already has the `peer` number of this peer. */
#define LS2D_REFUSED_TAKEN 2
/* Reason: the contact is not in a match yet. This peer repeats its request. */
#define LS2D_REFUSED_NOT_READY 3
/* Status: follows the match and requests a seat. */
#define LS2D_MATCH_JOINING 0
/* Status: follows the match. */
#define LS2D_MATCH_WATCHING 1
/* Status: has a seat, or is a dedicated server, in a match that has not begun. */
#define LS2D_MATCH_WAITING 2
/* Status: plays. */
#define LS2D_MATCH_PLAYING 3
/* Status: no messages of a majority of the peers arrive, directly or through other peers. */
#define LS2D_MATCH_PAUSED 4
/* Status: the other peers went on without this peer, which requests its seat again. */
#define LS2D_MATCH_DROPPED 5
/* Status: removed by a vote. */
#define LS2D_MATCH_KICKED 6
/* Status: announces its departure. */
#define LS2D_MATCH_LEAVING 7
/* Status: has left. */
#define LS2D_MATCH_LEFT 8
/* Status: all ticks of the match are final. */
#define LS2D_MATCH_FINISHED 9
/* Status: nothing more is sent. */
#define LS2D_MATCH_CLOSED 10
/* Status: requests to join, or downloads the initial state. */
#define LS2D_MATCH_CONNECTING 11
/* `ls2d_query_filter.flags`: the query sees sensors. */
#define LS2D_QUERY_SENSORS 1
/* `ls2d_query_filter.initial_overlap`: a ray reports shapes that it starts in. A cast reports such a shape only if
 * it would move deeper into the shape. */
#define LS2D_OVERLAP_RESIST 0
/* `ls2d_query_filter.initial_overlap`: rays and casts report shapes that they start in. */
#define LS2D_OVERLAP_REPORT 1
/* `ls2d_query_filter.initial_overlap`: rays and casts do not see shapes that they start in. */
#define LS2D_OVERLAP_IGNORE 2
/* Kind of a shape: a disc with `radius`. */
#define LS2D_CIRCLE 0
/* Kind of a shape: a line from `points[0]` to `points[1]`. */
#define LS2D_SEGMENT 1
/* Kind of a shape: a convex polygon of `count` points, counter-clockwise, rounded by `radius`. */
#define LS2D_POLYGON 2
/* Kind of a shape: all points within `radius` of the line from `points[0]` to `points[1]`. */
#define LS2D_CAPSULE 3
/* Kind of a shape: a link of a chain, made by `ls2d_chain_links`. It is a line from `points[0]` to `points[1]`.
 * The far end of the link before it is `points[2]`, and that of the link after it `points[3]`. */
#define LS2D_LINK 4
/* Kind of a shape: the convex hull of `count` points in any order, rounded by `radius`. */
#define LS2D_HULL 5
/* Kind of a shape: a rectangle of half width `points[0].x` and half height `points[0].y`, rounded by `radius`. */
#define LS2D_RECTANGLE 6
/* Flag of a shape: detects overlaps, and does not collide. */
#define LS2D_SHAPE_SENSOR 1
/* Flag of a shape: other shapes pass through it if they move in the direction `one_way`. */
#define LS2D_SHAPE_ONE_WAY 2
/* Flag of a shape: has its own `restitution_threshold`. */
#define LS2D_SHAPE_RESTITUTION_THRESHOLD 4
/* Flag of a shape: a sensor that acts on bodies in it. */
#define LS2D_SHAPE_AREA 8
/* Flag of a shape: the area attracts bodies to its centre. */
#define LS2D_SHAPE_ATTRACTION 16
/* Flag of a shape: its contacts are reported in contact events. It suffices that one of the two shapes has this
 * flag. */
#define LS2D_SHAPE_CONTACT_EVENTS 32
/* Flag of a shape: its hits are reported in hit events. It suffices that one of the two shapes has this flag. */
#define LS2D_SHAPE_HIT_EVENTS 64
/* Flag of a shape: sensors detect it. */
#define LS2D_SHAPE_SENSOR_EVENTS 128
/* Flag of a shape: a sensor that also detects other sensors. */
#define LS2D_SHAPE_DETECT_SENSORS 256
/* Flag of a link: it has a neighbour before `points[0]`. */
#define LS2D_SHAPE_LINK_BEFORE 512
/* Flag of a link: it has a neighbour after `points[1]`. */
#define LS2D_SHAPE_LINK_AFTER 1024
/* Flag of a link: solid from the right only, looking from `points[0]` to `points[1]`. */
#define LS2D_SHAPE_LINK_ONE_SIDED 2048
/* Rule for mixing the values of two shapes: the mean. If the shapes have different rules, the rule whose constant
 * is larger applies. */
#define LS2D_MIX_AVERAGE 0
/* Rule for mixing the values of two shapes: the square root of the product. */
#define LS2D_MIX_GEOMETRIC_MEAN 1
/* Rule for mixing the values of two shapes: the smaller value. */
#define LS2D_MIX_MINIMUM 2
/* Rule for mixing the values of two shapes: the product. */
#define LS2D_MIX_PRODUCT 3
/* Rule for mixing the values of two shapes: the larger value. */
#define LS2D_MIX_MAXIMUM 4
/* `ls2d_shape_def.attraction_falloff`: beyond `attraction_radius`, the attraction is constant. */
#define LS2D_FALLOFF_CONSTANT 0
/* `ls2d_shape_def.attraction_falloff`: beyond `attraction_radius`, the attraction is in inverse proportion to the
 * distance from the centre. */
#define LS2D_FALLOFF_INVERSE 1
/* `ls2d_shape_def.attraction_falloff`: beyond `attraction_radius`, the attraction is in inverse proportion to the
 * square of the distance from the centre. */
#define LS2D_FALLOFF_INVERSE_SQUARE 2

/* A point or a vector. */
typedef struct ls2d_vec2 {
    /* Component to the right. */
    ls2d_fx x;
    /* Component upwards. */
    ls2d_fx y;
} ls2d_vec2;

/* A state hash of 128 bits. */
typedef struct ls2d_hash {
    /* The lower half. */
    uint64_t low;
    /* The upper half. */
    uint64_t high;
} ls2d_hash;

/* A random number generator, which a game keeps as part of its state. */
typedef struct ls2d_rng {
    /* State of the generator. */
    uint64_t state;
    /* Stream of the generator, an odd number. */
    uint64_t increment;
} ls2d_rng;

/* Settings of a world. `ls2d_config_init` sets the defaults. */
typedef struct ls2d_config {
    /* Size of this struct in bytes. */
    uint32_t size;
    /* Ticks per second, 10 to 1000. */
    uint32_t tick_rate;
    /* Gravity in m/s², within ±100 000 on each axis. */
    ls2d_vec2 gravity;
    /* Number of sub-steps of a tick, 1 to 64. `tick_rate` times `sub_steps` is 60 to 4000. */
    uint32_t sub_steps;
    /* Number of solver iterations of a sub-step, 1 to 16. */
    uint32_t iterations;
    /* `LS2D_CONTACT_SOFT` or `LS2D_CONTACT_BAUMGARTE`. */
    uint32_t contact;
    /* Flags: `LS2D_SLEEPING`, `LS2D_CONTINUOUS`. */
    uint32_t flags;
    /* Stiffness of soft contacts in Hz, 1 to 1000. For Baumgarte contacts, share of the overlap corrected in each
     * sub-step, 0 to 1. */
    ls2d_fx contact_stiffness;
    /* Damping ratio of soft contacts, 0 to 100. For Baumgarte contacts, overlap in metres that is not corrected, 0
     * to 1. */
    ls2d_fx contact_damping;
    /* Largest speed in m/s with which contacts push shapes apart, 0 to 400. */
    ls2d_fx contact_push_speed;
    /* Stiffness of joints in Hz, 1 to 1000. */
    ls2d_fx joint_hertz;
    /* Damping ratio of joints, 0 to 100. */
    ls2d_fx joint_damping_ratio;
    /* Approach speed in m/s below which shapes do not bounce, 0 to 400. */
    ls2d_fx restitution_threshold;
    /* Largest speed of a body in m/s, 1 to 400. Below 27 ticks per second, also at most 15 m per tick. */
    ls2d_fx speed_max;
    /* Distance in metres within which shapes get contact points before they touch, 0.001 to 1. The distance is
     * larger for shapes that approach each other. */
    ls2d_fx speculative_distance;
    /* Largest margin in metres of the bounding boxes in the broad phase, 0.001 to 10. */
    ls2d_fx fat_margin;
    /* Lowest approach speed of a hit event in m/s, 0 to 400. */
    ls2d_fx hit_speed;
    /* Largest number of bodies, at most 2^20. */
    uint32_t body_limit;
    /* Largest number of shapes, at most 2^20. */
    uint32_t shape_limit;
    /* Largest number of joints, at most 2^20. */
    uint32_t joint_limit;
    /* Largest number of pairs of shapes with overlapping fat AABBs in a tick, at most 2^20. A tick with more pairs
     * ignores those of the shapes in the largest slots, and counts as a fault. */
    uint32_t pair_limit;
} ls2d_config;

/* Definition of a body, and its settings. `ls2d_body_def_init` sets the defaults. */
typedef struct ls2d_body_def {
    /* Size of this struct in bytes. */
    uint32_t size;
    /* `LS2D_FIXED`, `LS2D_KINEMATIC` or `LS2D_DYNAMIC`. */
    uint32_t kind;
    /* `LS2D_BODY_` flags. */
    uint32_t flags;
    /* `LS2D_SWEEP_OFF` and so on. */
    uint32_t continuous;
    /* Origin in the world, in metres. */
    ls2d_vec2 position;
    /* Rotation. */
    ls2d_angle angle;
    /* Reserved: 0. */
    uint32_t reserved;
    /* Velocity of the centre of mass in m/s. */
    ls2d_vec2 velocity;
    /* Angular velocity in rad/s, counter-clockwise. */
    ls2d_fx angular_velocity;
    /* Mass in kg, 1e-5 to 2^30. Read only with `LS2D_BODY_GIVEN_MASS`. */
    ls2d_fx mass;
    /* Centre of mass in the body's frame, in metres. Read only with `LS2D_BODY_GIVEN_MASS`. */
    ls2d_vec2 mass_centre;
    /* Radius of gyration about the centre of mass in metres, 0.002 to 512. Read only with `LS2D_BODY_GIVEN_MASS`. */
    ls2d_fx mass_gyration;
    /* Decay rate of the velocity, per second. */
    ls2d_fx linear_damping;
    /* Decay rate of the angular velocity, per second. */
    ls2d_fx angular_damping;
    /* Factor on the world's gravity. */
    ls2d_fx gravity_scale;
    /* Speed in m/s below which the body becomes ready to sleep. */
    ls2d_fx sleep_speed;
    /* A number that the game may choose freely. */
    uint64_t user_data;
    /* Name for reports: 1 to 16 ASCII letters, digits, `-` and `_`, padded with zeros. All zeros mean no name. */
    uint8_t name[16];
} ls2d_body_def;

/* Properties of a body. */
typedef struct ls2d_body_info {
    /* `LS2D_FIXED`, `LS2D_KINEMATIC` or `LS2D_DYNAMIC`. */
    uint32_t kind;
    /* `LS2D_BODY_` flags, without `LS2D_BODY_GIVEN_MASS`. */
    uint32_t flags;
    /* Origin in the world, in metres. */
    ls2d_vec2 position;
    /* Rotation. */
    ls2d_angle angle;
    /* Number of shapes. */
    uint32_t shapes;
    /* Velocity of the centre of mass in m/s. */
    ls2d_vec2 velocity;
    /* Angular velocity in rad/s, counter-clockwise. */
    ls2d_fx angular_velocity;
    /* Centre of mass in the world, in metres. */
    ls2d_vec2 centre;
    /* Mass in kg. */
    ls2d_fx mass;
    /* Moment of inertia about the centre of mass in kg m². */
    ls2d_fx inertia;
    /* The number that the game has stored with the body. */
    uint64_t user_data;
    /* Decay rate of the velocity, per second. */
    ls2d_fx linear_damping;
    /* Decay rate of the angular velocity, per second. */
    ls2d_fx angular_damping;
    /* Factor on the world's gravity. */
    ls2d_fx gravity_scale;
    /* Speed in m/s below which the body becomes ready to sleep. */
    ls2d_fx sleep_speed;
    /* `LS2D_SWEEP_OFF` and so on. */
    uint32_t continuous;
    /* Reserved: 0. */
    uint32_t reserved;
} ls2d_body_info;

/* Position and rotation of a body. */
typedef struct ls2d_pose {
    /* The body. */
    ls2d_body body;
    /* Origin in the world, in metres. */
    ls2d_vec2 position;
    /* Rotation. */
    ls2d_angle angle;
    /* Flags: `LS2D_BODY_ENABLED`, `LS2D_BODY_ASLEEP`. */
    uint32_t flags;
} ls2d_pose;

/* An explosion: impulses away from a point. */
typedef struct ls2d_explosion {
    /* Size of this struct in bytes. */
    uint32_t size;
    /* Reserved: 0. */
    uint32_t reserved;
    /* Centre in the world, in metres. */
    ls2d_vec2 centre;
    /* Radius in metres within which the impulse is full. */
    ls2d_fx radius;
    /* Width in metres of the ring outside of the radius in which the impulse falls to 0. */
    ls2d_fx falloff;
    /* Impulse in N s per metre of the width of a shape, as seen from the centre. */
    ls2d_fx impulse;
    /* Categories of shapes that the explosion acts on. */
    uint64_t mask;
} ls2d_explosion;

/* Definition of a shape. `ls2d_shape_def_init` sets the defaults. */
typedef struct ls2d_shape_def {
    /* Size of this struct in bytes. */
    uint32_t size;
    /* `LS2D_CIRCLE` and so on. */
    uint32_t kind;
    /* `LS2D_SHAPE_` flags. */
    uint32_t flags;
    /* Number of points of a polygon or hull, at most 8. */
    uint32_t count;
    /* Points in metres from the shape's centre. */
    ls2d_vec2 points[8];
    /* Radius of a circle or capsule, rounding radius of a polygon, hull or rectangle, in metres. */
    ls2d_fx radius;
    /* Centre of the shape in the body's frame, in metres. */
    ls2d_vec2 offset;
    /* Mass per area in kg/m², 0 to 2^20. */
    ls2d_fx density;
    /* Friction coefficient, 0 to 16. */
    ls2d_fx friction;
    /* Fraction of the approach speed that a bounce returns, 0 to 1.5. */
    ls2d_fx restitution;
    /* Approach speed in m/s below which the shape does not bounce, 0 to 400. Read only with
     * `LS2D_SHAPE_RESTITUTION_THRESHOLD`. */
    ls2d_fx restitution_threshold;
    /* Rolling resistance of a round shape, as a fraction of its radius, 0 to 1. */
    ls2d_fx rolling_resistance;
    /* Speed of the surface around the shape, clockwise, in m/s, within ±400. */
    ls2d_fx surface_speed;
    /* Categories that the shape belongs to, one bit each. */
    uint64_t category;
    /* Categories that the shape collides with. */
    uint64_t mask;
    /* Two shapes with the same positive group always collide, two shapes with the same negative group never do. 0
     * is no group. */
    int32_t group;
    /* `LS2D_MIX_AVERAGE` and so on, for friction. */
    uint32_t friction_mixing;
    /* `LS2D_MIX_AVERAGE` and so on, for restitution. */
    uint32_t restitution_mixing;
    /* Direction in the body's frame in which other shapes pass through this one. Read only with
     * `LS2D_SHAPE_ONE_WAY`. */
    ls2d_angle one_way;
    /* Acceleration in m/s² that the area gives to bodies in it, along the axes of the area's body, within ±10 000. */
    ls2d_vec2 area_acceleration;
    /* Force in N per m² of the part of a body that is in the area, along the axes of the area's body, within
     * ±2^20. */
    ls2d_vec2 area_force;
    /* Velocity of the medium relative to the area's body in m/s, along the axes of this body, within ±400. */
    ls2d_vec2 area_flow;
    /* Rate per second, 0 to 1000, at which the velocity of a body in the area approaches that of the medium. */
    ls2d_fx area_linear_drag;
    /* Rate per second, 0 to 1000, at which the angular velocity of a body in the area approaches that of the
     * area's body. */
    ls2d_fx area_angular_drag;
    /* Density of the medium in kg/m², 0 to 2^20, for buoyancy. */
    ls2d_fx area_density;
    /* Acceleration in m/s² towards the centre of the area, at the distance `attraction_radius`. */
    ls2d_fx attraction_acceleration;
    /* Distance from the centre in metres at which the acceleration is `attraction_acceleration`. Nearer to the
     * centre, it decreases linearly to 0; farther away, `attraction_falloff` applies. */
    ls2d_fx attraction_radius;
    /* `LS2D_FALLOFF_CONSTANT` and so on. */
    uint32_t attraction_falloff;
    /* Reserved: 0. */
    uint32_t reserved;
    /* A number that the game may choose freely. */
    uint64_t user_data;
} ls2d_shape_def;

/* Definition of a joint. `ls2d_joint_def_init` sets the defaults. If the comment of a flag names a field, the
 * field is read only with this flag. There is one exception: a pulley always reads `length`. */
typedef struct ls2d_joint_def {
    /* Size of this struct in bytes. */
    uint32_t size;
    /* `LS2D_REVOLUTE` and so on. */
    uint32_t kind;
    /* `LS2D_JOINT_` flags. */
    uint32_t flags;
    /* Number of teeth of a gear's wheel on body A: 1 to 1000, or -1 to -1000 for a ring around the other wheel. */
    int32_t teeth_a;
    /* Number of teeth of a gear's wheel on body B, in the same range. */
    int32_t teeth_b;
    /* Angle of the joint's frame on A, in the frame of body A. */
    ls2d_angle angle_a;
    /* Angle of the joint's frame on B, in the frame of body B. */
    ls2d_angle angle_b;
    /* Reserved: 0. */
    uint32_t reserved;
    /* Body A. */
    ls2d_body body_a;
    /* Body B. */
    ls2d_body body_b;
    /* Anchor in the frame of body A, in metres. */
    ls2d_vec2 anchor_a;
    /* Anchor in the frame of body B, in metres. */
    ls2d_vec2 anchor_b;
    /* Lower limit of the angle in rad (revolute), of the translation in m (prismatic, wheel) or of the length in m
     * (distance). */
    ls2d_fx limit_lower;
    /* Upper limit, in the unit of the lower one. */
    ls2d_fx limit_upper;
    /* Target speed of the motor: in rad/s (revolute, wheel, motor), or m/s (prismatic, distance). */
    ls2d_fx motor_speed;
    /* Largest torque of the motor in N m (revolute, wheel, motor), or largest force in N (prismatic, distance). */
    ls2d_fx motor_max;
    /* Frequency of the spring in Hz. */
    ls2d_fx spring_hertz;
    /* Damping ratio of the spring. */
    ls2d_fx spring_damping_ratio;
    /* Rest position of the spring, in rad (revolute) or in m (prismatic, distance, wheel). */
    ls2d_fx spring_target;
    /* Smallest force of the spring in N, 0 or less. Positive forces push the anchors apart. */
    ls2d_fx spring_force_lower;
    /* Largest force of the spring in N, 0 or more. */
    ls2d_fx spring_force_upper;
    /* Length in metres that a rod holds (distance), or of the rope (pulley). */
    ls2d_fx length;
    /* Stiffness in Hz of the rigid constraints of the joint. */
    ls2d_fx hertz;
    /* Damping ratio of the rigid constraints of the joint. */
    ls2d_fx damping_ratio;
    /* Force in N beyond which the joint is reported or breaks. */
    ls2d_fx threshold_force;
    /* Torque in N m beyond which the joint is reported or breaks. */
    ls2d_fx threshold_torque;
    /* Target velocity of B's anchor relative to A along the axes of the world, in m/s (motor joint). */
    ls2d_vec2 linear_velocity;
    /* Largest force in N for `linear_velocity` (motor joint). */
    ls2d_fx linear_motor_max;
    /* Frequency in Hz of the spring between the anchors. */
    ls2d_fx linear_hertz;
    /* Damping ratio of the spring between the anchors. */
    ls2d_fx linear_damping_ratio;
    /* Largest force of the spring between the anchors in N (motor joint). */
    ls2d_fx linear_max;
    /* Frequency in Hz of the spring on the angle. */
    ls2d_fx angular_hertz;
    /* Damping ratio of the spring on the angle. */
    ls2d_fx angular_damping_ratio;
    /* Largest torque of the spring on the angle in N m (motor joint). */
    ls2d_fx angular_max;
    /* Radius of the wheel of a rack in metres. */
    ls2d_fx radius;
    /* Position of a pulley's wheel on A's side, in the world, in metres. */
    ls2d_vec2 wheel_a;
    /* Position of a pulley's wheel on B's side, in the world, in metres. */
    ls2d_vec2 wheel_b;
    /* Ratio of a pulley: the length on A's side plus `ratio` times the length on B's side is at most `length`. */
    ls2d_fx ratio;
    /* A number that the game may choose freely. */
    uint64_t user_data;
} ls2d_joint_def;

/* Selects the shapes that a query sees. A null pointer stands for the defaults of `ls2d_query_filter_init`. */
typedef struct ls2d_query_filter {
    /* Size of this struct in bytes. */
    uint32_t size;
    /* Flags: `LS2D_QUERY_SENSORS` or 0. */
    uint32_t flags;
    /* Treatment of shapes that a ray or a cast starts in: `LS2D_OVERLAP_RESIST` and so on. */
    uint32_t initial_overlap;
    /* Number of bodies in `except`, at most 8. */
    uint32_t except_count;
    /* Categories of the query: a shape is seen only if its `mask` has one of them. */
    uint64_t category;
    /* Categories of shapes that the query sees. */
    uint64_t mask;
    /* Bodies that the query does not see. */
    ls2d_body except[8];
} ls2d_query_filter;

/* Hit of a ray. */
typedef struct ls2d_ray_hit {
    /* The shape that the ray meets. */
    ls2d_shape shape;
    /* Body of that shape. */
    ls2d_body body;
    /* Fraction of the translation at the hit, 0 to 1. */
    ls2d_fx fraction;
    /* Point in the world, in metres. */
    ls2d_vec2 point;
    /* Outward normal of the surface; zero if the ray starts inside. */
    ls2d_vec2 normal;
    /* 1 if the ray starts inside the shape, otherwise 0. */
    uint64_t starts_inside;
} ls2d_ray_hit;

/* Hit of a moving probe. */
typedef struct ls2d_cast_hit {
    /* The shape that the probe meets. */
    ls2d_shape shape;
    /* Body of that shape. */
    ls2d_body body;
    /* Fraction of the translation at the hit, 0 to 1. */
    ls2d_fx fraction;
    /* Displacement of the probe up to the hit, in metres. */
    ls2d_vec2 travelled;
    /* Point on the surface of that shape, in the world, in metres. */
    ls2d_vec2 point;
    /* Outward normal of the surface at that point. */
    ls2d_vec2 normal;
    /* 1 if the shapes overlap at the start, otherwise 0. */
    uint64_t starts_inside;
} ls2d_cast_hit;

/* The shape nearest to a point. */
typedef struct ls2d_closest_point {
    /* The nearest shape. */
    ls2d_shape shape;
    /* Body of that shape. */
    ls2d_body body;
    /* Distance in metres, negative if the given point is inside the shape. */
    ls2d_fx distance;
    /* Point on the surface, in the world, in metres. */
    ls2d_vec2 point;
    /* Unit vector from the given point to the shape. */
    ls2d_vec2 normal;
} ls2d_closest_point;

/* An axis-aligned box. */
typedef struct ls2d_aabb {
    /* Lower left corner in metres. */
    ls2d_vec2 lower;
    /* Upper right corner in metres. */
    ls2d_vec2 upper;
} ls2d_aabb;

/* A shape that is not in the world, for casts and overlaps. */
typedef struct ls2d_probe {
    /* Size of this struct in bytes. */
    uint32_t size;
    /* Rotation. */
    ls2d_angle angle;
    /* Position of the shape's centre in the world, in metres. */
    ls2d_vec2 position;
    /* Geometry of the probe; other fields of the definition have no effect. */
    ls2d_shape_def shape;
} ls2d_probe;

/* Geometry and abilities of a character. `ls2d_mover_init` sets the defaults. */
typedef struct ls2d_mover {
    /* Size of this struct in bytes. */
    uint32_t size;
    /* Steepest slope that counts as ground, measured from the horizontal. */
    ls2d_angle slope_max;
    /* Height in metres of steps that the character climbs without a jump, 0 to 100. */
    ls2d_fx step_height;
    /* Largest descent of the ground within a tick that the character follows, in metres, 0 to 100. */
    ls2d_fx snap_distance;
    /* Geometry of the character; other fields of the definition have no effect. */
    ls2d_shape_def shape;
} ls2d_mover;

/* A surface that a character has met. */
typedef struct ls2d_mover_plane {
    /* The shape that the character has met. */
    ls2d_shape shape;
    /* Body of that shape. */
    ls2d_body body;
    /* Position of the body's origin when the character met the surface, in the world, in metres. */
    ls2d_vec2 body_position;
    /* Velocity of the surface in m/s. */
    ls2d_vec2 velocity;
    /* Outward normal of the surface. */
    ls2d_vec2 normal;
    /* Nearest point on the surface, in the world, in metres. */
    ls2d_vec2 point;
    /* Distance of the character from the surface in metres, negative if they overlap. */
    ls2d_fx separation;
    /* Rotation of the body when the character met the surface. */
    ls2d_angle body_angle;
    /* Reserved: 0. */
    uint32_t reserved;
} ls2d_mover_plane;

/* State of a character, which the game stores. `ls2d_mover_state_init` sets the first state. */
typedef struct ls2d_mover_state {
    /* Size of this struct in bytes. */
    uint32_t size;
    /* `LS2D_MOVER_` flags. */
    uint32_t flags;
    /* Position in the world, in metres, of the origin of the geometry's coordinates. */
    ls2d_vec2 position;
    /* Velocity in m/s: relative to the ground while the character stands on ground, otherwise in the world. */
    ls2d_vec2 velocity;
    /* With `LS2D_MOVER_ON_GROUND`, the ground on which the character stands; otherwise zeros. */
    ls2d_mover_plane ground;
    /* Shapes solid from one side that the character overlaps and passes through until it has left them. */
    ls2d_shape passing[8];
    /* Number of these shapes. */
    uint32_t passing_count;
    /* Reserved: 0. */
    uint32_t reserved;
} ls2d_mover_state;

/* Two shapes that began or ceased to touch. A handle is stale if its shape was removed. */
typedef struct ls2d_contact_event {
    /* The shape in the smaller slot. */
    ls2d_shape shape_a;
    /* The shape in the larger slot. */
    ls2d_shape shape_b;
} ls2d_contact_event;

/* Two shapes that hit each other. */
typedef struct ls2d_hit_event {
    /* The shape in the smaller slot. */
    ls2d_shape shape_a;
    /* The shape in the larger slot. */
    ls2d_shape shape_b;
    /* Contact point in the world, in metres. */
    ls2d_vec2 point;
    /* Unit vector from A to B. */
    ls2d_vec2 normal;
    /* Approach speed in m/s. */
    ls2d_fx approach_speed;
    /* Impulse along the normal over the whole tick, in N s. */
    ls2d_fx impulse;
} ls2d_hit_event;

/* A sensor and a shape that began or ceased to overlap. A handle is stale if its shape was removed. */
typedef struct ls2d_sensor_event {
    /* The sensor. */
    ls2d_shape sensor;
    /* The shape that overlaps the sensor. */
    ls2d_shape visitor;
    /* Time at which the overlap began or ceased, as a fraction of the tick from 0 to 1. */
    ls2d_fx fraction;
} ls2d_sensor_event;

/* A joint whose force or torque exceeded its threshold. */
typedef struct ls2d_joint_event {
    /* The joint. The handle is stale if the joint broke. */
    ls2d_joint joint;
    /* Force on body B in N. */
    ls2d_vec2 force;
    /* Torque in N m on body B about B's anchor. */
    ls2d_fx torque;
    /* 1 if the joint broke, otherwise 0. */
    uint64_t broke;
} ls2d_joint_event;

/* Upper limits on the size of a replay and on the cost of playing it. `ls2d_limits_init` sets the defaults. */
typedef struct ls2d_limits {
    /* Size of this struct in bytes. */
    uint32_t size;
    /* Reserved: 0. */
    uint32_t reserved;
    /* Largest number of bytes of the file. */
    uint64_t file_bytes;
    /* Largest number of bytes of the setup. */
    uint32_t setup_bytes;
    /* Largest number of players. */
    uint32_t players;
    /* Largest number of bytes of a block, the part of the file with the inputs between two checkpoints. */
    uint32_t block_bytes;
    /* Largest number of ticks between checkpoints. */
    uint32_t block_ticks;
    /* Largest number of ticks of the game. */
    uint64_t ticks;
    /* Largest number of bodies of the world. */
    uint64_t bodies;
    /* Largest number of work units of a tick. A unit takes about a microsecond or less. */
    uint64_t tick_work;
    /* Largest number of work units of the game. */
    uint64_t total_work;
} ls2d_limits;

/* Result of verifying a replay. Every verdict except `LS2D_MATCH` means that the replay is not verified. */
typedef struct ls2d_verdict {
    /* `LS2D_MATCH` and so on. */
    uint32_t kind;
    /* Reserved: 0. */
    uint32_t reserved;
    /* Number of ticks played, for `LS2D_MATCH`, `LS2D_CLAIM_MISMATCH` and `LS2D_INCOMPLETE`; tick of the first
     * checkpoint that differs, for `LS2D_DIVERGED`; otherwise 0. */
    uint64_t ticks;
    /* Hash of the last state for `LS2D_MATCH`, `LS2D_CLAIM_MISMATCH` and `LS2D_INCOMPLETE`; otherwise 0. */
    ls2d_hash hash;
} ls2d_verdict;

/* Parameters of a match and of a peer. `ls2d_match_config_init` sets the defaults. */
typedef struct ls2d_match_config {
    /* Size of this struct in bytes. */
    uint32_t size;
    /* Number of seats of the match, 1 to 64. */
    uint32_t seats;
    /* Number of seats that this peer plays; 0 for a spectator or a dedicated server. */
    uint32_t own_seats;
    /* Number of seats that have to be taken before the first tick, including those of the host. */
    uint32_t start_with;
    /* Bytes of an input, 1 to 512. */
    uint32_t input_bytes;
    /* Duration of a tick in microseconds, 1000 to 1 000 000. */
    uint32_t tick_micros;
    /* Number of ticks that may be played with guessed inputs of other peers, 0 to 32; 0 means lockstep. */
    uint32_t guess;
    /* Smallest delay of this peer's own inputs in ticks. The delay follows the latency. */
    uint32_t delay_min;
    /* Largest delay of this peer's own inputs in ticks, at most 60. */
    uint32_t delay_max;
    /* Interval in ticks at which states are saved. 0, the default, stands for the interval of a Rust `Peer`: 1
     * with guessed inputs; in lockstep, the largest divisor of `check_interval` up to 8, or 6 if `check_interval`
     * is 0. */
    uint32_t save_interval;
    /* Interval in ticks at which states are compared: a multiple of `save_interval`. 0, the default, stands for
     * the interval of a Rust `Peer`: the largest multiple of `save_interval` up to 10, or `save_interval` if it is
     * more than 10. */
    uint32_t check_interval;
    /* Number of ticks that may be played beyond the last final tick, at least 16. */
    uint32_t history;
    /* Minimum number of final ticks whose inputs are kept for peers that return, at least `history`. */
    uint32_t log_ticks;
    /* When a peer joins, its first tick lies three round trips and this number of ticks after the agreement on its
     * seat. */
    uint32_t seat_lead;
    /* A peer may get a seat if it lags by at most this many ticks. */
    uint32_t seat_within;
    /* Number that identifies this peer. Choose a new random number in each process. */
    uint32_t peer;
    /* Tag of the match: packets with another tag are ignored. */
    uint64_t match_tag;
    /* Time in microseconds for which the other peers wait for a missing peer before they go on without it. */
    uint64_t patience;
    /* Identity of the player: a peer that joins with the same key gets its seat back, if the seat is free. */
    uint64_t key;
    /* Secret random numbers that protect against packets with forged addresses. */
    uint64_t secret[2];
} ls2d_match_config;

/* A request of a match or of a replay to the game. */
typedef struct ls2d_request {
    /* `LS2D_REQUEST_SAVE` and so on. */
    uint32_t kind;
    /* The tick that the request is about. */
    uint32_t tick;
    /* Bit for each seat that nobody plays, for `LS2D_REQUEST_ADVANCE`. */
    uint64_t absent;
    /* Bit for each seat whose input is guessed, for `LS2D_REQUEST_ADVANCE`. */
    uint64_t guessed;
} ls2d_request;

/* An event of a match. */
typedef struct ls2d_match_event {
    /* `LS2D_EVENT_STATUS` and so on. */
    uint32_t kind;
    /* Number of the peer that the event names. */
    uint32_t peer;
    /* The seat that the event names. */
    uint32_t seat;
    /* The tick that the event names. */
    uint32_t tick;
    /* A value whose meaning depends on the kind. */
    uint32_t value;
    /* Reserved: 0. */
    uint32_t reserved;
    /* Hash of this peer, for `LS2D_EVENT_DESYNC`. */
    ls2d_hash ours;
    /* Hash of the other peer, for `LS2D_EVENT_DESYNC`. */
    ls2d_hash theirs;
} ls2d_match_event;

/* ---- The library ---- */

/* Version of the API in the library. It has to equal `LS2D_API_VERSION` of the header. */
uint32_t ls2d_api_version(void);

/* Version of the engine's arithmetic: programs with different versions compute different states. */
uint32_t ls2d_semantics(void);

/* Copies the text of the last failure or verdict on this thread, as UTF-8 without a final zero. If the buffer is
 * too short, the text is cut. `length` is the length of the whole text in bytes. A call that returns `LS2D_NONE`
 * has not failed, and leaves the text unchanged. */
ls2d_status ls2d_last_error(uint8_t *buffer, size_t capacity, size_t *length);

/* Frees an object of any kind. Every later use of its handle is an error. */
ls2d_status ls2d_free(uint32_t handle);

/* Number of objects that have not been freed. Use it to find leaks. */
size_t ls2d_object_count(void);

/* Number of bytes of a bytes object. */
ls2d_status ls2d_bytes_size(uint32_t bytes, size_t *size);

/* Copies the bytes of a bytes object. */
ls2d_status ls2d_bytes_copy(uint32_t bytes, uint8_t *buffer, size_t capacity);

/* Makes a bytes object with a copy of some bytes. */
ls2d_status ls2d_bytes_new(const uint8_t *data, size_t size, uint32_t *bytes);

/* A buffer for callers that cannot allocate memory themselves, such as JavaScript. Returns the address of `size`
 * bytes with an alignment of 8, or 0 if there is not enough memory. Each thread has one such buffer. A call with a
 * larger size may move the buffer, but keeps its contents. */
size_t ls2d_scratch(size_t size);

/* ---- Worlds ---- */

/* Sets the default settings of a world: 60 ticks per second, gravity of 10 m/s² downwards. */
ls2d_status ls2d_config_init(ls2d_config *config);

/* Copies the settings `from` to `config`, adapted to small boxes. Raises the number of sub-steps (to at most 64
 * per tick and 4000 per second) and the contact stiffness, so that a stack of 8 boxes of `size` metres sinks by
 * less than 2.5 % of `size`. Reduces the speculative distance to a fiftieth of `size`, but not below 1 mm. Set
 * gravity and the tick rate in `from` before this call. */
ls2d_status ls2d_config_for_smallest(ls2d_config *config, const ls2d_config *from, ls2d_fx size);

/* Makes an empty world. A null `config` stands for the default settings. */
ls2d_status ls2d_world_new(const ls2d_config *config, uint32_t *world);

/* Makes a copy of a world. */
ls2d_status ls2d_world_clone(uint32_t world, uint32_t *copy);

/* Advances a world by one tick. */
ls2d_status ls2d_world_step(uint32_t world);

/* Advances a world by a number of ticks. Afterwards, the event functions return the events of the last tick. */
ls2d_status ls2d_world_steps(uint32_t world, uint32_t ticks);

/* Hash of the state of a world. Equal settings, edits and ticks in the same order give equal hashes on every
 * machine. */
ls2d_status ls2d_world_hash(uint32_t world, ls2d_hash *hash);

/* Hash of one section of the state. `section` is 0 (settings, tick and fault count), 1 (bodies), 2 (shapes), 3
 * (joints), 4 (contacts), 5 (islands), or 6 (random number generator). */
ls2d_status ls2d_world_digest(uint32_t world, uint32_t section, ls2d_hash *hash);

/* Number of ticks since the world was made. */
ls2d_status ls2d_world_tick(uint32_t world, uint64_t *tick);

/* Number of faults since the world was made: results of the solver that were clamped to the range of their number
 * format, and ticks with more pairs than `pair_limit`. Limiting a body to the largest speed does not count. */
ls2d_status ls2d_world_faults(uint32_t world, uint64_t *faults);

/* The settings of a world. */
ls2d_status ls2d_world_config(uint32_t world, ls2d_config *config);

/* Numbers of bodies, shapes, joints, awake bodies, and pairs of shapes with overlapping fat AABBs. Each pointer
 * may be null. */
ls2d_status ls2d_world_counts(uint32_t world, size_t *bodies, size_t *shapes, size_t *joints, size_t *awake, size_t *pairs);

/* Draws a number of 32 bits from the world's generator, which is part of the state. */
ls2d_status ls2d_world_random(uint32_t world, uint32_t *number);

/* Draws a uniform number below `bound` from the world's generator. */
ls2d_status ls2d_world_random_below(uint32_t world, uint32_t bound, uint32_t *number);

/* Draws a uniform number from `low` to below `high` from the world's generator. */
ls2d_status ls2d_world_random_range(uint32_t world, ls2d_fx low, ls2d_fx high, ls2d_fx *number);

/* Rebuilds the caches of a world from its state. The hash of the world does not change. There are no events until
 * the next tick. */
ls2d_status ls2d_world_clear_scratch(uint32_t world);

/* ---- Definitions ---- */

/* Sets the defaults of a body of the given kind, at rest at the origin. */
ls2d_status ls2d_body_def_init(uint32_t kind, ls2d_body_def *def);

/* Sets the defaults of a shape of the given kind. The caller sets the geometry. */
ls2d_status ls2d_shape_def_init(uint32_t kind, ls2d_shape_def *def);

/* Sets the defaults of a joint of the given kind. The caller sets its bodies, which are `LS2D_NO_ID` at first. */
ls2d_status ls2d_joint_def_init(uint32_t kind, ls2d_joint_def *def);

/* Makes the links of a chain through some points. If `closed` is not 0, the last point is connected with the
 * first. If `one_sided` is not 0, the chain is solid only from the right, looking along the points. The links take
 * all other properties from `base`, whose geometry is ignored. */
ls2d_status ls2d_chain_links(const ls2d_shape_def *base, const ls2d_vec2 *points, size_t point_count, uint32_t closed, uint32_t one_sided, ls2d_shape_def *links, size_t capacity, size_t *count);

/* Mass, centre of mass and radius of gyration of a dynamic body with some shapes, for an `ls2d_body_def`. Each
 * pointer to a result may be null. At least one shape must have both an area and a density. */
ls2d_status ls2d_shapes_mass(const ls2d_shape_def *shapes, size_t shape_count, ls2d_fx *mass, ls2d_vec2 *centre, ls2d_fx *gyration);

/* ---- Edits of a world, or of a list of commands ---- */

/* Makes an empty list of commands. */
ls2d_status ls2d_commands_new(uint32_t *commands);

/* Empties a list of commands. */
ls2d_status ls2d_commands_clear(uint32_t commands);

/* Number of commands in a list. */
ls2d_status ls2d_commands_count(uint32_t commands, size_t *count);

/* Encodes a list of commands as bytes. */
ls2d_status ls2d_commands_encode(uint32_t commands, uint32_t *bytes);

/* Replaces the contents of a list of commands by the commands in `data`, an encoded list. `data` may come from an
 * untrusted source. */
ls2d_status ls2d_commands_decode(uint32_t commands, const uint8_t *data, size_t size);

/* Executes a list of commands in order. Skips commands that the world refuses. Writes the number of skipped
 * commands to `refused`, unless this pointer is null. */
ls2d_status ls2d_world_execute(uint32_t world, uint32_t commands, uint32_t *refused);

/* Adds a body with its shapes. Writes the body's handle to `id`, unless `id` is null or the target is a list. */
ls2d_status ls2d_spawn(uint32_t target, const ls2d_body_def *body, const ls2d_shape_def *shapes, size_t shape_count, ls2d_body *id);

/* Adds a body at each of the `poses`, all with the definition `body` and the same shapes. If the world refuses one
 * of the bodies, it adds none of them. A recording stores the definition only once. The fields `body` and `flags`
 * of the poses are not read. Writes the handles of the bodies to `ids`, unless `ids` is null or the target is a
 * list. */
ls2d_status ls2d_spawn_each(uint32_t target, const ls2d_body_def *body, const ls2d_shape_def *shapes, size_t shape_count, const ls2d_pose *poses, size_t pose_count, ls2d_body *ids, size_t capacity);

/* Removes a body with its shapes and joints. */
ls2d_status ls2d_despawn(uint32_t target, ls2d_body body);

/* Adds a shape to a body. Writes the shape's handle to `id`, unless `id` is null or the target is a list. */
ls2d_status ls2d_add_shape(uint32_t target, ls2d_body body, const ls2d_shape_def *shape, ls2d_shape *id);

/* Removes a shape. */
ls2d_status ls2d_remove_shape(uint32_t target, ls2d_shape shape);

/* Replaces the definition of a shape. */
ls2d_status ls2d_set_shape(uint32_t target, ls2d_shape shape, const ls2d_shape_def *def);

/* Adds a joint. Writes the joint's handle to `id`, unless `id` is null or the target is a list. */
ls2d_status ls2d_add_joint(uint32_t target, const ls2d_joint_def *joint, ls2d_joint *id);

/* Adds a joint between each pair of bodies in `ends`, all with the definition `joint`, whose own bodies are
 * ignored. If the world refuses one of the joints, it adds none of them. A recording stores the definition only
 * once. `ends` contains body A and body B of the first joint, then those of the second joint, and so on;
 * `end_count` is the number of bodies. Writes the handles of the joints to `ids`, unless `ids` is null or the
 * target is a list. */
ls2d_status ls2d_add_joint_each(uint32_t target, const ls2d_joint_def *joint, const ls2d_body *ends, size_t end_count, ls2d_joint *ids, size_t capacity);

/* Removes a joint. */
ls2d_status ls2d_remove_joint(uint32_t target, ls2d_joint joint);

/* Replaces the definition of a joint. The bodies of the joint cannot be changed. */
ls2d_status ls2d_set_joint(uint32_t target, ls2d_joint joint, const ls2d_joint_def *def);

/* Enables a joint. */
ls2d_status ls2d_enable_joint(uint32_t target, ls2d_joint joint);

/* Disables a joint: it stays in the world and keeps its handle, but has no effect. */
ls2d_status ls2d_disable_joint(uint32_t target, ls2d_joint joint);

/* Applies a force in N to a body during the next tick, at a point of the world in metres. */
ls2d_status ls2d_apply_force(uint32_t target, ls2d_body body, ls2d_fx force_x, ls2d_fx force_y, ls2d_fx x, ls2d_fx y);

/* Applies a torque in N m to a body during the next tick. */
ls2d_status ls2d_apply_torque(uint32_t target, ls2d_body body, ls2d_fx torque);

/* Applies an impulse in N s to a body at a point of the world in metres: changes the velocity at once. */
ls2d_status ls2d_apply_impulse(uint32_t target, ls2d_body body, ls2d_fx impulse_x, ls2d_fx impulse_y, ls2d_fx x, ls2d_fx y);

/* Applies an angular impulse in N m s to a body: changes the angular velocity at once. */
ls2d_status ls2d_apply_angular_impulse(uint32_t target, ls2d_body body, ls2d_fx impulse);

/* Sets the velocity of a body's centre of mass in m/s, and its angular velocity in rad/s. */
ls2d_status ls2d_set_velocity(uint32_t target, ls2d_body body, ls2d_fx x, ls2d_fx y, ls2d_fx angular);

/* Sets the position of a body's origin in metres, and its angle. */
ls2d_status ls2d_set_transform(uint32_t target, ls2d_body body, ls2d_fx x, ls2d_fx y, ls2d_angle angle);

/* Moves a kinematic body during the next tick, so that its origin ends at (`x`, `y`) in metres with the rotation
 * `angle`. After this tick its velocity is 0. The result is `LS2D_WRONG_KIND` for a body that is not kinematic,
 * and `LS2D_SPEED` if the body cannot reach the pose in one tick at the world's `speed_max`: use
 * `ls2d_set_transform` for such a distance. */
ls2d_status ls2d_move_to(uint32_t target, ls2d_body body, ls2d_fx x, ls2d_fx y, ls2d_angle angle);

/* Sets all settings of a body: damping, gravity scale, locks, continuous collision detection, sleep. The other
 * fields of `def` have no effect. */
ls2d_status ls2d_set_body(uint32_t target, ls2d_body body, const ls2d_body_def *def);

/* Changes the kind of a body. A body that becomes fixed stops. */
ls2d_status ls2d_set_kind(uint32_t target, ls2d_body body, uint32_t kind);

/* Sets the mass of a body. If `def` has `LS2D_BODY_GIVEN_MASS`, its three mass fields are used, otherwise the mass
 * of the body's shapes. The other fields of `def` have no effect. */
ls2d_status ls2d_set_mass(uint32_t target, ls2d_body body, const ls2d_body_def *def);

/* Sets the number that the game stores with a body. */
ls2d_status ls2d_set_user_data(uint32_t target, ls2d_body body, uint64_t user_data);

/* Sets the name of a body. A length of 0 removes the name. */
ls2d_status ls2d_set_name(uint32_t target, ls2d_body body, const uint8_t *text, size_t length);

/* Enables a body: it takes part in the simulation again. */
ls2d_status ls2d_enable(uint32_t target, ls2d_body body);

/* Disables a body: it keeps its pose and velocity, collides with nothing, and queries do not find it. */
ls2d_status ls2d_disable(uint32_t target, ls2d_body body);

/* Wakes a body. */
ls2d_status ls2d_wake(uint32_t target, ls2d_body body);

/* Puts a dynamic body to sleep, together with the dynamic bodies that are connected to it by contacts and joints. */
ls2d_status ls2d_sleep(uint32_t target, ls2d_body body);

/* Sets the gravity in m/s². */
ls2d_status ls2d_set_gravity(uint32_t target, ls2d_fx x, ls2d_fx y);

/* Replaces the settings of a world. A limit, such as `body_limit`, must be equal to that of the world; otherwise
 * the result is `LS2D_FIXED_SETTING`, and no setting changes. A recording also refuses a different tick rate. */
ls2d_status ls2d_set_config(uint32_t target, const ls2d_config *config);

/* Applies the impulses of an explosion to dynamic bodies, away from its centre, and wakes these bodies. */
ls2d_status ls2d_explode(uint32_t target, const ls2d_explosion *explosion);

/* Sets the defaults of an explosion: radius and falloff of 1 m, acting on shapes of all categories. The centre is
 * a point of the world in metres. `impulse` is in N s per metre of the width of a shape. */
ls2d_status ls2d_explosion_init(ls2d_fx x, ls2d_fx y, ls2d_fx impulse, ls2d_explosion *explosion);

/* ---- Contents of a world ---- */

/* Properties of a body. */
ls2d_status ls2d_body_get(uint32_t world, ls2d_body id, ls2d_body_info *info);

/* All bodies in slot order. */
ls2d_status ls2d_world_bodies(uint32_t world, ls2d_body *bodies, size_t capacity, size_t *count);

/* Poses of all bodies in slot order. */
ls2d_status ls2d_world_poses(uint32_t world, ls2d_pose *poses, size_t capacity, size_t *count);

/* Shapes of a body in order of attachment. */
ls2d_status ls2d_body_shapes(uint32_t world, ls2d_body id, ls2d_shape *shapes, size_t capacity, size_t *count);

/* Joints of a body in slot order. */
ls2d_status ls2d_body_joints(uint32_t world, ls2d_body id, ls2d_joint *joints, size_t capacity, size_t *count);

/* Name of a body: 16 bytes, padded with zeros. */
ls2d_status ls2d_body_name(uint32_t world, ls2d_body id, uint8_t *name);

/* Velocity in m/s of a body at a point of the world in metres. */
ls2d_status ls2d_body_velocity_at(uint32_t world, ls2d_body id, ls2d_fx x, ls2d_fx y, ls2d_vec2 *velocity);

/* Definition of a shape, and handle of its body. Each pointer to a result may be null. */
ls2d_status ls2d_shape_get(uint32_t world, ls2d_shape id, ls2d_shape_def *def, ls2d_body *owner);

/* The fat AABB of a shape: its axis-aligned bounding box in the world with a margin, in metres. */
ls2d_status ls2d_shape_box(uint32_t world, ls2d_shape id, ls2d_aabb *area);

/* Shapes that a sensor overlaps, in slot order. */
ls2d_status ls2d_sensor_overlaps(uint32_t world, ls2d_shape id, ls2d_shape *shapes, size_t capacity, size_t *count);

/* All joints in slot order. */
ls2d_status ls2d_world_joints(uint32_t world, ls2d_joint *joints, size_t capacity, size_t *count);

/* Definition of a joint. */
ls2d_status ls2d_joint_get(uint32_t world, ls2d_joint id, ls2d_joint_def *def);

/* The anchors of a joint in the world, in metres. */
ls2d_status ls2d_joint_anchors(uint32_t world, ls2d_joint id, ls2d_vec2 *a, ls2d_vec2 *b);

/* Angle of the joint's frame on B relative to its frame on A in rad, counter-clockwise, including whole turns. */
ls2d_status ls2d_joint_angle(uint32_t world, ls2d_joint id, ls2d_fx *angle);

/* Force in N that a joint exerted on body B in the last sub-step, and torque in N m about B's anchor. */
ls2d_status ls2d_joint_force(uint32_t world, ls2d_joint id, ls2d_vec2 *force, ls2d_fx *torque);

/* Copies the definition of a joint, and sets its anchors and angles for the current poses of its bodies: both
 * anchors are at the point `anchor` of the world, in metres. The x axes of the joint's frames have the direction
 * `axis` in the world; a zero vector stands for the x axis. A gear, rack or pulley is adapted so that it has no
 * position error. */
ls2d_status ls2d_joint_at(uint32_t world, const ls2d_joint_def *from, const ls2d_vec2 *anchor, const ls2d_vec2 *axis, ls2d_joint_def *def);

/* ---- Drawing ---- */

/* Poses of all enabled bodies in slot order, for drawing. A pose has five numbers: handle, x and y in metres,
 * angle in rad, and 1 if the body is awake, otherwise 0. `capacity` and `count` are numbers of `double`s. */
ls2d_status ls2d_draw_poses(uint32_t world, double *rows, size_t capacity, size_t *count);

/* ---- Events of the last tick ---- */

/* Bodies that moved or fell asleep, in slot order, with their poses. */
ls2d_status ls2d_events_moved(uint32_t world, ls2d_pose *events, size_t capacity, size_t *count);

/* Pairs of shapes that began to touch, sorted by shape A, then by shape B. */
ls2d_status ls2d_events_contact_begin(uint32_t world, ls2d_contact_event *events, size_t capacity, size_t *count);

/* Pairs of shapes that ceased to touch, sorted by shape A, then by shape B. */
ls2d_status ls2d_events_contact_end(uint32_t world, ls2d_contact_event *events, size_t capacity, size_t *count);

/* Pairs of shapes that hit each other at the world's `hit_speed` or faster, if one of them has
 * `LS2D_SHAPE_HIT_EVENTS`. Sorted by shape A, then by shape B. */
ls2d_status ls2d_events_hits(uint32_t world, ls2d_hit_event *events, size_t capacity, size_t *count);

/* Shapes that began to overlap a sensor, sorted by `fraction`. */
ls2d_status ls2d_events_sensor_begin(uint32_t world, ls2d_sensor_event *events, size_t capacity, size_t *count);

/* Shapes that ceased to overlap a sensor, sorted by `fraction`. */
ls2d_status ls2d_events_sensor_end(uint32_t world, ls2d_sensor_event *events, size_t capacity, size_t *count);

/* Joints whose force or torque exceeded its threshold in the last sub-step of the tick, in slot order. */
ls2d_status ls2d_events_joints(uint32_t world, ls2d_joint_event *events, size_t capacity, size_t *count);

/* ---- Queries ---- */

/* Sets the defaults of a query filter, with which a query sees all shapes except sensors. */
ls2d_status ls2d_query_filter_init(ls2d_query_filter *filter);

/* Sets the defaults of a probe with a shape of the given kind, at the origin. The caller sets the geometry. */
ls2d_status ls2d_probe_init(uint32_t kind, ls2d_probe *probe);

/* The first shape that a ray meets. The ray starts at the point (`x`, `y`) of the world and has the length and
 * direction of the vector (`along_x`, `along_y`), in metres. `LS2D_NONE` if there is no hit. */
ls2d_status ls2d_cast_ray(uint32_t world, ls2d_fx x, ls2d_fx y, ls2d_fx along_x, ls2d_fx along_y, const ls2d_query_filter *filter, ls2d_ray_hit *hit);

/* Every shape that a ray meets, in order along the ray. The ray is given as in `ls2d_cast_ray`. */
ls2d_status ls2d_cast_ray_all(uint32_t world, ls2d_fx x, ls2d_fx y, ls2d_fx along_x, ls2d_fx along_y, const ls2d_query_filter *filter, ls2d_ray_hit *hits, size_t capacity, size_t *count);

/* The first shape that a probe meets when it moves by the vector (`along_x`, `along_y`), in metres. `LS2D_NONE` if
 * there is no hit. */
ls2d_status ls2d_cast_shape(uint32_t world, const ls2d_probe *probe, ls2d_fx along_x, ls2d_fx along_y, const ls2d_query_filter *filter, ls2d_cast_hit *hit);

/* Shapes that overlap a probe, in slot order. */
ls2d_status ls2d_overlap_shape(uint32_t world, const ls2d_probe *probe, const ls2d_query_filter *filter, ls2d_shape *shapes, size_t capacity, size_t *count);

/* Shapes that overlap a box, in slot order. */
ls2d_status ls2d_overlap_box(uint32_t world, const ls2d_aabb *area, const ls2d_query_filter *filter, ls2d_shape *shapes, size_t capacity, size_t *count);

/* Shapes that contain a point, in slot order. */
ls2d_status ls2d_overlap_point(uint32_t world, ls2d_fx x, ls2d_fx y, const ls2d_query_filter *filter, ls2d_shape *shapes, size_t capacity, size_t *count);

/* The shape nearest to the point (`x`, `y`) of the world, in metres. `LS2D_NONE` if no shape is at most `within`
 * metres away. */
ls2d_status ls2d_closest(uint32_t world, ls2d_fx x, ls2d_fx y, ls2d_fx within, const ls2d_query_filter *filter, ls2d_closest_point *closest);

/* Distance between two shapes in metres, negative if they overlap. `LS2D_NONE` if one of the shapes is disabled or
 * not in the world. */
ls2d_status ls2d_shape_distance(uint32_t world, ls2d_shape a, ls2d_shape b, ls2d_fx *distance);

/* ---- Characters ---- */

/* Sets the defaults of a character with a shape of the given kind: it stands on slopes up to 45 degrees, climbs no
 * steps, and follows ground that descends by up to 0.1 m in a tick. The caller sets the geometry. */
ls2d_status ls2d_mover_init(uint32_t kind, ls2d_mover *mover);

/* Sets the state of a character at rest in the air, at a position in metres. */
ls2d_status ls2d_mover_state_init(ls2d_fx x, ls2d_fx y, ls2d_mover_state *state);

/* Moves a character for one tick at its velocity among the shapes that a filter accepts. The game adds gravity to
 * the velocity. `from` and `state` may point to the same struct. Writes the new state to `state`, and the surfaces
 * to `met`, in the order in which the character meets them. If `met` is too short, the state is written
 * nevertheless. */
ls2d_status ls2d_move_character(uint32_t world, const ls2d_mover *mover, const ls2d_mover_state *from, const ls2d_query_filter *filter, ls2d_mover_state *state, ls2d_mover_plane *met, size_t capacity, size_t *count);

/* ---- Snapshots ---- */

/* Saves the state of a world into a new snapshot. */
ls2d_status ls2d_world_save(uint32_t world, uint32_t *snapshot);

/* Saves a world into an existing snapshot, whose memory is reused. */
ls2d_status ls2d_world_save_into(uint32_t world, uint32_t snapshot);

/* Restores a world to a saved state. */
ls2d_status ls2d_world_restore(uint32_t world, uint32_t snapshot);

/* Hash of a saved state. */
ls2d_status ls2d_snapshot_hash(uint32_t snapshot, ls2d_hash *hash);

/* Encodes a world as bytes. */
ls2d_status ls2d_world_encode(uint32_t world, uint32_t *bytes);

/* Makes a world from encoded bytes. The bytes may come from an untrusted source. */
ls2d_status ls2d_world_decode(const uint8_t *data, size_t size, uint32_t *world);

/* ---- Replays of worlds ---- */

/* Sets the default limits of a replay, which allow a day of play at 60 ticks per second. With these limits, a
 * malicious file can take hours to verify: a server should set narrower limits. */
ls2d_status ls2d_limits_init(ls2d_limits *limits);

/* Creates a world, sets it up with the list `commands`, and starts recording it, with a checkpoint every
 * `interval` ticks. A null `config` stands for the default settings. */
ls2d_status ls2d_recording_new(const ls2d_config *config, uint32_t commands, uint32_t interval, uint32_t *recording);

/* Executes and empties a list of commands, and advances the recorded world by one tick. Skips commands that the
 * world refuses. */
ls2d_status ls2d_recording_step(uint32_t recording, uint32_t commands);

/* Makes a copy of the recorded world, to draw and query it. */
ls2d_status ls2d_recording_world(uint32_t recording, uint32_t *world);

/* Returns the bytes finished since the last call, which the caller appends to the file. */
ls2d_status ls2d_recording_take(uint32_t recording, uint32_t *bytes);

/* Ends a recording, and returns the remaining bytes. */
ls2d_status ls2d_recording_finish(uint32_t recording, uint32_t *bytes);

/* Verifies a replay of a world. The replay may come from an untrusted source. A null `limits` stands for the
 * default limits. `ls2d_last_error` returns the verdict in words. */
ls2d_status ls2d_replay_verify(const uint8_t *data, size_t size, const ls2d_limits *limits, ls2d_verdict *verdict);

/* ---- Timelines of replays of worlds ---- */

/* Opens a replay of a world for seeking to any of its ticks. The replay may come from an untrusted source. Tick t
 * is the state after t ticks. A null `limits` stands for the default limits. If the replay cannot be played, its
 * verdict is written, and the result is `LS2D_RECORD`. Other failures write no verdict. */
ls2d_status ls2d_timeline_open(const uint8_t *data, size_t size, const ls2d_limits *limits, uint32_t *timeline, ls2d_verdict *verdict);

/* The current tick, and the number of ticks. Each pointer may be null. */
ls2d_status ls2d_timeline_ticks(uint32_t timeline, uint64_t *tick, uint64_t *ticks);

/* Goes to a tick. If the replay cannot be played up to this tick (a checkpoint differs, inputs are not valid, or a
 * limit is exceeded), the result is `LS2D_RECORD`, and the timeline stays at the last tick played. Later seeks to
 * the tick at which playing failed, or beyond it, fail without moving. Earlier ticks remain reachable. */
ls2d_status ls2d_timeline_seek(uint32_t timeline, uint64_t tick);

/* Goes forward by a tick. `LS2D_NONE` at the end. */
ls2d_status ls2d_timeline_step(uint32_t timeline);

/* Goes back by a tick. `LS2D_NONE` at the start. */
ls2d_status ls2d_timeline_step_back(uint32_t timeline);

/* Makes a copy of the world at the current tick, to draw and query it. */
ls2d_status ls2d_timeline_world(uint32_t timeline, uint32_t *world);

/* ---- Recorders of games with rules of their own ---- */

/* Starts a recorder for a game with its own rules. `rules` is the name of the rules in UTF-8, `setup` the data
 * from which the game makes its first state, and `start` the hash of that state. There is a checkpoint every
 * `interval` ticks. */
ls2d_status ls2d_recorder_new(const uint8_t *rules, size_t rules_length, uint32_t rules_version, uint32_t players, uint32_t tick_rate, uint32_t input_bytes, const uint8_t *setup, size_t setup_size, const ls2d_hash *start, uint32_t interval, uint32_t *recorder);

/* Records the inputs of the next tick, which cannot be changed later: `input_bytes` bytes for each player, in the
 * order of the players. `absent` has a bit for each absent player; the input of such a player has to be zeros.
 * Writes 1 to `due`, unless this pointer is null, if the caller then has to pass the hash of the state after this
 * tick to `ls2d_recorder_checkpoint`; otherwise 0. */
ls2d_status ls2d_recorder_record(uint32_t recorder, const uint8_t *inputs, size_t size, uint64_t absent, uint32_t *due);

/* Passes the hash of the state after the last recorded tick, for the checkpoint that `ls2d_recorder_record` has
 * announced as due. The call has no effect if no checkpoint is due. */
ls2d_status ls2d_recorder_checkpoint(uint32_t recorder, const ls2d_hash *hash);

/* Returns the bytes finished since the last call, which the caller appends to the file. */
ls2d_status ls2d_recorder_take(uint32_t recorder, uint32_t *bytes);

/* Adds a result of the game, such as a score: a name of 1 to 64 bytes of UTF-8, and a number. A replay has at most
 * 256 results, and their names must differ. The results can be read without playing the replay. */
ls2d_status ls2d_recorder_claim(uint32_t recorder, const uint8_t *name, size_t name_length, int64_t number);

/* Returns the bytes that `ls2d_recorder_finish` would return now, and goes on with the recording. After the bytes
 * taken so far, they complete a replay of the ticks so far, whose last state has the hash `hash`. */
ls2d_status ls2d_recorder_so_far(uint32_t recorder, const ls2d_hash *hash, uint32_t *bytes);

/* Ends a replay with the hash of the last state, and returns the remaining bytes. */
ls2d_status ls2d_recorder_finish(uint32_t recorder, const ls2d_hash *hash, uint32_t *bytes);

/* ---- Replays of games with rules of their own ---- */

/* Opens a replay of a game with its own rules. The replay may come from an untrusted source. If the replay cannot
 * be played, its verdict is written, the handle is 0, and the result is `LS2D_RECORD`. Other failures write no
 * verdict. */
ls2d_status ls2d_replay_open(const uint8_t *data, size_t size, const ls2d_limits *limits, uint32_t *replay, ls2d_verdict *verdict);

/* Name of the rules as a bytes object, and numbers that describe the replay. Each pointer except `rules` may be
 * null. */
ls2d_status ls2d_replay_rules(uint32_t replay, uint32_t *rules, uint32_t *rules_version, uint32_t *players, uint32_t *tick_rate, uint32_t *input_bytes, uint64_t *ticks);

/* The setup of the game as bytes. */
ls2d_status ls2d_replay_setup(uint32_t replay, uint32_t *bytes);

/* Name (a bytes object) and number of a result in the file, such as a score. Results are in ascending order of
 * their names, and are verified only if the verdict is `LS2D_MATCH`. `LS2D_NONE` if there are no more results. */
ls2d_status ls2d_replay_claim_at(uint32_t replay, uint32_t index, uint32_t *name, int64_t *number);

/* Writes the inputs of all players for the next tick to `inputs`, and, unless `absent` is null, a bit for each
 * absent player to `absent`. Returns `LS2D_NONE` at the end. */
ls2d_status ls2d_replay_next(uint32_t replay, uint8_t *inputs, size_t capacity, size_t *size, uint64_t *absent);

/* Compares the hash of the game's state with the file. Call it before the first tick and after each tick, or,
 * while seeking, for each `LS2D_REQUEST_CHECKSUM`. */
ls2d_status ls2d_replay_check(uint32_t replay, const ls2d_hash *hash);

/* Adds a result of the game that the host has simulated. `ls2d_replay_verdict` compares the results with those in
 * the file. */
ls2d_status ls2d_replay_claim(uint32_t replay, const uint8_t *name, size_t name_length, int64_t number);

/* The verdict after the last tick, or after a checkpoint that differs. `hash` is the hash of the current state. */
ls2d_status ls2d_replay_verdict(uint32_t replay, const ls2d_hash *hash, ls2d_verdict *verdict);

/* ---- Timelines of replays of games with rules of their own ---- */

/* Starts seeking to the state after `tick` ticks. `ls2d_replay_next_request` then returns the requests that lead
 * to this state. Before the first request, the game has to be in its first state. */
ls2d_status ls2d_replay_seek(uint32_t replay, uint64_t tick);

/* The next request of a seek. Save, load and advance are fulfilled as in a match. To fulfil
 * `LS2D_REQUEST_CHECKSUM`, pass the hash of the current state to `ls2d_replay_check`. Returns `LS2D_NONE` when the
 * tick of `ls2d_replay_seek` is reached, and `LS2D_RECORD` if the game has diverged from the file at or before
 * this tick. */
ls2d_status ls2d_replay_next_request(uint32_t replay, ls2d_request *request, uint8_t *inputs, size_t capacity, size_t *size);

/* Sets the interval in ticks at which seeking saves the state. The default is 60 ticks, or a 256th of the ticks of
 * the replay if that is more. */
ls2d_status ls2d_replay_set_interval(uint32_t replay, uint32_t ticks);

/* ---- Matches ---- */

/* Sets the defaults of a match: lockstep at 60 ticks per second, inputs of one byte, and a start as soon as two
 * seats (or the only one) are taken. The caller sets `peer`, `key` and `secret` to random numbers. */
ls2d_status ls2d_match_config_init(uint32_t seats, ls2d_match_config *config);

/* Opens a match. `offer` is data of at most 512 bytes that all peers have to agree on, such as rules and setup. */
ls2d_status ls2d_match_host(const ls2d_match_config *config, const uint8_t *offer, size_t offer_size, uint32_t *handle);

/* Joins a match through the participant at the address `contact`, as a spectator if `own_seats` is 0. */
ls2d_status ls2d_match_join(const ls2d_match_config *config, const uint8_t *offer, size_t offer_size, const uint8_t *contact, size_t contact_size, uint32_t *handle);

/* Requests to join a match through the participant at the address `contact`. Discards a match in progress, with
 * its requests and events. Packets that were not fetched are still sent. */
ls2d_status ls2d_match_ask(uint32_t handle, const uint8_t *contact, size_t contact_size);

/* Processes a packet that arrived from the address `from`. `now` is a time in microseconds that never decreases. */
ls2d_status ls2d_match_receive(uint32_t handle, uint64_t now, const uint8_t *from, size_t from_size, const uint8_t *packet, size_t size);

/* Advances the match to the time `now`. Call it every few milliseconds and after packets have arrived. */
ls2d_status ls2d_match_update(uint32_t handle, uint64_t now);

/* Writes 1 if `ls2d_match_advance` has to be called now, otherwise 0. */
ls2d_status ls2d_match_is_due(uint32_t handle, uint64_t now, uint32_t *due);

/* Issues the inputs of this peer's seats, in order of the seats, and plays a tick if possible: the next requests
 * then contain `LS2D_REQUEST_ADVANCE`. Writes 1 to `issued` if the inputs were issued; otherwise the same inputs
 * may be passed again. Issued inputs count for one tick, so clear recorded key presses when the inputs were
 * issued. While the input delay grows, `ls2d_match_is_due` remains 1, and each further call takes the inputs of
 * one more tick before the next tick is played. For a peer without seats, `size` is 0. */
ls2d_status ls2d_match_advance(uint32_t handle, uint64_t now, const uint8_t *inputs, size_t size, uint32_t *issued);

/* The next request. Fulfil requests in order before the next `ls2d_match_advance`. For `LS2D_REQUEST_ADVANCE`,
 * writes the inputs of all seats to `inputs`. `LS2D_NONE` if there is no request. */
ls2d_status ls2d_match_next_request(uint32_t handle, ls2d_request *request, uint8_t *inputs, size_t capacity, size_t *size);

/* Passes the hash that `LS2D_REQUEST_CHECKSUM` requests. */
ls2d_status ls2d_match_report_hash(uint32_t handle, uint32_t tick, const ls2d_hash *hash);

/* The next packet, of at most 1200 bytes, and its destination, an address of at most 32 bytes. `LS2D_NONE` if
 * there is no packet. */
ls2d_status ls2d_match_next_packet(uint32_t handle, uint8_t *to, size_t to_capacity, size_t *to_size, uint8_t *packet, size_t capacity, size_t *size);

/* The next event. `LS2D_NONE` if there is no event. */
ls2d_status ls2d_match_next_event(uint32_t handle, ls2d_match_event *event);

/* Writes 1 if a joining peer waits for its initial state, otherwise 0. */
ls2d_status ls2d_match_wants_state(uint32_t handle, uint32_t *wants);

/* Offers the encoded state after `tick` final ticks to peers that join. */
ls2d_status ls2d_match_offer_state(uint32_t handle, uint32_t tick, const uint8_t *state, size_t size);

/* Status of the match: one of the `LS2D_MATCH_` constants. */
ls2d_status ls2d_match_status(uint32_t handle, uint32_t *status);

/* Numbers of ticks: `played` ticks were played, `last` ticks have final inputs, and `confirmed` ticks were played
 * with final inputs. Each pointer may be null. */
ls2d_status ls2d_match_ticks(uint32_t handle, uint32_t *played, uint32_t *last, uint32_t *confirmed);

/* Writes the bit mask of this peer's own seats. */
ls2d_status ls2d_match_seats(uint32_t handle, uint64_t *seats);

/* The final inputs of all seats for a tick. `LS2D_NONE` if they are not final yet or no longer stored. */
ls2d_status ls2d_match_final_inputs(uint32_t handle, uint32_t tick, uint8_t *inputs, size_t capacity, size_t *size, uint64_t *absent);

/* Delay of this peer's inputs in ticks. For the link to `peer`: smoothed round-trip time in microseconds, and loss
 * in thousandths. Each pointer may be null. `LS2D_NONE` if there is no such peer. */
ls2d_status ls2d_match_link(uint32_t handle, uint32_t peer, uint32_t *delay, uint64_t *round_trip, uint32_t *loss);

/* Leaves the match. Call `ls2d_match_update` until the status is `LS2D_MATCH_CLOSED`, to inform the other peers. */
ls2d_status ls2d_match_leave(uint32_t handle);

/* Requests an end of the match after `ticks` ticks. The request is sent two seconds before the end. Until a
 * majority has decided on the end, other peers can get seats. The request of one peer with a vote (a player with a
 * seat, or a dedicated server) suffices and cannot be withdrawn, so base it on the state of a confirmed tick
 * (`ls2d_match_ticks`). Without a vote, the request has no effect until this peer gets a seat, and none if its tick
 * has passed by then. */
ls2d_status ls2d_match_end_at(uint32_t handle, uint32_t ticks);

/* Tells the other peers that this peer requests a pause (1) or withdraws its request (0). The match plays on:
 * during a pause, the program of each peer calls `ls2d_match_update` and does not call `ls2d_match_advance`. */
ls2d_status ls2d_match_pause(uint32_t handle, uint32_t paused);

/* Votes for going on without a missing peer. */
ls2d_status ls2d_match_go_on_without(uint32_t handle, uint32_t peer);

/* Votes for removing the player with this key. The vote counts only while this peer is a voter. */
ls2d_status ls2d_match_kick(uint32_t handle, uint64_t key);

/* Sets the number of ticks that may be played with guessed inputs; 0 is lockstep. */
ls2d_status ls2d_match_set_guess(uint32_t handle, uint32_t ticks);

/* ---- Mathematics ---- */

/* Reads a decimal number such as `-1.25`, rounded to nearest. */
ls2d_status ls2d_fx_parse(const uint8_t *text, size_t length, ls2d_fx *number);

/* Writes a number as exact decimal text, and the length of the text in bytes. */
ls2d_status ls2d_fx_format(ls2d_fx number, uint8_t *text, size_t capacity, size_t *length);

/* `numerator / denominator`, rounded to nearest, saturating. `LS2D_NUMBER` if `denominator` is 0. */
ls2d_status ls2d_fx_ratio(int64_t numerator, int64_t denominator, ls2d_fx *number);

/* `a + b`, saturating. */
ls2d_fx ls2d_fx_add(ls2d_fx a, ls2d_fx b);

/* `a - b`, saturating. */
ls2d_fx ls2d_fx_sub(ls2d_fx a, ls2d_fx b);

/* `a b`, rounded to nearest, saturating. */
ls2d_fx ls2d_fx_mul(ls2d_fx a, ls2d_fx b);

/* `a / b`, rounded to nearest, saturating. `LS2D_NUMBER` if `b` is 0. */
ls2d_status ls2d_fx_div(ls2d_fx a, ls2d_fx b, ls2d_fx *number);

/* Square root, rounded to nearest. `LS2D_NUMBER` for a negative number. */
ls2d_status ls2d_fx_sqrt(ls2d_fx a, ls2d_fx *number);

/* Length of a vector, rounded to nearest, saturating. */
ls2d_fx ls2d_fx_hypot(ls2d_fx x, ls2d_fx y);

/* `a.x b.x + a.y b.y`, rounded once, saturating. */
ls2d_fx ls2d_vec2_dot(ls2d_fx ax, ls2d_fx ay, ls2d_fx bx, ls2d_fx by);

/* `a.x b.y - a.y b.x`, rounded once, saturating. */
ls2d_fx ls2d_vec2_cross(ls2d_fx ax, ls2d_fx ay, ls2d_fx bx, ls2d_fx by);

/* The direction of a vector as a unit vector. `LS2D_NUMBER` for the zero vector. */
ls2d_status ls2d_vec2_normalize(ls2d_fx x, ls2d_fx y, ls2d_vec2 *unit);

/* A vector turned by an angle. */
ls2d_status ls2d_vec2_rotate(ls2d_fx x, ls2d_fx y, ls2d_angle angle, ls2d_vec2 *turned);

/* Sine of an angle. */
ls2d_fx ls2d_angle_sin(ls2d_angle angle);

/* Cosine of an angle. */
ls2d_fx ls2d_angle_cos(ls2d_angle angle);

/* Angle of a vector from the x axis; 0 for the zero vector. */
ls2d_angle ls2d_angle_of(ls2d_fx x, ls2d_fx y);

/* Converts a number of degrees to an angle. */
ls2d_angle ls2d_angle_from_degrees(ls2d_fx degrees);

/* Converts a number of radians to an angle. */
ls2d_angle ls2d_angle_from_radians(ls2d_fx radians);

/* Converts an angle to degrees, above -180 and up to 180. */
ls2d_fx ls2d_angle_to_degrees(ls2d_angle angle);

/* Converts an angle to radians, above -pi and up to pi. */
ls2d_fx ls2d_angle_to_radians(ls2d_angle angle);

/* Makes a random number generator, which the game keeps as part of its state. */
ls2d_status ls2d_rng_init(uint64_t seed, ls2d_rng *rng);

/* Draws a uniform number below `bound`; 0 if `bound` is 0. `from` is the generator before the draw, `rng` the
 * generator after it. Both may be the same struct. */
ls2d_status ls2d_rng_below(const ls2d_rng *from, ls2d_rng *rng, uint32_t bound, uint32_t *number);

/* Draws a uniform number from `low` to below `high`; `low` if the range is empty. `from` is the generator before
 * the draw, `rng` the generator after it. Both may be the same struct. */
ls2d_status ls2d_rng_range(const ls2d_rng *from, ls2d_rng *rng, ls2d_fx low, ls2d_fx high, ls2d_fx *number);

/* Hash of bytes, for the state hash of a game. */
ls2d_status ls2d_hash_bytes(const uint8_t *data, size_t size, ls2d_hash *hash);

#ifdef __cplusplus
}
#endif

#endif
