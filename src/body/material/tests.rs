use super::*;

#[test]
fn mixing_follows_each_rule_and_the_later_rule_wins() {
    let (a, b) = (fx!(0.25), fx!(1));
    let expected = [
        (Mixing::Average, fx!(0.625)),
        (Mixing::GeometricMean, fx!(0.5)),
        (Mixing::Minimum, fx!(0.25)),
        (Mixing::Product, fx!(0.25)),
        (Mixing::Maximum, fx!(1)),
    ];
    for (rule, value) in expected {
        assert_eq!(rule.mix(a, b), value, "{rule:?}");
        assert_eq!(rule.mix(b, a), value, "{rule:?} should be symmetric");
    }
    let average = Material { friction: a, friction_mixing: Mixing::Average, ..Material::default() };
    let maximum = Material { friction: b, friction_mixing: Mixing::Maximum, ..Material::default() };
    assert_eq!(average.mixed_friction(&maximum), b);
}

#[test]
fn the_smaller_threshold_applies_and_none_is_that_of_the_world() {
    let of = |restitution_threshold| Material { restitution_threshold, ..Material::default() };
    let (none, half, three) = (of(None), of(Some(fx!(0.5))), of(Some(fx!(3))));
    for (a, b, expected) in [
        (none, none, fx!(1)),
        (none, half, fx!(0.5)),
        (none, three, fx!(1)),
        (half, three, fx!(0.5)),
        (three, three, fx!(3)),
    ] {
        assert_eq!(a.mixed_restitution_threshold(&b, fx!(1)), expected);
        assert_eq!(b.mixed_restitution_threshold(&a, fx!(1)), expected);
    }
    assert!(of(Some(fx!(400))).is_valid() && of(Some(Fx::ZERO)).is_valid());
    assert!(!of(Some(fx!(401))).is_valid() && !of(Some(fx!(-0.001))).is_valid());
}
