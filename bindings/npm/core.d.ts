// lockstep2d/core: without replays and matches.
export {
    Angle, Commands, Fx, Lockstep2dError, Random, Snapshot, World, angleOf, box, capsule, chain, circle, cos, cross,
    decodeMoverState, degrees, dot, encodeMoverState, fx, hashBytes, hull, hypot, init, loaded, massOf, moveCharacter, normalize,
    objectCount, polygon, radians, rotate, segment, semantics, sin, sqrt, turns,
} from "./index.js";
export type {
    AreaOptions, BodyId, BodyInfo, BodyOptions, BodyPose, BodySettings, BodyType, Bytes, CastHit, ChainDef, ConfigInfo,
    ConfigOptions, ContactEvent, Edits, Events, Filter, Handle, InitOptions, JointId, JointInfo, JointOptions, MassOptions, Mixing,
    Moved, MoverOptions, MoverPlane, MoverState, Num, RayHit, Rotation, SensorEvent, ShapeDef, ShapeId, ShapeInfo, ShapeOptions, Spring, Vec, Vec2,
} from "./index.js";
