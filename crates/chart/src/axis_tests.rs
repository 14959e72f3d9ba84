//! Ticks: where they are, what they say, and that they do not overlap.

use super::*;
use crate::label::Run;

fn text(label: &Label) -> String {
    label
        .0
        .iter()
        .map(|run| match run {
            Run::Plain(text) => text.clone(),
            Run::Raised(text) => format!("^{text}"),
        })
        .collect()
}

fn texts(ruler: &Ruler) -> Vec<String> {
    let ticks = ruler.ticks(Along::Horizontal);
    ticks.ticks.iter().filter_map(|t| t.label.as_ref()).map(text).collect()
}

#[test]
fn linear_ticks_are_round_numbers() {
    let ruler = Ruler::covering(Scale::Linear, [0.0, 10.0], 0.0, (0.0, 300.0));
    assert_eq!(texts(&ruler), ["0", "2", "4", "6", "8", "10"]);
}

#[test]
fn between_whole_numbers_there_is_no_tick() {
    let ruler = Ruler::covering(Scale::Linear, [0.0, 3.0, 1.0, 2.0], 0.04, (0.0, 600.0));
    assert_eq!(texts(&ruler), ["0", "1", "2", "3"]);
    let ruler = Ruler::covering(Scale::Linear, [0.0, 3.0, 1.5], 0.04, (0.0, 600.0));
    assert!(texts(&ruler).len() > 4);
}

#[test]
fn large_and_small_numbers_leave_a_power_of_ten_to_the_title() {
    let ruler = Ruler::covering(Scale::Linear, [0.0, 3e-7], 0.0, (0.0, 250.0));
    assert_eq!(ruler.ticks(Along::Horizontal).left_out, -9);
    assert_eq!(texts(&ruler), ["0", "100", "200", "300"]);
    let heading = Axis::linear("drift", "J").heading(-9, 300.0);
    assert_eq!(heading.iter().map(text).collect::<Vec<_>>(), ["drift [10^−9 J]"]);
}

#[test]
fn decades_are_written_as_powers() {
    let ruler = Ruler::covering(Scale::Log, [1e-6, 1.0], 0.0, (0.0, 420.0));
    assert_eq!(texts(&ruler), ["10^−6", "10^−5", "10^−4", "10^−3", "10^−2", "10^−1", "1"]);
}

#[test]
fn labels_never_overlap_at_any_width_or_range() {
    for width in [40.0, 90.0, 200.0, 333.0, 560.0, 1200.0] {
        for decades in [0.31, 0.5, 0.9, 1.3, 2.0, 3.7, 8.0, 16.0, 40.0, 600.0] {
            for start in [-300.0_f64, -16.0, -3.2, -0.1, 0.0, 5.0] {
                let values = [10_f64.powf(start), 10_f64.powf(start + decades)];
                for scale in [Scale::Log, Scale::Linear] {
                    let ruler = Ruler::covering(scale, values, 0.04, (0.0, width));
                    for along in [Along::Horizontal, Along::Vertical] {
                        assert_no_overlap(&ruler, along);
                    }
                }
            }
        }
    }
}

fn assert_no_overlap(ruler: &Ruler, along: Along) {
    let mut spans: Vec<(f64, f64)> = ruler
        .ticks(along)
        .ticks
        .iter()
        .filter_map(|tick| {
            let half = match along {
                Along::Horizontal => 0.5 * tick.label.as_ref()?.width(),
                Along::Vertical => 8.0,
            };
            tick.label.as_ref()?;
            Some((tick.pixel - half, tick.pixel + half))
        })
        .collect();
    spans.sort_by(|a, b| a.0.total_cmp(&b.0));
    assert!(spans.windows(2).all(|s| s[0].1 <= s[1].0), "{ruler:?} {along:?} {spans:?}");
}

#[test]
fn a_narrow_logarithmic_axis_still_has_two_labels() {
    for (low, high) in [(1.0, 1.9), (3.1e-5, 5.2e-5), (2.0, 9.0), (0.95, 1.06)] {
        let ruler = Ruler::covering(Scale::Log, [low, high], 0.0, (0.0, 400.0));
        assert!(texts(&ruler).len() >= 2, "{low} {high} {:?}", texts(&ruler));
    }
}

#[test]
fn values_without_a_place_do_not_stretch_the_axis() {
    let values = [f64::NAN, f64::INFINITY, -1.0, 0.0, 10.0, 1000.0];
    let ruler = Ruler::covering(Scale::Log, values, 0.0, (0.0, 100.0));
    assert_eq!(ruler.at(10.0), Some(0.0));
    assert_eq!(ruler.at(1000.0), Some(100.0));
    assert_eq!(ruler.place(0.0), Place::Before);
    assert_eq!(ruler.place(f64::NAN), Place::Nowhere);
}

#[test]
fn no_value_and_one_value_still_make_an_axis() {
    for values in [vec![], vec![f64::NAN], vec![3.0], vec![0.0], vec![1e-300], vec![f64::MAX]] {
        for scale in [Scale::Linear, Scale::Log] {
            let ruler = Ruler::covering(scale, values.clone(), 0.04, (0.0, 300.0));
            let ticks = ruler.ticks(Along::Horizontal);
            assert!(ticks.ticks.iter().all(|t| t.pixel.is_finite()), "{scale:?} {values:?}");
        }
    }
}
