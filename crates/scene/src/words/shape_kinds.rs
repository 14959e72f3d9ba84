//! Shapes from a word and some numbers: generators of `stationary-mesh`, curved where they are round
//! and the elements are quadratic.

use stationary_mesh::{
    Diagonals, MeshError, QuadraticSegments, QuadraticTetrahedra, QuadraticTriangles, ball, bar,
    cuboid, curved_ball, curved_disc, curved_sphere, curved_torus, disc, icosphere, rectangle,
    torus,
};
use toml::Spanned;

use crate::text::diagnostic::{Checked, at};
use crate::text::fault::Fault;
use crate::text::number::{Components, Count};
use crate::text::{check, limits};
use crate::words::laid_shape::{Element, Shape, block, outlined, sheet};
use crate::words::quadratic_shape::{curve, curved_block, curved_sheet};

type Make = fn(&[f64], &[usize]) -> Result<Shape, MeshError>;

/// What a word of `kind` means.
#[derive(Clone, Copy)]
struct Kind {
    linear: Make,
    quadratic: Make,
    /// How many vertices there will be of linear elements, or a little more.
    count: fn(&[u64]) -> u64,
    /// The cells whose vertices are the nodes of quadratic elements.
    refined: fn(u64) -> u64,
    /// The least dimension of a scene that it fits into.
    dimension: usize,
    /// How many numbers `size` and `cells` have.
    numbers: [usize; 2],
    /// What `size` is.
    size: &'static str,
}

const KINDS: [(&str, Kind); 7] = [
    (
        "bar",
        Kind {
            linear: |size, cells| Ok(outlined(&bar(size[0], cells[0])?)),
            quadratic: |size, cells| curve(&QuadraticSegments::straight(&bar(size[0], cells[0])?)),
            count: |cells| cells[0].saturating_add(1),
            refined: twice,
            dimension: 1,
            numbers: [1, 1],
            size: "its length",
        },
    ),
    (
        "rectangle",
        Kind {
            linear: |size, cells| {
                let cells = [cells[0], cells[1]];
                sheet(&rectangle([size[0], size[1]], cells, Diagonals::Alternating)?)
            },
            quadratic: |size, cells| {
                let cells = [cells[0], cells[1]];
                let mesh = rectangle([size[0], size[1]], cells, Diagonals::Alternating)?;
                curved_sheet(&QuadraticTriangles::straight(&mesh))
            },
            count: |cells| cells[0].saturating_add(1).saturating_mul(cells[1].saturating_add(1)),
            refined: twice,
            dimension: 2,
            numbers: [2, 2],
            size: "its two sides",
        },
    ),
    (
        "disc",
        Kind {
            linear: |size, cells| sheet(&disc(size[0], cells[0])?),
            quadratic: |size, cells| curved_sheet(&curved_disc(size[0], cells[0])?),
            count: |cells| cells[0].saturating_mul(cells[0].saturating_add(1)).saturating_mul(3),
            refined: twice,
            dimension: 2,
            numbers: [1, 1],
            size: "its radius",
        },
    ),
    (
        "box",
        Kind {
            linear: |size, cells| {
                let size = [size[0], size[1], size[2]];
                block(&cuboid(size, [cells[0], cells[1], cells[2]])?)
            },
            quadratic: |size, cells| {
                let size = [size[0], size[1], size[2]];
                let mesh = cuboid(size, [cells[0], cells[1], cells[2]])?;
                curved_block(&QuadraticTetrahedra::straight(&mesh))
            },
            count: |cells| cells.iter().fold(1, |n: u64, &k| n.saturating_mul(k.saturating_add(1))),
            refined: twice,
            dimension: 3,
            numbers: [3, 3],
            size: "its three sides",
        },
    ),
    (
        "ball",
        Kind {
            linear: |size, cells| block(&ball(size[0], cells[0])?),
            quadratic: |size, cells| curved_block(&curved_ball(size[0], cells[0])?),
            count: |cells| 4_u64.saturating_mul(power(8, cells[0])),
            refined: one_more,
            dimension: 3,
            numbers: [1, 1],
            size: "its radius",
        },
    ),
    (
        "sphere",
        Kind {
            linear: |size, cells| sheet(&icosphere(size[0], cells[0])?),
            quadratic: |size, cells| curved_sheet(&curved_sphere(size[0], cells[0])?),
            count: |cells| 10_u64.saturating_mul(power(4, cells[0])),
            refined: one_more,
            dimension: 3,
            numbers: [1, 1],
            size: "its radius",
        },
    ),
    (
        "torus",
        Kind {
            linear: |size, cells| sheet(&torus([size[0], size[1]], [cells[0], cells[1]])?),
            quadratic: |size, cells| {
                curved_sheet(&curved_torus([size[0], size[1]], [cells[0], cells[1]])?)
            },
            count: |cells| cells[0].saturating_mul(cells[1]),
            refined: twice,
            dimension: 3,
            numbers: [2, 2],
            size: "the radii of its circle and of its tube",
        },
    ),
];

fn power(base: u64, levels: u64) -> u64 {
    base.saturating_pow(u32::try_from(levels).unwrap_or(u32::MAX))
}

fn twice(cells: u64) -> u64 {
    cells.saturating_mul(2)
}

fn one_more(levels: u64) -> u64 {
    levels.saturating_add(1)
}

/// The shape of a kind, in elements of this sort.
pub(crate) fn generated(
    dimension: usize,
    element: Element,
    kind: &Spanned<String>,
    size: &Components,
    cells: &Spanned<Vec<Spanned<Count>>>,
) -> Checked<Shape> {
    let of = check::word("shape", kind.get_ref(), kind.span(), &KINDS)?;
    if dimension < of.dimension {
        let fault = Fault::ShapeDimension { kind: kind.get_ref().clone(), dimension };
        return Err(at(kind.span(), fault));
    }
    let what = of.size;
    let wrong = |key, expected, got| Fault::ShapeNumbers { key, expected, got, what };
    if size.get_ref().len() != of.numbers[0] {
        return Err(at(size.span(), wrong("size", of.numbers[0], size.get_ref().len())));
    }
    if cells.get_ref().len() != of.numbers[1] {
        return Err(at(cells.span(), wrong("cells", of.numbers[1], cells.get_ref().len())));
    }
    let lengths = size.get_ref().iter().map(|x| check::positive("a size of the shape", x));
    let lengths = lengths.collect::<Checked<Vec<f64>>>()?;
    let numbers: Vec<u64> = cells.get_ref().iter().map(|count| count.get_ref().0).collect();
    let (make, nodes) = match element {
        Element::Linear => (of.linear, numbers.clone()),
        Element::Quadratic => (of.quadratic, numbers.iter().map(|&n| (of.refined)(n)).collect()),
    };
    let count = (of.count)(&nodes);
    if count > limits::PARTICLES {
        let fault = Fault::TooMany { what: "particles", count, limit: limits::PARTICLES };
        return Err(at(cells.span(), fault));
    }
    let numbers: Vec<usize> = numbers.into_iter().map(|n| n as usize).collect();
    make(&lengths, &numbers).map_err(|error| at(cells.span(), Fault::Shape(error.to_string())))
}
