//! One recording in the table of checks.

use egui::{Color32, RichText, Role, Sense, Ui, WidgetInfo, vec2};
use socam_recording::check::{Check, Finding, Severity, Verdict};

use socam_chart::numbers::{plain, trimmed};
use socam_chart::table::{self, Key};
use socam_chart::theme;
use socam_workbench::recording::{Recording, short};

pub(super) const COLUMNS: [table::Column; 8] = [
    table::text("", 18.0),
    table::text("recording", 200.0),
    table::text("verdict", 200.0),
    table::number("rows", 64.0),
    table::number("duration, s", 76.0),
    table::number("rate, Hz", 66.0),
    table::number("findings", 66.0),
    table::text("worst finding", 200.0),
];

/// Sign of a verdict, so that verdicts do not differ by colour alone.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Sign {
    None,
    Tick,
    Mark,
    Cross,
}

impl Sign {
    /// Draws the sign: fonts have none of them.
    fn draw(self, ui: &mut Ui, colour: Color32) {
        let (rect, _) = ui.allocate_exact_size(vec2(12.0, 12.0), Sense::hover());
        let at = |x: f32, y: f32| rect.min + vec2(x, y);
        let line = |points: Vec<egui::Pos2>| {
            ui.painter().line(points, egui::Stroke::new(2.0, colour));
        };
        match self {
            Self::None => {}
            Self::Tick => line(vec![at(1.0, 6.0), at(4.5, 10.0), at(11.0, 2.0)]),
            Self::Mark => {
                line(vec![at(6.0, 1.0), at(6.0, 7.5)]);
                ui.painter().circle_filled(at(6.0, 10.5), 1.4, colour);
            }
            Self::Cross => {
                line(vec![at(2.0, 2.0), at(10.0, 10.0)]);
                line(vec![at(10.0, 2.0), at(2.0, 10.0)]);
            }
        }
    }
}

/// A recording and its check, once it is made.
pub(super) struct Row<'a> {
    pub(super) name: &'a str,
    rows: usize,
    duration_s: Option<f64>,
    rate_hz: Option<f64>,
    pub(super) check: Option<&'a Result<Check, String>>,
}

impl<'a> Row<'a> {
    pub(super) fn of(recording: &'a Recording, known: &'a [(String, Result<Check, String>)]) -> Self {
        let name = recording.about.name.as_str();
        let step_s = recording.about.sample_time_s;
        Self {
            name,
            rows: recording.samples.rows(),
            duration_s: recording.samples.span_s().map(|[from, to]| to - from),
            rate_hz: (step_s > 0.0).then(|| 1.0 / step_s),
            check: known.iter().find(|(own, _)| own == name).map(|(_, check)| check),
        }
    }

    fn findings(&self) -> &[Finding] {
        match self.check {
            Some(Ok(check)) => &check.findings,
            _ => &[],
        }
    }

    /// Verdict in words, its rank, and its sign.
    fn verdict(&self) -> (&'static str, f64, Sign) {
        match self.check {
            None => ("not checked yet", 3.0, Sign::None),
            Some(Err(_)) => ("not checked", 4.0, Sign::Cross),
            Some(Ok(check)) => match check.verdict {
                Verdict::Fit => ("fit for use", 0.0, Sign::Tick),
                Verdict::FitWithReservations => ("fit with reservations", 1.0, Sign::Mark),
                Verdict::Unfit => ("not fit for use", 2.0, Sign::Cross),
            },
        }
    }

    pub(super) fn key(&self, column: usize) -> Key {
        match column {
            1 => short(self.name).into(),
            2 => Key::Number(self.verdict().1),
            3 => Key::Number(self.rows as f64),
            4 => self.duration_s.into(),
            5 => self.rate_hz.into(),
            6 => Key::Number(self.findings().len() as f64),
            _ => self.worst().as_str().into(),
        }
    }

    fn worst(&self) -> String {
        match self.check {
            Some(Err(sentence)) => sentence.clone(),
            _ => self.findings().first().map(Finding::sentence).unwrap_or_default(),
        }
    }

    /// Draws a cell; true where the row was pressed to unfold or to fold it.
    pub(super) fn cell(&self, ui: &mut Ui, column: usize, is_open: bool) -> bool {
        let text = |value: Option<f64>| RichText::new(value.map_or("-".into(), trimmed)).monospace();
        let label = |ui: &mut Ui, text: RichText| {
            ui.add(egui::Label::new(text).truncate().sense(Sense::click())).clicked()
        };
        match column {
            0 => {
                let name = format!("{}: findings", short(self.name));
                arrow(ui, &name, self.check.is_some(), is_open)
            }
            1 => label(ui, RichText::new(short(self.name)).strong()),
            2 => {
                let (word, _, sign) = self.verdict();
                let colour = match sign {
                    Sign::None => theme::weak(ui),
                    Sign::Tick => theme::good(ui),
                    Sign::Mark => theme::body(ui),
                    Sign::Cross => theme::alarm(ui),
                };
                sign.draw(ui, colour);
                label(ui, RichText::new(word).strong().color(colour))
            }
            3 => label(ui, RichText::new(self.rows.to_string()).monospace()),
            4 => label(ui, text(self.duration_s)),
            5 => label(ui, text(self.rate_hz)),
            6 if self.check.is_none() => label(ui, RichText::new("-")),
            6 => label(ui, RichText::new(self.findings().len().to_string()).monospace()),
            _ => label(ui, RichText::new(plain(&self.worst())).color(theme::weak(ui))),
        }
    }

    /// Draws the findings and their remedies.
    pub(super) fn details(ui: &mut Ui, row: &Self) {
        if let Some(Err(sentence)) = row.check {
            ui.label(RichText::new(sentence).color(theme::alarm(ui)));
        }
        if row.findings().is_empty() && matches!(row.check, Some(Ok(_))) {
            ui.label(RichText::new("nothing stands in the way of a fit").color(theme::weak(ui)));
        }
        for finding in row.findings() {
            let (word, colour): (&str, Color32) = match finding.severity() {
                Severity::Prevents => ("prevents a fit", theme::alarm(ui)),
                Severity::Weakens => ("weakens a fit", theme::alarm(ui)),
                Severity::Note => ("note", theme::weak(ui)),
            };
            ui.label(RichText::new(format!("{word}: {}", plain(&finding.sentence()))).color(colour));
            ui.label(RichText::new(format!("instead: {}", plain(&finding.remedy()))).small());
        }
    }
}

/// Draws the arrow that unfolds a row, where there is something to unfold; true where it was pressed.
pub(crate) fn arrow(ui: &mut Ui, name: &str, is_any: bool, is_open: bool) -> bool {
    let (rect, response) = ui.allocate_exact_size(vec2(14.0, 14.0), Sense::click());
    response.widget_info(|| WidgetInfo::selected(Role::Button, is_any, is_open, name));
    if is_any {
        let mut icon = response.clone();
        icon.rect = rect;
        egui::collapsing_header::paint_default_icon(ui, if is_open { 1.0 } else { 0.0 }, &icon);
    }
    response.clicked()
}
