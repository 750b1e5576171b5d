//! The panels as people use and see them: driven by the names that a screen reader would say, and compared with pictures.

mod bench;
mod clicks;
mod commands;
mod files;
mod fits;
mod fleet;
mod keyboard;
mod live;
mod machine;
mod pictures;
mod sample;
mod time;
mod units;
