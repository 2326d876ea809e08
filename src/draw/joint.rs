//! Primitives of a joint. The allowed part of the distance between the anchors is drawn as a joint arm, and the part
//! that violates the joint as a gap.

use alloc::format;

use super::primitive::{Form, Layers, Style, Subject};
use super::primitives::{Sink, primitive, stretched};
use crate::body::{BodyKind, JointId};
use crate::math::{Fx, Vec2, fx_div};
use crate::solver::{Joint, JointKind, Pulley, Weld};
use crate::world::World;

pub(super) fn add(world: &World, id: JointId, layers: Layers, found: Sink<'_>) {
    let (Some(joint), Some((anchor_a, anchor_b))) = (world.joint(id), world.joint_anchors(id)) else {
        return;
    };
    let mut add = |style, form| found(primitive(style, Subject::Joint(id), form));
    if let Some(error) = world.joint_error(id).filter(|_| layers.joint_errors) {
        let unit = if world.joint_error_is_angle(id) == Some(true) { "mrad" } else { "mm" };
        let text = format!("{:.2} {unit}", error.saturating_mul_int(1000));
        add(Style::JointError, Form::Label { at: anchor_b, text });
    }
    if !layers.joints {
        return;
    }
    let (body_a, body_b) = joint.def().bodies();
    for (body, anchor) in [(body_a, anchor_a), (body_b, anchor_b)] {
        // A fixed body gets no line. Often many joints share one fixed body, and lines to its centre would meet in a
        // point far outside of the scene.
        if let Some(body) = world.body(body).filter(|body| body.kind() != BodyKind::Fixed) {
            add(Style::JointArm, Form::Line { from: anchor, to: body.centre_of_mass() });
        }
        add(Style::JointAnchor, Form::Point(anchor));
    }
    match &joint.def().kind {
        JointKind::Pulley(Pulley { wheel_a, wheel_b, .. }) => {
            for (from, to) in [(anchor_a, *wheel_a), (*wheel_a, *wheel_b), (*wheel_b, anchor_b)] {
                add(Style::JointArm, Form::Line { from, to });
            }
        }
        // The anchors of gears and racks are apart by design.
        JointKind::Gear(_) | JointKind::Rack(_) => {}
        _ => {
            let meant = nearest_allowed(joint, world, (anchor_a, anchor_b));
            for (style, from, to) in [(Style::JointArm, anchor_a, meant), (Style::JointGap, meant, anchor_b)]
            {
                if from != to {
                    add(style, Form::Line { from, to });
                }
            }
        }
    }
}

/// The position nearest to B's anchor at which [`World::joint_error`] would be 0.
fn nearest_allowed(joint: &Joint, world: &World, (anchor_a, anchor_b): (Vec2<Fx>, Vec2<Fx>)) -> Vec2<Fx> {
    let def = joint.def();
    match &def.kind {
        JointKind::Revolute(_) | JointKind::Weld(Weld { linear: None, .. }) => anchor_a,
        JointKind::Prismatic(_) | JointKind::Wheel(_) => {
            let Some(body) = world.body(def.body_a) else { return anchor_b };
            let axes = joint.axes(body);
            let along = axes.apply_inverse_wide(anchor_b - anchor_a).x;
            anchor_a + axes.apply_wide(Vec2::new(along, Fx::ZERO))
        }
        JointKind::Distance(distance) => {
            let length = anchor_a.distance(anchor_b);
            let nearest = distance.nearest_allowed(length);
            match fx_div(nearest, length) {
                Some(factor) if nearest != length => anchor_a + stretched(anchor_b - anchor_a, factor),
                _ => anchor_b,
            }
        }
        _ => anchor_b,
    }
}
