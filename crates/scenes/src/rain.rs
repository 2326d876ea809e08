//! Ragdolls rain on five floors and are removed again.

use alloc::vec;
use alloc::vec::Vec;

use super::Scene;
use super::builder::{build, rectangle};
use super::ragdoll::BONES;
use lockstep2d::body::{BodyDef, BodyId, WorldError};
use lockstep2d::fx;
use lockstep2d::lockstep::Sandbox;
use lockstep2d::math::{Angle, Fx, Vec2};
use lockstep2d::world::{BodyPose, Command, Config};

/// Maximum number of columns. A column has [`GROUP`] ragdolls side by side above each floor.
const COLUMNS: u64 = 40;
const FLOORS: u32 = 5;
/// Number of ragdolls of a column that fall on each floor.
const GROUP: u32 = 5;
/// Number of ticks between two new columns.
const INTERVAL: u64 = 8;

pub(super) const RAIN: Scene = Scene {
    name: "rain",
    about: "every 8 ticks 25 ragdolls are added, and from the 41st time on as many old ones are removed",
    ticks: 1000,
    golden_ticks: 60,
    setup: |_| {
        build(Config::default(), |scene| {
            let tile = rectangle(fx!(0.25), fx!(0.25))?;
            let mut floors = Vec::new();
            for floor in 0..FLOORS {
                let place = |j: i32| (Fx::from_num(j) / 2 - fx!(125), Fx::from_num(45 * floor));
                floors.extend((0..=500).map(place).map(|(x, y)| tile.offset((x, y))));
            }
            scene.spawn(BodyDef::fixed(), &floors)?;
            for command in announce(0)? {
                scene.command(command)?;
            }
            Ok(())
        })
    },
    script: |tick, game| match tick % INTERVAL {
        0 => release(column_at(tick / INTERVAL), game),
        7 => announce(column_at(tick / INTERVAL + 1)).expect("the scenes of this crate are valid"),
        _ => vec![],
    },
};

/// Numbers of the ragdolls of a column. The ragdolls above each other, one on each floor, have the same number.
const fn ragdolls(column: u32) -> core::ops::Range<u32> {
    column * GROUP..(column + 1) * GROUP
}

/// User data of a bone: a value of at least 1, from the number of the ragdoll and the index of the bone. The user data
/// of the floor is 0.
fn mark(ragdoll: u32, bone: usize) -> u64 {
    u64::from(ragdoll) * BONES.len() as u64 + bone as u64 + 1
}

/// Spawns the bodies of the ragdolls of a column, disabled. One tick later, when their handles are known, [`release`]
/// joins and enables them.
fn announce(column: u32) -> Result<Vec<Command>, WorldError> {
    let mut commands = Vec::new();
    for (ragdoll, i) in ragdolls(column).zip(0..) {
        let x = fx!(-121.875) + fx!(6.25).saturating_mul_int(column.into()) + Fx::from_num(i) / 2;
        let group = i32::try_from(ragdoll + 1).expect("a few hundred");
        for (index, bone) in BONES.iter().enumerate() {
            let pose = |floor: u32| BodyPose {
                position: bone.position(Vec2::new(x, Fx::from_num(40 + 45 * floor))),
                angle: Angle::ZERO,
            };
            let body = bone.body().disabled().user_data(mark(ragdoll, index));
            let poses = (0..FLOORS).map(pose).collect();
            commands.push(Command::SpawnEach { body, shapes: bone.shapes(group)?, poses });
        }
    }
    Ok(commands)
}

/// Removes the previous ragdolls of this column, and joins and enables the new ones.
fn release(column: u32, game: &Sandbox) -> Vec<Command> {
    let marks = mark(column * GROUP, 0)..mark((column + 1) * GROUP, 0);
    let of_column = game.world().bodies().filter(|(_, body)| marks.contains(&body.user_data()));
    let (old, new): (Vec<_>, Vec<_>) = of_column.partition(|(_, body)| body.is_enabled());
    let mut commands: Vec<_> = old.into_iter().map(|(body, _)| Command::Despawn { body }).collect();

    let mut waiting: Vec<_> =
        new.into_iter().map(|(id, body)| (body.user_data(), body.position().y, id)).collect();
    waiting.sort_unstable();
    let bodies: Vec<BodyId> = waiting.into_iter().map(|(_, _, id)| id).collect();
    // Bodies with the same ragdoll number and bone are adjacent, ordered from the lowest floor up.
    let floors = FLOORS as usize;
    for (index, bone) in BONES.iter().enumerate().skip(1) {
        let mut ends = Vec::new();
        for group in bodies.chunks_exact(BONES.len() * floors) {
            let on_floors = |bone: usize| group[bone * floors..][..floors].iter().copied();
            ends.extend(on_floors(bone.parent).zip(on_floors(index)));
        }
        if let Some(&(parent, own)) = ends.first() {
            commands.push(Command::AddJointEach { joint: bone.joint(parent, own), ends });
        }
    }
    commands.extend(bodies.into_iter().map(|body| Command::Enable { body }));
    commands
}

fn column_at(round: u64) -> u32 {
    u32::try_from(round % COLUMNS).expect("a remainder")
}
