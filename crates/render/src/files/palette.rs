//! [`Palette`]: at most 255 colours for a frame, and a transparent colour.
//!
//! A frame with up to 255 colours keeps all of them exactly. A frame with more colours keeps only the most frequent
//! ones exactly, because they fill large areas, where a changed colour is visible. The other colours are divided into
//! boxes. For each box, the palette has the mean colour. Until the palette is full, the box with the largest sum of
//! squared errors in a channel is split at the mean of that channel.

use std::collections::BTreeMap;

type Rgb = [u8; 3];

/// Maximum number of colours in a palette. A GIF has one more index, which is used for pixels that do not change.
const COLOURS_MAX: usize = 255;
/// Number of the most frequent colours that are kept exactly if there are too many colours.
const KEPT: usize = 96;
/// A frame of more than 255 colours still uses the existing palette if no error in a channel exceeds this value. Stray
/// colours may have larger errors.
const ERROR_MAX: u8 = 24;
/// A colour is stray if at most one in this number of pixels of the frame has it.
const PIXELS_OF_A_STRAY: u64 = 20_000;
/// Maximum number of colours in the cache of nearest colours.
const REMEMBERED_MAX: usize = 1 << 16;

/// Number of pixels of each colour.
#[derive(Default)]
pub(super) struct Counts {
    counts: BTreeMap<Rgb, u64>,
    pixels: u64,
}

impl Counts {
    pub(super) fn of(colours: impl Iterator<Item = Rgb>) -> Self {
        let mut counts = Counts::default();
        counts.add(colours);
        counts
    }

    pub(super) fn add(&mut self, colours: impl Iterator<Item = Rgb>) {
        let Counts { counts, pixels } = self;
        let mut run: Option<(Rgb, u64)> = None;
        for colour in colours {
            *pixels += 1;
            match &mut run {
                Some((last, length)) if *last == colour => *length += 1,
                _ => {
                    if let Some((last, length)) = run.replace((colour, 1)) {
                        *counts.entry(last).or_default() += length;
                    }
                }
            }
        }
        if let Some((last, length)) = run {
            *counts.entry(last).or_default() += length;
        }
    }
}

pub(super) struct Palette {
    colours: Vec<Rgb>,
    /// For each colour, the index of the nearest colour of the palette. The map has all colours of the palette, and
    /// caches other colours.
    nearest: BTreeMap<Rgb, u8>,
}

impl Palette {
    pub(super) fn of(counts: &Counts) -> Self {
        let mut all: Vec<(Rgb, u64)> =
            counts.counts.iter().map(|(&colour, &count)| (colour, count)).collect();
        if all.len() > COLOURS_MAX {
            all.sort_by_key(|&(colour, count)| (std::cmp::Reverse(count), colour));
            let rest = all.split_off(KEPT);
            all.extend(boxes(rest, COLOURS_MAX - KEPT));
        }
        let mut palette = Palette {
            colours: all.into_iter().map(|(colour, _)| colour).collect(),
            nearest: BTreeMap::new(),
        };
        palette.remember();
        palette
    }

    /// Whether the palette suits a frame. If the frame has at most 255 colours, all must be in the palette. Otherwise,
    /// [`ERROR_MAX`] limits the errors.
    pub(super) fn suits(&mut self, counts: &Counts) -> bool {
        let is_exact = counts.counts.len() <= COLOURS_MAX;
        let stray = counts.pixels / PIXELS_OF_A_STRAY;
        counts.counts.iter().all(|(&colour, &count)| {
            let index = self.index(colour);
            let found = self.colour(index);
            let error = (0..3).map(|channel| found[channel].abs_diff(colour[channel])).max();
            if is_exact { found == colour } else { count <= stray || error <= Some(ERROR_MAX) }
        })
    }

    pub(super) fn index(&mut self, colour: Rgb) -> u8 {
        if let Some(&index) = self.nearest.get(&colour) {
            return index;
        }
        let distance = |other: &Rgb| -> u32 {
            (0..3).map(|channel| u32::from(other[channel].abs_diff(colour[channel])).pow(2)).sum()
        };
        let nearest = (0..=u8::MAX).zip(&self.colours).min_by_key(|(_, other)| distance(other));
        let index = nearest.map_or(0, |(index, _)| index);
        if self.nearest.len() >= REMEMBERED_MAX {
            self.remember();
        }
        self.nearest.insert(colour, index);
        index
    }

    pub(super) fn colour(&self, index: u8) -> Rgb {
        self.colours.get(usize::from(index)).copied().unwrap_or_default()
    }

    /// Index of pixels that do not change.
    pub(super) fn transparent(&self) -> u8 {
        u8::try_from(self.colours.len()).unwrap_or(u8::MAX)
    }

    /// Red, green and blue of each index, including the transparent one.
    pub(super) fn table(&self) -> Vec<u8> {
        self.colours.iter().chain(&[[0; 3]]).flatten().copied().collect()
    }

    /// Resets the cache to the colours of the palette.
    fn remember(&mut self) {
        self.nearest = self.colours.iter().copied().zip(0..=u8::MAX).collect();
    }
}

/// Divides colours into at most `count` boxes. Returns the mean colour and the number of pixels of each box.
fn boxes(colours: Vec<(Rgb, u64)>, count: usize) -> Vec<(Rgb, u64)> {
    let mut boxes = vec![Box::of(colours)];
    while boxes.len() < count {
        let widest = (0..boxes.len()).max_by_key(|&at| boxes[at].error);
        let Some(widest) = widest.filter(|&at| boxes[at].error > 0) else { break };
        let Box { colours, channel, mean, .. } = boxes.swap_remove(widest);
        let (low, high) = colours.into_iter().partition(|(colour, _)| colour[channel] <= mean[channel]);
        boxes.extend([Box::of(low), Box::of(high)]);
    }
    boxes.into_iter().map(|Box { mean, pixels, .. }| (mean, pixels)).collect()
}

struct Box {
    colours: Vec<(Rgb, u64)>,
    pixels: u64,
    mean: Rgb,
    /// Channel with the largest sum of squared errors.
    channel: usize,
    /// Sum of squared errors of this channel.
    error: u64,
}

impl Box {
    fn of(colours: Vec<(Rgb, u64)>) -> Self {
        let pixels: u64 = colours.iter().map(|(_, count)| count).sum();
        let sum =
            |channel: usize| colours.iter().map(|(colour, count)| u64::from(colour[channel]) * count).sum();
        // The mean is rounded down, so that a split at the mean leaves neither side empty.
        let mean = [0, 1, 2].map(|channel| u64::checked_div(sum(channel), pixels).unwrap_or(0) as u8);
        let error = |channel: usize| -> u64 {
            let errors = colours
                .iter()
                .map(|(colour, count)| u64::from(colour[channel].abs_diff(mean[channel])).pow(2) * count);
            errors.sum()
        };
        let channel = (0..3).max_by_key(|&channel| error(channel)).unwrap_or(0);
        let error = error(channel);
        Box { colours, pixels, mean, channel, error }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn grey(shades: std::ops::Range<u8>) -> impl Iterator<Item = Rgb> {
        shades.map(|shade| [shade, shade, shade])
    }

    #[test]
    fn few_colours_are_kept_as_they_are() {
        let counts = Counts::of(grey(0..255));
        let mut palette = Palette::of(&counts);
        assert!(
            grey(0..255)
                .all(|colour| palette.index(colour) == colour[0] && palette.colour(colour[0]) == colour)
        );
        assert_eq!((palette.transparent(), palette.table().len()), (255, 256 * 3));
        assert!(palette.suits(&counts));
        assert!(!palette.suits(&Counts::of([[1, 2, 3]].into_iter())), "a missing shade should not suit");
    }

    #[test]
    fn of_many_colours_the_large_areas_are_kept() {
        let areas = [[250, 250, 247], [197, 221, 242], [31, 95, 158]];
        let pixels = areas.into_iter().flat_map(|colour| [colour; 500]);
        let edges =
            (0..4096u16).map(|i| [(i % 16) as u8 * 17, (i / 16 % 16) as u8 * 17, (i / 256) as u8 * 17]);
        let counts = Counts::of(pixels.chain(edges.clone()));
        let mut palette = Palette::of(&counts);
        assert_eq!(palette.table().len(), 256 * 3);
        for colour in areas {
            let index = palette.index(colour);
            assert_eq!(palette.colour(index), colour);
        }
        // 4096 colours are divided into 159 boxes, so a box has about 3 colours in each of the three channels.
        for colour in edges {
            let index = palette.index(colour);
            let found = palette.colour(index);
            let error = (0..3).map(|channel| found[channel].abs_diff(colour[channel])).max();
            assert!(error <= Some(48), "{colour:?} became {found:?}");
        }
    }

    #[test]
    fn what_is_remembered_is_bounded_and_changes_nothing() {
        let mut palette = Palette::of(&Counts::of(grey(0..255)));
        for i in 0..200_000u32 {
            let [_, red, green, blue] = (i * 83).to_be_bytes();
            let colour = [red, green, blue];
            let distance =
                |shade: u8| -> u32 { colour.iter().map(|part| u32::from(part.abs_diff(shade)).pow(2)).sum() };
            let index = palette.index(colour);
            assert_eq!(distance(index), (0..255).map(distance).min().unwrap(), "{colour:?}");
            assert!(palette.nearest.len() <= REMEMBERED_MAX);
        }
    }
}
