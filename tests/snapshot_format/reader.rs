//! Reads a world's bytes by the tables of `docs/FORMAT.md`, without the engine's decoder.

use std::fmt::Display;
use std::ops::Range;

use lockstep2d::hash::StateHash;
use lockstep2d::world::Section;

/// Reads fields, and lists the meaning of each.
pub(crate) struct Reader<'a> {
    bytes: &'a [u8],
    at: usize,
    pub(crate) listing: String,
}

impl<'a> Reader<'a> {
    pub(crate) fn new(bytes: &'a [u8]) -> Self {
        Reader { bytes, at: 0, listing: String::new() }
    }

    fn take(&mut self, count: usize, name: &str, show: impl FnOnce(&[u8]) -> String) -> &'a [u8] {
        let taken = &self.bytes[self.at..self.at + count];
        self.at += count;
        let shown = show(taken);
        let digits: Vec<String> = taken.iter().map(|byte| format!("{byte:02x}")).collect();
        for (row, chunk) in digits.chunks(16).enumerate() {
            let line = format!("{:47} | {}", chunk.join(" "), if row == 0 { name } else { "" });
            self.listing += line.trim_end();
            self.listing += if row == 0 && !shown.is_empty() { " " } else { "" };
            self.listing += if row == 0 { &shown } else { "" };
            self.listing += "\n";
        }
        taken
    }

    fn number<const N: usize, T: Display + Copy>(&mut self, name: &str, from: fn([u8; N]) -> T) -> T {
        let mut bytes = [0; N];
        let show = |taken: &[u8]| from(taken.try_into().expect("as many bytes as requested")).to_string();
        bytes.copy_from_slice(self.take(N, name, show));
        from(bytes)
    }

    fn u8(&mut self, name: &str) -> u8 {
        self.number(name, u8::from_le_bytes)
    }

    fn u16(&mut self, name: &str) -> u16 {
        self.number(name, u16::from_le_bytes)
    }

    fn u32(&mut self, name: &str) -> u32 {
        self.number(name, u32::from_le_bytes)
    }

    fn u64(&mut self, name: &str) -> u64 {
        self.number(name, u64::from_le_bytes)
    }

    fn i32(&mut self, name: &str) -> i32 {
        self.number(name, i32::from_le_bytes)
    }

    fn i64(&mut self, name: &str) -> i64 {
        self.number(name, i64::from_le_bytes)
    }

    /// Reads one byte, and a value if the byte is 1.
    fn option(&mut self, name: &str, value: impl FnOnce(&mut Self)) {
        match self.u8(name) {
            0 => {}
            present => {
                assert_eq!(present, 1, "{name}: expected 0 or 1");
                value(self);
            }
        }
    }

    /// Reads adjacent fixed-point numbers of 4 or 8 bytes.
    fn fixed(&mut self, name: &str, count: usize, bytes: usize, fraction_bits: u32) {
        self.take(count * bytes, name, |taken| {
            let number = |chunk: &[u8]| {
                let mut wide = [if chunk[bytes - 1] < 0x80 { 0 } else { 0xff }; 8];
                wide[..bytes].copy_from_slice(chunk);
                decimal(i64::from_le_bytes(wide), fraction_bits)
            };
            taken.chunks(bytes).map(number).collect::<Vec<_>>().join(", ")
        });
    }

    fn fx(&mut self, name: &str) {
        self.fixed(name, 1, 8, 32);
    }

    fn fx2(&mut self, name: &str) {
        self.fixed(name, 2, 8, 32);
    }

    fn count(&mut self, name: &str) -> u64 {
        self.u64(&format!("number of {name}:"))
    }

    fn handle(&mut self, name: &str) -> (u32, u32) {
        (self.u32(&format!("{name}: slot")), self.u32(&format!("{name}: generation")))
    }

    fn config(&mut self) {
        self.u32("ticks per second");
        self.fx2("gravity");
        self.u32("sub-steps");
        self.u32("iterations");
        match self.u32("contact tuning: variant") {
            0 => ["hertz", "damping ratio", "push speed"].map(|name| self.fx(name)),
            _ => ["share", "slop", "push speed"].map(|name| self.fx(name)),
        };
        for name in ["joint hertz", "joint damping ratio", "restitution threshold", "speed limit"] {
            self.fx(name);
        }
        self.fx("speculative distance");
        self.fx("fat margin");
        self.u8("bodies sleep");
        self.u8("fast bodies are swept");
        self.fx("hit speed");
        for name in ["body limit", "shape limit", "joint limit", "pair limit"] {
            self.u32(name);
        }
    }

    fn arena(&mut self, name: &str, value: fn(&mut Self)) {
        for slot in 0..self.count(&format!("{name} slots")) {
            self.u32(&format!("{name} slot {slot}: generation"));
            if self.u8("occupied") == 1 {
                value(self);
            }
        }
        for _ in 0..self.count(&format!("free {name} slots")) {
            self.u32("free slot");
        }
        self.u32(&format!("{name} slots used up"));
    }

    fn body(&mut self) {
        self.u32("kind");
        self.fx2("centre of mass");
        self.u32("angle");
        self.fixed("velocity", 2, 4, 21);
        self.fixed("spin", 1, 4, 21);
        self.fx2("force");
        self.fx("torque");
        if self.u32("mass source: variant") == 1 {
            self.fx("given mass");
            self.fx2("given centre of mass");
            self.fx("given radius of gyration");
        }
        self.fx("mass");
        self.fx2("centre of mass in the body's frame");
        self.fx("radius of gyration");
        self.i32("its reciprocal: mantissa");
        self.u32("its reciprocal: shift");
        self.settings();
        self.u8("enabled");
        self.u32("ticks of rest");
        self.option("sleeps in an island", |reader| {
            reader.handle("island");
        });
        self.option("has a target", |reader| {
            reader.fx2("target: centre of mass");
            reader.u32("target: angle");
        });
        for _ in 0..self.count("shapes") {
            self.handle("shape");
        }
        self.u64("user data");
        self.option("has a name", |reader| {
            reader.take(16, "name", |_| String::new());
        });
    }

    fn settings(&mut self) {
        for name in ["linear damping", "angular damping", "gravity scale"] {
            self.fx(name);
        }
        for name in ["locked: x", "locked: y", "locked: rotation"] {
            self.u8(name);
        }
        self.u32("continuous: variant");
        self.u8("may sleep");
        self.fx("sleep speed");
    }

    fn shape(&mut self) {
        self.handle("body");
        match self.u32("geometry: variant") {
            0 => self.fx("radius"),
            1 => {
                self.fx2("one end");
                self.fx2("other end");
            }
            2 => {
                for _ in 0..self.count("vertices") {
                    self.fixed("vertex", 2, 4, 22);
                }
                self.fixed("rounding radius", 1, 4, 22);
            }
            3 => {
                self.fx2("centre of one end");
                self.fx2("centre of the other");
                self.fx("radius");
            }
            _ => {
                self.fx2("one end");
                self.fx2("other end");
                self.option("a neighbour before", |reader| reader.fx2("its other end"));
                self.option("a neighbour after", |reader| reader.fx2("its other end"));
                self.u32("solid sides");
            }
        }
        self.fx2("offset");
        self.fx("density");
        self.fx("friction");
        self.u32("friction mixing");
        self.fx("restitution");
        self.u32("restitution mixing");
        self.option("restitution threshold", |reader| reader.fx("value"));
        self.fx("rolling resistance");
        self.fx("surface speed");
        self.u64("filter: category");
        self.u64("filter: mask");
        self.i32("filter: group");
        self.option("one-way", |reader| {
            reader.u32("its direction");
        });
        self.sensor();
        for name in ["events: contact", "events: hit", "events: sensor", "events: detect sensors"] {
            self.u8(name);
        }
        self.u64("user data");
        self.fx2("fat box: lower corner");
        self.fx2("fat box: upper corner");
    }

    fn sensor(&mut self) {
        if self.u8("flags: sensor, area") & 2 == 0 {
            return;
        }
        self.fx2("area: acceleration");
        self.option("area: attraction", |reader| {
            reader.fx2("acceleration, radius");
            reader.u32("falloff");
        });
        self.fx2("area: force");
        self.fx2("area: flow");
        self.fx2("area: linear drag, angular drag");
        self.fx("area: density");
    }

    fn joint(&mut self) {
        self.handle("body A");
        self.handle("body B");
        for body in ["A", "B"] {
            self.fx2(&format!("anchor in {body}'s frame"));
            self.u32(&format!("angle in {body}'s frame"));
        }
        self.u8("the bodies collide");
        self.u8("enabled");
        match self.u32("kind: variant") {
            0 | 1 | 4 => self.limit_motor_spring(),
            2 => {
                self.option("rod", |reader| reader.fx("length"));
                self.limit_motor_spring();
                self.option("spring force", |reader| reader.fx2("least, largest"));
            }
            3 => {
                self.option("soft anchors", |reader| reader.fx2("hertz, damping ratio"));
                self.option("soft angle", |reader| reader.fx2("hertz, damping ratio"));
            }
            5 => {
                self.option("linear drive", |reader| reader.fixed("velocity, largest force", 3, 8, 32));
                self.option("angular drive", |reader| reader.fx2("speed, largest torque"));
                for name in ["linear spring", "angular spring"] {
                    self.option(name, |reader| reader.fixed("hertz, damping ratio, largest", 3, 8, 32));
                }
            }
            7 => {
                self.i32("teeth of A");
                self.i32("teeth of B");
            }
            8 => self.fx("radius"),
            9 => {
                self.fx2("wheel of A");
                self.fx2("wheel of B");
                self.fx2("length, ratio");
            }
            _ => {}
        }
        self.option("softness", |reader| reader.fx2("hertz, damping ratio"));
        self.option("force threshold", |reader| reader.fx("force"));
        self.option("torque threshold", |reader| reader.fx("torque"));
        self.u32("beyond it");
        self.u64("user data");
        self.fixed("impulses", 6, 4, 21);
        self.i64("turns, in 2^-32");
    }

    fn limit_motor_spring(&mut self) {
        self.option("limit", |reader| reader.fx2("lower, upper"));
        self.option("motor", |reader| reader.fx2("speed, largest force or torque"));
        self.option("spring", |reader| reader.fixed("hertz, damping ratio, target", 3, 8, 32));
    }

    fn island(&mut self) {
        for _ in 0..self.count("bodies") {
            self.u32("slot of a body");
        }
    }

    fn list_of_contacts(&mut self, name: &str) {
        for _ in 0..self.count(name) {
            self.u32("slot of shape A");
            self.u32("slot of shape B");
            self.u8("touching");
            self.u8("passing");
            self.u8("points with impulses");
            for _ in 0..2 {
                self.u16("feature");
                self.fixed("normal impulse", 1, 4, 21);
                self.fixed("tangential impulse", 1, 4, 21);
            }
            self.fixed("kept manifold: normal", 2, 4, 30);
            for length in ["arm of A", "arm of B", "from the first point to the second", "from A to B"] {
                self.fixed(length, 2, 4, 22);
            }
            self.u32("angle of A");
            self.u32("angle of B");
            self.fixed("separations", 2, 4, 27);
            self.fixed("impulse against rolling", 1, 4, 21);
        }
    }

    fn contacts(&mut self) {
        self.list_of_contacts("contacts");
        self.list_of_contacts("sleeping contacts");
        self.u8("pairs were left out");
        for _ in 0..self.count("contacts that edits changed") {
            self.handle("shape A");
            self.handle("shape B");
            self.option("one is a sensor", |reader| {
                reader.u32("which");
            });
        }
    }

    /// Reads a world. Returns the byte range of each section of the state.
    pub(crate) fn world(&mut self) -> Vec<(Section, Range<usize>)> {
        self.take(8, "magic, LS2DWRLD", |_| String::new());
        assert_eq!(self.u32("format version"), 4);
        assert_eq!(self.u32("semantics id"), lockstep2d::SEMANTICS);
        let length = self.u64("bytes of the state");
        let start = self.at;
        let mut sections = Vec::new();
        let mut end_section = |section, at| {
            let from = sections.last().map_or(start, |(_, range): &(Section, Range<usize>)| range.end);
            sections.push((section, from..at));
        };
        self.config();
        self.u64("tick");
        self.u64("faults");
        end_section(Section::World, self.at);
        self.arena("body", Self::body);
        end_section(Section::Bodies, self.at);
        self.arena("shape", Self::shape);
        end_section(Section::Shapes, self.at);
        self.arena("joint", Self::joint);
        end_section(Section::Joints, self.at);
        self.arena("island", Self::island);
        end_section(Section::Islands, self.at);
        self.contacts();
        end_section(Section::Contacts, self.at);
        self.u64("random numbers: state");
        self.u64("random numbers: increment");
        end_section(Section::Random, self.at);
        assert_eq!((self.at - start) as u64, length);
        let hash = StateHash::of_bytes(&self.bytes[..self.at]);
        let stored = self.take(16, "hash of all bytes before it", |_| String::new());
        assert_eq!(stored, hash.0.to_le_bytes());
        assert_eq!(self.at, self.bytes.len(), "expected no bytes after the hash");
        sections
    }
}

/// Text of `bits / 2^fraction_bits` with at most six fractional digits, rounded towards zero.
fn decimal(bits: i64, fraction_bits: u32) -> String {
    let micro = (u128::from(bits.unsigned_abs()) * 1_000_000) >> fraction_bits;
    let text = format!("{}{}.{:06}", if bits < 0 { "-" } else { "" }, micro / 1_000_000, micro % 1_000_000);
    text.trim_end_matches('0').trim_end_matches('.').to_owned()
}
