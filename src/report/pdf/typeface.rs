//! Typefaces and their glyph widths. Text is set without kerning and ligatures, because the built-in fonts do not need
//! them at the sizes used in reports.

use std::borrow::Cow;

use krilla::text::{Font, GlyphId, KrillaGlyph};
use skrifa::MetadataProvider as _;
use skrifa::instance::{LocationRef, Size};

use super::PdfError;
use crate::fonts;

/// A typeface of a report.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Face {
    Text,
    Strong,
    Mono,
}

/// The typefaces of a report.
pub(super) struct Typefaces([Typeface; 3]);

struct Typeface {
    font: Font,
    bytes: skrifa::FontRef<'static>,
}

/// A run of text in a single typeface.
pub(super) struct Run {
    pub(super) font: Font,
    pub(super) glyphs: Vec<KrillaGlyph>,
    pub(super) text: String,
    /// Width in points at the font size of the run.
    pub(super) width: f32,
}

impl Typefaces {
    pub(super) fn load() -> Result<Self, PdfError> {
        let [text, strong, mono] = [fonts::TEXT, fonts::STRONG, fonts::MONOSPACE].map(Typeface::load);
        Ok(Typefaces([text?, strong?, mono?]))
    }

    fn face(&self, face: Face) -> &Typeface {
        let [text, strong, mono] = &self.0;
        match face {
            Face::Text => text,
            Face::Strong => strong,
            Face::Mono => mono,
        }
    }

    /// Returns a typeface that contains a character, preferably the given one, with the glyph and its advance in ems.
    fn glyph(&self, face: Face, character: char) -> (Face, u32, f32) {
        let found = [face, Face::Mono, Face::Text].into_iter().find_map(|face| {
            let (glyph, advance) = self.face(face).glyph(character)?;
            Some((face, glyph, advance))
        });
        found.unwrap_or((face, 0, 0.5))
    }

    /// Replaces each character that is missing from all typefaces with its code point, such as `[U+96FB]`.
    fn displayable<'a>(&self, text: &'a str) -> Cow<'a, str> {
        let is_missing =
            |character: char| [Face::Text, Face::Mono].iter().all(|face| self.face(*face).glyph(character).is_none());
        if !text.contains(is_missing) {
            return Cow::Borrowed(text);
        }
        let mut shown = String::new();
        for character in text.chars() {
            if is_missing(character) {
                shown.push_str(&format!("[U+{:04X}]", u32::from(character)));
            } else {
                shown.push(character);
            }
        }
        Cow::Owned(shown)
    }

    /// Returns the width of a text in points.
    pub(super) fn width(&self, face: Face, size: f32, text: &str) -> f32 {
        self.displayable(text).chars().map(|character| self.glyph(face, character).2 * size).sum()
    }

    /// Splits a text into runs of a single typeface.
    pub(super) fn runs(&self, face: Face, size: f32, text: &str) -> Vec<Run> {
        let mut runs: Vec<(Face, Run)> = Vec::new();
        for character in self.displayable(text).chars() {
            let (own, glyph, advance) = self.glyph(face, character);
            if runs.last().is_none_or(|(last, _)| *last != own) {
                let font = self.face(own).font.clone();
                runs.push((own, Run { font, glyphs: Vec::new(), text: String::new(), width: 0.0 }));
            }
            let Some((_, run)) = runs.last_mut() else { continue };
            let start = run.text.len();
            run.text.push(character);
            run.width += advance * size;
            run.glyphs.push(KrillaGlyph::new(GlyphId::new(glyph), advance, 0.0, 0.0, 0.0, start..run.text.len(), None));
        }
        runs.into_iter().map(|(_, run)| run).collect()
    }

    /// Breaks a text into lines of at most the given width. Only words that are too long are split.
    pub(super) fn lines(&self, face: Face, size: f32, text: &str, width: f32) -> Vec<String> {
        let mut lines = Vec::new();
        for paragraph in text.split('\n') {
            let (mut line, mut taken) = (String::new(), 0.0);
            for word in self.displayable(paragraph).split_inclusive([' ', '·', '-', '/']) {
                let own = self.width(face, size, word.trim_end());
                if taken > 0.0 && taken + own > width {
                    lines.push(std::mem::take(&mut line).trim_end().to_owned());
                    taken = 0.0;
                }
                for character in word.chars() {
                    let advance = self.glyph(face, character).2 * size;
                    if taken + advance > width && taken > 0.0 && character != ' ' {
                        lines.push(std::mem::take(&mut line));
                        taken = 0.0;
                    }
                    line.push(character);
                    taken += advance;
                }
            }
            lines.push(line.trim_end().to_owned());
        }
        lines
    }
}

impl Typeface {
    fn load(bytes: &'static [u8]) -> Result<Self, PdfError> {
        let font = Font::new(bytes.into(), 0).ok_or(PdfError::Font)?;
        let bytes = skrifa::FontRef::new(bytes).map_err(|_| PdfError::Font)?;
        Ok(Typeface { font, bytes })
    }

    fn glyph(&self, character: char) -> Option<(u32, f32)> {
        let glyph = self.bytes.charmap().map(character)?;
        let advance = self.bytes.glyph_metrics(Size::new(1.0), LocationRef::default()).advance_width(glyph)?;
        Some((glyph.to_u32(), advance))
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]

    use super::*;

    /// U+96FB, U+52D5 and U+6A5F form the Japanese word for an electric motor. The built-in fonts do not contain them.
    #[test]
    fn prints_missing_glyphs_as_code_points() {
        let typefaces = Typefaces::load().unwrap();
        let printed = "[U+96FB][U+52D5][U+6A5F]/7 Größe Ω";
        let text: String =
            typefaces.runs(Face::Text, 9.0, "電動機/7 Größe Ω").into_iter().map(|run| run.text).collect();
        assert_eq!(text, printed);
        assert_eq!(typefaces.lines(Face::Text, 9.0, "電動機/7 Größe Ω", 1_000.0), [printed]);
        // Each missing character becomes eight characters, which may be broken like any others.
        let lines = typefaces.lines(Face::Strong, 9.0, "電動機", 60.0);
        assert!(lines.len() > 1 && lines.concat() == "[U+96FB][U+52D5][U+6A5F]", "{lines:?}");
    }
}
