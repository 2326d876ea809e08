use super::*;
use crate::lockstep::{Sandbox, SandboxSetup};
use crate::world::Phase;

#[test]
fn phases_are_logged_if_wanted() {
    let mut game = Sandbox::new(&SandboxSetup::default()).expect("an empty world");
    for _ in 0..2 {
        let logged = step(&mut game, &[vec![]], Phases::Compared);
        let phases: Vec<_> = logged.iter().map(|logged| logged.phase).collect();
        assert_eq!((phases.len(), phases[1]), (8, Some(Phase::BroadPhase)));
    }
    let mut ignoring = Sandbox::new(&SandboxSetup::default()).expect("an empty world");
    assert!(step(&mut ignoring, &[vec![]], Phases::Ignored).is_empty());
}
