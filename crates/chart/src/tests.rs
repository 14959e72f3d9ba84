//! What must hold of every chart, whatever its data.

use super::*;

fn draw(chart: &Chart) -> Vec<String> {
    let styles = Styles::assign(&[], &[chart.names()]);
    let layouts = [Layout::Wide, Layout::Narrow];
    layouts.map(|layout| chart.svg(layout, Medium::File, &styles, "a chart").unwrap()).to_vec()
}

/// Elements are closed in the order they were opened, and no number is missing.
fn assert_well_formed(svg: &str) {
    let mut open: Vec<&str> = Vec::new();
    for tag in svg.split('<').skip(1) {
        let inside = tag.split('>').next().unwrap();
        let name = inside.split_whitespace().next().unwrap().trim_end_matches('/');
        if let Some(closing) = name.strip_prefix('/') {
            assert_eq!(open.pop(), Some(closing), "{svg}");
        } else if !inside.ends_with('/') {
            open.push(name);
        }
    }
    assert!(open.is_empty(), "{open:?}");
    let text = svg.replace("the value is NaN", "").replace("the value is inf", "");
    assert!(!text.contains("=\"NaN") && !text.contains("(NaN"), "{svg}");
    for attribute in svg.split(" d=\"").skip(1).map(|rest| rest.split('"').next().unwrap()) {
        assert!(!attribute.contains("NaN") && !attribute.contains("inf"), "{attribute}");
    }
}

fn hostile_values() -> Vec<f64> {
    let extremes = [f64::NAN, f64::INFINITY, f64::NEG_INFINITY, f64::MAX, f64::MIN, 5e-324];
    extremes.into_iter().chain([0.0, -0.0, -1.0, 1.0, 1e-300, 1e300]).collect()
}

fn hostile_points() -> Vec<(f64, f64)> {
    let values = hostile_values();
    values.iter().flat_map(|&x| values.iter().map(move |&y| (x, y))).collect()
}

fn axes(scale: Scale) -> [Axis; 2] {
    ["step", "error"].map(|title| Axis { title: title.into(), unit: "m".into(), scale })
}

#[test]
fn numbers_without_a_place_never_break_a_chart() {
    for scale in [Scale::Linear, Scale::Log] {
        let [x, y] = axes(scale);
        let mut lines = Lines::new("lines", x.clone(), y.clone())
            .with(Series::new("a", hostile_points()).failed(f64::NAN, "why").failed(-1.0, "why"))
            .with(Series::new("empty", []))
            .with(Series::new("dots", hostile_points()).marked(Mark::Markers))
            .curve("curve", hostile_points())
            .mark_front();
        for value in hostile_values() {
            lines = lines.slope(2.0, (value, value)).with(Series::new("one", [(value, value)]));
        }
        let map = Map::new("map", x.clone(), y.clone(), ["stable"]).border("b", hostile_points());
        let values = hostile_values();
        let bars =
            Bars::new("bars", "case", values.iter().map(f64::to_string), Axis::linear("y", ""))
                .with(BarSeries::new("a", values.clone()))
                .with(BarSeries::new("b", values.iter().rev().copied()));
        let mut ladder = Ladder::new("ladder", x, y, 1e-3).choose(3);
        for (cost, error) in hostile_points() {
            ladder = ladder.rung("a", "step = 1 s", cost, Judged::Error(error));
            ladder = ladder.rung("b", "step = 1 s", cost, Judged::Failed("why".into()));
        }
        let charts: [Chart; 4] = [lines.into(), map.into(), bars.into(), ladder.into()];
        charts.iter().flat_map(draw).for_each(|svg| assert_well_formed(&svg));
    }
    let [x, y] = axes(Scale::Linear);
    let field: Vec<_> = hostile_points().into_iter().map(|p| (p, p)).collect();
    let portrait = Portrait::new("portrait", x, y).field(field);
    let portrait = portrait.curve(Series::new("c", hostile_points()));
    draw(&portrait.into()).iter().for_each(|svg| assert_well_formed(svg));
}

fn error(chart: impl Into<Chart>) -> String {
    chart.into().file("").unwrap_err().to_string()
}

#[test]
fn what_no_drawing_can_show_is_a_typed_error() {
    let nan = f64::NAN;
    let [x, y] = axes(Scale::Log);
    let linear = Axis::linear("error", "m");
    let mixed = Lines::new("", x.clone(), linear.clone()).slope(2.0, (1.0, 1.0));
    assert_eq!(
        error(mixed),
        "a slope of 2 is no line on axes of which x is logarithmic and y is linear"
    );
    let steep = Lines::new("", x.clone(), y.clone()).slope(nan, (1.0, 1.0));
    assert!(error(steep).starts_with("a slope of NaN"));
    for (x_place, y_place) in [(nan, 1.0), (1.0, 0.0), (-1.0, 1.0), (1.0, f64::INFINITY)] {
        let mut map = Map::new("", x.clone(), y.clone(), ["stable"]);
        map.cell(x_place, y_place, "stable");
        assert!(error(map).ends_with("has no place on the axes of its map"));
    }
    let mut map = Map::new("", x.clone(), y.clone(), ["stable"]);
    map.cells.push((1.0, 1.0, 7));
    assert_eq!(error(map), "a cell has outcome 7, and 1 outcomes are listed");
    let portrait = Portrait::new("", linear.clone(), y.clone());
    assert_eq!(error(portrait), "portraits need linear axes, and `error` is logarithmic");
    let portrait = Portrait::new("", linear.clone(), linear.clone());
    assert!(error(portrait.step("s", (0.0, nan), (1.0, 1.0))).starts_with("the step of s from"));
    let bars = Bars::new("", "ball", ["1", "2"], y.clone());
    assert_eq!(error(bars), "bars need linear axes, and `error` is logarithmic");
    let bars = Bars::new("", "ball", ["1", "2"], linear).with(BarSeries::new("a", [1.0]));
    assert_eq!(error(bars), "a has 1 values for 2 categories");
    for tolerance in [0.0, -1.0, nan, f64::INFINITY] {
        let ladder = Ladder::new("", x.clone(), y.clone(), tolerance);
        assert!(error(ladder).starts_with(&format!("the tolerance is {tolerance}")));
    }
    let ladder = Ladder::new("", x, y, 1.0).choose(0);
    assert_eq!(error(ladder), "the choice is rung 0 of 0, counted from 0");
}

#[test]
fn empty_charts_are_charts_that_say_so() {
    let [x, y] = axes(Scale::Log);
    let lines = Lines::new("", x.clone(), y.clone()).mark_front();
    let map = Map::new("", x.clone(), y.clone(), []);
    let bars = Bars::new("", "", [""; 0], Axis::linear("", ""));
    let ladder = Ladder::new("", x, y, 1.0);
    let charts: [Chart; 4] = [lines.into(), map.into(), bars.into(), ladder.into()];
    for svg in charts.iter().flat_map(draw) {
        assert_well_formed(&svg);
        assert!(svg.contains(">no data</text>"), "{svg}");
    }
    let [x, y] = axes(Scale::Linear);
    draw(&Portrait::new("", x, y).into()).iter().for_each(|svg| assert_well_formed(svg));
}

#[test]
fn the_rest_is_thin_and_grey_and_says_its_name_when_pointed_at() {
    let [x, y] = axes(Scale::Log);
    let lines = Lines::new("", x, y)
        .with(Series::new("best", [(1.0, 1.0), (2.0, 0.5)]))
        .with(Series::new("other", [(1.0, 2.0), (2.0, 1.5)]).as_rest());
    let chart = Chart::from(lines);
    assert_eq!(chart.names(), ["best"]);
    for svg in draw(&chart) {
        assert!(svg.contains(r#"<g class="rest">"#) && svg.contains("<title>other\n"), "{svg}");
        assert!(svg.contains(">the others</text>") && !svg.contains(">other</text>"), "{svg}");
        assert!(svg.find("<title>other").unwrap() < svg.find("<title>best").unwrap(), "{svg}");
    }
}

#[test]
fn a_curve_that_another_covers_is_drawn_wider() {
    let [x, y] = axes(Scale::Linear);
    let points = [(1.0, 1.0), (2.0, 0.5), (3.0, 0.7)];
    let lines = Lines::new("", x, y)
        .with(Series::new("below", points))
        .with(Series::new("above", points))
        .with(Series::new("elsewhere", points.map(|(x, y)| (x, y + 1.0))));
    for svg in draw(&lines.into()) {
        assert_eq!(svg.matches(r#"<g class="s0 wide1">"#).count(), 1, "{svg}");
        assert_eq!(svg.matches(" wide1\"").count(), 1, "{svg}");
    }
}

#[test]
fn a_bar_begins_at_zero_and_its_length_is_its_value() {
    let axis = Axis::linear("velocity", "m/s");
    let bars = Bars::new("", "ball", ["1", "2", "3"], axis)
        .with(BarSeries::new("a", [1.0, 2.0, f64::NAN]));
    let svg = &draw(&bars.into())[0];
    let heights: Vec<f64> = svg
        .split(r#"<path class="bar" d="M"#)
        .skip(1)
        .filter(|bar| bar.contains("<title>"))
        .map(|bar| bar.split(['v', 'h']).nth(2).unwrap().parse().unwrap())
        .collect();
    assert_eq!(heights.len(), 2);
    assert!((heights[1] - 2.0 * heights[0]).abs() <= 0.2, "{heights:?}");
    assert!(svg.contains("a failed\nball: 3\nthe value is NaN"), "{svg}");
}

#[test]
fn a_ladder_rings_its_choice_and_says_what_meets_the_tolerance() {
    let [x, y] = axes(Scale::Log);
    let ladder = Ladder::new("", x, y, 1e-3)
        .rung("a", "step = 1 s", 10.0, Judged::Error(1e-2))
        .rung("a", "step = 0.1 s", 100.0, Judged::Error(1e-4))
        .rung("b", "step = 2 s", 5.0, Judged::Failed("diverged".into()))
        .choose(1);
    for svg in draw(&ladder.into()) {
        assert_eq!(svg.matches(r#"class="choice""#).count(), 2, "{svg}");
        assert!(svg.contains(">chosen: a, step = 0.1 s</text>"), "{svg}");
        assert!(svg.contains(">meets 0.001 below</text>"), "{svg}");
        assert!(svg.contains("step = 2 s: diverged") && svg.contains("\nstep = 1 s</title>"));
    }
}

#[test]
fn names_reasons_and_titles_are_escaped() {
    let evil = "</text><script>alert('&')</script>";
    let axis = || Axis::linear(evil, evil);
    let lines = Lines::new(evil, axis(), axis())
        .with(Series::new(evil, [(0.0, 0.0), (1.0, 1.0)]).failed(0.5, evil))
        .curve(evil, [(0.0, 0.0), (1.0, 1.0)]);
    let mut map = Map::new(evil, axis(), axis(), [evil]);
    map.cell(0.0, 0.0, evil);
    let portrait = Portrait::new(evil, axis(), axis()).step(evil, (0.0, 0.0), (1.0, 1.0));
    let charts: [Chart; 3] = [lines.into(), map.into(), portrait.into()];
    for svg in charts.iter().flat_map(draw) {
        assert_well_formed(&svg);
        assert!(!svg.contains("<script"), "{svg}");
    }
}

#[test]
fn a_failure_is_on_the_chart_with_its_reason() {
    let [x, y] = axes(Scale::Log);
    let chart: Chart = Lines::new("", x, y)
        .with(Series::new("verlet", [(0.1, 1e-3), (0.2, 4e-3)]))
        .with(Series::new("euler", []).failed(0.2, "diverged at t = 3 s"))
        .into();
    for svg in draw(&chart) {
        assert!(svg.contains("euler failed\nstep: 0.2 m\ndiverged at t = 3 s"), "{svg}");
        assert!(svg.contains(r#"class="fail""#) && svg.contains(">failed<"), "{svg}");
        assert!(svg.contains(">euler</text>"), "its name is on the chart too");
    }
}

#[test]
fn the_front_names_the_methods_that_no_method_beats() {
    let [x, y] = axes(Scale::Log);
    let lines = Lines::new("", x, y)
        .with(Series::new("a", [(1.0, 1.0), (4.0, 0.5)]))
        .with(Series::new("b", [(2.0, 0.1), (5.0, f64::NAN)]));
    assert_eq!(lines.front_points(), [("a", (1.0, 1.0)), ("b", (2.0, 0.1))]);
}

#[test]
fn a_point_says_its_name_and_its_numbers_with_units() {
    let chart: Chart = Lines::new("", Axis::log("step", "s"), Axis::log("error", "m"))
        .with(Series::new("verlet", [(0.125, 1.25e-7)]))
        .into();
    assert!(draw(&chart)[0].contains("<title>verlet\nstep: 0.125 s\nerror: 1.25e-7 m</title>"));
}

/// The numbers of each path of a class.
fn paths(svg: &str, class: &str) -> Vec<Vec<f64>> {
    let begin = format!("class=\"{class}\" d=\"");
    let data = svg.split(&begin).skip(1).filter_map(|rest| rest.split('"').next());
    data.map(|d| d.split(['M', 'L', ' ']).filter_map(|word| word.parse().ok()).collect()).collect()
}

#[test]
fn ticks_are_within_their_axis_however_short_it_is() {
    for k in 0..60 {
        let (offset, slim) = (0.37 * 1.9_f64.powi(k), 10_f64.powi(-(k % 5)));
        let [x, y] = axes(Scale::Linear);
        let corners = [(offset, offset), (offset * (1.0 + slim), 2.0 * offset)];
        let [x_turned, y_turned] = axes(Scale::Linear);
        let turned = corners.map(|(x, y)| (y, x));
        for chart in [
            Portrait::new("", x, y).curve(Series::new("c", corners)),
            Portrait::new("", x_turned, y_turned).curve(Series::new("c", turned)),
        ] {
            for svg in draw(&chart.into()) {
                let axis = &paths(&svg, "axis")[0];
                let [left, top, _, bottom, right, _] = axis[..] else { panic!("{axis:?}") };
                let grid = paths(&svg, "grid");
                assert!(grid.iter().any(|line| line[0] == line[2]), "no tick along x: {svg}");
                assert!(grid.iter().any(|line| line[1] == line[3]), "no tick along y: {svg}");
                for line in &grid {
                    let (across, down) = (line[0].max(line[2]), line[1].max(line[3]));
                    let within = left - 0.1 <= line[0] && across <= right + 0.1;
                    assert!(within && top - 0.1 <= line[1] && down <= bottom + 0.1, "{line:?}");
                }
            }
        }
    }
}

#[test]
fn what_is_among_the_least_numbers_is_drawn_as_zero() {
    for size in [1e-312, 5e-324, 1e-300] {
        let [x, y] = axes(Scale::Linear);
        let field = [((size, size), (1.0, 0.0)), ((3.0 * size, 2.0 * size), (0.0, 1.0))];
        let mut map = Map::new("", x.clone(), y.clone(), ["stable", "lost"]);
        map.cell(size, size, "stable");
        map.cell(2.0 * size, 3.0 * size, "lost");
        let charts = [Portrait::new("", x, y).field(field).into(), Chart::from(map)];
        for svg in charts.iter().flat_map(draw) {
            assert!(svg.contains(r#"height="#) && !svg.contains(">inf<"), "{svg}");
            let axis = &paths(&svg, "axis")[0];
            assert!(axis[3] - axis[1] > 100.0 && svg.contains(">0.5</text>"), "{size} {svg}");
        }
    }
}

#[test]
fn a_point_that_is_zero_on_one_axis_has_its_place_on_the_other() {
    let [x, y] = axes(Scale::Log);
    let points = [(1.0, 1.0), (2.0, 0.5), (100.0, 0.0)];
    let lines = Lines::new("", x.clone(), y.clone()).with(Series::new("a", points));
    let turned = Lines::new("", x, y).with(Series::new("a", points.map(|(x, y)| (y, x))));
    for svg in [lines, turned].map(Chart::from).iter().flat_map(draw) {
        let axis = &paths(&svg, "axis")[0];
        let place =
            svg.split("transform=\"translate(").find(|part| part.contains("beyond the axis"));
        let place: Vec<f64> =
            place.unwrap().split([' ', ')']).take(2).map(|word| word.parse().unwrap()).collect();
        assert!(axis[0] <= place[0] && place[0] <= axis[4], "{place:?} {axis:?}");
        assert!(axis[1] <= place[1] && place[1] <= axis[3], "{place:?} {axis:?}");
    }
}

#[test]
fn a_prediction_is_the_same_line_whichever_of_its_points_is_given() {
    let [x, y] = axes(Scale::Linear);
    let lines = || {
        let series = Series::new("a", [(0.0, 0.0), (1.0, 1.0)]);
        Lines::new("", x.clone(), y.clone()).with(series)
    };
    let guide = |lines: Lines| paths(&Chart::from(lines).file("").unwrap(), "guide")[0].clone();
    let at = |slope: f64, x: f64| (x, 0.25 + slope * x);
    for (slope, far) in [(2.0, 1e3), (2.0, 1e6), (0.5, 1e9), (-1.0, 1e5), (1.0, -1e7)] {
        let near = guide(lines().slope(slope, at(slope, 0.0)));
        assert_eq!(guide(lines().slope(slope, at(slope, far))), near, "{slope} {far}");
        let curve = |far: f64| guide(lines().curve("", [at(slope, 0.0), at(slope, far)]));
        assert_eq!(curve(far), curve(10.0_f64.copysign(far)), "{slope} {far}");
    }
}

#[test]
fn the_heading_has_the_power_of_ten_that_the_ticks_below_many_failures_leave_out() {
    let [_, y] = axes(Scale::Log);
    let mut series = Series::new("a", [(1.0, 1.4e-9), (2.0, 5e-9), (3.0, 7.5e-8)]);
    for _ in 0..8 {
        series = series.failed(2.0, "why");
    }
    let chart = Chart::from(Lines::new("", Axis::linear("step", "s"), y).with(series));
    let [_, narrow] = &draw(&chart)[..] else { panic!() };
    assert!(narrow.contains(">50</text>"), "{narrow}");
    assert!(narrow.contains(r#"error [10<tspan class="sup" dy="-5">−9<"#), "{narrow}");
}

#[test]
fn names_of_any_number_of_words_stay_within_the_chart() {
    let [x, y] = axes(Scale::Log);
    let long =
        "a method whose name says all that there is to say of it, and somewhat more than that";
    let mut lines = Lines::new("", x.clone(), y.clone());
    let mut ladder = Ladder::new("", x, y, 1e-3).choose(0);
    for name in [long, "short", "of the fourth order, with an error estimate of the third one"] {
        lines = lines.with(Series::new(name, [(1.0, 1.0), (2.0, 0.5)]));
        ladder = ladder.rung(name, "step = 0.001 s, tolerance = 1e-9", 1.0, Judged::Error(1e-4));
    }
    for svg in [Chart::from(lines), Chart::from(ladder)].iter().flat_map(draw) {
        let number = |text: &str, before: &str| -> f64 {
            let rest = text.split(before).nth(1).unwrap();
            rest.split(['"', ' ']).next().unwrap().parse().unwrap()
        };
        let (width, height) = (number(&svg, "viewBox=\"0 0 "), number(&svg, "height=\""));
        let names: Vec<&str> = svg.split("<text class=\"name\"").skip(1).collect();
        assert!(names.len() >= 3);
        for name in names {
            let words = name.split(['>', '<']).nth(1).unwrap();
            let right = number(name, "x=\"") + crate::label::text_width(words, crate::label::TEXT);
            assert!(right <= width && number(name, "y=\"") <= height, "{words} {right}");
        }
    }
}

#[test]
fn a_wide_label_of_a_slim_plot_stays_within_the_chart() {
    let [x, y] = axes(Scale::Linear);
    let slim = [(55.07382737742, 0.0), (55.0738273775, 1.0)];
    for svg in draw(&Portrait::new("", x, y).curve(Series::new("c", slim)).into()) {
        let labels: Vec<&str> = svg.split("<text class=\"tl mid\" x=\"").skip(1).collect();
        assert!(!labels.is_empty());
        for label in labels {
            let (place, rest) = label.split_once('"').unwrap();
            let words = rest.split(['>', '<']).nth(1).unwrap();
            let half = 0.5 * crate::label::text_width(words, crate::label::TEXT);
            assert!(place.parse::<f64>().unwrap() >= half, "{words} at {place}");
        }
    }
}
