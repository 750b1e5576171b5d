//! Deaths of a recorder, simulated: the process is killed, power is lost between syncs, or power is lost within a sync.
//!
//! A recording is made once and all that it does to the disk is noted. Each death then takes a moment of it and what the disk may hold
//! at that moment, and `judge` says whether the recording keeps its promises. `SOCAM_DEATHS=N` asks for N losses of power, and N/100
//! kills:
//!
//! ```sh
//! SOCAM_DEATHS=100000 cargo test --release -p socam-recording --lib deaths -- --nocapture
//! ```

mod disk;
mod draw;
mod failures;
mod judge;
mod story;

use std::collections::BTreeMap;

use disk::Death;
use draw::Draw;
use judge::{Found, judge};
use story::Story;

/// Deaths of one recording, before another one is made.
const DEATHS_A_STORY: u64 = 50;

/// Least number of losses of power; takes some seconds.
const LOSSES: u64 = 2000;

/// Counts of what deaths have left.
#[derive(Debug, Default)]
struct Tally {
    deaths: u64,
    stories: u64,
    found: BTreeMap<Found, u64>,
    samples: u64,
    most_lost: u64,
}

/// Lets recordings die, and fails at the first broken promise.
fn die(deaths: u64, kinds: &[Death]) -> Tally {
    let mut tally = Tally::default();
    let folder = judge::folder();
    let mut story = Story::of(0);
    for seed in 0..deaths {
        if seed % DEATHS_A_STORY == 0 {
            story = Story::of(seed / DEATHS_A_STORY);
            tally.stories += 1;
        }
        let mut draw = Draw::new(seed);
        let death = kinds[seed as usize % kinds.len()];
        let image = story.image(death, &mut draw);
        let left = judge(folder.path(), &story, &image)
            .unwrap_or_else(|problem| panic!("{death:?}, seed {seed}, {image:?}: {problem}"));
        tally.deaths += 1;
        *tally.found.entry(left.found).or_default() += 1;
        tally.samples += left.samples;
        tally.most_lost = tally.most_lost.max(left.lost);
    }
    tally
}

fn asked() -> u64 {
    std::env::var("SOCAM_DEATHS").map_or(LOSSES, |text| text.parse().expect("SOCAM_DEATHS is a number"))
}

#[test]
fn a_killed_process_loses_nothing_that_was_handed_over() {
    let tally = die((asked() / 100).max(200), &[Death::Kill]);
    println!("killed: {tally:?}");
    assert!(tally.found[&Found::Cut] > tally.deaths / 4 && tally.found[&Found::Older] > 0, "{tally:?}");
}

#[test]
fn a_loss_of_power_loses_nothing_that_was_synced() {
    let tally = die(asked(), &[Death::Power, Death::TornSync]);
    println!("power lost: {tally:?}");
    // Not one kind of image only: every outcome is reached.
    let all = [Found::Nothing, Found::Older, Found::Cut, Found::Damaged, Found::Whole];
    assert!(all.iter().all(|found| tally.found.contains_key(found)), "{tally:?}");
}
