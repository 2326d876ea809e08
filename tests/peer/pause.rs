use lockstep2d::session::Status;

use super::{Table, modes};

/// One peer plays no ticks for 10 s, which is five times the patience. The other peer waits for it.
#[test]
fn a_pause_costs_no_seat_and_is_not_caught_up() {
    for options in modes() {
        let mut table = Table::new(30, 0);
        table.host(options);
        table.join(options, 0);
        table.play(2000);
        table.stopped = Some(1);
        table.play(1000);
        let before = table.peer(0).tick();
        table.play(9000);
        assert_eq!(table.peer(0).tick(), before, "without inputs of the other player");
        for (at, seat) in [(0, 0), (1, 1)] {
            assert_eq!(table.peer(at).status(), Some(Status::Playing));
            assert_eq!(table.peer(at).seats(), [seat]);
        }
        table.stopped = None;
        table.play(2000);
        let ticks = table.peer(0).tick() - before;
        assert!((100..=130).contains(&ticks), "{ticks} ticks in 2 s, of 660 since the pause began");
    }
}
