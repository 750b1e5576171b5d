//! Units that were chosen, in the views beside that over time.

use egui_kittest::kittest::Queryable;
use socam_chart::theme::Look;
use socam_dashboard::diagnosis::Over;
use socam_dashboard::spectra::ChartType;
use socam_dashboard::{Dashboard, View};
use socam_workbench::arrangement::Arrangement;
use socam_workbench::display_units::DisplayUnits;
use socam_workbench::signal::Signal;

use crate::clicks::{until, window};
use crate::sample;

/// Shows speeds in rpm, and that of the motor in deg/s.
fn in_rpm(mut dashboard: Dashboard) -> Dashboard {
    let mut units = DisplayUnits::default();
    units.choose_for_all("rad/s", "rpm");
    units.choose_for_one(&Signal { name: "motor_speed".into(), unit: "rad/s".into() }, "deg/s");
    dashboard.views.time.arrange(&Arrangement { units, ..Arrangement::default() });
    dashboard
}

#[test]
fn spectra_responses_and_residuals_are_in_the_chosen_unit() {
    let mut window = window(in_rpm(sample::state("diagnosis", Look::Dark).unwrap()));
    for (over, chart) in [
        (Over::Signals, "Chart output_speed: measured and predicted, rpm (reversals-1.mcap, held out)"),
        (Over::Speed, "Chart output_speed: mean residual, rpm"),
        (Over::Frequency, "Chart output_speed: residual, rpm per sqrt(Hz)"),
    ] {
        window.state_mut().views.diagnosis.page.over = over;
        window.run_steps(2);
        window.get_by_label(chart);
    }
    let mut dashboard = in_rpm(sample::dashboard(Look::Dark, View::Frequency));
    dashboard.add_recording(sample::run(1, 4000));
    let mut window = crate::clicks::window(dashboard);
    until(&mut window, "spectra", |window| !window.state().is_busy());
    window.run_steps(2);
    window.get_by_label("Chart motor_speed, deg/s per sqrt(Hz)");
    window.state_mut().views.frequency.kind = ChartType::Response;
    window.run_steps(2);
    until(&mut window, "a response", |window| !window.state().is_busy());
    window.run_steps(2);
    window.get_by_label("Chart |output_speed / motor_speed|, (rpm)/(deg/s)");
}
