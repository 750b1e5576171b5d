//! The dashboard in a web page: recordings that are dropped into it are looked at there, and go nowhere.
//!
//! The page (`page.html`) hands over what happens - size, pointer, keys, files - and puts the picture of each pass on a canvas. The
//! picture is drawn by the dashboard's own rasteriser, so it is the one that `--screenshot` gives, and needs no graphics card. Texts and
//! files cross the border through one buffer: the page asks for `room`, writes, and says what it was.
#![cfg(target_arch = "wasm32")]

mod page;
