//! Long names on one line: their beginning and their end, which tell recordings apart.

use egui::{FontId, Ui};

const DOTS: &str = "...";

/// The text with as much of its middle left out as it takes to fit into a width, points.
pub(in crate::review) fn elided(ui: &Ui, text: &str, font: &FontId, width: f32) -> String {
    let letters: Vec<char> = text.chars().collect();
    let widths: Vec<f32> =
        ui.fonts_mut(|fonts| letters.iter().map(|letter| fonts.glyph_width(font, *letter)).collect());
    let dots: f32 = ui.fonts_mut(|fonts| DOTS.chars().map(|letter| fonts.glyph_width(font, letter)).sum());
    cut(&letters, &widths, dots, width)
}

/// Takes letters from both ends in turns, one from the beginning first, as long as they fit.
fn cut(letters: &[char], widths: &[f32], dots: f32, width: f32) -> String {
    if widths.iter().sum::<f32>() <= width {
        return letters.iter().collect();
    }
    let (mut head, mut tail) = (0, letters.len());
    let mut room = width - dots;
    while head < tail {
        let from_head = head <= letters.len() - tail;
        let next = if from_head { head } else { tail - 1 };
        room -= widths[next];
        if room < 0.0 {
            break;
        }
        if from_head { head += 1 } else { tail -= 1 }
    }
    letters[..head].iter().chain(&DOTS.chars().collect::<Vec<_>>()).chain(&letters[tail..]).collect()
}

#[cfg(test)]
mod tests {
    #[test]
    fn beginning_and_end_stay() {
        let cut = |text: &str, width: f32| {
            let letters: Vec<char> = text.chars().collect();
            super::cut(&letters, &vec![1.0; letters.len()], 3.0, width)
        };
        assert_eq!(cut("bench-2026-11-24-warm-07.mcap", 40.0), "bench-2026-11-24-warm-07.mcap");
        assert_eq!(cut("bench-2026-11-24-warm-07.mcap", 19.0), "bench-20...-07.mcap");
        assert_eq!(cut("abc", 1.0), "...");
        assert_eq!(cut("äöüßäöüß", 7.0), "äö...üß");
    }
}
