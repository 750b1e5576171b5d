//! Letters that the window's own fonts lack: fonts of the system have most of them, and scripts that none has are said.

use std::collections::BTreeSet;
use std::sync::{Arc, Mutex, PoisonError};

use egui::{FallbackRequest, FontInsert};
use egui_system_font_provider::SystemFontProvider;
use unicode_script::{Script, UnicodeScript};

/// The scripts of letters that no font has.
#[derive(Debug, Clone, Default)]
pub(crate) struct Letters {
    found: Arc<Mutex<Found>>,
}

#[derive(Debug, Default)]
struct Found {
    /// Scripts that have not been said.
    fresh: BTreeSet<&'static str>,
    said: BTreeSet<&'static str>,
}

impl Letters {
    /// Looks for letters in fonts of the system, and remembers the scripts of those that are not there.
    pub(crate) fn by_the_system(&self, ctx: &egui::Context) {
        ctx.add_font_provider(Arc::new(SystemFontProvider::new()));
        self.listen(ctx);
    }

    /// Remembers the scripts of letters that no font provider before this one has; `eframe` has added that of the system.
    pub(crate) fn listen(&self, ctx: &egui::Context) {
        let found = self.found.clone();
        ctx.add_font_provider(Arc::new(move |request: &FallbackRequest<'_>| -> Option<FontInsert> {
            let letter = request.cluster.chars().next()?;
            found.lock().unwrap_or_else(PoisonError::into_inner).lacks(letter);
            None
        }));
    }

    /// One sentence about the scripts that cannot be drawn; each script is named once.
    pub(crate) fn sentence(&self) -> Option<String> {
        self.found.lock().unwrap_or_else(PoisonError::into_inner).sentence()
    }
}

impl Found {
    fn lacks(&mut self, letter: char) {
        // A sign of no script is a box among letters that can be read.
        let script = match letter.script() {
            Script::Common | Script::Inherited | Script::Unknown => return,
            script => script.full_name(),
        };
        if !self.said.contains(script) {
            self.fresh.insert(script);
        }
    }

    fn sentence(&mut self) -> Option<String> {
        let names: Vec<String> = self.fresh.iter().map(|name| name.replace('_', " ")).collect();
        if names.is_empty() {
            return None;
        }
        self.said.append(&mut self.fresh);
        let (word, these) = if names.len() == 1 { ("script", "this script") } else { ("scripts", "them") };
        Some(format!(
            "no font of this computer has the {word} {}, and names in {these} are drawn as boxes: install a font, such as one of Noto, and open the window again",
            socam_findings::words::list(&names, "and")
        ))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_script_without_a_font_is_said_once() {
        let (ctx, letters) = (egui::Context::default(), Letters::default());
        // Without the system's fonts, so that the answer is the same on every machine.
        letters.listen(&ctx);
        let draw = |text: &str| {
            let mut output = ctx.run_ui(egui::RawInput::default(), |ui| drop(ui.label(text)));
            output.textures_delta.clear();
        };
        draw("motor_speed, скорость, θέση");
        assert_eq!(letters.sentence(), None);
        draw("电机转速");
        let said = letters.sentence().unwrap();
        assert!(said.starts_with("no font of this computer has the script Han, and names"), "{said}");
        draw("电机转速 出力トルク मोटर ⌥");
        let said = letters.sentence().unwrap();
        assert!(said.contains("the scripts Devanagari and Katakana, and names in them"), "{said}");
        draw("मोटर");
        assert_eq!(letters.sentence(), None);
    }
}
