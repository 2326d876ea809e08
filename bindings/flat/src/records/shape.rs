//! Shapes and areas.

use lockstep2d::body::{
    Area, Attraction, EventSwitches, Falloff, Filter, Geometry, Material, Mixing, Polygon, ShapeDef, Sides,
};
use lockstep2d::math::{Fx, Vec2, widen};

use super::{check_flags, check_reserved, check_size, flag, has, size};
use crate::describe::{constants, records};
use crate::numbers::{RawAngle, RawFx, RawVec2};
use crate::status::{Failure, Outcome, Status, value};

constants! {
    /// Kind of a shape: a disc with `radius`.
    CIRCLE = 0, "LS2D_CIRCLE";
    /// Kind of a shape: a line from `points[0]` to `points[1]`.
    SEGMENT = 1, "LS2D_SEGMENT";
    /// Kind of a shape: a convex polygon of `count` points, counter-clockwise, rounded by `radius`.
    POLYGON = 2, "LS2D_POLYGON";
    /// Kind of a shape: all points within `radius` of the line from `points[0]` to `points[1]`.
    CAPSULE = 3, "LS2D_CAPSULE";
    /// Kind of a shape: a link of a chain, made by `ls2d_chain_links`. It is a line from `points[0]` to `points[1]`.
    /// The far end of the link before it is `points[2]`, and that of the link after it `points[3]`.
    LINK = 4, "LS2D_LINK";
    /// Kind of a shape: the convex hull of `count` points in any order, rounded by `radius`.
    HULL = 5, "LS2D_HULL";
    /// Kind of a shape: a rectangle of half width `points[0].x` and half height `points[0].y`, rounded by `radius`.
    RECTANGLE = 6, "LS2D_RECTANGLE";
    /// Flag of a shape: detects overlaps, and does not collide.
    SHAPE_SENSOR = 1, "LS2D_SHAPE_SENSOR";
    /// Flag of a shape: other shapes pass through it if they move in the direction `one_way`.
    SHAPE_ONE_WAY = 2, "LS2D_SHAPE_ONE_WAY";
    /// Flag of a shape: has its own `restitution_threshold`.
    SHAPE_RESTITUTION_THRESHOLD = 4, "LS2D_SHAPE_RESTITUTION_THRESHOLD";
    /// Flag of a shape: a sensor that acts on bodies in it.
    SHAPE_AREA = 8, "LS2D_SHAPE_AREA";
    /// Flag of a shape: the area attracts bodies to its centre.
    SHAPE_ATTRACTION = 16, "LS2D_SHAPE_ATTRACTION";
    /// Flag of a shape: its contacts are reported in contact events. It suffices that one of the two shapes has this
    /// flag.
    SHAPE_CONTACT_EVENTS = 32, "LS2D_SHAPE_CONTACT_EVENTS";
    /// Flag of a shape: its hits are reported in hit events. It suffices that one of the two shapes has this flag.
    SHAPE_HIT_EVENTS = 64, "LS2D_SHAPE_HIT_EVENTS";
    /// Flag of a shape: sensors detect it.
    SHAPE_SENSOR_EVENTS = 128, "LS2D_SHAPE_SENSOR_EVENTS";
    /// Flag of a shape: a sensor that also detects other sensors.
    SHAPE_DETECT_SENSORS = 256, "LS2D_SHAPE_DETECT_SENSORS";
    /// Flag of a link: it has a neighbour before `points[0]`.
    SHAPE_LINK_BEFORE = 512, "LS2D_SHAPE_LINK_BEFORE";
    /// Flag of a link: it has a neighbour after `points[1]`.
    SHAPE_LINK_AFTER = 1024, "LS2D_SHAPE_LINK_AFTER";
    /// Flag of a link: solid from the right only, looking from `points[0]` to `points[1]`.
    SHAPE_LINK_ONE_SIDED = 2048, "LS2D_SHAPE_LINK_ONE_SIDED";
    /// Rule for mixing the values of two shapes: the mean. If the shapes have different rules, the rule whose constant
    /// is larger applies.
    MIX_AVERAGE = 0, "LS2D_MIX_AVERAGE";
    /// Rule for mixing the values of two shapes: the square root of the product.
    MIX_GEOMETRIC_MEAN = 1, "LS2D_MIX_GEOMETRIC_MEAN";
    /// Rule for mixing the values of two shapes: the smaller value.
    MIX_MINIMUM = 2, "LS2D_MIX_MINIMUM";
    /// Rule for mixing the values of two shapes: the product.
    MIX_PRODUCT = 3, "LS2D_MIX_PRODUCT";
    /// Rule for mixing the values of two shapes: the larger value.
    MIX_MAXIMUM = 4, "LS2D_MIX_MAXIMUM";
    /// `ls2d_shape_def.attraction_falloff`: beyond `attraction_radius`, the attraction is constant.
    FALLOFF_CONSTANT = 0, "LS2D_FALLOFF_CONSTANT";
    /// `ls2d_shape_def.attraction_falloff`: beyond `attraction_radius`, the attraction is in inverse proportion to the
    /// distance from the centre.
    FALLOFF_INVERSE = 1, "LS2D_FALLOFF_INVERSE";
    /// `ls2d_shape_def.attraction_falloff`: beyond `attraction_radius`, the attraction is in inverse proportion to the
    /// square of the distance from the centre.
    FALLOFF_INVERSE_SQUARE = 2, "LS2D_FALLOFF_INVERSE_SQUARE";
}

pub(crate) const LINK_FLAGS: u32 = SHAPE_LINK_BEFORE | SHAPE_LINK_AFTER | SHAPE_LINK_ONE_SIDED;
const FLAGS: u32 = 511 | LINK_FLAGS;
const POINTS_MAX: usize = 8;

records! {
    /// Definition of a shape. `ls2d_shape_def_init` sets the defaults.
    struct RawShapeDef = "ls2d_shape_def" {
        /// Size of this struct in bytes.
        size: u32,
        /// `LS2D_CIRCLE` and so on.
        kind: u32,
        /// `LS2D_SHAPE_` flags.
        flags: u32,
        /// Number of points of a polygon or hull, at most 8.
        count: u32,
        /// Points in metres from the shape's centre.
        points: [RawVec2; 8],
        /// Radius of a circle or capsule, rounding radius of a polygon, hull or rectangle, in metres.
        radius: RawFx,
        /// Centre of the shape in the body's frame, in metres.
        offset: RawVec2,
        /// Mass per area in kg/m², 0 to 2^20.
        density: RawFx,
        /// Friction coefficient, 0 to 16.
        friction: RawFx,
        /// Fraction of the approach speed that a bounce returns, 0 to 1.5.
        restitution: RawFx,
        /// Approach speed in m/s below which the shape does not bounce, 0 to 400. Read only with
        /// `LS2D_SHAPE_RESTITUTION_THRESHOLD`.
        restitution_threshold: RawFx,
        /// Rolling resistance of a round shape, as a fraction of its radius, 0 to 1.
        rolling_resistance: RawFx,
        /// Speed of the surface around the shape, clockwise, in m/s, within ±400.
        surface_speed: RawFx,
        /// Categories that the shape belongs to, one bit each.
        category: u64,
        /// Categories that the shape collides with.
        mask: u64,
        /// Two shapes with the same positive group always collide, two shapes with the same negative group never do. 0
        /// is no group.
        group: i32,
        /// `LS2D_MIX_AVERAGE` and so on, for friction.
        friction_mixing: u32,
        /// `LS2D_MIX_AVERAGE` and so on, for restitution.
        restitution_mixing: u32,
        /// Direction in the body's frame in which other shapes pass through this one. Read only with
        /// `LS2D_SHAPE_ONE_WAY`.
        one_way: RawAngle,
        /// Acceleration in m/s² that the area gives to bodies in it, along the axes of the area's body, within ±10 000.
        area_acceleration: RawVec2,
        /// Force in N per m² of the part of a body that is in the area, along the axes of the area's body, within
        /// ±2^20.
        area_force: RawVec2,
        /// Velocity of the medium relative to the area's body in m/s, along the axes of this body, within ±400.
        area_flow: RawVec2,
        /// Rate per second, 0 to 1000, at which the velocity of a body in the area approaches that of the medium.
        area_linear_drag: RawFx,
        /// Rate per second, 0 to 1000, at which the angular velocity of a body in the area approaches that of the
        /// area's body.
        area_angular_drag: RawFx,
        /// Density of the medium in kg/m², 0 to 2^20, for buoyancy.
        area_density: RawFx,
        /// Acceleration in m/s² towards the centre of the area, at the distance `attraction_radius`.
        attraction_acceleration: RawFx,
        /// Distance from the centre in metres at which the acceleration is `attraction_acceleration`. Nearer to the
        /// centre, it decreases linearly to 0; farther away, `attraction_falloff` applies.
        attraction_radius: RawFx,
        /// `LS2D_FALLOFF_CONSTANT` and so on.
        attraction_falloff: u32,
        /// Reserved: 0.
        reserved: u32,
        /// A number that the game may choose freely.
        user_data: u64,
    }
}

fn mixing(rule: u32) -> Outcome<Mixing> {
    Ok(match rule {
        MIX_AVERAGE => Mixing::Average,
        MIX_GEOMETRIC_MEAN => Mixing::GeometricMean,
        MIX_MINIMUM => Mixing::Minimum,
        MIX_PRODUCT => Mixing::Product,
        MIX_MAXIMUM => Mixing::Maximum,
        other => return Err(value("a rule of mixing", other)),
    })
}

const fn mixing_number(rule: Mixing) -> u32 {
    match rule {
        Mixing::Average => MIX_AVERAGE,
        Mixing::GeometricMean => MIX_GEOMETRIC_MEAN,
        Mixing::Minimum => MIX_MINIMUM,
        Mixing::Product => MIX_PRODUCT,
        Mixing::Maximum => MIX_MAXIMUM,
    }
}

impl RawShapeDef {
    pub(crate) fn of(def: &ShapeDef) -> Self {
        let mut raw = RawShapeDef::without_geometry(def);
        let mut put = |points: &[Vec2<Fx>]| {
            raw.points.iter_mut().zip(points).for_each(|(place, point)| *place = RawVec2::of(*point));
        };
        match def.geometry {
            Geometry::Circle { radius } => (raw.kind, raw.radius) = (CIRCLE, RawFx::of(radius)),
            Geometry::Segment { a, b } => {
                put(&[a, b]);
                raw.kind = SEGMENT;
            }
            Geometry::Polygon(polygon) => {
                let points: Vec<_> = polygon.vertices().iter().map(|vertex| vertex.widen()).collect();
                put(&points);
                raw.count = u32::try_from(points.len()).unwrap_or(0);
                (raw.kind, raw.radius) = (POLYGON, RawFx::of(widen(polygon.radius())));
            }
            Geometry::Capsule { a, b, radius } => {
                put(&[a, b]);
                (raw.kind, raw.radius) = (CAPSULE, RawFx::of(radius));
            }
            Geometry::Link { a, b, before, after, sides } => {
                put(&[a, b, before.unwrap_or_default(), after.unwrap_or_default()]);
                raw.kind = LINK;
                raw.flags |= flag(before.is_some(), SHAPE_LINK_BEFORE)
                    | flag(after.is_some(), SHAPE_LINK_AFTER)
                    | flag(sides == Sides::Right, SHAPE_LINK_ONE_SIDED);
            }
        }
        raw
    }

    fn without_geometry(def: &ShapeDef) -> Self {
        let ShapeDef {
            geometry: _,
            offset,
            density,
            material,
            filter,
            one_way,
            sensor,
            area,
            events,
            user_data,
        } = *def;
        let Material {
            friction,
            friction_mixing,
            restitution,
            restitution_mixing,
            restitution_threshold,
            rolling_resistance,
            surface_speed,
        } = material;
        let medium = area.unwrap_or_default();
        let flags = flag(sensor, SHAPE_SENSOR)
            | flag(one_way.is_some(), SHAPE_ONE_WAY)
            | flag(restitution_threshold.is_some(), SHAPE_RESTITUTION_THRESHOLD)
            | flag(area.is_some(), SHAPE_AREA)
            | flag(medium.attraction.is_some(), SHAPE_ATTRACTION)
            | flag(events.contact, SHAPE_CONTACT_EVENTS)
            | flag(events.hit, SHAPE_HIT_EVENTS)
            | flag(events.sensor, SHAPE_SENSOR_EVENTS)
            | flag(events.detect_sensors, SHAPE_DETECT_SENSORS);
        let (attraction, radius, falloff) = match medium.attraction {
            Some(Attraction { acceleration, radius, falloff }) => (acceleration, radius, falloff),
            None => (Fx::ZERO, Fx::ZERO, Falloff::Constant),
        };
        RawShapeDef {
            size: size::<Self>(),
            kind: CIRCLE,
            flags,
            count: 0,
            points: [RawVec2::ZERO; POINTS_MAX],
            radius: RawFx(0),
            offset: RawVec2::of(offset),
            density: RawFx::of(density),
            friction: RawFx::of(friction),
            restitution: RawFx::of(restitution),
            restitution_threshold: RawFx::of(restitution_threshold.unwrap_or_default()),
            rolling_resistance: RawFx::of(rolling_resistance),
            surface_speed: RawFx::of(surface_speed),
            category: filter.category,
            mask: filter.mask,
            group: filter.group,
            friction_mixing: mixing_number(friction_mixing),
            restitution_mixing: mixing_number(restitution_mixing),
            one_way: RawAngle::of(one_way.unwrap_or_default()),
            area_acceleration: RawVec2::of(medium.acceleration),
            area_force: RawVec2::of(medium.force),
            area_flow: RawVec2::of(medium.flow),
            area_linear_drag: RawFx::of(medium.linear_drag),
            area_angular_drag: RawFx::of(medium.angular_drag),
            area_density: RawFx::of(medium.density),
            attraction_acceleration: RawFx::of(attraction),
            attraction_radius: RawFx::of(radius),
            attraction_falloff: match falloff {
                Falloff::Constant => FALLOFF_CONSTANT,
                Falloff::Inverse => FALLOFF_INVERSE,
                Falloff::InverseSquare => FALLOFF_INVERSE_SQUARE,
            },
            reserved: 0,
            user_data,
        }
    }

    /// Converts the geometry. The geometry of links is not validated here; the world validates it.
    pub(crate) fn geometry(&self) -> Outcome<Geometry> {
        check_size::<Self>(self.size)?;
        if self.kind != LINK {
            check_flags("the flags of a shape that is no link", self.flags & LINK_FLAGS, 0)?;
        }
        let points = self.points.map(RawVec2::vec);
        let [a, b, before, after, ..] = points;
        let radius = self.radius.fx();
        let count = usize::try_from(self.count).ok().filter(|&count| count <= POINTS_MAX);
        let corners = count.and_then(|count| points.get(..count)).ok_or_else(|| {
            Failure::new(Status::Geometry, format!("{} points, at most 8 are possible", self.count))
        });
        let rounded = |polygon: Polygon| polygon.rounded(radius).map(Geometry::Polygon);
        Ok(match self.kind {
            CIRCLE => Geometry::circle(radius)?,
            SEGMENT => Geometry::segment(a, b)?,
            POLYGON => rounded(Polygon::new(corners?)?)?,
            CAPSULE => Geometry::capsule(a, b, radius)?,
            LINK => {
                let before = has(self.flags, SHAPE_LINK_BEFORE).then_some(before);
                let after = has(self.flags, SHAPE_LINK_AFTER).then_some(after);
                let sides = if has(self.flags, SHAPE_LINK_ONE_SIDED) { Sides::Right } else { Sides::Both };
                Geometry::Link { a, b, before, after, sides }
            }
            HULL => rounded(Polygon::hull(corners?)?)?,
            RECTANGLE => rounded(Polygon::rectangle(a.x, a.y)?)?,
            other => return Err(value("the kind of a shape", other)),
        })
    }

    pub(crate) fn def(&self) -> Outcome<ShapeDef> {
        let geometry = self.geometry()?;
        let flags = self.flags;
        check_flags("the flags of a shape", flags, FLAGS)?;
        check_reserved(self.reserved)?;
        Ok(ShapeDef {
            geometry,
            offset: self.offset.vec(),
            density: self.density.fx(),
            material: self.material()?,
            filter: self.filter(),
            one_way: has(flags, SHAPE_ONE_WAY).then(|| self.one_way.angle()),
            sensor: has(flags, SHAPE_SENSOR | SHAPE_AREA),
            area: if has(flags, SHAPE_AREA) { Some(self.area()?) } else { None },
            events: EventSwitches {
                contact: has(flags, SHAPE_CONTACT_EVENTS),
                hit: has(flags, SHAPE_HIT_EVENTS),
                sensor: has(flags, SHAPE_SENSOR_EVENTS),
                detect_sensors: has(flags, SHAPE_DETECT_SENSORS),
            },
            user_data: self.user_data,
        })
    }

    pub(crate) fn filter(&self) -> Filter {
        Filter { category: self.category, mask: self.mask, group: self.group }
    }

    pub(crate) fn material(&self) -> Outcome<Material> {
        let own_threshold = has(self.flags, SHAPE_RESTITUTION_THRESHOLD);
        Ok(Material {
            friction: self.friction.fx(),
            friction_mixing: mixing(self.friction_mixing)?,
            restitution: self.restitution.fx(),
            restitution_mixing: mixing(self.restitution_mixing)?,
            restitution_threshold: own_threshold.then(|| self.restitution_threshold.fx()),
            rolling_resistance: self.rolling_resistance.fx(),
            surface_speed: self.surface_speed.fx(),
        })
    }

    fn area(&self) -> Outcome<Area> {
        let attraction = Attraction {
            acceleration: self.attraction_acceleration.fx(),
            radius: self.attraction_radius.fx(),
            falloff: match self.attraction_falloff {
                FALLOFF_CONSTANT => Falloff::Constant,
                FALLOFF_INVERSE => Falloff::Inverse,
                FALLOFF_INVERSE_SQUARE => Falloff::InverseSquare,
                other => return Err(value("the falloff of an attraction", other)),
            },
        };
        Ok(Area {
            acceleration: self.area_acceleration.vec(),
            attraction: has(self.flags, SHAPE_ATTRACTION).then_some(attraction),
            force: self.area_force.vec(),
            flow: self.area_flow.vec(),
            linear_drag: self.area_linear_drag.fx(),
            angular_drag: self.area_angular_drag.fx(),
            density: self.area_density.fx(),
        })
    }
}
