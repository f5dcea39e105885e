//! Meshes with fewer triangles, for images in which they are small: Rossignac and Borrel, "Multi-resolution 3D
//! approximations for rendering complex scenes", 1993.

use crate::triangles::{Vertex, normal_of};
use std::collections::HashSet;

/// Returns the triangles that are left if the vertices of each cell of a grid become one, their mean. The longest side
/// of the mesh has `cells` cells.
pub(crate) fn simplified(triangles: &[Vertex], cells: usize) -> Vec<Vertex> {
    let (low, side) = bounds(triangles);
    let along = |x: f32, low: f32| ((x - low) / side * cells as f32) as usize;
    let cell = |vertex: &Vertex| {
        let at = [0, 1, 2].map(|k| along(vertex.position[k], low[k]).min(cells - 1));
        (at[0] * cells + at[1]) * cells + at[2]
    };
    // A mean for each cell that has vertices.
    let mut found = vec![u32::MAX; cells.pow(3)];
    let mut means: Vec<Mean> = Vec::new();
    let mut corners = Vec::new();
    for triangle in triangles.as_chunks::<3>().0 {
        corners.push(triangle.each_ref().map(|vertex| {
            let index = &mut found[cell(vertex)];
            if *index == u32::MAX {
                *index = means.len() as u32;
                means.push(Mean::default());
            }
            means[*index as usize].add(vertex);
            *index
        }));
    }
    // Two triangles of the same corners remain if they face opposite directions: both sides of a thin wall.
    let mut seen = HashSet::new();
    let distinct = |&[a, b, c]: &[u32; 3]| {
        let turned = [[a, b, c], [b, c, a], [c, a, b]].into_iter().min();
        a != b && b != c && c != a && seen.insert(turned)
    };
    let vertices = |corners: [u32; 3]| {
        let triangle = corners.map(|corner| means[corner as usize].vertex());
        let normal = normal_of(triangle.map(|vertex| vertex.position));
        triangle.map(|vertex| Vertex { normal, ..vertex })
    };
    corners
        .into_iter()
        .filter(distinct)
        .flat_map(vertices)
        .collect()
}

/// Returns the lowest corner of the box around triangles and its longest side, m.
pub(crate) fn bounds(triangles: &[Vertex]) -> ([f32; 3], f32) {
    let (mut low, mut high) = ([f32::INFINITY; 3], [f32::NEG_INFINITY; 3]);
    for vertex in triangles {
        for k in 0..3 {
            low[k] = low[k].min(vertex.position[k]);
            high[k] = high[k].max(vertex.position[k]);
        }
    }
    let side = (0..3).map(|k| high[k] - low[k]).fold(0.0, f32::max);
    (low, side)
}

/// The mean of vertices.
#[derive(Default)]
struct Mean {
    position: [f32; 3],
    texcoord: [f32; 3],
    count: f32,
}

impl Mean {
    fn add(&mut self, vertex: &Vertex) {
        self.count += 1.0;
        for k in 0..3 {
            self.position[k] += vertex.position[k];
            self.texcoord[k] += vertex.texcoord[k];
        }
    }

    /// Returns the mean, without a normal.
    fn vertex(&self) -> Vertex {
        Vertex {
            position: self.position.map(|x| x / self.count),
            normal: [0.0; 3],
            texcoord: self.texcoord.map(|x| x / self.count),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::triangles::string;
    use std::collections::HashMap;

    /// Returns true if triangles enclose a volume and are wound counterclockwise as seen from outside: each edge occurs
    /// as often in one direction as in the other, and the volume is positive.
    fn closed(triangles: &[Vertex]) -> bool {
        let mut edges = HashMap::new();
        let mut volume = 0.0;
        for triangle in triangles.as_chunks::<3>().0 {
            let [a, b, c] = triangle
                .each_ref()
                .map(|vertex| vertex.position.map(f32::to_bits));
            for (from, to) in [(a, b), (b, c), (c, a)] {
                match from < to {
                    true => *edges.entry((from, to)).or_insert(0) += 1,
                    false => *edges.entry((to, from)).or_insert(0) -= 1,
                }
            }
            volume += signed_volume(
                triangle
                    .each_ref()
                    .map(|vertex| vertex.position.map(f64::from)),
            );
        }
        volume > 0.0 && edges.values().all(|&count| count == 0)
    }

    /// Returns six times the volume of the tetrahedron of a triangle and the origin.
    fn signed_volume([a, b, c]: [[f64; 3]; 3]) -> f64 {
        let minor = |i: usize, k: usize| b[i] * c[k] - b[k] * c[i];
        a[0] * minor(1, 2) + a[1] * minor(2, 0) + a[2] * minor(0, 1)
    }

    #[test]
    fn a_simplified_surface_is_closed_and_near_the_surface() {
        // A cylinder of radius 1 and length 2.
        let cylinder = string(72);
        assert!(closed(&cylinder));
        assert!(!closed(&cylinder[3..]));
        let inside_out: Vec<Vertex> = cylinder.iter().rev().copied().collect();
        assert!(!closed(&inside_out));
        for cells in [8, 16] {
            let found = simplified(&cylinder, cells);
            assert!(!found.is_empty() && found.len() < cylinder.len() && closed(&found));
            for Vertex {
                position: [x, y, z],
                ..
            } in found
            {
                let radius = x.hypot(y);
                let outside = (radius - 1.0).max(z.abs() - 1.0);
                let inside = (1.0 - radius).min(1.0 - z.abs());
                assert!(outside < 1e-6 && inside < 2.0 / cells as f32, "{x} {y} {z}");
            }
        }
        assert!(simplified(&cylinder, 1).is_empty());
    }
}
