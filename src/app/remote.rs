//! Detection of remote sessions, in which the window is operated from another computer.

/// Returns whether the user operates this computer over a remote desktop. A remote desktop may report the release of a
/// button late; until then, the button appears pressed.
#[cfg(windows)]
pub(super) fn is_remote_session() -> bool {
    // The variable is set at logon and may be outdated, because a session can be continued from another computer.
    let logged_on_remotely = || std::env::var("SESSIONNAME").is_ok_and(|name| name.starts_with("RDP-"));
    winsafe::GetSystemMetrics(winsafe::co::SM::REMOTESESSION) != 0 || logged_on_remotely()
}

/// Always returns `false`, because other systems do not report remote sessions.
#[cfg(not(windows))]
pub(super) const fn is_remote_session() -> bool {
    false
}
