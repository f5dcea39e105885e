//! STL files, binary and text. Corners with the same bits are one vertex. Normals are ignored: in many files they are
//! wrong.

use super::triangles::{Triangles, floats};
use clench_math::Vec3;
use std::collections::HashMap;
use std::iter::Enumerate;
use std::str::{Lines, SplitAsciiWhitespace};

/// The length of a binary file's header: 80 arbitrary bytes, then the number of triangles.
const HEADER: usize = 84;
/// The length of a triangle: normal, three corners, two arbitrary bytes.
const TRIANGLE: usize = 50;
/// The length of a normal, three numbers.
const NORMAL: usize = 12;
/// The length of three corners of three numbers.
const CORNERS: usize = 36;

pub(super) fn read(bytes: &[u8]) -> Result<Triangles, String> {
    let mut mesh = Indexed::default();
    match is_binary(bytes)? {
        true => read_binary(&bytes[HEADER..], &mut mesh)?,
        false => read_text(&String::from_utf8_lossy(bytes), &mut mesh)?,
    }
    match mesh.triangles.faces.is_empty() {
        true => Err("the STL file has no triangles".to_owned()),
        false => Ok(mesh.triangles),
    }
}

/// Returns true if the bytes are a binary file. Some binary files begin with "solid", like text files, so the length
/// decides.
///
/// # Errors
/// Returns an error if they are not text and their length does not match their number of triangles.
fn is_binary(bytes: &[u8]) -> Result<bool, String> {
    let count = match bytes.get(80..HEADER) {
        Some(&[a, b, c, d]) => u32::from_le_bytes([a, b, c, d]) as usize,
        _ => 0,
    };
    let expected = HEADER + TRIANGLE * count;
    if bytes.len() >= HEADER && bytes.len() == expected {
        return Ok(true);
    }
    let start = bytes.trim_ascii_start().get(..5);
    if start.is_some_and(|word| word.eq_ignore_ascii_case(b"solid")) && !bytes.contains(&0) {
        return Ok(false);
    }
    Err(match bytes.len() < HEADER {
        true => "not an STL file: too short for a binary one, and not text".to_owned(),
        false => format!(
            "a binary STL file of {count} triangles has {expected} bytes, but this one {}",
            bytes.len()
        ),
    })
}

/// Triangles with equal corners merged.
#[derive(Default)]
struct Indexed {
    triangles: Triangles,
    vertices: HashMap<[u32; 3], u32>,
}

impl Indexed {
    /// Adds a triangle.
    ///
    /// # Errors
    /// Returns an error if there are too many vertices.
    fn push(&mut self, corners: [[f32; 3]; 3]) -> Result<(), String> {
        let mut face = [0; 3];
        for (index, corner) in face.iter_mut().zip(corners) {
            let vertices = &mut self.triangles.vertices;
            let next = u32::try_from(vertices.len()).map_err(|_| "too many vertices")?;
            *index = *self
                .vertices
                .entry(corner.map(f32::to_bits))
                .or_insert(next);
            if *index == next {
                vertices.push(Vec3::from_array(corner.map(f64::from)));
            }
        }
        self.triangles.faces.push(face);
        Ok(())
    }
}

fn read_binary(bytes: &[u8], mesh: &mut Indexed) -> Result<(), String> {
    for (number, triangle) in bytes.chunks_exact(TRIANGLE).enumerate() {
        let numbers = floats(&triangle[NORMAL..NORMAL + CORNERS]);
        let mut corners = [[0.0; 3]; 3];
        let coordinates = corners.as_flattened_mut().iter_mut();
        coordinates.zip(numbers).for_each(|(to, x)| *to = x);
        if !corners.as_flattened().iter().all(|x| x.is_finite()) {
            return Err(format!("triangle {number}: a coordinate is not finite"));
        }
        (mesh.push(corners)).map_err(|error| format!("triangle {number}: {error}"))?;
    }
    Ok(())
}

/// Reads all solids of a text, ignoring case.
fn read_text(text: &str, mesh: &mut Indexed) -> Result<(), String> {
    let mut lines = Text {
        lines: text.lines().enumerate(),
        number: 0,
    };
    while let Some((word, _)) = lines.next() {
        lines.expect(word, "solid")?;
        loop {
            let (word, _) = lines.need("facet or endsolid")?;
            if word.eq_ignore_ascii_case("endsolid") {
                break;
            }
            lines.expect(word, "facet")?;
            lines.take("outer")?;
            let corners = [lines.vertex()?, lines.vertex()?, lines.vertex()?];
            (mesh.push(corners)).map_err(|error| lines.error(&error))?;
            lines.take("endloop")?;
            lines.take("endfacet")?;
        }
    }
    Ok(())
}

/// The nonempty lines of a text.
struct Text<'a> {
    lines: Enumerate<Lines<'a>>,
    /// The number of the last line, from 1 on.
    number: usize,
}

impl<'a> Text<'a> {
    /// Returns the first word of the next line, and the others.
    fn next(&mut self) -> Option<(&'a str, SplitAsciiWhitespace<'a>)> {
        self.lines.by_ref().find_map(|(index, line)| {
            self.number = index + 1;
            let mut words = line.split_ascii_whitespace();
            Some((words.next()?, words))
        })
    }
    fn need(&mut self, what: &str) -> Result<(&'a str, SplitAsciiWhitespace<'a>), String> {
        let next = self.next();
        next.ok_or_else(|| self.error(&format!("the file ends where {what} should follow")))
    }
    /// Consumes a line that begins with `keyword` and returns its other words.
    fn take(&mut self, keyword: &str) -> Result<SplitAsciiWhitespace<'a>, String> {
        let (word, rest) = self.need(keyword)?;
        self.expect(word, keyword)?;
        Ok(rest)
    }
    fn vertex(&mut self) -> Result<[f32; 3], String> {
        let mut words = self.take("vertex")?;
        let mut corner = [0.0; 3];
        for coordinate in &mut corner {
            let word = words.next();
            let word = word.ok_or_else(|| self.error("a vertex has three coordinates"))?;
            let number = word.parse().ok().filter(|x: &f32| x.is_finite());
            let wrong = || self.error(&format!("\"{word}\" is not a finite number"));
            *coordinate = number.ok_or_else(wrong)?;
        }
        match words.next() {
            None => Ok(corner),
            Some(_) => Err(self.error("a vertex has three coordinates")),
        }
    }
    fn expect(&self, word: &str, keyword: &str) -> Result<(), String> {
        match word.eq_ignore_ascii_case(keyword) {
            true => Ok(()),
            false => Err(self.error(&format!("\"{word}\" where {keyword} should be"))),
        }
    }
    fn error(&self, what: &str) -> String {
        format!("not a valid STL file: line {}: {what}", self.number)
    }
}
