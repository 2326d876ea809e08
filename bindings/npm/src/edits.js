// Edits of a world, executed at once or collected in a list of commands.
import { array, fail, given, long, object, onlyKnown } from "./check.js";
import { bodyKind, writeBody, writeBodyAndShapes, writeJoint, writeShape } from "./definitions.js";
import { bitsOf, rawOf, vectorOf } from "./fx.js";
import { Handle, call, give, giveText, id, idAt, putRaw, scratch, sizeOf, takeBytes, u32, write } from "./library.js";

const SETTINGS = ["linearDamping", "angularDamping", "gravityScale", "sleepSpeed", "maySleep", "continuous", "lockX", "lockY",
    "lockRotation"];
const raws = (vector, what) => vectorOf(vector, what);

export class Edits extends Handle {
    /** Returns the handle; undefined for a list of commands. */
    spawn(options) {
        const { id: at, body, shapes, count } = writeBodyAndShapes(options);
        call("ls2d_spawn", this.handle, body, shapes, count, at);
        return this.added(at);
    }

    /** Returns the handles; undefined for a list of commands. */
    spawnEach(options, poses) {
        const placed = array(poses, "poses").map((pose, index) => {
            const { position, angle = 0 } = onlyKnown(pose, ["position", "angle"], `pose ${index}`);
            return { position: given(position, `the position of pose ${index}`), angle };
        });
        const size = sizeOf("pose");
        const room = placed.length * (size + 8);
        const { rest, body, shapes, count } = writeBodyAndShapes(options, room);
        const ids = rest + placed.length * size;
        placed.forEach((pose, index) => write("pose", rest + index * size, pose));
        call("ls2d_spawn_each", this.handle, body, shapes, count, rest, placed.length, ids, placed.length);
        return this.allAdded(ids, placed.length);
    }

    added(at) {
        return idAt(at);
    }

    allAdded(at, count) {
        return Array.from({ length: count }, (_, index) => idAt(at + 8 * index));
    }

    despawn(body) {
        call("ls2d_despawn", this.handle, id(body));
    }

    addShape(body, shape) {
        const at = scratch(8 + sizeOf("shape_def"));
        writeShape(at + 8, shape);
        call("ls2d_add_shape", this.handle, id(body), at + 8, at);
        return this.added(at);
    }

    removeShape(shape) {
        call("ls2d_remove_shape", this.handle, id(shape, "a shape"));
    }

    setShape(shape, definition) {
        const at = scratch(sizeOf("shape_def"));
        writeShape(at, definition);
        call("ls2d_set_shape", this.handle, id(shape, "a shape"), at);
    }

    addJoint(options) {
        const { anchor, axis, ...definition } = object(options, "a joint");
        const place = anchor === undefined ? undefined : [...raws(anchor, "anchor"), ...raws(axis ?? [0, 0], "axis")];
        if (options.a === undefined || options.b === undefined) {
            fail("a joint connects two bodies, `a` and `b`");
        }
        if (anchor !== undefined) {
            const frame = ["anchorA", "anchorB", "angleA", "angleB"].find((name) => options[name] !== undefined);
            if (frame !== undefined) {
                fail(`a joint has either \`anchor\` or \`${frame}\`, because \`anchor\` sets \`${frame}\``);
            }
        } else if (axis !== undefined) {
            fail("`axis` of a joint needs `anchor`");
        }
        const at = scratch(48 + sizeOf("joint_def"));
        writeJoint(at + 48, definition, anchor !== undefined);
        if (place !== undefined) {
            this.place(at, place);
        }
        call("ls2d_add_joint", this.handle, at + 48, at);
        return this.added(at);
    }

    /** Returns the handles; undefined for a list of commands. */
    addJointEach(options, pairs) {
        const connected = array(pairs, "pairs").map((pair, index) => {
            const bodies = array(pair, `pair ${index}`);
            return bodies.length === 2 ? bodies.map((body) => id(body)) : fail(`pair ${index} has 2 bodies, and not ${bodies.length}`);
        });
        const [size, count] = [sizeOf("joint_def"), connected.length];
        const at = scratch(size + 24 * count);
        const ids = at + size + 16 * count;
        writeJoint(at, options);
        connected.flat().forEach((body, index) => putRaw(at + size + 8 * index, body));
        call("ls2d_add_joint_each", this.handle, at, at + size, 2 * count, ids, count);
        return this.allAdded(ids, count);
    }

    /** Sets the frames in the joint definition at the address `at + 48`. `numbers` are the coordinates of the anchor
     * and the axis in the world. */
    place(at, numbers) {
        numbers.forEach((raw, index) => putRaw(at + 8 + 8 * index, raw));
        call("ls2d_joint_at", this.handle, at + 48, at + 8, at + 24, at + 48);
    }

    removeJoint(joint) {
        call("ls2d_remove_joint", this.handle, id(joint, "a joint"));
    }

    setJoint(joint, options) {
        const at = scratch(sizeOf("joint_def"));
        writeJoint(at, options);
        call("ls2d_set_joint", this.handle, id(joint, "a joint"), at);
    }

    enableJoint(joint) {
        call("ls2d_enable_joint", this.handle, id(joint, "a joint"));
    }

    disableJoint(joint) {
        call("ls2d_disable_joint", this.handle, id(joint, "a joint"));
    }

    applyForce(body, force, point) {
        call("ls2d_apply_force", this.handle, id(body), ...raws(force, "force"), ...raws(point, "point"));
    }

    applyTorque(body, torque) {
        call("ls2d_apply_torque", this.handle, id(body), rawOf(torque, "torque"));
    }

    applyImpulse(body, impulse, point) {
        call("ls2d_apply_impulse", this.handle, id(body), ...raws(impulse, "impulse"), ...raws(point, "point"));
    }

    applyAngularImpulse(body, impulse) {
        call("ls2d_apply_angular_impulse", this.handle, id(body), rawOf(impulse, "impulse"));
    }

    setVelocity(body, velocity, angular = 0) {
        call("ls2d_set_velocity", this.handle, id(body), ...raws(velocity, "velocity"), rawOf(angular, "angular velocity"));
    }

    setTransform(body, position, angle = 0) {
        call("ls2d_set_transform", this.handle, id(body), ...raws(position, "position"), bitsOf(angle));
    }

    moveTo(body, position, angle = 0) {
        call("ls2d_move_to", this.handle, id(body), ...raws(position, "position"), bitsOf(angle));
    }

    setBody(body, options) {
        onlyKnown(options, SETTINGS, "`setBody`");
        const at = scratch(sizeOf("body_def"));
        writeBody(at, options);
        call("ls2d_set_body", this.handle, id(body), at);
    }

    setType(body, type) {
        call("ls2d_set_kind", this.handle, id(body), bodyKind(type));
    }

    setMass(body, mass) {
        const at = scratch(sizeOf("body_def"));
        writeBody(at, { mass });
        call("ls2d_set_mass", this.handle, id(body), at);
    }

    setUserData(body, data) {
        call("ls2d_set_user_data", this.handle, id(body), long(data, "the user data"));
    }

    setName(body, name) {
        const [at, length] = giveText(name);
        call("ls2d_set_name", this.handle, id(body), at + 64, length);
    }

    enable(body) {
        call("ls2d_enable", this.handle, id(body));
    }

    disable(body) {
        call("ls2d_disable", this.handle, id(body));
    }

    wake(body) {
        call("ls2d_wake", this.handle, id(body));
    }

    sleep(body) {
        call("ls2d_sleep", this.handle, id(body));
    }

    setGravity(gravity) {
        call("ls2d_set_gravity", this.handle, ...raws(gravity, "gravity"));
    }

    explode(options) {
        const { centre, impulse, radius, falloff, mask } =
            onlyKnown(options, ["centre", "impulse", "radius", "falloff", "mask"], "an explosion");
        const numbers = [...raws(centre, "centre"), rawOf(impulse, "impulse")];
        const at = scratch(sizeOf("explosion"));
        call("ls2d_explosion_init", ...numbers, at);
        write("explosion", at, { radius, falloff, mask });
        call("ls2d_explode", this.handle, at);
    }
}

export class Commands extends Edits {
    constructor() {
        const at = scratch(8);
        call("ls2d_commands_new", at);
        super(u32(at));
    }

    // What a list adds has no handles before a world executes the list.
    added() {
        return undefined;
    }

    allAdded() {
        return undefined;
    }

    place() {
        fail("a list of commands has no poses that `anchor` could refer to: use `anchorA` and `anchorB`");
    }

    get length() {
        const at = scratch(8);
        call("ls2d_commands_count", this.handle, at);
        return u32(at);
    }

    clear() {
        call("ls2d_commands_clear", this.handle);
    }

    toBytes() {
        const at = scratch(8);
        call("ls2d_commands_encode", this.handle, at);
        return takeBytes(u32(at));
    }

    fromBytes(bytes) {
        const at = give(bytes);
        call("ls2d_commands_decode", this.handle, at + 64, bytes.length);
        return this;
    }
}
