// The exports that both entry points share.
export { Lockstep2dError } from "./error.js";
export { Angle, Fx, degrees, fx, radians, turns } from "./fx.js";
export { loaded } from "./library.js";
export { box, capsule, chain, circle, hull, massOf, polygon, segment } from "./definitions.js";
export { decodeMoverState, encodeMoverState, moveCharacter } from "./character.js";
export { Commands } from "./edits.js";
export { Snapshot, World } from "./world.js";
export { Random, angleOf, cos, cross, dot, hashBytes, hypot, normalize, rotate, sin, sqrt } from "./maths.js";

import { library } from "./library.js";

export const semantics = () => library().ls2d_semantics();
export const objectCount = () => library().ls2d_object_count();
