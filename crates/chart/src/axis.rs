//! An axis: what it shows, how it maps values to pixels, and where its ticks are.

use std::fmt;

use crate::label::{Label, TEXT, fixed, wrapped};

/// How an axis is divided.
///
/// A number that is not finite, or beyond 1e300, has no place on either.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum Scale {
    /// Equal differences are equally long.
    Linear,
    /// Equal ratios are equally long; only positive numbers have a place.
    Log,
}

impl fmt::Display for Scale {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Scale::Linear => "linear",
            Scale::Log => "logarithmic",
        })
    }
}

/// What an axis shows.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Axis {
    /// The quantity, in words.
    pub title: String,
    /// Its unit; empty where there is none.
    pub unit: String,
    /// How it is divided.
    pub scale: Scale,
}

impl Axis {
    /// An axis of equal differences.
    pub fn linear(title: &str, unit: &str) -> Self {
        Axis { title: title.into(), unit: unit.into(), scale: Scale::Linear }
    }

    /// An axis of equal ratios.
    pub fn log(title: &str, unit: &str) -> Self {
        Axis { title: title.into(), unit: unit.into(), scale: Scale::Log }
    }

    /// The title with its unit in brackets, and before the unit the power of ten that the ticks
    /// leave out, on as many lines as the width asks for.
    pub(crate) fn heading(&self, left_out: i32, width: f64) -> Vec<Label> {
        let mut lines: Vec<Label> =
            wrapped(&self.title, width, TEXT).into_iter().map(Label::plain).collect();
        let Some(unit) = self.unit_label(left_out) else { return lines };
        match lines.pop() {
            Some(last) if last.width() + unit.width() + 4.0 <= width => {
                lines.push(last.then(Label::plain(" ")).then(unit));
            }
            last => lines.extend(last.into_iter().chain([unit])),
        }
        lines
    }

    fn unit_label(&self, left_out: i32) -> Option<Label> {
        let factor = (left_out != 0).then(|| Label::power_of_ten(left_out));
        let unit = (!self.unit.is_empty()).then(|| Label::plain(self.unit.clone()));
        let inside = match (factor, unit) {
            (None, None) => return None,
            (Some(factor), Some(unit)) => factor.then(Label::plain(" ")).then(unit),
            (Some(one), None) | (None, Some(one)) => one,
        };
        Some(Label::plain("[").then(inside).then(Label::plain("]")))
    }
}

/// Where a value is on an axis.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Place {
    /// At this pixel.
    At(f64),
    /// Zero or negative on a logarithmic axis: before its start.
    Before,
    /// NaN or infinite: nowhere.
    Nowhere,
}

/// An axis with its extent, laid over pixels from `start` to `end` (which may run backwards).
#[derive(Clone, Debug)]
pub(crate) struct Ruler {
    scale: Scale,
    low: f64,
    high: f64,
    start: f64,
    end: f64,
    /// Whether all values are whole numbers, between which there is nothing.
    whole: bool,
}

impl Ruler {
    /// Covers the values that have a place, with `margin` (a share of the extent) on both sides.
    pub(crate) fn covering(
        scale: Scale,
        values: impl IntoIterator<Item = f64>,
        margin: f64,
        (start, end): (f64, f64),
    ) -> Self {
        let (mut low, mut high) = (f64::INFINITY, f64::NEG_INFINITY);
        let mut whole = scale == Scale::Linear;
        for value in values.into_iter().filter_map(|value| measure(scale, value)) {
            low = low.min(value);
            high = high.max(value);
            whole &= value.fract() == 0.0;
        }
        if low > high {
            (low, high, whole) = (0.0, 1.0, false);
        }
        whole &= high - low >= 1.0;
        // A single value, or values apart by rounding only, still need an extent to be seen in.
        let narrowest = match scale {
            Scale::Log => 0.3,
            Scale::Linear => (1e-12 * low.abs().max(high.abs())).max(LEAST_EXTENT),
        };
        if high - low < narrowest {
            let middle = 0.5 * (low + high);
            let half = match scale {
                Scale::Log => 0.5,
                // Numbers so small leave no room for steps between them: they are as good as zero.
                Scale::Linear if middle.abs() < LEAST_EXTENT => 1.0,
                Scale::Linear => 0.1 * middle.abs(),
            };
            (low, high) = (middle - half, middle + half);
        }
        let margin = margin * (high - low);
        Ruler { scale, low: low - margin, high: high + margin, start, end, whole }
    }

    /// The same extent over other pixels.
    pub(crate) fn over(&self, (start, end): (f64, f64)) -> Self {
        Ruler { start, end, ..self.clone() }
    }

    /// Length of the extent, in units (or decades) of the axis.
    pub(crate) fn extent(&self) -> f64 {
        self.high - self.low
    }

    pub(crate) fn start(&self) -> f64 {
        self.start
    }

    pub(crate) fn place(&self, value: f64) -> Place {
        if !is_number(value) {
            return Place::Nowhere;
        }
        match measure(self.scale, value) {
            Some(measure) => Place::At(self.pixel(measure)),
            None => Place::Before,
        }
    }

    /// The pixel of a value that has one.
    pub(crate) fn at(&self, value: f64) -> Option<f64> {
        match self.place(value) {
            Place::At(pixel) => Some(pixel),
            Place::Before | Place::Nowhere => None,
        }
    }

    fn pixel(&self, measure: f64) -> f64 {
        let share = (measure - self.low) / (self.high - self.low);
        (self.start + share * (self.end - self.start)).clamp(-FARTHEST, FARTHEST)
    }

    /// How far a value is from the start of the axis, in units (or decades) of it.
    pub(crate) fn beyond_start(&self, value: f64) -> Option<f64> {
        measure(self.scale, value).map(|measure| measure - self.low)
    }

    /// Pixels per unit (or decade).
    pub(crate) fn density(&self) -> f64 {
        (self.end - self.start).abs() / (self.high - self.low)
    }
}

/// The least extent of an axis of equal differences: steps of a part of it are still normal numbers.
pub(crate) const LEAST_EXTENT: f64 = 1e-290;

/// Pixels beyond which a place is moved nearer. A line to there still has its direction, to a pixel.
pub(crate) const FARTHEST: f64 = 1e12;

/// Larger numbers leave no room for the arithmetic of an axis: they count as infinite.
const LARGEST: f64 = 1e300;

/// Whether a value can have a place on some axis.
pub(crate) fn is_number(value: f64) -> bool {
    value.abs() <= LARGEST
}

/// The value as the axis measures it: itself, or its decimal logarithm.
pub(crate) fn measure(scale: Scale, value: f64) -> Option<f64> {
    match scale {
        _ if !is_number(value) => None,
        Scale::Linear => Some(value),
        Scale::Log if value > 0.0 => Some(value.log10()),
        Scale::Log => None,
    }
}

/// A tick: where, and what it says; minor ticks say nothing.
#[derive(Clone, Debug)]
pub(crate) struct Tick {
    pub(crate) pixel: f64,
    pub(crate) label: Option<Label>,
}

/// The ticks of an axis and the power of ten that their labels leave out.
#[derive(Clone, Debug)]
pub(crate) struct Ticks {
    pub(crate) ticks: Vec<Tick>,
    pub(crate) left_out: i32,
}

impl Ticks {
    /// The same ticks so many pixels farther along.
    pub(crate) fn moved(mut self, by: f64) -> Self {
        self.ticks.iter_mut().for_each(|tick| tick.pixel += by);
        self
    }

    pub(crate) fn widest(&self) -> f64 {
        self.ticks.iter().filter_map(|t| t.label.as_ref()).map(Label::width).fold(0.0, f64::max)
    }
}

/// How much room a tick's label needs along its axis.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Along {
    /// Labels side by side: their width counts.
    Horizontal,
    /// Labels above each other: their height counts.
    Vertical,
}

impl Along {
    fn room(self, labels: &[Label]) -> f64 {
        match self {
            Along::Horizontal => labels.iter().map(Label::width).fold(30.0, f64::max) + 14.0,
            Along::Vertical => 38.0,
        }
    }
}

impl Ruler {
    /// A tick a category, as many of them with a name as there is room for.
    pub(crate) fn named_ticks(&self, names: &[String]) -> Ticks {
        let labels: Vec<Label> = names.iter().map(|name| Label::plain(name.clone())).collect();
        let widest = labels.iter().map(Label::width).fold(0.0, f64::max) + 8.0;
        let stride = (widest / self.density()).ceil().max(1.0) as usize;
        let ticks = labels.into_iter().enumerate().filter_map(|(i, label)| {
            let label = i.is_multiple_of(stride).then_some(label);
            Some(Tick { pixel: self.at(i as f64)?, label })
        });
        Ticks { ticks: ticks.collect(), left_out: 0 }
    }

    /// As many ticks as there is room for, at round numbers.
    pub(crate) fn ticks(&self, along: Along) -> Ticks {
        match self.scale {
            Scale::Linear => self.linear_ticks(self.low, self.high, along),
            Scale::Log if self.extent() < 2.2 => self.ticks_within_decades(along),
            Scale::Log => self.decade_ticks(along),
        }
    }

    fn linear_ticks(&self, low: f64, high: f64, along: Along) -> Ticks {
        let largest = low.abs().max(high.abs());
        let magnitude = largest.log10().floor() as i32;
        let left_out = if (-2..5).contains(&magnitude) { 0 } else { magnitude.div_euclid(3) * 3 };
        let unit = 10_f64.powi(left_out);
        let finest = ((high - low) / 40.0).log10().floor() as i32;
        let mut ticks = Vec::new();
        // Coarser and coarser; nine decades are beyond any chart, so the search ends.
        for (exponent, mantissa) in
            (finest..finest + 9).flat_map(|e| [(e, 1.0), (e, 2.0), (e, 5.0)])
        {
            let step = mantissa * 10_f64.powi(exponent);
            if !step.is_normal() || self.whole && step < 1.0 {
                continue;
            }
            let (first, last) = ((low / step).ceil(), (high / step).floor());
            if last < first {
                // The axis is too short for two labels: one of the last that are within it is left.
                ticks.truncate(1);
                break;
            }
            let count = (last - first) as usize + 1;
            if count > 60 {
                continue;
            }
            let decimals = (left_out - exponent).clamp(0, 15) as usize;
            let values: Vec<f64> = (0..count).map(|i| (first + i as f64) * step).collect();
            let labels: Vec<Label> =
                values.iter().map(|v| Label::plain(fixed(v / unit, decimals))).collect();
            let fits = count == 1 || step * self.linear_density() >= along.room(&labels);
            ticks = values
                .iter()
                .zip(labels)
                .filter_map(|(&v, label)| Some(Tick { pixel: self.at(v)?, label: Some(label) }))
                .collect();
            if fits {
                break;
            }
        }
        Ticks { ticks, left_out }
    }

    /// Pixels per unit at the crowded end of the axis.
    fn linear_density(&self) -> f64 {
        match self.scale {
            Scale::Linear => self.density(),
            Scale::Log => self.density() / (10_f64.powf(self.high) * std::f64::consts::LN_10),
        }
    }

    /// Less than about two decades: round multiples of powers of ten, or round differences.
    fn ticks_within_decades(&self, along: Along) -> Ticks {
        let every: &[u32] = &[1, 2, 3, 4, 5, 6, 7, 8, 9];
        for mantissas in [every, &[1, 2, 3, 5, 7], &[1, 2, 5], &[1, 3], &[1]] {
            let values: Vec<(u32, i32)> = (self.low.floor() as i32..=self.high.ceil() as i32)
                .flat_map(|e| mantissas.iter().map(move |&m| (m, e)))
                .filter(|&(m, e)| self.holds(f64::from(m).log10() + f64::from(e)))
                .collect();
            let labels: Vec<Label> = values.iter().map(|&(m, e)| self.log_label(m, e)).collect();
            let pixels: Vec<f64> = values
                .iter()
                .map(|&(m, e)| self.pixel(f64::from(m).log10() + f64::from(e)))
                .collect();
            let closest =
                pixels.windows(2).map(|p| (p[1] - p[0]).abs()).fold(f64::INFINITY, f64::min);
            if values.len() >= 2 && closest >= along.room(&labels) {
                let ticks = pixels
                    .into_iter()
                    .zip(labels)
                    .map(|(pixel, label)| Tick { pixel, label: Some(label) })
                    .collect();
                return Ticks { ticks, left_out: 0 };
            }
        }
        self.linear_ticks(10_f64.powf(self.low), 10_f64.powf(self.high), along)
    }

    fn decade_ticks(&self, along: Along) -> Ticks {
        let (first, last) = (self.low.ceil() as i32, self.high.floor() as i32);
        let stride = [1, 2, 3, 4, 5, 10, 20, 50, 100, 200]
            .into_iter()
            .find(|&stride| {
                let labels: Vec<Label> = (first..=last)
                    .filter(|e| e % stride == 0)
                    .map(|e| self.log_label(1, e))
                    .collect();
                f64::from(stride) * self.density() >= along.room(&labels)
            })
            .unwrap_or(500);
        let majors = (first..=last).map(|e| Tick {
            pixel: self.pixel(f64::from(e)),
            label: (e % stride == 0).then(|| self.log_label(1, e)),
        });
        let fine = if stride == 1 && self.density() > 36.0 { 2..10 } else { 2..2 };
        let minors = (first - 1..=last)
            .flat_map(|e| fine.clone().map(move |m| f64::from(m).log10() + f64::from(e)))
            .filter(|&measure| self.holds(measure))
            .map(|measure| Tick { pixel: self.pixel(measure), label: None });
        Ticks { ticks: majors.chain(minors).collect(), left_out: 0 }
    }

    fn holds(&self, measure: f64) -> bool {
        self.low <= measure && measure <= self.high
    }

    /// Plain numbers where the whole axis is made of everyday ones, else powers of ten.
    fn log_label(&self, mantissa: u32, exponent: i32) -> Label {
        if self.low >= -3.05 && self.high <= 4.05 {
            let decimals = (-exponent).max(0) as usize;
            return Label::plain(fixed(f64::from(mantissa) * 10_f64.powi(exponent), decimals));
        }
        Label::multiple(mantissa, exponent)
    }
}

#[cfg(test)]
#[path = "axis_tests.rs"]
mod tests;
