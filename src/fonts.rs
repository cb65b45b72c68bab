//! The built-in fonts of the window and of reports. Their licences are in `assets/fonts/LICENCES.txt`.

/// Font for text.
pub const TEXT: &[u8] = include_bytes!("../assets/fonts/Inter-Regular.otf");
/// Font for headings and emphasised text.
pub const STRONG: &[u8] = include_bytes!("../assets/fonts/Inter-SemiBold.otf");
/// Font for bytes and numbers, in which every character has the same width.
pub const MONOSPACE: &[u8] = include_bytes!("../assets/fonts/JetBrainsMono-Regular.ttf");
