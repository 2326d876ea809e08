// Joints as objects, read from their structs.
import { C } from "./layout.js";
import { read } from "./library.js";

const KINDS = ["revolute", "prismatic", "distance", "weld", "wheel", "motor", "filter", "gear", "rack", "pulley"];

/** Reads a joint definition as the options of `addJoint`. */
export function readJoint(at) {
    const def = read("joint_def", at);
    const has = (bit, part) => ((def.flags & bit) === 0 ? {} : part);
    // The springs of a weld have no largest force.
    const pull = (hertz, dampingRatio, max) => ({ hertz, dampingRatio, ...(def.kind === C.WELD ? {} : { max }) });
    const threshold = {
        ...has(C.JOINT_THRESHOLD_FORCE, { force: def.thresholdForce }),
        ...has(C.JOINT_THRESHOLD_TORQUE, { torque: def.thresholdTorque }),
        ...has(C.JOINT_BREAKS, { breaks: true }),
    };
    return {
        type: KINDS[def.kind],
        a: def.bodyA,
        b: def.bodyB,
        anchorA: def.anchorA,
        anchorB: def.anchorB,
        angleA: def.angleA,
        angleB: def.angleB,
        collide: (def.flags & C.JOINT_COLLIDE) !== 0,
        enabled: (def.flags & C.JOINT_ENABLED) !== 0,
        userData: def.userData,
        ...has(C.JOINT_LIMIT, { limit: [def.limitLower, def.limitUpper] }),
        ...has(C.JOINT_MOTOR, { motor: { speed: def.motorSpeed, max: def.motorMax } }),
        ...has(C.JOINT_SPRING, { spring: { hertz: def.springHertz, dampingRatio: def.springDampingRatio, target: def.springTarget } }),
        ...has(C.JOINT_SPRING_FORCE, { springForce: [def.springForceLower, def.springForceUpper] }),
        ...has(C.JOINT_ROD, { rod: def.length }),
        ...has(C.JOINT_SOFTNESS, { softness: { hertz: def.hertz, dampingRatio: def.dampingRatio } }),
        ...(Object.keys(threshold).length === 0 ? {} : { threshold }),
        ...has(C.JOINT_LINEAR_MOTOR, { linearMotor: { velocity: def.linearVelocity, max: def.linearMotorMax } }),
        ...has(C.JOINT_LINEAR_SPRING, { linearSpring: pull(def.linearHertz, def.linearDampingRatio, def.linearMax) }),
        ...has(C.JOINT_ANGULAR_SPRING, { angularSpring: pull(def.angularHertz, def.angularDampingRatio, def.angularMax) }),
        ...(def.kind === C.GEAR ? { teeth: [def.teethA, def.teethB] } : {}),
        ...(def.kind === C.RACK ? { radius: def.radius } : {}),
        ...(def.kind === C.PULLEY ? { wheels: [def.wheelA, def.wheelB], length: def.length, ratio: def.ratio } : {}),
    };
}
