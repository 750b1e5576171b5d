//! Maps of efficiency and of its uncertainty over speed and torque, with lines of equal efficiency.
//!
//! Only operating points near recorded ones are coloured; other values would be extrapolated.

use socam_efficiency::Efficiency;
use socam_plot::{Axis, Contour, Heat, Panel, Row};

/// Columns and rows of a map.
const CELLS: [usize; 2] = [33, 25];
/// Greatest distance of a drawn cell from a recorded operating point, cells.
const REACH: f64 = 2.6;
/// Least efficiency of a drawn cell; below, there is almost no torque.
const LEAST: f64 = 0.3;
/// Number of points along a line of equal efficiency at which its visibility is checked.
const ALONG: usize = 120;

/// The map of one or more sections, one row each, on common scales. `names` are their titles.
#[must_use]
pub fn svg(sections: &[(&str, &Efficiency)]) -> String {
    let visited = || sections.iter().flat_map(|(_, efficiency)| &efficiency.visited);
    let most = [0, 1].map(|k| visited().map(|point| point[k]).fold(1e-9, f64::max));
    let cells: Vec<Vec<Cell>> = sections.iter().map(|(_, efficiency)| cells(efficiency, most)).collect();
    let sorted = |of: fn(&Cell) -> f64| {
        let mut values: Vec<f64> = cells.iter().flatten().map(of).filter(|value| value.is_finite()).collect();
        values.sort_by(f64::total_cmp);
        values
    };
    // The scale covers 90 % of the values, so that a few at the edge do not dominate it.
    let at = |values: &[f64], part: f64| {
        values.get((part * (values.len().max(1) - 1) as f64) as usize).copied().unwrap_or(0.0)
    };
    let (values, halves) = (sorted(|cell| 100.0 * cell.efficiency), sorted(|cell| 100.0 * cell.half));
    let colours = [at(&values, 0.08), at(&values, 1.0)];
    let of_halves = [0.0, at(&halves, 0.95).max(1e-3)];
    let rows: Vec<Row<'_>> = sections
        .iter()
        .zip(&cells)
        .map(|((name, efficiency), cells)| {
            let heat = |value: &str, unit: &str, colours, of: fn(&Cell) -> f64| Heat {
                title: format!("{name}: {value} over speed and torque"),
                x: (Axis::new("Input speed", "rad/s"), most[0]),
                y: (Axis::new("Input torque", "N m"), most[1]),
                value: Axis::new(value, unit),
                colours,
                size: CELLS,
                cells: cells
                    .iter()
                    .map(|cell| socam_plot::Cell { column: cell.column, row: cell.row, value: of(cell) })
                    .collect(),
                contours: Vec::new(),
                dots: &[],
            };
            let known = heat("95 % interval, to either side", "points", of_halves, |cell| 100.0 * cell.half);
            let efficient = heat("Efficiency", "%", colours, |cell| 100.0 * cell.efficiency);
            let panels = vec![
                Panel::Heat(Heat { contours: contours(efficiency, cells, colours, most), ..efficient }),
                Panel::Heat(Heat { dots: &efficiency.visited, ..known }),
            ];
            Row { title: (*name).to_owned(), panels }
        })
        .collect();
    socam_plot::sheet("efficiency over speed and torque", &rows)
}

struct Cell {
    column: usize,
    row: usize,
    efficiency: f64,
    half: f64,
}

fn cells(efficiency: &Efficiency, [speed, torque]: [f64; 2]) -> Vec<Cell> {
    let [columns, rows] = CELLS;
    let mut near = vec![false; columns * rows];
    for point in &efficiency.visited {
        let (x, y) = (point[0] / speed * columns as f64 - 0.5, point[1] / torque * rows as f64 - 0.5);
        for row in 0..rows {
            for column in 0..columns {
                near[row * columns + column] |= (x - column as f64).hypot(y - row as f64) < REACH;
            }
        }
    }
    let at = |index: usize| {
        let (row, column) = (index / columns, index % columns);
        let (x, y) = ((column as f64 + 0.5) / columns as f64, (row as f64 + 0.5) / rows as f64);
        let estimate = efficiency.losses.efficiency(x * speed, y * torque);
        Cell { column, row, efficiency: estimate.value, half: 0.5 * (estimate.ci95[1] - estimate.ci95[0]) }
    };
    (0..columns * rows).filter(|index| near[*index]).map(at).filter(|cell| cell.efficiency > LEAST).collect()
}

/// Lines of equal efficiency, which are straight: torque = (viscous speed + constant) / (1 - share - efficiency).
fn contours(
    efficiency: &Efficiency,
    cells: &[Cell],
    colours: [f64; 2],
    [speed, torque]: [f64; 2],
) -> Vec<Contour> {
    let is_drawn = |x: f64, y: f64| {
        let [column, row] =
            [x / speed * CELLS[0] as f64, y / torque * CELLS[1] as f64].map(|place| place as usize);
        cells.iter().any(|cell| cell.column == column && cell.row == row)
    };
    let of = |estimate: &Option<socam_calibrate::Estimate>| estimate.map_or(0.0, |estimate| estimate.value);
    let losses = &efficiency.losses;
    let contour = |level: f64| {
        let room = 1.0 - of(&losses.torque_share) - 0.01 * level;
        let points = (0..=ALONG)
            .map(|k| k as f64 / ALONG as f64 * speed)
            .map(|x| [x, (of(&losses.viscous) * x + of(&losses.constant)) / room])
            .filter(|[x, y]| *y > 0.0 && is_drawn(*x, *y));
        let points: Vec<[f64; 2]> = points.collect();
        Some(Contour { level, ends: [*points.first()?, *points.last()?] })
    };
    Heat::levels(colours).into_iter().filter_map(contour).collect()
}
