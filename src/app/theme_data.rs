//! Theme data from `assets/theme.ron`: colours by meaning, sizes and spacing. This module does not draw anything.

use std::sync::LazyLock;

use serde::Deserialize;

use super::ColorScheme;

#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize)]
#[serde(try_from = "String")]
pub struct Rgb(pub [u8; 3]);

#[derive(Clone, Copy, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct TextSizes {
    pub caption: f32,
    pub body: f32,
    pub section: f32,
    pub value: f32,
    pub live: f32,
}

/// Distances in points, all multiples of four.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct SpacingSizes {
    pub inside: f32,
    pub between: f32,
    pub groups: f32,
    pub around: f32,
}

#[derive(Clone, Copy, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Palette {
    pub surface: Rgb,
    pub raised: Rgb,
    pub sunken: Rgb,
    /// Background of a text entry. In the light theme, a grey background would look disabled.
    pub entry: Rgb,
    pub line: Rgb,
    pub text: Rgb,
    pub muted: Rgb,
    pub accent: Rgb,
    pub on_accent: Rgb,
    /// Colour of values that have been edited but not written.
    pub staged: Rgb,
    pub good: Rgb,
    pub warn: Rgb,
    /// Colour of errors and of the STOP button.
    pub bad: Rgb,
    pub on_bad: Rgb,
    pub series: [Rgb; 8],
}

#[derive(Clone, Copy, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ThemeData {
    pub text: TextSizes,
    pub space: SpacingSizes,
    pub radius: f32,
    dark: Palette,
    light: Palette,
}

static BUILT_IN: LazyLock<Result<ThemeData, String>> =
    LazyLock::new(|| ron::from_str(ThemeData::THEME_SOURCE).map_err(|error| error.to_string()));

impl ThemeData {
    pub const THEME_SOURCE: &'static str = include_str!("../../assets/theme.ron");

    /// Returns the built-in theme.
    ///
    /// # Errors
    /// Returns a description of the error in the theme file. A test ensures that the file has no error.
    pub fn built_in() -> Result<&'static ThemeData, &'static str> {
        BUILT_IN.as_ref().map_err(String::as_str)
    }

    pub fn palette(&self, theme: ColorScheme) -> &Palette {
        match theme {
            ColorScheme::Dark => &self.dark,
            ColorScheme::Light => &self.light,
        }
    }
}

impl TryFrom<String> for Rgb {
    type Error = String;

    fn try_from(text: String) -> Result<Self, String> {
        let bytes = text.strip_prefix('#').and_then(|digits| crate::bits::parse_hex(digits).ok());
        match bytes.as_deref() {
            Some([red, green, blue]) => Ok(Rgb([*red, *green, *blue])),
            _ => Err(format!("{text:?} is not a colour of the form #RRGGBB")),
        }
    }
}

impl Rgb {
    /// Returns the contrast with another colour, from 1 to 21, as defined by WCAG 2.
    pub fn contrast_ratio(self, other: Rgb) -> f64 {
        let (a, b) = (self.relative_luminance(), other.relative_luminance());
        (a.max(b) + 0.05) / (a.min(b) + 0.05)
    }

    fn relative_luminance(self) -> f64 {
        let [red, green, blue] = self.0.map(|channel| {
            let value = f64::from(channel) / 255.0;
            if value <= 0.04045 { value / 12.92 } else { ((value + 0.055) / 1.055).powf(2.4) }
        });
        0.2126 * red + 0.7152 * green + 0.0722 * blue
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn contrast_matches_wcag() {
        let rgb = |text: &str| Rgb::try_from(text.to_owned()).unwrap();
        assert!((rgb("#000000").contrast_ratio(rgb("#FFFFFF")) - 21.0).abs() < 1e-9);
        // A known pair: #767676 is the lightest grey that is legible on white.
        assert!((rgb("#767676").contrast_ratio(rgb("#FFFFFF")) - 4.54).abs() < 0.01);
        assert!(Rgb::try_from("#12345".to_owned()).is_err() && Rgb::try_from("123456".to_owned()).is_err());
    }

    #[test]
    fn text_is_legible_on_every_surface() {
        let look = ThemeData::built_in().unwrap();
        for theme in [ColorScheme::Dark, ColorScheme::Light] {
            let palette = look.palette(theme);
            let Palette { text, muted, accent, staged, good, warn, bad, .. } = *palette;
            for surface in [palette.surface, palette.raised, palette.sunken, palette.entry] {
                for (name, colour) in [
                    ("text", text),
                    ("muted", muted),
                    ("accent", accent),
                    ("staged", staged),
                    ("good", good),
                    ("warn", warn),
                    ("bad", bad),
                ] {
                    let contrast = colour.contrast_ratio(surface);
                    assert!(contrast >= 4.5, "{theme:?}: {name} on {surface:?} has {contrast:.2}");
                }
            }
            assert!(
                palette.on_accent.contrast_ratio(accent) >= 4.5 && palette.on_bad.contrast_ratio(bad) >= 4.5,
                "{theme:?}"
            );
            for (number, series) in palette.series.iter().enumerate() {
                let contrast = series.contrast_ratio(palette.sunken);
                assert!(contrast >= 3.0, "{theme:?}: series {number} has {contrast:.2}");
            }
        }
    }

    #[test]
    fn distances_fit_grid() {
        let SpacingSizes { inside, between, groups, around } = ThemeData::built_in().unwrap().space;
        assert!([inside, between, groups, around].iter().all(|space| space % 4.0 == 0.0));
    }
}
