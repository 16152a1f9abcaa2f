//! `*ELASTIC`: isotropic, orthotropic along x, y, z, the engineering constants of the same, or any law.

use super::Model;
use super::property::{of_material, twice};
use crate::error::{DeckError, Fault};
use crate::lexer::Card;
use nalgebra::Matrix3;
use signorini_fem_mesh::{Hooke, HookeError};

const ISOTROPIC: &str = "Young's modulus and Poisson's ratio in one line, and at most a temperature: laws that depend \
    on temperature are not read";
const ORTHOTROPIC: &str = "nine numbers, eight in the first line: D1111, D1122, D2222, D1133, D2233, D3333, D1212, \
    D1313, D2323, and at most a temperature: laws that depend on temperature are not read";
const ENGINEERING: &str = "nine numbers, eight in the first line: E1, E2, E3, nu12, nu13, nu23, G12, G13, G23, and at \
    most a temperature: laws that depend on temperature are not read";
const ANISOTROPIC: &str = "21 numbers, eight in a line: D1111, D1122, D2222, D1133, D2233, D3333, D1112, D2212, D3312, D1212, \
    D1113, D2213, D3313, D1213, D1313, D1123, D2223, D3323, D1223, D1323, D2323, and at most a temperature: laws that depend on \
    temperature are not read";

pub(super) fn elastic(model: &mut Model, card: &Card) -> Result<(), DeckError> {
    card.allow(&["TYPE"])?;
    let material = of_material(model, card)?;
    let kind = card.value("TYPE")?;
    let (wanted, count) = match kind.as_ref().map_or("ISO", |kind| &kind.name) {
        "ISO" | "ISOTROPIC" => (ISOTROPIC, 2),
        "ORTHO" | "ORTHOTROPIC" => (ORTHOTROPIC, 9),
        "ENGINEERINGCONSTANTS" => (ENGINEERING, 9),
        "ANISO" | "ANISOTROPIC" => (ANISOTROPIC, 21),
        _ => {
            let why = "TYPE is ISO, ORTHO, ENGINEERING CONSTANTS or ANISO";
            let word = kind.as_ref().map_or(&card.word, |kind| &kind.word);
            return Err(word.fault(Fault::Unsupported(why)));
        }
    };
    let mut numbers = Vec::with_capacity(count + 1);
    for line in &card.lines {
        if numbers.len() >= count {
            return Err(line.expected(wanted));
        }
        let fields = line.at_most(count + 1 - numbers.len(), wanted)?;
        for at in 0..fields.len() {
            numbers.push(line.real(&fields, at, wanted)?);
        }
    }
    let (Some(first), Some(last)) = (card.lines.first(), card.lines.last()) else {
        return Err(card.word.expected(wanted));
    };
    if numbers.len() < count {
        return Err(last.expected(wanted));
    }
    if let Some((before, _)) = &material.elastic {
        return Err(twice(card, before));
    }
    let law = match (wanted, &numbers[..]) {
        (ORTHOTROPIC, n) => orthotropic([[n[0], n[1], n[3]], [n[1], n[2], n[4]], [n[3], n[4], n[5]]], &n[6..9]),
        (ENGINEERING, n) => orthotropic(inverse(n), &n[6..9]),
        (ANISOTROPIC, n) => anisotropic(n),
        (_, n) => Hooke::isotropic(n[0], n[1]),
    };
    let law = law.map_err(|error| first.fault(Fault::Hooke(error)))?;
    material.elastic = Some((first.location.clone(), law));
    Ok(())
}

/// A law from its normal part and the shear moduli 12, 13, 23.
fn orthotropic(normal: [[f64; 3]; 3], shear: &[f64]) -> Result<Hooke, HookeError> {
    let mut c = [[0.0; 6]; 6];
    for (row, values) in normal.iter().enumerate() {
        c[row][..3].copy_from_slice(values);
    }
    // the order is yz, xz, xy
    for (row, value) in (3..6).zip(shear.iter().rev()) {
        c[row][row] = *value;
    }
    Hooke::from_voigt(&c)
}

/// Any law from the columns of the upper triangle, in the order 11, 22, 33, 12, 13, 23.
fn anisotropic(numbers: &[f64]) -> Result<Hooke, HookeError> {
    let place = [0, 1, 2, 5, 4, 3];
    let mut c = [[0.0; 6]; 6];
    let upper = (0..6).flat_map(|column| (0..=column).map(move |row| (row, column)));
    for ((row, column), value) in upper.zip(numbers) {
        let [row, column] = [row, column].map(|k| place[k]);
        c[row][column] = *value;
        c[column][row] = *value;
    }
    Hooke::from_voigt(&c)
}

/// The normal part of the stiffness from E1, E2, E3, nu12, nu13, nu23: the inverse of that of the compliance.
fn inverse(n: &[f64]) -> [[f64; 3]; 3] {
    let compliance = Matrix3::from([
        [1.0 / n[0], -n[3] / n[0], -n[4] / n[0]],
        [-n[3] / n[0], 1.0 / n[1], -n[5] / n[1]],
        [-n[4] / n[0], -n[5] / n[1], 1.0 / n[2]],
    ]);
    // of none the law is refused
    compliance.try_inverse().map_or([[f64::NAN; 3]; 3], Into::into)
}
