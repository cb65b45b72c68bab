//! The theme of the window as applied to egui: fonts, colours, sizes and spacing from `assets/theme.ron`, and the texts
//! of one language. Every view receives a [`Theme`]. Views do not define colours, sizes or fonts of their own.

use egui::{Color32, CornerRadius, FontData, FontDefinitions, FontFamily, FontId, Margin, RichText, Stroke, TextStyle};

use crate::app::{ColorScheme, Language, Palette, Rgb, SpacingSizes, Text, TextSizes, ThemeData, significant_decimals};
use crate::bits::Word;
use crate::fonts;

impl From<Rgb> for Color32 {
    fn from(Rgb([red, green, blue]): Rgb) -> Self {
        Color32::from_rgb(red, green, blue)
    }
}

#[derive(Clone, Copy, Debug)]
pub struct Theme {
    pub palette: &'static Palette,
    pub sizes: &'static TextSizes,
    pub space: &'static SpacingSizes,
    pub radius: CornerRadius,
    pub language: Language,
    theme: ColorScheme,
}

impl Theme {
    pub fn new(look: &'static ThemeData, theme: ColorScheme, language: Language) -> Self {
        Theme {
            palette: look.palette(theme),
            sizes: &look.text,
            space: &look.space,
            radius: CornerRadius::from(look.radius),
            language,
            theme,
        }
    }

    /// Returns the same theme with the texts of the other language.
    pub(crate) fn with_toggled_language(&self) -> Self {
        let language = match self.language {
            Language::English => Language::German,
            Language::German => Language::English,
        };
        Theme { language, ..*self }
    }

    pub fn translate(&self, id: &'static str) -> String {
        Text::new(id).to_string_in(self.language)
    }

    pub fn format_text(&self, text: &Text) -> String {
        text.to_string_in(self.language)
    }

    /// Formats a number with the decimal separator of the current language.
    pub fn format_number(&self, value: f64, decimals: usize) -> String {
        crate::app::format_decimal(value, decimals, self.language)
    }

    /// Replaces the decimal point in a number with the decimal separator of the current language.
    pub fn digits(&self, number: &str) -> String {
        crate::app::texts::localize_number(number, self.language)
    }

    /// Formats a number with as many decimals as it needs, up to twelve significant digits. Further digits would only
    /// show rounding errors.
    pub fn format_significant_digits(&self, value: f64) -> String {
        self.format_number(value, significant_decimals(value))
    }

    /// Formats a word in hexadecimal, padded to its width.
    pub fn format_word(&self, word: Word) -> String {
        self.format_text(&Text::new("live.word").with("hex", word).with("count", word.bits))
    }

    pub fn label(&self, words: impl Into<String>) -> RichText {
        RichText::new(words).color(self.palette.muted)
    }

    /// Returns text in the style of a caption, for small text next to or below widgets.
    pub fn caption(&self, words: impl Into<String>) -> RichText {
        RichText::new(words).size(self.sizes.caption).color(self.palette.muted)
    }

    /// Adds the space between two groups, less the spacing that egui adds before the next widget.
    pub fn add_gap(&self, ui: &mut egui::Ui) {
        ui.add_space((self.space.groups - ui.spacing().item_spacing.y).max(0.0));
    }

    /// Returns the heading of a section or a card.
    pub fn heading(&self, words: impl Into<String>) -> RichText {
        RichText::new(words).font(self.bold_font(self.sizes.section))
    }

    /// Returns monospaced text for bytes, registers and changing numbers.
    pub fn monospace(&self, words: impl Into<String>) -> RichText {
        RichText::new(words).font(FontId::monospace(self.sizes.body))
    }

    /// Returns the text of a card's main value.
    pub fn value(&self, words: impl Into<String>) -> RichText {
        RichText::new(words).font(FontId::monospace(self.sizes.value))
    }

    pub fn bold_font(&self, size: f32) -> FontId {
        FontId::new(size, FontFamily::Name(STRONG.into()))
    }

    /// Returns the frame of a card. It is raised and has a border but no shadow.
    pub fn card_frame(&self) -> egui::Frame {
        egui::Frame::NONE
            .fill(self.palette.raised.into())
            .stroke(Stroke::new(1.0, self.palette.line))
            .corner_radius(self.radius)
            .inner_margin(Margin::same(12))
    }

    /// Returns the frame for read-only content such as plots, bytes and the trace.
    pub fn sunken_frame(&self) -> egui::Frame {
        egui::Frame::NONE.fill(self.palette.sunken.into()).corner_radius(self.radius).inner_margin(Margin::same(8))
    }

    pub fn apply_to(&self, ctx: &egui::Context) {
        let theme = match self.theme {
            ColorScheme::Dark => egui::Theme::Dark,
            ColorScheme::Light => egui::Theme::Light,
        };
        ctx.set_theme(theme);
        ctx.style_mut_of(theme, |style| {
            style.text_styles = [
                (TextStyle::Small, FontId::proportional(self.sizes.caption)),
                (TextStyle::Body, FontId::proportional(self.sizes.body)),
                (TextStyle::Button, FontId::proportional(self.sizes.body)),
                (TextStyle::Heading, self.bold_font(self.sizes.section)),
                (TextStyle::Monospace, FontId::monospace(self.sizes.body)),
            ]
            .into();
            let (inside, between) = (self.space.inside, self.space.between);
            style.spacing.item_spacing = egui::vec2(between, between);
            style.spacing.button_padding = egui::vec2(between + 2.0, inside);
            style.spacing.interact_size.y = 28.0;
            style.spacing.icon_width = 16.0;
            style.spacing.combo_width = 96.0;
            style.spacing.menu_margin = Margin::same(8);
            style.spacing.window_margin = Margin::same(16);
            // The scroll bar is always visible, even on cards, to show that the content scrolls.
            style.spacing.scroll = egui::style::ScrollStyle {
                foreground_color: true,
                dormant_background_opacity: 0.0,
                active_background_opacity: 0.0,
                dormant_handle_opacity: 0.35,
                active_handle_opacity: 0.5,
                interact_handle_opacity: 0.8,
                handle_min_length: 32.0,
                ..egui::style::ScrollStyle::thin()
            };
            style.wrap_mode = Some(egui::TextWrapMode::Extend);
            style.interaction.selectable_labels = false;
            style.animation_time = 0.1;
            // The cursor does not blink, because a frame is drawn only when something changes.
            style.visuals.text_cursor.blink = false;
            self.apply_colours(&mut style.visuals);
        });
    }

    fn apply_colours(&self, visuals: &mut egui::Visuals) {
        let palette = self.palette;
        let faint = Color32::from(palette.accent).gamma_multiply(0.12);
        visuals.override_text_color = None;
        visuals.panel_fill = palette.surface.into();
        visuals.window_fill = palette.raised.into();
        visuals.window_stroke = Stroke::new(1.0, palette.line);
        visuals.window_corner_radius = self.radius;
        visuals.menu_corner_radius = self.radius;
        visuals.window_shadow = egui::Shadow::NONE;
        visuals.popup_shadow = egui::Shadow::NONE;
        visuals.extreme_bg_color = palette.sunken.into();
        visuals.text_edit_bg_color = Some(palette.entry.into());
        visuals.faint_bg_color = palette.sunken.into();
        visuals.code_bg_color = palette.sunken.into();
        visuals.hyperlink_color = palette.accent.into();
        visuals.warn_fg_color = palette.warn.into();
        visuals.error_fg_color = palette.bad.into();
        visuals.weak_text_color = Some(palette.muted.into());
        visuals.selection.bg_fill = Color32::from(palette.accent).gamma_multiply(0.25);
        visuals.selection.stroke = Stroke::new(1.0, palette.accent);
        visuals.striped = false;
        let corner = CornerRadius::same(4);
        let text = Color32::from(palette.text);
        let line = Color32::from(palette.line);
        // Controls that can be pressed or checked must stand out from separators.
        let edge = Color32::from(palette.muted).gamma_multiply(0.6);
        let accent = Color32::from(palette.accent);
        let widgets = &mut visuals.widgets;
        for (widget, fill, border, ink) in [
            (&mut widgets.noninteractive, palette.raised.into(), line, text),
            (&mut widgets.inactive, palette.raised.into(), edge, text),
            (&mut widgets.hovered, faint, accent, text),
            (&mut widgets.active, faint.gamma_multiply(2.0), accent, text),
            (&mut widgets.open, faint, accent, text),
        ] {
            widget.bg_fill = fill;
            widget.weak_bg_fill = fill;
            widget.bg_stroke = Stroke::new(1.0, border);
            widget.fg_stroke = Stroke::new(1.0, ink);
            widget.corner_radius = corner;
            widget.expansion = 0.0;
        }
    }
}

const STRONG: &str = "strong";

const FONTS: [(&str, &[u8]); 4] = [
    ("inter", fonts::TEXT),
    (STRONG, fonts::STRONG),
    ("mono", fonts::MONOSPACE),
    ("icons", include_bytes!("../../assets/fonts/Icons.ttf")),
];

/// Installs the built-in fonts: a text font in two weights, a monospaced font for bytes and numbers, and an icon font.
pub fn install_fonts(ctx: &egui::Context) {
    let mut definitions = FontDefinitions::empty();
    for (name, bytes) in FONTS {
        definitions.font_data.insert(name.to_owned(), FontData::from_static(bytes).into());
    }
    let family = |names: &[&str]| names.iter().map(|name| (*name).to_owned()).collect::<Vec<_>>();
    definitions.families.insert(FontFamily::Proportional, family(&["inter", "icons", "mono"]));
    definitions.families.insert(FontFamily::Monospace, family(&["mono", "icons", "inter"]));
    definitions.families.insert(FontFamily::Name(STRONG.into()), family(&[STRONG, "icons", "mono"]));
    ctx.set_fonts(definitions);
}

#[cfg(test)]
mod tests {
    use super::*;

    /// No font may turn 0x40 into 0×40, as contextual alternates do, because users copy addresses into scripts.
    #[test]
    fn fonts_substitute_no_characters() {
        for (name, bytes) in FONTS {
            let tables = usize::from(u16::from_be_bytes([bytes[4], bytes[5]]));
            let tags: Vec<&[u8]> = bytes[12..].chunks(16).take(tables).map(|entry| &entry[..4]).collect();
            assert!(tags.contains(&&b"cmap"[..]) && !tags.contains(&&b"GSUB"[..]), "{name}");
        }
    }
}
