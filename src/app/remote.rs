//! Remote sessions: the window is shown and operated on another computer.

/// Returns whether the user operates this computer over a remote desktop. Over a remote desktop, the release of a
/// button may arrive late. Until it arrives, the window shows the button as pressed.
#[cfg(windows)]
pub(super) fn is_remote_session() -> bool {
    // The variable is that of the logon and may be outdated: a session can be continued from another computer.
    let logged_on_remotely = || std::env::var("SESSIONNAME").is_ok_and(|name| name.starts_with("RDP-"));
    winsafe::GetSystemMetrics(winsafe::co::SM::REMOTESESSION) != 0 || logged_on_remotely()
}

/// Always `false`, because other systems do not report remote sessions.
#[cfg(not(windows))]
pub(super) const fn is_remote_session() -> bool {
    false
}
