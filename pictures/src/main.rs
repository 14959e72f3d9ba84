//! Whether pictures show what they should in a program that knows no style variables.
//!
//! Every SVG file in the folders that are named is rendered by resvg. Of each picture is asked:
//!
//! ```text
//! is it there?            paper covers part of it, ink another part
//! is it in colour?        no pixel is darker than the ink: what cannot be read is painted black
//! whose colours?          a hue that the file names is seen, and so is its plain value
//! is it all there?        nothing is drawn beyond its frame
//! ```

use std::env;
use std::error::Error;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::ExitCode;

use resvg::tiny_skia::{Pixmap, Transform};
use resvg::usvg::{Options, Tree};
use stationary_chart::{HUES, Tone};

/// Room around a picture in which nothing may be drawn, in pixels.
const AROUND: u32 = 40;
/// How far a channel may be from what was asked for: rounding.
const ROUNDING: i32 = 3;
/// How far a thin line's colour may be from what was asked for: its edges are mixed with paper.
const THIN: i32 = 110;
/// The least part of a picture that is paper, and that is not.
const LEAST: f64 = 0.002;

fn main() -> ExitCode {
    let folders: Vec<PathBuf> = env::args_os().skip(1).map(PathBuf::from).collect();
    if folders.is_empty() {
        eprintln!("name the folders that hold the pictures");
        return ExitCode::FAILURE;
    }
    let mut options = Options::default();
    options.fontdb_mut().load_system_fonts();
    // The generic family, where the system does not say which it is.
    let family = options.fontdb.faces().find_map(|face| Some(face.families.first()?.0.clone()));
    family.into_iter().for_each(|family| options.fontdb_mut().set_sans_serif_family(family));
    let (mut seen, mut complaints) = (0, 0);
    for folder in &folders {
        match pictures(folder) {
            Ok(files) if !files.is_empty() => {
                for file in files {
                    seen += 1;
                    let found =
                        looked_at(&file, &options).unwrap_or_else(|error| vec![error.to_string()]);
                    complaints += found.len();
                    found.iter().for_each(|words| eprintln!("{}: {words}", file.display()));
                }
            }
            Ok(_) => {
                complaints += 1;
                eprintln!("{}: no picture", folder.display());
            }
            Err(error) => {
                complaints += 1;
                eprintln!("{}: {error}", folder.display());
            }
        }
    }
    println!("{seen} pictures, {complaints} complaints");
    if complaints == 0 { ExitCode::SUCCESS } else { ExitCode::FAILURE }
}

/// The SVG files of a folder, in order.
fn pictures(folder: &Path) -> Result<Vec<PathBuf>, Box<dyn Error>> {
    let mut files = Vec::new();
    for entry in fs::read_dir(folder)? {
        let path = entry?.path();
        if path.extension().is_some_and(|extension| extension == "svg") {
            files.push(path);
        }
    }
    files.sort();
    Ok(files)
}

/// What is wrong with a picture.
fn looked_at(file: &Path, options: &Options) -> Result<Vec<String>, Box<dyn Error>> {
    let text = fs::read_to_string(file)?;
    complaints(&text, options)
}

fn complaints(text: &str, options: &Options) -> Result<Vec<String>, Box<dyn Error>> {
    let rendered = Rendered::of(text, options)?;
    let mut complaints = Vec::new();
    let count = |is: &dyn Fn(Colour) -> bool| rendered.inside().filter(|&c| is(c)).count() as f64;
    let all = count(&|_| true);
    let paper = count(&|colour| near(colour, PAPER, ROUNDING)) / all;
    if paper < LEAST {
        complaints.push(format!("{:.1} % of it is paper", 100.0 * paper));
    }
    if 1.0 - paper < LEAST {
        complaints.push("it is blank".to_owned());
    }
    let ink = parsed(Tone::Ink.on_light_paper());
    let darker = |colour: Colour| (0..3).all(|k| colour[k] + ROUNDING < ink[k]);
    let black = count(&darker) / all;
    if black > 0.0 {
        complaints.push(format!("{:.2} % of it is darker than the ink", 100.0 * black));
    }
    let body = text.split("</style>").last().unwrap_or(text);
    let hues: Vec<Colour> = (0..HUES)
        .filter(|hue| body.contains(&format!("class=\"s{hue}")))
        .map(|hue| parsed(Tone::Hue(hue).on_light_paper()))
        .collect();
    if !hues.is_empty() && !rendered.inside().any(|c| hues.iter().any(|&hue| near(c, hue, THIN))) {
        complaints.push("none of its hues is seen".to_owned());
    }
    let beyond = rendered.around().filter(|&c| !near(c, PAPER, ROUNDING)).count();
    if beyond > 0 {
        complaints.push(format!("{beyond} pixels are drawn beyond its frame"));
    }
    Ok(complaints)
}

/// Red, green and blue, from 0 to 255.
type Colour = [i32; 3];

const PAPER: Colour = [255; 3];

fn near(a: Colour, b: Colour, most: i32) -> bool {
    (0..3).all(|k| (a[k] - b[k]).abs() <= most)
}

/// `#rrggbb`
fn parsed(hex: &str) -> Colour {
    [1, 3, 5].map(|i| hex.get(i..i + 2).and_then(|d| i32::from_str_radix(d, 16).ok()).unwrap_or(0))
}

/// A picture in pixels, with room around it.
struct Rendered(Pixmap);

impl Rendered {
    fn of(text: &str, options: &Options) -> Result<Self, Box<dyn Error>> {
        let tree = Tree::from_str(text, options)?;
        let size = tree.size().to_int_size();
        let (width, height) = (size.width() + 2 * AROUND, size.height() + 2 * AROUND);
        let mut pixels = Pixmap::new(width, height).ok_or("too large to render")?;
        let moved = Transform::from_translate(AROUND as f32, AROUND as f32);
        resvg::render(&tree, moved, &mut pixels.as_mut());
        Ok(Rendered(pixels))
    }

    /// The colours of the picture itself, on white where it has no paper.
    fn inside(&self) -> impl Iterator<Item = Colour> {
        self.colours().filter_map(|(colour, inside)| inside.then_some(colour))
    }

    /// The colours around it.
    fn around(&self) -> impl Iterator<Item = Colour> {
        self.colours().filter_map(|(colour, inside)| (!inside).then_some(colour))
    }

    fn colours(&self) -> impl Iterator<Item = (Colour, bool)> {
        let (width, height) = (self.0.width(), self.0.height());
        self.0.pixels().iter().zip(0..).map(move |(pixel, place): (_, u32)| {
            let within = |x: u32, all: u32| (AROUND..all - AROUND).contains(&x);
            let inside = within(place % width, width) && within(place / width, height);
            let clear = 255 - i32::from(pixel.alpha());
            let colour = [pixel.red(), pixel.green(), pixel.blue()].map(|c| i32::from(c) + clear);
            (colour, inside)
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// What is complained of in a picture with this inside.
    fn said(inside: &str) -> Vec<String> {
        let text = format!(
            "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 100 50\" width=\"100\" \
             height=\"50\">{inside}</svg>"
        );
        complaints(&text, &Options::default()).unwrap()
    }

    #[test]
    fn a_square_of_a_hue_is_a_picture() {
        let hue = Tone::Hue(0).on_light_paper();
        let square = format!("<rect class=\"s0\" width=\"40\" height=\"40\" fill=\"{hue}\"/>");
        assert!(said(&square).is_empty());
    }

    #[test]
    fn a_colour_that_cannot_be_read_is_black_and_complained_of() {
        let style = "<style>.s0{fill:#1769c4;fill:var(--s0)}</style>";
        let square = "<rect class=\"s0\" width=\"40\" height=\"40\"/>";
        let said = said(&format!("{style}{square}"));
        assert_eq!(said, ["32.00 % of it is darker than the ink", "none of its hues is seen"]);
    }

    #[test]
    fn nothing_and_too_much_are_complained_of() {
        assert_eq!(said(""), ["it is blank"]);
        let hue = Tone::Hue(2).on_light_paper();
        let wide = format!("<rect width=\"110\" height=\"40\" fill=\"{hue}\"/>");
        assert_eq!(said(&wide), ["400 pixels are drawn beyond its frame"]);
        let full = format!("<rect width=\"100\" height=\"50\" fill=\"{hue}\"/>");
        assert_eq!(said(&full), ["0.0 % of it is paper"]);
    }
}
