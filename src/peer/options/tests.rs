use super::*;
use crate::lockstep::{Sandbox, SandboxSetup};

#[test]
fn an_error_names_what_sets_the_number() {
    let game = Sandbox::new(&SandboxSetup::default()).unwrap();
    let error = |field| ConfigError { field, value: 16_667, min: 1, max: 2, step: 1 };
    for (field, slot, expected) in [
        ("tick_micros", InputSlot::Fixed(1), "`Game::tick_rate` is 1 to 1000, not 60"),
        ("seats", InputSlot::Fixed(1), "`Game::players` is 1 to 2, not 1"),
        ("delay_min", InputSlot::Fixed(1), "`delay.0` is 1 to 2, not 16667"),
        ("delay_max", InputSlot::Fixed(1), "`delay.1` is 1 to 2, not 16667"),
        ("input_bytes", InputSlot::Fixed(600), "`bytes of the default input` is 1 to 2, not 16667"),
        ("input_bytes", InputSlot::Prefixed(600), "`input_bytes` is 0 to 510, not 600"),
        ("guess", InputSlot::Fixed(1), "`guess` is 1 to 2, not 16667"),
    ] {
        let text = alloc::format!("{}", named(error(field), &game, slot));
        assert_eq!(text, alloc::format!("the session cannot start: {expected}"));
    }
}
