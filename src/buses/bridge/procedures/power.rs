//! Control of the encoder supply by an adapter that can switch it, at the start and end of a session.

use crate::parameter::Keywords;

#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum SupplyAfterSession {
    /// The supply returns to its previous state. If the session has switched the supply on, the supply is switched off.
    #[default]
    AsFound,
    On,
    /// The supply is switched off, even if it was on before the session.
    Off,
}

impl SupplyAfterSession {
    /// Link parameter and value that leave the supply on after the session.
    pub const LEAVE_SUPPLY_ON: (&str, &str) = ("leave-supply", "on");
    pub const KEYWORDS: Keywords<SupplyAfterSession> = Keywords(&[
        ("as-found", SupplyAfterSession::AsFound),
        ("on", SupplyAfterSession::On),
        ("off", SupplyAfterSession::Off),
    ]);
}

#[derive(Clone, Copy, Debug, Default)]
pub(super) struct SupplyState {
    pub(super) after: SupplyAfterSession,
    /// Whether the encoder had power before the session, or `None` if unknown.
    pub(super) was_on: Option<bool>,
    pub(super) is_switched_on: bool,
}

impl SupplyState {
    /// Returns whether the supply must be switched off at the end of the session.
    pub(super) fn must_switch_off(self) -> bool {
        let was_on = self.was_on == Some(true);
        match self.after {
            SupplyAfterSession::AsFound => self.is_switched_on && !was_on,
            SupplyAfterSession::On => false,
            SupplyAfterSession::Off => self.is_switched_on || was_on,
        }
    }
}

/// Logs that the supply could not be switched off. A session that has ended cannot return the error.
pub(crate) fn log_supply_failure(left: Result<(), impl std::fmt::Display>) {
    if let Err(error) = left {
        tracing::warn!("the encoder's supply could not be switched off: {error}");
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::parameter::ParameterValues;

    /// The supply is switched off unless it was on before or another choice was made (issue 22.16).
    #[test]
    fn restores_or_overrides_supply_after_session() {
        use SupplyAfterSession::{AsFound, Off, On};
        let cases = [
            (AsFound, None, true, true),
            (AsFound, Some(false), true, true),
            (AsFound, Some(true), true, false),
            (AsFound, Some(true), false, false),
            (AsFound, None, false, false),
            (On, None, true, false),
            (Off, Some(true), false, true),
            (Off, Some(true), true, true),
            (Off, None, false, false),
        ];
        for (after, was_on, is_switched_on, off) in cases {
            assert_eq!(
                SupplyState { after, was_on, is_switched_on }.must_switch_off(),
                off,
                "{after:?} {was_on:?} {is_switched_on}"
            );
        }
        for (word, after) in [("as-found", Some(AsFound)), ("on", Some(On)), ("off", Some(Off)), ("yes", None)] {
            assert_eq!(SupplyAfterSession::KEYWORDS.read(word), after);
        }
    }
}
