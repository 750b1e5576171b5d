use super::insert::Place;
use super::*;
use socam_workbench::arrangement::Arrangement;

fn signal(name: &str, unit: &str) -> Signal {
    Signal { name: name.into(), unit: unit.into() }
}

fn channels() -> Vec<Signal> {
    [("command", "V"), ("motor_speed", "rad/s"), ("output_speed", "rad/s"), ("torque_out", "N m")]
        .map(|(name, unit)| signal(name, unit))
        .into()
}

fn titles(plots: &Plots) -> Vec<String> {
    let root = plots.tree.root.unwrap();
    let children = plots.tree.tiles.get_container(root).unwrap().children_vec();
    let title = |id: &TileId| plots.tree.tiles.get_pane(id).map_or_else(|| "(several)".into(), Plot::title);
    children.iter().map(title).collect()
}

#[test]
fn each_channel_gets_a_plot_and_a_hidden_one_comes_back_where_it_was() {
    let mut plots = Plots::default();
    plots.fit(&channels());
    let usual = ["command", "motor_speed", "output_speed", "torque_out"];
    assert_eq!(titles(&plots), usual);
    plots.hidden.insert(signal("motor_speed", "rad/s"));
    plots.fit(&channels());
    assert_eq!(titles(&plots), ["command", "output_speed", "torque_out"]);
    plots.hidden.clear();
    plots.fit(&channels());
    assert_eq!(titles(&plots), usual);
    // Channels of recordings that are not shown now keep their plots.
    plots.fit(&[]);
    assert!(plots.is_empty());
    plots.fit(&channels());
    assert!(titles(&plots) == usual && !plots.is_empty());
}

#[test]
fn channels_of_two_units_share_a_plot_and_a_third_is_refused_in_a_sentence() {
    let mut plot = Plot::Time(vec![signal("motor_speed", "rad/s")]);
    plot.join(signal("output_speed", "rad/s")).unwrap();
    plot.join(signal("torque_out", "N m")).unwrap();
    let refused = plot.join(signal("command", "V")).unwrap_err();
    assert!(refused.contains("command is in V and this plot has axes in rad/s and N m"), "{refused}");
    assert_eq!(plot.title(), "motor_speed, output_speed, torque_out");
}

#[test]
fn a_layout_survives_its_file() {
    let mut plots = Plots::default();
    plots.fit(&channels());
    let (id, _) = plots.panes().find(|(_, plot)| plot.title() == "torque_out").unwrap();
    plots.insert(Plot::Spectrogram(signal("torque_out", "N m")), id, Place::After);
    plots.insert(Plot::Statistics, id, Place::Above);
    plots.hidden.insert(signal("command", "V"));
    plots.fit(&channels());
    let stored = plots.arrangement(&[]);
    let read: Arrangement = serde_json::from_str(&stored.text()).unwrap();
    assert_eq!(read, stored);
    assert_eq!(Plots::of(&read).arrangement(&[]), stored);
    let node = format!("{:?}", stored.plots);
    assert!(node.contains("Row([") && node.contains("Spectrogram") && node.contains("Statistics"), "{node}");
}

#[test]
fn areas_of_data_in_a_column_are_equally_high_and_the_lowest_has_the_axis() {
    let mut plots = Plots::default();
    plots.fit(&channels());
    plots.stack(Plot::Statistics, &[]);
    let lowest = plots.lowest();
    assert_eq!(lowest.len(), 1);
    let height = plots.least_height() + 200.0;
    plots.level(height);
    let root = plots.tree.root.unwrap();
    let Some(Tile::Container(Container::Linear(column))) = plots.tree.tiles.get(root) else { panic!() };
    let heights: Vec<f32> = column.children.iter().map(|child| column.shares[*child]).collect();
    assert!((heights.iter().sum::<f32>() + 4.0 * heights::GAP - height).abs() < 1e-3);
    assert_eq!(heights[0], heights[1]);
    assert!((heights[3] - heights[0] - socam_chart::chart::X_AXIS).abs() < 1e-3, "{heights:?}");
    // The table gets what it needs, or as much as the others.
    assert!(heights[4] >= heights[0], "{heights:?}");
}
