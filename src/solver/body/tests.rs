use super::*;

#[test]
fn a_velocity_at_either_end_of_its_format_is_clamped() {
    for (end, limit) in [(Speed::MIN, -SPEED_MAX), (Speed::MAX, SPEED_MAX)] {
        let (mut body, mut faults) = (SolverBody::default(), 0);
        body.set_velocity(end, end, end, &mut faults);
        assert_eq!((body.velocity, body.spin, faults), (Vec2::new(limit, limit), limit, 3));
    }
}
