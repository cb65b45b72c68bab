//! The renderers of the window, which are tried in order until one of them works.
//!
//! OpenGL 2 is available on every computer with a driver for its graphics card, and on Linux even without a card.
//! Windows without such a driver, as on remote desktops and in virtual machines, provides only OpenGL 1.1. Direct3D 12
//! then draws in software.

use eframe::Renderer;

/// Environment variable that selects a renderer. It is needed on computers where a renderer starts but does not draw
/// correctly.
const RENDERER_VARIABLE: &str = "ENCODER_STUDIO_RENDERER";

/// Names of the renderers as used in [`RENDERER_VARIABLE`].
const NAMES: &[(&str, Renderer)] = &[
    ("opengl", Renderer::Glow),
    #[cfg(windows)]
    ("direct3d", Renderer::Wgpu),
];

/// Returns the renderers to try: the one selected by the user, or all of them if none is selected.
pub(super) fn renderers_to_try() -> Vec<Renderer> {
    renderers_for(std::env::var(RENDERER_VARIABLE).ok().as_deref())
}

/// Returns the renderers for the value of the variable. Returns an empty list for an unknown name such as `none`.
fn renderers_for(selected: Option<&str>) -> Vec<Renderer> {
    let is_wanted = |name: &str| selected.is_none_or(|selected| selected.eq_ignore_ascii_case(name));
    NAMES.iter().filter(|(name, _)| is_wanted(name)).map(|(_, renderer)| *renderer).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn tries_only_selected_renderer() {
        assert_eq!(renderers_for(None).first(), Some(&Renderer::Glow));
        assert_eq!(renderers_for(None).len(), NAMES.len());
        assert_eq!(renderers_for(Some("OpenGL")), [Renderer::Glow]);
        assert!(renderers_for(Some("none")).is_empty());
    }
}
