//! The rules of `examples/web` in Rust: a native player in a match with web pages.
//!
//! `cargo run -p lockstep2d-relay --example push -- ws://127.0.0.1:7010 CODE [--ticks 3000] [-o FILE]`
//!
//! The first player in the room opens the match. A bot provides the inputs. FILE is a replay of the sandbox, equal to
//! the replay that a web page records. A player who joins late writes no replay. The program prints a line of JSON when
//! it has entered the room, and one at the end. Exit codes: 0 the match has ended, 1 an error or a desync, 2 wrong
//! arguments.

use std::error::Error;
use std::path::PathBuf;
use std::thread;
use std::time::{Duration, SystemTime, UNIX_EPOCH};

use clap::Parser;
use lockstep2d::body::{BodyDef, BodyId, Geometry, Polygon, ShapeDef, WorldError};
use lockstep2d::fx;
use lockstep2d::hash::StateHash;
use lockstep2d::lockstep::{Game, RulesId, Sandbox, SandboxSetup, SetupError};
use lockstep2d::math::{Fx, Vec2};
use lockstep2d::peer::{Peer, PeerEvent, PeerIdentity, PeerOptions};
use lockstep2d::replay::{CHECKPOINT_INTERVAL, Limits, RawReplay, Recording};
use lockstep2d::session::{Event, Status};
use lockstep2d::world::{Command, Config, Snapshot, World};
use lockstep2d_relay::Relay;
use serde_json::json;

const SEATS: u8 = 4;
/// Time after which another member is asked, if the contact does not answer.
const CONTACT_PATIENCE: Duration = Duration::from_secs(2);

/// The game. Its whole state is the world: `players` never changes.
struct Push {
    world: World,
    players: Vec<BodyId>,
}

/// Commands that add the ground, the players and the crates.
fn setup() -> Result<Vec<Command>, WorldError> {
    let ground = ShapeDef::new(Polygon::rectangle(fx!(8), fx!(1))?).friction(fx!(0.8));
    let ball = ShapeDef::new(Geometry::circle(fx!(0.6))?).density(fx!(3));
    let crates = ShapeDef::new(Polygon::square(fx!(0.5))?);
    let at = |x: i32, y: Fx| BodyDef::dynamic().position((Fx::from_num(x), y));
    let mut commands =
        vec![Command::Spawn { body: BodyDef::fixed().position((fx!(0), fx!(-1))), shapes: vec![ground] }];
    commands.extend([-4, 4, -6, 6].map(|x| Command::Spawn { body: at(x, fx!(1)), shapes: vec![ball] }));
    commands.extend(
        (0..5).map(|row| Command::Spawn { body: at(0, Fx::from_num(row) + fx!(0.5)), shapes: vec![crates] }),
    );
    Ok(commands)
}

impl Push {
    /// Commands for the inputs. Bits of an input: 1 pushes to the left, 2 to the right, 4 jumps.
    fn commands(&self, inputs: &[u8]) -> Vec<Command> {
        let command = |(&body, &input): (&BodyId, &u8)| {
            let state = self.world.body(body)?;
            let along = Fx::from_num(i32::from(input >> 1 & 1) - i32::from(input & 1));
            let jumps = input & 4 != 0 && state.velocity().y.abs() < fx!(0.05);
            let impulse = Vec2::new(along, if jumps { fx!(18) } else { fx!(0) });
            (impulse != Vec2::ZERO).then(|| Command::ApplyImpulse { body, impulse, point: state.position() })
        };
        self.players.iter().zip(inputs).filter_map(command).collect()
    }
}

impl Game for Push {
    type Setup = ();
    type Input = u8;
    type Save = Snapshot;
    const RULES: RulesId = RulesId { name: "push the crates", version: 1 };

    fn new(_: &()) -> Result<Self, SetupError> {
        let build = || {
            let mut world = World::new(Config::default())?;
            for command in setup()? {
                world.execute(&command)?;
            }
            let players = world.bodies().map(|(id, _)| id).skip(1).take(SEATS.into()).collect();
            Ok(Push { world, players })
        };
        build().map_err(|error: WorldError| SetupError { why: error.to_string() })
    }
    fn players(&self) -> u32 {
        SEATS.into()
    }
    fn tick_rate(&self) -> u32 {
        60
    }
    fn step(&mut self, inputs: &[u8]) {
        for command in self.commands(inputs) {
            // The world refuses no command, because players are never removed.
            let _ = self.world.execute(&command);
        }
        self.world.step();
    }
    fn state_hash(&self) -> StateHash {
        self.world.state_hash()
    }
    fn save(&self) -> Snapshot {
        self.world.save()
    }
    fn load(&mut self, save: &Snapshot) {
        self.world.restore(save);
    }
    fn work(&self, _: &[u8]) -> u64 {
        self.world.work(0, 0)
    }
    fn world_mut(&mut self) -> Option<&mut World> {
        Some(&mut self.world)
    }
}

#[derive(Debug, Parser)]
#[command(about = "A native player of examples/web")]
struct Arguments {
    /// URL of the relay.
    relay: String,
    /// Code of the room.
    code: String,
    /// Number of ticks after which the match ends.
    #[arg(long, default_value_t = 3000)]
    ticks: u64,
    /// File for the replay.
    #[arg(short, long)]
    output: Option<PathBuf>,
}

/// The secret of an identity as bytes. The relay derives the address of a client from the client's secret.
fn secret(me: &PeerIdentity) -> [u8; 16] {
    let mut bytes = [0; 16];
    for (to, from) in bytes.chunks_mut(8).zip(me.secret) {
        to.copy_from_slice(&from.to_le_bytes());
    }
    bytes
}

/// Opens the match, or joins it if another member is in the room.
fn enter(arguments: &Arguments) -> Result<Peer<Push, Relay>, Box<dyn Error>> {
    let me = PeerIdentity::random();
    // The relay gets another secret, because it must not know the secret of the handshake.
    let relay = Relay::connect(&arguments.relay, &arguments.code, secret(&PeerIdentity::random()))?;
    let options = PeerOptions::rollback();
    Ok(match relay.others().first().cloned() {
        None => Peer::host(&(), options, me, relay)?,
        Some(contact) => Peer::join(&(), options, me, relay, contact)?,
    })
}

fn ask_another(peer: &mut Peer<Push, Relay>) {
    if let Some(contact) = peer.transport_mut().next_contact() {
        peer.ask(contact);
    }
}

/// Converts a replay of `Push` to one of the sandbox, whose inputs are commands.
fn as_sandbox(file: &[u8]) -> Result<Vec<u8>, Box<dyn Error>> {
    let refused = |verdict: lockstep2d::replay::Verdict| verdict.to_string();
    let mut inputs = RawReplay::<Push>::open(file, &Limits::default()).map_err(refused)?;
    let start = SandboxSetup { config: Config::default(), commands: setup()? };
    let mut recording = Recording::<Sandbox>::start(&start, CHECKPOINT_INTERVAL)?;
    let mut game = Push::new(&())?;
    while inputs.tick() < inputs.ticks() {
        inputs.step().map_err(refused)?;
        recording.step(&[game.commands(inputs.inputs())])?;
        game.step(inputs.inputs());
    }
    Ok(recording.finish()?)
}

fn main() -> Result<(), Box<dyn Error>> {
    let arguments = Arguments::parse();
    let mut peer = enter(&arguments)?;
    println!("{}", json!({ "address": format!("{:?}", peer.transport_mut().own()) }));
    peer.end_at(arguments.ticks);
    let mut replay = Vec::new();
    let start = SystemTime::now().duration_since(UNIX_EPOCH)?;
    let mut asked_at = Duration::ZERO;
    while peer.status() != Some(Status::Closed) {
        let now = SystemTime::now().duration_since(UNIX_EPOCH)?.saturating_sub(start);
        peer.update(now)?;
        let is_inside = peer.status().is_some() || peer.download().is_some();
        if !is_inside && now.saturating_sub(asked_at) >= CONTACT_PATIENCE {
            asked_at = now;
            ask_another(&mut peer);
        }
        while peer.is_due() {
            // The bot changes its direction every 40 ticks, and jumps every 90 ticks.
            let tick = peer.tick();
            let jump = if tick % 90 < 2 { 4 } else { 0 };
            let input = if tick / 40 % 2 == 0 { 1 } else { 2 };
            peer.advance(&[input | jump])?;
        }
        while let Some(event) = peer.next_event() {
            match event {
                PeerEvent::Desync(desync) => return Err(format!("desync: {desync:?}").into()),
                // This peer has to join again.
                PeerEvent::Session(Event::TooFarBehind) => ask_another(&mut peer),
                _ => {}
            }
        }
        replay.extend(peer.take_replay());
        thread::sleep(Duration::from_millis(2));
    }
    let end = peer.finish()?;
    replay.extend(end.replay);
    if let Some(path) = &arguments.output {
        if replay.is_empty() {
            eprintln!("{}: not written, because a replay starts at the first tick", path.display());
        } else {
            std::fs::write(path, as_sandbox(&replay)?)?;
        }
    }
    println!("{}", json!({ "ticks": end.ticks, "hash": end.game.state_hash().to_string() }));
    Ok(())
}
