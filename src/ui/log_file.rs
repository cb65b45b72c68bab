//! The log file: what the log panel shows, kept beyond the window. It begins anew when it has become large.

use std::fs::{self, File, OpenOptions};
use std::path::Path;
use std::sync::Mutex;

/// Bytes from which it begins anew; the one before is kept beside it.
const LARGE: u64 = 1 << 20;

/// Writes the log to this file from now on; where it cannot be written, the window works without.
pub(super) fn begin(path: &Path) {
    match open(path) {
        Ok(file) => {
            let subscriber = tracing_subscriber::fmt()
                .with_writer(Mutex::new(file))
                .with_ansi(false)
                .with_target(false)
                .with_max_level(tracing::Level::INFO)
                .finish();
            let _ = tracing::subscriber::set_global_default(subscriber);
            tracing::info!("encoder-studio {}", env!("CARGO_PKG_VERSION"));
        }
        Err(error) => tracing::warn!("{}: no log file: {error}", path.display()),
    }
}

fn open(path: &Path) -> std::io::Result<File> {
    if let Some(folder) = path.parent() {
        fs::create_dir_all(folder)?;
    }
    if fs::metadata(path).is_ok_and(|data| data.len() > LARGE) {
        fs::rename(path, path.with_extension("old.log"))?;
    }
    OpenOptions::new().create(true).append(true).open(path)
}
