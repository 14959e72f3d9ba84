//! What must hold of every chart, whatever its data.

use super::*;

fn draw(chart: &Chart) -> Vec<String> {
    let styles = Styles::assign(&[], &[chart.names()]);
    let layouts = [Layout::Wide, Layout::Narrow];
    layouts.map(|layout| chart.svg(layout, Medium::File, &styles, "a chart")).to_vec()
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
            lines = lines.slope(value, (value, value)).with(Series::new("one", [(value, value)]));
        }
        let mut map =
            Map::new("map", x.clone(), y.clone(), ["stable"]).border("b", hostile_points());
        hostile_points().into_iter().for_each(|(x, y)| map.cell(x, y, "diverged"));
        let field: Vec<_> = hostile_points().into_iter().map(|p| (p, p)).collect();
        let mut portrait = Portrait::new("portrait", x, y).field(field);
        portrait = portrait.curve(Series::new("c", hostile_points()));
        for point in hostile_points() {
            portrait = portrait.step("s", point, (point.1, point.0));
        }
        let charts: [Chart; 3] = [lines.into(), map.into(), portrait.into()];
        charts.iter().flat_map(draw).for_each(|svg| assert_well_formed(&svg));
    }
}

#[test]
fn empty_charts_are_charts() {
    let [x, y] = axes(Scale::Log);
    let lines = Lines::new("", x.clone(), y.clone()).mark_front();
    let map = Map::new("", x.clone(), y.clone(), []);
    let charts: [Chart; 3] = [lines.into(), map.into(), Portrait::new("", x, y).into()];
    charts.iter().flat_map(draw).for_each(|svg| assert_well_formed(&svg));
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
