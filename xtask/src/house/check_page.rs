//! Opens pages, the report's and those of runs, in a browser and complains about what a reader would.
//!
//! On a desk and on a phone, in light and in dark: a console message, a request to anywhere, a
//! sideways scroll, text that is too small, covered or cut, a chart that answers neither the
//! pointer nor the arrow keys. Screenshots of all views are left beside the page.

mod browser;

use std::fs;
use std::io;
use std::path::{Path, PathBuf};

use serde::Deserialize;
use serde_json::{Value, json};

use browser::Browser;
pub use browser::BrowserError;

/// Something that a reader would mind.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum Complaint {
    /// The file names something outside of it.
    #[error("the file refers to `{0}`")]
    Reference(String),
    /// The page writes to the console.
    #[error("{view}: the console says: {text}")]
    Console {
        /// Where it was seen.
        view: String,
        /// What it says.
        text: String,
    },
    /// The page asks for something.
    #[error("{view}: the page requests {url}")]
    Request {
        /// Where it was seen.
        view: String,
        /// What it asks for.
        url: String,
    },
    /// The page is wider than the window.
    #[error("{view}: the page is {content} px wide in a window of {window} px")]
    Sideways {
        /// Where it was seen.
        view: String,
        /// Width of the page.
        content: u64,
        /// Width of the window.
        window: u64,
    },
    /// A text is hard to read.
    #[error("{view}: {what}")]
    Text {
        /// Where it was seen.
        view: String,
        /// What is wrong with which text.
        what: String,
    },
    /// Pointing at a chart shows nothing.
    #[error("{view}: pointing at a mark shows no numbers")]
    Mute {
        /// Where it was seen.
        view: String,
    },
    /// A chart that can be reached by the keyboard says nothing.
    #[error("{view}: an arrow key shows no numbers")]
    MuteToKeys {
        /// Where it was seen.
        view: String,
    },
    /// So many elements that a phone stutters.
    #[error("{view}: the page has {elements} elements, and {MOST_ELEMENTS} at most are swift")]
    Heavy {
        /// Where it was seen.
        view: String,
        /// How many elements.
        elements: u64,
    },
}

/// Why a page cannot be checked.
#[derive(Debug, thiserror::Error)]
pub enum CheckError {
    /// The page or a screenshot.
    #[error("{}: {source}", path.display())]
    File {
        /// Which file.
        path: PathBuf,
        /// What the system says.
        source: io::Error,
    },
    /// The browser.
    #[error(transparent)]
    Browser(#[from] BrowserError),
    /// The page's own answers make no sense.
    #[error("the page's answer: {0}")]
    Answer(#[from] serde_json::Error),
}

/// Elements that a page of all studies may have. It had 101,306 once, and was slow to scroll.
const MOST_ELEMENTS: u64 = 40_000;

/// A window in which the page is looked at.
struct View {
    name: &'static str,
    width: u64,
    height: u64,
    scheme: &'static str,
}

const VIEWS: [View; 6] = [
    View { name: "desk-light", width: 1400, height: 900, scheme: "light" },
    View { name: "desk-dark", width: 1400, height: 900, scheme: "dark" },
    // The narrowest window that has the contents at its side.
    View { name: "laptop-light", width: 1060, height: 800, scheme: "light" },
    // The narrowest window that still has wide charts.
    View { name: "tablet-light", width: 767, height: 1024, scheme: "light" },
    View { name: "phone-light", width: 390, height: 844, scheme: "light" },
    View { name: "phone-dark", width: 390, height: 844, scheme: "dark" },
];

/// Checks pages, or the `index.html` of folders, one after the other in one browser, and writes `screenshots` beside
/// each: the complaints of each.
///
/// # Errors
/// What prevents looking; what is seen is a complaint.
pub fn check_pages(pages: &[impl AsRef<Path>]) -> Result<Vec<Vec<Complaint>>, CheckError> {
    let mut browser = Browser::start()?;
    pages.iter().map(|page| check(&mut browser, page.as_ref())).collect()
}

fn check(browser: &mut Browser, page: &Path) -> Result<Vec<Complaint>, CheckError> {
    let page = if page.is_dir() { page.join("index.html") } else { page.to_owned() };
    let page = page.canonicalize().map_err(at(&page))?;
    let folder = page.parent().unwrap_or(&page);
    let text = fs::read_to_string(&page).map_err(at(&page))?;
    let screenshots = folder.join("screenshots");
    fs::create_dir_all(&screenshots).map_err(at(&screenshots))?;
    let mut complaints: Vec<Complaint> =
        outside_references(&text).into_iter().map(Complaint::Reference).collect();
    for view in &VIEWS {
        complaints.extend(look(browser, view, &page, &screenshots)?);
    }
    Ok(complaints)
}

fn at(path: &Path) -> impl FnOnce(io::Error) -> CheckError {
    let path = path.to_owned();
    |source| CheckError::File { path, source }
}

/// Addresses outside of the file, wherever they stand. The name of the SVG language is none.
fn outside_references(text: &str) -> Vec<String> {
    let text = text.replace("http://www.w3.org/2000/svg", "");
    let marks = ["http://", "https://", "src=\"//", "href=\"//", "url(//", "@import", "fetch("];
    let mut found: Vec<(usize, String)> = marks
        .iter()
        .flat_map(|mark| text.match_indices(mark))
        .map(|(start, _)| {
            (start, text[start..].chars().take(60).take_while(|c| !c.is_whitespace()).collect())
        })
        .collect();
    found.sort();
    found.into_iter().map(|(_, reference)| reference).collect()
}

fn look(
    browser: &mut Browser,
    view: &View,
    page: &Path,
    screenshots: &Path,
) -> Result<Vec<Complaint>, CheckError> {
    let url = format!("file://{}", page.display());
    let &View { name, width, height, scheme } = view;
    open_window(browser, width, height)?;
    // A page that scrolls smoothly answers a second and a half after it is told where to go.
    let preferences = json!([
        { "name": "prefers-color-scheme", "value": scheme },
        { "name": "prefers-reduced-motion", "value": "reduce" },
    ]);
    browser.call("Emulation.setEmulatedMedia", json!({ "features": preferences }))?;
    browser.take_events();
    browser.call("Page.navigate", json!({ "url": url }))?;
    browser.wait_for("Page.loadEventFired")?;

    let answer = browser.evaluate(include_str!("check_page/probe.js"))?;
    let seen: Seen = serde_json::from_value(answer)?;
    photograph(browser, view, seen.height, &screenshots.join(name))?;
    let mute = is_mute(browser)?;
    let mute_to_keys = is_mute_to_keys(browser)?;

    let view = || name.to_owned();
    let mut complaints: Vec<Complaint> =
        browser.take_events().iter().filter_map(|event| heard(event, &url, name)).collect();
    if seen.width > width {
        complaints.push(Complaint::Sideways { view: view(), content: seen.width, window: width });
    }
    complaints.extend(seen.texts.into_iter().map(|what| Complaint::Text { view: view(), what }));
    complaints.extend(mute.then(|| Complaint::Mute { view: view() }));
    complaints.extend(mute_to_keys.then(|| Complaint::MuteToKeys { view: view() }));
    if seen.elements > MOST_ELEMENTS {
        complaints.push(Complaint::Heavy { view: view(), elements: seen.elements });
    }
    Ok(complaints)
}

/// Gives the page a window of a size in pixels.
fn open_window(browser: &mut Browser, width: u64, height: u64) -> Result<(), CheckError> {
    let mobile = width < 640;
    let size =
        json!({ "width": width, "height": height, "deviceScaleFactor": 1, "mobile": mobile });
    browser.call("Emulation.setDeviceMetricsOverride", size)?;
    Ok(())
}

/// What the probe says of the page.
#[derive(Deserialize)]
struct Seen {
    width: u64,
    height: u64,
    elements: u64,
    texts: Vec<String>,
}

/// The complaint that an event of the browser is, if it is one.
fn heard(event: &Value, page: &str, view: &str) -> Option<Complaint> {
    let (view, params) = (view.to_owned(), &event["params"]);
    let words = |value: &Value| value.as_str().unwrap_or("?").to_owned();
    match event["method"].as_str()? {
        "Runtime.consoleAPICalled" => {
            let arguments = params["args"].as_array()?.iter();
            let text: Vec<String> = arguments
                .map(|a| a["value"].as_str().map_or(a.to_string(), str::to_owned))
                .collect();
            Some(Complaint::Console { view, text: text.join(" ") })
        }
        "Runtime.exceptionThrown" => {
            let text = words(&params["exceptionDetails"]["exception"]["description"]);
            Some(Complaint::Console { view, text })
        }
        "Log.entryAdded" => {
            Some(Complaint::Console { view, text: words(&params["entry"]["text"]) })
        }
        "Network.requestWillBeSent" => {
            let url = words(&params["request"]["url"]);
            let own = url == page || url.starts_with("data:");
            (!own).then_some(Complaint::Request { view, url })
        }
        _ => None,
    }
}

/// Points at the first mark of the page, and sees whether its numbers appear.
fn is_mute(browser: &mut Browser) -> Result<bool, CheckError> {
    let mark = browser.evaluate(
        "(() => { const mark = [...document.querySelectorAll('.pt, .cell')].find(m => m.getClientRects().length && m.getBoundingClientRect().width);
           if (!mark) return null;
           mark.scrollIntoView({ block: 'center', behavior: 'instant' });
           const r = mark.getBoundingClientRect();
           return { x: r.x + r.width / 2, y: r.y + r.height / 2 }; })()",
    )?;
    if mark.is_null() {
        return Ok(false);
    }
    // The scroll hides a tooltip when its event is handled, so the pointer comes a frame later.
    browser.evaluate("new Promise(done => requestAnimationFrame(() => setTimeout(done, 50)))")?;
    let moved = json!({ "type": "mouseMoved", "x": mark["x"], "y": mark["y"] });
    browser.call("Input.dispatchMouseEvent", moved)?;
    let hidden = browser.evaluate("document.getElementById('tip')?.hidden ?? true")?;
    Ok(hidden != Value::Bool(false))
}

/// Goes to the first chart that the keyboard reaches, and sees whether an arrow key says a number. A
/// page without such a chart is no report.
fn is_mute_to_keys(browser: &mut Browser) -> Result<bool, CheckError> {
    let chart = browser.evaluate(
        "(() => { document.getElementById('tip')?.setAttribute('hidden', '');
           const chart = [...document.querySelectorAll('.chart[tabindex]')].find(c => c.getClientRects().length && c.querySelector('[data-says]'));
           chart?.focus({ preventScroll: true });
           return !!chart; })()",
    )?;
    if chart != Value::Bool(true) {
        return Ok(false);
    }
    for kind in ["keyDown", "keyUp"] {
        let key = json!({ "type": kind, "key": "ArrowRight", "code": "ArrowRight" });
        browser.call("Input.dispatchKeyEvent", key)?;
    }
    let hidden = browser.evaluate("document.getElementById('tip')?.hidden ?? true")?;
    Ok(hidden != Value::Bool(false))
}

/// The browser cannot take a taller picture at once.
const TALLEST: u64 = 8000;

/// Writes `name.png`, and `name-2.png`, ... for what is below: of a window as tall as it may be, as a picture of what
/// no window shows has the whole page laid out anew.
fn photograph(
    browser: &mut Browser,
    view: &View,
    page_height: u64,
    name: &Path,
) -> Result<(), CheckError> {
    open_window(browser, view.width, page_height.clamp(1, TALLEST))?;
    for (i, top) in (0..page_height.max(1)).step_by(TALLEST as usize).enumerate() {
        browser.evaluate(&format!("scrollTo(0, {top})"))?;
        let params = json!({ "format": "png", "optimizeForSpeed": true });
        let picture = browser.call("Page.captureScreenshot", params)?;
        let bytes = from_base64(picture["data"].as_str().unwrap_or(""));
        let number = if i == 0 { String::new() } else { format!("-{}", i + 1) };
        let file = PathBuf::from(format!("{}{number}.png", name.display()));
        fs::write(&file, bytes).map_err(at(&file))?;
    }
    open_window(browser, view.width, view.height)
}

/// Bytes of a base64 text (RFC 4648); other letters are passed over.
fn from_base64(text: &str) -> Vec<u8> {
    let mut bytes = Vec::with_capacity(text.len() / 4 * 3);
    let (mut bits, mut held) = (0_u32, 0);
    for letter in text.bytes() {
        let six = match letter {
            b'A'..=b'Z' => letter - b'A',
            b'a'..=b'z' => letter - b'a' + 26,
            b'0'..=b'9' => letter - b'0' + 52,
            b'+' => 62,
            b'/' => 63,
            _ => continue,
        };
        bits = bits << 6 | u32::from(six);
        held += 6;
        if held >= 8 {
            held -= 8;
            bytes.push((bits >> held) as u8);
        }
    }
    bytes
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn base64_is_read_back() {
        assert_eq!(from_base64("aGVsbG8="), b"hello");
        assert_eq!(from_base64("AP8Q"), [0, 255, 16]);
        assert!(from_base64("").is_empty());
    }

    #[test]
    fn references_outside_of_the_file_are_found_and_the_name_of_svg_is_none() {
        let page = r#"<svg xmlns="http://www.w3.org/2000/svg"><img src="https://a.org/b.png">"#;
        assert_eq!(outside_references(page), [r#"https://a.org/b.png">"#]);
        assert!(
            outside_references(r##"<a href="#here">http</a> <a href="x.csv">x</a>"##).is_empty()
        );
    }
}
