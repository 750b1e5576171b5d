//! Check view: the findings of `check` for the open recordings, as a table with expandable rows.

pub(crate) mod row;

use std::collections::BTreeSet;

use egui::{RichText, Ui};
use socam_recording::check::{self, Check};

use crate::platform::{self, CheckOptions, CheckTask};
use crate::progress::{self, wake};
use crate::view::{Help, ViewPanel};
use row::{COLUMNS, Row};
use socam_chart::chart::{self, Seen};
use socam_chart::table::Table;
use socam_chart::theme;
use socam_workbench::Workspace;
use socam_workbench::job::{Handle, Job};
use socam_workbench::rail::{Step, Tone, Verdict};
use socam_workbench::recording::short;

/// Number of recordings up to which all are unfolded at first.
const FEW: usize = 2;

/// Results of the checks.
#[derive(Debug, Default)]
pub struct Checks {
    options: CheckOptions,
    known: Vec<(String, Result<Check, String>)>,
    job: Option<(String, Job<Result<Check, String>>)>,
    /// Recordings that were folded, or unfolded where there are many.
    turned: BTreeSet<String>,
    /// The settings and the model that the results belong to.
    of: Option<(CheckTask, u64)>,
}

impl ViewPanel for Checks {
    fn ui(&mut self, ui: &mut Ui, workspace: &mut Workspace, _: &mut Vec<Seen>) {
        egui::CentralPanel::default().show(ui, |ui| self.contents(ui, workspace));
    }

    fn poll(&mut self, _: &egui::Context, workspace: &mut Workspace) {
        if let Some((name, job)) = &self.job
            && let Some(result) = job.poll()
        {
            self.known.push((name.clone(), result.and_then(|result| result)));
            self.job = None;
        }
        let (verdict, recordings) = self.verdict(workspace);
        workspace.rail.set(Step::Check, verdict, recordings);
    }

    fn command(&self, workspace: &Workspace) -> Option<String> {
        self.options.command(workspace.model(), &workspace.entries)
    }

    fn is_busy(&self) -> bool {
        self.job.is_some()
    }

    fn help() -> Help {
        &[(
            "Tolerance of speed ratios; Input, without a model",
            "of the mean ratio of two speeds against that of the gears; a channel whose recordings are checked without a model: on a desktop",
        )]
    }
}

impl Checks {
    /// The verdict on the recordings that are shown, and their names.
    fn verdict(&self, workspace: &Workspace) -> (Verdict, Vec<String>) {
        let shown: Vec<String> = workspace.shown().map(|(_, own)| own.about.name.clone()).collect();
        let checked: Vec<&Result<Check, String>> =
            self.known.iter().filter(|(name, _)| shown.contains(name)).map(|(_, check)| check).collect();
        let of_model = self.of.as_ref().is_some_and(|(_, revision)| *revision == workspace.revision());
        if self.job.is_some() {
            return (Verdict::Running, shown);
        }
        if checked.is_empty() || !of_model {
            return (Verdict::NotDone, shown);
        }
        let count =
            |is: fn(&Check) -> bool| checked.iter().filter(|check| check.as_ref().is_ok_and(is)).count();
        let fit = count(|check| check.verdict == check::Verdict::Fit);
        let weak = count(|check| check.verdict == check::Verdict::FitWithReservations);
        let all = checked.len();
        let (words, tone) = match (all - fit - weak, weak) {
            (0, 0) => ("fit for use".to_owned(), Tone::Good),
            (0, _) => (format!("{weak} of {all} fit with reservations"), Tone::Quiet),
            (unfit, _) => (format!("{unfit} of {all} not fit for use"), Tone::Alarm),
        };
        (Verdict::Done { words, tone }, shown)
    }

    fn contents(&mut self, ui: &mut Ui, workspace: &Workspace) {
        let (entries, model) = (&workspace.entries, workspace.model());
        if entries.is_empty() {
            chart::empty_state(
                ui,
                "No recording is open",
                "Open one with Ctrl+O: this view says whether it can carry a fit of the model, what stands in the way, and what to record instead.",
            );
            return;
        }
        self.options.ui(ui, model, entries);
        self.work(ui, workspace);
        let title = format!(
            "Fit for use with {}? A click on a row unfolds its findings.",
            self.options.subject(model)
        );
        ui.label(RichText::new(title).color(theme::weak(ui)));
        let rows: Vec<Row<'_>> = entries.iter().map(|entry| Row::of(&entry.recording, &self.known)).collect();
        // Few recordings have room for their findings.
        let folds = rows.len() > FEW;
        let is_open = |row: &Row<'_>| row.check.is_some() && self.turned.contains(row.name) == folds;
        let mut turned = None;
        Table::new("checks", &COLUMNS).show_unfolding(
            ui,
            &rows,
            Row::key,
            |ui, row, column| {
                if row.cell(ui, column, is_open(row)) {
                    turned = Some(row.name.to_owned());
                }
            },
            is_open,
            Row::details,
        );
        if let Some(name) = turned
            && !self.turned.remove(&name)
        {
            self.turned.insert(name);
        }
    }

    fn work(&mut self, ui: &mut Ui, workspace: &Workspace) {
        let Some(task) = self.options.task() else { return };
        let of = Some((task.clone(), workspace.revision()));
        if self.of != of {
            (self.of, self.known, self.job) = (of, Vec::new(), None);
        }
        let unknown = |name: &str| self.known.iter().all(|(known, _)| known != name);
        let mut recordings = workspace.entries.iter().map(|entry| &entry.recording);
        let next = recordings.find(|next| unknown(&next.about.name));
        if let (None, Some(recording)) = (&self.job, next) {
            let (own, model, name) =
                (recording.clone(), workspace.model().clone(), recording.about.name.clone());
            let work = move |_: &Handle| platform::check(&task, &model, &own);
            let title = format!("Checking {}", short(&name));
            self.job = Some((name, Job::start(&title, &wake(ui.ctx()), work)));
        }
        if let Some((name, job)) = &self.job
            && progress::job(ui, job)
        {
            self.known.push((name.clone(), Err(format!("{}: the check was cancelled", short(name)))));
            self.job = None;
        }
    }
}
