//! Energy, momentum and gaps of an assembly.
#![expect(clippy::disallowed_types, reason = "energies are compared with floating point, not simulated")]
#![expect(clippy::float_arithmetic, reason = "the oracle computes energy in floating point")]

use lockstep2d::body::{Body, JointId};
use lockstep2d::math::Fx;
use lockstep2d::solver::{Distance, JointKind, JointLimit, Motor, Prismatic, Pull, Wheel};

use crate::assembly::Assembly;

fn float(x: Fx) -> f64 {
    x.to_num::<f64>()
}

impl Assembly {
    /// Sum of kinetic, potential and spring energy in J. The potential energy is zero at the height of the origin.
    pub(crate) fn energy(&self) -> f64 {
        let gravity = float(self.world.config().gravity.y);
        let of = |body: &Body| {
            let (m, k) = (float(body.mass()), float(body.radius_of_gyration()));
            let (v, w) = (body.velocity(), float(body.angular_velocity()));
            let (x, y) = (float(v.x), float(v.y));
            m * (x * x + y * y + k * k * w * w) / 2.0 - m * gravity * float(body.centre_of_mass().y)
        };
        let bodies: f64 = self.bodies.iter().map(|&id| of(self.world.body(id).expect("there"))).sum();
        bodies + self.joints.iter().map(|&id| self.spring_energy(id)).sum::<f64>()
    }

    /// Momentum, and angular momentum about the origin.
    pub(crate) fn momentum(&self) -> Momentum {
        let mut sum = Momentum::default();
        for &id in &self.bodies {
            let body = self.world.body(id).expect("there");
            let (m, k) = (float(body.mass()), float(body.radius_of_gyration()));
            let (v, at) = (body.velocity(), body.centre_of_mass());
            let (v, w) = ([float(v.x), float(v.y)], float(body.angular_velocity()));
            let own = [m * v[0], m * v[1]];
            sum.linear = [sum.linear[0] + own[0], sum.linear[1] + own[1]];
            sum.size += own[0].hypot(own[1]);
            sum.angular += m * k * k * w + float(at.x) * own[1] - float(at.y) * own[0];
        }
        sum
    }

    /// Unit of energy in J for assemblies that start at rest: the weight of all bodies times 1 m.
    pub(crate) fn scale(&self) -> f64 {
        let gravity = float(self.world.config().gravity.y).abs();
        self.bodies.iter().map(|&id| float(self.world.body(id).expect("there").mass()) * gravity).sum::<f64>()
    }

    fn spring_energy(&self, id: JointId) -> f64 {
        let joint = self.world.joint(id).expect("there");
        let (a, b) = joint.def().bodies();
        let [a, b] = [a, b].map(|id| self.world.body(id).expect("there"));
        let (at_a, at_b) = self.world.joint_anchors(id).expect("there");
        let inverse = |body: &Body| if body.is_dynamic() { 1.0 / float(body.mass()) } else { 0.0 };
        let turning = |body: &Body| if body.is_dynamic() { 1.0 / float(body.inertia()) } else { 0.0 };
        let (im, it) = ([inverse(a), inverse(b)], [turning(a), turning(b)]);
        let omega = |hertz: Fx| float(hertz) * core::f64::consts::TAU;
        let angular = |hertz: Fx, x: Fx| omega(hertz).powi(2) * float(x).powi(2) / (it[0] + it[1]) / 2.0;
        let angle = self.world.joint_angle(id).unwrap_or(Fx::ZERO);
        let translation = self.world.joint_translation(id).map_or(0.0, |t| float(t.x));
        let gap = at_b - at_a;
        let gap = (float(gap.x), float(gap.y));
        let linear = |hertz: Fx, square: f64| omega(hertz).powi(2) * square / (im[0] + im[1]) / 2.0;
        // Energy of a spring that is deformed by `x`, and whose force is at most `max`.
        let limited = |hertz: Fx, mobility: f64, x: f64, max: f64| {
            let stiffness = omega(hertz).powi(2) / mobility;
            let soft = x.min(max / stiffness);
            stiffness * soft * soft / 2.0 + max * (x - soft)
        };
        match &joint.def().kind {
            JointKind::Revolute(kind) => kind.spring.map_or(0.0, |s| angular(s.hertz, angle)),
            JointKind::Weld(kind) => {
                let turn = kind.angular.map_or(0.0, |soft| angular(soft.hertz, angle));
                let square = gap.0 * gap.0 + gap.1 * gap.1;
                turn + kind.linear.map_or(0.0, |soft| linear(soft.hertz, square))
            }
            JointKind::Prismatic(Prismatic { spring: Some(spring), .. })
            | JointKind::Wheel(Wheel { spring: Some(spring), .. }) => {
                linear(spring.hertz, translation.powi(2))
            }
            JointKind::Distance(Distance { spring: Some(spring), spring_force, .. }) => {
                let x = gap.0.hypot(gap.1) - float(spring.target);
                let max = |force: JointLimit| {
                    float(if x > 0.0 { force.lower.saturating_neg() } else { force.upper })
                };
                limited(spring.hertz, im[0] + im[1], x.abs(), spring_force.map_or(f64::MAX, max))
            }
            JointKind::Motor(Motor { linear_spring, angular_spring, .. }) => {
                let pull = |pull: &Option<Pull>, mobility: f64, x: f64| {
                    pull.map_or(0.0, |pull| limited(pull.soft.hertz, mobility, x, float(pull.max)))
                };
                let turn = pull(angular_spring, it[0] + it[1], float(angle).abs());
                turn + pull(linear_spring, im[0] + im[1], gap.0.hypot(gap.1))
            }
            _ => 0.0,
        }
    }

    /// Largest joint error in metres.
    pub(crate) fn gap(&self) -> f64 {
        let error = |&id: &JointId| self.world.joint_error(id).map_or(0.0, float);
        self.joints.iter().map(error).fold(0.0, f64::max)
    }
}

/// Momentum in kg m/s and angular momentum in kg m^2/s.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Momentum {
    linear: [f64; 2],
    /// Sum of the magnitudes of the momenta of all bodies.
    size: f64,
    angular: f64,
}

impl Momentum {
    /// The change of momentum as a share of `size`, and the change of angular momentum as a share of its value at the
    /// start.
    pub(crate) fn change(&self, end: &Self) -> [f64; 2] {
        let apart = (end.linear[0] - self.linear[0]).hypot(end.linear[1] - self.linear[1]);
        [apart / self.size, ((end.angular - self.angular) / self.angular).abs()]
    }
}
