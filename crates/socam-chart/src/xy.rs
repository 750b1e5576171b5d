//! One channel over another, each sample a dot with the colour of a third quantity, such as time.

use egui::{Color32, Mesh, Shape, vec2};
use egui_plot::{PlotPoint, PlotTransform};

use super::colours::Colours;

/// Radius of a dot, points.
const RADIUS: f32 = 1.3;

/// Dots over a pair of axes.
#[derive(Debug, Clone)]
pub struct Cloud {
    /// Dots: x, y and the quantity of the colour. Later ones are on top.
    pub dots: Vec<[f64; 3]>,
    /// The quantity of the colours.
    pub colours: Colours,
}

/// Keeps of any number of samples those that a picture can show: the last one of each cell of a grid, and the samples with the
/// least and the greatest x and y.
#[derive(Debug)]
pub struct Thinner {
    ranges: [[f64; 2]; 2],
    cells: [usize; 2],
    /// Number of the last sample of each cell, plus one; 0 without a sample.
    last: Vec<u64>,
    dots: Vec<[f64; 3]>,
    /// Samples with the least x, greatest x, least y and greatest y, and their numbers.
    extremes: [Option<(u64, [f64; 3])>; 4],
    count: u64,
}

impl Thinner {
    /// Creates a thinner for a picture with these ranges, horizontal and vertical. `cells` is their number in each direction: about
    /// one for every two pixels.
    #[must_use]
    pub fn new(ranges: [[f64; 2]; 2], cells: [usize; 2]) -> Self {
        let cells = cells.map(|count| count.clamp(1, 4096));
        let number = cells[0] * cells[1];
        Self {
            ranges,
            cells,
            last: vec![0; number],
            dots: vec![[0.0; 3]; number],
            extremes: [None; 4],
            count: 0,
        }
    }

    /// Takes a sample. Samples that are missing or outside of the ranges are left out.
    pub fn push(&mut self, sample: [f64; 3]) {
        self.count += 1;
        let mut cell = 0;
        for axis in [1, 0] {
            let [low, high] = self.ranges[axis];
            let share = (sample[axis] - low) / (high - low);
            if !(0.0..=1.0).contains(&share) {
                return;
            }
            let count = self.cells[axis];
            cell = cell * count + ((share * count as f64) as usize).min(count - 1);
        }
        (self.last[cell], self.dots[cell]) = (self.count, sample);
        for (number, extreme) in self.extremes.iter_mut().enumerate() {
            let (axis, sign) = (number / 2, if number % 2 == 0 { 1.0 } else { -1.0 });
            if extreme.is_none_or(|(_, known)| sign * sample[axis] < sign * known[axis]) {
                *extreme = Some((self.count, sample));
            }
        }
    }

    /// The dots in the order of their samples.
    #[must_use]
    pub fn dots(self) -> Vec<[f64; 3]> {
        let kept = self.last.into_iter().zip(self.dots).filter(|(number, _)| *number > 0);
        let mut dots: Vec<(u64, [f64; 3])> = kept.chain(self.extremes.into_iter().flatten()).collect();
        dots.sort_unstable_by_key(|(number, _)| *number);
        dots.dedup_by_key(|(number, _)| *number);
        dots.into_iter().map(|(_, dot)| dot).collect()
    }
}

impl Cloud {
    /// One mesh of small squares with a soft edge, however many dots there are.
    pub(super) fn shapes(&self, transform: &PlotTransform, shapes: &mut Vec<Shape>) {
        let frame = transform.frame().expand(2.0 * RADIUS);
        let mut mesh = Mesh::default();
        for [x, y, value] in &self.dots {
            let at = transform.position_from_point(&PlotPoint::new(*x, *y));
            if !frame.contains(at) {
                continue;
            }
            let start = mesh.vertices.len() as u32;
            let colour = self.colours.of(*value);
            for (radius, colour) in [(RADIUS - 0.5, colour), (RADIUS + 0.5, Color32::TRANSPARENT)] {
                for (right, down) in [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)] {
                    mesh.colored_vertex(at + vec2(radius * right, radius * down), colour);
                }
            }
            mesh.add_triangle(start, start + 1, start + 2);
            mesh.add_triangle(start, start + 2, start + 3);
            for side in 0..4 {
                let next = (side + 1) % 4;
                mesh.add_triangle(start + side, start + next, start + 4 + side);
                mesh.add_triangle(start + next, start + 4 + side, start + 4 + next);
            }
        }
        if !mesh.is_empty() {
            shapes.push(Shape::mesh(mesh));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_million_samples_become_a_picture_of_them_with_its_extremes() {
        let count = 1_000_000;
        let sample = |n: u32| {
            let angle = f64::from(n) * 0.1;
            let radius = if n == 123_456 { 2.0 } else { 1.0 };
            [radius * angle.cos(), radius * angle.sin(), f64::from(n)]
        };
        let mut thinner = Thinner::new([[-2.5, 2.5]; 2], [400, 300]);
        (0..count).for_each(|n| thinner.push(sample(n)));
        thinner.push([f64::NAN, 0.0, 1e9]);
        thinner.push([99.0, 0.0, 1e9]);
        let dots = thinner.dots();
        assert!((500..3000).contains(&dots.len()), "{}", dots.len());
        assert!(dots.contains(&sample(123_456)), "the one sample that is apart is lost");
        for axis in 0..2 {
            let values = || (0..count).map(|n| sample(n)[axis]);
            let (low, high) = (values().fold(f64::MAX, f64::min), values().fold(f64::MIN, f64::max));
            assert!(dots.iter().any(|dot| dot[axis] == low) && dots.iter().any(|dot| dot[axis] == high));
        }
        assert!(dots.is_sorted_by_key(|dot| dot[2]), "later dots are on top");
    }
}
