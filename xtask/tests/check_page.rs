//! A page that is fine is passed, and each thing that a reader would mind is found.
//!
//! These start a browser: `cargo test -p xtask --test check_page -- --ignored`.

use std::fs;

use xtask::check_page::{Complaint, check_pages};

const VIEWS: [&str; 6] =
    ["desk-light", "desk-dark", "laptop-light", "tablet-light", "phone-light", "phone-dark"];

/// What is said of a page with this body.
fn complaints(name: &str, body: &str) -> Vec<Complaint> {
    let folder = std::env::temp_dir().join(format!("check-page-{name}-{}", std::process::id()));
    fs::create_dir_all(&folder).unwrap();
    let head = r#"<meta charset="utf-8"><meta name="viewport" content="width=device-width">"#;
    let page =
        format!("<!doctype html><html lang=en><head>{head}</head><body>{body}</body></html>");
    fs::write(folder.join("index.html"), page).unwrap();
    let complaints = check_pages(&[&folder]).unwrap().concat();
    for view in VIEWS {
        assert!(folder.join(format!("screenshots/{view}.png")).exists());
    }
    fs::remove_dir_all(&folder).unwrap();
    complaints
}

#[test]
#[ignore = "starts Chromium"]
fn a_plain_page_is_passed() {
    assert_eq!(complaints("plain", "<p>Nothing to complain of.</p>"), []);
}

#[test]
#[ignore = "starts Chromium"]
fn a_console_message_is_heard() {
    let said = complaints("console", "<script>console.log('left over')</script>");
    let heard = |c: &Complaint| matches!(c, Complaint::Console { text, .. } if text == "left over");
    assert!(said.len() == VIEWS.len() && said.iter().all(heard), "{said:?}");
}

#[test]
#[ignore = "starts Chromium"]
fn an_exception_is_heard() {
    let said = complaints("exception", "<script>nothing.there()</script>");
    assert!(said.iter().all(|c| matches!(c, Complaint::Console { .. })), "{said:?}");
    assert_eq!(said.len(), VIEWS.len());
}

#[test]
#[ignore = "starts Chromium"]
fn a_request_is_seen_in_the_text_and_by_the_browser() {
    let said = complaints("request", r#"<img src="https://example.invalid/a.png">"#);
    assert!(matches!(&said[0], Complaint::Reference(_)), "{said:?}");
    assert!(said.iter().any(|c| matches!(c, Complaint::Request { .. })), "{said:?}");
}

#[test]
#[ignore = "starts Chromium"]
fn a_page_wider_than_a_phone_is_seen_on_the_phone_only() {
    let said = complaints("wide", r#"<div style="width:500px">wide</div>"#);
    let on_phone =
        |c: &Complaint| matches!(c, Complaint::Sideways { view, .. } if view.starts_with("phone"));
    assert!(said.len() == 2 && said.iter().all(on_phone), "{said:?}");
}

#[test]
#[ignore = "starts Chromium"]
fn small_covered_and_cut_texts_are_seen() {
    let chart = r#"<svg class="chart" viewBox="0 0 200 40" width="200">
        <text x="0" y="20" font-size="6">tiny</text>
        <text x="50" y="20">one</text><text x="52" y="20">two</text>
        <text x="190" y="20">outside</text></svg>"#;
    let said: Vec<String> = complaints("texts", chart).iter().map(ToString::to_string).collect();
    for words in [r#""tiny" is 6.0 px"#, r#""one" covers "two""#, r#""outside" leaves its chart"#] {
        assert!(said.iter().any(|line| line.contains(words)), "{words}: {said:?}");
    }
}

#[test]
#[ignore = "starts Chromium"]
fn a_chart_that_says_nothing_is_seen() {
    let chart = r#"<svg class="chart" viewBox="0 0 100 100" width="100">
        <g class="pt" transform="translate(50 50)"><circle r="5"/></g></svg><div id="tip" hidden></div>"#;
    let said = complaints("mute", chart);
    assert!(
        said.len() == VIEWS.len() && said.iter().all(|c| matches!(c, Complaint::Mute { .. })),
        "{said:?}"
    );
}

#[test]
#[ignore = "starts Chromium"]
fn a_chart_that_is_mute_to_the_arrow_keys_is_seen() {
    let chart = r#"<svg class="chart" tabindex="0" width="40" height="40"><path data-says="1" d="M0 0h9v9z"/></svg>"#;
    let said = complaints("keys", &format!(r#"{chart}<div id="tip" hidden></div>"#));
    assert!(said.iter().all(|c| matches!(c, Complaint::MuteToKeys { .. })), "{said:?}");
    assert_eq!(said.len(), VIEWS.len());
}
